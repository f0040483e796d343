"""A kind as a contributor would write it: how far blocks slide down an incline in a time.

Rows are ways, weighed by what repeats of a setting scatter; no further term is in the model but an
error of the scale, alike for all.
"""

from collections.abc import Mapping, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.data import Measurement
from stickslip.engine.simulation import ensemble
from stickslip.errors import InputError
from stickslip.identify.candidates import friction_of, specifications
from stickslip.identify.fits import starting_law
from stickslip.identify.kinds.kind import Request, SeveralLaws
from stickslip.identify.kinds.simulated import AnyFit, SimulatedKind
from stickslip.identify.problems.run_laws import LawRuns, RunLaw, laws_to_run
from stickslip.identify.simulated import Always
from stickslip.mechanisms import SpringBlock
from stickslip.quantities import vary as with_values
from stickslip.show.formatting import quantity

Array = NDArray[np.float64]
DURATION = "duration"
"""Condition that makes a travel a slide: the time after which it was read [s]."""
SCALE = 1e-3
"""Prior deviation of the error of the scale that ways are read on, over them."""


@final
class Slides(LawRuns):
    """Ways of blocks that slide, with the inclines and durations at which they were read."""

    def __init__(
        self,
        block: SpringBlock,
        measurement: Measurement,
        laws: Mapping[str, RunLaw],
        doubts: Mapping[str, float],
    ) -> None:
        slides = [
            (with_values(block, "mechanism", one.overrides).incline,
             one.condition(DURATION, "s"), float(way))
            for one in measurement.records()
            for way in np.atleast_1d(one.values("travel"))
        ]  # fmt: skip
        self.inclines, self.durations, self.measured = np.array(slides, dtype=float).T
        if not np.all(self.durations > 0.0):
            least = quantity(float(self.durations.min()), "s")
            raise InputError(f"durations of slides must be above 0 s, got {least}.")
        speed = float(np.max(2.0 * self.measured / self.durations))
        level = 0.5 * float(np.max(np.abs(np.tan(self.inclines))))
        load = block.mass * block.gravity
        sizes = {"level": level, "surplus": 0.2 * level, "speed": speed,
                 "slope": level * load / speed}  # fmt: skip
        super().__init__(block, laws, doubts, sizes=sizes, load=load)
        self.weights = np.ones(len(self.measured))
        self.always = Always(
            columns=self.measured[:, None], sizes=np.array([[SCALE]]), prior=np.ones(1)
        )

    @override
    def simulate(self, asked: Mapping[str, Array]) -> dict[str, Array]:
        found = {}
        for family, points in asked.items():
            values, count = self.values(family, points), len(points)
            rows = np.full((len(self.measured), count), np.nan)
            for duration in np.unique(self.durations):
                here = np.flatnonzero(self.durations == duration)
                columns = {path: np.tile(x, len(here)) for path, x in values.items()}
                columns["mechanism.incline"] = np.repeat(self.inclines[here], count)
                runs = ensemble(self.mechanism, self.laws[family].law, columns,
                                t_end=float(duration), outputs=["x"])  # fmt: skip
                complete = np.array([one.complete for one in runs.status])
                ways = np.where(complete, np.abs(np.asarray(runs["x"])), np.nan)
                rows[here] = ways.reshape(len(here), count)
            found[family] = rows
        return found

    @override
    def contains(self, name: str, other: str) -> bool:
        return {*self.laws[other].free} < {*self.laws[name].free}


@final
class SlideKind(SimulatedKind):
    """Blocks that slide down an incline, whose way is read after a noted time."""

    routes = ("slides",)
    measured = "slides"
    these = "these slides"
    drawn = ("way", "m")
    conditions = frozenset({DURATION})
    uses = frozenset()

    @override
    def serves(self, measurement: Measurement) -> bool:
        return all("travel" in one.quantities() and one.condition(DURATION, "s") is not None
                   for one in measurement.records())  # fmt: skip

    @override
    def laws(self, laws: SeveralLaws | None) -> Mapping[str, Any]:
        usual = ["viscous", "coulomb", "coulomb-viscous"]
        return {one.name: one.law for one in specifications(laws or usual)}

    @override
    def problem(
        self, request: Request, laws: Mapping[str, Any], vary: str | Sequence[str] | None
    ) -> Slides:
        mechanism = request.mechanism
        if not isinstance(mechanism, SpringBlock):
            raise InputError(f"slides need a SpringBlock on an incline, got {mechanism!r}.")
        block, found, doubts = laws_to_run(
            mechanism, laws, request.measurement, vary, request.fixed, doubts={},
            start=lambda block, law: starting_law(law, block.mass * block.gravity)
            if isinstance(law, type) else law,
        )  # fmt: skip
        return Slides(block, request.measurement, found, doubts)

    @override
    def called(self, fit: AnyFit) -> str:
        return friction_of(fit.law.title)

    @override
    def fault(self, fit: AnyFit) -> str:
        much = fit.rms > 0.5 * float(np.std(fit.problem.measured))
        return "leaves more than half of what ways differ by" * much

    @override
    def about(self, fit: AnyFit) -> str:
        return f"The root mean square of its residuals is {quantity(fit.rms, 'm', 2)}."

    @override
    def pieces(
        self, fit: AnyFit, others: Sequence[AnyFit]
    ) -> Sequence[tuple[str, Array, Array, Mapping[str, Array]]]:
        problem = fit.problem
        curves = {one.law.title: one.family.band[1] for one in (fit, *others)}
        return [("all slides", problem.durations, problem.measured, curves)]
