"""The bar that shows how far a command is, where somebody looks at it."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress


def progress_bar(console: "Console", *, remaining: bool = False) -> "Progress":
    """Return a bar that goes away when it is done.

    Parameters
    ----------
    remaining
        Whether it says how long it will still take.
    """
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
    # A bar that is not seen would leave an empty line among the messages.
    return Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
