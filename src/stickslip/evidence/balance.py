"""The force balance along measured motions: rows, folds with gaps, and columns of terms."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import copy
from typing import Any, Self, final

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from stickslip.errors import InputError
from stickslip.evidence.bristles import SIGN, Shape
from stickslip.evidence.motion import HIGHEST, RATE, band, derivative, spread_out, top_speed
from stickslip.evidence.part import Part, part_of
from stickslip.evidence.series import Series, pieces
from stickslip.evidence.structure import Structure
from stickslip.evidence.terms import Term, column_of, through_bristle, usual_size
from stickslip.formatting import number

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Spans = Mapping[str, tuple[float, float]]

FOLDS = 10
"""Blocks that are held out in turn."""
GAP = 3.0
"""Gap beside a held-out block, over the time constant 1/fc of the filter."""
ENDS = 2.0
"""Ends of a piece that are not compared, over 1/fc: the filter has nothing beyond them."""
PERIODS = 30.0
"""Least length of what is compared, over 1/fc: ten blocks and their gaps leave the most."""
RESOLVED = 4.0
"""Length of a bristle that the path resolves, over the displacement that the sensor resolves."""
SLIPPING = 10.0
"""Least time of motion between rests and reversals, over 1/fc."""
SHORTEST = 8.0
"""Least length of a piece, over 1/fc."""
ROOM_TEMPERATURE = 20.0
"""Temperature [°C] from which terms in the temperature count."""
DELIVERED = 0.3
"""Share of the samples of a force that an amplifier delivers, at least: their largest is the least
limit that is tried. A force that is nearly always beyond its limit is not known."""
POINTS = 20
"""Folds of a table, at most."""


@final
class Balance:
    """Measured motions and forces in one band, and the columns of terms along them.

    Parameters
    ----------
    series : sequence of Series
        What was measured; pieces between gaps count by themselves.
    fc : float, optional
        Band [Hz]; by default that in which noise of the position costs little.
    folds : int, default 10
        Blocks that are held out in turn.
    like : Balance, optional
        A balance whose band, clock, references and resolution are taken, to predict by its fit.

    Raises
    ------
    InputError
        If the series cannot be judged by their force balance.
    """

    def __init__(
        self,
        series: Sequence[Series],
        fc: float | None = None,
        *,
        folds: int = FOLDS,
        like: "Balance | None" = None,
    ) -> None:
        self.series = tuple(series)
        measured = [piece for one in series for piece in pieces(one)]
        if not measured:
            raise InputError(
                "the force balance needs a piece of at least 64 samples without a gap."
            )
        self.fc: float = like.fc if like else fc or usual_band(measured)
        measured = [one for one in measured if _length(one) * self.fc > SHORTEST]
        _check_length(measured, self.fc, [] if like else series)
        self.spans: Spans = like.spans if like else _spans(measured)
        self.centres: Mapping[str, float] = like.centres if like else _centres(measured)
        self.references: Mapping[str, float] = like.references if like else _references(measured)
        parts: list[Part] = []
        for one in measured:
            first = parts[-1].rows.stop if parts else 0
            span = self.spans.get(one.channel, (0.0, 1.0))
            centre = self.centres.get(one.channel, 0.0)
            parts.append(part_of(one, self.fc, first, span, centre, self.references))
        self.dynamic = True
        self._assemble(parts, folds, like.resolved if like else {})
        if not like:
            self._check_motion()

    @classmethod
    def points(cls, v: Array, f: Array, **covariates: Array) -> Self:
        """Return the balance of a table: steady speeds (n,) and friction, a row for each.

        Without time there is no memory and no fault.

        Examples
        --------
        >>> table = Balance.points(np.arange(1.0, 9.0), np.full(8, 2.0))
        >>> table.count, table.folds
        (8, 8)
        """
        v, f = np.asarray(v, float), np.asarray(f, float)
        columns = {name: np.asarray(x, float) for name, x in covariates.items()}
        if len(v) < 4 or any(
            x.shape != v.shape or not np.isfinite(x).all() for x in (v, f, *columns.values())
        ):
            raise InputError(
                "a table of friction needs at least 4 points, and in each a speed, a friction and"
                f" every covariate as finite numbers; got {len(v)} points."
            )
        found = cls.__new__(cls)
        found.series, found.fc, found.dynamic = (), 1.0, False
        found.spans, found.centres = {"": (0.0, 1.0)}, {"": 0.0}
        found.references = {name: _reference(name, x) for name, x in columns.items()}
        still = np.zeros(len(v))
        part = Part(
            channel="",
            inertia=False,
            mass=None,
            h=1.0,
            every=1,
            filter=None,
            t=np.arange(len(v), dtype=float),
            clock=still,
            since=still,
            centre=0.0,
            q=still,
            path=still,
            v=v,
            a=still,
            raw=f,
            force=f,
            taken=still,
            covariates=columns,
            extra={},
            references=found.references,
            start=0.0,
            noise=0.0,
            open=still > 0.0,
            clear=still == 0.0,
            rows=slice(0, len(v)),
            states={SIGN: np.sign(v)},
        )
        found._assemble([part], min(len(v), POINTS), {})
        return found

    def _assemble(self, parts: list[Part], folds: int, resolved: Mapping[str, float]) -> None:
        """Set the rows of all parts, their folds, halves and gaps."""
        self.parts = parts
        self.folds = folds
        self.count = parts[-1].rows.stop
        self.channels = tuple(dict.fromkeys(one.channel for one in parts))
        self.force = np.concatenate([one.force[:: one.every] for one in parts])
        self.at_rest = np.concatenate([one.open for one in parts])
        self.clear = np.concatenate([one.clear for one in parts])
        self.scale = max(float(np.sqrt(np.mean(self.force**2))), 1e-300)
        self.own = {
            name: np.concatenate([np.full(one.count, one.channel == name) for one in parts])
            for name in self.channels
        }
        self.fold = np.empty(self.count, dtype=int)
        self.half = np.empty(self.count, dtype=int)
        self.use = np.ones(self.count, dtype=bool)
        done = dict.fromkeys(self.channels, 0)
        total = {c: sum(one.count for one in parts if one.channel == c) for c in self.channels}
        for one in parts:
            number = done[one.channel] + np.arange(one.count)
            self.fold[one.rows] = number * folds // total[one.channel]
            self.half[one.rows] = number * 2 // total[one.channel] if self.dynamic else number % 2
            done[one.channel] += one.count
            if self.dynamic:
                end = int(ENDS / self.fc / (one.h * one.every)) + 1
                self.use[one.rows][:end] = self.use[one.rows][-end:] = False
        gap = 0
        if self.dynamic:
            gap = max(int(GAP / self.fc / (parts[0].h * parts[0].every)), 5)
        self.near = np.array([spread_out(self.fold == k, gap) for k in range(folds)])
        self.resolved: dict[str, float] = {
            c: max(one.resolved for one in parts if one.channel == c) for c in self.channels
        } | dict(resolved)
        self.speed: dict[str, float] = {}
        self.span: dict[str, float] = {}
        self.least_limit: dict[str, float] = {}
        for c in self.channels:
            own = [one for one in parts if one.channel == c]
            self.speed[c] = max(top_speed(np.concatenate([one.v for one in own])), 1e-300)
            self.span[c] = max(float(np.ptp(one.q)) for one in own)
            force = np.abs(np.concatenate([one.raw for one in own]))
            self.least_limit[c] = float(np.quantile(force, DELIVERED))
        self._columns: dict[tuple[Term, Shape | None], tuple[Array, Array]] = {}
        self._late: dict[tuple[float, float, float], Array] = {}

    def _check_motion(self) -> None:
        """Refuse what rests throughout, as far as the sensor shows."""
        moving = self.use & ~self.at_rest
        seconds = sum(one.h * one.every * float(moving[one.rows].sum()) for one in self.parts)
        if seconds * self.fc < SLIPPING:
            raise InputError(
                f"the body moves for {number(seconds)} s only, as far as the position shows: in a"
                f" band of {number(self.fc)} Hz the force balance needs"
                f" {number(SLIPPING / self.fc)} s of motion between rests and reversals."
            )

    @property
    def free(self) -> bool:
        """Whether nothing drives the motion: no force was recorded that could be wrong."""
        return not any(np.any(one.raw) for one in self.parts)

    @property
    def length(self) -> float:
        """Return the length [s] of all series of a channel, the largest."""
        return max(length for _, length in self.spans.values())

    def of(self, channel: str) -> list[Part]:
        """Return the parts of a channel."""
        return [one for one in self.parts if one.channel == channel]

    def make_states(self, channel: str, shapes: Iterable[Shape]) -> None:
        """Make the states of many bristles along a channel."""
        shapes = tuple(shapes)
        for one in self.of(channel):
            one.make_states(shapes)

    def open(self, structure: Structure) -> Flags:
        """Return rows (n,) whose force a structure leaves open.

        These are those at rest, in channels without a memory that the path resolves.
        """
        found = self.at_rest.copy()
        for channel, shape in structure.memories:
            if self.resolves(shape[0], channel):
                found[self.own[channel]] = False
        return found

    def resolves(self, length: float, channel: str = "") -> bool:
        """Whether the path of a channel tells where a bristle of a length [m] is deflected to."""
        return length > RESOLVED * self.resolved[channel]

    def columns(self, term: Term, shape: Shape) -> tuple[Array, Array]:
        """Return columns (n, d) of a term, and what multiplies the state in them (n, d).

        Both are zero in other channels.
        """
        key = (term, shape if through_bristle(term.kind) else None)
        if key not in self._columns:
            self._columns[key] = self._made(term, shape)
        return self._columns[key]

    def _made(self, term: Term, shape: Shape) -> tuple[Array, Array]:
        columns: Array | None = None
        multipliers: Array = np.zeros((self.count, 0))
        for one in self.parts:
            if term.channel not in (one.channel, "*"):
                continue
            if term.kind == "known" and term.what not in one.extra:
                continue
            column, multiplier = column_of(one, term, shape)
            if columns is None:
                columns = np.zeros((self.count, column.shape[1]))
                multipliers = np.zeros_like(columns)
            columns[one.rows] = column[:: one.every]
            if multiplier is not None:
                multipliers[one.rows] = multiplier[:: one.every]
        if columns is None:
            columns = multipliers
        return columns, multipliers

    def late(self, delay: float, lag: float = 0.0, skew: float = 0.0) -> Array:
        """Return the forces (n,) that a channel shows of each row, late or through a filter [s].

        With a skew it shows them later by so much for each second since the start.
        """
        if not (delay or lag or skew):
            return self.force
        key = (delay, lag, skew)
        if key not in self._late:
            self._late[key] = np.concatenate([_shown(one, delay, lag, skew) for one in self.parts])
        return self._late[key]

    def filtered(self, forces: Array, lag: float) -> Array:
        """Return forces (n, ...) as a channel shows them through a filter of a lag [s], if any."""
        if not lag:
            return forces
        found = np.empty_like(forces)
        for one in self.parts:
            own = forces[one.rows] / _kept(one, lag, self.fc)
            a = one.h * one.every / (one.h * one.every + 2.0 * lag)
            found[one.rows] = lfilter([a, a], [1.0, 2.0 * a - 1.0], own, 0, (1.0 - a) * own[:1])[0]
        return found

    def inside(self, *, largest: bool, smallest: bool) -> "Balance":
        """Return the balance without rows in which a force at an end of its piece has a part.

        Each record may have a range of its own, and a constant force may have been taken off.
        """
        found = copy(self)
        found.use = self.use.copy()
        for one in self.parts:
            there = (largest & (one.raw == one.raw.max())) | (smallest & (one.raw == one.raw.min()))
            beside = spread_out(there, int(1.0 / self.fc / one.h) + 1)
            found.use[one.rows] &= ~beside[:: one.every]
        return found

    @contextmanager
    def passing(self) -> Iterator[None]:
        """Forget the columns and states that are made inside: those of values tried once."""
        kept: list[dict[Any, Any]] = [self._columns, self._late]
        kept += [one.states for one in self.parts]
        sizes = [len(one) for one in kept]
        try:
            yield
        finally:
            for one, size in zip(kept, sizes, strict=True):
                while len(one) > size:
                    one.popitem()  # the last that was made


def _shown(one: Part, delay: float, lag: float, skew: float) -> Array:
    """Return the forces (m,) that a channel shows late, less what the known motion takes."""
    whole = one.force + one.taken
    shown = whole + lag * derivative(whole, one.h) if lag else whole
    later = delay + skew * one.since[:: one.every]
    found: Array = np.interp(one.t[:: one.every] + later, one.t, shown)
    return found - one.taken[:: one.every]


def _kept(one: Part, lag: float, fc: float) -> float:
    """Return what is kept of noise in the band after a filter is taken off and put on again.

    The one is by differences of samples, the other by the rule of trapezia from row to row.
    """
    w = 2.0 * np.pi * np.linspace(0.0, fc, 200)
    angle, half = w * one.h, 0.5 * w * one.h * one.every
    off = 1.0 + (lag * (8.0 * np.sin(angle) - np.sin(2.0 * angle)) / (6.0 * one.h)) ** 2
    on = 1.0 + (lag * 2.0 * np.tan(half) / (one.h * one.every)) ** 2
    return float(np.sqrt(np.mean(off / on)))


def _length(piece: Series) -> float:
    return float(piece.t[-1] - piece.t[0])


def usual_band(measured: Sequence[Series]) -> float:
    """Return the least band [Hz] of all channels of pieces: in each, that of most of its time.

    It is wider where so narrow a band would leave nothing to hold out.
    """
    found = []
    for channel in dict.fromkeys(one.channel for one in measured):
        own = [one for one in measured if one.channel == channel]
        bands = np.array([band(one) for one in own])
        lengths = np.array([_length(one) for one in own])
        order = np.argsort(bands)
        middle = np.searchsorted(np.cumsum(lengths[order]), 0.5 * lengths.sum())
        fc = float(bands[order][min(int(middle), len(own) - 1)])
        step = min(float(np.median(np.diff(one.t))) for one in own)
        wanted = (PERIODS + 2.0 * ENDS) / float(lengths.max())
        found.append(max(fc, min(wanted, RATE / step, HIGHEST)))
    return min(found)


def _check_length(measured: Sequence[Series], fc: float, series: Sequence[Series]) -> None:
    """Refuse what is too short for its band, and what does not move or has no force."""
    by_channel: dict[str, list[Series]] = {}
    for one in measured:
        by_channel.setdefault(one.channel, []).append(one)
    for one in series:
        own = by_channel.get(one.channel, [])
        length = sum(_length(piece) - 2.0 * ENDS / fc for piece in own)
        where = f" of {one.channel}" if one.channel else ""
        if length * fc < PERIODS * 0.99:
            least = (PERIODS + 2.0 * ENDS) / fc
            raise InputError(
                f"the record{where} is too short for its noise: in a band of {number(fc)} Hz the"
                f" force balance needs {number(least)} s without a gap, got"
                f" {number(max(map(_length, own), default=_length(one)))} s. Record longer, or use"
                " a finer encoder."
            )
        still = all(piece.taken is None and not piece.extra for piece in own)
        if still and not max(float(np.ptp(piece.force)) for piece in own) > 0.0:
            raise InputError(
                f"the force{where} is constant: the force balance needs the force of the drive"
                " while it changes."
            )


def _spans(measured: Sequence[Series]) -> Spans:
    """Return the first time and the length of all series of each channel."""
    found = {}
    for channel in dict.fromkeys(one.channel for one in measured):
        own = [one for one in measured if one.channel == channel]
        first = min(float(one.t[0]) for one in own)
        found[channel] = (first, max(float(one.t[-1]) for one in own) - first)
    return found


def _centres(measured: Sequence[Series]) -> Mapping[str, float]:
    """Return the position of each channel from which terms along the way count.

    It is 0 where that is within reach, else the middle: seen from afar a spring is an offset.
    """
    found = {}
    for channel in dict.fromkeys(one.channel for one in measured):
        own = [one for one in measured if one.channel == channel]
        low = min(float(one.q.min()) for one in own)
        high = max(float(one.q.max()) for one in own)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        found[channel] = middle if abs(middle) > 2.0 * half else 0.0
    return found


def _references(measured: Sequence[Series]) -> Mapping[str, float]:
    """Return the values from which terms in covariates count."""
    names = dict.fromkeys(name for one in measured for name in one.covariates)
    return {
        name: _reference(
            name,
            np.concatenate([one.covariates[name] for one in measured if name in one.covariates]),
        )
        for name in names
    }


def _reference(name: str, values: Array) -> float:
    return ROOM_TEMPERATURE if name == "temperature" else usual_size(values)
