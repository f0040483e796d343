"""Sections on the cart and on rest: Figs 2 and 11, rules for rest, break-away levels that vary."""

import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from stickslip.paper.paper_audit import PaperAudit
from stickslip.paper.rigs import CYCLES, KINETIC, STEP, CartRun, CartStudy, RestRule, Share
from stickslip.paper.sections.common import (
    BACK_SLIP,
    FIRST_CYCLE,
    LOWEST_VELOCITY,
    back_slip_text,
    values_of,
)
from stickslip.show import plots, report
from stickslip.show.formatting import (
    fixed,
    in_words,
    interval,
    joined,
    number,
    percent,
    quantity,
    significant,
    with_unit,
)

# The paper's cart: the printed equations and exactly (Fig. 2), then a chosen law (Fig. 11).

STEP_TEXT = f"steps of {1e3 * STEP:g} ms"
CAUSES = {
    "no-stick-rule": ("no rule for rest", "without and with the stick rule, in {step}"),
    "step": ("the time step", "{step} against located events, both with the stick rule"),
    "friction": ("the cart itself", "the exact run: the swing pulls harder than friction holds"),
}
"""What each share is called, and which runs it is the difference of.

The share of the misprint is not among them: it was hardly simulated.
"""
ANIMATED = 12.0
"""Frames a second of what is shown."""
STROKE = (1.15, 0.7)
"""Begin and end of the stroke of Fig. 11 that is shown, in cycles before the end."""
STEADY = 1e-6
"""Share of the travel within which cycles are the same."""


def cart_section(found: PaperAudit) -> report.Section:
    """Fig. 2: the cart with the printed equations, in fixed steps and exactly."""
    study = found.cart
    return report.Section(
        id="cart",
        nav="Fig. 2, the cart",
        heading=_cart_heading(study),
        blocks=(
            report.Paragraph(text=_setting(study)),
            _run_table((*study.runs, *study.table_1)),
            report.Paragraph(text=_scheme_text(study)),
            _cycle_figure(study),
            _animation(study),
            report.Subheading(text="Where the backward motion comes from"),
            _share_table(study),
            report.Caption(text=_shares_text(study)),
        ),
    )


def _cart_heading(study: CartStudy) -> str:
    free, exact = (study.run(key).least_velocity for key in ("fixed", "exact"))
    if exact > 0.5 * free:  # both are at most 0
        return "Fig. 2: most of the backward motion of the old scheme comes from its steps"
    return "Fig. 2: the cart with the printed equations"


def _setting(study: CartStudy) -> str:
    cart, swing = study.cart, study.swing
    angle = f"{math.degrees(swing.amplitude):.0f}°"
    origin = (
        "As given by `--set`"
        if study.given
        else "Ours, since the paper prints none and its sources were not at hand; who holds [6] and"
        ' [7] enters theirs, such as `stickslip paper --set cart_mass=0.4 --set amplitude="40'
        ' deg"`'
    )
    return (
        f"{origin}: cart {cart.cart_mass:g} kg, ball {cart.ball_mass:g} kg, rod {cart.length:g} m;"
        f" the rod swings from −{angle} to {angle} and back with {swing.fast:g}, −{swing.slow:g}"
        f" and {swing.fast:g} rad/s², in {study.period:.5f} s. {in_words(CYCLES).capitalize()}"
        f" cycles from rest with $mu_k$ = $mu_s$ = {KINETIC:g}, then at the levels of Table I; in"
        " steps of the paper’s 10 ms by forward Euler (our choice), and exactly. With the stick"
        " rule friction begins at $F_s$, without it sgn 0 = 0."
    )


def _scheme_text(study: CartStudy) -> str:
    """Say what (4) cannot have been, and how far the old scheme and the exact run agree."""
    exact, old, new = (study.run(key) for key in ("exact", "table-1", "table-1-exact"))
    literal = study.run("printed-4")
    turned = (
        f" Taken literally, (3) and (4) drive this cart {quantity(abs(literal.travel), 'm')}"
        " backwards, while the paper’s goes forwards: we infer that the sign in $mu$ of (3) is a"
        f" slip of notation. With the plain $mu$ of (1), (4) gives"
        f" {fixed(study.run('unsigned-4').travel, 3)} m."
        if literal.travel * exact.travel < 0.0
        else ""
    )
    return (
        "The paper concludes that a rule for rest removes the backward motion and leaves the"
        f" displacement as it was. At $mu$ = {KINETIC:g}, (1) and (2) in steps give"
        f" {fixed(study.run('printed-1').travel, 3)} m and the exact run"
        f" {fixed(exact.travel, 3)} m; at the levels of Table I {fixed(old.travel, 3)} and"
        f" {fixed(new.travel, 3)} m, with a back-slip of {quantity(old.mean_return, 'm', 2)} and"
        f" {'none' if new.mean_return == 0.0 else quantity(new.mean_return, 'm', 2)}"
        f" a cycle.{turned}"
    )


