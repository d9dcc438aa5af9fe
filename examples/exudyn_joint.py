"""A bolted joint as a reduced model with contact, for Exudyn.

Needs NumPy and Exudyn, not faying, and beside it, under the name of this file, the ``.npz`` that
``faying export DIR --to npz`` writes::

    import compliance                                    # this file, copied beside compliance.npz

    added = compliance.add_joint(mbs)                    # supports rest: ObjectGenericODE2
    added = compliance.add_body(mbs, frame=(-55, 0, 0))  # or move: ObjectFFRFreducedOrder
    compliance.add_load(mbs, added, "tip.Fz", -500.0)    # a constant, or a function of time
    watched = compliance.add_sensors(mbs, added)

Motion is M q̈ + C q̇ + K q = f + f_bolts + Gᵀ λ(q): the mass matrix and its companions of a finite
element model between trial vectors, and the contact forces λ ≥ 0 at the contact points, which obey

    s = (R + D) λ + g₀ + G q ≥ 0,   λ s = 0,   D = diag(1 / (penalty · area))

with R the flexibility of the surroundings that the trial vectors lack. Where s > 0 the joint gapes.
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

Array = np.ndarray[Any, np.dtype[Any]]

COMPONENTS = ("ux", "uy", "uz", "rx", "ry", "rz")
FORCES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
ROUND_OFF = 1e-13
EPSILON = float(np.finfo(float).eps)
SMALLEST_FLEXIBILITY = 1e-6
LARGEST_DRIFT = 1e-11
"""Gap left at closed points, over the largest, from which the inverse is formed anew."""


class CoupledPoints:
    """Contact points that feel each other: a complementarity problem with a remembered active set.

    The inverse of the active block is kept, at full size with zeros elsewhere, and changed by as
    many ranks as points open or close.
    """

    def __init__(self, flexibility: Array) -> None:
        self.flexibility = flexibility
        self.diagonal = np.diag(flexibility).copy()
        self.active = np.zeros(len(flexibility), dtype=bool)
        self._held = self.active.copy()
        self._inverse = np.zeros_like(flexibility)

    def solve(self, gap: Array) -> Array:
        """Return the forces (n_point,) for gaps without them (n_point,).

        Wrong signs change sides all at once, and one at a time, by the largest index, where that
        has not helped for twenty times (block principal pivoting).
        """
        active, largest = self.active, np.abs(gap).max()
        root = np.sqrt(self.diagonal)
        fewest, attempts = len(gap) + 1, 20
        for _ in range(50 * len(gap) + 200):
            forces = -(self.inverse(active) @ gap)
            slack = self.flexibility @ forces + gap
            if np.abs(slack[active]).max(initial=0.0) > LARGEST_DRIFT * largest:
                self._held = np.zeros_like(active)
                self._inverse[:] = 0.0
                forces = -(self.inverse(active) @ gap)
                slack = self.flexibility @ forces + gap
            # Where weak springs hold a part, forces that balance move it far more than the gap.
            noise = np.maximum(ROUND_OFF * largest, EPSILON * (root @ np.abs(forces)) * root)
            wrong = np.where(active, self.diagonal * forces < -noise, slack < -noise)
            count = int(np.count_nonzero(wrong))
            if count == 0:
                self.active = active
                result: Array = np.maximum(forces, 0.0)
                return result
            if count < fewest:
                fewest, attempts = count, 20
            elif attempts > 0:
                attempts -= 1
            else:
                wrong[: np.flatnonzero(wrong)[-1]] = False
            active = active ^ wrong
        message = "the contact problem did not settle; is the state finite?"
        raise RuntimeError(message)

    def inverse(self, active: Array) -> Array:
        """Return the inverse of the active block (n_point, n_point), zero elsewhere."""
        opened, closed = (
            np.flatnonzero(set_) for set_ in (self._held & ~active, active & ~self._held)
        )
        P, H = self._inverse, self.flexibility
        if len(opened):
            columns = P[:, opened]
            P -= columns @ np.linalg.solve(columns[opened], columns.T)
            P[opened], P[:, opened] = 0.0, 0.0
        if len(closed):
            columns = P @ H[:, closed]
            between = H[np.ix_(closed, closed)] - H[closed] @ columns
            columns[closed] -= np.eye(len(closed))
            P += columns @ np.linalg.solve(between, columns.T)
        self._held = active.copy()
        return P


class Springs(CoupledPoints):
    """Contact points that do not feel each other: penalty without flexible surroundings."""

    def solve(self, gap: Array) -> Array:
        """Return the forces (n_point,) for gaps (n_point,)."""
        self.active = gap < 0
        forces: Array = np.maximum(-gap / self.diagonal, 0.0)
        return forces

    def inverse(self, active: Array) -> Array:
        """Return the inverse of the active block (n_point, n_point), zero elsewhere."""
        return np.diag(active / self.diagonal)


class ReducedJoint:
    """What the data file holds, and the user functions that Exudyn calls."""

    def __init__(self, path: Path) -> None:
        with np.load(path) as file:
            self.data: dict[str, Array] = {name: file[name] for name in file.files}
        data = self.data
        if data["mu"].any():
            message = f"{path} has friction, which this module does not know; export without it"
            raise ValueError(message)
        self.G, self.gap0, self.weights = data["G"], data["g0"], data["w"]
        self.bolt_forces = -data["E"].T @ data["N0"]
        n_point, n_relative = len(self.weights), len(data["P"])
        self.N = np.zeros((n_point, n_relative))
        np.add.at(self.N, (data["N_rows"], data["N_columns"]), data["N_values"])
        self.contact = self._law(self.N @ data["R"] @ self.N.T)

    @property
    def n_mode(self) -> int:
        """Number of coordinates q."""
        return len(self.data["M"])

    @property
    def load_names(self) -> list[str]:
        """Return the loads of the deck that the study applied."""
        return [str(name) for name in self.data["load_names"]]

    def _law(self, flexibility: Array) -> CoupledPoints:
        diagonal = np.diag(flexibility)
        penalty = np.maximum(
            1.0 / (self.data["cn"] * self.weights), SMALLEST_FLEXIBILITY * diagonal
        )
        if not penalty.all():
            message = "hard contact needs a model with the compliance its trial vectors lack"
            raise ValueError(message)
        kind = CoupledPoints if diagonal.any() else Springs
        return kind(flexibility + np.diag(penalty))

    def contact_forces(self, q: Array) -> Array:
        """Return λ (n_point,) in a state q."""
        return self.contact.solve(self.gap0 + self.G @ q)

    def pressure(self, q: Array) -> Array:
        """Return the contact pressure (n_point,) in a state q."""
        pressure: Array = self.contact_forces(np.asarray(q)) / self.weights
        return pressure

    def tangent(self, q: Array) -> Array:
        """Return −∂(Gᵀ λ)/∂q (n_mode, n_mode): the stiffness of the closed points."""
        self.contact_forces(q)
        stiffness: Array = self.G.T @ (self.contact.inverse(self.contact.active) @ self.G)
        return stiffness

    def force(self, _mbs: Any, _t: float, _item: int, q: Array, _q_t: Array) -> Array:
        """Return Gᵀ λ(q): Exudyn's forceUserFunction."""
        force: Array = self.G.T @ self.contact_forces(np.asarray(q))
        return force

    def jacobian(
        self, _mbs: Any, _t: float, _item: int, q: Array, _q_t: Array, factor: float, _: float
    ) -> Array:
        """Return the derivative of −Gᵀ λ(q) times a factor: Exudyn's jacobianUserFunction."""
        return factor * self.tangent(np.asarray(q))

    def outputs(self, q: Array) -> Array:
        """Return largest pressure, clamp force of each interface, axial force of each bolt."""
        data, forces = self.data, self.contact_forces(q)
        largest = (forces / self.weights).max(initial=0.0)
        clamp = np.bincount(data["interface_of_point"], forces, len(data["interface_names"]))
        bolts = data["bolt_stiffness"] * (data["E"] @ q) + data["N0"]
        return np.concatenate([[largest], clamp, bolts])

    def output_names(self) -> list[str]:
        """Return what each entry of the outputs is."""
        clamps = [f"{name}.clamp" for name in self.data["interface_names"]]
        return ["max_pressure", *clamps, *(f"{name}.N" for name in self.data["bolt_names"])]

    def boundary_forces(self, name: str) -> list[int]:
        """Return which boundary degrees of freedom a force such as ``"tip.Fz"`` acts on.

        ``"tip.17.Fz"`` is the force on node 17 of a boundary of several nodes; without a number it
        is shared evenly between them. ``data["boundary"]`` has the coordinate of each.
        """
        parts = [text.rsplit(".", 2) for text in self.data["boundary_names"]]
        names = [(boundary, node, FORCES[COMPONENTS.index(c)]) for boundary, node, c in parts]
        choices = sorted({f"{boundary}.{force}" for boundary, _, force in names})
        chosen = [
            index
            for index, (boundary, node, force) in enumerate(names)
            if name in (f"{boundary}.{force}", f"{boundary}.{node}.{force}")
        ]
        if not chosen:
            takes = ", ".join([*choices, *self.load_names])
            message = f"the joint takes no load '{name}'; it takes {takes}"
            raise ValueError(message)
        return chosen

    def recover(
        self,
        velocity: Array,
        acceleration: Array,
        loads: dict[str, Array] | None = None,
        frame: Array | None = None,
    ) -> Array:
        """Return the pressures of the full finite element model in a moving state.

        Only inertia and damping forces are taken from the motion; contact is solved anew with the
        flexibility of the whole structure.

        Parameters
        ----------
        velocity, acceleration : (n_time, n_mode)
            q̇ and q̈.
        loads
            ``"tip.Fz"`` and the like to forces (n_time,), deck loads to factors; others are zero.
        frame : (n_time, 12), optional
            Accelerations of a moving frame, see :func:`frame_fields`.

        Returns
        -------
        ndarray (n_time, n_point)
        """
        data, n = self.data, self.N.shape[1]
        compliance = data["recovery_compliance"]
        law = self._law(self.N @ compliance[:n, :n] @ self.N.T)
        n_boundary = len(data["boundary"])
        inputs = np.zeros((len(velocity), len(compliance) - n))
        first = n_boundary + len(data["N0"])
        inputs[:, n_boundary:first] = -data["N0"]
        for name, force in (loads or {}).items():
            if name in self.load_names:
                inputs[:, first + self.load_names.index(name)] += np.asarray(force)
                continue
            places = self.boundary_forces(name)
            inputs[:, places] += np.asarray(force)[:, None] / len(places)
        ports = inputs @ compliance[n:, :n]
        ports = ports - acceleration @ data["recovery_inertia"][:n].T
        ports -= velocity @ data["recovery_damping"][:n].T
        if frame is not None:
            ports -= frame @ data["recovery_frame"][:n].T
        gaps = self.gap0 + ports @ self.N.T
        return np.array([law.solve(gap) for gap in gaps]) / self.weights


