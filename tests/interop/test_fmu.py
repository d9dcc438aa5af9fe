"""FMUs of the joint, read, checked and simulated by fmpy, against our own integrators."""

import json
import shutil
import xml.etree.ElementTree as ET
import zipfile
from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.contact.laws import Penalty
from faying.export.fmu import archive

fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed (pip install fmpy)")

from fmpy.validation import validate_fmu  # noqa: E402  only where fmpy is there
from fmu_joints import (  # noqa: E402
    EQUAL,
    FORCES,
    N_STEP,
    NEEDS_COMPILER,
    SCHEMES,
    STEP,
    Instance,
    assert_equal,
    handed_over,
    held,
    outputs,
    simulate,
)

pytestmark = NEEDS_COMPILER


@pytest.fixture(scope="module")
def given():
    return handed_over()


@pytest.mark.parametrize("number", [0, 1], ids=["fmi2", "fmi3"])
def test_fmpy_finds_nothing_wrong(files, number):
    assert validate_fmu(str(files[number])) == []
    description = fmpy.read_model_description(str(files[number]))
    said = {v.name: v.description for v in description.modelVariables}
    assert said["tip.Fx"] == "force on tip"
    assert said["tip.Mx"] == "moment on tip"
    assert said["bolt.force"] == "axial force of bolt 'bolt', tension positive"
    units = {v.name: v.unit for v in description.modelVariables}
    assert units["tip.Fz"] == "N"
    assert units["tip.Mx"] == "N.mm"
    assert units["joint.max_pressure"] == "MPa"
    bases = {u.name: (u.baseUnit.kg, u.baseUnit.m, u.baseUnit.s, u.baseUnit.factor)
             for u in description.unitDefinitions}  # fmt: skip
    assert bases["MPa"] == (1, -1, -2, pytest.approx(1e6, rel=1e-14))
    assert bases["N.mm"] == (1, 2, -2, pytest.approx(1e-3, rel=1e-14))


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("version", "every"), [(2, 1), (3, 1), (2, 8)])
def test_step_load_moves_it_as_our_integrators_do(given, unzipped, version, every, scheme):
    """Held over all of a communication step too."""
    integrator, start = SCHEMES[scheme]
    system, bolt = given, given.bolts["bolt"].initial_force
    ours = fy.solve_transient(
        system, fy.Load(FORCES), step=STEP, duration=N_STEP * STEP, integrator=integrator
    )
    chosen = outputs(system)
    if version == 3:
        del chosen["modal.a[1]"]
        chosen["joint.pressure"] = lambda solution: solution.pressure
        chosen["modal.a"] = lambda solution: solution.accelerations
    table = held([0.0], FORCES, bolt)
    result = simulate(unzipped[version], table, start, interval=every * STEP, output=list(chosen))
    assert_equal(result, ours, chosen, every)
    # The test is about contact that opens and closes.
    assert np.ptp(ours.open_fraction("joint")) > 0.05


@pytest.mark.parametrize("every", [1, 5])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_ramp_is_followed_inside_communication_steps(given, unzipped, scheme, every):
    """Derivatives of inputs make a linear history exact, whatever the communication step."""
    integrator, start = SCHEMES[scheme]
    system = given
    times = np.array([0.0, N_STEP * STEP])
    load = fy.Load({name: fy.History(times, [0.1 * f, f]) for name, f in FORCES.items()})
    ours = fy.solve_transient(
        system, load, step=STEP, duration=N_STEP * STEP, integrator=integrator
    )
    # By hand: fmpy.simulate_fmu takes derivatives of exactly nine inputs.
    instance = Instance(unzipped[2], 2)
    initial = {name: 0.1 * force for name, force in FORCES.items()}
    instance.start(start_loaded=False, **start, **initial)
    chosen = outputs(system)
    result = [instance.get(*chosen)]
    for step in range(0, N_STEP, every):
        for name, force in FORCES.items():
            instance.set(name, (0.1 + 0.9 * step / N_STEP) * force)
            instance.set_rate(name, 0.9 * force / (N_STEP * STEP))
        instance.fmu.doStep(step * STEP, every * STEP)
        result.append(instance.get(*chosen))
    instance.close()
    assert_equal(dict(zip(chosen, np.transpose(result), strict=True)), ours, chosen, every)


