"""One step of the integrators against the balances and formulas that define them."""

from types import SimpleNamespace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.simulation.integrators import Motion

N, STEP = 4, 0.3
ROUND_OFF = 1e-12


@pytest.fixture
def system():
    random = np.random.default_rng(3)
    roots = random.normal(size=(3, N, N))
    M, C, K = (root @ root.T + np.eye(N) for root in roots)
    return SimpleNamespace(M=M, C=C, K=K)


@pytest.fixture
def start():
    values = np.random.default_rng(4).normal(size=(5, N))
    return Motion(*values, contact=np.zeros(0))


def stepped(scheme, system, start, force, step=STEP):
    right = scheme.right_hand_side(system, start, step) + scheme.force_weight * force
    u = np.linalg.solve(scheme.effective_matrix(system, step), right)
    return scheme.advance(start, u, force, step)


FORCE = np.array([1.0, -2.0, 0.5, 3.0])


def test_implicit_euler(system, start):
    """Backward differences and the balance at the end of the step."""
    scheme = fy.ImplicitEuler()
    end = stepped(scheme, system, start, FORCE)
    assert end.v == pytest.approx((end.u - start.u) / STEP, rel=ROUND_OFF)
    assert end.a == pytest.approx((end.v - start.v) / STEP, rel=ROUND_OFF)
    left = system.M @ end.a + system.C @ end.v + system.K @ end.u
    assert left == pytest.approx(FORCE, abs=1e-10)
    assert not scheme.needs_acceleration
    assert (scheme.kept_force(FORCE, 2 * FORCE) == 3 * FORCE).all()


@pytest.mark.parametrize("rho", [0.0, 0.3, 0.8, 1.0])
def test_generalized_alpha(system, start, rho):
    """Chung and Hulbert 1993: balance between the ends, Newmark's formulas, second order."""
    scheme = fy.GeneralizedAlpha(rho)
    end = stepped(scheme, system, start, FORCE)
    alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    gamma = 0.5 - alpha_m + alpha_f
    beta = (1 - alpha_m + alpha_f) ** 2 / 4

    def between(new, old, weight):
        return (1 - weight) * new + weight * old

    left = system.M @ between(end.a, start.a, alpha_m)
    left += system.C @ between(end.v, start.v, alpha_f)
    left += system.K @ between(end.u, start.u, alpha_f)
    assert left == pytest.approx(between(FORCE, start.force, alpha_f), abs=1e-10)
    means = [between(end.a, start.a, 1 - one) for one in (2 * beta, gamma)]
    assert end.u == pytest.approx(start.u + STEP * start.v + STEP**2 / 2 * means[0], abs=1e-10)
    assert end.v == pytest.approx(start.v + STEP * means[1], abs=1e-10)
    assert scheme.needs_acceleration
    assert (scheme.kept_force(FORCE, 2 * FORCE) == 3 * FORCE).all()


@pytest.mark.parametrize("rho", [0.0, 0.3, 0.8, 1.0])
def test_energy_decaying(system, start, rho):
    """The four equations of docs/theory/time_integration.md, between means over the step."""
    scheme = fy.EnergyDecaying(rho)
    end = stepped(scheme, system, start, FORCE)
    lag = (1 - rho) / (2 * (1 + rho))
    u, v, a, w, f = (
        ((new + old) / 2, new - old)
        for new, old in (
            (end.u, start.u),
            (end.v, start.v),
            (end.a, start.a),
            (end.lagging, start.lagging),
            (FORCE, start.force),
        )
    )
    left = system.M @ v[1] / STEP + system.C @ u[1] / STEP
    left += system.K @ (u[0] + lag**2 * STEP * w[1])
    assert left == pytest.approx(f[0], abs=1e-10)
    assert u[1] / STEP == pytest.approx(v[0] + lag**2 * STEP * a[1], abs=1e-10)
    assert u[1] / STEP == pytest.approx(w[0] + 2 * lag * w[1], abs=1e-10)
    assert v[1] / STEP == pytest.approx(a[0] + 2 * lag * a[1], abs=1e-10)
    assert (end.force == FORCE).all()
    assert end.contact is start.contact
    assert not scheme.needs_acceleration
    assert scheme.force_weight == 0.5
    assert (scheme.kept_force(FORCE, 2 * FORCE) == FORCE).all()


@pytest.mark.parametrize("rho", [-1e-9, 1 + 1e-9, np.nan])
@pytest.mark.parametrize("kind", [fy.GeneralizedAlpha, fy.EnergyDecaying])
def test_spectral_radii_that_cannot_be(kind, rho):
    with pytest.raises(ModelError, match="must lie between 0 and 1"):
        kind(rho)


def test_default_spectral_radius():
    assert (fy.GeneralizedAlpha().rho_infinity, fy.EnergyDecaying().rho_infinity) == (0.8, 0.0)
