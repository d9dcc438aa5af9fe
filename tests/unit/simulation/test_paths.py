"""Paths, cycles and tightening with friction of two sliders; balance and law are written out."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.contact.augmented import AugmentedContact
from faying.contact.contact import Contact
from faying.contact.laws import Coulomb, Penalty
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.yielding import YieldingContact
from faying.exceptions import ConvergenceError, ModelError
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary
from faying.simulation.bolts_by_force import BoltsByForce
from faying.simulation.cycles import load_work, loop_area, repeat, repeats
from faying.simulation.path import moved_alone, path_inputs, path_start
from faying.simulation.path_steps import _extrapolated, follow
from faying.simulation.start import released_state
from faying.simulation.tightening import tightened_joint
from small_system import SmallSystem

NORMAL, TANGENTIAL, FRICTION, WEIGHTS = 2e3, 800.0, 0.3, np.array([1.0, 2.0])
BOLT = 400.0
P = np.zeros((6, 4))
P[[0, 1, 3, 4], [1, 0, 3, 2]] = 1.0  # of each point along its normal, and two tangents
SAME = {"rtol": 0, "atol": 1e-9}  # what increments are solved to, of forces up to ten


def sliders(gaps=(0.0, 0.002), lean=0.0, sideways=0.0):
    """Two masses that bolts press down and springs hold along a plane; ``lean`` couples both ways.

    Coordinates: along and normal of the first, then of the second; where springs hold them
    sideways, these last. Without those, compliance is singular, and increments are solved for
    forces.
    """
    K = np.diag([300.0, 500.0 + BOLT, 200.0, 700.0 + BOLT])
    K += 150.0 * np.outer([1, 0, -1, 0], [1, 0, -1, 0]) + 250.0 * np.outer(
        [0, 1, 0, -1], [0, 1, 0, -1]
    )
    K += lean * (np.outer([1, 1, 0, 0], [1, 1, 0, 0]) + np.outer([0, 0, 1, -1], [0, 0, 1, -1]))
    moved = P
    if sideways:
        moved = np.hstack([P, np.eye(6)[:, [2, 5]]])
        K = np.block([[K, np.zeros((4, 2))], [np.zeros((2, 4)), sideways * np.eye(2)]])
    n = len(K)
    contact = Contact(
        relative_operator=moved,
        interpolation=sp.csr_array(np.eye(6)[[0, 3]]),
        shear=sp.csr_array(np.eye(6)[[1, 4, 2, 5]]),
        initial_gap=np.array(gaps),
        weights=WEIGHTS,
        tangents=np.stack([np.tile(row, (2, 1)) for row in np.eye(3)[:2]]),
        laws={"sliders": Coulomb(Penalty(NORMAL), FRICTION, TANGENTIAL)},
        slices={"sliders": slice(0, 2)},
    )
    bolts = [
        Bolt(name=name, elongation=np.eye(n)[dof], stiffness=BOLT)
        for name, dof in (("a", 1), ("b", 3))
    ]
    ends = {
        name: Boundary(name=name, nodes=[dof], components=[0], dofs=[dof])
        for name, dof in (("first", 0), ("second", 2))
    }
    return SmallSystem(
        M=np.eye(n),
        C=np.zeros((n, n)),
        K=K,
        contact=contact,
        boundaries=ends,
        bolts={bolt.name: bolt for bolt in bolts},
    )


TIGHT = {"a": 12.0, "b": 20.0}


def pulled(first=0.0, second=0.0, bolts=TIGHT):
    return fy.Load({"first.Fx": first, "second.Fx": second}, bolt_forces=bolts)


WAY = [pulled(), pulled(1.0), pulled(4.0, 3.0), pulled(9.0, -6.0), pulled(-9.0, 5.0), pulled()]


def check_path(system, loads, path, slip=0.0):
    """Balance of all forces, the law at the points with the slip of each load, and its energy."""
    slip = np.zeros((2, 2)) + slip
    for i, load in enumerate(loads):
        u, normal, shear = path.states[i], path.contact_forces[i], path.shear_forces[i]
        external = np.zeros(len(u))
        external[[0, 2]] = load.forces["first.Fx"], load.forces["second.Fx"]
        external[[1, 3]] -= [load.bolt_forces[name] for name in ("a", "b")]
        inner = np.zeros(6)
        inner[[0, 3]], inner[[1, 4]], inner[[2, 5]] = normal, *shear
        np.testing.assert_allclose(
            system.K @ u, external + system.contact.relative_operator.T @ inner, **SAME
        )
        gap = u[[1, 3]] + system.contact.initial_gap
        np.testing.assert_allclose(path.gap[i], gap, **SAME)
        np.testing.assert_allclose(normal, NORMAL * WEIGHTS * np.maximum(-gap, 0.0), **SAME)
        new = path.shear_slip[i]
        held = -TANGENTIAL * WEIGHTS * (u[[0, 2]] - new[0])
        np.testing.assert_allclose(shear, [np.where(normal > 0, held, 0.0), [0.0, 0.0]], **SAME)
        assert (np.abs(shear[0]) <= FRICTION * normal + 1e-9).all()
        change = new - slip
        slips = np.abs(change[0]) > 1e-12
        np.testing.assert_allclose(
            shear[0, slips], -np.sign(change[0, slips]) * FRICTION * normal[slips], **SAME
        )
        assert path.dissipation[i] == pytest.approx(-(shear * change).sum(), abs=1e-12)
        slip = new
    return slip


@pytest.mark.parametrize("sideways", [0.0, 350.0])
@pytest.mark.parametrize("lean", [0.0, 120.0])
def test_paths_balance_and_obey_the_law(lean, sideways):
    system = sliders(lean=lean, sideways=sideways)
    solver = system.static_contact.increments
    assert isinstance(solver, YieldingContact)
    assert (solver.shapes is None) == (sideways > 0)
    path = fy.solve_path(system, WAY, name="way")
    check_path(system, WAY, path)
    assert path.name == "way"
    assert (path.iterations[1:] >= 1).all()  # the first may be what it began with
    np.testing.assert_array_equal(path.inputs, path_inputs(system, WAY))
    assert abs(path.dissipation[1]) < 1e-12  # one newton is held
    assert path.dissipation[3] > 0
    # It goes on from any of its states, and the last one of several.
    for k in (1, 3):
        begun = fy.solve_path(system, WAY[:k])
        rest = fy.solve_path(system, WAY[k:], initial=begun)
        np.testing.assert_array_equal(rest.shear_slip, path.shear_slip[k:])
        np.testing.assert_array_equal(rest.states, path.states[k:])
        np.testing.assert_array_equal(rest.iterations, path.iterations[k:])


def test_a_path_goes_on_from_a_joint_without_friction():
    """Its normal forces are where it begins, and nothing has slipped."""
    system = sliders()
    law = {"sliders": Penalty(NORMAL)}
    smooth = replace(system, contact=replace(system.contact, laws=law))
    before = fy.solve_static(smooth, pulled(3.0))
    start = path_start(system, before)
    np.testing.assert_array_equal(start.increment.forces[0], before.contact_forces)
    assert not start.increment.forces[1:].any()
    assert not start.slip.any()
    assert (start.iterations, start.dissipation) == (0, 0.0)
    assert (start.increment.iterations, start.increment.residual) == (0, 0.0)
    np.testing.assert_array_equal(start.increment.slack, np.zeros((3, 2)))
    np.testing.assert_allclose(
        start.relative, moved_alone(system, path_inputs(system, [pulled(3.0)]))[0], rtol=1e-14
    )
    path = fy.solve_path(smooth, [pulled(3.0), pulled()])
    np.testing.assert_allclose(path.contact_forces[0], before.contact_forces, rtol=1e-12)
    np.testing.assert_array_equal(path.dissipation, [0.0, 0.0])


@pytest.mark.parametrize(("way", "slides"), [(1.0, True), (-0.5, False), (-3.0, False)])
def test_an_increment_begins_where_what_slipped_slips_on_or_sticks(way, slides):
    """As the load goes on or turns."""
    system = sliders(sideways=100.0)
    relative = moved_alone(system, path_inputs(system, [pulled(), pulled(20.0), pulled(25.0)]))
    *_, step = follow(system.static_contact.increments, relative, path_start(system, None))
    assert np.abs(step.increment.slack[1:]).max() > 0
    start = _extrapolated(step, relative[-1] + way * (relative[-1] - relative[-2]))
    contact = system.contact
    z = contact.moved(start.moved) + contact.offset(step.slip)
    stiffness = LawsAtPoints(contact=contact).respond(z)[1]
    # What slips is pressed by more, and shears more.
    assert stiffness[:, 1:, 0].any() == slides


@dataclass
class Refusing:
    """A solver that is asked for increments of a share of a load at most, and notes what it is."""

    plain: AugmentedContact
    farthest: float
    last: float = 0.0

    def __post_init__(self):
        self.S, self.contact, self.asked = self.plain.S, self.plain.contact, []

    def solve(self, free, offset, start=None):
        self.asked.append(start)
        if abs(free[1] - self.last) > self.farthest:
            message = "too far"
            raise ConvergenceError(message)
        self.last = free[1]
        return self.plain.solve(free, offset, start)


@pytest.mark.parametrize("parts", [1, 2, 64, 65])
def test_increments_that_are_not_solved_are_halved(parts):
    """As often as six times; then the whole is that of the parts, with what all of them took."""
    system = sliders()
    plain, start = (
        system.static_contact.increments,
        path_start(system, fy.solve_path(system, WAY[:1])),
    )
    relative = moved_alone(system, path_inputs(system, [pulled(9.0), pulled(9.0)]))
    far = relative[0, 1] - start.relative[1]
    solver = Refusing(plain, 1.0001 * abs(far) / parts, last=start.relative[1])
    if parts == 65:
        with pytest.raises(ConvergenceError, match=r"^load 1 of 2 on the path: too far$"):
            list(follow(solver, relative, start))
        assert len(solver.asked) == 7
        return
    found, again = follow(solver, relative, start)
    here, taken, steps = start, 0.0, 0
    for k in range(1, parts + 1):
        target = start.relative + (relative[0] - start.relative) * k / parts
        (here,) = follow(plain, [target], here)
        taken, steps = taken + here.dissipation, steps + here.iterations
    np.testing.assert_allclose(found.slip, here.slip, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.increment.forces, here.increment.forces, **SAME)
    assert found.dissipation == pytest.approx(taken, abs=1e-12)
    assert found.iterations == steps
    np.testing.assert_array_equal(found.relative, relative[0])
    assert again.dissipation == pytest.approx(0.0, abs=1e-12)
    assert len(solver.asked) == 2 * parts


def test_the_second_half_of_an_increment_is_divided_as_often_as_the_first():
    system = sliders()
    start = path_start(system, fy.solve_path(system, WAY[:1]))
    relative = moved_alone(system, path_inputs(system, [pulled(9.0)]))
    middle = (start.relative[1] + relative[0, 1]) / 2

    class Half(Refusing):
        def solve(self, free, offset, start=None):
            self.farthest = np.inf if free[1] <= middle * 1.0001 else 0.0
            return super().solve(free, offset, start)

    solver = Half(system.static_contact.increments, 0.0)
    with pytest.raises(ConvergenceError, match="too far"):
        list(follow(solver, relative, start))
    assert len(solver.asked) == 1 + 1 + 6  # the whole, its first half, six parts of its second


def test_increments_begin_on_the_line_of_the_one_before():
    """As far as the load goes along it; of an unstressed joint as if nothing were known."""
    system = sliders()
    solver = Refusing(system.static_contact.increments, np.inf)
    way = [pulled(bolts={"a": -5.0, "b": 20.0}), *WAY[1:3]]
    relative = moved_alone(system, path_inputs(system, way))
    steps = list(follow(solver, relative, path_start(system, None)))
    assert (steps[0].increment.forces[0] > 0).tolist() == [False, True]  # one point is open
    assert solver.asked[0] is None
    assert solver.asked[1] is steps[0].increment
    line, ahead = np.diff(relative, axis=0)
    part = line @ ahead / (line @ line)
    assert 0.1 < abs(part) < 1
    first, last = (step.increment.moved for step in steps[:2])
    expected = last + part * (last - first)
    np.testing.assert_allclose(solver.asked[2].moved, expected, rtol=0, atol=1e-15)  # round-off


def test_increments_of_a_cycle_go_as_far_as_those_of_the_cycle_before():
    system = sliders()
    solver = Refusing(system.static_contact.increments, np.inf)
    relative = moved_alone(system, path_inputs(system, [pulled(), *WAY[1:3]]))
    first = next(follow(solver, relative[:1], path_start(system, None)))
    before = [first, *follow(solver, relative[1:], first)]
    solver.asked.clear()
    again = list(follow(solver, relative[1:], before[-1], before=before))
    was = [step.increment.moved for step in before]
    now = [step.increment.moved for step in (before[-1], *again)]
    assert len(solver.asked) == 2
    for number, start in enumerate(solver.asked):
        expected = now[number] + was[number + 1] - was[number]
        np.testing.assert_allclose(start.moved, expected, rtol=0, atol=1e-15)  # round-off


LOAD = pulled(3.0, -2.0)


def by_path(system, amplitude, increments, count):
    """Rise and cycles as loads of one path from the tightened joint, and their factors."""
    rise = amplitude * np.arange(1, increments + 1) / increments
    down = amplitude * (1 - np.arange(1, 2 * increments + 1) / increments)
    factors = np.concatenate([rise, *[down, -down] * count])
    loads = [pulled(3.0 * f, -2.0 * f) for f in factors]
    tight = fy.solve_path(system, [pulled()])
    return tight, factors, fy.solve_path(system, loads, initial=tight)


@pytest.mark.parametrize("count", [1, 3])
def test_cycles_are_loads_of_a_path(count):
    """Another way to the same increments: only what is expected of them differs."""
    system = sliders(lean=120.0)
    tight, factors, path = by_path(system, 6.0, 3, count)
    found = fy.solve_cycles(system, LOAD, 6.0, tight, increments=3, count=count)
    assert found.amplitude == 6.0
    np.testing.assert_allclose(found.factors, factors[-12:], rtol=0, atol=1e-15)
    for name in ("states", "contact_forces", "shear_forces", "shear_slip", "dissipation"):
        np.testing.assert_allclose(getattr(found.cycle, name), getattr(path, name)[-12:], **SAME)
        np.testing.assert_allclose(getattr(found.start, name)[0], getattr(path, name)[-13], **SAME)
    energies = path.dissipation[3:].reshape(count, 12).sum(axis=1)
    np.testing.assert_allclose(found.energies, energies, **SAME)
    assert energies[-1] > 0.1
    u = path.states[-13:]
    along = 3.0 * u[:, 0] - 2.0 * u[:, 2]
    np.testing.assert_allclose(load_work(path, LOAD)[-13:], along, **SAME)
    area = 0.5 * ((along[1:] + along[:-1]) * -np.diff(factors[-13:])).sum()
    assert loop_area(found, LOAD) == pytest.approx(area, abs=1e-9)
    # Which energy that is: trapezoids of six increments each way.
    assert area == pytest.approx(energies[-1], rel=0.3)


def test_cycles_are_repeated_until_they_agree_to_a_thousandth():
    """These are alike from the first."""
    system = sliders(lean=120.0)
    tight = fy.solve_path(system, [pulled()])
    for amplitude in (6.0, 0.1):
        found = fy.solve_cycles(system, LOAD, amplitude, tight, increments=2)
        assert found.stationary
        assert len(found.energies) == 1
    assert abs(found.energies[0]) < 1e-12  # nothing slips

    steps = followed_cycle(system, 6.0, tight)
    moved_on = [*steps[:-1], replace(steps[-1], slip=steps[-1].slip + 1.0)]
    told = ([1.0, 0.9], [0.9, 0.9011], [0.9011, 0.902])  # 1.2 and then 0.998 thousandths more
    agree = [repeats(system.contact, moved_on, [5.0, *energies]) for energies in told]
    assert agree == [False, False, True]
    assert not repeats(system.contact, moved_on, [0.9])
    assert repeats(system.contact, steps, [1.0, 0.9])  # ends where it began


def followed_cycle(system, amplitude, tight):
    loads = [LOAD.scaled(amplitude * factor) for factor in (1.0, 0.0, -1.0, 0.0, 1.0)]
    relative = moved_alone(system, path_inputs(system, loads))
    solver = system.static_contact.increments
    (start,) = follow(solver, relative[:1], path_start(system, tight))
    return repeat(solver, relative[1:], start, 1).steps


@pytest.mark.parametrize(("share", "alike"), [(0.9e-12, True), (1.1e-12, False)])
def test_slip_of_round_off_is_none(share, alike):
    """To 1e-12 of what contact takes as the load turns, and gives back."""
    system, contact = sliders(), sliders().contact
    steps = followed_cycle(system, 0.2, fy.solve_path(system, [pulled()]))
    pairs, moved = (
        np.subtract(*(value(steps[at].increment) for at in (2, -1)))
        for value in (
            lambda increment: contact.at_pairs(increment.forces[0], increment.forces[1:]),
            lambda increment: increment.moved,
        )
    )
    slip = steps[-1].slip.copy()
    slip[0, 0] += share * np.abs(pairs * moved).sum() / abs(steps[-1].increment.forces[1, 0])
    assert repeats(contact, [*steps[:-1], replace(steps[-1], slip=slip)], [0.0]) == alike


def test_cycles_that_go_on_changing_are_ended(monkeypatch):
    monkeypatch.setattr("faying.simulation.cycles.STATIONARY", -1.0)
    monkeypatch.setattr("faying.simulation.cycles.ROUND_OFF", -1.0)
    monkeypatch.setattr("faying.simulation.cycles.MOST_CYCLES", 4)
    tight = fy.solve_path(sliders(), [pulled()])
    found = fy.solve_cycles(sliders(), LOAD, 6.0, tight, increments=1)
    assert not found.stationary
    assert len(found.energies) == 4


def test_cycles_without_friction_take_nothing():
    system = sliders()
    law = {"sliders": Penalty(NORMAL)}
    smooth = replace(system, contact=replace(system.contact, laws=law))
    found = fy.solve_cycles(smooth, LOAD, 2.0, increments=2)
    np.testing.assert_array_equal(found.energies, [0.0])
    assert found.stationary
    np.testing.assert_array_equal(found.factors, [1, 0, -1, -2, -1, 0, 1, 2])
    assert found.start.states.shape == (1, 4)
    np.testing.assert_allclose(found.cycle.states[-1], found.start.states[0], rtol=1e-12)
    assert len(fy.solve_cycles(smooth, LOAD, 2.0, increments=2, count=3).energies) == 3


@pytest.mark.parametrize(("amplitude", "increments"), [(0.0, 3), (np.inf, 3), (1.0, 0)])
def test_cycles_out_of_range_are_refused(amplitude, increments):
    with pytest.raises(ModelError, match="give a positive factor of the load and one or more"):
        fy.solve_cycles(sliders(), LOAD, amplitude, increments=increments)


@pytest.mark.parametrize("sideways", [0.0, 350.0])
def test_bolts_are_tightened_along_a_path_with_friction(sideways):
    """One after the other, then together: nominal forces, and loads that lead any model there."""
    system, goal = sliders(lean=600.0, sideways=sideways), {"b": 12.0, "a": 8.0}
    found = tightened_joint(system, goal, increments=4)
    tightening = found.tightening
    assert tightening.bolts == ("a", "b")
    stages = [f"{name} to {share}" for name in "ba" for share in ("25%", "50%", "75%", "100%")]
    assert list(tightening.stages) == [*stages, "all to nominal"]
    forces = tightening.bolt_forces
    assert forces.shape == (9, 2)
    np.testing.assert_allclose(forces[:4, 1], [3.0, 6.0, 9.0, 12.0], rtol=1e-9)
    np.testing.assert_allclose(forces[4:8, 0], [2.0, 4.0, 6.0, 8.0], rtol=1e-9)
    np.testing.assert_allclose(forces[8], [8.0, 12.0], rtol=1e-9)
    assert abs(forces[7, 1] - 12.0) > 0.01  # what the neighbour took away
    loads = [replace(load, forces=pulled().forces) for load in found.tightening.loads]
    path = fy.solve_path(system, loads)
    check_path(system, loads, path)
    assert path.dissipation[0] > 1e-4  # the first points that close slip
    np.testing.assert_allclose(path.shear_slip[-1], found.rest(system).shear_slip[-1], **SAME)
    initial = np.array(
        [[load.bolt_forces[name] for name in "ab"] for load in found.tightening.loads]
    )
    assert dict(zip("ab", initial[-1], strict=True)) == tightening.initial_forces
    assert not initial[:4, 0].any()
    reached = BOLT * path.states[:, [1, 3]] + initial
    np.testing.assert_allclose(reached, forces, **SAME)


def test_bolts_that_are_locked_already_come_first():
    """Their forces are a load of their own, before the first bolt that is turned."""
    system = sliders()
    locked = replace(
        system,
        bolts={"a": system.bolts["a"].locked(9.0), "b": system.bolts["b"]},
    )
    found = tightened_joint(locked, {"b": 12.0}, increments=2)
    assert [load.bolt_forces["a"] for load in found.tightening.loads] == [9.0] * len(
        found.tightening.loads
    )
    assert found.tightening.loads[0].bolt_forces["b"] == 0.0
    assert len(found.tightening.stages) == len(found.tightening.bolt_forces) == 2
    np.testing.assert_allclose(found.tightening.bolt_forces[-1, 1], 12.0, rtol=1e-9)
    turned = tightened_joint(locked, {"a": 11.0}, increments=3)
    assert turned.tightening.loads[0].bolt_forces == {"a": 9.0, "b": 0.0}
    on_the_way = turned.tightening.bolt_forces[:, 0]
    np.testing.assert_allclose(on_the_way, 11.0 * np.array([1, 2, 3]) / 3, rtol=1e-9)
    none = tightened_joint(locked, {})
    assert len(none.tightening.loads) == 1
    assert none.tightening.stages == ()
    assert none.tightening.bolt_forces.shape == (0, 2)


@pytest.mark.parametrize("sideways", [0.0, 350.0])
def test_bolts_that_pull_at_what_gives_way_are_refused(sideways):
    """As those that are stiffer than all that resists them, contact included."""
    system = sliders(lean=120.0, sideways=sideways)
    stiff = {n: replace(bolt, stiffness=1e9) for n, bolt in system.bolts.items()}
    problem = BoltsByForce(joint=replace(system, bolts=stiff), bolts=np.array([1, 0]))
    message = r"bolts b, a cannot be tightened to 12, 8: .* gives way"
    with pytest.raises(ConvergenceError, match=message):
        problem.solve(np.array([12.0, 8.0]), np.zeros(2), 0.0, None)


@pytest.mark.parametrize("load", [pulled(3.0, -2.0), pulled(3.0, -2.0, {"a": 0.0, "b": 20.0})])
def test_a_joint_that_was_tightened_without_friction(load):
    """Nothing is sheared; what has moved along the plane is slip, and friction begins there."""
    system = sliders(lean=120.0)
    state = released_state(system, load)
    np.testing.assert_array_equal(state.shear_forces, np.zeros((1, 2, 2)))
    u = state.states[0]
    np.testing.assert_allclose(state.shear_slip[0], [u[[0, 2]], [0.0, 0.0]], rtol=0, atol=1e-14)
    gap = u[[1, 3]] + system.contact.initial_gap
    np.testing.assert_allclose(state.gap[0], gap, **SAME)
    normal = NORMAL * WEIGHTS * np.maximum(-gap, 0.0)
    np.testing.assert_allclose(state.contact_forces[0], normal, **SAME)
    external = [load.forces["first.Fx"], 0.0, load.forces["second.Fx"], 0.0]
    external -= np.array([0, load.bolt_forces["a"], 0, load.bolt_forces["b"]])
    external[[1, 3]] += normal
    np.testing.assert_allclose(system.K @ u, external, **SAME)
    assert state.dissipation.tolist() == [0.0]
    stays = fy.solve_path(system, [load], initial=state)
    np.testing.assert_allclose(stays.states, state.states, rtol=0, atol=1e-12)
    assert np.abs(stays.shear_forces).max() < 1e-9
