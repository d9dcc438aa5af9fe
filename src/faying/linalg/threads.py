"""Threads of the linear algebra libraries, where more of them would only wait for each other."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController

SMALL = 1500
"""Order of dense matrices up to which one thread is fastest.

Sharing a Cholesky factorization of a few hundred rows costs more than it saves; on a machine that
does other work as well, threads that wait for each other made a run ten times slower.
"""


@contextmanager
def threads_for(order: int) -> Iterator[None]:
    """Keep dense linear algebra on one thread where its matrices are small."""
    if order > SMALL:
        yield
        return
    with _controller().limit(limits=1, user_api="blas"):
        yield


@cache
def _controller() -> ThreadpoolController:
    return ThreadpoolController()
