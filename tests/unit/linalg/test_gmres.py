"""GMRES whose answers come from another matrix each time, against dense solutions."""

import numpy as np
import pytest

from faying.linalg.gmres import corrected

SIZE = 40


def parts(seed):
    """A matrix, and matrices near it of which none is the preconditioner twice."""
    random = np.random.default_rng(seed)
    A = random.normal(size=(SIZE, SIZE)) + 12.0 * np.eye(SIZE)
    near = [A + 0.3 * random.normal(size=A.shape) for _ in range(SIZE)]
    return A, iter(near), random.normal(size=SIZE)


@pytest.mark.parametrize("seed", range(4))
def test_answers_of_a_preconditioner_that_changes(seed):
    """Also in half precision and with one answer that is of no use: products alone count."""
    A, near, right = parts(seed)
    products, answers = [], []

    def product(vector):
        products.append(vector)
        return A @ vector

    def answer(vector):
        answers.append(vector)
        if len(answers) == 2:
            return vector.copy()
        return np.linalg.solve(next(near), vector).astype(np.float16).astype(float)

    enough = 1e-9 * np.linalg.norm(right)
    x = corrected(product, answer, right, enough, SIZE)
    # Rotations tell the residual but for round-off.
    assert np.linalg.norm(right - A @ x) <= enough + 1e-13 * np.linalg.norm(right)
    assert 2 < len(products) == len(answers) < SIZE // 2
    fewer = corrected(product, lambda b: np.linalg.solve(next(near), b), right, enough, 3)
    assert fewer is None


def test_an_answer_that_is_exact_takes_one_product():
    A, _, right = parts(7)
    count = []
    x = corrected(
        lambda vector: count.append(1) or A @ vector,
        lambda vector: np.linalg.solve(A, vector),
        right,
        1e-10 * np.linalg.norm(right),
        5,
    )
    np.testing.assert_allclose(x, np.linalg.solve(A, right), rtol=1e-10)
    assert len(count) == 1
    np.testing.assert_array_equal(corrected(None, None, np.zeros(3), 0.0, 5), np.zeros(3))


def test_what_overflows_is_not_corrected():
    right = np.ones(3, dtype=np.float32)
    with np.errstate(over="ignore", invalid="ignore"):
        assert corrected(lambda x: x * np.float32(1e30), lambda b: b * 1e30, right, 0.0, 5) is None
