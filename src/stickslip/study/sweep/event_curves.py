"""Curves of events of periodic orbits over two parameters.

An event of a branch is an orbit F(y, p, q) = 0 at which a function g(y, p, q) is 0 too. (F, g) is a
map of y and p with the parameter q, and its branch is the curve: the predictor, the corrector and
the steps are those of `continuation`. With M = dPhi/dy:

1. Fold (s = -1) and period doubling (s = 1): M + s is singular where g of the bordered system
   [M + s, b; c', 0] [v; g] = [0; 1] is 0. With the left vector w of the same system its derivatives
   are -w' (dM v) = -w' d/de [dPhi/d(y, p, q) at y + e v], by two further runs. The borders b and c
   are the null vectors of the last point (Govaerts 2000, chapter 4; Kuznetsov 2004, chapter 10).
2. Grazing: g is the least distance of a stop or a switch from where it is met, for which its
   velocity is 0. Sticking: g is the break-away level less the friction needed, at the turn of the
   velocity or, where sticking breaks off, at its least between two turns; or it is the least speed
   of a slip that does not turn. Derivatives of all are differences of runs.
3. An orbit that touches has no derivative (di Bernardo et al. 2008), so that curves of grazing are
   solved on one side: what a step puts beyond is moved back along the gradient of g and
   extrapolated linearly from there. How far beyond it is, an impact tells by its speed u and
   acceleration a: g = -u^2 / 2a.
4. Points of codimension two along a curve, each located as an event of a branch is:
     cusp                  l changes its sign: with w the left null vector of M - 1, the tangent of
                           the curve of folds is (dp, dq) = l (w' dF/dq, -w' dF/dp)
     fold-flip             another multiplier passes 1 or -1
     grazing, sticking     with fold or flip: two such curves meet
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.solver import BareRun, Equations
from stickslip.errors import InputError, SimulationError
from stickslip.mechanisms import Mechanism, stops_of
from stickslip.quantities import replaced
from stickslip.show.display import OnAxes, Summary, Tabular
from stickslip.show.formatting import quantity, span
from stickslip.study.sweep.continuation import (
    BORDER,
    LEAST_STEP,
    MOST_NEWTON,
    MOST_POINTS,
    MOST_STEP,
    NEARBY,
    BranchEvent,
    Curve,
    Point,
    between_of,
    change_of,
    check_step,
    multipliers_of,
    units_of,
    within,
)
from stickslip.study.sweep.orbits import (
    END_STEP,
    ORBIT_TIMES,
    Orbit,
    ReturnMap,
    Shot,
    Signature,
    map_of,
    placed,
    solved,
    value_of,
)
from stickslip.study.sweep.parameter_grid import Array, counted

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["EventCurve", "continue_event"]

KINDS: Final = ("fold", "period doubling", "grazing", "sticking")


@dataclass(frozen=True)
class _HardStop:
    """Distance of a coordinate from a hard stop."""

    number: int
    """Which of the stops of the mechanism."""

    def __call__(self, run: BareRun, mechanism: Mechanism, t: Array) -> Array:
        stop = stops_of(mechanism)[self.number]
        q = run.at(t)[:, run.states.index(stop.coordinate)]
        return np.asarray((float(stop.position) - q) * (1.0 if stop.side == "upper" else -1.0))

    def met(self, run: BareRun, mechanism: Mechanism) -> list[float]:
        times = np.array([e.t for e in run.events() if e.reason.endswith("hits stop")])
        near = np.abs(self(run, mechanism, times)) if len(times) else times
        return [float(t) for t in times[near <= NEARBY * self.size(run, mechanism)]]

    def size(self, run: BareRun, mechanism: Mechanism) -> float:
        """Return the size of the distance in a run."""
        times = np.linspace(0.0, run.differentiate.t_end, ORBIT_TIMES)
        return float(np.abs(self(run, mechanism, times)).max())


@dataclass(frozen=True)
class _Switch:
    """Distance of a switch of the mechanism, such as a soft stop, from its threshold."""

    number: int
    """Which of the switches."""
    side: float
    """Sign of its margin where it is not met."""

    def __call__(self, run: BareRun, mechanism: Mechanism, t: Array) -> Array:
        return self.side * margins(run, t)[:, self.number]

    def met(self, run: BareRun, mechanism: Mechanism) -> list[float]:
        return []  # the motion goes on through it, and the distance changes its sign


@dataclass(frozen=True)
class _Slip:
    """Speed of a contact that slips in one direction: where it is 0 for an instant, it may hold."""

    contact: str
    direction: float

    def __call__(self, run: BareRun, mechanism: Mechanism, t: Array) -> Array:
        columns = run.playback(t)
        slips = _column(columns, "mode", self.contact) != 0
        return np.where(slips, self.direction * columns[_rate_of(mechanism, self.contact)], np.inf)

    def met(self, run: BareRun, mechanism: Mechanism) -> list[float]:
        events = (e for e in run.events() if e.contact == self.contact)
        return [e.t for e in events if e.reason == "stop" and e.from_mode == self.direction]


@dataclass(frozen=True)
class _Level:
    """Distance of the friction that holds a contact from its break-away level, over the level."""

    contact: str
    law: Any

    def __call__(self, run: BareRun, mechanism: Mechanism, t: Array) -> Array:
        columns = run.playback(t)
        friction, load, mode = (_column(columns, n, self.contact) for n in (*_HOLDS, "mode"))
        result = np.full(len(t), np.inf)
        for k in np.flatnonzero(mode == 0):
            level = level_of(self.law, self.contact, friction[k], load[k])
            result[k] = 1.0 - abs(friction[k]) / level
        return result

    def met(self, run: BareRun, mechanism: Mechanism) -> list[float]:
        events = (e for e in run.events() if e.contact == self.contact)
        return [e.t for e in events if e.reason == "break-away"]


_Gap: TypeAlias = _HardStop | _Switch | _Level | _Slip
"""A distance that is 0 where something is touched."""
_HOLDS = ("friction", "normal_force")


def _column(columns: Mapping[str, Array], name: str, contact: str) -> Array:
    return columns[name] if name in columns else columns[f"{name}:{contact}"]


def level_of(law: Any, contact: str, friction: float, load: float) -> float:
    """Return the break-away level [N] of a contact against the friction that holds it."""
    members = dict(getattr(law, "members", ()))
    own = members.get(contact, law) if members else law
    return float(own.towards(-1 if friction > 0.0 else 1).break_away(load))


def margins(run: BareRun, t: Array) -> Array:
    """Return the margins of all switches of the mechanism (n, switches)."""
    equations = Equations(run.playback.model, run.playback.inputs)
    rows = []
    for time, y in zip(t.tolist(), run.at(t).tolist(), strict=True):
        equations.load_at(time)
        rows.append(equations("margins", 0, 0, time, y))
    return np.array(rows)


class _Singular:
    """M + s is singular: bordered system."""

    at = 0.0

    def __init__(self, sign: float, shot: Shot) -> None:
        self.sign, self.map = sign, shot.derivatives.map
        self.border = self.other = np.empty(0)
        self.accept(shot, shot.scale, 0.0)

    def matrix(self, shot: Shot) -> Array:
        """Return M + s in scaled states."""
        result: Array = shot.monodromy * self.scale / self.scale[:, None]
        return result + self.sign * np.eye(len(result))

    def accept(self, shot: Shot, scale: Array, at: float) -> None:
        self.scale = self.map.of_states(scale)
        left, _, right = np.linalg.svd(self.matrix(shot))
        b, c = left[:, -1], right[-1]
        if len(self.border):  # so that g goes on without a change of sign
            b, c = (x if x @ old >= 0.0 else -x for x, old in ((b, self.border), (c, self.other)))
        self.border, self.other = b, c

    def system(self, shot: Shot) -> tuple[float, Array, Array]:
        """Return g, and the right and the left vector."""
        matrix, n = self.matrix(shot), len(self.border)
        bordered = np.block([[matrix, self.border[:, None]], [self.other[None], np.zeros((1, 1))]])
        last = np.eye(n + 1)[-1]
        right, left = np.linalg.solve(bordered, last), np.linalg.solve(bordered.T, last)
        return float(right[-1]), right[:-1], left[:-1]

    def __call__(self, shot: Shot) -> tuple[float, bool]:
        return self.system(shot)[0], False

    def slope(self, plane: "Plane", shot: Shot, value: float) -> Array:
        _, v, w = self.system(shot)
        n, of_states, sides = len(shot.y), self.map.of_states, []
        v, slot = self.scale * v, self.map.slot
        if self.map.section is not None:  # the cycle is as much longer as its end comes later
            v = np.insert(v, slot, 0.0)
            v[slot] = -(shot.jacobian[slot, :n] @ v) / shot.jacobian[slot, slot]
        for sign in (1.0, -1.0):
            other, step = shot, 0.0
            with suppress(SimulationError, InputError):
                near = plane.at(value).shoot(shot.y + sign * END_STEP * v, shot.value)
                if near.signature == shot.signature:
                    other, step = near.sensed(), sign * END_STEP
            sides.append((of_states(other.derivatives.returned[:n]), step))
        (above, up), (below, down) = sides
        if up == down:
            raise SimulationError("something else happens on both sides of the orbit.")
        return np.asarray(-((w / self.scale) @ (above - below)) / (up - down)) * plane.sizes(shot)


class _Distance:
    """A least distance, or that of a turn, is 0; derivatives by differences of runs."""

    window, narrower, touch = 0.06, 4, 0.05
    """Part of a cycle around the last touch in which it is looked for, how often that is made
    narrower around the least distance, and the distance, over the size, of what counts as one."""
    aside = 1e-6
    """Step of each unknown, over its size, for differences."""
    phase = 0.0
    """Time of the touch over the period, at the last point."""
    at = 0.0
    """The same of the last run."""

    def accept(self, shot: Shot, scale: Array, at: float) -> None:
        self.phase = at

    def __call__(self, shot: Shot) -> tuple[float, bool]:
        raise NotImplementedError

    def slope(self, plane: "Plane", shot: Shot, value: float) -> Array:
        base, sizes = self(shot)[0], plane.sizes(shot)
        u, result = np.array([*shot.y.tolist(), shot.value, value]), np.empty(len(sizes))
        for i, size in enumerate(sizes):
            for step in (self.aside, -self.aside):  # to whichever side there is no contact
                moved = u + step * size * np.eye(len(u))[i]
                near = plane.at(moved[-1]).shoot(moved[:-2], moved[-2])
                g, beyond = self(near)
                result[i] = (g - base) / step
                if not beyond:
                    break
        return result


class _Touch(_Distance):
    """The least distance of a gap is 0."""

    def __init__(self, gap: _Gap, phase: float, size: float) -> None:
        self.gap, self.phase, self.size = gap, phase, size

    def __call__(self, shot: Shot) -> tuple[float, bool]:
        run, period = shot.run, shot.period
        half = self.window * period / shot.derivatives.map.cycles
        middle = self.phase * period

        def gap(t: Array) -> Array:
            return self.gap(run, shot.mechanism, np.mod(t, period)) / self.size

        met = [around(t, middle, period) for t in self.gap.met(run, shot.mechanism)]
        at = min(met, key=lambda t: abs(t - middle), default=math.inf)
        if abs(at - middle) < half:
            h = 2e-3 * half
            one, two = gap(at - h * np.array([1.0, 2.0]))
            speed, bend = (4.0 * one - two) / (2.0 * h), (two - 2.0 * one) / h**2
            if not bend > 0.0:
                raise SimulationError("it is met, and not touched.")
            self.at = (at + speed / bend) / period
            return -(speed**2) / (2.0 * bend), True
        for _ in range(self.narrower):
            times = np.linspace(middle - half, middle + half, ORBIT_TIMES)
            values = gap(times)
            known = np.isfinite(values[:-2] + values[2:])
            lows = np.flatnonzero(known & (values[1:-1] <= np.minimum(values[:-2], values[2:])))
            if not len(lows):
                raise SimulationError("the contact that was touched is not near any more.")
            k = int(min(lows, key=lambda i: abs(times[i + 1] - middle))) + 1
            middle, half = times[k], times[1] - times[0]
        a, b, c = values[k - 1 : k + 2]
        self.at = middle / period
        least = float(b - (c - a) ** 2 / (8.0 * (a - 2.0 * b + c))) if a + c > 2.0 * b else float(b)
        return least, least < 0.0


class _Turn(_Distance):
    """The friction needed at a turn of the velocity is the break-away level."""

    def __init__(self, contact: str, phase: float, sticks: bool) -> None:
        self.contact, self.phase, self.sticks = contact, phase, sticks

    def __call__(self, shot: Shot) -> tuple[float, bool]:
        half, period = self.window / shot.derivatives.map.cycles, shot.period
        turns = [
            e
            for e in shot.run.events()
            if e.contact == self.contact
            and e.reason in ("stop", "reversal")
            and abs(around(e.t / period, self.phase, 1.0) - self.phase) < half
        ]
        if not turns:
            raise SimulationError("the velocity does not turn there any more.")
        turn = min(turns, key=lambda e: abs(around(e.t / period, self.phase, 1.0) - self.phase))
        self.at = turn.t / period
        columns = shot.run.playback(np.mod(turn.t + period * END_STEP * _AROUND, period))
        friction, load = (_column(columns, n, self.contact) for n in _HOLDS)
        level = level_of(shot.law, self.contact, -turn.from_mode, load[1])
        side, beyond = (1.0 if self.sticks else -1.0), (turn.reason == "stop") != self.sticks
        if turn.margin != 0.0:
            return side * turn.margin / level, beyond
        # one-sided values at the turn; the acceleration is linear in the friction
        before, after = 2.0 * friction[1] - friction[0], 2.0 * friction[2] - friction[3]
        rate = columns[_rate_of(shot.mechanism, self.contact)]
        a, b = 2.0 * rate[1] - 0.5 * rate[0], 2.0 * rate[2] - 0.5 * rate[3]
        needed = before + a * (after - before) / (a + b)
        return side * (1.0 - abs(needed) / level), beyond


_AROUND = np.array([-2.0, -1.0, 1.0, 2.0])


def around(t: float, middle: float, period: float) -> float:
    """Return the time at which a cycle is repeated that is nearest to a time."""
    return t - period * round((t - middle) / period)


def _rate_of(mechanism: Mechanism, contact: str) -> str:
    """Return the rate along which a contact slips."""
    own = next(c for c in mechanism.contacts() if c.name == contact)
    return mechanism.rates[mechanism.coordinates.index(own.slip)]


_Condition: TypeAlias = _Singular | _Touch | _Turn
"""What makes an orbit one at an event."""


class Plane:
    """Orbits at an event as a map of y and p, with q as its parameter."""

    def __init__(
        self,
        base: ReturnMap,
        second: str,
        widths: tuple[float, float],
        condition: Callable[[Shot], _Condition],
        shot: Shot,
        value: float,
    ) -> None:
        self.base, self.second, self.widths = base, second, widths
        self.section, self.slot = base.section, base.slot
        self.cycles, self.free, self.seen = base.cycles, base.free, base.seen
        self.names, self.tolerance = (*base.unknowns, str(base.path)), base.tolerance
        self.maps: dict[float, ReturnMap] = {}
        self.condition, self.back = condition(shot), np.empty(0)
        self.back = self.condition.slope(self, shot, value)

    def at(self, q: float) -> ReturnMap:
        """Return the map of y at a value of the second parameter."""
        if q not in self.maps:
            base = self.base
            law = self.second.startswith("friction.")
            root, prefix = (base.law, "friction") if law else (base.mechanism, "mechanism")
            moved: Any = replaced(root, prefix, self.second, q)
            result = replace(base, **{"law" if law else "mechanism": moved})
            known = result.__dict__
            if base.form is not None and self.second in base.form.model.parameter_paths:
                known["form"] = base.form.at(self.second, q)
                known["signatures"] = base.signatures
            if len(self.maps) > 2:
                self.maps.clear()
            self.maps[q] = result
        return self.maps[q]

    def speeds(self, mechanism: Mechanism) -> Array:
        """Return how fast states are carried along."""
        return self.base.speeds(mechanism)

    def sizes(self, shot: Shot) -> Array:
        """Return the sizes of y, p and q (n + 2,)."""
        return np.append(shot.scale, self.widths)

    def shoot(self, y: Array, value: float = np.nan, most: Array | None = None) -> Shot:
        """Run over the period from free states and the first parameter in one vector."""
        result = self.near(np.append(y, value))
        if most is not None and (np.abs(result.residual) > most).any():
            raise SimulationError("a step along a curve has led away from it.")
        return result

    def border_beside(self, point: Point) -> str:
        """Return what else changes right beside the event at a point, in words, if anything does.

        Beside a fold or a doubling in the first parameter, and else in any unknown.
        """
        shot, u = self.base_of(point.shot), point.unknowns * point.scale
        sizes, smooth = self.sizes(shot), isinstance(self.condition, _Singular)
        back = self.back / float(self.back @ self.back) * sizes
        names = [*self.names, self.second]
        at = [len(names) - 2] if smooth else range(len(names))

        def happens(u: Array) -> Signature:
            return self.at(float(u[-1])).happens(u[:-2], float(u[-2]))

        with suppress(SimulationError, InputError):
            # its own change is that right on both sides
            sides = () if smooth else (-10.0 * NEARBY, -NEARBY, NEARBY, 10.0 * NEARBY)
            known = {point.signature, *(happens(u + off * back) for off in sides)}
            for side, i in itertools.product((-BORDER, BORDER), at):
                other = happens(u + side * np.diag(sizes)[i])
                if other not in known:
                    near = min(known, key=lambda signature: len({*signature} ^ {*other}))
                    size = "size" if i < len(names) - 2 else "range"
                    what = change_of(near, other)[1]
                    return f"with {names[i]} {BORDER:g} of its {size} off, {what}"
        return ""

    def near(self, u: Array) -> Shot:
        """Return what a run from unknowns tells, or one in front of a contact near them."""
        shot = self.at(float(u[-1])).shoot(u[:-2], float(u[-2]))
        g, beyond = self.condition(shot)
        if not beyond:
            return self.shot(u, u, shot, g)
        back = self.back / float(self.back @ self.back) * self.sizes(shot)
        for k in range(MOST_NEWTON):
            moved = u + 2.0**k * (abs(g) + NEARBY) * back
            other = self.at(moved[-1]).shoot(moved[:-2], float(moved[-2]))
            least, beyond = self.condition(other)
            if not beyond:
                return self.shot(u, moved, other, least)
        raise SimulationError("a step has led beyond the contact.")

    def shot(self, u: Array, moved: Array, shot: Shot, g: float) -> Shot:
        """Return what a run tells at unknowns, extrapolated from those that it was made at."""
        width = self.widths[0]
        derivatives: Any = Sensing(self, shot, float(moved[-1]), self.condition.at)
        residual, off = np.append(shot.residual, g * width), u - moved
        scale = np.append(shot.scale, width)
        if off.any():
            slopes = derivatives.all[: len(scale)].copy()
            slopes.flat[:: slopes.shape[1] + 1] -= 1.0
            residual = residual + slopes @ off
        return replace(
            shot,
            y=u[:-1],
            value=float(u[-1]),
            residual=residual,
            scale=scale,
            error=float((np.abs(residual) / scale).max()),
            off=off,
            half=np.append(shot.half, 0.0),
            derivatives=derivatives,
        )

    def happens(self, y: Array, value: float) -> Signature:
        """Return what happens in the period."""
        return self.shoot(y, value).signature

    def nearby(self, shot: Shot, y: Array, value: float) -> Shot:
        """Return what closes so near a shot that derivatives and events are those of its run."""
        near = self.at(value).nearby(self.base_of(shot), y[:-1], float(y[-1]))
        off = np.append(y - shot.y, value - shot.value) + shot.off
        zero = np.zeros_like(shot.residual)
        return replace(
            near, y=y, value=value, residual=zero, scale=shot.scale, off=off, half=shot.half,
            derivatives=shot.derivatives,
        )  # fmt: skip

    def base_of(self, shot: Shot) -> Shot:
        """Return the run of the orbit alone."""
        result: Any = shot.derivatives
        return result.shot if isinstance(result, Sensing) else shot

    def signature(self, mechanism: Mechanism, run: BareRun) -> Signature:
        """Return what happens in a run."""
        return self.base.signature(mechanism, run)

    def orbit(self, shot: Shot) -> Orbit:
        """Return the orbit that a shot has closed."""
        with suppress(SimulationError, InputError):
            map_ = self.at(shot.value)
            return map_.orbit(solved(map_, shot.y[:-1], float(shot.y[-1])))
        return self.base.orbit(self.base_of(shot))


@dataclass(frozen=True)
class Sensing:
    """Derivatives of orbit and event."""

    map: Plane
    """Whose run it was."""
    shot: Shot
    """The run of the orbit."""
    value: float
    """The second parameter."""
    at: float
    """Time over the period at which the contact is touched."""

    @cached_property
    def all(self) -> Array:
        """With respect to y, p and q: of the free states, of g, and of what advances."""
        base, n = self.shot.derivatives.by_unknowns, len(self.shot.y)
        slope = self.map.condition.slope(self.map, self.shot, self.value)
        self.map.back = slope
        g = self.map.widths[0] * slope / self.map.sizes(self.shot)
        g[n] += 1.0  # as of the states after a period, less those at its start
        return np.vstack([base[:n], g, base[n:]])

    @property
    def by_unknowns(self) -> Array:
        """The same."""
        return self.all

    @property
    def monodromy(self) -> Array:
        """Derivatives of the free states after the period with respect to their start."""
        return self.shot.derivatives.monodromy


def _det(sign: float) -> Callable[[Point], float]:
    return lambda point: float(np.prod(point.multipliers + sign).real)


def _cusp(point: Point) -> float:
    """Return the tangent of a curve of folds over the direction that the left null vector gives."""
    n = len(point.unknowns) - 2
    plane = point.shot.derivatives.map
    w = np.linalg.svd(point.slopes[:n, :n])[0][:, -1]
    if isinstance(plane, Plane) and isinstance(plane.condition, _Singular):
        border = plane.condition.border
        w = w if plane.base.of_states(w) @ border >= 0.0 else -w
    (a, b), (dp, dq) = w @ point.slopes[:n, n:], point.tangent[n:]
    return float(dp * b - dq * a) / float(a * a + b * b)


WITH: Final = {
    "fold": [
        ("cusp", "two folds meet", _cusp),
        ("fold-flip", "another multiplier at -1", _det(1.0)),
    ],
    "period doubling": [("fold-flip", "another multiplier at 1", _det(-1.0))],
} | {
    kind: [
        (f"{kind} with fold", "a multiplier at 1", _det(-1.0)),
        (f"{kind} with flip", "a multiplier at -1", _det(1.0)),
    ]
    for kind in ("grazing", "sticking")
}
"""Test functions of points of codimension two, by the kind of the curve."""


@dataclass(frozen=True, kw_only=True, eq=False)
class CodimensionTwo:
    """A point at which two events coincide.

    Parameters
    ----------
    kind : str
        Such as ``"cusp"``, ``"fold-flip"``, ``"grazing with fold"``.
    values : tuple of float
        Both parameters.
    sentence : str
        What happens there.
    orbit : Orbit
        The orbit there.
    """

    kind: str
    values: tuple[float, float]
    sentence: str
    orbit: Orbit


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class EventCurve(OnAxes, Tabular):
    """A curve of an event of periodic orbits over two parameters, point by point."""

    kind: str
    """``"fold"``, ``"period doubling"``, ``"grazing"`` or ``"sticking"``."""
    paths: tuple[str, str]
    """Full paths of the parameters."""
    parameter_units: tuple[str, str]
    """Their SI units."""
    cycles: int
    """Cycles of the drives after which the orbits close."""
    states: tuple[str, ...]
    """Free states (k,), as in `Orbit.free`."""
    units: Mapping[str, str]
    """SI units of all states."""
    values: Array
    """Both parameters (n, 2)."""
    starts: Array
    """Free states at time 0 (n, k)."""
    multipliers: NDArray[np.complex128]
    """Floquet multipliers (n, k), in front of a contact that is touched."""
    points: tuple[CodimensionTwo, ...]
    """Points of codimension two along it."""
    ends: tuple[str, str]
    """Why it ends at its first and at its last point."""
    runs: int
    """Runs over a period that it took, but for derivatives."""

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each point."""
        import pandas as pd

        columns: dict[str, object] = dict(zip(self.paths, self.values.T, strict=True))
        columns |= {"event": self.kind, "cycles": self.cycles}
        columns |= {name: self.starts[:, i] for i, name in enumerate(self.states)}
        return pd.DataFrame(columns)

    def _summary(self) -> Summary:
        names = [path.rpartition(".")[2] for path in self.paths]
        low, high = self.values.min(axis=0), self.values.max(axis=0)
        ranges = [
            f"{name} {span(float(a), float(b), unit, 4)}"
            for name, a, b, unit in zip(names, low, high, self.parameter_units, strict=True)
        ]
        rows = [
            (p.kind, *map(quantity, p.values, self.parameter_units, (6, 6)), p.sentence)
            for p in self.points
        ]
        return Summary(
            sentence=f"Curve of {self.kind} of period {self.cycles}, {len(self.values)} points:"
            f" {', '.join(ranges)}.",
            head=("point", *names, "what happens") if rows else (),
            rows=rows,
            notes=tuple(dict.fromkeys(self.ends)),
        )


