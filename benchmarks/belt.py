"""A block drawn through a spring sticks and slips for 100 s; the period has a closed form."""

import math

from scipy.integrate import solve_ivp

from benchmarks.measuring import REPEATS, Result, at_error, largest_error
from stickslip import Coulomb, EventDriven, TowedBlock, simulate

M, K, SPEED, F_K, F_S = 1.0, 2.0, 0.1, 1.0, 1.5
T_END = 100.0
ERROR = 1e-9

BLOCK = TowedBlock(mass=M, stiffness=K, speed=SPEED, load=1.0)
LAW = Coulomb(kinetic_coefficient=F_K, static_coefficient=F_S)


def exact() -> list[float]:
    """Return the times of all changes between stick and slip."""
    w, D = math.sqrt(K / M), (F_S - F_K) / K
    slip, stick = 2 / w * (math.pi - math.atan(w * D / SPEED)), 2 * D / SPEED
    t, times = F_S / (K * SPEED), []
    while t < T_END:
        times += [t, t + slip]
        t += slip + stick
    return [t for t in times if t < T_END]


def by_stickslip(tolerance: float) -> object:
    return simulate(BLOCK, LAW, t_end=T_END, solver=EventDriven(tolerance=tolerance, tier="python"))


def by_scipy(tolerance: float) -> list[float]:
    """Slip by slip; the time at rest follows from the spring and needs no integration."""

    def stop(t, y):
        return y[1]

    def slipping(t, y):
        return [y[1], (K * (SPEED * t - y[0]) - F_K) / M]

    stop.terminal, stop.direction = True, -1
    x, times = 0.0, []
    while (t := x / SPEED + F_S / (K * SPEED)) < T_END:
        times.append(t)
        run = solve_ivp(
            slipping, (t, T_END), [x, 0.0], method="DOP853", rtol=tolerance, atol=tolerance,
            events=stop,
        )  # fmt: skip
        if run.status == 0:
            break
        times.append(float(run.t_events[0][0]))
        x = float(run.y_events[0][0][0])
    return times


def run(repeats: int = REPEATS) -> Result:
    """Run the case."""
    known = exact()
    return Result(
        title="Block on a belt, stick-slip for 100 s",
        what=f"times of all {len(known)} changes, against the closed form",
        error=ERROR,
        entries=(
            at_error(
                "stickslip, plain Python", by_stickslip,
                lambda found: largest_error([event.t for event in found.events], known),
                ERROR, repeats,
            ),
            at_error(
                "SciPy DOP853, events by hand", by_scipy,
                lambda found: largest_error(found, known), ERROR, repeats,
            ),
        ),
    )  # fmt: skip
