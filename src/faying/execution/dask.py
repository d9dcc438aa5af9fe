"""Tasks on a Dask cluster: a scheduler anywhere, or one of this machine (extra ``cluster``)."""

import hashlib
import json
import pickle
import socket
import threading
import uuid
from collections import OrderedDict
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack
from importlib import import_module
from math import ceil
from pathlib import Path
from queue import Empty, Queue
from time import perf_counter
from types import TracebackType
from typing import Any, Self

from faying.exceptions import CampaignError
from faying.execution.executor import FATAL_DEATHS, Function, LostTasksError, Prepare, Results

BATCH_SECONDS = 0.1
"""Work a batch holds at least; Dask needs about a millisecond for each."""

PROBES = 64
"""Tasks that are sent one by one, from whose times the size of batches follows."""

CONNECT_SECONDS = 15.0
"""How long a scheduler may take to answer."""

POLL_SECONDS = 5.0

WITHOUT_WORKERS = 120.0
"""Seconds a cluster of this machine may be without workers; a restart takes 2 to 20."""

KEPT = 2
"""Prepared functions a worker keeps, those it used last."""


class DaskExecutor:
    """Workers of a Dask cluster; use it in a ``with`` statement, or :meth:`close` it.

    Parameters
    ----------
    client
        A connected ``distributed.Client``; not closed by this executor.
    """

    def __init__(self, client: Any) -> None:
        self._client = client
        self._owned = ExitStack()
        # Workers of a batch system may come hours later; those of this machine are there.
        self._patient = True

    @classmethod
    def local(cls, n_workers: int) -> Self:
        """Start a scheduler and workers on this machine, with one thread each.

        Raises
        ------
        CampaignError
            If the extra is missing.
        """
        distributed, config = _package(), import_module("dask.config")
        owned = ExitStack()
        owned.enter_context(
            config.set(
                {
                    # Dask gives up a task when more workers than this have died.
                    "distributed.scheduler.allowed-failures": FATAL_DEATHS - 1,
                    # And the place of a worker not back by then: on a busy machine that takes long.
                    "distributed.deploy.lost-worker-timeout": "10 minutes",
                }
            )
        )
        cluster = distributed.LocalCluster(
            n_workers=n_workers,
            threads_per_worker=1,
            # Factorizations can neither be spilled nor shared: a limit would only end workers.
            memory_limit=0,
            dashboard_address=":0",  # whichever port is free
        )
        owned.enter_context(cluster)
        executor = cls(owned.enter_context(distributed.Client(cluster, set_as_default=False)))
        executor._owned, executor._patient = owned, False
        return executor

    @classmethod
    def connect(cls, scheduler: str) -> Self:
        """Connect to a scheduler.

        Parameters
        ----------
        scheduler
            Its address, as ``tcp://node17:8786``, or the file it was told to write
            (``dask scheduler --scheduler-file FILE``).

        Raises
        ------
        CampaignError
            If the extra is missing, the file is no such file, or nothing answers.
        """
        distributed = _package()
        address = _address(scheduler)
        try:
            _knock(address)
            client = distributed.Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError, TypeError) as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            message = (
                f"no Dask scheduler answers at {address or 'an empty address'} ({reason}); give the"
                " address that 'dask scheduler' printed, or the file it wrote with --scheduler-file"
            )
            raise CampaignError(message) from None
        executor = cls(client)
        executor._owned.enter_context(client)
        return executor

    @property
    def n_workers(self) -> int:
        """Workers that are connected now."""
        return len(self._client.nthreads())

    def map(self, prepare: Prepare, tasks: Sequence[Any]) -> Results:
        """Yield place and result of each task as they come; tiny ones are sent in batches."""
        if not tasks:
            return
        campaign = _Map(
            self._client,
            prepare,
            tasks,
            n_workers=max(self.n_workers, 1),
            patient=self._patient,
        )
        yield from campaign.results()

    def close(self) -> None:
        """Disconnect, and end a cluster that :meth:`local` started."""
        self._owned.close()

    def __enter__(self) -> Self:
        """Return the executor."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close it."""
        self.close()


def _package() -> Any:
    """Return Dask's package, whose annotations are too partial to be used."""
    try:
        return import_module("distributed")
    except ImportError:
        message = (
            "Dask's package 'distributed' is not installed; pip install 'faying[cluster]', "
            "or use --workers"
        )
        raise CampaignError(message) from None


def _knock(address: str) -> None:
    """Open the address once and close it again; raises OSError or ValueError where nothing answers.

    A client that could not connect leaves its event loop and threads behind in this process, so
    none is started for an address that nobody listens at.
    """
    addressing = import_module("distributed.comm.addressing")
    scheme, location = addressing.parse_address(address)
    import_module("distributed.comm.registry").get_backend(scheme)
    if scheme in {"tcp", "tls", "ws", "wss"}:
        host, port = addressing.parse_host_port(location)
        socket.create_connection((host, port), timeout=CONNECT_SECONDS).close()


def _address(scheduler: str) -> str:
    """Return the address a scheduler file holds, or what is one already."""
    path = Path(scheduler or "(no name)")
    if "://" in scheduler or not (path.suffix == ".json" or path.exists()):
        return scheduler
    try:
        address = json.loads(path.read_text(encoding="utf-8"))["address"]
    except OSError as error:
        reason = str(error.strerror)
    except (ValueError, KeyError, TypeError):
        reason = "it holds no address"
    else:
        return str(address)
    message = (
        f"cannot read scheduler file {path}: {reason}; "
        "give the one that 'dask scheduler --scheduler-file FILE' wrote"
    )
    raise CampaignError(message)


