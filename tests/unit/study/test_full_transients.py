"""Transients of the full model in studies: what is kept of them, and what is not held."""

import tracemalloc

import numpy as np
import pytest

import faying as fy
from faying.files.flattening import flattened
from faying.linalg.memory import VARIABLE, NotEnoughMemoryError
from faying.study.inputs.loads import case_load
from faying.study.keys.schema import parse_study
from faying.study.results.responses import respond
from faying.study.stages.full_transients import INSTANTS_AT_ONCE, FullTransient, full_transients
from faying.study.stages.offline import prepare_joint
from small_study import SMALL_JOINT

STEP = 1e-5
CASE = """
[[load_case]]
name = "{name}"
kind = "step"
rise_time = 1e-4
forces = [{{ boundary = "tip", component = "Fz", value = {value} }}]
duration = {duration}
step = {step}
"""
RUBS = '[[interface]]\nname = "joint"\npenalty = 1e5\nfriction = 0.2\ntangential_penalty = 8e4\n'


def prepared(tmp_path, *, count, joint=SMALL_JOINT):
    text = joint + "".join(
        CASE.format(name=name, value=value, duration=count * STEP, step=STEP)
        for name, value in (("push", -200.0), ("pull", 150.0))
    )
    study = parse_study(text, tmp_path / "joint.toml")
    return prepare_joint(study), study.load_cases


@pytest.mark.long
@pytest.mark.parametrize("joint", [SMALL_JOINT, SMALL_JOINT + RUBS], ids=["smooth", "rough"])
def test_pieces_make_the_response_of_the_whole(tmp_path, joint):
    prepared_joint, cases = prepared(tmp_path, count=2 * INSTANTS_AT_ONCE + 8, joint=joint)
    found = full_transients(prepared_joint, [FullTransient(case=case) for case in cases])
    for case, one in zip(cases, found, strict=True):
        whole = fy.solve_transient(
            prepared_joint.model,
            case_load(case),
            step=STEP,
            duration=case.duration,
            initial=prepared_joint.rest,
        )
        expected = flattened(respond(whole, prepared_joint.model, one.seconds, moves=True))
        mine = flattened(one)
        assert mine.keys() == expected.keys()
        for name in mine.keys() - {"iterations", "seconds"}:
            # Round-off, of two responses side by side; the signs of shapes of motion are open.
            near = 1e-7 * np.abs(expected[name]).max(initial=0.0)
            if name.startswith("motion/") and name != "motion/chosen":
                continue
            np.testing.assert_allclose(mine[name], expected[name], rtol=0, atol=near, err_msg=name)
        moved = [
            np.einsum("sk,knc->snc", response["motion/amplitudes"], response["motion/shapes"])
            for response in (mine, expected)
        ]
        np.testing.assert_allclose(*moved, rtol=0, atol=1e-7 * np.abs(moved[1]).max())


@pytest.mark.long
def test_displacements_of_all_instants_are_not_held(tmp_path):
    def most(count):
        joint, cases = prepared(tmp_path, count=count)
        tracemalloc.start()
        full_transients(joint, [FullTransient(case=cases[0])])
        _, highest = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return highest, joint.model

    most(INSTANTS_AT_ONCE)  # imports and caches
    (few, model), (many, _) = most(2 * INSTANTS_AT_ONCE), most(8 * INSTANTS_AT_ONCE)
    history = 8 * 6 * INSTANTS_AT_ONCE * 3 * model.structure.n_dof
    # What 6 pieces more leave: contact forces and gaps, an eighth of the displacements and their
    # derivatives here, twice while they are joined, and instants to draw.
    assert many - few < 0.6 * history


def test_instants_that_do_not_fit_are_refused(tmp_path, monkeypatch):
    joint, cases = prepared(tmp_path, count=100 * INSTANTS_AT_ONCE)
    assert joint.period > 0  # factorizes
    monkeypatch.setenv(VARIABLE, "1e6")
    with pytest.raises(NotEnoughMemoryError, match="contact forces and gaps of 1 transients"):
        full_transients(joint, [FullTransient(case=cases[0])])
