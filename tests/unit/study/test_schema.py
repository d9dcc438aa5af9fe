import tomllib
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp

import faying.study
from faying.exceptions import FormatError, ModelError, StudyError
from faying.study.inputs.load_model import build, load_model
from faying.study.inputs.loads import case_load, time_span, time_step, training_box
from faying.study.keys.errors import line_of
from faying.study.keys.load_files import read_history
from faying.study.keys.schema import Study, read_study
from faying.study.keys.tables import COMPARED

ROOT = Path(__file__).parents[3]
STUDIES = Path(faying.study.__file__).parent
DEMO = (STUDIES / "demo.toml").read_text()
DECK = (ROOT / "examples" / "nastran_deck.toml").read_text()

SMALL = """
[model]
source = "lap-joint"
lap_joint = { element_size = 10.0, hole_radius = 0.0, washer_radius = 11.0 }
[[bolt]]
name = "bolt"
preload = 1e3
[reduction]
methods = ["compliance"]
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "STUDY.toml"
    path.write_text(text)
    return path


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


def study(folder: Path, text: str) -> Study:
    return read_study(written(folder, text))


@pytest.mark.parametrize("name", ["demo", "demo-quick"])
def test_packaged_studies_load(name):
    loaded = load_model(read_study(STUDIES / f"{name}.toml"))
    assert loaded.preloads == {"bolt": 10e3}
    assert [spec.name for spec in loaded.boundaries] == ["tip"]


def test_demo_is_the_seeds_example():
    demo = read_study(STUDIES / "demo.toml")
    assert demo.reduction.methods == COMPARED
    assert demo.reduction.joint_modes == (5, 10, 20, 40)
    training = demo.reduction.training
    loads = training.levels ** len(training.box) * len(training.preload_factors)
    assert loads == 75
    assert [case.name for case in demo.load_cases] == ["LC1", "LC2", "LC2-step"]
    assert {force.component: force.value for force in demo.load_cases[2].forces} == {
        "Fz": -500.0,
        "Mx": 20e3,
    }
    assert demo.text == DEMO
    assert demo.path == STUDIES / "demo.toml"


def test_two_bolts_example_loads():
    loaded = load_model(read_study(ROOT / "examples" / "two_bolts.toml"))
    assert loaded.preloads == {"bolt-1": 8e3, "bolt-2": 6e3}
    assert [(spec.name, spec.penalty) for spec in loaded.interfaces] == [
        ("joint-1", 5e5),
        ("joint-2", 5e5),
    ]
    assert (loaded.interfaces[0].minus, loaded.interfaces[0].plus) == ("lower", "middle")
    assert {m.youngs_modulus for m in loaded.assembly.materials.values()} == {205e3}
    assert {m.poissons_ratio for m in loaded.assembly.materials.values()} == {0.29}


def test_deck_example_is_the_generated_joint():
    deck = load_model(read_study(ROOT / "examples" / "nastran_deck.toml")).assembly
    own = load_model(read_study(STUDIES / "demo-quick.toml")).assembly
    # the deck has eight significant digits
    np.testing.assert_allclose(deck.mesh.nodes, own.mesh.nodes, rtol=1e-7, atol=1e-12)
    assert deck.mesh.n_elements == own.mesh.n_elements
    assert set(deck.mesh.element_sets["lower"]) == set(own.mesh.element_sets["lower"])


BROKEN = [
    (
        "preload = 10e3",
        "prelaod = 10e3",
        [
            "unknown key 'prelaod'",
            "[[bolt]] number 1 of STUDY.toml",
            "(line 23)",
            "did you mean 'preload'?",
        ],
    ),
    ("preload = 10e3", 'preload = "ten"', ["'preload'", "(line 23)", "found 'ten'", "a number"]),
    ("preload = 10e3", "preload = nan", ["finite number"]),
    ("preload = 10e3", "preload = true", ["found true", "a number"]),
    ("preload = 10e3", "preload = -5", ["found -5", "0 or more"]),
    ("preload = 10e3", "", ["missing key 'preload'", "[[bolt]] number 1"]),
    ("title =", "titel =", ["'titel' at the top of STUDY.toml (line 5)", "'title'"]),
    ("[sticking]", "[stiking]", ["'stiking'", "'sticking'"]),
    ('"lap-joint"', '"nastrn"', ["'nastrn'", "did you mean 'nastran'?"]),
    ('source = "lap-joint"', "", ["missing key 'source' in [model]"]),
    ("element_size", "elment_size", ["[model.lap_joint]", "(line 12)", "'element_size'"]),
    ("element_size = 2.5", 'element_size = "a"', ["'element_size'", "found 'a'", "a number"]),
    ("element_size = 2.5", 'shape = "hex9"', ["'hex9'", "did you mean 'hex8'?"]),
    ("element_size = 2.5", "penalty = 3", ["it belongs in [[interface]]"]),
    ('penalty = "auto"', 'penalty = "atuo"', ["'atuo'", "did you mean 'auto'?"]),
    ('penalty = "auto"', "penalty = 0", ["found 0", "a positive number, 'auto' or 'hard'"]),
    ('penalty = "auto"', 'plus = "upper"', ["only one of minus and plus"]),
    ("[5, 10, 20, 40]", "[5, 10, 10]", ["'joint_modes' in [reduction]", "must increase"]),
    ("[5, 10, 20, 40]", "[5, 0]", ["entry 2 of 'joint_modes'", "1 or more"]),
    ('"jim-a",', '"jim-aa",', ["entry 2 of 'methods'", "(line 38)", "did you mean 'jim-a'?"]),
    ("min = -750.0", "min = 7500.0", ["number 1", "not below max 750"]),
    ('component = "Fz", min', 'component = "fz", min', ["did you mean 'Fz'?"]),
    ("box = [", "box = [] #", ["not valid TOML", "line"]),
    ('name = "LC2"', 'name = "LC1"', ["'LC1' is already the name of number 1"]),
    ('kind = "static"', 'kind = "sttaic"', ["did you mean 'static'?"]),
    ('kind = "static"', 'kind = "static"\nstep = 1.0', ["'step'", "has no time"]),
    ('kind = "step"', 'kind = "history"', ["needs a 'file'"]),
    ("value = -500.0", 'file = "h.csv"', ["'h.csv' does not exist", "forces number 1"]),
    (", value = -500.0", "", ["exactly one of 'value', 'file'"]),
    (
        'component = "Mx", value = 20e3',
        'component = "Fz", value = 20e3',
        ["[[load_case]] number 2, forces number 2", "tip.Fz is loaded by number 1"],
    ),
    ('component = "Mx", min', 'component = "Fz", min', ["box", "number 2", "tip.Fz"]),
    ("value = -500.0", "value = -500.0, valu = 3", ["unknown key 'valu'", "'value'"]),
    ("periods = 2.0", "periods = 2.0\nduration = 1.0", ["'duration', 'periods'"]),
    ("periods = 2.0\nsteps_per_period = 100", "periods = 2.0", ["needs a time step"]),
    ('integrator = "implicit-euler"', "rho_infinity = 0.5", ["generalized-alpha"]),
    ("threshold = 0.5", "threshold = 50", ["found 50", "1 or less"]),
    ("stiffness = 1e6", "", ["missing key 'stiffness' in [sticking]"]),
    ('units = "mm-t-s"', 'units = "SI"', ["'SI'", "mm-t-s"]),
    ("[sticking]", "[sticking", ["STUDY.toml", "not valid TOML", "line 25"]),
    ("[sticking]", "[material.steel]\nrho = -1.0\n[sticking]", ["'rho'", "found -1"]),
    ("[sticking]", "[material.alu]\nE = 7e4\n[sticking]", ["[material.alu]", "'steel'"]),
    ("[[bolt]]", "[bolt]", ["'bolt'", "found a table", "[[name]]"]),
    ("[damping]", "[[damping]]", ["'damping'", "expected one table"]),
    ("report = true", 'report = "yes"', ["'report'", "true or false"]),
]


@pytest.mark.parametrize(("old", "new", "fragments"), BROKEN, ids=[new for _, new, _ in BROKEN])
def test_bad_input_is_named_with_its_place_and_remedy(tmp_path, old, new, fragments):
    with pytest.raises(StudyError) as caught:
        study(tmp_path, changed(DEMO, old, new))
    message = str(caught.value)
    assert "STUDY.toml" in message
    assert "\n" not in message
    for fragment in fragments:
        assert fragment in message


def test_several_mistakes_come_in_one_message(tmp_path):
    text = changed(changed(DEMO, "preload", "prelaod"), "alpha", "alhpa")
    with pytest.raises(StudyError) as caught:
        study(tmp_path, text)
    message = str(caught.value)
    assert message.startswith("STUDY.toml: 2 mistakes\n")
    assert "'preload'" in message
    assert "'alpha'" in message


DECK_BROKEN = [
    ('file = "cantilever.bdf"', 'file = "nope.bdf"', ["'nope.bdf' does not exist"]),
    ('file = "cantilever.bdf"', "", ["needs 'file'"]),
    ("elements = [226]", "axis = [[0, 0, 0], [0, 0, 1]]", ["'diameter' and 'washer_radius'"]),
    ("node = 475", "", ["needs either 'set' or 'node'"]),
    ('boundary = "tip"', 'boundary = "tpi"', ["no boundary 'tpi'", "did you mean 'tip'?"]),
]


@pytest.mark.parametrize(
    ("old", "new", "fragments"), DECK_BROKEN, ids=[n for _, n, _ in DECK_BROKEN]
)
def test_bad_studies_of_a_deck(tmp_path, old, new, fragments):
    text = DECK.replace('"cantilever.bdf"', f'"{ROOT / "examples" / "cantilever.bdf"}"')
    text = changed(text, old.replace("cantilever", str(ROOT / "examples" / "cantilever")), new)
    with pytest.raises(StudyError) as caught:
        study(tmp_path, text)
    for fragment in fragments:
        assert fragment in str(caught.value)


def test_unreadable_study(tmp_path):
    with pytest.raises(StudyError, match="No such file"):
        read_study(tmp_path / "absent.toml")
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(StudyError, match="not UTF-8"):
        read_study(tmp_path / "binary.toml")


def test_studies_are_frozen(tmp_path):
    small = study(tmp_path, SMALL)
    with pytest.raises(ValueError, match="frozen"):
        small.title = "other"


def test_line_numbers_of_every_kind_of_toml():
    text = "\n".join(
        [
            "a.b = 1  # comment with [brackets] and = signs",
            "text = '''one",
            "[not.a.table]",
            "two'''",
            "list = [",
            "    1,",
            "    { x = [1,",
            "      2], y = 'a,]' },",
            "]",
            "[[t]]",
            "k = 1979-05-27 07:32:00",
            "[[t.u]]",
            "[[t]]",
            "[[t.u]]",
            '"quoted key" = 1.5e3',
            "[v]",
        ]
    )
    tomllib.loads(text)
    lines = {
        ("a", "b"): 1,
        ("text",): 2,
        ("list", 0): 6,
        ("list", 1, "x", 1): 8,
        ("list", 1, "y"): 8,
        ("t", 0, "k"): 11,
        ("t", 1, "u", 0, "quoted key"): 15,
        ("v",): 16,
        ("not", "a", "table"): None,
    }
    assert {location: line_of(text, location) for location in lines} == lines


HISTORIES = [
    ("0,1\n1,x\n", "line 2: found 'x' in column 'value'"),
    ("0,1\n1\n", "line 2: found 1 cells, expected 2"),
    ("t,F\n0,1\n\n2,1\n1,1\n", "line 5: time 1 does not come after 2"),
    ("0,1\n1,inf\n", "line 2: found 'inf'"),
    ("0,1\n1,1e308\n", "expected finite numbers up to 1e+30 in magnitude"),
    ("-1,1\n1,1\n", "time -1 is negative"),
    ("t,F\n0,1\n", "found 1 instants"),
    ("", "is empty"),
]


@pytest.mark.parametrize(("text", "fragment"), HISTORIES)
def test_bad_histories(tmp_path, text, fragment):
    path = tmp_path / "force.csv"
    path.write_text(text)
    with pytest.raises(FormatError) as caught:
        read_history(path)
    assert fragment in str(caught.value)
    assert str(path) in str(caught.value)


def test_history_files_are_relative_to_the_study(tmp_path):
    (tmp_path / "force.csv").write_text("time,Fz\n0,0\n# pause\n2e-3,-4.0\n")
    text = (
        SMALL
        + """
