"""Models whose parts change temperature."""

from dataclasses import replace

import numpy as np

from faying.joint.load_pattern import check_pattern_name, load_pattern
from faying.joint.model import Model
from faying.model.assembly import Beam, NodalLoads
from faying.model.deck_bolt import axial_stiffness, bolt_axis_element
from faying.model.specs import BoltSpec
from faying.model.temperature import Temperature, expansion_of


def with_temperature(model: Model, name: str, temperature: Temperature) -> Model:
    """Return a copy with the temperatures of its parts as a load pattern of the given name.

    An amplitude of one brings all parts from the reference to their temperatures, a fraction to a
    fraction of the change: ``Load({"hot": 1.0})``. Bolts that expand lose preload, and bolts gain
    it when members expand (T2).

    Parameters
    ----------
    name
        Name of the load pattern.
    temperature
        Temperatures of the parts.

    Raises
    ------
    ModelError
        If a part is not known, a material has no coefficient of expansion, nothing expands, or the
        name is that of a load on a boundary.

    Notes
    -----
    Rigid couplings keep their shape: under a rigid washer the seat does not expand; take ``"rbe3"``
    where that matters.

    Examples
    --------
    >>> import faying as fy
    >>> steel = fy.Material(
    ...     youngs_modulus=210e3, poissons_ratio=0.29, density=7.8e-9, expansion=12e-6
    ... )
    >>> joint = fy.lap_joint(element_size=5.0, material=steel)
    >>> hot = fy.Temperature(reference=20.0, parts={"bolt": 120.0})
    >>> joint = fy.preload(fy.with_temperature(joint, "hot", hot), {"bolt": 10e3})
    >>> bool(fy.solve_static(joint, fy.Load({"hot": 1.0})).bolt_force("bolt") < 10e3)
    True
    """
    check_pattern_name(name, model.boundaries)
    assembly, shanks = model.assembly, {}
    for bolt, tightened in model.bolts.items():
        shanks[bolt] = tightened.shank.elements if tightened.shank is not None else ()
    forces, free_strains = expansion_of(assembly, temperature, shanks)
    strains = {
        beam.id: strain for beam, strain in zip(assembly.beams, free_strains.tolist(), strict=True)
    }
    added = {}
    for bolt, elements in shanks.items():
        spec = BoltSpec(name=bolt, elements=elements)
        element = bolt_axis_element(assembly, spec)
        strain = strains.get(element.id, 0.0)
        if strain and isinstance(element, Beam):
            ends = assembly.mesh.nodes[list(element.nodes)]
            length = float(np.linalg.norm(ends[1] - ends[0]))
            added[bolt] = -axial_stiffness(assembly, element) * length * strain
    loaded = np.flatnonzero(forces.any(axis=1))
    nodal = NodalLoads(nodes=loaded, forces=forces[loaded])
    pattern = load_pattern(name, nodal, assembly, model.dofs)
    return replace(
        model,
        load_patterns={**model.load_patterns, name: replace(pattern, bolt_forces=added)},
    )
