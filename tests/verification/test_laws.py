"""Every law down every road: where forces and gaps are told they are those of the law, or refused.

One line of LAWS is a law, one of ROADS a road.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from test_bolts import HOLDING, STEEL, squeezed_blocks

import faying as fy
from faying.assessment.stuck_modes import stuck_springs
from faying.contact import laws
from faying.contact.laws import Coulomb, Hard, Penalty
from faying.exceptions import ModelError, StudyError
from faying.export.formats import export
from faying.export.linearized import linearize
from faying.io.op4 import read_op4_matrices
from faying.joint.system import input_forces
from faying.simulation.integrators import EnergyDecaying, ImplicitEuler
from faying.simulation.solution import Solution
from faying.simulation.static import relative_forces
from faying.simulation.tightening import tightened_joint
from lap_joints import tiny_lap

STIFFNESS = 2e5
PRELOAD = 8e3
LOADS = [fy.Load({"tip.Fz": -300.0 * f, "tip.Mx": 1e4 * f}) for f in (0.0, 0.5, 1.0, 0.5, -0.5)]


@dataclass(frozen=True)
class Curve(laws.Curve):
    """A law that faying does not have: p = c δ + k δ² where closed by δ."""

    initial: float
    stiffening: float

    name = "rough"
    named_pressure = 10.0

    def pressure_of(self, closure):
        d = np.maximum(closure, 0.0)
        slope = (self.initial + 2 * self.stiffening * d) * (closure >= 0)
        return self.initial * d + self.stiffening * d**2, slope

    def closure_of(self, pressure):
        root = np.sqrt(self.initial**2 + 4 * self.stiffening * pressure)
        return 2 * pressure / (self.initial + root), 1.0 / root


LAWS = {
    "penalty": Penalty(STIFFNESS),
    "hard": Hard(),
    "rough": Curve(STIFFNESS, 1e10),
    "table": fy.TableClosure((0.0, 1e-5, 1e-4), (0.0, 2.0, 60.0)),
    "exponential": fy.ExponentialClosure(pressure=5.0, clearance=2e-5),
    "power": fy.PowerClosure(pressure=20.0, depth=5e-5, exponent=2.0),
    "gasket": fy.GasketClosure((0.0, 1e-5, 1e-4), (0.0, 2.0, 60.0), (4e5, 7e5, 3e6)),
}


@cache
def jointed(name, friction):
    """The cantilever with a law, bolt locked at an initial force."""
    model = fy.lap_joint(element_size=5.0, penalty=STIFFNESS, quadrature="nodal")
    joint = model.interfaces["joint"].with_law(LAWS[name])
    model = model.with_interfaces({"joint": joint}).with_bolt_forces({"bolt": PRELOAD})
    return model.with_friction(friction) if friction else model


def reduced(model):
    return fy.reduce(model, fy.craig_bampton(model, normal_modes=3), compliance=True)


def moving(system):
    """Two steps from the preloaded joint."""
    rest = fy.solve_path(system, LOADS[:1])
    return fy.solve_transient(
        system, LOADS[2], step=1e-5, duration=2e-5, initial=rest, integrator=ImplicitEuler()
    )


def tightened(model):
    if model.contact.components == 1:
        return fy.solve_static(fy.preload(model, {"bolt": PRELOAD}))
    return tightened_joint(model, {"bolt": PRELOAD}, increments=2).rest(model)


def loaded(model, folder):
    reduced(model).save(folder / "joint.faying")
    rom = fy.read_reduced_model(folder / "joint.faying")
    assert rom.contact.laws == model.contact.laws
    return fy.solve_path(rom, LOADS)


ROADS = {
    "static": lambda model, _: fy.solve_static(model, LOADS[2]),
    "tightening": lambda model, _: tightened(model),
    "path": lambda model, _: fy.solve_path(model, LOADS),
    "cycle": lambda model, _: fy.solve_cycles(model, LOADS[2], increments=3).cycle,
    "full transient": lambda model, _: moving(model),
    "reduced transient": lambda model, _: moving(reduced(model)),
    "saved and loaded": loaded,
    "recovery": lambda model, _: fy.recover_pressure(model, fy.solve_path(reduced(model), LOADS)),
}


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("road", ROADS)
def test_every_law_holds_on_every_road(road, name, friction, tmp_path):
    if (road, name) == ("saved and loaded", "rough"):
        pytest.skip("files know the laws of faying alone")
    model = jointed(name, friction)
    law = model.interfaces["joint"].law
    if name == "gasket" and "transient" in road:
        with pytest.raises(ModelError, match="'joint' has the law 'gasket', which remembers how f"):
            ROADS[road](model, tmp_path)
        return
    found = ROADS[road](model, tmp_path)
    check_law(law, found, friction)
    if isinstance(found, Solution) and found.times is None:
        check_balance(found)


def check_balance(found):
    """K u = f + Pᵀ Gᵀ λ with all components of the forces that are told, and g = g₀ + G u."""
    system = found.system
    states = np.atleast_2d(found.states)
    if system.contact.residual_compliance is None:
        gap = states @ system.contact.gap_operator.T + system.contact.initial_gap
        # Round-off of displacements of 0.1.
        np.testing.assert_allclose(np.atleast_2d(found.gap), gap, rtol=0, atol=1e-10)
    contact = relative_forces(system, found.contact_forces, found.shear_forces)
    applied = input_forces(system, found.inputs) + contact
    left = (system.K @ states.T).T - applied
    assert np.abs(left).max() < 1e-8 * np.abs(applied).max()  # round-off of K u


def check_law(law, found, friction):
    gap, forces = np.atleast_2d(found.gap), np.atleast_2d(found.contact_forces)
    weights = found.system.contact.weights
    largest = found.max_pressure.max()
    assert largest > 1.0
    if law.normal.yields:
        deepest = -np.inf + np.zeros(gap.shape) if found.deepest is None else found.deepest
        states = [law.normal.after(one) for one in np.atleast_2d(deepest)]
        every = [one.respond(g[None], weights)[0][0] for one, g in zip(states, gap, strict=True)]
        expected = np.array(every) / weights
        # Natural residual 1e-13 of the largest force, times what the steepest slope makes of it.
        np.testing.assert_allclose(forces / weights, expected, rtol=0, atol=1e-9 * largest)
    else:
        assert (forces >= 0).all()
        assert np.abs(gap[forces > 0]).max() < 1e-9  # round-off of displacements of 0.1
        assert gap.min() > -1e-9
    if friction:
        size = np.linalg.norm(np.atleast_3d(found.traction).reshape(*forces.shape, 3), axis=-1)
        assert (size <= friction * forces / weights + 1e-9 * largest).all()


@pytest.fixture(scope="module")
def smooth():
    return fy.lap_joint(element_size=5.0, penalty=STIFFNESS).with_bolt_forces({"bolt": 8e3})


def with_law(model, law):
    joint = model.interfaces["joint"]
    return model.with_interfaces({"joint": joint.with_law(law)})


def test_a_straight_curve_is_the_penalty(smooth):
    path = fy.solve_path(with_law(smooth, Curve(STIFFNESS, 0.0)), LOADS)
    straight = fy.solve_path(smooth, LOADS)
    largest = straight.max_pressure.max()
    np.testing.assert_allclose(path.pressure, straight.pressure, rtol=0, atol=1e-10 * largest)


CURVE = LAWS["rough"]


@pytest.fixture(scope="module")
def curved(smooth):
    """A reduced model with friction on the curve, and its path."""
    rubbing = smooth.with_friction(0.3)
    model = with_law(rubbing, replace(rubbing.interfaces["joint"].law, normal=CURVE))
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=3), compliance=True)
    return rom, fy.solve_path(rom, LOADS)


@pytest.mark.parametrize(
    "solve",
    [
        lambda rom, path: fy.solve_transient(
            rom, LOADS[0], step=1e-5, duration=2e-5, initial=path, integrator=EnergyDecaying()
        ),
        lambda rom, path: fy.certify_increments(rom, path),
    ],
)
def test_what_knows_proportional_laws_alone_refuses_a_curve(curved, solve):
    rom, path = curved
    with pytest.raises(ModelError, match="'joint' has the law 'rough', whose closure is not in"):
        solve(rom, path)


@pytest.mark.parametrize("to", ["mat", "fmu", "npz", "exudyn"])
def test_no_file_holds_another_law_than_the_model(curved, tmp_path, to):
    with pytest.raises(StudyError, match=f"'joint' has the law 'rough', which {to} does not su"):
        export(curved[0], to, out=tmp_path / "joint")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("name", ["rough", "table", "exponential", "power", "gasket"])
def test_linear_files_hold_the_slope_of_a_law_at_the_preload(name, friction, tmp_path):
    """A gasket that vibrates unloads and reloads, once its first period has closed it deepest."""
    rom = reduced(jointed(name, friction))
    linear = linearize(rom)
    vibration = [fy.Load({"tip.Fz": force}) for force in (0.0, 0.02, -0.02, 0.01, -0.01)]
    up, down = fy.solve_path(rom, vibration).displacement("tip")[-2:]
    push = linear.inputs[:, linear.input_names.index("tip.Fz")]
    tip = np.linalg.solve(linear.K, push)[linear.boundary]
    np.testing.assert_allclose(tip, (up - down) / 0.02, rtol=1e-4, atol=1e-5 * abs(tip).max())
    files = {path.name: path for path in export(rom, "nastran", out=tmp_path / "joint.op4")}
    assert "DLAW" not in read_op4_matrices(files["joint_recovery.op4"])
    assert "recovery below does not" in files["joint_readme.txt"].read_text()


def test_small_motions_see_the_slope_of_a_curve(smooth):
    model = with_law(smooth, CURVE)
    path = fy.solve_path(model, LOADS[:1])
    closed = path.pressure[-1] > 0
    _, flexibility = stuck_springs(model, path)
    slopes = np.sqrt(STIFFNESS**2 + 4e10 * path.pressure[-1, closed])
    weights = model.contact.weights[closed]
    np.testing.assert_allclose(1 / (flexibility * weights), slopes, rtol=1e-12)  # round-off


def test_friction_on_a_smooth_interface_needs_no_with_friction(smooth):
    rubbing = smooth.with_friction(0.3)
    law = rubbing.interfaces["joint"].law
    path = fy.solve_path(with_law(smooth, law), LOADS)
    np.testing.assert_array_equal(path.pressure, fy.solve_path(rubbing, LOADS).pressure)
    assert with_law(rubbing, Penalty(STIFFNESS)).structure is not rubbing.structure


@pytest.mark.parametrize("law", [Coulomb(Penalty(1e5), 0.4, 8e4), Penalty(1e5)])
def test_derivatives_are_those_of_the_admissible_forces(law):
    """Central differences in random directions, at open, sticking and slipping points."""
    rng = np.random.default_rng(0)
    forces = rng.standard_normal((law.components, 400)) * [[1.0], [0.4], [0.4]][: law.components]
    way = rng.standard_normal(forces.shape)
    ends = [law.admissible(forces + h * way) for h in (1e-7, -1e-7)]
    expected = (ends[0] - ends[1]) / 2e-7
    found = np.einsum("pij,jp->ip", law.derivative(forces), way)
    # Round-off of the differences, 1e-16/1e-7; no point lies within 1e-7 of a kink.
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6)


def test_no_friction_is_no_friction_law(smooth):
    """μ = 0 costs what frictionless contact costs: it has no tangential ports."""
    model = smooth.with_friction(0.0)
    assert model.interfaces["joint"].law == Penalty(STIFFNESS)
    assert model.structure is smooth.structure


def test_another_coefficient_shares_the_factorization(smooth):
    first = smooth.with_friction(0.1)
    assert first.with_friction(0.3).structure is first.structure
    assert first.with_friction(0.3).port_compliance is first.port_compliance


VM250 = fy.GasketClosure(
    closures=(0.0, 0.0508, 0.1016, 0.1524, 0.2032, 0.254, 0.3048, 0.3556, 0.4064, 0.4572, 0.508,
              0.5588, 0.6096, 0.68326),
    pressures=(0.0, 1.61226, 5.20884, 11.3134, 20.0499, 25.996, 29.0345, 35.7453, 44.0064, 56.3189,
               74.8254, 96.7287, 129.001, 157.147),
    unloading=(243.0, 243.0, 265.7, 288.4, 311.1, 333.8, 356.5, 474.4, 592.3, 757.533, 922.767,
               1088.0, 1249.0, 1490.0),
)  # fmt: skip
"""Ansys' verification problem 250 [mm, MPa]: compression and slopes of ``TB,GASKET``."""