[[load_case]]
name = "h"
kind = "history"
forces = [{ boundary = "tip", component = "Fz", file = "force.csv" }]
steps_per_period = 50
"""
    )
    case = study(tmp_path, text).load_cases[0]
    assert case.forces[0].file == tmp_path / "force.csv"
    history = read_history(case.forces[0].file)
    np.testing.assert_array_equal(history.at(np.array([0.0, 1e-3, 1.0])), [0.0, -2.0, -4.0])
    assert time_span(case, period=1.0) == 2e-3
    assert time_step(case, period=1.0) == 0.02


def test_timing_by_period(tmp_path):
    demo = study(tmp_path, DEMO)
    assert time_step(demo.load_cases[2], period=2.0) == 0.02
    assert time_span(demo.load_cases[2], period=2.0) == 4.0
    bare = study(tmp_path, SMALL).reduction.training
    assert (time_step(bare, period=1.0), time_span(bare, period=1.0)) == (0.01, 1.0)


def test_entries_override_the_generators_defaults(tmp_path):
    text = SMALL + '[[interface]]\nname = "joint"\npenalty = "hard"\nquadrature = "nodal"\n'
    loaded = load_model(study(tmp_path, text + '[[boundary]]\nname = "tip"\nset = "tip-face"\n'))
    (joint,) = loaded.interfaces
    assert (joint.minus, joint.plus) == ("lower", "upper")
    assert (joint.penalty, joint.quadrature) == ("hard", "nodal")
    (tip,) = loaded.boundaries
    assert (tip.set, tip.node) == ("tip-face", None)


REFUSED_BY_MODEL = [
    ('[[interface]]\nname = "jiont"\n', "did you mean 'joint'?"),
    ('[[boundary]]\nname = "tpi"\n', "did you mean 'tip'?"),
    ('[[bolt]]\nname = "blot"\npreload = 1.0\n', "did you mean 'bolt'?"),
    (
        '[[load_case]]\nname = "a"\nkind = "static"\n'
        'forces = [{ boundary = "tpi", component = "Fz", value = 1 }]\n',
        "did you mean 'tip'?",
    ),
]


@pytest.mark.parametrize(("extra", "fragment"), REFUSED_BY_MODEL)
def test_names_the_generator_does_not_have(tmp_path, extra, fragment):
    with pytest.raises(StudyError) as caught:
        load_model(study(tmp_path, SMALL + extra))
    assert fragment in str(caught.value)


def test_generated_bolts_take_only_a_preload(tmp_path):
    text = changed(SMALL, "preload = 1e3", "preload = 1e3\ndiameter = 8.0")
    with pytest.raises(StudyError, match=r"'diameter'.*\[model.lap_joint\]"):
        load_model(study(tmp_path, text))


def test_every_bolt_of_the_model_needs_a_preload(tmp_path):
    text = changed(SMALL, '[[bolt]]\nname = "bolt"\npreload = 1e3\n', "")
    with pytest.raises(StudyError, match="'bolt' of the model has no preload"):
        load_model(study(tmp_path, text))


def test_sets_by_property_ids_and_deck_name(tmp_path):
    sets = """
