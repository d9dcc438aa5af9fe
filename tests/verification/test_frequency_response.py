"""Responses by harmonics: linear limit, derivatives, folds, energy."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from test_backbone import DAMPER, LIMIT, MASS, SLIDER, SPRING, mass_on_a_slider

import faying as fy
from faying.assessment.forced_joint import MORE, ForcedJoint, Released
from faying.assessment.resonance import steady_state
from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.contact.laws import Coulomb, Penalty
from faying.exceptions import ModelError
from faying.model.boundary import Boundary
from faying.simulation.periodic import PeriodicProblem
from lap_joints import tiny_lap
from small_system import SmallSystem


@pytest.fixture(scope="module")
def slider():
    return mass_on_a_slider()


@pytest.fixture(scope="module")
def lap():
    model = tiny_lap(penalty=1e6, damping=fy.Rayleigh(alpha=50.0))
    rubbing = model.with_bolt_forces({"bolt": 8e3}).with_friction(0.2)
    return fy.reduce(rubbing, fy.craig_bampton(rubbing, normal_modes=15), compliance=True)


def test_where_nothing_slips_it_is_the_linear_response(slider):
    load, frequencies = {"mass.Fx": 1 + 1j}, [2.8, 3.1, 3.2, 3.6]
    found = fy.frequency_response(slider, load, frequencies, [1e-3], harmonics=3, samples=48)
    curve = found.curves[0]
    assert curve.missed == ()
    circular = 2 * np.pi * curve.frequency
    expected = 1e-3 * (1 + 1j) / (SPRING + SLIDER - MASS * circular**2 + 1j * DAMPER * circular)
    # Newton's method stops where the next step is 1e-9.
    np.testing.assert_allclose(curve.response("mass.ux"), expected, rtol=1e-8)
    assert set(frequencies) <= set(curve.frequency.round(12))
    assert curve.contact is not None
    assert (curve.contact.friction_energy == 0).all()
    assert (curve.contact.slip_share == 0).all()
    np.testing.assert_allclose(curve.contact.imbalance, 0, atol=1e-8)


@pytest.mark.long
@pytest.mark.parametrize(
    ("motion_size", "length", "closing", "tolerance"),
    # Single precision leaves 8e-5 of the large motion; it was 1e-2 where the slip of points that
    # were open at rest was taken to stay.
    [(5e-7, 1e-10, 0, 3e-5), (3e-4, 1e-8, 5, 3e-4)],
)
def test_derivatives_are_those_of_the_path(lap, motion_size, length, closing, tolerance):
    """Through slip, opening, closing and both periods; also by the frequency."""
    rest = fy.solve_path(lap, [fy.Load()])
    forced = ForcedJoint.of(lap, {"tip.Fz": 1.0, "tip.Fy": 0.5j}, rest, np.array([600.0]))
    points, loads = np.flatnonzero(forced.stuck.forces[0] >= 0), forced.loads(2, Released())
    pairs = np.ones((3, loads.n_mode), dtype=bool)
    pairs[2, 0] = False
    problem = PeriodicProblem.of(
        forced.stuck,
        points,
        loads,
        level=20.0,
        pairs=pairs,
        samples=24,
    )
    circular, size = 2 * np.pi * 600.0, problem.size
    random = np.random.default_rng(1)
    x = random.standard_normal(size) * motion_size
    motion = problem.follow(x, circular)
    assert motion.path.dissipation.sum() > 0
    open_at_rest = forced.stuck.forces[0] == 0
    assert (motion.path.forces[:, 0, open_at_rest] > 0).any(axis=0).sum() == closing
    slopes = problem.derivatives(motion).residual
    change = random.standard_normal(size)
    ahead, behind = (
        problem.residual(problem.follow(x + sign * length * change, circular)) for sign in (1, -1)
    )
    expected = (ahead - behind) / (2 * length)
    # Central differences over 1e-10 of what is solved to 1e-12 of forces: 3e-6 was seen.
    size_of = np.abs(expected).max()
    np.testing.assert_allclose(slopes[:, :-1] @ change, expected, atol=tolerance * size_of)
    length = 1e-5 * circular
    ahead, behind = (
        problem.residual(problem.follow(x, circular + sign * length)) for sign in (1, -1)
    )
    expected = (ahead - behind) / (2 * length)
    np.testing.assert_allclose(slopes[:, -1], expected, atol=1e-3 * np.abs(expected).max())


def pressed_mass():
    """A mass that is pressed onto a spring of 500 by 5, beside a spring of its own."""
    contact = Contact(
        relative_operator=np.array([[1.0]]),
        interpolation=sp.csr_array([[1.0]]),
        initial_gap=np.array([-5.0 * (1 / 500.0 + 1 / SPRING)]),
        weights=np.ones(1),
        laws={"stop": Penalty(500.0)},
        slices={"stop": slice(0, 1)},
    )
    end = Boundary(name="mass", nodes=[0], components=[0], dofs=[0])
    return SmallSystem(
        M=np.array([[MASS]]),
        C=np.array([[0.8]]),
        K=np.array([[SPRING]]),
        contact=contact,
        boundaries={"mass": end},
    )


@pytest.mark.slow
def test_a_joint_that_opens_folds_and_is_followed_past_its_turning_points():
    found = fy.frequency_response(
        pressed_mass(), {"mass.Fx": 1.0}, np.linspace(2.0, 3.6, 9), [0.8], harmonics=3, samples=96
    )
    curve = found.curves[0]
    assert curve.missed == ()
    assert curve.frequency[-1] == pytest.approx(3.6)
    assert (np.diff(curve.frequency) < 0).any()
    up, down = curve.swept_up, curve.swept_down
    assert not up.all()
    highest_up = np.abs(curve.response("mass.ux")[up]).max()
    highest_down = np.abs(curve.response("mass.ux")[down]).max()
    assert highest_down > 1.2 * highest_up
    # The balance closes on every branch, to the samples: 0.4 % with 96, up to 2.2 % with 48.
    np.testing.assert_allclose(curve.contact.imbalance, 0, atol=0.01)
    assert curve.contact.open_share.max() == 1.0


@pytest.mark.long
def test_a_lap_joint_balances(lap):
    curve = fy.frequency_response(
        lap, {"tip.Fz": 1.0}, [600.0], [30.0], harmonics=2, samples=32
    ).curves[0]
    # 32 samples a period: backward Euler takes 1 % more or less.
    assert abs(curve.contact.imbalance[0]) < 0.02
    assert curve.contact.friction_energy[0] > 0.05 * curve.contact.load_work[0]
    assert 0 < curve.contact.slip_share[0] <= 1
    assert curve.contact.bolt_force_range.shape == (1, 1)
    assert curve.contact.peak_pressure[0] > 0
    assert 0 <= curve.contact.stick_share[0] < 1


@pytest.mark.long
def test_a_slow_period_is_that_of_a_path(lap):
    """Pressures, bolt force and bending where inertia takes no part; also those that bases lack."""
    rest, force = fy.solve_path(lap, [fy.Load()]), 60.0
    forced = ForcedJoint.of(lap, {"tip.Fz": 1.0}, rest, np.array([0.5]))
    (period,) = forced.curve(force, harmonics=3, samples=32).periods.values()
    loads = [fy.Load({"tip.Fz": x}) for x in force * np.cos(2 * np.pi * np.arange(1, 65) / 32)]
    path = fy.solve_path(lap, loads, initial=rest)
    # Harmonics past the third are held: 0.2 % of the range of forces and moments with one.
    for found, expected in (
        (period.pressure, path.pressure[-32:]),
        (period.bolt_forces["bolt"], path.bolt_force("bolt")[-32:]),
        (period.bolt_moments["bolt"], path.bolt_bending("bolt")[-32:]),
    ):
        np.testing.assert_allclose(found, expected, atol=2e-3 * np.ptp(expected, axis=0).max())


@pytest.mark.long
def test_the_deviation_is_what_more_harmonics_change(slider):
    """Exact where it is largest, and of the right order elsewhere."""
    load, asked = {"mass.Fx": 1.0}, [2.2, 2.6]
    (curve,) = fy.frequency_response(slider, load, asked, [8.0], tolerance=0.5).curves
    more = curve.harmonics.shape[1] - 1 + MORE
    (finer,) = fy.frequency_response(slider, load, asked, [8.0], harmonics=more).curves
    rows, others = (
        [int(np.abs(one.frequency - target).argmin()) for target in asked] for one in (curve, finer)
    )
    moved = curve.response("mass.ux")[rows]
    changes = np.abs(finer.response("mass.ux")[others] - moved) / np.abs(moved)
    told = curve.deviation[rows]
    worst = int(np.argmax(told))
    assert told[worst] == pytest.approx(changes[worst], rel=1e-3)
    assert (changes > 1e-4).all()
    assert (changes < 5 * told).all()


@settings(max_examples=10, deadline=None)
@given(
    frequencies=st.lists(st.integers(1, 80), min_size=3, max_size=3, unique=True).map(sorted),
    order=st.integers(1, 5),
)
def test_a_range_follows_all_that_its_frequencies_alone_do(slider, frequencies, order):
    rest, asked = fy.solve_path(slider, [fy.Load()]), np.array(frequencies) / 10

    def followed(chosen):
        forced = ForcedJoint.of(slider, {"mass.Fx": 1.0}, rest, chosen)
        return forced._problem(1.0, order, None, Released()).pairs

    together = followed(asked)
    for one in asked:
        alone = followed(np.array([one]))
        harmonics, modes = alone.shape
        assert together[:harmonics, :modes][alone].all()


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"frequencies": [2.0, 1.0]}, "give rising positive numbers"),
        ({"levels": [0.0]}, "give positive numbers"),
        ({"harmonics": 0}, "give one or more"),
        ({"harmonics": 5, "samples": 8}, "four for each harmonic"),
        ({"tolerance": 1.0}, "between 0 and 1"),
    ],
)
def test_what_is_refused(slider, change, text):
    arguments = {"frequencies": [1.0, 2.0], "levels": [1.0], **change}
    with pytest.raises(ModelError, match=text):
        fy.frequency_response(slider, {"mass.Fx": 1.0}, **arguments)


@pytest.mark.long
def test_points_off_their_springs_go_the_way_of_all_paths(lap):
    """Slip, opening and both periods, beside increments between the pairs by their own solver."""
    rest = fy.solve_path(lap, [fy.Load()])
    forced = ForcedJoint.of(lap, {"tip.Fz": 1.0}, rest, np.array([600.0]))
    loads = forced.loads(1, Released())
    problem = PeriodicProblem.of(
        forced.stuck,
        np.arange(lap.contact.n_points),
        loads,
        level=30.0,
        pairs=np.ones((2, loads.n_mode), dtype=bool),
        samples=12,
    )
    x, circular = np.full(problem.size, 2e-6), 2 * np.pi * 600.0
    path = problem.follow(x, circular).path
    assert path.dissipation.sum() > 0
    assert (path.forces[:, 0] == 0).any()
    local, T = problem.local, problem.stuck.between(problem.local.pairs, problem.local.pairs)
    springs = local.rows.T @ sp.diags_array(local.springs.ravel()) @ local.rows
    free = np.linalg.solve(np.eye(len(T)) - T @ springs, T)
    solver = CondensedContact(contact=local.contact, compliance=(free + free.T) / 2).increments
    columns = np.tile(problem._columns(problem.unpacked(x), circular), (2, 1))
    moved = columns @ problem.loads.restrained[local.pairs, : columns.shape[1]].T
    slip = local.slip
    for number, stuck in enumerate(moved):
        pressed = springs @ stuck - local.rows.T @ local.forces.ravel()
        relative = problem.stuck.moved[local.pairs] + stuck + free @ pressed
        found = solver.solve(relative, local.contact.offset(slip))
        # Both solve increments to 1e-9 of the largest force and better.
        size = path.forces.max()
        np.testing.assert_allclose(path.forces[number], found.forces, atol=1e-8 * size)
        expected = pytest.approx(found.dissipation, rel=1e-6, abs=1e-9)
        assert path.dissipation[number] == expected
        slip = slip + found.slack[1:]


def test_frequencies_that_an_arc_passes_are_landed_on(slider):
    """Damped so little that arcs between the frequencies end beyond some of them."""
    asked = np.linspace(3.0, 3.4, 6)
    curve = fy.frequency_response(
        slider, {"mass.Fx": 1.0}, asked, [1e-3], harmonics=1, samples=16
    ).curves[0]
    assert curve.missed == ()
    assert set(asked.round(9)) <= set(curve.frequency.round(9))
    assert curve.frequency[-1] == pytest.approx(3.4)


def test_gross_slip_is_said(slider):
    found = fy.frequency_response(slider, {"mass.Fx": 1.0}, [2.4], [12.0], harmonics=1, samples=16)
    assert any("all that is closed on an interface slips at once" in text for text in found.remarks)


@pytest.mark.slow
def test_a_transient_settles_at_the_linear_response(slider):
    """400 steps make periods 2e-5 too long, which is 1e-3 here at most, and 2e-3 may be to come."""
    damper = 8.0
    damped = replace(slider, C=np.diag([damper, 0, 0]))
    told = []
    settled = steady_state(damped, {"mass.Fx": 1.0}, 1e-3, 3.0, progress=told.append)
    assert len(told) > 1
    assert sum(told) == settled.periods
    circular = 6 * np.pi
    expected = 1e-3 / (SPRING + SLIDER - MASS * circular**2 + 1j * damper * circular)
    found = settled.fundamental[settled.components.index("mass.ux")]
    assert abs(found - expected) < 3e-3 * abs(expected)
    assert settled.to_come < 2e-3


def rubbing_mass(slider, stiffness):
    """The mass on a slider of another stiffness, undamped."""
    law = Coulomb(Penalty(1e3), LIMIT / 20.0, stiffness)
    contact = replace(slider.contact, laws={"slider": law})
    return replace(slider, C=np.zeros((3, 3)), contact=contact)


def largest(system, force, ratio, harmonics, samples):
    """Amplitude of the sliding mass driven at a ratio to its frequency without friction."""
    frequency = ratio * np.sqrt(SPRING / MASS) / (2 * np.pi)
    curve = fy.frequency_response(
        system, {"mass.Fx": 1.0}, [frequency], [force], harmonics=harmonics, samples=samples
    ).curves[0]
    angles = np.outer(np.arange(harmonics + 1), np.linspace(0, 2 * np.pi, 2001))
    return np.abs(
        (curve.harmonics[0, :, curve.components.index("mass.ux")] @ np.exp(1j * angles)).real
    ).max()


@pytest.mark.long
@pytest.mark.parametrize("ratio", [0.7, 0.9])
def test_a_mass_that_slides_keeps_its_inertia(slider, ratio):
    """Beside steps in time; harmonics past the ninth are 0.5 % of the amplitude."""
    stiffness, force = 1e4, 15.0
    found = largest(rubbing_mass(slider, stiffness), force, ratio, harmonics=9, samples=256)
    steps, x, v, slip, path = 1000, force / SPRING, 0.0, 0.0, []
    step = 2 * np.pi / (ratio * np.sqrt(SPRING / MASS) * steps)
    for driven in force * np.cos(2 * np.pi * np.arange(60 * steps) / steps):
        slip = min(max(slip, x - LIMIT / stiffness), x + LIMIT / stiffness)
        v += step * (driven - SPRING * x - stiffness * (x - slip)) / MASS
        x += step * v
        path.append(x)
    assert found == pytest.approx(np.ptp(path[-steps:]) / 2, rel=0.007)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ratio", "harmonics"),
    # Velocity has corners, which harmonics round, so that it reverses late: 0.28, 0.18 and 0.09 %
    # with 9, 15 and 35 of them at 0.7, for any samples; 0.05 % with 15 at 0.9.
    [(0.9, 15), (0.7, 35)],
)
def test_rigid_friction_is_den_hartogs(slider, ratio, harmonics):
    """J. P. den Hartog, Trans. ASME 53 (1931) APM-107: motion without stops."""
    force = 5 * LIMIT
    found = largest(rubbing_mass(slider, 1e9), force, ratio, harmonics=harmonics, samples=2048)
    free = 1 / (1 - ratio**2)
    turned = np.sin(np.pi / ratio) / (ratio * (1 + np.cos(np.pi / ratio)))
    expected = force / SPRING * np.sqrt(free**2 - (LIMIT / force * turned) ** 2)
    assert found == pytest.approx(expected, rel=1e-3)
