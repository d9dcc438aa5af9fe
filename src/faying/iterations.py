"""How long iterations go on before they are given up: all of them settle far sooner."""

MOST_STEPS = 100
"""Steps of Newton's method and exchanges of points; 2 to 45 are usual."""

MOST_TRIALS = 40
"""Bisections, to a millionth of a millionth, and solutions that each begin from the one before."""

MOST_HALVINGS = 12
"""Halvings of a step: what happens below a four-thousandth of it happens at once."""

MOST_SOLVED = 10_000
"""Increments, points of a sweep, samples or corners: each is solved, one after the other."""

RETRIES = 3
"""Times that something is tried which mostly does at once."""
