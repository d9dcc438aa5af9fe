"""Division of vectorized work into pieces that bound memory and fit into caches."""

from collections.abc import Iterator

PIECE_NUMBERS = 2**18
"""Numbers of one array of a piece: 2 MB, small enough for a processor's cache."""


def pieces(count: int, numbers: int = 1) -> Iterator[slice]:
    """Yield slices of ``count`` items, of ``numbers`` numbers each, that fit into a piece."""
    size = max(1, PIECE_NUMBERS // max(numbers, 1))
    return (slice(start, min(start + size, count)) for start in range(0, count, size))
