"""The battery of one law, or of several side by side, as a page."""

from collections.abc import Mapping, Sequence

from stickslip.quantities import fields_of
from stickslip.show.formatting import joined, number, quantity
from stickslip.show.plots import draw_characteristic, inline_svg
from stickslip.show.report import blocks as page
from stickslip.show.report.shared_sections import law_references
from stickslip.show.report.tables import Column, Name, Row, Table
from stickslip.study.characterization import Characteristic, Characterization

MANY = 4
"""Laws from which on the title does not name all."""


def characterization_page(
    found: Characterization, *, reproduce: Sequence[str] = (), versions: Mapping[str, str]
) -> page.Page:
    """Return the page of a battery.

    Examples
    --------
    >>> from stickslip import Coulomb, characterize
    >>> found = characterize(Coulomb(kinetic_coefficient=0.25), tests=["steady"])
    >>> page = characterization_page(found, versions={})
    >>> [section.id for section in page.sections]
    ['overview', 'laws', 'steady', 'reproduce']
    """
    titles = [law.title for law in found.all]
    tests = [_test(name, results, found) for name, results in found.by_test.items()]
    return page.Page(
        title=joined(titles) if len(titles) < MANY else f"{titles[0]} and {len(titles) - 1} more",
        subject=f"normal force {quantity(found.load, 'N')}",
        kicker="friction laws on the test bench",
        sections=(_overview(found), _laws(found), *tests, _end(found, reproduce, versions)),
        footer=page.colophon(versions),
    )


def _overview(found: Characterization) -> page.Section:
    """Return what each test says, for all laws."""
    blocks: list[page.Block] = []
    names = {name: next(iter(results.values())).title for name, results in found.by_test.items()}
    for name in dict.fromkeys(name for result in found.all for name in result.failed):
        names.setdefault(name, name.capitalize())
    for law in found.all:
        if found.others:
            blocks.append(page.Subheading(text=law.title))
        rows = tuple(Row(cells=(title, law.told(name))) for name, title in names.items())
        blocks.append(Table(columns=(Column(head="test"), Column(head="result")), rows=rows))
    heading = "What the law does" if not found.others else "What the laws do"
    return page.Section(id="overview", nav="Overview", heading=heading, blocks=tuple(blocks))


def _laws(found: Characterization) -> page.Section:
    """Return formulas and parameters."""
    blocks: list[page.Block] = []
    for law in found.all:
        blocks.append(page.Subheading(text=law.title))
        blocks.append(page.Math(latex=law.law.formula))
        rows = tuple(
            Row(
                cells=(
                    f"{name.replace('_', ' ').capitalize()} ${quantity.symbol}$",
                    number(getattr(law.law, name), 6),
                    "none" if quantity.unit == "1" else quantity.unit,
                )
            )
            for name, quantity in fields_of(type(law.law)).items()
            if getattr(law.law, name) is not None
        )
        columns = (
            Column(head="parameter"),
            Column(head="value", numeric=True),
            Column(head="unit", phone="label", label="unit:"),
        )
        if rows:
            blocks.append(Table(columns=columns, rows=rows))
        if law.matched:
            blocks.append(page.Caption(text=law.matched))
    heading = "The law" if not found.others else "The laws"
    return page.Section(id="laws", nav=heading, heading=heading, blocks=tuple(blocks))


def _test(
    name: str, results: Mapping[str, Characteristic], found: Characterization
) -> page.Section:
    """Return the section of a test: what it says, its figure, its conditions."""
    first = next(iter(results.values()))
    blocks: list[page.Block] = []
    if len(found.all) == 1:
        blocks.append(page.Paragraph(text=first.sentence))
    else:
        rows = tuple(
            Row(cells=(Name(text=title), result.sentence)) for title, result in results.items()
        )
        blocks.append(Table(columns=(Column(head="law"), Column(head="result")), rows=rows))
    svg = inline_svg(
        draw_characteristic(results),
        alt=f"{first.title}: {', '.join(results)}",
        prefix=f"figure-{name}",
    )
    blocks.append(page.Figure(svg=svg, caption=f"**{first.title}.** {first.conditions}"))
    failed = [(law.title, law.failed[name]) for law in found.all if name in law.failed]
    blocks += [page.Note(title=f"{title}: no result.", text=why) for title, why in failed]
    return page.Section(id=name, nav=first.title, heading=first.title, blocks=tuple(blocks))


def _end(
    found: Characterization, commands: Sequence[str], versions: Mapping[str, str]
) -> page.Section:
    """Return sources, commands and versions."""
    blocks: list[page.Block] = []
    references = law_references([law.law for law in found.all], {})
    if references:
        blocks.append(page.References(items=references))
    if commands:
        blocks.append(page.Code(text="\n".join(f"$ {command}" for command in commands)))
    items = [page.KeyValue(key=name, value=version) for name, version in versions.items()]
    items.append(page.KeyValue(key="Runs", value="by `simulate` and `ensemble`, each certified"))
    blocks.append(page.KeyValues(items=tuple(items)))
    return page.Section(
        id="reproduce",
        nav="Sources",
        heading="Sources, and how to make this page again",
        blocks=tuple(blocks),
    )
