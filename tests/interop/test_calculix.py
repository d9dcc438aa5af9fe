"""Decks that faying writes, run by CalculiX and read back by faying."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from programs import calculix, or_skip, run_calculix

import faying as fy
from faying.io.abaqus import read_joint
from faying.io.abaqus.writer import write_deck
from faying.linalg.factorization import factorize
from faying.model.assembly import Assembly, NodalLoads
from faying.model.boundary import FORCE_NAMES
from faying.model.build import build_model
from faying.model.constraints import constrain
from faying.model.description import JointDescription
from faying.model.elements.hex8 import HEX8
from faying.model.lap_joint import STEEL, lap_joint_assembly
from faying.model.matrices import assemble_matrices, used_components
from faying.model.mesh import CellBlock, Mesh
from faying.reduction.normal_modes import lowest_modes

PRINTED = 1e-6
"""Seven digits are printed; 3e-7 is measured."""

GEOMETRY = 1e-3
"""Relative effect of the geometry CalculiX updates between steps, on the coarse cantilever.

3e-4 of displacement and 2e-4 of the largest pressure are measured.
"""

CASES = {"LC1": [0, 0, -500.0, 0, 0, 0], "LC2": [0, 0, -500.0, 20e3, 0, 0]}
PARAMS = [(element, case) for element in ("standard", "incompatible") for case in CASES]
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


@pytest.fixture(scope="module")
def binary():
    return or_skip(calculix)


def cantilever(element, case=None, element_size=5.0):
    """The seed's cantilever, its bolt tightened to 8 kN, with the loads of one case."""
    description = lap_joint_assembly(
        element_size=element_size, element=element, bolt_mass=False, penalty=1e6
    )
    tip = description.assembly.rigid_couplings[0].reference
    loads = {case: NodalLoads(nodes=[tip], forces=[CASES[case]])} if case else {}
    return replace(
        description,
        assembly=replace(description.assembly, loads=loads),
        preloads={"bolt": 8000.0} if case else {},
    )


def frequencies(assembly):
    ours = assemble_matrices(assembly)
    T = constrain(assembly, used_components(assembly)).transformation
    K, M = ((T.T @ matrix @ T).tocsr() for matrix in (ours.K, ours.M))
    squares, _ = lowest_modes(K, M, factorize(K), 10)
    return np.sqrt(squares) / (2 * np.pi)


@pytest.mark.parametrize(
    ("element", "tolerance"),
    [
        # Seven digits are printed: half a unit of the last one is 5e-7 of 1000.
        ("standard", 5e-7),
        # Promised in issue 4. Bending agrees to 1e-4, the ninth mode to 0.48 % only: CalculiX
        # gives mass to the incompatible modes, faying none; the stiffness is the same (below).
        ("incompatible", 5e-3),
    ],
)
def test_ten_frequencies(element, tolerance, binary, tmp_path):
    """The cantilever without contact, its plates held by the bolt alone."""
    description = cantilever(element)
    write_deck(description, tmp_path / "joint.inp", modes=10)
    theirs = run_calculix(binary, tmp_path / "joint.inp").frequencies
    np.testing.assert_allclose(theirs, frequencies(description.assembly), rtol=tolerance)


def test_c3d8i_is_our_brick_but_for_the_mass_of_its_modes(binary, tmp_path):
    """Matrices of one brick; CalculiX stores the incompatible modes as three more nodes."""
    nodes = (np.array(HEX8.reference_nodes) * [2.0, 3.0, 4.0]) @ [[1, 0, 0], [0.2, 1, 0], [0, 0, 1]]
    block = CellBlock(kind="hex8", nodes=[range(8)], ids=[1], properties=[1])
    mesh = Mesh(nodes=nodes, node_ids=np.arange(1, 9), blocks=(block,))
    brick = Assembly(mesh=mesh, materials={1: STEEL}, element="incompatible")
    path = tmp_path / "brick.inp"
    write_deck(JointDescription(assembly=brick), path, modes=1)
    path.write_text(path.read_text().replace("*FREQUENCY", "*FREQUENCY,SOLVER=MATRIXSTORAGE"))
    run_calculix(binary, path)
    K, M = (stored(path.with_suffix(suffix)) for suffix in (".sti", ".mas"))
    corner, mode = slice(24), slice(24, 33)
    condensed = K[corner, corner] - K[corner, mode] @ np.linalg.solve(
        K[mode, mode], K[mode, corner]
    )
    ours = assemble_matrices(brick)
    used = np.flatnonzero(np.arange(48) % 6 < 3)
    wanted = ours.K.toarray()[np.ix_(used, used)]
    # Fourteen digits are stored; condensation loses one.
    np.testing.assert_allclose(condensed, wanted, rtol=0, atol=1e-12 * wanted.max())
    wanted = ours.M.toarray()[np.ix_(used, used)]
    np.testing.assert_allclose(M[corner, corner], wanted, rtol=0, atol=1e-12 * wanted.max())
    # (1 - ξ²)² with two points a direction: 4/9 of the mass each, where faying's modes have none.
    mass = STEEL.density * 24.0
    np.testing.assert_allclose(np.diag(M)[mode], 4 / 9 * mass, rtol=1e-12)


def stored(path):
    """Read a symmetric matrix of CalculiX: row, column, value."""
    table = np.loadtxt(path)
    i, j = table[:, :2].astype(int).T - 1
    matrix = np.zeros((i.max() + 1, i.max() + 1))
    matrix[i, j] = matrix[j, i] = table[:, 2]
    return matrix


