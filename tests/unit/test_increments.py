"""Increments with friction of a few points, in Python and as compiled, against Coulomb's law."""

import sys
from dataclasses import replace
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.linalg import lapack

import faying.contact
from faying.contact.compiled_frictional import CompiledFrictionalContact
from faying.contact.contact import Contact
from faying.contact.frictional import SOLVED, Increment
from faying.contact.laws import Coulomb, Penalty
from faying.contact.laws_at_points import LawsAtPoints
from faying.exceptions import ConvergenceError
from faying.simulation.path import MOST_DIVISIONS, PathStep, follow
from few_points import (
    ELASTIC,
    ELASTIC_YIELD,
    PAIRS,
    YIELD,
    N,
    check_law,
    free,
    joint,
)
from random_friction import natural_residual, small_path, walked

COMPILED = ("compiled_points", "compiled_increments")


@pytest.fixture(scope="module")
def interpreted():
    """The modules that numba compiles, as they are written; LAPACK by SciPy."""
    numba = pytest.importorskip("numba", reason="needs the extra 'compiled'")
    names = [f"faying.contact.{name}" for name in COMPILED]
    before = {name: sys.modules.pop(name) for name in names if name in sys.modules}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(numba.config, "DISABLE_JIT", True)
        points, loop = map(import_module, names)

    def factorize(_, matrix, pivots):
        matrix[:], pivots[:], failed = lapack.dgetrf(matrix)
        return failed == 0

    def substitute(_, transposed, matrix, pivots, right):
        assert bytes(transposed) == b"T"
        right[:] = lapack.dgetrs(matrix, pivots, right.T)[0].T

    loop.factorize, loop.substitute = factorize, substitute
    yield points, loop
    for name, module in zip(names, (points, loop), strict=True):
        sys.modules.pop(name)
        vars(faying.contact).pop(name.rpartition(".")[2], None)
        if name in before:
            sys.modules[name] = before[name]
            setattr(faying.contact, name.rpartition(".")[2], before[name])
        assert module is not before.get(name)


class Counting:
    """The solver in Python, and how many increments it was left."""

    def __init__(self, plain):
        self.plain, self.left = plain, 0

    def __getattr__(self, name):
        return getattr(self.plain, name)

    def solve(self, z_free, start=None):
        self.left += 1
        return self.plain.solve(z_free, start)


def compiled(plain, interpreted, about=None):
    """The solver that is compiled, as it is written."""
    solver = CompiledFrictionalContact(Counting(plain), about)
    vars(solver)["_loop"] = interpreted[1]
    return solver


@pytest.mark.parametrize("seed", range(6))
def test_increments_obey_the_law(seed):
    """Each from the one before; all sides of the law occur."""
    plain, G = joint(seed)
    start, kinds = plain.solve(free(seed)), np.zeros(3)
    check_law(plain, G, free(seed), start)
    for step in range(8):
        target = free(100 * seed + step, shear=0.1 if step % 2 else 0.7)
        found = plain.solve(target, start.forces)
        slips, sticks = check_law(plain, G, target, found)
        kinds += [slips.sum(), sticks.sum(), (found.forces[0] == 0).sum()]
        assert found.iterations >= 1
        gap = (found.slack - YIELD * found.forces)[0]
        np.testing.assert_allclose(plain.gap(found), gap, rtol=0, atol=1e-12)
        start = found
    assert kinds.min() > 2


@pytest.mark.parametrize("seed", range(4))
def test_compiled_increments_obey_the_law(seed, interpreted):
    """About the state before and about none; few of steps this large are left to Python."""
    plain, G = joint(seed, ELASTIC)
    start, solved = plain.solve(free(seed)), 0
    for step in range(8):
        target = free(seed) + free(100 * seed + step) * (0.01, 0.1, 0.5, 1.0)[step % 4]
        solver = compiled(plain, interpreted, start.forces if step % 3 else None)
        found = solver.solve(target, start.forces)
        check_law(plain, G, target, found, ELASTIC_YIELD)
        solved += solver.plain.left == 0
        start = found
    assert solved >= 6


