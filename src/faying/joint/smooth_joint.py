"""A joint without friction, from which tightening without friction starts."""

from faying.joint.system import Joint, PortableJoint


def smooth_joint(joint: Joint) -> Joint:
    """Return a joint with its normal laws alone; without friction the joint itself.

    Nothing is factorized again.
    """
    contact = joint.contact.smooth
    if contact is joint.contact:
        return joint
    return PortableJoint(
        contact=contact,
        boundaries=joint.boundaries,
        bolts=joint.bolts,
        load_patterns=joint.load_patterns,
        port_compliance=joint.port_compliance,
    )
