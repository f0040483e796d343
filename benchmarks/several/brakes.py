"""Friction linings and what they press on each other: disc brakes, trains of clutches.

Mechanisms as users write them: benchmarks and tests of several contacts simulate them.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

from typing_extensions import override

from stickslip.errors import ParameterError
from stickslip.maths import Scalar
from stickslip.mechanisms.base import Contact, ContactInputs, Mechanism, gear_inputs
from stickslip.mechanisms.drives import Drive
from stickslip.mechanisms.robots import checked_parts
from stickslip.quantities import Parametrised, Quantity

# Friction linings: what brakes and clutches press on each other.


@dataclass(frozen=True, kw_only=True)
class Lining(Parametrised):
    """A friction lining: the pad of a brake, or the lining of a clutch.

    It rubs at a radius, so that its slip velocity is in m/s and its friction in N. A clutch with
    several faces has their number times the pressing force.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import Ramp
    >>> pad = Lining(radius=0.12, press=Ramp(rate=50.0))
    >>> pad.press.value(2.0)
    100.0
    """

    radius: Annotated[float, Quantity("r", "m", above=0)]
    """Effective radius."""
    load: Annotated[float, Quantity("N", "N", low=0)] = 0.0
    """Constant part of the pressing force."""
    press: Drive | None = None
    """Pressing force beside the load [N]; while both together are not above 0, nothing rubs."""

    def contact(self, coordinate: str, name: str) -> Contact:
        """Return the contact of a lining.

        Parameters
        ----------
        coordinate : str
            Angle that turns at the lining.
        name : str
            Name of the contact.

        Returns
        -------
        Contact
            Its slip velocity is the radius times the rate of the angle.
        """
        return Contact(slip={coordinate: self.radius}, load=self.load, name=name)


def pressing_drives(linings: Mapping[str, Lining]) -> dict[str, Drive]:
    """Return the drives that press linings, by the names of these."""
    return {name: lining.press for name, lining in linings.items() if lining.press is not None}


def pressing_forces(
    linings: Mapping[str, Lining], drives: Mapping[str, Scalar]
) -> dict[str, Scalar]:
    """Return the pressing forces [N] that change."""
    return {
        name: lining.load + drives[name]
        for name, lining in linings.items()
        if lining.press is not None
    }


# A disc and the pads that brake it.


@dataclass(frozen=True, kw_only=True)
class DiscBrake(Mechanism):
    """A disc that pads brake, each at its radius.

    The contacts are `pad-1`, `pad-2` and so on. While the pads hold the disc, they share the torque
    that this takes in proportion to the torques at which they would break away.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> from benchmarks.several.brakes import Lining
    >>> brake = DiscBrake(
    ...     inertia=0.5, pads=(Lining(radius=0.10, load=100.0), Lining(radius=0.12, load=80.0))
    ... )
    >>> run = simulate(brake, Coulomb(kinetic_coefficient=0.4), t_end=2.0, y0={"omega": 20.0})
    >>> round(float(run["phi"][-1]), 9)  # 0.5 J omega^2 over the torque
    12.755102041
    """

    name: ClassVar[str] = "disc-brake"
    coordinates: ClassVar[tuple[str, ...]] = ("phi",)
    rates: ClassVar[tuple[str, ...]] = ("omega",)
    units: ClassVar[tuple[str, ...]] = ("rad",)
    moving_part: ClassVar[str] = "disc"
    contact_names: ClassVar[str] = "pad-1, pad-2, ..."

    inertia: Annotated[float, Quantity("J", "kg m^2", above=0)]
    """Moment of inertia of the disc and what turns with it."""
    pads: tuple[Lining, ...]
    """The pads, one or more."""
    stiffness: Annotated[float, Quantity("k", "N m/rad", low=0)] = 0.0
    """Torsion spring towards phi = 0."""
    damping: Annotated[float, Quantity("c", "N m s/rad", low=0)] = 0.0
    """Damper beside it."""
    drive: Drive | None = None
    """Torque on the disc [N m]."""

    def __post_init__(self) -> None:
        """Check the parameters and the pads."""
        super().__post_init__()
        object.__setattr__(self, "pads", checked_parts("DiscBrake.pads", Lining, self.pads, 1))

    def _linings(self) -> dict[str, Lining]:
        """Return the pads by name."""
        return {f"pad-{i + 1}": pad for i, pad in enumerate(self.pads)}

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        return 0.5 * self.inertia * q_dot["phi"] * q_dot["phi"]

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        return 0.5 * self.stiffness * q["phi"] * q["phi"]

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return {"phi": drives.get("drive", 0.0) - self.damping * q_dot["phi"]}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return tuple(lining.contact("phi", name) for name, lining in self._linings().items())

    @override
    def loads(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return pressing_forces(self._linings(), drives)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        others = -self.stiffness * q["phi"] - self.damping * q_dot["phi"]
        return {  # forces at the radius of each pad, whose torques these are
            name: gear_inputs(
                drives.get("drive", 0.0) / pad.radius,
                others / pad.radius,
                position=pad.radius * q["phi"],
            )
            for name, pad in self._linings().items()
        }

    @override
    def drives(self) -> Mapping[str, Drive]:
        own = {} if self.drive is None else {"drive": self.drive}
        return {**own, **pressing_drives(self._linings())}


# Rotors in a row with a clutch between each two.


@dataclass(frozen=True, kw_only=True)
class Rotor(Parametrised):
    """A body that turns.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import Sine
    >>> Rotor(inertia=0.2, torque=Sine(amplitude=10.0, frequency=5.0)).inertia
    0.2
    """

    inertia: Annotated[float, Quantity("J", "kg m^2", above=0)]
    """Moment of inertia."""
    damping: Annotated[float, Quantity("c", "N m s/rad", low=0)] = 0.0
    """Damper to the housing."""
    torque: Drive | None = None
    """Torque on it [N m]."""


@dataclass(frozen=True, kw_only=True)
class ClutchTrain(Mechanism):
    """Rotors in a row with a clutch between each two, and perhaps a brake on the first.

    The angle `phi` is that of the first rotor, and `psi1`, `psi2` and so on are the angles by
    which each further rotor is ahead of the one before: the third stands at
    ``phi + psi1 + psi2``. The contacts are `clutch-1`, `clutch-2` and so on, and `brake`.

    Examples
    --------
    A motor at 100 rad/s takes a load along once the clutch is pressed; both then turn at
    ``100 * 0.2 / (0.2 + 0.3)``.

    >>> from stickslip import Coulomb, simulate
    >>> from stickslip.mechanisms.drives import Ramp
    >>> from benchmarks.several.brakes import Lining, Rotor
    >>> train = ClutchTrain(
    ...     rotors=(Rotor(inertia=0.2), Rotor(inertia=0.3)),
    ...     clutches=(Lining(radius=0.1, press=Ramp(rate=500.0)),),
    ... )
    >>> start = {"omega": 100.0, "psi1_dot": -100.0}
    >>> run = simulate(train, Coulomb(kinetic_coefficient=0.3), t_end=2.0, y0=start)
    >>> round(float(run["omega"][-1]), 9)
    40.0
    """

    name: ClassVar[str] = "clutch-train"
    moving_part: ClassVar[str] = "rotor"
    contact_names: ClassVar[str] = "clutch-1, clutch-2, ..., brake"

    rotors: tuple[Rotor, ...]
    """The rotors in their order, two or more."""
    clutches: tuple[Lining, ...]
    """The clutches between them, one fewer than rotors."""
    brake: Lining | None = None
    """Brake between the housing and the first rotor."""

    def __post_init__(self) -> None:
        """Check the parts and their number."""
        super().__post_init__()
        rotors = checked_parts("ClutchTrain.rotors", Rotor, self.rotors, 2)
        clutches = checked_parts("ClutchTrain.clutches", Lining, self.clutches, 1)
        object.__setattr__(self, "rotors", rotors)
        object.__setattr__(self, "clutches", clutches)
        if len(clutches) != len(rotors) - 1:
            raise ParameterError(
                f"ClutchTrain has {len(rotors)} rotors, which {len(rotors) - 1} clutches join; got"
                f" {len(clutches)} clutches."
            )
        if self.brake is not None:
            checked_parts("ClutchTrain.brake", Lining, self.brake, 1)

    @property
    @override
    def coordinates(self) -> tuple[str, ...]:  # type: ignore[override]  # of an instance
        """Angle of the first rotor, then of each one from the one before."""
        return ("phi", *(f"psi{i + 1}" for i in range(len(self.clutches))))

    @property
    @override
    def rates(self) -> tuple[str, ...]:  # type: ignore[override]
        """Angular velocities of the same."""
        return ("omega", *(f"psi{i + 1}_dot" for i in range(len(self.clutches))))

    @property
    @override
    def units(self) -> tuple[str, ...]:  # type: ignore[override]
        """SI units of the angles."""
        return ("rad",) * len(self.rotors)

    def _linings(self) -> dict[str, Lining]:
        """Return clutches and brake by name."""
        result = {f"clutch-{i + 1}": clutch for i, clutch in enumerate(self.clutches)}
        return result if self.brake is None else {**result, "brake": self.brake}

    def _turning(self) -> dict[str, tuple[str, Lining]]:
        """Return clutches and brake by name, with the angle along which each slips."""
        # Clutches slip along psi, the brake along phi, which stays over without one.
        linings, angles = self._linings(), (*self.coordinates[1:], "phi")
        return {name: (x, linings[name]) for name, x in zip(linings, angles, strict=False)}

    def _speeds(self, q_dot: Mapping[str, Scalar]) -> list[Scalar]:
        """Return the angular velocity of each rotor."""
        speed: Scalar = 0.0
        result = []
        for name in self.coordinates:
            speed = speed + q_dot[name]
            result.append(speed)
        return result

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        turning = zip(self.rotors, self._speeds(q_dot), strict=True)
        return sum((0.5 * rotor.inertia * speed * speed for rotor, speed in turning), 0.0)

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        return 0.0

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        # a torque on one rotor turns all relative angles up to it
        total: Scalar = 0.0
        result = {}
        parts = zip(self.coordinates, self.rotors, self._speeds(q_dot), strict=True)
        for i, (name, rotor, speed) in reversed(list(enumerate(parts))):
            total = total + drives.get(f"torque-{i + 1}", 0.0) - rotor.damping * speed
            result[name] = total
        return result

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return tuple(lining.contact(x, name) for name, (x, lining) in self._turning().items())

    @override
    def loads(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return pressing_forces(self._linings(), drives)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        # which part of the torques a clutch passes on is decided by its friction
        return {
            name: {"position": item.radius * q[x]} for name, (x, item) in self._turning().items()
        }

    @override
    def drives(self) -> Mapping[str, Drive]:
        torques = {f"torque-{i + 1}": rotor.torque for i, rotor in enumerate(self.rotors)}
        turning = {name: drive for name, drive in torques.items() if drive is not None}
        return {**turning, **pressing_drives(self._linings())}
