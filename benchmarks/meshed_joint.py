"""A joint from a mesher, in units of one plain factorization of its stiffness matrix.

    python benchmarks/meshed_joint.py STUDY.toml
    python benchmarks/meshed_joint.py STUDY.toml --friction 0.15 --steps 10
    python benchmarks/meshed_joint.py STUDY.toml --friction 0.15 --backbone 0.2 2000 12

takes a study whose model is a mesh with bolts, and its first load case of constant forces, and
prints a table: preparing contact, tightening and static cases without friction, then increments
with that of the study, or the one that is given, by the share of closed area that slips; or
backbones of the first modes between two energies. Processor time of one thread, medians of three
where a stage takes below ten seconds. Run it with OMP_NUM_THREADS=1.
"""

import argparse
import gc
import os
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np

import faying as fy
from faying.assessment.modal_analysis import modal_analysis
from faying.assessment.slip import slip_states
from faying.linalg.factorization import factorize
from faying.simulation.static import AT_REST
from faying.study.inputs.load_model import build_loaded, load_model
from faying.study.inputs.loads import case_load
from faying.study.keys.schema import read_study

Result = TypeVar("Result")

LONG = 10.0
"""Seconds from which a stage is run once."""

FULL = 20
"""Loads that grow to the nominal one."""


class Table:
    """Prints stages over the first one."""

    def __init__(self) -> None:
        self.unit = 0.0

    def stage(self, name: str, compute: Callable[[], Result], *, times: int = 3) -> Result:
        """Run a stage, print its processor time and peak memory, and return what it computes."""
        spent: list[float] = []
        while True:
            start = time.process_time()
            result = compute()
            spent.append(time.process_time() - start)
            if len(spent) == times or spent[-1] > LONG:
                break
            # A structure and what is between its pairs hold each other until they are searched for.
            del result
            gc.collect()
        self.unit = self.unit or float(np.median(spent))
        self.line(name, float(np.median(spent)))
        return result

    def line(self, name: str, seconds: float, remark: str = "") -> None:
        """Print one line."""
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
        ratio = seconds / self.unit
        sys.stdout.write(f"| {name} | {seconds:.3f} | {ratio:.2f} | {peak:.2f} | {remark} |\n")
        sys.stdout.flush()


def fresh(model: fy.Model) -> fy.Model:
    """Return a model that remembers nothing of contact."""
    return replace(model, structure=replace(model.structure))


def prepared(model: fy.Model) -> fy.Model:
    """Return a model whose contact is prepared."""
    model = fresh(model)
    _ = model.static_contact.increments
    return model


def main() -> None:
    """Print the table."""
    options = parse()
    study = read_study(options.study)
    loaded = load_model(study)
    model = build_loaded(loaded)
    if options.budget:
        model = model.with_dense_budget(int(options.budget))
    load = next(case_load(case) for case in study.load_cases if case.forces)
    forces = {bolt.name: float(bolt.preload) for bolt in study.bolts}
    sys.stdout.write(
        f"{options.study.name}: {model.K.shape[0]} dofs, {model.contact.n_points} points, "
        f"{len(forces)} bolts; load average {os.getloadavg()[0]:.1f}\n\n"
        "| stage | processor s | over one factorization | peak GiB | |\n|---|---|---|---|---|\n"
    )
    table = Table()
    table.stage("factorization of K", lambda: factorize(model.K))
    rubbing = model if options.friction is None else model.with_friction(options.friction)
    smooth = table.stage("contact prepared", lambda: prepared(model.with_friction(0.0)))
    relative = smooth.contact.relative_operator.shape[0]
    tight = table.stage(f"tightening, {relative} rows", lambda: fy.preload(smooth, forces))
    table.stage("static case, cold", lambda: fy.solve_static(tight, load))
    growing = [load.scaled((n + 1) / FULL) for n in range(FULL)]
    start = time.process_time()
    fy.solve_static_cases(tight, growing)
    table.line("static case, warm", (time.process_time() - start) / FULL, f"{FULL} loads")
    if rubbing.contact.rubbing_interfaces:
        locked = {bolt.name: bolt.initial_force for bolt in tight.bolts.values()}
        rubbing = fresh(rubbing.with_bolt_forces(locked))
        del smooth, tight  # with their matrices between pairs
        if options.backbone:
            vibrate(table, rubbing, options.modes, options.increments, *options.backbone)
        else:
            rub(table, rubbing, load, options.steps, options.factor)


def rub(table: Table, rubbing: fy.Model, load: fy.Load, steps: int, factor: float) -> None:
    """Print the stages with friction."""
    largest = rubbing.contact.coefficients.max()
    rubbing = table.stage(f"contact prepared, friction {largest:g}", lambda: prepared(rubbing))
    state = table.stage("preload in one increment", lambda: fy.solve_path(rubbing, [AT_REST]))
    tell(table, "preload in one increment", 0.0, state)
    for n in range(steps):
        start = time.process_time()
        part = factor * (n + 1) / steps
        before, state = state, fy.solve_path(rubbing, [load.scaled(part)], state)
        tell(table, f"increment to {part:.2f}", time.process_time() - start, state, before)


def vibrate(
    table: Table,
    rubbing: fy.Model,
    modes: list[int],
    increments: int,
    least: float,
    most: float,
    count: float,
) -> None:
    """Print what each energy of each mode takes, and what came of it."""
    rubbing = table.stage("contact prepared", lambda: prepared(rubbing), times=1)
    rest = table.stage("preload", lambda: fy.solve_path(rubbing, [AT_REST]), times=1)
    levels, begun = np.geomspace(least, most, int(count)), time.process_time()
    for mode in modes:
        analysis = table.stage(
            f"mode {mode} prepared",
            lambda mode=mode: modal_analysis(
                rubbing, mode, levels, over="energy", initial=rest, increments=increments
            ),
            times=1,
        )
        for number, level in enumerate(levels):
            start = time.process_time()
            cycle = analysis.cycle(number)
            spent = time.process_time() - start
            curve = analysis.backbone([cycle])
            table.line(
                f"mode {mode}, energy {level:.3g}",
                spent,
                f"{cycle.cycles} cycles of {increments}, {spent / (cycle.cycles + 0.25):.2f} s each"
                f"; {curve.amplitude[0]:.4g} at {curve.measured_at}, {curve.frequency[0]:.2f} Hz, "
                f"damping {curve.damping_ratio[0]:.4%}, {curve.energy_difference[0]:+.1%} by loop, "
                f"{1 - curve.stick_share[0]:.0%} slips",
            )
    table.line("backbones", time.process_time() - begun)


def tell(
    table: Table,
    name: str,
    seconds: float,
    state: fy.Solution,
    before: fy.Solution | None = None,
) -> None:
    """Print an increment with what slips in it."""
    states = slip_states(state, before)
    slips = f"{states.slip_of_closed[-1]:.0%} of closed area slips"
    table.line(name, seconds, f"{slips}, {int(state.iterations[-1])} Newton steps")


def parse() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", type=Path)
    parser.add_argument("--friction", type=float, help="of all interfaces")
    parser.add_argument("--budget", type=float, help="dense budget [bytes]")
    parser.add_argument("--steps", type=int, default=5)
    parser.add_argument("--factor", type=float, default=1.0)
    parser.add_argument("--backbone", type=float, nargs=3, metavar=("LEAST", "MOST", "COUNT"))
    parser.add_argument("--modes", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--increments", type=int, default=20, help="of a cycle")
    return parser.parse_args()


if __name__ == "__main__":
    main()
