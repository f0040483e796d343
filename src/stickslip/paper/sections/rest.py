"""Rules for rest beside the exact switch, and break-away levels that vary."""

from stickslip.formatting import fixed, interval, joined, number, percent, quantity, significant
from stickslip.paper.audit import PaperAudit
from stickslip.paper.cart import CYCLES, KINETIC, CartRun
from stickslip.paper.rest_rules import RestRule
from stickslip.paper.sections.cart import largest_pull
from stickslip.paper.sections.common import BACK_SLIP, FIRST_CYCLE, back_slip_text, levels_from
from stickslip.report import Caption, Column, Name, Paragraph, Row, Section, Table


def rest_section(found: PaperAudit) -> Section:
    """Show what the zero-velocity band of the paper's [18] does, beside other rules for rest."""
    columns = (
        Column(head="rule for rest"),
        Column(head="block, travel\nm", numeric=True, phone="label"),
        Column(
            head="sign changes\nin 1 s", numeric=True, phone="label", label="sign changes in 1 s"
        ),
        Column(head="block\nat the end", phone="label", label="block at the end"),
        Column(
            head=f"cart, travel in\n{CYCLES} cycles, m",
            numeric=True,
            phone="label",
            label="cart, travel, m",
        ),
        Column(
            head="cart, back-slip\nmm/cycle",
            numeric=True,
            phone="label",
            label="cart, back-slip, mm per cycle",
        ),
    )
    return Section(
        collapsed=True,
        id="rest",
        nav="Rules for rest",
        heading="The zero-velocity band of [18] beside the exact switch",
        blocks=(
            Paragraph(text=_rest_text(found)),
            Table(columns=columns, rows=tuple(map(_rest_row, found.rest_rules))),
            Caption(text=_rest_caption(found)),
        ),
    )


def _rest_text(found: PaperAudit) -> str:
    steps = sorted({one.dt for one in found.rest_rules if one.dt is not None}, reverse=True)
    level = found.values.mu_k * found.values.load / found.values.rig.mass
    jumps = joined([f"{significant(1e3 * level * dt, 2)} mm/s in {1e3 * dt:g} ms" for dt in steps])
    return (
        "Karnopp (1985), the paper’s [18], has a body slower than $D_v$ at rest while the force"
        " needed is within break-away. A step changes the velocity of the block by"
        f" $F_c$ $dt$/$m$, which is {jumps}, and can jump over a narrower band. Coulomb friction"
        f" with the levels {levels_from(found)}, forward Euler, friction from $F_s$ in the first"
        " step out of rest."
    )


def _rest_row(rule: RestRule) -> Row:
    if rule.dt is None:
        name = Name(text="exact switch", aside="events located")
    else:
        text = "at a change of sign" if rule.stick_rule else "none"
        if rule.band > 0.0:
            text = f"band, $D_v$ = {number(1e3 * rule.band)} mm/s"
        name = Name(text=text, aside=f"steps of {1e3 * rule.dt:g} ms")
    return Row(
        cells=(
            name,
            fixed(rule.block.travel, 4),
            str(rule.reversals),
            "rests" if rule.rests else "moves to and fro" if rule.reversals else "moves",
            fixed(rule.cart_travel, 3),
            significant(1e3 * rule.cart_back_slip, 2),
        ),
        chosen=rule.dt is None,
    )


def _rest_caption(found: PaperAudit) -> str:
    exact = found.rest_rules[0]
    wide = [one for one in found.rest_rules if one.band > 0.0 and one.rests]
    narrow = [one for one in found.rest_rules if one.band > 0.0 and not one.rests]
    parts = []
    for one in wide:
        off = one.block.travel / exact.block.travel - 1.0
        parts.append(
            f"{number(1e3 * one.band)} mm/s in steps of {1e3 * (one.dt or 0.0):g} ms"
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


def break_away_section(found: PaperAudit) -> Section:
    """Show what a break-away level that varies does to the cart."""
    columns = (
        Column(head="break-away level"),
        Column(
            head="friction reached\nby cycle, over $N$",
            numeric=True,
            phone="label",
            label="reached",
        ),
        FIRST_CYCLE,
        Column(head="later cycles\nmm", numeric=True, phone="label"),
        BACK_SLIP,
    )
    return Section(
        collapsed=True,
        id="break-away",
        nav="Break-away that varies",
        heading=_break_away_heading(found),
        blocks=(
            Paragraph(text=_break_away_text(found)),
            Table(columns=columns, rows=tuple(map(_break_away_row, found.cart.break_away))),
            Caption(text=_break_away_caption(found)),
        ),
    )


def _groups(found: PaperAudit) -> list[list[CartRun]]:
    """Return the runs with a constant level, by their kinetic coefficient."""
    groups: dict[float, list[CartRun]] = {}
    for one in found.cart.break_away:
        kinetic = getattr(one.law, "kinetic_coefficient", None)
        if one.law.name == "coulomb" and kinetic is not None:
            groups.setdefault(kinetic, []).append(one)
    return list(groups.values())


def _later(run: CartRun) -> tuple[float, float]:
    return min(run.travels[1:]), max(run.travels[1:])


def _spread(runs: list[CartRun]) -> float:
    """Return by how much travels of later cycles differ between runs, over the travel."""
    low = min(_later(one)[0] for one in runs)
    high = max(_later(one)[1] for one in runs)
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


def _break_away_row(run: CartRun) -> Row:
    low, high = (significant(1e3 * one, 4) for one in _later(run))
    reached = [significant(one, 3) for one in run.largest_friction]
    later = reached[1:]
    steady = len(set(later)) == 1
    return Row(
        cells=(
            Name(text=run.title, aside="" if run.law.name == "coulomb" else "free bristles"),
            f"{reached[0]}, then {later[0]}" if steady else ", ".join(reached),
            significant(1e3 * run.travels[0], 4),
            low if low == high else f"{low} to {high}",
            back_slip_text(run.mean_return),
        )
    )


def _break_away_caption(found: PaperAudit) -> str:
    parts = []
    for runs in _groups(found):
        kinetic = number(getattr(runs[0].law, "kinetic_coefficient", 0.0))
        first = [1e3 * one.travels[0] for one in runs]
        ends = f"{interval(min(first), max(first))} mm"
        parts.append(f"at $mu_k$ = {kinetic} the first cycle has {ends}")
    slipping = [one for one in found.cart.break_away if one.mean_return > 0.0]
    text = f"By level, {joined(parts)}."
    if _spread(_groups(found)[0]) < SAME:
        text += (
            " Later on the swing reverses its acceleration at once and asks for more than any of"
            " these levels at that instant, so that the cart starts at the same time with each."
        )
    held = [one for one in found.cart.break_away if one.mean_return == 0.0]
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
