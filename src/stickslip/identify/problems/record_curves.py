"""What draws of the posterior of records say: steady curves, and readings of other records."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.identify.own_laws import Slips, is_slope, slope_column
from stickslip.identify.posterior import Array, Column, Draws
from stickslip.identify.problems.record_columns import (
    RESOLVED,
    Balance,
    Memory,
    law_column,
    powers_of_load,
)
from stickslip.identify.problems.record_model import (
    BELOW,
    SCALES,
    STRETCHES,
    RecordModel,
    stretches,
)
from stickslip.identify.problems.record_rows import MIDDLE, BalanceRows

FARTHEST = 3.0
"""E-folds of speed beyond those resolved that count."""
NEARBY, FADES = 1.0 / 60.0, 1.0 / 24.0
"""Distance from places that were seen up to which what was learned of the place holds, and over
which it fades, over the range of positions."""
EVENLY = 400
"""Places over which the level is averaged."""
RESOLVED_ROWS = 20
"""Rows of a direction with a resolved speed that tell its range."""
STUDENT = 6.0
"""Degrees of freedom of the noise of readings."""
BRISTLES = ("others", "damping", "slow")
"""What bristles do beside their level, and levels while a turn is passed, which at rest says
nothing of what they can hold."""
AT_LEVEL = 1.25
"""Range of friction at rest in draws over its level, at which what is above it ends."""
COURSES = ("drift", "stretch", "zero")
"""What was learned as a course in time."""
BY_PLACE = {"place": "drift", "force": "zero"}
"""What was learned of places, and what as a course in time that looks alike."""
GOES_ON = 0.25
"""Prior probability that a course of friction goes on in a record that follows: warming does, but
what another joint did, or an edge of a fit, does not (on two of six splits of public records)."""
WARMING, ANY_CAUSE = 0.12, 0.5
"""Sizes of such a course over that of the friction: of warming, as in tables, and of what does not
go on, which may be as large as friction is. How large it is tells which it is."""
EITHER = 0.5
"""Prior probability that the course of a force beside friction goes on: no size tells which."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SteadyRows(Slips):
    """Steady sliding, whose inputs count from their means, over their standard deviations."""

    ratio: Array
    """Loads over the usual one (n,)."""
    transmitted: Array | float = 0.0
    """What the gear transmits over the ratio of loads (n,) [N]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OtherRows:
    """Rows of other records."""

    balance: Balance
    """They in motion or at rest, filtered as those fitted."""

    @property
    def rows(self) -> BalanceRows:
        """The rows at the middle cutoff."""
        return self.balance.rows(MIDDLE)

    @property
    def velocity(self) -> Array:
        """Velocities (n,) [m/s]."""
        return self.rows.velocity

    @property
    def response(self) -> Array:
        """What was measured there (n,) [N]."""
        return self.rows.response


def slips_of(balance: Balance, at: SteadyRows) -> Slips:
    """Return steady sliding as laws of any form take it."""
    through = np.asarray(at.transmitted) * at.ratio
    inputs = balance.frame.raw(at.inputs, balance.pieces[0].record, through)
    return Slips(velocity=at.velocity, load=at.load, inputs=inputs)


def steady_column(balance: Balance, column: Column, at: SteadyRows) -> Array:
    """Return the column of a term of a law in steady sliding (n,); (k, n) for shapes of k draws."""
    if is_slope(column[0]):
        return slope_column(column, slips_of(balance, at))
    return law_column(column, at.velocity, np.sign(at.velocity) * at.ratio, 0.0, at.transmitted)


def steady_curves(model: RecordModel, draws: Sequence[Draws], at: SteadyRows) -> Array:
    """Return steady friction, with what is constant (draws, n).

    It is that of the record fitted: in the mean over its rows in time, and its range of places.
    """
    frame, v, side = model.frame, at.velocity, np.sign(at.velocity)
    state, speed = side * at.ratio, np.abs(v) / frame.top
    hats = frame.hats(v)
    course = frame.course(model.balance.rows(MIDDLE).time).mean(axis=0)
    evenly = frame.begin + frame.span * np.linspace(0.0, 1.0, EVENLY)
    place = frame.places(evenly, model.balance.waves[1]).mean(axis=0)
    count = len(course)
    result = []
    for draw in draws:
        plain = model.split(draw.node, draw.random)
        f = np.zeros((draw.random.shape[1], len(v)))
        for column, c in zip(draw.structure, draw.law, strict=True):
            f += np.outer(c, steady_column(model.balance, column, at))
        level = place @ plain["place"] + course @ plain["drift"][:count]
        level += _mean(plain["stretch"], 0)
        slope = course @ plain["drift"][count:] + _mean(plain["stretch"], 1)
        if "run" in plain:
            level, slope = level + _mean(plain["run"], 0), slope + _mean(plain["run"], 1)
        f += state * (hats @ plain["common"]).T + np.outer(level, state)
        f += np.outer(slope, side * speed)
        for name, u in at.inputs.items():
            f += np.outer(plain[f"level*{name}"][0], state * u)
            f += np.outer(plain[f"viscous*{name}"][0], side * speed * u)
        if "load" in plain:
            f += (state[:, None] * powers_of_load(at.ratio) @ plain["load"]).T
        if "sides" in plain:
            f += at.ratio * (hats @ plain["sides"]).T + plain["offset"].T
            f += np.outer(plain["side"], speed)
        result.append(f)
    return np.concatenate(result)


def _mean(x: Array, half: int) -> Array:
    """Return the mean of the levels, or the slopes, of parts (k,)."""
    return np.asarray(x.reshape(2, -1, x.shape[1])[half].mean(axis=0))


def rms(x: Array) -> Array:
    """Return root mean squares of columns (n, k) as (k,)."""
    return np.asarray(np.sqrt(np.mean(x * x, axis=0)))


def _numbers(draws: Sequence[Draws]) -> list[int]:
    return [draw.random.shape[1] for draw in draws]


def beyond(model: RecordModel, draws: Sequence[Draws], at: SteadyRows) -> Array:
    """Return what friction may do at speeds that were not resolved (draws, n)."""
    rng = np.random.default_rng(5)
    moved = far_from(model, at.velocity) * BELOW * model.size * np.sign(at.velocity)
    return np.asarray(rng.normal(size=(sum(_numbers(draws)), 1)) * moved)


def far_from(model: RecordModel, velocity: Array) -> Array:
    """Return by how many e-folds speeds are beyond those resolved (n,)."""
    frame = model.frame
    u = np.log(np.maximum(np.abs(velocity), frame.least))
    below, above = math.log(frame.low) - u, u - math.log(frame.top)
    return np.asarray(np.minimum(np.maximum(below, 0.0) + np.maximum(above, 0.0), FARTHEST))


def run_sizes(model: RecordModel, draws: Sequence[Draws], rng: np.random.Generator) -> Array:
    """Return how much another run differs (draws, 1): as those fitted do, or as runs usually do."""
    if "run" in model.names:
        each = [model.at(draw.node, "run") for draw in draws]
        return np.repeat(each, _numbers(draws))[:, None] * model.size
    sizes, shares = SCALES["run of a joint" if model.balance.pieces[0].record.joint else "run"]
    return np.asarray(rng.choice(sizes, p=shares, size=(sum(_numbers(draws)), 1)) * model.size)


def of_another_run(model: RecordModel, draws: Sequence[Draws], at: SteadyRows) -> Array:
    """Return what another run adds (draws, n): to the level, and to the slope."""
    rng = np.random.default_rng(7)
    sizes, side = run_sizes(model, draws, rng), np.sign(at.velocity)
    level, slope = (sizes * rng.normal(size=sizes.shape) for _ in range(2))
    return np.asarray(level * side * at.ratio + slope * at.velocity / model.frame.top)


def readings(
    model: RecordModel, draws: Sequence[Draws], other: OtherRows, *, seed: int = 0
) -> Array:
    """Return draws of the readings of other records (draws, n).

    They are those of another run, whose level and slope differ by what runs differ; what was
    learned of places holds where they were seen. At rest friction is what holds the coordinate: it
    is drawn between the levels of both directions.
    """
    rows = other.rows
    if not rows.count:
        return np.zeros((sum(_numbers(draws)), 0))
    rng = np.random.default_rng([seed, 11])
    fixed = other.balance.fixed(MIDDLE)
    fixed.pop("slope")
    maker = _Readings(model, other.balance, rng)
    result = np.concatenate([maker.of(draw, fixed) for draw in draws])
    noise = model.noises[MIDDLE]
    size = noise.deviations[model.classes(other.balance, MIDDLE, noise)]
    more = np.zeros(rows.count)
    if not model.balance.measured:  # the sensors may be noisier there, or have spikes
        own = np.mean(model.balance.rows(MIDDLE).sensed(model.inertia) ** 2)
        more = np.sqrt(np.maximum(rows.sensed(model.inertia) ** 2 - own, 0.0))
    tail = rng.standard_t(STUDENT, size=result.shape) * math.sqrt((STUDENT - 2.0) / STUDENT)
    factors = np.repeat([model.at(draw.node, "noise") for draw in draws], _numbers(draws))
    sizes = np.hypot(factors[:, None] * size * float(noise.pieces.max()), more)
    return np.asarray(result + sizes * tail)


def going_on(size: Array) -> Array:
    """Return the probability that courses of a size over that of the friction (k,) go on.

    Examples
    --------
    >>> going_on(np.array([0.0, 0.1, 0.2, 0.5])).round(2).tolist()
    [0.58, 0.5, 0.27, 0.0]
    """
    precision = WARMING**-2 - ANY_CAUSE**-2
    odds = ANY_CAUSE / WARMING * np.exp(-0.5 * precision * size**2) * GOES_ON / (1.0 - GOES_ON)
    return np.asarray(odds / (1.0 + odds))


class _Readings:
    """Draws of the readings of other records, one structure at one node at a time.

    What was learned of the law and of inputs holds there. What was learned as a course in time is
    that of the record fitted: another has another, as large as that learned, which may go on from
    the end of the record fitted where it follows that in time, and as warming does if it is as
    small. What was learned of places holds where they were seen, but for the share that changes in
    time have: so much may have been one.
    """

    def __init__(self, model: RecordModel, other: Balance, rng: np.random.Generator) -> None:
        self.model, self.other, self.rng = model, other, rng
        self.rests = other.rests
        self.rows, frame = other.rows(MIDDLE), model.frame
        self.pulses = other.pulses(MIDDLE)
        own = model.balance.rows(MIDDLE)
        seen = np.sort(own.position)
        at = np.clip(np.searchsorted(seen, self.rows.position), 1, len(seen) - 1)
        distance = np.minimum(
            np.abs(self.rows.position - seen[at]), np.abs(self.rows.position - seen[at - 1])
        )
        gap = np.maximum(distance / frame.span - NEARBY, 0.0) / FADES
        self.near = np.exp(-0.5 * gap**2)
        self.far = far_from(model, self.rows.velocity)
        ends = frame.start + frame.duration
        begins = float(self.rows.time.min())
        self.after = begins >= ends - 0.02 * frame.duration
        self.course = frame.course(frame.start + self.rows.time - begins)
        """Course in time of another record (n, p)."""
        self.first, self.last = frame.course(np.array([frame.start, ends]))
        self.parts = stretches(self.rows.count)
        self.seen: dict[int, tuple[dict[str, Array], Array]] = {}

    def columns(self, memory: int) -> tuple[dict[str, Array], Array]:
        """Return the columns with a bristle."""
        if memory not in self.seen:
            bristle = Memory() if self.rests else self.model.memories[memory]
            self.seen[memory] = self.other.columns(MIDDLE, bristle, self.model.columns)
        return self.seen[memory]

    def of(self, one: Draws, fixed: dict[str, Array]) -> Array:
        """Return the readings of draws (k, n), without noise."""
        model, rng, node = self.model, self.rng, one.node
        count, size = one.random.shape[1], model.size
        groups, x = self.columns(node[-2])
        plain = model.split(node, one.random)
        at = [model.columns.index(column) for column in one.structure]
        f = (x[:, at] @ one.law).T
        f += self.rows.response - self.other.response(MIDDLE, model.acting(node))
        beside = self.in_time(plain["zero"], EITHER)
        every = {**groups, **fixed}
        z, slope = groups["state"][:, 0], self.other.slope(MIDDLE)
        for name, b in plain.items():
            if name in (*COURSES, "turn", "run") or (self.rests and name in BRISTLES):
                continue
            if name not in every:  # a part of the mechanism that the other record is without
                continue
            columns = every[name]
            learned = (columns @ b).T
            if name in BY_PLACE:
                new = (columns @ (rms(b) * rng.normal(size=b.shape))).T
                in_time = np.sum(plain[BY_PLACE[name]] ** 2, axis=0)
                of_place = rng.uniform(size=count) > in_time / (in_time + np.sum(b * b, axis=0))
                near = of_place[:, None] * self.near
                learned = near * learned + np.sqrt(1.0 - near**2) * new
            if name in (*fixed, "sides"):
                beside += learned
            else:
                f += learned
        courses = plain["drift"].reshape(2, -1, count)
        level, tilt = (
            _mean(plain["stretch"], half)[:, None]
            + self.in_time(courses[half], going_on(self.last @ courses[half] / size))
            + (rms(plain["stretch"]) * rng.normal(size=(STRETCHES, count))).T[:, self.parts]
            for half in (0, 1)
        )
        runs = run_sizes(model, [one], rng)
        level = level + runs * rng.normal(size=(count, 1))
        tilt = tilt + runs * rng.normal(size=(count, 1))
        level = level + self.far * BELOW * size * rng.normal(size=(count, 1))
        if "offset" in plain:
            beside = beside + runs * rng.normal(size=(count, 1))
        beside = beside + self.doubtful(plain, fixed, count)
        f += level * z + tilt * slope
        f += self.beyond_inputs(plain, z)
        if self.rests:  # one in ten draws is at each level, so that the band has them both
            share = np.clip(AT_LEVEL * rng.uniform(-1.0, 1.0, size=(count, 1)), -1.0, 1.0)
            return np.asarray(beside + share * f)
        f += beside
        if self.pulses.shape[1] and "turn" in model.names:
            turned = model.at(node, "turn") * size * rng.normal(size=(count, self.pulses.shape[1]))
            f += turned @ self.pulses.T
        return f

    def doubtful(self, plain: Mapping[str, Array], fixed: Mapping[str, Array], count: int) -> Array:
        """Return what parameters of the other record alone change (k, n)."""
        rng, result = self.rng, np.zeros((count, self.rows.count))
        of = self.other.run[self.rows.piece][:, None] == np.arange(self.other.runs)
        for path, unknown in self.other.pieces[0].record.unknown.items():
            if path not in plain:
                new = unknown.doubt * rng.normal(size=(count, self.other.runs))
                result += new @ (fixed[path] * of).T
        return result

    def in_time(self, learned: Array, likely: Array | float) -> Array:
        """Return another course in time (k, n), as large as that with coefficients (p, k).

        That goes on with a probability (k,).
        """
        new = rms(learned) * self.rng.normal(size=learned.shape)
        result = (self.course @ new).T
        if self.after:
            goes_on = self.rng.uniform(size=learned.shape[1]) < likely
            result += (goes_on * (self.last @ learned - self.first @ new))[:, None]
        return np.asarray(result)

    def beyond_inputs(self, plain: dict[str, Array], z: Array) -> Array:
        """Return what inputs beyond their range may change (k, n): by as much as within it."""
        model, rows = self.model, self.rows
        result = np.zeros((plain["stretch"].shape[1], rows.count))
        for name in model.frame.inputs:
            own = model.balance.rows(MIDDLE)
            seen = own.taken([model.balance.input(p, name) for p in model.balance.pieces])
            x = rows.taken([self.other.input(p, name) for p in self.other.pieces])
            out = np.maximum(x - seen.max(), 0.0) + np.minimum(x - seen.min(), 0.0)
            result += self.rng.normal(size=(len(result), 1)) * plain[f"level*{name}"].T * (out * z)
        return result


def resolved_speeds(model: RecordModel, count: int) -> Array:
    """Return velocities (n,) that were resolved in each direction that was moved in.

    Where no speed is resolved, they are those of the rows.
    """
    frame, rows = model.frame, model.balance.rows(MIDDLE)
    grids = []
    for side in frame.sides:
        moved = side * rows.velocity
        own = moved[(moved > 0.0) & (rows.far > RESOLVED)]
        own = own if len(own) > RESOLVED_ROWS else moved[moved > 0.0]
        if not len(own):
            continue
        low = max(frame.low, rows.slowest(own, 0.03))
        top = max(float(np.quantile(own, 0.98)), 1.01 * low)
        grids.append(side * np.geomspace(low, top, count))
    return np.sort(np.concatenate(grids))
