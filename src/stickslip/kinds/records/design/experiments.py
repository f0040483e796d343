"""Which measurement would tell the best law from its rivals, designed by simulation."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from stickslip.drives import Sampled, Sine
from stickslip.errors import InputError, SimulationError
from stickslip.formatting import number, scale_of
from stickslip.kinds.records.design.predictors import (
    Coast,
    Predictor,
    Presliding,
    Reading,
    Steady,
    error_of,
    own_force,
    sprung,
)
from stickslip.mechanisms import stops_of

Array = NDArray[np.float64]

SPEEDS = (0.01, 0.03, 0.1, 0.3, 1.0)
"""Speeds that are proposed, over the largest of the record."""
LOADS = (0.5, 0.8)
"""Amplitudes of presliding loops over the break-away level."""
COASTS = (1.0, 0.3, 0.1)
"""Speeds that a coast begins with, over the largest of the record: slower where it goes too far."""
PASSES = 20
"""Passes within the stroke that are asked for at most."""
WAYS = {1.0: "forwards", -1.0: "backwards"}
BOTH = tuple(WAYS)
"""Signs of the directions that a body can be moved in."""
ANYWHERE = (-math.inf, math.inf)
"""Where a body may be that nothing holds up."""


@final
@dataclass(frozen=True, kw_only=True)
class Experiment:
    """A measurement and what each law predicts for it."""

    what: str
    """What to do, as a sentence with values."""
    observed: str
    """What is read off, with its unit."""
    predicted: Mapping[str, float]
    """Largest or final reading by candidate."""
    doubts: Mapping[str, float] = field(default_factory=dict)
    """Standard error of each prediction, from that of the candidate's parameters."""
    separation: float
    """Least difference of best and a rival, over the doubt of the reading and both predictions."""

    def readings(self) -> tuple[str, Mapping[str, str]]:
        """Return what is read off with the unit shown, and by candidate its prediction in words."""
        what, _, unit = self.observed.rpartition(", ")
        scale = scale_of(self.predicted.values(), unit)
        said = {
            name: " ".join(scale.estimate_text(value, self.doubts[name])).strip()
            if math.isfinite(self.doubts.get(name, math.inf))
            else scale.number(value)
            for name, value in self.predicted.items()
        }
        return f"{what}, {scale.unit}", said

    def to_dict(self) -> Mapping[str, Any]:
        """Return the experiment as plain numbers and strings."""
        return {
            "what": self.what,
            "observed": self.observed,
            "predicted": dict(self.predicted),
            "doubts": dict(self.doubts),
            "separation": self.separation,
        }


@dataclass(frozen=True, kw_only=True)
class _Terms:
    """How motion of a kind is put into words."""

    force: str
    force_unit: str
    distance: str
    length_unit: str
    said_unit: str
    """Unit of lengths and speeds as they are said, without the second."""
    factor: float
    """Lengths and speeds as they are said over those in SI."""

    def speed(self, value: float, digits: int) -> str:
        """Return a speed in words, without a power of ten."""
        return f"{self.length(value, digits)}/s"

    def length(self, value: float, digits: int) -> str:
        """Return a length in words, without a power of ten."""
        return f"{_plain(self.factor * value, digits)} {self.said_unit}"


STRAIGHT = _Terms(
    force="force",
    force_unit="N",
    distance="distance",
    length_unit="m",
    said_unit="mm",
    factor=1e3,
)
TURNING = _Terms(
    force="torque",
    force_unit="N m",
    distance="angle",
    length_unit="rad",
    said_unit="rad",
    factor=1.0,
)


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """A measurement that might be made."""

    kind: str
    """Of several of a kind the most telling one is proposed."""
    what: str
    observed: str
    read: Reading
    noise: float
    """What the reading itself is known to."""
    room: float = math.inf
    """Largest reading that the stroke allows, of those that are lengths."""
    slower: bool = False
    """Whether it is asked for only where no faster one of its kind tells anything."""


