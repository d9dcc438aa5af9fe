"""Thread numbers of the linear algebra libraries, limited where more threads would only wait."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache

import scipy.linalg  # noqa: F401  its BLAS is another than NumPy's
from threadpoolctl import ThreadpoolController

from faying.linalg.mkl import load_mkl

SMALL_ORDER = 1500
"""Order of dense matrices up to which one thread is fastest.

Several threads make a Cholesky factorization of a few hundred rows slower; on a busy machine,
threads that waited for each other made a run ten times slower.
"""

_FOUND: ContextVar[dict[str, int] | None] = ContextVar("threads before", default=None)
"""Threads of each library outside :func:`one_thread`."""


def limit_threads(threads: int) -> None:
    """Limit the threads of each library in this process from now on."""
    _controller().limit(limits=threads)


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep dense linear algebra on one thread, except inside :func:`threads_for`.

    The number does not depend on the load of the machine, and so neither do digits.
    """
    libraries = _controller().info()
    token = _FOUND.set({library["prefix"]: library["num_threads"] for library in libraries})
    try:
        with _controller().limit(limits=1, user_api="blas"):
            yield
    finally:
        _FOUND.reset(token)


@contextmanager
def threads_for(order: int) -> Iterator[None]:
    """Keep dense linear algebra of small matrices (by order) on one thread."""
    limits = 1 if order <= SMALL_ORDER else _FOUND.get()
    if limits is None:
        yield
        return
    with _controller().limit(limits=limits, user_api="blas"):
        yield


@cache
def _controller() -> ThreadpoolController:
    """Return the controller of all libraries, after loading those used in factorizations.

    A library loaded later would keep all its threads, and digits would depend on the order.
    """
    load_mkl()
    return ThreadpoolController()
