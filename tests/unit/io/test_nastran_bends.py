"""Curved bars and solids of layers."""

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from faying._typing import Matrix
from faying.exceptions import FormatError
from faying.model.assembly import Assembly, Beam, BeamSection, Material
from faying.model.matrices import assemble_matrices, mass_properties

RADIUS = 3.0
STEEL = "MAT1,9,210000.,,.3,7.8-9\n"
SECTION = BeamSection(
    area=0.1,
    inertia_z=0.01,
    inertia_y=0.03,
    torsion=0.02,
    shear_factor_y=0.5,
    shear_factor_z=0.7,
)
Read = Callable[..., Assembly]


@pytest.fixture
def read(nastran) -> Read:
    return lambda *cards: nastran(STEEL, *cards).assembly


def bend(read: Read, card: str, size: str, neutral: str = "0.", shear: str = ".5,.7") -> Assembly:
    """A quarter of a circle about the origin from grid 1 to grid 2."""
    return read(
        "GRID,1,,0.,3.,0.\nGRID,2,,3.,0.,0.\nGRID,3,,5.,7.,0.",
        f"CBEND,4,5,1,2,{card}",
        f"PBEND,5,9,.1,.01,.03,.02,{size}\n,,,,,,,,\n,{shear},.2,,,{neutral}",
    )


def flexibility(assembly: Assembly) -> Matrix:
    """Motion of the last node under its unit forces and moments, the first node held."""
    K = assemble_matrices(assembly).K.toarray()[6:, 6:]
    forces = np.eye(len(K))[:, -6:]
    return np.asarray(np.linalg.solve(K, forces)[-6:])


@pytest.mark.parametrize(
    ("card", "size"),
    [
        ("0.,-1.,0.,1", ","),
        ("0.,1.,0.,1", ","),  # the centre on the extension of the line
        ("1.,0.,0.,2", ","),
        ("3,,,3", "3.,"),
        ("5.,1.,0.,4", ",90."),
    ],
)
def test_a_curved_bar_is_a_chain_of_straight_ones(read: Read, card: str, size: str) -> None:
    arc = bend(read, card, size)
    count = 100
    angle = np.linspace(np.pi / 2, 0, count + 1)
    nodes = RADIUS * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    material = Material(name="steel", youngs_modulus=210000.0, poissons_ratio=0.3, density=0.0)
    chain = replace(
        arc,
        mesh=replace(arc.mesh, nodes=nodes, node_ids=np.arange(count + 1)),
        bushes=(),
        beams=tuple(
            Beam(
                id=i,
                nodes=(i, i + 1),
                section=SECTION,
                material=material,
                orientation=(float(x), float(y), 0.0),
            )
            for i, (x, y, _) in enumerate(nodes[:-1])
        ),
    )
    pair = replace(arc, mesh=replace(arc.mesh, nodes=nodes[[0, -1]], node_ids=np.array([1, 2])))
    found, expected = flexibility(pair), flexibility(chain)
    # Sides of a polygon fall short of the arc by the square of their angle (1/64)²/24, and
    # flexibilities with it, of which the radius enters some three times.
    assert np.abs(found - expected).max() < 1e-4 * np.abs(expected).max()


def test_the_neutral_axis_lies_towards_the_centre(read: Read) -> None:
    """A force across one end of a quarter circle: π/4 (R³/I + R/A - 2R²ΔN/I + R/kA·E/G) / E.

    By Castigliano's theorem from N = F sin φ, V = F cos φ, M = F R sin φ; blank DELTAN is I/AR.
    """
    for neutral, offset in (("", 0.01 / 0.1 / RADIUS), (".2", 0.2)):
        assembly = bend(read, "3,,,3", "3.,", neutral)
        pair = replace(
            assembly,
            mesh=replace(
                assembly.mesh, nodes=assembly.mesh.nodes[:2], node_ids=assembly.mesh.node_ids[:2]
            ),
        )
        shear = 2 * 1.3 * RADIUS / (0.5 * 0.1)
        bending = (RADIUS**3 - 2 * RADIUS**2 * offset) / 0.01
        expected = np.pi / 4 * (bending + RADIUS / 0.1 + shear) / 210000.0
        assert flexibility(pair)[0, 0] == pytest.approx(expected, rel=1e-12)  # round-off


