"""The structure of the package itself: who imports whom, public names, sizes, doctests."""

import ast
import doctest
import importlib
import importlib.util
import inspect
from graphlib import TopologicalSorter

import pytest
from packages import MODULES, ORDER, ROOMS, ROOT, dotted, imports, package, parsed

import faying

LONGEST = 400


def test_imports_point_one_way():
    wrong = {
        (path, name)
        for path in MODULES
        for name in imports(path)
        if "." in name and name.split(".")[1] not in ORDER[: ORDER.index(package(path)) + 1]
    }
    assert wrong == set()


def test_rooms_of_a_study_import_one_way():
    wrong = set()
    for path in MODULES:
        if path.startswith("study/"):
            room = dotted(path).split(".")[2:3]
            before = ROOMS[: ROOMS.index(room[0]) + 1] if room else ()
            inner = (name for name in imports(path) if name.startswith("faying.study."))
            wrong |= {(path, name) for name in inner if name.split(".")[2] not in before}
    assert wrong == set()


def test_every_folder_has_its_place():
    assert {package(path) for path in MODULES} == set(ORDER)


@pytest.mark.long
def test_scripts_beside_figures_import_what_is_there():
    """They run rarely: benchmarks/decks.py named a function that had gone."""
    folders = [ROOT.parents[1] / name for name in ("benchmarks", "docs", "examples")]
    used = {
        (node.module, alias.name)
        for folder in folders
        for path in folder.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("faying")
        for alias in node.names
    }
    missing = [
        names
        for names in sorted(used)
        if not hasattr(importlib.import_module(names[0]), names[1])
        and importlib.util.find_spec(".".join(names)) is None
    ]
    assert used
    assert missing == []


def test_unit_tests_stand_under_the_name_of_a_package():
    tests = ROOT.parents[1] / "tests" / "unit"
    assert not list(tests.glob("test_*.py"))
    assert {path.parent.name for path in tests.rglob("test_*.py")} <= set(ORDER)


@pytest.mark.long
def test_files_import_each_other_in_one_order():
    """Not even inside functions may two files, of one folder or of several, need each other."""
    graph = {
        dotted(path): set(imports(path)) - {dotted(path), "faying"}
        for path in MODULES
        if path != "__init__.py"
    }
    assert len(list(TopologicalSorter(graph).static_order())) >= len(graph)  # raises on a cycle


def test_scanner_sees_imports():
    assert "faying.contact.contact" in set(imports("contact/condensed.py"))


@pytest.mark.parametrize("name", faying.__all__)
def test_public_names_exist_and_are_described(name):
    thing = getattr(faying, name)
    assert inspect.getdoc(thing)
    assert name in dir(faying)


def test_other_names_are_refused():
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        faying.nothing  # noqa: B018  the access is the test


def test_modules_are_short():
    long = {
        path
        for path in MODULES
        if len((ROOT / path).read_text(encoding="utf-8").splitlines()) > LONGEST
    }
    assert long == set()


def test_modules_say_what_they_are_for():
    assert [path for path in MODULES if not ast.get_docstring(parsed(path))] == []


@pytest.mark.long
@pytest.mark.parametrize(
    "path", [p for p in MODULES if ">>>" in (ROOT / p).read_text(encoding="utf-8")]
)
def test_examples_in_docstrings(path):
    module = importlib.import_module(dotted(path))
    result = doctest.testmod(module)
    assert result.attempted > 0
    assert result.failed == 0


@pytest.mark.parametrize("name", faying.__all__)
def test_public_names_show_an_example(name):
    assert ">>>" in (getattr(faying, name).__doc__ or "")
