"""Which further measurement would tell the candidates apart: found by simulating it."""

import contextlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, product
from typing import Any

import numpy as np

from stickslip.errors import StickslipError
from stickslip.experiments import whole_cycles
from stickslip.formatting import joined, number, quantity, scale_of
from stickslip.friction import FrictionLaw
from stickslip.identification import TravelModel, Trial
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary

FACTORS = (0.4, 0.6, 0.8, 1.0, 1.25, 1.5)
"""Settings tried, over the present one: what a rig can usually be set to."""
KNOBS = ("mechanism.compression", "mechanism.drive.level", "mechanism.drive.amplitude")
"""Parameters an experimenter can turn, in the order of ease."""
SAME = 0.02
"""Settings closer than this share are one setting."""
BEYOND = (0.75, 1.5)
"""New settings below and above those measured, over the outermost, where they span all others."""
MOVES = 0.05
"""Share of the longest travel below which a setting is not worth a run."""


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
    >>> words_of("mechanism.compression"), words_of("mechanism.drive.level")
    ('compression', 'drive level')
    """
    return path.removeprefix("mechanism.").replace(".", " ").replace("_", " ")


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
    measured: bool = False
    """Whether a trial was made at this setting; it is then no proposal."""

    @property
    def text(self) -> str:
        """The setting with its unit, lengths in millimetres and angles in degrees."""
        unit, factor = unit_of(self.unit)
        return f"{number(factor * self.value, 6)} {unit}".replace(" °", "°")

    def gap(self, one: str, other: str) -> float:
        """Return the difference of two predictions [m]."""
        return abs(self.predicted[one] - self.predicted[other])

    @property
    def spread(self) -> float:
        """Largest difference of two predictions [m]."""
        return max(self.predicted.values()) - min(self.predicted.values())

    def to_dict(self) -> Mapping[str, Any]:
        """Return the separation as plain numbers and strings."""
        return {
            "set": {self.path: self.value},
            "measured": self.measured,
            "predicted_travel": dict(self.predicted),
        }


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """Which settings to measure next to tell the best law from others, and what to expect."""

    what: str
    """Parameter to set, in words."""
    best: str
    """Key of the best law."""
    rival: str
    """Key of the law that differs most from it at these settings."""
    rivals: tuple[str, ...]
    """Keys of all laws that are to be told from the best."""
    settings: tuple[Separation, ...]
    """Settings to measure, one or two; empty if none separates the laws."""
    tried: tuple[Separation, ...]
    """New settings that were simulated and at which the body moves."""
    apart: tuple[str, ...]
    """Keys of the laws that these settings separate from the best."""
    widest: float
    """Largest difference of any of these laws from the best at a new setting [m]."""
    errors: Mapping[str, Sequence[float]]
    """Half the 95 % interval of what laws predict at each of the settings [m], by key."""

    def to_dict(self) -> Mapping[str, Any]:
        """Return the proposal as plain numbers and strings."""
        return {
            "set": [{row.path: row.value} for row in self.settings],
            "rivals": list(self.rivals),
            "separates": list(self.apart),
            "largest_difference": self.widest,
            "prediction_errors": {name: list(found) for name, found in self.errors.items()},
        }

    def line(self, titles: Mapping[str, str]) -> str:
        """Return the proposal as a sentence, with the titles of the laws by key."""
        if not self.tried:
            return f"No new setting of the {self.what} was found at which the body moves."
        symbol = f"${self.tried[0].symbol}$"
        others = [titles[name] for name in self.rivals]
        names = joined(others)
        if not self.settings:
            first, last = self.tried[0].text, self.tried[-1].text
            ends = f"from {first} to {last}" if len(self.tried) > 1 else f"such as {first}"
            return (
                f"No setting of {symbol} {ends} would distinguish {titles[self.best]} from"
                f" {names}: their predictions differ by at most {quantity(self.widest, 'm', 2)},"
                " which is within the uncertainty of reading and predicting them."
            )
        told = {
            name: [row.predicted[name] for row in self.settings] for name in (self.best, self.rival)
        }
        sizes = [abs(travel) for travel in chain(*told.values())]
        scale = scale_of([max(min(sizes), 1e-3 * max(sizes))], "m")
        one, other = (
            joined(
                [
                    f"{scale.quantity(x)} ± {scale.quantity(error, 2)}"
                    for x, error in zip(travels, self.errors[name], strict=True)
                ]
            )
            for name, travels in told.items()
        )
        return (
            f"Set {symbol} to {joined([row.text for row in self.settings])}, three runs each."
            f" {titles[self.best]} predicts {one}, {titles[self.rival]} {other}."
        )


def propose(
    rows: Sequence[Separation],
    best: str,
    rivals: Sequence[str],
    doubt: float,
    errors: Mapping[str, Sequence[float]],
) -> Proposal | None:
    """Propose the settings that separate the best law from its rivals; None without any to try.

    These are the outermost two settings that were not measured if a rival differs there by more
    than the doubt, since they tell how travel grows; else the one where one differs most. `errors`
    have half the 95 % interval of what each law predicts at each of the rows, which a difference
    must exceed too: what laws predict far from what was measured may be uncertain.
    """
    if not rows or not rivals:
        return None
    place = {id(row): i for i, row in enumerate(rows)}

    def gap(some: Sequence[Separation], names: Sequence[str]) -> tuple[float, str]:
        """Return the largest difference from the best law that can be seen, and whose it is."""
        gaps = dict.fromkeys(names, 0.0)
        for row, name in product(some, names):
            uncertain = math.hypot(errors[best][place[id(row)]], errors[name][place[id(row)]])
            seen = row.gap(best, name)
            gaps[name] = max(gaps[name], seen if seen > math.hypot(doubt, uncertain) else 0.0)
        name = max(gaps, key=lambda one: gaps[one])
        return gaps[name], name

    farthest = max(abs(row.predicted[best]) for row in rows)
    least = max(MOVES * farthest, doubt)
    tried = tuple(r for r in rows if not r.measured and abs(r.predicted[best]) > least)
    outer = tried[:1] + tried[1:][-1:]
    inner = tuple(sorted(tried, key=lambda row: gap([row], rivals)[0])[-1:])
    settings = next((s for s in (outer, inner) if s and gap(s, rivals)[0] > 0.0), ())
    names = [best, *rivals]
    return Proposal(
        what=words_of(rows[0].path),
        best=best,
        rival=gap(settings, rivals)[1] if settings else _gap(tried, best, rivals)[1],
        rivals=tuple(rivals),
        settings=settings,
        tried=tried,
        apart=tuple(name for name in rivals if gap(settings, [name])[0] > 0.0),
        widest=_gap(tried, best, rivals)[0],
        errors={n: tuple(errors[n][place[id(row)]] for row in settings) for n in names},
    )


def _gap(rows: Sequence[Separation], best: str, names: Sequence[str]) -> tuple[float, str]:
    """Return the largest difference from the best law [m], and whose it is."""
    gaps = {name: max((row.gap(best, name) for row in rows), default=0.0) for name in names}
    name = max(gaps, key=lambda one: gaps[one])
    return gaps[name], name


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


def separations(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw],
    *,
    t_end: float,
    trials: Sequence[Trial] = (),
    factors: Sequence[float] = FACTORS,
) -> tuple[Separation, ...]:
    """Predict the travel of each law at settings of the rig, in the order of the setting."""
    knob = knob_of(mechanism, trials)
    if knob is None or not laws:
        return ()
    path, _, unit, value = knob
    settings = _settings(mechanism, path, unit, value, trials, factors)
    initial = trials[0].initial if trials else {}
    per_cycle = bool(trials and trials[0].cycles)
    return predictions(
        mechanism, laws, path, settings, t_end=t_end, initial=initial, per_cycle=per_cycle
    )


def predictions(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw],
    path: str,
    settings: Sequence[tuple[float, bool]],
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
    for setting, measured in settings:
        changed = vary(mechanism, "mechanism", {path: setting})
        with contextlib.suppress(StickslipError):
            trial = Trial(
                mechanism=changed,
                initial=initial or {},
                travel=0.0,
                half_width=0.0,
                cycles=whole_cycles(changed, t_end) if per_cycle else None,
            )
            asked.append((trial, setting, measured))
    if not asked:
        return ()
    trials = [trial for trial, _, _ in asked]
    travels = {name: _travels(law, trials, t_end) for name, law in laws.items()}
    found = []
    for i, (_, setting, measured) in enumerate(asked):
        predicted = {name: float(made[i]) for name, made in travels.items()}
        if all(map(math.isfinite, predicted.values())):
            found.append(
                Separation(
                    path=path,
                    symbol=symbol,
                    unit=unit,
                    value=setting,
                    predicted=predicted,
                    measured=measured,
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


def _settings(
    mechanism: Mechanism,
    path: str,
    unit: str,
    value: float,
    trials: Sequence[Trial],
    factors: Sequence[float],
) -> list[tuple[float, bool]]:
    """Return settings to try, and whether each was measured, by their share of the present one."""
    done = sorted({share for t in trials if (share := _share(mechanism, path, value, t)) > 0.0})
    tried = sorted(factors)
    if done and done[0] <= (1.0 + SAME) * tried[0]:
        tried.insert(0, BEYOND[0] * done[0])
    if done and done[-1] >= (1.0 - SAME) * tried[-1]:
        tried.append(BEYOND[1] * done[-1])
    new = [f for f in tried if all(abs(f - share) > SAME * share for share in done)]
    rows = [(float(f"{share * value:.12g}"), True) for share in done]
    rows += [(rounded_setting(f * value, unit), False) for f in new]
    return sorted(rows, key=lambda row: row[0] / value)


def _share(mechanism: Mechanism, path: str, value: float, trial: Trial) -> float:
    """Return the setting of a trial over the present one; 0 if more than that was different."""
    as_it_stands, as_set = (
        {name: number for name, _, number in parameters(rig, "mechanism")}
        for rig in (mechanism, trial.mechanism)
    )
    same = {**as_set, path: value} == as_it_stands and not trial.initial
    return as_set[path] / value if same else 0.0
