"""Which solver follows a path: in Python, or compiled where increments are many."""

from importlib.util import find_spec

from faying._typing import Matrix
from faying.contact.compiled_frictional import CompiledFrictionalContact, compilable
from faying.contact.increment_solver import IncrementSolver
from faying.joint.system import System
from faying.simulation.compiled import check_compiler

PAYING, FEWEST = 2e8, 20
"""Increments times relative displacements squared from which they are compiled unasked, and the
fewest: 1000 with the 444 of the default cantilever, 119 with 1296, 33 with 2472.

To load what was compiled takes a second per process, to compile it up to a minute once per
installation, and where a path begins takes as long as five increments. An increment is 3 to 6 ms
faster with 444 relative displacements, 10 to 60 ms with 1296, and 0.13 to 0.6 s with 2472.
"""

SHARED = 10
"""Increments from which they are solved about the state where their path begins: to prepare that
takes as long as five of them, and saves half of each where most of the joint sticks."""


def paying_increments(n_relative: int) -> int:
    """Return from how many increments on they are compiled unasked."""
    return max(FEWEST, round(PAYING / max(n_relative, 1) ** 2))


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
    pays = count >= paying_increments(len(plain.S)) and find_spec("numba") is not None
    if not (pays if compiled is None else compiled) or not compilable(plain):
        return plain
    shared = count >= SHARED and about.any()
    return CompiledFrictionalContact(plain, about if shared else None)
