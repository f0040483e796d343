"""Settings of a rig: what is set, in which unit, and what laws predict there."""

import contextlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.errors import StickslipError
from stickslip.experiments import whole_cycles
from stickslip.formatting import number
from stickslip.friction import FrictionLaw
from stickslip.identification import TravelModel, Trial
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary

KNOBS = ("mechanism.compression", "mechanism.drive.level", "mechanism.drive.amplitude")
"""Parameters an experimenter can turn, in the order of ease."""


def unit_of(unit: str) -> tuple[str, float]:
    """Return the unit that settings are read in, and its numbers over those in SI.

    Examples
    --------
    >>> unit_of("m"), unit_of("N"), unit_of("rad")[0]
    (('mm', 1000.0), ('N', 1.0), '°')
    """
    return {"m": ("mm", 1e3), "rad": ("°", math.degrees(1.0))}.get(unit, (unit, 1.0))


def rounded_setting(value: float, unit: str) -> float:
    """Return a setting [SI] with three digits in the unit that it is read in.

    Examples
    --------
    >>> rounded_setting(0.0123456, "m"), math.degrees(rounded_setting(0.314, "rad"))
    (0.0123, 18.0)
    """
    _, factor = unit_of(unit)
    return float(f"{factor * value:.3g}") / factor


def words_of(path: str) -> str:
    """Return what a parameter of the mechanism is called.

    Examples
    --------
    >>> words_of("mechanism.compression"), words_of("mechanism.drive.drive.frequency")
    ('compression', 'drive frequency')
    """
    words = path.removeprefix("mechanism.").replace(".", " ").replace("_", " ").split()
    return " ".join(dict.fromkeys(words))  # a drive of a motor is its drive


@dataclass(frozen=True, kw_only=True)
class Separation:
    """One setting of the rig and the travel each fitted law predicts for it."""

    path: str
    """Parameter to set."""
    symbol: str
    """Its symbol."""
    unit: str
    """Its SI unit."""
    value: float
    """Setting, SI."""
    predicted: Mapping[str, float]
    """Travel [m] by law."""

    @property
    def text(self) -> str:
        """The setting with its unit, lengths in millimetres and angles in degrees."""
        unit, factor = unit_of(self.unit)
        return f"{number(factor * self.value, 6)} {unit}".replace(" °", "°")

    def to_dict(self) -> Mapping[str, Any]:
        """Return the separation as plain numbers and strings."""
        return {"set": {self.path: self.value}, "predicted_travel": dict(self.predicted)}


def knob_of(
    mechanism: Mechanism, trials: Sequence[Trial] = ()
) -> tuple[str, str, str, float] | None:
    """Return path, symbol, unit and value of the parameter that is set to get other travels.

    What the trials vary, if that is one parameter, can be set; else, or where that one is 0 as the
    rig stands, it is the one that is easiest to turn.
    """
    known = {
        path: (q.symbol, q.unit, value) for path, q, value in parameters(mechanism, "mechanism")
    }
    varied = [path for path in known if len({_value(trial, path) for trial in trials}) > 1]
    for path in (*(varied if len(varied) == 1 else ()), *KNOBS):
        if path in known and known[path][2] != 0:
            return path, *known[path]
    return None


def _value(trial: Trial, path: str) -> float | None:
    found = {name: value for name, _, value in parameters(trial.mechanism, "mechanism")}
    return found.get(path)


def predictions(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw],
    path: str,
    settings: Sequence[float],
    *,
    t_end: float,
    initial: Mapping[str, float] | None = None,
    per_cycle: bool = False,
) -> tuple[Separation, ...]:
    """Predict the travel of each law at given settings, but for those where no run ends."""
    symbol, unit = next(
        (q.symbol, q.unit) for one, q, _ in parameters(mechanism, "mechanism") if one == path
    )
    asked = []
    for setting in settings:
        changed = vary(mechanism, "mechanism", {path: setting})
        with contextlib.suppress(StickslipError):
            trial = Trial(
                mechanism=changed,
                initial=initial or {},
                travel=0.0,
                half_width=0.0,
                cycles=whole_cycles(changed, t_end) if per_cycle else None,
            )
            asked.append((trial, setting))
    if not asked:
        return ()
    trials = [trial for trial, _ in asked]
    travels = {name: _travels(law, trials, t_end) for name, law in laws.items()}
    found = []
    for i, (_, setting) in enumerate(asked):
        predicted = {name: float(made[i]) for name, made in travels.items()}
        if all(map(math.isfinite, predicted.values())):
            found.append(
                Separation(
                    path=path,
                    symbol=symbol,
                    unit=unit,
                    value=setting,
                    predicted=predicted,
                )
            )
    return tuple(found)


def _travels(law: FrictionLaw, trials: Sequence[Trial], t_end: float) -> list[float]:
    """Return the travel of each trial [m]; NaN where a run cannot be made."""
    model = TravelModel(law, (), t_end)
    try:
        travels: list[float] = model.table(trials, np.zeros((1, 0)))[0].tolist()
    except StickslipError:  # of one setting, which is one of many
        travels = []
        for trial in trials:
            try:
                travels.append(model.travel(trial, ()))
            except StickslipError:
                travels.append(math.nan)
    return travels
