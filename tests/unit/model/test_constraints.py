"""Elimination of couplings, equations and supports: what is kept, dropped and refused."""

import numpy as np
import pytest

from faying.exceptions import ModelError
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import Assembly, AverageCoupling, Equation, RigidCoupling, Support
from faying.model.constraints import constrain, movable_components
from faying.model.couplings.average import average_rows
from faying.model.couplings.rigid import rigid_rows
from faying.model.matrices import rigid_body_motions
from faying.model.mesh import Mesh

# Corners of a unit cube and a node outside it; ids differ from indices on purpose.
POINTS = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)] + [(2, 3, 4)], float)
OUTSIDE = 8
TRANSLATIONS = np.arange(6 * len(POINTS)) % 6 < 3


def assembly(**content):
    mesh = Mesh(nodes=POINTS, node_ids=100 + np.arange(len(POINTS)))
    return Assembly(mesh=mesh, **content)


def average(nodes, **options):
    return AverageCoupling(
        id=7, reference=OUTSIDE, nodes=nodes, weights=np.ones(len(nodes)), **options
    )


def test_without_constraints_every_used_component_is_free():
    dofs = constrain(assembly(), TRANSLATIONS)
    np.testing.assert_array_equal(dofs.free, np.flatnonzero(TRANSLATIONS))
    assert (dofs.transformation != dofs.transformation.astype(bool)).nnz == 0


def test_supported_and_unused_components_vanish():
    dofs = constrain(
        assembly(supports=(Support(id=1, nodes=[0, 1], components=(0, 2)),)), TRANSLATIONS
    )
    gone = ~TRANSLATIONS
    gone[[0, 2, 6, 8]] = True
    rows = np.diff(dofs.transformation.indptr)
    np.testing.assert_array_equal(rows == 0, gone)


def test_rotations_of_a_rigid_reference_appear_only_where_something_resists_them():
    # One node straight along x from its reference cannot feel the rotation about x.
    coupling = RigidCoupling(id=5, reference=0, nodes=[4])
    dofs = constrain(assembly(rigid_couplings=(coupling,)), TRANSLATIONS)
    assert {3, 4, 5} & set(dofs.free.tolist()) == {4, 5}


def test_rounding_of_coordinates_is_no_lever_arm():
    points = np.array([[0.0, 0.3, 0.0], [1.0, 0.1 + 0.2, 0.0]])
    mesh = Mesh(nodes=points, node_ids=[1, 2])
    model = Assembly(mesh=mesh, rigid_couplings=(RigidCoupling(id=5, reference=0, nodes=[1]),))
    free = constrain(model, TRANSLATIONS[:12]).free
    assert points[1, 1] != points[0, 1]
    assert 3 not in free


def test_a_rotation_tied_only_to_unused_rotations_is_dropped():
    coupling = RigidCoupling(id=5, reference=OUTSIDE, nodes=[0, 1, 2], components=(3, 4, 5))
    used = TRANSLATIONS.copy()
    used[6 * OUTSIDE :] = False
    dofs = constrain(assembly(rigid_couplings=(coupling,)), used)
    assert dofs.free.max() < 6 * OUTSIDE


def test_free_degrees_of_freedom_ascend_and_indices_are_sorted():
    coupling = RigidCoupling(id=5, reference=OUTSIDE, nodes=[0, 1, 2])
    dofs = constrain(assembly(rigid_couplings=(coupling,)), TRANSLATIONS)
    assert np.all(np.diff(dofs.free) > 0)
    assert dofs.transformation.has_sorted_indices


def test_movable_components_are_those_with_something_behind_them():
    content = {
        "average_couplings": (average([0, 1, 2, 4]),),
        "supports": (Support(id=1, nodes=[3], components=(0,)),),
    }
    used = TRANSLATIONS.copy()
    used[6 * OUTSIDE :] = False
    movable = movable_components(assembly(**content), used)
    assert movable[6 * OUTSIDE :].all()
    assert not movable[18]
    assert movable[19]
    assert not movable[3:6].any()