def _animation(study: CartStudy) -> report.Animation:
    """The first two cycles of the exact run, drawn to scale."""
    exact = study.run("exact").run
    alt = "A cart with an inverted pendulum moves to the right as the pendulum swings"
    until = 2.0 * study.period
    draw = partial(plots.animation_html, exact, study.cart, fps=ANIMATED, until=until)
    return report.Animation(
        html=partial(draw, alt=alt, narrow=(358, 560)),
        caption="**The exact run** in its first two cycles, to scale and in real time."
        " The cart is yellow while it sticks; the arrows are the forces of the ground and"
        " the torque.",
    )


def _run_table(runs: Sequence[CartRun]) -> report.Table:
    heads = ["run", f"travel in\n{CYCLES} cycles, m", "by cycle\nmm", LOWEST_VELOCITY, BACK_SLIP]
    exact = [run.key.endswith("exact") for run in runs]
    return report.table_of(heads, map(_run_row, runs, exact), chosen=exact)


def _run_row(run: CartRun, exact: bool) -> Sequence[report.Cell]:
    later = sorted((1e3 * travel for travel in run.travels[1:]), key=abs)
    steady = abs(later[-1] - later[0]) < STEADY * abs(later[0])
    ends = [significant(travel, 3) for travel in (later[0], later[-1])]
    following = ends[0] if steady else " to ".join(ends)
    return (
        report.Name(text=run.title, aside="events located" if exact else STEP_TEXT),
        significant(run.travel, 3),
        f"{significant(1e3 * run.travels[0], 3)}, then {following}",
        significant(1e3 * run.least_velocity, 3),
        significant(1e3 * run.mean_return, 3),
    )


def _cycle_figure(study: CartStudy) -> report.Figure:
    keys = ("exact", "printed-1", "fixed-held")
    runs = {study.run(key).title: study.run(key).run for key in keys}
    last = study.run("exact").run.span[1]
    return report.figure(
        plots.draw_cycles(runs, chosen=study.run("exact").title, cycle=(last - study.period, last)),
        "Displacement of the cart in all cycles, and its velocity near zero in the last",
        "fig2b",
        "**In place of Fig. 2. Cart displacement by (1) and (2)**, as printed and corrected in"
        f" {STEP_TEXT}, and exactly: all cycles, and the velocity near zero in the last one."
        f" Yellow: the exact run sticks. {_same_text(study)}",
        plots.CYCLE_SIZES,
    )


def _same_text(study: CartStudy) -> str:
    """Say that (1) is the corrected law without its rule, where the runs bear it out."""
    same = study.run("printed-1").travels == study.run("fixed").travels
    return "Without the stick rule the corrected law is (1), (2): the same run." if same else ""


def _shares_text(study: CartStudy) -> str:
    shares = {share.key: share for share in study.shares}
    steps = [shares["no-stick-rule"], shares["step"]]
    free, exact = study.run("fixed"), study.run("exact")
    late = sum(share.least_velocity for share in steps)
    return (
        "What each cause adds at $mu$ = 0.2; the rows add up to the run with (1) and (2)."
        f" In {STEP_TEXT} it reaches {_speed(free.least_velocity)}, of which the step and the"
        f" missing rule make up {percent(late / free.least_velocity)} and vanish with the step. The"
        f" exact run reaches {_speed(exact.least_velocity)}: the swing pulls this cart back harder"
        " than friction can hold. A criterion on the sign of the velocity cannot tell the two"
        " apart."
    )


def _speed(velocity: float) -> str:
    return with_unit(significant(1e3 * velocity, 2), "mm/s")


