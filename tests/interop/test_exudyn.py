"""Exudyn simulates the joint it was handed; we agree with what it finds."""

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import faying as fy
from faying.assessment.recovery import balanced_accelerations
from faying.exceptions import StudyError
from faying.export.formats import export
from faying.model.assembly import NodalLoads
from faying.reduction.projection import for_moving_supports

exu = pytest.importorskip("exudyn", reason="Exudyn is not installed")

EXAMPLES = Path(__file__).parents[2] / "examples"
sys.path.insert(0, str(EXAMPLES))
import exudyn_swing as swing  # noqa: E402
from exudyn.itemInterface import (  # noqa: E402
    GenericJoint,
    MarkerBodyRigid,
    MarkerNodeRigid,
    ObjectGround,
)

# Exudyn's own deprecations
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

LC2 = {"tip.Fz": -500.0, "tip.Mx": 20e3}


@pytest.fixture(scope="module")
def rom(joint, classic):
    return fy.reduce(joint, classic, compliance=True)


@pytest.fixture(scope="module")
def given(joint, rom):
    return for_moving_supports(joint, rom)


@pytest.fixture(scope="module")
def module(given, tmp_path_factory):
    files = export(given, "exudyn", out=tmp_path_factory.mktemp("exudyn") / "swung-joint.py")
    assert [file.name for file in files] == ["swung_joint.py", "swung_joint.npz"]
    return swing.imported(files[0])


@pytest.fixture(scope="module")
def springs(joint, tmp_path_factory):
    """A basis with joint modes and a soft penalty, without residual compliance."""
    soft = joint.with_penalty(1e4)
    rom = fy.reduce(soft, fy.jim_a(soft, joint_modes=8))
    given = replace(rom, method="jim-a")
    file, _ = export(given, "exudyn", out=tmp_path_factory.mktemp("springs") / "springs.py")
    return given, swing.imported(file)


def settings(step, steps, rho=0.8):
    chosen = exu.SimulationSettings()
    chosen.timeIntegration.numberOfSteps = steps
    chosen.timeIntegration.endTime = steps * step
    chosen.timeIntegration.generalizedAlpha.spectralRadius = rho
    chosen.solution.file.write = False
    chosen.solution.sensors.writePeriod = step
    return chosen


def stepped(module, loads, step, steps, *, jacobian=True):
    """Simulate the joint with its supports at rest; return states and outputs."""
    mbs = exu.SystemContainer().AddSystem()
    added = module.add_joint(mbs, jacobian=jacobian)
    for name, load in loads.items():
        module.add_load(mbs, added, name, load)
    watched = module.add_sensors(mbs, added)
    mbs.Assemble()
    mbs.SolveDynamic(settings(step, steps))
    return [mbs.GetSensorStoredData(n)[:, 1:] for n in (watched.position, watched.outputs)]


def rising(values, step, steps):
    """Loads that rise within ten steps, as functions for Exudyn and as a load.

    From a jump the two start otherwise: ours averages the first acceleration over the first step.
    """

    def course(value):
        return lambda t: value * np.sin(0.5 * np.pi * np.minimum(t / (10 * step), 1.0)) ** 2

    times, functions = step * np.arange(steps + 1), {k: course(v) for k, v in values.items()}
    return functions, fy.Load({k: fy.History(times, f(times)) for k, f in functions.items()})


def test_preloaded_state_is_ours(given, module):
    forces = module.joint().contact_forces(fy.solve_static(given).states)
    # Round-off of one system of 100 points.
    np.testing.assert_allclose(
        forces, fy.solve_static(given).contact_forces, atol=1e-9 * forces.max(), rtol=0
    )


@pytest.mark.parametrize("load", [{}, {"tip.Fz": -500.0}, LC2], ids=["preload", "lc1", "lc2"])
def test_static_response(given, module, load):
    mbs = exu.SystemContainer().AddSystem()
    added = module.add_joint(mbs)
    for name, value in load.items():
        module.add_load(mbs, added, name, value)
    mbs.Assemble()
    chosen = exu.SimulationSettings()
    chosen.staticSolver.newton.relativeTolerance = 1e-12
    chosen.staticSolver.numberOfLoadSteps = 1
    chosen.solution.file.write = False
    mbs.SolveStatic(chosen)
    q = mbs.GetNodeOutput(added.node, exu.OutputVariableType.Coordinates)
    own = fy.solve_static(given, fy.Load(load))
    # Newton on piecewise linear equations ends exact; round-off times the condition of K.
    np.testing.assert_allclose(q, own.states, atol=1e-9 * np.abs(own.states).max(), rtol=0)
    found = module.joint().outputs(q)
    expected = [own.max_pressure, own.contact_force("joint"), own.bolt_force("bolt")]
    np.testing.assert_allclose(found, expected, rtol=1e-8)
    assert module.joint().output_names() == ["max_pressure", "joint.clamp", "bolt.N"]


