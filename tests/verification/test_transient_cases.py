"""Transients side by side are those one by one."""

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.simulation.stepping import SIDE_BY_SIDE
from small_system import small_system

STEP = 1e-5
SCHEMES = {
    "euler": fy.ImplicitEuler(),
    "alpha": fy.GeneralizedAlpha(0.8),
    "decaying": fy.EnergyDecaying(),
}
FIELDS = ("states", "velocities", "accelerations", "contact_forces", "gap", "inputs", "times")


def loads(count, seed=0):
    rng = np.random.default_rng(seed)
    ramp = np.array([0.0, 20 * STEP, 40 * STEP])
    return [
        fy.Load(
            {"tip.Fz": fy.History(ramp, fz * np.array([0.0, 1.0, 0.3])), "tip.Mx": mx},
            name=f"case-{case}",
        )
        for case, (fz, mx) in enumerate(rng.uniform(-1, 1, (count, 2)) * [500.0, 20e3])
    ]


def check(system, cases, scheme, n_step=40, step=STEP, initial=None):
    options = {"step": step, "duration": n_step * step, "integrator": scheme}
    together = fy.solve_transient_cases(system, cases, initial=initial, **options)
    assert [solution.name for solution in together] == [load.name for load in cases]
    for at, (load, found) in enumerate(zip(cases, together, strict=True)):
        start = None if initial is None else initial[at]
        expected = fy.solve_transient(system, load, initial=start, **options)
        assert found.states.shape == (n_step + 1, system.K.shape[0])
        for name in FIELDS:
            values = getattr(expected, name)
            # Products with a matrix add up in another order than products with a vector; contact
            # magnifies that by displacement over penetration, 1e4.
            np.testing.assert_allclose(
                getattr(found, name),
                values,
                rtol=0,
                atol=1e-10 * np.abs(values).max(),
                err_msg=name,
            )
    return together


@pytest.fixture(scope="module")
def rom(joint, classic):
    return fy.reduce(joint, classic, compliance=True)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_of_a_reduced_model(rom, scheme):
    together = check(rom, loads(5), SCHEMES[scheme])
    assert np.ptp([solution.max_pressure.max() for solution in together]) > 1.0  # they do differ


def test_of_the_full_model(joint):
    check(joint, loads(2), fy.GeneralizedAlpha(0.8), n_step=15)


def test_of_more_cases_than_are_advanced_together(rom):
    check(rom, loads(SIDE_BY_SIDE + 3), fy.ImplicitEuler(), n_step=8)


def test_of_several_preloads(rom):
    forces = (5e3, 10e3, 15e3)
    at_rest = [fy.Load(bolt_forces={"bolt": force}) for force in forces]
    cases = [fy.Load({"tip.Fz": -300.0}, bolt_forces={"bolt": force}) for force in forces]
    initial = [fy.solve_static(rom, load) for load in at_rest]
    together = check(rom, cases, fy.ImplicitEuler(), initial=initial)
    starts = [solution.contact_force()[0] for solution in together]
    assert starts[0] < starts[1] < starts[2]


@pytest.mark.parametrize("scheme", SCHEMES)
def test_of_hard_contact(scheme):
    """Two masses that meet between them: a rigid stop, apart and together by turns."""
    row = np.array([-1.0, 1.0])
    K = np.diag([3.0, 5.0]) + 2.0 * np.outer(row, row)
    system = small_system(
        np.diag([1.0, 2.0]), 0.1 * np.outer(row, row), K, [row], gap=0.05, stiffness=np.inf
    )
    cases = [fy.Load({"mass.Fx": force}, name=str(force)) for force in (-0.3, 0.1, 0.5, 2.0)]
    together = check(system, cases, SCHEMES[scheme], n_step=100, step=0.05)
    closed = together[-1].contact_forces[:, 0] > 0
    assert 0 < np.count_nonzero(closed) < len(closed)


def test_of_an_interface_beyond_the_budget(joint):
    """The form contact takes where dense matrices exceed the budget."""
    system = joint.with_dense_budget(100)
    options = {"step": STEP, "duration": 5 * STEP}
    together = fy.solve_transient_cases(system, loads(2), **options)
    for load, found in zip(loads(2), together, strict=True):
        expected = fy.solve_transient(joint, load, **options)
        largest = expected.contact_forces.max()
        np.testing.assert_allclose(
            found.contact_forces, expected.contact_forces, rtol=0, atol=1e-9 * largest
        )


def test_steps_are_counted_for_all_cases(rom):
    done = []
    fy.solve_transient_cases(rom, loads(3), step=STEP, duration=4 * STEP, progress=done.append)
    assert sum(done) == 3 * 4  # compiled steps of one case come together


def test_nothing_to_do(rom):
    assert fy.solve_transient_cases(rom, [], step=STEP, duration=STEP) == []


def test_refuses_another_number_of_starts(rom):
    start = fy.solve_static(rom)
    with pytest.raises(ModelError, match="3 loads and 2 initial solutions"):
        fy.solve_transient_cases(rom, loads(3), step=STEP, duration=STEP, initial=[start, start])
