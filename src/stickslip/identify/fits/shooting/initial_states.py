r"""Initial states of segments: coordinates and rates by damped steps, bristles along the motion.

Bristle states are followed along a measured motion, for copies of a law at once.
The engine takes one step after the other in machine code (`stickslip.engine.kernels.states`). The
equations of a few laws are written for arrays alone: their states :math:`z_k` take exponential
Euler steps,

.. math:: z_k \leftarrow z_k + \frac{e^{h J_k} - 1}{J_k}\, \dot z_k(z) ,
          \qquad J_k = \partial \dot z_k / \partial z_k ,

which are exact where the rate is linear in the deflection, in `PARTS` parts of each step. Dahl's
bristle with an exponent other than 1 moves by its closed form.

Source: M. Hochbruck, A. Ostermann, "Exponential integrators", Acta Numerica 19, 2010.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.kernels.states import MOST_PARTS as PARTS
from stickslip.engine.kernels.states import NUDGE
from stickslip.engine.solver import states_along
from stickslip.friction import FrictionLaw, bound
from stickslip.identify.fits.levenberg_marquardt import AGREE
from stickslip.identify.fits.parameters import MOVED, FreeParameters, with_arrays
from stickslip.identify.fits.settings import NEGLIGIBLE, ROUNDING, ROUNDS, SETTLED
from stickslip.quantities import vary

Array = NDArray[np.float64]


TINY = float(np.finfo(float).eps)
"""Share of the way to the limit that is none."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Path:
    """A measured motion: at samples, and in the steps between them."""

    time: Array
    """Times of the samples (n,) [s]."""
    velocity: Array
    """Slip velocity at the samples (n,) [m/s]."""
    load: Array
    """Normal force at the samples (n,) [N]."""
    travel: Array
    """Displacement in each step (n - 1,) [m]."""
    inputs: Mapping[str, Array] = field(default_factory=dict)
    """Contact inputs at the samples (n,), by name."""

    def steps(self) -> Array:
        """Return durations, velocities, loads and inputs of the steps (3 + inputs, n - 1)."""
        duration, beside = np.diff(self.time), (self.load, *self.inputs.values())
        means = [0.5 * (item[1:] + item[:-1]) for item in beside]
        return np.array([duration, self.travel / duration, *means])


def follow(law: FrictionLaw, path: Path, start: Array) -> Array:
    """Return bristle states (b, samples, copies) along a path from the first ones (b, copies).

    Within a step the velocity is constant, so that laws which know displacement only see the
    measured one exactly.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> x = np.linspace(0.0, 1e-3, 11)
    >>> there = Path(time=x, velocity=np.ones(11), load=np.ones(11), travel=np.diff(x))
    >>> law = Dahl(kinetic_coefficient=0.5, bristle_stiffness=1e3)
    >>> z = follow(law, there, np.zeros((1, 1)))
    >>> round(float(z[0, -1, 0] / (0.5e-3 * (1 - np.exp(-2.0)))), 9)
    1.0
    """
    inputs = {name: path.inputs[name] for name in law.inputs}
    steps = replace(path, inputs=inputs).steps().T
    result = None if _power(law) is not None else states_along(law, steps, tuple(inputs), start)
    return _in_arrays(law, steps, tuple(inputs), start) if result is None else np.asarray(result)


def balancing(law: FrictionLaw, path: Path, force: float, bristles: int) -> Array:
    """Return the least bristle states at the first sample of a path that a force can come from.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> at_rest = Path(time=np.zeros(1), velocity=np.zeros(1), load=np.ones(1), travel=np.zeros(0))
    >>> law = Dahl(kinetic_coefficient=0.5, bristle_stiffness=1e3)
    >>> balancing(law, at_rest, 0.25, 1), balancing(law, at_rest, 4.0, 1)
    (array([[0.00025]]), array([[0.0005]]))
    """
    law = bound(law, {name: float(path.inputs[name][0]) for name in law.inputs})
    v, n, size = float(path.velocity[0]), float(path.load[0]), 1e-6
    unbent = law.force(v, n, (0.0,) * bristles)
    moved = [
        law.force(v, n, tuple(size * (k == i) for i in range(bristles))) for k in range(bristles)
    ]
    slope = np.array([np.atleast_1d((item - unbent) / size) for item in moved])
    level = law.break_away(n)
    wanted = np.clip(force, -level, level) - unbent
    result: Array = slope * wanted / np.maximum(np.sum(slope**2, axis=0), 1e-300)
    return result


