"""Materials whose directions differ: laws, their axes, what decks say of them, elements."""

from dataclasses import replace

import numpy as np
import pytest

from faying.exceptions import FormatError, ModelError
from faying.io.abaqus import read_joint
from faying.io.nastran import read_deck, write_deck
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import Assembly, Material
from faying.model.cells import CellBlock
from faying.model.elastic_law import (
    isotropic_law,
    mean_constants,
    orthotropic_law,
    stable,
    tensor,
    turned,
)
from faying.model.elements import SOLIDS
from faying.model.matrices import assemble_matrices
from faying.model.mesh import Mesh
from refusals import refuses
from small_abaqus_deck import DECK

# Sums of some hundred products of numbers of one size, in another order.
ROUNDING = 1e-12
WOOD = ((16000.0, 900.0, 600.0), (0.4, 0.45, 0.35), np.array([700.0, 60.0, 800.0]))


def turn():
    """Any rotation."""
    q, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


def test_engineering_constants_are_found_in_the_compliance():
    compliance = np.linalg.inv(orthotropic_law(*WOOD))
    np.testing.assert_allclose(1 / np.diag(compliance), [16000, 900, 600, 700, 60, 800], rtol=1e-12)
    assert -compliance[1, 0] / compliance[0, 0] == pytest.approx(0.4)
    assert -compliance[2, 1] / compliance[1, 1] == pytest.approx(0.35)
    for wrong in (((1.0, 1.0, 1.0), (0.9, 0.9, 0.9)), ((1.0, 1.0, -1.0), (0.1, 0.1, 0.1))):
        with pytest.raises(ValueError, match=r"too large|positive"):
            orthotropic_law(*wrong, np.ones(3))


def test_energy_does_not_depend_on_the_frame():
    law, axes = orthotropic_law(*WOOD), turn()
    strain = np.random.default_rng(1).normal(size=(3, 3))
    strain = strain + strain.T
    local = axes @ strain @ axes.T
    basic = np.einsum("ij,ijkl,kl", strain, tensor(turned(law, axes)), strain)
    assert basic == pytest.approx(np.einsum("ij,ijkl,kl", local, tensor(law), local), rel=ROUNDING)
    np.testing.assert_allclose(
        turned(isotropic_law(3.0, 0.3), axes), isotropic_law(3.0, 0.3), atol=ROUNDING
    )
    assert mean_constants(isotropic_law(3.0, 0.3)) == pytest.approx((3.0, 0.3))


def test_unstable_laws_are_refused():
    law = orthotropic_law(*WOOD)
    assert stable(law)
    crooked, weak = law.copy(), law.copy()
    crooked[0, 1] *= 1.1
    weak[0, 1] = weak[1, 0] = 2 * np.sqrt(law[0, 0] * law[1, 1])
    for wrong in (crooked, weak, law * np.nan):
        with pytest.raises(ModelError, match="stable material"):
            Material.anisotropic(wrong, density=1.0)


@pytest.mark.parametrize("kind", [(e.kind, e.formulation) for e in SOLIDS.values()], ids="-".join)
def test_uniform_strain_stores_its_energy_in_every_element(kind):
    element = next(e for e in SOLIDS.values() if (e.kind, e.formulation) == kind)
    nodes = np.asarray(element.reference_nodes) @ turn() * 2.0
    law = turned(orthotropic_law(*WOOD), turn())
    block = CellBlock(
        kind=element.kind,
        formulation=element.formulation,
        nodes=np.arange(len(nodes))[None],
        ids=np.array([1]),
        properties=np.array([1]),
    )
    assembly = Assembly(
        mesh=Mesh(nodes=nodes, node_ids=np.arange(1, len(nodes) + 1), blocks=(block,)),
        materials={1: Material.anisotropic(law, density=2.0)},
    )
    gradient = np.random.default_rng(2).normal(size=(3, 3))
    motion = np.zeros((len(nodes), 6))
    motion[:, :3] = nodes @ gradient.T
    matrices = assemble_matrices(assembly)
    energy = motion.ravel() @ matrices.K @ motion.ravel()
    along = np.zeros((len(nodes), 6))
    along[:, 0] = 1.0
    volume = along.ravel() @ matrices.M @ along.ravel() / 2.0
    strain = 0.5 * (gradient + gradient.T)
    expected = volume * np.einsum("ij,ijkl,kl", strain, tensor(law), strain)
    assert energy == pytest.approx(expected, rel=ROUNDING)


