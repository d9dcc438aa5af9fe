"""PARDISO under valgrind: it reads no memory that is not its own, which dies now and then."""

import os
import shutil
import subprocess
import sys

import pytest

from faying.linalg.mkl import load_mkl

pytestmark = pytest.mark.skipif(load_mkl() is None, reason="MKL is not installed")

SCRIPT = """
import numpy as np
import scipy.sparse as sp
from faying.linalg.pardiso import port_stiffness

# Two plates of springs, joined at their rims: their border is a branch of the elimination's tree.
chain = sp.diags_array([-np.ones(19), 2.1 * np.ones(20), -np.ones(19)], offsets=[-1, 0, 1])
plate = sp.kron(chain, sp.eye_array(20)) + sp.kron(sp.eye_array(20), chain)
stiffness = sp.block_diag([plate, plate], format="csr")
rim = np.arange(20)
one, two = (sp.eye_array(800, format="csr")[rim + first] for first in (0, 400))
print(port_stiffness(stiffness, (one - two).tocsr())[0, 0])
"""


@pytest.mark.long
def test_elimination_onto_ports_reads_its_own_memory():
    if shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed (apt install valgrind)")
    watch = ("valgrind", "--undef-value-errors=no", "--error-limit=no")
    # Each array comes from malloc, so that valgrind knows where it ends.
    places = {"PYTHONMALLOC": "malloc", "MKL_DISABLE_FAST_MM": "1", "MKL_NUM_THREADS": "1"}
    run = subprocess.run(
        [*watch, sys.executable, "-c", SCRIPT],
        env=os.environ | places,
        capture_output=True,
        text=True,
        check=True,
    )
    assert float(run.stdout) > 0
    assert "mkl_pds" not in run.stderr, run.stderr
