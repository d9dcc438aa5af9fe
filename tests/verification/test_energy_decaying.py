"""The second-order scheme whose energy cannot grow: its proof in numbers, and what it is for."""

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.simulation.integrators import INTEGRATORS, Motion, named_integrator
from faying.simulation.stepping import transient_solver
from small_system import small_system, two_masses
from windows_of_one import windows_of_one

ROUND_OFF = 1e-12  # of energies of order one, over a thousand steps


def layers(rng, n=6, hard=False, residual=True):
    """Random masses and springs that meet at coupled points, with residual compliance."""
    spread = rng.normal(size=(n, n))
    stiffness = spread @ spread.T + 0.1 * np.eye(n)
    rows = rng.normal(size=(4, n))
    soft = rng.normal(size=(4, 4))
    return small_system(
        np.diag(10.0 ** rng.uniform(-3, 0, n)),
        np.zeros((n, n)),
        stiffness,
        rows,
        gap=0.02,
        stiffness=np.inf if hard else 50.0,
        residual=0.01 * soft @ soft.T if residual else None,
    )


def run(system, rho, step, duration=60.0, force=-2.0):
    return fy.solve_transient(
        system,
        fy.Load({"mass.Fx": force}),
        step=step,
        duration=duration,
        integrator=fy.EnergyDecaying(rho),
    )


@pytest.mark.parametrize("residual", [None, np.array([[0.07]])])
@pytest.mark.parametrize("stop", [8.0, 1e6, np.inf])
@pytest.mark.parametrize("step", [0.01, 0.1, 1.0, 10.0])
def test_the_midpoint_rule_loses_only(step, stop, residual):
    motion = run(two_masses(stop, residual, damping=0.0), 1.0, step, duration=max(8.0, 300 * step))
    closed = motion.contact_forces[:, 0] > 0
    assert np.count_nonzero(np.diff(closed)) > 1  # contact opens and closes
    lost = fy.energy_balance(motion).numerical_dissipation
    assert np.diff(lost).min() > -ROUND_OFF


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8, 1.0])
@pytest.mark.parametrize("kind", ["penalty", "residual", "hard", "hard-residual"])
@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2, 3))]
)
def test_energy_is_never_more_than_was_supplied(kind, rho, seed):
    """On random joints of coupled points, at steps of a tenth to ten times their periods."""
    rng = np.random.default_rng(seed)
    system = layers(rng, hard="hard" in kind, residual="residual" in kind)
    for step in (0.01, 0.1, 1.0):
        motion = run(system, rho, step, duration=100 * step)
        balance = fy.energy_balance(motion)
        scale = np.abs(balance.work).max() + balance.stored.max()
        assert balance.numerical_dissipation.min() > -ROUND_OFF * scale
        assert np.count_nonzero(np.diff(motion.contact_forces > 0, axis=0)) > 0


@pytest.mark.parametrize("hard", [False, True])
def test_mean_contact_obeys_the_law_at_the_end_of_each_step(hard):
    """Pressures that are reported belong to the displacements that are."""
    system = layers(np.random.default_rng(1), hard=hard, residual=True)
    motion = run(system, 0.8, 0.05, duration=5.0)
    contact = system.contact
    pairs = motion.contact_forces @ contact.interpolation
    relative = motion.states @ contact.relative_operator.T + pairs @ contact.residual_compliance
    gap = (contact.interpolation @ relative.T).T + contact.initial_gap
    small = 1e-9 * np.abs(gap).max()  # round-off of the contact problem
    np.testing.assert_allclose(motion.gap, gap, atol=small)
    slack = gap + contact.flexibility * motion.contact_forces
    assert slack.min() > -small
    assert motion.contact_forces.min() >= 0
    assert np.abs(slack * motion.contact_forces).max() < small * motion.contact_forces.max()


def test_rigid_stops_are_not_passed():
    motion = run(two_masses(np.inf, damping=0.1), 0.8, 0.05)
    assert motion.contact_forces.max() > 0.1
    assert motion.gap.min() > -1e-13  # round-off


def test_studies_know_it_by_name():
    assert named_integrator("energy-decaying", 0.5) == fy.EnergyDecaying(0.5)
    assert named_integrator("energy-decaying") == fy.EnergyDecaying()
    assert named_integrator("generalized-alpha") == fy.GeneralizedAlpha()
    assert named_integrator("implicit-euler", None) == fy.ImplicitEuler()
    assert named_integrator(None) == fy.ImplicitEuler()
    assert all(named_integrator(name).name == name for name in INTEGRATORS)
    with pytest.raises(ModelError, match="'euler'; the integrators are implicit-euler"):
        named_integrator("euler")
    with pytest.raises(ModelError, match="between 0 and 1"):
        fy.EnergyDecaying(1.1)


