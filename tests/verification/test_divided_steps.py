"""Steps divided until pressures hold a tolerance: what was asked for is reached, and said."""

import logging
import tracemalloc

import h5py
import numpy as np
import pytest

import faying as fy
from faying.exceptions import FormatError, ModelError
from faying.files.flattening import flattened, restored
from faying.simulation.divided_steps import SAFETY, divided_steps
from faying.simulation.path_steps import MOST_DIVISIONS
from faying.simulation.restart import Restart
from faying.simulation.transient_windows import transient_windows

LOAD = {"tip.Fz": -500.0}
PERIOD = 1.6e-3
INSTANTS = 20
STEP = PERIOD / 80
TIMES = {"step": STEP, "duration": INSTANTS * STEP}
SCHEMES = [fy.ImplicitEuler(), fy.GeneralizedAlpha(0.8), fy.EnergyDecaying(0.0)]


def rising(part):
    times = np.linspace(0.0, PERIOD, 801)
    shape = 0.5 - 0.5 * np.cos(np.pi * np.minimum(times / (part * PERIOD), 1.0))
    return fy.Load({name: fy.History(times, value * shape) for name, value in LOAD.items()})


@pytest.fixture(scope="module")
def rom(joint):
    return fy.reduce(joint, fy.craig_bampton(joint, normal_modes=20), compliance=True)


def apart(one, other):
    return np.abs(one - other).max() / other.max()


@pytest.mark.long
@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_tolerance_is_reached(rom, scheme):
    load, options = rising(0.1), {**TIMES, "integrator": scheme}
    parts = 2 * 2**MOST_DIVISIONS
    exact = fy.solve_transient(rom, load, **{**options, "step": STEP / parts}).pressure[::parts]
    assert apart(fy.solve_transient(rom, load, **options).pressure, exact) > 0.01
    for changes in (0.1, 0.03):
        tolerance = SAFETY / scheme.order * changes  # what is said of them
        found = fy.solve_transient(rom, load, **options, tolerance=tolerance)
        assert found.step_error.sum() <= tolerance
        # What the intervals add up to is more than what is left of them at any instant.
        assert apart(found.pressure, exact) < changes
    assert found.substeps.max() > 2
    assert (np.diff(np.log2(found.substeps[1:])) >= -1).all()  # not more than twice as long


@pytest.mark.long
@pytest.mark.parametrize("part", [0.25, 1.0])
def test_what_is_said_is_on_the_safe_side(rom, part):
    """Of implicit Euler 1.9 times the sum of the changes was reached; what is said is 5 times."""
    load, options = rising(part), {**TIMES, "integrator": fy.ImplicitEuler()}
    parts = 2 * 2**MOST_DIVISIONS
    exact = fy.solve_transient(rom, load, **{**options, "step": STEP / parts}).pressure[::parts]
    for tolerance in (0.3, 0.03):
        found = fy.solve_transient(rom, load, **options, tolerance=tolerance)
        assert apart(found.pressure, exact) < found.step_error.sum()


@pytest.mark.long
def test_the_full_model_is_divided_alike(joint, rom):
    load = rising(0.25)
    full, reduced = (
        fy.solve_transient(system, load, **TIMES, tolerance=0.05) for system in (joint, rom)
    )
    assert full.substeps.max() > 1
    # The same steps but where an error is on the verge: what it is of other steps is in both.
    assert np.abs(np.log2(full.substeps[1:] / reduced.substeps[1:])).max() <= 1
    assert apart(reduced.pressure, full.pressure) < 0.05


def test_what_no_division_reaches_is_said(rom):
    found = fy.solve_transient(rom, fy.Load(LOAD), **TIMES, tolerance=1e-6)
    assert found.substeps.max() == 2**MOST_DIVISIONS
    assert found.step_error.sum() > 1e-6


