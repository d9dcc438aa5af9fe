"""The C sources of FMUs: compiled strictly, run under sanitizers, and for joints of other kinds."""

import logging
import os
import shutil
import subprocess
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import faying as fy
from faying.contact.laws import Penalty
from faying.export import fmu as fmu_export
from faying.export.fmu import archive, library

fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed (pip install fmpy)")

from fmpy.validation import validate_fmu  # noqa: E402  only where fmpy is there
from fmu_joints import (  # noqa: E402
    EQUAL,
    FORCES,
    N_STEP,
    STEP,
    assert_equal,
    handed_over,
    held,
    outputs,
    rubbing_joint,
    simulate,
    written,
)

pytestmark = pytest.mark.skipif(
    library.compiler() is None, reason="there is no C compiler (apt install gcc)"
)

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic")


@pytest.fixture
def only_fmi2(monkeypatch):
    """Compile no library for FMI 3.0 where a test does not look at it."""
    compiled = archive._binary

    def one(given, sources, version):
        return compiled(given, sources, version) if version == 2 else {}

    monkeypatch.setattr(archive, "_binary", one)


@pytest.fixture(scope="module")
def given():
    return handed_over()


def strictly_compiled(place, target, *options, source="fmi2.c"):
    command = [library.compiler(), *STRICT, "-DFMI2_OVERRIDE_FUNCTION_PREFIX", *options]
    command += [f"-I{place}/sources", str(source), "-o", str(target), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.long
@pytest.mark.parametrize("version", [2, 3])
def test_sources_compile_without_warnings(unzipped, tmp_path, version):
    source = f"{unzipped[version]}/sources/fmi{version}.c"
    options = ("-O2", "-shared", "-fPIC", "-Wshadow", "-Wconversion")
    strictly_compiled(unzipped[version], tmp_path / "joint.so", *options, source=source)


def test_source_distribution_names_functions_after_the_model(unzipped, tmp_path):
    """FMI 2.0 demands the prefix, for several models are linked into one program."""
    target, source = tmp_path / "joint.o", f"{unzipped[2]}/sources/fmi2.c"
    subprocess.run([library.compiler(), "-c", source, "-o", target], check=True)
    assert b"joint_fmi2DoStep" in target.read_bytes()
    source = f"{unzipped[3]}/sources/fmi3.c"
    prefix = "-DFMI3_FUNCTION_PREFIX=lap_"
    subprocess.run([library.compiler(), prefix, "-c", source, "-o", target], check=True)
    assert b"lap_fmi3DoStep" in target.read_bytes()


@pytest.fixture(scope="module")
def rubbing(tmp_path_factory):
    """Extracted FMU of a joint with friction, of few points."""
    folder = tmp_path_factory.mktemp("rubbing")
    rom = rubbing_joint(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
    return fmpy.extract(str(written(rom, folder / "joint.fmu")[0]))


@pytest.mark.long
@pytest.mark.parametrize("tool", ["sanitizers", "valgrind"])
def test_memory_is_sound(unzipped, rubbing, tmp_path, tool):
    driver = tmp_path / "driver"
    source = Path(__file__).parent / "fmu_driver.c"
    if tool == "valgrind" and shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed (apt install valgrind)")
    checked = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    options = ("-g", "-O1", *(checked if tool == "sanitizers" else ()))
    try:
        strictly_compiled(unzipped[2], driver, *options, source=source)
    except AssertionError as error:
        if "san" in str(error):
            pytest.skip("the compiler has no sanitizers")
        raise
    watch = ("valgrind", "-q", "--error-exitcode=99", "--leak-check=full")
    for place in (unzipped[2], rubbing):
        drive((*(watch if tool == "valgrind" else ()), driver), place)


def drive(command, place):
    """Run the driver with the variables of an extracted FMU."""
    description = fmpy.read_model_description(place)
    chosen = [
        [v.valueReference for v in description.modelVariables if v.causality == causality]
        for causality in ("input", "output")
    ]
    resources = "file://" + os.fspath(place).replace(" ", "%20") + "/resources"
    done = subprocess.run(
        [*command, resources, description.guid, *map(str, map(len, chosen))],
        input=" ".join(str(reference) for group in chosen for reference in group),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


PLATES = {"plates": 3, "shape": "hex20", "element_size": 10.0, "hole_radius": 0.0}
"""Eight-node facets have more points than displacements, and weak springs bring round-off."""


@pytest.mark.parametrize(
    ("quadrature", "plates"), [("nodal", {}), ("gauss", {}), ("nodal", PLATES)]
)
def test_hard_contact(tmp_path, quadrature, plates):
    given = handed_over(penalty="hard", quadrature=quadrature, **plates)
    file = written(given, tmp_path / "hard.fmu")[0]
    assert validate_fmu(str(file)) == []
    system, bolt = given, given.bolts["bolt"].initial_force
    ours = fy.solve_transient(system, fy.Load(FORCES), step=STEP, duration=N_STEP * STEP)
    chosen = outputs(system)
    if quadrature == "gauss" or plates:
        # Forces of single points are not unique there; where they sit is decided at 1e-7 relative.
        del chosen["joint.max_pressure"], chosen["joint.open_fraction"]
    if plates:
        del chosen["joint.contact_force"]
    result = simulate(file, held([0.0], FORCES, bolt), {}, output=list(chosen))
    assert_equal(result, ours, chosen)


def test_without_compiler_it_has_sources_only(given, tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(library, "COMPILERS", ("no-such-compiler",))
    with caplog.at_level(logging.WARNING, logger="faying"):
        files = fmu_export.write(given, tmp_path / "9 joint.fmu")
    assert "no C compiler found (no-such-compiler)" in caplog.text
    for file in files:
        assert validate_fmu(str(file)) == []
        names = zipfile.ZipFile(file).namelist()
        assert not any(name.startswith("binaries") for name in names)
        assert "sources/motion.c" in names


@pytest.mark.long
def test_equal_joints_give_equal_files(given, files, tmp_path, only_fmi2):
    again = fmu_export.write(given, tmp_path / "joint.fmu")
    assert again[0].read_bytes() == files[0].read_bytes()


def test_milliseconds_become_seconds(given, tmp_path):
    """A joint in mm, kg, ms has the same motion in seconds as it has in milliseconds."""
    model = given
    other = replace(
        model,
        units="mm-kg-ms",
        M=model.M * 1e3,
        C=model.C * 1.0,
        K=model.K * 1e-3,
        contact=replace(
            model.contact,
            laws={"joint": Penalty(1e-3 * model.contact.penalty[0])},
            residual_compliance=1e3 * model.contact.residual_compliance,
        ),
        bolts={
            name: type(bolt)(
                name=name,
                elongation=bolt.elongation,
                stiffness=1e-3 * bolt.stiffness,
                initial_force=1e-3 * bolt.initial_force,
            )
            for name, bolt in model.bolts.items()
        },
    )
    file = written(other, tmp_path / "ms.fmu")[0]
    assert validate_fmu(str(file)) == []
    bolt = model.bolts["bolt"].initial_force
    forces = {name: 1e-3 * force for name, force in FORCES.items()}
    chosen = ["tip.uz", "tip.vz", "joint.max_pressure"]
    result = simulate(file, held([0.0], forces, 1e-3 * bolt), {}, output=chosen)
    ours = fy.solve_transient(model, fy.Load(FORCES), step=STEP, duration=N_STEP * STEP)
    values = outputs(model)
    assert_equal({"tip.uz": result["tip.uz"], "tip.vz": result["tip.vz"],
                  "joint.max_pressure": 1e3 * result["joint.max_pressure"]},
                 ours, {name: values[name] for name in chosen})  # fmt: skip


def test_several_interfaces_bolts_and_nodes(given, tmp_path):
    """The joint cut in two interfaces of different penalty, with two bolts and no residual."""
    model, contact = given, given.contact
    count = contact.n_points
    bolt, tip = model.bolts["bolt"], model.boundaries["tip"]
    split = replace(
        model,
        contact=replace(
            contact,
            slices={"front": slice(0, 50), "back": slice(50, count)},
            laws={
                "front": Penalty(contact.penalty[0]),
                "back": Penalty(0.5 * contact.penalty[0]),
            },
            residual_compliance=None,
        ),
        bolts={
            name: replace(
                bolt,
                name=name,
                stiffness=part * bolt.stiffness,
                initial_force=part * bolt.initial_force,
            )
            for name, part in (("M6", 0.7), ("M4", 0.3))
        },
        boundaries={"ends": replace(tip, name="ends", nodes=[7, 7, 7, 9, 9, 9])},
    )
    file = written(split, tmp_path / "split.fmu")[0]
    assert validate_fmu(str(file)) == []
    load = fy.Load({"ends.Fz": -500.0}, bolt_forces={"M6": 8e3})
    initial = fy.solve_static(split, fy.Load(bolt_forces={"M6": 8e3}))
    ours = fy.solve_transient(split, load, step=STEP, duration=N_STEP * STEP, initial=initial)
    chosen = {
        "ends.7.uz": lambda solution: solution.displacement("ends")[:, 2],
        "ends.9.rx": lambda solution: solution.displacement("ends")[:, 3],
        "front.contact_force": lambda solution: solution.contact_force("front"),
        "back.contact_force": lambda solution: solution.contact_force("back"),
        "back.open_fraction": lambda solution: solution.open_fraction("back"),
        "M6.force": lambda solution: solution.bolt_force("M6"),
        "M4.force": lambda solution: solution.bolt_force("M4"),
    }
    names = ("ends.7.Fz", "M6.initial_force", "M4.initial_force")
    values = (-500.0, 8e3, split.bolts["M4"].initial_force)
    table = np.array([(0.0, *values)], dtype=[("time", float), *((n, float) for n in names)])
    result = simulate(file, table, {}, output=list(chosen))
    for name, value in chosen.items():
        expected = value(ours)
        atol = EQUAL * np.abs(expected).max()
        np.testing.assert_allclose(result[name], expected, rtol=0, atol=atol, err_msg=name)
