"""Continuing a command that Ctrl-C or SIGTERM has stopped."""

import shlex
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import NoReturn

import typer

INTERRUPTED, TERMINATED = 130, 143
"""Exit status after Ctrl-C and after SIGTERM, as in shells."""


class _Terminated(KeyboardInterrupt):
    """SIGTERM, which batch systems send before they kill a process."""


def _terminate(_signal: int, _frame: FrameType | None) -> NoReturn:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # a second signal ends the process at once
    raise _Terminated


ANSWERS = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: _terminate}


@contextmanager
def resumable(
    command: Sequence[str], folder: Path, others: str = "", option: Sequence[str] = ("--resume",)
) -> Iterator[None]:
    """Print how to continue a command that is stopped, and exit with the status of the signal.

    ``command`` is the command line without the ``option`` that continues it, and ``others`` further
    text; the folder's ``unfinished`` keeps finished results.
    """
    handlers = {}
    if threading.current_thread() is threading.main_thread():  # only it receives signals
        for number, answer in ANSWERS.items():
            if signal.getsignal(number) is not signal.SIG_IGN:
                handlers[number] = signal.signal(number, answer)
    try:
        yield
    except KeyboardInterrupt as stopped:
        unfinished = folder / "unfinished"
        again = shlex.join([*command, *(option if unfinished.exists() else ())]) + others
        said = f"finished results are kept in {unfinished}. Continue with"
        if not unfinished.exists():
            said = "nothing was finished yet. Start again with"
        typer.echo(f"Interrupted; {said}\n  {again}", err=True)
        status = TERMINATED if isinstance(stopped, _Terminated) else INTERRUPTED
        raise typer.Exit(status) from None
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
