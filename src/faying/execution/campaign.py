"""Campaigns: named tasks, computed by an executor, with results stored so that it can resume."""

import hashlib
import signal
import threading
import traceback
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence, Set
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from faying import __version__, exceptions
from faying._typing import Matrix
from faying.display.facts import listed
from faying.exceptions import CampaignError, FayingError
from faying.execution.checkpoint import Arrays, Bundles, Checkpoint
from faying.execution.executor import Executor, Prepare, SerialExecutor
from faying.execution.processes import pickled


def run_campaign(
    prepare: Prepare,
    tasks: Mapping[str, Any],
    executor: Executor | None = None,
    *,
    keep: Bundles | Path | str | None = None,
    progress: Callable[[str], object] | None = None,
) -> Mapping[str, Arrays]:
    """Compute named tasks, each of which returns named arrays.

    Parameters
    ----------
    prepare
        Called once by a worker; returns the function from a task to a mapping of arrays. A function
        of a module, or ``functools.partial`` of one.
    tasks
        Arguments of that function by the name of the task.
    executor
        Executor of the tasks; this process unless given.
    keep
        Folder in which results are stored at once, made if it does not exist. A campaign that was
        stopped continues from it when it is run again; results of other tasks, of another
        ``prepare`` or another version of faying are ignored. With a :class:`Checkpoint` in its
        place the names alone are the keys. With None, results are kept in memory.
    progress
        Called with the name of each task when its result is complete.

    Returns
    -------
    Mapping
        Arrays by the name of the task, in the order of ``tasks``; read from the folder on access,
        so that memory does not grow with the campaign.

    Raises
    ------
    FayingError
        The error of a task, with its name, after all others are finished and stored.
        The error of ``prepare``, at once.
    CampaignError
        If a task raised another error or did not return arrays, or killed its workers.

    Notes
    -----
    Every executor and number of workers gives equal numbers, as long as each process has as
    many threads, because the order of sums depends on threads. Workers agree to the
    last bit; a process that did other work before, like an interactive one, differs by 1e-12.
    """
    groups = [{name: task} for name, task in tasks.items()]
    return run_grouped_campaign(
        partial(_prepare_for_groups, prepare), groups, executor, keep=keep, progress=progress
    )


def run_grouped_campaign(
    prepare: Prepare,
    groups: Sequence[Mapping[str, Any]],
    executor: Executor | None = None,
    *,
    keep: Bundles | Path | str | None = None,
    progress: Callable[[str], object] | None = None,
) -> Mapping[str, Arrays]:
    """Compute named tasks in groups; each task returns named arrays.

    Parameters
    ----------
    prepare
        As in :func:`run_campaign`, but the returned function takes a list of tasks, and returns
        or yields one mapping of arrays for each.
    groups
        Mappings from names to tasks; :func:`grouped` makes such groups.
    executor, keep, progress
        As in :func:`run_campaign`; one result is stored per task, whatever its group.

    Returns
    -------
    Mapping
        As :func:`run_campaign`, in the order of the groups.

    Raises
    ------
    FayingError
        As :func:`run_campaign`, or if two tasks have one name.

    Notes
    -----
    A worker computes a whole group, and another repeats it if the worker dies. Where some results
    of a group are missing, the whole group is computed again and the missing ones are stored: in
    another group their last digits would differ. Where a task of a group fails, each of the group
    is computed alone, so that the results of the others are stored.
    """
    _ignore_broken_pipes()
    tasks = _ungrouped(groups)
    store = _store(keep)
    keys = dict(_keys(prepare, tasks, plain=not isinstance(keep, (Path, str))))
    missing = [name for name in tasks if not store.has(keys[name])]
    if progress is not None:
        for name in tasks:
            if store.has(keys[name]):
                progress(name)
    failures: dict[str, Failure] = {}
    outcomes = _outcomes(prepare, groups, set(missing), executor or SerialExecutor())
    with closing(outcomes):  # otherwise workers would run on as long as the error is held
        for name, outcome in outcomes:
            if isinstance(outcome, Failure):
                failures[name] = outcome
                continue
            store.put(keys[name], outcome)
            if progress is not None:
                progress(name)
    if failures:
        raise _first_error(failures, [name for name in missing if name in failures])
    return _StoredResults(store, keys)


def _ignore_broken_pipes() -> None:
    """Restore Python's default that writing to the pipe of a dead worker raises an error.

    ``gmsh.initialize`` revokes it: writing to such a pipe would then end this process
    without a message. Only the main thread may set signal handlers.
    """
    if hasattr(signal, "SIGPIPE") and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)


@dataclass(frozen=True)
class Failure:
    """The class name and message of an error, which can be sent between processes."""

    kind: str
    message: str
    preparing: bool = False


Group = tuple[list[Any], list[int]]
"""Tasks of a group, and the indices of the tasks whose results are needed."""


def _prepare_for_groups(prepare: Prepare) -> Callable[[list[Any]], Iterator[Any]]:
    """Prepare the function of single tasks, and return it for groups."""
    return partial(map, prepare())


