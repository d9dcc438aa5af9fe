"""Compiled time steps against the same steps in Python."""

import logging

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.simulation import compiled
from faying.simulation.transient import transient_pieces, transient_solver

LC2 = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
SHAKEN = fy.Load(
    {
        "tip.Fz": fy.History(times=np.linspace(0, 2e-3, 41), values=800 * np.sin(np.arange(41))),
        "tip.Fx": 4e3,
    },
    name="shaken",
)
STEP, STEPS = 2e-5, 100


@pytest.fixture
def compiled_loop():
    """Compile, for one test only (see tests/conftest.py)."""
    pytest.importorskip("numba", reason="needs the extra 'compiled'")
    fy.compile_steps()


@pytest.fixture(scope="module")
def rom(fine_joint):
    return fy.reduce(fine_joint, fy.craig_bampton(fine_joint, normal_modes=10), compliance=True)


def integrate(rom, load, integrator, **options):
    return fy.solve_transient(
        rom, load, step=STEP, duration=STEPS * STEP, integrator=integrator, **options
    )


def in_python(monkeypatch, compute):
    with monkeypatch.context() as patch:
        patch.setattr("faying.simulation.stepping.worth_compiling", lambda *_: False)
        return compute()


def assert_equal_histories(found, expected):
    assert found.times.tolist() == expected.times.tolist()
    # Forces are closed to 1e-11 of the largest one; velocities and accelerations amplify what that
    # does to displacements by the step, which is a fiftieth of the shortest period kept.
    for name, small in [
        ("contact_forces", 1e-9),
        ("gap", 1e-9),
        ("states", 1e-10),
        ("velocities", 1e-8),
        ("accelerations", 1e-6),
    ]:
        mine, other = getattr(found, name), getattr(expected, name)
        scale = np.abs(other).max()
        np.testing.assert_allclose(mine, other, rtol=0, atol=small * scale, err_msg=name)
    assert (found.contact_forces >= 0).all()
    assert found.iterations[1:].min() >= 1


@pytest.mark.parametrize("load", [LC2, SHAKEN], ids=lambda load: load.name)
@pytest.mark.parametrize(
    "integrator", [fy.ImplicitEuler(), fy.GeneralizedAlpha()], ids=lambda scheme: scheme.name
)
def test_steps_are_those_in_python(monkeypatch, compiled_loop, rom, load, integrator):
    expected = in_python(monkeypatch, lambda: integrate(rom, load, integrator))
    calls = []
    advance = compiled.CompiledSteps.advance

    def counted(self, *arguments):
        calls.append(advance(self, *arguments))
        return calls[-1]

    monkeypatch.setattr(compiled.CompiledSteps, "advance", counted)
    seen = []
    found = integrate(rom, load, integrator, progress=seen.append)
    assert_equal_histories(found, expected)
    assert sum(calls) > STEPS / 2  # the loop does the work; it may leave jumps to Python
    assert sum(seen) == STEPS


def test_steps_that_the_loop_leaves_are_done_in_python(monkeypatch, compiled_loop, rom):
    expected = in_python(monkeypatch, lambda: integrate(rom, LC2, None))
    advance = compiled.CompiledSteps.advance
    turns = iter(range(10**6))

    def reluctant(self, motion, guess, trend, applied, history, first):
        if next(turns) % 3:
            return 0
        return advance(self, motion, guess, trend, applied[:7], history, first)

    monkeypatch.setattr(compiled.CompiledSteps, "advance", reluctant)
    assert_equal_histories(integrate(rom, LC2, None), expected)
    monkeypatch.setattr(compiled.CompiledSteps, "advance", lambda *_: 0)
    assert_equal_histories(integrate(rom, LC2, None), expected)


def test_many_points_between_pairs(monkeypatch, compiled_loop):
    model = fy.preload(fy.lap_joint(element_size=4.0, order=5), {"bolt": 10e3})
    assert model.contact.n_points > 1000
    many = fy.reduce(model, fy.craig_bampton(model, normal_modes=5), compliance=True)
    expected = in_python(monkeypatch, lambda: integrate(many, LC2, None))
    assert_equal_histories(integrate(many, LC2, None), expected)


def test_cases_pieces_and_restarts(monkeypatch, compiled_loop, rom):
    cases = [LC2, SHAKEN]
    options = {"step": STEP, "duration": STEPS * STEP}
    expected = in_python(monkeypatch, lambda: fy.solve_transient_cases(rom, cases, **options))
    for mine, other in zip(fy.solve_transient_cases(rom, cases, **options), expected, strict=True):
        assert_equal_histories(mine, other)
    pieces = list(transient_pieces(rom, SHAKEN, length=30, **options))
    forces = np.concatenate([piece.contact_forces for piece, _ in pieces])
    small = 1e-9 * expected[1].contact_forces.max()  # as above
    np.testing.assert_allclose(forces, expected[1].contact_forces, rtol=0, atol=small)
    middle = pieces[1][1]
    rest = list(transient_pieces(rom, SHAKEN, length=None, restart=middle, **options))
    np.testing.assert_allclose(rest[0][0].contact_forces, forces[61:], rtol=0, atol=small)


def test_a_gap_that_is_no_number_is_refused(compiled_loop, rom):
    wild = fy.Load({"tip.Fz": 1e308, "tip.Mx": 1e308})
    with pytest.raises(ModelError, match="NaN or infinity"), np.errstate(all="ignore"):
        integrate(rom, wild, None)


def test_what_the_loop_has_nothing_for(joint, rom):
    stops = fy.lap_joint(element_size=5.0, penalty="hard", quadrature="nodal")
    hard = fy.reduce(stops, fy.craig_bampton(stops, normal_modes=5), compliance=True)
    classic = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=5))
    for system, expected in [(joint, None), (hard, None), (classic, None)]:
        assert transient_solver(system, step=STEP)._compiled is expected
    assert transient_solver(rom, step=STEP)._compiled is not None


def test_long_runs_are_compiled_unasked(monkeypatch, caplog, rom):
    pytest.importorskip("numba", reason="needs the extra 'compiled'")
    monkeypatch.setattr(compiled, "PAYING_STEPS", STEPS)
    fy.solve_transient(rom, LC2, step=STEP, duration=(STEPS - 1) * STEP)
    assert not compiled.worth_compiling(1, 100)
    with caplog.at_level(logging.INFO, logger="faying"):
        integrate(rom, LC2, None)
    assert "compiling the time steps of reduced models" in caplog.text
    assert compiled.worth_compiling(1, 100)
    assert not compiled.worth_compiling(1, 10**4)


def test_full_models_do_not_wait_for_a_loop_that_is_not_theirs(monkeypatch, joint):
    monkeypatch.setattr(compiled, "PAYING_STEPS", 1)
    fy.solve_transient(joint, LC2, step=STEP, duration=2 * STEP)
    assert not compiled.worth_compiling(0, 100)


def test_without_numba(monkeypatch):
    monkeypatch.setattr(compiled, "find_spec", lambda _: None)
    assert not compiled.worth_compiling(10**6, 100)
    with pytest.raises(ModelError, match=r"pip install 'faying\[compiled\]'"):
        fy.compile_steps()
