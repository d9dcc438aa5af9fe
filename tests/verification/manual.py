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


def hertz_sphere() -> Iterator[Row]:
    """A paraboloid's gap between two blocks ten contact radii large, a quarter of them."""
    exact, source = test_hertz_sphere.HERTZ, "Hertz 1882; Johnson 1985, (4.22) to (4.24)"
    for penalty, rule in (("hard", "hard, nodal"), ("auto", "penalty, gauss")):
        blocks, solution = test_hertz_sphere.solve(1 / 4, penalty)
        peak = float(solution.max_pressure)
        yield Row(
            "Hertz point contact", source, f"peak, {rule} [MPa]", f"{exact.peak_pressure:.2f}",
            f"{peak:.2f}", relative(peak, exact.peak_pressure), "", "test_hertz_sphere",
        )  # fmt: skip
        pressed = blocks.joint.points[solution.pressure > 0, :2]
        radius = float(np.hypot(*pressed.T).max())
        yield Row(
            "", "", f"radius, {rule}; element 1/4", f"{exact.contact_radius:.3f}",
            f"{radius:.3f}", relative(radius, exact.contact_radius), "", "test_hertz_sphere",
        )  # fmt: skip
        errors = [test_hertz_sphere.error(1 / n, penalty) for n in (2, 4)]
        yield Row(
            "", "", f"pressure field, {rule}, root mean square", "0", "", rounded(errors[1]),
            f"{np.log2(errors[0] / errors[1]):.2f}", "test_hertz_sphere",
        )  # fmt: skip


def nafems_cylinder() -> Iterator[Row]:
    """Steel cylinder on an aluminium block, 35 kN/mm."""
    exact = test_nafems.CYLINDER
    found = [test_nafems.cylinder_on_block(1 / n) for n in (8, 16)]
    peaks = [float(solution.max_pressure) for _, solution in found]
    errors = [abs(peak / exact.peak_pressure - 1) for peak in peaks]
    yield Row(
        "NAFEMS: cylinder on block", "Konter 2006, R0094; Hertz", "peak [MPa]",
        f"{exact.peak_pressure:.1f}", f"{peaks[1]:.1f}", rounded(errors[1]),
        f"{np.log2(errors[0] / errors[1]):.2f}", "test_nafems",
    )  # fmt: skip
    blocks, solution = found[1]
    width = float(blocks.joint.points[solution.pressure > 0, 0].max())
    yield Row(
        "", "", "half width [mm]; element 0.39", f"{exact.half_width:.3f}", f"{width:.3f}",
        relative(width, exact.half_width), "", "test_nafems",
    )  # fmt: skip


def nafems_punch() -> Iterator[Row]:
    """Steel punch with a rounded rim on aluminium, a quarter of it, 100 MPa on its end."""
    exact = float(test_nafems.PUNCH.pressure(0.0))
    found = [test_nafems.centre(1 / n) for n in (5, 10)]
    errors = [abs(one / exact - 1) for one in found]
    yield Row(
        "NAFEMS: punch, a quarter", "Konter 2006, R0094; Sneddon 1965",
        "pressure in the centre [MPa]",
        f"{exact:.2f}", f"{found[1]:.2f}", rounded(errors[1]),
        f"{np.log2(errors[0] / errors[1]):.2f}", "test_nafems",
    )  # fmt: skip


def lift_off() -> Iterator[Row]:
    """A sleeve between rigid plates under one bolt, pulled apart."""
    module = test_joint_assessment
    model, phi = module.sleeve(), module.BOLT / (module.BOLT + module.PARTS)
    force = 2e3
    found = fy.assess(model, [fy.Load({"head.Fz": force}, name="lift")])
    apart = fy.solve_static(model, fy.Load({"head.Fz": 3 * module.PRELOAD}))
    for quantity, exact, ours in (
        ("load factor Φ of the bolt", phi, found.bolts["bolt"].load_factors["lift"]),
        (
            "clamp force under 2 kN [N]",
            module.PRELOAD - (1 - phi) * force,
            found.interfaces["joint"].least_clamp,
        ),
        (
            "load at lift-off [N]",
            module.PRELOAD / (1 - phi),
            force * found.interfaces["joint"].opening["lift"],
        ),
        ("bolt force beyond lift-off [N]", 3 * module.PRELOAD, float(apart.bolt_force("bolt"))),
    ):
        first = quantity.startswith("load factor")
        yield Row(
            "bolted joint that lifts off" if first else "",
            "bolt diagram (VDI 2230)" if first else "",
            quantity, f"{exact:.6g}", f"{ours:.6g}", relative(ours, exact), "exact",
            "test_joint_assessment",
        )  # fmt: skip


