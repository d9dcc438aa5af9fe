"""Stress in threads: by hand, and what is refused."""

import pytest

import faying as fy
from faying.assessment.thread import thread_stress
from faying.exceptions import ModelError


@pytest.mark.parametrize(
    ("diameter", "pitch", "area"), [(6.0, 1.0, 20.1), (10.0, 1.5, 58.0), (16.0, 2.0, 157.0)]
)
def test_stress_areas_are_those_that_standards_list(diameter, pitch, area):
    thread = fy.Thread(diameter=diameter, pitch=pitch, grade="8.8")
    assert thread.stress_area == pytest.approx(area, rel=3e-3)  # listed to three digits


def test_stress_without_friction_is_axial():
    thread = fy.Thread(diameter=10.0, pitch=1.5, grade="10.9")
    found = thread_stress(thread, 20e3, 18e3, 30e3, "mm-t-s")
    assert found.reduced == found.axial == 30e3 / thread.stress_area
    assert found.amplitude == pytest.approx(6e3 / thread.stress_area, rel=1e-15)
    assert found.proof == pytest.approx(900.0, rel=1e-15)
    assert found.safety == pytest.approx(900.0 / found.axial, rel=1e-15)


def test_units_change_nothing():
    thread = fy.Thread(diameter=10.0, pitch=1.5, grade="8.8", friction=0.1)
    metres = fy.Thread(diameter=0.01, pitch=0.0015, grade="8.8", friction=0.1)
    one = thread_stress(thread, 20e3, 18e3, 30e3, "mm-t-s")
    other = thread_stress(metres, 20e3, 18e3, 30e3, "m-kg-s")
    assert other.safety == pytest.approx(one.safety, rel=1e-12)
    assert other.proof == pytest.approx(640e6, rel=1e-12)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"pitch": 6.0}, "has the pitch 6"),
        ({"grade": "A2-70"}, "grade 'A2-70' is none"),
        ({"grade": "8.0"}, "grade '8.0' is none"),
    ],
)
def test_bad_threads_are_refused(keys, message):
    with pytest.raises(ModelError, match=message):
        fy.Thread(**{"diameter": 10.0, "pitch": 1.5, "grade": "8.8", **keys})


def test_unknown_units_and_bolts_are_refused():
    thread = fy.Thread(diameter=10.0, pitch=1.5, grade="8.8")
    with pytest.raises(ModelError, match="in furlong-stone-s is not known"):
        thread_stress(thread, 1.0, 1.0, 1.0, "furlong-stone-s")
    joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    with pytest.raises(ModelError, match="threads: there is no bolt 'M8'; there are bolt"):
        fy.assess(joint, [fy.Load({"tip.Fz": -1.0})], paths=False, threads={"M8": thread})
