"""Start values: of a law of which only the type is given, and of a search on several travels."""

import dataclasses
import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.friction import FrictionLaw
from stickslip.identification import TravelModel, Trial, is_rig, under_cycles
from stickslip.mechanisms import slip_of
from stickslip.quantities import fields_of, parameters
from stickslip.simulation import simulate

Start: TypeAlias = Sequence[float]
"""Values of the free parameters where a search begins."""
Array: TypeAlias = NDArray[np.float64]

LEVELS = (0.04, 12.0)
"""Least and largest friction level that is scanned, over its start value: from a ball bearing to
rubber."""
SLOPES = (1e-2, 1e5)
"""The same for a law whose first parameter is no level but a slope with speed, which grows with the
size of a rig."""
GRAVITY = 9.81
"""Gravity [m/s^2], for the size of damping."""
COUNTS = {LEVELS: 24, SLOPES: 15}
"""How many values of the first parameter are scanned."""
SHARES = (0.9, 0.6, 0.3)
"""Shares of the level that fits alone, beside which further parameters are scanned; a viscous part
takes the rest."""
DECADES = (1e-2, 10**-1.5, 1e-1, 10**-0.5, 1.0, 10**0.5, 10.0, 1e2)
"""Further parameters over their start values: least squares does not see them from afar."""
REACH = 4096.0
"""How far from its start value a first parameter is scanned while the best is at an end of what was
scanned, as a factor. Beyond it laws only get stiff."""
DENSE, BESIDE = 240, 8
"""Levels, and combinations of further parameters, where travels are not monotonic in the level;
half as many levels where runs are of many cycles."""
DRAWS, FEW_DRAWS, SLOW_DRAWS = 16, 8, 2
"""Combinations of nuisances that are drawn: fewer where runs are of many cycles, or with bristles,
which take longer, unless a search is to be thorough."""
FALLING, SURPLUS = (0.5, 0.8), 0.2
"""Speeds over the largest one of a run with which friction that falls all the way passes for one
that rises by less, and the share of what lies above a level beside them."""
PLAUSIBLE = {"speed": (-2.5, 0.0), "stiffness": (3.0, 6.0), "damping": (-1.0, 0.5)}
"""Decades of nuisances: speeds over the largest one of a run, stiffness over the level [1/m], which
is a deflection of 1 um to 1 mm, and damping over the root of stiffness and gravity [s/m]."""
MOST = 60
"""Combinations of further parameters that are tried, at most; drawn if there are more."""
DRAWN, AROUND = 256, 3.0
"""Points that are drawn where parameters of the mechanism are unknown, and the factor from the
values that were given up to which they lie."""
FRACTION = 3.0
"""Friction over that of the branch that fits alone up to which slopes are scanned densely."""
KEPT, MANY = 6, 48
"""Starting points that a scan returns, and a dense one."""


def starting_points(model: TravelModel, trials: Sequence[Trial]) -> list[Start]:
    """Return values of the free parameters near which travels are explained best.

    The first parameter, a level, is scanned over three decades, and on while the best is at an end,
    with the others at their least. Where each travel falls as the level rises there is one best
    level, and the others are scanned over decades beside shares of it. A body that swings to and
    fro before it rests has travels that rise and fall with the level, and least squares would stay
    on the branch where it begins: there levels are scanned densely, and points of all branches are
    returned.
    """
    if any(map(is_rig, model.free)):
        return _with_rig(model, trials)
    trials = spread_out(trials, 3)
    first, *others = model.free
    names = {path: path.rpartition(".")[2] for path in model.free}
    centre = {path: float(getattr(model.law, name) or 0.1) for path, name in names.items()}
    quantities = {path: fields_of(type(model.law))[name] for path, name in names.items()}
    span = SLOPES if quantities[first].scale == "slope" else LEVELS
    idle = [_least(model, path, centre[path]) for path in others]
    levels, table = _scanned(model, trials, centre[first], span, idle)
    costs = _costs(table, trials)
    best = _rows(model, levels, idle)[int(np.argmin(costs))]
    centre |= {
        p: doubling_slope(model, trials, best) for p in others if quantities[p].scale == "slope"
    }
    beside = _beside(model, best[0], centre) if others else []
    if span is LEVELS and not model.law.states and _branched(table):
        rests = [rest for _, rest in beside]
        if len(others) == 1 and quantities[others[0]].scale == "slope":
            # the level that fits alone may be of a branch with a fraction of the friction
            rests += [[FRACTION * value for value in rest] for rest in rests]
        return _dense(model, trials, levels, [idle, *rests])
    if [quantities[path].scale for path in others] == ["stiffness"]:
        # soft bristles give back what they took: each stiffness has a level of its own
        rests = [[factor * centre[others[0]]] for factor in DECADES]
        return _valleys(model, trials, levels, rests)
    rows = _rows(model, levels, idle)
    if not others:
        return _best(rows, costs)
    more = [[share * best[0], *rest] for share, rest in beside]
    return _best(
        [*rows, *more], np.concatenate([costs, _costs(_table(model, trials, more), trials)])
    )


