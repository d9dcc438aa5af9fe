"""Training steps of method B, computed with the full or with a reduced model."""

from types import SimpleNamespace

import numpy as np

import faying as fy
from faying.joint.model import Model
from faying.study.keys.tables import BoxSide, TrainingSection
from faying.study.stages.offline import step_training


def test_a_reduced_model_trains_as_the_full_one(joint, classic):
    """Prior reduction of §15.3.4.2: contact through the compliance, motion by few modes."""
    period = 1 / fy.preloaded_frequencies(joint, 1)[0]
    rest = fy.solve_static(joint)
    forces, systems = {}, {}
    for system in ("full", "reduced"):
        training = TrainingSection(
            box=(BoxSide(boundary="tip", component="Fz", min=-500.0, max=500.0),),
            system=system,
            steps_per_period=40,
        )
        study = SimpleNamespace(reduction=SimpleNamespace(training=training))
        prepared = SimpleNamespace(study=study, model=joint, period=period, rest=rest)
        steps = step_training(prepared, classic)
        assert steps.n_steps == 40
        forces[system] = np.stack([response["forces"] for response in steps.forces([0, 1])])
        systems[system] = steps._solver.system
    assert isinstance(systems["full"], Model)
    # Ten vibration modes, and the shapes under loads of the boundary.
    assert len(systems["reduced"].K) == len(classic)
    off = np.abs(forces["reduced"] - forces["full"]) / forces["full"].max()
    # Of few modes just after the jump; measured 7.7e-3, and 4.9e-4 in the root mean square.
    assert off.max() < 0.02
    assert np.sqrt(np.mean(off**2)) < 1e-3
    assert np.ptp(forces["full"], axis=2).max() > 0.1 * forces["full"].max()
