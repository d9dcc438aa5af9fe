"""Cycles of a joint with friction: loops, energy over amplitude, and fretting."""

import numpy as np
from matplotlib.axes import Axes

from faying.display.quantities import number, percent, quantity
from faying.display.style import heading, plain
from faying.report.figures.entry import Drawn
from faying.report.figures.surface_map import draw_map, map_panels
from faying.report.style import SLIP_MAP, new_figure
from faying.study.results.path_record import CycleRecord
from faying.study.results.values import CaseResult, Results
from faying.units import Units


def plot_loops(case: CaseResult, axes: Axes, units: Units) -> Axes:
    """Draw the last loop of each amplitude: load factor over the displacement it does work on."""
    for cycle in case.reference.cycles.values():
        factors = np.concatenate([[cycle.amplitude], cycle.increments.factors[:, 0]])
        work = np.concatenate([[cycle.start_work], cycle.increments.load_work])
        label = f"amplitude {number(cycle.amplitude)}"
        axes.plot(work, factors, marker=".", ms=3, label=label)
    axes.set_xlabel(f"load at factor one × displacement along it [{units.of('force·length')}]")
    axes.set_ylabel("load factor")
    axes.legend()
    return axes


def plot_energies(case: CaseResult, axes: Axes, units: Units) -> Axes:
    """Draw the energy per cycle over the amplitude, by slip and as the area of the loop."""
    cycles = list(case.reference.cycles.values())
    amplitudes = [cycle.amplitude for cycle in cycles]
    axes.plot(amplitudes, [cycle.energies[-1] for cycle in cycles], "o-", label="by slip")
    axes.plot(
        amplitudes, [cycle.loop_area for cycle in cycles], "x", ms=8, label="area of the loop"
    )
    if min(cycle.energies[-1] for cycle in cycles) > 0 and len(cycles) > 1:
        axes.set_xscale("log")
        axes.set_yscale("log")
    axes.set_xlabel("amplitude [load factor]")
    axes.set_ylabel(f"energy per cycle [{units.of('force·length')}]")
    axes.legend()
    return axes


def loop_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw the cycles of a case; None for cases without."""
    cycles = case.reference.cycles
    if not cycles:
        return None
    units = results.unit_set
    figure = new_figure(13.0, 5.4)
    left, right = figure.subplots(1, 2)
    plot_loops(case, left, units)
    plot_energies(case, right, units)
    left.set_title("last loop of each amplitude", loc="left")
    right.set_title("energy per cycle", loc="left")
    figure.suptitle(heading(f"{case.name}: cycles, full model"))
    notes = "; ".join(_described(cycle, units) for cycle in cycles.values())
    return Drawn(
        figure=figure,
        stem="loops",
        title=f"{case.name}: loops and energy per cycle",
        caption=(
            "Left: load factor over the displacement that the load does work on, times the load "
            "at factor one, so that the area of a loop is energy. Right: energy per cycle, by "
            "slip and by that area, which come together as increments shrink. "
            f"Amplitude {notes}."
        ),
        section=case.name,
    )


def _described(cycle: CycleRecord, units: Units) -> str:
    """Return amplitude, energy, number of cycles and whether they repeat."""
    energy = quantity(float(cycle.energies[-1]), units.of("force·length"))
    repeats = "" if cycle.stationary else ", still changing"
    return f"{number(cycle.amplitude)}: {energy} after {len(cycle.energies)} cycles{repeats}"


def fretting_figure(results: Results, case: CaseResult) -> Drawn | None:
    """Draw slip range and its product with the traction at the largest amplitude, per point."""
    records = results.rubbing
    cycles = list(case.reference.cycles.values())
    if not cycles or not records or not cycles[-1].fretting.any():
        return None
    units, largest = results.unit_set, cycles[-1]
    fields = (
        (largest.slip_range, f"slip range [{units.length}]"),
        (largest.fretting, f"slip range × traction [{units.of('force/length')}]"),
    )
    figure, rows = map_panels(records.values(), 2, 13.0, 0.7)
    for panels, (name, record) in zip(rows, records.items(), strict=True):
        for axes, (values, text) in zip(panels, fields, strict=True):
            point_values = values[slice(*record.slice)]
            draw_map(
                record,
                np.where(point_values > 0, point_values, np.nan),
                axes,
                units,
                colours=SLIP_MAP,
                limits=(0.0, float(values.max(initial=0.0))),
                label=text,
            )
            axes.set_title(plain(name), loc="left")
    figure.suptitle(
        heading(f"{case.name}: fretting at amplitude {number(largest.amplitude)}, full model")
    )
    worn = _worn(results, largest)
    return Drawn(
        figure=figure,
        stem="fretting",
        title=f"{case.name}: fretting",
        caption=(
            "Left: how far a contact point slips to and fro in a cycle. Right: that times its "
            "largest traction, the parameter of Ruiz, Boddington & Chen 1984 for fretting. Grey "
            f"does not slip. {worn}"
        ),
        section=case.name,
    )


def _worn(results: Results, largest: CycleRecord) -> str:
    weights = np.concatenate([record.weights for record in results.interfaces.values()])
    share = float(weights[largest.slip_range > 0].sum() / weights.sum())
    return f"{percent(share)} of all contact area slips somewhere in the cycle."
