"""Couplings and supports as linear equations, one family per file."""
