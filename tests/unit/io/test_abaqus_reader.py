"""What each keyword family of an input deck becomes, and what is refused with its place."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import FormatError, ModelError
from faying.io.abaqus import read_deck, read_joint
from faying.io.abaqus.written_steps import contact_lines
from faying.model.description import JointDescription
from faying.model.elements import SOLIDS, block_element
from faying.model.elements.stiffness import stiffness_blocks
from faying.model.matrices import assemble_matrices
from faying.model.specs import GapRule
from faying.study.inputs.load_model import load_model
from faying.study.keys.schema import read_study
from lap_joints import tiny_lap
from refusals import refuses
from small_abaqus_deck import DECK, PARTS, SHANK, WOOD


@pytest.fixture
def read(tmp_path):
    def reader(text, step=None):
        path = tmp_path / "deck.inp"
        path.write_text(text)
        return read_joint(path, step=step)

    return reader


@pytest.fixture
def small(read):
    return read(DECK)


def edited(*changes, text=DECK):
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new, 1)
    return text


def before_steps(lines, text=DECK):
    return text.replace("*STEP\n", lines + "*STEP\n", 1)


# --- what is read -----------------------------------------------------------------------------


def test_the_last_of_two_sections_counts(read):
    """CalculiX 2.20 takes the last too: two springs of 100 and 400 N/mm on one element gave 400."""
    twice = edited(("*STEP\n", "*SPRING, ELSET=STICK\n1, 1\n5.\n*MASS, ELSET=TIP\n3e-6\n*STEP\n"))
    assembly = read(twice).assembly
    assert [spring.stiffness for spring in assembly.springs] == [5.0]
    assert [mass.mass for mass in assembly.masses] == [3e-6]
    for keyword, element in (("SPRING", 4), ("MASS", 5)):
        note = f"*{keyword} of 1 elements (the first {element}) that have one already: the last"
        assert any(note in text for text in assembly.ignored)


def test_the_small_deck_becomes_a_joint(small):
    assembly = small.assembly
    assert assembly.mesh.n_elements == 2
    assert assembly.element == "standard"
    (material,) = set(assembly.materials.values())
    assert (material.name, material.youngs_modulus) == ("Steel", 210000.0)
    assert (material.poissons_ratio, material.density) == (0.3, 7.85e-9)
    ids = assembly.mesh.node_ids
    assert set(ids[assembly.mesh.node_sets["Bottom"]]) == {1, 2, 3, 4}
    assert set(ids[assembly.mesh.node_sets["TOP"]]) == {15, 16, 17, 18}
    assert len(assembly.mesh.node_sets["BOTH"]) == 8
    assert list(assembly.mesh.element_sets["BRICKS"]) == [1, 2]
    (interface,) = small.interfaces
    assert interface == fy.InterfaceSpec(
        name="Joint", minus="SLAVE", plus="MASTER", penalty=1e6, search_distance=np.inf
    )
    (bolt,) = small.bolts
    assert bolt.elements == (3,)
    assert small.preloads == {bolt.name: 400.0}
    (spring,) = assembly.springs
    assert spring.stiffness == 1000.0
    assert [ids[node] for node, _ in spring.ends] == [6, 12]
    (mass,) = assembly.masses
    assert (ids[mass.node], mass.mass) == (100, 2.5e-6)
    (load,) = assembly.loads.values()
    assert list(ids[load.nodes]) == [100]
    np.testing.assert_array_equal(load.forces, [[0, 0, -7.0, 0, 0, 0]])


def test_the_small_deck_is_in_equilibrium(tmp_path):
    path = tmp_path / "deck.inp"
    path.write_text(DECK)
    model = fy.read_abaqus(path, boundaries=[fy.BoundarySpec(name="tip", node=100)])
    tight = fy.preload(model, read_joint(path).preloads)
    solution = fy.solve_static(tight, fy.Load({"tip.Fz": -7.0}))
    # The parts touch through contact and bolt only; the sum is exact but for round-off.
    assert solution.contact_force() == pytest.approx(solution.bolt_force("bolt 3") + 7.0, rel=1e-9)
    # No step locks the bolt: its force is that of *CLOAD, to the stiffness that is left.
    assert solution.bolt_force("bolt 3") == pytest.approx(400.0, rel=1e-6)


def test_what_locks_a_bolt(read):
    """A *CLOAD behind the lock does nothing; without other loads, a study's come after the lock."""
    steps = DECK[: DECK.index("*STEP")] + STEPS
    assert read(steps, step=1).unlocked == {"bolt 3"}
    locked = read(steps, step=2)
    assert not locked.unlocked
    assert any("FIXED locks it while the loads of step 1" in n for n in locked.assembly.ignored)
    later = steps.replace("100, 3, -9.", "104, 1, 900.\n100, 3, -9.")
    assert read(later, step=2).preloads == {"bolt 3": 400.0}
    alone = read(edited(("100, 3, -7.\n", "")))
    assert not alone.unlocked
    assert any("only bolts act in step 1" in note for note in alone.assembly.ignored)


def test_read_deck_is_the_structure_alone(tmp_path):
    path = tmp_path / "deck.inp"
    path.write_text(DECK)
    assert read_deck(path).mesh.n_elements == 2


def test_forces_on_an_oriented_average_are_those_of_the_program_of_the_deck(read):
    def force(head, number):
        orientation = "*ORIENTATION, NAME=O\n0., 1., 0., -1., 0., 0.\n*COUPLING, ORIENTATION=O,"
        text = edited(("*COUPLING,", orientation), ("100, 3, -7.", f"103, {number}, 5."))
        loads = read(head + text).assembly.loads["step 1"]
        return loads.forces[0].tolist()

    assert force("", 1) == [0, 5, 0, 0, 0, 0]
    assert force("", 2) == [-5, 0, 0, 0, 0, 0]
    assert force("", 4) == [0, 0, 0, 0, 5, 0]
    assert force("*PREPRINT\n", 1) == [5, 0, 0, 0, 0, 0]


