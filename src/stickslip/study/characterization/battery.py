"""The battery: all tests of a law, and of several side by side."""

import dataclasses
import functools
import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    ClassVar,
    Final,
    Literal,
    TypeAlias,
    TypeVar,
    final,
)

import numpy as np
from numpy.typing import NDArray

from stickslip import mechanisms
from stickslip.engine.simulation import simulate
from stickslip.engine.solver import EventDriven
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, SimulationError
from stickslip.friction import FrictionLaw, bound, law_type, with_typical_values
from stickslip.identify.fits import starting_law
from stickslip.maths import Latches, Scalar
from stickslip.mechanisms import Axis, Mechanism
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.mechanisms.drives import Drive, Pulse, Ramp, Sampled, Sine
from stickslip.quantities import Parametrised, Quantity, fields_of, named
from stickslip.show.display import InPanels, OnAxes, Summary, Tabular
from stickslip.show.documents import json_value
from stickslip.show.formatting import capital, joined, lower_first, number, quantity, unit_text
from stickslip.study.tolerances import ALIKE, FINE, MOST_STEPS, PERCENT, ROUNDING, TRANSIENT

if TYPE_CHECKING:
    import pandas as pd


# The bench on which laws are tried: their sizes, a contact on a prescribed path, results.
#
# Settings of tests count in sizes of the law itself: break-away, the speed at which friction
# changes, and the presliding length, the displacement at which a contact that deflects reaches
# break-away.

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
        result: dict[str, Any] = json_value({name: getattr(self, name) for name in names})
        return {"sentence": self.sentence, **result}

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

USUAL_SPEED = 1e-3
"""Speed that stands for the one at which friction changes where a law has none [m/s]."""
SLOW = 1e-4
"""Speed on a path over the one at which friction changes, so that the path alone matters."""
LOOP_SPEED = ALIKE * USUAL_SPEED
"""Imposed speed of a loop [m/s]: far below any Stribeck velocity."""
POINTS = 200
"""Points of each way of a path, and of each side of a curve."""
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
        x.append(np.linspace(start, end, POINTS + 1)[1:])
        v = LOOP_SPEED if end > start else -LOOP_SPEED
        states = moved_at(law, v, z, load, np.abs(x[-1] - start) / LOOP_SPEED, latches)
        friction.append(
            np.array([law.force(v, load, tuple(map(float, state))) for state in states])
        )
        z = states[-1]
    return PreslidingLoop(displacement=np.concatenate(x), friction=np.concatenate(friction))


def moved_at(
    law: FrictionLaw, v: float, z: Array, load: float, times: Array, latches: Latches
) -> Array:
    """Return the states (n, states) at increasing times of a motion at a constant slip velocity."""
    result = []
    for time in times:
        # Flags of latches stay as they were at the beginning of the piece.
        with latches:
            result.append(law.moved(v, load, tuple(map(float, z)), float(time)))
    latches.turn()
    if result[0] is not None:
        return np.array(result, dtype=np.float64)

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

RIGID = 1e-5
"""Displacement that stands for the presliding length where a law has none [m]."""
STIFF_CELL, SOFT_CELL = (1e5, 1e-6), (1e2, 1e-4)
"""Stiffness of the load cell over that of the contact, and its time constant [s]; the second where
the contact has no state that only the path may move."""


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
        result = [
            float(value) * self.load
            for name, scale in scales.items()
            if scale in ("level", "level+") and (value := getattr(self.law, name)) is not None
        ]
        result = [value for value in result if value > 0.0]
        held = float(self.curve.towards(1).break_away(self.load))
        slow = abs(float(self.curve.steady(USUAL_SPEED, self.load)))
        result = result or ([held] if held > 0.0 else [slow])
        return min(result), max(*result, held)

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
        result = [float(getattr(self.law, name)) for name in names if getattr(self.law, name)]
        return min(result, default=USUAL_SPEED)

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
        ratio, time = STIFF_CELL if self.law.states else SOFT_CELL
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


# The battery: all tests of a law, and of several side by side.

# Tests before sliding: break-away by rate and dwell, drift, small loops.

# The force at which a body breaks away: against how fast it grows, and how long it rested.

