"""The report in a real browser: its view draws, answers to slider, mouse and keyboard, needs no
network, and leaves pictures where there is no WebGL."""

import csv
import io
import re
import shutil
import zlib
from base64 import b64decode
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.image import imread
from programs import MissingProgramError, or_skip

from fake_results import fake_results
from faying.interface.surface import nodal_average
from faying.report.errors import error_table
from faying.report.figures.album import Album, FigureEntry
from faying.report.figures.model import model_figure
from faying.report.html import render, render_methods, write_report

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

PATIENCE = 120_000
"""Milliseconds that anything may take: the machine may be busy, and nothing here is about speed."""

SOFTWARE = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
"""WebGL without a graphics card."""

WIDTHS = {1280: 900, 390: 844}
"""A screen and a phone."""

PICTURE = "canvas => canvas.toDataURL()"


def chromium() -> str:
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        message = "Chromium is not installed: there is no 'chromium' on the path"
        raise MissingProgramError(message)
    return found


@pytest.fixture(scope="module")
def browser():
    program = or_skip(chromium)
    with playwright.sync_playwright() as driver:
        # As root in a container there is no sandbox and little shared memory.
        options = ["--no-sandbox", "--disable-dev-shm-usage", *SOFTWARE]
        started = driver.chromium.launch(executable_path=program, args=options, timeout=PATIENCE)
        yield started
        started.close()


@pytest.fixture(scope="module")
def results():
    return fake_results()


