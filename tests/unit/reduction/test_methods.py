"""Methods of the literature: what each must do exactly, and what it must respect."""

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ConvergenceError, ModelError
from faying.reduction.basis import ModeKind
from faying.reduction.deim import Deim, deim, with_deim
from faying.reduction.force_basis import (
    ForceBasis,
    cone_projected_greedy,
    nonnegative_factors,
    with_force_basis,
)
from faying.reduction.method import OfflineData
from faying.reduction.methods import METHODS
from faying.reduction.trial_vector_derivatives import trial_vector_derivatives

LC2 = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
BOX = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)}, levels=4)


@pytest.fixture(scope="module")
def soft(joint):
    """A penalty at which displacement bases are not hopeless."""
    model = joint.with_penalty(1e4)
    return model.with_bolt_forces(fy.tighten(model, {"bolt": 10e3}).initial_forces)


@pytest.fixture(scope="module")
def training(soft):
    return fy.static_snapshots(soft, BOX.static_loads(soft))


def error(system, model, load=LC2):
    full = fy.solve_static(model, load)
    return fy.compare(fy.solve_static(system, load), full).max_relative_error


class TestTrialVectorDerivatives:
    def test_joint_modes_vanish_on_the_boundary_and_are_orthonormal(self, soft, classic):
        basis = trial_vector_derivatives(soft, joint_modes=12, classic=classic)
        modes = basis.of_kind(ModeKind.JOINT)
        assert modes.shape[1] == 12
        assert not modes[soft.structure.boundary].any()
        # Gram-Schmidt done twice: round-off.
        np.testing.assert_allclose(modes.T @ (soft.K @ modes), np.eye(12), atol=1e-10)

    def test_span_products_of_gaps(self, soft, classic):
        """All products kept, the static shape of any of them is in the basis."""
        count = len(classic) * (len(classic) + 1) // 2
        basis = trial_vector_derivatives(soft, joint_modes=count, classic=classic)
        contact = soft.contact
        gaps = contact.interpolation @ (contact.relative_operator @ classic.vectors)
        force = contact.weights * gaps[:, 7] * gaps[:, 8]
        nodal = contact.relative_operator.T @ (contact.interpolation.T @ force)
        shape = soft.structure.solve_held(nodal[:, None])[:, 0]
        fit = np.linalg.lstsq(basis.vectors, shape, rcond=None)[0]
        # The POD drops what is below 1e-12 of the largest product.
        assert np.abs(shape - basis.vectors @ fit).max() < 1e-6 * np.abs(shape).max()

    def test_more_modes_help(self, soft, classic):
        basis = trial_vector_derivatives(soft, joint_modes=40, classic=classic)
        without = error(fy.reduce(soft, classic), soft)
        assert error(fy.reduce(soft, basis), soft) < 0.1 * without

    def test_a_basis_that_keeps_the_interface_closed_is_refused(self, soft):
        rigid = fy.Basis(vectors=np.zeros((soft.K.shape[0], 1)), kinds=(ModeKind.NORMAL,))
        with pytest.raises(ModelError, match="opens or closes"):
            trial_vector_derivatives(soft, classic=rigid)


@pytest.mark.parametrize("build", [cone_projected_greedy, nonnegative_factors])
class TestForceBases:
    def test_vectors_are_nonnegative_and_carry_one_unit_of_force(self, training, build):
        basis = build(training, count=6)
        assert len(basis) == 6
        assert (basis.vectors >= 0).all()
        np.testing.assert_allclose(basis.vectors.sum(axis=0), 1.0, rtol=1e-12)

    def test_never_pulls(self, soft, training, build):
        system = with_force_basis(soft, build(training, count=8))
        solution = fy.solve_static_cases(system, BOX.random_loads(soft, 20, seed=2))
        assert solution.pressure.min() >= 0.0

    def test_is_the_best_in_its_cone(self, soft, training, build):
        """Galerkin on a cone: no other nonnegative combination has less energy."""
        basis = build(training, count=6)
        solution = fy.solve_static(with_force_basis(soft, basis), LC2)
        ports = soft.port_compliance
        signed = solution.inputs * np.r_[np.ones(ports.n_boundary), -1.0]
        gap = soft.contact.free_gap(signed @ ports.contact_columns)
        H = soft.static_contact.flexibility

        def energy(forces):
            return forces @ (0.5 * H @ forces + gap)

        rng = np.random.default_rng(3)
        least = energy(solution.contact_forces)
        for _ in range(50):
            other = basis.vectors @ np.abs(rng.standard_normal(6)) * 4e3
            mixed = 0.99 * solution.contact_forces + 0.01 * other
            assert energy(mixed) >= least * (1 + 1e-12 * np.sign(least))


