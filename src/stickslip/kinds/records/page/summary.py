"""The opening: the verdict, the law with its numbers, and what one would quote."""

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from stickslip import formatting
from stickslip.errors import InputError
from stickslip.formatting import number, parameter_words, rounded, signed_percent, with_unit
from stickslip.friction import Coulomb, CoulombViscous, DirectionDependent, QuadraticDrag, Viscous
from stickslip.identification import Estimate, RecordFit
from stickslip.kinds.records.design.predictors import Steady
from stickslip.kinds.records.next_measurements import predictor_of
from stickslip.kinds.records.page.texts import paired, rival_of, symbols_of, to_digits
from stickslip.kinds.records.verdict import RecordCandidate, RecordVerdict
from stickslip.plots import map_points
from stickslip.quantities import fields_of, turned
from stickslip.report import Fact, LawLine, Section, label_of, opening
from stickslip.selection import (
    in_sentence,
    limit_of,
    moved_by_errors,
    score_text,
    traded,
)

PLAIN: Final = (Coulomb, Viscous, CoulombViscous, QuadraticDrag)
"""Laws whose friction is a sum of powers of the speed, which one line says."""
SLOW: Final = 0.05
"""Share of the largest speed below which filtered points mix both directions."""
STEP: Final = 1e-3
"""Steps that slopes are taken with, over half widths."""
FEW: Final = 0.05
"""Share of the points below which friction of a direction is not told at a speed."""


def opening_section(verdict: RecordVerdict, kicker: str, remark: str = "") -> Section:
    """Return the section that a reader may stop after."""
    fit = verdict.closest.fit if verdict.best else None
    return opening(
        verdict.words,
        kicker,
        remark,
        symbols=symbols_of(verdict.candidates),
        law=law_lines(fit, verdict.closest) if fit else (),
        facts=_facts(verdict),
        settles=_settles(fit, verdict) if fit else verdict.words.settles,
    )


def _settles(fit: RecordFit, verdict: RecordVerdict) -> tuple[str, ...]:
    lines = [f"{label_of(e)} is {e.plus_minus}.{limit_of(fit, e)}" for e in verdict.settled]
    return tuple([*lines[:2], *levels_at_speed(fit), *lines[2:]][:3])


def levels_at_speed(fit: RecordFit) -> tuple[str, ...]:
    """Return friction at the usual speed, where parameters of the law trade off.

    None of them is known for itself then, but what they make together is. Of a law of two
    directions, those are told whose parameters trade off.
    """
    points, together = map_points(fit), traded(fit)
    if points is None or together & moved_by_errors(fit):
        return ()
    ways: tuple[tuple[float, str, str], ...] = ((0.0, "friction.", ""),)
    if fit.law.directional:
        ways = ((1.0, "friction.forward", " forward"), (-1.0, "friction.backward", " in reverse"))
    lines = []
    for side, paths, way in ways:
        speeds = side * points.velocity if side else np.abs(points.velocity)
        speeds = speeds[speeds > SLOW * float(np.max(np.abs(points.velocity)))]
        known = len(speeds) >= FEW * len(points.velocity)
        if not known or not any(path.startswith(paths) for path in together):
            continue
        speed = float(f"{np.median(speeds):.2g}")  # the value itself is a round one
        value, half = level_at(fit, math.copysign(speed, side))
        if not 0.0 < half < abs(value):
            continue
        at = formatting.quantity(speed, fit.measurement.unit("velocity"), 2)
        unit = fit.measurement.unit("friction")
        lines.append(
            f"Friction{way} at {at} is {with_unit(formatting.estimate(value, half), unit)}."
        )
    return tuple(lines)


