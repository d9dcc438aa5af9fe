"""Tables that go with matrices: nodes, degrees of freedom, faces, node sets."""

from os import PathLike
from pathlib import Path

import numpy as np

from faying._typing import Indices, Matrix
from faying.exceptions import FormatError
from faying.files.contents import file_bytes, file_text, reason_of
from faying.files.numpy_archive import read_arrays
from faying.io.deck_lines import Lines
from faying.io.line_texts import split_lines
from faying.io.nastran.cards import Card
from faying.io.nastran.fields import integer
from faying.io.nastran.tokenizer import read_cards

_Rows = list[tuple[int, list[str]]]


def read_node_table(path: str | PathLike[str]) -> tuple[Indices, Matrix]:
    """Return ids (n,) and coordinates (n, 3) from rows of id, x, y, z.

    Text files (``.csv``, ``.txt``, ``.dat``) separate by commas, semicolons or blanks and may
    have a heading line and comments after ``#``. An ``.npz`` holds one array (n, 4).
    """
    table = _numbers(Path(path), "node table", ("id", "x", "y", "z"))
    return _whole(table[:, :1], Path(path), "node id")[:, 0], table[:, 1:]


def read_dof_table(path: str | PathLike[str]) -> Indices:
    """Return (n, 2) node id and component 1..6 of each matrix row, from rows of the same.

    Files are those of :func:`read_node_table`, or the ``.pch`` of an external superelement of
    Nastran with its EXTRN card.
    """
    if Path(path).suffix.lower() == ".pch" and Path(path).is_file():
        return read_extrn(Path(path))
    table = _numbers(Path(path), "dof table", ("node", "component"))
    return _whole(table, Path(path), "dof table entry")


def read_id_sets(path: str | PathLike[str], what: str) -> dict[str, list[Indices]]:
    """Return named rows of node ids, from rows of name, id, … or an ``.npz`` of named arrays."""
    path = Path(path)
    if path.suffix.lower() == ".npz":
        return {
            name: list(_whole(np.atleast_2d(array), path, f"{what} '{name}'"))
            for name, array in _arrays(path, what).items()
        }
    sets: dict[str, list[Indices]] = {}
    for i, (line, texts) in enumerate(_rows(path, what)):
        ids = [text for text in texts[1:] if text]
        if not ids or not all(text.isascii() and text.isdigit() for text in ids):
            if i == 0:
                continue  # a heading
            message = f"{path}:{line}: {what} '{texts[0]}': expected name, node id, node id, …"
            raise FormatError(message)
        sets.setdefault(texts[0], []).append(np.array([int(text[:18]) for text in ids]))
    return sets


def _arrays(path: Path, what: str) -> dict[str, Matrix]:
    _check_there(path, what)
    try:
        return read_arrays(path)
    except Exception as error:  # whatever a damaged archive meets
        message = (
            f"{what} '{path}' cannot be read ({reason_of(error)}); write it again by numpy.savez"
        )
        raise FormatError(message) from error


def _check_there(path: Path, what: str) -> None:
    if not path.is_file():
        message = f"{what} '{path}' is not there; check the path"
        raise FormatError(message)
    if path.suffix.lower() not in (".npz", ".csv", ".txt", ".dat"):
        message = f"{what} '{path}' ends in '{path.suffix}'; readable are .csv, .txt, .npz"
        raise FormatError(message)


def _rows(path: Path, what: str) -> _Rows:
    _check_there(path, what)
    try:
        text = file_text(path, errors="replace")
    except OSError as error:
        message = f"{what} '{path}' cannot be read: {error.strerror}"
        raise FormatError(message) from error
    separated = text.replace(";", ",")
    rows = []
    for number, full in enumerate(separated.splitlines(), start=1):
        line = full.partition("#")[0].strip()
        if line:
            parts = line.split(",") if "," in line else line.split()
            rows.append((number, [part.strip() for part in parts]))
    return rows


def _numbers(path: Path, what: str, columns: tuple[str, ...]) -> Matrix:
    expected = f"expected {len(columns)} numbers: {', '.join(columns)}"
    if path.suffix.lower() == ".npz":
        arrays = list(_arrays(path, what).values())
        table = arrays[0] if len(arrays) == 1 else np.zeros(0)
        if table.ndim != 2 or table.shape[1] != len(columns) or table.dtype.kind not in "fiu":
            message = (
                f"{what} '{path}': expected one array of {len(columns)} columns: "
                f"{', '.join(columns)}"
            )
            raise FormatError(message)
        return table.astype(np.float64)
    rows = _rows(path, what)
    if rows and not _parsed(rows[0][1]):
        rows = rows[1:]
    wrong = next((row for row in rows if len(row[1]) != len(columns)), None)
    if wrong is not None:
        message = f"{path}:{wrong[0]}: {what}: found {len(wrong[1])} entries, {expected}"
        raise FormatError(message)
    if not rows:
        message = f"{what} '{path}' has no rows; {expected} on each"
        raise FormatError(message)
    try:
        return np.array([texts for _, texts in rows], dtype=np.float64)
    except ValueError as error:
        line, texts = next((row for row in rows if not _parsed(row[1])), rows[0])
        message = f"{path}:{line}: {what}: found '{' '.join(texts)}', {expected}"
        raise FormatError(message) from error


def _parsed(texts: list[str]) -> bool:
    try:
        return all(np.isfinite(float(text)) or True for text in texts)
    except ValueError:
        return False


def _whole(table: Matrix, path: Path, what: str) -> Indices:
    if table.dtype.kind not in "fiu":
        message = f"{what} in '{path}': expected whole numbers, found {table.dtype}"
        raise FormatError(message)
    # Doubles hold whole numbers up to 2⁵³ exactly.
    wrong = ~(np.abs(table) < 2.0**53) | (table != np.floor(table))
    if wrong.any():
        message = f"{what} {table[wrong][0]:g} in '{path}' is not a whole number"
        raise FormatError(message)
    return table.astype(np.int64)


def read_extrn(path: Path) -> Indices:
    """Return node id and component 1..6 (n, 2) of the rows of an external superelement's matrices.

    They are in the ``.pch`` that Nastran wrote beside the OP4 file (EXTSEOUT with MATOP4 or
    DMIGOP4). Scalar points get component 1.
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
    rows = [row for field in range(0, len(card), 2) for row in _rows_of_pair(card, field)]
    table = np.array(rows, dtype=np.int64).reshape(-1, 2)
    if len(np.unique(table, axis=0)) != len(table):
        message = "a grid component is named twice"
        raise card.error(message)
    return table


def _rows_of_pair(card: Card, field: int) -> list[tuple[int, int]]:
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
