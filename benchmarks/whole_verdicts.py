"""What a user is told: whole selections, judged by what is true of the rig and by a fresh motion.

`python -m benchmarks.faults --route select`, `benchmarks.force_maps --route select` and
`benchmarks.structures --route select` ask `select` as a user would, without named laws.

A law is *right* if it is the true one, or if it predicts a fresh motion as well as the true law
fitted to the same record (`SAME`). A fault is *named* if a finding has it, alone or in a group, or
the data check of a refused record; one that is an effect of friction or a constant force also if
the fit of the law that is nearest has its parameter, whose interval leaves 0 out.
A *false certainty* is an accusation of something that is not there; a law that is recommended
without a doubt, a right equal or a finding beside it, and on the fresh motion errs by more than
the error that was stated (`FAR`); or a parameter that is said to be settled and is outside twice
its interval.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.synthetic_truth import share
from stickslip import FrictionLaw, Measurement, check, select
from stickslip.errors import StickslipError
from stickslip.identification import RecordFit, RecordSettings, fit_record
from stickslip.kinds import RecordVerdict
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters

NEUTRAL = ("law", "unexplained")
"""Kinds of findings that name no cause."""
SAME = 1.15
"""Error on a fresh motion over that of the true law up to which a law is an equal one."""
FAR = 1.5
"""Error on a fresh motion over the stated one from which the statement was false."""
TIMES = 2.0
"""Widths of an interval outside which a settled value is false, not unlucky."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Known:
    """A record, and what is true of it."""

    given: Mechanism
    """The mechanism as the user knows it."""
    law: FrictionLaw | None
    """The true law, from which its fit begins; None where no law has its friction."""
    values: Mapping[str, float]
    """True values of its parameters and of those of the mechanism, by path."""
    measurement: Measurement
    fresh: Measurement
    """Another motion of the same rig, which no selection sees."""
    unknown: tuple[str, ...] = ()
    """Paths of the mechanism that are looked for beside the law."""
    fault: bool = False
    """Whether something is wrong with rig or record."""
    right: tuple[str, ...] = ()
    """Kinds of findings that are true."""
    parts: tuple[str, ...] = ()
    """Beginnings of paths of parameters that are then not 0."""


def values_of(law: FrictionLaw, mechanism: Mechanism) -> dict[str, float]:
    """Return the values of a law and a mechanism by path."""
    return {
        path: float(value)
        for room, one in (("friction", law), ("mechanism", mechanism))
        for path, _, value in parameters(one, room)
        if value is not None
    }


def parts_of(kind: str) -> set[str]:
    """Return the kinds that a finding names: several, if they are not told apart."""
    return {kind, *kind.split(" or ")}


def selected(known: Known) -> dict[str, Any]:
    """Return what `select` says of a record, and what of it is true."""
    began = time.process_time()
    try:
        verdict = select(known.given, None, known.measurement, vary=[*known.unknown] or None)
    except StickslipError as error:
        checks = check(known.measurement, mechanism=known.given).findings
        return {
            "refused": str(error),
            "checks": [one.kind for one in checks if one.severity != "info"],
            "right": list(known.right),
            "built_in": known.fault,
            "seconds": time.process_time() - began,
        }
    seconds = time.process_time() - began
    assert isinstance(verdict, RecordVerdict)
    fits = {c.name: c.fit for c in verdict.candidates if c.fit}
    name = known.law.name if known.law else ""
    true = fits.get(name) or (_of_truth(known, verdict.route) if known.law else None)
    horizon = verdict.plan.horizon
    errors = {one: _fresh(fit, known, horizon) for one, fit in fits.items()}
    if true is not None:
        errors[name] = _fresh(true, known, horizon)
    closest = verdict.closest
    assert closest.fit is not None
    own = closest.fit if closest.name == name else None
    settled = {one.path for one in verdict.settled} if verdict.words.settles else ()
    words = verdict.words
    return {
        "law": name,
        "named": verdict.best.name if verdict.best else "",
        "closest": closest.name,
        "equals": list(verdict.equals),
        "doubt": verdict.best.doubt if verdict.best else "",
        "kinds": [one.kind for one in verdict.model_errors],
        "checks": [one.kind for one in verdict.checks.findings if one.severity != "info"],
        "right": list(known.right),
        "parts": [one for one in known.parts if _told(closest.fit, one)],
        "built_in": known.fault,
        "fitted_by": verdict.route,
        "score": closest.score,
        "fresh": errors,
        "intervals": [] if own is None else intervals(own, known, settled),
        "sentence": str(verdict.sentence),
        "verdict": words.verdict,
        "lede": words.lede,
        "settles": list(words.settles),
        "cannot_tell": list(words.cannot_tell),
        "measure_next": list(words.measure_next),
        "seconds": seconds,
    }


def _told(fit: RecordFit, part: str) -> bool:
    """Whether a parameter whose path begins so is not 0, by its interval."""
    own = [one for one in fit.estimates if one.path.startswith(part)]
    return any(one.bounded and one.low * one.high > 0.0 for one in own)


