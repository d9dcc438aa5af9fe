"""The error of a reduced transient, estimated without the full model: near the true one."""

import numpy as np
import pytest

import faying as fy
from faying.assessment.transient_error import finer_model
from faying.exceptions import ModelError

LC2 = {"tip.Fz": -500.0, "tip.Mx": 20e3}
PERIOD = 1.6e-3
TIMES = {"step": PERIOD / 100, "duration": PERIOD / 4}


def rising(part):
    times = np.linspace(0.0, PERIOD, 801)
    shape = 0.5 - 0.5 * np.cos(np.pi * np.minimum(times / (part * PERIOD), 1.0))
    return fy.Load({name: fy.History(times, value * shape) for name, value in LC2.items()})


@pytest.fixture(scope="module")
def rom(joint):
    return fy.reduce(joint, fy.craig_bampton(joint, normal_modes=10), compliance=True)


@pytest.fixture(scope="module")
def finer(joint, rom):
    return finer_model(joint, rom)


@pytest.mark.parametrize("scheme", [fy.ImplicitEuler(), fy.GeneralizedAlpha(0.8)])
@pytest.mark.parametrize("load", [fy.Load(LC2), rising(0.1), rising(0.25)])
def test_estimate_is_near_the_true_error(joint, rom, finer, load, scheme):
    options = {**TIMES, "integrator": scheme}
    motion = fy.solve_transient(rom, load, **options)
    true = fy.compare(motion, fy.solve_transient(joint, load, **options))
    found = fy.transient_error(finer, motion, load, integrator=scheme)
    # Within a factor of 3: what was measured on three joints, docs/theory/transient_accuracy.md.
    for name in ("max_relative_error", "rms_relative_error"):
        assert 1 / 3 < getattr(found, name) / getattr(true, name) < 3, name


def test_finer_model_holds_the_coarser_one(joint, classic):
    """It has its joint modes, twice its normal modes and the same static solution."""
    rom = fy.reduce(joint, fy.jim_a(joint, joint_modes=5, classic=classic), compliance=True)
    finer = finer_model(joint, rom)
    assert finer.joint_modes == 5
    assert len(finer.basis) == len(rom.basis) + 10
    both = [fy.solve_static(one, fy.Load(LC2)).pressure for one in (rom, finer)]
    np.testing.assert_allclose(*both, rtol=0, atol=1e-8 * both[0].max())  # exact up to round-off
    load, motion = fy.Load(LC2), fy.solve_transient(rom, fy.Load(LC2), **TIMES)
    one, other = (fy.transient_error(model, motion, load) for model in (joint, finer))
    assert one == other


def test_what_cannot_be_judged(joint, rom):
    static = fy.solve_static(rom, fy.Load(LC2))
    full = fy.solve_transient(joint, fy.Load(LC2), step=1e-5, duration=2e-5)
    for solution in (static, full):
        with pytest.raises(ModelError, match="only a transient of a reduced model"):
            fy.transient_error(joint, solution, fy.Load(LC2))
    none = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=0), compliance=True)
    with pytest.raises(ModelError, match="no normal modes to take twice of"):
        finer_model(joint, none)
