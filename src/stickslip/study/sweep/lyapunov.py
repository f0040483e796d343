"""Lyapunov exponents of driven motions, and whether motions close or are chaotic.

Neighbours of a motion y after a cycle T of the drives, without coordinates on which nothing depends
(`orbits`), are y' + M dy, with M = dPhi/dy of that run; saltation matrices of impacts, sticking and
breaking away are part of it.

1. From a random orthogonal Q, each cycle gives M Q = Q' R. Exponents are means of log |R_ii| / T in
   decreasing order. What sticks loses a direction: R_ii = 0, and its exponent is -infinity.
2. Standard errors come from means over ten stretches of the run.
3. Drives without a common cycle cannot begin anew after one: there the run is made at once, and one
   tangent vector is followed, which gives the largest exponent alone.
4. A motion that closes at its end has left transients, chaotic ones included: then the last cycles
   count, 64 at most, by which that is seen. One that does not close is chaotic if its largest
   exponent is above 0 by three standard errors. Else it is quasi-periodic, of a longer period, or
   has not settled.

Means of a motion that does not close depend on its start. The same run from starts 1e-9 of its size
away shows by how much: their spread.

Sources: G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn, Meccanica 15, 1980; P. C. Mueller,
Chaos Solitons Fractals 5, 1995 (saltation).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.simulation import GivenFriction, event_driven_law, initial_state
from stickslip.engine.solver import EventDriven
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, SimulationError
from stickslip.friction import FrictionLaw, Laws
from stickslip.mechanisms import WHOLE, Mechanism, cycle_of, stops_of
from stickslip.show.display import OnAxes, Summary, Tabular
from stickslip.show.formatting import count, number, quantity
from stickslip.study.sweep.attractors import period_of
from stickslip.study.sweep.orbits import LOST, Orbit, ReturnMap, refuse_cut, return_map
from stickslip.study.sweep.parameter_grid import (
    PERIOD,
    Array,
    compiled,
    counted,
    whole_run,
)
from stickslip.study.tolerances import ALIKE, TRANSIENT

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["LyapunovExponents", "lyapunov_exponents"]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class LyapunovExponents(OnAxes, Tabular):
    """Lyapunov exponents of a motion, the largest first."""

    exponents: Array
    """Exponents (n,) [1/s]; -infinity along directions lost to sticking, NaN where not known."""
    errors: Array
    """Standard errors (n,) [1/s]; 0 of those that follow from the multipliers of an orbit."""
    period: float
    """Length of a cycle [s]."""
    cycles: int
    """Cycles that count."""
    closes: int
    """After how many cycles the motion closes at its end; 0 if it does not within 32."""
    end: Mapping[str, float]
    """States after the last cycle, without those that drives prescribe."""

    @property
    def largest(self) -> float:
        """The largest exponent [1/s]."""
        return float(self.exponents[0]) if len(self.exponents) else -np.inf

    @property
    def chaotic(self) -> bool:
        """Whether the motion does not close, and an exponent is above 0 by three errors."""
        return not self.closes and self.largest > 3.0 * float(np.append(self.errors, 0.0)[0])

    @property
    def kind(self) -> str:
        """What the motion is: ``"chaotic"``, ``"not closed"``, or ``"periodic"``."""
        return "chaotic" if self.chaotic else "periodic" if self.closes else "not closed"

    def _over(self) -> str:
        return "place"

    def _column_units(self) -> Mapping[str, str]:
        return {"exponent": "1/s", "error": "1/s"}

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each exponent with its standard error."""
        import pandas as pd

        columns = {"exponent": self.exponents, "error": self.errors}
        return pd.DataFrame({"place": np.arange(1, len(self.errors) + 1), **columns})

    def _summary(self) -> Summary:
        what = {
            "chaotic": "The motion is chaotic: its largest exponent is above 0 by three errors.",
            "periodic": f"The motion closes after {self.closes} of its cycles.",
            "not closed": (
                "The motion does not close within 32 cycles and is not chaotic: it is"
                " quasi-periodic, of a longer period, or has not settled."
            ),
        }
        rows = [
            ("−∞" if np.isneginf(value) else quantity(value, "1/s", 4), number(error, 2))
            for value, error in zip(self.exponents.tolist(), self.errors.tolist(), strict=True)
        ]
        over = f"Over {count(self.cycles, 'cycle')} of {quantity(self.period, 's', 4)}."
        return Summary(
            sentence=f"{what[self.kind]} {over}", head=("exponent", "standard error"), rows=rows
        )


