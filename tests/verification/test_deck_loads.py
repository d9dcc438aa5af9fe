"""Loads of a deck with contact: full and reduced models against forces at single nodes."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.assessment.energy import energy_balance
from faying.io.nastran.reader import read_parts
from faying.io.nastran.writer import write_deck
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import NodalLoads
from faying.model.boundary import FORCE_NAMES
from faying.reduction.recovery import recovery_operator
from faying.simulation.newton import solve_static_newton
from lap_joints import tiny_lap

PRESSURE, PULL = 2.5, np.array([40.0, -30.0, 25.0])
SAME = 1e-9
"""Of the largest value: both are solved to round-off, with condition numbers of 1e6 or so."""

STATIC = fy.Load({"5": 0.8, "tip.Fz": -60.0})
PENALTIES = [1e4, "auto", "hard"]


@pytest.fixture(scope="module")
def description():
    """The cantilever, with the nodes and bricks of the top near the overlap."""
    return lap_joint_assembly(element_size=5.0)


@pytest.fixture(scope="module")
def deck(description, tmp_path_factory):
    """A deck with pressure on the top, a force at a grid in other axes, and both together."""
    path = tmp_path_factory.mktemp("deck") / "joint.bdf"
    write_deck(description.assembly, path)
    mesh = description.assembly.mesh
    cards = ["CORD2R,7,,0.,0.,0.,0.,0.,1.", ",0.,1.,0."]
    cards += [
        f"PLOAD4,1,{mesh.element_ids[element]},{PRESSURE},,,,{corners[0]},{corners[2]}"
        for element, corners in top_faces(mesh)
    ]
    # x of system 7 is y of the basic frame, y is -x.
    cards.append(f"FORCE,2,{pulled(mesh)},7,1.,{PULL[1]},{-PULL[0]},{PULL[2]}")
    cards.append("LOAD,5,2.,1.5,1,.5,2")
    text = path.read_text()
    path.write_text(text.replace("ENDDATA", "\n".join([*cards, "ENDDATA"])))
    return path


def top_faces(mesh):
    """Bricks below the top, x > 5, with the grids of their top faces in order round."""
    (block,) = mesh.blocks
    top = mesh.nodes[:, 2].max()
    for element, nodes in enumerate(block.nodes):
        upper = nodes[4:]
        if np.allclose(mesh.nodes[upper, 2], top) and mesh.nodes[upper, 0].min() > 5:
            yield element, mesh.node_ids[upper].tolist()


def pulled(mesh):
    """A grid in the middle of the lower plate."""
    place = [-20.0, 0.0, mesh.nodes[:, 2].min()]
    return int(mesh.node_ids[np.linalg.norm(mesh.nodes - place, axis=1).argmin()])


def nodal_forces(mesh):
    """Forces of LOAD 5 by hand: a quarter of each rectangle's pressure to each of its corners."""
    forces = {}
    for _, corners in top_faces(mesh):
        place = mesh.nodes[mesh.node_index(np.array(corners))]
        area = np.linalg.norm(place[1] - place[0]) * np.linalg.norm(place[2] - place[1])
        for corner in corners:
            forces[corner] = forces.get(corner, 0.0) - np.array([0, 0, 3.0 * PRESSURE * area / 4])
    node = pulled(mesh)
    return {**forces, node: forces.get(node, 0.0) + PULL}


def at_independent_nodes(assembly):
    """Forces and moments of LOAD 5 (6,), those on rigid couplings taken to their references."""
    mesh, found = assembly.mesh, {}
    follows = {
        int(node): coupling.reference
        for coupling in assembly.rigid_couplings
        for node in coupling.nodes
    }
    for number, force in nodal_forces(mesh).items():
        node = int(mesh.node_index(np.array([number]))[0])
        carrier = follows.get(node, node)
        moment = np.cross(mesh.nodes[node] - mesh.nodes[carrier], force)
        carried = int(mesh.node_ids[carrier])
        found[carried] = found.get(carried, 0.0) + np.concatenate([force, moment])
    return found


@pytest.fixture(scope="module", params=PENALTIES)
def loaded(request, deck, description):
    """The deck's model, tightened, with its loads."""
    model = fy.read_nastran(
        deck,
        interfaces=[fy.InterfaceSpec(name="joint", penalty=request.param)],
        bolts=description.bolts,
        boundaries=description.boundaries,
    )
    return fy.preload(model.with_deck_loads("5", "2"), {"bolt": 8e3})


