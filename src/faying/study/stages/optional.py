"""What a run adds to its results and can do without: a failure is a warning, not the end."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from types import TracebackType

from faying.exceptions import FayingError


@dataclass(frozen=True)
class Attempt:
    """Try an extra; whatever it raises is noted under its name and goes no further.

    That an extra meets what nobody foresaw must not cost what was computed before it, so errors of
    every kind stop here. Interrupts do not.
    """

    name: str
    failed: list[str]

    def __enter__(self) -> None:
        """Begin."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> bool:
        """Note an error; say whether it ends here."""
        if not isinstance(error, Exception):
            return False
        reason = (
            str(error) if isinstance(error, FayingError) else f"{type(error).__name__}: {error}"
        )
        said = f"{self.name}: {reason}"
        if said not in self.failed:
            self.failed.append(said)
        return True


@dataclass(eq=False)
class Extras:
    """Validation and the like, tried one by one.

    Attributes
    ----------
    failed
        What could not be done and why, one sentence each, in the order of the run.
    """

    failed: list[str] = field(default_factory=list)

    def attempt(self, name: str) -> Attempt:
        """Return a context that an extra of this name is tried in."""
        return Attempt(name, self.failed)

    def repeat(self, said: Iterable[object]) -> None:
        """Note what failed in the interrupted run that a result was taken over from."""
        self.failed.extend(text for text in map(str, said) if text not in self.failed)
