"""What a run found beyond its load cases, as plain values."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from faying.assessment.choose_joint_modes import JointModeChoice


@dataclass(frozen=True, kw_only=True)
class LoadSpaceResult:
    """Errors of one reduced model over random loads of the training box.

    Attributes
    ----------
    median_error : [1]
        Median of the loads' largest relative pressure errors.
    worst_error : [1]
        Largest of them.
    """

    median_error: float
    worst_error: float


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadSpaceRecord:
    """Methods at loads they have not seen.

    Attributes
    ----------
    n_loads : [1]
        Random loads from the training box.
    methods
        Method name to joint mode count to errors.
    """

    n_loads: int
    methods: Mapping[str, Mapping[int, LoadSpaceResult]]


@dataclass(frozen=True, eq=False, kw_only=True)
class ValidationRecord:
    """What a run found beyond its load cases.

    Attributes
    ----------
    load_space
        Methods at random loads of the training box; None without one.
    choices
        Basis name to the number of joint modes chosen automatically.
    """

    load_space: LoadSpaceRecord | None = None
    choices: Mapping[str, JointModeChoice] = field(default_factory=dict)
