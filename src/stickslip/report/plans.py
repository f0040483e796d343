"""A plan of travels as a sheet to print and to fill in by hand."""

from collections.abc import Mapping, Sequence

from stickslip.quantities import fields_of
from stickslip.report import numbers
from stickslip.report.blocks import Block, Code, KeyValue, KeyValues, Note, Paragraph
from stickslip.report.documents import Page, Section
from stickslip.report.selection.texts import quantity_value
from stickslip.report.tables import Blank, Column, Name, Row, Table
from stickslip.selection import Plan
from stickslip.selection.lab_sheet import in_unit, unit_of
from stickslip.selection.separation import setting_text

__all__ = ["plan_page"]


def plan_page(
    plan: Plan,
    *,
    title: str,
    subject: str,
    save_as: str,
    reproduce: Sequence[str] = (),
    versions: Mapping[str, str],
    digest: str = "",
) -> Page:
    """Return the sheet of a plan.

    Parameters
    ----------
    plan : Plan
        What `stickslip.plan` gave.
    title : str
        What is measured.
    subject : str
        The rig, at the right of the top line.
    save_as : str
        Command that reads the filled sheet, with the name of its file.
    reproduce : sequence of str
        Commands that give this sheet again.
    versions : mapping of str to str
        Versions by name of the software; that of ``"stickslip"`` stands in the footer.
    digest : str
        Hash of the inputs.

    Examples
    --------
    >>> from stickslip import SpringBlock, plan
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> sheet = plan(rig, ["coulomb", "viscous"], uncertainty=0.004)
    >>> page = plan_page(sheet, title="Block", subject="rig.toml", save_as="", versions={})
    >>> [section.id for section in page.sections]
    ['before', 'settings', 'apart', 'values', 'runs']
    """
    sections = [
        _before(plan),
        _settings(plan),
        _apart(plan),
        _values(plan),
        _runs(plan, save_as),
        _reproduce(reproduce, versions, digest),
    ]
    version = f"stickslip {versions.get('stickslip', '')}".strip()
    return Page(
        title=f"Lab sheet: {title}",
        subject=subject,
        kicker="plan of travels",
        sections=tuple(section for section in sections if section is not None),
        footer=f"Written by {version}. This file is complete: it loads nothing and runs no script.",
    )


def _titles(plan: Plan) -> dict[str, str]:
    return {name: law.title for name, law in plan.laws.items()}


def _before(plan: Plan) -> Section:
    """Return what to measure before the runs."""
    columns = (
        Column(head="parameter"),
        Column(head="in the rig file", numeric=True, phone="label"),
        Column(
            head="know it to\n(standard uncertainty)",
            numeric=True,
            phone="label",
            label="know it to",
        ),
        Column(head="stated", phone="label"),
        Column(head="how"),
    )
    rows = [
        Row(
            cells=(
                f"{one.name.capitalize()} ${one.quantity.symbol}$",
                in_unit(one.value, one.quantity.unit, 4),
                f"{in_unit(one.needed, one.quantity.unit)}"
                f" ({numbers.percent(one.needed / abs(one.value))})",
                one.verdict,
                one.how,
            )
        )
        for one in plan.preparations
    ]
    blocks: list[Block] = [
        Paragraph(text=plan.sentence),
        *[Note(title="Left out.", text=line) for line in plan.remarks],
    ]
    level = _titles(plan)[plan.reference]
    if rows:
        caption = (
            f"Known so well, each of these adds half as much as the {_count(plan)} readings to the"
            f" uncertainty of the level of {level} friction; three of them widen its interval by a"
            " third. What all runs share does not average out; what is set anew for each run does."
        )
        blocks.append(Table(columns=columns, rows=tuple(rows), caption=caption))
    if plan.rest:
        items = [KeyValue(key=head, value=text) for head, text in plan.rest.items()]
        blocks.append(KeyValues(items=tuple(items)))
    return Section(
        id="before", nav="Before the runs", heading="Before the runs", blocks=tuple(blocks)
    )


def _count(plan: Plan) -> int:
    return len(plan.settings) * plan.repeats


def _settings(plan: Plan) -> Section:
    """Return the travels that each law predicts."""
    titles, settings = _titles(plan), [setting_text(row) for row in plan.settings]
    columns = [Column(head=f"travel predicted, mm\n{plan.knob}")]
    columns += [Column(head=one, numeric=True, phone="label") for one in settings]
    rows = [
        Row(
            cells=(
                Name(text=titles[name], aside=_values_of(plan, name)),
                *(numbers.fixed(1e3 * row.predicted[name], 1) for row in plan.settings),
            ),
            chosen=name == plan.reference,
        )
        for name in plan.laws
    ]
    known = f"each to {in_unit(plan.uncertainty, 'm')}"
    doubt = (
        f"Travels are taken to be known {known}, 2 % of the longest: an assumption, until repeats"
        " of one setting show their scatter."
        if plan.assumed
        else f"Travels are taken to be known {known}, scatter and reading together."
    )
    caption = f"All laws have the level that gives the same travel at the present setting. {doubt}"
    return Section(
        id="settings",
        nav="Settings",
        heading=f"What to set: {plan.repeats} runs at each of {len(settings)} settings",
        blocks=(Table(columns=tuple(columns), rows=tuple(rows), caption=caption),),
    )


