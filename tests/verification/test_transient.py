"""Time integration against closed forms, its order, and where the energy goes."""

from functools import partial

import numpy as np
import pytest
from oscillator import Oscillator
from spring_gap import SpringGap

import faying as fy
from faying.assessment.energy import energy_balance
from faying.exceptions import ModelError
from small_system import small_system, two_masses

FAR = 1e6  # a gap no motion here closes
OSCILLATOR = Oscillator(mass=2.0, damping=0.3, stiffness=5.0)
PUSH = fy.Load({"mass.Fx": 3.0})
SCHEMES = {
    "euler": fy.ImplicitEuler(),
    "trapezoidal": fy.GeneralizedAlpha(1.0),
    "alpha": fy.GeneralizedAlpha(0.8),
    "annihilating": fy.GeneralizedAlpha(0.0),
    "decaying": fy.EnergyDecaying(0.8),
    "midpoint": fy.EnergyDecaying(1.0),
    "decaying-fast": fy.EnergyDecaying(0.0),
}


def free_oscillator():
    o = OSCILLATOR
    return small_system(o.mass, o.damping, o.stiffness, [[1.0]], gap=FAR, stiffness=1.0)


def beside_a_stop(stiffness=1.0, stop=8.0, gap=0.0, damping=0.0):
    return small_system(1.0, damping, stiffness, [[1.0]], gap=gap, stiffness=stop)


def largest_error(system, scheme, step, exact, duration=6.0, **options):
    motion = fy.solve_transient(
        system,
        options.pop("load", PUSH),
        step=step,
        duration=duration,
        integrator=scheme,
        **options,
    )
    return np.abs(motion.states[:, 0] - exact(motion.times)).max()


@pytest.mark.parametrize(
    ("scheme", "order"),
    [("euler", 1), *((name, 2) for name in SCHEMES if name != "euler")],
)
def test_order_on_a_step_without_contact(scheme, order):
    system = free_oscillator()
    assert fy.solve_transient(system, PUSH, step=0.01, duration=6.0).contact_forces.max() == 0

    def exact(times):
        return OSCILLATOR.step_response(3.0, times)

    errors = [largest_error(system, SCHEMES[scheme], h, exact) for h in (0.02, 0.01, 0.005)]
    observed = np.log2(np.array(errors[:-1]) / errors[1:])
    # The next term of the expansion is an order higher: 5 % at these steps.
    np.testing.assert_allclose(observed, order, atol=0.06)
    assert errors[-1] < {1: 2e-2, 2: 1e-4}[order]  # of 1.1


def free_vibration_beside_a_stop(scheme, step):
    stop = SpringGap(stiffness=1.0, stop_stiffness=8.0)
    system = beside_a_stop()
    pulled = fy.solve_static(system, fy.Load({"mass.Fx": 0.7}))
    return largest_error(
        system,
        scheme,
        step,
        lambda t: stop.free_vibration(0.7, t),
        duration=10.0,
        load=fy.Load(),
        initial=pulled,
    )


@pytest.mark.long
@pytest.mark.parametrize(
    ("scheme", "order"),
    [("euler", 1), ("trapezoidal", 2), ("alpha", 2), ("decaying", 2), ("midpoint", 2)],
)
def test_order_when_contact_opens_and_closes(scheme, order):
    """The vibration of a mass that meets an elastic stop three times."""
    errors = [free_vibration_beside_a_stop(SCHEMES[scheme], h) for h in (0.01, 0.005, 0.0025)]
    observed = np.log2(np.array(errors[:-1]) / errors[1:])
    # The force has a kink at the stop, which costs no order but makes the error uneven.
    np.testing.assert_allclose(observed, order, atol=0.3)
    assert errors[-1] < {1: 0.05, 2: 1e-4}[order] * 0.7


@pytest.mark.parametrize("gap", [0.0, 0.4])
@pytest.mark.parametrize("stop", [8.0, np.inf])
@pytest.mark.parametrize("force", [-3.0, -0.2, 1.0])
def test_static_answer_of_spring_and_stop(gap, stop, force):
    exact = SpringGap(stiffness=1.0, stop_stiffness=stop, gap=gap)
    solution = fy.solve_static(beside_a_stop(stop=stop, gap=gap), fy.Load({"mass.Fx": force}))
    assert solution.states[0] == pytest.approx(exact.displacement(force), abs=1e-14)  # round-off
    assert solution.contact_forces[0] == pytest.approx(exact.contact_force(force), abs=1e-14)


