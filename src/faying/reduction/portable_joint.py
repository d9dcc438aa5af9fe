"""The full model without finite elements: what static contact and recovery need to know of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import final

import numpy as np

from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.joint.load_pattern import LoadPattern
from faying.joint.system import Joint, PortCompliance, boundary_slices, static_contact_of
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class PortableJoint:
    """The full model as seen through its ports.

    Attributes
    ----------
    contact
        Without degrees of freedom behind the pairs, ``relative_operator`` has no columns.
    boundaries, bolts, load_patterns
        By name; boundary degrees of freedom are numbered through, bolts have no elongation row and
        load patterns no forces.
    port_compliance
        Q K⁻¹ Qᵀ of the full model.
    """

    contact: Contact
    boundaries: Mapping[str, Boundary]
    bolts: Mapping[str, Bolt]
    port_compliance: PortCompliance
    load_patterns: Mapping[str, LoadPattern] = field(default_factory=dict)

    @cached_property
    def static_contact(self) -> CondensedContact:
        """The static contact problem of the full model."""
        return static_contact_of(self)


def at_its_ports(joint: Joint, ports: PortCompliance) -> PortableJoint:
    """Return a joint as seen through its ports alone, from any system with the same ports."""
    places = boundary_slices(joint.boundaries)
    without = np.zeros((joint.contact.relative_operator.shape[0], 0))
    return PortableJoint(
        contact=replace(joint.contact, relative_operator=without, residual_compliance=None),
        boundaries={
            name: port.with_dofs(np.arange(places[name].start, places[name].stop))
            for name, port in joint.boundaries.items()
        },
        bolts={name: port.at_ports() for name, port in joint.bolts.items()},
        port_compliance=ports,
        load_patterns={
            name: replace(port, forces=np.zeros(0)) for name, port in joint.load_patterns.items()
        },
    )
