"""Which tasks are worked at together: decided by the tasks alone, whoever computes them.

In whose company a transient is stepped changes its round-off; how many workers there are must not.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import ceil
from typing import TypeVar

from faying.exceptions import CampaignError

FEWEST_TOGETHER = 4
"""Side by side unless told, and groups that are left before more than these go together.

A response then costs half of what it costs alone. Of as many groups two workers have several each;
with more workers the time that larger groups save outweighs idle ones: eight side by side take a
third to a half longer than four.
"""

MOST_TOGETHER = 8
"""Side by side at most unless told, for 0.35 to 0.45; 16 save a fifth of that, for more memory."""

T = TypeVar("T")


def grouped(tasks: Mapping[str, T], size: int | None = None) -> list[dict[str, T]]:
    """Divide tasks, in their order, into groups of about the same size.

    Parameters
    ----------
    size
        Of a group at most. Unless told a quarter of the tasks, but 4 at least and 8 at most: the
        first few side by side save most, and groups are what workers share.

    Raises
    ------
    CampaignError
        If the size is not positive.
    """
    if size is None:
        size = min(MOST_TOGETHER, max(FEWEST_TOGETHER, len(tasks) // FEWEST_TOGETHER))
    if size < 1:
        message = f"the number of tasks side by side is {size}; give at least one"
        raise CampaignError(message)
    return [dict(part) for part in even_parts(list(tasks.items()), size)]


def even_parts(items: Sequence[T], size: int) -> list[Sequence[T]]:
    """Divide a sequence into as few parts of at most ``size`` as there can be, evenly."""
    count = ceil(len(items) / size)
    ends = [len(items) * part // max(count, 1) for part in range(count + 1)]
    return [items[start:end] for start, end in pairwise(ends)]
