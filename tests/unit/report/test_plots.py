"""Quick looks in one call: axes with units, and the numbers of the solution on them."""

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.colors import to_hex

import faying as fy
from faying.assessment.backbone import Backbone
from faying.exceptions import ModelError


@pytest.fixture(autouse=True)
def closed(monkeypatch):
    pyplot.switch_backend("agg")
    yield
    pyplot.close("all")


@pytest.fixture(scope="module")
def static(joint):
    return fy.solve_static(joint, fy.Load({"tip.Fz": -500.0}, name="LC1"))


@pytest.fixture(scope="module")
def moving(joint, classic):
    rom = fy.reduce(joint, classic)
    return fy.solve_transient(rom, fy.Load({"tip.Fz": -500.0}), step=1e-5, duration=3e-5)


def test_static_solution_is_a_map_of_its_points(joint, static):
    axes = static.plot()
    (squares,) = axes.collections
    assert np.array_equal(squares.get_array(), static.pressure)
    interface = joint.interfaces["joint"]
    paths = [path.vertices[:4] for path in squares.get_paths()]
    assert np.allclose([path.mean(axis=0) for path in paths], interface.points[:, :2])
    sides = [np.ptp(path, axis=0) for path in paths]
    assert np.allclose(np.prod(sides, axis=1), interface.weights)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [mm]", "y [mm]")
    labels = {one.get_xlabel() for one in axes.figure.axes}
    assert "contact pressure [MPa]" in labels
    axes.figure.canvas.draw()


def test_given_axes_are_drawn_on(static):
    _, mine = pyplot.subplots()
    assert static.plot(mine, quantity="gap", interface="joint") is mine
    assert np.array_equal(mine.collections[0].get_array(), static.gap)


def test_transient_is_a_line_and_each_instant_a_map(moving):
    axes = moving.plot()
    (line,) = axes.get_lines()
    assert np.array_equal(line.get_xdata(), moving.times)
    assert np.array_equal(line.get_ydata(), moving.max_pressure)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time [s]", "largest contact pressure [MPa]")
    squares = moving.plot(at=-1).collections[0]
    assert np.array_equal(squares.get_array(), moving.pressure[-1])


def test_what_cannot_be_drawn_is_named(static, moving):
    with pytest.raises(ModelError, match="no picture 'stress'; the pictures are pressure, ga"):
        static.plot(quantity="stress")
    with pytest.raises(ModelError, match="no interface 'flange'; the interfaces are joint"):
        static.plot(interface="flange")
    with pytest.raises(ModelError, match="no state 4; there are 4, counted from 0"):
        moving.plot(at=4)


def test_model_is_drawn_with_its_parts(joint):
    axes = joint.plot()
    assert axes.name == "3d"
    shown = {text.get_text() for text in axes.get_legend().get_texts()}
    assert {"interface edges", "boundaries", "supports"} <= shown
    assert axes.get_xlabel() == "x [mm]"


def test_backbone_has_damping_left_and_frequency_right():
    n = np.array([1.0, 10.0])
    found = Backbone(
        mode=2, small_frequency=120.0, measured_at="tip.rx", amplitude=n, load=n,
        modal_amplitude=n, frequency=120.0 / n, damping_ratio=n / 100, friction_damping=n,
        linear_damping=n, energy_per_cycle=n, loop_area=n, stick_share=n, macroslip=n > 5,
        cycles=n.astype(int), stationary=n > 0, loop_load=n[:, None], loop_modal=n[:, None],
    )  # fmt: skip
    left = found.plot()
    right = next(one for one in left.figure.axes if one is not left)
    assert np.array_equal(left.get_lines()[0].get_ydata(), [1.0, 10.0])
    assert np.array_equal(right.get_lines()[0].get_ydata(), [120.0, 12.0])
    assert to_hex(left.get_lines()[0].get_color()) != to_hex(right.get_lines()[0].get_color())
    assert left.get_xlabel() == "amplitude at tip.rx [rad]"
    assert right.get_ylabel() == "frequency [Hz]"
    assert "amplitudes: 1 to 10 rad" in repr(found)
    assert "damping ratios: 1 to 10 %" in repr(found)
