"""Blocks on rough ground: shot, pushed or pulled by a spring, on two feet, in a row on a belt."""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

from typing_extensions import override

from stickslip.errors import ParameterError
from stickslip.maths import Scalar, sin, where
from stickslip.mechanisms import base
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import Quantity
from stickslip.show.formatting import number

# A block on rough ground, shot off by a spring or pushed by a force.


@dataclass(frozen=True, kw_only=True)
class SpringBlock(base.BoundedMechanism):
    """A block that a compressed spring, a force, or both set in motion.

    The state `x` is the travel from the start, where the block is at rest. The spring pushes with
    ``stiffness * (compression - x)``; unless it is attached it only pushes, and the block leaves it
    at its natural length. A negative compression is a spring on the other side; a spring that is
    neither compressed nor attached is not touched.

    On an incline the block is pressed on the ground by ``mass * gravity * cos(incline)`` and pulled
    towards negative x by ``mass * gravity * sin(incline)``: positive x is uphill.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> round(float(run["x"][-1]), 7)
    0.2038736
    """

    name: ClassVar[str] = "spring-block"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)
    moving_part: ClassVar[str] = "block"

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of the block."""
    stiffness: Annotated[float, Quantity("k", "N/m", low=0)] = 0.0
    """Stiffness of the spring."""
    compression: Annotated[float, Quantity("x_0", "m")] = 0.0
    """How far the spring is compressed at the start."""
    attached: bool = False
    """Whether the block stays fastened to the spring and is pulled back by it."""
    drive: Drive | None = None
    """Force on the block [N]."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""
    incline: base.Incline = 0.0
    """Angle of the ground from the horizontal; where it is positive, positive x is uphill."""
    lower_stop: Annotated[float, Quantity("x_l", "m")] | None = None
    """Hard stop that x does not fall below; none if not given."""
    upper_stop: Annotated[float, Quantity("x_u", "m")] | None = None
    """Hard stop that x does not rise above; none if not given."""
    restitution: Annotated[float, Quantity("e", low=0, high=1)] = 0.0
    """Speed after an impact at a stop over the speed before; 0 if nothing bounces."""

    def __post_init__(self) -> None:
        """Check the parameters, and that a compressed spring is there."""
        super().__post_init__()
        if self.compression != 0 and self.stiffness == 0:
            raise ParameterError(
                f"SpringBlock.compression (x_0) is {number(self.compression, 6)} m but stiffness"
                " (k) is 0: there is no spring to compress. Give a stiffness above 0 N/m, or no"
                " compression."
            )
        if self.attached and self.stiffness == 0:
            raise ParameterError(
                "SpringBlock.attached is true but stiffness (k) is 0: there is no spring to attach"
                " to. Give a stiffness above 0 N/m, or attached=False."
            )

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        m = self.mass
        return 0.5 * m * (q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"])

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        m, g, k, gap = self.mass, self.gravity, self.stiffness, self.compression - q["x"]
        spring = self._touching(gap, 0.5 * k * gap * gap)
        return m * g * base.height(self.incline, q["x"], q["y"]) + spring

    def _touching(self, gap: Scalar, of_spring: Scalar) -> Scalar:
        """Return what the spring does: nothing where the block has left it."""
        if self.attached:
            return of_spring
        # On the side on which the spring is, whichever that is.
        pushes = gap * self.compression > 0.0
        return where(pushes, of_spring, 0.0, ("spring touches", "block leaves the spring"))

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return {"x": drives.get("drive", 0.0)}

    @override
    def contacts(self) -> tuple[base.Contact, ...]:
        return (base.Contact(slip="x", normal="y"),)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> base.ContactInputs:
        gap = self.compression - q["x"]
        weight = -self.mass * self.gravity * sin(self.incline)
        return base.gear_inputs(
            drives.get("drive", 0.0),
            self._touching(gap, self.stiffness * gap) + weight,
            gravity=weight,
            position=q["x"],
        )

    @override
    def stops(self) -> tuple[base.Stop, ...]:
        return base.stops_between("x", self.lower_stop, self.upper_stop, self.restitution)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.drive is None else {"drive": self.drive}


# A block pulled over rough ground through a spring; the same as a mass on a belt.


@dataclass(frozen=True, kw_only=True)
class TowedBlock(base.Mechanism):
    """A block on rough ground, pulled by a spring and a damper whose far end moves steadily.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    >>> run = simulate(block, Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5), t_end=20.0)
    >>> starts = [event.t for event in run.events if event.reason == "break-away"]
    >>> round(starts[1] - starts[0], 5)
    7.61126
    """

    name: ClassVar[str] = "towed-block"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)
    moving_part: ClassVar[str] = "block"

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of the block."""
    stiffness: Annotated[float, Quantity("k", "N/m", above=0)]
    """Stiffness of the spring."""
    speed: Annotated[float, Quantity("V", "m/s")]
    """Speed of the far end of the spring."""
    damping: Annotated[float, Quantity("c", "N s/m", low=0)] = 0.0
    """Damper beside the spring."""
    load: Annotated[float, Quantity("N", "N", low=0)] | None = None
    """Normal force; the weight if not given."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""
    modulation: Drive | None = None
    """Force that presses the block beside the load [N]; where it lifts it off, a run ends."""

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        upward = q_dot.get("y", 0.0)
        return 0.5 * self.mass * (q_dot["x"] * q_dot["x"] + upward * upward)

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        stretch = self.speed * t - q["x"]
        return 0.5 * self.stiffness * stretch * stretch

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        result = {"x": self.damping * (self.speed - q_dot["x"])}
        if self.modulation is not None:
            result["y"] = -(self.steady_load + drives["modulation"])
        return result

    @override
    def contacts(self) -> tuple[base.Contact, ...]:
        if self.modulation is not None:
            return (base.Contact(slip="x", normal="y"),)
        return (base.Contact(slip="x", load=self.steady_load),)

    @property
    def steady_load(self) -> float:
        """Normal force without its modulation [N]."""
        return self.mass * self.gravity if self.load is None else self.load

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> base.ContactInputs:
        pull = self.stiffness * (self.speed * t - q["x"])
        pull = pull + self.damping * (self.speed - q_dot["x"])
        return base.gear_inputs(pull, 0.0, position=q["x"])

    @override
    def carried(self) -> Mapping[str, Scalar]:
        return {"x": self.speed}

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.modulation is None else {"modulation": self.modulation}