def continue_event(
    event: BranchEvent,
    paths: tuple[str, str],
    box: Sequence[tuple[float, float]],
    *,
    step: float = MOST_STEP,
    points: int = MOST_POINTS,
    period: float | None = None,
) -> EventCurve:
    """Follow an event of a branch of periodic orbits over two parameters.

    For cycles that nothing drives in time the states of the curve hold the length `cycle`.

    Parameters
    ----------
    event : BranchEvent
        A fold, a period doubling, a grazing contact or a change of sticking that `continue_orbit`
        has located.
    paths : pair of str
        What varies, as in `ensemble`: first that along which the branch was followed.
    box : pair of pair of float
        Range of each.
    step : float
        Largest step, over the sizes of states and ranges.
    points : int
        Largest number of points to either side.
    period : float, optional
        Length of a cycle [s]; that of the drives if not given, and unknown where there are none.

    Returns
    -------
    EventCurve
        Both parameters along it, its orbits, and points of codimension two.

    Raises
    ------
    InputError
        If an argument cannot be used, or the event is of a kind that has no such curve.
    SimulationError
        If there is no orbit at the event that can be solved for.

    References
    ----------
    W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, SIAM 2000, chapter 4.

    Examples
    --------
    >>> from stickslip import Axis, Viscous
    >>> from stickslip.mechanisms.drives import Sine
    >>> from stickslip.study.sweep import continue_orbit, periodic_orbit
    >>> axis = Axis(
    ...     inertia=1.0, stiffness=1.0, drive=Sine(amplitude=0.8, frequency=0.1), upper_stop=2.0
    ... )
    >>> orbit = periodic_orbit(axis, Viscous(viscous_coefficient=0.4))
    >>> branch = continue_orbit(orbit, "drive.amplitude", (0.5, 2.0))
    >>> event = next(event for event in branch.events if event.kind == "grazing")
    >>> paths = ("drive.amplitude", "drive.frequency")
    >>> curve = continue_event(event, paths, ((0.5, 2.0), (0.09, 0.12)))
    >>> curve.kind, curve.ends
    ('grazing', ('It reaches 90 mHz.', 'It reaches 0.12 Hz.'))
    """
    owner = "continue_event"
    if getattr(event, "kind", None) not in KINDS:
        raise InputError(
            f"{owner}: event must be one of a branch, of kind {', '.join(KINDS)}, got"
            f" {getattr(event, 'kind', event)!r}."
        )
    if len({*paths}) != 2 or len(box) != 2:
        raise InputError(f"{owner}: paths and box must be two each, got {paths!r} and {box!r}.")
    counted(owner, "points", points, 1)
    check_step(owner, step, LEAST_STEP)
    orbit, ranges = event.orbit, [between_of(owner, pair) for pair in box]
    if orbit.controlled is not None:
        raise InputError(
            f"{owner}: the orbit is under delayed feedback, and curves follow those of drives that"
            " repeat themselves and self-excited ones. Follow the event by continue_orbit at"
            " several values."
        )
    full, values, units = zip(
        *(placed(owner, orbit, *pair) for pair in zip(paths, ranges, strict=True)), strict=True
    )
    if full[0] == full[1]:
        raise InputError(f"{owner}: paths must be two parameters, got {full[0]} twice.")
    base = replace(map_of(orbit, orbit.cycles, period, full[0]), beside=(full[1],))
    within(replace(base, path=full[1], beside=()), ranges[1])
    base = within(base, ranges[0])
    widths = ranges[0][1] - ranges[0][0], ranges[1][1] - ranges[1][0]
    y = base.unknowns_of(orbit)
    shot, condition = _begun(event.kind, base, y, values[0], widths[0])
    plane = Plane(base, full[1], widths, condition, shot, values[1])
    as_map: Any = plane
    curve = Curve(as_map, *ranges[1], units[1], step, int(points), LEAST_STEP)
    curve.box.append((-2, *ranges[0], units[0]))
    curve.tests, curve.hops = tuple(WITH[event.kind]), True
    curve.smooth = event.kind in ("fold", "period doubling")
    curve.scale = np.append(shot.scale, widths)
    curve.widest = curve.scale
    u = np.array([*shot.y.tolist(), shot.value, values[1]]) / curve.scale
    for normal in np.eye(len(u))[[-1, -2]]:  # with the one or the other parameter kept
        first = curve.correct(u, normal, 0.0)
        if first is not None:
            break
    else:
        raise SimulationError(
            f"{owner}: the search for an orbit at the {event.kind} near"
            f" {quantity(values[0], units[0], 6)} does not converge."
        )

    def accept(point: Point) -> None:
        own: Any = point.shot.derivatives
        if isinstance(own, Sensing):
            plane.condition.accept(own.shot, curve.scale[:-2], own.at)

    curve.accept, curve.beside = accept, plane.border_beside
    return _curve(event.kind, curve, plane, first[0], full, units)


