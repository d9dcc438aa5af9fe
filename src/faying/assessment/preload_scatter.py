"""The effect of scatter of the preloads: metrics of a load case over many tightenings."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from itertools import chain
from types import MappingProxyType

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.case_metrics import case_metrics, metrics_of
from faying.assessment.growth import DEFAULT_INCREMENTS
from faying.assessment.strength.thread import Thread
from faying.exceptions import ModelError, naming, refuse_model
from faying.interface.surface import ContactSurface
from faying.joint.model import Model
from faying.joint.system import System
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import InputRow, NamedLoad
from faying.simulation.path import path_inputs, solve_ends

QUANTILES = (0.0, 0.05, 0.5, 0.95, 1.0)
"""Reported quantiles over the tightenings."""


@dataclass(frozen=True, kw_only=True)
class PreloadScatter:
    """Scatter of preloads about their nominal values.

    Attributes
    ----------
    tightening_factor
        α_A, largest over smallest preload of one bolt (VDI 2230), with a uniform distribution
        between them about the nominal preload, independent for each bolt. Tables of α_A include
        the scatter of friction; with ``thread_friction`` it is that of the torque alone.
    settlement : [length]
        f_Z, by which every bolt is shorter after embedding of the surfaces.
    thread_friction, head_friction
        Smallest and largest μ_G in the threads and μ_K under the heads, together: every bolt is
        tightened with the torque of the nominal preload at the middle of both ranges.
    surface_friction
        Smallest and largest μ of the interfaces with friction, independent for each.
    samples
        Number of tightenings, the same ones at every call.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> torque = fy.PreloadScatter(tightening_factor=1.6)
    >>> (spread, *_) = fy.assess(joint, [fy.Load()], scatter=torque).scatter
    >>> bool(spread.least < spread.meant < spread.most)
    True
    """

    tightening_factor: float = 1.0
    settlement: float = 0.0
    thread_friction: tuple[float, float] | None = None
    head_friction: tuple[float, float] | None = None
    surface_friction: tuple[float, float] | None = None
    samples: int = 200

    def __post_init__(self) -> None:
        wrong = []
        if not 1 <= self.tightening_factor < np.inf:
            wrong.append(f"the tightening factor is {self.tightening_factor:g}; give 1 or more")
        if not 0 <= self.settlement < np.inf:
            wrong.append(f"the settlement is {self.settlement:g}; give a length, or 0")
        if self.samples < 1:
            wrong.append(f"there are {self.samples} samples; give 1 or more")
        for name in ("thread_friction", "head_friction", "surface_friction"):
            ends = getattr(self, name)
            if ends is not None and not 0 <= ends[0] <= ends[1] < np.inf:
                wrong.append(f"{name} goes from {ends[0]:g} to {ends[1]:g}; give the smaller first")
        if (self.thread_friction is None) != (self.head_friction is None):
            wrong.append("the torque takes both thread_friction and head_friction; give the other")
        if wrong:
            raise ModelError("; ".join(wrong))


@dataclass(frozen=True, kw_only=True)
class Spread:
    """One metric of one load case over the tightenings.

    Attributes
    ----------
    case
        Load case.
    metric
        Name of the metric, as in ``clamp_force.joint``.
    dimension
        Dimension of the values in words, as ``force/length²``.
    meant
        Value at the nominal preloads, without settlement.
    least
        Smallest value.
    p05
        5th percentile over the tightenings.
    median
        Median.
    p95
        95th percentile.
    most
        Largest value.
    """

    case: str
    metric: str
    dimension: str
    meant: float
    least: float
    p05: float
    median: float
    p95: float
    most: float


Stage = Callable[[str, int], AbstractContextManager[Callable[[int], object] | None]]
"""Context, by name and number of steps, that may return a function to report progress."""


def spreads_of_cases(
    system: Model | ReducedModel,
    interfaces: Mapping[str, ContactSurface],
    loads: Sequence[NamedLoad],
    scatter: PreloadScatter,
    threads: Mapping[str, Thread],
    stage: Stage = lambda *_: nullcontext(),
) -> tuple[Spread, ...]:
    """Return the metrics of static load cases over scattered preloads, in one stage."""
    with stage("preload scatter", (1 + scatter.samples) * len(loads)) as told:
        each = (preload_spreads(system, interfaces, load, scatter, threads, told) for load in loads)
        return tuple(chain.from_iterable(each))


def preload_spreads(
    system: Model | ReducedModel,
    interfaces: Mapping[str, ContactSurface],
    load: NamedLoad,
    scatter: PreloadScatter,
    threads: Mapping[str, Thread] = MappingProxyType({}),
    progress: Callable[[int], object] | None = None,
) -> tuple[Spread, ...]:
    """Return the metrics of a static load case over scattered preloads.

    Histories are taken at time zero. Threads of bolts give the preload of a torque with scattered
    friction in thread and head. ``progress`` is called with the number of further tightenings.

    Raises
    ------
    ModelError
        If the load does not fit, there is no bolt, or a scattered quantity does not exist.
    ConvergenceError
        If a tightening is not solved, with friction.

    Notes
    -----
    A static solution for each tightening; with friction at an interface a path, in which all
    bolts are tightened together before the load grows, with metrics of slip too. The initial force
    N₀ of a bolt is multiplied, and lowered by its stiffness times the settlement; its final force
    is proportional to this where the bolts are the only load and gaps are zero.
    """
    if not system.bolts:
        refuse_model("the model has no bolt that could scatter; leave that out")
    if scatter.surface_friction is not None:
        system.contact.check_rubs()
    rng = np.random.default_rng(0)
    meant = load.inputs(system, np.zeros(1))
    inputs = np.vstack([meant, _sampled_inputs(system, meant, scatter, threads, rng)])

    def told(ways: Sequence[Matrix]) -> Iterator[Matrix]:
        for way in ways:
            yield way
            if progress is not None:
                progress(1)

    metrics, spreads = metrics_of(system, interfaces, certified=False), list[Spread]()
    tables = list[Matrix]()
    for joint, rows in _joints(system, inputs, scatter, rng):
        ways = [_path_inputs(joint, row) for row in rows]
        ends = solve_ends(joint, ways, None, load.name, told)
        tables.append(case_metrics(ends, interfaces))
    table = np.concatenate(tables)
    for column, metric in enumerate(metrics):
        if metric.worst is None:
            continue
        values = np.quantile(table[1:, column], QUANTILES).tolist()
        spreads.append(
            Spread(
                case=load.name,
                metric=metric.name,
                dimension=metric.dimension,
                meant=float(table[0, column]),
                **dict(zip(("least", "p05", "median", "p95", "most"), values, strict=True)),
            )
        )
    return tuple(spreads)


def _joints(
    system: Model | ReducedModel, inputs: Matrix, scatter: PreloadScatter, rng: np.random.Generator
) -> Iterator[tuple[Model | ReducedModel, Matrix]]:
    """Yield joints with inputs (n, n_input): the given one, or one for each friction sample."""
    if scatter.surface_friction is None:
        yield system, inputs
        return
    yield system, inputs[:1]
    names = list(system.contact.laws)
    drawn = _in_range(scatter.surface_friction, _strata(rng, scatter.samples, len(names)))
    for row, coefficients in zip(inputs[1:], drawn.tolist(), strict=True):
        yield _with_coefficients(system, dict(zip(names, coefficients, strict=True))), row[None]


def _path_inputs(system: System, row: Vector) -> Matrix:
    """Return inputs (n_load, n_input) of a path: tightening, then the load in equal increments."""
    load, count = InputRow(name="", row=row), DEFAULT_INCREMENTS
    return path_inputs(system, [load.scaled(step / count) for step in range(count + 1)])


def _with_coefficients(
    system: Model | ReducedModel, coefficients: Mapping[str, float]
) -> Model | ReducedModel:
    """Return a full or reduced model with other coefficients of friction."""
    laws = {
        name: system.contact.laws[name].with_coefficient(friction)
        for name, friction in coefficients.items()
    }
    if isinstance(system, ReducedModel):
        return replace(system, contact=replace(system.contact, laws=laws))
    interfaces = system.interfaces.items()
    return system.with_interfaces({name: face.with_law(laws[name]) for name, face in interfaces})


def _sampled_inputs(
    system: System,
    meant: Matrix,
    scatter: PreloadScatter,
    threads: Mapping[str, Thread],
    rng: np.random.Generator,
) -> Matrix:
    """Return the inputs (n_sample, n_input) of all tightenings."""
    bolts, count = system.port_compliance.bolts, scatter.samples
    factor = scatter.tightening_factor
    shares = _strata(rng, count, bolts.stop - bolts.start)
    factors = 2 * (1 + (factor - 1) * shares) / (1 + factor)
    if scatter.thread_friction is not None and scatter.head_friction is not None:
        ranges = (scatter.thread_friction, scatter.head_friction)
        # The nominal values first, the middle of both ranges, then the samples.
        middle = np.full((1, shares.shape[1]), 0.5)
        drawn = [
            _in_range(limits, np.vstack([middle, _strata(rng, *shares.shape)])) for limits in ranges
        ]
        for column, name in enumerate(system.bolts):
            torque = _torque(name, threads, *(limits[:, column] for limits in drawn))
            factors[:, column] *= torque[0] / torque[1:]
    stiffness = np.array([bolt.stiffness for bolt in system.bolts.values()])
    inputs = np.repeat(meant, count, axis=0)
    locked = inputs[:, bolts] * factors - stiffness * scatter.settlement
    inputs[:, bolts] = np.maximum(locked, 0.0)
    return inputs


def _torque(bolt: str, threads: Mapping[str, Thread], in_thread: Vector, at_head: Vector) -> Vector:
    """Return the tightening torque of a bolt per preload [length]."""
    if bolt not in threads:
        refuse_model(f"bolt '{bolt}' has no thread, whose friction could scatter; give it")
    with naming(f"bolt '{bolt}'"):
        return threads[bolt].torque_per_force(in_thread, at_head)


def _strata(rng: np.random.Generator, count: int, columns: int) -> Matrix:
    """Return positions in a range (count, columns), one in every equal part of it in each column.

    The quantiles of each bolt are then exact (Latin hypercube).
    """
    order = rng.permuted(np.tile(np.arange(count), (columns, 1)), axis=1)
    return (order.T + rng.random((count, columns))) / count


def _in_range(ends: tuple[float, float], shares: Matrix) -> Matrix:
    return ends[0] + (ends[1] - ends[0]) * shares
