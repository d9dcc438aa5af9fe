"""A deck as a sequence of keywords, with parts replaced by their instances and steps counted."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from faying.exceptions import FormatError
from faying.io.abaqus.instances import instantiated
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.source import read_spans
from faying.io.abaqus.tokenizer import read_keywords


@dataclass(frozen=True, eq=False, kw_only=True)
class Deck:
    """Keywords in their order.

    Attributes
    ----------
    n_step
        Number of steps.
    path
        The deck, for messages that concern all of it.
    ignore
        What is left out on request: words of :data:`faying.io.left_out.IGNORABLE`.
    """

    keywords: Sequence[Keyword]
    n_step: int
    path: Path
    ignore: frozenset[str] = frozenset()

    def of(self, *names: str) -> list[Keyword]:
        """Return the keywords of these names."""
        return [keyword for keyword in self.keywords if keyword.name in names]

    def without(self, *names: str) -> "Deck":
        """Return the deck without the keywords of these names."""
        return replace(self, keywords=[k for k in self.keywords if k.name not in names])

    @property
    def perturbations(self) -> frozenset[int]:
        """The steps that are linear perturbations: loads of other steps do not act in them."""
        return frozenset(k.step for k in self.of("STEP") if k.has("PERTURBATION"))

    def until(self, step: int | None) -> "Deck":
        """Return the deck as it is in one step: model data and steps up to it.

        Linear perturbation steps leave nothing behind for later ones; by default the last other
        step is taken.
        """
        aside = self.perturbations
        general = [number for number in range(1, self.n_step + 1) if number not in aside]
        chosen = step if step is not None else (general[-1] if general else self.n_step)
        if step is not None and not 1 <= step <= self.n_step:
            message = f"{self.path}: there is no step {step}; the deck has {self.n_step}"
            raise FormatError(message)
        keywords = [
            k
            for k in self.keywords
            if k.step == chosen or (k.step < chosen and k.step not in aside)
        ]
        return replace(self, keywords=keywords, n_step=chosen)

    def groups(self, head: str, *members: str) -> Iterator[tuple[Keyword, list[Keyword]]]:
        """Return each head with the members that follow it."""
        groups: list[tuple[Keyword, list[Keyword]]] = []
        for keyword in self.keywords:
            if keyword.name == head:
                groups.append((keyword, []))
            elif keyword.name in members and groups:
                if any(member.name == keyword.name for member in groups[-1][1]):
                    keyword.refuse(f"the *{head} above has one already; remove one of them")
                groups[-1][1].append(keyword)
            elif keyword.name in members:
                keyword.refuse(f"it must follow *{head}")
        return iter(groups)


def read_keyword_deck(path: Path, ignore: frozenset[str] = frozenset()) -> Deck:
    """Read a deck into keywords, whose data nobody has looked at."""
    keywords = instantiated(read_keywords(read_spans(path)))
    if not keywords:
        message = f"{path}: the deck is empty; it needs *NODE, *ELEMENT, …"
        raise FormatError(message)
    numbered, step, inside = [], 0, False
    for keyword in keywords:
        if keyword.name == "STEP":
            if inside:
                keyword.refuse("a step before this one does not end; add *END STEP")
            step, inside = step + 1, True
        numbered.append(replace(keyword, step=step if inside else 0))
        if keyword.name == "END STEP":
            if not inside:
                keyword.refuse("there is no *STEP that it ends")
            inside = False
    _check_order(numbered)
    return Deck(keywords=numbered, n_step=step, path=path, ignore=ignore)


def _check_order(keywords: Sequence[Keyword]) -> None:
    """Refuse model data after a step; both programs do."""
    steps = np.array([keyword.step for keyword in keywords])
    inside = np.flatnonzero(steps)
    if not inside.size:
        return
    for keyword in keywords[int(inside[0]) :]:
        if keyword.step == 0:
            keyword.refuse("it stands between or behind steps; move it before the first *STEP")
