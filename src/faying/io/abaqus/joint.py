"""Read an Abaqus or CalculiX deck: the structure, its contact pairs and its bolts."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import numpy as np

from faying.io.abaqus.changing_steps import step_before_changes
from faying.io.abaqus.deck import read_keyword_deck
from faying.io.abaqus.model import description
from faying.io.deck_lines import naming
from faying.io.left_out import checked_ignore
from faying.model.assembly import Assembly
from faying.model.description import JointDescription


def read_joint(
    path: str | PathLike[str], *, step: int | None = None, ignore: Sequence[str] = ()
) -> JointDescription:
    """Read a deck, its contact pairs as interfaces and its pretension sections as bolts.

    Parameters
    ----------
    path
        The deck; *INCLUDE is relative to its folder.
    step
        Step whose boundary conditions, loads and bolt forces count, with what earlier steps leave
        in force. Unless given it is the last general one in front of those that change the
        structure (*MODEL CHANGE, *CHANGE …, *EQUATION with REMOVE).

    ignore
        What the deck has and the model shall not: words of
        :data:`faying.io.left_out.IGNORABLE`, which says what each means.

    Returns
    -------
    JointDescription
        Slave surfaces are the minus sides. ``assembly.loads`` has ``step 1``, … with what is in
        force in each step up to the chosen one, which comes first. Ids and names are those of the
        deck; names inside instances are ``instance.name``. ``assembly.ignored`` names everything
        left out.

    Raises
    ------
    FormatError
        With file and line: a missing file, a malformed number, a reference to something that is
        not there, a repeated id; or all keywords that change the structure and are not supported.

    Notes
    -----
    About 8 s for 500 000 nodes and bricks.
    """
    path = Path(path)
    ignored: list[str] = []
    # Overflow is caught by the finiteness checks, where the line can be named.
    with np.errstate(over="ignore", invalid="ignore"), naming(path):
        deck = read_keyword_deck(path, checked_ignore(ignore))
        chosen = step_before_changes(deck, ignored) if step is None else step
        return description(deck.until(chosen), ignored)


def read_deck(path: str | PathLike[str]) -> Assembly:
    """Read the structure of a deck as :func:`read_joint`, in its last general step."""
    return read_joint(path).assembly
