"""The compiled solver of increments with friction, and where it hands over to the one in Python."""

import logging
import time
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from typing import Any, final

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.frictional import FrictionalContact, Increment
from faying.contact.laws import Coulomb, Hard, Penalty
from faying.contact.newton_steps import PROXIMAL

_log = logging.getLogger("faying")

INCREMENTS = "faying.contact.compiled_increments"


@final
@dataclass(frozen=True, eq=False)
class CompiledFrictionalContact:
    """Solver of increments with Coulomb's law, compiled; the same up to the residual left.

    Attributes
    ----------
    plain
        The solver in Python, which does what the compiled one leaves.
    about : (3, n_point) or None [force]
        Forces of a state that increments are near; with them, systems are made of the points that
        are other than there.
    """

    plain: FrictionalContact
    about: Matrix | None = None

    @property
    def contact(self) -> Contact:
        """Gaps, tangential displacements and laws."""
        return self.plain.contact

    @property
    def S(self) -> Matrix:
        """Compliance between pairs (n_relative, n_relative) [length/force]."""
        return self.plain.S

    def solve(
        self, z_free: Matrix, start: Matrix | None = None, similar: Increment | None = None
    ) -> Increment:
        """Solve one increment; see :meth:`.FrictionalContact.solve`."""
        if start is None:
            return self.plain.solve(z_free)
        forces = np.ascontiguousarray(self.plain.laws.admissible(start, None))
        slack, expected = np.empty(z_free.shape), np.empty((0, z_free.shape[1]))
        if similar is not None:
            expected = np.ascontiguousarray(self.plain.trial(similar))
        steps, left = self._loop.solve(
            **self._arrays,
            **self._state,
            z_free=np.ascontiguousarray(z_free),
            expected=expected,
            x=forces,
            z=slack,
        )
        if left <= self._loop.ENOUGH:
            return Increment(forces=forces, slack=slack, iterations=int(steps), residual=left)
        return self.plain.solve(z_free, start) if similar is None else self.solve(z_free, start)

    def gap(self, increment: Increment) -> Vector:
        """Return the gap (n_point,) [length] after an increment."""
        return self.plain.gap(increment)

    @cached_property
    def _loop(self) -> Any:
        begin = time.perf_counter()
        _log.info("compiling increments with friction, once per installation")
        loop = import_module(INCREMENTS)
        _log.info("compiled, or read from the cache, in %.1f s", time.perf_counter() - begin)
        return loop

    @cached_property
    def _arrays(self) -> dict[str, Any]:
        plain, rows = self.plain, self.plain.steps.rows
        arrays = {
            "columns": rows.columns,
            "values": rows.values,
            "S": plain.S,
            "yielding": np.maximum(plain.D, PROXIMAL * plain.steps.own),
            "closure": plain.D,
            "scale": plain.scale,
            "friction": plain.friction,
        }
        routines = {name: np.uint64(_address(f"d{name}")) for name in ("getrf", "getrs")}
        return {
            **routines,
            "transposed": np.array([ord("T")], dtype=np.uint8),
            **{name: np.array(values, order="C") for name, values in arrays.items()},
        }

    @cached_property
    def _state(self) -> dict[str, Matrix]:
        """U, J, K and A⁻¹ of the state about which increments are solved, if there is one."""
        names, arrays = ("slope0", "stiff0", "inverse0"), self._arrays
        if self.about is not None:
            given = {name: arrays[name] for name in ("friction", "scale", "yielding")}
            found = self._loop.linearized(np.array(self.about, order="C"), **given)
            with suppress(LinAlgError):
                supported = self.plain.steps.supported(found[1].reshape(-1, 3, 3))
                return {"supported": supported, **dict(zip(names, found, strict=True))}
        found = self._loop.unsupported(self.contact.n_points)
        return {"supported": arrays["S"], **dict(zip(names, found, strict=True))}


def compilable(solver: FrictionalContact) -> bool:
    """Say whether there is compiled code for the laws of all interfaces."""
    laws = solver.contact.laws.values()
    return all(law.proportional and isinstance(law, Coulomb | Hard | Penalty) for law in laws)


def _address(name: str) -> int:
    """Return where a routine of SciPy's LAPACK is."""
    from numba.extending import get_cython_function_address

    return int(get_cython_function_address("scipy.linalg.cython_lapack", name))
