"""A towed block with LuGre friction: stiff, no events, no closed form."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.kernel import Kernel
from benchmarks.measuring import (
    MANY,
    TIERS,
    Entry,
    Result,
    Target,
    at_error,
    faster,
    own_entries,
    with_times,
)
from stickslip import LuGre, TowedBlock

M, K, SPEED = 1.0, 2.0, 0.1
F_K, F_S, V_S, S0, S1, S2 = 1.0, 1.5, 1e-3, 1e5, 316.0, 0.4
T_END = 20.0
TIMES = np.linspace(0.0, T_END, 401)
ERROR = 1e-8
STIFFNESSES = (1e5, 1e7)
LOOSE = 1e-6
"""A tolerance that has a line of its own in the growth of steps."""
WORK = "LuGre (sigma0 = 1e5), error 1e-8"
WHY = (
    "Rodas5P, of order 5, needs 2000 steps for this error, of which 760 creep up to the first slip;"
    " solutions with its factors are a quarter of the time, the equations another, the exponential"
    " among them a tenth of all, the search for events a fifth"
)
WHY_GROWTH = "the tighter the tolerance, the more the steps grow"

BLOCK = TowedBlock(mass=M, stiffness=K, speed=SPEED, load=1.0)
LAW = LuGre(
    kinetic_coefficient=F_K, static_coefficient=F_S, stribeck_velocity=V_S,
    bristle_stiffness=S0, bristle_damping=S1, viscous_coefficient=S2,
)  # fmt: skip


def rates(t, y):
    x, v, z = y
    g = F_K + (F_S - F_K) * math.exp(-((v / V_S) ** 2))
    z_dot = v - S0 * abs(v) * z / g
    return [v, (K * (SPEED * t - x) - S0 * z - S1 * z_dot - S2 * v) / M, z_dot]


def jacobian(t, y):
    _, v, z = y
    surplus = (F_S - F_K) * math.exp(-((v / V_S) ** 2))
    g, slope = F_K + surplus, -2 * v / V_S**2 * surplus
    by_v = 1 - S0 * z * (math.copysign(1.0, v) * g - abs(v) * slope) / g**2
    by_z = -S0 * abs(v) / g
    return [
        [0.0, 1.0, 0.0],
        [-K / M, -(S1 * by_v + S2) / M, -(S0 + S1 * by_z) / M],
        [0.0, by_v, by_z],
    ]


def by_scipy(
    method: str, tolerance: float, times: Sequence[float] | None = None, t_end: float = T_END
):
    """Return a run; tolerances of small states follow their size."""
    atol = tolerance * np.array([1.0, 0.1, 1e-5])
    return solve_ivp(
        rates, (0.0, t_end), [0.0, 0.0, 0.0], method=method, rtol=tolerance, atol=atol,
        jac=jacobian, t_eval=times,
    )  # fmt: skip


def at_once(method: str, error_of: Callable[[np.ndarray], float]) -> Entry:
    """Return an entry of SciPy: what is timed has no values between steps, as in the kernel."""

    def stepped(tolerance: float) -> float:
        by_scipy(method, tolerance)
        return tolerance

    def error(tolerance: float) -> float:
        return error_of(by_scipy(method, tolerance, TIMES).y[0])

    return at_error(f"SciPy {method}, equations by hand", stepped, error, ERROR)


def growth(tolerance: float) -> Target:
    """Return how the steps grow with the stiffness of the bristles."""
    kernels = [
        Kernel(BLOCK, replace(LAW, bristle_stiffness=s, bristle_damping=math.sqrt(s)), T_END)
        for s in STIFFNESSES
    ]
    few = [kernel.run(LOOSE).steps() for kernel in kernels]
    steps = [kernel.run(tolerance).steps() for kernel in kernels]
    ratio = steps[1] / steps[0]
    return Target(
        work="LuGre, steps when sigma0 grows 100 x, sigma1 = sqrt(sigma0)",
        goal="grow < 1.5 x",
        measured=f"{ratio:.2f} x ({steps[0]} to {steps[1]}) at tolerance {tolerance:.0e};"
        f" {few[1] / few[0]:.2f} x at {LOOSE:.0e}",
        met=ratio < 1.5,
        reason=WHY_GROWTH,
    )


def run(repeats: int = MANY, tiers: Sequence[str] = tuple(TIERS)) -> Result:
    """Run the case."""
    reference = by_scipy("Radau", 1e-12, TIMES).y[0]
    largest = float(np.abs(reference).max())

    def error_of(x: np.ndarray) -> float:
        return float(np.abs(x - reference).max()) / largest

    entries = with_times(
        (
            *own_entries(
                BLOCK, LAW, T_END, lambda run: error_of(run.at(TIMES)["x"]),
                lambda kernel: error_of(kernel.states(TIMES)[0]), ERROR, tiers,
                "stiff_tolerance",
            ),
            *(at_once(method, error_of) for method in ("Radau", "LSODA")),
        ),
        repeats,
        time.process_time,
    )  # fmt: skip
    return Result(
        title="Towed block with LuGre friction, 20 s",
        what=f"place at {len(TIMES)} times over the largest, against SciPy Radau at 1e-12",
        error=ERROR,
        entries=entries,
        targets=(
            *faster(WORK, 30.0, entries, "SciPy LSODA", WHY),
            *((growth(entries[0].tolerance),) if "compiled" in tiers else ()),
        ),
    )
