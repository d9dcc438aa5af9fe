"""The report answers in the order an engineer asks, with units, and works without a network."""

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest

import faying as fy
from fake_results import YIELD, fake_results
from faying.display.quantities import number
from faying.display.table import Column, described
from faying.exceptions import FormatError
from faying.report import style
from faying.report.errors import error_table, timing_table
from faying.report.figures.album import Album
from faying.report.html import render, render_methods, write_report
from faying.report.methods import headline, meanings, reservations, verdicts
from faying.report.model_tables import applied_loads
from faying.report.questions import clamp_table, clamped_areas, questions
from faying.report.trust import trust
from faying.study.results.validation_record import ValidationRecord
from faying.units import units_of
from table_cells import cells

WHOLE = fake_results()
# Two cases show all there is to show and draw in less time.
RESULTS = replace(WHOLE, cases={name: WHOLE.cases[name] for name in ("LC1", "LC2-step")})
WHERE = Path("run")
MM = units_of("mm-t-s")
VOID = {"meta", "img", "br", "hr", "link", "input"}


class Page(HTMLParser):
    """Checks nesting while it collects."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.links, self.images, self.text = [], [], [], [], []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        if tag not in VOID:
            self.open.append(tag)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        if tag == "a":
            self.links.append(attributes["href"])
        if tag == "img":
            self.images.append(attributes["src"])
        assert tag not in {"link", "iframe"}
        assert "src" not in attributes or tag == "img"

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if not {"style", "script"} & set(self.open):
            self.text.append(data)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "DPI", 50)  # quick; what is drawn is checked elsewhere
        path = write_report(RESULTS, folder)
    return path, Page(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def methods(written):
    return Page((written[0].parent / "methods.html").read_text(encoding="utf-8"))


def section(results, title):
    return next(one for one in questions(results, Album(results)) if one.title == title)


def test_clamp_forces_are_told_around_each_of_several_bolts():
    model = fy.lap_joint(element_size=5.0, bolt_positions=((-10.0, 0.0), (10.0, 0.0)))
    joint = fy.preload(model, dict.fromkeys(model.bolts, 8e3))
    found = fy.assess(joint, [fy.Load({"tip.Fz": -300.0}, name="bend")], paths=False)

    def rows(assessment):
        return cells(clamp_table(dict(clamped_areas(RESULTS, assessment)), MM))

    around = found.bolts["bolt-2"].clamp_around["joint"]
    said = rows(found)
    assert list(said) == ["joint", "joint around bolt-1", "joint around bolt-2"]
    assert said["joint around bolt-2"]["smallest [N]"] == number(around.least, 5)
    assert said["joint around bolt-2"]["smallest, load case"] == "bend"
    alone = replace(found, bolts={"bolt-2": found.bolts["bolt-2"]})
    assert list(rows(alone)) == ["joint"]
    bare = replace(found.interfaces["joint"], certified=None)
    silent = rows(replace(alone, interfaces={"joint": bare}))
    assert "certified to ± [N]" in said["joint"]
    assert "certified to ± [N]" not in silent["joint"]  # a column of nothing


def test_numbers_stand_in_columns_with_their_unit_above():
    """What a csv file takes is the number itself, whatever is shown of it."""
    columns = (
        Column("force", lambda row: row, "force", 3),
        Column("in", lambda _: "LC1"),
        Column("nothing", lambda _: None),
        Column("share", lambda row: 1e-10 * row, "%", 3),
    )
    table = described("bolt", [("b", 9962.25), ("c", -2.0)], columns, MM)
    assert table.columns == ("bolt", "force [N]", "in", "share [%]")
    assert table.names == ("bolt", "force [N]", "force, load case", "share [%]")
    assert [cell.text for cell in table.rows[0]] == ["b", "9960", "LC1", "9.96e-7"]
    assert table.rows[0][1].value == 9962.25
    assert table.rows[1][1].text == "−2"
    assert table.rows[1][3].text == "< 1e-7"  # round-off
    assert described("bolt", [("b", 0.0)], columns[2:3], MM).rows == ()  # names alone


def test_page_stands_alone(written):
    path, page = written
    assert path.name == "report.html"
    # Scripts name a namespace; that they fetch nothing is seen in a browser.
    assert "http" not in re.sub(r"(?s)<script.*?</script>", "", path.read_text(encoding="utf-8"))
    assert len(page.images) == 6
    for image in page.images:
        assert image.startswith("figures/")
        assert (path.parent / unquote(image)).is_file()


def test_pages_lead_to_each_other(written, methods):
    _, page = written
    assert "methods.html" in page.links
    assert "report.html" in methods.links
    for one in (page, methods):
        anchors = [link[1:] for link in one.links if link.startswith("#")]
        assert set(anchors) <= set(one.ids)
        assert len(set(one.ids)) == len(one.ids)
    assert set(methods.images) & set(page.images) == set()  # nothing is shown twice


def test_normal_modes_that_were_chosen_are_said_with_the_reason(methods):
    text = " ".join("".join(methods.text).split())
    assert 'LC2-step: normal_modes = "auto" is 20; the loads excite modes up to 7.96e+03 Hz' in text
    assert "off by an unknown share with 10, 3.10% with 20; 2.5 times that, the largest" in text
    assert "is not within the tolerance of 2%: more modes gain too little" in text


def test_user_text_is_escaped(written):
    _, page = written
    text = "".join(page.text)
    assert "Two bars <fake> & co" in text
    assert "# α & <β>" in text


def test_sections_come_in_the_order_of_the_questions(written):
    _, page = written
    order = ["joint", "view", "bolts", "opening", "slip", "pressure", "load-cases", "trust"]
    assert [name for name in page.ids if name in order] == [n for n in order if n != "slip"]


def test_pages_say_what_they_must(written, methods):
    text = " ".join("".join(written[1].text).split())
    for needed in (
        "The joint holds. The most used is bolt, by yield: 70 % of what is allowed, in LC2-step",
        "Not judged",
        "quadrature",
        "9962.2",
        "unseen loads, nmf: it met what <nobody> foresaw",
        "jim-a with 40 joint modes: no solution",
        "tip Fz = −500 N, tip Mx = 20000 N·mm",
    ):
        assert (needed in text) == (needed != "Not judged"), needed
    text = " ".join("".join(methods.text).split())
    for needed in (
        "max relative pressure error",
        "energy error at most 10 %",
        "Max relative pressure errors at 100 random static loads",
        "pressures recovered from its motion in transients are off by 2.0 %",
    ):
        assert needed in text, needed


def test_verdict_is_a_row_for_each_bolt_and_interface(written):
    page = written[0].read_text(encoding="utf-8")
    table = page[page.index('id="joint"') : page.index('id="view"')]
    assert table.count('<th scope="row"') == 2
    assert "yield 70 %" in table
    assert "clamp loss 20 %" in table
    assert "opening 40 %" in table  # it opens at 2.5 times the load
    lost = replace(YIELD, quantity="opening", outcome="not met", utilisation=np.inf, value=0.0)
    opened = replace(RESULTS, assessment=replace(RESULTS.assessment, checks=(lost,)))
    assert "opening lost" in render(Album(opened), WHERE)
    failed = replace(YIELD, outcome="not met", utilisation=2.5, value=1600.0)
    yielding = replace(RESULTS, assessment=replace(RESULTS.assessment, checks=(failed,)))
    page = render(Album(yielding), WHERE)
    said = "The joint does not hold: bolt, yield 1600 of 640 MPa, in LC2-step at 3.00e-4 s."
    assert f'<p class="verdict failed">{said}</p>' in page
    assert '"failed": true' in page  # red in the view
    assert "The joint was not judged" not in render(Album(replace(RESULTS, assessment=None)), WHERE)


def test_what_limits_accuracy_is_said_of_this_joint_alone(written, methods):
    text = " ".join("".join(written[1].text + methods.text).split())
    for foreign in ("73 to 112", "153 MPa", "219 MPa", "cantilever", "time-step checks above"):
        assert foreign not in text, foreign
    assert "joint: 28 contact points by the rule nodal on 18 facets, 6.24 mm wide" in text
    # Nodal points are their own averages.
    assert (
        "joint: estimated from this mesh alone, pressures are off by 4.0 % of the peak in the "
        "root mean square"
    ) in text
    assert "single points by up to 30 %." in text
    assert "With nodal quadrature true errors were up to three times the estimate." in text
    assert "This is an estimate, not a bound" in text
    assert "nor about the discretization error of the full model." in text
    assert "LC2-step: a step of 1.00e-4 s; with half of it pressures change by up to" in text
    assert "LC1: a step" not in text
    assert "joint: pressure is 100000 N/mm³ times penetration, which reaches" in text


def test_a_static_run_under_hard_contact_says_nothing_of_steps_and_penalties():
    joint = replace(RESULTS.interfaces["joint"], penalty=float("inf"))
    quiet = replace(
        RESULTS,
        cases={"LC1": RESULTS.cases["LC1"]},
        interfaces={"joint": joint},
        validation=ValidationRecord(),
    )
    found = trust(quiet)
    assert list(found) == ["Mesh and quadrature", "Contact law"]
    assert found["Contact law"] == "joint: hard contact without penetration."


def test_hard_contact_with_more_points_than_pairs_is_said_to_be_undetermined():
    joint = RESULTS.interfaces["joint"]
    hard = replace(joint, penalty=float("inf"))
    crowded = replace(hard, weights=np.ones(len(joint.pairs) + 1))

    def about(record):
        said = reservations(replace(RESULTS, interfaces={"joint": record}))
        return [text for text in said if "determines nodal forces" in text]

    assert about(joint) == about(hard) == []
    (text,) = about(crowded)
    assert text.startswith(f"joint: hard contact at 29 points of {len(joint.pairs)} node pairs")


def test_errors_that_no_method_has_take_no_column():
    case = RESULTS.cases["LC1"]
    columns = error_table(case).columns
    assert "certified: max error [%]" in columns
    assert "residual of friction [%]" not in columns
    silent = {
        name: {count: replace(one, certified_bound=None) for count, one in sizes.items()}
        for name, sizes in case.methods.items()
    }
    assert "certified: max error [%]" not in error_table(replace(case, methods=silent)).columns


def test_certified_energy_and_clamp_force_come_before_the_pressure_and_its_loose_bound():
    columns = error_table(RESULTS.cases["LC1"]).columns
    bounds = [name for name in columns if name.startswith("certified")]
    assert bounds == [
        "certified: energy error [%]",
        "certified: clamp force error [%]",
        "certified: max error [%]",
    ]  # fmt: skip


def test_no_column_is_lost_on_a_phone(written):
    """Wide tables become cards there, in which every cell says its column."""
    page = written[0].read_text(encoding="utf-8")
    for table in page.split("<table")[1:]:
        rows = table.split("</table>")[0].split("<tr>")[1:]
        heads = rows[0].count("<th")
        if "cards" in table[:30]:
            assert heads > 3
            assert all(row.count("data-label=") == heads - 1 for row in rows[1:])
        else:
            assert heads <= 3
    assert "content: attr(data-label)" in page


def test_only_what_changes_a_decision_is_red():
    def held_by_springs(case, share):
        shares = {"upper-lower": np.array([share])}
        return replace(case, reference=replace(case.reference, weak_shares=shares))

    def declared(area):
        return {"joint": replace(RESULTS.interfaces["joint"], declared_area=area)}

    doubtful = replace(
        RESULTS,
        cases={name: held_by_springs(case, 0.02) for name, case in RESULTS.cases.items()},
        warnings=("LC1: not converged",),
        omissions=("strength of bolts: nothing resists", "unseen loads: no"),
        interfaces=declared(1e4),
    )
    page = render(Album(doubtful), WHERE)
    # A sentence, not one for each load case.
    assert page.count("the weak springs upper-lower carry 0.02 of the contact force") == 1
    red = page[page.index('class="verdict doubt"') : page.index('id="joint"')]
    said = ("converge: LC1: not converged", "7% of the declared", "computed: strength of bolts: no")
    for text in ("weak springs upper-lower", *said):
        assert text in red, text
    assert "unseen loads" not in red
    heads = replace(
        RESULTS,
        cases={name: held_by_springs(case, 1e-6) for name, case in RESULTS.cases.items()},
        interfaces=declared(800.0),  # as heads over clearance holes
    )
    page = render(Album(heads), WHERE)
    assert 'class="verdict doubt"' not in page
    assert page.index("88% of the declared contact area") > page.index("change no verdict")


def with_errors(**errors):
    """Give every case the same errors by method and joint modes."""

    def result(template, error):
        return replace(template, accuracy=replace(template.accuracy, max_relative_error=error))

    cases = {}
    for name, case in RESULTS.cases.items():
        template = case.methods["jim-b"][5]
        cases[name] = replace(
            case,
            methods={
                method.replace("_", "-"): {n: result(template, e) for n, e in sizes.items()}
                for method, sizes in errors.items()
            },
        )
    return replace(RESULTS, cases=cases)


def test_verdict_takes_the_smallest_reliable_count():
    results = with_errors(
        jim_b={5: 0.04, 10: 0.2, 20: 0.03, 40: 0.01}, jim_a={5: 0.5, 20: 0.08}, compliance={0: 0.6}
    )
    found = {v.method: v for v in verdicts(results)}
    # 5 modes were good by luck: with 10 the error is 20 %.
    assert (found["jim-b"].joint_modes, found["jim-b"].grade) == (20, "good")
    assert "from 20 joint modes on" in found["jim-b"].sentence
    assert (found["jim-a"].joint_modes, found["jim-a"].grade) == (20, "fair")
    assert found["compliance"].grade == "poor"
    assert "not to be trusted" in found["compliance"].sentence
    assert "jim-b, 20 joint modes" in headline(verdicts(results), results)


def test_worst_case_decides():
    results = with_errors(compliance={0: 0.001})
    case = results.cases["LC1"]
    bad = replace(
        case.methods["compliance"][0],
        accuracy=replace(case.methods["compliance"][0].accuracy, max_relative_error=0.3),
    )
    results = replace(
        results,
        cases={**results.cases, "LC1": replace(case, methods={"compliance": {0: bad}})},
    )
    (verdict,) = verdicts(results)
    assert (verdict.grade, verdict.case) == ("poor", "LC1")
    assert "No method meets the mark" in headline([verdict], results)


def test_case_without_solution_cannot_be_trusted():
    results = with_errors(compliance={0: 0.001})
    results = replace(
        results,
        cases={**results.cases, "LC1": replace(results.cases["LC1"], methods={})},
    )
    (verdict,) = verdicts(results)
    assert verdict.grade == "poor"
    assert "no solution in LC1" in verdict.sentence


def test_method_good_on_the_load_cases_only_is_named():
    results = with_errors(jim_b={5: 0.01, 20: 0.01}, compliance={0: 0.001})
    said = " ".join(reservations(results))
    # The fixture's unseen loads: 10 % with five joint modes.
    assert "jim-b, 5 joint modes: good on the load cases, but 10 % off" in said
    assert "compliance: good on the load cases" not in said


def test_static_rival_is_judged_by_static_cases():
    results = with_errors(nmf={20: 0.01})
    step = replace(results.cases["LC2-step"], methods={})
    results = replace(results, cases={**results.cases, "LC2-step": step})
    (verdict,) = verdicts(results)
    assert verdict.grade == "good"
    assert "static load cases" in verdict.sentence
    assert "nmf, 20 joint modes (static loads only)" in headline([verdict], results)


def test_coarse_time_step_is_told_first():
    case = RESULTS.cases["LC2-step"]
    half = replace(case.half_step, pressure=1.4 * case.half_step.pressure)
    results = replace(RESULTS, cases={"LC2-step": replace(case, half_step=half)})
    assert "not converged in time" in headline(verdicts(results), results)
    page = render(Album(results), WHERE)
    assert page.index("time step is too large") < page.index('class="view-stage"')
    unchecked = replace(
        RESULTS, cases={"LC2-step": replace(case, half_step=None, half_step_times=None)}
    )
    assert "it was not checked, so convergence in time is unknown" in trust(unchecked)["Time step"]


def test_grades_are_written_as_marks_too():
    table = error_table(RESULTS.cases["LC1"])
    for row in table.rows:
        error = row[table.columns.index("max error [%]")]
        assert error.mark == {"good": "✓", "fair": "~", "poor": "✗"}[error.grade]
    assert len({len(row) for row in table.rows} | {len(table.columns)}) == 1


def test_load_cases_have_their_loads_and_extremes():
    rows = cells(section(RESULTS, "Load cases").tables[0])
    case = RESULTS.cases["LC2-step"].reference
    assert rows["LC1"]["loads"] == "tip Fz = −500 N, tip Mx = 20000 N·mm"
    assert rows["LC2-step"]["largest pressure [MPa]"] == number(case.pressure.max(), 4)
    least = rows["LC2-step"]["least clamp force of joint [N]"]
    assert least == number(case.contact_forces["joint"].min(), 5)
    assert rows["LC2-step"]["largest bolt force [N]"] == number(case.bolt_forces["bolt"].max(), 5)


def test_what_the_load_opens_is_told_by_what_the_preload_presses():
    record, case = RESULTS.interfaces["joint"], RESULTS.cases["LC1"]
    # The hump of the preload, cut off behind the bolt.
    pressure = np.where(record.points[:, 0] < 17.0, record.preload_pressure, 0.0)
    case = replace(case, reference=replace(case.reference, pressure=pressure))
    results = replace(RESULTS, cases={**RESULTS.cases, "LC1": case})
    before, now = record.preload_pressure > 0, pressure > 0
    share = (before & ~now).sum() / before.sum()  # all points stand for the same area
    assert 0.1 < share < 0.9
    rows = cells(section(results, "Load cases").tables[0])
    assert rows["LC1"]["opened by the load [%]"] == number(100 * share)
    row = cells(section(results, "Opening").tables[0])["joint"]
    # The fake gap grows along x.
    assert row["largest gap [mm]"] == "3.000e-3"
    assert (row["opens at [× load]"], row["opens at, load case"]) == ("2.500", "LC1")


def test_unreadable_study_text_is_no_obstacle():
    for text in ("not = [toml", "load_case = 3"):
        assert applied_loads(replace(RESULTS, study_text=text)) == {}


def test_timings_compare_with_the_full_model():
    rows = cells(timing_table(RESULTS))
    assert rows["full model"]["per static case [s]"] == "0.250"
    assert rows["jim-b"]["offline [s]"] == "3"
    assert rows["compliance"]["full model's time over it"] == "1"


def test_results_without_methods_make_a_report(tmp_path):
    cases = {n: replace(c, methods={}, half_step=None) for n, c in RESULTS.cases.items()}
    quiet = replace(
        RESULTS, cases=cases, bolts={}, warnings=(), timings={}, validation=ValidationRecord()
    )
    page = Page(render(Album(quiet), tmp_path))
    assert page.images == []
    assert page.text
    assert "No reduced model was compared" in "".join(
        Page(render_methods(Album(quiet), tmp_path)).text
    )


def test_folder_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FormatError, match="cannot write"):
        write_report(RESULTS, tmp_path / "file")


def test_names_of_methods_are_explained(methods):
    text = " ".join("".join(methods.text).split())
    assert "What the methods are" in text
    assert all(meaning in text for meaning in meanings(RESULTS).values())
    assert set(meanings(RESULTS)) == {name for c in RESULTS.cases.values() for name in c.methods}


def test_pages_know_an_engineers_words(written, methods):
    text = " ".join("".join(written[1].text + methods.text).split())
    for ours in (
        "the seed", "demands nothing", "once it acts", "a share slips", "65535", "not seen",
        "bounds fixed", "mode 1 of",
    ):  # fmt: skip
        assert ours not in text, ours
    assert "Numerical Studies on the Reduced Order Modeling" in text
    assert "Certified, of static cases:" in text


def test_numbers_stay_with_their_units_and_tables_are_printed_whole(written):
    page = written[0].read_text(encoding="utf-8")
    assert "td { white-space: nowrap; }" in page
    printed = page[page.index("@media print") :]
    assert ".scroll, pre { overflow: visible; }" in printed
    assert 'loading="lazy"' not in page  # pictures not yet seen would be missing in print


def test_what_may_be_meant_is_told_in_grey():
    """A joint without supports is no mistake, for inertia balances its loads."""
    page = render(Album(replace(RESULTS, notes=("no support holds 6 motion(s)",))), WHERE)
    assert '<p class="note wide asked">No support holds 6 motion(s). </p>' in page
    assert 'class="verdict doubt"' not in page


def test_instant_of_the_run_reads_like_one():
    provenance = {"faying": "0.1.0", "date": "2026-11-21T15:34:23+00:00"}
    page = render(Album(replace(RESULTS, provenance=provenance)), WHERE)
    assert "faying 0.1.0, 2026-11-21 15:34 UTC<" in page
    odd = render(Album(replace(RESULTS, provenance={"date": "once"})), WHERE)
    assert ", once<" in odd


def test_one_mode_is_singular():
    assert style.label("jim-a", 1) == "jim-a, 1 joint mode"
    assert "from 2 joint modes on" in verdicts(with_errors(jim_a={1: 0.5, 2: 0.01}))[0].sentence
    assert "with 1 joint mode," in verdicts(with_errors(jim_a={1: 0.5, 2: 0.6}))[0].sentence


def test_fewer_joint_modes_than_asked_for_are_named():
    asked = replace(
        with_errors(jim_b={5: 0.04, 7: 0.01}, compliance={0: 0.0}),
        study_text="[reduction]\njoint_modes = [5, 10]\n",
    )
    said = " ".join(reservations(asked))
    assert "jim-b: 10 joint modes were requested, but training gave only 7 joint modes" in said
    assert "compliance: 10" not in said
    for text in ("[reduction]\njoint_modes = [5, 7]\n", '[reduction]\njoint_modes = "auto"', "="):
        assert "asked for" not in " ".join(reservations(replace(asked, study_text=text)))


def test_a_mesh_error_that_is_not_known_is_said_to_be_so():
    cases = {name: replace(case, mesh_errors={}) for name, case in RESULTS.cases.items()}
    unknown = replace(RESULTS, cases=cases)
    said = trust(unknown)["Mesh and quadrature"]
    assert "joint: the mesh error of its pressures could not be estimated." in said
    assert any(
        text.endswith("discretization error of the full model.") for text in reservations(unknown)
    )
