"""Judge a pipe flange and a bracket by hand and by faying.

``python docs/validation/judged_by_hand.py [FOLDER]`` meshes both with gmsh (``pip install gmsh``),
runs their studies in the folder and prints the tables of docs/judged_by_hand.md. Some
minutes.
"""

import sys
from collections.abc import Iterator, Mapping
from math import cos, hypot, pi, radians, sin, sqrt
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import gmsh
import numpy as np

import faying as fy
from faying.assessment.check import Check
from faying.assessment.joint_record import BoltAssessment, InterfaceAssessment
from faying.study.judgement.verdict import run_verdict
from faying.study.keys.schema import read_study
from faying.study.results.store import read_results
from faying.workflow.run import run

MU_THREAD = MU_HEAD = 0.12
MU_FACE = 0.15
YOUNGS = 210e3

FLANGE = {"circle": 130.0, "inner": 40.0, "outer": 85.0, "pipe": 50.0, "thick": 16.0, "stub": 50.0}
PULLED = {"pull": {"Fz": 40e3}, "bend": {"My": 1.5e6}}
BRACKET = {"base": 20.0, "foot": 12.0, "rows": 40.0, "height": 80.0, "wall": -34.0}


def meshed(path: Path, size: float, around: int = 10) -> None:
    """Mesh what was drawn with curved tetrahedra, and write it."""
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", around)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.HighOrderOptimize", 2)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(path))
    gmsh.finalize()


def named(bodies: dict[str, list[tuple[int, int]]], faces: dict[str, float]) -> None:
    """Name volumes, and the faces whose centres lie at a height z."""
    gmsh.model.occ.synchronize()
    for name, body in bodies.items():
        gmsh.model.addPhysicalGroup(3, [tag for kind, tag in body if kind == 3], name=name)
    for name, z in faces.items():
        every = [tag for _, tag in gmsh.model.getEntities(2)]
        at = [t for t in every if abs(gmsh.model.occ.getCenterOfMass(2, t)[2] - z) < 1e-6]
        gmsh.model.addPhysicalGroup(2, at, name=name)


def start() -> Any:
    """Begin a drawing; return the kernel it is drawn by."""
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    return gmsh.model.occ


def flange_places() -> list[tuple[float, float]]:
    """Return where the bolts of the flange are."""
    angles = [radians(45 * number) for number in range(8)]
    return [(FLANGE["circle"] / 2 * cos(a), FLANGE["circle"] / 2 * sin(a)) for a in angles]


def mesh_flange(path: Path, size: float = 12.0, around: int = 10) -> None:
    """Draw and mesh two pipe stubs with flanges."""
    occ, t, end = start(), FLANGE["thick"], FLANGE["thick"] + FLANGE["stub"]
    halves = []
    for side in (-1, 1):
        disk = occ.addCylinder(0, 0, 0, 0, 0, side * t, FLANGE["outer"])
        pipe = occ.addCylinder(0, 0, 0, 0, 0, side * end, FLANGE["pipe"])
        body, _ = occ.fuse([(3, disk)], [(3, pipe)])
        tools = [(3, occ.addCylinder(0, 0, 0, 0, 0, side * end, FLANGE["inner"]))]
        tools += [(3, occ.addCylinder(x, y, 0, 0, 0, side * t, 6.75)) for x, y in flange_places()]
        halves.append(occ.cut(body, tools)[0])
    _, parts = occ.fragment(*halves)
    named({"lower": parts[0], "upper": parts[1]}, {"clamp": -end, "end": end})
    meshed(path, size, around)


def bracket_places() -> list[tuple[float, float]]:
    """Return where the bolts of the bracket are."""
    return [(x, y) for x in (-20.0, 20.0) for y in (-18.0, 18.0)]


def mesh_bracket(path: Path) -> None:
    """Draw and mesh an angle on a plate."""
    occ, base, foot = start(), BRACKET["base"], BRACKET["foot"]
    plate = [(3, occ.addBox(-50, -40, -base, 100, 80, base))]
    flat = occ.addBox(-40, -30, 0, 80, 60, foot)
    wall = occ.addBox(-40, -30, 0, 12, 60, BRACKET["height"])
    angle, _ = occ.fuse([(3, flat)], [(3, wall)])
    holes = [(3, occ.addCylinder(x, y, -base, 0, 0, base + foot, 4.5)) for x, y in bracket_places()]
    plate, _ = occ.cut(plate, holes, removeTool=False)
    angle, _ = occ.cut(angle, holes)
    _, parts = occ.fragment(plate, angle)
    named({"base": parts[0], "bracket": parts[1]}, {"clamp": -base, "end": BRACKET["height"]})
    meshed(path, 7.0)


