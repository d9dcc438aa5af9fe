"""Proof that no vibration mode was missed: closed forms, clusters, omissions, every backend."""

import json
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.assessment.stuck_modes import count_frequencies_below
from faying.exceptions import ConvergenceError
from faying.joint.free_matrices import FreeMatrices
from faying.joint.structure import Structure
from faying.linalg.backends import VARIABLE, available_backends
from faying.linalg.memory import VARIABLE as MEMORY
from faying.linalg.singular import InertiaError
from faying.reduction import normal_modes
from faying.reduction.mode_count import check_modes, count_modes_below
from faying.reduction.normal_modes import NormalModes, fixed_interface_normal_modes
from faying.report.model_tables import model_table
from faying.study.keys.schema import read_study
from faying.study.results.store import read_results
from faying.workflow.run import run


@pytest.fixture(params=available_backends(), autouse=True)
def backend(request, monkeypatch):
    monkeypatch.setenv(VARIABLE, request.param)
    return request.param


def chains(n, copies=1):
    """Unit masses and springs in rows, the first spring to ground, the last mass a boundary."""
    main = np.append(np.full(n - 1, 2.0), 1.0)
    one = sp.diags_array([-np.ones(n - 1), main, -np.ones(n - 1)], offsets=[-1, 0, 1])
    K = sp.block_diag([one] * copies, format="csr")
    return Structure(
        matrices=FreeMatrices(form=lambda: (sp.eye_array(n * copies, format="csr"), K, None)),
        relative_operator=sp.csr_array((0, n * copies)),
        boundary=n * np.arange(1, copies + 1) - 1,
        elongations=np.zeros((0, n * copies)),
    )


def closed_form(n):
    """Frequencies of n - 1 masses between walls: 2 sin(jπ/2n)/2π."""
    return np.sin(np.arange(1, n) * np.pi / (2 * n)) / np.pi


def test_a_bar_between_walls():
    n = 400
    exact = closed_form(n)
    modes = fixed_interface_normal_modes(chains(n), 12)
    # ARPACK's tolerance is round-off; the condition of the chain is 6e4.
    np.testing.assert_allclose(modes.frequencies, exact[:12], rtol=1e-9)
    assert modes.next_frequency == pytest.approx(exact[12], rel=1e-9)
    count = check_modes(chains(n), modes)
    assert (count.found, count.counted, count.reason) == (12, 12, "")
    assert exact[11] < count.below < exact[12]


@pytest.mark.parametrize("missing", [0, 4, 10])
def test_a_missed_mode_is_an_error_that_says_what_to_do(missing):
    """Where it lies above all that are kept, nothing is missing from them."""
    modes = fixed_interface_normal_modes(chains(400), 12)
    fewer = NormalModes(
        vectors=np.delete(modes.vectors, missing, axis=1),
        frequencies=np.delete(modes.frequencies, missing),
        next_frequency=modes.next_frequency,
    )
    with pytest.raises(ConvergenceError, match=r"11 .* where there are 12: .* ask for a few more"):
        check_modes(chains(400), fewer)


def test_an_eigenvalue_solver_that_misses_one_is_found_out(monkeypatch):
    complete = normal_modes.lowest_modes

    def forgetful(K, M, factor, count):
        squares, vectors = complete(K, M, factor, count + 1)
        return np.delete(squares, 2), np.delete(vectors, 2, axis=1)

    structure = fy.lap_joint(element_size=5.0).structure
    assert check_modes(structure, fixed_interface_normal_modes(structure, 9)).counted == 9
    monkeypatch.setattr(normal_modes, "lowest_modes", forgetful)
    with pytest.raises(ConvergenceError, match="there are 10"):
        check_modes(structure, fixed_interface_normal_modes(structure, 9))


def test_a_run_that_misses_a_mode_ends_there(monkeypatch, tmp_path):
    complete = normal_modes.lowest_modes

    def forgetful(K, M, factor, count):
        squares, vectors = complete(K, M, factor, count + 1)
        return squares[1:], vectors[:, 1:]

    monkeypatch.setattr(normal_modes, "lowest_modes", forgetful)
    study = read_study(Path(fy.__file__).parent / "study" / "demo-quick.toml")
    with pytest.raises(ConvergenceError, match="ask for a few more normal modes"):
        run(study, tmp_path)
    assert not (tmp_path / "summary.json").exists()


@pytest.mark.parametrize(("count", "proven"), [(1, None), (2, 2), (3, 2), (5, 4), (6, 6)])
def test_the_count_is_made_in_a_gap(count, proven):
    """Two equal chains have every frequency twice; a count between equals would be a toss."""
    found = check_modes(chains(150, copies=2), fixed_interface_normal_modes(chains(150, 2), count))
    assert (found and found.found) == proven
    assert (found and found.counted) == proven


def test_all_modes_and_none():
    structure = chains(5)
    every = check_modes(structure, fixed_interface_normal_modes(structure, 4))
    assert (every.found, every.counted) == (4, 4)
    assert check_modes(structure, fixed_interface_normal_modes(structure, 0)) is None


def test_what_cannot_be_counted_says_why(monkeypatch):
    modes = fixed_interface_normal_modes(chains(400), 3)
    monkeypatch.setenv(MEMORY, "1000")
    count = check_modes(chains(400), modes)
    assert (count.found, count.counted) == (3, None)
    assert "use a coarser mesh" in count.reason
    monkeypatch.delenv(MEMORY)

    def doubtful(A):
        reason = "of round-off"
        raise InertiaError(reason)

    monkeypatch.setattr("faying.reduction.mode_count.count_negative", doubtful)
    assert "of round-off" in check_modes(chains(400), modes).reason


def test_the_lap_joint(joint):
    structure = joint.structure
    modes = fixed_interface_normal_modes(structure, 20)
    count = check_modes(structure, modes)
    assert (count.found, count.counted) == (20, 20)
    halves = (modes.frequencies[1:] + modes.frequencies[:-1]) / 2
    for below in (1, 7, 13):
        assert count_modes_below(joint, halves[below - 1]) == below
    assert count_modes_below(joint, 0.0) == 0


def test_frequencies_of_the_preloaded_joint(joint):
    """Closed contact is part of the stiffness here, and the boundary free."""
    state = fy.solve_static(joint)
    found = fy.preloaded_frequencies(joint, 31, state=state)
    for below in (1, 2, 5, 30):
        between = (found[below - 1] + found[below]) / 2
        assert count_frequencies_below(joint, between, state=state) == below
    assert count_frequencies_below(joint, (found[0] + found[1]) / 2) == 1


@pytest.mark.long
def test_a_run_reports_the_count(quick_demo):
    said = json.loads((quick_demo / "summary.json").read_text(encoding="utf-8"))
    count = said["normal_modes"]
    assert count["found"] == count["counted"] > 0
    assert count["below"] > 1000  # a steel bar of 100 mm
    assert said["timings"]["stages"]["mode_count"] > 0
    table = model_table(read_results(quick_demo / "results.h5"))
    rows = {row[0].text: row[1].text for row in table.rows}
    found, of, counted = rows["fixed-interface normal modes"].split()[:3]
    assert (int(found), of, int(counted)) == (count["found"], "of", count["counted"])
    assert rows["factorization"].endswith("MB of factors")
