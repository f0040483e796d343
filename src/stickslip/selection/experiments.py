"""Which measurement would tell the best law from its rivals, designed by simulation."""

import math
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.drives import Drive, Sampled, Sine
from stickslip.errors import InputError, SimulationError
from stickslip.friction import BristleLaw, DirectionalLaw, FrictionLaw, SetValuedLaw, towards
from stickslip.identification.segmenting import with_drive
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary
from stickslip.simulation import simulate

__all__ = ["Experiment", "Predictor", "design", "steady_friction"]

Array = NDArray[np.float64]

SPEEDS = (0.01, 0.03, 0.1, 0.3, 1.0)
"""Speeds that are proposed, over the largest of the record."""
LOADS = (0.5, 0.8)
"""Amplitudes of presliding loops over the break-away level."""
ROWS = 200


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
    estimates: Mapping[str, float] = field(default_factory=dict)
    """Fitted values by path."""
    errors: Array = field(default_factory=lambda: np.zeros(0))
    """Their standard errors (p,); infinite for what the record does not tell."""
    correlation: Array = field(default_factory=lambda: np.eye(0))
    """Their correlation (p, p)."""

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
    ...     driven=True,
    ... )
    >>> first.what, first.predicted
    ('Constant speed of 5 mm/s, forwards, 10 s.', {'coulomb': 2.0, 'viscous': 0.02})
    """
    if len(candidates) < 2:
        return ()
    chosen = candidates[best]
    plans = [*_steady(speed, force_doubt, driven=driven)]
    if driven:
        plans += [*_coasts(chosen, speed, length_doubt), *_presliding(chosen, length_doubt)]
    found: dict[str, Experiment] = {}
    for plan in plans:
        one = _looked_at(plan, candidates, best)
        if one is not None and one.separation > 1.0:
            known = found.get(plan.kind, one)
            found[plan.kind] = max(known, one, key=lambda x: x.separation)
    return tuple(sorted(found.values(), key=lambda x: -x.separation))


def steady_friction(law: FrictionLaw, velocity: Array | float, load: float) -> Array:
    """Return friction [N] after long sliding at velocities (n,) [m/s]."""
    v = np.atleast_1d(np.asarray(velocity, dtype=float))
    if isinstance(law, BristleLaw):
        return np.asarray(law.steady(v, load) + 0.0 * v, dtype=float)
    assert isinstance(law, SetValuedLaw | DirectionalLaw)
    return np.asarray(law.force(v, load) + 0.0 * v, dtype=float)


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
    doubts = {name: _error(plan.read, one, values[name]) for name, one in candidates.items()}
    return Experiment(
        what=plan.what,
        observed=plan.observed,
        predicted=values,
        doubts=doubts,
        separation=_separation(values, doubts, best, plan.noise),
    )


def _error(read: Reading, candidate: Predictor, value: float) -> float:
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


def _plain(value: float, digits: int) -> str:
    """Return a number to some digits without a power of ten, as one would set it."""
    return f"{float(f'{value:.{digits}g}'):.15g}"


def _steady(speed: float, doubt: Callable[[float], float], *, driven: bool) -> Iterator[_Plan]:
    """Constant speed: the force after long sliding."""
    for share in SPEEDS:
        v = share * speed
        seconds = min(max(10.0, 5.0 * math.ceil(0.05 / max(v, 1e-6) / 5.0)), 60.0)
        for side, towards_it in ((1.0, "forwards"), (-1.0, "backwards")):
            yield _Plan(
                kind=f"steady {towards_it}",
                what=f"Constant speed of {_plain(1e3 * v, 2)} mm/s, {towards_it}, {seconds:.0f} s.",
                observed="force that keeps it, N" if driven else "friction, N",
                read=_Steady(velocity=side * v, driven=driven),
                noise=doubt(seconds),
            )


@dataclass(frozen=True, kw_only=True)
class _Steady:
    """Reads the force that a constant speed takes, its size."""

    velocity: float
    driven: bool

    def __call__(self, candidate: Predictor) -> float:
        force = float(steady_friction(candidate.law, self.velocity, candidate.load)[0])
        if self.driven:
            force -= _own_force(candidate.mechanism, self.velocity)
        return math.copysign(1.0, self.velocity) * force


def _own_force(mechanism: Mechanism, velocity: float) -> float:
    """Return the force of a mechanism on itself at a speed [N]: its damper and its offset."""
    slip = mechanism.contacts()[0].slip
    at: Mapping[str, float] = defaultdict(float)
    moving: Mapping[str, float] = defaultdict(float, {slip: velocity})
    return float(mechanism.forces(0.0, at, moving, defaultdict(float)).get(slip, 0.0))


def _sprung(mechanism: Mechanism) -> bool:
    """Whether a spring holds what slides."""
    slip = mechanism.contacts()[0].slip
    energy = [
        float(mechanism.potential_energy(0.0, defaultdict(float, {slip: x})))
        for x in (-1.0, 0.0, 1.0)
    ]
    return energy[0] + energy[2] > 2.0 * energy[1]


def _run(candidate: Predictor, drive: Drive | None, t_end: float, y0: Mapping[str, float]) -> Any:
    driven = with_drive(candidate.mechanism, drive)
    return simulate(driven, candidate.law, t_end=t_end, y0=y0, throw=False)


def _coasts(chosen: Predictor, speed: float, noise: float) -> Iterator[_Plan]:
    """Let go at the record's speed: how far it goes until it stops. A spring would not let it."""
    if _sprung(chosen.mechanism):
        return
    for side, towards_it in ((1.0, "forwards"), (-1.0, "backwards")):
        yield _Plan(
            kind=f"coast {towards_it}",
            what=(
                f"Coast {towards_it} from {_plain(1e3 * speed, 3)} mm/s with the drive off, three"
                " times."
            ),
            observed="distance to the stop, m",
            read=_Coast(speed=side * speed),
            noise=noise,
        )


@dataclass(frozen=True, kw_only=True)
class _Coast:
    """Reads how far a body goes without a drive."""

    speed: float
    t_end: float = 60.0

    def __call__(self, candidate: Predictor) -> float:
        mechanism = candidate.mechanism
        slip = mechanism.contacts()[0].slip
        rate = mechanism.rates[mechanism.coordinates.index(slip)]
        run = _run(candidate, None, self.t_end, {rate: self.speed})
        return abs(float(run.at(run.span[1])[slip][0]))


def _presliding(chosen: Predictor, noise: float) -> Sequence[_Plan]:
    """Push to and fro below break-away: how far it gives way."""
    level = float(towards(chosen.law, 1).break_away(chosen.load))
    if level <= 0.0:
        return ()
    offset = -_own_force(chosen.mechanism, 0.0)
    return [
        _Plan(
            kind="presliding",
            what=(
                f"A force of {share * level:.3g} N to and fro at 0.5 Hz, below break-away, for a"
                " minute."
            ),
            observed="movement from peak to peak, m",
            read=_Presliding(
                drive=Sine(amplitude=share * level, frequency=0.5)
                + Sampled(times=(0.0,), values=(offset,))
            ),
            noise=noise,
        )
        for share in LOADS
    ]


@dataclass(frozen=True, kw_only=True)
class _Presliding:
    """Reads how far a body gives way to a force that does not break it away."""

    drive: Drive
    t_end: float = 4.0

    def __call__(self, candidate: Predictor) -> float:
        run = _run(candidate, self.drive, self.t_end, {})
        slip = candidate.mechanism.contacts()[0].slip
        return float(np.ptp(run.at(np.linspace(0.5 * self.t_end, run.span[1], ROWS))[slip]))
