"""The same study gives the same bits, whatever ran before it and however often it was killed."""

import signal
import subprocess
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

import h5py
import numpy as np
import pytest

import faying as fy
from small_study import BEND, FINE_JUMP, NO_REPORT, SMALL_JOINT, reduction, training

SMALL = (
    SMALL_JOINT
    + """
[[interface]]
name = "joint"
penalty = PENALTY

[sticking]
stiffness = 1e6

[validation]
unseen_loads = 4

"""
    + reduction("craig-bampton", "jim-b", "compliance", joint_modes=[4])
    + training(levels=2)
    + BEND
    + FINE_JUMP
    + NO_REPORT
)
"""Every stage of a run that solves contact problems, in seconds."""

CLOCKED = ("/timings/", "/provenance/date", "/seconds")
"""What of results is the clock's."""

RUN = """
import os, signal, sys
from itertools import count
from pathlib import Path
from threadpoolctl import threadpool_limits
from faying.study.keys.schema import read_study
from faying.workflow.run import run

study, out, last = read_study(Path(sys.argv[1])), Path(sys.argv[2]), float(sys.argv[3])
quiet = study.output.model_copy(update={"report": False})
calls = count()

def kill(*_):
    if next(calls) == last:
        os.kill(os.getpid(), signal.SIGKILL)

sys.setprofile(kill)
with threadpool_limits(1):
    run(study.model_copy(update={"output": quiet}), out, resume=True)
sys.setprofile(None)
print(next(calls))
"""
"""A run that is killed, wherever it is, at a call or return of functions.

Counted, they are the same in every run; a clock hits other places when other programs run.
"""


SEQUENCE = """
import sys
from pathlib import Path
from threadpoolctl import threadpool_limits
from faying.study.keys.schema import read_study
from faying.workflow.run import run

paths = list(map(Path, sys.argv[1:]))
for path, out in zip(paths[::2], paths[1::2], strict=True):
    study = read_study(path)
    quiet = study.output.model_copy(update={"report": False})
    with threadpool_limits(1):
        assert run(study.model_copy(update={"output": quiet}), out)["converged"]
"""
"""Runs one after the other in one process, without reports, which compute nothing."""


def bits(out: Path) -> dict[str, object]:
    """Type, shape and bytes of every dataset that a run leaves, but for dates and seconds."""
    found: dict[str, object] = {}

    def note(name: str, node: h5py.Group | h5py.Dataset) -> None:
        if isinstance(node, h5py.Dataset) and not any(part in f"/{name}" for part in CLOCKED):
            value = np.asarray(node[()])
            text = h5py.check_string_dtype(node.dtype) is not None
            found[name] = value.tolist() if text else (value.dtype, value.shape, value.tobytes())

    with h5py.File(out / "results.h5") as file:
        file.visititems(note)
    return found


def assert_same(found: Mapping[str, object], expected: Mapping[str, object], what: str) -> None:
    """Name the datasets that differ, for their bytes tell nobody anything."""
    names = sorted(found.keys() | expected.keys())
    differing = [name for name in names if found.get(name) != expected.get(name)]
    assert not differing, what
    assert len(names) > 100


def elsewhere(path: Path, out: Path, last: float = np.inf) -> subprocess.CompletedProcess[str]:
    """Run, or resume, in a process of its own; killed at the call of that number."""
    return subprocess.run(
        [sys.executable, "-W", "error", "-c", RUN, path, out, str(last)],
        capture_output=True,
        text=True,
        check=False,
    )


def finished(path: Path, out: Path) -> int:
    """Run, or resume, in a process of its own to the end; return the number of its calls."""
    ended = elsewhere(path, out)
    assert ended.returncode == 0, ended.stderr
    return int(ended.stdout)


def check_orders(studies: Mapping[str, Path], order: Iterable[str], folder: Path) -> None:
    """Run studies one after the other in one process, and each in a process of its own.

    Not in the process of the tests: libraries that other tests load round differently afterwards.
    """
    expected: dict[str, dict[str, object]] = {}
    for name, path in studies.items():
        finished(path, folder / name)
        expected[name] = bits(folder / name)
    outs = [(name, folder / f"{place}-{name}") for place, name in enumerate(order)]
    pairs = [argument for name, out in outs for argument in (studies[name], out)]
    ended = subprocess.run(
        [sys.executable, "-W", "error", "-c", SEQUENCE, *pairs],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    before = "nothing"
    for name, out in outs:
        assert_same(bits(out), expected[name], f"{name} after {before}")
        before = name


@pytest.fixture(scope="module")
def small(tmp_path_factory) -> dict[str, Path]:
    """Studies of seconds whose contact problems differ in size, law and solver."""
    folder = tmp_path_factory.mktemp("small")
    hard = SMALL.replace("joint_modes = [4]\n", "").replace('"craig-bampton", "jim-b", ', "")
    hard = hard[: hard.index("[reduction.training]")] + hard[hard.index("[[load_case]]") :]
    texts = {
        "elastic": SMALL.replace("PENALTY", '"auto"'),
        "hard": hard.replace("PENALTY", '"hard"').replace("unseen_loads = 4\n", ""),
    }
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text)
    return {name: folder / f"{name}.toml" for name in texts}


@pytest.mark.long
def test_a_study_gives_the_same_bits_after_any_other(small, tmp_path):
    # Each after itself and after the other.
    a, b = small
    check_orders(small, (a, a, b, b, a), tmp_path)


def check_kills(path: Path, folder: Path, instants: int) -> None:
    """Kill a run at so many instants all over it, each time resume: same bits."""
    whole = finished(path, folder / "whole")
    expected = bits(folder / "whole")
    for instant in range(instants):
        out = folder / str(instant)
        last = int(whole * (instant + 0.5) / instants)
        assert elsewhere(path, out, last).returncode == -signal.SIGKILL
        finished(path, out)
        assert_same(bits(out), expected, f"killed at call {last} of {whole}")


@pytest.mark.long
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal here")
def test_a_killed_run_resumes_to_the_bit(small, tmp_path):
    check_kills(small["elastic"], tmp_path, 5)


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no such signal here")
def test_a_run_killed_anywhere_resumes_to_the_bit(small, tmp_path):
    check_kills(small["elastic"], tmp_path, 50)


@pytest.mark.slow
def test_all_examples_give_the_same_bits_in_any_order(tmp_path):
    package, examples = Path(fy.__file__).parent, Path(__file__).parents[2] / "examples"
    demos = {path.stem: path for path in (package / "study").glob("*.toml")}
    studies = demos | {path.stem: path for path in examples.glob("*.toml")}
    assert len(studies) >= 4
    forth = sorted(studies)
    check_orders(studies, (*forth, *reversed(forth)), tmp_path)
