"""What is searched: the goal of a motion in its steady cycle, and what it breaks, in all cases."""

import dataclasses
import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Annotated, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.simulation import simulate
from stickslip.engine.solver import EventDriven
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, ParameterError, not_whole
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import Mechanism, Prescribed, slipping, static_normal_forces
from stickslip.mechanisms.drives import Profile
from stickslip.quantities import Parametrised, Quantity, full_path, parameters, vary
from stickslip.show.described import Described
from stickslip.show.formatting import number, percent, quantity

# The steady cycle of a mechanism that repeats a motion: what it brings and what it takes.

Array = NDArray[np.float64]

FIRST_CYCLES = 3
"""Cycles that are run before it is asked whether they repeat."""
MOST_CYCLES = 48
"""Cycles after which no more are tried."""
REPEATED = 1e-6
"""Change from cycle to cycle, over the largest in a cycle, that still counts as the same."""
SAMPLES = 257
"""Evenly spread times of a cycle at which extremes are looked for first."""
ZOOM = 17
"""Times between the neighbours of the best of those."""
QUARTERS = 4
"""Stretches of a motion without steps."""
GAUSS = 0.5 / math.sqrt(3.0)
"""Distance of the two Gauss points from the middle of a cell, over its width."""


@dataclass(frozen=True, kw_only=True)
class Cycle(metaclass=Described):
    """The last of some cycles, in SI units.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    >>> cycle = measure(capsule, Coulomb(kinetic_coefficient=0.2))
    >>> round(cycle.travel, 7), cycle.repeats
    (0.0064304, True)
    """

    run: Trajectory = field(repr=False)
    """All cycles from rest on."""
    begin: float
    """When the last cycle begins [s]."""
    period: float
    """How long it lasts [s]."""
    lasted: float = 1.0
    """Share of the time asked for that the run lasted: below 1 where it ended early."""
    repeats: bool
    """Whether travel and velocity are those of the cycle before."""
    travel: float
    """Way forward [m]."""
    work: float
    """Positive work of the motor [J]."""
    position: float
    """Largest distance of the inner body from its middle [rad] or [m]."""
    rate: float
    """Largest speed of it [rad/s] or [m/s]."""
    acceleration: float
    """Largest acceleration of it [rad/s^2] or [m/s^2]."""
    effort: float
    """Largest torque [N m] or force [N]."""
    load_share: float
    """Least normal force over the weight."""
    back_slip: float
    """Back-slip: all motion in the negative direction [m]."""
    peaks: Mapping[str, Array] = field(default_factory=dict, repr=False)
    """Extremes of each stretch of the motion, both ways, by the name of the limit: where a motion
    has several of about one size, each changes smoothly and their largest does not."""

    @property
    def energy(self) -> float:
        """Positive work of the motor over the travel [J/m]; infinite where there is none."""
        return self.work / self.travel if self.travel > 0.0 else math.inf


def motor_of(mechanism: Mechanism) -> str:
    """Return the field of a mechanism whose motor prescribes a motion.

    Examples
    --------
    >>> from stickslip import Capsule
    >>> from stickslip.mechanisms.drives import SineSwing
    >>> from stickslip.mechanisms import Prescribed
    >>> swing = Prescribed(profile=SineSwing(amplitude=0.01, frequency=2.0))
    >>> motor_of(Capsule(capsule_mass=0.8, inner_mass=0.2, drive=swing))
    'drive'
    """
    for entry in dataclasses.fields(mechanism):
        if isinstance(getattr(mechanism, entry.name), Prescribed) and mechanism.guided():
            return entry.name
    raise InputError(
        f"mechanism must have a prescribed motion to be optimised, got {type(mechanism).__name__}"
        " without one: give it Prescribed(profile=...), as in PendulumCart(pendulum=...) or"
        " Capsule(drive=...)."
    )


def fitted(mechanism: Mechanism, profile: Profile, *, limit: float | None = None) -> Mechanism:
    """Return the mechanism with another motion, and its motor with a limit, none if not given."""
    return dataclasses.replace(
        mechanism, **{motor_of(mechanism): Prescribed(profile=profile, limit=limit)}
    )


