"""Verdicts do not turn on the last bits, which differ between kernels of linear algebra."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from threadpoolctl import threadpool_info

TESTS = Path(__file__).parent
OLDER = {
    "Cooperlake": "Haswell",
    "Haswell": "Sandybridge",
    "SapphireRapids": "Haswell",
    "Sandybridge": "Nehalem",
    "SkylakeX": "Haswell",
    "Zen": "Sandybridge",
}
"""A kernel of OpenBLAS with other instructions, which each processor has that can run the first."""
SHOWN = (
    "import scipy.linalg, threadpoolctl;"
    "print(*{one.get('architecture') for one in threadpoolctl.threadpool_info()})"
)


def run(*arguments, **variables):
    return subprocess.run(
        [sys.executable, *arguments], cwd=TESTS.parent, env=os.environ | variables,
        capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def second():
    """The environment of a process with a second kernel."""
    first = {
        entry.get("architecture") for entry in threadpool_info() if entry["user_api"] == "blas"
    }
    older = OLDER.get(min(map(str, first), default=""))
    if len(first) != 1 or older is None:
        pytest.skip(f"no second kernel of linear algebra is known beside {first or 'none'}.")
    variables = {"OPENBLAS_CORETYPE": older}
    used = run("-c", SHOWN, **variables).stdout.split()
    if used != [older]:
        pytest.skip(f"this library of linear algebra has no kernel {older}: it used {used}.")
    return variables


def test_verdicts_are_the_same_under_a_second_kernel_of_linear_algebra(second):
    """The tests marked `rounding` run with the first kernel like all others, and here again."""
    marked = [
        path for path in TESTS.rglob("test_*.py") if "mark.rounding" in path.read_text("utf-8")
    ]
    again = run(
        "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "rounding and not slow",
        *(str(path) for path in marked if path != Path(__file__)), **second,
    )  # fmt: skip
    assert again.returncode == 0, again.stdout + again.stderr
