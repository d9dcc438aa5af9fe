"""Paths with friction against Newton's method on all displacements, written out here.

Where contact is hard, no displacements alone determine forces: there the forces of the points are
unknowns beside all displacements.
"""

from functools import cache
from itertools import islice

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla

import faying as fy
from faying.exceptions import ModelError
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
        self.K, self.gap = model.K, contact.initial_gap
        self.friction, self.normal, self.shear = np.empty((3, self.n))
        for name, law in contact.laws.items():
            at = contact.slices[name]
            self.friction[at] = law.friction
            self.normal[at] = law.penalty * contact.weights[at]
            self.shear[at] = law.tangential_penalty * contact.weights[at]

    def forces(self, u, slip):
        """λ (3 n) at displacements, and its derivative by G u (sparse)."""
        g, first, second = (self.G @ u).reshape(3, -1)
        pressed = np.maximum(-self.normal * (g + self.gap), 0.0)
        trial = -self.shear * (np.array([first, second]) - slip)
        size, limit = np.hypot(*trial), self.friction * pressed
        slips = size > limit
        way = trial / np.where(size > 0, size, 1.0)
        shear = np.where(slips, limit * way, trial) * (pressed > 0)
        own = -self.normal * (pressed > 0)
        held = -self.shear * (pressed > 0) * np.where(slips, limit / np.where(size > 0, size, 1), 1)
        across = np.eye(2)[:, :, None] - slips * way[:, None] * way[None]
        pulled = self.friction * own * slips * way
        blocks = [[sp.diags_array(own), None, None]]
        for i in range(2):
            columns = [sp.diags_array(held * across[i, j]) for j in range(2)]
            blocks.append([sp.diags_array(pulled[i]), *columns])
        return np.concatenate([pressed, *shear]), sp.block_array(blocks).tocsc()

    def increment(self, u, x, slip, external):
        """Newton's method with halving of the residual, and a step more where it ends.

        Displacements, forces, slip, and what is left. A hundred-billionth of the loads alone moves
        the tip by as much as is compared.
        """
        size, ends = np.abs(external).max(), False
        x, slope = self.forces(u, slip)
        left = self.K @ u - external - self.G.T @ x
        for _ in range(200):
            tangent = (self.K - self.G.T @ slope @ self.G).tocsc()
            change = -spla.splu(tangent).solve(left)
            for fraction in 0.5 ** np.arange(14):
                x, slope = self.forces(u + fraction * change, slip)
                tried = self.K @ (u + fraction * change) - external - self.G.T @ x
                if np.linalg.norm(tried) < np.linalg.norm(left):
                    break
            u, left = u + fraction * change, tried
            if ends:
                break
            ends = np.abs(left).max() < 1e-11 * size
        shear = (self.G @ u).reshape(3, -1)[1:]
        return u, x, shear + x.reshape(3, -1)[1:] / self.shear, left