class _Map:
    """One campaign on a cluster: what was sent and what came back."""

    def __init__(
        self,
        client: Any,
        prepare: Prepare,
        tasks: Sequence[Any],
        *,
        n_workers: int,
        patient: bool,
    ) -> None:
        self.client, self.tasks = client, tasks
        self.n_workers, self.patient = n_workers, patient
        # By value where a module is a script, which workers do not have.
        payload: bytes = import_module("cloudpickle").dumps(prepare)
        self.digest = hashlib.sha256(payload).hexdigest()
        # A task rather than scattered data: computed again where its worker dies.
        self.payload = client.submit(bytes, payload, key=f"faying-prepare-{uuid.uuid4().hex}")
        self.sent: dict[str, tuple[Any, tuple[int, ...]]] = {}
        self.done: Queue[Any] = Queue()
        self.unsent: Sequence[int] = ()
        self.suspects: list[int] = []

    def results(self) -> Iterator[tuple[int, Any]]:
        """Send tasks, some first, and yield what comes back."""
        places = range(len(self.tasks))
        probes = min(len(places), max(PROBES, 2 * self.n_workers))
        self.unsent = places[probes:]
        try:
            yield from self._answers(places[:probes])
            unsent, self.unsent = self.unsent, ()
            yield from self._answers(unsent)  # only where every probe was fatal
            yield from self._suspected()
        finally:
            self.client.cancel([future for future, _ in self.sent.values()])

    def _answers(self, singly: Sequence[int]) -> Iterator[tuple[int, Any]]:
        """Send tasks one by one, what was not sent as soon as one is back, and yield results."""
        for task in singly:
            self._send((task,))
        while self.sent:
            future = self._next()
            _, batch = self.sent.pop(future.key)
            outcome = self._outcome(future, batch)
            if outcome is None:
                continue
            results, seconds = outcome
            unsent, self.unsent = self.unsent, ()
            for part in self._batches(unsent, seconds):
                self._send(part)
            yield from zip(batch, results, strict=True)

    def _next(self) -> Any:
        """Wait for the next future that is done, as long as there can be one."""
        alone = perf_counter()
        while True:
            try:
                return self.done.get(timeout=POLL_SECONDS)
            except Empty:
                if self.patient or self.client.nthreads():
                    alone = perf_counter()
            if perf_counter() - alone > WITHOUT_WORKERS:
                message = (
                    "all Dask workers of this machine have died and were not replaced; "
                    "one that runs out of memory dies like this, use fewer"
                )
                raise CampaignError(message)

    def _suspected(self) -> Iterator[tuple[int, Any]]:
        """Try tasks whose workers died alone: Dask blames all that a worker had before it."""
        suspects, lost = sorted(self.suspects), list[int]()
        if len(suspects) == 1:
            raise LostTasksError(suspects)
        for task in suspects:
            self.suspects = []
            yield from self._answers([task])
            lost += self.suspects
        if lost:
            raise LostTasksError(lost)

    def _batches(self, places: Sequence[int], seconds: float) -> Iterator[tuple[int, ...]]:
        """Divide tasks that take some time each, without leaving a worker idle for it."""
        worthwhile = ceil(BATCH_SECONDS / max(seconds, 1e-6))
        size = max(1, min(worthwhile, ceil(len(places) / self.n_workers)))
        for start in range(0, len(places), size):
            yield tuple(places[start : start + size])

    def _send(self, places: tuple[int, ...]) -> None:
        future = self.client.submit(
            compute_batch,
            self.payload,
            self.digest,
            [self.tasks[task] for task in places],
            key=f"faying-task-{uuid.uuid4().hex}",
            pure=False,
            retries=2,
        )
        self.sent[future.key] = future, places
        future.add_done_callback(self.done.put)

    def _outcome(self, future: Any, batch: tuple[int, ...]) -> Any:
        """Return results and mean time of a batch; None where it killed its workers."""
        try:
            # Where the worker that has it dies meanwhile, it is computed again.
            return future.result()
        except _package().KilledWorker:
            self.suspects.extend(batch)
            return None
        except ModuleNotFoundError as error:
            message = f"a Dask worker lacks a package: {error}; install the same ones everywhere"
            raise CampaignError(message) from None
        except (CancelledError, OSError) as error:
            message = (
                f"the Dask cluster dropped the campaign ({type(error).__name__}); "
                "look at its scheduler's log and resume"
            )
            raise CampaignError(message) from None


_PREPARED: OrderedDict[str, Function] = OrderedDict()
_TURN = threading.Lock()


def compute_batch(payload: bytes, digest: str, tasks: Sequence[Any]) -> tuple[list[Any], float]:
    """Compute tasks on a worker; return results and the mean time of one.

    Threads of a worker take turns: factorizations are not for two at once.
    """
    with _TURN:
        function = _prepared(payload, digest)
        start = perf_counter()
        results = [function(task) for task in tasks]
        return results, (perf_counter() - start) / len(tasks)


def _prepared(payload: bytes, digest: str) -> Function:
    """Prepare once, whatever the number of tasks."""
    if digest not in _PREPARED:
        while len(_PREPARED) >= KEPT:
            _PREPARED.popitem(last=False)
        _PREPARED[digest] = pickle.loads(payload)()
    _PREPARED.move_to_end(digest)
    return _PREPARED[digest]