class TestForceBasis:
    def test_a_snapshot_is_reproduced(self, soft):
        """The solution lies in the cone, so it is the minimum there too; same for a ROM."""
        full = fy.solve_static(soft, LC2)
        others = fy.static_snapshots(soft, BOX.static_loads(soft)[:3])
        basis = ForceBasis(vectors=np.column_stack([full.contact_forces, others]))
        rom = fy.reduce(soft, fy.craig_bampton(soft, normal_modes=5), compliance=True)
        for system in (soft, rom):
            # Round-off times the condition of WᵀHW, below 1e6.
            assert error(with_force_basis(system, basis), soft) < 1e-8
            solution = fy.solve_static(with_force_basis(system, basis), LC2)
            np.testing.assert_allclose(
                solution.displacement("tip"), full.displacement("tip"), rtol=1e-6
            )
            np.testing.assert_allclose(solution.gap, full.gap, atol=1e-8 * np.abs(full.gap).max())

    def test_unit_vectors_give_the_full_solution(self, soft):
        system = with_force_basis(soft, ForceBasis(vectors=np.eye(soft.contact.n_points)))
        assert error(system, soft) < 1e-10  # the same problem, the same solver

    def test_greedy_bases_are_nested_and_come_closer(self, soft, training):
        basis = cone_projected_greedy(training, count=30)
        # A shorter basis is scaled once more: round-off.
        np.testing.assert_allclose(
            cone_projected_greedy(training, count=4).vectors, basis.first(4).vectors, rtol=1e-14
        )
        assert error(with_force_basis(soft, basis), soft) < error(
            with_force_basis(soft, basis.first(3)), soft
        )

    def test_greedy_picks_the_extreme_rays_and_stops(self):
        rays = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        inside = np.array([[1.0, 2.0, 3.0], [1.0, 1.0, 0.0]]).T
        basis = cone_projected_greedy(np.hstack([rays, inside])[:, ::-1], count=5)
        assert len(basis) <= 5
        unit = basis.vectors / np.linalg.norm(basis.vectors, axis=0)
        for ray in rays:
            assert (unit.T @ ray).max() == pytest.approx(1.0, abs=1e-12)

    def test_greedy_is_the_plain_greedy(self, training):
        """Lazy projections pick what projecting every snapshot each time picks."""
        from scipy.optimize import nnls

        unit = training / np.linalg.norm(training, axis=0)
        picked = [0]
        for _ in range(5):
            distances = [nnls(unit[:, picked], column)[1] for column in unit.T]
            picked.append(int(np.argmax(distances)))
        expected = ForceBasis(vectors=unit[:, picked]).vectors
        np.testing.assert_array_equal(cone_projected_greedy(training, count=6).vectors, expected)

    def test_factors_fit_better_than_snapshots(self, training):
        from scipy.optimize import nnls

        unit = training / np.linalg.norm(training, axis=0)

        def misfit(basis):
            return sum(nnls(basis.vectors, column)[1] ** 2 for column in unit.T)

        greedy = cone_projected_greedy(training, count=5)
        assert misfit(nonnegative_factors(training, count=5)) < 0.9 * misfit(greedy)

    def test_faults_are_named(self, soft):
        with pytest.raises(ModelError, match="nonnegative"):
            ForceBasis(vectors=-np.eye(2))
        with pytest.raises(ModelError, match="contact points"):
            with_force_basis(soft, ForceBasis(vectors=np.eye(3)))
        with pytest.raises(ModelError, match="no snapshot"):
            cone_projected_greedy(np.zeros((3, 2)), count=1)
        with pytest.raises(ModelError, match="≥ 0"):
            cone_projected_greedy(-np.ones((3, 2)), count=1)