def _scanned(
    model: TravelModel,
    trials: Sequence[Trial],
    centre: float,
    span: tuple[float, float],
    idle: Sequence[float],
) -> tuple[Array, Array]:
    """Return values of the first parameter, and the travels with each; on where the best ends."""
    low, high = room_for(model.law, model.free[0].rpartition(".")[2], model.free)
    ratio = (span[1] / span[0]) ** (1.0 / (COUNTS[span] - 1))
    first, last = span[0] * centre, span[1] * centre
    levels = np.unique(np.clip(np.geomspace(first, last, COUNTS[span]), max(low, first), high))
    table = _table(model, trials, _rows(model, levels, idle))
    for side in (0, -1):
        while True:
            at = int(np.argmin(_costs(table, trials)))
            edge = float(levels[side])
            if at != (0 if side == 0 else len(levels) - 1) or not low < edge < high:
                break
            if not 1.0 / REACH <= edge / centre <= max(REACH, span[1]):
                break
            power = np.arange(-6, 0) if side == 0 else np.arange(1, 7)
            more = np.unique(np.clip(edge * ratio**power, max(low, 1e-12 * centre), high))
            found = _table(model, trials, _rows(model, more, idle))
            order = (more, levels) if side == 0 else (levels, more)
            levels = np.concatenate(order)
            table = np.concatenate((found, table) if side == 0 else (table, found))
    return levels, table


def _with_rig(model: TravelModel, trials: Sequence[Trial]) -> list[Start]:
    """Return points where parameters of the mechanism are unknown too.

    The law is scanned with the mechanism as it was given; around the best of these points, all
    values are drawn together. A resonance lies elsewhere with another stiffness: least squares
    alone would stay on its side of it.
    """
    from scipy.stats import qmc

    law = [path for path in model.free if not is_rig(path)]
    known = {path: value for path, _, value in parameters(trials[0].mechanism, "mechanism")}
    rig = [known[path] for path in model.free if is_rig(path)]
    alone = starting_points(replace(model, free=law), trials) if law else [[]]
    centre = np.array([*alone[0], *rig])
    shares = qmc.Sobol(len(centre), rng=np.random.default_rng(0)).random(DRAWN)
    widths = np.where(centre == 0.0, 1.0, centre)
    rows = [[*point, *rig] for point in alone]
    drawn = np.where(
        centre == 0.0, 0.1 * (2.0 * shares - 1.0), widths * AROUND ** (2.0 * shares - 1.0)
    )
    if law:  # the level that fits with the wrong mechanism may be far off
        ends = np.log(LEVELS) + math.log(
            float(getattr(model.law, law[0].rpartition(".")[2]) or 0.1)
        )
        drawn[:, 0] = np.exp(ends[0] + (ends[1] - ends[0]) * shares[:, 0])
    rows += drawn.tolist()
    few = spread_out(trials, 4 * len(centre))
    return _best(rows, _costs(_table(model, few, rows), few))


def spread_out(trials: Sequence[Trial], most: int) -> list[Trial]:
    """Return one trial of each setting; of many some, from the shortest to the longest travel."""
    different = sorted({t.run: t for t in trials}.values(), key=lambda t: abs(t.travel))
    chosen = np.linspace(0, len(different), most).astype(int)
    return [different[min(i, len(different) - 1)] for i in dict.fromkeys(chosen.tolist())]


def _least(model: TravelModel, path: str, centre: float) -> float:
    """Return the value at which a parameter does least: 0 where that is sure, else its start."""
    quantity = fields_of(type(model.law))[path.rpartition(".")[2]]
    kept = quantity.above is not None or quantity.at_least is not None or quantity.scale == "none"
    return centre if kept else 0.0


def doubling_slope(model: TravelModel, trials: Sequence[Trial], values: Start) -> float:
    """Return the slope [N s/m] that doubles the friction of a law at the largest speed of a run."""
    force, speed = force_and_speed(model, trials, values)
    return force / speed