def guide_of(mechanism: Mechanism) -> tuple[str, str, str, str]:
    """Return the names of the guided coordinate, its rate and its effort, and its unit.

    Examples
    --------
    >>> from stickslip import Capsule
    >>> from stickslip.mechanisms.drives import SineSwing
    >>> from stickslip.mechanisms import Prescribed
    >>> swing = Prescribed(profile=SineSwing(amplitude=0.01, frequency=2.0))
    >>> guide_of(Capsule(capsule_mass=0.8, inner_mass=0.2, drive=swing))
    ('xi', 'xi_dot', 'force', 'm')
    """
    (coordinate,) = mechanism.guided()
    place = mechanism.coordinates.index(coordinate)
    effort = mechanism.guided()[coordinate].effort
    return coordinate, mechanism.rates[place], effort, mechanism.units[place]


def units_of_limits(mechanism: Mechanism) -> dict[str, str]:
    """Return the units that limits have for a mechanism, by name.

    Examples
    --------
    >>> from stickslip import Capsule
    >>> from stickslip.mechanisms.drives import SineSwing
    >>> from stickslip.mechanisms import Prescribed
    >>> swing = Prescribed(profile=SineSwing(amplitude=0.01, frequency=2.0))
    >>> units_of_limits(Capsule(capsule_mass=0.8, inner_mass=0.2, drive=swing))["effort"]
    'N'
    """
    motor_of(mechanism)
    coordinate, _, _, unit = guide_of(mechanism)
    return {
        "position": unit,
        "rate": f"{unit}/s",
        "acceleration": f"{unit}/s^2",
        "effort": mechanism.guided()[coordinate].unit,
        "load_share": "1",
        "back_slip": "m",
        "energy": "J/m",
    }


def slip_of_body(mechanism: Mechanism) -> str:
    """Return the coordinate along which the body slips whose inner motion is prescribed."""
    guided = mechanism.guided()
    found = [name for name in slipping(mechanism) if name not in guided]
    if not found:
        raise InputError(
            f"the motion prescribes {', '.join(slipping(mechanism))}, the slip itself: there is"
            " nothing to optimise."
        )
    if len(found) > 1:
        raise InputError(
            f"the contacts of {type(mechanism).__name__} slip along {', '.join(found)}: a motion is"
            " optimised for the travel along one coordinate."
        )
    return found[0]


def load_shares(mechanism: Mechanism, seen: Trajectory) -> dict[str, Array]:
    """Return normal forces over those at rest, by column of a run."""
    found = {}
    static = static_normal_forces(mechanism)
    bearing = {contact: force for contact, force in static.items() if force != 0.0}
    for contact, force in (bearing or static).items():
        for column in ("normal_force", f"normal_force:{contact}"):
            if column in seen.names:
                found[column] = seen[column] / force
    return found


