"""Verdicts do not turn on the last bits, which differ between processors.

Tests marked `rounding` run again under other kernels of linear algebra, and with machine code for
any x86-64: ``make kernels``.
"""

import dataclasses
import re
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import pytest
from benchmarks import closed_loop_axes, joints, pulled_sliders, servos
from benchmarks.band_truths import decays, maps, records, tables, travels

from stickslip import Measurement, select
from stickslip.errors import StickslipError

SMALL = 1e-12
"""Relative change of each reading: far below what any sensor resolves, and above rounding."""
SEED = 40_98


def changed(measurement: Measurement, random: np.random.Generator) -> Measurement:
    """Return a measurement whose readings are off by what no sensor sees."""

    def of(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {name: of(item) for name, item in value.items()}
        if isinstance(value, tuple):
            return tuple(changed(item, random) for item in value)
        if isinstance(value, Measurement):
            return changed(value, random)
        if isinstance(value, np.ndarray | float):
            return value * (1.0 + SMALL * random.uniform(-1.0, 1.0, np.shape(value)))
        return value

    names = (
        "position", "velocity", "force", "friction", "load", "spring_force", "pull", "voltage",
        "current", "travel", "mean_velocity", "inputs", "joints", "trials",
    )  # fmt: skip
    return dataclasses.replace(
        measurement, **{name: of(getattr(measurement, name)) for name in names}
    )


Asked = tuple[Any, Measurement, dict[str, Any]]


def drawn(of: Any, number: int) -> Asked:
    rig = of.drawn(number, SEED)
    settings = {"vary": ["friction.*", *rig.unknown]} if rig.unknown else {}
    if rig.t_end is not None:
        settings["t_end"] = rig.t_end
    return rig.mechanism, rig.measurement, settings


def servo(number: int) -> Asked:
    made = servos.draw(np.random.default_rng([SEED, number]))
    record = servos.recorded(made)
    return made.rig, record, {"vary": ["friction.*", "mechanism.drive.resistance"]}


def closed_loop(number: int) -> Asked:
    random = np.random.default_rng([SEED, number])
    rig = closed_loop_axes.draw(random, "stribeck")
    return rig.axis, closed_loop_axes.record(rig, random), {"route": "balance"}


def arm(number: int) -> Asked:
    rig, _, (record, _), _ = joints.drawn("clean", number, SEED)
    return rig, record, {"vary": joints.LINEAR, "settings": joints.SETTINGS}


def steps(number: int) -> Asked:
    truth = pulled_sliders.STEPPED[number % len(pulled_sliders.STEPPED)]
    made = pulled_sliders.steps(np.random.default_rng([SEED, number]), truth)
    return made.given, made.record, {}


def slider(number: int) -> Asked:
    rig = pulled_sliders.Rig(SEED, number)
    return rig.told, rig.record(rig.run(), rig.block), {}


KINDS: Mapping[str, tuple[Callable[[int], Asked], int]] = {
    "table": (partial(drawn, tables), 14),
    "map": (partial(drawn, maps), 4),
    "record": (partial(drawn, records), 8),
    "decay": (partial(drawn, decays), 5),
    "travels": (partial(drawn, travels), 3),
    "closed loop": (closed_loop, 1),
    "servo": (servo, 1),
    "arm": (arm, 1),
    "steps": (steps, 2),
    "slider": (slider, 1),
}
"""Forty measurements of all kinds, by how many of each."""


def said(mechanism: Any, measurement: Measurement, settings: Mapping[str, Any]) -> str:
    """Return the sentences of a verdict, or why there is none."""
    try:
        verdict = select(mechanism, None, measurement, **settings)
    except StickslipError as error:
        return f"refused: {error}"
    words = getattr(verdict, "words", None)
    if words is None:
        return str(verdict).partition("\n")[0]
    asserted = [
        finding.sentence for finding in getattr(verdict, "findings", ()) if finding.asserted
    ]
    return "\n".join([words.verdict, words.lede, *asserted, *words.cannot_tell])


NUMBER = re.compile(r"−?\d+(?:,\d{3})*(?:\.\d+)?")


WORST = re.compile(r" in the median, and to ± [^;(]*(?=;| \()")
"""How wide a band is at its widest: few draws of one place decide that, and whether it is said."""


def differ(words: str, others: str) -> bool:
    """Return whether sentences differ by more than a tenth, or a last digit, of their numbers.

    Where a band is as wide in both directions, it is at its widest in either.
    """
    words, others = WORST.sub("", words), WORST.sub("", others)
    if NUMBER.sub("#", words) != NUMBER.sub("#", others):
        return True
    for x, y in zip(NUMBER.findall(words), NUMBER.findall(others), strict=True):
        digit = 10.0 ** -max(len(each.partition(".")[2]) for each in (x, y))
        one, other = (float(each.replace(",", "").removeprefix("−")) for each in (x, y))
        if abs(one - other) > max(0.1 * max(one, other), 1.01 * digit):
            return True
    return False


def test_words_and_numbers_differ_as_a_reader_would_say():
    words = "Use Stribeck friction. It is known to ± 1.2 %, from 10 to 1,000 N."
    assert not differ(words, words.replace("1.2", "1.3"))
    assert differ(words, words.replace("1.2", "1.9"))
    assert differ(words, words.replace("Stribeck", "Coulomb"))
    wide = (
        "known to ± 2.0 mm in the median, and to ± 5 mm at worst, at 0.2 m; with 0.3 m it is 1 m."
    )
    assert not differ(wide, "known to ± 2.0 mm; with 0.3 m it is 1 m.")
    assert differ(wide, "known to ± 3.0 mm; with 0.3 m it is 1 m.")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("make", "number"),
    [
        pytest.param(make, number, id=f"{kind} {number}")
        for kind, (make, count) in KINDS.items()
        for number in range(count)
    ],
)
def test_readings_that_no_sensor_tells_apart_have_the_same_verdict(make, number):
    mechanism, measurement, settings = make(number)
    random = np.random.default_rng(SEED)
    words = said(mechanism, measurement, settings)
    others = said(mechanism, changed(measurement, random), settings)
    assert not differ(words, others), f"{others}\nin place of\n{words}"
