"""Properties every basis and reduced model has, whatever the loads."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import faying as fy
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.projection import residual_compliance

LOAD = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
BOX = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)})
COMPONENTS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
loads = st.tuples(*[st.floats(-1, 1)] * 6, st.floats(0.3, 1.5))


def drawn_load(values, model):
    *components, factor = values
    scale = (2000.0, 500.0, 500.0, 2e4, 2e4, 2e4)
    forces = {f"tip.{n}": s * v for n, s, v in zip(COMPONENTS, scale, components, strict=True)}
    return fy.Load(forces, bolt_forces={"bolt": factor * model.bolts["bolt"].initial_force})


@pytest.fixture(scope="module")
def small():
    """A joint small enough for dense matrices of all its degrees of freedom."""
    model = fy.lap_joint(
        element_size=10.0,
        hole_radius=None,
        washer_radius=10.0,
        damping=fy.Rayleigh(alpha=160.0, beta=5e-7),
    )
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


@pytest.fixture(scope="module")
def everything(small):
    """The identity as a basis: boundary first, as a superelement orders them."""
    n, boundary = small.structure.n_dof, small.structure.boundary
    order = np.concatenate([boundary, small.structure.interior])
    kinds = (ModeKind.CONSTRAINT,) * len(boundary) + (ModeKind.NORMAL,) * (n - len(boundary))
    return Basis(vectors=np.eye(n)[:, order], kinds=kinds)


@pytest.fixture(scope="module")
def bases(joint, classic):
    forces = fy.static_snapshots(joint, BOX.static_loads(joint))
    return {
        "craig-bampton": classic,
        "jim-a": fy.jim_a(joint, joint_modes=20, classic=classic),
        "jim-a, W = I": fy.jim_a(joint, joint_modes=20, classic=classic, weight="I"),
        "jim-b": fy.jim_b(joint, forces, joint_modes=20, classic=classic),
    }


NAMES = ["craig-bampton", "jim-a", "jim-a, W = I", "jim-b"]


@pytest.mark.parametrize("compliance", [False, True])
def test_identity_basis_is_the_full_model_in_statics(small, everything, compliance):
    rom = fy.reduce(small, everything, compliance=compliance)
    for penalty in ("as it is", "hard"):
        full = small if penalty == "as it is" else small.with_penalty(np.inf)
        rom = fy.reduce(full, everything, compliance=compliance)
        expected, found = fy.solve_static(full, LOAD), fy.solve_static(rom, LOAD)
        check_same(fy.full_displacement(full, found), expected.states)
        check_same(found.pressure if penalty == "as it is" else found.gap,
                   expected.pressure if penalty == "as it is" else expected.gap)  # fmt: skip
        check_same(found.displacement("tip"), expected.displacement("tip"))
        assert found.bolt_force("bolt") == pytest.approx(expected.bolt_force("bolt"), rel=1e-9)


@pytest.mark.parametrize("compliance", [False, True])
@pytest.mark.parametrize(
    "scheme", [fy.ImplicitEuler(), fy.GeneralizedAlpha(0.8), fy.EnergyDecaying()]
)
def test_identity_basis_is_the_full_model_in_time(small, everything, scheme, compliance):
    rom = fy.reduce(small, everything, compliance=compliance)
    expected, found = (
        fy.solve_transient(system, LOAD, step=2e-5, duration=4e-4, integrator=scheme)
        for system in (small, rom)
    )
    check_same(fy.full_displacement(small, found), expected.states)
    check_same(found.pressure, expected.pressure)


def check_same(found, expected):
    # Dense and sparse factors differ by round-off times the condition of K, 1e6 here.
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("name", NAMES)
def test_static_displacements_are_exact_everywhere_with_compliance(name, bases, joint):
    rom = fy.reduce(joint, bases[name], compliance=True)
    loads = [LOAD, fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})]
    found, expected = (fy.solve_static_cases(system, loads) for system in (rom, joint))
    check_same(fy.full_displacement(joint, found), expected.states)
    one = fy.full_displacement(joint, fy.solve_static(rom, LOAD))
    check_same(one, fy.full_displacement(joint, found)[0])


def test_displacements_with_compliance_show_the_gaps_of_the_solution(bases, joint):
    """Plates drawn from the trial vectors alone interpenetrate, or gape where they touch."""
    rom = fy.reduce(joint, bases["craig-bampton"], compliance=True)
    motion = fy.solve_transient(rom, LOAD, step=2e-5, duration=4e-4)
    moved = fy.full_displacement(joint, motion) @ joint.contact.relative_operator.T
    shown = moved @ joint.contact.interpolation.T + joint.contact.initial_gap
    check_same(shown, motion.gap)


def test_identity_basis_leaves_no_compliance(small, everything):
    rest = residual_compliance(small, everything)
    full = small.structure.held_compliance
    assert np.abs(rest).max() < 1e-10 * np.abs(full).max()  # round-off of the difference


@pytest.mark.parametrize("name", NAMES)
def test_boundary_rows_are_identity_and_zero(name, bases, joint):
    basis, boundary = bases[name], joint.structure.boundary
    constraint = basis.of_kind(ModeKind.CONSTRAINT)
    rest = basis.of_kind(ModeKind.NORMAL, ModeKind.BOLT, ModeKind.JOINT)
    np.testing.assert_array_equal(constraint[boundary], np.eye(len(boundary)))
    np.testing.assert_array_equal(rest[boundary], 0)
    assert constraint.shape[1] + rest.shape[1] == len(basis)
    every = np.sort(np.concatenate([boundary, joint.structure.interior]))
    np.testing.assert_array_equal(every, np.arange(joint.structure.n_dof))


@pytest.mark.parametrize("name", NAMES)
def test_held_shapes_are_orthonormal_in_the_stiffness(name, bases, joint):
    basis = bases[name]
    held = basis.of_kind(ModeKind.NORMAL, ModeKind.BOLT, ModeKind.JOINT)
    # Gram-Schmidt twice: round-off times the ratio of the energies of a shape and what is new.
    np.testing.assert_allclose(held.T @ (joint.K @ held), np.eye(held.shape[1]), atol=1e-10)
    coupling = basis.of_kind(ModeKind.CONSTRAINT).T @ (joint.K @ held)
    stiffness = np.sqrt(np.diag(joint.structure.boundary_stiffness))
    assert (np.abs(coupling) < 1e-8 * stiffness[:, None]).all()  # static shapes are K-orthogonal


@pytest.mark.parametrize("name", NAMES[1:])
def test_fewer_joint_modes_are_the_first_ones(name, bases, joint, classic):
    basis = bases[name]
    five = {
        "jim-a": lambda: fy.jim_a(joint, joint_modes=5, classic=classic),
        "jim-a, W = I": lambda: fy.jim_a(joint, joint_modes=5, classic=classic, weight="I"),
        "jim-b": lambda: fy.jim_b(
            joint,
            fy.static_snapshots(joint, BOX.static_loads(joint)),
            joint_modes=5,
            classic=classic,
        ),
    }[name]()
    shorter = basis.with_joint_modes(5)
    assert shorter.count(ModeKind.JOINT) == 5
    assert shorter.kinds == five.kinds
    # The same arithmetic on the same columns; matrix products of other widths round differently.
    scale = np.abs(five.vectors).max(axis=0)
    assert (np.abs(shorter.vectors - five.vectors).max(axis=0) < 1e-8 * scale).all()
    assert len(basis.with_joint_modes(0)) == len(classic)
    assert len(basis.with_joint_modes(1000)) == len(basis)


def test_normal_modes_diagonalize_mass(joint, classic):
    normal = classic.of_kind(ModeKind.NORMAL)
    mass = normal.T @ (joint.M @ normal)
    squares = 1 / np.diag(mass)  # K is the identity here
    off = mass - np.diag(np.diag(mass))
    assert np.abs(off).max() < 1e-9 * mass.max()  # eigensolver tolerance
    assert (np.diff(squares) > 0).all()


@pytest.mark.parametrize("name", NAMES)
def test_residual_compliance_is_positive_semidefinite_and_shrinks(name, bases, joint):
    rest = residual_compliance(joint, bases[name])
    values = np.linalg.eigvalsh(rest)
    # A difference of compliances known to 3e-13 (any factorization of K, condition 1e7).
    round_off = 1e-12 * np.linalg.eigvalsh(joint.structure.held_compliance)[-1]
    assert values.min() > -round_off
    assert values.max() > 100 * round_off
    # A larger basis can only lower it.
    lowered = residual_compliance(joint, bases["craig-bampton"]) - rest
    assert np.linalg.eigvalsh(lowered)[0] > -round_off


@pytest.mark.parametrize("name", NAMES)
def test_residual_compliance_is_what_the_basis_misses(name, bases, joint):
    """P K⁻¹ Pᵀ − PΦ K_r⁻¹ (PΦ)ᵀ, by its definition, (M5)."""
    rom = fy.reduce(joint, bases[name])
    missing = joint.port_compliance.relative - rom.port_compliance.relative
    small = 1e-9 * np.abs(joint.port_compliance.relative).max()  # condition of K
    np.testing.assert_allclose(residual_compliance(joint, bases[name]), missing, rtol=0, atol=small)


@settings(max_examples=10)
@given(loads)
@pytest.mark.parametrize("name", NAMES)
def test_statics_with_compliance_are_exact(name, bases, joint, values):
    load = drawn_load(values, joint)
    rom = fy.reduce(joint, bases[name], compliance=True)
    fast, full = fy.solve_static(rom, load), fy.solve_static(joint, load)
    # Exact by (M5); round-off times the condition of K, 1e-11 is usual.
    small = 1e-8 * full.max_pressure
    np.testing.assert_allclose(fast.pressure, full.pressure, rtol=0, atol=small)
    small = 1e-9 * np.abs(full.displacement("tip")).max()
    np.testing.assert_allclose(
        fast.displacement("tip"), full.displacement("tip"), rtol=0, atol=max(small, 1e-12)
    )


@settings(max_examples=10)
@given(loads, st.integers(0, 19), st.integers(1, 20))
@pytest.mark.parametrize("name", ["jim-a", "jim-b"])
def test_more_modes_never_raise_the_energy_error(name, bases, joint, values, fewer, more):
    """Galerkin's best approximation in a linear problem: contact forces given, gap ignored."""
    inputs = drawn_load(values, joint).inputs(joint, np.zeros(1))[0]
    contact = fy.solve_static(joint).contact_forces * (1 + np.arange(joint.contact.n_points) % 3)
    force = joint.contact.gap_operator.T @ contact
    force += fy.joint.system.input_forces(joint, inputs)
    exact = joint.factorize_static().solve(force)
    errors = [
        energy_error(joint, bases[name].with_joint_modes(n), force, exact)
        for n in (fewer, fewer + more)
    ]
    assert errors[1] <= errors[0] * (1 + 1e-9) + 1e-9 * exact @ (joint.K @ exact)


