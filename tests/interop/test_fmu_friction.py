"""FMUs of joints with friction, simulated by fmpy, against our own paths and integrators."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.assessment.slip import slip_states
from faying.contact.laws import Coulomb, Penalty
from faying.export.fmu import library

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
    rubbing_joint,
    simulate,
    written,
)

pytestmark = NEEDS_COMPILER

FORCES = {"tip.Fx": 2500.0, "tip.Fz": -200.0, "tip.Mx": 20e3}
SHARES = ("open_fraction", "stick_fraction", "slip_fraction")


@pytest.fixture(scope="module")
def given():
    return rubbing_joint()


@pytest.fixture(scope="module")
def ours(given):
    """Name of a scheme to the step response of our own integrator."""
    return {
        name: fy.solve_transient(
            given, fy.Load(FORCES), step=STEP, duration=N_STEP * STEP, integrator=integrator
        )
        for name, (integrator, _) in SCHEMES.items()
    }


def size(traction):
    return np.linalg.norm(traction, axis=-1)


FRICTION = {
    "joint.max_traction": lambda solution: size(solution.traction).max(axis=-1),
    "joint.dissipated_energy": lambda solution: np.cumsum(solution.dissipation),
}
AT_POINTS = {
    "joint.pressure": lambda solution: solution.pressure,
    "joint.traction": lambda solution: size(solution.traction),
}


@pytest.mark.parametrize("number", [0, 1], ids=["fmi2", "fmi3"])
def test_fmpy_finds_nothing_wrong(files, number):
    assert validate_fmu(str(files[number])) == []
    described = fmpy.read_model_description(str(files[number])).modelVariables
    units = {v.name: v.unit for v in described}
    assert units["joint.dissipated_energy"] == "N.mm"
    assert units["joint.max_traction"] == "MPa"
    starts = {v.name: v.start for v in described}
    assert float(starts["joint.friction"]) == 0.2
    assert float(starts["joint.tangential_penalty"]) == 8e5


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("version", [2, 3])
def test_step_load_slips_as_with_our_integrators(given, unzipped, ours, version, scheme):
    wanted = ours[scheme]
    chosen = outputs(given) | FRICTION
    if version == 3:
        del chosen["modal.a[1]"]
        chosen |= AT_POINTS
    shares = [f"joint.{share}" for share in SHARES]
    table = held([0.0], FORCES, given.bolts["bolt"].initial_force)
    result = simulate(unzipped[version], table, SCHEMES[scheme][1], output=[*chosen, *shares])
    # 1e-9 of the largest of each, 2e-11 of the peak traction is measured.
    assert_equal(result, wanted, chosen)
    states = slip_states(wanted)
    shared = {"stick_fraction": states.stick_share, "slip_fraction": states.slip_share}
    for name, share in shared.items():
        # What a point does is told alike, but at rest our history has no slip before the first.
        np.testing.assert_allclose(result[f"joint.{name}"][1:], share[1:], rtol=0, atol=1e-12)
    total = sum(result[name] for name in shares)
    np.testing.assert_allclose(total, 1.0, rtol=0, atol=1e-12)
    assert states.slip_share.max() > 0.2  # it is about points that slip
    assert states.stick_share[1:].max() > 0.1  # and others that stick


def law(normal=1e6, friction=0.2, tangential=8e5):
    return Coulomb(Penalty(normal), friction, tangential)


@pytest.mark.parametrize(
    ("parameters", "other"),
    [
        ({}, law()),
        ({"joint.friction": 0.05}, law(friction=0.05)),
        ({"joint.friction": 1.0, "joint.penalty": 1e8}, law(normal=1e8, friction=1.0)),
        ({"joint.tangential_penalty": 1e4}, law(tangential=1e4)),
    ],
)
def test_start_is_the_end_of_a_path_over_the_bolts_to_the_loads(given, unzipped, parameters, other):
    """Also with parameters of the law set before initialization."""
    model = replace(given, contact=replace(given.contact, laws={"joint": other}))
    path = fy.solve_path(model, [fy.Load(), fy.Load(FORCES)])
    instance = Instance(unzipped[3], 3)
    instance.start(start_loaded=True, **FORCES, **parameters)
    references = [instance.references[name] for name in AT_POINTS]
    count = given.contact.n_points
    found = np.reshape(instance.fmu.getFloat64(references, nValues=2 * count), (2, count))
    for values, value in zip(found, AT_POINTS.values(), strict=True):
        wanted = value(path)[-1]
        # Increments are solved to 1e-9 of the largest force at worst; 2e-11 is measured.
        np.testing.assert_allclose(values, wanted, rtol=0, atol=10 * EQUAL * wanted.max())
    assert instance.get("joint.dissipated_energy") == [0.0]
    instance.close()


@pytest.mark.parametrize("integrator", [0, 2])
@pytest.mark.parametrize("version", [2, 3])
def test_restored_state_remembers_slip_and_replays_exactly(unzipped, version, integrator):
    one, other = Instance(unzipped[version], version), Instance(unzipped[version], version)
    seen = ("tip.ux", "joint.max_traction", "joint.dissipated_energy", "joint.slip_fraction")
    pull = {"along": "tip.Fx", "seen": seen}
    one.start(integrator=integrator)
    other.start(**{"joint.friction": 0.7})
    other.run(8, 500.0, **pull)
    one.run(8, 3000.0, **pull)
    time, kept = one.time, one.state("get")
    text = one.state("serialize", kept)
    first = one.run(8, -3000.0, **pull)
    assert np.ptp(first[:, 2]) > 0
    copy = other.state("deserialize", text)
    for instance, state in ((one, kept), (other, copy)):
        instance.state("set", state)
        instance.time = time
        assert np.array_equal(instance.run(8, -3000.0, **pull), first)
        instance.state("free", state)
    one.fmu.reset()
    one.start(integrator=integrator)
    assert one.get("joint.dissipated_energy") == [0.0]
    one.close()
    other.close()


def test_one_of_two_interfaces_has_friction(given, tmp_path):
    """The joint cut in two, without residual compliance."""
    contact, count = given.contact, given.contact.n_points
    shear = contact.shear[[*range(50), *range(count, count + 50)]]
    cut = replace(
        contact,
        slices={"front": slice(0, 50), "back": slice(50, count)},
        laws={"front": law(friction=0.1), "back": Penalty(5e5)},
        residual_compliance=None,
        shear=shear,
    )
    split = replace(given, contact=cut)
    file = written(split, tmp_path / "split.fmu")[1]
    names = {v.name for v in fmpy.read_model_description(str(file)).modelVariables}
    assert not names & {"back.friction", "back.max_traction", "back.slip_fraction"}
    chosen = {
        "tip.ux": lambda solution: solution.displacement("tip")[:, 0],
        "back.max_pressure": lambda solution: solution.pressure[:, 50:].max(axis=1),
        "front.traction": lambda solution: size(solution.traction)[:, :50],
        "front.dissipated_energy": lambda solution: np.cumsum(solution.dissipation),
    }
    table = held([0.0], FORCES, given.bolts["bolt"].initial_force)
    for scheme in ("implicit-euler", "energy-decaying"):
        integrator, start = SCHEMES[scheme]
        wanted = fy.solve_transient(
            split, fy.Load(FORCES), step=STEP, duration=10 * STEP, integrator=integrator
        )
        result = simulate(file, table, start, count=10, output=list(chosen))
        assert_equal(result, wanted, chosen)


def messages_of(place):
    """An instance, and the messages that it logs."""
    said = []
    instance = Instance(place, 3, lambda *given: said.append(given[-1].decode()))
    return instance, said


def test_hard_contact_with_friction(given, tmp_path):
    """Nodal points, at which rigid forces are unique."""
    hard = rubbing_joint(penalty=np.inf, quadrature="nodal", tangential_penalty=np.inf)
    place = fmpy.extract(str(written(hard, tmp_path / "hard.fmu")[1]))
    chosen = outputs(hard) | FRICTION | AT_POINTS
    del chosen["modal.a[1]"]
    wanted = fy.solve_transient(hard, fy.Load(FORCES), step=STEP, duration=10 * STEP)
    table = held([0.0], FORCES, given.bolts["bolt"].initial_force)
    result = simulate(place, table, {}, count=10, output=list(chosen))
    assert_equal(result, wanted, chosen)
    instance, said = messages_of(place)
    with pytest.raises(Exception, match="ExitInitializationMode failed"):
        instance.start(integrator=2)
    assert "energy-decaying steps with friction need elastic contact, and interface 1" in said[-1]
    instance.close()


@pytest.mark.parametrize("value", [-0.1, 11.0, np.nan])
def test_absurd_coefficients_are_refused(unzipped, value):
    instance, said = messages_of(unzipped[3])
    with pytest.raises(Exception, match="ExitInitializationMode failed"):
        instance.start(**{"joint.friction": value})
    assert "the coefficient of friction of interface 1 is" in said[-1]
    assert said[-1].endswith("it must lie between 0 and 10")
    instance.close()


def test_a_step_that_is_not_solved_says_when_where_and_by_how_much(unzipped, tmp_path):
    """With a library that makes no Newton step, from a state of the right one."""
    instance = Instance(unzipped[3], 3)
    instance.start(time=3.0)
    kept = instance.state("get")
    text = instance.state("serialize", kept)
    instance.state("free", kept)
    instance.close()
    place = shutil.copytree(unzipped[3], tmp_path / "weak")
    target, source = next((place / "binaries").glob("*/*")), place / "sources" / "fmi3.c"
    options = ("-std=c99", "-O0", "-shared", "-fPIC", "-DNEWTON_STEPS=0")
    subprocess.run([library.compiler(), *options, source, "-o", target, "-lm"], check=True)
    weak, said = messages_of(place)
    state = weak.fmu.deserializeFMUState(text)
    weak.fmu.setFMUState(state)
    names = ("tip.ux", "bolt.force", "joint.max_traction", "joint.slip_fraction")
    before = weak.get(*names)
    weak.set("tip.Fx", 1e5)
    with pytest.raises(Exception, match="fmi3DoStep failed with status 3"):
        weak.fmu.doStep(3.0, 10 * STEP)
    (message,) = said
    wanted = (
        r"at time 3\.0000\d+: contact was not solved: at contact point \d+ of interface 1 "
        r"\d\.\de[+-]\d\d of the largest force is left; choose a smaller step, or a smaller "
        "coefficient of friction"
    )
    assert re.fullmatch(wanted, message), message
    assert weak.get(*names) == before
    weak.fmu.freeFMUState(state)
    weak.close()


def test_what_recovery_needs_of_friction_travels_along(given, unzipped):
    contact = given.contact
    with np.load(f"{unzipped[3]}/resources/recovery.npz") as kept:
        rows = (kept["shear_values"], kept["shear_columns"], kept["shear_row_starts"])
        moved = np.linspace(-1.0, 1.0, len(kept["relative_compliance"]))
        T = sp.csr_array(rows, shape=(2 * contact.n_points, len(moved)))
        # The same sums, maybe in another order.
        np.testing.assert_allclose(
            (T @ moved).reshape(2, -1), contact.moved(moved)[1:], rtol=0, atol=1e-14
        )
        assert kept["friction"].tolist() == [0.2]
        assert kept["tangential_penalty"].tolist() == [8e5]
