"""MAT9, MAT11: materials of solids whose directions differ."""

from collections import ChainMap
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card
from faying.io.nastran.coordinates import Systems
from faying.io.nastran.layers import named_materials
from faying.model.assembly import Material
from faying.model.elastic_law import orthotropic_law, turned


def read_anisotropic(
    bulk: BulkData, named: frozenset[int], materials: Mapping[int, Material]
) -> dict[int, Material]:
    """Return the materials along their own axes by id.

    Those that no PSOLID names are left out with a note.
    """
    anisotropic: dict[int, Material] = {}
    for name, law, density in (("MAT9", _general, 22), ("MAT11", _orthotropic, 10)):
        defined = ChainMap(anisotropic, dict(materials))
        for number, card in named_materials(bulk, name, named, defined):
            try:
                anisotropic[number] = Material.anisotropic(
                    law(card), density=card.real(density, 0.0) * bulk.mass_factor, name=str(number)
                )
            except (ModelError, ValueError) as error:
                text = f"material {number}: {error}"
                raise card.error(text) from error
    return anisotropic


def along(card: Card, material: Material, systems: Systems) -> Material:
    """Turn a material to the coordinate system CORDM of its PSOLID."""
    number = card.integer(2, 0)
    if material.law is None or number == 0:
        return material
    if number < 0:
        card.refuse(
            "CORDM = -1, axes of each element, is not supported; give a rectangular system", 2
        )
    frame = systems.frame_of(card, 2)
    if frame.kind != "R":
        card.refuse(
            f"CORDM = {number} is not rectangular; only directions that stay are supported", 2
        )
    return replace(material, law=turned(material.law, np.asarray(frame.axes)))


def _general(card: Card) -> Matrix:
    law = np.zeros((6, 6))
    law[np.triu_indices(6)] = [card.real(j, 0.0) for j in range(1, 22)]
    return law + np.triu(law, 1).T


def _orthotropic(card: Card) -> Matrix:
    shear = np.array([card.real(7), card.real(9), card.real(8)])
    moduli, ratios = ([card.real(j) for j in places] for places in ((1, 2, 3), (4, 5, 6)))
    return orthotropic_law(moduli, ratios, shear)
