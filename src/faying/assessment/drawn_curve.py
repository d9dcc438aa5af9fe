"""Results of contact and bolts along the motions of a curve over frequency."""

import numpy as np
import numpy.typing as npt

from faying._typing import ComplexMatrix, Mask, Matrix, Vector
from faying.assessment.response_curve import (
    ContactInMotion,
    Period,
    ResponseCurve,
    boundary_components,
)
from faying.digits import DECK_DIGITS
from faying.joint.system import System
from faying.simulation.periodic_curve import CurvePoint, Traced
from faying.simulation.solution import Solution


def drawn_curve(system: System, state: Solution, level: float, traced: Traced) -> ResponseCurve:
    """Return the curve of motions, and the periods of the largest loads on contact or bolts."""
    names, points = boundary_components(system), traced.points
    rows = [_period_results(system, point) for point in points]
    parts = {
        name: np.array([row[name] for row in rows]) for name in ContactInMotion.__dataclass_fields__
    }
    count = max((point.problem.n_harmonic for point in points), default=1)
    harmonics = [harmonics_of(point.motion.outputs[_boundaries(point)], count) for point in points]
    decisive = set[int]()
    if points:
        decisive = {int(parts["peak_pressure"].argmax()), int(parts["clamp_force"].argmin())}
        decisive |= {*parts["bolt_force_range"].argmax(axis=0).tolist()}
    frequency = np.array([point.motion.circular for point in points]) / (2 * np.pi)
    return ResponseCurve(
        level=level,
        components=names,
        frequency=frequency,
        harmonics=np.array(harmonics).reshape(len(points), count + 1, len(names)),
        missed=traced.missed,
        contact=ContactInMotion(**parts),
        periods={
            f"{frequency[row]:.6g}": _period(system, state, points[row]) for row in sorted(decisive)
        },
    )


def _period(system: System, state: Solution, point: CurvePoint) -> Period:
    """Return pressures and bolt forces along the last period of a motion."""
    loads, outputs, samples = point.problem.loads, point.motion.outputs, point.problem.samples
    added = dict(zip(system.bolts, loads.bolt_forces(outputs), strict=True))
    forces = _contact_forces(system, point)[0]
    return Period(
        times=2 * np.pi / point.motion.circular * np.arange(1, samples + 1) / samples,
        pressure=(forces / system.contact.weights[:, None]).T,
        bolt_forces={
            name: np.ravel(state.bolt_force(name))[-1] + force for name, force in added.items()
        },
        bolt_moments={
            name: state.bolt_bending(name).reshape(-1, 2, 2)[-1] + ends
            for name, ends in loads.bolt_moments(outputs).items()
        },
    )


def harmonics_of(values: Matrix, count: int) -> ComplexMatrix:
    """Return harmonics 0 … count (count + 1, n) from samples (n, N) that end with the period."""
    samples = values.shape[1]
    angle = 2 * np.pi * np.outer(np.arange(count + 1), np.arange(1, samples + 1)) / samples
    weights = np.where(np.arange(count + 1) > 0, 2.0, 1.0) / samples
    return np.asarray((weights[:, None] * np.exp(-1j * angle)) @ values.T)


def _boundaries(point: CurvePoint) -> slice:
    loads = point.problem.loads
    return slice(loads.n_column, loads.n_column + loads.n_boundary)


def _contact_forces(system: System, point: CurvePoint) -> npt.NDArray[np.float64]:
    """Return the contact forces along the last period of a motion (3, n_point, N)."""
    problem, contact, N = point.problem, system.contact, point.problem.samples
    stuck, k = problem.stuck, len(problem.stuck.springs)
    excess = problem.begun(point.motion)
    displaced = problem.displaced(point.unknowns, point.motion.circular, excess)
    moved = (contact.rows @ displaced[:, -N:]).reshape(k, -1, N)
    forces = np.zeros((3, contact.n_points, N))
    forces[:k] = stuck.forces[:k, :, None] - stuck.springs[:, :, None] * moved
    forces[:k, problem.local.points] = np.moveaxis(point.motion.path.forces[-N:], 0, 2)
    return forces


def _period_results(system: System, point: CurvePoint) -> dict[str, float | Vector]:
    """Return the results of contact and loads in the last period of a motion."""
    problem, motion, contact = point.problem, point.motion, system.contact
    stuck, loads, N = problem.stuck, problem.loads, problem.samples
    forces, path, watched = _contact_forces(system, point), motion.path, problem.local.points
    far = np.hypot(*np.moveaxis(path.slack[-N:], 1, 0))
    pressed = path.forces[-N:, 0] > 0
    slips = np.zeros(contact.n_points, dtype=bool)
    slips[watched] = ((far > DECK_DIGITS * far.max(initial=0.0)) & pressed).any(axis=0)
    closed = forces[0] > 0
    sticks = contact.sticking(forces[0].T, np.moveaxis(forces[1:], -1, 0)).T
    weights = contact.weights
    ever, at_rest = closed.any(axis=1), stuck.forces[0] > 0
    bound, surfaces = contact.coefficients * at_rest, contact.slices.values()
    shares = [_min_share(weights[at], sticks[at], closed[at]) for at in surfaces if bound[at].any()]
    # Work of f and of damping forces on du over a period, by the first harmonic and by all.
    orders = np.arange(problem.n_harmonic + 1)[:, None]
    turns = motion.circular * orders**2 * problem.moved(motion).conj()
    damped = harmonics_of(motion.outputs[loads.damped], problem.n_harmonic)
    first = harmonics_of(motion.outputs[:2], 1)[1]
    return {
        "load_work": -np.pi * problem.level * float(first[0].imag - first[1].real),
        "damping_energy": np.pi * float((turns * damped).real.sum()),
        "friction_energy": float(path.dissipation[-N:].sum()),
        "motion_energy": (motion.circular * np.linalg.norm(motion.harmonics[1])) ** 2 / 2,
        "peak_pressure": float((forces[0] / weights[:, None]).max(initial=0.0)),
        "stick_share": min(shares, default=1.0),
        "slip_share": float(weights[slips].sum() / max(weights[ever].sum(), 1e-300)),
        "open_share": float(
            (weights[at_rest] @ ~closed[at_rest]).max() / max(weights[at_rest].sum(), 1e-300)
        ),
        "clamp_force": float(forces[0].sum(axis=0).min()),
        "bolt_force_range": np.ptp(loads.bolt_forces(motion.outputs), axis=1),
        "error": point.error,
    }


def _min_share(weights: Vector, chosen: Mask, of: Mask) -> float:
    """Return the least chosen share (n, N) of an area; 0 for no area."""
    area = np.maximum(weights @ of, np.finfo(float).tiny)
    return float((weights @ chosen / area).min())
