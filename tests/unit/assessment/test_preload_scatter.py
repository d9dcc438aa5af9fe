"""The preload-scatter example against joints tightened one by one."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

import faying as fy

PATH = Path(__file__).parents[3] / "examples" / "preload_scatter.py"


@pytest.fixture(scope="module")
def example():
    spec = importlib.util.spec_from_file_location("preload_scatter", PATH)
    module = importlib.util.module_from_spec(spec)
    sys.modules["preload_scatter"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def test_scattered_joints_are_those_tightened_one_by_one(example):
    model = example.joint(element_size=5.0)
    result = example.scatter(model, cases=60, seed=3)
    for case in (0, 17, 59):
        forces = fy.tighten(model, {"bolt": result.preloads[case]}).initial_forces
        load = fy.Load(example.LOAD.forces, bolt_forces=forces)
        full = fy.solve_static(model, load)
        # Statically exact reduced model, tightening to 1e-12: round-off times the condition of H.
        assert result.peaks[case] == pytest.approx(float(full.max_pressure), rel=1e-8)
        assert result.bolt_forces[case] == pytest.approx(float(full.bolt_force("bolt")), rel=1e-8)
        assert result.contact_forces[case] == pytest.approx(float(full.contact_force()), rel=1e-8)


def test_first_order_is_the_tangent_at_the_nominal_preload(example):
    model = example.joint(element_size=5.0)
    result = example.scatter(model, cases=400, seed=1)
    near = np.abs(result.preloads - example.PRELOAD) < 20.0  # within the range of the derivative
    assert near.sum() > 2
    np.testing.assert_allclose(result.linear_peak[near], result.peaks[near], rtol=1e-6)


def test_summary_names_what_it_counts(example):
    text = example.summary(example.scatter(example.joint(element_size=5.0), cases=50))
    assert "50 preloads" in text
    assert "peak pressure [MPa]" in text
