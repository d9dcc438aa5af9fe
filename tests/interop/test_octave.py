"""The .mat hand-over in Octave: static cases, a transient, recovery and the jacobian."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from octave_runs import SAME, close, octave, run_octave
from programs import or_skip

import faying as fy
from faying.export.formats import export
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import NodalLoads
from faying.simulation.solution import Solution
from lap_joints import tiny_lap

LOADS = np.array([[0.0, 0.0, -500.0, 0.0, 0.0, 0.0], [200.0, 50.0, 900.0, 2e3, -1e3, 3e3]])
NAMES = tuple(f"tip.{name}" for name in ("Fx", "Fy", "Fz", "Mx", "My", "Mz"))
STEP, COUNT = 2e-5, 40

HARD = 1e-7
"""For hard contact on Gauss points: their forces are not unique, and those of a very stiff law are
picked through matrices of condition 1e7 (the proximal term)."""


@pytest.fixture(scope="module")
def program() -> str:
    return or_skip(octave)


def model_of(joint: fy.Model, kind: str) -> fy.ReducedModel:
    """Reduced models with penalty and hard contact, with and without residual compliance."""
    if kind == "hard":
        joint = joint.with_penalty(np.inf)
    basis = fy.craig_bampton(joint, normal_modes=10)
    return fy.reduce(joint, basis, compliance=kind != "plain")


@pytest.fixture(scope="module", params=["penalty", "hard", "plain"])
def rom(request, joint) -> fy.ReducedModel:
    return model_of(joint, request.param)


SCRIPT = """
joint = load('joint.mat');
state = faying_static(joint);
q0 = state.q; lambda0 = state.lambda;
loads = {loads};
for k = 1:2
  state = faying_static(joint, loads(k, :));
  statics(:, k) = state.q; forces(:, k) = state.lambda; gaps(:, k) = state.gap;
end
state = faying_static(joint);
for k = 1:{count}
  state = faying_step(joint, state, loads(1, :), {step});
  q(:, k) = state.q; v(:, k) = state.v; lambda(:, k) = state.lambda;
  [pressure(:, k), gap, ~, ends(:, k)] = faying_recover(joint, state.v, state.a, loads(1, :));
end
"""


def transient(system: fy.ReducedModel) -> Solution:
    load = fy.Load(dict(zip(NAMES, LOADS[0], strict=True)))
    return fy.solve_transient(system, load, step=STEP, duration=COUNT * STEP)


def test_same_solutions(program: str, rom: fy.ReducedModel, tmp_path: Path) -> None:
    export(rom, "mat", out=tmp_path / "joint.mat")
    points = HARD if np.isinf(rom.contact.penalty).any() else SAME
    script = SCRIPT.format(
        loads=np.array2string(LOADS, separator=",").replace("],", "];"), count=COUNT, step=STEP
    )
    found = run_octave(program, tmp_path, script)
    close(found["q0"][:, 0], fy.solve_static(rom).states)
    close(found["lambda0"][:, 0], fy.solve_static(rom).contact_forces, points)
    for case, forces in enumerate(LOADS):
        wanted = fy.solve_static(rom, fy.Load(dict(zip(NAMES, forces, strict=True))))
        close(found["statics"][:, case], wanted.states)
        close(found["forces"][:, case], wanted.contact_forces, points)
        close(found["gaps"][:, case], wanted.gap)
    history = transient(rom)
    close(found["q"], history.states[1:].T)
    close(found["lambda"], history.contact_forces[1:].T, points)
    recovered = fy.recover_pressure(rom, history)
    close(found["pressure"], recovered.pressure[1:].T, points)
    close(found["ends"], recovered.displacement("tip")[1:].T)


DECK_LOADS = """
joint = load('joint.mat');
tip = [0; 0; -100; 0; 0; 0];
state = faying_static(joint, [tip; 0.8; -2]);
q = state.q; pressure = state.lambda ./ joint.w;
recovered = faying_recover(joint, 0 * q, 0 * q, [tip; 0.8; -2]);
state = faying_static(joint);
for k = 1:5
  state = faying_step(joint, state, [tip; 0.8; -2], {step});
  steps(:, k) = state.q;
