r"""The balance of a free motion: families of laws, and values from which their runs begin.

What friction has taken until some rows is what the energy lost, or the momentum where the motion
goes on in one direction,

.. math::
    E_0 - E(q_j, v_j) = \sum_t c_t \int_0^{t_j} g_t(|v|)\,|v|\, dt , \qquad
    J (v_0 - v_j)\, s = \sum_t c_t \int_0^{t_j} g_t(|v|)\, dt ,

with what known forces gave added. Rows of the energy are turns, where no velocity comes in; without
turns, and of the momentum, means over parts of the record. Least squares over all families and
shapes weigh them; a length or stiffness that is off is not in it, which is why runs follow.
"""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.optimize import lsq_linear
from scipy.signal import butter, sosfiltfilt

from stickslip.errors import InputError
from stickslip.identify.posterior import Array
from stickslip.identify.problems.free_runs import (
    FreeMotion,
    Motion,
    Term,
    Unseen,
)
from stickslip.identify.problems.record_rows import MOST_ROWS
from stickslip.identify.problems.record_signals import Record, noise_of
from stickslip.identify.vocabulary import PARTS, Grid
from stickslip.mechanisms import Mechanism, motor_of
from stickslip.quantities import parameters

Places = NDArray[np.intp]
PARTS_OF_RECORD = 120
"""Parts of a record whose means are rows."""
FEWEST_TURNS = 8
"""Turns from which they are the rows."""
AROUND = 1.0 / 7.0
"""Part of the time between turns, to each side of one, through which a parabola is laid."""
BEGUN = 9
"""Samples from which the start of a motion is guessed, at most."""
CUTOFF = 6.0
"""Cutoff of velocities [1/steps between turns or parts]: they only weigh what friction takes."""
SEEN = (0.04, 0.98)
"""Quantiles of the speed between which it was seen: by time where that tells friction, else by the
way, along which friction works."""
KNOWN_SPEED = 3.0
"""Part of the slowest seen speed down to which what no law says is free."""
GAINED = 10.0
"""What a motion gains over the noise of that, from which something drives it."""
TURNED = 0.1
"""Way back over the range up to which a motion goes on in one direction."""
RESTED = 5.0
"""Noise of the place by which a body moves that has not come to rest."""
RESTING = 50
"""Parts of a record, of which a body rests in one at least."""
SOUGHT = 0.5
"""Deviation of the logarithm of what is sought of a mechanism, about what a plain balance says."""
UNSEEN = ("length", "stiffness")
"""Parameters of a mechanism that no balance of a free motion sees, the first that it has."""


def free_form(records: Sequence[Record]) -> str:
    """Return how a free motion is integrated: its momentum where it goes on, else its work.

    It goes on where it turns back by little of its way.
    """
    if any(
        np.any(record.force != -record.constant) or record.friction or record.driven
        for record in records
    ):
        return ""
    return "momentum" if goes_on(records) else "work"


def goes_on(records: Sequence[Record]) -> bool:
    """Return whether motions turn back by no more than little of their way."""
    ways = [(record.position, float(np.ptp(record.position)) + 1e-300) for record in records]
    back = [
        min(float(np.max(np.maximum.accumulate(q) - q)) for q in (x, -x)) / size for x, size in ways
    ]
    return max(back) < TURNED