def force_and_speed(
    model: TravelModel, trials: Sequence[Trial], values: Start
) -> tuple[float, float]:
    """Return the friction [N] of the first parameter as a level, and the largest speed [m/s]."""
    trial = max(trials, key=lambda one: abs(one.travel))
    law = model.with_values(values)
    end = trial.until(model.t_end)
    run = simulate(trial.mechanism, law, t_end=end, y0=trial.start(law), throw=False)
    slip = slip_of(trial.mechanism)
    rate = trial.mechanism.rates[trial.mechanism.coordinates.index(slip)]
    force = values[0] * float(np.median(run["normal_force"]))
    return force, max(float(np.max(np.abs(run[rate]))), 1e-6)


def nuisances_of(
    law: type[FrictionLaw], free: Collection[str], known: Collection[str] = ()
) -> list[str]:
    """Return full paths of parameters of a law that nobody measured, gave or fits.

    These are those that the law cannot do without, and those that add a part of its own beside
    them, such as a viscous one, whose default is that it is not there. Exponents, which shape a
    part, are as the law has them, but for the power of the speed that a law is fitted by.

    Examples
    --------
    >>> from stickslip import Stribeck
    >>> nuisances_of(Stribeck, ["friction.kinetic_coefficient"])
    ['friction.static_coefficient', 'friction.stribeck_velocity', 'friction.viscous_coefficient']
    """
    defaults = law.__dataclass_fields__
    found = []
    for name, quantity in fields_of(law).items():
        path, default = f"friction.{name}", defaults[name].default
        if path in free or name in known:
            continue
        if quantity.structural or quantity.scale == "none":
            unknown = name in law.fit_order and not law.states
        else:
            unknown = default is dataclasses.MISSING or default == 0.0
        if unknown:
            found.append(path)
    return found


def plausible(
    model: TravelModel,
    trials: Sequence[Trial],
    values: Start,
    nuisances: Sequence[str],
    *,
    thorough: bool = False,
) -> Array:
    """Return combinations of plausible values of nuisances (d, q), the first with least of each.

    What must not fall below another parameter is told by what it lies above it, up to as much
    again.
    A part that grows with speed is at most as large as the level, at the largest speed of a run.
    """
    from scipy.stats import qmc

    force, speed = force_and_speed(model, trials, values)
    known = fields_of(type(model.law))
    law = model.with_values(values)
    slow = law.states and not thorough
    count = SLOW_DRAWS if slow else FEW_DRAWS if under_cycles(trials) else DRAWS
    shares = qmc.Sobol(len(nuisances), rng=np.random.default_rng(0)).random(count)
    shares[0] = 0.0
    speeds = [known[path.rpartition(".")[2]].scale == "speed" for path in nuisances]
    if any(speeds) and not slow:
        low, high = PLAUSIBLE["speed"]
        rows = np.full((len(FALLING), len(nuisances)), SURPLUS)
        rows[:, speeds] = ((np.log10(FALLING) - low) / (high - low))[:, None]
        shares = np.concatenate([shares, rows])
    drawn: Array = np.zeros(shares.shape)
    level = float(values[0])
    for i, path in enumerate(nuisances):
        quantity = known[path.rpartition(".")[2]]
        share = shares[:, i]
        if quantity.at_least is not None:
            drawn[:, i] = share * float(getattr(law, quantity.at_least))
        elif quantity.scale in PLAUSIBLE:
            # bristles that are stiff and a speed that is low do least
            low, high = PLAUSIBLE[quantity.scale]
            if quantity.scale == "stiffness":
                low, high = high, low
            size = {"speed": speed, "stiffness": level}.get(quantity.scale, 1.0 / GRAVITY**0.5)
            drawn[:, i] = size * 10 ** (low + share * (high - low))
        elif quantity.scale.startswith("slope"):
            drawn[:, i] = share * force / speed
        elif quantity.scale == "drag":
            drawn[:, i] = share * force / speed**2
        elif quantity.scale == "none" and quantity.bounds:
            low, high = quantity.bounds
            drawn[:, i] = low * (high / low) ** share if low > 0.0 else high * share
        else:
            drawn[:, i] = (1.0 + share) * float(getattr(law, path.rpartition(".")[2]) or 0.0)
    for i, path in enumerate(nuisances):  # damping goes with the root of the stiffness beside it
        if known[path.rpartition(".")[2]].scale == "damping":
            stiff = [known[one.rpartition(".")[2]].scale == "stiffness" for one in nuisances]
            if any(stiff):
                drawn[:, i] *= np.sqrt(drawn[:, stiff.index(True)])
    return drawn