def measure(mechanism: Mechanism, law: FrictionLaw | Laws, *, samples: int = SAMPLES) -> Cycle:
    """Run cycles until they repeat, and measure the last one.

    Parameters
    ----------
    mechanism : Mechanism
        With a prescribed motion.
    law : FrictionLaw or Laws
        What holds it back.
    samples : int
        Evenly spread times at which extremes are looked for; between the neighbours of the best
        it is looked once more.

    Returns
    -------
    Cycle
        `repeats` is False where 48 cycles were not enough, and where the run ended early.

    Examples
    --------
    >>> import math
    >>> from stickslip import Coulomb, PendulumCart
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    >>> cart = PendulumCart(
    ...     cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    ... )
    >>> cycle = measure(cart, Coulomb(kinetic_coefficient=0.2))
    >>> round(cycle.travel, 7), round(1e3 * cycle.back_slip, 2)
    (0.0634659, 0.31)
    """
    profile = getattr(mechanism, motor_of(mechanism)).profile
    period, count = float(profile.period), FIRST_CYCLES
    while True:
        run = simulate(
            mechanism,
            law,
            t_end=count * period,
            solver=EventDriven(tier="compiled"),
            throw=False,
        )
        if not run.status.complete:
            return _cut_short(run, period, run.span[1] / (count * period))
        repeats = _repeats(mechanism, run, count, period)
        if repeats or 2 * count > MOST_CYCLES:
            slip = slip_of_body(mechanism)
            begin, end = (count - 1) * profile.period, count * profile.period
            nodes = _nodes(run, profile, float(begin), float(end), samples)
            seen = run.at(nodes)
            columns = _columns(mechanism, seen)
            stretches = _stretches(profile, nodes, float(begin))
            extremes = _extremes(run, nodes, columns, mechanism)
            x, accelerations = seen[slip], _accelerations(profile)
            return Cycle(
                run=run,
                begin=float(begin),
                period=float(profile.period),
                repeats=repeats,
                travel=float(x[-1] - x[0]),
                work=_positive_work(mechanism, run, nodes),
                back_slip=float(np.maximum(-np.diff(x), 0.0).sum()),
                peaks={
                    name: _peaks(column, stretches, extremes[name], both=name != "load_share")
                    for name, column in columns.items()
                }
                | {"acceleration": accelerations},
                position=extremes["position"],
                rate=extremes["rate"],
                acceleration=float(accelerations.max()),
                effort=extremes["effort"],
                load_share=extremes["load_share"],
            )
        count *= 2


def _cut_short(run: Trajectory, period: float, lasted: float) -> Cycle:
    """Return a cycle of which nothing is known but when it ended."""
    measured = ("travel", "work", "position", "rate", "acceleration", "effort", "load_share")
    unknown: dict[str, Any] = dict.fromkeys((*measured, "back_slip"), math.nan)
    return Cycle(run=run, begin=0.0, period=period, lasted=lasted, repeats=False, **unknown)


def _repeats(mechanism: Mechanism, run: Trajectory, count: int, period: float) -> bool:
    """Whether the last cycle is like the one before it."""
    slip = slip_of_body(mechanism)
    rate = mechanism.rates[mechanism.coordinates.index(slip)]
    last = run.at(np.linspace((count - 1) * period, count * period, 33))
    before = run.at([(count - 2) * period])
    x, v = last[slip], last[rate]
    # Travel of the last cycle less that of the one before.
    more = (x[-1] - x[0]) - (x[0] - before[slip][0])
    return bool(
        abs(more) <= REPEATED * np.ptp(x) and abs(v[-1] - v[0]) <= REPEATED * np.abs(v).max()
    )


def _columns(mechanism: Mechanism, seen: Trajectory) -> dict[str, Array]:
    """Return what has limits, by their names."""
    coordinate, rate, effort, _ = guide_of(mechanism)
    return {
        "position": seen[coordinate],
        "rate": seen[rate],
        "effort": seen[effort],
        "load_share": np.min(list(load_shares(mechanism, seen).values()), axis=0),
    }


def _positive_work(mechanism: Mechanism, run: Trajectory, nodes: Array) -> float:
    """Return the work of the motor where it drives, by two Gauss points a cell."""
    _, rate, effort, _ = guide_of(mechanism)
    widths = np.diff(nodes)
    middles = nodes[:-1] + 0.5 * widths
    power = np.zeros_like(widths)
    for side in (-GAUSS, GAUSS):
        seen = run.at(middles + side * widths)
        power = power + np.maximum(seen[effort] * seen[rate], 0.0)
    return float((0.5 * widths * power).sum())


def _nodes(run: Trajectory, profile: Profile, begin: float, end: float, samples: int) -> Array:
    """Return even times, and those at which something jumps, also just before."""
    jumps = [float(piece.start) for piece in profile.pieces(end)]
    jumps += [event.t for event in run.events]
    inside = np.array([t for t in jumps if begin < t < end])
    # Just before a jump too, so that both of its sides are seen.
    before = np.nextafter(inside, -np.inf)
    return np.unique(np.concatenate([np.linspace(begin, end, samples), inside, before]))