[model.sets]
whole = { properties = [1, 2] }
ends = [1, 2]
below = "lower"
few = { elements = [3] }
[[boundary]]
name = "corner"
set = "few"
"""
    loaded = load_model(study(tmp_path, SMALL + sets))
    mesh = loaded.assembly.mesh
    assert len(mesh.element_sets["whole"]) == mesh.n_elements
    np.testing.assert_array_equal(mesh.node_ids[mesh.node_sets["ends"]], [1, 2])
    np.testing.assert_array_equal(mesh.element_sets["below"], mesh.element_sets["lower"])
    cell = mesh.blocks[0].nodes[mesh.blocks[0].ids == 3]
    np.testing.assert_array_equal(mesh.node_sets["few"], np.sort(cell.ravel()))
    assert "whole" not in mesh.node_sets


@pytest.mark.parametrize(
    ("line", "fragment"),
    [
        ("x = 7", "no solid has property 7"),
        ("x = [99999]", "no node with id 99999"),
        ("x = { elements = [99999] }", "no solid element with id 99999"),
        ('x = "lowr"', "did you mean 'lower'?"),
    ],
)
def test_sets_that_do_not_exist(tmp_path, line, fragment):
    with pytest.raises(StudyError) as caught:
        load_model(study(tmp_path, f"{SMALL}[model.sets]\n{line}\n"))
    assert "'x' in [model.sets] of STUDY.toml (line" in str(caught.value)
    assert fragment in str(caught.value)


def test_deck_materials_and_bolt_nodes(tmp_path):
    deck = ROOT / "examples" / "cantilever.bdf"
    text = DECK.replace('"cantilever.bdf"', f'"{deck}"')
    text = changed(text, "elements = [226]", "nodes = [476, 477]")
    loaded = load_model(study(tmp_path, text + "[material.2]\nE = 7e4\n"))
    assert loaded.bolts[0].elements == (226,)
    materials = loaded.assembly.materials
    assert (materials[1].youngs_modulus, materials[2].youngs_modulus) == (210e3, 70e3)
    with pytest.raises(StudyError, match="no material 'stel'"):
        load_model(study(tmp_path, text + "[material.stel]\nE = 7e4\n"))


def test_loads_of_the_demo(tmp_path):
    demo = study(tmp_path, DEMO)
    assert case_load(demo.load_cases[1]).forces == {"tip.Fz": -500.0, "tip.Mx": 20e3}
    box = training_box(demo.reduction.training)
    assert box.ranges == {"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)}
    assert (box.levels, box.preload_factors) == (5, (0.5, 1.0, 1.5))


def test_boundaries_without_the_component_of_a_load(tmp_path):
    text = (
        SMALL
        + """
