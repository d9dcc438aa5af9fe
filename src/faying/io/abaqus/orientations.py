"""``*ORIENTATION``: directions of materials and couplings, the same everywhere in a set."""

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.digits import SOLVED
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import integer, padded, real
from faying.io.abaqus.keyword import Keyword, named
from faying.io.abaqus.sets import NamedSets
from faying.model.axes import axes_along


def distributed_axes(
    deck: Deck, keyword: Keyword, sets: NamedSets
) -> tuple[Matrix, list[tuple[Indices, Matrix]]]:
    """Return the axes (3, 3) that the ORIENTATION of a keyword names, as rows in the basic frame.

    Also returned are the ids of elements with others by a *DISTRIBUTION, and those.
    """
    orientation = _find(deck, keyword)
    rows = orientation.rows()
    name = rows[0][0].upper() if rows and len(rows[0]) == 1 else ""
    tables = [k for k in deck.of("DISTRIBUTION") if k.value("NAME").upper() == name]
    if not name or not tables:
        return _axes(orientation), []
    default, *others = tables[-1].rows()
    if len(rows) > 1 or not default or default[0]:
        tables[-1].refuse(
            "expected a first line without an element, and no turn behind the distribution"
        )
    return _spanned(tables[-1], 0, default[1:]), [
        (sets.members(tables[-1], row[0], i), _spanned(tables[-1], i, row[1:]))
        for i, row in enumerate(others, start=1)
    ]


def orientation_at(deck: Deck, keyword: Keyword, points: Matrix) -> Matrix:
    """Return the axes (n, 3, 3) that the ORIENTATION of a keyword names at points (n, 3), as rows.

    Those of a cylindrical one are radial, tangential and axial.
    """
    orientation = _find(deck, keyword)
    if orientation.choice("SYSTEM") not in ("C", "CYLINDRICAL"):
        return np.broadcast_to(_axes(orientation), (len(points), 3, 3))
    orientation.check()
    rows = orientation.rows()
    if not rows or not 5 <= len(rows[0]) <= 6:
        orientation.refuse("expected a line with the coordinates of two points of the axis")
    values = padded(orientation, 0, rows[0], 6, "a coordinate")
    axis = values[3:] - values[:3]
    length = float(np.linalg.norm(axis))
    if not length > 0:
        orientation.refuse("the two points of the axis coincide", 0)
    axis = axis / length
    arms = points - values[:3]
    radial = arms - np.outer(arms @ axis, axis)
    lengths = np.linalg.norm(radial, axis=1)
    on_axis = lengths <= SOLVED * np.abs(points).max(initial=0.0)
    if on_axis.any():
        radial[on_axis] = _across(axis)
        lengths[on_axis] = 1.0
        deck.ignored.append(
            f"{int(on_axis.sum())} nodes on the axis of *ORIENTATION {orientation.value('NAME')}: "
            "any direction across it is radial there; the one of CalculiX is taken"
        )
    radial = radial / lengths[:, None]
    return np.stack([radial, np.cross(axis, radial), np.broadcast_to(axis, radial.shape)], axis=1)


def _across(axis: Vector) -> Vector:
    """Return the direction across an axis that CalculiX takes for radial on it."""
    if abs(axis[0]) > SOLVED:
        radial = np.array([-axis[1] / axis[0], 1.0, 0.0])
    elif abs(axis[1]) > SOLVED:
        radial = np.array([0.0, -axis[2] / axis[1], 1.0])
    else:
        radial = np.array([1.0, 0.0, 0.0])
    return np.asarray(radial / np.linalg.norm(radial))


def _find(deck: Deck, keyword: Keyword) -> Keyword:
    orientations = {k.value("NAME").upper(): k for k in deck.of("ORIENTATION")}
    return named(keyword, keyword.value("ORIENTATION"), orientations, "orientation")


def _axes(keyword: Keyword) -> Matrix:
    keyword.check()
    if keyword.choice("SYSTEM") not in ("R", "RECTANGULAR"):
        keyword.refuse(f"SYSTEM={keyword.choice('SYSTEM')} is not supported; RECTANGULAR is")
    rows = keyword.rows()
    if not 1 <= len(rows) <= 2 or not 6 <= len(rows[0]) <= 9:
        keyword.refuse(
            "expected a line with the coordinates of points a and b, and one with a turn"
        )
    axes = _spanned(keyword, 0, rows[0])
    return axes if len(rows) == 1 else _turned(keyword, rows[1], axes)


def _spanned(keyword: Keyword, row: int, fields: list[str]) -> Matrix:
    """Return the axes (3, 3) of points a and b, and an origin behind them."""
    values = padded(keyword, row, fields, 9, "a coordinate")
    axes = axes_along(values[:3] - values[6:], values[3:6] - values[6:])
    if axes is None:
        keyword.refuse("points a and b lie on one line with the origin; they must span a plane")
    return axes


def _turned(keyword: Keyword, row: list[str], axes: Matrix) -> Matrix:
    """Turn two of the axes about the third."""
    about = integer(keyword, 1, row[0], "an axis 1, 2 or 3") - 1
    if len(row) != 2 or about not in (0, 1, 2):
        keyword.refuse("expected an axis, 1, 2 or 3, and an angle in degrees", 1)
    angle = np.radians(real(keyword, 1, row[1], "an angle"))
    j, k = (about + 1) % 3, (about + 2) % 3
    result = axes.copy()
    result[j] = np.cos(angle) * axes[j] + np.sin(angle) * axes[k]
    result[k] = np.cos(angle) * axes[k] - np.sin(angle) * axes[j]
    return result
