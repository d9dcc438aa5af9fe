"""Contact pairs of decks of MSC and Simcenter Nastran."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from faying._typing import Indices, Matrix, Vector
from faying.digits import DECK_DIGITS
from faying.exceptions import refuse
from faying.interface.gap_pairing import declared
from faying.io.element_faces import shell_facets
from faying.io.nastran.cards import Card
from faying.io.nastran.contact_parameters import Parameters, note_friction
from faying.io.nastran.regions import Region
from faying.model.assembly import Assembly
from faying.model.mesh import Mesh
from faying.model.specs import GapRule, InterfaceSpec
from faying.model.surface import Facets, corner_nodes, facet_centres, facet_normals, padded

DEFAULT_ERROR = 1 / 20
"""MSC's default contact tolerance over the smallest edge of solids."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Pair:
    """Two regions that may touch; ``minus`` is the source (secondary, slave) side.

    Attributes
    ----------
    where
        File and line of the card that defines the pair.
    parameters
        Parameters of its contact set, table or pair.
    offset : [length]
        Added to the gap of the mesh.
    """

    name: str
    minus: Region
    plus: Region
    where: str
    parameters: Parameters
    offset: float = 0.0

    @property
    def friction(self) -> float:
        """Coefficient of friction."""
        return self.parameters.friction or 0.0

    @property
    def glued(self) -> bool:
        """Whether the regions neither open nor slide."""
        return self.parameters.glued


def region_of(regions: dict[int, Region], card: Card, field: int) -> Region:
    """Return the region named in a field."""
    return card.find(regions, field, "contact region", "BSURFS, BSURF or BCPROP")


def check_distinct(pairs: list[Pair]) -> None:
    """Refuse a region in contact with itself, and the same two regions twice."""
    seen: dict[frozenset[str], Pair] = {}
    for pair in pairs:
        key = frozenset((pair.minus.name, pair.plus.name))
        if len(key) == 1:
            refuse(
                f"{pair.where}: region {pair.minus.name} is in contact with itself, which is not "
                "supported; give each side its own region"
            )
        if key in seen:
            refuse(
                f"{pair.where}: contact or glue between {pair.minus.name} and {pair.plus.name} is "
                f"already defined at {seen[key].where} and would count twice; remove one"
            )
        seen[key] = pair


def spec_of(pair: Pair, assembly: Assembly, ignored: dict[str, None]) -> InterfaceSpec:
    """Return a pair as an interface, its faces paired across the gaps between them.

    Bodies list no faces. Faces farther apart than the size of a face cannot meet at small
    displacements and are left out.
    """
    distance = pair.parameters.search_distance
    if pair.minus.facets is None and pair.plus.facets is None:
        distance = min(distance, float(_edges(pair.minus, assembly.mesh).mean()))
        ignored[
            f"faces of {pair.name} that lie farther apart than the size of a face, {distance:.3g}"
        ] = None
    spec = InterfaceSpec(
        name=pair.name,
        minus=pair.minus.name,
        plus=pair.plus.name,
        friction=pair.friction,
        search_distance=distance,
        gap=_gap_rule(pair, assembly.mesh),
    )
    if pair.friction > 0:
        note_friction(ignored)
    spec = declared(assembly, spec)
    if spec.meshes == "non-matching":
        ignored[f"meshes of {pair.name} do not match: coupled by projection"] = None
    return spec


def _gap_rule(pair: Pair, mesh: Mesh) -> GapRule | None:
    """Return the rule that shifts gaps of a pair, or closes them before the analysis, if any."""
    parameters = pair.parameters
    closed = [] if parameters.closed_up_to is None else [parameters.closed_up_to]
    if parameters.within_error:
        closed.append(parameters.error or DEFAULT_ERROR * _edges(pair.minus, mesh).min())
    if not closed and not pair.offset:
        return None
    return GapRule(closed_up_to=float(max(closed, default=-np.inf)), offset=pair.offset)