# A body that slides on two feet.


@dataclass(frozen=True, kw_only=True)
class TwoFeet(base.Mechanism):
    """A body that slides on a front and a rear foot.

    Its height `y` and its tilt `phi` are held at 0, and what each foot carries follows from both:
    friction acts below the centre of mass, so that the front foot is pressed down while the body
    slides forward. A run ends where a foot lifts off. The spring and the drive act at the height
    of the centre of mass. The contacts are `front` and `rear`.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> body = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15)
    >>> laws = {
    ...     "front": Coulomb(kinetic_coefficient=0.6),
    ...     "rear": Coulomb(kinetic_coefficient=0.2),
    ... }
    >>> run = simulate(body, laws, t_end=1.0, y0={"v": 1.0})
    >>> run.at(0.1)["normal_force:front"].round(3), run.at(0.1)["normal_force:rear"].round(3)
    (array([10.256]), array([9.364]))
    """

    name: ClassVar[str] = "two-feet"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)
    moving_part: ClassVar[str] = "body"
    contact_names: ClassVar[str] = "front, rear"

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of the body."""
    front: Annotated[float, Quantity("a", "m", above=0)]
    """Distance of the front foot ahead of the centre of mass."""
    rear: Annotated[float, Quantity("b", "m", above=0)]
    """Distance of the rear foot behind it."""
    height: Annotated[float, Quantity("h", "m", low=0)] = 0.0
    """Height of the centre of mass above the ground."""
    stiffness: Annotated[float, Quantity("k", "N/m", low=0)] = 0.0
    """Spring towards x = 0."""
    damping: Annotated[float, Quantity("c", "N s/m", low=0)] = 0.0
    """Damper beside it."""
    drive: Drive | None = None
    """Force along the ground [N]."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        return 0.5 * self.mass * (q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"])

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        return self.mass * self.gravity * q["y"] + 0.5 * self.stiffness * q["x"] * q["x"]

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return {"x": drives.get("drive", 0.0) - self.damping * q_dot["x"]}

    @override
    def contacts(self) -> tuple[base.Contact, ...]:
        # Friction acts below the centre of mass, and so turns the body.
        slip = {"x": 1.0, "phi": self.height}
        return (
            base.Contact(slip=slip, normal={"y": 1.0, "phi": self.front}, name="front"),
            base.Contact(slip=slip, normal={"y": 1.0, "phi": -1.0 * self.rear}, name="rear"),
        )

    @override
    def held(self) -> tuple[str, ...]:
        return ("y", "phi")

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> base.ContactInputs:
        others = -self.stiffness * q["x"] - self.damping * q_dot["x"]
        both = base.gear_inputs(drives.get("drive", 0.0), others, position=q["x"])
        return {"front": both, "rear": both}

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.drive is None else {"drive": self.drive}


# Blocks in a row on a belt, joined by springs.

MOST_BLOCKS = 1000
"""More blocks have equations that take minutes to be written and compiled."""


