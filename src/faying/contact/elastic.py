"""Elastic contact problems in sequence: each from the last one if that is similar, else anew."""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
import scipy.linalg as la

from faying._typing import Mask, SparseMatrix, Vector
from faying.contact.active_set import ActiveSetSpace, solve_complementarity
from faying.contact.forces import ContactForces
from faying.contact.state import ContactState
from faying.contact.supported_pairs import (
    InaccurateError,
    SupportedCompliance,
    SupportedPairs,
)

FEW_PAIRS = 300
"""Pairs up to which supporting them costs no more than the factorizations it replaces."""

LEAST_TOUCHED = 1 / 8
"""Pairs in contact over all pairs from which supporting more pairs pays.

All pairs take part in what is made for the springs, only those in contact in a factorization.
"""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class ElasticContact:
    """Solver of elastic contact with a dense compliance.

    Attributes
    ----------
    space
        The flexibility, in the form in which it is solved anew.
    pairs
        The same, in the form in which it is solved from a similar problem.
    """

    space: ActiveSetSpace
    pairs: SupportedPairs

    def solve(
        self, g_free: Vector, state: ContactState | None = None
    ) -> tuple[ContactForces, ContactState]:
        """Solve s = H λ + g_free ≥ 0, λ ≥ 0, λᵀ s = 0, from where the last problem ended.

        Raises
        ------
        ConvergenceError
            If H is not positive semidefinite.

        Notes
        -----
        Where the problem is similar to the last one, a product with E per linear system; else a
        factorization each (:func:`~.active_set.solve_complementarity`).
        """
        start = g_free < 0 if state is None else state.active
        found = self._from_similar(g_free, start, state)
        if found is None:
            forces = solve_complementarity(self.space, g_free, start)
            found = forces, ContactState(active=forces.active)
        forces, after = found
        steady = state is not None and self.pairs.near(state.active, forces.active)
        return forces, ContactState(
            active=forces.active, supported=after.supported, steady=steady, factor=after.factor
        )

    def _from_similar(
        self, g_free: Vector, start: Mask, state: ContactState | None
    ) -> tuple[ContactForces, ContactState] | None:
        try:
            support = self._support(start, state)
            return None if support is None else self.pairs.solve(g_free, start, support)
        except (la.LinAlgError, InaccurateError):
            return None

    def _support(self, start: Mask, state: ContactState | None) -> SupportedCompliance | None:
        """Return the E to begin with: that at hand, a new one where it pays, or none."""
        if state is not None and state.supported is not None:
            if not self.pairs.near(state.supported, start):
                return self.pairs.supported(start)
            return self.pairs.at_hand(state)
        few = len(self.pairs.S) <= FEW_PAIRS
        steady = state is not None and state.steady and self._enough(start)
        return self.pairs.supported(start) if few or steady else None

    def _enough(self, active: Mask) -> bool:
        touched = np.count_nonzero(self._touching @ active)
        return bool(touched >= LEAST_TOUCHED * len(self.pairs.S))

    @cached_property
    def _touching(self) -> SparseMatrix:
        return abs(self.pairs.N).T.tocsr()
