"""The tables of a study file that say what to find out beyond the load cases, and what to write."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator

from faying.study.keys.errors import refusal
from faying.study.keys.section import CountOrNone, NotNegative, Section, Switch

OutputField = Literal["pressure", "gap", "displacement"]


class OutputSection(Section):
    """[output]: what is written."""

    times: tuple[NotNegative, ...] = ()
    fields: tuple[OutputField, ...] = ("pressure", "gap", "displacement")
    report: Switch = True


def _no_sweep(value: Any) -> Any:
    if value is not False:
        message = (
            "the sweep over the contact stiffness is gone, remove it; the report tells how far "
            "surfaces penetrate, and 'penalty' in [[interface]] repeats a study with another"
        )
        raise refusal(message)
    return value


class ValidationSection(Section):
    """[validation]: what to find out beyond the load cases.

    Twice as many unseen loads more make the floor under all linear bases.
    """

    gone: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("box", "preload_factors"),
        "remove it: searches found milder loads than random ones and are gone",
    )
    unseen_loads: CountOrNone = 100
    penalty_sweep: Annotated[Literal[False], BeforeValidator(_no_sweep)] = False
    half_step: Switch = True
    reference: Literal["full", "worst", "none"] | None = None