class TestDeim:
    def test_snapshot_space_is_interpolated_exactly(self, training):
        """Rank-limited snapshots are recovered from the sampling points."""
        few = training[:, ::9]
        sampling = deim(few, count=few.shape[1])
        recovered = sampling.interpolation @ few[sampling.points]
        # Round-off times the norm of the interpolation, some hundreds.
        np.testing.assert_allclose(recovered, few, atol=1e-8 * few.max())
        assert len(np.unique(sampling.points)) == len(sampling)

    def test_all_points_give_the_full_solution(self, soft):
        n = soft.contact.n_points
        system = with_deim(soft, Deim(points=np.arange(n), interpolation=np.eye(n)))
        assert error(system, soft) < 1e-10  # the same problem by another solver

    def test_law_holds_at_the_sampling_points(self, soft, training):
        sampling = deim(training, count=20)
        solution = fy.solve_static(with_deim(soft, sampling), LC2)
        at = sampling.points
        expected = 1e4 * np.maximum(-solution.gap[at], 0.0)
        # p = c_n times a gap of 1e-3: round-off of the gap against H.
        np.testing.assert_allclose(solution.pressure[at], expected, atol=1e-6 * expected.max())

    def test_interpolated_pressures_may_pull(self, soft, training):
        """The defect that force bases do not have; measured, not wished for."""
        solution = fy.solve_static(with_deim(soft, deim(training, count=10)), LC2)
        assert solution.pressure.min() < 0.0

    def test_forces_are_answered_with_what_they_press(self, soft, training, monkeypatch):
        """Closed where they press, open where they pull or are zero."""
        contact = with_deim(soft, deim(training, count=10)).static_contact
        forces, asked = np.zeros(soft.contact.n_points), []
        forces[[3, 8, 20]] = 2.0, 0.5, -1.0

        def pressed(_, free_gap, active):
            asked.append((free_gap, active))
            return forces, 4

        monkeypatch.setattr(type(contact), "pressed", pressed)
        free = soft.port_compliance.contact_columns[0]
        found = contact.solve(free, soft.contact.offset())
        again = contact.solve(free, soft.contact.offset(), found)
        assert found.iterations == again.iterations == 4
        gap = soft.contact.free_gap(free)
        assert asked[0][1] is None
        np.testing.assert_array_equal(np.flatnonzero(asked[1][1]), [3, 8])
        np.testing.assert_array_equal(asked[0][0], gap)
        whole = soft.static_contact
        # Sums of three products; a system of condition 10.
        np.testing.assert_allclose(found.slack[0], whole.flexibility @ forces + gap, rtol=1e-12)
        moved = free + whole.total @ (soft.contact.interpolation.T @ forces)
        np.testing.assert_allclose(found.moved, moved, rtol=1e-10)

    def test_no_solution_is_said(self, soft):
        """A sampling whose own force opens its gap: an unsolvable sign pattern."""
        pressed = int(fy.solve_static(soft).pressure.argmax())
        interpolation = -np.ones((soft.contact.n_points, 1))
        interpolation[pressed] = 1.0
        system = with_deim(soft, Deim(points=np.array([pressed]), interpolation=interpolation))
        with pytest.raises(ConvergenceError, match="DEIM at 1 points"):
            fy.solve_static(system)

    def test_another_models_sampling_is_refused(self, soft):
        with pytest.raises(ModelError, match="interpolates to 3"):
            with_deim(soft, Deim(points=np.array([0]), interpolation=np.ones((3, 1))))


@pytest.mark.parametrize("method", [m for m in METHODS.values() if m.source], ids=lambda m: m.name)
def test_every_method_of_the_literature_is_built(method, soft, training, classic):
    data = OfflineData(classic=classic, contact_forces=training)
    basis = method.joint_modes.extended(soft, data, 15) if method.joint_modes else classic
    system = method.reduced(soft, basis, training, 15)
    solution = fy.solve_static(system, LC2)
    assert solution.pressure.shape == (soft.contact.n_points,)
    assert fy.compare(solution, fy.solve_static(soft, LC2)).max_relative_error < 0.6
    assert "20" in method.source


@pytest.mark.parametrize("fact", ["colour", "marker", "meaning"])
def test_methods_are_told_apart(fact):
    assert len({getattr(method, fact) for method in METHODS.values()}) == len(METHODS)
