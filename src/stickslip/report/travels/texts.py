"""Words and numbers that several sections of the report share."""

from typing import Final

import numpy as np

from stickslip.friction import FrictionLaw
from stickslip.identification import Estimate
from stickslip.quantities import fields_of
from stickslip.report import numbers
from stickslip.selection import Candidate, TravelVerdict

__all__ = [
    "assumptions",
    "counted",
    "estimate_range",
    "estimate_value",
    "largest_difference",
    "measured_band",
    "quantity_value",
    "slip_and_rate",
    "step_text",
    "travels",
]

WORDS: Final = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
SAMPLES: Final = 4000
BELOW: Final = {"m": 1.0, "m/s": 0.1, "rad": 0.1, "rad/s": 0.1}
"""What is shown in thousandths: values below these."""


def counted(count: int) -> str:
    """Return a small number in words.

    Examples
    --------
    >>> counted(5), counted(25)
    ('five', '25')
    """
    return WORDS[count] if 0 <= count < len(WORDS) else str(count)


def quantity_value(value: float, unit: str, digits: int = 3) -> str:
    r"""Return a value with its unit, in millimetres where metres would need leading zeros.

    Examples
    --------
    >>> quantity_value(0.05, "m/s", 2), quantity_value(0.25, "1", 2)
    ('50\xa0mm/s', '0.25')
    """
    if 1e-6 <= abs(value) < BELOW.get(unit, 0.0):
        value, unit = value * 1e3, f"m{unit}"
    plain = f"{value:.{digits}g}"
    is_short = "e" not in plain and 0.0 < abs(value) < 1e4
    text = plain.replace("-", numbers.fixed(-1, 0)[0]) if is_short else _long(value, digits)
    return numbers.with_unit(text, "" if unit == "1" else unit)


def _long(value: float, digits: int) -> str:
    return numbers.significant(value, digits) if value else "0"


def estimate_value(estimate: Estimate) -> str:
    """Return the value of an estimate, ending where the digits of its interval end."""
    if not estimate.bounded or estimate.low == estimate.high:
        return numbers.significant(estimate.value, 3)
    ends = numbers.interval(estimate.low, estimate.high).split(" to ")
    decimals = {len(end.partition(".")[2]) for end in ends}
    # An interval over many powers of ten has no common last digit.
    if len(decimals) > 1 or any("×" in end for end in ends):
        return numbers.significant(estimate.value, 2)
    return numbers.fixed(estimate.value, decimals.pop())


def estimate_range(estimate: Estimate) -> str:
    """Return the interval of an estimate, or why it has no end."""
    if estimate.bounded:
        return numbers.interval(estimate.low, estimate.high)
    text = numbers.interval(estimate.low, estimate.high)
    return f"{text}: {estimate.reason}" if estimate.reason else text


def assumptions(candidate: Candidate) -> str:
    """Return the parameters that were neither measured nor fitted, with their values."""
    law: FrictionLaw = candidate.fit.law if candidate.fit else candidate.law
    quantities = fields_of(type(law))
    parts = [
        f"${quantities[name].symbol}$ {quantity_value(value, quantities[name].unit)}"
        for name in candidate.assumed
        for value in [getattr(law, name)]
        if value  # a viscous part of 0 is the absence of an assumption
    ]
    switch = ["held at its first stop"] if getattr(law, "static_switch", False) else []
    return ", ".join([*parts, *switch]) or "nothing"


def step_text(dt: float) -> str:
    r"""Return a time step with a unit in which it has few zeros.

    Examples
    --------
    >>> step_text(0.01), step_text(2e-6), step_text(0.5)
    ('10\xa0ms', '2\xa0µs', '500\xa0ms')
    """
    factor, unit = next(
        ((factor, unit) for factor, unit in ((1.0, "s"), (1e3, "ms")) if dt * factor >= 0.999),
        (1e6, "µs"),
    )
    return numbers.with_unit(f"{dt * factor:g}", unit)


def slip_and_rate(verdict: TravelVerdict) -> tuple[str, str]:
    """Return the names of the slipping coordinate and of its rate."""
    slip = verdict.mechanism.contacts()[0].slip
    return slip, verdict.mechanism.rates[verdict.mechanism.coordinates.index(slip)]


def travels(verdict: TravelVerdict) -> tuple[float, ...]:
    """Return the measured travels [m], one a record."""
    return tuple(
        float(np.mean(record.travel))
        for record in verdict.measurement.records()
        if record.travel is not None
    )


def measured_band(verdict: TravelVerdict) -> tuple[float, float] | None:
    """Return the range of the first measured travel [m], None if it has no stated doubt."""
    record = verdict.measurement.records()[0]
    half = float(record.uncertainty.get("travel", 0.0))
    if not half or record.travel is None:
        return None
    travel = travels(verdict)[0]
    return travel - half, travel + half


def largest_difference(verdict: TravelVerdict, candidate: Candidate) -> float | None:
    """Return how far a law is from the chosen one on the way at most [m]."""
    if verdict.best is None or verdict.best.run is None or candidate.run is None:
        return None
    slip, _ = slip_and_rate(verdict)
    one, other = verdict.best.run, candidate.run
    last = min(one.span[1], other.span[1])
    times = np.union1d(np.linspace(0.0, last, SAMPLES), one.t[one.t <= last])
    return float(np.max(np.abs(one.at(times)[slip] - other.at(times)[slip])))
