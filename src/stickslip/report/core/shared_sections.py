"""Sections that the pages of several kinds of measurement share."""

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Final, Literal

from stickslip.experiments import Checks
from stickslip.formatting import in_words
from stickslip.identification import Estimate
from stickslip.report.core.blocks import Block, Fact, KeyValue, KeyValues, Math, Subheading
from stickslip.report.core.documents import LawLine, Opening, Section
from stickslip.report.core.headings import CERTIFICATE, checks_heading
from stickslip.report.core.markup import label_of, typeset
from stickslip.report.core.tables import Column, Name, Number, Row, Table
from stickslip.selection import Wording

MARKS: Final[Mapping[str, Literal["none", "warn", "bad"]]] = {"warning": "warn", "error": "bad"}


def check_items(checks: Checks) -> tuple[KeyValue, ...]:
    """Return a line for each finding of the checks of a record, warnings and errors marked.

    Examples
    --------
    >>> from stickslip import Measurement, check
    >>> [one.mark for one in check_items(check(Measurement(travel=0.2, uncertainty=0.005)))]
    ['warn']
    """
    return tuple(
        KeyValue(
            key=finding.kind.replace("-", " ").replace("_", " ").capitalize(),
            value=str(finding),
            mark=MARKS.get(finding.severity, "none"),
        )
        for finding in checks.findings
    )


MOST = 3
"""Items of a list of the opening at most."""


def opening(
    words: Wording,
    kicker: str,
    remark: str = "",
    *,
    symbols: Collection[str] = (),
    law: Sequence[LawLine] = (),
    facts: Sequence[Fact] = (),
    settles: Sequence[str] | None = None,
    no_score: str = "",
    record: str = "record",
) -> Section:
    """Return the section that a reader may stop after: the verdict and what one would quote.

    Symbols in the sentences are typeset; `settles` stands for what the wording says is settled.
    """

    def typeset_all(lines: Sequence[str]) -> tuple[str, ...]:
        return tuple(typeset(line, symbols) for line in lines[:MOST])

    block = Opening(
        kicker=kicker,
        verdict=typeset(words.verdict, symbols),
        lede=typeset(" ".join(part for part in (words.lede, no_score, remark) if part), symbols),
        law=tuple(law),
        facts=tuple(facts[:MOST]),
        settles=tuple(settles[:MOST]) if settles is not None else typeset_all(words.settles),
        cannot_tell=typeset_all(words.cannot_tell),
        measure_next=typeset_all(words.measure_next),
        record=record,
    )
    return Section(id="verdict", nav="Verdict", heading="", blocks=(block,))


def candidates_heading(count: int, judged_on: str) -> str:
    """Return the heading of the section that compares all laws.

    Examples
    --------
    >>> candidates_heading(1, "held-out blocks"), candidates_heading(3, "held-out blocks")
    ('One candidate, scored on held-out blocks', 'Three candidates, scored on held-out blocks')
    """
    noun = "candidate" if count == 1 else "candidates"
    return f"{in_words(count).capitalize()} {noun}, scored on {judged_on}"


def parameters(
    formula: str,
    estimates: Sequence[Estimate],
    last: tuple[str, Callable[[Estimate, str], str]],
    *,
    heading: str,
    caption: str,
    more: Sequence[Block] = (),
    remarks: tuple[str, Sequence[str]],
    label: Callable[[Estimate], str] = label_of,
) -> Section:
    """Return the section on the parameters of a law: its formula, their table, and remarks.

    `last` has the title of the last column, and what it says of an estimate with its unit.
    """
    (head, said), (title, lines) = last, remarks

    def row(one: Estimate) -> Row:
        value, doubt = one.parts
        unit = "" if one.quantity.unit == "1" else one.quantity.unit
        shown = Number(value=value, doubt=doubt, unit=unit) if one.bounded else one.plus_minus
        name = Name(text=label(one), aside="" if one.bounded else one.reason)
        return Row(cells=(name, shown, said(one, unit)))

    columns = (
        Column(head="parameter"),
        Column(head="estimate, 95 % interval", numeric=True),
        Column(head=head, numeric=True, phone="label"),
    )
    table = Table(columns=columns, rows=tuple(map(row, estimates)), caption=caption)
    blocks: list[Block] = [Math(latex=formula), table, *more]
    if lines:
        items = tuple(KeyValue(key="Note", value=line) for line in lines)
        blocks += [Subheading(text=title), KeyValues(items=items)]
    return Section(id="parameters", nav="Parameters", heading=heading, blocks=tuple(blocks))


def record_and_checks(
    checks: Checks,
    *,
    blocks: Sequence[Block] = (),
    items: Sequence[KeyValue] = (),
    source: str = "its checks",
) -> Section | None:
    """Return the section on the record: what is said of it, and what was checked of it."""
    found = (*items, *check_items(checks))
    shown = (*blocks, *([KeyValues(items=found)] if found else []))
    if not shown:
        return None
    heading = checks_heading(sum(item.mark != "none" for item in found), source)
    return Section(id="record", nav="Record and checks", heading=heading, blocks=shown)


def certificate(items: Sequence[KeyValue]) -> Section:
    """Return the section that says how far to trust the computation behind a verdict."""
    blocks = (KeyValues(items=tuple(items)),)
    return Section(id="certificate", nav="Certificate", heading=CERTIFICATE, blocks=blocks)
