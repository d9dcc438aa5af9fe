"""Results of a run that never was: two stacked bars, fields by formula, every kind of entry."""

import numpy as np

from faying.assessment.accuracy import Accuracy
from faying.assessment.check import Check
from faying.assessment.choose_joint_modes import JointModeChoice
from faying.assessment.choose_normal_modes import NormalModeChoice
from faying.assessment.joint_record import (
    Assessment,
    BoltAssessment,
    ClampRange,
    InterfaceAssessment,
)
from faying.assessment.mesh_error import MeshError
from faying.interface.interface import FacePairs
from faying.model.cells import CellBlock
from faying.reduction.mode_count import ModeCount
from faying.study.results.nodal_motion import NodalMotion
from faying.study.results.validation_record import (
    LoadSpaceRecord,
    LoadSpaceResult,
    ValidationRecord,
)
from faying.study.results.values import (
    BoltRecord,
    CaseResult,
    InterfaceRecord,
    MethodResult,
    Response,
    Results,
)

NX, NY = 6, 3
TIMES = np.linspace(0.0, 1e-3, 11)
JOINT_MODES = {"craig-bampton": (0,), "jim-a": (5, 20), "jim-b": (5, 20), "compliance": (0,)}
ERRORS = {"craig-bampton": 2.0, "jim-a": 0.4, "jim-b": 0.1, "compliance": 1e-9}

STUDY = """title = "fake"  # α & <β>
[[load_case]]
name = "LC1"
kind = "static"
forces = [
    { boundary = "tip", component = "Fz", value = -500.0 },
    { boundary = "tip", component = "Mx", value = 20e3 },
]
"""


def _bar(z):
    """Nodes (n, 3) and cells (m, 8) of a bar one element thick, from height z up to z + 5."""
    x, y, level = np.meshgrid(
        np.arange(NX + 1) * 5.0, np.arange(NY + 1) * 5.0, [z, z + 5.0], indexing="ij"
    )
    nodes = np.stack([x, y, level], axis=-1).reshape(-1, 3)
    index = np.arange(len(nodes)).reshape(NX + 1, NY + 1, 2)
    low, high = index[..., 0], index[..., 1]
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    cells = [face[i : i + NX, j : j + NY] for face in (low, high) for i, j in ring]
    return nodes, np.stack(cells, axis=-1).reshape(-1, 8), index


def _interface():
    lower, _, index = _bar(0.0)
    offset = len(lower)
    minus, plus = index[..., 1], index[..., 0] + offset
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    quads = [
        np.stack([side[i : i + NX, j : j + NY] for i, j in ring], axis=-1).reshape(-1, 4)
        for side in (minus, plus)
    ]
    pairs = np.stack([minus.ravel(), plus.ravel()], axis=-1)
    points = lower[minus.ravel()]
    n = len(points)
    weights = np.full(n, 25.0)
    return InterfaceRecord(
        points=points,
        normals=np.tile([0.0, 0.0, 1.0], (n, 1)),
        weights=weights,
        initial_gap=np.zeros(n),
        slice=(0, n),
        pairs=pairs,
        pair_points=points,
        averaging=np.eye(n),
        faces=(FacePairs(kind="quad4", minus=quads[0], plus=quads[1]),),
        penalty=1e5,
        quadrature="nodal",
        stuck=_pressure(points, 1.0) > 30.0,
        preload_pressure=_pressure(points, 1.0),
    )


def _pressure(points, factor):
    """A hump around the bolt at (15, 7.5)."""
    distance = np.hypot(points[:, 0] - 15.0, points[:, 1] - 7.5)
    return 60.0 * np.maximum(1.0 - distance * factor / 12.0, 0.0)


