"""Bands of verdicts against known truths: the numbers of issue 59, by one command.

``python -m benchmarks.bands --seed 1 --count 120 --kinds tables -o bands.jsonl`` draws rigs by
seed and number, judges each through the public API and appends a line to the file; what the file
has is not judged again. Then it prints target, measured, and whether that is met. ``--details``
adds the measured numbers by kind of truth and every false statement. Rigs are those of
`benchmarks.band_truths`, which share no code with the judge.

Measured of a rig: whether the band holds the true steady friction point by point, all along, and
beyond the measured speeds; its half-width over the noise; the probability of a new reading to lie
in the bands of readings; whether the named law is the true one, or predicts as well (root mean
square error at most 1.25 times that of the true structure fitted by least squares, or half the
noise); whether the set holds the true family; intervals over all laws; those of the named law,
which on tables are of that law laid through the true curve where it is not the true law; and after
the advised readings, drawn from the truth, whether the mean width has halved or one family is left.

*False statements*: a bounded interval over all laws that misses its true value by more than half
its width; a fault, and on records any property of the rig, that is named without doubt and is not
there; a law that is alone in its set without doubt, wrong, and off by more than the noise; a band
that misses the truth by more than two noises anywhere, unless what hides there is said to.
"""

import argparse
import json
import math
import time
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import ndtr
from tools.budget import BUDGET, counted

from benchmarks.band_truths import decays, maps, records, tables, travels
from benchmarks.band_truths.rig import VISCOUS, Array, Points, Rig
from benchmarks.band_verdict import Judged, judged
from stickslip.errors import StickslipError

RESULTS = "bands.jsonl"
KINDS: Mapping[str, Callable[[int, int], Rig]] = {
    "tables": tables.drawn,
    "maps": maps.drawn,
    "records": records.drawn,
    "decays": decays.drawn,
    "travels": travels.drawn,
}
LEVELS = (0.95, 0.80, 0.50)
SECONDS = {"tables": 0.5, "maps": 8.0, "records": 8.0, "decays": 5.0, "travels": 3.0}
"""Processor time that a verdict of each kind may take [s]."""
FAULTS = {"drift", "clipping", "threshold"}
"""Terms that are faults."""
Row = Mapping[str, Any]


def rated(rig: Rig, seed: int) -> dict[str, Any]:
    """Return what a verdict on a rig is worth."""
    row: dict[str, Any] = {
        "kind": rig.kind, "truth": rig.truth, "inside": rig.inside, "false": [],
    }  # fmt: skip
    began = time.process_time()
    try:
        verdict = judged(rig)
        row["seconds"] = time.process_time() - began
        if rig.second is not None:
            row["second"] = verdict.inside(rig.second)
    except StickslipError as error:
        # a refusal, of the second record too, is right where something is wrong that no band holds
        row["refused"] = str(error)
        row.setdefault("seconds", time.process_time() - began)
        if rig.inside:
            row["false"] = [f"refused: {error}"]
        return row
    except Exception as error:  # a verdict that breaks is a result
        said = f"broke: {type(error).__name__}: {error}"
        return row | {"false": [said], "seconds": time.process_time() - began}
    row |= {"named": "+".join(verdict.family), "set": len(verdict.set), "gain": verdict.gain}
    row["known"] = verdict.known
    if verdict.law is not None:
        row["handed"] = [verdict.law.off, verdict.law.stated]
    if rig.curves and rig.asked is not None:
        row |= _covered(rig, rig.asked, verdict)
    if rig.family is not None:
        named = _named(verdict.family)
        row["right"] = named == rig.family
        row["good"] = row["right"] or row.get("equal", False)
        row["in_set"] = any(_named(item) == rig.family for item in verdict.set)
    asserted = [fault for fault in verdict.faults if fault.fault or rig.causes is not None]
    true = rig.faults | (rig.causes or frozenset())
    row["accused"] = sorted(item.kind for item in asserted if not item.instead & true)
    told = any(fault.instead & rig.faults for fault in verdict.faults)
    row["found"] = told if rig.faults else None
    row["doubts"] = verdict.doubts
    row["intervals"] = _intervals(rig, verdict)
    if rig.more is not None and rig.curves and rig.asked is not None:
        row |= _advised(rig, verdict, seed)
    row["false"] = list(_false(rig, row))
    return row


def _named(family: Sequence[str]) -> frozenset[str]:
    """Return the terms of a family without its faults, which are judged apart."""
    return frozenset(family) - FAULTS