def _stretches(profile: Profile, nodes: Array, begin: float) -> list[slice]:
    """Return the nodes of each stretch between the steps of a motion, at least one each."""
    starts = [float(piece.start) for piece in profile.pieces(0.0)]
    # A motion without steps is cut into parts, each with extremes of its own.
    if len(starts) < 2:
        starts = np.linspace(0.0, float(profile.period), QUARTERS, endpoint=False).tolist()
    ends = [begin + start for start in (*starts[1:], float(profile.period))]
    firsts = np.searchsorted(nodes, [begin + start for start in starts]).tolist()
    lasts = np.searchsorted(nodes, ends).tolist()
    most = len(nodes) - 1
    return [
        slice(min(a, most), max(b, min(a, most) + 1)) for a, b in zip(firsts, lasts, strict=True)
    ]


def _accelerations(profile: Profile) -> Array:
    """Return the largest acceleration of each piece of a cycle, or of a motion without pieces."""
    smooth = max(abs(float(bound)) for bound in profile.smooth_bound())
    pieces = profile.pieces(0.0)
    if not pieces:
        return np.array([smooth])
    starts = np.array([float(piece.start) for piece in pieces])
    widths = np.diff([*starts, float(profile.period)])
    first = np.array([float(piece.value) for piece in pieces])
    last = first + widths * np.array([float(piece.slope) for piece in pieces])
    return np.asarray(np.maximum(np.abs(first), np.abs(last)) + smooth)


def _peaks(column: Array, stretches: list[slice], extreme: float, *, both: bool) -> Array:
    """Return extremes by stretch, moved by what the nodes miss of the extreme of all."""
    if not both:
        least = np.array([column[stretch].min() for stretch in stretches])
        return np.asarray(least + (extreme - least.min()))
    most = [column[stretch].max() for stretch in stretches]
    found = np.array([*most, *(-column[stretch].min() for stretch in stretches)])
    return np.asarray(found + (extreme - found.max()))


def _extremes(
    run: Trajectory, nodes: Array, columns: Mapping[str, Array], mechanism: Mechanism
) -> dict[str, float]:
    """Return the extreme of each column, looked for between the neighbours of the extreme node."""
    sizes = _sizes(columns)
    best = {name: int(np.argmax(size)) for name, size in sizes.items()}
    pairs = [(nodes[max(i - 1, 0)], nodes[min(i + 1, len(nodes) - 1)]) for i in best.values()]
    near = run.at(np.concatenate([np.linspace(*pair, ZOOM) for pair in pairs]))
    finer = _sizes(_columns(mechanism, near))
    found = {
        name: max(float(size[best[name]]), float(finer[name][k * ZOOM : (k + 1) * ZOOM].max()))
        for k, (name, size) in enumerate(sizes.items())
    }
    return found | {"load_share": -found["load_share"]}


def _sizes(columns: Mapping[str, Array]) -> dict[str, Array]:
    """Return what must not grow too large."""
    return {name: -c if name == "load_share" else np.abs(c) for name, c in columns.items()}


# The cases that a motion must stand: one, an interval of parameters, or samples of a law.


MOST_POINTS = 200
SHARE = Quantity("quantile", low=0, high=1)


@dataclass(frozen=True, kw_only=True)
class Scenarios(metaclass=Described):
    """Laws, with changes to the mechanism, and what counts of them.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> two = tuple(Coulomb(kinetic_coefficient=mu) for mu in (0.2, 0.3))
    >>> cases = Scenarios(laws=two, changes=({}, {}), quantile=0.0, words="the worse of two")
    >>> cases.weights(np.array([3.0, 1.0])).tolist()
    [0.0, 1.0]
    """

    laws: tuple[FrictionLaw | Laws, ...]
    """A law for each scenario."""
    changes: tuple[Mapping[str, float], ...]
    """Values of the mechanism by path, for each scenario."""
    quantile: float | Literal["mean"]
    """Which quantile of the goal counts, 0 of which is the worst case; or that its mean does."""
    words: str
    """What they are, as reports say it."""

    def __len__(self) -> int:
        """Return the number of scenarios."""
        return len(self.laws)

    def weights(self, values: Array) -> Array:
        """Return what each value counts (n,): the quantile, or the mean, is their sum."""
        if self.quantile == "mean":
            return np.full(len(values), 1.0 / len(values))
        # Between neighbours in rank, as quantiles by linear interpolation are.
        place = self.quantile * (len(values) - 1)
        low = int(place)
        found = np.zeros(len(values))
        order = np.argsort(values, kind="stable")
        found[order[low]] = 1.0 - (place - low)
        if place > low:
            found[order[low + 1]] = place - low
        return found