def _of_truth(known: Known, route: str) -> RecordFit | None:
    """Return the fit of the true law, which begins at the truth; None if there is none."""
    assert known.law is not None
    try:
        return fit_record(
            known.given,
            known.law,
            known.measurement,
            unknown=known.unknown,
            route=route,
            settings=RecordSettings(starts=1),
            contained=(),
        )
    except StickslipError:
        return None


def _fresh(fit: RecordFit, known: Known, horizon: float) -> float:
    """Return the error of what the fit predicts of the fresh motion; infinite if it fails."""
    try:
        return float(fit.score(known.fresh, horizon=horizon).rms)
    except StickslipError:
        return float("inf")


def intervals(fit: RecordFit, known: Known, settled: Sequence[str] | set[str]) -> list[Any]:
    """Return for each bounded estimate of the true law whether its interval holds the truth."""
    rows = []
    for one in fit.estimates:
        true = known.values.get(one.path)
        if true is None or not one.bounded:
            continue
        low, high = (one.value + TIMES * (end - one.value) for end in (one.low, one.high))
        rows.append(
            {
                "path": one.path,
                "true": true,
                "value": one.value,
                "covered": bool(one.low <= true <= one.high),
                "near": bool(low <= true <= high),
                "settled": one.path in settled,
            }
        )
    return rows


def predicts(row: Mapping[str, Any], name: str) -> bool:
    """Whether a law is the true one, or errs no more on the fresh motion.

    Where no law has the true friction: no more than was stated.
    """
    true, errors = row["law"], row["fresh"]
    allowed = SAME * errors.get(true, 0.0) if true else FAR * row["score"]
    return name == true or errors.get(name, np.inf) <= allowed


def right(row: Mapping[str, Any]) -> bool:
    """Whether the law that is nearest is a right one."""
    return "refused" not in row and predicts(row, row["closest"])


def named(row: Mapping[str, Any]) -> bool:
    """Whether the fault that is built in was said."""
    if row.get("parts"):
        return True
    said = [*row.get("kinds", ()), *row.get("checks", ())]
    return any(parts_of(kind) & {*row.get("right", ())} for kind in said)


def accused(row: Mapping[str, Any]) -> list[str]:
    """Return findings that name what is not there."""
    kinds = [kind for kind in row.get("kinds", ()) if kind not in NEUTRAL]
    return [kind for kind in kinds if not parts_of(kind) & {*row["right"]}]


def false_certainties(row: Mapping[str, Any]) -> list[str]:
    """Return what was said with certainty and is false."""
    if "refused" in row:
        return []
    found = [f"{kind} is not there" for kind in accused(row)]
    hedged = row["doubt"] or row["kinds"] or any(predicts(row, one) for one in row["equals"])
    own = row["fresh"].get(row["named"], 0.0)
    if row["named"] and not hedged and not right(row) and own > FAR * row["score"]:
        found.append(f"{row['named']} errs by {own:.3g}, stated {row['score']:.3g}")
    found += [
        f"{one['path']} = {one['value']:.4g} is settled, but {one['true']:.4g}"
        for one in row["intervals"]
        if one["settled"] and not one["near"]
    ]
    return found


def in_line(title: str, row: Mapping[str, Any]) -> str:
    """Return a row in a line."""
    if "refused" in row:
        return f"{title}: refused{', named' if named(row) else ''}: {row['refused']}"
    law = "right law" if right(row) else "another law"
    fault = "" if not row["built_in"] else ", named" if named(row) else ", fault not said"
    false = false_certainties(row)
    own = row["fresh"].get(row["closest"], np.inf)
    true = row["fresh"].get(row["law"], np.inf)
    return (
        f"{title}: {law}{fault}{', FALSE: ' + '; '.join(false) if false else ''}"
        f" | stated {row['score']:.3g}, fresh {own:.3g}, true law {true:.3g};"
        f" {row['seconds']:.0f} s | {row['sentence']}"
    )


def totals(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return counts."""
    told = [row for row in rows if "refused" not in row]
    faulty = [row for row in rows if row.get("built_in")]
    sound = [row for row in told if not row["built_in"]]
    found = [one for row in told for one in row["intervals"] if not row["kinds"]]
    false = [row for row in told if false_certainties(row)]
    lines = [
        f"whole selections: {len(told)}, refused {len(rows) - len(told)};"
        f" law right or equal on sound rigs {sum(map(right, sound))} of {len(sound)};"
        f" accused {sum(bool(accused(row)) for row in sound)}",
        f"faults named, alone or in a group: {sum(map(named, faulty))} of {len(faulty)};"
        f" something else {sum(bool(accused(row)) for row in faulty)}",
        f"false certainties: {len(false)} of {len(told)}",
        "95 % intervals of true laws, where nothing is found: "
        + share([one["covered"] for one in found]),
    ]
    if told:
        seconds = [row["seconds"] for row in told]
        lines.append(
            f"processor time, median {np.median(seconds):.0f} s, largest {max(seconds):.0f} s"
        )
    return lines