[[boundary]]
name = "corner"
node = 30
[[load_case]]
name = "twist"
kind = "static"
forces = [{ boundary = "corner", component = "Mx", value = 1.0 }]
"""
    )
    # a node of solids alone has no rotations
    with pytest.raises(ModelError, match="'corner' takes no load 'Mx'; it has Fx, Fy, Fz"):
        build(study(tmp_path, text))


MATRICES = """
[model]
source = "matrices"
files = { M = "M.mtx", K = "K.mtx", nodes = "nodes.csv", dofs = "dofs.csv", faces = "faces.csv" }
[[interface]]
name = "joint"
minus = "below"
plus = "above"
[[boundary]]
name = "tip"
node = 7
[reduction]
methods = ["compliance"]
"""


def test_matrices_are_a_source(tmp_path):
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    points = [(*corner, 0) for corner in square] * 2
    nodes = [f"{i + 1},{x},{y},{z}" for i, (x, y, z) in enumerate(points)]
    (tmp_path / "nodes.csv").write_text("\n".join(nodes) + "\n")
    (tmp_path / "dofs.csv").write_text("".join(f"{i},3\n" for i in range(1, 9)))
    (tmp_path / "faces.csv").write_text("below,1,2,3,4\nabove,5,8,7,6\n")
    for name in ("M.mtx", "K.mtx"):
        scipy.io.mmwrite(tmp_path / name, sp.eye_array(8).tocoo())
    loaded = load_model(study(tmp_path, MATRICES))
    assert loaded.assembly.matrices.K.shape == (8, 8)
    assert set(loaded.assembly.face_sets) == {"below", "above"}
    (tmp_path / "K.mtx").unlink()
    with pytest.raises(StudyError, match=r"'K' in .model.files. .*'K.mtx' does not exist"):
        study(tmp_path, MATRICES)


def test_methods_compared_unasked_are_not_those_of_the_literature():
    assert COMPARED == (
        "craig-bampton",
        "jim-a",
        "jim-b",
        "compliance",
        "jim-a+compliance",
        "jim-b+compliance",
    )
