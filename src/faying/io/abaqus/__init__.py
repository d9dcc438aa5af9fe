"""Abaqus and CalculiX decks: :func:`read_joint`, :func:`read_deck`, :func:`write_deck`."""

from faying.io.abaqus.joint import read_deck, read_joint
from faying.io.abaqus.writer import write_deck

__all__ = ["read_deck", "read_joint", "write_deck"]