def test_case_comments_blanks_and_continued_keywords_do_not_matter(read, small):
    text = edited(
        ("*NODE, NSET=NALL", "*node ,\n nset = nall"),
        ("*SOLID SECTION, ELSET=BRICKS, MATERIAL=STEEL",
         "*Solid  Section,\nelset=Bricks, material=steel\n\n** x"),
        ("5, 0., 0., 1.", "** between\n\n  5 ,0. ,  0.E0, 1.,"),
        ("1, 1, 2, 3, 4, 5, 6, 7, 8", "1, 1, 2, 3, 4,\n5, 6, 7, 8"),
        ("*NSET, NSET=Bottom", '*NSET, NSET="Bottom"'),
    )  # fmt: skip
    other = read(text.replace("\n", "\r\n"))
    np.testing.assert_array_equal(other.assembly.mesh.nodes, small.assembly.mesh.nodes)
    np.testing.assert_array_equal(
        other.assembly.mesh.blocks[0].nodes, small.assembly.mesh.blocks[0].nodes
    )
    assert "Bottom" in other.assembly.mesh.node_sets


def test_included_files_are_read_beside_the_deck(tmp_path, read):
    nodes, rest = DECK.split("*ELEMENT", 1)
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "nodes.inc").write_text(nodes)
    described = read('*INCLUDE, INPUT="parts/nodes.inc"\n*ELEMENT' + rest)
    assert len(described.assembly.mesh.nodes) == 21
    (tmp_path / "parts" / "nodes.inc").write_text(nodes.replace("8, 0., 3., 1.", "8, 0., x, 1."))
    with pytest.raises(FormatError, match=r"nodes\.inc:12: \*NODE: a coordinate: 'x'"):
        read("*INCLUDE, INPUT=parts/nodes.inc\n*ELEMENT" + rest)


MIDDLES = {"hex20": "C3D20", "wedge15": "C3D15", "pyramid13": "C3D13", "tet10": "C3D10"}
# Abaqus: edges of the mid-side nodes, corners counted from one (Analysis User's Guide, solids).
EDGES = {
    "C3D20": "12 23 34 41 56 67 78 85 15 26 37 48",
    "C3D15": "12 23 31 45 56 64 14 25 36",
    "C3D13": "12 23 34 41 15 25 35 45",
    "C3D10": "12 23 31 14 24 34",
}
# The same: corners of faces S1, S2, ...
FACES = {
    8: "1234 5876 1562 2673 3784 4851",
    6: "123 465 1452 2563 3641",
    5: "1234 125 235 345 415",
    4: "123 142 243 341",
}


@pytest.mark.parametrize("kind", SOLIDS)
def test_node_order_and_faces(kind, read):
    element = SOLIDS[kind]
    corners = element.reference_nodes[: element.n_corners]
    name = MIDDLES.get(kind, f"C3D{len(corners)}")
    edges = [(int(a) - 1, int(b) - 1) for a, b in EDGES.get(name, "").split()]
    points = np.vstack([corners, *((corners[a] + corners[b])[None] / 2 for a, b in edges)])
    count = len(points)
    record = ", ".join(map(str, range(1, min(count, 15) + 1)))
    if count > 15:
        record += ",\n" + ", ".join(map(str, range(16, count + 1)))
    faces = FACES[len(corners)].split()
    text = "\n".join(
        [
            "*NODE", *(f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(points.tolist(), 1)),
            f"*ELEMENT, TYPE={name}, ELSET=E", f"7, {record}",
            "*MATERIAL, NAME=M", "*ELASTIC", "1., 0.", "*DENSITY", "1.",
            "*SOLID SECTION, ELSET=E, MATERIAL=M",
            *(f"*SURFACE, NAME=F{i}\n7, S{i}" for i in range(1, len(faces) + 1)), "",
        ]
    )  # fmt: skip
    assembly = read(text).assembly
    (block,) = assembly.mesh.blocks
    assert block.kind == kind
    np.testing.assert_allclose(assembly.mesh.nodes[block.nodes[0]], element.reference_nodes)
    # The mass is the volume of the reference element: no node is out of place.
    mass = assemble_matrices(assembly).M[0::6][:, 0::6].sum()
    assert mass == pytest.approx({8: 1.0, 6: 0.5, 5: 4 / 3, 4: 1 / 6}[len(corners)], rel=1e-12)
    for number, face in enumerate(faces, 1):
        nodes = assembly.face_sets[f"F{number}"][0]
        assert set(nodes[: len(face)] + 1) == {int(digit) for digit in face}
        a, b, c = assembly.mesh.nodes[nodes[:3]]
        outward = np.cross(b - a, c - a) @ (a - corners.mean(axis=0))
        assert outward > 0


def test_coordinate_systems_of_nodes(read):
    text = edited(
        ("1, 0., 0., 0.\n", ""),
        ("*ELEMENT", "*NODE, SYSTEM=C\n1, 5., 90., 2.\n*SYSTEM\n1., 0., 0., 1., 1., 0.\n"
         "*NODE\n201, 1., 2., 3.\n*SYSTEM\n*NODE, SYSTEM=S\n202, 2., 90., 30.\n*ELEMENT"),
    )  # fmt: skip
    mesh = read(text).assembly.mesh
    for node, place in {
        1: (0, 5, 2),
        201: (1 - 2, 1, 3),
        202: (0, 2 * np.cos(np.pi / 6), 1),
    }.items():
        np.testing.assert_allclose(mesh.nodes[mesh.node_index([node])[0]], place, atol=1e-15)


def test_whole_elements_as_a_surface_give_their_exterior(read):
    text = edited(("*SURFACE, NAME=HEAD\nUPPER, S2", "*SURFACE, NAME=HEAD\nUPPER,"))
    assert len(read(text).assembly.face_sets["HEAD"]) == 6


def test_blanks_in_names_may_be_left_out(read, small):
    text = edited(
        ("*SOLID SECTION", "*solidsection"),
        ("*CONTACT PAIR", "*Contactpair"),
        ("REF NODE=103", "refnode=103"),
        ("*RIGID BODY, NSET=BOTTOM, REF NODE=102", "*RIGIDBODY, NSET=BOTTOM, REFNODE=102"),
    )
    described = read(text)
    assert described.interfaces == small.interfaces
    assert [c.reference for c in described.assembly.rigid_couplings] == [
        c.reference for c in small.assembly.rigid_couplings
    ]


