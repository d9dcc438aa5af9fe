"""Rules for the keys of a bolt."""

from faying.exceptions import ModelError
from faying.sources import SOURCES
from faying.study.keys.errors import Mistakes
from faying.study.keys.model_tables import BoltSection
from faying.study.keys.requirement_tables import MarginsSection
from faying.study.keys.tables import Study
from faying.study.keys.threads import final_force, thread_of


def bolt_problems(study: Study, bolt: BoltSection) -> Mistakes:
    """Yield that a bolt has no place or preload, and contradictory keys."""
    source = SOURCES[study.model.source]
    ways = [key for key in ("elements", "nodes", "axis") if getattr(bolt, key) is not None]
    if not ways and not source.has_joint:
        text = "found none, expected one of 'elements', 'nodes' or 'axis'"
        yield "", f"{text}; place bolt '{bolt.name}' by one of them"
    yield from _placed_bolt(bolt) if source.has_elements else _matrix_bolt(bolt)
    yield from _sized_bolt(study, bolt)
    if not any(getattr(bolt, key) is not None for key in TIGHTENED) and (
        ways or not source.is_deck
    ):
        text = (
            "missing key 'preload', the bolt's final force (0 if not tightened), 'torque', "
            "'utilisation' or 'initial_force'; add one"
        )
        yield "", text


TIGHTENED = ("preload", "torque", "utilisation", "initial_force")
"""Keys that state how a bolt is tightened; a bolt has one of them."""


def _sized_bolt(study: Study, bolt: BoltSection) -> Mistakes:
    """Yield problems of keys that depend on the size and the grade of a bolt."""
    judged = bolt.thread is not None or bolt.grade is not None or bolt.strength is not None
    for key in JUDGED:
        named = bolt.size is not None or bolt.thread is not None
        if getattr(bolt, key) is not None and not (named and judged):
            yield key, 'it needs the bolt\'s size and grade; add size = "M8" and grade = "8.8"'
            return
    for key in ("head", "hole"):
        if key in bolt.model_fields_set and bolt.size is None:
            yield key, 'it needs a size; add size = "M8"'
    try:
        thread = thread_of(bolt, study.units)
        final_force(bolt, study.units)
    except ModelError as error:
        yield "", f"bolt '{bolt.name}': {error}"
        return
    if bolt.axis is None and any(bolt.end_masses):
        yield "end_masses", "only a bolt given by its axis has end masses; add a [[mass]] instead"
    faced = thread is not None and thread.bearing is not None
    if bolt.head_pressure_limit is not None and not faced:
        text = "the area under the head is unknown; add washer_radius and hole"
        yield "head_pressure_limit", text
    missing = [
        key
        for key, source in (("diameter", bolt.size), ("washer_radius", faced))
        if bolt.axis and not getattr(bolt, key) and not source
    ]
    if missing:
        yield "", f"a bolt given by its axis needs {' and '.join(map(repr, missing))}; add it"


JUDGED = (
    "grade", "strength", "torque", "utilisation", "thread_friction", "head_friction", "hole",
    "head_pressure_limit", "engagement",
)  # fmt: skip
"""Keys of a bolt that need its size and grade."""


NASA_KEYS = ("FF", "FS_u", "FS_y", "FS_sep", "FS_slip", "shear_plane", "separation_critical")
VDI_KEYS = ("S_F", "S_D", "S_p")
"""Design factors of each standard of margins."""


def margin_problems(_: Study, margins: MarginsSection) -> Mistakes:
    """Yield design factors that the chosen standard does not have."""
    others = VDI_KEYS if margins.standard == "nasa-std-5020b" else NASA_KEYS
    for key in margins.model_fields_set.intersection(others):
        yield key, f'standard = "{margins.standard}" has no such factor; remove it'


def _placed_bolt(bolt: BoltSection) -> Mistakes:
    """Yield keys that only bolts of matrices have."""
    for key in ("stiffness", "direction"):
        if getattr(bolt, key) is not None:
            yield key, f"only bolts of source 'matrices' have a {key}; remove it"


def _matrix_bolt(bolt: BoltSection) -> Mistakes:
    """Yield problems of keys that bolts of matrices have, or cannot have."""
    if bolt.axis is not None or bolt.elements is not None:
        text = (
            "matrices have no elements or solids to bolt; give nodes = [head, nut] and the "
            "'stiffness' EA/L that K contains between them"
        )
        yield "", text
    elif bolt.nodes is not None and len(bolt.nodes) != 2:
        yield "nodes", f"found {len(bolt.nodes)} nodes, expected two: the head's and the nut's"
    elif bolt.nodes is not None and bolt.stiffness is None:
        yield "", "a bolt in matrices needs 'stiffness', the EA/L that K contains; add it"
