"""Compiled increments with friction against the same ones in Python."""

from dataclasses import replace
from types import SimpleNamespace

import h5py
import numpy as np
import pytest

import faying as fy
from faying.contact.compiled_frictional import CompiledFrictionalContact, compilable
from faying.contact.frictional import SOLVED, FrictionalContact
from faying.exceptions import ModelError
from faying.export import transient_stream
from faying.simulation import compiled as compiling
from faying.simulation.path_solver import path_solver, paying_increments

STEP, STEPS = 2e-5, 60
SHAKEN = fy.Load(
    {
        "tip.Fz": fy.History(times=np.linspace(0, 1e-3, 21), values=800 * np.sin(np.arange(21))),
        "tip.Fx": 3e3,
    },
    name="shaken",
)
SCHEMES = {"euler": fy.ImplicitEuler(), "decaying": fy.EnergyDecaying()}


@pytest.fixture(scope="module")
def full():
    model = fy.lap_joint(element_size=5.0, penalty=1e6).with_bolt_forces({"bolt": 10e3})
    return model.with_friction(0.2)


@pytest.fixture(scope="module")
def rom(full):
    return fy.reduce(full, fy.craig_bampton(full, normal_modes=10), compliance=True)


def test_what_is_not_solved_compiled_is_solved_in_python(full):
    plain = full.static_contact.frictional
    nothing = SimpleNamespace(
        solve=lambda **_: (60.0, np.inf), unsupported=lambda n: np.zeros((3, n, 9)), ENOUGH=1e-11
    )
    solver = CompiledFrictionalContact(plain)
    vars(solver)["_loop"] = nothing
    pytest.importorskip("numba", reason="needs the extra 'compiled'")
    z_free = 1e-3 * np.random.default_rng(0).standard_normal((3, full.contact.n_points))
    first = plain.solve(z_free)
    found, expected = solver.solve(z_free, first.forces), plain.solve(z_free, first.forces)
    np.testing.assert_array_equal(found.forces, expected.forces)
    assert compilable(plain)


def test_laws_without_compiled_code_are_left_to_python(full):
    class Curve:
        components = 1

    contact = replace(full.contact, laws={"joint": Curve()})
    assert not compilable(FrictionalContact(contact=contact, S=full.static_contact.total))


def test_paths_of_many_increments_are_compiled_unasked(full):
    pytest.importorskip("numba", reason="needs the extra 'compiled'")
    plain, forces = full.static_contact.frictional, np.ones((3, full.contact.n_points))
    paying = paying_increments(len(plain.S))
    assert path_solver(full, paying - 1, forces) is plain
    assert path_solver(full, paying, forces, compiled=False) is plain
    many = path_solver(full, paying, forces)
    assert isinstance(many, CompiledFrictionalContact)
    assert many.about is forces
    # An unstressed joint is no state that a path would stay near.
    asked = path_solver(full, 1, 0 * forces, compiled=True)
    assert isinstance(asked, CompiledFrictionalContact)
    assert asked.about is None


def test_fewer_increments_pay_to_be_compiled_where_each_takes_longer():
    assert [paying_increments(n) for n in (444, 1296, 2472, 10_000)] == [1015, 119, 33, 20]


def test_compiled_paths_need_numba(full, monkeypatch):
    monkeypatch.setattr(compiling, "find_spec", lambda name: None)
    with pytest.raises(ModelError, match="need numba"):
        fy.solve_path(full, [fy.Load()], compiled=True)


def test_pairs_on_springs_yield_as_the_inverse_says(full):
    """Against S (I + B S)⁻¹ written out, with springs of any kind at a third of the points."""
    steps, rng = full.static_contact.frictional.steps, np.random.default_rng(1)
    n = full.contact.n_points
    K = rng.standard_normal((n, 3, 3)) * (rng.random(n) < 0.3)[:, None, None] * 1e3
    G, S = steps.G.toarray(), steps.S
    at = (np.arange(3)[:, None] * n + np.arange(n)).T
    B = sum(G[rows].T @ own @ G[rows] for rows, own in zip(at, K, strict=True))
    expected = S @ np.linalg.inv(np.eye(len(S)) + B @ S)
    # The condition of I + B S, some 1e3, multiplies round-off.
    np.testing.assert_allclose(steps.supported(K), expected, rtol=0, atol=1e-10 * abs(S).max())