def test_a_slave_of_nodes_is_the_facets_between_them(read):
    nodes = "*SURFACE, NAME=SLAVE, TYPE=NODE\n5\n6\n7, 1.\nEIGHT, 1.\n"
    text = edited(
        ("*SURFACE, NAME=SLAVE, TYPE=ELEMENT\nLOWER, S2\n", nodes),
        ("*NSET, NSET=Bottom", "*NSET, NSET=EIGHT\n8\n*NSET, NSET=Bottom"),
    )
    described = read(text)
    model = fy.build_model(
        described.assembly, interfaces=described.interfaces, bolts=described.bolts
    )
    assert model.interfaces["Joint"].weights.sum() == pytest.approx(6.0)
    with pytest.raises(FormatError, match="master surface 'SLAVE' has no facets"):
        read(text.replace("SLAVE, MASTER", "MASTER, SLAVE", 1))


def test_a_slave_without_a_whole_facet_is_points(read):
    """Pressures times areas push the upper brick by what the beam pulls: one interface a node."""
    nodes = "*SURFACE, NAME=SLAVE, TYPE=NODE\n5\n7\n"
    described = read(edited(("*SURFACE, NAME=SLAVE, TYPE=ELEMENT\nLOWER, S2\n", nodes)))
    model = fy.build_model(
        described.assembly, interfaces=described.interfaces, bolts=described.bolts
    )
    # A corner of a brick has a quarter of each of three faces: (2 + 3 + 6) / 4.
    areas = {name: one.weights.sum() for name, one in model.interfaces.items()}
    assert areas == pytest.approx({"Joint node 5": 2.75, "Joint node 7": 2.75})
    joint = fy.preload(model.with_deck_loads("step 1"), {"bolt 3": 400.0})
    pulled = fy.solve_static(joint, fy.Load({"step 1": 1.0}))
    # 7 N press the upper brick too.
    assert pulled.contact_force() - pulled.bolt_force("bolt 3") == pytest.approx(7.0, rel=1e-9)
    with pytest.raises(FormatError, match="no node of surface 'SLAVE' lies above 'MASTER'"):
        read(
            edited(
                ("*SURFACE, NAME=SLAVE, TYPE=ELEMENT\nLOWER, S2\n", nodes.replace("5\n7", "104"))
            )
        )


@pytest.mark.parametrize("closure", [-1e-4, -5e-5, 0.0, 2e-4])
def test_exponential_contact_is_that_of_the_program_of_the_deck(read, closure):
    text = edited(("=LINEAR\n1.E6", "=EXPONENTIAL\n2.E-4, 5."))
    (interface,) = read(text).interfaces
    (pressure,), _ = interface.closure.pressure_of(np.array([closure]))
    # Chords of the table are 3e-4 above the curve at most.
    assert pressure == pytest.approx(5.0 * 100 ** (closure / 2e-4), rel=4e-4)
    (interface,) = read("*PREPRINT\n" + text).interfaces
    assert interface.closure == fy.ExponentialClosure(clearance=2e-4, pressure=5.0)


def test_tabular_contact(read):
    (interface,) = read(edited(("=LINEAR\n1.E6", "=TABULAR\n0., -1.E-3\n8., 0."))).interfaces
    assert interface.closure == fy.TableClosure(closures=(-1e-3, 0.0), pressures=(0.0, 8.0))


def test_hard_contact_and_contact_without_behaviour(read):
    behaviour = "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E6\n"
    for other in ("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n", "*FRICTION\n0.0\n"):
        (interface,) = read(edited((behaviour, other))).interfaces
        assert interface.penalty == "hard"


def test_clearance_is_the_gap_whatever_the_mesh_has(read):
    text = before_steps("*CLEARANCE, MASTER=MASTER, SLAVE=SLAVE, VALUE=0.02\n")
    (spec,) = read(text).interfaces
    assert (spec.name, spec.gap) == ("Joint", GapRule(value=0.02))


def test_meshes_that_do_not_match_are_said_to(read):
    described = read(edited(("11, 0., 0., 1.", "11, 0.5, 0., 1.")))
    assert described.interfaces[0].meshes == "non-matching"
    assert any("do not match" in note for note in described.assembly.ignored)


def test_formulation_follows_the_element_type(read):
    both = DECK.replace("TYPE=C3D8,", "TYPE=C3D8I,")
    assert read(both).assembly.element == "incompatible"
    mixed = read(edited(("TYPE=C3D8,", "TYPE=C3D8I,"))).assembly
    assert mixed.element == "incompatible"
    assert [block.formulation for block in mixed.mesh.blocks] == ["incompatible", "standard"]
    reduced = read(DECK.replace("TYPE=C3D8,", "TYPE=C3D8R,")).assembly
    assert reduced.element == "reduced"
    assert any("2 C3D8R: uniform strain with the hourglass" in note for note in reduced.ignored)


def test_bricks_of_uniform_strain_are_those_of_the_program_of_the_deck(read):
    """Abaqus' hourglass springs are a fifth of CalculiX's, which reads no *PREPRINT."""
    text = DECK.replace("TYPE=C3D8,", "TYPE=C3D8R,")
    energies = []
    for head, formulation in (("", "reduced"), ("*PREPRINT, ECHO=NO\n", "reduced-abaqus")):
        assembly = read(head + text).assembly
        assert assembly.element == formulation
        assert any("2 C3D8R: uniform strain with the hourglass" in n for n in assembly.ignored)
        nodes = assembly.mesh.nodes[assembly.mesh.blocks[0].nodes[:1]]
        saddle = np.prod(nodes[0] - nodes[0].mean(axis=0), axis=1)
        element = block_element(assembly.mesh.blocks[0], assembly.element)
        blocks = stiffness_blocks(element, nodes, np.ones(1), np.ones(1))
        energies.append(saddle @ blocks[0, :, :, 0, 0] @ saddle)
    assert energies[0] == pytest.approx(5 * energies[1], rel=1e-9)  # rounding
    mixed = read("*PREPRINT\n" + edited(("TYPE=C3D8,", "TYPE=C3D8R,"))).assembly.mesh
    assert [block.formulation for block in mixed.blocks] == ["reduced-abaqus", "standard"]


