"""Checks of the strength of bolts, each in its most critical load case."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.check import Check
from faying.assessment.joint_record import REST, Assessment, CaseState
from faying.assessment.strength.fatigue import (
    ENDURANCE_CYCLES,
    EXPONENT,
    endurance,
    is_rated,
    miner_sums,
)
from faying.assessment.strength.preload_ends import PreloadEnd
from faying.assessment.strength.thread import (
    SHEAR,
    Thread,
    fibre_stresses,
    largest_amplitude,
    normal_stresses,
    thread_stress,
    tightening_stress,
    working_stress,
)
from faying.exceptions import check_known, naming
from faying.units import units_of


def stripping_force(thread: Thread, engagement: float, ultimate: float) -> float:
    """Return the force at which the thread of a bolt with tensile strength R_m strips [force].

    The cylinder that shears is at the minor diameter D₁ = d − 5/4 H of the nut: of each pitch P/2 +
    (d₂ − D₁)/√3 is metal of the bolt (areas of the basic profile, FED-STD-H28/2B). The engagement
    is a length.
    """
    minor = thread.diameter - 5 / 4 * np.sqrt(3) / 2 * thread.pitch
    metal = thread.pitch / 2 + (thread.pitch_diameter - minor) / np.sqrt(3)
    area = np.pi * minor * engagement / thread.pitch * metal
    return float(SHEAR * ultimate * area)


def strength_checks(
    threads: Mapping[str, Thread],
    ends: Sequence[PreloadEnd],
    units: str,
    repetitions: Mapping[str, float] | None = None,
) -> Iterator[Check]:
    """Yield the checks of the bolts with known threads.

    The joint is given at the ends of the scatter of its preloads, or at nominal preloads.
    Repetitions are the numbers of times a load case occurs in the life of the joint, where known.

    Raises
    ------
    ModelError
        If the units are not known.
    """
    for name, thread in threads.items():
        if thread.friction is not None:
            yield _tightening_check(name, thread, ends, units)
        yield _yield_check(name, thread, ends, units)
        yield from _fatigue_checks(name, thread, ends, units, repetitions or {})
        if thread.bearing is not None and thread.pressure_limit is not None:
            yield _pressure_check(name, thread, ends, units)
        if thread.engagement is not None:
            yield _stripping_check(name, thread, ends, units)


@dataclass(frozen=True, kw_only=True)
class _Largest:
    """The largest of some values over all ends, load cases and instants."""

    value: float
    end: PreloadEnd
    case: str
    row: int

    def check(self, bolt: str, quantity: str, limit: float, unit: str, source: str) -> Check:
        """Return the check of this value against an upper limit."""
        times = self.end.cases[self.case].times
        timed = times is not None and self.row < len(times)
        check = Check(
            part=bolt,
            kind="bolt",
            quantity=quantity,
            unit=unit,
            case=self.case,
            instant=float(times[self.row]) if timed and times is not None else None,
            scatter=self.end.name,
            source=source,
            bound=self._bounds(bolt),
        )
        return check.at_most(self.value, limit)

    def _bounds(self, bolt: str) -> bool:
        """Return whether this value is an upper bound over the scatter of preloads.

        In a joint without friction with a single bolt, its force rises with its preload: its spring
        is never stiffer than itself with the rest of the joint. With several, one may relax
        another.
        """
        alone = len(self.end.rest.bolt_forces) == 1
        solved = self.case in self.end.solved and not self.end.rubs
        return alone and solved and bolt not in self.end.rest.bolt_moments


def _largest(ends: Sequence[PreloadEnd], of: Callable[[PreloadEnd, CaseState], Vector]) -> _Largest:
    """Return the largest of values (n_instant,) over all ends and load cases."""
    candidates = [
        _Largest(value=float(values.max()), end=end, case=case, row=int(values.argmax()))
        for end in ends
        for case, state in end.cases.items()
        for values in (of(end, state),)
    ]
    return max(candidates, key=lambda largest: largest.value)


def _tightening_check(bolt: str, thread: Thread, ends: Sequence[PreloadEnd], units: str) -> Check:
    """Return the check of tension and torsion during tightening."""
    end = max(ends, key=lambda end: end.preload(bolt))
    stress, limit = tightening_stress(thread, end.preload(bolt)), thread.strengths(units).yields
    check = Check(
        part=bolt,
        kind="bolt",
        quantity="tightening",
        unit=units_of(units).pressure,
        scatter=end.name,
        source="σ_red,M over R_p0.2 (VDI symbols)",
    )
    return check.at_most(stress, limit)


STRESSED = "take a larger size, a higher grade, or relieve the bolt"
BENT = (
    "bending decides, and without it the check is met; where friction of the faces carries what "
    "acts along them and the study does not say so, give 'friction' of the interface or [sticking]"
)
BENT_AT_REST = (
    "tightening alone bends it beyond the limit, and without bending the check is met: what it "
    "clamps tilts under its head or nut; look at gaps that the bolts close, flanges that tilt "
    "about a gasket, the order of tightening, and the mesh around the hole"
)
"""Remedy for a bolt that yields."""


def _yield_check(bolt: str, thread: Thread, ends: Sequence[PreloadEnd], units: str) -> Check:
    worst = _largest(
        ends,
        lambda end, state: working_stress(
            thread, end.preload(bolt), state.bolt_forces[bolt], state.bolt_moments.get(bolt)
        ),
    )
    check = worst.check(
        bolt,
        "yield",
        thread.strengths(units).yields,
        unit=units_of(units).pressure,
        source="σ_red,B over R_p0.2 (VDI symbols)",
    )
    if check.outcome == "met":
        return check
    rest, preload = worst.end.rest, worst.end.preload(bolt)
    forces = worst.end.cases[worst.case].bolt_forces[bolt][worst.row : worst.row + 1]
    if working_stress(thread, preload, forces, None)[0] > check.limit:
        return replace(check, reason=STRESSED)
    tightened = working_stress(thread, preload, rest.bolt_forces[bolt], rest.bolt_moments.get(bolt))
    return replace(check, reason=BENT_AT_REST if tightened[0] > check.limit else BENT)


def _pressure_check(bolt: str, thread: Thread, ends: Sequence[PreloadEnd], units: str) -> Check:
    outer, inner = thread.bearing or (0.0, 0.0)
    area = np.pi / 4 * (outer**2 - inner**2)
    worst = _largest(ends, lambda _, state: state.bolt_forces[bolt] / area)
    return worst.check(
        bolt,
        "pressure under the head",
        thread.pressure_limit or 0.0,
        unit=units_of(units).pressure,
        source="F_S,max / A_p over p_G (VDI symbols)",
    )


def _stripping_check(bolt: str, thread: Thread, ends: Sequence[PreloadEnd], units: str) -> Check:
    ultimate = thread.strengths(units).ultimate
    worst = _largest(ends, lambda _, state: state.bolt_forces[bolt])
    return worst.check(
        bolt,
        "stripping",
        stripping_force(thread, thread.engagement or 0.0, ultimate),
        unit=units_of(units).force,
        source="FED-STD-H28 area of the bolt's thread, shear at 0.6 R_m",
    )


FATIGUE = "σ_a over σ_ASV = 0.85 (150/d + 45) (VDI symbols)"
UNRATED = "endurance is known of steels of 8.8 to 12.9"
UNCOUNTED = "give the load cases 'repetitions'"
UNLOADED = "the joint is judged at rest: give its harmonic load as [[frequency]], or load cases"
MINER = "Miner's sum, rainflow by ASTM E1049, σ_ASV = 0.85 (150/d + 45)"


def _fatigue_checks(
    bolt: str,
    thread: Thread,
    ends: Sequence[PreloadEnd],
    units: str,
    repetitions: Mapping[str, float],
) -> Iterator[Check]:
    """Yield checks of counted load cases by Miner's sum, and of all others by amplitude."""
    limit = endurance(thread, units)
    if not is_rated(thread, units):
        yield Check(part=bolt, kind="bolt", quantity="fatigue", reason=UNRATED)
        return
    if set(ends[0].cases) == {REST}:
        yield Check(part=bolt, kind="bolt", quantity="fatigue", reason=UNLOADED)
        return
    sums = [_damage(bolt, thread, end, repetitions, limit) for end in ends]
    if any(case in repetitions for case in ends[0].cases):
        worst = max(range(len(ends)), key=lambda row: sums[row][1])
        case, total, end = sums[worst]
        check = Check(
            part=bolt,
            kind="bolt",
            quantity="fatigue, Miner's sum",
            case=case,
            scatter=end,
            source=MINER,
        )
        yield check.at_most(total, 1.0)
    uncounted = [case for case in ends[0].cases if case not in repetitions]
    if uncounted:
        yield _endurance_check(bolt, thread, ends, uncounted, units, limit)


