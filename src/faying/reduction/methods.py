"""The methods that a study can name, with construction, meaning and style.

The first six are compared by default. The seventh, for transients, is compared by name, and where
``compliance`` is estimated to be inaccurate. The others come from the literature and are included
for comparison. Colours are from Okabe and Ito's palette, distinguishable with every colour vision
(Color Universal Design, 2008), those of the literature's methods from Tol's muted scheme
(SRON/EPS/TN/09-002).
"""

from collections.abc import Mapping
from types import MappingProxyType

from faying._typing import Matrix
from faying.joint.model import Model
from faying.joint.system import System
from faying.reduction.attachment import attachment_modes
from faying.reduction.basis import Basis
from faying.reduction.deim import deim, with_deim
from faying.reduction.force_basis import (
    cone_projected_greedy,
    nonnegative_factors,
    with_force_basis,
)
from faying.reduction.jim_a import jim_a
from faying.reduction.jim_b import jim_b
from faying.reduction.method import JointModes, Method, OfflineData
from faying.reduction.trial_vector_derivatives import trial_vector_derivatives

_CONSTRAINED = (
    "constraint modes of the boundaries, fixed-interface normal modes and a shape per bolt"
)
_ONLY_THROUGH = "the reduced model sees contact through these shapes only"
_EXACT = (
    "the flexibility that these shapes lack at the interface is added as a residual compliance, "
    "which makes static pressures those of the full model"
)


def _test_loads(model: Model, data: OfflineData, count: int) -> Basis:
    return jim_a(
        model,
        joint_modes=count,
        subarea_count=data.subareas,
        weight=data.weight,
        classic=data.classic,
    )


def _training_forces(model: Model, data: OfflineData, count: int) -> Basis:
    return jim_b(model, data.contact_forces, joint_modes=count, classic=data.classic)


def _derivatives(model: Model, data: OfflineData, count: int) -> Basis:
    return trial_vector_derivatives(model, joint_modes=count, classic=data.classic)


def _attachments(model: Model, data: OfflineData, count: int) -> Basis:  # noqa: ARG001
    return attachment_modes(model, classic=data.classic)


def _cone_greedy(model: Model, forces: Matrix, count: int) -> System:
    return with_force_basis(model, cone_projected_greedy(forces, count=count))


def _nonnegative_factors(model: Model, forces: Matrix, count: int) -> System:
    return with_force_basis(model, nonnegative_factors(forces, count=count))


def _deim(model: Model, forces: Matrix, count: int) -> System:
    return with_deim(model, deim(forces, count=count))


_JIM_A = JointModes(name="jim-a", extended=_test_loads)
_JIM_B = JointModes(name="jim-b", extended=_training_forces, trained=True)
_DERIVATIVES = JointModes(name="trial-vector-derivatives", extended=_derivatives)
_ATTACHED = JointModes(name="attachment modes", extended=_attachments)

METHODS: Mapping[str, Method] = MappingProxyType(
    {
        method.name: method
        for method in (
            Method(
                name="craig-bampton",
                meaning=f"{_CONSTRAINED}; {_ONLY_THROUGH}.",
                colour="#E69F00",
                marker="s",
            ),
            Method(
                name="jim-a",
                meaning="as craig-bampton, and joint modes of method A: answers to unit pressures "
                f"on patches of the interface; {_ONLY_THROUGH}.",
                colour="#D55E00",
                marker="o",
                joint_modes=_JIM_A,
            ),
            Method(
                name="jim-b",
                meaning="as craig-bampton, and joint modes of method B: answers to the contact "
                f"forces of training runs; {_ONLY_THROUGH}.",
                colour="#0072B2",
                marker="^",
                joint_modes=_JIM_B,
            ),
            Method(
                name="compliance",
                meaning=f"{_CONSTRAINED}; {_EXACT}.",
                colour="#009E73",
                marker="D",
                compliance=True,
            ),
            Method(
                name="jim-a+compliance",
                meaning=f"as jim-a; {_EXACT}.",
                colour="#CC79A7",
                marker="v",
                joint_modes=_JIM_A,
                compliance=True,
            ),
            Method(
                name="jim-b+compliance",
                meaning=f"as jim-b; {_EXACT}.",
                colour="#56B4E9",
                marker="P",
                joint_modes=_JIM_B,
                compliance=True,
            ),
            Method(
                name="compliance+inertia",
                meaning=f"{_CONSTRAINED}, static shapes of unit forces between all contact pairs, "
                "and of the inertia forces of these shapes; static pressures are those of the "
                "full model, and what responds at the interface has its inertia.",
                colour="#661100",
                marker="*",
                joint_modes=_ATTACHED,
                on_request=True,
            ),
            Method(
                name="trial-vector-derivatives",
                meaning="as craig-bampton, and derivatives of its shapes with respect to one "
                f"another; {_ONLY_THROUGH}.",
                colour="#882255",
                marker="<",
                joint_modes=_DERIVATIVES,
                source="Pichler, Witteveen & Fischer 2017, doi:10.1007/s11044-016-9555-2",
            ),
            Method(
                name="cone-greedy",
                meaning="contact forces as sums, without negative parts, of chosen training "
                "forces.",
                colour="#999933",
                marker=">",
                forces=_cone_greedy,
                source="Benaceur, Ern & Ehrlacher 2020, doi:10.1002/nme.6261",
            ),
            Method(
                name="nmf",
                meaning="contact forces as sums of non-negative factors of the training forces.",
                colour="#332288",
                marker="X",
                forces=_nonnegative_factors,
                source="Balajewicz, Amsallem & Farhat 2016, arXiv:1503.01000",
            ),
            Method(
                name="deim",
                meaning="contact forces interpolated from a few points of the interface.",
                colour="#44AA99",
                marker="p",
                forces=_deim,
                source="Chaturantabut & Sorensen 2010, doi:10.1137/090766498",
            ),
        )
    }
)
"""Name to method, in the order in which they are shown."""
