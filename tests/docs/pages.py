"""The pages of the documentation and the code in them."""

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted([*ROOT.glob("*.md"), *DOCS.rglob("*.md")])

FENCE = re.compile(r"^```(\w+)([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Block:
    """A fenced code block: language, the words after it, its text and its line."""

    language: str
    words: str
    text: str
    line: int


def blocks(page: Path) -> list[Block]:
    """Code blocks of a page in their order."""
    text = page.read_text(encoding="utf-8")
    return [
        Block(
            language=match[1],
            words=match[2].strip(),
            text=match[3],
            line=text[: match.start()].count("\n") + 1,
        )
        for match in FENCE.finditer(text)
    ]
