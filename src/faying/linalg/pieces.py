"""Work on many things alike by the piece, so that memory stays bounded and caches hold it."""

from collections.abc import Iterator

PIECE_NUMBERS = 2**18
"""Numbers of one array of a piece: 2 MB, small enough for a processor's cache."""


def pieces(count: int, numbers: int = 1) -> Iterator[slice]:
    """Divide ``count`` things of so many numbers each, in their order."""
    size = max(1, PIECE_NUMBERS // max(numbers, 1))
    return (slice(start, min(start + size, count)) for start in range(0, count, size))
