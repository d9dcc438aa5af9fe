"""Load cases that are backbones: keys, refusals, summary, results file and figure."""

import json
from dataclasses import fields, replace
from io import StringIO

import numpy as np
import pytest
from rich.console import Console

import faying as fy
from faying.assessment.backbone import Backbone
from faying.assessment.modal_cycles import Swing
from faying.cli.outcome import show_outcome
from faying.display.facts import with_unit
from faying.display.quantities import number, percent
from faying.exceptions import ModelError, StudyError
from faying.report.errors import error_table
from faying.report.figures.album import Album
from faying.report.figures.backbone import backbone_figure, backbone_slip_figure, masing_remark
from faying.report.methods import verdicts
from faying.report.model_tables import applied_loads
from faying.report.questions import questions
from faying.report.slip import slip_sentence
from faying.study.inputs.load_model import build
from faying.study.judgement.remarks import vibrations
from faying.study.judgement.summary import summarize
from faying.study.keys.schema import parse_study, read_study
from faying.study.results.store import read_results
from faying.workflow.run import run
from small_study import NO_REPORT, reduction, tiny_joint

RING = """
[[load_case]]
name = "ring"
kind = "backbone"
modes = [2, 1]
amplitude_range = [0.001, 0.1, 3]
increments = 3
at = "tip"
masing = true
"""
STUDY = (
    tiny_joint("penalty = 1e6\nfriction = 0.2\n")
    + "[damping]\nbeta = 1e-7\n"
    + reduction("compliance", normal_modes=10)
    + RING
    + NO_REPORT
)


def test_vibrations_are_told_first_and_no_fatigue_is_judged_by_the_joint_at_rest(tmp_path):
    sized = STUDY.replace("preload = 5e3", 'preload = 5e3\nsize = "M6"\ngrade = "8.8"')
    (tmp_path / "study.toml").write_text(sized.replace("[2, 1]", "[1]"), encoding="utf-8")
    summary = run(read_study(tmp_path / "study.toml"), tmp_path / "out")
    curve = read_results(tmp_path / "out/results.h5").cases["ring"].reference.backbones["1"]
    (said,) = [line for line in summary["remarks"] if line.startswith("ring, mode 1 at tip")]
    for value in (curve.frequency[0], curve.amplitude[-1], curve.amplitude[0]):
        assert with_unit(value, "") in said
    assert f"damping ratio {percent(curve.damping_ratio[-1])}" in said
    assert summary["verdict"]["sentence"].startswith("The joint holds as far as it is judged")
    assert summary["verdict"]["sentence"].endswith("of what is allowed, at rest.")
    (question,) = summary["verdict"]["open_questions"]
    assert question.startswith("fatigue of bolt: ")
    checks = [check for part in summary["verdict"]["parts"] for check in part["checks"]]
    assert {check["case"] for check in checks if check["quantity"] == "yield"} == {"at rest"}


def test_the_headline_names_what_is_damped_most_and_where_all_slips(results):
    case = results.cases["ring"]
    curve = case.reference.backbones["1"]
    humped = replace(
        curve,
        damping_ratio=np.array([0.01, 0.08, 0.02]),
        macroslip=np.array([False, True, True]),
        remarks=("both",),
    )
    other = replace(case.reference.backbones["2"], remarks=("both", "this"))
    shown = replace(case, reference=replace(case.reference, backbones={"1": humped, "2": other}))
    shown = replace(results, cases={"ring": shown})
    said, _ = vibrations(shown)
    middle = with_unit(curve.amplitude[1], "mm")
    for value in (curve.frequency[0], curve.frequency[1], curve.frequency[2]):
        assert f"{with_unit(value, 'Hz')} with damping ratio" in said
    assert f"damping ratio 8.0 % at {middle}, " in said
    assert said.endswith(f", all that touches slips from {middle} on")
    caption = backbone_figure(shown, shown.cases["ring"]).caption
    assert "Modes 1, 2: both. Mode 2: this." in caption


class Bars:
    """What a run shows of its stages: name to how far it is to go, and how far it went."""

    def __init__(self):
        self.ends, self.reached = {}, {}

    def add_task(self, description, *, total=None):
        self.ends[description] = total
        return description

    def advance(self, task, advance=1):
        self.reached[task] = self.reached.get(task, 0) + advance

    def remove_task(self, task):
        assert task in self.ends


@pytest.fixture(scope="module")
def bars():
    return Bars()


@pytest.fixture(scope="module")
def finished(tmp_path_factory, bars):
    folder = tmp_path_factory.mktemp("study")
    (folder / "ring.toml").write_text(STUDY)
    out = folder / "out"
    assert run(read_study(folder / "ring.toml"), out, progress=bars)["converged"]
    return out


