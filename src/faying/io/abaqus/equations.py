"""``*EQUATION``: linear equations between degrees of freedom."""

from collections.abc import Iterator

from faying.io.abaqus.deck import Deck
from faying.io.abaqus.dofs import Dofs, component
from faying.io.abaqus.fields import integer, real
from faying.io.abaqus.keyword import Keyword
from faying.model.assembly import Equation

Term = tuple[int, int, float]


def read_equations(deck: Deck, dofs: Dofs) -> Iterator[Equation]:
    """Read all *EQUATION; the first term is the one that is eliminated."""
    number = 0
    for keyword in deck.of("EQUATION"):
        keyword.check()
        rows = keyword.rows()
        row = 0
        while row < len(rows):
            count = integer(keyword, row, rows[row][0], "the number of terms")
            start, row = row, row + 1
            if count < 1 or len(rows[start]) != 1:
                keyword.refuse("expected the number of terms alone on this line", start)
            fields: list[tuple[int, list[str]]] = []
            while row < len(rows) and len(fields) < count:
                if len(rows[row]) % 3:
                    keyword.refuse(
                        "expected node, degree of freedom, coefficient for each term", row
                    )
                fields += [(row, rows[row][i : i + 3]) for i in range(0, len(rows[row]), 3)]
                row += 1
            if len(fields) != count:
                keyword.refuse(f"found {len(fields)} terms, expected {count}", start)
            for terms in _per_node(keyword, fields, dofs):
                number += 1
                yield Equation(id=number, terms=terms)


def _per_node(
    keyword: Keyword, fields: list[tuple[int, list[str]]], dofs: Dofs
) -> Iterator[tuple[Term, ...]]:
    """One equation; or several, where the terms are node sets that are taken member by member."""
    nodes = [dofs.find(keyword, row, label).tolist() for row, (label, _, _) in fields]
    count = len(nodes[0])
    for (row, _), members in zip(fields, nodes, strict=True):
        if len(members) not in (1, count) or (count > 1 and members != sorted(members)):
            keyword.refuse(f"a set of {len(members)} nodes where the first term has {count}", row)
    for i in range(count):
        terms: list[Term] = []
        for (row, (_, dof, text)), members in zip(fields, nodes, strict=True):
            node = members[i] if len(members) > 1 else members[0]
            value = real(keyword, row, text, "a coefficient")
            terms += _term(node, component(keyword, row, dof), value, dofs)
        yield tuple(terms)


def _term(node: int, c: int, value: float, dofs: Dofs) -> list[Term]:
    axes = dofs.axes(node)
    if axes is None:
        return [(*dofs.place(node, c), value)]
    first = 3 * (c // 3)
    turned = [(node, first + k, value * float(axes[c % 3, k])) for k in range(3)]
    # The largest comes first, for the first term of an equation is eliminated.
    return sorted((t for t in turned if t[2] != 0.0), key=lambda term: -abs(term[2]))
