"""Blocks in a row on a belt, joined by springs."""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.errors import ParameterError
from stickslip.maths import Scalar
from stickslip.mechanisms.base import Contact, ContactInputs, Mechanism, gear_inputs
from stickslip.quantities import Quantity

MOST_BLOCKS = 1000
"""More blocks have equations that take minutes to be written and compiled."""


@final
@dataclass(frozen=True, kw_only=True)
class BlockChain(Mechanism):
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

    @override
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
    def contacts(self) -> tuple[Contact, ...]:
        return tuple(
            Contact(slip=x, load=self.load, name=f"block-{i + 1}")
            for i, x in enumerate(self.coordinates)
        )

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
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
            f"block-{i}": gear_inputs(0.0, pull, position=q[x])
            for i, (x, pull) in enumerate(named, 1)
        }

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {}
