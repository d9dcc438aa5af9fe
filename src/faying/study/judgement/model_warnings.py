"""Warnings about a joint: missing contact, free motion, and data implausible in its units."""

from collections.abc import Iterator, Mapping

import numpy as np

from faying.assessment.case_metrics import weak_warnings
from faying.digits import DECK_DIGITS
from faying.display.facts import WORTH_SAYING
from faying.display.quantities import percent, quantity
from faying.interface.selection import WHOLE_AREA
from faying.joint.diagnosis import AS_A_WHOLE, suspension
from faying.joint.model import Model
from faying.model.assembly import Material
from faying.model.generated_bolt import seat_offset
from faying.model.specs import BoltSpec
from faying.study.inputs.load_model import LoadedModel
from faying.study.keys.tables import Study
from faying.study.keys.threads import StudyBolts
from faying.study.results.values import CaseResult, Results
from faying.units import LENGTHS, MASSES, pascals, units_of


def kept_share(area: float, declared_area: float | None) -> float | None:
    """Return the share of the declared area that is paired; None where none was declared."""
    return None if not declared_area else min(area / declared_area, 1.0)


def missing_contact(name: str, area: float, declared_area: float | None) -> str:
    """Return a warning about the unpaired part of an interface; empty if all is paired."""
    share = kept_share(area, declared_area)
    if share is None or share >= WHOLE_AREA:
        return ""
    return (
        f"interface '{name}': {share:.0%} of the declared contact area is paired ({area:.6g} of "
        f"{declared_area:.6g}, the smaller side); the rest has no face opposite it along "
        "its normal, or lies beyond the search distance"
    )


def missing_contacts(results: Results) -> list[str]:
    """Return warnings about unpaired parts of the interfaces of a run."""
    said = (
        missing_contact(name, float(face.weights.sum()), face.declared_area)
        for name, face in results.interfaces.items()
    )
    return [text for text in said if text]


def unheld(model: Model) -> list[str]:
    """Return warnings that a joint can move as a whole, or swings on soft springs."""
    count, swings = model.rigid_motions.shape[1], suspension(model)
    return [*([AS_A_WHOLE.format(count=count)] if count else []), *([swings] if swings else [])]


def overlapping(model: Model) -> list[str]:
    """Return warnings of surfaces that overlap before any load, as with a tilted scan."""
    unit, said = units_of(model.units).length, []
    for name, interface in model.interfaces.items():
        gap, size = interface.initial_gap, float(np.ptp(interface.points, axis=0).max(initial=0.0))
        inside = gap < -DECK_DIGITS * size
        if inside.any():
            share = float(interface.weights[inside].sum() / interface.weights.sum())
            said.append(
                f"surfaces of interface '{name}' overlap by up to {quantity(-gap.min(), unit)} on "
                f"{percent(share)} of its area before any load: they press each other apart "
                "without bolts, as in a press fit"
            )
    return said


def unmeasured(study: Study, cases: Mapping[str, CaseResult]) -> list[str]:
    """Return warnings about modes without motion where a backbone measures amplitudes."""
    said = []
    for case in study.load_cases:
        if case.kind == "backbone" and case.name in cases:
            curves = cases[case.name].reference.backbones
            still = [str(mode) for mode in sorted(case.modes) if str(mode) not in curves]
            if still:
                said.append(
                    f"load case '{case.name}': mode {', '.join(still)} is left out: no motion at "
                    f"'{case.at}', where its amplitude is measured"
                )
    return said


def barely_held(results: Results) -> list[str]:
    """Return warnings about load cases in which weak springs carry too much."""
    shares: dict[str, dict[str, float]] = {}
    for name, case in results.cases.items():
        for bodies, share in case.reference.weak_shares.items():
            shares.setdefault(bodies, {})[name] = float(np.max(share))
    return weak_warnings(shares)


MODULI = (1e4, 2e12)
"""Range of Young's moduli [Pa], from gels to above diamond (1.2e12)."""
DENSITIES = (1.0, 3e4)
"""Range of densities [kg/m³], from the lightest foams to above osmium (2.26e4)."""
LIGHTEST = 1e6
"""Young's modulus over density squared [Pa m⁶/kg²] that no solid exceeds: foams lose
stiffness with the square of their density (Gibson and Ashby, Cellular Solids, 1997, ch. 5), balsa
and honeycombs along their cells have the most, up to 6e5; diamond 1e5, steel 3e3."""
SOFT_AND_DENSE = (1e9, 3e3)
"""Young's modulus [Pa] below which, and density [kg/m³] above which, only metal-filled rubber
exists: the softest metals so dense, thallium and indium, have 8 and 11 GPa (CRC Handbook)."""
TIGHTENED = (1e6, 3e9)
"""Range of stress [Pa] in tightened bolts: a tenth of nylon's strength to above any steel's."""
COHESION = 0.1
"""Pressure over Young's modulus that exceeds the theoretical strength of every crystal
(J. Frenkel, Z. Phys. 37 (1926) 572: G/2π in shear, E/16; up to E/10 in tension)."""


