"""One static load case of a full or reduced model, with or without friction."""

from faying.joint.system import System
from faying.simulation.load import Load
from faying.simulation.path import last_of, solve_path
from faying.simulation.solution import Solution
from faying.simulation.static import AT_REST


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
    return last_of(solve_path(system, [load], initial, name=load.name))
