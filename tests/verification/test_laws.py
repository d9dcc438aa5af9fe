"""A law that faying does not have: a curve of pressure over closure, alone and under friction."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import faying as fy
from faying.assessment.stuck_stiffness import stuck_springs
from faying.contact.frictional import FrictionalContact
from faying.contact.laws import Coulomb, Penalty
from faying.exceptions import ModelError, StudyError
from faying.export.formats import export
from faying.simulation.integrators import ImplicitEuler

STIFFNESS = 2e5
LOADS = [fy.Load({"tip.Fz": -300.0 * f, "tip.Mx": 1e4 * f}) for f in (0.0, 0.5, 1.0, 0.5, -0.5)]


@dataclass(frozen=True)
class Curve:
    """p = c δ + k δ² of a rough surface that stiffens as it closes by δ."""

    stiffness: float
    stiffening: float

    name = "curve"
    components = 1
    friction = 0.0
    proportional = False

    @property
    def normal(self):
        return self

    @property
    def penalty(self):
        return self.stiffness

    def closure(self, forces, weights):
        pressure = np.maximum(forces, 0.0) / weights
        root = np.sqrt(self.stiffness**2 + 4 * self.stiffening * pressure)
        return 2 * pressure / (self.stiffness + root), 1.0 / (root * weights)

    def admissible(self, forces, pressing=None):
        return np.maximum(forces, 0.0)

    def derivative(self, forces, pressing=None):
        return (forces > 0).astype(float)[0, :, None, None]


@pytest.fixture(scope="module")
def smooth():
    return fy.lap_joint(element_size=5.0, penalty=STIFFNESS).with_bolt_forces({"bolt": 8e3})


def with_law(model, law):
    joint = model.interfaces["joint"]
    return model.with_interfaces({"joint": joint.with_law(law)})


def test_a_curve_needs_no_branch_in_the_solver(smooth):
    curve = Curve(STIFFNESS, 1e10)
    path = fy.solve_path(with_law(smooth, curve), LOADS)
    closure = np.maximum(-path.gap, 0.0)
    expected = curve.stiffness * closure + curve.stiffening * closure**2
    # The natural residual is 1e-13 of the largest force; where the curve is steep it is amplified.
    largest = path.max_pressure.max()
    np.testing.assert_allclose(path.pressure, expected, rtol=0, atol=1e-9 * largest)
    straight = fy.solve_path(smooth, LOADS)
    assert np.abs(path.pressure - straight.pressure).max() > 0.05 * largest  # the curve is felt


def test_a_straight_curve_is_the_penalty(smooth):
    path = fy.solve_path(with_law(smooth, Curve(STIFFNESS, 0.0)), LOADS)
    straight = fy.solve_path(smooth, LOADS)
    largest = straight.max_pressure.max()
    np.testing.assert_allclose(path.pressure, straight.pressure, rtol=0, atol=1e-10 * largest)


def test_friction_takes_a_curve_for_its_normal_law(smooth):
    rubbing = smooth.with_friction(0.3)
    law = replace(rubbing.interfaces["joint"].law, normal=Curve(STIFFNESS, 1e10))
    path = fy.solve_path(with_law(rubbing, law), LOADS)
    closure = np.maximum(-path.gap, 0.0)
    largest = path.max_pressure.max()
    expected = STIFFNESS * closure + 1e10 * closure**2
    np.testing.assert_allclose(path.pressure, expected, rtol=0, atol=1e-9 * largest)
    size = np.linalg.norm(path.traction, axis=-1)
    assert (size <= 0.3 * path.pressure + 1e-9 * largest).all()
    assert (size[-1] >= 0.299 * path.pressure[-1])[path.pressure[-1] > 0].any()  # some slip


CURVE = Curve(STIFFNESS, 1e10)


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
        lambda rom, _: fy.solve_transient(rom, LOADS[0], step=1e-5, duration=2e-5),
        lambda rom, path: fy.solve_transient(
            rom,
            LOADS[0],
            step=1e-5,
            duration=2e-5,
            initial=path,
            integrator=ImplicitEuler(),
        ),
        lambda rom, _: fy.solve_static(rom),
        lambda rom, path: fy.certify_increments(rom, path),
    ],
)
def test_what_knows_proportional_laws_alone_refuses_a_curve(curved, solve):
    rom, path = curved
    with pytest.raises(ModelError, match="'joint' has the law 'curve', whose closure is not in"):
        solve(rom, path)


@pytest.mark.parametrize("to", ["nastran", "mat", "fmu", "npz"])
def test_no_file_holds_another_law_than_the_model(curved, tmp_path, to):
    with pytest.raises(StudyError, match=f"'joint' has the law 'curve', which {to} does not ca"):
        export(curved[0], to, out=tmp_path / "joint")
    assert not list(tmp_path.iterdir())


def test_compiled_increments_leave_curves_to_others(curved):
    rom, path = curved
    asked = fy.solve_path(rom, LOADS, compiled=True)
    np.testing.assert_array_equal(asked.pressure, path.pressure)


def test_recovered_paths_have_the_gaps_of_the_law(curved, smooth):
    rom, path = curved
    law = rom.contact.laws["joint"]
    model = with_law(smooth.with_friction(0.3), law)
    recovered = fy.recover_pressure(model, path)
    closure = np.maximum(-recovered.gap, 0.0)
    expected = STIFFNESS * closure + 1e10 * closure**2
    largest = path.max_pressure.max()
    np.testing.assert_allclose(recovered.pressure, expected, rtol=0, atol=1e-9 * largest)


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
@pytest.mark.parametrize("held", [False, True])
def test_derivatives_are_those_of_the_admissible_forces(law, held):
    """Central differences in random directions, at open, sticking and slipping points."""
    rng = np.random.default_rng(0)
    forces = rng.standard_normal((law.components, 400)) * [[1.0], [0.4], [0.4]][: law.components]
    pressing = np.abs(rng.standard_normal(400)) if held else None
    way = rng.standard_normal(forces.shape)
    ends = [law.admissible(forces + h * way, pressing) for h in (1e-7, -1e-7)]
    expected = (ends[0] - ends[1]) / 2e-7
    found = np.einsum("pij,jp->ip", law.derivative(forces, pressing), way)
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
    assert isinstance(first.static_contact.frictional, FrictionalContact)
