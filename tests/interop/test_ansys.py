"""Files that Ansys wrote and ansys-mapdl-reader brings along: cubes of SOLID186 and SOLID187.

The archive and the matrices belong together: 40 bricks with 321 nodes.
"""

import contextlib
import random
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from faying.exceptions import FormatError
from faying.io.ansys_archive import read_archive
from faying.io.ansys_commands import read_commands
from faying.io.ansys_full import read_full
from faying.model.assembly import Material
from faying.model.elements import SOLIDS
from faying.model.matrices import assemble_matrices, mass_properties

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # the package's own deprecations
    examples = pytest.importorskip(
        "ansys.mapdl.reader.examples", reason="ansys-mapdl-reader is not installed"
    )

STEEL = Material(name="default", youngs_modulus=2e11, poissons_ratio=0.3, density=7850.0)


@pytest.fixture(scope="module")
def archive():
    return read_archive(Path(examples.hexarchivefile), materials={})


@pytest.fixture(scope="module")
def matrices():
    return {name: read_full(Path(examples.fullfile), name) for name in "KM"}


def test_archive(archive):
    assert [(b.kind, len(b.ids)) for b in archive.mesh.blocks] == [("hex20", 40)]
    assert len(archive.mesh.nodes) == 321
    assert archive.materials[1].youngs_modulus == 7e10
    assert archive.materials[1].poissons_ratio == 0.35
    assert archive.materials[1].density == 2700.0
    assert len(archive.mesh.node_sets["NCOMP2"]) > 0
    assert set(archive.mesh.element_sets["ECOMP1"]) <= set(archive.mesh.element_ids)
    # the mesh fills its box: an inverted or misread brick would not; round-off of the sums
    volume = np.ptp(archive.mesh.nodes, axis=0).prod()
    assert mass_properties(archive).mass == pytest.approx(2700.0 * volume, rel=1e-12)


@pytest.mark.long
def test_tetrahedra():
    found = read_archive(Path(examples.tetarchivefile), materials={"default": STEEL})
    assert {block.kind for block in found.mesh.blocks} == {"tet4"}  # SOLID187 without mid-sides
    volume = np.ptp(found.mesh.nodes, axis=0).prod()
    assert mass_properties(found).mass == pytest.approx(7850.0 * volume, rel=1e-9)


def written(path, routine, points, elements):
    """An archive as CDWRITE writes it, of one routine; elements are their nodes."""
    lines = ["/PREP7", f"ET,1,{routine}", f"NBLOCK,6,SOLID,{len(points)},{len(points)}"]
    lines.append("(3i9,6e21.13e3)")
    for number, place in enumerate(points.tolist(), start=1):
        lines.append(f"{number:9d}{0:9d}{0:9d}" + "".join(f"{x:21.13e}" for x in place))
    lines += ["N,R5.3,LOC,-1,", f"EBLOCK,19,SOLID,{len(elements)},{len(elements)}", "(19i9)"]
    for number, nodes in enumerate(elements, start=1):
        head = [1, 1, 1, 1, 0, 0, 0, 0, len(nodes), 0, number]
        for row in (head + nodes[:8], nodes[8:]):
            lines.append("".join(f"{one:9d}" for one in row))
    path.write_text("\n".join([*lines, "       -1", ""]))
    return path


def test_bricks_of_twenty_nodes_are_integrated_as_ansys_does(archive, matrices):
    """SOLID186 has eight points unless KEYOPT(2) = 1; the .full is of another E, and nu = 0.31."""
    K = matrices["K"]
    like = replace(archive.materials[1], poissons_ratio=0.31)
    ours = assemble_matrices(replace(archive, materials={1: like})).K.tocsr()
    rows = 6 * np.searchsorted(archive.mesh.node_ids, K.dofs[:, 0]) + K.dofs[:, 1] - 1
    scale = ours.diagonal()[rows].sum() / K.matrix.diagonal().sum()
    # Round-off; integrated fully, and with nu of the archive, both are 3e-2 off.
    difference = abs(ours[rows][:, rows] - scale * K.matrix).max()
    assert difference < 1e-12 * abs(scale * K.matrix).max()