def test_half_of_the_mass_is_at_either_end(read: Read) -> None:
    assembly = bend(read, "3,,,3", "3.,")
    expected = (7.8e-9 * 0.1 + 0.2) * np.pi / 2 * RADIUS
    assert mass_properties(assembly).mass == pytest.approx(expected, rel=1e-12)
    assert "mass of 1 CBEND: half of it at either end, without inertia" in assembly.ignored


@pytest.mark.parametrize(
    ("cards", "message"),
    [
        ("CBEND,4,6,1,2,3,,,3", "property 6 is not in the deck"),
        ("CBEND,4,5,1,1,3,,,3", "nodes coincide"),
        ("CBEND,4,5,1,2,3.,-3.,0.,3", "lie on the line of the nodes"),
        ("CBEND,4,5,1,2,1.,1.,0.,1", "GEOM = 1 with RB = 3"),
        ("CBEND,4,7,1,2,1.,1.,0.,1", "square to the chord"),
        ("CBEND,4,7,1,2,-2.,1.,0.,2", "tangent at GA leads away"),
        ("CBEND,4,8,1,2,3,,,3", "RB = 2 is smaller than half the distance 4.24264"),
        ("CBEND,4,5,1,2,3,,,5", "GEOM = 5"),
        ("CBEND,4,9,1,2,3,,,3", "FSI = 2, a pipe"),
        ("CBEND,4,10,1,2,3,,,3", "field 7 (J) is 0"),
        ("CBEND,4,11,1,2,3,,,3", "an offset '.1'"),
        ("CBEND,4,12,1,2,3,,,3", "impossible for a curved bar"),
        ("CBEND,4,5,1,2,3,,,3\nPBEND,5,9,1.,1.,1.,1.,3.", "property 5 is already defined"),
    ],
)
def test_bends_that_are_refused(read: Read, cards: str, message: str) -> None:
    properties = (
        "PBEND,5,9,.1,.01,.03,.02,3.\nPBEND,7,9,.1,.01,.03,.02\nPBEND,8,9,.1,.01,.03,.02,2.",
        "PBEND,9,9,2,.1,.05,,3.\nPBEND,10,9,.1,.01,.03,,3.",
        "PBEND,11,9,.1,.01,.03,.02,3.\n,,,,,,,,\n,,,,.1",
        "PBEND,12,9,.1,.01,.03,.02,3.\n,,,,,,,,\n,,,,,,9.",
    )
    with pytest.raises(FormatError, match=re.escape(message)):
        read("GRID,1,,0.,3.,0.\nGRID,2,,3.,0.,0.\nGRID,3,,5.,7.,0.", *properties, cards)


BRICK = (
    "".join(
        f"GRID,{i},,{x}.,{y}.,{z}.\n"
        for i, (x, y, z) in enumerate(
            ((x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))), start=1
        )
    )
    + "CHEXA,1,2,1,2,3,4,5,6\n,7,8\n"
)


def test_solids_of_equal_layers_are_solids(read: Read) -> None:
    plain = read(BRICK, "PSOLID,2,9")
    layered = read(BRICK, "PCOMPS,2,,13\n,1,9,.2,0.\n,2,9,.4,90.")
    found, expected = (assemble_matrices(one).K.toarray() for one in (layered, plain))
    np.testing.assert_array_equal(found, expected)
    assert any(note.startswith("PCOMPS: layered solids are as") for note in layered.ignored)


def test_solids_of_several_materials_are_refused(read: Read) -> None:
    with pytest.raises(FormatError, match="layers of materials 9, 11; layered solids"):
        read(BRICK, "MAT1,11,1.,,.3", "PCOMPS,2,,13\n,1,9,.2,0.\n,2,11,.4,90.")
