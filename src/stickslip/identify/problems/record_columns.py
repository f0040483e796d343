r"""Columns of the force balance of one coordinate: laws, and what every record may have.

At the samples, with the state :math:`z` of a bristle of length :math:`r` along the way, the
direction where :math:`r = 0`, a level :math:`g` that depends on speed lags as in LuGre friction:

.. math:: \frac{dL}{dx} = \frac{\operatorname{sgn}(dx)\, g(v) - L}{r(v)} ,
          \qquad r(v) = r_0\, g(v) / g(v_0) ,

which is one triangular system with two diagonals for all levels. Bristles of other exponents, of
which 0 yields at once, have :math:`z\,g(v)`. The filter then makes rows of all columns.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.linalg import lapack

from stickslip.errors import InputError
from stickslip.identify.forces import TRANSMITTED
from stickslip.identify.own_laws import Slips, Slope, is_dry, is_slope, slope_column
from stickslip.identify.posterior import Array, Column
from stickslip.identify.problems.record_rows import (
    AS_RECORDED,
    MIDDLE,
    RESTS,
    SHORT,
    Acting,
    BalanceRows,
    Piece,
    by_best_sensor,
    checked,
    pieces_of,
)
from stickslip.identify.problems.record_signals import Record, bristle
from stickslip.identify.vocabulary import DRY, GEAR, PARTS
from stickslip.maths import Scalar

LEVELS = DRY | {GEAR}
"""Terms that lag with the bristle."""
FORCE = "force"
"""Part of what an input changes that is no friction."""
WIDER = 2.0
"""Band of what a gear transmits, over that of the rows."""
VARIES = 0.05
"""Standard deviation over the mean of what a gear transmits, from which friction may show it."""
OTHERS = (0.16, 0.25, 0.4, 0.63, 1.0, 1.6, 2.5, 4.0, 6.3)
"""Lengths of further bristles, over that of the law: so near that their sums follow how a surface
of any kind yields."""
TOGETHER = 10
"""Number of their columns for which sizes are stated: of more, each is smaller, so that their sum
stays as large."""
COSINES, CURVED = 12, 4.0
"""Cosines over the place, and the number from which on they are smaller."""
COURSE = 5
"""Columns of a drift: a line and cosines."""
TURNS = 60
"""Turns that have a pulse, at most: those with the largest accelerations."""
PULSE = 6.0
"""Reach of the pulse of a turn, over 1/cutoff."""
RESOLVED = 1.2
"""Distance to a turn or a rest from which on a speed is resolved, over 1/cutoff."""
PASSED = 2.0
"""Slowest speed over that which is passed in the moment of a turn, which tells no smoothness."""
DECADES = 300.0
"""Largest speed over the smallest that has a knot of its own, at most."""
KNOTS = 2.5
"""Knots of the curve for each e-fold of speed."""
AT_ONCE = 64
"""Columns that are filtered at once, which bounds the memory."""
ZERO = "zero."
"""Beginning of the paths of zeros of positions, of which no record is without."""
SAME_SPAN = 0.01
"""Part of a column outside another from which they are told apart."""
TINY = 1e-300
LUGRE = -1.0
"""Exponent that stands for a length that follows the level."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Memory:
    """A bristle: its length and how it yields."""

    length: float = 0.0
    """Way along which it yields [m]; 0 if at once."""
    exponent: float = 1.0
    """That of Dahl's law, 0 if it yields at once after its length; `LUGRE` if that follows."""
    ratio: Array | None = None
    """Length over `length` at the knots of speed (k,)."""
    speed: float = 0.0
    """Speed at which it has `length` [m/s]."""
    spread: float = 0.0
    """Standard deviation of the logarithm of lengths for which it stands."""

    @property
    def lags(self) -> bool:
        """Whether levels follow it by a linear equation along the way; else they are times it."""
        return self.exponent in (1.0, LUGRE)


