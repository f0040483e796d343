"""Slides as residuals that depend on a law, and the fit of a law to them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.data import LawEstimates, Measurement
from stickslip.engine.simulation import simulate
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits import (
    Fit,
    FreeParameters,
    Inference,
    OptimizeResult,
    Parameters,
    Problem,
    ResidualJacobian,
    StartEstimate,
    Watch,
    bounds_met,
    estimates_for,
    estimates_of,
    infer,
    search,
    sentences_of,
    told,
)
from stickslip.mechanisms import Mechanism, SpringBlock
from stickslip.quantities import vary
from stickslip.show.formatting import quantity

if TYPE_CHECKING:
    from stickslip.show.display import Drawing, Target

Array = NDArray[np.float64]

DURATION = "duration"
"""Condition that makes a travel a slide: the time after which it was read [s]."""
NUDGE = 1e-4
"""Step of a difference quotient over the value; runs are exact to 1e-8."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class SlideProblem(Problem):
    """Measured less simulated way of each slide; a segment is a setting with its repeats."""

    blocks: Sequence[SpringBlock]
    """The block of each slide (n,), on its incline."""
    durations: Array
    """Time of each slide (n,) [s]."""
    ways: Array
    """Measured way of each slide (n,) [m]."""
    law: FrictionLaw
    """Has the values of parameters that are not looked for."""
    free_parameters: FreeParameters
    """What is looked for."""

    @property
    @override
    def spans(self) -> Array:
        times = dict(zip(self.segment.tolist(), self.durations, strict=True))
        return np.array([[k, 0.0, t] for k, t in times.items()])

    @property
    @override
    def quantity(self) -> str:
        return "travel"

    @property
    @override
    def times(self) -> Array:
        return self.durations

    @property
    def segment(self) -> NDArray[np.intp]:
        """Setting of each slide (n,)."""
        seen: dict[Any, int] = {}
        settings = zip(self.blocks, self.durations.tolist(), strict=True)
        return np.array(
            [seen.setdefault(setting, len(seen)) for setting in settings], dtype=np.intp
        )

    def law_with(self, values: Array) -> FrictionLaw:
        """Return the law with values (p,) of what is looked for."""
        found = dict(zip(self.free_parameters.paths, map(float, values), strict=True))
        return vary(self.law, "friction", found)

    def predicted(self, values: Array, rows: NDArray[np.intp]) -> Array:
        """Return the ways (m,) of some slides with values (p,)."""
        law, segment, known = self.law_with(values), self.segment, {}
        for i in rows.tolist():
            if segment[i] not in known:
                run = simulate(self.blocks[i], law, t_end=float(self.durations[i]))
                first, last = run.at(run.span)["x"]
                known[segment[i]] = abs(last - first)
        return np.array([known[segment[i]] for i in rows.tolist()])

    @override
    def linearise(
        self,
        values: Array,
        near: ResidualJacobian | None = None,
        *,
        only: Sequence[int] | None = None,
        slopes: bool = True,
    ) -> ResidualJacobian:
        rows = np.arange(len(self.ways))
        if only is not None:
            rows = rows[np.isin(self.segment, only)]
        predicted = self.predicted(values, rows)
        table = np.zeros((len(rows), len(values)))
        items = self.free_parameters.items
        bases = {one.above for one in items}  # what others must not fall below is made smaller
        for i, item in enumerate(items if slopes else ()):
            other, step = values.copy(), NUDGE * max(abs(values[i]), abs(item.start))
            other[i] += -step if item.path in bases else step
            table[:, i] = (self.predicted(other, rows) - predicted) / (other[i] - values[i])
        return ResidualJacobian(
            values=values,
            residual=self.ways[rows] - predicted,
            slopes=table,
            segment=self.segment[rows],
        )


