"""Loads in force in each step of a deck."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TypeVar

from faying.io.abaqus.deck import Deck
from faying.io.abaqus.keyword import Keyword

Key = TypeVar("Key")
Value = TypeVar("Value")


def in_force(
    deck: Deck,
    names: Sequence[str],
    read: Callable[[Keyword], Iterable[tuple[Key, Value]]],
) -> Iterator[dict[Key, list[tuple[Value, Keyword]]]]:
    """Yield the loads of keywords that are in force, step by step from 0, and what each is of.

    A later step replaces what it names again; within a step values add up. OP=NEW removes what
    earlier steps left by keywords of that name, and none of it acts in a linear perturbation.
    ``read`` yields what a keyword loads, and how.
    """
    loads: dict[Key, list[tuple[Value, Keyword]]] = {}
    for step in range(deck.n_step + 1):
        loads = {} if step in deck.perturbations else loads
        new: dict[Key, list[tuple[Value, Keyword]]] = {}
        for keyword in (k for k in deck.of(*names) if k.step == step):
            keyword.check()
            if keyword.choice("OP") == "NEW":
                loads = {k: v for k, v in loads.items() if v[0][1].name != keyword.name}
            for key, value in read(keyword):
                new.setdefault(key, []).append((value, keyword))
        loads = {**loads, **new}
        yield loads
