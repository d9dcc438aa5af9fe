"""What a method of reduction is: how it is built, and how readers of a report meet it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from faying._typing import Matrix
from faying.joint.model import Model
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.projection import projected
from faying.reduction.reduced_model import ReducedModel


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
    on_request
        Whether studies compare it only where they name it.
    """

    name: str
    meaning: str
    colour: str
    marker: str
    joint_modes: JointModes | None = None
    compliance: bool = False
    on_request: bool = False

    @property
    def basis_name(self) -> str:
        """Name of its basis, which it may share with other methods."""
        return self.joint_modes.name if self.joint_modes else CLASSIC

    @property
    def trained(self) -> bool:
        """Whether it learns from training runs."""
        return self.joint_modes is not None and self.joint_modes.trained

    def counts(self, basis: Basis, sizes: Sequence[int]) -> list[int]:
        """Return the sizes it is built at: joint modes as far as there are any, or 0 without."""
        available = basis.count(ModeKind.JOINT) if self.joint_modes else 0
        return sorted({min(count, available) for count in sizes}) if available else [0]

    def reduced(self, model: Model, basis: Basis, count: int) -> ReducedModel:
        """Return the reduced model with some joint modes, without what recovers pressures.

        Parameters
        ----------
        basis
            The classic basis, extended by :attr:`joint_modes` if there are any.
        """
        rom = projected(model, basis.with_joint_modes(count), compliance=self.compliance)
        return replace(rom, method=self.name)
