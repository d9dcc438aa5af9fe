"""Finite element models: M, C and K from a deck, a generator or matrices (stage 1)."""
