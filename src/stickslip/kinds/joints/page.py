"""Sections of the page of a selection for several joints: those of each joint, and what is shared.

What is said of one joint is made by the sections of the page of one contact.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from stickslip.experiments import Measurement
from stickslip.formatting import Scale, capital, count, in_words, joined, scale_of
from stickslip.identification import has_trend
from stickslip.kinds.joints.joint_verdict import RecordVerdict
from stickslip.kinds.joints.sections.appendix import dropped_section, record_figure
from stickslip.kinds.joints.sections.certificate import certificate_section as certificate_of
from stickslip.kinds.joints.sections.friction import map_section
from stickslip.kinds.joints.sections.parameters import parameters_section
from stickslip.kinds.joints.sections.reproduce import laws_as_code, lines_of, reproduced
from stickslip.kinds.joints.sections.residuals import residuals_section
from stickslip.kinds.joints.sections.scores import error_column, scores_section
from stickslip.kinds.joints.sections.sections import trials_section
from stickslip.kinds.joints.sections.summary import error_fact, law_lines
from stickslip.kinds.joints.sections.texts import symbols_of
from stickslip.kinds.joints.sections.validation_record import second_section
from stickslip.kinds.joints.verdict import JointVerdict, joint_label, short_verdict
from stickslip.plots import (
    DOTS,
    MapSplit,
    draw_residuals,
    draw_split_map,
    inline_svg,
    joint_figure,
    joint_sizes,
    map_points,
    panel_of,
    postures_of,
    residual_sizes,
    sampled,
    split_sizes,
)
from stickslip.report import (
    Block,
    Column,
    Figure,
    KeyValue,
    KeyValues,
    LawLine,
    Name,
    Number,
    Origin,
    Paragraph,
    Row,
    Section,
    SectionMaker,
    Subheading,
    Table,
    label_of,
    made_sections,
    opening,
    record_and_checks,
    typeset,
)
from stickslip.selection import plain, score_text

MOST: Final = 30
"""Combinations of laws in the table at most."""
PANELS: Final = 3
"""Joints against whose positions residuals are drawn at most."""
LOADED: Final = 0.5
"""Range of the force through the gear over the friction from which maps are split by it."""


def joint_sections(
    verdict: JointVerdict, origin: Origin, remark: str = ""
) -> tuple[SectionMaker, ...]:
    """Return what makes the sections of a page."""
    scales = _scales(verdict)
    return (
        partial(opening_section, verdict, origin.data, remark),
        partial(forces_section, verdict),
        *(
            partial(joint_section, own, name, number, scales, verdict.measurement)
            for number, (name, own) in enumerate(verdict.joints.items(), 1)
        ),
        partial(mechanism_section, verdict),
        partial(combinations_section, verdict),
        partial(checks_section, verdict),
        partial(certificate_section, verdict),
        partial(reproduce_section, verdict, origin),
    )


def opening_section(verdict: JointVerdict, kicker: str, remark: str = "") -> Section:
    """Return the section that a reader may stop after."""
    symbols = symbols_of(c for one in verdict.joints.values() for c in one.candidates)
    laws, facts = [], []
    for name, own in verdict.joints.items():
        fit, label = own.closest.fit, joint_label(name)
        for line in law_lines(fit, own.closest) if fit and verdict.best else ():
            laws.append(LawLine(label=f"{label}: {line.label}", formula=line.formula))
        fact = error_fact(own)
        facts += [replace(fact, what=f"{label}: {fact.what}")] if fact else []
    return opening(verdict.words, kicker, remark, symbols=symbols, law=laws, facts=facts)


def forces_section(verdict: JointVerdict) -> Section | None:
    """Return the section with the forces of all joints, measured and predicted."""
    fit = verdict.closest.fit
    if fit is None:
        return None
    svg = inline_svg(
        joint_figure(fit),
        alt=f"Measured and predicted force of {joined(list(fit.score().joints))}",
        prefix="forces-figure",
        **joint_sizes(fit),
    )
    several = len(verdict.measurement.records())
    which = "" if several == 1 else f" of the first of {several} records"
    caption = (
        f"**Forces of the joints**{which}: measured, and predicted with the fitted mechanism and"
        " the laws of all joints. Both passed the same filter."
    )
    heading = f"Held-out error of {_errors(verdict)}"
    return Section(
        id="forces", nav="Forces", heading=heading, blocks=(Figure(svg=svg, caption=caption),)
    )


def _errors(verdict: JointVerdict) -> str:
    said = []
    for name, own in verdict.joints.items():
        said.append(f"{own.scale.error(own.closest.score)} at the {name}")
    return joined(said)


def _scales(verdict: JointVerdict) -> Mapping[str, Scale]:
    """Return what positions and forces of all joints are shown in, by SI unit."""
    shown: dict[str, list[float]] = {}
    for own in verdict.joints.values():
        record = own.measurement.records()[0]
        for name in {"position", "force"}.intersection(record.quantities()):
            values = np.abs(record.values(name))
            shown.setdefault(record.unit(name), []).append(float(np.max(values)))
    return {unit: scale_of(largest, unit) for unit, largest in shown.items()}


def joint_section(
    verdict: RecordVerdict,
    name: str,
    number: int,
    scales: Mapping[str, Scale],
    whole: Measurement,
) -> Section:
    """Return the section of one joint."""
    symbols = symbols_of(verdict.candidates)
    text = f"{verdict.words.verdict} {verdict.words.lede}"
    blocks: list[Block] = [Paragraph(text=typeset(text, symbols))]
    made = [partial(make, verdict) for make in OF_A_JOINT]
    for part in made_sections(*made, partial(posture_section, verdict, name, whole)):
        blocks += [Subheading(text=part.heading), *part.blocks]
    fit = verdict.closest.fit
    figure = record_figure(verdict, fit, scales=scales) if fit else None
    blocks += [Subheading(text="The record"), figure] if figure else []
    return Section(
        id=f"joint-{number}",
        nav=joint_label(name),
        heading=plain(short_verdict(name, verdict)),
        blocks=tuple(_apart(block, number) for block in blocks),
    )


def split_section(verdict: RecordVerdict) -> Section | None:
    """Return the friction map by thirds of load and temperature, None where neither varies."""
    fit = verdict.closest.fit
    points = map_points(fit) if fit else None
    if fit is None or points is None:
        return None
    velocity, force = (fit.measurement.unit(name) for name in ("velocity", "force"))
    friction = float(np.median(np.abs(points.friction)))
    splits = []
    for name, x in points.beside.items():
        low, high = np.percentile(x, [5.0, 95.0])
        if not high - low > (LOADED * friction if name == "transmitted" else 0.0):
            continue
        gear = name == "transmitted"
        shown, unit = scale_of(x, force) if gear else (1.0, "°C")
        what = "torque" if force == "N m" else "force"
        label = f"by {what} through the gear" if gear else f"by {name}"
        splits.append(MapSplit(label, shown * x, unit))
    if not splits:
        return None
    svg = inline_svg(
        draw_split_map(
            points.velocity,
            points.friction,
            splits,
            shown=sampled(len(points.velocity)),
            units=(velocity, force),
        ),
        alt=f"Friction against velocity, {joined([one.label for one in splits])}",
        prefix="split-figure",
        **split_sizes(len(splits)),
    )
    caption = (
        "**Friction map** in thirds of the record; lines are medians. What goes through the gear is"
        " what the motion takes: weight, inertia and the other joints. Lines that lie apart are"
        " friction that depends on it, or an error of the links, which looks alike."
    )
    return Section(
        id="split",
        nav="By load",
        heading=f"Friction {joined([one.label for one in splits])}",
        blocks=(Figure(svg=svg, caption=caption),),
    )


def posture_section(verdict: RecordVerdict, name: str, whole: Measurement) -> Section | None:
    """Return the residuals by the positions of the other joints, None where these are unknown."""
    fit = verdict.closest.fit
    if fit is None or not np.all(np.isfinite(fit.residual)):
        return None
    residual = verdict.scale.factor * fit.optimum.best.residual
    others = {joint: x for joint, x in postures_of(fit, whole).items() if joint != name}
    if not others:
        return None
    followed = [joint for joint, x in others.items() if has_trend(residual, x, among=len(others))]
    drawn = followed[:PANELS]
    if not drawn:
        names = joined(list(others)).replace(" and ", " or ")
        text = f"No test finds a dependence of the residuals on the position of the {names}."
        return Section(
            id="posture",
            nav="Posture",
            heading="Residuals by posture",
            blocks=(Paragraph(text=text),),
        )
    shown = sampled(len(residual), DOTS)
    panels = []
    for joint in drawn:
        by, unit = scale_of(others[joint], whole.unit(f"position.{joint}"))
        label = f"position of the {joint}, {unit}"
        x, effective = by * others[joint], fit.inference.effective
        panels.append(panel_of(label, x, residual, effective, shown))
    svg = inline_svg(
        draw_residuals(panels, f"residual, {verdict.scale.unit}"),
        alt=f"Residuals of the chosen law against the position of the {joined(drawn)}",
        prefix="posture-figure",
        **residual_sizes(len(panels)),
    )
    caption = (
        "**Residuals by posture**: their mean follows the position of"
        f" {'another joint' if len(followed) == 1 else 'other joints'} (confirmed on held-out"
        " blocks). What the links weigh changes with the posture: an error of the links, and"
        " friction that grows with the load, look like this."
    )
    if len(drawn) < len(followed):
        caption += f" The first {len(drawn)} of these {len(followed)} joints are drawn."
    return Section(
        id="posture",
        nav="Posture",
        heading=f"The residuals depend on the position of the {joined(followed)}",
        blocks=(Figure(svg=svg, caption=caption),),
    )


def _apart(block: Block, number: int) -> Block:
    """Return a block whose drawing defines nothing that another joint's does."""
    if not isinstance(block, Figure):
        return block
    return replace(block, svg=block.svg.replace("-figure-", f"-figure-{number}-"))


