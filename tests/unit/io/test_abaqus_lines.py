"""Trusses and springs along any line: a tripod by the sum of its legs."""

import numpy as np
import pytest

from faying.exceptions import FormatError
from faying.io.abaqus import read_deck
from faying.model.matrices import assemble_matrices, mass_properties

FEET = np.array([[2.0, 0.0, -3.0], [-1.0, 1.5, -3.0], [-1.0, -2.0, -3.0]])
NODES = "*NODE\n4, 0., 0., 0.\n" + "".join(
    f"{i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(FEET.tolist(), 1)
)
REST = "*BOUNDARY\n1, 1, 3\n2, 1, 3\n3, 1, 3\n*STEP\n*STATIC\n*CLOAD\n4, 3, -1.\n*END STEP\n"
TRUSSES = """\
*ELEMENT, TYPE=T3D2, ELSET=LEGS
1, 1, 4
2, 4, 2
3, 3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*DENSITY
2.
*SOLID SECTION, ELSET=LEGS, MATERIAL=M
0.25
"""
SPRINGS = """\
*ELEMENT, TYPE=SPRINGA, ELSET=LEGS
1, 1, 4
2, 4, 2
3, 3, 4
*SPRING, ELSET=LEGS

70.
"""


@pytest.fixture
def read(tmp_path):
    def call(text):
        (tmp_path / "deck.inp").write_text(text)
        return read_deck(tmp_path / "deck.inp")

    return call


def at_apex(assembly):
    """Stiffness of the apex alone."""
    rows = 6 * int(assembly.mesh.node_index(np.array([4]))[0]) + np.arange(3)
    return assemble_matrices(assembly).K.toarray()[np.ix_(rows, rows)]


def legs(stiffness):
    lengths = np.linalg.norm(FEET, axis=1)
    along = FEET / lengths[:, None]
    return np.einsum("n,na,nb->ab", np.broadcast_to(stiffness(lengths), 3), along, along)


def test_trusses(read):
    found = read(NODES + TRUSSES + REST)
    # Sums of nine rounded products.
    np.testing.assert_allclose(at_apex(found), legs(lambda length: 250.0 / length), atol=1e-12)
    wanted = 2.0 * 0.25 * np.linalg.norm(FEET, axis=1).sum()
    assert mass_properties(found).mass == pytest.approx(wanted)
    unit = read(NODES + TRUSSES.replace("0.25\n", "") + REST)
    assert {beam.section.area for beam in unit.beams} == {1.0}


def test_springs_along_a_line(read):
    found = read(NODES + SPRINGS + REST)
    np.testing.assert_allclose(at_apex(found), legs(lambda _: 70.0), atol=1e-12)
    straight = read(NODES.replace("4, 0., 0., 0.", "4, 2., 0., 0.") + SPRINGS + REST)
    # The leg that became upright is a spring between two components.
    assert len(straight.springs) == 1
    assert len(straight.bushes) == 2


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("0.25\n", "-1.\n", r"SOLID SECTION: an area is -1"),
        ("ELSET=LEGS, MATERIAL", "ELSET=SOME, MATERIAL", r":8: .*element 1 has no \*SOLID SECTION"),
        ("1, 1, 4", "1, 1, 5", "truss 1 has no length"),
    ],
)
def test_trusses_that_make_no_sense_are_refused(read, old, new, message):
    some = "5, 2., 0., -3.\n", "*ELSET, ELSET=SOME\n2,\n*MATERIAL"
    text = NODES + some[0] + TRUSSES.replace("*MATERIAL", some[1], 1) + REST
    with pytest.raises(FormatError, match=message):
        read(text.replace(old, new, 1))
    with pytest.raises(FormatError, match="SPRINGA 1 has no direction"):
        read(NODES + some[0] + SPRINGS.replace("1, 1, 4", "1, 1, 5") + REST)
