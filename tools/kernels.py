"""Run what decides something under other arithmetic: nothing may turn on the last bits.

``python -m tools.kernels`` runs, under several kernels of OpenBLAS and with the engine's machine
code for any x86-64,

1. the tests marked `rounding`;
2. selections of measurements of all kinds (`tests.test_rounding`), whose words have to be those of
   the first kernel, with numbers that differ by a tenth or their last digit at most.

Sums differ between them in the last bits, as they do between processors.
"""

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
KERNELS: Mapping[str, Mapping[str, str]] = {
    "Prescott": {"OPENBLAS_CORETYPE": "Prescott"},
    "Haswell": {"OPENBLAS_CORETYPE": "Haswell"},
    "SkylakeX": {"OPENBLAS_CORETYPE": "SkylakeX"},
    "any x86-64": {"STICKSLIP_CPU": "x86-64"},
}
"""Environments, by what they are called."""
REPORTED = {"Prescott": "Katmai"}
"""What OpenBLAS calls a kernel by another name."""
NEEDED = {"Haswell": "avx2", "SkylakeX": "avx512f"}
"""What the processor must be able to do, by kernel."""
SHOWN = (
    "import numpy, scipy.linalg, threadpoolctl;"
    "print(*{one.get('architecture') for one in threadpoolctl.threadpool_info()})"
)
SELECTED: Mapping[str, tuple[int, ...]] = {
    "table": (0, 1, 2, 3),
    "map": (0,),
    "record": (0, 1),
    "decay": (0,),
    "steps": (0,),
    "servo": (1,),  # of 0 no run follows the readings, and how far off one is turns on rounding
    "arm": (0,),
    "slider": (0,),
    "travels": (0,),
}
"""Numbers of the measurements that are selected under each kernel, by kind."""


def python(*arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """Return what a process wrote that runs with other variables of the environment."""
    return subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, env=os.environ | variables,
        capture_output=True, text=True, check=False,
    )  # fmt: skip


def lacking(name: str) -> str:
    """Return why a kernel cannot be run here, if it cannot."""
    info = Path("/proc/cpuinfo")
    features = info.read_text(encoding="utf-8").split() if info.exists() else []
    if "sse2" not in features:
        return "this is no x86-64 processor under Linux"
    if (needed := NEEDED.get(name, "sse2")) not in features:
        return f"this processor has no {needed}"
    if wanted := KERNELS[name].get("OPENBLAS_CORETYPE"):
        used = python("-c", SHOWN, **KERNELS[name]).stdout.split()
        if used not in ([wanted], [REPORTED.get(wanted, wanted)]):
            return f"linear algebra runs with {' and '.join(used) or 'no kernel of OpenBLAS'}"
    return ""


def words() -> dict[str, str]:
    """Return what selections of some measurements say, by name."""
    from tests.test_rounding import KINDS, said

    return {
        f"{kind} {number}": said(*KINDS[kind][0](number))
        for kind, numbers in SELECTED.items()
        for number in numbers
    }


def failures(name: str, first: Mapping[str, str]) -> list[str]:
    """Return what fails under a kernel."""
    from tests.test_rounding import differ

    tests = python(
        "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "rounding", "tests", **KERNELS[name]
    )
    result = [f"{name}\n{tests.stdout}{tests.stderr}"] if tests.returncode else []
    selections = python("-m", "tools.kernels", "--words", **KERNELS[name])
    if selections.returncode:
        return [*result, f"{name}\n{selections.stderr}"]
    for which, said in json.loads(selections.stdout).items():
        if differ(said, first[which]):
            result.append(f"{name}: {which} says\n{said}\nin place of\n{first[which]}")
    return result


def main() -> None:
    """Run all kernels, one on each core; exit with 1 if a statement differs or a test fails."""
    if "--words" in sys.argv:
        print(json.dumps(words()))
        return
    reasons = {name: lacking(name) for name in KERNELS}
    for name, reason in reasons.items():
        print(f"{name}: {f'skipped: {reason}' if reason else 'runs'}", flush=True)
    names = [name for name, reason in reasons.items() if not reason]
    first = words()
    with ThreadPoolExecutor(int(os.environ.get("WORKERS", "2"))) as pool:
        found = [line for lines in pool.map(lambda x: failures(x, first), names) for line in lines]
    print("\n\n".join(found))
    count = len(names) * (1 + len(first)) - len(found)
    print(f"{count} passed, {len(found)} failed")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