def lyapunov_exponents(
    motion: Mechanism | Orbit | Trajectory,
    law: GivenFriction | None = None,
    *,
    y0: Mapping[str, float] | None = None,
    cycles: int = 400,
    settle: int = 200,
    period: float | None = None,
    solver: EventDriven | None = None,
) -> LyapunovExponents:
    """Return the Lyapunov exponents of a driven motion.

    Parameters
    ----------
    motion : Mechanism, Orbit or Trajectory
        What moves; or an orbit, whose exponents are the logarithms of its multipliers over its
        period; or a run, which goes on where its last cycle ended.
    law : FrictionLaw, type or str, or mapping of str to these, optional
        What holds a mechanism back, as in `simulate`.
    y0 : mapping, optional
        States of a mechanism at time 0, as in `simulate`.
    cycles : int
        Cycles that count, of a motion that does not close.
    settle : int
        Cycles before them.
    period : float, optional
        Length of a cycle [s]; that of the drives if not given. If drives do not repeat themselves
        after it, only the largest exponent is known.
    solver : EventDriven, optional
        Compiled if not given.

    Returns
    -------
    LyapunovExponents
        Exponents with standard errors, and whether the motion closes or is chaotic.

    Raises
    ------
    InputError
        If an argument cannot be used, or the drives have no cycle.
    SimulationError
        If the run ends early, or has no derivative in most of its cycles.

    References
    ----------
    P. C. Mueller, Calculation of Lyapunov exponents for dynamic systems with discontinuities,
    Chaos Solitons Fractals 5 (1995) 1671-1681.

    Examples
    --------
    Those of a linear oscillator add up to its damping over its mass:

    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> drive = Sine(amplitude=1.0, frequency=1.0)
    >>> axis = Axis(inertia=1.0, stiffness=100.0, damping=0.5, load=0.0, drive=drive)
    >>> found = lyapunov_exponents(axis, Coulomb(kinetic_coefficient=0.0), cycles=20)
    >>> round(float(found.exponents.sum()), 6), found.kind
    (-0.5, 'periodic')
    """
    owner = "lyapunov_exponents"
    if isinstance(motion, Orbit):
        return _of_orbit(motion)
    if isinstance(motion, Trajectory):
        motion, law, y0 = _continued(motion, period)
    if law is None:
        raise InputError(f"{owner}: give the law of friction of {type(motion).__name__}.")
    result = event_driven_law(motion, law)
    counted(owner, "cycles", cycles, 20)
    counted(owner, "settle", settle, 0)
    begin = initial_state(owner, motion, result, dict(y0 or {}))
    if period is None:
        whole_run(owner, motion, cycles + settle)
    else:
        PERIOD.check(owner, "period", period)
    map_ = return_map(motion, result, 1, period, compiled(solver))
    cycle = map_.duration(motion, np.nan)
    if _cuts(motion, cycle):
        return _at_once(map_, np.array(begin)[list(map_.free)], cycle, settle, cycles)
    return _cycle_by_cycle(map_, map_.settled(owner, begin, settle), cycle, cycles)


def is_chaotic(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    y0: Mapping[str, float],
    period: float | None,
    solver: EventDriven,
) -> bool:
    """Whether the largest exponent of a motion that does not close is above 0 by three errors.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=2.0))
    >>> is_chaotic(axis, Coulomb(kinetic_coefficient=0.5), {}, None, compiled(None))
    False
    """
    map_ = return_map(mechanism, law, 1, period, solver)
    begin = initial_state("lyapunov_exponents", mechanism, law, dict(y0))
    at_once = {"stretch": 192} if _cuts(mechanism, map_.duration(mechanism, np.nan)) else {}
    return diverges(map_, np.array(begin)[list(map_.free)], **at_once)


def diverges(map_: ReturnMap, y: Array, value: float = np.nan, *, stretch: int = 32) -> bool:
    """Whether a motion from free states does not close within 192 cycles, and neighbours leave."""
    logs, strobes, _ = growth(map_, y, 192, stretch, value)
    rate, error = largest_of(logs)
    return rate > 3.0 * error and not _closes(strobes)


def have_left(growths: Array) -> NDArray[np.bool_]:
    """Return whether neighbours have left each other by their growth.

    Regular motions do not let a distance grow a thousandfold. Of less nothing follows: chaos whose
    body comes to rest now and then makes neighbours one.

    Examples
    --------
    >>> have_left(np.array([0.0, 1.0, 1e6])).tolist()
    [False, False, True]
    """
    return np.asarray(growths > 1e3)


def starts_nearby(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    y0: Mapping[str, float] | Sequence[float] | None,
    columns: Mapping[str, Array],
    off: Array,
) -> dict[str, Array]:
    """Return what varies, with starts off by (n, states) where nothing prescribes or stops them.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> law, off = Coulomb(kinetic_coefficient=0.5), np.array([[1e-9, 0.0]])
    >>> starts_nearby(Axis(inertia=1.0), law, None, {}, off)["initial.x"]
    array([1.e-09])
    """
    begin = initial_state("starts_nearby", mechanism, law, y0)
    given = {*mechanism.start(), *(stop.coordinate for stop in stops_of(mechanism))}
    return dict(columns) | {
        path: columns.get(path, begin[i]) + off[:, i]
        for i, name in enumerate((*mechanism.coordinates, *mechanism.rates))
        if name not in given
        for path in (f"initial.{name}",)
    }


