"""The hand-over of a joint with friction in Octave: paths, steps, recovery and the jacobian."""

from pathlib import Path

import numpy as np
import pytest
from octave_runs import SAME, close, octave, run_octave
from programs import or_skip

import faying as fy
from faying.assessment.slip import SLIP, slip_states
from faying.export.formats import export

STEP, COUNT = 2e-5, 20
NAMES = tuple(f"tip.{name}" for name in ("Fx", "Fy", "Fz", "Mx", "My", "Mz"))
LOADS = np.array(
    [
        [2500.0, 0.0, -200.0, 0.0, 0.0, 0.0],
        [-2500.0, 0.0, 300.0, 5e3, 0.0, 0.0],  # back over the first: points slip the other way
        [500.0, 400.0, 300.0, 0.0, -1e3, 3e3],
    ]
)


@pytest.fixture(scope="module")
def program() -> str:
    return or_skip(octave)


@pytest.fixture(scope="module")
def model() -> fy.Model:
    smooth = fy.lap_joint(
        element_size=5.0, penalty=1e6, damping=fy.Rayleigh(alpha=160.0, beta=5e-7)
    )
    tight = smooth.with_bolt_forces({"bolt": 10e3})
    return tight.with_friction(0.2, tangential_penalty=8e5)


@pytest.fixture(scope="module")
def rom(model: fy.Model) -> fy.ReducedModel:
    return fy.reduce(model, fy.craig_bampton(model, normal_modes=10), compliance=True)


def load(forces: np.ndarray) -> fy.Load:
    return fy.Load(dict(zip(NAMES, forces.tolist(), strict=True)))


SCRIPT = """
joint = load('joint.mat');
state = faying_static(joint);
rest = state.q - joint.q0; held = state.shear - joint.shear0; left = state.slip - joint.slip0;
tight = state;
loads = {loads};
for k = 1:rows(loads)
  state = faying_static(joint, loads(k, :), joint.N0, state);
  q(:, k) = state.q; lambda(:, k) = state.lambda; gaps(:, k) = state.gap;
  shear(:, :, k) = state.shear; slip(:, :, k) = state.slip;
end
state = tight; known = tight;
for k = 1:{count}
  state = faying_step(joint, state, loads(1, :), {step});
  moved(:, k) = state.q; pressed(:, k) = state.lambda; pulled(:, :, k) = state.shear;
  [pressure(:, k), ~, ~, ends(:, k), known] = ...
    faying_recover(joint, state.v, state.a, loads(1, :), joint.N0, known);
  found(:, :, k) = known.shear;
end
try, faying_recover(joint, state.v, state.a, loads(1, :)); catch e, refusal = e.message; end
try, faying_contact(joint, state.q); catch e, refused = e.message; end
traction = (joint.tangents1 .* shear(:, 1, 1) + joint.tangents2 .* shear(:, 2, 1)) ./ joint.w;
clear known tight e;
"""


def written(rom: fy.ReducedModel, folder: Path) -> str:
    export(rom, "mat", out=folder / "joint.mat")
    loads = np.array2string(LOADS, separator=",").replace("],", "];")
    return SCRIPT.format(loads=loads, count=COUNT, step=STEP)


@pytest.mark.long
def test_paths_steps_and_recovery(
    program: str, model: fy.Model, rom: fy.ReducedModel, tmp_path: Path
) -> None:
    found = run_octave(program, tmp_path, written(rom, tmp_path))
    tight = fy.solve_path(rom, [fy.Load()])
    assert np.abs(found["rest"]).max() <= SAME * np.abs(tight.states).max()
    assert np.abs(found["held"]).max() <= SAME * np.abs(tight.shear_forces).max()
    assert np.abs(found["left"]).max() <= SAME * np.abs(tight.shear_slip).max()
    path = fy.solve_path(rom, [load(forces) for forces in LOADS], initial=tight)
    assert (slip_states(path, tight).status == SLIP).any(axis=1).all()
    close(found["q"], path.states.T)
    close(found["lambda"], path.contact_forces.T)
    close(found["gaps"], path.gap.T)
    close(found["shear"], path.shear_forces.T)
    close(found["slip"], path.shear_slip.T)
    close(found["traction"], path.traction[0])
    options = {"step": STEP, "duration": COUNT * STEP, "initial": tight}
    history = fy.solve_transient(rom, load(LOADS[0]), **options)
    close(found["moved"], history.states[1:].T)
    close(found["pressed"], history.contact_forces[1:].T)
    close(found["pulled"], history.shear_forces[1:].T)
    recovered = fy.recover_pressure(model, history)
    close(found["pressure"], recovered.pressure[1:].T)
    close(found["found"], recovered.shear_forces[1:].T)
    close(found["ends"], recovered.displacement("tip")[1:].T)
    assert "give the state of the last one" in str(found["refusal"])
    assert "give the state of the step before" in str(found["refused"])


def test_hard_contact_with_friction(program: str, model: fy.Model, tmp_path: Path) -> None:
    """Nodal points, at which rigid forces are unique."""
    smooth = fy.lap_joint(element_size=5.0, penalty=np.inf, quadrature="nodal")
    hard = smooth.with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    rom = fy.reduce(hard, fy.craig_bampton(hard, normal_modes=5), compliance=True)
    assert np.isinf(rom.contact.laws["joint"].tangential_penalty)
    found = run_octave(program, tmp_path, written(rom, tmp_path).split("state = tight")[0])
    tight = fy.solve_path(rom, [fy.Load()])
    path = fy.solve_path(rom, [load(forces) for forces in LOADS], initial=tight)
    close(found["q"], path.states.T)
    close(found["lambda"], path.contact_forces.T)
    close(found["shear"], path.shear_forces.T)


JACOBIAN = """
joint = load('joint.mat');
before = faying_static(joint);
state = faying_static(joint, [{loads}], joint.N0, before);
[f, J, lambda, gap, after] = faying_contact(joint, state.q, before);
balance = joint.K * state.q + joint.E' * joint.N0 - f;
applied = balance(joint.boundary);
direction = sin((1:numel(f))') .* abs(state.q - before.q);
h = 1e-6;
up = faying_contact(joint, state.q + h * direction, before);
down = faying_contact(joint, state.q - h * direction, before);
slope = (up - down) / (2 * h);
tangent = J * direction;
asymmetry = norm(J - J') / norm(J);
moved = after.slip - state.slip; slipped = state.slip;
clear before after;
"""


def test_force_and_jacobian_of_a_state(program: str, rom: fy.ReducedModel, tmp_path: Path) -> None:
    export(rom, "mat", out=tmp_path / "joint.mat")
    script = JACOBIAN.format(loads="; ".join(map(str, LOADS[0])))
    found = run_octave(program, tmp_path, script)
    # Contact forces of a state are a difference of displacements times the penalty.
    np.testing.assert_allclose(found["applied"][:, 0], LOADS[0], atol=1e-3)
    scale = np.abs(found["tangent"]).max()
    # Second order in a step of 1e-6 of the displacements, and cancellation: 6e-11 is measured.
    np.testing.assert_allclose(found["slope"], found["tangent"], rtol=0, atol=1e-6 * scale)
    assert found["asymmetry"] > 1e-3  # 0.08: some points slip
    slipped = np.abs(found["slipped"]).max()
    np.testing.assert_allclose(found["moved"], 0.0, atol=SAME * slipped)