def wooden(tmp_path, elastic, section="", more=""):
    text = DECK.replace("*ELASTIC\n210000., 0.3\n", f"*ELASTIC, TYPE={elastic}\n")
    text = text.replace("*SOLID SECTION,", f"{more}*SOLID SECTION,{section}")
    # The bolt and nothing else has an isotropic material of its own.
    text = text.replace("*SOLID", "*MATERIAL, NAME=IRON\n*ELASTIC\n2.E5, 0.3\n*SOLID", 1)
    text = text.replace(
        "*BEAM SECTION, ELSET=BOLT, MATERIAL=STEEL", "*BEAM SECTION, ELSET=BOLT, MATERIAL=IRON"
    )
    path = tmp_path / "wood.inp"
    path.write_text(text)
    return read_joint(path).assembly.materials[1]


ENGINEERING = "ENGINEERING CONSTANTS\n16000., 900., 600., 0.4, 0.45, 0.35, 700., 800.,\n60."


def test_types_of_elastic_say_the_same(tmp_path):
    law = orthotropic_law(*WOOD)
    assert np.allclose(wooden(tmp_path, ENGINEERING).law, law, rtol=ROUNDING)
    c = law[[0, 0, 1, 0, 1, 2, 3, 5, 4], [0, 1, 1, 2, 2, 2, 3, 5, 4]].tolist()
    direct = f"ORTHO\n{', '.join(map(repr, c[:8]))},\n{c[8]!r}"
    assert np.allclose(wooden(tmp_path, direct).law, law, rtol=ROUNDING)
    full = [*c[:6], 0.0, 0.0, 0.0, c[6], 0.0, 0.0, 0.0, 0.0, c[7], *5 * [0.0], c[8]]
    rows = [", ".join(map(repr, full[k : k + 8])) for k in (0, 8, 16)]
    assert np.allclose(wooden(tmp_path, "ANISO\n" + ",\n".join(rows)).law, law, rtol=ROUNDING)


def test_orientations_turn_the_material(tmp_path):
    axes = "*ORIENTATION, NAME=ALONG\n0., 2., 0., 0., 1., 3.\n"
    material = wooden(tmp_path, ENGINEERING, " ORIENTATION=ALONG,", axes)
    y, z = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
    expected = turned(orthotropic_law(*WOOD), np.array([y, z, np.cross(y, z)]))
    assert np.allclose(material.law, expected, rtol=ROUNDING)
    material = wooden(tmp_path, ENGINEERING, " ORIENTATION=ALONG,", axes + "1, 90.\n")
    expected = turned(orthotropic_law(*WOOD), np.array([y, np.cross(y, z), -z]))
    assert np.allclose(material.law, expected, rtol=ROUNDING)


@pytest.mark.parametrize(
    ("elastic", "section", "more", "message"),
    [
        ("ORTHO\n1., 2.", "", "", r"\*ELASTIC: found 2 numbers, expected 9"),
        ("COUPLED\n1., 2.", "", "", "TYPE=COUPLED is not supported"),
        (ENGINEERING.replace("0.4,", "9.4,"), "", "", "Poisson's ratios are too large"),
        (ENGINEERING, " ORIENTATION=B,", "", "there is no orientation 'B'; known are none"),
        (
            ENGINEERING,
            " ORIENTATION=A,",
            "*ORIENTATION, NAME=A, SYSTEM=CYLINDRICAL\n0., 0., 0., 0., 0., 1.\n",
            "SYSTEM=CYLINDRICAL is not supported",
        ),
        (
            ENGINEERING,
            " ORIENTATION=A,",
            "*ORIENTATION, NAME=A\n0., 0., 1., 0., 0., 2.\n",
            "lie on one line",
        ),
    ],
)
def test_what_decks_cannot_say_of_them(tmp_path, elastic, section, more, message):
    refuses(message, wooden, tmp_path, elastic, section, more)


