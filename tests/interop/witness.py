"""pyYeti, the independent reader and writer of Nastran's files."""

import os
import warnings
from typing import Any

import numpy as np
import pytest


def pyyeti_nastran() -> Any:
    """Return ``pyyeti.nastran`` without what it does to other tests; skip where it is missing."""
    if os.environ.get("FAYING_REQUIRE_PROGRAMS") != "1":
        pytest.importorskip("pyyeti", reason="pyYeti is not installed: pip install pyyeti")
    # At import it changes how NumPy prints (legacy="1.13") and warns of its own deprecations.
    with warnings.catch_warnings(), np.printoptions():
        warnings.simplefilter("ignore")
        import pyyeti.nastran.bulk
        import pyyeti.nastran.op4
    return pyyeti.nastran
