"""All studies of what selections say of rigs with a known truth, as one campaign with one table.

``python -m benchmarks.studies -o studies --seed 5 --share 0.1`` judges a tenth of the rigs of each
study, spread over its truths; ``--only axes joints`` some studies, ``--executor dask://HOST:PORT``
on a cluster. Each rig is a line of ``rows.jsonl`` in the folder, and depends on study, seed and
number alone: what was ended goes on where it was. The table is written as ``studies.csv``.

A verdict is right if it names the true law or one that predicts as well, of a rig with a fault, if
the fault is named; a false certainty is what each study says in its own words. Regret is the error
of the named law on a fresh motion over that of the best candidate, less 1.
"""

import argparse
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from benchmarks import (
    joints,
    pulled_sliders,
    travel_truth,
)
from benchmarks.axis_records import FAULTS, FURTHER, TRUTHS
from stickslip.cli.progress import workers
from stickslip.engine.executors import spread

Row = Mapping[str, Any]
GOLDEN = 0.618
STRUCTURES = (*TRUTHS, *FAULTS, *FURTHER)


class Outcome(NamedTuple):
    """What a verdict on one rig is worth."""

    right: bool
    false: bool
    held: int = 0
    """Intervals of 95 % that hold the truth."""
    bounded: int = 0
    """Intervals."""
    regret: float = math.nan


@dataclass(frozen=True, kw_only=True)
class Study:
    """Rigs of one kind."""

    count: int
    """Rigs of the whole study."""
    judge: Callable[[int, int], dict[str, Any]]
    """Returns what a selection says of a rig, by seed and number."""
    outcome: Callable[[Row], Outcome]
    """Returns what that is worth."""


def _regret(errors: Mapping[str, float], named: str | None) -> float:
    """Return the excess of the error of a law over the least."""
    known = [error for error in errors.values() if math.isfinite(error) and error > 0.0]
    own = errors.get(named or "", math.nan)
    return own / min(known) - 1.0 if known and math.isfinite(own) else math.nan


def _travel(row: Row) -> Outcome:
    held = [item["held"] for item in row["intervals"]]
    regret = _regret(row["errors"], row["named"])
    return Outcome(row["right"], row["false"], sum(held), len(held), regret)


def _slider(row: Row) -> Outcome:
    held = [item["held"] for item in row["intervals"]]
    return Outcome(row["right"], row["false"], sum(held), len(held))


def _arm(row: Row) -> Outcome:
    known = [item for item in row["joints"].values() if item["covered"] is not None]
    sound = row["kind"] in ("clean", "still")
    right = all(item["right"] or item["in set"] for item in known)
    said = any(item["said"] for item in known)
    held = sum(item["covered"] > 0.95 for item in known)
    return Outcome(right if sound else said, sound and said, held, len(known))


STUDIES: Mapping[str, Study] = {
    "travels": Study(count=200, judge=travel_truth.judge, outcome=_travel),
    "features": Study(count=20, judge=pulled_sliders.pulled, outcome=_slider),
    "velocity steps": Study(count=20, judge=pulled_sliders.stepped, outcome=_slider),
    "joints": Study(
        count=len(joints.CASES),
        judge=lambda seed, number: joints.judged(*joints.CASES[number], number, seed),
        outcome=_arm,
    ),
}


def stored(path: Path) -> list[dict[str, Any]]:
    """Return the results in a file; a last line that was cut off does not count."""
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError:
            continue
    return rows


def numbers(count: int, part: float) -> list[int]:
    """Return the rigs of a part of a study, spread over it and over what repeats in it.

    Examples
    --------
    >>> numbers(40, 0.1)
    [0, 1, 14, 27]
    """
    step = round(GOLDEN * count) or 1
    while math.gcd(step, count) > 1:
        step += 1
    return sorted(i * step % count for i in range(max(1, round(part * count))))


def judged(name: str, seed: int, number: int) -> dict[str, Any]:
    """Return the row of a rig; what fails is a row too."""
    try:
        row = STUDIES[name].judge(seed, number)
    except Exception as error:  # one rig of hundreds must not end a campaign
        row = {"refused": f"{type(error).__name__}: {error}"}
    return row | {"study": name, "campaign": [seed, number]}


def tabulated(rows: Sequence[Row]) -> pd.DataFrame:
    """Return a line for each study."""
    lines = []
    for name, study in STUDIES.items():
        own = [row for row in rows if row["study"] == name]
        known = [row for row in own if not ("refused" in row or "failed" in row)]
        if not own:
            continue
        result = [study.outcome(row) for row in known]
        bounded = sum(item.bounded for item in result)
        regrets = [item.regret for item in result if math.isfinite(item.regret)]
        seconds = [row.get("processor", row.get("seconds", math.nan)) for row in known]
        lines.append(
            {
                "study": name,
                "rigs": len(own),
                "refused": len(own) - len(known),
                "right or equal": sum(item.right for item in result),
                "false certainties": sum(item.false for item in result),
                "intervals": bounded,
                "coverage, %": 100.0 * sum(item.held for item in result) / max(bounded, 1),
                "regret, median": float(np.median(regrets)) if regrets else math.nan,
                "processor time, median s": float(np.median(seconds)) if seconds else math.nan,
            }
        )
    return pd.DataFrame(lines)


def run(
    folder: Path, seed: int, part: float, only: Sequence[str], count: int, address: str | None
) -> pd.DataFrame:
    """Judge the rigs that a folder does not hold yet; write and return the table."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "rows.jsonl"
    wanted = [(name, seed, n) for name in only for n in numbers(STUDIES[name].count, part)]
    known = {(row["study"], *row["campaign"]): row for row in stored(path)}
    tasks = [item for item in wanted if item not in known]
    if path.exists() and not path.read_bytes().endswith(b"\n"):
        with path.open("a", encoding="utf-8") as file:
            file.write("\n")

    def keep(row: dict[str, Any]) -> bool:
        key = (row["study"], *row["campaign"])
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        known[key] = row
        done = sum(item in known for item in wanted)
        said = row.get("refused") or row.get("failed") or STUDIES[key[0]].outcome(row)
        print(f"{done} of {len(wanted)}: {key[0]} {key[2]}: {said}", flush=True)
        return True

    with workers(count, address) as executor:
        if executor is None:
            for task in tasks:
                keep(judged(*task))
        else:
            spread(judged, tasks, keep, executor)
    table = tabulated([known[item] for item in wanted])
    table.to_csv(folder / "studies.csv", index=False)
    return table


def main(arguments: Sequence[str] | None = None) -> None:
    """Run as the command line says."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.studies")
    parser.add_argument("-o", "--output", type=Path, default=Path("studies"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--share", type=float, default=1.0, help="share of the rigs of each study")
    parser.add_argument("--only", nargs="+", choices=STUDIES, default=[*STUDIES])
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--executor", metavar="dask://HOST:PORT")
    given = parser.parse_args(arguments)
    table = run(given.output, given.seed, given.share, given.only, given.workers, given.executor)
    print(table.to_string(index=False, float_format="%.3g"))


if __name__ == "__main__":
    main()
