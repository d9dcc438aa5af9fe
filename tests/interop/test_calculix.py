"""Decks that faying writes, run by CalculiX and read back by faying."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from programs import calculix, or_skip, run_calculix

import faying as fy
from faying.contact.laws import Coulomb, Penalty
from faying.io.abaqus import read_joint
from faying.io.abaqus.writer import write_deck
from faying.joint.build import build_model
from faying.joint.lap_joint import STEEL, lap_joint_assembly
from faying.model.assembly import Assembly, NodalLoads
from faying.model.boundary import FORCE_NAMES
from faying.model.cells import CellBlock
from faying.model.description import JointDescription
from faying.model.elements import SOLIDS
from faying.model.matrices import assemble_matrices
from faying.model.mesh import Mesh
from faying.model.specs import GapRule
from faying.simulation.start import last_of
from faying.simulation.tightening import tightened_joint
from linear_solution import circular_frequencies

PRINTED = 1e-6
"""Seven digits are printed; 3e-7 is measured."""

GEOMETRY = 1e-3
"""Relative effect of the geometry CalculiX updates between steps, on the coarse cantilever.

3e-4 of displacement and 2e-4 of the largest pressure are measured.
"""

PRESSED = 0.5
FOLLOWS = 2e-5
"""CalculiX turns a pressure with its surface where there is contact; faying does not.

5e-6 of the largest displacement is measured at this pressure, nothing at a tenth of it, 1e-3 at ten
times as much.
"""

CASES = {"LC1": [0, 0, -500.0, 0, 0, 0], "LC2": [0, 0, -500.0, 20e3, 0, 0]}
PARAMS = [("standard", "LC1"), ("incompatible", "LC1"), ("incompatible", "LC2")]
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


@pytest.fixture(scope="module")
def binary():
    return or_skip(calculix)


def cantilever(element, case, element_size=5.0):
    """The seed's cantilever, its bolt tightened to 8 kN, with the loads of one case."""
    description = lap_joint_assembly(
        element_size=element_size, element=element, bolt_mass=False, penalty=1e6
    )
    tip = description.assembly.rigid_couplings[0].reference
    loads = {case: NodalLoads(nodes=[tip], forces=[CASES[case]])}
    return replace(
        description,
        assembly=replace(description.assembly, loads=loads),
        preloads={"bolt": 8000.0},
    )


# Seven digits are printed: half a unit of the last one is 5e-7 of 1000.
SAME = 5e-7
# Promised in issue 4. Bending agrees to 1e-4, the ninth mode to 0.48 % only: CalculiX gives mass to
# the incompatible modes, faying none; the stiffness is the same (below).
MODES_HAVE_MASS = 5e-3


@pytest.mark.parametrize(
    ("options", "tolerance"),
    [
        ({"element": "standard"}, SAME),
        ({"element": "incompatible"}, MODES_HAVE_MASS),
        ({"element": "standard", "washer": "rbe3", "bolt_positions": ((-8, 0), (8, 0))}, SAME),
        ({"element": "standard", "plates": 3, "curvature": 0.004}, SAME),
        ({"shape": "hex20", "element_size": 10.0, "washer_radius": 9.0}, SAME),
    ],
    ids=lambda value: "-".join(map(str, value.values())) if isinstance(value, dict) else "",
)
def test_ten_frequencies(options, tolerance, binary, tmp_path):
    """Lap joints without contact, their plates held by bolts and springs alone."""
    description = lap_joint_assembly(**{"element_size": 5.0, "bolt_mass": False, **options})
    write_deck(description, tmp_path / "joint.inp", modes=10)
    theirs = run_calculix(binary, tmp_path / "joint.inp").frequencies
    np.testing.assert_allclose(
        theirs, circular_frequencies(description.assembly, 10) / (2 * np.pi), rtol=tolerance
    )


def matrices_of_one(kind, element, binary, path):
    """K and M of one skew solid: CalculiX's, ours at the translations of its nodes, our mass."""
    shape = np.array([[2.0, 0.1, 0.0], [0.2, 3.0, 0.1], [0.0, 0.3, 4.0]])
    nodes = np.array(SOLIDS[kind].reference_nodes) @ shape
    n = len(nodes)
    block = CellBlock(kind=kind, nodes=[range(n)], ids=[1], properties=[1])
    mesh = Mesh(nodes=nodes, node_ids=np.arange(1, n + 1), blocks=(block,))
    solid = Assembly(mesh=mesh, materials={1: STEEL}, element=element)
    write_deck(JointDescription(assembly=solid), path, modes=1)
    path.write_text(path.read_text().replace("*FREQUENCY", "*FREQUENCY,SOLVER=MATRIXSTORAGE"))
    run_calculix(binary, path)
    theirs = [stored(path.with_suffix(suffix)) for suffix in (".sti", ".mas")]
    nodal = assemble_matrices(solid)
    used = np.flatnonzero(np.arange(6 * n) % 6 < 3)
    return theirs, [m.toarray()[np.ix_(used, used)] for m in (nodal.K, nodal.M)]


