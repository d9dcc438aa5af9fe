"""A joint as it would be without friction: what frictionless tightening starts friction from."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import final

import numpy as np

from faying._typing import Matrix
from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.joint.load_pattern import LoadPattern
from faying.joint.system import Joint, PortCompliance, System, static_contact_of
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary
from faying.simulation.load import Load
from faying.simulation.path import solve_path
from faying.simulation.solution import Solution
from faying.simulation.static import AT_REST, port_forces, solved_cases, solved_inputs


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class SmoothJoint:
    """A full or reduced model whose surfaces slide freely, seen through its ports.

    Attributes
    ----------
    contact
        With the normal laws of the system alone.
    boundaries, bolts, load_patterns, port_compliance
        Of the system.
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
    """Return a joint without the friction of its interfaces; nothing is factorized again."""
    if joint.contact.components == 1:
        return joint
    laws = {name: law.normal for name, law in joint.contact.laws.items()}
    return SmoothJoint(
        contact=replace(joint.contact, laws=laws),
        boundaries=joint.boundaries,
        bolts=joint.bolts,
        load_patterns=joint.load_patterns,
        port_compliance=joint.port_compliance,
    )


def pressures_without_friction(joint: Joint, inputs: Matrix) -> Matrix:
    """Return contact pressures of static loads (n_case, n_input) as if nothing rubbed."""
    ports = joint.port_compliance
    free = port_forces(ports, inputs) @ ports.contact_columns
    pressures: Matrix = solved_cases(smooth_joint(joint), free).forces / joint.contact.weights
    return pressures


def solved_without_friction(system: System, inputs: Matrix, name: str) -> Solution:
    """Solve static loads (n_case, n_input) of a joint as if nothing rubbed."""
    return solved_inputs(system, smooth_joint(system), inputs, name)


def released_state(system: System, load: Load = AT_REST) -> Solution:
    """Solve a load without friction, as a state of a joint with friction that carries no traction.

    What moved tangentially counts as slip: friction begins here. A path that goes on from it
    (``initial`` of :func:`faying.solve_path`) is that of a joint tightened without friction. Its
    one entry is of the system itself.

    Raises
    ------
    ModelError, ConvergenceError
        As :func:`faying.solve_static`.
    """
    if system.contact.components == 1:
        return solve_path(system, [load], name=load.name)
    contact, ports = system.contact, system.port_compliance
    smooth = smooth_joint(system)
    inputs = load.inputs(system, np.zeros(1))
    solved = solved_inputs(system, smooth, inputs, load.name)
    free = port_forces(ports, inputs[0]) @ ports.contact_columns
    pressed = contact.interpolation.T @ solved.contact_forces[0]
    total = smooth.static_contact.total
    slip = contact.moved(free + total @ pressed)[1 : contact.components]
    return replace(
        solved,
        contact_error=0.0,
        shear_forces=np.zeros((1, *slip.shape)),
        shear_slip=slip[None],
        dissipation=np.zeros(1),
    )
