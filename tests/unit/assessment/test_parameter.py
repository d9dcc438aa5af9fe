"""Numbers known by their ranges: where trials lie in them, and what is refused."""

import pytest

from faying.assessment.parameter import Parameter, design, values_at
from faying.exceptions import ModelError

FRICTION = Parameter(name="friction", low=0.1, high=0.4)
CROWN = Parameter(name="crown", low=-1.0, high=1.0)


def test_positive_ranges_go_by_their_logarithm():
    assert FRICTION.value(0.5) == pytest.approx(0.2)
    assert CROWN.value(0.5) == 0.0
    for one in (FRICTION, CROWN):
        assert one.share(one.value(0.3)) == pytest.approx(0.3)


def test_corners_and_the_middle():
    found = [tuple(trial.values()) for trial in design([FRICTION, CROWN])]
    assert found[0] == pytest.approx((0.2, 0.0))
    assert found[1:] == [
        pytest.approx(corner) for corner in [(0.1, -1), (0.1, 1), (0.4, -1), (0.4, 1)]
    ]


def test_quasi_random_points_fill_the_ranges_alike_every_time():
    first, again = (design([FRICTION, CROWN], "quasi-random", 8) for _ in range(2))
    assert first == again
    # Of eight points of Halton's sequence in base 2 four lie in each half.
    assert sum(trial["friction"] < 0.2 - 1e-9 for trial in first) in (3, 4)
    assert all(0.1 < trial["friction"] < 0.4 and -1 < trial["crown"] < 1 for trial in first)


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: Parameter(name="p", low=1.0, high=1.0), "the smaller one first"),
        (lambda: Parameter(name="p", low=1.0, high=2.0, start=3.0), "start within"),
        (lambda: design([FRICTION], "random"), "give 'corners' or 'quasi-random'"),
        (lambda: design([FRICTION] * 14), "16384 corners"),
    ],
)
def test_what_is_wrong_is_said(call, match):
    with pytest.raises(ModelError, match=match):
        call()


def test_values_are_by_name():
    assert values_at([FRICTION], [1.0]) == {"friction": pytest.approx(0.4)}
