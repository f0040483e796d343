"""How the files of a measurement are read: names, units and factors of their columns."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import final

from stickslip.experiments.repair import Repair, repairs
from stickslip.experiments.spelling import Speaker

__all__ = ["Reading"]


@final
@dataclass(frozen=True, kw_only=True)
class Reading:
    """How files are read; arguments as in `load_measurement`.

    Examples
    --------
    >>> rig = Reading(columns={"position": "q"}, gain={"force": 35.15})
    >>> rig.with_changes(Reading(columns={"force": "u"})).columns
    {'position': 'q', 'force': 'u'}
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    """Quantity -> name of its column."""
    units: Mapping[str, str] = field(default_factory=dict)
    """Quantity -> unit of its column."""
    gain: Mapping[str, float] = field(default_factory=dict)
    """Quantity -> factor, as in `load_measurement`."""
    offset: Mapping[str, float] = field(default_factory=dict)
    """Quantity -> offset of its sensor, in SI."""
    repair: tuple[Repair, ...] = ()
    """What is repaired."""
    conditions: tuple[str, ...] = ()
    """Columns that hold a condition of the trial, one value in each."""
    by: Speaker = field(default="python", compare=False)
    """Who said so, and is to be told in the same spelling what else to say."""

    def __post_init__(self) -> None:
        """Check what is to be repaired."""
        object.__setattr__(self, "repair", repairs(self.repair))
        object.__setattr__(self, "conditions", tuple(dict.fromkeys(self.conditions)))

    def with_changes(self, other: "Reading") -> "Reading":
        """Return this one with what another one says in addition or instead."""
        return Reading(
            columns={**self.columns, **other.columns},
            units={**self.units, **other.units},
            gain={**self.gain, **other.gain},
            offset={**self.offset, **other.offset},
            repair=self.repair + other.repair,
            conditions=self.conditions + other.conditions,
            by=self.by if other.by == "python" else other.by,
        )
