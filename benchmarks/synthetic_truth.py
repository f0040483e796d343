"""Random rigs with known friction: do intervals cover the truth?

``python -m benchmarks.synthetic_truth --rigs 200 --seed 1 --jobs 2``; results are appended to a
file line by line, and a run that was killed goes on where it was. ``--variant clean`` asks it of
axes with Coulomb and viscous friction whose records have the noise of an encoder and nothing else;
``--variant drag`` leaves a drag term out of the law that is fitted, and ``--variant drift`` lets
friction levels grow by 5 % over a record: what do intervals cover then?
"""

import argparse
import json
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.rigs import FREE, TRUTHS, Random, Rig, draw, record
from stickslip import Axis, CoulombViscous, FrictionLaw, Measurement, QuadraticDrag, fit
from stickslip.errors import StickslipError
from stickslip.identify import LawFit
from stickslip.identify.fits import Estimate

ALWAYS = "coulomb-viscous"
ROUTES = ("balance",)
KINDS = ("truth", "limit")
"""Whether intervals hold the truth, and what the law comes to in the end where it does not hold."""
VIOLATIONS = ("drag", "drift")
DRAG = (0.05, 0.5)
"""Drag at the largest speed over the kinetic level, where the law that is fitted has none."""
DRIFT = 0.05
"""Growth of levels over a record, over their mean."""
TOGETHER = 6
"""Fresh records whose fit stands for what a law comes to with data without end."""
COVERAGE = (0.90, 0.99)
"""Targets for nominal 95 %."""
RESULTS = "synthetic_truth.jsonl"
NORMAL = 1.96
"""Half width of a 95 % interval over the standard deviation."""


def coverage(
    found: LawFit, rig: Rig, limits: Mapping[str, float] | None = None
) -> list[dict[str, Any]]:
    """Return for every bounded estimate which intervals hold the true value.

    Parameters
    ----------
    found : LawFit
        A fit to a record of the rig.
    rig : Rig
        The truth.
    limits : mapping of str to float, optional
        By path what the law comes to with more data, where it does not hold.
    """
    rows = []
    for estimate in found.estimates:
        own = rig.law if estimate.path.startswith("friction.") else rig.axis
        true = getattr(own, estimate.path.rpartition(".")[2])
        if not estimate.bounded:
            rows.append({"path": estimate.path, "bounded": False})
            continue
        limit = {} if limits is None else {"limit": bool(_holds(estimate, limits[estimate.path]))}
        rows.append(
            limit
            | {
                "path": estimate.path,
                "bounded": True,
                "truth": bool(_holds(estimate, true)),
                "relative": estimate.half_width / NORMAL / max(abs(true), 1e-300),
            }
        )
    return rows


def _holds(estimate: Estimate, value: float) -> bool:
    return estimate.low <= value <= estimate.high


def fitted(
    rig: Rig,
    measurement: Measurement,
    *,
    law: type[FrictionLaw] | None = None,
    route: str = ROUTES[0],
) -> LawFit:
    """Return a fit of a law, the true one if none is given, the inertia looked for too."""
    law = type(rig.law) if law is None else law
    result = fit(
        Axis(inertia=1.0),
        law,
        measurement,
        vary=[*FREE.get(law.name, ["friction.*"]), "mechanism.inertia"],
        route=route,
    )
    assert isinstance(result, LawFit)
    return result


def violated(rig: Rig, violation: str, random: Random) -> Rig:
    """Return a rig that the law that is fitted to it does not hold for."""
    if violation == "drift":
        return replace(rig, drift=DRIFT)
    assert isinstance(rig.law, QuadraticDrag)
    drag = rig.law.kinetic_coefficient / rig.speed**2 * float(random.uniform(*DRAG))
    return replace(rig, law=replace(rig.law, quadratic_coefficient=drag))


def judge(
    seed: int,
    number: int,
    *,
    candidates: Sequence[str] = (),  # of studies that compare laws
    route: str = ROUTES[0],
    variant: str = "",
) -> dict[str, Any]:
    """Return what fits make of one random rig."""
    del candidates
    random = np.random.default_rng([seed, number])
    own = {"drag": "quadratic-drag", "clean": ALWAYS}
    truth = own.get(variant) or list(TRUTHS)[number % len(TRUTHS)]
    began = time.perf_counter()
    row: dict[str, Any] = {"seed": seed, "rig": number, "truth": truth, "route": route}
    row |= {"variant": variant}
    try:
        rig, law, limits = draw(random, truth), None, None
        if variant == "clean":
            rig = replace(rig, disturbance=0.0)
        violation = variant in VIOLATIONS
        if violation:
            rig = violated(rig, variant, random)
            law = CoulombViscous if variant == "drag" else None
        measurement, _ = record(rig, random)
        result = fitted(rig, measurement, law=law, route=route)
        if violation:
            more = Measurement(trials=tuple(record(rig, random)[0] for _ in range(TOGETHER)))
            long = fitted(rig, more, law=law, route=route)
            limits = {estimate.path: estimate.value for estimate in long.estimates}
        row |= {
            "correlation_time": rig.correlation_time,
            "intervals": coverage(result, rig, limits),
        }
    except StickslipError as error:
        row["failed"] = str(error)
    return row | {"seconds": time.perf_counter() - began}