def test_beams_and_bodies_that_expand_are_isotropic(tmp_path):
    path = tmp_path / "wood.inp"
    text = DECK.replace("*ELASTIC\n210000., 0.3\n", f"*ELASTIC, TYPE={ENGINEERING}\n")
    path.write_text(text)
    refuses(r"BEAM SECTION: material 'Steel' is anisotropic", read_joint, path)
    text = text.replace("*DENSITY", "*EXPANSION\n1.E-5\n*DENSITY", 1)
    text = text.replace("*BEAM SECTION", "*MATERIAL, NAME=IRON\n*ELASTIC\n1., 0.\n*BEAM SECTION")
    text = text.replace("ELSET=BOLT, MATERIAL=STEEL", "ELSET=BOLT, MATERIAL=IRON")
    path.write_text(text.replace("*END STEP", "*TEMPERATURE\nNALL, 20.\n*END STEP", 1))
    refuses(r"EXPANSION: material 'Steel' is anisotropic", read_joint, path)


def nastran(tmp_path, card, system=""):
    corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    path = tmp_path / "wood.bdf"
    path.write_text(
        "".join(f"GRID,{i},,{x}.,{y}.,{z}.\n" for i, (x, y, z) in enumerate(corners, 1))
        + "CHEXA,1,1,1,2,3,4,5,6\n,7,8\nCORD2R,7,,0.,0.,0.,1.,1.,0.\n,0.,0.,1.\n"
        + f"CORD2C,8,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nPSOLID,1,5,{system}\n{card}\n"
    )
    return read_deck(path).materials[1]


def test_nastran_gives_laws_or_constants(tmp_path):
    law = np.array(turned(orthotropic_law(*WOOD), turn()))
    numbers = [f"{value:.9e}" for value in law[np.triu_indices(6)]]
    rows = [numbers[:7], numbers[7:15], [*numbers[15:], "4.-10"]]
    material = nastran(tmp_path, "MAT9,5," + "\n,".join(",".join(row) for row in rows))
    # Ten digits are written.
    np.testing.assert_allclose(material.law, law, rtol=1e-9, atol=1e-9 * law.max())
    assert material.density == 4e-10
    card = "MAT11,5,16000.,900.,600.,.4,.45,.35,700.\n,800.,60.,4.-10"
    material = nastran(tmp_path, card)
    np.testing.assert_allclose(material.law, orthotropic_law(*WOOD), rtol=ROUNDING)
    assert material.density == 4e-10
    along = nastran(tmp_path, card, "7")  # z along (1, 1, 0), x along basic z
    root = np.sqrt(0.5)
    axes = np.array([[0, 0, 1], [root, -root, 0], [root, root, 0]])
    np.testing.assert_allclose(along.law, turned(orthotropic_law(*WOOD), axes), atol=1e-9)
    for system, message in (("-1", "axes of each"), ("8", "not rectangular"), ("9", "9 is not in")):
        refuses(f"PSOLID: .*{message}", nastran, tmp_path, card, system)
    with pytest.raises(FormatError, match="MAT11: material 5: Poisson's ratios are too large"):
        nastran(tmp_path, card.replace(".4,", "9.,"))


def test_decks_are_not_written_of_them():
    assembly = lap_joint_assembly(element_size=10.0).assembly
    law = Material.anisotropic(isotropic_law(2.1e5, 0.3), density=7.8e-9)
    with pytest.raises(FormatError, match="materials whose directions differ"):
        write_deck(replace(assembly, materials=dict.fromkeys(assembly.materials, law)), "a.bdf")
