"""Coupled blocks that come to rest: a contact each, 2 to 100 of them, and SciPy by hand."""

import itertools
import math
import time

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.kernel import Kernel
from benchmarks.measuring import REPEATS, Section, Target
from benchmarks.tables import milliseconds
from stickslip.friction import Coulomb, Laws
from stickslip.mechanisms import Contact, MatrixMechanism

COUPLING, GROUND, T_END = 100.0, 10.0, 10.0
"""Springs between neighbours and to the ground [N/m]; time of the run [s]."""
GOALS = {2: 0.15, 10: 1.2, 30: 6.0, 100: 45.0}
"""Time of the kernel that a chain of so many blocks was meant to take [ms]."""
OFF = 1e-11
"""Velocity that SciPy's blocks begin to slip with, or the event would be found again [m/s]."""
LONGEST = 30
"""Blocks of the longest chain that SciPy runs."""
HEADS = ("blocks", "events", "kernel, ms", "us an event", "SciPy by hand, ms", "ratio", "places")
WHY = "decisions evaluate all contacts three to five times an event"


def levels(n: int) -> np.ndarray:
    """Return the levels of friction [N]."""
    return np.array([1.0 + 0.2 * round((0.6180339887498949 * i) % 1, 4) for i in range(1, n + 1)])


def rates(n: int) -> np.ndarray:
    """Return the velocities at time 0 [m/s]."""
    return np.array([round(3 * math.sin(1.7 * i), 4) for i in range(1, n + 1)])


def stiffness(n: int) -> np.ndarray:
    """Return the stiffness matrix of the chain [N/m]."""
    matrix = np.diag(np.full(n, GROUND))
    for i in range(n - 1):
        matrix[i : i + 2, i : i + 2] += COUPLING * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return matrix


class Chain(MatrixMechanism):
    """Blocks of 1 kg on the ground, each rubbing with a load of 1 N."""

    name = "chain"

    def mass_matrix(self, q):
        return np.eye(len(self.coordinates)).tolist()

    def forces(self, t, q, q_dot, drives):
        x, found = [q[name] for name in self.coordinates], {}
        for i, name in enumerate(self.coordinates):
            total = -GROUND * x[i]
            for j in (i - 1, i + 1):
                if 0 <= j < len(x):
                    total = total + COUPLING * (x[j] - x[i])
            found[name] = total
        return found

    def potential_energy(self, t, q):
        x = [q[name] for name in self.coordinates]
        total = sum((0.5 * GROUND * a * a for a in x), 0.0)
        for a, b in itertools.pairwise(x):
            total = total + 0.5 * COUPLING * (b - a) * (b - a)
        return total

    def contacts(self):
        return tuple(Contact(slip=name, load=1.0, name=name) for name in self.coordinates)

    def drives(self):
        return {}


def chain(n: int) -> Chain:
    """Return a chain of n blocks."""
    names = {
        "coordinates": tuple(f"x{i}" for i in range(1, n + 1)),
        "rates": tuple(f"v{i}" for i in range(1, n + 1)),
        "units": ("m",) * n,
    }
    return type(f"Chain{n}", (Chain,), names)()


def by_stickslip(n: int) -> tuple[float, int, np.ndarray]:
    """Return the time of the kernel [ms], the number of events and the last places."""
    blocks = chain(n)
    pairs = zip(blocks.coordinates, levels(n).tolist(), strict=True)
    laws = Laws(members=tuple((name, Coulomb(kinetic_coefficient=mu)) for name, mu in pairs))
    kernel = Kernel(
        blocks, laws, T_END, start=dict(zip(blocks.rates, rates(n).tolist(), strict=True))
    )
    kernel.run(1e-12)
    best = math.inf
    for _ in range(REPEATS):
        start = time.perf_counter()
        kernel.run(1e-12)
        best = min(best, time.perf_counter() - start)
    return 1e3 * best, len(kernel.changes()), np.array(kernel.final()[:n])


def by_scipy(n: int, tolerance: float = 1e-12) -> tuple[float, np.ndarray]:
    """Return the time [ms] and the last places; modes and events are coded by hand."""
    matrix, level = stiffness(n), levels(n)
    start = time.perf_counter()
    t, y = 0.0, np.concatenate([np.zeros(n), rates(n)])
    side = np.sign(y[n:])
    while t < T_END:
        moving = side != 0.0

        def slope(t, y, moving=moving, side=side):
            pull = -matrix @ y[:n] - side * level
            return np.concatenate([np.where(moving, y[n:], 0.0), np.where(moving, pull, 0.0)])

        def least(t, y, moving=moving, side=side):
            spare = level - np.abs(matrix @ y[:n])
            return float(np.min(np.where(moving, side * y[n:], spare)))

        least.terminal, least.direction = True, -1
        run = solve_ivp(
            slope, (t, T_END), y, method="DOP853", rtol=tolerance, atol=tolerance, events=least
        )
        t, y = float(run.t[-1]), run.y[:, -1].copy()
        if run.status != 1:
            break
        spare = level - np.abs(matrix @ y[:n])
        i = int(np.argmin(np.where(moving, side * y[n:], spare)))
        y[n + i] = 0.0
        pull = float((-matrix @ y[:n])[i])
        stops = bool(moving[i]) and abs(pull) < level[i]
        side = side.copy()
        side[i] = 0.0 if stops else math.copysign(1.0, pull)
        if not stops:
            y[n + i] = side[i] * OFF
    return 1e3 * (time.perf_counter() - start), y[:n]


def run() -> Section:
    """Run the case."""
    rows, targets = [], []
    for n, goal in GOALS.items():
        own, events, places = by_stickslip(n)
        hand, ratio, error = "", "", ""
        if n <= LONGEST:
            spent, other = by_scipy(n)
            hand, ratio = milliseconds(spent / 1e3), f"{spent / own:.0f}"
            error = f"differ by {np.abs(places - other).max():.1e} m"
        rows.append(
            (str(n), str(events), f"{own:.3g}", f"{1e3 * own / events:.1f}", hand, ratio, error)
        )
        targets.append(
            Target(
                work=f"{n} coupled blocks, kernel", goal=f"{goal:g} ms", measured=f"{own:.3g} ms",
                met=own <= goal, reason="" if own <= goal else WHY,
            )
        )  # fmt: skip
    return Section(
        title="Several contacts",
        heads=HEADS,
        rows=tuple(rows),
        notes=(
            "- Blocks of 1 kg, 100 N/m between neighbours and 10 N/m to the ground, until rest.",
            "- SciPy: `solve_ivp` with DOP853 at 1e-12, one terminal event, vectorised.",
        ),
        targets=tuple(targets),
    )