def stored(path):
    """Read a symmetric matrix of CalculiX: row, column, value."""
    table = np.loadtxt(path)
    i, j = table[:, :2].astype(int).T - 1
    matrix = np.zeros((i.max() + 1, i.max() + 1))
    matrix[i, j] = matrix[j, i] = table[:, 2]
    return matrix


def assert_same(found, wanted):
    """Fourteen digits are stored; condensation loses one."""
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12 * wanted.max())


@pytest.mark.parametrize(
    ("kind", "formulation"),
    [
        ("hex8", "standard"),
        ("hex8", "reduced"),
        ("hex20", "standard"),
        ("hex20", "reduced"),
        ("tet4", "standard"),
        ("tet10", "standard"),
        ("wedge15", "standard"),
    ],
)
def test_matrices_of_solids(kind, formulation, binary, tmp_path):
    """CalculiX integrates some masses with fewer points; all else is the same."""
    (K, M), (stiffness, mass) = matrices_of_one(kind, formulation, binary, tmp_path / "one.inp")
    assert_same(K, stiffness)
    if kind.startswith("hex") and formulation == "standard":
        assert_same(M, mass)
    assert M.sum() == pytest.approx(mass.sum(), rel=1e-12)


def test_c3d8i_is_our_brick_but_for_the_mass_of_its_modes(binary, tmp_path):
    """CalculiX stores the incompatible modes as three more nodes."""
    theirs, (stiffness, mass) = matrices_of_one("hex8", "incompatible", binary, tmp_path / "i.inp")
    K, M = theirs
    corner, mode = slice(24), slice(24, 33)
    assert_same(
        K[corner, corner] - K[corner, mode] @ np.linalg.solve(K[mode, mode], K[mode, corner]),
        stiffness,
    )
    assert_same(M[corner, corner], mass)
    # (1 - ξ²)² with two points a direction: 4/9 of the mass each, where faying's modes have none.
    np.testing.assert_allclose(np.diag(M)[mode], 4 / 9 * mass[::3, ::3].sum(), rtol=1e-12)


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
        point_shape=table,
        initial_gap=np.zeros(n_point),
        weights=np.tile(weights, n_face) * area / weights.sum(),
        points=np.zeros((n_point, 3)),
        normals=np.tile(interface.normals[0], (n_point, 1)),
        face_of_point=np.repeat(np.arange(n_face), len(at)),
        quadrature="calculix",
    )


def from_deck(path, step):
    """Model, bolt forces and load of a step of a deck, nothing added to what the deck says."""
    joint = read_joint(path, step=step)
    selected = joint.assembly.loads.get(joint.selected_load)
    forces, boundaries = {}, []
    for nodes, values in [] if selected is None else [(selected.nodes, selected.forces)]:
        for number, row in zip(joint.assembly.mesh.node_ids[nodes].tolist(), values, strict=True):
            boundaries.append(fy.BoundarySpec(name=f"n{number}", node=number))
            forces |= {f"n{number}.{FORCE_NAMES[c]}": row[c] for c in np.flatnonzero(row)}
    model = build_model(
        joint.assembly, interfaces=joint.interfaces, bolts=joint.bolts, boundaries=boundaries
    )
    return model, joint.preloads, fy.Load(forces)


def solved(path, step, data):
    """What faying makes of a step of a deck with CalculiX's contact points."""
    model, preloads, load = from_deck(path, step)
    ((name, interface),) = model.interfaces.items()
    model = model.with_interfaces({name: ccx_rule(interface, data)})
    return fy.solve_static(fy.preload(model, preloads), load)


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


@pytest.fixture(scope="module", params=PARAMS, ids="-".join)
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


@pytest.mark.long
def test_single_increment_agrees_to_the_digits_printed(both, binary, tmp_path):
    """With no step before it CalculiX solves the same small-displacement problem."""
    _, text, preloaded, solution, _ = both
    control = max(preloaded.displacements[1])  # the last node is the bolt's pretension node
    path = tmp_path / "one.inp"
    path.write_text(in_one_increment(text, control, preloaded.displacements[1][control][0]))
    check(solution, run_calculix(binary, path), 1, PRINTED)


