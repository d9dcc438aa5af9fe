"""Periodic motion of a joint under harmonic loads, in modal coordinates on the exact statics.

The unknowns are harmonics q_k, k = 0 … H, of a few M-orthonormal shapes φ, such as modes of small
vibrations with every closed point stuck. Their motion q(t) = φᵀ M (u − u₀) is prescribed, and
everything else follows along two periods of N increments, of which the second one counts: under
forces M φ a(t) that make the shapes move so, and f(t) − M Y ẍ(t) − C (φ q̇(t) + Y ẋ(t)), with

    a_k = k² ω² q_k.                                                                        (F11)

The rest Y x is that of the stuck joint (F17); what slip and opening add to it is quasi-static.
Other harmonics are none of these shapes, whose inertia holds them, and the static ones of all else.
Contact is that of paths: increments (F12) of the points that slip, open or close, all others being
springs (F10), and no force of contact is cut at H.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from faying._typing import ComplexMatrix, ComplexVector, Indices, Mask, Matrix, Vector
from faying.contact.stuck_points import LocalContact, StuckPoints
from faying.joint.system import System
from faying.model.bolt import Bolt
from faying.simulation.local_path import (
    Excess,
    LocalPath,
    OffSprings,
    changed_by,
    follow_local,
    local_derivatives,
)
from faying.simulation.stuck_rest import StuckRest

PERIODS = 2
"""Periods of a path; the end of the second differed from its start by 1e-6 of the amplitude."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ModalLoads:
    """Load columns and their effects: both parts of f, then q, −M Y ẍ, and −C (φ q̇ + Y ẋ).

    Effects are displacements, and the force −a at q.

    Attributes
    ----------
    rest
        Shapes, and the rest.
    restrained : (n_relative, n_column + n_output)
        Displacements of the pairs per column and per force at outputs, all closed points stuck.
    answers : (n_column + n_output, n_column)
        Displacements along loads and outputs, and −a at q, per column.
    prescribed : (n_relative, n_mode)
        Reduction of the compliance of the pairs by prescribed shapes.
    bolts
    n_boundary
    """

    rest: StuckRest
    restrained: Matrix
    answers: Matrix
    prescribed: Matrix
    bolts: Mapping[str, Bolt]
    n_boundary: int

    @classmethod
    def of(cls, system: System, stuck: StuckPoints, load: Matrix, rest: StuckRest) -> "ModalLoads":
        """Return the loads for both parts of a load (n_dof, 2), and shapes with their rest."""
        W = rest.directions
        forces = np.column_stack([load, system.M @ W, system.C @ W])
        factor, G = system.factorize_static(), system.contact.relative_operator
        still = factor.solve(forces)
        ports, n = system.port_compliance, forces.shape[1]
        outputs = [forces.T @ still]
        outputs += [still[boundary.dofs] for boundary in system.boundaries.values()]
        outputs += [bolt.elongation[None] @ still for bolt in system.bolts.values()]
        columns = [G @ still, ports.contact_columns[: ports.bolts.stop].T]
        for bolt in system.bolts.values():
            if bolt.bending is not None:
                outputs.append(bolt.bending @ still)
                rows = sp.csr_array(bolt.bending).toarray()
                lacked = 0.0 if bolt.residual_bending is None else bolt.residual_bending.T
                columns.append(G @ factor.solve(rows.T) + lacked)
        moved = np.column_stack(columns)
        restrained = stuck.restrained(moved)
        answers = np.concatenate(outputs) - moved.T @ stuck.held_back(restrained[:, :n])
        # Exchange the given a for the resulting q.
        shape = slice(2, 2 + rest.n_mode)
        root = la.cholesky(answers[shape, shape], lower=True)
        unit = la.solve_triangular(root, np.eye(len(root)), lower=True)
        prescribed = restrained[:, shape] @ unit.T
        coupled = answers[:, shape] @ unit.T
        restrained = restrained - prescribed @ coupled.T
        restrained[:, shape] = prescribed @ unit
        answers = answers - coupled @ coupled[:n].T
        answers[:, shape] = coupled @ unit
        answers[shape] = answers[:n, shape].T
        answers[shape, shape] = -unit.T @ unit
        return cls(
            rest=rest,
            restrained=restrained,
            answers=answers,
            prescribed=prescribed,
            bolts=system.bolts,
            n_boundary=ports.n_boundary,
        )

    @property
    def n_mode(self) -> int:
        """Number of shapes."""
        return self.rest.n_mode

    @property
    def n_column(self) -> int:
        """Number of load columns."""
        return 2 + 2 * int(self.rest.directions.shape[1])

    @property
    def damped(self) -> slice:
        """Columns of damping."""
        return slice(self.n_column - self.rest.directions.shape[1], self.n_column)

    def factors(self, circular: float) -> tuple[ComplexMatrix, ComplexMatrix]:
        """Return harmonics of the columns per load and q (n_column, 1 + n_mode), and slopes over ω.

        All are of one circular frequency.
        """
        x, slope = self.rest.led(circular)
        swung = np.vstack([np.eye(self.n_mode, 1 + self.n_mode, 1), x])
        turned = np.vstack([np.zeros((self.n_mode, 1 + self.n_mode)), slope])
        load = np.outer([1.0, 1j], np.eye(1, 1 + self.n_mode))
        inertia = circular**2 * slope + 2 * circular * x
        columns = [load, swung[: self.n_mode], circular**2 * x, -1j * circular * swung]
        slopes = [0 * load, turned[: self.n_mode], inertia, -1j * (swung + circular * turned)]
        return np.concatenate(columns), np.concatenate(slopes)

    def stuck(self, circular: float) -> ComplexVector:
        """Return boundary displacements (n_boundary,) [length] under the load without slip."""
        q = self.rest.swung(circular)[: self.n_mode]
        columns = self.factors(circular)[0] @ np.append(1.0, q)
        return np.asarray(self.answers[self.n_column :][: self.n_boundary] @ columns)

    def bolt_forces(self, outputs: Matrix) -> Matrix:
        """Return changes of bolt forces (n_bolt, N) [force] due to the motion."""
        first = self.n_column + self.n_boundary
        stiffness = np.array([[bolt.stiffness] for bolt in self.bolts.values()])
        return stiffness.reshape(-1, 1) * outputs[first : first + len(self.bolts)]

    def bolt_moments(self, outputs: Matrix) -> dict[str, Matrix]:
        """Return changes of bolt bending moments (N, 2, 2) due to the motion, by bolt."""
        first = self.n_column + self.n_boundary + len(self.bolts)
        bent = [name for name, bolt in self.bolts.items() if bolt.bending is not None]
        ends = outputs[first:].T.reshape(outputs.shape[1], len(bent), 2, 2)
        return {name: ends[:, number] for number, name in enumerate(bent)}