BOLT = """
[[bolt]]
name = "{name}"
axis = [[{x:.4f}, {y:.4f}, {low}], [{x:.4f}, {y:.4f}, {high}]]
size = "{size}"
grade = "8.8"
torque = {torque}
thread_friction = 0.12
head_friction = 0.12
tightening_factor = {factor}
head_pressure_limit = {pressure}
engagement = {engagement}
"""


def study(mesh: str, minus: str, plus: str, bolts: str, cases: dict[str, dict[str, float]]) -> str:
    """Return the study of a joint."""
    text = f"""title = "{mesh.removesuffix(".msh").capitalize()}"
units = "mm-t-s"

[model]
source = "mesh"
file = "{mesh}"
separate = ["{plus}"]

[material.default]
E = {YOUNGS}
nu = 0.3
rho = 7.85e-9

[[interface]]
name = "joint"
minus = "{minus}"
plus = "{plus}"
{bolts}
[[support]]
set = "clamp"

[[boundary]]
name = "end"
set = "end"
coupling = "rbe3"

[sticking]
threshold = 0.1
stiffness = 1e5

[requirement]
slip_friction = {MU_FACE}

[reduction]
methods = ["compliance"]
normal_modes = 4
"""
    for name, loads in cases.items():
        forces = ", ".join(
            f'{{ boundary = "end", component = "{key}", value = {value} }}'
            for key, value in loads.items()
        )
        text += f'\n[[load_case]]\nname = "{name}"\nkind = "static"\nforces = [{forces}]\n'
    return text


def written_flange(folder: Path) -> None:
    """Write mesh and study of the flange."""
    mesh_flange(folder / "flange.msh")
    bolts = "".join(
        BOLT.format(
            name=f"bolt-{number}", x=x, y=y, low=-16.0, high=16.0, size="M12", torque=65e3,
            factor=1.4, pressure=710.0, engagement=10.0,
        )
        for number, (x, y) in enumerate(flange_places(), 1)
    )  # fmt: skip
    cases = PULLED | {"shear and twist": {"Fx": 8e3, "Mz": 0.8e6}}
    (folder / "flange.toml").write_text(study("flange.msh", "lower", "upper", bolts, cases))


def written_bracket(folder: Path) -> None:
    """Write mesh and study of the bracket."""
    mesh_bracket(folder / "bracket.msh")
    bolts = "".join(
        BOLT.format(
            name=f"bolt-{number}", x=x, y=y, low=-20.0, high=12.0, size="M8", torque=22e3,
            factor=1.0, pressure=710.0, engagement=8.0,
        )
        for number, (x, y) in enumerate(bracket_places(), 1)
    )  # fmt: skip
    cases = {"push": {"Fx": 1500.0}, "lift": {"Fz": 4000.0}}
    (folder / "bracket.toml").write_text(study("bracket.msh", "base", "bracket", bolts, cases))


class Thread:
    """What hand calculation takes from tables: d, P, d2, A_S, head, hole."""

    def __init__(self, d: float, pitch: float, head: float, hole: float) -> None:
        d2, d3 = d - 0.6495 * pitch, d - 1.2269 * pitch
        self.d2, self.pitch, self.mean = d2, pitch, (d2 + d3) / 2
        self.area = pi / 4 * self.mean**2
        self.bearing = pi / 4 * (head**2 - hole**2)
        self.ratio = 0.16 * pitch + 0.58 * d2 * MU_THREAD + (head + hole) / 4 * MU_HEAD

    def tightening(self, force: float, share: float = 1.0) -> float:
        """Return the stress with a share of the torsion."""
        moment = force * (0.16 * self.pitch + 0.58 * self.d2 * MU_THREAD)
        return hypot(force / self.area, sqrt(3) * share * moment / (pi / 16 * self.mean**3))

    def bent(self, force: float, moment: float) -> float:
        """Return the stress with half of the torsion and a bending moment."""
        twisted = sqrt(self.tightening(force, 0.5) ** 2 - (force / self.area) ** 2)
        return hypot(force / self.area + moment / (pi / 32 * self.mean**3), twisted)