def flange() -> Iterator[Row]:
    """A stiff flange on an elastic bed under six bolts, pulled and tilted until it is apart."""
    module = test_bolted_flange
    model, moment = module.flange(12), 0.5 * module.opening_moment()
    factor, half_open = module.opened(16)
    coarse, fine = module.errors(*module.opened(8)), module.errors(factor, half_open)
    orders = [f"{order:.2f}" for order in np.log2(np.divide(coarse, fine))]
    for place, (quantity, exact, ours, order) in enumerate(
        (
            (
                "largest bolt force, closed, gauss [N]",
                module.closed_forces(moment).max(),
                module.bolt_forces(module.solved(model, module.PULL, moment)).max(),
                "exact",
            ),
            (
                "moment that opens the edge, nodal; facet 1/16 [N mm]",
                module.opening_moment(),
                module.opening_moment() * factor,
                orders[0],
            ),
            (
                "largest bolt force, open in part, nodal; facet 1/16 [N]",
                module.half_open()[1].max(),
                half_open.max(),
                orders[1],
            ),
            (
                "largest bolt force, apart, two moments [N]",
                module.apart(*module.TWISTED).max(),
                module.bolt_forces(module.solved(model, *module.TWISTED)).max(),
                "exact",
            ),
        )
    ):
        yield Row(
            "" if place else "flange under six bolts that lifts off",
            "" if place else "equilibrium of a rigid plate",
            quantity, f"{exact:.6g}", f"{ours:.6g}", relative(ours, exact), order,
            "test_bolted_flange",
        )  # fmt: skip


def bar_impact() -> Iterator[Row]:
    """A bar that strikes a rigid wall, from rest; 160 elements, 80 for the order."""
    for key, name in (("euler", "implicit Euler"), ("decaying", "energy-decaying")):
        scheme = test_bar_impact.SCHEMES[key]
        coarse, fine = (test_bar_impact.struck(n, scheme) for n in (80, 160))
        for quantity, exact, ours, errors in (
            (
                "impulse on the wall over F L/c",
                1.0,
                fine.impulse,
                [abs(one.impulse - 1) for one in (coarse, fine)],
            ),
            ("energy kept", 1.0, fine.kept, [1 - one.kept for one in (coarse, fine)]),
        ):
            first = quantity.startswith("impulse")
            yield Row(
                "bar striking a wall" if first else "", "waves, Graff 1975, §2.4" if first else "",
                f"{quantity}, {name}, 160 elements", f"{exact:g}", f"{ours:.4f}",
                rounded(errors[1]), f"{np.log2(errors[0] / errors[1]):.2f}", "test_bar_impact",
            )  # fmt: skip


