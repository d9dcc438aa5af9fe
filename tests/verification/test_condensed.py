"""The condensed solution against Newton's method on the full finite element equations."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.contact.laws import Hard, Penalty
from faying.exceptions import ConvergenceError
from faying.joint.system import input_forces
from lap_joints import tiny_lap

COMPONENTS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
LARGEST = np.array([2000.0, 500.0, 500.0, 2e4, 2e4, 2e4])


def random_load(rng, model):
    """All six components at the tip and a preload factor of its own for every bolt."""
    values = (rng.uniform(-1, 1, 6) * LARGEST).tolist()
    bolts = {name: rng.uniform(0.3, 1.5) * bolt.initial_force for name, bolt in model.bolts.items()}
    return fy.Load(
        {f"tip.{name}": value for name, value in zip(COMPONENTS, values, strict=True)},
        bolt_forces=bolts,
    )


def check_random_loads(model, count, seed=0):
    rng = np.random.default_rng(seed)
    loads = [random_load(rng, model) for _ in range(count)]
    together = fy.solve_static_cases(model, loads)
    for case, load in enumerate(loads):
        newton = fy.solve_static_newton(model, load)
        check_same(together.states[case], together.pressure[case], newton)


def check_same(states, pressure, newton):
    assert newton.max_pressure > 1.0  # the loads do press the parts together
    # Both are exact but for round-off times the condition of K (1e7); 1e-11 is measured.
    small = 1e-9 * np.abs(newton.states).max()
    np.testing.assert_allclose(states, newton.states, rtol=0, atol=small)
    small = 1e-9 * newton.max_pressure
    np.testing.assert_allclose(pressure, newton.pressure, rtol=0, atol=small)


@pytest.fixture(scope="module")
def hard_joint():
    return fy.preload(fy.lap_joint(element_size=5.0, penalty="hard"), {"bolt": 10e3})


def tightened(penalty, joint):
    model = joint if penalty == "auto" else joint.with_penalty(penalty)
    return model.with_bolt_forces(fy.tighten(model, {"bolt": 10e3}).initial_forces)


SLOW = pytest.mark.slow


@pytest.mark.parametrize(("count", "seed"), [(12, 0), pytest.param(80, 1, marks=SLOW)])
@pytest.mark.parametrize("penalty", [1e4, 1e5, "auto"])
def test_penalty_contact_under_random_loads(penalty, joint, count, seed):
    check_random_loads(tightened(penalty, joint), count, seed)


@pytest.mark.parametrize(("count", "seed"), [(10, 0), pytest.param(80, 1, marks=SLOW)])
def test_hard_contact_under_random_loads(hard_joint, count, seed):
    assert np.isinf(hard_joint.interfaces["joint"].penalty)
    assert hard_joint.interfaces["joint"].quadrature == "nodal"
    check_random_loads(hard_joint, count, seed)


@pytest.mark.long
def test_default_mesh(fine_joint):
    check_random_loads(fine_joint, 2)


@pytest.mark.slow
@pytest.mark.parametrize("penalty", [1e4, 1e5, "auto"])
def test_default_mesh_under_more_loads(penalty, fine_joint):
    check_random_loads(tightened(penalty, fine_joint), 5, seed=2)


# Contact alone holds a middle plate; its linear stiffness comes from springs at the tip.
HELD = {"tip_suspension": (1e4, 1e7)}


@pytest.mark.parametrize(
    "parameters",
    [
        {"curvature": 0.01},
        {"plates": 3, "bolt_positions": ((-10.0, 0.0), (10.0, 0.0)), **HELD},
        {"plates": 3, "curvature": 0.005, "washer": "rbe3", **HELD},
        {"shape": "tet10", "element_size": 10.0, "hole_radius": None},
        {"shape": "hex20", "element_size": 10.0, "hole_radius": None},
        {"shape": "wedge6"},
        {"curvature": 0.01, "penalty": "hard"},
    ],
    ids=lambda p: " ".join(f"{k}={v}" for k, v in p.items()),
)
def test_other_joints(parameters):
    model = fy.lap_joint(**{"element_size": 5.0, **parameters})
    model = fy.preload(model, dict.fromkeys(model.bolts, 10e3))
    check_random_loads(model, 3)


def test_initial_gap_and_interference(joint):
    points = joint.interfaces["joint"].points
    for height in (2e-3, -2e-3):  # a crowned surface that touches in the middle, and the reverse
        gap = height * (np.linalg.norm(points[:, :2], axis=1) / 20) ** 2
        check_random_loads(joint.with_initial_gap("joint", gap), 3)


def test_softly_hung_middle_plate():
    model = fy.lap_joint(element_size=5.0, plates=3)
    model = fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())
    load = fy.Load({"tip.Fz": -300.0, "tip.My": 1e4})
    condensed, newton = fy.solve_static(model, load), fy.solve_static_newton(model, load)
    # 1 N/mm holds the plate until contact closes: free gaps are 300 mm, of which round-off takes
    # 1e-11 and the penalty of 4e5 makes 1e-5 of 100 MPa.
    small = 1e-6 * newton.max_pressure
    np.testing.assert_allclose(condensed.pressure, newton.pressure, rtol=0, atol=small)


def test_soft_and_hard_interfaces_together():
    model = fy.lap_joint(element_size=5.0, plates=3, quadrature="nodal", **HELD)
    hard = {"joint-2": model.interfaces["joint-2"].with_penalty(np.inf)}
    model = fy.preload(model.with_interfaces(hard), {"bolt": 10e3})
    check_random_loads(model, 3)


def test_redundant_hard_contact_has_the_displacements_of_a_stiff_penalty(joint):
    """Four Gauss points a facet are more than the normal displacements can close singly."""
    load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})
    hard = fy.solve_static(joint.with_penalty(np.inf), load)
    stiff = fy.solve_static_newton(joint.with_penalty(1e9), load)
    # The penalty leaves a penetration of p/c_n = 1e-7, which the lever to the tip makes 1e-6.
    np.testing.assert_allclose(hard.states, stiff.states, rtol=0, atol=2e-6)
    assert hard.contact_force() == pytest.approx(stiff.contact_force(), rel=1e-5)  # 1e-7 of 0.01
    assert hard.max_penetration < 1e-12  # round-off of displacements of order 1


def test_equilibrium_and_contact_law_hold(joint):
    """The equations themselves, without another solver."""
    rng = np.random.default_rng(3)
    contact = joint.contact
    for load in [random_load(rng, joint) for _ in range(5)]:
        s = fy.solve_static(joint, load)
        external = input_forces(joint, s.inputs)
        residual = joint.K @ s.states - external - contact.gap_operator.T @ s.contact_forces
        # Round-off of K u, whose entries reach 1e6 times displacements of order 1.
        np.testing.assert_allclose(residual, 0, atol=1e-8 * np.abs(external).max())
        gap = contact.initial_gap + contact.gap_operator @ s.states
        np.testing.assert_allclose(s.gap, gap, rtol=0, atol=1e-12)  # round-off of order-1 sums
        law = contact.penalty * np.maximum(-s.gap, 0.0)
        # 1e-12 of gap times the penalty 4e5.
        np.testing.assert_allclose(s.pressure, law, rtol=0, atol=1e-6 * s.max_pressure)


def test_contact_forces_are_equal_and_opposite(joint):
    """Newton's third law: no net force or moment, whatever the pressure."""
    contact = joint.contact
    forces = contact.gap_operator.T @ fy.solve_static(joint).contact_forces
    for motion in rigid_motions(joint):
        total, gross = forces @ motion, np.abs(forces) @ np.abs(motion)
        assert abs(total) <= 1e-13 * gross  # rounding of a sum


