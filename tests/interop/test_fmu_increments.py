"""The C solver of increments with friction that FMUs carry, on random and adversarial paths."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from fmu_increments import IncrementsInC

from faying.exceptions import ConvergenceError
from faying.export.fmu import archive, library
from faying.simulation.path_steps import follow
from random_friction import (
    INCREMENTS,
    Joints,
    natural_residual,
    small_path,
    solver_of,
    unstressed,
)

pytestmark = pytest.mark.skipif(
    library.compiler() is None, reason="there is no C compiler (apt install gcc)"
)


CONTRADICTORY = (0, 52, 64, 110, 118, 208)
"""Paths on which points of hard contact contradict each other; ours refuses them too."""


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    target = tmp_path_factory.mktemp("increments") / "increments.so"
    source = Path(__file__).parent / "fmu_increments.c"
    options = ("-std=c99", "-O2", "-shared", "-fPIC", f"-I{archive.SOURCES}")
    subprocess.run([library.compiler(), *options, source, "-o", target, "-lm"], check=True)
    return target


def steps_of(solver, relatives):
    """Yield where a path stands before and after each of its increments."""
    here = unstressed(solver)
    for target in relatives:
        before = here
        (here,) = follow(solver, [target], here)
        yield before, here


def test_increments_obey_the_law(compiled):
    """The law is written out again, in Python.

    The whole of it is `python benchmarks/friction_robustness.py 4050` for ours.
    """
    joints, solved = Joints(), 0
    for index in range(60):
        rng = np.random.default_rng(index)
        _, plain, relatives = joints.path(rng) if rng.random() < 0.5 else small_path(rng)
        if index in CONTRADICTORY:
            continue
        solver = IncrementsInC(compiled, plain)
        for before, here in steps_of(solver, relatives):
            halved = here.iterations != here.increment.iterations
            slip = here.slip - here.increment.slack[1:] if halved else before.slip
            # To this increments are solved, or refused.
            assert natural_residual(plain, here, slip) <= 1e-9, index
            solved += 1
        solver.close()
    assert solved == (60 - 2) * INCREMENTS


def test_what_yields_is_solved_as_ours_solves_it(compiled):
    """The last one not without stages; rigid contact may have several solutions."""
    joints, compared = Joints(), 0
    for index in (*range(4, 30), 95):
        rng = np.random.default_rng(index)
        _, plain, relatives = joints.path(rng) if rng.random() < 0.5 else small_path(rng)
        if not plain.yields.all():
            continue
        solver = IncrementsInC(compiled, plain)
        both = [
            [here for _, here in steps_of(one, relatives)] for one in (solver, solver_of(plain))
        ]
        for theirs, ours in zip(*both, strict=True):
            wanted = ours.increment.forces
            apart = np.abs(theirs.increment.forces - wanted).max()
            # To this residual increments may be solved; 8e-11 is measured.
            assert apart <= 1e-9 * np.abs(wanted).max(), index
            compared += 1
        solver.close()
    assert compared == 23 * INCREMENTS


@pytest.mark.parametrize("index", CONTRADICTORY)
def test_what_we_refuse_is_refused(compiled, index):
    """Points of hard contact that are more than the displacements beneath them."""
    rng = np.random.default_rng(index)
    assert rng.random() > 0.5
    _, plain, relatives = small_path(rng)
    solver = IncrementsInC(compiled, plain)
    with pytest.raises(ConvergenceError):
        list(steps_of(solver, relatives))
    solver.close()
