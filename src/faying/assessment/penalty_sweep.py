"""What the contact stiffness c_n of Eq. (15.12) means for a joint: a sweep.

A penalty is right when it no longer shows: pressures are those of hard contact, Eq. (15.7), as far
as the mesh can resolve them. The yardstick is hard contact at the joint's own contact points, so
that nothing but the penalty differs; pressures are compared as nodal averages. Where there are more
points than node pairs (Gauss points, and eight-node facets under any rule) hard contact leaves
pressures undetermined, and a very stiff penalty makes single points carry what their neighbours
should: pressures alternate from point to point and the peak grows. A stiffer penalty than any of
the sweep then serves as hard, and what gives no nodal force is left out before averaging.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from faying._typing import Matrix, Vector, frozen
from faying.assessment.accuracy import relative_error
from faying.digits import SOLVED
from faying.exceptions import ModelError
from faying.interface.pair_fit import PairFit
from faying.interface.penalty import automatic_penalty_of
from faying.joint.model import Model
from faying.joint.system import System
from faying.simulation.load import Load
from faying.simulation.preload import tighten
from faying.simulation.solution import Solution
from faying.simulation.static import AT_REST, solve_static_cases
from faying.simulation.static_case import solve_static

DECADES = np.arange(-2.0, 2.25, 0.5)
"""Default penalties are these powers of ten times the automatic one."""


HARD_PENALTY = 10.0
"""Penalty that stands for hard contact, over the stiffest of a sweep and the automatic one.

What a penalty shows is of first order in its inverse: the default sweep ends at a hundredth of what
the automatic one shows, and a thousandth is left of it here.
"""


@dataclass(frozen=True, eq=False, kw_only=True)
class PenaltySweep:
    """Static solutions of a joint over its contact stiffness, bolts at the same final forces.

    Attributes
    ----------
    loads : (n_load,)
        Names of the load cases.
    penalties : (n_penalty,) [force/length³]
        Contact stiffness, ascending.
    automatic : [force/length³]
        10 E/h of the adjoining elements, or the model's own penalty where that is unknown.
    max_pressure : (n_penalty, n_load) [force/length²]
        Largest pressure at the contact points.
    max_average : (n_penalty, n_load) [force/length²]
        Largest nodal average of the pressure that displacements feel.
    penetration : (n_penalty, n_load) [length]
        Largest penetration.
    deviation : (n_penalty, n_load) [1]
        Largest difference of nodal averages to hard contact, over the largest nodal average of
        hard contact.
    rms_deviation : (n_penalty, n_load) [1]
        Root mean square of the same where hard contact has pressure.
    hard_max_average : (n_load,) [force/length²]
        Largest nodal average of hard contact.
    element_size : [length]
        Root of the mean facet area.
    deflection : (n_load,) [length]
        Largest boundary translation of hard contact.
    errors : (n_penalty, n_load) [1]
        Method name to its largest relative error against the full model of the same penalty.
    """

    loads: tuple[str, ...]
    penalties: Vector
    automatic: float
    max_pressure: Matrix
    max_average: Matrix
    penetration: Matrix
    deviation: Matrix
    rms_deviation: Matrix
    hard_max_average: Vector
    element_size: float
    deflection: Vector
    errors: Mapping[str, Matrix] = field(default_factory=dict)

    def __post_init__(self) -> None:
        arrays = ("penalties", "max_pressure", "max_average", "penetration", "deviation")
        for name in (*arrays, "rms_deviation", "hard_max_average", "deflection"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def relative_penetration(self) -> Matrix:
        """Largest penetration over the element size (n_penalty, n_load)."""
        return np.asarray(self.penetration / self.element_size)

    @property
    def table(self) -> str:
        """The sweep as lines of text, worst load of each column."""
        names = "".join(f"{name:>16}" for name in self.errors)
        head = f"{'c_n':>10}{'peak p':>10}{'average':>10}{'penetr.':>10}{'/h':>9}{'off hard':>10}"
        lines = [head + names]
        for row, penalty in enumerate(self.penalties):
            worst = "".join(f"{error[row].max():>16.2%}" for error in self.errors.values())
            lines.append(
                f"{penalty:>10.3g}{self.max_pressure[row].max():>10.4g}"
                f"{self.max_average[row].max():>10.4g}{self.penetration[row].max():>10.2e}"
                f"{self.relative_penetration[row].max():>9.1e}{self.deviation[row].max():>10.1%}"
                + worst
            )
        return "\n".join(lines)


def penalty_sweep(
    model: Model,
    loads: Sequence[Load] = (AT_REST,),
    penalties: Sequence[float] | None = None,
    *,
    methods: Mapping[str, Callable[[Model], System]] | None = None,
) -> PenaltySweep:
    """Solve static loads over a range of contact stiffnesses and compare with hard contact.

    Parameters
    ----------
    model
        Preloaded. At each penalty its bolts are tightened anew to the final forces they have in
        this model without load, for the same initial force would give another preload.
    penalties : [force/length³]
        Finite; by default nine from 1/100 to 100 times 10 E/h.
    methods
        Name to a function that reduces the model of one penalty, for instance
        ``{"jim-b": lambda m: fy.reduce(m, basis)}``; bases made before the sweep may be used.

    Returns
    -------
    PenaltySweep
        Its ``table`` is for reading; :mod:`faying.assessment.penalty_advice` draws the conclusion.

    Raises
    ------
    ModelError
        If a penalty is not positive and finite, or there is no pressure to compare.

    Notes
    -----
    No factorization: copies of the model with another penalty share its structure. Per penalty
    the bolts are tightened once and every load is one small contact problem.
    """
    centre = _automatic(model)
    values = centre * 10.0**DECADES if penalties is None else np.sort(np.asarray(penalties, float))
    if values.ndim != 1 or not len(values) or not ((values > 0) & np.isfinite(values)).all():
        message = "penalties of a sweep must be positive and finite; hard contact is the yardstick"
        raise ModelError(message)
    final = _final_forces(model)
    hard = _tightened(_hard(model, HARD_PENALTY * max(centre, float(values.max()))), final)
    yardstick = solve_static_cases(hard, loads)
    for load, forces in zip(loads, yardstick.contact_forces, strict=True):
        if not forces.any():
            message = f"load '{load.name}' has no contact pressure, which no penalty changes"
            raise ModelError(message)
    fits = {name: PairFit.of(interface) for name, interface in model.interfaces.items()}
    averages = _nodal_averages(hard, yardstick, fits)
    rows: list[list[Vector]] = []
    errors: dict[str, list[Vector]] = {name: [] for name in methods or {}}
    for penalty in values:
        swept = _tightened(model.with_penalty(float(penalty)), final)
        full = solve_static_cases(swept, loads)
        rows.append(_row(full, _nodal_averages(swept, full, fits), averages))
        for name, build in (methods or {}).items():
            cases = solve_static_cases(build(swept), loads)
            errors[name].append(_max_errors(cases, full))
    columns = np.array(rows).transpose(1, 0, 2)
    area = sum(interface.area for interface in model.interfaces.values())
    return PenaltySweep(
        loads=tuple(load.name for load in loads),
        penalties=values,
        automatic=centre,
        max_pressure=columns[0],
        max_average=columns[1],
        penetration=columns[2],
        deviation=columns[3],
        rms_deviation=columns[4],
        hard_max_average=averages.max(axis=1),
        element_size=float(np.sqrt(area / _facet_count(model))),
        deflection=_deflections(yardstick),
        errors={name: np.array(values) for name, values in errors.items()},
    )


def _automatic(model: Model) -> float:
    """Return the softest 10 E/h of the interfaces, or the model's own penalty if unknown."""
    try:
        return min(automatic_penalty_of(model.assembly, i) for i in model.interfaces.values())
    except ModelError:
        smallest = min(interface.penalty for interface in model.interfaces.values())
        if np.isfinite(smallest):
            return float(smallest)
        raise


