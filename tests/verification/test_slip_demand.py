"""Slip by sums: what an interface carries by balance, and the friction that takes."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.assessment.joint_checks import joint_checks
from faying.assessment.joint_verdict import joint_verdict
from faying.assessment.slip_demand import area_sums, least_mean_arm
from faying.cli.description import _signs
from faying.exceptions import ModelError
from faying.interface.relative_displacement import common_normal
from faying.joint.build import build_model
from faying.joint.tangential import TangentialRows, tangential_rows
from faying.model.assembly import Support
from faying.units import units_of
from lap_joints import tiny_lap

PULL = {"tip.Fx": 1.2e3, "tip.Fy": 80.0, "tip.Mz": 500.0, "tip.Fz": -100.0}
LOADS = [fy.Load(PULL, name="pull"), fy.Load({"tip.Fz": -200.0}, name="bend")]
STICKING = fy.Sticking(threshold=0.3, stiffness=1e6)
UPWARDS = np.tile([0.0, 0.0, 1.0], (12, 1))


def balanced(model):
    """F_Q and M about the centre of pressure of the first load: those of the tip."""
    mesh, tip = model.assembly.mesh, model.boundaries["tip"].nodes[0]
    force = fy.solve_static(model, LOADS[0]).contact_forces
    points = model.interfaces["joint"].points
    arm = mesh.nodes[mesh.node_index(np.array([tip]))[0]] - force @ points / force.sum()
    return np.hypot(1.2e3, 80.0), abs(500.0 + arm[0] * 80.0 - arm[1] * 1.2e3), force


@pytest.mark.parametrize("sticking", [None, STICKING])
def test_what_is_carried_is_what_the_tip_takes(pair, sticking):
    """The balance of the outer plate, to the round-off of back-substitutions."""
    model = fy.preload(pair, dict.fromkeys(pair.bolts, 8e3), sticking=sticking)
    wanted = fy.Requirements(slip_friction={"joint": 0.2}, min_slip_safety=1.0)
    found = fy.assess(model, LOADS, wanted, paths=False)
    demand, (force, moment, pressed) = found.interfaces["joint"].slip, balanced(model)
    assert not demand.unknown
    assert demand.tangential_force["pull"] == pytest.approx(force, rel=1e-9)
    assert demand.moment["pull"] == pytest.approx(moment, rel=1e-9)
    assert demand.clamp_force["pull"] == pytest.approx(pressed.sum(), rel=1e-12)
    assert demand.tangential_force["bend"] < 1e-6
    assert list(demand.safety) == ["pull"]  # nothing to carry in the other
    places = model.interfaces["joint"].points[:, :2]
    arm = least_mean_arm(places, pressed[None] / pressed.sum())[0]
    needed = force / pressed.sum() + moment / (pressed.sum() * arm)
    assert demand.needed_friction["pull"] == pytest.approx(needed, rel=1e-9)
    assert demand.safety["pull"] == pytest.approx(0.2 / needed, rel=1e-9)
    (verdict,) = found.verdicts
    assert (verdict.requirement, verdict.place, verdict.case) == (
        "min_slip_safety", "joint", "pull",
    )  # fmt: skip
    assert verdict.met == (0.2 / needed >= 1.0)


def test_friction_exceeded_around_one_bolt_alone_is_said(pair):
    """What its surroundings need, the whole interface does not: the verdict leaves it open."""
    uneven = fy.preload(pair, dict(zip(pair.bolts, (8e3, 2e3), strict=True)))
    found = fy.assess(uneven, LOADS, fy.Requirements(slip_friction=0.2), paths=False)
    whole = found.interfaces["joint"].slip.needed_friction["pull"]
    around = {name: bolt.slip_around["joint"] for name, bolt in found.bolts.items()}
    most = max(around, key=lambda name: around[name].needed_friction["pull"])
    between = np.sqrt(whole * around[most].needed_friction["pull"])
    enough = 1.01 * around[most].needed_friction["pull"]
    for friction, told in ((between, [most]), (enough, [])):
        found = fy.assess(uneven, LOADS, fy.Requirements(slip_friction=friction), paths=False)
        checks = joint_checks(found, units_of("mm-t-s"))
        local = [check for check in checks if check.quantity == "slip at joint"]
        assert [check.part for check in local] == told
        assert all(check.outcome == "unknown" for check in local)
        verdict = joint_verdict(checks, units_of("mm-t-s"))
        assert any(text.startswith("slip at joint") for text in verdict.open_questions) == bool(
            told
        )
        assert verdict.holds


def test_bolts_beside_the_contact_carry_what_the_tip_takes(pair):
    """As around a gasket inside the bolt circle: no contact points are beyond them."""
    mesh = pair.assembly.mesh
    plates, tip = mesh.blocks[0], pair.boundaries["tip"]
    between = np.abs(mesh.nodes[plates.nodes].mean(axis=1)[:, 0]) < 5.0
    lower, upper = (plates.ids[between & (plates.properties == number)] for number in (1, 2))
    model = build_model(
        pair.assembly,
        interfaces=[fy.InterfaceSpec(name="joint", minus=lower.tolist(), plus=upper.tolist())],
        bolts=[
            fy.BoltSpec(name=name, elements=bolt.shank.elements)
            for name, bolt in pair.bolts.items()
        ],
        boundaries=[fy.BoundarySpec(name="tip", node=int(tip.nodes[0]))],
    )
    reach = max(abs(model.interfaces["joint"].points[:, 0]))
    assert reach < min(abs(bolt.ends[0, 0]) for bolt in model.bolts.values())
    model = fy.preload(model, dict.fromkeys(model.bolts, 8e3))
    demand = fy.assess(model, LOADS, paths=False).interfaces["joint"].slip
    assert not demand.unknown
    force, moment, _ = balanced(model)
    assert demand.tangential_force["pull"] == pytest.approx(force, rel=1e-9)
    assert demand.moment["pull"] == pytest.approx(moment, rel=1e-9)


def test_surroundings_of_bolts_share_what_is_carried(pair):
    for model in (pair, fy.preload(pair, dict.fromkeys(pair.bolts, 8e3), sticking=STICKING)):
        whole, *areas = tangential_rows(model)
        assert [one.bolt for one in areas] == list(pair.bolts)
        assert all(not one.unknown for one in areas)
        for part in ("per_input", "per_pair"):
            shares = np.array([getattr(one, part) for one in areas])
            # Each is a back-substitution of its own; pair forces add up to nothing.
            missed = np.abs(shares.sum(axis=0) - getattr(whole, part))
            assert missed.max() < 1e-9 * np.abs(shares).max()


def test_reduced_models_know_it_too(pair, tmp_path):
    exact = fy.assess(pair, LOADS, paths=False)
    rom = fy.reduce(pair, fy.craig_bampton(pair, normal_modes=6), compliance=True)
    rom.save(tmp_path / "joint.faying")
    for system in (rom, fy.read_reduced_model(tmp_path / "joint.faying")):
        found = fy.assess(system, LOADS, paths=False)
        for name, bolt in exact.bolts.items():
            one, other = bolt.slip_around["joint"], found.bolts[name].slip_around["joint"]
            # Contact forces of this method are the full model's to 1e-9.
            assert other.needed_friction == pytest.approx(one.needed_friction, rel=1e-7)


def test_what_nothing_tells_is_said():
    """The tip is held along y: the joint and the support share, and nothing sticks."""
    model = fy.lap_joint(element_size=5.0)
    x = model.assembly.mesh.nodes[:, 0]
    held = Support(id=99, nodes=np.flatnonzero(x == x.max()), components=(1,))
    assembly = replace(model.assembly, supports=(*model.assembly.supports, held))
    bolt = model.bolts["bolt"].shank.elements
    shared = build_model(
        assembly,
        interfaces=[fy.InterfaceSpec(name="joint")],
        bolts=[fy.BoltSpec(name="bolt", elements=bolt)],
    )
    shared = fy.preload(shared, {"bolt": 8e3})
    asked = fy.Requirements(slip_friction=0.2, min_slip_safety=1.0)
    found = fy.assess(shared, [fy.Load(name="rest")], paths=False).interfaces["joint"].slip
    assert "held together elsewhere" in found.unknown
    assert not found.needed_friction
    (verdict,) = fy.assess(shared, [fy.Load(name="rest")], asked, paths=False).verdicts
    assert (verdict.met, verdict.place) == (None, "joint")
    assert "held together elsewhere" in verdict.reason
    stuck = fy.preload(shared, {"bolt": 8e3}, sticking=STICKING)
    assert (
        not fy.assess(stuck, [fy.Load(name="rest")], paths=False).interfaces["joint"].slip.unknown
    )


def test_bolts_of_given_matrices_hide_their_lateral_forces():
    model = fy.preload(tiny_lap(), {"bolt": 5e3})
    hidden = replace(model, bolts={"bolt": replace(model.bolts["bolt"], shank=None)})
    found = fy.assess(hidden, [fy.Load(name="rest")], paths=False).interfaces["joint"].slip
    assert found.unknown == "bolt 'bolt' is part of given matrices, which hide its lateral force"


def test_both_faces_of_a_plate_can_be_one_interface():
    """Their normals cancel: it has no plane, and the matrices of the rest are numbers."""
    # Powers of two: the normals are those of the axes to the last bit.
    whole = {"length": 128.0, "overlap": 32.0, "width": 16.0, "thickness": 8.0}
    model = fy.lap_joint(element_size=8.0, plates=3, hole_radius=0.0, washer_radius=9.0, **whole)
    plates = model.assembly.mesh.blocks[0]
    outer = plates.ids[plates.properties != 2].tolist()
    both = build_model(
        model.assembly, interfaces=[fy.InterfaceSpec(name="both", minus="middle", plus=outer)]
    )
    assert not both.interfaces["both"].flat
    said = "several directions, on average (0, 0, 0)"
    assert _signs(both.interfaces["both"]) == (said, "both sides")
    for area in tangential_rows(both):
        assert "it is curved" in area.unknown
        assert np.isfinite(area.tangents).all()
    rom = fy.reduce(both, fy.craig_bampton(both, normal_modes=1), compliance=True)
    assert np.isfinite(rom.tangential[0].tangents).all()


def test_normals_that_cancel_to_the_last_bit_have_no_mean():
    """Here they do to the last bit."""
    normals = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    found, pairs, flat = common_normal(normals, np.ones(2), normals)
    assert not flat
    np.testing.assert_array_equal(found, normals)
    np.testing.assert_array_equal(pairs, normals)


def test_coefficient_of_no_interface_is_refused(pair):
    wanted = fy.Requirements(slip_friction={"jiont": 0.2})
    with pytest.raises(ModelError, match="no interface 'jiont' without friction; there are joint"):
        fy.assess(pair, LOADS, wanted, paths=False)
    (verdict,) = fy.assess(pair, LOADS, fy.Requirements(min_slip_safety=1.2), paths=False).verdicts
    assert "add what is missing" in verdict.reason


def area():
    return TangentialRows(
        interface="joint",
        bolt="",
        unknown="",
        origin=np.zeros(3),
        tangents=np.eye(3)[:2],
        per_input=np.zeros((3, 0)),
        per_pair=np.zeros((3, 0)),
    )


def test_a_flat_joint_whose_edge_bends_away_is_judged():
    """As a bent sheet on a plate: few facets are tilted, and the bolt presses beside them."""
    straight = fy.lap_joint(element_size=5.0)
    nodes = straight.assembly.mesh.nodes.copy()
    joined = np.unique(straight.interfaces["joint"].pairs)
    edge = joined[np.isclose(nodes[joined, 0], nodes[joined, 0].max())]
    nodes[edge, 2] -= 1.5
    mesh = replace(straight.assembly.mesh, nodes=nodes)
    bolt = fy.BoltSpec(name="bolt", elements=straight.bolts["bolt"].shank.elements)
    bent = build_model(
        replace(straight.assembly, mesh=mesh),
        interfaces=[fy.InterfaceSpec(name="joint")],
        bolts=[bolt],
        boundaries=[fy.BoundarySpec(name="tip", node=straight.boundaries["tip"].nodes[0])],
    )
    assert not bent.interfaces["joint"].flat
    pull = [fy.Load({"tip.Fx": 1.2e3, "tip.Fz": 50.0}, name="pull")]
    demands = [
        fy.assess(fy.preload(model, {"bolt": 8e3}), pull, paths=False).interfaces["joint"].slip
        for model in (straight, bent)
    ]
    assert not demands[1].unknown
    needed = [demand.needed_friction["pull"] for demand in demands]
    assert needed[1] == pytest.approx(needed[0], rel=0.03)


def test_an_area_that_presses_where_it_is_tilted_has_no_plane():
    points = np.hstack([np.random.default_rng(1).normal(size=(12, 2)), np.zeros((12, 1))])
    normals, forces, carried = UPWARDS.copy(), np.ones((3, 12)), np.array([[3.0, 0.0, 0.0]] * 3)
    normals[0] = [0.6, 0.0, 0.8]
    forces[1:, 0] = 0.0, 0.1
    sums = area_sums(area(), points, normals, forces, carried)
    np.testing.assert_array_equal(sums.bent, [True, False, False])
    assert np.isinf(sums.needed_friction[0])
    assert sums.clamp_force[1:] == pytest.approx([11.0, 11.1], rel=1e-12)


def test_least_mean_arms_are_fermats():
    """Of an equilateral triangle to its centre; from a corner of 120° or more to the others."""
    places = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(3) / 2]])
    third = np.full((1, 3), 1 / 3)
    assert least_mean_arm(places, third)[0] == pytest.approx(1 / np.sqrt(3), rel=1e-12)
    flat = np.array([[0.0, 0.1], [2.0, 0.0], [-2.0, 0.0]])
    assert least_mean_arm(flat, third)[0] == pytest.approx(2 * np.hypot(2, 0.1) / 3, rel=1e-12)


def test_no_rigid_sliding_dissipates_less_than_the_load_works():
    """With the friction that is needed, of 200 random areas and 400 motions of each."""
    random = np.random.default_rng(5)
    for _ in range(200):
        points = np.hstack([random.normal(size=(12, 2)), np.zeros((12, 1))])
        forces, carried = random.uniform(0, 1, (1, 12)) ** 3, random.normal(size=(1, 3))
        sums = area_sums(area(), points, UPWARDS, forces, carried)
        motions = random.normal(size=(400, 3)) * [1, 1, random.uniform(0, 4)]
        motions[0] = [carried[0, 0], carried[0, 1], 0.0]
        x, y = points[:, :2].T
        v, w = motions[:, :2, None], motions[:, 2:]
        sliding = np.hypot(v[:, 0] - w * y, v[:, 1] + w * x) @ forces[0]
        assert (sums.needed_friction[0] * sliding >= motions @ carried[0] * (1 - 1e-12)).all()


def test_one_load_alone_needs_exactly_that_friction():
    """A force through the centre of pressure, and a couple."""
    points = np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0]])
    forces = np.full((3, 4), 50.0)
    forces[2] = 0.0
    carried = np.array([[30.0, 40.0, 0.0], [0.0, 0.0, -60.0], [1.0, 0.0, 0.0]])
    needed = area_sums(area(), points, UPWARDS[:4], forces, carried).needed_friction
    assert needed == pytest.approx([50 / 200, 60 / 200, np.inf], rel=1e-12)
