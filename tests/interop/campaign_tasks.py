"""What the campaigns of the tests do; a module of its own, for workers import it."""

import os
import signal
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np

import faying as fy
from faying.exceptions import ModelError
from faying.simulation.stepping import transient_solver


def square(log):
    """Prepare the cheapest of functions; the log counts preparations and tasks."""
    note(log, "prepared")
    return partial(_square, log)


def _square(log, task):
    note(log, task)
    return {"square": np.asarray(task**2)}


def note(log, what):
    with Path(log).open("a") as file:
        file.write(f"{what}\n")


def mixed():
    """Prepare a function some of whose tasks fail."""
    return _mixed


def _mixed(task):
    if task == "model":
        message = "there is no boundary 'top'"
        raise ModelError(message)
    if task == "bug":
        return {"ratio": np.asarray(1 / 0)}
    if task == "text":
        return "no arrays"
    if task == "die":
        die()
    return {"length": np.asarray(len(task))}


def die():
    """End this process as the system does where memory runs out.

    A worker of Dask waits until its nanny knows that it runs: one that dies while it starts is not
    replaced.
    """
    if distributed := sys.modules.get("distributed"):
        worker = distributed.get_worker()
        asked = {"function": distributed.protocol.pickle.dumps(_is_running)}
        nanny = worker.rpc(worker.nanny)
        while not distributed.utils.sync(worker.loop, nanny.run, **asked)["result"]:
            time.sleep(0.05)
    os.kill(os.getpid(), signal.SIGKILL)


def _is_running(dask_worker):
    """Return whether a nanny knows that its worker runs."""
    return dask_worker.process.status.name == "running"


def mixed_together():
    """Prepare the same for groups."""
    return partial(map, _mixed)


def company():
    """Prepare a function whose results tell who was computed together."""
    return _company


def _company(tasks):
    return [{"own": np.asarray(task), "all": np.asarray(tasks)} for task in tasks]


def forgetful():
    """Prepare a function that loses the last of several."""
    return _forgetful


def _forgetful(tasks):
    return [{"own": np.asarray(task)} for task in tasks[: max(1, len(tasks) - 1)]]


def unprepared():
    message = "the model has no mass"
    raise ModelError(message)


def die_with(mark):
    """Remove the file and die, where it is still there."""
    try:
        Path(mark).unlink()
    except FileNotFoundError:
        return
    die()


def deadly():
    os.kill(os.getpid(), signal.SIGKILL)


def joint():
    """Build a small preloaded joint."""
    model = fy.lap_joint(element_size=5.0, damping=fy.Rayleigh(beta=1e-6))
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


def transients(mark, step):
    """Prepare transients of the joint; whoever finds the file removes it and is killed."""
    model = joint()
    solver, rest = transient_solver(model, step=step), fy.solve_static(model)
    return partial(_transient, solver, rest, mark)


def _transient(solver, rest, mark, load):
    response = solver.solve(load, duration=40 * solver.step, initial=rest)
    if load.name == "third":
        die_with(mark)
    return {"pressure": response.pressure, "displacement": response.displacement("tip")}


def pressure_or_death(mark, solution):
    """Take what is wanted of a solution; whoever finds the file removes it and is killed."""
    if solution.name == "third":
        die_with(mark)
    return {"pressure": solution.pressure, "displacement": solution.displacement("tip")}
