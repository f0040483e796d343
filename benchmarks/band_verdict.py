"""What the study of bands asks of a verdict: the one place that knows the public API."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from typing_extensions import override

from benchmarks.band_truths.rig import Array, Points, Rig
from stickslip import Measurement, select
from stickslip.identify.problems.record_signals import records_of
from stickslip.identify.problems.tables import readings_of
from stickslip.identify.verdict import groups_of

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


def judged(rig: Rig) -> "Judged":
    """Return the verdict on a rig."""
    return KINDS.get(rig.kind, Judged)(rig)


class Judged:
    """The verdict of `select`."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.verdict = self._selected()
        judgement = self.verdict.judgement
        # the route of records marks the family of laws with a memory, and always has an inertia
        self.family = tuple(x for x in self.verdict.family if x != "inertia")
        self.set = [tuple(x for x in one if x != "inertia") for one in self.verdict.set]
        self.gain = judgement.comparison.curve_gain
        self.parameters = self.verdict.parameters
        terms = judgement.problem.terms
        self.faults = [
            Fault(
                kind=one.term,
                instead=frozenset({one.term, *one.instead}),
                fault=terms[one.term].role == "fault",
            )
            for one in self.verdict.causes
            if one.asserted and one.needed
        ]
        self.doubts = any(not one.asserted for one in self.verdict.causes)
        self.hidden = " ".join(itertools.chain(*groups_of(judgement)))

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
        return np.asarray(
            self.verdict.named_curve(points.velocity, points.load, points.inputs or None)
        )

    def inside(self, record: Measurement) -> float:
        """Return the share of the readings of another record within their band."""
        return float(self._selected(record).inside)

    def shown(self, record: Measurement, levels: Sequence[float]) -> list[float]:
        """Return the shares of what another record shows that lie in the bands of levels."""
        judgement = self.verdict.judgement
        other = judgement.problem.of(records_of(self.rig.mechanism, record, offset=True))
        bands = [judgement.reading_band(other.rows, level) for level in levels]
        return [float(np.mean((b.low <= other.response) & (other.response <= b.high)))
                for b in bands]  # fmt: skip

    def advised(self) -> Points | None:
        """Return no places: records have no advice."""
        return None


class JudgedTable(Judged):
    """The verdict of `select` on a table."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.verdict = self._selected()
        beside = [one.term for one in self.verdict.findings if one.asserted]
        self.family = (*self.verdict.family, *beside)
        self.set = [(*one, *beside) for one in self.verdict.set]
        self.gain = self.verdict.judgement.named.distance
        self.parameters = self.verdict.parameters
        self.faults = [
            Fault(kind=one.term, instead=frozenset({one.term}), fault=False)
            for one in self.verdict.findings
            if one.asserted
        ]
        self.doubts, self.hidden = False, ""

    @override
    def shown(self, record: Measurement, levels: Sequence[float]) -> list[float]:
        """Return the shares of the readings of another table in the bands of levels."""
        judgement = self.verdict.judgement
        other = readings_of(self.rig.mechanism, record)
        rows = judgement.problem.like(other.rows)
        bands = [judgement.reading_band(rows, level) for level in levels]
        return [float(np.mean((b.low <= other.friction) & (other.friction <= b.high)))
                for b in bands]  # fmt: skip

    @override
    def advised(self) -> Points | None:
        """Return where readings are proposed."""
        places, problem = np.array(self.verdict.places), self.verdict.judgement.problem
        if not len(places):
            return None
        rows = problem.at(places)
        loaded = problem.model.frame.loaded
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
        self.parameters = [
            Limits(path=own.path, low=own.low, high=own.high, low_any=any_.low, high_any=any_.high)
            for own, any_ in zip(
                self.verdict.closest.fit.estimates, self.verdict.intervals, strict=True
            )
            # coefficients of other powers of the speed are other quantities
            if own.path.endswith("kinetic_coefficient") or judgement.named in (rig.family or ())
        ]
        self.faults, self.doubts, self.hidden = [], False, ""

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
    def advised(self) -> Points | None:
        """Return no places: the study of travels has no further readings."""
        return None


KINDS: Mapping[str, type[Judged]] = {"tables": JudgedTable, "travels": Travelled}
"""Verdicts of kinds that are no records."""


@dataclass(frozen=True, kw_only=True)
class Limits:
    """Intervals of a parameter, as `Interval` of other kinds has them."""

    path: str
    low: float
    high: float
    low_any: float
    high_any: float