def ccx_rule(interface, data):
    """The interface with CalculiX's contact points: four triangles a facet, seven points each."""
    rule = np.load(data / "lap_joint" / "mesh.npz")
    at, weights = rule["quad_ccx"], rule["quadw_ccx"]
    shape = np.prod(1 + CORNERS[None] * at[:, None], axis=2) / 4
    (faces,) = interface.faces
    order = np.argsort(interface.pairs[:, 0])
    pairs = order[np.searchsorted(interface.pairs[order, 0], faces.minus)]
    n_face, n_point = len(pairs), len(pairs) * len(at)
    table = sp.csr_array(
        (
            np.tile(shape, (n_face, 1)).ravel(),
            np.repeat(pairs, len(at), axis=0).ravel(),
            np.arange(0, 4 * n_point + 1, 4),
        ),
        shape=(n_point, len(interface.pairs)),
    )
    # Facets of this joint are parallelograms of one size; weights sum to 4 on the square.
    area = interface.area / n_face
    return replace(
        interface,
        interpolation=table,
        point_shape=table,
        initial_gap=np.zeros(n_point),
        weights=np.tile(weights, n_face) * area / weights.sum(),
        points=np.zeros((n_point, 3)),
        normals=np.tile(interface.normals[0], (n_point, 1)),
        face_of_point=np.repeat(np.arange(n_face), len(at)),
        quadrature="calculix",
    )


def solved(path, step, data):
    """What faying makes of a step of a deck, everything taken from the deck."""
    joint = read_joint(path, step=step)
    loads = joint.assembly.loads.values()
    forces, boundaries = {}, []
    for nodes, values in ((load.nodes, load.forces) for load in loads):
        for number, row in zip(joint.assembly.mesh.node_ids[nodes].tolist(), values, strict=True):
            boundaries.append(fy.BoundarySpec(name=f"n{number}", node=number))
            forces |= {f"n{number}.{FORCE_NAMES[c]}": row[c] for c in np.flatnonzero(row)}
    model = build_model(
        joint.assembly, interfaces=joint.interfaces, bolts=joint.bolts, boundaries=boundaries
    )
    (name,) = model.interfaces
    model = model.with_interfaces({name: ccx_rule(model.interfaces[name], data)})
    return fy.solve_static(fy.preload(model, joint.preloads, increments=1), fy.Load(forces))


def check(solution, theirs, step, tolerance, pressure=None):
    """Compare displacements, contact force and largest pressure."""
    model = solution.system
    nodal = model.dofs.nodal(solution.states)[:, :3]
    ids = model.assembly.mesh.node_ids.tolist()
    solid = np.unique(model.assembly.mesh.blocks[0].nodes)
    wanted = np.array([theirs.displacements[step][ids[i]] for i in solid])
    largest = np.abs(wanted).max()
    np.testing.assert_allclose(nodal[solid], wanted, rtol=0, atol=tolerance * largest)
    assert solution.contact_force() == pytest.approx(theirs.contact_forces[step], rel=tolerance)
    peak = theirs.pressures[step].max()
    assert solution.max_pressure == pytest.approx(peak, rel=pressure or tolerance)


@pytest.fixture(
    scope="module", params=[(e, c) for e in ("standard", "incompatible") for c in CASES]
)
def both(request, binary, data, tmp_path_factory):
    """A deck of preload and one load case; CalculiX's run and faying's solution of the case."""
    element, case = request.param
    path = tmp_path_factory.mktemp(f"{element}-{case}") / "joint.inp"
    write_deck(cantilever(element, case), path)
    text = path.read_text()
    return element, text, run_calculix(binary, path), solved(path, 2, data), path


def test_same_deck_in_both(both, data):
    """Preload and load case as two steps of one deck."""
    element, _, theirs, solution, path = both
    if element == "incompatible":
        check(solution, theirs, 2, GEOMETRY)
    else:
        # The edge presses a point of the stiffer bricks harder, and its place decides: 11 % of the
        # largest pressure, which the next test finds again when no geometry is updated.
        check(solution, theirs, 2, GEOMETRY, pressure=0.15)
    if "LC1" in path.read_text():
        check(solved(path, 1, data), theirs, 1, PRINTED)
        # The bolt is tightened to a final force: nothing of it is lost to the joint.
        assert theirs.contact_forces[1] == pytest.approx(8000.0, rel=PRINTED)


def in_one_increment(text, control, shortening):
    """The deck with the load case as its only step and the bolt shortened as the preload did."""
    start, case = text.index("** preload"), text.index("** LC")
    locked = f"*BOUNDARY,FIXED\n{control},1,1\n"
    assert locked in text
    return text[:start] + text[case:].replace(
        locked, f"*BOUNDARY\n{control},1,1,{shortening:.10g}\n"
    )


def test_single_increment_agrees_to_the_digits_printed(both, binary, tmp_path):
    """With no step before it CalculiX solves the same small-displacement problem."""
    _, text, preloaded, solution, _ = both
    control = max(preloaded.displacements[1])  # the last node is the bolt's pretension node
    path = tmp_path / "one.inp"
    path.write_text(in_one_increment(text, control, preloaded.displacements[1][control][0]))
    check(solution, run_calculix(binary, path), 1, PRINTED)
