"""Tasks on a Dask cluster, remote or on this machine (extra ``cluster``)."""

import hashlib
import json
import pickle
import socket
import threading
import uuid
from collections import OrderedDict
from collections.abc import Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack
from functools import partial
from importlib import import_module
from pathlib import Path
from time import perf_counter
from types import TracebackType
from typing import Any, Self

from faying.exceptions import CampaignError
from faying.execution.executor import Function, Prepare, Results, results_of
from faying.files.child_python import STARTUP_SECONDS
from faying.iterations import RETRIES

CONNECT_SECONDS = 15.0
"""Seconds that a scheduler may take to answer."""


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
        # Workers of a batch system may start hours later, local ones start at once.
        self._patient, self._seen = True, 0.0

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
                    "distributed.scheduler.allowed-failures": RETRIES - 1,
                    # It gives up a worker not restarted by then, slow on a busy machine.
                    "distributed.deploy.lost-worker-timeout": "10 minutes",
                }
            )
        )
        cluster = distributed.LocalCluster(
            n_workers=n_workers,
            threads_per_worker=1,
            # Factorizations cannot be spilled or shared: a limit would only end workers.
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
            Its address, such as ``tcp://node17:8786``, or the scheduler file
            (``dask scheduler --scheduler-file FILE``).

        Raises
        ------
        CampaignError
            If the extra is missing, the file is not a scheduler file, or nothing answers.
        """
        distributed = _package()
        address = _address(scheduler)
        try:
            _check_reachable(address)
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
        """Number of workers connected at present."""
        return len(self._client.nthreads())

    def map(self, prepare: Prepare, tasks: Sequence[Any]) -> Results:
        """Yield index and result of each task in the order of completion."""
        # Functions of scripts go by value, since workers do not have the script.
        payload: bytes = import_module("cloudpickle").dumps(prepare)
        # A task rather than scattered data: it is computed again if its worker dies.
        sent = self._client.submit(bytes, payload, key=f"faying-prepare-{uuid.uuid4().hex}")
        pool = self._client.get_executor(pure=False, retries=2)
        submit = partial(pool.submit, compute, sent, hashlib.sha256(payload).hexdigest())
        death = _package().KilledWorker
        tried = partial(results_of, submit, tasks, death=death, watch=self._watch)
        self._seen = perf_counter()
        try:
            suspects = yield from tried(range(len(tasks)), together=len(tasks))
            # Dask blames all tasks of a dead worker, so each suspect is tried alone.
            for task in suspects:
                if len(suspects) == 1 or (yield from tried([task], together=1)):
                    yield task, None
        except ModuleNotFoundError as error:
            message = f"a Dask worker lacks a package: {error}; install the same packages on all"
            raise CampaignError(message) from None
        except (CancelledError, OSError) as error:
            message = (
                f"the Dask cluster dropped the campaign ({type(error).__name__}); "
                "look at its scheduler's log and resume"
            )
            raise CampaignError(message) from None

    def _watch(self) -> float:
        """Return the seconds to wait; raise if all local workers have died."""
        if self._patient or self._client.nthreads():
            self._seen = perf_counter()
        if perf_counter() - self._seen > STARTUP_SECONDS:
            message = (
                "all Dask workers of this machine have died and were not replaced; "
                "workers that run out of memory die like this, use fewer"
            )
            raise CampaignError(message)
        return 5.0

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
        """Close the executor."""
        self.close()


def _package() -> Any:
    """Return the package of Dask, untyped since its annotations are incomplete."""
    try:
        return import_module("distributed")
    except ImportError:
        message = (
            "Dask's package 'distributed' is not installed; pip install 'faying[cluster]', "
            "or use --workers"
        )
        raise CampaignError(message) from None


def _check_reachable(address: str) -> None:
    """Connect to an address once; raise OSError or ValueError where nothing answers.

    A client that cannot connect leaves its event loop and threads in this process, so none
    is started for a dead address.
    """
    addressing = import_module("distributed.comm.addressing")
    scheme, location = addressing.parse_address(address)
    import_module("distributed.comm.registry").get_backend(scheme)
    if scheme in {"tcp", "tls", "ws", "wss"}:
        host, port = addressing.parse_host_port(location)
        socket.create_connection((host, port), timeout=CONNECT_SECONDS).close()


def _address(scheduler: str) -> str:
    """Return the address in a scheduler file, or the argument if it is an address."""
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
        "give the file that 'dask scheduler --scheduler-file FILE' wrote"
    )
    raise CampaignError(message)


_PREPARED: OrderedDict[str, Function] = OrderedDict()
_TURN = threading.Lock()


def compute(payload: bytes, digest: str, task: Any) -> Any:
    """Compute a task on a worker, one thread at a time since factorizations are not shared."""
    with _TURN:
        return _prepared(payload, digest)(task)


def _prepared(payload: bytes, digest: str) -> Function:
    """Return the prepared function, which all tasks of a worker share."""
    if digest not in _PREPARED:
        while len(_PREPARED) >= 2:  # keep the last two
            _PREPARED.popitem(last=False)
        _PREPARED[digest] = pickle.loads(payload)()
    _PREPARED.move_to_end(digest)
    return _PREPARED[digest]
