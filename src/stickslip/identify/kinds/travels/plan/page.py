"""A plan of travels as a sheet to print and to fill in by hand."""

from collections.abc import Mapping, Sequence
from typing import Final

from stickslip.identify.kinds.travels.fit import unit_of
from stickslip.identify.kinds.travels.plan.sheet import Plan
from stickslip.identify.kinds.travels.plan.tables import SheetTable, tables_of
from stickslip.show.formatting import number
from stickslip.show.report import (
    Blank,
    Block,
    Code,
    Column,
    KeyValue,
    KeyValues,
    Name,
    Note,
    Page,
    Paragraph,
    Row,
    Section,
    Table,
    colophon,
)

NAVS: Final = {
    "before": "Before the runs",
    "settings": "Settings",
    "apart": "Which laws",
    "values": "Which values",
}
"""Sections with tables, as the line on top of the page names them."""
NUMERIC: Final = "0123456789\N{MINUS SIGN}"
"""With what numbers begin."""


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

    Examples
    --------
    >>> from stickslip import SpringBlock, plan
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> sheet = plan(rig, ["coulomb", "viscous"], uncertainty=0.004)
    >>> page = plan_page(sheet, title="Block", subject="rig.toml", save_as="", versions={})
    >>> [section.id for section in page.sections]
    ['before', 'settings', 'apart', 'values', 'runs']
    """
    tables = tables_of(plan)
    sections = [
        *(_section(plan, tables, name) for name in dict.fromkeys(table.name for table in tables)),
        _runs(plan, save_as),
        _reproduce(reproduce, versions, digest),
    ]
    return Page(
        title=f"Lab sheet: {title}",
        subject=subject,
        kicker="plan of travels",
        sections=tuple(section for section in sections if section is not None),
        footer=colophon(versions),
    )


def _section(plan: Plan, tables: Sequence[SheetTable], name: str) -> Section:
    """Return the section of the tables of one name."""
    blocks: list[Block] = []
    if name == "before":
        blocks.append(Paragraph(text=f"{plan.sentence} {plan.band_sentence}"))
        blocks += [Note(title="Note.", text=line) for line in plan.remarks]
    mine = [table for table in tables if table.name == name]
    for table in mine:
        if table.rows:
            blocks.append(_table(plan, table))
        if table.lines:
            items = [KeyValue(key=head, value=text) for head, text in table.lines.items()]
            blocks.append(KeyValues(items=tuple(items)))
    return Section(id=name, nav=NAVS[name], heading=mine[0].title, blocks=tuple(blocks))


def _table(plan: Plan, table: SheetTable) -> Table:
    """Return a table of a plan as one of a page, with cards on a phone."""
    unit, _ = unit_of(plan.settings[0].unit)
    columns: list[Column] = []
    for i, head in enumerate(table.heads):
        label = f"at {head} {unit}".replace(" °", "°") if table.name == "settings" else head
        # words beside a column of numbers are on its side, or they touch it
        numeric = any(column.numeric for column in columns) or all(
            row.cells[i][:1] in NUMERIC for row in table.rows
        )
        columns.append(
            Column(
                head=head.replace(" [", "\n["),
                numeric=numeric,
                phone="label" if i else "show",
                label=label if i else "",
            )
        )
    rows = [
        Row(
            cells=(Name(text=first, aside=row.aside) if row.aside else first, *others),
            chosen=row.chosen,
            muted=row.muted,
        )
        for row in table.rows
        for first, *others in [row.cells]
    ]
    return Table(columns=tuple(columns), rows=tuple(rows), caption=table.caption)


def _runs(plan: Plan, save_as: str) -> Section:
    """Return the table to fill in."""
    unit, factor = unit_of(plan.settings[0].unit)
    columns = (
        Column(head="run"),
        Column(
            head=f"{plan.knob}\n[{unit}]",
            numeric=True,
            phone="label",
            label=f"{plan.knob} [{unit}]",
        ),
        Column(head="travel\n[mm]", phone="label", label="travel [mm]"),
        Column(head="remarks", phone="hide"),
    )
    rows = tuple(
        Row(
            cells=(
                name,
                number(factor * one.value),
                Blank(what="travel"),
                Blank(what="remarks"),
            )
        )
        for name, one in plan.runs().items()
    )
    head, first, *_ = plan.csv().splitlines()
    text = (
        "Make the runs in this order: the settings go up and down again, so that wear and warm-up"
        " are not mistaken for their effect. Measure each travel from the start to the rest"
        " position of the body."
    )
    save = (
        "Save the table as a CSV file with these columns. A column `uncertainty [mm]`, the"
        " standard uncertainty of each travel, is optional; without it the scatter of the repeats"
        " is used."
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
        id="reproduce",
        nav="Reproduce this sheet",
        heading="Reproduce this sheet",
        blocks=tuple(blocks),
    )
