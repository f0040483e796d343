"""Start values: of a law of which only the type is given, and of a search on several travels."""

import dataclasses
import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError, SimulationError
from stickslip.friction import FrictionLaw
from stickslip.identification.estimation.ranges import Sizes, with_ranges
from stickslip.identification.travels.model import TravelModel, Trial, is_rig
from stickslip.identification.travels.single_travel import room_for
from stickslip.mechanisms import slip_of
from stickslip.quantities import fields_of, parameters, vary
from stickslip.simulation import ensemble, simulate

Start: TypeAlias = Sequence[float]
"""Values of the free parameters where a search begins."""
Array: TypeAlias = NDArray[np.float64]

ORDINARY = {
    "level": 0.25,
    "level+": 0.25,
    "level-": 0.25,
    "slope": 0.5 / 9.81,
    "slope+": 0.5 / 9.81,
    "slope-": 0.5 / 9.81,
    "drag": 1.0 / 9.81,
    "speed": 0.5,
    "displacement": 0.25e-3,
    "stiffness": 1e3,
    "damping": 10.0,
}
"""Dry metal on metal; slopes and drag are over the load. Bristles give way by 0.25 mm."""
SURPLUS_AT_REST = 0.4
"""What a level has over that which it does not fall below, over the latter."""
LEVELS = (0.04, 12.0)
"""Least and largest friction level that is scanned, over its start value: from a ball bearing to
rubber."""
SLOPES = (1e-2, 1e5)
"""The same for a law whose first parameter is no level but a slope with speed, which grows with the
size of a rig."""
COUNTS = {LEVELS: 24, SLOPES: 15}
"""How many values of the first parameter are scanned."""
SHARES = (0.9, 0.6, 0.3)
"""Shares of the level that fits alone, beside which further parameters are scanned; a viscous part
takes the rest."""
DECADES = (1e-2, 10**-1.5, 1e-1, 10**-0.5, 1.0, 10**0.5, 10.0, 1e2)
"""Further parameters over their start values: least squares does not see them from afar."""
DENSE = (240, 16)
"""Levels and values of a second parameter, where travels are not monotonic in the level."""
SURPLUS = 0.02
"""What a level at rest that is scanned densely has over that of sliding, over this, in decades."""
MOST = 60
"""Combinations of further parameters that are tried, at most; drawn if there are more."""
DRAWN, AROUND = 256, 3.0
"""Points that are drawn where parameters of the mechanism are unknown, and the factor from the
values that were given up to which they lie."""
KEPT = 6
"""Starting points that a scan returns."""


def starting_points(model: TravelModel, trials: Sequence[Trial]) -> list[Start]:
    """Return values of the free parameters near which several travels are explained best.

    The first parameter, a level, is scanned over three decades with the others at their least.
    Where each travel falls as the level rises there is one best level, and the others are scanned
    over decades beside shares of it. A body that swings to and fro before it rests has travels that
    rise and fall with the level, and least squares would stay on the branch where it begins: there
    levels are scanned densely.
    """
    if any(map(is_rig, model.free)):
        return _with_rig(model, trials)
    trials = _spread(trials, 3)
    first, *others = model.free
    names = {path: path.rpartition(".")[2] for path in model.free}
    centre = {path: float(getattr(model.law, name) or 0.1) for path, name in names.items()}
    quantities = {path: fields_of(type(model.law))[name] for path, name in names.items()}
    span = SLOPES if quantities[first].scale == "slope" else LEVELS
    ends = span[0] * centre[first], span[1] * centre[first]
    low, high = room_for(model.law, names[first], model.free)
    levels = np.unique(np.clip(np.geomspace(*ends, COUNTS[span]), max(low, ends[0]), high))
    idle = [_least(model, path, centre[path]) for path in others]
    rows = [[level, *idle] for level in levels.tolist()]
    table = np.array([_travels(model, trials, row) for row in rows])
    costs = _costs(table, trials)
    best = rows[int(np.argmin(costs))]
    centre |= {
        p: doubling_slope(model, trials, best) for p in others if quantities[p].scale == "slope"
    }
    scanned = len(others) <= 1 and span is LEVELS and not model.law.states
    if scanned and _branched(table):
        return _best(*_dense(model, trials, (max(ends[0], low), min(ends[1], high)), centre))
    if not others:
        return _best(rows, costs)
    rows += [[share * best[0], *rest] for share, rest in _beside(model, best[0], centre)]
    more = [_travels(model, trials, row) for row in rows[len(costs) :]]
    return _best(rows, np.concatenate([costs, _costs(np.array(more), trials)]))


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
    few = _spread(trials, 4 * len(centre))
    return _best(rows, _costs(np.array([_travels(model, few, row) for row in rows]), few))


