"""The route of scarce data: travels of a body that comes to rest."""

import math
from collections import Counter
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError, ParameterError
from stickslip.experiments import Measurement
from stickslip.experiments.paths import canonical
from stickslip.experiments.units import check_uncertainty
from stickslip.friction import FrictionLaw, bristles_of
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary
from stickslip.simulation import simulate

__all__ = [
    "TravelModel",
    "Trial",
    "standard_errors",
    "trials_of",
    "uncertainties_of",
    "under_cycles",
]

Array: TypeAlias = NDArray[np.float64]

LEAST_ERROR = 1e-5
"""Share of the mean travel below which readings are not told apart: runs are exact to 1e-8, and no
travel was ever measured to this."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One measured travel and how the rig was set for it."""

    mechanism: Mechanism
    initial: Mapping[str, float]
    travel: float
    half_width: float
    """Uncertainty of the travel [m]; 0 if none was given."""
    kind: str = "standard"
    """What the uncertainty is, as in `Measurement`."""
    doubts: Mapping[str, float] = field(default_factory=dict)
    """Standard uncertainties of the mechanism's parameters that are of this trial alone."""
    shared: Mapping[str, float] = field(default_factory=dict)
    """Those that all trials share."""

    def with_mechanism(self, mechanism: Mechanism) -> "Trial":
        """Return the trial as if it had been made with another mechanism."""
        return replace(self, mechanism=mechanism)

    def start(self, law: FrictionLaw) -> Mapping[str, float]:
        """Return the initial states that a mechanism with a law has."""
        known = {*self.mechanism.coordinates, *self.mechanism.rates}
        known.update(bristles_of(law))
        return {name: value for name, value in self.initial.items() if name in known}

    @property
    def setting(self) -> Hashable:
        """What the experimenter set: trials of one setting are repeats."""
        return self.mechanism, frozenset(self.initial.items())


def trials_of(mechanism: Mechanism, measurement: Measurement) -> tuple[Trial, ...]:
    """Return the trials of a measurement of travels.

    Raises
    ------
    InputError
        If a record has no travel, or an uncertainty is of no parameter.
    """
    trials = []
    uncertainties = uncertainties_of(mechanism, measurement)
    for record, (own, shared) in zip(measurement.records(), uncertainties, strict=True):
        if record.travel is None:
            raise InputError(
                f"this fit uses travels, and record {record.name or 'without a name'!r} has none;"
                f" it has {', '.join(record.quantities())}."
            )
        trials.append(
            Trial(
                mechanism=vary(mechanism, "mechanism", record.overrides),
                initial=record.initial,
                travel=float(record.travel),
                half_width=float(record.uncertainty.get("travel", 0.0)),
                kind=record.uncertainty_kind,
                doubts=own,
                shared=shared,
            )
        )
    return tuple(trials)


def uncertainties_of(
    mechanism: Mechanism, measurement: Measurement
) -> list[tuple[dict[str, float], dict[str, float]]]:
    """Return standard uncertainties of the mechanism's parameters by path, of each record.

    Those of the record alone come first, then those that all records share: what any record sets
    was set anew for each of them, and what none sets is one number for all.

    Raises
    ------
    InputError
        If an uncertainty is of no parameter.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0)
    >>> trials = [Measurement(travel=s, overrides={"mechanism.compression": s}) for s in (0.1, 0.2)]
    >>> both = Measurement(trials=tuple(trials), doubts={"compression": 1e-3, "mass": 0.01})
    >>> uncertainties_of(rig, both)[0]
    ({'mechanism.compression': 0.001}, {'mechanism.mass': 0.01})
    """
    records = measurement.records()
    common = _doubts(mechanism, measurement.doubts) if measurement.trials else {}
    anew = {path for record in records for path in record.overrides}
    by_hand = {path: one for path, one in common.items() if path in anew}
    found = []
    for record in records:
        own = {**by_hand, **_doubts(vary(mechanism, "mechanism", record.overrides), record.doubts)}
        shared = {path: one for path, one in common.items() if path not in own}
        found.append((own, shared))
    return found