def _in_arrays(law: FrictionLaw, motion: Array, inputs: tuple[str, ...], start: Array) -> Array:
    """Return states (b, steps + 1, copies) along a motion, of a law in arrays."""
    states = np.empty((len(start), len(motion) + 1, start.shape[1]))
    states[:, 0] = z = start
    closed, size = _power(law) is not None, 0.0
    for i, (h, v, n, *beside) in enumerate(motion):
        at = bound(law, dict(zip(inputs, beside, strict=True)))
        for _ in range(1 if closed else PARTS):
            if closed:
                z = _yielded(at, v, n, z, h)
            else:
                z, size = _stepped(at, v, n, z, h / PARTS, size)
        states[:, i + 1] = z
    return states


def _stepped(
    law: FrictionLaw, v: float, n: float, z: Array, h: float, size: float
) -> tuple[Array, float]:
    """Return states after an exponential Euler step of h, and the largest deflection so far."""
    f = _rates(law, v, n, z)
    size = max(size, float(np.max(np.abs(z) + np.abs(h * f))))
    nudge = NUDGE * size + 1e-300
    slopes = np.empty_like(z)
    for k in range(len(z)):
        moved = z.copy()
        moved[k] += nudge
        slopes[k] = (_rates(law, v, n, moved)[k] - f[k]) / nudge
    x = np.minimum(h * slopes, 50.0)
    safe = np.where(np.abs(x) < NUDGE, 1.0, x)
    return z + h * f * np.where(np.abs(x) < NUDGE, 1.0, np.expm1(safe) / safe), size


def _yielded(law: Any, v: float, n: float, z: Array, h: float) -> Array:
    """Return the state (1, ...) of Dahl's bristle after a step of h by its closed form."""
    power = _power(law)
    assert power is not None
    names = law.made_of.memory.names
    probe = law.break_away(1.0) / getattr(law, names.get("bristle_stiffness", "bristle_stiffness"))
    probe = np.broadcast_to(probe, z.shape)
    moves = v != 0.0
    way, along = np.where(moves, v, 1.0), np.where(v < 0.0, -1.0, 1.0)
    # at a deflection against the way, the spring stands further from its limit than unbent
    curve = ((_rates(law, v, n, -along * probe) / way) ** (1.0 / power) - 1.0) / probe
    left = 1.0 - curve * along * z
    size = np.abs(left)
    bend = 1.0 - power
    worn = curve * np.abs(v) * h * np.maximum(size, TINY) ** -bend
    plain = np.abs(bend) < ROUNDING
    spent = np.where(plain, 0.0, bend * worn)
    kept = np.log1p(-np.minimum(spent, 1.0 - TINY)) / np.where(plain, 1.0, bend)
    size = np.where(spent >= 1.0, 0.0, size * np.exp(np.where(plain, -worn, kept)))
    return np.where(moves, along * (1.0 - np.copysign(size, left)) / curve, z)


def _power(law: Any) -> Array | None:
    """Return the exponents with which a Dahl bristle yields, if any is not 1; None of others."""
    made = getattr(law, "made_of", None)
    leaf = None if made is None else made.memory
    if leaf is None or leaf.part.name != "dahl":
        return None
    power = np.asarray(getattr(law, leaf.names.get("yield_exponent", "yield_exponent")))
    return None if np.all(power == 1.0) else power


def _rates(law: FrictionLaw, v: float, n: float, z: Array) -> Array:
    """Return the rates of states (b, copies)."""
    return np.stack([np.broadcast_to(rate, z.shape[1:]) for rate in law.rates(v, n, tuple(z))])


EXACT = 1e-6
"""Root mean square, over the size of the motion, that no step need take off: the solver's own."""
DAMPING = 1e-6
"""First damping of steps of initial states, over the largest eigenvalue of the normal equations;
at one over it nothing moves."""


Found = TypeVar("Found")


@dataclass(frozen=True)
class Known(Generic[Found]):
    """What was found, in place of what finds it."""

    found: Found
    """What was found."""

    def __call__(self) -> Found:
        """Return what was found."""
        return self.found