def _curve(
    kind: str, curve: Curve, plane: Plane, first: Shot, paths: Sequence[str], units: Sequence[str]
) -> EventCurve:
    """Follow a curve from its first orbit to both sides."""
    begin = curve.point(first)
    result, events, ends = curve.both(begin)
    (low, high), met = curve.box[1][1:3], []
    for event in events:
        own = event.orbit
        value = value_of(own.mechanism, own.law, paths[0])
        if low <= value <= high:
            alone = {"period doubling": "flip"}.get(kind, kind)
            names = {name for name, _, _ in WITH[kind]}
            name = event.kind if event.kind in names else f"{alone} with {event.kind}"
            met.append(
                CodimensionTwo(
                    kind=name,
                    values=(value, event.value),
                    sentence=event.sentence.partition(";")[0],
                    orbit=own,
                )
            )
    unknowns = np.array([curve.unscaled(point.shot) for point in result])
    return EventCurve(
        kind=kind,
        paths=(paths[0], paths[1]),
        parameter_units=(units[0], units[1]),
        cycles=plane.cycles,
        states=plane.base.unknowns,
        units=units_of(plane.base),
        values=unknowns[:, -2:],
        starts=unknowns[:, :-2],
        multipliers=multipliers_of(result),
        points=tuple(met),
        ends=ends,
        runs=curve.runs,
    )


