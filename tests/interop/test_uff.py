"""Frequency responses as data sets 58, read back by pyuff."""

from types import SimpleNamespace

import numpy as np
import pytest

from faying.assessment.response_curve import FrequencyResponse, ResponseCurve
from faying.exceptions import StudyError
from faying.export.uff import write
from faying.study.results.frequency_record import FrequencyRecord

pyuff = pytest.importorskip("pyuff")

FOLDED = np.array([10.0, 12.0, 11.0, 13.0])

NAMED = SimpleNamespace(name="joint")


def run(load):
    curve = ResponseCurve(
        level=2.0,
        components=("tip.ux", "tip.uz"),
        frequency=FOLDED,
        harmonics=np.arange(16).reshape(4, 2, 2) * (1 + 1j),
    )
    response = FrequencyResponse(load=load, curves=(curve,), linear=curve)
    record = FrequencyRecord(at="tip.uz", response=response)
    return SimpleNamespace(frequencies={"shaker": record})


def test_sweeps_are_displacement_over_force(tmp_path):
    (path,) = write(NAMED, tmp_path / "frf.uff", run({"tip.Fz": 5.0}))
    sets = pyuff.UFF(str(path)).read_sets()
    assert [one["id1"][-8:] for one in sets] == ["sweep up"] * 2 + ["eep down"] * 2
    along = sets[1]
    np.testing.assert_allclose(along["x"], [10.0, 12.0, 13.0], rtol=1e-6)
    # Ascii sets have seven digits and more.
    np.testing.assert_allclose(along["data"], np.array([3, 7, 15]) * (1 + 1j) / 10, rtol=1e-6)
    assert (along["func_type"], along["rsp_dir"], along["ref_dir"]) == (4, 3, 3)


def test_several_loads_have_no_one_force_to_divide_by(tmp_path):
    (path,) = write(NAMED, tmp_path / "frf.uff", run({"tip.Fz": 5.0, "tip.Fy": 1j}))
    first = pyuff.UFF(str(path)).read_sets(0)
    assert first["func_type"] == 0
    np.testing.assert_allclose(first["data"], np.array([2, 6, 14]) * (1 + 1j), rtol=1e-6)


def test_a_run_without_harmonic_loads_is_refused(tmp_path):
    with pytest.raises(StudyError, match="has no responses to harmonic loads"):
        write(NAMED, tmp_path / "frf.uff", SimpleNamespace(frequencies={}))