def test_one_step_an_instant_is_the_plain_solution(rom):
    plain = fy.solve_transient(rom, rising(0.25), **TIMES)
    divided = divided_steps(rom, step=STEP, tolerance=1.0)
    given = np.ones(INSTANTS + 1, dtype=int)
    found = divided.solve(rising(0.25), duration=TIMES["duration"], substeps=given)
    for name in ("states", "velocities", "contact_forces", "gap", "inputs"):
        one, other = getattr(found, name), getattr(plain, name)
        # Round-off, of contact solved from another start.
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-9 * np.abs(other).max())
    np.testing.assert_array_equal(found.times, plain.times)
    assert np.isnan(found.step_error[1:]).all()


def test_given_steps_are_those_of_another_run(rom):
    first = fy.solve_transient(rom, rising(0.1), **TIMES, tolerance=0.03)
    divided = divided_steps(rom, step=STEP, tolerance=0.03)
    again = divided.solve(rising(0.1), duration=TIMES["duration"], substeps=first.substeps)
    np.testing.assert_array_equal(again.substeps, first.substeps)
    assert apart(again.pressure, first.pressure) < 1e-9  # round-off


@pytest.mark.long
def test_a_stream_resumes_to_the_bit(rom, tmp_path, monkeypatch):
    options = {**TIMES, "tolerance": 0.02, "integrator": fy.EnergyDecaying(0.0)}
    monkeypatch.setattr("faying.export.transient_stream.STEPS_AT_ONCE", 4)
    whole = fy.stream_transient(rom, rising(0.1), tmp_path / "whole.h5", **options)

    done = []

    def stop(steps):
        done.append(steps)
        if len(done) == 10:
            raise KeyboardInterrupt

    broken = tmp_path / "broken.h5"
    with pytest.raises(KeyboardInterrupt):
        fy.stream_transient(rom, rising(0.1), broken, **options, progress=stop)
    with pytest.raises(FormatError, match="tolerance"):
        fy.stream_transient(rom, rising(0.1), broken, **{**options, "tolerance": 0.5}, resume=True)
    fy.stream_transient(rom, rising(0.1), broken, **options, resume=True)
    with h5py.File(whole) as one, h5py.File(broken) as other:
        for name in ("times", "states", "max_pressure", "substeps", "step_error"):
            np.testing.assert_array_equal(one[name][()], other[name][()])
        found = fy.solve_transient(rom, rising(0.1), **options)
        np.testing.assert_array_equal(one["substeps"][()], found.substeps)


def test_energy_of_rejected_steps_is_no_warning(joint, caplog):
    poor = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=20))
    load = fy.Load({"tip.Mx": -30e3})
    options = {"step": 1e-5, "duration": 3e-4, "integrator": fy.GeneralizedAlpha()}
    with caplog.at_level(logging.WARNING, logger="faying"):
        found = fy.solve_transient(poor, load, **options, tolerance=1.0)
    assert bool(caplog.records) == (found.energy_gain > 0.1)


def test_what_is_between_the_instants_is_not_held(joint):
    divided, load = divided_steps(joint, step=STEP, tolerance=1.0), rising(0.25)

    def most(count):
        tracemalloc.start()
        found = divided.solve(load, duration=count * STEP, substeps=np.full(count + 1, 4))
        _, highest = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert (found.substeps[1:] == 4).all()
        return highest

    most(5)  # imports, and the factors
    instants = 8 * 30 * (3 * joint.structure.n_dof + 2 * joint.contact.n_points)
    # Of 30 instants more each one and all as one, 2.4 times; with the steps between them 5.5.
    assert most(35) - most(5) < 3 * instants


@pytest.mark.parametrize("tolerance", [0.0, -1.0, float("nan")])
def test_tolerances_that_are_none(rom, tolerance):
    with pytest.raises(ModelError, match="give a positive share"):
        fy.solve_transient(rom, fy.Load(LOAD), **TIMES, tolerance=tolerance)


def test_what_is_handed_on_is_kept(rom):
    steps = divided_steps(rom, step=STEP, tolerance=0.02, integrator=fy.EnergyDecaying(0.0))
    pieces = transient_windows(steps, [rising(0.1)], duration=TIMES["duration"], length=7)
    for _, (end,) in pieces:
        again = restored(Restart, flattened(end))
        for name in ("active", "forces", "moved"):
            mine, other = getattr(again.contact, name), getattr(end.contact, name)
            np.testing.assert_array_equal(mine, other)
