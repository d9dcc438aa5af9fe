"""Generated bolts: a beam between two washers."""

from dataclasses import replace

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.digits import SHORT_DIGITS
from faying.exceptions import refuse_model
from faying.model.assembly import (
    Assembly,
    Beam,
    BeamSection,
    Material,
    PointMass,
)
from faying.model.axes import any_across, round_section
from faying.model.boundary import with_coupling
from faying.model.clamping import check_clamping
from faying.model.mesh import Mesh
from faying.model.specs import BoltSpec
from faying.model.surface import facet_normals

# A facet bears the washer if it faces along the axis within 25° and lies off the bearing plane by
# at most a fifth of the washer's radius: this includes slightly curved or inclined seats, but no
# hole walls.
_SMALLEST_COSINE = 0.9
_LARGEST_OFFSET = 0.2


def add_bolt(assembly: Assembly, spec: BoltSpec) -> Assembly:
    """Add a bolt: a beam along the axis, tied to the surface under its head and its nut.

    The beam is a round bar of the given diameter between the centres of the two bearing surfaces.
    Each washer couples the nodes of the outward-facing facets within the washer radius, rigidly
    (RBE2) or on average with equal weights (RBE3). The result has two more nodes, one beam, two
    couplings, and masses of head and nut if they have any; ids follow the largest ones in use.

    Raises
    ------
    ModelError
        If a dimension is missing or not positive, no node lies under a washer, or nothing is
        clamped because both washers are on one body with no other between them.

    Notes
    -----
    Cost: one pass over the facets of the mesh.
    """
    ends = _ends(spec)
    material = _material(assembly, spec)
    seats = _seats(assembly.mesh, spec, ends)
    check_clamping(assembly.mesh, spec, seats)
    n_node = len(assembly.mesh.nodes)
    mesh = assembly.mesh.with_nodes(ends)
    first_id = assembly.largest_id + 1
    beam = Beam(
        id=first_id,
        nodes=(n_node, n_node + 1),
        section=bolt_section(spec, material),
        material=material if spec.mass else replace(material, density=0.0),
        orientation=any_across(ends[1] - ends[0]),
    )
    fittings = tuple(
        PointMass(id=first_id + 3 + i, node=n_node + i, mass=mass)
        for i, mass in enumerate(spec.end_masses)
        if mass
    )
    result = replace(
        assembly,
        mesh=mesh,
        beams=(*assembly.beams, beam),
        masses=(*assembly.masses, *fittings),
    )
    for i, seat in enumerate(seats):
        result = with_coupling(result, spec.washer, first_id + 1 + i, n_node + i, seat)
    return result


def seat_offset(mesh: Mesh, spec: BoltSpec) -> float:
    """Return the mean offset from the axis of the nodes under head and nut [length].

    The larger of both. It is nearly zero for a seat of all the nodes around a hole.

    Raises
    ------
    ModelError
        As :func:`add_bolt`.
    """
    ends = _ends(spec)
    axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    seats = zip(_seats(mesh, spec, ends), ends, strict=True)
    beside = [np.cross(mesh.nodes[seat].mean(axis=0) - end, axis) for seat, end in seats]
    return float(np.linalg.norm(beside, axis=1).max())


def bolt_section(spec: BoltSpec, material: Material) -> BeamSection:
    """Return the section of a solid round bolt."""
    section = round_section((spec.diameter or 0.0) / 2, 0.0, material.poissons_ratio)
    if spec.shear_flexible:
        return section
    return replace(section, shear_factor_y=np.inf, shear_factor_z=np.inf)


def _ends(spec: BoltSpec) -> Matrix:
    """Return the ends of the axis (2, 3), after a check of all dimensions."""
    measures = {"diameter": spec.diameter, "washer_radius": spec.washer_radius}
    for name, value in measures.items():
        if value is None or not value > 0:
            refuse_model(f"bolt '{spec.name}': {name} is {value}; give a positive length")
    if spec.washer not in ("rbe2", "rbe3"):
        refuse_model(f"bolt '{spec.name}': washer is '{spec.washer}'; give 'rbe2' or 'rbe3'")
    ends = np.asarray(spec.axis if spec.axis is not None else [], dtype=float)
    if ends.shape != (2, 3) or not np.linalg.norm(ends[1] - ends[0]) > 0:
        refuse_model(
            f"bolt '{spec.name}': axis is {spec.axis}; give two different points "
            "((x, y, z), (x, y, z)), the centres of the bearing surfaces"
        )
    return ends


