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
from faying.exceptions import StudyError
from faying.export import fmu as fmu_export
from faying.export.fmu import archive, library, resources

fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed (pip install fmpy)")

from fmpy.validation import validate_fmu  # noqa: E402  only where fmpy is there
from fmu_joints import (  # noqa: E402
    FORCES,
    N_STEP,
    STEP,
    assert_equal,
    handed_over,
    held,
    outputs,
    simulate,
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


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    # Masters read resources through a URI: blanks and letters beyond ASCII must survive.
    return tmp_path_factory.mktemp("fmu für dich")


@pytest.fixture(scope="module")
def files(given, folder):
    return fmu_export.write(given, folder / "joint.fmu")


@pytest.fixture(scope="module")
def unzipped(files, folder):
    """FMI version to folder of the extracted FMU."""
    return {
        version: fmpy.extract(str(file), unzipdir=str(folder / f"fmi{version}"))
        for version, file in zip((2, 3), files, strict=True)
    }


def strictly_compiled(place, target, *options, source="fmi2.c"):
    command = [library.compiler(), *STRICT, "-DFMI2_OVERRIDE_FUNCTION_PREFIX", *options]
    command += [f"-I{place}/sources", str(source), "-o", str(target), "-lm"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


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


@pytest.mark.parametrize("tool", ["sanitizers", "valgrind"])
def test_memory_is_sound(unzipped, tmp_path, tool):
    place, driver = unzipped[2], tmp_path / "driver"
    source = Path(__file__).parent / "fmu_driver.c"
    if tool == "valgrind" and shutil.which("valgrind") is None:
        pytest.skip("valgrind is not installed (apt install valgrind)")
    checked = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    try:
        strictly_compiled(
            place, driver, "-g", "-O1", *(checked if tool == "sanitizers" else ()), source=source
        )
    except AssertionError as error:
        if "san" in str(error):
            pytest.skip("the compiler has no sanitizers")
        raise
    variables = fmpy.read_model_description(place).modelVariables
    chosen = [
        [v.valueReference for v in variables if v.causality == c] for c in ("input", "output")
    ]
    resources = "file://" + os.fspath(place).replace(" ", "%20") + "/resources"
    arguments = [resources, fmpy.read_model_description(place).guid, *map(str, map(len, chosen))]
    watch = ("valgrind", "-q", "--error-exitcode=99", "--leak-check=full")
    done = subprocess.run(
        [*(watch if tool == "valgrind" else ()), driver, *arguments],
        input=" ".join(str(reference) for group in chosen for reference in group),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def rebuilt(unzipped, folder, *options):
    """Copy of the extracted FMU whose library is compiled differently."""
    place = shutil.copytree(unzipped, folder / "rebuilt")
    target = next((place / "binaries").glob("*/*"))
    source = place / "sources" / "fmi2.c"
    strictly_compiled(place, target, "-O3", "-shared", "-fPIC", *options, source=source)
    return place


def test_pairs_give_what_points_give(given, unzipped, tmp_path):
    """The way for interfaces of a thousand points and more, here on a small one."""
    place = rebuilt(unzipped[2], tmp_path, "-DMANY_POINTS=1")
    system, bolt = given.model, given.model.bolts["bolt"].initial_force
    ours = fy.solve_transient(system, fy.Load(FORCES), step=STEP, duration=N_STEP * STEP)
    chosen = outputs(system)
    result = simulate(place, held([0.0], FORCES, bolt), {}, output=list(chosen))
    assert_equal(result, ours, chosen)


@pytest.mark.parametrize("quadrature", ["nodal", "gauss"])
def test_hard_contact(tmp_path, quadrature, only_fmi2):
    given = handed_over(penalty="hard", quadrature=quadrature)
    file = fmu_export.write(given, tmp_path / "hard.fmu")[0]
    assert validate_fmu(str(file)) == []
    system, bolt = given.model, given.model.bolts["bolt"].initial_force
    ours = fy.solve_transient(system, fy.Load(FORCES), step=STEP, duration=N_STEP * STEP)
    chosen = outputs(system)
    if quadrature == "gauss":
        # Forces of single points are not unique there; where they sit is decided at 1e-7 relative.
        del chosen["joint.max_pressure"], chosen["joint.open_fraction"]
    result = simulate(file, held([0.0], FORCES, bolt), {}, output=list(chosen))
    assert_equal(result, ours, chosen)


def test_without_compiler_it_has_sources_only(given, tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(library, "COMPILERS", ("no-such-compiler",))
    with caplog.at_level(logging.WARNING, logger="faying"):
        files = fmu_export.write(given, tmp_path / "9 joint.fmu")
    assert "there is no C compiler (no-such-compiler)" in caplog.text
    for file in files:
        assert validate_fmu(str(file)) == []
        names = zipfile.ZipFile(file).namelist()
        assert not any(name.startswith("binaries") for name in names)
        assert "sources/motion.c" in names


def test_equal_joints_give_equal_files(given, files, tmp_path):
    again = fmu_export.write(given, tmp_path / "joint.fmu")
    assert [file.read_bytes() for file in again] == [file.read_bytes() for file in files]


def test_milliseconds_become_seconds(given, tmp_path, only_fmi2):
    """A joint in mm, kg, ms has the same motion in seconds as it has in milliseconds."""
    model = given.model
    scaled = type(model)(
        M=model.M * 1e3,
        C=model.C * 1.0,
        K=model.K * 1e-3,
        contact=type(model.contact)(
            **{
                **vars(model.contact),
                "penalty": 1e-3 * model.contact.penalty,
                "residual_compliance": 1e3 * model.contact.residual_compliance,
            }
        ),
        boundaries=model.boundaries,
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
    other = type(given)(**{**vars(given), "model": scaled, "units": "mm-kg-ms",
                           "preloaded": fy.solve_static(scaled)})  # fmt: skip
    file = fmu_export.write(other, tmp_path / "ms.fmu")[0]
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


def test_hard_contact_at_very_many_points_is_refused(given, monkeypatch, tmp_path):
    contact = given.model.contact
    penalty = np.full(contact.n_points, np.inf)
    hard = replace(given.model, contact=replace(contact, penalty=penalty))
    monkeypatch.setattr(resources, "MOST_HARD_POINTS", contact.n_points - 1)
    with pytest.raises(StudyError, match="hard contact at 112 points is too large for an FMU"):
        fmu_export.write(replace(given, model=hard), tmp_path / "hard.fmu")
