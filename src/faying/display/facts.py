"""Values shown as one line of text, and as a small table in a notebook."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from html import escape


class Shown(ABC):
    """A value that is shown by a short summary rather than by all its numbers.

    Dataclasses that are shown so are declared with ``repr=False``.
    """

    @property
    @abstractmethod
    def facts(self) -> Mapping[str, str]:
        """Texts that summarize the value, by their labels; quick to compute."""

    def __repr__(self) -> str:
        inner = ", ".join(f"{meaning}: {value}" for meaning, value in self.facts.items())
        return f"{type(self).__name__}({inner})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f'<tr><th scope="row" style="text-align: left">{escape(meaning)}</th>'
            f'<td style="text-align: left">{escape(value)}</td></tr>'
            for meaning, value in self.facts.items()
        )
        return f"<table><caption>{type(self).__name__}</caption><tbody>{rows}</tbody></table>"


def with_unit(value: float, unit: str) -> str:
    """Return a number with four significant digits and its unit.

    Examples
    --------
    >>> with_unit(105.4037, "MPa"), with_unit(float("inf"), "")
    ('105.4 MPa', 'inf')
    """
    return f"{value:.4g} {unit}".rstrip()


def listed(names: Iterable[object]) -> str:
    """Return the first few names as text, and the number of the remaining ones.

    Examples
    --------
    >>> listed([3, 5]), listed(range(1, 11))
    ('3, 5', '1, 2, 3, 4, 5, 6, 7, 8 and 2 more')
    """
    every = list(map(str, names))
    more = len(every) - MOST_SHOWN
    return ", ".join(every[:MOST_SHOWN]) + (f" and {more} more" if more > 0 else "")


def bulleted(mistakes: Sequence[str]) -> str:
    """Return the first few mistakes, one a line, and the number of the remaining ones.

    Examples
    --------
    >>> print(bulleted(["no column 'tip'", "no column 'end'"]))
      - no column 'tip'
      - no column 'end'
    """
    lines, more = [f"  - {text}" for text in mistakes[:MOST_SHOWN]], len(mistakes) - MOST_SHOWN
    return "\n".join([*lines, f"  ... and {more} more"] if more > 0 else lines)


def counted(names: Mapping[str, object]) -> str:
    """Return the number of names, and the first few of them in parentheses.

    Examples
    --------
    >>> counted({"left": 1, "right": 2}), counted({})
    ('2 (left, right)', '0')
    """
    shown = list(names)[:MOST_SHOWN]
    more = ", …" if len(names) > len(shown) else ""
    return f"{len(names)} ({', '.join(shown)}{more})" if shown else "0"


WORTH_SAYING = 0.05
"""Share of a quantity above which a second contribution is mentioned beside the first."""

MOST_SHOWN = 8
"""Number of names, mistakes or files that are written out; the rest are counted."""
