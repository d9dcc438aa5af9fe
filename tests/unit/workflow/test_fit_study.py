"""Parameters of a study: found from synthetic data, spread to bands, or refused."""

import json

import numpy as np
import pytest

from faying.assessment.modal_analysis import backbone
from faying.exceptions import StudyError
from faying.reduction.craig_bampton import craig_bampton
from faying.reduction.projection import projected
from faying.study.keys.schema import parse_study
from faying.study.stages.offline import prepare_joint
from faying.study.stages.path_cases import rest_state
from faying.study.stages.varied import varied_joint, with_values
from faying.workflow.fit import band_of_study, fit_study
from small_study import TINY_JOINT

STUDY = (
    "friction_during_preload = false\n"
    + TINY_JOINT
    + """
[[interface]]
name = "joint"
friction = 0.3
tangential_penalty = 1e5

[[interface.crown]]
origin = [0.0, 0.0, 0.0]
along = [1.0, 0.0, 0.0]
distance = 20.0
height = 0.002

[damping]
alpha = 5.0

[reduction]
normal_modes = 6

[[parameter]]
name = "friction"
keys = ["interface.joint.friction"]
range = [0.1, 0.5]

[[parameter]]
name = "linear damping"
keys = ["damping.alpha"]
range = [1.0, 20.0]

[[measurement]]
name = "hammer"
load_case = "ring"
mode = 1
file = "hammer.csv"
frequency_scatter = 1e-4
damping_scatter = 0.03

[[load_case]]
name = "ring"
kind = "backbone"
modes = [1]
amplitude_range = [0.05, 0.4, 3]
increments = 4
"""
)


@pytest.fixture
def study(tmp_path):
    def call(old="", new="", rows="amplitude,frequency,damping\n0.1,600,0.01\n"):
        assert old in STUDY
        (tmp_path / "hammer.csv").write_text(rows)
        return parse_study(STUDY.replace(old, new), tmp_path / "ring.toml")

    return call


def test_values_reach_all_their_keys_and_nothing_else(study):
    keys = 'keys = ["interface.joint.friction", "interface.joint.crown.1.height"]'
    read = study('keys = ["interface.joint.friction"]', keys)
    other = with_values(read, {"friction": 0.2})
    assert other.interfaces[0].friction == other.interfaces[0].crown[0].height == 0.2
    assert (other.damping.alpha, read.interfaces[0].friction) == (5.0, 0.3)


@pytest.mark.long
def test_one_reduced_model_serves_all_values(study):
    keys = {
        "stiffness": ("interface.joint.tangential_penalty", 5e4),
        "preload": ("bolt.bolt.preload", 4e3),
        "crown": ("interface.joint.crown.1.height", 0.004),
        "shim": ("interface.joint.initial_gap", 0.001),
    }
    more = "".join(
        f'[[parameter]]\nname = "{name}"\nkeys = ["{key}"]\nrange = [{value / 3}, {value * 2}]\n'
        for name, (key, value) in keys.items()
    )
    values = {"friction": 0.15, "linear damping": 8.0}
    values |= {name: value for name, (_, value) in keys.items()}
    varied = study("[[measurement]]", f"{more}[[measurement]]")
    shared = varied_joint(varied).curves(values)["ring", 1]
    read = with_values(varied, values)
    joint = prepare_joint(read)
    rom = projected(joint.model, craig_bampton(joint.model, normal_modes=6), compliance=True)
    rest = rest_state(rom, joint.preload_path)
    alone = backbone(rom, 1, read.load_cases[0].levels, initial=rest, increments=16)
    # The full model was tightened here, which its reduction is exact to 1e-10 for.
    np.testing.assert_allclose(shared.frequency, alone.frequency, rtol=1e-8)
    np.testing.assert_allclose(shared.damping_ratio, alone.damping_ratio, rtol=1e-6)


@pytest.mark.long
def test_synthetic_data_are_recovered_within_their_intervals(study, tmp_path):
    truth = {"friction": 0.2, "linear damping": 4.0}
    curve = varied_joint(study()).curves(truth)["ring", 1]
    noise = np.random.default_rng(4).standard_normal((2, 3))
    columns = (
        curve.amplitude,
        curve.frequency * (1 + 1e-4 * noise[0]),
        curve.damping_ratio * (1 + 0.03 * noise[1]),
    )
    table = "\n".join(",".join(map(repr, map(float, row))) for row in zip(*columns, strict=True))
    read = study(rows=f"amplitude,frequency,damping\n{table}\n")
    found = fit_study(read, tmp_path / "fit")
    for name, value in truth.items():
        low, high = found.intervals[name]
        assert low < value < high
        assert high / low < 5  # and the intervals say something: ranges are 5 and 20 wide
    told = json.loads((tmp_path / "fit" / "fit.json").read_text())
    assert told["parameters"]["friction"]["value"] == found.values["friction"]
    assert (tmp_path / "fit" / "fit_hammer.csv").read_text().startswith("amplitude,frequency,")


@pytest.mark.long
def test_a_band_holds_its_samples_and_goes_on_where_it_stopped(study, tmp_path, monkeypatch):
    read = study()
    bands = band_of_study(read, tmp_path / "band")
    (band,) = bands.values()
    assert (band.damping_low < band.damping_high).all()
    told = json.loads((tmp_path / "band" / "band.json").read_text())
    assert (told["design"], len(told["samples"])) == ("corners", 5)
    # Corner 3 of the design fails once; what was computed before it is not computed again.
    import faying.study.stages.varied as varied

    joint, computed = varied.VariedJoint, []

    def stopped(self, values):
        computed.append(values)
        if len(computed) == 3:
            raise KeyboardInterrupt
        return curves(self, values)

    curves = joint.curves
    monkeypatch.setattr(joint, "curves", stopped)
    with pytest.raises(KeyboardInterrupt):
        band_of_study(read, tmp_path / "again")
    (resumed,) = band_of_study(read, tmp_path / "again").values()
    assert len(computed) == 6  # the third one twice
    np.testing.assert_array_equal(resumed.damping_high, band.damping_high)


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("interface.joint.friction", "interface.jiont.friction", "did you mean 'joint'"),
        ("interface.joint.friction", "material.STEEL.E", "changes the structure"),
        ("interface.joint.friction", "interface.joint.fricton", "did you mean 'friction'"),
        ("interface.joint.friction", "interface.joint.crown.2.height", "has no table"),
        ("interface.joint.friction", "damping.alpha", "belongs to parameter 'friction' already"),
        ("[0.1, 0.5]", "[0.5, 0.1]", "the smaller number first"),
        ("[0.1, 0.5]", "[0.0, 0.5]", "start above 0"),
        ('"linear damping"', '"friction"', "two parameters are called"),
    ],
)
def test_what_is_wrong_is_said(study, old, new, match):
    with pytest.raises(StudyError, match=match):
        study(old, new)
