"""Keywords without effect on a linear structure with contact, and those with a known remedy."""

from collections.abc import Mapping

HARMLESS = frozenset(
    (
        *("HEADING", "PREPRINT", "RESTART", "STEP", "END STEP", "STATIC", "FREQUENCY", "DYNAMIC"),
        *("MODAL DYNAMIC", "STEADY STATE DYNAMICS", "BUCKLE", "VISCO", "COMPLEX FREQUENCY"),
        *("CONTROLS", "SOLVER CONTROLS", "NODE PRINT", "NODE FILE", "NODE OUTPUT", "EL PRINT"),
        *("EL FILE", "ELEMENT OUTPUT", "OUTPUT", "CONTACT PRINT", "CONTACT FILE"),
        *("CONTACT OUTPUT", "ENERGY PRINT", "ENERGY FILE", "ENERGY OUTPUT", "SECTION PRINT"),
        *("SECTION FILE", "MODAL OUTPUT", "MODAL FILE", "MODAL PRINT", "INTEGRATED OUTPUT"),
        *("PRINT", "MONITOR", "FILE FORMAT", "NODAL THICKNESS", "TIME POINTS"),
        *("ORIENTATION", "SECTION CONTROLS", "MATRIX GENERATE", "MATRIX OUTPUT"),
        *("PHYSICAL CONSTANTS", "CONTACT CONTROLS", "DISTRIBUTION", "DISTRIBUTION TABLE"),
    )
)

REMEDIES: Mapping[str, str] = {
    "NGEN": "write the nodes out; preprocessors and CalculiX's cgx do",
    "NFILL": "write the nodes out; preprocessors and CalculiX's cgx do",
    "NCOPY": "write the nodes out",
    "ELGEN": "write the elements out",
    "ELCOPY": "write the elements out",
    "TIE": "mesh the tied parts as one body (shared nodes), or write *EQUATION or *MPC,TIE",
    "CONTACT": "define *CONTACT PAIR; general contact is not supported",
    "CONTACT INCLUSIONS": "define *CONTACT PAIR; general contact is not supported",
    "PLASTIC": "remove it; materials are linear elastic",
    "HYPERELASTIC": "give *ELASTIC; materials are linear elastic",
    "SHELL SECTION": "mesh with solids; shells are not supported",
    "MEMBRANE SECTION": "mesh with solids",
    "TEMPERATURE": "remove it; thermal strain is not supported",
    "INITIAL CONDITIONS": "remove it; initial stress, strain or temperature is not supported",
    "CONTACT INTERFERENCE": "give initial_gap (negative) to the interface in the study",
    "CYCLIC SYMMETRY MODEL": "model the whole structure",
    "GAP": "use *CONTACT PAIR",
    "DASHPOT": "remove it and give damping in the study",
    "DAMPING": "remove it and give alpha and beta under [damping] in the study",
    "MODAL DAMPING": "remove it and give alpha and beta under [damping] in the study",
    "MODEL CHANGE": "remove it; nothing is added or removed between steps",
    "CONNECTOR SECTION": "use *COUPLING, *MPC or *EQUATION",
    "SUBMODEL": "cut the model yourself and hold it by *BOUNDARY",
    "USER ELEMENT": 'give matrices instead (source = "matrices")',
    "MATRIX INPUT": 'give matrices instead (source = "matrices")',
    "MATRIX ASSEMBLE": 'give matrices instead (source = "matrices")',
    "RIGID SURFACE": "mesh the rigid part with solids and give it *RIGID BODY",
    "EMBEDDED ELEMENT": "share nodes instead",
}
