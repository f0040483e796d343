"""The paper's Table II beside ours, and its criteria applied again."""

from stickslip.formatting import (
    fixed,
    in_words,
    joined,
    percent,
    quantity,
    signed_percent,
    significant,
)
from stickslip.paper.audit import PaperAudit, TableRow
from stickslip.paper.sections.common import travel_axis
from stickslip.report import (
    Block,
    Caption,
    Column,
    Mark,
    Name,
    Note,
    Number,
    Paragraph,
    Row,
    RowPlot,
    Section,
    Subheading,
    Table,
)

__all__ = ["ranking_section", "table_section"]


def table_section(found: PaperAudit) -> Section:
    """Show every row of Table II, its three columns beside ours in readings A and B."""
    titles = {row.law.name: row.law.title for row in found.table}
    others = [f"{titles[name]} ({fixed(x, 3)} m)" for name, x in found.viscous_travels.items()]
    text = (
        f"The same {in_words(len(found.table))} models with the coefficients of Table I. What the"
        f" paper does not print is assumed: {_assumptions(found)}. With the spring released, the"
        " models differ only by what is assumed: with the same viscous part, which (5) and (9) also"
        f" have, {joined(others)} come close to Coulomb + viscous."
    )
    return Section(
        id="table2",
        nav="Table II",
        heading="The paper’s Table II beside ours",
        blocks=(Paragraph(text=text), _table(found)),
    )


def _assumptions(found: PaperAudit) -> str:
    """List the assumed values in the paper's own terms."""
    values = found.values
    return (
        f"$sigma_2$ {values.viscous:g} N s/m in Coulomb + viscous and none in Stribeck and LuGre,"
        f" $v_s$ {1e3 * values.stribeck_velocity:g} mm/s,"
        f" bristles of {significant(values.stiffness, 2)} N/m and"
        f" {significant(values.damping, 2)} N s/m"
    )


def _table(found: PaperAudit) -> Table:
    columns = (
        Column(head="friction model"),
        Column(
            head="velocity\npositive", phone="label", label="velocity always positive, published"
        ),
        Column(head="displacement\nm", numeric=True, phone="label", label="published, m"),
        Column(head="relative\nerror", numeric=True, phone="label", label="error, published"),
        Column(head="A, push\nm", numeric=True, phone="label", label="ours, A push, m"),
        Column(head="error", numeric=True, phone="label", label="error, A"),
        Column(head="B, spring\nm", numeric=True, phone="label", label="ours, B spring, m"),
        Column(head="error", numeric=True, phone="label", label="error, B"),
        Column(head="", axis=travel_axis(found, "travel, m; ring: published, triangle: A, dot: B")),
    )
    return Table(
        columns=columns,
        rows=tuple(_row(row) for row in found.table),
        caption=(
            "The first three columns after the name are printed in the paper. Our runs hold the"
            " block at its first stop, by the paper’s switch to static friction, and never move"
            " backwards."
        ),
    )


def _row(row: TableRow) -> Row:
    published = row.published.travel or 0.0
    push, spring = (row.reading(key).criteria for key in "AB")
    marks = (
        Mark(
            kind="link",
            at=min(push.travel, published),
            to=max(push.travel, published),
            colour="muted",
        ),
        Mark(kind="triangle", at=push.travel, colour="c2"),
        Mark(kind="ring", at=published, colour="muted"),
        Mark(kind="dot", at=spring.travel, colour="c1"),
    )
    return Row(
        cells=(
            Name(text=row.law.title, aside=row.published.note),
            "yes" if row.published.velocity_positive else "no",
            fixed(published, 2),
            percent(row.published.relative_error or 0.0),
            fixed(push.travel, 3),
            signed_percent(push.relative_error or 0.0),
            Number(value=fixed(spring.travel, 3)),
            signed_percent(spring.relative_error or 0.0),
            RowPlot(marks=marks),
        )
    )


