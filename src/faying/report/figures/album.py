"""Figures of a run, drawn and saved for a page."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from faying.files.atomic import writing
from faying.files.names import file_names
from faying.report.style import house_style, save
from faying.study.results.values import CaseResult, Results

PHONE = 2.4
"""Width over height above which a figure is not legible at the width of a phone."""


@dataclass(frozen=True, kw_only=True)
class FigureEntry:
    """A figure of a report.

    Attributes
    ----------
    path
        The PNG file.
    title
        Title of a few words.
    caption
        Explanation, with the important numbers.
    wide
        Whether the figure is too wide for the width of a phone.
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
        Kind of the figure, such as ``"pressure"``.
    title, caption
        As in :class:`FigureEntry`.
    """

    figure: Figure
    stem: str
    title: str
    caption: str


@dataclass(frozen=True, eq=False)
class Album:
    """The figures of a run as PNG files in a folder.

    Attributes
    ----------
    results
    folder
        Folder of the files, made if it does not exist; None draws nothing.
    """

    results: Results
    folder: Path | None = None

    def shown(
        self,
        *draws: Callable[..., Drawn | None],
        of: Iterable[CaseResult | str] | None = None,
    ) -> list[FigureEntry]:
        """Draw and save figures, one at a time, and return their entries.

        The figures show the whole run, or the load cases and harmonic loads (by name) in ``of``.
        Functions with nothing to draw return None.

        Raises
        ------
        FormatError
            If a file cannot be written.
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
        """Yield the prefix of file names, and the arguments, of each load case or harmonic load."""
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