class Ways(NamedTuple):
    """What other initial states do: singular values of their slopes, in units of the motion."""

    columns: Array
    """Orthonormal (n, m): left singular vectors."""
    singular: Array
    """Singular values (m,)."""
    directions: Array
    """Right singular vectors, in rows (m, m)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LocalState:
    """One segment, linearised: what is needed to carry its initial state on.

    Steps of initial states are damped (Levenberg) in units of the motion: a velocity counts as the
    way that it makes in the length of the segment. In the units of its own effect, the initial
    velocity of a body that stays at rest would be moved without end: all it does is to shift where
    the body stops, by next to nothing, as the initial position does too.
    """

    state: Array
    """Initial coordinates and rates (m,)."""
    residual: Array
    """Measured less what is simulated from this very state (n,)."""
    size: float
    """Largest change of what was measured."""
    sense: Callable[[], Array]
    """Finds the slopes by the unknowns (n, p); asked for where they are needed."""
    units: Array
    """What initial coordinates and rates are counted in (m,)."""
    ways: Callable[[], Ways | None]
    """Finds what other initial states would do; None if that leaves all bounds. It is asked for
    where it is needed: of a state that fits worse than another, it is not."""
    damping: float = DAMPING
    """Over the largest singular value squared."""

    @property
    def slopes(self) -> Array:
        """Slopes by the unknowns (n, p)."""
        return self.sense()

    @property
    def able(self) -> bool:
        """Whether it is known what other initial states would do, so that steps can begin here."""
        return self.ways() is not None

    @property
    def known(self) -> Ways:
        """What they would do."""
        ways = self.ways()
        assert ways is not None
        return ways

    def __getstate__(self) -> dict[str, Any]:
        """Return what crosses processes: slopes that are found."""
        return {**self.__dict__, "sense": Known(self.slopes), "ways": Known(self.ways())}

    @property
    def misfit(self) -> float:
        """Sum of squares from this very state."""
        return float(self.residual @ self.residual)

    @property
    def basis(self) -> Array:
        """Orthonormal columns of what initial states can do (n, r)."""
        columns, singular, _ = self.known
        return columns[:, singular > NEGLIGIBLE * singular[0]]

    @property
    def settled(self) -> bool:
        """Whether another step promises next to nothing, or less than the solver is exact to."""
        columns, singular, _ = self.known
        kept = 1.0 - self._damped * singular
        promised = float(np.sum((columns.T @ self.residual) ** 2 * (1.0 - kept**2)))
        return promised <= max(SETTLED * self.misfit, self.exact)

    @property
    def exact(self) -> float:
        """Sum of squares that is the solver's own."""
        return len(self.residual) * (EXACT * self.size) ** 2

    @property
    def _damped(self) -> Array:
        """Inverse of the singular values (m,), damped."""
        singular = self.known.singular
        bottom = singular**2 + self.damping * singular[0] ** 2
        result: Array = singular / np.maximum(bottom, np.finfo(float).tiny)
        return result

    def near(self, change: Array | None = None) -> Array:
        """Return the initial state that fits better where the unknowns have changed by (p,)."""
        columns, _, directions = self.known
        wanted = columns.T @ self.expected(change)
        return self.state + self.units * (directions.T @ (self._damped * wanted))

    def expected(self, change: Array | None = None) -> Array:
        """Return the residual (n,) from this state, unknowns changed, to first order."""
        if change is None or not change.any():
            return self.residual
        return self.residual - self.slopes @ change

    def stepped(self, *, well: bool) -> "LocalState":
        """Return the segment with less damping if its last step went well, else with more."""
        damping = self.damping / 10.0 if well else self.damping * 100.0
        return replace(self, damping=min(damping, 1.0 / DAMPING))

    def projected(self, columns: Array) -> Array:
        """Return columns less what initial states can do."""
        return columns - self.basis @ (self.basis.T @ columns)


def settled(
    guess: Array,
    rest: Array,
    shoot: Callable[[Array], LocalState | None],
    *,
    at_rest: bool,
    rounds: int = ROUNDS,
) -> LocalState | None:
    """Return a segment from the initial state that fits it best; None if no run succeeds.

    `rest` is the guess with rates of 0, but those that are known.
    """
    first = shoot(guess)
    best = _descended(first, shoot, rounds) if first is not None and first.able else None
    return _or_at_rest(best, rest, shoot, rounds) if at_rest or best is None else best


