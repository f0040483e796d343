"""The bench on which laws are tried: their sizes, and a contact on a prescribed path."""

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, TypeVar, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.characterization.presliding import presliding_length
from stickslip.drives import Drive, Sampled
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, bound
from stickslip.maths import Latches, Scalar
from stickslip.mechanisms import (
    Axis,
    Contact,
    Guide,
    Mechanism,
    SpringBlock,
    TowedBlock,
    given_inputs,
)
from stickslip.quantities import Parametrised, Quantity, fields_of

Array = NDArray[np.float64]
M = TypeVar("M", bound=Mechanism)

USUAL_SPEED = 1e-3
"""Speed that stands for the one at which friction changes where a law has none [m/s]."""
RIGID = 1e-5
"""Displacement that stands for the presliding length where a law has none [m]."""
STIFF, QUICK = 1e5, 1e-6
"""Stiffness of the load cell over that of the contact, and its time constant [s]."""
SOFT, SLUGGISH = 1e2, 1e-4
"""The same where the contact has no state that only the path may move."""
NEAR = 1e-9
"""Share of the presliding length at which states begin: some laws switch at exactly 0."""


@final
@dataclass(frozen=True, kw_only=True)
class Bench(Parametrised):
    """A law with the sizes that its tests take their settings from."""

    law: FrictionLaw
    """The law, as runs take it."""
    load: Annotated[float, Quantity("N", "N", above=0)] = 1.0
    """Normal force."""
    mass: Annotated[float, Quantity("m", "kg", above=0)] = 1.0
    """Mass of the body."""
    stiffness: Annotated[float, Quantity("k", "N/m", above=0)] = 100.0
    """Stiffness of the spring that pulls it, where it is pulled by one."""
    inputs: Mapping[str, float] = field(default_factory=dict)
    """Values of the inputs that the law depends on, by name [SI, temperature in degC]."""
    scales: tuple[float, float] | None = None
    """Force [N] and speed [m/s] that settings of tests count in, where they are those of another
    law; its own if not given."""

    @classmethod
    def of(
        cls,
        law: FrictionLaw,
        load: float,
        rig: Mechanism | None,
        inputs: Mapping[str, float] | None = None,
        scales: tuple[float, float] | None = None,
    ) -> "Bench":
        """Return the bench of a law, with mass and stiffness of a mechanism if there is one."""
        if rig is None:
            return cls(law=law, load=load, inputs=inputs or {}, scales=scales)
        if not isinstance(rig, Axis | SpringBlock | TowedBlock):
            raise InputError(
                "rig must be an Axis, SpringBlock or TowedBlock, whose mass and stiffness are"
                f" taken, got {type(rig).__name__}."
            )
        mass = rig.inertia if isinstance(rig, Axis) else rig.mass
        stiffness = rig.stiffness or 100.0 * mass
        return cls(
            law=law,
            load=load,
            mass=mass,
            stiffness=stiffness,
            inputs=inputs or {},
            scales=scales,
        )

    @functools.cached_property
    def curve(self) -> FrictionLaw:
        """The law bound to the values of its inputs, which can be asked for numbers."""
        return bound(self.law, self.inputs) if self.inputs else self.law

    @functools.cached_property
    def levels(self) -> tuple[float, float]:
        """The lowest and the highest level of forward motion [N]: of sliding, and of rest."""
        scales = {name: one.scale for name, one in fields_of(type(self.law)).items()}
        found = [
            float(value) * self.load
            for name, scale in scales.items()
            if scale in ("level", "level+") and (value := getattr(self.law, name)) is not None
        ]
        found = [one for one in found if one > 0.0]
        held = float(self.curve.towards(1).break_away(self.load))
        slow = abs(float(self.curve.steady(USUAL_SPEED, self.load)))
        found = found or ([held] if held > 0.0 else [slow])
        return min(found), max(*found, held)

    @property
    def force(self) -> float:
        """Force that settings of tests count in [N]: the highest level."""
        return self.levels[1] if self.scales is None else self.scales[0]

    @functools.cached_property
    def speed(self) -> float:
        """Speed at which friction changes [m/s]: the Stribeck velocity, or one like it."""
        if self.scales is not None:
            return self.scales[1]
        names = [name for name, one in fields_of(type(self.law)).items() if one.scale == "speed"]
        found = [float(getattr(self.law, name)) for name in names if getattr(self.law, name)]
        return min(found, default=USUAL_SPEED)

    @functools.cached_property
    def length(self) -> float:
        """Presliding length [m]; 0 where nothing deflects."""
        return presliding_length(self.curve, self.load) if self.law.states else 0.0

    @functools.cached_property
    def latched(self) -> bool:
        """Whether what the equations say depends on switches that a state does not tell."""
        flags = Latches()
        with flags:
            self.curve.rates(self.speed, self.load, tuple(0.0 for _ in self.law.states))
        return bool(flags)

    def on(self, mechanism: M) -> M:
        """Return a mechanism that tells the law the values of its inputs."""
        return given_inputs(mechanism, self.inputs) if self.inputs else mechanism

    @property
    def reach(self) -> float:
        """The presliding length, or what stands for it [m]."""
        return self.length or RIGID

    def guided(self, path: Drive, *, rate: float = 0.0) -> Mechanism:
        """Return the contact moved by a load cell whose deflection is far below the reach."""
        ratio, time = (STIFF, QUICK) if self.law.states else (SOFT, SLUGGISH)
        stiffness = ratio * self.levels[1] / self.reach
        contact = GuidedContact(
            mass=stiffness * time * time,
            stiffness=stiffness,
            damping=2.0 * stiffness * time,
            path=path,
            rate=rate,
            load=self.load,
        )
        return self.on(contact)

    @property
    def sticks(self) -> bool:
        """Whether some force leaves a body at rest."""
        return float(self.curve.break_away(self.load)) > 0.0

    @property
    def threshold(self) -> str:
        """What a force below the levels stays below, in words."""
        return "break-away" if self.sticks else "its level of sliding"

    def deflected(self, share: float = NEAR) -> dict[str, float]:
        """Return states of the law at a share of the presliding length."""
        return dict.fromkeys(self.law.states, share * self.reach)