def _covered(rig: Rig, asked: Points, verdict: Judged) -> dict[str, Any]:
    """Return how the band compares with the true curve, and new readings with theirs."""
    assert rig.noise is not None
    noise = np.maximum(rig.noise(asked), 1e-300)
    true = [curve(asked) for curve in rig.curves]
    point, whole = verdict.band(asked), verdict.band(asked, all_along=True)
    out = [np.maximum(point.low - item, item - point.high) / noise for item in true]
    scatter = (rig.noise if rig.shown is None else rig.shown)(asked)
    result: dict[str, Any] = {
        "point": float(np.mean([item <= 1e-9 for item in out])),
        "all": float(
            np.mean([np.all((whole.low <= item) & (item <= whole.high)) for item in true])
        ),
        "width": float(np.mean((point.high - point.low) / 2.0 / noise)),
        "out": float(np.max(out)),
    }
    # of a free motion nobody reads friction: what a second record shows is read
    result["new"] = (
        verdict.shown(rig.second, LEVELS)
        if rig.kind == "decays" and rig.second is not None
        else [_share(verdict.readings(asked, level), true, scatter) for level in LEVELS]
    )
    if rig.beyond is not None:
        far = verdict.band(rig.beyond)
        over = [curve(rig.beyond) for curve in rig.curves]
        result["beyond"] = float(np.mean([(far.low <= y) & (y <= far.high) for y in over]))
    law = verdict.predicted(asked)
    if law is not None:
        # the law of several days is that of their mean
        among = [*true, np.mean(true, axis=0)]
        error = min(float(np.sqrt(np.mean(((law - item) / noise) ** 2))) for item in among)
        result["error"] = error
        best = 0.0
        if rig.fitted is not None:
            best = float(np.sqrt(np.mean(((rig.fitted(asked) - true[0]) / noise) ** 2)))
            result["best"] = best
        result["equal"] = error <= max(1.25 * best, 0.5)
        # within the tolerance of any law: of friction, at 95 % of the places
        size = [np.maximum(np.abs(item), 0.1 * np.max(np.abs(item)) + 1e-300) for item in among]
        shares = zip(among, size, strict=True)
        result["off"] = min(
            float(np.quantile(np.abs(law - item) / own, 0.95)) for item, own in shares
        )
    return result


def _share(band: Any, true: Sequence[Array], scatter: Array) -> float:
    """Return the probability of new readings in a band: true curves (n,) and normal noise (n,)."""
    noise = np.maximum(scatter, 1e-300)
    each = [ndtr((band.high - item) / noise) - ndtr((band.low - item) / noise) for item in true]
    return float(np.mean(each))


def _intervals(rig: Rig, verdict: Judged) -> list[dict[str, Any]]:
    """Return the intervals of parameters whose true value is known.

    Those of a named law that is not the true one are of that law laid through the true curve.
    """
    is_true = _named(verdict.family) == rig.family
    nearest = {} if is_true else verdict.nearest(rig.curves)
    result = []
    for parameter in verdict.parameters:
        true = rig.parameters.get(parameter.path.rpartition(".")[2])
        other = ("power" in verdict.family) != ("power" in (rig.family or ()))
        if true is None or (other and parameter.path.endswith(VISCOUS)):
            continue  # of another power of the speed
        low, high = float(parameter.low_any), float(parameter.high_any)
        bounded = math.isfinite(low) and math.isfinite(high)
        half = max((high - low) / 2.0, 1e-300)
        miss = max(low - true, true - high, 0.0) / half if bounded else 0.0
        result.append({
            "path": parameter.path, "bounded": bounded, "any": low <= true <= high, "miss": miss,
            "law": bool(parameter.low <= nearest.get(parameter.path, true) <= parameter.high),
            "width": half / abs(true or 1.0),
        })  # fmt: skip
    return result


def _advised(rig: Rig, verdict: Judged, seed: int) -> dict[str, Any]:
    """Return whether the advised readings shrink the band by half, or leave one family.

    Twice: of what is advised, and of as many readings as are stated to halve it.
    """
    assert rig.more is not None
    assert rig.asked is not None
    places = verdict.advised()
    if places is None:
        return {"advised": False}
    before, result = verdict.doubtful(rig.asked), dict[str, Any]()
    enough = verdict.halves and verdict.advised(verdict.halves)
    for which, some in (("advice", places), ("enough", enough)):
        if some is None:
            continue
        result |= {"followed": False, "used": len(some) / verdict.made}
        try:
            after = judged(rig.more(some, seed))
        except Exception:  # counted as advice that did not help
            result[which] = False
            continue
        now = after.doubtful(rig.asked)
        shrink = float(np.mean(now.high - now.low) / np.mean(before.high - before.low))
        result[which] = result["followed"] = shrink <= 0.5 or len(after.set) == 1
        if which == "advice":
            result |= {"asked": len(some), "expected": verdict.expected, "shrink": shrink}
        else:
            result |= {"halves": len(some), "halved": shrink}
    return result


