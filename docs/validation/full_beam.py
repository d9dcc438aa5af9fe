"""The Brake-Reuss beam with measured surfaces, against backbones that others computed of it.

``python docs/validation/full_beam.py FOLDER`` prints the tables of docs/measured_joint.md; behind
the folder ``flat-alike`` has one tangential stiffness at all points, ``flat-heights`` prints what
asperities at a hundred heights in each point damp that move as the stuck joint does. The folder
holds Job.inp (github.com/Nidish96/Abaqus4Joints, assets/demo), brb_surface_data.mat,
brb_epmc_flat.yaml and brb_epmc_meso.yaml (github.com/tmd-lab/tmdsimpy, examples/structures).
"""

import re
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.io import loadmat

import faying as fy
from faying._typing import Vector
from faying.assessment.stuck_modes import stuck_modes
from faying.contact.laws import Coulomb
from faying.interface.surface_scan import Scan
from faying.interface.topography import ScanPlacement, topography
from faying.simulation.path import path_start

YOUNG, POISSON, FRICTION = 192.31e9, 0.3, 0.03
BOLT = (12002 + 12075 + 12670) / 3
LINEAR = 0.087e-2
"""Modulus [Pa], Poisson's ratio and coefficient, force of a bolt [N], damping beside friction."""

YIELD, HARDENING = 331.7e6, 620e6
"""Of an asperity [Pa]."""

ENDS = ((38150, 38151), (38986, 38988), (38987, 38989))
"""Nodes of each bolt's end and its nut, which the deck leaves free along the bolt."""

SPRING = 1e6
"""Between them [N/m], so that statics can run; a bolt has 3e8, the closed lap 3e10."""

SOFT = 1e3
"""The same where the lap is open [N/m]."""

LEVELS = (4e-6, 1.24e-5, 4.36e-5)
"""Modal amplitudes [m kg^½]."""

MODES = {"flat": (168.5026, 580.4082, 1177.6498), "meso": (180.6293, 595.2815, 1199.9013)}
FREE = (65.644, 144.087, 588.808, 625.300, 688.520, 707.469)
"""Their bending modes after preload, and elastic modes without contact [Hz] (brb_epmc.py)."""


@dataclass(frozen=True, kw_only=True)
class Asperities:
    """Equal spheres at heights of a tabulated density (Porter & Brake, MSSP 192 (2023) 110210)."""

    radius: float
    gaps: Vector
    numbers: Vector

    def at(self, closure: float) -> tuple[float, float, float]:
        """Return pressure, and normal and tangential stiffness per area on the way back."""
        force, normal, shear = self.at_heights(closure)
        return float(force.sum()), float(normal.sum()), float(shear.sum())

    def at_heights(self, closure: float) -> tuple[Vector, Vector, Vector]:
        """Return the same of the asperities at each height (101,)."""
        modulus = YOUNG / (2 * (1 - POISSON**2))
        hard = 1.295 * np.exp(0.736 * POISSON) * np.pi * YIELD
        limit = self.radius * (hard / (2 * modulus)) ** 2
        depth = np.maximum(closure - self.gaps, 1e-15)
        ratio = depth / limit
        hertz = 4 / 3 * modulus * np.sqrt(self.radius) * depth**1.5
        share = np.exp(-3.3 * HARDENING / YOUNG)
        plastic = self._flattened(ratio, modulus, hard, depth)
        elastic = ratio < 1.9
        force = np.where(elastic, hertz, hertz + share * (plastic - hertz))
        # Back along Hertz's law of a flatter sphere (Brake, IJSS 62 (2015) 104), which meets the
        # force: radius and depth change by inverse factors.
        contact = np.sqrt(self.radius * depth)
        shear = YOUNG / (4 * (1 + POISSON) * (2 - POISSON))
        met = self.numbers * (closure > self.gaps)
        return met * force, met * 2 * modulus * contact, met * 8 * shear * contact

    def _flattened(self, ratio: Vector, modulus: float, hard: float, depth: Vector) -> Vector:
        """Return forces beyond yielding (Ghaednia et al., J. Tribology 141 (2019))."""
        radius = self.radius
        elastic = np.sqrt(radius * depth)
        exponent = 0.14 * np.exp(23 * YIELD / (2 * modulus))
        limit = depth / ratio
        full = radius * hard / (2 * modulus) * np.sqrt(ratio * (ratio / 1.9) ** exponent)
        slope = np.sqrt(YOUNG / YIELD)
        soft = HARDENING / YOUNG
        way = -2 * slope * soft ** (1 - (depth - limit) / (4 * radius))
        way /= (4 - 3 * np.exp(-2 * slope * soft)) * (1 - soft)
        contact = elastic + (full - elastic) * np.exp(way)
        hardness = 2.84 - 0.92 * (1 - np.cos(np.pi * contact / (2 * radius)))
        first = 4 / 3 * (radius / modulus) ** 2 * (hard / 2) ** 3
        grown = 4 * hardness * np.pi * YIELD / hard * (1 - np.exp(-(ratio ** (5 / 9)) / 25)) * ratio
        return first * (np.exp(-0.25 * ratio ** (5 / 12)) * ratio**1.5 + grown)


