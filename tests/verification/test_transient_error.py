"""The error of a reduced transient, estimated without the full model: near the true one."""

import numpy as np
import pytest

import faying as fy
from faying.assessment.transient_error import FORCE_PATTERNS, KRYLOV_SHAPES, finer_model
from faying.exceptions import ModelError
from faying.simulation.divided_steps import divided_steps

LC2 = {"tip.Fz": -500.0, "tip.Mx": 20e3}
PERIOD = 1.6e-3
TIMES = {"step": PERIOD / 100, "duration": PERIOD / 4}


def rising(part):
    times = np.linspace(0.0, PERIOD, 801)
    shape = 0.5 - 0.5 * np.cos(np.pi * np.minimum(times / (part * PERIOD), 1.0))
    return fy.Load({name: fy.History(times, value * shape) for name, value in LC2.items()})


@pytest.fixture(scope="module")
def bases(joint):
    return {count: fy.craig_bampton(joint, normal_modes=count) for count in (0, 10, 40)}


SCHEMES = [fy.ImplicitEuler(), fy.GeneralizedAlpha(0.8), fy.EnergyDecaying(0.8)]


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("load", [fy.Load(LC2), rising(0.1), rising(0.25)])
def test_estimate_is_near_the_true_error(joint, bases, load, scheme):
    options = {**TIMES, "integrator": scheme}
    full = fy.solve_transient(joint, load, **options)
    for count, basis in bases.items():
        motion = fy.solve_transient(fy.reduce(joint, basis, compliance=True), load, **options)
        found = fy.transient_error(joint, motion, load, integrator=scheme)
        true = fy.compare(motion, full)
        # Within a factor of 2.5: what was measured on three joints, and a little for the fourth,
        # docs/theory/transient_accuracy.md.
        for name in ("max_relative_error", "rms_relative_error"):
            assert 1 / 2.5 < getattr(found, name) / getattr(true, name) < 2.5, (count, name)


def test_tractions_are_estimated_like_pressures(joint):
    rubbing = joint.with_friction(0.2, tangential_penalty=8e5)
    load = fy.Load({"tip.Fz": -500.0, "tip.Fx": 3000.0})
    options = {"step": PERIOD / 100, "duration": PERIOD / 10}
    full = fy.solve_transient(rubbing, load, **options)
    rom = fy.reduce(rubbing, fy.craig_bampton(rubbing, normal_modes=10), compliance=True)
    motion = fy.solve_transient(rom, load, **options)
    found, true = fy.transient_error(rubbing, motion, load), fy.compare(motion, full)
    apart = np.linalg.norm(motion.traction - full.traction, axis=-1).max()
    largest = np.linalg.norm(full.traction, axis=-1).max()
    # The same two maxima: round-off.
    assert true.max_traction_error == pytest.approx(apart / largest, rel=1e-12)
    assert true.max_traction_error > 0.01
    # As of pressures.
    assert 1 / 2.5 < found.max_traction_error / true.max_traction_error < 2.5
    assert "max traction error" in found.facts


def test_nothing_is_said_of_tractions_where_nothing_rubs(joint, bases):
    motion = fy.solve_transient(fy.reduce(joint, bases[10]), fy.Load(LC2), step=1e-5, duration=2e-5)
    found = fy.compare(motion, motion)
    assert found.max_traction_error is None
    assert "max traction error" not in found.facts


def test_estimate_of_a_model_without_residual_compliance_is_its_static_error(joint, bases):
    load = fy.Load(LC2)
    motion = fy.solve_transient(fy.reduce(joint, bases[10]), load, **TIMES)
    true = fy.compare(motion, fy.solve_transient(joint, load, **TIMES))
    found = fy.transient_error(joint, motion, load)
    assert true.max_relative_error > 1.0
    # What such a model lacks in statics the finer one has exactly; the rest is some percent of it.
    assert found.max_relative_error == pytest.approx(true.max_relative_error, rel=0.05)


def test_finer_model_holds_the_coarser_one(joint, classic):
    """It has its trial vectors, up to sixty more and the same static solution."""
    rom = fy.reduce(joint, fy.jim_a(joint, joint_modes=5, classic=classic), compliance=True)
    load = fy.Load(LC2)
    motion = fy.solve_transient(rom, load, **TIMES)
    finer = finer_model(joint, motion)
    assert (
        5 + FORCE_PATTERNS < finer.joint_modes <= 5 + FORCE_PATTERNS * KRYLOV_SHAPES
    )  # dependent ones dropped
    seen = finer.basis.vectors.T @ (joint.K @ finer.basis.vectors)
    inside = np.linalg.lstsq(seen, finer.basis.vectors.T @ (joint.K @ rom.trial_vectors))[0]
    back = finer.basis.vectors @ inside
    scale = np.abs(rom.trial_vectors).max()
    np.testing.assert_allclose(back, rom.trial_vectors, rtol=0, atol=1e-8 * scale)  # round-off
    both = [fy.solve_static(one, load).pressure for one in (rom, finer)]
    np.testing.assert_allclose(*both, rtol=0, atol=1e-8 * both[0].max())  # exact up to round-off
    one, other = (fy.transient_error(model, motion, load) for model in (joint, finer))
    assert one == other


@pytest.mark.long
def test_divided_steps_are_judged_with_the_same_steps(joint, bases):
    load, scheme = rising(0.1), fy.EnergyDecaying(0.0)
    rom = fy.reduce(joint, bases[10], compliance=True)
    options = {"step": PERIOD / 50, "duration": PERIOD / 4, "integrator": scheme}
    motion = fy.solve_transient(rom, load, **options, tolerance=0.05)
    assert motion.substeps.max() > 1
    full = divided_steps(joint, step=PERIOD / 50, tolerance=1.0, integrator=scheme).solve(
        load, duration=PERIOD / 4, substeps=motion.substeps
    )
    found = fy.transient_error(joint, motion, load, integrator=scheme).max_relative_error
    # As with steps of one length.
    assert 1 / 2.5 < found / fy.compare(motion, full).max_relative_error < 2.5


def test_a_load_that_moves_no_contact_is_without_error(joint, bases):
    rom = fy.reduce(joint, bases[10], compliance=True)
    motion = fy.solve_transient(rom, fy.Load({}), **TIMES)
    assert fy.transient_error(joint, motion, fy.Load({})).max_relative_error < 1e-9  # round-off


def test_what_cannot_be_judged(joint, bases):
    rom = fy.reduce(joint, bases[10], compliance=True)
    static = fy.solve_static(rom, fy.Load(LC2))
    full = fy.solve_transient(joint, fy.Load(LC2), step=1e-5, duration=2e-5)
    for solution in (static, full):
        with pytest.raises(ModelError, match="only a transient of a reduced model"):
            fy.transient_error(joint, solution, fy.Load(LC2))
    other = fy.lap_joint(element_size=6.0)
    motion = fy.solve_transient(rom, fy.Load(LC2), step=1e-5, duration=2e-5)
    with pytest.raises(ModelError, match="give the model that was reduced"):
        fy.transient_error(other, motion, fy.Load(LC2))
