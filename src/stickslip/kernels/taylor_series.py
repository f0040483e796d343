"""Exact propagation of linear modes: the Taylor series of the solution, which is entire.

With constant coefficients each term follows from the last, c[k + 1] = h / (k + 1) J c[k], and
twenty of them give a step of more than a radian of the fastest motion to the last digit. The
series stands in the dense output, so that guards become polynomials in the fraction of the step.

Harmonic forces of one angular frequency W enter with their terms and the rates of these: a power
(-1)^j (W h)^2j / (2 j)! of the former and (-1)^j (W h)^2j h / (2 j + 1)! of the latter in turn.
"""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.dense_output import interpolate
from stickslip.kernels.equations import WAVES_OF, evaluate
from stickslip.kernels.error_scale import TAIL, VANISHED, series_tail
from stickslip.kernels.model_interface import field, jacobian, time_slope
from stickslip.kernels.state_layout import (
    DENSE,
    DRIFT,
    FLAGS,
    MATRIX,
    MODE,
    N_STATES,
    N_WAVES,
    POINT,
    SERIES,
    WAVES,
    Y1,
)

RATIOS = (0.0, 0.0, *(1.0 / (k * (k - 1.0)) for k in range(2, SERIES + 1)))
"""1 / (k (k - 1)): the power k of a harmonic over that before the last, over the angle squared."""


def fill_waves(t: float, h: float, w: Vector, whole: Wholes, at: int) -> int:
    """Write the factors of all powers of the harmonics; return the last that counts, 0 if none."""
    first, rows = whole[WAVES], whole[N_WAVES]
    if rows == 0:
        return 0
    terms = first + SERIES + 1
    evaluate(WAVES_OF, whole[MODE], whole[FLAGS], t, w, at, terms)
    acts = False
    for i in range(2 * rows):
        acts = acts or w[terms + i] != 0.0
    square = h * h * w[terms + 2 * rows] if acts else 0.0
    w[first] = 1.0
    w[first + 1] = h
    last = SERIES + 1 if acts else 0
    for k in range(2, SERIES + 1):
        factor = -square * RATIOS[k] * w[first + k - 2]
        w[first + k] = factor
        if k % 2 == 0 and last > k and abs(factor) <= VANISHED:
            last = k
    return last


def wave_at(k: int, w: Vector, whole: Wholes) -> tuple[float, int]:
    """Return the factor of a power of the harmonics, and the place of what it multiplies."""
    first = whole[WAVES]
    return w[first + k], first + SERIES + 1 + whole[N_WAVES] * (k % 2)


def waves_tail(w: Vector, whole: Wholes) -> float:
    """Return the last term of the harmonics over what is allowed."""
    return abs(w[whole[WAVES] + SERIES]) / TAIL if whole[N_WAVES] > 0 else 0.0


def series_fill(t: float, h: float, w: Vector, whole: Wholes, at: int) -> None:
    """Fill the dense output with the series of a step from the state at `at`."""
    dense = whole[DENSE]
    drift = whole[DRIFT]
    matrix = whole[MATRIX]
    point = whole[POINT]
    n = whole[N_STATES]
    last = dense + 1
    field(t, w, whole, at, last + n)
    time_slope(t, w, whole, at, drift)
    jacobian(t, w, whole, at, matrix)
    for i in range(n):
        w[last + i] = w[at + i]
        w[last + n + i] *= h
        w[point + i] = max(abs(w[last + i]), abs(w[last + n + i]))  # largest term yet
    waving = fill_waves(t, h, w, whole, at)
    if n == 2 and waving == 0:
        series_of_two(h, w, whole)
        return
    # Two small terms in a row end the series: one alone may be zero by chance, as each second term
    # of an oscillation from rest is.
    small = 0
    terms = 1
    while terms < SERIES and small < 2:
        last += n
        terms += 1
        factor = h / terms
        ended = terms >= waving
        power, waves = 0.0, drift
        if waving > 0:
            power, waves = wave_at(terms - 1, w, whole)
        for i in range(n):
            # df/dt is constant but for harmonics: time enters the second derivative of the state
            total = h * w[drift + i] if terms == 2 else power * w[waves + i]
            for j in range(n):
                total += w[matrix + i * n + j] * w[last + j]
            total *= factor
            w[last + n + i] = total
            w[point + i] = max(w[point + i], abs(total))
            ended = ended and abs(total) <= VANISHED * w[point + i]
        small = small + 1 if ended else 0
    w[dense] = terms - small


def series_of_two(h: float, w: Vector, whole: Wholes) -> None:
    """Fill in the series of two states, of one coordinate, from the second term after the first on.

    Most linear modes have two. In variables of their own the terms wait for no memory, which takes
    half the time.
    """
    drift = whole[DRIFT]
    matrix = whole[MATRIX]
    last = whole[DENSE] + 1
    a = w[matrix]
    b = w[matrix + 1]
    c = w[matrix + 2]
    d = w[matrix + 3]
    x = w[last + 2]
    v = w[last + 3]
    largest_x = max(abs(w[last]), abs(x))
    largest_v = max(abs(w[last + 1]), abs(v))
    # time enters the second derivative and no other
    grown_x = h * w[drift]
    grown_v = h * w[drift + 1]
    small = 0
    terms = 1
    while terms < SERIES and small < 2:
        terms += 1
        factor = h / terms
        next_x = grown_x + a * x + b * v
        next_v = grown_v + c * x + d * v
        grown_x = 0.0
        grown_v = 0.0
        x = factor * next_x
        v = factor * next_v
        w[last + 2 * terms] = x
        w[last + 2 * terms + 1] = v
        largest_x = max(largest_x, abs(x))
        largest_v = max(largest_v, abs(v))
        ended = abs(x) <= VANISHED * largest_x and abs(v) <= VANISHED * largest_v
        small = small + 1 if ended else 0
    w[whole[DENSE]] = terms - small


def series_step(t: float, h: float, w: Vector, whole: Wholes, at: int) -> float:
    """Try a step; return the tail of its series over what is allowed, the solution in Y1."""
    series_fill(t, h, w, whole, at)
    interpolate(w, whole, 1.0, whole[Y1])
    return max(series_tail(h, w, whole), waves_tail(w, whole))