def _false(rig: Rig, row: Row) -> Iterator[str]:
    """Yield the false statements of a verdict."""
    for item in row["intervals"]:
        if item["miss"] > 0.5:
            yield f"{item['path']} misses its interval by {item['miss']:.1f} half-widths"
    for kind in row["accused"]:
        yield f"{kind} is named and is not there"
    wrong = not row.get("right", False) and not row.get("equal", False) and not row["doubts"]
    if row["set"] == 1 and wrong and row.get("error", 0.0) > 1.0 and row["gain"] <= 0.0:
        yield f"{row['named']} stands alone, and is off by {row['error']:.1f} noises"
    if row.get("out", 0.0) > 2.0:
        yield f"the band misses the truth by {row['out']:.1f} noises"


def line(kind: str, seed: int, number: int) -> dict[str, Any]:
    """Return the line of the results of one rig."""
    of = {"seed": seed, "number": number}
    return of | rated(KINDS[kind](number, seed), seed * 100_000 + number)


def _mean(rows: Sequence[Row], key: str) -> float:
    result = [row[key] for row in rows if row.get(key) is not None]
    return float(np.mean(result)) if result else math.nan


def summary(rows: Sequence[Row]) -> list[tuple[str, str, str, bool | None]]:
    """Return the numbers of the issue: what, target, measured, met."""
    lines: list[tuple[str, str, str, bool | None]] = []

    def put(what: str, target: str, value: float, met: bool, text: str = "{:.3f}") -> None:
        known = math.isfinite(value)
        lines.append((what, target, text.format(value) if known else "-", met if known else None))

    for kind in dict.fromkeys(row["kind"] for row in rows):
        own = [row for row in rows if row["kind"] == kind]
        for inside in (True, False):
            part = [row for row in own if row["inside"] == inside]
            where = f"{kind}, {'inside' if inside else 'outside'}"
            point, whole, far = (_mean(part, key) for key in ("point", "all", "beyond"))
            put(f"{where}: pointwise coverage", ".93-.99", point, 0.93 <= point <= 0.99)
            put(f"{where}: whole curve", ">= .90", whole, whole >= 0.90)
            put(f"{where}: beyond the range", ">= .90", far, far >= 0.90)
            widths = [row["width"] for row in part if "width" in row]
            most = 1.6 if inside else 2.7
            if widths:
                middle = float(np.median(widths))
                target = f"<= {most}" if kind == "tables" else "(tables)"
                put(f"{where}: width over noise, median", target, middle,
                    middle <= most or kind != "tables", "{:.2f}")  # fmt: skip
                put(f"{where}: width over noise, mean", "-", float(np.mean(widths)), True, "{:.2f}")
            new = [row["new"] for row in part if "new" in row]
            for level, share in zip(LEVELS, np.mean(new, axis=0) if new else (), strict=False):
                put(f"{where}: new readings in the {level:.2f} band", f"{level:.2f} +- .03",
                    float(share), abs(float(share) - level) <= 0.03)  # fmt: skip
        second = _mean(own, "second")
        put(f"{kind}: readings of a second record", ">= .90", second, second >= 0.90)
        known = [row for row in own if row["inside"] and "right" in row]
        share = _mean(known, "good")
        put(f"{kind}: law right or predicting as well", ">= .92", share, share >= 0.92)
        put(f"{kind}: law right", "-", _mean(known, "right"), True)
        put(f"{kind}: truth in the set", "-", _mean(known, "in_set"), True)
        result = _mean(own, "found")
        put(f"{kind}: faults found", "-", result, True)
        sound = [
            {"accused": bool(row["accused"])} for row in own if row["inside"] and "accused" in row
        ]
        share = _mean(sound, "accused")
        put(f"{kind}: sound rigs accused", "<= .02", share, share <= 0.02)
        held = [item for row in own for item in row.get("intervals", ()) if item["bounded"]]
        share = _mean(held, "any")
        put(
            f"{kind}: intervals over all laws ({len(held)})",
            ".93-.99",
            share,
            0.93 <= share <= 0.99,
        )
        put(f"{kind}: intervals under the named law", "-", _mean(held, "law"), True)
        share = _mean(own, "advice")
        put(f"{kind}: advice decides or halves the band", ">= .70", share, share >= 0.70)
        share = _mean(own, "enough")
        put(f"{kind}: as many as are said to halve it do", "-", share, True)
        asked = [row["asked"] for row in own if "asked" in row]
        if asked:
            put(f"{kind}: advised readings, median", "-", float(np.median(asked)), True, "{:.0f}")
        wrong = float(np.mean([bool(row["false"]) for row in own]))
        put(f"{kind}: false statements ({len(own)} rigs)", "<= .02", wrong, wrong <= 0.02)
        middle, worst = (float(f([row["seconds"] for row in own])) for f in (np.median, np.max))
        put(f"{kind}: processor time, median [s]", f"<= {SECONDS[kind]}", middle,
            middle <= SECONDS[kind], "{:.2f}")  # fmt: skip
        put(f"{kind}: processor time, most [s]", "-", worst, True, "{:.2f}")
    sizes = counted(tomllib.loads(BUDGET.read_text(encoding="utf-8"))["rooms"])
    code, constants = sizes["judge"], sizes["constants"]
    put("judge: code lines", "<= 27,000", code, code <= 27_000, "{:,.0f}")
    put("judge: numeric constants", "<= 350", constants, constants <= 350, "{:.0f}")
    return lines


