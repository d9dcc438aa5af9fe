"""Names of keywords; blanks inside them may be left out, as in CalculiX."""

from collections.abc import Mapping

from faying.io.abaqus.left_out import KEYWORDS

READ = frozenset(
    (
        *("NODE", "SYSTEM", "ELEMENT", "NSET", "ELSET", "SURFACE", "MATERIAL", "ELASTIC"),
        *("DENSITY", "EXPANSION", "CONDUCTIVITY", "SPECIFIC HEAT", "LATENT HEAT"),
        *("INELASTIC HEAT FRACTION", "SOLID SECTION", "BEAM SECTION", "BEAM GENERAL SECTION"),
        "SHELL SECTION",
        *("TRANSVERSE SHEAR STIFFNESS", "SPRING", "MASS", "ROTARY INERTIA", "TRANSFORM"),
        *("BOUNDARY", "CLOAD", "DLOAD", "DSLOAD", "EQUATION", "MPC", "RIGID BODY", "COUPLING"),
        *("KINEMATIC", "DISTRIBUTING", "DISTRIBUTING COUPLING", "PRE-TENSION SECTION"),
        *("CONTACT", "CONTACT INCLUSIONS", "CONTACT PROPERTY ASSIGNMENT"),
        *("CONTACT PAIR", "SURFACE INTERACTION", "SURFACE BEHAVIOR", "FRICTION", "CLEARANCE"),
        *("GAP CONDUCTANCE", "AMPLITUDE", "TEMPERATURE", "TIE", "ORIENTATION"),
        *("SECTION CONTROLS", "DISTRIBUTION"),
    )
)
"""Keywords whose data are read, or refused for what they say."""

_STRUCTURE = (
    *("PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE", "INCLUDE"),
)


def without_blanks(name: str) -> str:
    """Return a name in upper case without blanks."""
    return "".join(name.upper().split())


_KNOWN: Mapping[str, str] = {
    without_blanks(name): name for name in (*READ, *KEYWORDS.names(), *_STRUCTURE)
}


def keyword_name(text: str) -> str:
    """Return the usual spelling of a keyword; an unknown one with single blanks."""
    return _KNOWN.get(without_blanks(text), " ".join(text.upper().split()))
