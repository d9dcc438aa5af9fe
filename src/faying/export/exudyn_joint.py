"""A bolted joint as a reduced model with contact, for Exudyn. Written by faying.

Needs NumPy and Exudyn, and the file of the same name ending in ``.npz`` beside it::

    import compliance_exudyn as compliance               # this file

    added = compliance.add_joint(mbs)                    # supports rest: ObjectGenericODE2
    added = compliance.add_body(mbs, frame=(-55, 0, 0))  # or move: ObjectFFRFreducedOrder
    compliance.add_load(mbs, added, "tip.Fz", -500.0)    # a constant, or a function of time
    watched = compliance.add_sensors(mbs, added)

Motion is M q̈ + C q̇ + K q = f + f_bolts + Gᵀ λ(q), with the projected matrices of a finite
element model, and the contact forces λ ≥ 0 at the contact points, which obey

    s = (R + D) λ + g₀ + G q ≥ 0,   λ s = 0,   D = diag(1 / (penalty · area))

with R the residual flexibility beside the trial vectors. Where s > 0 the joint is open.
Units are those of the model, ``joint().data["units"]``; pressure is positive in compression.
"""

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from faying.export.exudyn_contact import FORCES, Array, ReducedJoint

# Any, since Exudyn is only partly typed.
exu: Any = import_module("exudyn")
eii: Any = import_module("exudyn.itemInterface")
bodies: Any = import_module("exudyn.rigidBodyUtilities")


@dataclass(frozen=True)
class Added:
    """Numbers of the items that were added to a system.

    Attributes
    ----------
    node
        NodeGenericODE2 with the coordinates q.
    contact
        ObjectGenericODE2 that holds the contact forces; without a body also mass and stiffness.
    frame, body
        Rigid body node and ObjectFFRFreducedOrder, or None.
    """

    node: int
    contact: int
    frame: int | None = None
    body: int | None = None


@dataclass(frozen=True)
class Watched:
    """Numbers of the sensors of q, its derivatives, and the outputs of the joint."""

    position: int
    velocity: int
    acceleration: int
    outputs: int


def add_joint(mbs: Any, *, jacobian: bool = True) -> Added:
    """Add the joint with its supports at rest, in equilibrium under its bolts.

    Parameters
    ----------
    mbs
        Exudyn's MainSystem.
    jacobian
        Give Exudyn the tangent of contact; otherwise it uses slow finite differences.
    """
    node = _coordinates(mbs)
    data = joint().data
    return Added(node, _contact(mbs, node, data["M"], data["C"], data["K"], jacobian=jacobian))


def add_body(
    mbs: Any,
    *,
    frame: tuple[float, float, float] = (0.0, 0.0, 0.0),
    position: tuple[float, float, float] | None = None,
    rotation: Array | None = None,
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    angular_velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    jacobian: bool = True,
) -> Added:
    """Add the joint as a flexible body whose supports are fixed to a moving frame.

    The frame replaces the supports of the finite element model, so there are no rigid-body modes:
    attach the carrier of the supports to the frame's node.

    Parameters
    ----------
    frame
        Point of the mesh at the origin of the frame.
    position, rotation, velocity, angular_velocity
        Initial state of the frame in global axes; ``position`` is ``frame`` unless given.
    gravity
        Gravity on frame and deformation.
    """
    data = joint().data
    if "invariants" not in data:
        message = (
            "the data hold no mass integrals; export from a run of faying, or a model that "
            "for_moving_supports(model, rom) returned"
        )
        raise ValueError(message)
    placement = np.asarray(frame, dtype=float)
    start = frame if position is None else position
    rigid = mbs.AddNode(
        bodies.GetRigidBodyNode(
            exu.NodeType.RotationEulerParameters,
            position=list(start),
            velocity=list(velocity),
            rotationMatrix=np.eye(3) if rotation is None else rotation,
            angularVelocity=list(angular_velocity),
        )
    )
    node = _coordinates(mbs)
    body = mbs.AddObject(
        eii.ObjectFFRFreducedOrder(
            nodeNumbers=[rigid, node],
            massMatrixReduced=_container(data["M"]),
            stiffnessMatrixReduced=_container(data["K"]),
            dampingMatrixReduced=_container(data["C"]),
            modeBasis=np.ascontiguousarray(data["modes"].reshape(joint().n_mode, -1).T),
            referencePositions=(data["nodes"] - placement).ravel(),
            **inertia(data["invariants"], placement),
        )
    )
    if np.any(gravity):
        marker = mbs.AddMarker(eii.MarkerBodyMass(bodyNumber=body))
        mbs.AddLoad(eii.LoadMassProportional(markerNumber=marker, loadVector=list(gravity)))
    zero = np.zeros_like(data["M"])
    return Added(node, _contact(mbs, node, zero, zero, zero, jacobian=jacobian), rigid, body)


