"""The audit of the paper as a page, and what it adds to the page of its rig."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from stickslip.data import Rig, load_rig
from stickslip.friction import SOURCES
from stickslip.identify.kinds import TravelVerdict
from stickslip.paper import sections
from stickslip.paper.paper_audit import PaperAudit, audit
from stickslip.show.formatting import fixed, percent
from stickslip.show.report import (
    Fact,
    Opening,
    Origin,
    Page,
    Section,
    SectionMaker,
    blocks,
    render,
    reproduce,
)


class Beside(NamedTuple):
    """What the page of a selection on the rig of the paper shows beside the selection."""

    remark: str = ""
    """A sentence at the end of the lede."""
    lead: tuple[SectionMaker, ...] = ()
    """Sections after the verdict."""
    extra: tuple[Section | SectionMaker, ...] = ()
    """Sections before what to measure next."""


def beside(rig: Rig, verdict: TravelVerdict) -> Beside:
    """Return where the paper's own comparison errs, for the page of its rig; nothing for others."""
    if not _bundled(rig, verdict):
        return Beside()
    try:
        found = audit(verdict=verdict)
    except blocks.CAUGHT as error:
        return Beside(extra=(blocks.failed_section("paper", error),))
    return Beside(
        remark=_remark(found),
        lead=(partial(sections.excitation_section, found), partial(sections.table_section, found)),
        extra=(
            partial(sections.equation_section, found),
            partial(sections.misprint_section, found),
        ),
    )


def _bundled(rig: Rig, verdict: TravelVerdict) -> bool:
    """Whether a verdict is on the rig of the paper as it comes with the package."""
    paper = load_rig()
    return (
        rig.digest == paper.digest
        and verdict.mechanism == rig.mechanism
        and verdict.measurement is rig.measurement
    )


def _remark(found: PaperAudit) -> str:
    """Say where the published error comes from, if the numbers bear it out."""
    first = found.table[0]
    push, spring = (abs(r.criteria.relative_error or 0.0) for r in first.readings[:2])
    published = first.published.relative_error
    if published is None or not spring < push:
        return ""
    return (
        f"The paper prints an error of {percent(published)} for {first.law.title} friction. With"
        f" the spring released it is {percent(spring)}; the push of 10 N for 0.1 s, of which it"
        f" also writes, gives {percent(push)}, the nearest reading."
    )


def result_sections(found: PaperAudit) -> tuple[Section, ...]:
    """Return the sections whose tables the terminal shows."""
    makers = (
        sections.table_section,
        sections.ranking_section,
        sections.unpublished_section,
        sections.trial_section,
        sections.cart_section,
        sections.choice_section,
    )
    return tuple(maker(found) for maker in makers)


def paper_report(audit: PaperAudit, *, command: str = "stickslip paper") -> str:
    """Return the audit of the paper as one HTML page."""
    makers: tuple[Callable[[PaperAudit], Section], ...] = (
        sections.claim_section,
        sections.table_section,
        sections.ranking_section,
        sections.choice_section,
        sections.excitation_section,
        sections.unpublished_section,
        sections.misprint_section,
        sections.cart_section,
        sections.schematic_section,
        sections.figure_section,
        sections.phenomena_section,
        sections.trial_section,
        sections.rest_section,
        sections.break_away_section,
        sections.equation_section,
        sections.assumption_section,
    )
    opening = _opening(audit)
    origin = Origin(title="", data="", commands=(command,), digest=audit.rig.digest)
    laws = [row.law for row in audit.table]
    page = Page(
        title="The pendulum-driven cart paper, recomputed",
        subject="Tables and figures beside what was printed",
        kicker="audit of a paper",
        sections=blocks.made_sections(
            Section(id="verdict", nav="Verdict", heading="", blocks=(opening,)),
            *(partial(maker, audit) for maker in makers),
            partial(reproduce, origin, laws=laws, cited={"paper": ["rig"]}),
        ),
        footer=blocks.colophon(origin.versions),
    )
    return render(page)


def _opening(found: PaperAudit) -> Opening:
    """Say what the audit found."""
    first = found.table[0]
    push, spring = (r.criteria for r in first.readings[:2])
    return Opening(
        kicker=SOURCES["paper"],
        verdict="One travel cannot rank friction models.",
        lede=(
            "The paper writes that a spring is released, and also that 10 N act for 0.1 s. With the"
            f" spring released, {first.law.title} friction with Table I’s coefficient travels"
            f" {spring.travel:.3f} m, {percent(spring.relative_error or 0.0)} from the measured"
            f" {found.measured:.2f} m. A push gives {push.travel:.3f} m, the reading nearest to the"
            f" printed {first.published.travel or 0.0:.2f} m; that a push stood for the spring in"
            " the simulation is our inference. The other rows depend on values that the paper does"
            " not print."
        ),
        facts=_facts(found),
        settles=found.verdict.words.settles[:2],
        cannot_tell=(
            "Which values the paper used, beyond Table I.",
            *found.verdict.words.cannot_tell[:1],
        ),
        measure_next=found.verdict.words.measure_next[:1],
    )


def _facts(found: PaperAudit) -> tuple[Fact, ...]:
    first = found.table[0]
    push, spring = (r.criteria for r in first.readings[:2])
    exactly = sum(n.value is not None and n.kept and n.reading == "A" for n in found.requirements)
    in_steps = sum(step_travel.reached for step_travel in found.step_travels)
    total = len(found.rig.published)
    return (
        Fact(
            value=percent(abs(spring.relative_error or 0.0)),
            aside=f"printed: {percent(first.published.relative_error or 0.0)}",
            what=f"error of {first.law.title} with Table I’s coefficient, spring released",
        ),
        Fact(
            value=f"{fixed(push.work_in, 3)} J",
            aside=f"and {fixed(spring.work_in, 3)} J",
            what="work of the push of 10 N for 0.1 s, and of the released spring",
        ),
        Fact(
            value=f"{exactly} of {total} rows",
            aside=f"{in_steps} in steps of 10 ms",
            what="of Table II can follow from unpublished values for the push, Table I kept: solved"
            " exactly, and by forward Euler with some rule for rest",
        ),
    )
