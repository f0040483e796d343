"""Sections on what the paper claims and on what it does not print."""

from collections.abc import Iterator

import numpy as np

from stickslip.engine.trajectory import Trajectory
from stickslip.friction import LuGre
from stickslip.paper.paper_audit import PaperAudit
from stickslip.paper.printed import ROUNDING, Consequence, Requirement, StepTravel
from stickslip.paper.rigs import CYCLES, KINETIC, PUSH_DURATION
from stickslip.paper.sections.cart import largest_pull
from stickslip.paper.sections.common import values_of
from stickslip.show.formatting import (
    fixed,
    in_words,
    interval,
    number,
    percent,
    quantity,
    significant,
    with_unit,
)
from stickslip.show.report import (
    Name,
    Paragraph,
    Section,
    Subheading,
    Table,
    table_of,
)

# What the parameters that the paper does not print would have to be.


def unpublished_section(found: PaperAudit) -> Section:
    """Show the value behind each published row with its range, for a push and for a spring."""
    total = sum(row.published.travel is not None for row in found.table)
    reached = {key: _reached(found, key) for key in "AB"}
    needs = {(need.law, need.reading): need for need in found.requirements}
    heads = ["row", "published\nm", "A, push: would need", "B, spring: would need"]
    rows = [
        (
            row.law.title,
            fixed(row.published.travel or 0.0, 2),
            *(_value(needs[row.law.name, key]) for key in "AB"),
            needs[row.law.name, "A"].text,
        )
        for row in found.table
        if (row.law.name, "A") in needs
    ]
    return Section(
        id="unpublished",
        nav="Unpublished values",
        heading=(
            f"With Table I kept, unpublished values can give {in_words(reached['A'])} of the"
            f" {in_words(total)} travels for the push and {in_words(reached['B'])} for the spring"
        ),
        blocks=(
            Paragraph(
                text=(
                    "Found by root finding, solved exactly; under each value the range for travels"
                    " that round to the printed figure. That a value gives the row does not show"
                    " that it was used."
                )
            ),
            table_of([*heads, "what that means"], rows),
            Subheading(text=_step_heading(found)),
            _step_table(found),
        ),
    )


def trial_section(found: PaperAudit) -> Section:
    """Show the runs behind the values for (5) in steps and for bristles."""
    return Section(
        collapsed=True,
        id="trials",
        nav="(5) in steps, bristles",
        heading="The 0.45 m of Stribeck in steps, and travels by stiffness of the bristles",
        blocks=(
            Paragraph(text=_creep_text(found)),
            _creep_table(found),
            Subheading(text="By stiffness of the bristles"),
            _bristle_table(found),
        ),
    )


def _reached(found: PaperAudit, key: str) -> int:
    return sum(
        need.value is not None and need.kept and need.reading == key for need in found.requirements
    )


def _step_heading(found: PaperAudit) -> str:
    reached = sum(step_travel.reached for step_travel in found.step_travels)
    total = len(found.step_travels)
    return f"In steps of 10 ms, {in_words(reached)} of {in_words(total)}, Table I kept"


def _step_table(found: PaperAudit) -> Table:
    """Show what steps of 10 ms make of the push, by the friction in the first step."""
    titles = {row.law.name: row.law.title for row in found.table}
    rows = [
        (
            titles[step_travel.row],
            fixed(step_travel.published, 2),
            *_step_cells(step_travel),
            values_of(step_travel.law, found.values.load)
            if step_travel.scatter is None
            else f"(5), sgn $v$ added, no rule for rest; {values_of(step_travel.law)}",
        )
        for step_travel in found.step_travels
    ]
    caption = (
        "The push by forward Euler in the sample time that the paper states for its cart. The 0.16"
        " m of both Coulomb rows need sgn 0 = 0 in the first step; bristles have no such step."
        " Which of these it was cannot be told from the paper."
    )
    heads = ["row", "published\nm", "sgn 0 = 0\nm", "from break-away\nm", "with"]
    return table_of(heads, rows, caption)


def _step_cells(travel: StepTravel) -> tuple[str, str]:
    """Return the travel where sgn 0 = 0 and where friction begins at the break-away level."""
    if travel.scatter is None:
        return fixed(travel.travel, 3), fixed(travel.static, 3)
    low, high = travel.scatter
    return "—", f"{fixed(low, 2)} to {fixed(high, 2)}"


def _creep_text(found: PaperAudit) -> str:
    """Say how (5) reaches its printed travel in steps, and what speaks against it."""
    least = min(creep.least_velocity for creep in found.creeps)
    return (
        "As printed, (5) diverges once the velocity is negative. With the sgn $v$ that it lacks,"
        " friction backwards exceeds $F_s$, so that in steps of 10 ms each step back is followed by"
        " a larger one forwards, and the block creeps on. That agrees with the remark on Fig. 8"
        " that the velocity does not become exactly zero; the Yes of Table II does not, since it"
        f" falls to {significant(1e3 * least, 2)} mm/s again and again. The creep is chaotic: $v_s$"
        " that differ by 10⁻⁹ of themselves give the scatter, whose digits differ between"
        " computers."
    )


