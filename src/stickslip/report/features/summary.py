"""The opening: the verdict, the law with its numbers, and what one would quote."""

from stickslip import formatting
from stickslip.formatting import number, parameter_words, with_unit
from stickslip.identification import FeatureFit, StickSlipFeatures
from stickslip.quantities import fields_of
from stickslip.report.core.blocks import Fact
from stickslip.report.core.documents import LawLine, Opening, Section
from stickslip.report.core.markup import label_of
from stickslip.report.features.texts import typeset_lines
from stickslip.selection import FeatureVerdict, share_parts, share_text


def opening_section(verdict: FeatureVerdict, kicker: str, remark: str = "") -> Section:
    """Return the section that a reader may stop after."""
    best, words = verdict.best, verdict.words
    fit = best.fit if best else None
    told = fit is not None and best is not None and not best.dropped
    (lede,) = typeset_lines([f"{words.lede} {words.no_score} {remark}".strip()], verdict)
    opening = Opening(
        kicker=kicker,
        verdict=words.verdict,
        lede=lede,
        law=_law_lines(fit) if fit else (),
        facts=_facts(verdict),
        settles=_settles(fit) if fit and told else typeset_lines(words.settles, verdict),
        cannot_tell=typeset_lines(words.cannot_tell, verdict),
        measure_next=typeset_lines(words.measure_next, verdict),
    )
    return Section(id="verdict", nav="Verdict", heading="", blocks=(opening,))


def _settles(fit: FeatureFit) -> tuple[str, ...]:
    known = [e for e in fit.estimates if e.bounded]
    return tuple(f"{label_of(e)} is {e.plus_minus}." for e in known[:3])


def _law_lines(fit: FeatureFit) -> tuple[LawLine, ...]:
    """Return the parameters of the law, then what of the mechanism was looked for."""
    found = {e.path: e for e in fit.estimates}
    lines = []
    for name, quantity in fields_of(type(fit.law)).items():
        value, estimate = getattr(fit.law, name), found.get(f"friction.{name}")
        if value is None:
            continue
        text = f"{formatting.quantity(value, quantity.unit)}, taken as given"
        text = estimate.plus_minus if estimate else text
        lines.append(LawLine(label=parameter_words(name), formula=f"${quantity.symbol}$ = {text}"))
    for path, estimate in found.items():
        if path.startswith("mechanism."):
            name = parameter_words(path)
            formula = f"${estimate.quantity.symbol}$ = {estimate.plus_minus}"
            lines.append(LawLine(label=f"effective {name}", formula=formula))
    return tuple(lines)


def _facts(verdict: FeatureVerdict) -> tuple[Fact, ...]:
    best, control, features = verdict.best, verdict.control, verdict.features
    facts = []
    if best is not None and best.fit is not None:
        value, doubt = share_parts(best)
        what = (
            "held-out error: frequency, mean and standard deviation of the second half, root mean"
            " square, ± 1 standard error"
        )
        facts.append(Fact(value=value, aside=with_unit(doubt, "%"), what=what))
    if control is not None and control.fit is not None:
        what = "the same error with the mechanism fixed as stated"
        facts.append(Fact(value=share_text(control), what=what))
    facts.append(_motion(features))
    return tuple(facts[:3])


def _motion(features: StickSlipFeatures) -> Fact:
    """Return what tells most of the motion: the time between slips, or how fast it swings."""
    if features.slips > 1:
        spread = formatting.quantity(float(features.waiting_times.std()), "s", 2)
        what = (
            f"median time between slips, with the spread of {features.slips:,} slips; they begin"
            f" at {number(features.break_away)} of the load"
        )
        value = formatting.quantity(features.waiting_time, "s")
        return Fact(value=value, aside=f"± {spread}", what=what)
    ratio = features.frequency / features.natural_frequency
    what = (
        "of the natural frequency √(k/m) of the nominal mass: the force oscillates at"
        f" {formatting.quantity(features.frequency, 'Hz')}"
    )
    return Fact(value=formatting.ratio(ratio), what=what)
