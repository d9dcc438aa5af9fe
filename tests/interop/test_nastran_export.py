"""The superelement for Nastran: run by mystran, read by pyYeti, and true to the joint."""

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg as la
from programs import mystran, or_skip
from witness import pyyeti_nastran

import faying as fy
from faying.exceptions import FormatError
from faying.export.formats import export
from faying.export.linearized import linearize
from faying.export.nastran import Rows, assembly_cards, punch_cards, superelement_rows
from faying.io.matrix_tables import read_extrn
from faying.io.op4 import read_op4_matrices

nastran = pyyeti_nastran()

TIP_MASS = 1e-3


@pytest.fixture(scope="module")
def given(joint: fy.Model) -> fy.ReducedModel:
    return fy.reduce(joint, fy.craig_bampton(joint, normal_modes=10), compliance=True)


@pytest.fixture(scope="module")
def folder(given: fy.ReducedModel, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("superelement")
    export(given, "nastran", out=folder / "joint.op4")
    export(given, "nastran", out=folder / "cards.dmig")
    return folder


def matrices(given: fy.ReducedModel) -> dict[str, np.ndarray]:
    linear, order = linearize(given), superelement_rows(given).order
    at = np.ix_(order, order)
    return {"kaa": linear.K[at], "maa": linear.M[at], "baa": linear.C[at]}


DECK = """\
ID JOINT,FAYING
IN4 1 = joint.op4
SOL 103
CEND
METHOD = 1
BEGIN BULK
EIGRL   1                       8
{grid}
{points}
CUSERIN 1       1       1       {count:<8}0
        {node:<8}123456
        {first:<8}THRU    {last:<8}
PUSERIN 1       1       KAA     MAA
{mass}ENDDATA
"""


@pytest.mark.parametrize("mass", [0.0, TIP_MASS])
def test_frequencies_of_the_superelement_in_mystran(
    given: fy.ReducedModel, folder: Path, tmp_path: Path, mass: float
) -> None:
    """Mystran takes superelements by CUSERIN; an added mass at the tip shows what is attached."""
    program, rows = or_skip(mystran), superelement_rows(given)
    (node,) = rows.grids
    # mystran writes file names in capitals
    shutil.copy(folder / "joint.op4", tmp_path / "JOINT.OP4")
    cards = (folder / "joint.asm").read_text().splitlines()
    grid = cards.index(next(card for card in cards if card.startswith("GRID")))
    (tmp_path / "run.bdf").write_text(
        DECK.format(
            grid="\n".join(cards[grid : grid + 2]),
            points=next(card for card in cards if card.startswith("SPOINT")),
            count=len(rows.points),
            node=node,
            first=rows.points[0],
            last=rows.points[-1],
            mass=f"CONM2   1       {node:<16}{mass:<8}\n" if mass else "",
        )
    )
    subprocess.run(
        [program, "run.bdf"], cwd=tmp_path, capture_output=True, check=False, timeout=600
    )
    printed = (tmp_path / "run.F06").read_text(errors="replace")
    table = printed[printed.index("R E A L   E I G E N V A L U E S") :].splitlines()
    found = [float(line.split()[4]) for line in table if line[:9].strip().isdigit()][:8]
    wanted = matrices(given)
    M = wanted["maa"].copy()
    M[[0, 1, 2], [0, 1, 2]] += mass
    squares = la.eigh(wanted["kaa"], M, eigvals_only=True)[:8]
    # Seven digits are printed.
    np.testing.assert_allclose(found, np.sqrt(squares) / (2 * np.pi), rtol=6e-7)


def test_matrices_in_pyyeti(given: fy.ReducedModel, folder: Path) -> None:
    names, found, forms, _ = nastran.op4.load(str(folder / "joint.op4"), into="list")
    for name, wanted in matrices(given).items():
        matrix = found[names.index(name)]
        # The mean with the transpose may round.
        np.testing.assert_allclose(matrix, wanted, rtol=0, atol=1e-15 * np.abs(wanted).max())
        assert forms[names.index(name)] == 6


def test_cards_are_those_pyyeti_writes(
    given: fy.ReducedModel, folder: Path, tmp_path: Path
) -> None:
    """Superelement cards of an independent program, for the same superelement."""
    uset, _, bset = nastran.bulk.asm2uset(str(folder / "joint.asm"))
    rows, names = superelement_rows(given), matrices(given)
    n_boundary = len(rows.dofs) - len(rows.points)
    assert bset.sum() == n_boundary
    labels = [tuple(dof) for dof in rows.dofs.tolist()]
    assert [tuple(map(int, one)) for one in uset.index] == labels
    points = rows.points
    table = uset.iloc[:n_boundary]
    nastran.bulk.wtextseout(
        str(tmp_path / "theirs"),
        se=100,
        bset=np.arange(n_boundary),
        uset=table,
        spoint1=int(points[0]),
        **names,
    )
    held = {"joint.asm": ("SEBULK", "SECONCT", "SPOINT"), "joint.pch": ("EXTRN", "QSET1", "SPOINT")}
    for name, cards in held.items():
        ours, theirs = folder / name, tmp_path / name.replace("joint", "theirs")
        for card in cards:
            found, wanted = (
                nastran.bulk.rdcards(str(file), card, return_var="list") for file in (ours, theirs)
            )
            assert [trimmed(one) for one in found] == [trimmed(one) for one in wanted], card
        coordinates = nastran.bulk.rdgrids(str(ours))[:, 2:5]
        np.testing.assert_allclose(
            coordinates, given.mesh.nodes[given.mesh.node_ids == labels[0][0]]
        )
    ours, theirs = (
        nastran.op4.dir(str(f), verbose=False)[0]
        for f in (folder / "joint.op4", tmp_path / "theirs.op4")
    )
    assert ours == theirs


def trimmed(card: list[object]) -> list[object]:
    while card and card[-1] in ("", None):
        card = card[:-1]
    return card


def test_dmig_in_pyyeti(given: fy.ReducedModel, folder: Path) -> None:
    found = nastran.bulk.rddmig(str(folder / "cards.dmig"))
    dofs = [tuple(dof) for dof in superelement_rows(given).dofs.tolist()]
    for name, wanted in matrices(given).items():
        matrix = found[name + "x"]
        assert matrix.index.to_list() == dofs
        # Ten digits at least.
        np.testing.assert_allclose(matrix.to_numpy(), wanted, rtol=6e-10, atol=1e-15 * wanted.max())


def test_contact_forces_of_a_small_motion(given: fy.ReducedModel, folder: Path) -> None:
    """The recovery file gives the contact forces and gaps of the full nonlinear joint."""
    held = {
        name: matrix.toarray()
        for name, matrix in read_op4_matrices(folder / "joint_recovery.op4").items()
    }
    stiffness = read_op4_matrices(folder / "joint.op4")["KAA"].toarray()
    force = np.zeros(len(stiffness))
    force[2] = -1e-3  # small enough that no point opens or closes
    motion = np.linalg.solve(stiffness, force)[:, None]
    wanted = fy.solve_static(given, fy.Load({"tip.Fz": -1e-3}))
    change = np.abs(wanted.contact_forces - fy.solve_static(given).contact_forces).max()
    forces = (held["LAM0"] + held["LAMROW"] @ motion)[:, 0]
    # Differences of numbers 1e5 times larger.
    np.testing.assert_allclose(forces, wanted.contact_forces, rtol=0, atol=1e-5 * change)
    gaps = (held["GAP0"] + held["GAPROW"] @ motion)[:, 0]
    opened = np.abs(wanted.gap - fy.solve_static(given).gap).max()
    np.testing.assert_allclose(gaps, wanted.gap, rtol=0, atol=1e-5 * opened)
    bolt = held["BOLTK"] * (held["BOLTE"] @ (held["QREF"] + motion)) + held["BOLTN0"]
    np.testing.assert_allclose(bolt[0, 0], wanted.bolt_force("bolt"), rtol=1e-9)


def test_recovery_as_the_text_says(given: fy.ReducedModel, folder: Path) -> None:
    """Static pressures of the full model from the matrices of the file alone."""
    held = {
        name: matrix.toarray()
        for name, matrix in read_op4_matrices(folder / "joint_recovery.op4").items()
    }
    inputs = np.array([0.0, 0.0, -500.0, 0.0, 0.0, 0.0, -held["BOLTN0"][0, 0]])
    free = held["RCOMPF"] @ inputs
    n_relative = held["RCOMPC"].shape[1]
    S = held["NINT"] @ held["RCOMPC"][:n_relative] @ held["NINT"].T
    H = S + np.diag(held["DLAW"][:, 0])
    free_gap = held["GINIT"][:, 0] + held["NINT"] @ free[:n_relative]
    forces = fy.contact_problem(H, free_gap).solve().forces
    wanted = fy.solve_static(given, fy.Load({"tip.Fz": -500.0}))
    # The model keeps the residual compliance: its static pressures are those of the full model.
    np.testing.assert_allclose(
        forces / held["WEIGHT"][:, 0], wanted.pressure, rtol=0, atol=1e-8 * wanted.max_pressure
    )


def test_text_names_every_matrix_and_row(given: fy.ReducedModel, folder: Path) -> None:
    text = (folder / "joint_readme.txt").read_text()
    for name in read_op4_matrices(folder / "joint_recovery.op4"):
        assert name in text
    for point, component in superelement_rows(given).dofs.tolist():
        assert f"{point:9} {component:2}" in text


def test_other_suffix_is_refused(given: fy.ReducedModel, tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"ends in '.txt', expected .op4 or .dmig"):
        export(given, "nastran", out=tmp_path / "joint.txt")


def test_several_grids_with_some_components(tmp_path: Path) -> None:
    places = {7: (1.0, 2.0, 3.0), 12: (4.5, -1e-3, 1e6)}
    rows = [(7, 1), (7, 2), (7, 3), *((12, c) for c in range(1, 7))]
    for points in (np.array([], dtype=int), np.array([20]), np.arange(20, 24)):
        dofs = np.array([*rows, *((point, 0) for point in points)])
        superelement = Rows(dofs=dofs, order=np.arange(len(dofs)))
        (tmp_path / "joint.asm").write_text(assembly_cards("two", superelement, places))
        (tmp_path / "joint.pch").write_text(punch_cards("two", superelement, places))
        uset = nastran.bulk.asm2uset(str(tmp_path / "joint.asm"))[0]
        assert [tuple(map(int, dof)) for dof in uset.index] == [*rows, *((p, 0) for p in points)]
        assert read_extrn(tmp_path / "joint.pch").tolist() == [
            list(row) for row in (*rows, *((p, 1) for p in points.tolist()))
        ]


def test_hard_contact(joint: fy.Model, tmp_path: Path) -> None:
    hard = joint.with_penalty(np.inf)
    rom = fy.reduce(hard, fy.craig_bampton(hard, normal_modes=10), compliance=True)
    export(rom, "nastran", out=tmp_path / "joint.op4")
    held = read_op4_matrices(tmp_path / "joint.op4")
    found = la.eigh(held["KAA"].toarray(), held["MAA"].toarray(), eigvals_only=True)
    exact = fy.preloaded_frequencies(hard, 2)
    # Ten normal modes with the residual compliance; the same linearization is exact in statics.
    np.testing.assert_allclose(np.sqrt(found[:2]) / (2 * np.pi), exact, rtol=1e-3)
    assert not read_op4_matrices(tmp_path / "joint_recovery.op4")["DLAW"].toarray().any()
