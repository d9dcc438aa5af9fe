"""Certificates of reduced models against the full solution they do without."""

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse.linalg as spla

import faying as fy
from faying.assessment import tresca
from faying.assessment.certificate import certifier, certify
from faying.assessment.choose_joint_modes import choose_joint_modes
from faying.assessment.natural_map import NaturalMap
from faying.assessment.tresca import certify_increments
from faying.exceptions import ModelError
from faying.reduction.recovery import static_displacements
from lap_joints import tiny_lap

LOADS = (
    fy.Load({"tip.Fz": -500.0}, name="LC1"),
    fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2"),
)
BOX = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)}, levels=3)
PENALTIES = (1e4, 1e5, 8.4e5)


@pytest.fixture(scope="module")
def preloaded():
    return fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3}, sticking=fy.Sticking())


@pytest.fixture(scope="module")
def bases(preloaded):
    """Bases do not depend on the penalty but for the snapshots of B."""
    model = preloaded.with_penalty(1e5)
    classic = fy.craig_bampton(model, normal_modes=20)
    snapshots = fy.static_snapshots(model, BOX.static_loads(model))
    return {
        "craig-bampton": classic,
        "jim-a": fy.jim_a(model, joint_modes=20, classic=classic),
        "jim-b": fy.jim_b(model, snapshots, joint_modes=20, classic=classic),
    }


def locked(preloaded, penalty):
    model = preloaded.with_penalty(penalty)
    return model.with_bolt_forces(fy.tighten(model, {"bolt": 10e3}).initial_forces)


def energy_norm(model, forces):
    H = model.static_contact.flexibility
    return np.sqrt(((forces @ H) * forces).sum(axis=-1))


@pytest.mark.parametrize("penalty", PENALTIES)
@pytest.mark.parametrize("method", ["craig-bampton", "jim-a", "jim-b"])
def test_everything_certified_holds_and_the_energy_sharply(preloaded, bases, method, penalty):
    model = locked(preloaded, penalty)
    loads = [*LOADS, *BOX.random_loads(model, 20, seed=1)]
    exact = fy.solve_static_cases(model, loads)
    cases = fy.solve_static_cases(fy.reduce(model, bases[method]), loads)
    certificate = certifier(model).certify_inputs(cases.inputs, cases.pressure)

    slight = 1e-9 * exact.max_pressure.max()  # round-off of the exact solution
    assert (certificate.pressure_low <= exact.pressure + slight).all()
    assert (certificate.pressure_high >= exact.pressure - slight).all()
    low, high = certificate.contact_force["joint"].T
    assert (low <= exact.contact_force() * (1 + 1e-9)).all()
    assert (high >= exact.contact_force() * (1 - 1e-9)).all()
    force_error = np.abs(cases.contact_force() / exact.contact_force() - 1)
    assert (certificate.contact_force_error >= force_error).all()
    difference = cases.pressure - exact.pressure
    pressure_error = np.abs(difference).max(axis=1) / exact.max_pressure
    assert (certificate.max_relative_error >= pressure_error).all()
    weights = model.contact.weights
    rms = np.sqrt((difference**2 * weights).sum(axis=1) / weights.sum())
    assert (certificate.rms_pressure_error >= rms).all()

    error = energy_norm(model, cases.contact_forces - exact.contact_forces)
    sharpness = np.sqrt(2 * certificate.energy) / error
    relative = error / energy_norm(model, exact.contact_forces)
    assert (certificate.energy_error >= relative).all()
    assert sharpness.min() >= 1 - 1e-9  # round-off
    assert sharpness.max() < 3.0  # measured at most 1.9 on the default mesh


def test_the_exact_solution_is_certified_to_round_off(preloaded):
    exact = fy.solve_static(preloaded, LOADS[1])
    certificate = certify(preloaded, LOADS[1], exact.pressure)
    # √B is of the order ε ‖H‖ ‖λ‖, pressures that times √(c_n / w).
    assert certificate.energy_error < 1e-8
    assert certificate.max_relative_error < 1e-6
    assert certificate.clipped_pressure == 0.0


def test_negative_pressures_are_clipped_and_reported(preloaded):
    pressure = fy.solve_static(preloaded, LOADS[0]).pressure.copy()
    at = int(np.argmin(pressure))
    pressure[at] = -0.25
    certificate = certify(preloaded, LOADS[0], pressure)
    assert certificate.clipped_pressure == 0.25
    assert certificate.pressure[at] == 0.0


