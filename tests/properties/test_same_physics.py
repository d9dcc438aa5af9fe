"""The same joint described otherwise has the same pressures.

Turned, moved, mirrored, renumbered, in other units, and under other loads in proportion.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

import faying as fy
from faying.joint.build import build_model
from faying.joint.lap_joint import STEEL, lap_joint_assembly
from faying.model.cells import CellBlock

MEASURES = {
    "length": 110.0,
    "width": 20.0,
    "thickness": 10.0,
    "overlap": 40.0,
    "element_size": 10.0,
    "hole_radius": 0.0,
    "bolt_diameter": 6.0,
    "washer_radius": 11.0,
}
BOLT = (3.0, -2.0)
FORCE, MOMENT = np.array([150.0, 80.0, -300.0]), np.array([12e3, -4e3, 2e3])
PRELOAD = 10e3
DAMPING = fy.Rayleigh(alpha=160.0, beta=5e-7)
STEP, STEPS = 1e-5, 20
LAWS = ["hard", 1e5]


def described(penalty, **changed):
    """Nothing about it is symmetric: the bolt is off the middle, the load in all directions."""
    measures = {**MEASURES, "bolt_positions": (BOLT,), **changed}
    return lap_joint_assembly(penalty=penalty, **measures)


def built(joint, damping=DAMPING):
    return build_model(
        joint.assembly,
        interfaces=joint.interfaces,
        bolts=joint.bolts,
        boundaries=joint.boundaries,
        damping=damping,
    )


def load(force=FORCE, moment=MOMENT):
    names = ("tip.Fx", "tip.Fy", "tip.Fz", "tip.Mx", "tip.My", "tip.Mz")
    return fy.Load(dict(zip(names, [*force, *moment], strict=True)))


def pressures(model, applied, preload=PRELOAD, step=STEP):
    """After tightening, under a static load, and after its jump by the full and a reduced model."""
    tight = fy.preload(model, {"bolt": preload})
    rom = fy.reduce(tight, fy.craig_bampton(tight, normal_modes=4), compliance=True)
    times = {"step": step, "duration": STEPS * step}
    return np.array(
        [
            fy.solve_static(tight).pressure,
            fy.solve_static(tight, applied).pressure,
            fy.solve_static(rom, applied).pressure,
            fy.solve_transient(tight, applied, **times).pressure[-1],
            fy.solve_transient(rom, applied, **times).pressure[-1],
        ]
    )


@pytest.fixture(scope="module")
def usual():
    """Places of the contact points and pressures there, by contact law."""
    found = {}
    for penalty in LAWS:
        model = built(described(penalty))
        found[penalty] = model.interfaces["joint"].points, pressures(model, load())
    return found


def assert_same(usual, places, found):
    """Compare at the same places, in whatever order they come."""
    points, expected = usual
    distance, order = cKDTree(places).query(points)
    assert distance.max() < 1e-9 * np.ptp(points, axis=0).max()
    assert len(set(order.tolist())) == len(places)
    # The load does something: contact points open and close.
    assert ((expected[0] > 0) != (expected[1] > 0)).any()
    # Pressures are differences of displacements that are some 1e3 times larger, by matrices
    # whose condition is some 1e8: a digit or two of sixteen are left over 1e-9.
    np.testing.assert_allclose(found[:, order], expected, rtol=0, atol=1e-9 * expected.max())


def moved(assembly, turn, shift):
    """An assembly under x -> turn x + shift, a reflection too; its couplings follow their nodes."""
    mesh = assembly.mesh
    blocks = mesh.blocks
    if np.linalg.det(turn) < 0:  # a mirrored brick is inside out: its corners swap in pairs
        swapped = [1, 0, 3, 2, 5, 4, 7, 6]
        blocks = tuple(replace(block, nodes=block.nodes[:, swapped]) for block in blocks)
    beams = tuple(
        replace(beam, orientation=tuple(turn @ beam.orientation)) for beam in assembly.beams
    )
    nodes = mesh.nodes @ turn.T + shift
    return replace(assembly, mesh=replace(mesh, nodes=nodes, blocks=blocks), beams=beams)


TURN = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
SHIFT = np.array([350.0, -70.0, 220.0])


@pytest.mark.parametrize("penalty", LAWS)
@pytest.mark.parametrize(
    "turn", [TURN, np.diag([1.0, -1.0, 1.0]), TURN @ np.diag([-1.0, 1.0, 1.0])]
)
def test_turned_moved_and_mirrored(usual, penalty, turn):
    joint = described(penalty)
    model = built(replace(joint, assembly=moved(joint.assembly, turn, SHIFT)))
    axial = np.linalg.det(turn) * turn  # moments and turns are axial vectors
    found = pressures(model, load(turn @ FORCE, axial @ MOMENT))
    back = (model.interfaces["joint"].points - SHIFT) @ turn
    assert_same(usual[penalty], back, found)


def renumbered(assembly, rng):
    """Nodes and elements in another order, with other ids, and bricks begun at another corner."""
    mesh, (block,) = assembly.mesh, assembly.mesh.blocks
    order = rng.permutation(len(mesh.nodes))
    place = np.argsort(order)
    turned = [1, 2, 3, 0, 5, 6, 7, 4]
    cells = place[block.nodes]
    half = rng.random(len(cells)) < 0.5
    cells[half] = cells[half][:, turned]
    mixed = rng.permutation(len(cells))
    ids = rng.choice(10 * len(cells), len(cells), replace=False) + 10_000
    known = dict(zip(block.ids.tolist(), ids.tolist(), strict=True))
    sets = {name: np.array([known[i] for i in own]) for name, own in mesh.element_sets.items()}
    numbered = replace(
        mesh,
        nodes=mesh.nodes[order],
        node_ids=mesh.node_ids[order],
        blocks=(
            CellBlock(
                kind=block.kind,
                nodes=cells[mixed],
                ids=ids[mixed],
                properties=block.properties[mixed],
            ),
        ),
        element_sets=sets,
        node_sets={name: place[own] for name, own in mesh.node_sets.items()},
    )
    return replace(
        assembly,
        mesh=numbered,
        beams=tuple(
            replace(beam, nodes=tuple(place[list(beam.nodes)].tolist())) for beam in assembly.beams
        ),
        rigid_couplings=tuple(
            replace(one, reference=int(place[one.reference]), nodes=place[one.nodes])
            for one in assembly.rigid_couplings
        ),
        supports=tuple(replace(one, nodes=place[one.nodes]) for one in assembly.supports),
    )


@pytest.mark.parametrize("penalty", LAWS)
def test_renumbered(usual, penalty):
    joint = described(penalty)
    assembly = renumbered(joint.assembly, np.random.default_rng(7))
    model = built(replace(joint, assembly=assembly))
    assert_same(usual[penalty], model.interfaces["joint"].points, pressures(model, load()))


@pytest.mark.parametrize("penalty", LAWS)
def test_other_units(usual, penalty):
    """Metres, kilograms and pascals in place of millimetres, tonnes and megapascals."""
    metres = {name: 1e-3 * value for name, value in MEASURES.items()}
    steel = replace(STEEL, youngs_modulus=1e6 * STEEL.youngs_modulus, density=1e12 * STEEL.density)
    stiffness = penalty if penalty == "hard" else 1e9 * penalty
    place = tuple(1e-3 * np.array(BOLT))
    model = built(described(stiffness, **metres, material=steel, bolt_positions=(place,)))
    found = pressures(model, load(FORCE, 1e-3 * MOMENT))
    assert_same(usual[penalty], 1e3 * model.interfaces["joint"].points, 1e-6 * found)


@pytest.mark.parametrize("penalty", LAWS)
@pytest.mark.parametrize("factor", [1e-3, 7.0])
def test_loads_in_proportion(usual, penalty, factor):
    """Without initial gaps contact does not know how large forces are, only their ratios."""
    model = built(described(penalty))
    found = pressures(model, load(factor * FORCE, factor * MOMENT), preload=factor * PRELOAD)
    assert_same(usual[penalty], model.interfaces["joint"].points, found / factor)
