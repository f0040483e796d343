"""Which measurement would tell the best law from its rivals, designed by simulation."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from stickslip.drives import Drive, Sampled, Sine
from stickslip.errors import InputError, SimulationError
from stickslip.friction import BristleLaw, DirectionalLaw, FrictionLaw, SetValuedLaw, towards
from stickslip.identification.segmenting import with_drive
from stickslip.mechanisms import Mechanism
from stickslip.simulation import simulate

__all__ = ["Experiment", "design"]

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
    separation: float
    """Difference of best and nearest rival, over the doubt of such a reading."""

    def to_dict(self) -> Mapping[str, Any]:
        """Return the experiment as plain numbers and strings."""
        return {
            "what": self.what,
            "observed": self.observed,
            "predicted": dict(self.predicted),
            "separation": self.separation,
        }


def design(
    mechanism: Mechanism | None,
    laws: Mapping[str, FrictionLaw],
    *,
    best: str,
    speed: float,
    force_doubt: float,
    length_doubt: float,
    load: float,
) -> tuple[Experiment, ...]:
    """Return measurements in the order of what they tell, those that tell nothing left out.

    Parameters
    ----------
    mechanism : Mechanism, optional
        As fitted; without one, as where only friction was measured, no run is proposed.
    laws : mapping of str to FrictionLaw
        Fitted laws that are still in question, by candidate.
    best : str
        The candidate that is named.
    speed : float
        Largest speed of the record [m/s].
    force_doubt, length_doubt : float
        What forces [N] and positions [m] of the record are known to.
    load : float
        Normal force [N].
    """
    if len(laws) < 2:
        return ()
    found = [_steady(laws, best, share * speed, force_doubt, load) for share in SPEEDS]
    if mechanism is not None:
        found += [_coast(mechanism, laws, best, speed, length_doubt)]
        found += [_presliding(mechanism, laws, best, share, length_doubt, load) for share in LOADS]
    told = [one for one in found if one is not None and one.separation > 1.0]
    return tuple(sorted(told, key=lambda one: -one.separation))


def steady_friction(law: FrictionLaw, velocity: Array | float, load: float) -> Array:
    """Return friction [N] after long sliding at velocities (n,) [m/s]."""
    v = np.atleast_1d(np.asarray(velocity, dtype=float))
    if isinstance(law, BristleLaw):
        return np.asarray(law.steady(v, load) + 0.0 * v, dtype=float)
    assert isinstance(law, SetValuedLaw | DirectionalLaw)
    return np.asarray(law.force(v, load) + 0.0 * v, dtype=float)


def _separation(values: Mapping[str, float], best: str, doubt: float) -> float:
    gaps = [abs(v - values[best]) for name, v in values.items() if name != best]
    return min(gaps) / max(doubt, 1e-300) if gaps else 0.0


def _plain(value: float, digits: int) -> str:
    """Return a number to some digits without a power of ten, as one would set it."""
    return f"{float(f'{value:.{digits}g}'):.15g}"


def _steady(
    laws: Mapping[str, FrictionLaw], best: str, v: float, doubt: float, load: float
) -> Experiment | None:
    """Constant speed: the friction force after long sliding."""
    values = {name: float(steady_friction(law, v, load)[0]) for name, law in laws.items()}
    seconds = max(10.0, 5.0 * math.ceil(0.05 / max(v, 1e-6) / 5.0))
    return Experiment(
        what=(
            f"Constant speed of {_plain(1e3 * v, 2)} mm/s, forwards,"
            f" {min(seconds, 60.0):.0f} s each."
        ),
        observed="friction, N",
        predicted=values,
        separation=_separation(values, best, doubt),
    )


def _simulated(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw],
    read: Callable[[Any], float],
    *,
    t_end: float,
    drive: Any,
    y0: Mapping[str, float],
) -> Mapping[str, float] | None:
    """Return what is read off a run with each law; None where a run fails."""
    try:
        driven = with_drive(mechanism, drive)
    except InputError:
        return None
    values = {}
    for name, law in laws.items():
        try:
            values[name] = read(simulate(driven, law, t_end=t_end, y0=y0, throw=False))
        except (SimulationError, InputError):
            return None
    return values


def _coast(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw],
    best: str,
    speed: float,
    doubt: float,
) -> Experiment | None:
    """Let go at the record's speed: how far it goes until it stops."""
    slip = mechanism.contacts()[0].slip
    rate = mechanism.rates[mechanism.coordinates.index(slip)]
    values = _simulated(
        mechanism,
        laws,
        lambda run: float(run.at(run.span[1])[slip][0]),
        t_end=60.0,
        drive=None,
        y0={rate: speed},
    )
    if values is None or not all(map(math.isfinite, values.values())):
        return None
    return Experiment(
        what=f"Coast from {_plain(1e3 * speed, 3)} mm/s with the drive off, three times each way.",
        observed="distance to the stop, m",
        predicted=values,
        separation=_separation(values, best, doubt),
    )


def _presliding(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw],
    best: str,
    share: float,
    doubt: float,
    load: float,
) -> Experiment | None:
    """Push to and fro below break-away: how far it gives way."""
    level = float(towards(laws[best], 1).break_away(load))
    slip = mechanism.contacts()[0].slip
    offset = float(getattr(mechanism, "offset", 0.0))
    if level <= 0.0:
        return None

    def moved(run: Any) -> float:
        return float(np.ptp(run.at(np.linspace(2.0, run.span[1], ROWS))[slip]))

    values = _simulated(
        mechanism,
        laws,
        moved,
        t_end=4.0,
        drive=Sine(amplitude=share * level, frequency=0.5) + _held(offset),
        y0={},
    )
    if values is None:
        return None
    return Experiment(
        what=(
            f"A force of {share * level:.3g} N to and fro at 0.5 Hz, below break-away, for a"
            " minute."
        ),
        observed="movement from peak to peak, m",
        predicted=values,
        separation=_separation(values, best, doubt),
    )


def _held(force: float) -> Drive:
    return Sampled(times=(0.0,), values=(force,))