def test_a_gasket_is_loaded_and_unloaded_as_in_vm250():
    """44.0064 MPa at 0.4064 mm and 157.147 at 0.68326, and back along the slopes there."""
    model = squeezed_blocks("hex8", 1e5, "gauss").with_closure(VM250)
    pressures = np.array([44.0064, 1.0, 30.0, 157.147, 5.0, 150.0])
    closures = np.array([0.4064, 0.4064 - 43.0064 / 592.3, 0.4064 - 14.0064 / 592.3, 0.68326,
                         0.68326 - 152.147 / 1490.0, 0.68326 - 7.147 / 1490.0])  # fmt: skip
    # The spring that holds the plate is shortened with 8 mm of steel.
    forces = 54.0 * pressures + HOLDING * (closures + 8.0 * pressures / STEEL.youngs_modulus)
    path = fy.solve_path(model, [fy.Load({"plate.Fz": -force}) for force in forces])
    # Points in an even field differ by round-off of displacements of 1 mm over slopes of 1000.
    np.testing.assert_allclose(-path.gap.T, closures + 0 * path.gap.T, rtol=1e-9)
    np.testing.assert_allclose(path.pressure.T, pressures + 0 * path.gap.T, rtol=1e-8)


@pytest.mark.parametrize(
    ("slopes", "message"),
    [((4e5, 7e5), "3 closures and 2 slopes"), ((4e5, 7e5, 1e5), "from closure 0.0001 pressure go")],
)
def test_a_gasket_that_would_give_back_more_than_it_took_is_refused(slopes, message):
    with pytest.raises(ModelError, match=message):
        fy.GasketClosure((0.0, 1e-5, 1e-4), (0.0, 2.0, 60.0), slopes)


