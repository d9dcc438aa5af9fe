"""Weak springs: bodies that contact and friction hold as they would without them."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.joint.diagnosis import check_held
from lap_joints import tiny_lap

PULL = fy.Load({"tip.Fx": 300.0, "tip.Fz": -50.0}, name="pull")
BOTH = ["lower-middle", "middle-upper"]


@pytest.fixture(scope="module")
def plates():
    """Three plates, of which the middle one carries the load and nothing but contact holds it."""
    joint = tiny_lap(plates=3, tip_suspension=(0.0, 0.0), penalty=1e6)
    return joint.with_bolt_forces({"bolt": 10e3})


@pytest.fixture(scope="module")
def held(plates):
    return fy.with_weak_springs(plates)


def path(joint):
    return fy.solve_path(joint.with_friction(0.4), [fy.Load(), PULL])


def carried(solution):
    return sum(solution.weak_force(name) for name in BOTH)


def test_only_what_is_free_is_held(plates, held):
    with pytest.raises(ModelError, match=r"body 'middle' .*weak_springs = .auto."):
        check_held(plates)
    check_held(held)
    assert sorted(held.weak_supports) == BOTH
    assert fy.with_weak_springs(held) is held
    (note,) = held.assembly.ignored
    assert note.startswith("weak springs of ")
    assert "lower-middle (nodes " in note


@pytest.mark.parametrize("stiffness", [0.0, -1.0, float("nan"), float("inf")])
def test_stiffness_is_a_positive_number(plates, stiffness):
    with pytest.raises(ModelError, match="give a positive number or 'auto'"):
        fy.with_weak_springs(plates, stiffness)


def test_friction_holds_a_plate_whatever_the_springs(plates, held):
    found = path(held)
    stiffness = held.weak_supports[BOTH[0]].stiffness
    again = path(fy.with_weak_springs(plates, 10 * stiffness))
    moved = found.displacement("tip")[1]
    # The springs carry less than 1e-5 of the load, ten times as stiff ones ten times that.
    np.testing.assert_allclose(again.displacement("tip")[1], moved, atol=1e-4 * abs(moved).max())
    np.testing.assert_allclose(
        again.contact_forces, found.contact_forces, atol=1e-4 * found.contact_forces.max()
    )
    # The penalty lets the surfaces, and with them the springs, give way by 1e-3 mm.
    assert carried(found)[1] < 1e-5 * found.contact_forces[1].sum()


def test_without_friction_the_springs_carry_the_load(held):
    free = fy.solve_static(held, PULL)
    pulled = sum(
        (one.forces @ free.states).reshape(3, 3).sum(axis=0)[0] * sign
        for one, sign in zip((held.weak_supports[n] for n in BOTH), (1, -1), strict=True)
    )
    # Balance of forces along x of the middle plate, where nothing else resists: round-off.
    assert abs(pulled) == pytest.approx(300.0, rel=1e-6)
    assert carried(free) >= 300.0 * (1 - 1e-6)


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_a_reduced_model_tells_the_same_after_loading_too(held, friction, tmp_path):
    joint = held.with_friction(friction)
    rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    loads = [fy.Load(), PULL]
    full, reduced = (fy.solve_path(one, loads) for one in (joint, rom))
    # Statics are those of the full model, up to the condition of weakly held plates.
    np.testing.assert_allclose(carried(reduced), carried(full), rtol=1e-5)
    rom.save(tmp_path / "joint.faying")
    again = fy.solve_path(fy.read_reduced_model(tmp_path / "joint.faying"), loads)
    np.testing.assert_array_equal(carried(again), carried(reduced))


def test_bodies_without_springs_have_no_force(held):
    with pytest.raises(ModelError, match=r"no weak springs 'lower'; those there are hold lower-mi"):
        fy.solve_static(held, PULL).weak_force("lower")


def test_hard_contact_of_a_plate_on_weak_springs_is_the_limit_of_stiff_penalties():
    """Eight-node facets have more points than displacements; the springs bring round-off."""
    forces = []
    for penalty in (np.inf, 1e11):
        joint = tiny_lap(plates=3, shape="hex20", penalty=penalty, quadrature="nodal")
        found = fy.solve_static(fy.preload(joint, {"bolt": 10e3}), fy.Load({"tip.Fz": -50.0}))
        forces.append(joint.contact.at_pairs(found.contact_forces))
    # What 1e11 N/mm³ gives way by: 4e-8 of the largest force, in proportion to 1 / penalty.
    np.testing.assert_allclose(forces[0], forces[1], atol=2e-7 * forces[1].max())


def test_the_softest_springs_cost_a_reduced_model_no_digits(tmp_path):
    """Free plates on springs of 1e-8 of their stiffness ended in numbers that were not finite."""
    plates = fy.lap_joint(element_size=10.0, hole_radius=0.0, bolt_positions=())
    free = fy.build_model(
        replace(plates.assembly, supports=()),
        interfaces=[fy.InterfaceSpec(name="joint", friction=0.4)],
        boundaries=[fy.BoundarySpec(name="tip", node=2)],
    )
    joint = fy.with_weak_springs(free, 1e-3)
    rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=20), compliance=True)
    rom.save(tmp_path / "free.faying")
    swings = []
    for model in (joint, rom, fy.read_reduced_model(tmp_path / "free.faying")):
        rest = fy.solve_path(model, [fy.Load()])
        glued = replace(rest, contact_forces=np.ones_like(rest.contact_forces))
        swings.append(fy.preloaded_frequencies(model, 2, state=glued))
    # What 20 normal modes hold: 9e-4, on springs of the automatic stiffness too.
    np.testing.assert_allclose(swings[1], swings[0], rtol=2e-3)
    np.testing.assert_array_equal(swings[2], swings[1])
