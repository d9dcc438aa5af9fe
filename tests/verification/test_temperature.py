"""What temperatures do to bars, bolts and joints: closed forms."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError, StudyError
from faying.export.arrays import variables
from faying.export.linearized import linearize
from faying.model.assembly import Assembly, Support
from faying.model.generate import brick_grid
from solid_blocks import stacked

ALUMINIUM = fy.Material(
    name="aluminium", youngs_modulus=70e3, poissons_ratio=0.33, density=2.7e-9, expansion=23e-6
)
STEEL = fy.Material(
    name="steel", youngs_modulus=210e3, poissons_ratio=0.29, density=7.8e-9, expansion=12e-6
)
ROUND_OFF = 1e-9
"""Of forces: what is left of ten digits of a factorization by stiff couplings and contact."""


def stack(lower, upper, divisions=(4, 4, 2), size=(40.0, 40.0, 10.0), bolt=STEEL):
    """Two blocks, one on the other, that share no node; materials 1, 2, and 3 of the bolt."""
    block = brick_grid(*(np.linspace(0.0, b, n + 1) for b, n in zip(size, divisions, strict=True)))
    above = replace(block, nodes=np.add(block.nodes, [0.0, 0.0, size[2]]))
    mesh = stacked(block, above, names=("lower", "upper"))
    return Assembly(mesh=mesh, materials={1: lower, 2: upper, 3: bolt})


def held_freely(assembly):
    """Hold the lower block without stressing it: at a point, a line and a plane of its bottom."""
    nodes = assembly.mesh.nodes
    bottom = nodes[:, 2] == 0.0

    def at(x, y):
        return np.flatnonzero(bottom & (nodes[:, 0] == x) & (nodes[:, 1] == y))

    supports = [(at(0.0, 0.0), (0, 1, 2)), (at(40.0, 0.0), (1, 2)), (at(0.0, 40.0), (2,))]
    return replace(
        assembly,
        supports=tuple(
            Support(id=number, nodes=node, components=held)
            for number, (node, held) in enumerate(supports)
        ),
    )


def bolted(lower, upper, bolt=STEEL):
    shank = fy.BoltSpec(
        name="bolt",
        axis=((20.0, 20.0, 0.0), (20.0, 20.0, 20.0)),
        diameter=8.0,
        washer_radius=11.0,
        washer="rbe3",
        material=3,
    )
    assembly = held_freely(stack(lower, upper, bolt=bolt))
    return fy.build_model(assembly, bolts=[shank])


@pytest.mark.parametrize("change", [80.0, -60.0])
def test_a_steel_bolt_in_aluminium_plates_gains_what_both_stiffnesses_let_it(change):
    # With no gap the joint is the spring N / N0 of the preload, whatever its contact area is.
    joint = bolted(ALUMINIUM, ALUMINIUM)
    warm = fy.Temperature(reference=20.0, uniform=20.0 + change)
    joint = fy.preload(fy.with_temperature(joint, "warm", warm), {"bolt": 10e3})
    bolt = joint.bolts["bolt"]
    gained = fy.solve_static(joint, fy.Load({"warm": 1.0})).bolt_force("bolt") - 10e3
    shank = 1 / bolt.stiffness
    whole = shank * bolt.initial_force / 10e3  # the compliance of bolt and plates together
    expected = (23e-6 - 12e-6) * change * 20.0 / whole
    assert gained == pytest.approx(expected, rel=ROUND_OFF)
    # The bolt that expands alone loses, by its own coefficient.
    alone = fy.Temperature(reference=20.0, parts={"bolt": 20.0 + change})
    lost = fy.solve_static(
        fy.with_temperature(joint, "alone", alone), fy.Load({"alone": 1.0})
    ).bolt_force("bolt")
    assert lost - 10e3 == pytest.approx(-12e-6 * change * 20.0 / whole, rel=ROUND_OFF)


def test_what_expands_freely_is_without_stress():
    joint = bolted(STEEL, STEEL)
    joint = fy.with_temperature(joint, "warm", fy.Temperature(reference=0.0, uniform=100.0))
    joint = fy.preload(joint, {"bolt": 10e3})
    cold, warm = (fy.solve_static(joint, fy.Load({"warm": share})) for share in (0.0, 1.0))
    assert warm.bolt_force("bolt") == pytest.approx(10e3, rel=ROUND_OFF)
    largest = np.abs(cold.contact_forces).max()
    np.testing.assert_allclose(
        warm.contact_forces, cold.contact_forces, rtol=0, atol=ROUND_OFF * largest
    )
    moved = joint.dofs.transformation @ (warm.full_displacement() - cold.full_displacement())
    nodes = joint.assembly.mesh.nodes
    in_plane = moved.reshape(-1, 6)[:, :3]
    lower = nodes[:, 2] < 10.0
    np.testing.assert_allclose(
        in_plane[lower], 12e-4 * nodes[lower], rtol=0, atol=ROUND_OFF * 12e-4 * 40.0
    )


def clamped_bar():
    """Two blocks of no lateral contraction between smooth walls: a bar."""
    lower, upper = (replace(one, poissons_ratio=0.0) for one in (STEEL, ALUMINIUM))
    assembly = stack(lower, upper)
    x, y, z = assembly.mesh.nodes.T
    supports = []
    for wall in (0.0, 20.0):
        edge = (z == wall) & (y == 0.0)
        for chosen, held in ((z == wall, (2,)), (edge, (1,)), (edge & (x == 0.0), (0,))):
            nodes = np.flatnonzero(chosen)
            supports.append(Support(id=len(supports), nodes=nodes, components=held))
    return fy.build_model(
        replace(assembly, supports=tuple(supports)),
        interfaces=[fy.InterfaceSpec(name="joint", penalty=1e5)],
    )


def test_a_clamped_bar_of_two_materials_is_pressed():
    # p (L/E1 + L/E2 + 1/c) = (a1 dT1 + a2 dT2) L, each half at a temperature of its own.
    bar = clamped_bar()
    hot = fy.Temperature(reference=20.0, uniform=70.0, parts={"upper": 120.0})
    bar = fy.with_temperature(bar, "hot", hot)
    pressure = fy.solve_static(bar, fy.Load({"hot": 1.0})).pressure
    longer = (12e-6 * 50.0 + 23e-6 * 100.0) * 10.0
    expected = longer / (10.0 / 210e3 + 10.0 / 70e3 + 1 / 1e5)
    np.testing.assert_allclose(np.abs(pressure), expected, rtol=ROUND_OFF)
    # Cold the halves part, and nothing presses.
    cooled = fy.solve_static(bar, fy.Load({"hot": -1.0}))
    np.testing.assert_array_equal(cooled.pressure, 0.0)
    np.testing.assert_allclose(cooled.gap, longer, rtol=ROUND_OFF)


def test_reduced_and_stored_models_tell_the_same_bolt_force(tmp_path):
    joint = bolted(ALUMINIUM, ALUMINIUM)
    joint = fy.with_temperature(joint, "warm", fy.Temperature(reference=20.0, uniform=90.0))
    joint = fy.preload(joint, {"bolt": 10e3})
    load = fy.Load({"warm": 1.0})
    full = fy.solve_static(joint, load)
    rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    rom.save(tmp_path / "joint.faying")
    for model in (rom, fy.read_reduced_model(tmp_path / "joint.faying")):
        told = fy.solve_static(model, load)
        # Reduction with compliance is exact in statics, to the digits of its dense matrices.
        assert told.bolt_force("bolt") == pytest.approx(full.bolt_force("bolt"), rel=1e-8)
    with pytest.raises(StudyError, match="temperature 'warm' expands bolts"):
        variables(rom)
    linear = linearize(rom)
    row, column = linear.output_names.index("bolt.N"), linear.input_names.index("warm")
    assert linear.feedthrough[row, column] == joint.load_patterns["warm"].bolt_forces["bolt"]
    recovered = fy.recover_pressure(rom, fy.solve_static(rom, load))
    assert recovered.bolt_force("bolt") == pytest.approx(full.bolt_force("bolt"), rel=1e-8)
    slope = fy.sensitivity(joint, full).loads.of("warm").bolt_forces[0, 0]
    step = 1e-3
    ahead = fy.solve_static(joint, fy.Load({"warm": 1.0 + step})).bolt_force("bolt")
    # Linear while the same points touch.
    assert slope == pytest.approx((ahead - full.bolt_force("bolt")) / step, rel=1e-6)


@pytest.mark.parametrize(
    ("temperature", "message"),
    [
        (fy.Temperature(reference=20.0, parts={"lid": 30.0}), "no body or element set 'lid'"),
        (fy.Temperature(reference=20.0, parts={1: 30.0, "lower": 40.0}), "30 and 40"),
        (fy.Temperature(reference=20.0, uniform=30.0), "'unknown' has no coefficient"),
        (fy.Temperature(reference=20.0, uniform=20.0), "moves nothing"),
    ],
)
def test_temperatures_that_cannot_be_are_refused(temperature, message):
    joint = bolted(replace(STEEL, name="unknown", expansion=None), STEEL)
    with pytest.raises(ModelError, match=message):
        fy.with_temperature(joint, "warm", temperature)
