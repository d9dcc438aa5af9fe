"""Cards that are not read, and what becomes of each."""

from collections.abc import Mapping

from faying.io.left_out import Handling

_HARMLESS: Mapping[str, tuple[str, ...]] = {
    "analysis, solver and output control: faying has its own": (
        *("ASET", "ASET1", "BSET", "BSET1", "CSET", "CSET1", "QSET", "QSET1", "OMIT", "OMIT1"),
        *("USET", "USET1", "SESET", "EIGR", "EIGRL", "EIGB"),
        *("EIGC", "EIGP", "FREQ", "FREQ1", "FREQ2", "FREQ3", "FREQ4", "FREQ5", "TSTEP", "TSTEP1"),
        *("TSTEPNL", "NLPARM", "NLPCI", "NLSTEP", "NLCNTL2", "NLCNTLG", "MDLPRM", "NLMOPTS"),
        *("DTI", "ECHOON", "ECHOOFF", "DISPLAY", "PLOTEL", "PLOTEL3", "PLOTEL4", "MONPNT1"),
        *("MONPNT2", "CBARAO", "GROUP", "OUTRCV", "DEBUG", "PANEL"),
    ),
    "statics of Nastran hold what it names, vibrations do not: write SPC1 where it is a support": (
        *("SUPORT", "SUPORT1"),
    ),
    "dynamic loads and tables of damping: the study has its own": (
        *("DLOAD", "RLOAD1", "RLOAD2", "TLOAD1", "TLOAD2", "DAREA", "DELAY", "DPHASE"),
        *("TABLED1", "TABLED2", "TABLED3", "TABLED4", "TABDMP1", "TABRND1", "RANDPS", "TIC"),
        *("RANDT1", "TABRNDG", "RCROSS", "EPOINT"),
    ),
    "damping elements: give [damping] in the study": (
        *("CDAMP1", "CDAMP2", "CDAMP3", "CDAMP4", "CDAMP5", "CVISC"),
        *("PDAMP", "PDAMP5", "PDAMPT", "PVISC"),
    ),
    "materials have the constants of the reference temperature": (
        *("MATT1", "MATT2", "MATT3", "MATT8", "MATT9", "MATT11"),
        *("TABLEM1", "TABLEM2", "TABLEM3", "TABLEM4", "TABLEM5"),
    ),
    "elements have the stiffness of their property at any load and frequency": (
        *("PBUSHT", "PELAST"),
    ),
    "heat conduction": (
        *("CHBDYE", "CHBDYG", "CHBDYP", "PHBDY", "CONV", "CONVM", "PCONV", "PCONVM", "QBDY1"),
        *("QBDY2", "QBDY3", "QHBDY", "RADBC", "RADM", "RADSET", "VIEW", "VIEW3D", "MAT4"),
        *("MAT5", "MATT4", "MATT5", "RADCAV", "RADLST", "RADMTX"),
    ),
    "aerodynamics": (
        *("AERO", "AEROS", "CAERO1", "CAERO2", "CAERO3", "CAERO4", "CAERO5", "PAERO1", "PAERO2"),
        *("PAERO3", "PAERO4", "PAERO5", "SPLINE1", "SPLINE2", "SPLINE3", "SPLINE4", "SPLINE5"),
        *("AEFACT", "AELIST", "AESURF", "AESTAT", "AELINK", "AEPARM", "TRIM", "FLFACT"),
        *("FLUTTER", "MKAERO1", "MKAERO2", "GUST", "SET2", "DIVERG"),
        *("AECOMP", "AECOMPL", "MONPNT3", "MONDSP1", "AESCALE", "UXVEC"),
        # of ZAERO
        *("AEROZ", "CAERO7", "PAFOIL7", "PANLST1", "PANLST2", "PANLST3", "MKAEROZ", "TRIMFLT"),
        *("TRIMFNC", "TRIMVAR", "CELLBOX", "CELLWNG", "INPCFD", "LOADMOD", "DMIS"),
        *("FIXMACH", "OMITCFD", "PLTAERO", "PLTMODE", "PLTVG", "PLTCP", "PLTTRIM", "PLTFLUT"),
    ),
    "rotors do not turn: no gyroscopic terms": (
        *("ROTORD", "ROTORG", "RSPINR", "RSPINT", "RGYRO", "UNBALNC", "ROTPARM"),
    ),
    "data of failure and of materials that are not linear": ("TABLES1", "TABLEST"),
    "optimization and sensitivities: nothing is optimized": (
        *("DESVAR", "DVPREL1", "DVPREL2", "DVCREL1", "DVCREL2", "DVMREL1", "DVMREL2", "DVTREL1"),
        *("DVGRID", "DLINK", "DDVAL", "DTABLE", "DRESP1", "DRESP2", "DRESP3", "DCONSTR"),
        *("DCONADD", "DESOBJ", "DOPTPRM", "DSCREEN", "DEQATN", "TOPVAR", "DMNCON", "DMRLAW"),
        *("RANDVAR",),
    ),
    "matrices that only case control, refused there, puts to use, and names of sets": (
        *("ABSNMVS", "ABSTRCT", "DMIG", "DMI", "DMIJ", "DMIK", "DMIJI", "SET3", "SETREE", "GRDSET"),
    ),
}

_REMEDIES = {
    "CPYRA": "write CPYRAM",
    "PLSOLID": "use PSOLID",
    **dict.fromkeys(
        ("CWELD", "PWELD", "CFAST", "PFAST"),
        "join the parts by a CBUSH or CBAR between two RBE3 of the nodes around either end",
    ),
    **dict.fromkeys(("CGAP", "PGAP"), "remove it, and let the faces touch (BCTSET, BCTABL1)"),
}

ADDED_MASS = ("NSM", "NSM1", "NSML", "NSML1", "NSMADD")
"""Masses beside those of properties, which case control selects."""

USERS: Mapping[str, tuple[str, ...]] = {
    "PLPLANE": ("CQUAD", "CQUAD4", "CQUAD8", "CQUADX", "CTRIA3", "CTRIA6", "CTRIAX"),
    "PGAP": ("CGAP",),
}
"""Properties that are not read, and the elements that may name them."""

CARDS = Handling(
    what="card",
    harmless={name: text for text, names in _HARMLESS.items() for name in names},
    on_request={"MATS1": "plastic"},
    remedies=_REMEDIES,
    unknown="remove it, or model it with supported cards",
)
