"""Line numbers of the keys and array entries of a TOML text; tomllib does not report them."""

import re
from dataclasses import dataclass, field

Location = tuple[str | int, ...]
"""Keys and zero-based array indices from the top of a file, e.g. ``("bolt", 0, "preload")``."""

TOKEN = re.compile(
    r'(?P<skip>[ \t\r]+|#[^\n]*)|(?P<newline>\n)|(?P<text>"""(?:\\.|[^\\])*?"{3,5}'
    r"|'''.*?'{3,5}|\"(?:\\.|[^\"\\\n])*\"|'[^'\n]*')|(?P<mark>[\[\]{}=,.])"
    r"|(?P<bare>[^\s\[\]{}=,.#\"']+)",
    re.DOTALL,
)


@dataclass(frozen=True)
class Token:
    """A piece of TOML and the line it starts on."""

    kind: str
    text: str
    line: int


@dataclass
class _Scanner:
    """Reading head over the tokens of a text that tomllib has accepted."""

    tokens: list[Token]
    lines: dict[Location, int] = field(default_factory=dict)
    counts: dict[Location, int] = field(default_factory=dict)
    at: int = 0

    @property
    def token(self) -> Token:
        return self.tokens[self.at]

    def take(self) -> Token:
        token = self.token
        self.at += 1
        return token

    def skip_newlines(self) -> None:
        while self.token.kind == "newline":
            self.at += 1

    def key(self) -> tuple[str, ...]:
        parts = []
        while self.token.kind in ("bare", "text") or self.token.text == ".":
            token = self.take()
            if token.text != ".":
                parts.append(token.text[1:-1] if token.kind == "text" else token.text)
        return tuple(parts)

    def record(self, location: Location, line: int) -> None:
        self.lines.setdefault(location, line)

    def absolute(self, key: tuple[str, ...]) -> Location:
        """Insert the running number after every name that is an array of tables."""
        location: Location = ()
        for name in key:
            location = (*location, name)
            if location in self.counts:
                location = (*location, self.counts[location])
        return location

    def document(self) -> dict[Location, int]:
        table: Location = ()
        self.skip_newlines()
        while self.token.kind != "end":
            if self.token.text == "[" and self.token.kind == "mark":
                table = self.header()
            else:
                self.entry(table)
            self.skip_newlines()
        return self.lines

    def header(self) -> Location:
        line = self.take().line
        array = self.token.text == "["
        self.at += array
        key = self.key()
        self.at += 1 + array
        if array:
            name = (*self.absolute(key[:-1]), key[-1])
            self.counts[name] = self.counts.get(name, -1) + 1
            self.record(name, line)
        location = self.absolute(key)
        self.record(location, line)
        return location

    def entry(self, table: Location) -> None:
        line = self.token.line
        location = (*table, *self.key())
        self.record(location, line)
        self.at += 1
        self.value(location)

    def value(self, location: Location) -> None:
        self.skip_newlines()
        opening = self.token.text if self.token.kind == "mark" else ""
        if opening == "[":
            self.items(location, "]")
        elif opening == "{":
            self.items(location, "}")
        else:
            while self.token.kind in ("bare", "text") or self.token.text == ".":
                self.at += 1

    def items(self, location: Location, closing: str) -> None:
        self.at += 1
        number = 0
        while True:
            self.skip_newlines()
            if self.token.text == closing and self.token.kind == "mark":
                break
            if closing == "}":
                self.entry(location)
            else:
                self.record((*location, number), self.token.line)
                self.value((*location, number))
                number += 1
            self.skip_newlines()
            self.at += self.token.text == ","
        self.at += 1


def line_numbers(text: str) -> dict[Location, int]:
    r"""Return the line (from 1) of every table, key and array entry of a valid TOML text.

    Examples
    --------
    >>> line_numbers("[[bolt]]\nname = 'M6'\n")[("bolt", 0, "name")]
    2
    """
    tokens, line = [], 1
    for match in TOKEN.finditer(text):
        kind = str(match.lastgroup)
        if kind != "skip":
            tokens.append(Token(kind, match.group(), line))
        line += match.group().count("\n")
    tokens.append(Token("end", "", line))
    return _Scanner(tokens).document()