def test_step_settles_at_the_static_answer():
    system = beside_a_stop(gap=0.4, damping=1.0)
    load = fy.Load({"mass.Fx": -3.0})
    motion = fy.solve_transient(system, load, step=0.05, duration=60.0)
    static = fy.solve_static(system, load)
    # Damped to exp(-0.5 · 60).
    np.testing.assert_allclose(motion.states[-1], static.states, atol=1e-9)
    np.testing.assert_allclose(motion.pressure[-1], static.pressure, atol=1e-9)


def test_a_rigid_stop_is_not_passed():
    system = beside_a_stop(stop=np.inf, gap=0.4)
    motion = fy.solve_transient(system, fy.Load({"mass.Fx": -3.0}), step=0.01, duration=5.0)
    assert motion.states.min() >= -0.4 - 1e-14  # round-off
    assert (motion.contact_forces >= 0).all()
    assert motion.max_penetration.max() < 1e-14


def test_history_is_followed():
    """A ramp so slow that the response is static."""
    system = small_system(1e-6, 0.0, 5.0, [[1.0]], gap=FAR, stiffness=1.0)
    ramp = fy.History(times=np.array([0.0, 1.0]), values=np.array([0.0, 10.0]))
    motion = fy.solve_transient(system, fy.Load({"mass.Fx": ramp}), step=0.1, duration=2.0)
    # Euler's error in a static ramp is zero but for the mass of 1e-6.
    expected = np.interp(motion.times, [0, 1], [0, 2])
    np.testing.assert_allclose(motion.states[:, 0], expected, atol=1e-4)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_prestressed_joint_stays_at_rest(scheme, joint):
    motion = fy.solve_transient(
        joint, fy.Load(), step=1e-5, duration=2e-4, integrator=SCHEMES[scheme]
    )
    start = fy.solve_static(joint)
    small = 1e-7 * np.abs(start.states).max()  # residual of the static solution times 20 steps
    np.testing.assert_allclose(
        motion.states, np.broadcast_to(start.states, motion.states.shape), rtol=0, atol=small
    )
    drift = np.abs(motion.pressure - start.pressure).max() / start.max_pressure
    assert drift < 1e-6  # the same, times penalty over stiffness


@pytest.mark.parametrize("scheme", ["euler", "alpha", "trapezoidal", "decaying", "decaying-fast"])
def test_massless_degrees_of_freedom(scheme):
    """A spring in front of the mass: its end has no mass and follows at once."""
    K = np.array([[5.0, -2.0], [-2.0, 2.0]])
    system = small_system(
        np.diag([2.0, 0.0]), np.zeros((2, 2)), K, [[1.0, 0.0]], gap=FAR, stiffness=1.0, loaded=1
    )
    motion = fy.solve_transient(system, PUSH, step=0.002, duration=3.0, integrator=SCHEMES[scheme])
    exact = Oscillator(mass=2.0, damping=0.0, stiffness=3.0).step_response(3.0, motion.times)
    error = np.abs(motion.states[:, 0] - exact).max()
    assert error < (0.02 if scheme == "euler" else 1e-4)  # first and second order of 0.002
    # The massless end is in equilibrium: 2 (u₁ − u₀) = 3.
    end = motion.states[5:, 1] - motion.states[5:, 0]
    if scheme != "trapezoidal":  # which keeps the first jump ringing for ever
        np.testing.assert_allclose(end[200:], 1.5, atol=1e-3)


def test_refuses_steps_that_are_none():
    for step, duration in ((0.0, 1.0), (-1.0, 1.0), (2.0, 1.0), (np.nan, 1.0)):
        with pytest.raises(ModelError, match="the step must be positive"):
            fy.solve_transient(free_oscillator(), PUSH, step=step, duration=duration)


# Energy ------------------------------------------------------------------------------------------


def run(system, scheme, step=0.01, duration=6.0, load=PUSH):
    return fy.solve_transient(
        system, load, step=step, duration=duration, integrator=SCHEMES[scheme]
    )


APART = fy.Load({"mass.Fx": -0.3})