def test_compiled_increments_of_stiff_points(interpreted):
    """Points 1e8 times stiffer than the structure: no digits may go in b less nearly b.

    18 of 36 are solved as compiled, the others by the last digits of their systems; none was.
    """
    stiff = 1e8
    laws = {
        "one": Coulomb(Penalty(2 * stiff), 0.4, 1.5 * stiff),
        "two": Penalty(5 * stiff),
        "three": Coulomb(Penalty(20 * stiff), 0.2, 15 * stiff),
    }
    solved = 0
    for seed in range(6):
        plain, G = joint(seed, laws)
        start = plain.solve(free(seed))
        for step in range(6):
            target = free(seed) + free(100 * seed + step) * (0.01, 0.1, 0.5)[step % 3]
            solver = compiled(plain, interpreted, start.forces if step % 2 else None)
            start = solver.solve(target, start.forces)
            check_law(plain, G, target, start, ELASTIC_YIELD / stiff)
            solved += solver.plain.left == 0
    assert solved >= 12


@pytest.mark.parametrize("seed", range(3))
def test_an_increment_begins_as_a_similar_one_ended(seed):
    plain, G = joint(seed)
    start, target = plain.solve(free(seed)), free(seed + 50)
    similar = plain.solve(target, start.forces)
    again = plain.solve(target, start.forces, similar)
    check_law(plain, G, target, again)
    assert again.iterations <= min(2, similar.iterations)


def test_opened_joints_have_no_forces(interpreted):
    plain, _ = joint()
    start = plain.solve(free(0)).forces
    opened = np.abs(free(3)) + np.array([0.5, 0, 0])[:, None]
    for solver in (plain, compiled(plain, interpreted, start)):
        found = solver.solve(opened, start)
        np.testing.assert_array_equal(found.forces, 0.0)
        np.testing.assert_array_equal(found.slack, opened)


@pytest.mark.parametrize("seed", [2, 6, 16, 21, 22, 38, 77])
def test_paths_of_few_points_that_newton_steps_alone_do_not_solve(seed):
    """Rank-deficient, stiff, with normals that lean; all that is tried beside Newton steps."""
    _, plain, relatives = small_path(np.random.default_rng(seed))
    for step, slip in walked(plain, relatives):
        # Twice, for sums in another order.
        assert natural_residual(plain, step, slip) <= 2 * SOLVED


def random_forces(n=40):
    """Trial forces that press, pull, shear more and less than friction holds, or do nothing."""
    random = np.random.default_rng(7)
    trial = random.normal(size=(3, n)) + np.array([0.5, 0, 0])[:, None]
    trial[:, 0], trial[1:, 1] = 0.0, 0.0
    trial[0, 1:5] = 1.0, 0.7, -0.3, 0.0
    friction = np.where(np.arange(n) % 7 == 3, 0.0, random.uniform(0.1, 1.0, n))
    friction[1] = 0.0
    return trial, friction


def coulomb_at(points, law_of):
    contact = Contact(
        relative_operator=np.eye(3 * points),
        interpolation=sp.csr_array(np.eye(points, 3 * points)),
        shear=sp.csr_array(np.eye(2 * points, 3 * points, k=points)),
        initial_gap=np.zeros(points),
        weights=np.ones(points),
        laws={str(p): law_of(p) for p in range(points)},
        slices={str(p): slice(p, p + 1) for p in range(points)},
    )
    return LawsAtPoints(contact=contact)


