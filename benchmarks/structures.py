"""Which structures the evidence engine finds in records of axes whose truth is known.

``python -m benchmarks.structures --seed 11`` makes a record of each of 24 structures, 12 faults and
8 further truths, explains it, and predicts the friction of a second one (the next seed). With
``--names cv1 f_gap1`` it does so for some, with ``--rule E`` by another rule, and with ``--stress``
for seven truths at low rates, with small motions, a coarse encoder and noise.

A structure is right if it holds the terms of the truth and no others. It is equal if its friction
on the second record is as near the truth as that of the true structure: within 15 %, or within
0.5 % of the friction. A fault is named if a finding has its kind, and wrong if it does not.
"""

import argparse
import json
import math
import time
import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.axis_records import ALL, FAULTS, FURTHER, RATE, TRUTHS, AxisRecord, Truth, record
from stickslip import Measurement
from stickslip.errors import InputError
from stickslip.evidence import (
    Balance,
    Explanation,
    Fit,
    Rule,
    Series,
    Structure,
    Term,
    begin,
    explain,
    fit,
    low_pass,
    predict,
)
from stickslip.evidence.fits import design, matched
from stickslip.evidence.intervals import refined

RULES = {
    "B": Rule(1.0, 0.02, 0.005, False, False, None),
    "C": Rule(1.0, 0.02, 0.005, True, False, None),
    "D": Rule(1.0, 0.02, 0.005, True, True, None),
    "E": Rule(2.0, 0.02, 0.01, True, True, None),
    "F": Rule(),
    "G": Rule(2.0, 0.02, 0.01, True, True),
}
"""The rules that were compared; F is the usual one."""
KINDS = {
    "backlash": {"backlash", "loose"},
    "drift": {"drift"},
    "delay": {"delay"},
    "flexible": {"flexible"},
    "saturation": {"saturation"},
    "spring": {"spring"},
}
"""Kinds of terms that name a fault."""
TOLD = {
    "backlash": ("backlash", "late or elastic"),
    "drift": ("drift of the level",),
    "delay": ("delay", "late or elastic"),
    "flexible": ("flexibility", "late or elastic"),
    "saturation": ("force limit",),
    "spring": ("spring", "position force"),
}
"""Kinds of findings that name a fault."""
ALSO = {"ri1": ("position force",), "da3": ("load",), "lo1": ("load",)}
"""Kinds of findings that are true of structures without a fault."""
OF_PLANT = ("inertia", "flexible", "loose", "saturation", "backlash")
"""Kinds that are not friction."""
STRESSED = ("cv1", "pv1", "ds1", "da1", "lg1", "f_gap1", "f_flex1")


@dataclass(frozen=True, kw_only=True)
class Score:
    """What was found in one record."""

    name: str
    fault: str
    structure: str
    right: bool
    equal: bool
    tied: bool
    """Whether the true structure is among the ties."""
    further: tuple[str, ...] = ()
    """Terms that are not of the truth."""
    missing: tuple[str, ...] = ()
    faults: tuple[tuple[str, ...], ...] = ()
    """Faults that are named, with the kinds of each."""
    error: float = math.nan
    """Error of the friction on the second record, over its size."""
    best_error: float = math.nan
    """That of the true structure."""
    covered: Mapping[str, bool] = field(default_factory=dict)
    seconds: float = 0.0
    evaluated: int = 0

    @property
    def named(self) -> bool:
        """Return whether the fault that is built in is named."""
        return any(KINDS[self.fault] & set(kinds) for kinds in self.faults if self.fault)

    @property
    def wrong(self) -> bool:
        """Return whether a fault is named that is not built in."""
        true = KINDS.get(self.fault, set())
        return any(not true & set(kinds) for kinds in self.faults)

    @property
    def line(self) -> str:
        """Return the score in a line."""
        verdict = (
            "right" if self.right else "equal" if self.equal else "tie" if self.tied else "WRONG"
        )
        if self.fault:
            verdict = "named" if self.named else "missed"
            verdict += ", WRONG FAULT" if self.wrong else ""
        elif self.faults:
            verdict += ", ACCUSED"
        terms = " ".join([*(f"+{x}" for x in self.further), *(f"-{x}" for x in self.missing)])
        faults = " ".join("/".join(kinds) for kinds in self.faults)
        error = "" if self.fault else f"{100 * self.error:5.2f} ({100 * self.best_error:.2f}) %"
        return (
            f"{self.name:9} {verdict:14} {error:15} {self.seconds:4.1f} s {terms} [{faults}]"
            f" | {self.structure}"
        )


