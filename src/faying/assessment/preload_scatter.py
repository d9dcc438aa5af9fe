"""What scatter of the preloads does: the metrics of a load case over many tightenings."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix
from faying.assessment.case_metrics import case_metrics, metrics_of
from faying.exceptions import ModelError
from faying.interface.surface import ContactSurface
from faying.joint.system import System
from faying.simulation.load import Load
from faying.simulation.static import solve_static_inputs

SHARES = (0.0, 0.05, 0.5, 0.95, 1.0)
"""Of the tightenings, below which the values that are told lie."""


@dataclass(frozen=True, kw_only=True)
class PreloadScatter:
    """How far preloads differ from what was meant.

    Attributes
    ----------
    tightening_factor
        α_A, largest over smallest preload of one bolt (VDI 2230); their mean is what was meant, and
        between them any is as likely as any other, for each bolt on its own.
    settlement : [length]
        f_Z, by which every bolt is shorter afterwards, because surfaces flatten.
    samples
        Tightenings that are tried, the same ones at every call.
    """

    tightening_factor: float = 1.0
    settlement: float = 0.0
    samples: int = 200

    def __post_init__(self) -> None:
        wrong = []
        if not 1 <= self.tightening_factor < np.inf:
            wrong.append(f"the tightening factor is {self.tightening_factor:g}; give 1 or more")
        if not 0 <= self.settlement < np.inf:
            wrong.append(f"the settlement is {self.settlement:g}; give a length, or 0")
        if self.samples < 1:
            wrong.append(f"there are {self.samples} samples; give 1 or more")
        if wrong:
            raise ModelError("; ".join(wrong))


@final
@dataclass(frozen=True, kw_only=True)
class Spread:
    """One metric of one load case over the tightenings.

    Attributes
    ----------
    case
        Load case.
    metric
        What, as in ``clamp_force.joint``.
    dimension
        Dimension of the values in words, as ``force/length²``.
    meant
        At the preloads that were meant, without settlement.
    least
        Smallest value.
    p05
        Value that 5 % of the tightenings stay below.
    median
        Value that half of them stay below.
    p95
        Value that 95 % of them stay below.
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


def preload_spreads(
    system: System,
    interfaces: Mapping[str, ContactSurface],
    load: Load,
    scatter: PreloadScatter,
) -> tuple[Spread, ...]:
    """Return the metrics of a static load case over scattered preloads.

    Parameters
    ----------
    system
        Preloaded full or reduced model without friction.
    interfaces
        Geometry of its contact points.
    load
        Histories are taken at time zero.

    Raises
    ------
    ModelError
        If the load does not fit, or there is no bolt or friction.

    Notes
    -----
    A static solution for each tightening. The initial force N₀ of a bolt is multiplied and
    lowered by its stiffness times the settlement; its final force follows in proportion where
    nothing but the bolts loads the joint and gaps are zero.
    """
    if not system.bolts or len(system.contact.rubbing):
        what = "friction" if system.bolts else "no bolt"
        message = f"the model has {what}, and scatter is of preloads without friction; leave it out"
        raise ModelError(message)
    inputs = np.vstack(
        [meant := load.inputs(system, np.zeros(1)), _tightened(system, meant, scatter)]
    )
    table = case_metrics(solve_static_inputs(system, inputs, load.name), interfaces)
    spreads = []
    for column, metric in enumerate(metrics_of(system, interfaces, certified=False)):
        if metric.worst is None:
            continue
        values = np.quantile(table[1:, column], SHARES).tolist()
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


def _tightened(system: System, meant: Matrix, scatter: PreloadScatter) -> Matrix:
    """Return the inputs (n_sample, n_input) of all tightenings."""
    bolts, count = system.port_compliance.bolts, scatter.samples
    rng, n_bolt = np.random.default_rng(0), bolts.stop - bolts.start
    # One in each of as many equal ranges: the quantiles of one bolt are then those that are meant.
    order = rng.permuted(np.tile(np.arange(count), (n_bolt, 1)), axis=1)
    shares = (order.T + rng.random((count, n_bolt))) / count
    most = scatter.tightening_factor
    factors = 2 * (1 + (most - 1) * shares) / (1 + most)
    stiffness = np.array([bolt.stiffness for bolt in system.bolts.values()])
    inputs = np.repeat(meant, count, axis=0)
    locked = inputs[:, bolts] * factors - stiffness * scatter.settlement
    inputs[:, bolts] = np.maximum(locked, 0.0)
    return inputs
