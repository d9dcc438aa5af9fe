"""Fields of supported cards with bounds of their numbers; treatment of other cards.

``>0`` marks a number that must be positive, ``>=0`` one that must not be negative; ``.`` is a field
that is not read. After the last name a card may have lists or rows that its reader handles.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying.io.left_out import Handling

_POINTS = "C1 C2 D1 D2 E1 E2 F1 F2"
_MODULI = " ".join(f"G{i}{j}" for i in range(1, 7) for j in range(i, 7))

_ROWS: Mapping[str, str] = {
    # grid points and systems
    "GRID": "ID CP X1 X2 X3 CD PS SEID",
    "GRDSET": ". CP . . . CD PS SEID",
    "SPOINT": "",
    **dict.fromkeys(("CORD1R", "CORD1C", "CORD1S"), "CIDA G1A G2A G3A CIDB G1B G2B G3B"),
    **dict.fromkeys(("CORD2R", "CORD2C", "CORD2S"), "CID RID A1 A2 A3 B1 B2 B3 C1 C2 C3"),
    # materials
    "MAT1": "MID E G NU RHO A TREF GE",
    "MAT2": "MID G11 G12 G13 G22 G23 G33 RHO>=0 A1 A2 A3 TREF",
    "MAT8": "MID E1>0 E2>0 NU12 G12>=0 G1Z>=0 G2Z>=0 RHO>=0 A1 A2 TREF",
    "MAT9": f"MID {_MODULI} RHO A1 A2 A3 A4 A5 A6 TREF GE",
    "MAT11": "MID E1 E2 E3 NU12 NU13 NU23 G12 G13 G23 RHO A1 A2 A3 TREF",
    # properties
    "PSOLID": "PID MID CORDM IN STRESS ISOP FCTN",
    "PCOMPS": "PID CORDM PSDIR",
    "PSHELL": "PID MID1 T>0 MID2 12I/T**3>0 MID3 TS/T>0 NSM>=0 Z1 Z2 MID4",
    "PSHEAR": "PID MID T>0 NSM>=0 F1>=0 F2>=0",
    "PCOMP": "PID Z0 NSM SB FT TREF GE LAM",
    "PCOMPG": "PID Z0 NSM SB FT TREF GE LAM",
    "PBAR": f"PID MID A>0 I1>=0 I2>=0 J>=0 NSM>=0 . {_POINTS} K1 K2 I12",
    "PBARL": "PID MID GROUP TYPE . . . . DIM1",
    "PBEAM": "PID MID A>0 I1>=0 I2>=0 I12 J>=0 NSM>=0",
    "PBEAML": "PID MID GROUP TYPE . . . . DIM1",
    "PROD": "PID MID A>0 J>=0 C NSM>=0",
    "PTUBE": "PID MID OD>0 T>=0 NSM>=0 OD2",
    "PBEND": f"PID MID A>0 I1>0 I2>0 J>0 RB THETAB {_POINTS} K1>=0 K2>=0 NSM>=0 RC ZC DELTAN",
    "PELAS": "PID1 K1 GE1 S1 PID2 K2 GE2 S2",
    "PMASS": "PID1 M1 PID2 M2 PID3 M3 PID4 M4",
    "PBUSH": "PID",
    "PBUSH1D": "PID K>=0 C M>=0",
    # elements
    "CHEXA": "EID PID",
    "CPENTA": "EID PID",
    "CPYRAM": "EID PID",
    "CTETRA": "EID PID",
    **dict.fromkeys(("CTRIA3", "CTRIAR"), "EID PID G1 G2 G3 THETA ZOFFS . . TFLAG T1 T2 T3"),
    **dict.fromkeys(("CQUAD4", "CQUADR"), "EID PID G1 G2 G3 G4 THETA ZOFFS . TFLAG T1 T2 T3 T4"),
    "CTRIA6": "EID PID G1 G2 G3 G4 G5 G6 THETA ZOFFS T1 T2 T3 TFLAG",
    "CQUAD8": "EID PID G1 G2 G3 G4 G5 G6 G7 G8 T1 T2 T3 T4 THETA ZOFFS TFLAG",
    "CSHEAR": "EID PID G1 G2 G3 G4",
    "CBAR": "EID PID GA GB X1 X2 X3 OFFT PA PB W1A W2A W3A W1B W2B W3B",
    "CBEAM": "EID PID GA GB X1 X2 X3 OFFT PA PB W1A W2A W3A W1B W2B W3B SA SB",
    "BAROR": ". PID . . X1 X2 X3 OFFT",
    "BEAMOR": ". PID . . X1 X2 X3 OFFT",
    "CROD": "EID PID G1 G2",
    "CTUBE": "EID PID G1 G2",
    "CONROD": "EID G1 G2 MID A>0 J>=0 C NSM>=0",
    "CBEND": "EID PID GA GB X1 X2 X3 GEOM",
    "CBUSH": "EID PID GA GB X1 X2 X3 CID S OCID S1 S2 S3",
    "CBUSH1D": "EID PID GA GB CID",
    "GENEL": "EID",
    **{f"C{kind}{n}": "EID PID G1 C1 G2 C2" for kind in ("ELAS", "MASS") for n in "13"},
    "CELAS2": "EID K G1 C1 G2 C2 GE S",
    "CELAS4": "EID K S1 S2",
    "CMASS2": "EID M G1 C1 G2 C2",
    "CMASS4": "EID M S1 S2",
    "CONM1": "EID G CID",
    "CONM2": "EID G CID M X1 X2 X3 . I11 I21 I22 I31 I32 I33",
    # rigid elements and constraints
    "RBE1": "EID",
    "RBE2": "EID GN CM",
    "RBE3": "EID . REFGRID REFC",
    "RBAR": "EID GA GB CNA CNB CMA CMB",
    "RROD": "EID GA GB CMA CMB",
    "RTRPLT": "EID GA GB GC CNA CNB CNC . CMA CMB CMC",
    "RSSCON": "EID TYPE ES1 EA1 EB1",
    "MPC": "SID",
    "MPCADD": "SID",
    "SPC": "SID G1 C1 D1 G2 C2 D2",
    "SPC1": "SID C",
    "SPCADD": "SID",
    "SPCD": "SID G1 C1 D1 G2 C2 D2",
    # loads and temperatures
    "FORCE": "SID G CID F N1 N2 N3",
    "MOMENT": "SID G CID M N1 N2 N3",
    **dict.fromkeys(("FORCE1", "MOMENT1"), "SID G F G1 G2"),
    **dict.fromkeys(("FORCE2", "MOMENT2"), "SID G F G1 G2 G3 G4"),
    "SLOAD": "SID S1 F1 S2 F2 S3 F3",
    "PLOAD": "SID P G1 G2 G3 G4",
    "PLOAD1": "SID EID TYPE SCALE X1 P1 X2 P2",
    "PLOAD2": "SID P",
    "PLOAD4": "SID EID P1 P2 P3 P4 G1 G3 CID N1 N2 N3",
    "GRAV": "SID CID A N1 N2 N3",
    "RFORCE": "SID G CID A R1 R2 R3 METHOD RACC",
    "LOAD": "SID S",
    "TEMP": "SID G1 T1 G2 T2 G3 T3",
    "TEMPD": "SID1 T1 SID2 T2 SID3 T3 SID4 T4",
    "TEMPP1": "SID EID1 TBAR TPRIME",
    "TEMPRB": "SID EID1 TA TB",
    "DEFORM": "SID EID1 D1 EID2 D2 EID3 D3",
    # sets, contact and bolts, read after the structure
    "PARAM": "N V1",
    "SET1": "SID",
    "BSURF": "ID",
    "BSURFS": "ID",
    "BCPROP": "ID",
    "BCPROPS": "ID",
    "BCTSET": "CSID SID1 TID1 FRIC1 MIND1 MAXD1",
    "BGSET": "GSID SID1 TID1 SDIST1",
    **dict.fromkeys(("BCTADD", "BGADD"), "ID"),
    **dict.fromkeys(("BCTPARM", "BCTPARA", "BGPARM", "BGPARA"), "ID"),
    "BCRPARA": "CRID SURF OFFSET TYPE",
    "BCTABLE": "ID IDSECND IDPRIM NGROUP",
    "BCTABL1": "BCID",
    "BCONECT": "ID BCPGID BCPPID IDSECND IDPRIM",
    "BCBODY": "BID DIM BEHAV BSID ISTYP FRIC",
    "BCBODY1": "BID BPID DIM BEHAV BSID",
    "BCSURF": "BID",
    **dict.fromkeys(("BCBDPRP", "BCONPRG", "BCONPRP", "BCPARA"), "ID"),
    "BOLT": "ID ETYPE",
    "BOLTFOR": "SID LOAD>=0",
    "BOLTLD": "SID S",
    "BOLTFRC": "SID",
    "BOLTSEQ": "SID",
}


@dataclass(frozen=True, kw_only=True)
class Field:
    """A field of a card: its name, and whether it must be positive, or not negative."""

    name: str
    positive: bool = False
    not_negative: bool = False

    def fault(self, value: float) -> str:
        """Return why a number is out of bounds; an empty text if it is not."""
        if self.positive and not value > 0:
            return "must be positive"
        return "must not be negative" if self.not_negative and not value >= 0 else ""


def _field(text: str) -> Field:
    name, _, bound = text.partition(">")
    return Field(name=name, positive=bound == "0", not_negative=bound == "=0")


FIELDS: Mapping[str, tuple[Field, ...]] = {
    name: tuple(map(_field, fields.split())) for name, fields in _ROWS.items()
}
"""Supported cards, with the fields before their lists and rows."""

_UNKNOWN = Field(name="")


_BEYOND = int(np.iinfo(np.int32).max)
"""A field number beyond the end of any card."""


def place_of(card: str, name: str) -> int:
    """Return the number of a field by name; one beyond any card if the card lacks it."""
    return next((i for i, field in enumerate(FIELDS[card]) if field.name == name), _BEYOND)


def field_of(card: str, number: int) -> Field:
    """Return a field of a card, without a name if the table lacks it."""
    fields = FIELDS.get(card, ())
    return fields[number] if number < len(fields) and fields[number].name != "." else _UNKNOWN


_HARMLESS: Mapping[str, tuple[str, ...]] = {
    "analysis, solver and output control: the study decides": (
        *("ASET", "ASET1", "BSET", "BSET1", "CSET", "CSET1", "QSET", "QSET1", "OMIT", "OMIT1"),
        *("USET", "USET1", "SESET", "EIGR", "EIGRL", "EIGB"),
        *("EIGC", "EIGP", "FREQ", "FREQ1", "FREQ2", "FREQ3", "FREQ4", "FREQ5", "TSTEP", "TSTEP1"),
        *("TSTEPNL", "NLPARM", "NLPCI", "NLSTEP", "NLCNTL2", "NLCNTLG", "MDLPRM", "NLMOPTS"),
        *("DTI", "ECHOON", "ECHOOFF", "DISPLAY", "PLOTEL", "PLOTEL3", "PLOTEL4", "MONPNT1"),
        *("MONPNT2", "CBARAO", "GROUP", "OUTRCV", "DEBUG", "PANEL"),
    ),
    "fixed in Nastran's statics, not in vibrations: write SPC1 for a support": (
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
    "materials have their constants at the reference temperature": (
        *("MATT1", "MATT2", "MATT3", "MATT8", "MATT9", "MATT11"),
        *("TABLEM1", "TABLEM2", "TABLEM3", "TABLEM4", "TABLEM5"),
    ),
    "elements have the same stiffness at any load and frequency": (*("PBUSHT", "PELAST"),),
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
    "rotors do not rotate: no gyroscopic terms": (
        *("ROTORD", "ROTORG", "RSPINR", "RSPINT", "RGYRO", "UNBALNC", "ROTPARM"),
    ),
    "data of failure and of nonlinear materials": ("TABLES1", "TABLEST"),
    "optimization and sensitivities: nothing is optimized": (
        *("DESVAR", "DVPREL1", "DVPREL2", "DVCREL1", "DVCREL2", "DVMREL1", "DVMREL2", "DVTREL1"),
        *("DVGRID", "DLINK", "DDVAL", "DTABLE", "DRESP1", "DRESP2", "DRESP3", "DCONSTR"),
        *("DCONADD", "DESOBJ", "DOPTPRM", "DSCREEN", "DEQATN", "TOPVAR", "DMNCON", "DMRLAW"),
        *("RANDVAR",),
    ),
    "matrices that only refused case control commands use, and names of sets": (
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
"""Nonstructural masses that case control selects."""

USERS: Mapping[str, tuple[str, ...]] = {
    "PLPLANE": ("CQUAD", "CQUAD4", "CQUAD8", "CQUADX", "CTRIA3", "CTRIA6", "CTRIAX"),
    "PGAP": ("CGAP",),
}
"""Unsupported properties, and the elements that may name them."""

CARDS = Handling(
    what="card",
    harmless={name: text for text, names in _HARMLESS.items() for name in names},
    on_request={"MATS1": "plastic"},
    remedies=_REMEDIES,
    unknown="remove it, or model it with supported cards",
)