def _material(assembly: Assembly, spec: BoltSpec) -> Material:
    """Return the bolt's material by property id or name; by default the first solid's."""
    choice = spec.material
    if choice is None and assembly.mesh.n_elements:
        choice = int(assembly.mesh.element_properties[0])
    by_name = {material.name: material for material in assembly.materials.values()}
    chosen = by_name.get(choice) if isinstance(choice, str) else None
    if isinstance(choice, int):
        chosen = assembly.materials.get(choice)
    if chosen is None:
        choices = ", ".join(f"{i} ('{m.name}')" for i, m in assembly.materials.items()) or "none"
        refuse_model(
            f"bolt '{spec.name}': there is no material '{choice}'; give a property id or a "
            f"material name; known: {choices}"
        )
    return chosen


def _seats(mesh: Mesh, spec: BoltSpec, ends: Matrix) -> tuple[Indices, Indices]:
    """Return the nodes under the two washers."""
    axis = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    cosines = facet_normals(mesh.nodes, mesh.exterior) @ axis
    first, second = (
        _seat(mesh, spec, towards * cosines, end, towards * axis)
        for end, towards in ((ends[0], -1.0), (ends[1], 1.0))
    )
    return first, second


def _seat(mesh: Mesh, spec: BoltSpec, cosines: Vector, end: Vector, outward: Vector) -> Indices:
    """Return the nodes within the washer radius of the axis, near the bearing plane at ``end``.

    From facets that face outward along the axis, by cosines (n_facet,) of their normals.
    """
    radius, labels, facets = spec.washer_radius or 0.0, mesh.bodies, mesh.exterior.nodes
    chosen = np.unique(facets[cosines >= _SMALLEST_COSINE])
    nodes: Indices = chosen[chosen >= 0]
    from_end = mesh.nodes[nodes] - end
    offset = np.abs(from_end @ outward)
    radial = np.linalg.norm(from_end - np.outer(from_end @ outward, outward), axis=1)
    in_plane = offset <= _LARGEST_OFFSET * radius
    under = in_plane & (radial <= radius * (1 + 1e-9))
    if not under.any():
        position = "({:g}, {:g}, {:g})".format(*end)
        if in_plane.any():
            hint = (
                f"the nearest node of that surface is {radial[in_plane].min():.4g} from the axis; "
                "enlarge the washer or refine the mesh"
            )
        elif _are_inclined(cosines[_facets_within(mesh, end, radius)]):
            hint = "the surfaces there lie askew of the axis; turn it onto the normal of its seat"
        else:
            hint = "no surface lies there; move the end of the axis to the centre of the surface"
        refuse_model(
            f"bolt '{spec.name}': no node lies under the washer of radius {radius:g} at {position}"
            f"; {hint}"
        )
    nodes, offset = nodes[under], offset[under]
    closest = np.full(labels.max() + 1, np.inf)
    np.minimum.at(closest, labels[nodes], offset)
    # Seats of other bodies, as the next sheet of a thin stack, are farther away than round-off.
    closest_plane: Mask = closest <= closest.min() + SHORT_DIGITS * radius
    return nodes[closest_plane[labels[nodes]]]


def _facets_within(mesh: Mesh, centre: Vector, radius: float) -> Mask:
    """Return the exterior facets (n_facet,) with a node within a radius [length] of a point."""
    facets = mesh.exterior.nodes
    distances = np.linalg.norm(mesh.nodes - centre, axis=1)
    within = (facets >= 0) & (distances[facets] <= radius)
    return np.asarray(within.any(axis=1))


def _are_inclined(cosines: Vector) -> bool:
    """Return whether facets are inclined: none faces along the axis, and not all are hole walls."""
    return bool(len(cosines)) and 1 - _SMALLEST_COSINE < cosines.max() < _SMALLEST_COSINE