def kinds_of(structure: Structure) -> set[str]:
    """Return what a structure holds, with its memory and the Stribeck step of LuGre.

    The damping of a bristle is of its memory.
    """
    found = {term.kind for term in structure.terms if term.kind not in ("inertia", "damping")}
    for _, shape in structure.memories:
        found.add("memory")
        if len(shape) == 5:
            found.add("stribeck")
    return found


def true_structure(truth: Truth, balance: Balance) -> Structure:
    """Return the structure of a truth, with its nonlinear parameters."""
    plant = truth.plant
    parameters = {
        "power": (plant.exponent,),
        "stribeck": (plant.stribeck_velocity, plant.stribeck_exponent),
        "stribeck_dir": (plant.stribeck_velocity, plant.stribeck_exponent),
        "ripple": (plant.wave,),
        "level_ripple": (plant.wave,),
        "second": (plant.second_length, 1.0),
    }
    found = begin(balance)
    wanted = set(truth.kinds.split())
    if plant.lugre:
        step = plant.step_forward / plant.forward
        shape = (plant.length, 1.0, plant.stribeck_velocity, step, plant.stribeck_exponent)
        found = found.shaped("", shape)
        wanted -= {"stribeck"}
    elif "memory" in wanted:
        found = found.shaped("", (plant.length, plant.bristle_exponent))
    for kind in wanted - {"memory"}:
        what = kind if kind in ("load", "temperature") else ""
        found = found.having(Term(kind, parameters.get(kind, ()), "", what))
    return found


def friction_error(found: Fit, balance: Balance, second: AxisRecord) -> float:
    """Return the error of the predicted friction on a second record, over its deviation."""
    there, _, _ = predict(found, [second.series], balance)
    made = design(there, found.structure)
    values = found.coef[matched(found.owner, made.owners)]
    own = np.array([term.kind not in OF_PLANT for term in made.owners])
    predicted = made.columns[:, own] @ values[own]
    part = there.parts[0]
    true = low_pass(part.h, there.fc).passed(second.friction)[:: part.every]
    rows = there.use & ~there.at_rest
    return float(np.sqrt(np.mean((predicted - true)[rows] ** 2)) / np.std(true[rows]))


def true_values(truth: Truth) -> dict[str, float]:
    """Return the true values of parameters, by the names of intervals."""
    p = truth.plant
    back = p.viscous if p.viscous_backward is None else p.viscous_backward
    drag = p.viscous if p.exponent != 1.0 else math.nan
    return {
        "-/inertia": p.inertia,
        "-/level": 0.5 * (p.forward + p.backward),
        "-/offset": p.offset + 0.5 * (p.forward - p.backward),
        "-/viscous": 0.5 * (p.viscous + back),
        "-/viscous_dir": 0.5 * (p.viscous - back),
        "-/power": drag,
        "-/quadratic": drag,
        "-/power.0": p.exponent,
        "-/stribeck": 0.5 * (p.step_forward + p.step_backward),
        "-/stribeck_dir": 0.5 * (p.step_forward - p.step_backward),
        "-/stribeck.0": p.stribeck_velocity,
        "-/stribeck_dir.0": p.stribeck_velocity,
        "-/load": p.by_load,
        "-/temperature": p.by_temperature * p.forward,
        "-/second": p.second,
        "-/second.0": p.second_length,
        "-/spring": p.spring,
        "-/r0": p.length,
        "-/n": p.bristle_exponent,
        "*/delay.0": p.delay,
        "-/saturation": 1.0,
    }


