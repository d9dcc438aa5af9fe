"""Results of the validation of a run as plain values."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from faying.assessment.choose_joint_modes import JointModeChoice


@dataclass(frozen=True, kw_only=True)
class LoadSpaceResult:
    """Errors of a reduced model over random loads of the training box.

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
    """Errors of methods at random loads that were not used for training.

    Attributes
    ----------
    n_loads : [1]
        Number of random loads from the training box.
    methods
        Errors by method and number of joint modes.
    """

    n_loads: int
    methods: Mapping[str, Mapping[int, LoadSpaceResult]]


@dataclass(frozen=True, eq=False, kw_only=True)
class ValidationRecord:
    """Results of the validation of a run.

    Attributes
    ----------
    load_space
        Errors at random loads of the training box; None without a box.
    choices
        Automatically chosen numbers of joint modes by basis.
    """

    load_space: LoadSpaceRecord | None = None
    choices: Mapping[str, JointModeChoice] = field(default_factory=dict)