@pytest.mark.slow
def test_friction_in_one_increment(binary, data, tmp_path):
    """Tightening, then bolt and load case in one increment: displacements, pressures, tractions."""
    path, one = tmp_path / "joint.inp", tmp_path / "one.inp"
    smooth = cantilever("incompatible", "LC2")
    (spec,) = smooth.interfaces
    rough = replace(spec, friction=0.2, tangential_penalty=8e5)
    write_deck(replace(smooth, interfaces=(rough,)), path)
    text = path.read_text()
    theirs = run_calculix(binary, path)
    model, preloads, load = from_deck(path, 2)
    assert model.interfaces["joint"].law == Coulomb(Penalty(1e6), 0.2, 8e5)
    model = model.with_interfaces({"joint": ccx_rule(model.interfaces["joint"], data)})
    tight = tightened_joint(model, preloads, increments=1)
    control = max(theirs.displacements[1])
    one.write_text(in_one_increment(text, control, theirs.displacements[1][control][0]))
    loaded = fy.solve_path(model.with_bolt_forces(tight.tightening.initial_forces), [load])
    for found, run in ((tight.rest(model), theirs), (loaded, run_calculix(binary, one))):
        check(last_of(found), run, 1, PRINTED)
        mine = np.sort(np.linalg.norm(found.traction[-1], axis=-1))[::-1]
        printed = np.sort(run.tractions[1])[::-1]  # of points in contact alone, in another order
        assert printed[0] > 0
        # Both come from displacements and penalties of one size.
        small = PRINTED * run.pressures[1].max()
        np.testing.assert_allclose(mine[: len(printed)], printed, rtol=0, atol=small)
    assert loaded.dissipation[-1] > 1e3 * tight.rest(model).dissipation.sum()


def test_initial_interference(binary, data, tmp_path):
    """A negative initial gap, *CLEARANCE in the deck; the bolt has to close less."""
    path = tmp_path / "joint.inp"
    joint = cantilever("standard", "LC1")
    (spec,) = joint.interfaces
    closer = replace(spec, gap=GapRule(offset=-2e-3))
    write_deck(replace(joint, interfaces=(closer,)), path)
    theirs = run_calculix(binary, path)
    model, preloads, _ = from_deck(path, 1)
    assert [spec.gap for spec in read_joint(path).interfaces] == [GapRule(value=-2e-3)]
    interface = ccx_rule(model.interfaces["joint"], data).with_initial_gap(-2e-3)
    tightened = fy.preload(model.with_interfaces({"joint": interface}), preloads)
    check(fy.solve_static(tightened), theirs, 1, PRINTED)


@pytest.mark.long
@pytest.mark.parametrize("element", ["standard", "incompatible"])
def test_pressure_and_force_of_a_step_as_one_load(element, binary, data, tmp_path):
    """*DLOAD on the top and *CLOAD at the tip, with contact; the step is a load of the model."""
    path, one = tmp_path / "joint.inp", tmp_path / "one.inp"
    write_deck(cantilever(element, "LC1"), path)
    start = path.read_text()
    case = start.index("** LC1")
    assert "*CLOAD\n" in start[case:]
    pressed = "*DLOAD\n" + "".join(f"{brick},P2,{PRESSED}\n" for brick in bricks_on_top(path))
    text = start[:case] + start[case:].replace("*CLOAD\n", f"{pressed}*CLOAD\n", 1)
    path.write_text(text)
    joint = read_joint(path)
    assert joint.selected_load == "step 2"
    model = build_model(joint.assembly, interfaces=joint.interfaces, bolts=joint.bolts)
    ((name, interface),) = model.interfaces.items()
    model = model.with_interfaces({name: ccx_rule(interface, data)}).with_deck_loads("step 2")
    tightened = fy.preload(model, joint.preloads)
    solution = fy.solve_static(tightened, fy.Load({"step 2": 1.0}))
    without = fy.solve_static(tightened)
    assert abs(solution.max_pressure - without.max_pressure) > 0.02 * without.max_pressure
    preloaded = run_calculix(binary, path).displacements[1]
    control = max(preloaded)
    one.write_text(in_one_increment(text, control, preloaded[control][0]))
    # The edge presses a point of the stiffer bricks harder, and its place decides: 9e-4.
    peak = 3e-3 if element == "standard" else None
    check(solution, run_calculix(binary, one), 1, FOLLOWS, pressure=peak)


def bricks_on_top(path):
    """Element ids of the bricks whose second face (nodes 5 to 8) is the top beyond the washer."""
    mesh = read_joint(path).assembly.mesh
    for block in mesh.blocks:
        upper = mesh.nodes[block.nodes[:, 4:]]
        top = np.isclose(upper[:, :, 2], mesh.nodes[:, 2].max()).all(axis=1)
        yield from block.ids[top & (upper[:, :, 0].min(axis=1) > 5)].tolist()


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_fine_cantilever(case, binary, data, tmp_path):
    """2.5 mm bricks with incompatible modes: 1824 bricks, 148 node pairs."""
    path, one = tmp_path / "joint.inp", tmp_path / "one.inp"
    write_deck(cantilever("incompatible", case, 2.5), path)
    text = path.read_text()
    theirs = run_calculix(binary, path)
    solution = solved(path, 2, data)
    # 1.6 and 2.5 % of the largest pressure are measured: the finer the mesh at the edge, the more
    # the geometry CalculiX updates between the steps decides about its last point.
    check(solution, theirs, 2, GEOMETRY, pressure=0.03)
    control = max(theirs.displacements[1])
    one.write_text(in_one_increment(text, control, theirs.displacements[1][control][0]))
    check(solution, run_calculix(binary, one), 1, PRINTED)
