"""What happens to a run: full disks, folders that are gone or taken, Ctrl-C, names with markup."""

import io
import os
import re
import resource
import signal
import subprocess
import sys
import time
from contextlib import nullcontext
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
import typer
from rich.console import Console

from fake_results import fake_results
from faying import __main__ as entry
from faying.cli import progress
from faying.cli.fit import band, fit
from faying.cli.interruption import resumable
from faying.cli.outcome import show_outcome
from faying.exceptions import FormatError, StudyError
from faying.export.vtk import write_interface_vtu
from faying.files.atomic import held
from faying.files.names import file_names
from faying.report.figures.album import Album
from faying.report.html import render
from faying.simulation.compiled import import_loop
from faying.study.judgement.summary import summarize
from faying.study.keys.schema import read_study
from faying.study.results.store import read_results, write_results
from faying.workflow.run import run

STUDY = """\
[model]
source = "lap-joint"
[model.lap_joint]
element_size = 10.0
washer_radius = 10.0
[reduction]
normal_modes = 3
methods = ["compliance"]
[[bolt]]
name = "bolt"
preload = 10e3
[[load_case]]
name = "NAME"
kind = "static"
forces = [{ boundary = "tip", component = "Fz", value = -500.0 }]
[output]
report = false
"""
HOSTILE = "../../<script>alert(1)</script>[/bold]$x_{&\"'\\frac"


@pytest.fixture
def study(tmp_path):
    (tmp_path / "study.toml").write_text(STUDY.replace("NAME", "bend"))
    return tmp_path / "study.toml"


def call(study, *options, limit=None):
    """Run the command in a process of its own, with a limit to the size of its files."""
    arguments = [sys.executable, "-m", "faying", "run", study.name, "--out", "out", *options]
    before = (lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))) if limit else None
    return subprocess.run(
        arguments,
        capture_output=True,
        text=True,
        cwd=study.parent,
        check=False,
        preexec_fn=before,
    )


@pytest.mark.long
@pytest.mark.parametrize("limit", [50, 3000, 100_000])
def test_full_disk(study, limit):
    """The stamp, the summary or the results do not fit; nothing is left half written."""
    import_loop()  # what numba compiles is kept in files too
    ended = call(study, limit=limit)
    assert ended.returncode == 2, ended.stderr
    *stages, said = ended.stderr.splitlines()
    assert said.startswith("faying: cannot ")
    assert all(re.match(r" +\d+:\d\d  \w", line) for line in stages)
    assert not [path for path in (study.parent / "out").rglob("*") if path.name.startswith(".")]
    again = call(study, "--resume")
    assert again.returncode == 0, again.stderr
    assert read_results(study.parent / "out" / "results.h5").cases


