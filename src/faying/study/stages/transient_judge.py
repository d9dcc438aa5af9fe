"""What a run knows of the pressures of a reduced transient beside the transient itself."""

from dataclasses import dataclass, replace

from faying.assessment.accuracy import Accuracy
from faying.assessment.recovery import recover_pressure
from faying.assessment.transient_error import finer_model, transient_error
from faying.simulation.integrators import Integrator
from faying.simulation.load import Load
from faying.simulation.solution import Solution
from faying.study.results.values import Response
from faying.study.stages.offline import PreparedJoint
from faying.study.stages.path_cases import rest_state


@dataclass(frozen=True, eq=False, kw_only=True)
class TransientJudge:
    """What judges reduced transients of one joint, which may fail."""

    joint: PreparedJoint

    def judged(
        self,
        name: str,
        response: Response,
        solution: Solution,
        load: Load,
        integrator: Integrator,
        *,
        recovered: bool,
    ) -> Response:
        """Return the response of a reduced transient with its estimated errors.

        The name is that of load case and model. Pressures may be recovered from the motion too.
        """
        books = self.joint.books
        if recovered:
            with books.stage("recovery"), books.attempt(f"{name}, recovered pressures"):
                pressure = recover_pressure(self.joint.model, solution).pressure
                response = replace(response, recovered_pressure=pressure)
        estimate = None
        with books.stage("estimated errors"), books.attempt(f"{name}, estimated error"):
            estimate = self._estimate(solution, load, integrator)
        return replace(response, estimate=estimate)

    def _estimate(self, solution: Solution, load: Load, integrator: Integrator) -> Accuracy:
        """Estimate how far off a transient is from that of the full model, without it."""
        finer = finer_model(self.joint.model, solution)
        joint = self.joint
        initial = rest_state(finer, joint.preload_path, joint.rest)
        return transient_error(finer, solution, load, integrator=integrator, initial=initial)
