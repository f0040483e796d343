"""The numbers that the judgement of a measurement is asked for, beside those that are measured.

``python -m benchmarks posterior`` prints a row for each: what, what is asked, what is measured, and
whether that is met. ``python -m benchmarks posterior swings costs`` prints the parts that are named
(``--seed S``; ``--quick`` takes a sixth of the made-up truths, ``--count N`` takes N of each kind;
``special:rounded`` and ``costs:table`` are one line of a part). Rows of made-up truths are
kept in a file of lines by seed and number, as `benchmarks.bands` has it: after each change of the
judge a fresh seed is to be drawn. Processor times depend on the machine.
"""

import argparse
import math
import sys
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from tools.budget import BUDGET, counted

from benchmarks import bands, pulled_sliders, real_records
from benchmarks.band_truths import travels as truths
from benchmarks.closed_loop_axes import fast_lugre
from benchmarks.posterior import costs, fits, study
from stickslip import select
from stickslip.errors import StickslipError

Rows = Sequence[Mapping[str, Any]]
COUNTS: Mapping[str, int] = {"tables": 100, "maps": 24, "records": 66, "decays": 36}
"""Made-up measurements of each kind: of records each of 31 sound and 33 wrong rigs."""
QUICK = 6
"""Part of the made-up truths that is drawn in haste."""
SWINGS = 48
"""Swings: 24 inside the vocabulary, and as many outside."""
TRAVELS = 50
"""Rigs whose travels are judged: of ten truths each, two blocks of four sets are fastened."""
WEAK = 60
"""Tables with much noise, and of noise alone."""
SPECIAL = 10
"""Tables of each special kind."""
PULLED = 24
"""Blocks that a spring pulls: 12 inside the vocabulary, and as many outside."""
AXES = 10
"""Axes with LuGre friction."""
HELD = (0.93, 0.99)
"""Share of truths that bands of 95 % are to hold."""
IN_DOUBT, TRIED = 5, 4
"""Verdicts in doubt of each kind, and measurements that are made up for each of them at most."""
SHOWN = (
    "kind", "number", "truth", "named", "advised", "advice", "asked", "expected", "shrink",
    "followed", "used", "halved",
)  # fmt: skip
"""What is printed of each."""
CLASSES = 14
CODE, CONSTANTS = 21_500, 180
"""What `identify` may have of code lines, named numbers and classes of results."""


