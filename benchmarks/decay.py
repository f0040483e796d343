"""A block on a spring swings four times and stops for good; every stop has a closed form."""

import functools
import math
import time
from collections.abc import Sequence

from scipy.integrate import solve_ivp

from benchmarks.kernel import Kernel
from benchmarks.measuring import (
    MANY,
    TIERS,
    Result,
    by_hand,
    faster,
    largest_error,
    own_entries,
    with_times,
    within,
)
from stickslip import Coulomb, SpringBlock
from stickslip.engine import Trajectory

M, K, X_0, MU, G = 1.0, 100.0, 0.08, 0.1, 9.81
F = MU * M * G
T_END = 3.0
ERROR = 1e-9
WORK = "spring-block decay, 4 swings, error 1e-9"
WHY = (
    "16 steps, of which 3 are rejected: values of the series, most of them for the certificate, are"
    " a fifth of the time, the series another, the roots of guards a quarter"
)

RIG = SpringBlock(mass=M, stiffness=K, compression=X_0, attached=True, gravity=G)
LAW = Coulomb(kinetic_coefficient=MU)


def exact() -> list[float]:
    """Return the times of the four stops, and where the block rests."""
    half, loss = math.pi * math.sqrt(M / K), 2 * F / K
    return [half, 2 * half, 3 * half, 4 * half, 4 * loss]


def of_stickslip(run: Trajectory) -> list[float]:
    return [*(event.t for event in run.events), float(run.at(T_END)["x"][0])]


def of_kernel(kernel: Kernel) -> list[float]:
    return [*kernel.changes(), kernel.final()[0]]


def by_scipy(
    method: str, tolerance: float, K: float = K, X_0: float = X_0, F: float = F
) -> list[float]:
    """Swing by swing: the sign of friction is fixed, the event is the next stop."""

    def stop(t, y, side):
        return y[1]

    def swing(t, y, side):
        return [y[1], (K * (X_0 - y[0]) - side * F) / M]

    def jacobian(t, y, side):
        return [[0.0, 1.0], [-K / M, 0.0]]

    stop.terminal = True
    t, x, stops = 0.0, 0.0, []
    options = {} if method == "DOP853" else {"jac": jacobian}
    while abs(K * (X_0 - x)) > F:
        side = math.copysign(1.0, X_0 - x)
        stop.direction = -side
        run = solve_ivp(
            swing, (t, T_END), [x, 0.0], method=method, rtol=tolerance, atol=tolerance * X_0,
            events=stop, args=(side,), **options,
        )  # fmt: skip
        t, x = float(run.t_events[0][0]), float(run.y_events[0][0][0])
        stops.append(t)
    return [*stops, x]


@functools.cache
def swings(tolerance: float) -> dict[float, object]:
    """Return heyoka's integrators of a swing forward and back, compiled once."""
    import heyoka as hy

    x, v = hy.make_vars("x", "v")
    ends = {1.0: hy.event_direction.negative, -1.0: hy.event_direction.positive}
    return {
        side: hy.taylor_adaptive(
            [(x, v), (v, (K * (X_0 - x) - side * F) / M)], [0.0, 0.0], tol=tolerance,
            t_events=[hy.t_event(v, direction=ends[side])],
        )
        for side in ends
    }  # fmt: skip


def by_heyoka(tolerance: float) -> list[float]:
    """Swing by swing, as above."""
    modes = swings(tolerance)
    t, x, stops = 0.0, 0.0, []
    while abs(K * (X_0 - x)) > F:
        swing = modes[math.copysign(1.0, X_0 - x)]
        swing.time, swing.state[:] = t, (x, 0.0)
        swing.reset_cooldowns()
        swing.propagate_until(T_END)
        t, x = swing.time, float(swing.state[0])
        stops.append(t)
    return [*stops, x]


def run(repeats: int = MANY, tiers: Sequence[str] = tuple(TIERS)) -> Result:
    """Run the case."""
    known = exact()

    def error_of(found):
        return largest_error(found, known)

    entries = with_times(
        (
            *own_entries(
                RIG, LAW, T_END, lambda run: error_of(of_stickslip(run)),
                lambda kernel: error_of(of_kernel(kernel)), ERROR, tiers,
            ),
            *by_hand(by_heyoka, by_scipy, error_of, ERROR),
        ),
        repeats,
        time.process_time,
    )  # fmt: skip
    return Result(
        title="Block on a spring, four swings",
        what="times of the four stops and the final place, against the closed form",
        error=ERROR,
        entries=entries,
        targets=(
            *within(WORK, 12.0, entries, "us", WHY),
            *faster(WORK, 200.0, entries, "SciPy DOP853", WHY),
        ),
    )
