"""Contact by sparse factors, for interfaces that dense matrices have no room for, against dense."""

import pickle
from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.contact.sparse_pairs import SparsePairs
from faying.exceptions import ModelError
from faying.linalg.factorization import factorize
from faying.linalg.partial import port_compliance
from faying.linalg.sparse_stiffness import SparseStiffness
from faying.simulation.tightening import tightened_joint

TINY = 1e3
"""Budget in bytes that no dense matrix fits into."""

BOLT = {"bolt": 10e3}
LC2 = fy.Load({"tip.Fz": -20.0, "tip.Mx": 500.0}, name="LC2")
TO_AND_FRO = [fy.Load()] + [LC2.scaled(factor) for factor in (0.5, 1.0, 0.0, -4.0, 3.0)]


def assert_alike(mine, exact):
    np.testing.assert_allclose(mine, exact, rtol=0, atol=1e-9 * np.abs(exact).max(initial=0.0))


@pytest.fixture(scope="module")
def joints():
    """The same tightened joint, dense and sparse."""
    model = fy.lap_joint(element_size=5.0)
    return [fy.preload(joint, BOLT) for joint in (model, model.with_dense_budget(TINY))]


def test_products_and_inverses_are_those_of_the_whole_stiffness(joints):
    dense = joints[0].with_friction(0.2)
    K, ports = dense.K, dense.structure.relative_operator
    whole = np.linalg.inv(port_compliance(ports, factorize(K)))
    sparse, random = SparseStiffness.of(K, ports), np.random.default_rng(0)
    moved = random.normal(size=len(whole))
    assert_alike(sparse.times(moved), whole @ moved)
    rows = dense.contact.rows
    springs = (rows.T @ rows).tocsr() * np.diag(whole).mean()
    held = sparse.on_springs(springs)
    forces = random.normal(size=(len(whole), 2))
    assert_alike(sparse.moved_by(held, forces), np.linalg.solve(whole + springs.toarray(), forces))


def test_tightening_and_static_cases_are_those_of_dense_matrices(joints):
    dense, sparse = joints
    assert sparse.bolts["bolt"].initial_force == pytest.approx(
        dense.bolts["bolt"].initial_force, rel=1e-9
    )
    assert isinstance(sparse.static_contact.increments.pairs, SparsePairs)
    for load in (LC2, LC2.scaled(-5.0)):
        exact, mine = fy.solve_static(dense, load), fy.solve_static(sparse, load)
        for name in ("contact_forces", "gap", "states"):
            assert_alike(getattr(mine, name), getattr(exact, name))


@pytest.mark.parametrize("friction", [0.15, 0.6])
def test_paths_with_friction_are_those_of_dense_matrices(joints, friction):
    exact, mine = (fy.solve_path(j.with_friction(friction), TO_AND_FRO) for j in joints)
    assert (np.abs(exact.shear_slip[-1]) > 0).any()
    for name in ("contact_forces", "shear_forces", "shear_slip", "gap", "states", "dissipation"):
        assert_alike(getattr(mine, name), getattr(exact, name))


def test_digits_are_the_same_whatever_was_solved_before(joints):
    sparse = joints[1].with_friction(0.2)
    rest = fy.solve_path(sparse, TO_AND_FRO[:2])
    fy.solve_path(sparse, TO_AND_FRO)
    fresh = replace(sparse, structure=replace(sparse.structure))
    again, alone = (fy.solve_path(joint, [LC2.scaled(3.0)], rest) for joint in (sparse, fresh))
    np.testing.assert_array_equal(again.contact_forces, alone.contact_forces)
    np.testing.assert_array_equal(again.shear_forces, alone.shear_forces)


GASKET = fy.GasketClosure((0.0, 1e-5, 1e-4), (0.0, 2.0, 60.0), (4e5, 7e5, 9e5))


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_curves_that_remember_are_followed_alike(joints, friction):
    joints = [joint.with_closure(GASKET) for joint in joints]
    if friction:
        joints = [joint.with_friction(friction, 3e5) for joint in joints]
    exact, mine = (fy.solve_path(joint, TO_AND_FRO) for joint in joints)
    for name in ("contact_forces", "gap", "states", "deepest"):
        assert_alike(getattr(mine, name), getattr(exact, name))


def test_bolts_tightened_with_friction_have_their_forces(joints):
    exact, mine = (
        tightened_joint(joint.with_friction(0.2), BOLT, increments=3) for joint in joints
    )
    assert_alike(mine.tightening.bolt_forces, exact.tightening.bolt_forces)
    for name in ("contact_forces", "shear_forces", "shear_slip"):
        assert_alike(getattr(mine.rest(mine.joint), name), getattr(exact.rest(exact.joint), name))


def test_reduced_models_go_to_other_processes(joints):
    """As those of dense matrices do, without factors; digits are the same."""
    rom = fy.reduce(joints[1], fy.craig_bampton(joints[1], normal_modes=3), compliance=True)
    mine = fy.solve_static(rom, LC2)
    sent = pickle.loads(pickle.dumps(rom))
    np.testing.assert_array_equal(fy.solve_static(sent, LC2).contact_forces, mine.contact_forces)


def test_vibration_is_refused_by_name(joints):
    with pytest.raises(ModelError, match="this takes dense matrices between"):
        fy.frequency_response(joints[1], {"tip.Fz": 1.0}, [640.0], [1.0])