def _endurance_check(
    bolt: str,
    thread: Thread,
    ends: Sequence[PreloadEnd],
    cases: Sequence[str],
    units: str,
    limit: float,
) -> Check:
    """Return the check of the amplitude over rest and all load cases without counts."""
    amplitudes = [
        largest_amplitude(np.concatenate([_stresses(bolt, thread, end, case) for case in cases]))
        for end in ends
    ]
    worst = int(np.argmax(amplitudes))
    amplitude, end = amplitudes[worst], ends[worst]
    amplitude_of = {case: largest_amplitude(_stresses(bolt, thread, end, case)) for case in cases}
    check = Check(
        part=bolt,
        kind="bolt",
        quantity="fatigue",
        unit=units_of(units).pressure,
        case=max(amplitude_of, key=amplitude_of.__getitem__),
        scatter=end.name,
        source=FATIGUE,
    ).at_most(amplitude, limit)
    if check.outcome == "met":
        return check
    cycles = ENDURANCE_CYCLES * (limit / amplitude) ** EXPONENT
    borne = f"borne {float(f'{cycles:.1g}'):.0f} times: {UNCOUNTED}"
    return replace(check, outcome="unknown", utilisation=None, reason=borne)


def _damage(
    bolt: str,
    thread: Thread,
    end: PreloadEnd,
    repetitions: Mapping[str, float],
    limit: float,
) -> tuple[str, float, str]:
    """Return the most damaging load case, Miner's sum of the worst fibre, and its end of scatter.

    Cases without a solution at that end have the amplitudes of nominal preloads.
    """
    sums = {
        case: miner_sums(
            fibre_stresses(_stresses(bolt, thread, end, case)), repetitions[case], limit
        )
        for case in end.cases
        if case in repetitions
    }
    if not sums:
        return "", 0.0, end.name
    total = np.sum(list(sums.values()), axis=0)
    fibre = int(total.argmax())
    harmful = [case for case, damage in sums.items() if damage[fibre] > 0]
    moved = len([case for case in harmful if case not in end.solved]) if end.name else 0
    nominal = f"{moved} of {len(harmful)} cases by their nominal amplitudes" if moved else ""
    where = ", ".join(filter(None, (end.name, nominal)))
    return max(sums, key=lambda case: float(sums[case][fibre])), float(total[fibre]), where


