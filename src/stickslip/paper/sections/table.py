"""The paper's Table II beside ours, and its criteria applied again."""

from stickslip.formatting import (
    fixed,
    in_words,
    joined,
    number,
    percent,
    quantity,
    scale_of,
    signed_percent,
    significant,
)
from stickslip.paper.audit import PaperAudit, TableRow
from stickslip.paper.sections.common import levels_from, travel_axis
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


def table_section(found: PaperAudit) -> Section:
    """Show every row of Table II beside ours in readings A and B, and the push in 10 ms steps."""
    titles = {row.law.name: row.law.title for row in found.table}
    others = [f"{titles[name]} ({fixed(x, 3)} m)" for name, x in found.viscous_travels.items()]
    levels = levels_from(found)
    origin = (
        " The file of this rig gives the levels, or its travels do; what it does not give is"
        " assumed as for the rig of the paper"
        if found.own
        else " What the paper does not print is assumed"
    )
    text = (
        f"The {in_words(len(found.table))} models that the paper names, with the coefficients"
        f" {levels}.{origin}: {_assumptions(found)}; all assumptions are"
        " in one table below. “Coulomb plus viscous plus static” has neither an equation nor a row"
        " in the paper; its static level is that of Coulomb + viscous here, so that the two agree."
    )
    if others and found.values.own_reading == "B":
        text += (
            " With the spring released, the models differ only by what is assumed: with the same"
            f" viscous part, which (5) and (9) also have, {joined(others)} come close to"
            " Coulomb + viscous."
        )
    return Section(
        id="table2",
        nav="The six models" if found.own else "Table II",
        heading=(
            "The models of the paper on this rig"
            if found.own
            else "The paper’s Table II beside ours"
        ),
        blocks=(
            Paragraph(text=text),
            _table(found),
            Caption(text=_step_text(found)),
            *(() if len(found.trials) == 1 else (_trial_table(found),)),
        ),
    )


def _assumptions(found: PaperAudit) -> str:
    """List the assumed values in the paper's own terms."""
    values = found.values
    return (
        f"$sigma_2$ {number(values.viscous)} N s/m in Coulomb + viscous and none in Stribeck and"
        f" LuGre, $v_s$ {number(1e3 * values.stribeck_velocity)} mm/s,"
        f" bristles of {significant(values.stiffness, 2)} N/m and"
        f" {significant(values.damping, 2)} N s/m"
    )


def _table(found: PaperAudit) -> Table:
    printed = () if found.own else (
        Column(head="velocity\npositive", phone="label", label="velocity positive, published"),
        Column(head="published\nm", numeric=True, phone="label"),
    )  # fmt: skip
    reading = found.values.own_reading
    spring = "B, spring" if reading == "B" else "C, fixed spring"
    travels = [row.published.travel or 0.0 for row in found.table]
    travels += [reading.criteria.travel for row in found.table for reading in row.readings]
    marks = f"travel, m; triangle: A, dot: {reading}, line: measured"
    columns = (
        Column(head="friction model"),
        *printed,
        Column(head="A, push\nm", numeric=True, phone="label", label="A push, m"),
        Column(head="A, steps of\n10 ms, m", numeric=True, phone="label", label="A in 10 ms, m"),
        Column(head=f"{spring}\nm", numeric=True, phone="label", label=f"{spring}, m"),
        Column(
            head="",
            axis=travel_axis(found, travels, marks if found.own else f"{marks}, ring: published"),
        ),
    )
    caption = "Below each travel, its relative error."
    if reading == "B":
        caption += (
            " Our runs hold the block at its first stop, by the paper’s switch to static friction,"
            " and never move backwards."
        )
    return Table(
        columns=columns,
        rows=tuple(_row(found, row) for row in found.table),
        caption=caption
        if found.own
        else f"The two columns after the name are printed in the paper. {caption}",
    )


def _row(found: PaperAudit, row: TableRow) -> Row:
    published = row.published.travel
    push, spring = (row.reading(key).criteria for key in ("A", found.values.own_reading))
    marks = [
        Mark(kind="triangle", at=push.travel, colour="c2"),
        Mark(kind="dot", at=spring.travel, colour="c1"),
    ]
    if published is not None:
        marks.append(Mark(kind="ring", at=published, colour="muted"))
    positive = {None: "—", True: "yes", False: "no"}[row.published.velocity_positive]
    printed = () if found.own else (positive, _with_error(found, published, 2))
    return Row(
        cells=(
            Name(text=row.law.title, aside=row.published.note),
            *printed,
            _with_error(found, push.travel),
            _with_error(found, row.coarse),
            _with_error(found, spring.travel),
            RowPlot(marks=tuple(marks), lanes=2),
        )
    )


def _with_error(found: PaperAudit, travel: float | None, digits: int = 3) -> Name | str:
    """Return a travel with its relative error below it."""
    if travel is None:
        return "—"
    return Name(text=fixed(travel, digits), aside=signed_percent(travel / found.measured - 1.0))


def _step_text(found: PaperAudit) -> str:
    """Say what the column of 10 ms is, and why bristle laws have no entry in it."""
    limits = [
        f"{quantity(row.largest_step, 's', 2)} ({row.law.title})"
        for row in found.table
        if row.coarse is None and row.largest_step is not None
    ]
    text = (
        "Steps of 10 ms: forward Euler with a rule that holds the block where its velocity changes"
        " sign; 10 ms is the sample time that the paper states for its cart. Friction misses the"
        " first step, since sgn 0 = 0."
    )
    if limits:
        text += (
            f" The bristles assumed here need steps below {joined(limits)}; in longer ones their"
            " deflection grows without limit."
        )
    return text


