"""Matrices of other programs: formats, tables and the message for each mistake."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp

from faying.exceptions import FayingError, FormatError, ModelError
from faying.io.matrices import matrices_assembly, read_matrices
from faying.model.assembly import Support

NODES = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
IDS = np.array([10, 20, 30, 40])
DOFS = np.stack([np.repeat(IDS, 3), np.tile([1, 2, 3], 4)], axis=1)
_random = np.random.default_rng(3).normal(size=(12, 12))
K = _random @ _random.T
M = np.diag(np.arange(1.0, 13.0))


def matrix_file(path: Path, matrix: np.ndarray) -> Path:
    kind = path.name.partition(".")[2]
    if kind == "npz":
        sp.save_npz(path, sp.csr_array(matrix))
    elif kind == "dense.npz":
        np.savez(path, stiffness=matrix)
    elif kind == "mtx":
        scipy.io.mmwrite(path, sp.coo_array(matrix), symmetry="symmetric", precision=17)
    elif kind == "full.mtx":
        scipy.io.mmwrite(path, matrix, precision=17)
    else:
        scipy.io.savemat(path, {"anything": sp.csc_array(matrix), "note": "text"})
    return path


def tables(path: Path) -> dict[str, Path]:
    """Node and dof table as text."""
    nodes, dofs = path / "nodes.csv", path / "dofs.txt"
    rows = [f"{i}, {x}, {y}, {z}" for i, (x, y, z) in zip(IDS, NODES, strict=True)]
    nodes.write_text("id,x,y,z\n# comment\n" + "\n".join(rows) + "\n")
    dofs.write_text("\n".join(f"{n} {c}" for n, c in DOFS))
    return {"nodes": nodes, "dofs": dofs}


@pytest.mark.parametrize(
    "kind",
    [
        "npz",
        "dense.npz",
        *(pytest.param(k, marks=pytest.mark.long) for k in ("mtx", "full.mtx", "mat")),
    ],
)
def test_formats(tmp_path: Path, kind: str) -> None:
    files = {name: matrix_file(tmp_path / f"{name}.{kind}", m) for name, m in (("M", M), ("K", K))}
    assembly = read_matrices(**files, C=files["K"], **tables(tmp_path))
    block = assembly.matrices
    assert block is not None
    assert block.C is not None
    # Seventeen digits are exact; averaging the triangles is exact for equal numbers.
    for found, wanted in ((block.M, M), (block.K, K), (block.C, K)):
        assert np.array_equal(found.toarray(), wanted)
    assert np.array_equal(assembly.mesh.nodes, NODES)
    assert assembly.mesh.node_ids.tolist() == IDS.tolist()
    assert block.nodes.tolist() == np.repeat(range(4), 3).tolist()
    assert block.components.tolist() == [0, 1, 2] * 4


@pytest.mark.long
def test_matrix_chosen_by_name_among_several(tmp_path: Path) -> None:
    path = tmp_path / "both.mat"
    scipy.io.savemat(path, {"M": M, "K": K})
    assembly = read_matrices(M=path, K=path, **tables(tmp_path))
    assert assembly.matrices is not None
    assert np.array_equal(assembly.matrices.K.toarray(), K)
    scipy.io.savemat(path, {"A": M, "B": K})
    with pytest.raises(FormatError, match=r"matrix M: .* holds A, B; name one of them M"):
        read_matrices(M=path, K=path, **tables(tmp_path))


def test_tables_in_npz(tmp_path: Path) -> None:
    np.savez(tmp_path / "nodes.npz", np.column_stack([IDS, NODES]))
    np.savez(tmp_path / "dofs.npz", DOFS)
    np.savez(tmp_path / "faces.npz", top=[[10, 20, 30, 40]])
    (tmp_path / "sets.csv").write_text("name,node\nleft,10\nleft,40\nright;20;30\n")
    path = matrix_file(tmp_path / "K.npz", K)
    assembly = read_matrices(
        path,
        path,
        nodes=tmp_path / "nodes.npz",
        dofs=tmp_path / "dofs.npz",
        faces=tmp_path / "faces.npz",
        node_sets=tmp_path / "sets.csv",
        name="plate",
    )
    assert assembly.name == "plate"
    assert assembly.face_sets["top"].tolist() == [[0, 1, 2, 3]]
    assert assembly.mesh.node_sets["left"].tolist() == [0, 3]
    assert assembly.mesh.node_sets["right"].tolist() == [1, 2]
    (tmp_path / "faces.csv").write_text("a,10,20,30\na,10,30,40\nb,10,20,30,40\n")
    assembly = read_matrices(path, path, **tables(tmp_path), faces=tmp_path / "faces.csv")
    assert {name: faces.tolist() for name, faces in assembly.face_sets.items()} == {
        "a": [[0, 1, 2], [0, 2, 3]],
        "b": [[0, 1, 2, 3]],
    }


def test_defaults_and_parts_passed_through() -> None:
    held = Support(id=1, nodes=np.array([0]), components=(0, 1, 2))
    assembly = matrices_assembly(M, sp.csr_array(K), nodes=NODES, supports=[held])
    assert assembly.supports == (held,)
    assert assembly.mesh.node_ids.tolist() == [1, 2, 3, 4]
    assert assembly.matrices is not None
    assert assembly.matrices.nodes.tolist() == np.repeat(range(4), 3).tolist()
    with pytest.raises(ModelError, match="neither 3 nor 6 rows a node; give the dof table"):
        matrices_assembly(M[:5, :5], K[:5, :5], nodes=NODES)


def test_rounding_is_averaged_away() -> None:
    lopsided = K.copy()
    lopsided[2, 5] += 1e-10 * abs(K).max()
    block = matrices_assembly(M, lopsided, nodes=NODES).matrices
    assert block is not None
    assert abs(block.K - block.K.T).max() == 0.0


def changed(matrix: np.ndarray, row: int, column: int, value: float) -> np.ndarray:
    result = matrix.copy()
    result[row, column] = value
    return result


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"K": changed(K, 4, 7, np.nan)},
            r"matrix K: entry \(5, 8\) is nan \(row 5, node 20 component 2\)",
        ),
        ({"M": changed(M, 1, 1, np.inf)}, r"matrix M: entry \(2, 2\) is inf"),
        ({"K": K[:, :11]}, r"matrix K has shape \(12, 11\); it must be square"),
        ({"M": M[:9, :9]}, "matrix M has 9 rows but the dof table 12"),
        ({"C": M[:9, :9]}, "matrix C has 9 rows but the dof table 12"),
        (
            {"K": changed(K, 4, 7, K[4, 7] + 5)},
            r"matrix K is not symmetric: entries \(5, 8\) .* differ by 5 "
            r"\(row 5, node 20 component 2; row 8, node 30 component 2\).*gyroscopics",
        ),
        ({"K": np.triu(K)}, "only one triangle is stored"),
        ({"M": changed(M, 3, 3, -2.0)}, "diagonal is -2 at row 4, node 20 component 1"),
        ({"M": 0 * M}, "rᵀMr = 0"),
        ({"dofs": changed(DOFS, 2, 0, 99)}, "row 3 names node 99"),
        ({"dofs": changed(DOFS, 2, 1, 7)}, "row 3 has component 7"),
        ({"dofs": changed(DOFS, 2, 1, 1)}, "node 10 component 1 occurs in rows 1 and 3"),
        ({"dofs": DOFS[:, :1]}, r"dof table: shape \(12, 1\)"),
        ({"node_ids": [10, 20, 20, 40]}, "node 20 occurs twice"),
        ({"node_ids": [10, 20, 30]}, "3 node ids but coordinates"),
        ({"nodes": changed(NODES, 1, 1, np.inf)}, "node 20 is not finite"),
        ({"K": K + 0j}, "matrix K is of type complex128"),
        ({"faces": {"top": [[10, 20, 30, 40, 50]]}}, "face set 'top': shape"),
        ({"faces": {"top": [[10, 20, 99]]}}, "no node with id 99"),
    ],
)
def test_mistakes(arguments: dict[str, Any], message: str) -> None:
    usual = {"M": M, "K": K, "nodes": NODES, "node_ids": IDS, "dofs": DOFS}
    with pytest.raises(ModelError, match=message):
        matrices_assembly(**{**usual, **arguments})


def hdf5(path: Path) -> None:
    """Make a MATLAB 7.3 file: HDF5 behind a header of 512 bytes."""
    with h5py.File(path, "w", userblock_size=512) as file:
        file["K"] = K
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM")


@pytest.mark.parametrize(
    ("name", "make", "message"),
    [
        ("K.npz", None, "matrix K: file .* does not exist"),
        ("K.bin", lambda path: path.write_bytes(b""), r"ends in '\.bin'; readable are \.npz"),
        ("K.npz", lambda path: path.write_bytes(b"garbage"), "cannot be read"),
        ("K.mtx", lambda path: path.write_text("%%MatrixMarket x\n"), "cannot be read"),
        ("K.mat", lambda path: path.write_bytes(b"MATLAB 5.0 MAT-file" + bytes(200)), "matrix K"),
        ("K.mat", hdf5, "MATLAB 7.3 file; save it"),
        ("K.npz", lambda path: np.savez(path, a=K, b=M), "holds a, b; name one of them K"),
    ],
)
def test_bad_matrix_files(
    tmp_path: Path, name: str, make: Callable[[Path], Any] | None, message: str
) -> None:
    if make:
        make(tmp_path / name)
    good = matrix_file(tmp_path / "M.npz", M)
    with pytest.raises(FayingError, match=message):
        read_matrices(M=good, K=tmp_path / name, **tables(tmp_path))


@pytest.mark.parametrize(
    ("table", "text", "message"),
    [
        ("nodes", "1,0,0,0\n2,0,0\n", r"(?s)nodes\.csv: .*line 2: found 3 cells, expected 4"),
        ("nodes", "1,0,0,0\n2,0,x,0\n", r"line 2: found 'x' in column 'y'"),
        ("nodes", "1.5,0,0,0\n", "node id 1.5 in .* is not a whole number"),
        ("nodes", "id,x,y,z\n", "has no rows"),
        ("dofs", "10 1\n10 one\n", r"line 2: found 'one' in column 'component'"),
        ("dofs", "10 nan\n", "line 1: found 'nan' in column 'component'"),
    ],
)
def test_bad_tables(tmp_path: Path, table: str, text: str, message: str) -> None:
    files = tables(tmp_path)
    files[table].write_text(text)
    good = matrix_file(tmp_path / "M.npz", M)
    with pytest.raises(FormatError, match=message):
        read_matrices(M=good, K=good, **files)
    with pytest.raises(FormatError, match="does not exist"):
        read_matrices(M=good, K=good, **{**files, table: tmp_path / "none.csv"})


def test_faces_of_mixed_kinds_in_one_set(tmp_path: Path) -> None:
    (tmp_path / "faces.csv").write_text("a,10,20,30\na,10,20,30,40\n")
    good = matrix_file(tmp_path / "M.npz", M)
    read = read_matrices(good, good, **tables(tmp_path), faces=tmp_path / "faces.csv")
    assert read.face_sets["a"].tolist() == [[0, 1, 2, -1], [0, 1, 2, 3]]
    for wrong in ([[10, -1, 20, 30]], [[10, 20, -1, -1]], [[10, 20, 30, -1, 40]]):
        with pytest.raises(ModelError, match="-1 only at the ends of rows"):
            matrices_assembly(M, K, nodes=NODES, node_ids=IDS, dofs=DOFS, faces={"a": wrong})
    (tmp_path / "faces.csv").write_text("a,10,20,30\na,10,x,30\n")
    with pytest.raises(FormatError, match=r"faces\.csv:2: face set 'a'"):
        read_matrices(good, good, **tables(tmp_path), faces=tmp_path / "faces.csv")
