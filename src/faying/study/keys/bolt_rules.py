"""Rules for the keys of a bolt."""

from collections.abc import Iterator

from faying.exceptions import ModelError
from faying.sources import SOURCES
from faying.study.keys.errors import Location, Problem
from faying.study.keys.tables import Study
from faying.study.keys.threads import final_force, thread_of


def bolt_problems(study: Study) -> Iterator[Problem]:
    """Yield problems of bolts without a place or preload, and of contradictory keys."""
    for i, bolt in enumerate(study.bolts):
        location: Location = ("bolt", i)
        ways = [key for key in ("elements", "nodes", "axis") if getattr(bolt, key) is not None]
        if not ways and not SOURCES[study.model.source].has_joint:
            text = "found none, expected one of 'elements', 'nodes' or 'axis'"
            yield study.in_table(location, f"{text}; place bolt '{bolt.name}' by one of them")
        yield from _matrix_bolt(study, i)
        tightened = [key for key in TIGHTENED if getattr(bolt, key) is not None]
        yield from _sized_bolt(study, i)
        if not tightened and (ways or not SOURCES[study.model.source].is_deck):
            text = (
                "missing key 'preload', the bolt's final force (0 if not tightened), 'torque', "
                "'utilisation' or 'initial_force'; add one"
            )
            yield study.in_table(location, text)


TIGHTENED = ("preload", "torque", "utilisation", "initial_force")
"""Keys that state how a bolt is tightened; a bolt has one of them."""


def _sized_bolt(study: Study, number: int) -> Iterator[Problem]:
    """Yield problems of keys that depend on the size and the grade of a bolt."""
    bolt, location = study.bolts[number], ("bolt", number)
    judged = bolt.thread is not None or bolt.grade is not None or bolt.strength is not None
    for key in JUDGED:
        named = bolt.size is not None or bolt.thread is not None
        if getattr(bolt, key) is not None and not (named and judged):
            text = 'it needs the bolt\'s size and grade; add size = "M8" and grade = "8.8"'
            yield study.problem((*location, key), text)
            return
    for key in ("head", "hole"):
        if key in bolt.model_fields_set and bolt.size is None:
            yield study.problem((*location, key), 'it needs a size; add size = "M8"')
    try:
        thread = thread_of(bolt, study.units)
        final_force(bolt, study.units)
    except ModelError as error:
        yield study.in_table(location, f"bolt '{bolt.name}': {error}")
        return
    if bolt.axis is None and any(bolt.end_masses):
        text = "only a bolt given by its axis has end masses; add a [[mass]] instead"
        yield study.problem((*location, "end_masses"), text)
    faced = thread is not None and thread.bearing is not None
    if bolt.head_pressure_limit is not None and not faced:
        text = "the area under the head is unknown; add washer_radius and hole"
        yield study.problem((*location, "head_pressure_limit"), text)
    missing = [
        key
        for key, source in (("diameter", bolt.size), ("washer_radius", faced))
        if bolt.axis and not getattr(bolt, key) and not source
    ]
    if missing:
        text = f"a bolt given by its axis needs {' and '.join(map(repr, missing))}; add it"
        yield study.in_table(location, text)


JUDGED = (
    "grade", "strength", "torque", "utilisation", "thread_friction", "head_friction", "hole",
    "head_pressure_limit", "engagement",
)  # fmt: skip
"""Keys of a bolt that need its size and grade."""


NASA_KEYS = ("FF", "FS_u", "FS_y", "FS_sep", "FS_slip", "shear_plane", "separation_critical")
VDI_KEYS = ("S_F", "S_D", "S_p")
"""Design factors of each standard of margins."""


def margin_problems(study: Study) -> Iterator[Problem]:
    """Yield design factors that the chosen standard does not have."""
    margins = study.requirement.margins
    if margins is None:
        return
    others = VDI_KEYS if margins.standard == "nasa-std-5020b" else NASA_KEYS
    for key in margins.model_fields_set.intersection(others):
        text = f'standard = "{margins.standard}" has no such factor; remove it'
        yield study.problem(("requirement", "margins", key), text)


def _matrix_bolt(study: Study, number: int) -> Iterator[Problem]:
    """Yield problems of keys that only bolts of matrices have, and must have."""
    bolt, location = study.bolts[number], ("bolt", number)
    if SOURCES[study.model.source].has_elements:
        for key in ("stiffness", "direction"):
            if getattr(bolt, key) is not None:
                text = f"only bolts of source 'matrices' have a {key}; remove it"
                yield study.problem((*location, key), text)
        return
    if bolt.axis is not None or bolt.elements is not None:
        text = (
            "matrices have no elements or solids to bolt; give nodes = [head, nut] and the "
            "'stiffness' EA/L that K contains between them"
        )
        yield study.in_table(location, text)
    elif bolt.nodes is not None and len(bolt.nodes) != 2:
        text = f"found {len(bolt.nodes)} nodes, expected two: the head's and the nut's"
        yield study.problem((*location, "nodes"), text)
    elif bolt.nodes is not None and bolt.stiffness is None:
        text = "a bolt in matrices needs 'stiffness', the EA/L that K contains; add it"
        yield study.in_table(location, text)
