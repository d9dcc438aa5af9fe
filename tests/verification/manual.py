"""The verification manual: problems with known answers, solved anew, as the table of a page.

``python tests/verification/manual.py`` prints the table of docs/verification.md;
``test_manual.py`` compares it with the page in every run of the tests.
"""

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import test_backbone
import test_bar_impact
import test_block_on_a_plane
import test_bolted_flange
import test_bolts
import test_cattaneo_mindlin
import test_friction
import test_frictional_bar
import test_hertz
import test_hertz_sphere
import test_joint_assessment
import test_nafems
import test_receding_layer
import test_reference_cantilever
import test_transient
import test_two_leaves

import faying as fy

DATA = Path(__file__).parents[1] / "data"
COLUMNS = ("problem", "source", "quantity", "exact", "faying", "error", "order", "test")


@dataclass(frozen=True)
class Row:
    """One quantity of a problem; ``error`` and ``order`` as text, for not all are relative."""

    quantity: str
    exact: str
    ours: str
    error: str
    order: str = ""


@dataclass(frozen=True)
class Problem:
    """A problem with a known answer, and the test that says more of it."""

    name: str
    source: str
    test: str
    rows: Callable[[], Iterator[Row]]


def rounded(error: float) -> str:
    """Two digits; round-off by its bound, for its digits are those of a processor."""
    return "< 1e-9" if error < 1e-9 else f"{error:.1e}"


def compared(quantity: str, exact: float, ours: float, digits: str = ".6g", order: str = "") -> Row:
    """A quantity and its relative error."""
    error = rounded(abs(ours / exact - 1))
    return Row(quantity, f"{exact:{digits}}", f"{ours:{digits}}", error, order)


def converging(errors: Sequence[float]) -> str:
    """Order of the errors of a mesh or step and of one half as large."""
    return f"{np.log2(errors[0] / errors[1]):.2f}"


def vanishing(quantity: str, errors: Sequence[float]) -> Row:
    """An error that would be zero, on the finer of two meshes or steps."""
    return Row(quantity, "0", "", rounded(errors[1]), converging(errors))


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
        name = f"pressure, {kind}, {law}, {rule} [MPa]"
        yield Row(name, f"{exact:.4f}", f"{solution.max_pressure:.4f}", rounded(worst), "exact")


RULES = ("hard", "hard, nodal"), ("auto", "penalty, gauss")


def hertz_line() -> Iterator[Row]:
    """Parabolic gap between two blocks 24 half widths large."""
    exact = test_hertz.HERTZ
    for penalty, rule in RULES:
        place, _, solution = test_hertz.solve(1 / 16, penalty)
        peak = float(solution.max_pressure)
        width = float(place[solution.pressure > 0].max())
        yield compared(f"peak, {rule} [MPa]", exact.peak_pressure, peak, ".2f")
        yield compared(f"half width, {rule}; element 1/16", exact.half_width, width, ".3f")
        errors = [test_hertz.error(1 / n, penalty) for n in (8, 16)]
        yield vanishing(f"pressure field, {rule}, root mean square", errors)


def hertz_sphere() -> Iterator[Row]:
    """A paraboloid's gap between two blocks ten contact radii large, a quarter of them."""
    exact = test_hertz_sphere.HERTZ
    for penalty, rule in RULES:
        blocks, solution = test_hertz_sphere.solve(1 / 4, penalty)
        peak = float(solution.max_pressure)
        pressed = blocks.joint.points[solution.pressure > 0, :2]
        radius = float(np.hypot(*pressed.T).max())
        yield compared(f"peak, {rule} [MPa]", exact.peak_pressure, peak, ".2f")
        yield compared(f"radius, {rule}; element 1/4", exact.contact_radius, radius, ".3f")
        errors = [test_hertz_sphere.error(1 / n, penalty) for n in (2, 4)]
        yield vanishing(f"pressure field, {rule}, root mean square", errors)


def nafems_cylinder() -> Iterator[Row]:
    """Steel cylinder on an aluminium block, 35 kN/mm."""
    exact = test_nafems.CYLINDER
    found = [test_nafems.cylinder_on_block(1 / n) for n in (8, 16)]
    peaks = [float(solution.max_pressure) for _, solution in found]
    errors = [abs(peak / exact.peak_pressure - 1) for peak in peaks]
    yield compared("peak [MPa]", exact.peak_pressure, peaks[1], ".1f", converging(errors))
    blocks, solution = found[1]
    width = float(blocks.joint.points[solution.pressure > 0, 0].max())
    yield compared("half width [mm]; element 0.39", exact.half_width, width, ".3f")


