"""Random rigs with known friction: do intervals cover the truth, and does selection pick well?

``python -m benchmarks.synthetic_truth --rigs 200 --seed 1 --jobs 2``; results are appended to a
file line by line, and a run that was killed goes on where it was. ``--route inverse-dynamics`` asks
the same of friction that is derived from filtered motion and force. ``--variant clean`` asks it of
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
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.rigs import FREE, TRUTHS, Array, Random, Rig, draw, record
from stickslip import Axis, CoulombViscous, FrictionLaw, Measurement, QuadraticDrag, fit, select
from stickslip.errors import StickslipError
from stickslip.identification import RecordFit
from stickslip.identification.estimation.jackknife import infer
from stickslip.identification.settings import RecordSettings
from stickslip.kinds.joints.joint_verdict import RecordCandidate, RecordVerdict
from stickslip.selection.choice import choose
from stickslip.selection.cross_validation import CrossValidation

CANDIDATES = (
    "viscous", "coulomb", "coulomb-viscous", "direction-dependent", "power-viscous",
    "quadratic-drag", "stribeck", "dahl",
)  # fmt: skip
"""Compared by selection. Left out: LuGre and Dahl with exponent, which take most of the time."""
FAST = CANDIDATES[:6]
"""Those without bristles or a peak at rest: a fifth of the time."""
ALWAYS = "coulomb-viscous"
HORIZON = 4.0
"""Length [s] of the runs that are predicted on fresh records."""
FRESH = 5
"""Fresh records of each rig: on a single one, luck decides between laws that are equally right."""
ROUTES = ("shooting", "inverse-dynamics")
KINDS = ("jackknife", "bootstrap", "naive")
FURTHER = ("not widened", "limit", "limit, not widened")
"""Intervals without what halves add; and whether either holds what the law comes to in the end."""
VIOLATIONS = ("drag", "drift")
DRAG = (0.05, 0.5)
"""Drag at the largest speed over the kinetic level, where the law that is fitted has none."""
DRIFT = 0.05
"""Growth of levels over a record, over their mean."""
TOGETHER = 6
"""Fresh records whose fit stands for what a law comes to with data without end."""
COVERAGE = (0.90, 0.99)
"""Targets for nominal 95 %."""
REGRET = 0.10
RESULTS = "synthetic_truth.jsonl"


def coverage(
    found: RecordFit, rig: Rig, limits: Mapping[str, float] | None = None
) -> list[dict[str, Any]]:
    """Return for every bounded estimate which intervals hold the true value.

    Parameters
    ----------
    found : RecordFit
        A fit to a record of the rig.
    rig : Rig
        The truth.
    limits : mapping of str to float, optional
        By path what the law comes to with more data, where it does not hold.
    """
    plain = infer(found.optimum.best, found.scale).half_widths
    naive = 1.96 * np.sqrt(np.maximum(np.diag(found.inference.naive), 0.0))
    drawn = np.percentile(found.bootstrap(seed=0), [2.5, 97.5], axis=0)
    rows = []
    for i, estimate in enumerate(found.estimates):
        room, _, name = estimate.path.partition(".")
        true = getattr(rig.law if room == "friction" else rig.axis, name)
        if not estimate.bounded:
            rows.append({"path": estimate.path, "bounded": False})
            continue
        error = estimate.value - true
        limit = {}
        if limits is not None:
            off = estimate.value - limits[estimate.path]
            held = estimate.low <= limits[estimate.path] <= estimate.high
            limit = {"limit": bool(held), "limit, not widened": bool(abs(off) <= plain[i])}
        rows.append(
            limit
            | {
                "path": estimate.path,
                "bounded": True,
                "jackknife": bool(estimate.low <= true <= estimate.high),
                "not widened": bool(abs(error) <= plain[i]),
                "naive": bool(abs(error) <= naive[i]),
                "bootstrap": bool(drawn[0, i] <= true <= drawn[1, i]),
                "errors": float(error / found.inference.errors[i]),
                "relative": float(found.inference.errors[i] / max(abs(true), 1e-300)),
            }
        )
    return rows


def fitted(
    rig: Rig,
    measurement: Measurement,
    *,
    law: type[FrictionLaw] | None = None,
    starts: int = 4,
    route: str = ROUTES[0],
) -> RecordFit:
    """Return a fit of a law, the true one if none is given, the inertia looked for too."""
    law = type(rig.law) if law is None else law
    found = fit(
        Axis(inertia=1.0),
        law,
        measurement,
        vary=[*FREE.get(law.name, ["friction.*"]), "mechanism.inertia"],
        route=route,
        settings=RecordSettings(starts=starts),
    )
    assert isinstance(found, RecordFit)
    return found


def regrets(
    measurement: Measurement,
    fresh: Sequence[Measurement],
    *,
    candidates: Sequence[str] = CANDIDATES,
    starts: int = 2,
    route: str = ROUTES[0],
) -> dict[str, Any]:
    """Return what was picked, and the errors of all candidates on each fresh record."""
    verdict = select(
        Axis(inertia=1.0),
        candidates,
        measurement,
        vary=["friction.*", "mechanism.inertia"],
        route=route,
        settings=RecordSettings(starts=starts),
    )
    assert isinstance(verdict, RecordVerdict)
    errors = {c.name: [_error(c, one) for one in fresh] for c in verdict.candidates}
    picks = {
        "selected": verdict.closest.name,
        f"always {ALWAYS}": ALWAYS,
        **{name: verdict.picks[name] for name in ("held-out blocks", "AIC", "BIC")},
        "training error": verdict.picks["training error"],
    }
    judged = {
        c.name: {
            "losses": c.validation.losses,
            "parameters": c.parameters,
            "dropped": c.dropped or c.doubt,
            "residual": c.residual,
            "effective": c.effective,
            "simpler": list(c.simpler),
            "is_simpler": list(c.is_simpler),
        }
        for c in verdict.candidates
        if c.validation
    }
    return {"errors": errors, "picks": picks, "judged": judged}


def _error(candidate: RecordCandidate, fresh: Measurement) -> float:
    if candidate.fit is None:
        return math.inf
    return candidate.fit.score(fresh, horizon=HORIZON).rms


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
    candidates: Sequence[str] = CANDIDATES,
    route: str = ROUTES[0],
    variant: str = "",
) -> dict[str, Any]:
    """Return what fits, and selection if there are candidates, make of one random rig."""
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
        fresh = [record(rig, random)[0] for _ in range(FRESH if candidates else 0)]
        found = fitted(rig, measurement, law=law, route=route)
        if violation:
            more = Measurement(trials=tuple(record(rig, random)[0] for _ in range(TOGETHER)))
            long = fitted(rig, more, law=law, starts=1, route=route)
            limits = dict(zip(long.free_parameters.paths, long.values.tolist(), strict=True))
        row |= {
            "correlation_time": rig.correlation_time,
            "over_noise": found.rms / rig.noise if route == ROUTES[0] else None,
            "effective": found.inference.effective,
            "rows": len(found.residual),
            "intervals": coverage(found, rig, limits),
            "contradicting": bool(found.halves and found.halves.contradicting),
            "chance": float(min(found.halves.chances)) if found.halves else None,
        }
        if candidates:
            row |= regrets(measurement, fresh, candidates=candidates, route=route)
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
            rows.append(repicked(row))
    return rows


@dataclass(frozen=True, kw_only=True)
class Stored:
    """A candidate as a line of results has it, for the rule that chooses among candidates."""

    name: str
    parameters: int
    dropped: str
    validation: CrossValidation
    residual: float
    effective: float
    simpler: tuple[str, ...]
    is_simpler: tuple[str, ...]

    @property
    def score(self) -> float:
        return self.validation.score


def repicked(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row with what the present rule selects: the rule may have changed since the fits."""
    if "judged" not in row or any("effective" not in one for one in row["judged"].values()):
        return row  # of fits that kept less than the rule asks for
    candidates = [
        Stored(
            name=name,
            parameters=one["parameters"],
            dropped=one["dropped"],
            validation=CrossValidation(losses=tuple(one["losses"]), extrapolation=math.nan),
            residual=one["residual"],
            effective=one["effective"],
            simpler=tuple(one["simpler"]),
            is_simpler=tuple(one["is_simpler"]),
        )
        for name, one in row["judged"].items()
    ]
    best = choose(candidates)
    return row | {"picks": row["picks"] | {"selected": best.name}}