def scenarios_of(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    interval: Mapping[str, tuple[float, float]] | None,
    laws: Sequence[FrictionLaw | Laws] | None,
    quantile: float | Literal["mean"],
    points: int,
) -> Scenarios:
    """Return the scenarios that the arguments of `optimise_profile` stand for."""
    if interval and laws is not None:
        raise InputError("interval and scenarios are both given: leave one out.")
    if laws is not None:
        return _samples(laws, quantile)
    if interval:
        return _grid(mechanism, law, interval, points)
    return Scenarios(laws=(law,), changes=({},), quantile=0.0, words="the given law")


def _samples(laws: Sequence[FrictionLaw | Laws], quantile: float | Literal["mean"]) -> Scenarios:
    if not laws or not all(isinstance(law, FrictionLaw | Laws) for law in laws):
        raise InputError(f"scenarios must be friction laws, at least one, got {laws!r}.")
    share: float | Literal["mean"] = "mean"
    words = "the mean"
    if quantile != "mean":
        share = SHARE.check("optimise_profile", "quantile", quantile)
        words = f"the {percent(share)} quantile" if share else "the worst"
    return Scenarios(
        laws=tuple(laws),
        changes=({},) * len(laws),
        quantile=share,
        words=f"{words} of {len(laws)} laws",
    )


def _grid(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    interval: Mapping[str, tuple[float, float]],
    points: int,
) -> Scenarios:
    """Return evenly spread values of each parameter, ends included, in all combinations."""
    if type(points) is not int or points < 2:
        raise ParameterError(not_whole("points", 2, points))
    known = {
        path: quantity
        for root, prefix in ((mechanism, "mechanism"), (law, "friction"))
        for path, quantity, _ in parameters(root, prefix)
        if not path.startswith(f"mechanism.{motor_of(mechanism)}.")
    }
    axes = {full_path(path, known): _range(path, ends) for path, ends in interval.items()}
    if points ** len(axes) > MOST_POINTS:
        raise InputError(
            f"interval has {points}^{len(axes)} combinations; the limit is {MOST_POINTS}: give"
            " fewer points or fewer parameters."
        )
    rows = [
        dict(zip(axes, values, strict=True))
        for values in itertools.product(
            *(np.linspace(*ends, points).tolist() for ends in axes.values())
        )
    ]
    own = [{p: v for p, v in row.items() if p.startswith("mechanism.")} for row in rows]
    others = [{p: v for p, v in row.items() if p not in mine} for row, mine in zip(rows, own)]  # noqa: B905  # made of each other
    ranges = ", ".join(
        f"{path} {number(low)} to {number(high)}" for path, (low, high) in axes.items()
    )
    return Scenarios(
        laws=tuple(vary(law, "friction", row) if row else law for row in others),
        changes=tuple(own),
        quantile=0.0,
        words=f"the worst of {len(rows)} evenly spaced points of {ranges}",
    )


def _range(path: str, ends: object) -> tuple[float, float]:
    """Return the ends of an interval, checked."""
    try:
        low, high = (float(end) for end in ends)  # type: ignore[attr-defined]  # whatever was given
    except (TypeError, ValueError):
        raise InputError(f"interval[{path!r}] must be (low, high), got {ends!r}.") from None
    if not low < high:
        raise InputError(f"interval[{path!r}] must increase, got {low:g} to {high:g}.")
    return low, high


# What is searched: the goal of a motion and what it breaks, over all scenarios.


