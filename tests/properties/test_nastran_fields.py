"""Numbers survive any field form."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying.io.nastran.fields import format_real, integer, integers, real, reals

# Beyond 1e300 a shortened mantissa may round up to infinity.
FLOATS = st.floats(min_value=-1e300, max_value=1e300)


@given(FLOATS, st.sampled_from([8, 16]))
def test_formatted_reals_read_back(value: float, width: int) -> None:
    text = format_real(value, width)
    assert len(text) <= width
    back = real(text)
    assert back is not None
    # Sign, point and a three-digit exponent with its sign leave at least 2 and 10 digits; the
    # rounding error is half a unit of the last one. Denormals have fewer digits of their own.
    assert math.isclose(back, value, rel_tol=0.051 if width == 8 else 5.1e-10, abs_tol=1e-322)


@given(st.floats(min_value=1e-9, max_value=1e9), st.booleans())
def test_usual_magnitudes_keep_ten_digits(value: float, negative: bool) -> None:
    value = -value if negative else value
    assert real(format_real(value)) == pytest.approx(value, rel=1e-11, abs=0)


@given(FLOATS)
def test_python_reals_in_any_notation(value: float) -> None:
    shown = repr(value).upper()
    for text in (shown, shown.replace("E", "D"), shown.replace("E", "")):
        if "E" in shown and ("+" not in shown.split("E")[1] and "-" not in shown.split("E")[1]):
            continue
        assert real(text) == value


@given(st.lists(st.text(alphabet="0123456789+-.DE ", max_size=16), min_size=1, max_size=20))
def test_batch_and_single_parsers_agree(texts: list[str]) -> None:
    for width in (8, 16):
        cut = [text[:width] for text in texts]
        raw = np.array([text.encode() for text in cut], dtype=f"S{width}")
        for batch, single in ((reals, real), (integers, integer)):
            values, bad = batch(raw)
            wanted = [single(text.strip()) if text.strip() else None for text in cut]
            assert bad.tolist() == [value is None for value in wanted]
            assert values.tolist() == [value or 0 for value in wanted]
