"""Figures show what the numbers say, in all cases a run can leave."""

import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread

import faying.sources
from fake_results import NX, NY, fake_results
from faying.assessment.response_curve import ResponseCurve
from faying.display.quantities import number, percent, place, seconds
from faying.exceptions import FormatError
from faying.files.names import file_names
from faying.interface.interface import FacePairs
from faying.joint.picture import frame, name_axes, plot_bodies, plot_model, title_above
from faying.report import style
from faying.report.figures.album import Album
from faying.report.figures.convergence import convergence_figure, plot_convergence
from faying.report.figures.frequency import phases
from faying.report.figures.maps import (
    OPENING_STATES,
    gap_figure,
    initial_gap_figure,
    plot_pressure,
    plot_states,
    preload_figure,
    pressure_figure,
    summary,
)
from faying.report.figures.model import model_figure, tightening_figure
from faying.report.figures.response import plot_peak_pressure, response_figure
from faying.report.figures.surface_map import best_plane, draw_map, outline
from faying.report.style import colour, house_style, new_figure
from faying.study.judgement.step_check import step_check
from faying.units import units_of

RESULTS = fake_results()
JOINT = RESULTS.interfaces["joint"]
MM = units_of("mm-t-s")


def album(results, folder):
    """Draw each kind of picture of the paper."""
    shown, of = Album(results, folder).shown, results.cases.values()
    static = [case for case in of if case.times is None]
    run = (model_figure, preload_figure, tightening_figure, convergence_figure)
    entries = [*shown(*run), *shown(pressure_figure, of=static), *shown(gap_figure, of=of)]
    return [*entries, *shown(response_figure, of=[case for case in of if case not in static])]


@pytest.fixture(scope="module")
def entries(tmp_path_factory):
    return album(RESULTS, tmp_path_factory.mktemp("run") / "figures")


@pytest.fixture
def coarse(monkeypatch):
    """Quick pictures where only their existence matters."""
    monkeypatch.setattr(style, "DPI", 40)


def panel():
    return new_figure(4.0, 3.0).add_subplot()


def test_every_picture_of_the_paper_is_drawn(entries):
    assert [entry.path.stem for entry in entries] == [
        "model",
        "preload",
        "tightening",
        "convergence",
        "case_LC1_pressure",
        "case_LC2-torsion_pressure",
        "case_LC1_gap",
        "case_LC2-torsion_gap",
        "case_LC2-step_gap",
        "case_LC2-step_response",
    ]


@pytest.mark.long
def test_pictures_are_not_blank(entries):
    for entry in entries:
        pixels = imread(entry.path)[..., :3]
        assert min(pixels.shape[:2]) > 200
        # Margins are cut, so ink fills a good part of any picture of ours.
        assert 0.01 < (pixels.min(axis=-1) < 0.97).mean() < 0.99, entry.path.name


def test_error_over_joint_modes_is_left_out_where_no_method_has_joint_modes():
    def only_zero(case):
        return replace(case, methods={"compliance": {0: case.methods["compliance"][0]}})

    none = replace(RESULTS, cases={name: only_zero(case) for name, case in RESULTS.cases.items()})
    assert convergence_figure(none) is None
    assert convergence_figure(RESULTS) is not None


def test_captions_give_the_numbers(entries):
    captions = {entry.path.stem: entry.caption for entry in entries}
    peak = RESULTS.cases["LC1"].reference.pressure.max()
    assert f"max {peak:.1f} MPa at" in captions["case_LC1_pressure"]
    assert "node pairs stick" in captions["preload"]
    assert "axis of bolt" in captions["model"]


def test_drawing_leaves_no_global_state():
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    with house_style():
        pass
    assert dict(mpl.rcParams) == before


@pytest.mark.long
def test_drawing_needs_no_pyplot():
    """In a process of its own: packages that other tests import bring pyplot themselves."""
    script = "import sys, faying.report.html; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


def test_pressure_scale_starts_at_zero_and_other_scales_are_as_given():
    axes = plot_pressure(JOINT, JOINT.preload_pressure, panel(), MM)
    (image,) = axes.images
    assert (image.norm.vmin, image.norm.vmax) == (0.0, JOINT.preload_pressure.max())
    assert axes.get_xlabel() == "x [mm]"
    error = np.linspace(-0.3, 0.1, len(JOINT.points))
    limits = (-0.3, 0.3)
    axes = draw_map(JOINT, error, panel(), MM, colours="RdBu_r", limits=limits, label="error")
    (image,) = axes.images
    assert (image.norm.vmin, image.norm.vmax) == limits
    assert image.get_array().min() == pytest.approx(-0.3)


