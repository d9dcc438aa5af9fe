"""Where in a study stands what the model builder complains of."""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager

from faying.exceptions import ModelError
from faying.study.keys.model_tables import BoltSection, BoundarySection, InterfaceSection
from faying.study.keys.tables import Study

_NAMED = re.compile(r"^(interface|bolt|boundary) '([^']+)'")


@contextmanager
def naming_tables(study: Study) -> Iterator[None]:
    """Say in front of complaints of interfaces, bolts and boundaries where the study has them.

    The model builder knows their names only; a deck's own have no table in the study.
    """
    try:
        yield
    except ModelError as error:
        named = _NAMED.match(str(error))
        if named is None:
            raise
        kind, name = named.groups()
        tables: Mapping[str, Sequence[InterfaceSection | BoltSection | BoundarySection]] = {
            "interface": study.interfaces,
            "bolt": study.bolts,
            "boundary": study.boundaries,
        }
        for number, section in enumerate(tables[kind]):
            if section.name == name:
                message = f"{study.source.table((kind, number))}: {error}"
                raise ModelError(message) from error
        raise
