"""Clipping and mortar couplings of random overlaps: geometry from elsewhere, balance, frames."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection
from scipy.spatial.transform import Rotation

from faying.interface.clipping import areas, clip, fans
from faying.interface.mortar import find_couplings
from mortar_blocks import SIZE, SPEC, bent, blocks, mortar, nodal_forces, turned

seeds = st.integers(0, 2**32 - 1)
kinds = st.sampled_from(["hex8", "tet4", "hex20", "tet10", "wedge6"])
counts = st.tuples(st.integers(1, 6), st.integers(1, 6))
angles = st.floats(-3.2, 3.2)
offsets = st.tuples(st.floats(-4, 4), st.floats(-4, 4))
rules = st.sampled_from(["gauss", "nodal"])


def convex(random, n):
    """Random convex quadrilaterals (n, 4, 2), some of them triangles that repeat a corner."""
    angle = np.sort(random.uniform(0, 2 * np.pi, (n, 4)), axis=1)
    # Corners of an ellipse in order are convex; gaps above π only leave the centre out.
    corners = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    corners = corners * random.uniform(0.5, 2.0, (n, 1, 2)) + random.uniform(-1, 1, (n, 1, 2))
    corners[::3, 3] = corners[::3, 2]
    return corners


def halfplanes(polygon):
    """Rows a x + b y + c <= 0 of a convex polygon."""
    rows = []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        length = np.linalg.norm(b - a)
        if length > 0:
            normal = np.array([b[1] - a[1], a[0] - b[0]]) / length
            rows.append([*normal, -normal @ a])
    return np.array(rows)


def common_area(one, other):
    """Area of the intersection of two convex polygons, by halfspaces; 0 if it is tiny."""
    rows = np.vstack([halfplanes(one), halfplanes(other)])
    # The centre of the largest inscribed circle.
    found = linprog([0, 0, -1], np.column_stack([rows[:, :2], np.ones(len(rows))]), -rows[:, 2],
                    bounds=[(None, None), (None, None), (0, None)])  # fmt: skip
    if found.status != 0 or found.x[2] < 1e-6:
        return 0.0
    return ConvexHull(HalfspaceIntersection(rows, found.x[:2]).intersections).volume


@settings(max_examples=25)
@given(seeds)
def test_clipping_finds_the_common_area(seed):
    random = np.random.default_rng(seed)
    one, other = convex(random, 12), convex(random, 12)
    polygons, corners = clip(one, other)
    found = areas(polygons, corners)
    expected = [common_area(a, b) for a, b in zip(one, other, strict=True)]
    # Intersections thinner than 1e-6 count as none on the other side.
    np.testing.assert_allclose(found, expected, atol=1e-5)
    swapped = areas(*clip(other, one))
    np.testing.assert_allclose(swapped, found, atol=1e-13)
    triangles, owners = fans(polygons, corners)
    total = np.bincount(owners, areas(triangles, np.full(len(triangles), 3)), len(found))
    np.testing.assert_allclose(total, found, atol=1e-13)


def lattice(random, n):
    """Rectangles and right triangles on a small lattice (n, 4, 2), with sides in common."""
    low, size = random.integers(0, 3, (n, 2)), random.integers(1, 4, (n, 2))
    unit = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    corners = (low[:, None] + size[:, None] * unit).astype(float)
    corners[::3, 3] = corners[::3, 2]
    return corners


@pytest.mark.long
@settings(max_examples=30)
@given(seeds, angles)
def test_shared_sides_are_cut_by_no_rounding(seed, angle):
    random = np.random.default_rng(seed)
    one, other = lattice(random, 20), lattice(random, 20)
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, s], [-s, c]])
    polygons, corners = clip(one @ turn, other @ turn)
    expected = [common_area(a, b) for a, b in zip(one, other, strict=True)]
    np.testing.assert_allclose(areas(polygons, corners), expected, atol=1e-9)
    # A quadrilateral with a quadrilateral has eight corners at most.
    assert corners.max() <= 8


def overlap(below, above, angle, offset):
    rectangle = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * SIZE[:2] / 2
    flat = np.column_stack([rectangle, np.zeros(4)])
    return common_area(rectangle, turned(angle, 0.8, offset)(flat)[:, :2])


@pytest.mark.long
@settings(max_examples=30)
@given(kinds, kinds, counts, counts, angles, offsets, rules, seeds)
def test_area_balance_and_linear_motions(
    lower, upper, below, above, angle, offset, quadrature, seed
):
    assembly = blocks((below, lower), (above, upper), move=turned(angle, 0.8, offset))
    joint = mortar(assembly, quadrature=quadrature)
    # Facets covered by less than a millionth are left out.
    expected = overlap(below, above, angle, offset)
    np.testing.assert_allclose(joint.area, expected, rtol=1e-5, atol=1e-4)
    assert joint.weights.min() > 0
    random = np.random.default_rng(seed)
    forces = nodal_forces(joint, random.exponential(size=joint.n_points))
    size = np.abs(forces).sum()
    # Corners of facets covered by little extrapolate; their weights are as little.
    np.testing.assert_allclose(forces.sum(axis=0) / size, 0, atol=1e-11)
    moment = np.cross(assembly.mesh.nodes, forces).sum(axis=0)
    np.testing.assert_allclose(moment / size, 0, atol=1e-7)
    field = np.random.default_rng(seed).normal(size=3)
    both = assembly.mesh.nodes @ field
    opened = joint.gap_operator @ np.outer(both, [0, 0, 1, 0, 0, 0]).ravel()
    np.testing.assert_allclose(opened, 0, atol=1e-7)


@settings(max_examples=15)
@given(kinds, kinds, counts, counts, angles, rules, seeds)
def test_rotating_and_moving_everything_changes_nothing(
    lower, upper, below, above, angle, quadrature, seed
):
    random = np.random.default_rng(seed)
    assembly = blocks((below, lower), (above, upper), move=turned(angle, 0.8))
    turn, shift = Rotation.random(rng=random).as_matrix(), random.uniform(-50, 50, 3)
    moved = bent(assembly, lambda nodes: nodes @ turn.T + shift)
    here, there = (mortar(one, quadrature=quadrature) for one in (assembly, moved))
    np.testing.assert_allclose(there.area, here.area, rtol=1e-9)
    # The same motion in both frames; segments may be cut into other triangles, so that contact
    # forces of a uniform pressure are compared, not points.
    forces = [nodal_forces(one, np.ones(one.n_points)) for one in (here, there)]
    np.testing.assert_allclose(forces[1], forces[0] @ turn.T, atol=1e-8 * here.area)
    # Coordinates of 100 round at 1e-14.
    np.testing.assert_allclose(there.initial_gap, 0, atol=1e-10)


@settings(max_examples=15)
@given(kinds, kinds, counts, counts, angles, offsets)
def test_either_side_may_carry_the_points(lower, upper, below, above, angle, offset):
    """A uniform pressure loads both sides alike, whichever is minus; so does its resultant."""
    assembly = blocks((below, lower), (above, upper), move=turned(angle, 0.8, offset))
    one = mortar(assembly)
    other = mortar(assembly, minus="upper", plus="lower")
    forces = [nodal_forces(joint, np.ones(joint.n_points)) for joint in (one, other)]
    # Both are ∫ N dA over the overlap, but for facets covered by less than a millionth.
    np.testing.assert_allclose(forces[1], forces[0], atol=1e-5 * SIZE[0] * SIZE[1])


@settings(max_examples=15)
@given(counts, counts, angles, seeds)
def test_renumbering_changes_no_projection(below, above, angle, seed):
    assembly = blocks((below, "hex8"), (above, "tet4"), move=turned(angle, 0.8))
    mesh = assembly.mesh
    random = np.random.default_rng(seed)
    place = random.permutation(len(mesh.nodes))
    order = np.argsort(place)
    renumbered = replace(
        assembly,
        mesh=replace(
            mesh,
            nodes=mesh.nodes[order],
            node_ids=mesh.node_ids[order],
            blocks=tuple(replace(block, nodes=place[block.nodes]) for block in mesh.blocks),
        ),
    )
    (before,), (after,) = (find_couplings(a, SPEC).values() for a in (assembly, renumbered))
    field = random.normal(size=(len(mesh.nodes), 3))
    found = np.empty((len(mesh.nodes), 3))
    found[order[after.pairs[:, 0]]] = after.motion @ field[order]
    assert (mesh.bodies[before.pairs[:, 0]] == 0).all()
    # Corners of barely covered facets extrapolate.
    np.testing.assert_allclose(found[before.pairs[:, 0]], before.motion @ field, atol=1e-7)