@pytest.fixture(scope="module")
def results(finished):
    return read_results(finished / "results.h5")


@pytest.fixture(scope="module")
def curve(results, tmp_path_factory):
    """The second mode in Python."""
    model = build(parse_study(STUDY, tmp_path_factory.mktemp("python") / "ring.toml"))
    force = results.bolts["bolt"].initial_force
    joint = model.with_bolt_forces({"bolt": force})
    return fy.backbone(joint, 2, np.geomspace(0.001, 0.1, 3), at="tip", increments=12, masing=True)


@pytest.mark.usefixtures("finished")
def test_a_run_shows_how_many_amplitudes_are_done(bars):
    """Of two modes and three amplitudes each: what is left of minutes can be told."""
    assert bars.ends["ring full"] == bars.reached["ring full"] == 6


def test_the_summary_has_frequency_and_damping(finished, curve):
    case = json.loads((finished / "summary.json").read_text())["load_cases"]["ring"]
    assert list(case["backbones"]) == ["1", "2"]
    found = case["backbones"]["2"]
    assert found["measured_at"] == "tip"
    # The same increments from a preload that was solved in as many steps, to round-off of both.
    for name in ("amplitude", "frequency", "damping_ratio", "energy_per_cycle", "linear_damping"):
        np.testing.assert_allclose(found[name], getattr(curve, name), rtol=1e-6, err_msg=name)
    assert found["damping_ratio"][-1] > found["linear_damping"][-1] > 0
    np.testing.assert_allclose(found["energy"], curve.energy, rtol=1e-6)
    largest = curve.damping_ratio.max()
    for name in ("masing_frequency", "masing_damping", "masing_deviation"):
        np.testing.assert_allclose(
            found[name], getattr(curve, name), rtol=1e-5, atol=1e-6 * largest, err_msg=name
        )
    assert abs(found["masing_deviation"][-1]) > 0.01


def test_results_keep_the_curves_of_every_method(results):
    case = results.cases["ring"]
    full, reduced = case.reference.backbones, case.methods["compliance"][0].response.backbones
    assert isinstance(full["1"], Backbone)
    assert full["1"].mode == 1
    for mode, one in full.items():
        # Ten normal modes; 8e-4 and 3 % are measured.
        np.testing.assert_allclose(reduced[mode].frequency, one.frequency, rtol=2e-3)
        np.testing.assert_allclose(reduced[mode].damping_ratio, one.damping_ratio, rtol=0.1)
        assert one.loop_load.shape == one.loop_modal.shape == (3, 13)
        area = -np.trapezoid(one.loop_modal, one.loop_load, axis=1)
        np.testing.assert_allclose(area, one.loop_area, rtol=1e-9, atol=1e-12)


@pytest.mark.long
def test_a_backbone_that_was_stopped_goes_on_after_its_last_amplitude(
    finished, results, tmp_path, monkeypatch
):
    """In the full model's second mode: the first is there, and one amplitude of the second."""
    computed, whole = [], Swing.cycle

    def counted(swing, load, half):
        if len(computed) == 4 and not (tmp_path / "stopped").exists():
            (tmp_path / "stopped").touch()
            raise KeyboardInterrupt
        computed.append(load)
        return whole(swing, load, half)

    monkeypatch.setattr(Swing, "cycle", counted)
    study, bars = read_study(finished.parent / "ring.toml"), Bars()
    with pytest.raises(KeyboardInterrupt):
        run(study, tmp_path)
    assert run(study, tmp_path, resume=True, progress=bars)["converged"]
    # Six by the full model and six by the reduced one, each once.
    assert len(computed) == 12
    assert bars.reached["ring full"] == 6
    mine = read_results(tmp_path / "results.h5").cases["ring"]
    other = results.cases["ring"]
    for case in (mine, other):
        assert set(case.methods) == {"compliance"}
    for name, curve in other.reference.backbones.items():
        assert_same_curve(mine.reference.backbones[name], curve)
    for name, curve in other.methods["compliance"][0].response.backbones.items():
        assert_same_curve(mine.methods["compliance"][0].response.backbones[name], curve)
    assert mine.reference.seconds > 0