def _share_table(study: CartStudy) -> report.Table:
    printed = study.run("printed-1")
    shares = [share for share in study.shares if share.key in CAUSES]
    named = [
        (CAUSES[share.key][0], CAUSES[share.key][1].format(step=STEP_TEXT)) for share in shares
    ]
    named.append(("all together", f"{printed.title}, {STEP_TEXT}"))
    parts: list[Share | CartRun] = [*shares, printed]
    rows = [
        (
            report.Name(text=cause, aside=runs),
            significant(1e3 * of.least_velocity, 3),
            significant(1e3 * of.mean_return, 3),
        )
        for (cause, runs), of in zip(named, parts, strict=True)
    ]
    chosen = [share.key == "friction" for share in shares]
    return report.table_of(["cause", LOWEST_VELOCITY, BACK_SLIP], rows, chosen=(*chosen, False))


def choice_section(found: PaperAudit) -> report.Section:
    """Fig. 11: the cart with the law that the selection names, and with the paper's choice."""
    study = found.cart
    return report.Section(
        id="cart-choice",
        nav="Fig. 11, the choice",
        heading=_choice_heading(study),
        blocks=(
            report.Paragraph(text=_choice_text(found)),
            _choice_table(study),
            _choice_figure(study),
            report.Caption(text=f"{_return_text(found)} {_normal_text(study)}"),
        ),
    )


def _choice_heading(study: CartStudy) -> str:
    travels = {choice.key: quantity(choice.travels[-1], "m") for choice in study.choices}
    if "selected" not in travels:
        return f"{study.run('paper').law.title} friction moves the cart {travels['paper']} a cycle"
    return (
        f"The cart moves {travels['selected']} a cycle with the law that select names, and"
        f" {travels['paper']} with the paper’s example"
    )


def _choice_text(found: PaperAudit) -> str:
    named = [choice for choice in found.cart.choices if choice.key == "selected"]
    chosen = f"names {named[0].law.title}" if named else "names no law"
    cart = "given by `--set`" if found.cart.given else "ours"
    return (
        "The paper takes Coulomb + viscous friction “for instance”; its $sigma_2$ is not printed"
        f" ({quantity(found.values.viscous, 'N s/m', 2)}, assumed). `select` {chosen} for the rig."
        f" Masses and swing of the cart are {cart}"
        ", so that the figure can be compared in kind only."
    )


def _label(run: CartRun) -> str:
    return "by select" if run.key == "selected" else "the paper’s example"


def _choice_table(study: CartStudy) -> report.Table:
    heads = ["law", "travel\nm", FIRST_CYCLE, "last cycle\nmm", BACK_SLIP, LOWEST_VELOCITY]
    rows = [
        (
            report.Name(text=f"{run.law.title}, {_label(run)}", aside=values_of(run.law)),
            significant(run.travel, 3),
            fixed(1e3 * run.travels[0], 2),
            fixed(1e3 * run.travels[-1], 2),
            back_slip_text(run.mean_return),
            significant(1e3 * run.least_velocity, 2),
            fixed(run.least_normal_force, 3),
        )
        for run in study.choices
    ]
    chosen = [run.key == "selected" for run in study.choices]
    return report.table_of([*heads, "lowest normal\nforce, N"], rows, chosen=chosen)


def _choice_figure(study: CartStudy) -> report.Figure:
    runs = {_label(choice): choice.run for choice in study.choices}
    last = study.choices[0].run.span[1]
    stroke = (last - STROKE[0] * study.period, last - STROKE[1] * study.period)
    views = [
        plots.MotionView(column="x", title="displacement", span=(0.0, last)),
        plots.MotionView(column="v", title="velocity", span=stroke),
    ]
    apart = ""
    if len(runs) > 1:
        views.append(
            plots.MotionView(
                column="v", title="difference in velocity", span=stroke, difference=True
            )
        )
        apart = ", and by how much that of the paper’s example differs"
    return report.figure(
        plots.draw_motion(runs, views=views),
        "Displacement and velocity of the cart with the chosen laws",
        "fig11",
        "**In place of Fig. 11. The cart under Coulomb + viscous friction**, the paper’s example,"
        " and under the law that select names, both solved exactly: displacement in all cycles,"
        f" velocity in the last whole stroke{apart}.",
        {"wide": (880, 300), "narrow": (358, 600)},
    )


def _return_text(found: PaperAudit) -> str:
    """Say whether the cart slips back, and what keeps it from it."""
    study = found.cart
    back = [choice for choice in study.choices if choice.mean_return > 0.0]
    if back:
        ways = ", ".join(f"{_label(run)}: {quantity(run.mean_return, 'm', 2)}" for run in back)
        return f"The cart slips back in a cycle: {ways}."
    pull = max(largest_pull(run) for run in study.choices)
    return (
        f"The cart never slips back: at rest the swing pulls it back with up to {percent(pull)} of"
        " the normal force, less than friction can hold. At a lower level of"
        f" {KINETIC:g} it does slip back, as the tables above show."
    )


