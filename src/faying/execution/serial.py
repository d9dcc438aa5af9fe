"""Tasks one after the other, in this process."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from faying.execution.executor import Prepare, Results


@dataclass(frozen=True)
class SerialExecutor:
    """The reference of all executors: nothing is sent anywhere."""

    @property
    def n_workers(self) -> int:
        """Always one: this process."""
        return 1

    def map(self, prepare: Prepare, tasks: Sequence[Any]) -> Results:
        """Yield place and result of each task in their order."""
        if not tasks:
            return
        function = prepare()
        for number, task in enumerate(tasks):
            yield number, function(task)