def _spread(trials: Sequence[Trial], most: int) -> list[Trial]:
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
    trial = max(trials, key=lambda one: abs(one.travel))
    law = model.with_values(values)
    end = trial.until(model.t_end)
    run = simulate(trial.mechanism, law, t_end=end, y0=trial.start(law), throw=False)
    slip = slip_of(trial.mechanism)
    rate = trial.mechanism.rates[trial.mechanism.coordinates.index(slip)]
    force = values[0] * float(np.median(run["normal_force"]))
    return force / max(float(np.max(np.abs(run[rate]))), 1e-6)


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


def _travels(model: TravelModel, trials: Sequence[Trial], values: Sequence[float]) -> Array:
    try:
        return model.travels(trials, values)
    except (SimulationError, InputError):
        return np.full(len(trials), math.inf)


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
    model: TravelModel,
    trials: Sequence[Trial],
    ends: tuple[float, float],
    centre: Mapping[str, float],
) -> tuple[list[Start], Array]:
    """Return a dense grid of one or two parameters and its costs, by ensembles."""
    others = model.free[1:]
    axes = [np.geomspace(*ends, DENSE[0])]
    above = [path for path in others if _stands_above(model, path)]
    for path in others:
        spread = np.geomspace(DECADES[0], DECADES[-1], DENSE[1] - 1)
        if path in above:
            axes.append(np.array([1.0, *(1.0 + SURPLUS * spread)]))
        else:
            axes.append(np.array([_least(model, path, centre[path]), *(spread * centre[path])]))
    columns = dict(zip(model.free, (a.ravel() for a in np.meshgrid(*axes)), strict=True))
    for path in above:
        columns[path] = columns[path] * columns[model.free[0]]
    table = []
    for trial in trials:
        start = trial.start(model.law)
        slip = slip_of(trial.mechanism)
        end = trial.until(model.t_end)
        runs = ensemble(trial.mechanism, model.law, columns, t_end=end, outputs=[slip], y0=start)
        table.append(np.where(np.isfinite(runs[slip]), runs[slip], np.inf) - start.get(slip, 0.0))
    rows = np.stack([columns[path] for path in model.free], axis=1)
    return rows.tolist(), _costs(np.stack(table, axis=1), trials)


def _stands_above(model: TravelModel, path: str) -> bool:
    """Whether a parameter must not fall below another one."""
    return fields_of(type(model.law))[path.rpartition(".")[2]].at_least is not None


def _best(rows: Sequence[Start], costs: Array) -> list[Start]:
    return [rows[i] for i in np.argsort(costs, kind="stable")[:KEPT]]


def required_of(law: type[FrictionLaw]) -> tuple[str, ...]:
    """Return the names of the parameters that a law cannot do without.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> required_of(Dahl)
    ('kinetic_coefficient', 'bristle_stiffness')
    """
    fields = law.__dataclass_fields__
    return tuple(name for name in fields_of(law) if fields[name].default is dataclasses.MISSING)


def starting_law(law: type[FrictionLaw], load: float = 1.0) -> FrictionLaw:
    """Return a law of that type with ordinary values for each parameter it needs.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> starting_law(Coulomb)
    Coulomb(kinetic_coefficient=0.25, static_coefficient=None)
    """
    per_load = ("slope", "slope+", "slope-", "drag")
    typical = ORDINARY | {name: ORDINARY[name] * load for name in per_load}
    typical |= {"load": load, "force": ORDINARY["level"] * load}
    sizes = Sizes(typical=typical, reach=typical)
    values: dict[str, Any] = {}
    for name in required_of(law):
        quantity = with_ranges(law, name)
        values[name] = sizes.of(quantity).start
        if quantity.at_least in values:
            values[name] = values[quantity.at_least] * (1.0 + SURPLUS_AT_REST)
    return law(**values)


def with_known(law: FrictionLaw, known: Mapping[str, float] | None) -> FrictionLaw:
    """Return a law with the values that are known, by name.

    Examples
    --------
    >>> from stickslip import Viscous
    >>> with_known(Viscous(viscous_coefficient=1.0), {"viscous_coefficient": 30.0})
    Viscous(viscous_coefficient=30.0)
    """
    return vary(law, "friction", {f"friction.{name}": v for name, v in (known or {}).items()})
