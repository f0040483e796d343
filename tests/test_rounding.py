"""Verdicts do not turn on the last bits, which differ between kernels of linear algebra."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from threadpoolctl import threadpool_info

TESTS = Path(__file__).parent
OLDER = {
    "Cooperlake": ("Haswell", "Nehalem"),
    "Haswell": ("Sandybridge", "Nehalem"),
    "SapphireRapids": ("Haswell", "Nehalem"),
    "Sandybridge": ("Nehalem", "Core2"),
    "SkylakeX": ("Haswell", "Nehalem"),
    "Zen": ("Sandybridge", "Nehalem"),
}
"""Kernels of OpenBLAS with other instructions, which each processor has that can run the first."""
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
def others():
    """The environments of processes with a second and a third kernel."""
    first = {
        entry.get("architecture") for entry in threadpool_info() if entry["user_api"] == "blas"
    }
    older = OLDER.get(min(map(str, first), default=""))
    if len(first) != 1 or older is None:
        pytest.skip(f"no other kernel of linear algebra is known beside {first or 'none'}.")
    found = [{"OPENBLAS_CORETYPE": name} for name in older]
    used = [run("-c", SHOWN, **one).stdout.split() for one in found]
    if used != [[name] for name in older]:
        pytest.skip(f"this library of linear algebra lacks one of the kernels {older}: {used}.")
    return found


def test_verdicts_are_the_same_under_three_kernels_of_linear_algebra(others):
    """The tests marked `rounding` run with the first kernel like all others, and here again.

    Both further kernels run at the same time.
    """
    marked = [
        path for path in TESTS.rglob("test_*.py") if "mark.rounding" in path.read_text("utf-8")
    ]
    arguments = [
        "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "rounding and not slow",
        *(str(path) for path in marked if path != Path(__file__)),
    ]  # fmt: skip
    with ThreadPoolExecutor(len(others)) as pool:
        again = [*pool.map(lambda one: run(*arguments, **one), others)]
    for kernel, done in zip(others, again, strict=True):
        assert done.returncode == 0, f"{kernel}\n{done.stdout}{done.stderr}"