def test_old_results_survive_a_full_disk(tmp_path):
    path = tmp_path / "results.h5"
    write_results(fake_results(), path)
    before = path.read_bytes()
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (len(before) // 2, usual[1]))
    try:
        with pytest.raises(FormatError, match=r"cannot write .*results\.h5"):
            write_results(fake_results(), path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.long
def test_two_runs_in_one_folder(study):
    out = study.parent / "out"
    out.mkdir()
    with held(out):
        with pytest.raises(StudyError, match=r"another run is writing to .*choose another"):
            run(read_study(study), out)
        ended = call(study)
        assert ended.returncode == 2
        assert "another run is writing" in ended.stderr
        assert not list(out.iterdir())
    assert call(study).returncode == 0


WRITES = """
import sys, time
from pathlib import Path
from faying.files.atomic import replacing
with replacing(Path(sys.argv[1])) as temporary:
    temporary.write_text("half of it")
    print(temporary, flush=True)
    time.sleep(600)
"""


def writing(path):
    """Start a process that writes a file and does not end, and return its temporary file."""
    command = [sys.executable, "-c", WRITES, str(path)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    return process, Path(process.stdout.readline().strip())


@pytest.mark.long
def test_next_run_removes_what_killed_ones_left(study):
    out = study.parent / "out"
    (out / "figures").mkdir(parents=True)
    own = [out / ".results.h5", out / ".notes.h5.of mine.h5"]
    for file in own:
        file.write_text("a user's own")
    places = [out / "results.h5", out / "figures" / "gap.png", out / "summary.json"]
    started = [writing(place) for place in places]
    try:
        for process, _ in started[:2]:
            process.kill()
            process.wait()
        assert all(left.read_text() == "half of it" for _, left in started)
        run(read_study(study), out)
        assert [left.exists() for _, left in started] == [False, False, True]
        assert all(file.exists() for file in own)
        assert read_results(out / "results.h5").cases.keys() == {"bend"}
    finally:
        for process, _ in started:
            process.kill()
            process.communicate()


@pytest.mark.long
@pytest.mark.parametrize(
    ("stop", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["Ctrl-C", "kill"]
)
def test_interrupted_run_says_how_to_go_on(study, stop, status):
    """A step response of a hundred thousand steps, which is not finished when its stage is told."""
    text = study.read_text().replace(
        'kind = "static"', 'kind = "step"\nstep = 1e-6\nduration = 0.1'
    )
    study.write_text(text)
    arguments = [sys.executable, "-m", "faying", "run", study.name, "--out", "a folder"]
    with subprocess.Popen(
        arguments,
        cwd=study.parent,
        stderr=subprocess.PIPE,
        text=True,
        # Shells tell what they start in the background to ignore it, tests and all.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    ) as process:
        told = next((line for line in process.stderr if line.endswith("bend full\n")), "")
        process.send_signal(stop if told else signal.SIGKILL)
        said = told + process.stderr.read()
    assert process.returncode == status, said
    assert "Traceback" not in said
    assert said.endswith("  faying run study.toml --out 'a folder' --resume\n")


@pytest.mark.parametrize(
    ("stop", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["Ctrl-C", "kill"]
)
def test_a_command_interrupted_early_says_how_to_begin_again(tmp_path, capsys, stop, status):
    """Before anything is kept, as while a deck is read."""

    def stopped():
        with resumable(["faying", "run", "a b.toml"], tmp_path):
            os.kill(os.getpid(), stop)
            time.sleep(5)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(typer.Exit) as ended:
            stopped()
    finally:
        signal.signal(signal.SIGINT, before)
    assert ended.value.exit_code == status
    said = "Interrupted; nothing was finished yet. Start again with\n  faying run 'a b.toml'\n"
    assert capsys.readouterr().err == said


@pytest.mark.parametrize(
    ("command", "works"), [(fit, "fit_study"), (band, "band_of_study")], ids=["fit", "band"]
)
def test_an_interrupted_fit_says_that_its_backbones_are_kept(
    tmp_path, monkeypatch, capsys, command, works
):
    """Minutes of them: it said that nothing was begun."""

    def stopped(_study, folder, **_arguments):
        (folder / "unfinished").mkdir(parents=True)
        raise KeyboardInterrupt

    monkeypatch.setattr(f"faying.workflow.fit.{works}", stopped)
    module = sys.modules["faying.cli.fit"]  # the package has a function of that name
    monkeypatch.setattr(module, "study_work", lambda *_: nullcontext((None, None, None)))
    name, out = command.__name__, tmp_path / "out"
    with pytest.raises(typer.Exit) as ended:
        command(Path("a b.toml"), out=out)
    assert ended.value.exit_code == 130
    said = f"finished results are kept in {out / 'unfinished'}. Continue with"
    again = f"  faying {name} 'a b.toml' --out {out}\n"
    assert capsys.readouterr().err == f"Interrupted; {said}\n{again}"


@pytest.mark.parametrize(
    ("stop", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["Ctrl-C", "kill"]
)
def test_a_command_interrupted_before_it_is_read_in_says_so(monkeypatch, capsys, stop, status):
    def stopped():
        os.kill(os.getpid(), stop)
        time.sleep(5)

    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    signal.signal(signal.SIGINT, signal.default_int_handler)
    monkeypatch.setattr("faying.cli.main", stopped)
    try:
        with pytest.raises(SystemExit) as ended:
            entry.main()
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    assert ended.value.code == status
    expected = "Interrupted; nothing was written. Give the same command again\n"
    assert capsys.readouterr().err == expected


@pytest.mark.long
def test_a_run_without_a_terminal_tells_its_stages(study):
    """A line as each begins: what is read in a log while it runs."""
    lines = call(study).stderr.splitlines()
    stages = [re.fullmatch(r" *(\d+):(\d\d)  (\S.*)", line).groups() for line in lines]
    times = [60 * int(minutes) + int(seconds) for minutes, seconds, _ in stages]
    assert times == sorted(times)
    names = [name for _, _, name in stages if " of " not in name]  # how far, on a busy machine
    assert names[:4] == ["assembly", "factorization", "compliance", "preload"]
    assert names.index("preload") < names.index("files")


def test_lines_tell_how_much_is_done(capsys, monkeypatch):
    now = [0.0]
    monkeypatch.setattr(progress, "monotonic", lambda: now[0])
    lines = progress.Lines()
    task = lines.add_task("steps", total=100)
    for _ in range(70):
        now[0] += 1.0
        lines.advance(task)
    assert capsys.readouterr().err == (
        "   0:00  steps\n   0:31  steps: 31 of 100\n   1:02  steps: 62 of 100\n"
    )


def test_folder_that_vanishes(tmp_path):
    with pytest.raises(FormatError, match=r"cannot write .*gone"):
        write_results(fake_results(), tmp_path / "gone" / "results.h5")


class Tags(HTMLParser):
    """The names of all tags of a page."""

    def __init__(self):
        super().__init__()
        self.found = set()

    def handle_starttag(self, tag, attrs):
        self.found.add(tag)
        self.found |= {name for name, _ in attrs if name.startswith("on")}


@pytest.mark.long
def test_names_with_markup(tmp_path):
    """Of everything a file can name: shown as they are, in files of the folder only."""
    results = fake_results()
    case = replace(results.cases["LC1"], name=HOSTILE)
    warnings = (*results.warnings, f"<img src=x onerror=alert(1)> {HOSTILE}")
    hostile = replace(
        results, title=HOSTILE, warnings=warnings, cases={**results.cases, HOSTILE: case}
    )
    out = tmp_path / "deep" / "out"
    out.mkdir(parents=True)
    write_results(hostile, out / "results.h5")
    page = render(Album(read_results(out / "results.h5")), out)
    usual, found = Tags(), Tags()
    usual.feed(render(Album(results), out))
    found.feed(page)
    assert found.found == usual.found
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    write_interface_vtu(hostile, out)
    assert {path.name for path in tmp_path.iterdir()} == {"deep"}
    assert {path.name for path in out.parent.iterdir()} == {"out"}
    shown = io.StringIO()
    show_outcome(summarize(hostile), out, Console(markup=False, width=1000, file=shown))
    assert HOSTILE in shown.getvalue()


def test_names_too_long_for_files():
    names = file_names(["ü" * 500, "ü" * 501, "x" * 300])
    assert all(len(stem.encode()) < 140 for stem in names.values())
    assert len(set(names.values())) == 3


@pytest.mark.long
def test_control_characters_do_not_reach_the_terminal(tmp_path):
    (tmp_path / "study.toml").write_text('[model]\nsource = "\\u001b[31m"\n')
    arguments = [sys.executable, "-m", "faying", "check", "study.toml"]
    ended = subprocess.run(arguments, capture_output=True, cwd=tmp_path, check=False)
    assert ended.returncode == 2
    assert b"\x1b" not in ended.stderr
    assert b"\\x1b[31m" in ended.stderr
