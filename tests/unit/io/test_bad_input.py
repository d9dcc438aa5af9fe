"""Bad input: exit status 2, one message that names the culprit and a remedy, no traceback."""

import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.io.nastran import write_deck
from faying.model.assembly import Assembly, Beam
from faying.model.cells import CellBlock

MODEL = fy.lap_joint(element_size=5.0)
JOINT = MODEL.assembly
MESH = JOINT.mesh
BOLT, TIP = JOINT.beams[0].id, int(MODEL.boundaries["tip"].nodes[0])
FACES = MODEL.interfaces["joint"].faces[0]
UPPER = np.unique(MESH.blocks[0].nodes[MESH.blocks[0].properties == 2])

DECK_STUDY = f"""\
[model]
source = "nastran"
file = "joint.bdf"

[model.sets]
lower = 1
upper = 2

[[interface]]
name = "joint"
minus = "lower"
plus = "upper"
penalty = 4e5

[[bolt]]
name = "M6"
elements = [{BOLT}]
preload = 10e3

[[boundary]]
name = "tip"
node = {TIP}

[reduction]
normal_modes = 5
methods = ["compliance"]

[[load_case]]
name = "bend"
kind = "static"
forces = [{{ boundary = "tip", component = "Fz", value = -500.0 }}]

[output]
report = false
"""

MATRICES = """\
[model]
source = "matrices"

[model.files]
M = "M.npz"
K = "K.npz"
nodes = "nodes.npz"
dofs = "dofs.npz"
faces = "faces.npz"

"""
MATRIX_BOLT = f"nodes = [477, 476]\nstiffness = {MODEL.bolts['bolt'].stiffness!r}"
MATRIX_STUDY = MATRICES + DECK_STUDY[DECK_STUDY.index("[[interface]]") :].replace(
    f"elements = [{BOLT}]", MATRIX_BOLT
)


def node(*point: float) -> int:
    """Index of the node nearest to a point."""
    return int(np.linalg.norm(MESH.nodes - point, axis=1).argmin())


def moved(nodes: object, by: tuple[float, float, float]) -> Assembly:
    points = np.array(MESH.nodes)
    points[nodes] += by
    return replace(JOINT, mesh=replace(MESH, nodes=points))


@pytest.fixture(scope="module")
def deck(tmp_path_factory) -> str:
    return deck_of(JOINT, tmp_path_factory.mktemp("deck"))


def unheld() -> Assembly:
    """Return the joint without supports, and without mass that could balance its loads."""
    materials = {number: replace(one, density=0.0) for number, one in JOINT.materials.items()}
    beams = tuple(
        replace(beam, material=replace(beam.material, density=0.0)) for beam in JOINT.beams
    )
    return replace(JOINT, supports=(), materials=materials, beams=beams)


def deck_of(assembly: Assembly, folder: Path) -> str:
    write_deck(assembly, folder / "joint.bdf")
    return (folder / "joint.bdf").read_text()


@pytest.fixture
def refused(call, tmp_path) -> Callable[..., str]:
    """Return a function that runs a command on a study and returns its one message."""

    def check(study: str | Path, command: str = "check", *options: object) -> str:
        path = tmp_path / "study.toml" if isinstance(study, str) else study
        if isinstance(study, str):
            path.write_text(study)
        if command == "run" and not options:
            options = ("--out", tmp_path / "results")
        status, out, err = call(command, path, *options)
        assert status == 2, err
        # 'check' shows what it understood of a model that is not held before it refuses it.
        assert out == "" or (command == "check" and "unconstrained" in err)
        return one_message(err)

    return check


def one_message(err: str) -> str:
    # A line for each stage that was begun stands before the message.
    err = re.sub(r"^(?: +\d+:\d\d  [^\n]*\n)+", "", err)
    assert err.startswith("faying: "), err
    assert err.count("faying: ") == 1
    assert "Traceback" not in err
    assert err.endswith("\n")
    # One line, and one for each fault of a table; no empty ones of a progress bar.
    assert err.count("\n") == 1 + err.count("\n  - line ")
    return err.removeprefix("faying: ")


def assert_says(message: str, *parts: str) -> None:
    """Look for the culprit first, then for the remedy."""
    for part in parts:
        assert part in message, message


BOTH = pytest.mark.parametrize("command", ["check", "run"])


# ---- the study file


