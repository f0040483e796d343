"""The verdict on records in words. Symbols stand between dollar signs, which reports typeset."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from stickslip.experiments import QUANTITIES, Checks
from stickslip.experiments.units import turned
from stickslip.experiments.wording import number
from stickslip.identification import Estimate
from stickslip.selection.experiments import Experiment
from stickslip.selection.record_verdict import RecordCandidate, as_good
from stickslip.selection.scoring import FLOOR
from stickslip.selection.settled import settled_estimates
from stickslip.selection.specifications import REFERENCE
from stickslip.selection.verdict import Wording

__all__ = [
    "error_text",
    "friction_of",
    "in_sentence",
    "outcomes",
    "plus_minus",
    "record_wording",
    "with_doubt",
]

MOST = 3
"""Items of a list at most."""
PLAIN = 1e-4
"""Size below which numbers are written with a power of ten."""
DIGITS = 6
"""Digits of a number at most, however sure it is."""
NAMES = ("Coulomb", "Dahl", "LuGre", "Stribeck")
"""How titles begin that are names."""


def error_text(
    value: float, quantity: str, *, turning: bool = False, among: Sequence[float] = ()
) -> str:
    """Return a score with its unit, lengths in millimetres; angles if what was measured turns.

    One of several scores has the digits that tell it from the others, four more at most.

    Examples
    --------
    >>> error_text(0.00024, "position"), error_text(1.234, "friction")
    ('0.24 mm', '1.23 N')
    >>> [error_text(one, "position", among=(1.02e-5, 1.01e-5)) for one in (1.02e-5, 1.01e-5)]
    ['0.0102 mm', '0.0101 mm']
    """
    unit = turned(QUANTITIES[quantity].unit, turning)
    others = [other for other in among if other != value] if value in among else []
    for more in range(5):
        text = _score_text(value, quantity, unit, more)
        if all(_score_text(other, quantity, unit, more) != text for other in others):
            return text
    return _score_text(value, quantity, unit, 0)


def _score_text(value: float, quantity: str, unit: str, more: int) -> str:
    """Return a score with more digits than usual."""
    least = 0.1 if unit.startswith("rad") else 1.0
    if quantity in {"position", "velocity"} and abs(value) < least:
        value, unit = 1e3 * value, "m" + unit
    size = abs(value)
    digits = 2 if size < 10.0 else 1
    if size >= 0.1:
        text = f"{value:.{digits + more}f}"
    elif more and size >= PLAIN:
        text = f"{value:#.{digits + more}g}"  # zeros that tell it from others stay
    else:
        text = number(value, digits + more)
    return f"{text} {unit}"


def plus_minus(estimate: Estimate) -> str:
    """Return an estimate with its half width, as in ``158 ± 4 N s/m``."""
    unit = "" if estimate.quantity.unit == "1" else f" {estimate.quantity.unit}"
    if not estimate.bounded:
        return f"{number(estimate.value)}{unit}, not bounded"
    return with_doubt(estimate.value, 0.5 * (estimate.high - estimate.low)) + unit


def with_doubt(value: float, half: float) -> str:
    """Return a number to the digits that its half width allows, and this; six digits at most.

    Examples
    --------
    >>> with_doubt(157.36, 3.94), with_doubt(0.021699, 0.0), with_doubt(52.9447753, 1.4e-14)
    ('157 ± 4', '0.0217', '52.9448')
    >>> with_doubt(2.13e-6, 4e-8)
    '(2.13 ± 0.04) × 10⁻⁶'
    """
    if half <= 0.0:
        return number(value)
    if half < 0.5 * 10.0**-DIGITS * abs(value):
        return number(value, DIGITS)  # a doubt below the tolerances of runs says nothing
    size = max(abs(value), half)
    if size < PLAIN:
        power = math.floor(math.log10(size))
        factor = number(10.0**power).partition(" × ")[2]
        return f"({with_doubt(value / 10.0**power, half / 10.0**power)}) × {factor}"
    power = math.floor(math.log10(half))
    digits = -power + (1 if half / 10.0**power < 1.95 else 0)
    if digits <= 0:
        return f"{round(value, digits):.0f} ± {round(half, digits):.0f}"
    return f"{value:.{digits}f} ± {half:.{digits}f}"


def outcomes(candidates: Sequence[RecordCandidate], best: RecordCandidate) -> list[RecordCandidate]:
    """Add to each candidate what became of it."""
    return [replace(c, outcome=_outcome(c, best)) for c in candidates]


def _outcome(c: RecordCandidate, best: RecordCandidate) -> str:
    if c.name == best.name:
        return "chosen"
    if c.fit is None:
        return f"not fitted: {c.dropped}"
    if c.dropped:
        return c.dropped
    more = c.parameters - best.parameters
    if as_good(c, best):
        if more > 0:
            return f"{more} more parameter{'s' if more > 1 else ''}, no gain beyond doubt"
        return "as good within doubt"
    told = _told_apart(c, best)
    if c.name == REFERENCE:
        return "reference" if told else "reference, not told apart"
    if best.score <= 0.0:  # numbers that a law made, without noise
        return "errs where the chosen law does not"
    return f"{c.score / best.score:.1f} × the error" + ("" if told else ", within doubt")


def _told_apart(c: RecordCandidate, best: RecordCandidate) -> bool:
    """Whether a candidate errs more than the chosen one by more than one paired error."""
    return not as_good(c, best, share=math.inf)


def record_wording(
    candidates: Sequence[RecordCandidate],
    best: RecordCandidate,
    without: RecordCandidate | None,
    picks: Mapping[str, str],
    checks: Checks,
    experiments: Sequence[Experiment],
    *,
    scored: str,
) -> Wording:
    """Put a selection on records into words."""
    assert best.fit is not None
    rivals = [c for c in candidates if c.name != best.name and c.fit and not c.dropped]
    equal = [c for c in rivals if as_good(c, best)]
    return Wording(
        verdict=_verdict(best, equal, without),
        lede=_lede(candidates, best, without, scored),
        settles=_settles(best),
        cannot_tell=_cannot_tell(best, candidates, picks),
        measure_next=_measure_next(experiments, candidates, checks),
        no_score="",
    )


def _verdict(
    best: RecordCandidate, equal: Sequence[RecordCandidate], without: RecordCandidate | None
) -> str:
    if without is not None and without.score <= (1.0 + FLOOR) * best.score:
        return "No candidate explains this record better than no friction at all."
    name = friction_of(best.title)
    if best.fit is not None and best.fit.model_errors:
        return f"The model does not hold. {best.fit.model_errors[0].finding} Closest is {name}."
    if best.dropped:
        return f"No candidate is beyond objection; the closest is {name}."
    if best.doubt:
        return f"Use {name} to predict; not all of it is known: {best.doubt}."
    if equal:
        names = " and ".join(in_sentence(c.title) for c in equal[:2])
        verb = "is" if len(equal) == 1 else "are"
        return f"Use {name}; {names} {verb} as good on this record."
    return f"Use {name}."


def friction_of(title: str) -> str:
    """Return the friction of a law as one says it within a sentence.

    Examples
    --------
    >>> friction_of("Direction-dependent"), friction_of("Dahl with exponent")
    ('direction-dependent friction', 'Dahl friction with exponent')
    """
    kind, joint, more = in_sentence(title).partition(" with ")
    noun = "" if kind.endswith("friction") else " friction"
    return f"{kind}{noun}{joint}{more}"


def in_sentence(title: str) -> str:
    """Return a title as it stands within a sentence; names keep their capital.

    Examples
    --------
    >>> in_sentence("Direction-dependent"), in_sentence("Coulomb + viscous")
    ('direction-dependent', 'Coulomb + viscous')
    """
    return title if title.startswith(NAMES) else title[0].lower() + title[1:]


def _lede(
    candidates: Sequence[RecordCandidate],
    best: RecordCandidate,
    without: RecordCandidate | None,
    scored: str,
) -> str:
    assert best.fit is not None
    assert best.validation is not None
    fit = best.fit
    told = partial(
        error_text,
        quantity=fit.problem.quantity,
        turning=fit.measurement.turning,
        among=[c.score for c in candidates if c.name in {best.name, REFERENCE}],
    )
    text = (
        f"It misses what it has not seen by {told(best.score)} ({scored};"
        f" standard error {told(best.validation.error)})."
    )
    usual = next((c for c in candidates if c.name == REFERENCE), None)
    if usual is not None and usual.name != best.name and usual.fit:
        text += (
            f" Coulomb + viscous friction, the usual choice, reaches"
            f" {told(usual.score)} on the same blocks"
            f"{'.' if _told_apart(usual, best) else ', which do not tell the two apart.'}"
        )
    elif without is not None and math.isfinite(without.score):
        text += f" Without friction it would be {told(without.score)}."
    text += "".join(f" {error}" for error in fit.model_errors)
    closer = [c for c in candidates if c.dropped and c.fit and c.score < best.score]
    if closer and not best.dropped:
        first = closer[0]
        text += f" {first.title} misses by {told(first.score)}, but {first.dropped}."
    return text


def _settles(best: RecordCandidate) -> tuple[str, ...]:
    assert best.fit is not None
    known = settled_estimates(best.fit)
    return tuple(f"${e.quantity.symbol}$ = {plus_minus(e)}." for e in known[:MOST])


def _cannot_tell(
    best: RecordCandidate, candidates: Sequence[RecordCandidate], picks: Mapping[str, str]
) -> tuple[str, ...]:
    assert best.fit is not None
    others = _other_picks(best, candidates, picks)
    lines = list(best.fit.sentences)
    for c in candidates:
        for line in c.fit.sentences if c.fit and c.dropped else ():
            if "step" in line or "undetermined" in line:
                lines.append(f"{c.title}: {line}")
                break
    lines.append("How friction behaves at speeds, loads and temperatures that were not recorded.")
    # What else there is to say never crowds out that criteria disagree.
    return (*lines[: MOST - len(others)], *others)


def _other_picks(
    best: RecordCandidate, candidates: Sequence[RecordCandidate], picks: Mapping[str, str]
) -> tuple[str, ...]:
    """Return a sentence where other criteria would pick another law."""
    titles = {c.name: in_sentence(c.title) for c in candidates}
    against: dict[str, list[str]] = {}
    for criterion, name in picks.items():
        if name and name != best.name:
            against.setdefault(titles.get(name, name), []).append(criterion)
    said = [f"{' and '.join(who)} would pick {title}" for title, who in against.items()]
    return (f"Criteria disagree: {'; '.join(said)}.",) if said else ()


def _measure_next(
    experiments: Sequence[Experiment],
    candidates: Sequence[RecordCandidate],
    checks: Checks,
) -> tuple[str, ...]:
    titles = {c.name: c.title for c in candidates}
    lines = []
    for one in experiments[:2]:
        said = ", ".join(
            f"{titles.get(name, name)} {with_doubt(value, one.doubts.get(name, 0.0))}"
            for name, value in one.predicted.items()
        )
        lines.append(f"{one.what} Predicted {one.observed}: {said}.")
    warned = [f.sentence for f in checks.findings if f.severity == "warning"]
    lines += [f"First mend the record: {line}" for line in warned[:1]]
    if not lines:
        lines.append(
            "The same record once more, after an hour of running: what changes is not in the law."
        )
    return tuple(lines[:MOST])