def test_averaged_rotations_of_solid_nodes_are_left_out():
    used = TRANSLATIONS.copy()
    used[6 * OUTSIDE :] = True
    plain = constrain(assembly(average_couplings=(average([0, 1, 2, 4]),)), used)
    listed = average([0, 1, 2, 4], components=(0, 1, 2, 3, 4, 5))
    careless = constrain(assembly(average_couplings=(listed,)), used)
    np.testing.assert_array_equal(plain.free, careless.free)
    # Same least squares problem; only rounding differs.
    assert abs(plain.transformation - careless.transformation).max() < 1e-13


def test_a_full_inclined_support_is_a_plain_one():
    axes = np.linalg.qr(np.arange(9.0).reshape(3, 3) + np.eye(3))[0]
    support = Support(id=1, nodes=[0], components=(0, 1, 2), axes=axes)
    T = constrain(assembly(supports=(support,)), TRANSLATIONS).transformation
    assert T[:3].nnz == 0


def test_an_inclined_support_spares_the_loaded_component():
    axes = np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]])
    support = Support(id=1, nodes=[0], components=(0,), axes=axes)
    assert 0 in constrain(assembly(supports=(support,)), TRANSLATIONS, keep=[0]).free


def test_equation_with_a_loaded_first_term_is_solved_for_another():
    equation = Equation(id=3, terms=((0, 0, 2.0), (1, 0, -1.0), (2, 0, 0.5)))
    dofs = constrain(assembly(equations=(equation,)), TRANSLATIONS, keep=[0])
    u = dofs.nodal(np.random.default_rng(1).standard_normal(len(dofs.free)))
    assert 0 in dofs.free
    # Three products of order one.
    assert abs(2 * u[0, 0] - u[1, 0] + 0.5 * u[2, 0]) < 1e-14


def test_two_loaded_averages_over_the_same_nodes_stay_solvable():
    first = average([0, 1, 2, 4])
    second = AverageCoupling(id=8, reference=7, nodes=[0, 1, 2, 4], weights=[1.0, 2, 3, 4])
    keep = np.r_[6 * OUTSIDE : 6 * OUTSIDE + 6, 42:48]
    used = TRANSLATIONS.copy()
    used[keep] = False
    dofs = constrain(assembly(average_couplings=(first, second)), used, keep=keep)
    assert set(keep) <= set(dofs.free.tolist())
    assert len(dofs.free) == np.count_nonzero(used)


