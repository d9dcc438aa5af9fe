"""Shells of input decks: beam theory, offsets, solids beside them, and CalculiX's own."""

import itertools

import numpy as np
import pytest
from calculix_runs import displacements, needs_calculix, solved

import faying as fy
from faying.exceptions import FormatError
from faying.io.abaqus import read_deck, read_joint
from faying.model.specs import GapRule

LENGTH, WIDTH, THICKNESS = 10.0, 2.0, 0.25
TYPES = {"S3": 3, "S4": 4, "S4R": 4, "S6": 6, "S8": 8, "S8R": 8}


def strip(kind, n=10, m=2):
    """A strip along x, clamped at x = 0, its normal along z: node lines, elements, sets."""
    size = TYPES[kind]
    step = 2 if size in (6, 8) else 1
    number = {}
    for i in range(step * n + 1):
        for j in range(step * m + 1):
            if not (size == 8 and i % 2 and j % 2):
                number[i, j] = len(number) + 1
    cells = []
    for i in range(0, step * n, step):
        for j in range(0, step * m, step):
            a, b, c, d = (i, j), (i + step, j), (i + step, j + step), (i, j + step)
            for corners in [(a, b, c), (a, c, d)] if size in (3, 6) else [(a, b, c, d)]:
                ring = zip(corners, (*corners[1:], corners[0]), strict=True)
                middle = [((p[0] + q[0]) // 2, (p[1] + q[1]) // 2) for p, q in ring]
                cells.append([number[p] for p in [*corners, *(middle if step == 2 else [])]])
    lines = ["*NODE, NSET=ALL"]
    for (i, j), k in number.items():
        lines.append(f"{k}, {LENGTH * i / (step * n)!r}, {WIDTH * j / (step * m)!r}, 0.")
    lines.append(f"*ELEMENT, TYPE={kind}, ELSET=SHELLS")
    lines += [f"{k}, " + ", ".join(map(str, row)) for k, row in enumerate(cells, 1)]
    lines += ["*NSET, NSET=ROOT", *(f"{k}," for (i, _), k in number.items() if i == 0)]
    ends = [k for (i, _), k in number.items() if i == step * n]
    return "\n".join(lines) + "\n", ends


def deck(kind, load, section="", data=f"{THICKNESS}", n=10):
    text, ends = strip(kind, n)
    return (
        f"{text}*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*DENSITY\n2.\n"
        f"*SHELL SECTION, ELSET=SHELLS, MATERIAL=M{section}\n{data}\n*BOUNDARY\nROOT, 1, 6\n"
        f"*STEP\n*STATIC\n{load}\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    ), ends


@pytest.mark.parametrize("kind", TYPES)
def test_a_strip_under_pressure_bends_as_a_beam(kind, tmp_path):
    """Pressure pushes along the normal, weight along its own direction."""
    p = 1e-3
    text, ends = deck(kind, f"*DLOAD\nSHELLS, P, {p}")
    (tmp_path / "deck.inp").write_text(text)
    u = solved(read_deck(tmp_path / "deck.inp"))
    bending = 1000.0 * THICKNESS**3 / 12
    tip = p * LENGTH**4 / (8 * bending) + p * LENGTH**2 / (2 * 5 / 6 * 500.0 * THICKNESS)
    # Ten elements along the strip; the coarse one of S3 is the stiffest.
    np.testing.assert_allclose(u[np.array(ends) - 1, 2], tip, rtol=1e-2)
    weight, _ = deck(kind, "*DLOAD\nSHELLS, GRAV, 1., 0., 0., -1.")
    (tmp_path / "deck.inp").write_text(weight)
    v = solved(read_deck(tmp_path / "deck.inp"))
    ratio = -p / (2.0 * THICKNESS)
    # Weight is M times an acceleration, pressure ∫ N dA.
    np.testing.assert_allclose(ratio * v[:, 2], u[:, 2], rtol=0, atol=3e-3 * tip)


def test_an_offset_bends_a_strip_that_is_pulled(tmp_path):
    """Nodes on the top, OFFSET 0.5: pulled there, the strip bows down by M L² / 2 EI."""
    text, ends = deck("S4", "*CLOAD\nEND, 1, 0.01", section=", OFFSET=SPOS")
    listed = "*NSET, NSET=END\n" + "\n".join(f"{k}," for k in ends)
    (tmp_path / "deck.inp").write_text(text.replace("*BOUNDARY", f"{listed}\n*BOUNDARY"))
    u = solved(read_deck(tmp_path / "deck.inp"))
    moment = 0.01 * len(ends) * THICKNESS / 2 / WIDTH
    wanted = moment * LENGTH**2 / (2 * 1000.0 * THICKNESS**3 / 12)
    # The end is pulled by equal forces at three nodes, not by ½ 1 ½: a state beside the beam's.
    np.testing.assert_allclose(u[np.array(ends) - 1, 2], -wanted, rtol=2e-2)


@needs_calculix
@pytest.mark.parametrize("kind", ["S8", "S8R", "S6"])
def test_calculix_bends_its_solids_alike(kind, tmp_path):
    text, _ = deck(kind, "*DLOAD\nSHELLS, P, 1E-3")
    theirs = displacements(tmp_path, text)[-1]
    ours = solved(read_deck(tmp_path / "job.inp"))[:, :3]
    wanted = np.array([theirs[i + 1] for i in range(len(ours))])
    # Solids of one layer against shells, on ten elements along the strip: shear and the clamp.
    np.testing.assert_allclose(ours, wanted, rtol=0, atol=1e-2 * np.abs(wanted).max())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ((f"\n{THICKNESS}\n", "\n0.\n"), r"the thickness is 0; it must be positive"),
        (
            (f"\n{THICKNESS}\n", "\n0.1, 3, M\n0.1, 3, M\n"),
            r"expected one data line with the thickness",
        ),
        (("MATERIAL=M\n0", "MATERIAL=M, COMPOSITE\n0"), r"parameter COMPOSITE is not supported"),
        (("*SHELL SECTION, ELSET=SHELLS", "*SHELL SECTION, ELSET=ONE"), r"has no \*SHELL SECTION"),
        (("SHELLS, P,", "SHELLS, P2,"), r"1 is not a solid element"),
        (("*MATERIAL", "*SURFACE, NAME=S\nSHELLS, S3\n*MATERIAL"), r"1 is not a solid element"),
        (("*DENSITY", "*EXPANSION\n1E-5\n*DENSITY"), r"shells of material 'M' cannot expand"),
    ],
)
def test_what_shells_are_not_is_refused(change, message, tmp_path):
    heated, _ = deck("S4", "*DLOAD\nSHELLS, P, 1E-3\n*TEMPERATURE\nALL, 20.", n=3)
    assert change[0] in heated
    one = heated.replace("*MATERIAL", "*ELSET, ELSET=ONE\n1\n*MATERIAL", 1)
    (tmp_path / "deck.inp").write_text(one.replace(*change, 1))
    with pytest.raises(FormatError, match=message):
        read_deck(tmp_path / "deck.inp")


def plate_on_a_block(side):
    """Deck of a plate of shells, held at its left end, whose left half lies on a block."""
    nodes, cells = {}, {"C3D20": [], "S8R": []}
    edges = [(a + k, (a + 1) % 4 + k) for k in (0, 4) for a in range(4)]
    edges += [(a, a + 4) for a in range(4)]
    for i, j in itertools.product(range(16), range(2)):
        flat = [(i / 2 + a / 2, j + b) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        for kind, heights in (("C3D20", (0.0, 2.0)), ("S8R", (2.2,))):
            if kind == "C3D20" and i >= 8:
                continue
            corners = [np.array([*at, z]) for z in heights for at in flat]
            if kind == "S8R" and side == "SPOS":
                corners = corners[::-1]
            middles = [(corners[a] + corners[b]) / 2 for a, b in edges if max(a, b) < len(corners)]
            cells[kind].append(
                [nodes.setdefault(tuple(p.tolist()), len(nodes) + 1) for p in corners + middles]
            )
    lines = ["*NODE, NSET=NALL", *(f"{i}, {x}, {y}, {z}" for (x, y, z), i in nodes.items())]
    for first, (kind, rows) in zip((1, 101), cells.items(), strict=True):
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET=E{kind}")
        for number, row in enumerate(rows, first):
            lines.append(f"{number}, " + ", ".join(map(str, row[:15])) + "," * (len(row) > 15))
            lines += [", ".join(map(str, row[15:]))] if row[15:] else []
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", "210000., 0.3"]
    lines += ["*SOLID SECTION, ELSET=EC3D20, MATERIAL=M", "*SHELL SECTION, ELSET=ES8R, MATERIAL=M"]
    lines += ["0.4", "*SURFACE, NAME=SLAVE", f"ES8R, {side}", "*SURFACE, NAME=MASTER"]
    lines += ["EC3D20, S2", "*SURFACE INTERACTION, NAME=SI"]
    lines += ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "1.E5"]
    lines += ["*CONTACT PAIR, INTERACTION=SI, TYPE=SURFACE TO SURFACE", "SLAVE, MASTER"]
    lines += ["*BOUNDARY", *(f"{i}, 1, 3" for (_, _, z), i in nodes.items() if z == 0)]
    lines += [f"{i}, 1, 6" for (x, _, z), i in nodes.items() if (x, z) == (0, 2.2)]
    lines += ["*STEP", "*STATIC", "*DLOAD", f"ES8R, P, {1.0 if side == 'SPOS' else -1.0}"]
    text = "\n".join([*lines, "*NODE PRINT, NSET=NALL", "U", "*END STEP", ""])
    return text, [i for (_, _, z), i in nodes.items() if z == 2.2]


@needs_calculix
@pytest.mark.parametrize("side", ["SNEG", "SPOS"])
def test_shells_in_contact_touch_half_a_thickness_off_their_nodes(side, tmp_path):
    text, plate = plate_on_a_block(side)
    theirs = displacements(tmp_path, text)[-1]
    described = read_joint(tmp_path / "job.inp")
    assert [spec.gap for spec in described.interfaces] == [GapRule(offset=-0.2)]
    assert any("without the lever of the thickness" in n for n in described.assembly.ignored)
    model = fy.read_abaqus(tmp_path / "job.inp").with_deck_loads("step 1")
    solution = fy.solve_static(model, fy.Load({"step 1": 1.0}))
    found = model.dofs.nodal(solution.states)[model.assembly.mesh.node_index(np.array(plate)), :3]
    wanted = np.array([theirs[i] for i in plate])
    # Solids in place of shells: 0.35 % with two elements to a unit, 3.4 % with one.
    np.testing.assert_allclose(found, wanted, rtol=0, atol=0.006 * np.abs(wanted).max())


@needs_calculix
def test_shells_held_by_an_elastic_layer(tmp_path):
    text, plate = plate_on_a_block("SPOS")
    layer = text.replace("OVERCLOSURE=LINEAR\n1.E5", "OVERCLOSURE=TIED\n1.E5\n*FRICTION\n0.1, 1.E3")
    theirs = displacements(tmp_path, layer)[-1]
    assembly = read_deck(tmp_path / "job.inp")
    assert any("ties of shells hold their nodes" in note for note in assembly.ignored)
    found = solved(assembly)[assembly.mesh.node_index(np.array(plate)), :3]
    wanted = np.array([theirs[i] for i in plate])
    # 1.8 %: the layer holds the middle of the plate here, its lower face there.
    np.testing.assert_allclose(found, wanted, rtol=0, atol=0.03 * np.abs(wanted).max())


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "TYPE=SURFACE TO SURFACE",
            "ADJUST=0.1",
            "ADJUST is not supported with surfaces of shells",
        ),
        (
            "OVERCLOSURE=LINEAR\n1.E5",
            "OVERCLOSURE=TIED",
            "ties of shells, which include rotations, are not",
        ),
    ],
)
def test_what_surfaces_of_shells_do_not_take(old, new, message, tmp_path):
    text, _ = plate_on_a_block("SPOS")
    (tmp_path / "deck.inp").write_text(text.replace(old, new))
    with pytest.raises(FormatError, match=message):
        read_joint(tmp_path / "deck.inp")
