"""Contact laws at single points, where every branch has its figures."""

from dataclasses import FrozenInstanceError, fields

import numpy as np
import pytest

from faying.contact.laws import (
    CLOSURES,
    LAWS,
    Coulomb,
    ExponentialClosure,
    Hard,
    Penalty,
    PowerClosure,
    TableClosure,
)
from faying.contact.laws.coulomb import LARGEST_FRICTION, automatic_tangential_penalty
from faying.exceptions import ModelError

WEIGHTS = np.array([0.5, 4.0])
RUBBING = Coulomb(Penalty(10.0), 0.5, 40.0)
CURVES = [
    TableClosure((-0.2, 0.1, 0.5), (0.0, 1.0, 4.0)),
    ExponentialClosure(2.0, 0.3),
    PowerClosure(2.0, 0.4, 2.5),
    PowerClosure(2.0, 0.4, 1.0),
]
YIELDING = [Penalty(10.0), RUBBING, *CURVES, *(Coulomb(one, 0.5, 40.0) for one in CURVES)]


@pytest.mark.parametrize("law", [Penalty(10.0), Hard()])
def test_without_friction_contact_presses_and_does_nothing_else(law):
    forces = np.array([[3.0, 0.0, -2.0]])
    assert (law.components, law.friction, law.proportional) == (1, 0.0, True)
    np.testing.assert_array_equal(law.admissible(forces), [[3.0, 0.0, 0.0]])
    # A point without force is open: neither sign of its slack then moves the solution.
    np.testing.assert_array_equal(law.derivative(forces)[:, 0, 0], [1.0, 0.0, 0.0])


def test_closures_are_forces_over_stiffness_and_area():
    forces = np.array([[20.0, 20.0], [4.0, -8.0], [0.0, 16.0]])
    closed, compliance = Penalty(10.0).closure(forces[:1], WEIGHTS)
    np.testing.assert_allclose(closed, [[4.0, 0.5]], rtol=1e-15)
    np.testing.assert_allclose(compliance, [[0.2, 0.025]], rtol=1e-15)
    closed, compliance = RUBBING.closure(forces, WEIGHTS)
    np.testing.assert_allclose(closed, [[4.0, 0.5], [0.2, -0.05], [0.0, 0.1]], rtol=1e-15)
    np.testing.assert_allclose(compliance, [[0.2, 0.025], [0.05, 0.00625], [0.05, 0.00625]])
    for hard in Hard().closure(forces[:1], WEIGHTS):
        np.testing.assert_array_equal(hard, np.zeros((1, 2)))
    rigid = Coulomb(Hard(), 0.5, np.inf).closure(forces, WEIGHTS)
    for none in rigid:
        np.testing.assert_array_equal(none, np.zeros((3, 2)))


def test_coulomb_cuts_what_exceeds_friction():
    # Sticks, slips along (3, 4), at its limit, open, pressed without pull.
    forces = np.array(
        [[10.0, 10.0, 10.0, -1.0, 6.0], [3.0, 6.0, 3.0, 2.0, 0.0], [0.0, 8.0, 4.0, 0.0, 0.0]]
    )
    expected = [[10.0, 10.0, 10.0, 0.0, 6.0], [3.0, 3.0, 3.0, 0.0, 0.0], [0.0, 4.0, 4.0, 0.0, 0.0]]
    np.testing.assert_allclose(RUBBING.admissible(forces), expected, rtol=1e-15)


def test_derivatives_where_points_stick_slip_and_open():
    forces = np.array([[10.0, 10.0, -1.0], [3.0, 6.0, 2.0], [0.0, 8.0, 0.0]])
    stick, slip, opened = RUBBING.derivative(forces)
    np.testing.assert_array_equal(stick, np.eye(3))
    # n = (0.6, 0.8), μ λ_n = 5 of |λ_t| = 10.
    turning = 0.5 * np.array([[1 - 0.36, -0.48], [-0.48, 1 - 0.64]])
    expected = np.zeros((3, 3))
    expected[0, 0], expected[1:, 0], expected[1:, 1:] = 1.0, [0.3, 0.4], turning
    np.testing.assert_allclose(slip, expected, rtol=1e-14)
    np.testing.assert_array_equal(opened, np.zeros((3, 3)))


def test_nothing_sticks_where_nothing_holds():
    unloaded = np.array([[0.0], [0.0], [0.0]])
    np.testing.assert_array_equal(RUBBING.derivative(unloaded)[0], np.zeros((3, 3)))
    smooth = Coulomb(Penalty(10.0), 0.0, 40.0)
    pressed = np.array([[5.0], [0.0], [0.0]])
    np.testing.assert_array_equal(smooth.derivative(pressed)[0], np.diag([1.0, 0.0, 0.0]))