@final
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SlideFit(Fit[FrictionLaw]):
    """A law with which blocks slide as far as they did."""

    problem: SlideProblem
    """The slides, and what was looked for."""
    optimum: OptimizeResult
    """How the search ended."""
    inference: Inference
    """Covariances of the estimates."""
    sentences: tuple[str, ...]
    """What the slides cannot tell."""

    @property
    def rms(self) -> float:
        """Root mean square of the residuals [m]."""
        return self.optimum.best.rms

    @override
    def law_estimates(self) -> LawEstimates:
        correlation, speed = self.inference.correlation, _largest_speed(self.problem)
        return estimates_for(
            self.law, self.estimates, correlation, levels="per load", largest_speed=speed
        )

    @override
    def _plot(self, ax: "Target") -> "Drawing":
        from stickslip.show.plots import on_axes

        def draw(figure: Any, _narrow: bool) -> None:
            axes = figure.add_subplot(xlabel="fitted way, m", ylabel="residual, mm")
            left = self.optimum.best.residual
            axes.plot(self.problem.ways - left, 1e3 * left, "o")

        return on_axes(draw, ax, (400, 300))

    @override
    def __str__(self) -> str:
        said = "; ".join(map(str, self.estimates))
        return f"{self.law.title}: {said}; residual {quantity(self.rms, 'm', 2)}"

    @override
    def to_dict(self) -> Mapping[str, Any]:
        return {**super().to_dict(), "rms": self.rms}


def _largest_speed(problem: SlideProblem) -> float:
    return float(np.max(2.0 * problem.ways / problem.durations))


def problem_of(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    free: Sequence[str] | None = None,
    known: Mapping[str, float] | None = None,
) -> SlideProblem:
    """Return slides as residuals of a law."""
    if not isinstance(mechanism, SpringBlock):
        raise InputError(f"slides need a SpringBlock on an incline, got {mechanism!r}.")
    slides = [
        (
            vary(mechanism, "mechanism", record.overrides),
            record.condition(DURATION, "s"),
            float(way),
        )
        for record in measurement.records()
        for way in np.atleast_1d(record.values("travel"))  # repeats of one setting
    ]
    blocks = [block for block, _, _ in slides]
    durations = np.array([duration for _, duration, _ in slides], dtype=float)
    ways = np.array([way for _, _, way in slides])
    if not np.all(durations > 0.0):
        raise InputError(f"durations of slides must be above 0 s, got {durations.min()!r} s.")
    weight = mechanism.mass * mechanism.gravity
    steepest = max(abs(math.sin(block.incline)) for block in blocks)
    force, load = 0.5 * weight * steepest, weight * math.cos(mechanism.incline)
    speed = float(np.max(2.0 * ways / durations))
    rough = StartEstimate(  # sizes of friction from which start values and bounds follow
        level=force / load,
        viscous=0.1 * force / speed,
        offset=0.0,
        force=force,
        load=load,
        speed=speed,
        stiffness=force / load / float(np.max(ways)),
        two_sided=False,
    )
    start, free_parameters = rough.unknowns(law, free=free, known=known)
    return SlideProblem(
        blocks=blocks, durations=durations, ways=ways, law=start, free_parameters=free_parameters
    )


def fit_slides(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    progress: Watch | None = None,
) -> SlideFit:
    """Fit a law to slides."""
    chosen = Parameters.of(mechanism, law, vary, fixed, measurement=measurement)
    problem = problem_of(chosen.mechanism, chosen.law, measurement, chosen.free, chosen.known)
    found = search(problem, watch=progress)
    best, free = found.best, problem.free_parameters
    inference = infer(best, free.slopes(free.coordinates(best.values)), table=True)
    at_bounds = bounds_met(free, best.values)
    shown = told(free, chosen.mechanism, measurement)  # with the units that values read in
    estimates = estimates_of(shown, best, inference, at_bounds)
    return SlideFit(
        law=problem.law_with(best.values),
        mechanism=chosen.mechanism,
        estimates=estimates,
        problem=problem,
        optimum=found,
        inference=inference,
        sentences=sentences_of(shown, best, inference, at_bounds, estimates),
        cancelled=found.cancelled,
    )