def coverage(found: Explanation, truth: Truth) -> dict[str, bool]:
    """Return which intervals hold the true value; of LuGre those that its damping leaves alone."""
    known = true_values(truth)
    usual = ("-/inertia", "-/viscous")
    return {
        key: bool(low <= known[key] <= high)
        for key, (_, low, high) in found.intervals.items()
        if key in known and math.isfinite(known[key]) and (not truth.plant.lugre or key in usual)
    }


def score(truth: Truth, *, seed: int, rule: Rule, every: int = 1) -> Score:
    """Explain a record, and judge what was found."""
    warnings.simplefilter("error")
    measured = thinned(record(truth, seed).series, every)
    began = time.process_time()
    try:
        found = explain([measured], rule=rule)
    except InputError as error:
        return Score(
            name=truth.name, fault=truth.fault, structure=str(error), right=False, equal=False,
            tied=False,
        )  # fmt: skip
    seconds = time.process_time() - began
    best = found.best.structure
    faults = {kind for fault in found.faults for kind in fault.kinds}
    got, wanted = kinds_of(best), set(truth.kinds.split())
    right = got - faults == wanted
    error = best_error = math.nan
    if not truth.fault and every == 1:
        second = record(truth, seed + 1)
        balance = found.balance
        error = friction_error(found.best, balance, second)
        true = refined(balance, fit(balance, true_structure(truth, balance)))
        best_error = friction_error(true, balance, second)
    return Score(
        name=truth.name,
        fault=truth.fault,
        structure=str(best),
        right=right and not (faults and not truth.fault),
        equal=error <= max(1.15 * best_error, best_error + 0.005),
        tied=any(kinds_of(one.structure) == wanted for one in found.ties),
        further=tuple(sorted(got - faults - wanted)),
        missing=tuple(sorted(wanted - got)),
        faults=tuple(fault.kinds for fault in found.faults),
        error=error,
        best_error=best_error,
        covered=coverage(found, truth) if right else {},
        seconds=seconds,
        evaluated=found.evaluated,
    )


def measured(found: AxisRecord) -> Measurement:
    """Return a record as a user has it."""
    known = dict(found.covariates)
    load = known.pop("load", 1.0)
    return Measurement(
        time=found.t, position=found.q, force=found.force, load=load, inputs=known, turning=True
    )


def true_parameters(truth: Truth) -> dict[str, float]:
    """Return the true values of laws with one load, by path."""
    p = truth.plant
    found = {"mechanism.inertia": p.inertia}
    if p.by_load or p.by_temperature or p.level_ripple or p.second or p.lugre:
        return found
    sides = {"forward_": (p.forward, p.step_forward), "backward_": (p.backward, p.step_backward)}
    if p.forward == p.backward and p.step_forward == p.step_backward:
        sides[""] = sides["forward_"]
    for side, (level, step) in sides.items():
        found[f"friction.{side}kinetic_coefficient"] = level
        if step:
            found[f"friction.{side}static_coefficient"] = level + step
    back = p.viscous if p.viscous_backward is None else p.viscous_backward
    drag = "quadratic" if p.exponent == 2.0 else "viscous"
    found |= {
        f"friction.{drag}_coefficient": p.viscous,
        f"friction.forward_{drag}_coefficient": p.viscous,
        f"friction.backward_{drag}_coefficient": back,
        "friction.viscous_exponent": p.exponent,
        "friction.stribeck_velocity": p.stribeck_velocity,
        "friction.fading_exponent": p.stribeck_exponent,
    }
    if p.length:
        found["friction.bristle_stiffness"] = p.forward / p.length
        found["friction.yield_exponent"] = p.bristle_exponent
    return found if p.forward != p.backward else found | {"mechanism.offset": p.offset}