def _response(points, nodes, error, times):
    base = _pressure(points, 1.1)
    shape = 1.0 + error * 0.5 * np.sin(points[:, 0] / 5.0)
    swing = 1.0 if times is None else (1.0 + 0.5 * np.sin(times * 6e3))[:, None]
    pressure = base * shape * swing
    tip = np.array([0.0, 0.01, -1.0, 1e-3, 0.0, 0.0]) * (1 + error / 10)
    moving = tip if times is None else tip * swing
    bolts = 1e4 * (np.asarray(swing)[..., 0] if times is not None else np.array(1.0))
    sagging = np.zeros_like(nodes)
    sagging[:, 2] = -((nodes[:, 0] / 30.0) ** 2)
    return Response(
        pressure=pressure,
        gap=np.where(pressure > 0, -pressure / 1e5, 1e-4 * points[:, 0]),
        displacements={"tip": moving},
        bolt_forces={"bolt": np.asarray(bolts)},
        contact_forces={"joint": np.asarray(25.0 * pressure.sum(axis=-1))},
        open_fraction={"joint": np.asarray((pressure <= 0).mean(axis=-1))},
        iterations=np.asarray(3 if times is None else np.full(len(times), 2)),
        seconds=0.25,
        nodal_displacement=sagging if times is None else None,
        motion=_motion(sagging, swing) if error == 0 and times is not None else None,
        recovered_pressure=base * swing if error and times is not None else None,
        estimate=_estimate(1.5 * error) if error and times is not None else None,
    )


def _motion(sagging, swing):
    """Sag that swings, and move as a whole along x, ever further."""
    along = np.linspace(0.0, 0.5, len(swing))
    return NodalMotion(
        chosen=np.arange(len(swing)),
        amplitudes=np.stack([swing[:, 0], along], axis=1),
        shapes=np.stack([sagging, np.tile([1.0, 0.0, 0.0], (len(sagging), 1))]),
        missed=1e-3,
    )


def _estimate(error):
    return Accuracy(
        max_relative_error=error,
        rms_relative_error=error / 20,
        p999_relative_error=error / 2,
        max_pressure_ratio=1.0,
        displacement_error=error / 10,
    )


def _case(name, kind, points, nodes, times):
    reference = _response(points, nodes, 0.0, times)
    methods = {
        method: {
            count: _method(count, ERRORS[method] / (1 + count / 5), reference, points, nodes, times)
            for count in counts
        }
        for method, counts in JOINT_MODES.items()
    }
    half_times = None if times is None else np.linspace(times[0], times[-1], 2 * len(times) - 1)
    return CaseResult(
        name=name,
        kind=kind,
        times=times,
        components={"tip": ("ux", "uy", "uz", "rx", "ry", "rz")},
        reference=reference,
        methods=methods,
        half_step=None if times is None else _response(points, nodes, 0.05, half_times),
        half_step_times=half_times,
        mesh_errors={"joint": MeshError(field=0.04, largest=0.3)},
    )


def _method(count, error, reference, points, nodes, times):
    response = _response(points, nodes, error, times)
    relative = np.abs(response.pressure - reference.pressure) / reference.pressure.max()
    return MethodResult(
        joint_modes=count,
        n_modes=16 + count,
        response=response,
        certified_energy_error=error / 2 if times is None else None,
        certified_force_error=error / 4 if times is None else None,
        certified_bound=2 * error if times is None else None,
        recovered_error=None if times is None else 0.02,
        accuracy=Accuracy(
            max_relative_error=float(relative.max()),
            rms_relative_error=float(np.sqrt((relative**2).mean())),
            p999_relative_error=float(np.percentile(relative, 99.9)),
            max_pressure_ratio=float(response.pressure.max() / reference.pressure.max()),
            displacement_error=error / 10,
        ),
    )


def _validation():
    return ValidationRecord(
        load_space=LoadSpaceRecord(
            n_loads=100,
            methods={
                name: {
                    count: LoadSpaceResult(
                        median_error=ERRORS[name] / (2 + count), worst_error=ERRORS[name]
                    )
                    for count in counts
                }
                for name, counts in JOINT_MODES.items()
            },
        ),
        choices={
            "jim-b": JointModeChoice(
                count=20,
                met=True,
                tolerance=0.1,
                measure="energy_error",
                counts=np.array([5, 20]),
                bounds=np.array([0.4, 0.08]),
            )
        },
    )


