"""Whether a late force channel explains measured friction as well as presliding does.

Presliding ends some way after a reversal, a delay some time after it. Where all reversals are
alike, a law of bristles fits friction that was recorded late, and none of its residuals shows it.
So laws without memory are fitted again with the delay, or the lag, that their residuals ask for.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, final

from stickslip.errors import StickslipError
from stickslip.formatting import scale_of, with_unit, within
from stickslip.identification import (
    LateSensor,
    ModelError,
    RecordSettings,
    SensorResponse,
    cure_of,
    late_sensors,
)
from stickslip.selection.choice import NEAR, as_good, errs_more
from stickslip.selection.record_verdict import RecordCandidate
from stickslip.selection.verdict import score_scale
from stickslip.selection.wording import friction_of

PRESLIDING = "delay or presliding"
"""Kind of the error of a model whose presliding may be a late force channel."""
ROUNDS = 3
"""Fits at most with a response: each shows what is left of it."""
CLOSE = 0.02
"""Share of a response that may be left."""
MOST = 3
"""Fits of laws with a response at most, of those whose squares promise to be the least."""
SIMILAR = 2.0
"""Squares that they promise over the least, at most."""
PROMISED = 4.0
"""Squares that they promise over those of the law with presliding, at most: to first order, a large
response promises too little."""
LEAST = 0.10
"""Share of the squared residuals that a response must predict to be fitted."""


@final
@dataclass(frozen=True)
class _Late:
    """A candidate that was fitted with a late force channel."""

    candidate: RecordCandidate
    response: SensorResponse
    interval: tuple[float, float]
    """95 % interval of its time [s]."""
    share: float
    """Share of the squared residuals that it promised to take off."""


Refit: TypeAlias = Callable[[RecordCandidate, RecordSettings], RecordCandidate]


def late_force(
    closest: RecordCandidate,
    scored: Sequence[RecordCandidate],
    settings: RecordSettings,
    refit: Refit,
) -> ModelError | None:
    """Return that a late force channel explains a record no worse than presliding alone, if so."""
    if closest.fit is None or not closest.fit.law.states:
        return None
    promises = [
        (c.residual**2 * (1.0 - min(late.share, 1.0)), number, c, late)
        for number, c in enumerate(scored)
        if c.fit is not None and not c.fit.law.states
        for late in late_sensors(c.fit)
        if late.share >= LEAST
    ]
    promises = [one for one in promises if one[0] <= PROMISED * closest.residual**2]
    promises.sort(key=lambda one: one[:2])
    tried = [
        found
        for left, _, simple, late in promises[:MOST]
        if left <= SIMILAR * promises[0][0]
        if (found := _settled(simple, late, settings, refit)) is not None
    ]
    own = max(late_sensors(closest.fit), key=lambda one: one.share, default=None)
    if own is not None and own.share >= LEAST:
        promised = closest.residual**2 * (1.0 - min(own.share, 1.0))
        if all(promised < one.candidate.score**2 for one in tried):
            found = _settled(closest, own, settings, refit)
            tried += [] if found is None else [found]
    if not tried:
        return None
    best = min(tried, key=lambda one: one.candidate.score)
    rival = best.candidate
    better = rival.score < closest.score and not as_good(closest, rival)
    worse = rival.name == closest.name or errs_more(rival, closest, errors=NEAR)
    if worse and not better:
        return None
    return _error(closest, best, better=better)


def _settled(
    simple: RecordCandidate, late: LateSensor, settings: RecordSettings, refit: Refit
) -> _Late | None:
    """Return a candidate fitted with the response that its residuals ask for."""
    response, more = settings.response, late.response
    best: _Late | None = None
    for _ in range(ROUNDS):
        response = SensorResponse(
            delay=response.delay + more.delay, lag=max(response.lag + more.lag, 0.0)
        )
        own = replace(settings, friction_delay=response.delay, friction_lag=response.lag)
        try:
            rival = refit(simple, own)
        except StickslipError:
            break
        if rival.fit is None or rival.validation is None:
            break
        if best is not None and rival.score >= best.candidate.score:
            break
        shift = response.late - late.response.late
        ends = late.interval[0] + shift, late.interval[1] + shift
        best = _Late(rival, response, ends, late.share)
        left = [one for one in late_sensors(rival.fit) if one.kind == late.kind]
        if (
            not left
            or left[0].share <= 0.0
            or abs(left[0].response.late) < CLOSE * abs(response.late)
        ):
            break
        more = left[0].response
    return best


def _error(closest: RecordCandidate, late: _Late, *, better: bool) -> ModelError:
    assert closest.fit is not None
    rival, response = late.candidate, late.response
    size = _sized(response.late, *late.interval)
    unit = closest.fit.measurement.unit("friction")
    scale = score_scale([closest.score, rival.score], unit)
    if response.delay and response.lag:
        channel = f"a delay and a filter of the force channel, which add up to {size}"
    elif response.lag:
        channel = f"a filter of the force channel with a time constant of {size}"
    else:
        channel = f"a delay of the force channel of {size}"
    finding = (
        f"With {channel}, {friction_of(rival.title)} explains the record"
        f" {'better' if better else 'as well'}: held-out error {scale.error(rival.score)},"
        f" {friction_of(closest.title)} without it {scale.error(closest.score)}."
    )
    return ModelError(
        kind=PRESLIDING,
        finding=finding,
        consequence=(
            "After a reversal, presliding ends at a displacement, and a late channel after a time:"
            " reversals at other accelerations, or a step of force on the sensor alone, tell them"
            f" apart. {cure_of(response)}"
        ),
        effect=response.late,
        interval=late.interval,
        share=late.share,
    )


def _sized(value: float, low: float, high: float) -> str:
    """Return a time with its interval, both to the same digit."""
    scale = scale_of([value], "s")
    shown = within(*(scale.factor * one for one in (value, low, high)))
    return f"{with_unit(shown, scale.unit)} (95 % interval {scale.interval(low, high)})"