class TestCompiledPoints:
    """Each loop over points against arrays."""

    def test_derivatives_and_residuals_are_those_of_the_law(self, interpreted):
        points, _ = interpreted
        trial, friction = random_forces()
        n = trial.shape[1]
        laws = coulomb_at(n, lambda p: Coulomb(Penalty(1.0), friction[p], 1.0))
        slope = np.full((n, 9), np.nan)
        points.slopes(trial, friction, slope)
        # The same expressions in another order.
        np.testing.assert_allclose(
            slope, laws.derivative(trial, None).reshape(n, 9), rtol=0, atol=1e-14
        )
        x, wrong = np.random.default_rng(8).normal(size=(3, n)), np.full((3, n), np.nan)
        norm, left = points.residual(trial, x, friction, wrong)
        expected = x - laws.admissible(trial, None)
        np.testing.assert_allclose(wrong, expected, rtol=0, atol=1e-14)
        assert norm == pytest.approx(np.linalg.norm(expected), rel=1e-13)
        largest = max(np.abs(x).max(), np.abs(expected).max())
        assert left == pytest.approx(np.abs(expected).max() / largest, rel=1e-13)
        small = 0.01 * x
        _, left = points.residual(trial, small, friction, wrong)
        assert left == 1.0
        solved = laws.admissible(trial, None)
        assert points.residual(solved, solved, friction, wrong)[1] <= 1e-15
        assert points.residual(0 * trial, 0 * x, friction, wrong) == (0.0, 0.0)
        assert points.residual(trial, np.nan * x, friction, wrong) == (np.inf, np.inf)

    def test_springs_of_a_point(self, interpreted):
        points, _ = interpreted
        random = np.random.default_rng(9)
        slope = 0.5 * random.random((3, 3))
        r, c = random.uniform(0.5, 2.0, (2, 3, 2))
        inverse, K = np.full(9, np.nan), np.full(9, np.nan)
        points.local(slope.ravel(), 1, r, c, inverse, K)
        scaled = slope * r[:, 1]
        exact = np.linalg.inv(np.eye(3) - slope + scaled * c[:, 1])
        np.testing.assert_allclose(inverse, exact.ravel(), rtol=0, atol=1e-12)
        np.testing.assert_allclose(K, (exact @ scaled).ravel(), rtol=0, atol=1e-12)

    def test_between_points_and_pairs(self, interpreted):
        points, _ = interpreted
        plain, G = joint()
        rows, random = plain.steps.rows, np.random.default_rng(10)
        pairs, forces = random.normal(size=3 * PAIRS), random.normal(size=(3, N))
        at_points, at_pairs = np.full((3, N), np.nan), np.full(3 * PAIRS, np.nan)
        points.interpolate(rows.columns, rows.values, pairs, at_points)
        np.testing.assert_allclose(at_points, G @ pairs, rtol=0, atol=1e-14)
        points.share_out(rows.columns, rows.values, forces, at_pairs)
        expected = np.einsum("apr,ap->r", G, forces)
        np.testing.assert_allclose(at_pairs, expected, rtol=0, atol=1e-14)

    def test_blocks_of_points(self, interpreted):
        points, _ = interpreted
        random = np.random.default_rng(11)
        blocks, vectors = random.normal(size=(N, 9)), random.normal(size=(3, N))
        result = random.normal(size=(3, N))
        expected = result - 0.5 * np.einsum("pab,bp->ap", blocks.reshape(N, 3, 3), vectors)
        points.blockwise(blocks, vectors, -0.5, result)
        np.testing.assert_allclose(result, expected, rtol=0, atol=1e-14)


