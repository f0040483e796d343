"""A towed block with LuGre friction: stiff, no events, no closed form."""

import functools
import math
from collections.abc import Sequence

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.measuring import REPEATS, TIERS, Result, at_error, own_entries, with_times
from stickslip import EventDriven, LuGre, TowedBlock, simulate

M, K, SPEED = 1.0, 2.0, 0.1
F_K, F_S, V_S, S0, S1, S2 = 1.0, 1.5, 1e-3, 1e5, 316.0, 0.4
T_END = 20.0
TIMES = np.linspace(0.0, T_END, 401)
ERROR = 1e-6

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


def by_scipy(method: str, tolerance: float):
    """Return the positions; tolerances of small states follow their size."""
    atol = tolerance * np.array([1.0, 0.1, 1e-5])
    run = solve_ivp(
        rates, (0.0, T_END), [0.0, 0.0, 0.0], method=method, rtol=tolerance, atol=atol,
        jac=jacobian, t_eval=TIMES,
    )  # fmt: skip
    return run.y[0]


def by_stickslip(solver: EventDriven):
    return simulate(BLOCK, LAW, t_end=T_END, solver=solver).at(TIMES)["x"]


def run(repeats: int = REPEATS, tiers: Sequence[str] = tuple(TIERS)) -> Result:
    """Run the case."""
    reference = by_scipy("Radau", 1e-11)
    largest = float(np.abs(reference).max())

    def error_of(x) -> float:
        return float(np.abs(x - reference).max()) / largest

    return Result(
        title="Towed block with LuGre friction, 20 s",
        what="place at 401 times over the largest, against SciPy Radau at 1e-11",
        error=ERROR,
        entries=with_times((
            *own_entries(BLOCK, LAW, by_stickslip, error_of, ERROR, tiers, "stiff_tolerance"),
            *(
                at_error(
                    f"SciPy {method}, equations by hand", functools.partial(by_scipy, method),
                    error_of, ERROR,
                )
                for method in ("Radau", "LSODA")
            ),
        ), repeats),
    )  # fmt: skip
