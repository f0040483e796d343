"""Limit cycles of a towed block, compared with a record by features."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.simulation import ensemble
from stickslip.engine.solver import EventDriven, Samples
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits import FreeParameter, FreeParameters, Problem, ResidualJacobian
from stickslip.identify.kinds.features.features import COMPARED, READ, StickSlipFeatures
from stickslip.mechanisms import TowedBlock
from stickslip.quantities import Quantity, full_path, parameters

Array: TypeAlias = NDArray[np.float64]
Progress: TypeAlias = Callable[[int, int], object]

SETTLING = 12
"""Observed periods after which the motion counts as a limit cycle."""
WATCHED = 10
"""Observed periods of which the features are taken; of 10 for both, two of three sliders
whose parameters are not identified have narrow intervals that miss the truth."""
SAMPLES = 64
"""Samples in an observed period."""
NUDGE = 0.01
"""Step of difference quotients in the logarithms, well above the error of sampled features; slopes
are known to about this share."""
SOLVER = EventDriven(tier="compiled", tolerance=1e-7, stiff_tolerance=1e-5, max_steps=50_000)
"""Features carry a per cent of doubt."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FeatureProblem(Problem):
    """Logarithms of frequency, mean and standard deviation of a simulated limit cycle."""

    block: TowedBlock
    """The towed block, with its nominal parameters."""
    law: FrictionLaw
    """Holds the parameters that are not fitted."""
    observed: StickSlipFeatures
    """Features of the record, which the limit cycle is compared with."""
    free_parameters: FreeParameters
    """The free parameters."""

    @property
    def spans(self) -> Array:
        return np.zeros((1, 3))

    @property
    def quantity(self) -> str:
        return "spring_force"

    @property
    def times(self) -> Array:
        return np.zeros(len(COMPARED))

    def features(self, values: Array, progress: Progress | None = None) -> Array:
        """Return the compared features (n, 3) of limit cycles with values (n, p)."""
        return cycle_features(
            self.block,
            self.law,
            self.free_parameters.paths,
            values,
            period=1.0 / self.observed.frequency,
            level=self.observed.mean,
            progress=progress,
        )

    def residuals(self, features: Array) -> Array:
        """Return logarithms of observed over simulated features (..., 3).

        Below the share to which features are read there is nothing.
        """
        observed = self.observed.compared
        return np.log(observed / np.maximum(features, READ * observed))

    def linearise(
        self,
        values: Array,
        near: ResidualJacobian | None = None,
        *,
        only: Sequence[int] | None = None,
        slopes: bool = True,
    ) -> ResidualJacobian:
        rows = [values]
        at = self.free_parameters.coordinates(values)
        steps = np.where(at + NUDGE < self.free_parameters.limits()[1], NUDGE, -NUDGE)
        if slopes:
            rows += [
                self.free_parameters.values(at + step * axis)
                for step, axis in zip(steps, np.eye(len(at)), strict=True)
            ]
        residual = self.residuals(self.features(np.array(rows)))
        residual = np.where(np.isfinite(residual), residual, np.inf)
        table = np.zeros((len(COMPARED), len(at)))
        if slopes and np.all(np.isfinite(residual)):
            by_coordinate = (residual[0] - residual[1:]).T / steps
            table = by_coordinate @ np.linalg.inv(self.free_parameters.slopes(at))
        return ResidualJacobian(
            values=values,
            residual=residual[0],
            slopes=table,
            segment=np.zeros(len(COMPARED), dtype=np.intp),
        )


