"""Joints that nothing holds: inertia relief, elastic modes, the same joint on very soft springs.

Springs of 1e-9 of the median diagonal of K let the joint swing below 1.2 Hz, its first elastic mode
is at 667 Hz: they raise the square of its frequency by about (1.2/667)² = 3e-6.
"""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.joint.diagnosis import check_held, suspension
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import Spring, Support

SOFT = 1e-9
LOAD = fy.Load({"tip.Fz": 200.0, "tip.Fy": 50.0})
DESCRIBED = lap_joint_assembly(element_size=5.0)
MESH = DESCRIBED.assembly.mesh
CORNER = int(MESH.node_ids[MESH.nodes.sum(axis=1).argmax()])
CLAMP = MESH.node_sets["clamp"]


def built(boundaries=DESCRIBED.boundaries, **changes) -> fy.Model:
    model = fy.build_model(
        replace(DESCRIBED.assembly, **changes),
        interfaces=DESCRIBED.interfaces,
        bolts=DESCRIBED.bolts,
        boundaries=boundaries,
    )
    return fy.preload(model, {"bolt": 10e3})


def suspended(free) -> fy.Model:
    stiffness = SOFT * float(np.median(free.K.diagonal()))
    solids = np.unique(np.concatenate([block.nodes for block in MESH.blocks]))
    nodes = solids[[0, len(solids) // 2, -1]].tolist()
    first = free.assembly.largest_id + 1
    springs = tuple(
        Spring(id=first + 3 * i + c, ends=((node, c),), stiffness=stiffness)
        for i, node in enumerate(nodes)
        for c in range(3)
    )
    return built(supports=(), springs=springs)


@pytest.fixture(scope="module")
def free():
    return built(supports=())


@pytest.fixture(scope="module")
def soft(free):
    return suspended(free)


@pytest.fixture(scope="module", params=["tip", "corner", "none"])
def anywhere(request, free):
    """Springs of (M11) are all on the boundary, half of them, or none."""
    if request.param == "tip":
        return free
    corner = [fy.BoundarySpec(name="tip", node=CORNER)]
    return built(boundaries=corner if request.param == "corner" else [], supports=())


def test_there_are_six_motions_and_no_more(free, soft):
    R = free.rigid_motions
    np.testing.assert_allclose(R.T @ (free.M @ R), np.eye(6), atol=1e-12)
    assert np.abs(free.K @ R).max() < 1e-12 * abs(free.K).max() * np.abs(R).max()  # round-off
    assert soft.rigid_motions.shape[1] == 0
    check_held(free)


def test_static_forces_are_balanced_by_inertia(anywhere):
    load = LOAD if anywhere.boundaries else fy.Load()
    found = fy.solve_static(anywhere, load)
    u, R, M = found.states, anywhere.rigid_motions, anywhere.M
    pushed = np.zeros(len(u))
    if anywhere.boundaries:
        tip = anywhere.boundaries["tip"]
        pushed[tip.dofs[:3]] = [0.0, 50.0, 200.0]
    bolt = anywhere.bolts["bolt"]
    pushed -= bolt.initial_force * bolt.elongation
    carried = anywhere.contact.gap_operator.T @ found.contact_forces
    left = anywhere.K @ u - carried - pushed + M @ (R @ (R.T @ pushed))
    # Round-off of a stiffness of 1e7 and displacements of 0.01.
    assert np.abs(left).max() < 1e-6 * np.abs(found.contact_forces).max()
    assert np.abs(R.T @ (M @ u)).max() < 1e-12 * np.abs(R.T @ M).max() * np.abs(u).max() * len(u)


def test_it_is_the_joint_on_very_soft_springs(free, soft):
    np.testing.assert_allclose(
        fy.preloaded_frequencies(free, 3), fy.preloaded_frequencies(soft, 9)[6:], rtol=1e-5
    )
    assert fy.count_frequencies_below(free, 2500.0) == 2
    ours, theirs = fy.solve_static(free, fy.Load()), fy.solve_static(soft, fy.Load())
    np.testing.assert_allclose(ours.pressure, theirs.pressure, atol=1e-7 * ours.max_pressure)


def test_a_suspension_is_told_apart(free, soft):
    assert suspension(free) == ""
    assert suspension(built()) == ""
    swings = fy.preloaded_frequencies(soft, 6)
    expected = f"hold 6 motion(s) of the joint as a whole, in which it swings at {swings[0]:.3g} to"
    assert expected in suspension(soft)


def test_backbones_are_those_on_very_soft_springs(free, soft):
    ours = fy.backbone(free.with_friction(0.2), 1, [0.01], increments=16)
    theirs = fy.backbone(soft.with_friction(0.2), 7, [0.01], increments=16)
    np.testing.assert_allclose(ours.frequency, theirs.frequency, rtol=1e-6)
    np.testing.assert_allclose(ours.damping_ratio, theirs.damping_ratio, rtol=1e-5)


def test_newton_agrees(free):
    condensed, newton = fy.solve_static(free, LOAD), fy.solve_static_newton(free, LOAD)
    np.testing.assert_allclose(newton.states, condensed.states, atol=1e-9)
    np.testing.assert_allclose(
        newton.pressure, condensed.pressure, atol=1e-9 * condensed.max_pressure
    )


def test_reduced_models_are_exact_in_statics(anywhere, tmp_path):
    rom = fy.reduce(anywhere, fy.craig_bampton(anywhere, normal_modes=6), compliance=True)
    rom.save(tmp_path / "free.h5")
    load = LOAD if anywhere.boundaries else fy.Load()
    full = fy.solve_static(anywhere, load)
    for model in (rom, fy.read_reduced_model(tmp_path / "free.h5")):
        fast = fy.solve_static(model, load)
        np.testing.assert_allclose(fast.pressure, full.pressure, atol=1e-8 * full.max_pressure)
    for name in anywhere.boundaries:
        np.testing.assert_allclose(fast.displacement(name), full.displacement(name), atol=1e-8)
    recovered = fy.recover_pressure(anywhere, fast)
    np.testing.assert_allclose(recovered.pressure, full.pressure, atol=1e-8 * full.max_pressure)


def test_it_flies_as_a_whole(free):
    """Momentum grows with time, in the full and the reduced model."""
    rom = fy.reduce(free, fy.craig_bampton(free, normal_modes=12), compliance=True)
    jump = fy.Load({"tip.Fz": 100.0})
    step = {"step": 2e-5, "duration": 1e-3}
    full, fast = (fy.solve_transient(model, jump, **step) for model in (free, rom))
    push = np.zeros(len(free.rigid_motions))
    push[free.boundaries["tip"].dofs[2]] = 100.0
    momentum = full.velocities @ (free.M @ free.rigid_motions)
    expected = np.outer(full.times - full.times[0], free.rigid_motions.T @ push)
    assert np.abs(momentum - expected).max() < 1e-6 * np.abs(expected).max()
    np.testing.assert_allclose(
        fast.displacement("tip"),
        full.displacement("tip"),
        atol=1e-3 * full.displacement("tip").max(),
    )


def test_one_free_direction_is_balanced_alone():
    lower = np.flatnonzero(MESH.nodes[:, 2] < -1.0)
    corner = lower[MESH.nodes[lower, :2].sum(axis=1).argmax()]
    slides = (Support(id=1, nodes=np.append(CLAMP, corner), components=(1, 2)),)
    sliding = built(supports=slides)
    assert sliding.rigid_motions.shape[1] == 1
    moved = sliding.dofs.nodal(sliding.rigid_motions[:, 0])[:, :3]
    assert np.ptp(moved[:, 0]) < 1e-9 * np.abs(moved).max()
    assert np.abs(moved[:, 1:]).max() < 1e-9 * np.abs(moved).max()
    assert fy.solve_static(sliding, LOAD).max_pressure > 0


def test_sparse_factors_balance_forces_alike(free):
    dense, sparse = (fy.solve_static(m, LOAD) for m in (free, free.with_dense_budget(100)))
    largest = dense.contact_forces.max()
    np.testing.assert_allclose(
        sparse.contact_forces, dense.contact_forces, rtol=0, atol=1e-9 * largest
    )
