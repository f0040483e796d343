"""Other engines on a problem: one module each, `by_<engine>` in the folder of the problem."""

import importlib
import importlib.util
import time
from collections.abc import Callable
from dataclasses import dataclass

from benchmarks.measuring import Missing

BOTH, ONE = "mu_k, mu_s", "mu_k"
"""Which levels of friction an engine has."""
LIBRARIES = (
    ("heyoka", "heyoka", "heyoka", "`pip install heyoka`"),
    ("SciPy", "scipy", "scipy", "`pip install scipy`"),
    ("MuJoCo", "mujoco", "mujoco", "`pip install mujoco`"),
    ("Drake", "drake", "pydrake", "`pip install drake`"),
    ("Siconos", "siconos", "", "Debian's `python3-siconos`"),
)
"""Name, module of the runs, module to import, and where to get it. Siconos needs an interpreter of
its own, which its module looks for."""


WORKERS: list[int] = []
"""Processes that run engines with an interpreter of their own."""


def processor_time() -> float:
    """Return the processor time of this process and of the workers [s] (Linux)."""
    clocks = [(~pid << 3) | 2 for pid in WORKERS]  # as clock_getcpuclockid numbers them
    return time.process_time() + sum(map(time.clock_gettime, clocks))


class StallError(Exception):
    """An engine would not come to an end."""


@dataclass(frozen=True, kw_only=True)
class Engine:
    """One engine in one setting."""

    name: str
    levels: str = ONE
    build: Callable[..., Callable[[], object]]
    """Makes the model; what it returns is timed."""


def found(folder: str, *about: object) -> list[Engine | Missing]:
    """Return the settings of all libraries that have runs in a folder, or why there are none.

    Parameters
    ----------
    folder : str
        Folder of the problem, as `block`.
    *about : object
        What `engines` of each module is asked with.
    """
    entries: list[Engine | Missing] = []
    for label, runs, library, source in LIBRARIES:
        module = f"benchmarks.{folder}.by_{runs}"
        if importlib.util.find_spec(module) is None:
            continue
        if library and importlib.util.find_spec(library) is None:
            entries.append(Missing(solver=label, reason=source))
        else:
            entries += importlib.import_module(module).engines(*about)
    return entries
