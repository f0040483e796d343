"""Processor time and peak memory of selections of several sizes, each in a process of its own.

``python -m benchmarks.posterior.costs table`` prints those of one as JSON: seconds of a selection
after a small one, which loads what every selection needs, and the peak of the whole process.
"""

import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks import real_records
from benchmarks.posterior.study import AXIS, swing
from stickslip import Axis, Measurement, select
from stickslip.data import catalogue

SEED = 77


@dataclass(frozen=True, kw_only=True)
class Cost:
    """What a selection takes."""

    seconds: float
    """Processor time [s]."""
    peak: float
    """Peak memory of the process [GB]."""


def _select(case: real_records.Case) -> Callable[[], Any]:
    vary = ["friction.*", *case.unknown] if case.unknown else None
    return lambda: select(case.mechanism, None, case.first, vary=vary, settings=case.settings)


def table(rows: int = 40) -> Callable[[], Any]:
    """A table of 40 readings."""
    random, v = np.random.default_rng(SEED), np.geomspace(0.01, 1.0, rows)
    curve = 5.0 + 3.0 * np.exp(-((v / 0.1) ** 2)) + 4.0 * v
    given = Measurement(velocity=v, friction=curve + 0.05 * random.normal(size=rows))
    return lambda: select(AXIS, None, given)


def loads(rows: int = 20_000) -> Callable[[], Any]:
    """A table of 20,000 rows with measured loads."""
    random = np.random.default_rng(SEED)
    v, load = random.uniform(0.02, 1.0, rows), random.choice([10.0, 20.0, 40.0], rows)
    load = load * (1.0 + 0.002 * random.normal(size=rows))
    friction = load * (0.2 + 0.1 * v) * (1.0 + 0.02 * random.normal(size=rows))
    given = Measurement(velocity=v, friction=friction, load=load)
    return lambda: select(AXIS, None, given)


def emps() -> Callable[[], Any]:
    """EMPS, all 24,841 rows."""
    first = next(real_records.emps())
    record = catalogue.dataset("emps").measurement("train")
    return _select(replace(first, first=record))


def long(rows: int = 80_000) -> Callable[[], Any]:
    """A record of 80,000 rows."""
    random, t = np.random.default_rng(SEED), np.arange(rows) * 5e-4
    x, v, a = np.zeros((3, rows))
    for f in (0.23, 0.61, 1.13):
        w = 2.0 * np.pi * f
        x += 0.2 * np.sin(w * t + f)
        v += 0.2 * w * np.cos(w * t + f)
        a -= 0.2 * w * w * np.sin(w * t + f)
    force = 20.0 * a + 15.0 * np.sign(v) + 30.0 * v + 0.3 * random.normal(size=rows)
    given = Measurement(time=t, position=x + 1e-6 * random.normal(size=rows), force=force)
    return lambda: select(
        Axis(inertia=30.0), None, given, vary=["friction.*", "mechanism.inertia"], route="balance"
    )


def free_swing() -> Callable[[], Any]:
    """A swing of 60 s at 50 Hz."""
    own = swing(4, SEED)  # level + viscous
    return lambda: select(own.told, None, own.record(), route="balance")


def six_joints() -> Callable[[], Any]:
    """A robot with six joints."""
    return _select([*real_records.staubli()][-1])


def servo() -> Callable[[], Any]:
    """Three records of a servo with four unknown constants."""
    return _select(next(real_records.servo()))


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A selection, and the most that it may take [s]."""

    made: Callable[[], Callable[[], Any]]
    most: float


KINDS: Mapping[str, Kind] = {
    "table": Kind(made=table, most=0.6),
    "loads": Kind(made=loads, most=5.0),
    "emps": Kind(made=emps, most=6.0),
    "long": Kind(made=long, most=12.0),
    "swing": Kind(made=free_swing, most=5.0),
    "joints": Kind(made=six_joints, most=30.0),
    "servo": Kind(made=servo, most=20.0),
}
PEAK = 1.0
"""Most memory [GB]."""


def measured(name: str) -> Cost:
    """Return what a selection takes, in this process."""
    table(10)()
    chosen = KINDS[name].made()
    began = time.process_time()
    chosen()
    seconds = time.process_time() - began
    return Cost(
        seconds=seconds, peak=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9
    )


def alone(name: str) -> Cost:
    """Return the same of a process of its own."""
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.posterior.costs", name],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return Cost(**json.loads(done.stdout.splitlines()[-1]))


def main(arguments: Sequence[str] | None = None) -> None:
    """Print what a selection takes."""
    (name,) = sys.argv[1:] if arguments is None else arguments
    print(json.dumps(vars(measured(name))))


if __name__ == "__main__":
    main()