def test_small_numbers_beside_colour_bars_have_no_factor_above_them():
    """Slips of a few hundredths of a micrometre: 1e-5 stood on the title of the next map."""
    slip, scale = np.linspace(0.0, 6e-5, len(JOINT.points)), (0.0, 6e-5)
    axes = draw_map(JOINT, slip, panel(), MM, colours="viridis", limits=scale, label="slip")
    axes.figure.canvas.draw()
    (bar,) = axes.child_axes
    assert bar.yaxis.get_offset_text().get_text() == ""
    assert "2e-5" in [text.get_text() for text in bar.get_yticklabels()]


def colour_at(axes, x, y):
    """Return the colour (3,) of a drawn figure at a place in data coordinates."""
    figure = axes.figure
    figure.canvas.draw()
    pixels = np.asarray(figure.canvas.buffer_rgba())[::-1, :, :3] / 255.0
    column, row = axes.transData.transform((x, y)).astype(int)
    return pixels[row, column]


def test_what_lies_around_open_points_is_grey():
    pressure = np.where(JOINT.points[:, 0] < 12.0, 40.0, 0.0)
    axes = plot_pressure(JOINT, pressure, panel(), MM)
    grey = np.array(to_rgb(style.OPEN_COLOUR))
    # Points at 10 press, those at 15 do not; the middle divides them.
    assert np.abs(colour_at(axes, 14.0, 6.0) - grey).max() < 0.02  # eight bits a colour
    assert np.abs(colour_at(axes, 11.0, 6.0) - grey).max() > 0.2


def test_gap_figure_tells_what_opened_from_what_never_was_pressed():
    case = RESULTS.cases["LC1"]
    # The hump of the preload, cut off behind the bolt.
    pressure = np.where(JOINT.points[:, 0] < 17.0, JOINT.preload_pressure, 0.0)
    case = replace(case, reference=replace(case.reference, pressure=pressure))
    axes = plot_states(JOINT, pressure, panel(), MM)
    before, now = JOINT.preload_pressure > 0, pressure > 0
    opened, idle = (np.flatnonzero(before & ~now)[0], np.flatnonzero(~before & ~now)[0])
    for point, state in ((opened, "opened by the load"), (idle, "open before and now")):
        x, y = JOINT.points[point, :2]
        inside = (x + (0.9 if x < 15 else -0.9), y + (0.9 if y < 7 else -0.9))  # off the edges
        expected = np.array(to_rgb(OPENING_STATES[state]))
        assert np.abs(colour_at(axes, *inside) - expected).max() < 0.02
    caption = gap_figure(RESULTS, case).caption
    assert "largest gap 3.00e-3 mm at (30, 0, 5) mm" in caption
    closed = replace(case, reference=replace(case.reference, gap=-np.ones(JOINT.points.shape[0])))
    assert gap_figure(RESULTS, closed) is None


def test_the_initial_gap_is_drawn_where_surfaces_part():
    touching = replace(JOINT, initial_gap=0 * JOINT.initial_gap)
    assert initial_gap_figure(replace(RESULTS, interfaces={"joint": touching})) is None
    parted = replace(JOINT, initial_gap=np.linspace(0.0, 0.0256, len(JOINT.points)))
    figure = initial_gap_figure(replace(RESULTS, interfaces={"joint": parted})).figure
    assert figure.axes[0].get_title(loc="left") == "joint: up to 0.0256 mm before any load"
    across = replace(JOINT, initial_gap=np.linspace(-0.0125, 0.0256, len(JOINT.points)))
    figure = initial_gap_figure(replace(RESULTS, interfaces={"joint": across})).figure
    assert figure.axes[0].get_title(loc="left").endswith("load, overlap up to 0.0125 mm")


