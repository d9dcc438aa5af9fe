"""The laws of all interfaces evaluated at all points, for solvers of increments."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.laws import Law


@dataclass(frozen=True, eq=False, kw_only=True)
class LawsAtPoints:
    """The laws of all interfaces as one law with three components.

    Missing components of a law carry no force.

    Attributes
    ----------
    contact
    deepest : (n_point,) or None [length]
        Largest closures so far, where some law remembers them.
    """

    contact: Contact
    deepest: Vector | None = None

    def after(self, deepest: Vector | None) -> Self:
        """Return the laws of points with these largest closures so far, if any law remembers."""
        return self if deepest is None else replace(self, deepest=deepest)

    def closed_to(self, gap: Vector) -> Vector | None:
        """Return the largest closures (n_point,) after this gap; None if no law remembers them."""
        if not self.contact.remembers:
            return None
        return -gap if self.deepest is None else np.maximum(self.deepest, -gap)

    @property
    def components(self) -> int:
        """Components of force at a point: 1, or 3 where some interface has friction."""
        return self.contact.components

    @cached_property
    def springs(self) -> Matrix:
        """Stiffness of points that are closed and stick (components, n_point) [force/length]."""
        springs = np.zeros((self.components, self.contact.n_points))
        for law, points in self.members:
            law_springs = law.springs(self.contact.weights[points])
            springs[: len(law_springs), points] = law_springs
        return springs

    def respond(self, moved: Matrix) -> tuple[Matrix, Matrix]:
        """Return forces (components, n_point) at displacements, and their stiffness −∂λ/∂moved."""
        if len(self.members) == 1:
            law, _ = self.members[0]
            return law.respond(moved, self.contact.weights)
        forces = np.zeros_like(moved)
        stiffness = np.zeros((moved.shape[1], len(moved), len(moved)))
        for law, points in self.members:
            n = law.components
            answer = law.respond(moved[:n, points], self.contact.weights[points])
            forces[:n, points], stiffness[points, :n, :n] = answer
        return forces, stiffness

    def side_by_side(self, gaps: Matrix) -> tuple[Matrix, Matrix]:
        """Return normal forces (n_point, n_case) at gaps, and −∂λ/∂gap of equal shape."""
        forces, stiffness = np.empty_like(gaps), np.empty_like(gaps)
        for law, points in self.members:
            weights = np.repeat(self.contact.weights[points], gaps.shape[1])
            answer, slope = law.normal.respond(gaps[points].reshape(1, -1), weights)
            forces[points] = answer.reshape(-1, gaps.shape[1])
            stiffness[points] = slope.reshape(-1, gaps.shape[1])
        return forces, stiffness

    def yielded(self, forces: Matrix) -> Matrix:
        """Return closures of the laws under forces (components, n_point) [length]."""
        whole = np.zeros((3, self.contact.n_points))
        whole[: len(forces)] = forces
        return self.closure(whole)[0][: len(forces)]

    def closure(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        """Return c(x) [length] and c′(x) [length/force], (3, n_point) each."""
        if self._compliance is not None:
            return self._compliance * forces, self._compliance
        return self._evaluate_closure(forces)

    @cached_property
    def _compliance(self) -> Matrix | None:
        """The compliance c′ where all laws are proportional, so that it is formed once."""
        if not all(law.proportional for law, _ in self.members):
            return None
        return self._evaluate_closure(np.zeros((3, self.contact.n_points)))[1]

    def _evaluate_closure(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        closed, compliance = np.zeros_like(forces), np.zeros_like(forces)
        for law, points in self.members:
            block = slice(law.components), points
            closed[block], compliance[block] = law.closure(
                forces[block], self.contact.weights[points]
            )
        return closed, compliance

    def admissible(self, forces: Matrix) -> Matrix:
        """Return the admissible forces (3, n_point) nearest to given ones."""
        result = np.zeros_like(forces)
        for law, points in self.members:
            block = slice(law.components), points
            result[block] = law.admissible(forces[block])
        return result

    def derivative(self, forces: Matrix) -> Matrix:
        """Return the derivative of the admissible forces (n_point, 3, 3)."""
        result = np.zeros((forces.shape[1], 3, 3))
        for law, points in self.members:
            n = law.components
            result[points, :n, :n] = law.derivative(forces[:n, points])
        return result

    @cached_property
    def members(self) -> list[tuple[Law, slice]]:
        """Each law, and its points."""
        laws = self.contact.laws
        if self.deepest is not None:
            laws = {n: laws[n].after(self.deepest[at]) for n, at in self.contact.slices.items()}
        return [(laws[name], points) for name, points in self.contact.slices.items()]