@pytest.mark.parametrize("stiffness", [0.0, -1.0, np.inf, np.nan])
def test_a_penalty_is_a_positive_number(stiffness):
    with pytest.raises(ModelError, match="give a positive number, 'auto' or 'hard'"):
        Penalty(stiffness)
    assert Penalty(0.5).penalty == 0.5  # of any size


def test_the_ends_of_the_ranges_of_friction():
    assert Coulomb(Hard(), 0.0, 0.5).friction == 0.0
    assert Coulomb(Hard(), LARGEST_FRICTION, 0.5).friction == LARGEST_FRICTION == 10.0
    with pytest.raises(ModelError, match=r"coefficient of friction is 10\.1; give a number from 0"):
        Coulomb(Hard(), 10.1, 0.5)
    with pytest.raises(ModelError, match=r"coefficient of friction is -0\.1; give a number from 0"):
        Coulomb(Penalty(1e5), -0.1, 1e5)
    with pytest.raises(ModelError, match="tangential penalty is 0; give a positive number"):
        Coulomb(Hard(), 0.5, 0.0)


@pytest.mark.parametrize(
    ("poissons_ratio", "share"), [(0.0, 1.0), (0.3, 14 / 17), (0.5, 2 / 3), (-1.0, 4 / 3)]
)
def test_sticking_is_as_stiff_as_mindlins_spheres(poissons_ratio, share):
    """2 (1 − ν)/(2 − ν): as stiff as normal contact at ν = 0, two thirds where volume is kept."""
    found = automatic_tangential_penalty(8.0, poissons_ratio)
    assert found == pytest.approx(8.0 * share, rel=1e-15)  # round-off


@pytest.mark.parametrize("law", [Hard(), *YIELDING])
def test_laws_do_not_change(law):
    for field in fields(law):
        with pytest.raises(FrozenInstanceError):
            setattr(law, field.name, 1.0)
    with pytest.raises(FrozenInstanceError):
        law.colour = "red"


MOVED = np.random.default_rng(3).standard_normal((3, 400)) * [[1.0], [0.3], [0.3]]
AREAS = np.random.default_rng(4).uniform(0.5, 2.0, 400)


@pytest.mark.parametrize("law", YIELDING)
@pytest.mark.parametrize("small", [1.0, 1e-2])  # which sticks before surfaces meet, too
def test_responses_are_the_forces_of_admissible_and_closure(law, small):
    """λ = admissible(λ − r (moved + c(λ))), (F1), at open, sticking and slipping points."""
    moved = (MOVED * [[1.0], [small], [small]])[: law.components]
    forces, _ = law.respond(moved, AREAS)
    slack = moved + law.closure(forces, AREAS)[0]
    again = law.admissible(forces - 7.0 * slack)
    np.testing.assert_allclose(again, forces, rtol=0, atol=1e-14 * forces.max())  # round-off
    assert (forces[0] > 0).any()


@pytest.mark.parametrize("law", YIELDING)
def test_stiffnesses_are_the_derivatives_of_responses(law):
    moved = MOVED[: law.components]
    way = np.random.default_rng(5).standard_normal(moved.shape)
    ends = [law.respond(moved + h * way, AREAS)[0] for h in (1e-7, -1e-7)]
    stiffness = law.respond(moved, AREAS)[1]
    found = -np.einsum("pij,jp->ip", stiffness, way)
    # Round-off of the differences, 1e-16/1e-7 of forces; no point lies within 1e-7 of a kink.
    largest = np.abs(ends[0]).max()
    np.testing.assert_allclose(found, (ends[0] - ends[1]) / 2e-7, rtol=0, atol=1e-8 * largest)


def test_newtons_method_begins_closed_and_sticking():
    zero = np.zeros((3, 2))
    forces, stiffness = RUBBING.respond(zero, WEIGHTS)
    np.testing.assert_array_equal(forces, zero)
    np.testing.assert_array_equal(stiffness, [np.diag([10.0, 40.0, 40.0]) * w for w in WEIGHTS])
    smooth = Coulomb(Penalty(10.0), 0.0, 40.0).respond(zero, WEIGHTS)[1]
    np.testing.assert_array_equal(smooth[:, 1:, 1:], 0.0)  # nothing to hold on by


@pytest.mark.parametrize("law", [Hard(), Coulomb(Penalty(10.0), 0.5, np.inf)])
def test_what_does_not_yield_has_no_response(law):
    assert not law.yields
    with pytest.raises(ModelError, match="do not follow from displacements; give a penalty"):
        law.respond(np.zeros((law.components, 2)), WEIGHTS)


