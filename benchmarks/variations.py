"""References for sensitivities: a closed form, and variational equations written by hand."""

import math
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks import decay, lugre

TINY = 1e-30
"""An imaginary part so small that what it does is a derivative."""


def swing(t: float, m, k, x_0, g, mu):
    """Return place and velocity of the block of `decay`; the parameters may be complex."""
    w, level = np.sqrt(k / m), mu * m * g / k
    half, x, n = math.pi / w, 0.0, 0
    while True:
        middle = x_0 - (-1) ** n * level
        if (n + 1) * half.real > t:
            phase = w * t - n * math.pi
            return middle + (x - middle) * np.cos(phase), -(x - middle) * w * np.sin(phase)
        x, n = 2.0 * middle - x, n + 1


def swinging(t: float) -> np.ndarray:
    """Return the sensitivities to mass, stiffness, compression, gravity and friction."""
    numbers = np.array([decay.M, decay.K, decay.X_0, decay.G, decay.MU], dtype=complex)
    columns = []
    for i in range(len(numbers)):
        own = numbers.copy()
        own[i] += 1j * TINY
        columns.append([state.imag / TINY for state in swing(t, *own)])
    return np.transpose(columns)


def fading(
    t_end: float, inertia: float, mu_k: float, mu_s: float, v_s: float, sigma_2: float
) -> np.ndarray:
    """Return the sensitivities of an axis under 2 sin(2 pi t) to the five numbers, in that order.

    At a stop the moment moves by -S_v/a and the velocity's sensitivities go on with the change of
    the acceleration; at break-away the acceleration is 0 on both sides.
    """

    def drive(t: float) -> float:
        return 2.0 * math.sin(2.0 * math.pi * t)

    def acceleration(t: float, v: float, side: int) -> tuple[float, list[float], float]:
        e = math.exp(-((v / v_s) ** 2))
        a = (drive(t) - side * (mu_k + (mu_s - mu_k) * e) - sigma_2 * v) / inertia
        by_v_s = side * (mu_s - mu_k) * e * 2.0 * v**2 / v_s**3
        slopes = [-a, *(-side * f for f in (1.0 - e, e)), -by_v_s, -v]
        by_v = side * (mu_s - mu_k) * e * 2.0 * v / v_s**2 - sigma_2
        return a, [slope / inertia for slope in slopes], by_v / inertia

    def rates(t, y, side):
        a, slopes, by_v = acceleration(t, y[1], side)
        S_v = y[7:12]
        return [y[1], a, *S_v, *(by_v * S_v + slopes)]

    def stop(t, y, side):
        return y[1]

    stop.terminal = True
    t, y, side = math.asin(mu_s / 2.0) / (2.0 * math.pi), np.zeros(12), 1
    while t < t_end:
        stop.direction = -side
        run = solve_ivp(
            rates, (t, t_end), y, args=(side,), events=stop, method="DOP853", rtol=1e-13, atol=1e-15
        )
        t, y = float(run.t[-1]), run.y[:, -1].copy()
        if run.status == 0:
            break
        t, y, side = after_stop(t, y, side, mu_s, drive, lambda t, s: acceleration(t, 0.0, s)[0])
    return y[2:].reshape(2, 5)


def after_stop(
    t: float,
    y: np.ndarray,
    side: int,
    level: float,
    drive: Callable[[float], float],
    acceleration: Callable[[float, int], float],
) -> tuple[float, np.ndarray, int]:
    """Return where and how motion goes on after a stop: at once the other way, or later."""
    y[1] = 0.0
    if drive(t) * -side > level:
        y[7:12] *= acceleration(t, -side) / acceleration(t, side)
        return t, y, -side
    y[7:12] = 0.0
    quarter = math.asin(level / 2.0) / (2.0 * math.pi)
    halves = (n for n in range(1000) if n / 2.0 + quarter > t)
    n = next(halves)
    return n / 2.0 + quarter, y, 1 if n % 2 == 0 else -1


def bristles(t_end: float) -> np.ndarray:
    """Return the sensitivities of the LuGre case to F_k, F_s, v_s, sigma_0 and sigma_1."""
    F_K, F_S, V_S, S0, S1, M = lugre.F_K, lugre.F_S, lugre.V_S, lugre.S0, lugre.S1, lugre.M

    def rates(t, y):
        x, v, z = y[:3]
        e = math.exp(-((v / V_S) ** 2))
        g = F_K + (F_S - F_K) * e
        z_dot = v - S0 * abs(v) * z / g
        by_g = S0 * abs(v) * z / g**2
        by_v_s = by_g * (F_S - F_K) * e * 2.0 * v**2 / V_S**3
        by_p = np.array([by_g * (1.0 - e), by_g * e, by_v_s, -abs(v) * z / g, 0.0])
        v_by_p = (-S1 * by_p - np.array([0.0, 0.0, 0.0, z, z_dot])) / M
        S = y[3:].reshape(3, 5)
        slopes = np.array(lugre.jacobian(t, y[:3])) @ S + np.array([np.zeros(5), v_by_p, by_p])
        return [*lugre.rates(t, (x, v, z)), *slopes.ravel()]

    scale = np.array([1.0, 1.0, 1e3, 1e-5, 1e-2])
    atol = np.concatenate([[1.0, 0.1, 1e-5], *(s * scale for s in (1.0, 0.1, 1e-5))])
    run = solve_ivp(rates, (0.0, t_end), np.zeros(18), method="Radau", rtol=1e-10,
                    atol=1e-10 * atol)  # fmt: skip
    return run.y[3:13, -1].reshape(2, 5)