@dataclass(frozen=True, eq=False, kw_only=True)
class Motion:
    """One periodic motion, solved or on the way there.

    Attributes
    ----------
    harmonics : (H + 1, n_mode) complex
        q_k, the mean first.
    circular : [1/time]
    path
        Increments of all periods.
    outputs : (n_output, N)
        −a at q, what loads, boundaries and bolts move, and bend bolts, along the last period.
    """

    harmonics: ComplexMatrix
    circular: float
    path: LocalPath
    outputs: Matrix


@dataclass(frozen=True, eq=False, kw_only=True)
class Derivatives:
    """Derivatives by the unknowns and, in the last place, by ω.

    Attributes
    ----------
    residual : (size, size + 1)
    columns : (N, n_column, size + 1)
        Derivatives of the load columns along a period.
    excess : (PERIODS N,)
        Derivatives of the forces beyond those of springs.
    """

    residual: Matrix
    columns: Matrix
    excess: Excess

    def at(self, rows: Indices) -> "Derivatives":
        """Return the derivatives with μ at other rows, after points were added."""
        return replace(self, excess=[(rows[old], change) for old, change in self.excess])


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
    pairs : (H + 1, n_mode)
        Harmonics of each shape that are unknown; the others are nil.
    samples
        N.
    """

    stuck: StuckPoints
    local: LocalContact
    loads: ModalLoads
    level: float
    pairs: Mask
    samples: int

    @classmethod
    def of(
        cls, stuck: StuckPoints, points: Indices, loads: ModalLoads, **numbers: Any
    ) -> "PeriodicProblem":
        """Return the problem for points (n,) to watch."""
        driven = replace(stuck, prescribed=loads.prescribed)
        return cls(stuck=driven, local=driven.local(points), loads=loads, **numbers)

    @property
    def size(self) -> int:
        """Number of real unknowns."""
        return int(self.pairs.sum() + self.pairs[1:].sum())

    @property
    def n_harmonic(self) -> int:
        """H."""
        return len(self.pairs) - 1

    @cached_property
    def _angles(self) -> Matrix:
        """kθ (N, H + 1) at the samples of a period."""
        theta = 2 * np.pi * np.arange(1, self.samples + 1) / self.samples
        return theta[:, None] * np.arange(self.n_harmonic + 1)

    def packed(self, harmonics: ComplexMatrix) -> Vector:
        """Return harmonics (H + 1, n_mode) as real unknowns, real parts first."""
        turning = self.pairs[1:]
        return np.concatenate([harmonics.real[self.pairs], harmonics[1:].imag[turning]])

    def unpacked(self, unknowns: Vector) -> ComplexMatrix:
        """Return the harmonics of real unknowns."""
        harmonics, n = np.zeros(self.pairs.shape, dtype=complex), int(self.pairs.sum())
        harmonics[self.pairs] = unknowns[:n]
        harmonics[1:][self.pairs[1:]] += 1j * unknowns[n:]
        return harmonics

    def _given(self, harmonics: ComplexMatrix) -> ComplexMatrix:
        """Return the load and q of all harmonics (H + 1, 1 + n_mode)."""
        given = np.pad(harmonics, ((0, 0), (1, 0)))
        given[1, 0] = self.level
        return given

    def _driven(self, harmonics: ComplexMatrix, circular: float) -> ComplexMatrix:
        """Return harmonics of the load columns (H + 1, n_column)."""
        order = circular * np.arange(self.n_harmonic + 1)
        factors = [self.loads.factors(each)[0] for each in order.tolist()]
        return np.asarray(np.einsum("kcm,km->kc", factors, self._given(harmonics)))

    def _columns(self, harmonics: ComplexMatrix, circular: float) -> Matrix:
        """Return factors of the load columns along a period (N, n_column)."""
        return np.asarray((np.exp(1j * self._angles) @ self._driven(harmonics, circular)).real)

    def moved(self, motion: Motion) -> ComplexMatrix:
        """Return harmonics of all directions (H + 1, n_mode + n_rest)."""
        order = motion.circular * np.arange(self.n_harmonic + 1)
        led = np.array([self.loads.rest.led(each)[0] for each in order.tolist()])
        rest = np.einsum("krm,km->kr", led, self._given(motion.harmonics))
        return np.column_stack([motion.harmonics, rest])

    @cached_property
    def _at_points(self) -> Matrix:
        """Effect of load columns and outputs at the points, all stuck (components n_local, …)."""
        return np.asarray(self.local.rows @ self.loads.restrained[self.local.pairs])

    def follow(
        self,
        unknowns: Vector,
        circular: float,
        guesses: Sequence[Matrix] = (),
        kept: Sequence[OffSprings | None] = (),
    ) -> Motion:
        """Return the motion along all periods for given motion of the modes.

        Guesses are μ of the PERIODS N increments (PERIODS N, components n_local) [force]; ``kept``
        are factors from a similar path.

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
            period=self.samples,
            guesses=guesses,
            kept=kept,
        )
        outputs = self.loads.answers @ columns[-self.samples :].T
        outputs += self._at_points.T @ path.excess(local)[:, -self.samples :]
        return Motion(harmonics=harmonics, circular=circular, path=path, outputs=outputs)

    def _harmonics(self, values: Matrix) -> ComplexMatrix:
        """Return harmonics 0 … H (H + 1, n) of samples (N, n)."""
        wave = np.exp(-1j * self._angles) / self.samples
        wave[:, 1:] *= 2
        return np.asarray(np.tensordot(wave, values, (0, 0)))

    def residual(self, motion: Motion) -> Vector:
        """Return k² ω² q_k less a_k of the path, as real unknowns."""
        order = motion.circular * np.arange(self.n_harmonic + 1)[:, None]
        given = self._harmonics(motion.outputs[2 : 2 + self.loads.n_mode].T)
        return self.packed(order**2 * motion.harmonics + given)

    def derivatives(self, motion: Motion) -> "Derivatives":
        """Return derivatives of the residual and of the path, exact along it."""
        H, m, N = self.n_harmonic, self.loads.n_mode, self.samples
        size, n = self.size, self.loads.n_column
        wave, order = np.exp(1j * self._angles), motion.circular * np.arange(H + 1)
        factors, slopes = map(np.array, zip(*map(self.loads.factors, order.tolist()), strict=True))
        # Derivatives of the load columns by the unknowns.
        order_of, mode_of = np.nonzero(self.pairs)
        added = wave[:, None, order_of] * factors[order_of, :, 1 + mode_of].T
        given = self._given(motion.harmonics) * np.arange(H + 1)[:, None]
        per_frequency = (wave @ np.einsum("kcm,km->kc", slopes, given)).real
        columns = np.dstack([added.real, -added.imag[:, :, order_of > 0], per_frequency])
        modal = slice(2, 2 + m)
        change = np.einsum("mc,ncx->nmx", self.loads.answers[modal], columns)
        shapes = self._at_points[:, :n]
        excess = local_derivatives(self.local, motion.path, shapes, columns)
        for number, (rows, per_unknown) in enumerate(excess[-N:]):
            change[number] += shapes[rows, modal].T @ per_unknown
        answer = self._harmonics(change)[self.pairs]
        result = np.concatenate([answer.real, answer[order_of > 0].imag])
        squares = order[order_of] ** 2
        result[:, :size] += np.diag(np.concatenate([squares, squares[order_of > 0]]))
        inertia = 2 * (order**2 / motion.circular)[:, None] * motion.harmonics
        result[:, size] += self.packed(inertia)
        return Derivatives(residual=result, columns=columns, excess=excess)

    def displaced(self, unknowns: Vector, circular: float, excess: Matrix) -> Matrix:
        """Return δ of all pairs along all periods (n_relative, PERIODS N) under some μ."""
        columns = np.tile(self._columns(self.unpacked(unknowns), circular), (PERIODS, 1))
        restrained = self.loads.restrained[:, : self.loads.n_column]
        shared = self.stuck.shared(self.local.pairs, self.local.rows.T @ excess.T)
        return np.asarray(restrained @ columns.T + shared)

    def begun(
        self, motion: Motion, change: Vector | None = None, by: Derivatives | None = None
    ) -> Matrix:
        """Return μ along a motion (PERIODS N, …), extrapolated for a change of unknowns and ω."""
        if change is None or by is None:
            return motion.path.excess(self.local).T
        return changed_by(motion.path, self.local, by.excess, change)

    def turned(self, motion: Motion, change: Vector) -> tuple[Vector, Matrix]:
        """Return unknowns (size,) after a change, as a phase shift and a remainder; and shifted μ.

        Close to a resonance the motion changes its phase much and its amplitude little.
        """
        h, rate = motion.harmonics, self.unpacked(change)
        size = float(np.vdot(h[1], h[1]).real)
        angle = float(np.vdot(h[1], rate[1]).imag) / size if size > 0 else 0.0
        turn = 1j * angle * np.arange(self.n_harmonic + 1)[:, None]
        harmonics = np.exp(turn) * (h + rate - turn * h)
        last = motion.path.excess(self.local).T[-self.samples :]
        later = np.arange(PERIODS * self.samples) + angle * self.samples / (2 * np.pi)
        first = np.floor(later).astype(np.int64)
        share = (later - first)[:, None]
        ahead = last[(first + 1) % self.samples]
        return self.packed(harmonics), (1 - share) * last[first % self.samples] + share * ahead

    def watching(self, points: Indices) -> tuple["PeriodicProblem", Indices]:
        """Return the problem with points (n,) added, and the new rows of its former μ."""
        every = np.union1d(self.local.points, points)
        at = np.searchsorted(every, self.local.points)
        rows = len(every) * np.arange(self.local.components)[:, None] + at
        return replace(self, local=self.stuck.local(every)), rows.ravel()
