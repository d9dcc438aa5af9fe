"""Cards that are not read, and what becomes of each."""

from collections.abc import Mapping

from faying.io.left_out import Handling

_HARMLESS: Mapping[str, tuple[str, ...]] = {
    "analysis, solver and output control: faying has its own": (
        *("ASET", "ASET1", "BSET", "BSET1", "CSET", "CSET1", "QSET", "QSET1", "OMIT", "OMIT1"),
        *("USET", "USET1", "SESET", "SUPORT", "SUPORT1", "EIGR", "EIGRL", "EIGB"),
        *("EIGC", "EIGP", "FREQ", "FREQ1", "FREQ2", "FREQ3", "FREQ4", "FREQ5", "TSTEP"),
        *("TSTEPNL", "NLPARM", "NLPCI", "NLSTEP", "MDLPRM", "NLMOPTS", "DTI", "ECHOON"),
        *("ECHOOFF", "DISPLAY", "PLOTEL", "PLOTEL3", "PLOTEL4", "MONPNT1", "MONPNT2"),
    ),
    "dynamic loads and tables of damping: the study has its own": (
        *("DLOAD", "RLOAD1", "RLOAD2", "TLOAD1", "TLOAD2", "DAREA", "DELAY", "DPHASE"),
        *("TABLED1", "TABLED2", "TABLED3", "TABLED4", "TABDMP1", "TABRND1", "RANDPS", "TIC"),
    ),
    "temperatures, which no thermal load puts to use": ("TEMP", "TEMPD", "TABLEM1"),
    "data of failure and of materials that are not linear": ("TABLES1",),
    "optimization and sensitivities: nothing is optimized": (
        *("DESVAR", "DVPREL1", "DRESP1", "DCONSTR", "DESOBJ", "DOPTPRM", "DVCREL1", "DCONADD"),
        *("DRESP2", "DEQATN"),
    ),
    "matrices that only case control, refused there, puts to use, and names of sets": (
        *("ABSNMVS", "ABSTRCT", "DMIG", "DMI", "SET3", "SETREE", "GRDSET"),
    ),
}

_REMEDIES = {
    "CPYRAM": "mesh with CHEXA, CPENTA or CTETRA",
    "CPYRA": "mesh with CHEXA, CPENTA or CTETRA",
    "CROD": "use CBAR",
    "CONROD": "use CBAR",
    "CBUSH": "use CELAS2",
    "RBAR": "use RBE2",
    "RBE1": "use RBE2 or MPC",
    "PLSOLID": "use PSOLID",
    "MAT9": "use MAT1; only isotropic materials are supported",
    "CMASS2": "use CONM2",
    "CONM1": "use CONM2",
}

CARDS = Handling(
    what="card",
    harmless={name: text for text, names in _HARMLESS.items() for name in names},
    on_request={"MATS1": "plastic"},
    remedies=_REMEDIES,
    unknown="remove it, or model it with supported cards",
)
