"""Energy that nothing supplied is found, however a transient is run."""

import json
import logging

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import faying as fy
from faying.cli import app
from faying.exceptions import ConvergenceError
from faying.simulation.energy_guard import MOST_GAIN, EnergyGuard
from faying.simulation.instants import Instants
from faying.simulation.integrators import Motion
from faying.simulation.stepping import transient_solver
from small_study import NO_REPORT
from small_system import small_system, two_masses
from windows_of_one import windows_of_one

WILD = fy.GeneralizedAlpha(1.0)
PULL = fy.Load({"mass.Fx": -2.0}, name="pull")
REST = fy.Load(name="rest")


def run(system, load=PULL, steps=400, integrator=WILD, **options):
    return fy.solve_transient(
        system, load, step=0.1, duration=0.1 * steps, integrator=integrator, **options
    )


@pytest.fixture(scope="module")
def wild():
    """A joint on which generalized-α gains energy: a poor basis under a stiff penalty."""
    model = fy.lap_joint(element_size=5.0, penalty=1e6, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    joint = fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking(threshold=0.5, stiffness=1e6))
    return fy.reduce(joint, fy.craig_bampton(joint, normal_modes=20))


BENT = fy.Load({"tip.Mx": -30e3}, name="bent")


def bend(system, integrator):
    return fy.solve_transient(system, BENT, step=1e-5, duration=1e-2, integrator=integrator)


@pytest.mark.long
def test_the_shortest_known_case_is_found(wild, caplog):
    motion = bend(wild, fy.GeneralizedAlpha())
    assert motion.max_pressure.max() > 1e10
    assert motion.energy_gain > 10 * MOST_GAIN
    assert len(caplog.messages) == 1
    assert "bent: the time integration gained" in caplog.text
    assert "EnergyDecaying" in caplog.text


@pytest.mark.parametrize("scheme", [fy.ImplicitEuler(), fy.EnergyDecaying()])
def test_schemes_that_cannot_gain_are_let_alone(wild, caplog, scheme):
    assert bend(wild, scheme).energy_gain < 0.1 * MOST_GAIN
    assert not caplog.messages


@pytest.mark.parametrize("scheme", [fy.ImplicitEuler(), fy.GeneralizedAlpha(), WILD])
def test_sound_transients_are_let_alone(joint, classic, caplog, scheme):
    """Full and reduced, loaded and at rest, where nothing moves but round-off."""
    for system in (joint, fy.reduce(joint, classic, compliance=True)):
        for load in (fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}), REST):
            motion = fy.solve_transient(system, load, step=1e-5, duration=2e-4, integrator=scheme)
            assert motion.energy_gain < 0.3 * MOST_GAIN
    assert not caplog.messages


def test_released_energy_is_not_taken_for_a_gain():
    """A structure that is let go moves although no load does any work."""
    system = two_masses(8.0)
    pulled = fy.solve_static(system, PULL)
    motion = run(system, REST, initial=pulled, integrator=fy.GeneralizedAlpha(0.8))
    assert np.abs(np.diff(motion.states, axis=0)).max() > 0.01
    assert motion.energy_gain < 0.3 * MOST_GAIN


def test_gain_is_what_the_balance_has_lost():
    """Where there is no damping; else it is found to be less, never more."""
    for damping in (0.0, 0.5):
        motion = run(two_masses(1e3, damping=damping))
        balance = fy.energy_balance(motion)
        moving = np.abs(balance.work + balance.bolt_work) + balance.kinetic
        shares = -balance.numerical_dissipation[1:] / np.maximum.accumulate(moving)[1:]
        if damping == 0.0:
            # The balance takes the first step's force at its end; the same here.
            assert motion.energy_gain == pytest.approx(shares.max(), rel=1e-2)
        assert motion.energy_gain <= 1.01 * max(shares.max(), 0.0)


@pytest.mark.parametrize("scheme", [fy.EnergyDecaying, fy.GeneralizedAlpha])
@pytest.mark.parametrize("rho", [0.0, 0.5, 0.8, 1.0])
def test_no_energy_is_made_by_a_jump(joint, scheme, rho):
    """The first steps after it, of a twentieth of the period; 17 times the work was made once.

    Energy-decaying steps make none in exact arithmetic. Generalized-alpha is bounded by the guard
    alone, and at 1 makes 1e-3 here by contact that opens.
    """
    step = 1 / fy.preloaded_frequencies(joint, 1)[0] / 20
    load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3})
    motion = fy.solve_transient(joint, load, step=step, duration=10 * step, integrator=scheme(rho))
    assert motion.energy_gain < (1e-12 if scheme is fy.EnergyDecaying else 5e-3)


