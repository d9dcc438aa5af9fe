"""Lines of a deck, and the file and line each comes from."""

from dataclasses import dataclass

from faying._typing import Indices


@dataclass(frozen=True, eq=False, kw_only=True)
class Lines:
    """Consecutive lines and where each comes from.

    Attributes
    ----------
    text
        Without line ends.
    number, file : (n_line,)
        Line number, counted from 1, in the file ``files[file]``.
    """

    text: list[bytes]
    number: Indices
    file: Indices
    files: tuple[str, ...]

    def __getitem__(self, part: slice) -> "Lines":
        return Lines(
            text=self.text[part], number=self.number[part], file=self.file[part], files=self.files
        )

    def where(self, line: int) -> str:
        """Return file:line."""
        return f"{self.files[self.file[line]]}:{self.number[line]}"