def asperities(folder: Path) -> Asperities:
    """Read the density of asperities."""
    data = loadmat(folder / "brb_surface_data.mat")
    shares = np.linspace(0, 1, 101)
    weights = np.full(101, 0.01)
    weights[[0, -1]] /= 2
    density = np.interp(shares, data["normzinterp"][0], data["pzinterp"][0])
    return Asperities(
        radius=float(data["Re"][0, 0]),
        gaps=shares * data["z_max"][0, 0],
        numbers=data["area_density"][0, 0] * weights * density,
    )


def deck(
    folder: Path, spring: float = SPRING, elastic: str = f"{YOUNG}, {POISSON}", bolt: float = BOLT
) -> Path:
    """Write the deck with forces of the bolts in place of the steps of its substructure."""
    text = (folder / "Job.inp").read_text().split("** STEP: Fixed-Int-Modal")[0]
    text = re.sub(r"(\*Elastic\n).*", rf"\g<1>{elastic}", text)
    springs, loads = [], []
    for number, (end, nut) in enumerate(ENDS, 1):
        springs += [
            f"*ELEMENT, TYPE=SPRING2, ELSET=END{number}",
            f"{900000 + number}, {end}, {nut}",
        ]
        springs += [f"*SPRING, ELSET=END{number}", "3, 3", f"{spring}"]
        loads += [f"{end}, 3, {bolt}", f"{nut}, 3, {-bolt}"]
    start = text.index("** Constraint: BNEQ1-1")
    steps = ["*STEP", "*STATIC", "*CLOAD", *loads, "*END STEP", ""]
    path = folder / "full_beam.inp"
    path.write_text(text[:start] + "\n".join([*springs, ""]) + text[start:] + "\n".join(steps))
    return path


def joint(path: Path) -> fy.Model:
    """Build the beam; loads of step 1 are the forces of its bolts."""
    model = fy.read_abaqus(
        path,
        interfaces=[
            fy.InterfaceSpec(
                name="lap", minus="BOTBEAM_INSURF", plus="TOPBEAM_INSURF", quadrature="nodal"
            )
        ],
        bolts=[],
        boundaries=[fy.BoundarySpec(name="sensor", set="OutNodes")],
    )
    return model.with_deck_loads("step 1")


@dataclass(frozen=True, eq=False)
class Rough(Coulomb):
    """Friction with a tangential stiffness of each point (n_point,), as asperities there have."""

    __hash__ = object.__hash__

    def __eq__(self, other: object) -> bool:
        return self is other

    def __post_init__(self) -> None:
        """Check nothing: tangential penalties are an array."""

    @property
    def yields(self) -> bool:
        """Whether the normal law does."""
        return self.normal.yields


def released(system: fy.Model, state: fy.Solution) -> fy.Solution:
    """Return a state without friction as one from which friction begins: its motion is slip."""
    contact = system.contact
    moved = path_start(system, state).increment.moved
    slip = np.zeros((1, 2, contact.n_points))
    slip[0][:, contact.rubbing] = (contact.shear @ moved).reshape(2, -1)
    return replace(state, shear_forces=np.zeros_like(slip), shear_slip=slip)


def lost(stiffness: Vector, limit: Vector, moved: Vector) -> Vector:
    """Return what springs that slip at a limit lose in a cycle of an amplitude."""
    slips = stiffness * moved > limit
    return np.where(slips, 4 * limit * (moved - limit / np.where(slips, stiffness, 1.0)), 0.0)


def damping_of_heights(grain: Asperities, law: fy.GasketClosure, state: fy.Solution) -> None:
    """Print damping of friction where points move as the stuck joint does, one spring each or many.

    Slip does not spread here, so that it holds for small amplitudes.
    """
    model, (lap,) = state.system, state.system.interfaces.values()
    modes = stuck_modes(model, state, 200.0, 1)
    circular, shape = 2 * np.pi * modes.frequencies[0], modes.shapes[:, 0]
    moved = np.hypot(
        *(model.contact.shear @ (model.contact.relative_operator @ shape)).reshape(2, -1)
    )
    closures = np.interp(np.atleast_2d(state.pressure)[-1], law.pressures, law.closures)
    for q in LEVELS:
        one = many = 0.0
        for weight, motion, closure in zip(lap.weights, q * moved, closures, strict=True):
            force, _, shear = grain.at_heights(closure)
            many += weight * lost(shear, FRICTION * force, motion).sum()
            one += weight * float(lost(shear.sum(), FRICTION * force.sum(), motion))
        ratios = [100 * work / (4 * np.pi * (circular * q) ** 2 / 2) for work in (one, many)]
        sys.stdout.write(f"{q:.2e}: one spring {ratios[0]:.3f} %, by heights {ratios[1]:.3f} %\n")


