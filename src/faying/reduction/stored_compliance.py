"""A compressed compliance as files hold it: its blocks one after another, in a few arrays."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.linalg.compressed import CompressedCompliance
from faying.reduction.model_check import check_distinct


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class StoredCompliance:
    """Clusters I of pairs with dense blocks S_II, blocks X_IJ X_JIᵀ between them, and X C Xᵀ.

    Attributes
    ----------
    members : (n_relative,) [into n_relative]
        Pairs of the first cluster, of the second, and so on.
    sizes : (n_cluster,) [1]
        Pairs of each cluster.
    diagonal : (n_entry,) [length/force]
        Entries of every S_II, row by row.
    factors : (n_factor,) [(length/force)^½]
        For each I the X_IJ of all J side by side, row by row.
    ranks : (n_cluster, n_cluster) [1]
        Columns of X_IJ.
    smooth : (n_relative, n_smooth) [1]
        X.
    core : (n_smooth, n_smooth) [length/force]
        C.
    error
        Bound on what compression left out, in the Frobenius norm.
    """

    members: Indices
    sizes: Indices
    diagonal: Vector
    factors: Vector
    ranks: Indices
    smooth: Matrix
    core: Matrix
    error: float

    def compliance(self, places: Matrix, name: str) -> CompressedCompliance:
        """Return the compliance between pairs at these places."""
        n, widths = len(places), self.ranks.sum(axis=-1)
        lengths = [len(self.members), len(self.diagonal), len(self.factors)]
        fits = (
            (self.sizes > 0).all()
            and self.sizes.sum() == n
            and self.ranks.shape == (len(self.sizes), len(self.sizes))
            and (self.ranks >= 0).all()
            and (self.ranks <= n).all()
            and (self.ranks == self.ranks.T).all()
            and lengths == [n, int(self.sizes @ self.sizes), int(self.sizes @ widths)]
            and self.smooth.shape == (n, len(self.core))
            and self.core.shape == (len(self.core), len(self.core))
        )
        numbers = (self.diagonal, self.factors, self.smooth, self.core)
        if not fits or not all(np.isfinite(part).all() for part in numbers):
            message = f"the parts of '{name}' do not fit together, or are not finite"
            raise ValueError(message)
        check_distinct(self.members, n, f"{name}/members")
        shapes = list(zip(self.sizes.tolist(), widths.tolist(), strict=True))
        return CompressedCompliance(
            clusters=tuple(np.split(self.members, np.cumsum(self.sizes)[:-1])),
            diagonal=_blocks(self.diagonal, [(size, size) for size, _ in shapes]),
            factors=_blocks(self.factors, shapes),
            ranks=self.ranks,
            smooth=self.smooth,
            core=self.core,
            places=places,
            error=self.error,
        )


def stored_compliance(compliance: CompressedCompliance) -> StoredCompliance:
    """Return what a file keeps of a compliance."""
    return StoredCompliance(
        members=np.concatenate(compliance.clusters),
        sizes=np.array([len(members) for members in compliance.clusters]),
        diagonal=np.concatenate([block.ravel() for block in compliance.diagonal]),
        factors=np.concatenate([block.ravel() for block in compliance.factors]),
        ranks=compliance.ranks,
        smooth=compliance.smooth,
        core=compliance.core,
        error=compliance.error,
    )


def _blocks(entries: Vector, shapes: list[tuple[int, int]]) -> tuple[Matrix, ...]:
    """Return matrices that follow one another, row by row."""
    ends = np.cumsum([rows * columns for rows, columns in shapes])[:-1]
    parts = np.split(entries, ends)
    return tuple(part.reshape(shape) for part, shape in zip(parts, shapes, strict=True))
