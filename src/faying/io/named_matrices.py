"""Which of several named matrices in a Nastran file is M, C or K."""

from collections.abc import Sequence

LETTERS = {"M": "M", "K": "K", "C": "B"}
"""First letter of Nastran's names (KGG, MAA, BXX) per matrix."""

SQUARE, RECTANGULAR, SYMMETRIC = 1, 2, 6
"""Forms of Nastran's matrices that store every entry."""

REAL_DOUBLE = 2
"""Nastran's type of doubles."""


class DamageError(ValueError):
    """What is wrong in a file, and where; the name of the file is added on the way out."""


def chosen_name(names: Sequence[str], letter_name: str) -> str:
    """Return the name of the matrix ``"M"``, ``"C"`` or ``"K"``.

    It is that very name; else the only one; else the only one that begins with the letter Nastran
    uses (M, B for damping, K).
    """
    exact = [name for name in names if name.upper() == letter_name.upper()]
    letter = LETTERS.get(letter_name, letter_name)
    for candidates in (exact, names, [name for name in names if name.upper().startswith(letter)]):
        if len(candidates) == 1:
            return candidates[0]
    message = (
        f"it holds {', '.join(names) or 'no matrix'}; expected one matrix, or one whose name "
        f"begins with {letter}; write {letter_name} to a file of its own"
    )
    raise DamageError(message)
