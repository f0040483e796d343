# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.study.benchmark.definition import ClosedLoop as ClosedLoop
from stickslip.study.benchmark.definition import CoefficientError as CoefficientError
from stickslip.study.benchmark.definition import Error as Error
from stickslip.study.benchmark.definition import FeatureError as FeatureError
from stickslip.study.benchmark.definition import ForceError as ForceError
from stickslip.study.benchmark.definition import PositionError as PositionError
from stickslip.study.benchmark.definition import Published as Published
from stickslip.study.benchmark.definition import Task as Task
from stickslip.study.benchmark.peers import PEERS as PEERS
from stickslip.study.benchmark.peers import Peer as Peer
from stickslip.study.benchmark.runs import OURS as OURS
from stickslip.study.benchmark.runs import Results as Results
from stickslip.study.benchmark.runs import Row as Row
from stickslip.study.benchmark.runs import benchmark_page as benchmark_page
from stickslip.study.benchmark.runs import run as run
from stickslip.study.benchmark.runs import summary_rows as summary_rows
from stickslip.study.benchmark.runs import task as task
from stickslip.study.benchmark.runs import tasks as tasks

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