def strip_opening(
    force: float, load: float, *, bolt: float, entry: float, edge: float, far: float
) -> float:
    """Return the factor on a load at which half of a strip under a bolt is open.

    Pressure is linear and begins half-way from the edge that opens: it acts at a sixth of the
    strip before the far one, and balances the bolt and the load where it enters.
    """
    acts = far + (edge - far) / 6
    return force / load * (acts - bolt) / (acts - entry)


Row = tuple[str, float, float, str]
Checks = dict[tuple[str, str], Check]
Judged = tuple[InterfaceAssessment, Mapping[str, BoltAssessment], Checks]


def flange_rows(folder: Path) -> Iterator[Row]:
    """Yield what is judged of the flange, its value by hand and by faying, and the unit."""
    joint, bolts, checks = judged(folder / "flange.toml", folder / "flange")
    thread = Thread(12.0, 1.75, 16.63, 13.5)
    force, gamma = 65e3 / thread.ratio, 0.4 / 2.4
    high, low = (1 + gamma) * force, (1 - gamma) * force
    pull, bend = 40e3 / 8, 4 * 1.5e6 / (8 * FLANGE["circle"])
    needed = 8e3 / (8 * force) + 0.8e6 / (8 * force * FLANGE["circle"] / 2)
    slip = joint.slip.needed_friction["shear and twist"]
    yield "preload of 65 N m", force, bolts["bolt-1"].preload, "N"
    yield from strength_rows(thread, high, checks)
    yield "clamp force at rest", 8 * force, joint.preload, "N"
    yield "clamp force under pull", 8 * (force - pull), joint.least_clamp, "N"
    yield "friction needed, shear and twist", needed, slip, ""
    bent = thread.bent(high, high / force * moment(bolts))
    yield "yield, with the model's bending", bent, largest(checks, "yield"), "MPa"
    yield "clamp loss around a bolt, pull", 100 * pull / low, loss(checks, "pull"), "%"
    yield "clamp loss around a bolt, bend", 100 * bend / low, loss(checks, "bend"), "%"
    pipe = (FLANGE["pipe"] + FLANGE["inner"]) / 2
    strip = {"edge": FLANGE["inner"], "far": FLANGE["outer"], "entry": pipe}
    for case, load in (("pull", pull), ("bend", 4 * 1.5e6 / (8 * 2 * pipe))):
        opens = strip_opening(force, load, bolt=FLANGE["circle"] / 2, **strip)
        yield f"opening around a bolt, {case}", opens, opening(bolts, case), "× load"


def bracket_rows(folder: Path) -> Iterator[Row]:
    """Yield the same of the bracket."""
    joint, bolts, checks = judged(folder / "bracket.toml", folder / "bracket")
    thread = Thread(8.0, 1.25, 11.63, 9.0)
    force = 22e3 / thread.ratio
    lift = 4000 / 2
    yield "preload of 22 N m", force, bolts["bolt-1"].preload, "N"
    yield from strength_rows(thread, force, checks)
    yield "clamp force at rest", 4 * force, joint.preload, "N"
    yield "clamp force under lift", 4 * force - 4e3, joint.least_clamp, "N"
    yield "friction needed, push", 1500 / (4 * force), joint.slip.needed_friction["push"], ""
    bent = thread.bent(force, moment(bolts))
    yield "yield, with the model's bending", bent, largest(checks, "yield"), "MPa"
    yield "clamp loss around a bolt, lift", 100 * lift / force, loss(checks, "lift"), "%"
    strip = {"edge": -40.0, "far": 0.0, "entry": BRACKET["wall"]}
    opens = strip_opening(force, lift, bolt=-BRACKET["rows"] / 2, **strip)
    yield "opening around a bolt, lift", opens, opening(bolts, "lift"), "× load"