def compare(folder: Path, surface: str, way: str) -> None:
    """Print the backbone of one surface beside the reference."""
    grain = asperities(folder)
    closures = np.concatenate([np.linspace(0.6e-6, 2e-6, 5), np.linspace(3e-6, 30e-6, 28)])
    pressures, normal, shear = np.array([grain.at(closure) for closure in closures]).T
    law = fy.GasketClosure((grain.gaps[1], *closures), (0.0, *pressures), (normal[0], *normal))
    path = deck(folder)
    model = joint(path)
    (lap,) = model.interfaces.values()
    gap = np.zeros(lap.n_points)
    if surface == "meso":
        samples = loadmat(folder / "brb_surface_data.mat")["mesoscale_xygap"]
        samples = samples[np.isfinite(samples[:, 2])]
        scan = Scan(places=samples[:, :2], values=samples[:, 2], is_gap=True)
        on_lap = ScanPlacement(of="gap", origin=(0, 0, 0), along=(1, 0, 0), tilt="keep")
        found = topography(lap, [(scan, on_lap)])
        sys.stdout.write(f"{found.notes[0]}\n")
        gap = found.gap - found.gap.min()
    model = model.with_initial_gap("lap", gap).with_closure(law)
    state = fy.solve_path(model, [fy.Load({"step 1": part}) for part in (0.25, 0.5, 1.0)])
    pressed = np.atleast_2d(state.pressure)[-1]
    held = np.interp(pressed, (0.0, *pressures), (shear[0], *shear))
    if way == "alike":
        held[:] = lap.weights * held @ pressed / (lap.weights @ pressed)
    sys.stdout.write(
        f"{surface}: peak {pressed.max() / 1e6:.1f} MPa, {lap.weights @ pressed:.0f} N, "
        f"c_t {held.min():.2g} to {held.max():.2g} N/m³\n"
    )
    face = model.interfaces["lap"]
    rubbing = model.with_interfaces({"lap": face.with_law(Rough(face.law, FRICTION, held))})
    state = released(rubbing, state)
    if way == "heights":
        damping_of_heights(grain, law, replace(state, system=rubbing))
        return
    modes = stuck_modes(rubbing, state, 1300.0, 6)
    sys.stdout.write(f"{surface}: {modes.frequencies.round(2).tolist()} Hz for {MODES[surface]}\n")
    circular = 2 * np.pi * modes.frequencies[0]
    curve = fy.backbone(
        rubbing,
        1,
        [(circular * q) ** 2 / 2 for q in LEVELS],
        over="energy",
        initial=state,
        increments=24,
    )
    theirs = {
        line.split(" : ")[0]: np.array(eval(line.split(" : ")[1]))
        for line in (folder / f"brb_epmc_{surface}.yaml").read_text().splitlines()
    }
    reached, along = np.log(curve.modal_amplitude), np.log(theirs["modal_amplitude"])
    f = np.interp(reached, along, theirs["frequency_rad_per_s"]) / (2 * np.pi)
    zeta = np.interp(reached, along, theirs["damping_factor_frac_crit"])
    rows = ["| modal amplitude | f [Hz] | computed | ζ [%] | computed |", "|---|---|---|---|---|"]
    for n, q in enumerate(curve.modal_amplitude):
        ours, loss = curve.frequency[n], curve.friction_damping[n] + LINEAR
        rows.append(
            f"| {q:.2e} | {f[n]:.2f} | {ours:.2f} ({100 * (ours / f[n] - 1):+.1f} %) "
            f"| {100 * zeta[n]:.2f} | {100 * loss:.2f} ({100 * (loss / zeta[n] - 1):+.0f} %) |"
        )
    sys.stdout.write("\n".join([*rows, ""]))
    sys.stdout.flush()


def without_contact(folder: Path) -> None:
    """Print elastic modes of the open lap, the first on springs at the bolts, and the reference."""
    model = joint(deck(folder, SOFT)).with_friction(FRICTION)
    state = fy.solve_path(model, [fy.Load({"step 1": 1.0})])
    parted = replace(state, contact_forces=np.zeros_like(state.contact_forces))
    modes = fy.preloaded_frequencies(model, 7, state=parted)
    sys.stdout.write(f"open: {modes.round(2).tolist()} Hz for {FREE}\n")


if __name__ == "__main__":
    for name in sys.argv[2:] or ("open", "flat", "meso"):
        if name == "open":
            without_contact(Path(sys.argv[1]))
            continue
        surface, _, way = name.partition("-")
        compare(Path(sys.argv[1]), surface, way)
