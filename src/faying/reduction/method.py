"""Methods of reduction: construction, and name and meaning in reports."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from faying._typing import Matrix
from faying.joint.model import Model
from faying.joint.system import System
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.projection import projected


@dataclass(frozen=True, eq=False, kw_only=True)
class OfflineData:
    """Data from which methods are built, besides the model.

    Attributes
    ----------
    classic
        Result of :func:`faying.craig_bampton`.
    contact_forces : (n_point, n_snapshot) [force]
        λ of training runs; without columns if no method uses them.
    subareas, weight
        Test loads of method A and the inner product of its POD, as :func:`faying.jim_a` takes them.
    """

    classic: Basis
    contact_forces: Matrix
    subareas: int = 200
    weight: Literal["K", "I"] = "K"


CLASSIC = "classic"
"""Name of the basis without joint modes."""


@dataclass(frozen=True, kw_only=True)
class JointModes:
    """A kind of joint modes that extend the classic basis; several methods may share it.

    Attributes
    ----------
    name
        Name of the basis, and of the stage of a run that builds it.
    extended
        Function of the model, the offline data and the number of joint modes; returns the classic
        basis with joint modes that vanish on the boundary, ordered by importance.
    trained
        Whether it uses the training forces.
    """

    name: str
    extended: Callable[[Model, OfflineData, int], Basis]
    trained: bool = False


@dataclass(frozen=True, kw_only=True)
class Method:
    """A method to reduce a model.

    Attributes
    ----------
    name
        Name in studies.
    meaning
        Explanation in one sentence for readers new to the method.
    colour, marker
        Style in every figure, as matplotlib names them.
    joint_modes
        Joint modes of its basis; None for the classic basis.
    compliance
        Whether the residual interface compliance is kept.
    forces
        For methods that reduce contact forces instead of displacements: function of the model,
        training forces and the number of vectors or points; returns a system for statics.
    source
        Publication of a method included for comparison, which studies compare only by name.
    on_request
        Whether studies compare it only by name, without a publication.
    """

    name: str
    meaning: str
    colour: str
    marker: str
    joint_modes: JointModes | None = None
    compliance: bool = False
    forces: Callable[[Model, Matrix, int], System] | None = None
    source: str = ""
    on_request: bool = False

    @property
    def basis_name(self) -> str:
        """Name of its basis, which other methods may share."""
        return self.joint_modes.name if self.joint_modes else CLASSIC

    @property
    def compared(self) -> bool:
        """Whether studies without a list of methods compare it."""
        return not self.source and not self.on_request

    @property
    def trained(self) -> bool:
        """Whether the method learns from training runs."""
        by_modes = self.joint_modes is not None and self.joint_modes.trained
        return by_modes or self.forces is not None

    @property
    def transient(self) -> bool:
        """Whether the reduced model can be integrated in time, not only solved statically."""
        return self.forces is None

    def counts(self, basis: Basis, sizes: Sequence[int]) -> list[int]:
        """Return the sizes to build: numbers of joint modes, as far as there are any; 0 without."""
        if self.forces is not None:
            return list(sizes)
        available = basis.count(ModeKind.JOINT) if self.joint_modes else 0
        return sorted({min(count, available) for count in sizes}) if available else [0]

    def reduced(self, model: Model, basis: Basis, contact_forces: Matrix, count: int) -> System:
        """Return the reduced model of a size, without recovery matrices for pressures.

        Parameters
        ----------
        basis
            The classic basis, extended by :attr:`joint_modes` if there are any.
        contact_forces : (n_point, n_snapshot) [force]
            λ of training runs.
        count
            Number of joint modes, force vectors or sampling points.
        """
        if self.forces is not None:
            return self.forces(model, contact_forces, count)
        rom = projected(model, basis.with_joint_modes(count), compliance=self.compliance)
        return replace(rom, method=self.name)