def test_a_map_shows_each_point_in_its_place():
    axes = draw_map(
        JOINT, JOINT.points[:, 0], panel(), MM, colours="RdBu_r", limits=(0.0, 30.0), label="x"
    )
    (image,) = axes.images
    left, right, _, _ = image.get_extent()
    values = image.get_array()[image.get_array().shape[0] // 2]
    x = np.linspace(left, right, len(values))
    # The nearest of points 5 mm apart is at most half of that away, and a pixel.
    assert np.abs(values - x).max() < 2.6


def test_methods_keep_their_colours():
    axes = plot_convergence(RESULTS.cases["LC1"], panel())
    colours = {line.get_label(): line.get_color() for line in axes.lines}
    for method in RESULTS.cases["LC1"].methods:
        assert colours[method] == colour(method)
    assert axes.get_yscale() == "log"


def test_step_check_sees_a_difference_the_peak_hides():
    case = RESULTS.cases["LC2-step"]
    half = replace(case.half_step, pressure=case.half_step.pressure.copy())
    half.pressure[::2] = case.reference.pressure
    half.pressure[4] = np.roll(case.reference.pressure[2], 3)
    check = step_check(replace(case, half_step=half))
    assert half.pressure[4].max() == case.reference.pressure[2].max()
    assert check.largest > 0.3
    assert check.change.displacement_error == pytest.approx(0.005, rel=1e-9)  # 0.05 / 10
    assert step_check(RESULTS.cases["LC1"]) is None


def test_step_check_bears_half_a_step_more_or_less():
    case = RESULTS.cases["LC2-step"]
    for ends in (-1, -2, -3):
        half = replace(
            case.half_step,
            pressure=case.half_step.pressure[:ends],
            displacements={n: u[:ends] for n, u in case.half_step.displacements.items()},
        )
        assert step_check(replace(case, half_step=half)).largest < np.inf


def test_outline_is_the_rim():
    lengths = np.linalg.norm(np.diff(outline(JOINT), axis=1)[:, 0], axis=1)
    assert lengths.sum() == pytest.approx(2 * 5.0 * (NX + NY))


def test_plane_of_a_vertical_interface():
    turn = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    upright = replace(
        JOINT,
        points=JOINT.points @ turn,
        pair_points=JOINT.pair_points @ turn,
        normals=JOINT.normals @ turn,
    )
    plane = best_plane(upright)
    assert plane.flat
    assert plane.labels == ("x", "z")
    np.testing.assert_allclose(plane.axes @ plane.axes.T, np.eye(2), atol=1e-15)


def test_sleeve_is_projected_along_its_axis():
    angle = JOINT.points[:, 0] / 30.0 * 2 * np.pi
    ring = np.stack([50 * np.cos(angle), 50 * np.sin(angle), JOINT.points[:, 1]], axis=-1)
    normals = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    sleeve = replace(JOINT, points=ring, pair_points=ring, normals=normals)
    plane = best_plane(sleeve)
    assert not plane.flat
    plot_pressure(sleeve, JOINT.preload_pressure, panel(), MM)


def without_contact(results):
    def quiet(case):
        zero = replace(
            case.reference,
            pressure=0 * case.reference.pressure,
            nodal_displacement=None
            if case.reference.nodal_displacement is None
            else 0 * case.reference.nodal_displacement,
        )
        return replace(case, reference=zero)

    interfaces = {
        name: replace(
            record,
            preload_pressure=0 * record.preload_pressure,
            stuck=np.zeros(len(record.pairs), dtype=bool),
        )
        for name, record in results.interfaces.items()
    }
    cases = {name: quiet(results.cases[name]) for name in ("LC1", "LC2-step")}
    return replace(results, interfaces=interfaces, cases=cases)


def bare(results):
    n = 0
    joint = replace(
        JOINT,
        points=np.empty((n, 3)),
        normals=np.empty((n, 3)),
        weights=np.empty(n),
        initial_gap=np.empty(n),
        slice=(0, 0),
        pairs=np.empty((n, 2), dtype=np.int64),
        pair_points=np.empty((n, 3)),
        averaging=np.empty((n, n)),
        faces=(),
        stuck=np.empty(n, dtype=bool),
        preload_pressure=np.empty(n),
    )
    case = results.cases["LC1"]
    empty = replace(case.reference, pressure=np.empty(0), gap=np.empty(0), bolt_forces={})
    return replace(
        results,
        interfaces={"joint": joint},
        bolts={},
        blocks=(),
        nodes=np.empty((0, 3)),
        body=np.empty(0, dtype=np.int64),
        cases={"LC1": replace(case, reference=empty, methods={}, components={})},
    )


@pytest.mark.long
@pytest.mark.parametrize("spoiled", [without_contact, bare])
def test_empty_and_zero_data_still_make_pictures(spoiled, tmp_path, coarse):
    for entry in album(spoiled(RESULTS), tmp_path):
        assert entry.path.is_file()


@pytest.mark.long
def test_dollar_signs_in_names_are_text(tmp_path, coarse):
    case = replace(RESULTS.cases["LC1"], name="a$b$")
    results = replace(RESULTS, title="$\\frac{$", cases={"a$b$": case})
    assert len(album(results, tmp_path)) > 4


@pytest.mark.long
def test_case_named_like_a_section_keeps_its_pictures_apart(tmp_path, coarse):
    case = replace(RESULTS.cases["LC1"], name="model", methods={})
    paths = [e.path for e in album(replace(RESULTS, cases={"model": case}), tmp_path)]
    assert len(set(paths)) == len(paths)


def test_real_model_is_drawn_with_bolt_and_boundary():
    model = faying.sources.lap_joint(element_size=5.0)
    figure = new_figure(5.0, 4.0)
    axes = plot_model(model, figure.add_subplot(projection="3d"))
    assert "tip" in {text.get_text().strip() for text in axes.texts}
    figure.canvas.draw()


def test_only_the_outside_is_drawn():
    axes = new_figure(4.0, 4.0).add_subplot(projection="3d")
    plot_bodies(RESULTS.nodes, RESULTS.blocks, RESULTS.body, axes)
    faces = axes.collections[0].get_facecolor()
    # Two bars, each with top and bottom of NX NY facets and a belt of 2 (NX + NY).
    assert len(faces) == 2 * (2 * NX * NY + 2 * (NX + NY))


def test_labels_of_axes_stay_on_the_page():
    """Of a flat, wide joint the label of its height hung over the right edge."""
    figure = new_figure(8.0, 4.0)
    axes = figure.add_subplot(projection="3d")
    frame(axes, np.array([[-60.0, -35.0, -9.0], [66.0, 35.0, 9.0]]))
    name_axes(axes, "mm")
    title_above(axes, "a fork")
    figure.draw_without_rendering()
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        label = axis.label.get_window_extent()
        assert figure.bbox.x0 <= label.x0
        assert label.x1 <= figure.bbox.x1


def test_captions_say_that_two_faces_lie_over_each_other():
    record = RESULTS.interfaces["joint"]
    turned = np.where(np.arange(len(record.normals))[:, None] % 2, -1, 1) * record.normals
    lower = record.pair_points - 0.5 * (np.arange(len(record.pairs))[:, None] % 2) * [0, 0, 1]
    pressure = record.preload_pressure
    said = summary("joint", replace(record, normals=turned, pair_points=lower), pressure, MM)
    assert said.startswith("joint, opposite faces, drawn over each other")
    assert summary("joint", record, pressure, MM).startswith("joint: max")


def test_peak_pressure_panel_keeps_to_the_reference():
    case = RESULTS.cases["LC2-step"]
    axes = plot_peak_pressure(case, panel(), MM)
    assert axes.get_ylim()[0] == 0.0
    assert axes.get_ylim()[1] < 2 * max(
        case.reference.pressure.max(), case.half_step.pressure.max()
    )


def test_tri6_interface_is_drawn():
    nodes = np.array([[0, 1, 2, 3, 4, 5]])
    corners = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0]])
    points = np.concatenate([corners, (corners + np.roll(corners, -1, axis=0)) / 2])
    record = replace(
        JOINT,
        points=points,
        pair_points=points,
        normals=np.tile([0.0, 0, 1], (6, 1)),
        weights=np.ones(6),
        pairs=np.stack([np.arange(6), np.arange(6, 12)], axis=-1),
        averaging=np.eye(6),
        faces=(FacePairs(kind="tri6", minus=nodes, plus=nodes + 6),),
        slice=(0, 6),
    )
    axes = plot_pressure(record, np.arange(6.0), panel(), MM)
    axes.figure.canvas.draw()
    assert len(axes.collections) > 1