UNIT_OF_BACK_SLIP = 1e-3
"""What counts as one unit of violation where no back-slip at all is allowed [m]."""
ROUNDING = 1e-9
"""Share of a limit by which it may be exceeded: a motion that just reaches it is rounded."""
SAFETY = 1e-5
"""Share of each limit that a search leaves: extremes are looked for more finely in the end."""
FAILED = 10.0
"""Violation of a motion that cannot be gone through or does not repeat itself."""
FINER = 4097
"""Times of a cycle at which the extremes of a result are looked for."""
GoalName: TypeAlias = Literal["travel", "speed", "economy"]


@dataclass(frozen=True, kw_only=True)
class Limits(Parametrised):
    """What a motion may take; a limit that is not given does not hold.

    Parameters
    ----------
    position : float
        Largest distance of the inner body from its middle: angle [rad] or half a stroke [m].
    rate : float
        Largest speed of it [rad/s] or [m/s].
    acceleration : float, optional
        Largest acceleration of it [rad/s^2] or [m/s^2].
    effort : float, optional
        Largest torque [N m] or force [N].
    load_share : float
        Least normal force over the weight. At 0 the run itself ends where the body lifts off.
    back_slip : float, optional
        Longest way that the body slips back in a cycle [m].
    energy : float, optional
        Largest positive work of the motor over the travel [J/m].

    Examples
    --------
    >>> import math
    >>> Limits(position=math.radians(60.0), rate=12.0, effort=0.6).load_share
    0.0
    """

    position: Annotated[float, Quantity("q_max", above=0)]
    rate: Annotated[float, Quantity("w_max", above=0)]
    acceleration: Annotated[float, Quantity("a_max", above=0)] | None = None
    effort: Annotated[float, Quantity("tau_max", above=0)] | None = None
    load_share: Annotated[float, Quantity("n_min", low=0, high=1)] = 0.0
    back_slip: Annotated[float, Quantity("s_back", "m", low=0)] | None = None
    energy: Annotated[float, Quantity("E_max", "J/m", above=0)] | None = None

    def given(self) -> dict[str, float]:
        """Return the limits that hold by name.

        Examples
        --------
        >>> Limits(position=0.5, rate=2.0).given()
        {'position': 0.5, 'rate': 2.0, 'load_share': 0.0}
        """
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        return {name: value for name, value in values.items() if value is not None}


@dataclass(frozen=True, kw_only=True)
class Margin(metaclass=Described):
    """How far a motion stays from one limit.

    Examples
    --------
    >>> Margin(name="rate", allowed=12.0, reached=11.5, unit="rad/s").margin
    0.5
    >>> Margin(name="position", allowed=0.01, reached=0.010000000000000231, unit="m").margin
    0.0
    """

    name: str
    """Which limit."""
    allowed: float
    """The limit."""
    reached: float
    """The extreme over the cycle, of all scenarios."""
    unit: str
    """Unit of both."""

    @property
    def margin(self) -> float:
        """What is left [unit]; below 0 where the limit is broken, by more than rounding."""
        left = self.allowed - self.reached
        if self.name == "load_share":
            left = -left
        allowance = ROUNDING * (self.allowed or UNIT_OF_BACK_SLIP)
        return 0.0 if -allowance <= left < 0.0 else left

    @property
    def share(self) -> float:
        """What is left over the limit itself; for loads and where nothing is allowed, as it is."""
        if self.name == "load_share":
            return self.margin
        return self.margin / (self.allowed or UNIT_OF_BACK_SLIP)


@dataclass(frozen=True, kw_only=True)
class Goal(metaclass=Described):
    """What is to be large."""

    name: str
    """Its name on the command line."""
    title: str
    """Its name in reports."""
    unit: str
    """Its unit."""
    value: Callable[[Cycle], float] = field(repr=False)
    """Read off a cycle."""


def _travel(cycle: Cycle) -> float:
    return cycle.travel


def _speed(cycle: Cycle) -> float:
    return cycle.travel / cycle.period


def _economy(cycle: Cycle) -> float:
    return cycle.travel / cycle.work if cycle.work > 0.0 else 0.0


GOALS: Mapping[str, Goal] = {
    goal.name: goal
    for goal in (
        Goal(name="travel", title="travel per cycle", unit="m", value=_travel),
        Goal(name="speed", title="mean speed", unit="m/s", value=_speed),
        Goal(name="economy", title="travel per work", unit="m/J", value=_economy),
    )
}
"""The goals by name."""


