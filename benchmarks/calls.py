"""What a short `simulate(...)` takes beside its kernel: the first calls of a process, later ones.

Processor times of a block on a spring, in a process that finds machine code which an earlier one
has left. Of calls that are repeated the least mean of many batches counts, which other work on the
machine lengthens least.
"""

import json
import statistics
import time
from collections.abc import Callable, Mapping

from benchmarks import decay
from benchmarks.compiling import told_by_child
from benchmarks.kernel import Kernel
from benchmarks.measuring import Section, Target
from stickslip import Coulomb, EventDriven, simulate
from stickslip.engine.solver import prepare

FIRST = 10
"""Calls of the process that are timed one by one."""
BATCH, BATCHES = 20, 300
WORK = "spring-block, simulate(...)"
TARGETS = {"later calls, the same objects": 60.0, f"calls 2 to {FIRST}, median": 200.0}
"""Longest that a call should take [us]."""
IMPORTED = (
    "import time; begun = time.process_time(); import stickslip;"
    " imported = time.process_time() - begun; from benchmarks.calls import child; child(imported)"
)


def call() -> object:
    """Simulate as users do, without any setting."""
    return simulate(decay.RIG, decay.LAW, t_end=decay.T_END)


def least(run: Callable[[], object], batches: int = BATCHES) -> float:
    """Return the least mean processor time of a call [s]."""
    times = []
    for _ in range(batches):
        begun = time.process_time()
        for _ in range(BATCH):
            run()
        times.append((time.process_time() - begun) / BATCH)
    return min(times)


def child(imported: float) -> None:
    """Print the times [s] of this process, whose first calls these are."""
    first = []
    for _ in range(FIRST):
        begun = time.process_time()
        call()
        first.append(time.process_time() - begun)
    kernel, plain = Kernel(decay.RIG, decay.LAW, decay.T_END), EventDriven(tier="python")
    times = {
        "import stickslip": imported,
        "first call: equations are traced, machine code is loaded": first[0],
        f"calls 2 to {FIRST}, median": statistics.median(first[1:]),
        "later calls, the same objects": least(call),
        "later calls, a new law each": least(
            lambda: simulate(decay.RIG, Coulomb(kinetic_coefficient=decay.MU), t_end=decay.T_END)
        ),
        "the kernel alone": least(lambda: kernel.run(1e-12)),
        "later calls in plain Python": least(
            lambda: simulate(decay.RIG, decay.LAW, t_end=decay.T_END, solver=plain), BATCHES // 20
        ),
    }
    print(json.dumps(times))


def in_child() -> Mapping[str, float]:
    """Return what a process prints that finds machine code."""
    prepare(decay.RIG, decay.LAW)
    return told_by_child(IMPORTED)


def run(timed: Callable[[], Mapping[str, float]] = in_child) -> Section:
    """Run the case."""
    times = timed()
    targets = tuple(
        Target(
            work=f"{WORK}, {name}",
            goal=f"<= {goal:g} us",
            measured=f"{1e6 * times[name]:.3g} us",
            met=1e6 * times[name] <= goal,
            reason="certificate, events and the objects of a run take two thirds of it",
        )
        for name, goal in TARGETS.items()
    )
    return Section(
        title="A short call of simulate(...)",
        heads=("what", "processor time, us"),
        rows=tuple((name, f"{1e6 * seconds:.3g}") for name, seconds in times.items()),
        notes=("- Machine code was on disk; it is loaded within the first call.",),
        targets=targets,
    )
