"""The paper's Table II beside ours, and its criteria applied again."""

from collections.abc import Mapping

from stickslip.formatting import (
    fixed,
    joined,
    number,
    percent,
    quantity,
    scale_of,
    signed_percent,
    significant,
    with_unit,
)
from stickslip.paper.audit import PaperAudit, TableRow
from stickslip.paper.sections.common import fitted_text, travel_axis
from stickslip.report import (
    Caption,
    Column,
    Mark,
    Name,
    Number,
    Paragraph,
    Row,
    RowPlot,
    Section,
    Table,
)
from stickslip.solver import BreakAway


def table_section(found: PaperAudit) -> Section:
    """Show every row of Table II beside ours in readings A and B, and the push in 10 ms steps."""
    text = (
        "A: the push, solved exactly, and in steps of 10 ms, the sample time that the paper states"
        f" for its cart. {found.values.own_reading}: the spring, solved exactly. {_origin(found)}:"
        f" {_assumptions(found)}. “Coulomb plus viscous plus static”, which the paper names, has no"
        " row in it."
    )
    if found.viscous_travels and found.values.own_reading == "B":
        titles = {row.law.name: row.law.title for row in found.table}
        travels = [f"{titles[name]} {fixed(x, 3)} m" for name, x in found.viscous_travels.items()]
        text += (
            " With the same viscous part, which (5) and (9) have too, the spring gives"
            f" {joined(travels)}: between the rows of B lies what is assumed, not the model."
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


def _origin(found: PaperAudit) -> str:
    if not found.own:
        return "Levels are those of Table I; what the paper does not print is assumed"
    return (
        "The file of this rig gives the levels, or its travels do; what neither gives is assumed as"
        " for the rig of the paper"
    )


def _assumptions(found: PaperAudit) -> str:
    """List the values that are not printed, in the paper's own terms."""
    values = found.values
    fitted = f" {fitted_text(found)}" if fitted_text(found) else ""
    return (
        f"$sigma_2$ {quantity(values.viscous, 'N s/m', 2)}{fitted} in Coulomb + viscous and none"
        f" in Stribeck and LuGre, $v_s$ {number(1e3 * values.stribeck_velocity)} mm/s,"
        f" bristles of {significant(values.stiffness, 2)} N/m and"
        f" {significant(values.damping, 2)} N s/m"
    )


RULES: Mapping[BreakAway, str] = {"zero": "sgn 0 = 0", "static": "from break-away"}
"""What the friction in the first step out of rest is called."""


def _table(found: PaperAudit) -> Table:
    printed = () if found.own else (
        Column(head="published\nm", numeric=True, phone="label", label="published, m"),
    )  # fmt: skip
    reading = found.values.own_reading
    spring = "B, spring" if reading == "B" else "C, fixed spring"
    travels = [row.published.travel or 0.0 for row in found.table]
    travels += [reading.criteria.travel for row in found.table for reading in row.readings]
    marks = f"travel, m; triangle: A, dot: {reading}, line: measured"
    columns = (
        Column(head="friction model"),
        *printed,
        Column(head="A, exact\nm", numeric=True, phone="label", label="A exact, m"),
        *(
            Column(
                head=f"A, 10 ms\n{what}",
                numeric=True,
                phone="label",
                label=f"10 ms, {what}",
            )
            for what in RULES.values()
        ),
        Column(head=f"{spring}\nm", numeric=True, phone="label", label=f"{spring}, m"),
        Column(
            head="",
            axis=travel_axis(found, travels, marks if found.own else f"{marks}, ring: published"),
        ),
    )
    caption = (
        f"Below each travel its error against the measured {_metres(found)}. All runs hold the"
        " block at its first stop, by the paper’s switch to static friction."
    )
    return Table(
        columns=columns, rows=tuple(_row(found, row) for row in found.table), caption=caption
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
    return Row(
        cells=(
            Name(text=row.law.title, aside=row.published.note),
            *(() if found.own else (_with_error(found, published, 2),)),
            _with_error(found, push.travel),
            *(_with_error(found, row.coarse.get(rule)) for rule in RULES),
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
    """Say what the columns of 10 ms are, and why bristle laws have no entry in them."""
    limits = [
        f"{quantity(row.largest_step, 's', 2)} ({row.law.title})"
        for row in found.table
        if not row.coarse and row.largest_step is not None
    ]
    text = (
        "Steps of 10 ms: forward Euler with a rule that holds the block where its velocity changes"
        " sign. In the first step out of rest there is no friction where sgn 0 = 0; by (5), and in"
        " Karnopp’s scheme [18], it begins at $F_s$."
    )
    if limits:
        text += f" The bristles assumed here need steps below {joined(limits)}."
    return text


def _trial_table(found: PaperAudit) -> Table:
    """Show every trial with the travel of each model at its compression."""
    scale = scale_of([trial.compression for trial in found.trials], "m")
    columns = (
        Column(head="compression"),
        Column(head="measured\nm", numeric=True, phone="label", label="measured, m"),
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
                with_unit(number(scale.factor * trial.compression), scale.unit),
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
    names = {"published": "published", "A": "A, push", "B": "B, spring", "C": "C, fixed spring"}
    columns = (
        Column(head="friction model"),
        *(
            Column(head=f"{names[key]}: both\ncriteria, rank", phone="label", label=names[key])
            for key in keys
        ),
        Column(head="by select", phone="label"),
    )
    rows = tuple(
        Row(cells=(row.law.title, *(_judged(found, row, key) for key in keys), _ours(found, row)))
        for row in found.table
    )
    return Section(
        id="ranking",
        nav="Criteria",
        heading=_ranking_heading(found),
        blocks=(
            Paragraph(text=_criteria_text(found)),
            Table(columns=columns, rows=rows),
            *(() if found.own else (Caption(text=_caption(found)),)),
            *((Paragraph(text=_energy_text(found)),) if reading == "B" else ()),
        ),
    )


def _met(found: PaperAudit, key: str) -> int:
    return sum(
        seen.velocity_never_negative and seen.displacement_never_decreases
        for seen in (row.reading(key).criteria for row in found.table)
    )


def _ranking_heading(found: PaperAudit) -> str:
    total, keys = len(found.table), ("A", found.values.own_reading)
    met = [_met(found, key) for key in keys]
    if all(count == total for count in met):
        return "Every exact run that holds the block meets both criteria of the paper"
    return "The two criteria of the paper, applied to our runs"


def _judged(found: PaperAudit, row: TableRow, key: str) -> str:
    """Return the rank of a law by the criteria, or which of them it fails."""
    rank = found.ranking(key).get(row.law.name)
    if rank is not None:
        return f"met, {rank}"
    if key == "published":
        return "—" if row.published.travel is None else "velocity negative"
    seen = row.reading(key).criteria
    return f"fails: goes back {quantity(seen.largest_return, 'm', 2)}"


def _criteria_text(found: PaperAudit) -> str:
    """Say what the criteria reject among our runs, and that this is physical for bristles."""
    backs = [
        f"{back.law.title} {significant(1e3 * back.criteria.least_velocity, 2)} mm/s and"
        f" {quantity(back.criteria.largest_return, 'm', 2)}"
        for back in found.springbacks
    ]
    free = next(row for row in found.fixed_steps if row.dt is not None and not row.stick_rule)
    return (
        "The velocity never becomes negative, and the displacement never decreases; of the models"
        " that meet both, the least relative error decides. What fails is, first, bristles of"
        f" 10⁵ N/m that nothing holds ({joined(backs)} backwards): they are springs, and to spring"
        f" back is physical.{_soft_text(found)} Second, fixed steps without a rule for rest: in"
        f" {1e3 * (free.dt or 0.0):g} ms the velocity changes its sign {free.reversals} times in"
        f" 1 s and reaches {significant(1e3 * free.criteria.least_velocity, 2)} mm/s. The criteria"
        " alone tell neither from a body that is really driven back."
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
            return named[0].dropped
        return f"held-out error {quantity(score, 'm', 2)}"
    estimate = fit.estimates[0]
    symbol, value = estimate.quantity.symbol, significant(estimate.value, 3)
    return f"${symbol}$ = {value} reproduces the travel"


def _caption(found: PaperAudit) -> str:
    errors = sorted(abs(row.reading("B").criteria.relative_error or 0.0) for row in found.table)
    half = found.values.uncertainty / found.measured
    return (
        f"In B the first four errors are {percent(errors[0])} to {percent(errors[3])}, and the"
        f" measured travel is rounded to ± {percent(half)}: their order means nothing."
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
        f" {quantity(need.criteria.largest_return, 'm', 2)} and bends by"
        f" $F_s$/$sigma_0$ = {quantity(bent, 'm', 2)} at break-away, where the paper describes a"
        " very tiny displacement: to reject it is right, and speaks against the value."
    )


def _energy_text(found: PaperAudit) -> str:
    """Answer the step from (11) to a choice by travel: what follows from it, and what does not."""
    work = 0.5 * found.values.rig.stiffness * found.values.rig.compression**2
    return (
        "From (11) the paper concludes that the displacement is unique for given parameters and"
        " can therefore select the model. The first is right. The second needs parameters from"
        " elsewhere: (11) holds for every law with its mean friction along the path, which the"
        f" travel fixes at {quantity(work, 'J')} / {_metres(found)} ="
        f" {quantity(work / found.measured, 'N')}, and with it one value in each law. Travels from"
        " several compressions tell models apart: $s$ grows as $x$² under Coulomb friction, as $x$"
        " under viscous friction."
    )


def _metres(found: PaperAudit) -> str:
    return f"{found.measured:.3f} m" if found.own else f"{found.measured:.2f} m"
