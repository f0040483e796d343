"""The bench on which laws are tried: their sizes, a contact on a prescribed path, results.

Settings of tests count in sizes of the law itself: break-away, the speed at which friction changes,
and the presliding length, the displacement at which a contact that deflects reaches break-away.
"""

import dataclasses
import functools
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeAlias, TypeVar, final

import numpy as np
from numpy.typing import NDArray

from stickslip import mechanisms
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, bound
from stickslip.maths import Latches, Scalar
from stickslip.mechanisms.drives import Drive, Sampled
from stickslip.quantities import Parametrised, Quantity, fields_of
from stickslip.show.display import OnAxes, Summary, Tabular
from stickslip.show.documents import json_value
from stickslip.study.tolerances import ROUNDING

if TYPE_CHECKING:
    import pandas as pd


# What the results of all tests have in common.


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Characteristic(OnAxes, Tabular, ABC):
    """What one test of the battery says of a law."""

    test: ClassVar[str]
    """Name of the test."""
    title: ClassVar[str]
    """What it shows, as a heading."""
    columns: ClassVar[Mapping[str, str]]
    """Fields that are columns of its table, with their SI units."""
    over: ClassVar[str] = ""
    """The column along which the rows stand; empty if they are numbered only."""

    conditions: str
    """Under which conditions, in words."""

    @property
    @abstractmethod
    def sentence(self) -> str:
        """What it says, in one sentence that a user can act on."""

    @final
    def to_dict(self) -> dict[str, Any]:
        """Return sentence, conditions and numbers, as in JSON."""
        names = [part.name for part in dataclasses.fields(self)]
        found: dict[str, Any] = json_value({name: getattr(self, name) for name in names})
        return {"sentence": self.sentence, **found}

    @final
    def to_dataframe(self) -> "pd.DataFrame":
        """Return the columns as a pandas DataFrame."""
        import pandas as pd

        return pd.DataFrame(self._values())

    def _values(self) -> Mapping[str, NDArray[Any]]:
        """Return the columns (n,) by name."""
        return {name: getattr(self, name) for name in self.columns}

    def _over(self) -> str:
        return self.over

    def _column_units(self) -> Mapping[str, str]:
        return self.columns

    def _summary(self) -> Summary:
        return Summary(sentence=self.sentence, notes=[self.conditions])


# Presliding: friction against displacement where the contact deflects but hardly slips.

Array: TypeAlias = NDArray[np.float64]

