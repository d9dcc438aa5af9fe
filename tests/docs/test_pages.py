"""The code in README and docs runs, and their links lead somewhere."""

import doctest
import importlib
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pages import PAGES, ROOT, Block, blocks

import faying as fy

SHELL_OF_CHECKOUT = {"README.md", "CONTRIBUTING.md"}
"""Pages whose shell commands set up a checkout; .ci/run runs those."""

RESULTS_OF_A_RUN = {"results.md"}
"""Pages whose code reads the results.h5 of a run of the demo."""

named = pytest.mark.parametrize(
    "page", PAGES, ids=lambda path: str(path.relative_to(ROOT).with_suffix(""))
)


@pytest.fixture(scope="session")
def quick_demo(tmp_path_factory):
    """Folder that ``faying demo --quick`` leaves in a process of its own; several pages show it."""
    folder = tmp_path_factory.mktemp("demo")
    done = subprocess.run(
        [sys.executable, "-m", "faying", "demo", "--quick", "--out", "."],
        cwd=folder,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr + done.stdout
    return folder


def run_python(block: Block, page: Path, names: dict[str, Any]) -> None:
    where = f"{page.name}, line {block.line}"
    if ">>>" in block.text:
        parser, runner = doctest.DocTestParser(), doctest.DocTestRunner()
        case = parser.get_doctest(block.text, names, where, str(page), block.line)
        report: list[str] = []
        runner.run(case, out=report.append, clear_globs=False)
        assert runner.summarize(verbose=False).failed == 0, "".join(report)
        names.update(case.globs)
        return
    # The line numbers of a traceback are those of the page.
    exec(compile("\n" * block.line + block.text, str(page), "exec"), names)


def missing(block: Block) -> bool:
    """Whether a block says ```python requires=PACKAGE and the package is not there."""
    wanted = block.words.removeprefix("requires=") if block.words.startswith("requires=") else ""
    try:
        for name in filter(None, wanted.split(",")):
            importlib.import_module(name)
    except (ImportError, OSError):  # OSError: a wheel without its system libraries
        return True
    return False


def run_shell(block: Block, page: Path, folder: Path, request) -> None:
    """Run the commands of a block in this process, which has imported what they need."""
    if page.name in SHELL_OF_CHECKOUT:
        return
    for line in block.text.splitlines():
        command, *arguments = shlex.split(line, comments=True)
        assert command == "faying", f"{page.name}: '{command}' is not run by this test"
        if arguments[:3] == ["demo", "--quick", "--out"]:
            shutil.copytree(request.getfixturevalue("quick_demo"), folder / arguments[3])
        else:
            status, *said = request.getfixturevalue("call")(*arguments)
            assert status == 0, said


@pytest.mark.long
@named
def test_code_runs(page, tmp_path, monkeypatch, request):
    monkeypatch.chdir(tmp_path)
    if page.name in RESULTS_OF_A_RUN:
        demo = request.getfixturevalue("quick_demo")
        shutil.copytree(demo, tmp_path, dirs_exist_ok=True)
    names: dict[str, Any] = {"__name__": "page"}
    for block in blocks(page):
        if missing(block):
            continue
        if block.language == "python":
            run_python(block, page, names)
        elif block.language == "bash":
            run_shell(block, page, tmp_path, request)
        elif block.words:
            (tmp_path / block.words).write_text(block.text, encoding="utf-8")


def headings(path: Path) -> set[str]:
    """Anchors of a page as GitHub makes them."""
    text = re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.M | re.S)
    lines = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", line.lower()).replace(" ", "-") for line in lines}


@named
def test_links_lead_somewhere(page):
    text = re.sub(r"`[^`\n]*`", "", page.read_text(encoding="utf-8"))
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith(("http:", "https:", "mailto:")):
            continue
        file, _, anchor = target.partition("#")
        path = (page.parent / file).resolve() if file else page
        assert path.exists(), target
        assert not anchor or anchor in headings(path), target


@named
def test_pages_are_reached_from_the_index(page):
    """Every page of docs is linked from README, the index or a page of its folder."""
    if page.parent == ROOT:
        return
    others = [other for other in PAGES if other != page]
    linked = {
        (other.parent / target.partition("#")[0]).resolve()
        for other in others
        for target in re.findall(r"\]\(([^)\s]+)\)", other.read_text(encoding="utf-8"))
    }
    assert page.resolve() in linked or page.name == "index.md"


@pytest.mark.parametrize("name", fy.__all__)
def test_public_names_are_used_on_a_page(name):
    """In code that test_code_runs runs."""
    code = [block.text for page in PAGES for block in blocks(page) if block.language == "python"]
    assert any(re.search(rf"\bfy\.{name}\b", text) for text in code)
