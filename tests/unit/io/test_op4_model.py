"""Matrices and labels of Nastran become the same model as matrices in memory."""

from pathlib import Path

import numpy as np
import pytest

from faying.exceptions import FormatError
from faying.io.dmig import dmig_text
from faying.io.matrices import read_matrices
from faying.io.matrix_tables import read_dof_table
from faying.io.op4 import write_op4
from lap_joints import tiny_lap


@pytest.fixture(scope="module")
def origin():
    """A joint of few nodes, and the labels of its rows in another order than that of ids."""
    model = tiny_lap(penalty=1e5)
    mesh, free = model.assembly.mesh, model.dofs.free
    labels = np.column_stack([mesh.node_ids[free // 6], free % 6 + 1])
    return model, labels


def extrn(labels) -> str:
    pairs = [f"{grid:8}{component:8}" for grid, component in labels]
    rows = ["".join(pairs[i : i + 4]) for i in range(0, len(pairs), 4)]
    return "BEGIN SUPER     100\n$\nEXTRN   " + "\n        ".join(rows) + "\n"


@pytest.mark.parametrize("kind", ["op4", "dmig"])
def test_matrices_and_labels(origin, tmp_path: Path, kind: str) -> None:
    model, labels = origin
    order = np.random.default_rng(2).permutation(len(labels))
    order = order if kind == "op4" else np.arange(len(labels))
    K, M = (matrix.toarray()[np.ix_(order, order)] for matrix in (model.K, model.M))
    mesh = model.assembly.mesh
    table = np.column_stack([mesh.node_ids, mesh.nodes])
    np.savetxt(tmp_path / "nodes.csv", table, delimiter=",", fmt=["%d", *["%.17g"] * 3])
    files = {"K": tmp_path / f"K.{kind}", "M": tmp_path / f"M.{kind}"}
    options = {}
    if kind == "op4":
        (tmp_path / "labels.pch").write_text(extrn(labels[order]))
        options["dofs"] = tmp_path / "labels.pch"
        for name, matrix in (("K", K), ("M", M)):
            write_op4(files[name], {f"{name}AA": matrix})
    else:
        for name, matrix in (("K", K), ("M", M)):
            files[name].write_text(dmig_text(f"{name}AA", matrix, labels))
    found = read_matrices(**files, nodes=tmp_path / "nodes.csv", **options).matrices
    place = 6 * found.nodes + found.components
    back = np.argsort(place)
    assert place[back].tolist() == sorted(model.dofs.free.tolist())
    # OP4 keeps the bits; symmetric parts are averaged. DMIG keeps ten digits.
    digits = 1e-15 if kind == "op4" else 6e-10
    ours = np.argsort(model.dofs.free)
    for matrix, wanted in ((found.K, model.K), (found.M, model.M)):
        wanted = wanted.toarray()[np.ix_(ours, ours)]
        np.testing.assert_allclose(
            matrix.toarray()[np.ix_(back, back)], wanted, rtol=digits, atol=1e-15 * wanted.max()
        )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("$ nothing\n", "has 0 EXTRN cards"),
        ("EXTRN          3  123456       3       1\n", "occurs twice"),
        ("EXTRN          3     178\n", "'3 178' is not a grid"),
        ("EXTRN          3     1X3\n", "'3 1X3' is not a grid"),
        ("EXTRN          3      11\n", "'3 11' is not a grid"),
    ],
)
def test_damaged_labels(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "labels.pch"
    path.write_text(text)
    with pytest.raises(FormatError, match=message):
        read_dof_table(path)


def test_grids_and_scalar_points(tmp_path: Path) -> None:
    path = tmp_path / "labels.pch"
    path.write_text("EXTRN          3     246       5       0       7        \n")
    assert read_dof_table(path).tolist() == [[3, 2], [3, 4], [3, 6], [5, 1], [7, 1]]