RATES = (2.0 / 3.0, 4.0 / 3.0, 20.0 / 3.0, 20.0)
"""Rates of force over break-away [1/s]."""
DWELLS = (0.1, 1.0, 10.0, 100.0)
"""Times at rest [s]."""
LATE_FALL = 0.005
"""Share of the largest force by which it has to fall after a peak."""
GONE = 20.0
"""Presliding lengths that a body slides before it rests, and after."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class BreakAway(Characteristic):
    """Peaks of friction as a body breaks away."""

    test: ClassVar[str] = "break-away"
    title: ClassVar[str] = "Break-away"
    columns: ClassVar[Mapping[str, str]] = {"rate": "N/s", "dwell": "s", "force": "N"}

    rate: Array
    """Rates at which the force grows (n,) [N/s]."""
    force: Array
    """Peak of friction at each rate (n,) [N]; NaN where friction has none."""
    dwell: Array
    """Times at rest (m,) [s]."""
    force_after: Array
    """Peak of friction after each (m,) [N]; NaN where friction has none, or switches without end at
    rest."""

    @property
    def sentence(self) -> str:
        if np.isnan(self.force).all():
            return (
                "Friction has no peak at break-away: the body creeps or deflects into sliding, and"
                " no threshold is met."
            )
        peaked = ~np.isnan(self.force)
        seen = self.force[peaked]
        if np.ptp(seen) > PERCENT * seen.max():
            slow, fast = (quantity(self.rate[peaked][i], "N/s") for i in (0, -1))
            verb = "falls" if seen[-1] < seen[0] else "rises"
            by_rate = (
                f"Break-away {verb} from {quantity(seen[0], 'N', 4)} at {slow} to"
                f" {quantity(seen[-1], 'N', 4)} at {fast}: a static level measured by hand does"
                " not hold for fast starts."
            )
        else:
            by_rate = (
                f"Break-away takes {quantity(seen.max(), 'N', 4)} however fast the force grows."
            )
        after = self.force_after[~np.isnan(self.force_after)]
        if len(after) > 1 and np.ptp(after) > PERCENT * after.max():
            return (
                f"{by_rate} It goes from {quantity(after[0], 'N')} after"
                f" {quantity(self.dwell[0], 's')} at rest to {quantity(after[-1], 'N')} after"
                f" {quantity(self.dwell[-1], 's')}."
            )
        return f"{by_rate} The time at rest does not matter." if len(after) else by_rate

    def _values(self) -> Mapping[str, Array]:
        """Return a row for each rate, then for each time at rest."""
        return {
            "rate": np.append(self.rate, np.full(len(self.dwell), np.nan)),
            "force": np.append(self.force, self.force_after),
            "dwell": np.append(np.full(len(self.rate), np.nan), self.dwell),
        }


def break_away(
    bench: Bench, *, rates: Sequence[float] | None = None, dwells: Sequence[float] = DWELLS
) -> BreakAway:
    """Pull a body with forces that grow at several rates, and after several times at rest.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> [round(float(one), 6) for one in break_away(Bench(law=law), rates=(1.0, 30.0)).force]
    [1.5, 1.5]
    """
    top = bench.force
    rates = [top * rate for rate in RATES] if rates is None else rates
    return BreakAway(
        rate=np.array(rates, dtype=np.float64),
        force=np.array([_pulled(bench, rate) for rate in rates]),
        dwell=np.array(dwells, dtype=np.float64),
        force_after=np.array([_rested(bench, dwell) for dwell in dwells]),
        conditions=(
            f"{quantity(bench.mass, 'kg')} pulled by a growing force; normal force"
            f" {quantity(bench.load, 'N')}. After rest: moved at up to"
            f" {quantity(0.1 * bench.speed, 'm/s')}."
        ),
    )


def _pulled(bench: Bench, rate: float) -> float:
    """Return the first peak of friction under a force that grows."""
    if not bench.sticks:
        return float("nan")
    axis = Axis(inertia=bench.mass, drive=Ramp(rate=rate), load=bench.load)
    run = simulate(bench.on(axis), bench.law, t_end=2.0 * bench.levels[1] / rate)
    for event in run.events:
        if event.reason == "break-away":
            return float(rate * event.t)
    return _first_peak(run, run.t)


def _rested(bench: Bench, dwell: float) -> float:
    """Return the peak of friction as a body goes on that was stopped."""
    if not bench.sticks:
        return float("nan")
    way = GONE * bench.reach
    speeds = (10.0 * bench.speed, 0.1 * bench.speed)
    path, arrivals = there_and_back([way, 2.0 * way], speeds, [dwell, 0.0])
    try:
        run = simulate(
            bench.guided(path),
            bench.law,
            t_end=arrivals[-1],
            y0=bench.deflected(),
            solver=EventDriven(max_steps=MOST_STEPS),
        )
    except SimulationError:
        return float("nan")
    again = arrivals[0] + dwell
    for event in run.events:
        if event.reason == "break-away" and event.t >= again:
            return float(run.at([event.t])["pull"][0])
    last = again + 0.5 * (arrivals[-1] - again)  # as far as the body is not slowed down
    times = np.union1d(np.linspace(again, last, FINE), run.t[(run.t > again) & (run.t < last)])
    return _first_peak(run, times[times <= run.span[1]])


def _first_peak(run: Trajectory, times: Array) -> float:
    """Return the first peak of friction at some times and between them; NaN if there is none."""
    force = run.at(times)["friction"]
    least = 1e-9 * np.abs(force).max()
    inner = (force[1:-1] > force[:-2] + least) & (force[1:-1] >= force[2:])
    # A peak counts only where friction falls below it later, by more than ripples do.
    lowest_later = np.minimum.accumulate(force[::-1])[::-1][2:]
    falls = lowest_later < force[1:-1] - LATE_FALL * np.abs(force).max()
    result = np.flatnonzero(inner & falls)
    if not len(result):
        return float("nan")
    i = int(result[0]) + 1
    near = np.linspace(times[max(i - 2, 0)], times[min(i + 2, len(times) - 1)], FINE)
    return float(run.at(near)["friction"].max())


# Forces below the level of sliding that pulse: whether the body drifts.

BIAS, RIPPLE, FREQUENCY = 0.5, 0.4, 10.0
"""Constant and swinging part of the force over the lowest level; frequency [Hz]."""
DRIFT_SPAN = (2.0, 10.0)
"""When drift begins to count, and the end [s]."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Drift(Characteristic):
    """The motion of a body under a force that swings and never reaches break-away."""

    test: ClassVar[str] = "drift"
    title: ClassVar[str] = "Drift below break-away"
    columns: ClassVar[Mapping[str, str]] = {"t": "s", "position": "m"}
    over: ClassVar[str] = "t"

    t: Array
    """Times (n,) [s]."""
    position: Array
    """Position (n,) [m]."""
    distance: float
    """How far the mean position moves in the time that counts [m]."""
    lasts: float
    """That time [s]."""
    length: float
    """Displacement that counts as large here: the presliding length [m]."""
    threshold: str
    """What the load stays below."""

    @property
    def stays(self) -> bool:
        """Whether the body stays in its place."""
        return abs(self.distance) <= ALIKE * self.length

    @property
    def rate(self) -> float:
        """Speed of the drift [m/s]."""
        return self.distance / self.lasts

    @property
    def sentence(self) -> str:
        if self.stays:
            return "It does not drift: under a load below break-away the body stays in its place."
        return (
            f"It drifts: {quantity(abs(self.distance), 'm')} in {quantity(self.lasts, 's')} under a"
            f" load that never reaches {self.threshold}."
        )


