"""Factorizations of symmetric positive definite matrices, and what they say of others."""

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.exceptions import ModelError
from faying.joint.free_matrices import FreeMatrices
from faying.joint.structure import Structure
from faying.linalg.partial import port_compliance
from faying.linalg.singular import SingularMatrixError
from faying.linalg.substitution import BLOCK


def chain(n, first=1.0):
    """Springs in a row, the first one to ground."""
    main = np.full(n, 2.0)
    main[0], main[-1] = 1.0 + first, 1.0
    return sp.diags_array([-np.ones(n - 1), main, -np.ones(n - 1)], offsets=[-1, 0, 1]).tocsr()


@pytest.mark.parametrize("form", [lambda A: A, lambda A: A.toarray(), lambda A: A.tocsc()])
@pytest.mark.parametrize("shape", [(50,), (50, 3), (50, 1), (50, 0)])
def test_solves(form, shape):
    A = chain(50)
    b = np.random.default_rng(0).standard_normal(shape)
    x = fy.factorize(form(A)).solve(b)
    assert x.shape == shape
    np.testing.assert_allclose(A @ x, b, atol=1e-12)  # round-off of a chain of 50


@pytest.mark.parametrize("form", [lambda A: A, lambda A: A.toarray()])
def test_names_the_free_motion(form):
    with pytest.raises(SingularMatrixError) as caught:
        fy.factorize(form(chain(20, first=0.0)))
    motion = caught.value.motion
    np.testing.assert_allclose(motion / motion[0], 1.0, rtol=1e-6)  # all move together
    assert isinstance(caught.value, ModelError)


@pytest.mark.parametrize("form", [lambda A: A, lambda A: A.toarray()])
def test_names_a_motion_of_one_part(form):
    A = sp.block_diag([chain(10), chain(5, first=0.0)]).tocsr()
    with pytest.raises(SingularMatrixError) as caught:
        fy.factorize(form(A))
    motion = np.abs(caught.value.motion)
    assert motion[:10].max() < 1e-6 * motion[10:].max()


@pytest.mark.parametrize("form", [lambda A: A, lambda A: A.toarray()])
def test_an_empty_row_is_a_free_motion(form):
    A = sp.block_diag([chain(6), sp.csr_array((1, 1))]).tocsr()
    with pytest.raises(SingularMatrixError) as caught:
        fy.factorize(form(A))
    assert np.abs(caught.value.motion).argmax() == 6


@pytest.mark.parametrize("form", [lambda A: A, lambda A: A.toarray()])
def test_a_soft_but_held_structure_is_not_singular(form):
    """A long chain (condition 1e6) and mixed units (1e12) are no mechanism."""
    fy.factorize(form(chain(600)))
    scale = sp.diags_array(np.where(np.arange(60) % 2, 1e6, 1.0))
    A = (scale @ chain(60) @ scale).tocsr()
    b = scale @ np.ones(60)
    x = fy.factorize(form(A)).solve(b)
    np.testing.assert_allclose(scale @ x, np.cumsum(np.arange(60, 0, -1.0)), rtol=1e-9)


def test_structure_free_without_its_boundary_says_so():
    """Held at the tip's boundary only: the interior factorizes, the whole does not."""
    model = fy.lap_joint(element_size=5.0, bolt_positions=())
    with pytest.raises(SingularMatrixError) as caught:
        fy.solve_static(model)
    assert np.abs(caught.value.motion).max() < 1e6  # of order one, whatever the round-off
    nodal = model.dofs.nodal(caught.value.motion)
    moving = np.linalg.norm(nodal[:, :3], axis=1)
    upper = model.assembly.mesh.nodes[:, 2] > 0
    assert moving[upper].max() > 0
    lower = model.assembly.mesh.nodes[:, 2] < 0
    assert moving[lower].max() < 1e-6 * moving[upper].max()


@pytest.mark.parametrize("seed", range(20))
def test_free_structure_with_one_boundary_is_found(seed):
    """What the condensed stiffness of one degree of freedom leaves is round-off of either sign."""
    n = 30
    stiffness = np.random.default_rng(seed).uniform(0.5, 2, n - 1) * 1e6
    D = sp.diags_array([-np.ones(n - 1), np.ones(n - 1)], offsets=[0, 1], shape=(n - 1, n))
    K = (D.T @ sp.diags_array(stiffness) @ D).tocsr()
    free = Structure(
        matrices=FreeMatrices(form=lambda: (K, K, None)),
        relative_operator=sp.csr_array((1, n)),
        boundary=np.array([n - 1]),
        elongations=np.zeros((0, n)),
    )
    with pytest.raises(SingularMatrixError) as caught:
        free.solve(np.ones((n, 1)))
    # All move together.
    np.testing.assert_allclose(caught.value.motion / caught.value.motion[-1], 1.0, rtol=1e-6)


@pytest.mark.parametrize("form", [lambda P: P, lambda P: P.toarray()])
@pytest.mark.parametrize("n_port", [0, 1, BLOCK + 7])
def test_port_compliance(form, n_port):
    n = 400
    ports = sp.random_array((n_port, n), density=0.01, rng=np.random.default_rng(0)).tocsr()
    A = chain(n)
    found = port_compliance(form(ports), fy.factorize(A))
    expected = ports @ np.linalg.solve(A.toarray(), ports.toarray().T)
    # Round-off times the condition of the chain, 6e5.
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * np.abs(expected).max(initial=1))
    np.testing.assert_array_equal(found, found.T)