@pytest.mark.parametrize("quadrature", ["gauss", "nodal"])
def test_hard_contact(quadrature):
    bare = fy.lap_joint(element_size=5.0, quadrature=quadrature, penalty=np.inf)
    model = fy.preload(bare, {"bolt": 10e3})
    loads = BOX.random_loads(model, 5, seed=2)
    exact = fy.solve_static_cases(model, loads)
    soft = locked(model, 1e5)
    judge = certifier(model)
    assert judge.flexibility.unique == (quadrature == "nodal")
    candidate = fy.solve_static_cases(soft, loads).pressure
    certificate = judge.certify_inputs(exact.inputs, candidate)
    error = energy_norm(model, candidate * model.contact.weights - exact.contact_forces)
    assert np.isfinite(certificate.energy).all()
    assert (np.sqrt(2 * certificate.energy) >= error * (1 - 1e-7)).all()
    low, high = certificate.contact_force["joint"].T
    assert (low <= exact.contact_force() * (1 + 1e-7)).all()
    assert (high >= exact.contact_force() * (1 - 1e-7)).all()
    # Gauss points outnumber the displacements between the parts: point pressures are not unique.
    assert np.isfinite(certificate.max_relative_error).all() == (quadrature == "nodal")


SPECTRAL = ("eig", "eigh", "eigvals", "eigvalsh", "svd", "svdvals", "cond", "matrix_rank", "pinv")
"""What takes all eigenvalues or singular values of a dense matrix."""


@pytest.fixture
def without_eigenvalues(monkeypatch):
    """Fail where eigenvalues over all contact points are asked for: they cost more than a run."""

    def refused(*_, **__):
        pytest.fail("eigenvalues of a matrix over all contact points")

    def norm(array, *arguments, plain=np.linalg.norm, **options):
        order = arguments[0] if arguments else options.get("ord")
        if np.ndim(array) == 2 and order in (2, -2, "nuc") and options.get("axis") is None:
            refused()
        return plain(array, *arguments, **options)

    for library in (la, np.linalg):
        for name in SPECTRAL:
            monkeypatch.setattr(library, name, refused, raising=False)
        monkeypatch.setattr(library, "norm", norm)
    for name in ("eigs", "eigsh", "svds"):
        monkeypatch.setattr(spla, name, refused)


@pytest.fixture(params=[("gauss", 1e5), ("nodal", 1e5), ("nodal", np.inf)])
def plates(request):
    """A joint with more points than pairs, with as many, and with as many hard ones."""
    quadrature, penalty = request.param
    model = fy.lap_joint(element_size=5.0, quadrature=quadrature, penalty=penalty)
    H = model.static_contact.flexibility  # known before certificates begin
    root = np.sqrt(model.contact.weights)
    return model, float(np.linalg.eigvalsh(H * root[:, None] * root)[0])


def test_certificates_take_no_eigenvalue_and_bound_the_norm_of_pressures_closely(
    plates, without_eigenvalues
):
    model, least = plates
    judge = certifier(model)
    inputs = LOADS[0].inputs(model, np.zeros(1))
    pressure = np.ones((1, model.contact.n_points))
    found = judge.certify_inputs(inputs, pressure)
    assert np.isfinite(found.rms_pressure_error).all()
    sharpness = judge.rms_factor * np.sqrt(least)
    assert sharpness >= 1 - 1e-8  # round-off of the least eigenvalue
    assert sharpness < 1.5  # measured 1.00, 1.37 and 1.37


def test_chosen_joint_modes_meet_the_tolerance(preloaded, bases):
    model = locked(preloaded, 1e5)
    loads = BOX.random_loads(model, 10, seed=3)
    choice = choose_joint_modes(model, bases["jim-b"], loads, 0.05)
    assert choice.met
    assert 0 < choice.count < 20
    assert (choice.bounds[:-1] > 0.05).all()
    exact = fy.solve_static_cases(model, loads)
    rom = fy.reduce(model, bases["jim-b"].with_joint_modes(choice.count))
    difference = fy.solve_static_cases(rom, loads).contact_forces - exact.contact_forces
    true = energy_norm(model, difference) / energy_norm(model, exact.contact_forces)
    assert true.max() <= choice.bounds[-1] <= 0.05
    assert not choose_joint_modes(model, bases["jim-b"], loads, 1e-6).met


