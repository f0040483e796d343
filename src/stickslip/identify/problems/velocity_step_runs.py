r"""Runs of many spring sliders at once, whose load points all move alike.

With :math:`w = \ln(V/V_0)` and :math:`s_i = \ln(V_0 \theta_i/D_i)`, and the load point at
:math:`V_l`:

    mu' = k (V_l - V)
    s_i' = R(w, s_i)/D_i - c/(b + b_2) mu'
    w' = (mu' - b s_1' - b_2 s_2')/a
    R = e^-s V_0 - V                              ageing, Nagata
        -V (w + s)                                slip
        (V_0 e^-s - V e^(w + s))/2                Perrin, Rice and Zheng

1. All sliders share the steps of time, so what two of them differ by is smooth in what their laws
   differ by: differences of runs are derivatives, however close they are.
2. A step is one of a Rosenbrock method of order 4 that is stiffly accurate (RODAS4, [HW]). Its
   linear systems are arrows: a state is coupled to the speed alone, and is eliminated.
3. The step is as long as the largest error of any slider allows. A slider that sets the length of
   more than `MOST` steps runs away, or sticks and slips: it ends, and the others go on.
4. Between steps the coefficient is a cubic through its values and slopes.

.. [HW] E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, Springer, 1996, IV.7.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]

GAMMA = 0.25
STAGES = tuple(
    map(
        np.array,
        (
            (),
            (1.544,),
            (0.9466785280815826, 0.2557011698983284),
            (3.314825187068521, 2.896124015972201, 0.9986419139977817),
            (1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950),
        ),
    )
)
"""What stages add to the state at which the next is evaluated."""
COUPLINGS = tuple(map(np.array, (
    (),
    (-5.6688,),
    (-2.430093356833875, -0.2063599157091915),
    (-0.1073529058151375, -9.594562251023355, -20.47028614809616),
    (7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160),
    (8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136,
     -6.058818238834054),
)))  # fmt: skip
"""What they add to the right-hand side of its linear system, over the step."""
FASTEST = 12.0
"""Logarithm of the speed over that of the load point from which a slider runs away."""
MOST = 200
"""Steps in a piece whose length a slider sets, or nearly, after which it is given up: one that
settles takes 60."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sliders:
    """Laws of evolution with as many states each, and stiffnesses: arrays (k,), SI."""

    direct: Array
    """Direct effects a, above 0."""
    effects: Sequence[Array]
    """Evolution effects by state."""
    distances: Sequence[Array]
    """Critical distances by state [m]."""
    stress: Array
    """Effects of stress c."""
    stiffness: Array
    """Stiffnesses over the load [1/m]."""
    evolution: Mapping[str, slice]
    """Which of them follow which law of evolution."""


def coefficients_of(
    sliders: Sliders,
    knots: Array,
    speeds: Array,
    times: Array,
    *,
    reference: float,
    tolerance: float,
) -> Array:
    """Return coefficients of friction less the reference one (n, k); NaN of what is given up.

    Sliders slide steadily at first. The load point moves at speeds (m,) [m/s], the first above 0,
    between knots (m + 1,) [s]; coefficients are asked for at rising times (n,) [s], less the one at
    the reference speed [m/s]. A step errs by the tolerance at most.
    """
    run = _Run(sliders, reference, tolerance)
    result = np.empty((len(times), len(sliders.direct)))
    first = np.full(len(sliders.direct), np.log(speeds[0] / reference))
    y = np.array([first, *(-first for _ in sliders.effects)])
    before = times <= knots[0]
    result[before] = run.coefficient(y)
    moving = False
    for start, end, speed in zip(knots[:-1], knots[1:], speeds, strict=True):
        here = (times > start) & (times <= end)
        if not moving and speed == speeds[0]:  # steady sliding goes on
            result[here] = run.coefficient(y)
            continue
        moving = True
        y, result[here] = run.piece(y, float(end - start), float(speed), times[here] - start)
    result[:, run.ended] = np.nan
    return result


