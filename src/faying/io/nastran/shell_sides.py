"""BSURF of shells: the side of each shell that faces the other region of its contact pair."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from faying._typing import Indices, Matrix, Vector
from faying.digits import DECK_DIGITS
from faying.io.nastran.contact_pairs import Pair
from faying.io.nastran.regions import Region
from faying.model.assembly import Assembly
from faying.model.shells import ShellBlock
from faying.model.surface import WIDTH, facet_centres, facet_normals


def with_shell_sides(
    pairs: list[Pair],
    assembly: Assembly,
    thicknesses: Mapping[int, float],
    ignored: dict[str, None],
) -> tuple[list[Pair], dict[str, float]]:
    """Put faces in place of regions of shells, half a thickness of their property off their nodes.

    With the pairs comes, by name, what is added to the gap of their mesh [length].
    """
    paired, gaps = [], dict[str, float]()
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
        gaps[pair.name] = -height
        ignored[
            f"{pair.name}: shells touch on the sides that face the solids, {height:g} off their "
            "nodes, without the lever of the thickness in tangential motion"
        ] = None
        named = replace(region, name=f"{region.name} of {pair.name}", facets=sides)
        minus, plus = (named if side is region else side for side in (pair.minus, pair.plus))
        paired.append(replace(pair, minus=minus, plus=plus))
    return paired, gaps


def _faces(region: Region, assembly: Assembly) -> tuple[Matrix, Matrix]:
    """Return centres and outward normals (n, 3) of the faces of a region of solids."""
    faces = assembly.mesh.exterior
    if region.elements is not None:
        faces = faces.taken(np.isin(faces.elements, region.elements))
    elif region.facets is not None:
        named = {tuple(row) for row in np.sort(region.facets, axis=1).tolist()}
        rows = [tuple(row) in named for row in np.sort(faces.nodes, axis=1).tolist()]
        faces = faces.taken(np.array(rows))
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
        rows.append(_turned(block, chosen, along))
        thick = [thicknesses.get(int(p), np.nan) for p in block.properties[chosen]]
        heights.append(along * block.offsets[chosen] + np.array(thick) / 2)
    height = np.concatenate(heights)
    if not np.ptp(height) <= DECK_DIGITS * abs(height).max():
        region.card.refuse(
            "shells of a contact region have thicknesses or offsets that differ; part the region"
        )
    return np.concatenate(rows), float(height[0])


def _turned(block: ShellBlock, chosen: Indices, along: Vector) -> Indices:
    """Nodes (n, 8) of shells seen from the side they touch with, -1 behind the last."""
    count = block.nodes.shape[1]
    corners = 3 if count % 3 == 0 else 4
    middle = [*range(corners, count)][::-1]
    # Backwards from the last corner: the middle of the last two corners comes first.
    order = [*range(corners - 1, -1, -1), *middle[1:], *middle[:1]]
    nodes = block.nodes[chosen]
    facets = np.full((len(chosen), WIDTH), -1, dtype=np.int64)
    facets[:, :count] = np.where(along[:, None] < 0, nodes[:, order], nodes)
    return facets
