"""Digits that tell nothing: shares of the largest of a kind below which a number is none.

And how large and how small numbers may be.
"""

ROUND_OFF = 1e-12
"""What sums and products of some thousand numbers of 16 digits leave."""

SOLVED = 1e-9
"""What systems of equations leave, whose conditions are up to a few millions."""

DECK_DIGITS = 1e-6
"""What is written leaves: fields of eight columns hold six to seven digits.

A stiffness that stands for rigid or for none is as far from its neighbours: results are a millionth
off, and K loses no more than six of its sixteen digits.
"""

SMALLEST, LARGEST = 1e-30, 1e30
"""Magnitudes of measures: products of several, as a stiffness times an area times a length, must
stay between 1e-308 and 1e308, where double precision ends."""

CURVE_POINTS = 200
"""Points of a smooth curve: straight lines between them are off half a cosine by 3e-5 of it."""

SHOWN_DIGITS = 1e-4
"""What results leave as they are shown, with four digits."""

SHORT_DIGITS = 1e-3
"""What short tables leave, and eight columns with sign and exponent, as -1.23-10."""
