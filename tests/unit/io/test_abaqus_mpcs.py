"""``*MPC`` and turned couplings: every rigid motion satisfies them, and they say what they name."""

import numpy as np
import pytest

from faying.exceptions import FormatError
from faying.io.abaqus import read_deck

POINTS = {
    1: (0.0, 0.0, 0.0),
    2: (2.0, 0.0, 0.0),
    3: (2.0, 3.0, 0.0),
    4: (0.0, 3.0, 0.0),
    5: (0.0, 0.0, 1.0),
    6: (2.0, 0.0, 1.0),
    7: (2.0, 3.0, 1.0),
    8: (0.0, 3.0, 1.0),
    9: (1.0, 1.5, 1.0),
    10: (0.5, 0.75, 1.0),
    11: (0.3, 0.4, 1.2),
}
BRICK = (
    "*NODE\n"
    + "".join(f"{i}, {x}, {y}, {z}\n" for i, (x, y, z) in POINTS.items())
    + "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
    "*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.3\n*SOLID SECTION, ELSET=E, MATERIAL=M\n"
    "*SURFACE, NAME=TOP\nE, S2\n"
)


@pytest.fixture
def equations(tmp_path):
    def read(lines, brick=BRICK):
        (tmp_path / "deck.inp").write_text(brick + lines)
        return read_deck(tmp_path / "deck.inp")

    return read


def sums(assembly, u):
    """The left side of each equation under displacements (n_node, 6)."""
    return np.array([sum(a * u[n, c] for n, c, a in e.terms) for e in assembly.equations])


def rigid(assembly, seed=0, axis=None):
    shift, turn = np.random.default_rng(seed).normal(size=(2, 3))
    turn = turn if axis is None else axis * np.linalg.norm(turn)
    points = assembly.mesh.nodes
    return np.hstack([shift + np.cross(turn, points), np.tile(turn, (len(points), 1))]), turn


def test_nodes_stay_on_a_plane(equations):
    """Whichever order they are named in; 9 lies on the line of 5 and 7."""
    assembly = equations("*MPC\nPLANE, 5, 9, 7, 6, 8\n")
    assert len(assembly.equations) == 2
    u, _ = rigid(assembly)
    np.testing.assert_allclose(sums(assembly, u), 0.0, atol=1e-14)  # rounding
    u[:, :2] += np.random.default_rng(1).normal(size=(len(u), 2))  # along the plane: no matter
    # A rigid motion turns the plane, so that motion along it counts where it is not level.
    level = np.zeros_like(u)
    level[:, :2] = u[:, :2]
    np.testing.assert_allclose(sums(assembly, level), 0.0, atol=1e-14)
    level[8, 2] = 1.0
    assert np.abs(sums(assembly, level)).max() > 0.1


def test_nodes_stay_on_a_line(equations):
    assembly = equations("*NSET, NSET=LINE\n5, 7, 9, 10\n*MPC\nSTRAIGHT, LINE\n")
    assert len(assembly.equations) == 4
    u, _ = rigid(assembly)
    np.testing.assert_allclose(sums(assembly, u), 0.0, atol=1e-14)
    along = np.zeros_like(u)
    along[8, :3] = [2.0, 3.0, 0.0]
    np.testing.assert_allclose(sums(assembly, along), 0.0, atol=1e-14)
    along[8, 2] = 1.0
    assert np.abs(sums(assembly, along)).max() > 0.1


def test_a_node_turns_as_the_mean_of_others(equations):
    """Its first displacement is the rotation of a rigid motion about its coordinates."""
    lines = "*MPC\nMEANROT, 5, 5, 5, 6, 6, 6, 7, 7, 7\n0, 8, 8, 8, 11\n"
    assembly = equations(lines)
    (equation,) = assembly.equations
    axis = np.array(POINTS[11]) / np.linalg.norm(POINTS[11])
    u, turn = rigid(assembly, axis=axis)
    u[10, 0] = turn @ axis
    np.testing.assert_allclose(sums(assembly, u), 0.0, atol=1e-13)
    assert equation.terms[-1][:2] == (10, 0)
    assert any("MEANROT: linear about the geometry" in note for note in assembly.ignored)


def test_couplings_tie_along_their_orientation(equations):
    """Two directions at each of four nodes; a radial motion alone is free."""
    lines = (
        "*ORIENTATION, NAME=O, SYSTEM=CYLINDRICAL\n1., 1.5, 0., 1., 1.5, 1.\n"
        "*COUPLING, CONSTRAINT NAME=C, REF NODE=9, SURFACE=TOP, ORIENTATION=O\n*KINEMATIC\n2, 3\n"
    )
    assembly = equations(lines)
    assert len(assembly.equations) == 8
    u, _ = rigid(assembly)
    np.testing.assert_allclose(sums(assembly, u), 0.0, atol=1e-14)
    radial = np.zeros_like(u)
    radial[:8, :2] = assembly.mesh.nodes[:8, :2] - [1.0, 1.5]
    np.testing.assert_allclose(sums(assembly, radial), 0.0, atol=1e-14)
    radial[:8, :2] = (assembly.mesh.nodes[:8, :2] - [1.0, 1.5]) @ [[0, 1], [-1, 0]]
    assert (np.abs(sums(assembly, radial)) > 0.1).sum() == 4


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("*MPC\nPLANE, 5, 6, 7, 4\n", r"a node is \S+ off the plane"),
        ("*MPC\nPLANE, 5, 9, 10, 7\n", r"lie on one line"),
        ("*MPC\nPLANE, 5, 6, 7\n", r"found 3 nodes, expected four"),
        ("*MPC\nSTRAIGHT, 5, 9, 6\n", r"off the line"),
        ("*MPC\nSTRAIGHT, 5, 9\n", r"found 2 nodes, expected three"),
        ("*MPC\nMEANROT, 5, 5, 6, 6, 6, 11\n", r"each node three times"),
        ("*MPC\nMEANROT, 5, 5, 5, 6, 6, 6, 1\n", r"axis of rotation; they are zero"),
        ("*MPC\nTIE, 5\n", r"found 2 fields, expected TIE"),
    ],
)
def test_what_says_nothing_is_refused(equations, lines, message):
    with pytest.raises(FormatError, match=rf"deck\.inp:\d+: .*{message}"):
        equations(lines)


@pytest.mark.parametrize(
    ("kind", "step", "noted"),
    [
        ("C3D8", "*FREQUENCY\n10,,\n", False),
        ("C3D8", "*FREQUENCY\n10,,,1.E-8\n", True),
        ("C3D8I", "*FREQUENCY\n10,,\n", True),
        ("C3D8I", "*STATIC\n", False),
    ],
)
def test_masses_that_are_others_in_calculix_are_named(equations, kind, step, noted):
    brick = BRICK.replace("TYPE=C3D8,", f"TYPE={kind},")
    notes = equations(f"*STEP\n{step}*END STEP\n", brick).ignored
    assert any("frequencies" in note and "lower" in note for note in notes) == noted


def test_beams_of_two_nodes_are_said_to_be_linear(equations):
    assembly = equations("*MPC\nBEAM, 7, 1\n")
    assert len(assembly.rigid_couplings) == 1
    assert "*MPC of type BEAM: linear about the geometry of the deck" in assembly.ignored
