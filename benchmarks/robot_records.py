"""Friction of measured robots and arms, law by law, beside published values.

``python -m benchmarks.robot_records`` prints a table for each record of several joints that the
benchmark has: the arm of two links, the Stäubli TX40 and the Schunk arm. Each law is given to all
joints alike and fitted to one part of the record with what is not known of the links; the table has
the error of the force of each joint in the other part, over the spread of that force, and the
parameters of Coulomb and viscous friction with 95 % intervals. ``--records tx40`` prints one table,
``--laws`` names other laws; ``--results FILE`` appends each row to a file of JSON lines.
"""

import argparse
import json
import math
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from stickslip import fit
from stickslip.errors import StickslipError
from stickslip.friction import LAWS, FrictionLaw, specification
from stickslip.identify.fits import RecordFit
from stickslip.study.benchmark.definition import Task
from stickslip.study.benchmark.records import ROBOT_TASKS

ASKED = ("viscous", "coulomb", "coulomb-viscous", "direction-dependent", "stribeck")
"""Laws of a table. One whose level grows with the recorded torque is not judged by how it predicts
that torque."""
SHOWN = "coulomb-viscous"
"""The law whose parameters are printed."""
PUBLISHED: Mapping[str, Mapping[str, Sequence[str]]] = {
    "tx40": {
        "viscous_coefficient": ("8.05", "5.53", "1.97", "1.11", "1.86", "0.65"),
        "kinetic_coefficient": ("7.14", "8.26", "6.34", "2.48", "3.03", "0.282"),
    },
    "two-link-arm": {"kinetic_coefficient": ("0.16 to 0.175", "0.11 to 0.12")},
}
"""By record. TX40_config.yaml of figaroh-examples, where joints 5 and 6 share .616 N m s/rad and
1.95 N m more; Wiebe et al. 2023."""


def fitted(task: Task, name: str) -> dict[str, Any]:
    """Return errors and parameters of a law that all joints of a record are given."""
    first, second = task.split()
    began = time.process_time()
    row: dict[str, Any] = {"record": task.name, "law": name}
    try:
        found = fit(task.mechanism, _law(name), first, vary=task.vary, settings=task.settings)
        own, other = _shares(found, None), _shares(found, second)
    except StickslipError as error:
        return row | {"refused": str(error)}
    friction = [one for one in found.estimates if one.path.startswith("friction.")]
    return row | {
        "of itself": own,
        "held out": other,
        "estimates": {one.path: str(one) for one in friction},
        "unbounded": sum(not one.bounded for one in friction),
        "told": len(found.estimates) - len(friction),
        "seconds": time.process_time() - began,
    }


def _law(name: str) -> Any:
    """Return what is fitted of a law that is called as candidates are."""
    kinds: Mapping[str, type[FrictionLaw]] = LAWS
    return kinds[name] if name in kinds else specification(name).law


def _shares(found: RecordFit[Any], record: Any) -> list[float]:
    """Return the error of each joint over the spread of its force, and of all together."""
    seen = found.predict(record) if record is not None else found.predict()
    every = [seen.of(name) for name in found.mechanism.coordinates]
    shares = [float(np.std(own.residual) / np.std(own.measured)) for own in every]
    return [*shares, math.sqrt(float(np.mean(np.square(shares))))]


def table(task: Task, rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the table of a record in Markdown, and parameters beside published ones."""
    names = task.mechanism.coordinates
    heads = ["law", *names, "all", "without interval"]
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    for row in rows:
        if "refused" in row:
            lines.append(f"| {row['law']} | refused: {row['refused']} |")
            continue
        cells = [row["law"], *(f"{x:.3f}" for x in row["held out"]), str(row["unbounded"])]
        lines.append("| " + " | ".join(cells) + " |")
    known = PUBLISHED.get(task.name, {})
    shown = next((row for row in rows if row["law"] == SHOWN and "estimates" in row), None)
    if shown is not None:
        lines.append("")
        for path, text in shown["estimates"].items():
            joint, _, field = path.removeprefix("friction.").partition(".")
            values = known.get(field)
            beside = f"; published {values[names.index(joint)]}" if values else ""
            lines.append(f"  {joint}: {text}{beside}")
        lines.append(f"  {shown['told']} parameters of links and constant forces fitted beside")
    return "\n".join(lines)


def main() -> None:
    """Print the tables."""
    known = {task.name: task for task in ROBOT_TASKS}
    parser = argparse.ArgumentParser(prog="python -m benchmarks.robot_records")
    parser.add_argument("--records", nargs="+", choices=known, default=[*known])
    parser.add_argument("--laws", nargs="+", default=ASKED)
    parser.add_argument("--results", type=Path)
    given = parser.parse_args()
    for name in given.records:
        task = known[name]
        rows = []
        for law in given.laws:
            rows.append(fitted(task, law))
            if given.results is not None:
                with given.results.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(rows[-1]) + "\n")
        print(f"{task.title}: {task.fitted} fitted, {task.judged} predicted")
        print("error of the force held out, over its spread:")
        print(table(task, rows), flush=True)


if __name__ == "__main__":
    main()
