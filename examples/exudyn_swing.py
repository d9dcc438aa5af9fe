"""A bolted arm that swings: contact in the loop in Exudyn, pressures recovered from its motion.

Run it with ``python examples/exudyn_swing.py``; it needs ``pip install exudyn`` and two minutes.
The lap joint of the default cantilever is an arm whose clamped end a drive turns to and fro, 60
times a second by ±20°; its own inertia bends the joint, tightened to no more than 3 kN. The arm is
a flexible body in a floating frame (``ObjectFFRFreducedOrder``) with the contact of the joint on
its modal coordinates. What comes back is compared three times:

* *recovered*: pressures of the full model from q̇, q̈ and the motion of the frame, with the pressures
  that the contact in the loop had;
* *inertia loads*: our own integration of the same reduced model, at rest under the loads that the
  accelerations of the frame exert on the undeformed arm;
* *with deformation*: the same with what the deformation adds to them, centrifugal, Euler and
  Coriolis terms of finite element matrices, found by repeating the integration.
"""

import importlib.util
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

import numpy as np

import faying as fy
from faying._typing import Matrix, Vector
from faying.assessment.recovery import Recovered
from faying.export.formats import export
from faying.model.boundary import Boundary
from faying.reduction.projection import for_moving_supports
from faying.simulation.frame_motion import FrameMotion, frame_loads

PRELOAD = 3e3
PIVOT = np.array([-55.0, 0.0, 0.0])
AMPLITUDE, FREQUENCY = np.deg2rad(20.0), 60.0
PERIOD = 1 / FREQUENCY
RHO = 0.6
"""Spectral radius of generalized-α in both programs."""


@dataclass(frozen=True, kw_only=True)
class Swing:
    """A simulated swing.

    Attributes
    ----------
    times : (n_time,)
    q, q_t, q_tt : (n_time, n_mode)
    outputs : (n_time, 3)
        Largest pressure, clamp force, bolt force, computed inside Exudyn.
    pressure : (n_time, n_point)
        Contact in the loop.
    """

    times: Vector
    q: Matrix
    q_t: Matrix
    q_tt: Matrix
    outputs: Matrix
    pressure: Matrix


def arm(element_size: float = 2.5, normal_modes: int = 20) -> tuple[fy.Model, fy.ReducedModel]:
    """Build, tighten and reduce the joint; return it and its reduced model for a moving frame."""
    damping = fy.Rayleigh(alpha=160.0, beta=5e-7)
    model = fy.lap_joint(element_size=element_size, damping=damping)
    tightened = fy.preload(model, {"bolt": PRELOAD}, sticking=fy.Sticking())
    basis = fy.craig_bampton(tightened, normal_modes=normal_modes)
    rom = fy.reduce(tightened, basis, compliance=True)
    return tightened, for_moving_supports(tightened, rom)


def angle(t: Vector | float) -> tuple[Vector, Vector, Vector]:
    """Return angle, angular velocity and acceleration of the drive: a sine that grows smoothly."""
    x = np.minimum(np.asarray(t, dtype=float) / PERIOD, 1.0)
    grown = x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3)
    growing = 140 * x**3 * (1 - x) ** 3 / PERIOD
    changing = 420 * x**2 * (1 - x) ** 2 * (1 - 2 * x) / PERIOD**2
    w = 2 * np.pi * FREQUENCY
    sine, cosine = np.sin(w * np.asarray(t)), np.cos(w * np.asarray(t))
    return (
        AMPLITUDE * sine * grown,
        AMPLITUDE * (w * cosine * grown + sine * growing),
        AMPLITUDE * (-(w**2) * sine * grown + 2 * w * cosine * growing + sine * changing),
    )


def frame_motion(times: Vector) -> FrameMotion:
    """Return how the frame moves, in its own axes: about y, the pivot at rest."""
    _, velocity, gain = angle(times)
    zero = np.zeros_like(times)
    turning, gaining = (np.column_stack([zero, rate, zero]) for rate in (velocity, gain))
    arm_to_origin = -PIVOT
    acceleration = np.cross(gaining, arm_to_origin)
    acceleration += np.cross(turning, np.cross(turning, arm_to_origin))
    return FrameMotion(
        acceleration=acceleration, angular_velocity=turning, angular_acceleration=gaining
    )


