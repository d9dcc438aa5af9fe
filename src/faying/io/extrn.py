"""Labels of an external superelement's rows: the EXTRN card of its punch file."""

from pathlib import Path

import numpy as np

from faying._typing import Indices
from faying.exceptions import FormatError
from faying.files.contents import file_bytes
from faying.io.deck_lines import Lines
from faying.io.line_texts import split_lines
from faying.io.nastran.cards import Card
from faying.io.nastran.fields import integer
from faying.io.nastran.tokenizer import read_cards


def read_extrn(path: Path) -> Indices:
    """Return node id and component 1..6 (n, 2) of the rows of an external superelement's matrices.

    Parameters
    ----------
    path
        The ``.pch`` that Nastran wrote beside the OP4 file (EXTSEOUT with MATOP4 or DMIGOP4).
        Scalar points get component 1.
    """
    text = split_lines(file_bytes(path).upper())
    lines = Lines(
        text=text,
        number=np.arange(1, len(text) + 1, dtype=np.int64),
        file=np.zeros(len(text), dtype=np.int64),
        files=(str(path),),
    )
    cards = read_cards(lines).cards().get("EXTRN")
    if cards is None or len(cards) != 1:
        message = (
            f"dof table '{path}' has {0 if cards is None else len(cards)} EXTRN cards; "
            "expected the punch file of one external superelement"
        )
        raise FormatError(message)
    card = next(iter(cards))
    rows = [row for field in range(0, len(card), 2) for row in _rows(card, field)]
    table = np.array(rows, dtype=np.int64).reshape(-1, 2)
    if len(np.unique(table, axis=0)) != len(table):
        message = "a grid component is named twice"
        raise card.error(message)
    return table


def _rows(card: Card, field: int) -> list[tuple[int, int]]:
    """Rows of one pair of grid and components; scalar points have component 0."""
    grid, components = card.text(field), card.text(field + 1)
    if not grid and not components:
        return []
    number = integer(grid)
    digits = components or "0"
    good = digits == "0" or (set(digits) <= set("123456") and len(set(digits)) == len(digits))
    if number is None or number < 1 or not good:
        message = f"'{grid} {components}' is no grid with its components"
        raise card.error(message, field)
    return [(number, max(int(digit), 1)) for digit in sorted(digits)]
