"""Factorizations of symmetric matrices, and computations with them."""
