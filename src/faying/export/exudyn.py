"""Export with contact for Exudyn: a Python module and its data."""

import re
from pathlib import Path
from typing import Any

import numpy as np

from faying.exceptions import refuse_study
from faying.export.arrays import numpy_variables
from faying.reduction.reduced_model import ReducedModel
from faying.study.results.values import Results

PARTS = ("exudyn_joint.py", "exudyn_contact.py")
"""Source files that are copied; the second replaces its import in the first."""


def write(rom: ReducedModel, path: Path, _: Results | None = None) -> tuple[Path, ...]:
    """Write a module that adds the joint to a multibody system, and its ``.npz`` beside it.

    Characters that are invalid in module names, as in ``jim-b-20.py``, become underscores.

    Raises
    ------
    StudyError
        If contact is hard and the model has no residual compliance, so that contact forces are
        not a function of q.
    """
    _check_law(rom)
    module = path.with_name(f"{_importable(path.stem)}.py")
    data = module.with_suffix(".npz")
    module.write_text(_source(), encoding="utf-8")
    with data.open("wb") as file:
        np.savez_compressed(file, **_arrays(rom))
    return module, data


def _source() -> str:
    """Return the text of the module, which does not import faying."""
    whole, contact = (Path(__file__).with_name(name).read_text(encoding="utf-8") for name in PARTS)
    head, _, tail = whole.partition("from faying.")
    body = tail.split("\n", 1)[1]
    return head + contact[contact.index("Array = ") :] + body


def _arrays(rom: ReducedModel) -> dict[str, Any]:
    """Return the variables of the model, with those of floating frames if known."""
    floating = {
        "invariants": rom.invariants,
        "modes": rom.mesh.modes,
        "recovery_frame": rom.recovery_frame,
    }
    return {
        **numpy_variables(rom),
        "nodes": rom.mesh.nodes,
        "node_ids": rom.mesh.node_ids,
        **{name: value for name, value in floating.items() if value is not None},
    }


def _check_law(rom: ReducedModel) -> None:
    contact = rom.contact
    if contact.residual_compliance is None and np.isinf(contact.penalty).any():
        refuse_study(
            f"contact is hard and '{rom.method}' has no compliance beside its trial vectors, "
            "so contact forces are not a function of the coordinates, as Exudyn needs; "
            "export 'compliance' or a method ending in '+compliance', or give a penalty"
        )


def _importable(stem: str) -> str:
    name = re.sub(r"\W", "_", stem, flags=re.ASCII)
    return f"joint_{name}" if not name[:1].isalpha() else name