# Exudyn is typed in part only; as Any it pleases type checkers.
exu: Any = import_module("exudyn")
eii: Any = import_module("exudyn.itemInterface")
bodies: Any = import_module("exudyn.rigidBodyUtilities")


@dataclass(frozen=True)
class Added:
    """Numbers of what was added to a system.

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
    """Numbers of sensors: coordinates q and their derivatives, and the outputs of the joint."""

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
        Give Exudyn the tangent of the contact; otherwise it takes differences, which is slow.
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

    The frame is where the finite element model was supported, so it holds no rigid-body modes:
    attach to the frame's node what carries the supports.

    Parameters
    ----------
    frame
        Point of the mesh where the origin of the frame is to be.
    position, rotation, velocity, angular_velocity
        Of the frame at the start, in the global frame; ``position`` is ``frame`` unless given.
    gravity
        Acts on frame and deformation.
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
    """Load a boundary, e.g. ``"tip.Fz"``, with a constant or a function of time.

    The name of a deck load stands for what it is multiplied by; not on a body. There only forces,
    and in global axes; moments need a marker of your own (``MarkerSuperElementRigid`` on the nodes
    around).

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
    """Add a load to every coordinate that a load of the deck works on."""
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
    """Return what :meth:`ReducedJoint.recover` needs of a moving frame (n_time, 12).

    Parameters
    ----------
    acceleration : (n_time, 3)
        Of the origin **of the mesh**, less gravity, in the axes of the frame.
    angular_velocity, angular_acceleration : (n_time, 3)
        In the axes of the frame.
    """
    turning, gaining = _skew(angular_velocity), _skew(angular_acceleration)
    matrix = gaining + turning @ turning
    return np.hstack([acceleration, matrix.reshape(-1, 9)])


def inertia(invariants: Array, origin: Array) -> dict[str, Any]:
    """Return the constant terms of ObjectFFRFreducedOrder from mass integrals.

    Parameters
    ----------
    invariants : (4 + 3 n_mode, 4 + 3 n_mode)
        Of products of 1, x, y, z and the components of the modes.
    origin : (3,)
        Of the frame.
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
    """Mass, damping, stiffness, bolts and contact on one node."""
    # Several joints in one system each remember their own active set.
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
    """Return ∫ũᵀṽ (..., 3, 3) from ∫u_k v_l: its trace times the identity less its transpose.

    That is δ_kl ∫u·v − ∫v_k u_l.
    """
    trace = np.trace(products, axis1=-2, axis2=-1)[..., None, None]
    return np.asarray(trace * np.eye(3) - np.swapaxes(products, -1, -2))


def _curl(products: Array) -> Array:
    """Return ∫u × v (..., 3) from ∫u_k v_l (..., 3, 3)."""
    turned = products - np.swapaxes(products, -1, -2)
    return np.stack([turned[..., 1, 2], turned[..., 2, 0], turned[..., 0, 1]], axis=-1)