def followed(
    before: LocalState,
    change: Array,
    rest: Array,
    shoot: Callable[[Array], LocalState | None],
    *,
    at_rest: bool,
    rounds: int = ROUNDS,
) -> LocalState | None:
    """Return a segment where the unknowns have changed by (p,): from a state carried on.

    Where that fits worse than the old state was promised to, or cannot be stepped from, the old
    state is tried as well.
    """
    moved, expected = shoot(before.near(change)), before.expected(change)
    tried = [] if moved is None else [(moved, True)]
    if moved is None or moved.misfit > float(expected @ expected) or not moved.able:
        stayed = shoot(before.state)
        tried += [] if stayed is None else [(stayed, False)]
    best = None
    for item, well in sorted(tried, key=lambda pair: pair[0].misfit):
        if item.able:
            best = _descended(
                replace(item, damping=before.damping).stepped(well=well), shoot, rounds
            )
            break
    return _or_at_rest(best, rest, shoot, rounds) if at_rest or best is None else best


def _or_at_rest(
    best: LocalState | None,
    rest: Array,
    shoot: Callable[[Array], LocalState | None],
    rounds: int,
) -> LocalState | None:
    """Return a segment from rest, unless an initial velocity fits it clearly better.

    Rest is not found downhill: a body that moves at first slides to where it is just stuck, and all
    that its velocity does is to shift that place.
    """
    half = len(rest) // 2
    if best is not None and np.array_equal(best.state[half:], rest[half:]):
        return best
    first = shoot(rest)
    if first is None or not first.able:
        return best
    rested = _descended(first, shoot, rounds)
    clearly = best is not None and best.misfit < (1.0 - AGREE) * rested.misfit
    return best if clearly else rested


def _descended(
    best: LocalState, shoot: Callable[[Array], LocalState | None], rounds: int
) -> LocalState:
    """Return a segment from the best state met on the way down.

    What is projected out of slopes is what a state can do to first order: it is true only of one
    from which there is next to nothing left to do.
    """
    for _ in range(rounds):
        if best.settled:
            break
        there = shoot(best.near())
        if there is None or there.misfit >= best.misfit or not there.able:
            if best.damping >= 1.0 / DAMPING:
                break
            best = best.stepped(well=False)
        else:
            best = replace(there, damping=best.damping).stepped(well=True)
    return best


# First deflections of bristles: what slip before a segment has built up.