def mechanism_section(verdict: JointVerdict) -> Section | None:
    """Return the section on the parameters of the mechanism, None where none was fitted."""
    fit = verdict.closest.fit
    found = [e for e in fit.shown if e.path.startswith("mechanism.")] if fit else []
    if not found:
        return None
    rows = []
    for one in found:
        value, doubt = one.parts
        number = Number(value=value, doubt=doubt, unit=one.quantity.unit)
        aside = "" if one.bounded else one.reason
        rows.append(Row(cells=(Name(text=label_of(one), aside=aside), number)))
    columns = (Column(head="parameter"), Column(head="estimate, 95 % interval", numeric=True))
    text = (
        "All joints share these parameters. They were fitted with every combination of laws anew."
    )
    known = sum(one.bounded for one in found)
    heading = f"{capital(in_words(known))} of {count(len(found), 'parameter')} of the mechanism"
    return Section(
        id="mechanism",
        nav="Mechanism",
        heading=f"{heading} {'is' if known == 1 else 'are'} identified",
        blocks=(Table(columns=columns, rows=tuple(rows), caption=text),),
    )


def combinations_section(verdict: JointVerdict) -> Section:
    """Return the section on all combinations of laws that were compared."""
    scale, rows = verdict.scale, []
    for one in verdict.candidates[:MOST]:
        value, doubt = score_text(scale, one.score, one.score_error)
        cells = (one.title, str(one.parameters), Number(value=value, doubt=doubt), one.outcome)
        rows.append(Row(cells=cells, chosen=one.name == verdict.closest.name))
    columns = (
        Column(head="laws"),
        Column(head="free\nparameters", numeric=True, phone="hide"),
        error_column(scale),
        Column(head="", phone="show"),
    )
    left = len(verdict.candidates) - len(rows)
    caption = (
        "Held-out error of all joints together, each weighted by what a regression with Coulomb"
        " and viscous friction leaves of its force. Laws are not chosen by this table, but joint"
        " by joint, by the error of the force of that joint."
    )
    if left > 0:
        caption += f" {capital(count(left, 'more combination'))} with larger errors not shown."
    sweeps = count(verdict.sweeps, "sweep")
    heading = f"{count(len(verdict.candidates), 'combination')} of laws compared in {sweeps}"
    return Section(
        id="combinations",
        nav="Combinations",
        heading=heading,
        blocks=(Table(columns=columns, rows=tuple(rows), caption=caption),),
    )


