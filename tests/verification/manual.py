"""The verification manual: problems with known answers, solved anew, as the table of a page.

``python tests/verification/manual.py`` prints the table of docs/verification.md;
``test_manual.py`` compares it with the page in every run of the tests.
"""

import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import test_bolts
import test_hertz
import test_receding_layer
import test_reference_cantilever
import test_transient

import faying as fy

DATA = Path(__file__).parents[1] / "data"
COLUMNS = ("problem", "source", "quantity", "exact", "faying", "error", "order", "test")


@dataclass(frozen=True)
class Row:
    """One quantity of one problem; ``error`` and ``order`` as text, for not all are relative."""

    problem: str
    source: str
    quantity: str
    exact: str
    ours: str
    error: str
    order: str
    test: str

    def cells(self) -> tuple[str, ...]:
        return tuple(vars(self).values())


def relative(ours: float, exact: float) -> str:
    return rounded(abs(ours / exact - 1))


def rounded(error: float) -> str:
    """Two digits; round-off by its bound, for its digits are those of a processor."""
    return "< 1e-9" if error < 1e-9 else f"{error:.1e}"


def patch() -> Iterator[Row]:
    """Two blocks squeezed evenly, with distorted elements inside."""
    for kind, penalty, rule in (
        ("hex8", "hard", "nodal"),
        ("wedge6", "hard", "nodal"),
        ("hex8", 1e5, "gauss"),
        ("hex20", 1e5, "gauss"),
    ):
        solution = fy.solve_static(
            test_bolts.squeezed_blocks(kind, penalty, rule), fy.Load({"plate.Fz": -5400.0})
        )
        exact = solution.contact_force() / 54.0
        worst = np.abs(solution.pressure / exact - 1).max()
        law = "hard" if penalty == "hard" else "penalty"
        yield Row(
            "patch test of contact", "uniform pressure", f"pressure, {kind}, {law}, {rule} [MPa]",
            f"{exact:.4f}", f"{solution.max_pressure:.4f}", rounded(worst), "exact", "test_bolts",
        )  # fmt: skip


def hertz_line() -> Iterator[Row]:
    """Parabolic gap between two blocks 24 half widths large."""
    exact, source = test_hertz.HERTZ, "Hertz 1882; Johnson 1985, (4.43) to (4.45)"
    for penalty, rule in (("hard", "hard, nodal"), ("auto", "penalty, gauss")):
        place, _, solution = test_hertz.solve(1 / 16, penalty)
        peak = float(solution.max_pressure)
        yield Row(
            "Hertz line contact", source, f"peak, {rule} [MPa]", f"{exact.peak_pressure:.2f}",
            f"{peak:.2f}", relative(peak, exact.peak_pressure), "", "test_hertz",
        )  # fmt: skip
        width = float(place[solution.pressure > 0].max())
        yield Row(
            "", "", f"half width, {rule}; element 1/16", f"{exact.half_width:.3f}",
            f"{width:.3f}", relative(width, exact.half_width), "", "test_hertz",
        )  # fmt: skip
        errors = [test_hertz.error(1 / n, penalty) for n in (8, 16)]
        yield Row(
            "", "", f"pressure field, {rule}, root mean square", "0", "", rounded(errors[1]),
            f"{np.log2(errors[0] / errors[1]):.2f}", "test_hertz",
        )  # fmt: skip


def receding_layer() -> Iterator[Row]:
    """Two layers pressed together by strips: contact recedes to a length that no load changes."""
    folder = DATA / "receding_layer"
    described = json.loads((folder / "case.json").read_text())
    mesh = np.load(folder / "mesh.npz")
    layers = test_receding_layer.layers_on_the_mesh(mesh, penalty=1e6, quadrature="gauss")
    solution = layers.pressed(test_receding_layer.FORCE)
    x, gap = test_receding_layer.profile(layers, solution)
    peak = 1e6 * float(np.maximum(-gap, 0.0).max())
    length = float(test_receding_layer.closed_length(x, gap))
    for name, key, ours in (
        ("peak [MPa]", "p0_semi", peak),
        ("contact length [mm]; element 0.625", "a_semi", length),
    ):
        yield Row(
            "receding contact of layers", "integral equation, `tests/data/README.md`", name,
            f"{described[key]:.3f}", f"{ours:.3f}", relative(ours, described[key]), "",
            "test_receding_layer",
        )  # fmt: skip


def vibration_on_a_stop() -> Iterator[Row]:
    """A mass on a spring that strikes an elastic stop, over ten units of time."""
    for key, name in (
        ("euler", "implicit Euler"),
        ("alpha", "generalized-α 0.8"),
        ("decaying", "energy-decaying"),
    ):
        scheme = test_transient.SCHEMES[key]
        errors = [test_transient.free_vibration_beside_a_stop(scheme, h) for h in (0.01, 0.005)]
        yield Row(
            "mass striking a stop", "half periods on one and two springs",
            f"largest displacement error, {name}, step 0.005, amplitude 0.7", "0", "",
            rounded(errors[1]), f"{np.log2(errors[0] / errors[1]):.2f}", "test_transient",
        )  # fmt: skip


def cantilever() -> Iterator[Row]:
    """The bolted cantilever of another program with the same mesh, elements and rule."""
    module, folder = test_reference_cantilever, DATA / "lap_joint"
    mesh = dict(np.load(folder / "mesh.npz"))
    loose = module.generated("gauss2")
    model = module.stuck(loose, mesh, module.node_map(loose, mesh))
    solution = fy.solve_static(model, module.LOADS["LC2"])
    theirs = np.load(folder / "LC2.npz")["p_quad__gauss2"]
    points = model.interfaces["joint"].points
    expected = module.reference_pressure(mesh, points, theirs, "gauss2")
    worst = np.abs(solution.pressure - expected).max() / expected.max()
    yield Row(
        "bolted cantilever, bending and torsion", "NumPy program, `tests/data/README.md`",
        "pressures at all points; the peak [MPa]", f"{expected.max():.3f}",
        f"{solution.max_pressure:.3f}", rounded(worst), "", "test_reference_cantilever",
    )  # fmt: skip


PROBLEMS: tuple[Callable[[], Iterator[Row]], ...] = (
    patch,
    hertz_line,
    receding_layer,
    vibration_on_a_stop,
    cantilever,
)


def rows() -> list[Row]:
    """Solve all problems."""
    return [row for problem in PROBLEMS for row in problem()]


def lines(found: list[Row]) -> Iterator[str]:
    """Yield the table as Markdown."""
    yield f"| {' | '.join(COLUMNS)} |"
    yield "|---" * len(COLUMNS) + "|"
    for row in found:
        cells = [*row.cells()[:-1], f"`{row.test}.py`"]
        yield f"| {' | '.join(cells)} |".replace("  ", " ")


if __name__ == "__main__":
    sys.stdout.write("\n".join(lines(rows())) + "\n")
