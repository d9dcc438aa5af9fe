"""A campaign of transient runs on a SLURM cluster, through dask-jobqueue.

Run it on the login node, in an environment that the compute nodes see too::

    pip install 'faying[cluster]' dask-jobqueue
    python examples/slurm_campaign.py results-folder

Every SLURM job is one worker: it builds and factorizes the joint once, then takes loads, four at a
time side by side, until none is left. Jobs may start hours apart; a job that is killed or runs out
of time gives its loads back.
Stopped (Ctrl-C, or the login node's limits), the script goes on where it was when it is run again.
"""

import sys
from pathlib import Path

import faying as fy
from faying.execution import DaskExecutor, transient_campaign

JOBS = 8
STEP, DURATION = 5e-6, 2e-3
LOADS = {
    f"Fz {force:.0f} N, Mx {moment:.0f} N mm": fy.Load({"tip.Fz": force, "tip.Mx": moment})
    for force in (-750.0, -500.0, -250.0, 250.0, 500.0, 750.0)
    for moment in (-30e3, -15e3, 0.0, 15e3, 30e3)
}


def joint() -> fy.Model:
    """Build the default cantilever, preloaded, with its sticking area."""
    model = fy.lap_joint(element_size=1.25, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


def main() -> None:
    """Ask SLURM for workers, run the campaign, print the largest pressure of each load."""
    # Not faying's: it comes with `pip install dask-jobqueue`.
    from dask_jobqueue import SLURMCluster
    from distributed import Client

    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "campaign")
    cluster = SLURMCluster(
        queue="standard",  # sinfo names yours
        account=None,
        walltime="04:00:00",
        # One process of one thread: factorizations are not shared, and take turns in a process.
        processes=1,
        cores=1,
        memory="16GB",  # faying's report says what a factorization takes
        interface="ib0",  # the network the nodes share; leave it out if unsure
        job_script_prologue=["export OMP_NUM_THREADS=1 MKL_NUM_THREADS=1"],
    )
    cluster.scale(jobs=JOBS)
    with cluster, Client(cluster) as client:
        found = transient_campaign(
            joint,
            LOADS,
            DaskExecutor(client),
            step=STEP,
            duration=DURATION,
            side_by_side=4,  # the thirty loads are then eight groups, one for each job
            keep=folder,
            progress=lambda name: sys.stderr.write(f"finished {name}\n"),
        )
        for name, arrays in found.items():
            sys.stdout.write(f"{name}: {arrays['pressure'].max():.2f} MPa\n")


if __name__ == "__main__":
    main()
