"""Compiled time steps against the same steps in Python."""

import numpy as np
import pytest

import faying as fy
from faying.exceptions import ModelError
from faying.simulation import compiled
from faying.simulation.stepping import transient_solver
from windows_of_one import windows_of_one

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
    """Skip where the loop cannot be compiled."""
    pytest.importorskip("numba", reason="needs the extra 'compiled'")


@pytest.fixture(scope="module")
def rom(fine_joint):
    return fy.reduce(fine_joint, fy.craig_bampton(fine_joint, normal_modes=10), compliance=True)


def integrate(rom, load, integrator, **options):
    duration = STEPS * STEP
    return fy.solve_transient(
        rom, load, step=STEP, duration=duration, integrator=integrator, **options
    )


def in_python(solve, *arguments, **options):
    """Return what is solved as where there is no numba."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled, "import_loop", lambda: None)
        return solve(*arguments, **options)


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
    expected = in_python(integrate, rom, load, integrator)
    calls = []
    advance = compiled.CompiledSteps.advance

    def counted(self, *arguments):
        calls.append(advance(self, *arguments))
        return calls[-1]

    monkeypatch.setattr(compiled.CompiledSteps, "advance", counted)
    seen = []
    found = integrate(rom, load, integrator, progress=seen.append)
    assert_equal_histories(found, expected)
    assert (
        sum(done for done, _ in calls) > STEPS / 2
    )  # the loop does the work; it may leave jumps to Python
    assert sum(seen) == STEPS


def test_steps_that_the_loop_leaves_are_done_in_python(monkeypatch, compiled_loop, rom):
    expected = in_python(integrate, rom, LC2, None)
    advance = compiled.CompiledSteps.advance
    turns = iter(range(10**6))

    def reluctant(self, motion, state, applied, history, first):
        if next(turns) % 3:
            return 0, state
        return advance(self, motion, state, applied[:7], history, first)

    monkeypatch.setattr(compiled.CompiledSteps, "advance", reluctant)
    assert_equal_histories(integrate(rom, LC2, None), expected)
    monkeypatch.setattr(
        compiled.CompiledSteps, "advance", lambda self, motion, state, *_: (0, state)
    )
    assert_equal_histories(integrate(rom, LC2, None), expected)


def test_many_points_between_pairs(compiled_loop):
    model = fy.preload(fy.lap_joint(element_size=4.0, order=5), {"bolt": 10e3})
    assert model.contact.n_points > 1000
    many = fy.reduce(model, fy.craig_bampton(model, normal_modes=5), compliance=True)
    expected = in_python(integrate, many, LC2, None)
    assert_equal_histories(integrate(many, LC2, None), expected)


def test_cases_pieces_and_restarts(compiled_loop, rom):
    cases = [LC2, SHAKEN]
    options = {"step": STEP, "duration": STEPS * STEP}
    expected = in_python(fy.solve_transient_cases, rom, cases, **options)
    found = fy.solve_transient_cases(rom, cases, **options)
    for mine, other in zip(found, expected, strict=True):
        assert_equal_histories(mine, other)
    solver = transient_solver(rom, step=STEP)
    pieces = list(windows_of_one(solver, SHAKEN, duration=STEPS * STEP, length=30))
    forces = np.concatenate([piece.contact_forces for piece, _ in pieces])
    small = 1e-9 * expected[1].contact_forces.max()  # as above
    np.testing.assert_allclose(forces, expected[1].contact_forces, rtol=0, atol=small)
    middle = pieces[1][1]
    again = list(windows_of_one(solver, SHAKEN, duration=STEPS * STEP, length=30, restart=middle))
    rest = np.concatenate([piece.contact_forces for piece, _ in again])
    np.testing.assert_array_equal(rest, forces[61:])


def test_a_gap_that_is_no_number_is_refused(compiled_loop, rom):
    wild = fy.Load({"tip.Fz": 1e308, "tip.Mx": 1e308})
    with pytest.raises(ModelError, match="NaN or infinity"), np.errstate(all="ignore"):
        integrate(rom, wild, None)


def test_what_the_loop_has_nothing_for(compiled_loop, joint, rom):
    stops = fy.lap_joint(element_size=5.0, penalty="hard", quadrature="nodal")
    hard = fy.reduce(stops, fy.craig_bampton(stops, normal_modes=5), compliance=True)
    classic = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=5))
    for system in (joint, hard):
        assert transient_solver(system, step=STEP)._compiled is None
    for system in (classic, rom):
        assert transient_solver(system, step=STEP)._compiled is not None


def test_a_basis_alone_steps_as_in_python(compiled_loop, fine_joint):
    """The compliance that a basis alone gives its contact is singular."""
    classic = fy.reduce(fine_joint, fy.craig_bampton(fine_joint, normal_modes=10))
    assert_equal_histories(
        integrate(classic, SHAKEN, None), in_python(integrate, classic, SHAKEN, None)
    )


def test_a_resumed_run_is_compiled_as_the_whole_was(compiled_loop, rom):
    solver, duration = transient_solver(rom, step=STEP), STEPS * STEP
    pieces = list(windows_of_one(solver, LC2, duration=duration, length=40))
    _, middle = pieces[0]
    resumed = list(windows_of_one(solver, LC2, duration=duration, length=40, restart=middle))
    for (mine, _), (other, _) in zip(resumed, pieces[1:], strict=True):
        np.testing.assert_array_equal(mine.contact_forces, other.contact_forces)


def test_an_earlier_run_changes_no_digit(compiled_loop, rom):
    first = integrate(rom, LC2, None)
    integrate(rom, SHAKEN, None)
    again = integrate(rom, LC2, None)
    np.testing.assert_array_equal(first.contact_forces, again.contact_forces)


@pytest.mark.parametrize(
    "error",
    [ImportError("Numba needs NumPy 2.3 or less"), OSError("File too large")],
    ids=["another NumPy", "a full disk"],
)
def test_what_keeps_numba_from_compiling_leaves_steps_in_python(monkeypatch, error):
    def fails(name):
        raise error

    monkeypatch.setattr(compiled, "import_module", fails)
    assert compiled.import_loop.__wrapped__() is None


def test_without_numba_the_argument_that_is_gone_warns(rom):
    def asked():
        assert transient_solver(rom, step=STEP)._compiled is None
        with pytest.warns(DeprecationWarning, match=r"pip install 'faying\[compiled\]'"):
            return integrate(rom, LC2, None, compiled=True)

    expected = in_python(integrate, rom, LC2, None)
    np.testing.assert_array_equal(in_python(asked).contact_forces, expected.contact_forces)
