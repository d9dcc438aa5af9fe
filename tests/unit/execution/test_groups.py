"""Who is stepped side by side: groups of tasks, and what their histories take."""

import weakref

import numpy as np
import pytest

import faying as fy
from faying.exceptions import CampaignError
from faying.execution.checkpoint import Checkpoint
from faying.execution.groups import grouped
from faying.execution.transients import step_responses
from faying.simulation import instants
from faying.simulation.stepping import TransientSolver, transient_solver

STEP = 1e-4
LOADS = [fy.Load({"tip.Fz": 10.0 * n}, name=f"{n}") for n in range(5)]


@pytest.mark.parametrize(
    ("n_tasks", "size", "sizes"),
    [
        (0, None, []),
        (1, None, [1]),
        (4, None, [4]),
        (5, None, [2, 3]),  # evenly, rather than four and one
        (8, None, [4, 4]),
        (16, None, [4] * 4),
        (24, None, [6] * 4),
        (64, None, [8] * 8),
        (5, 1, [1] * 5),
        (5, 2, [1, 2, 2]),
        (5, 100, [5]),
    ],
)
def test_groups_are_even_and_follow_from_the_tasks(n_tasks, size, sizes):
    tasks = {f"task {n}": n for n in range(n_tasks)}
    groups = grouped(tasks, size)
    assert [item for group in groups for item in group.items()] == list(tasks.items())
    assert [len(group) for group in groups] == sizes


def test_many_tasks_do_not_make_larger_groups_for_ever():
    groups = grouped({f"task {n}": n for n in range(1000)})
    assert [len(group) for group in groups] == [8] * 125


def test_no_task_at_a_time_is_refused():
    with pytest.raises(CampaignError, match="side by side is 0; give at least one"):
        grouped({"a": 1}, 0)


def test_a_checkpoint_keeps_of_a_group_what_is_missing(tmp_path):
    checkpoint = Checkpoint(tmp_path)
    checkpoint.put("b", {"value": np.asarray(2.0)})
    computed = []

    def compute():
        for value in (10.0, 20.0, 30.0):
            computed.append(value)
            yield {"value": np.asarray(value)}

    for _ in range(2):
        checkpoint.fill(["a", "b", "c"], compute)
        assert [float(checkpoint.get(key)["value"]) for key in "abc"] == [10.0, 2.0, 30.0]
    assert computed == [10.0, 20.0, 30.0]  # all together, and once


def test_histories_side_by_side_stay_within_the_bytes_given_to_them(joint, monkeypatch):
    solver, rest = transient_solver(joint, step=STEP), fy.solve_static(joint)
    run = {"duration": 3 * STEP, "initial": rest}
    together = [solution.pressure for solution in step_responses(solver, LOADS, **run)]
    original, sizes, alive = TransientSolver.solve_cases, [], weakref.WeakSet()

    def watched(self, loads, **options):
        assert not alive  # what was computed before is not kept in memory by us
        sizes.append(len(loads))
        solutions = original(self, loads, **options)
        alive.update(solutions)
        return solutions

    monkeypatch.setattr(TransientSolver, "solve_cases", watched)
    n_number = 4 * (3 * joint.K.shape[0] + 2 * joint.contact.n_points)
    for room, expected in ((0.5, [1] * 5), (2.5, [1, 2, 2]), (5.0, [5])):
        monkeypatch.setattr(instants, "HISTORY_BYTES", int(room * 8 * n_number))
        sizes.clear()
        found = map(pressure, step_responses(solver, LOADS, **run))
        # 1e-9: round-off of several right-hand sides at once and one by one, 1e-13 here.
        np.testing.assert_allclose(list(found), together, rtol=0, atol=1e-9 * np.max(together))
        assert sizes == expected


def pressure(solution):
    return solution.pressure
