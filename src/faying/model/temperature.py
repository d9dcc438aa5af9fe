"""Temperatures of the parts of a structure, and the forces of their change."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from faying._typing import Matrix, Vector
from faying.exceptions import refuse_model
from faying.model.assembly import Assembly, Material
from faying.model.body_forces import FreeStrain, expansion_forces, stretching_forces
from faying.model.parts import elements_named


@dataclass(frozen=True, kw_only=True)
class Temperature:
    """Temperatures of the parts of a joint, uniform in each part.

    Attributes
    ----------
    reference
        Temperature of all parts during assembly and tightening.
    uniform
        Temperature of all parts not in ``parts``; the reference if None.
    parts
        Bodies, element sets, property ids or bolts to their temperatures.

    Examples
    --------
    >>> import faying as fy
    >>> fy.Temperature(reference=20.0, parts={"bolt": 120.0}).parts["bolt"]
    120.0
    """

    reference: float
    uniform: float | None = None
    parts: Mapping[str | int, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        temperatures = (self.reference, self.uniform or 0.0, *self.parts.values())
        if not np.isfinite(temperatures).all():
            refuse_model(f"a temperature of {temperatures} is not finite; give numbers")


def expansion_of(
    assembly: Assembly, temperature: Temperature, bolts: Mapping[str, Collection[int]]
) -> tuple[Matrix, Vector]:
    """Return forces (n_node, 6) and free strains of beams (n_beam,) of temperatures of the parts.

    Free strains are α ΔT in all directions in solids, and along beams. Rigid couplings, springs and
    bushes keep their lengths. Bolts are names to the ids of their beams.

    Notes
    -----
    Linear in the number of elements.
    """
    if assembly.matrices is not None:
        refuse_model(
            "given matrices do not tell what expands in them; take the deck or mesh they are of, "
            "or give the forces of the expansion as loads"
        )
    beams = np.array([beam.id for beam in assembly.beams], dtype=np.int64)
    shells = [block.ids for block in assembly.shells]
    ids = np.concatenate([assembly.mesh.element_ids, beams, *shells])
    changes = _temperature_changes(assembly, temperature, bolts, ids)
    n_solid, n_line = assembly.mesh.n_elements, assembly.mesh.n_elements + len(beams)
    if changes[n_line:].any():
        number = int(ids[n_line:][np.flatnonzero(changes[n_line:])[0]])
        refuse_model(
            f"shell {number} would expand, and shells do not here; name the parts that do, without "
            "'uniform'"
        )
    strains = np.array(
        [
            change and _coefficient(beam.material) * change
            for beam, change in zip(assembly.beams, changes[n_solid:n_line].tolist(), strict=True)
        ]
    )
    solids = _solid_forces(assembly, changes[:n_solid])
    return solids + stretching_forces(assembly, strains), strains


def _temperature_changes(
    assembly: Assembly,
    temperature: Temperature,
    bolts: Mapping[str, Collection[int]],
    ids: Vector,
) -> Vector:
    """Return the changes of temperature (n,) of elements."""
    elsewhere = temperature.reference if temperature.uniform is None else temperature.uniform
    values, named = np.full(len(ids), elsewhere), np.zeros(len(ids), dtype=bool)
    for name, value in temperature.parts.items():
        if isinstance(name, str) and name in bolts:
            chosen = np.isin(ids, list(bolts[name]))
            if not chosen.any():
                refuse_model(f"bolt '{name}' has no beams; name the solids that it is made of")
        else:
            chosen = np.isin(ids, elements_named(assembly, [name], "the parts of the temperature"))
        twice = chosen & named & (values != value)
        if twice.any():
            repeated = int(np.flatnonzero(twice)[0])
            refuse_model(
                f"element {ids[repeated]} of '{name}' has the temperatures {values[repeated]:g} "
                f"and {value:g}; "
                "let each part have one"
            )
        values[chosen], named[chosen] = value, True
    return values - temperature.reference


def _solid_forces(assembly: Assembly, changes: Vector) -> Matrix:
    """Return the forces (n_node, 6) for changes of temperature (n_solid,)."""
    blocks, start = [], 0
    materials: dict[int, Material] = {}
    strains: dict[int, FreeStrain] = {}
    for block in assembly.mesh.blocks:
        warmer = changes[start : start + len(block.ids)]
        start += len(block.ids)
        kinds, which = np.unique(
            np.column_stack([block.properties, warmer]), axis=0, return_inverse=True
        )
        first = len(materials)
        blocks.append(replace(block, properties=first + which.ravel()))
        for number, (of_property, change) in enumerate(kinds.tolist(), first):
            materials[number] = material = assembly.materials[int(of_property)]
            if change:
                strains[number] = partial(np.multiply, _coefficient(material) * change)
    divided = replace(
        assembly, materials=materials, mesh=replace(assembly.mesh, blocks=tuple(blocks))
    )
    cold, warm = np.zeros(len(assembly.mesh.nodes)), np.ones(len(assembly.mesh.nodes))
    return expansion_forces(divided, strains, cold, warm)


def _coefficient(material: Material) -> float:
    if material.expansion is None:
        refuse_model(
            f"material '{material.name}' has no coefficient of expansion, and a part of it changes "
            "its temperature; give alpha in [material.NAME], or Material(expansion=...)"
        )
    return material.expansion
