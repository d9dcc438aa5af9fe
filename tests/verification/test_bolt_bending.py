"""Bending of bolts: against beams by hand, and the same from every model."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.model.assembly import Assembly, Beam, RigidCoupling, Spring, Support
from faying.model.generate import brick_grid
from faying.model.generated_bolt import bolt_section
from faying.model.specs import BoltSpec
from faying.reduction.projection import completed
from solid_blocks import stacked

STEEL = fy.Material(youngs_modulus=210e3, poissons_ratio=0.3, density=7.8e-9)
THREAD = fy.Thread(diameter=10.0, pitch=1.5, grade="8.8")
LOADS = [
    fy.Load({"tip.Fz": -300.0, "tip.Mx": 8e3}, name="bend"),
    fy.Load({"tip.Fx": 2e3}, name="pull"),
]


@pytest.fixture(scope="module")
def joint():
    return fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})


def standing_bolt(beams=1, *, spring=False, hinged=False):
    """A block pressed on a clamped one by a bolt from a fixed foot to a free head beside them."""
    grid = brick_grid(np.array([0, 4.0]), np.array([0, 4.0]), np.array([0, 2.0]))
    n = len(grid.nodes)
    heights = np.linspace(-8.0, 10.0, beams + 1)
    shank = np.column_stack([np.full(beams + 1, 2.0), np.full(beams + 1, 2.0), heights])
    mesh = stacked(replace(grid, nodes=grid.nodes - [0, 0, 2.0]), grid, beside=shank)
    foot, head = 2 * n, 2 * n + beams
    section = bolt_section(BoltSpec(name="bolt", diameter=6.0), STEEL)
    line = () if spring else tuple(
        Beam(id=90 + k, nodes=(foot + k, foot + k + 1), section=section, material=STEEL,
             orientation=(0.3, 1.0, 0.0))
        for k in range(beams)
    )  # fmt: skip
    guide = (Support(id=3, nodes=np.array([head]), components=(0, 1, 3, 4, 5)),) if spring else ()
    z = mesh.nodes[: 2 * n, 2]
    held = np.flatnonzero((z == -2) | ((z == 0) & (np.arange(2 * n) < n)))
    return fy.build_model(
        Assembly(
            mesh=mesh,
            materials={1: STEEL, 2: STEEL},
            supports=(
                Support(id=1, nodes=held, components=(0, 1, 2)),
                Support(
                    id=2,
                    nodes=np.array([foot]),
                    components=(0, 1, 2, 5) if hinged else (0, 1, 2, 3, 4, 5),
                ),
                *guide,
            ),
            rigid_couplings=(
                RigidCoupling(id=1, reference=head, nodes=n + np.flatnonzero(grid.nodes[:, 2] == 2))
                if not hinged
                else RigidCoupling(id=1, reference=n, nodes=np.array([head]), components=(0, 1, 2)),
            ),
            beams=line,
            springs=(Spring(id=90, ends=((foot, 2), (head, 2)), stiffness=3e5),) if spring else (),
        ),
        interfaces=[fy.InterfaceSpec(name="joint", penalty=1e5)],
        bolts=[fy.BoltSpec(name="bolt", elements=tuple(range(90, 90 + (1 if spring else beams))))],
        boundaries=[fy.BoundarySpec(name="head", node=head + 1)],
    )


@pytest.mark.parametrize("beams", [1, 3])
def test_a_bolt_is_a_cantilever_once_the_joint_is_open(beams):
    model = standing_bolt(beams)
    # Pulled apart, the bolt carries all that acts on the head: statics alone.
    load = fy.Load({"head.Fz": 1e3, "head.Fx": 50.0, "head.Fy": -20.0, "head.My": 300.0})
    solution = fy.solve_static(model, load)
    assert solution.contact_force() == 0
    moments = np.linalg.norm(solution.bolt_bending("bolt"), axis=-1)
    foot = np.hypot(-20.0 * 18.0, 50.0 * 18.0 + 300.0)
    # 1e-9: end moments of a beam are differences of its displacements.
    assert sorted(moments) == pytest.approx(sorted([foot, 300.0]), rel=1e-9)


def test_the_moment_of_a_turned_head_is_that_of_beam_theory():
    model = fy.preload(standing_bolt(), {"bolt": 5e3})
    solution = fy.solve_static(model, fy.Load({"head.My": 400.0}))
    motion = solution.displacement("head")
    sway, turn = motion[0], motion[4]
    section = bolt_section(BoltSpec(name="bolt", diameter=6.0), STEEL)
    bending_stiffness, shear = (
        STEEL.youngs_modulus * section.inertia_y,
        STEEL.shear_modulus * section.area,
    )
    phi = 12 * bending_stiffness / (section.shear_factor_y * shear * 18.0**2)
    far = bending_stiffness / 18.0 / (1 + phi) * ((4 + phi) * turn - 6 * sway / 18.0)
    near = bending_stiffness / 18.0 / (1 + phi) * ((2 - phi) * turn - 6 * sway / 18.0)
    moments = np.linalg.norm(solution.bolt_bending("bolt"), axis=-1)
    assert sorted(moments) == pytest.approx(sorted(np.abs([far, near])), rel=1e-8)
    # What the head takes is in the bolt and in the contact below it.
    points = model.interfaces["joint"].points
    contact = solution.contact_forces @ (points[:, 0] - 2.0)
    assert pytest.approx(far + contact, rel=1e-8) == 400.0


def test_reduced_models_of_exact_pressures_bend_alike(joint, tmp_path):
    basis = fy.craig_bampton(joint, normal_modes=3)
    exact = fy.reduce(joint, basis, compliance=True)
    exact.save(tmp_path / "joint.faying")
    full = fy.solve_static_cases(joint, LOADS).bolt_bending("bolt")
    for rom in (
        exact,
        fy.read_reduced_model(tmp_path / "joint.faying"),
        completed(joint, [exact])[0],
    ):
        found = fy.solve_static_cases(rom, LOADS).bolt_bending("bolt")
        # As pressures: round-off of the residual compliance.
        assert np.abs(found - full).max() < 1e-8 * np.abs(full).max()
    # The residual compliance is what bends it: the trial vectors alone are not enough.
    bare = replace(exact.bolts["bolt"], residual_bending=None)
    without = fy.solve_static_cases(replace(exact, bolts={"bolt": bare}), LOADS)
    assert np.abs(without.bolt_bending("bolt") - full).max() > 1e-4 * np.abs(full).max()


def test_assessments_tell_bending_and_count_it(joint):
    found = fy.assess(joint, LOADS, threads={"bolt": THREAD}, paths=False).bolts["bolt"]
    cases, rest = fy.solve_static_cases(joint, LOADS), fy.solve_static(joint)
    moments = np.linalg.norm(cases.bolt_bending("bolt"), axis=-1).max(axis=-1)
    added = np.linalg.norm(cases.bolt_bending("bolt") - rest.bolt_bending("bolt"), axis=-1)
    assert found.bending.most == pytest.approx(moments.max(), rel=1e-12)
    assert found.bending.most_case == LOADS[moments.argmax()].name
    assert found.bending.added == pytest.approx(added.max(), rel=1e-12)
    stress = cases.bolt_force("bolt") / THREAD.stress_area + moments / THREAD.section_modulus
    assert found.thread.safety == pytest.approx(640.0 / stress.max(), rel=1e-12)
    assert found.thread.bending > 0


def test_bending_of_springs_is_not_seen():
    model = fy.preload(standing_bolt(spring=True), {"bolt": 5e3})
    with pytest.raises(ModelError, match="bending of bolt 'bolt' is not known: it has no beams"):
        fy.solve_static(model).bolt_bending("bolt")
    found = fy.assess(
        model, [fy.Load({"head.Fz": 1e3})], threads={"bolt": THREAD}, paths=False
    ).bolts["bolt"]
    assert found.bending is None
    assert found.thread.bending is None
    assert found.thread.safety == pytest.approx(640.0 * THREAD.stress_area / found.most, rel=1e-12)


def test_beams_that_carry_no_moment_are_not_seen():
    # Hinged at its foot, and held by the head of three translations: a rod.
    assert standing_bolt(hinged=True).bolts["bolt"].bending is None
