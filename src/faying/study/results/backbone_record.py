"""How the backbones of a load case are packed into named arrays until the run ends."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from faying._typing import Matrix
from faying.assessment.backbone import Backbone


def packed_backbone(backbone: Backbone, prefix: str) -> dict[str, Matrix]:
    """Flatten a backbone to named arrays; what is None is left out."""
    values = {one.name: getattr(backbone, one.name) for one in fields(Backbone)}
    return {
        f"{prefix}/{name}": np.asarray(value, dtype=str if name == "remarks" else None)
        for name, value in values.items()
        if value is not None
    }


def unpacked_backbone(arrays: Mapping[str, Matrix], prefix: str) -> Backbone:
    """Return the backbone that :func:`packed_backbone` flattened."""
    names = [one.name for one in fields(Backbone) if f"{prefix}/{one.name}" in arrays]
    values: dict[str, Any] = {name: arrays[f"{prefix}/{name}"] for name in names}
    values["mode"] = int(values["mode"])
    values["small_frequency"] = float(values["small_frequency"])
    values["measured_at"] = str(values["measured_at"])
    values["units"], values["over"] = str(values["units"]), str(values["over"])
    values["remarks"] = tuple(map(str, values["remarks"]))
    return Backbone(**values)
