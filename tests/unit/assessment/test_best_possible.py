"""The floor under every linear basis."""

import numpy as np
import pytest

import faying as fy
from faying.assessment.best_possible import best_possible_errors, best_possible_gap_errors
from faying.exceptions import ModelError
from faying.simulation.static import solve_static_inputs


@pytest.fixture(scope="module")
def pressures(joint):
    box = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)}, levels=4)
    training = fy.solve_static_cases(joint, box.static_loads(joint)).pressure
    return training, fy.solve_static_cases(joint, box.random_loads(joint, 20, seed=1)).pressure


def test_rms_is_the_discarded_energy_of_the_svd(pressures):
    training, _ = pressures
    relative = training / training.max(axis=1, keepdims=True)
    values = np.linalg.svd(relative, compute_uv=False)
    errors = best_possible_errors(training, [0, 3, 10])
    expected = [np.sqrt((values[k:] ** 2).sum() / relative.size) for k in (0, 3, 10)]
    # Two routes to one number: round-off of an SVD, 1e-14 of the largest singular value.
    np.testing.assert_allclose(errors.training_rms, expected, rtol=1e-9)


def test_no_other_basis_does_better(pressures):
    training, _ = pressures
    relative = training / training.max(axis=1, keepdims=True)
    floor = best_possible_errors(training, [8]).training_rms[0]
    rng = np.random.default_rng(0)
    for _ in range(20):
        picked = rng.choice(len(relative), 8, replace=False)
        other = np.linalg.qr(relative[picked].T)[0]
        left = relative - relative @ other @ other.T
        assert np.sqrt((left**2).mean()) >= floor


def test_unseen_loads_are_harder_and_errors_fall(pressures):
    training, unseen = pressures
    errors = best_possible_errors(training, [2, 5, 10, 20], unseen=unseen)
    assert (np.diff(errors.training_rms) < 0).all()
    assert (np.diff(errors.unseen_rms) < 0).all()  # fits in nested spaces
    assert (errors.unseen_median <= errors.unseen_max).all()
    assert errors.unseen_max[-1] > errors.training_max[-1]


def test_all_modes_leave_nothing_in_training(pressures):
    training, _ = pressures
    # Round-off of the SVD and the fit.
    assert best_possible_errors(training, [len(training)]).training_max[0] < 1e-10


def test_empty_cases_do_not_count():
    errors = best_possible_errors(np.array([[1.0, 0.0], [0.0, 0.0]]), [1], unseen=np.eye(2))
    assert errors.training_max[0] < 1e-15  # one case, its own mode
    assert errors.unseen_max[0] == pytest.approx(1.0)  # the other direction is not represented


@pytest.fixture(scope="module")
def solutions(joint):
    box = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)}, levels=4)
    model = joint.with_penalty(1e4)
    return [
        fy.solve_static_cases(model, loads)
        for loads in (box.static_loads(joint), box.random_loads(joint, 20, seed=1))
    ]


def test_a_soft_law_lets_gaps_do_better_than_pressures(solutions):
    """The clipped gap is no combination of fixed pressure fields, so that floor does not bind."""
    training, unseen = solutions
    gaps = best_possible_gap_errors(training, [10], unseen=unseen)
    fields = best_possible_errors(training.pressure, [10], unseen=unseen.pressure)
    assert gaps.unseen_rms[0] < 0.5 * fields.unseen_rms[0]


def test_classic_vectors_help_and_all_modes_leave_nothing(solutions, classic):
    training, unseen = solutions
    alone = best_possible_gap_errors(training, [0, 5], unseen=unseen)
    helped = best_possible_gap_errors(training, [0, 5], unseen=unseen, classic=classic)
    assert (helped.training_rms < alone.training_rms).all()
    assert helped.unseen_rms[1] < helped.unseen_rms[0]
    whole = best_possible_gap_errors(training, [len(training.gap)], classic=classic)
    # Round-off of the gaps (openings of 0.1) times c_n over the pressure.
    assert whole.training_max[0] < 1e-8


def test_gaps_of_a_real_basis_come_no_closer(solutions, classic):
    """Method B finds its coefficients by Galerkin; the fit has them for free."""
    training, unseen = solutions
    model = training.system
    basis = fy.jim_b(model, training.contact_forces.T, joint_modes=10, classic=classic)
    found = solve_static_inputs(fy.reduce(model, basis), unseen.inputs)
    error = np.abs(found.pressure - unseen.pressure) / unseen.max_pressure[:, None]
    fit = best_possible_gap_errors(training, [10], unseen=unseen, classic=classic)
    assert np.sqrt((error**2).mean()) > fit.unseen_rms[0]


def test_hard_contact_has_no_gap_law(joint):
    hard = fy.solve_static_cases(joint.with_penalty(np.inf), [fy.Load({})])
    with pytest.raises(ModelError, match="no pressure follows"):
        best_possible_gap_errors(hard, [1])


@pytest.mark.parametrize(
    ("pressures", "counts", "message"),
    [
        (np.zeros((2, 3)), [1], "no case has any"),
        (np.full((2, 3), np.nan), [1], "finite"),
        (np.ones(3), [1], "n_case, n_point"),
        (np.ones((2, 3)), [-1], "zero or more"),
    ],
)
def test_faults_are_named(pressures, counts, message):
    with pytest.raises(ModelError, match=message):
        best_possible_errors(pressures, counts)


def test_two_models_do_not_mix():
    with pytest.raises(ModelError, match="2 contact points, the others 3"):
        best_possible_errors(np.ones((2, 3)), [1], unseen=np.ones((2, 2)))