def test_derivatives_last_for_one_communication_step(unzipped):
    instance = Instance(unzipped[2], 2)
    instance.start()
    instance.set("tip.Fz", -50.0)
    instance.set_rate("tip.Fz", -30.0 / STEP)
    for step in range(3):
        instance.fmu.doStep(step * STEP, STEP)
    assert instance.get("tip.Fz")[0] == pytest.approx(-80.0, rel=1e-14)
    instance.close()


def test_communication_steps_that_are_no_multiple_are_divided_equally(given, unzipped):
    """2.5 steps of 1e-5 become three of 2.5e-5 / 3."""
    system, bolt = given, given.bolts["bolt"].initial_force
    ours = fy.solve_transient(system, fy.Load(FORCES), step=2.5 * STEP / 3, duration=50 * STEP)
    table = held([0.0], FORCES, bolt)
    chosen = outputs(system)
    result = simulate(unzipped[2], table, {}, interval=2.5 * STEP, count=50, output=list(chosen))
    # Steps are whole multiples of 2^-24 of step_size, so that round-off of the communication
    # points does not ask for new matrices: 3e-8 of a step, times some ten from motion to pressure.
    for name in ("tip.uz", "joint.max_pressure", "bolt.force"):
        np.testing.assert_allclose(result[name], chosen[name](ours)[::3], rtol=1e-6)


def test_start_is_in_equilibrium_with_the_forces_at_initialization(given, unzipped):
    system, bolt = given, given.bolts["bolt"].initial_force
    load = fy.Load(FORCES, bolt_forces={"bolt": 0.7 * bolt})
    ours = fy.solve_static(system, load)
    table = held([0.0], FORCES, 0.7 * bolt)
    chosen = {name: value for name, value in outputs(system).items() if ".v" not in name}
    del chosen["modal.a[1]"]
    start = {"start_loaded": True}
    result = simulate(unzipped[2], table, start, count=5, output=list(chosen))
    for name in ("tip.uz", "bolt.force", "joint.contact_force", "joint.max_pressure"):
        # 1e-8: inputs that do not change leave it at rest, but for round-off over h²
        np.testing.assert_allclose(result[name], chosen[name](ours), rtol=1e-8)


def test_penalty_may_be_set_before_initialization(given, unzipped):
    contact = given.contact
    softer = fy.solve_static(
        replace(given, contact=replace(contact, laws={"joint": Penalty(0.1 * contact.penalty[0])}))
    )
    start = {"joint.penalty": 0.1 * float(contact.penalty[0]), "start_loaded": True}
    table = held([0.0], {}, given.bolts["bolt"].initial_force)
    result = simulate(unzipped[2], table, start, count=1, output=["joint.max_pressure"])
    assert result["joint.max_pressure"][0] == pytest.approx(softer.max_pressure, rel=EQUAL)
    assert abs(softer.max_pressure / fy.solve_static(given).max_pressure - 1) > 0.05


@pytest.mark.parametrize("version", [2, 3])
def test_restored_state_replays_exactly(unzipped, version):
    one, other = Instance(unzipped[version], version), Instance(unzipped[version], version)
    one.start()
    # Parameters are part of the state, and matrices that belong to others must not survive.
    other.start(integrator=1, rho_infinity=0.3)
    other.run(3, 50.0, 1.3 * STEP)
    one.run(10, -800.0)
    time, kept = one.time, one.state("get")
    text = one.state("serialize", kept)
    first = one.run(20, 900.0, 1.3 * STEP)
    copy = other.state("deserialize", text)
    for instance, state in ((one, kept), (other, copy)):
        instance.state("set", state)
        instance.time = time
        assert np.array_equal(instance.run(20, 900.0, 1.3 * STEP), first)
        instance.state("free", state)
        instance.close()


@pytest.mark.parametrize("version", [2, 3])
def test_two_instances_do_not_know_of_each_other(unzipped, version):
    alone = Instance(unzipped[version], version)
    alone.start()
    expected = alone.run(12, -700.0)
    alone.close()
    one, two = Instance(unzipped[version], version), Instance(unzipped[version], version)
    one.start()
    two.start(step_size=0.4 * STEP)
    seen = []
    for step in range(12):
        one.set("tip.Fz", -700.0 * np.cos(step))
        two.set("tip.Fz", 300.0)
        two.fmu.doStep(two.time, STEP)
        one.fmu.doStep(one.time, STEP)
        one.time, two.time = one.time + STEP, two.time + STEP
        seen.append(one.get("tip.uz", "tip.vz", "bolt.force", "joint.max_pressure"))
    assert np.array_equal(np.array(seen), expected)
    one.close()
    two.close()


