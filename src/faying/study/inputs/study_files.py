"""A study together with the files that it names."""

import tomllib
from collections.abc import Iterator
from contextlib import suppress
from hashlib import blake2b, file_digest

from faying.study.keys.tables import Study


def study_mark(study: Study) -> str:
    """Return a hash of a study and of the files that it names."""
    digest = blake2b(study.text.encode(), digest_size=16)
    for text in _texts(tomllib.loads(study.text)):
        path = study.path.parent / text
        # Most texts name no file; systems refuse some as paths, such as long titles.
        with suppress(OSError, ValueError), path.open("rb") as file:
            digest.update(file_digest(file, "blake2b").digest())
    return digest.hexdigest()


def _texts(value: object) -> Iterator[str]:
    """Yield the texts of a table, at any depth."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for member in value.values():
            yield from _texts(member)
    elif isinstance(value, list):
        for member in value:
            yield from _texts(member)