def test_wrong_input_is_refused(preloaded, bases):
    with pytest.raises(ModelError, match="one per contact point"):
        certify(preloaded, LOADS[0], np.zeros(3))
    with pytest.raises(ModelError, match="at least one load"):
        choose_joint_modes(preloaded, bases["jim-b"], [], 0.1)
    certificate = certify(preloaded, LOADS[0], np.zeros(preloaded.contact.n_points))
    assert certificate.energy_error == np.inf  # nothing certain about no pressure at all
    with pytest.raises(ModelError, match="energy_error, contact_force_error"):
        certificate.bound("colour")


def with_fixed_bounds(H, z_free, forces, bound):
    """Return forces that minimize ½ xᵀ H x + z_freeᵀ x within fixed bounds, by Newton's method."""
    scale = 1.0 / np.diag(H).reshape(3, -1)
    scale[1:] = scale[1:].mean(axis=0)
    for _ in range(50):
        tried = forces - scale * ((H @ forces.ravel()).reshape(3, -1) + z_free)
        size = np.maximum(np.hypot(*tried[1:]), 1e-30)
        sticks = size <= bound
        admissible = np.vstack([np.maximum(tried[0], 0), np.minimum(1, bound / size) * tried[1:]])
        wrong = forces - admissible
        if np.abs(wrong).max() < 1e-9 * np.abs(forces).max():
            return forces
        slope = np.zeros((3, 3, forces.shape[1]))
        slope[0, 0] = tried[0] > 0
        way, cut = tried[1:] / size, np.where(sticks, 1.0, bound / size)
        for i, j in np.ndindex(2, 2):
            slope[1 + i, 1 + j] = cut * ((i == j) - np.where(sticks, 0.0, way[i] * way[j]))
        blocks = np.vstack([np.hstack([np.diag(slope[i, j]) for j in range(3)]) for i in range(3)])
        system = np.eye(forces.size) - blocks @ (np.eye(forces.size) - scale.ravel()[:, None] * H)
        forces = forces - np.linalg.solve(system, wrong.ravel()).reshape(3, -1)
    raise AssertionError


def test_increments_with_fixed_bounds_lie_within_their_certificate(monkeypatch):
    joint = tiny_lap(penalty=1e5)
    model = joint.with_bolt_forces({"bolt": 5e3}).with_friction(0.2)
    basis = fy.craig_bampton(model, normal_modes=20)
    loads = [fy.Load(), fy.Load({"tip.Fx": 300.0}), fy.Load({"tip.Fx": 600.0})]
    poor = fy.solve_path(fy.reduce(model, basis), loads)
    found = certify_increments(model, poor)
    equations, contact = NaturalMap.of(model), model.contact
    free = static_displacements(model.port_compliance, poor.inputs)
    before = np.concatenate([np.zeros((1, *poor.shear_slip[0].shape)), poor.shear_slip[:-1]])
    H = equations.G @ equations.S @ equations.G.T + np.diag(equations.yields.ravel())
    for k, slip in enumerate(before):
        z_free = contact.free_slack(free[k, : model.port_compliance.n_relative], slip)
        given = np.concatenate([poor.contact_forces[k][None], poor.shear_forces[k]])
        exact = with_fixed_bounds(H, z_free, given, 0.2 * given[0])
        apart = (given - exact).ravel()
        true = np.sqrt(apart @ H @ apart)
        assert true <= np.sqrt(2 * found.energy[k]) * (1 + 1e-9)
        assert np.sqrt(2 * found.energy[k]) < 3 * true  # 1.2 to 1.4 are measured
        assert true / np.sqrt(exact.ravel() @ H @ exact.ravel()) <= found.energy_error[k]
    assert (found.residual > 1e-3).all()
    # By dense matrices between forces, as hard contact has them.
    monkeypatch.setattr(tresca, "flexibility_by_pairs", lambda *_: None)
    assert certify_increments(model, poor).energy == pytest.approx(found.energy, rel=1e-9)
    monkeypatch.undo()
    own = certify_increments(model, fy.solve_path(model, loads))
    # What increments are solved to, 1e-13 of the forces, in the square root of an energy.
    assert own.energy_error.max() < 1e-6
    assert own.residual.max() < 1e-11
    # Later increments go on from the slip before them.
    rest = fy.solve_path(model, loads[:2])
    again = certify_increments(model, fy.solve_path(model, loads[2:], initial=rest), rest)
    assert again.energy_error.max() < 1e-6
    with pytest.raises(ModelError, match="no interface has friction"):
        certify_increments(joint, poor)
    with pytest.raises(ModelError, match="is not one with friction at the"):
        certify_increments(model, fy.solve_path(joint, loads))
