"""Lines as places in a text are what Python's own splitting, searching and joining give."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying.io.deck_lines import LineTexts, joined, split_lines

TEXTS = st.text(alphabet="ab$, \r\n", max_size=40).map(str.encode)


@pytest.fixture(autouse=True, params=[1, 2**24], ids=["small chunks", "one chunk"])
def chunks(request, monkeypatch):
    monkeypatch.setattr("faying.io.deck_lines._CHUNK", request.param)
    monkeypatch.setattr("faying.io.deck_lines._LINES", min(request.param + 1, 2**13))


@given(TEXTS)
def test_lines_are_those_of_python(text: bytes) -> None:
    assert list(split_lines(text)) == text.splitlines()


@given(TEXTS, st.sampled_from([b"a", b",", b"ab", b"b,a"]))
def test_lines_that_hold_a_word(text: bytes, word: bytes) -> None:
    found = split_lines(text)
    expected = [i for i, line in enumerate(text.splitlines()) if word in line]
    assert found.holding(word).tolist() == expected
    # Also where one line follows the other without anything between them.
    assert joined([list(found)]).holding(word).tolist() == expected


@given(TEXTS)
def test_lines_are_cut_at_the_first_letter(text: bytes) -> None:
    expected = [line.partition(b"$")[0] for line in text.splitlines()]
    assert list(split_lines(text).cut_at(b"$")) == expected


@given(TEXTS, st.sampled_from([1, 3, 8]))
def test_first_letters(text: bytes, width: int) -> None:
    expected = [line[:width].ljust(width) for line in text.splitlines()]
    letters = split_lines(text).letters(width)
    assert letters.dtype == np.uint8
    assert letters.shape == (len(expected), width)
    assert [row.tobytes() for row in letters] == expected


@given(st.lists(TEXTS, max_size=4))
def test_parts_are_joined_in_their_order(texts: list[bytes]) -> None:
    parts = [split_lines(text)[k % 2 :].cut_at(b"$") for k, text in enumerate(texts)]
    found = joined([part if k % 3 else list(part) for k, part in enumerate(parts)])
    assert list(found) == [line for part in parts for line in part]


def test_lines_in_upper_case():
    text = LineTexts(b"ab\ncd", np.array([0, 3]), np.array([2, 5]))
    assert list(text.upper()) == [b"AB", b"CD"]