def test_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FormatError, match=r"cannot write .*; check the folder"):
        album(RESULTS, tmp_path / "file" / "figures")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (number(10463.95), "10500"),
        (number(-0.0333), "−0.0333"),
        (number(2.5e-4), "2.50e-4"),
        (number(9.999), "10.0"),
        (number(0.0), "0"),
        (number(np.inf), "∞"),
        (percent(0.0423), "4.2 %"),
        (percent(4.07), "407 %"),
        (percent(-0.05), "−5.0 %"),
        (percent(1e-12), "< 1e-7 %"),
        (percent(0.0), "0 %"),
        (seconds(0.00123), "1.23 ms"),
        (seconds(75.2), "75.2 s"),
        (place(np.array([-52.0, 4.25, -1e-14]), "mm", 40.0), "(−52, 4.25, 0) mm"),
        (place(np.array([0.0521, 0.2, 0.0]), "m", 0.04), "(0.0521, 0.2, 0) m"),
        (units_of("mm-t-s").of("force/length³"), "N/mm³"),
        (units_of("m-kg-s").pressure, "Pa"),
        (units_of("in-lbm-h").pressure, "force/length²"),
    ],
)
def test_numbers_as_text(text, expected):
    assert text == expected


def test_file_names_stay_apart():
    names = file_names(["a/b", "a b", "A-B", "///", "jim-a+compliance"])
    assert list(names.values()) == ["a-b", "a-b-2", "A-B-3", "unnamed", "jim-a+compliance"]


