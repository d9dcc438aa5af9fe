"""Abaqus and CalculiX input decks (``.inp``)."""

from faying.io.abaqus.joint import read_deck, read_joint

__all__ = ["read_deck", "read_joint"]
