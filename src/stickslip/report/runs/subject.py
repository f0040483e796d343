"""What a report of a run is about, and the words that its sections share."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import final

import numpy as np

from stickslip.experiments import LawEstimates, Rig
from stickslip.formatting import quantity, scale_of
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import cycle_or_none, slip_names
from stickslip.selection import Criteria, criteria_of
from stickslip.sweep import Band, DrivenCycle, Spread, Validation, cycles_in
from stickslip.trajectory import Trajectory


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class RunReport:
    """A run with what is known of it.

    Parameters
    ----------
    rig : Rig
        What moved.
    law : FrictionLaw
        With what friction.
    run : Trajectory
        How.
    estimates : LawEstimates, optional
        How well the law is known.
    remarks : tuple of str
        What does not carry over from where the law was fitted.
    law_file : str
        Where that was, if it was another file than the rig's.
    band : Band, optional
        The motion with the law's parameters drawn from their estimates.
    validation : Validation, optional
        What was measured on the rig beside the prediction.
    refit : tuple of str
        How the law compares with a fit to that measurement, in sentences.
    fixed_step : float, optional
        The step [s], where the run was made in fixed steps.
    commands : tuple of str
        Commands that give this report again.
    versions : mapping of str to str
        What the result may depend on.
    digests : mapping of str to str
        Hashes of the inputs.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = Rig(title="Block", mechanism=SpringBlock(mass=1.0, stiffness=100.0, compression=0.1))
    >>> law = Coulomb(kinetic_coefficient=0.25)
    >>> subject = RunReport(rig=rig, law=law, run=simulate(rig.mechanism, law, t_end=1.0))
    >>> subject.unit, subject.cycles, round(subject.criteria.travel, 4)
    ('m', (), 0.2039)
    """

    rig: Rig
    law: FrictionLaw
    run: Trajectory
    estimates: LawEstimates | None = None
    remarks: tuple[str, ...] = ()
    law_file: str = ""
    band: Band | None = None
    validation: Validation | None = None
    refit: tuple[str, ...] = ()
    fixed_step: float | None = None
    commands: tuple[str, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    digests: Mapping[str, str] = field(default_factory=dict)

    @property
    def part(self) -> str:
        """What slips, such as "cart"."""
        return self.rig.mechanism.moving_part

    @property
    def slip(self) -> str:
        """Name of the slipping coordinate."""
        return slip_names(self.rig.mechanism)[0]

    @property
    def rate(self) -> str:
        """Name of its rate."""
        return slip_names(self.rig.mechanism)[1]

    @property
    def unit(self) -> str:
        """Unit of the slipping coordinate."""
        return self.run.units[self.slip]

    @property
    def moves(self) -> bool:
        """Whether the body moves at all."""
        # an exact step may lead from rest to rest
        return bool(np.any(self.run[self.rate] != 0.0) or np.ptp(self.run[self.slip]) > 0.0)

    @property
    def mean_velocity(self) -> float:
        """Over all whole cycles, or without any over the run."""
        if self.cycles:
            return sum(one.travel for one in self.cycles) / (
                len(self.cycles) * self.cycles[0].period
            )
        first, last = self.run.span
        return self.criteria.travel / (last - first)

    @cached_property
    def criteria(self) -> Criteria:
        """What the run does, in the terms of the source paper."""
        measurement = self.rig.measurement
        records = () if measurement is None else measurement.records()
        travel = records[0].travel if len(records) == 1 else None
        return criteria_of(self.run, self.rig.mechanism, None if travel is None else float(travel))

    @cached_property
    def cycles(self) -> tuple[DrivenCycle, ...]:
        """The whole cycles of a run whose drives repeat themselves."""
        period = cycle_or_none(self.rig.mechanism)
        return () if period is None else cycles_in(self.run, self.rig.mechanism, period)

    def of(self, value: float, digits: int = 3, *, per_second: bool = False) -> str:
        """Return a distance or a speed of the slipping coordinate, with its unit."""
        return quantity(value + 0.0, self.unit + ("/s" if per_second else ""), digits)

    def range_beside(self, spread: Spread, value: float, *, per_second: bool = False) -> str:
        """Return a range of distances or speeds in the unit of the number beside it."""
        unit = self.unit + ("/s" if per_second else "")
        scale = scale_of([value] if value else [spread.low, spread.high], unit)
        return scale.interval(spread.low, spread.high)

    def advances(self, travel: float, digits: int = 3) -> str:
        """Return by how much the body advances or moves back, as a predicate."""
        verb = "advances" if travel >= 0.0 else "moves back"
        return f"{verb} {self.of(abs(travel), digits)}"
