"""Decks for readers, written where they are read."""

import pytest

from faying.io.nastran import read_joint


@pytest.fixture
def nastran(tmp_path):
    """Return a function that reads a Nastran deck of texts, each of them whole lines."""

    def read(*texts, **chosen):
        path = tmp_path / "a.bdf"
        path.write_text("".join(text if text.endswith("\n") else f"{text}\n" for text in texts))
        return read_joint(path, **chosen)

    return read