def _doubts(mechanism: Mechanism, given: Mapping[str, float]) -> dict[str, float]:
    """Return uncertainties by full path, of parameters that have a value."""
    known = {path: (quantity, v) for path, quantity, v in parameters(mechanism, "mechanism")}
    found = {canonical(mechanism, path): doubt for path, doubt in given.items()}
    for path, doubt in found.items():
        if path not in known:
            raise InputError(
                f"{path} has an uncertainty, but {type(mechanism).__name__} has no value of it."
            )
        quantity, value = known[path]
        try:
            check_uncertainty(doubt, value, quantity)
        except ParameterError as error:
            raise ParameterError(f"doubts: {path} {error}") from None
    return found


def standard_errors(trials: Sequence[Trial]) -> tuple[Array, bool]:
    """Return a standard error of each travel [m], and whether any uncertainty was stated.

    That of a rounding range is that of a uniform distribution; repeats of a setting that were all
    rounded to one number share one error, and so tell no more than one of them. Readings without a
    stated uncertainty beside others with one have the largest stated one. Where none is stated the
    errors are lower bounds, for the true ones to be estimated from the residuals: nobody reads
    better than the last digit that is written down.

    Parameters
    ----------
    trials : sequence of Trial
        The readings.

    Returns
    -------
    array (n,), bool
        Standard errors [m], and whether they are more than lower bounds.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> one = Trial(mechanism=rig, initial={}, travel=0.204, half_width=0.0)
    >>> errors, stated = standard_errors([one])
    >>> f"{1e3 * errors[0]:.2f} mm", stated
    ('0.29 mm', False)
    """
    rounded = 1.0 / math.sqrt(3.0)
    widths = np.array([t.half_width * (rounded if t.kind == "rounding" else 1.0) for t in trials])
    least = LEAST_ERROR * float(np.mean([abs(trial.travel) for trial in trials])) or LEAST_ERROR
    groups = Counter((t.setting, t.travel) for t in trials if t.kind == "rounding")
    settings = Counter(trial.setting for trial in trials)
    for i, t in enumerate(trials):
        if groups[t.setting, t.travel] == settings[t.setting]:
            widths[i] *= math.sqrt(settings[t.setting])
    if np.any(widths > 0.0):
        return np.maximum(np.where(widths > 0.0, widths, widths.max()), 1e-3 * least), True
    exponents = [Decimal(repr(trial.travel)).normalize().as_tuple().exponent for trial in trials]
    digit = 10.0 ** min(int(one) for one in exponents)
    return np.full(len(trials), max(min(digit, 0.01) / math.sqrt(12.0), least)), False


def under_cycles(trials: Sequence[Trial]) -> bool:
    """Whether a drive that repeats itself moves the body again and again.

    Examples
    --------
    >>> from stickslip import Capsule, Square, SpringBlock, Torque
    >>> wave = Torque(drive=Square(high=6.0, low=-1.0, period=0.4))
    >>> rigs = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=wave), SpringBlock(mass=1.0)
    >>> trials = [Trial(mechanism=rig, initial={}, travel=0.2, half_width=0.0) for rig in rigs]
    >>> under_cycles(trials), under_cycles(trials[1:])
    (True, False)
    """
    drives = (drive for trial in trials for drive in trial.mechanism.drives().values())
    return any(drive.repeats() is not None for drive in drives)


@dataclass
class TravelModel:
    """Travel as a function of the free parameters of a law."""

    law: FrictionLaw
    free: Sequence[str]
    t_end: float
    watch: Callable[[int], object] | None = None
    runs: int = field(default=0, init=False)

    def with_values(self, values: Sequence[float]) -> FrictionLaw:
        """Return the law with other values of the free parameters."""
        changes = dict(zip(self.free, values, strict=True))
        return vary(self.law, "friction", changes)

    def travel(self, trial: Trial, values: Sequence[float]) -> float:
        """Return the travel [m] of one trial."""
        self.runs += 1
        if self.watch is not None:
            self.watch(self.runs)
        law = self.with_values(values)
        run = simulate(trial.mechanism, law, t_end=self.t_end, y0=trial.start(law))
        (coordinate,) = (contact.slip for contact in trial.mechanism.contacts())
        ends = run.at(run.span)[coordinate]
        return float(ends[1] - ends[0])

    def travels(self, trials: Sequence[Trial], values: Sequence[float]) -> Array:
        """Return the travel of each trial [m] (n,); trials of one setting are one run."""
        found: dict[Hashable, float] = {}
        for trial in trials:
            if trial.setting not in found:
                found[trial.setting] = self.travel(trial, values)
        return np.array([found[trial.setting] for trial in trials])