@pytest.mark.parametrize(
    ("kind", "parameter", "said"),
    [
        (
            "C3D8R",
            ", HOURGLASS=ENHANCED",
            "ENHANCED is not read: with it C3D8R bends nearly as C3D8I",
        ),
        ("C3D8R", "", "hourglass control STIFFNESS and its factors are not read"),
        ("C3D8I", ", HOURGLASS=ENHANCED", "no solid of the deck has hourglass modes"),
    ],
)
def test_hourglass_control_is_told_where_it_matters(read, kind, parameter, said):
    controls = f"*SECTION CONTROLS, NAME=EC{parameter}\n1., 1., 1.\n*STEP"
    text = DECK.replace("TYPE=C3D8,", f"TYPE={kind},").replace("*STEP", controls, 1)
    (note,) = (n for n in read(text).assembly.ignored if n.startswith("*SECTION CONTROLS EC"))
    assert said in note


STEPS = """\
*STEP
*STATIC
*CLOAD
104, 1, 400.
100, 3, -7.
*END STEP
*STEP
*STATIC
*BOUNDARY, FIXED
104, 1
*CLOAD
100, 3, -9.
100, 1, 1.
100, 1, 1.
*END STEP
*STEP
*STATIC
*BOUNDARY, OP=NEW
102, 1, 3
*BOUNDARY, OP=NEW, FIXED
104, 1
*CLOAD, OP=NEW
100, 2, 5.
*END STEP
*STEP, PERTURBATION
*FREQUENCY
10
*CLOAD
100, 2, 50.
*END STEP
"""


@pytest.mark.parametrize(
    ("step", "forces", "held"),
    [
        (1, [0, 0, -7], 6),
        (2, [2, 0, -9], 6),
        (3, [0, 5, 0], 3),
        (None, [0, 5, 0], 3),
        (4, [0, 50, 0], 3),
    ],
)
def test_steps_add_to_and_replace_earlier_ones(read, step, forces, held):
    described = read(DECK[: DECK.index("*STEP")] + STEPS, step=step)
    load = described.assembly.loads[described.selected_load]
    np.testing.assert_array_equal(load.forces[0, :3], forces)
    loads = described.assembly.loads
    assert next(iter(loads)) == described.selected_load == f"step {step or 3}"
    earlier = {"step 1": [0, 0, -7], "step 2": [2, 0, -9], "step 3": [0, 5, 0]}
    for name, wanted in list(earlier.items())[: (step or 3) - 1]:
        np.testing.assert_array_equal(loads[name].forces[0, :3], wanted)
    assert len(loads) == (step or 3)
    (support,) = described.assembly.supports
    assert len(support.components) == held
    assert described.preloads == {"bolt 3": 400.0}


def test_a_perturbation_moves_no_support_and_takes_no_load_of_a_step_before(read):
    steps = STEPS.replace(
        "*CLOAD, OP=NEW\n", "*BOUNDARY\n15, 1, 1, .3\n*DLOAD\nLOWER, P2, 4.\n*CLOAD\n"
    )
    described = read(DECK[: DECK.index("*STEP")] + steps, step=4)
    load = described.assembly.loads["step 4"]
    # 100 and 102 of the deck are the only nodes with forces; the bolt keeps what locked it.
    assert load.forces.tolist() == [[0, 50, 0, 0, 0, 0]]
    assert len(described.assembly.loads["step 3"].nodes) > 4
    assert described.preloads == {"bolt 3": 400.0}


def test_steps_that_change_the_structure_are_not_read(read, tmp_path):
    """The last step in front of them is, and says so; one that is asked for is refused."""
    joint = read(WOOD)
    assert list(joint.assembly.loads) == ["step 1"]
    assert any("steps from 2 on: *MODEL CHANGE" in note for note in joint.assembly.ignored)
    assert any("step 1 is read" in note for note in joint.assembly.ignored)
    (tmp_path / "wood.inp").write_text(WOOD)
    refuses(r"\*MODEL CHANGE: .* not supported", read_joint, tmp_path / "wood.inp", step=2)
    with pytest.raises(FormatError, match="MODEL CHANGE"):  # nothing comes before step 1
        read(WOOD.replace("*STATIC", "*STATIC\n*MODEL CHANGE, TYPE=ELEMENT, ADD\nLOWER", 1))


def test_a_removed_preload_is_missed(read):
    # OP=NEW takes the pretension force away, but the bolt was locked before: its force stays.
    described = read(DECK[: DECK.index("*STEP")] + STEPS, step=3)
    assert described.preloads == {"bolt 3": 400.0}


def test_a_beam_that_is_shortened_has_an_initial_force(read, small):
    """EA/L times the displacement of the pretension node; FIXED leaves it where it is."""
    held = "*BOUNDARY\n104, 1, 1, 2.E-3\n"
    text = edited(("*CLOAD\n104, 1, 400.\n", held + "*CLOAD\n"))
    stiffness = fy.build_model(small.assembly, bolts=small.bolts).bolts["bolt 3"].stiffness
    later = "*STEP\n*STATIC\n*BOUNDARY, OP=NEW, FIXED\n104, 1\n*END STEP\n"
    for deck in (text, text + later):
        described = read(deck)
        assert described.preloads == {}
        # Rounding.
        assert described.initial_forces == {"bolt 3": pytest.approx(2e-3 * stiffness, rel=1e-12)}
    assert not any("pretension node" in note for note in described.assembly.ignored)
    (note,) = (n for n in read(edited(("*CLOAD", held + "*CLOAD"))).assembly.ignored if "104" in n)
    assert "holds the node at 0.002" in note


def test_a_study_tightens_what_the_deck_shortens(read, tmp_path):
    text = edited(("*CLOAD\n104, 1, 400.\n", "*BOUNDARY\n104, 1, 1, 2.E-3\n*CLOAD\n"))
    force = read(text).initial_forces["bolt 3"]
    study = tmp_path / "study.toml"
    source = '[model]\nsource = "abaqus"\nfile = "deck.inp"\n'
    for wish, preloads, locked in (
        ("", {}, {"bolt 3": force}),
        ("preload = 70.0", {"bolt 3": 70.0}, {}),
        ("initial_force = 80.0", {}, {"bolt 3": 80.0}),
    ):
        study.write_text(source + f'[[bolt]]\nname = "bolt 3"\n{wish}\n' * bool(wish))
        loaded = load_model(read_study(study))
        assert (loaded.preloads, loaded.initial_forces) == (preloads, locked)


