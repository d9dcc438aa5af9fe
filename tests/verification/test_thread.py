"""Stress in threads: by hand, and what is refused."""

import numpy as np
import pytest

import faying as fy
from faying.assessment.strength.thread import thread_stress
from faying.exceptions import ModelError

FORCES = np.array([18e3, 30e3, 25e3])


@pytest.mark.parametrize(
    ("diameter", "pitch", "area"), [(6.0, 1.0, 20.1), (10.0, 1.5, 58.0), (16.0, 2.0, 157.0)]
)
def test_stress_areas_are_those_that_standards_list(diameter, pitch, area):
    thread = fy.Thread(diameter=diameter, pitch=pitch, grade="8.8")
    assert thread.stress_area == pytest.approx(area, rel=3e-3)  # listed to three digits


def test_stress_without_friction_is_axial():
    thread = fy.Thread(diameter=10.0, pitch=1.5, grade="10.9")
    found = thread_stress(thread, 20e3, FORCES, None, "mm-t-s")
    assert found.reduced == found.axial == 30e3 / thread.stress_area
    assert found.amplitude == pytest.approx(6e3 / thread.stress_area, rel=1e-15)
    assert found.proof == pytest.approx(900.0, rel=1e-15)
    assert found.safety == pytest.approx(900.0 / found.axial, rel=1e-15)


def test_bending_adds_to_the_outer_fibre_at_the_instant_where_both_are_worst():
    thread = fy.Thread(diameter=10.0, pitch=1.5, grade="8.8", friction=0.1)
    moments = np.zeros((3, 2, 2))
    moments[2, 1] = [6e3, 8e3]  # 10 N m at the far end, in another plane than the axes
    found = thread_stress(thread, 20e3, FORCES, moments, "mm-t-s")
    area, modulus = np.pi / 4 * thread.stress_diameter**2, np.pi / 32 * thread.stress_diameter**3
    assert found.axial == pytest.approx(25e3 / area, rel=1e-15)
    assert found.bending == pytest.approx(1e4 / modulus, rel=1e-15)
    outer = np.hypot(found.axial + found.bending, np.sqrt(3) * 0.5 * found.torsion)
    assert found.reduced == pytest.approx(outer, rel=1e-15)
    assert found.safety == pytest.approx(640.0 / outer, rel=1e-15)
    # From 18 kN alone to 25 kN with all of the moment; 5 degrees apart lose 0.1 % of the latter.
    assert found.amplitude == pytest.approx((7e3 / area + 1e4 / modulus) / 2, rel=1e-3)


def test_units_change_nothing():
    thread = fy.Thread(diameter=10.0, pitch=1.5, grade="8.8", friction=0.1)
    metres = fy.Thread(diameter=0.01, pitch=0.0015, grade="8.8", friction=0.1)
    one = thread_stress(thread, 20e3, FORCES, None, "mm-t-s")
    other = thread_stress(metres, 20e3, FORCES, None, "m-kg-s")
    assert other.safety == pytest.approx(one.safety, rel=1e-12)
    assert other.proof == pytest.approx(640e6, rel=1e-12)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"pitch": 6.0}, "has the pitch 6"),
        ({"grade": "A9-70"}, "grade 'A9-70' is none"),
        ({"grade": "8.0"}, "grade '8.0' is none"),
    ],
)
def test_bad_threads_are_refused(keys, message):
    with pytest.raises(ModelError, match=message):
        fy.Thread(**{"diameter": 10.0, "pitch": 1.5, "grade": "8.8", **keys})


def test_unknown_units_and_bolts_are_refused():
    thread = fy.Thread(diameter=10.0, pitch=1.5, grade="8.8")
    with pytest.raises(ModelError, match="in furlong-stone-s is not known"):
        thread_stress(thread, 1.0, FORCES, None, "furlong-stone-s")
    joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    with pytest.raises(ModelError, match="threads: there is no bolt 'M8'; the bolts are bolt"):
        fy.assess(joint, [fy.Load({"tip.Fz": -1.0})], paths=False, threads={"M8": thread})