def _beside(
    model: TravelModel, level: float, centre: Mapping[str, float]
) -> list[tuple[float, list[float]]]:
    """Return shares of a level, and values of the further parameters beside each.

    A parameter that must not fall below the level lies above it by a third of what is scanned:
    friction at rest is seldom twice that of sliding.
    """
    quantities = fields_of(type(model.law))
    found = []
    for share in SHARES:
        axes = []
        for path in model.free[1:]:
            name = path.rpartition(".")[2]
            if quantities[name].scale == "slope":
                axes.append([(1.0 - share) * centre[path]])
            elif quantities[name].at_least is not None:
                axes.append([share * level * (1.0 + extra) for extra in (0.15, 0.5)])
            elif quantities[name].scale == "none" and not quantities[name].structural:
                axes.append(np.linspace(*quantities[name].bounds or (0.0, 1.0), 5).tolist())
            else:
                axes.append([factor * centre[path] for factor in DECADES])
        found += [(share, list(rest)) for rest in itertools.product(*axes)]
    if len(found) <= MOST:
        return found
    chosen = np.random.default_rng(0).choice(len(found), MOST, replace=False)
    return [found[i] for i in sorted(chosen)]


def _rows(model: TravelModel, levels: Array, rest: Sequence[float]) -> list[list[float]]:
    """Return values of the first parameter, each with the others beside it, or as high as it."""
    names = [path.rpartition(".")[2] for path in model.free]
    known = fields_of(type(model.law))
    above = [known[name].at_least == names[0] for name in names[1:]]
    return [
        [level, *(max(v, level) if up else v for v, up in zip(rest, above, strict=True))]
        for level in levels.tolist()
    ]


def _table(model: TravelModel, trials: Sequence[Trial], rows: Sequence[Start]) -> Array:
    """Return travels (k, n); infinite where a run cannot be made."""
    found = model.table(trials, np.array(rows, dtype=float))
    return np.where(np.isfinite(found), found, math.inf)


def _costs(table: Array, trials: Sequence[Trial]) -> Array:
    """Return the sum of squared residuals of each row."""
    costs: Array = np.sum((table - np.array([trial.travel for trial in trials])) ** 2, axis=1)
    return costs


def _branched(table: Array) -> bool:
    """Whether a travel rises with the level anywhere, by more than runs are wrong."""
    finite = table[np.all(np.isfinite(table), axis=1)]
    if len(finite) < 2:
        return False
    rises = np.diff(np.abs(finite), axis=0)
    return bool(np.any(rises > 1e-6 * np.abs(finite).max()))


def _dense(
    model: TravelModel, trials: Sequence[Trial], levels: Array, beside: Sequence[Sequence[float]]
) -> list[Start]:
    """Return points of all branches: on each, the levels where travels are explained best."""
    dense = DENSE // 2 if under_cycles(trials) else DENSE
    fine = np.geomspace(levels[0], levels[-1], dense)
    if len(beside) > BESIDE:
        chosen = np.linspace(0, len(beside) - 1, BESIDE).astype(int)
        beside = [beside[i] for i in chosen]
    return _valleys(model, trials, fine, beside)


def _valleys(
    model: TravelModel, trials: Sequence[Trial], levels: Array, beside: Sequence[Sequence[float]]
) -> list[Start]:
    """Return the levels where travels are explained best, with each of the values beside them."""
    count, found = len(levels), list[tuple[float, Start]]()
    rows = [row for rest in beside for row in _rows(model, levels, rest)]
    costs = _costs(_table(model, trials, rows), trials).reshape(len(beside), count)
    padded = np.pad(costs, ((0, 0), (1, 1)), constant_values=math.inf)
    valleys = (costs <= padded[:, :-2]) & (costs <= padded[:, 2:]) & np.isfinite(costs)
    for i, j in zip(*np.nonzero(valleys), strict=True):
        found.append((float(costs[i, j]), rows[int(i) * count + int(j)]))
    found.sort(key=lambda one: one[0])
    return [row for _, row in found[:MANY]]


def _best(rows: Sequence[Start], costs: Array) -> list[Start]:
    return [rows[i] for i in np.argsort(costs, kind="stable")[:KEPT]]


def room_for(law: FrictionLaw, name: str, free: Collection[str] = ()) -> tuple[float, float]:
    """Return the values a parameter may take while all that are not free stay as they are."""
    quantities = fields_of(type(law))
    quantity = quantities[name]
    low, high = max(quantity.low, quantity.above or 0.0, 0.0), quantity.high
    if quantity.scale == "none" and quantity.bounds:  # powers: beyond these no law is meant
        low, high = max(low, quantity.bounds[0]), min(high, quantity.bounds[1])
    if quantity.at_least is not None:
        low = max(low, getattr(law, quantity.at_least))
    for other, bound in quantities.items():
        if f"friction.{other}" in free:
            continue
        if bound.at_least == name and getattr(law, other) is not None:
            high = min(high, getattr(law, other))
    return low, high
