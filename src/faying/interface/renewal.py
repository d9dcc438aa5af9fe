"""Interfaces built anew on the facets that were found to touch: another rule, another law."""

from faying.interface.interface import Interface
from faying.interface.mortar import build_mortar_interface
from faying.interface.penalty import automatic_penalty, coupling_penalty
from faying.interface.zero_thickness import build_interface
from faying.model.assembly import Assembly
from faying.model.dofs import DofMap
from faying.model.specs import InterfaceSpec


def rebuilt(
    assembly: Assembly, dofs: DofMap, spec: InterfaceSpec, interface: Interface, penalty: float
) -> Interface:
    """Return an interface with the quadrature of a spec where another one touches.

    Parameters
    ----------
    spec
        Name, quadrature and order count; where the sides are is known already.
    penalty : [force/length³]

    Raises
    ------
    ModelError
        If the order does not fit the quadrature.
    """
    if interface.coupling is not None:
        return build_mortar_interface(assembly, dofs, spec, interface.coupling, penalty)
    return build_interface(assembly, dofs, spec, interface.faces, penalty)


def automatic_penalty_of(assembly: Assembly, interface: Interface) -> float:
    """Return 10 E/h [force/length³] of the elements on both sides of an interface.

    Raises
    ------
    ModelError
        As :func:`faying.interface.penalty.automatic_penalty`.
    """
    if interface.coupling is not None:
        return coupling_penalty(assembly, interface.coupling)
    return automatic_penalty(assembly, interface.faces)
