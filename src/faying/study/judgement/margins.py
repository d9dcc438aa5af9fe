"""Strength margins of bolts by the standard of a study."""

from collections.abc import Sequence
from dataclasses import replace

from faying.assessment.joint_judge import JointJudge, surfaces_of, tangential_of
from faying.assessment.joint_record import Assessment
from faying.assessment.strength.checks import Safeties, with_safeties
from faying.assessment.strength.nasa_std_5020b import DesignFactors, margin_checks
from faying.simulation.load import NamedLoad
from faying.study.keys.requirement_tables import MarginsSection

NASA, VDI = "nasa-std-5020b", "vdi-symbols"


def design_factors(section: MarginsSection) -> DesignFactors:
    """Return the design factors of a study."""
    return DesignFactors(
        fitting=section.FF,
        ultimate=section.FS_u,
        yields=section.FS_y,
        separation=section.FS_sep,
        slip=section.FS_slip,
        shear_plane=section.shear_plane,
        separation_critical=section.separation_critical,
    )


def with_margins(
    assessment: Assessment,
    judge: JointJudge,
    margins: MarginsSection | None,
    loads: Sequence[NamedLoad],
) -> Assessment:
    """Return an assessment with the bolt checks of the standard of a study added.

    The assessment has the strength checks of bolts; design factors multiply static load cases.
    """
    if margins is None:
        return assessment
    if margins.standard == VDI:
        safeties = Safeties(yields=margins.S_F, fatigue=margins.S_D, pressure=margins.S_p)
        return replace(assessment, checks=tuple(with_safeties(assessment.checks, safeties)))
    added = margin_checks(
        judge.exact,
        surfaces_of(judge.exact),
        tangential_of(judge.exact),
        judge.strengths.threads,
        loads,
        {name: bolt.preload for name, bolt in assessment.bolts.items()},
        judge.strengths.ranges,
        design_factors(margins),
        judge.coefficients,
        judge.system.units,
    )
    return replace(assessment, checks=(*assessment.checks, *added))
