"""Groups of tasks that are computed together, determined by the tasks alone.

The group of a transient changes its round-off; the number of workers must not.
"""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from math import ceil
from typing import TypeVar

from faying.exceptions import CampaignError

FEWEST_TOGETHER = 4
"""Default number of tasks side by side, and number of groups below which groups do not grow.

A response then costs half of what it costs alone. With four groups two workers have two each;
with more workers the time that larger groups save outweighs idle ones: eight side by side take a
third to a half longer than four.
"""

MOST_TOGETHER = 8
"""Most tasks side by side by default, at 0.35 to 0.45 of the cost; 16 save a fifth more."""

T = TypeVar("T")


def grouped(tasks: Mapping[str, T], size: int | None = None) -> list[dict[str, T]]:
    """Return the tasks in order, divided into groups of about equal size.

    Parameters
    ----------
    size
        Largest size of a group. By default a quarter of the tasks, at least 4 and at most 8: the
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
    """Return a sequence divided evenly into the fewest parts of at most ``size`` items."""
    count = ceil(len(items) / size)
    ends = [len(items) * part // max(count, 1) for part in range(count + 1)]
    return [items[start:end] for start, end in pairwise(ends)]