@BOTH
@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        (
            "joint.bdf",
            "jiont.bdf",
            ["line 3", "'jiont.bdf' does not exist", "relative to the study"],
        ),
        ('minus = "lower"', 'minus = "lowr"', ["'joint', minus side", "'lowr'", "mean 'lower'?"]),
        (f"node = {TIP}", 'set = "tipp"', ["boundary 'tip'", "no node set 'tipp'", "known are"]),
        (
            f"node = {TIP}",
            "node = 9999",
            ["boundary 'tip'", "no node with id 9999", "check the id"],
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_study(refused, deck, tmp_path, command, old, new, parts):
    (tmp_path / "joint.bdf").write_text(deck)
    assert old in DECK_STUDY
    assert_says(refused(DECK_STUDY.replace(old, new, 1), command), *parts)


@pytest.mark.long
@pytest.mark.parametrize("command", ["check", "run"])
def test_missing_study(tmp_path, command):
    """In a process of its own, as a user calls it."""
    arguments = [sys.executable, "-m", "faying", command, "nothing.toml"]
    found = subprocess.run(arguments, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert found.returncode == 2
    assert found.stdout == ""
    assert_says(one_message(found.stderr), "nothing.toml", "check the path")


@pytest.mark.long
def test_unconstrained_body_in_a_process_of_its_own(tmp_path):
    """Late enough that the progress bar has started."""
    deck_of(unheld(), tmp_path)
    (tmp_path / "study.toml").write_text(DECK_STUDY)
    arguments = [sys.executable, "-m", "faying", "run", "study.toml"]
    found = subprocess.run(arguments, capture_output=True, text=True, cwd=tmp_path, check=False)
    assert found.returncode == 2
    assert found.stdout == ""
    assert_says(one_message(found.stderr), "body 'upper'", "held by nothing", "support it")


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        (b"0,0\n1,1\n0.5,2\n", ["line 3", "0.5 does not come after 1", "must increase"]),
        (b"", ["push.csv is empty", "give a line of column names"]),
        (b"\xff\xfe\x00\x81", ["not UTF-8 text", "give a csv file in UTF-8"]),
    ],
)
@BOTH
def test_history(refused, deck, tmp_path, command, text, parts):
    (tmp_path / "joint.bdf").write_text(deck)
    (tmp_path / "push.csv").write_bytes(text)
    study = DECK_STUDY.replace('kind = "static"', 'kind = "history"\nstep = 1e-4')
    message = refused(study.replace("value = -500.0", 'file = "push.csv"'), command)
    assert_says(message, "[[load_case]] number 1, forces number 1", "push.csv", *parts)


# ---- the deck


@BOTH
@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("7.82-9", "-7.82-9", ["joint.bdf:8", "MAT1", "'1'", "must not be negative"]),
        (
            "CHEXA   1       1       1       16",
            "CHEXA   1       1       16      1 ",
            ["element 1 (hex8)", "negative volume", "correct the order of its nodes"],
        ),
        ("SPC1    1 ", "SPC1    2 ", ["SPC = 1", "sets are 2"]),
        (f"CBAR*   {BOLT}", "CBAR*   990", [f"bolt 'M6': element {BOLT} is no beam", "name the b"]),
    ],
    ids=["density", "negative volume", "no such SPC", "no such bolt"],
)
def test_deck(refused, deck, tmp_path, command, old, new, parts):
    assert old in deck
    (tmp_path / "joint.bdf").write_text(deck.replace(old, new, 1))
    assert_says(refused(DECK_STUDY, command), *parts)


def flat_element() -> Assembly:
    """The top of brick 1 lies in its bottom."""
    cell = MESH.blocks[0].nodes[0]
    points = np.array(MESH.nodes)
    points[cell[4:]] = points[cell[:4]]
    return replace(JOINT, mesh=replace(MESH, nodes=points))


def second_body() -> Assembly:
    """A brick that nothing touches."""
    corners = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    )
    first = len(MESH.nodes)
    brick = CellBlock(
        kind="hex8", nodes=[first + np.arange(8)], ids=np.array([9000]), properties=np.array([1])
    )
    mesh = replace(
        MESH,
        nodes=np.vstack([MESH.nodes, corners * 5.0 + 100.0]),
        node_ids=np.append(MESH.node_ids, 9001 + np.arange(8)),
        blocks=(*MESH.blocks, brick),
    )
    return replace(JOINT, mesh=mesh)


