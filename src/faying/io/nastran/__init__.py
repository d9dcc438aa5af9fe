"""Nastran bulk data: :func:`read_joint`, :func:`read_deck`, :func:`write_deck`.

Readers refuse unsupported input with :class:`~faying.exceptions.FormatError`, which gives file,
line, card, field and content, the expected content and a remedy.
"""

from faying.io.nastran.joint import read_deck, read_joint
from faying.io.nastran.writer import write_deck

__all__ = ["read_deck", "read_joint", "write_deck"]
