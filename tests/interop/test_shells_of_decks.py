"""Shells of input decks: beam theory, offsets, solids beside them, and CalculiX's own."""

import numpy as np
import pytest
from calculix_runs import displacements, needs_calculix, solved

from faying.exceptions import FormatError
from faying.io.abaqus import read_deck

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
        ((f"\n{THICKNESS}\n", "\n0.1, 3, M\n0.1, 3, M\n"), r"found 2 data lines, expected one"),
        (("MATERIAL=M\n0", "MATERIAL=M, COMPOSITE\n0"), r"parameter COMPOSITE is not supported"),
        (("*SHELL SECTION, ELSET=SHELLS", "*SHELL SECTION, ELSET=ONE"), r"has no \*SHELL SECTION"),
        (("SHELLS, P,", "SHELLS, P2,"), r"1 is no solid element"),
        (("*MATERIAL", "*SURFACE, NAME=S\nSHELLS, SPOS\n*MATERIAL"), r"found 'SPOS'"),
        (("*DENSITY", "*EXPANSION\n1E-5\n*DENSITY"), r"shells of material 'M' do not expand"),
    ],
)
def test_what_shells_are_not_is_refused(change, message, tmp_path):
    heated, _ = deck("S4", "*DLOAD\nSHELLS, P, 1E-3\n*TEMPERATURE\nALL, 20.", n=3)
    assert change[0] in heated
    one = heated.replace("*MATERIAL", "*ELSET, ELSET=ONE\n1\n*MATERIAL", 1)
    (tmp_path / "deck.inp").write_text(one.replace(*change, 1))
    with pytest.raises(FormatError, match=message):
        read_deck(tmp_path / "deck.inp")
