"""Sentences about the normal modes that a run chose for load cases over time."""

from collections.abc import Mapping

import numpy as np

from faying.assessment.choose_normal_modes import MOST_MODES, NormalModeChoice
from faying.assessment.transient_error import OBSERVED_RATIOS, REMEDY
from faying.units import Units


def chosen_count(choices: Mapping[str, NormalModeChoice]) -> int:
    """Return the number of normal modes that is enough for every load case."""
    return max(choice.count for choice in choices.values())


def mode_sentences(choices: Mapping[str, NormalModeChoice], units: Units) -> list[str]:
    """Return a sentence about the chosen number of normal modes for each load case."""
    shared = ""
    if len(choices) > 1:
        shared = f" All methods have {chosen_count(choices)}, the largest number of all load cases."
    return [_sentence(name, choice, units) + shared for name, choice in choices.items()]


def _sentence(case: str, choice: NormalModeChoice, units: Units) -> str:
    unit = units.frequency
    pairs = zip(choice.counts.tolist(), choice.estimates.tolist(), strict=True)
    errors = ", ".join(f"{_share(error)} with {count}" for count, error in pairs)
    tolerance = f"{100 * choice.tolerance:.3g}%"
    judged = f"within the tolerance of {tolerance}."
    largest = f"{1 / OBSERVED_RATIOS[0]:g} times that, the largest true error in tests, is "
    if not choice.met:
        judged = (
            f"not within the tolerance of {tolerance}: {_limit(choice)}. Method "
            f"'{REMEDY}' adds inertia of the interface, for which normal modes converge slowly."
        )
    return (
        f'{case}: normal_modes = "auto" is {choice.count}; the loads excite modes up to '
        f"{choice.excited:.3g} {unit}, steps resolve {choice.resolved:.3g} {unit}. Pressures are "
        f"estimated to be off by {errors}; {largest}{judged}{_of_tractions(choice)}"
    )


def _of_tractions(choice: NormalModeChoice) -> str:
    """Return a sentence about the estimated error of tractions; empty if it is zero."""
    error = choice.traction_error
    if not error > 0:
        return ""
    said = f" Tractions are then estimated to be off by {_share(error)} of the largest one"
    if error <= choice.tolerance or not choice.met:
        return f"{said}."
    return (
        f"{said}, above the tolerance, because pressures determine the number; method '{REMEDY}' "
        "is more accurate."
    )


def _share(error: float) -> str:
    return f"{error:.2%}" if np.isfinite(error) else "an unknown share"


def _limit(choice: NormalModeChoice) -> str:
    if choice.highest.max(initial=0.0) > choice.resolved:
        return "more modes have periods shorter than a step"
    if choice.counts.max(initial=0) < MOST_MODES:
        return "more modes gain too little"
    return f"at most {MOST_MODES} are tried"
