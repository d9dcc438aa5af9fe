"""OP4 files of Nastran and pyYeti are read to the bit, and ours by pyYeti."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from witness import pyyeti_nastran

from faying.exceptions import ModelError
from faying.io.matrix_tables import read_matrix
from faying.io.op4 import read_op4, read_op4_matrices, write_op4
from refusals import refuses

op4 = pyyeti_nastran().op4

NASTRAN_FILES = sorted(
    path
    for folder in ("nastran_op4_data", "nas2cam_extseout", "nastran_drm12", "cla_test_data")
    for path in (Path(op4.__file__).parents[1] / "tests" / folder).glob("*.op4")
    # 10 000 001 columns in 20 kB: refused for their size, see test_sizes_need_bytes; a name of
    # control characters: refused as well.
    if "large_dim" not in path.name and "badname" not in path.name
)


def dense(matrix: Any) -> Any:
    return matrix.toarray() if sp.issparse(matrix) else np.asarray(matrix)


@pytest.mark.parametrize("path", NASTRAN_FILES, ids=lambda path: path.name)
def test_files_that_nastran_wrote(path: Path) -> None:
    names, matrices, forms, types = op4.load(str(path), into="list")
    compared = 0
    for name, wanted, form, kind in zip(names, matrices, forms, types, strict=True):
        if names.count(name) > 1:
            continue
        if kind > 2 or form not in (1, 2, 6):
            refuses(r"complex|form", read_op4, path, name)
        else:
            found = read_op4(path, name).matrix
            # Both only move bytes or call a correctly rounding conversion: equal to the bit.
            np.testing.assert_array_equal(found.toarray(), dense(wanted))
        compared += 1
    assert compared


WRITTEN = [
    pytest.param(binary, order, form, id=f"{'binary' if binary else 'text'}{order}{form}")
    for binary, order in ((True, "<"), (True, ">"), (False, "="))
    for form in ("dense", "bigmat", "nonbigmat")
]


@pytest.mark.parametrize(("binary", "order", "form"), WRITTEN)
def test_files_that_pyyeti_wrote(tmp_path: Path, binary: bool, order: str, form: str) -> None:
    random = np.random.default_rng(3)
    wanted = random.standard_normal((12, 12)) * 10.0 ** random.integers(-9, 9, (12, 12))
    wanted[random.random((12, 12)) < 0.6] = 0.0
    path = tmp_path / "k.op4"
    op4.write(str(path), {"kaa": wanted}, binary=binary, endian=order, sparse=form, digits=16)
    found = read_matrix(path, "K").matrix.toarray()
    # Text keeps 17 digits, which round-trip a double.
    np.testing.assert_array_equal(found, wanted)


def test_ours_in_pyyeti(tmp_path: Path) -> None:
    random = np.random.default_rng(4)
    square, wide = random.standard_normal((7, 7)), random.standard_normal((3, 9))
    square[:, 2] = 0.0
    square[:3, 4] = 0.0
    written = {"K": square + square.T, "B": square, "IRECOV": wide, "Q0": wide[0]}
    write_op4(tmp_path / "a.op4", written)
    names, matrices, forms, types = op4.load(str(tmp_path / "a.op4"), into="list")
    assert names == ["k", "b", "irecov", "q0"]
    assert forms == [6, 1, 2, 2]
    assert set(types) == {2}
    for found, wanted in zip(matrices, written.values(), strict=True):
        np.testing.assert_array_equal(dense(found), wanted.reshape(dense(found).shape))
    back = read_op4_matrices(tmp_path / "a.op4")
    np.testing.assert_array_equal(back["IRECOV"].toarray(), wide)


def test_matrix_is_chosen_by_its_name(tmp_path: Path) -> None:
    path = tmp_path / "a.op4"
    write_op4(path, {"MAA": np.eye(2), "KAA": 2 * np.eye(2), "BAA": 3 * np.eye(2)})
    for name, value in (("M", 1.0), ("K", 2.0), ("C", 3.0)):
        assert read_matrix(path, name).matrix[0, 0] == value
    write_op4(path, {"KAA": np.eye(2), "KXX": np.eye(2)})
    refuses("KAA, KXX; expected one matrix", read_matrix, path, "K")


def test_sizes_need_bytes(tmp_path: Path) -> None:
    path = tmp_path / "a.op4"
    write_op4(path, {"K": np.eye(2)})
    content = bytearray(path.read_bytes())
    content[4:12] = (2_000_000_000).to_bytes(4, "little") * 2
    path.write_bytes(content)
    refuses("declares 2000000000 rows", read_matrix, path, "K")


@pytest.mark.parametrize(
    ("name", "matrix"), [("TOOLONGNAME", np.eye(2)), ("K", np.array([[np.nan]])), ("1K", np.eye(1))]
)
def test_unwritable(tmp_path: Path, name: str, matrix: Any) -> None:
    with pytest.raises(ModelError, match=name):
        write_op4(tmp_path / "a.op4", {name: matrix})
