"""One reduced model in two lines: how large it is, and what its numbers are measured in."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from faying.reduction.reduced_model import ReducedModel


def model_sizes(rom: "ReducedModel") -> str:
    """Say which model it is and what its numbers are measured in."""
    units = rom.unit_set
    counts = {
        "coordinate": len(rom.K),
        "boundary displacement": sum(len(boundary.dofs) for boundary in rom.boundaries.values()),
        "bolt": len(rom.bolts),
        "contact point": rom.contact.n_points,
    }
    sizes = ", ".join(f"{n} {name}{'s' * (n != 1)}" for name, n in counts.items())
    modes = f" with {rom.joint_modes} joint modes" if rom.joint_modes else ""
    measures = (units.length, units.mass, units.time, units.force, units.pressure)
    return f"Model: {rom.method}{modes}, {sizes}\nUnits: {', '.join(measures)}"