def test_rotation_nodes_of_rigid_bodies_stand_for_rotations(read):
    text = edited(
        ("REF NODE=102", "REF NODE=102, ROT NODE=105"),
        ("104, 9., 9., 9.", "104, 9., 9., 9.\n105, 7., 7., 7."),
        ("102, 1, 6", "102, 1, 3\n105, 1, 3"),
    )  # fmt: skip
    supports = read(text).assembly.supports
    held = {(n, c) for s in supports for n in s.nodes.tolist() for c in s.components}
    index = read(text).assembly.mesh.node_index([102])[0]
    assert held == {(index, c) for c in range(6)}


BEAM = "*BEAM SECTION, ELSET=BOLT, MATERIAL=STEEL, SECTION=CIRC\n0.5\n1., 0., 0.\n"


def test_sections_of_beams(read):
    def section(text):
        (beam,) = read(edited((BEAM, text))).assembly.beams
        return beam.section, beam

    circle, beam = section(BEAM)
    assert circle.area == pytest.approx(np.pi / 4, rel=1e-14)
    assert circle.inertia_y == pytest.approx(np.pi / 64, rel=1e-14)
    assert beam.orientation == (1.0, 0.0, 0.0)
    # n1 is x: 2 wide along x, 3 along y; bending about n1 bends towards y.
    wide, _ = section(BEAM.replace("CIRC\n0.5", "RECT\n2., 3."))
    assert (wide.inertia_y, wide.inertia_z) == pytest.approx((2 * 27 / 12, 3 * 8 / 12))
    # A square's torsion constant is 0.1406 a^4 (Timoshenko, Goodier, table in §109).
    square, _ = section(BEAM.replace("CIRC\n0.5", "RECT\n2., 2."))
    assert square.torsion == pytest.approx(0.1406 * 16, rel=5e-4)
    pipe, _ = section(BEAM.replace("CIRC\n0.5", "PIPE\n0.5, 0.499999"))
    # A pipe without a hole is a circle.
    assert pipe.inertia_y == pytest.approx(circle.inertia_y, rel=1e-6)
    assert pipe.shear_factor_y == pytest.approx(circle.shear_factor_y, rel=1e-6)
    general, beam = section(
        "*BEAM GENERAL SECTION, ELSET=BOLT, SECTION=GENERAL, DENSITY=3.\n"
        "10., 20., 0., 30., 40.\n1., 0., 0.\n2600., 1000.\n"
    )
    assert (general.area, general.inertia_y, general.inertia_z, general.torsion) == (10, 20, 30, 40)
    assert (beam.material.youngs_modulus, beam.material.density) == (2600.0, 3.0)
    assert beam.material.poissons_ratio == pytest.approx(0.3)


def test_beams_of_three_nodes_are_two_beams(read):
    text = edited(
        ("TYPE=B31, ELSET=BOLT\n3, 102, 103", "TYPE=B32, ELSET=BOLT\n3, 102, 106, 103"),
        ("104, 9., 9., 9.", "104, 9., 9., 9.\n106, 1., 1.5, 1."),
    )
    described = read(text)
    first, second = described.assembly.beams
    assert first.nodes[1] == second.nodes[0]
    assert second.id == 3
    assert described.bolts[0].elements == (3,)


def test_axial_springs_find_their_axis(read):
    text = edited(
        ("TYPE=SPRING2, ELSET=STICK\n4, 6, 12", "TYPE=SPRINGA, ELSET=STICK\n4, 1, 5"),
        ("*SPRING, ELSET=STICK\n1, 1\n", "*SPRING, ELSET=STICK\n\n"),
    )
    (spring,) = read(text).assembly.springs
    assert [component for _, component in spring.ends] == [2, 2]


def test_point_masses_turn_too(read):
    text = edited(
        ("*NSET, NSET=Bottom", "*ELEMENT, TYPE=ROTARYI, ELSET=WHEEL\n6, 100\n*NSET, NSET=Bottom"),
        ("*MASS, ELSET", "*ROTARY INERTIA, ELSET=WHEEL\n1., 2., 3., 0.1\n*MASS, ELSET"),
    )  # fmt: skip
    wheel = read(text).assembly.masses[1]
    assert wheel.inertia == ((1.0, 0.1, 0.0), (0.1, 2.0, 0.0), (0.0, 0.0, 3.0))


def test_pressure_and_gravity_add_up(read):
    text = edited(
        ("100, 3, -7.\n", "100, 3, -7.\n*DLOAD\nUPPER, P2, 10.\nLOWER, GRAV, 1000., 0., 0., -2.\n"
         "*DSLOAD\nSLAVE, P, 3.\n"),
    )  # fmt: skip
    assembly = read(text).assembly
    (load,) = assembly.loads.values()
    of = dict(zip(assembly.mesh.node_ids[load.nodes].tolist(), load.forces, strict=True))
    # Faces of 2 x 3; the brick weighs 6 x 7.85e-9 x 1000.
    assert sum(of[i][2] for i in (15, 16, 17, 18)) == pytest.approx(-10.0 * 6)
    assert sum(of[i][2] for i in range(1, 9)) == pytest.approx(-3.0 * 6 - 6 * 7.85e-6)
    assert of[100][2] == -7.0


def test_parts_and_instances(read):
    described = read(PARTS)
    mesh = described.assembly.mesh
    ids = mesh.node_ids.tolist()
    assert ids == [*range(1, 9), *range(11, 19), 21]
    assert any("'High' are raised by 10" in note for note in described.assembly.ignored)
    # Moved by (-3, 0, 1), then turned by -90 degrees about z: (x, y) becomes (y, -x).
    np.testing.assert_allclose(mesh.nodes[ids.index(17)], (3, 1, 2), atol=1e-14)
    assert set(mesh.node_ids[mesh.node_sets["Mixed"]]) == {1, 2, 3, 4, 15}
    assert set(mesh.node_ids[mesh.node_sets["Point"]]) == {21}
    assert set(mesh.element_sets) == {"Low.All", "High.All"}
    (interface,) = described.interfaces
    assert (interface.minus, interface.plus) == ("Low.Over", "High.Under")
    (load,) = described.assembly.loads.values()
    assert mesh.node_ids[load.nodes].tolist() == [15]
    held = {i for s in described.assembly.supports for i in mesh.node_ids[s.nodes].tolist()}
    assert held == {1, 2, 3, 4, 18}