def before_rest(record: Record) -> Record:
    """Return a free motion until the body rests for good, which tells nothing of sliding.

    The level of a law would act on, by the time or by the noise of the place.
    """
    x, least = record.velocity, max(len(record.time) // RESTING, 3)
    if record.located:
        x = record.position - np.median(record.position[-least:])
    assert x is not None
    # the quietest parts of a short record have less noise than it has
    last = float(np.std(np.diff(x[-max(len(x) // 4, 8) :], 3))) / math.sqrt(20.0)
    moving = np.flatnonzero(np.abs(x) > RESTED * max(noise_of(x), last))
    end = int(moving[-1]) + 1 if len(moving) else len(x)
    return record if len(x) - end < least else record.on(record.time[:end])


@dataclass(frozen=True, eq=False)
class FreeRecord:
    """The balance of one record of a free motion."""

    record: Record
    form: str
    """``"work"`` or ``"momentum"``."""

    @property
    def mechanism(self) -> Mechanism:
        """What moves, with what is given of it."""
        assert self.record.rig is not None
        return self.record.rig

    @property
    def step(self) -> float:
        """Time between samples [s]."""
        return float(np.median(np.diff(self.record.time)))

    @cached_property
    def velocity(self) -> Array:
        """Velocities (n,), smoothed."""
        x, h = self.record.position, self.step
        if self.record.velocity is not None:
            return self._smooth(self.record.velocity)
        return np.asarray(np.gradient(self._smooth(x), h))

    def _smooth(self, x: Array) -> Array:
        swings = len(crossings(self.record.position - np.median(self.record.position)))
        cutoff = CUTOFF * max(swings, 8.0) / len(x)
        if cutoff >= 0.5 or len(x) < 40:
            return x
        return np.asarray(sosfiltfilt(butter(4, 2.0 * cutoff, output="sos"), x))

    @cached_property
    def around(self) -> int:
        """Samples to each side of a turn through which a parabola is laid."""
        return max(round(AROUND * len(self.velocity) / (len(crossings(self.velocity)) + 1.0)), 1)

    @cached_property
    def turns(self) -> tuple[Places, Array, Array]:
        """Rows (t,), times and positions of the turns, by parabolas."""
        v, x, m = self.velocity, self.record.position, self.around
        at = crossings(v)
        at = at[(at > 2 * m) & (at < len(v) - 2 * m)]
        at = at[np.diff(at, prepend=-len(v)) > 2 * m]
        around = np.arange(-m, m + 1)
        laid = np.linalg.pinv(np.vander(around, 3, increasing=True))
        c = np.array([laid @ x[k - m : k + m + 1] for k in at]).reshape(-1, 3)
        bend = np.where(c[:, 2] == 0.0, 1.0, c[:, 2])
        return at, self.record.time[at], c[:, 0] - c[:, 1] ** 2 / (4.0 * bend)

    def _energies(self, q: Array, v: Array) -> Array:
        name = self.mechanism.coordinates[0]
        own = defaultdict[str, Any](float, {name: q})
        kinetic = self.mechanism.kinetic_energy(own, defaultdict[str, Any](float, {name: v}))
        return np.asarray(kinetic + self.mechanism.potential_energy(0.0, own) + 0.0 * q)

    @cached_property
    def _given(self) -> Array:
        """Known forces along the motion but those of a potential (n,)."""
        name, q = self.mechanism.coordinates[0], self.record.position
        none = dict.fromkeys(self.mechanism.drives(), 0.0)
        place, rate = (defaultdict[str, Any](float, {name: x}) for x in (q, self.velocity))
        forces = self.mechanism.forces(0.0, place, rate, none)
        return np.asarray(forces.get(name, 0.0) + 0.0 * q)

    def _summed(self, x: Array) -> Array:
        return np.asarray(np.cumsum(x) * self.step)

    @cached_property
    def is_at_turns(self) -> bool:
        """Whether the rows are turns."""
        return self.form == "work" and len(self.turns[0]) >= FEWEST_TURNS

    def rows(self, x: Array) -> Array:
        """Return values (n,) at the rows."""
        if self.is_at_turns:
            return np.asarray(x[self.turns[0]])
        parts = np.array_split(x, min(PARTS_OF_RECORD, len(x) // 4))
        return np.array([float(np.mean(part)) for part in parts])

    @cached_property
    def response(self) -> Array:
        """What friction has taken less a constant, at the rows."""
        v, q = self.velocity, self.record.position
        if self.form == "momentum":
            side = math.copysign(1.0, float(np.median(v)))
            momentum = 2.0 * self._energies(q, np.ones_like(q)) - 2.0 * self._energies(q, 0.0 * q)
            speed = self.record.velocity if self.record.velocity is not None else v
            return self.rows(side * (self._summed(self._given) - momentum * speed))
        given = self._summed(self._given * v)
        if self.is_at_turns:
            top = self.turns[2]
            return self.rows(given) - self._energies(top, 0.0 * top)
        return self.rows(given - self._energies(q, v))

    @cached_property
    def slope(self) -> Array:
        """Change of the energy with the place, at the turns: by it a zero that is off is seen."""
        top = self.turns[2]
        bend = 1e-4 * float(np.ptp(top)) + 1e-12
        change = self._energies(top + bend, 0.0 * top) - self._energies(top - bend, 0.0 * top)
        return np.asarray(0.5 * change / bend)

    @cached_property
    def noise(self) -> Array:
        """Standard deviation of the response by noise of the readings, at the rows."""
        one, h = self.record, self.step
        seen = one.position if one.velocity is None else one.velocity
        e = max(float(np.std(np.diff(seen, 3))) / math.sqrt(20.0), 1e-9 * float(np.ptp(seen)))
        if self.is_at_turns:
            top = 1.5 * e / math.sqrt(2.0 * self.around + 1.0)
            return np.asarray(np.abs(self.slope) * top + 1e-9 * np.ptp(self.response))
        v, count = self.velocity, len(one.time) / len(self.rows(one.time))
        moved = self._energies(one.position, np.ones_like(v)) * 2.0
        rate = e if one.velocity is not None else e / (h * math.sqrt(count))
        of = np.abs(v) if self.form == "work" else np.ones_like(v)
        return self.rows(np.abs(moved) * of * rate / math.sqrt(count)) + 1e-9 * np.ptp(
            self.response
        )

    def taken(self, curve: Array) -> Array:
        """Return what a friction curve along the record (n,) takes until the rows."""
        return self.rows(
            self._summed(curve * (1.0 if self.form == "momentum" else np.abs(self.velocity)))
        )


def crossings(x: Array) -> Places:
    """Return the samples before which values change their sign."""
    return np.flatnonzero((x[:-1] < 0.0) != (x[1:] < 0.0))


class FreeBalance:
    """The balances of all records of a free motion, with the families that they weigh."""

    def __init__(self, records: Sequence[Record], form: str) -> None:
        self.each = [FreeRecord(record, form) for record in records]
        self.speed = np.abs(np.concatenate([item.velocity for item in self.each]))
        self.goes_on = form == "momentum"
        slowest, fastest = self.passed(np.array(SEEN)).tolist()
        self.slowest, self.fastest = max(slowest, 1e-4 * fastest), fastest
        self.dim = self.slowest / (KNOWN_SPEED if self.goes_on else 1.0)
        self.refuse_gain()
        self.y = np.concatenate([item.response / item.noise for item in self.each])
        ones = [1.0 / item.noise for item in self.each]
        zeros = [x.slope / x.noise if x.is_at_turns else 0.0 * x.noise for x in self.each]
        self.base = np.hstack([block_diag(*(item[:, None] for item in x)) for x in (ones, zeros)])

    def passed(self, parts: Array) -> Array:
        """Return the speeds (n,) below which friction does parts of its work, or acts, (n,)."""
        speed = np.sort(self.speed)
        path = np.cumsum(np.ones_like(speed) if self.goes_on else speed)
        return np.asarray(speed[np.searchsorted(path, path[-1] * parts)])

    def column(self, name: str) -> Array:
        """Return what a part of a law takes until the rows, over their noise."""
        curves = [PARTS[name].curve(np.abs(item.velocity), ()) for item in self.each]
        taken = [item.taken(c) / item.noise for item, c in zip(self.each, curves, strict=True)]
        return np.concatenate(taken)

    @cached_property
    def fixed(self) -> tuple[Term, ...]:
        """The curve that what no law says multiplies: level, viscous friction and drag."""
        names = ["level", "viscous", "drag"]
        columns = [self.column(name) for name in names]
        curves = [PARTS[name].curve(self.speed, ()) + 0.0 * self.speed for name in names]
        size = np.sqrt(np.mean(np.square(curves), axis=1))
        x = np.column_stack([self.base, *columns])
        norm = np.linalg.norm(x, axis=0) + 1e-300
        least = np.where(np.arange(x.shape[1]) < self.base.shape[1], -np.inf, 0.0)
        c = lsq_linear(x / norm, self.y, (least, np.inf), method="bvls").x[-3:] / norm[-3:]
        total = float(np.sum(c * size)) or self._least
        c[0] += 0.02 * total
        return tuple(Term(part=n, coefficient=float(x)) for n, x in zip(names, c, strict=True))

    @property
    def _least(self) -> float:
        """Friction that takes no more than the noise of a row in all of the record [N]."""
        ways = [float(np.ptp(item.taken(np.ones_like(item.velocity)))) for item in self.each]
        return float(np.median(self.each[0].noise)) / max(*ways, 1e-300)

    def refuse_gain(self) -> None:
        """Refuse motions that gain energy, or momentum, which friction only takes."""
        for item in self.each:
            gained = float(item.response[0] - item.response[-1])
            if item.is_at_turns and not np.any(item.slope):
                why = "turns back although no spring and no weight of the mechanism pulls it back"
            elif gained > GAINED * math.hypot(item.noise[0], item.noise[-1]):
                what = "momentum" if self.goes_on else "energy"
                why = f"gains {what}, which friction only takes"
            else:
                continue
            raise InputError(
                f"the motion {why}: something drives it. Give the force, or the incline, constant"
                " force (offset), stiffness or length of the mechanism, or leave the part out in"
                " which it is driven."
            )

    @cached_property
    def size(self) -> float:
        """Root mean square of the friction along the records [N]."""
        friction = sum(item.at(self.speed) for item in self.fixed)
        return math.sqrt(float(np.mean(friction**2)))

    @cached_property
    def grid(self) -> Grid:
        """Shapes of parts for the speeds that were seen."""
        return Grid(slowest=self.slowest, fastest=self.fastest, fine=2.0)

    @property
    def motions(self) -> list[Motion]:
        """The records as runs follow them."""
        return [motion_of(item) for item in self.each]

    @cached_property
    def side(self) -> float:
        """Sign of the velocity; 1 where it has both."""
        middle = float(np.median(np.concatenate([item.velocity for item in self.each])))
        return -1.0 if self.goes_on and middle < 0.0 else 1.0

    def motion(self, unseen: Sequence[Unseen], load: float) -> FreeMotion:
        """Return the motions as runs follow them, with what no balance sees of the mechanism."""
        return FreeMotion(
            motions=self.motions,
            size=self.size,
            slowest=self.slowest / KNOWN_SPEED,
            fastest=self.fastest,
            fixed=self.fixed,
            unseen=tuple(unseen),
            dim=self.dim,
            side=self.side,
            load=load,
        )


def unseen_of(
    mechanism: Mechanism, sought: Sequence[str], deviations: Mapping[str, float]
) -> list[Unseen]:
    """Return the parameters that runs look for, by the paths of those that are sought.

    Deviations are those that were stated, by path. Without any of these it is the first of `UNSEEN`
    that the mechanism has.
    """
    values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    result = [Unseen(path=path, value=values[path], deviation=SOUGHT) for path in sought]
    result += [
        Unseen(path=path, value=values[path], deviation=x / abs(values[path]))
        for path, x in deviations.items()
        if values.get(path)
    ]
    known = {item.path for item in result}
    usual = [f"mechanism.{name}" for name in UNSEEN if values.get(f"mechanism.{name}", 0.0) > 0.0]
    if usual and not known & {*usual} and not sought:
        result.append(Unseen(path=usual[0], value=values[usual[0]]))
    return result


def balanced(records: Sequence[Record], form: str, inertia: str) -> dict[str, float]:
    """Return the value of each parameter that is sought, by the forces along the motion.

    They are those of a plain balance with a level and viscous friction, by least squares. `inertia`
    is the path of that which is an inertia and nothing else.
    """
    rows, left = list[Array](), list[Array]()
    for record in records:
        own = FreeRecord(record, form)
        v = own.velocity
        a = np.gradient(v, own.step)
        known = 0.0 * v if record.mechanism is None else record.mechanism
        columns = [np.sign(v), v, *(x.inertia * a - x.force for x in record.unknown.values())]
        if record.inertia is None:
            columns.append(a)
        inside = slice(len(v) // 50 + 2, -len(v) // 50 - 2)
        rows.append(np.column_stack(columns)[inside])
        left.append((record.force + known - (record.inertia or 0.0) * a)[inside])
    x, y = np.concatenate(rows), np.concatenate(left)
    size = np.sqrt(np.mean(x * x, axis=0)) + 1e-300
    c = np.linalg.lstsq(x / size, y, rcond=1e-9)[0] / size
    result = {path: item.given for path, item in records[0].unknown.items()}
    changes = dict(zip([*result, inertia], c[2:].tolist(), strict=False))
    return {path: result.get(path, 0.0) + change for path, change in changes.items()}


def undriven(mechanism: Mechanism) -> Mechanism:
    """Return a mechanism without the drive of its own, which did not act where it moves freely.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms.drives import Sine
    >>> undriven(Axis(inertia=1.0, drive=Sine(amplitude=2.0, frequency=4.0))).drive is None
    True
    """
    own = (
        hasattr(mechanism, "drive") and mechanism.drives() and motor_of(mechanism) is None
    )  # a motor brakes as it turns
    return replace(cast("Any", mechanism), drive=None) if own else mechanism


def motion_of(balance: FreeRecord) -> Motion:
    """Return a record as runs follow it."""
    one, every = balance.record, math.ceil(len(balance.record.time) / MOST_ROWS)
    time, count = one.time - one.time[0], min(BEGUN, 2 * balance.around + 1)
    laid = np.polynomial.polynomial.polyfit(time[:count], one.position[:count], min(2, count - 1))
    start = float(laid[0]), float(laid[1])
    if not one.located:
        assert one.velocity is not None
        start = float(one.position[0]), float(np.mean(one.velocity[:3]))
    values = one.position if one.located or one.velocity is None else one.velocity
    return Motion(
        mechanism=undriven(balance.mechanism),
        time=time[::every],
        values=values[::every],
        start=start,
        located=one.located,
        turns=balance.turns[1] - one.time[0] if balance.form == "work" else np.zeros(0),
    )
