"""An assessment with the strength of the bolts whose threads are known."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying.assessment.joint_record import Assessment, CaseState
from faying.assessment.strength.checks import strength_checks
from faying.assessment.strength.preload_ends import PreloadEnd
from faying.assessment.strength.thread import Thread, thread_stress
from faying.exceptions import ModelError


def with_threads(
    found: Assessment,
    cases: Mapping[str, CaseState],
    threads: Mapping[str, Thread],
    units: str,
    ends: Sequence[PreloadEnd],
    repetitions: Mapping[str, float] | None = None,
) -> Assessment:
    """Return an assessment with the stress in the threads that are known, and their checks.

    The load cases that were judged are given anew at the ends of the scatter of the preloads.
    Repetitions say how often a load case comes.
    """
    unknown = sorted(set(threads) - set(found.bolts))
    if unknown:
        known = ", ".join(found.bolts)
        message = f"threads: there is no bolt '{unknown[0]}'; there are {known}"
        raise ModelError(message)
    stressed = {
        name: replace(
            found.bolts[name],
            thread=thread_stress(
                thread,
                found.bolts[name].preload,
                np.concatenate([state.bolt_forces[name] for state in cases.values()]),
                np.concatenate([state.bolt_moments[name] for state in cases.values()])
                if found.bolts[name].bending is not None
                else None,
                units,
            ),
        )
        for name, thread in threads.items()
    }
    checks = strength_checks(threads, ends, units, repetitions)
    return replace(found, bolts={**found.bolts, **stressed}, checks=(*found.checks, *checks))
