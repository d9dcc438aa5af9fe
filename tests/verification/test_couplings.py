"""Couplings against rigid-body kinematics and the statics of a bolt group."""

import numpy as np
import pytest

from faying.model.assembly import Assembly, AverageCoupling, RigidCoupling
from faying.model.constraints import constrain
from faying.model.mesh import Mesh

RNG = np.random.default_rng(7)
POINTS = RNG.uniform(-3, 3, (12, 3))
REFERENCE = 11
ALL = np.ones(72, dtype=bool)


def model(points=POINTS, **content):
    return Assembly(mesh=Mesh(nodes=points, node_ids=1 + np.arange(len(points))), **content)


def rigid_motion(points, translation, rotation):
    """Displacements (n, 6) of points in a small rigid motion, by the cross product."""
    turned = translation + np.cross(rotation, points)
    return np.hstack([turned, np.tile(rotation, (len(points), 1))])


@pytest.mark.parametrize("components", [(0, 1, 2), (0, 1, 2, 3, 4, 5), (1, 5)])
def test_rigid_coupling_moves_its_nodes_as_one_body(components):
    nodes = [0, 3, 5]
    coupling = RigidCoupling(id=1, reference=REFERENCE, nodes=nodes, components=components)
    dofs = constrain(model(rigid_couplings=(coupling,)), ALL)
    translation, rotation = RNG.standard_normal((2, 3))
    expected = rigid_motion(POINTS, translation, rotation)
    moved = dofs.nodal(expected.ravel()[dofs.free])
    tied = np.ix_(nodes, components)
    # θ × r takes two products and two additions.
    np.testing.assert_allclose(moved[tied], expected[tied], atol=1e-14)


def test_chain_of_rigid_couplings_is_one_rigid_body():
    # A twisted chain of references at odd angles: 11 drives 0, 0 drives 1, 1 drives 2 to 6.
    chain = (
        RigidCoupling(id=3, reference=1, nodes=[2, 3, 4, 5, 6]),
        RigidCoupling(id=1, reference=REFERENCE, nodes=[0], components=(0, 1, 2, 3, 4, 5)),
        RigidCoupling(id=2, reference=0, nodes=[1], components=(0, 1, 2, 3, 4, 5)),
    )
    dofs = constrain(model(rigid_couplings=chain), ALL)
    expected = rigid_motion(POINTS, *RNG.standard_normal((2, 3)))
    moved = dofs.nodal(expected.ravel()[dofs.free])
    # Three rigid motions in sequence.
    np.testing.assert_allclose(moved[:7, :3], expected[:7, :3], atol=1e-13)
    assert not set(range(12)) & set(dofs.free.tolist())


@pytest.mark.parametrize("components", [(0, 1, 2), (0, 1, 2, 3, 4, 5), (0, 1, 2, 4)])
def test_average_coupling_reproduces_rigid_motions(components):
    coupling = AverageCoupling(
        id=1,
        reference=REFERENCE,
        nodes=np.arange(6),
        weights=RNG.uniform(0.5, 2, 6),
        components=components,
    )
    dofs = constrain(model(average_couplings=(coupling,)), ALL)
    expected = rigid_motion(POINTS, *RNG.standard_normal((2, 3)))
    moved = dofs.nodal(expected.ravel()[dofs.free])
    # Inverse of a 6 x 6 matrix with condition number below 1e3.
    np.testing.assert_allclose(moved[REFERENCE], expected[REFERENCE], atol=1e-12)


def test_average_coupling_spreads_a_load_like_a_bolt_group():
    """F w / Σw plus w (I⁻¹ M) × r about the weighted centre, I the weighted inertia tensor."""
    nodes, weights = np.arange(7), RNG.uniform(0.5, 2, 7)
    coupling = AverageCoupling(id=1, reference=REFERENCE, nodes=nodes, weights=weights)
    dofs = constrain(model(average_couplings=(coupling,)), ALL)
    force, moment = RNG.standard_normal((2, 3))
    load = np.zeros((12, 6))
    load[REFERENCE] = *force, *moment
    on_free = np.zeros(72)
    on_free[dofs.free] = dofs.transformation.T @ load.ravel()

    centre = weights @ POINTS[nodes] / weights.sum()
    arms = POINTS[nodes] - centre
    inertia = sum(
        w * (r @ r * np.eye(3) - np.outer(r, r)) for w, r in zip(weights, arms, strict=True)
    )
    about_centre = moment + np.cross(POINTS[REFERENCE] - centre, force)
    spin = np.linalg.solve(inertia, about_centre)
    expected = weights[:, None] * (force / weights.sum() + np.cross(spin, arms))
    # Inverse of a 6 x 6 matrix with condition number below 1e3.
    np.testing.assert_allclose(on_free.reshape(12, 6)[nodes, :3], expected, atol=1e-12)


