"""Studies that leave the number of normal modes to the run: chosen by estimates, told, repeated."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

import faying as fy
from faying.assessment import choose_normal_modes
from faying.assessment.choose_normal_modes import NormalModeChoice, excited_frequency
from faying.assessment.transient_error import OBSERVED_RATIOS
from faying.cli import app
from faying.exceptions import ModelError, StudyError
from faying.files.flattening import flattened, restored
from faying.linalg.singular import InertiaError
from faying.reduction.basis import ModeKind
from faying.reduction.normal_modes import fixed_interface_normal_modes
from faying.study.keys.schema import parse_study
from faying.study.results.mode_choice import mode_sentences
from faying.study.results.store import read_results
from faying.study.stages import normal_modes
from faying.units import units_of
from faying.workflow.run import run
from lap_joints import tiny_lap
from small_study import NO_REPORT, TINY_JOINT, reduction, step

TIMES = "step = 2e-5\nduration = 4e-4\n"
STUDY = (
    TINY_JOINT
    + "[damping]\nbeta = 1e-6\n"
    + reduction("compliance", "craig-bampton", normal_modes='"auto"')
    + 'transient_tolerance = 0.01\n[validation]\nreference = "none"\n'
    + NO_REPORT
    + step("push", "Fz", -100.0, f"rise_time = 4e-4\n{TIMES}")
)
JUMP = step("jump", "Fz", -100.0, TIMES)


def computed(text, folder):
    """Summary and results of a run."""
    assert run(parse_study(text, folder / "joint.toml"), folder / "out")["converged"]
    summary = json.loads((folder / "out" / "summary.json").read_text())
    return summary, read_results(folder / "out" / "results.h5")


def modes_of(model):
    return model.basis.count(ModeKind.NORMAL)


@pytest.fixture(scope="module")
def shaken():
    model = tiny_lap(damping=fy.Rayleigh(alpha=0.0, beta=1e-6))
    return fy.preload(model, {"bolt": 5e3})


@pytest.fixture(scope="module")
def chosen(tmp_path_factory):
    return computed(STUDY, tmp_path_factory.mktemp("chosen"))


def test_the_fewest_that_are_estimated_to_do_are_taken_by_all_methods(chosen):
    summary, results = chosen
    told = summary["normal_mode_choice"]["load_cases"]["push"]
    assert summary["normal_mode_choice"]["count"] == told["count"] == told["counts"][-1]
    assert told["met"]
    assert len(told["counts"]) > 1
    enough = OBSERVED_RATIOS[0] * 0.01  # the truth was seen to be up to 2.5 times the estimate
    assert told["error"] == told["estimates"][-1] <= enough
    assert told["tolerance"] == 0.01
    assert all(error > enough for error in told["estimates"][:-1])
    for method in ("compliance", "craig-bampton"):
        assert modes_of(results.reduced[method][0]) == told["count"]
    # What the run itself then estimates is what the choice was made by.
    found = summary["load_cases"]["push"]["methods"]["compliance"]["0"]
    assert found["estimated_max_relative_error"] == pytest.approx(told["error"], rel=1e-6)
    assert summary["load_cases"]["push"]["remedy"] is None


def test_python_and_reduce_choose_the_same(chosen, shaken, tmp_path):
    summary, _ = chosen
    (tmp_path / "joint.toml").write_text(STUDY)
    out = tmp_path / "joint.faying"
    result = CliRunner().invoke(app, ["reduce", str(tmp_path / "joint.toml"), "--out", str(out)])
    assert result.exit_code == 0
    told = summary["normal_mode_choice"]["load_cases"]["push"]
    assert told["reason"] in result.output
    assert modes_of(fy.read_reduced_model(out)) == told["count"]
    part = np.linspace(0.0, 1.0, 201)
    rise = fy.History(4e-4 * part, -100.0 * (0.5 - 0.5 * np.cos(np.pi * part)))
    load = fy.Load({"tip.Fz": rise})
    again = fy.choose_normal_modes(shaken, load, step=2e-5, duration=4e-4, tolerance=0.01)
    assert again.counts.tolist() == told["counts"]
    np.testing.assert_allclose(again.estimates, told["estimates"], rtol=1e-6)  # round-off


@pytest.mark.long
def test_a_jump_asks_for_more_and_what_no_number_reaches_is_said(chosen, tmp_path):
    text = STUDY.replace("= 0.01", "= 0.001") + JUMP
    (tmp_path / "joint.toml").write_text(text)
    out = tmp_path / "out"
    result = CliRunner().invoke(app, ["run", str(tmp_path / "joint.toml"), "--out", str(out)])
    assert result.exit_code == 0
    summary = json.loads((out / "summary.json").read_text())
    choice = summary["normal_mode_choice"]
    jump, push = (choice["load_cases"][name] for name in ("jump", "push"))
    assert choice["count"] == max(jump["count"], push["count"])
    assert choice["count"] >= chosen[0]["normal_mode_choice"]["count"]
    assert not jump["met"]
    assert jump["error"] <= 1.25 * min(jump["estimates"])
    # The run takes the method that does not depend on the number of modes.
    assert summary["load_cases"]["jump"]["remedy"]["taken"]["method"] == "compliance+inertia"
    assert "is not within the tolerance of 0.1%" in jump["reason"]
    assert " ".join(jump["reason"].split()) in " ".join(result.output.split())


def test_a_resumed_run_takes_the_number_over(chosen, tmp_path, monkeypatch):
    study = parse_study(STUDY, tmp_path / "joint.toml")

    def stopped(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("faying.workflow.run.reference_of", stopped)
        with pytest.raises(KeyboardInterrupt):
            run(study, tmp_path / "out")
    monkeypatch.setattr(normal_modes, "choose_normal_modes", stopped)
    assert run(study, tmp_path / "out", resume=True)["converged"]
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["normal_mode_choice"] == chosen[0]["normal_mode_choice"]
    results = read_results(tmp_path / "out" / "results.h5")
    np.testing.assert_array_equal(
        results.cases["push"].methods["compliance"][0].response.pressure,
        chosen[1].cases["push"].methods["compliance"][0].response.pressure,
    )


def test_divided_steps_are_those_of_the_first_trial(tmp_path):
    divided = STUDY.replace("step = 2e-5\n", 'step = "auto"\nsteps_per_period = 50\n')
    summary, results = computed(divided.replace("duration", "tolerance = 0.1\nduration"), tmp_path)
    told = summary["normal_mode_choice"]["load_cases"]["push"]
    assert told["tolerance"] == 0.1
    assert told["met"]
    steps = results.cases["push"].reference.substeps
    assert told["resolved"] >= 1.5 / results.cases["push"].times[1]
    assert steps.max() > 1


def test_loads_over_time_excite_what_they_excite():
    """By half a cosine within t an oscillator is moved by 1/((2 f t)² − 1) beside its statics."""
    model = fy.lap_joint(element_size=10.0, hole_radius=0.0)
    times = np.linspace(0.0, 1e-3, 201)
    rise = fy.History(times, 0.5 - 0.5 * np.cos(np.pi * times / times[-1]))
    options = {"step": 1e-5, "duration": 2e-3, "tolerance": 0.03}
    found = excited_frequency(model, fy.Load({"tip.Fz": rise}), **options)
    expected = np.sqrt(1 / 0.03 + 1) / 2 / times[-1]
    # Looked at in steps of 5 %, and at instants only.
    assert found == pytest.approx(expected, rel=0.1)
    jump = excited_frequency(model, fy.Load({"tip.Fz": 5.0}), **options)
    assert jump == pytest.approx(1 / (2 * np.pi * 1e-5))
    assert excited_frequency(model, fy.Load({}), **options) == 0.0


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"auto"', '"many"', "expected a whole number or 'auto'"),
        ('"auto"', "-3", "normal_modes"),
        (
            'kind = "step"\nrise_time = 4e-4',
            'kind = "static"',
            "'auto' needs load cases over time",
        ),
    ],
)
def test_what_fits_nothing(tmp_path, old, new, said):
    text = STUDY.replace("step = 2e-5\nduration = 4e-4\n", "") if "static" in new else STUDY
    with pytest.raises(StudyError, match=said):
        parse_study(text.replace(old, new), tmp_path / "joint.toml")


def test_a_tolerance_is_positive():
    model = fy.lap_joint(element_size=10.0, hole_radius=0.0)
    with pytest.raises(ModelError, match="give a positive share"):
        fy.choose_normal_modes(model, fy.Load({}), step=1e-5, duration=1e-4, tolerance=0.0)


@pytest.mark.long
def test_a_joint_with_friction_is_judged_from_where_it_was_tightened(tmp_path):
    rubs = (
        '[[interface]]\nname = "joint"\npenalty = 1e6\nfriction = 0.2\ntangential_penalty = 8e5\n'
    )
    text = STUDY.replace('reference = "none"', "half_step = false") + rubs
    summary, results = computed(text.replace('"craig-bampton"', ""), tmp_path)
    told = summary["normal_mode_choice"]["load_cases"]["push"]
    assert told["met"]
    assert modes_of(results.reduced["compliance"][0]) == told["count"]
    found = summary["load_cases"]["push"]["methods"]["compliance"]["0"]
    # Of pressures that agree to 1e-8, as the full model's stiffness and a reduced compliance do.
    assert found["estimated_max_relative_error"] == pytest.approx(told["error"], abs=1e-8)
    # As wide as it was seen on joints without friction.
    ratio = told["error"] / found["max_relative_error"]
    assert OBSERVED_RATIOS[0] < ratio < OBSERVED_RATIOS[1]


def tried(joint):
    """Return the choice after a jump, and the numbers of modes that were computed for it."""
    counts = []

    def modes(count):
        counts.append(count)
        return fixed_interface_normal_modes(joint.structure, count)

    options = {"step": 2e-5, "duration": 4e-4, "modes": modes}
    return fy.choose_normal_modes(joint, fy.Load({"tip.Fz": -100.0}), **options), counts


def test_modes_below_what_is_excited_are_counted_and_not_computed(shaken):
    found, counts = tried(shaken)
    below = fy.count_modes_below(shaken, found.excited)
    assert counts == found.counts.tolist()
    # The first that is tried has them all, half as many would not.
    assert found.counts[0] >= below > found.counts[0] / 2 > 2


def test_where_modes_cannot_be_counted_the_fewest_are_tried_first(shaken, monkeypatch):
    def uncounted(*_):
        message = "some pivots have no sign"
        raise InertiaError(message)

    monkeypatch.setattr(choose_normal_modes, "count_modes_below", uncounted)
    found, counts = tried(shaken)
    assert counts == found.counts.tolist()
    assert counts[0] == choose_normal_modes.FEWEST_MODES


@pytest.mark.parametrize(
    ("tractions", "met", "said"),
    [
        ([], True, "within the tolerance of 3%."),
        ([0.5, 0.02], True, "off by 2.00% of the largest one."),
        ([0.5, 0.0888], True, "is more accurate."),
        ([0.5, 0.45], False, "off by 45.00% of the largest one."),
        ([0.5, np.inf], False, "off by an unknown share of the largest one."),
    ],
)
def test_tractions_are_told_where_the_choice_is(tractions, met, said):
    choice = NormalModeChoice(
        count=20,
        met=met,
        tolerance=0.03,
        excited=1e3,
        resolved=1e4,
        counts=np.array([10, 20]),
        highest=np.array([1e3, 2e3]),
        estimates=np.array([0.1, 0.02 if met else 0.2]),
        tractions=np.array(tractions),
    )
    (sentence,) = mode_sentences({"push": choice}, units_of("mm-t-s"))
    assert sentence.endswith(said)
    assert ("pressures determine" in sentence) == (said == "is more accurate.")


def test_tractions_of_every_number_are_estimated(joint):
    rubbing = joint.with_friction(0.2, tangential_penalty=8e5)
    load = fy.Load({"tip.Fz": -500.0, "tip.Fx": 3000.0})
    found = fy.choose_normal_modes(rubbing, load, step=1.6e-5, duration=8e-5, tolerance=0.5)
    assert found.tractions.shape == found.counts.shape
    assert 0 < found.traction_error < 1
    again = restored(NormalModeChoice, flattened(found))
    assert again.traction_error == found.traction_error
