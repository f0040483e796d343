"""The mechanisms in SciPy: forces, modes and events by hand."""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.peers import BOTH, Engine
from benchmarks.several.problem import (
    BENT,
    LENGTH,
    LOWER,
    SECOND,
    SPEED,
    THIRD,
    UPPER,
    Case,
    G,
    Run,
    loads,
    speeds,
    stiffness,
    torque,
)

OFF = 1e-11
"""Velocity that contacts begin to slip with, or the event would be found again [m/s, rad/s]."""
ROUNDING = 1e-12
"""By which needed friction may exceed a static level [N, N m]."""


@dataclass(frozen=True, kw_only=True)
class Equations:
    """Equations of motion ``mass(q) a = force(t, q, v)`` less friction of each coordinate."""

    case: Case
    start: np.ndarray
    mass: Callable[[np.ndarray], np.ndarray | None]
    """None for a mass of 1 for each coordinate."""
    force: Callable[[float, np.ndarray, np.ndarray], np.ndarray]
    loads: Callable[[float], np.ndarray | float]
    first: int = 0
    """First coordinate with friction; all after it have some."""
    jumps: tuple[float, ...] = ()
    """Times at which loads jump."""

    def level(self, coefficients: np.ndarray, t: float) -> np.ndarray:
        result = np.zeros(len(self.start) // 2)
        result[self.first :] = coefficients * self.loads(t)
        return result

    def balance(
        self, t: float, y: np.ndarray, side: np.ndarray, held: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return accelerations, and the friction that held coordinates need."""
        n = len(side)
        push = self.force(t, y[:n], y[n:]) - side * self.level(self.case.kinetic, t)
        matrix = self.mass(y[:n])
        if matrix is None:
            return np.where(held, 0.0, push), np.where(held, push, 0.0)
        result, free = np.zeros(n), ~held
        result[free] = np.linalg.solve(matrix[np.ix_(free, free)], push[free])
        return result, np.where(held, push - matrix @ result, 0.0)

    def slope(self, t: float, y: np.ndarray, side: np.ndarray, held: np.ndarray) -> np.ndarray:
        speeds = np.where(held, 0.0, y[len(side) :])
        return np.concatenate([speeds, self.balance(t, y, side, held)[0]])

    def spare(self, t: float, y: np.ndarray, side: np.ndarray, held: np.ndarray) -> np.ndarray:
        """Return what is left of speeds, and of static levels where contacts stick."""
        result = side * y[len(side) :]
        result[: self.first] = math.inf
        if held.any():
            _, needed = self.balance(t, y, side, held)
            result[held] = (self.level(self.case.static, t) - np.abs(needed))[held]
        return result

    def let_go(self, i: int, t: float, y: np.ndarray, side: np.ndarray, held: np.ndarray) -> None:
        _, needed = self.balance(t, y, side, held)
        held[i], side[i] = False, math.copysign(1.0, needed[i])
        y[len(side) + i] = side[i] * OFF

    def settle(self, t: float, y: np.ndarray, side: np.ndarray, held: np.ndarray) -> None:
        """Let those slip that static levels do not hold, the worst one first."""
        while held.any():
            beyond = np.where(held, -self.spare(t, y, side, held), -1.0)
            i = int(np.argmax(beyond))
            if beyond[i] <= ROUNDING:
                return
            self.let_go(i, t, y, side, held)


def chain(case: Case) -> Equations:
    n = len(case.mechanism.coordinates)
    matrix = stiffness(n)
    return Equations(
        case=case,
        start=np.concatenate([np.zeros(n), speeds(n)]),
        mass=lambda q: None,
        force=lambda t, q, v: -matrix @ q,
        loads=lambda t: 1.0,
    )


def arm(case: Case) -> Equations:
    m, l2 = LOWER * LENGTH * LENGTH, LENGTH * LENGTH

    def mass(q: np.ndarray) -> np.ndarray:
        c = m * math.cos(q[1])
        return np.array([[UPPER * l2 + 2.0 * m + 2.0 * c, m + c], [m + c, m]])

    def force(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        s = m * math.sin(q[1])
        lower = LOWER * G * LENGTH * math.sin(q[0] + q[1])
        upper = (UPPER + LOWER) * G * LENGTH * math.sin(q[0])
        return np.array([s * v[1] * (2.0 * v[0] + v[1]) - upper - lower, -s * v[0] ** 2 - lower])

    return Equations(
        case=case,
        start=np.array([*BENT, 0.0, 0.0]),
        mass=mass,
        force=force,
        loads=lambda t: 1.0,
    )


def clutches(case: Case) -> Equations:
    sums = np.tril(np.ones((4, 4)))  # of relative angles
    matrix = sums.T @ sums
    return Equations(
        case=case,
        start=np.array([0.0, 0.0, 0.0, 0.0, SPEED, -SPEED, 0.0, 0.0]),
        mass=lambda q: matrix,
        force=lambda t, q, v: np.array([torque(t), 0.0, 0.0, 0.0]),
        loads=loads,
        first=1,
        jumps=(SECOND, THIRD),
    )


def integrate(rig: Equations, tolerance: float) -> np.ndarray:
    """Return the last places; contacts that stick are left out of the equations."""
    n, t, y = len(rig.start) // 2, 0.0, rig.start.copy()
    side = np.sign(y[n:])
    side[: rig.first] = 0.0
    held = (side == 0.0) & (np.arange(n) >= rig.first)
    rig.settle(t, y, side, held)

    def least(t: float, y: np.ndarray, side: np.ndarray, held: np.ndarray) -> float:
        return float(np.min(rig.spare(t, y, side, held)))

    least.terminal, least.direction = True, -1
    for stop in (*rig.jumps, rig.case.t_end):
        while t < stop:
            run = solve_ivp(
                rig.slope, (t, stop), y, method="DOP853", rtol=tolerance, atol=tolerance,
                events=least, args=(side, held),
            )  # fmt: skip
            t, y = float(run.t[-1]), run.y[:, -1].copy()
            if run.status == 1:
                i = int(np.argmin(rig.spare(t, y, side, held)))
                if held[i]:
                    rig.let_go(i, t, y, side, held)
                else:
                    held[i], side[i], y[n + i] = True, 0.0, 0.0
            rig.settle(t, y, side, held)
    return y[:n]


def engines(name: str, case: Case, tolerances: tuple[float, ...] = (1e-9, 1e-12)):
    rig = {"chain": chain, "arm": arm, "clutches": clutches}[name](case)

    def run(tolerance: float) -> np.ndarray:
        places = integrate(rig, tolerance)
        return np.cumsum(places) if name == "clutches" else places

    def build(tolerance: float) -> Run:
        return functools.partial(run, tolerance)

    return tuple(
        Engine(
            name=f"SciPy DOP853, modes and events by hand, {tolerance:g}",
            levels=BOTH,
            build=functools.partial(build, tolerance),
        )
        for tolerance in tolerances
    )
