"""Derivatives of whole runs from elsewhere: dual numbers through the laws' own Python, and SciPy.

The equations of motion are written by hand, the laws and the drives are evaluated with numbers that
carry their derivatives, and the variational equations are integrated with DOP853 from event to
event. Nothing of the generated equations or of the kernels takes part.
"""

import functools
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from stickslip import Axis, EventDriven, SpringBlock, simulate
from stickslip.maths import cos, sin, where
from stickslip.mechanisms.drives import Sum
from stickslip.quantities import parameters, shadow, vary

PYTHON = EventDriven(tier="compiled")
SMALLEST = 0.01
"""Derivatives are scaled by the size of the parameter, or by this where it is nearly 0."""


@dataclass(frozen=True, eq=False)
class Dual:
    """A number and its derivatives along some directions."""

    x: float
    d: Any

    def __add__(self, other):
        return Dual(self.x + value(other), self.d + slope(other))

    def __mul__(self, other):
        return Dual(self.x * value(other), self.d * value(other) + self.x * slope(other))

    def __truediv__(self, other):
        quotient = self.x / value(other)
        return Dual(quotient, (self.d - quotient * slope(other)) / value(other))

    def __rtruediv__(self, other):
        return Dual(other / self.x, -other / self.x**2 * self.d)

    def __neg__(self):
        return Dual(-self.x, -self.d)

    def __sub__(self, other):
        return self + (-other)

    def __rsub__(self, other):
        return other + (-self)

    __radd__, __rmul__ = __add__, __mul__

    def __abs__(self):
        return self if self.x >= 0.0 else -self

    def __float__(self):
        return self.x

    def __lt__(self, other):
        return self.x < value(other)

    def __gt__(self, other):
        return self.x > value(other)

    def __maths__(self, name: str, *arguments):
        if name == "exp":
            grown = math.exp(min(self.x, 700.0))  # stages beyond a stop have no meaning
            return Dual(grown, grown * self.d)
        if name == "sin":
            return Dual(math.sin(self.x), math.cos(self.x) * self.d)
        if name == "cos":
            return Dual(math.cos(self.x), -math.sin(self.x) * self.d)
        if name == "sign":
            return math.copysign(1.0, self.x)
        assert name == "power", name
        base, n = (value(argument) for argument in arguments)
        if base <= 0.0:  # as in stickslip.maths.power
            return Dual(base**n if float(n).is_integer() else 0.0, 0.0 * self.d)
        by_base = n * base ** (n - 1.0) * slope(arguments[0])
        return Dual(base**n, by_base + math.log(base) * base**n * slope(arguments[1]))


def value(number) -> float:
    """Return the number itself."""
    return number.x if isinstance(number, Dual) else number


def slope(number) -> Any:
    """Return the derivatives."""
    return number.d if isinstance(number, Dual) else 0.0


@dataclass(frozen=True)
class Case:
    """A run that can be made again with other numbers."""

    rig: Any
    law: Any
    t_end: float
    y0: tuple[float, ...]

    def states(self) -> tuple[str, ...]:
        """Return the names of the states."""
        bristles = self.law.states if self.law.states else ()
        return (*self.rig.coordinates, *self.rig.rates, *bristles)

    def paths(self) -> dict[str, float]:
        """Return all that sensitivities can be taken of, and what it is."""
        values = {path: x for path, _, x in parameters(self.rig, "mechanism")}
        values |= {path: x for path, _, x in parameters(self.law, "friction")}
        return values | {f"initial.{n}": x for n, x in zip(self.states(), self.y0, strict=True)}

    def sizes(self) -> dict[str, float]:
        """Return the size of each of the paths, by which derivatives are scaled."""
        return {path: max(abs(x), SMALLEST) for path, x in self.paths().items()}

    def run(self, solver: EventDriven = PYTHON, changes: dict[str, float] | None = None) -> Any:
        """Run, with some numbers changed by path."""
        rig, law, start = self.rig, self.law, list(self.y0)
        for path, x in (changes or {}).items():
            if path.startswith("mechanism."):
                rig = vary(rig, "mechanism", {path: x})
            elif path.startswith("friction."):
                law = vary(law, "friction", {path: x})
            else:
                start[self.states().index(path.removeprefix("initial."))] = x
        return simulate(rig, law, t_end=self.t_end, y0=start, solver=solver, throw=False)

    def sensitivities(self, t, solver: EventDriven = PYTHON) -> Any:
        """Return those of a run (n, states, paths), scaled by the sizes of the paths."""
        run = self.run(solver).at(t)
        columns = [[run.sensitivity(s, p) * h for p, h in self.sizes().items()] for s in run.states]
        return np.transpose(np.array(columns), (2, 0, 1))


