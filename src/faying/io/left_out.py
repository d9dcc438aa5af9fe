"""Parts of a deck that are not read or not written: one rule for all programs.

Parts that do not affect a linear structure with contact are left out with a note.
Parts that change stiffness, mass, supports or contact are left out only on request by one
of the words of :data:`IGNORABLE`. All other parts are refused, in one message.
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
        "temperature": "nothing expands; materials are as at the reference temperature",
    }
)
"""Words that leave parts out on request, and the consequence of each."""


@dataclass(frozen=True, kw_only=True)
class Occurrence:
    """Keywords or cards of one name.

    Attributes
    ----------
    name
        ``"TIE"``, ``"CROD"``; with an addition where the name alone is ambiguous.
    where
        File and line of the first occurrence.
    """

    name: str
    count: int
    where: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Handling:
    """Treatment of names that a reader does not read.

    Attributes
    ----------
    what, mark
        The program's term, ``"keyword"`` or ``"card"``, and the sign before names.
    harmless
        Names to the consequence of leaving them out.
    on_request
        Names to the words of :data:`IGNORABLE` that leave them out.
    remedies
        Names to the remedy.
    unknown
        Remedy for any other name.
    """

    what: str
    mark: str = ""
    harmless: Mapping[str, str]
    on_request: Mapping[str, str]
    remedies: Mapping[str, str]
    unknown: str

    def names(self) -> list[str]:
        """Return all names listed in any of the mappings."""
        return [*self.harmless, *self.on_request, *self.remedies]

    def notes(
        self, occurrences: Iterable[Occurrence], ignore: Collection[str], path: Path
    ) -> list[str]:
        """Return one note for each consequence, with all names left out for it."""
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
        """Return one line for one name, else a heading and the names under each remedy."""
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
    """Return the advice to leave something out, with the consequence."""
    return f'remove it, or leave it out by ignore = ["{word}"]: {IGNORABLE[word]}'


def checked_ignore(words: Iterable[str]) -> frozenset[str]:
    """Return the words of an ``ignore`` argument; refuse unknown ones."""
    chosen = frozenset([words] if isinstance(words, str) else words)
    unknown = sorted(chosen - IGNORABLE.keys())
    if unknown:
        refuse(f"ignore: '{unknown[0]}' is unknown; expected some of {', '.join(IGNORABLE)}")
    return chosen


def refuse_unwritten(assembly: Assembly) -> None:
    """Refuse an assembly with elements that no deck writer supports."""
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
            "export the reduced model instead, or write only solids, beams, springs and couplings"
        )


def write_whole(path: str | PathLike[str], text: str) -> None:
    """Write a deck completely or not at all."""
    with replacing(Path(path)) as temporary:
        temporary.write_text(text, encoding="ascii", errors="replace")