def closing(samples: Array, periods: Array) -> tuple[NDArray[np.int64], Array]:
    """Return after how many cycles motions close, and the sizes of their states.

    A coordinate may advance: the way of each cycle comes again. `samples` (n, m + 1, 2 k) are
    coordinates, then rates, once a cycle of `periods` (n,); a motion that does not close within
    half of them has 0, and sizes are (n, 2 k).

    Examples
    --------
    >>> x = np.array([[0.0, 1.0, 3.0, 4.0, 6.0]])
    >>> closing(np.stack([x, 0.0 * x], axis=2), np.array([1.0]))[0].tolist()
    [2]
    """
    k = samples.shape[2] // 2
    ways = np.concatenate([np.diff(samples[:, :, :k], axis=1), samples[:, 1:, k:]], axis=2)
    reach = np.ptp(samples[:, :, :k], axis=1)
    speed = np.maximum(np.abs(samples[:, :, k:]).max(axis=1), reach / periods[:, None])
    sizes = np.concatenate([np.maximum(reach, ALIKE * speed * periods[:, None]), speed], axis=1)
    for part in (slice(0, k), slice(k, None)):  # what hardly moves beside others is as large
        least = ALIKE * sizes[:, part].max(axis=1, keepdims=True, initial=0.0)
        sizes[:, part] = np.maximum(sizes[:, part], least)
    result = np.zeros(len(samples), dtype=np.int64)
    for cycles in range(ways.shape[1] // 2, 0, -1):
        off = np.abs(ways[:, cycles:] - ways[:, :-cycles]) <= ALIKE * sizes[:, None]
        result[off.all(axis=(1, 2))] = cycles
    return result, sizes


def _of_orbit(orbit: Orbit) -> LyapunovExponents:
    with np.errstate(divide="ignore"):
        sizes = np.abs(orbit.multipliers)
        rates = np.log(np.where(sizes > LOST, sizes, 0.0)) / orbit.period
    return LyapunovExponents(
        exponents=rates,
        errors=np.zeros(len(rates)),
        period=orbit.period / orbit.cycles,
        cycles=orbit.cycles,
        closes=orbit.cycles,
        end={name: orbit.start[name] for name in orbit.free},
    )


def _continued(
    run: Trajectory, period: float | None
) -> tuple[Mechanism, GivenFriction, dict[str, float]]:
    """Return mechanism, law, and the states after the last cycle of a run."""
    mechanism, law = (getattr(run.differentiate, name, None) for name in ("mechanism", "law"))
    if mechanism is None or law is None:
        raise InputError(
            "lyapunov_exponents: a run of the event-driven solver is needed, which has"
            " sensitivities; give the mechanism and its law instead."
        )
    cycle = cycle_of(mechanism) if period is None else period
    refuse_cut(mechanism, cycle)
    last = int(run.span[1] / cycle * (1.0 + WHOLE)) * cycle
    at, carried = run.at([last]), mechanism.carried()
    return (
        mechanism,
        law,
        {name: float(at[name][0] - last * carried.get(name, 0.0)) for name in run.states},
    )


def _cuts(mechanism: Mechanism, cycle: float) -> bool:
    """Whether a drive does not repeat itself after a cycle."""
    try:
        refuse_cut(mechanism, cycle)
    except InputError:
        return True
    return False


def _cycle_by_cycle(map_: ReturnMap, y: Array, cycle: float, cycles: int) -> LyapunovExponents:
    """Return all exponents, by one run a cycle."""
    first = map_.shoot(y)
    # of all states: one that is 0 in a cycle may move in others
    scale = np.maximum(first.scale, 1e-3 * first.scale.max(initial=0.0))
    n = len(y)
    basis = np.linalg.qr(np.random.default_rng(0).standard_normal((n, n)))[0]
    logs, strobes = np.full((cycles, n), np.nan), np.empty((cycles, n))
    lost = np.zeros(n, dtype=bool)
    for k in range(cycles):
        shot = map_.shoot(y)
        y = strobes[k] = y + shot.residual
        basis, grown = _carried(shot.derivatives.raw[:n, :n], scale, basis)
        lost |= grown <= LOST
        logs[k] = np.log(np.where(lost, 1.0, grown))
    closes = _closes(strobes)
    if closes:
        logs = logs[-min(64, cycles // 2) :]
    rates, errors = _means(logs / cycle)
    order = np.argsort(-np.where(lost, -np.inf, rates), kind="stable")
    return LyapunovExponents(
        exponents=np.where(lost, -np.inf, rates)[order],
        errors=np.where(lost, 0.0, errors)[order],
        period=cycle,
        cycles=len(logs),
        closes=closes,
        end=dict(zip(map_.names, y.tolist(), strict=True)),
    )


def _carried(slopes: Array, scale: Array, basis: Array) -> tuple[Array, Array]:
    """Return tangent vectors after a cycle, and by how much each has grown; NaN if not known.

    What rests at a stop has no derivative with respect to leaving it, and no tangent along that.
    """
    matrix = slopes * scale / scale[:, None]
    known: NDArray[np.bool_] = np.asarray(np.isfinite(matrix).all(axis=0))
    if not known.any() and len(known):
        return basis, np.full(len(basis), np.nan)
    moved = np.where(known, matrix, 0.0) @ np.where(known[:, None], basis, 0.0)
    basis, upper = np.linalg.qr(moved)
    return basis, np.abs(np.diag(upper))


def _at_once(
    map_: ReturnMap, y: Array, cycle: float, settle: int, cycles: int
) -> LyapunovExponents:
    """Return the largest exponent, by one tangent vector of one run."""
    logs, strobes, end = growth(map_, y, settle + cycles, settle + cycles)
    rate, error = largest_of(logs[settle:] / cycle)
    others = np.full(len(y) - 1, np.nan)
    return LyapunovExponents(
        exponents=np.append(rate, others),
        errors=np.append(error, others),
        period=cycle,
        cycles=cycles,
        closes=_closes(strobes),
        end=dict(zip(map_.names, end.tolist(), strict=True)),
    )


def growth(
    map_: ReturnMap, y: Array, cycles: int, stretch: int = 32, value: float = np.nan
) -> tuple[Array, Array, Array]:
    """Return the logarithm of the growth of a tangent vector in each cycle, strobes, and the end.

    Growth (cycles,) is NaN where the run has no derivative, and -infinity where all is stuck.
    """
    cycle, n = map_.duration(map_.pair(value)[0], value), len(y)
    vector = np.random.default_rng(0).standard_normal(n)
    logs, strobes = np.full(cycles, np.nan), np.empty((cycles, n))
    scale, part = np.ones(n), map_
    for begin in range(0, cycles, stretch):
        length = min(stretch, cycles - begin)
        part = part if part.cycles == length else replace(map_, cycles=length)
        mechanism, _, _, run = part.run(y, value)
        times = cycle * np.arange(1.0, length + 1.0)
        states = map_.seen(mechanism, run, times)[:, list(map_.free)]
        if not begin:
            size = np.abs(states).max(axis=0)
            scale = np.where(size > 0.0, size, max(size.max(initial=0.0), 1e-300))
        slopes = run.differentiate(times, map_.paths[:n])[:, list(map_.free)]
        matrix = slopes * scale / scale[:, None]
        known = np.isfinite(matrix).all(axis=(0, 1))
        vector = np.where(known, vector / np.linalg.norm(vector), 0.0)
        path = np.where(known, matrix, 0.0) @ vector
        sizes = np.append(np.linalg.norm(vector), np.linalg.norm(path, axis=1))
        with np.errstate(divide="ignore", invalid="ignore"):
            logs[begin : begin + length] = np.diff(np.log(sizes))
        strobes[begin : begin + length], y = states, states[-1]
        if not sizes[-1] > 0.0 or not np.isfinite(sizes[-1]):
            if known.any():  # all is stuck: what follows does not depend on what came before
                logs[begin:] = -np.inf
            vector = np.random.default_rng(begin).standard_normal(n)
        else:
            vector = path[-1]
    return logs, strobes, y


def largest_of(rates: Array) -> tuple[float, float]:
    """Return the mean of rates (cycles,) and its standard error; -infinity once all is stuck."""
    if np.isneginf(rates).any():
        return -np.inf, 0.0
    mean, error = _means(rates[:, None])
    return float(mean[0]), float(error[0])


def _closes(strobes: Array) -> int:
    """Return after how many cycles the end of a motion closes."""
    last = strobes[-64:]
    size = np.abs(last).max(axis=0, initial=0.0)
    return period_of(last, np.maximum(size, 1e-3 * size.max(initial=0.0)), TRANSIENT)


def _means(rates: Array, blocks: int = 10) -> tuple[Array, Array]:
    """Return means (n,) of rates (cycles, n), and their standard errors by blocks."""
    known = rates[np.isfinite(rates).all(axis=1)]
    if 2 * len(known) < len(rates) or len(known) < blocks:
        raise SimulationError(
            "there is no derivative in most cycles: a contact, a stop or a switch is only touched"
            " (grazing), or two events coincide."
        )
    means = np.array([block.mean(axis=0) for block in np.array_split(known, blocks)])
    return known.mean(axis=0), means.std(axis=0, ddof=1) / np.sqrt(blocks)
