"""The table [[measurement]]."""

from faying.study.keys.section import Count, ExistingFile, Name, Positive, Section


class MeasurementSection(Section):
    """[[measurement]]: see :class:`faying.assessment.measured_curve.MeasuredCurve`."""

    name: Name
    load_case: Name
    mode: Count
    file: ExistingFile
    frequency_scatter: Positive | None = None
    damping_scatter: Positive | None = None