@pytest.mark.parametrize("version", [2, 3])
def test_reset_starts_anew(unzipped, version):
    instance = Instance(unzipped[version], version)
    instance.start(time=3.0)
    first = instance.run(8, -600.0)
    instance.fmu.reset()
    instance.start(time=3.0)
    assert np.array_equal(instance.run(8, -600.0), first)
    instance.close()


@pytest.mark.parametrize(
    ("name", "value"),
    [("step_size", -1.0), ("rho_infinity", 2.0), ("joint.penalty", 0.0), ("tip.Fz", np.nan)],
)
def test_wrong_values_are_refused(unzipped, name, value):
    instance = Instance(unzipped[2], 2)
    with pytest.raises(Exception, match="fmi2ExitInitializationMode failed with status 3"):
        instance.start(**{name: value})
    instance.close()


def test_steps_backwards_need_a_state(unzipped):
    instance = Instance(unzipped[2], 2)
    instance.start()
    instance.run(3, 100.0)
    with pytest.raises(Exception, match="fmi2DoStep failed with status 3"):
        instance.fmu.doStep(0.0, STEP)
    with pytest.raises(Exception, match="fmi2SetReal failed with status 3"):
        instance.set("step_size", 2 * STEP)
    instance.close()


@pytest.mark.parametrize("place", [20, 150, 5000, -8])
def test_damaged_resources_are_refused(unzipped, tmp_path, place):
    folder = shutil.copytree(unzipped[2], tmp_path / "damaged")
    file = folder / "resources" / "joint.bin"
    content = bytearray(file.read_bytes())
    content[place] ^= 0x10
    file.write_bytes(content)
    with pytest.raises(Exception, match="instantiate"):
        Instance(folder, 2)


def test_recovery_matrices_travel_along(given, unzipped):
    """Pressures of the full model from a history that fmpy recorded, as our recovery gives them."""
    bolt = given.bolts["bolt"].initial_force
    names = ["joint.max_pressure", "modal.v", "modal.a"]
    result = simulate(unzipped[3], held([0.0], FORCES, bolt), {}, output=names)
    with np.load(f"{unzipped[3]}/resources/recovery.npz") as kept:
        count = len(kept["relative_compliance"])
        inputs = np.zeros(kept["input_rows"].shape[0])
        inputs[[2, 3]], inputs[-1] = list(FORCES.values()), -bolt
        ports = np.hstack([kept["contact_columns"], kept["input_rows"]])
        free = inputs @ ports - result["modal.a"] @ kept["inertia"].T
        free = free - result["modal.v"] @ kept["damping"].T
        N = np.zeros((len(kept["weights"]), count))
        rows = np.repeat(np.arange(len(N)), np.diff(kept["interpolation_row_starts"]))
        N[rows, kept["interpolation_columns"]] = kept["interpolation_values"]
        gap = kept["initial_gap"] + free[-1, :count] @ N.T
        H = N @ kept["relative_compliance"] @ N.T
        H += np.diag(1 / (kept["penalty"] * kept["weights"]))
        pressure = fy.contact_problem(H, gap).solve().forces / kept["weights"]
    # The compliance model itself is within a few per mille of what is recovered from it; a sign or
    # order that were wrong would be off by far more.
    assert pressure.max() == pytest.approx(result["joint.max_pressure"][-1], rel=0.05)


def test_step_size_is_that_of_the_run_or_follows_the_lowest_mode(given):
    frequency = 1 / (archive.DEFAULT_INSTANTS * archive._step_size(given, None))
    lowest = archive.linearize(given).frequencies(1)[0]
    # rounded to one digit, so off by a third at most
    assert frequency == pytest.approx(lowest, rel=0.35)


def test_description_is_well_formed_without_fmpy(files):
    """Names and references are each used once."""
    for file in files:
        root = ET.fromstring(zipfile.ZipFile(file).read("modelDescription.xml"))
        entries = list(root.find("ModelVariables"))
        names = [entry.get("name") for entry in entries]
        references = [entry.get("valueReference") for entry in entries]
        assert len(set(names)) == len(names) == len(set(references)), json.dumps(names)