def run(
    path: Path,
    *,
    rigs: int | Sequence[int],
    seed: int,
    jobs: int,
    candidates: Sequence[str],
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


def regret(row: Mapping[str, Any], rule: str) -> float:
    """Return the error of a rule's pick on all fresh records over that of the best, less 1."""
    errors = {name: np.atleast_1d(found) for name, found in row["errors"].items()}
    return _excess({name: _rms(found) for name, found in errors.items()}, row["picks"][rule])


def regret_on_one(row: Mapping[str, Any], rule: str) -> float:
    """Return the mean regret on each fresh record alone, where the luckiest law is the best."""
    errors = {name: np.atleast_1d(found) for name, found in row["errors"].items()}
    count = len(next(iter(errors.values())))
    picked = row["picks"][rule]
    alone = [_excess({n: float(e[i]) for n, e in errors.items()}, picked) for i in range(count)]
    return sum(alone) / count


def _rms(errors: Array) -> float:
    return math.sqrt(float(np.mean(errors**2)))


def _excess(errors: Mapping[str, float], picked: str) -> float:
    return errors[picked] / min(errors.values()) - 1.0


def summary(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the tables: coverage by kind of interval and by parameter, regret by rule."""
    failed = [row for row in rows if "failed" in row]
    rows = [row for row in rows if "failed" not in row]
    intervals = [one for row in rows for one in row["intervals"]]
    bounded = [one for one in intervals if one["bounded"]]
    lines = [
        f"{len(rows)} rigs ({len(failed)} failed); {len(bounded)} of {len(intervals)} estimates"
        " have a bounded interval",
        f"coverage of nominal 95 % (target {100 * COVERAGE[0]:.0f} to {100 * COVERAGE[1]:.0f} %):",
        *(
            f"  {kind:22}{share([one[kind] for one in bounded])}"
            for kind in (*KINDS, *FURTHER)
            if all(kind in one for one in bounded)
        ),
        "halves of the record contradict each other in "
        + share([row.get("contradicting", False) for row in rows]),
        "by parameter, jackknife:",
    ]
    for path in dict.fromkeys(one["path"] for one in bounded):
        hits = [one["jackknife"] for one in bounded if one["path"] == path]
        lines.append(f"  {path.partition('.')[2]:30}{share(hits)}")
    lines.append("by true law, jackknife:")
    for truth in TRUTHS:
        own = [o for row in rows if row["truth"] == truth for o in row["intervals"] if o["bounded"]]
        lines.append(f"  {truth:22}{share([one['jackknife'] for one in own])}")
    chosen = [row for row in rows if "picks" in row]
    if chosen:
        lines += regret_lines(chosen)
    return [*lines, *(f"rig {row['rig']} failed: {row['failed']}" for row in failed)]


def regret_lines(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the table of regrets, and how often the true law is picked."""
    counts = {len(np.atleast_1d(next(iter(row["errors"].values())))) for row in rows}
    fresh = " or ".join(str(count) for count in sorted(counts))
    lines = [
        f"regret on {fresh} fresh records of a rig, {len(rows)} rigs"
        f" (target: mean under {100 * REGRET:.0f} %), and mean regret on a single one:"
    ]
    for rule in (*rows[0]["picks"], "the true law"):
        taken = [row | {"picks": row["picks"] | {"the true law": row["truth"]}} for row in rows]
        taken = [row for row in taken if row["picks"][rule] in row["errors"]]  # it was a candidate
        if not taken:
            continue
        values = 100.0 * np.array([regret(row, rule) for row in taken])
        alone = 100.0 * np.array([regret_on_one(row, rule) for row in taken])
        right = [row["picks"][rule] == row["truth"] for row in taken]
        lines.append(
            f"  {rule:24} mean {_mean(values)}, median {np.median(values):5.1f} %, worst"
            f" {values.max():7.1f} %; single {_mean(alone)}; the true law in {share(right)}"
        )
    return lines


def _mean(values: Array) -> str:
    """Return a mean with its standard error."""
    return f"{values.mean():6.1f} +- {values.std() / len(values) ** 0.5:.1f} %"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.synthetic_truth")
    parser.add_argument("--rigs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--results", type=Path, default=Path(RESULTS))
    parser.add_argument(
        "--candidates",
        choices=("all", "fast", "none"),
        default="all",
        help="laws that selection compares; none: fits of the true law only",
    )
    parser.add_argument("--route", choices=ROUTES, default=ROUTES[0], help="how records are fitted")
    parser.add_argument(
        "--variant",
        choices=("clean", *VIOLATIONS),
        default="",
        help="clean: encoder noise alone; drag: left out of the law; drift: of the levels",
    )
    given = parser.parse_args()
    candidates = {"all": CANDIDATES, "fast": FAST, "none": ()}[given.candidates]
    for line in run(
        given.results,
        rigs=given.rigs,
        seed=given.seed,
        jobs=given.jobs,
        candidates=candidates,
        route=given.route,
        variant=given.variant,
    ):
        print(line, flush=True)
    print("\n".join(summary(judged(given.results, given.seed, given.route, given.variant))))


if __name__ == "__main__":
    main()