RIGID = RigidCoupling(id=5, reference=OUTSIDE, nodes=[0, 1])
TURNED = np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]])
REFUSED = {
    "own reference": (
        {"rigid_couplings": (RigidCoupling(id=5, reference=0, nodes=[0, 1]),)},
        (),
        r"rigid coupling 5: its reference node 100",
    ),
    "average over its reference": (
        {"average_couplings": (average([0, 1, 2, OUTSIDE]),)},
        (),
        r"average coupling 7: its reference node 108",
    ),
    "average over a line": (
        {"average_couplings": (average([0, 1]),)},
        (),
        r"average coupling 7: the motion of its 2 nodes.*reference node 108.*span a plane",
    ),
    "weight of zero": (
        {"average_couplings": (AverageCoupling(id=7, reference=8, nodes=[0], weights=[0.0]),)},
        (),
        r"average coupling 7: needs at least one node and one positive weight",
    ),
    "zero coefficient": (
        {"equations": (Equation(id=3, terms=((0, 1, 0.0), (1, 1, 1.0))),)},
        (),
        r"equation 3.*node 100, component uy, is zero",
    ),
    "no terms": ({"equations": (Equation(id=3, terms=()),)}, (), r"equation 3 has no terms"),
    "load on a support": (
        {"supports": (Support(id=9, nodes=[1], components=(2,)),)},
        (8,),
        r"load on a fixed degree of freedom: node 101, component uz.*release",
    ),
    "load on nothing": ({}, (3,), r"node 100, component rx, cannot take a load"),
    "load held along an inclined direction": (
        {"supports": (Support(id=9, nodes=[1], components=(0,), axes=TURNED),)},
        (6, 7),
        r"support 9 holds node 101, component u[xy] along an inclined direction",
    ),
    "loads tied to one another": (
        {"rigid_couplings": (RIGID,)},
        tuple(range(3)) + tuple(range(6, 9)) + tuple(range(48, 54)),
        r"loads enter.*node 100, component ux.*rigid coupling 5.*reference node instead",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_with_names_and_remedy(case):
    content, keep, message = REFUSED[case]
    with pytest.raises(ModelError, match=message):
        constrain(assembly(**content), TRANSLATIONS, keep=keep)


CONFLICTS = {
    "dependent twice": {
        "rigid_couplings": (RIGID, RigidCoupling(id=6, reference=7, nodes=[1])),
    },
    "dependent and supported": {
        "rigid_couplings": (RIGID,),
        "supports": (Support(id=9, nodes=[1], components=(2,)),),
    },
    "circle": {
        "rigid_couplings": (
            RigidCoupling(id=5, reference=1, nodes=[0]),
            RigidCoupling(id=6, reference=0, nodes=[1]),
        )
    },
    "the same twice": {"rigid_couplings": (RIGID, RIGID)},
    "reference in another": {
        "rigid_couplings": (RIGID, RigidCoupling(id=6, reference=7, nodes=[OUTSIDE, 2])),
        "average_couplings": (average([0, 1, 2, 3, 4], reference_components=(0, 1, 2)),),
    },
}


@pytest.mark.parametrize("case", CONFLICTS)
def test_couplings_that_claim_the_same_components_hold_all_together(case):
    """The motions left are those of all equations at once, by a dense decomposition of them."""
    content = CONFLICTS[case]
    used = np.ones(6 * len(POINTS), dtype=bool)
    T = constrain(assembly(**content), used).transformation.toarray()
    parts = [rigid_rows(assembly(**content)), average_rows(assembly(**content), used)]
    rows = np.vstack([np.eye(len(used))[part.dependent] - part.matrix for part in parts])
    held = [
        6 * node + c for s in content.get("supports", ()) for node in s.nodes for c in s.components
    ]
    rows = np.vstack([rows, np.eye(len(used))[held]])
    # Rounding of a handful of additions, and of a solution of twenty equations.
    assert np.abs(rows @ T).max() < 1e-12
    assert np.linalg.matrix_rank(T) == T.shape[1] == len(used) - np.linalg.matrix_rank(rows)


def test_an_average_over_a_line_may_tie_what_the_line_determines():
    used = TRANSLATIONS.copy()
    used[6 * OUTSIDE :] = False
    on_line = AverageCoupling(
        id=7, reference=0, nodes=[1, OUTSIDE], weights=[1.0, 1.0], reference_components=(0,)
    )
    # The reference is off the line, so even its translation is undetermined …
    with pytest.raises(ModelError, match="does not determine ux"):
        constrain(assembly(average_couplings=(on_line,)), used)
    # … but a line through it would do.
    points = POINTS.copy()
    points[0] = (POINTS[1] + POINTS[OUTSIDE]) / 2
    mesh = Mesh(nodes=points, node_ids=np.arange(len(points)))
    model = Assembly(mesh=mesh, average_couplings=(on_line,))
    T = constrain(model, TRANSLATIONS).transformation.toarray()
    # Mean of two nodes at equal distance.
    assert T[0].max() == pytest.approx(0.5, abs=1e-12)


def test_a_loaded_mean_of_many_nodes_is_one_of_groups():
    """Solved for the components of a few nodes, rows of all others would fill these."""
    mesh = lap_joint_assembly(element_size=2.5).assembly.mesh
    top = np.flatnonzero(mesh.nodes[:, 2] > 0)
    reference = len(mesh.nodes)
    mean = AverageCoupling(id=1, reference=reference, nodes=top, weights=1.0 + top % 3)
    model = Assembly(mesh=mesh.with_nodes(np.array([60.0, 1.0, 2.0])), average_couplings=(mean,))
    used = np.arange(6 * (reference + 1)) % 6 < 3
    dofs = constrain(model, used, keep=6 * reference + np.arange(6))
    T = dofs.transformation
    assert T.shape[1] == 3 * reference
    assert np.diff(T.indptr).max() < len(top)
    moved = T @ np.random.default_rng(4).normal(size=T.shape[1])
    rows = average_rows(model, used)
    np.testing.assert_allclose(rows.matrix @ moved, moved[rows.dependent], atol=1e-11)
    rigid = rigid_body_motions(model.mesh.nodes, np.zeros(3))
    translations = np.append(np.flatnonzero(used), 6 * reference + np.arange(6))
    np.testing.assert_allclose((T @ rigid[dofs.free])[translations], rigid[translations], atol=1e-9)
