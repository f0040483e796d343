"""The opening: the verdict, the law with its numbers, and what one would quote."""

from typing import Final

from stickslip import formatting
from stickslip.formatting import number, parameter_words, rounded, with_unit
from stickslip.friction import Coulomb, CoulombViscous, DirectionDependent, QuadraticDrag, Viscous
from stickslip.identification import RecordFit
from stickslip.kinds.joints.joint_verdict import RecordCandidate, RecordVerdict
from stickslip.plots import map_points
from stickslip.quantities import fields_of, turned
from stickslip.report import Fact, LawLine
from stickslip.selection import (
    score_text,
)

PLAIN: Final = (Coulomb, Viscous, CoulombViscous, QuadraticDrag)
"""Laws whose friction is a sum of powers of the speed, which one line says."""
SLOW: Final = 0.05
"""Share of the largest speed below which filtered points mix both directions."""
STEP: Final = 1e-3
"""Steps that slopes are taken with, over half widths."""
FEW: Final = 0.05
"""Share of the points below which friction of a direction is not told at a speed."""


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


def error_fact(verdict: RecordVerdict) -> Fact | None:
    """Return the held-out error of the closest law, None where it has none."""
    best = verdict.closest
    if best.validation is None:
        return None
    scale = verdict.scale
    value, doubt = score_text(scale, best.score, best.score_error)
    what = f"held-out error: {verdict.scored_on}"
    if not doubt:
        return Fact(value=with_unit(value, scale.unit), what=what)
    what += ", ± 1 standard error"
    return Fact(value=value, aside=with_unit(doubt, scale.unit), what=what)