def energy_error(model, basis, force, exact):
    phi = basis.vectors
    rest = exact - phi @ np.linalg.solve(phi.T @ (model.K @ phi), phi.T @ force)
    return rest @ (model.K @ rest)


def test_reduced_static_energy_is_never_below_the_full_one(bases, joint):
    """Ritz: with contact too, a smaller space cannot lower the potential energy."""
    full = potential_energy(fy.solve_static(joint, LOAD))
    assert full < 0
    for basis in bases.values():
        lower = [
            potential_energy(fy.solve_static(fy.reduce(joint, basis.with_joint_modes(n)), LOAD))
            for n in (0, 5, 10, 20)
        ]
        assert (np.diff(lower) <= 1e-9 * abs(full)).all()  # round-off
        assert lower[-1] >= full - 1e-9 * abs(full)


def potential_energy(solution):
    system, u = solution.system, solution.states
    external = fy.joint.system.input_forces(system, solution.inputs)
    contact = 0.5 * solution.contact_forces**2 @ system.contact.flexibility
    return 0.5 * u @ (system.K @ u) - external @ u + contact


def test_joint_modes_help(bases, joint):
    """The seed's qualitative statement: joint modes lower the pressure error."""
    full = fy.solve_static(joint.with_penalty(1e4), LOAD)
    errors = {
        name: [
            fy.compare(
                fy.solve_static(fy.reduce(full.system, basis.with_joint_modes(n)), LOAD), full
            ).max_relative_error
            for n in (0, 20)
        ]
        for name, basis in bases.items()
    }
    # Which method is ahead takes a fine mesh to see; here 20 modes nearly fill 28 facets.
    for name in ("jim-a", "jim-b"):
        assert errors[name][1] < 0.3 * errors[name][0]
