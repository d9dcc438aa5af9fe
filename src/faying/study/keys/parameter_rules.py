"""What parameters of a study must be: numbers that it has, in ranges."""

import tomllib
from collections.abc import Iterator

from faying.study.keys.errors import Problem
from faying.study.keys.parameter_tables import Steps, steps_to, value_at
from faying.study.keys.tables import Study


def parameter_problems(study: Study) -> Iterator[Problem]:
    """Find parameters that are no numbers of the study, and ranges that are none."""
    tables = tomllib.loads(study.text)
    used: dict[Steps, str] = {}
    for number, section in enumerate(study.parameters):
        wrong: dict[str, str] = {}
        if not section.range[0] < section.range[1]:
            wrong["range"] = f"found {list(section.range)}, expected the smaller number first"
        if section.name in [earlier.name for earlier in study.parameters[:number]]:
            wrong["name"] = f"two parameters are called '{section.name}'; names must differ"
        for key in section.keys:
            try:
                steps = steps_to(key, tables)
            except LookupError as error:
                wrong["keys"] = str(error)
                continue
            if steps[-1] == "friction" and not section.range[0] > 0:
                wrong["range"] = "without friction a joint has no backbone; begin above 0"
            if steps in used:
                wrong["keys"] = f"'{key}' belongs to parameter '{used[steps]}' already; remove it"
            elif isinstance(value_at(steps[:-1], tables), dict):
                used[steps] = section.name
            else:
                wrong["keys"] = f"the study has no table that '{key}' stands in; add it"
        yield from study.problems(("parameter", number), wrong)
