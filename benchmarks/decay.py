"""A block on a spring swings four times and stops for good; every stop has a closed form."""

import math

from scipy.integrate import solve_ivp

from benchmarks.measuring import REPEATS, Result, at_error, largest_error
from stickslip import Coulomb, EventDriven, SpringBlock, simulate

M, K, X_0, MU, G = 1.0, 100.0, 0.08, 0.1, 9.81
T_END = 3.0
ERROR = 1e-9

RIG = SpringBlock(mass=M, stiffness=K, compression=X_0, attached=True, gravity=G)
LAW = Coulomb(kinetic_coefficient=MU)


def exact() -> list[float]:
    """Return the times of the four stops, and where the block rests."""
    half, loss = math.pi * math.sqrt(M / K), 2 * MU * M * G / K
    return [half, 2 * half, 3 * half, 4 * half, 4 * loss]


def by_stickslip(tolerance: float) -> object:
    return simulate(RIG, LAW, t_end=T_END, solver=EventDriven(tolerance=tolerance, tier="python"))


def of_stickslip(run) -> list[float]:
    return [*(event.t for event in run.events), float(run.at(T_END)["x"][0])]


def by_scipy(tolerance: float) -> list[float]:
    """Swing by swing: the sign of friction is fixed, the event is the next stop."""

    def stop(t, y, side):
        return y[1]

    stop.terminal = True
    t, x, stops = 0.0, 0.0, []
    while abs(K * (X_0 - x)) > MU * M * G:
        side = math.copysign(1.0, X_0 - x)
        stop.direction = -side

        def swing(t, y, side):
            return [y[1], (K * (X_0 - y[0]) - side * MU * M * G) / M]

        run = solve_ivp(
            swing, (t, T_END), [x, 0.0], method="DOP853", rtol=tolerance, atol=tolerance * X_0,
            events=stop, args=(side,),
        )  # fmt: skip
        t, x = float(run.t_events[0][0]), float(run.y_events[0][0][0])
        stops.append(t)
    return [*stops, x]


def run(repeats: int = REPEATS) -> Result:
    """Run the case."""
    known = exact()
    return Result(
        title="Block on a spring, four swings",
        what="times of the four stops and the final place, against the closed form",
        error=ERROR,
        entries=(
            at_error(
                "stickslip, plain Python", by_stickslip,
                lambda found: largest_error(of_stickslip(found), known), ERROR, repeats,
            ),
            at_error(
                "SciPy DOP853, events by hand", by_scipy,
                lambda found: largest_error(found, known), ERROR, repeats,
            ),
        ),
    )  # fmt: skip
