"""Periodic motion of a joint under harmonic loads, in modal coordinates on the exact statics.

The unknowns are the harmonics q_k, k = 1 … H, of a few modes φ of small vibrations, in which every
closed point sticks. Their inertia and damping load the joint, and everything else follows
quasi-statically along two periods of N increments, of which the second one counts:

    f(t) − M φ q̈ − C φ q̇,   q_k = φᵀ M (u − u₀)_k.                                        (F11)

Contact is that of paths: increments (F12) of the points that slip, open or close, all others being
springs (F10), and no force of contact is cut at H.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np
import numpy.typing as npt

from faying._typing import ComplexMatrix, ComplexVector, Indices, Matrix, Vector
from faying.contact.stuck_points import LocalContact, StuckPoints
from faying.joint.system import System, input_forces
from faying.simulation.local_path import LocalPath, follow_local, local_derivatives

PERIODS = 2
"""Periods of a path; what the second leaves differed from its start by 1e-6 of the amplitude."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class ModalLoads:
    """Loads in columns: both parts of f, M φ and C φ of every mode; what they do is stored once.

    Attributes
    ----------
    n_mode
    restrained : (n_relative, n_column + n_output)
        What they move the pairs with all closed points stuck, and what forces at outputs do.
    answers : (n_column + n_output, n_column)
        What they move where loads and outputs are, likewise.
    bolt_stiffness : (n_bolt,) [force/length]
    n_boundary
    """

    n_mode: int
    restrained: Matrix
    answers: Matrix
    bolt_stiffness: Vector
    n_boundary: int

    @classmethod
    def of(
        cls, system: System, stuck: StuckPoints, inputs: ComplexVector, shapes: Matrix
    ) -> "ModalLoads":
        """Return them for amplitudes of inputs (n_input,) and modes (n_dof, n_mode)."""
        parts = input_forces(system, np.array([inputs.real, inputs.imag])).T
        forces = np.column_stack([parts, system.M @ shapes, system.C @ shapes])
        still = system.factorize_static().solve(forces)
        ports, n = system.port_compliance, forces.shape[1]
        bolts = list(system.bolts.values())
        outputs = np.concatenate(
            [
                forces.T @ still,
                *(still[boundary.dofs] for boundary in system.boundaries.values()),
                np.array([bolt.elongation for bolt in bolts]).reshape(len(bolts), -1) @ still
                if bolts
                else np.zeros((0, n)),
            ]
        )
        moved = np.column_stack(
            [
                system.contact.relative_operator @ still,
                ports.contact_columns[: ports.bolts.stop].T,
            ]
        )
        restrained = stuck.restrained(moved)
        return cls(
            n_mode=shapes.shape[1],
            restrained=restrained,
            answers=outputs - moved.T @ stuck.held_back(restrained[:, :n]),
            bolt_stiffness=np.array([bolt.stiffness for bolt in bolts]),
            n_boundary=ports.n_boundary,
        )

    @property
    def n_column(self) -> int:
        """Number of load columns."""
        return 2 + 2 * self.n_mode


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Motion:
    """One periodic motion, solved or on the way there.

    Attributes
    ----------
    harmonics : (H, n_mode) complex
        q_k.
    circular : [1/time]
    path
        Increments of all periods.
    outputs : (n_output, N)
        Loads, boundaries and bolts, along the last period.
    """

    harmonics: ComplexMatrix
    circular: float
    path: LocalPath
    outputs: Matrix


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Derivatives:
    """What changes with the unknowns and, in the last place, with ω.

    Attributes
    ----------
    residual : (size, size + 1)
    moved : (PERIODS N, components n_local, size + 1)
        Of the points along the path.
    """

    residual: Matrix
    moved: npt.NDArray[np.float32]


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PeriodicProblem:
    """(F11) for one level of the load and one set of watched points.

    Attributes
    ----------
    stuck
        All points.
    local
        Those that are watched.
    loads
    level
        Factor of the load.
    n_harmonic
        H.
    samples
        N.
    """

    stuck: StuckPoints
    local: LocalContact
    loads: ModalLoads
    level: float
    n_harmonic: int
    samples: int

    @property
    def size(self) -> int:
        """Number of real unknowns."""
        return 2 * self.n_harmonic * self.loads.n_mode

    @cached_property
    def _angles(self) -> Matrix:
        """kθ (N, H) at the samples of a period."""
        theta = 2 * np.pi * np.arange(1, self.samples + 1) / self.samples
        return theta[:, None] * np.arange(1, self.n_harmonic + 1)

    def packed(self, harmonics: ComplexMatrix) -> Vector:
        """Return harmonics (H, n_mode) as real unknowns, real parts first."""
        return np.concatenate([harmonics.real.ravel(), harmonics.imag.ravel()])

    def unpacked(self, unknowns: Vector) -> ComplexMatrix:
        """Return the harmonics of real unknowns."""
        real, imaginary = unknowns.reshape(2, self.n_harmonic, self.loads.n_mode)
        return np.asarray(real + 1j * imaginary)

    def _columns(self, harmonics: ComplexMatrix, circular: float) -> Matrix:
        """Return factors of the load columns along a period (N, n_column)."""
        wave = np.exp(1j * self._angles)
        order = circular * np.arange(1, self.n_harmonic + 1)[:, None]
        first = wave[:, 0]
        force = self.level * np.column_stack([first.real, -first.imag])
        inertia = (wave @ (order**2 * harmonics)).real
        damping = (wave @ (-1j * order * harmonics)).real
        return np.hstack([force, inertia, damping])

    @cached_property
    def _at_points(self) -> Matrix:
        """What load columns and outputs do at the points with all stuck (components n_local, …)."""
        return np.asarray(self.local.rows @ self.loads.restrained[self.local.pairs])

    def follow(
        self, unknowns: Vector, circular: float, guess: Sequence[Vector] | None = None
    ) -> Motion:
        """Run through the periods under given motion of the modes.

        Parameters
        ----------
        guess : (PERIODS N,) of (components n_local,) or None [length]
            Where the points may be after each increment.

        Raises
        ------
        ConvergenceError
            If an increment is not solved.
        """
        harmonics = self.unpacked(unknowns)
        columns = np.tile(self._columns(harmonics, circular), (PERIODS, 1))
        local, n = self.local, self.loads.n_column
        path = follow_local(
            local,
            columns @ self._at_points[:, :n].T,
            columns @ self.loads.restrained[local.pairs, :n].T,
            guess,
        )
        outputs = self.loads.answers @ columns[-self.samples :].T
        outputs += self._at_points.T @ path.excess(local)[:, -self.samples :]
        return Motion(harmonics=harmonics, circular=circular, path=path, outputs=outputs)

    def _modal(self, outputs: Matrix) -> Matrix:
        """Return the rows q = φᵀ M (u − u₀) of outputs (n_mode, ...)."""
        return outputs[2 : 2 + self.loads.n_mode]

    def residual(self, motion: Motion) -> Vector:
        """Return q_k less that of the path, as real unknowns."""
        wave = 2 / self.samples * np.exp(-1j * self._angles)
        return self.packed(motion.harmonics - wave.T @ self._modal(motion.outputs).T)

    def derivatives(self, motion: Motion) -> "Derivatives":
        """Return those of the residual and of the path, exact along it."""
        H, m, N = self.n_harmonic, self.loads.n_mode, self.samples
        size, n = self.size, self.loads.n_column
        # What one unknown adds to the load columns (N, n_column, size + 1).
        order = motion.circular * np.arange(1, H + 1)
        cosine, sine = np.cos(self._angles), np.sin(self._angles)
        added = np.zeros((N, n, 2, H, m))
        mode = np.arange(m)
        for k in range(H):
            added[:, 2 + mode, 0, k, mode] = order[k] ** 2 * cosine[:, [k]]
            added[:, 2 + mode, 1, k, mode] = -(order[k] ** 2) * sine[:, [k]]
            added[:, 2 + m + mode, 0, k, mode] = order[k] * sine[:, [k]]
            added[:, 2 + m + mode, 1, k, mode] = order[k] * cosine[:, [k]]
        columns = np.zeros((N, n, size + 1))
        columns[:, :, :size] = added.reshape(N, n, size)
        per_frequency = self._columns(motion.harmonics, motion.circular) / motion.circular
        columns[:, 2 : 2 + m, size] = 2 * per_frequency[:, 2 : 2 + m]
        columns[:, 2 + m :, size] = per_frequency[:, 2 + m :]
        modal = slice(2, 2 + m)
        change = np.einsum("mc,ncx->nmx", self.loads.answers[modal], columns)
        shapes = self._at_points[:, :n]
        derivatives = local_derivatives(self.local, motion.path, shapes, columns)
        for number, (rows, excess) in enumerate(derivatives.excess[-N:]):
            change[number] += shapes[rows, modal].T @ excess
        wave = 2 / N * np.exp(-1j * self._angles)
        answer = np.einsum("nk,nmx->kmx", wave, change).reshape(H * m, size + 1)
        result = -np.concatenate([answer.real, answer.imag])
        result[:, :size] += np.eye(size)
        return Derivatives(residual=result, moved=derivatives.moved)

    def displaced(self, motion: Motion) -> Matrix:
        """Return δ of all pairs along all periods (n_relative, PERIODS N)."""
        columns = np.tile(self._columns(motion.harmonics, motion.circular), (PERIODS, 1))
        restrained = self.loads.restrained[:, : self.loads.n_column]
        pairs = self.local.rows.T @ motion.path.excess(self.local)
        shared = self.stuck.compliance[:, self.local.pairs] @ pairs
        return np.asarray(restrained @ columns.T + shared)

    def begun(
        self, motion: Motion, change: Vector | None = None, by: Derivatives | None = None
    ) -> Sequence[Vector]:
        """Return where the points were in a motion, moved on as unknowns and ω change."""
        places = motion.path.moved.copy()
        if change is not None and by is not None:
            places += by.moved @ change.astype(np.float32)
        return list(places)

    def watching(self, points: Indices) -> "PeriodicProblem":
        """Return the problem with other watched points."""
        return replace(self, local=self.stuck.local(points))
