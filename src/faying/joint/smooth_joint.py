"""A joint without friction, from which tightening without friction starts."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.joint.load_pattern import LoadPattern
from faying.joint.system import Joint, PortCompliance, static_contact_of
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary


@dataclass(frozen=True, eq=False, kw_only=True)
class SmoothJoint:
    """A full or reduced model with frictionless contact, reduced to its ports.

    Attributes
    ----------
    contact
        Contact by the normal laws of the system alone.
    boundaries, bolts, load_patterns, port_compliance
        As in the system.
    """

    contact: Contact
    boundaries: Mapping[str, Boundary]
    bolts: Mapping[str, Bolt]
    load_patterns: Mapping[str, LoadPattern]
    port_compliance: PortCompliance

    @cached_property
    def static_contact(self) -> CondensedContact:
        """The static contact problem without friction."""
        return static_contact_of(self)


def smooth_joint(joint: Joint) -> Joint:
    """Return a joint with its normal laws alone; without friction the joint itself.

    Nothing is factorized again.
    """
    contact = joint.contact.smooth
    if contact is joint.contact:
        return joint
    return SmoothJoint(
        contact=contact,
        boundaries=joint.boundaries,
        bolts=joint.bolts,
        load_patterns=joint.load_patterns,
        port_compliance=joint.port_compliance,
    )
