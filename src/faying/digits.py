"""Digits that tell nothing: shares of the largest of a kind below which a number is none."""

ROUND_OFF = 1e-12
"""What sums and products of some thousand numbers of 16 digits leave."""

SOLVED = 1e-9
"""What systems of equations leave, whose conditions are up to a few millions."""

DECK_DIGITS = 1e-6
"""What is written leaves: fields of eight columns hold six to seven digits."""
