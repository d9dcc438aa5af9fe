"""Parameters from measured backbones: exact where curves are formulas, named where they are not."""

from types import SimpleNamespace

import numpy as np
import pytest

from faying.assessment.identification import identify
from faying.assessment.measured_curve import MeasuredCurve
from faying.assessment.parameter import Parameter
from faying.exceptions import ModelError

AMPLITUDE = np.geomspace(0.01, 1.0, 9)


def curve(a, b):
    """A backbone whose frequency tells a and whose damping tells b."""
    frequency = 100.0 * a * AMPLITUDE**-0.02
    return SimpleNamespace(
        amplitude=AMPLITUDE, frequency=frequency, damping_ratio=1e-3 * b * AMPLITUDE**0.5
    )


def compute(trials):
    return [{"test": curve(trial["a"], trial["b"])} for trial in trials]


def measured(seed=0, scatter=0.01, **changed):
    noise = np.exp(scatter * np.random.default_rng(seed).standard_normal((2, 7)))
    truth = curve(1.1, 2.0)
    columns = {
        "amplitude": AMPLITUDE[1:-1],
        "frequency": truth.frequency[1:-1] * noise[0],
        "damping_ratio": truth.damping_ratio[1:-1] * noise[1],
        "frequency_scatter": scatter,
        "damping_scatter": scatter,
    }
    return MeasuredCurve(name="test", case="c", mode=1, **{**columns, **changed})


A = Parameter(name="a", low=0.5, high=2.0)
B = Parameter(name="b", low=0.5, high=8.0, start=1.0)


def test_linear_problems_have_the_intervals_of_the_textbook():
    found = identify(compute, [A, B], [measured()])
    # Each is the mean of seven logarithms; misfit widens intervals and never narrows them.
    half = 2.1788 * max(found.misfit, 1.0) * 0.01 / np.sqrt(7)  # t of 12 degrees of freedom
    for name in ("a", "b"):
        low, high = found.intervals[name]
        # Differences of logarithms over logarithms of the range are exact to round-off.
        assert np.log(high / low) / 2 == pytest.approx(half, rel=1e-4)
    assert abs(found.correlations[0, 1]) < 1e-6
    assert found.remarks == ()


def test_intervals_hold_the_truth_as_often_as_they_say():
    found = [identify(compute, [A, B], [measured(seed)]) for seed in range(100)]
    inside = sum(
        one.intervals[name][0] < truth < one.intervals[name][1]
        for one in found
        for name, truth in (("a", 1.1), ("b", 2.0))
    )
    # 190 of 200 are expected; a binomial count lies within 180 to 199 with 99.9 %, and intervals
    # that misfit only widens hold somewhat more.
    assert 180 <= inside <= 200


def test_curvature_is_not_taken_for_what_the_data_tell():
    """Differences to one side saw b tripled: a fit of three parameters ended 6 errors off."""
    bends, tells = 10.0 * (-1.0) ** np.arange(len(AMPLITUDE)), 0.3

    def bent(trial):
        way = np.log(trial["a"])
        frequency = 100.0 * np.exp(tells * way + bends * way**2)
        damping = 1e-3 * trial["a"] * trial["b"] * AMPLITUDE**0.5
        return SimpleNamespace(amplitude=AMPLITUDE, frequency=frequency, damping_ratio=damping)

    truth = bent({"a": 1.0, "b": 2.0})
    test = measured(frequency=truth.frequency[1:-1], damping_ratio=truth.damping_ratio[1:-1])
    wide = Parameter(name="a", low=0.1, high=10.0, start=1.2)
    found = identify(lambda trials: [{"test": bent(trial)} for trial in trials], [wide, B], [test])
    assert found.values["a"] == pytest.approx(1.0, rel=1e-3)
    low, high = found.intervals["a"]
    assert np.log(high / low) / 2 == pytest.approx(2.1788 * 0.01 / np.sqrt(7) / tells, rel=0.02)


def test_what_the_data_do_not_tell_is_named():
    def product(trials):
        return [{"test": curve(1.1 * trial["a"] * trial["b"], 2.0)} for trial in trials]

    one, other = (Parameter(name=name, low=0.5, high=2.0) for name in "ab")
    found = identify(product, [one, other], [measured()])
    (said,) = [text for text in found.remarks if text.startswith("the data do not tell")]
    assert "'a' up by 0.7" in said
    assert "'b' down by 0.7" in said
    assert found.intervals["a"] == (0.5, 2.0)


def test_a_model_that_lacks_something_and_ends_of_ranges_are_named():
    narrow = Parameter(name="a", low=0.5, high=0.9)
    found = identify(compute, [narrow, B], [measured()])
    said = " ".join(found.remarks)
    assert "'a' ends at the upper end of its range" in said
    assert "times their scatter: the model lacks something" in said


def test_amplitudes_too_far_apart_are_not_taken_for_a_model_that_lacks_something():
    """Between three amplitudes damping of ln ζ ~ ln² A is 30 scatters from straight lines."""

    def bent(amplitude, trial):
        damping = 1e-3 * trial["b"] * np.exp(0.2 * np.log(amplitude) ** 2)
        frequency = 100.0 * trial["a"] * amplitude**-0.02
        return SimpleNamespace(amplitude=amplitude, frequency=frequency, damping_ratio=damping)

    truth = bent(AMPLITUDE, {"a": 1.1, "b": 2.0})
    test = measured(frequency=truth.frequency[1:-1], damping_ratio=truth.damping_ratio[1:-1])
    coarse, fine = (
        identify(lambda trials, x=x: [{"test": bent(x, one)} for one in trials], [A, B], [test])
        for x in (AMPLITUDE[::4], AMPLITUDE)
    )
    said = " ".join(coarse.remarks)
    assert "compute amplitudes that lie at the measured ones" in said
    assert "lacks something" not in said
    assert fine.remarks == ()


def test_a_backbone_without_damping_is_refused_by_name():
    still = SimpleNamespace(**{**vars(curve(1.0, 1.0)), "damping_ratio": AMPLITUDE - 0.01})
    with pytest.raises(ModelError, match=r"nothing damps .*'test' at 0\.01, .*\[damping\]"):
        identify(lambda trials: [{"test": still} for _ in trials], [A], [measured()])


def test_amplitudes_that_are_not_reached_are_left_out_and_said():
    wide = np.append(AMPLITUDE[1:-1], 3.0)
    frequency = np.append(curve(1.1, 2.0).frequency[1:-1], 1.0)
    test = measured(amplitude=wide, frequency=frequency, damping_ratio=None)
    found = identify(
        lambda trials: [{"test": curve(trial["a"], 1.0)} for trial in trials], [A], [test]
    )
    assert found.values["a"] == pytest.approx(1.1, rel=1e-3)
    assert "1 of 8 amplitudes of 'test' are not used" in found.remarks[0]
    assert found.remarks[0].endswith("begin below the first and end beyond the last")


@pytest.mark.parametrize(
    ("parameters", "changed", "match"),
    [
        ([], {}, "there is no parameter"),
        ([A, B], {"damping_scatter": None}, "give damping_scatter"),
        ([A, B], {"amplitude": np.full(7, 9.0)}, "do not give 2 parameters"),
    ],
)
def test_what_is_wrong_is_said(parameters, changed, match):
    with pytest.raises(ModelError, match=match):
        identify(compute, parameters, [measured(**changed)])