def at_opening(folder: Path, load: fy.Load, places: list[tuple[float, float]], entry: float) -> str:
    """Return what the area of the bolt that opens first is in balance with when half is open.

    Parameters
    ----------
    places
        Of the bolts, which are seen along the direction from the centre of the joint (flange), or
        along x (bracket).
    entry
        Where the load enters along it.
    """
    results, case = read_results(folder / "results.h5"), load.name
    rom, surface = results.reduced["compliance"][0], results.interfaces["joint"]
    factors = {
        name: bolt.opening_around["joint"][case] for name, bolt in results.assessment.bolts.items()
    }
    first = min(factors, key=factors.__getitem__)
    number = list(factors).index(first)
    x, y = places[number]
    along = np.array([x, y, 0.0]) / hypot(x, y) if len(places) > 4 else np.array([1.0, 0.0, 0.0])
    away = [np.hypot(surface.points[:, 0] - a, surface.points[:, 1] - b) for a, b in places]
    own = np.argmin(away, axis=0) == number
    opened = fy.solve_static(rom, load.scaled(factors[first]))
    forces = (opened.pressure * surface.weights)[own]
    bolt, at = float(opened.bolt_force(first)), float(np.array([x, y, 0.0]) @ along)
    acts = float(forces @ (surface.points[own] @ along)) / forces.sum()
    taken = bolt - forces.sum()
    borne = 1 - forces.sum() * (acts - at) / (taken * (at - entry))
    return (
        f"{case}, {first}: pressure acts at {acts:.1f} mm, the load takes {taken / 1e3:.1f} kN, "
        f"and the part itself bears {borne:.0%} of its moment\n"
    )


def strength_rows(thread: Thread, force: float, checks: Checks) -> Iterator[Row]:
    """Yield the strength of the most loaded bolt, whose force by hand is that of tightening."""
    strongest = largest(checks, "stripping")
    yield "tightening", thread.tightening(force), largest(checks, "tightening"), "MPa"
    yield "largest bolt force", force, strongest, "N"
    pressed = largest(checks, "pressure under the head")
    yield "pressure under the head", force / thread.bearing, pressed, "MPa"
    twisted = sqrt(thread.tightening(force, 0.5) ** 2 - (force / thread.area) ** 2)
    reduced = hypot(strongest / thread.area, twisted)
    yield "yield, without bending", thread.tightening(force, 0.5), reduced, "MPa"


def judged(study: Path, out: Path) -> Judged:
    """Run a study; return its interface, its bolts, and all checks by part and quantity."""
    run(read_study(study), out)
    results = read_results(out / "results.h5")
    verdict = run_verdict(results)
    checks = {(part.part, c.quantity): c for part in verdict.parts for c in part.checks}
    return results.assessment.interfaces["joint"], results.assessment.bolts, checks


def largest(checks: Checks, quantity: str) -> float:
    """Return the largest value of a check over all parts."""
    return max(check.value for (_, name), check in checks.items() if name == quantity)


def loss(checks: Checks, case: str) -> float:
    """Return the largest loss of clamp force around a bolt that a case decides [%]."""
    around = [c for (_, name), c in checks.items() if name.startswith("clamp loss at")]
    return max(c.value for c in around if c.case == case)


def moment(bolts: Mapping[str, BoltAssessment]) -> float:
    """Return the largest bending moment of a bolt at nominal preload."""
    return max(bolt.bending.most for bolt in bolts.values())


def opening(bolts: Mapping[str, BoltAssessment], case: str) -> float:
    """Return the least factor at which half of the area around a bolt is open."""
    return min(bolt.opening_around["joint"][case] for bolt in bolts.values())


def main() -> None:
    """Print both tables."""
    with TemporaryDirectory() as thrown:
        folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(thrown)
        folder.mkdir(exist_ok=True)
        written_flange(folder)
        written_bracket(folder)
        for rows in (flange_rows(folder), bracket_rows(folder)):
            sys.stdout.write("| figure | by hand | faying | differs |\n|---|---|---|---|\n")
            for name, hand, program, unit in rows:
                cells = (name, f"{hand:.4g} {unit}", f"{program:.4g}", f"{program / hand - 1:+.1%}")
                sys.stdout.write("| " + " | ".join(cells) + " |\n")
            sys.stdout.write("\n")
        pipe = (FLANGE["pipe"] + FLANGE["inner"]) / 2
        for name in ("pull", "bend"):
            load = fy.Load({f"end.{key}": value for key, value in PULLED[name].items()}, name=name)
            sys.stdout.write(at_opening(folder / "flange", load, flange_places(), pipe))
        lift = fy.Load({"end.Fz": 4e3}, name="lift")
        sys.stdout.write(at_opening(folder / "bracket", lift, bracket_places(), BRACKET["wall"]))


if __name__ == "__main__":
    main()