def _creep_table(found: PaperAudit) -> Table:
    speed = number(1e3 * found.values.stribeck_velocity)
    caption = (
        "Travel of the push after 10 s; the rule for rest holds the block where its velocity"
        f" changes sign, and friction begins at $F_s$. Table II has $v_s$ = {speed} mm/s."
    )
    heads = [
        "Stribeck velocity",
        "10 ms, no rule\nmean, m",
        "scatter\nm",
        "10 ms, rule\nfor rest, m",
        "1 ms, no rule\nm",
    ]
    rows = [
        (
            f"$v_s$ = {significant(1e3 * creep.stribeck_velocity, 4)} mm/s",
            fixed(creep.mean, 2),
            f"{fixed(min(creep.travels), 2)} to {fixed(max(creep.travels), 2)}",
            fixed(creep.held, 4),
            fixed(creep.fine, 4),
        )
        for creep in found.creeps
    ]
    return table_of(heads, rows, caption)


def _value(need: Requirement) -> Name:
    unit = "" if need.unit == "1" else f" {need.unit}"
    if need.value is None:
        return Name(text=f"no ${need.symbol}$", aside=f"nearest {fixed(need.start, 3)} m")
    limits = "one-sided"
    if need.low is not None and need.high is not None:
        limits = f"{significant(need.low, 3)} to {significant(need.high, 3)}"
    return Name(text=f"${need.symbol}$ = {significant(need.value, 3)}{unit}", aside=limits)


def _bristle_table(found: PaperAudit) -> Table:
    """Show the travel of the bristle laws by their stiffness, in the same push."""
    dahl, lugre = ([row for row in found.bristles if row.law == law] for law in ("dahl", "lugre"))
    caption = (
        "The push, solved exactly; LuGre with the other values of its 1995 paper. Published: Dahl"
        " 0.25 m, LuGre 0.13 m with a velocity that becomes negative."
    )
    heads = ["bristles", "Dahl, held\nm", "LuGre, free\nm", "LuGre, lowest\nvelocity, mm/s"]
    rows = [
        (
            f"{significant(held.stiffness, 1)} N/m",
            fixed(held.criteria.travel, 4),
            fixed(free.criteria.travel, 4),
            significant(1e3 * free.criteria.least_velocity, 2),
        )
        for held, free in zip(dahl, lugre, strict=True)
    ]
    return table_of(heads, rows, caption)


# What the paper claims, equation by equation and figure by figure, and what became of it.

REPRODUCED = "reproduced"
IN_STEPS = "reproduced in steps of 10 ms only"
CORRECTED = "corrected"
CANNOT = "cannot be: value not printed"
IN_KIND = "in kind: values not printed"
Claim = tuple[str, str, str, str]
"""What is claimed, where, what became of it, and the number that bears it out."""
SAMPLES = 4000
"""Times at which loads and speeds are read."""


def claim_section(audit: PaperAudit) -> Section:
    """List every claim, equation and figure with the result and its number."""
    claims = (*_table_2(audit), *_rig(audit), *_equations(audit), *_phenomena(audit), *_cart(audit))
    heads = ["claim, equation or figure", "where", "result"]
    rows = [(what, where, Name(text=result, aside=why)) for what, where, result, why in claims]
    listed = table_of(heads, rows)
    return Section(
        id="claims",
        nav="Claims",
        heading="What the paper claims, and what became of it",
        blocks=(listed,),
    )


