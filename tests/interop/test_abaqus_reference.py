"""The decks CalculiX ran for the reference solutions: same matrices, same displacements."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.spatial import cKDTree

import faying as fy
from faying.io.abaqus import read_joint

AXIAL = 296880.50576423545  # EA/L of the bolt, case.json
RULES = {"gauss2": "gauss", "lobatto": "nodal"}
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


@pytest.fixture(scope="module", params=["P0", "LC2"])
def deck(request, data):
    return request.param, read_joint(data / "lap_joint" / f"{request.param}.inp")


def test_matrices_before_constraints_are_those_of_the_reference(data):
    described = read_joint(data / "lap_joint" / "P0.inp")
    assembly = described.assembly
    # Both plates alone: without bolt, couplings and supports, as K_free was made.
    bare = replace(assembly, springs=(), equations=(), supports=())
    model = fy.build_model(bare, interfaces=described.interfaces)
    expected_nodes = np.load(data / "lap_joint" / "mesh.npz")["nodes"]
    np.testing.assert_array_equal(assembly.mesh.nodes[:2790], expected_nodes)
    for name in ("K", "M"):
        expected = sp.load_npz(data / "lap_joint" / f"{name}_free.npz")
        difference = abs(getattr(model, name) - expected)
        # The same element summed in another order: rounding.
        assert difference.max() < 1e-13 * abs(expected).max()


@pytest.mark.parametrize("rule", RULES)
def test_the_deck_gives_the_reference_solution(deck, data, rule):
    case, described = deck
    assembly = described.assembly
    (interface,) = described.interfaces
    assert (interface.minus, interface.plus, interface.penalty) == ("SMINUS", "SPLUS", 1e6)
    (load,) = assembly.loads.values()
    ids = assembly.mesh.node_ids[load.nodes]
    model = fy.build_model(
        assembly,
        interfaces=[replace(interface, quadrature=RULES[rule])],
        boundaries=[fy.BoundarySpec(name=str(node), node=int(node)) for node in ids],
    )
    forces = {
        f"{node}.F{axis}": float(value)
        for node, row in zip(ids, load.forces, strict=True)
        for axis, value in zip("xyz", row[:3], strict=True)
        if value
    }
    solution = fy.solve_static(model, fy.Load(forces))
    expected = np.load(data / "lap_joint" / f"{case}.npz")
    u = model.dofs.nodal(solution.states)[:, :3]
    # The README of the data promises 1e-6 of the largest; round-off is measured.
    np.testing.assert_allclose(
        u[:2790], expected[f"u__{rule}"], rtol=0, atol=1e-6 * np.abs(expected[f"u__{rule}"]).max()
    )
    mesh = np.load(data / "lap_joint" / "mesh.npz")
    faces = mesh["nodes"][mesh["pairs"][mesh["faces"], 0]]
    at = CORNERS if rule == "lobatto" else mesh["quad_gauss2"]
    shape = np.prod(1 + CORNERS[None] * at[:, None], axis=2) / 4
    places = np.einsum("qn,fnd->fqd", shape, faces).reshape(-1, 3)
    _, index = cKDTree(places).query(model.interfaces["SI"].points)
    pressure = expected[f"p_quad__{rule}"][index]
    # 1e-5 of the peak as the README of the data promises.
    np.testing.assert_allclose(solution.pressure, pressure, rtol=0, atol=1e-5 * pressure.max())
