"""Keywords and element types that are not read, and how each is handled."""

from collections.abc import Mapping

from faying.io.left_out import Handling

_HARMLESS: Mapping[str, tuple[str, ...]] = {
    "texts, and requests for output: faying writes its own": (
        *("HEADING", "PREPRINT", "RESTART", "NODE PRINT", "NODE FILE", "NODE OUTPUT", "EL PRINT"),
        *("EL FILE", "ELEMENT OUTPUT", "OUTPUT", "CONTACT PRINT", "CONTACT FILE"),
        *("CONTACT OUTPUT", "ENERGY PRINT", "ENERGY FILE", "ENERGY OUTPUT", "SECTION PRINT"),
        *("SECTION FILE", "MODAL OUTPUT", "MODAL FILE", "MODAL PRINT", "INTEGRATED OUTPUT"),
        *("PRINT", "MONITOR", "FILE FORMAT", "MATRIX GENERATE", "MATRIX OUTPUT", "TIME POINTS"),
        *("ELEMENT MATRIX OUTPUT", "SUBSTRUCTURE MATRIX OUTPUT", "FILTER OUTPUT"),
    ),
    "procedures: the load cases of a study, or calls from Python, determine what is computed": (
        *("STEP", "END STEP", "STATIC", "FREQUENCY", "DYNAMIC", "MODAL DYNAMIC", "BUCKLE"),
        *("STEADY STATE DYNAMICS", "VISCO", "COMPLEX FREQUENCY", "SUBSTRUCTURE GENERATE"),
        *("RETAINED NODAL DOFS", "SELECT CYCLIC SYMMETRY MODES", "SELECT EIGENMODES"),
        "DAMPING CONTROLS",
    ),
    "load cases of a substructure: the loads of all of them act in the load of the step": (
        "SUBSTRUCTURE LOAD CASE",
    ),
    "CalculiX solves again on a refined mesh; faying keeps the mesh of the deck, and results "
    "differ by the effect of the refinement": ("REFINE MESH",),
    "solution control: faying has its own tolerances": (
        "HCF",
        *("CONTROLS", "SOLVER CONTROLS", "CONTACT CONTROLS", "NO ANALYSIS", "DYNAMIC CONTROLS"),
        *("CONTACT STABILIZATION", "CONSTRAINT CONTROLS", "DIAGNOSTICS"),
    ),
    "roles of slave and master, and smoothing: an interface has its contact points on its first "
    "surface, and gaps of curved surfaces are those of smooth ones": (
        *("CONTACT FORMULATION", "SURFACE SMOOTHING"),
    ),
    "optimization and sensitivities: nothing is optimized": (
        *("DESIGN VARIABLES", "DESIGN VARIABLE", "DESIGN RESPONSE", "OBJECTIVE", "SENSITIVITY"),
        *("FEASIBLE DIRECTION", "FILTER", "GEOMETRIC TOLERANCES", "GEOMETRIC CONSTRAINT"),
        *("CONSTRAINT", "ROBUST DESIGN", "RANDOM FIELD", "CORRELATION LENGTH", "GREEN"),
    ),
    "damping: it has no effect in statics, and transients use alpha and beta of the study": (
        *("DASHPOT", "DAMPING", "MODAL DAMPING", "GLOBAL DAMPING", "CONTACT DAMPING"),
    ),
    "base motion: give the load cases of the study forces": ("BASE MOTION",),
    "without effect on isotropic solids at small displacements": (
        *("NODAL THICKNESS", "DISTRIBUTION TABLE"),
        *("PHYSICAL CONSTANTS", "VALUES AT INFINITY"),
    ),
    "start of transients: those of a study start from the preloaded state at rest": (
        *("INITIAL CONDITIONS, TYPE=VELOCITY", "INITIAL CONDITIONS, TYPE=DISPLACEMENT"),
    ),
}

_ON_REQUEST: Mapping[str, tuple[str, ...]] = {
    "plastic": (
        *("PLASTIC", "CYCLIC HARDENING", "CREEP", "POTENTIAL", "RATE DEPENDENT", "ANNEAL"),
        *("CHANGE PLASTIC", "DAMAGE INITIATION", "DAMAGE EVOLUTION", "MOHR COULOMB"),
        *("MOHR COULOMB HARDENING", "INITIAL CONDITIONS, TYPE=PLASTICSTRAIN"),
        *("INITIAL CONDITIONS, TYPE=HARDENING",),
    ),
    "temperature": (
        *("HEAT TRANSFER", "COUPLED TEMPERATURE-DISPLACEMENT", "FILM", "CFLUX"),
        *("UNCOUPLED TEMPERATURE-DISPLACEMENT", "DFLUX", "DSFLUX", "RADIATE", "SFILM", "SRADIATE"),
        *("CAVITY DEFINITION", "SURFACE PROPERTY", "GAP HEAT GENERATION"),
    ),
}

_SHELLS = "give S3, S4, S6 or S8 with *SHELL SECTION of one layer, or solids"
_PLANE = (
    "model the body in three dimensions by solids; plane and axisymmetric ones are not read. gmsh "
    "writes groups of faces as such: give its .msh file instead, or remove them"
)
_MATRICES = 'give matrices instead (source = "matrices")'
_GENERATED = "write nodes and elements out; preprocessors and CalculiX's cgx do"
_PAIRS = "define *CONTACT PAIR; general contact is uniform, or of listed surfaces"
_FLOW = "flow, electric and magnetic fields are not supported; remove them"
_ELASTIC = "give *ELASTIC; materials are linear elastic"
_STARTS = "remove it; structures start without stress"
_LAYERS = "mesh the layers as solids with a section each"