def printed(lines: Sequence[tuple[str, str, str, bool | None]]) -> str:
    """Return the table as text."""
    said = {True: "met", False: "NOT MET", None: "-"}
    return "\n".join(
        f"{what:52} {target:>12} {value:>9}  {said[met] if target[0] not in '-(' else ''}".rstrip()
        for what, target, value, met in lines
    )


def details(rows: Sequence[Row]) -> str:
    """Return the numbers by kind of truth, and every false statement."""
    text = []
    keys = ("point", "all", "width", "beyond", "error", "good", "right", "in_set", "advice")
    text.append(f"{'':34}" + "".join(f"{key:>8}" for key in ("count", *keys, "new .5", "false")))
    for kind, truth in sorted({(row["kind"], row["truth"]) for row in rows}):
        own = [row for row in rows if (row["kind"], row["truth"]) == (kind, truth)]
        new = [row["new"][-1] for row in own if "new" in row]
        numbers = [len(own), *(_mean(own, key) for key in keys)]
        numbers += [np.mean(new) if new else math.nan, np.mean([bool(r["false"]) for r in own])]
        mark = "" if own[0]["inside"] else "*"
        text.append(f"{kind:8}{truth + mark:26}" + "".join(f"{number:8.2f}" for number in numbers))
    for row in rows:
        text += [f"{row['kind']} {row['number']} ({row['truth']}): {item}" for item in row["false"]]
    return "\n".join(text)


def known(path: Path) -> list[dict[str, Any]]:
    """Return the lines of a file of results; a line that was not ended is left out."""
    rows = []
    for text in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            rows.append(json.loads(text))
        except json.JSONDecodeError:
            continue
    return rows


def run(kinds: Sequence[str], seed: int, count: int, path: Path, jobs: int) -> list[dict[str, Any]]:
    """Judge what the file does not have, append it, and return the lines asked for."""
    wanted = [(kind, seed, number) for kind in kinds for number in range(count)]
    rows = {(item["kind"], item["seed"], item["number"]): item for item in known(path)}
    missing = [item for item in wanted if item not in rows]
    with path.open("a", encoding="utf-8") as file:
        for row in _lines(missing, jobs):
            file.write(json.dumps(row) + "\n")
            file.flush()
            rows[row["kind"], row["seed"], row["number"]] = row
    return [rows[item] for item in wanted]


def _lines(missing: Sequence[tuple[str, int, int]], jobs: int) -> Iterator[dict[str, Any]]:
    if jobs == 1:
        yield from (line(*item) for item in missing)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(line, *zip(*missing, strict=True)) if missing else ()


def main(arguments: Sequence[str] | None = None) -> None:
    """Judge rigs and print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.bands")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=120, help="rigs of each kind")
    parser.add_argument("--kinds", nargs="+", choices=[*KINDS], default=[*KINDS])
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--details", action="store_true")
    parser.add_argument("-o", "--results", type=Path, default=Path(RESULTS))
    given = parser.parse_args(arguments)
    rows = run(given.kinds, given.seed, given.count, given.results, given.jobs)
    print(printed(summary(rows)))
    if given.details:
        print(details(rows))


if __name__ == "__main__":
    main()