def imported(path: Path) -> ModuleType:
    """Import the module that was handed over, wherever it is."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module


def simulate(joint: ModuleType, step: float, periods: float = 2.0) -> Swing:
    """Swing the arm in Exudyn; knows nothing of faying but the module it was handed."""
    import exudyn as exu
    from exudyn.itemInterface import GenericJoint, MarkerBodyRigid, MarkerNodeRigid, ObjectGround

    mbs = exu.SystemContainer().AddSystem()
    added = joint.add_body(mbs, frame=tuple(PIVOT))
    ground = mbs.AddObject(ObjectGround(referencePosition=list(PIVOT)))
    markers = [
        mbs.AddMarker(MarkerBodyRigid(bodyNumber=ground)),
        mbs.AddMarker(MarkerNodeRigid(nodeNumber=added.frame)),
    ]

    def drive(_mbs, t, _item, _parameters):
        return [0, 0, 0, 0, float(angle(t)[0]), 0]

    mbs.AddObject(
        GenericJoint(markerNumbers=markers, constrainedAxes=[1] * 6, offsetUserFunction=drive)
    )
    watched = joint.add_sensors(mbs, added)
    mbs.Assemble()

    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps = round(periods * PERIOD / step)
    integration.endTime = integration.numberOfSteps * step
    integration.generalizedAlpha.spectralRadius = RHO
    integration.newton.useModifiedNewton = False
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = step
    mbs.SolveDynamic(settings)

    stored = mbs.GetSensorStoredData
    q = stored(watched.position)
    return Swing(
        times=q[:, 0],
        q=q[:, 1:],
        q_t=stored(watched.velocity)[:, 1:],
        q_tt=stored(watched.acceleration)[:, 1:],
        outputs=stored(watched.outputs)[:, 1:],
        pressure=np.array([joint.joint().pressure(row) for row in q[:, 1:]]),
    )


def recovered(rom: fy.ReducedModel, swing: Swing) -> Recovered:
    """Recover the pressures of the full model from the motion alone."""
    return fy.recover_from_modal(
        rom.recovery,
        swing.times,
        swing.q,
        fy.Load(),
        velocities=swing.q_t,
        accelerations=swing.q_tt,
        frame_motion=frame_motion(swing.times),
    )


def integrated(model: fy.Model, rom: fy.ReducedModel, times: Vector, passes: int) -> fy.Solution:
    """Integrate the reduced model ourselves, at rest under the inertia loads of the frame.

    The first pass loads the undeformed arm; each further one adds what the deformation found
    before contributes.
    """
    motion = frame_motion(times)
    turning = _cross(motion.angular_velocity)
    matrix = _cross(motion.angular_acceleration) + turning @ turning
    coupling = rom.basis.vectors.T @ frame_loads(model)
    pairs = _component_masses(model, rom)
    names = [f"q{n}" for n in range(len(rom.K))]
    own = replace(
        rom,
        boundaries={
            name: Boundary(name=name, nodes=[n], components=[0], dofs=[n])
            for n, name in enumerate(names)
        },
    )
    load = -motion.fields() @ coupling.T
    added = np.zeros_like(load)
    for _ in range(passes):
        total = load - added
        forces = {f"{name}.Fx": fy.History(times, total[:, n]) for n, name in enumerate(names)}
        solution = fy.solve_transient(
            own,
            fy.Load(forces),
            step=times[1] - times[0],
            duration=times[-1],
            integrator=fy.GeneralizedAlpha(RHO),
        )
        added = np.einsum("tij,ijmn,tn->tm", matrix, pairs, solution.states)
        added += 2 * np.einsum("tij,ijmn,tn->tm", turning, pairs, solution.velocities)
    return solution


def _component_masses(model: fy.Model, rom: fy.ReducedModel) -> Matrix:
    """Φᵀ M E_ij Φ (3, 3, n_mode, n_mode), E_ij putting component j of a displacement into i."""
    nodal = model.dofs.transformation @ rom.basis.vectors
    heavy = model.nodal_mass @ nodal
    components = nodal.reshape(-1, 6, len(rom.K))
    pairs = np.zeros((3, 3, len(rom.K), len(rom.K)))
    for i in range(3):
        for j in range(3):
            moved = np.zeros_like(components)
            moved[:, i] = components[:, j]
            pairs[i, j] = heavy.T @ moved.reshape(nodal.shape)
    return pairs


def _cross(vectors: Matrix) -> Matrix:
    return -np.cross(vectors[:, None, :], np.eye(3)).transpose(0, 1, 2)


def differences(
    model: fy.Model, rom: fy.ReducedModel, step: float, periods: float = 2.0
) -> dict[str, float]:
    """Return the differences, relative to the largest pressure in the loop, and that pressure."""
    with tempfile.TemporaryDirectory() as folder:
        module, _ = export(rom, "exudyn", out=Path(folder) / "arm.py")
        swing = simulate(imported(module), step, periods)
    largest = swing.pressure.max()

    def largest_difference(pressure: Matrix) -> float:
        return float(np.abs(pressure - swing.pressure).max() / largest)

    back = recovered(rom, swing)
    return {
        "preload_pressure": float(swing.pressure[0].max()),
        "max_pressure": float(largest),
        "max_pressure_recovered": float(back.pressure.max()),
        "smallest_clamp_force": float(swing.outputs[:, 1].min()),
        "recovered": largest_difference(back.pressure),
        "recovered_rms": float(np.sqrt(np.mean((back.pressure - swing.pressure) ** 2)) / largest),
        "inertia_loads": largest_difference(integrated(model, rom, swing.times, 1).pressure),
        "with_deformation": largest_difference(integrated(model, rom, swing.times, 3).pressure),
    }


def main() -> None:
    """Print the differences at two steps."""
    model, rom = arm()
    for step in (4e-5, 2e-5):
        print(f"step {step:g} s")  # noqa: T201
        for name, value in differences(model, rom, step).items():
            print(f"  {name:24s} {value:.3g}")  # noqa: T201


if __name__ == "__main__":
    main()
