"""The friction benchmark: laws and peers fitted to public records, judged on what was not seen.

A `Task` says which part of a record is fitted, which part judges, and by what. `run` gives a task
to stickslip and to its peers.
"""

from stickslip.study.benchmark.definition import (
    ClosedLoop,
    CoefficientError,
    Error,
    FeatureError,
    ForceError,
    PositionError,
    Published,
    Task,
)
from stickslip.study.benchmark.peers import PEERS, Peer
from stickslip.study.benchmark.runs import (
    OURS,
    Results,
    Row,
    benchmark_page,
    run,
    summary_rows,
    task,
    tasks,
)

__all__ = [
    "OURS",
    "PEERS",
    "ClosedLoop",
    "CoefficientError",
    "Error",
    "FeatureError",
    "ForceError",
    "Peer",
    "PositionError",
    "Published",
    "Results",
    "Row",
    "Task",
    "benchmark_page",
    "run",
    "summary_rows",
    "task",
    "tasks",
]
