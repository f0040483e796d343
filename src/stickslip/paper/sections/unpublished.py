"""What the parameters that the paper does not print would have to be."""

from stickslip.formatting import fixed, in_words, joined, significant
from stickslip.friction import FrictionLaw
from stickslip.paper.audit import PaperAudit
from stickslip.paper.unpublished import Requirement
from stickslip.report import Caption, Column, Name, Paragraph, Row, Section, Subheading, Table


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
                    "The paper prints no stiffness or damping of bristles, no Stribeck velocity and"
                    " no viscous coefficient. The values below, found by root finding in readings A"
                    " and B, give its travels; under each value is the range for travels that round"
                    " to the printed figure. All runs of this table are solved exactly. Coulomb"
                    " would need another coefficient than Table I’s, and Stribeck less dry friction"
                    " than Table I has, since forwards (5) never falls below Coulomb friction. For"
                    " the push no viscous coefficient gives the row of Coulomb + viscous."
                )
            ),
            Table(columns=columns, rows=rows),
            Paragraph(text=_step_text(found)),
            Subheading(text="The 0.45 m of Stribeck, from (5) in steps"),
            Paragraph(text=_creep_text(found)),
            _creep_table(found),
            Subheading(text="The 0.25 m of Dahl and 0.13 m of LuGre, by stiffness"),
            _bristle_table(found),
            Caption(
                text=(
                    "That a value gives the row does not show that it was used. Only the parameters"
                    " of the paper’s simulations could settle that."
                )
            ),
        ),
    )


def _reached(found: PaperAudit, key: str) -> int:
    return sum(
        need.value is not None and need.kept and need.reading == key for need in found.requirements
    )


def _step_text(found: PaperAudit) -> str:
    """Say what steps of 10 ms make of the rows that the exact push does not reach."""
    parts = [
        f"{fixed(one.travel, 3)} m with {one.law.title}"
        + (f" ($sigma_2$ = {value:g} N s/m)" if (value := _viscous(one.law)) else "")
        for one in found.step_travels
    ]
    return (
        "The 0.16 m of Coulomb and of Coulomb + viscous can also come from the time step: in steps"
        " of 10 ms, the sample time that the paper states for its cart, forward Euler with the"
        f" stick rule gives {joined(parts)} for the push, with Table I’s coefficients. Friction"
        " misses the first step, since sgn 0 = 0; the exact push gives 0.154 m. Which of these it"
        " was cannot be told from the paper."
    )


def _creep_text(found: PaperAudit) -> str:
    """Say how (5) reaches its printed travel in steps, and what speaks against it."""
    row = next(one for one in found.table if one.law.name == "stribeck")
    travel = row.published.travel or 0.0
    inside = [one for one in found.creeps if min(one.travels) <= travel <= max(one.travels)]
    at = joined([f"{significant(1e3 * one.stribeck_velocity, 4)} mm/s" for one in inside])
    least = min(one.least_velocity for one in found.creeps)
    reaches = (
        f" At $v_s$ = {at} the printed {fixed(travel, 2)} m lies among them, with Table I kept."
        if inside
        else ""
    )
    return (
        "As printed, (5) drives the block backwards without end once its velocity is negative."
        " With the sgn $v$ that it lacks, but its exponent as printed, it creeps forwards instead,"
        " in the paper’s steps of 10 ms by forward Euler and without a rule for rest: backwards"
        " its friction exceeds $F_s$, so that each step back is followed by a larger one forwards."
        f" The push gives the travels below after 10 s.{reaches} That agrees with what the paper"
        " says of its Fig. 8, that the velocity does not become exactly zero; the Yes of Table II"
        f" does not agree, since the velocity falls to {significant(1e3 * least, 2)} mm/s again and"
        " again. The creep is a matter of the step, and chaotic: $v_s$ that differ by 10⁻⁹ of"
        " themselves give the scatter shown, whose digits differ between computers. With the rule"
        " for rest the block stays where it stops, and in steps of 1 ms it creeps by millimetres."
    )


def _creep_table(found: PaperAudit) -> Table:
    columns = (
        Column(head="$v_s$\nmm/s", numeric=True, label="Stribeck velocity, mm/s"),
        Column(head="10 ms, no rule\nmean, m", numeric=True, phone="label", label="mean, m"),
        Column(head="scatter\nm", numeric=True, phone="label"),
        Column(head="10 ms, rule\nfor rest, m", numeric=True, phone="label", label="with rule, m"),
        Column(head="1 ms, no rule\nm", numeric=True, phone="label", label="in 1 ms, m"),
    )
    rows = tuple(
        Row(
            cells=(
                significant(1e3 * one.stribeck_velocity, 4),
                fixed(one.mean, 2),
                f"{fixed(min(one.travels), 2)} to {fixed(max(one.travels), 2)}",
                fixed(one.held, 3),
                fixed(one.fine, 3),
            )
        )
        for one in found.creeps
    )
    return Table(columns=columns, rows=rows)


def _viscous(law: FrictionLaw) -> float:
    return float(getattr(law, "viscous_coefficient", 0.0))


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
        "The push of reading A with softer and softer bristles; LuGre with the other values of its"
        " 1995 paper, as in the table above."
        " Published: Dahl 0.25 m, LuGre 0.13 m with a velocity that becomes negative."
    )
    return Table(columns=columns, rows=rows, caption=caption)