def test_sides_of_triangles_and_quadrilaterals(read):
    # A wedge under a brick on one side, so that the slave has both kinds of facets.
    wedge = "*ELEMENT, TYPE=C3D6, ELSET=LOWER\n6, 21, 22, 23, 25, 26, 27\n*ELEMENT, TYPE=B31"
    places = ["2., 0., 0.", "4., 0., 0.", "2., 3., 0.", "2., 0., 1.", "4., 0., 1.", "2., 3., 1."]
    nodes = "".join(f"{i}, {p}\n" for i, p in zip((21, 22, 23, 25, 26, 27), places, strict=True))
    text = edited(
        ("100, 1., 1.5, 3.", nodes + "100, 1., 1.5, 3."),
        ("*ELEMENT, TYPE=B31", wedge),
        ("LOWER, S2", "LOWER, S2"),
    )
    described = read(text)
    faces = described.assembly.face_sets["SLAVE"]
    assert (faces >= 0).sum(axis=1).tolist() == [4, 3]
    fy.build_model(described.assembly, interfaces=described.interfaces, bolts=described.bolts)


def test_a_section_through_solids_doubles_its_nodes(read):
    described = read(SHANK)
    assembly = described.assembly
    lower, upper = assembly.mesh.blocks[0].nodes
    assert not np.intersect1d(lower, upper).size
    np.testing.assert_array_equal(assembly.mesh.nodes[lower[4:]], assembly.mesh.nodes[upper[:4]])
    assert set(assembly.mesh.node_ids[upper[:4]]) == {5, 6, 7, 8}
    (spring,) = assembly.springs
    # Ten thousand times E A / h of the brick below: 1000 x 1 / 2.
    assert spring.stiffness == pytest.approx(1e4 * 500.0)
    assert described.bolts == (fy.BoltSpec(name="CUT", elements=(spring.id,)),)
    assert described.preloads == {"CUT": 10.0}
    # The face of a contact pair beside the cut moves with the brick that owns the cut.
    assert set(assembly.face_sets["SIDE"][0, :4]) <= set(lower)


CUTS_REFUSED = [
    (("1, S2\n", "1, S4\n"), "does not cut fully through its solids"),
    (("NODE=99\n", "NODE=99\n1., 0., 0.\n"), "the direction is zero or lies in the section"),
    (("SURFACE=CUT", "SURFACE=GASH"), "no surface 'GASH'"),
    (("SURFACE=CUT,", "SURFACE=CUT, ELEMENT=1,"), "either SURFACE= or ELEMENT="),
]


@pytest.mark.parametrize(("change", "message"), CUTS_REFUSED)
def test_sections_that_cut_nothing_are_refused(read, change, message):
    refuses(message, read, edited(change, text=SHANK))


@pytest.mark.parametrize(
    ("direction", "force", "preload"),
    [("0., 0., 1.", 10.0, 10.0), ("0., 0., -2.", -10.0, 10.0), ("0., 0.3, -1.", -3.0, 3.0)],
)
def test_the_direction_of_a_section_says_what_pulls(read, direction, force, preload):
    """CalculiX presses where the force and the direction point apart, through solids and beams."""
    node = ("NODE=99\n", f"NODE=99\n{direction}\n")
    described = read(edited(node, ("99, 1, 10.", f"99, 1, {force}"), text=SHANK))
    assert described.preloads == {"CUT": preload}
    refuses("compressive force", read, edited(node, ("99, 1, 10.", f"99, 1, {-force}"), text=SHANK))
    beam = ("NODE=104\n", f"NODE=104\n{direction}\n")
    described = read(edited(beam, ("104, 1, 400.", f"104, 1, {force}")))
    assert described.preloads == {"bolt 3": preload}
    refuses("normal to the beam", read, edited(("NODE=104\n", "NODE=104\n1., 0., 0.\n")))


def test_cuts_are_no_interfaces(read, tmp_path):
    """A deck without contact pairs is read; what touches is then for the user to say."""
    described = read(edited(("*CONTACT PAIR, INTERACTION=J\nSIDE, OTHER\n", ""), text=SHANK))
    assert (described.interfaces, described.has_joined_faces) == ((), True)
    assert described.preloads == {"CUT": 10.0}
    with pytest.raises(ModelError, match="those of ties and of cuts through bolts"):
        fy.read_abaqus(tmp_path / "deck.inp")
    named = fy.InterfaceSpec(name="side", minus="SIDE", plus="OTHER", search_distance=1.0)
    assert list(fy.read_abaqus(tmp_path / "deck.inp", interfaces=[named]).interfaces) == ["side"]


def test_harmless_keywords_are_listed_once(small):
    ignored = small.assembly.ignored
    assert any(note.startswith("1 *HEADING, 1 *NODE FILE: ") for note in ignored)
    assert len(ignored) == len(set(ignored))


# --- what is refused --------------------------------------------------------------------------

