"""Candidates that predict what would be read off a measurement, and how sure that is."""

import math
from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.characterization import presliding_length
from stickslip.drives import Drive
from stickslip.errors import InputError, SimulationError
from stickslip.formatting import quantity
from stickslip.friction import FrictionLaw, bound
from stickslip.identification import with_drive
from stickslip.mechanisms import Mechanism, slip_of
from stickslip.quantities import vary
from stickslip.simulation import simulate

Array = NDArray[np.float64]

ROWS = 200
"""Instants at which a movement is looked at."""
SETTLED = 5.0
"""Presliding lengths after which bristles have settled."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Predictor:
    """A candidate that predicts: its law in a mechanism of its own, and how sure both are.

    Laws of one record are fitted together with offsets and masses, which are not exchangeable.
    """

    law: FrictionLaw
    """As fitted."""
    mechanism: Mechanism
    """As fitted with this law."""
    load: float
    """Normal force [N]."""
    inputs: Mapping[str, float] = field(default_factory=dict)
    """Contact inputs of the law, by name."""
    estimates: Mapping[str, float] = field(default_factory=dict)
    """Fitted values by path."""
    errors: Array = field(default_factory=lambda: np.zeros(0))
    """Their standard errors (p,); infinite for what the record does not tell."""
    correlation: Array = field(default_factory=lambda: np.eye(0))
    """Their correlation (p, p)."""

    @property
    def told_law(self) -> FrictionLaw:
        """The law at these inputs."""
        return bound(self.law, self.inputs)

    def moved(self, path: str, value: float) -> "Predictor":
        """Return the candidate with another value of what was fitted."""
        room = path.partition(".")[0]
        if room == "friction":
            return replace(self, law=vary(self.law, room, {path: value}))
        if room == "mechanism":
            return replace(self, mechanism=vary(self.mechanism, room, {path: value}))
        return self


Reading: TypeAlias = Callable[[Predictor], float]
"""What is read off when a candidate is right."""


def error_of(read: Reading, candidate: Predictor, value: float) -> float:
    """Return the standard error of a prediction, from runs with each parameter one error off.

    What the record does not tell is taken to be known to its own size.
    """
    changes = [
        _change(read, candidate, path, min(error, abs(estimate)) if estimate else error, value)
        for (path, estimate), error in zip(
            candidate.estimates.items(), candidate.errors.tolist(), strict=True
        )
    ]
    along = np.array(changes)
    return math.sqrt(max(float(along @ candidate.correlation @ along), 0.0))


def _change(read: Reading, candidate: Predictor, path: str, step: float, value: float) -> float:
    """Return how a reading changes with one parameter, to the side where it may be moved."""
    if not 0.0 < step < math.inf:
        return 0.0
    for side in (1.0, -1.0):
        try:
            moved = candidate.moved(path, candidate.estimates[path] + side * step)
            change = side * (read(moved) - value)
        except (SimulationError, InputError):
            continue
        if math.isfinite(change):
            return change
    return 0.0


@dataclass(frozen=True, kw_only=True)
class Steady:
    """Reads the force that a constant speed takes, its size."""

    velocity: float
    """Constant velocity [m/s]."""
    driven: bool
    """Whether the force is that of a drive, which moves the mechanism too."""
    distance: float = math.inf
    """How far the speed can be kept [m]."""

    def __call__(self, candidate: Predictor) -> float:
        """Return the force [N]."""
        law = candidate.told_law
        if math.isfinite(self.distance) and law.states:
            needed = SETTLED * presliding_length(law, candidate.load)
            if needed > self.distance:
                raise InputError(
                    f"bristles settle within {quantity(needed, 'm')}, but the stroke is"
                    f" {quantity(self.distance, 'm')}."
                )
        force = _after_long_sliding(law, self.velocity, candidate.load)
        if self.driven:
            force -= own_force(candidate.mechanism, self.velocity)
        return math.copysign(1.0, self.velocity) * force


def _after_long_sliding(law: FrictionLaw, velocity: float, load: float) -> float:
    """Return friction [N] when bristles have settled."""
    return float(law.steady(velocity, load))


def own_force(mechanism: Mechanism, velocity: float) -> float:
    """Return the force of a mechanism on itself at a speed [N]: its damper and its offset."""
    slip = slip_of(mechanism)
    at: Mapping[str, float] = defaultdict(float)
    moving: Mapping[str, float] = defaultdict(float, {slip: velocity})
    return float(mechanism.forces(0.0, at, moving, defaultdict(float)).get(slip, 0.0))


def sprung(mechanism: Mechanism) -> bool:
    """Whether a spring holds what slides."""
    slip = slip_of(mechanism)
    energy = [
        float(mechanism.potential_energy(0.0, defaultdict(float, {slip: x})))
        for x in (-1.0, 0.0, 1.0)
    ]
    return energy[0] + energy[2] > 2.0 * energy[1]


def _run(candidate: Predictor, drive: Drive | None, t_end: float, y0: Mapping[str, float]) -> Any:
    driven = with_drive(candidate.mechanism, drive)
    return simulate(driven, candidate.law, t_end=t_end, y0=y0, throw=False)


@dataclass(frozen=True, kw_only=True)
class Coast:
    """Reads how far a body goes without a drive."""

    speed: float
    """Velocity with which it is let go [m/s]."""
    start: float = 0.0
    """Where it is let go [m]."""
    t_end: float = 60.0
    """Time after which the run ends [s]."""

    def __call__(self, candidate: Predictor) -> float:
        """Return the distance [m]."""
        mechanism = candidate.mechanism
        slip = slip_of(mechanism)
        rate = mechanism.rates[mechanism.coordinates.index(slip)]
        run = _run(candidate, None, self.t_end, {slip: self.start, rate: self.speed})
        if any(event.reason.endswith("hits stop") for event in run.events):
            raise InputError("the body coasts into a stop, so its free travel is not observed.")
        return abs(float(run.at(run.span[1])[slip][0]) - self.start)


@dataclass(frozen=True, kw_only=True)
class Presliding:
    """Reads how far a body gives way to a force that does not break it away."""

    drive: Drive
    """Force over time, which stays below break-away."""
    t_end: float = 4.0
    """Time after which the run ends [s]."""

    def __call__(self, candidate: Predictor) -> float:
        """Return the movement from peak to peak [m] in the second half."""
        run = _run(candidate, self.drive, self.t_end, {})
        slip = slip_of(candidate.mechanism)
        return float(np.ptp(run.at(np.linspace(0.5 * self.t_end, run.span[1], ROWS))[slip]))