def _ungrouped(groups: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    tasks: dict[str, Any] = {}
    for group in groups:
        for name, task in group.items():
            if name in tasks:
                message = f"two tasks are called '{name}'; give each a name of its own"
                raise CampaignError(message)
            tasks[name] = task
    return tasks


def _outcomes(
    prepare: Prepare,
    groups: Sequence[Mapping[str, Any]],
    missing: Set[str],
    executor: Executor,
) -> Generator[tuple[str, Arrays | Failure], None, None]:
    """Yield name and result, or failure, of each missing task."""
    todo = [group for group in groups if not missing.isdisjoint(group)]
    if not todo:
        return
    asked = [[order for order, name in enumerate(group) if name in missing] for group in todo]
    names = [[name for name in group if name in missing] for group in todo]
    sent: list[Group] = [
        (list(group.values()), places) for group, places in zip(todo, asked, strict=True)
    ]
    results = executor.map(partial(_prepare_safely, prepare, __version__), sent)
    with closing(results):
        for number, outcomes in results:
            lost = [_lost(len(todo[number]))] * len(names[number])
            for name, outcome in zip(names[number], outcomes or lost, strict=True):
                if isinstance(outcome, Failure) and outcome.preparing:
                    raise _error(outcome, "")
                yield name, outcome


def _lost(n_together: int) -> Failure:
    fewer = f" or compute fewer than {n_together} side by side" if n_together > 1 else ""
    text = (
        "every worker that tried it died; workers that run out of memory die like this, "
        f"give each more memory{fewer}"
    )
    return Failure("CampaignError", text)


def _prepare_safely(prepare: Prepare, version: str) -> Callable[[Group], list[Arrays | Failure]]:
    """Prepare on a worker, and return errors as values so that other tasks go on."""
    try:
        if version != __version__:
            message = (
                f"a worker has faying {__version__}, but this process has {version}; "
                "install the same version everywhere"
            )
            raise CampaignError(message)
        function = prepare()
    except Exception as error:
        failure = _failure(error, preparing=True)
        return lambda group: [failure] * len(group[1])

    def attempt(group: Group) -> list[Arrays | Failure]:
        tasks, places = group
        try:
            outcomes = list(map(_arrays, function(tasks)))
        except Exception as error:
            if len(tasks) == 1:
                return [_failure(error, preparing=False)]
            return [attempt(([tasks[number]], [0]))[0] for number in places]
        if len(outcomes) != len(tasks):
            text = f"{len(tasks)} tasks gave {len(outcomes)} results; return one for each"
            return [Failure("CampaignError", text)] * len(places)
        return [outcomes[number] for number in places]

    return attempt


def _arrays(result: Any) -> dict[str, Matrix]:
    if not isinstance(result, Mapping):
        message = f"the task returned {type(result).__name__}; return a mapping of names to arrays"
        raise CampaignError(message)
    arrays = {str(name): np.asarray(value) for name, value in result.items()}
    for name, value in arrays.items():
        if value.dtype.hasobject:
            message = f"the task returned '{name}', which is not an array of numbers or text"
            raise CampaignError(message)
    return arrays


def _failure(error: Exception, *, preparing: bool) -> Failure:
    if isinstance(error, FayingError):
        return Failure(type(error).__name__, str(error), preparing)
    frames = traceback.extract_tb(error.__traceback__)
    line = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
    text = f"{type(error).__name__}: {error}{line}"
    return Failure("CampaignError", f"preparing failed, {text}" if preparing else text, preparing)


def _first_error(failures: Mapping[str, Failure], names: Sequence[str]) -> FayingError:
    """Return the error of the first failed task, with the names of the other failed ones."""
    first, others = names[0], names[1:]
    more = ""
    if others:
        more = f"; {len(others)} more failed: {listed(map(repr, others))}"
    return _error(failures[first], f"task '{first}': ", more)


def _error(failure: Failure, prefix: str, suffix: str = "") -> FayingError:
    kind = getattr(exceptions, failure.kind, CampaignError)
    error: FayingError = kind(f"{prefix}{failure.message}{suffix}")
    return error


def _store(keep: Bundles | Path | str | None) -> Bundles:
    if keep is None:
        return Bundles()
    if isinstance(keep, Bundles):
        return keep
    folder = Path(keep)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"cannot keep results in {folder}: {error.strerror}; choose another folder"
        raise CampaignError(message) from None
    return Checkpoint(folder)


def _keys(prepare: Prepare, tasks: Mapping[str, Any], *, plain: bool) -> Iterator[tuple[str, str]]:
    """Yield name and key of each task; the key is a hash of the task, or its name if plain."""
    if plain:
        yield from ((name, name) for name in tasks)
        return
    common = hashlib.sha256(__version__.encode() + pickled(prepare))
    for name, task in tasks.items():
        asked = common.copy()
        asked.update(pickled(task))
        yield name, f"{name} {asked.hexdigest()}"


@dataclass(frozen=True)
class _StoredResults(Mapping[str, Arrays]):
    """Results that are read from a store on access."""

    store: Bundles
    keys_of: Mapping[str, str]

    def __getitem__(self, name: str) -> Arrays:
        return self.store.get(self.keys_of[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys_of)

    def __len__(self) -> int:
        return len(self.keys_of)
