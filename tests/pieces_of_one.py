"""The pieces of one response, where a test has one alone."""

from faying.simulation.transient_pieces import transient_pieces


def pieces_of_one(steps, load, *, restart=None, **options):
    """Yield each piece of a response, and where it stands then."""
    restarts = None if restart is None else [restart]
    for (piece,), (here,) in transient_pieces(steps, [load], restarts=restarts, **options):
        yield piece, here
