"""The variables of interfaces: parameters of their laws, what they carry, and fields at points."""

from collections.abc import Iterator

import numpy as np

from faying.contact.laws import Coulomb, Law
from faying.contact.laws.coulomb import LARGEST_FRICTION
from faying.export.fmu import quantities
from faying.export.fmu.variable import Kind, Variable
from faying.reduction.reduced_model import ReducedModel


def law_parameters(rom: ReducedModel) -> Iterator[Variable]:
    """Yield coefficients and stiffnesses, as far as they are finite."""
    for index, name in enumerate(rom.contact.slices):
        yield from _of_law(name, index, rom.contact.laws[name])


def _of_law(name: str, index: int, law: Law) -> Iterator[Variable]:
    stiffnesses = [(Kind.PENALTY, "penalty", "contact", law.penalty)]
    if isinstance(law, Coulomb):
        yield Variable(
            name=f"{name}.friction",
            kind=Kind.FRICTION,
            index=index,
            causality="parameter",
            start=law.friction,
            limits=(0.0, LARGEST_FRICTION),
            description=f"coefficient of friction of interface {name}",
        )
        sticking = (Kind.TANGENTIAL_PENALTY, "tangential_penalty", "tangential")
        stiffnesses.append((*sticking, law.tangential_penalty))
    for kind, label, meaning, value in stiffnesses:
        if np.isfinite(value):
            yield Variable(
                name=f"{name}.{label}",
                kind=kind,
                index=index,
                causality="parameter",
                quantity=quantities.STIFFNESS,
                start=value,
                limits=(0.0, None),
                description=f"{meaning} stiffness of interface {name}",
            )


def interface_outputs(rom: ReducedModel) -> Iterator[Variable]:
    """Yield forces, largest stresses and shares of area; of friction where there is some."""
    smooth = (
        (Kind.CONTACT_FORCE, "contact_force", quantities.FORCE, "normal force through"),
        (Kind.MAX_PRESSURE, "max_pressure", quantities.PRESSURE, "largest contact pressure in"),
        (
            Kind.OPEN_FRACTION,
            "open_fraction",
            quantities.NONE,
            "part of the area without pressure of",
        ),
    )
    frictional = (
        (
            Kind.MAX_TRACTION,
            "max_traction",
            quantities.PRESSURE,
            "largest tangential traction in",
        ),
        (Kind.STICK_FRACTION, "stick_fraction", quantities.NONE, "part of the area that sticks of"),
        (
            Kind.SLIP_FRACTION,
            "slip_fraction",
            quantities.NONE,
            "part of the area that slipped in the last internal step of",
        ),
        (
            Kind.DISSIPATED_ENERGY,
            "dissipated_energy",
            quantities.ENERGY,
            "energy that friction took since initialization in",
        ),
    )
    for kind, label, quantity, text in (*smooth, *frictional):
        for index, name in enumerate(rom.contact.slices):
            if kind >= Kind.MAX_TRACTION and not _rubs(rom, name):
                continue
            yield Variable(
                name=f"{name}.{label}",
                kind=kind,
                index=index,
                causality="output",
                quantity=quantity,
                description=f"{text} interface {name}",
            )


def _rubs(rom: ReducedModel, interface: str) -> bool:
    return rom.contact.laws[interface].components > 1


def fields(rom: ReducedModel) -> Iterator[Variable]:
    """Yield pressures, and tractions where there is friction, as arrays over contact points."""
    families = (
        (Kind.PRESSURE, "pressure", "contact pressure"),
        (Kind.TRACTION, "traction", "length of the tangential traction"),
    )
    for kind, label, text in families:
        for index, (name, points) in enumerate(rom.contact.slices.items()):
            count = points.stop - points.start
            if count and (kind == Kind.PRESSURE or _rubs(rom, name)):
                yield Variable(
                    name=f"{name}.{label}",
                    kind=kind,
                    index=index,
                    causality="output",
                    quantity=quantities.PRESSURE,
                    size=count,
                    description=f"{text} at the points of interface {name}",
                )