@final
@dataclass(frozen=True, kw_only=True)
class GuidedContact(Mechanism):
    """A contact pushed along a prescribed path by a stiff load cell."""

    name: ClassVar[str] = "guided-contact"
    coordinates: ClassVar[tuple[str, ...]] = ("u", "x")
    rates: ClassVar[tuple[str, ...]] = ("w", "v")
    units: ClassVar[tuple[str, ...]] = ("m", "m")

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of the body."""
    stiffness: Annotated[float, Quantity("k", "N/m", above=0)]
    """Stiffness of the load cell."""
    damping: Annotated[float, Quantity("c", "N s/m", low=0)]
    """Damping of the load cell."""
    path: Drive
    """Acceleration of its far end [m/s^2]."""
    rate: Annotated[float, Quantity("w_0", "m/s")] = 0.0
    """Velocity at time 0."""
    load: Annotated[float, Quantity("N", "N", low=0)] = 1.0
    """Normal force."""

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        return 0.5 * self.mass * q_dot["x"] * q_dot["x"]

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        stretch = q["u"] - q["x"]
        return 0.5 * self.stiffness * stretch * stretch

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        force = self.damping * (q_dot["u"] - q_dot["x"])
        return {"x": force, "u": -force}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", load=self.load),)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {"path": self.path}

    @override
    def guided(self) -> Mapping[str, Guide]:
        return {"u": Guide(drive="path", effort="pull", unit="N")}

    @override
    def start(self) -> Mapping[str, Scalar]:
        return {"w": self.rate, "v": self.rate}


def there_and_back(
    places: Sequence[float], speed: float | Sequence[float], pauses: Sequence[float] = ()
) -> tuple[Drive, Array]:
    """Return the acceleration that goes from place to place, and the times of arrival (n,) [s]."""
    times, values, arrivals = [], [], []
    now, here = 0.0, 0.0
    for place, fastest, pause in zip(
        places,
        np.broadcast_to(speed, len(places)),
        pauses or [0.0] * len(places),
        strict=True,
    ):
        lasts = 2.0 * abs(place - here) / float(fastest)
        acceleration = 4.0 * (place - here) / (lasts * lasts)
        times += [now, now + 0.5 * lasts]
        values += [acceleration, -acceleration]
        now, here = now + lasts, place
        arrivals.append(now)
        if pause > 0.0:
            times.append(now)
            values.append(0.0)
            now += pause
    if times[-1] < now or not pauses:
        times.append(math.nextafter(now, math.inf))
        values.append(0.0)
    return Sampled(times=times, values=values), np.array(arrivals)