def level_at(fit: RecordFit, velocity: float) -> tuple[float, float]:
    """Return the size of friction in steady sliding [N], and the half width of its interval.

    From slopes at the fit and all covariances; infinite where it hangs on what is not known.
    """
    read, candidate = Steady(velocity=velocity, driven=False), predictor_of(fit)
    value, along = read(candidate), []
    for (path, at), half in zip(
        candidate.estimates.items(), fit.inference.half_widths.tolist(), strict=True
    ):
        width = half if math.isfinite(half) else abs(at)
        step = STEP * (min(width, abs(at)) or 1.0)
        try:
            ends = [read(candidate.moved(path, at + side * step)) for side in (1.0, -1.0)]
        except InputError:  # at a bound
            return value, math.inf
        slope = (ends[0] - ends[1]) / (2.0 * step)
        if math.isinf(half) and abs(slope * at) > STEP * abs(value):
            return value, math.inf
        along.append(slope * width)
    table = candidate.correlation
    return value, math.sqrt(max(float(np.array(along) @ table @ np.array(along)), 0.0))


def _known(fit: RecordFit) -> list[Estimate]:
    """Return the bounded estimates that no error of the model moves, the surest first."""
    moved = moved_by_errors(fit)
    known = [
        e for e in fit.estimates if e.bounded and "offset" not in e.path and e.path not in moved
    ]
    return sorted(known, key=lambda e: e.half_width / max(abs(e.value), 1e-300))


def law_lines(fit: RecordFit, of: RecordCandidate | None = None) -> tuple[LawLine, ...]:
    """Return the fitted law with its numbers, and what else was fitted beside it.

    The candidate that it is `of`, if any, knows where values come from that were not fitted.
    """
    law, points = fit.law, map_points(fit)
    load = points.load if points and not points.load_varies else None
    if isinstance(law, DirectionDependent):
        lines = [
            LawLine(label="forward", formula=f"$F$ = {_sum(fit, 'forward_', load)}"),
            LawLine(label="reverse", formula=f"$F$ = −({_sum(fit, 'backward_', load)})"),
        ]
    elif isinstance(law, PLAIN):
        lines = [LawLine(label="against the motion", formula=f"|$F$| = {_sum(fit, '', load)}")]
    else:
        lines = [
            LawLine(label=q.symbol and parameter_words(name), formula=_assigned(fit, name, of))
            for name, q in fields_of(type(law)).items()
            if getattr(law, name) is not None
        ]
    if fit.offset:
        text = with_unit(number(fit.offset, 2), fit.measurement.unit("friction"))
        if fit.offset_estimate is not None:
            text = fit.offset_estimate.plus_minus
        lines.append(LawLine(label="constant force", formula=text))
    for estimate in fit.estimates:
        if estimate.path.startswith("mechanism.") and not estimate.path.endswith("offset"):
            name = parameter_words(estimate.path)
            formula = f"${estimate.quantity.symbol}$ = {estimate.plus_minus}"
            lines.append(LawLine(label=name, formula=formula))
    return tuple(lines)


def _assigned(fit: RecordFit, name: str, of: RecordCandidate | None) -> str:
    quantity, path = fields_of(type(fit.law))[name], f"friction.{name}"
    found = [e for e in fit.estimates if e.path == path]
    if found:
        return f"${quantity.symbol}$ = {found[0].plus_minus}"
    if of and path in of.left_out:
        return f"${quantity.symbol}$ = 0, estimated as 0 and left out"
    value = getattr(fit.law, name)
    said = "taken as given"
    if of and path in of.from_balance:
        said = "found by the force balance and held in the fit"
    elif value == type(fit.law).__dataclass_fields__[name].default:
        said = "as usual"
    units = {one.path: one.quantity.unit for one in fit.held.items}
    text = formatting.quantity(value, units.get(path, quantity.unit))
    return f"${quantity.symbol}$ = {text}, {said}"


def _sum(fit: RecordFit, prefix: str, load: float | None) -> str:
    """Return friction as a sum: level, viscous part, drag; parts that are 0 are left out."""
    v = "$v$" if prefix == "forward_" else "|$v$|"
    speed: tuple[tuple[str, str, str], ...] = (
        ("viscous_coefficient", "N s/m", f" × {v}"),
        ("quadratic_coefficient", "N s^2/m^2", " × $v$²"),
    )
    parts = []
    level = _digits(fit, f"{prefix}kinetic_coefficient", load or 1.0)
    if level:
        parts.append(
            with_unit(level, fit.measurement.unit("friction")) if load else f"{level} × $N$"
        )
    for name, unit, factor in speed:
        value = _digits(fit, prefix + name, 1.0)
        if value:
            parts.append(with_unit(value, turned(unit, fit.measurement.turning)) + factor)
    return " + ".join(parts) or "0"


