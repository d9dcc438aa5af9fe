"""Responses to harmonic loads with friction and gaps, by harmonics of a few modes."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from faying._typing import Vector
from faying.assessment.forced_joint import FEWEST, ForcedJoint, linear_range
from faying.assessment.response_curve import FrequencyResponse, remarks_of
from faying.exceptions import ModelError
from faying.joint.system import System
from faying.linalg.threads import one_thread
from faying.simulation.load import Load
from faying.simulation.path import solve_path
from faying.simulation.solution import Solution


@one_thread()
def frequency_response(
    system: System,
    load: Mapping[str, complex],
    frequencies: Sequence[float] | Vector,
    levels: Sequence[float] | Vector = (1.0,),
    *,
    harmonics: int | None = None,
    samples: int | None = None,
    tolerance: float = 0.01,
    initial: Solution | None = None,
    progress: Callable[[int], object] | None = None,
) -> FrequencyResponse:
    """Return the periodic motion of a joint under a harmonic load, with stick, slip and opening.

    Parameters
    ----------
    system
        Full or reduced model.
    load
        ``"boundary.component"``, or the name of a load pattern, to its complex amplitude F,
        f(t) = Re(F exp(iωt)): ``{"tip.Fz": 1.0, "tip.Fy": 1j}`` turns.
    frequencies : (n,) [1/time]
        In ascending order. Where the curve bends points are added, also past turning points.
    levels : (n_level,)
        Factors of the load.
    harmonics
        Number of harmonics of all modes; those that higher ones move more than statically have
        these too. By default past the first one that meets an excited mode, and three more until no
        motion changes by ``tolerance``: ``deviation`` of a curve has the change of each.
    samples
        Increments of a period; by default 16 for each harmonic, 64 at least.
    tolerance
        Relative change of a motion by three more harmonics.
    initial
        State to vibrate about, the last one of a path; by default the bolts are tightened with
        friction in one increment.
    progress
        Called with 1 after each level.

    Raises
    ------
    ModelError
        If a number is out of range, contact is hard, or the load does not fit the system.

    Notes
    -----
    Modes up to 1.5 times the highest harmonic, the third at least, have inertia and damping (F11).
    They and their harmonics are the same at all frequencies of a curve, and at least those of each
    frequency alone with as many harmonics. All other motion is as in the stuck joint, where this is
    exact (F17). If all closed points of an interface slip or open, shapes of the joint without
    friction or contact are added to these modes. Each motion is two periods from the slip of the
    joint at rest. Points that always stick keep their earlier slip, so that steady states form a
    family, a narrow one (``docs/theory/friction.md``). Frequencies without a solution are listed in
    ``missed`` of their curve.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(
    ...     element_size=10.0,
    ...     hole_radius=0.0,
    ...     washer_radius=11.0,
    ...     damping=fy.Rayleigh(alpha=50.0),
    ... )
    >>> joint = joint.with_bolt_forces({"bolt": 10e3}).with_friction(0.2)
    >>> found = fy.frequency_response(joint, {"tip.Fz": 1.0}, [640.0, 645.0], [1.0], harmonics=3)
    >>> found.curves[0].missed
    ()
    """
    system.contact.check_forgetful("steady vibrations", "solve_cycles")
    asked = np.asarray(frequencies, dtype=float)
    factors = np.atleast_1d(np.asarray(levels, dtype=float))
    _check(asked, factors, harmonics, samples, tolerance)
    state = solve_path(system, [Load()]) if initial is None else initial
    forced = ForcedJoint.of(system, load, state, asked)
    curves = []
    for level in factors.tolist():
        curve = forced.curve(level, harmonics=harmonics, samples=samples, tolerance=tolerance)
        curves.append(curve)
        if progress is not None:
            progress(1)
    return FrequencyResponse(
        load=dict(load),
        curves=tuple(curves),
        linear=forced.linear(1.0, linear_range(asked)),
        remarks=remarks_of(curves),
        units=system.units,
    )


def _check(
    frequencies: Vector,
    levels: Vector,
    harmonics: int | None,
    samples: int | None,
    tolerance: float,
) -> None:
    wrong = []
    rising = frequencies.ndim == 1 and len(frequencies) and (np.diff(frequencies) > 0).all()
    if not rising or not ((frequencies > 0) & (frequencies < np.inf)).all():
        wrong.append(f"the frequencies are {frequencies.tolist()}; give rising positive numbers")
    if not len(levels) or not ((levels > 0) & (levels < np.inf)).all():
        wrong.append(f"the levels are {levels.tolist()}; give positive numbers")
    if harmonics is not None and harmonics < 1:
        wrong.append(f"found {harmonics} harmonics; give one or more")
    if samples is not None and samples < 4 * (harmonics or FEWEST):
        wrong.append(f"found {samples} samples of a period; give four for each harmonic or more")
    if not 0 < tolerance < 1:
        wrong.append(f"the tolerance is {tolerance:g}; give a number between 0 and 1")
    if wrong:
        raise ModelError("; ".join(wrong))
