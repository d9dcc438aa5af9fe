"""Supports that move: fields, loads, recovery, and the columns of a history that tell of them."""

from dataclasses import replace

import h5py
import numpy as np
import pytest

import faying as fy
from faying.exceptions import FormatError, ModelError, StudyError
from faying.model.matrices import mass_properties, rigid_body_motions
from faying.reduction.projection import for_moving_supports
from faying.simulation.frame_motion import FrameMotion, affine_fields
from faying.study.results.values import Results
from faying.study.stages.imported_history import FRAME, read_imported_history
from faying.study.stages.recover import RecoverOptions, recover

RNG = np.random.default_rng(7)


@pytest.fixture(scope="module")
def given(joint, classic):
    return for_moving_supports(joint, fy.reduce(joint, classic, compliance=True))


def motion_of(values):
    values = np.asarray(values, dtype=float)
    return FrameMotion(
        acceleration=values[:, :3],
        angular_velocity=values[:, 3:6],
        angular_acceleration=values[:, 6:],
    )


def test_fields_are_the_accelerations_of_the_points():
    nodes, values = RNG.standard_normal((5, 3)), RNG.standard_normal((4, 9))
    fields = motion_of(values).fields() @ affine_fields(nodes).T
    for found, (a, w, alpha) in zip(fields, values.reshape(-1, 3, 3), strict=True):
        expected = a + np.cross(alpha, nodes) + np.cross(w, np.cross(w, nodes))
        # Round-off.
        np.testing.assert_allclose(found.reshape(-1, 6)[:, :3], expected, atol=1e-14)


def test_angular_acceleration_turns_nodes_rigidly():
    nodes, alpha = RNG.standard_normal((5, 3)), RNG.standard_normal(3)
    values = np.concatenate([np.zeros(6), alpha])[None]
    found = motion_of(values).fields() @ affine_fields(nodes).T
    expected = rigid_body_motions(nodes, np.zeros(3))[:, 3:] @ alpha
    np.testing.assert_allclose(found[0], expected, atol=1e-14)  # round-off


def test_nodal_mass_is_that_of_the_whole(joint):
    """A rigid motion of all nodes takes the whole mass, that of the supported nodes included."""
    fields = affine_fields(joint.assembly.mesh.nodes)
    total = fields.T @ (joint.nodal_mass @ fields)
    expected = mass_properties(joint.assembly).mass
    np.testing.assert_allclose(total[:3, :3], expected * np.eye(3), atol=1e-12 * expected)


def test_steady_acceleration_is_the_weight_of_the_arm(joint, given):
    """At rest in a frame that accelerates upwards, the bar beyond the joint weighs on it."""
    acceleration = 1e6
    values = np.zeros((4, 9))
    values[:, 2] = acceleration
    still = np.zeros((4, len(given.K)))
    back = fy.recover_from_modal(
        given.recovery,
        np.arange(4.0),
        still,
        fy.Load(),
        velocities=still,
        accelerations=still,
        frame_motion=motion_of(values),
    )
    assert back.displacement("tip")[0, 2] < 0
    # By Maxwell and Betti: deflection of the tip under the weight is the work of the weight on the
    # deflection under a unit force at the tip, with contact closed in both (no friction, small).
    mass = joint.nodal_mass @ affine_fields(joint.assembly.mesh.nodes)[:, 2]
    unit = fy.solve_static(joint, fy.Load({"tip.Fz": -1.0}))
    rest = fy.solve_static(joint)
    shape = joint.dofs.transformation @ (unit.states - rest.states)
    small = fy.recover_from_modal(
        given.recovery,
        np.arange(4.0),
        still,
        fy.Load(),
        velocities=still,
        accelerations=still,
        frame_motion=motion_of(values * 1e-3),
    )
    sunk = small.displacement("tip")[0, 2] - rest.displacement("tip")[2]
    # Both loads change the contact area by less than a percent.
    assert sunk == pytest.approx(1e-3 * acceleration * (mass @ shape), rel=1e-2)


