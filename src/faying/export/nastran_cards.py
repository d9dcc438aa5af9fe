"""Bulk data of an external superelement: what the assembly run includes, and what comes after."""

from collections.abc import Mapping, Sequence

from faying._typing import Indices
from faying.io.nastran.layout import Value, large, small

Places = Mapping[int, Sequence[float]]
"""Grid id to its coordinates in the basic system."""


def assembly_cards(
    title: str, superelement: int, grids: Mapping[int, str], places: Places, points: Indices
) -> str:
    """Return the cards (.asm) for the main bulk data of the assembly run.

    Parameters
    ----------
    grids
        Grid id to its components.
    points : (n,)
        Ids of the scalar points, consecutive.
    """
    pairs: list[Value] = [grid for repeated in grids for grid in (repeated, repeated)]
    # The pairs of equal ids begin on the second line.
    connected: list[Value] = [superelement, 0, None, "NO", None, None, None, None, *pairs]
    cards = [
        f"$ {title}",
        "$ Include in the main bulk data of the assembly run.",
        small("SEBULK", [superelement, "EXTOP4", None, "MANUAL", None, None, superelement]),
        small("SECONCT", connected),
    ]
    if len(points):
        same: list[Value] = _run(points) * 2
        cards.append(small("SECONCT", [superelement, 0, None, "NO", None, None, None, None, *same]))
    return "\n".join(cards) + "\n" + grid_cards(places) + scalar_points(points)


def punch_cards(
    title: str, superelement: int, grids: Mapping[int, str], places: Places, points: Indices
) -> str:
    """Return the section (.pch) for the end of the deck of the assembly run."""
    outer = [value for grid, components in grids.items() for value in (grid, components)]
    inner = [value for point in points.tolist() for value in (point, 0)]
    cards = [
        f"$ {title}",
        "$ Include at the very end of the assembly run, after all other bulk data.",
        f"BEGIN SUPER{superelement:9}",
        small("EXTRN", [*outer, *inner]),
        *(small("ASET", outer[i : i + 8]) for i in range(0, len(outer), 8)),
    ]
    if len(points):
        cards.append(small("QSET1", [0, *_run(points)]))
    return "\n".join(cards) + "\n" + grid_cards(places) + scalar_points(points)


def grid_cards(places: Places) -> str:
    """Return GRID cards in sixteen columns."""
    return "".join(f"{large('GRID', [grid, 0, *xyz])}\n" for grid, xyz in places.items())


def scalar_points(points: Indices) -> str:
    """Return the SPOINT card of consecutive points; nothing where there are none."""
    return small("SPOINT", _run(points)) + "\n" if len(points) else ""


def _run(points: Indices) -> list[Value]:
    first, last = int(points[0]), int(points[-1])
    return [first, "THRU", last] if last > first else [first]