def rigid_motions(model):
    """Three translations and three rotations about the origin at the free degrees of freedom."""
    node, component = model.dofs.free // 6, model.dofs.free % 6
    place, plain = model.assembly.mesh.nodes[node], component < 3
    for axis in np.eye(3):
        yield np.where(plain, axis[component % 3], 0.0)
    for axis in np.eye(3):
        turned = np.cross(axis, place)[np.arange(len(node)), component % 3]
        yield np.where(plain, turned, axis[component % 3])


def test_cases_together_are_the_cases_alone(joint):
    rng = np.random.default_rng(5)
    loads = [random_load(rng, joint) for _ in range(6)]
    together = fy.solve_static_cases(joint, loads)
    for case, load in enumerate(loads):
        alone = fy.solve_static(joint, load)
        # A warm start changes the order of no sum that matters; matrix products may round apart.
        small = 1e-10 * alone.max_pressure
        np.testing.assert_allclose(together.pressure[case], alone.pressure, rtol=0, atol=small)
        np.testing.assert_allclose(together.states[case], alone.states, rtol=0, atol=1e-11)


def test_compliance_is_that_of_the_stiffness(joint):
    """S = G K⁻¹ Gᵀ, once from the boundary-held factorization and once from a new one."""
    kept = fy.interface_compliance(joint)
    anew = fy.interface_compliance(joint, fy.factorize(joint.K))
    # Round-off times the condition of K.
    np.testing.assert_allclose(kept, anew, rtol=0, atol=1e-10 * np.abs(anew).max())


def test_newton_says_that_redundant_hard_contact_is_singular():
    """Four Gauss points a facet again: the saddle-point equations have no unique solution."""
    coarse = tiny_lap(penalty="hard", quadrature="gauss")
    coarse = fy.preload(coarse, {"bolt": 10e3})
    with pytest.raises(ConvergenceError, match=r"closes \d+ points .* singular; take nodal"):
        fy.solve_static_newton(coarse, fy.Load({"tip.Fz": -500.0}))


def test_hard_contact_that_a_basis_cannot_close_names_the_basis():
    """One mode between two stops that both press it: opening one closes the other."""
    contact = Contact(
        relative_operator=np.array([[1.0], [-1.0]]),
        interpolation=sp.csr_array(np.eye(2)),
        initial_gap=-np.ones(2),
        weights=np.ones(2),
        laws={"joint": Hard()},
        slices={"joint": slice(0, 2)},
    )
    compliance = contact.relative_operator @ contact.relative_operator.T
    condensed = CondensedContact(contact=contact, compliance=compliance)
    with pytest.raises(ConvergenceError, match=r"hard at 2 points, but the model has 1 degrees"):
        condensed.increments.solve(np.zeros(2), contact.offset())
    soft = CondensedContact(
        contact=replace(contact, laws={"joint": Penalty(1.0)}), compliance=compliance
    )
    found = soft.increments.solve(np.zeros(2), contact.offset())
    np.testing.assert_allclose(found.forces[0], [1.0, 1.0], rtol=1e-12)
