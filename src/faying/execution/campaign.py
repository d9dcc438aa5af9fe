"""A campaign: named tasks, computed by an executor, kept as they come, resumable."""

import hashlib
import traceback
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from faying import __version__, exceptions
from faying._typing import Matrix
from faying.exceptions import CampaignError, FayingError
from faying.execution.checkpoint import Arrays, Checkpoint
from faying.execution.executor import Executor, LostTasksError, Prepare
from faying.execution.processes import pickled
from faying.execution.serial import SerialExecutor


def run_campaign(
    prepare: Prepare,
    tasks: Mapping[str, Any],
    executor: Executor | None = None,
    *,
    keep: Checkpoint | Path | str | None = None,
    progress: Callable[[str], object] | None = None,
) -> Mapping[str, Arrays]:
    """Compute named tasks, each giving named arrays.

    Parameters
    ----------
    prepare
        What a worker does once; returns the function from a task to a mapping of arrays. A function
        of a module, or ``functools.partial`` of one.
    tasks
        Name of each task to what is given to that function.
    executor
        Where; in this process unless given.
    keep
        Folder in which results are kept as they come, made if it is not there. A campaign that was
        stopped goes on from there when it is run again; results of other tasks, of another
        ``prepare`` or another faying are not taken for these. With a :class:`Checkpoint` in its
        place the names alone are the keys. Without, results are kept in memory.
    progress
        Called with the name of each task when its result is there.

    Returns
    -------
    Mapping
        Name of the task to its arrays, in the order of ``tasks``; read from the folder when asked
        for, so memory does not grow with the campaign.

    Raises
    ------
    FayingError
        Of the class that a task raised, and with its name, after all others are finished and kept.
        Of ``prepare``, at once.
    CampaignError
        If a task raised another error or did not return arrays, or killed its workers.

    Notes
    -----
    Equal numbers whatever the executor, as long as each process has as many threads: libraries sum
    in another order with others.
    """
    store = _store(keep)
    keys = dict(_keys(prepare, tasks, plain=not isinstance(keep, (Path, str))))
    missing = [name for name in tasks if not store.has(keys[name])]
    if progress is not None:
        for name in tasks:
            if store.has(keys[name]):
                progress(name)
    failures: dict[str, Failure] = {}
    found = _outcomes(prepare, tasks, missing, executor or SerialExecutor())
    with closing(found):  # else workers would go on as long as somebody looks at the error
        for name, outcome in found:
            if isinstance(outcome, Failure):
                failures[name] = outcome
                continue
            store.put(keys[name], outcome)
            if progress is not None:
                progress(name)
    if failures:
        raise _raised(failures, [name for name in missing if name in failures])
    return _Kept(store, keys)


@dataclass(frozen=True)
class Failure:
    """What an error was, in words that can be sent and shown."""

    kind: str
    message: str
    preparing: bool = False


def _outcomes(
    prepare: Prepare, tasks: Mapping[str, Any], names: Sequence[str], executor: Executor
) -> Generator[tuple[str, Arrays | Failure], None, None]:
    """Yield the result of each task or why there is none."""
    if not names:
        return
    found = executor.map(partial(_guarded, prepare), [tasks[name] for name in names])
    with closing(found):
        try:
            for place, outcome in found:
                if isinstance(outcome, Failure) and outcome.preparing:
                    raise _error(outcome, "")
                yield names[place], outcome
        except LostTasksError as error:
            for place in error.places:
                text = (
                    "every worker that tried it died; one that runs out of memory dies like this, "
                    "give each more of it"
                )
                yield names[place], Failure("CampaignError", text)


def _guarded(prepare: Prepare) -> Callable[[Any], Arrays | Failure]:
    """Prepare on a worker, with errors that come back as values: others' results go on."""
    try:
        function = prepare()
    except Exception as error:
        failure = _failure(error, preparing=True)
        return lambda _: failure

    def attempt(task: Any) -> Arrays | Failure:
        try:
            return _arrays(function(task))
        except Exception as error:
            return _failure(error, preparing=False)

    return attempt


def _arrays(result: Any) -> dict[str, Matrix]:
    if not isinstance(result, Mapping):
        message = f"it returned {type(result).__name__}; return a mapping of names to arrays"
        raise CampaignError(message)
    arrays = {str(name): np.asarray(value) for name, value in result.items()}
    for name, value in arrays.items():
        if value.dtype.hasobject:
            message = f"'{name}' of what it returned is no array of numbers or text"
            raise CampaignError(message)
    return arrays


def _failure(error: Exception, *, preparing: bool) -> Failure:
    if isinstance(error, FayingError):
        return Failure(type(error).__name__, str(error), preparing)
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
    text = f"{type(error).__name__}: {error}{place}"
    return Failure("CampaignError", f"preparing failed, {text}" if preparing else text, preparing)


def _raised(failures: Mapping[str, Failure], names: Sequence[str]) -> FayingError:
    """Return the error of the first task that failed, naming the others."""
    first, others = names[0], names[1:]
    more = ""
    if others:
        shown = ", ".join(f"'{name}'" for name in others[:5])
        more = f"; {len(others)} more failed: {shown}{', …' if len(others) > 5 else ''}"
    return _error(failures[first], f"task '{first}': ", more)


def _error(failure: Failure, before: str, after: str = "") -> FayingError:
    kind = getattr(exceptions, failure.kind, CampaignError)
    error: FayingError = kind(f"{before}{failure.message}{after}")
    return error


class _Memory:
    """Results of a campaign without a folder."""

    def __init__(self) -> None:
        self._bundles: dict[str, Arrays] = {}

    def has(self, key: str) -> bool:
        return key in self._bundles

    def get(self, key: str) -> Arrays:
        return self._bundles[key]

    def put(self, key: str, arrays: Arrays) -> None:
        self._bundles[key] = arrays


def _store(keep: Checkpoint | Path | str | None) -> Checkpoint | _Memory:
    if keep is None:
        return _Memory()
    if isinstance(keep, Checkpoint):
        return keep
    folder = Path(keep)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"cannot keep results in {folder}: {error.strerror}; choose another folder"
        raise CampaignError(message) from None
    return Checkpoint(folder)


def _keys(prepare: Prepare, tasks: Mapping[str, Any], *, plain: bool) -> Iterator[tuple[str, str]]:
    """Yield name and key of each task; the key says what was asked, unless the name does."""
    if plain:
        yield from ((name, name) for name in tasks)
        return
    common = hashlib.sha256(__version__.encode() + pickled(prepare))
    for name, task in tasks.items():
        asked = common.copy()
        asked.update(pickled(task))
        yield name, f"{name} {asked.hexdigest()}"


@dataclass(frozen=True)
class _Kept(Mapping[str, Arrays]):
    """Results that are read when asked for."""

    store: Checkpoint | _Memory
    keys_of: Mapping[str, str]

    def __getitem__(self, name: str) -> Arrays:
        return self.store.get(self.keys_of[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys_of)

    def __len__(self) -> int:
        return len(self.keys_of)
