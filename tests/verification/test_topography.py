"""Gaps from scans: a sphere's cap against Hertz, waves, holes, turns and tilts."""

from dataclasses import replace

import numpy as np
import pytest
from hertz import PointContact, effective_modulus
from pressed_blocks import graded, pressed_blocks
from pressed_layers import STEEL

import faying as fy
from faying.exceptions import FormatError, ModelError
from faying.interface.surface_scan import Scan, read_scan
from faying.interface.topography import ScanPlacement, topography

MODULUS = effective_modulus(*[(STEEL.youngs_modulus, STEEL.poissons_ratio)] * 2)
HERTZ = PointContact(load=1000 * np.pi / 3, radius=2 * MODULUS / (500 * np.pi), modulus=MODULUS)
JOINT = fy.lap_joint(element_size=2.5, hole_radius=0.0).interfaces["joint"]
ON_GAP = ScanPlacement(of="gap", origin=(0.0, 0.0, 0.0), along=(1.0, 0.0, 0.0))
X, Y = (grid.ravel() for grid in np.meshgrid(np.linspace(-25, 25, 401), np.linspace(-12, 12, 193)))


def scan_of(values, *, is_gap=True, keep=slice(None)):
    return Scan(places=np.column_stack([X, Y])[keep], values=values[keep], is_gap=is_gap)


def gap_of(values, placement=ON_GAP, **options):
    return topography(JOINT, [(scan_of(values, **options), placement)])[0]


@pytest.mark.long
def test_a_scanned_cap_presses_as_hertz(tmp_path):
    """The scan of a sphere in micrometres, of the plus side, turned and tilted."""
    lines = graded(1 / 4, 1.25, 10.0, growth=1.5)
    blocks = pressed_blocks(lines, lines, lines, penalty="hard")
    axis = np.linspace(-12.0, 12.0, 241)
    x, y = (grid.ravel() for grid in np.meshgrid(axis, axis))
    heights = -(x**2 + y**2) / (2 * HERTZ.radius) + 1e-4 * x
    np.savez(tmp_path / "cap.npz", x=axis, y=axis, z=1e3 * heights.reshape(241, 241))
    turned = ScanPlacement(
        of="plus", origin=(0, 0, 0), along=(0.6, 0.8, 0.0), tilt="keep", scale=1e-3
    )
    (face,) = blocks.model.interfaces.values()
    found, _ = topography(face, [(read_scan(tmp_path / "cap.npz"), turned)])
    along = face.points @ [0.6, 0.8, 0.0]
    gap = (face.points[:, 0] ** 2 + face.points[:, 1] ** 2) / (2 * HERTZ.radius)
    # A cap is its own form: nothing of it is filtered.
    np.testing.assert_allclose(found, gap - 1e-4 * along, atol=1e-9)
    flat = replace(turned, tilt="keep")
    level = Scan(places=np.column_stack([x, y]), values=1e3 * (heights - 1e-4 * x))
    joint = blocks.model.with_initial_gap(face.name, topography(face, [(level, flat)])[0])
    solution = type(blocks)(joint).pressed(HERTZ.load / 2)
    # As from the formula itself (tests/verification/test_hertz_sphere.py).
    assert solution.max_pressure == pytest.approx(HERTZ.peak_pressure, rel=1e-2)


@pytest.mark.parametrize(("wavelength", "left"), [(5.0, 0.5), (50.0, 0.9931), (2.5, 0.0625)])
def test_waves_are_kept_as_the_standard_says(wavelength, left):
    """exp(−π (α λ_c/λ)²) of waves at the cut-off of 5, ten times as long, and half as long."""
    placement = replace(ON_GAP, tilt="keep", wavelength=5.0)
    wave = 1e-3 * np.cos(2 * np.pi * X / wavelength)
    inner = np.abs(JOINT.points[:, 0]) < 15.0
    found = gap_of(wave, placement)[inner]
    expected = left * 1e-3 * np.cos(2 * np.pi * JOINT.points[inner, 0] / wavelength)
    # Cells of a sixteenth of the cut-off, of which samples are means, and the ends of the scan.
    np.testing.assert_allclose(found, expected, atol=2e-5)