REFUSED = [
    (before_steps("*TIE, NAME=T, CYCLIC SYMMETRY\nSLAVE, MASTER\n"),
     r":81: \*TIE, CYCLIC SYMMETRY: .*not supported.*whole structure"),
    (before_steps("*TIE, NAME=T\nSLAVE, MISTER\n"), r":82: \*TIE: there is no surface 'MISTER'"),
    (before_steps("*INITIAL CONDITIONS, TYPE=STRESS\n"),
     r"\*INITIAL CONDITIONS, TYPE=STRESS: .*not supported"),
    (before_steps("*BLA\n"), r":81: \*BLA: the keyword is not supported"),
    (edited(("1, 0., 0., 0.", "1, 0., 0.O, 0.")),
     r"deck\.inp:5: \*NODE: a coordinate: '0.O' is not"),
    (edited(("1, 0., 0., 0.", "1, 0., 1.E400, 0.")), r":5: .*too large for a number"),
    (edited(("2, 2., 0., 0.", "1, 2., 0., 0.")), r":6: \*NODE: node 1 is defined twice"),
    (edited(("2, 2., 0., 0.", "2 2., 0., 0., 0.")), r":6: .* a node id: '2 2\.' is not a number"),
    (before_steps("*ELEMENT, TYPE=S4, DLOAD\n9, 1, 2, 3, 4\n"), r":81: .*only transfer loads"),
    (edited(("5, 6, 7, 8\n", "5, 6, 7\n")), r":27: \*ELEMENT: expected an id and 8 nodes"),
    (edited(("5, 6, 7, 8\n", "5, 6, 7, 99\n")), r":27: \*ELEMENT: there is no node 99"),
    (edited(("5, 6, 7, 8\n", "5, 6, 7, 7\n")), r":27: .*element 1 has a node twice"),
    (edited(("2, 11, 12", "1, 11, 12")), r":29: \*ELEMENT: element 1 is defined twice"),
    (edited(("TYPE=C3D8,", "TYPE=S8R5,")), r":26: \*ELEMENT, TYPE=S8R5: .*give S3, S4"),
    (edited(("TYPE=B31", "TYPE=T3D3")), r"TYPE=T3D3: .*not supported.*use T3D2"),
    (edited(("ELSET=LOWER", "ELSETT=LOWER")), r"the parameter ELSETT is not supported"),
    (edited(("15, 18, 1", "15, 19, 1")), r"the range starts or ends at 19"),
    (edited(("15, 18, 1", "15, 18, 2")), r"is not a range"),
    (edited(("BOTTOM, TOP", "BOTTOM, TOPP")), r":41: \*NSET: the node set 'TOPP' does not exist"),
    (edited(("BOTTOM, TOP", "BOTTOM, BOTH")), r"'BOTH' contains itself"),
    (edited(("210000., 0.3", "210000., 0.3, 20.\n200000., 0.3, 90."),
            ("*CLOAD", "*TEMPERATURE\n5, 20.\n*CLOAD")),
     r"depend on temperature .* ignore = "),
    (edited(("210000., 0.3", "210000., 0.5")), r":44: \*MATERIAL: .*Poisson's ratio is 0.5"),
    (edited(("*ELASTIC", "*ELASTIC, TYPE=ORTHO")), r"found 2 numbers, expected 9"),
    (edited(("*DENSITY", "*ELASTIC\n1., 0.\n*DENSITY")), r"the \*MATERIAL above has one already"),
    (edited(("*DENSITY", "*PLASTIC\n300., 0.\n*DENSITY")), r"\*PLASTIC: .*linear elastic"),
    (edited(("ELSET=BRICKS, MATERIAL", "ELSET=LOWER, MATERIAL")),
     r":29: .*element 2 has no \*SOLID"),
    (edited(("MATERIAL=STEEL\n*BEAM", "MATERIAL=STEAL\n*BEAM")),
     r"no material 'STEAL'; known are STEEL"),
    (edited(("SECTION=CIRC\n0.5", "SECTION=I\n0.5")), r"SECTION=I is not supported"),
    (edited(("1, 1\n1.D3", "1, 7\n1.D3")), r"degree of freedom 7, expected 1 to 6"),
    (edited(("*SPRING, ELSET", "*SPRING, NONLINEAR, ELSET")),
     r"parameter NONLINEAR is not supported"),
    (edited(("LOWER, S2", "LOWER, S7")), r"found 'S7', expected a face S1"),
    (edited(("LOWER, S2", "BOLT, S2")), r"3 is not a solid element"),
    (edited(("=LINEAR\n1.E6", "=EXPONENTIAL\n1.E-3")), r"one line of two numbers"),
    (edited(("=LINEAR\n1.E6", "=TABULAR\n0., 0.\n1., 0.")), r"both must rise"),
    (edited(("*CONTACT PAIR", "*FRICTION, ROUGH\n*CONTACT PAIR")),
     r"\*FRICTION: friction by ROUGH is not supported"),
    (edited(("*CONTACT PAIR", "*FRICTION\n0.2, 0., 10.\n0.1, 0., 50.\n*CONTACT PAIR")),
     r"friction by a table of 2 lines is not supported"),
    (edited(("*CONTACT PAIR", "*FRICTION\n-0.2\n*CONTACT PAIR")),
     r"coefficient of friction is -0\.2; give a number from 0 to 10"),
    (edited(("*CONTACT PAIR", "*FRICTION\n0.2, -1.\n*CONTACT PAIR")), r"stick slope is -1; give"),
    (edited(("SLAVE, MASTER", "SLAVE, MISTER")), r"no surface 'MISTER'; known are SLAVE, MASTER"),
    (edited(("BEAM, 100", "DIST, 100")), r"type DIST is not supported .* an inequality"),
    (edited(("1, 1., 15, 1, -1.", "1, 1., 15, 1")), r"\*EQUATION: expected node, degree"),
    (edited(("*EQUATION\n2", "*EQUATION\n3")), r"found 2 terms, expected 3"),
    (edited(("104, 1, 400.\n", "")), r"\*PRE-TENSION SECTION: .*has no force"),
    (edited(("104, 1, 400.", "104, 1, -400.")), r"compressive force -400"),
    (edited(("*CLOAD", "*BOUNDARY\n104, 1, 1, -.1\n*CLOAD")), r"compressed by .* -0.1 of its"),
    (edited(("210000., 0.3", "210000., 0.3\n*EXPANSION\n1.2E-5"))
     + "*STEP\n*STATIC\n*BOUNDARY, FIXED\n104, 1\n*TEMPERATURE\nNALL, 20.\n*END STEP\n",
     r"element 3 is a bolt: .* not expand, or remove"),
    (
        DECK + "*STEP\n*STATIC\n*CLOAD, OP=NEW\n100, 3, 1.\n*END STEP\n",
        r"section 'bolt 3' has no force at the end of step 2, where it is read",
    ),
    (
        edited(("*PRE-TENSION", "*PRE-TENSION SECTION, ELEMENT=3, NODE=104\n*PRE-TENSION")),
        r"pretension node 104 belongs to another section too",
    ),
    (edited(("ELEMENT=3,", "ELEMENT=1,")), r"ELEMENT=1 is not one beam"),
    (edited(("102, 1, 6", "102, 1, 6, 0.1"), ("*STEP", "*TRANSFORM, NSET=NALL\n1,1,,0,1,0\n*STEP")),
     r"node 102 is moved along axes of a \*TRANSFORM"),
    (edited(("102, 1, 6", "102, 3, 1")), r"last degree of freedom 1 is below the first 3"),
    (edited(("102, 1, 6", "102, 11")), r"degree of freedom 11, expected 1 to 6"),
    (edited(("*CLOAD", "*CLOAD, FOLLOWER")), r"parameter FOLLOWER is not supported"),
    (edited(("*CLOAD", "*DLOAD\nLOWER, CORIO, 1.\n*CLOAD")), r"load CORIO is not supported"),
    (edited(("*END STEP", "*END STEP\n*NODE\n300, 0., 0., 0.")),
     r"move it before the first \*STEP"),
    (edited(("*END STEP", "*STEP\n*END STEP")), r"a step before this one does not end"),
    (edited(("*HEADING\n", "")), r"deck\.inp:1: data before the first keyword"),
    ("", r"deck\.inp: the deck is empty"),
    ("*NODE\n1, 0., 0., 0.\n", r"deck\.inp: the deck has no elements"),
    ("*INCLUDE, INPUT=nowhere.inc\n",
     r"deck\.inp:1: \*INCLUDE: input deck '.*nowhere.inc' does not exist"),
    ("*INCLUDE, INPUT=deck.inp\n", r"is circular"),
    (PARTS.replace("*END PART\n", ""), r":2: \*PART: it does not end"),
    (PARTS.replace("PART=Brick\n-3", "PART=Trick\n-3"), r"no part 'Trick'; known are BRICK"),
    (PARTS.replace("Low.1, High", "Lo.1, High"), r"no instance 'Lo'"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), REFUSED)
