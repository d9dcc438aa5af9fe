"""The command ``faying``, which says from its first moment that it was stopped.

Reading in the command line takes a second, in which nothing is computed.
"""

import signal
import sys
from types import FrameType
from typing import NoReturn


def main() -> None:
    """Run the command line."""
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) is not signal.SIG_IGN:  # as of what a shell starts behind it
            signal.signal(number, _end)
    from faying.cli import main as run_command_line

    run_command_line()


def _end(number: int, _frame: FrameType | None) -> NoReturn:
    sys.stderr.write("Interrupted; nothing was written. Give the same command again\n")
    sys.exit(128 + number)


# Worker processes read this module again under another name.
if __name__ == "__main__":
    main()