def test_backbones_of_methods_are_judged_by_frequency_and_damping(results, finished):
    """Not by pressures, which are those of the preloaded joint whatever the mode does."""
    case = results.cases["ring"]
    exact, found = case.reference.backbones, case.methods["compliance"][0].response.backbones
    frequency = max(np.abs(found[m].frequency / exact[m].frequency - 1).max() for m in exact)
    damping = max(np.abs(found[m].damping_ratio / exact[m].damping_ratio - 1).max() for m in exact)
    table = error_table(case)
    assert table.columns[1:3] == (
        "frequency off by at most [%]",
        "damping ratio off by at most [%]",
    )
    cells = [cell.text for cell in table.rows[0]]
    assert cells[1:3] == [number(100 * frequency), number(100 * damping)]
    summary = json.loads((finished / "summary.json").read_text())
    entry = summary["load_cases"]["ring"]["methods"]["compliance"]["0"]
    # A difference over the value, or their ratio less one: round-off of one.
    assert entry["frequency_error"] == pytest.approx(frequency, rel=1e-9)
    assert entry["damping_error"] == pytest.approx(damping, rel=1e-9)
    # Amplitudes take what they take: none of that is the time of a static case.
    assert "per_static_case" not in summary["timings"]["full"]
    bend = replace(
        case, name="bend", kind="static", reference=replace(case.reference, backbones={})
    )
    both = replace(results, cases={"ring": case, "bend": bend})
    (verdict,) = verdicts(both)
    assert verdict.case == "bend"
    shown = StringIO()
    show_outcome(summarize(both), finished, Console(file=shown, markup=False, width=1000))
    title = next(line for line in shown.getvalue().splitlines() if "joint modes" in line)
    assert "bend" in title
    assert "ring" not in title
    assert f"frequencies off by at most {percent(frequency)}, damping" in shown.getvalue()


def test_modes_stand_where_other_cases_have_loads(results):
    pull = '[[load_case]]\nname = "pull"\nkind = "static"\n'
    pull += 'forces = [{ boundary = "tip", component = "Fx", value = 2.0 }]\n'
    stated = applied_loads(replace(results, study_text=STUDY + pull))
    assert stated == {"ring": "modes 2, 1", "pull": "tip Fx = 2 N"}


def assert_same_curve(mine, other):
    for one in fields(Backbone):
        np.testing.assert_array_equal(getattr(mine, one.name), getattr(other, one.name), one.name)


def test_damping_is_drawn_over_amplitude(results):
    drawn = backbone_figure(results, results.cases["ring"])
    damping, shift, loops = drawn.figure.axes
    assert damping.get_xscale() == damping.get_yscale() == "log"
    assert shift.get_xlabel() == "amplitude at tip [mm]"
    lines = {line.get_label(): line for line in damping.get_lines()}
    (second,) = (line for name, line in lines.items() if name.startswith("mode 2, "))
    expected = results.cases["ring"].reference.backbones["2"]
    np.testing.assert_array_equal(second.get_xdata(), expected.amplitude)
    np.testing.assert_array_equal(second.get_ydata(), expected.damping_ratio)
    assert len(loops.get_lines()) == 2
    one = results.cases["ring"].reference.backbones["2"]
    masing = one.masing_damping + one.linear_damping
    (crosses,) = (
        line
        for line in damping.get_lines()
        if line.get_marker() == "x" and set(line.get_ydata()) <= set(masing)
    )
    assert crosses.get_ydata()[-1] == masing[-1]
    slips = one.friction_damping > 0
    off = [f"{one:+.2g}" for one in np.sort(100 * one.masing_deviation[slips])[[0, -1]]]
    assert f"damping of mode 2 is off by {off[0]} to {off[1]} %" in drawn.caption
    unasked = replace(one, masing_frequency=None, masing_damping=None)
    assert masing_remark("2", unasked) == ""
    assert all(line.get_label().endswith(" mm") for line in loops.get_lines())


def test_slip_is_mapped_at_amplitudes_that_slip(results):
    case = results.cases["ring"]
    one = case.reference.backbones["2"]
    assert one.slip_distance.shape == (3, len(one.slip_distance[0]))
    slips = one.energy_per_cycle > 0
    assert slips.any()
    assert (one.slip_distance[slips].max(axis=1) > 0).all()
    nothing = one.stick_share == 1
    assert not (one.slip_distance[nothing] > 1e-9).any()
    drawn = backbone_slip_figure(results, case)
    titles = [axes.get_title(loc="left") for axes in drawn.figure.axes]
    second = [title for title in titles if title.startswith("mode 2, joint: amplitude ")]
    assert len(second) == np.count_nonzero(slips)
    assert all(axes.images for axes in drawn.figure.axes if axes.get_title(loc="left") in second)