@pytest.mark.slow
def test_compiled_paths_and_cycles_are_those_in_python(full):
    """Small loads stay near where they begin, large ones do not: both compliances are used."""
    pytest.importorskip("numba", reason="needs the extra 'compiled'")
    tight = fy.solve_path(full, [fy.Load()])
    for amplitude in (0.3, 3.0):
        found, expected = (
            fy.solve_cycles(full, fy.Load({"tip.Fx": 1e3}), amplitude, tight, compiled=compiled)
            for compiled in (True, False)
        )
        assert len(found.energies) == len(expected.energies)
        # Increments are solved to 1e-11 of the largest force, and their conditions multiply that.
        for name in ("contact_forces", "shear_forces", "shear_slip", "states"):
            mine, other = getattr(found.cycle, name), getattr(expected.cycle, name)
            small = 1e-8 * np.abs(other).max()
            np.testing.assert_allclose(mine, other, rtol=0, atol=small, err_msg=name)
        again = fy.solve_cycles(full, fy.Load({"tip.Fx": 1e3}), amplitude, tight, compiled=True)
        np.testing.assert_array_equal(again.cycle.states, found.cycle.states)


@pytest.mark.slow  # compiles, half a minute once per installation
@pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)
def test_compiled_steps_with_friction_are_those_in_python(rom, scheme):
    pytest.importorskip("numba", reason="needs the extra 'compiled'")
    options = {"step": STEP, "duration": STEPS * STEP, "integrator": scheme}
    found = fy.solve_transient(rom, SHAKEN, compiled=True, **options)
    expected = fy.solve_transient(rom, SHAKEN, **options)
    # Increments are solved to 1e-11 of the largest force, and their conditions multiply that.
    for name in ("contact_forces", "shear_forces", "states", "shear_slip", "dissipation"):
        mine, other = getattr(found, name), getattr(expected, name)
        small = 1e-8 * np.abs(other).max()
        np.testing.assert_allclose(mine, other, rtol=0, atol=small, err_msg=name)
    assert expected.dissipation.sum() > 0


@pytest.mark.slow
def test_compiled_pieces_go_on_to_the_bit(rom, tmp_path, monkeypatch):
    pytest.importorskip("numba", reason="needs the extra 'compiled'")
    monkeypatch.setattr(transient_stream, "PIECE", 10)
    options = {"step": STEP, "compiled": True, "fields": ("pressure", "traction", "slip")}
    whole, parts = tmp_path / "whole.h5", tmp_path / "parts.h5"
    fy.stream_transient(rom, SHAKEN, whole, duration=30 * STEP, **options)
    fy.stream_transient(rom, SHAKEN, parts, duration=20 * STEP, **options)
    fy.stream_transient(rom, SHAKEN, parts, duration=30 * STEP, resume=True, **options)
    with h5py.File(whole) as one, h5py.File(parts) as other:
        for field in options["fields"]:
            np.testing.assert_array_equal(one[field][()], other[field][()])


@pytest.mark.slow
def test_compiled_increments_solve_what_random_paths_ask(full):
    """Judged by the law in Python: every increment that the compiled code says it has solved."""
    pytest.importorskip("numba", reason="needs the extra 'compiled'")
    rng = np.random.default_rng(3)
    for friction in (0.05, 0.3, 1.0):
        rubbing = full.with_friction(friction)
        plain = rubbing.static_contact.frictional
        solver, solved = CompiledFrictionalContact(plain), 0
        n = rubbing.contact.n_points
        forces = plain.solve(np.vstack([np.full((1, n), -1e-3), np.zeros((2, n))])).forces
        for _ in range(20):
            move = 3e-4 * (rng.standard_normal((3, 1)) + rng.standard_normal((3, n)))
            z_free = move - np.array([[1e-3], [0], [0]])
            found = solver.solve(z_free, forces)
            wrong = plain._residual(found.forces, plain._slack(found.forces, z_free), None)
            assert np.abs(wrong).max() <= SOLVED * np.abs(found.forces).max()
            solved += found.residual > 0
            forces = found.forces
        assert solved > 10


@pytest.mark.slow
def test_long_runs_are_compiled_unasked(rom, monkeypatch):
    pytest.importorskip("numba", reason="needs the extra 'compiled'")
    options = {"step": STEP, "duration": 10 * STEP}
    asked = fy.solve_transient(rom, SHAKEN, compiled=True, **options)
    plain = fy.solve_transient(rom, SHAKEN, **options)
    monkeypatch.setattr("faying.simulation.stepping.worth_compiling", lambda n_step: n_step >= 10)
    unasked = fy.solve_transient(rom, SHAKEN, **options)
    np.testing.assert_array_equal(unasked.contact_forces, asked.contact_forces)
    assert not np.array_equal(unasked.contact_forces, plain.contact_forces)
