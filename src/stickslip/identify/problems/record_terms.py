"""The vocabulary of records of one coordinate: terms of laws, of the rig and faults."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from stickslip.identify.forces import TRANSMITTED
from stickslip.identify.laws import CHANGING, TITLES
from stickslip.identify.problem import RUNNING_IN, Array, Shape, Term
from stickslip.identify.problems.record_frame import APART, mean_frequency
from stickslip.identify.problems.record_signals import Along, Steady
from stickslip.identify.thresholds import THRESHOLDS

GAINS = frozenset({"force_gain", "position_scale"})
"""Terms of what a record is scaled by."""
DEAD_ZONE = "dead zone of the driver"
"""What a level may be where the force turns with the motion."""
EXPONENTS = (0.0, 1.0, 2.0)
"""Exponents of bristles: yields at once, Dahl and LuGre, slower."""
SHORTEST = 5.0
"""Shortest bristle over the noise of positions: what is shorter is made by it."""
GRID = 10
"""Shapes of a term that are tried first: lengths of bristles, and Stribeck velocities."""
DEAD = 6
"""Dead zones that are tried first."""
LIMITS = (1.0 / 3.0, 0.5, 0.75)
"""Least limits of the force over the largest: cut at little, nothing is left to explain."""
LATER = (0.88, 1.14)
"""Multiples of a delay that its column may have: others would only smooth the noise of the force,
of which it is made, by up to (1 - c)^2 + c^2 + 2 c (1 - c) r for noise with the correlation r.
Delays that are tried first are so near each other that none is missed."""
LATEST = 0.1
"""Delays and lags of the force over the period of the motion, at most."""
RINGS = 0.4
"""Largest resonance over the band."""
WAVES = 2
"""Wave numbers of the place that are looked at."""


def screened(
    rows: Along, response: Array, *, finds_inertia: bool
) -> tuple[list[Shape], list[float], list[float]]:
    """Return the memories whose plain law leaves least, and wave numbers of what is left.

    Those of the force, then those of the level: of what is left times the direction.
    """
    if rows.free == "momentum":  # bristles are stretched before such a motion
        return [(0.0, 0.0)], [], []
    best, e = _bristles(rows, response, finds_inertia=finds_inertia)
    if rows.free:  # what is left of the work is no force of a place
        return [(0.0, 0.0), *best], [], []
    frame = rows.frame
    q, level = rows.seen(rows.place), rows.seen(rows.direction * rows.load)
    most = min(120.0 * math.pi / frame.span, math.pi / (8.0 * frame.noise))
    numbers = np.arange(3.0 * math.pi / frame.span, most, 0.5 / frame.span)
    few = slice(None, None, max(rows.count // 1500, 1))
    turning = np.exp(-1j * np.outer(numbers, q[few]))
    first, second = (_peaks(numbers, turning @ one[few]) for one in (e, level * e))
    return [(0.0, 0.0), *best], first, second


def _bristles(rows: Along, response: Array, *, finds_inertia: bool) -> tuple[list[Shape], Array]:
    """Return the best memory of each exponent, the best first, and what the best leaves (n,)."""
    lengths = _lengths(rows)
    plain = [rows.acting(np.ones(len(rows.velocity))), rows.acting(rows.velocity)]
    plain += [rows.inertial] if finds_inertia else []
    plain += [rows.taken(path) for path, one in rows.records[0].unknown.items() if not one.doubt]
    left: dict[Shape, tuple[float, Array]] = {}

    def try_(memory: Shape) -> None:
        x = np.column_stack([*plain, rows.acting(rows.state(*memory) * rows.load)])
        x = x / np.sqrt(np.mean(x * x, axis=0) + 1e-300)
        gram = x.T @ x + 1e-9 * len(x) * np.eye(x.shape[1])
        e = response - x @ np.linalg.solve(gram, x.T @ response)
        left[memory] = float(np.mean(e * e)), e

    for n in EXPONENTS:
        for length in lengths.tolist():
            try_((length, n))
    ratio = float(lengths[1] / lengths[0])
    best = []
    for n in EXPONENTS:
        for k in range(THRESHOLDS.refinements):  # about the best, halfway to its neighbours
            top = min((one for one in left if one[1] == n), key=lambda one: left[one][0])
            for side in (-1.0, 1.0):
                length = top[0] * ratio ** (side * 0.5 ** (k + 1))
                try_((max(length, float(lengths[0])), n))
        best.append(min((one for one in left if one[1] == n), key=lambda one: left[one][0]))
    shorter = _of_two(rows, response, [(float(x), 1.0) for x in lengths], plain)
    if shorter is not None and all(abs(math.log(shorter[0] / one[0])) > 0.2 for one in best):
        best.append(shorter)
    for memory in [*rows._states]:  # the others are not needed any more
        if memory not in best:
            del rows._states[memory]
    try_((0.0, 0.0))
    e = min(left.values(), key=lambda one: one[0])[1]
    if rows.free and float(np.mean(e * e)) > THRESHOLDS.explained * left[0.0, 0.0][0]:
        return [], e  # swings that fade tell little of bristles
    best.sort(key=lambda one: left[one][0])
    return best, e


def _lengths(rows: Along) -> Array:
    """Return lengths of bristles: from noise, or a sample's way at slow speed, to a quarter."""
    frame = rows.frame
    sampled = frame.low * max(filt.step for filt in rows.filters)
    least = min(max(SHORTEST * frame.noise, sampled), frame.span / 8.0)
    return np.geomspace(least, frame.span / 4.0, GRID)


