"""Nastran bulk data: :func:`read_joint`, :func:`read_deck`, :func:`write_deck`."""

from faying.io.nastran.joint import read_deck, read_joint
from faying.io.nastran.writer import write_deck

__all__ = ["read_deck", "read_joint", "write_deck"]
