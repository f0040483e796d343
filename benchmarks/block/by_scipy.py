"""The block in SciPy: by the sign of the velocity, by smooth laws, and with events by hand."""

import functools
import math
from collections.abc import Callable

from scipy.integrate import solve_ivp

from benchmarks.block.problem import F_K, F_S, M, Places, Run, pushes
from benchmarks.peers import BOTH, ONE, Engine, StallError

MOST = 200_000
"""Evaluations after which a run is given up."""


def sign(v: float) -> float:
    return math.copysign(F_K, v) if v else 0.0


def smooth(width: float, v: float) -> float:
    return F_K * math.tanh(v / width)


def simscape(v: float, v_brk: float = 0.1) -> float:
    """Return the force of the formula that Simscape's documentation prints, with its default."""
    v_St, v_Coul = math.sqrt(2) * v_brk, v_brk / 10
    peak = math.sqrt(2 * math.e) * (F_S - F_K) * math.exp(-((v / v_St) ** 2)) * v / v_St
    return peak + F_K * math.tanh(v / v_Coul)


def by_law(
    law: Callable[[float], float], method: str, tolerance: float, hold: float, seconds: float
) -> Run:
    """Integrate a force that is a function of the velocity, anew where the push changes."""

    def run() -> Places:
        evaluations = 0

        def rates(t, y, force):
            nonlocal evaluations
            evaluations += 1
            if evaluations > MOST:
                raise StallError(f"at t = {t:.2f} s after {MOST} evaluations")
            return [y[1], (force - law(y[1])) / M]

        y, places = [0.0, 0.0], []
        for force, start, end in pushes(hold, seconds):
            y = solve_ivp(
                rates, (start, end), y, method=method, rtol=tolerance, atol=1e-3 * tolerance,
                args=(force,),
            ).y[:, -1]  # fmt: skip
            places.append(float(y[0]))
        return Places(before=places[-2], after=places[-1])

    return run


def by_events(hold: float, seconds: float) -> Run:
    """Slip forward as the only motion, its stop as an event, rest as no motion."""

    def stop(t, y, force):
        return y[1]

    def slipping(t, y, force):
        return [y[1], (force - F_K) / M]

    stop.terminal, stop.direction = True, -1

    def run() -> Places:
        y, slips, places = [0.0, 0.0], False, []
        for force, start, end in pushes(hold, seconds):
            slips = slips or force > F_S
            if slips:
                result = solve_ivp(
                    slipping, (start, end), y, method="DOP853", rtol=1e-9, atol=1e-12,
                    events=stop, args=(force,),
                )  # fmt: skip
                y, slips = result.y[:, -1], result.status == 0
            y = [float(y[0]), float(y[1]) if slips else 0.0]
            places.append(y[0])
        return Places(before=places[-2], after=places[-1])

    return run


def engines() -> tuple[Engine, ...]:
    laws = (
        ("SciPy RK45, sign(v)", ONE, sign, "RK45", 1e-3),
        ("SciPy LSODA, tanh, 1 mm/s", ONE, functools.partial(smooth, 1e-3), "LSODA", 1e-9),
        ("SciPy LSODA, tanh, 1 um/s", ONE, functools.partial(smooth, 1e-6), "LSODA", 1e-9),
        ("SciPy LSODA, Simscape's formula", BOTH, simscape, "LSODA", 1e-9),
    )
    return (
        Engine(name="SciPy DOP853, events by hand", levels=BOTH, build=by_events),
        *(
            Engine(name=name, levels=levels, build=functools.partial(by_law, law, method, rtol))
            for name, levels, law, method, rtol in laws
        ),
    )