def glue_distance(pair: Pair, mesh: Mesh) -> float:
    """Return the largest distance of glued surfaces: SDIST of Simcenter, ERROR of MSC."""
    parameters = pair.parameters
    if np.isfinite(parameters.search_distance):
        return parameters.search_distance
    return float(parameters.error or DEFAULT_ERROR * _edges(pair.minus, mesh).min())


def _edges(region: Region, mesh: Mesh) -> Vector:
    """Return the edge lengths of the faces of a region or of its bodies."""
    nodes = _outside(region, mesh).corners
    if region.facets is not None:
        nodes = corner_nodes(region.facets)
    points = mesh.nodes[nodes]
    lengths = np.linalg.norm(np.roll(points, -1, axis=1) - points, axis=2)
    return np.asarray(lengths[lengths > 0])


def _outside(region: Region, mesh: Mesh) -> Facets:
    """Return the outer faces of a region's elements; of all elements if it lists none."""
    faces = mesh.exterior
    if region.elements is None:
        return faces
    return faces.taken(np.isin(faces.elements, region.elements))


def with_shell_sides(
    pairs: list[Pair],
    assembly: Assembly,
    thicknesses: Mapping[int, float],
    ignored: dict[str, None],
) -> list[Pair]:
    """Replace regions of shells by faces, half the property's thickness off their nodes."""
    paired = []
    for pair in pairs:
        thin = [side for side in (pair.minus, pair.plus) if side.shells is not None]
        if not thin:
            paired.append(pair)
            continue
        region, opposite = thin[0], pair.plus if thin[0] is pair.minus else pair.minus
        if len(thin) > 1 or pair.glued:
            region.card.refuse(
                "a contact region of shells may touch solids; contact with shells, and glue, is "
                "not supported: model one of the two by solids"
            )
        sides, height = _sides(region, _faces(opposite, assembly), assembly, thicknesses)
        ignored[
            f"{pair.name}: shells touch on the sides that face the solids, {height:g} off their "
            "nodes; tangential forces act without the lever arm of half the thickness"
        ] = None
        named = replace(region, name=f"{region.name} of {pair.name}", facets=sides)
        minus, plus = (named if side is region else side for side in (pair.minus, pair.plus))
        paired.append(replace(pair, minus=minus, plus=plus, offset=-height))
    return paired


def _faces(region: Region, assembly: Assembly) -> tuple[Matrix, Matrix]:
    """Return centres and outward normals (n, 3) of the faces of a region of solids."""
    faces = _outside(region, assembly.mesh)
    if region.facets is not None:
        positions = np.unique(faces.positions(region.facets))
        faces = faces.taken(positions[positions >= 0])
    nodes = assembly.mesh.nodes
    return facet_centres(nodes, faces), facet_normals(nodes, faces)


def _sides(
    region: Region,
    faces: tuple[Matrix, Matrix],
    assembly: Assembly,
    thicknesses: Mapping[int, float],
) -> tuple[Indices, float]:
    nodes, (centres, normals) = assembly.mesh.nodes, faces
    shells = np.empty(0) if region.shells is None else region.shells
    rows, heights = [], []
    for block in assembly.shells:
        chosen = np.flatnonzero(np.isin(block.ids, shells))
        if not len(chosen):
            continue
        corners = nodes[block.nodes[chosen, : 3 if block.kind.startswith("tri") else 4]]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        _, nearest = cKDTree(centres).query(corners.mean(axis=1))
        along = -np.sign(np.einsum("nd,nd->n", across, normals[nearest]))
        rows.append(padded(shell_facets(block, chosen, along < 0)))
        thick = [thicknesses.get(int(p), np.nan) for p in block.properties[chosen]]
        heights.append(along * block.offsets[chosen] + np.array(thick) / 2)
    height = np.concatenate(heights)
    if not np.ptp(height) <= DECK_DIGITS * abs(height).max():
        region.card.refuse(
            "shells of a contact region have different thicknesses or offsets; divide the region"
        )
    return np.concatenate(rows), float(height[0])