def test_average_of_rotations_does_not_depend_on_the_unit_of_length():
    def at(scale):
        coupling = AverageCoupling(
            id=1,
            reference=REFERENCE,
            nodes=np.arange(5),
            weights=np.ones(5),
            components=(0, 1, 2, 3, 4, 5),
        )
        dofs = constrain(model(POINTS * scale, average_couplings=(coupling,)), ALL)
        return dofs.transformation[6 * REFERENCE + 3 : 6 * REFERENCE + 6].toarray()

    units = np.where(np.arange(66) % 6 < 3, 1e-3, 1.0)
    # Both sides come from the same least-squares problem, scaled before it is solved.
    np.testing.assert_allclose(at(1000.0), at(1.0) * units, atol=1e-12)


@pytest.mark.parametrize("reference_components", [(0, 1, 2, 3, 4, 5), (0, 2)])
def test_load_on_an_average_reference_gives_the_same_structure(reference_components):
    """Keeping the reference free only renames unknowns: same compliance at the reference."""
    coupling = AverageCoupling(
        id=1,
        reference=REFERENCE,
        nodes=np.arange(6),
        weights=RNG.uniform(0.5, 2, 6),
        reference_components=reference_components,
    )
    whole = model(average_couplings=(coupling,))
    used = np.arange(72) % 6 < 3
    used[6 * REFERENCE :] = False
    root = RNG.standard_normal((72, 72))
    K = np.where(np.outer(used, used), root @ root.T, 0.0)
    loaded = 6 * REFERENCE + np.array(reference_components)

    def compliance(dofs):
        T = dofs.transformation.toarray()
        return T[loaded] @ np.linalg.solve(T.T @ K @ T, T[loaded].T)

    plain, kept = constrain(whole, used), constrain(whole, used, keep=loaded)
    assert set(loaded) <= set(kept.free.tolist())
    assert len(kept.free) == len(plain.free)
    expected = compliance(plain)
    # A random K has a condition number of about 1e6 here.
    np.testing.assert_allclose(compliance(kept), expected, rtol=1e-8, atol=1e-8 * expected.max())


def test_loads_on_two_separate_averages_keep_both_exact():
    pair = tuple(
        AverageCoupling(id=i, reference=9 + i, nodes=nodes, weights=np.ones(4))
        for i, nodes in ((1, [0, 1, 2, 3]), (2, [4, 5, 6, 7]))
    )
    used = np.arange(72) % 6 < 3
    used[60:] = False
    keep = np.arange(60, 72)
    dofs = constrain(model(average_couplings=pair), used, keep=keep)
    plain = constrain(model(average_couplings=pair), used)
    assert set(keep) <= set(dofs.free.tolist())
    assert len(dofs.free) == len(plain.free)
    moved = dofs.nodal(RNG.standard_normal(len(dofs.free)))
    averages = plain.transformation @ moved.ravel()[plain.free]
    # Two inverses of 6 x 6 matrices with condition numbers below 1e3.
    np.testing.assert_allclose(averages[keep], moved.ravel()[keep], atol=1e-11)


def test_load_on_an_average_of_rigidly_coupled_nodes():
    """The reference's load passes through the average and on to the rigid coupling's reference."""
    chain = {
        "average_couplings": (
            AverageCoupling(id=1, reference=REFERENCE, nodes=[0, 1, 2], weights=np.ones(3)),
        ),
        "rigid_couplings": (RigidCoupling(id=2, reference=10, nodes=[0, 1, 2]),),
    }
    used = np.arange(72) % 6 < 3
    keep = np.arange(6 * REFERENCE, 6 * REFERENCE + 6)
    dofs = constrain(model(**chain), used, keep=keep)
    expected = rigid_motion(POINTS, *RNG.standard_normal((2, 3)))
    moved = dofs.nodal(expected.ravel()[dofs.free])
    # The average turns into a rigid motion; its inverse has a condition number below 1e3.
    np.testing.assert_allclose(moved[:3, :3], expected[:3, :3], atol=1e-11)
    np.testing.assert_allclose(moved[[10, REFERENCE]], expected[[10, REFERENCE]], atol=1e-11)
