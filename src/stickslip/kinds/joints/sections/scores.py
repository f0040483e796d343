"""The scores: every law on blocks that its fit has not seen."""

import math
from typing import Final

from stickslip.formatting import Scale, joined, number, percent, quantity
from stickslip.kinds.joints.joint_verdict import BlockwiseVerdict, RecordCandidate, RecordVerdict
from stickslip.kinds.joints.sections.texts import symbols_of
from stickslip.report import (
    Axis,
    Cell,
    Colour,
    Column,
    Name,
    Number,
    Paragraph,
    Row,
    Section,
    Table,
    candidates_heading,
    error_axis,
    error_plot,
    typeset,
)
from stickslip.selection import ALIKE, APART, NEAR, in_sentence, score_text

NAMES: Final = {
    "held-out blocks": "held-out error",
    "extrapolation": "extrapolation to the last third",
    "training error": "training error",
    "AIC": "AIC",
    "BIC": "BIC",
}


def scores_section(verdict: RecordVerdict) -> Section:
    """Return the section that compares all laws."""
    rows = list(verdict.candidates) + ([verdict.control] if verdict.control else [])
    heading = candidates_heading(len(rows), "held-out blocks")
    scale = verdict.scale
    axis = error_axis((c.score for c in rows), scale, (c.score_error for c in rows))
    second = any(c.second is not None for c in rows)
    columns = (
        Column(head="model"),
        Column(head="free\nparameters", numeric=True, phone="hide"),
        error_column(scale),
        *([Column(head="", axis=axis)] if axis else []),
        _last_column(scale),
        *([_second_column(scale)] if second else []),
        Column(head="outcome", phone="show"),
    )
    table = Table(
        columns=columns,
        rows=tuple(_row(verdict, c, scale, axis=axis, second=second) for c in rows),
        caption=_caption(verdict, axis),
    )
    blocks = (Paragraph(text=_how(verdict)), table)
    return Section(id="scores", nav="Scores", heading=heading, blocks=blocks)


def error_column(scale: Scale) -> Column:
    """Return the column of held-out errors."""
    return Column(head=f"held-out error\n{scale.unit}, ± 1 s.e.", numeric=True)


def _last_column(scale: Scale) -> Column:
    return Column(head=f"last third\n{scale.unit}", numeric=True, phone="label")


def _second_column(scale: Scale) -> Column:
    return Column(head=f"second record\n{scale.unit}", numeric=True, phone="label")


def _row(
    verdict: RecordVerdict, c: RecordCandidate, scale: Scale, *, axis: Axis | None, second: bool
) -> Row:
    is_best = c.name == verdict.closest.name
    value, doubt = score_text(scale, c.score, c.score_error)
    last = c.validation.extrapolation if c.validation else math.nan
    cells: list[Cell] = [
        Name(text=c.title, aside=_aside(verdict, c)),
        str(c.parameters),
        Number(value=value, doubt=doubt),
    ]
    if axis is not None:
        cells.append(
            error_plot(
                c.score, c.score_error, scale, "c1" if is_best else _colour(verdict, c), axis
            )
        )
    cells.append(score_text(scale, last).value if math.isfinite(last) else "—")
    if second:
        cells.append(score_text(scale, c.second.rms).value if c.second else "—")
    outcome = c.outcome or c.dropped or "how much friction matters"
    cells.append(typeset(outcome, symbols_of([c])))
    chosen = verdict.best is not None and is_best
    return Row(cells=tuple(cells), chosen=chosen, muted=bool(c.dropped))


def _aside(verdict: RecordVerdict, c: RecordCandidate) -> str:
    if verdict.control is not None and c.name == verdict.control.name:
        return "control"
    if verdict.reference is not None and c.name == verdict.reference.name:
        return "the usual choice"
    return ""


def _colour(verdict: RecordVerdict, c: RecordCandidate) -> Colour:
    is_reference = verdict.reference is not None and c.name == verdict.reference.name
    return "c2" if is_reference else "muted"


def _how(verdict: RecordVerdict) -> str:
    plan = verdict.plan
    gap = f"with a gap of {quantity(plan.gap, 's', 2)}" if plan.gap > 0.0 else "without a gap"
    scored = verdict.blocks_scored
    block = (
        "the held-out block"
        if scored == plan.folds
        else (f"the held-out block, which is possible for {scored} of them")
    )
    text = (
        f"The record of {quantity(plan.length, 's')} is divided into {plan.folds} blocks, {gap} on"
        " both sides of each. Every candidate is fitted to the other blocks"
    )
    return f"{text} and predicts the force of the joint in {block}."


def _caption(verdict: RecordVerdict, axis: Axis | None) -> str:
    text = "Dot: held-out error. Bar: ± 1 standard error over blocks. " if axis else ""
    text += (
        "Last third: fitted to the data before it, scored on the last third."
        f" Rule of choice: of the laws whose losses are within {number(NEAR)} standard errors of"
        " those of the law with the lowest error, or whose error is within"
        f" {percent(ALIKE)} of it, the one with the"
        " fewest parameters is named. Losses are compared as ratios, block by block. Laws within"
        f" {number(APART)} standard errors are not told apart. "
    )
    if verdict.explained:
        text += (
            "A law that leaves more of the force, over all rows, than the force balance allows is"
            " named only if those that it allows predict worse. "
        )
    return " ".join([text + picks_text(verdict), *verdict.missing]).strip()


def picks_text(verdict: BlockwiseVerdict) -> str:
    """Return what other criteria would pick, for information."""
    titles = {c.name: c.title for c in verdict.candidates}
    best = verdict.closest.name
    agree = [NAMES.get(k, k) for k, name in verdict.picks.items() if name == best]
    against: dict[str, list[str]] = {}
    for key, name in verdict.picks.items():
        if name and name != best:
            against.setdefault(name, []).append(NAMES.get(key, key))
    parts = []
    if agree:
        verb = "picks" if len(agree) == 1 else "pick"
        parts.append(f"{joined(agree)} {verb} the chosen law")
    for name, who in against.items():
        parts.append(f"{joined(who)} would pick {in_sentence(titles.get(name, name))}")
    text = "; ".join(parts)
    note = " (AIC and BIC use the effective sample size)"
    tail = note if "AIC" in verdict.picks or "BIC" in verdict.picks else ""
    return f"{text[0].upper()}{text[1:]}{tail}." if text else ""