def _table_2(audit: PaperAudit) -> Iterator[Claim]:
    steps = {step_travel.row: step_travel for step_travel in audit.step_travels}
    for row in audit.table:
        if row.published.travel is None:
            continue
        need, step = audit.requirement(row.law.name), steps.get(row.law.name)
        parts = [f"exactly {fixed(row.reading('A').criteria.travel, 3)} m"]
        given = ""
        if need is not None and need.reading == "A":
            unit = "" if need.unit == "1" else f" {need.unit}"
            given = f"${need.symbol}$ = {significant(need.value or 0.0, 3)}{unit}"
        if need is not None and given and need.kept:
            parts = [f"{given} gives it"]
        elif row.law.name == "stribeck":
            parts = ["exactly, none with the dry friction of Table I"]
            parts += [f"viscous friction alone, {given}, gives it"] if given else []
        elif given:
            parts.append(f"{given} in place of Table I gives it")
        elif row.law.name != "coulomb":
            parts = ["exactly, no $sigma_2$ gives it for the push"]
        if step is not None and step.scatter is not None:
            speed = significant(1e3 * audit.creeps[len(audit.creeps) // 2].stribeck_velocity, 4)
            low, high = (fixed(end, 2) for end in step.scatter)
            parts.append(
                f"in steps, sgn $v$ added and $v_s$ = {speed} mm/s, it creeps to {low} to {high} m"
            )
        elif step is not None and row.law.states:
            value = values_of(step.law, audit.values.load).split(", ")
            soft = next(part for part in value if "sigma_0" in part)
            parts.append(f"in steps of 10 ms {soft} gives {fixed(step.travel, 3)} m")
        elif step is not None:
            viscous = getattr(step.law, "viscous_coefficient", 0.0)
            part = f"$sigma_2$ = {viscous:g} N s/m: " if viscous else ""
            parts.append(
                f"in steps of 10 ms {part}{fixed(step.travel, 3)} m where sgn 0 = 0,"
                f" {fixed(step.static, 3)} m where friction begins at $F_s$"
            )
        result = CANNOT
        if row.law.name == "coulomb" and step is not None and step.reached:
            result = IN_STEPS
        yield f"{row.law.title}, {row.published.travel:.2f} m", "Table II", result, "; ".join(parts)
    yield (
        "Relative errors",
        "Table II",
        REPRODUCED,
        f"they follow from the travels and the measured {audit.measured:.2f} m",
    )
    yield (
        "Coulomb and Coulomb + viscous are the most accurate",
        "IV.B",
        CORRECTED,
        "one travel ranks no model: each has a value that gives it",
    )


def _rig(audit: PaperAudit) -> Iterator[Claim]:
    fit = audit.verdict.best.fit if audit.verdict.best else None
    known = fit.estimates[0] if fit is not None and fit.estimates else None
    inside = known is not None and known.low <= audit.values.mu_k <= known.high
    allowed = "" if known is None else f"{known.low:.3f} to {known.high:.3f}"
    yield (
        f"$mu_d$ = {audit.values.mu_k:g}",
        "Table I",
        REPRODUCED if inside else CORRECTED,
        f"the measured travel allows {allowed or 'none'} with the spring released,"
        f" {_pushed(audit)} if the block was pushed",
    )
    spring = audit.table[0].reading("B")
    yield (
        "(11) energy balance",
        "IV",
        REPRODUCED,
        f"{fixed(spring.closed_form or 0.0, 4)} m by formula and by simulation",
    )
    met = [
        sum(
            seen.velocity_never_negative and seen.displacement_never_decreases
            for seen in (row.reading(key).criteria for row in audit.table)
        )
        for key in "AB"
    ]
    backs = [
        f"{back.law.title} {quantity(back.criteria.largest_return, 'm', 2)}"
        for back in audit.springbacks
    ]
    yield (
        "Two criteria: no negative velocity, no decrease",
        "III.A",
        CORRECTED,
        f"met by {met[0]} and {met[1]} of {len(audit.table)} exact runs that hold the block (push,"
        f" spring); free bristles spring back ({', '.join(backs)}), which is physical",
    )
    free = next(row for row in audit.fixed_steps if row.dt is not None and not row.stick_rule)
    yield (
        "A rule for rest is needed in steps",
        "III.A",
        REPRODUCED,
        f"without it the velocity changes its sign {free.reversals} times in 1 s, in steps of"
        f" {1e3 * (free.dt or 0.0):g} ms",
    )


def _pushed(audit: PaperAudit) -> str:
    """Return the coefficients whose travel after the push rounds to the measured one."""
    values, duration = audit.values, PUSH_DURATION
    levels = [
        (values.force * duration) ** 2
        / (2.0 * values.rig.mass * travel + values.force * duration**2)
        for travel in (audit.measured + ROUNDING, audit.measured - ROUNDING)
    ]
    low, high = (level / values.load for level in levels)
    return f"{low:.3f} to {high:.3f}"


def _equations(audit: PaperAudit) -> Iterator[Claim]:
    by = {consequence.form.equation: consequence for consequence in audit.consequences}
    yield (
        "(1) Coulomb, of [6]",
        "II",
        CORRECTED,
        "nothing is held at rest, since sgn 0 = 0: the body creeps by an amount set by the step",
    )
    yield "(2) dynamics with (1)", "II", REPRODUCED, "right while the cart slides"
    yield (
        "(3), (4) friction and dynamics, of [7]",
        "II",
        CORRECTED,
        f"sgn $v$ enters twice; as printed, a block coasting forwards {_ends(by['(3)'], 'coast')}",
    )
    yield (
        "(5) Stribeck",
        "III.C.1",
        CORRECTED,
        f"|·| and sgn $v$ are missing; as printed, coasting {_ends(by['(5)'], 'coast')}. Its rule"
        " for rest is right, and is used here",
    )
    for equation, title, what in (
        ("(6)", "Dahl", "$Z$ has a sign already; "),
        ("(7)", "Coulomb", ""),
        ("(8)", "viscous", "one sgn too many; "),
        ("(9)", "LuGre", "sgn on all three parts, exponent ambiguous; "),
        ("(10)", "Coulomb + viscous", "one sgn too many; "),
    ):
        yield (
            f"{equation} {title}",
            "III.C",
            CORRECTED,
            f"{what}holds a body at rest without limit: pushed from rest $x$ = 0, not"
            f" {significant(_corrected(by[equation], 'push'), 3)} m{_assumed(by[equation])}",
        )


def _ends(consequence: Consequence, test: str) -> str:
    seen = consequence.outcome(test)
    assert seen is not None
    right, viscous = significant(seen.corrected.travel, 3), _assumed(consequence)
    if seen.printed.diverged:
        return f"diverges, instead of {right} m{viscous}"
    return f"ends at {significant(seen.printed.criteria.travel, 3)} m, not {right} m{viscous}"


def _assumed(consequence: Consequence) -> str:
    """Name the viscous part with which an equation is run where Table II gives its law none."""
    viscous = getattr(consequence.corrected, "viscous_coefficient", 0.0)
    if consequence.form.equation not in ("(5)", "(9)") or not viscous:
        return ""
    return f" (with $sigma_2$ = {viscous:g} N s/m, assumed)"


def _corrected(consequence: Consequence, test: str) -> float:
    seen = consequence.outcome(test)
    assert seen is not None
    return seen.corrected.travel


def _phenomena(audit: PaperAudit) -> Iterator[Claim]:
    pulled = audit.stick_slip
    if pulled is not None:
        yield (
            "Stick-slip motion",
            "III.B.1",
            REPRODUCED,
            f"sticks {pulled.stick_time:.3f} s, slips {pulled.slip_time:.3f} s, by run and formula",
        )
    bristles = audit.cart.break_away[-1]
    if isinstance(bristles.law, LuGre):
        yield (
            "Break-away force that varies",
            "III",
            REPRODUCED,
            f"only (9) has it: {significant(max(bristles.largest_friction), 3)} of the normal force"
            f" on the cart, not {audit.values.mu_s:g}",
        )
    yield (
        "Figs 3, 4 Stribeck effect, presliding",
        "III.B",
        IN_KIND,
        "drawn again with the corrected laws; $v_s$ and stiffness are assumed",
    )
    yield (
        "Figs 6 to 10 the block",
        "IV.B",
        IN_KIND,
        "drawn again; the travels are those of Table II",
    )


def _cart(audit: PaperAudit) -> Iterator[Claim]:
    study = audit.cart
    printed, exact = study.run("printed-1"), study.run("exact")
    old, new = study.run("table-1"), study.run("table-1-exact")
    yield (
        "Fig. 2 the cart of [6], [7] goes back",
        "II",
        IN_KIND,
        f"(1), (2) in steps of 10 ms reach {_speed(printed.least_velocity)}; exactly"
        f" {_speed(exact.least_velocity)} at $mu$ = {KINETIC:g}",
    )
    loads, speeds = _ranges(study.run("paper").run)
    _, block = _ranges(audit.table[0].reading("B").run)
    yield (
        "Rig and cart share the same physical condition",
        "IV.B",
        CANNOT,
        f"masses and swing are not printed; with ours the load is {interval(*loads)} N and the"
        f" speed up to {significant(speeds[1], 2)} m/s, on the rig {audit.values.load:.2f} N"
        f" throughout and {significant(block[1], 2)} m/s",
    )
    yield (
        "Fig. 11 with a rule for rest the cart never goes back",
        "V",
        IN_KIND,
        f"back-slip {_way(new.mean_return)} a cycle with $mu_s$ = {audit.values.mu_s:g}: the swing"
        f" pulls with {percent(largest_pull(new))} of the normal force",
    )
    yield (
        "The cart goes to “the same displacement” as before",
        "V",
        IN_KIND,
        f"(1), (2) in steps of 10 ms and exactly: {fixed(old.travel, 3)} and"
        f" {fixed(new.travel, 3)} m in {CYCLES} cycles at Table I’s levels",
    )


def _ranges(run: Trajectory) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the range of the normal force, and of the speed."""
    seen = run.at(np.linspace(*run.span, SAMPLES))
    load, speed = seen["normal_force"], np.abs(seen["v"])
    return (float(load.min()), float(load.max())), (float(speed.min()), float(speed.max()))


def _speed(velocity: float) -> str:
    return with_unit(significant(1e3 * velocity, 2), "mm/s")


def _way(way: float) -> str:
    return "0 mm" if way == 0.0 else quantity(way, "m", 2)
