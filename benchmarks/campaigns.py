"""Campaigns: time, memory and files, and how the time falls with workers.

``python -m benchmarks.campaigns --runs 10000000`` prints the large case, and
``--scaling`` the same campaign on several executors. With 64 workers on few cores nothing is
faster; the row says what so many cost, and the last line what the writer leaves of 64 cores.
"""

import argparse
import os
import resource
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from multiprocessing import get_context
from pathlib import Path

from stickslip import Coulomb, SpringBlock
from stickslip.engine import EventTimes, Final, Max
from stickslip.study.sweep import Campaign, Case, Normal, Uniform
from stickslip.study.sweep.campaigns import _Ledger, _made


def asked(runs: int) -> Campaign:
    """Return the campaign of the measured case."""
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
    return Campaign(
        cases=(Case(mechanism=rig, law=law, t_end=10.0),),
        factors={
            "kinetic_coefficient": Uniform(low=0.1, high=0.3),
            "compression": Uniform(low=0.05, high=0.1),
            "mass": Normal(mean=1.0, sd=0.05),
        },
        design="sobol",
        runs=runs,
        outputs={"travel": Final("x"), "fastest": Max("v"), "rest": EventTimes("stop", -1)},
    )


@contextmanager
def dask(workers: int, *, processes: bool) -> Iterator[Executor]:
    """Yield the executor of a cluster on this machine."""
    from distributed import Client, LocalCluster

    options = {"threads_per_worker": 1, "dashboard_address": ":0", "processes": processes}
    options["memory_limit"] = 0
    with LocalCluster(n_workers=workers, **options) as cluster, Client(cluster) as client:
        yield client.get_executor()


def spawned(workers: int) -> ProcessPoolExecutor:
    """Return processes that were not forked."""
    return ProcessPoolExecutor(workers, mp_context=get_context("spawn"))


def scaling(runs: int) -> None:
    """Print the time on each executor, of a second campaign: the first one starts workers."""
    cases: dict[str, Callable[[], AbstractContextManager[Executor]]] = {
        "1 thread": lambda: ThreadPoolExecutor(1),
        "2 threads": lambda: ThreadPoolExecutor(2),
        "1 process": lambda: spawned(1),
        "2 processes": lambda: spawned(2),
        "1 Dask worker": lambda: dask(1, processes=True),
        "2 Dask workers": lambda: dask(2, processes=True),
        "64 Dask workers in one process": lambda: dask(64, processes=False),
    }
    first = 0.0
    for name, pool in cases.items():
        with pool() as executor, tempfile.TemporaryDirectory() as folder:
            asked(2 * 32_768).run(Path(folder, "warm"), executor=executor)
            begun = time.perf_counter()
            asked(runs).run(Path(folder, "runs"), executor=executor)
            took = time.perf_counter() - begun
        first = first or took
        print(f"{name:32} {took:6.2f} s  {first / took:5.2f}", flush=True)
    one = asked(32_768)
    task = next(one.tasks())
    begun = time.perf_counter()
    made = _made(*task)
    worker = time.perf_counter() - begun
    with tempfile.TemporaryDirectory() as folder:
        ledger = _Ledger(Path(folder, "runs"), one, replace=False)
        begun = time.perf_counter()
        ledger.add(*made)
        writer = time.perf_counter() - begun
    print(
        f"a file: {1e3 * worker:.0f} ms of a worker, {1e3 * writer:.1f} ms of the writer, which is"
        f" busy from {worker / writer:.0f} workers on"
    )


def large(runs: int) -> None:
    """Print time, memory and files of one campaign, and how long a column takes to read."""
    import duckdb
    import pandas as pd

    with tempfile.TemporaryDirectory() as folder:
        begun = time.perf_counter()
        result = asked(runs).run(Path(folder, "runs"))
        took = time.perf_counter() - begun
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(f"{result}\n{took:.1f} s, {runs / took:.0f} a second, {memory:.0f} MiB at most")
        below = f"{folder}/runs/runs"
        begun = time.perf_counter()
        mean = pd.read_parquet(below, columns=["travel"])["travel"].mean()
        print(f"pandas: mean {mean:.6f} m in {time.perf_counter() - begun:.2f} s")
        begun = time.perf_counter()
        query = f"select avg(travel), quantile_cont(travel, 0.95) from '{below}/*.parquet'"
        seen = duckdb.connect().execute(query).fetchall()[0]
        print(f"DuckDB: {seen} in {time.perf_counter() - begun:.2f} s")


def main() -> None:
    """Run as the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1_000_000)
    parser.add_argument("--scaling", action="store_true")
    given = parser.parse_args()
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    (scaling if given.scaling else large)(given.runs)


if __name__ == "__main__":
    main()
