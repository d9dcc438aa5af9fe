"""Rows of loads for the tables of ``faying check``."""

from collections.abc import Iterator

from faying.simulation.integrators import named_integrator
from faying.study.keys.frequency_table import HarmonicForce
from faying.study.keys.tables import ForceSection, LoadCaseSection, Study
from faying.study.stages.path_cases import cycle_increments


def case_rows(study: Study) -> Iterator[tuple[str, str, str, str]]:
    """Yield name, kind, loads and time of load cases."""
    for case in study.load_cases:
        yield case.name, case.kind, "; ".join(map(_force, case.forces)), _timing(case)


def frequency_rows(study: Study) -> Iterator[tuple[str, str, str, str]]:
    """Yield name, loads, levels and range of harmonic loads."""
    for swept in study.frequencies:
        levels = ", ".join(f"{level:g}" for level in swept.levels)
        span = f"{swept.lowest:g} to {swept.highest:g}, {swept.points} points"
        yield swept.name, "; ".join(map(_harmonic, swept.forces)), levels, span


def _harmonic(force: HarmonicForce) -> str:
    turned = f" at {force.phase:g}°" if force.phase else ""
    return f"{force.target} = {force.value:g}{turned}"


def _force(force: ForceSection) -> str:
    amount = f"{force.value:g}" if force.file is None else force.file.name
    if force.boundary is None:
        return f"{amount} times {'deck load' if force.deck_load else 'temperature'} {force.target}"
    return f"{force.boundary} {force.component} = {amount}"


def _timing(case: LoadCaseSection) -> str:
    if case.kind == "path":
        return f"increments of {case.factors.name}" if case.factors else ""
    if case.kind == "cycle":
        amplitudes = ", ".join(f"{amplitude:g}" for amplitude in case.amplitudes or (1.0,))
        return f"cycles of {amplitudes} times the loads until they repeat"
    if case.kind == "backbone":
        modes = ", ".join(map(str, case.modes))
        half = cycle_increments(case) // 2
        solutions = len(case.modes) * len(case.levels) * ((half + 1) // 2 + 2 * half)
        return (
            f"modes {modes} at {len(case.levels)} amplitudes each, cycles until they repeat: "
            f"{solutions} increments at least"
        )
    if case.kind == "static":
        return ""
    step = f"{case.steps_per_period} per period" if case.step is None else f"{case.step:g}"
    if case.tolerance is not None:
        step += f" or less (within {case.tolerance:g} of the largest pressure)"
    length = "as the history" if case.duration is None else f"{case.duration:g}"
    if case.periods is not None:
        length = f"{case.periods:g} period{'s' * (case.periods != 1)}"
    rise = "" if case.rise_time is None else f", loads rising over {case.rise_time:g}"
    return f"{length}, step {step}, {named_integrator(case.integrator).name}{rise}"
