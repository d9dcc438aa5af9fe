"""Libraries that factorize sparse matrices: which are here, and which is to be used."""

import os

from faying.exceptions import ModelError
from faying.linalg.mkl import load_mkl

VARIABLE = "FAYING_FACTORIZATION"
"""Environment variable that names the backend of sparse factorizations."""

BACKENDS = ("pardiso", "superlu")


def available_backends() -> tuple[str, ...]:
    """Return the backends for sparse matrices that work here, the fastest first."""
    return BACKENDS if load_mkl() is not None else ("superlu",)


def chosen_backend(backend: str | None = None) -> str:
    """Return the backend asked for, else what the environment names, else the fastest."""
    available = available_backends()
    name = backend or os.environ.get(VARIABLE) or available[0]
    if name not in available:
        remedy = "pip install mkl" if name == "pardiso" else f"choose among {', '.join(BACKENDS)}"
        source = "backend" if backend else VARIABLE
        message = f"{source} = {name!r}: no such factorization here; {remedy}"
        raise ModelError(message)
    return name