def slider() -> Iterator[Row]:
    """A mass on a spring and a slider, over its amplitude."""
    module = test_backbone
    found = fy.backbone(module.mass_on_a_slider(), 1, [0.5], increments=100)
    force = float(found.load[0] * np.sqrt(module.MASS))
    moved = (force - module.LIMIT) / module.SPRING
    lost = 4 * module.LIMIT * (moved - module.LIMIT / module.SLIDER)
    for quantity, exact, ours in (
        (
            "frequency of large vibration [Hz]",
            np.sqrt(force / moved / module.MASS) / (2 * np.pi),
            float(found.frequency[0]),
        ),
        ("energy lost per cycle", lost, float(found.energy_per_cycle[0])),
    ):
        first = quantity.startswith("frequency")
        yield Row(
            "mass on a spring and a slider" if first else "",
            "Coulomb's law by hand" if first else "",
            quantity, f"{exact:.6g}", f"{ours:.6g}", relative(ours, exact), "exact",
            "test_backbone",
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
    yield Row(
        "bolted cantilever, pulled, μ = 0.2", "NumPy program, `tests/data/README.md`",
        "tractions at all points; the largest [MPa]", f"{largest:.4f}",
        f"{np.linalg.norm(traction, axis=1).max():.4f}", rounded(worst), "", "test_friction",
    )  # fmt: skip


def block_on_a_plane() -> Iterator[Row]:
    """A rigid block pulled obliquely through a spring, sticking and slipping."""
    module = test_block_on_a_plane
    for state, force in (("sticking", 230.0), ("slipping", 500.0)):
        found, (moved, held) = module.pulled(force), module.end_of(force)
        rows = [("force on the block", held, float(np.linalg.norm(found.held)), "N")]
        if state == "slipping":
            exact = 4 * module.LIMIT * (moved - module.LIMIT / module.TOGETHER)
            rows.append(("energy per cycle", exact, found.energy, "mJ"))
        for quantity, exact, ours, unit in rows:
            first = state == "sticking"
            yield Row(
                "block on a plane, pulled by a spring" if first else "",
                "Coulomb's law by hand" if first else "",
                f"{quantity}, {state} [{unit}]", f"{exact:.6g}", f"{ours:.6g}",
                relative(ours, exact), "exact", "test_block_on_a_plane",
            )  # fmt: skip


def frictional_bar() -> Iterator[Row]:
    """A bar on a bed of friction, errors over seven forces."""
    module = test_frictional_bar
    found = [module.pulled(n) for n in (50, 100)]
    errors = [module.errors(one) for one in found]
    middle = len(module.PULLS) // 2
    exact = module.exact(found[1].force[middle])
    for place, (quantity, name, digits) in enumerate(
        (
            ("slip length [mm]; element 1", "slip", ".4g"),
            ("displacement of the end [mm]", "moved", ".6g"),
            ("energy per cycle [mJ]", "energy", ".5g"),
        )
    ):
        yield Row(
            "bar on a frictional bed, seven forces" if not place else "",
            "shear layer, Menq et al. 1986" if not place else "",
            quantity, f"{getattr(exact, name):{digits}}",
            f"{getattr(found[1], name)[middle]:{digits}}", rounded(errors[1][place]),
            f"{np.log2(errors[0][place] / errors[1][place]):.2f}", "test_frictional_bar",
        )  # fmt: skip


def two_leaves() -> Iterator[Row]:
    """Two leaves that slip over each other, twice the load at which they begin to."""
    coarse, fine = (test_two_leaves.bent(length) for length in (20.0, 40.0))
    for place, (quantity, values) in enumerate(
        {
            "deflection over that at onset, twice its load": [
                (5 * one.exact_deflection, one.deflections[2], one.exact_deflection)
                for one in (coarse, fine)
            ],
            "energy per cycle [mJ]": [
                (one.exact_energy, one.energy, 1.0) for one in (coarse, fine)
            ],
        }.items()
    ):
        errors = [abs(ours / exact - 1) for exact, ours, _ in values]
        exact, ours, unit = values[1]
        yield Row(
            "two leaves of a cantilever, L/h = 40" if not place else "",
            "Goodman & Klumpp 1956" if not place else "",
            quantity, f"{exact / unit:.5g}", f"{ours / unit:.5g}", rounded(errors[1]),
            f"{np.log2(errors[0] / errors[1]):.2f}", "test_two_leaves",
        )  # fmt: skip


def cattaneo_mindlin() -> Iterator[Row]:
    """The cylinders of Hertz's problem pushed sideways by half of μ P."""
    module = test_cattaneo_mindlin
    source = "Cattaneo 1938, Mindlin 1949; Johnson 1985, §7.2"
    exact = module.energy()
    for penalty, rule in (("hard", "hard, nodal"), ("auto", "penalty, gauss")):
        coarse, fine = (module.pushed(1 / n, penalty) for n in (8, 16))
        yield Row(
            "Cattaneo–Mindlin", source, f"half width of stick, {rule}; element 1/16",
            f"{module.STICKS:.3f}", f"{fine.half_width:.3f}",
            relative(fine.half_width, module.STICKS), "", "test_cattaneo_mindlin",
        )  # fmt: skip
        errors = [one.traction_error for one in (coarse, fine)]
        yield Row(
            "", "", f"traction field, {rule}, root mean square", "0", "", rounded(errors[1]),
            f"{np.log2(errors[0] / errors[1]):.2f}", "test_cattaneo_mindlin",
        )  # fmt: skip
        errors = [abs(one.energy / exact - 1) for one in (coarse, fine)]
        yield Row(
            "", "", f"energy per cycle and mm, {rule} [mJ]", f"{exact:.4g}", f"{fine.energy:.4g}",
            rounded(errors[1]), f"{np.log2(errors[0] / errors[1]):.2f}", "test_cattaneo_mindlin",
        )  # fmt: skip


PROBLEMS: tuple[Callable[[], Iterator[Row]], ...] = (
    patch,
    hertz_line,
    hertz_sphere,
    nafems_cylinder,
    nafems_punch,
    receding_layer,
    lift_off,
    flange,
    vibration_on_a_stop,
    bar_impact,
    slider,
    block_on_a_plane,
    frictional_bar,
    two_leaves,
    cattaneo_mindlin,
    cantilever,
    rubbing_cantilever,
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