def doubts(materials: Mapping[int, Material], units: str) -> Iterator[str]:
    """Yield warnings about implausible material constants; none if the units are unknown.

    A study in mm-t-s with Pa and kg/m³ would run, with results wrong by powers of ten.

    Examples
    --------
    >>> steel = Material(name="steel", youngs_modulus=2.1e11, poissons_ratio=0.3, density=7.85e-9)
    >>> list(doubts({1: steel}, "mm-t-s"))
    ["material 'steel': E = 2.1e+11 is 2.1e+17 Pa in mm-t-s, beyond any solid; check E and 'units'"]
    """
    pascal = pascals(units)
    if pascal is None:
        return
    length, mass, _ = units.split("-")
    density = MASSES[mass] / LENGTHS[length] ** 3
    reported = set()
    for material in materials.values():
        for name, value, factor, unit, (low, high) in (
            ("E", material.youngs_modulus, pascal, "Pa", MODULI),
            ("rho", material.density, density, "kg/m³", DENSITIES),
        ):
            if value and not low <= value * factor <= high:
                reported.add(
                    f"material '{material.name}': {name} = {value:g} is {value * factor:g} {unit} "
                    f"in {units}, beyond any solid; check {name} and 'units'"
                )
        stiff, heavy = material.youngs_modulus * pascal, material.density * density
        single = MODULI[0] <= stiff <= MODULI[1] and DENSITIES[0] <= heavy <= DENSITIES[1]
        together = {
            "stiff": stiff > LIGHTEST * heavy**2,
            "soft": stiff < SOFT_AND_DENSE[0] and heavy > SOFT_AND_DENSE[1],
        }
        reported.update(
            f"material '{material.name}': E is {stiff / 1e9:.3g} GPa and rho {heavy:.3g} kg/m³ "
            f"in {units}; no solid of that density is so {what}; check both and 'units'"
            for what, doubtful in together.items()
            if single and doubtful
        )
    yield from sorted(reported)


def bolt_doubts(study: Study, loaded: LoadedModel) -> Iterator[str]:
    """Yield warnings about implausible preloads of bolts with known section."""
    pascal = pascals(study.units)
    threads = StudyBolts.of(study).threads
    low, high = TIGHTENED
    for spec in loaded.bolts if pascal else ():
        force = loaded.preloads.get(spec.name, loaded.initial_forces.get(spec.name, 0.0))
        thread = threads.get(spec.name)
        area = _section(loaded, spec) if thread is None else np.pi / 4 * thread.diameter**2
        stress = 0.0 if not area else force / area * (pascal or 1.0)
        if stress and not low <= stress <= high:
            yield (
                f"bolt '{spec.name}': a preload of {force:g} {study.unit_set.force} on "
                f"{area:.4g} {study.unit_set.of('length²')} is {stress / 1e6:.3g} MPa, as "
                "of no tightened bolt; check it and 'units'"
            )


SEAT_LEVER = 0.28
"""Largest bending moment at rest over preload times mean distance of the nodes under a head from

Measured: 0.21 to 0.28 at 0.8 and 1.5 mm and 0.1 at 0.3 mm on a flange of eight M12 with 24 to 31
nodes under a head (``docs/judged_by_hand.md``); 0.04 at 0.6 mm on a lug of two M8 with 35.
"""


def uneven_seats(loaded: LoadedModel) -> Iterator[str]:
    """Yield a warning about bolts that unevenly placed nodes under head or nut may bend."""
    offsets = {
        spec.name: (seat_offset(loaded.assembly.mesh, spec), spec.diameter)
        for spec in loaded.bolts
        if spec.axis is not None and spec.diameter and spec.washer_radius
    }
    # σ_b/σ = (F k e / W) / (F / A) of a round bar.
    bent = {name: 8 * SEAT_LEVER * off / size for name, (off, size) in offsets.items()}
    # 0.02 to 0.03 is left on that flange with twice as many nodes around a hole.
    many = [name for name, share in bent.items() if share > WORTH_SAYING]
    if many:
        worst = max(many, key=bent.__getitem__)
        length = loaded.study.unit_set.length
        yield (
            f"nodes under head or nut of {', '.join(many)} are unevenly placed, on average up to "
            f"{offsets[worst][0]:.2g} {length} beside the axis ('{worst}'): the preload may bend "
            f"it by up to {bent[worst]:.0%} of its stress; refine around its hole until bending at "
            "rest no longer changes, unless the part ends there"
        )


def _section(loaded: LoadedModel, spec: BoltSpec) -> float | None:
    """Return the cross-sectional area of a bolt [length²]; None where it is unknown."""
    if spec.diameter is not None:
        return float(np.pi / 4 * spec.diameter**2)
    beams = [beam for beam in loaded.assembly.beams if beam.id in (spec.elements or ())]
    return beams[0].section.area if beams else None


def pressure_doubts(
    cases: Mapping[str, CaseResult], materials: Mapping[int, Material], units: str
) -> Iterator[str]:
    """Yield a warning about the largest contact pressure if no solid could bear it."""
    stiffest = max((entry.youngs_modulus for entry in materials.values()), default=0.0)
    peaks = {
        name: float(entry.reference.pressure.max(initial=0.0)) for name, entry in cases.items()
    }
    name = max(peaks, key=peaks.__getitem__, default="")
    if stiffest and peaks.get(name, 0.0) > COHESION * stiffest:
        unit = units_of(units).pressure
        yield (
            f"load case '{name}': the largest pressure is {peaks[name]:.3g} {unit}, "
            f"{peaks[name] / stiffest:.0%} of the largest Young's modulus; no solid bears "
            "that: check preloads, loads and 'units'"
        )
