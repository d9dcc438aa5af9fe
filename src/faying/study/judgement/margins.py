"""The margins of bolts that a study demands, by the standard it names."""

from collections.abc import Mapping, Sequence

from faying.assessment.check import Check
from faying.assessment.joint_record import Assessment
from faying.assessment.strength.nasa_std_5020b import DesignFactors, margin_checks
from faying.assessment.strength.safeties import Safeties, with_safeties
from faying.assessment.strength.thread import Thread
from faying.assessment.strength.tightening import PreloadRange
from faying.joint.model import Model
from faying.joint.tangential import tangential_rows
from faying.reduction.projection import contact_surfaces
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import NamedLoad
from faying.study.keys.requirement_tables import MarginsSection

NASA, VDI = "nasa-std-5020b", "vdi-symbols"


def design_factors(section: MarginsSection) -> DesignFactors:
    """Return the factors of a study."""
    return DesignFactors(
        fitting=section.FF,
        ultimate=section.FS_u,
        yields=section.FS_y,
        separation=section.FS_sep,
        slip=section.FS_slip,
        shear_plane=section.shear_plane,
        separation_critical=section.separation_critical,
    )


def demanded_checks(
    margins: MarginsSection | None,
    ranges: Mapping[str, PreloadRange],
    system: Model | ReducedModel,
    threads: Mapping[str, Thread],
    loads: Sequence[NamedLoad],
    coefficients: Mapping[str, float],
    assessment: Assessment,
    units: str,
) -> tuple[Check, ...]:
    """Return the checks of bolts with what the standard of a study adds to them.

    Parameters
    ----------
    ranges
        Bolt to the range of its preload.
    loads
        Static load cases.
    coefficients
        Interface to the coefficient slip is judged with.
    assessment
        With the checks of the strength of bolts.

    Raises
    ------
    ModelError, ConvergenceError
        As :func:`faying.assessment.strength.nasa_std_5020b.margin_checks`.
    """
    if margins is None:
        return assessment.checks
    if margins.standard == VDI:
        safeties = Safeties(yields=margins.S_F, fatigue=margins.S_D, pressure=margins.S_p)
        return tuple(with_safeties(assessment.checks, safeties))
    added = margin_checks(
        system,
        contact_surfaces(system) if isinstance(system, Model) else system.interfaces,
        tangential_rows(system) if isinstance(system, Model) else system.tangential,
        threads,
        loads,
        {name: bolt.preload for name, bolt in assessment.bolts.items()},
        ranges,
        design_factors(margins),
        coefficients,
        units,
    )
    return (*assessment.checks, *added)