@pytest.fixture(scope="module")
def full(loaded):
    return fy.solve_static(loaded, STATIC)


def close(found, wanted, tolerance=SAME):
    scale = np.abs(wanted).max()
    assert scale > 0
    np.testing.assert_allclose(found, wanted, rtol=0, atol=tolerance * scale)


def test_same_as_forces_at_single_nodes_by_full_newton(loaded, full):
    """Every loaded node is a boundary there, and no pattern and no port takes part."""
    forces = at_independent_nodes(loaded.assembly)
    assert len(forces) > 10
    interfaces = [
        fy.InterfaceSpec(name=name, penalty="hard" if np.isinf(one.penalty) else one.penalty)
        for name, one in loaded.interfaces.items()
    ]
    element = loaded.assembly.beams[0].id
    witness = fy.build_model(
        replace(loaded.assembly, loads={}),
        interfaces=interfaces,
        bolts=[fy.BoltSpec(name="bolt", elements=(element,))],
        boundaries=[fy.BoundarySpec(name=f"n{node}", node=node) for node in forces],
    ).with_bolt_forces({"bolt": loaded.bolts["bolt"].initial_force})
    tip = int(loaded.boundaries["tip"].nodes[0])
    forces = {node: 0.8 * force for node, force in forces.items()}
    forces[tip] = forces[tip] + np.array([0, 0, -60.0, 0, 0, 0])
    load = {
        f"n{node}.{name}": value
        for node, force in forces.items()
        for name, value in zip(FORCE_NAMES, force.tolist(), strict=True)
        if value
    }
    expected = solve_static_newton(witness, fy.Load(load))
    close(full.pressure, expected.pressure)
    close(
        loaded.dofs.nodal(full.states),
        witness.dofs.nodal(expected.states),
    )
    assert full.bolt_force("bolt") == pytest.approx(float(expected.bolt_force("bolt")), rel=SAME)


@pytest.mark.parametrize("method", ["compliance", "jim-a+compliance"])
def test_reduced_model_with_compliance_is_exact_in_statics(loaded, full, method):
    basis = fy.craig_bampton(loaded, normal_modes=6)
    if method.startswith("jim-a"):
        basis = fy.jim_a(loaded, joint_modes=3, classic=basis, subarea_count=20)
    rom = fy.reduce(loaded, basis, compliance=True)
    reduced = fy.solve_static(rom, STATIC)
    close(reduced.pressure, full.pressure)
    close(reduced.displacement("tip"), full.displacement("tip"))
    assert reduced.bolt_force("bolt") == pytest.approx(float(full.bolt_force("bolt")), rel=SAME)


def test_final_preload_does_not_feel_the_patterns(loaded):
    assert fy.solve_static(loaded).bolt_force("bolt") == pytest.approx(8e3, rel=1e-9)


def test_certificate_and_worst_direction_know_the_load(loaded, full):
    exact = fy.certify(loaded, STATIC, full.pressure)
    assert exact.max_relative_error < 1e-6  # round-off of an energy is squared
    other = fy.solve_static(loaded, fy.Load({"5": 0.75, "tip.Fz": -60.0}))
    error = np.abs(other.pressure - full.pressure).max() / full.max_pressure
    assert error > 1e-3
    assert fy.certify(loaded, STATIC, other.pressure).max_relative_error >= error


def test_full_model_gives_itself_back(loaded, full):
    recovered = fy.recover_pressure(loaded, full)
    close(recovered.pressure, full.pressure)
    work = np.array([one.forces @ full.states for one in loaded.load_patterns.values()])
    close(recovered.port_displacements[-2:], work)


HISTORY = fy.Load(
    {
        "5": fy.History([0.0, 2e-4, 6e-4], [0.0, 1.0, 0.4]),
        "2": fy.History([0.0, 4e-4], [0.0, 3.0]),
        "tip.Fz": -60.0,
    }
)
TIMES = {"step": 2e-5, "duration": 6e-4}


