"""Which further measurement would tell the candidates apart: found by simulating it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from stickslip.errors import StickslipError
from stickslip.friction import FrictionLaw
from stickslip.identification.travel import TravelModel, Trial
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary

__all__ = ["Separation", "knob_of", "proposals", "separations"]

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


@dataclass(frozen=True, kw_only=True)
class Separation:
    """One setting of the rig and the travel each fitted law predicts for it."""

    path: str
    """Parameter to set."""
    symbol: str
    unit: str
    value: float
    """Setting, SI."""
    predicted: Mapping[str, float]
    """Travel [m] by law."""
    measured: bool = False
    """Whether a trial was made at this setting; it is then no proposal."""

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


def knob_of(mechanism: Mechanism) -> tuple[str, str, str, float] | None:
    """Return path, symbol, unit and value of the parameter that is easiest to turn."""
    known = {
        path: (q.symbol, q.unit, value) for path, q, value in parameters(mechanism, "mechanism")
    }
    for path in KNOBS:
        if path in known and known[path][2] != 0:
            return path, *known[path]
    return None


def separations(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw],
    *,
    t_end: float,
    trials: Sequence[Trial] = (),
    factors: Sequence[float] = FACTORS,
) -> tuple[Separation, ...]:
    """Predict the travel of each law at settings of the rig, in the order of the setting.

    Parameters
    ----------
    mechanism : Mechanism
        The rig as it stands.
    laws : mapping of str to FrictionLaw
        The fitted laws by name.
    t_end : float
        Time after which a body counts as stopped [s].
    trials : sequence of Trial
        What was measured: their settings are marked, and where they span all others, settings
        beyond them are added.
    factors : sequence of float
        Settings over the present one.
    """
    knob = knob_of(mechanism)
    if knob is None or not laws:
        return ()
    path, symbol, unit, value = knob
    initial = trials[0].initial if trials else {}
    found = []
    for setting, measured in _settings(mechanism, path, value, trials, factors):
        changed = vary(mechanism, "mechanism", {path: setting})
        trial = Trial(mechanism=changed, initial=initial, travel=0.0, half_width=0.0)
        try:
            predicted = {
                name: TravelModel(law, (), t_end).travel(trial, ()) for name, law in laws.items()
            }
        except StickslipError:
            continue
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


def _settings(
    mechanism: Mechanism,
    path: str,
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
    rows += [(float(f"{f * value:.3g}"), False) for f in new]
    return sorted(rows, key=lambda row: row[0] / value)


def _share(mechanism: Mechanism, path: str, value: float, trial: Trial) -> float:
    """Return the setting of a trial over the present one; 0 if more than that was different."""
    as_it_stands, as_set = (
        {name: number for name, _, number in parameters(rig, "mechanism")}
        for rig in (mechanism, trial.mechanism)
    )
    same = {**as_set, path: value} == as_it_stands and not trial.initial
    return as_set[path] / value if same else 0.0


def proposals(rows: Sequence[Separation], name: str) -> tuple[Separation, ...]:
    """Return the settings that are not measured yet and at which a law still moves the body.

    Parameters
    ----------
    rows : sequence of Separation
        In the order of the setting.
    name : str
        The law.
    """
    farthest = max((abs(row.predicted[name]) for row in rows), default=0.0)
    return tuple(r for r in rows if not r.measured and abs(r.predicted[name]) > MOVES * farthest)
