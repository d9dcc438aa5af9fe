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
from faying.model.assembly import NodalLoads
from faying.model.boundary import FORCE_NAMES
from faying.model.build import build_model
from faying.model.constraints import constrain
from faying.model.lap_joint import lap_joint_assembly
from faying.model.matrices import assemble_matrices, used_components
from faying.reduction.normal_modes import lowest_modes

PRINTED = 1e-6
"""Seven digits are printed; 3e-7 is measured."""

GEOMETRY = 1e-3
"""Relative effect of the geometry CalculiX updates between steps, on the coarse cantilever.

3e-4 of displacement and 2e-4 of the largest pressure are measured.
"""

CASES = {"LC1": [0, 0, -500.0, 0, 0, 0], "LC2": [0, 0, -500.0, 20e3, 0, 0]}
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
    return fy.solve_static(fy.preload(model, joint.preloads), fy.Load(forces))


def check(solution, theirs, step, tolerance, bolt=1e-6):
    """Compare displacements, contact force and largest pressure.

    ``bolt`` is what the beam that faying keeps in the cut of the bolt (1e-4 of its compliance)
    adds to ``tolerance``.
    """
    model = solution.system
    nodal = model.dofs.nodal(solution.states)[:, :3]
    ids = model.assembly.mesh.node_ids.tolist()
    solid = np.unique(model.assembly.mesh.blocks[0].nodes)
    wanted = np.array([theirs.displacements[step][ids[i]] for i in solid])
    largest = np.abs(wanted).max()
    allowed = tolerance + bolt
    np.testing.assert_allclose(nodal[solid], wanted, rtol=0, atol=allowed * largest)
    assert solution.contact_force() == pytest.approx(theirs.contact_forces[step], rel=allowed)
    assert solution.max_pressure == pytest.approx(theirs.pressures[step].max(), rel=allowed)


@pytest.mark.parametrize("case", CASES)
def test_same_deck_in_both(case, binary, data, tmp_path):
    """Preload and load case as two steps of one deck, with incompatible modes (C3D8I)."""
    path = tmp_path / "joint.inp"
    write_deck(cantilever("incompatible", case), path)
    theirs = run_calculix(binary, path)
    check(solved(path, 1, data), theirs, 1, PRINTED)
    check(solved(path, 2, data), theirs, 2, GEOMETRY)
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


@pytest.mark.parametrize("element", ["standard", "incompatible"])
@pytest.mark.parametrize("case", CASES)
def test_single_increment_agrees_to_the_digits_printed(element, case, binary, data, tmp_path):
    """With no step before it CalculiX solves the same small-displacement problem."""
    path, one = tmp_path / "joint.inp", tmp_path / "one.inp"
    write_deck(cantilever(element, case), path)
    text = path.read_text()
    preloaded = run_calculix(binary, path)
    control = max(preloaded.displacements[1])  # the last node is the bolt's pretension node
    one.write_text(in_one_increment(text, control, preloaded.displacements[1][control][0]))
    check(solved(path, 2, data), run_calculix(binary, one), 1, PRINTED)