damped_masses = partial(two_masses, damping=0.1)


def test_midpoint_rule_keeps_the_balance_to_round_off():
    balance = energy_balance(run(free_oscillator(), "trapezoidal", step=0.1))
    assert balance.stored.max() > 1.0
    # Only round-off of 60 steps, times the averaging of the first acceleration (1e-3)².
    np.testing.assert_allclose(balance.numerical_dissipation, 0, atol=1e-6)
    assert balance.dissipated[-1] > 0.1
    assert (np.diff(balance.dissipated) >= 0).all()


@pytest.mark.parametrize("residual", [None, np.array([[0.07]])])
@pytest.mark.parametrize("scheme", ["trapezoidal", "alpha", "decaying", "midpoint"])
def test_imbalance_with_contact_falls_with_the_square_of_the_step(scheme, residual):
    system = damped_masses(8.0, residual)
    motion = run(system, scheme, load=APART)
    closed = motion.contact_forces[:, 0] > 0
    assert np.count_nonzero(np.diff(closed)) > 3  # contact opens and closes
    worst = [
        np.abs(energy_balance(run(system, scheme, h, load=APART)).numerical_dissipation).max()
        for h in (0.04, 0.005)
    ]
    # A factor of 8 in the step is 64 in the square; the instants of impact make it uneven.
    assert worst[1] < worst[0] / 25
    assert worst[1] < 1e-4 * energy_balance(motion).stored.max()


@pytest.mark.parametrize("residual", [None, np.array([[0.07]])])
@pytest.mark.parametrize("stop", [8.0, np.inf])
@pytest.mark.parametrize("step", [0.3, 0.03])
def test_implicit_euler_only_loses(step, stop, residual):
    balance = energy_balance(run(damped_masses(stop, residual), "euler", step, load=APART))
    lost = balance.numerical_dissipation
    # Exactly ½|Δv|²_M + ½|Δu|²_K + ½|Δλ|²_(D+R) + λ₁ᵀs₀ in every step; round-off may show.
    assert (np.diff(lost) > -1e-13).all()
    assert lost[-1] > 0.01 * balance.work[-1]


def test_energy_terms_of_a_static_state():
    system = damped_masses(8.0, np.array([[0.07]]))
    motion = run(system, "euler", step=0.5, duration=0.5)
    u, force = motion.states[0], motion.contact_forces[0, 0]
    assert force > 0
    balance = energy_balance(motion)
    assert balance.kinetic[0] == balance.work[0] == balance.bolt_work[0] == 0
    assert balance.strain[0] == pytest.approx(0.5 * u @ system.K @ u, rel=1e-14)
    assert balance.contact[0] == pytest.approx(0.5 * force**2 * (1 / 8.0 + 0.07), rel=1e-14)


def test_energy_balance_of_the_cantilever(joint, classic):
    """Full and reduced model: the balance closes, and both lose alike."""
    load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})
    lost = []
    for system in (joint, fy.reduce(joint, classic, compliance=True)):
        motion = fy.solve_transient(
            system, load, step=2e-6, duration=4e-4, integrator=fy.GeneralizedAlpha(0.8)
        )
        balance = energy_balance(motion)
        assert balance.work[-1] > 10.0  # N mm
        lost.append(balance.numerical_dissipation[-1] / balance.work[-1])
    # The step resolves the load's onset of all but the highest modes.
    assert max(map(abs, lost)) < 0.02


def test_energy_balance_needs_a_transient(joint):
    with pytest.raises(ModelError, match="is not a transient"):
        energy_balance(fy.solve_static(joint))


def test_what_implicit_euler_returns_balances_at_every_instant():
    system = beside_a_stop(gap=0.4, damping=0.7)
    motion = fy.solve_transient(
        system, fy.Load({"mass.Fx": -3.0}), step=0.01, duration=5.0, integrator=fy.ImplicitEuler()
    )
    assert motion.contact_forces.max() > 0  # it strikes the stop
    u, v, a = motion.states[1:, 0], motion.velocities[1:, 0], motion.accelerations[1:, 0]
    left = a + 0.7 * v + u
    # M ü + C u̇ + K u = f + Gᵀλ to round-off over the square of the step.
    np.testing.assert_allclose(left, -3.0 + motion.contact_forces[1:, 0], rtol=0, atol=1e-10)
