"""Choice of the number of joint modes for a tolerance, by certified errors."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Frozen, Indices, Vector
from faying.assessment.certificate import Measure, certifier
from faying.exceptions import refuse_model
from faying.joint.model import Model
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.projection import projected
from faying.simulation.load import Load
from faying.simulation.static import solve_static_cases


@dataclass(frozen=True, eq=False, kw_only=True)
class JointModeChoice(Frozen):
    """The number of joint modes for a tolerance.

    Attributes
    ----------
    count : [1]
        Chosen number of joint modes: the smallest certified number, or all if none is certified
        (``met``).
    met
        Whether the tolerance is certified.
    tolerance : [1]
        Given tolerance.
    measure
        Certified quantity.
    counts : (n,) [1]
        Tried numbers of joint modes.
    bounds : (n,) [1]
        Certified error of each, the largest over the loads.
    """

    count: int
    met: bool
    tolerance: float
    measure: Measure
    counts: Indices
    bounds: Vector


def choose_joint_modes(
    model: Model,
    basis: Basis,
    loads: Sequence[Load],
    tolerance: float,
    *,
    measure: Measure = "energy_error",
) -> JointModeChoice:
    """Return the smallest number of joint modes with a certified error within a tolerance.

    Parameters
    ----------
    model
        The full model; it is not solved.
    basis
        Basis with all available joint modes, e.g. from :func:`faying.jim_b`.
    loads
        Static loads, e.g. ``box.random_loads(model, 50, seed=0)``.
    tolerance
        As a fraction of the exact solution, in the measure.
    measure
        ``"energy_error"`` is bounded sharply; ``"max_relative_error"`` (of pressure) ten to a
        thousand times too high for stiff contact, so more modes than necessary may be chosen.

    Raises
    ------
    ModelError
        If there is no load or the tolerance is not positive.

    Notes
    -----
    Numbers are tried upwards, since errors need not fall with every mode. Each takes a projection
    and, per load, a reduced static solution and a certificate, some milliseconds each.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> loads = [fy.Load({"tip.Fz": -500.0}), fy.Load({"tip.Mx": 20e3})]
    >>> basis = fy.jim_a(joint, normal_modes=4, joint_modes=20)
    >>> choice = fy.choose_joint_modes(joint, basis, loads, 0.2)
    >>> choice.count, choice.met
    (9, True)
    """
    if not loads or not tolerance > 0:
        refuse_model(
            f"choosing joint modes needs at least one load (got {len(loads)}) and a positive "
            f"tolerance (got {tolerance:g})"
        )
    judge = certifier(model)
    counts, bounds = [], []
    for count in range(basis.count(ModeKind.JOINT) + 1):
        rom = projected(model, basis.with_joint_modes(count))
        cases = solve_static_cases(rom, loads)
        certificate = judge.certify_inputs(cases.inputs, cases.pressure)
        counts.append(count)
        bounds.append(float(certificate.bound(measure).max()))
        if bounds[-1] <= tolerance:
            break
    return JointModeChoice(
        count=counts[-1],
        met=bounds[-1] <= tolerance,
        tolerance=tolerance,
        measure=measure,
        counts=np.array(counts),
        bounds=np.array(bounds),
    )