YIELD = Check(
    part="bolt",
    kind="bolt",
    quantity="yield",
    outcome="met",
    utilisation=0.7,
    value=448.0,
    limit=640.0,
    unit="MPa",
    case="LC2-step",
    instant=3e-4,
)


def _assessment():
    """A bolt and the interface, which holds."""
    clamp = {
        "preload": 1e4, "least": 8e3, "least_case": "LC1", "certified_least": np.array([7990, 8e3]),
        "most": 1.1e4, "most_case": "LC2-step", "certified_most": None,
    }  # fmt: skip
    bolt = BoltAssessment(
        preload=1e4,
        least=9962.25,
        least_case="LC1",
        most=1.5e4,
        most_case="LC2-step",
        axial_loads={"LC1": 500.0},
        load_factors={"LC1": 0.1},
        clamp_around={"joint": ClampRange(**clamp)},
    )
    joint = InterfaceAssessment(
        preload=1e4,
        least_clamp=8e3,
        least_clamp_case="LC1",
        certified=np.array([7990.0, 8e3]),
        most_clamp=1.1e4,
        most_clamp_case="LC2-step",
        certified_most=None,
        certified_width=10.0,
        max_pressure=80.0,
        max_pressure_case="LC2-step",
        max_pressure_point=np.array([15.0, 5.0, 5.0]),
        max_nodal_pressure=75.0,
        max_nodal_pressure_case="LC2-step",
        closed_area=300.0,
        closed_area_case="LC1",
        opening={"LC1": 2.5, "LC2/torsion": np.inf},
    )
    return Assessment(bolts={"bolt": bolt}, interfaces={"joint": joint}, checks=(YIELD,))


def fake_results():
    """Two static cases and a step response of four methods."""
    lower, cells, _ = _bar(0.0)
    upper, _, _ = _bar(5.0)
    nodes = np.concatenate([lower, upper])
    n_cell = len(cells)
    joint = _interface()
    block = CellBlock(
        kind="hex8",
        nodes=np.concatenate([cells, cells + len(lower)]),
        ids=np.arange(1, 2 * n_cell + 1),
        properties=np.ones(2 * n_cell, dtype=np.int64),
    )
    return Results(
        title="Two bars <fake> & co",
        units="mm-t-s",
        study_text=STUDY,
        nodes=nodes,
        node_ids=np.arange(1, len(nodes) + 1),
        body=np.repeat([0, 1], len(lower)),
        blocks=(block,),
        mass=3.5e-5,
        dofs=3 * len(nodes),
        interfaces={"joint": joint},
        bolts={
            "bolt": BoltRecord(
                preload=1e4,
                initial_force=1.2e4,
                history=np.array([0.0, 5e3, 1e4]),
                axis=np.array([[15.0, 7.5, 0.0], [15.0, 7.5, 10.0]]),
            )
        },
        tightening_stages=("start", "bolt to 50 %", "bolt to 100 %"),
        cases={
            "LC1": _case("LC1", "static", joint.points, nodes, None),
            "LC2/torsion": _case("LC2/torsion", "static", joint.points, nodes, None),
            "LC2-step": _case("LC2-step", "step", joint.points, nodes, TIMES),
        },
        timings={"assembly": 0.5, "compliance": 0.1, "jim-b": 3.0, "project compliance": 0.01},
        provenance={"faying": "0.1.0", "python": "3.11", "factorization": "superlu"},
        validation=_validation(),
        normal_modes=ModeCount(below=4e4, found=20, counted=20),
        mode_choices={
            "LC2-step": NormalModeChoice(
                count=20,
                met=False,
                tolerance=0.02,
                excited=7957.0,
                resolved=5e4,
                counts=np.array([10, 20]),
                highest=np.array([9524.0, 4e4]),
                estimates=np.array([np.inf, 0.031]),
            )
        },
        factor_bytes=2_500_000,
        assessment=_assessment(),
        warnings=("load case LC1, jim-a with 40 joint modes: no solution",),
        omissions=("unseen loads, nmf: it met what <nobody> foresaw",),
    )
