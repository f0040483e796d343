"""Which measurement would tell the best law from its rivals, designed by simulation."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from stickslip.drives import Sampled, Sine
from stickslip.errors import InputError, SimulationError
from stickslip.friction import towards
from stickslip.selection.predictors import (
    Coast,
    Predictor,
    Presliding,
    Reading,
    Steady,
    error_of,
    own_force,
    sprung,
)

__all__ = ["Experiment", "design"]

Array = NDArray[np.float64]

SPEEDS = (0.01, 0.03, 0.1, 0.3, 1.0)
"""Speeds that are proposed, over the largest of the record."""
LOADS = (0.5, 0.8)
"""Amplitudes of presliding loops over the break-away level."""


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
    speed_unit: str
    per_second: float
    """Speeds as they are said over those in SI."""

    def speed(self, value: float, digits: int) -> str:
        """Return a speed in words, without a power of ten."""
        return f"{_plain(self.per_second * value, digits)} {self.speed_unit}"


STRAIGHT = _Terms(
    force="force",
    force_unit="N",
    distance="distance",
    length_unit="m",
    speed_unit="mm/s",
    per_second=1e3,
)
TURNING = _Terms(
    force="torque",
    force_unit="N m",
    distance="angle",
    length_unit="rad",
    speed_unit="rad/s",
    per_second=1.0,
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


def design(
    candidates: Mapping[str, Predictor],
    *,
    best: str,
    speed: float,
    force_doubt: Callable[[float], float],
    length_doubt: float,
    driven: bool,
    turning: bool = False,
) -> tuple[Experiment, ...]:
    """Return measurements in the order of what they tell, those that tell nothing left out.

    Parameters
    ----------
    candidates : mapping of str to Predictor
        Those still in question, by name.
    best : str
        The candidate that is named.
    speed : float
        Largest speed of the record [m/s].
    force_doubt : callable
        What the mean of a force [N] is known to after some time [s].
    length_doubt : float
        What positions of the record are known to [m].
    driven : bool
        Whether the mechanism can be run; not where only friction was measured.
    turning : bool
        Whether it turns about an axis: speeds [rad/s], torques [N m] and angles [rad].

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
    """
    if len(candidates) < 2:
        return ()
    chosen = candidates[best]
    terms = TURNING if turning else STRAIGHT
    plans = [*_steady(speed, force_doubt, terms, driven=driven)]
    if driven:
        plans += [*_coasts(chosen, speed, length_doubt, terms)]
        plans += [*_presliding(chosen, length_doubt, terms)]
    found: dict[str, Experiment] = {}
    for plan in plans:
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


def _steady(
    speed: float, doubt: Callable[[float], float], terms: _Terms, *, driven: bool
) -> Iterator[_Plan]:
    """Constant speed: the force after long sliding."""
    for share in SPEEDS:
        v = share * speed
        seconds = min(max(10.0, 5.0 * math.ceil(0.05 / max(v, 1e-6) / 5.0)), 60.0)
        for side, towards_it in ((1.0, "forwards"), (-1.0, "backwards")):
            yield _Plan(
                kind=f"steady {towards_it}",
                what=f"Constant speed of {terms.speed(v, 2)}, {towards_it}, {seconds:.0f} s.",
                observed=(
                    f"{f'{terms.force} that keeps it' if driven else 'friction'},"
                    f" {terms.force_unit}"
                ),
                read=Steady(velocity=side * v, driven=driven),
                noise=doubt(seconds),
            )


def _coasts(chosen: Predictor, speed: float, noise: float, terms: _Terms) -> Iterator[_Plan]:
    """Let go at the record's speed: how far it goes until it stops. A spring would not let it."""
    if sprung(chosen.mechanism):
        return
    for side, towards_it in ((1.0, "forwards"), (-1.0, "backwards")):
        yield _Plan(
            kind=f"coast {towards_it}",
            what=(
                f"Coast {towards_it} from {terms.speed(speed, 3)} with the drive off, three times."
            ),
            observed=f"{terms.distance} to the stop, {terms.length_unit}",
            read=Coast(speed=side * speed),
            noise=noise,
        )


def _presliding(chosen: Predictor, noise: float, terms: _Terms) -> Sequence[_Plan]:
    """Push to and fro below break-away: how far it gives way."""
    level = float(towards(chosen.law, 1).break_away(chosen.load))
    if level <= 0.0:
        return ()
    offset = -own_force(chosen.mechanism, 0.0)
    return [
        _Plan(
            kind="presliding",
            what=(
                f"A {terms.force} of {share * level:.3g} {terms.force_unit} to and fro at 0.5 Hz,"
                " below break-away, for a minute."
            ),
            observed=f"movement from peak to peak, {terms.length_unit}",
            read=Presliding(
                drive=Sine(amplitude=share * level, frequency=0.5)
                + Sampled(times=(0.0,), values=(offset,))
            ),
            noise=noise,
        )
        for share in LOADS
    ]
