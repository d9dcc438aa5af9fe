"""PARAM, and the list of cards that are harmless to leave out."""

from collections.abc import Mapping

from faying.io.nastran.cards import Bulk, Cards

_SCALES = frozenset(("CB1", "CB2", "CK1", "CK2", "CK3", "CM1", "CM2", "CP1", "CP2"))

HARMLESS = frozenset(
    (
        # analysis, solver and output control
        *("ASET", "ASET1", "BSET", "BSET1", "CSET", "CSET1", "QSET", "QSET1", "OMIT", "OMIT1"),
        *("USET", "USET1", "SESET", "SUPORT", "SUPORT1", "EIGR", "EIGRL", "EIGB"),
        *("EIGC", "EIGP", "FREQ", "FREQ1", "FREQ2", "FREQ3", "FREQ4", "FREQ5", "TSTEP"),
        *("TSTEPNL", "NLPARM", "NLPCI", "NLSTEP", "MDLPRM", "NLMOPTS", "DTI", "ECHOON"),
        *("ECHOOFF", "DISPLAY", "PLOTEL", "PLOTEL3", "PLOTEL4", "MONPNT1", "MONPNT2"),
        # dynamic loads and damping tables: the study has its own
        *("DLOAD", "RLOAD1", "RLOAD2", "TLOAD1", "TLOAD2", "DAREA", "DELAY", "DPHASE"),
        *("TABLED1", "TABLED2", "TABLED3", "TABLED4", "TABDMP1", "TABRND1", "RANDPS", "TIC"),
        # temperatures without a thermal load, failure data, optimisation
        *("TEMP", "TEMPD", "TABLES1", "TABLEM1", "DESVAR", "DVPREL1", "DRESP1"),
        *("DCONSTR", "DESOBJ", "DOPTPRM", "DVCREL1", "DCONADD", "DRESP2", "DEQATN"),
        # matrices that only case control (refused there) puts to use; names of sets
        *("ABSNMVS", "ABSTRCT", "DMIG", "DMI", "SET3", "SETREE", "GRDSET"),
    )
)
"""Cards that do not change mass or stiffness; named in ``Assembly.ignored``."""


def mass_factor(cards: Mapping[str, Cards], control: Bulk, ignored: list[str]) -> float:
    """Return PARAM,WTMASS (1 if absent) and note the other parameters.

    Parameters
    ----------
    cards
        Of the bulk data.
    control
        PARAM lines of case control, which Nastran takes like those of the bulk data.

    Raises
    ------
    FormatError
        If a parameter scales matrices in a way that is not supported.
    """
    factor = 1.0
    others: set[str] = set()
    for card in (*control.cards().get("PARAM", ()), *cards.get("PARAM", ())):
        name = card.text(0)
        if name == "WTMASS":
            factor = card.real(1)
            if not factor > 0:
                text = f"WTMASS = {factor:g} must be positive"
                raise card.error(text, 1)
        elif name in _SCALES:
            if card.real(1) != 1.0:
                text = f"{name} scales input matrices, which is not supported; remove it"
                raise card.error(text, 1)
        elif name:
            others.add(name)
    if others:
        ignored.append(f"PARAM {', '.join(sorted(others))}")
    return factor
