"""Bolts as engineers name them: sizes, grades, torques and utilisation against listed figures."""

import numpy as np
import pytest

import faying as fy
from faying.assessment.strength.grades import BoltStrength, strength_of
from faying.assessment.strength.sizes import size_named
from faying.assessment.strength.tightening import (
    PreloadRange,
    force_of_torque,
    force_of_utilisation,
    variation_of,
)
from faying.exceptions import ModelError, StudyError
from faying.study.keys.schema import parse_study
from faying.study.keys.threads import StudyBolts
from small_study import SMALL_JOINT


@pytest.mark.parametrize(
    ("name", "area"),
    [("M6", 20.1), ("M8", 36.6), ("M8x1", 39.2), ("M8 × 1", 39.2), ("M12", 84.3), ("M24", 353.0)],
)
def test_stress_areas_of_sizes(name, area):
    # ISO 898-1 lists three digits
    assert fy.Thread.named(name, "8.8").stress_area == pytest.approx(area, rel=3e-3)


@pytest.mark.parametrize(
    ("name", "area"),
    [("1/4-20 UNC", 0.0318), ("3/8-24 UNF", 0.0878), ("1-8 UNC", 0.606), ("#10-32 UNF", 0.0200)],
)
def test_stress_areas_of_inch_sizes(name, area):
    thread = fy.Thread.named(name, "SAE 5", "in-slinch-s")
    assert thread.stress_area == pytest.approx(area, rel=3e-3)  # ASME B1.1 lists three digits


def test_units_of_sizes_and_strengths():
    one, other = fy.Thread.named("M10", "8.8"), fy.Thread.named("M10", "8.8", "m-kg-s")
    assert other.diameter == pytest.approx(one.diameter / 1000, rel=1e-15)
    assert other.strengths("m-kg-s").yields == pytest.approx(640e6, rel=1e-15)
    assert strength_of("SAE 8", "in-slinch-s").proof == pytest.approx(120e3, rel=1e-5)  # MASSES
    assert strength_of("A2-70", "mm-t-s").ultimate == pytest.approx(700.0, rel=1e-15)
    assert strength_of("10.9", "mm-t-s").proof == pytest.approx(830.0, rel=1e-15)


@pytest.mark.parametrize("name", ["8", "M7", "M8-1", "3/8", "UNF"])
def test_sizes_that_are_none_are_refused(name):
    with pytest.raises(ModelError, match=r"no size is called|is not listed"):
        size_named(name)


def test_strengths_that_are_out_of_order_are_refused():
    with pytest.raises(ModelError, match="each at least the one before"):
        BoltStrength(proof=600.0, yields=580.0, ultimate=800.0)


@pytest.mark.parametrize(
    ("size", "force"), [("M6", 9.4e3), ("M8", 17.2e3), ("M10", 27.3e3), ("M12", 39.6e3)]
)
def test_utilisation_gives_the_preloads_that_are_widely_quoted(size, force):
    # 90 % of the yield stress at mu_G = 0.12, grade 8.8; tables round diameters
    thread = fy.Thread.named(size, "8.8", friction=0.12)
    assert force_of_utilisation(thread, 0.9, "mm-t-s") == pytest.approx(force, rel=1e-2)


SCATTERED = """preload_scatter = { thread_friction = [0.1, 0.14], head_friction = [0.1, 0.14] }
[model]
source = "lap-joint"

[[bolt]]
name = "bolt"
size = "M6"
grade = "8.8"
thread_friction = 0.12
head_friction = 0.12
tightening_factor = 1.6
"""


def test_utilisation_is_that_of_the_largest_preload_and_friction_widens_its_range(tmp_path):
    study = parse_study(SCATTERED + "utilisation = 0.9\n", tmp_path / "joint.toml")
    thread, spread = (
        StudyBolts.of(study).threads["bolt"],
        StudyBolts.of(study).strengths.ranges["bolt"],
    )
    (nominal,) = StudyBolts.of(study).forces.values()
    most = force_of_utilisation(thread, 0.9, "mm-t-s")
    gamma = 0.6 / 2.6
    assert (1 + gamma) * nominal == pytest.approx(most, rel=1e-14)
    # One torque, at the ends of both coefficients of friction
    meant, slippery, rough = (float(thread.torque_per_force(mu, mu)) for mu in (0.12, 0.10, 0.14))
    assert spread.most(1.0) == pytest.approx((1 + gamma) * meant / slippery, rel=1e-14)
    assert spread.least(1.0) == pytest.approx((1 - gamma) * meant / rough, rel=1e-14)


def test_torque_agrees_with_the_widely_quoted_sum():
    thread = fy.Thread.named("M10", "8.8", friction=0.12, head_friction=0.1)
    d_k = (14.63 + 11.0) / 2
    ratio = 0.16 * 1.5 + 0.58 * thread.pitch_diameter * 0.12 + d_k / 2 * 0.1
    # 0.16 and 0.58 are 1/2π and 1.155/2, to two digits
    assert force_of_torque(thread, 40e3) == pytest.approx(40e3 / ratio, rel=5e-3)


