"""What the parameters that the paper does not print would have to be."""

from stickslip.formatting import fixed, in_words, number, significant
from stickslip.paper.audit import PaperAudit
from stickslip.paper.sections.common import values_of
from stickslip.paper.unpublished import Requirement, StepTravel
from stickslip.report import Column, Name, Paragraph, Row, Section, Subheading, Table


def unpublished_section(found: PaperAudit) -> Section:
    """Show the value behind each published row with its range, for a push and for a spring."""
    total = sum(row.published.travel is not None for row in found.table)
    reached = {key: _reached(found, key) for key in "AB"}
    columns = (
        Column(head="row"),
        Column(head="published\nm", numeric=True, phone="label"),
        Column(head="A, push: would need", numeric=True, phone="label", label="A would need"),
        Column(head="B, spring: would need", numeric=True, phone="label", label="B would need"),
        Column(head="what that means"),
    )
    needs = {(need.law, need.reading): need for need in found.requirements}
    rows = tuple(
        Row(
            cells=(
                row.law.title,
                fixed(row.published.travel or 0.0, 2),
                *(_value(needs[row.law.name, key]) for key in "AB"),
                needs[row.law.name, "A"].text,
            )
        )
        for row in found.table
        if (row.law.name, "A") in needs
    )
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
            Table(columns=columns, rows=rows),
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
    reached = sum(one.reached for one in found.step_travels)
    total = len(found.step_travels)
    return f"In steps of 10 ms, {in_words(reached)} of {in_words(total)}, Table I kept"


def _step_table(found: PaperAudit) -> Table:
    """Show what steps of 10 ms make of the push, by the friction in the first step."""
    titles = {row.law.name: row.law.title for row in found.table}
    columns = (
        Column(head="row"),
        Column(head="published\nm", numeric=True, phone="label", label="published, m"),
        Column(head="sgn 0 = 0\nm", numeric=True, phone="label", label="sgn 0 = 0, m"),
        Column(head="from break-away\nm", numeric=True, phone="label", label="from break-away, m"),
        Column(head="with"),
    )
    rows = tuple(
        Row(
            cells=(
                titles[one.row],
                fixed(one.published, 2),
                *step_cells(one),
                values_of(one.law, found.values.load)
                if one.scatter is None
                else f"(5), sgn $v$ added, no rule for rest; {values_of(one.law)}",
            )
        )
        for one in found.step_travels
    )
    caption = (
        "The push by forward Euler in the sample time that the paper states for its cart. The 0.16"
        " m of both Coulomb rows need sgn 0 = 0 in the first step; bristles have no such step."
        " Which of these it was cannot be told from the paper."
    )
    return Table(columns=columns, rows=rows, caption=caption)


def step_cells(one: StepTravel) -> tuple[str, str]:
    """Return the travel where sgn 0 = 0 and where friction begins at the break-away level."""
    if one.scatter is None:
        return fixed(one.travel, 3), fixed(one.static, 3)
    low, high = one.scatter
    return "—", f"{fixed(low, 2)} to {fixed(high, 2)}"


def _creep_text(found: PaperAudit) -> str:
    """Say how (5) reaches its printed travel in steps, and what speaks against it."""
    least = min(one.least_velocity for one in found.creeps)
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
    columns = (
        Column(head="Stribeck velocity"),
        Column(head="10 ms, no rule\nmean, m", numeric=True, phone="label", label="mean, m"),
        Column(head="scatter\nm", numeric=True, phone="label"),
        Column(head="10 ms, rule\nfor rest, m", numeric=True, phone="label", label="with rule, m"),
        Column(head="1 ms, no rule\nm", numeric=True, phone="label", label="in 1 ms, m"),
    )
    rows = tuple(
        Row(
            cells=(
                f"$v_s$ = {significant(1e3 * one.stribeck_velocity, 4)} mm/s",
                fixed(one.mean, 2),
                f"{fixed(min(one.travels), 2)} to {fixed(max(one.travels), 2)}",
                fixed(one.held, 3),
                fixed(one.fine, 3),
            )
        )
        for one in found.creeps
    )
    speed = number(1e3 * found.values.stribeck_velocity)
    caption = (
        "Travel of the push after 10 s; the rule for rest holds the block where its velocity"
        f" changes sign, and friction begins at $F_s$. Table II has $v_s$ = {speed} mm/s."
    )
    return Table(columns=columns, rows=rows, caption=caption)


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
    columns = (
        Column(head="bristles"),
        Column(head="Dahl, held\nm", numeric=True, phone="label"),
        Column(head="LuGre, free\nm", numeric=True, phone="label"),
        Column(
            head="LuGre, lowest\nvelocity, mm/s",
            numeric=True,
            phone="label",
            label="LuGre, lowest velocity, mm/s",
        ),
    )
    dahl = [row for row in found.bristles if row.law == "dahl"]
    lugre = [row for row in found.bristles if row.law == "lugre"]
    rows = tuple(
        Row(
            cells=(
                f"{significant(one.stiffness, 1)} N/m",
                fixed(one.criteria.travel, 4),
                fixed(other.criteria.travel, 4),
                significant(1e3 * other.criteria.least_velocity, 2),
            )
        )
        for one, other in zip(dahl, lugre, strict=True)
    )
    caption = (
        "The push, solved exactly; LuGre with the other values of its 1995 paper. Published: Dahl"
        " 0.25 m, LuGre 0.13 m with a velocity that becomes negative."
    )
    return Table(columns=columns, rows=rows, caption=caption)