class _Run:
    """The state of a run of several sliders."""

    def __init__(self, sliders: Sliders, reference: float, tolerance: float) -> None:
        self.sliders, self.reference, self.tolerance = sliders, reference, tolerance
        evolved = np.sum(sliders.effects, axis=0)
        self._effects = np.array([sliders.direct, *sliders.effects])
        self._distances = np.array(sliders.distances)
        stressed = sliders.stress != 0.0
        self._share = np.where(stressed, sliders.stress / np.where(stressed, evolved, 1.0), 0.0)
        self._stressed = bool(stressed.any())
        self.ended = np.zeros(len(evolved), dtype=bool)

    def coefficient(self, y: Array) -> Array:
        """Return the coefficient less the reference one (k,)."""
        return np.asarray(np.sum(self._effects * y, axis=0))

    def _renewals(self, y: Array, V: Array) -> tuple[Array, Array, Array]:
        """Return rates of states times their distance, and derivatives by w and s (s, k)."""
        rate, by_w, by_s = np.empty_like(y[1:]), np.empty_like(y[1:]), np.empty_like(y[1:])
        for evolution, at in self.sliders.evolution.items():
            v, s = V[at], y[1:, at]
            if evolution == "slip":
                x = y[0, at] + s
                rate[:, at], by_w[:, at], by_s[:, at] = -v * x, -v * (x + 1.0), -v
            elif evolution == "prz":
                age, worn = self.reference * np.exp(-s), v * np.exp(y[0, at] + s)
                rate[:, at], by_w[:, at], by_s[:, at] = (
                    0.5 * (age - worn), -worn, -0.5 * (age + worn)
                )  # fmt: skip
            else:
                age = self.reference * np.exp(-s)
                rate[:, at], by_w[:, at], by_s[:, at] = age - v, -v, -age
        return rate, by_w, by_s

    def _rates(self, y: Array, speed: float) -> Array:
        """Return the derivatives of w and of each state by time (1 + s, k)."""
        V = self.reference * np.exp(y[0])
        pulled, result = self.sliders.stiffness * (speed - V), np.empty_like(y)
        result[1:] = self._renewals(y, V)[0] / self._distances
        if self._stressed:
            result[1:] -= self._share * pulled
        result[0] = (pulled - np.sum(self._effects[1:] * result[1:], axis=0)) / self._effects[0]
        return result

    def _solver(self, y: Array, h: float) -> Callable[[Array], Array]:
        """Return what solves (1 / (h gamma) - J) x = r at a state."""
        direct, effects, e = self._effects[0], self._effects[1:], 1.0 / (h * GAMMA)
        V = self.reference * np.exp(y[0])
        by_speed = -self.sliders.stiffness * V
        _, by_w, by_s = self._renewals(y, V)
        q, g = by_w / self._distances - self._share * by_speed, -by_s / self._distances
        inverse, back = 1.0 / (e + g), effects * g / direct
        carried = back * inverse
        lead = e - (by_speed - np.sum(effects * q, axis=0)) / direct - np.sum(carried * q, axis=0)

        def solved(right: Array) -> Array:
            result = np.empty_like(right)
            result[0] = (right[0] + np.sum(carried * right[1:], axis=0)) / lead
            result[1:] = (right[1:] + q * result[0]) * inverse
            return result

        return solved

    def _step(self, y: Array, h: float, speed: float) -> tuple[Array, Array]:
        """Return the states after a step, and its error over the tolerance (k,)."""
        solved, count = self._solver(y, h), len(COUPLINGS)
        stages = np.empty((count, y.size))
        at = y
        for number, couplings in enumerate(COUPLINGS):
            if number == count - 1:
                at = at + stages[number - 1].reshape(y.shape)
            elif number:
                at = y + (STAGES[number] @ stages[:number]).reshape(y.shape)
            right = self._rates(at, speed)
            if number:
                right += (couplings @ stages[:number]).reshape(y.shape) / h
            stages[number] = solved(right).ravel()
        last = stages[-1].reshape(y.shape)
        return at + last, np.max(np.abs(self._effects * last), axis=0) / self.tolerance

    def piece(self, y: Array, length: float, speed: float, times: Array) -> tuple[Array, Array]:
        """Return the states at the end of a piece, and the coefficient at times in it (n, k)."""
        fastest = np.log(max(speed, self.reference) / self.reference) + FASTEST
        ends, values, slopes = [0.0], [self.coefficient(y)], [self._slope(y, speed)]
        t, h, slow = 0.0, 1e-4 * length, np.zeros(y.shape[1])
        with np.errstate(all="ignore"):
            while t < length * (1.0 - 1e-12):
                h = min(h, length - t)
                new, error = self._step(y, h, speed)
                error = np.where(np.isfinite(error) & (new[0] < fastest), error, np.inf)
                error[self.ended] = 0.0
                worst = float(error.max())
                slow += error >= 0.3 * min(max(worst, 1e-3), 1e9)
                if worst > 1.0 and slow.max() < MOST:
                    h *= max(0.2, 0.9 * worst**-0.25)
                    continue
                if slow.max() >= MOST:
                    self.ended |= (slow >= MOST) | (error > 1.0)
                    if self.ended.all():
                        break
                t += h
                y = np.where(self.ended, 0.0, new)
                error[self.ended], slow[self.ended] = 0.0, 0.0
                ends.append(t)
                values.append(self.coefficient(y))
                slopes.append(self._slope(y, speed))
                h *= min(5.0, 0.9 * max(float(error.max()), 1e-4) ** -0.25)
            # those that ended may have left any number
            rows = _between(np.array(ends), np.array(values), np.array(slopes), times)
        return y, rows

    def _slope(self, y: Array, speed: float) -> Array:
        return np.asarray(self.sliders.stiffness * (speed - self.reference * np.exp(y[0])))


def _between(ends: Array, values: Array, slopes: Array, times: Array) -> Array:
    """Return values (n, k) of cubics through values and slopes (m, k) at times."""
    at = np.clip(np.searchsorted(ends, times, side="right") - 1, 0, max(len(ends) - 2, 0))
    after = np.minimum(at + 1, len(ends) - 1)
    h = np.maximum(ends[after] - ends[at], 1e-300)[:, None]
    x = ((times - ends[at]) / h[:, 0])[:, None]
    rest = 1.0 - x
    return np.asarray(
        rest**2 * ((1.0 + 2.0 * x) * values[at] + x * h * slopes[at])
        + x**2 * ((1.0 + 2.0 * rest) * values[after] - rest * h * slopes[after])
    )
