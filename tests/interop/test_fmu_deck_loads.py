"""Loads of a deck as inputs of an FMU, simulated by fmpy, against our own integrators."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.model.assembly import NodalLoads

fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed (pip install fmpy)")

from fmpy.validation import validate_fmu  # noqa: E402  only where fmpy is there
from fmu_joints import (  # noqa: E402
    EQUAL,
    N_STEP,
    NEEDS_COMPILER,
    SCHEMES,
    STEP,
    Instance,
    assert_equal,
    held,
    outputs,
    simulate,
    unpacked,
)

pytestmark = NEEDS_COMPILER


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    """A hand-over with two loads of a deck beside the boundary, and its extracted FMUs."""
    forces = {"7": [0, 60.0, -150.0, 0, 0, 0], "step 2": [0, 0, 200.0, 0, 0, 0]}
    loads = {
        name: NodalLoads(nodes=[100, 101], forces=[force] * 2) for name, force in forces.items()
    }
    model = fy.lap_joint(element_size=5.0, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    joint = fy.preload(model.with_load_patterns(loads), {"bolt": 10e3})
    rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=8), compliance=True)
    given = replace(rom, name="lap joint")
    files, places = unpacked(given, tmp_path_factory.mktemp("loaded"))
    assert [validate_fmu(str(file)) for file in files] == [[], []]
    return given, places


@pytest.mark.parametrize("start_loaded", [False, True])
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("version", [2, 3])
def test_factors_of_deck_loads_are_inputs(loaded, version, scheme, start_loaded):
    given, places = loaded
    integrator, start = SCHEMES[scheme]
    load = fy.Load({"tip.Fz": -100.0, "7": 1.5, "step 2": -0.8})
    initial = fy.solve_static(given, load) if start_loaded else None
    ours = fy.solve_transient(
        given,
        load,
        step=STEP,
        duration=N_STEP * STEP,
        integrator=integrator,
        initial=initial,
    )
    table = held([0.0], {"tip.Fz": -100.0}, given.bolts["bolt"].initial_force)
    factors = [("7.factor", float), ("step 2.factor", float)]
    inputs = np.zeros(1, dtype=[*table.dtype.descr, *factors])
    for name in table.dtype.names:
        inputs[name] = table[name]
    inputs["7.factor"], inputs["step 2.factor"] = 1.5, -0.8
    chosen = {name: outputs(given)[name] for name in ("tip.uz", "bolt.force")}
    chosen["joint.max_pressure"] = lambda solution: solution.max_pressure
    options = {**start, "start_loaded": start_loaded}
    result = simulate(places[version], inputs, options, output=list(chosen))
    assert_equal(result, ours, chosen)


def test_derivative_of_a_factor_is_followed(loaded):
    """As a linear history, with communication steps of five steps."""
    given, places = loaded
    load = fy.Load({"7": fy.History([0.0, 1.0], [0.5, 0.5 + 2e3])})
    ours = fy.solve_transient(given, load, step=STEP, duration=20 * STEP)
    instance = Instance(places[2], 2)
    instance.set("7.factor", 0.5)
    instance.start(start_loaded=False)
    assert instance.get("7.factor") == [0.5]
    for step in range(4):
        instance.set("7.factor", 0.5 + 2e3 * instance.time)
        instance.set_rate("7.factor", 2e3)
        instance.fmu.doStep(instance.time, 5 * STEP)
        instance.time += 5 * STEP
        found = instance.get("tip.uz", "joint.max_pressure")
        wanted = [ours.displacement("tip")[5 * step + 5, 2], ours.max_pressure[5 * step + 5]]
        np.testing.assert_allclose(found, wanted, rtol=EQUAL)
    instance.close()
