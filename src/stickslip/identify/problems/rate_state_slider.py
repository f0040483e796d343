"""A spring slider without inertia with rate-and-state friction, as rock and gouge are tested."""

import math
import sys
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stickslip.errors import InputError, SimulationError
from stickslip.friction import RateState
from stickslip.quantities import Quantity
from stickslip.show.display import Tabular
from stickslip.show.formatting import number

if TYPE_CHECKING:
    import pandas as pd

Array: TypeAlias = NDArray[np.float64]
Rates: TypeAlias = Callable[[Array, float, float], tuple[float, ...]]
STEEPEST = 0.5 * math.log(sys.float_info.max)
"""Logarithms of speeds beyond this are held there: the run has failed long before."""
STEPS = 20_000
"""Steps between two asked times after which a run counts as failed."""

UNITS = {"time": "s", "coefficient": "1", "velocity": "m/s", "state": "s", "second_state": "s"}
"""Columns of a history, and their units; the last only where there is a second state."""
STIFFNESS = Quantity("k", "1/m", above=0)


@dataclass(frozen=True, kw_only=True, eq=False)
class SliderHistory(Tabular):
    """What a spring slider with rate-and-state friction does in time.

    Examples
    --------
    >>> from stickslip.friction import RateState
    >>> law = RateState(
    ...     reference_coefficient=0.6,
    ...     direct_effect=0.01,
    ...     evolution_effect=0.005,
    ...     critical_distance=1e-5,
    ...     reference_velocity=1e-6,
    ... )
    >>> simulate_velocity_steps(law, stiffness=1e3, time=[0.0, 10.0], pull=[0.0, 1e-5])
    <SliderHistory 2 times, coefficient 0.6 to 0.6>
    """

    time: Array
    """Times (n,) [s]."""
    coefficient: Array
    """Friction coefficient (n,), which is the force of the spring over the load."""
    velocity: Array
    """Slip speed (n,) [m/s]."""
    state: Array
    """State theta (n,) [s], the age of the contacts; NaN without evolution."""
    second_state: Array | None = None
    """State theta_2 (n,) [s]; None without one."""

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the columns as a pandas DataFrame with the time in front."""
        import pandas as pd

        return pd.DataFrame({name: getattr(self, name) for name in self._column_units()})

    def _over(self) -> str:
        return "time"

    def _column_units(self) -> Mapping[str, str]:
        return {name: unit for name, unit in UNITS.items() if getattr(self, name) is not None}

    def __repr__(self) -> str:
        low, high = self.coefficient.min(), self.coefficient.max()
        ends = f"{number(low, 4)} to {number(high, 4)}"
        return f"<SliderHistory {len(self.time)} times, coefficient {ends}>"


def simulate_velocity_steps(
    law: RateState,
    *,
    stiffness: float,
    time: ArrayLike,
    pull: ArrayLike,
    at: ArrayLike | None = None,
    tolerance: float = 1e-11,
) -> SliderHistory:
    """Pull a slider without inertia through a spring whose far end moves as given.

    The slider starts in steady sliding at the speed of the first piece of the pull. Each piece is
    integrated on its own by LSODA: in the logarithms of speed and state, or of the regularised form
    in the coefficient and the logarithm of the state, as only that form comes to rest and follows a
    pull backwards. Without evolution there is a closed form of the other. Friction that falls with
    speed and has no state takes the speed of the load point at once, as on an infinitely stiff
    spring: on any other it would run away.

    Parameters
    ----------
    law : RateState
        Friction of the slider.
    stiffness : float
        Stiffness of spring and machine over the load, d mu / d x [1/m].
    time : array (k,)
        Times [s] between which the far end moves steadily, increasing.
    pull : array (k,)
        Its positions [m] there, nowhere decreasing unless the law is regularised.
    at : array (n,), optional
        Times asked for, increasing, within `time`; `time` itself if not given.
    tolerance : float
        Relative and absolute tolerance of the logarithms.

    Returns
    -------
    SliderHistory
        Coefficient, slip speed and state at the times asked for.

    Raises
    ------
    InputError
        If the pull cannot be used.
    SimulationError
        If the slider runs away, as it does on a spring softer than the critical stiffness, or its
        speed changes too fast to be followed.

    Examples
    --------
    A tenfold step, long after which only a - b is left:

    >>> law = RateState(
    ...     reference_coefficient=0.6,
    ...     direct_effect=0.01,
    ...     evolution_effect=0.005,
    ...     critical_distance=1e-5,
    ...     reference_velocity=1e-6,
    ... )
    >>> run = simulate_velocity_steps(
    ...     law, stiffness=1e3, time=[0.0, 10.0, 60.0], pull=[0.0, 1e-5, 5.1e-4]
    ... )
    >>> run.coefficient.round(6), round(0.6 + 0.005 * np.log(10.0), 6)
    (array([0.6     , 0.6     , 0.611513]), np.float64(0.611513))
    """
    stiffness = STIFFNESS.check("simulate_velocity_steps", "stiffness", stiffness)
    knots, speeds = _speeds(time, pull, backwards=law.regularised)
    times = knots if at is None else np.atleast_1d(np.asarray(at, dtype=float))
    inside = np.all(np.diff(times) >= 0.0) and knots[0] <= times[0] and times[-1] <= knots[-1]
    if times.ndim != 1 or not inside:
        raise InputError(
            "simulate_velocity_steps: at [s] must increase and lie between"
            f" {knots[0]:g} and {knots[-1]:g} s, the first and last time of the pull."
        )
    logs = logarithms(law, stiffness, knots, speeds, times, tolerance)
    if logs is None:
        k, critical = number(stiffness), number(max(law.critical_stiffness, 0.0))
        if stiffness > law.critical_stiffness:
            raise SimulationError(
                "the speed of the slider changes too fast to be followed, with a direct effect (a)"
                f" of {number(law.direct_effect)} and a stiffness (k) of {k} 1/m. Give a larger a;"
                " or, where k is little above the critical stiffness and a large step makes the"
                f" slider run away, a larger k (it must be above {critical} 1/m)."
            )
        raise SimulationError(
            f"the slider runs away: its stiffness (k) is {k} 1/m, and steady sliding needs more"
            f" than the critical one, {critical} 1/m."
        )
    ages = [
        (2.0 if law.evolution == "prz" else 1.0) * D / law.reference_velocity * np.exp(s)
        for (_, D), s in zip(law.states, logs.T[1:], strict=False)
    ]
    return SliderHistory(
        time=times,
        coefficient=coefficients(law, logs),
        velocity=velocities(law, logs),
        state=ages[0] if ages else np.full(len(times), np.nan),
        second_state=ages[1] if len(ages) > 1 else None,
    )


def coefficients(law: RateState, logs: Array) -> Array:
    """Return coefficients of friction."""
    if law.regularised:
        return logs[:, 0].copy()
    effects = [law.direct_effect, *(b for b, _ in law.states)]
    return np.asarray(law.reference_coefficient + logs[:, : len(effects)] @ np.array(effects))


def velocities(law: RateState, logs: Array) -> Array:
    """Return slip speeds."""
    if not law.regularised:
        return np.asarray(law.reference_velocity * np.exp(logs[:, 0]))
    mu, level = logs[:, 0], law.reference_coefficient + logs[:, 1:] @ [b for b, _ in law.states]
    a = law.direct_effect
    speed = law.reference_velocity * np.exp((np.abs(mu) - level) / a)
    return np.asarray(-np.sign(mu) * speed * np.expm1(-2.0 * np.abs(mu) / a))


def _speeds(time: ArrayLike, pull: ArrayLike, *, backwards: bool) -> tuple[Array, Array]:
    """Return times (k,) and the speeds between them (k - 1,), checked."""
    t, x = (np.asarray(values, dtype=float) for values in (time, pull))
    if t.ndim != 1 or t.shape != x.shape or t.size < 2 or not np.all(np.isfinite([t, x])):
        raise InputError(
            "simulate_velocity_steps: time [s] and pull [m] must be equally long, finite and of at"
            f" least 2 values, got the shapes {t.shape} and {x.shape}."
        )
    if not np.all(np.diff(t) > 0.0):
        raise InputError("simulate_velocity_steps: time [s] must increase strictly.")
    speeds = np.diff(x) / np.diff(t)
    if backwards and speeds[0] == 0.0:
        raise InputError(
            "simulate_velocity_steps: the pull must move at first, as the slider starts in steady"
            " sliding, and rests for the first piece."
        )
    if not backwards and (speeds[0] <= 0.0 or np.any(speeds < 0.0)):
        raise InputError(
            "simulate_velocity_steps: the pull must move forwards at first and never back, got"
            f" speeds from {speeds.min():g} to {speeds.max():g} m/s. A law with regularised=True"
            " follows it backwards."
        )
    return t, speeds


def logarithms(
    law: RateState,
    stiffness: float,
    knots: Array,
    speeds: Array,
    times: Array,
    tolerance: float,
) -> Array | None:
    """Return w = ln(V/V_0) and s = ln(V_0 theta/D_c) of a slider that a spring pulls.

    Of the regularised form, the coefficient stands for w. What fails gives None.
    """
    if law.evolution == "none" and not law.regularised:
        return _without_state(law, stiffness, knots, speeds, times)[:, None]
    from scipy.integrate import ODEintWarning, odeint

    V_0, V = law.reference_velocity, float(speeds[0])
    first = float(np.log(abs(V) / V_0))
    lead = float(law.steady(V)) if law.regularised else first
    state: Array = np.array([lead, *(-first for _ in law.states)])
    logs = np.empty((len(times), len(state)))
    logs[times <= knots[0]] = state
    rates = rates_of(law, stiffness)
    moving = False
    for start, end, speed in zip(knots[:-1], knots[1:], speeds, strict=True):
        here = (times > start) & (times <= end)
        if not moving and speed == speeds[0]:  # steady sliding goes on, exactly
            logs[here] = state
            continue
        moving = True
        with warnings.catch_warnings():  # what it says is in `told`, too
            warnings.simplefilter("ignore", ODEintWarning)
            path, told = odeint(
                rates,
                state,
                np.concatenate([[start], times[here], [end]]),
                args=(float(speed),),
                rtol=tolerance,
                atol=tolerance,
                mxstep=STEPS,
                full_output=True,
            )
        failed = not told["message"].startswith("Integration successful")
        if failed or not np.all(np.abs(path) < STEEPEST):
            return None
        logs[here], state = path[1:-1], path[-1]
    return logs


def _without_state(
    law: RateState, stiffness: float, knots: Array, speeds: Array, times: Array
) -> Array:
    """Return w = ln(V/V_0) at times (n,): a dw/dt = k (V_load - V) has a closed form.

    1/V relaxes towards 1/V_load over the way a/k of the load point.
    """
    V = float(speeds[0])
    logs = np.full(len(times), np.log(V))
    for start, end, V_load in zip(knots[:-1], knots[1:], speeds, strict=True):
        here = (times > start) & (times <= end)
        t = np.append(times[here], end) - start
        if law.direct_effect > 0.0:
            rate = stiffness / law.direct_effect
            way = rate * V_load * t
            # (1 - e^-x) / x of a load point at rest is 1
            mean = -np.expm1(-way) / np.where(way > 0.0, way, 1.0) + (way == 0.0)
            path = np.log(V) - np.log(np.exp(-way) + V * rate * t * mean)
        else:
            path = np.full(len(t), np.log(V_load if V_load > 0.0 else V))
        logs[here], V = path[:-1], float(np.exp(path[-1]))
    return np.asarray(logs - np.log(law.reference_velocity))


def rates_of(law: RateState, stiffness: float) -> Rates:
    """Return the time derivatives of w and s as a function of state, time and pulling speed.

    Of the regularised form, that of the coefficient stands for that of w.
    """
    from math import copysign, exp, log, log1p  # found faster than by the module

    a, mu_0, V_0, k = (
        law.direct_effect,
        law.reference_coefficient,
        law.reference_velocity,
        stiffness,
    )
    effects, distances = [b for b, _ in law.states], [D for _, D in law.states]
    renewal = RENEWALS.get(law.evolution, _ageing)
    stress = law.stress_effect / law.evolved if law.stress_effect else 0.0

    def plain(y: Array, _: float, V_load: float) -> tuple[float, ...]:
        w, *ages = y.tolist()
        w = min(w, STEEPEST)
        V = V_0 * exp(w)
        pulled = k * (V_load - V)
        s_dots = [
            renewal(V_0, V, w, s) / D - stress * pulled
            for s, D in zip(ages, distances, strict=True)
        ]
        evolved = sum(b * s_dot for b, s_dot in zip(effects, s_dots, strict=True))
        return (pulled - evolved) / a, *s_dots

    def regularised(y: Array, _: float, V_load: float) -> tuple[float, ...]:
        mu, *ages = y.tolist()
        level = mu_0 + sum(b * s for b, s in zip(effects, ages, strict=True))
        rest = -2.0 * abs(mu) / a
        if rest == 0.0:
            w, V = -STEEPEST, 0.0
        else:  # of V / V_0 = 2 sinh(mu / a) exp(-level / a)
            short = log1p(-exp(rest)) if rest < -1e-8 else log(-rest)
            w = max(min((abs(mu) - level) / a + short, STEEPEST), -STEEPEST)
            V = V_0 * exp(w)
        pulled = k * (V_load - copysign(V, mu))
        loaded = stress * copysign(pulled, mu * pulled) if stress else 0.0
        s_dots = (renewal(V_0, V, w, s) / D - loaded for s, D in zip(ages, distances, strict=True))
        return pulled, *s_dots

    return regularised if law.regularised else plain


def _ageing(V_0: float, V: float, _: float, s: float) -> float:
    return V_0 * math.exp(min(-s, STEEPEST)) - V


def _slip(_: float, V: float, w: float, s: float) -> float:
    return -V * (w + s)


def _prz(V_0: float, V: float, w: float, s: float) -> float:
    return 0.5 * (V_0 * math.exp(min(-s, STEEPEST)) - V * math.exp(min(w + s, STEEPEST)))


RENEWALS: Final = {"ageing": _ageing, "slip": _slip, "prz": _prz, "nagata": _ageing}
"""The rate of the logarithm of a state times its critical distance, without effect of stress."""