def test_what_is_missing_is_said(given):
    times, still = np.arange(4.0), np.zeros((4, len(given.K)))
    old = replace(given.recovery, frame=None)
    for operator, rows, message in (
        (old, 4, "run the study again"),
        (given.recovery, 3, "3 instants but the history 4"),
    ):
        with pytest.raises(ModelError, match=message):
            fy.recover_from_modal(
                operator, times, still, fy.Load(), frame_motion=motion_of(np.zeros((rows, 9)))
            )


def test_a_csv_file_names_the_motion_of_the_frame(given, tmp_path):
    path = tmp_path / "motion.csv"
    path.write_text("time,q1,frame.az,frame.alphax\n0,0,1,2\n1,0,3,4\n")
    frame = read_imported_history(path, given.joint).frame
    np.testing.assert_array_equal(frame.acceleration, [[0, 0, 1], [0, 0, 3]])
    np.testing.assert_array_equal(frame.angular_velocity, np.zeros((2, 3)))
    np.testing.assert_array_equal(frame.angular_acceleration, [[2, 0, 0], [4, 0, 0]])
    path.write_text("time,q1,frame.aw\n0,0,1\n")
    with pytest.raises(FormatError, match=r"unknown column 'frame\.aw'; did you mean 'frame\."):
        read_imported_history(path, given.joint)


def test_an_hdf5_file_has_nine_columns(given, tmp_path):
    path, values = tmp_path / "motion.h5", RNG.standard_normal((4, 9))
    with h5py.File(path, "w") as file:
        file["times"], file["coordinates"] = np.arange(4.0), np.zeros((4, 17))
        file["frame"] = values
    frame = read_imported_history(path, given.joint).frame
    np.testing.assert_array_equal(frame.fields(), motion_of(values).fields())
    with h5py.File(path, "a") as file:
        del file["frame"]
        file["frame"] = values[:, :6]
    with pytest.raises(FormatError, match=r"'frame' has shape \(4, 6\), expected \(4, 9\)"):
        read_imported_history(path, given.joint)


def test_the_command_recovers_with_it(given, tmp_path):
    results = _results_with(given)
    n, times = len(given.K), 1e-4 * np.arange(6)
    q = 1e-3 * RNG.standard_normal((6, n))
    values = 1e5 * RNG.standard_normal((6, 9)) * ([1] * 3 + [1e-3] * 3 + [1e-1] * 3)
    names = ["time", *(f"{kind}{k}" for kind in "qva" for k in range(1, n + 1)), *FRAME]
    table = np.column_stack([times, q, q, q, values])
    path = tmp_path / "swing.csv"
    np.savetxt(path, table, delimiter=",", header=",".join(names), comments="", fmt="%.17g")
    found = recover(results, path, RecoverOptions(method="compliance"))
    expected = fy.recover_from_modal(
        given.recovery,
        times,
        q,
        fy.Load(),
        velocities=q,
        accelerations=q,
        frame_motion=motion_of(values),
    )
    # the same arithmetic; contact blocks may be solved from other factorizations
    allowed = 1e-11 * expected.pressure.max()
    np.testing.assert_allclose(found.pressure, expected.pressure, rtol=0, atol=allowed)
    loads = tmp_path / "loads.csv"
    loads.write_text("time,tip.Fz,frame.az\n0,1,1\n1,1,1\n")
    with pytest.raises(StudyError, match="moving supports but no coordinates"):
        recover(results, loads, RecoverOptions())


def _results_with(given):
    """As much of a run's results as recovery asks for."""

    results = object.__new__(Results)
    for name, value in {
        "title": "swing",
        "units": given.units,
        "reduced": {"craig-bampton": {0: given}, "compliance": {0: given}},
        "interfaces": given.interfaces,
    }.items():
        object.__setattr__(results, name, value)
    return results