def test_every_step_is_looked_at():
    """A motion that is given more than its load can do for one step, and loses it in the next."""
    system = two_masses(8.0)
    start = Motion(*np.zeros((5, 2)), contact=np.zeros(1))
    history = Instants.empty(1, 30, system)
    history.velocities[0, 7] = 1.0
    guard = EnergyGuard(
        system=system,
        step=0.1,
        force_weight=1.0,
        loads=["still"],
        starts=[start],
        ledgers=[None],
        inputs=np.zeros((1, 31, 2)),
        history=history,
    )
    (found,) = guard.audit()
    assert found.gain == pytest.approx(1.0, rel=0.01)  # of what was stored at rest a share counts


def test_side_by_side_each_has_its_own():
    system, loads = two_masses(1e3), [PULL, fy.Load({"mass.Fx": 1e-3}, name="push")]
    together = fy.solve_transient_cases(system, loads, step=0.1, duration=40.0, integrator=WILD)
    alone = [run(system, load).energy_gain for load in loads]
    assert [one.energy_gain for one in together] == pytest.approx(alone, rel=1e-9)
    assert together[0].energy_gain > MOST_GAIN > together[1].energy_gain


def test_pieces_and_restarts_keep_the_ledger(caplog):
    system = two_masses(1e3)
    late = fy.Load({"mass.Fx": fy.History(np.array([0.0, 15.0, 15.1]), [0.0, 0.0, -2.0])})
    whole = run(system, late).energy_gain
    caplog.clear()
    solver = transient_solver(system, step=0.1, integrator=WILD)
    pieces = list(windows_of_one(solver, late, duration=40.0, length=90))
    gains = [piece.energy_gain for piece, _ in pieces]
    assert gains[0] < MOST_GAIN < gains[-1] == pytest.approx(whole, rel=1e-12)
    assert gains == sorted(gains)
    assert len(caplog.messages) == 1
    rest = windows_of_one(solver, late, duration=40.0, length=None, restart=pieces[1][1])
    assert next(rest)[0].energy_gain == pytest.approx(whole, rel=1e-12)


def test_streams_say_it(tmp_path):
    system, path = two_masses(1e3), tmp_path / "long.h5"
    options = {"step": 0.1, "integrator": WILD}
    fy.stream_transient(system, PULL, path, duration=20.0, **options)
    fy.stream_transient(system, PULL, path, duration=40.0, resume=True, **options)
    with h5py.File(path) as file:
        assert file.attrs["energy_gain"] == pytest.approx(run(system).energy_gain, rel=1e-9)


def test_compiled_steps_are_watched():
    pytest.importorskip("numba", reason="needs the extra 'compiled'")
    stiff = two_masses(1e3)
    assert transient_solver(stiff, step=0.1, integrator=WILD)._compiled is not None
    assert run(stiff).energy_gain > 5 * MOST_GAIN


def test_numbers_that_overflow_are_explained():
    """The motion grows until nothing is a number; that is not the fault of the loads."""
    rng = np.random.default_rng(0)
    spread = rng.normal(size=(6, 6))
    system = small_system(
        np.diag(10.0 ** rng.uniform(-3, 0, 6)),
        np.zeros((6, 6)),
        spread @ spread.T + 0.1 * np.eye(6),
        rng.normal(size=(4, 6)),
        gap=0.02,
        stiffness=5e3,
    )
    with pytest.raises(ConvergenceError, match="pull: the time integration gained many times"):
        fy.solve_transient(system, PULL, step=1.0, duration=1e5, integrator=WILD)


STUDY = """
title = "Wild"
[model]
source = "lap-joint"
lap_joint = { element_size = 5.0 }
[[interface]]
name = "joint"
penalty = 1e6
[[bolt]]
name = "bolt"
preload = 10e3
[sticking]
stiffness = 1e6
[damping]
alpha = 160.0
beta = 5e-7
[reduction]
normal_modes = 20
methods = ["craig-bampton", "compliance"]
[validation]
half_step = false
[[load_case]]
name = "bent"
kind = "step"
forces = [{ boundary = "tip", component = "Mx", value = -30e3 }]
duration = 5e-3
step = 1e-5
integrator = "generalized-alpha"
"""


@pytest.mark.long
def test_a_run_ends_with_status_1_and_names_what_grew(tmp_path):
    path, out = tmp_path / "wild.toml", tmp_path / "out"
    path.write_text(STUDY)
    ended = CliRunner().invoke(app, ["run", str(path), "--out", str(out)])
    assert ended.exit_code == 1, ended.output
    assert isinstance(ended.exception, SystemExit)
    summary = json.loads((out / "summary.json").read_text())
    assert summary["converged"] is False
    (message,) = summary["not_converged"]
    assert message.startswith("bent, craig-bampton with 0 joint modes: the time integration gained")
    assert 'integrator = "energy-decaying"' in message
    assert "the time integration gained" in (out / "report.html").read_text()
    path.write_text(STUDY.replace("generalized-alpha", "energy-decaying") + NO_REPORT)
    ended = CliRunner().invoke(app, ["run", str(path), "--out", str(tmp_path / "sound")])
    assert ended.exit_code == 0, ended.output


@pytest.fixture(autouse=True)
def _warnings_only(caplog):
    caplog.set_level(logging.WARNING, logger="faying")
