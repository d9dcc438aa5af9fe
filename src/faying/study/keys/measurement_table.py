"""The table [[measurement]]."""

from typing import Literal

from faying.study.keys.section import Count, ExistingFile, Name, Positive, Section


class ResponseSection(Section):
    """[[measurement.response]]: a frequency response around the mode, at one amplitude.

    Attributes
    ----------
    amplitude : [length]
        Of the displacement, kept while the frequency was stepped; or at the resonance.
    of
        What responds, where the file does not say it.
    """

    file: ExistingFile
    amplitude: Positive
    of: Literal["displacement", "velocity", "acceleration"] = "displacement"


class MeasurementSection(Section):
    """[[measurement]]: see :class:`faying.assessment.measured_curve.MeasuredCurve`.

    Attributes
    ----------
    file
        Of the curve.
    response
        In its place: responses that each give a point of it.
    """

    name: Name
    load_case: Name
    mode: Count
    file: ExistingFile | None = None
    response: tuple[ResponseSection, ...] = ()
    frequency_scatter: Positive | None = None
    damping_scatter: Positive | None = None