RIGID = Memory()
"""No bristle: friction turns at once."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RecordFrame:
    """What columns are scaled by: that of the records fitted, for all rows."""

    top: float
    """Speed that one in two hundred of the resolved rows exceeds [m/s]."""
    low: float
    """Slowest speed that is resolved [m/s]."""
    least: float
    """Slowest speed of laws [m/s]."""
    shaped: float
    """Slowest speed at which laws may bend [m/s]: slower ones are passed in a moment of a turn."""
    knots: Array
    """Logarithms of speeds (k,)."""
    begin: float
    span: float
    """Least position and the range of positions [m]."""
    start: float
    duration: float
    """First time and the range of times [s]."""
    noise: float
    """Standard deviation of the noise of positions [m]."""
    load: float
    """Geometric mean of the load [N]; 1 where it does not change."""
    inputs: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Means and standard deviations of inputs that change."""
    transmitted: tuple[float, ...] = ()
    """Tenth, median and ninetieth percentile of what the gear transmits [N], where it changes."""
    sides: tuple[float, ...] = (-1.0, 1.0)
    """Directions that were seen."""

    def hats(self, velocity: Array) -> Array:
        """Return the basis of curves of speed (n, k)."""
        x = np.log(np.maximum(np.abs(velocity), self.low))
        at = (x - self.knots[0]) / (self.knots[1] - self.knots[0])
        apart = np.minimum(at, len(self.knots) - 1.0)[:, None] - np.arange(len(self.knots))
        return np.asarray(np.maximum(1.0 - np.abs(apart), 0.0))

    def course(self, time: Array) -> Array:
        """Return the basis of what changes with time (n, p)."""
        x = (time - self.start) / self.duration
        waves = [np.cos(math.pi * k * x) / k for k in range(2, COURSE + 1)]
        return np.column_stack([2.0 * x - 1.0, *waves])

    def raw(
        self, inputs: Mapping[str, Array], like: Record, transmitted: Array | float
    ) -> dict[str, Array]:
        """Return inputs as laws take them, of those from their means over their deviations.

        What does not change is as in a record; what a gear transmits [N] is as given.
        """
        still = {
            name: np.asarray(np.mean(x))
            for name, x in like.inputs.items()
            if name not in self.inputs
        }
        of = {name: mean + size * inputs[name] for name, (mean, size) in self.inputs.items()}
        through = {TRANSMITTED: np.asarray(transmitted)} if self.transmitted else {}
        return {**still, **of, **through}

    def places(self, position: Array, waves: Sequence[float]) -> Array:
        """Return the basis of what changes with the place (n, p)."""
        x = (position - self.begin) / self.span
        smooth = [
            np.cos(math.pi * k * x) / math.hypot(1.0, k / CURVED) for k in range(1, COSINES + 1)
        ]
        turning = [f(w * position) for w in waves for f in (np.sin, np.cos)]
        return np.column_stack([*smooth, *turning])


def frame_of(pieces: Sequence[Piece], rows: BalanceRows) -> RecordFrame:
    """Return the scales of records."""
    speed = np.abs(rows.velocity)
    resolved = rows.far > RESOLVED
    seen = speed[resolved] if np.mean(resolved) > 0.3 else speed
    top = float(np.quantile(seen, 0.995))
    resolution = max(piece.resolution for piece in pieces)
    low = max(top / DECADES, rows.slowest(seen, 0.01), resolution)
    low = min(low, 0.5 * top)
    passed = PASSED * max(piece.passed for piece in pieces)
    count = max(6, math.ceil(KNOTS * math.log(top / low)))
    records = [piece.record for piece in pieces]
    places = np.concatenate([record.position for record in records])
    loads = [record.load for record in records if record.load is not None]
    load = 1.0
    if loads and np.ptp(np.concatenate(loads)) > 1e-6 * np.max(np.concatenate(loads)):
        load = float(np.exp(np.mean(np.log(np.maximum(np.concatenate(loads), 1e-9)))))
    through = [through_gear(record) for record in records]
    transmitted: tuple[float, ...] = ()
    if all(x is not None for x in through):
        x = np.abs(np.concatenate([x for x in through if x is not None]))
        if np.std(x) > VARIES * np.mean(x):
            transmitted = tuple(np.quantile(x, (0.1, 0.5, 0.9)).tolist())
    inputs = {}
    for name in records[0].inputs:
        if name == TRANSMITTED and transmitted:
            continue
        x = np.concatenate([record.inputs[name] for record in records if name in record.inputs])
        if np.ptp(x) > 1e-6 * (np.max(np.abs(x)) + 1e-300):
            inputs[name] = float(np.mean(x)), float(np.std(x))
    sides = tuple(side for side in (-1.0, 1.0) if np.mean(side * rows.velocity > low) > 0.02)
    return RecordFrame(
        top=top, low=low, shaped=min(max(low, passed), 0.5 * top),
        least=max(top / 1000.0, float(np.quantile(speed, 0.01))),
        knots=np.linspace(math.log(low), math.log(top), count),
        begin=float(places.min()), span=float(np.ptp(places)), start=float(rows.time.min()),
        duration=float(np.ptp(rows.time)), noise=min(piece.noise for piece in pieces), load=load,
        inputs=inputs, transmitted=transmitted, sides=sides or (1.0,),
    )  # fmt: skip


def through_gear(record: Record) -> Array | None:
    """Return what the gear of a record transmits (n,) [N], with its sign if that is known."""
    return record.inputs.get(TRANSMITTED) if record.transmitted is None else record.transmitted


