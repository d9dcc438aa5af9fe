"""Damaged matrix files of Abaqus and CalculiX: refused, or read as what they now say."""

import numpy as np
import pytest
from damage import damaged
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.exceptions import FormatError
from faying.io.matrix_tables import read_matrix

QUICK = settings(max_examples=200)
TEXTS = {
    ".mtx": "** heading\n1,1, 1,1, 4.0E+00\n1,2, 1,1,-1.5D0\n1,2, 1,2, 3.25\n7,3, 7,3, 2.0\n",
    ".sti": "1 1  4.0000000000000e+00\n1 2 -1.5000000000000e+00\n2 2  3.2500000000000e+00\n",
}


@pytest.mark.long
@pytest.mark.parametrize("suffix", TEXTS)
@given(data=st.data())
@QUICK
def test_damage(tmp_path, suffix, data):
    content = data.draw(damaged(TEXTS[suffix].encode(), text=True))
    path = tmp_path / f"job{suffix}"
    path.write_bytes(content)
    (tmp_path / "job.dof").write_text("1.1\n1.2\n")
    found, message = attempt(path)
    if found is None:
        assert path.name in message
        return
    matrix = found.matrix
    assert matrix.shape[0] == matrix.shape[1] <= 2 * len(content)
    # Every value stands in the file, in one of the notations it may have.
    written = {abs(v) for v in numbers(content.decode("latin-1"))}
    assert {abs(v) for v in matrix.data.tolist()} <= written | {0.0}


def attempt(path):
    """A matrix and an empty message, or None and the message of the refusal."""
    try:
        return read_matrix(path, "K"), ""
    except FormatError as error:
        return None, str(error)


def numbers(text):
    """All numbers of the last columns of a file."""
    for line in text.splitlines():
        fields = line.replace(",", " ").replace("D", "E").replace("d", "e").split()
        if fields and not line.lstrip().startswith("**"):
            yield float(fields[-1])


@pytest.mark.long
@given(values=st.lists(st.floats(-1e300, 1e300), min_size=3, max_size=3))
@QUICK
def test_values_survive(tmp_path, values):
    a, b, c = values
    path = tmp_path / "K.mtx"
    path.write_text(f"3,1,3,1,{a!r}\n3,2,3,1,{b!r}\n3,2,3,2,{c!r}\n")
    found = read_matrix(path, "K")
    # A diagonal of 1e36 or more is what Abaqus writes for a held row, which has no place.
    free = [v < 1e36 for v in (a, c)]
    expected = np.array([[a, b], [b, c]])[free][:, free]
    np.testing.assert_array_equal(found.matrix.toarray(), expected)
    assert found.dofs.tolist() == [
        d for d, keep in zip([[3, 1], [3, 2]], free, strict=True) if keep
    ]
