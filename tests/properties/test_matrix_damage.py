"""Matrix files with mistakes in them are read or refused in one line, whatever the mistakes.

Compiled code of SciPy ended the process here: its readers of Matrix Market and MATLAB 5, and its
conversions of sparse matrices whose indices are out of range.
"""

import io
import warnings

import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.exceptions import FormatError
from faying.io.matrix_tables import read_matrix

SIZE = 12
K = sp.csr_array(
    sp.random_array((SIZE, SIZE), density=0.2, rng=np.random.default_rng(3)) + sp.eye_array(SIZE)
)
K = sp.csr_array(K + K.T)


def market(symmetry, dense=False):
    file = io.BytesIO()
    scipy.io.mmwrite(file, K.toarray() if dense else K, symmetry=symmetry)
    return file.getvalue()


def matlab(matrix, **options):
    file = io.BytesIO()
    scipy.io.savemat(file, {"K": matrix}, **options)
    return file.getvalue()


FILES = {
    "general.mtx": market("general"),
    "symmetric.mtx": market("symmetric"),
    "array.mtx": market("general", dense=True),
    "symmetric-array.mtx": market("symmetric", dense=True),
    "sparse.mat": matlab(K),
    "dense.mat": matlab(K.toarray()),
    "compressed.mat": matlab(K, do_compression=True),
    "four.mat": matlab(K, format="4"),
}


@pytest.fixture(autouse=True)
def _little_memory(monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", "1e6")  # what is to be refused need not be tried


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("matrices")


@pytest.mark.long
@pytest.mark.parametrize("name", FILES)
def test_whole_files(folder, name):
    (folder / name).write_bytes(FILES[name])
    found = read_matrix(folder / name, "K").matrix
    # Matrix Market is written with sixteen digits.
    assert abs(found - K).max() <= 1e-15 * abs(K).max()


@pytest.mark.long
@pytest.mark.parametrize("name", FILES)
def test_files_cut_off(folder, name):
    path = folder / f"half-{name}"
    path.write_bytes(FILES[name][: len(FILES[name]) * 2 // 3])
    said, _ = found(path)
    assert f"half-{name}' cannot be read" in said


PARTS = {
    "csr": {"indices": K.indices, "indptr": K.indptr, "data": K.data},
    "csc": {"indices": K.indices, "indptr": K.indptr, "data": K.data},
    "coo": {"row": K.tocoo().row, "col": K.tocoo().col, "data": K.data},
    "bsr": {"indices": K.indices, "indptr": K.indptr, "data": K.data.reshape(-1, 1, 1)},
    "dia": {"offsets": np.arange(3), "data": np.ones((3, SIZE))},
}


@pytest.mark.long
@settings(max_examples=100)
@given(data=st.data())
@pytest.mark.parametrize("kind", PARTS)
def test_archives_whose_arrays_contradict_each_other(folder, kind, data):
    """Check sums of the archive are right, so that only the arrays themselves can be doubted."""
    parts = {name: np.array(values) for name, values in PARTS[kind].items()}
    parts |= {"shape": np.array([SIZE, SIZE]), "format": np.array(kind.encode())}
    for name in data.draw(st.lists(st.sampled_from(sorted(parts)), min_size=1, max_size=2)):
        values = parts[name]
        how = data.draw(st.sampled_from(["entry", "cut", "kind", "axis", "lost"]))
        if how == "entry" and values.size and values.dtype.kind in "if":
            at = data.draw(st.integers(0, values.size - 1))
            extremes = [-1, 0, SIZE, 10**6, 2**31 - 1, -(2**31)]
            values.reshape(-1)[at] = data.draw(st.sampled_from(extremes))
        elif how == "cut":
            parts[name] = np.atleast_1d(values)[: data.draw(st.integers(0, 5))]
        elif how == "kind" and values.dtype.kind in "if":
            kinds = ["U3", "c16", "f4", "u1"]
            parts[name] = values.astype(data.draw(st.sampled_from(kinds)))
        elif how == "axis":
            parts[name] = values[None]
    path = folder / f"{kind}.npz"
    np.savez(path, **parts)
    read_or_refused(path)


def read_or_refused(path):
    said, matrix = found(path)
    assert "\n" not in said
    if matrix is not None:  # its indices can be followed
        assert (matrix @ np.ones(matrix.shape[1])).shape == matrix.shape[:1]


def found(path):
    """What the reader says, or the matrix it makes."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of numbers beyond the range of their type
            return "", read_matrix(path, "K").matrix
    except FormatError as error:
        return str(error), None