def ranking_section(found: PaperAudit) -> Section:
    """Apply the paper's own criteria to its table and to ours, with our verdict beside."""
    ranks = [found.ranking(key) for key in ("published", "A", "B")]
    columns = (
        Column(head="friction model"),
        Column(head="published", numeric=True, phone="label", label="rank, published"),
        Column(head="A, push", numeric=True, phone="label", label="rank, A"),
        Column(head="B, spring", numeric=True, phone="label", label="rank, B"),
        Column(head="by select"),
    )
    rows = tuple(
        Row(
            cells=(
                row.law.title,
                *(str(one.get(row.law.name, "rejected")) for one in ranks),
                _ours(found, row),
            )
        )
        for row in found.table
    )
    return Section(
        id="ranking",
        nav="The ranking",
        heading="The paper’s own criteria, applied again",
        blocks=(
            Paragraph(
                text=(
                    "By the criteria of the paper the velocity never becomes negative and the"
                    " displacement never decreases; among the models that meet them the least"
                    " relative error decides. In the printed table this excludes"
                    " LuGre and puts Coulomb and Coulomb + viscous first, as the paper concludes."
                )
            ),
            Table(columns=columns, rows=rows),
            Caption(text=_caption(found)),
            _note(found),
            Subheading(text="What (11) allows"),
            Paragraph(text=_energy_text(found)),
        ),
    )


def _ours(found: PaperAudit, row: TableRow) -> str:
    """Say what selection makes of a law: one travel, one value that reproduces it."""
    named = [one for one in found.verdict.candidates if one.name == row.law.name]
    if not named or named[0].fit is None or not named[0].fit.estimates:
        return "no value reproduces the travel"
    estimate = named[0].fit.estimates[0]
    symbol, value = estimate.quantity.symbol, significant(estimate.value, 3)
    return f"not ranked: ${symbol}$ = {value} reproduces the travel"


def _caption(found: PaperAudit) -> str:
    errors = sorted(abs(row.reading("B").criteria.relative_error or 0.0) for row in found.table)
    half = 0.005 / found.measured
    return (
        f"In B the errors of the first four are {percent(errors[0])} to {percent(errors[3])}, while"
        f" the measured travel is rounded to ± {percent(half)}: their order means nothing, and the"
        " place of Coulomb + viscous follows from its assumed coefficient. Each law has a value"
        " that reproduces one travel, so `select` ranks none; it names Coulomb, which needs the"
        " fewest assumptions."
    )


def _note(found: PaperAudit) -> Block:
    """Say what criterion 1 does to laws with elastic presliding."""
    backs = [
        f"{1e3 * back.criteria.least_velocity:.2g} mm/s and"
        f" {1e6 * back.criteria.largest_return:.0f} µm for {back.law.title}"
        for back in found.springbacks
    ]
    speeds = " and ".join(backs).replace("-", "−")
    return Note(
        title="The first criterion rejects elastic spring-back, which is physical.",
        text=(
            "Bristles are springs, and a block on them springs back when it stops. With bristles of"
            " 10⁵ N/m and nothing to hold the block, the lowest velocity and the back-slip are"
            f" {speeds}, taken with the other values of its 1995 paper. In the"
            " tables above the block is held at its first stop, by the paper’s"
            f" switch to static friction, and no row fails for that reason.{_soft_text(found)}"
        ),
    )


def _soft_text(found: PaperAudit) -> str:
    """Grant that the run which gives the published row of LuGre is rightly rejected."""
    need = found.requirement("lugre")
    if need is None or need.value is None or need.criteria is None:
        return ""
    values = found.values
    bent = values.mu_k * values.load / need.value
    return (
        f" The run that gives the published {need.published:.2f} m of LuGre, with bristles of"
        f" {significant(need.value, 3)} N/m, goes back by"
        f" {quantity(need.criteria.largest_return, 'm', 2)}. Its bristles bend by"
        f" {quantity(bent, 'm', 2)} before slip, where the paper describes a very tiny displacement"
        " (III.B.3): to reject this run is right. It speaks against the value, not the law."
    )


def _energy_text(found: PaperAudit) -> str:
    """Answer the step from (11) to a choice by travel: what follows from it, and what does not."""
    work = 0.5 * found.values.rig.stiffness * found.values.rig.compression**2
    return (
        "From (11) the paper concludes that the displacement is unique for given parameters and"
        " can therefore select the model. The first part is right, and useful: a law whose"
        " parameters are known from elsewhere predicts one travel, and a measurement can refute it."
        " The second needs those parameters. (11) holds for every law with its mean friction along"
        " the path in place of $mu$$m$$g$, and the measured travel fixes that mean at"
        f" {quantity(work, 'J')} / {found.measured:.2f} m = {quantity(work / found.measured, 'N')},"
        " and with it one value in each law: the last column above. The paper has $mu_d$ and"
        " $mu_s$ from a handbook and does not print the other parameters, so that its comparison"
        " tests model and values together. Travels from several compressions can tell models apart:"
        " by (11) $s$ grows as $x$² under Coulomb friction, under purely viscous friction as $x$,"
        " and under both together in between."
    )
