"""The pages: the audit of the paper, and the selection report of a rig."""

import math
from collections.abc import Mapping, Sequence
from importlib.metadata import version

from stickslip.experiments import Rig, load_rig
from stickslip.friction import SOURCES
from stickslip.identification.travel import trials_of
from stickslip.paper.audit import PaperAudit, audit
from stickslip.paper.sections import (
    cart_section,
    choice_section,
    equation_section,
    excitation_section,
    figure_sections,
    table_section,
    unpublished_section,
)
from stickslip.paper.sections.common import counted
from stickslip.report import (
    Code,
    Fact,
    Opening,
    Page,
    Paragraph,
    References,
    Section,
    render,
)
from stickslip.report.numbers import fixed, percent
from stickslip.report.selection import selection_page
from stickslip.report.selection.closing import law_references
from stickslip.report.selection.texts import step_text
from stickslip.report.versions import versions
from stickslip.selection import FixedStepRow, TravelVerdict, compare_fixed_steps
from stickslip.simulation import simulate
from stickslip.solver import FixedStep
from stickslip.trajectory import Trajectory

__all__ = ["paper_report", "rig_report"]

STEPS = (50.0, 500.0)
"""Fixed steps from the start to the stop, in the two runs that are compared."""


def rig_report(rig: Rig, verdict: TravelVerdict, *, command: str = "stickslip select") -> str:
    """Return the selection report of a rig as one HTML page.

    For the bundled rig of the paper it also shows where the paper's own comparison errs.

    Parameters
    ----------
    rig : Rig
        What was measured.
    verdict : TravelVerdict
        What `select` found.
    command : str
        The command that made it, for those who want to repeat it.
    """
    lead: Sequence[Section] = ()
    extra: Sequence[Section] = ()
    remark = ""
    if _bundled(rig, verdict):
        found = audit(verdict=verdict)
        lead = (excitation_section(found), table_section(found))
        extra = (equation_section(found),)
        remark = _remark(found)
    steps, runs = _fixed_steps(verdict, t_end=rig.t_end)
    page = selection_page(
        verdict,
        subject=rig.subject,
        kicker=rig.title,
        remark=remark,
        lead=lead,
        extra=extra,
        reproduce=(command,),
        versions=versions(),
        digest=rig.digest,
        fixed_steps=steps,
        fixed_step_runs=runs,
    )
    return render(page)


def _bundled(rig: Rig, verdict: TravelVerdict) -> bool:
    """Whether a verdict is on the rig of the paper as it comes with the package."""
    paper = load_rig()
    return (
        rig.digest == paper.digest
        and verdict.mechanism == rig.mechanism
        and verdict.measurement is rig.measurement
    )


def _fixed_steps(
    verdict: TravelVerdict, *, t_end: float
) -> tuple[Sequence[FixedStepRow], Mapping[str, Trajectory]]:
    """Run the chosen law as a block diagram, for comparison."""
    best = verdict.best
    if best is None or best.fit is None:
        return (), {}
    law, trial = best.fit.law, trials_of(verdict.mechanism, verdict.measurement)[0]
    stop = best.criteria.stop_time if best.criteria else None
    last = min(2.0 * stop, t_end) if stop else t_end
    steps = tuple(nice((stop or t_end / 20.0) / parts) for parts in STEPS)
    runs = {
        f"{step_text(steps[0])}, {'stick rule' if rule else 'no stick rule'}": simulate(
            trial.mechanism,
            law,
            t_end=last,
            y0=trial.initial,
            solver=FixedStep(dt=steps[0], stick_rule=rule),
        )
        for rule in (False, True)
    }
    rows = compare_fixed_steps(trial.mechanism, law, t_end=last, y0=trial.initial, steps=steps)
    return rows, runs


def nice(value: float) -> float:
    """Return the number of the series 1, 2, 5, 10, ... that is nearest as a ratio.

    Examples
    --------
    >>> nice(0.0095), nice(0.0031), nice(40.0)
    (0.01, 0.002, 50.0)
    """
    power = math.floor(math.log10(value))
    series = [float(f"{digit}e{power}") for digit in (1, 2, 5, 10)]
    return min(series, key=lambda step: abs(math.log(step / value)))


