"""Which solver follows a path: in Python, or compiled where increments are many."""

from importlib.util import find_spec

from faying._typing import Matrix
from faying.contact.compiled_frictional import CompiledFrictionalContact, compilable
from faying.contact.increment_solver import IncrementSolver
from faying.joint.system import System
from faying.simulation.compiled import check_compiler

PAYING_INCREMENTS = 1000
"""Increments from which they are compiled unasked.

To load what was compiled takes a second per process, to compile it up to a minute once per
installation; an increment of the default cantilever is 3 to 6 ms faster.
"""


def path_solver(
    system: System, count: int, about: Matrix, compiled: bool | None = None
) -> IncrementSolver:
    """Return what solves the increments of a path.

    Parameters
    ----------
    count
        Increments, at least.
    about : (3, n_point) [force]
        Forces where the path begins, which its increments are about; zero of an unstressed joint.
    compiled
        Whether they are compiled; unless given, where that pays.

    Raises
    ------
    ModelError
        If compiled increments are asked for without numba.
    """
    plain = system.static_contact.frictional
    if compiled:
        check_compiler()
    pays = count >= PAYING_INCREMENTS and find_spec("numba") is not None
    if not (pays if compiled is None else compiled) or not compilable(plain):
        return plain
    return CompiledFrictionalContact(plain, about if about.any() else None)
