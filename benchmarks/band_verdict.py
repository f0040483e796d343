"""What the study of bands asks of a verdict: the one place that knows the public API."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from typing_extensions import override

from benchmarks.band_truths.rig import Array, Curve, Points, Rig
from stickslip import Measurement, select
from stickslip.friction import bound
from stickslip.identify import BandVerdict
from stickslip.identify.judgement import Judgement
from stickslip.identify.problems.driven_runs import DrivenProblem
from stickslip.identify.problems.free_motion import FreeMotionProblem
from stickslip.identify.problems.record_signals import records_of
from stickslip.identify.problems.records import RecordProblem
from stickslip.identify.problems.tables import TableProblem, readings_of
from stickslip.identify.projection import PLACES, Projector, Target, is_signed, names_of
from stickslip.identify.propose import widths_of_another

MOST_MOTIONS = 4
"""Further free motions or records that are made at most."""
ROUTES = {"tables": None}
"""Routes of kinds; all others are judged by their force balance."""


@dataclass(frozen=True, kw_only=True)
class Fault:
    """A property of the rig or a fault that is named without doubt."""

    kind: str
    instead: frozenset[str]
    """What it is said not to be told from."""
    fault: bool
    """Whether it is a fault."""


@dataclass(frozen=True, kw_only=True)
class HandedOver:
    """The law that leaves a verdict, beside the band that was judged."""

    off: float
    """Share of friction by which it is off the middle of the band, at 95 % of the places ..."""
    stated: float
    """... and which share was stated."""

    @property
    def holds(self) -> bool:
        """Whether it is as close as was stated."""
        return self.off <= self.stated


def handed_over(verdict: BandVerdict) -> HandedOver | None:
    """Return how far the law handed over is from the middle of the band; None where none is."""
    judgement = verdict.judgement
    if verdict.best is None or not judgement.named.structure:
        return None
    rows = judgement.problem.asked()
    if np.ptp(judgement.problem.scale(rows)) > 0.0:  # at the load of the law
        rows = judgement.problem.at(np.unique(rows.velocity))
    target = Target(
        draws=judgement.problem.steady(rows, judgement.draws),
        tolerance=judgement.tolerance,
        scale=judgement.problem.scale(rows),
    )
    composed = judgement.composition
    law = bound(verdict.law, composed.inputs)
    force = np.array([float(law.steady(v, composed.normal())) for v in rows.velocity.tolist()])
    force += offset_beside(verdict)
    off = float(np.quantile(np.abs(force - target.middle) / target.size, PLACES))
    stated = max(verdict.closest.distance, judgement.tolerance)
    return HandedOver(off=round(off, 12), stated=round(stated, 12))  # rounding is no difference


def offset_beside(verdict: BandVerdict) -> float:
    """Return the constant force of the mechanism that was found: one that was given is no part."""
    result = not verdict.judgement.offset
    return float(getattr(verdict.mechanism, "offset", 0.0)) if result else 0.0


def told(judgement: Judgement) -> bool:
    """Return whether friction is distinguished from zero and a law of it is named."""
    return judgement.is_told and bool(judgement.named.structure)


def judged(rig: Rig) -> "Judged":
    """Return the verdict on a rig."""
    return KINDS.get(rig.kind, Judged)(rig)


ALIKE: Mapping[str, frozenset[str]] = {
    "delay": frozenset({"delay", "lag", "latency", "flexible", "resonance", "backlash", "limit"}),
    "force": frozenset({"force", "spring", "ripple", "offset_drift"}),
    "place": frozenset({"place", "level_ripple"}),
    "temperature": frozenset({"level*temperature", "viscous*temperature"}),
    "inertia_given": frozenset({"inertia_error", "force_gain", "position_scale"}),
    "mechanism_given": frozenset({"mechanism", "force_gain"}),
}
"""What findings are called in the truths, and what they say they cannot be distinguished from."""


class Judged:
    """The verdict of `select`."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.verdict = self._selected()
        told = [finding.term for finding in self.verdict.findings if finding.asserted]
        own = told if rig.kind == "tables" else []
        memory = ["memory"] if getattr(self.verdict.judgement.problem, "memory", "") else []
        # where friction is not told from zero, the law that is closest is not recommended
        named = self.verdict.family if self.verdict.judgement.is_told else ()
        self.family = (*named, *own, *memory)
        self.set = [(*item, *own, *memory) for item in self.verdict.set]
        self.gain = self.verdict.judgement.named.distance
        self.known = self.verdict.judgement.known
        self.law = handed_over(self.verdict)
        self.parameters = self.verdict.parameters
        self.faults = [
            Fault(
                kind=item, instead=ALIKE.get(item, frozenset()) | {item}, fault=rig.kind != "tables"
            )
            for item in told
        ]
        self.doubts = False

    def _selected(self, validate: Measurement | None = None) -> Any:
        rig = self.rig
        return select(
            rig.mechanism,
            None,
            rig.measurement,
            vary=["friction.*", *rig.unknown] if rig.unknown else None,
            route=ROUTES.get(rig.kind, "balance"),
            validate=validate,
        )

    def band(self, points: Points, *, all_along: bool = False) -> Any:
        """Return low, median, high [N] of the steady friction at points (n,)."""
        return self.verdict.band(
            points.velocity, points.load, points.inputs or None, all_along=all_along
        )

    def readings(self, points: Points, level: float) -> Any:
        """Return low, median, high [N] of new readings at points (n,)."""
        return self.verdict.readings(
            points.velocity, points.load, points.inputs or None, level=level
        )

    def predicted(self, points: Points) -> Array | None:
        """Return friction [N] by the named law at points (n,)."""
        judgement = self.verdict.judgement
        at = judgement.problem.at(points.velocity, points.load, points.inputs or None)
        return np.asarray(judgement.acting(at))

    def nearest(self, curves: Sequence[Curve]) -> Mapping[str, float]:
        """Return parameters of the law named for a table, laid through the mean of true curves.

        By path; they are what an interval of that law is of, where it is not the true one.
        """
        if self.rig.kind not in ("tables", "maps") or not curves or not self.verdict.family:
            return {}
        judgement, problem = self.verdict.judgement, self.verdict.judgement.problem
        structure = judgement.named.structure
        rows, weights = problem.metric(problem.places(), judgement.target.allowed)
        at = Points(velocity=rows.velocity, load=rows.load, inputs=dict(rows.inputs))
        free, begin = problem.free(judgement.named)
        positive = np.array([not is_signed(name) for name in names_of(structure)])
        laid = Projector(lambda x: problem.design(x, rows), free, weights, positive)
        curve = np.mean([curve(at) for curve in curves], axis=0, keepdims=True)
        coefficients, shaped = laid(curve, [structure, *begin])
        composed = problem.composition(problem.tied(shaped), coefficients, offset=judgement.offset)
        return {path: float(np.ravel(x)[0]) for path, x in composed.paths().items()}

    def inside(self, record: Measurement) -> float:
        """Return the share of the readings of another record within their band."""
        return float(self._selected(record).inside)

    def shown(self, record: Measurement, levels: Sequence[float]) -> list[float]:
        """Return the shares of what another record shows that lie in the bands of levels."""
        judgement, mechanism = self.verdict.judgement, self.rig.mechanism
        if self.rig.kind == "tables":
            table = readings_of(mechanism, record)
            rows, shown = judgement.problem.like(table.rows), table.friction
        else:
            rows = judgement.problem.like(records_of(mechanism, record, offset=True))
            shown = rows.response
        bands = [judgement.reading_band(rows, level) for level in levels]
        return [float(np.mean((b.low <= shown) & (shown <= b.high))) for b in bands]

    @property
    def expected(self) -> float:
        """Width that is expected after what is advised, over today's."""
        further = self._further()
        return further[self._count(further) - 1] if further else float(self.verdict.shrinks)

    def _further(self) -> Sequence[float]:
        """Return expected widths after further records or free motions; none of tables."""
        judgement = self.verdict.judgement
        problem = judgement.problem
        if isinstance(problem, FreeMotionProblem):
            return problem.further(judgement.draws, problem.start_of(judgement.draws))
        if isinstance(problem, RecordProblem | DrivenProblem):
            return widths_of_another(*problem.run_sizes, 0.5 * judgement.known, problem.runs)
        return ()

    @staticmethod
    def _count(shrinks: Sequence[float]) -> int:
        """Return how many are made: those that halve the band, if these are few."""
        return min(next((k for k, x in enumerate(shrinks, 1) if x <= 0.5), 1), MOST_MOTIONS)

    def doubtful(self, points: Points) -> Any:
        """Return the band that what is advised is to narrow: of records, that of another one."""
        new = isinstance(self.verdict.judgement.problem, RecordProblem | DrivenProblem)
        rows = self.verdict.judgement.problem.at(points.velocity, points.load, points.inputs)
        return self.verdict.judgement.band(rows, new=True) if new else self.band(points)

    @property
    def made(self) -> int:
        """Number of readings of a table, or of records, that were made."""
        problem = self.verdict.judgement.problem
        return problem.table.total if isinstance(problem, TableProblem) else problem.runs

    @property
    def halves(self) -> int | None:
        """Number of readings that are said to halve the band, where it is above those proposed."""
        halves = getattr(self.verdict, "halves", None)
        return halves if halves is not None and halves > len(self.verdict.places) else None

    def advised(self, count: int | None = None) -> Points | None:
        """Return where readings are proposed, or more; of motions the shares of the start."""
        verdict, problem = self.verdict, self.verdict.judgement.problem
        if further := self._further():
            share = 1.0
            if isinstance(problem, FreeMotionProblem):
                share = problem.start_of(verdict.judgement.draws)
            return Points(velocity=np.full(self._count(further), share))
        at = np.arange(len(verdict.places))
        if count is not None:
            at = np.resize(at, count)
        places = np.array(verdict.places)[at]
        if not len(places):
            return None
        known = {name: np.array(x)[at] for name, x in verdict.conditions.items()}
        rows = problem.at(places, known.pop("load", None), known)
        loaded = self.rig.kind == "tables" and problem.model.frame.loaded
        return Points(velocity=places, load=rows.load if loaded else None, inputs=rows.inputs)