def _values_of(plan: Plan, name: str) -> str:
    """Return the values of a law that were counted on."""
    law = plan.laws[name]
    found = []
    for field, quantity in fields_of(type(law)).items():
        value = getattr(law, field)
        if value is not None and value != 0.0 and not quantity.structural:
            found.append(f"${quantity.symbol}$ = {quantity_value(_three(value), quantity.unit)}")
    return ", ".join(found)


def _three(value: float) -> float:
    return float(f"{value:.3g}")


def _apart(plan: Plan) -> Section | None:
    """Return which laws can be told apart."""
    if not plan.tellings:
        return None
    titles = _titles(plan)
    columns = (
        Column(head="if this law holds"),
        Column(head="this one is ruled out", phone="label", label="rules out"),
        Column(head="largest\ndifference", numeric=True, phone="label", label="difference"),
        Column(head="at", numeric=True, phone="label"),
        Column(head="by"),
    )
    rows = [
        Row(
            cells=(
                titles[one.holds],
                titles[one.rival],
                in_unit(one.gap, "m"),
                setting_text(one.setting),
                one.effort,
            ),
            muted=one.repeats is None,
        )
        for one in plan.tellings
    ]
    told = sum(one.repeats is not None for one in plan.tellings)
    caption = (
        "Difference: what is left when the law that is to be ruled out is fitted to the travels of"
        " the other one. Ruled out: by the test of `stickslip select`, in nine of ten such sets of"
        f" readings. Grey: not in {plan.tellings[0].most} runs at each setting."
    )
    return Section(
        id="apart",
        nav="Which laws",
        heading=f"The runs tell {told} of {len(plan.tellings)} pairs of laws apart",
        blocks=(Table(columns=columns, rows=tuple(rows), caption=caption),),
    )


def _values(plan: Plan) -> Section:
    """Return what the runs will tell of each parameter."""
    titles = _titles(plan)
    columns = (
        Column(head="law"),
        Column(head="parameter", phone="label"),
        Column(head="if it is", numeric=True, phone="label"),
        Column(head="expected interval\n95 %", numeric=True, phone="label", label="interval"),
        Column(head="so"),
    )
    rows = []
    for one in plan.expectations:
        estimate = one.estimate
        unit = "" if estimate.quantity.unit == "1" else f" {estimate.quantity.unit}"
        rows.append(
            Row(
                cells=(
                    titles[one.law],
                    f"${estimate.quantity.symbol}$",
                    quantity_value(_three(estimate.value), estimate.quantity.unit),
                    f"{estimate.range}{unit if estimate.bounded else ''}",
                    "known" if one.identified else _open(plan, one.law, one.advice),
                ),
                muted=not one.identified,
            )
        )
    caption = (
        "The interval to expect if the law holds with that value and the rig is known as stated, or"
        " else as needed. What is not fitted by `stickslip select` is fitted here beside what is:"
        " it shows what the travels could tell of it at best."
    )
    return Section(
        id="values",
        nav="Which values",
        heading="What the runs will tell of each law",
        blocks=(Table(columns=columns, rows=tuple(rows), caption=caption),),
    )


def _open(plan: Plan, law: str, advice: str) -> str:
    """Return that a parameter is left open, and once for each advice what would tell it."""
    first = next(one for one in plan.expectations if one.advice == advice)
    return f"not identified. {advice}" if advice and first.law == law else "not identified"


def _runs(plan: Plan, save_as: str) -> Section:
    """Return the table to fill in."""
    unit, factor = unit_of(plan.settings[0].unit)
    columns = (
        Column(head="run"),
        Column(head=f"{plan.knob}\n{unit}", numeric=True, phone="label"),
        Column(head="travel\nmm", phone="label", label="travel, mm"),
        Column(head="remarks", phone="hide"),
    )
    rows = tuple(
        Row(
            cells=(
                name,
                f"{factor * one.value:.10g}",
                Blank(what="travel"),
                Blank(what="remarks"),
            )
        )
        for name, one in plan.runs().items()
    )
    head, first, *_ = plan.csv().splitlines()
    text = (
        "Make the runs in this order: settings go up and down again, so that wear and warmth are"
        " not taken for their effect. Measure each travel from where the body starts to where it"
        " rests."
    )
    save = (
        "Save the table as a CSV file with these columns. A column `uncertainty [mm]`, the standard"
        " uncertainty of each travel, may stand beside them; without it the scatter of the repeats"
        " counts."
    )
    blocks: list[Block] = [
        Paragraph(text=text),
        Table(columns=columns, rows=rows),
        Paragraph(text=save),
        Code(text="\n".join([head, f"{first}...", *([f"\n$ {save_as}"] if save_as else [])])),
    ]
    return Section(id="runs", nav="The runs", heading="The runs", blocks=tuple(blocks))


def _reproduce(commands: Sequence[str], versions: Mapping[str, str], digest: str) -> Section | None:
    items = [KeyValue(key=name, value=version) for name, version in versions.items()]
    if digest:
        items.append(KeyValue(key="Hash of the inputs", value=f"`{digest}`"))
    blocks: list[Block] = []
    if commands:
        blocks.append(Code(text="\n".join(f"$ {command}" for command in commands)))
    if items:
        blocks.append(KeyValues(items=tuple(items)))
    if not blocks:
        return None
    return Section(
        id="reproduce", nav="This sheet again", heading="This sheet again", blocks=tuple(blocks)
    )
