"""All that is assumed on the page, in one table."""

import math

from stickslip.formatting import joined, number, quantity, significant
from stickslip.friction import LuGre
from stickslip.paper.audit import PaperAudit
from stickslip.paper.cart import CYCLES, KINETIC
from stickslip.paper.excitations import PUSH_DURATION
from stickslip.paper.misprints import BACKWARD, BRISTLE_STEP, HELD
from stickslip.paper.misprints import STEP as FINE
from stickslip.paper.sections.common import fitted_text, values_of
from stickslip.paper.stick_slip import SPEED
from stickslip.paper.unpublished import CREEPING, STEP, STIFFNESS, lugre_row
from stickslip.quantities import fields_of
from stickslip.report import Column, Paragraph, Row, Section, Table


def assumption_section(found: PaperAudit) -> Section:
    """List every value that the page uses and the source does not print, with its origin."""
    rows = (*_rig_rows(found), *_law_rows(found), *_run_rows(found))
    printed = (
        "the file of this rig gives"
        if found.own
        else "Tables I and II and the text of the paper print"
    )
    return Section(
        collapsed=True,
        id="assumptions",
        nav="Assumptions",
        heading="What is assumed, and where it is used",
        blocks=(
            Paragraph(
                text=f"Every value on this page is one that {printed}, or stands in this table."
            ),
            Table(
                columns=(
                    Column(head="where"),
                    Column(head="value"),
                    Column(head="origin", phone="label", label="origin:"),
                ),
                rows=tuple(Row(cells=cells) for cells in rows),
            ),
        ),
    )


def _rig_rows(found: PaperAudit) -> list[tuple[str, str, str]]:
    values = found.values
    rig, pushed = values.rig, f"{quantity(values.force, 'N')} for {PUSH_DURATION:g} s"
    rows = [
        (
            "block, gravity",
            quantity(rig.gravity, "m/s^2"),
            "rig file; 9.81 m/s² where it gives none" if found.own else "not printed",
        )
    ]
    if found.own:
        given = "rig file" if found.rig.given.get("coulomb") else "fitted to the travels"
        rows += [
            ("block, levels", f"$mu_k$ {number(values.mu_k)}, $mu_s$ {number(values.mu_s)}", given),
            ("reading A", pushed, "force of the spring, time of the paper"),
        ]
    else:
        rows += [
            (
                "readings B and C, compression",
                quantity(rig.compression, "m"),
                "inferred from $F$ = $K$$x$ and 10 N",
            ),
            ("reading A", f"{pushed}, then coasting", "printed; that it coasts is inferred"),
            ("reading C", "the block stays fastened", "ours, a control"),
        ]
    return rows


def _law_rows(found: PaperAudit) -> list[tuple[str, str, str]]:
    load = found.values.load
    rows = []
    for row in found.table:
        own = found.rig.given.get(row.law.name, ()) if found.own else ()
        held = " held at its first stop" if getattr(row.law, "static_switch", False) else ""
        assumed = found.rig.assumed.get(row.law.name, ())
        origin = "Table I"
        if found.own:
            used = [name for name in fields_of(type(row.law)) if getattr(row.law, name) is not None]
            given = [name.replace("_", " ") for name in used if name in own]
            if len(given) == len(used):
                origin = "rig file"
            else:
                origin = (
                    f"{joined(given)} of the rig file" if given else "levels as above"
                ) + ", the rest as for the rig of the paper"
                if row.law.name.startswith("coulomb-viscous") and fitted_text(found):
                    origin = fitted_text(found)
        elif assumed:
            origin = (
                f"levels of Table I; {joined([name.replace('_', ' ') for name in assumed])} assumed"
            )
        if isinstance(row.law, LuGre) and not own:
            origin += "; $n$ not printed"
        rows.append(
            (f"models, {row.law.title}", f"{values_of(row.law, load)}{held and ','}{held}", origin)
        )
    return rows


def _run_rows(found: PaperAudit) -> list[tuple[str, str, str]]:
    values, cart, swing = found.values, found.cart.cart, found.cart.swing
    angle = f"{math.degrees(swing.amplitude):.0f}°"
    soft = lugre_row(values, STIFFNESS)
    rows = [
        (
            "printed equations",
            f"$sigma_2$ {significant(values.viscous, 2)} N s/m in (5), (8), (9) and (10), also"
            " where the models above have none; $n$ = 2 in (9)",
            fitted_text(found) or "assumed",
        ),
        (
            "printed equations, tests",
            f"{-BACKWARD:g} m/s backwards; held against {HELD:g} $F_c$; steps of {1e3 * FINE:g} ms,"
            f" {1e3 * BRISTLE_STEP:g} ms with bristles; Heun’s method",
            "ours",
        ),
        (
            "spring-back, break-away with bristles",
            f"LuGre, {values_of(soft, values.load)}",
            "LuGre 1995, with the levels of the block",
        ),
        (
            "steps of 10 ms",
            f"{quantity(STEP, 's')}, forward Euler",
            "the paper states the time for its cart, not the method",
        ),
        (
            "cart",
            f"{number(cart.cart_mass)} kg, ball {number(cart.ball_mass)} kg, rod"
            f" {number(cart.length)} m",
            "ours",
        ),
        (
            "cart, swing",
            f"−{angle} to {angle} and back, {number(swing.fast)}, −{number(swing.slow)},"
            f" {number(swing.fast)} rad/s², {CYCLES} cycles",
            "ours",
        ),
    ]
    if not found.own:
        rows += [
            (
                "unpublished values, LuGre",
                "$sigma_1$ the root of $sigma_0$, $sigma_2$ 0.4 N s/m, $v_s$ 1 mm/s, $n$ 2, nothing"
                " holds the block",
                "LuGre 1995",
            ),
            (
                "(5) in steps of 10 ms",
                f"$v_s$ {joined([significant(1e3 * one, 4) for one in CREEPING])} mm/s; sgn $v$"
                " added",
                "tried",
            ),
            ("cart, $mu_k$ = $mu_s$", f"{KINETIC:g}; Table I’s where said", "ours"),
            ("stick-slip, pulling speed", f"{1e3 * SPEED:g} mm/s", "ours"),
        ]
    return rows
