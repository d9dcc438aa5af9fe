"""The table [[measurement]]."""

from typing import Literal

from faying.study.keys.section import Count, ExistingFile, Name, Positive, Section


class ResponseSection(Section):
    """[[measurement.response]]: a frequency response around the mode, at one amplitude.

    Attributes
    ----------
    amplitude : [length]
        Beside a backbone: of the displacement, kept while the frequency was stepped; or at the
        resonance.
    level : [1]
        Beside curves over frequency: of the load.
    factor : [1]
        What the numbers of the file are multiplied by to be in the units of the study.
    of
        What responds, where the file does not say it.
    """

    file: ExistingFile
    amplitude: Positive | None = None
    level: Positive | None = None
    factor: Positive = 1.0
    of: Literal["displacement", "velocity", "acceleration"] = "displacement"


class MeasurementSection(Section):
    """[[measurement]]: see :class:`faying.assessment.measured_curve.MeasuredCurve`.

    Attributes
    ----------
    load_case, mode
        Backbone that it stands beside.
    frequency
        In their place: harmonic load whose curves it stands beside.
    file
        Of the curve.
    response
        In its place: responses that each give a point of it.
    """

    name: Name
    load_case: Name | None = None
    mode: Count | None = None
    frequency: Name | None = None
    file: ExistingFile | None = None
    response: tuple[ResponseSection, ...] = ()
    frequency_scatter: Positive | None = None
    damping_scatter: Positive | None = None