def _trial_table(found: PaperAudit) -> Table:
    """Show every trial with the travel of each model at its compression."""
    scale = scale_of([trial.compression for trial in found.trials], "m")
    columns = (
        Column(head=f"compression\n{scale.unit}", numeric=True),
        Column(head="measured\nm", numeric=True),
        *(
            Column(
                head=row.law.title.replace(" + ", "\n+ "),
                numeric=True,
                phone="label",
                label=row.law.title,
            )
            for row in found.table
        ),
    )
    rows = tuple(
        Row(
            cells=(
                number(scale.factor * trial.compression),
                Number(value=fixed(trial.measured, 3)),
                *(fixed(trial.travels[row.law.name], 3) for row in found.table),
            )
        )
        for trial in found.trials
    )
    caption = (
        "All trials, as measured and with each model, travels in m. The figures and tables above"
        " and below show the first."
    )
    return Table(columns=columns, rows=rows, caption=caption)


def ranking_section(found: PaperAudit) -> Section:
    """Apply the paper's own criteria to its table and to ours, with our verdict beside."""
    reading = found.values.own_reading
    keys = ("A", reading) if found.own else ("published", "A", "B")
    ranks = [found.ranking(key) for key in keys]
    names = {"published": "published", "A": "A, push", "B": "B, spring", "C": "C, fixed spring"}
    columns = (
        Column(head="friction model"),
        *(
            Column(head=names[key], numeric=True, phone="label", label=f"rank, {names[key]}")
            for key in keys
        ),
        Column(head="by select"),
    )
    rows = tuple(
        Row(
            cells=(
                row.law.title,
                *(
                    "—"
                    if key == "published" and row.published.travel is None
                    else str(one.get(row.law.name, "rejected"))
                    for key, one in zip(keys, ranks, strict=True)
                ),
                _ours(found, row),
            )
        )
        for row in found.table
    )
    printed = (
        " In the printed table this excludes LuGre and puts Coulomb and Coulomb + viscous first,"
        " as the paper concludes."
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
                    f" relative error decides.{'' if found.own else printed}"
                )
            ),
            Table(columns=columns, rows=rows),
            *(() if found.own else (Caption(text=_caption(found)),)),
            _note(found),
            *(
                (Subheading(text="What (11) allows"), Paragraph(text=_energy_text(found)))
                if reading == "B"  # the block leaves its spring
                else ()
            ),
        ),
    )


def _ours(found: PaperAudit, row: TableRow) -> str:
    """Say what selection makes of a law: one travel, one value that reproduces it."""
    named = [one for one in found.verdict.candidates if one.name == row.law.name]
    if not named:
        return "not tried"
    fit = named[0].fit
    if fit is None or not fit.estimates:
        return "no value reproduces the travel" if len(found.trials) == 1 else named[0].dropped
    if len(found.trials) > 1:
        score = named[0].score
        if score is None:
            return named[0].unscored
        return f"held-out error {quantity(score, 'm', 2)}"
    estimate = fit.estimates[0]
    symbol, value = estimate.quantity.symbol, significant(estimate.value, 3)
    return f"not ranked: ${symbol}$ = {value} reproduces the travel"


def _caption(found: PaperAudit) -> str:
    errors = sorted(abs(row.reading("B").criteria.relative_error or 0.0) for row in found.table)
    half = found.values.uncertainty / found.measured
    return (
        f"In B the errors of the first four are {percent(errors[0])} to {percent(errors[3])}, while"
        f" the measured travel is rounded to ± {percent(half)}: their order means nothing, and the"
        " places of Coulomb + viscous and + static follow from an assumed coefficient. Each law has"
        " a value"
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
    bent = values.mu_s * values.load / need.value
    return (
        f" The run that gives the published {need.published:.2f} m of LuGre, with bristles of"
        f" {significant(need.value, 3)} N/m, goes back by"
        f" {quantity(need.criteria.largest_return, 'm', 2)}. Its bristles bend by"
        f" $F_s$/$sigma_0$ = {quantity(bent, 'm', 2)} at break-away, where the paper describes a"
        " very tiny displacement (III.B.3): to reject this run is right. It speaks against the"
        " value, not the law."
    )


def _energy_text(found: PaperAudit) -> str:
    """Answer the step from (11) to a choice by travel: what follows from it, and what does not."""
    work = 0.5 * found.values.rig.stiffness * found.values.rig.compression**2
    last = ": the last column above" if len(found.trials) == 1 else ""
    return (
        "From (11) the paper concludes that the displacement is unique for given parameters and"
        " can therefore select the model. The first part is right, and useful: a law whose"
        " parameters are known from elsewhere predicts one travel, and a measurement can refute it."
        " The second needs those parameters. (11) holds for every law with its mean friction along"
        " the path in place of $mu$$m$$g$, and the measured travel fixes that mean at"
        f" {quantity(work, 'J')} / {_metres(found)} = {quantity(work / found.measured, 'N')},"
        f" and with it one value in each law{last}. The paper has $mu_d$ and"
        " $mu_s$ from a handbook and does not print the other parameters, so that its comparison"
        " tests model and values together. Travels from several compressions can tell models apart:"
        " by (11) $s$ grows as $x$² under Coulomb friction, under purely viscous friction as $x$,"
        " and under both together in between."
    )


def _metres(found: PaperAudit) -> str:
    return f"{found.measured:.3f} m" if found.own else f"{found.measured:.2f} m"
