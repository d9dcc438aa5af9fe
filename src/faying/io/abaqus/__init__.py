"""Abaqus and CalculiX decks: :func:`read_joint`, :func:`read_deck`, :func:`write_deck`.

Unsupported input raises :class:`~faying.exceptions.FormatError` with file, line
and keyword, what was found and expected, and what to do.
"""

from faying.io.abaqus.joint import read_deck, read_joint
from faying.io.abaqus.writer import write_deck

__all__ = ["read_deck", "read_joint", "write_deck"]