@pytest.mark.parametrize(
    "solve",
    [
        lambda model: fy.solve_static_cases(model, LOADS[:2]),
        lambda model: fy.frequency_response(model, {"tip.Fz": 1.0}, [640.0], [1.0]),
        lambda model: fy.certify(model, LOADS[1], np.zeros(model.contact.n_points)),
    ],
)
def test_what_does_not_follow_closures_refuses_a_gasket(solve):
    with pytest.raises(ModelError, match="'joint' has the law 'gasket'"):
        solve(jointed("gasket", 0.0))


@pytest.mark.long
def test_a_gasket_vibrates_along_its_lines():
    """Where a bolt was loosened: as an elastic layer, flat where pressure ends on them."""
    slope = 3e6
    gasket = fy.GasketClosure((0.0, 1e-5, 1e-4), (0.0, 2.0, 60.0), (slope, slope, slope))
    joint = tiny_lap()
    tight, loose = (
        joint.with_bolt_forces({"bolt": force}).with_closure(gasket).with_friction(0.3, 3e5)
        for force in (PRELOAD, PRELOAD / 4)
    )
    rest = fy.solve_path(loose, [fy.Load()], initial=fy.solve_path(tight, [fy.Load()]))
    deepest = np.maximum(rest.deepest[-1], 0.0)
    gap = joint.interfaces["joint"].initial_gap + deepest - gasket.pressure_of(deepest)[0] / slope
    layer = loose.with_closure(fy.TableClosure((0.0, 1.0), (0.0, slope)))
    layer = layer.with_initial_gap("joint", gap)
    gasketed = fy.backbone(loose, 1, [1e-3, 1e-2], initial=rest, increments=24)
    start = replace(rest, deepest=None)
    elastic = fy.backbone(layer, 1, [1e-3], initial=start, increments=8)
    # Nothing slips, and nothing goes on along the table.
    assert gasketed.friction_damping[0] == 0
    assert gasketed.small_frequency == pytest.approx(elastic.small_frequency, rel=1e-9)
    assert gasketed.frequency[0] == pytest.approx(elastic.frequency[0], rel=1e-9)
    # Once cycles repeat friction alone takes energy, to the chords of 24 increments.
    assert gasketed.friction_damping[1] > 1e-4
    assert abs(gasketed.energy_difference[1]) < 0.02


def test_a_gasket_stays_flat_where_a_path_goes_on():
    """From where a saved path ended, and through an open joint."""
    model = jointed("gasket", 0.0)
    loads = [*LOADS[:3], fy.Load({"tip.Fz": -2000.0}), LOADS[1]]
    whole, first = fy.solve_path(model, loads), fy.solve_path(model, loads[:4])
    after = fy.solve_static(model, loads[4], initial=first)
    largest = whole.max_pressure.max()
    assert (whole.contact_forces[3] == 0).sum() > (whole.contact_forces[0] == 0).sum()
    # Displacements are formed anew from the forces that are told: round-off of 0.1.
    np.testing.assert_allclose(after.pressure, whole.pressure[-1], rtol=0, atol=1e-7 * largest)