def test_caption_of_the_preload_names_both_panels(entries):
    caption = next(entry.caption for entry in entries if entry.path.stem == "preload")
    assert all(side in caption for side in ("Left:", "Right: the node pairs"))


def test_titles_stand_above_bodies_and_names(coarse):
    # A cube fills the picture; its bolt sticks out of it.
    drawn = model_figure(
        replace(
            RESULTS,
            nodes=RESULTS.nodes / np.ptp(RESULTS.nodes, axis=0) * 10.0,
            bolts={
                name: replace(bolt, axis=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 10.0]]))
                for name, bolt in RESULTS.bolts.items()
            },
        )
    )
    drawn.figure.canvas.draw()
    axes = drawn.figure.axes[0]
    title = next(text for text in axes.texts if "solid elements" in text.get_text())
    bottom = title.get_window_extent().y0
    names = [text for text in axes.texts if text is not title]
    assert names
    for name in names:
        assert name.get_window_extent().y1 < bottom
    (bodies,) = (c for c in axes.collections if type(c).__name__ == "Poly3DCollection")
    drawn_bodies = bodies.get_transform().transform_path(bodies.get_paths()[0]).vertices
    assert drawn_bodies[:, 1].max() < bottom
    assert bottom < drawn.figure.bbox.y1


def test_wide_pictures_are_told_apart(entries):
    wide = {entry.path.stem for entry in entries if entry.wide}
    assert "preload" in wide
    assert not wide & {"model", "tightening"}


@pytest.mark.long
def test_titles_with_long_names_stay_in_the_picture(coarse):
    name = "Betriebslast Nr. 1: Zug und Biegung, ungünstig, kalt, nach 10 Jahren im Freien"
    static = replace(RESULTS.cases["LC1"], name=name)
    step = replace(RESULTS.cases["LC2-step"], name=name)
    for drawn in (
        model_figure(replace(RESULTS, title=name)),
        pressure_figure(RESULTS, static),
        response_figure(RESULTS, step),
    ):
        figure = drawn.figure
        figure.canvas.draw()
        titles = [*figure.texts, *(text for axes in figure.axes for text in axes.texts)]
        (title,) = (text for text in titles if "Betriebslast" in text.get_text())
        extent = title.get_window_extent()
        assert extent.x0 >= 0, drawn.stem
        assert extent.x1 <= figure.bbox.x1, drawn.stem
        assert extent.y1 <= figure.bbox.y1, drawn.stem


def test_measured_phases_lie_beside_the_computed_ones():
    """Not whole turns away, where a test begins behind the peak."""
    frequency, phase = np.linspace(1, 2, 50), np.radians(np.linspace(170, 370, 50))

    def curve(first):
        motion = np.exp(1j * phase[first:, None, None]) * [[0], [1]]
        return ResponseCurve(
            level=1.0, components=("tip.uz",), frequency=frequency[first:], harmonics=motion
        )

    record = SimpleNamespace(at="tip.uz", response=SimpleNamespace(linear=curve(0)))
    assert phases(curve(40), record) == pytest.approx(phase[40:], abs=1e-12)