def drift(bench: Bench, *, bias: float | None = None, ripple: float | None = None) -> Drift:
    """Push a body with a constant force and a ripple that together stay below break-away.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=1.5, bristle_stiffness=1e5, viscous_coefficient=0.4)
    >>> print(drift(Bench(law=law), bias=0.5, ripple=0.4).sentence)
    It drifts: 0.616 mm in 8 s under a load that never reaches break-away.
    """
    low, high = bench.levels
    bias = BIAS * low if bias is None else bias
    ripple = RIPPLE * low if ripple is None else ripple
    if not abs(bias) + abs(ripple) < high:
        raise InputError(
            f"bias and ripple must stay below {bench.threshold} at {quantity(high, 'N')}, got"
            f" {quantity(bias, 'N')} and {quantity(ripple, 'N')}."
        )
    first, end = DRIFT_SPAN
    # The constant part ends behind the run.
    force = Pulse(level=bias, duration=2.0 * end) + Sine(amplitude=ripple, frequency=FREQUENCY)
    axis = bench.on(Axis(inertia=bench.mass, drive=force, load=bench.load))
    run = simulate(axis, bench.law, t_end=end, y0=bench.deflected())

    def position(since: float, until: float) -> Array:
        return run.at(np.minimum(np.linspace(since, until, FINE), run.span[1]))["x"]

    cycles = 5.0 / FREQUENCY  # over which a position is a mean
    before, after = (position(until - cycles, until).mean() for until in (first, end))
    return Drift(
        t=np.linspace(0.0, end, FINE),
        position=position(0.0, end),
        distance=float(after - before),
        lasts=end - first,
        length=bench.reach,
        threshold=bench.threshold,
        conditions=(
            f"{quantity(bench.mass, 'kg')} under {quantity(bias, 'N')} and a ripple of"
            f" {quantity(ripple, 'N')} at {quantity(FREQUENCY, 'Hz')}; {bench.threshold}:"
            f" {quantity(high, 'N')}."
        ),
    )


# Small displacements to and fro: what deflects before it slips, and what it remembers.