@dataclass(frozen=True, kw_only=True)
class BlockChain(base.Mechanism):
    """Blocks in a row on a belt or on the ground, joined by springs.

    The places `x1`, `x2` and so on are counted from where the blocks stand while no spring is
    stretched, and along with the belt: `x1` stays what it is while the first block rides on the
    belt. A further spring and a damper hold each block against the ground. The contacts are
    `block-1`, `block-2` and so on. On a moving belt this is the model of earthquakes of Burridge
    and Knopoff.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> chain = BlockChain(blocks=3, mass=1.0, coupling=4.0, stiffness=1.0, speed=0.1)
    >>> law = Coulomb(kinetic_coefficient=0.7, static_coefficient=1.0)
    >>> run = simulate(chain, law, t_end=20.0)
    >>> [(event.contact, round(event.t, 6)) for event in run.events][:2]
    [('block-1', 10.0), ('block-2', 10.0)]
    """

    name: ClassVar[str] = "block-chain"
    moving_part: ClassVar[str] = "block"
    contact_names: ClassVar[str] = "block-1, block-2, ..."

    blocks: Annotated[int, Quantity("n", low=1, high=MOST_BLOCKS, structural=True)]
    """Number of blocks."""
    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of each block."""
    coupling: Annotated[float, Quantity("k_c", "N/m", low=0)]
    """Stiffness of the springs between neighbours."""
    stiffness: Annotated[float, Quantity("k", "N/m", low=0)] = 0.0
    """Stiffness of the springs between each block and the ground."""
    damping: Annotated[float, Quantity("c", "N s/m", low=0)] = 0.0
    """Dampers beside the springs to the ground."""
    speed: Annotated[float, Quantity("V", "m/s")] | None = None
    """Speed of the belt; with None the blocks are on the ground, where they may rest for good."""
    load: Annotated[float, Quantity("N", "N", low=0)] = 1.0
    """Normal force of each block, or 1 where levels are forces."""

    def __post_init__(self) -> None:
        """Check the parameters, and that the number of blocks is whole."""
        super().__post_init__()
        if self.blocks != int(self.blocks):
            raise ParameterError(
                f"BlockChain.blocks (n) must be a whole number of 1 to {MOST_BLOCKS}, got"
                f" {self.blocks:g}."
            )
        object.__setattr__(self, "blocks", int(self.blocks))

    @property
    @override
    def coordinates(self) -> tuple[str, ...]:  # type: ignore[override]  # of an instance
        """Places of the blocks along the belt."""
        return tuple(f"x{i + 1}" for i in range(self.blocks))

    @property
    @override
    def rates(self) -> tuple[str, ...]:  # type: ignore[override]
        """Speeds of the blocks on the belt."""
        return tuple(f"v{i + 1}" for i in range(self.blocks))

    @property
    @override
    def units(self) -> tuple[str, ...]:  # type: ignore[override]
        """SI units of the places."""
        return ("m",) * self.blocks

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        return sum((0.5 * self.mass * q_dot[x] * q_dot[x] for x in self.coordinates), 0.0)

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        places = [q[x] for x in self.coordinates]
        # Places count along with the belt: springs to the ground also see how far that has moved.
        moved = 0.0 if self.speed is None else self.speed * t
        stretched = [place + moved for place in places]
        apart = [after - before for before, after in itertools.pairwise(places)]
        ground = sum((0.5 * self.stiffness * s * s for s in stretched), 0.0)
        return ground + sum((0.5 * self.coupling * s * s for s in apart), 0.0)

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        belt = 0.0 if self.speed is None else self.speed
        return {x: -self.damping * (q_dot[x] + belt) for x in self.coordinates}

    @override
    def contacts(self) -> tuple[base.Contact, ...]:
        return tuple(
            base.Contact(slip=x, load=self.load, name=f"block-{i + 1}")
            for i, x in enumerate(self.coordinates)
        )

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> base.ContactInputs:
        belt = 0.0 if self.speed is None else self.speed
        pulls = [
            -self.stiffness * (q[x] + belt * t) - self.damping * (q_dot[x] + belt)
            for x in self.coordinates
        ]
        for i, (before, after) in enumerate(itertools.pairwise(self.coordinates)):
            pull = self.coupling * (q[after] - q[before])
            pulls[i], pulls[i + 1] = pulls[i] + pull, pulls[i + 1] - pull
        named = zip(self.coordinates, pulls, strict=True)
        return {
            f"block-{i}": base.gear_inputs(0.0, pull, position=q[x])
            for i, (x, pull) in enumerate(named, 1)
        }

    @override
    def carried(self) -> Mapping[str, Scalar]:
        return {} if self.speed is None else dict.fromkeys(self.coordinates, -self.speed)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {}
