"""How far a command is: a bar where somebody looks at it, lines where they go to a file."""

from contextlib import AbstractContextManager, nullcontext
from time import monotonic
from typing import TYPE_CHECKING, Any, final

import typer

if TYPE_CHECKING:
    from rich.console import Console


@final
class Lines:
    """A line on standard error for every stage as it begins, with the time since the first."""

    def __init__(self) -> None:
        self._start = self._last = monotonic()
        self._tasks: dict[int, tuple[str, float | None, float]] = {}
        self._said = ""

    def add_task(self, description: str, *, total: float | None = None) -> int:
        """Tell that a stage begins."""
        self._tasks[number := len(self._tasks)] = description, total, 0.0
        if description != self._said:
            self._tell(description)
        self._said = description
        return number

    def advance(self, task: int, advance: float = 1) -> None:
        """Tell now and then how much of a stage is done."""
        description, total, done = self._tasks[task]
        self._tasks[task] = description, total, done + advance
        if monotonic() - self._last > 30.0:  # seconds
            self._tell(
                f"{description}: {done + advance:.0f}" + (f" of {total:.0f}" if total else "")
            )

    def update(self, task: int, *, description: str, **_: Any) -> None:
        """Tell that a stage has become another."""
        self._tasks[task] = description, *self._tasks[task][1:]
        self._tell(description)

    def remove_task(self, task: int) -> None:
        """Forget a stage that is done; what follows of its name is told again where others were."""

    def _tell(self, text: str) -> None:
        self._last = monotonic()
        minutes, seconds = divmod(int(self._last - self._start), 60)
        typer.echo(f"{minutes:4d}:{seconds:02d}  {text}", err=True)


def progress_bar(
    console: "Console", *, remaining: bool = False, lines: bool = True
) -> AbstractContextManager[Any]:
    """Return a bar that goes away when it is done; lines where no terminal shows it.

    It says how long it will still take if ``remaining``. Commands of seconds have no lines.
    """
    if not console.is_terminal and lines:
        return nullcontext(Lines())
    from rich.progress import (
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeRemainingColumn,
    )

    # Brackets in the names of load cases are no markup.
    columns = [TextColumn("{task.description}", markup=False), BarColumn(), TaskProgressColumn()]
    if remaining:
        columns.append(TimeRemainingColumn())
    # A hidden bar would leave an empty line among the messages.
    return Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