LONGEST_WAY = 100.0
"""Time of a way as long as the amplitude for which the allowed speed is taken rather [s]."""
BRIEFEST_WAY = 1.0
"""The same of a contact that neither deflects nor holds, whose friction follows the speed alone:
small smoothing velocities ask for so many steps that a longer way ends a run early [s]."""
TURNS = (1.0, -1.0, 0.5, -0.25, 0.5, -1.0, 1.0)
"""Where the path turns, over its amplitude; the inner loop goes from the third and back to it."""
INNER = (0.8, 0.4)
"""Where an inner loop on first loading turns, over the presliding length: it tests the memory."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Presliding(Characteristic):
    """Friction along a slow path to and fro, with a closed inner loop."""

    test: ClassVar[str] = "presliding"
    title: ClassVar[str] = "Presliding and memory"
    columns: ClassVar[Mapping[str, str]] = {"displacement": "m", "force": "N"}

    displacement: Array
    """Displacement (n,) [m]."""
    force: Array
    """Friction force (n,) [N]."""
    reversals: Array
    """Displacements at which the path turns (m,) [m]."""
    length: float
    """Displacement at which the first stiffness reaches break-away [m]; 0 if nothing deflects."""
    change: float
    """Force after a closed inner loop less the force before, on first loading [N]."""
    memory: Literal["local", "non-local", "none"]
    """Whether the force returns after a closed inner loop; none if nothing deflects."""
    sticks: bool
    """Whether some force leaves the body at rest."""

    @property
    def sentence(self) -> str:
        if not self.sticks:
            return (
                "It neither deflects nor holds: at small velocities there is next to no friction,"
                " so that reversals are smoother than measured ones."
            )
        if self.memory == "none":
            return (
                "It does not deflect: below break-away the contact is rigid, so that no force"
                " springs back when a motion turns."
            )
        deflects = f"It deflects by some {quantity(self.length, 'm')} before it slides"
        if self.memory == "non-local":
            return (
                f"{deflects}. After a closed inner loop the force is the one before: its memory is"
                " non-local, as that of measured contacts is."
            )
        way = "less" if self.change < 0.0 else "more"
        return (
            f"{deflects}. After a closed inner loop the force is"
            f" {quantity(abs(self.change), 'N')} {way} than before: its memory is local, so that"
            " small swings on top of a motion are predicted wrongly."
        )


def presliding(
    bench: Bench, *, amplitude: float | None = None, inner: tuple[float, float] | None = None
) -> Presliding:
    """Move the contact slowly along a path that turns, and test its memory.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=1.5, bristle_stiffness=1e5, viscous_coefficient=0.4)
    >>> found = presliding(Bench(law=law), inner=(1.2e-5, 0.6e-5))
    >>> found.memory, round(found.change, 3)
    ('local', -0.292)
    """
    reach = 2.0 * bench.reach if amplitude is None else amplitude
    wanted, allowed = SLOW * bench.speed, PERCENT * bench.speed
    if amplitude is None and not (bench.law.states or bench.sticks):
        reach = min(reach, BRIEFEST_WAY * allowed)
    speed = min(max(wanted, reach / LONGEST_WAY), allowed) if bench.law.states else allowed
    turns = reach * np.array(TURNS)
    x, force = _followed(bench, turns, speed)
    change = 0.0
    memory: Literal["local", "non-local", "none"] = "none"
    if bench.length > 0.0:
        begins, to = inner or (part * bench.length for part in INNER)
        run, arrivals = _along(bench, (begins, to, begins), speed)
        before, after = run.at(np.minimum(arrivals[[0, 2]], run.span[1]))["friction"]
        change = float(after - before)
        memory = "local" if abs(change) > ALIKE * bench.levels[1] else "non-local"
    return Presliding(
        displacement=x,
        force=force,
        reversals=turns,
        length=bench.length,
        change=change,
        memory=memory,
        sticks=bench.sticks,
        conditions=(
            f"{quantity(reach, 'm')} to and fro at no more than {quantity(speed, 'm/s')}, normal"
            f" force {quantity(bench.load, 'N')}."
        ),
    )


def _along(bench: Bench, turns: Sequence[float], speed: float) -> tuple[Trajectory, Array]:
    """Return the motion of the contact along a path, and when it turns [s]."""
    path, arrivals = there_and_back(turns, speed)
    run = simulate(bench.guided(path), bench.law, t_end=arrivals[-1], y0=bench.deflected())
    return run, arrivals


def _followed(bench: Bench, turns: Array, speed: float) -> tuple[Array, Array]:
    """Return displacement and friction along a path."""
    run, arrivals = _along(bench, turns.tolist(), speed)
    share = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, POINTS))  # even steps of displacement
    starts = np.concatenate([[0.0], arrivals[:-1]])
    times = np.concatenate([a + (b - a) * share[1:] for a, b in zip(starts, arrivals, strict=True)])
    times = np.union1d(times, run.t)  # steps end where a contact gives way
    seen = run.at(np.minimum(times, run.span[1]))
    return seen["x"], seen["friction"]


# The battery: all tests of a law, and of several side by side.

# Tests of sliding: steady friction, and the energy that it takes in a cycle.
#
# Passivity is searched for, not proved: cycles of motion at piecewise constant velocity are drawn,
# the states of the law are followed through each by the method of Runge and Kutta, and the search
# goes on around those in which friction takes the least energy.

# Friction after long sliding at each velocity, and what the contact holds at rest.

REACH = 100.0
"""Speeds are looked at so many times below and above the one at which friction changes."""
SEEN = 2.0
"""Friction over the highest level, up to which they are looked at one decade farther."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class SteadyCurve(Characteristic):
    """The steady curve of a law."""

    test: ClassVar[str] = "steady"
    title: ClassVar[str] = "Steady sliding"
    columns: ClassVar[Mapping[str, str]] = {"velocity": "m/s", "force": "N"}
    over: ClassVar[str] = "velocity"

    velocity: Array
    """Slip velocity (n,) [m/s], from backwards to forwards; 0 is left out."""
    force: Array
    """Friction force (n,) [N]."""
    break_away: tuple[float, float]
    """Largest force at rest, backwards and forwards [N]."""
    holds: bool
    """Whether the body stays at rest under any smaller force."""

    @property
    def sentence(self) -> str:
        ahead, back = (self._side(side) for side in (1, -1))
        same = ahead == back
        return ahead if same else f"Forwards: {lower_first(ahead)} Backwards: {lower_first(back)}"

    def _side(self, side: int) -> str:
        """Return what one direction of slip says."""
        chosen = self.velocity * side > 0.0
        speed, force = np.abs(self.velocity[chosen]), np.abs(self.force[chosen])
        order = np.argsort(speed)
        speed, force = speed[order], force[order]
        rest = self.break_away[(side + 1) // 2]
        if rest <= 0.0:
            top = int(np.argmax(force >= 0.9 * force.max()))
            return (
                f"At rest it holds nothing: friction grows from 0 to {quantity(force[top], 'N')} at"
                f" {quantity(speed[top], 'm/s')}, so that a body never sticks."
            )
        low = int(np.argmin(force))
        start = max(rest, float(force[0]))
        if force[low] < (1.0 - PERCENT) * start:
            falls = force[0] >= (1.0 + PERCENT) * force[low]
            where = f" at {quantity(speed[low], 'm/s')}" if falls else ""
            what = "A drive that is soft can stick and slip"
            rises = " and rises beyond" if force[-1] > (1.0 + PERCENT) * force[low] else ""
            return (
                f"Break-away takes {quantity(start, 'N')}, sliding {quantity(force[low], 'N')}"
                f"{where}{rises}. {what}{' below this speed' if falls and rises else ''}."
            )
        begins = f"Break-away and slow sliding take {quantity(rest, 'N')}; friction"
        steps = np.diff(force) / force.max()
        if (steps < -ROUNDING).any():
            most = quantity(speed[-1], "m/s")
            return f"{begins} falls by no more than 1 % at speeds up to {most}."
        how = "grows with" if force[-1] > (1.0 + ROUNDING) * force[0] else "does not depend on"
        return f"{begins} {how} speed, so that steady sliding is stable."


def steady_curve(bench: Bench) -> SteadyCurve:
    """Return the steady curve of a law.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    >>> print(steady_curve(Bench(law=law)).sentence)
    Break-away takes 1.5 N, sliding 1 N. A drive that is soft can stick and slip.
    """
    law, load = bench.curve, bench.load
    farther = np.abs(law.steady(bench.speed * 10.0 * REACH * np.array([-1.0, 1.0]), load))
    slow = np.max(farther) <= SEEN * bench.levels[1]  # viscous friction is hardly seen before
    speeds = bench.speed * np.geomspace(1.0 / REACH, 10.0 * REACH if slow else REACH, POINTS + 1)
    velocity = np.concatenate([-speeds[::-1], speeds])
    force = np.asarray(law.steady(velocity, load), dtype=np.float64) + np.zeros_like(velocity)
    back, ahead = (float(law.towards(side).break_away(load)) for side in (-1, 1))
    least, most = (quantity(speed, "m/s") for speed in speeds[[0, -1]])
    return SteadyCurve(
        velocity=velocity,
        force=force,
        break_away=(back, ahead),
        holds=law.holds,
        conditions=f"{least} to {most} both ways, normal force {quantity(load, 'N')}.",
    )


# Whether friction can return more work than it takes, and the motion in which it does.

TRIED, KEPT, ROUNDS = 120, 8, 4
"""Motions that the search begins with, those it goes on from, and how often it does."""
AROUND, SPREAD = 6, 0.5
"""Motions around each, and how far their speeds and ways scatter in the first round [ln 1]."""
PIECES = 3
"""Pieces of constant velocity of a motion."""
CYCLE_SPEEDS = (1e-2, 1e2)
"""Speeds of a motion over the one at which friction changes."""
WAYS = (0.05, 4.0)
"""Ways at one velocity over the presliding length."""
ENERGY_CYCLES = 6
"""Cycles until a motion repeats itself; the search takes half of them."""
LENGTH_STEPS = 32
"""Steps of Runge-Kutta for each presliding length; each piece has twice as many at least."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Passivity(Characteristic):
    """The least energy that a search found a cycle of motion to take."""

    test: ClassVar[str] = "passivity"
    title: ClassVar[str] = "Passivity"
    columns: ClassVar[Mapping[str, str]] = {"velocity": "m/s", "duration": "s"}

    worst: float
    """Energy that friction takes in the worst cycle [J]; negative if it returns some."""
    velocity: Array
    """Velocities of that cycle (n,) [m/s]."""
    duration: Array
    """How long each lasts (n,) [s]."""
    cycles: int
    """Number of motions tried; 0 where none is needed."""
    scale: float
    """Break-away times presliding length [J]."""

    @property
    def passive(self) -> bool:
        """Whether no motion was found that gains energy from friction."""
        return self.worst >= -TRANSIENT * self.scale

    @property
    def sentence(self) -> str:
        if not self.passive:
            motion = ", ".join(
                f"{quantity(v, 'm/s')} for {quantity(t, 's')}"
                for v, t in zip(self.velocity, self.duration, strict=True)
            )
            return (
                f"It is not passive: friction returns {quantity(-self.worst, 'J')} in each cycle of"
                f" {motion}; a proof of stability that takes friction as passive does not hold."
            )
        if not self.cycles:
            return "It is passive at all speeds tried: friction acts against the velocity."
        return (
            f"No cycle of {self.cycles} that were tried gains energy from friction; this is no"
            " proof that none does."
        )


def cycle_energy(
    law: FrictionLaw,
    velocity: Sequence[float] | Array,
    duration: Sequence[float] | Array,
    *,
    load: float = 1.0,
    cycles: int = ENERGY_CYCLES,
    finer: int = 1,
) -> Array:
    """Return the energy that friction takes in a cycle of motion at piecewise constant velocity.

    The states are followed by the equations of the law at these velocities, which no body of finite
    mass can take on; the energy is that of the last cycle.

    Parameters
    ----------
    law : FrictionLaw
        The law; its states begin at 0.
    velocity : sequence of float or array (n,) or (n, m)
        Velocity of each piece, of one motion or of several [m/s].
    duration : sequence of float or array (n,) or (n, m)
        How long each piece lasts [s].
    load : float
        Normal force [N].
    cycles : int
        How often the motion is repeated.
    finer : int
        How many times shorter the steps are than usual.

    Returns
    -------
    array (m,)
        Energy [J]; negative if friction returns more than it takes.

    Raises
    ------
    InputError
        If velocities and durations do not belong together.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> float(cycle_energy(Coulomb(kinetic_coefficient=0.5), [0.1, -0.1], [1.0, 1.0])[0])
    0.1
    """
    v, t = (np.atleast_2d(np.asarray(item, dtype=np.float64).T).T for item in (velocity, duration))
    if v.shape != t.shape or not (t > 0.0).all():
        raise InputError(
            f"a cycle needs as many durations above 0 s as velocities, got {v.shape[0]} velocities"
            f" and {t.shape[0]} durations."
        )
    # Without states friction follows from the velocity: no steps are needed.
    if not law.states:
        force = np.array([law.steady(item, load) for item in v]) + np.zeros_like(v)
        return np.asarray((force * v * t).sum(axis=0))
    length = presliding_length(law, load)
    z = np.zeros((len(law.states), v.shape[1]))
    flags = Latches(off=True)
    for _ in range(cycles):
        energy = np.zeros(v.shape[1])
        for speed, lasts in zip(v, t, strict=True):
            way = float(np.abs(speed * lasts).max()) / length
            # So many steps for each presliding length, over which states relax.
            count = finer * max(2 * LENGTH_STEPS, int(np.ceil(LENGTH_STEPS * way)))
            z, work = _moved(law, load, speed, lasts / count, count, z, flags)
            energy = energy + work
    return energy


def _moved(
    law: FrictionLaw,
    load: float,
    v: Array,
    h: Array,
    count: int,
    z: Array,
    flags: Latches,
) -> tuple[Array, Array]:
    """Return states (n, m) after some steps at constant velocities, and the work of friction."""

    def rates(at: Array) -> Array:
        with flags:
            return np.array([np.zeros_like(v) + rate for rate in law.rates(v, load, tuple(at))])

    def power(at: Array) -> Array:
        with flags:
            return np.asarray(law.force(v, load, tuple(at))) * v

    work = np.zeros_like(v)
    before, k1 = power(z), rates(z)
    for _ in range(count):
        k2 = rates(z + 0.5 * h * k1)
        k3 = rates(z + 0.5 * h * k2)
        k4 = rates(z + h * k3)
        start, first = z, k1
        z = z + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        k1 = rates(z)
        half = 0.5 * (start + z) + h / 8.0 * (first - k1)  # of the cubic through both ends
        now = power(z)
        # Simpson's rule, with the state half-way.
        work = work + h / 6.0 * (before + 4.0 * power(half) + now)
        before = now
        # Latches turn between steps only; rates are those of their new sides then.
        if flags:
            rates(z)
            flags.turn()
            before, k1 = power(z), rates(z)
    return z, work


def passivity(bench: Bench) -> Passivity:
    """Search for a cycle of motion in which friction returns more work than it takes.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> print(passivity(Bench(law=Coulomb(kinetic_coefficient=0.5))).sentence)
    It is passive at all speeds tried: friction acts against the velocity.
    """
    law, load = bench.curve, bench.load
    conditions = f"Normal force {quantity(load, 'N')}; velocities that jump and stay constant"
    scale = bench.levels[1] * bench.reach
    if not law.states:
        speeds = bench.speed * np.geomspace(1e-4, 1e4, 401)
        speeds = np.concatenate([-speeds, speeds])
        power = (np.asarray(law.steady(speeds, load)) + np.zeros_like(speeds)) * speeds
        gaining = speeds[[int(np.argmin(power))]] if power.min() < 0.0 else speeds[:0]
        duration = bench.reach / np.abs(gaining)
        return Passivity(
            worst=float(sum(power.min() * duration)),
            velocity=gaining,
            duration=duration,
            cycles=0,
            scale=scale,
            conditions=(
                f"Normal force {quantity(load, 'N')}; steady curve up to"
                f" {quantity(speeds[-1], 'm/s')}."
            ),
        )

    def searched(speed: Array, way: Array) -> Array:
        with np.errstate(all="ignore"):  # of motions that are too fast for the steps
            result = cycle_energy(
                law, speed, way / np.abs(speed), load=load, cycles=ENERGY_CYCLES // 2
            )
        return np.where(np.isfinite(result), result, np.inf)

    random = np.random.default_rng(0)
    way, speed = (
        size * np.exp(random.uniform(np.log(low), np.log(high), size=(PIECES, TRIED)))
        for size, (low, high) in ((bench.reach, WAYS), (bench.speed, CYCLE_SPEEDS))
    )
    # The first half goes one way; in the rest each piece goes either way.
    speed[:, TRIED // 2 :] *= random.choice([-1.0, 1.0], size=(PIECES, TRIED // 2))
    # slow, then too fast for the states to follow
    speed[:, 0] = bench.speed * np.array([0.1, 100.0, 100.0])
    way[:, 0] = bench.reach * np.array([1.7, 1.2, 0.1])
    energy = searched(speed, way)
    count = TRIED
    for n in range(ROUNDS):
        best = np.argsort(energy)[:KEPT]
        speed, way, energy = speed[:, best], way[:, best], energy[best]
        spread = SPREAD / (n + 1)
        near = [
            np.repeat(array, AROUND, axis=1)
            * np.exp(random.normal(scale=spread, size=(PIECES, KEPT * AROUND)))
            for array in (speed, way)
        ]
        fastest = CYCLE_SPEEDS[1] * bench.speed
        near = [np.clip(near[0], -fastest, fastest), np.minimum(near[1], WAYS[1] * bench.reach)]
        count += KEPT * AROUND
        energy = np.append(energy, searched(*near))
        speed, way = (np.append(a, b, axis=1) for a, b in zip((speed, way), near, strict=True))
    lasts = way / np.abs(speed)
    # An energy that differs with the steps is an artefact: the next motion is looked at.
    for i in np.argsort(energy)[:10]:
        with np.errstate(all="ignore"):
            worst, finer = (
                float(cycle_energy(law, speed[:, i], lasts[:, i], load=load, finer=n)[0])
                for n in (1, 4)
            )
        if abs(worst - finer) <= ALIKE * (scale + abs(finer)):
            break
    else:
        raise SimulationError(
            "The equations change too fast for the search: its energies differ with the steps."
        )
    return Passivity(
        worst=worst,
        velocity=speed[:, i],
        duration=lasts[:, i],
        cycles=count,
        scale=scale,
        conditions=f"{conditions}; energy of the last of {ENERGY_CYCLES} cycles.",
    )


# The battery: all tests of a law, and of several side by side.

Given: TypeAlias = FrictionLaw | type[FrictionLaw] | str
"""A law, its type, or its name or composition."""

TESTS: Final[Mapping[str, Callable[[Bench], Characteristic]]] = MappingProxyType(
    {
        "steady": steady_curve,
        "presliding": presliding,
        "break-away": break_away,
        "drift": drift,
        "passivity": passivity,
    }
)
"""The tests by name, in the order of pages."""

ROLES = ("kinetic_coefficient", "static_coefficient", "stribeck_velocity", "bristle_stiffness")
"""What several laws have in common: F_c, F_s, v_s and stiffness."""
LOAD = Quantity("N", "N", above=0)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Characterization(InPanels):
    """What the battery says of a law; a test that was not made, or could not be, is None."""

    title: str
    """The law in running text, with the values of its inputs."""
    law: FrictionLaw
    """The law with the parameters that were tried."""
    load: float
    """Normal force [N]."""
    steady: SteadyCurve | None = None
    """Friction after long sliding."""
    presliding: Presliding | None = None
    """Loop of small displacements, and its memory."""
    break_away: BreakAway | None = None
    """Break-away against rate and rest."""
    drift: Drift | None = None
    """Motion under a ripple below break-away."""
    passivity: Passivity | None = None
    """Least energy of a cycle."""
    failed: Mapping[str, str] = field(default_factory=dict)
    """Why a test could not be made, by its name."""
    matched: str = ""
    """Which parameters were set to those of the first law, in a sentence."""
    others: tuple["Characterization", ...] = ()
    """The same of the other laws, or of other values of the inputs."""

    @property
    def all(self) -> tuple["Characterization", ...]:
        """The law itself and the others."""
        return (self, *self.others)

    @property
    def results(self) -> Mapping[str, Characteristic]:
        """The tests that were made, by name."""
        result = {name: getattr(self, name.replace("-", "_")) for name in TESTS}
        return {name: value for name, value in result.items() if value is not None}

    @property
    def by_test(self) -> dict[str, dict[str, Characteristic]]:
        """Results of all laws by test, and by the title of the law for each."""
        output: dict[str, dict[str, Characteristic]] = {}
        for law in self.all:
            for name, result in law.results.items():
                output.setdefault(name, {})[law.title] = result
        return output

    def to_dict(self) -> dict[str, Any]:
        """Return laws, sentences and numbers, as in JSON."""
        entry = {
            "law": self.law.name,
            "title": self.title,
            "parameters": {name: getattr(self.law, name) for name in fields_of(type(self.law))},
            "load": self.load,
            "matched": self.matched,
            "tests": {name: result.to_dict() for name, result in self.results.items()},
            "failed": dict(self.failed),
        }
        return {**entry, "others": [other.to_dict() for other in self.others]}

    def _summary(self) -> Summary:
        names = dict.fromkeys(name for law in self.all for name in (*law.results, *law.failed))
        rows = [[name, *(law.told(name) for law in self.all)] for name in names]
        if not self.others:
            return Summary(sentence=f"{self.title}, normal force {number(self.load)} N.", rows=rows)
        head = ["test", *(law.title for law in self.all)]
        return Summary(sentence=f"{len(self.all)} laws side by side.", head=head, rows=rows)

    def told(self, test: str) -> str:
        """Return what a test says in a sentence; `failed` has why one could not be made."""
        result = self.results.get(test)
        if result is not None:
            return result.sentence
        return f"no result: {self.failed[test]}" if test in self.failed else "not made"


def characterize(
    law: Given,
    *others: Given,
    load: float = 1.0,
    rig: Mechanism | None = None,
    tests: Sequence[str] | None = None,
    match: bool = True,
    inputs: Mapping[str, float | Sequence[float]] | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Characterization:
    """Try a law on a battery of tests, or several side by side.

    Parameters
    ----------
    law : FrictionLaw, type or str
        The law; one given by type, name or composition has its typical values.
    *others : FrictionLaw, type or str
        Laws beside it.
    load : float
        Normal force [N].
    rig : Axis, SpringBlock or TowedBlock, optional
        Body whose mass is taken; 1 kg if not given.
    tests : sequence of str, optional
        Names of tests: steady, presliding, break-away, drift, passivity. All if not given.
    match : bool
        Whether the other laws take the levels, the Stribeck velocity and the bristle stiffness of
        the first.
    inputs : mapping of str to float or sequence of float, optional
        Values of the inputs that a law depends on, such as ``{"temperature": (20.0, 40.0)}``: each
        is tried as a law of its own.
    progress : callable, optional
        Called with the number of tests done and of all.

    Returns
    -------
    Characterization
        The results by test, and those of the others.

    Raises
    ------
    InputError
        If an argument cannot be used, or an input of a law has no value.
    UnknownNameError
        If a law or a test is unknown.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=1.5, bristle_stiffness=1e5, viscous_coefficient=0.4)
    >>> found = characterize(law, tests=["drift"])
    >>> found.drift.sentence
    'It drifts: 3.41 mm in 8 s under a load that never reaches break-away.'
    """
    load = LOAD.check("characterize", "load", load)
    chosen = list(TESTS) if tests is None else list(dict.fromkeys(tests))
    for name in chosen:
        named(TESTS, name, "test")
    if not chosen:
        raise InputError(f"tests must name one of {', '.join(TESTS)}, got none.")
    given = [law_with_values(friction, load) for friction in (law, *others)]
    notes = [""] * len(given)
    # Levels and stiffness of the first law, so that differences are those of the shape.
    if match:
        for i, member in enumerate(given[1:], 1):
            given[i], notes[i] = _matched(member, given[0])
    tried = [
        (title, twin, at, note)
        for friction, note in zip(given, notes, strict=True)
        for title, twin, at in _levels(friction, inputs or {})
    ]
    _refuse_unused(inputs or {}, given)
    titles = _distinct([title for title, *_ in tried])
    benches: list[Bench] = []
    for _, member, at, _ in tried:
        # Settings of matched laws are the same too.
        same = (benches[0].force, benches[0].speed) if benches and match else None
        benches.append(Bench.of(member, load, rig, at, same))
    count, done = len(chosen) * len(tried), itertools.count(1)
    result: list[Characterization] = []
    for title, bench, (_, member, _, note) in zip(titles, benches, tried, strict=True):
        results: dict[str, Any] = {}
        failed: dict[str, str] = {}
        for name in chosen:
            try:
                results[name.replace("-", "_")] = TESTS[name](bench)
            # One law that cannot be followed does not end the others.
            except SimulationError as error:
                why, dot, _ = str(error).partition(". ")  # the rest is advice on rigs of one's own
                failed[name] = (
                    f"{why}{dot.strip()} The bench cannot follow this law with these values: give"
                    " others, such as a larger smoothing velocity or a smaller bristle stiffness,"
                    " or leave the test out."
                )
            if progress is not None:
                progress(next(done), count)
        result.append(
            Characterization(
                title=title, law=member, load=load, matched=note, failed=failed, **results
            )
        )
    return dataclasses.replace(result[0], others=tuple(result[1:]))


def law_with_values(given: Given, load: float) -> FrictionLaw:
    """Return a law; one that is given by type, name or text with its typical values.

    Examples
    --------
    >>> law_with_values("coulomb", 1.0)
    Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
    """
    law: Any = law_type(given) if isinstance(given, str) else given
    is_type = isinstance(law, type) and issubclass(law, FrictionLaw)
    if not (is_type or isinstance(law, FrictionLaw)):
        raise InputError(
            f"a law must be a FrictionLaw, its type, or its name or composition, got {given!r}."
        )
    return with_typical_values(law) or starting_law(law, load)


def _matched(law: FrictionLaw, first: FrictionLaw) -> tuple[FrictionLaw, str]:
    """Return a law with levels, Stribeck velocity and stiffness of another; and which, in words."""
    values: dict[str, float] = {}
    for name in fields_of(type(law)):
        role = name.rpartition("ward_")[2]
        own = name if hasattr(first, name) else role if hasattr(first, role) else f"forward_{role}"
        value = getattr(first, own, None) if role in ROLES else None
        if value is not None:
            values[name] = float(value)
    # A level at rest may not lie below one that was matched above it.
    for name, field_of_law in fields_of(type(law)).items():
        least = field_of_law.at_least
        if least in values and name not in values and (own_value := getattr(law, name)) is not None:
            values[name] = max(float(own_value), values[least])
    words = dict.fromkeys(name.rpartition("ward_")[2].replace("_", " ") for name in values)
    if not words:
        return law, f"Nothing of {law.title} could be matched to {first.title}."
    return dataclasses.replace(law, **values), f"{capital(joined([*words]))} as {first.title}."


def _levels(
    law: FrictionLaw, inputs: Mapping[str, float | Sequence[float]]
) -> Iterator[tuple[str, FrictionLaw, dict[str, float]]]:
    """Return the law at each combination of values of its inputs, with its title and the values."""
    missing = [name for name in law.inputs if name not in inputs]
    if missing:
        raise InputError(
            f"the law {law.name} depends on {joined(missing)}: give values, such as"
            f" inputs={{{missing[0]!r}: [...]}} in Python or --input {missing[0]}=VALUE,... on the"
            " command line."
        )
    choices = [np.atleast_1d(np.asarray(inputs[name], dtype=float)) for name in law.inputs]
    # Every combination of values, the last input fastest.
    for values in itertools.product(*choices):
        at = {name: float(value) for name, value in zip(law.inputs, values, strict=True)}
        told = "".join(f", {name} {_input_text(name, value)}" for name, value in at.items())
        yield f"{law.title}{told}", law, at


def _input_text(name: str, value: float) -> str:
    """Return a value of an input with its unit."""
    unit = unit_text(CONTACT_INPUTS[name].unit) if name in CONTACT_INPUTS else ""
    return f"{number(value, 4)} {unit}".strip()


def _refuse_unused(
    inputs: Mapping[str, float | Sequence[float]], laws: Sequence[FrictionLaw]
) -> None:
    known = tuple(dict.fromkeys(name for law in laws for name in law.inputs))
    for name in inputs:
        if name not in known:
            depends = f"depend on {joined(known)}" if known else "depend on no input"
            raise InputError(f"inputs: no law here depends on {name!r}; they {depends}.")


def _distinct(titles: Sequence[str]) -> list[str]:
    """Return titles of which no two are equal."""
    seen: dict[str, int] = {}
    result = []
    for title in titles:
        seen[title] = seen.get(title, 0) + 1
        result.append(title if seen[title] == 1 else f"{title} ({seen[title]})")
    return result
