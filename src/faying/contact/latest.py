"""A cache of one value, for results too large to keep several."""

import threading
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

Formed = TypeVar("Formed")


@dataclass(eq=False)
class Latest(Generic[Formed]):
    """The latest value that was formed; threads form a new one in turn."""

    formed: Formed | None = None
    turn: threading.RLock = field(default_factory=threading.RLock)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle without the value, which stays in this process."""
        return Latest, ()
