"""With several threads the same call gives the same digits, whatever was limited before."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import numpy as np
import scipy.sparse as sp
from faying.linalg.factorization import factorize
from faying.linalg.threads import SMALL_ORDER, one_thread, threads_for

line = sp.diags_array([2.1, -1.0, -1.0], offsets=[0, 1, -1], shape=(16, 16))
A = sp.csr_array(sp.kron(sp.kron(line, line), sp.kron(line, np.eye(3) + 0.1)))
b = np.random.default_rng(0).standard_normal(A.shape[0])

def digits():
    return factorize(A).solve(b).tobytes()

with threads_for(SMALL_ORDER):
    pass  # before anything was factorized
with threads_for(SMALL_ORDER):
    begun = digits()
free = digits()
with one_thread():
    alone = digits()
with threads_for(SMALL_ORDER):
    assert digits() == begun, "limited after one_thread"
assert digits() == free, "after limits"
assert begun == alone, "one thread or another"
print("other digits with two threads" if free != alone else "the same with two threads")
"""


@pytest.mark.long
def test_digits_do_not_depend_on_limits_before():
    """In a process of its own, in which MKL is not loaded when threads are first limited."""
    two = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "2")
    source = str(Path(__file__).parents[3] / "src")
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        env={**os.environ, **two, "PYTHONPATH": source},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
