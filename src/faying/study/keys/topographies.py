"""[[interface.topography]] and [[interface.crown]]: initial gaps from the form of surfaces."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

from faying.interface.gap_field import with_gap_offset
from faying.interface.surface_scan import read_scan
from faying.interface.topography import Crown, ScanPlacement, crown_gap, topography
from faying.joint.model import Model
from faying.study.keys.section import ExistingFile, Number, Point, Positive, Section


class TopographySection(Section):
    """[[interface.topography]]: see :class:`faying.interface.topography.ScanPlacement`."""

    file: ExistingFile
    of: Literal["minus", "plus", "gap"]
    origin: Point
    along: Point
    tilt: Literal["remove", "keep"] = "remove"
    wavelength: Positive | Literal["auto"] = "auto"
    scale: Positive = 1.0

    @property
    def placement(self) -> ScanPlacement:
        """Placement of the scan: all keys of the table but the file."""
        return ScanPlacement(**self.model_dump(exclude={"file"}))


class CrownSection(Section):
    """[[interface.crown]]: see :class:`faying.interface.topography.Crown`."""

    origin: Point
    along: Point
    distance: Positive
    height: Number
    exponent: Positive = 2.0


def with_crowns(model: Model, crowns: Mapping[str, Sequence[CrownSection]]) -> Model:
    """Return a model with the gaps of crowned surfaces, interface by interface."""
    for name, sections in crowns.items():
        interface = model.interfaces[name]
        gap = crown_gap(interface, [Crown(**section.model_dump()) for section in sections])
        model = model.with_interfaces({name: with_gap_offset(interface, gap)})
    return model


def with_topographies(model: Model, scans: Mapping[str, Sequence[TopographySection]]) -> Model:
    """Return a model with the gaps that scans leave, one by one, noted in its source."""
    for name, sections in scans.items():
        interface = model.interfaces[name]
        read = [(read_scan(section.file), section.placement) for section in sections]
        gap, notes = topography(interface, read)
        model = model.with_interfaces({name: with_gap_offset(interface, gap)})
        noted = (*model.assembly.ignored, *notes)
        model = replace(model, assembly=replace(model.assembly, ignored=noted))
    return model