end
state = faying_static(joint, tip); alone = state.q;
state = faying_static(joint, [tip; 0; 0]); zero = state.q;
names = joint.load_names;
try, faying_static(joint, [tip; 1]); catch e, text = e.message; end
"""


def test_deck_loads_come_behind_the_boundary(program: str, joint: fy.Model, tmp_path: Path) -> None:
    loads = {
        "7": NodalLoads(nodes=[100, 101], forces=[[0, 40.0, -90.0, 0, 0, 0]] * 2),
        "step 2": NodalLoads(nodes=[60], forces=[[0, 0, 50.0, 0, 0, 0]]),
    }
    model = joint.with_load_patterns(loads)
    rom = model_of(model, "penalty")
    export(rom, "mat", out=tmp_path / "joint.mat")
    found = run_octave(program, tmp_path, DECK_LOADS.format(step=STEP))
    load = fy.Load({"tip.Fz": -100.0, "7": 0.8, "step 2": -2.0})
    static = fy.solve_static(rom, load)
    close(found["q"][:, 0], static.states)
    close(found["pressure"][:, 0], static.pressure)
    close(found["recovered"][:, 0], fy.solve_static(model, load).pressure)
    history = fy.solve_transient(rom, load, step=STEP, duration=5 * STEP)
    close(found["steps"], history.states[1:].T)
    np.testing.assert_array_equal(found["alone"], found["zero"])
    assert [str(name[0]) for name in found["names"].ravel()] == ["7", "step 2"]
    assert "found 7 loads, expected 6 at the boundary and then 2 factors" in str(found["text"])


JACOBIAN = """
joint = load('joint.mat');
state = faying_static(joint, [0; 0; -300; 0; 0; 0]);
[f, J, lambda, gap] = faying_contact(joint, state.q);
balance = joint.K * state.q + joint.E' * joint.N0 - f;
applied = balance(joint.boundary);
direction = sin((1:numel(f))') .* abs(state.q);
h = 1e-7;
up = faying_contact(joint, state.q + h * direction);
down = faying_contact(joint, state.q - h * direction);
slope = (up - down) / (2 * h);
tangent = J * direction;
asymmetry = norm(J - J');
forces = state.lambda;
"""


def test_hard_contact_of_a_plate_on_weak_springs(program: str, tmp_path: Path) -> None:
    """Eight-node facets have more points than displacements; the springs bring round-off."""
    plates = tiny_lap(plates=3, shape="hex20", penalty="hard").with_bolt_forces({"bolt": 1e4})
    given = fy.reduce(plates, fy.craig_bampton(plates, normal_modes=4), compliance=True)
    export(given, "mat", out=tmp_path / "joint.mat")
    found = run_octave(
        program, tmp_path, "joint = load('joint.mat'); forces = faying_static(joint).lambda;"
    )
    pairs, ours = (
        given.contact.at_pairs(forces)
        for forces in (found["forces"][:, 0], fy.solve_static(given).contact_forces)
    )
    # The springs yield a million times more than contact: so many digits less than round-off.
    close(pairs, ours, 1e-8)


def test_force_and_jacobian_of_a_state(program: str, joint: fy.Model, tmp_path: Path) -> None:
    export(model_of(joint, "penalty"), "mat", out=tmp_path / "joint.mat")
    found = run_octave(program, tmp_path, JACOBIAN)
    # The contact forces of a state are a difference of displacements times the penalty.
    np.testing.assert_allclose(
        found["lambda"], found["forces"], rtol=0, atol=1e-6 * found["forces"].max()
    )
    np.testing.assert_allclose(found["applied"][:, 0], [0, 0, -300, 0, 0, 0], atol=1e-3)
    # Piecewise linear: the difference quotient is exact but for cancellation.
    scale = np.abs(found["tangent"]).max()
    np.testing.assert_allclose(found["slope"], found["tangent"], rtol=0, atol=1e-5 * scale)
    assert found["asymmetry"] == 0.0


def test_hard_contact_without_compliance_is_refused(
    program: str, joint: fy.Model, tmp_path: Path
) -> None:
    hard = joint.with_penalty(np.inf)
    rom = fy.reduce(hard, fy.craig_bampton(hard, normal_modes=10))
    export(rom, "mat", out=tmp_path / "joint.mat")
    script = (
        "joint = load('joint.mat'); "
        "try, faying_contact(joint, joint.q0); catch e, text = e.message; end"
    )
    found = run_octave(program, tmp_path, script)
    assert "no force for a given q" in str(found["text"])


PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "export_to_matlab.md"


@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_a_joint_that_nothing_holds_begins_at_rest(
    program: str, tmp_path: Path, friction: float
) -> None:
    described = lap_joint_assembly(element_size=10.0, hole_radius=0.0, washer_radius=11.0)
    joint = fy.build_model(
        replace(described.assembly, supports=()),
        interfaces=described.interfaces,
        bolts=described.bolts,
        boundaries=described.boundaries,
    ).with_bolt_forces({"bolt": 5e3})
    joint = joint.with_friction(friction) if friction else fy.preload(joint, {"bolt": 5e3})
    rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=5), compliance=True)
    export(rom, "mat", out=tmp_path / "joint.mat")
    script = f"""
joint = load('joint.mat');
try, faying_static(joint); catch e, refusal = e.message; end
state = faying_rest(joint);
gap = state.gap; clear e;
for k = 1:8
  state = faying_step(joint, state, [0 0 300 0 0 0], {STEP});
  q(:, k) = state.q; lambda(:, k) = state.lambda;
end
"""
    found = run_octave(program, tmp_path, script)
    motion = fy.solve_transient(rom, fy.Load({"tip.Fz": 300.0}), step=STEP, duration=8 * STEP)
    close(found["q"], motion.states[1:].T)
    close(found["lambda"], motion.contact_forces[1:].T)
    close(found["gap"][:, 0], motion.gap[0])
    assert "begin with faying_rest" in str(found["refusal"])


def test_code_of_the_page_runs(program: str, joint: fy.Model, tmp_path: Path) -> None:
    export(model_of(joint, "penalty"), "mat", out=tmp_path / "joint.mat")
    code = re.findall(r"^```matlab\n(.*?)^```$", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    found = run_octave(program, tmp_path, "\n".join(code))
    assert found["pressure"].max() > 0
    assert found["recovered"].shape[1] == found["tip"].shape[1] == 50
    assert np.isfinite(found["acceleration"]).all()


def test_every_variable_is_in_the_table(rom: fy.ReducedModel, tmp_path: Path) -> None:
    export(rom, "mat", out=tmp_path / "joint.mat")
    export(rom, "npz", out=tmp_path / "joint.npz")
    text = PAGE.read_text("utf-8")
    mat = {name for name, _, _ in scipy.io.whosmat(tmp_path / "joint.mat")}
    npz = set(np.load(tmp_path / "joint.npz").files)
    assert mat - npz == {"N", "T"}
    for name in mat | npz:
        assert f"`{name}`" in text, name
