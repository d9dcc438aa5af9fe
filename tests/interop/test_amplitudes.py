"""Loads with a course over time: CalculiX's displacements at the end of the steps, and ours."""

from dataclasses import replace

import numpy as np
import pytest
from calculix_runs import displacements, needs_calculix, solved

from faying.exceptions import FormatError
from faying.io.abaqus import read_joint

BRICK = """*NODE, NSET=NALL
1, 0., 0., 0.
2, 2., 0., 0.
3, 2., 3., 0.
4, 0., 3., 0.
5, 0., 0., 4.
6, 2., 0., 4.
7, 2., 3., 4.
8, 0., 3., 4.
*ELEMENT, TYPE=C3D8, ELSET=ALL
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=BASE
1, 2, 3, 4
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL
*BOUNDARY
BASE, 1, 3
*AMPLITUDE, NAME=RISE
0., 0., 1., 2., 4., 8.
*AMPLITUDE, NAME=TOTAL, TIME=TOTAL TIME
0., 1., 2., 3., 5., 9.
*AMPLITUDE, NAME=SHIFTED, SHIFTX=-1., SHIFTY=2.
0., 0., 3., 6.
*AMPLITUDE, NAME=SHORT
0., 0., 0.1, 500000.
"""


def step(*loads, length=1.0):
    head = f"*STEP\n*STATIC\n{length}, {length}\n"
    return head + "\n".join(loads) + "\n*NODE PRINT, NSET=NALL\nU\n*END STEP\n"


def force(name="", node=7, component=3, value=10.0):
    amplitude = f", AMPLITUDE={name}" if name else ""
    return f"*CLOAD{amplitude}\n{node}, {component}, {value}"


DECKS = {
    "step time": [step(force("RISE"), length=2.5)],
    "beyond the table": [step(force("RISE"), length=6.0)],
    "total time": [step(force("TOTAL"), length=1.0), step(force(node=5, component=1), length=2.0)],
    "kept": [step(force("RISE"), length=2.5), step(force(node=5, component=1), length=1.0)],
    "shifted": [step(force("SHIFTED"), length=1.0)],
    "far from one": [step(force("SHORT", value=1e-3))],
    "replaced": [step(force("RISE"), length=2.0), step(force(), length=2.0)],
    "pressure": [step("*DLOAD, AMPLITUDE=RISE\nALL, P2, 3.", force("SHIFTED"), length=2.0)],
}


@needs_calculix
@pytest.mark.parametrize("name", DECKS)
def test_loads_at_the_end_of_every_step(name, tmp_path):
    steps = DECKS[name]
    text = BRICK + "".join(steps)
    theirs = displacements(tmp_path, text)
    path = tmp_path / "job.inp"
    assert len(theirs) == len(steps)
    for number, motion in enumerate(theirs, start=1):
        assembly = read_joint(path, step=number).assembly
        (load,) = [assembly.loads[f"step {number}"]]
        ours = solved(replace(assembly, loads={"one": load}))
        expected = np.array([motion[node] for node in range(1, 9)])
        # Seven digits are printed.
        np.testing.assert_allclose(ours[:, :3], expected, atol=1e-6 * np.abs(expected).max())


def test_what_is_taken_is_said(tmp_path):
    path = tmp_path / "job.inp"
    path.write_text(BRICK + step(force("RISE"), length=2.5))
    notes = read_joint(path).assembly.ignored
    assert "AMPLITUDE=RISE of *CLOAD: times 5, its end in the step" in notes
    assert not any(note.endswith("*AMPLITUDE") for note in notes)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("AMPLITUDE=RISE", "AMPLITUDE=FALL"), "no \\*AMPLITUDE 'FALL'; known are RISE, TOTAL"),
        (("NAME=RISE", "NAME=RISE, VALUE=ABSOLUTE"), "VALUE=ABSOLUTE is not supported"),
        (("NAME=RISE", "NAME=RISE, DEFINITION=PERIODIC"), "DEFINITION=PERIODIC is not supported"),
        (("0., 0., 1., 2., 4., 8.", "0., 0., 1."), "found 3 numbers, expected pairs"),
        (("0., 0., 1., 2., 4., 8.", "1., 0., 0., 2."), "times do not increase"),
        (("NAME=TOTAL", "NAME=RISE"), "two amplitudes 'RISE'"),
    ],
)
def test_amplitudes_that_cannot_be_read(change, message, tmp_path):
    path = tmp_path / "job.inp"
    text = BRICK + step(force("RISE"))
    assert change[0] in text
    path.write_text(text.replace(*change))
    with pytest.raises(FormatError, match=message):
        read_joint(path)


def test_tables_that_nothing_uses_do_no_harm(tmp_path):
    path = tmp_path / "job.inp"
    path.write_text(BRICK.replace("NAME=SHORT", "NAME=SHORT, VALUE=ABSOLUTE") + step(force()))
    assert read_joint(path).assembly.loads
