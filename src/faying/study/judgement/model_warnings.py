"""What of a joint is not as declared: contact area that is missing, bodies that nothing holds."""

from collections.abc import Mapping

import numpy as np

from faying.assessment.weak_share import weak_warnings
from faying.joint.diagnosis import AS_A_WHOLE, suspension
from faying.joint.model import Model
from faying.study.keys.tables import Study
from faying.study.results.values import CaseResult, Results

ALMOST_ALL = 0.99
"""Share of a declared area below which something of it was left out: facets follow curves."""


def kept_share(area: float, declared_area: float | None) -> float | None:
    """Return the share of a declared area that is in contact; None where none was declared."""
    return None if not declared_area else min(area / declared_area, 1.0)


def missing_contact(name: str, area: float, declared_area: float | None) -> str:
    """Say of an interface what is missing of its declared area; nothing if it is all there."""
    share = kept_share(area, declared_area)
    if share is None or share >= ALMOST_ALL:
        return ""
    return (
        f"interface '{name}': {share:.0%} of the declared contact area is paired ({area:.6g} of "
        f"{declared_area:.6g}, the smaller side); the rest sees nothing of the other side along "
        "its normal, or lies beyond the search distance"
    )


def missing_contacts(results: Results) -> list[str]:
    """Say what is missing of the declared contact of all interfaces of a run."""
    said = (
        missing_contact(name, float(face.weights.sum()), face.declared_area)
        for name, face in results.interfaces.items()
    )
    return [text for text in said if text]


def unheld(model: Model) -> list[str]:
    """Say that a joint can move as a whole, or swings on springs."""
    count, swings = model.rigid_motions.shape[1], suspension(model)
    return [*([AS_A_WHOLE.format(count=count)] if count else []), *([swings] if swings else [])]


def unmeasured(study: Study, cases: Mapping[str, CaseResult]) -> list[str]:
    """Name the modes that leave the place still at which a backbone measures amplitudes."""
    said = []
    for case in study.load_cases:
        if case.kind == "backbone" and case.name in cases:
            curves = cases[case.name].reference.backbones
            still = [str(mode) for mode in sorted(case.modes) if str(mode) not in curves]
            if still:
                said.append(
                    f"load case '{case.name}': mode {', '.join(still)} is left out: it leaves "
                    f"'{case.at}' still, where its amplitude would be measured"
                )
    return said


def barely_held(results: Results) -> list[str]:
    """Say where weak springs carry what contact and friction should."""
    shares: dict[str, dict[str, float]] = {}
    for name, case in results.cases.items():
        for bodies, share in case.reference.weak_shares.items():
            shares.setdefault(bodies, {})[name] = float(np.max(share))
    return weak_warnings(shares)