@dataclass(frozen=True, kw_only=True)
class Number:
    """A number that is asked for."""

    what: str
    asked: str
    measured: str
    met: bool | None = None
    """None where nothing is asked, or nothing could be measured."""

    def __str__(self) -> str:
        met = {True: "met", False: "NOT MET", None: ""}[self.met]
        return f"| {self.what} | {self.asked} | {self.measured} | {met} |"


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What the study is asked to draw."""

    seed: int
    quick: bool = False
    number: int | None = None
    """Truths of each kind; the usual ones if not given."""
    only: str = ""
    """The line of a part that is printed; all of them if empty."""
    results: Path = Path(bands.RESULTS)

    def count(self, usual: int) -> int:
        """Return how many truths are drawn."""
        if self.number is not None:
            return self.number
        return math.ceil(usual / QUICK) if self.quick else usual

    def of(self, names: Iterable[str]) -> list[str]:
        """Return the lines of a part that are printed."""
        return [name for name in names if self.only in ("", name)]

    def rows(self, kind: str) -> list[dict[str, Any]]:
        """Return what verdicts on made-up measurements of a kind are worth."""
        return bands.run([kind], self.seed, self.count(COUNTS[kind]), self.results, 1)


def least(what: str, asked: float, value: float, more: str = "") -> Number:
    """Return a share that is to be as large as is asked."""
    met = None if math.isnan(value) else value >= asked
    return Number(what=what, asked=f">= {asked:g}", measured=f"{value:.3f}{more}", met=met)


def most(what: str, asked: float, value: float, unit: str = "", form: str = ".3g") -> Number:
    """Return a size that is to be as small as is asked."""
    met = None if math.isnan(value) else value <= asked
    return Number(what=what, asked=f"<= {asked:g}{unit}", measured=f"{value:{form}}{unit}", met=met)


def held(what: str, value: float, more: str = "", low: float = HELD[0]) -> Number:
    """Return a share of truths that bands are to hold."""
    met = None if math.isnan(value) else low <= value <= HELD[1]
    return Number(
        what=what, asked=f"{low:g} to {HELD[1]:g}", measured=f"{value:.3f}{more}", met=met
    )


def _mean(rows: Rows, key: str) -> float:
    result = [row[key] for row in rows if row.get(key) is not None]
    return float(np.mean(result)) if result else math.nan


def _middle(rows: Rows, key: str) -> float:
    result = [row[key] for row in rows if row.get(key) is not None]
    return float(np.median(result)) if result else math.nan


# ---- made-up tables, maps, records and decays


def is_right(row: Mapping[str, Any]) -> bool:
    """Return whether a verdict is right, predicts as well or within 2 %, or names the cause."""
    near = row.get("off", math.inf) <= 0.02
    return bool(row.get("good") or row.get("equal") or near or row.get("found"))


def made_up(asked: Asked) -> Iterator[Number]:
    """Yield what all made-up measurements show."""
    yield from _statements("made-up", [row for kind in COUNTS for row in asked.rows(kind)])


def _statements(what: str, rows: Rows) -> Iterator[Number]:
    """Yield how many verdicts are false, right or in doubt, and how close laws handed over are."""
    false = [row for row in rows if row["false"]]
    yield most(f"{what}: false statements, {len(rows)}", 0.02, len(false) / len(rows))
    judged = [row for row in rows if "named" in row]
    right = [row for row in judged if is_right(row)]
    doubt = [row for row in judged if not is_right(row) and not row["false"]]
    yield least(f"{what}: right, equal within 2 %, or cause named", 0.9, len(right) / len(judged))
    yield most(f"{what}: in doubt, neither that nor false", 0.1, len(doubt) / len(judged))
    handed = [row["handed"] for row in rows if row.get("handed")]
    beyond = [off - said for off, said in handed if off > said]
    yield Number(
        what=f"{what}: law handed over within the stated share of the band's middle",
        asked="all",
        measured=f"{len(handed) - len(beyond)} of {len(handed)}, beyond it by"
        f" {max(beyond, default=0.0):.1%}",
        met=not beyond,
    )


def tables(asked: Asked) -> Iterator[Number]:
    """Yield what made-up tables show."""
    rows = asked.rows("tables")
    for inside, where, width in ((True, "inside", 1.15), (False, "outside", 1.65)):
        own = [row for row in rows if row["inside"] == inside]
        yield held(f"tables, {where}: band", _mean(own, "point"))
        yield least(f"tables, {where}: beyond", 0.9, _mean(own, "beyond"))
        yield most(f"tables, {where}: width over noise, median", width, _middle(own, "width"))
        if inside:
            yield least("tables, inside: law right", 0.85, _mean(own, "right"))
            yield least("tables, inside: right or equal", 0.92, _mean(own, "good"))
        else:
            equal = [{"equal": is_right(row)} for row in own if "equal" in row]
            yield least("tables, outside: equal within 2 %", 0.92, _mean(equal, "equal"))
    yield from _intervals("tables", rows)
    yield from _advice("tables", rows)
    yield from _statements("tables", rows)


def _intervals(kind: str, rows: Rows) -> Iterator[Number]:
    every = [item for row in rows for item in row.get("intervals", ()) if item["bounded"]]
    for key, words in (("law", "named law"), ("any", "all laws")):
        yield held(f"{kind}: intervals, {words}", _mean(every, key), f" of {len(every)}")


def _advice(kind: str, rows: Rows) -> Iterator[Number]:
    own = [row for row in rows if "advice" in row]
    numbers = [row["asked"] for row in own if "asked" in row]
    none = sum(row.get("advised") is False for row in rows)
    count = f", {len(own)} rehearsed, none given for {none}"
    if numbers:
        came, expected = _middle(own, "shrink"), _middle(own, "expected")
        count += f"; {np.median(numbers):.0f} readings in the median, width {came:.2f}"
        count += f" (expected {expected:.2f})"
    yield least(f"{kind}: advice decides or halves", 0.7, _mean(own, "advice"), count)
    some = sum("enough" in row for row in rows)
    count = f", {some} with more than were made: {_mean(rows, 'enough'):.2f}"
    what = f"{kind}: as many as are stated decide or halve"
    yield least(what, 0.7, _mean(own, "followed"), count)
    yield most(f"{kind}: readings of these over those made, median", 1.0, _middle(own, "used"))


def maps(asked: Asked) -> Iterator[Number]:
    """Yield what tables of many loads or temperatures show."""
    rows = asked.rows("maps")
    yield held("maps: band", _mean(rows, "point"))
    yield from _intervals("maps", rows)
    yield from _advice("maps", rows)


def records(asked: Asked) -> Iterator[Number]:
    """Yield what made-up records show."""
    rows = asked.rows("records")
    sound = [row for row in rows if row["inside"]]
    yield held("records, sound: steady band", _mean(sound, "point"))
    yield most("records, sound: half-width over friction", 0.004, _middle(sound, "known"))
    wrong = [*set_of(rows, False)]
    yield held("records, wrong or outside: steady band", _mean(wrong, "point"))
    for name in ("inertia", "viscous_coefficient"):
        own = [
            item["any"]
            for row in sound
            for item in row.get("intervals", ())
            if item["path"].endswith(name)
        ]
        share = float(np.mean(own)) if own else math.nan
        yield held(f"records, sound: {name} inside", share, f" of {len(own)}")
    yield least("records: readings of a second record", 0.93, _mean(rows, "second"))
    yield least("records, sound: right or equal", 0.92, _mean(sound, "good"))
    yield from _intervals("records", rows)
    yield from _advice("records", rows)


def travels(asked: Asked) -> Iterator[Number]:
    """Yield what travels of rigs with known friction show."""
    rows = bands.run(["travels"], asked.seed, asked.count(TRAVELS), asked.results, 1)
    for inside, where in ((True, "inside"), (False, "outside")):
        own = [*set_of(rows, inside)]
        width = f", ±{_middle(own, 'width'):.2f} readings' errors"
        yield held(f"travels, {where}: other settings", _mean(own, "point"), width)
        yield least(f"travels, {where}: beyond", 0.9, _mean(own, "beyond"))
    fastened = [row for row in rows if truths.set_of(row["number"]) == "attached"]
    yield held(f"travels, {len(fastened)} fastened blocks", _mean(fastened, "point"))
    yield least("travels, inside: law right or equal", 0.93, _mean([*set_of(rows, True)], "good"))
    yield least("travels, inside: law right", 0.0, _mean([*set_of(rows, True)], "right"))
    yield from _intervals("travels", rows)
    false = float(np.mean([bool(row["false"]) for row in rows]))
    yield most(f"travels: false statements, {len(rows)}", 0.02, false)
    yield most("travels: processor time, median", 3.0, _middle(rows, "seconds"), " s")
    for row in rows:
        for said in row["false"]:
            print(f"travels {row['number']} ({row['truth']}): {said}", file=sys.stderr)


def set_of(rows: Rows, inside: bool) -> Iterator[Mapping[str, Any]]:
    """Yield rows of truths that the vocabulary has, or of others."""
    return (row for row in rows if row["inside"] == inside)


def decays(asked: Asked) -> Iterator[Number]:
    """Yield what made-up free motions show."""
    rows = asked.rows("decays")
    for inside, where in ((True, "inside"), (False, "outside")):
        own = [*set_of(rows, inside)]
        yield held(f"decays, {where}: band", _mean(own, "point"))
    yield least("decays, inside: right or equal", 0.92, _mean([*set_of(rows, True)], "good"))
    yield least("decays: readings of a second record", 0.93, _mean(rows, "second"))
    yield from _intervals("decays", rows)
    yield from _advice("decays", rows)


def advice(asked: Asked) -> Iterator[Number]:
    """Yield what becomes of verdicts in doubt of all kinds when their advice is carried out.

    A verdict is in doubt if it names a law that others, which it does not exclude, may be.
    """
    every, count = list[dict[str, Any]](), asked.count(IN_DOUBT)
    for kind, drawn in DRAWN.items():
        doubtful = list[dict[str, Any]]()
        for k in range(TRIED * count):
            row = drawn(asked, k)
            if row.get("set", 1) > 1 or row.get("doubt"):
                doubtful.append({"kind": kind, "number": k} | row)
                print({x: doubtful[-1].get(x) for x in SHOWN}, file=sys.stderr, flush=True)
            if len(doubtful) == count:
                break
        every += doubtful
        yield from _advice(f"{kind}, {len(doubtful)} in doubt", doubtful)
    without = sum(row.get("advised") is False for row in every)
    yield Number(
        what=f"verdicts in doubt without advice, {len(every)}", asked="0", measured=str(without),
        met=not without,
    )  # fmt: skip
    yield from _advice("all kinds", every)


def _of_bands(kind: str) -> Callable[[Asked, int], dict[str, Any]]:
    def drawn(asked: Asked, number: int) -> dict[str, Any]:
        return bands.line(kind, asked.seed, number)

    return drawn


DRAWN: Mapping[str, Callable[[Asked, int], dict[str, Any]]] = {
    **{kind: _of_bands(kind) for kind in (*COUNTS, "travels")},
    "features": lambda asked, k: pulled_sliders.pulled(asked.seed, k, rehearsed=True),
    "velocity steps": lambda asked, k: pulled_sliders.stepped(asked.seed, k, rehearsed=True),
}
"""What a verdict on a made-up measurement is worth, and what its advice comes to."""


# ---- special tables, odds of friction


def special(asked: Asked) -> Iterator[Number]:
    """Yield what tables that are special in one thing show."""
    for name in asked.of(study.SPECIAL):
        result = study.of_special(name, asked.seed, asked.count(SPECIAL))
        width = float(np.median([item.width for item in result]))
        share = float(np.mean([item.inside for item in result]))
        yield least(f"special tables, {name}", 0.93, share, f", ±{width:.1%}")
        if name == "sorted joint":
            yield most("sorted joint tables: half-width over friction", 0.03, width)


def odds(asked: Asked) -> Iterator[Number]:
    """Yield how often friction is distinguished from zero, and noise is."""
    count = asked.count(WEAK)
    for what, made, wrong, allowed in (
        ("weak sound tables not distinguished from zero", study.weak, False, 0),
        ("frictionless tables told to have friction", study.frictionless, True, 1),
    ):
        result = [
            study.is_told(made(np.random.default_rng([asked.seed, 60, k]))) for k in range(count)
        ]
        number = sum(item == wrong for item in result)
        yield Number(
            what=f"{what}, {count}", asked=f"<= {allowed}", measured=str(number),
            met=number <= allowed,
        )  # fmt: skip


# ---- closed-loop axes, swings


LUGRE = {
    "kinetic_coefficient", "static_coefficient", "stribeck_velocity", "viscous_coefficient",
    "bristle_stiffness", "inertia",
}  # fmt: skip
"""Parameters of an axis with LuGre friction that its record tells."""


def lugre(asked: Asked) -> Iterator[Number]:
    """Yield what records of axes with LuGre friction in closed loop show."""
    named, inside, count = 0, list[bool](), asked.count(AXES)
    for k in range(count):
        rig, record = fast_lugre(np.random.default_rng([asked.seed, 10, k]))
        guess = replace(rig.axis, inertia=1.3 * rig.axis.inertia, offset=0.0)
        vary = ["friction.*", "mechanism.inertia", "mechanism.offset"]
        verdict: Any = select(guess, None, record, vary=vary, route="balance")
        named += "LuGre" in verdict.closest.title
        truth = {**vars(rig.law), "inertia": rig.axis.inertia}
        known = {parameter.path.rpartition(".")[2]: parameter for parameter in verdict.parameters}
        own = [
            name in known and known[name].low_any <= truth[name] <= known[name].high_any
            for name in sorted(LUGRE)
        ]
        inside += own
        out = [name for name, x in zip(sorted(LUGRE), own, strict=True) if not x]
        print(
            f"axis {k}: {rig.rate / 1e3:.0f} kHz, {verdict.closest.title}, not inside: {out}",
            file=sys.stderr,
        )
    yield least(f"closed-loop LuGre axes: named, of {count}", 0.9 * count, float(named))
    yield least("closed-loop LuGre axes: six intervals", 0.93, float(np.mean(inside)))


def swings(asked: Asked) -> Iterator[Number]:
    """Yield what swings show whose length is given off."""
    result = []
    for k in range(asked.count(SWINGS)):
        result.append(study.swung(study.swing(k, asked.seed)))
        print(result[-1], file=sys.stderr)
    for inside, where, low in ((True, "inside", 0.93), (False, "outside", 0.9)):
        own = [item for item in result if item.inside == inside]
        width = float(np.median([item.width for item in own]))
        share = float(np.mean([item.held for item in own]))
        yield held(f"swings, {where}, {len(own)}: steady band", share, f", ±{width:.1%}", low)
        ahead = float(np.median([item.ahead for item in own]))
        yield most(f"swings, {where}: last 40 % over the reading error, median", 1.3, ahead)
        lengths = float(np.mean([item.length for item in own]))
        yield least(f"swings, {where}: length inside", 0.93, lengths)


# ---- stick-slip


def features(asked: Asked) -> Iterator[Number]:
    """Yield what features of stick-slip show."""
    rows = []
    for k in range(asked.count(PULLED)):
        rows.append(pulled_sliders.pulled(asked.seed, k, rehearsed=True))
        print(rows[-1], file=sys.stderr, flush=True)
    judged = [row for row in rows if "refused" not in row]
    refused = f", {len(rows) - len(judged)} of {len(rows)} refused"
    yield most("features: false statements", 0.02, float(np.mean([x["false"] for x in judged])))
    for inside, where in ((True, "inside"), (False, "outside")):
        own = [*set_of(judged, inside)]
        told = [held for row in own for each in row["predicted"] for held in each]
        share = float(np.mean(told))
        yield held(f"features, {where}: at other settings", share, f" of {len(told)}", 0.93)
        yield least(f"features, {where}: name right or equal", 0.93, _mean(own, "right"), refused)
    for key, words in (("lawful", "law right"), ("intervals", "all laws")):
        every = [item["held"] for row in judged for item in row[key]]
        yield held(f"features: intervals, {words}", float(np.mean(every)), f" of {len(every)}")
    doubt = [row for row in judged if row["doubt"]]
    without = sum(not row["advised"] for row in doubt)
    yield Number(
        what=f"features: verdicts in doubt without advice, {len(doubt)}", asked="0",
        measured=str(without), met=not without,
    )  # fmt: skip
    yield from _advice("features", judged)
    yield most("features: true law lost by the advised record", 0.02, _mean(judged, "lost"))
    seconds = [row["seconds"] for row in judged]
    yield most("features: processor time, median", 5.0, float(np.median(seconds)), " s")
    yield most("features: processor time, most", 5.0, max(seconds), " s")


# ---- fits of one law


def fit_coverage(asked: Asked, kind: str) -> Iterator[Number]:
    """Yield which share of the intervals of fits of a kind holds the truth."""
    rows = list[fits.Fitted]()
    for number in range(asked.count(fits.KINDS[kind].count)):
        rows.append(fits.fitted(kind, asked.seed, number))
        print(rows[-1], file=sys.stderr, flush=True)
    for exact, words in ((True, "law right"), (False, f"law within {fits.OFF:.0%}")):
        own = [row for row in rows if row.exact == exact]
        every = [hit for row in own for hit in row.held.values()]
        unbounded, refused = sum(row.unbounded for row in own), sum(bool(x.refused) for x in own)
        more = f" of {len(every)}, {unbounded} not bounded"
        more += f", {refused} of {len(own)} refused" if refused else ""
        share = float(np.mean(every)) if every else math.nan
        yield held(f"fit, {kind}, {words}: intervals", share, more)
    apart = [row.apart for row in rows if row.apart is not None]
    if apart:
        yield most(f"fit, {kind}: difference from select, {len(apart)}", 0.0, max(apart))
    seconds = [row.seconds for row in rows]
    middle, most_, allowed = float(np.median(seconds)), max(seconds), fits.KINDS[kind].seconds
    yield Number(
        what=f"fit, {kind}: processor time, median", asked=f"<= {allowed:g} s",
        measured=f"{middle:.1f} s, most {most_:.1f} s", met=middle <= allowed,
    )  # fmt: skip


# ---- measured records


def real(asked: Asked) -> Iterator[Number]:
    """Yield what the second parts of measured records show."""
    every = []
    for line in real_records.lines():
        every.append(line)
        print(line, file=sys.stderr)
    result = [item for item in every if not item.reason]
    false = sum(bool(item.false) for item in every)
    yield Number(
        what=f"real sets: lines with a false statement, {len(every)}", asked="0",
        measured=str(false), met=not false,
    )  # fmt: skip
    inside = [item.inside for item in result]
    enough = sum(x >= 0.9 for x in inside)
    yield Number(
        what="real sets: readings of another part inside", asked=">= 0.9 each, .94 median",
        measured=f"{enough} of {len(result)} above .9, median {np.median(inside):.3f}",
        met=enough == len(result) and float(np.median(inside)) >= 0.94,
    )  # fmt: skip
    ratios = [item.ratio for item in result]
    yield most("real sets: half-width over error, median", 2.0, float(np.median(ratios)))
    yield most("real sets: half-width over error, worst", 4.0, max(ratios))
    above = [item for item in result if item.excess > 1.05]
    below = sum(item.excess < 1.0 for item in result)
    yield Number(
        what="real sets: error above Coulomb + viscous by 5 %", asked="0",
        measured=f"{len(above)}, below it on {below}", met=not above,
    )  # fmt: skip
    axis = [item for item in result if item.name.startswith("EMPS")]
    known = max((item.known for item in axis), default=math.nan)
    yield most("EMPS, other half: steady half-width", 0.025, known)
    mass = not any("inertia" in said for item in axis for said in item.false)
    yield Number(
        what="EMPS: mass 95.15 kg", asked="inside", met=mass,
        measured=", ".join(item.interval for item in axis),
    )  # fmt: skip
    handed = max((item.handed / item.spread for item in axis), default=math.nan)
    yield most("EMPS, other half: error of the law handed over, over the force", 0.082, handed)
    yield Number(
        what="sorted public joint tables", asked="half-width .03, readings .93",
        measured="not among the public sets here: see the sorted joint of special tables",
    )  # fmt: skip


# ---- what it takes


def times(asked: Asked) -> Iterator[Number]:
    """Yield processor time and peak memory."""
    peaks = []
    for name in asked.of(costs.KINDS):
        kind, cost = costs.KINDS[name], costs.alone(name)
        peaks.append(cost.peak)
        doc = (kind.made.__doc__ or name).splitlines()[0].rstrip(".")
        yield most(f"processor time: {doc} ({cost.peak:.2f} GB)", kind.most, cost.seconds, " s")
    yield most("peak memory", costs.PEAK, max(peaks), " GB", ".2f")


def sizes(asked: Asked) -> Iterator[Number]:
    """Yield how large the code is."""
    result = counted(tomllib.loads(BUDGET.read_text(encoding="utf-8"))["rooms"])
    yield most("code lines of identify", CODE, result["judge"], form=",.0f")
    yield most("named numbers of identify", CONSTANTS, result["constants"], form=".0f")
    yield most("classes of results of identify", CLASSES, len(result_classes()), form=".0f")


def result_classes() -> list[str]:
    """Return the classes of fits, candidates and verdicts that `stickslip.identify` has."""
    from stickslip.identify.candidates import Candidate, Verdict
    from stickslip.identify.fits import Fit
    from stickslip.identify.kinds import registry

    registry.kinds()  # which loads all of them

    def below(kind: Any) -> set[type]:
        return {kind}.union(*(below(subclass) for subclass in kind.__subclasses__()))

    kinds: tuple[Any, ...] = (Fit, Candidate, Verdict)
    every = set[type]().union(*(below(kind) for kind in kinds))
    own = {item.__name__ for item in every if item.__module__.startswith("stickslip.identify")}
    return sorted(own)


PARTS: Mapping[str, Callable[[Asked], Iterator[Number]]] = {
    "made-up": made_up,
    "advice": advice,
    "tables": tables,
    "maps": maps,
    "records": records,
    "decays": decays,
    "travels": travels,
    "special": special,
    "odds": odds,
    "lugre": lugre,
    "swings": swings,
    "features": features,
    **{f"fit-{kind}": partial(fit_coverage, kind=kind) for kind in fits.KINDS},
    "real": real,
    "costs": times,
    "sizes": sizes,
}


def main(arguments: Sequence[str]) -> None:
    """Print the parts that are named, all of them if none is."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks posterior")
    parser.add_argument("parts", nargs="*", metavar="part", help=f"of {', '.join(PARTS)}")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quick", action="store_true", help="a sixth of the made-up truths")
    parser.add_argument("--count", type=int, help="made-up truths of each kind")
    parser.add_argument("-o", "--results", type=Path, default=Path(bands.RESULTS))
    given = parser.parse_args(arguments)
    if unknown := [part for part in given.parts if part.partition(":")[0] not in PARTS]:
        parser.error(f"no part {', '.join(unknown)}; there are {', '.join(PARTS)}")
    every = Asked(seed=given.seed, quick=given.quick, number=given.count, results=given.results)
    print(f"seed {given.seed}{', a sixth of the truths' * given.quick}")
    print("| what | asked | measured | |\n|---|---|---|---|", flush=True)
    for name in given.parts or PARTS:
        part, _, only = name.partition(":")
        try:
            for number in PARTS[part](replace(every, only=only)):
                print(number, flush=True)
        except (StickslipError, OSError) as error:
            print(f"| {name} | | {error} | |", flush=True)
