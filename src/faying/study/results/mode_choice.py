"""The normal modes that a run chose for its load cases over time, and how that is told."""

from collections.abc import Mapping

import numpy as np

from faying.assessment.choose_normal_modes import MOST_MODES, NormalModeChoice
from faying.assessment.transient_error import OBSERVED_RATIOS, REMEDY
from faying.units import Units


def chosen_count(choices: Mapping[str, NormalModeChoice]) -> int:
    """Return the number that is enough for every load case."""
    return max(choice.count for choice in choices.values())


def mode_sentences(choices: Mapping[str, NormalModeChoice], units: Units) -> list[str]:
    """Say how many normal modes were chosen for each load case, and why."""
    shared = ""
    if len(choices) > 1:
        shared = f" Methods have {chosen_count(choices)}, the most that a load case asks for."
    return [_sentence(name, choice, units) + shared for name, choice in choices.items()]


def _sentence(case: str, choice: NormalModeChoice, units: Units) -> str:
    unit = units.frequency
    pairs = zip(choice.counts.tolist(), choice.estimates.tolist(), strict=True)
    errors = ", ".join(f"{_share(error)} with {count}" for count, error in pairs)
    tolerance = f"{100 * choice.tolerance:.3g}%"
    judged = f"within the tolerance of {tolerance}."
    largest = (
        f"{1 / OBSERVED_RATIOS[0]:g} times that, the most that the true error was seen to be, is "
    )
    if not choice.met:
        judged = (
            f"not within the tolerance of {tolerance}: {_limit(choice)}. Method "
            f"'{REMEDY}' gives the interface the inertia that normal modes find so slowly."
        )
    return (
        f'{case}: normal_modes = "auto" is {choice.count}; the loads excite modes up to '
        f"{choice.excited:.3g} {unit}, steps resolve {choice.resolved:.3g} {unit}. Pressures are "
        f"estimated to be off by {errors}; {largest}{judged}{_of_tractions(choice)}"
    )


def _of_tractions(choice: NormalModeChoice) -> str:
    """Say how far tractions are off with the number chosen, if they are."""
    error = choice.traction_error
    if not error > 0:
        return ""
    said = f" Tractions are then estimated to be off by {_share(error)} of the largest one"
    if error <= choice.tolerance or not choice.met:
        return f"{said}."
    return (
        f"{said}, more than that, for the number is chosen by pressures; method '{REMEDY}' has "
        "them nearer the truth."
    )


def _share(error: float) -> str:
    return f"{error:.2%}" if np.isfinite(error) else "an unknown share"


def _limit(choice: NormalModeChoice) -> str:
    if choice.highest.max(initial=0.0) > choice.resolved:
        return "more modes have periods shorter than a step"
    if choice.counts.max(initial=0) < MOST_MODES:
        return "more modes bring too little"
    return f"{MOST_MODES} are the most that are tried"