def nafems_punch() -> Iterator[Row]:
    """Steel punch with a rounded rim on aluminium, a quarter of it, 100 MPa on its end."""
    exact = float(test_nafems.PUNCH.pressure(0.0))
    found = [test_nafems.centre(1 / n) for n in (5, 10)]
    order = converging([abs(one / exact - 1) for one in found])
    yield compared("pressure in the centre [MPa]", exact, found[1], ".2f", order)


def lift_off() -> Iterator[Row]:
    """A sleeve between rigid plates under one bolt, pulled apart."""
    module = test_joint_assessment
    model, phi = module.sleeve(), module.BOLT / (module.BOLT + module.PARTS)
    force = 2e3
    found = fy.assess(model, [fy.Load({"head.Fz": force}, name="lift")])
    apart = fy.solve_static(model, fy.Load({"head.Fz": 3 * module.PRELOAD}))
    joint, factors = found.interfaces["joint"], found.bolts["bolt"].load_factors
    clamp, opens = module.PRELOAD - (1 - phi) * force, module.PRELOAD / (1 - phi)
    for quantity, exact, ours in (
        ("load factor Φ of the bolt", phi, factors["lift"]),
        ("clamp force under 2 kN [N]", clamp, joint.least_clamp),
        ("load at lift-off [N]", opens, force * joint.opening["lift"]),
        ("bolt force beyond lift-off [N]", 3 * module.PRELOAD, float(apart.bolt_force("bolt"))),
    ):
        yield compared(quantity, exact, ours, order="exact")


def flange() -> Iterator[Row]:
    """A stiff flange on an elastic bed under six bolts, pulled and tilted until it is apart."""
    module = test_bolted_flange
    model, opening = module.flange(12), module.opening_moment()
    factor, half_open = module.opened(16)
    coarse, fine = module.errors(*module.opened(8)), module.errors(factor, half_open)
    orders = [converging(errors) for errors in zip(coarse, fine, strict=True)]

    def largest(*tilt: float) -> float:
        return module.bolt_forces(module.solved(model, *tilt)).max()

    closed, apart = module.closed_forces(opening / 2).max(), module.apart(*module.TWISTED).max()
    for quantity, exact, ours, order in (
        (
            "largest bolt force, closed, gauss [N]",
            closed,
            largest(module.PULL, opening / 2),
            "exact",
        ),
        (
            "moment that opens the edge, nodal; facet 1/16 [N mm]",
            opening,
            opening * factor,
            orders[0],
        ),
        (
            "largest bolt force, open in part, nodal; facet 1/16 [N]",
            module.half_open()[1].max(),
            half_open.max(),
            orders[1],
        ),
        ("largest bolt force, apart, two moments [N]", apart, largest(*module.TWISTED), "exact"),
    ):
        yield compared(quantity, exact, ours, order=order)


def bar_impact() -> Iterator[Row]:
    """A bar that strikes a rigid wall, from rest; 160 elements, 80 for the order."""
    for key, name in (("euler", "implicit Euler"), ("decaying", "energy-decaying")):
        scheme = test_bar_impact.SCHEMES[key]
        found = [test_bar_impact.struck(n, scheme) for n in (80, 160)]
        for quantity, values in (
            ("impulse on the wall over F L/c", [one.impulse for one in found]),
            ("energy kept", [one.kept for one in found]),
        ):
            errors = [abs(value - 1) for value in values]
            name_of_row = f"{quantity}, {name}, 160 elements"
            yield Row(name_of_row, "1", f"{values[1]:.4f}", rounded(errors[1]), converging(errors))


def slider() -> Iterator[Row]:
    """A mass on a spring and a slider, over its amplitude."""
    module = test_backbone
    found = fy.backbone(module.mass_on_a_slider(), 1, [0.5], increments=100)
    force = float(found.load[0] * np.sqrt(module.MASS))
    moved = (force - module.LIMIT) / module.SPRING
    lost = 4 * module.LIMIT * (moved - module.LIMIT / module.SLIDER)
    exact = float(np.sqrt(force / moved / module.MASS) / (2 * np.pi))
    ours = float(found.frequency[0])
    yield compared("frequency of large vibration [Hz]", exact, ours, order="exact")
    yield compared("energy lost per cycle", lost, float(found.energy_per_cycle[0]), order="exact")


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
    yield compared("peak [MPa]", described["p0_semi"], peak, ".3f")
    yield compared("contact length [mm]; element 0.625", described["a_semi"], length, ".3f")


