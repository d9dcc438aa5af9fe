"""Paths with friction against Newton's method on all displacements, written out here."""

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla

import faying as fy
from faying.joint.system import input_forces

CORNERS = np.array([2e3, 5e2, 5e2, 2e4, 2e4, 2e4])
NAMES = ("tip.Fx", "tip.Fy", "tip.Fz", "tip.Mx", "tip.My", "tip.Mz")
CASES = [
    (friction, penalty)
    for friction in (0.05, 0.2, 0.5, 1.0)
    for penalty in (1e4, 1e5, 1e6, 1e7, "hard")
]


def reversing_path(seed):
    """The preload, then two random corners and back, each in three increments."""
    corners = np.random.default_rng(seed).uniform(-1, 1, (2, 6)) * CORNERS
    ends = np.vstack([np.zeros(6), corners, -0.5 * corners[:1]])
    rows = [np.interp(np.linspace(0, 3, 10), np.arange(4), column) for column in ends.T]
    return [fy.Load(dict(zip(NAMES, row, strict=True))) for row in np.transpose(rows)]


class FullOrder:
    """K u = f + Gᵀ λ(G u), the law by radial return at every point, elastic contact alone."""

    def __init__(self, model):
        contact, P = model.contact, model.contact.relative_operator
        self.n = contact.n_points
        self.G = sp.vstack([contact.interpolation @ P, contact.shear @ P]).tocsc()
        self.K, self.gap, (self.law,) = model.K, contact.initial_gap, contact.laws.values()
        self.normal = self.law.penalty * contact.weights
        self.shear = self.law.tangential_penalty * contact.weights

    def forces(self, u, slip):
        """λ (3 n) at displacements, and its derivative by G u (sparse)."""
        g, first, second = (self.G @ u).reshape(3, -1)
        pressed = np.maximum(-self.normal * (g + self.gap), 0.0)
        trial = -self.shear * (np.array([first, second]) - slip)
        size, limit = np.hypot(*trial), self.law.friction * pressed
        slips = size > limit
        way = trial / np.where(size > 0, size, 1.0)
        shear = np.where(slips, limit * way, trial) * (pressed > 0)
        own = -self.normal * (pressed > 0)
        held = -self.shear * (pressed > 0) * np.where(slips, limit / np.where(size > 0, size, 1), 1)
        across = np.eye(2)[:, :, None] - slips * way[:, None] * way[None]
        pulled = self.law.friction * own * slips * way
        blocks = [[sp.diags_array(own), None, None]]
        for i in range(2):
            columns = [sp.diags_array(held * across[i, j]) for j in range(2)]
            blocks.append([sp.diags_array(pulled[i]), *columns])
        return np.concatenate([pressed, *shear]), sp.block_array(blocks).tocsc()

    def increment(self, u, slip, external):
        """Newton's method with halving of the residual; forces and slip at the end."""
        size = np.abs(external).max()
        x, slope = self.forces(u, slip)
        left = self.K @ u - external - self.G.T @ x
        for _ in range(200):
            if np.abs(left).max() < 1e-11 * size:
                break
            tangent = (self.K - self.G.T @ slope @ self.G).tocsc()
            change = -spla.splu(tangent).solve(left)
            for fraction in 0.5 ** np.arange(14):
                x, slope = self.forces(u + fraction * change, slip)
                tried = self.K @ (u + fraction * change) - external - self.G.T @ x
                if np.linalg.norm(tried) < np.linalg.norm(left):
                    break
            u, left = u + fraction * change, tried
        shear = (self.G @ u).reshape(3, -1)[1:]
        return u, x.reshape(3, -1), shear + x.reshape(3, -1)[1:] / self.shear, left


def joint(friction, penalty):
    model = fy.lap_joint(element_size=5.0, penalty=penalty).with_bolt_forces({"bolt": 8e3})
    return model.with_friction(friction)


def check_equations(model, path):
    """Equilibrium of all displacements, and the law of the displacements themselves."""
    contact, P = model.contact, model.contact.relative_operator
    (law,) = contact.laws.values()
    G = sp.vstack([contact.interpolation @ P, contact.shear @ P])
    external, before = input_forces(model, path.inputs), np.zeros((2, contact.n_points))
    rigid = law.penalty == np.inf
    for u, f, x_n, x_t, slip in zip(
        path.states, external, path.contact_forces, path.shear_forces, path.shear_slip, strict=True
    ):
        x, largest = np.vstack([x_n, x_t]), x_n.max()
        left = model.K @ u - f - G.T @ x.ravel()
        assert np.abs(left).max() < 1e-9 * np.abs(f).max()
        z = (G @ u).reshape(3, -1)
        z[0] += contact.initial_gap + (0.0 if rigid else x_n / (law.penalty * contact.weights))
        z[1:] += (0.0 if rigid else x_t / (law.tangential_penalty * contact.weights)) - before
        before = slip
        # Slack in length times the stiffness of a point, about 1e4 N/mm, is in force.
        assert (x_n > -1e-9 * largest).all()
        assert (1e4 * z[0] > -1e-9 * largest).all()
        assert (1e4 * np.abs(z[0][x_n > 1e-9 * largest]) < 1e-8 * largest).all()
        size = np.hypot(*x_t)
        assert (size <= law.friction * x_n + 1e-9 * largest).all()
        sticks = (x_n > 1e-9 * largest) & (size < law.friction * x_n - 1e-8 * largest)
        assert (1e4 * np.hypot(*z[1:, sticks]) < 1e-8 * largest).all()


def compare(friction, penalty, seed):
    model, loads = joint(friction, penalty), reversing_path(seed)
    path = fy.solve_path(model, loads)
    check_equations(model, path)
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=3), compliance=True)
    reduced, largest = fy.solve_path(rom, loads), path.max_pressure.max()
    # Round-off of S times the penalty.
    np.testing.assert_allclose(reduced.pressure, path.pressure, rtol=0, atol=1e-8 * largest)
    np.testing.assert_allclose(reduced.traction, path.traction, rtol=0, atol=1e-8 * largest)
    if penalty == "hard":  # no displacements alone determine forces there
        return
    full = FullOrder(model)
    u, slip = np.zeros(model.K.shape[0]), np.zeros((2, full.n))
    for load, state, normal, shear in zip(
        loads, path.states, path.contact_forces, path.shear_forces, strict=True
    ):
        external = input_forces(model, load.inputs(model, np.zeros(1)))[0]
        u, x, slip, left = full.increment(u, slip, external)
        assert np.abs(left).max() < 1e-10 * np.abs(external).max()
        np.testing.assert_allclose(state, u, rtol=0, atol=1e-9 * np.abs(u).max())
        # Forces are displacements times penalty, in which the full order loses digits.
        lost = 1e-9 * max(1.0, float(penalty) / 1e6)
        found = np.vstack([normal, shear])
        np.testing.assert_allclose(found, x, rtol=0, atol=lost * normal.max())


@pytest.mark.parametrize(("friction", "penalty"), [CASES[0], CASES[7], CASES[18], CASES[14]])
def test_paths_are_those_of_the_full_order(friction, penalty):
    compare(friction, penalty, 0)


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "penalty"), CASES)
@pytest.mark.parametrize("seed", range(1, 6))
def test_a_hundred_paths_are_those_of_the_full_order(friction, penalty, seed):
    compare(friction, penalty, seed)
