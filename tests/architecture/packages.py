"""The packages of faying in the order of the work, and who imports whom.

``python tests/architecture/packages.py`` prints a line for each package.
"""

import ast
import gc
from collections import Counter
from functools import cache
from pathlib import Path

import faying

ROOT = Path(faying.__file__).parent

ORDER = (
    "_typing",
    "exceptions",
    "units",
    "digits",
    "iterations",
    "display",
    "linalg",
    "files",
    "contact",
    "model",
    "interface",
    "joint",
    "io",
    "readers",
    "sources",
    "simulation",
    "reduction",
    "assessment",
    "execution",
    "study",
    "draft",
    "export",
    "__init__",
    "report",
    "workflow",
    "cli",
)
"""Folders and single modules; each imports from those before it only."""

ROOMS = ("keys", "inputs", "results", "judgement", "stages")
"""Folders of ``study``, each of which imports from those before it only."""

MODULES = sorted(
    str(path.relative_to(ROOT)) for path in ROOT.rglob("*.py") if path.name != "__main__.py"
)


def dotted(path):
    """Name of the module in a file."""
    parts = ("faying", *Path(path).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


NAMES = {dotted(path) for path in MODULES}


@cache
def parsed(path):
    """Syntax tree of a file of faying.

    Looking for garbage among its nodes meanwhile takes twice as long as parsing.
    """
    gc.disable()
    try:
        return ast.parse((ROOT / path).read_text(encoding="utf-8"))
    finally:
        gc.enable()


def statements(block):
    """Yield the statements of a tree, inside functions too, without their expressions."""
    for part in ("body", "orelse", "finalbody", "handlers", "cases"):
        for statement in getattr(block, part, ()):
            yield statement
            yield from statements(statement)


@cache
def imports(path):
    """Modules of faying that a file imports, inside functions too."""
    found = []
    # The names that faying itself imports on first use stand in its stub.
    for node in statements(parsed("__init__.pyi" if path == "__init__.py" else path)):
        if isinstance(node, ast.Import):
            found += [name.name for name in node.names if name.name.startswith("faying")]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("faying"):
            inner = [f"{node.module}.{name.name}" for name in node.names]
            found += [name if name in NAMES else node.module for name in inner]
    return found


def package(path):
    """The folder, or single module, that a file belongs to."""
    return Path(path).parts[0].removesuffix(".py")


def imported_packages():
    """Every package, in order, with the packages it imports and how often."""
    counts = {name: Counter() for name in ORDER}
    for path in MODULES:
        used = (name.split(".")[1] for name in imports(path) if "." in name)
        counts[package(path)].update(name for name in used if name != package(path))
    return counts


if __name__ == "__main__":
    for name, used in imported_packages().items():
        inner = ", ".join(f"{other} {used[other]}" for other in ORDER if used[other])
        print(f"{name:12} <- {inner or 'nothing'}")  # noqa: T201  the script's purpose
