"""Memory that a transient of the full model takes in a study, beyond what was there before it.

``python benchmarks/transient_memory.py SIZE COUNT [TOLERANCE]`` prints a row: default lap joint
with edges of SIZE mm, COUNT times 10 µs in as many steps, or in steps that hold a TOLERANCE.
"""

import resource
import sys
import tempfile
import time
from pathlib import Path

from faying.study.keys.schema import parse_study
from faying.study.stages.full_transients import FullTransient, full_transients
from faying.study.stages.offline import prepare_joint

STUDY = """
[model]
source = "lap-joint"
lap_joint = {{ element_size = {size} }}

[damping]
beta = 1e-6

[[bolt]]
name = "bolt"
preload = 5e3

[[load_case]]
name = "push"
kind = "step"
rise_time = 2e-4
forces = [{{ boundary = "tip", component = "Fz", value = -200.0 }}]
duration = {duration}
{step}
"""


def main(size: str, count: int, tolerance: str | None) -> None:
    """Print degrees of freedom, instants, steps, memory in MB and processor seconds."""
    step = f'step = "auto"\ntolerance = {tolerance}' if tolerance else "step = 1e-5"
    text = STUDY.format(size=size, duration=count * 1e-5, step=step)
    with tempfile.TemporaryDirectory() as folder:
        study = parse_study(text, Path(folder) / "joint.toml")
        joint = prepare_joint(study)
    before, begin = used(), time.process_time()
    (found,) = full_transients(joint, [FullTransient(case=study.load_cases[0])])
    spent, n_time = time.process_time() - begin, len(found.pressure)
    steps = n_time - 1 if found.substeps is None else int(found.substeps.sum())
    sys.stdout.write(
        f"| {joint.model.structure.n_dof} | {n_time} | {steps} | {used() - before:.0f} | "
        f"{spent:.1f} |\n"
    )


def used() -> float:
    """Return the most memory that this process has had so far [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), sys.argv[3] if sys.argv[3:] else None)