def law_column(
    column: tuple[str, Sequence[Scalar]], velocity: Array, state: Array, least: float = 0.0,
    transmitted: Array | float = 0.0,
) -> Array:  # fmt: skip
    """Return a column of a law (n,) at velocities where bristles have a state.

    What a gear transmits is that for each unit of the state, which has the load in it.

    Examples
    --------
    >>> law_column(("stribeck", (1.0, 2.0)), np.array([0.0, 1.0]), np.ones(2)).round(3).tolist()
    [1.0, 0.368]
    """
    name, shape = column
    if name == GEAR:
        return np.asarray(state * transmitted)
    part, speed = PARTS[name], np.abs(velocity)
    if part.dry:
        return np.asarray(state * part.curve(np.maximum(speed, least), shape))
    return np.asarray(np.sign(velocity) * part.curve(speed, shape))


def relaxed(way: Array, length: Array | float, levels: Array, start: float = 0.0) -> Array:
    """Return levels (n, p) as they lag along a way (n,) with a length (n,), from a state.

    Examples
    --------
    >>> way = np.array([0.0, 1.0, 2.0])
    >>> relaxed(way, 1.0, np.ones((3, 1)))[:, 0].round(3).tolist()
    [0.0, 0.632, 0.865]
    >>> relaxed(way, 1.0, np.ones((3, 1)), start=1.0)[:, 0].tolist()
    [1.0, 1.0, 1.0]
    """
    steps = np.diff(way, prepend=way[:1])
    kept = np.exp(-np.abs(steps) / length)
    band = np.asfortranarray(np.vstack([np.ones(len(way)), np.append(-kept[1:], 0.0)]))
    right = np.asfortranarray(((1.0 - kept) * np.sign(steps))[:, None] * levels)
    right[:1] = start * levels[:1]
    result, _ = lapack.dtbtrs(band, right, uplo="L", diag="U")
    return np.asarray(result)


def is_told(column: Array, beside: Sequence[Array]) -> bool:
    """Return whether a column (n,) is none of those beside (n,).

    Examples
    --------
    >>> x = np.array([1.0, 0.0, 2.0])
    >>> is_told(2.0 * x, [x]), is_told(2.0 * x, [x**2])
    (False, True)
    """
    if not beside:
        return bool(np.any(column))
    x = np.column_stack([item / (np.linalg.norm(item) + TINY) for item in beside])
    apart = column - x @ np.linalg.lstsq(x, column, rcond=1e-9)[0]
    return bool(np.linalg.norm(apart) > SAME_SPAN * np.linalg.norm(column))


def powers_of_load(ratio: Array | float) -> Array:
    """Return what a level over its load changes by with the load over the usual one (n, 2).

    As a small power of it, and by a part that no load changes.
    """
    x = np.maximum(np.atleast_1d(ratio), 1e-3)
    return np.column_stack([np.log(x), 1.0 / x - 1.0])


