"""Remarks on a run in addition to its verdict: peaks, errors, and choices with their reasons."""

from collections.abc import Iterator

from faying.assessment.accuracy import Accuracy
from faying.assessment.backbone import amplitude_unit
from faying.assessment.transient_error import (
    EXACT,
    LARGE_ERROR,
    OBSERVED_ON,
    OBSERVED_RATIOS,
    REMEDY,
    TRACTIONS_OBSERVED,
    remedy_hint,
)
from faying.display.facts import with_unit
from faying.display.quantities import percent
from faying.study.inputs.jumps import jump_sentence
from faying.study.judgement.comparison import backbone_errors
from faying.study.judgement.step_check import choice_sentence, step_choice
from faying.study.results.mode_choice import mode_sentences
from faying.study.results.second_solution import remedy_sentence, shapes_seconds
from faying.study.results.values import CaseResult, Results


def remarks(results: Results) -> list[str]:
    """Return the remarks that the console prints after a run."""
    steps = {name: step_choice(case) for name, case in results.cases.items()}
    return [
        *(f"Note: {text}" for text in results.notes),
        *vibrations(results),
        *_backbones(results),
        *_estimates(results),
        *(choice_sentence(name, choice) for name, choice in steps.items() if choice is not None),
        *mode_sentences(results.mode_choices, results.unit_set),
        *remedies(results),
        *(f"Doubtful: {said}" for said in jumps(results)),
        *([f"Reference: {results.reference_reason}"] if results.reference_reason else []),
    ]


def jumps(results: Results) -> list[str]:
    """Return a sentence about each load case in which loads jump."""
    time = results.unit_set.time
    said = (
        jump_sentence(name, case.jumps, time, history=case.kind == "history")
        for name, case in results.cases.items()
    )
    return [text for text in said if text]


def remedies(results: Results) -> list[str]:
    """Return a sentence about each transient that was solved again: the model and its cost."""
    shapes = shapes_seconds(results.timings)
    return [
        remedy_sentence(name, case.remedy, shapes)
        for name, case in results.cases.items()
        if case.remedy is not None
    ]


def hint(results: Results) -> str:
    """Return advice for further methods where estimated errors are large; empty elsewhere."""
    worst: dict[str, float] = {}
    for case in results.cases.values():
        estimates = [
            (name, result.response.estimate)
            for name, sizes in case.methods.items()
            for result in sizes.values()
        ]
        if not case.is_full:
            estimates.append((EXACT, case.reference.estimate))
        if case.remedy is not None:
            estimates.append((REMEDY, None))
        for name, estimate in estimates:
            error = 0.0 if estimate is None else estimate.max_relative_error
            error /= case.tolerance or LARGE_ERROR
            worst[name] = max(error, worst.get(name, 0.0))
    return remedy_hint(worst)


def vibrations(results: Results) -> list[str]:
    """Return sentences about modes with their damping, and peaks under harmonic loads."""
    return [*_modes(results), *_peaks(results)]


def _modes(results: Results) -> Iterator[str]:
    """Yield frequency and damping of each backbone at its ends and at its largest damping."""
    rate = results.unit_set.frequency
    for name, case in results.cases.items():
        for mode, curve in case.reference.backbones.items():
            unit = amplitude_unit(curve.measured_at, results.units)
            size = results.unit_set.of("force·length") if curve.over == "energy" else unit
            levels = curve.energy if curve.over == "energy" else curve.amplitude
            most = int(curve.damping_ratio.argmax())
            shown = dict.fromkeys((0, most, len(curve.frequency) - 1))
            slides = levels[curve.macroslip.astype(bool)]
            beyond = (
                f", all that touches slips from {with_unit(slides.min(), size)} on"
                if len(slides)
                else ""
            )
            told = (
                f"{with_unit(curve.frequency[row], rate)} with damping ratio "
                f"{percent(curve.damping_ratio[row])} at {with_unit(levels[row], size)}"
                for row in shown
            )
            yield f"{name}, mode {mode} at {curve.measured_at}: {', '.join(told)}{beyond}"


def _peaks(results: Results) -> Iterator[str]:
    """Yield the peaks of responses to harmonic loads, and their checks by transients."""
    rate = results.unit_set.frequency
    for name, record in results.frequencies.items():
        size = amplitude_unit(record.at, results.units)
        for level in record.peaks():
            peak, damping = level.peak, level.there("damping_ratio")
            ratio = "" if damping is None else f", damping ratio {damping:.2%}"
            missed = len(level.curve.missed)
            highest = (
                "is largest, without a peak between 'from' and 'to'," if peak.at_end else "peaks"
            )
            yield (
                f"{name}, level {peak.level:g}: {record.at} {highest} at "
                f"{with_unit(peak.frequency, rate)} with {with_unit(peak.amplitude, size)}{ratio}"
                f"{f', {missed} frequencies without a motion' if missed else ''}"
            )
        yield from (f"{name}, {check.sentence}" for check in record.checks)


def _backbones(results: Results) -> Iterator[str]:
    """Yield the errors of backbones of reduced models against the full model."""
    for name, case in results.cases.items():
        for method, sizes in case.methods.items():
            errors = backbone_errors(sizes[max(sizes)].response, case.reference) if sizes else None
            if errors is not None:
                yield (
                    f"Backbones {name}, {method}: frequencies off by at most "
                    f"{percent(errors.frequency)}, damping ratios by "
                    f"{percent(errors.damping)}"
                )


def _estimates(results: Results) -> list[str]:
    """Return sentences with the estimated errors of each transient, for the largest bases."""
    estimates = {name: dict(_estimated(case)) for name, case in results.cases.items()}
    said = [
        f"{name}, errors estimated without a full solution: "
        f"{', '.join(f'{method} {error.told}' for method, error in errors.items())}"
        for name, errors in estimates.items()
        if errors
    ]
    if said:
        low, high = OBSERVED_RATIOS
        observed = f"{OBSERVED_ON}; {TRACTIONS_OBSERVED}"
        said.append(f"(Estimates, {low:g} to {high:g} times the true error on {observed}.)")
    return [*said, *filter(None, [hint(results)])]


def _estimated(case: CaseResult) -> Iterator[tuple[str, Accuracy]]:
    """Yield method and estimated error of the largest basis of each method."""
    for method, sizes in case.methods.items():
        estimate = sizes[max(sizes)].response.estimate if sizes else None
        if estimate is not None:
            yield method, estimate
    if case.reference.estimate is not None:
        yield f"the reference, {case.reference_model}", case.reference.estimate
