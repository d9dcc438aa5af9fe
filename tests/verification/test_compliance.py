"""Residual interface compliance: static solutions of the reduced model are those of the full one.

The bound 1e-8 of the relative pressure error is issue 3's; round-off of two independent dense
solutions, amplified by the condition of the contact flexibility, leaves 1e-11 to 6e-9.
"""

import numpy as np
import pytest

import faying as fy

AMPLITUDES = {"Fx": 2e3, "Fy": 500.0, "Fz": 750.0, "Mx": 30e3, "My": 30e3, "Mz": 30e3}


def random_loads(model: fy.Model, count: int, seed: int = 0) -> list[fy.Load]:
    """Six tip components and a preload factor, drawn uniformly."""
    rng = np.random.default_rng(seed)
    return [
        fy.Load(
            {f"tip.{name}": size * rng.uniform(-1, 1) for name, size in AMPLITUDES.items()},
            bolt_forces={
                name: rng.uniform(0.3, 1.7) * bolt.initial_force
                for name, bolt in model.bolts.items()
            },
        )
        for _ in range(count)
    ]


def preloaded(**parameters) -> fy.Model:
    model = fy.lap_joint(damping=fy.Rayleigh(alpha=160.0, beta=5e-7), **parameters)
    return fy.preload(model, dict.fromkeys(model.bolts, 10e3), sticking=fy.Sticking())


def reduced(model: fy.Model) -> fy.ReducedModel:
    """With no joint modes at all."""
    return fy.reduce(model, fy.craig_bampton(model, normal_modes=20), compliance=True)


@pytest.fixture(scope="module", params=[1e4, 1e5, "auto", "hard"])
def both(request) -> tuple[fy.Model, fy.ReducedModel]:
    """The full model of a penalty, and the reduced one."""
    model = preloaded(penalty=request.param)
    return model, reduced(model)


def largest_error(model: fy.Model, rom: fy.ReducedModel, count: int) -> float:
    """Largest relative pressure error over random loads."""
    loads = random_loads(model, count)
    full, fast = fy.solve_static_cases(model, loads), fy.solve_static_cases(rom, loads)
    error = np.abs(fast.pressure - full.pressure).max(axis=1) / full.max_pressure
    return float(error.max())


@pytest.mark.long
def test_compliance_is_statically_exact_at_any_penalty(both):
    assert largest_error(*both, count=200) < 1e-8


@pytest.mark.long
@pytest.mark.parametrize(
    "parameters",
    [
        {"curvature": 2e-3, "element_size": 4.0},
        {"shape": "tet10", "element_size": 5.0},
        {
            "plates": 3,
            "width": 40.0,
            "bolt_positions": ((-10.0, -8.0), (10.0, -8.0), (0.0, 10.0)),
            "element_size": 4.0,
        },
    ],
    ids=["curved interface", "tet10", "two interfaces, three bolts"],
)
def test_compliance_is_statically_exact_on_any_joint(parameters):
    model = preloaded(**parameters)
    assert largest_error(model, reduced(model), count=30) < 1e-8


def lc2_step(model: fy.Model) -> tuple[fy.Load, dict]:
    period = 1.0 / fy.preloaded_frequencies(model, 1)[0]
    load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
    return load, {"step": period / 100, "duration": 2 * period}


@pytest.mark.long
def test_compliance_follows_a_step_of_the_load(both):
    # Bounds of issue 3; measured 0.3 to 1.1 % (max), 0.02 % (rms), docs/theory/transient_accuracy.
    model, rom = both
    load, options = lc2_step(model)
    accuracy = fy.compare(
        fy.solve_transient(rom, load, **options), fy.solve_transient(model, load, **options)
    )
    assert accuracy.rms_relative_error < 5e-3
    assert accuracy.p999_relative_error < 1e-2
    assert accuracy.max_relative_error < 3e-2
    assert abs(accuracy.max_pressure_ratio - 1) < 5e-3
    assert accuracy.displacement_error < 1e-3


@pytest.mark.long
def test_compliance_follows_a_smooth_load_by_generalized_alpha(fine_joint):
    model, rom = fine_joint, reduced(fine_joint)
    load, options = lc2_step(model)
    times = np.linspace(0, options["duration"], 400)
    swell = np.sin(np.pi * times / options["duration"]) ** 2
    smooth = fy.Load({key: fy.History(times, value * swell) for key, value in load.forces.items()})
    options["integrator"] = fy.GeneralizedAlpha(0.8)
    accuracy = fy.compare(
        fy.solve_transient(rom, smooth, **options), fy.solve_transient(model, smooth, **options)
    )
    assert accuracy.max_relative_error < 1e-2  # issue 3; measured 0.2 %


def test_interface_compliance_is_symmetric_and_that_of_the_bare_stiffness():
    model = fy.lap_joint(element_size=5.0)
    own = fy.interface_compliance(model)
    given = fy.interface_compliance(model, fy.factorize(model.K))
    # Two factorizations of matrices with condition 1e7.
    np.testing.assert_allclose(own, given, rtol=0, atol=1e-9 * np.abs(own).max())
    # Two sparse products, summed in another order on the two sides of the diagonal.
    np.testing.assert_allclose(own, own.T, rtol=0, atol=1e-14 * np.abs(own).max())