def largest_pull(run: CartRun) -> float:
    """Return the largest backward pull on the resting cart, over the normal force.

    NaN if it never rests.
    """
    first, last = run.run.span
    seen = run.run.at(np.union1d(np.linspace(first, last, 20_000), run.run.t))
    resting = seen["mode"] == 0
    pulls = -seen["friction"][resting] / seen["normal_force"][resting]
    return float(max(pulls, default=math.nan))


def _normal_text(study: CartStudy) -> str:
    least = min(choice.least_normal_force for choice in study.choices)
    return (
        "The normal force is the same with every law, since the swing is prescribed; it falls to"
        f" {percent(least / study.weight)} of the weight."
    )


# Rules for rest beside the exact switch, and break-away levels that vary.


def rest_section(found: PaperAudit) -> report.Section:
    """Show what the zero-velocity band of the paper's [18] does, beside other rules for rest."""
    heads = [
        "rule for rest",
        "block, travel\nm",
        "sign changes\nin 1 s",
        "block\nat the end",
        f"cart, travel in\n{CYCLES} cycles, m",
        "cart, back-slip\nmm/cycle",
    ]
    rows = [
        (
            _rule_name(rule),
            fixed(rule.block.travel, 4),
            str(rule.reversals),
            "rests" if rule.rests else "moves to and fro" if rule.reversals else "moves",
            fixed(rule.cart_travel, 3),
            significant(1e3 * rule.cart_back_slip, 2),
        )
        for rule in found.rest_rules
    ]
    rules = report.table_of(heads, rows, chosen=[rule.dt is None for rule in found.rest_rules])
    return report.Section(
        collapsed=True,
        id="rest",
        nav="Rules for rest",
        heading="The zero-velocity band of [18] beside the exact switch",
        blocks=(
            report.Paragraph(text=_rest_text(found)),
            rules,
            report.Caption(text=_rest_caption(found)),
        ),
    )


def _rest_text(found: PaperAudit) -> str:
    steps = sorted({rule.dt for rule in found.rest_rules if rule.dt is not None}, reverse=True)
    level = found.values.mu_k * found.values.load / found.values.rig.mass
    jumps = joined([f"{significant(1e3 * level * dt, 2)} mm/s in {1e3 * dt:g} ms" for dt in steps])
    return (
        "Karnopp (1985), the paper’s [18], has a body slower than $D_v$ at rest while the force"
        " needed is within break-away. A step changes the velocity of the block by"
        f" $F_c$ $dt$/$m$, which is {jumps}, and can jump over a narrower band. Coulomb friction"
        f" with the levels of Table I, forward Euler, friction from $F_s$ in the first"
        " step out of rest."
    )


def _rule_name(rule: RestRule) -> report.Name:
    if rule.dt is None:
        return report.Name(text="exact switch", aside="events located")
    text = "at a change of sign" if rule.stick_rule else "none"
    if rule.band > 0.0:
        text = f"band, $D_v$ = {number(1e3 * rule.band)} mm/s"
    return report.Name(text=text, aside=f"steps of {1e3 * rule.dt:g} ms")


def _rest_caption(found: PaperAudit) -> str:
    exact = found.rest_rules[0]
    wide = [rest_rule for rest_rule in found.rest_rules if rest_rule.band > 0.0 and rest_rule.rests]
    narrow = [one for one in found.rest_rules if one.band > 0.0 and not one.rests]
    parts = []
    for rule in wide:
        off = rule.block.travel / exact.block.travel - 1.0
        parts.append(
            f"{number(1e3 * rule.band)} mm/s in steps of {1e3 * (rule.dt or 0.0):g} ms"
            f" ({percent(off)} too far)"
        )
    text = f"Bands that hold the block: {joined(parts)}." if parts else "No band holds the block."
    if narrow:
        missed = [
            f"{number(1e3 * one.band)} mm/s in steps of {1e3 * (one.dt or 0.0):g} ms"
            for one in narrow
        ]
        text += f" Bands that it jumps over: {joined(missed)}."
    return (
        f"{text} With a rule, friction begins at $F_s$; without one, sgn 0 = 0. A wide band does"
        " what the rule for a change of sign does. Neither finds the instant of stop or start, so"
        " that travels keep an error of the order of the step."
    )