def _stresses(bolt: str, thread: Thread, end: PreloadEnd, case: str) -> Matrix:
    """Return normal stresses from rest through a load case and back (n_instant + 2, n_end, 3)."""
    state, bent_before = end.cases[case], end.rest.bolt_moments.get(bolt)
    moments = None if bent_before is None else state.bolt_moments.get(bolt)
    tightened = normal_stresses(thread, end.rest.bolt_forces[bolt][:1], bent_before)
    loaded = normal_stresses(thread, state.bolt_forces[bolt], moments)
    if moments is None and bent_before is not None:  # the bending is that at rest
        loaded = np.concatenate([loaded, loaded], axis=1) + tightened * [0.0, 1.0, 1.0]
    return np.concatenate([tightened, loaded, tightened])


def with_threads(
    found: Assessment,
    cases: Mapping[str, CaseState],
    threads: Mapping[str, Thread],
    units: str,
    ends: Sequence[PreloadEnd],
    repetitions: Mapping[str, float] | None = None,
) -> Assessment:
    """Return an assessment with the stress in the known threads, and their checks.

    Load cases are given again at the ends of the scatter of the preloads. Repetitions are the
    numbers of times they occur.
    """
    for name in threads:
        with naming("threads"):
            check_known(name, found.bolts, "bolt")
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


@dataclass(frozen=True, kw_only=True)
class Safeties:
    """Required safety factors.

    Attributes
    ----------
    yields
        S_F.
    fatigue
        S_D.
    pressure
        S_p, under the head.
    """

    yields: float = 1.0
    fatigue: float = 1.0
    pressure: float = 1.0


def with_safeties(checks: Iterable[Check], demanded: Safeties) -> Iterator[Check]:
    """Yield checks with limits divided by the required safety factors."""
    safeties = {
        "yield": demanded.yields,
        "fatigue": demanded.fatigue,
        "pressure under the head": demanded.pressure,
    }
    for check in checks:
        safety = safeties.get(check.quantity)
        if safety is None or check.value is None or check.limit is None:
            yield check
            continue
        judged = replace(check, required=True).at_most(check.value, check.limit / safety)
        unknown = check.outcome == "unknown"
        yield replace(judged, outcome="unknown", utilisation=None) if unknown else judged
