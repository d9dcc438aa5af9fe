"""docs/theory/equation_map.md: every equation of the seed, its function and its test."""

import ast
import inspect
import re
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from pages import DOCS, ROOT

TEXT = (DOCS / "theory" / "equation_map.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| \((15\.\d+)\) \| .* \| (\S+) \| (\S+) \|$", TEXT, re.MULTILINE)
NAMED = [(number, name.strip("`"), test.strip("`")) for number, name, test in ROWS if name != "—"]


def resolved(name: str) -> Any:
    """Import the module, class, function or method of a dotted name."""
    parts = name.split(".")
    for end in range(len(parts), 0, -1):
        try:
            found: Any = import_module(".".join(parts[:end]))
        except ModuleNotFoundError:
            continue
        for part in parts[end:]:
            found = inspect.getattr_static(found, part)
        return getattr(found, "fget", None) or getattr(found, "func", found)
    raise ModuleNotFoundError(name)


def cited(text: str) -> set[str]:
    """Equation numbers in a text; "(15.20) to (15.22)" cites all between."""
    numbers = {int(n) for n in re.findall(r"\(15\.(\d+)[a-d]?\)", text)}
    for first, last in re.findall(r"\(15\.(\d+)\) to \(15\.(\d+)\)", text):
        numbers |= set(range(int(first), int(last) + 1))
    return {f"15.{n}" for n in numbers}


def names_of_tests(path: Path) -> set[str]:
    """Names of the tests of a file, Class::name for those in classes."""
    names: set[str] = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef):
            names.add(node.name)
        elif isinstance(node, ast.ClassDef):
            inner = [one.name for one in node.body if isinstance(one, ast.FunctionDef)]
            names |= {f"{node.name}::{name}" for name in inner}
    return names


def test_all_equations_of_the_seed_are_there():
    assert [number for number, *_ in ROWS] == [f"15.{n}" for n in range(1, 32)]
    assert len(NAMED) > 20


@pytest.mark.parametrize(("number", "name", "test"), NAMED, ids=[row[0] for row in NAMED])
def test_function_cites_its_equation_and_the_test_exists(number, name, test):
    found = resolved(name)
    texts = [inspect.getsource(found)]
    if not isinstance(found, ModuleType):
        # Equations of a whole module stand at its top.
        texts.append(inspect.getmodule(found).__doc__ or "")
    assert number in cited("\n".join(texts))
    file, _, function = test.partition("::")
    assert function in names_of_tests(ROOT / file)
