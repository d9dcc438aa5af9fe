"""Strength of bolts by grade: ISO 898-1, ISO 3506-1 and SAE J429."""

import re
from dataclasses import dataclass

from faying.exceptions import refuse_model
from faying.units import pascals

PROOF = {
    "4.6": 225.0, "4.8": 310.0, "5.6": 280.0, "5.8": 380.0, "6.8": 440.0,
    "8.8": 580.0, "9.8": 650.0, "10.9": 830.0, "12.9": 970.0,
}  # fmt: skip
"""Stress under proof load of property classes [MPa], ISO 898-1, of 8.8 up to 16 mm."""

STAINLESS = {"50": (210.0, 500.0), "70": (450.0, 700.0), "80": (600.0, 800.0)}
"""Yield and ultimate strength of austenitic steels A1 to A5 [MPa], ISO 3506-1."""

SAE = {"2": (55.0, 57.0, 74.0), "5": (85.0, 92.0, 120.0), "8": (120.0, 130.0, 150.0)}
"""Proof, yield and ultimate strength [ksi], SAE J429; of 2 up to 3/4 in, of 5 up to 1 in."""

GRADE = re.compile(r"\d{1,2}\.[1-9]|A[1-5]-(?:50|70|80)|SAE (?:2|5|8)")


@dataclass(frozen=True, kw_only=True)
class BoltStrength:
    """Strength of the material of a bolt.

    Attributes
    ----------
    proof : [force/length²]
        S_p, stress under proof load.
    yields : [force/length²]
        R_p0.2, yield strength.
    ultimate : [force/length²]
        R_m, tensile strength.
    """

    proof: float
    yields: float
    ultimate: float

    def __post_init__(self) -> None:
        if not 0 < self.proof <= self.yields <= self.ultimate:
            refuse_model(
                f"strengths are proof {self.proof:g}, yield {self.yields:g} and ultimate "
                f"{self.ultimate:g}; give positive ones, each at least the one before"
            )


def check_grade(grade: str) -> None:
    """Refuse an unknown grade."""
    if not GRADE.fullmatch(grade):
        refuse_model(
            f"grade '{grade}' is none; give it as in '8.8' or '10.9', 'A2-70' or 'SAE 5', or the "
            "strengths themselves"
        )


def strength_of(grade: str, units: str) -> BoltStrength:
    """Return the strength of a grade.

    The yield strength of a property class follows from its name: "8.8" is 0.8 of 800 MPa. Its proof
    stress is that of the table, or 0.9 of its yield strength if the table has none; for stainless
    steels it is the yield strength.
    """
    check_grade(grade)
    pascal = pascals(units)
    if pascal is None:
        refuse_model(f"a grade is a stress in MPa, and what that is in {units} is not known")
    if grade.startswith("A"):
        yields, ultimate = STAINLESS[grade[-2:]]
        values, unit = (yields, yields, ultimate), 1e6
    elif grade.startswith("SAE"):
        values, unit = SAE[grade[-1]], 1e3 * (pascals("in-slinch-s") or 0.0)
    else:
        strength, share = grade.split(".")
        ultimate = 100.0 * int(strength)
        yields = ultimate * int(share) / 10
        values, unit = (min(PROOF.get(grade, 0.9 * yields), yields), yields, ultimate), 1e6
    proof, yields, ultimate = (value * unit / pascal for value in values)
    return BoltStrength(proof=proof, yields=yields, ultimate=ultimate)
