"""Joints judged: bolts against the bolted joint, clamp forces against the full model."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.assessment.certificate import certifier
from faying.exceptions import ModelError
from faying.joint.bolt_surroundings import surroundings
from faying.joint.build import build_model
from faying.model.assembly import Assembly, RigidCoupling, Spring, Support
from faying.model.generate import brick_grid
from faying.model.mesh import Mesh
from faying.reduction.projection import contact_surfaces
from solid_blocks import stacked

LOAD = fy.Load({"tip.Fx": 3e3, "tip.Fz": -400.0, "tip.Mx": 8e3}, name="pull and bend")
E, AREA, LENGTH, PENALTY, BOLT, PRELOAD = 210e3, 54.0, 8.0, 1e5, 4e5, 5e3


@pytest.fixture(scope="module")
def joint():
    return fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})


def sleeve(penalty=PENALTY, quadrature="gauss"):
    """Two blocks between rigid plates that only lift: bolt and blocks are springs side by side."""
    grid = brick_grid(
        np.array([0, 3.0, 5.0, 9.0]), np.array([0, 2.0, 6.0]), np.array([0, 2.5, 4.0])
    )
    n = len(grid.nodes)
    below = replace(grid, nodes=grid.nodes - [0, 0, 4.0])
    mesh = stacked(below, grid, beside=[[4.5, 3.0, -4.0], [4.5, 3.0, 4.0]])
    base, head = 2 * n, 2 * n + 1
    x, y, z = mesh.nodes[:base].T
    steel = fy.Material(youngs_modulus=E, poissons_ratio=0.3, density=7.8e-9)
    assembly = Assembly(
        mesh=mesh,
        materials={1: steel, 2: steel},
        supports=(
            Support(id=1, nodes=np.flatnonzero(x == 0), components=(0,)),
            Support(id=2, nodes=np.flatnonzero(y == 0), components=(1,)),
            Support(id=3, nodes=np.array([base]), components=(0, 1, 2, 3, 4, 5)),
            Support(id=4, nodes=np.array([head]), components=(0, 1, 3, 4, 5)),
        ),
        rigid_couplings=(
            RigidCoupling(id=1, reference=base, nodes=np.flatnonzero(z == -4), components=(2,)),
            RigidCoupling(id=2, reference=head, nodes=np.flatnonzero(z == 4), components=(2,)),
        ),
        springs=(Spring(id=99, ends=((base, 2), (head, 2)), stiffness=BOLT),),
    )
    model = build_model(
        assembly,
        interfaces=[fy.InterfaceSpec(name="joint", penalty=penalty, quadrature=quadrature)],
        bolts=[fy.BoltSpec(name="bolt", elements=(99,))],
        boundaries=[fy.BoundarySpec(name="head", node=head + 1)],
    )
    return fy.preload(model, {"bolt": PRELOAD})


def two_sleeves():
    """Two of them beside each other: each bolt crosses an interface of its own."""
    alone = sleeve()
    assembly = alone.assembly
    mesh, n = assembly.mesh, len(assembly.mesh.nodes)
    others = (
        replace(one, nodes=one.nodes + n, ids=one.ids + n, properties=one.properties + 2)
        for one in mesh.blocks
    )
    spring = assembly.springs[0]
    both = replace(
        assembly,
        mesh=Mesh(
            nodes=np.vstack([mesh.nodes, np.add(mesh.nodes, (20.0, 0, 0))]),
            node_ids=np.arange(2 * n) + 1,
            blocks=(*mesh.blocks, *others),
        ),
        materials=dict.fromkeys((1, 2, 3, 4), assembly.materials[1]),
        supports=assembly.supports
        + tuple(replace(s, id=s.id + 4, nodes=s.nodes + n) for s in assembly.supports),
        rigid_couplings=assembly.rigid_couplings
        + tuple(
            replace(c, id=c.id + 2, reference=c.reference + n, nodes=c.nodes + n)
            for c in assembly.rigid_couplings
        ),
        springs=(
            spring,
            replace(spring, id=100, ends=tuple((node + n, axis) for node, axis in spring.ends)),
        ),
    )
    beneath = int(np.flatnonzero((mesh.nodes == [5.0, 2.0, -1.5]).all(axis=1))[0])
    model = build_model(
        both,
        interfaces=[
            fy.InterfaceSpec(name="left", minus=1, plus=2, penalty=PENALTY),
            fy.InterfaceSpec(name="right", minus=3, plus=4, penalty=PENALTY),
        ],
        bolts=[
            fy.BoltSpec(name="left bolt", elements=(99,)),
            fy.BoltSpec(name="right bolt", elements=(100,)),
        ],
        boundaries=[
            fy.BoundarySpec(name="head", node=n),
            fy.BoundarySpec(name="block", node=beneath + 1),
        ],
    )
    return fy.preload(model, dict.fromkeys(model.bolts, PRELOAD))


PARTS = 1 / (LENGTH / (E * AREA) + 1 / (PENALTY * AREA))
"""Stiffness of blocks and contact in series."""


def test_load_factor_and_opening_are_those_of_the_bolted_joint():
    """Φ = k_S/(k_S + k_P), F_S = F_V + Φ F_A, F_K = F_V − (1 − Φ) F_A, open at F_V/(1 − Φ)."""
    model, phi = sleeve(), BOLT / (BOLT + PARTS)
    load = fy.Load({"head.Fz": 2e3}, name="lift")
    found = fy.assess(model, [load])
    bolt, face = found.bolts["bolt"], found.interfaces["joint"]
    # The preload is found to 1e-10 of itself.
    assert bolt.load_factors["lift"] == pytest.approx(phi, rel=1e-8)
    assert bolt.axial_loads["lift"] == pytest.approx(2e3, rel=1e-8)
    assert bolt.most == pytest.approx(PRELOAD + phi * 2e3, rel=1e-9)
    assert face.least_clamp == pytest.approx(PRELOAD - (1 - phi) * 2e3, rel=1e-9)
    opening = PRELOAD / (1 - phi) / 2e3
    assert face.opening["lift"] == pytest.approx(opening, rel=1e-9)


def test_bolts_have_no_load_factors_of_interfaces_they_do_not_cross():
    """A force on the lower block takes as much from the bolt as from the clamp force: F_A = 0."""
    loads = [fy.Load({"block.Fz": -500.0}, name="press"), fy.Load({"head.Fz": 2e3}, name="lift")]
    left, right = fy.assess(two_sleeves(), loads).bolts.values()
    assert set(left.load_factors) == {"lift"}
    assert left.load_factors["lift"] == pytest.approx(BOLT / (BOLT + PARTS), rel=1e-8)
    # The preload is found to 1e-10 of itself, forces are some hundred newtons.
    assert left.axial_loads["press"] == pytest.approx(0.0, abs=1e-4)
    assert not right.load_factors


@pytest.mark.long
def test_certified_clamp_forces_contain_the_full_models(joint):
    """In 1000 random cases of two bases that are off; of the better one they are narrower."""
    values = np.random.default_rng(2).uniform(-1, 1, (1000, 3)) * [2e3, 500.0, 20e3]
    loads = [
        fy.Load(dict(zip(("tip.Fx", "tip.Fz", "tip.Mx"), row, strict=True)), name=str(k))
        for k, row in enumerate(values)
    ]
    exact = fy.solve_static_cases(joint, loads).contact_force("joint")
    classic = fy.craig_bampton(joint, normal_modes=10)
    widths = []
    for basis in (classic, fy.jim_a(joint, joint_modes=40, classic=classic)):
        rom = fy.reduce(joint, basis)
        cases = fy.solve_static_cases(rom, loads)
        certificate = certifier(rom.joint).certify_inputs(cases.inputs, cases.pressure)
        low, high = certificate.contact_force["joint"].T
        assert ((low <= exact) & (exact <= high)).all()
        widths.append(float(np.median((high - low) / exact)))
    assert widths[1] < widths[0]


@pytest.mark.long
def test_clamp_forces_around_bolts_are_certified(pair):
    """In 1000 random cases: ranges that the full model has, in intervals from two bases off it."""
    values = np.random.default_rng(3).uniform(-1, 1, (1000, 3)) * [2e3, 500.0, 20e3]
    loads = [
        fy.Load(dict(zip(("tip.Fx", "tip.Fz", "tip.Mx"), row, strict=True)), name=str(k))
        for k, row in enumerate(values)
    ]
    exact = fy.solve_static_cases(pair, loads)
    areas = surroundings(contact_surfaces(pair), pair.bolts)
    assert set(areas) == {("joint", name) for name in pair.bolts}
    forces = {area: exact.contact_forces[:, points].sum(axis=1) for area, points in areas.items()}
    whole = exact.contact_force("joint")
    assert sum(forces.values()) == pytest.approx(whole, rel=1e-12)
    classic = fy.craig_bampton(pair, normal_modes=10)
    widths = []
    for basis in (classic, fy.jim_a(pair, joint_modes=40, classic=classic)):
        cases = fy.solve_static_cases(rom := fy.reduce(pair, basis), loads)
        certificate = certifier(rom.joint).certify_inputs(cases.inputs, cases.pressure, areas)
        for area, force in forces.items():
            low, high = certificate.area_force[area].T
            assert ((low <= force) & (force <= high)).all()
            widths.append(float(np.median(high - low)))
    assert max(widths[2:]) < min(widths[:2])
    # What is assessed is certified by the full model at its ports.
    found = fy.assess(rom, loads[:100], paths=False)
    for name, bolt in found.bolts.items():
        around, true = bolt.clamp_around["joint"], forces["joint", name]
        for case, ends in (
            (around.least_case, around.certified_least),
            (around.most_case, around.certified_most),
        ):
            # Both solutions are exact to their round-off.
            assert ends[0] - 1e-6 <= true[int(case)] <= ends[1] + 1e-6
            assert ends[1] - ends[0] <= around.certified_width
        # The root of the round-off of an energy, 1e-8, with room.
        assert around.certified_width < 1e-6 * around.preload
    face = found.interfaces["joint"]
    low, high = face.certified_most
    assert low - 1e-6 <= whole[int(face.most_clamp_case)] <= high + 1e-6
    assert face.certified_width < 1e-6 * face.preload


def test_clamp_ranges_are_those_of_the_cases(pair):
    values = np.random.default_rng(4).uniform(-1, 1, (20, 2)) * [2e3, 500.0]
    loads = [
        fy.Load({"tip.Fx": pull, "tip.Fz": bend}, name=str(k))
        for k, (pull, bend) in enumerate(values)
    ]
    found = fy.assess(pair, loads, paths=False)
    cases, rest = fy.solve_static_cases(pair, loads), fy.solve_static(pair)
    face, clamp = found.interfaces["joint"], cases.contact_force("joint")
    assert face.most_clamp == pytest.approx(clamp.max(), rel=1e-12)
    assert face.most_clamp_case == str(clamp.argmax())
    along = pair.interfaces["joint"].points[:, 0]
    for name, bolt in found.bolts.items():
        here = (along < 0) == (pair.bolts[name].ends[0, 0] < 0)
        forces, around = cases.contact_forces[:, here].sum(axis=1), bolt.clamp_around["joint"]
        assert around.preload == pytest.approx(rest.contact_forces[here].sum(), rel=1e-12)
        assert around.least == pytest.approx(forces.min(), rel=1e-12)
        assert around.least_case == str(forces.argmin())
        assert around.most == pytest.approx(forces.max(), rel=1e-12)
        assert around.most_case == str(forces.argmax())
        # The exact model is certified to its round-off.
        assert around.certified_least == pytest.approx(around.least, rel=1e-6)


def test_bolts_whose_axes_are_unknown_have_no_areas(pair):
    one, other = pair.bolts
    lost = replace(pair.bolts[other], ends=None)
    assert not surroundings(contact_surfaces(pair), {one: pair.bolts[one], other: lost})
    whole = surroundings(contact_surfaces(pair), {other: lost})
    assert whole["joint", other].all()
    assert not surroundings(contact_surfaces(pair), {})


def test_requirements_are_judged_where_they_are_nearest_to_failing(joint):
    loads = [
        fy.Load({"tip.Fz": -200.0}, name="mild"),
        fy.Load({"tip.Fx": 9e3, "tip.Fz": -700.0}, name="hard pull"),
    ]
    cases = fy.solve_static_cases(joint, loads)
    wanted = fy.Requirements(
        min_clamp_force={"joint": 8e3},
        max_pressure=float(cases.max_pressure.max()) * 1.01,
        max_nodal_pressure=10.0,
        no_opening_within=8.0,
        min_opening_factor=1.0,
    )
    found = fy.assess(joint, loads, wanted)
    by_name = {one.requirement: one for one in found.verdicts}
    clamp = cases.contact_force("joint")
    assert by_name["min_clamp_force"].case == loads[int(clamp.argmin())].name
    assert by_name["min_clamp_force"].value == pytest.approx(clamp.min(), rel=1e-6)
    assert by_name["min_clamp_force"].met == (clamp.min() >= 8e3)
    assert by_name["max_pressure"].met
    means = joint.interfaces["joint"].nodal_average(cases.pressure).max(axis=-1)
    crushed = by_name["max_nodal_pressure"]
    assert crushed.value == pytest.approx(means.max(), rel=1e-12)
    assert crushed.case == loads[int(means.argmax())].name
    assert not crushed.met
    points, rest = joint.interfaces["joint"].points, fy.solve_static(joint).pressure > 0
    ends = joint.bolts["bolt"].ends
    near = (np.hypot(*(points - ends[0])[:, :2].T) <= 8.0) & rest
    smallest = cases.pressure[:, near].min()
    assert by_name["no_opening_within"].value == pytest.approx(smallest, abs=1e-9)
    assert by_name["no_opening_within"].met == (smallest > 0)
    assert by_name["min_opening_factor"].value == min(found.interfaces["joint"].opening.values())
    assert found.met == all(one.met for one in found.verdicts)


def test_bolts_share_the_area_around_them(pair):
    joint = pair
    found = fy.assess(joint, [fy.Load({"tip.Fz": -300.0}, name="bend")], paths=False)
    axial = sum(one.axial_loads["bend"] for one in found.bolts.values())
    # What the tip takes from all bolts and all areas together: no force is lost between them.
    cases = fy.solve_static_cases(joint, [fy.Load(), fy.Load({"tip.Fz": -300.0})])
    bolts = sum(np.diff(cases.bolt_force(name))[0] for name in joint.bolts)
    assert axial == pytest.approx(bolts - np.diff(cases.contact_force("joint"))[0], abs=1e-6)


def test_bolts_have_load_factors_of_loads_that_act_along_them(pair):
    """Not of what bends a bolt or presses elsewhere, whose ratios have any size and sign."""
    loads = [
        fy.Load({"tip.Fz": -300.0}, name="bend"),
        fy.Load({"tip.Mz": 4e4}, name="turn"),
        fy.Load({"tip.Mx": 3e4}, name="twist"),
        fy.Load({"tip.Fx": 3e3}, name="pull"),
    ]
    found = fy.assess(pair, loads, paths=False)
    factors = [one.load_factors for one in found.bolts.values()]
    assert all(0 <= factor <= 1 for one in factors for factor in one.values())
    assert not any({"turn", "twist"} & set(one) for one in factors)
    told = [set(one.axial_loads) for one in found.bolts.values()]
    assert told == [{load.name for load in loads}] * 2


def test_nothing_to_assess_is_refused(joint):
    with pytest.raises(ModelError, match="no load"):
        fy.assess(joint, [])
    with pytest.raises(ModelError, match="the same name"):
        fy.assess(joint, [LOAD, LOAD])
    wanted = fy.Requirements(no_opening_within=1.0, max_pressure=1e9)
    highest, around = fy.assess(joint, [LOAD], wanted, paths=False).verdicts
    assert highest.met
    assert around.met is None
    assert "within 1 of bolt 'bolt'" in around.reason
    with pytest.raises(ModelError, match="no interface 'jiont'"):
        fy.assess(joint, [LOAD], fy.Requirements(min_clamp_force={"jiont": 1.0}), paths=False)