COMMANDS = """\
KEYOP,       1, 2, 1,
MPDATA,R5.0, 1,EX  ,       1, 1, 2.000000000E+11,
MP,NUXY,1,0.3,   ! no unit
UIMP,       1,DENS, , ,  7850.0 ,
MPDATA,R5.0, 1,MU  ,       2, 1, 0.15,
D,       1,UX  ,  0.0    ,  0.0
F,       2,FX  ,  1.0    ,  0.0
SFE,       1,       2,PRES, 1,R5.0
CE,R5.0,DEFI,       1,       2,  0.0
CE,R5.0,NODE,       1,UX  ,  1.0    ,       2,UX  , -1.0
ACEL,  0.0    ,  0.0    ,  0.0
SECTYPE,   9,PRETENSION,BOLT,
TB,BISO,       1,   1
"""


def contacts(path, behaviour):
    """A brick of SOLID186 whose lower face is in contact with the plane below, by a target."""
    places = SOLIDS["hex20"].reference_nodes
    order = [*range(1, 13), 17, 18, 19, 20, 13, 14, 15, 16]
    below = places[:4] - [0.0, 0.0, 0.1]
    rows = [[1, 1, 1, 1, 0, 0, 0, 0, 20, 0, 1, *order]]
    rows += [[2, 2, 5, 1, 0, 0, 0, 0, 8, 0, 2, 1, 4, 3, 2, 12, 11, 10, 9]]
    rows += [[2, 3, 5, 1, 0, 0, 0, 0, 4, 0, 3, 21, 22, 23, 24]]
    lines = ["/PREP7", "ET,1,186", "ET,2,174", "ET,3,170", f"KEYOP,2,12,{behaviour}"]
    lines += ["NBLOCK,6,SOLID,24,24", "(3i9,6e21.13e3)"]
    for number, place in enumerate([*places.tolist(), *below.tolist()], start=1):
        lines.append(f"{number:9d}{0:9d}{0:9d}" + "".join(f"{x:21.13e}" for x in place))
    lines += ["N,R5.3,LOC,-1,", "EBLOCK,19,SOLID,3,3", "(19i9)"]
    for row in rows:
        for part in (row[:19], row[19:]):
            if part:
                lines.append("".join(f"{one:9d}" for one in part))
    path.write_text("\n".join([*lines, "       -1", COMMANDS]))
    return path


@pytest.mark.long
def test_what_is_not_read_is_told_with_what_to_do(tmp_path):
    found = read_archive(contacts(tmp_path / "a.cdb", 0), materials={})
    (block,) = found.mesh.blocks
    assert (block.kind, block.formulation) == ("hex20", "")  # KEYOPT(2) = 1
    constants = found.materials[1]
    assert (constants.youngs_modulus, constants.poissons_ratio) == (2e11, 0.3)
    assert constants.density == 7850.0
    np.testing.assert_array_equal(found.mesh.node_sets["contact 5"], [0, 1, 2, 3, 8, 9, 10, 11])
    np.testing.assert_array_equal(found.mesh.node_sets["target 5"], [20, 21, 22, 23])
    assert found.ignored[0] == (
        'contact pair 5, 1 contact elements: an [[interface]] with minus = "contact 5", '
        'plus = "target 5", friction = 0.15'
    )
    starts = ("supports (D)", "forces (F)", "pressures (SFE)", "constraint equations", "tables of")
    told = [note for note in found.ignored if note.startswith("1 commands of ")]
    assert [note.removeprefix("1 commands of ").startswith(one) for note, one in
            zip(told, starts, strict=True)] == [True] * 5  # fmt: skip
    assert any(note.startswith("1 pretension sections: the bolts are cut") for note in
               found.ignored)  # fmt: skip
    bonded = read_archive(contacts(tmp_path / "b.cdb", 5), materials={}).ignored[0]
    assert "bonded (KEYOPT(12) = 5)" in bonded


@pytest.mark.long
@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("MPDATA,R5.0, 2,EX  ,       1, 1, 2.E+11, 1.9E+11,", "EX of material 1 depends on temp"),
        ("MP,EY,1,1.E11", "EY of material 1 not as EX"),
    ],
)
def test_materials_that_are_not_isotropic_constants_are_refused(line, message, tmp_path):
    path = contacts(tmp_path / "a.cdb", 0)
    path.write_text(path.read_text() + line + "\n")
    with pytest.raises(FormatError, match=message):
        read_archive(path, materials={})


