"""Which small faults in contact, time integration and reduction the fast tests would not notice.

    python benchmarks/mutants.py [--sample N] [--seed S] [--only PART] [--list] [--limit SECONDS]

A mutant is one file of ``src/faying`` with one operator, comparison, sign or number changed, found
in its syntax tree and named ``file:line: what -> what``. For each one the tests that stand beside
its file in ``TARGETS`` run in a process of its own, where the changed file takes the place of the
true one in memory; nothing is written. A mutant is killed by a test that fails or that does not end
within the limit; those that no test notices survive and are printed, with a count at the end.
"""

import argparse
import ast
import copy
import importlib.abc
import importlib.machinery
import importlib.util
import os
import random
import signal
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

os.environ.update(OMP_NUM_THREADS="1", MKL_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")

# Imported before the processes part, so that each need not do so; faying itself must not be.
import h5py  # noqa: F401
import numpy as np  # noqa: F401
import pytest
import scipy.sparse.linalg  # noqa: F401

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src"

_LAWS = ("tests/unit/contact/test_contact_laws.py", "tests/verification/test_laws.py")
_CONTACT = ("tests/verification/test_contact_problem.py", *_LAWS)
_MOTION = ("tests/verification/test_transient.py", "tests/verification/test_energy_decaying.py")
_STEPS = ("tests/unit/simulation/test_integrator_steps.py",)
_INCREMENTS = ("tests/unit/contact/test_increments.py",)
_PATHS = ("tests/unit/simulation/test_paths.py",)
_REDUCTION = ("tests/unit/reduction/test_basis.py",)
TARGETS: dict[str, tuple[str, ...]] = {
    "contact/active_set.py": _CONTACT,
    "contact/laws/penalty.py": _LAWS,
    "contact/laws/hard.py": _LAWS,
    "contact/laws/unilateral.py": _LAWS,
    "contact/laws/coulomb.py": _LAWS,
    "contact/dense_points.py": ("tests/unit/contact/test_dense_points.py",),
    "contact/augmented.py": _INCREMENTS,
    "contact/yielding.py": _INCREMENTS,
    "contact/glued_pairs.py": ("tests/unit/contact/test_glued_pairs.py",),
    "contact/laws_at_points.py": ("tests/unit/contact/test_laws_at_points.py",),
    "simulation/integrators/implicit_euler.py": _STEPS,
    "simulation/integrators/generalized_alpha.py": _STEPS,
    "simulation/integrators/energy_decaying.py": _STEPS,
    "simulation/integrators/spectral_radius.py": _STEPS,
    "simulation/step_contact.py": ("tests/unit/simulation/test_step_contact.py",),
    "simulation/path.py": _PATHS,
    "simulation/bolts_by_force.py": (*_PATHS, "tests/verification/test_bolts.py"),
    "simulation/cycles.py": _PATHS,
    "simulation/tightening.py": _PATHS,
    "simulation/energies.py": ("tests/unit/simulation/test_energies.py", *_MOTION),
    "reduction/craig_bampton.py": _REDUCTION,
    "reduction/normal_modes.py": _REDUCTION,
    "reduction/pod.py": ("tests/properties/test_pod.py",),
    "reduction/basis.py": _REDUCTION,
    "reduction/compliance.py": _REDUCTION,
    "reduction/contact_reduction.py": ("tests/unit/reduction/test_methods.py",),
}
"""Files under test, below ``src/faying``, and the tests that must notice what is wrong in them."""

SWAPS: dict[type[ast.AST], tuple[type[ast.AST], ...]] = {
    ast.Add: (ast.Sub,),
    ast.Sub: (ast.Add,),
    ast.Mult: (ast.Div,),
    ast.Div: (ast.Mult,),
    ast.Pow: (ast.Mult,),
    ast.BitAnd: (ast.BitOr,),
    ast.BitOr: (ast.BitAnd,),
    ast.BitXor: (ast.BitOr,),
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.And: (ast.Or,),
    ast.Or: (ast.And,),
}
NAMES = {"minimum": "maximum", "maximum": "minimum", "min": "max", "max": "min", "any": "all"}


@dataclass(frozen=True)
class Mutant:
    """One change: the file, the number of the place in its tree, which of the changes there."""

    file: str
    place: int
    choice: int
    name: str


def changes(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """Yield what may stand in the place of a node, with the words for it."""
    if isinstance(node, ast.BinOp | ast.BoolOp | ast.AugAssign):
        for other in SWAPS.get(type(node.op), ()):
            changed = copy.deepcopy(node)
            changed.op = other()  # type: ignore[assignment]
            yield f"{type(node.op).__name__} -> {other.__name__}", changed
    elif isinstance(node, ast.Compare):
        for other in SWAPS.get(type(node.ops[0]), ()):
            changed = copy.deepcopy(node)
            changed.ops[0] = other()  # type: ignore[call-overload]
            yield f"{type(node.ops[0]).__name__} -> {other.__name__}", changed
    elif isinstance(node, ast.UnaryOp) and not isinstance(node.op, ast.UAdd):
        yield f"{type(node.op).__name__} left out", node.operand
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
        wrong = 2 * node.value if isinstance(node.value, float) and node.value else node.value + 1
        yield f"{node.value!r} -> {wrong!r}", ast.Constant(wrong)
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield f"{node.value} -> {not node.value}", ast.Constant(not node.value)
    elif isinstance(node, ast.Attribute) and node.attr in NAMES:
        changed = copy.deepcopy(node)
        changed.attr = NAMES[node.attr]
        yield f"{node.attr} -> {changed.attr}", changed


class Walk(ast.NodeTransformer):
    """Visit a syntax tree without its messages and arguments of functions."""

    def __init__(self, wished: tuple[int, int] | None = None) -> None:
        self.count = 0
        self.wished = wished
        self.found: list[tuple[int, int, int, str]] = []

    def visit(self, node: ast.AST) -> ast.AST:
        """Return a node, changed if it is the one that was wished for."""
        if isinstance(node, ast.JoinedStr | ast.Raise | ast.arguments):
            return node
        place, self.count = self.count, self.count + 1
        for choice, (words, changed) in enumerate(changes(node)):
            if self.wished is None:
                self.found.append((place, choice, node.lineno, words))  # type: ignore[attr-defined]
            elif self.wished == (place, choice):
                return ast.copy_location(changed, node)
        return self.generic_visit(node)


def mutants(file: str) -> list[Mutant]:
    """Return all mutants of a file."""
    walk = Walk()
    walk.visit(ast.parse((SOURCE / "faying" / file).read_text(encoding="utf-8")))
    return [
        Mutant(file, place, choice, f"{file}:{line}: {words}")
        for place, choice, line, words in walk.found
    ]


class Changed(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Loads one module from a changed syntax tree."""

    def __init__(self, mutant: Mutant) -> None:
        self.path = SOURCE / "faying" / mutant.file
        self.module = ".".join(("faying", *Path(mutant.file).with_suffix("").parts))
        tree = ast.parse(self.path.read_text(encoding="utf-8"))
        tree = Walk((mutant.place, mutant.choice)).visit(tree)
        self.code = compile(ast.fix_missing_locations(tree), str(self.path), "exec")

    def find_spec(
        self,
        fullname: str,
        path: object,  # noqa: ARG002
        target: object = None,  # noqa: ARG002
    ) -> importlib.machinery.ModuleSpec | None:
        """Say that the changed module is loaded from here."""
        if fullname != self.module:
            return None
        return importlib.util.spec_from_file_location(fullname, self.path, loader=self)

    def exec_module(self, module: ModuleType) -> None:
        """Run the changed code as the module."""
        exec(self.code, module.__dict__)


def survives(mutant: Mutant | None, tests: tuple[str, ...], limit: int) -> bool:
    """Run tests with a mutant in a process of its own; None is the true source."""
    child = os.fork()
    if child:
        return os.waitpid(child, 0)[1] == 0
    with open(os.devnull, "w") as nothing:  # noqa: PTH123
        for stream in (1, 2):
            os.dup2(nothing.fileno(), stream)
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(limit)
        status = 1
        try:
            if mutant is not None:
                sys.meta_path.insert(0, Changed(mutant))
            status = int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", *tests]))
        finally:
            os._exit(status)


def main() -> None:
    """Print the survivors and how many there are."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sample", type=int, help="so many mutants, spread over all files")
    parser.add_argument("--seed", type=int, default=0, help="of the sample")
    parser.add_argument("--only", default="", help="files whose path contains this")
    parser.add_argument("--limit", type=int, default=60, help="seconds for the tests of a mutant")
    parser.add_argument("--list", action="store_true", help="name the mutants, run none")
    wished = parser.parse_args()
    os.chdir(ROOT)
    sys.path.insert(0, str(SOURCE))
    chosen = [one for file in TARGETS if wished.only in file for one in mutants(file)]
    total = len(chosen)
    if wished.sample is not None and wished.sample < total:
        picked = random.Random(wished.seed).sample(range(total), wished.sample)
        chosen = [chosen[i] for i in sorted(picked)]
    write = sys.stdout.write
    if wished.list:
        write("".join(f"{one.name}\n" for one in chosen))
        return
    for tests in dict.fromkeys(TARGETS[one.file] for one in chosen):
        if not survives(None, tests, 10 * wished.limit):
            sys.exit(f"{', '.join(tests)}: these fail on the true source")
    survivors = 0
    start = time.monotonic()
    for one in chosen:
        if survives(one, TARGETS[one.file], wished.limit):
            survivors += 1
            write(f"survives  {one.name}\n")
            sys.stdout.flush()
    write(
        f"{len(chosen)} of {total} mutants run in {time.monotonic() - start:.0f} s, "
        f"{len(chosen) - survivors} killed, {survivors} survive\n"
    )


if __name__ == "__main__":
    main()
