"""What the names of methods mean, for readers who see them for the first time."""

from faying.study.results import Results

CONSTRAINED = (
    "constraint modes of the boundaries, fixed-interface normal modes and a shape per bolt"
)
ONLY_THROUGH = "the reduced model sees contact through these shapes only"
EXACT = (
    "the flexibility that these shapes lack at the interface is added as a residual compliance, "
    "which makes static pressures those of the full model"
)
JIM_A = "joint modes of method A: answers to unit pressures on patches of the interface"
JIM_B = "joint modes of method B: answers to the contact forces of training runs"
MEANINGS = {
    "craig-bampton": f"{CONSTRAINED}; {ONLY_THROUGH}.",
    "jim-a": f"as craig-bampton, and {JIM_A}; {ONLY_THROUGH}.",
    "jim-b": f"as craig-bampton, and {JIM_B}; {ONLY_THROUGH}.",
    "compliance": f"{CONSTRAINED}; {EXACT}.",
    "jim-a+compliance": f"as jim-a; {EXACT}.",
    "jim-b+compliance": f"as jim-b; {EXACT}.",
    "trial-vector-derivatives": (
        "as craig-bampton, and derivatives of its shapes with respect to one another; "
        f"{ONLY_THROUGH}."
    ),
    "cone-greedy": "contact forces as sums, without negative parts, of chosen training forces.",
    "nmf": "contact forces as sums of non-negative factors of the training forces.",
    "deim": "contact forces interpolated from a few points of the interface.",
}


def meanings(results: Results) -> dict[str, str]:
    """Return what each method of a run is, in the order in which the study names them."""
    names = dict.fromkeys(name for case in results.cases.values() for name in case.methods)
    return {name: MEANINGS[name] for name in names if name in MEANINGS}