def _final_forces(model: Model) -> dict[str, float]:
    preloaded = solve_static(model)
    forces = {name: float(preloaded.bolt_force(name)) for name in model.bolts}
    return {name: force for name, force in forces.items() if force > 0}


def _tightened(model: Model, final: Mapping[str, float]) -> Model:
    return model.with_bolt_forces(tighten(model, final).initial_forces) if final else model


def _hard(model: Model, stiff: float) -> Model:
    """Return the model with hard contact, of a stiff penalty where pairs do not determine it."""
    return model.with_interfaces(
        {
            name: interface.with_penalty(
                np.inf if interface.n_points <= len(interface.pairs) else stiff
            )
            for name, interface in model.interfaces.items()
        }
    )


def _nodal_averages(model: Model, solution: Solution, fits: Mapping[str, PairFit]) -> Matrix:
    """Nodal averages (n_load, n_pair of all interfaces) of what displacements feel."""
    slices = model.contact.slices
    parts = [
        model.interfaces[name].nodal_average(fits[name].felt(solution.pressure[:, points]))
        for name, points in slices.items()
    ]
    return np.concatenate(parts, axis=1)


def _row(solution: Solution, averages: Matrix, hard: Matrix) -> list[Vector]:
    """One line of the sweep, each entry (n_load,)."""
    off = np.array([relative_error(a, h) for a, h in zip(averages, hard, strict=True)])
    pressed = hard > SOLVED * hard.max(axis=1, keepdims=True)
    rms = np.sqrt((off**2 * pressed).sum(axis=1) / pressed.sum(axis=1))
    return [
        solution.max_pressure,
        averages.max(axis=1),
        solution.max_penetration,
        np.abs(off).max(axis=1),
        rms,
    ]


def _max_errors(cases: Solution, full: Solution) -> Vector:
    pairs = zip(cases.pressure, full.pressure, strict=True)
    return np.array([np.abs(relative_error(p, reference)).max() for p, reference in pairs])


def _facet_count(model: Model) -> int:
    return sum(len(f.minus) for interface in model.interfaces.values() for f in interface.faces)


def _deflections(solution: Solution) -> Vector:
    """Largest boundary translation of every load; zero without a boundary."""
    largest = np.zeros(len(solution.inputs))
    for name, boundary in solution.system.boundaries.items():
        moved = solution.displacement(name)[..., boundary.components < 3]
        largest = np.maximum(largest, np.abs(moved).max(axis=1, initial=0.0))
    return largest