def break_away_section(found: PaperAudit) -> report.Section:
    """Show what a break-away level that varies does to the cart."""
    reached = "friction reached\nby cycle, over $N$"
    heads = ["break-away level", reached, FIRST_CYCLE, "later cycles\nmm", BACK_SLIP]
    return report.Section(
        collapsed=True,
        id="break-away",
        nav="Break-away that varies",
        heading=_break_away_heading(found),
        blocks=(
            report.Paragraph(text=_break_away_text(found)),
            report.table_of(heads, map(_break_away_row, found.cart.break_away)),
            report.Caption(text=_break_away_caption(found)),
        ),
    )


def _groups(found: PaperAudit) -> list[list[CartRun]]:
    """Return the runs with a constant level, by their kinetic coefficient."""
    groups: dict[float, list[CartRun]] = {}
    for run in found.cart.break_away:
        kinetic = getattr(run.law, "kinetic_coefficient", None)
        if run.law.name == "coulomb" and kinetic is not None:
            groups.setdefault(kinetic, []).append(run)
    return list(groups.values())


def _later(run: CartRun) -> tuple[float, float]:
    return min(run.travels[1:]), max(run.travels[1:])


def _spread(runs: list[CartRun]) -> float:
    """Return by how much travels of later cycles differ between runs, over the travel."""
    low = min(_later(run)[0] for run in runs)
    high = max(_later(run)[1] for run in runs)
    return (high - low) / abs(high)


def _break_away_heading(found: PaperAudit) -> str:
    first = _groups(found)[0]
    if _spread(first) < SAME:
        return (
            "A break-away level that varies changes the first cycle of the cart, and whether it"
            " slips back"
        )
    return "A break-away level that varies"


SAME = 1e-6
"""Share of the travel within which cycles are the same."""


def _break_away_text(found: PaperAudit) -> str:
    values = found.values
    return (
        "Section III lists a break-away force that varies; of the equations only (9) has one, since"
        " bristles give way earlier the faster the force grows. The cart, solved exactly: Coulomb"
        f" friction with other static levels, at $mu_k$ = {number(values.mu_k)} and at"
        f" {KINETIC:g}; and LuGre with $mu_s$ = {number(values.mu_s)}, free bristles of 10⁵ N/m and"
        " the other values of its 1995 paper."
    )


def _break_away_row(run: CartRun) -> Sequence[report.Cell]:
    low, high = (significant(1e3 * value, 4) for value in _later(run))
    reached = [significant(value, 3) for value in run.largest_friction]
    steady = len(set(reached[1:])) == 1
    return (
        report.Name(text=run.title, aside="" if run.law.name == "coulomb" else "free bristles"),
        f"{reached[0]}, then {reached[1]}" if steady else ", ".join(reached),
        significant(1e3 * run.travels[0], 4),
        low if low == high else f"{low} to {high}",
        back_slip_text(run.mean_return),
    )


def _break_away_caption(found: PaperAudit) -> str:
    parts = []
    for runs in _groups(found):
        kinetic = number(getattr(runs[0].law, "kinetic_coefficient", 0.0))
        first = [1e3 * run.travels[0] for run in runs]
        ends = f"{interval(min(first), max(first))} mm"
        parts.append(f"at $mu_k$ = {kinetic} the first cycle has {ends}")
    slipping = [run for run in found.cart.break_away if run.mean_return > 0.0]
    text = f"By level, {joined(parts)}."
    if _spread(_groups(found)[0]) < SAME:
        text += (
            " Later on the swing reverses its acceleration at once and asks for more than any of"
            " these levels at that instant, so that the cart starts at the same time with each."
        )
    held = [run for run in found.cart.break_away if run.mean_return == 0.0]
    if slipping and held:
        pull = largest_pull(held[-1])
        text += (
            f" Whether it slips back depends on the level: the swing pulls it back with up to"
            f" {percent(pull)} of the normal force, and a level that falls below that at a cycle"
            " lets it slip in that cycle."
        )
    bristles = found.cart.break_away[-1]
    if bristles.law.name == "lugre":
        text += (
            f" LuGre reaches {significant(max(bristles.largest_friction), 3)} of the normal force"
            f" before slip, not {number(found.values.mu_s)}, and springs back by"
            f" {quantity(bristles.mean_return, 'm', 2)} a cycle."
        )
    return text