@pytest.mark.parametrize(
    ("kind", "steps", "near"),
    # The joint modes' stiffness adds a digit to the condition.
    [("compliance", 100, 1e-6), ("springs", 50, 1e-5)],
)
def test_step_response_is_that_of_our_integrator(given, module, springs, kind, steps, near):
    given, module = (given, module) if kind == "compliance" else springs
    functions, load = rising(LC2, 1e-5, steps)
    q, outputs = stepped(module, functions, 1e-5, steps)
    own = fy.solve_transient(
        given,
        load,
        step=1e-5,
        duration=1e-5 * steps,
        integrator=fy.GeneralizedAlpha(rho_infinity=0.8),
    )
    assert own.max_pressure.max() > 1.5 * own.max_pressure[0] or kind == "springs"
    # The same scheme, for Exudyn's algorithmic acceleration (Arnold & Brüls 2007) weighs forces as
    # Chung & Hulbert's balance between instants does. Newton stops at 1e-8.
    np.testing.assert_allclose(q, own.states, atol=near * np.abs(own.states).max(), rtol=0)
    np.testing.assert_allclose(
        outputs[:, 0], own.max_pressure, atol=near * own.max_pressure.max(), rtol=0
    )
    np.testing.assert_allclose(outputs[:, 1], own.contact_force(), rtol=near)
    np.testing.assert_allclose(outputs[:, 2], own.bolt_force("bolt"), rtol=near)


@pytest.mark.parametrize("kind", ["compliance", "springs"])
def test_jacobian_is_the_derivative_of_the_force(given, module, springs, kind):
    given, module = (given, module) if kind == "compliance" else springs
    joint = module.joint()
    q = fy.solve_static(given, fy.Load(LC2)).states
    unused = np.zeros_like(q)
    exact = joint.jacobian(None, 0.0, 0, q, unused, 3.0, 7.0)
    width = 1e-7 * np.abs(q).max()
    differences = np.empty_like(exact)
    for n, direction in enumerate(np.eye(len(q))):
        # Coordinates move the joint by very different amounts.
        h = width / max(np.abs(joint.G @ direction).max(), 1e-3)
        ahead, behind = (
            joint.force(None, 0.0, 0, q + sign * h * direction, unused) for sign in (1, -1)
        )
        differences[:, n] = -3.0 * (ahead - behind) / (2 * h)
    scale = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
    # Piecewise linear, so exact but for round-off in forces of 1e4 N over steps of 1e-8 mm times
    # stiffnesses of 1e6 N/mm.
    assert (np.abs(differences - exact) / scale.max()).max() < 1e-6
    np.testing.assert_allclose(exact, exact.T, atol=1e-9 * np.abs(exact).max())


def test_remembered_inverse_stays_exact(module):
    """Many small changes of the active set leave no drift."""
    joint = module.joint()
    rng = np.random.default_rng(4)
    walk = 1e-3 * rng.standard_normal((200, 1)).cumsum(axis=0)
    shape = rng.standard_normal(len(joint.gap0))
    for factor in walk:
        gap = joint.gap0 - 1e-3 + factor * shape
        forces = joint.contact.solve(gap)
        slack = joint.contact.flexibility @ forces + gap
        # Drift of the updated inverse is stopped at 1e-11 of the largest gap.
        assert slack.min() > -1e-10 * np.abs(gap).max()
        assert np.abs(slack * forces).max() < 1e-10 * np.abs(gap).max() * forces.max()
        assert forces.min() >= 0