def vibration_on_a_stop() -> Iterator[Row]:
    """A mass on a spring that strikes an elastic stop, over ten units of time."""
    for key, name in (
        ("euler", "implicit Euler"),
        ("alpha", "generalized-α 0.8"),
        ("decaying", "energy-decaying"),
    ):
        scheme = test_transient.SCHEMES[key]
        errors = [test_transient.free_vibration_beside_a_stop(scheme, h) for h in (0.01, 0.005)]
        yield vanishing(f"largest displacement error, {name}, step 0.005, amplitude 0.7", errors)


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
    name, peak = "pressures at all points; the peak [MPa]", solution.max_pressure
    yield Row(name, f"{expected.max():.3f}", f"{peak:.3f}", rounded(worst))


def rubbing_cantilever() -> Iterator[Row]:
    """The cantilever pulled by 3 kN with friction, in one increment with the preload."""
    module, mesh = test_friction, dict(np.load(DATA / "lap_joint" / "mesh.npz"))
    smooth = test_reference_cantilever.generated("gauss2")
    model = smooth.with_friction(module.FRICTION, tangential_penalty=module.TANGENTIAL)
    solution = fy.solve_path(model, [module.LOADS["PULL"]])
    theirs = np.load(DATA / "friction" / "G1_mu0.2_PULL.npz")
    points = model.interfaces["joint"].points
    resisting = np.array(
        [
            test_reference_cantilever.reference_pressure(mesh, points, t, "gauss2")
            for t in theirs["t_quad__gauss2"].T
        ]
    ).T
    traction = solution.traction[0, :, :2]
    largest = np.linalg.norm(resisting, axis=1).max()
    worst = np.abs(traction + resisting).max() / largest
    name, ours = "tractions at all points; the largest [MPa]", np.linalg.norm(traction, axis=1)
    yield Row(name, f"{largest:.4f}", f"{ours.max():.4f}", rounded(worst))


def block_on_a_plane() -> Iterator[Row]:
    """A rigid block pulled obliquely through a spring, sticking and slipping."""
    module = test_block_on_a_plane
    for state, force in (("sticking", 230.0), ("slipping", 500.0)):
        found, (moved, held) = module.pulled(force), module.end_of(force)
        ours = float(np.linalg.norm(found.held))
        yield compared(f"force on the block, {state} [N]", held, ours, order="exact")
    exact = 4 * module.LIMIT * (moved - module.LIMIT / module.TOGETHER)
    yield compared("energy per cycle, slipping [mJ]", exact, found.energy, order="exact")


def frictional_bar() -> Iterator[Row]:
    """A bar on a bed of friction, errors over seven forces."""
    module = test_frictional_bar
    found = [module.pulled(n) for n in (50, 100)]
    errors = zip(*(module.errors(one) for one in found), strict=True)
    middle = len(module.PULLS) // 2
    exact = module.exact(found[1].force[middle])
    for (quantity, name, digits), pair in zip(
        (
            ("slip length [mm]; element 1", "slip", ".4g"),
            ("displacement of the end [mm]", "moved", ".6g"),
            ("energy per cycle [mJ]", "energy", ".5g"),
        ),
        errors,
        strict=True,
    ):
        known, ours = getattr(exact, name), getattr(found[1], name)[middle]
        figures = f"{known:{digits}}", f"{ours:{digits}}"
        yield Row(quantity, *figures, rounded(pair[1]), converging(pair))


def two_leaves() -> Iterator[Row]:
    """Two leaves that slip over each other, twice the load at which they begin to."""
    leaves = [test_two_leaves.bent(length) for length in (20.0, 40.0)]
    exact = [5 * one.exact_deflection for one in leaves]
    ours = [one.deflections[2] for one in leaves]
    order = converging([abs(b / a - 1) for a, b in zip(exact, ours, strict=True)])
    unit = leaves[1].exact_deflection
    yield compared(
        "deflection over that at onset, twice its load", exact[1] / unit, ours[1] / unit,
        ".5g", order,
    )  # fmt: skip
    order = converging([abs(one.energy / one.exact_energy - 1) for one in leaves])
    exact_energy, energy = leaves[1].exact_energy, leaves[1].energy
    yield compared("energy per cycle [mJ]", exact_energy, energy, ".5g", order)