def checks_section(verdict: JointVerdict) -> Section | None:
    """Return the section on what was checked of the records."""
    return record_and_checks(verdict.checks)


def certificate_section(verdict: JointVerdict) -> Section | None:
    """Return the section on the computation behind the verdict."""
    section = certificate_of(verdict)
    if section is None:
        return None
    became = "the last changed no choice" if verdict.settled else "the choices had not settled"
    item = KeyValue(
        key="Sweeps",
        value=f"{verdict.sweeps} over {count(len(verdict.joints), 'joint')}; {became}",
        mark="ok" if verdict.settled else "warn",
    )
    return replace(section, blocks=(*section.blocks, KeyValues(items=(item,))))


def reproduce_section(verdict: JointVerdict, origin: Origin) -> Section:
    """Return the section with commands, the selection and the laws as code, and references."""
    fit = verdict.closest.fit
    every = [one for own in verdict.joints.values() for one in own.candidates]
    laws = {type(one.law): one.law for one in every if one.law is not None}
    return reproduced(
        verdict,
        origin,
        lines=_lines(verdict, origin.file),
        law=laws_as_code(dict(fit.law.members)) if fit else "",  # type: ignore[attr-defined]
        laws=tuple(laws.values()),
    )


def _lines(verdict: JointVerdict, rig: str) -> str:
    """Return the lines of Python that make the selection again."""
    first = next(iter(verdict.joints.values()))
    return lines_of(verdict, [one.name for one in first.candidates], rig)


OF_A_JOINT: Final[tuple[Callable[[RecordVerdict], Section | None], ...]] = (
    map_section,
    split_section,
    scores_section,
    second_section,
    trials_section,
    parameters_section,
    residuals_section,
    dropped_section,
)
"""Sections of the page of one contact that stand in the section of a joint."""