def with_beam_in_one_body() -> Assembly:
    ends = node(-35.0, 0.0, -10.0), node(-35.0, 0.0, 0.0)
    beam: Beam = replace(JOINT.beams[0], id=900, nodes=ends)
    return replace(JOINT, beams=(*JOINT.beams, beam))


LOOSE = "support it, tie it to a held body with a bolt"
OTHER_BOLT = '\n[[bolt]]\nname = "M8"\npreload = 1e3\n'
OWN_WASHERS = "diameter = 6.0\nwasher_radius = 4.0\n"


@BOTH
@pytest.mark.parametrize(
    ("assembly", "addition", "parts"),
    [
        (flat_element, "", ["element 1 (hex8)", "has no volume", "merge its nodes"]),
        (unheld, "", ["body 'upper'", "held by nothing", LOOSE]),
        (second_body, "", ["body (nodes 9001 to 9008) is held by nothing", LOOSE]),
        (
            lambda: moved(FACES.plus[5, 0], (1.0, 0.0, 0.0)),
            "",
            ["interface 'joint': non-matching faces", "miss each other by up to 1", "mesh both"],
        ),
        (
            lambda: moved(UPPER, (2.0, 0.0, 0.0)),
            "",
            ["interface 'joint': non-matching faces", "up to 2", "mesh both sides"],
        ),
        (
            lambda: moved(UPPER, (0.0, 0.0, 2.0)),
            "",
            ["interface 'joint' is empty", "2 apart", "move the parts together"],
        ),
        (
            with_beam_in_one_body,
            OTHER_BOLT + "elements = [900]\n",
            ["bolt 'M8' clamps nothing", "hold the same body", "separate of [model]"],
        ),
        (
            lambda: JOINT,
            OTHER_BOLT + "axis = [[-35.0, 0.0, -10.0], [-35.0, 0.0, 0.0]]\n" + OWN_WASHERS,
            ["bolt 'M8' clamps nothing", "hold the same body", "separate of [model]"],
        ),
        (
            lambda: JOINT,
            OTHER_BOLT + "axis = [[-35.0, 50.0, -10.0], [-35.0, 50.0, 0.0]]\n" + OWN_WASHERS,
            ["bolt 'M8'", "no node lies under the washer", "enlarge the washer"],
        ),
    ],
    ids=[
        "flat element",
        "no support",
        "second body",
        "one node off",
        "body shifted",
        "body lifted",
        "beam in one body",
        "bolt through one body",
        "bolt beside the body",
    ],
)
def test_model(refused, tmp_path, command, assembly, addition, parts):
    deck_of(assembly(), tmp_path)
    assert_says(refused(DECK_STUDY + addition, command), *parts)


@BOTH
@pytest.mark.parametrize(
    ("where", "component", "parts"),
    [
        ((-55.0, 0.0, 0.0), "Fz", ["boundary 'tip'", "node 8 is fixed", "node that can move"]),
        ((35.0, 0.0, 10.0), "Mx", ["boundary 'tip' takes no load 'Mx'", "it has Fx, Fy, Fz"]),
    ],
    ids=["support", "no rotation"],
)
def test_load_on_a_fixed_component(refused, deck, tmp_path, command, where, component, parts):
    (tmp_path / "joint.bdf").write_text(deck)
    held = int(MESH.node_ids[node(*where)])
    study = DECK_STUDY.replace(f"node = {TIP}", f"node = {held}").replace('"Fz"', f'"{component}"')
    assert_says(
        refused(study, command), *(part.replace("node 8 ", f"node {held} ") for part in parts)
    )


# ---- matrices


@pytest.fixture
def matrices(tmp_path) -> Path:
    """The joint's own matrices and tables as files."""
    export(MODEL, tmp_path)
    return tmp_path