def test_reduced_history_that_spans_everything_is_the_full_one(small):
    """With all interior shapes as normal modes the reduced model is the full one, in other axes."""
    n_interior = len(small.structure.interior)
    basis = fy.craig_bampton(small, normal_modes=n_interior - 2)
    rom = fy.reduce(small, basis, compliance=True)
    full = fy.solve_transient(small, HISTORY, **TIMES)
    reduced = fy.solve_transient(rom, HISTORY, **TIMES)
    assert np.ptp(full.max_pressure) > 0.02 * full.max_pressure.max()
    close(reduced.pressure, full.pressure)


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A joint of few degrees of freedom, two of its loads as patterns."""
    model = tiny_lap(damping=fy.Rayleigh(beta=1e-6))
    forces = [[0, 0, -20.0, 0, 0, 0], [0, 15.0, 0, 0, 0, 0], [0, 0, 30.0, 0, 0, 0]]
    loads = {
        name: NodalLoads(nodes=nodes, forces=forces)
        for name, nodes in {"5": [60, 70, 80], "2": [40, 50, 63]}.items()
    }
    return fy.preload(model.with_load_patterns(loads), {"bolt": 5e3})


def test_energy_of_the_patterns_is_accounted_for(small):
    solution = fy.solve_transient(small, HISTORY, integrator=fy.GeneralizedAlpha(1.0), **TIMES)
    balance = energy_balance(solution)
    # Second-order sums of a response in 30 steps; without the patterns' work all of it is missing.
    assert np.abs(balance.numerical_dissipation).max() < 0.05 * np.abs(balance.work).max()


def test_recovery_of_a_reduced_history(small):
    rom = fy.reduce(small, fy.craig_bampton(small, normal_modes=30), compliance=True)
    solution = fy.solve_transient(rom, HISTORY, **TIMES)
    full = fy.solve_transient(small, HISTORY, **TIMES)
    recovered = fy.recover_pressure(small, solution)
    operator = recovery_operator(small, rom.basis)
    close(
        fy.recover_pressure(small, solution, operator=operator).pressure, recovered.pressure, 1e-12
    )
    assert fy.compare(recovered, full).max_relative_error < 0.02
    assert recovered.bolt_force("bolt").shape == solution.times.shape
    close(recovered.bolt_force("bolt"), full.bolt_force("bolt"), 1e-3)


def test_derivatives_by_bolts_stay_right(small):
    """Against central differences; the patterns only shift the state."""
    load, step = {"5": 1.0, "tip.Fz": -20.0}, 1.0
    solution = fy.solve_static(small, fy.Load(load))
    change = fy.sensitivity(small, solution).initial_bolt_forces
    assert change.lower[0] < -step < step < change.upper[0]
    force = small.bolts["bolt"].initial_force
    up, down = (
        fy.solve_static(small, fy.Load(load, bolt_forces={"bolt": force + sign * step}))
        for sign in (1, -1)
    )
    slope = (up.pressure - down.pressure) / (2 * step)
    close(change.pressure[:, 0], slope, 1e-7)  # a difference of 1e-4 of pressures to 1e-13


def test_derivatives_by_amplitudes(small):
    """Against central differences, where the range says that they are exact."""
    load, step = {"5": 1.0, "2": 0.5, "tip.Fz": -20.0}, 1e-3
    change = fy.sensitivity(small, fy.solve_static(small, fy.Load(load))).loads
    assert change.parameters[-2:] == ("5", "2")
    for name in ("5", "2"):
        column = change.parameters.index(name)
        assert change.lower[column] < -step < step < change.upper[column]
        up, down = (
            fy.solve_static(small, fy.Load({**load, name: load[name] + sign * step}))
            for sign in (1, -1)
        )
        # Differences of 1e-4 of pressures, displacements and forces to 1e-13.
        close(change.pressure[:, column], (up.pressure - down.pressure) / (2 * step), 1e-7)
        moved = (up.displacement("tip") - down.displacement("tip")) / (2 * step)
        close(change.displacement("tip")[:, column], moved, 1e-7)
        pulled = (up.bolt_force("bolt") - down.bolt_force("bolt")) / (2 * step)
        assert change.bolt_forces[0, column] == pytest.approx(float(pulled), rel=1e-6)


def test_load_sets_of_the_deck(deck):
    assembly = read_parts(deck, None).assembly
    total = {name: load.forces.sum(axis=0)[:3] for name, load in assembly.loads.items()}
    expected = sum(nodal_forces(assembly.mesh).values())
    close(total["5"], expected, 1e-12)
    close(total["2"], PULL, 1e-12)
