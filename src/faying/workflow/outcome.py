"""What a command that computes leaves behind."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome:
    """Outcome of a study, or of many load cases on a reduced model.

    Attributes
    ----------
    converged
        Whether every solution was found.
    summary
        Contents of ``summary.json``.
    """

    converged: bool
    summary: Mapping[str, Any]
