"""What a method of reduction is: how it is built, and how readers of a report meet it."""

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
    """What methods are built from, besides the model.

    Attributes
    ----------
    classic
        Result of :func:`faying.craig_bampton`.
    contact_forces : (n_point, n_snapshot) [force]
        λ of training runs; without columns where no method asks for them.
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
    """A way to extend the classic basis by joint modes, which several methods may share.

    Attributes
    ----------
    name
        Of the basis, and of the stage of a run that builds it.
    extended
        Takes the model, the offline data and the number of joint modes; returns the classic basis
        and joint modes that vanish on the boundary, ordered by importance.
    trained
        Whether it looks at the training forces.
    """

    name: str
    extended: Callable[[Model, OfflineData, int], Basis]
    trained: bool = False


@dataclass(frozen=True, kw_only=True)
class Method:
    """A way to reduce a model.

    Attributes
    ----------
    name
        As studies spell it.
    meaning
        A sentence for readers who meet the name for the first time.
    colour, marker
        In every figure, as matplotlib names them.
    joint_modes
        What its basis has beyond the classic one; None for nothing.
    compliance
        Whether the residual interface compliance is kept.
    forces
        For methods that reduce contact forces instead of displacements: takes the model, training
        forces and the number of vectors or points; returns a system for statics.
    source
        Publication of a method that is here to compare with; studies compare the others unless
        they name methods.
    on_request
        Whether studies compare it only where they name it.
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
        """Name of its basis, which it may share with other methods."""
        return self.joint_modes.name if self.joint_modes else CLASSIC

    @property
    def compared(self) -> bool:
        """Whether studies compare it that name no methods."""
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
        """Return the sizes it is built at: joint modes as far as there are any, or 0 without."""
        if self.forces is not None:
            return list(sizes)
        available = basis.count(ModeKind.JOINT) if self.joint_modes else 0
        return sorted({min(count, available) for count in sizes}) if available else [0]

    def reduced(self, model: Model, basis: Basis, contact_forces: Matrix, count: int) -> System:
        """Return the reduced model of a size, without what recovers pressures.

        Parameters
        ----------
        basis
            The classic basis, extended by :attr:`joint_modes` if there are any.
        contact_forces : (n_point, n_snapshot) [force]
            λ of training runs.
        count
            Joint modes, force vectors or sampling points.
        """
        if self.forces is not None:
            return self.forces(model, contact_forces, count)
        rom = projected(model, basis.with_joint_modes(count), compliance=self.compliance)
        return replace(rom, method=self.name)
