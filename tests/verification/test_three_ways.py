"""The same joint from the generator, from a Nastran deck and from matrices: the same pressures."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp

import faying as fy
from faying import cli
from faying.io.nastran import write_deck
from faying.joint.lap_joint import lap_joint_assembly
from faying.joint.model import Model
from faying.study.results.store import read_results
from faying.study.results.values import Results

PENALTY = 420_000.0  # 10 E/h of 5 mm bricks, which 'auto' finds where there are elements

COMMON = f"""
[[interface]]
name = "joint"
minus = "lower"
plus = "upper"
penalty = {PENALTY}

[[load_case]]
name = "LC2"
kind = "static"
forces = [
    {{ boundary = "tip", component = "Fz", value = -500.0 }},
    {{ boundary = "tip", component = "Mx", value = 20e3 }},
]

[sticking]
stiffness = 1e6

[reduction]
normal_modes = 5
methods = ["compliance"]

[output]
report = false
"""


@pytest.fixture(scope="module")
def model() -> Model:
    return fy.lap_joint(element_size=5.0)


@pytest.fixture(scope="module")
def generated(tmp_path_factory) -> Results:
    head = """
    [model]
    source = "lap-joint"
    lap_joint = { element_size = 5.0 }

    [[bolt]]
    name = "bolt"
    preload = 10e3
    """
    return run(tmp_path_factory.mktemp("generated"), head)


def run(folder: Path, head: str) -> Results:
    """Run a study through the command line."""
    study = folder / "study.toml"
    study.write_text(head + COMMON)
    out = folder / "results"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["faying", "run", str(study), "--out", str(out)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
    assert not ended.value.code
    return read_results(out / "results.h5")


def assert_same(found: Results, wanted: Results, tolerance: float) -> None:
    """Compare pressures with their largest, displacements of the tip with theirs."""
    for case in wanted.cases:
        ours, theirs = found.cases[case], wanted.cases[case]
        responses = [(ours.reference, theirs.reference)]
        responses += [
            (ours.methods[m][0].response, theirs.methods[m][0].response) for m in ours.methods
        ]
        for a, b in responses:
            assert np.abs(a.pressure - b.pressure).max() < tolerance * b.pressure.max()
            scale = np.abs(b.displacements["tip"]).max()
            assert np.abs(a.displacements["tip"] - b.displacements["tip"]).max() < tolerance * scale
            assert a.bolt_forces["bolt"] == pytest.approx(b.bolt_forces["bolt"], rel=tolerance)
    for name, interface in wanted.interfaces.items():
        scale = interface.preload_pressure.max()
        difference = found.interfaces[name].preload_pressure - interface.preload_pressure
        assert np.abs(difference).max() < tolerance * scale


@pytest.mark.long
def test_a_deck_gives_the_pressures_of_the_generator(model, generated, tmp_path):
    write_deck(model.assembly, tmp_path / "joint.bdf")
    head = f"""
    [model]
    source = "nastran"
    file = "joint.bdf"

    [model.sets]
    lower = 1
    upper = 2

    [[bolt]]
    name = "bolt"
    elements = [{model.assembly.beams[0].id}]
    preload = 10e3

    [[boundary]]
    name = "tip"
    node = {model.boundaries["tip"].nodes[0]}
    """
    # A deck's numbers have ten digits or more; the stiffness loses one or two in the solution.
    assert_same(run(tmp_path, head), generated, 1e-8)


def export(model: Model, folder: Path, kind: str) -> str:
    """Write the free degrees of freedom as another program would, and return their study."""
    mesh = model.assembly.mesh
    for name in ("M", "K"):
        write_matrix(folder / f"{name}.{kind}", getattr(model, name))
    free = model.dofs.free
    np.savez(folder / "dofs.npz", np.column_stack([mesh.node_ids[free // 6], free % 6 + 1]))
    np.savez(folder / "nodes.npz", np.column_stack([mesh.node_ids, mesh.nodes]))
    (faces,) = model.interfaces["joint"].faces
    # The plus side is listed as the minus side sees it: turn it round.
    np.savez(
        folder / "faces.npz",
        lower=mesh.node_ids[faces.minus],
        upper=mesh.node_ids[faces.plus[:, ::-1]],
    )
    bolt = model.assembly.beams[0]
    nut, head = mesh.node_ids[list(bolt.nodes)].tolist()
    return f"""
    [model]
    source = "matrices"

    [model.files]
    M = "M.{kind}"
    K = "K.{kind}"
    nodes = "nodes.npz"
    dofs = "dofs.npz"
    faces = "faces.npz"

    [[bolt]]
    name = "bolt"
    nodes = [{head}, {nut}]
    stiffness = {model.bolts["bolt"].stiffness!r}
    preload = 10e3

    [[boundary]]
    name = "tip"
    node = {model.boundaries["tip"].nodes[0]}
    """


def write_matrix(path: Path, matrix: sp.sparray) -> None:
    if path.suffix == ".npz":
        sp.save_npz(path, matrix)
    elif path.suffix == ".mtx":
        # 17 digits are exact
        scipy.io.mmwrite(path, matrix.tocoo(), symmetry="symmetric", precision=17)
    else:
        scipy.io.savemat(path, {path.stem: matrix.tocsc()})


@pytest.mark.long
@pytest.mark.parametrize("kind", ["npz", "mtx", "mat"])
def test_matrices_give_the_pressures_of_the_generator(model, generated, tmp_path, kind):
    found = run(tmp_path, export(model, tmp_path, kind))
    # The matrices are the same to the last bit; another order of additions costs a few digits.
    assert_same(found, generated, 1e-9)
    assert found.dofs == generated.dofs
    assert found.interfaces["joint"].faces[0].minus.shape == (28, 4)


@pytest.mark.long
def test_unconstrained_matrices_and_a_list_of_what_is_held(model, generated, tmp_path):
    joint = lap_joint_assembly(element_size=5.0)
    loose = fy.build_model(
        replace(joint.assembly, supports=()),
        interfaces=joint.interfaces,
        bolts=joint.bolts,
        boundaries=joint.boundaries,
    )
    head = export(loose, tmp_path, "npz")
    mesh = joint.assembly.mesh
    clamp = mesh.node_ids[mesh.node_sets["clamp"]]
    table = np.column_stack([np.repeat(clamp, 3), np.tile([1, 2, 3], len(clamp))])
    np.savetxt(tmp_path / "held.csv", table, fmt="%d", delimiter=",")
    found = run(tmp_path, head.replace('    K = "K', '    held = "held.csv"\n    K = "K'))
    # As above.
    assert_same(found, generated, 1e-9)
