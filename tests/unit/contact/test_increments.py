"""Increments with friction of a few points, by stages and at once, against Coulomb's law."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import linprog

from faying.contact import newton_descent
from faying.contact.between_pairs import ByCompliance
from faying.contact.glued_pairs import GluedPairs
from faying.contact.increment import Increment, displaced
from faying.contact.laws import Coulomb, Penalty
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.yielding import YieldingContact
from faying.digits import SOLVED
from faying.exceptions import ConvergenceError
from faying.simulation.path_steps import MOST_DIVISIONS, PathStep, follow
from few_points import (
    ELASTIC,
    ELASTIC_YIELD,
    PAIRS,
    POINT_STIFFNESS,
    YIELD,
    N,
    apart,
    check_law,
    free,
    joint,
)
from random_friction import natural_residual, small_path, solver_of, walked

STILL = np.zeros(3 * PAIRS)


def by_displacements(plain):
    """The solver of the same increments that paths take where every point yields."""
    laws = LawsAtPoints(contact=plain.contact)
    between = ByCompliance(plain.S)
    pairs = GluedPairs.of(plain.contact.rows, laws.springs, between)
    return YieldingContact(contact=plain.contact, between=between, pairs=pairs, otherwise=plain)


@pytest.mark.parametrize("seed", range(6))
def test_increments_obey_the_law(seed):
    """Each from the one before; all sides of the law occur."""
    plain, G = joint(seed)
    start, kinds = plain.solve(STILL, free(seed)), np.zeros(3)
    check_law(plain, G, free(seed), start)
    for step in range(8):
        target = free(100 * seed + step, shear=0.1 if step % 2 else 0.7)
        found = plain.solve(STILL, target, start)
        slips, sticks = check_law(plain, G, target, found)
        kinds += [slips.sum(), sticks.sum(), (found.forces[0] == 0).sum()]
        assert found.iterations >= 1
        gap = (found.slack - YIELD * found.forces)[0]
        np.testing.assert_allclose(found.gap(plain.laws), gap, rtol=0, atol=1e-12)
        start = found
    assert kinds.min() > 2


@pytest.mark.parametrize("seed", range(4))
def test_increments_by_displacements_obey_the_law(seed):
    """Each from the one before; all sides of the law occur."""
    plain, G = joint(seed, ELASTIC)
    solver, kinds = by_displacements(plain), np.zeros(3)
    start = solver.solve(STILL, free(seed))
    check_law(plain, G, free(seed), start, ELASTIC_YIELD)
    for step in range(8):
        target = free(100 * seed + step, shear=0.1 if step % 2 else 0.7)
        found = solver.solve(STILL, target, start)
        slips, sticks = check_law(plain, G, target, found, ELASTIC_YIELD)
        kinds += [slips.sum(), sticks.sum(), (found.forces[0] == 0).sum()]
        np.testing.assert_allclose(found.moved, displaced(plain, STILL, found.forces), rtol=1e-12)
        gap = (found.slack - ELASTIC_YIELD * found.forces)[0]
        np.testing.assert_allclose(found.gap(plain.laws), gap, rtol=0, atol=1e-12)
        start = found
    assert kinds.min() > 2


def test_increments_by_displacements_of_stiff_points():
    """Points up to 2e6 times stiffer than the structure, 200 times STIFFEST."""
    stiff = 1e5
    laws = {
        "one": Coulomb(Penalty(2 * stiff), 0.4, 1.5 * stiff),
        "two": Penalty(5 * stiff),
        "three": Coulomb(Penalty(20 * stiff), 0.2, 15 * stiff),
    }
    for seed in range(6):
        plain, G = joint(seed, laws)
        solver = by_displacements(plain)
        start = solver.solve(STILL, free(seed))
        for step in range(6):
            target = free(seed) + free(100 * seed + step) * (0.01, 0.1, 0.5)[step % 3]
            start = solver.solve(STILL, target, start)
            check_law(plain, G, target, start, ELASTIC_YIELD / stiff)


def test_points_that_all_stick_are_what_a_solution_begins_with(monkeypatch):
    """Gaps count with their sign: what stays closed and stuck is solved without a step."""
    compliance, gap = 0.1, -np.linspace(1.0, 2.0, 5)
    solver = by_displacements(apart(5, compliance))
    monkeypatch.setattr(newton_descent, "MOST_STEPS", 0)
    offset = np.vstack([gap, np.zeros((2, 5))])
    found = newton_descent.solve_yielding(solver.laws, solver.pairs, np.zeros(15), offset)
    # Springs in series, to round-off.
    pressed = -gap / (1 / POINT_STIFFNESS + compliance)
    np.testing.assert_allclose(found.forces[0], pressed, rtol=1e-13)


def test_opened_joints_have_no_forces():
    opened = np.abs(free(3)) + np.array([0.5, 0, 0])[:, None]
    plain, _ = joint()
    start = plain.solve(STILL, free(0))
    solver = by_displacements(joint(0, ELASTIC)[0])
    pressed = solver.solve(STILL, free(0))
    for found in (plain.solve(STILL, opened, start), solver.solve(STILL, opened, pressed)):
        np.testing.assert_array_equal(found.forces, 0.0)
        np.testing.assert_array_equal(found.slack, opened)


@pytest.mark.parametrize("seed", [2, 6, 16, 22, 38, 77])
def test_paths_of_few_points_that_newton_steps_alone_do_not_solve(seed):
    """Rank-deficient, stiff, with normals that lean; all that is tried beside Newton steps."""
    _, plain, relatives = small_path(np.random.default_rng(seed))
    for step, slip in walked(solver_of(plain), relatives):
        # Twice, for sums in another order.
        assert natural_residual(plain, step, slip) <= 2 * SOLVED


def test_points_that_no_displacement_opens_are_refused():
    """Hard points of path 21, without friction: forces would rise to 1e10 times the others'.

    Some of their normals differ by 1e-7.
    """
    _, plain, relatives = small_path(np.random.default_rng(21))
    solver, contact = solver_of(plain), plain.contact
    gap = contact.initial_gap + contact.interpolation @ relatives[0]
    n, rows = len(gap), contact.interpolation.toarray()
    # No displacement up to a thousand times the gaps opens all of them.
    far = 1e3 * np.abs(gap).max()
    widest = linprog(
        np.append(np.zeros(rows.shape[1]), -1.0),
        A_ub=np.column_stack([-rows, np.ones(n)]),
        b_ub=gap,
        bounds=[(-far, far)] * rows.shape[1] + [(None, None)],
    )
    assert -widest.fun < 0
    with pytest.raises(ConvergenceError, match="points of hard contact may contradict each other"):
        solver.solve(relatives[0], contact.offset())


@pytest.mark.parametrize(
    ("gap", "pressed", "parts"),
    [(0.0, False, 1), (1e-3, False, MOST_DIVISIONS + 1), (0.0, True, MOST_DIVISIONS + 1)],
)
def test_increments_are_halved_where_half_of_one_is_another_problem(gap, pressed, parts):
    plain, _ = joint()
    contact = replace(plain.contact, initial_gap=np.full(N, gap))
    asked = []

    def refuse(target, *_):
        asked.append(target)
        message = "no"
        raise ConvergenceError(message)

    forces = np.full((3, N), float(pressed))
    nothing = Increment(
        forces=forces, slack=np.zeros((3, N)), moved=STILL, iterations=0, residual=0.0
    )
    here = PathStep(relative=STILL, increment=nothing, slip=np.zeros((2, N)))
    solver = SimpleNamespace(contact=contact, S=plain.S, solve=refuse)
    with pytest.raises(ConvergenceError, match="load 1 of 1 on the path: no"):
        list(follow(solver, np.ones((1, 3 * PAIRS)), here))
    assert len(asked) == parts