class Travelled(Judged):
    """The verdict of `select` on travels, whose points are settings."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.verdict = select(rig.mechanism, None, rig.measurement, t_end=rig.t_end)
        judgement = self.verdict.judgement
        self.family = (judgement.named,)
        self.set = list(self.verdict.set)
        self.gain = 0.0 if judgement.explained else 1.0
        self.known, self.law = math.nan, None
        self.parameters = [
            Limits(path=own.path, low=own.low, high=own.high, low_any=any_.low, high_any=any_.high)
            for own, any_ in zip(
                self.verdict.closest.fit.estimates, self.verdict.intervals, strict=True
            )
            # coefficients of other powers of the speed are other quantities
            if own.path.endswith("kinetic_coefficient") or judgement.named in (rig.family or ())
        ]
        self.faults, self.doubts = [], False

    @override
    def band(self, points: Points, *, all_along: bool = False) -> Any:
        """Return low, median, high [m] of the travel at settings (n,)."""
        return self.verdict.band(points.velocity, all_along=all_along)

    @override
    def readings(self, points: Points, level: float) -> Any:
        """Return low, median, high [m] of new readings at settings (n,)."""
        return self.verdict.readings(points.velocity, level=level)

    @override
    def predicted(self, points: Points) -> Array | None:
        """Return travels [m] by the named law at settings (n,)."""
        return np.asarray(self.verdict.judgement.named_travels(points.velocity))

    @override
    def doubtful(self, points: Points) -> Any:
        return self.band(points)

    @property
    @override
    def made(self) -> int:
        return len(self.rig.measurement.trials)

    @property
    @override
    def expected(self) -> float:
        return float(self.verdict.shrinks)

    @override
    def advised(self, count: int | None = None) -> Points | None:
        """Return the settings at which readings are proposed; of more, none are stated."""
        settings = np.array(self.verdict.places)
        return Points(velocity=settings) if len(settings) and count is None else None


KINDS: Mapping[str, type[Judged]] = {"travels": Travelled}
"""Verdicts of kinds that are no friction over the speed."""


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Intervals of a parameter, as `Interval` of other kinds has them."""

    path: str
    low: float
    high: float
    low_any: float
    high_any: float