def thinned(series: Series, every: int) -> Series:
    """Return every so many samples of a series."""
    return replace(
        series,
        t=series.t[::every],
        q=series.q[::every],
        force=series.force[::every],
        covariates={name: x[::every] for name, x in series.covariates.items()},
    )


def totals(scores: Sequence[Score], title: str) -> str:
    """Return the counts of some scores."""
    if not scores:
        return ""
    sound = [one for one in scores if not one.fault]
    faulty = [one for one in scores if one.fault]
    covered = [x for one in scores for x in one.covered.values()]
    levels = [x for one in scores for key, x in one.covered.items() if key == "-/level"]
    lines = [f"{title}:"]
    if sound:
        right, equal = sum(one.right for one in sound), sum(one.right or one.equal for one in sound)
        further = [len(one.further) for one in sound if one.further]
        errors = [one.error for one in sound if math.isfinite(one.error)]
        lines += [
            f"  right {right}, right or equal {equal}, of {len(sound)};"
            f" with a false term {len(further)} ({sum(further)} terms);"
            f" accused {sum(bool(one.faults) for one in sound)}",
        ]
        if errors:
            lines.append(f"  error on the second record, median {100 * np.median(errors):.2f} %")
    if faulty:
        lines.append(
            f"  faults named {sum(one.named for one in faulty)} of {len(faulty)};"
            f" with a wrong fault {sum(one.wrong for one in faulty)}"
        )
    if covered:
        lines.append(
            f"  coverage of 95 % intervals {100 * np.mean(covered):.0f} % of {len(covered)}"
            f" (levels {100 * np.mean(levels or [np.nan]):.0f} %)"
        )
        missed = Counter(key for one in scores for key, held in one.covered.items() if not held)
        lines += [f"  outside: {', '.join(f'{k} {n}' for k, n in missed.items())}"] * bool(missed)
    seconds = [one.seconds for one in scores]
    lines.append(
        f"  processor time, median {np.median(seconds):.1f} s, largest {max(seconds):.1f} s;"
        f" hypotheses, median {np.median([one.evaluated for one in scores]):.0f}"
    )
    return "\n".join(lines)


def stressed(truths: Sequence[Truth]) -> list[tuple[str, int, list[Truth]]]:
    """Return variants of truths: name, samples that are left out, and the truths."""

    def varied(**changed: float) -> list[Truth]:
        return [replace(one, plant=replace(one.plant, **changed)) for one in truths]

    return [
        ("as is", 1, list(truths)),
        (f"{RATE // 10} Hz", 10, list(truths)),
        (f"{RATE // 20} Hz", 20, list(truths)),
        ("motion x 0.15", 1, varied(calm=0.15)),
        ("encoder x 20", 1, varied(encoder=2e-3, noise=3e-4)),
        ("force noise x 10", 1, varied(force_noise=0.3)),
    ]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for each record, and totals."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--names", nargs="*", default=None)
    parser.add_argument("--rule", default="F", choices=sorted(RULES))
    parser.add_argument("--stress", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path)
    chosen = parser.parse_args(arguments)
    names = chosen.names or (STRESSED if chosen.stress else [one.name for one in ALL])
    truths = [one for one in ALL if one.name in names]
    variants = stressed(truths) if chosen.stress else [("", 1, truths)]
    kept = []
    for title, every, some in variants:
        job = partial(score, seed=chosen.seed, rule=RULES[chosen.rule], every=every)
        print(title) if title else None
        scores: list[Score] = []
        with ProcessPoolExecutor(max_workers=chosen.jobs) as pool:
            for one in pool.map(job, some) if chosen.jobs > 1 else map(job, some):
                print(one.line, flush=True)
                scores.append(one)
        for part, of in (("24 structures", TRUTHS), ("12 faults", FAULTS), ("8 further", FURTHER)):
            own = [one for one in scores if one.name in {other.name for other in of}]
            print(totals(own, part)) if own else None
        kept += [{"variant": title, **vars(one)} for one in scores]
    if chosen.out:
        chosen.out.write_text(json.dumps(kept, indent=1))


if __name__ == "__main__":
    main()
