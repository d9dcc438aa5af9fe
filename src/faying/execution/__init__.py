"""Campaigns: many tasks on one prepared model, in this process, in several or on a cluster.

See docs/how-to/run_on_a_cluster.md.
"""

from faying.execution.campaign import run_campaign, run_grouped_campaign
from faying.execution.checkpoint import Checkpoint
from faying.execution.dask import DaskExecutor
from faying.execution.executor import Executor, SerialExecutor
from faying.execution.groups import grouped
from faying.execution.processes import ProcessExecutor
from faying.execution.transients import responses, transient_campaign

__all__ = [
    "Checkpoint",
    "DaskExecutor",
    "Executor",
    "ProcessExecutor",
    "SerialExecutor",
    "grouped",
    "responses",
    "run_campaign",
    "run_grouped_campaign",
    "transient_campaign",
]