def _remark(found: PaperAudit) -> str:
    """Say where the published error comes from, if the numbers bear it out."""
    first = found.table[0]
    push, spring = (abs(r.criteria.relative_error or 0.0) for r in first.readings[:2])
    published = first.published.relative_error
    if published is None or not spring < push:
        return ""
    return (
        f"The published {percent(published)} error of {first.law.title} friction comes from"
        f" simulating a push where the rig releases a spring; released, it is {percent(spring)}."
    )


def paper_report(found: PaperAudit, *, command: str = "stickslip paper") -> str:
    """Return the audit of the paper as one HTML page."""
    page = Page(
        title="The pendulum-driven cart paper, recomputed",
        subject="Tables and figures beside what was printed",
        kicker="audit of a paper",
        sections=(
            Section(id="verdict", nav="Verdict", heading="", blocks=(_opening(found),)),
            excitation_section(found),
            table_section(found),
            unpublished_section(found),
            equation_section(found),
            cart_section(found),
            choice_section(found),
            *figure_sections(found),
            _closing(found, command),
        ),
        footer=f"Written by stickslip {version('stickslip')}. No network, no scripts.",
    )
    return render(page)


def _opening(found: PaperAudit) -> Opening:
    """Say what the audit found."""
    first = found.table[0]
    push, spring = (r.criteria for r in first.readings[:2])
    near = [
        row for row in found.table if abs(row.readings[1].criteria.relative_error or 0.0) <= 0.05
    ]
    reached = [need for need in found.requirements if need.value is not None]
    return Opening(
        kicker=SOURCES["paper"],
        verdict=_sentence(len(near), len(reached)),
        lede=(
            f"With the spring released, {counted(len(near))} of {counted(len(found.table))} models"
            f" come within 5 % of the measured {found.measured:.2f} m. The paper simulated a push"
            f" of 10 N for 0.1 s, which does {push.work_in:.3f} J of work where the spring does"
            f" {spring.work_in:.3f} J. One travel cannot rank these models."
        ),
        facts=_facts(found, len(reached)),
        settles=tuple(found.verdict.words.settles[:3]),
        cannot_tell=(
            "Which values the paper used: it prints no stiffness, Stribeck velocity or viscous"
            " coefficient.",
            *found.verdict.words.cannot_tell[:2],
        ),
        measure_next=tuple(found.verdict.words.measure_next[:3]),
    )


def _facts(found: PaperAudit, reached: int) -> tuple[Fact, ...]:
    first = found.table[0]
    push, spring = (r.criteria for r in first.readings[:2])
    return (
        Fact(
            value=percent(abs(spring.relative_error or 0.0)),
            aside=f"not {percent(first.published.relative_error or 0.0)}",
            what=f"error of {first.law.title} with Table I's coefficient, spring released",
        ),
        Fact(
            value=f"{fixed(push.work_in, 3)} J",
            aside=f"not {fixed(spring.work_in, 3)} J",
            what="work of the push that was simulated, and of the spring that was released",
        ),
        Fact(
            value=f"{reached} of {len(found.requirements)} rows",
            aside="",
            what="of Table II can be had by choosing an unpublished value",
        ),
    )


def _sentence(near: int, reached: int) -> str:
    """Return the finding, or the topic if the numbers do not bear it out."""
    if near >= 2 and reached >= 2:
        return (
            "The ranking of Table II can be produced by the excitation and by unpublished values."
        )
    return "Table II and the equations of the paper, recomputed."


def _closing(found: PaperAudit, command: str) -> Section:
    used = ", ".join(f"{name} {number}" for name, number in versions().items())
    return Section(
        id="again",
        nav="Reproduce and cite",
        heading="Reproduce and cite",
        blocks=(
            Code(text=f"$ {command}"),
            Paragraph(text=f"Versions: {used}. Rig: sha256 `{found.rig.digest[:16]}`."),
            References(items=law_references((row.law for row in found.table), {"paper": ["rig"]})),
        ),
    )
