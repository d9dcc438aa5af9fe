"""The report answers in the order an engineer asks, with units, and works without a network."""

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest

import faying as fy
from fake_results import fake_results
from faying.exceptions import FormatError
from faying.report import style
from faying.report.certified import sharpness
from faying.report.html import render, write_report
from faying.report.joint import clamp_judgement
from faying.report.limits import limits
from faying.report.meanings import meanings
from faying.report.quantities import percent, quantity
from faying.report.tables import applied_loads, case_table, error_table, timing_table
from faying.report.verdict import headline, reservations, verdicts
from faying.study.validation_record import ValidationRecord
from faying.units import units_of

WHOLE = fake_results()
# Two cases show all there is to show and draw in less time.
RESULTS = replace(WHOLE, cases={name: WHOLE.cases[name] for name in ("LC1", "LC2-step")})
WHERE = Path("run")
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


def test_clamp_forces_are_told_around_each_of_several_bolts():
    model = fy.lap_joint(element_size=5.0, bolt_positions=((-10.0, 0.0), (10.0, 0.0)))
    joint = fy.preload(model, dict.fromkeys(model.bolts, 8e3))
    found = fy.assess(joint, [fy.Load({"tip.Fz": -300.0}, name="bend")], paths=False)
    rows = clamp_judgement(replace(RESULTS, assessment=found)).rows
    around = found.bolts["bolt-2"].clamp_around["joint"]
    assert [row[0].text for row in rows] == [
        "joint",
        "joint around bolt-1",
        "joint around bolt-2",
    ]
    assert rows[2][4].text == f"{quantity(around.most, 'N', 5)} (bend)"
    alone = replace(found, bolts={"bolt-2": found.bolts["bolt-2"]})
    assert len(clamp_judgement(replace(RESULTS, assessment=alone)).rows) == 1
    bare = {"certified": None, "certified_most": None, "certified_width": None}
    joint = replace(
        found, bolts={}, interfaces={"joint": replace(found.interfaces["joint"], **bare)}
    )
    table = clamp_judgement(replace(RESULTS, assessment=joint))
    assert table.columns == ("clamp force of", "at rest", "smallest", "largest")


def test_page_stands_alone(written):
    path, page = written
    assert path.name == "report.html"
    # Scripts name a namespace; that they fetch nothing is seen in a browser.
    assert "http" not in re.sub(r"(?s)<script.*?</script>", "", path.read_text(encoding="utf-8"))
    assert len(page.images) == 14  # the model twice: for print and where there is no WebGL
    for image in page.images:
        assert image.startswith("figures/")
        assert (path.parent / unquote(image)).is_file()


def test_contents_lead_somewhere(written):
    _, page = written
    anchors = [link[1:] for link in page.links if link.startswith("#")]
    assert len(anchors) == 11 + len(RESULTS.cases)
    assert set(anchors) <= set(page.ids)
    assert len(set(page.ids)) == len(page.ids)


def test_normal_modes_that_were_chosen_are_said_with_the_reason(written):
    _, page = written
    text = " ".join("".join(page.text).split())
    assert 'LC2-step: normal_modes = "auto" is 20; the loads excite modes up to 7.96e+03 Hz' in text
    assert "off by an unknown share with 10, 3.10% with 20; 2.5 times that, the most" in text
    assert "is not within the tolerance of 2%: more modes bring too little" in text


def test_user_text_is_escaped(written):
    _, page = written
    text = "".join(page.text)
    assert "Two bars <fake> & co" in text
    assert "# α & <β>" in text


def test_sections_come_in_the_order_of_the_questions(written):
    _, page = written
    order = ["summary", "model", "load-cases", "convergence", "errors", "beyond", "accuracy"]
    assert [name for name in page.ids if name in order] == order


def test_page_says_what_it_must(written):
    text = " ".join("".join(written[1].text).split())
    for needed in (
        "max relative pressure error",
        "nodal averages",
        "quadrature",
        "Time-step check",
        "10000 N",
        "100000 N/mm³",
        "jim-a with 40 joint modes: no solution",
        "unseen loads, nmf: it met what <nobody> foresaw",
        "1 part(s) of the validation could not be computed",
        "Stiff enough <here>.",
        "energy error at most 10 %",
        "Max relative pressure errors at 100 random static loads",
        "recovered from its motion in transients, pressures are off by 2.0 %",
        "tip Fz = −500 N, tip Mx = 20000 N·mm",
    ):
        assert needed in text, needed


