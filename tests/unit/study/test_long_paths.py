"""Long paths of a study go on where they were interrupted."""

from dataclasses import dataclass
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

import faying as fy
from faying.execution.checkpoint import Checkpoint
from faying.simulation.start import last_of
from faying.study.stages import books, path_cases
from faying.study.stages.books import Books
from faying.study.stages.path_cases import IncrementalCase, follow_path
from lap_joints import tiny_lap

LOADS = [fy.Load({"tip.Fx": 600.0 * np.sin(0.4 * one)}) for one in range(1, 12)]
FIELDS = ("contact_forces", "shear_forces", "shear_slip", "gap", "states", "dissipation")


@pytest.mark.parametrize("reduced", [False, True], ids=["full", "reduced"])
def test_an_interrupted_path_goes_on_after_its_last_piece(tmp_path, monkeypatch, reduced):
    """Stopped after eight of eleven increments: the numbers of all of them at once, to the bit."""
    model = tiny_lap(penalty=1e6)
    joint = model.with_friction(0.2).with_bolt_forces({"bolt": 5e3})
    basis = fy.craig_bampton(joint, normal_modes=4)
    system = fy.reduce(joint, basis, compliance=True) if reduced else joint
    rest = last_of(fy.solve_path(system, [fy.Load()]))
    expected = fy.solve_path(system, LOADS, initial=rest, name="way")
    followed, reached, original = [], [], path_cases.follow

    def interrupted(solver, relative, here, part):
        if len(followed) == 8:
            followed.append("stop")
            raise KeyboardInterrupt
        followed.extend(part)
        return original(solver, relative, here, part=part)

    monkeypatch.setattr(path_cases, "follow", interrupted)
    monkeypatch.setattr(path_cases, "INCREMENTS_AT_ONCE", 4)
    run = IncrementalCase(
        case=SimpleNamespace(name="way"),
        model=joint,
        system=system,
        preloaded=rest,
        books=Books(checkpoint=Checkpoint(tmp_path)),
        key="way full 1",
        progress=reached.append,
        led=len,
    )
    with pytest.raises(KeyboardInterrupt):
        follow_path(run, LOADS)
    before = sum(run.piece(path_cases._Increments, name, dict)[1] for name in kept_names())
    found, seconds = follow_path(run, LOADS)
    assert followed == [*range(8), "stop", *range(8, 11)]
    assert reached == [4, 4, 4, 4, 3]
    assert seconds > before > 0
    for name in FIELDS:
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), name)
    assert found.iterations.tolist() == expected.iterations.tolist()
    # It slips back and forth: where a piece ends matters for the next.
    assert expected.dissipation[-1] > 0
    assert np.abs(np.diff(expected.shear_slip, axis=0)).max(axis=(1, 2)).min() > 0


def kept_names():
    return [f"increments {first + 1} to {end}" for first, end in pairwise((0, 4, 8))]


@dataclass(frozen=True)
class Answer:
    value: float


def test_computing_what_is_kept_counts_as_the_stage_that_asks_for_it(tmp_path, monkeypatch):
    now = [0.0]
    monkeypatch.setattr(books, "clock", lambda: now[0])
    notes = Books(checkpoint=Checkpoint(tmp_path))

    def slow():
        now[0] += 2.0
        return Answer(42.0)

    with notes.timed("preload"):
        assert notes.value(Answer, "slow", slow) == Answer(42.0)
    assert notes.seconds == {"preload": 2.0, "checkpoint": 0.0}
