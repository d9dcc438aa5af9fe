"""The compliance between many ports, a Schur complement, against complete solutions."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import faying as fy
from faying.linalg import pardiso
from faying.linalg.backends import available_backends, estimate_memory, estimate_port_memory
from faying.linalg.budget import DENSE_COPIES
from faying.linalg.factorization import factorize
from faying.linalg.mkl import PardisoHandle
from faying.linalg.partial import port_compliance
from faying.linalg.singular import NotDefiniteError

pytestmark = pytest.mark.skipif("pardiso" not in available_backends(), reason="needs MKL")


@pytest.fixture(scope="module")
def plates():
    """Stiffness and three ports a node pair of two plates that touch nearly all over."""
    model = fy.lap_joint(
        element_size=5.0, length=105.0, width=60.0, overlap=85.0, thickness=10.0, penalty=1e6
    ).with_friction(0.2)
    inner = model.structure.interior
    ports = model.structure.relative_operator[:, inner].tocsr()
    return model.K[inner][:, inner].tocsr(), ports


@pytest.fixture
def solved(monkeypatch):
    """Numbers of right-hand sides that PARDISO solved for."""
    counts = []
    complete = PardisoHandle.solve

    def counted(handle, right):
        counts.append(right.shape[1])
        return complete(handle, right)

    monkeypatch.setattr(PardisoHandle, "solve", counted)
    return counts


def assert_agree(found, exact):
    # Condition 1e7 times round-off, as of single solutions.
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-9 * np.abs(exact).max())


def test_as_by_complete_substitutions(plates, solved):
    K, ports = plates
    factor = factorize(K, backend="pardiso")
    solved.clear()
    found = port_compliance(ports, factor)
    assert not solved
    assert_agree(found, ports @ factor.solve(ports.T.toarray()))
    np.testing.assert_array_equal(found, found.T)


def test_weak_springs_cost_the_stiffness_no_digits():
    """As of a plate that is not held at all: glued to the other one it is."""
    loose = fy.lap_joint(element_size=5.0, bolt_positions=()).with_friction(0.2)
    weak, ports = fy.with_weak_springs(loose, 1e-6), loose.structure.relative_operator
    exact = pardiso.port_stiffness(loose.K, ports)
    found = pardiso.port_stiffness(weak.K, ports)
    # Springs of 1e-6 N/mm beside 1e5; their compliance has lost all other digits.
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-10 * np.abs(exact).max())


def refused(_):
    raise NotDefiniteError


def test_where_it_fails_all_columns_are_solved_for(plates, solved, monkeypatch):
    K, ports = plates
    factor = factorize(K, backend="pardiso")
    right = port_compliance(ports, factor)
    monkeypatch.setattr(PardisoHandle, "schur_complement", refused)
    assert_agree(port_compliance(ports, factor), right)
    assert sum(solved) >= ports.shape[0]


def test_few_or_dense_columns_are_solved_for(plates, solved, monkeypatch):
    K, ports = plates
    factor = factorize(K, backend="pardiso")
    monkeypatch.setattr(pardiso, "port_stiffness", None)
    solved.clear()
    few = port_compliance(ports[: pardiso.FEW_PORTS], factor)
    some = port_compliance(ports[: pardiso.FEW_PORTS + 5].toarray(), factor)
    assert sum(solved) == 2 * pardiso.FEW_PORTS + 5
    np.testing.assert_allclose(
        few, some[: pardiso.FEW_PORTS, : pardiso.FEW_PORTS], rtol=0, atol=1e-12
    )


@pytest.mark.long
@settings(max_examples=60)
@given(
    n=st.integers(1, 60),
    density=st.floats(0, 0.1),
    n_port=st.integers(1, 80),
    port_density=st.sampled_from([0.0, 0.02, 0.3, 1.0]),
    seed=st.integers(0, 1000),
)
def test_ports_of_any_rows(n, density, n_port, port_density, seed):
    """Also where nothing is connected, bodies fall apart, and ports are empty or more than rows."""
    rng = np.random.default_rng(seed)
    A = sp.random_array((n, n), density=density, rng=rng)
    A = (A @ A.T + sp.diags_array(1 + rng.random(n))).tocsr()
    ports = sp.random_array((n_port, n), density=port_density, rng=rng).tocsr()
    found = pardiso.port_stiffness(A, ports)
    if found is None:
        return
    exact = ports @ np.linalg.inv(A.toarray()) @ ports.T.toarray()
    np.testing.assert_array_equal(found, found.T)
    # Entries of order one to 1e2, condition below 1e5.
    np.testing.assert_allclose(found @ exact, np.eye(n_port), rtol=0, atol=1e-9)


def test_memory_is_foretold_and_what_does_not_fit_takes_longer(plates, monkeypatch, caplog):
    K, ports = plates
    told, dense = estimate_port_memory(K, ports, backend="pardiso")
    assert told > max(24 * ports.shape[0] ** 2, estimate_memory(K).peak)
    assert dense == 8 * DENSE_COPIES * ports.shape[0] ** 2
    factor = factorize(K, backend="pardiso")
    right = port_compliance(ports, factor)
    factors = estimate_memory(K, backend="pardiso")
    monkeypatch.setenv("FAYING_MEMORY", str(10 * (factors.factor + told)))
    assert factors.with_ports(told, 0).peak == factors.factor + told
    assert not factors.with_ports(told, dense).one_by_one
    monkeypatch.setenv("FAYING_MEMORY", str(told // 2))
    foretold = factors.with_ports(told, dense)
    assert foretold.one_by_one
    assert foretold.peak == max(factors.peak, factors.factor + dense)
    assert_agree(port_compliance(ports, factor), right)
    assert f"{ports.shape[0]} ports are solved for one by one" in caplog.text
