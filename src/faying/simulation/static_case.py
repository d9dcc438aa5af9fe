"""One static load case of a full or reduced model, with or without friction."""

import numpy as np

from faying.joint.system import System
from faying.simulation.load import Load
from faying.simulation.path import last_of, solve_path
from faying.simulation.solution import Solution
from faying.simulation.static import AT_REST, solve_static_cases


def solve_static(system: System, load: Load = AT_REST, initial: Solution | None = None) -> Solution:
    """Solve the static contact problem of one load case.

    Parameters
    ----------
    system
        Full or reduced model; histories are taken at time zero.
    initial
        With friction or gaskets, the state to go on from in one increment; by default the joint is
        unstressed and nothing has slipped. Else where it comes from does not matter.

    Raises
    ------
    ModelError
        If the load does not fit the system, or the structure is not held.

    Notes
    -----
    One dense contact problem and one back-substitution; the compliance of the system is
    formed at the first call and kept.
    """
    if not system.contact.forgets:
        return last_of(solve_path(system, [load], initial, name=load.name))
    cases = solve_static_cases(system, [load])
    return Solution(
        name=load.name,
        system=system,
        states=cases.states[0],
        contact_forces=cases.contact_forces[0],
        gap=cases.gap[0],
        inputs=cases.inputs[0],
        iterations=cases.iterations[0],
        contact_error=np.asarray(cases.contact_error)[0],
    )