def test_what_limits_accuracy_is_said_of_this_joint_alone(written):
    text = " ".join("".join(written[1].text).split())
    for foreign in ("73 to 112", "153 MPa", "219 MPa", "cantilever", "time-step checks above"):
        assert foreign not in text, foreign
    assert "joint: 28 contact points by the rule nodal on 18 facets, 6.24 mm wide" in text
    # Nodal points are their own averages.
    assert "stands up to 0 % above the largest nodal average" in text
    assert (
        "joint: estimated from this mesh alone, its pressures are off by 4.0 % of the peak in the "
        "root mean square"
    ) in text
    assert "single points by up to 30 %." in text
    assert "Under nodal quadrature the truth was up to three times the estimate." in text
    assert "This is an estimate, no bound" in text
    assert "discretization error, which the mesh alone is estimated to make 4.0 %" in text
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
    found = limits(quiet)
    assert list(found) == ["Mesh and quadrature", "Contact law"]
    assert found["Contact law"] == "joint: hard contact, nothing penetrates."


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
    assert "certified: max error" in columns
    assert "residual of friction" not in columns
    silent = {
        name: {count: replace(one, certified_bound=None) for count, one in sizes.items()}
        for name, sizes in case.methods.items()
    }
    assert "certified: max error" not in error_table(replace(case, methods=silent)).columns


def test_certified_energy_and_clamp_force_come_before_the_pressure_and_its_loose_bound():
    columns = error_table(RESULTS.cases["LC1"]).columns
    bounds = [name for name in columns if name.startswith("certified")]
    assert bounds == [
        "certified: energy error", "certified: clamp force error", "certified: max error",
    ]  # fmt: skip
    results = with_errors(jim_b={5: 0.02, 20: 0.001}, compliance={0: 1e-9})
    # The bound of jim-b with 5 joint modes, 0.1, serves as template: 5 and 100 times the errors;
    # what is exact to round-off tells nothing.
    assert "is 5.00 to 100 times the true one, 52.5 times in the median" in sharpness(results)
    assert sharpness(with_errors(compliance={0: 1e-9})) == ""


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


def test_what_makes_the_joint_itself_doubtful_stands_first():
    def held_by_springs(case, share):
        shares = {"upper-lower": np.array([share])}
        return replace(case, reference=replace(case.reference, weak_shares=shares))

    doubtful = replace(
        RESULTS,
        cases={name: held_by_springs(case, 0.02) for name, case in RESULTS.cases.items()},
        warnings=("LC1: not converged",),
    )
    page = render(doubtful, [], WHERE)
    # A sentence, not one for each load case.
    assert page.count("the weak springs upper-lower carry 0.02 of the contact force") == 1
    assert page.index("weak springs upper-lower") < page.index('class="view-stage"')
    assert page.index("1 solution(s) did not converge") < page.index('class="view-stage"')
    harmless = replace(
        RESULTS,
        cases={name: held_by_springs(case, 1e-6) for name, case in RESULTS.cases.items()},
        warnings=(),
    )
    assert "Before these figures are used" not in render(harmless, [], WHERE)


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
    assert "not converged in time in LC2-step" in headline(verdicts(results), results)
    assert any("time step is not fine enough" in said for said in reservations(results))
    unchecked = replace(
        RESULTS, cases={"LC2-step": replace(case, half_step=None, half_step_times=None)}
    )
    assert any("no time-step check" in said for said in reservations(unchecked))


def test_grades_are_written_as_marks_too():
    table = error_table(RESULTS.cases["LC1"])
    for row in table.rows:
        error = row[table.columns.index("max error")]
        assert error.mark == {"good": "✓", "fair": "~", "poor": "✗"}[error.grade]
    assert len({len(row) for row in table.rows} | {len(table.columns)}) == 1


def test_load_case_table_has_the_peak_and_its_place():
    table = case_table(RESULTS)
    cells = {row[0].text: [cell.text for cell in row] for row in table.rows}
    # The pressure's hump is centred between nodes, four of which share the peak.
    assert cells["LC1"][4].startswith("joint (15, 5, 5) mm")
    assert cells["LC2-step"][4].endswith(" s")
    assert "…" in cells["LC2-step"][table.columns.index("bolt force")]