BEFORE = 0.02
"""Share of a segment whose length times the first velocity is how far the body slipped before the
first sample of a record."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordedMotion:
    """The motion of a record between two gaps, and what it begins with."""

    record: int
    """Which record it is of."""
    path: Path
    """The motion, from the first sample on."""
    held: float = 0.0
    """Friction [N] that would balance all other forces on a body at rest at the first sample."""

    @classmethod
    def unknown(cls, record: int, start: float) -> "RecordedMotion":
        """Return the motion of which nothing is known but when it begins [s], under 1 N."""
        one = np.ones(1)
        path = Path(time=start * one, velocity=0.0 * one, load=one, travel=np.zeros(0))
        return cls(record=record, path=path)

    @property
    def start(self) -> float:
        """Time of the first sample [s]."""
        return float(self.path.time[0])

    def begun(self, velocity: float) -> "RecordedMotion":
        """Return the first sample alone, with another slip velocity [m/s]."""
        one = self.path
        first = replace(
            one,
            time=one.time[:1],
            velocity=np.array([velocity]),
            load=one.load[:1],
            travel=np.zeros(0),
            inputs={name: x[:1] for name, x in one.inputs.items()},
        )
        return replace(self, path=first)

    def covers(self, record: int, time: float) -> bool:
        """Return whether a time of a record is within the motion."""
        return self.record == record and self.path.time[0] <= time <= self.path.time[-1]

    def led_in(self, time: float) -> Path:
        """Return the path after some time [s] of slip at the first velocity."""
        one = self.path
        columns = one.time, one.velocity, one.load, *one.inputs.values()
        times, velocity, load, *inputs = (np.append(column[0], column) for column in columns)
        times[0] -= time
        return Path(
            time=times,
            velocity=velocity,
            load=load,
            travel=np.append(velocity[0] * time, one.travel),
            inputs=dict(zip(one.inputs, inputs, strict=True)),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class FirstDeflections:
    """Deflections with which the segments of a record begin, for a law at some values.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> law = Dahl(kinetic_coefficient=2.0, bristle_stiffness=1e4)
    >>> first = FirstDeflections(
    ...     law=law,
    ...     free_parameters=FreeParameters(()),
    ...     values=np.zeros(0),
    ...     motion=RecordedMotion.unknown(0, 0.0).begun(0.1),
    ...     starts=np.zeros(1),
    ...     length=1.0,
    ... )
    >>> first.states.round(7)  # of steady slip, in m
    array([[0.0002]])
    """

    law: FrictionLaw
    """Holds the parameters that are not looked for."""
    free_parameters: FreeParameters
    """What is looked for."""
    values: Array
    """Its values (p,) [SI]."""
    motion: RecordedMotion
    """The motion of the record."""
    starts: Array
    """Times (k,) [s] at which segments begin."""
    length: float
    """Length of segments [s], of which a share was slip before the first sample."""

    @cached_property
    def path(self) -> Path:
        """The motion that bristles are followed along."""
        return self.motion.led_in(BEFORE * self.length)

    @property
    def velocity_slopes(self) -> Array:
        """Slopes [s] of the states (k, b) by the first velocity."""
        velocity = float(self.motion.path.velocity[0])
        if velocity == 0.0:
            return np.full_like(self.states, BEFORE * self.length)
        moved = replace(self, motion=self.motion.begun((1.0 + MOVED) * velocity))
        return np.asarray((moved.states - self.states) / (MOVED * velocity))

    @cached_property
    def states(self) -> Array:
        """Deflections [m] at the starts (k, b)."""
        return self._at_starts(self._followed)[..., 0]

    @cached_property
    def slopes(self) -> Array:
        """Their slopes by the unknowns (k, b, p)."""
        law, moved, columns = self._moved()
        result = self._at_starts(self._along(law, 1 + len(moved)))
        table = np.zeros((*result.shape[:2], len(self.free_parameters)))
        table[..., columns] = (result[..., 1:] - result[..., :1]) / moved
        return np.nan_to_num(table)

    @cached_property
    def _followed(self) -> Array:
        """Deflections along the motion (b, n, 1)."""
        return self._along(vary(self.law, "friction", self._values()), 1)

    def _values(self) -> dict[str, float]:
        """Return values of the law's parameters that are looked for, by path."""
        pairs = zip(self.free_parameters.paths, self.values.tolist(), strict=True)
        return {path: x for path, x in pairs if path.startswith("friction.")}

    def _moved(self) -> tuple[Any, Array, list[int]]:
        """Return a law with arrays (1 + m,): in each copy but the first a parameter is moved.

        And by how much (m,), and which of the unknowns it is.
        """
        values, items = self._values(), self.free_parameters.items
        columns = [i for i, item in enumerate(items) if item.path in values]
        moved = MOVED * np.array([
            _size(values[items[i].path], items[i].start, items[i].high) for i in columns
        ])  # fmt: skip
        table = {path: np.full(1 + len(moved), x) for path, x in values.items()}
        for k, i in enumerate(columns):
            table[items[i].path][1 + k] += moved[k]
        return with_arrays(vary(self.law, "friction", values), table), moved, columns

    def _along(self, law: Any, copies: int) -> Array:
        """Return deflections along the motion (b, n, copies); 0 where they cannot be found."""
        bristles = len(self.law.states)
        first = np.zeros((bristles, copies))
        with np.errstate(all="ignore"):  # a law that fails far out is refused by its runs
            if self.path.velocity[0] == 0.0:  # at rest bristles balance the other forces
                first[:] = balancing(law, self.path, self.motion.held, bristles)
            return np.nan_to_num(follow(law, self.path, first))

    def _at_starts(self, states: Array) -> Array:
        """Return deflections at the starts (k, b, copies), straight between samples."""
        time = self.path.time
        at = np.clip(np.searchsorted(time, self.starts, side="right"), 1, len(time) - 1)
        share = (self.starts - time[at - 1]) / (time[at] - time[at - 1])
        share = np.clip(share, 0.0, 1.0)[:, None]
        result = states[:, at - 1] * (1.0 - share) + states[:, at] * share
        return np.asarray(result.transpose(1, 0, 2))


def _size(value: float, start: float, high: float) -> float:
    """Return the size that a parameter is moved by a share of; it may be 0 at a bound."""
    room = 1e-3 * high if np.isfinite(high) else 0.0
    return max(
        abs(value), abs(start) if value == 0.0 else 0.0, room if value == 0.0 else 0.0, 1e-12
    )
