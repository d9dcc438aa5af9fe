"""Element routines of Ansys: which are read as what, and what to do about the others."""

from collections.abc import Mapping

BRICKS_8 = frozenset((45, 185))
BRICKS_20 = frozenset((95, 186))
TETRAHEDRA_10 = frozenset((92, 187))
NO_STRUCTURE = frozenset((151, 152, 153, 154, 200))
"""MESH200 only carries a mesh, SURF151 to SURF154 only loads."""

CONTACTS, TARGETS = frozenset((173, 174)), frozenset((170,))

_JOINED = "what they join moves apart here; couple a face by [[boundary]], or use .full matrices"
_STRUCTURE = "model them as solids, or use .full matrices"
_SPRINGS = "they are not there; use .full matrices"

OTHERS: Mapping[int, tuple[str, str]] = {
    14: ("COMBIN14", _SPRINGS),
    21: ("MASS21", "they are not there; use .full matrices"),
    39: ("COMBIN39", _SPRINGS),
    40: ("COMBIN40", _SPRINGS),
    180: ("LINK180", _STRUCTURE),
    181: ("SHELL181", _STRUCTURE),
    281: ("SHELL281", _STRUCTURE),
    63: ("SHELL63", _STRUCTURE),
    188: ("BEAM188", "bolts are made by [[bolt]] with an axis; else use .full matrices"),
    189: ("BEAM189", "bolts are made by [[bolt]] with an axis; else use .full matrices"),
    4: ("BEAM4", "bolts are made by [[bolt]] with an axis; else use .full matrices"),
    184: ("MPC184", _JOINED),
    175: ("CONTA175", _JOINED),
    176: ("CONTA176", _JOINED),
    177: ("CONTA177", _JOINED),
    178: ("CONTA178", "contact is between surfaces; name their sides in an [[interface]]"),
    179: (
        "PRETS179",
        "the bolts are parted at their sections and nothing closes these; delete the sections and "
        "merge the nodes (NUMMRG) before CDWRITE, and tighten by [[bolt]] with an axis",
    ),
    190: ("SOLSH190", "change them to SOLID185"),
    285: ("SOLID285", "change them to SOLID187"),
    65: ("SOLID65", "change them to SOLID185"),
}
"""Routines that are left out: names, and what to do."""

_BRICK_OPTIONS: Mapping[tuple[int, int, int], str] = {
    (185, 2, 0): "selective reduced integration (B-bar), stiffer in bending than here",
    (185, 2, 1): "uniform reduced integration, softer in bending than here",
    (45, 1, 1): "no extra shapes, stiffer in bending than here",
    (45, 2, 1): "uniform reduced integration, softer in bending than here",
}
"""Routine, key option and its value to what Ansys does with bricks of eight nodes."""

_OPTIONS_TOLD = {185: (2,), 45: (1, 2)}


def is_reduced(routine: int, options: Mapping[int, int]) -> bool:
    """Whether bricks of twenty nodes have eight points: SOLID186 has unless KEYOPT(2) = 1."""
    return options.get(2, 0) != 1 if routine == 186 else options.get(11, 0) == 1


def brick_note(routine: int, options: Mapping[int, int]) -> str:
    """Return what Ansys does otherwise with bricks of eight nodes; nothing where it is as here."""
    for option in _OPTIONS_TOLD.get(routine, ()):
        value = options.get(option, 0)
        if meaning := _BRICK_OPTIONS.get((routine, option, value), ""):
            return (
                f"SOLID{routine} with KEYOPT({option}) = {value}: {meaning}, where bricks have "
                'incompatible modes; element = "standard" under [model] leaves these out'
            )
    return ""


def left_out_note(routine: int, count: int) -> str:
    """Return what is said of elements that are not read."""
    name, remedy = OTHERS.get(
        routine, (f"routine {routine}", "model them in the study, or use .full matrices")
    )
    return f"{count} elements {name}: {remedy}"
