"""What a factorization will take, and what the system grants."""

import logging
import os
import subprocess
import sys

import numpy as np
import pytest
import scipy.sparse as sp
from threadpoolctl import threadpool_limits

import faying as fy
from faying.exceptions import ModelError
from faying.linalg import memory
from faying.linalg.backends import available_backends, count_negative, estimate_memory
from faying.linalg.factorization import factorize
from faying.linalg.memory import (
    VARIABLE,
    Limit,
    NotEnoughMemoryError,
    control_group_limits,
    free_memory,
    physical_memory,
)

BACKENDS = available_backends()
needs_mkl = pytest.mark.skipif("pardiso" not in BACKENDS, reason="MKL is not installed")


@pytest.fixture(params=BACKENDS)
def backend(request):
    return request.param


@pytest.fixture(scope="module")
def interior():
    """K_ii of a lap joint."""
    structure = fy.lap_joint(element_size=3.5).structure
    return structure.K[structure.interior][:, structure.interior].tocsr()


def test_the_estimate_is_what_the_factors_take(backend, interior):
    K = interior
    expected = estimate_memory(K, backend=backend)
    with threadpool_limits(1):  # each thread more takes some workspace of its own
        taken = factorize(K, backend=backend).memory
    # PARDISO's supernodes store more than entries, the less the larger; the law for SuperLU may be
    # off by two.
    most = 1.5 if expected.counted else 2.0
    assert 1 / most < expected.factor / taken < most
    # PARDISO's workspace is 17 MB for each thread but one.
    assert max(0.99 * taken if expected.counted else 0, expected.factor) <= expected.peak
    assert expected.peak < most * taken + 20e6 * (os.cpu_count() or 1)
    assert (expected.backend, expected.order) == (backend, K.shape[0])
    assert expected.counted == (backend == "pardiso")


def test_a_node_that_nothing_holds_is_counted(backend, interior):
    """A model is told the size of its factors before it is refused for what moves freely."""
    K = interior
    free = np.zeros(K.shape[0])
    free[9:12] = 1.0
    held = sp.diags_array(1.0 - free)
    alone = (held @ K @ held).tocsr()
    alone.eliminate_zeros()
    found = estimate_memory(alone, backend=backend)
    assert found.factor <= 1.01 * estimate_memory(K, backend=backend).factor


@pytest.mark.parametrize("n", [0, 1, 5])
def test_dense_and_small_matrices(backend, n):
    assert estimate_memory(np.eye(n)).factor == 8 * n * n
    small = estimate_memory(sp.csr_array((n, n)), backend=backend)  # even an empty pattern
    assert small.order == n
    assert small.factor >= 0


@needs_mkl
def test_what_does_not_fit_is_refused(interior, monkeypatch):
    K = interior
    monkeypatch.setenv(VARIABLE, "1e6")
    said = r"factors of 3\d+ degrees of freedom take about 0\.0\d+ GB \(pardiso\), and 0.001 GB"
    with pytest.raises(NotEnoughMemoryError, match=said) as caught:
        factorize(K, backend="pardiso")
    assert isinstance(caught.value, ModelError)  # the command line shows the message alone
    monkeypatch.setenv(VARIABLE, "1e12")
    assert factorize(K, backend="pardiso").backend == "pardiso"


def test_a_count_is_no_reason_to_run_out_of_memory(backend, interior, monkeypatch):
    monkeypatch.setenv(VARIABLE, "1e6")
    with pytest.raises(NotEnoughMemoryError, match=backend):
        count_negative(interior, backend=backend)


def test_an_estimate_by_law_only_warns(interior, monkeypatch, caplog):
    K = interior
    monkeypatch.setenv(VARIABLE, "1e6")
    with caplog.at_level(logging.WARNING, logger="faying"):
        assert factorize(K, backend="superlu").backend.startswith("superlu")
    assert "use a coarser mesh" in caplog.text
    assert len(caplog.records) == 1


@pytest.mark.parametrize("word", ["much", "inf", "nan"])
def test_the_variable_must_be_a_number(monkeypatch, word):
    monkeypatch.setenv(VARIABLE, word)
    with pytest.raises(ModelError, match=r"FAYING_MEMORY = .* a number of bytes"):
        free_memory()


def write(folder, **files):
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name.replace("__", ".")).write_text(text)


def test_limits_of_version_2(tmp_path, monkeypatch):
    """The job's own group, the limit of the one above it, and none at the top."""
    write(tmp_path / "proc/self", cgroup="0::/slice/job\n")
    top = tmp_path / "sys/fs/cgroup"
    stat = "anon 5\ninactive_file 100\nactive_file 7\n"
    write(top, memory__stat=stat)
    write(top / "slice", memory__max="5000\n", memory__current="4000\n", memory__stat=stat)
    write(top / "slice/job", memory__max="max\n", memory__current="900\n", memory__stat=stat)
    assert control_group_limits(tmp_path) == [Limit(5000, 1100)]
    write(top / "slice/job", memory__max="1000\n")
    assert control_group_limits(tmp_path) == [Limit(1000, 200), Limit(5000, 1100)]
    write(tmp_path / "proc", meminfo="MemTotal: 9 kB\nMemAvailable:       8 kB\n")
    monkeypatch.setattr(memory, "SYSTEM", tmp_path)
    monkeypatch.delenv(VARIABLE, raising=False)
    assert free_memory() == 200
    assert physical_memory() == 1000
    write(top / "slice/job", memory__current="1300\n")  # above the limit for a moment
    assert free_memory() == 0
    write(tmp_path / "proc", meminfo="MemAvailable:       0 kB\n")
    assert free_memory() == 0


def test_limits_of_version_1_in_a_container(tmp_path):
    """The path of the group is that of the host; its files are at the top."""
    lines = "8:pids:/docker/a\n4:cpu,memory:/docker/a\n1:name=systemd:/docker/a\n"
    write(tmp_path / "proc/self", cgroup=lines)
    stat = "cache 5\ntotal_inactive_file 50\n"
    top = tmp_path / "sys/fs/cgroup/memory"
    write(
        top,
        memory__limit_in_bytes="3000\n",
        memory__usage_in_bytes="1000\n",
        memory__stat=stat,
    )
    assert control_group_limits(tmp_path) == [Limit(3000, 2050)]
    write(top, memory__limit_in_bytes="9223372036854771712\n")  # what the kernel says of no limit
    assert control_group_limits(tmp_path) == []


def test_systems_that_do_not_tell(tmp_path, monkeypatch, interior):
    monkeypatch.setattr(memory, "SYSTEM", tmp_path)
    monkeypatch.delenv(VARIABLE, raising=False)
    assert free_memory() is None
    assert control_group_limits() == []
    assert physical_memory() > 2**28
    assert factorize(interior).memory > 0


@pytest.mark.skipif(sys.platform != "linux", reason="reads the files of the Linux kernel")
def test_this_machine_tells():
    """In a process of its own, where no test has set anything."""
    script = "from faying.linalg.memory import *; print(free_memory(), physical_memory())"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=600
    )
    free, physical = map(int, done.stdout.split())
    assert 0 < free <= physical