def test_damaged_commands_are_read_or_passed_over(tmp_path):
    rng, path = random.Random(2), tmp_path / "damaged.cdb"
    whole = "ETBLOCK,        1,        1\n(2i9,19a9)\n        1      186        0        1\n"
    whole += COMMANDS
    path.write_text(whole)
    assert read_commands(path).options == {1: {2: 1}}
    for _ in range(300):
        damaged = list(whole)
        for _ in range(8):
            damaged[rng.randrange(len(damaged))] = rng.choice("0123456789,.-+EeRD \n!é\0")
        path.write_text("".join(damaged), encoding="latin-1")
        found = read_commands(path)
        assert all(isinstance(n, int) for options in found.options.values() for n in options)


@pytest.mark.long
def test_pyramids_and_removed_mid_side_nodes(tmp_path):
    """SOLID186 folded to a pyramid: the apex stands for the top and its sides."""
    places = SOLIDS["pyramid13"].reference_nodes
    apex = [5] * 4
    whole = [1, 2, 3, 4, *apex, 6, 7, 8, 9, *apex, 10, 11, 12, 13]
    found = read_archive(
        written(tmp_path / "a.cdb", 186, places, [whole]), materials={"default": STEEL}
    )
    (block,) = found.mesh.blocks
    assert block.kind == "pyramid13"
    np.testing.assert_array_equal(block.nodes, [range(13)])
    assert found.ignored == ()

    without = [0 if node in (7, 12) else node for node in whole]
    found = read_archive(
        written(tmp_path / "b.cdb", 186, places, [without]), materials={"default": STEEL}
    )
    (block,) = found.mesh.blocks
    np.testing.assert_array_equal(block.nodes, [[0, 1, 2, 3, 4, 5, 13, 7, 8, 9, 10, 14, 12]])
    np.testing.assert_array_equal(found.mesh.nodes[13:], places[[6, 11]])
    assert {equation.terms[1:] for equation in found.equations} == {
        ((a, c, -0.5), (b, c, -0.5)) for a, b in ((1, 2), (2, 4)) for c in range(3)
    }
    assert found.ignored == ("2 removed mid-side nodes: straight sides",)

    linear = written(tmp_path / "c.cdb", 185, places[:5], [[1, 2, 3, 4, *apex]])
    (block,) = read_archive(linear, materials={"default": STEEL}).mesh.blocks
    assert block.kind == "pyramid5"
    np.testing.assert_array_equal(block.nodes, [range(5)])


def test_matrices_are_labelled_and_symmetric(matrices):
    K, M = matrices["K"], matrices["M"]
    assert K.matrix.shape == M.matrix.shape == (len(K.dofs), len(K.dofs))
    assert np.array_equal(K.dofs, M.dofs)
    assert set(K.dofs[:, 1]) == {1, 2, 3}
    for one in (K, M):
        assert abs(one.matrix - one.matrix.T).max() == 0
        assert one.matrix.diagonal().min() > 0


def test_c_is_not_in_the_file():
    with pytest.raises(FormatError, match=r"file has only K and M"):
        read_full(Path(examples.fullfile), "C")


@pytest.mark.long
def test_materials_must_be_given():
    with pytest.raises(FormatError, match=r'add \[material."material 1"\]'):
        read_archive(Path(examples.tetarchivefile), materials={})


@pytest.mark.long
@pytest.mark.parametrize("name", ["full", "cdb"])
def test_damaged_files_end_in_one_message(name, tmp_path):
    """A few only: every one starts a process."""
    whole = Path(examples.fullfile if name == "full" else examples.hexarchivefile).read_bytes()
    path = tmp_path / f"damaged.{name}"
    rng = random.Random(1)
    for _ in range(3):
        damaged = bytearray(whole[: rng.randrange(100, len(whole))])
        for _ in range(200):
            damaged[rng.randrange(len(damaged))] = rng.randrange(256)
        path.write_bytes(damaged)
        with contextlib.suppress(FormatError):
            if name == "full":
                read_full(path, "K")
            else:
                read_archive(path, materials={"default": STEEL})
