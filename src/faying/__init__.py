"""faying: contact pressure in bolted joints at the cost of a reduced model.

The names below are in the order of the work: model, preload, basis, reduced model, solution,
comparison.

>>> import faying as fy
>>> model = fy.lap_joint(element_size=5.0)
>>> preloaded = fy.preload(model, {"bolt": 10e3})
>>> basis = fy.craig_bampton(preloaded, normal_modes=10)
>>> rom = fy.reduce(preloaded, basis, compliance=True)
>>> load = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
>>> fast, full = fy.solve_static(rom, load), fy.solve_static(preloaded, load)
>>> fy.compare(fast, full).max_relative_error < 1e-8
True
"""

import ast
import warnings
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any

__version__ = version("faying")

# Names are imported when first used, so that `faying --help` need not wait for SciPy. They stand
# in the stub only, where type checkers find them.
_STUB = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
_HOMES = {
    found.name: str(node.module)
    for node in _STUB.body
    if isinstance(node, ast.ImportFrom)
    for found in node.names
}
__all__ = sorted(_HOMES)


_RENAMED = {"load": "read_reduced_model"}
"""Former names, which warn."""


def __getattr__(name: str) -> Any:
    if name in _RENAMED:
        message = f"faying.{name} is called faying.{_RENAMED[name]} now; use that"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        name = _RENAMED[name]
    if name not in _HOMES:
        message = f"module 'faying' has no attribute '{name}'"
        raise AttributeError(message)
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted([*__all__, "__version__"])
