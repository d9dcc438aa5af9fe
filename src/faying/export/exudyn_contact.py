"""Contact forces of a reduced joint with NumPy alone; part of the module for Exudyn.

:mod:`faying.export.exudyn` copies all but the imports into the module that it writes.
"""

from pathlib import Path
from typing import Any

import numpy as np

Array = np.ndarray[Any, np.dtype[Any]]

COMPONENTS = ("ux", "uy", "uz", "rx", "ry", "rz")
FORCES = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
ROUND_OFF = 1e-11
"""Round-off of gaps over the largest gap. Where closed points have a larger gap, the inverse is
computed again."""
EPSILON = float(np.finfo(float).eps)
SMALLEST_FLEXIBILITY = 1e-6
"""Flexibility of contact at a point over that of the joint there: it makes forces unique, and
changes gaps by a millionth."""


class CoupledPoints:
    """Coupled contact points: a complementarity problem that keeps its active set.

    The inverse of the active block is stored at full size with zeros elsewhere, and updated by as
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

        All points with wrong signs change state at once; only the one of the largest index, where
        twenty such steps did not reduce their number (block principal pivoting).
        """
        active, largest = self.active, np.abs(gap).max(initial=0.0)
        root = np.sqrt(self.diagonal)
        fewest, attempts = len(gap) + 1, 20
        for _ in range(50 * len(gap) + 200):
            forces = -(self.inverse(active) @ gap)
            slack = self.flexibility @ forces + gap
            if np.abs(slack[active]).max(initial=0.0) > ROUND_OFF * largest:
                self._held = np.zeros_like(active)
                self._inverse[:] = 0.0
                forces = -(self.inverse(active) @ gap)
                slack = self.flexibility @ forces + gap
            # Balanced forces move a part on weak springs far more than the gap.
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


class ReducedJoint:
    """The joint of a data file, with the user functions of Exudyn."""

    def __init__(self, path: Path) -> None:
        with np.load(path) as file:
            self.data: dict[str, Array] = {name: file[name] for name in file.files}
        data = self.data
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
        """Names of the deck loads of the study."""
        return [str(name) for name in self.data["load_names"]]

    def _law(self, flexibility: Array) -> CoupledPoints:
        diagonal = np.diag(flexibility)
        penalty = np.maximum(
            1.0 / (self.data["cn"] * self.weights), SMALLEST_FLEXIBILITY * diagonal
        )
        if not penalty.all():
            message = "hard contact needs a model with residual compliance"
            raise ValueError(message)
        return CoupledPoints(flexibility + np.diag(penalty))

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
        """Return the names of the outputs."""
        clamps = [f"{name}.clamp" for name in self.data["interface_names"]]
        return ["max_pressure", *clamps, *(f"{name}.N" for name in self.data["bolt_names"])]

    def boundary_forces(self, name: str) -> list[int]:
        """Return the boundary degrees of freedom on which a force such as ``"tip.Fz"`` acts.

        ``"tip.17.Fz"`` is the force on node 17 of a boundary of several nodes; without a number it
        is shared evenly by all nodes. ``data["boundary"]`` has the coordinate of each.
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
            message = f"the joint has no load '{name}'; its loads are {takes}"
            raise ValueError(message)
        return chosen

    def recover(
        self,
        velocity: Array,
        acceleration: Array,
        loads: dict[str, Array] | None = None,
        frame: Array | None = None,
    ) -> Array:
        """Return the pressures of the full finite element model in motion.

        Only inertia and damping forces come from the motion; contact is solved again with the
        flexibility of the whole structure.

        Parameters
        ----------
        velocity, acceleration : (n_time, n_mode)
            q̇ and q̈.
        loads
            Forces (n_time,) by names such as ``"tip.Fz"``, factors by deck load; others are zero.
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