class RigidFullOrder(FullOrder):
    """K u = f + Gᵀ x and x = proj(x − r z(u, x)), with u and x unknown; 1/c is 0 where rigid."""

    factor = 1e4
    """r, near the stiffness of a point [N/mm]."""

    @property
    def gives(self):
        return np.concatenate([1 / self.normal, 1 / self.shear, 1 / self.shear])

    def residual(self, u, x, slip, external):
        """Rest of both equations, and the derivative of the projection."""
        z = (self.G @ u + self.gives * x).reshape(3, -1) + np.vstack([self.gap, -slip])
        trial = x.reshape(3, -1) - self.factor * z
        normal, size = np.maximum(trial[0], 0.0), np.hypot(*trial[1:])
        limit = self.friction * normal
        slips = size > limit
        way = trial[1:] / np.where(size > 0, size, 1.0)
        held = np.where(slips, limit / np.where(size > 0, size, 1.0), 1.0) * (normal > 0)
        projected = np.vstack([normal, np.where(slips, limit * way, trial[1:])])
        across = np.eye(2)[:, :, None] - slips * way[:, None] * way[None]
        pulled = self.friction * (normal > 0) * slips * way
        blocks = [[sp.diags_array((normal > 0) * 1.0), None, None]]
        for i in range(2):
            columns = [sp.diags_array(held * across[i, j]) for j in range(2)]
            blocks.append([sp.diags_array(pulled[i]), *columns])
        balance = self.K @ u - external - self.G.T @ x
        return np.concatenate([balance, x - projected.ravel()]), sp.block_array(blocks)

    def increment(self, u, x, slip, external):
        """As that of elastic contact."""
        size, n, ends = np.abs(external).max(), len(u), False
        left, slope = self.residual(u, x, slip, external)
        for _ in range(200):
            forces = sp.eye_array(len(x)) - slope + self.factor * slope @ sp.diags_array(self.gives)
            rows = [[self.K, -self.G.T], [self.factor * slope @ self.G, forces]]
            change = -spla.splu(sp.block_array(rows).tocsc()).solve(left)
            for fraction in 0.5 ** np.arange(14):
                moved, forces = u + fraction * change[:n], x + fraction * change[n:]
                tried, slope = self.residual(moved, forces, slip, external)
                if np.linalg.norm(tried) < np.linalg.norm(left):
                    break
            u, x, left = moved, forces, tried
            if ends:
                break
            ends = np.abs(left).max() < 1e-11 * size
        return u, x, (self.G @ u + self.gives * x).reshape(3, -1)[1:], left


@cache
def joint(**parameters):
    model = fy.lap_joint(**{"element_size": 5.0, **parameters})
    return model.with_bolt_forces(dict.fromkeys(model.bolts, 8e3))


def check_law(model, path):
    """No force outside the cone, no gap that closes, nothing that slips below its bound."""
    contact, P = model.contact, model.contact.relative_operator
    G = sp.vstack([contact.interpolation @ P, contact.shear @ P])
    friction, before = np.empty(contact.n_points), np.zeros((2, contact.n_points))
    gives = np.empty((3, contact.n_points))
    for name, law in contact.laws.items():
        at = contact.slices[name]
        friction[at] = law.friction
        gives[0, at] = 1 / law.penalty / contact.weights[at]
        gives[1:, at] = 1 / law.tangential_penalty / contact.weights[at]
    for u, x_n, x_t, slip in zip(
        path.states, path.contact_forces, path.shear_forces, path.shear_slip, strict=True
    ):
        largest = x_n.max()
        z = (G @ u).reshape(3, -1) + gives * np.vstack([x_n, x_t])
        z[0] += contact.initial_gap
        z[1:] -= before
        before = slip
        # Slack in length times the stiffness of a point, about 1e4 N/mm, is in force.
        assert (x_n > -1e-9 * largest).all()
        assert (1e4 * z[0] > -1e-9 * largest).all()
        assert (1e4 * np.abs(z[0][x_n > 1e-9 * largest]) < 1e-8 * largest).all()
        size = np.hypot(*x_t)
        assert (size <= friction * x_n + 1e-9 * largest).all()
        sticks = (x_n > 1e-9 * largest) & (size < friction * x_n - 1e-8 * largest)
        assert (1e4 * np.hypot(*z[1:, sticks]) < 1e-8 * largest).all()


