"""Examples of the property tests depend on nothing but the test."""

import importlib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st


def examples():
    """Draw numbers as the property tests do."""
    seen = []

    @settings(derandomize=True, database=None, max_examples=200)
    @given(st.integers(0, 2**32 - 1), st.floats(0.0, 1e9), st.text(max_size=9))
    def draw(number, ratio, word):
        seen.append((number, ratio, word))

    draw()
    return seen


def test_examples_do_not_depend_on_the_modules_imported_before(tmp_path, monkeypatch):
    if not settings().derandomize:
        pytest.skip("this profile searches for new examples")
    before = examples()
    text = "\n".join(f"a{n}, b{n}, c{n} = {n}, {n}.5, 'word {n}'" for n in range(1000, 1100))
    (tmp_path / "module_with_numbers.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    importlib.import_module("module_with_numbers")
    assert examples() == before
    assert len(set(before)) > 100


def test_no_verdict_depends_on_how_long_an_example_takes():
    assert settings().deadline is None
