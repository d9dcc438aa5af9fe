"""``faying recover``: what a run keeps is enough to recover pressures of imported histories."""

from pathlib import Path

import h5py
import numpy as np
import pytest

import faying as fy
from faying.assessment.imported_recovery import (
    backward_differences,
    recover_from_boundary_loads,
    recover_from_modal,
)
from faying.assessment.recovery import (
    balanced_accelerations,
    recover_pressure,
)
from faying.display.quantities import number
from faying.exceptions import FormatError, ModelError, StudyError
from faying.reduction.recovery import recovery_operator
from faying.study.keys.schema import read_study
from faying.study.stages.offline import prepare_joint
from faying.study.stages.recover import RecoverOptions, recover, reduced_model, results_of
from faying.workflow.run import run
from small_study import NO_REPORT, TINY_JOINT, reduction, static

STUDY = (
    'title = "recover"\n'
    + TINY_JOINT.replace("5e3", "10e3")
    + "[sticking]\nstiffness = 1e6\n[damping]\nalpha = 160.0\nbeta = 5e-7\n"
    + reduction("craig-bampton", "jim-a", "jim-a+compliance", normal_modes=6, joint_modes=[2, 4])
    + static("pull", "Fz", -100.0)
    + NO_REPORT
)
LOAD = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="step")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A finished run."""
    folder = tmp_path_factory.mktemp("recover")
    (folder / "STUDY.toml").write_text(STUDY)
    assert run(read_study(folder / "STUDY.toml"), folder / "out")["converged"]
    return folder / "out"


@pytest.fixture(scope="module")
def results(folder):
    return results_of(folder)


@pytest.fixture(scope="module")
def model(folder):
    """The same joint in memory."""
    return prepare_joint(read_study(folder.parent / "STUDY.toml")).model


@pytest.fixture(scope="module")
def classic(model):
    return fy.craig_bampton(model, normal_modes=6)


@pytest.fixture(scope="module")
def solution(model, classic):
    rom = fy.reduce(model, classic)
    return fy.solve_transient(rom, LOAD, step=2e-5, duration=30 * 2e-5)


@pytest.fixture(scope="module")
def expected(model, solution):
    return recover_pressure(model, solution)


def close(pressure, reference):
    """Equal but for round-off: the same matrices, with sums in another order."""
    np.testing.assert_allclose(pressure, reference, rtol=0, atol=1e-8 * reference.max())


def write_csv(path, columns):
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(map(repr, map(float, row))) for row in rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


def modal_columns(solution, *, derivatives=True):
    """Columns of a modal history of a solution; loads act from the second instant on."""
    columns = {"time": solution.times}
    fields = {"q": solution.states}
    if derivatives:
        accelerations = balanced_accelerations(solution.system, solution)
        fields |= {"v": solution.velocities, "a": accelerations}
    for letter, values in fields.items():
        columns |= {f"{letter}{n}": column for n, column in enumerate(values.T, start=1)}
    acting = np.where(solution.times > 0, 1.0, 0.0)
    return columns | {"tip.Fz": -500.0 * acting, "tip.Mx": 20e3 * acting}


def test_what_is_derived_is_said_once(call, folder, solution, tmp_path):
    path = write_csv(tmp_path / "bare.csv", modal_columns(solution, derivatives=False))
    status, out, _ = call("recover", folder, path)
    assert status == 0
    assert "craig-bampton; velocities and accelerations by a cubic spline" in out


def test_a_modal_csv_gives_the_pressures_of_memory(
    call, folder, results, solution, expected, tmp_path
):
    path = write_csv(tmp_path / "motion.csv", modal_columns(solution))
    status, out, err = call("recover", folder, path)
    assert (status, err) == (0, "")
    assert "craig-bampton; velocities and accelerations: both from the history" in out
    assert "Boundary forces: tip.Fz, tip.Mx from the history; all others are zero" in out
    with h5py.File(folder / "recovered_motion.h5") as file:
        assert file.attrs["format"] == "faying recovered pressures"
        assert file["pressure"].attrs["unit"] == "MPa"
        close(file["pressure"][()], expected.pressure)
        np.testing.assert_array_equal(file["times"][()], solution.times)
        np.testing.assert_allclose(file["max_pressure"][()], expected.max_pressure, rtol=1e-8)
        for name, values in (
            ("gap", expected.gap),
            ("contact_force/joint", expected.contact_force("joint")),
            ("bolt_force/bolt", expected.bolt_force("bolt")),
            ("displacements/tip", expected.displacement("tip")),
        ):
            # Round-off as above, of displacements that are sums of larger ones.
            np.testing.assert_allclose(
                file[name][()], values, rtol=0, atol=1e-8 * np.abs(values).max()
            )
    for heading in ("pressure [MPa]", "at [mm]", "time [s]", "contact force then [N]"):
        assert heading in out
    largest = expected.pressure.max()
    instant, _ = np.unravel_index(expected.pressure.argmax(), expected.pressure.shape)
    row = next(line for line in out.splitlines() if line.strip().startswith("joint"))
    assert f"{largest:.5g}" in row
    assert number(float(solution.times[instant]), 5) in row
    picture = (folder / "recovered_motion_joint.vtu").read_text()
    assert "pressure [MPa]" in picture
    assert "TimeValue" in picture


@pytest.mark.parametrize("inputs", ["array", "boundary", "group"])
def test_hdf5_gives_the_same(results, solution, expected, tmp_path, inputs):
    path = tmp_path / "motion.h5"
    with h5py.File(path, "w") as file:
        file["times"], file["coordinates"] = solution.times, solution.states
        file["velocities"] = solution.velocities
        file["accelerations"] = balanced_accelerations(solution.system, solution)
        if inputs == "array":
            file["inputs"] = solution.inputs
        elif inputs == "boundary":
            file["inputs"] = solution.inputs[:, :6]
        else:
            file["inputs/tip.Fz"] = solution.inputs[:, 2]
            file["inputs/tip.Mx"] = solution.inputs[:, 3]
    recovered = recover(results, path, RecoverOptions())
    assert recovered.loads == ("tip.Fz", "tip.Mx")
    close(recovered.pressure, expected.pressure)


@pytest.mark.parametrize("way", ["spline", "backward"])
def test_missing_derivatives(results, model, classic, solution, tmp_path, way):
    path = write_csv(tmp_path / "motion.csv", modal_columns(solution, derivatives=False))
    recovered = recover(results, path, RecoverOptions(derivatives=way))
    derived = (None, None)
    if way == "backward":
        derived = backward_differences(solution.times, solution.states)
    acting = fy.History(solution.times, np.where(solution.times > 0, -500.0, 0.0))
    twist = fy.History(solution.times, np.where(solution.times > 0, 20e3, 0.0))
    expected = recover_from_modal(
        recovery_operator(model, classic),
        solution.times,
        solution.states,
        fy.Load({"tip.Fz": acting, "tip.Mx": twist}),
        velocities=derived[0],
        accelerations=derived[1],
    )
    assert "velocities and accelerations by" in recovered.derivatives
    close(recovered.pressure, expected.pressure)


def test_coordinates_of_joint_modes(results, model, classic, tmp_path):
    basis = fy.jim_a(model, joint_modes=4, classic=classic, subarea_count=200)
    rom = fy.reduce(model, basis.with_joint_modes(2))
    solution = fy.solve_transient(rom, LOAD, step=2e-5, duration=10 * 2e-5)
    path = write_csv(tmp_path / "motion.csv", modal_columns(solution))
    recovered = recover(results, path, RecoverOptions(method="jim-a", joint_modes=2))
    close(recovered.pressure, recover_pressure(model, solution).pressure)


@pytest.mark.parametrize("method", ["compliance", "craig-bampton"])
def test_boundary_forces_are_simulated_as_in_memory(results, model, classic, tmp_path, method):
    times = np.linspace(0.0, 4e-4, 21)
    force = -300.0 * np.sin(2000.0 * times)
    path = write_csv(tmp_path / "force.csv", {"time": times, "tip.Fz": force})
    options = RecoverOptions(
        method=None if method == "compliance" else method, integrator=fy.GeneralizedAlpha(0.8)
    )
    recovered = recover(results, path, options)
    expected = recover_from_boundary_loads(
        fy.reduce(model, classic, compliance=method == "compliance"),
        times,
        {"tip.Fz": force},
        integrator=fy.GeneralizedAlpha(0.8),
    )
    assert (recovered.route, recovered.method) == ("boundary loads", method)
    close(recovered.pressure, expected.pressure)
    fine = recover(results, path, RecoverOptions(step=1e-5))
    assert len(fine.times) == 41


def test_reduced_models_come_back_whole(results, model, classic):
    """Static solutions, ports and expansion of a model that left its trial vectors behind."""
    there = results.reduced["compliance"][0]
    here = fy.reduce(model, classic, compliance=True)
    one, other = fy.solve_static(there, LOAD), fy.solve_static(here, LOAD)
    close(one.pressure, other.pressure)
    np.testing.assert_allclose(one.displacement("tip"), other.displacement("tip"), rtol=1e-9)
    np.testing.assert_allclose(one.bolt_force("bolt"), other.bolt_force("bolt"), rtol=1e-9)
    with pytest.raises(ModelError, match="without its trial vectors"):
        one.full_displacement()
    assert set(results.reduced) == {"craig-bampton", "compliance", "jim-a", "jim-a+compliance"}


def refused(results, path, match, error=(FormatError, StudyError), **options):
    with pytest.raises(error, match=match):
        recover(results, path, RecoverOptions(**options))


CSV = "time,q1,tip.Fz\n0,0,0\n1,0,0\n2,0,0\n3,0,0\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (CSV.replace(",", ";"), "separated by semicolons; separate them by commas"),
        (CSV.replace("tip.Fz", "tip.Fs"), r"unknown column 'tip.Fs'; did you mean 'tip.Fz'\?"),
        (CSV.replace("time", "tme"), r"unknown column 'tme'; did you mean 'time'\?"),
        (CSV.replace("time", "q2"), "has no column 'time'"),
        (CSV.replace("tip.Fz", "q1"), "column 'q1' occurs twice"),
        (CSV.replace("q1", "q2"), "column 'q1' is missing"),
        (CSV.replace("tip.Fz", "a2"), "column 'q2' is missing"),
        (
            CSV.replace("tip.Fz", "v1").replace("q1", "q1,q2").replace(",0,", ",0,0,"),
            "column 'v2' is missing",
        ),
        (CSV.replace("q1", "v1"), "no coordinates; add q1 to q1"),
        (CSV.replace("2,0,0", "2,nan,0"), "line 4: found 'nan' in column 'q1'"),
        (CSV.replace("2,0,0", "2,zero,0"), "line 4: found 'zero' in column 'q1'"),
        (CSV.replace("2,0,0", "2,0"), "line 4: found 2 cells, expected 3"),
        (CSV.replace("2,0,0", "1,0,0"), r"line 4: time 1 does not come after 1"),
        ("# by a solver\n" + CSV.replace("3,", "-3,"), r"line 6: time -3 does not come after 2"),
        ("time,q1\n", "found 0 instants"),
        ("time\n0\n1\n", "holds only times"),
        ("", "is empty"),
        (CSV, "has 1 coordinates, but the basis of 'craig-bampton' has 13 .6 constraint, 6 normal"),
        ("time,tip.Fz\n0,1\n", "at least two instants"),
        ("time,tip.Fz\n1,1\n2,1\n", "the first at time 0"),
    ],
)
def test_mistakes_in_a_csv_file_are_named(results, tmp_path, text, message):
    path = tmp_path / "motion.csv"
    path.write_text(text)
    refused(results, path, message)


def test_too_few_instants_to_derive(results, solution, tmp_path):
    columns = modal_columns(solution, derivatives=False)
    path = write_csv(tmp_path / "motion.csv", {k: v[:3] for k, v in columns.items()})
    refused(results, path, "3 instants, too few to derive velocities and accelerations; give 4")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"coordinates": np.zeros((4, 13))}, "no dataset 'times'"),
        ({"times": np.arange(4.0), "accelerations": np.zeros((4, 13))}, "no 'coordinates'"),
        ({"times": np.arange(4.0), "coordinate": np.zeros(4)}, r"did you mean 'coordinates'\?"),
        ({"times": np.zeros(4)}, "row 1 of 'times': time 0 does not come after 0"),
        ({"times": np.zeros((4, 1))}, r"'times' has shape \(4, 1\)"),
        (
            {"times": np.arange(4.0), "coordinates": np.full((4, 13), np.nan)},
            r"'coordinates' holds nan at \[0, 0\]",
        ),
        ({"times": np.arange(4.0), "coordinates": np.zeros((3, 13))}, r"expected \(4, 13\)"),
        ({"times": np.arange(4.0), "inputs": np.zeros((4, 3))}, r"shape \(4, 3\), expected 4 rows"),
        ({"times": np.arange(4.0), "inputs": np.zeros((4, 7))}, "the initial forces of this run"),
        ({"times": np.arange(4.0), "inputs/tip.fz": np.zeros(4)}, r"did you mean 'tip.Fz'\?"),
        ({"times": np.arange(4.0), "inputs/tip.Fz": np.zeros(3)}, r"shape \(3,\)"),
        ({"times": np.arange(4.0), "inputs": "no numbers"}, "not a dataset of numbers"),
    ],
)
def test_mistakes_in_an_hdf5_file_are_named(results, tmp_path, content, message):
    path = tmp_path / "motion.h5"
    with h5py.File(path, "w") as file:
        for name, values in content.items():
            file[name] = values
    refused(results, path, message)


def test_files_that_are_no_history(results, tmp_path):
    refused(results, tmp_path / "nowhere.csv", "does not exist")
    for name, message in (
        ("motion.txt", "a history cannot be read from '.txt'"),
        ("m.h5", "not an"),
    ):
        (tmp_path / name).write_text("hello")
        refused(results, tmp_path / name, message)


def test_methods_that_were_not_run(results, solution, tmp_path):
    modal = write_csv(tmp_path / "motion.csv", modal_columns(solution))
    refused(results, modal, r"'jim-b'; did you mean 'jim-a'\?", method="jim-b")
    refused(results, modal, "run with 2, 4 joint modes; give --joint-modes", method="jim-a")
    refused(results, modal, "not 3: change --joint", method="jim-a", joint_modes=3)
    refused(results, modal, "so there is no --step; remove it", step=1e-5)
    loads = write_csv(tmp_path / "loads.csv", {"time": [0.0, 1e-4], "tip.Fz": [0.0, 1.0]})
    refused(results, loads, "remove --derivatives", derivatives="spline")


def test_errors_are_one_message_and_status_2(call, folder, tmp_path):
    status, out, err = call("recover", tmp_path, tmp_path / "motion.csv")
    assert (status, out) == (2, "")
    assert "holds no results.h5" in err
    status, out, err = call("recover", folder, tmp_path / "motion.csv")
    assert (status, out) == (2, "")
    assert err.startswith("faying: history ")
    status, out, _ = call("recover", "--help")
    assert status == 0
    assert "HISTORY" in out


def test_results_without_ports_say_so(folder, tmp_path):
    (tmp_path / "results.h5").write_bytes(Path(folder / "results.h5").read_bytes())
    with h5py.File(tmp_path / "results.h5", "r+") as file:
        del file["ports"], file["reduced"]
    with pytest.raises(
        StudyError, match=r"hold no port compliance, as its \d+ node pairs .*faying reduce"
    ):
        reduced_model(results_of(tmp_path), "compliance")


CURVED = """
[model]
source = "lap-joint"
lap_joint = { element_size = 10.0, hole_radius = 0.0, washer_radius = 11.0, plates = 3, \
curvature = 1e-3 }
[[bolt]]
name = "bolt"
preload = 10e3
[[interface]]
name = "joint-1"
initial_gap = 1e-3
[[interface]]
name = "joint-2"
penalty = "hard"
quadrature = "nodal"
[reduction]
normal_modes = 4
methods = ["compliance"]
[[load_case]]
name = "pull"
kind = "static"
forces = [{ boundary = "tip", component = "Fz", value = -10.0 }]
[output]
report = false
"""


def test_two_curved_interfaces_come_back(tmp_path):
    (tmp_path / "STUDY.toml").write_text(CURVED)
    study = read_study(tmp_path / "STUDY.toml")
    assert run(study, tmp_path / "out")["converged"]
    results = results_of(tmp_path / "out")
    model = prepare_joint(study).model
    n_pair = sum(len(joint.pairs) for joint in model.interfaces.values())
    assert n_pair < model.port_compliance.n_relative < 3 * n_pair
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=4), compliance=True)
    times, force = 1e-4 * np.arange(11), -10.0 * np.arange(11) / 10
    path = write_csv(tmp_path / "force.csv", {"time": times, "tip.Fz": force})
    recovered = recover(results, path, RecoverOptions())
    expected = recover_from_boundary_loads(rom, times, {"tip.Fz": force})
    assert set(recovered.contact_force) == {"joint-1", "joint-2"}
    assert (expected.pressure[-1] > 0).any()
    # Hard contact has no penalty that bounds the round-off of the compliance; measured 1.4e-9.
    np.testing.assert_allclose(
        recovered.pressure, expected.pressure, rtol=0, atol=1e-7 * expected.pressure.max()
    )