class Balance:
    """The force balance of records, as columns at rows of all cutoffs.

    Parameters
    ----------
    records : sequence of Record
        What was measured.
    like : Balance, optional
        That of the records fitted, whose cutoff and scales are taken.
    highest : float
        Largest cutoff [Hz].
    rests : bool
        Whether the rows are those at rest.
    """

    def __init__(
        self,
        records: Sequence[Record],
        like: "Balance | None" = None,
        highest: float = math.inf,
        *,
        rests: bool = False,
    ) -> None:
        self.rests = rests
        """Whether the rows are those at rest, where friction is anywhere up to its level."""
        cutoff = None if like is None else like.pieces[0].cutoff
        if like is None:
            checked(records)
            records = by_best_sensor(records)
        elif like.pieces[0].record.velocity is None:
            records = [replace(record, velocity=None) for record in records]
        self.pieces: list[Piece]
        self.pieces, self._every = pieces_of(records, cutoff, highest)
        if like is not None:
            wider = like.pieces[0].wider
            self.pieces = [replace(piece, wider=min(wider, piece.widest)) for piece in self.pieces]
        self.acting: Acting = like.acting if like else AS_RECORDED
        """How forces are taken to act."""
        self._from: Balance = like or self
        self._rows: dict[int, BalanceRows] = {}
        starts, ends = (np.array([piece.record.time[k] for piece in self.pieces]) for k in (0, -1))
        # what follows in time is the same run
        again = np.concatenate([[0], (starts[1:] <= ends[:-1]).astype(int)])
        self.run = np.cumsum(again)
        """Number of the run of each piece."""
        self.runs = int(self.run[-1]) + 1
        self.first: float = like.first if like else 0.0
        """Length of the best bristle [m]."""
        self.frame: RecordFrame = like.frame if like else frame_of(self.pieces, self.rows(1))
        if len(self.frame.sides) == 1 and self.driven and not rests:
            slowest = float(np.min(np.abs(self.rows(MIDDLE).velocity), initial=math.inf))
            self.take([piece.with_start(slowest) for piece in self.pieces])
            self.frame = like.frame if like else frame_of(self.pieces, self.rows(1))
        self.waves: tuple[tuple[float, ...], tuple[float, ...]] = like.waves if like else ((), ())
        """Wave numbers of forces and of levels over the place [1/m]."""
        self._states: dict[int, tuple[Memory, list[Array]]] = {}
        self._seen: dict[tuple[int, int], tuple[Memory, dict[str, Array], dict[Column, Array]]] = {}
        if like and any(np.any(piece.hidden) for piece in like.pieces):
            self.reveal()

    @property
    def measured(self) -> bool:
        """Whether friction itself was measured."""
        return self.pieces[0].record.friction

    @property
    def finds_inertia(self) -> bool:
        """Whether the inertia is looked for."""
        return not self.measured and self.pieces[0].record.inertia is None

    @property
    def given(self) -> tuple[str, ...]:
        """What is given beside the force and may be given wrong: "inertia", "mechanism", "body".

        "both" is the inertia with the mechanism, as a gain of the force would change them. What is
        looked for takes up no less than itself: errors that are in its span are no others.
        """
        return self._from._given

    @cached_property
    def _given(self) -> tuple[str, ...]:
        records = [piece.record for piece in self.pieces]
        unknown = [item for item in records[0].unknown.values() if not item.doubt]
        if self.measured:
            return ()
        if records[0].joint:  # how much of a body is the inertia of one joint is how it is written
            return (
                () if any(not path.startswith(ZERO) for path in records[0].unknown) else ("body",)
            )
        result = self._taken(MIDDLE)
        if not any(np.any(record.force) for record in records):
            names = tuple(name for name in result if name != "both")
            return names[:1] if len(names) > 1 and not unknown else ()  # nothing else has a scale
        if any(item.given for item in unknown):  # so it has where a gain of the force is sought
            return ()
        sought = [self.rows(MIDDLE).unknown(path) for path in self._looked_for]
        sought += [self.rows(MIDDLE).acceleration] * self.finds_inertia
        return tuple(name for name, x in result.items() if is_told(x, sought))

    def response(self, which: int, acting: Acting) -> Array:
        """Return the response of the rows (n,) if forces acted otherwise [N]."""
        rows = self.rows(which)
        if acting == self.acting:
            return rows.response
        return rows.response - rows.driven(self.acting) + rows.driven(acting)

    def widen(self) -> bool:
        """Let velocities have the widest band, if that is wider; return whether it is."""
        pieces = [replace(piece, wider=max(piece.widest, piece.wider)) for piece in self.pieces]
        wider = any(a.wider > b.wider for a, b in zip(pieces, self.pieces, strict=True))
        self.take(pieces)
        return wider

    def take(self, pieces: Sequence[Piece]) -> None:
        """Take pieces as they are now, with other rows."""
        self.pieces, self._rows, self._states, self._seen = [*pieces], {}, {}, {}
        for name in ("_given", "_likely"):
            self.__dict__.pop(name, None)

    def rows(self, which: int) -> BalanceRows:
        """Return the rows at one of the cutoffs."""
        if which not in self._rows:
            rows = BalanceRows(self.pieces, which, self._every, self.acting, rests=self.rests)
            if not len(rows.velocity) and self._from is self:  # others may have none
                raise InputError(RESTS)
            self._rows[which] = rows
        return self._rows[which]

    # ---- at the samples
    def lengths(self, memory: Memory, piece: Piece) -> Array | float:
        """Return the length of a bristle at the samples of a piece (n,)."""
        if memory.ratio is None:
            return memory.length
        x = np.log(np.maximum(np.abs(piece.velocity), self.frame.low))
        return np.asarray(memory.length * np.interp(x, self.frame.knots, memory.ratio))

    def states(self, memory: Memory) -> list[Array]:
        """Return the states of a bristle at the samples of the pieces."""
        if id(memory) not in self._states:
            self._states[id(memory)] = memory, [self._state(memory, piece) for piece in self.pieces]
        return self._states[id(memory)][1]

    def forget(self, kept: Sequence[Memory]) -> None:
        """Forget states and columns of all memories but some."""
        keys = {id(item) for item in kept}
        self._states = {key: x for key, x in self._states.items() if key in keys}
        self._seen = {key: x for key, x in self._seen.items() if key[1] in keys}

    def _state(self, memory: Memory, piece: Piece) -> Array:
        if self.rests:  # it may be stretched in either direction
            return np.ones(len(piece.way))
        if memory.length == 0.0:
            return piece.direction
        if not memory.lags:
            return bristle(piece.along(memory.length), memory.length, memory.exponent, piece.start)
        ones = np.ones((len(piece.way), 1))
        way, length = piece.along(memory.length), self.lengths(memory, piece)
        return relaxed(way, length, ones, piece.start)[:, 0]

    def load(self, piece: Piece) -> Array | float:
        """Return the load over the usual one (n,)."""
        x = piece.record.load
        return 1.0 if x is None or self.frame.load == 1.0 else np.maximum(x, 0.0) / self.frame.load

    def transmitted(self, piece: Piece) -> Array | float:
        """Return what the gear transmits over the load, which states are times (n,)."""
        x = through_gear(piece.record) if self.frame.transmitted else None
        if x is None:
            return 0.0
        # it has the noise of accelerations, which has no sign where the size is taken
        smooth = piece.filters[MIDDLE](x, wider=WIDER, full=True)
        return np.asarray(np.abs(smooth) / np.maximum(self.load(piece), 1e-9))

    def input(self, piece: Piece, name: str) -> Array:
        """Return an input (n,) from its mean, over its standard deviation."""
        mean, size = self.frame.inputs[name]
        x = piece.record.inputs.get(name)
        return 0.0 * piece.velocity if x is None else (x - mean) / size

    def moving(self, memory: Memory, piece: Piece, state: Array) -> dict[str, Array]:
        """Return what depends on a bristle at the samples (n, ...), by group."""
        frame, v = self.frame, piece.velocity
        z = state * self.load(piece)
        hats = frame.hats(piece.velocity)
        course = frame.course(piece.record.time)
        groups = {
            "state": z[:, None],
            "common": z[:, None] * hats,
            "drift": np.hstack([z[:, None] * course, (v / frame.top)[:, None] * course]),
            "place": z[:, None] * frame.places(piece.record.position, self.waves[1]),
            "slow": (z * (memory.length == 0.0))[:, None]
            * np.maximum(1.0 - np.abs(v)[:, None] / (frame.low * 4.0 ** -np.arange(3.0)), 0.0),
        }
        if len(frame.sides) > 1:
            groups["sides"] = np.abs(z)[:, None] * hats
        first = memory.length or self._first
        lengths = [min(k * first, frame.span / 3.0) for k in OTHERS]
        others = [
            bristle(piece.along(length), length, n, piece.start) - state
            for length in lengths
            for n in (0.0, 1.0)
        ]
        if memory.length:  # what no law says while it is not stretched depends on the speed, too
            lacks = piece.direction - bristle(
                piece.along(memory.length), memory.length, 1.0, piece.start
            )
            others += [*(lacks[:, None] * hats).T]
        groups["others"] = np.column_stack(others) * math.sqrt(TOGETHER / len(others))
        for name in frame.inputs:
            u = self.input(piece, name)
            groups[f"level*{name}"] = (z * u)[:, None]
            groups[f"viscous*{name}"] = (v / frame.top * u)[:, None]
        if frame.load != 1.0:
            groups["load"] = z[:, None] * powers_of_load(self.load(piece))
        if self._lags(memory):
            length = self.lengths(memory, piece) / memory.length * np.ones(len(v))
            levels = self._lagging(memory, piece, np.column_stack([hats, length]))
            groups["common"] = levels[:, :-1]
            # the damping of bristles is what the lag changes by
            groups["damping"] = np.gradient(levels[:, -1:], piece.step, axis=0)
        return groups

    def of_laws(self, memory: Memory, laws: Sequence[Column], piece: Piece, state: Array) -> Array:
        """Return the columns of laws at the samples (n, p), whose levels lag with a bristle."""
        v, z, through = piece.velocity, state * self.load(piece), self.transmitted(piece)
        lagging, flat, parts = self._lags(memory), np.ones(len(v)), list[Array]()
        for law in laws:
            if is_slope(law[0]):
                parts.append(self._slope(law, piece, state))
            elif lagging and law[0] in LEVELS:
                level = law_column(law, np.abs(v), flat, self.frame.least, through)
                parts.append(self._lagging(memory, piece, level[:, None])[:, 0])
            else:  # speeds that are passed in a moment of a turn tell no shape but with bristles
                parts.append(law_column(law, v, z, self.frame.low, through))
        return np.column_stack([np.zeros((len(v), 0)), *parts])

    def _lags(self, memory: Memory) -> bool:
        """Return whether levels lag with a bristle by as much as the place tells."""
        return memory.length > SHORT * self.frame.noise and memory.lags

    def _lagging(self, memory: Memory, piece: Piece, levels: Array) -> Array:
        """Return levels (n, p) as they lag with a bristle, times the load."""
        load, length = np.reshape(self.load(piece), (-1, 1)), self.lengths(memory, piece)
        return load * relaxed(piece.along(memory.length), length, levels, piece.start)

    def _slope(self, column: Column, piece: Piece, state: Array) -> Array:
        """Return the column of a term of a law of any form at the samples (n,)."""
        name, v = column[0], piece.velocity
        assert isinstance(name, Slope)
        side = np.sign(state) if is_dry(name) else np.sign(v)
        given = {name: self.input(piece, name) for name in self.frame.inputs}
        load = self.load(piece) * np.ones(len(v))
        rows = Slips(
            velocity=side * np.maximum(np.abs(v), self.frame.least),
            load=name.own.load * load,
            inputs=self.frame.raw(given, piece.record, self.transmitted(piece) * load),
        )
        return slope_column(column, rows) * (np.abs(state) if is_dry(name) else 1.0)

    @property
    def _first(self) -> float:
        """Length of further bristles where the law has none."""
        return self.first or 0.01 * self.frame.span

    def fixed(self, which: int) -> dict[str, Array]:
        """Return what depends on no bristle, at the rows (n, ...), by group."""
        frame, rows, pieces = self.frame, self.rows(which), self.pieces
        result = {}
        if len(frame.sides) > 1:
            result["offset"] = np.ones((rows.count, 1))
            result["side"] = rows.seen([np.abs(p.velocity) / frame.top for p in pieces])[:, None]
            for name in frame.inputs:  # as a pressure pushes on a rod, whichever way it moves
                result[f"{FORCE}*{name}"] = rows.seen([self.input(p, name) for p in pieces])[
                    :, None
                ]
        result["slope"] = self.slope(which)[:, None]
        places = [self.forces(p.record.position) for p in pieces]
        result["force"] = rows.seen(places)
        result["zero"] = rows.seen([frame.course(p.record.time) for p in pieces])
        if self.given:
            taken = self._taken(which)
            result["given"] = np.column_stack([taken[name] for name in self.given])
        for path in pieces[0].record.unknown:
            result[path] = rows.unknown(path)[:, None]
        if self.finds_inertia:
            result["inertia"] = rows.acceleration[:, None]
        return result

    @cached_property
    def driven(self) -> bool:
        """Whether a force was recorded that a drive gives."""
        return not self.measured and all(np.any(piece.record.force) for piece in self.pieces)

    @property
    def is_no_line(self) -> bool:
        """Whether a drive gives forces that are no line over the position, as a controller's are.

        Only beside a line is a delay looked for: of one frequency both are one thing.
        """
        if not self.driven or self.pieces[0].record.joint:
            return False
        rows = self.rows(MIDDLE)
        place, force = (x - np.mean(x) for x in (rows.position, rows.force))
        slope = float(place @ force) / (float(place @ place) + TINY)
        left = float(np.std(force - slope * place))
        return slope > 0.0 or left > SAME_SPAN * float(np.std(force))

    def _plainly(self, memory: Memory) -> Array:
        """Return what a plain balance with a bristle leaves least with.

        They are inertia, viscous friction, level, a constant, and what is looked for.
        """
        rows = self.rows(MIDDLE)
        states = zip(self.states(memory), self.pieces, strict=True)
        level = rows.seen([state * self.load(p) for state, p in states])
        x = np.column_stack(
            [rows.acceleration, self.slope(MIDDLE), level, np.ones(rows.count)]
            + [self.rows(MIDDLE).unknown(path) for path in self._looked_for]
        )
        size = np.sqrt(np.mean(x * x, axis=0)) + TINY
        weights = TINY ** (rows.hidden * self.clips)
        weighed = x / size * weights[:, None]
        return np.asarray(np.linalg.lstsq(weighed, rows.force * weights, rcond=SAME_SPAN)[0] / size)

    @property
    def _looked_for(self) -> list[str]:
        """Paths of what is looked for in the balance alone."""
        return [path for path, item in self.pieces[0].record.unknown.items() if item.is_open]

    def needed(self, memory: Memory) -> list[Array]:
        """Return the force that the motion needs, about, at the samples of the pieces [N].

        That which was recorded has its noise, with which it would explain itself.
        """
        inertia, slope, level, constant, *sizes = self._from._plainly(memory).tolist()
        every = []
        for piece, state in zip(self.pieces, self.states(memory), strict=True):
            record, acceleration = piece.record, piece.acceleration
            result = inertia * acceleration + slope * piece.velocity / self.frame.top + constant
            result = result + level * state * self.load(piece)
            for path, size in zip(self._from._looked_for, sizes, strict=True):
                one = record.unknown[path]
                result = result + size * (one.inertia * acceleration - one.force)
            every.append(result if record.mechanism is None else result - record.mechanism)
        return every

    def delayed(self, which: int, memory: Memory) -> Array:
        """Return what a unit of a delay of the force changes, at the rows (n,) [N/s]."""
        rows = self.rows(which)
        if self.driven:
            return rows.seen(self.needed(memory), slope=1)
        return rows.driven(self.acting, slope=1)

    @property
    def clips(self) -> bool:
        """Whether a sensor of the force may clip, but not in nearly all rows."""
        return self.driven and 0.0 < float(np.mean(self.rows(MIDDLE).hidden)) < 0.9

    def reveal(self) -> None:
        """Take forces that are hidden if their sensor clips as the motion needs them."""
        pieces = []
        for piece, needed in zip(self.pieces, self.needed(RIGID), strict=True):
            beyond = np.sign(piece.clipped) * (needed - piece.acted(AS_RECORDED))
            pieces.append(replace(piece, hidden=piece.clipped * np.maximum(beyond, 0.0)))
        self.take(pieces)

    @property
    def excess(self) -> float:
        """By how much forces are above what their sensor shows, in the mean, with their noise [N].

        An excess within the noise takes nothing but noise from them, which is no better for it.
        """
        above = np.concatenate([np.abs(x.hidden * x.clipped) for x in self.pieces])
        above = above[np.concatenate([x.clipped != 0.0 for x in self.pieces])]
        return math.hypot(float(np.mean(above)), self._force_noise) if len(above) else 0.0

    @cached_property
    def _force_noise(self) -> float:
        """Standard deviation of the noise of recorded forces [N], not of jumps of a command.

        From the median of third differences, whose weights have a sum of squares of 20.
        """
        third = [np.abs(np.diff(piece.given.force, 3)) for piece in self.pieces]
        middle = max(float(np.median(x)) if len(x) else 0.0 for x in third)
        return middle / (0.6745 * math.sqrt(20.0))  # the median of a normal distribution's size

    def plain(self) -> Array:
        """Return columns of level, viscous friction, a constant and what is looked for (n, p)."""
        fixed, rows = self.fixed(MIDDLE), self.rows(MIDDLE)
        beside = [name for name in ("offset", "inertia", *self._looked_for) if name in fixed]
        level = [p.direction * self.load(p) for p in self.pieces]
        return np.hstack([*(fixed[x] for x in beside), fixed["slope"], rows.seen(level)[:, None]])

    @cached_property
    def dampings(self) -> list[str]:
        """Paths of what is looked for and acts, alone or together, as viscous friction does."""
        slope, looked = self.slope(MIDDLE), self._looked_for
        if not looked:
            return []
        columns = np.column_stack([self.rows(MIDDLE).unknown(path) for path in looked])
        columns /= np.linalg.norm(columns, axis=0) + 1e-300
        shares = np.linalg.lstsq(columns, slope, rcond=SAME_SPAN**2)[0]
        size = float(np.linalg.norm(slope))
        if np.linalg.norm(slope - columns @ shares) > SAME_SPAN * size:
            return []
        each = zip(looked, shares.tolist(), strict=True)
        return [path for path, share in each if abs(share) > SAME_SPAN * size]

    @property
    def inertia(self) -> float:
        """Inertia that is given, with that of what is looked for as it is likely."""
        first = self.pieces[0].record
        more = [x * first.unknown[path].inertia for path, x in self._from._likely.items()]
        return (first.inertia or 0.0) + sum(more)

    @cached_property
    def _likely(self) -> dict[str, float]:
        """Sizes of what is looked for, but for gains, by which a plain balance leaves least."""
        unknown = self.pieces[0].record.unknown
        paths = [path for path in self._looked_for if not unknown[path].given]
        if not paths:
            return {}
        rows, slope = self.rows(MIDDLE), self.slope(MIDDLE)
        level = rows.seen([p.direction * self.load(p) for p in self.pieces])
        known = [self.rows(MIDDLE).unknown(path) for path in paths]
        x = np.column_stack([*known, level, slope, np.ones(rows.count)])
        size = np.sqrt(np.mean(x * x, axis=0)) + TINY
        c = np.linalg.lstsq(x / size, rows.response, rcond=SAME_SPAN)[0] / size
        return dict(zip(paths, np.abs(c).tolist(), strict=False))

    def _taken(self, which: int) -> dict[str, Array]:
        """Return what the inertia and the mechanism take at the rows (n,), and both.

        Errors of what is given are in proportion to it: of both, the force has another gain. Of one
        joint of several it is the rigid body. What is looked for takes its likely share.
        """
        rows, likely = self.rows(which), self._from._likely
        records = [piece.record for piece in self.pieces]
        inertia = np.array([record.inertia or 0.0 for record in records])
        for path, x in likely.items():
            inertia += x * np.array([record.unknown[path].inertia for record in records])
        forces = [
            (0.0 * record.time if record.mechanism is None else record.mechanism)
            + sum(x * record.unknown[path].force for path, x in likely.items())
            for record in records
        ]
        result = {}
        if np.any(inertia):
            result["inertia"] = inertia[rows.piece] * rows.acceleration
        if any(np.any(force) for force in forces):
            result["mechanism"] = -rows.seen(forces)
        if len(result) > 1:
            result["both"] = sum(result.values(), np.zeros(rows.count))
        if records[0].joint:
            return {"body": result.get("both", sum(result.values(), np.zeros(rows.count)))}
        return result

    def forces(self, position: Array) -> Array:
        """Return the basis of a force that changes with the place (n, p), without a line over it.

        Of one frequency a line, the inertia and a delay are one thing.
        """
        places = self.frame.places(position, self.waves[0])
        if not self.driven or self.pieces[0].record.joint:
            return places
        along = np.clip(2.0 * (position - self.frame.begin) / self.frame.span - 1.0, -1.0, 1.0)
        order = np.arange(1, COSINES + 1)
        line = -12.0 * (order % 2) / (math.pi * order) ** 2 / np.hypot(1.0, order / CURVED)
        places[:, :COSINES] -= np.outer(along, line)
        return places

    def slope(self, which: int) -> Array:
        """Return the velocity over the largest at the rows (n,)."""
        return self.rows(which).seen([p.velocity / self.frame.top for p in self.pieces])

    def pulses(self, which: int) -> Array:
        """Return the pulses of turns at the rows (n, p)."""
        rows = self.rows(which)
        each = max(TURNS // len(self.pieces), 10)
        parts = []
        for k, piece in enumerate(self.pieces):
            filt = piece.filters[which]
            count = len(piece.velocity)
            turns = piece.turns
            if len(turns) > each:
                change = np.abs(np.gradient(piece.velocity, piece.step))[turns]
                turns = np.sort(turns[np.argsort(-change, kind="stable")[:each]])
            kernel = np.zeros(count)
            kernel[count // 2] = 0.25 / piece.step / filt.band
            kernel = filt(kernel, full=True)
            at = rows.picks[k][:, None] * piece.every - turns[None, :]
            reach = PULSE / filt.band / piece.step
            inside = (np.abs(at) < reach) & (np.abs(at) < count // 2)
            values = np.where(inside, kernel[np.where(inside, at + count // 2, 0)], 0.0)
            own = np.zeros((rows.count, len(turns)))
            own[rows.piece == k] = values
            parts.append(own[:, np.any(values != 0.0, axis=0)])
        return np.hstack(parts)

    # ---- at the rows
    def columns(
        self, which: int, memory: Memory, laws: Sequence[Column]
    ) -> tuple[dict[str, Array], Array]:
        """Return columns that depend on a bristle at the rows of a cutoff, and those of laws."""
        rows, each = self.rows(which), [*zip(self.pieces, self.states(memory), strict=True)]
        if (which, id(memory)) not in self._seen:
            parts = [self.moving(memory, piece, state) for piece, state in each]
            ends = np.cumsum([0, *(x.shape[1] for x in parts[0].values())])
            seen = self._in_turn(rows, [np.hstack([*groups.values()]) for groups in parts])
            groups = {k: seen[:, a:b] for k, a, b in zip(parts[0], ends, ends[1:], strict=False)}
            groups["delay"] = self.delayed(which, memory)[:, None]
            self._seen[which, id(memory)] = memory, groups, {}
        _, groups, known = self._seen[which, id(memory)]
        new = [law for law in laws if law not in known]
        if new:
            x = self._in_turn(rows, [self.of_laws(memory, new, *item) for item in each])
            known |= dict(zip(new, x.T, strict=True))
        for law in {*known} - {*laws}:
            del known[law]
        result = [known[law] for law in laws]
        return dict(groups), np.column_stack([np.zeros((rows.count, 0)), *result])

    @staticmethod
    def _in_turn(rows: BalanceRows, parts: Sequence[Array]) -> Array:
        """Return columns of the pieces at the rows (n, p), of which a few are filtered at once."""
        total = range(0, parts[0].shape[1], AT_ONCE)
        return np.hstack([rows.seen([x[:, k : k + AT_ONCE] for x in parts]) for k in total])

    @cached_property
    def turned(self) -> bool:
        """Whether the motion turns at all."""
        return any(len(piece.turns) for piece in self.pieces)