class Oracle:
    """Variational equations of a case, from event to event."""

    def __init__(self, case: Case) -> None:
        paths, sizes = case.paths(), case.sizes()
        seeds = {p: Dual(x, row) for (p, x), row in zip(
            paths.items(), np.diag(list(sizes.values())), strict=True
        )}  # fmt: skip
        self.case = case
        self.rig = shadow(case.rig, "mechanism", seeds.__getitem__)
        self.law = shadow(case.law, "friction", seeds.__getitem__)
        self.start = [seeds[f"initial.{state}"] for state in case.states()]
        (self.drive,) = self.rig.drives().values() or (None,)
        self.can_stick = not case.law.states or case.law.static_switch
        parts = self.drive.parts if isinstance(self.drive, Sum) else (self.drive,)
        self.tables = [part.pieces(case.t_end) for part in parts if part is not None]
        starts = [piece.start for table in self.tables for piece in table]
        self.starts = sorted((s for s in starts if value(s) < case.t_end), key=value)

    def push(self, t: float, y: list[Dual], piece: int) -> Any:
        """Return all forces along x but friction."""
        r, (x, v) = self.rig, y[:2]
        u = 0.0 if self.drive is None else self.drive.smooth(t)
        u += sum(self.held(table, t, piece) for table in self.tables)
        if isinstance(self.case.rig, SpringBlock):
            gap = r.compression - x
            touches = r.attached or gap.x * r.compression.x > 0
            downhill = r.mass * r.gravity * sin(r.incline)
            return u - downhill + where(touches, r.stiffness * gap, 0.0)
        if isinstance(self.case.rig, Axis):
            return u - r.damping * v - r.offset - r.stiffness * x
        return r.stiffness * (r.speed * t - x) + r.damping * (r.speed - v)

    def held(self, table: Any, t: float, piece: int) -> Any:
        """Return what a drive's table gives from a start on."""
        since = value(self.starts[piece]) if piece >= 0 else -math.inf
        holding = [row for row in table if value(row.start) <= since]
        if not holding:
            return 0.0
        begin, level, rate = holding[-1]
        return level + (rate * (t - begin) if value(rate) else 0.0)

    def load(self) -> Any:
        """Return the normal force."""
        own = getattr(self.rig, "load", None)
        if own is not None:
            return own
        weight = self.rig.mass * self.rig.gravity
        return weight * cos(self.rig.incline) if hasattr(self.rig, "incline") else weight

    def field(self, t: float, y: list[Dual], mode: int, piece: int) -> list[Any]:
        """Return the slopes of the states in a mode."""
        if mode == 0:
            return [0.0 * part for part in y]
        mass = self.rig.inertia if isinstance(self.case.rig, Axis) else self.rig.mass
        x_dot, load = y[1], self.load()
        if self.case.law.states:
            force = self.law.force(x_dot, load, tuple(y[2:]))
            rates = self.law.rates(x_dot, load, tuple(y[2:]))
        else:
            force, rates = mode * self.law.towards(mode).sliding(mode * x_dot, load), ()
        return [x_dot, (self.push(t, y, piece) - force) / mass, *rates]

    def to_break_away(self, t: float, y: list[Dual], piece: int) -> Any:
        """Return what is left of the break-away level."""
        push = self.push(t, y, piece)
        return self.law.towards(1 if value(push) > 0.0 else -1).break_away(self.load()) - abs(push)

    def mode_from_rest(self, t: float, y: list[Dual], piece: int) -> int:
        """Return what a body at rest does."""
        if self.can_stick and self.to_break_away(t, y, piece).x >= 0.0:
            return 0
        return self.leaving(t, y, piece)

    def leaving(self, t: float, y, piece: int) -> int:
        """Return the direction in which a body leaves rest."""
        if self.case.law.states:
            return 1 if value(self.field(t, y, 1, piece)[1]) > 0.0 else -1
        return 1 if value(self.push(t, y, piece)) > 0.0 else -1

    def segment(self, span, y: list[Dual], mode: int, piece: int) -> Any:
        """Integrate a mode up to its end, or to that of a piece of the drive."""
        shape = (len(y), 1 + len(y[0].d))

        def rhs(t, flat):
            rows = flat.reshape(shape)
            slopes = self.field(t, [Dual(float(r[0]), r[1:]) for r in rows], mode, piece)
            return np.concatenate([[s.x, *s.d] for s in slopes])

        def ends(t, flat):
            if mode:
                return flat[shape[1]]
            rows = flat.reshape(shape)
            return self.to_break_away(t, [Dual(float(r[0]), r[1:]) for r in rows], piece).x

        ends.terminal, ends.direction = True, -mode or -1  # type: ignore[attr-defined]
        flat = np.concatenate([[part.x, *part.d] for part in y])
        # where bristles relax, steps as long as stability allows have a poor interpolation
        longest = 1e-3 if self.case.law.states else 0.05
        return solve_ivp(
            rhs, span, flat, method="DOP853", rtol=1e-12, atol=1e-14, dense_output=True,
            events=ends, max_step=longest,
        )  # fmt: skip

    def solve(self) -> tuple[list[tuple[float, Any]], Callable[[Any], Any]]:
        """Return the ends of the segments, and sensitivities (n, states, paths) at times."""
        t, y, piece = 0.0, self.start, -1
        while piece + 1 < len(self.starts) and value(self.starts[piece + 1]) <= 0.0:
            piece += 1
        mode = int(np.sign(y[1].x)) or self.mode_from_rest(t, y, piece)
        if mode == 0:
            y[1] = Dual(0.0, 0.0 * y[1].d)
        parts: list[tuple[float, Any]] = []
        while t < self.case.t_end:
            more = piece + 1 < len(self.starts)
            stop = value(self.starts[piece + 1]) if more else self.case.t_end
            done = self.segment((t, stop), y, mode, piece)
            parts.append((t, done.sol))
            t = float(done.t[-1])
            rows = done.y[:, -1].reshape(len(y), -1)
            y = [Dual(float(row[0]), row[1:]) for row in rows]
            y, mode, piece = self.passed(t, y, mode, piece, by_event=done.status == 1)
        return parts, lambda times: self.read(parts, times)

    def passed(self, t: float, y, mode: int, piece: int, *, by_event: bool):
        """Make the transition at the end of a segment; the sensitivities jump with its moment."""
        before = self.field(t, y, mode, piece)
        if by_event:
            if mode:
                moment = -y[1].d / before[1].x
                y[1] = Dual(0.0, y[1].d)
            else:
                later = self.to_break_away(t + 1e-7, y, piece).x
                rate = (later - self.to_break_away(t - 1e-7, y, piece).x) / 2e-7
                moment = -self.to_break_away(t, y, piece).d / rate
            new = self.mode_from_rest(t, y, piece) if mode else self.leaving(t, y, piece)
            if mode and not self.can_stick:
                new = -mode
        else:
            piece += 1
            if piece >= len(self.starts):
                return y, mode, piece
            moment = slope(self.starts[piece])
            new = mode or self.mode_from_rest(t, y, piece)
        after = self.field(t, y, new, piece)
        jumped = [
            Dual(part.x, part.d + (b.x - a.x) * moment)
            for part, b, a in zip(y, before, after, strict=True)
        ]
        return jumped, new, piece

    def read(self, parts, times) -> Any:
        """Return the sensitivities at times."""
        begins = [begin for begin, _ in parts]
        places = np.maximum(np.searchsorted(begins, times, side="right") - 1, 0)
        rows = [parts[i][1](t) for i, t in zip(places, times, strict=True)]
        return np.array(rows).reshape(len(times), len(self.start), -1)[:, :, 1:]


def away_from_ends(parts, t_end: float) -> Any:
    """Return times in all segments, not at their ends, where round-off decides the side."""
    edges = [*(begin for begin, _ in parts), t_end]
    inner = [low + (high - low) * s for low, high in itertools.pairwise(edges) for s in (0.3, 0.8)]
    return np.array([*inner, t_end])


@functools.lru_cache(maxsize=1)
def solved(case: Case) -> Any:
    """Return the oracle's solution of a case, to which runs of several tolerances are held."""
    return Oracle(case).solve()


def mismatch(case: Case, solver: EventDriven = PYTHON) -> float:
    """Return the largest difference between run and oracle, over the size of state and slope."""
    parts, expected = solved(case)
    t = away_from_ends(parts, case.t_end)
    found, known = case.sensitivities(t, solver), expected(t)
    run = case.run(solver)
    largest = np.array([np.abs(run[state]).max() for state in run.states])
    return float((np.abs(found - known) / (np.abs(known).max(axis=0) + largest[:, None])).max())
