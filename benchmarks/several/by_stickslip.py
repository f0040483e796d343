"""The mechanisms in stickslip: the compiled kernel alone."""

import functools

import numpy as np

from benchmarks.kernel import Kernel
from benchmarks.peers import BOTH, Engine
from benchmarks.several.problem import Case, Run

TOLERANCES = {"chain": (1e-12,), "arm": (1e-9, 1e-12), "clutches": (1e-9,)}
"""Those of the chain and of the clutches at constant load do not matter: their modes are exact."""


def kernel_of(case: Case, *, compiled: bool = True) -> Kernel:
    """Return the kernel of a case."""
    return Kernel(case.mechanism, case.laws, case.t_end, compiled=compiled, start=case.start)


def build(name: str, case: Case, tolerance: float) -> Run:
    kernel, n = kernel_of(case), len(case.mechanism.coordinates)

    def run() -> np.ndarray:
        places = np.array(kernel.run(tolerance).final()[:n])
        return np.cumsum(places) if name == "clutches" else places  # relative angles

    return run


def engines(name: str, case: Case) -> tuple[Engine, ...]:
    return tuple(
        Engine(
            name=f"stickslip, kernel alone, {tolerance:g}",
            levels=BOTH,
            build=functools.partial(build, name, case, tolerance),
        )
        for tolerance in TOLERANCES[name]
    )