def _of_two(
    rows: Along, response: Array, memories: Sequence[Shape], plain: Sequence[Array]
) -> Shape | None:
    """Return the shorter of two memories that together leave much less than the best one alone."""
    states = [rows.acting(rows.state(*one) * rows.load) for one in memories]
    x = np.column_stack([*plain, *states])
    x = x / np.sqrt(np.mean(x * x, axis=0) + 1e-300)
    gram, moment = x.T @ x + 1e-9 * len(x) * np.eye(x.shape[1]), x.T @ response
    n, total = len(plain), float(response @ response)

    def left(*which: int) -> float:
        at = [*range(n), *(n + k for k in which)]
        c = np.linalg.solve(gram[np.ix_(at, at)], moment[at])
        return total - float(c @ moment[at]) if np.all(c[n:] > 0.0) else math.inf

    count = len(memories)
    pairs = {(i, j): left(i, j) for i in range(count) for j in range(i + 1, count)}
    best = min(pairs, key=lambda one: pairs[one])
    alone = min(left(k) for k in range(count))
    return memories[best[0]] if pairs[best] < (1.0 - THRESHOLDS.explained) * alone else None


def _peaks(numbers: Array, spectrum: Any) -> list[float]:
    """Return the wave numbers of the largest peaks of a spectrum."""
    power = np.abs(spectrum)
    peaks = np.flatnonzero((power[1:-1] >= power[:-2]) & (power[1:-1] >= power[2:])) + 1
    return [float(numbers[j]) for j in sorted(peaks.tolist(), key=lambda j: -power[j])[:WAVES]]


def _alike_terms(rows: Along, path: str, terms: Sequence[Term]) -> frozenset[str]:
    """Return the terms that are the same columns as a parameter that is looked for, or a constant.

    What one says the other need not: of both, the share of each would be open.
    """
    x = np.column_stack([rows.taken(path), np.ones(rows.count)])
    x = x / (np.sqrt(np.mean(x * x, axis=0)) + 1e-300)
    found = set[str]()
    for term in terms:
        if term.role == "curve" or term.name == "offset" or not term.shapes:
            continue
        y = np.reshape(term.columns(rows, term.shapes[0]), (rows.count, -1))
        left = y - x @ np.linalg.lstsq(x, y, rcond=None)[0]
        if np.sqrt(np.mean(left * left)) <= THRESHOLDS.same_span * np.sqrt(np.mean(y * y)):
            found.add(term.name)
    return frozenset(found)


def hides_dead_zone(rows: Along, *, finds_inertia: bool) -> bool:
    """Return whether what a dead zone of the driver takes is in the span of a plain balance.

    A force has the direction of the motion wherever friction is large beside what accelerates: then
    a dead zone is a level, whatever its size, and no record of this kind tells them apart.
    """
    plain = [rows.seen(rows.direction * rows.load), rows.seen(rows.velocity), np.ones(rows.count)]
    plain += [rows.acceleration] if finds_inertia else []
    plain += [rows.taken(path) for path in rows.records[0].unknown]
    x = np.column_stack(plain)
    x = x / (np.sqrt(np.mean(x * x, axis=0)) + 1e-300)
    y = np.column_stack([rows.seen(rows.within(size)) for size in _dead_zones(rows).tolist()])
    left = y - x @ np.linalg.lstsq(x, y, rcond=1e-9)[0]
    part = np.linalg.norm(left, axis=0) / (np.linalg.norm(y, axis=0) + 1e-300)
    return bool(np.min(part) <= THRESHOLDS.same_span)


