"""Bushes, rods and scalar masses against the springs and arms they stand for."""

import numpy as np

from faying.model.assembly import (
    Assembly,
    Beam,
    BeamSection,
    Bush,
    Material,
    ScalarMass,
)
from faying.model.matrices import assemble_matrices, mass_properties, rigid_body_motions
from faying.model.mesh import Mesh

STEEL = Material(youngs_modulus=210000.0, poissons_ratio=0.3, density=7.82e-9)
NODES = np.array([[0.0, 0.0, 0.0], [10.0, 4.0, -3.0]])
MESH = Mesh(nodes=NODES, node_ids=np.array([1, 2]))
# Rounding of sums of a few terms.
EXACT = 1e-12


def bush(**given):
    turn = np.linalg.qr(np.random.default_rng(5).standard_normal((3, 3)))[0]
    values = {
        "id": 1,
        "nodes": (0, 1),
        "stiffness": (10.0, 20.0, 30.0, 400.0, 500.0, 600.0),
        "axes": tuple(tuple(row) for row in turn.tolist()),
        "place": (3.0, 7.0, 1.0),
    }
    return Bush(**(values | given))


def test_the_energy_is_that_of_the_springs_where_the_bush_acts():
    one = bush()
    K = assemble_matrices(Assembly(mesh=MESH, bushes=(one,))).K
    u = np.random.default_rng(6).standard_normal((2, 6))
    place, axes = np.array(one.place), np.array(one.axes)
    carried = [d[:3] + np.cross(d[3:], place - x) for d, x in zip(u, NODES, strict=True)]
    stretch = np.concatenate([axes @ (carried[1] - carried[0]), axes @ (u[1, 3:] - u[0, 3:])])
    energy = stretch @ (np.array(one.stiffness) * stretch)
    assert abs(u.ravel() @ K @ u.ravel() - energy) < EXACT * energy


def test_rigid_motions_stretch_no_bush_between_nodes():
    K = assemble_matrices(Assembly(mesh=MESH, bushes=(bush(),))).K
    motion = rigid_body_motions(NODES, np.zeros(3))
    assert np.abs(K @ motion).max() < EXACT * 10 * abs(K).max()


def test_a_grounded_bush_holds_its_node():
    one = bush(nodes=(1,), axes=tuple(map(tuple, np.eye(3).tolist())), place=tuple(NODES[1]))
    K = assemble_matrices(Assembly(mesh=MESH, bushes=(one,))).K.toarray()
    expected = np.zeros((12, 12))
    expected[6:, 6:] = np.diag(one.stiffness)
    np.testing.assert_allclose(K, expected, atol=EXACT * 600)


def test_the_mass_of_a_bush_is_shared_by_its_nodes():
    found = mass_properties(Assembly(mesh=MESH, bushes=(bush(mass=3.0),)))
    assert abs(found.mass - 3.0) < EXACT
    np.testing.assert_allclose(found.centre, NODES.mean(axis=0), atol=EXACT * 10)


def test_a_rod_pulls_and_twists_and_nothing_else():
    section = BeamSection(area=12.0, inertia_y=0.0, inertia_z=0.0, torsion=20.0)
    rod = Beam(id=1, nodes=(0, 1), section=section, material=STEEL, orientation=(0.0, 0.0, 1.0))
    found = assemble_matrices(Assembly(mesh=MESH, beams=(rod,)))
    values = np.linalg.eigvalsh(found.K.toarray())
    length = float(np.linalg.norm(NODES[1] - NODES[0]))
    axial, twist = 210000.0 * 12 / length, STEEL.shear_modulus * 20 / length
    np.testing.assert_allclose(values[-2:], sorted([2 * axial, 2 * twist]), rtol=EXACT)
    assert np.abs(values[:-2]).max() < EXACT * values[-1]
    # Its mass lies on the line, with no inertia at nodes that nothing could turn.
    mass = found.M.toarray()
    assert not mass[3:6].any()
    whole = mass_properties(Assembly(mesh=MESH, beams=(rod,)))
    assert abs(whole.mass - STEEL.density * 12 * length) < EXACT * whole.mass
    swing = np.sort(np.linalg.eigvalsh(whole.inertia))[1:]
    # Shape functions linear along the rod integrate r² exactly.
    np.testing.assert_allclose(swing, whole.mass * length**2 / 12, rtol=1e-9)


def test_a_scalar_mass_acts_on_the_difference_of_its_ends():
    one = ScalarMass(id=1, ends=((0, 1), (1, 1)), mass=5.0)
    M = assemble_matrices(Assembly(mesh=MESH, scalar_masses=(one,))).M.toarray()
    expected = np.zeros((12, 12))
    expected[[1, 7], [1, 7]] = 5.0
    expected[[1, 7], [7, 1]] = -5.0
    np.testing.assert_array_equal(M, expected)
