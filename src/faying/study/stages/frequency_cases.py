"""Harmonic loads of a study: the response from the backbone, and by harmonic balance."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TypeVar

import numpy as np

from faying.assessment.backbone import Backbone
from faying.assessment.backbone_response import backbone_response
from faying.assessment.forced_joint import ForcedJoint, linear_range
from faying.assessment.modal_cycles import ModalCycle
from faying.assessment.resonance import resonance, steady_state
from faying.assessment.response_curve import (
    FrequencyResponse,
    ResponseCurve,
    boundary_components,
    remarks_of,
)
from faying.assessment.transient_check import TransientCheck
from faying.exceptions import ConvergenceError, naming
from faying.reduction.reduced_model import ReducedModel
from faying.study.keys.frequency_rules import shown_place
from faying.study.keys.frequency_table import FrequencySection
from faying.study.keys.measurements import measured_responses
from faying.study.results.frequency_record import FrequencyRecord
from faying.study.stages.offline import PreparedJoint
from faying.study.stages.path_cases import rest_state

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class ResonantMode:
    """The backbone of the mode in resonance; None without one."""

    backbone: Backbone | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class FrequencyRunner:
    """Solver of a harmonic load of a run.

    Attributes
    ----------
    joint
        Prepared joint, whose full model is solved.
    rom
        Reduced model for transients as a check; None where it could not be built.
    """

    swept: FrequencySection
    joint: PreparedJoint
    rom: ReducedModel | None

    def solve(self) -> FrequencyRecord:
        """Return the responses; remarks name the frequencies that did not converge."""
        with naming(f"frequency '{self.swept.name}'"):
            seconds, backbone, expected = 0.0, None, None
            with self.joint.books.attempt(f"{self.swept.name}, curve from the backbone"):
                kept, took = self._piece(ResonantMode, "backbone", self._backbone)
                backbone = kept.backbone
                if backbone is not None:
                    expected = backbone_response(
                        self.joint.model,
                        backbone,
                        self.swept.load,
                        (self.swept.lowest, self.swept.highest),
                        self.swept.levels,
                        initial=self.joint.rest,
                    )
                seconds += took
            curves, checks = [], []
            for level in self.swept.levels:
                compute = partial(self._level, level)
                curve, took = self._piece(ResponseCurve, f"level {level}", compute)
                curves.append(curve)
                seconds += took
                if self.swept.check is not None and len(curve.frequency):
                    with self.joint.books.attempt(f"{self.swept.name}, level {level:g}, transient"):
                        name, compare = f"transient {curve.level}", partial(self._transient, curve)
                        checks.append(self._piece(TransientCheck, name, compare)[0])
            still, _ = self._piece(ResponseCurve, "linear", self._linear)
        return FrequencyRecord(
            at=self._at,
            response=FrequencyResponse(
                load=self.swept.load,
                curves=tuple(curves),
                linear=still,
                remarks=remarks_of(curves),
                units=self.joint.model.units,
            ),
            expected=expected,
            backbone=backbone,
            checks=tuple(checks),
            measured=measured_responses(self.joint.study, self.swept, self._at),
            seconds=seconds,
        )

    def _piece(self, kind: type[T], name: str, compute: Callable[[], T]) -> tuple[T, float]:
        """Return a piece, stored or computed, and the seconds of its computation."""
        return self.joint.books.timed_value(kind, f"frequency {self.swept.name}, {name}", compute)

    @property
    def _at(self) -> str:
        return shown_place(self.swept, boundary_components(self.joint.model))

    @cached_property
    def _forced(self) -> ForcedJoint:
        with self.joint.books.stage(f"{self.swept.name}: stuck joint"):
            return ForcedJoint.of(
                self.joint.model, self.swept.load, self.joint.rest, self.swept.asked
            )

    def _linear(self) -> ResponseCurve:
        return self._forced.linear(1.0, linear_range(self.swept.asked))

    def _level(self, level: float) -> ResponseCurve:
        forced, name = self._forced, f"{self.swept.name}: level {level:g}"
        with self.joint.books.stage(name, self.swept.points) as advance:
            return forced.curve(
                level,
                harmonics=self.swept.harmonics,
                samples=self.swept.samples,
                progress=advance,
            )

    def _backbone(self) -> ResonantMode:
        """Return the backbone of the mode in resonance; an empty record without one."""
        with self.joint.books.stage(f"{self.swept.name}: backbone") as advance:
            resonant = resonance(
                self.joint.model,
                self.swept.load,
                (self.swept.lowest, self.swept.highest),
                self.swept.levels,
                self._at,
                self.joint.rest,
            )
            if resonant is None:
                return ResonantMode()
            cycles = list[ModalCycle]()
            for number in range(len(resonant.analysis.levels)):
                name = f"backbone, amplitude {number + 1}"
                compute = partial(resonant.analysis.cycle, number)
                try:
                    cycle, _ = self._piece(ModalCycle, name, compute)
                except ConvergenceError:
                    # The curve then ends below the peak, as its remarks state.
                    if not cycles:
                        raise
                    break
                cycles.append(cycle)
                advance(1)
                if resonant.resists(cycle):
                    break
            return ResonantMode(backbone=resonant.analysis.backbone(cycles))

    def _transient(self, curve: ResponseCurve) -> TransientCheck:
        """Return the check of the peak of a curve by a transient."""
        if self.rom is None:
            message = "no reduced model could be built to integrate"
            raise ConvergenceError(message)
        peak = curve.peak(self._at)
        name = f"{self.swept.name}: transient, level {curve.level:g}, periods"
        with self.joint.books.stage(name) as advance:
            settled = steady_state(
                self.rom,
                self.swept.load,
                curve.level,
                peak.frequency,
                rest_state(self.rom, self.joint.preload_path, self.joint.rest),
                progress=advance,
            )
        motion = settled.fundamental[settled.components.index(self._at)]
        return TransientCheck(
            level=curve.level,
            frequency=peak.frequency,
            amplitude=peak.amplitude,
            transient_amplitude=float(np.abs(motion)),
            phase=peak.phase,
            transient_phase=float(np.angle(motion, deg=True)),
            periods=settled.periods,
            to_come=settled.to_come,
        )


def frequency_records(
    joint: PreparedJoint, rom: ReducedModel | None
) -> Mapping[str, FrequencyRecord]:
    """Return the results of all harmonic loads of a study, by name."""
    return {
        swept.name: FrequencyRunner(swept=swept, joint=joint, rom=rom).solve()
        for swept in joint.study.frequencies
    }
