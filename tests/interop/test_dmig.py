"""DMIG files of Nastran and pyYeti are read to the bit, and ours by pyYeti."""

from pathlib import Path

import numpy as np
import pytest
from witness import pyyeti_nastran

from faying.exceptions import FormatError
from faying.io.dmig import dmig_text, read_dmig
from faying.io.matrix_tables import read_matrix

bulk = pyyeti_nastran().bulk

PUNCHED = Path(bulk.__file__).parents[1] / "tests" / "nastran_dmig_data" / "matrix_factory.pch"


@pytest.mark.parametrize("name", ["PATRN", "IDENT", "RANDM"])
def test_punch_file_of_nastran(name: str) -> None:
    wanted = bulk.rddmig(str(PUNCHED))[name.lower()]
    found = read_dmig(PUNCHED, name)
    labels = np.array(wanted.index.to_list())
    labels[labels[:, 1] == 0, 1] = 1  # scalar points
    np.testing.assert_array_equal(found.dofs, labels)
    # Both convert the same decimals: equal to the bit.
    np.testing.assert_array_equal(found.matrix.toarray(), wanted.to_numpy())


def test_complex_matrix_of_nastran_is_refused() -> None:
    with pytest.raises(FormatError, match=r"matrix_factory.pch:970: DMIG: matrix CMPLX is complex"):
        read_dmig(PUNCHED, "CMPLX")


@pytest.mark.parametrize("symmetric", [True, False])
def test_ours_in_pyyeti_and_back(tmp_path: Path, symmetric: bool) -> None:
    random = np.random.default_rng(5)
    matrix = random.standard_normal((8, 8)) * 10.0 ** random.integers(-8, 8, (8, 8))
    matrix = matrix + matrix.T if symmetric else matrix
    matrix[2, 5] = matrix[5, 2] = 0.0
    dofs = np.array([(7, c) for c in range(1, 7)] + [(101, 0), (102, 0)])
    path = tmp_path / "k.dmig"
    path.write_text(dmig_text("KAAX", matrix, dofs))
    theirs = bulk.rddmig(str(path))["kaax"]
    assert theirs.index.to_list() == [tuple(dof) for dof in dofs.tolist()]
    # Sixteen columns keep ten digits at least.
    np.testing.assert_allclose(theirs.to_numpy(), matrix, rtol=5e-10, atol=0)
    ours = read_matrix(path, "K")
    np.testing.assert_array_equal(ours.matrix.toarray(), theirs.to_numpy())
    assert ours.dofs is not None
    assert ours.dofs[-2:].tolist() == [[101, 1], [102, 1]]


HAND_WRITTEN = """
DMIG,STIF,0,6,1,0
DMIG,STIF,27,1,,2,3,3.+5,
,2,4,2.5+10,,50,,1.0
DMIG,STIF,2,3,,2,3,7.0
"""


def test_free_field_with_scalar_point(tmp_path: Path) -> None:
    path = tmp_path / "k.dmig"
    path.write_text(HAND_WRITTEN)
    found = read_dmig(path, "K")
    assert found.dofs is not None
    assert found.dofs.tolist() == [[2, 3], [2, 4], [27, 1], [50, 1]]
    wanted = [[7, 0, 3e5, 0], [0, 0, 2.5e10, 0], [3e5, 2.5e10, 0, 1], [0, 0, 1, 0]]
    assert found.matrix.toarray().tolist() == wanted


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("STIF,0,6,1", "STIF,0,9,1", "k.dmig:2: DMIG: matrix STIF has form 9"),
        ("STIF,0,6,1", "STIF,0,6,3", "k.dmig:2: DMIG: matrix STIF is complex"),
        ("2,3,7.0", "27,1,7.0", "k.dmig:5: .*is given twice|k.dmig:3"),
        ("50,,1.0", "2,3,1.0", "k.dmig:4: DMIG: matrix STIF: row 27-1 of column 2-3"),
        ("3.+5", "3.x5", r"k.dmig:3: DMIG: field 8 holds '3.X5', expected a real number"),
        ("2,4,2.5", "2,7,2.5", "k.dmig:4: DMIG: grid 2 component 7"),
        (
            "DMIG,STIF,0,6,1,0",
            "$",
            "k.dmig:3: DMIG: a column of matrix 'STIF', which has no",
        ),
        ("DMIG,STIF,2,3,,", "DMIG,STIF,0,6,1,", "two headers"),
        ("1.0\n", "1.0,2.0\n", "expected nothing"),
    ],
)
def test_damage_is_named(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = tmp_path / "k.dmig"
    text = HAND_WRITTEN.replace(old, new, 1)
    if "27,1,7.0" in new:
        text += "DMIG,STIF,27,1,,2,3,1.0\n"
    path.write_text(text)
    with pytest.raises(FormatError, match=message):
        read_dmig(path, "STIF")
