"""Keywords and their parameters; blanks inside names may be left out, as in CalculiX."""

from collections.abc import Mapping
from dataclasses import dataclass

from faying.io.abaqus.left_out import KEYWORDS


def without_blanks(name: str) -> str:
    """Return a name in upper case without blanks."""
    return "".join(name.upper().split())


_TAKES: Mapping[str, str] = {
    "NODE": "NSET, SYSTEM=R|C|S, INPUT",
    "SYSTEM": "",
    "ELEMENT": "TYPE*, ELSET, DLOAD",
    "NSET": "NSET*, GENERATE, INSTANCE, INTERNAL, UNSORTED, ELSET, FREQUENCY",
    "ELSET": "ELSET*, GENERATE, INSTANCE, INTERNAL, UNSORTED",
    "SURFACE": "NAME*, TYPE=ELEMENT|NODE, INTERNAL",
    "PART": "NAME*",
    "INSTANCE": "NAME*, PART*",
    "TRANSFORM": "NSET*, TYPE=R|C|S",
    "ORIENTATION": "NAME*, SYSTEM=RECTANGULAR|R|CYLINDRICAL|C, DEFINITION=COORDINATES",
    "AMPLITUDE": "NAME*, TIME=STEP TIME|TOTAL TIME, VALUE=RELATIVE, DEFINITION=TABULAR, SHIFTX, "
    "SHIFTY, SMOOTH",
    "MATERIAL": "NAME*",
    "ELASTIC": "TYPE, MODULI",
    "DENSITY": "",
    "EXPANSION": "TYPE=ISOTROPIC|ISO, ZERO",
    "SOLID SECTION": "ELSET*, MATERIAL*, ORIENTATION, CONTROLS, STACK DIRECTION",
    "SHELL SECTION": "ELSET*, MATERIAL*, OFFSET, ORIENTATION, SECTION INTEGRATION, POISSON, "
    "DENSITY, CONTROLS",
    "BEAM SECTION": "ELSET*, MATERIAL*, SECTION*, POISSON, TEMPERATURE",
    "BEAM GENERAL SECTION": "ELSET*, SECTION=GENERAL, DENSITY, POISSON",
    "SPRING": "ELSET*",
    "MASS": "ELSET*, TYPE=ISOTROPIC",
    "ROTARY INERTIA": "ELSET*",
    "BOUNDARY": "OP=MOD|NEW, TYPE=DISPLACEMENT, AMPLITUDE, TIME DELAY, FIXED, NAME",
    "CLOAD": "OP=MOD|NEW, AMPLITUDE, TIME DELAY, LOAD CASE, OMEGA0, NAME",
    "DLOAD": "OP=MOD|NEW, AMPLITUDE, TIME DELAY, CONSTANT RESULTANT, NAME",
    "DSLOAD": "OP=MOD|NEW, AMPLITUDE, TIME DELAY, CONSTANT RESULTANT, NAME",
    "TEMPERATURE": "OP=MOD|NEW, AMPLITUDE, TIME DELAY, NAME",
    "INITIAL CONDITIONS": "TYPE",
    "EQUATION": "",
    "MPC": "",
    "RIGID BODY": "NSET, ELSET, REF NODE, ROT NODE, PIN NSET, TIE NSET, POSITION=INPUT",
    "COUPLING": "CONSTRAINT NAME, REF NODE*, SURFACE*, ORIENTATION",
    "KINEMATIC": "",
    "DISTRIBUTING": "COUPLING=CONTINUUM|STRUCTURAL, WEIGHTING METHOD=UNIFORM",
    "DISTRIBUTING COUPLING": "ELSET*",
    "PRE-TENSION SECTION": "SURFACE, ELEMENT, NODE*",
    "TIE": "NAME, ADJUST, POSITION TOLERANCE, TYPE, NO ROTATION, NO THICKNESS, CONSTRAINT RATIO",
    "CONTACT INCLUSIONS": "ALL EXTERIOR",
    "CONTACT PROPERTY ASSIGNMENT": "",
    "CONTACT PAIR": "INTERACTION*, TYPE, SMALL SLIDING, ADJUST, EXTENSION ZONE, CPSET, "
    "MECHANICAL CONSTRAINT, GEOMETRIC CORRECTION, SMOOTH, HCRIT, TRACKING, "
    "SUPPLEMENTARY CONSTRAINTS, SLIDING TRANSITION, NO THICKNESS",
    "SURFACE INTERACTION": "NAME*, PAD THICKNESS",
    "SURFACE BEHAVIOR": "PRESSURE-OVERCLOSURE=HARD|LINEAR|TABULAR|EXPONENTIAL, PENALTY, DIRECT, "
    "AUGMENTED LAGRANGE, NO SEPARATION",
    "FRICTION": "LAGRANGE, SHEAR TRACTION SLOPE, SLIP TOLERANCE, ELASTIC SLIP, ROUGH, USER, "
    "TAUMAX, EXPONENTIAL DECAY, ANISOTROPIC, DEPENDENCIES, TEST DATA",
    "CLEARANCE": "MASTER*, SLAVE*, VALUE*",
    "MODEL CHANGE": "TYPE, REMOVE, ADD",
}
"""Keywords to their parameters: ``*`` must be given, behind ``=`` are the values that are read, of
which the first is that of a parameter left out."""

READ = frozenset(_TAKES) - {"PART", "INSTANCE", "INITIAL CONDITIONS", "MODEL CHANGE"} | frozenset(
    (
        *("CONDUCTIVITY", "SPECIFIC HEAT", "LATENT HEAT", "INELASTIC HEAT FRACTION", "CONTACT"),
        *("TRANSVERSE SHEAR STIFFNESS", "GAP CONDUCTANCE", "SECTION CONTROLS", "DISTRIBUTION"),
    )
)
"""Keywords whose data are read, or refused for what they say."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter of a keyword: the values it may have, any if there are none."""

    name: str
    required: bool
    choices: tuple[str, ...]


def _parameter(text: str) -> Parameter:
    name, _, choices = text.partition("=")
    return Parameter(
        name=name.rstrip("*"),
        required=name.endswith("*"),
        choices=tuple(filter(None, choices.split("|"))),
    )


PARAMETERS: Mapping[str, Mapping[str, Parameter]] = {
    keyword: {
        without_blanks(text.partition("=")[0].rstrip("*")): _parameter(text)
        for text in filter(None, takes.split(", "))
    }
    for keyword, takes in _TAKES.items()
}
"""Keywords to what they take, by names without blanks."""

_STRUCTURE = (
    *("PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE", "INCLUDE"),
)


_KNOWN: Mapping[str, str] = {
    without_blanks(name): name for name in (*READ, *KEYWORDS.names(), *_STRUCTURE)
}


def keyword_name(text: str) -> str:
    """Return the usual spelling of a keyword; an unknown one with single blanks."""
    return _KNOWN.get(without_blanks(text), " ".join(text.upper().split()))
