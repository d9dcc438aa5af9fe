"""Every sparse backend against dense inverses and against the others."""

import gc
import os
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import faying as fy
from faying.exceptions import ModelError
from faying.linalg import superlu
from faying.linalg.backends import VARIABLE, available_backends
from faying.linalg.factorization import factorize
from faying.linalg.mkl import PardisoHandle
from faying.linalg.partial import port_compliance
from faying.linalg.singular import SingularMatrixError
from faying.linalg.superlu import SMALLEST, nested_dissection

BACKENDS = available_backends()
needs_mkl = pytest.mark.skipif("pardiso" not in BACKENDS, reason="MKL is not installed")


@pytest.fixture(params=BACKENDS)
def backend(request):
    return request.param


@pytest.fixture(scope="module")
def interior():
    """K_ii of a small lap joint and the ports of its interface."""
    structure = fy.lap_joint(element_size=5.0).structure
    inner = structure.interior
    return structure.K[inner][:, inner].tocsr(), structure.relative_operator[:, inner].tocsr()


def random_definite(n, density, dofs, rng):
    D = sp.random_array((n, n), density=density, rng=rng, format="csr")
    return sp.kron(D @ D.T + sp.eye_array(n), np.eye(dofs) + 0.1).tocsr()


@settings(max_examples=60)
@given(
    n=st.integers(1, 60),
    density=st.floats(0, 0.3),
    dofs=st.sampled_from([1, 2, 3, 6]),  # with and without the blocks of a node
    n_right=st.integers(0, 5),
    seed=st.integers(0, 1000),
)
def test_solutions_leave_no_residual(n, density, dofs, n_right, seed):
    rng = np.random.default_rng(seed)
    A = random_definite(n, density, dofs, rng)
    B = rng.standard_normal((A.shape[0], n_right))
    exact = np.linalg.solve(A.toarray(), B)
    for backend in BACKENDS:
        found = factorize(A, backend=backend).solve(B)
        assert np.abs(A @ found - B).max(initial=0) <= 1e-10  # B of order one, condition below 1e3
        np.testing.assert_allclose(found, exact, rtol=0, atol=1e-12)


@pytest.mark.parametrize("shape", [(), (1,), (0,), (300,)])
def test_against_the_dense_inverse(backend, interior, shape):
    K, _ = interior
    b = np.random.default_rng(0).standard_normal((K.shape[0], *shape))
    factor = factorize(K, backend=backend)
    x = factor.solve(b)
    exact = np.linalg.inv(K.toarray()) @ b
    assert x.shape == b.shape
    # Condition 1e7 times round-off.
    np.testing.assert_allclose(x, exact, rtol=0, atol=1e-9 * np.abs(exact).max(initial=1e-300))
    assert factor.backend.startswith(backend)
    assert factor.memory > 8 * K.shape[0]


def test_port_compliance_is_the_same_however_formed(backend, interior):
    K, ports = interior
    found = port_compliance(ports, factorize(K, backend=backend))
    exact = ports @ np.linalg.inv(K.toarray()) @ ports.T.toarray()
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-10 * np.abs(exact).max())


@pytest.mark.parametrize("n", [0, 1, 2, 3, 4])
def test_small_matrices(backend, n):
    A = (2 * sp.eye_array(n)).tocsr()
    ports = sp.csr_array((0, n))
    factor = factorize(A, backend=backend)
    np.testing.assert_allclose(factor.solve(np.ones((n, 2))), 0.5, rtol=1e-15)  # one ulp
    assert port_compliance(ports, factor).shape == (0, 0)


def test_regular_but_indefinite_matrices_are_solved(backend):
    main = np.where(np.arange(40) % 5, 3.0, -3.0)
    A = sp.diags_array([-np.ones(39), main, -np.ones(39)], offsets=[-1, 0, 1]).tocsr()
    b = np.arange(40.0)
    np.testing.assert_allclose(A @ factorize(A, backend=backend).solve(b), b, atol=1e-12)


def test_a_mechanism_of_a_solid_is_named(backend):
    """Round-off of assembly leaves pivots of either sign: whole motions of a free structure."""
    structure = fy.lap_joint(element_size=5.0, bolt_positions=()).structure
    with pytest.raises(SingularMatrixError) as caught:
        factorize(structure.K, backend=backend)
    motion = caught.value.motion
    energy = motion @ (structure.K @ motion) / (structure.K.diagonal() @ motion**2)
    assert abs(energy) < 1e-13


