"""``python -m benchmarks [case ...]``: print cases; all of them also write benchmarks/results.md.

``python -m benchmarks capsule:chart capsule:marks`` prints parts of a case that has some.
``python -m benchmarks posterior`` prints what verdicts are worth (`benchmarks.posterior.numbers`).
"""

import argparse
import importlib
import importlib.metadata
import importlib.util
import os
import platform
import sys
from pathlib import Path

from benchmarks import tables
from benchmarks.engines import Holding
from benchmarks.measuring import BUDGET, MANY, REPEATS, Result, Section

CASES = (
    "decay",
    "calls",
    "ensembles",
    "belt",
    "lugre",
    "sampled",
    "sensitivities",
    "contacts",
    "robots",
    "capsule",
    "engines",
)
COMPILE = "compile"
"""Times of compiling, which are printed only: they take minutes and empty caches."""
POSTERIOR = "posterior"
"""What verdicts are worth, which is counted and not timed: it takes an hour."""
PAGE = Path(__file__).parent / "results.md"
LIBRARIES = ("stickslip", "numpy", "scipy", "llvmlite", "heyoka", "mujoco", "drake")


def machine() -> str:
    """Return what the times were taken on."""
    versions = {package: version(package) for package in LIBRARIES}
    libraries = ", ".join(
        f"{package} {results}" for package, results in versions.items() if results
    )
    return (
        f"Machine: {processor()}, {os.cpu_count()} cores;"
        f" {platform.system()}, Python {platform.python_version()}, {libraries}."
    )


def version(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


def processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def page(results: list[object]) -> str:
    """Return the page: targets, cases at equal error, tables of their own, other engines."""
    goals = [target for result in results for target in getattr(result, "targets", ())]
    equal = [result for result in results if isinstance(result, Result)]
    lines = ["## Targets", "", *tables.targets(goals)] if goals else []
    lines += ["## At equal error", "", *tables.equal_error(equal)] if equal else []
    for result in results:
        if isinstance(result, Section):
            lines += [f"## {result.title}", "", *tables.section(result)]
        elif isinstance(result, Holding):
            lines += ["## One block in other engines", "", *tables.in_engines(result)]
    lines.append(
        f"Medians of {REPEATS} runs after the first, or of as many as fit into {BUDGET:g} s, taken"
        f" in turns in one process; at equal error the least processor time of {MANY} runs, which"
        f" other work on the machine lengthens least. {machine()}"
    )
    return "\n".join(lines)


def main() -> None:
    if sys.argv[1:2] == [POSTERIOR]:
        importlib.import_module("benchmarks.posterior.numbers").main(sys.argv[2:])
        return
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument(
        "cases", nargs="*", metavar="case", help=f"of {', '.join((*CASES, COMPILE))}"
    )
    chosen = parser.parse_args().cases
    if chosen == [COMPILE]:
        compiling = importlib.import_module("benchmarks.compiling")
        for measured in (compiling.run(), compiling.default_calls()):
            print("\n".join([f"## {measured.title}", "", *tables.section(measured)]))
        print(machine())
        return
    parts = {case: [name for name in chosen if name.partition(":")[0] == case] for case in CASES}
    unknown = [name for name in chosen if name.partition(":")[0] not in CASES]
    names = [case for case in CASES if not chosen or parts[case]]
    modules = {name: importlib.import_module(f"benchmarks.{name}") for name in names}
    picked = {
        name: [part.partition(":")[2] for part in parts[name] if ":" in part] for name in names
    }
    if unknown:
        parser.error(f"no case {', '.join(unknown)}; there are {', '.join(CASES)}")
    for name, own in picked.items():
        known = getattr(modules[name], "PARTS", ())
        strange = [part for part in own if part not in known]
        if strange:
            there = f"there are {', '.join(known)}" if known else "it has none"
            parser.error(f"no part {', '.join(strange)} of {name}; {there}")
    text = page([modules[name].run(*picked[name]) for name in names])
    print(text)
    if len(names) == len(CASES) and not any(picked.values()):
        PAGE.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