LOOP_SPEED = 1e-6
"""Imposed speed [m/s]: far below any Stribeck velocity, so that only the path matters."""
LOOP_POINTS = 200
"""Points of each straight piece of the path."""
ACCURATE = 1e-11
"""Error of a step of deflections, over their own size and over the presliding length."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class PreslidingLoop(OnAxes, Tabular):
    """Friction along an imposed displacement that swings ever wider."""

    displacement: Array
    """Imposed displacement (n,) [m]."""
    friction: Array
    """Friction force (n,) [N]."""

    def to_dataframe(self) -> "pd.DataFrame":
        """Return displacement and friction as a pandas DataFrame."""
        import pandas as pd

        return pd.DataFrame({"displacement": self.displacement, "friction": self.friction})

    def _column_units(self) -> Mapping[str, str]:
        return {"displacement": "m", "friction": "N"}

    def _summary(self) -> Summary:
        rows = (
            ("largest displacement", f"{np.abs(self.displacement).max():.4g} m"),
            ("largest friction", f"{np.abs(self.friction).max():.4g} N"),
        )
        return Summary(sentence=f"Presliding loop of {len(self.friction)} points.", rows=rows)


def presliding_length(law: FrictionLaw, load: float = 1.0) -> float:
    """Return the displacement [m] at which the first stiffness would reach break-away.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> presliding_length(Dahl(kinetic_coefficient=0.25, bristle_stiffness=1000.0))
    0.00025
    """
    rest = tuple(0.0 for _ in law.states)
    with Latches(off=True):  # where nothing has slipped yet
        rates = law.rates(LOOP_SPEED, load, rest)
        moved = tuple(float(rate) / LOOP_SPEED for rate in rates)  # deflection per displacement
        # The laws are affine in their deflection at a given speed, so any step gives the slope.
        stiffness = float(law.force(0.0, load, moved)) - float(law.force(0.0, load, rest))
    return float(law.break_away(load)) / stiffness


def presliding_loop(
    law: FrictionLaw, amplitude: float, load: float = 1.0, *, swings: int = 3
) -> PreslidingLoop:
    """Move a contact slowly to and fro, each time farther, and record its friction.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=0.25, bristle_stiffness=1000.0)
    >>> loop = presliding_loop(law, 0.001, load=10.0)
    >>> bool(abs(loop.friction).max() < 2.5)
    True
    """
    if not amplitude > 0 or swings < 1:
        raise InputError(
            "a presliding loop needs an amplitude above 0 m and at least one swing,"
            f" got {amplitude:g} m and {swings}."
        )
    ends = [sign * amplitude * (n + 1) / swings for n in range(swings) for sign in (1.0, -1.0)]
    x, friction = [np.zeros(1)], [np.zeros(1)]
    z, latches = np.zeros(len(law.states)), Latches(off=True)
    # The last piece goes back to where the widest swing began, which closes its loop.
    for start, end in zip([0.0, *ends], [*ends, amplitude], strict=True):
        x.append(np.linspace(start, end, LOOP_POINTS + 1)[1:])
        v = LOOP_SPEED if end > start else -LOOP_SPEED
        states = _moved(law, v, z, load, np.abs(x[-1] - start) / LOOP_SPEED, latches)
        friction.append(
            np.array([law.force(v, load, tuple(map(float, state))) for state in states])
        )
        z = states[-1]
    return PreslidingLoop(displacement=np.concatenate(x), friction=np.concatenate(friction))


def _moved(
    law: FrictionLaw, v: float, z: Array, load: float, times: Array, latches: Latches
) -> Array:
    """Return the states (n, states) at increasing times of a motion at a constant slip velocity."""
    found = []
    for time in times:
        # Flags of latches stay as they were at the beginning of the piece.
        with latches:
            found.append(law.moved(v, load, tuple(map(float, z)), float(time)))
    latches.turn()
    if found[0] is not None:
        return np.array(found, dtype=np.float64)

    def rates(_time: float, state: Array) -> Array:
        return np.asarray(law.rates(v, load, tuple(map(float, state))), dtype=np.float64)

    from scipy.integrate import solve_ivp

    # Absolute errors count where deflections go through 0.
    nothing = ACCURATE * presliding_length(law, load)
    span = (0.0, times[-1])
    run = solve_ivp(rates, span, z, "DOP853", times, rtol=ACCURATE, atol=nothing)
    return np.asarray(run.y.T)


# The bench on which laws are tried: their sizes, and a contact on a prescribed path.

M = TypeVar("M", bound=mechanisms.Mechanism)

USUAL_SPEED = 1e-3
"""Speed that stands for the one at which friction changes where a law has none [m/s]."""
RIGID = 1e-5
"""Displacement that stands for the presliding length where a law has none [m]."""
STIFF, QUICK = 1e5, 1e-6
"""Stiffness of the load cell over that of the contact, and its time constant [s]."""
SOFT, SLUGGISH = 1e2, 1e-4
"""The same where the contact has no state that only the path may move."""


@dataclass(frozen=True, kw_only=True)
class Bench(Parametrised):
    """A law with the sizes that its tests take their settings from."""

    law: FrictionLaw
    """The law, as runs take it."""
    load: Annotated[float, Quantity("N", "N", above=0)] = 1.0
    """Normal force."""
    mass: Annotated[float, Quantity("m", "kg", above=0)] = 1.0
    """Mass of the body."""
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
        rig: mechanisms.Mechanism | None,
        inputs: Mapping[str, float] | None = None,
        scales: tuple[float, float] | None = None,
    ) -> "Bench":
        """Return the bench of a law, with the mass of a mechanism if there is one."""
        if rig is None:
            return cls(law=law, load=load, inputs=inputs or {}, scales=scales)
        if not isinstance(rig, mechanisms.Axis | mechanisms.SpringBlock | mechanisms.TowedBlock):
            raise InputError(
                "rig must be an Axis, SpringBlock or TowedBlock, whose mass is taken, got"
                f" {type(rig).__name__}."
            )
        mass = rig.inertia if isinstance(rig, mechanisms.Axis) else rig.mass
        return cls(law=law, load=load, mass=mass, inputs=inputs or {}, scales=scales)

    @functools.cached_property
    def curve(self) -> FrictionLaw:
        """The law bound to the values of its inputs, which can be asked for numbers."""
        return bound(self.law, self.inputs) if self.inputs else self.law

    @functools.cached_property
    def levels(self) -> tuple[float, float]:
        """The lowest and the highest level of forward motion [N]: of sliding, and of rest."""
        scales = {name: quantity.scale for name, quantity in fields_of(type(self.law)).items()}
        found = [
            float(value) * self.load
            for name, scale in scales.items()
            if scale in ("level", "level+") and (value := getattr(self.law, name)) is not None
        ]
        found = [value for value in found if value > 0.0]
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
        names = [
            name
            for name, quantity in fields_of(type(self.law)).items()
            if quantity.scale == "speed"
        ]
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
        return mechanisms.given_inputs(mechanism, self.inputs) if self.inputs else mechanism

    @property
    def reach(self) -> float:
        """The presliding length, or what stands for it [m]."""
        return self.length or RIGID

    def guided(self, path: Drive) -> mechanisms.Mechanism:
        """Return the contact moved by a load cell whose deflection is far below the reach."""
        ratio, time = (STIFF, QUICK) if self.law.states else (SOFT, SLUGGISH)
        stiffness = ratio * self.levels[1] / self.reach
        contact = GuidedContact(
            # m = k T^2 and c = 2 k T: critically damped, with that time constant.
            mass=stiffness * time * time,
            stiffness=stiffness,
            damping=2.0 * stiffness * time,
            path=path,
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

    def deflected(self) -> dict[str, float]:
        """Return states of the law at a small share of the presliding length."""
        return dict.fromkeys(self.law.states, ROUNDING * self.reach)


@dataclass(frozen=True, kw_only=True)
class GuidedContact(mechanisms.Mechanism):
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
    load: Annotated[float, Quantity("N", "N", low=0)] = 1.0
    """Normal force."""

    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        return 0.5 * self.mass * q_dot["x"] * q_dot["x"]

    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        # The far end stands for the path, whose reaction is the measured force.
        stretch = q["u"] - q["x"]
        return 0.5 * self.stiffness * stretch * stretch

    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        force = self.damping * (q_dot["u"] - q_dot["x"])
        return {"x": force, "u": -force}

    def contacts(self) -> tuple[mechanisms.Contact, ...]:
        return (mechanisms.Contact(slip="x", load=self.load),)

    def drives(self) -> Mapping[str, Drive]:
        return {"path": self.path}

    def guided(self) -> Mapping[str, mechanisms.Guide]:
        return {"u": mechanisms.Guide(drive="path", effort="pull", unit="N")}


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
        # Half the time speeding up, half slowing down: the peak speed is twice the mean one.
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
    # After the last arrival it rests, from the next number on.
    if times[-1] < now or not pauses:
        times.append(math.nextafter(now, math.inf))
        values.append(0.0)
    return Sampled(times=times, values=values), np.array(arrivals)