def test_load_case_table_says_what_the_load_opens_and_where():
    record, case = RESULTS.interfaces["joint"], RESULTS.cases["LC1"]
    # The hump of the preload, cut off behind the bolt.
    pressure = np.where(record.points[:, 0] < 17.0, record.preload_pressure, 0.0)
    case = replace(case, reference=replace(case.reference, pressure=pressure))
    table = case_table(replace(RESULTS, cases={**RESULTS.cases, "LC1": case}))
    cells = {row[0].text: [cell.text for cell in row] for row in table.rows}
    opened, gap = (table.columns.index(name) for name in ("opened by the load", "largest gap"))
    before, now = record.preload_pressure > 0, pressure > 0
    share = (before & ~now).sum() / before.sum()  # all points stand for the same area
    assert 0.1 < share < 0.9
    assert cells["LC1"][opened] == percent(share)
    # The fake gap grows along x; the first of the points at its end is named.
    assert cells["LC1"][gap] == "3.00e-3 mm at (30, 0, 5) mm"
    assert cells["LC2-step"][gap].endswith("mm at 0 s")
    assert cells["LC1"][opened] != cells["LC1"][table.columns.index("without pressure")]


def test_unreadable_study_text_is_no_obstacle():
    assert applied_loads("not = [toml", units_of("mm-t-s")) == {}
    assert applied_loads("load_case = 3", units_of("mm-t-s")) == {}


def test_timings_compare_with_the_full_model():
    rows = {row[0].text: [cell.text for cell in row] for row in timing_table(RESULTS).rows}
    assert rows["full model"][2] == "0.250 s"
    assert rows["jim-b"][1] == "3.00 s"
    assert rows["compliance"][3] == "1.0 ×"


def test_results_without_methods_make_a_report(tmp_path):
    cases = {n: replace(c, methods={}, half_step=None) for n, c in RESULTS.cases.items()}
    quiet = replace(
        RESULTS, cases=cases, bolts={}, warnings=(), timings={}, validation=ValidationRecord()
    )
    page = Page(render(quiet, [], tmp_path))
    assert "No reduced model was compared" in "".join(page.text)
    assert page.images == []
    assert page.text


def test_folder_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FormatError, match="cannot write"):
        write_report(RESULTS, tmp_path / "file")


def test_names_of_methods_are_explained(written):
    text = " ".join("".join(written[1].text).split())
    assert "What the methods are" in text
    assert all(meaning in text for meaning in meanings(RESULTS).values())
    assert set(meanings(RESULTS)) == {name for c in RESULTS.cases.values() for name in c.methods}


def test_page_knows_no_words_of_our_own(written):
    text = " ".join("".join(written[1].text).split())
    assert "the seed" not in text
    assert "Numerical Studies on the Reduced Order Modeling" in text
    assert "Certified, of static cases:" in text


def test_numbers_stay_with_their_units_and_tables_are_printed_whole(written):
    page = written[0].read_text(encoding="utf-8")
    assert "td { white-space: nowrap; }" in page
    printed = page[page.index("@media print") :]
    assert ".scroll, pre { overflow: visible; }" in printed
    assert 'loading="lazy"' not in page  # pictures not yet seen would be missing in print


def test_instant_of_the_run_reads_like_one():
    provenance = {"faying": "0.1.0", "date": "2026-11-21T15:34:23+00:00"}
    page = render(replace(RESULTS, provenance=provenance), [], WHERE)
    assert "faying 0.1.0, 2026-11-21 15:34 UTC." in page
    odd = render(replace(RESULTS, provenance={"date": "once"}), [], WHERE)
    assert ", once." in odd


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
    assert "jim-b: 10 joint modes were asked for, but only 7 joint modes could be made" in said
    assert "compliance: 10" not in said
    for text in ("[reduction]\njoint_modes = [5, 7]\n", '[reduction]\njoint_modes = "auto"', "="):
        assert "asked for" not in " ".join(reservations(replace(asked, study_text=text)))


def test_a_mesh_error_that_is_not_known_is_said_to_be_so():
    cases = {name: replace(case, mesh_errors={}) for name, case in RESULTS.cases.items()}
    unknown = replace(RESULTS, cases=cases)
    said = limits(unknown)["Mesh and quadrature"]
    assert "joint: what the mesh does to its pressures could not be estimated." in said
    assert any(text.endswith("own discretization error.") for text in reservations(unknown))
