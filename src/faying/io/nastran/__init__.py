"""Nastran bulk data: :func:`read_deck`, :func:`write_deck`."""

from faying.io.nastran.reader import read_deck
from faying.io.nastran.writer import write_deck

__all__ = ["read_deck", "write_deck"]