def unknowns_of(
    block: TowedBlock,
    law: FrictionLaw,
    observed: StickSlipFeatures,
    *,
    unknown: Sequence[str],
    free: Sequence[str],
) -> FreeParameters:
    """Return what is looked for, with ranges about what the record shows."""
    declared = [*parameters(block, "mechanism"), *parameters(law, "friction")]
    known = {path: quantity for path, quantity, _ in declared}
    values = {path: value for path, _, value in declared}
    paths = [full_path(name, known) for name in (*unknown, *free)]
    items = []
    for path in paths:
        quantity = known[path]
        above = "" if quantity.at_least is None else f"friction.{quantity.at_least}"
        start, low, high = _range(path, quantity, values[path], block, observed)
        holding = [
            values[other]
            for other, one in known.items()
            if one.at_least is not None and f"friction.{one.at_least}" == path
            if other not in paths
        ]
        if holding:  # what is held, and nothing slides above it
            high = min(high, *holding)
            start, low = min(start, high), min(low, 0.5 * high)
        if above:
            start += 0.9 * abs(observed.mean) if above in paths else values[above]
        items.append(
            FreeParameter(
                path=path,
                quantity=quantity,
                start=start,
                low=low,
                high=high,
                log=True,
                above=above,
            )
        )
    return FreeParameters(tuple(items), known=values)


def _range(
    path: str, quantity: Quantity, value: float, block: TowedBlock, observed: StickSlipFeatures
) -> tuple[float, float, float]:
    """Return start, least and largest value; of the static level its surplus.

    The spring and the speed of its end tell sizes more closely than the ranges of a law do, which
    begin at its value.
    """
    size = block.steady_load if quantity.scale == "force" else 1.0
    level = size * abs(observed.mean)
    if quantity.at_least is not None:
        spread = size * max(observed.standard_deviation, 1e-3 * abs(observed.mean))
        return spread, 0.01 * spread, 10.0 * spread
    if quantity.scale in ("level", "force"):
        return 0.9 * level, 0.3 * level, 1.5 * level
    if path == "mechanism.mass":
        return value, value / 10.0, value * 10.0
    if quantity.scale == "speed":
        return 2.0 * block.speed, 0.1 * block.speed, 50.0 * block.speed
    if value <= 0.0:
        raise InputError(f"a fit to features needs a start value above 0 for {path}, got 0.")
    if quantity.scale == "none" and not quantity.structural and quantity.bounds is not None:
        low, high = quantity.bounds
        return value, max(min(low, value), value / 1e3), max(high, value)
    return value, value / 30.0, value * 30.0


def cycle_features(
    block: TowedBlock,
    law: FrictionLaw,
    paths: Sequence[str],
    values: Array,
    *,
    period: float,
    level: float,
    progress: Progress | None = None,
) -> Array:
    """Return frequency [Hz], mean and standard deviation of the force over the load (n, 3).

    Runs start where the spring holds the mean level, and are watched after they have settled;
    rows are NaN where a run fails.
    """
    load = block.steady_load
    times = period * (SETTLING + np.arange(WATCHED * SAMPLES + 1) / SAMPLES)
    runs = ensemble(
        replace(block, load=load),
        law,
        dict(zip(paths, values.T, strict=True)),
        t_end=float(times[-1]),
        outputs={"x": Samples("x", list(times)), "v": Samples("v", list(times))},
        y0={"x": -level * load / block.stiffness},
        solver=SOLVER,
        progress=progress,
    )
    force = block.stiffness * (block.speed * times - runs["x"])
    force = (force + block.damping * (block.speed - runs["v"])) / load
    complete = np.array([status.complete for status in runs.status])
    return np.array(
        [
            _cycle(times, row) if good else np.full(3, np.nan)
            for row, good in zip(force, complete, strict=True)
        ]
    )


def _cycle(times: Array, force: Array) -> Array:
    """Return frequency, mean and standard deviation over whole cycles of a periodic force."""
    mean, spread = float(force.mean()), float(force.std())
    ups = np.flatnonzero((force[:-1] < mean) & (force[1:] >= mean))
    if len(ups) < 3 or spread < 1e-6 * abs(mean):
        return np.array([math.nan if not math.isfinite(mean) else 0.0, mean, spread])
    share = (mean - force[ups]) / (force[ups + 1] - force[ups])
    crossings = times[ups] + share * (times[1] - times[0])
    whole = force[ups[0] + 1 : ups[-1] + 1]
    frequency = (len(ups) - 1) / (crossings[-1] - crossings[0])
    return np.array([frequency, float(whole.mean()), float(whole.std())])
