"""How to go on with a command that Ctrl-C or SIGTERM has stopped."""

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
"""Exit status after Ctrl-C and after SIGTERM, as shells have it."""


class _Terminated(KeyboardInterrupt):
    """SIGTERM: batch systems send it before they kill."""


def _terminate(_signal: int, _frame: FrameType | None) -> NoReturn:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # a second one ends it at once
    raise _Terminated


ANSWERS = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: _terminate}


@contextmanager
def resumable(command: Sequence[str], folder: Path, others: str = "") -> Iterator[None]:
    """Say how to go on with a command that is stopped, and end with the status of the signal.

    The command is what was given, without ``--resume``, with what else to give; ``unfinished`` in
    the folder keeps what is finished.
    """
    handlers = {}
    if threading.current_thread() is threading.main_thread():  # which alone hears signals
        for number, answer in ANSWERS.items():
            if signal.getsignal(number) is not signal.SIG_IGN:
                handlers[number] = signal.signal(number, answer)
    try:
        yield
    except KeyboardInterrupt as stopped:
        unfinished = folder / "unfinished"
        again = shlex.join([*command, *(["--resume"] if unfinished.exists() else [])]) + others
        said = f"what is finished is kept in {unfinished}. Go on with"
        if not unfinished.exists():
            said = "nothing was finished yet. Begin again with"
        typer.echo(f"Interrupted; {said}\n  {again}", err=True)
        status = TERMINATED if isinstance(stopped, _Terminated) else INTERRUPTED
        raise typer.Exit(status) from None
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
