"""Two blocks on each other whose meshes do not match, and loads with known answers."""

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sl

from faying.contact.laws import normal_law
from faying.interface.facets import area_vectors, gauss_rule, shape_functions
from faying.interface.mortar import build_mortar_interface, find_couplings
from faying.joint.build import build_model
from faying.model.assembly import Assembly, Material, Support
from faying.model.dofs import DofMap
from faying.model.generate import Cells, brick_grid, shaped
from faying.model.specs import InterfaceSpec
from solid_blocks import stacked

STEEL = Material(youngs_modulus=210000.0, poissons_ratio=0.29, density=7.82e-9)
SIZE = np.array([10.0, 8.0, 3.0])
"""Length, width and height of each block; they meet at z = 0."""

SPEC = InterfaceSpec(name="joint", minus="lower", plus="upper", meshes="non-matching", penalty=1e5)


def block(counts, kind, level, distort, seed):
    """One block from z = level * height; nodes inside moved along the surface, not its rim."""
    half = SIZE[:2] / 2
    lines = [np.linspace(-h, h, n + 1) for h, n in zip(half, counts, strict=True)]
    cells = brick_grid(*lines, z=SIZE[2] * np.array([level, level + 1.0]))
    nodes = cells.nodes.copy()
    columns, column = np.unique(nodes[:, :2].round(9), axis=0, return_inverse=True)
    inner = (np.abs(np.abs(columns) - half) > 1e-6).all(axis=1)
    shift = np.random.default_rng(seed).uniform(-distort, distort, columns.shape)
    shift = shift * inner[:, None] * 2 * half / np.array(counts)
    nodes[:, :2] += shift[column.ravel()]
    return shaped(Cells(kind=cells.kind, nodes=nodes, cells=cells.cells), kind)


def blocks(lower, upper, *, distort=0.0, move=None):
    """Assembly of two blocks, each (counts in the plane, kind); ``move`` places the upper one."""
    parts = [block(*lower, level=-1, distort=distort, seed=0)]
    parts.append(block(*upper, level=0, distort=distort, seed=1))
    if move is not None:
        parts[1] = replace(parts[1], nodes=move(parts[1].nodes))
    mesh = stacked(*parts, names=("lower", "upper"))
    return Assembly(mesh=mesh, materials={1: STEEL, 2: STEEL}, element="standard")


def bent(assembly, shape):
    """The same blocks with their nodes moved by a function of position."""
    return replace(assembly, mesh=replace(assembly.mesh, nodes=shape(assembly.mesh.nodes)))


def turned(angle, scale=1.0, offset=(0.0, 0.0)):
    """A placement of the upper block: turned about z, scaled in the plane, shifted."""
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) * [scale, scale, 1.0]
    return lambda nodes: nodes @ matrix + [*offset, 0.0]


def unconstrained(assembly):
    size = 6 * len(assembly.mesh.nodes)
    return DofMap(transformation=sp.eye_array(size, format="csr"), free=np.arange(size))


def mortar(assembly, penalty=1e5, **options):
    """The one interface of an assembly, over all six components of all nodes."""
    spec = replace(SPEC, **options)
    (coupling,) = find_couplings(assembly, spec).values()
    return build_mortar_interface(
        assembly, unconstrained(assembly), spec, coupling, normal_law(penalty)
    )


def nodal_forces(joint, pressure):
    """Contact forces Gᵀλ (n_node, 3) of a pressure at the points."""
    forces = joint.gap_operator.T @ (joint.weights * pressure)
    return forces.reshape(-1, 6)[:, :3]


def pressure_loads(assembly, facets, pressure):
    """Consistent nodal loads (n_node, 3) of a pressure on facets."""
    nodes = assembly.mesh.nodes
    loads = np.zeros_like(nodes)
    for kind, table in facets.by_kind().items():
        rule = gauss_rule(kind)
        vectors = area_vectors(kind, nodes[table], rule.points) * rule.weights[:, None]
        shares = np.einsum("qa,fqd->fad", shape_functions(kind, rule.points), vectors)
        np.add.at(loads, table, -pressure * shares)
    return loads


def squeezed(flat, penalty, *, pressure=100.0, curve=None, quadrature=None):
    """Model and loads of blocks under the same pressure from all sides, held statically.

    The stress is uniform and the contact pressure the same everywhere, whatever the shape of the
    surface between the blocks.
    """
    assembly = flat if curve is None else bent(flat, curve)
    before = flat.mesh.nodes
    centre = [np.flatnonzero(np.abs(before[:, axis]) < 1e-9) for axis in (0, 1)]
    foot = np.flatnonzero((np.abs(before - [0, 0, -SIZE[2]]) < 1e-9).all(axis=1))
    supports = [Support(id=i + 1, nodes=one, components=(i,)) for i, one in enumerate(centre)]
    supports.append(Support(id=3, nodes=foot, components=(2,)))
    model = build_model(
        replace(assembly, supports=tuple(supports)),
        interfaces=[replace(SPEC, penalty=penalty, quadrature=quadrature)],
    )
    outside = assembly.mesh.exterior
    touching = (np.abs(before[outside.nodes[:, :3], 2]) < 1e-9).all(axis=1)
    loads = np.zeros((len(before), 6))
    loads[:, :3] = pressure_loads(assembly, outside.taken(~touching), pressure)
    return model, model.dofs.transformation.T @ loads.ravel()


def all_closed(model, loads):
    """Contact pressures with every point in contact, by one sparse direct solution.

    Written down here once more, so that it is independent of the solvers of the package.
    """
    joint = model.interfaces["joint"]
    G, gap, weights = joint.gap_operator, joint.initial_gap, joint.weights
    if np.isinf(joint.penalty):
        saddle = sp.bmat([[model.K, -G.T], [-G, None]]).tocsc()
        forces = sl.spsolve(saddle, np.concatenate([loads, gap]))[len(loads) :]
        return forces / weights
    springs = sp.diags_array(joint.penalty * weights)
    u = sl.spsolve((model.K + G.T @ springs @ G).tocsc(), loads - G.T @ (springs @ gap))
    return -joint.penalty * (G @ u + gap)