def design(
    candidates: Mapping[str, Predictor],
    *,
    best: str,
    speed: float,
    force_doubt: Callable[[float], float],
    length_doubt: float,
    driven: bool,
    turning: bool = False,
    reach: tuple[float, float] | None = ANYWHERE,
    sides: Sequence[float] = BOTH,
) -> tuple[Experiment, ...]:
    """Return measurements in the order of what they tell, those that tell nothing left out.

    Those that leave the stroke are left out too, or made shorter and repeated. It is taken to be
    the one of a sine with the record's largest speed: gaining that and losing it takes half of it.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, Viscous
    >>> axis = Axis(inertia=1.0)
    >>> laws = {
    ...     "coulomb": Coulomb(kinetic_coefficient=2.0),
    ...     "viscous": Viscous(viscous_coefficient=4.0),
    ... }
    >>> named = {name: Predictor(law=law, mechanism=axis, load=1.0) for name, law in laws.items()}
    >>> first, *_ = design(
    ...     named,
    ...     best="coulomb",
    ...     speed=0.5,
    ...     force_doubt=lambda seconds: 0.1,
    ...     length_doubt=0.01,
    ...     driven=False,
    ... )
    >>> first.what, first.predicted
    ('Constant speed of 5 mm/s, forwards, 10 s.', {'coulomb': 2.0, 'viscous': 0.02})

    In a stroke of 30 mm it is run several times:

    >>> first, *_ = design(
    ...     named,
    ...     best="coulomb",
    ...     speed=0.5,
    ...     force_doubt=lambda seconds: 0.1,
    ...     length_doubt=0.01,
    ...     driven=False,
    ...     reach=(-0.015, 0.015),
    ... )
    >>> first.what
    'Constant speed of 5 mm/s, forwards, 2 passes of 5.9 s within the stroke of 30 mm.'
    """
    if len(candidates) < 2:
        return ()
    chosen = candidates[best]
    terms = TURNING if turning else STRAIGHT
    plans = [*_steady(speed, force_doubt, terms, reach, sides, driven=driven)]
    if driven:
        plans += [*_coasts(chosen, speed, length_doubt, terms, reach or ANYWHERE, sides)]
    if driven and len(sides) > 1:
        plans += [*_presliding(chosen, length_doubt, terms, reach or ANYWHERE)]
    found: dict[str, Experiment] = {}
    for plan in plans:
        if plan.slower and plan.kind in found:
            continue
        one = _looked_at(plan, candidates, best)
        if one is not None and one.separation > 1.0:
            known = found.get(plan.kind, one)
            found[plan.kind] = max(known, one, key=lambda x: x.separation)
    return tuple(sorted(found.values(), key=lambda x: -x.separation))


def _predicted(plan: _Plan, candidates: Mapping[str, Predictor]) -> dict[str, float]:
    """Return what each candidate predicts; nothing where one of them cannot."""
    try:
        values = {name: plan.read(one) for name, one in candidates.items()}
    except (SimulationError, InputError):
        return {}
    return values if all(map(math.isfinite, values.values())) else {}


def _separation(
    values: Mapping[str, float], doubts: Mapping[str, float], best: str, noise: float
) -> float:
    """Return the least difference of the best and a rival over its doubt."""
    own = math.hypot(noise, doubts.get(best, 0.0))
    return min(
        abs(value - values[best]) / max(math.hypot(own, doubts.get(name, 0.0)), 1e-300)
        for name, value in values.items()
        if name != best
    )


def _looked_at(plan: _Plan, candidates: Mapping[str, Predictor], best: str) -> Experiment | None:
    """Return a measurement with what is predicted for it; None if it tells nothing."""
    values = _predicted(plan, candidates)
    # The reading alone is asked first, since the doubt of predictions takes many runs.
    if not values or _separation(values, {}, best, plan.noise) <= 1.0:
        return None
    if max(values.values()) > plan.room:
        return None
    doubts = {name: error_of(plan.read, one, values[name]) for name, one in candidates.items()}
    return Experiment(
        what=plan.what,
        observed=plan.observed,
        predicted=values,
        doubts=doubts,
        separation=_separation(values, doubts, best, plan.noise),
    )


def _plain(value: float, digits: int) -> str:
    """Return a number to some digits without a power of ten, as one would set it."""
    return f"{float(f'{value:.{digits}g}'):.15g}"


def _run_up(share: float, stroke: float) -> float:
    """Return what a share of the record's largest speed takes of the stroke to gain or to lose.

    A sine of amplitude A reaches its largest speed v with the acceleration v^2 / A, which gains
    it within A / 2: a quarter of the stroke.
    """
    return 0.25 * share**2 * stroke


