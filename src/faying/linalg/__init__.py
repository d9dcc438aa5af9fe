"""Factorizations and what is computed with them."""