def test_refused_with_place_and_reason(read, text, message):
    refuses(message, read, text)


def test_unknown_steps_and_missing_decks_are_refused(read, tmp_path):
    refuses(r"there is no step 2; the deck has 1", read, DECK, step=2)
    refuses(r"'.*none\.inp' does not exist", read_joint, tmp_path / "none.inp")


def test_materials_that_no_section_names_are_left_out(read):
    """Libraries come with decks; what is in them need not be linear."""
    block = (
        "*MATERIAL, NAME=Rubber\n*HYPERELASTIC, MOONEY-RIVLIN\n0.8, 0.2, 0.1\n"
        "*MATERIAL, NAME=Soft\n*PLASTIC\n200., 0.\n*USER MATERIAL, CONSTANTS=1\n1.\n"
        "*MATERIAL, NAME=Hot\n*ELASTIC\n2E5, .3, 20.\n1E5, .3, 500.\n"
    )
    described = read(edited(("*MATERIAL, NAME=Steel\n", block + "*MATERIAL, NAME=Steel\n")))
    assert {material.name for material in described.assembly.materials.values()} == {"Steel"}
    for name in ("Rubber", "Soft", "Hot"):
        assert f"material {name}, which no section names" in described.assembly.ignored
    with pytest.raises(FormatError, match="PLASTIC: the keyword is not supported"):
        read(edited(("*DENSITY\n7.85E-9\n", "*DENSITY\n7.85E-9\n*PLASTIC\n200., 0.\n")))
    with pytest.raises(FormatError, match="PLASTIC: the keyword is not supported"):
        # Behind the block something else is refused as ever.
        read(
            edited(
                ("*SOLID SECTION", block + "*SOLID SECTION"), ("*STEP\n", "*PLASTIC\n1.\n*STEP\n")
            )
        )


def test_fields_behind_the_nodes_of_elements_are_passed_over(read, small):
    """Where every line has them: else one is a line that lost its end."""
    rows = [("1, 1, 2, 3, 4, 5, 6, 7, 8", "1, 1, 2, 3, 4, 5, 6, 7, 8, 11, 12")]
    found = read(edited(*rows)).assembly
    np.testing.assert_array_equal(found.mesh.blocks[0].nodes, small.assembly.mesh.blocks[0].nodes)
    assert "fields after the 8 nodes of C3D8, which CalculiX ignores too" in found.ignored
    more = "1, 1, 2, 3, 4, 5, 6, 7, 8, 11\n6, 1, 2, 3, 4, 5, 6, 7, 8"
    refuses("a field is missing or extra", read, edited((rows[0][0], more)))


def test_surfaces_of_nothing(read):
    """They do no harm until something names them."""
    described = read(
        edited(("*SURFACE, NAME=HEAD\n", "*SURFACE, NAME=NONE\n*SURFACE, NAME=HEAD\n"))
    )
    assert "NONE" not in described.assembly.face_sets
    with pytest.raises(FormatError, match="there is no surface 'MASTER'; known are SLAVE"):
        read(edited(("*SURFACE, NAME=MASTER\n2, S1\n", "*SURFACE, NAME=MASTER\n")))


@pytest.mark.parametrize(
    ("lines", "expected", "note"),
    [
        ("*FRICTION\n0.2, 1.E5\n", (0.2, 1e5), "the stick slope 100000 is the tangential penalty"),
        ("*FRICTION, SHEAR TRACTION SLOPE=2.E4\n0.3\n", (0.3, 2e4), "stick slope 20000"),
        ("*FRICTION\n0.2\n", (0.2, "auto"), "elastic slip of its program (SLIP TOLERANCE)"),
        ("*FRICTION, ELASTIC SLIP=1.E-3\n0.2\n", (0.2, "auto"), "program (ELASTIC SLIP)"),
        ("*FRICTION, LAGRANGE\n0.2\n", (0.2, float("inf")), "rigid sticking"),
        ("*FRICTION\n0.0\n", (0.0, "auto"), ""),
    ],
)
def test_friction_becomes_the_law_of_its_interfaces(tmp_path, lines, expected, note):
    joint = read_joint(_written(tmp_path, lines))
    (spec,) = joint.interfaces
    assert (spec.friction, spec.tangential_penalty) == expected
    said = [text for text in joint.assembly.ignored if text.startswith("*FRICTION")]
    assert len(said) == bool(note)
    assert all(note in text for text in said)


def test_friction_is_written():
    smooth = tiny_lap()
    spec = fy.InterfaceSpec(name="joint", penalty=1e6, friction=0.2, tangential_penalty=8e5)
    for change, expected in (
        ({}, "0.2,800000."),
        ({"penalty": "hard", "tangential_penalty": "auto"}, "0.2"),
        ({"friction": 0.0}, None),
    ):
        one = replace(spec, **change)
        lines = list(contact_lines(JointDescription(assembly=smooth.assembly, interfaces=(one,))))
        found = lines[lines.index("*FRICTION") + 1] if "*FRICTION" in lines else None
        assert found == expected


def _written(folder, lines):
    path = folder / "deck.inp"
    path.write_text(edited(("*CONTACT PAIR", f"{lines}*CONTACT PAIR")))
    return path