def add_load(
    mbs: Any, added: Added, name: str, load: float | Callable[[float], float]
) -> list[int]:
    """Load a boundary, such as ``"tip.Fz"``, with a constant or a function of time.

    For a deck load, ``load`` is its factor; not on a body, which takes only forces
    in global axes. Moments on a body need your own marker (``MarkerSuperElementRigid`` on nodes
    nearby).

    Returns
    -------
    list of int
        Load numbers.
    """
    if name in joint().load_names:
        return _deck_load(mbs, added, name, load)
    places = joint().boundary_forces(name)
    share = 1.0 / len(places)
    if added.body is None:
        coordinates = joint().data["boundary"][places].tolist()
        return [
            _coordinate_load(mbs, added.node, coordinate, load, share) for coordinate in coordinates
        ]
    axis = FORCES.index(name.rsplit(".", 1)[1])
    if axis > 2:
        message = f"'{name}' is a moment; on a body only forces can be added here"
        raise ValueError(message)
    direction = share * np.eye(3)[axis]
    nodes = [
        int(joint().data["boundary_names"][coordinate].split(".")[-2]) for coordinate in places
    ]
    return [_force(mbs, boundary_marker(mbs, added, node), load, direction) for node in nodes]


def _deck_load(
    mbs: Any, added: Added, name: str, load: float | Callable[[float], float]
) -> list[int]:
    """Add a load to every coordinate on which a deck load does work."""
    if added.body is not None:
        message = (
            f"'{name}' is a load of the deck; on a body only forces at boundaries can be added"
        )
        raise ValueError(message)
    shares = joint().data["L"][joint().load_names.index(name)]
    return [
        _coordinate_load(mbs, added.node, coordinate, load, float(shares[coordinate]))
        for coordinate in np.flatnonzero(shares).tolist()
    ]


def boundary_marker(mbs: Any, added: Added, node_id: int) -> int:
    """Add a MarkerSuperElementPosition at a node of the mesh, by its id, to a body."""
    number = int(np.flatnonzero(joint().data["node_ids"] == node_id)[0])
    marker = eii.MarkerSuperElementPosition(
        bodyNumber=added.body, meshNodeNumbers=[number], weightingFactors=[1.0]
    )
    return int(mbs.AddMarker(marker))


def add_sensors(mbs: Any, added: Added, **options: Any) -> Watched:
    """Add sensors of q, q̇, q̈ and of the outputs named by ``joint().output_names()``.

    Parameters
    ----------
    options
        Of Exudyn's sensors; ``storeInternal=True`` unless given.
    """
    settings = {"storeInternal": True, "writeToFile": False, **options}
    kinds = exu.OutputVariableType
    position, velocity, acceleration = (
        int(
            mbs.AddSensor(
                eii.SensorNode(nodeNumber=added.node, outputVariableType=kind, **settings)
            )
        )
        for kind in (kinds.Coordinates, kinds.Coordinates_t, kinds.Coordinates_tt)
    )

    def outputs(mbs: Any, _t: float, numbers: Any, _factors: Any, configuration: Any) -> Array:
        return joint().outputs(np.asarray(mbs.GetSensorValues(numbers[0], configuration)))

    sensor = eii.SensorUserFunction(
        sensorNumbers=[position], factors=[1.0], sensorUserFunction=outputs, **settings
    )
    return Watched(position, velocity, acceleration, int(mbs.AddSensor(sensor)))


def frame_fields(
    acceleration: Array, angular_velocity: Array, angular_acceleration: Array
) -> Array:
    """Return the accelerations of a moving frame (n_time, 12) for :meth:`ReducedJoint.recover`.

    Parameters
    ----------
    acceleration : (n_time, 3)
        Acceleration of the origin **of the mesh**, less gravity, in the axes of the frame.
    angular_velocity, angular_acceleration : (n_time, 3)
        Components in the axes of the frame.
    """
    turning, gaining = _skew(angular_velocity), _skew(angular_acceleration)
    matrix = gaining + turning @ turning
    return np.hstack([acceleration, matrix.reshape(-1, 9)])