def amplification(rho, frequency):
    """Eigenvalues of one step of unit length on the free motion of a mass on a spring."""
    system = small_system(1.0, 0.0, frequency**2, [[1.0]], gap=1e6, stiffness=1.0)
    scheme, zero = fy.EnergyDecaying(rho), np.zeros((1, 4))
    u, v, a, lagging = np.eye(4)[:, None]
    motion = Motion(u, v, a, zero, lagging, zero)
    right = scheme.right_hand_side(system, motion, 1.0)
    end = scheme.advance(motion, right / scheme.effective_matrix(system, 1.0), zero, 1.0)
    return np.linalg.eigvals(np.vstack([end.u, end.v, end.a, end.lagging]))


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8, 1.0])
def test_what_the_step_cannot_resolve_dies_out_as_told(rho):
    # Double eigenvalues are found to the root of round-off; the limit is off by 1 / (ω h).
    np.testing.assert_allclose(np.abs(amplification(rho, 1e6)), rho, atol=2e-3)


@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8, 1.0])
def test_what_the_step_resolves_is_damped_by_the_cube_of_its_frequency(rho):
    """The damping ratio is 2 d³ (ω h)³, half that of generalized-α, and the period right."""
    frequency, lag = 0.02, fy.EnergyDecaying(rho).lag
    growth = np.log(amplification(rho, frequency) + 0j)
    physical = growth[np.argmin(np.abs(growth - 1j * frequency))]
    slower = (1 / 12 + lag**2) * frequency**2
    # What is left out is of the next order in ω h.
    assert physical.imag / frequency == pytest.approx(1 - slower, abs=frequency**4)
    assert -physical.real / frequency == pytest.approx(
        2 * (lag * frequency) ** 3, abs=2 * frequency**5
    )


@pytest.fixture(scope="module")
def stiff_joint():
    model = fy.lap_joint(element_size=5.0, penalty=1e6, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking(threshold=0.5, stiffness=1e6))


@pytest.mark.long
@pytest.mark.parametrize("rho", [0.8, 1.0])
def test_a_poor_basis_under_a_stiff_penalty_stays_bounded(stiff_joint, rho):
    """Generalized-α ends at 6e14 MPa here; the basis has 20 modes for 384 points."""
    rom = fy.reduce(stiff_joint, fy.craig_bampton(stiff_joint, normal_modes=20))
    load, times = fy.Load({"tip.Mx": -30e3}), {"step": 1e-5, "duration": 1e-2}
    motion = fy.solve_transient(rom, load, **times, integrator=fy.EnergyDecaying(rho))
    # What damps most is the measure; undamped modes of the basis ring, in pressure as well.
    assert motion.max_pressure.max() < 2 * fy.solve_transient(rom, load, **times).max_pressure.max()
    balance = fy.energy_balance(motion)
    gained = -balance.numerical_dissipation
    # The energy kept of the first acceleration is that of a displacement of d h² a₀.
    assert gained.max() < 0.01 * balance.work.max()


@pytest.mark.long
def test_pressures_are_as_accurate_as_those_of_generalized_alpha(stiff_joint):
    """Where that is stable: under a smooth load, of the model with exact compliance."""
    rom = fy.reduce(stiff_joint, fy.craig_bampton(stiff_joint, normal_modes=5), compliance=True)
    times = np.linspace(0, 8e-4, 401)
    swell = np.sin(np.pi * times / times[-1]) ** 2
    load = fy.Load({"tip.Mx": fy.History(times, -15e3 * swell)})

    def pressures(steps, scheme):
        step, duration = times[-1] / steps, times[-1]
        motion = fy.solve_transient(rom, load, step=step, duration=duration, integrator=scheme)
        return motion.pressure[:: steps // 100]

    fine = pressures(1600, fy.GeneralizedAlpha(0.8))
    mine, other, euler = (
        np.sqrt(((pressures(100, scheme) - fine) ** 2).mean()) / fine.max()
        for scheme in (fy.EnergyDecaying(0.8), fy.GeneralizedAlpha(0.8), fy.ImplicitEuler())
    )
    # They differ by terms of second order only, measured 1 %.
    assert mine < 1.2 * other
    assert mine < 0.2 * euler


def test_it_goes_on_where_it_was(stiff_joint):
    rom = fy.reduce(stiff_joint, fy.craig_bampton(stiff_joint, normal_modes=5), compliance=True)
    options = {"step": 1e-5, "duration": 6e-4, "integrator": fy.EnergyDecaying()}
    load = fy.Load({"tip.Mx": -30e3})
    whole = fy.solve_transient(rom, load, **options).contact_forces
    solver = transient_solver(rom, step=1e-5, integrator=fy.EnergyDecaying())
    pieces = list(windows_of_one(solver, load, duration=6e-4, length=25))
    rest = list(windows_of_one(solver, load, duration=6e-4, length=None, restart=pieces[0][1]))
    found = np.concatenate([pieces[0][0].contact_forces, rest[0][0].contact_forces])
    # The same steps; contact may be solved from other factors.
    np.testing.assert_allclose(found, whole, atol=1e-9 * whole.max(), rtol=0)
