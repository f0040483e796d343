"""A block drawn through a spring sticks and slips for 100 s; the period has a closed form."""

import functools
import math
import time
from collections.abc import Sequence

from scipy.integrate import solve_ivp

from benchmarks.measuring import (
    MANY,
    TIERS,
    Result,
    by_hand,
    faster,
    largest_error,
    own_entries,
    with_times,
)
from stickslip import Coulomb, TowedBlock

M, K, SPEED, F_K, F_S = 1.0, 225.0, 0.0093, 1.0, 1.5
T_END = 100.0
ERROR = 1e-9
WORK = "belt, 100 s, 275 events, error 1e-9"
WHY = "six steps a cycle, each with the roots of its guards"

BLOCK = TowedBlock(mass=M, stiffness=K, speed=SPEED, load=1.0)
LAW = Coulomb(kinetic_coefficient=F_K, static_coefficient=F_S)


def exact() -> list[float]:
    """Return the times of all changes between stick and slip."""
    w, D = math.sqrt(K / M), (F_S - F_K) / K
    slip, stick = 2 / w * (math.pi - math.atan(w * D / SPEED)), 2 * D / SPEED
    first, times = F_S / (K * SPEED), []
    for cycle in range(math.ceil(T_END / (slip + stick))):
        t = first + cycle * (slip + stick)
        times += [t, t + slip]
    return [t for t in times if t < T_END]


def by_scipy(method: str, tolerance: float) -> list[float]:
    """Slip by slip; the time at rest follows from the spring and needs no integration."""

    def stop(t, y):
        return y[1]

    def slipping(t, y):
        return [y[1], (K * (SPEED * t - y[0]) - F_K) / M]

    def jacobian(t, y):
        return [[0.0, 1.0], [-K / M, 0.0]]

    stop.terminal, stop.direction = True, -1
    options = {} if method == "DOP853" else {"jac": jacobian}
    x, times = 0.0, []
    while (t := x / SPEED + F_S / (K * SPEED)) < T_END:
        times.append(t)
        run = solve_ivp(
            slipping, (t, T_END), [x, 0.0], method=method, rtol=tolerance, atol=tolerance * SPEED,
            events=stop, **options,
        )  # fmt: skip
        if run.status == 0:
            break
        times.append(float(run.t_events[0][0]))
        x = float(run.y_events[0][0][0])
    return times


@functools.cache
def slipping(tolerance: float) -> object:
    """Return heyoka's integrator of a slip, compiled once."""
    import heyoka as hy

    x, v = hy.make_vars("x", "v")
    return hy.taylor_adaptive(
        [(x, v), (v, (K * (SPEED * hy.time - x) - F_K) / M)], [0.0, 0.0], tol=tolerance,
        t_events=[hy.t_event(v, direction=hy.event_direction.negative)],
    )  # fmt: skip


def by_heyoka(tolerance: float) -> list[float]:
    """Slip by slip, as above."""
    import heyoka as hy

    slip = slipping(tolerance)
    x, times = 0.0, []
    while (t := x / SPEED + F_S / (K * SPEED)) < T_END:
        times.append(t)
        slip.time, slip.state[:] = t, (x, 0.0)
        slip.reset_cooldowns()
        if slip.propagate_until(T_END)[0] == hy.taylor_outcome.time_limit:
            break
        times.append(slip.time)
        x = float(slip.state[0])
    return times


def run(repeats: int = MANY, tiers: Sequence[str] = tuple(TIERS)) -> Result:
    """Run the case."""
    known = exact()

    def error_of(found):
        return largest_error(found, known)

    entries = with_times(
        (
            *own_entries(
                BLOCK, LAW, T_END, lambda run: error_of([event.t for event in run.events]),
                lambda kernel: error_of(kernel.changes()), ERROR, tiers,
            ),
            *by_hand(by_heyoka, by_scipy, error_of, ERROR),
        ),
        repeats,
        time.process_time,
    )  # fmt: skip
    return Result(
        title="Block on a belt, stick-slip for 100 s",
        what=f"times of all {len(known)} changes, against the closed form",
        error=ERROR,
        entries=entries,
        targets=faster(WORK, 130.0, entries, "SciPy DOP853", WHY),
    )
