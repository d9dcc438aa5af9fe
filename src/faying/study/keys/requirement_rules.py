"""Checks of requirements before a run: wrong names, and requirements that cannot be judged."""

from collections.abc import Iterator

from faying.assessment.requirements import ClosedRing, Requirements, misnamed
from faying.assessment.sealing import ring_around
from faying.assessment.verdicts import NO_FRICTION, NO_SLIP, ring_surface
from faying.joint.model import Model
from faying.reduction.projection import contact_surfaces
from faying.study.keys.errors import located, reject
from faying.study.keys.requirement_tables import RequirementSection
from faying.study.keys.tables import Study


def requirements_of(section: RequirementSection) -> Requirements:
    """Return the requirements of a study."""
    keys = {n: getattr(section, n) for n in type(section).model_fields if n != "margins"}
    rings = tuple(ClosedRing(**ring.model_dump()) for ring in section.closed_ring)
    return Requirements(**{**keys, "closed_ring": rings})


def check_requirements(study: Study, model: Model) -> None:
    """Refuse requirements on unknown interfaces.

    Raises
    ------
    StudyError
        One message with all unknown names.
    ModelError
        If a ring does not surround a hole.
    """
    requirements = requirements_of(study.requirement)
    wrong = misnamed(requirements, list(model.interfaces), model.contact.smooth_interfaces)
    reject(study.source, located(("requirement",), wrong))
    surfaces = contact_surfaces(model) if requirements.closed_ring else {}
    for ring in requirements.closed_ring:
        ring_around(surfaces[ring_surface(ring, surfaces)], ring.around)


def not_judged(study: Study, model: Model) -> Iterator[str]:
    """Yield the requirements that a run cannot judge, with reasons."""
    section, kinds = study.requirement, {case.kind for case in study.load_cases}
    rubbing = bool(model.contact.rubbing_interfaces)
    followed = rubbing and kinds & {"static", "cycle"}
    coefficient_known = rubbing or section.slip_friction is not None
    if section.min_slip_safety is not None and not (
        coefficient_known and kinds & {"static", "cycle"}
    ):
        yield f"min_slip_safety cannot be judged: {NO_SLIP}"
    if section.min_sliding_factor is not None and not followed:
        yield f"min_sliding_factor cannot be judged: {NO_FRICTION}"
    if section.min_opening_factor is not None and "static" not in kinds:
        yield "min_opening_factor cannot be judged: it needs a static load case"