def _dead_zones(rows: Along) -> Array:
    """Return sizes of dead zones [N], up to the median of the force."""
    force = np.abs(rows.raw)
    return np.geomspace(0.05, 1.0, DEAD) * float(np.median(force[force > 0.0]))


def _fading(clock: Array, constant: float) -> Array:
    """Return a drift over time (n,): straight, or one that fades with a time constant."""
    return clock if constant == 0.0 else np.exp(-(clock + 0.5) / constant)


def terms_of(  # noqa: C901  # a vocabulary is a list
    rows: Along,
    memories: Sequence[Shape],
    waves: Sequence[float],
    level_waves: Sequence[float],
    *,
    finds_inertia: bool,
    always: frozenset[str],
    constant: bool,
) -> dict[str, Term]:
    """Return the vocabulary of records."""
    frame = rows.frame
    driven = bool(np.any(rows.raw)) and not rows.free and not rows.records[0].friction
    loaded = frame.load != 1.0
    # the curve of a free motion stands beside a law, from which it goes away by a part of it
    least = 1.0 / (THRESHOLDS.outlier**2 * len(frame.bending)) if rows.free else 0.0
    bending = np.maximum(frame.bending, least)
    lengths = _lengths(rows)
    ratio = float(lengths[1] / lengths[0])
    speeds = np.geomspace(frame.low, frame.top, GRID)
    faster = float(speeds[1] / speeds[0])
    falls = [(float(v), float(n)) for v in speeds for n in (1, 2)]
    loads: list[Shape] = [(), (0.67,), (0.8,)] if loaded else [()]
    base = frozenset({"level", "curve", *(["adhesion"] if loaded else [])})
    flows = frozenset({"power", "drag", "saturating"})
    moving = base | flows | {"viscous"}  # alone, it would say the force itself

    def law(of: Callable[[Any, Shape], Array]) -> Callable[[Any, Shape], Array]:
        return lambda r, s: r.acting(of(r, s))

    def on_state(of: Callable[[Any, Shape], Array]) -> Callable[[Any, Shape], Array]:
        """Return columns of the state of the memory, which the shape begins with."""

        def columns(r: Any, shape: Shape) -> Array:
            z, x = r.state(*shape[:2]) * r.load, of(r, shape[2:])
            return np.asarray(r.acting(z * x if x.ndim == 1 else z[:, None] * x))

        return columns

    def curve(r: Any, shape: Shape) -> Array:
        x = r.knotted()
        hats = np.array([np.interp(x, frame.knots, one) for one in frame.basis.T]).T
        z = (r.state(*shape[:2]) * r.load)[:, None]
        return np.asarray(
            r.acting(np.hstack([z * hats, np.abs(z) * hats]) if shape[2] else z * hats)
        )

    def constant_force(r: Any, _: Shape) -> Array:
        # a force that does no work in a swing, as that of an encoder's zero, is no friction
        none = rows.free == "work" and isinstance(r, Steady)
        return np.asarray(r.acting((0.0 if none else 1.0) * np.ones(len(r.velocity))))

    def of_memory(*own: Shape) -> list[Shape]:
        return [(*memory, *one) for memory in memories for one in own]

    # shorter bristles than the screening looks at are made by noise
    anything = (0.0, math.inf)
    ranges = [(float(lengths[0]), math.inf), *[anything] * 3]
    on_memory: dict[str, Any] = {"shared": 2, "ranges": ranges}
    step = (ratio**0.25, 1.0)  # the screening went as far as that
    terms = [
        Term(name="level", role="law", columns=on_state(
                lambda r, s: np.ones(len(r.velocity)) if not s else r.load ** (s[0] - 1.0)),
             shapes=of_memory(*loads), steps=(*step, 1.15), nonnegative=True, title=TITLES["level"],
             rank=0, **on_memory),
        Term(name="viscous", role="law", columns=law(lambda r, _: r.velocity),
             title=TITLES["viscous"], rank=1),
        Term(name="offset", role="rig", columns=constant_force,
             title=TITLES["offset"], rank=2),
        Term(name="stribeck", role="law",
             columns=on_state(lambda r, s: np.exp(-(np.abs(r.velocity) / s[0]) ** s[1])),
             shapes=of_memory(*falls), steps=(*step, faster, 1.0), nonnegative=True, needs=base,
             title=TITLES["stribeck"], rank=4, **on_memory),
        Term(name="viscous_direction", role="law", columns=law(lambda r, _: np.abs(r.velocity)),
             needs=frozenset({"viscous", "power", "drag"}),
             title=TITLES["viscous_direction"], rank=5),
        Term(name="level_direction", role="law", needs=base,
             columns=lambda r, s: r.acting(np.abs(r.state(*s)) * r.load), steps=step,
             # without a memory it is an offset
             shapes=[one for one in memories if one[0] > 0.0 or not constant],
             title=TITLES["level_direction"], rank=5, **on_memory),
        Term(name="drag", role="law", columns=law(lambda r, _: r.velocity * np.abs(r.velocity)),
             excludes=flows - {"drag"}, nonnegative=True,
             title=TITLES["drag"], rank=1 if rows.free else 6),  # what swings out is in air
        Term(name="power", role="law",
             columns=law(lambda r, s: np.sign(r.velocity) * np.abs(r.velocity) ** s[0]),
             shapes=[(p,) for p in (0.33, 0.5, 0.67, 0.8, 1.5)], steps=(1.25,), nonnegative=True,
             excludes=(flows | {"viscous"}) - {"power"}, title=TITLES["power"], rank=7),
        Term(name="stribeck_direction", role="law", needs=frozenset({"stribeck"}),
             columns=law(lambda r, s: np.exp(-(np.abs(r.velocity) / s[0]) ** s[1])),
             shapes=falls, steps=(faster, 1.0),
             title=TITLES["stribeck_direction"], rank=8),
        Term(name="second", role="law", needs=frozenset({"level", "curve"}),
             columns=law(lambda r, s: r.state(*s) * r.load),
             shapes=[(float(x), n) for x in lengths for n in (0.0, 1.0)], steps=(ratio, 1.0),
             ranges=ranges,
             nonnegative=True, title="second memory", rank=9),
        Term(name="place", role="law", needs=base, cost=2, columns=on_state(
                lambda r, _: np.column_stack([r.place / frame.span, (r.place / frame.span) ** 2])),
             shapes=of_memory(()), steps=step, title="level that changes with the place", rank=10,
             **on_memory),
        Term(name="drift", role="rig", needs=base,
             columns=on_state(lambda r, s: _fading(r.clock, s[0])),
             shapes=of_memory(*((x,) for x in RUNNING_IN)), steps=(*step, 1.5),
             title="level that changes with time", rank=13, **on_memory),
        Term(name="viscous_drift", role="rig", needs=frozenset({"viscous", "power", "drag"}),
             columns=law(lambda r, s: r.velocity * _fading(r.clock, s[0])),
             shapes=[(x,) for x in RUNNING_IN], steps=(1.5,),
             title="viscous friction that changes with time", rank=14),
        Term(name="offset_drift", role="rig", needs=frozenset({"offset"}),
             columns=law(lambda r, s: _fading(r.clock, s[0])),
             shapes=[(x,) for x in RUNNING_IN], steps=(1.5,),
             title="offset that changes with time", rank=15),
        # a controller that acts on the position is a spring of negative stiffness, and explains the
        # force without a mass
        Term(name="spring", role="rig", columns=law(lambda r, _: r.stretch), nonnegative=True,
             title="spring", rank=15),
        Term(name="bow", role="rig", columns=law(lambda r, _: r.place**2), rank=16,
             title="force that bends with the place"),
        Term(name="curve", role="curve", columns=curve, shapes=(), cost=5,
             precision=lambda shape: shape[3] * np.tile(bending, 1 + int(shape[2])),
             title=TITLES["curve"], **on_memory),
    ]  # fmt: skip
    if waves and level_waves:
        terms += [
            Term(name="ripple", role="rig", cost=2, shapes=[(k,) for k in waves], steps=(1.02,),
                 columns=law(lambda r, s: r.wave(s[0])), title="ripple over the place",
                 rank=11),
            Term(name="level_ripple", role="law", cost=2, needs=base,
                 columns=on_state(lambda r, s: r.wave(s[0])),
                 shapes=of_memory(*((k,) for k in level_waves)), steps=(*step, 1.02),
                 title="level that ripples over the place", rank=12, **on_memory),
        ]  # fmt: skip
    if loaded:
        terms.append(
            Term(name="adhesion", role="law", columns=on_state(lambda r, _: 1.0 / r.load),
                 shapes=of_memory(()), steps=step, nonnegative=True,
                 title=TITLES["adhesion"], rank=3, **on_memory)
        )  # fmt: skip
    if TRANSMITTED in frame.inputs:
        terms.append(
            Term(name="gear", role="law", columns=on_state(
                    lambda r, _: (r.input(TRANSMITTED) + frame.inputs[TRANSMITTED]) / r.load),
                 shapes=of_memory(()), steps=step, nonnegative=True, rank=3,
                 title="share of what the gear transmits", **on_memory)
        )  # fmt: skip
        if all(one.transmitted is not None for one in rows.records):
            terms.append(
                Term(name="gear_direction", role="law", needs=frozenset({"gear"}),
                     columns=lambda r, s: r.acting(r.state(*s) ** 2 * r.transmitted),
                     shapes=of_memory(()), steps=step, rank=6,
                     title="share that differs where the gear is driven", **on_memory)
            )  # fmt: skip
    for name in frame.inputs.keys() - {TRANSMITTED}:
        terms += [
            Term(name=f"level*{name}", role="law", needs=base, shapes=of_memory(()), steps=step,
                 columns=on_state(lambda r, _, name=name: r.input(name)),  # type: ignore[misc]
                 title=CHANGING["level"].format(name), rank=10, **on_memory),
            Term(name=f"viscous*{name}", role="law", needs=frozenset({"viscous"}), rank=11,
                 columns=law(lambda r, _, name=name: r.velocity * r.input(name)),  # type: ignore[misc]
                 title=CHANGING["viscous"].format(name)),
        ]  # fmt: skip
    if any(one.mechanism is not None for one in rows.records):
        terms.append(
            Term(name="mechanism", role="rig", columns=lambda r, _: r.mechanism, rank=3,
                 limits=(-2.0, 2.0), title="known forces larger or smaller than given")
        )  # fmt: skip
    if finds_inertia:
        terms.append(
            Term(name="inertia", role="rig", columns=lambda r, _: r.inertial,
                 nonnegative=True, title="inertia", rank=0)
        )  # fmt: skip
    sought = {path: one for path, one in rows.records[0].unknown.items() if not one.doubt}
    for path, one in sought.items():
        terms.append(
            Term(name=path, role="rig", columns=lambda r, _, path=path: r.taken(path),  # type: ignore[misc]
                 limits=one.limits, rank=0, title=path.rpartition(".")[2].replace("_", " "),
                 excludes=_alike_terms(rows, path, terms))
        )  # fmt: skip
    if driven or rows.records[0].friction:
        late = LATEST / mean_frequency(rows.records)
        # the noise of positions leaves the moment of a reversal open by as much
        rate = float(np.sqrt(np.mean(rows.acceleration**2)))
        least = max(0.5 * rows.filters[0].step, 0.5 * math.sqrt(2.0 * frame.noise / rate))
        longest = max(late, 2.0 * least)
        between = math.log(longest / least) / math.log(LATER[1] / LATER[0])
        delays = np.geomspace(least, longest, math.ceil(between) + 1)
        terms += [
            Term(name="lag", role="rig", columns=lambda r, _: r.force_rate, limits=(-late, 0.0),
                 title="lag of the force", rank=17),
            Term(name="delay", role="rig", columns=lambda r, s: r.early(s[0]), limits=LATER,
                 shapes=[(float(x),) for x in delays], steps=(float(delays[1] / delays[0]),),
                 cost=0, excludes=frozenset({"lag", "latency"}), title="delay of the force",
                 rank=17),
            Term(name="latency", role="rig", columns=lambda r, s: r.early(-s[0]), limits=LATER,
                 shapes=[(float(x),) for x in delays], steps=(float(delays[1] / delays[0]),),
                 cost=0, excludes=frozenset({"lag", "delay"}), rank=18,
                 title="motion that lags behind the force"),
        ]  # fmt: skip
    if driven:
        force = np.abs(rows.held(rows.raw))  # at the rows, as what acts at rest is no drive
        largest = float(np.max(force))
        limits = np.maximum(np.quantile(force, (0.85, 0.93, 0.97)), np.multiply(LIMITS, largest))
        clips = (float(limits[0]), largest)
        relaxing = np.geomspace(APART / frame.band, 0.25 * frame.duration, 6)
        rings = np.geomspace(0.1, RINGS, 8) * frame.band
        gaps = np.geomspace(30.0 * frame.noise, frame.span / 16.0, 6)
        dead = _dead_zones(rows)
        terms += [
            Term(name="clip", role="fault", columns=lambda r, s: r.held(r.excess(s[0])),
                 shapes=[(float(x),) for x in limits], steps=(float(limits[1] / limits[0]),),
                 ranges=[clips], limits=(0.7, 1.3), title="force that is clipped",
                 rank=18, needs=moving),
            Term(name="hose", role="rig", columns=lambda r, s: r.seen(r.relaxing(s[0])),
                 shapes=[(float(x),) for x in relaxing], nonnegative=True,
                 steps=(float(relaxing[1] / relaxing[0]),), title="relaxing spring",
                 excludes=frozenset({"backlash", "flexible"}), rank=16),
            *([] if hides_dead_zone(rows, finds_inertia=finds_inertia) else [
                Term(name="dead_zone", role="fault", columns=lambda r, s: r.seen(r.within(s[0])),
                     shapes=[(float(x),) for x in dead], steps=(float(dead[1] / dead[0]),),
                     limits=(0.7, 1.3), title=DEAD_ZONE, rank=18, needs=moving)]),
            Term(name="backlash", role="fault", columns=lambda r, s: r.loose(s[0]),
                 shapes=[(float(x),) for x in gaps], steps=(float(gaps[1] / gaps[0]),),
                 nonnegative=True, title="backlash", rank=19, needs=always - {"offset"}),
            Term(name="flexible", role="fault", needs=always - {"offset"},
                 columns=lambda r, s: r.seen(r.ringing(r.full_acceleration(), s[0])),
                 shapes=[(float(x),) for x in rings], steps=(float(rings[1] / rings[0]),),
                 nonnegative=True, title="flexible coupling", rank=20),
        ]  # fmt: skip
        known = rows.records[0].mechanism is not None
        inertia = rows.records[0].inertia or 0.0
        if not finds_inertia and inertia:
            terms.append(
                Term(name="inertia_error", role="fault", columns=lambda r, _: r.acceleration,
                     limits=(-0.7 * inertia, inertia), rank=16, excludes=GAINS,
                     title="inertia other than given")
            )  # fmt: skip
        if (not finds_inertia and inertia) or known:
            # what a gain changes of friction is in the coefficients of friction
            terms += [
                Term(name="force_gain", role="fault", limits=(-0.7, 1.0), rank=17,
                     columns=lambda r, _: inertia * r.acceleration - r.mechanism,
                     excludes=(GAINS - {"force_gain"}) | {"mechanism", "inertia_error"},
                     title="gain of the force other than given"),
                Term(name="position_scale", role="fault", limits=(-0.7, 1.0), rank=17,
                     columns=lambda r, _: inertia * r.acceleration - r.scaled,
                     excludes=(GAINS - {"position_scale"}) | {"mechanism", "inertia_error"},
                     title="scale of the position other than given"),
            ]  # fmt: skip
    names = [one.name for one in terms]
    left_out = set[str]() if constant else {"offset", "offset_drift"}
    if len(np.unique(np.sign(rows.direction))) < 2:
        # places pass once, as times do
        left_out |= {"place", "spring", "bow", "ripple", "level_ripple"}
    if not driven and not rows.records[0].friction:  # a free motion slows with time
        left_out |= {"drift", "viscous_drift", "offset_drift", "bow", "place", "second"}
        left_out |= {"offset"} if rows.free == "momentum" else set()
        if always - {"offset"}:  # all other forces are known by those of the mechanism
            left_out |= {"mechanism"}
        # its energy tells the directions apart no better than what holds the body
        left_out |= {one for one in names if one.endswith("_direction")}
    return {one.name: one for one in terms if one.name not in left_out}
