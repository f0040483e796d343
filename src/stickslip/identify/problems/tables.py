r"""Tables of friction over speed, with loads, temperatures, runs, and the order of the rows.

Terms of laws stand for friction :math:`s(v)\,N^a f(|v|)`: :math:`s` is the direction, :math:`N`
the load over its geometric mean. Blocks are speeds, and loads where there are several: what is left
out is what will be asked. The measured curve is piecewise linear over :math:`\log |v|` with knots
at the speeds, between them and beyond them, its bending penalised: a smoothing spline, whose prior
opens the band between the readings and beyond them. Beside it friction may jump between two speeds.
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.identify.fits import stretches_of
from stickslip.identify.laws import CHANGING, FLOWS, POINTS, TITLES, Composition, bounds_of, compose
from stickslip.identify.problem import (
    ALIKE,
    ASKED,
    BENDING,
    BEYOND,
    RUNNING_IN,
    SIDE,
    STRETCHES,
    Array,
    Family,
    Mask,
    Points,
    Problem,
    Shape,
    Structure,
    Term,
    bending_of,
)
from stickslip.mechanisms import Mechanism

LOAD_EXPONENTS = (0.5, 0.67, 0.8, 0.9, 1.0)
"""Powers of the load that friction may follow."""
SPEED_EXPONENTS = (0.2, 0.33, 0.5, 0.67, 0.8, 1.25, 1.5)
"""Powers of the speed; 1 is viscous and 2 is drag."""
RUN_SPREADS = (3.0, 10.0, 30.0)
"""Spreads of runs, in units of the noise."""
FAR = math.log(10.0)
"""How far below and above the measured speeds the curve has knots, in logarithms."""
FEW_SPEEDS = 3
"""Speeds of a direction from which it may differ from the other."""
FEWEST = 5
"""Readings that a table must have."""
BOTH, HERSEY = -1.0, -2.0
"""Stand for the power of the load of a measured curve: a part that grows with the load beside one
that does not; the load times a curve over speed / load (Hersey number)."""
SHUFFLED = 0.3
"""Share of the order that speeds, loads and runs must leave, so that a drift can be told."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Rows:
    """Readings of friction, or places where it is asked."""

    velocity: Array
    """Velocities (n,) [m/s]."""
    load: Array
    """Loads (n,) [N]."""
    inputs: Mapping[str, Array]
    """Temperatures and other inputs of the contact (n,)."""
    run: NDArray[np.intp]
    """Number of the run (n,); -1: any."""
    order: Array
    """Place in the order of measuring, from -1 to 1 (n,)."""
    direction: Array
    """Sign of the velocity (n,); of what friction balances where that is 0."""

    @property
    def speed(self) -> Array:
        """Sizes of the velocities (n,) [m/s]."""
        return np.abs(self.velocity)

    def where(self, kept: Mask) -> "Rows":
        """Return some of the rows."""
        return Rows(
            velocity=self.velocity[kept],
            load=self.load[kept],
            inputs={name: x[kept] for name, x in self.inputs.items()},
            run=self.run[kept],
            order=self.order[kept],
            direction=self.direction[kept],
        )

    @classmethod
    def joined(cls, parts: Sequence["Rows"]) -> "Rows":
        """Return the rows of several tables; only inputs that all have are kept."""
        names = set.intersection(*(set(one.inputs) for one in parts))
        return cls(
            velocity=np.concatenate([one.velocity for one in parts]),
            load=np.concatenate([one.load for one in parts]),
            inputs={name: np.concatenate([one.inputs[name] for one in parts]) for name in names},
            run=np.concatenate([one.run for one in parts]),
            order=np.concatenate([one.order for one in parts]),
            direction=np.concatenate([one.direction for one in parts]),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """What the columns of all rows are scaled by: it is that of the table that was measured."""

    slowest: float
    fastest: float
    load: float
    """Geometric mean of the loads [N]."""
    size: float
    """Root mean square of the friction [N]."""
    knots: Array
    """Logarithms of the speeds at which the measured curve bends (k,)."""
    basis: Array
    """Eigenvectors of its bending (k, k)."""
    bending: Array
    """Their eigenvalues (k,)."""
    means: Mapping[str, float]
    """Means of the inputs."""
    straight: Array
    """Level, and what is viscous [s/m], of a straight line through friction over its mean (2,)."""


class TableProblem(Problem):
    """A table of friction, as the judge sees it."""

    independent = True
    softness = 2.0
    usual: Sequence[Family] = (
        ("level",),
        ("level", "viscous"),
        ("level", "stribeck"),
        ("level", "stribeck", "viscous"),
        ("level", "power"),
        ("level", "saturating"),
        ("level", "power", "stribeck"),
        ("drag", "level", "viscous"),
        ("level", "drag"),
        ("power",),
        ("viscous",),
        ("tanh", "viscous"),
        ("hersey", "level", "viscous"),
        ("level", "viscous", "level_direction"),
        ("adhesion", "level"),
        ("adhesion", "level", "viscous"),
        ("adhesion", "level", "stribeck", "viscous"),
        ("level", "offset", "viscous"),
        ("level", "offset", "stribeck", "viscous"),
        ("level", "offset", "viscous", "viscous_direction"),
        ("level", "offset", "stribeck_sides", "viscous"),
        ("level", "offset", "stribeck_sides", "viscous", "viscous_direction"),
    )

    def __init__(self, rows: Rows, friction: Array) -> None:
        self.rows, self.response = rows, np.asarray(friction, dtype=float)
        speed = rows.speed[rows.speed > 0.0]
        slowest = float(speed.min())
        logs = np.log(np.maximum(rows.speed, slowest / 10.0))
        knots = _knots(_apart(np.log(speed)))
        bending, basis = bending_of(knots)
        self.frame = Frame(
            slowest=slowest,
            fastest=float(speed.max()),
            load=float(np.exp(np.mean(np.log(rows.load)))),
            size=float(np.sqrt(np.mean(self.response**2))) or 1.0,
            knots=knots,
            basis=basis,
            bending=bending,
            means={name: float(np.mean(x)) for name, x in rows.inputs.items()},
            straight=_straight(rows, self.response),
        )
        self.loaded = bool(np.ptp(rows.load) > 1e-9 * rows.load.max())
        self.blocks = self.excluded = _blocks(logs, np.log(rows.load))
        self.stretches = np.argmax(np.array(self.blocks), axis=0)
        self.terms = _terms(rows, self.frame, loaded=self.loaded)
        if not self.loaded:  # under one load they are the same column
            self.instead = {"offset": TITLES["level_direction"]}
        # friction that changes with an input is as usual as one with a flow, or a sum of three
        # terms that only passes through the readings is searched before it
        changing = [(f"level*{x}", f"viscous*{x}") for x in rows.inputs]
        self.usual = [
            *type(self).usual,
            *(
                tuple(sorted({"level", "viscous", *some}))
                for level, viscous in changing
                for some in ((level,), (viscous,), (level, viscous))
            ),
        ]
        loads = (*LOAD_EXPONENTS, BOTH, HERSEY) if self.loaded else (1.0,)
        sides = (0.0, 1.0) if both_ways(rows) else (0.0,)
        self.references = [
            (("curve", (penalty, a, side)),) for penalty in BENDING for a in loads for side in sides
        ]
        # a curve that bends as little as it can beside a jump does not smear it
        self.references += [
            (("curve", (penalty, 1.0, 0.0)), ("jump", (place,)))
            for penalty in BENDING[1:]
            for place in _gaps(rows.speed)
        ]

    def __reduce__(self) -> tuple[Any, ...]:
        """Return what makes it again in another process: its terms are functions."""
        return TableProblem, (self.rows, self.response), {"only": self.only}

    def scales(self, fitted: Array) -> Sequence[Array]:
        """Return friction and speed, with which noise of sensors and of drives grows."""
        frame = self.frame
        return [
            np.abs(fitted) + 1e-2 * frame.size,
            np.maximum(self.rows.speed, frame.slowest / 3.0),
        ]

    def speeds(self, rows: Rows) -> Array:
        """Return the speeds of rows (n,)."""
        return np.maximum(rows.speed, 1e-3 * self.frame.slowest)

    def features(self, rows: Rows) -> Mapping[str, Array]:
        """Return what readings may be told apart by; rows of any run have no order."""
        stated = rows.run >= 0
        return {
            SIDE: rows.direction,
            "speed": self.speeds(rows),
            "load": rows.load,
            **rows.inputs,
            "order of the readings": np.where(stated, rows.order, np.nan),
        }

    def variants(self, rows: Rows) -> Sequence[Rows]:
        """Return rows as they were in each run, early, midway and late, where none is asked for."""
        if (rows.run >= 0).any():
            return [rows]
        runs = range(int(self.rows.run.max()) + 1) if "run" in self.terms else (-1,)
        orders = (0.0, -1.0, 1.0) if "drift" in self.terms else (0.0,)
        both, like = itertools.product(runs, orders), np.ones_like(rows.run)
        return [
            replace(rows, run=run * like, order=np.full(len(like), order)) for run, order in both
        ]

    def at(
        self,
        velocity: Array,
        load: Array | float | None = None,
        inputs: Mapping[str, Array | float] | None = None,
    ) -> Rows:
        """Return rows at velocities (n,); load and inputs are the usual ones if not given."""
        v = np.atleast_1d(np.asarray(velocity, dtype=float))
        ones = np.ones(len(v))
        given = inputs or {}
        return Rows(
            velocity=v,
            load=ones * (self.frame.load if load is None else load),
            inputs={name: ones * given.get(name, mean) for name, mean in self.frame.means.items()},
            run=np.full(len(v), -1),
            order=np.zeros(len(v)),
            direction=np.where(v < 0.0, -1.0, 1.0),
        )

    def places(self, structure: Structure) -> Sequence[Structure]:
        """Return a structure with its jump at either end of the gap between two speeds."""
        speeds = np.unique(self.rows.speed)

        def at(side: int) -> Structure:  # just above the one speed, or just below the other
            return tuple(
                (
                    name,
                    (
                        float(
                            np.nextafter(
                                speeds[np.searchsorted(speeds, shape[0]) - side], side * math.inf
                            )
                        ),
                    ),
                )
                if name == "jump"
                else (name, shape)
                for name, shape in structure
            )

        return tuple(dict.fromkeys((at(0), at(1))))

    def points(self, structure: Structure, coefficients: Array) -> Points:
        """Return the readings."""
        return Points(
            velocity=self.rows.velocity,
            friction=self.response,
            load=self.rows.load,
            rows=np.arange(len(self.response)),
        )

    def asked(self) -> Rows:
        """Return the rows over which the band is stated: each measured direction, at mean load."""
        v = self.rows.velocity
        sides = [v[v < 0.0], v[v > 0.0]]
        grids = [
            np.sign(one[0]) * np.geomspace(np.abs(one).min(), np.abs(one).max(), ASKED)
            for one in sides
            if len(np.unique(one)) >= FEW_SPEEDS
        ]
        return self.at(np.sort(np.concatenate(grids)))

    def offered(self) -> Rows:
        """Return the readings that may be proposed: at the asked speeds."""
        return self.asked()

    def like(self, rows: Rows) -> Rows:
        """Return rows of another table as this one sees them: of any of its runs, at any time."""
        return self.at(rows.velocity, rows.load, rows.inputs)

    def speeds_of_curve(self) -> Array:
        """Return rising speeds (n,) through which a curve is drawn as a law."""
        return np.geomspace(self.frame.slowest, self.frame.fastest, POINTS)

    def composition(
        self, structure: Structure, coefficients: Array, *, offset: bool = False
    ) -> Composition:
        """Return the law that a structure with coefficients (d, p) is.

        Where friction is not in proportion to the load, it is the law at the mean load.
        """
        load, at = self.frame.load, 0
        terms: dict[str, tuple[Shape, Array]] = {}
        rig: dict[str, Array] = {}
        for name, shape in structure:
            size = self.size(name, shape)
            own, at = coefficients[:, at : at + size], at + size
            entries = self.terms[name].same_shape
            if entries is not None and len(shape) > entries and self.loaded:
                rig["load_exponent"] = np.full(len(own), shape[entries])
            if name == "offset":
                rig[name] = own[:, 0]
                if offset:
                    differs = own / load + terms.get("level_direction", ((), 0.0))[1]
                    terms["level_direction"] = (), differs
            elif name in ("adhesion", "drift"):  # columns are over the load
                rig[name] = load * own[:, 0]
            elif name == "hersey":  # the law at the mean load
                terms["stribeck"] = shape, own
            elif name != "run":
                beside = name in FLOWS or name.startswith("viscous")
                terms[name] = shape[:entries], own * (load if beside else 1.0)
        if "adhesion" in rig:  # part of the level at the mean load
            shape, own = terms["level"]
            terms["level"] = shape, own + rig["adhesion"][:, None] / load
        if "curve" in terms:
            return Composition(text="", values={}, rig=rig, load=load)
        found = compose(terms, self.frame.means, len(coefficients))
        return replace(found, rig=rig, load=load)

    def size(self, name: str, shape: Shape) -> int:
        """Return the number of coefficients of a term."""
        if name == "curve":
            return len(self.frame.knots) * (1 + int(shape[2])) * (1 + (shape[1] == BOTH))
        return int(self.rows.run.max()) + 1 if name == "run" else self.terms[name].cost

    @classmethod
    def of(cls, mechanism: Mechanism, measurement: Measurement) -> "TableProblem":
        """Return the problem of a measured table; readings at rest are left out.

        Examples
        --------
        >>> from stickslip import Axis
        >>> v = np.linspace(0.1, 1.0, 10)
        >>> table = Measurement(velocity=v, friction=2.0 + v)
        >>> len(TableProblem.of(Axis(inertia=1.0), table).response)
        10
        """
        segments = stretches_of(mechanism, measurement)
        parts, frictions = [], []
        for segment in segments:
            path, count = segment.path, len(segment.friction)
            v = path.velocity
            # sweeps under other loads or temperatures differ by these
            same = not any(np.ptp(x) > 0.0 for x in (path.load, *path.inputs.values()))
            one = len(segments) == 1 and same
            run = _sweeps(v) if one else np.full(count, segment.record)
            parts.append(
                Rows(
                    velocity=v,
                    load=path.load,
                    inputs=path.inputs,
                    run=run,
                    order=np.linspace(-1.0, 1.0, count),
                    direction=np.sign(v),
                ).where(v != 0.0)
            )
            frictions.append(segment.friction[v != 0.0])
        rows = Rows.joined(parts)
        if len(rows.velocity) < FEWEST:
            raise InputError(
                f"a table of friction needs at least {FEWEST} readings that slide, and this has"
                f" {len(rows.velocity)}: measure friction at more speeds."
            )
        most = max(len(np.unique(rows.velocity[rows.direction == way])) for way in (-1.0, 1.0))
        if most < FEW_SPEEDS:
            raise InputError(
                f"a law of friction over speed needs at least {FEW_SPEEDS} speeds in one direction,"
                f" and this table has {most}: measure friction at more speeds."
            )
        return cls(rows, np.concatenate(frictions))


def _sweeps(velocity: Array) -> NDArray[np.intp]:
    """Return the number of the sweep of each row (n,), if each meets all speeds once.

    Examples
    --------
    >>> _sweeps(np.array([0.1, 0.2, 0.3, 0.1, 0.2, 0.3])).tolist()
    [0, 0, 0, 1, 1, 1]
    >>> _sweeps(np.array([0.1, 0.1, 0.2, 0.2, 0.3, 0.3])).tolist()
    [0, 0, 0, 0, 0, 0]
    """
    known, count = np.unique(velocity), len(velocity)
    sweeps = np.arange(count) // len(known)
    parts = [velocity[sweeps == k] for k in range(int(sweeps[-1]) + 1)]
    alike = all(np.array_equal(np.sort(one), known) for one in parts)
    return sweeps if alike and len(parts) > 1 and len(known) > 2 else np.zeros(count, dtype=int)


def _blocks(speeds: Array, loads: Array) -> list[Mask]:
    """Return a block for each speed, and for each load where there are three or more."""
    by_speed = np.argmin(np.abs(speeds[:, None] - _apart(speeds)), axis=1)
    count = int(by_speed.max()) + 1
    by_speed = by_speed * min(count, STRETCHES) // count  # neighbours together
    by_load = np.unique(np.round(loads, 6), return_inverse=True)[1]
    blocks = [by_speed == k for k in range(by_speed.max() + 1)]
    if by_load.max() > 1 and by_speed.max() > 1:
        blocks += [by_load == k for k in range(by_load.max() + 1)]
    return blocks


def _apart(logs: Array) -> Array:
    """Return speeds as logarithms, those next to each other as their mean.

    Examples
    --------
    >>> _apart(np.log([1.0, 1.001, 2.0, 2.001])).round(4).tolist()
    [0.0005, 0.6934]
    """
    known = np.sort(logs)
    groups = np.split(known, np.flatnonzero(np.diff(known) > ALIKE) + 1)
    return np.array([float(np.mean(one)) for one in groups])


def both_ways(rows: Rows) -> bool:
    """Return whether there are readings at several speeds in both directions."""
    sides = (rows.velocity[rows.velocity > 0.0], rows.velocity[rows.velocity < 0.0])
    return all(len(np.unique(one)) >= FEW_SPEEDS for one in sides)


def _knots(logs: Array) -> Array:
    """Return knots at the speeds, between them, and beyond them."""
    if len(logs) < 3:
        inside = np.array([logs[0] - 0.5, float(np.mean(logs)), logs[-1] + 0.5])
    else:
        count = min(STRETCHES - 1, 2 * len(logs) - 1)  # as many as blocks have gaps
        inside = np.interp(np.linspace(0, len(logs) - 1, count), np.arange(len(logs)), logs)
    beyond = np.linspace(0.0, FAR, BEYOND + 1)[1:]
    return np.concatenate([inside[0] - beyond[::-1], inside, inside[-1] + beyond])


def _gaps(speed: Array) -> list[float]:
    """Return the middles between neighbouring speeds, two of which at least are on either side."""
    known = np.log(np.unique(speed))
    return np.exp(0.5 * (known[1:-2] + known[2:-1])).tolist() if len(known) > 3 else []


def _terms(rows: Rows, frame: Frame, *, loaded: bool) -> dict[str, Term]:
    """Return the vocabulary of tables."""

    def weight(r: Rows, exponent: float) -> Array:
        return r.direction * frame.load * (r.load / frame.load) ** exponent

    def law(
        shape_of_speed: Callable[[Array, Shape], Array], entries: int, usual: float
    ) -> Callable[[Rows, Shape], Array]:
        def columns(r: Rows, shape: Shape) -> Array:
            exponent = shape[entries] if len(shape) > entries else usual
            return np.asarray(weight(r, exponent) * shape_of_speed(r.speed, shape))

        return columns

    def curve(r: Rows, shape: Shape) -> Array:
        over = r.load / frame.load if shape[1] == HERSEY else 1.0
        logs = np.log(np.maximum(r.speed / over, frame.slowest * 1e-3))
        bent = _hats(logs, frame.knots) @ frame.basis
        powers = (1.0, 0.0) if shape[1] == BOTH else (1.0,) if shape[1] == HERSEY else shape[1:2]
        hats = np.hstack([weight(r, a)[:, None] * bent for a in powers])
        return np.hstack([hats, r.direction[:, None] * hats]) if shape[2] else hats

    speeds = np.geomspace(frame.slowest / 1.5, frame.fastest, 9)
    ratio = float(speeds[1] / speeds[0])
    loads: list[Shape] = [(), *((a,) for a in LOAD_EXPONENTS)] if loaded else [()]
    falls = [(float(v), float(n)) for v in speeds for n in (1, 2)]
    saturations = np.geomspace(frame.slowest, frame.fastest, 6)
    flows = frozenset({"power", "drag", "saturating", "logarithmic"})
    part: Mapping[str, Any] = {"role": "law", "nonnegative": True}
    load_ratio = 1.15 if loaded else 1.0
    terms = [
        Term(
            name="level", columns=law(lambda u, _: np.ones(len(u)), 0, 1.0), shapes=loads,
            steps=(load_ratio,), same_shape=0, title=TITLES["level"], rank=0, **part,
        ),
        Term(
            name="viscous", columns=law(lambda u, _: u, 0, 0.0), shapes=loads,
            steps=(load_ratio,), same_shape=0, title=TITLES["viscous"], rank=1, **part,
        ),
        Term(
            name="stribeck",
            columns=law(lambda u, s: np.exp(-((u / s[0]) ** s[1])), 2, 1.0),
            shapes=[(*fall, *a) for fall in falls for a in loads], steps=(ratio, 1.0, load_ratio),
            same_shape=2, needs=frozenset({"level"}), title=TITLES["stribeck"], rank=2, **part,
        ),
        Term(
            name="drag", columns=law(lambda u, _: u**2, 0, 0.0), shapes=loads,
            steps=(load_ratio,), same_shape=0, excludes=flows - {"drag"},
            title=TITLES["drag"], rank=4, **part,
        ),
        Term(
            name="power", columns=law(lambda u, s: u ** s[0], 1, 0.0),
            shapes=[(p, *a) for p in SPEED_EXPONENTS for a in loads],
            steps=(1.25, load_ratio), same_shape=1,
            ranges=(bounds_of("power", "viscous_exponent"), (0.0, math.inf)),
            excludes=(flows | {"viscous"}) - {"power"},
            title=TITLES["power"], rank=5, **part,
        ),
        Term(
            name="saturating", columns=law(lambda u, s: s[0] * np.arctan(u / s[0]), 1, 0.0),
            shapes=[(float(v), *a) for v in saturations for a in loads],
            steps=(float(saturations[1] / saturations[0]), load_ratio), same_shape=1,
            excludes=(flows | {"viscous"}) - {"saturating"}, rank=13,
            title=TITLES["saturating"], **part,
        ),
        Term(
            name="logarithmic",
            columns=law(lambda u, s: np.log1p(u / s[0]), 1, 1.0),
            shapes=[(frame.slowest * 10.0**k, *a) for k in (-1.0, 0.0, 1.0) for a in loads],
            steps=(10.0, load_ratio), same_shape=1, role="law", excludes=flows - {"logarithmic"},
            title="logarithm of the speed", rank=14,
        ),
        Term(
            name="tanh", columns=law(lambda u, s: np.tanh(u / s[0]), 1, 1.0),
            shapes=[(float(v), *a) for v in speeds[:6] for a in loads],
            steps=(ratio, load_ratio), same_shape=1, excludes=frozenset({"level", "stribeck"}),
            title="level that is smooth in the velocity (tanh)", rank=6, **part,
        ),
        Term(
            name="jump", role="curve", needs=frozenset({"curve"}), shapes=(), steps=(1.0,),
            columns=lambda r, shape: weight(r, 1.0) * (r.speed > shape[0]),
            title=TITLES["jump"], rank=8,
        ),
        Term(
            name="curve", role="curve", columns=curve, shapes=(),
            precision=lambda shape: shape[0]
            * frame.load**2  # of a force, as the noise is
            * np.tile(frame.bending, (1 + int(shape[2])) * (1 + (shape[1] == BOTH))),
            title=TITLES["curve"], cost=2,
        ),
    ]  # fmt: skip
    if both_ways(rows):
        terms += [
            Term(name="offset", role="rig", columns=lambda r, _: np.ones(len(r.load)),
                 title=TITLES["offset"], rank=3),
            Term(name="level_direction", role="law", needs=frozenset({"level"}), contrasts=1,
                 columns=lambda r, _: r.load, title=TITLES["level_direction"], rank=7),
            Term(name="viscous_direction", role="law", needs=frozenset({"viscous"}), contrasts=1,
                 columns=lambda r, _: frame.load * r.speed,
                 title=TITLES["viscous_direction"], rank=8),
            Term(name="stribeck_sides", role="law", needs=frozenset({"level"}), cost=2, contrasts=1,
                 excludes=frozenset({"stribeck"}), shapes=falls, steps=(ratio, 1.0),
                 columns=lambda r, s: (r.load * np.exp(-((r.speed / s[0]) ** s[1])))[:, None]
                 * np.column_stack([r.direction, np.ones(len(r.load))]),
                 title=TITLES["stribeck_direction"], rank=9),
        ]  # fmt: skip
        if not loaded:  # under one load they are the same column
            terms = [one for one in terms if one.name != "level_direction"]
    if loaded:
        terms.append(
            Term(name="adhesion", role="law", needs=frozenset({"level"}), nonnegative=True,
                 columns=lambda r, _: r.direction * frame.load, title=TITLES["adhesion"], rank=3)
        )  # fmt: skip
        terms.append(
            Term(name="hersey", shapes=falls, steps=(ratio, 1.0), rank=6, **part,
                 columns=lambda r, s: weight(r, 1.0)
                 * np.exp(-((r.speed * frame.load / r.load / s[0]) ** s[1])),
                 excludes=frozenset({"stribeck", "stribeck_sides"}), needs=frozenset({"level"}),
                 title="static surplus that fades with speed over load (Hersey number)")
        )  # fmt: skip
    for name, values in rows.inputs.items():
        if np.ptp(values) > 0.0:
            terms += _of_input(name, frame)
    if _shuffled(rows):
        terms.append(
            Term(name="drift", role="fault", rank=10,
                 shapes=[(settling, of) for settling in RUNNING_IN for of in (0.0, 1.0)],
                 columns=lambda r, s: weight(r, 1.0) * _course(r.order, s[0])
                 * (frame.straight[0] + frame.straight[1] * r.speed if s[1] else 1.0),
                 title="drift in the order of measuring")
        )  # fmt: skip
    if rows.run.max() > 0:
        count = int(rows.run.max()) + 1
        terms.append(
            Term(name="run", role="run", shapes=[(one,) for one in RUN_SPREADS], rank=3,
                 columns=lambda r, _: weight(r, 1.0)[:, None] * _of_runs(r.run, count),
                 precision=lambda shape: frame.load**2 / shape[0] ** 2,
                 title="differences between runs")
        )  # fmt: skip
    return {one.name: one for one in terms}


def _of_input(name: str, frame: Frame) -> list[Term]:
    """Return terms of the vocabulary that change with an input of the contact."""
    return [
        Term(name=f"level*{name}", role="law", needs=frozenset({"level"}), rank=11, contrasts=1,
             columns=lambda r, _: r.direction * r.load * (r.inputs[name] - frame.means[name]),
             title=CHANGING["level"].format(name)),
        Term(name=f"viscous*{name}", role="law", needs=frozenset({"viscous"}), rank=12, contrasts=1,
             columns=lambda r, _: frame.load * r.velocity * (r.inputs[name] - frame.means[name]),
             title=CHANGING["viscous"].format(name)),
    ]  # fmt: skip


def _of_runs(run: NDArray[np.intp], count: int) -> Array:
    """Return columns (n, r) of the runs, whose mean is that of the law: 0 for any run."""
    own = run[:, None] == np.arange(count)
    return np.where(run[:, None] < 0, 0.0, own - 1.0 / count)


def _shuffled(rows: Rows) -> bool:
    """Return whether the order of measuring is another than that of speeds, loads and runs."""
    logs = np.log(rows.speed + 1e-9 * rows.speed.max())
    known = [np.ones(len(rows.order)), rows.velocity, logs, np.log(rows.load), rows.run]
    x = np.column_stack([*known, rows.direction, *rows.inputs.values()])
    left = rows.order - x @ np.linalg.lstsq(x, rows.order, rcond=None)[0]
    return bool(len(left) > x.shape[1] + 2 and np.var(left) > SHUFFLED * np.var(rows.order))


def _course(order: Array, settling: float) -> Array:
    """Return a drift over the order from -1 to 1: a line, or what settles; 0 at its mean.

    From first to last it changes by 1.
    """
    if settling == 0.0:
        return 0.5 * order
    decay = np.exp(-0.5 * (order + 1.0) / settling)
    mean, change = settling * (1.0 - math.exp(-1.0 / settling)), math.exp(-1.0 / settling) - 1.0
    return np.asarray((decay - mean) / change)


def _straight(rows: Rows, friction: Array) -> Array:
    """Return level and slope (2,) of the line through friction over speed and load, of mean 1."""
    x = (rows.load / rows.load.mean())[:, None] * np.column_stack(
        [np.ones_like(rows.speed), rows.speed]
    )
    line, _ = nnls(x, rows.direction * friction)
    mean = float(np.mean(x @ line))
    return line / mean if mean > 0.0 else np.array([1.0, 0.0])


def _hats(logs: Array, knots: Array) -> Array:
    """Return hat functions (n, k) at the knots, straight beyond the outer ones."""
    hats = np.array([np.interp(logs, knots, one) for one in np.eye(len(knots))]).T
    over = logs - np.clip(logs, knots[0], knots[-1])
    for edge, inner in ((-1, -2), (0, 1)):
        side = over > 0.0 if edge == -1 else over < 0.0
        share = np.where(side, over / (knots[edge] - knots[inner]), 0.0)
        hats[:, edge] += share
        hats[:, inner] -= share
    return np.asarray(hats)