def _steady(
    speed: float,
    doubt: Callable[[float], float],
    terms: _Terms,
    reach: tuple[float, float] | None,
    sides: Sequence[float],
    *,
    driven: bool,
) -> Iterator[_Plan]:
    """Constant speed: the force after long sliding, as far as the stroke goes."""
    stroke = math.inf if reach is None else reach[1] - reach[0]
    if stroke <= 0.0:
        return
    for share in SPEEDS:
        v = share * speed
        seconds = min(max(10.0, 5.0 * math.ceil(0.05 / max(v, 1e-6) / 5.0)), 60.0)
        distance = stroke if math.isinf(stroke) else stroke - 2.0 * _run_up(share, stroke)
        how, seconds = _passes(seconds, v, distance, stroke, terms)
        if reach is None:
            how += f", over {terms.length(v * seconds, 2)}"
        for side in sides:
            towards_it = WAYS[side]
            yield _Plan(
                kind=f"steady {towards_it}",
                what=f"Constant speed of {terms.speed(v, 2)}, {towards_it}, {how}.",
                observed=(
                    f"{f'drive {terms.force}' if driven else 'friction'}, {terms.force_unit}"
                ),
                read=Steady(velocity=side * v, driven=driven, distance=distance),
                noise=doubt(seconds),
            )


def _passes(
    seconds: float, speed: float, distance: float, stroke: float, terms: _Terms
) -> tuple[str, float]:
    """Return how long a speed is kept within a distance, in words, and how long that is in all."""
    if speed * seconds <= distance:
        return f"{seconds:.0f} s", seconds
    each = _rounded_down(distance / speed)
    count = min(math.ceil(seconds / each), PASSES)
    within = f"within the stroke of {terms.length(stroke, 3)}"
    return f"{count} passes of {_plain(each, 2)} s {within}", count * each


def _rounded_down(value: float) -> float:
    """Return a number to two digits that is not larger."""
    power = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.floor(value / power) * power


def _coasts(
    chosen: Predictor,
    speed: float,
    noise: float,
    terms: _Terms,
    reach: tuple[float, float],
    sides: Sequence[float],
) -> Iterator[_Plan]:
    """Let go at the record's speed: how far it goes until it stops. A spring would not let it."""
    if sprung(chosen.mechanism):
        return
    stroke = reach[1] - reach[0]
    # Between stops it matters where a body is let go; elsewhere no force depends on it.
    stopped = math.isfinite(stroke) and bool(stops_of(chosen.mechanism))
    for share in COASTS if math.isfinite(stroke) else COASTS[:1]:
        v, run_up = share * speed, _run_up(share, stroke)
        for side in sides:
            towards_it = WAYS[side]
            start = reach[0] + run_up if side > 0.0 else reach[1] - run_up
            yield _Plan(
                kind=f"coast {towards_it}",
                what=(
                    f"Coast {towards_it} from {terms.speed(v, 3)} with the drive off, three times."
                ),
                observed=f"{terms.distance} to the stop, {terms.length_unit}",
                read=Coast(speed=side * v, start=start if stopped else 0.0),
                noise=noise,
                room=stroke - run_up if math.isfinite(stroke) else math.inf,
                slower=share < COASTS[0],
            )


def _presliding(
    chosen: Predictor, noise: float, terms: _Terms, reach: tuple[float, float]
) -> Sequence[_Plan]:
    """Push to and fro below break-away: how far it gives way."""
    level = float(chosen.told_law.towards(1).break_away(chosen.load))
    if level <= 0.0:
        return ()
    offset = -own_force(chosen.mechanism, 0.0)
    return [
        _Plan(
            kind="presliding",
            what=(
                f"An alternating {terms.force} of amplitude {number(share * level)}"
                f" {terms.force_unit} at 0.5 Hz, below break-away, for one minute."
            ),
            observed=f"peak-to-peak displacement, {terms.length_unit}",
            read=Presliding(
                drive=Sine(amplitude=share * level, frequency=0.5)
                + Sampled(times=(0.0,), values=(offset,))
            ),
            noise=noise,
            room=reach[1] - reach[0],
        )
        for share in LOADS
    ]
