"""The table [[measurement]]."""

from typing import Literal

from faying.study.keys.section import Count, ExistingFile, Name, Positive, Section


class ResponseSection(Section):
    """[[measurement.response]]: a frequency response around the mode, at one amplitude."""

    file: ExistingFile
    amplitude: Positive | None = None
    level: Positive | None = None
    factor: Positive = 1.0
    of: Literal["displacement", "velocity", "acceleration"] = "displacement"


class MeasurementSection(Section):
    """[[measurement]]: see :class:`faying.assessment.measured_curve.MeasuredCurve`."""

    name: Name
    load_case: Name | None = None
    mode: Count | None = None
    frequency: Name | None = None
    file: ExistingFile | None = None
    response: tuple[ResponseSection, ...] = ()
    frequency_scatter: Positive | None = None
    damping_scatter: Positive | None = None
