"""docs/theory/equation_map.md: equations of the seed and of our own, functions and tests."""

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
ROWS = re.findall(r"^\| \((15\.\d+|[A-Z]\d+)\) \| .* \| (\S+) \| (\S+) \|$", TEXT, re.MULTILINE)
NAMED = [(number, name.strip("`"), test.strip("`")) for number, name, test in ROWS if name != "—"]


OWN = {
    "M": "method",
    "R": "recovery",
    "C": "certificate",
    "F": "friction",
    "T": "bolts_and_sticking",
}
"""Letter of our own equation numbers to the page that they are of."""

CITED_OWN = re.compile(rf"\(([{''.join(OWN)}]\d+)\)")


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
    return {f"15.{n}" for n in numbers} | set(CITED_OWN.findall(text))


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
    seed = [number for number, *_ in ROWS if number.startswith("15.")]
    assert seed == [f"15.{n}" for n in range(1, 32)]
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


def test_every_equation_of_our_own_that_is_cited_stands_on_its_page():
    numbers = {letter: numbers_of(DOCS / "theory" / f"{page}.md") for letter, page in OWN.items()}
    texts = [path for folder in ("src", "tests", "docs") for path in (ROOT / folder).rglob("*")]
    unknown = [
        f"{path.relative_to(ROOT)}: ({number})"
        for path in texts
        if path.suffix in {".py", ".md"}
        for number in CITED_OWN.findall(path.read_text(encoding="utf-8"))
        if number not in numbers[number[0]]
    ]
    assert not unknown


def numbers_of(page: Path) -> set[str]:
    """Numbers that a page gives to its equations: in a tag, or at the end of a sentence."""
    text = page.read_text(encoding="utf-8")
    return set(re.findall(r"\\tag\{([A-Z]\d+)\}", text)) | set(CITED_OWN.findall(text))


def test_all_tagged_equations_of_the_method_are_in_the_map():
    tagged = re.findall(r"\\tag\{(M\d+)\}", (DOCS / "theory" / "method.md").read_text("utf-8"))
    assert [number for number, *_ in ROWS if number.startswith("M")] == tagged
