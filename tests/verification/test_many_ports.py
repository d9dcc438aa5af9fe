"""The compliance between many ports, formed by nested dissection, against complete solutions."""

from unittest.mock import patch

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import faying as fy
from faying.linalg import dissected
from faying.linalg.backends import available_backends
from faying.linalg.dissected import DissectedFactorization, dissected_gram, has_many
from faying.linalg.estimate import estimate_memory
from faying.linalg.factorization import factorize
from faying.linalg.partial import port_compliance
from faying.linalg.separator import separator
from faying.linalg.superlu import factorize_superlu

BACKENDS = available_backends()


@pytest.fixture(scope="module")
def plates():
    """Stiffness and three ports a node pair of two plates that touch nearly all over."""
    model = fy.lap_joint(
        element_size=5.0, length=105.0, width=60.0, overlap=85.0, thickness=10.0, penalty=1e6
    ).with_friction(0.2)
    inner = model.structure.interior
    ports = model.structure.relative_operator[:, inner].tocsr()
    return model.K[inner][:, inner].tocsr(), ports


@pytest.mark.parametrize("backend", BACKENDS)
def test_as_by_complete_substitutions(plates, backend):
    K, ports = plates
    assert has_many(ports.shape)
    factor = factorize(K, ports=ports, backend=backend)
    assert isinstance(factor, DissectedFactorization)
    parts = []

    def counted(A, columns):
        parts.append(A.shape[0])
        return factor.factorize(A, columns)

    found = dissected_gram(K, ports, counted)
    assert len(parts) >= 4  # both plates, each separated
    assert sum(parts) < K.shape[0]
    exact = ports @ factor.solve(ports.T.toarray())
    # Condition 1e7 times round-off, as of single solutions.
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-9 * np.abs(exact).max())
    np.testing.assert_array_equal(port_compliance(ports, factor), (found + found.T) / 2)


def test_a_wrong_sum_is_noticed(plates, monkeypatch):
    K, ports = plates
    factor = factorize(K, ports=ports)
    right = port_compliance(ports, factor)
    smaller = 0.999 * right
    monkeypatch.setattr(dissected, "dissected_gram", lambda *_: smaller)
    found = port_compliance(ports, factor)
    np.testing.assert_allclose(found, right, rtol=0, atol=1e-9 * np.abs(right).max())


def test_few_columns_need_no_dissection(plates, monkeypatch):
    K, ports = plates
    factor = factorize(K, ports=ports)
    monkeypatch.setattr(dissected, "dissected_gram", None)
    found = port_compliance(ports[:3], factor)
    exact = ports[:3] @ factor.solve(ports[:3].T.toarray())
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-9 * np.abs(exact).max())


def test_memory_is_that_of_the_plain_factors(plates):
    K, ports = plates
    assert estimate_memory(K, ports=ports) == estimate_memory(K)


@settings(max_examples=25, deadline=None)
@given(
    n=st.integers(2, 40),
    density=st.floats(0, 0.1),
    n_port=st.integers(1, 30),
    seed=st.integers(0, 1000),
)
def test_ports_of_any_rows(n, density, n_port, seed):
    """Also where bodies fall apart, single unknowns stand alone, and ports touch several parts."""
    rng = np.random.default_rng(seed)
    A = sp.random_array((n, n), density=density, rng=rng)
    A = (A @ A.T + sp.diags_array(1 + rng.random(n))).tocsr()
    ports = sp.random_array((n_port, n), density=rng.uniform(0, 0.3), rng=rng).tocsr()
    exact = ports @ np.linalg.inv(A.toarray()) @ ports.T.toarray()
    with patch.multiple(dissected, SMALLEST=2, FEW=0):
        found = dissected_gram(A, ports, factorize_superlu)
    # Entries of order one, condition below 1e3.
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-12)


def test_plates_are_taken_apart_at_their_bolt_and_then_halved(plates):
    K, ports = plates
    touched = np.diff(ports.tocsc().indptr) > 0
    bolt = separator(K, touched)
    assert len(bolt.unknowns) == 12  # both ends
    assert K[bolt.first][:, bolt.second].nnz == 0
    plate = K[bolt.first][:, bolt.first]
    halves = separator(plate, touched[bolt.first])
    assert plate[halves.first][:, halves.second].nnz == 0
    together = np.concatenate([halves.unknowns, halves.first, halves.second])
    np.testing.assert_array_equal(np.sort(together), np.arange(plate.shape[0]))
    share = touched[bolt.first][halves.first].sum() / touched[bolt.first].sum()
    assert 0.25 < share < 0.75
    assert len(halves.unknowns) < plate.shape[0] / 8


def test_what_cannot_be_separated():
    everything = sp.csr_array(np.ones((9, 9)) + 9 * np.eye(9))
    assert separator(everything, np.ones(9, dtype=bool)) is None