def test_slip_is_mapped_where_a_study_says_and_drawn_over_energy(results):
    text = results.study_text.replace(
        'at = "tip"', 'at = "tip"\nover = "energy"\nmaps = [1e-9, 1e9]'
    )
    case = results.cases["ring"]
    curves = {mode: replace(one, over="energy") for mode, one in case.reference.backbones.items()}
    over = replace(case, reference=replace(case.reference, backbones=curves))
    drawn = backbone_slip_figure(replace(results, study_text=text), over)
    titles = [axes.get_title(loc="left") for axes in drawn.figure.axes]
    ends = [f"{number(float(one))} N·mm" for one in curves["2"].energy[[0, -1]]]
    found = [title for title in titles if title.startswith("mode 2, ")]
    assert found == [f"mode 2, joint: energy {end}" for end in ends]
    assert "nearest to those of the study" in drawn.caption
    damping, shift, _ = backbone_figure(results, over).figure.axes
    assert shift.get_xlabel() == "energy of the vibration [N·mm]"
    (second,) = (line for line in damping.get_lines() if line.get_label().startswith("mode 2, "))
    np.testing.assert_array_equal(second.get_xdata(), curves["2"].energy)


@pytest.mark.long
def test_the_report_says_that_vibrations_slip(results, tmp_path):
    """Its fields are those of the preloaded joint, in which nothing slips."""
    one = results.cases["ring"].reference.backbones["2"]
    said = slip_sentence(results)
    assert said.startswith("In vibration the joint slips: ")
    smallest = number(float(one.amplitude[one.energy_per_cycle > 0].min()))
    assert f"mode 2 of ring from amplitude {smallest} mm on" in said
    drawn = [
        e.path.name for part in questions(results, Album(results, tmp_path)) for e in part.figures
    ]
    assert "case_ring_backbones.png" in drawn
    assert "case_ring_pressure.png" not in drawn


def test_check_says_how_many_increments_there_are(call, tmp_path):
    (tmp_path / "ring.toml").write_text(STUDY)
    status, out, _ = call("check", tmp_path / "ring.toml")
    assert status == 0
    # Two modes, three amplitudes, a quarter of a cycle and one cycle of twelve.
    assert (
        "modes 2, 1 at 3 amplitudes each, cycles until they repeat: 90 increments at least" in out
    )


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("modes = [2, 1]\n", "", r"needs 'modes', as modes = \[1, 2\]"),
        ("[2, 1]", "[1, 1]", "a mode occurs twice; keep one"),
        ("[2, 1]", "[0]", "modes"),
        ("[0.001, 0.1, 3]", "[0.1, 0.001, 3]", "give the smaller amplitude first"),
        ("amplitude_range = [0.001, 0.1, 3]", "amplitudes = [-1.0]", "amplitudes"),
        ("amplitude_range = [0.001, 0.1, 3]\n", "", "give one of them"),
        ("increments = 3", "amplitudes = [0.1]", "give one of them"),
        ("increments = 3", "maps = [0.2]", "from the smallest to the largest amplitude"),
        ("increments = 3", 'over = "force"', "over"),
        ('kind = "backbone"', 'kind = "cycle"', "'forces' is missing or empty"),
        (
            'at = "tip"',
            'forces = [{ boundary = "tip", component = "Fx", value = 1.0 }]',
            "loaded only by the inertia of its modes; remove it",
        ),
    ],
)
def test_keys_that_do_not_fit_are_refused(tmp_path, old, new, match):
    assert old in STUDY
    with pytest.raises(StudyError, match=match):
        parse_study(STUDY.replace(old, new), tmp_path / "ring.toml")


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("friction = 0.2\n", "", "no interface has friction, so nothing is damped"),
        ('"tip"', '"tpi"', "there is no boundary 'tpi'; did you mean 'tip'"),
        ('"tip"', '"tip.ur"', "'ur' is not one of the components 'ux'"),
        ("[2, 1]", "[100000]", "modes; give smaller numbers"),
        (
            'modes = [2, 1]\namplitude_range = [0.001, 0.1, 3]\nincrements = 3\nat = "tip"',
            'modes = [2]\namplitudes = [0.01]\nat = "tip.ry"',
            "load case 'ring': mode 2: the mode of .* leaves 'tip' still",
        ),
    ],
)
def test_what_the_model_does_not_have_is_refused(tmp_path, old, new, match):
    assert old in STUDY
    (tmp_path / "ring.toml").write_text(STUDY.replace(old, new))
    with pytest.raises((StudyError, ModelError), match=match):
        run(read_study(tmp_path / "ring.toml"), tmp_path / "out")


@pytest.mark.long
def test_a_mode_that_is_still_where_amplitudes_are_measured_is_left_out_by_name(tmp_path):
    text = STUDY.replace('"tip"', '"tip.ry"').replace("[0.001, 0.1, 3]", "[1e-5, 1e-4, 2]")
    (tmp_path / "ring.toml").write_text(text)
    summary = run(read_study(tmp_path / "ring.toml"), tmp_path / "out")
    assert list(summary["load_cases"]["ring"]["backbones"]) == ["1"]
    (said,) = [text for text in summary["warnings"] if "is left out" in text]
    assert said.startswith("load case 'ring': mode 2 is left out: no motion at 'tip.ry'")
