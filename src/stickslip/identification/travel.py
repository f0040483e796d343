"""The route of scarce data: travels of a body that comes to rest."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.friction import FrictionLaw, bristles_of
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary
from stickslip.simulation import simulate

__all__ = ["TravelModel", "Trial", "trials_of"]


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
        If a record has no travel.
    """
    trials = []
    for record in measurement.records():
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
            )
        )
    return tuple(trials)


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
