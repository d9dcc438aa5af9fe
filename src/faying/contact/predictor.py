"""Where forces go in an increment if no point changes sides: where Newton's method begins."""

from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Matrix
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.newton_steps import Factors, NewtonSteps

AT_BOUND = 1e-6
"""Distance from the friction bound, over it, within which a point is taken to slip on."""

FEW_BACK = 0.1
"""Share of points at their bound that may slip back before all of them are tried as stuck."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Predictor:
    """Solves increments with the law to its first order.

    Attributes
    ----------
    laws
        What the contact points admit and yield.
    steps
        Linear systems between pairs.
    scale : (3, n_point) [force/length]
        r.
    """

    laws: LawsAtPoints
    steps: NewtonSteps
    scale: Matrix

    def as_before(self, z_free: Matrix, start: Matrix) -> tuple[Matrix, Factors | None]:
        """Return forces if every point stays where it was, and the factors they were found with.

        Points at their friction bound slip on. Those that would slip back, as all do where a load
        reverses, stick, and it is tried once more.
        """
        start = self.laws.admissible(start, None)
        outward, x = np.full(start.shape[1], 1.0 + AT_BOUND), start
        for _ in range(2):
            trial = np.stack([start[0], outward * start[1], outward * start[2]])
            slope = self.laws.derivative(trial, None)
            try:
                x, factors = self._solved(z_free, start, trial, slope)
            except LinAlgError:
                return start, None
            slip = self._slack(x, z_free)[1:]
            slips = (slope[:, 0, 0] > 0) & (slope[:, 1:, 1:].trace(axis1=1, axis2=2) < 2)
            back = slips & ((slip * start[1:]).sum(axis=0) > 0)
            if np.count_nonzero(back) <= FEW_BACK * np.count_nonzero(slips):
                break
            outward[back] = 1.0 - AT_BOUND
        return x, factors

    def as_in(self, trial: Matrix, z_free: Matrix, start: Matrix) -> tuple[Matrix, Factors | None]:
        """Return forces if every point is where x − r z of another increment tells."""
        start = self.laws.admissible(start, None)
        try:
            return self._solved(z_free, start, trial, self.laws.derivative(trial, None))
        except LinAlgError:
            return start, None

    def _solved(
        self, z_free: Matrix, start: Matrix, trial: Matrix, slope: Matrix
    ) -> tuple[Matrix, Factors | None]:
        """Solve F = 0 with what is admissible to the first order about a trial."""
        away = start - self.scale * self._slack(start, z_free) - trial
        admissible = self.laws.admissible(trial, None) + np.einsum("pij,jp->ip", slope, away)
        compliance = self.laws.closure(start)[1]
        dx, factors = self.steps.step(start - admissible, slope, self.scale, compliance)
        return start + dx, factors

    def _slack(self, x: Matrix, z_free: Matrix) -> Matrix:
        return np.asarray(self.steps.moved(x) + self.laws.closure(x)[0] + z_free)
