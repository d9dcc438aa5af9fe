"""Where to the bodies of an assembly move when it is taken apart at its interfaces."""

from collections.abc import Mapping

import numpy as np

from faying._typing import Indices, Matrix
from faying.interface.surface import ContactSurface


def explosion(interfaces: Mapping[str, ContactSurface], body: Indices) -> Matrix:
    """Return a direction to move each body in, so that every interface opens by one.

    Parameters
    ----------
    body : (n_node,)
        Number of the body a node belongs to, -1 where none.

    Returns
    -------
    (n_body, 3)
        Least squares over the interfaces, the bodies at rest in the mean. An interface whose
        normals cancel, or that touches one body only, opens nothing.
    """
    n_body = int(body.max(initial=-1)) + 1
    rows, directions = [], []
    for record in interfaces.values():
        total = float(record.weights.sum())
        if not len(record.pairs) or total <= 0:
            continue
        normal = record.weights @ record.normals / total
        minus, plus = (int(np.bincount(body[side] + 1).argmax()) - 1 for side in record.pairs.T)
        # Where normals cancel an interface closes on itself, like a pin in its hole.
        if minus == plus or min(minus, plus) < 0 or np.linalg.norm(normal) < 0.1:
            continue
        row = np.zeros(n_body)
        row[[minus, plus]] = -1.0, 1.0
        rows.append(row)
        directions.append(normal / np.linalg.norm(normal))
    if not rows:
        return np.zeros((n_body, 3))
    # Of all solutions the shortest: every connected group of bodies keeps its mean place.
    moves: Matrix = np.linalg.lstsq(np.array(rows), np.array(directions), rcond=None)[0]
    return moves