@pytest.mark.parametrize("curve", CURVES)
def test_closures_and_pressures_of_a_curve_are_inverse(curve):
    closure = np.linspace(-1.0, 4.0, 997)
    pressure, slope = curve.pressure_of(closure)
    assert (np.diff(pressure) >= 0).all()
    assert (pressure >= 0).all()
    closed = pressure > 0
    again, flatness = curve.closure_of(pressure[closed])
    np.testing.assert_allclose(again, closure[closed], rtol=0, atol=1e-13)  # round-off of 4
    np.testing.assert_allclose(flatness * slope[closed], 1.0, rtol=1e-9)  # round-off near s = 0
    ends = [curve.pressure_of(closure + h)[0] for h in (1e-6, -1e-6)]
    smooth = np.abs(closure - curve.closure_of(np.zeros(1))[0]) > 1e-5
    differences = (ends[0] - ends[1]) / 2e-6
    # Second differences, 1e-6 of slopes; no closure lies within 1e-6 of a kink.
    np.testing.assert_allclose(slope[smooth], differences[smooth], rtol=1e-6, atol=1e-6)


def test_curves_pass_through_what_they_are_given_by():
    table, exponential, power = CURVES[:3]
    np.testing.assert_allclose(
        table.pressure_of(np.array([-0.3, -0.05, 0.1, 0.3, 0.7]))[0],
        [0.0, 0.5, 1.0, 2.5, 5.5],
        rtol=1e-15,
    )  # its last slope, 7.5, goes on
    np.testing.assert_allclose(
        exponential.pressure_of(np.array([-0.4, -0.3, 0.0, 0.3]))[0],
        [0.0, 0.0, 2.0, 4 * np.expm1(2.0) / np.expm1(1.0)],
        rtol=1e-15,
    )
    np.testing.assert_allclose(
        power.pressure_of(np.array([-0.1, 0.4, 0.8]))[0], [0.0, 2.0, 2.0 * 2**2.5], rtol=1e-15
    )
    # Far beyond, steps of Newton's method meet numbers.
    assert np.isfinite(exponential.pressure_of(np.array([1e6]))[0]).all()
    assert table.stiffness == pytest.approx(7.5, rel=1e-15)
    slope = 2.0 / 0.3 * (2 * np.e - 1) / (np.e - 1)
    assert exponential.stiffness == pytest.approx(slope, rel=1e-14)
    assert power.stiffness == pytest.approx(2.5 * 2.0 / 0.4, rel=1e-15)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ExponentialClosure(0.0, 1.0), "'exponential': pressure is 0; give a positive"),
        (lambda: ExponentialClosure(1.0, np.nan), "'exponential': clearance is nan; give a pos"),
        (lambda: PowerClosure(1.0, -2.0, 2.0), "'power': depth is -2; give a positive"),
        (lambda: PowerClosure(1.0, 1.0, 0.5), r"exponent is 0\.5; give one or more \(of"),
        (lambda: TableClosure((0.0,), (0.0,)), "1 closures and 1 pressures; give two rows"),
        (lambda: TableClosure((0.0, 1.0), (0.0,)), "2 closures and 1 pressures; give two"),
        (lambda: TableClosure((0.0, 1.0), (0.1, 2.0)), r"first pressure is 0\.1; begin with"),
        (
            lambda: TableClosure((0.0, 1.0, 1.0), (0.0, 2.0, 3.0)),
            "after closure 1 with pressure 2 comes 1 with 3; both must rise",
        ),
        (lambda: TableClosure((0.0, np.nan), (0.0, 2.0)), "comes nan with 2; both must rise"),
    ],
)
def test_curves_that_are_none_are_refused(make, message):
    with pytest.raises(ModelError, match=message):
        make()


def test_files_name_every_law_as_it_names_itself():
    for law in [Hard(), *YIELDING]:
        assert LAWS[law.name] is type(law)
        assert (law.name in CLOSURES) == (law in CURVES)


@pytest.mark.parametrize("law", [Penalty(10.0), *CURVES])
def test_energies_are_what_pressures_do_while_they_close(law):
    way = np.linspace(-0.4, 1.2, 100_001)
    forces = law.respond(-way[None], np.full(len(way), 2.0))[0][0]
    done = np.append(0.0, np.cumsum(np.diff(way) * (forces[1:] + forces[:-1]) / 2))
    energy = law.energy(forces[None], np.full(len(way), 2.0))
    # The trapezoidal rule: second derivatives times 1e-10.
    np.testing.assert_allclose(energy, done, rtol=0, atol=1e-7 * done[-1])


def test_what_sticks_stores_energy_beside():
    forces = np.array([[10.0], [3.0], [4.0]])
    normal = RUBBING.normal.energy(forces[:1], np.ones(1))
    np.testing.assert_allclose(RUBBING.energy(forces, np.ones(1)), normal + 25 / 80, rtol=1e-15)
    assert Hard().energy(forces[:1], np.ones(1)) == 0.0
