"""What becomes of the parts of a deck that are not read, or not written: one rule for all programs.

What says nothing about a linear structure with contact is left out, and what that means is noted.
What changes stiffness, mass, supports or contact is left out only if the user asks for it by one
of the words of :data:`IGNORABLE`; without that, and all else, is refused: everything at once.
"""

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from types import MappingProxyType

from faying.exceptions import FormatError, refuse
from faying.files.atomic import replacing
from faying.model.assembly import Assembly

IGNORABLE: Mapping[str, str] = MappingProxyType(
    {
        "plastic": "materials stay linear elastic at any stress",
        "friction": "surfaces that touch slide freely",
        "temperature": "nothing expands, and materials are those of the reference temperature",
    }
)
"""What is left out on request only, and what that means."""


@dataclass(frozen=True, kw_only=True)
class Occurrence:
    """Keywords or cards of one name.

    Attributes
    ----------
    name
        ``"TIE"``, ``"CROD"``; with what tells it from others where that matters.
    where
        File and line of the first.
    """

    name: str
    count: int
    where: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Handling:
    """What happens to names that a reader does not read.

    Attributes
    ----------
    what, mark
        What the program calls them, ``"keyword"``, ``"card"``, and what it puts before their names.
    harmless
        Name to what leaving it out means.
    on_request
        Name to the word of :data:`IGNORABLE` that leaves it out.
    remedies
        Name to what to do instead.
    unknown
        What to do about a name that is none of these.
    """

    what: str
    mark: str = ""
    harmless: Mapping[str, str]
    on_request: Mapping[str, str]
    remedies: Mapping[str, str]
    unknown: str

    def names(self) -> list[str]:
        """Return all names that something is known about."""
        return [*self.harmless, *self.on_request, *self.remedies]

    def notes(
        self, occurrences: Iterable[Occurrence], ignore: Collection[str], path: Path
    ) -> list[str]:
        """Return what is left out and what that means, a note for each meaning."""
        left_out: dict[str, list[Occurrence]] = defaultdict(list)
        refused: dict[str, list[Occurrence]] = defaultdict(list)
        for entry in occurrences:
            word = self.on_request.get(entry.name)
            if entry.name in self.harmless:
                left_out[self.harmless[entry.name]].append(entry)
            elif word is not None and word in ignore:
                left_out[f"{IGNORABLE[word]} (ignore = {word})"].append(entry)
            elif word is not None:
                refused[request(word)].append(entry)
            else:
                refused[self.remedies.get(entry.name, self.unknown)].append(entry)
        if refused:
            raise FormatError(self._message(refused, path))
        return [
            f"{', '.join(f'{entry.count} {self.mark}{entry.name}' for entry in group)}: {meaning}"
            for meaning, group in left_out.items()
        ]

    def _message(self, refused: Mapping[str, list[Occurrence]], path: Path) -> str:
        """Return one line for one name, else a heading and the names under what to do."""
        groups = list(refused.items())
        problem = "not supported and may change the structure"
        if len(groups) == 1 and len(groups[0][1]) == 1:
            remedy, (entry,) = groups[0]
            times = f" ({entry.count} of them)" if entry.count > 1 else ""
            name = f"{self.mark}{entry.name}"
            return f"{entry.where}: {name}: the {self.what} is {problem}{times}; {remedy}"
        count = sum(len(group) for _, group in groups)
        lines = [f"{path}: {count} kinds of {self.what}s are {problem}:"]
        for remedy, group in groups:
            lines.append(f"  {remedy}:")
            lines += [
                f"    {entry.where}: {self.mark}{entry.name} ({entry.count})" for entry in group
            ]
        return "\n".join(lines)


def request(word: str) -> str:
    """Return how to have something left out, and what that means."""
    return f'remove it, or leave it out by ignore = ["{word}"]: {IGNORABLE[word]}'


def checked_ignore(words: Iterable[str]) -> frozenset[str]:
    """Return the words of an ``ignore`` argument."""
    chosen = frozenset([words] if isinstance(words, str) else words)
    unknown = sorted(chosen - IGNORABLE.keys())
    if unknown:
        refuse(f"ignore: '{unknown[0]}' is not known; known are {', '.join(IGNORABLE)}")
    return chosen


def refuse_unwritten(assembly: Assembly) -> None:
    """Refuse an assembly with elements that no deck writer knows."""
    kinds: Mapping[str, Collection[object]] = {
        "matrices from another program": [m for m in [assembly.matrices] if m is not None],
        "shells": assembly.shells,
        "bushes": assembly.bushes,
        "scalar masses": assembly.scalar_masses,
        "average couplings of different components": [
            item for item in assembly.average_couplings if item.entering is not None
        ],
        "materials whose directions differ": [
            item for item in assembly.materials.values() if item.law is not None
        ],
    }
    unwritten = [name for name, family in kinds.items() if family]
    if unwritten:
        refuse(
            f"the assembly has {' and '.join(unwritten)}, which faying reads but does not write; "
            "export the reduced model instead, or write solids, beams, springs and couplings alone"
        )


def write_whole(path: str | PathLike[str], text: str) -> None:
    """Write a deck, which appears complete or not at all."""
    with replacing(Path(path)) as temporary:
        temporary.write_text(text, encoding="ascii", errors="replace")