@pytest.fixture(scope="module")
def address(results, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    picture = folder / "figures" / "model.png"
    picture.parent.mkdir()
    picture.write_bytes(small_png())
    entry = FigureEntry(path=picture, title="Model", caption="")

    class Still(Album):
        def shown(self, *draws, of=None):
            return [entry] if draws == (model_figure,) else []

    path = folder / "report.html"
    path.write_text(render(Still(results), folder), encoding="utf-8")
    methods = render_methods(Album(results), folder)
    (folder / "methods.html").write_text(methods, encoding="utf-8")
    return path.as_uri()


def small_png():
    def chunk(kind, data):
        body = kind + data
        return len(data).to_bytes(4, "big") + body + zlib.crc32(body).to_bytes(4, "big")

    head = (4).to_bytes(4, "big") * 2 + bytes([8, 0, 0, 0, 0])
    rows = zlib.compress(bytes(4 * 5))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


class Visit:
    """A page that was opened, and all it said and asked for."""

    def __init__(self, browser, address, *, before="", **options):
        self.page = browser.new_page(**options)
        self.page.set_default_timeout(PATIENCE)
        self.said, self.asked = [], []
        self.page.on("console", lambda message: self.said.append(message.text))
        self.page.on("pageerror", lambda error: self.said.append(str(error)))
        self.page.on("request", lambda request: self.asked.append(request.url))
        if before:
            self.page.add_init_script(before)
        self.page.goto(address)
        self.page.wait_for_selector("#view[data-shown]")

    def part(self, name):
        return self.page.locator(f"#view [data-part={name}]")

    def after(self, act, attribute="shown"):
        """Do something, and wait until the view has answered."""
        count = self.page.locator("#view").get_attribute(f"data-{attribute}")
        act()
        self.page.wait_for_function(
            f"""count => {{
                const said = document.getElementById("view").dataset;
                return said.{attribute} !== count && said.asked === said.shown;
            }}""",
            arg=count,
        )

    def pixels(self):
        """The view's canvas (height, width, 4), 0 to 255."""
        picture = self.part("canvas").evaluate(PICTURE)
        read = imread(io.BytesIO(b64decode(picture.split(",")[1])), format="png")
        return np.rint(255 * read).astype(int)

    def choose(self, name, text):
        self.after(lambda: self.part(name).select_option(label=text))


@pytest.fixture(scope="module", params=WIDTHS)
def visit(request, browser, address):
    opened = Visit(
        browser, address, viewport={"width": request.param, "height": WIDTHS[request.param]}
    )
    yield opened
    opened.page.close()


def picked_value(visit):
    text = visit.part("picked").inner_text()
    found = re.fullmatch(
        r"joint at \((.*)\) mm: contact pressure (\S+) MPa( at time (\S+) s)?\.", text
    )
    assert found, text
    place = [float(x.replace("−", "-")) for x in found[1].split(", ")]
    return place, float(found[2]), found[4]


def test_view_draws_bodies_and_colours(visit):
    visit.choose("case", "LC1 (static)")
    pixels = visit.pixels()
    drawn = pixels[..., 3] > 0
    assert 0.03 < drawn.mean() < 0.9  # neither nothing nor a blank
    # Yellow, the top of the scale, is on the contact faces and nowhere else.
    red, green, blue = pixels[drawn][:, :3].T
    assert ((red > 200) & (green > 190) & (blue < 90)).any()
    assert visit.page.locator(".view-labels").inner_text().startswith("bolt ")
    size = visit.page.evaluate("[document.documentElement.scrollWidth, window.innerWidth]")
    assert size[0] <= size[1]


@pytest.mark.long
def test_slider_moves_through_time_and_the_bolt_force_follows(visit, results):
    visit.choose("case", "LC2-step (step)")
    slider = visit.part("frame")
    slider.focus()
    visit.after(lambda: visit.page.keyboard.press("Home"))
    before = visit.pixels()
    case = results.cases["LC2-step"]
    for at, key in ((0, None), (1, "ArrowRight")):
        if key:
            visit.after(lambda key=key: visit.page.keyboard.press(key))
        force = float(visit.page.locator(".view-labels").inner_text().split()[1])
        assert force == pytest.approx(case.reference.bolt_forces["bolt"][at], rel=5e-4)
    assert visit.part("instant").inner_text() == "time 1.00e-4 s"
    assert (visit.pixels() != before).any()
    # One step of the animation, for on a busy machine its timer overtakes what draws.
    visit.page.evaluate(
        """() => {
            window.usual = window.setInterval;
            window.setInterval = (step) => { step(); return -1; };
        }"""
    )
    visit.after(lambda: visit.part("play").click())
    visit.page.evaluate("() => { window.setInterval = window.usual; }")
    assert visit.part("play").inner_text() == "Stop"
    assert visit.part("frame").input_value() == "2"
    visit.part("play").click()
    assert visit.part("play").inner_text() == "Play"


def test_bodies_move_with_the_instants_and_say_how_far(visit, results):
    visit.choose("case", "LC2-step (step)")
    visit.part("frame").focus()
    visit.after(lambda: visit.page.keyboard.press("Home"))
    assert visit.part("stretching").is_visible()
    before = np.argwhere(visit.pixels()[..., 3] > 0).mean(axis=0)
    visit.after(lambda: visit.page.keyboard.press("End"))
    after = np.argwhere(visit.pixels()[..., 3] > 0).mean(axis=0)
    assert np.abs(after - before).max() > 1.0  # pixels, of the middle of what is drawn
    ratio = visit.part("canvas").evaluate("canvas => canvas.width / canvas.clientWidth")
    visit.part("canvas").click(position=body_place(visit, ratio))
    text = visit.part("picked").inner_text()
    found = re.fullmatch(r"On a body, at .*: displaced by (\S+) mm at time 0\.001 s\.", text)
    assert found, text
    motion = results.cases["LC2-step"].reference.motion
    distance = np.linalg.norm(np.tensordot(motion.amplitudes[-1], motion.shapes, axes=1), axis=1)
    assert np.abs(distance - float(found[1])).min() < 5e-3 * distance.max()
    assert (
        visit.page.locator(".view-history svg")
        .get_attribute("aria-label")
        .startswith("displacement over time, from ")
    )
    visit.part("frame").focus()
    visit.after(lambda: visit.page.keyboard.press("Home"))


def body_place(visit, ratio):
    """Where the largest patch of a body's plain colour is, in points of the page."""
    pixels = visit.pixels()
    flat = (np.abs(np.diff(pixels[..., :3], axis=1)).max(axis=2) == 0) & (pixels[:, 1:, 3] == 255)
    grey = flat & (np.ptp(pixels[:, 1:, :3], axis=2) < 90)
    rows, columns = np.nonzero(grey)
    row = np.bincount(rows).argmax()
    run = columns[rows == row]
    return {"x": float(np.median(run)) / ratio, "y": float(row) / ratio}


def test_largest_value_is_that_of_the_results(visit, results):
    visit.choose("case", "LC2-step (step)")
    visit.part("largest").click()
    case, joint = results.cases["LC2-step"], results.interfaces["joint"]
    averages = nodal_average(joint, case.reference.pressure)
    at = int(averages.max(axis=1).argmax())
    visit.part("frame").focus()
    visit.after(lambda: visit.page.keyboard.press("End"))
    visit.after(lambda: visit.part("frame").fill(str(at)))
    visit.part("largest").click()
    place, value, _ = picked_value(visit)
    assert value == pytest.approx(averages.max(), rel=5e-3)  # three digits
    # The hump is symmetric, so that several points share the peak.
    peaks = joint.pair_points[np.isclose(averages[at], averages.max())]
    assert np.abs(peaks - place).sum(axis=1).min() < 1e-3
    assert (
        visit.page.locator(".view-history svg")
        .get_attribute("aria-label")
        .startswith("contact pressure over time, from ")
    )


def test_click_reads_the_point_that_is_clicked(visit):
    visit.choose("case", "LC1 (static)")
    visit.after(lambda: visit.part("apart").fill("0.6"))
    visit.after(lambda: visit.part("whole").click(), "drawn")
    # Away first, so that the mark appears in the picture.
    visit.after(lambda: visit.part("canvas").click(position={"x": 3, "y": 3}), "drawn")
    before = visit.pixels()
    visit.after(lambda: visit.part("largest").click(), "drawn")
    wanted = picked_value(visit)
    changed = np.argwhere(np.abs(visit.pixels() - before).max(axis=2) > 40)
    ratio = visit.part("canvas").evaluate("canvas => canvas.width / canvas.clientWidth")
    y, x = (changed.min(axis=0) + changed.max(axis=0)) / 2 / ratio
    visit.after(
        lambda: visit.part("canvas").click(position={"x": float(x), "y": float(y)}), "drawn"
    )
    assert picked_value(visit) == wanted


def test_keyboard_turns_and_reads(visit):
    canvas = visit.part("canvas")
    canvas.focus()
    before = visit.pixels()
    visit.after(lambda: visit.page.keyboard.press("ArrowLeft"), "drawn")
    visit.after(lambda: visit.page.keyboard.press("+"), "drawn")
    assert (visit.pixels() != before).any()
    visit.after(lambda: visit.page.keyboard.press("0"), "drawn")
    visit.after(lambda: visit.page.keyboard.press("Enter"), "drawn")
    assert "Click or tap" not in visit.part("picked").inner_text()


def test_error_of_a_method_is_over_the_peak_of_its_reference(visit, results):
    visit.choose("case", "LC1 (static)")
    visit.choose("model", "jim-a, 5 joint modes")
    visit.choose("quantity", "error of pressure")
    case, joint = results.cases["LC1"], results.interfaces["joint"]
    method = case.methods["jim-a"][5].response.pressure
    off = nodal_average(joint, method - case.reference.pressure) / case.reference.pressure.max()
    shown = float(visit.part("high").inner_text().split()[0])
    assert shown == pytest.approx(100 * np.abs(off).max(), rel=5e-3)
    assert visit.part("low").inner_text() == f"−{visit.part('high').inner_text().split()[0]}"
    visit.choose("model", "full model")
    assert visit.part("quantity").input_value() == "pressure"


def test_map_zooms_and_says_what_is_under_the_pointer(visit):
    canvas = visit.page.locator(".view-maps canvas")
    canvas.scroll_into_view_if_needed()
    canvas.hover()
    caption = visit.page.locator(".view-maps figcaption")
    assert re.fullmatch(r"joint: \S+ MPa at x \S+ mm, y \S+ mm", caption.inner_text())
    before = canvas.evaluate(PICTURE)
    canvas.focus()
    visit.page.keyboard.press("+")
    assert canvas.evaluate(PICTURE) != before
    visit.page.keyboard.press("0")
    assert canvas.evaluate(PICTURE) == before


@pytest.mark.long
def test_tables_are_sorted_and_taken_along(browser, address, results):
    """As csv they have numbers, with units in the heads."""
    wanted = error_table(results.cases["LC1"])
    page = browser.new_page(viewport={"width": max(WIDTHS), "height": 900})
    page.set_default_timeout(PATIENCE)
    page.goto(address.replace("report.html", "methods.html"))
    table = page.locator("h3:text-is('LC1') ~ .scroll").first
    column = wanted.columns.index("max error [%]")
    head = table.locator(f"thead th:nth-child({column + 1})")
    cells = table.locator(f"tbody tr td:nth-child({column + 1})")

    def values():
        return [float(cell.get_attribute("data-value")) for cell in cells.all()]

    head.get_by_role("button").click()
    assert head.get_attribute("aria-sort") == "ascending"
    assert values() == sorted(values())
    head.get_by_role("button").click()
    assert values() == sorted(values(), reverse=True)
    with page.expect_download() as download:
        page.locator("h3:text-is('LC1') ~ button.csv").first.click()
    text = download.value.path().read_text(encoding="utf-8-sig")
    rows = list(csv.reader(io.StringIO(text)))
    assert rows[0] == list(wanted.names)
    for row in rows[1:]:
        (same,) = (one for one in wanted.rows if one[0].text == row[0])
        assert [float(text) for text in row[1:]] == [cell.value for cell in same[1:]]
    page.close()


def test_nothing_was_said_or_fetched(visit):
    """Last of the visits: all the tests above are behind it."""
    assert visit.said == []
    assert all(url.startswith(("file:", "blob:")) for url in visit.asked)


@pytest.mark.long
def test_print_shows_the_picture_instead(browser, address):
    opened = Visit(browser, address)
    still = opened.page.locator(".still")
    assert not still.is_visible()
    opened.page.emulate_media(media="print")
    assert still.is_visible()
    assert not opened.page.locator("#view").is_visible()
    opened.page.close()


@pytest.mark.long
def test_dark_scheme_changes_paper_and_ink(browser, address):
    opened = Visit(browser, address, color_scheme="dark")
    colours = opened.page.evaluate(
        "[getComputedStyle(document.body).backgroundColor, getComputedStyle(document.body).color]"
    )
    paper, ink = (sum(map(int, re.findall(r"\d+", colour))) for colour in colours)
    assert paper < 120 < 600 < ink
    opened.page.close()


@pytest.mark.long
def test_without_webgl_maps_and_picture_stay(browser, address):
    none = """
    const real = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        return kind.startsWith("webgl") ? null : real.call(this, kind, ...rest);
    };"""
    opened = Visit(browser, address, before=none)
    assert opened.part("no-webgl").is_visible()
    assert opened.page.locator(".still").is_visible()
    assert not opened.part("stage").is_visible()
    opened.page.locator(".view-maps canvas").hover()
    assert " MPa at x " in opened.page.locator(".view-maps figcaption").inner_text()
    opened.part("largest").click()
    picked_value(opened)
    assert opened.said == []
    opened.page.close()


@pytest.mark.long
@pytest.mark.parametrize("width", WIDTHS)
def test_labels_of_bolts_do_not_hide_one_another(browser, results, tmp_path, width):
    one = results.bolts["bolt"]
    bolts = {
        f"M8 number {k}": replace(one, axis=one.axis + np.array([2.0 * k, 0.0, 0.0]))
        for k in range(6)
    }
    page = tmp_path / "report.html"
    page.write_text(render(Album(replace(results, bolts=bolts)), tmp_path), encoding="utf-8")
    opened = Visit(browser, page.as_uri(), viewport={"width": width, "height": WIDTHS[width]})
    boxes = opened.page.evaluate(
        """() => [...document.querySelectorAll(".view-labels, .view-labels span")].map((one) => {
            const { left, right, top, bottom } = one.getBoundingClientRect();
            return [left, right, top, bottom];
        })"""
    )
    (left, right, *_), *labels = boxes
    assert len(labels) == 6
    for number, (a, b, c, d) in enumerate(labels):
        assert left - 0.5 <= a < b <= right + 0.5
        for e, f, g, h in labels[:number]:
            assert b <= e or f <= a or d <= g or h <= c
    opened.page.close()


@pytest.mark.long
def test_joint_stays_whole_in_a_window_that_gets_narrow(browser, address):
    opened = Visit(browser, address, viewport={"width": 1280, "height": 900})
    opened.page.set_viewport_size({"width": 390, "height": 2600})
    opened.page.wait_for_function(
        "() => { const { width } = document.querySelector('#view canvas'); return width < 400; }"
    )
    drawn = opened.pixels()[..., 3] > 0
    opened.page.close()
    assert drawn.any()
    assert not drawn[:, [0, -1]].any()


@pytest.mark.long
def test_interfaces_at_rest_alone_are_shown_too(browser, results, tmp_path):
    """Without load cases and bolts there is still the joint as it is."""
    page = tmp_path / "report.html"
    quiet = replace(results, cases={}, bolts={})
    page.write_text(render(Album(quiet), tmp_path), encoding="utf-8")
    opened = Visit(browser, page.as_uri())
    assert opened.part("case").inner_text() == "preload (bolts tightened, no load)"
    assert opened.said == []
    opened.page.close()


def two_interfaces(results):
    """The same joint with its interface twice: fields side by side."""
    joint = results.interfaces["joint"]
    n, found = len(joint.weights), results.assessment

    def twice(response):
        fields = {
            name: np.concatenate([getattr(response, name)] * 2, axis=-1)
            for name in ("pressure", "gap")
        }
        sums = {
            name: {one: getattr(response, name)["joint"] for one in ("low", "up")}
            for name in ("contact_forces", "open_fraction")
        }
        return replace(response, recovered_pressure=None, **fields, **sums)

    cases = {
        name: replace(
            case,
            reference=twice(case.reference),
            half_step=case.half_step and twice(case.half_step),
            methods={
                method: {n: replace(one, response=twice(one.response)) for n, one in sizes.items()}
                for method, sizes in case.methods.items()
            },
        )
        for name, case in results.cases.items()
    }
    return replace(
        results,
        cases=cases,
        interfaces={"low": joint, "up": replace(joint, slice=(n, 2 * n))},
        assessment=replace(
            found,
            interfaces=dict.fromkeys(("low", "up"), found.interfaces["joint"]),
            bolts={"bolt": replace(found.bolts["bolt"], clamp_around={})},
        ),
    )


@pytest.mark.long
def test_three_cases_and_two_interfaces_take_few_screens(browser, results, tmp_path):
    """Seconds, for pictures are as large as in use: what is measured is what they take."""
    both = two_interfaces(results)
    (bolt,) = both.assessment.bolts.values()
    bolts = {f"bolt-{number}": bolt for number in range(1, 9)}
    joint = replace(both, assessment=replace(both.assessment, bolts=bolts))
    path = write_report(joint, tmp_path)
    opened = Visit(browser, path.as_uri(), viewport={"width": 1280, "height": 800})
    height = opened.page.evaluate("document.documentElement.scrollHeight")
    assert height <= 8 * 800
    for name in ("#joint", "#view [data-part=stage]"):
        box = opened.page.locator(name).bounding_box()
        assert box["y"] + box["height"] <= 800, name
    # Ten rows, of which five are on the first screen and all are printed.
    rows = opened.page.locator("#joint tbody tr")
    assert (rows.count(), rows.filter(visible=True).count()) == (10, 5)
    opened.page.locator(".unfold input").check()
    assert rows.filter(visible=True).count() == 10
    opened.page.locator(".unfold input").uncheck()
    printed = opened.page.pdf(format="A4")
    assert len(re.findall(rb"/Type\s*/Page[^s]", printed)) <= 5
    opened.page.set_viewport_size({"width": 390, "height": 844})
    assert opened.page.evaluate("document.documentElement.scrollWidth") == 390
    assert opened.said == []
    opened.page.close()
