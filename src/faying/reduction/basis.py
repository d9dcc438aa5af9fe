"""A reduction basis: trial vectors and their kinds, Eqs. (15.18) and (15.19)."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from faying._typing import Frozen, Matrix, SparseMatrix
from faying.digits import ROUND_OFF
from faying.display.facts import Shown
from faying.exceptions import refuse_model

SMALLEST_NEW_PART = 1e-8
"""A trial vector is dropped if at most this part of its energy norm is new."""


class ModeKind(StrEnum):
    """Kind of a trial vector."""

    CONSTRAINT = "constraint"
    NORMAL = "normal"
    BOLT = "bolt"
    LOAD = "load"
    RELIEF = "relief"
    JOINT = "joint"
    ATTACHMENT = "attachment"


VANISHING = tuple(kind for kind in ModeKind if kind is not ModeKind.CONSTRAINT)
"""Kinds of trial vectors that vanish on the boundary, Φ_f."""


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Basis(Frozen, Shown):
    """Shapes that a reduced model moves in: the trial vectors Φ of u ≈ Φ q, (15.15).

    Attributes
    ----------
    vectors : (n_dof, n_mode)
        One shape a column, at the free degrees of freedom of the full model. Constraint modes are
        displacements per displacement; the others are scaled to ΦᵀKΦ = 1.
    kinds : n_mode kinds
        Kind of each column: constraint, normal, bolt, load or joint.

    Examples
    --------
    >>> import faying as fy
    >>> fy.craig_bampton(fy.lap_joint(element_size=5.0), normal_modes=4)
    Basis(trial vectors: 11 (6 constraint, 4 normal, 1 bolt), degrees of freedom: 1326)
    """

    vectors: Matrix
    kinds: tuple[ModeKind, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.vectors.shape[1] != len(self.kinds):
            refuse_model(f"{self.vectors.shape[1]} trial vectors but {len(self.kinds)} kinds")

    @property
    def facts(self) -> Mapping[str, str]:
        """Number of trial vectors, by kind."""
        kinds = ", ".join(f"{n} {kind}" for kind, n in Counter(self.kinds).items())
        return {
            "trial vectors": f"{len(self)} ({kinds})" if kinds else "0",
            "degrees of freedom": str(len(self.vectors)),
        }

    def __len__(self) -> int:
        return len(self.kinds)

    def __add__(self, following: "Basis") -> "Basis":
        return Basis(
            vectors=np.hstack([self.vectors, following.vectors]), kinds=self.kinds + following.kinds
        )

    def count(self, kind: ModeKind) -> int:
        """Return the number of columns of a kind."""
        return self.kinds.count(kind)

    def of_kind(self, *kinds: ModeKind) -> Matrix:
        """Return the columns of the given kinds, in their order."""
        return self.vectors[:, [kind in kinds for kind in self.kinds]]

    def with_joint_modes(self, count: int) -> "Basis":
        """Return the basis with its first ``count`` joint modes only.

        Joint modes are ordered by importance and orthogonal to those before them, so a shorter
        basis is part of a longer one.
        """
        is_joint = np.array([kind is ModeKind.JOINT for kind in self.kinds])
        selected = ~is_joint | (np.cumsum(is_joint) <= count)
        return Basis(
            vectors=self.vectors[:, selected],
            kinds=tuple(kind for kind, keep in zip(self.kinds, selected, strict=True) if keep),
        )

    def extended(self, shapes: Matrix, kind: ModeKind, K: SparseMatrix) -> "Basis":
        """Return the basis extended by shapes, block by block where Gram-Schmidt is slow.

        Parameters
        ----------
        shapes : (n_dof, n)
            They vanish on the boundary.
        kind
            Kind of the new vectors. They are orthonormal in K, among each other and to all vectors
            of this basis that vanish on the boundary. The vectors of this basis do not change.
        """
        vanishing = self.of_kind(*VANISHING)
        energies = np.einsum("ij,ij->j", shapes, K @ shapes)
        new = shapes[:, energies > 0] / np.sqrt(energies[energies > 0])
        for _ in range(2):
            new = new - vanishing @ (vanishing.T @ (K @ new))
            gram = new.T @ (K @ new)
            parts, directions = np.linalg.eigh((gram + gram.T) / 2)
            added = parts > ROUND_OFF
            new = new @ (directions[:, added] / np.sqrt(parts[added]))
        return self + Basis(vectors=new, kinds=(kind,) * new.shape[1])

    def orthonormalized(self, K: SparseMatrix) -> "Basis":
        """Return the basis with the shapes that vanish on the boundary orthonormal in K.

        Constraint modes do not change, so the boundary rows of the basis remain [I 0] and the
        superelement form survives; they are K-orthogonal to the others already. Shapes that are
        linear combinations of earlier ones are dropped.

        Notes
        -----
        Gram-Schmidt twice per column ("twice is enough", Giraud et al. 2005,
        doi:10.1007/s00211-005-0615-4).
        """
        shapes = [i for i, kind in enumerate(self.kinds) if kind is not ModeKind.CONSTRAINT]
        candidates = self.vectors[:, shapes]
        done, stiff_done = (np.empty_like(candidates) for _ in range(2))
        kinds: list[ModeKind] = []
        for column, index in zip(candidates.T, shapes, strict=True):
            size = len(kinds)
            vector, full = column, np.sqrt(column @ (K @ column))
            for _ in range(2):
                vector = vector - done[:, :size] @ (stiff_done[:, :size].T @ vector)
            stiff = K @ vector
            energy = float(np.sqrt(vector @ stiff))
            if energy <= SMALLEST_NEW_PART * full:
                continue
            done[:, size], stiff_done[:, size] = vector / energy, stiff / energy
            kinds.append(self.kinds[index])
        constraint = self.of_kind(ModeKind.CONSTRAINT)
        return Basis(
            vectors=np.hstack([constraint, done[:, : len(kinds)]]),
            kinds=(ModeKind.CONSTRAINT,) * constraint.shape[1] + tuple(kinds),
        )
