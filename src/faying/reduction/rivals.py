"""Reductions from the literature that a user can name, to compare on their own model."""

from collections.abc import Callable
from dataclasses import dataclass

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.joint.model import Model
from faying.joint.system import System
from faying.reduction.basis import Basis
from faying.reduction.deim import deim, with_deim
from faying.reduction.force_basis import (
    cone_projected_greedy,
    nonnegative_factors,
    with_force_basis,
)
from faying.reduction.reduced_model import reduce
from faying.reduction.trial_vector_derivatives import trial_vector_derivatives


@dataclass(frozen=True, kw_only=True)
class Rival:
    """A reduction from the literature.

    Attributes
    ----------
    name
        As users spell it.
    source
        Where it comes from.
    build
        Takes the model, its classic basis, training contact forces (n_point, n_snapshot) and the
        number of vectors; returns the system to solve.
    trained
        Whether it needs the training forces.
    transient
        Whether it can be integrated in time, not only solved statically.
    """

    name: str
    source: str
    build: Callable[[Model, Basis, Matrix, int], System]
    trained: bool
    transient: bool


def _trial_vector_derivatives(model: Model, classic: Basis, _: Matrix, count: int) -> System:
    return reduce(model, trial_vector_derivatives(model, joint_modes=count, classic=classic))


def _cone_greedy(model: Model, _: Basis, forces: Matrix, count: int) -> System:
    return with_force_basis(model, cone_projected_greedy(forces, count=count))


def _nonnegative_factors(model: Model, _: Basis, forces: Matrix, count: int) -> System:
    return with_force_basis(model, nonnegative_factors(forces, count=count))


def _deim(model: Model, _: Basis, forces: Matrix, count: int) -> System:
    return with_deim(model, deim(forces, count=count))


RIVALS = {
    rival.name: rival
    for rival in (
        Rival(
            name="trial-vector-derivatives",
            source="Pichler, Witteveen & Fischer 2017, doi:10.1007/s11044-016-9555-2",
            build=_trial_vector_derivatives,
            trained=False,
            transient=True,
        ),
        Rival(
            name="cone-greedy",
            source="Benaceur, Ern & Ehrlacher 2020, doi:10.1002/nme.6261",
            build=_cone_greedy,
            trained=True,
            transient=False,
        ),
        Rival(
            name="nmf",
            source="Balajewicz, Amsallem & Farhat 2016, arXiv:1503.01000",
            build=_nonnegative_factors,
            trained=True,
            transient=False,
        ),
        Rival(
            name="deim",
            source="Chaturantabut & Sorensen 2010, doi:10.1137/090766498",
            build=_deim,
            trained=True,
            transient=False,
        ),
    )
}


def rival_system(
    name: str, model: Model, *, classic: Basis, contact_forces: Matrix, count: int
) -> System:
    """Build a rival reduction of a model by name.

    Parameters
    ----------
    name
        A key of :data:`RIVALS`.
    classic
        Result of :func:`faying.craig_bampton`.
    contact_forces : (n_point, n_snapshot) [force]
        λ of training runs; not looked at by rivals that need no training.
    count
        Joint modes, force vectors or sampling points.

    Raises
    ------
    ModelError
        If there is no such rival, or it cannot be built.
    """
    if name not in RIVALS:
        message = f"there is no rival reduction '{name}'; they are {', '.join(RIVALS)}"
        raise ModelError(message)
    return RIVALS[name].build(model, classic, contact_forces, count)
