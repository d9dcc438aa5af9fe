"""Threads of the linear algebra libraries, where more of them would only wait for each other."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache

import scipy.linalg  # noqa: F401  its BLAS is another than NumPy's
from threadpoolctl import ThreadpoolController

from faying.linalg.mkl import load_mkl

SMALL_ORDER = 1500
"""Order of dense matrices up to which one thread is fastest.

Sharing a Cholesky factorization of a few hundred rows costs more than it saves; on a machine that
does other work as well, threads that wait for each other made a run ten times slower.
"""

_FOUND: ContextVar[dict[str, int] | None] = ContextVar("threads before", default=None)
"""Threads of each library outside :func:`one_thread`."""


def limit_threads(threads: int) -> None:
    """Limit the threads of each library in this process from now on."""
    _controller().limit(limits=threads)


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep dense linear algebra on one thread, except where :func:`threads_for` says otherwise.

    Whatever the machine does meanwhile, so that digits do not depend on it.
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
    """Keep dense linear algebra on one thread where its matrices are small."""
    limits = 1 if order <= SMALL_ORDER else _FOUND.get()
    if limits is None:
        yield
        return
    with _controller().limit(limits=limits, user_api="blas"):
        yield


@cache
def _controller() -> ThreadpoolController:
    """Find all libraries once, those first that are loaded when something is factorized.

    One that came later would keep all its threads, so that digits depended on what ran before.
    """
    load_mkl()
    return ThreadpoolController()
