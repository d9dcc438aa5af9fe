"""The methods a user can name (design §4), each a basis and what the model sees of contact."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Method:
    """A way to reduce a model.

    Attributes
    ----------
    name
        As studies spell it.
    joint_modes
        ``"jim-a"``, ``"jim-b"``, or None for a basis without joint modes.
    compliance
        Whether the residual interface compliance is kept.
    """

    name: str
    joint_modes: str | None
    compliance: bool


METHODS = {
    method.name: method
    for method in (
        Method("craig-bampton", None, compliance=False),
        Method("jim-a", "jim-a", compliance=False),
        Method("jim-b", "jim-b", compliance=False),
        Method("compliance", None, compliance=True),
        Method("jim-a+compliance", "jim-a", compliance=True),
        Method("jim-b+compliance", "jim-b", compliance=True),
    )
}
