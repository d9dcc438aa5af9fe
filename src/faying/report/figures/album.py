"""Pictures of a run: drawn and saved when a page asks for them."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from faying.files.atomic import writing
from faying.files.names import file_names
from faying.report.style import house_style, save
from faying.study.results.values import CaseResult, Results

PHONE = 2.4
"""Width over height from which a picture cannot be read at the width of a phone."""


@dataclass(frozen=True, kw_only=True)
class FigureEntry:
    """One figure of a report.

    Attributes
    ----------
    path
        The PNG file.
    title
        What it shows, in a few words.
    caption
        How to read it, with the numbers that matter.
    wide
        Whether it is too wide to be read when it is shrunk to the width of a phone.
    """

    path: Path
    title: str
    caption: str
    wide: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Drawn:
    """A figure before it is saved.

    Attributes
    ----------
    figure
    stem
        Which picture it is, as ``"pressure"``.
    title, caption
        As in :class:`FigureEntry`.
    """

    figure: Figure
    stem: str
    title: str
    caption: str


@dataclass(frozen=True, eq=False)
class Album:
    """The pictures of a run, as PNG in a folder.

    Attributes
    ----------
    results
    folder
        Made if it does not exist; without one nothing is drawn.
    """

    results: Results
    folder: Path | None = None

    def shown(
        self,
        *draws: Callable[..., Drawn | None],
        of: Iterable[CaseResult | str] | None = None,
    ) -> list[FigureEntry]:
        """Draw and save pictures, atomically, one at a time so that only one is in memory.

        They are of the whole run; or ``of`` load cases, and of harmonic loads by their names.
        Functions that have nothing to draw return None.

        Raises
        ------
        FormatError
            If they cannot be written.
        """
        if self.folder is None:
            return []
        with writing(self.folder), house_style():
            self.folder.mkdir(parents=True, exist_ok=True)
            return [
                _saved(drawn, self.folder / f"{stem}{drawn.stem}.png")
                for stem, subject in ([("", ())] if of is None else self._named(of))
                for draw in draws
                if (drawn := draw(self.results, *subject)) is not None
            ]

    def _named(
        self, of: Iterable[CaseResult | str]
    ) -> Iterator[tuple[str, tuple[CaseResult | str]]]:
        """Yield how files about load cases and harmonic loads begin."""
        cases, frequencies = file_names(self.results.cases), file_names(self.results.frequencies)
        for subject in of:
            if isinstance(subject, str):
                yield f"frequency_{frequencies[subject]}_", (subject,)
            else:
                yield f"case_{cases[subject.name]}_", (subject,)


def _saved(drawn: Drawn, path: Path) -> FigureEntry:
    width, height = save(drawn.figure, path)
    wide = width > PHONE * height
    return FigureEntry(path=path, title=drawn.title, caption=drawn.caption, wide=wide)