def test_scatter_of_a_tightening_factor_is_that_of_gamma():
    scatter = PreloadRange(variation=variation_of(1.6))
    assert scatter.most(10.0) / scatter.least(10.0) == pytest.approx(1.6, rel=1e-14)
    assert (scatter.most(10.0) + scatter.least(10.0)) / 2 == pytest.approx(10.0, rel=1e-14)


AXIS = "axis = [[0.0, 0.0, 0.0], [0.0, 0.0, 30.0]]"
MESH = """
units = "mm-t-s"
[model]
source = "mesh"
file = "joint.msh"
[[interface]]
name = "joint"
[[bolt]]
name = "b"
KEYS
[[support]]
set = "clamp"
"""


def study(folder, keys):
    (folder / "joint.msh").write_text("")
    return parse_study(MESH.replace("KEYS", keys), folder / "joint.toml")


def test_a_size_brings_measures_and_torque_a_preload(tmp_path):
    keys = f'{AXIS}\nsize = "M8"\ngrade = "8.8"\ntorque = 20e3\n'
    found = study(tmp_path, keys + "thread_friction = 0.12\nhead_friction = 0.12")
    thread = StudyBolts.of(found).threads["b"]
    assert (thread.diameter, thread.pitch) == pytest.approx((8.0, 1.25), rel=1e-14)
    assert thread.bearing == pytest.approx((11.63, 9.0), rel=1e-14)
    force = StudyBolts.of(found).forces["b"]
    torque = thread.torque_per_force(np.array([0.12]), np.array([0.12]))[0] * force
    assert torque == pytest.approx(20e3, rel=1e-14)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ('size = "M8"\ngrade = "8.9.1"\npreload = 1.0', "grade '8.9.1' is none"),
        ('size = "M7"\ngrade = "8.8"\npreload = 1.0', "add it, as in 'M7x1'"),
        ('size = "M8"\npreload = 1.0\ntorque = 2.0', "found 'preload', 'torque', which each give"),
        ('size = "M8"\nutilisation = 0.9', "it needs the bolt's size and grade"),
        ('size = "M8"\ngrade = "8.8"\nutilisation = 0.9', "give thread_friction"),
        ('size = "M8"\ngrade = "8.8"\ntorque = 9.0', "give thread_friction and head_friction"),
        ('size = "M8"\ngrade = "8.8"\nhole = 20.0\npreload = 1.0', "bears on nothing"),
        ('size = "3/8-24 UNF"\npreload = 1.0', "needs 'washer_radius'; add it"),
        ('head = "ISO 4762"\npreload = 1.0', "it needs a size"),
        (
            'size = "3/8-24 UNF"\ngrade = "SAE 5"\nwasher_radius = 9.0\npreload = 1.0\n'
            "head_pressure_limit = 9.0",
            "the area under the head is unknown",
        ),
        ("preload = 1.0", "needs 'diameter' and 'washer_radius'; add it"),
        (
            'size = "M8"\ngamma = 0.1\ntightening_factor = 1.2\npreload = 1.0',
            "the scatter of its preload",
        ),
    ],
)
def test_bolts_that_make_no_sense_are_refused(tmp_path, keys, message):
    with pytest.raises(StudyError, match=message):
        study(tmp_path, f"{AXIS}\n{keys}")


def test_a_bolt_of_a_source_takes_size_and_strength(tmp_path):
    keys = '5e3\nsize = "M6"\nstrength = { proof = 580.0, yield = 640.0, ultimate = 800.0 }\n'
    text = SMALL_JOINT.replace("5e3\n", keys, 1)
    found = parse_study(text, tmp_path / "joint.toml")
    assert StudyBolts.of(found).threads["bolt"].strengths("mm-t-s").yields == 640.0


@pytest.mark.parametrize(
    ("head", "outer"), [("ISO 4014", 11.63), ("ISO 4762", 12.33), ("ISO 7089", 16.0)]
)
def test_heads_and_washers_press_on_their_faces(tmp_path, head, outer):
    text = f'{AXIS}\nsize = "M8"\ngrade = "8.8"\npreload = 1.0\nhead = "{head}"'
    thread = StudyBolts.of(study(tmp_path, text)).threads["b"]
    assert thread.bearing == pytest.approx((outer, 9.0), rel=1e-14)
    face = 12.33 if head == "ISO 4762" else 11.63  # the head rubs on its washer
    assert thread.head_diameter == pytest.approx((face + 9.0) / 2, rel=1e-14)


def test_heads_that_are_none_are_refused():
    with pytest.raises(ModelError, match="head 'DIN 912' is not known"):
        size_named("M8", "DIN 912")
    with pytest.raises(ModelError, match="lists no face of 'M45'"):
        size_named("M45", "ISO 4762")
