"""How many threads dense linear algebra has in a run."""

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from faying.linalg.mkl import load_mkl
from faying.linalg.threads import SMALL_ORDER, one_thread, threads_for
from faying.study.inputs.load_set import read_loads
from faying.study.keys.schema import read_study
from faying.workflow.reduce import reduce_study
from faying.workflow.run import run
from faying.workflow.solve import solve_loads
from small_study import BEND, NO_REPORT, SMALL_JOINT, reduction


@pytest.fixture(autouse=True)
def _two_threads():
    load_mkl()  # a library that came later would keep what the environment says
    with threadpool_limits(2, user_api="blas"):
        yield


def counted():
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


def test_large_matrices_have_all_threads_and_small_ones_one():
    assert counted() == {2}
    with threads_for(SMALL_ORDER + 1):
        assert counted() == {2}
    with threads_for(SMALL_ORDER):
        assert counted() == {1}
    with one_thread():
        assert counted() == {1}
        with threads_for(SMALL_ORDER + 1):
            assert counted() == {2}
        assert counted() == {1}
    assert counted() == {2}


class Watch:
    """Counts threads whenever a stage begins."""

    def __init__(self):
        self.seen = []

    def add_task(self, description, *, total=None):
        self.seen.append(counted())

    def advance(self, task, advance=1):
        pass

    def remove_task(self, task):
        pass


STUDY = SMALL_JOINT + reduction("compliance", normal_modes=3) + BEND + NO_REPORT


@pytest.mark.long
def test_runs_reductions_and_solved_loads_have_one_thread(tmp_path):
    (tmp_path / "study.toml").write_text(STUDY)
    (tmp_path / "loads.csv").write_text("case,tip.Fz\na,-150\n")
    study = read_study(tmp_path / "study.toml")
    rom = reduce_study(study, tmp_path / "joint.faying", progress=(reducing := Watch()))
    loads = read_loads(tmp_path / "loads.csv", rom)
    solve_loads(rom, loads, tmp_path / "solved", progress=(solving := Watch()))
    run(study, tmp_path / "run", progress=(running := Watch()))
    for watch in (reducing, solving, running):
        assert watch.seen
        assert all(one == {1} for one in watch.seen)