def export(model: fy.Model, folder: Path) -> None:
    ids, free = model.assembly.mesh.node_ids, model.dofs.free
    sp.save_npz(folder / "M.npz", model.M)
    sp.save_npz(folder / "K.npz", model.K)
    np.savez(folder / "dofs.npz", np.column_stack([ids[free // 6], free % 6 + 1]))
    np.savez(folder / "nodes.npz", np.column_stack([ids, model.assembly.mesh.nodes]))
    faces = model.interfaces["joint"].faces[0]
    np.savez(folder / "faces.npz", lower=ids[faces.minus], upper=ids[faces.plus[:, ::-1]])


def test_matrices(refused, matrices):
    """What else is wrong with matrices: test_matrices_reader.py."""
    matrix = sp.load_npz(matrices / "K.npz").tolil()
    matrix[10, 10] = np.nan
    sp.save_npz(matrices / "K.npz", matrix.tocsr())
    message = refused(MATRIX_STUDY)
    assert_says(message, "matrix K: entry (11, 11) is nan", "node 19", "must be finite")


@BOTH
@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ('K = "K.npz"', 'K = "k.npz"', ["'K' in [model.files]", "'k.npz' does not exist"]),
        (
            "penalty = 4e5\n",
            "",
            ["interface 'joint'", "penalty = 'auto'", "give the penalty as a n"],
        ),
        ('plus = "upper"', 'plus = "uper"', ["'joint', plus side", "'uper'", "mean 'upper'?"]),
        (
            MATRIX_BOLT,
            "elements = [1]",
            ["[[bolt]] number 1", "no elements", "give nodes = [head,"],
        ),
        (MATRIX_BOLT, "nodes = [477, 476]", ["[[bolt]] number 1", "needs 'stiffness'", "add it"]),
        ("[477, 476]", "[477, 9999]", ["bolt 'M6'", "no node with id 9999", "check the id"]),
        ("[477, 476]", "[477, 477]", ["bolt 'M6'", "nodes are [477, 477]", "give two different"]),
        ("stiffness = ", "stiffness = 9", ["bolt 'M6'", "K does not contain", "check the nodes"]),
        (
            "[477, 476]\n",
            "[477, 476]\ndirection = [0, 0, -1]\n",
            ["bolt 'M6': direction", "does not point from the nut to the head", "turn it round"],
        ),
        (
            "[model.files]\n",
            '[model.files]\nheld = "faces.npz"\n',
            ["faces.npz", "expected one array of 2 columns: node, component"],
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_matrix_study(refused, matrices, command, old, new, parts):
    assert old in MATRIX_STUDY
    assert_says(refused(MATRIX_STUDY.replace(old, new, 1), command), *parts)


def test_no_npz_file(refused, matrices):
    (matrices / "K.npz").write_text("hello")
    assert_says(refused(MATRIX_STUDY), "matrix K", "K.npz", "not an .npz file", "write it again")


def test_unknown_node_in_a_face(refused, matrices):
    np.savez(matrices / "faces.npz", lower=[[1, 2, 3, 9999]], upper=[[1, 2, 3, 4]])
    assert_says(refused(MATRIX_STUDY), "face set 'lower'", "no node with id 9999", "check the id")


def test_unconstrained_matrices(refused, tmp_path):
    export(fy.build_model(replace(JOINT, beams=()), bolts=[]), tmp_path)
    assert_says(refused(MATRIX_STUDY), "unconstrained body", "held by nothing", LOOSE)


def test_bolt_stiffer_than_its_matrices(refused, matrices):
    # Only the whole structure can tell, which 'check' does not solve.
    stiffness = MODEL.bolts["bolt"].stiffness
    study = MATRIX_STUDY.replace(f"{stiffness!r}", f"{1.01 * stiffness!r}")
    parts = ["bolt 'M6': its stiffness 299849 is not contained", "296881 in all", "give EA/L"]
    assert_says(refused(study, "run"), *parts)


# ---- the output folder


@pytest.mark.parametrize("command", ["check", "run", "demo"])
def test_output_folder(refused, call, deck, tmp_path, command):
    (tmp_path / "joint.bdf").write_text(deck)
    (tmp_path / "taken").write_text("")
    for out in (tmp_path / "taken", tmp_path / "taken" / "inside"):
        if command == "demo":
            status, _, error = call("demo", "--out", out)
            assert status == 2
            message = one_message(error)
        else:
            message = refused(DECK_STUDY, command, "--out", out)
        assert_says(message, f"cannot write to folder {out}", "choose another with --out")


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a folder not even root fills")
def test_folder_without_permission(refused, deck, tmp_path):
    (tmp_path / "joint.bdf").write_text(deck)
    message = refused(DECK_STUDY, "run", "--out", "/proc/self")
    assert_says(message, "cannot write to folder /proc/self", "choose another with --out")
