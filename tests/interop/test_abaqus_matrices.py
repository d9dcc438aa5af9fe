"""Matrices that CalculiX wrote, and matrices in the forms Abaqus writes."""

import shutil
import subprocess

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.exceptions import FormatError, ModelError
from faying.io.abaqus import read_joint
from faying.io.matrices import read_matrices
from faying.io.matrix_tables import read_matrix

SPEC = fy.InterfaceSpec(name="joint", minus="SLAVE", plus="MASTER", penalty=1e5)


@pytest.fixture
def folder(data):
    return data / "interop" / "calculix_matrices"


def own_model(folder):
    return fy.build_model(read_joint(folder / "two_bricks.inp").assembly, interfaces=[SPEC])


def check_equal(ours, theirs):
    np.testing.assert_array_equal(ours.dofs.free, theirs.dofs.free)
    for name in ("K", "M"):
        expected = getattr(ours, name)
        # Fourteen digits are written; the sums over points differ in order.
        difference = abs(getattr(theirs, name) - expected).max()
        assert difference < 1e-12 * abs(expected).max()


def test_stored_matrices_are_those_of_the_same_deck(folder):
    assembly = read_matrices(
        K=folder / "two_bricks.sti", M=folder / "two_bricks.mas", nodes=folder / "two_bricks.inp"
    )
    assert set(assembly.face_sets) == {"SLAVE", "MASTER"}
    assert set(assembly.mesh.node_sets) == {"NALL", "TOP"}
    check_equal(own_model(folder), fy.build_model(assembly, interfaces=[SPEC]))


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
def test_calculix_writes_them_still(folder, tmp_path):
    shutil.copy(folder / "two_bricks.inp", tmp_path)
    subprocess.run(["ccx", "two_bricks"], cwd=tmp_path, check=True, capture_output=True)
    job = tmp_path / "two_bricks"
    assembly = read_matrices(
        K=job.with_suffix(".sti"), M=job.with_suffix(".mas"), nodes=job.with_suffix(".inp")
    )
    check_equal(own_model(folder), fy.build_model(assembly, interfaces=[SPEC]))


def abaqus_text(matrix, dofs, *, triangle=True, separator=", "):
    """FORMAT=MATRIX INPUT: node, component, node, component, value of the lower triangle."""
    part = sp.coo_array(sp.tril(matrix) if triangle else matrix)
    rows = zip(part.row, part.col, part.data, strict=True)
    lines = [
        separator.join(map(str, [*dofs[i], *dofs[j], f"{value:.16E}"])) for i, j, value in rows
    ]
    return "** written by a test in the form of *MATRIX OUTPUT\n" + "\n".join(lines) + "\n"


@pytest.mark.parametrize("triangle", [True, False])
@pytest.mark.parametrize("separator", [", ", " ", ","])
def test_matrix_input_format(folder, tmp_path, triangle, separator):
    ours = own_model(folder)
    free = ours.dofs.free
    ids = ours.assembly.mesh.node_ids
    dofs = np.column_stack([ids[free // 6], free % 6 + 1])
    # Rows in any order: the mass starts from the other end.
    back = np.arange(len(dofs))[::-1]
    text = abaqus_text(ours.K, dofs, triangle=triangle, separator=separator)
    # A held degree of freedom is written with 1e36 on the diagonal.
    (tmp_path / "K.mtx").write_text(text + separator.join(["1", "1", "1", "1", "1.0E+36"]) + "\n")
    mass = abaqus_text(ours.M[back][:, back], dofs[back], triangle=triangle, separator=separator)
    held = separator.join(["1", "1", "1", "1", "1.5E-9"]) + "\n"
    (tmp_path / "M.mtx").write_text(mass + held)
    assembly = read_matrices(
        K=tmp_path / "K.mtx", M=tmp_path / "M.mtx", nodes=folder / "two_bricks.inp"
    )
    check_equal(ours, fy.build_model(assembly, interfaces=[SPEC]))


def test_coordinate_format_takes_its_labels_from_a_table(folder, tmp_path):
    ours = own_model(folder)
    free, ids = ours.dofs.free, ours.assembly.mesh.node_ids
    table = "\n".join(f"{ids[f // 6]},{f % 6 + 1}" for f in free.tolist())
    (tmp_path / "dofs.csv").write_text(table)
    for name in ("K", "M"):
        part = sp.coo_array(getattr(ours, name))
        rows = zip(part.row + 1, part.col + 1, part.data, strict=True)
        (tmp_path / f"{name}.mtx").write_text("\n".join(f"{i} {j} {v:.16e}" for i, j, v in rows))
    assembly = read_matrices(
        K=tmp_path / "K.mtx",
        M=tmp_path / "M.mtx",
        nodes=folder / "two_bricks.inp",
        dofs=tmp_path / "dofs.csv",
    )
    check_equal(ours, fy.build_model(assembly, interfaces=[SPEC]))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1,1,1,1,2.0\n1,2,1,1\n", r"K\.mtx:2: matrix K: found '1,2,1,1', expected 5 numbers"),
        ("1,1,1,1,2.0\n1,2,1,2,x\n", r"K\.mtx:2: .* found '1,2,1,2,x'"),
        ("1,1,1,1,1.E999\n", r"K\.mtx:1: "),
        ("1,1,1,1,2.\n1,1,1,1,3.\n", r"gives entry \(1, 1\) twice"),
        ("1,7,1,7,2.\n", r"node 1 component 7"),
        ("1,1.5,1,1,2.\n", r"1\.5 is no row, node or component"),
        ("*MATRIX INPUT\n1,1,1,1,2.\n", r"K\.mtx:1: .* found '\*MATRIX INPUT'"),
        ("** nothing\n", r"holds no numbers"),
        ("0 1 2.0\n", r"out of range"),
        ("1 1 2.0\n1 900000000 2.0\n", r"out of range"),
    ],
)
def test_damaged_matrices_are_refused_with_their_place(tmp_path, text, message):
    path = tmp_path / "K.mtx"
    path.write_text(text)
    with pytest.raises(FormatError, match=message):
        read_matrix(path, "K")


@pytest.mark.parametrize(
    ("text", "message"), [("2.1\n3\n", r"K\.dof:2: found '3'"), ("2.1\n", r"names 1")]
)
def test_damaged_labels_are_refused(folder, tmp_path, text, message):
    shutil.copy(folder / "two_bricks.sti", tmp_path / "K.sti")
    (tmp_path / "K.dof").write_text(text)
    with pytest.raises(FormatError, match=message):
        read_matrix(tmp_path / "K.sti", "K")


def test_matrices_of_different_runs_are_refused(folder, tmp_path):
    for suffix in (".sti", ".mas", ".dof"):
        shutil.copy(folder / f"two_bricks{suffix}", tmp_path / f"job{suffix}")
    lines = (tmp_path / "job.dof").read_text().splitlines()
    shutil.copy(tmp_path / "job.mas", tmp_path / "other.mas")
    (tmp_path / "other.dof").write_text("\n".join(["1.1", *lines[1:]]))
    with pytest.raises(ModelError, match="matrix M has a row for node 1 component 1"):
        read_matrices(
            K=tmp_path / "job.sti", M=tmp_path / "other.mas", nodes=folder / "two_bricks.inp"
        )