def test_tilt_is_removed_and_the_sides_touch():
    bowl = 1e-4 * (X**2 + Y**2)
    tilted = gap_of(bowl + 0.3 + 2e-3 * X - 1e-3 * Y)
    assert tilted.min() == 0.0
    np.testing.assert_allclose(tilted, gap_of(bowl), atol=1e-12)


def test_sides_are_seen_from_their_outside():
    """The same bump on both sides, each scan's y as seen by who looks at it."""
    bump = np.exp(-((X - 3) ** 2 + (Y - 2) ** 2) / 50)
    mirrored = np.exp(-((X - 3) ** 2 + (Y + 2) ** 2) / 50)
    minus, plus = (replace(ON_GAP, of=side, tilt="keep") for side in ("minus", "plus"))
    scan, other = scan_of(bump, is_gap=False), scan_of(mirrored, is_gap=False)
    one = topography(JOINT, [(scan, minus)])[0]
    # The grid of the filter lies otherwise; the bump is 1 high.
    np.testing.assert_allclose(one, topography(JOINT, [(other, plus)])[0], atol=3e-4)
    both = topography(JOINT, [(scan, minus), (other, plus)])[0]
    np.testing.assert_allclose(both, 2 * one, atol=6e-4)


def test_holes_are_left_out_and_said():
    field = 1e-4 * X**2
    near = np.hypot(X - 5, Y) > 2.0
    placement = replace(ON_GAP, wavelength=1.5)
    found, (note,) = topography(JOINT, [(scan_of(field, keep=near), placement)])
    np.testing.assert_allclose(found, gap_of(field, placement), atol=1e-6)
    assert "of the area in holes has its form alone" in note


def test_a_scan_beside_the_interface_is_refused():
    aside = replace(ON_GAP, origin=(40.0, 0.0, 0.0))
    with pytest.raises(ModelError, match=r"of its area lies off the samples.*check origin, along"):
        gap_of(X, aside)
    with pytest.raises(ModelError, match="points across the interface"):
        gap_of(X, replace(ON_GAP, along=(0.0, 0.0, 1.0)))
    with pytest.raises(ModelError, match="the scan holds heights of a side, and is of 'gap'"):
        gap_of(X, is_gap=False)


def test_scans_are_read_from_csv_and_xyz(tmp_path):
    rows = [(x, y, x * y) for x in range(4) for y in range(4)]
    text = "\n".join(f"{x},{y},{z}" for x, y, z in rows)
    (tmp_path / "a.csv").write_text(f"x,y,gap\n{text}\n9,9,\n")
    found = read_scan(tmp_path / "a.csv")
    assert (found.is_gap, found.holes, len(found.values)) == (True, 1, 16)
    (tmp_path / "a.xyz").write_text(text.replace(",", " ") + "\n5 5 No Data\n")
    again = read_scan(tmp_path / "a.xyz")
    assert (again.is_gap, again.holes) == (False, 1)
    np.testing.assert_array_equal(again.values, found.values)
    (tmp_path / "b.csv").write_text("x,y,height\n1,2,3\n")
    with pytest.raises(FormatError, match="a scan has x, y and z"):
        read_scan(tmp_path / "b.csv")


def test_a_filter_that_takes_more_than_the_memory_is_refused(monkeypatch):
    """Waves of half a millimetre over 50: five million cells."""
    monkeypatch.setenv("FAYING_MEMORY", "1e6")
    short = replace(ON_GAP, wavelength=0.5)
    with pytest.raises(ModelError, match=r"cut-off of 0.5 take .* give a longer wavelength"):
        gap_of(np.zeros(X.size), short)
