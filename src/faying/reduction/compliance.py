"""Interface compliance of a model: gap per contact force."""

from faying._typing import Matrix
from faying.joint.model import Model
from faying.linalg.factorization import Factorization
from faying.linalg.partial import port_compliance


def interface_compliance(model: Model, factor: Factorization | None = None) -> Matrix:
    """Return S = G K⁻¹ Gᵀ (n_point, n_point) [length/force], (M1).

    Column k is how far every contact point opens under a unit force at point k.

    Parameters
    ----------
    model
        It must be held without contact.
    factor
        Factorization of ``model.K``; by default the one the model keeps.

    Notes
    -----
    One back-substitution per pair of nodes (three where an interface is curved), not per contact
    point, in blocks of bounded memory.

    Examples
    --------
    >>> import faying as fy
    >>> S = fy.interface_compliance(fy.lap_joint(element_size=5.0))
    >>> S.shape, bool(abs(S - S.T).max() < 1e-9 * S.max())
    ((112, 112), True)
    """
    if factor is None:
        relative = model.port_compliance.relative
    else:
        relative = port_compliance(model.contact.relative_operator, factor)
    return model.contact.at_points(relative)
