"""The C solver of increments with friction that FMUs carry, where paths take a solver."""

import ctypes

import numpy as np
import scipy.sparse as sp

from faying.contact.increment import Increment
from faying.digits import SOLVED
from faying.exceptions import ConvergenceError


def pointers(*arrays):
    return [array.ctypes.data_as(ctypes.c_void_p) for array in arrays]


class IncrementsInC:
    """Solves increments of a :class:`.NaturalMap` with the sources of FMUs."""

    def __init__(self, library, plain):
        self.contact, self.S = plain.contact, plain.S
        self.library = ctypes.CDLL(str(library))
        self.library.make_solver.restype = ctypes.c_void_p
        self.library.solve_increment.restype = ctypes.c_double
        n, r = self.contact.n_points, len(self.S)
        G = sp.csr_array(plain.G)
        given = [np.ascontiguousarray(self.S)]
        for rows in (G[:n], G[n:]):
            index = [array.astype(np.uint64) for array in (rows.indptr, rows.indices)]
            given += [rows.data.copy(), *index]
        given += [plain.yields.ravel().copy(), self.contact.coefficients.copy()]
        self._kept = given  # the solver points into them
        sizes = ctypes.c_size_t(n), ctypes.c_size_t(r)
        self.solver = ctypes.c_void_p(self.library.make_solver(*sizes, *pointers(*given)))

    def solve(self, free, offset, start=None):
        z_free = self.contact.moved(free) + offset
        x = np.zeros_like(z_free) if start is None else np.array(start.forces, order="C")
        z_free, slack = np.ascontiguousarray(z_free), np.empty_like(x)
        left = self.library.solve_increment(self.solver, *pointers(z_free, x, slack))
        if not left <= SOLVED:
            message = f"an increment with friction was not solved (residual {left:.1e})"
            raise ConvergenceError(message)
        moved = free + self.S @ self.contact.at_pairs(x[0], x[1:])
        return Increment(forces=x, slack=slack, moved=moved, iterations=1, residual=left)

    def close(self):
        self.library.free_solver(self.solver)
