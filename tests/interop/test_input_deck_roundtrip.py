"""Input decks that faying writes are the same joint when it reads them."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import FormatError
from faying.io.abaqus import read_joint
from faying.io.abaqus.writer import write_deck
from faying.joint.build import build_model
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import (
    Assembly,
    Equation,
    MatrixBlock,
    NodalLoads,
    PointMass,
    Spring,
    Support,
)
from faying.model.description import JointDescription
from linear_solution import circular_frequencies

DIGITS = 1e-9
"""Thirteen digits are written; a stiff bolt and a small residual take some of them."""


def joint(**options):
    description = lap_joint_assembly(**{"element_size": 5.0, "bolt_mass": False, **options})
    tip = description.assembly.rigid_couplings[0].reference
    loads = {"pull": NodalLoads(nodes=[tip], forces=[[0, 0, -300.0, 0, 0, 0]])}
    return replace(
        description,
        assembly=replace(description.assembly, loads=loads),
        preloads={spec.name: 5e3 for spec in description.bolts},
    )


def model_of(description, tip):
    return build_model(
        description.assembly,
        interfaces=description.interfaces,
        bolts=description.bolts,
        boundaries=[fy.BoundarySpec(name="tip", node=tip)],
    )


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"element": "standard", "washer": "rbe3", "penalty": 1e5},
        {"shape": "hex20", "element_size": 10.0, "washer_radius": 9.0, "shear_flexible": False},
        {"shape": "tet10", "element_size": 10.0, "washer_radius": 9.0, "curvature": 0.002},
        {"shape": "tet4", "penalty": "hard"},
        {"shape": "wedge6", "bolt_positions": ((-8.0, 0.0), (8.0, 0.0))},
    ],
    ids=lambda options: "-".join(map(str, options.values())) or "default",
)
def test_preloaded_lap_joint(options, tmp_path):
    wanted = joint(**options)
    write_deck(wanted, tmp_path / "joint.inp")
    found = read_joint(tmp_path / "joint.inp")
    tip = int(wanted.assembly.mesh.node_ids[wanted.assembly.rigid_couplings[0].reference])
    load = fy.Load({"tip.Fz": -300.0})
    solutions = []
    for description in (wanted, found):
        model = model_of(description, tip)
        solutions.append(fy.solve_static(fy.preload(model, description.preloads), load))
    ours, theirs = solutions
    assert theirs.displacement("tip")[2] == pytest.approx(ours.displacement("tip")[2], rel=1e-5)
    # The beam that stays in the cut adds 1e-4 to the bolt's compliance, which the load meets.
    assert theirs.contact_force() == pytest.approx(ours.contact_force(), rel=1e-5)
    assert theirs.max_pressure == pytest.approx(ours.max_pressure, rel=1e-4)
    (loads,) = found.assembly.loads.values()
    np.testing.assert_array_equal(loads.forces, [[0, 0, -300.0, 0, 0, 0]])


def test_springs_masses_equations_and_supports(tmp_path):
    description = lap_joint_assembly(element_size=5.0, bolt_mass=False)
    tip = description.assembly.rigid_couplings[0].reference
    c, s = np.cos(0.3), np.sin(0.3)
    assembly = replace(
        description.assembly,
        springs=(
            Spring(id=900, ends=((tip, 2),), stiffness=1e3 / 7),
            Spring(id=901, ends=((tip, 3),), stiffness=1e6 / 7),
            Spring(id=902, ends=((20, 0), (60, 0)), stiffness=1e4 / 3),
        ),
        masses=(PointMass(id=903, node=tip, mass=1e-5 / 3),),
        equations=(Equation(id=1, terms=((30, 1, 1.0), (31, 1, -1 / 3), (tip, 4, 0.2))),),
        supports=(
            *description.assembly.supports,
            Support(
                id=2,
                nodes=np.array([50]),
                components=(0,),
                axes=np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]),
            ),
        ),
    )
    write_deck(JointDescription(assembly=assembly), tmp_path / "joint.inp", modes=6)
    found = read_joint(tmp_path / "joint.inp").assembly
    np.testing.assert_allclose(
        circular_frequencies(found, 6), circular_frequencies(assembly, 6), rtol=DIGITS
    )
    assert set(found.mesh.node_sets) >= {"CLAMP", "TIP-FACE"}


def test_mass_of_a_bolt_goes_to_its_ends(tmp_path):
    description = lap_joint_assembly(element_size=10.0, washer_radius=9.0)
    write_deck(description, tmp_path / "joint.inp")
    (first, second) = read_joint(tmp_path / "joint.inp").assembly.masses
    assert first.mass == second.mass == pytest.approx(7.82e-9 * np.pi * 9 * 20 / 2, rel=1e-12)


def refused(description, tmp_path, match, **options):
    with pytest.raises(FormatError, match=match):
        write_deck(description, tmp_path / "joint.inp", **options)
    assert not list(tmp_path.iterdir())


def test_what_a_deck_cannot_say_is_refused_by_name(tmp_path):
    good = joint()
    assembly = good.assembly
    eye = np.eye(1)
    block = MatrixBlock(M=eye, K=eye, nodes=[0], components=[0])
    given = JointDescription(assembly=Assembly(mesh=assembly.mesh, matrices=block))
    refused(given, tmp_path, "has matrices from another program")
    refused(replace(good, preloads={"M6": 1.0}), tmp_path, "no bolt 'M6' to preload")
    (spec,) = good.interfaces
    mortar = replace(spec, meshes="non-matching")
    refused(replace(good, interfaces=(mortar,)), tmp_path, "'joint' is non-matching")
    turned = replace(assembly.beams[0], orientation=(1.0, 0.5, 0.0))
    leaning = replace(good, assembly=replace(assembly, beams=(turned,)))
    refused(leaning, tmp_path, f"beam {turned.id} or its section is not along coordinate axes")
    twist = {"twist": NodalLoads(nodes=[0], forces=[[0, 0, 0, 1.0, 0, 0]])}
    refused(good, tmp_path, "node 1 has no rotations", loads=twist)
    heavy = PointMass(id=999, node=0, mass=1.0, inertia=((1.0, 0, 0), (0, 0, 0), (0, 0, 0)))
    weighted = replace(good, assembly=replace(assembly, masses=(heavy,)))
    refused(weighted, tmp_path, "point mass 999 has inertia")
    bare = replace(good, assembly=replace(assembly, materials={}))
    with pytest.raises(FormatError, match="property 1 has no material"):
        write_deck(replace(bare, bolts=(), preloads={}), tmp_path / "joint.inp")
    with pytest.raises(FormatError, match="cannot write"):
        write_deck(good, tmp_path / "no" / "joint.inp")