def cattaneo_mindlin() -> Iterator[Row]:
    """The cylinders of Hertz's problem pushed sideways by half of μ P."""
    module = test_cattaneo_mindlin
    exact = module.energy()
    for penalty, rule in RULES:
        found = [module.pushed(1 / n, penalty) for n in (8, 16)]
        name = f"half width of stick, {rule}; element 1/16"
        yield compared(name, module.STICKS, found[1].half_width, ".3f")
        errors = [one.traction_error for one in found]
        yield vanishing(f"traction field, {rule}, root mean square", errors)
        order = converging([abs(one.energy / exact - 1) for one in found])
        name = f"energy per cycle and mm, {rule} [mJ]"
        yield compared(name, exact, found[1].energy, ".4g", order)


HERTZ, NAFEMS, COULOMB = "Hertz 1882; Johnson 1985", "Konter 2006, R0094", "Coulomb's law by hand"
SPRINGS, PROGRAM = "half periods on one and two springs", "NumPy program, `tests/data/README.md`"
EQUATION = "integral equation, `tests/data/README.md`"
LAYER = "shear layer, Menq et al. 1986"
WAVES, DIAGRAM = "waves, Graff 1975, §2.4", "bolt diagram (VDI 2230)"
MINDLIN = "Cattaneo 1938, Mindlin 1949; Johnson 1985, §7.2"
PLATE, LEAVES = "equilibrium of a rigid plate", "Goodman & Klumpp 1956"
PROBLEMS = (
    Problem("patch test of contact", "uniform pressure", "test_bolts", patch),
    Problem("Hertz line contact", f"{HERTZ}, (4.43) to (4.45)", "test_hertz", hertz_line),
    Problem("Hertz point contact", f"{HERTZ}, (4.22) to (4.24)", "test_hertz_sphere", hertz_sphere),
    Problem("NAFEMS: cylinder on block", f"{NAFEMS}; Hertz", "test_nafems", nafems_cylinder),
    Problem("NAFEMS: punch, a quarter", f"{NAFEMS}; Sneddon 1965", "test_nafems", nafems_punch),
    Problem("receding contact of layers", EQUATION, "test_receding_layer", receding_layer),
    Problem("bolted joint that lifts off", DIAGRAM, "test_joint_assessment", lift_off),
    Problem("flange under six bolts that lifts off", PLATE, "test_bolted_flange", flange),
    Problem("mass striking a stop", SPRINGS, "test_transient", vibration_on_a_stop),
    Problem("bar striking a wall", WAVES, "test_bar_impact", bar_impact),
    Problem("mass on a spring and a slider", COULOMB, "test_backbone", slider),
    Problem(
        "block on a plane, pulled by a spring", COULOMB, "test_block_on_a_plane", block_on_a_plane
    ),
    Problem("bar on a frictional bed, seven forces", LAYER, "test_frictional_bar", frictional_bar),
    Problem("two leaves of a cantilever, L/h = 40", LEAVES, "test_two_leaves", two_leaves),
    Problem("Cattaneo–Mindlin", MINDLIN, "test_cattaneo_mindlin", cattaneo_mindlin),
    Problem(
        "bolted cantilever, bending and torsion", PROGRAM, "test_reference_cantilever", cantilever
    ),
    Problem("bolted cantilever, pulled, μ = 0.2", PROGRAM, "test_friction", rubbing_cantilever),
)


HEAD = f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|"


def lines(problem: Problem) -> Iterator[str]:
    """Solve a problem, yield its rows of the table as Markdown."""
    titles = problem.name, problem.source
    for row in problem.rows():
        cells = *titles, *vars(row).values(), f"`{problem.test}.py`"
        yield f"| {' | '.join(cells)} |".replace("  ", " ")
        titles = "", ""


if __name__ == "__main__":
    table = [*HEAD, *(line for problem in PROBLEMS for line in lines(problem))]
    sys.stdout.write("\n".join(table) + "\n")
