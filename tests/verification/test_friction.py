"""Paths with Coulomb friction, against programs made without faying and against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from test_reference_cantilever import AXIAL, generated, node_map, reference_pressure

import faying as fy
from faying.assessment.stuck_modes import stuck_mode
from faying.contact import newton_descent
from faying.contact.augmented import AugmentedContact
from faying.contact.between_pairs import ByCompliance
from faying.contact.yielding import YieldingContact
from faying.digits import SOLVED
from faying.exceptions import ConvergenceError, ModelError, StudyError
from faying.export.formats import export
from faying.export.linearized import linearize
from faying.joint.system import input_forces
from faying.simulation.path import moved_alone, path_inputs
from lap_joints import tiny_lap

FRICTION, TANGENTIAL = 0.2, 8e5


def by_stages(contact, S):
    return AugmentedContact(contact=contact, between=ByCompliance(S))


def by_displacements(contact, S):
    return YieldingContact.of(contact, ByCompliance(S))


SOLVERS = (
    pytest.param(by_stages, id="stages"),
    pytest.param(by_displacements, id="displacements"),
)
LOADS = {
    "P": fy.Load(),
    "LC1": fy.Load({"tip.Fz": -500.0}),
    "LC2": fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}),
    "PULL": fy.Load({"tip.Fx": 3000.0}),
}


@pytest.fixture(scope="module")
def mesh(data):
    return np.load(data / "lap_joint" / "mesh.npz")


@pytest.fixture(scope="module", params=["gauss2", "lobatto"])
def rubbing(request, mesh):
    smooth = generated(request.param)
    model = smooth.with_friction(FRICTION, tangential_penalty=TANGENTIAL)
    return request.param, model, node_map(smooth, mesh)


@pytest.fixture(scope="module")
def gauss():
    return generated("gauss2").with_friction(FRICTION, tangential_penalty=TANGENTIAL)


@pytest.fixture(scope="module")
def coarse():
    model = fy.lap_joint(element_size=5.0, penalty=1e6).with_bolt_forces({"bolt": 8e3})
    return model.with_friction(0.3)


@pytest.mark.parametrize("case", LOADS)
def test_single_increments_are_those_of_the_reference(rubbing, mesh, data, case):
    """Displacement and bolt force to 1e-6, pressure and traction to 1e-5 of their peaks."""
    rule, model, order = rubbing
    solution = fy.solve_path(model, [LOADS[case]])
    expected = np.load(data / "friction" / f"G1_mu0.2_{case}.npz")
    u = model.dofs.nodal(solution.states[0])[order, :3]
    largest = np.abs(expected[f"u__{rule}"]).max()
    # The reference leaves 2e-12 of its forces; 6e-10 is measured here.
    np.testing.assert_allclose(u, expected[f"u__{rule}"], rtol=0, atol=1e-6 * largest)
    head, nut = (expected[f"aux__{rule}"][i] for i in (0, 2))
    bolt = 8000.0 + AXIAL * (head[2] - nut[2])
    np.testing.assert_allclose(solution.bolt_force("bolt"), bolt, rtol=1e-6)
    points = model.interfaces["joint"].points
    pressure = reference_pressure(mesh, points, expected[f"p_quad__{rule}"], rule)
    peak = pressure.max()
    np.testing.assert_allclose(solution.pressure[0], pressure, rtol=0, atol=1e-5 * peak)
    resisting = [reference_pressure(mesh, points, t, rule) for t in expected[f"t_quad__{rule}"].T]
    # The reference gives what resists the plus side; the plus side receives the opposite.
    np.testing.assert_allclose(
        -np.transpose(resisting), solution.traction[0, :, :2], rtol=0, atol=1e-5 * FRICTION * peak
    )


@pytest.mark.long
def test_a_cycle_of_pulls_is_that_of_the_reference(gauss, mesh, data):
    """Displacements and bolt force to 1e-6, fields at the reversals and energy per cycle to 1e-5.

    Both solve the same increments; 1e-9 is measured.
    """
    reference = np.load(data / "friction" / "G1_PULL_mu0.2_gauss2.npz")
    columns = [str(name) for name in reference["columns"]]
    of = {name: reference["history"][:, i] for i, name in enumerate(columns)}
    factors = np.concatenate(
        [[0.0], np.linspace(0, 1, 11)[1:], np.linspace(1, -1, 21)[1:], np.linspace(-1, 1, 21)[1:]]
    )
    solution = fy.solve_path(gauss, [fy.Load({"tip.Fx": 3000.0 * f}) for f in factors])
    tip = np.stack([of[f"tip_{axis}"] for axis in "xyz"], axis=1)
    np.testing.assert_allclose(
        solution.displacement("tip")[:, :3], tip, rtol=0, atol=1e-6 * np.abs(tip).max()
    )
    np.testing.assert_allclose(solution.bolt_force("bolt"), of["bolt_z"], rtol=1e-6)
    peak, most = of["p_max"].max(), of["t_max"].max()
    np.testing.assert_allclose(solution.max_pressure, of["p_max"], rtol=0, atol=1e-5 * peak)
    size = np.linalg.norm(solution.traction, axis=2)
    np.testing.assert_allclose(size.max(axis=1), of["t_max"], rtol=0, atol=1e-5 * most)
    slip_work, moved = of["slip_work"], solution.displacement("tip")[:, 0]
    cycle = slip_work[-40:].sum()
    assert solution.dissipation[-40:].sum() == pytest.approx(cycle, rel=1e-5)
    np.testing.assert_allclose(solution.dissipation, slip_work, rtol=0, atol=1e-5 * cycle)
    area = 3000.0 * np.trapezoid(factors[-41:], moved[-41:])
    assert area == pytest.approx(np.trapezoid(of["load"][-41:], tip[-41:, 0]), rel=1e-5)
    points = gauss.interfaces["joint"].points
    for name, at in {"preload": 0, "plus1": 10, "minus": 30, "plus2": 50}.items():
        pressure = reference_pressure(mesh, points, reference[f"{name}_p"], "gauss2")
        np.testing.assert_allclose(solution.pressure[at], pressure, rtol=0, atol=1e-5 * peak)
        for values, found, sign in (("t", solution.traction, -1), ("s", solution.slip, 1)):
            exact = [
                reference_pressure(mesh, points, one, "gauss2")
                for one in reference[f"{name}_{values}"].T
            ]
            scale = most if values == "t" else np.abs(solution.slip).max()
            # As in single increments: the reference gives what resists the plus side.
            np.testing.assert_allclose(
                sign * np.transpose(exact), found[at, :, :2], rtol=0, atol=1e-5 * scale
            )


def test_a_small_coefficient_is_frictionless(coarse):
    smooth = fy.lap_joint(element_size=5.0, penalty=1e6).with_bolt_forces({"bolt": 8e3})
    load = LOADS["LC2"]
    expected = fy.solve_static(smooth, load)
    for friction in (0.0, 1e-12):
        found = fy.solve_path(smooth.with_friction(friction), [load])
        np.testing.assert_allclose(
            found.pressure[0], expected.pressure, rtol=0, atol=1e-9 * expected.max_pressure
        )
    without = fy.solve_path(smooth, [load])  # a path of a joint without friction
    np.testing.assert_allclose(
        without.pressure[0], expected.pressure, rtol=0, atol=1e-9 * expected.max_pressure
    )


@pytest.mark.parametrize("case", ["LC2", "PULL"])
def test_a_large_coefficient_sticks_every_closed_point(gauss, case, monkeypatch):
    """By one sparse solution with springs at the points that close, and none elsewhere."""
    monkeypatch.setattr("faying.contact.laws.coulomb.LARGEST_FRICTION", np.inf)
    rough = gauss.with_friction(1e9, tangential_penalty=TANGENTIAL)
    found = fy.solve_path(rough, [LOADS[case]])
    contact, P = rough.contact, rough.contact.relative_operator
    closed = found.contact_forces[0] > 0
    G = sp.vstack([contact.interpolation @ P, contact.shear @ P]).tocsr()
    springs = np.repeat([1e6, TANGENTIAL, TANGENTIAL], contact.n_points)
    springs *= np.tile(closed * contact.weights, 3)
    external = input_forces(rough, found.inputs)[0]
    u = spla.spsolve((rough.K + G.T @ sp.diags_array(springs) @ G).tocsc(), external)
    np.testing.assert_allclose(found.states[0], u, rtol=0, atol=1e-9 * np.abs(u).max())
    forces = np.concatenate([found.contact_forces[0], *found.shear_forces[0]])
    # Digits of displacements, times the penalty.
    np.testing.assert_allclose(forces, -springs * (G @ u), rtol=0, atol=1e-8 * forces.max())
    assert (found.contact_forces[0] >= 0).all()
    assert (found.gap[0][~closed] >= 0).all()


def test_a_path_that_only_sticks_returns_to_its_start():
    model = fy.lap_joint(element_size=5.0, penalty=1e6).with_bolt_forces({"bolt": 8e3})
    model = model.with_friction(10.0)
    small = [fy.Load({"tip.Fx": 10.0 * f}) for f in (0.0, 1.0, -1.0, 1.0, 0.0)]
    solution = fy.solve_path(model, small)
    first, last = solution.traction[0], solution.traction[-1]
    largest = np.abs(solution.traction).max()
    np.testing.assert_allclose(last, first, rtol=0, atol=1e-8 * largest)


@pytest.mark.parametrize("solver_of", SOLVERS)
def test_turning_the_tangents_changes_nothing(gauss, solver_of):
    contact = gauss.contact
    solver = solver_of(contact, gauss.static_contact.total)
    cosine, sine = np.cos(0.7), np.sin(0.7)
    half = contact.shear.shape[0] // 2
    first, second = contact.shear[:half], contact.shear[half:]
    turned = sp.vstack([cosine * first + sine * second, cosine * second - sine * first]).tocsr()
    other, still = solver_of(replace(contact, shear=turned), solver.S), np.zeros(len(solver.S))
    rng = np.random.default_rng(0)
    z_free = 1e-3 * rng.standard_normal((3, contact.n_points))
    z_turned = z_free.copy()
    z_turned[1] = cosine * z_free[1] + sine * z_free[2]
    z_turned[2] = cosine * z_free[2] - sine * z_free[1]
    mine, theirs = solver.solve(still, z_free).forces, other.solve(still, z_turned).forces
    back = np.array([cosine * theirs[1] - sine * theirs[2], sine * theirs[1] + cosine * theirs[2]])
    small = 1e-9 * mine.max()  # the residual, times the condition
    np.testing.assert_allclose(theirs[0], mine[0], rtol=0, atol=small)
    np.testing.assert_allclose(back, mine[1:], rtol=0, atol=small)


def test_a_path_without_loads_is_refused(coarse):
    with pytest.raises(ModelError, match=r"the path has no loads; give at least one, fy\.Load"):
        fy.solve_path(coarse, [])


def test_tightening_that_is_not_solved_says_what_to_do(coarse, monkeypatch):
    # Nothing is solved to this.
    monkeypatch.setattr("faying.contact.augmented.SETTLED", -1.0)
    monkeypatch.setattr("faying.contact.newton_descent.SOLVED", 0.0)
    with pytest.raises(ConvergenceError, match="friction_during_preload = false"):
        fy.solve_path(coarse, [fy.Load()])


def test_the_preloaded_joint_vibrates_with_its_closed_points_stuck(gauss):
    found = fy.preloaded_frequencies(gauss, 5)
    # As the reference prints them, to 1e-3 Hz.
    expected = [648.665, 1217.276, 3769.198, 4333.889, 6197.799]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-3)


def test_tangents_that_give_no_way_are_the_limit_of_stiff_ones():
    joint = fy.preload(tiny_lap(), {"bolt": 5e3})
    rigid = joint.with_friction(0.2, tangential_penalty=float("inf"))
    stiff = joint.with_friction(0.2, tangential_penalty=1e10)
    found = fy.preloaded_frequencies(rigid, 3)
    # Rigid tangents keep the millionth part of the points' own compliance: 1.1e-4 lower at most.
    np.testing.assert_allclose(found, fy.preloaded_frequencies(stiff, 3), rtol=2e-4)
    # Residual compliance gives a reduced model the stiffness; 20 modes the inertia.
    rom = fy.reduce(rigid, fy.craig_bampton(rigid, normal_modes=20), compliance=True)
    state = fy.solve_path(rom, [fy.Load()])
    assert stuck_mode(rom, state, 1).frequency == pytest.approx(found[0], rel=2e-4)


@pytest.mark.long
@pytest.mark.parametrize("penalty", ["auto", "hard"])
def test_plates_that_friction_alone_holds_between_others(penalty):
    """The middle of three plates is hardly held: its points yield a million times their law."""
    joint = fy.lap_joint(element_size=5.0, plates=3, penalty=penalty)
    joint = joint.with_bolt_forces({"bolt": 10e3})
    loads = [fy.Load(), fy.Load({"tip.Fx": 1000.0}), fy.Load({"tip.Fz": -300.0})]
    for friction in (0.1, 0.15, 0.4):
        path = fy.solve_path(joint.with_friction(friction), loads)
        size, normal = np.linalg.norm(path.shear_forces, axis=1), path.contact_forces
        # Natural residual to which an increment is solved, over the largest force.
        assert (size <= friction * normal + SOLVED * normal.max()).all()
        assert (normal[:, joint.contact.slices["joint-1"]].max(axis=1) > 0).all()
        assert (normal[:, joint.contact.slices["joint-2"]].max(axis=1) > 0).all()


@pytest.mark.long
@pytest.mark.parametrize("solver_of", SOLVERS)
def test_last_digits_do_not_decide_whether_an_increment_is_solved(solver_of):
    """Three plates are tightened; by residuals alone nine of these copies were refused."""
    joint = fy.lap_joint(element_size=5.0, plates=3).with_bolt_forces({"bolt": 10e3})
    joint = joint.with_friction(0.1)
    total, rng = joint.static_contact.total, np.random.default_rng(0)
    relative, offset = (
        moved_alone(joint, path_inputs(joint, [fy.Load()]))[0],
        joint.contact.offset(),
    )
    for _ in range(10):
        digits = rng.uniform(-1, 1, total.shape)
        S = total * (1 + 1e-14 * (digits + digits.T))
        copy = solver_of(joint.contact, S)
        found = copy.solve(relative * (1 + 1e-14 * rng.uniform(-1, 1, relative.shape)), offset)
        assert found.residual <= SOLVED


def rom_of(model):
    return fy.reduce(model, fy.craig_bampton(model, normal_modes=3), compliance=True)


@pytest.mark.parametrize("to", ["exudyn", "vtk"])
def test_no_hand_over_forgets_friction(coarse, to, tmp_path):
    wanted = (
        rf"'joint' has friction, which {to} does not support; export the joint with it "
        r"\(mat, fmu, npz\), the linear joint \(nastran\)"
    )
    with pytest.raises(StudyError, match=wanted):
        export(rom_of(coarse), to, out=tmp_path / "joint")
    assert not list(tmp_path.iterdir())


def test_a_linear_hand_over_sticks_where_it_is_closed(coarse, tmp_path):
    """Under loads so small that nothing slips it is the path of the full model, in statics."""
    rom = rom_of(coarse)
    linear = linearize(rom)
    for name in ("tip.Fx", "tip.Fz", "tip.Mx"):
        path = fy.solve_path(coarse, [fy.Load(), fy.Load({name: 1e-2})])
        motion = np.linalg.solve(linear.K, 1e-2 * linear.inputs[:, linear.input_names.index(name)])
        for found, values in (
            (linear.outputs[:6] @ motion, path.displacement("tip")),
            (linear.force_rows @ motion, path.contact_forces),
            (linear.gap_rows @ motion, path.gap),
        ):
            exact = values[1] - values[0]
            # Differences of forces a million times larger; 1e-7 is measured.
            np.testing.assert_allclose(found, exact, rtol=0, atol=1e-5 * np.abs(exact).max())
    again = linearize(fy.solve_path(rom, [fy.Load()]))  # about the end of a path
    np.testing.assert_array_equal(again.K, linear.K)
    files = export(rom, "nastran", out=tmp_path / "joint")
    text = files[-1].read_text()
    assert "every point in contact at the preload sticks" in text


def test_linear_joints_of_a_whole_basis_vibrate_as_the_full_one_does_stuck():
    model = tiny_lap(penalty=1e5)
    model = model.with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    basis = fy.craig_bampton(model, normal_modes=len(model.structure.interior) - 1)
    found = linearize(fy.reduce(model, basis)).frequencies(5)
    # The one mode left out is at the top of the spectrum.
    np.testing.assert_allclose(found, fy.preloaded_frequencies(model, 5), rtol=1e-8)


def test_what_knows_no_friction_refuses_it(coarse):
    for attempt in (
        lambda: fy.preload(coarse, {"bolt": 8e3}),
        lambda: fy.solve_static_newton(coarse),
        lambda: fy.certify(coarse, LOADS["LC1"], np.zeros(coarse.contact.n_points)),
    ):
        with pytest.raises(ModelError, match="'joint' has friction, which is not carried here"):
            attempt()


@pytest.mark.long
@pytest.mark.parametrize(
    ("solver_of", "round_off"), [(by_stages, 1e-11), (by_displacements, newton_descent.ROUND_OFF)]
)
def test_increments_are_solved_to_round_off(gauss, solver_of, round_off):
    solver = solver_of(gauss.contact, gauss.static_contact.total)
    rng = np.random.default_rng(1)
    for _ in range(20):
        z_free = 1e-3 * rng.standard_normal((3, gauss.contact.n_points))
        assert solver.solve(np.zeros(len(solver.S)), z_free).residual <= 100 * round_off
