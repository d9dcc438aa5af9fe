"""Tables of the console."""

from collections.abc import Iterable
from itertools import compress

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from faying.display.table import Table as DescribedTable


def plain_console() -> Console:
    """Return a console that prints brackets, as of units, rather than reading them as markup."""
    return Console(markup=False, highlight=False)


def text_table(
    title: str | None,
    columns: Iterable[str],
    rows: Iterable[Iterable[object]],
    styles: Iterable[str] = (),
) -> Table:
    """Return a table without empty columns; rows may have styles."""
    pad = title is not None
    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=pad)
    cells = [list(map(_text, row)) for row in rows]
    filled = [any(column) for column in zip(*cells, strict=True)]
    for column in compress(columns, filled):
        table.add_column(column, overflow="fold")
    named = [*styles, *[""] * len(cells)]
    for row, style in zip(cells, named, strict=False):
        table.add_row(*map(Text, compress(row, filled)), style=style)
    return table


def shown(title: str, table: DescribedTable) -> Table:
    """Return a table of the package as a table of the console."""
    return text_table(title, table.columns, ([cell.text for cell in row] for row in table.rows))


def _text(cell: object) -> str:
    return f"{cell:.6g}" if isinstance(cell, float) else str(cell)