def _digits(fit: RecordFit, name: str, factor: float) -> str:
    """Return a parameter to the digits that its interval leaves, nothing if it is 0."""
    value = getattr(fit.law, name, None)
    if not value:
        return ""
    found = [e for e in fit.estimates if e.path == f"friction.{name}" and e.bounded]
    if found and found[0].half_width < abs(value):
        return rounded(factor * value, factor * found[0].half_width)
    return number(factor * value)


def _facts(verdict: RecordVerdict) -> tuple[Fact, ...]:
    makers: tuple[Callable[[RecordVerdict], Fact | None], ...] = (
        error_fact,
        _second,
        _factor,
        _telling,
    )
    return tuple(fact for make in makers if (fact := make(verdict)) is not None)[:3]


def error_fact(verdict: RecordVerdict) -> Fact | None:
    """Return the held-out error of the closest law, None where it has none."""
    best = verdict.closest
    if best.validation is None:
        return None
    scale = verdict.scale
    value, doubt = score_text(scale, best.score, best.score_error)
    what = f"held-out error: {verdict.purpose.scored}"
    if not doubt:
        return Fact(value=with_unit(value, scale.unit), what=what)
    what += ", ± 1 standard error"
    return Fact(value=value, aside=with_unit(doubt, scale.unit), what=what)


def _second(verdict: RecordVerdict) -> Fact | None:
    """Return the error on the second record, and whether the choice holds there."""
    on_second = verdict.on_second
    if on_second is None:
        return None
    return Fact(
        value=verdict.scale.error(on_second.error),
        what=f"error on the second record; the choice {on_second.finding} there",
    )


def _factor(verdict: RecordVerdict) -> Fact | None:
    best, other = verdict.best, rival_of(verdict)
    if best is None or other is None or not 0.0 < best.score < math.inf:
        return None
    apart = paired(other, best)
    doubt = ""
    if apart is not None:
        size = number(abs(apart), 2)
        doubt = f"; the paired difference is {size} standard errors"
    ratio = other.score / best.score
    shown = formatting.ratio(ratio)
    if ratio >= 1.05:
        return Fact(
            value=f"{shown} smaller", what=f"than the error of {in_sentence(other.title)}{doubt}"
        )
    names = [in_sentence(one.title) for one in (other, best)]
    return Fact(value=shown, what=f"ratio of the error of {names[0]} to that of {names[1]}{doubt}")


def _telling(verdict: RecordVerdict) -> Fact | None:
    """Return the number that says most: how directions differ, or the surest parameter."""
    fit = verdict.best.fit if verdict.best else None
    if fit is None:
        return None
    law = fit.law
    if isinstance(law, DirectionDependent) and not moved_by_errors(fit):
        ahead, back = law.forward_viscous_coefficient, law.backward_viscous_coefficient
        if ahead > 0.0 and back > 0.0:
            value = signed_percent(back / ahead - 1.0)
            more = "more" if back >= ahead else "less"
            return Fact(value=value, what=f"{more} viscous friction in reverse than forward")
    own = [e for e in _known(fit) if e.path.startswith("friction.")]
    if not own:
        return None
    value, doubt = own[0].parts
    halves = verdict.half_estimates.get(own[0].path)
    what = f"{label_of(own[0])}, with its {own[0].interval} interval"
    if halves and np.all(np.isfinite(halves)):
        first, second = (to_digits(x, own[0]) for x in halves)
        halves_of = "the trials" if fit.halves and fit.halves.several else "the record"
        what += f"; {first} in the first half of {halves_of}, {second} in the second"
    return Fact(value=value, aside=with_unit(doubt, own[0].quantity.unit), what=what)
