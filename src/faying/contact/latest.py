"""What was formed last, where there is room for one at a time."""

import threading
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

Formed = TypeVar("Formed")


@dataclass(eq=False)
class Latest(Generic[Formed]):
    """What was formed last; who forms it anew takes turns."""

    formed: Formed | None = None
    turn: threading.RLock = field(default_factory=threading.RLock)

    def __reduce__(self) -> tuple[Any, ...]:
        """Leave behind what was formed, which belongs to this process."""
        return Latest, ()