def _begun(
    kind: str, base: ReturnMap, y: Array, value: float, width: float
) -> tuple[Shot, Callable[[Shot], _Condition]]:
    """Return a run near the event, in front of a contact, and what makes it an event."""
    if kind in ("fold", "period doubling"):
        sign = -1.0 if kind == "fold" else 1.0
        return base.shoot(y, value).sensed(), lambda shot: _Singular(sign, shot)
    error: Exception | None = None
    for off in (0.0, *itertools.chain(*((d, -d) for d in NEARBY * 10.0 ** np.arange(1, 6)))):
        try:
            shot = solved(base, y, value + off * width)
            condition = _touched(kind, shot)
            if not condition(shot)[1]:
                return shot, lambda _, touched=condition: touched
        except (SimulationError, InputError) as caught:
            error = caught
    raise SimulationError(f"continue_event: no orbit in front of the contact: {error}")


def _touched(kind: str, shot: Shot) -> _Condition:
    """Return what is touched in a run: whatever comes nearest to it."""
    run, mechanism, period = shot.run, shot.mechanism, shot.period
    times = np.linspace(0.0, period, 32 * ORBIT_TIMES * shot.derivatives.map.cycles)[:-1]
    result: list[tuple[float, _Condition]] = []

    def consider(gap: _Gap) -> None:
        values = gap(run, mechanism, times)
        size = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
        left, right = np.roll(values, 1), np.roll(values, -1)
        least = np.flatnonzero(
            (values <= left) & (values < right) & (values < _Distance.touch * size)
        )
        for phase in (times[least] / period).tolist():
            touch = _Touch(gap, phase, size)
            with suppress(SimulationError):
                result.append((abs(touch(shot)[0]), touch))

    if kind == "grazing":
        for i in range(len(stops_of(mechanism))):
            consider(_HardStop(i))
        for i in range(run.playback.model.sizes.switches):
            for side in (1.0, -1.0):
                consider(_Switch(i, side))
    else:
        for contact in mechanism.contacts():
            consider(_Level(contact.name, shot.law))
            for side in (1.0, -1.0):
                consider(_Slip(contact.name, side))
        for turn in run.events():
            if turn.reason in ("stop", "reversal"):
                at = _Turn(turn.contact, turn.t / period, turn.reason == "stop")
                result.append((abs(at(shot)[0]), at))
    nearest = min(result, key=lambda pair: pair[0], default=(math.inf, None))
    if nearest[1] is None or nearest[0] > _Distance.touch:
        raise SimulationError("nothing is touched in the orbit at the event.")
    return nearest[1]
