"""Nastran bulk data: :func:`read_joint`, :func:`read_deck`, :func:`write_deck`.

What a reader cannot represent it refuses with :class:`~faying.exceptions.FormatError`: file, line,
card and field, what stands there, what is expected and what to do.
"""

from faying.io.nastran.joint import read_deck, read_joint
from faying.io.nastran.writer import write_deck

__all__ = ["read_deck", "read_joint", "write_deck"]
