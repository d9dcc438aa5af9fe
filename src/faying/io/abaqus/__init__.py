"""Abaqus and CalculiX decks: :func:`read_joint`, :func:`read_deck`, :func:`write_deck`.

What a reader cannot represent it refuses with :class:`~faying.exceptions.FormatError`: file, line
and keyword, what stands there, what is expected and what to do.
"""

from faying.io.abaqus.joint import read_deck, read_joint
from faying.io.abaqus.writer import write_deck

__all__ = ["read_deck", "read_joint", "write_deck"]
