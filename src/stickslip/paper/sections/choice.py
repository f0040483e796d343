"""The paper's Fig. 11: the cart with the law that was chosen."""

import math

import numpy as np

from stickslip.formatting import fixed, number, percent, quantity, significant
from stickslip.paper.audit import PaperAudit
from stickslip.paper.cart import KINETIC, CartRun, CartStudy
from stickslip.paper.sections.common import values_of
from stickslip.plots import MotionView, draw_motion, inline_svg
from stickslip.report import Caption, Column, Figure, Name, Paragraph, Row, Section, Table

STROKE = (1.15, 0.7)
"""Begin and end of the stroke that is shown, in cycles before the end."""


def choice_section(found: PaperAudit) -> Section:
    """Fig. 11: the cart with the law that the selection names, and with the paper's choice."""
    study = found.cart
    return Section(
        id="cart-choice",
        nav="The cart" if found.own else "Fig. 11, the choice",
        heading=_heading(study),
        blocks=(
            Paragraph(text=_text(found)),
            _table(study),
            _figure(study, own=found.own),
            Caption(text=f"{_return_text(found)} {_normal_text(study)}"),
        ),
    )


def _heading(study: CartStudy) -> str:
    travels = {one.key: quantity(one.travels[-1], "m") for one in study.choices}
    if "selected" not in travels:
        return f"{study.run('paper').law.title} friction moves the cart {travels['paper']} a cycle"
    return (
        f"The cart moves {travels['selected']} a cycle with the law that select names, and"
        f" {travels['paper']} with the paper’s example"
    )


def _text(found: PaperAudit) -> str:
    named = [one for one in found.cart.choices if one.key == "selected"]
    chosen = f"names {named[0].law.title}" if named else "names no law"
    swing = (
        "Cart and swing are those assumed for the page of the paper, as listed above."
        if found.own
        else "Cart and swing are those used for Fig. 2 above, which are ours; so the printed figure"
        " can be compared in kind only."
    )
    return (
        "The paper selects Coulomb or Coulomb + viscous friction, and takes the latter “for"
        " instance” into the cart, with a viscous coefficient that it does not print:"
        f" {number(found.values.viscous)} N s/m is taken here, as in the tables above. `select`"
        f" {chosen} for the rig, with the values that the measurement gives. {swing}"
    )


def _label(one: CartRun) -> str:
    return "by select" if one.key == "selected" else "the paper’s example"


def _table(study: CartStudy) -> Table:
    columns = (
        Column(head="law"),
        Column(head="first cycle\nmm", numeric=True, phone="label", label="first cycle, mm"),
        Column(head="last cycle\nmm", numeric=True, phone="label", label="last cycle, mm"),
        Column(
            head="back-slip\nmm/cycle", numeric=True, phone="label", label="back-slip, mm per cycle"
        ),
        Column(
            head="lowest normal\nforce, N",
            numeric=True,
            phone="label",
            label="lowest normal force, N",
        ),
    )
    rows = tuple(
        Row(
            cells=(
                Name(text=f"{one.law.title}, {_label(one)}", aside=values_of(one.law)),
                fixed(1e3 * one.travels[0], 2),
                fixed(1e3 * one.travels[-1], 2),
                _nothing_or(one.mean_return),
                fixed(one.least_normal_force, 3),
            ),
            chosen=one.key == "selected",
        )
        for one in study.choices
    )
    return Table(columns=columns, rows=rows)


def _nothing_or(way: float) -> str:
    return "none" if way == 0.0 else significant(1e3 * way, 2)


def _figure(study: CartStudy, *, own: bool) -> Figure:
    runs = {_label(one): one.run for one in study.choices}
    last = study.choices[0].run.span[1]
    stroke = (last - STROKE[0] * study.period, last - STROKE[1] * study.period)
    views = [
        MotionView(column="x", title="displacement", span=(0.0, last)),
        MotionView(column="v", title="velocity", span=stroke),
    ]
    apart = ""
    if len(runs) > 1:
        views.append(
            MotionView(column="v", title="difference in velocity", span=stroke, difference=True)
        )
        apart = ", and by how much that of the paper’s example differs"
    return Figure(
        svg=inline_svg(
            draw_motion(runs, views=views),
            alt="Displacement and velocity of the cart with the law that select names, and with"
            " the paper’s",
            prefix="fig11",
            wide=(880, 300),
            narrow=(358, 600),
        ),
        caption=f"**{'' if own else 'In place of Fig. 11. '}The cart under Coulomb + viscous"
        " friction**, the paper’s example, and under the law that select names, both solved"
        f" exactly: displacement in all cycles, velocity in the last whole stroke{apart}.",
    )


def _return_text(found: PaperAudit) -> str:
    """Say whether the cart slips back, and what keeps it from it."""
    study = found.cart
    back = [one for one in study.choices if one.mean_return > 0.0]
    if back:
        ways = ", ".join(f"{_label(one)}: {quantity(one.mean_return, 'm', 2)}" for one in back)
        return f"The cart slips back in a cycle: {ways}."
    asked = max(largest_pull(one) for one in study.choices)
    return (
        f"The cart never slips back: at rest the swing pulls it back with up to {percent(asked)} of"
        " the normal force, less than friction can hold. At a lower level of"
        f" {KINETIC:g} it does slip back, as the tables above show."
    )


def largest_pull(one: CartRun) -> float:
    """Return the largest backward pull on the resting cart, over the normal force.

    NaN if it never rests.
    """
    first, last = one.run.span
    seen = one.run.at(np.union1d(np.linspace(first, last, 20_000), one.run.t))
    resting = seen["mode"] == 0
    pulls = -seen["friction"][resting] / seen["normal_force"][resting]
    return float(max(pulls, default=math.nan))


def _normal_text(study: CartStudy) -> str:
    least = min(one.least_normal_force for one in study.choices)
    return (
        "The normal force is the same with every law, since the swing is prescribed; it falls to"
        f" {percent(least / study.weight)} of the weight."
    )