def inertia(invariants: Array, origin: Array) -> dict[str, Any]:
    """Return the constant terms of ObjectFFRFreducedOrder from mass integrals.

    Parameters
    ----------
    invariants : (4 + 3 n_mode, 4 + 3 n_mode)
        Integrals of products of 1, x, y, z and the components of the modes.
    origin : (3,)
        Origin of the frame.
    """
    shift = np.eye(len(invariants))
    shift[1:4, 0] = -origin
    moments = shift @ invariants @ shift.T
    n = (len(moments) - 4) // 3
    mass, first, second = moments[0, 0], moments[0, 1:4], moments[1:4, 1:4]
    modes = moments[0, 4:].reshape(n, 3)
    placed = moments[4:, 1:4].reshape(n, 3, 3)  # mode, component, coordinate
    paired = moments[4:, 4:].reshape(n, 3, n, 3)
    both = np.moveaxis(paired, 1, 2)  # mode i, mode j, component of i, component of j
    return {
        "mass": mass,
        "centerOfMass": first / mass,
        "inertia": _tilted(second),
        "mPhitTPsi": modes.T,
        "mPhitTPsiTilde": np.hstack(list(_skew(modes))),
        # x̃ᵀΨ = Ψ × x, by the antisymmetric part of the products of their components
        "mXRefTildePsi": _curl(placed).T,
        "mXRefTildePsiTilde": np.hstack(list(_tilted(np.swapaxes(placed, 1, 2)))),
        "mPsiTildePsi": np.moveaxis(_curl(np.swapaxes(both, 2, 3)), 2, 1).reshape(3 * n, n),
        "mPsiTildePsiTilde": np.moveaxis(_tilted(both), 2, 1).reshape(3 * n, 3 * n),
    }


@cache
def joint() -> ReducedJoint:
    """Return the joint of the data file beside this one."""
    return ReducedJoint(Path(__file__).with_suffix(".npz"))


def _coordinates(mbs: Any) -> int:
    n, start = joint().n_mode, joint().data["q0"]
    node = eii.NodeGenericODE2(
        numberOfODE2Coordinates=n,
        referenceCoordinates=np.zeros(n),
        initialCoordinates=start,
        initialCoordinates_t=np.zeros(n),
    )
    return int(mbs.AddNode(node))


def _contact(mbs: Any, node: int, M: Array, C: Array, K: Array, *, jacobian: bool) -> int:
    """Add mass, damping, stiffness, bolts and contact on a node."""
    # Each joint in a system has its own active set.
    joint_copy = copy(joint())
    joint_copy.contact = type(joint_copy.contact)(joint_copy.contact.flexibility)
    item = eii.ObjectGenericODE2(
        nodeNumbers=[node],
        massMatrix=M,
        dampingMatrix=C,
        stiffnessMatrix=K,
        forceVector=joint().bolt_forces,
        forceUserFunction=joint_copy.force,
        jacobianUserFunction=joint_copy.jacobian if jacobian else 0,
    )
    return int(mbs.AddObject(item))


def _coordinate_load(
    mbs: Any, node: int, coordinate: int, load: float | Callable[[float], float], share: float
) -> int:
    marker = mbs.AddMarker(eii.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
    if not callable(load):
        return int(mbs.AddLoad(eii.LoadCoordinate(markerNumber=marker, load=share * load)))

    def at(_mbs: Any, t: float, _load: float) -> float:
        return share * load(t)

    item = eii.LoadCoordinate(markerNumber=marker, load=0.0, loadUserFunction=at)
    return int(mbs.AddLoad(item))


def _force(mbs: Any, marker: int, load: float | Callable[[float], float], direction: Array) -> int:
    if not callable(load):
        vector = list(load * direction)
        return int(mbs.AddLoad(eii.LoadForceVector(markerNumber=marker, loadVector=vector)))

    def at(_mbs: Any, t: float, _load: Any) -> list[float]:
        return list(load(t) * direction)

    item = eii.LoadForceVector(
        markerNumber=marker, loadVector=[0.0, 0.0, 0.0], loadVectorUserFunction=at
    )
    return int(mbs.AddLoad(item))


def _container(matrix: Array) -> Any:
    container = exu.MatrixContainer()
    container.SetWithDenseMatrix(matrix, useDenseMatrix=True)
    return container


def _skew(vectors: Array) -> Array:
    """Return v× (..., 3, 3)."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def _tilted(products: Array) -> Array:
    """Return ∫ũᵀṽ (..., 3, 3) from ∫u_k v_l: trace times identity minus transpose.

    That is δ_kl ∫u·v − ∫v_k u_l.
    """
    trace = np.trace(products, axis1=-2, axis2=-1)[..., None, None]
    return np.asarray(trace * np.eye(3) - np.swapaxes(products, -1, -2))


def _curl(products: Array) -> Array:
    """Return ∫u × v (..., 3) from ∫u_k v_l (..., 3, 3)."""
    turned = products - np.swapaxes(products, -1, -2)
    return np.stack([turned[..., 1, 2], turned[..., 2, 0], turned[..., 0, 1]], axis=-1)