_REMEDIES: Mapping[str, tuple[str, ...]] = {
    _GENERATED: ("NGEN", "NFILL", "NCOPY", "ELGEN", "ELCOPY", "NMAP"),
    _PAIRS: (
        *("CONTACT EXCLUSIONS", "CONTACT INITIALIZATION DATA"),
        "CONTACT INITIALIZATION ASSIGNMENT",
        *("CONTACT CLEARANCE", "CONTACT CLEARANCE ASSIGNMENT", "SURFACE PROPERTY ASSIGNMENT"),
    ),
    _ELASTIC: (
        *("HYPERELASTIC", "HYPERFOAM", "DEFORMATION PLASTICITY", "USER MATERIAL", "DEPVAR"),
        *("VISCOELASTIC", "ENGINEERING CONSTANTS", "NO COMPRESSION", "NO TENSION"),
    ),
    _SHELLS: ("SHELL GENERAL SECTION", "MEMBRANE SECTION"),
    _STARTS: (
        "INITIAL CONDITIONS, TYPE=STRESS",
        *("INITIAL CONDITIONS", "INITIAL STRAIN INCREASE"),
    ),
    "give initial_gap (negative) to the interface in the study": ("CONTACT INTERFERENCE",),
    "model the whole structure": ("CYCLIC SYMMETRY MODEL", "TIE, CYCLIC SYMMETRY"),
    "use *CONTACT PAIR": ("GAP",),
    "remove it; the structure must be the same in all steps": (
        *("MODEL CHANGE", "CHANGE FRICTION", "CHANGE MATERIAL", "CHANGE SOLID SECTION"),
        *("CHANGE SURFACE BEHAVIOR", "CHANGE CONTACT TYPE"),
    ),
    "use *COUPLING, *MPC or *EQUATION": (
        *("CONNECTOR SECTION", "CONNECTOR BEHAVIOR", "CONNECTOR ELASTICITY", "CONNECTOR LOAD"),
        *("CONNECTOR MOTION", "CONNECTOR LOCK", "CONNECTOR STOP", "CONNECTOR DAMPING"),
        *("CONNECTOR FRICTION", "FASTENER", "FASTENER PROPERTY"),
    ),
    "cut the model and hold it by *BOUNDARY": ("SUBMODEL",),
    _MATRICES: (
        *("USER ELEMENT", "MATRIX INPUT", "MATRIX ASSEMBLE", "UEL PROPERTY", "USER SECTION"),
        "MATRIX",
    ),
    "mesh the rigid part with solids and give it *RIGID BODY": ("RIGID SURFACE",),
    "share nodes instead": ("EMBEDDED ELEMENT",),
    _FLOW: (
        *("FLUID SECTION", "FLUID CONSTANTS", "SPECIFIC GAS CONSTANT", "MASS FLOW"),
        *("ELECTRICAL CONDUCTIVITY", "ELECTROMAGNETICS", "MAGNETIC PERMEABILITY"),
    ),
}

_SHELL_TYPES = ("S3RS", "S4RS", "S4R5", "S8R5", "S9R5")
_MEMBRANES = ("M3D3", "M3D4", "M3D4R", "M3D6", "M3D8", "M3D8R", "SFM3D4", "SFM3D3")
_PLANE_TYPES = tuple(
    f"{family}{nodes}"
    for family in ("CPE", "CPS", "CAX", "CGAX")
    for nodes in ("3", "4", "4R", "4I", "4H", "6", "6M", "8", "8R", "6H", "8H", "8RH")
)

_TYPES: Mapping[str, tuple[str, ...]] = {
    _SHELLS: (*_SHELL_TYPES, *_MEMBRANES),
    _PLANE: (*_PLANE_TYPES, "SAX1", "SAX2", "T2D2", "B21", "B22", "CONN2D2"),
    "use T3D2": ("T3D3", "T3D2H"),
    "use C3D20": ("C3D20I",),
    "use C3D8 or C3D8I; hybrid elements are not supported": ("C3D8H", "C3D8IH", "C3D8RH"),
    "use C3D10, C3D20 or C3D4; hybrid elements are not supported": (
        *("C3D10H", "C3D10MH", "C3D20H", "C3D20RH", "C3D4H", "C3D6H", "C3D15H"),
    ),
    "use *COUPLING, *MPC or *EQUATION": ("CONN3D2",),
    "use *CONTACT PAIR": ("GAPUNI", "GAPSPHER", "GAPCYL"),
    _LAYERS: ("SC6R", "SC8R", "CSS8"),
    _FLOW: ("D", "F3D4", "F3D6", "F3D8", "AC3D4", "AC3D8", "AC3D10", "AC3D20"),
    "mesh the rigid part with solids and give it *RIGID BODY": ("R3D3", "R3D4", "RB3D2"),
    _MATRICES: ("U1", "US3"),
}


def _by_name(groups: Mapping[str, tuple[str, ...]], head: str = "") -> dict[str, str]:
    return {f"{head}{name}": text for text, names in groups.items() for name in names}


KEYWORDS = Handling(
    what="keyword",
    mark="*",
    harmless=_by_name(_HARMLESS),
    on_request=_by_name(_ON_REQUEST),
    remedies={**_by_name(_REMEDIES), **_by_name(_TYPES, "ELEMENT, TYPE=")},
    unknown="remove it, or model it with supported keywords",
)
