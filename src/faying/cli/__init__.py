"""The command line: parse, call, print; one file per command. No logic lives here."""

import sys
from typing import Annotated

import typer

from faying.cli.check import check
from faying.cli.export import export
from faying.cli.fit import band, fit
from faying.cli.init import init, schema
from faying.cli.recover import recover
from faying.cli.reduce import reduce
from faying.cli.reports import report, view
from faying.cli.run import demo, run
from faying.cli.solve import solve
from faying.cli.tighten import tighten
from faying.exceptions import FayingError

BAD_INPUT = 2
"""Exit status of errors that the user can correct."""

# Plain tracebacks can be pasted into bug reports.
app = typer.Typer(
    name="faying",
    help="Contact pressure in bolted joints at the cost of a reduced model.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    add_completion=False,
    context_settings={"help_option_names": ["--help", "-h"]},
)
for command in (
    demo,
    init,
    run,
    check,
    report,
    recover,
    export,
    reduce,
    solve,
    tighten,
    fit,
    band,
    schema,
    view,
):
    app.command()(command)


def _print_version(asked: bool) -> None:
    if asked:
        from importlib.metadata import version

        typer.echo(f"faying {version('faying')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_print_version, is_eager=True, help="Print version."),
    ] = False,
) -> None:
    pass


def main() -> None:
    """Run the command line; bad input gives one message and exit status 2, not a traceback."""
    try:
        app()
    except FayingError as error:
        message = str(error)
    except OSError as error:
        file = f"{error.filename}: " if error.filename else ""
        message = f"{file}{error.strerror or error}; check the path, the folder and free space"
    except MemoryError as error:
        message = f"out of memory ({error}); use a coarser mesh, or fewer loads, steps and modes"
    else:
        return
    # Names from files may contain control characters of terminals.
    shown = "".join(c if c.isprintable() or c == "\n" else ascii(c)[1:-1] for c in message)
    typer.echo(f"faying: {shown}", err=True)
    sys.exit(BAD_INPUT)