def compare(model, loads, count=None):
    """The path of a model, of its reduction without joint modes, and of the full order.

    The full order solves so many increments; all of them unless told.
    """
    path = fy.solve_path(model, loads)
    check_law(model, path)
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=3), compliance=True)
    reduced, largest = fy.solve_path(rom, loads), path.max_pressure.max()
    # Round-off of S times the penalty.
    np.testing.assert_allclose(reduced.pressure, path.pressure, rtol=0, atol=1e-8 * largest)
    np.testing.assert_allclose(reduced.traction, path.traction, rtol=0, atol=1e-8 * largest)
    np.testing.assert_allclose(reduced.dissipation.sum(), path.dissipation.sum(), rtol=1e-7)
    with pytest.raises(ModelError, match="take displacements with the full model"):
        reduced.full_displacement()
    moved, exact = fy.full_displacement(model, reduced), path.states
    np.testing.assert_allclose(moved, exact, rtol=0, atol=1e-7 * np.abs(exact).max())
    stiffest = max(law.penalty for law in model.contact.laws.values())
    full = (RigidFullOrder if stiffest == np.inf else FullOrder)(model)
    u, slip = np.zeros(model.K.shape[0]), np.zeros((2, full.n))
    x = np.zeros(3 * full.n)
    whole = zip(loads, path.states, path.contact_forces, path.shear_forces, strict=True)
    for load, state, normal, shear in islice(whole, count):
        external = input_forces(model, load.inputs(model, np.zeros(1)))[0]
        u, x, slip, left = full.increment(u, x, slip, external)
        assert np.abs(left).max() < 1e-10 * np.abs(external).max()
        np.testing.assert_allclose(state, u, rtol=0, atol=1e-9 * np.abs(u).max())
        # Forces are displacements times penalty, in which the full order loses digits.
        lost = 1e-9 if stiffest == np.inf else 1e-9 * max(1.0, stiffest / 1e6)
        found = np.vstack([normal, shear]).ravel()
        np.testing.assert_allclose(found, x, rtol=0, atol=lost * normal.max())
    return path


@pytest.mark.long
@pytest.mark.parametrize(("friction", "penalty"), [CASES[0], CASES[7], CASES[18], CASES[14]])
def test_paths_are_those_of_the_full_order(friction, penalty):
    count = 4 if penalty == "hard" else None  # these take long; the slow ones have all
    compare(joint(penalty=penalty).with_friction(friction), reversing_path(0), count)


COARSE = {"element_size": 10.0, "hole_radius": 0.0, "washer_radius": 11.0, "penalty": 1e6}
OTHERS = {"curved": {"curvature": 8e-3}}
MORE = {
    "mortar, hard": {"upper_element_size": 7.0, "penalty": "hard"},
    "mortar, curved, nodal": {
        "upper_element_size": 7.0,
        "curvature": 4e-3,
        "quadrature": "nodal",
    },
    "curved, nodal": {"curvature": 8e-3, "quadrature": "nodal"},
    "mortar": {"upper_element_size": 7.0},
    **{kind: {"shape": kind} for kind in ("hex20", "tet4", "tet10", "wedge6", "wedge15")},
}


@pytest.mark.parametrize(
    "parameters",
    [*OTHERS.values(), *(pytest.param(one, marks=pytest.mark.slow) for one in MORE.values())],
    ids=[*OTHERS, *MORE],
)
def test_paths_of_other_interfaces(parameters):
    """Curved, of meshes that do not match, of every kind of solid."""
    model = joint(**{**COARSE, **parameters}).with_friction(0.2)
    path = compare(model, reversing_path(0)[:6])
    assert path.dissipation[1:].max() > 0
    # Tractions lie in the surface, whatever its shape.
    across = np.einsum("ipk,pk->ip", path.traction, model.interfaces["joint"].normals)
    assert np.abs(across).max() < 1e-12 * path.max_pressure.max()


@pytest.mark.parametrize("other", [1e5, pytest.param(np.inf, marks=pytest.mark.slow)])
def test_paths_of_interfaces_with_laws_of_their_own(other):
    """One stiff, the other soft or hard; each with a coefficient and a tangential penalty.

    The middle plate hangs in stiff springs: round-off of what moves freely is not looked for.
    """
    smooth = joint(**{**COARSE, "plates": 3, "quadrature": "nodal", "tip_suspension": (1e5, 1e8)})
    second = smooth.interfaces["joint-2"].with_penalty(other)
    smooth = smooth.with_interfaces({**smooth.interfaces, "joint-2": second})
    tangential = {"joint-1": 5e5, "joint-2": min(other, 2e9)}
    model = smooth.with_friction({"joint-1": 0.1, "joint-2": 0.4}, tangential_penalty=tangential)
    compare(model, reversing_path(0)[:5])


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "penalty"), CASES)
@pytest.mark.parametrize("seed", range(1, 6))
def test_a_hundred_paths_are_those_of_the_full_order(friction, penalty, seed):
    """A fifth of them hard."""
    compare(joint(penalty=penalty).with_friction(friction), reversing_path(seed))