class TestCompiledSystems:
    """What steps are made of, against arrays."""

    def test_compliance_between_changed_points(self, interpreted):
        _, loop = interpreted
        plain, G = joint()
        rows, random = plain.steps.rows, np.random.default_rng(12)
        more = np.zeros((N, 9))
        changed = np.array([0, 4])
        more[changed] = random.normal(size=(2, 9))
        pairs = loop.touched(rows.columns, rows.values, changed, 3 * PAIRS)
        met = np.flatnonzero(np.abs(G[:, changed]).sum(axis=(0, 1)))
        np.testing.assert_array_equal(pairs, met)
        B = sum(G[:, p].T @ more[p].reshape(3, 3) @ G[:, p] for p in changed)
        found = loop.assembled(rows.columns, rows.values, plain.S, more, changed, pairs)
        expected = (np.eye(3 * PAIRS) + B @ plain.S)[np.ix_(pairs, pairs)]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13)

    def test_points_that_differ(self, interpreted):
        _, loop = interpreted
        slope = np.zeros((4, 9))
        slope[1, 8], slope[2, 0], slope[3, 4] = -0.3, 0.1, 0.05
        np.testing.assert_array_equal(loop.differing(slope, 0 * slope, 0.1), [1])
        np.testing.assert_array_equal(loop.differing(slope, slope, 0.0), [])

    def test_linear_steps_are_extrapolated_to_their_end(self, interpreted):
        """Of steps A (w − x), as many as there are unknowns tell the end."""
        _, loop = interpreted
        random = np.random.default_rng(13)
        n, w = 3, random.normal(size=6)
        A = 0.5 * np.diag([1.0, 0.6, 0.2, 1.0, 0.6, 0.2])
        past, x = np.zeros((5, 2, 6)), np.zeros(6)
        for i in range(4):
            past[i] = x, A @ (w - x)
            x = x + past[i, 1]
        step = past[3, 1].copy()
        loop.extrapolated(past, 4, step)
        # Round-off times the square of the condition of three steps in geometric ratios.
        np.testing.assert_allclose(past[3, 0, :n] + step[:n], w[:n], rtol=0, atol=1e-6)

    def test_a_state_to_begin_from(self, interpreted):
        """Points at their bound slip, others stick, and open ones have no springs."""
        _, loop = interpreted
        forces = np.array([[2.0, 2.0, 0.0], [0.8, 0.3, 0.0], [0.0, 0.0, 0.0]])
        friction, r = np.full(3, 0.4), np.full((3, 3), 1.5)
        c = np.full((3, 3), 0.2)
        slope, K, inverse = loop.linearized(forces, friction, r, c)
        slip = [1, 0, 0, 0.4, 0, 0, 0, 0, 1]
        stick = np.eye(3).ravel()
        # A point is taken to slip on when it is within 1e-6 of the bound.
        np.testing.assert_allclose(slope, [slip, stick, 0 * stick], rtol=0, atol=2e-6)
        for p in (0, 1):
            own = slope[p].reshape(3, 3)
            exact = np.linalg.inv(np.eye(3) - own + own * (r * c)[:, p])
            np.testing.assert_allclose(inverse[p], exact.ravel(), rtol=0, atol=1e-12)
            np.testing.assert_allclose(K[p], 1.5 * (exact @ own).ravel(), rtol=0, atol=1e-12)
        np.testing.assert_array_equal(inverse[2], stick)
        assert not K[2].any()
        for found, expected in zip(loop.unsupported(2), (0, 0, stick), strict=True):
            np.testing.assert_array_equal(found, np.broadcast_to(expected, (2, 9)))


@pytest.mark.parametrize(
    ("gap", "pressed", "parts"),
    [(0.0, False, 1), (1e-3, False, MOST_DIVISIONS + 1), (0.0, True, MOST_DIVISIONS + 1)],
)
def test_increments_are_halved_where_half_of_one_is_another_problem(gap, pressed, parts):
    plain, _ = joint()
    contact = replace(plain.contact, initial_gap=np.full(N, gap))
    asked = []

    def refuse(z_free, *_):
        asked.append(z_free)
        message = "no"
        raise ConvergenceError(message)

    forces = np.full((3, N), float(pressed))
    nothing = Increment(forces=forces, slack=np.zeros((3, N)), iterations=0, residual=0.0)
    here = PathStep(relative=np.zeros(3 * PAIRS), increment=nothing, slip=np.zeros((2, N)))
    solver = SimpleNamespace(contact=contact, S=plain.S, solve=refuse)
    with pytest.raises(ConvergenceError, match="load 1 of 1 on the path: no"):
        list(follow(solver, np.ones((1, 3 * PAIRS)), here))
    assert len(asked) == parts