def test_inertia_terms_are_those_exudyn_computes(joint, given, module):
    from exudyn.FEM import ObjectFFRFreducedOrderInterface
    from scipy.sparse import kron

    at = np.array([-55.0, 1.0, 3.0])
    mass = sum(joint.nodal_mass[axis::6][:, axis::6] for axis in range(3)) / 3
    full = kron(mass, np.eye(3)).tocsr()

    class Mesh:
        """As much of FEMinterface as is asked for."""

        def __init__(self):
            self.modeBasis = {"matrix": given.mesh.modes.reshape(len(given.mesh.modes), -1).T}
            self.postProcessingModes = {}

        def GetNodePositionsAsArray(self):  # noqa: N802
            return given.mesh.nodes - at

        def GetSurfaceTriangles(self):  # noqa: N802
            return []

        GetSurfaceTriangles6 = GetSurfaceTriangles

        def GetMassMatrix(self, sparse):  # noqa: N802
            return full

        GetStiffnessMatrix = GetMassMatrix

    reference = ObjectFFRFreducedOrderInterface(Mesh())
    components = np.transpose(given.mesh.modes, (1, 0, 2)).reshape(len(given.mesh.nodes), -1)
    fields = np.column_stack([np.ones(len(given.mesh.nodes)), given.mesh.nodes, components])
    found = module.inertia(fields.T @ (mass @ fields), at)
    stored = module.inertia(given.invariants, at)
    for name in (key for key in found if key.startswith("m") and key != "mass"):
        expected = getattr(reference, name)
        scale = np.abs(expected).max()
        np.testing.assert_allclose(found[name], expected, atol=1e-12 * scale)  # round-off
        # What is stored also has the rotary inertia of the bolt's beam.
        np.testing.assert_allclose(stored[name], expected, atol=3e-3 * scale)
    np.testing.assert_allclose(stored["mass"], reference.totalMass, rtol=1e-12)
    np.testing.assert_allclose(stored["centerOfMass"], reference.chiU, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(stored["inertia"], reference.inertiaLocal, rtol=1e-9, atol=1e-9)


@pytest.mark.long
def test_swinging_arm():
    """Small version of the example: 5 mm bricks, 10 normal modes, one period and a quarter."""
    arm = swing.arm(element_size=5.0, normal_modes=10)
    coarse, fine = (swing.differences(*arm, step, periods=1.25) for step in (2e-4, 1e-4))
    assert fine["max_pressure"] > 2 * fine["preload_pressure"]
    # Basis of 10 normal modes in the loop; recovery lacks what the deformation adds (3e-3). Exact
    # to 0.9 % in the largest, 0.1 % in the mean when this was written.
    assert fine["recovered"] < 1.5e-2
    assert fine["recovered_rms"] < 2e-3
    # Second order in the step, 1.2e-3 at 1e-4 s.
    assert fine["with_deformation"] < 2e-3
    assert fine["with_deformation"] < 0.5 * coarse["with_deformation"]


def test_swinging_needs_the_motion_of_the_frame(given, module):
    found = swing.simulate(module, 2e-4, periods=1.0)
    still = fy.recover_from_modal(
        given.recovery,
        found.times,
        found.q,
        fy.Load(),
        velocities=found.q_t,
        accelerations=found.q_tt,
    )
    back = swing.recovered(given, found)
    frame = module.frame_fields(*_frame(swing.frame_motion(found.times)))
    there = module.joint().recover(found.q_t, found.q_tt, frame=frame)
    # The same matrices in two programs.
    np.testing.assert_allclose(there, back.pressure, atol=1e-6 * back.pressure.max())
    errors = [np.abs(one.pressure - found.pressure).max() for one in (still, back)]
    assert errors[1] < 0.1 * errors[0]


def _frame(motion):
    return motion.acceleration, motion.angular_velocity, motion.angular_acceleration


def test_pendulum_under_gravity_keeps_its_period(given, module):
    """A stiff arm falls like a rigid pendulum: period from mass, centre and inertia alone."""
    mbs = exu.SystemContainer().AddSystem()
    added = module.add_body(mbs, frame=tuple(swing.PIVOT), gravity=(0.0, 0.0, -9810.0))
    ground = mbs.AddObject(ObjectGround(referencePosition=list(swing.PIVOT)))
    markers = [
        mbs.AddMarker(MarkerBodyRigid(bodyNumber=ground)),
        mbs.AddMarker(MarkerNodeRigid(nodeNumber=added.frame)),
    ]
    mbs.AddObject(GenericJoint(markerNumbers=markers, constrainedAxes=[1, 1, 1, 1, 0, 1]))
    mbs.Assemble()
    mbs.SolveDynamic(settings(1e-3, 20, rho=0.5))
    turned = mbs.GetNodeOutput(added.frame, exu.OutputVariableType.Rotation)[1]
    terms = module.inertia(given.invariants, swing.PIVOT)
    torque = terms["mass"] * 9810.0 * terms["centerOfMass"][0]
    # ½ α t² with the fall still small: cos of 0.02 rad and the steps' first error, 2e-3.
    assert turned == pytest.approx(0.5 * torque / terms["inertia"][1, 1] * 0.02**2, rel=5e-3)


def test_force_on_a_body_turns_it(module, given):
    mbs = exu.SystemContainer().AddSystem()
    added = module.add_body(mbs, frame=tuple(swing.PIVOT))
    loads = module.add_load(mbs, added, "tip.Fx", 100.0)
    assert len(loads) == 1
    with pytest.raises(ValueError, match="is a moment"):
        module.add_load(mbs, added, "tip.Mx", 1.0)
    mbs.Assemble()
    mbs.SolveDynamic(settings(1e-4, 20, rho=0.5))
    moved = mbs.GetNodeOutput(added.frame, exu.OutputVariableType.Displacement)
    mass = given.invariants[0, 0]
    # Free flight along the arm, ½ F/m t², less than the arm's elastic stretch of 1e-4 mm.
    assert moved[0] == pytest.approx(0.5 * 100.0 / mass * 2e-3**2, rel=5e-3)


def test_two_joints_in_one_system_do_not_disturb_each_other(given, module):
    mbs = exu.SystemContainer().AddSystem()
    loads = [rising(case, 2e-5, 30) for case in (LC2, {"tip.Fz": 500.0})]
    watched = []
    for functions, _ in loads:
        added = module.add_joint(mbs)
        for name, value in functions.items():
            module.add_load(mbs, added, name, value)
        watched.append(module.add_sensors(mbs, added).position)
    mbs.Assemble()
    mbs.SolveDynamic(settings(2e-5, 30))
    for (_, load), sensor in zip(loads, watched, strict=True):
        own = fy.solve_transient(
            given,
            load,
            step=2e-5,
            duration=6e-4,
            integrator=fy.GeneralizedAlpha(rho_infinity=0.8),
        )
        # As for one.
        found = mbs.GetSensorStoredData(sensor)[:, 1:]
        np.testing.assert_allclose(found, own.states, atol=1e-6 * np.abs(own.states).max(), rtol=0)


def test_deck_loads_and_their_recovery(joint, tmp_path):
    """A load on many nodes is a load on every coordinate, here as a function of time."""
    loads = {"7": NodalLoads(nodes=[100, 101], forces=[[0, 60.0, -150.0, 0, 0, 0]] * 2)}
    model = joint.with_load_patterns(loads)
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=10), compliance=True)
    rom = for_moving_supports(model, rom)
    own = swing.imported(export(rom, "exudyn", out=tmp_path / "loaded.py")[0])
    slope, step, steps = 4e3, 2e-5, 25
    functions, load = rising({"tip.Fz": -100.0}, step, steps)
    q, _ = stepped(own, {**functions, "7": lambda t: slope * t}, step, steps)
    ours = fy.solve_transient(
        rom,
        fy.Load({**load.forces, "7": fy.History([0.0, 1.0], [0.0, slope])}),
        step=step,
        duration=steps * step,
        integrator=fy.GeneralizedAlpha(rho_infinity=0.8),
    )
    # As in the step response above.
    np.testing.assert_allclose(q, ours.states, atol=1e-6 * np.abs(ours.states).max(), rtol=0)
    recovered = own.joint().recover(
        ours.velocities,
        balanced_accelerations(rom, ours),
        {"tip.Fz": functions["tip.Fz"](ours.times), "7": slope * ours.times},
    )
    wanted = fy.recover_pressure(model, ours).pressure
    # Round-off of contact problems of 100 points.
    np.testing.assert_allclose(recovered, wanted, rtol=0, atol=1e-8 * wanted.max())
    mbs = exu.SystemContainer().AddSystem()
    with pytest.raises(ValueError, match="'7' is a load of the deck; on a body only forces"):
        own.add_load(mbs, own.add_body(mbs), "7", 1.0)
    with pytest.raises(ValueError, match=r"has no load '8'; its loads are .*tip\.Mz, 7$"):
        own.add_load(mbs, own.add_joint(mbs), "8", 1.0)