@dataclass(frozen=True, kw_only=True)
class ScoredMotion(metaclass=Described):
    """A profile, what it brings, and what it leaves of each limit.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> swing = ThreePhase(amplitude=0.8, fast=120.0, slow=30.0)
    >>> ScoredMotion(profile=swing, value=0.06, margins=(), cycles=()).feasible
    False
    """

    profile: Profile
    """The motion."""
    value: float
    """Its goal, in SI units; 0 where it is not known."""
    margins: tuple[Margin, ...]
    """What is left of each limit; none where the run ended early."""
    cycles: tuple[Cycle, ...]
    """The steady cycle of each scenario."""

    @property
    def early_end(self) -> str:
        """When a run ended early, and why, in words; empty where all lasted."""
        run = self._cut_short
        if run is None:
            return ""
        return f"its run stopped at {quantity(run.run.span[1], 's')}: {run.run.ending}"

    @property
    def _cut_short(self) -> Cycle | None:
        return next((cycle for cycle in self.cycles if cycle.lasted < 1.0), None)

    def shown(self, goal: Goal) -> Cycle:
        """Return the cycle of the scenario that does worst, or of the first that ended early."""
        return self._cut_short or min(self.cycles, key=goal.value)

    @property
    def violation(self) -> float:
        """What is broken, as the sum of shares of the limits; 0 if nothing is."""
        # The earlier a run ended the worse, so that a search finds its way out.
        ends = [FAILED * (2.0 - c.lasted) for c in self.cycles if not c.repeats]
        return sum(ends) + sum(max(0.0, -m.share) for m in self.margins)

    @property
    def feasible(self) -> bool:
        """Whether every scenario repeats itself within all limits."""
        return bool(self.cycles) and self.violation <= 0.0


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A mechanism, scenarios, a goal and limits."""

    mechanism: Mechanism
    """With any prescribed motion and without a limit of its motor."""
    scenarios: Scenarios
    """What it must stand."""
    goal: Goal
    """What is to be large."""
    limits: Limits
    """What it may take."""

    def cases(self, profile: Profile) -> list[Mechanism]:
        """Return the mechanism of each scenario with a motion."""
        moved = fitted(self.mechanism, profile)
        changes = self.scenarios.changes
        return [vary(moved, "mechanism", own) if own else moved for own in changes]

    def judge(self, profile: Profile, *, samples: int = SAMPLES) -> ScoredMotion:
        """Run a motion through all scenarios."""
        pairs = zip(self.cases(profile), self.scenarios.laws, strict=True)
        cycles = tuple(measure(mechanism, law, samples=samples) for mechanism, law in pairs)
        if any(cycle.lasted < 1.0 for cycle in cycles):
            return ScoredMotion(profile=profile, value=0.0, margins=(), cycles=cycles)
        values = self.values(cycles)
        return ScoredMotion(
            profile=profile,
            value=float(self.scenarios.weights(values) @ values),
            margins=self._margins(cycles),
            cycles=cycles,
        )

    def values(self, cycles: tuple[Cycle, ...]) -> Array:
        """Return the goal of each scenario (n,)."""
        return np.array([self.goal.value(cycle) for cycle in cycles])

    def _margins(self, cycles: tuple[Cycle, ...]) -> tuple[Margin, ...]:
        units = units_of_limits(self.mechanism)
        worst = {"load_share": min}
        return tuple(
            Margin(
                name=name,
                allowed=allowed,
                reached=worst.get(name, max)(getattr(cycle, name) for cycle in cycles),
                unit=units[name],
            )
            for name, allowed in self.limits.given().items()
        )

    def tighter(self) -> "Problem":
        """Return the problem with a little less of each limit, for searching."""
        given = self.limits.given()
        changed = {name: value * (1.0 - SAFETY) for name, value in given.items()}
        changed["load_share"] = min(1.0, given["load_share"] + SAFETY)
        return dataclasses.replace(self, limits=Limits(**changed))
