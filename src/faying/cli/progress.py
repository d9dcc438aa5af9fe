"""Progress of a command: a bar in a terminal, lines elsewhere."""

from contextlib import AbstractContextManager, nullcontext
from time import monotonic
from typing import TYPE_CHECKING, Any

import typer

if TYPE_CHECKING:
    from rich.console import Console


class Lines:
    """Progress as lines on standard error, with the time since the first stage began."""

    def __init__(self) -> None:
        self._start = self._last = monotonic()
        self._tasks: dict[int, tuple[str, float | None, float]] = {}
        self._said = ""

    def add_task(self, description: str, *, total: float | None = None) -> int:
        """Print that a stage begins, and return its number."""
        self._tasks[number := len(self._tasks)] = description, total, 0.0
        if description != self._said:
            self._tell(description)
        self._said = description
        return number

    def advance(self, task: int, advance: float = 1) -> None:
        """Print every half minute how much of a stage is done."""
        description, total, done = self._tasks[task]
        self._tasks[task] = description, total, done + advance
        if monotonic() - self._last > 30.0:  # seconds
            self._tell(
                f"{description}: {done + advance:.0f}" + (f" of {total:.0f}" if total else "")
            )

    def update(self, task: int, *, description: str, **_: Any) -> None:
        """Print the new description of a stage."""
        self._tasks[task] = description, *self._tasks[task][1:]
        self._tell(description)

    def remove_task(self, task: int) -> None:
        """Do nothing at the end of a stage."""

    def _tell(self, text: str) -> None:
        self._last = monotonic()
        minutes, seconds = divmod(int(self._last - self._start), 60)
        typer.echo(f"{minutes:4d}:{seconds:02d}  {text}", err=True)


def progress_bar(
    console: "Console", *, remaining: bool = False, lines: bool = True
) -> AbstractContextManager[Any]:
    """Return a progress bar that disappears at the end, or lines without a terminal.

    The bar shows the remaining time if ``remaining``. Commands of seconds print no ``lines``.
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

    # Brackets in names of load cases are not markup.
    columns = [TextColumn("{task.description}", markup=False), BarColumn(), TaskProgressColumn()]
    if remaining:
        columns.append(TimeRemainingColumn())
    # A hidden bar would leave an empty line among the messages.
    return Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