def test_unknown_load_is_named(module):
    with pytest.raises(ValueError, match=r"no load 'tip\.Fq'; its loads are tip\.Fx"):
        module.joint().boundary_forces("tip.Fq")


def test_hard_contact_needs_compliance(joint, classic, tmp_path):
    hard = joint.with_penalty(np.inf)
    with pytest.raises(StudyError, match="compliance"):
        export(fy.reduce(hard, classic), "exudyn", out=tmp_path / "hard.py")


def test_hard_contact_with_compliance(joint, classic, tmp_path):
    given = fy.reduce(joint.with_penalty(np.inf), classic, compliance=True)
    module = swing.imported(export(given, "exudyn", out=tmp_path / "hard_joint.py")[0])
    found = module.joint().contact_forces(fy.solve_static(given).states).sum()
    # A millionth of the points' own compliance stands for rigid.
    assert found == pytest.approx(fy.solve_static(given).contact_forces.sum(), rel=1e-4)


def test_module_does_not_need_faying(module):
    folder, text = Path(module.__file__).parent, Path(module.__file__).read_text(encoding="utf-8")
    assert not re.search(r"^\s*(import|from) faying", text, re.MULTILINE)
    code = (
        f"import sys; sys.modules['faying'] = None; sys.path.insert(0, {str(folder)!r}); "
        "import swung_joint; print(swung_joint.joint().n_mode)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600
    )
    assert done.stdout.strip() == "17"