def judged(
    path: Path, seed: int, route: str = ROUTES[0], variant: str = ""
) -> list[dict[str, Any]]:
    """Return the results of a route in a file; a last line that was cut off does not count."""
    rows = []
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
        try:
            row = json.loads(line)
        except json.JSONDecodeError:
            continue
        same = row.get("route", ROUTES[0]) == route and row.get("variant", "") == variant
        if row["seed"] == seed and same:
            rows.append(row)
    return rows


def run(
    path: Path,
    *,
    rigs: int | Sequence[int],
    seed: int,
    jobs: int,
    candidates: Sequence[str] = (),
    route: str = ROUTES[0],
    variant: str = "",
    rated: Callable[..., dict[str, Any]] | None = None,
) -> Iterator[str]:
    """Judge the rigs, so many or of these numbers, that a file does not hold yet, and append them.

    Yield progress.
    """
    wanted = range(rigs) if isinstance(rigs, int) else rigs
    done = {row["rig"] for row in judged(path, seed, route, variant)} & {*wanted}
    left = [number for number in wanted if number not in done]
    rate = partial(judge, variant=variant) if rated is None else rated
    cut = path.exists() and not path.read_bytes().endswith(b"\n")
    with path.open("a", encoding="utf-8") as file, ProcessPoolExecutor(jobs) as pool:
        if cut and path.stat().st_size:
            file.write("\n")
        tasks = [
            pool.submit(rate, seed, number, candidates=candidates, route=route) for number in left
        ]
        for count, task in enumerate(as_completed(tasks), start=len(done) + 1):
            row = task.result()
            file.write(json.dumps(row) + "\n")
            file.flush()
            said = f"rig {row['rig']}, {row['truth']}, {row['seconds']:.1f} s"
            yield f"{count} of {len(wanted)}: {said}"


def share(hits: Sequence[bool]) -> str:
    """Return a share in percent with its binomial error."""
    if not hits:
        return "none"
    p = sum(hits) / len(hits)
    error = math.sqrt(p * (1.0 - p) / len(hits))
    return f"{100 * p:5.1f} +- {100 * error:.1f} % of {len(hits)}"


def summary(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the tables: coverage by kind of interval and by parameter."""
    failed = [row for row in rows if "failed" in row]
    rows = [row for row in rows if "failed" not in row]
    intervals = [item for row in rows for item in row["intervals"]]
    bounded = [interval for interval in intervals if interval["bounded"]]
    lines = [
        f"{len(rows)} rigs ({len(failed)} failed); {len(bounded)} of {len(intervals)} estimates"
        " have a bounded interval",
        f"coverage of nominal 95 % (target {100 * COVERAGE[0]:.0f} to {100 * COVERAGE[1]:.0f} %):",
        *(
            f"  {kind:22}{share([item[kind] for item in bounded])}"
            for kind in KINDS
            if all(kind in item for item in bounded)
        ),
        "by parameter:",
    ]
    for path in dict.fromkeys(item["path"] for item in bounded):
        hits = [item["truth"] for item in bounded if item["path"] == path]
        lines.append(f"  {path.partition('.')[2]:30}{share(hits)}")
    lines.append("by true law:")
    for truth in TRUTHS:
        own = [o for row in rows if row["truth"] == truth for o in row["intervals"] if o["bounded"]]
        lines.append(f"  {truth:22}{share([item['truth'] for item in own])}")
    return [*lines, *(f"rig {row['rig']} failed: {row['failed']}" for row in failed)]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.synthetic_truth")
    parser.add_argument("--rigs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    parser.add_argument("--route", choices=ROUTES, default=ROUTES[0], help="how records are fitted")
    parser.add_argument(
        "--variant",
        choices=("clean", *VIOLATIONS),
        default="",
        help="clean: encoder noise alone; drag: left out of the law; drift: of the levels",
    )
    given = parser.parse_args()
    for line in run(
        given.results,
        rigs=given.rigs,
        seed=given.seed,
        jobs=given.jobs,
        route=given.route,
        variant=given.variant,
    ):
        print(line, flush=True)
    print("\n".join(summary(judged(given.results, given.seed, given.route, given.variant))))


if __name__ == "__main__":
    main()