def test_threads_may_solve_at_once(backend, interior):
    K, _ = interior
    factor = factorize(K, backend=backend)
    right = np.random.default_rng(0).standard_normal((8, K.shape[0], 3))
    alone = [factor.solve(b) for b in right]
    before = threading.active_count()

    def work(b):
        np.linalg.inv(np.eye(300) + 0.1)  # NumPy's threads meanwhile
        return factor.solve(b)

    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(work, np.repeat(right, 4, axis=0)))
    for x, y in zip(together, np.repeat(alone, 4, axis=0), strict=True):
        np.testing.assert_allclose(x, y, rtol=0, atol=1e-12 * np.abs(y).max())
    assert threading.active_count() <= before


@pytest.mark.long
def test_two_threads_in_every_library(backend):
    """OpenMP of MKL beside the threads of NumPy's and SciPy's BLAS, in a process of its own."""
    script = f"""
import numpy as np, scipy.linalg as la, scipy.sparse as sp
from faying.linalg.factorization import factorize
A = sp.kron(sp.diags_array([-np.ones(1999), np.full(2000, 2.1), -np.ones(1999)],
            offsets=[-1, 0, 1]), np.eye(3) + 1).tocsr()
dense = np.random.default_rng(0).standard_normal((600, 600))
for _ in range(3):
    product = dense @ dense.T
    la.cholesky(product + 600 * np.eye(600))
    x = factorize(A, backend={backend!r}).solve(np.ones((6000, 20)))
    assert np.abs(A @ x - 1).max() < 1e-10
    assert np.isfinite(la.eigvalsh(product)).all()
"""
    environment = {**os.environ, "OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"}
    done = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.long
@needs_mkl
def test_memory_is_freed_with_the_factorization(interior, monkeypatch):
    gc.collect()  # factorizations that other tests left are none of this one's
    released = []
    release = PardisoHandle.release

    def counted(handle):
        released.append(handle)
        release(handle)

    monkeypatch.setattr(PardisoHandle, "release", counted)
    factor = factorize(interior[0], backend="pardiso")
    assert not released
    del factor
    gc.collect()
    assert len(released) == 1
    with pytest.raises(SingularMatrixError):  # and with the attempts that failed
        factorize(sp.csr_array(np.array([[1.0, -1.0], [-1.0, 1.0]])), backend="pardiso")
    gc.collect()
    assert len(released) == 3  # the matrix itself and the shifted one


def test_the_environment_chooses(monkeypatch, interior):
    K, _ = interior
    monkeypatch.setenv(VARIABLE, "superlu")
    assert factorize(K).backend.startswith("superlu")
    monkeypatch.delenv(VARIABLE)
    assert factorize(K).backend.startswith(BACKENDS[0])
    monkeypatch.setenv(VARIABLE, "umfpack")
    with pytest.raises(ModelError, match=r"FAYING_FACTORIZATION = 'umfpack'.*choose among"):
        factorize(K)


def test_without_mkl_superlu_serves(monkeypatch, interior):
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setattr("faying.linalg.backends.load_mkl", lambda: None)
    assert factorize(interior[0]).backend.startswith("superlu")
    with pytest.raises(ModelError, match="pip install mkl"):
        factorize(interior[0], backend="pardiso")


def test_minimum_degree_where_metis_is_missing(monkeypatch, interior):
    K, _ = interior
    b = np.ones(K.shape[0])
    first = factorize(K, backend="superlu").solve(b)
    monkeypatch.setattr(superlu, "nested_dissection", lambda A: None)
    factor = factorize(K, backend="superlu")
    assert factor.backend == "superlu"
    np.testing.assert_allclose(factor.solve(b), first, rtol=0, atol=1e-9 * np.abs(first).max())


def test_metis_keeps_factors_sparse(monkeypatch):
    pytest.importorskip("pymetis")
    structure = fy.lap_joint(element_size=3.0).structure
    K = structure.K[structure.interior][:, structure.interior].tocsr()
    order = nested_dissection(K)
    assert K.shape[0] > SMALLEST
    np.testing.assert_array_equal(np.sort(order), np.arange(K.shape[0]))
    ordered = factorize(K, backend="superlu")
    assert ordered.backend == "superlu+metis"
    monkeypatch.setattr(superlu, "nested_dissection", lambda A: None)
    assert ordered.memory < 1.05 * factorize(K, backend="superlu").memory


def test_right_hand_sides_of_the_wrong_length_are_refused(backend):
    factor = factorize((2 * sp.eye_array(6)).tocsr(), backend=backend)
    with pytest.raises(ValueError, match=r"rows|size"):
        factor.solve(np.ones((1, 3)))
