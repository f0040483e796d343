"""What moves an inner body: a motion it is told, or a force or torque."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive, Profile
from stickslip.maths import Scalar, where
from stickslip.mechanisms.base import Guide
from stickslip.quantities import Parametrised, Quantity

DRIVE = "motor"
"""Name of the drive that a motor has."""


@dataclass(frozen=True, kw_only=True)
class Motor(Parametrised, ABC):
    """What acts between a body and what it carries."""

    name: ClassVar[str]
    """``type`` in rig files."""
    wanted: ClassVar[str] = "a motor, Prescribed(...) or Torque(...)"

    @override
    @classmethod
    def instead(cls, given: object) -> str:
        if isinstance(given, Profile):
            return "Write Prescribed(profile=...)."
        if isinstance(given, Drive):
            return "Write Torque(drive=...)."
        return f"Write Torque(drive=...). {Drive.instead(given)}" if callable(given) else ""

    @abstractmethod
    def drives(self) -> Mapping[str, Drive]:
        """Return the drives that are fitted, by name."""

    @abstractmethod
    def force(self, drives: Mapping[str, Scalar]) -> Scalar:
        """Return the force [N] or torque [N m] at present values of the drives."""

    @abstractmethod
    def start(self, coordinate: str, rate: str) -> Mapping[str, Scalar]:
        """Return where the driven coordinate begins, by name; empty where it is free to.

        Parameters
        ----------
        coordinate : str
            Name of the driven coordinate.
        rate : str
            Name of its rate.

        Returns
        -------
        mapping of str to float or array
            Values at time 0, in SI units.
        """

    @abstractmethod
    def guide(self, effort: str, unit: str) -> Guide | None:
        """Return how the coordinate is guided, None where a force moves it.

        Parameters
        ----------
        effort : str
            Name for the force or torque that the motion takes, as a column of runs.
        unit : str
            Unit of that effort, ``"N"`` or ``"N m"``.

        Returns
        -------
        Guide or None
            The guide of the coordinate.
        """

    @abstractmethod
    def limits(self, effort: Scalar) -> Mapping[str, Scalar]:
        """Return what ends a run as a guided coordinate needs too much, by event."""


@final
@dataclass(frozen=True, kw_only=True)
class Prescribed(Motor):
    """A prescribed motion; the force or torque that it requires is computed.

    Examples
    --------
    >>> from stickslip.drives import ThreePhase
    >>> motor = Prescribed(profile=ThreePhase(amplitude=0.8, fast=120.0, slow=30.0))
    >>> float(motor.start("theta", "omega")["theta"])
    -0.8
    """

    name: ClassVar[str] = "prescribed"

    profile: Profile
    """The motion."""
    limit: Annotated[float, Quantity("tau_m", "N m", above=0, or_unit="N")] | None = None
    """Largest force or torque; a run that needs more ends there. None if not given."""

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {DRIVE: self.profile}

    @override
    def force(self, drives: Mapping[str, Scalar]) -> Scalar:
        return 0.0

    @override
    def start(self, coordinate: str, rate: str) -> Mapping[str, Scalar]:
        return {coordinate: self.profile.start_position, rate: self.profile.start_rate}

    @override
    def guide(self, effort: str, unit: str) -> Guide | None:
        return Guide(drive=DRIVE, effort=effort, unit=unit)

    @override
    def limits(self, effort: Scalar) -> Mapping[str, Scalar]:
        if self.limit is None:
            return {}
        share = effort / self.limit
        return {"motor limit forward": 1.0 - share, "motor limit backward": 1.0 + share}


@final
@dataclass(frozen=True, kw_only=True)
class Torque(Motor):
    """A force or torque given as a function of time, limited to what the motor can supply.

    Examples
    --------
    >>> from stickslip.drives import Sine
    >>> Torque(drive=Sine(amplitude=0.4, frequency=1.0), limit=0.3).name
    'torque'
    """

    name: ClassVar[str] = "torque"

    drive: Drive | None = None
    """Torque [N m] or force [N]; none if not given."""
    limit: Annotated[float, Quantity("tau_m", "N m", above=0, or_unit="N")] | None = None
    """Largest torque: beyond it the motor saturates. None if not given."""

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.drive is None else {DRIVE: self.drive}

    @override
    def force(self, drives: Mapping[str, Scalar]) -> Scalar:
        wanted = drives.get(DRIVE, 0.0)
        if self.limit is None or self.drive is None:
            return wanted
        most = self.limit
        named = ("motor saturates", "motor leaves saturation")
        above = where(wanted > most, most, wanted, named)
        return where(wanted < -most, -most, above, named)

    @override
    def start(self, coordinate: str, rate: str) -> Mapping[str, Scalar]:
        return {}

    @override
    def guide(self, effort: str, unit: str) -> Guide | None:
        return None

    @override
    def limits(self, effort: Scalar) -> Mapping[str, Scalar]:
        return {}


IDLE = Torque()
"""A motor that does nothing."""

MOTORS: Mapping[str, type[Motor]] = {motor.name: motor for motor in (Prescribed, Torque)}
"""The motors by the ``type`` they have in rig files."""
