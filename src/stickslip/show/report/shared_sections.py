"""Sections that several kinds of pages share, with their headings: from the verdict to sources."""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any, Final, Literal

from stickslip.data import Checks, grouped
from stickslip.engine.trajectory import Trajectory
from stickslip.friction import CITATIONS, FrictionLaw, RateState
from stickslip.identify import Wording
from stickslip.show.formatting import (
    fixed,
    in_words,
    joined,
    quantity,
    residue,
    scale_of,
    significant,
    with_unit,
)
from stickslip.show.plots import inline_svg
from stickslip.show.report import blocks as page

CERTIFICATE: Final = "Certificate of the computation"


def checks_heading(warned: int) -> str:
    """Return the heading of the section on a record and its checks.

    Examples
    --------
    >>> checks_heading(0), checks_heading(2)
    ('The record: no warnings from its checks', 'The record: two warnings from its checks')
    """
    if not warned:
        return "The record: no warnings from its checks"
    noun = "warning" if warned == 1 else "warnings"
    return f"The record: {in_words(warned)} {noun} from its checks"


def ended_early(t: float) -> str:
    """Return what is said first of a run that ended before its end time.

    Examples
    --------
    >>> ended_early(0.25)
    'The run ends early, at 0.25 s'
    """
    return f"The run ends early, at {quantity(t, 's')}"


MARKS: Final[Mapping[str, Literal["none", "warn", "bad"]]] = {"warning": "warn", "error": "bad"}


def check_items(checks: Checks) -> tuple[page.KeyValue, ...]:
    """Return a line for each finding of the checks, warnings and errors marked; each kind once.

    Examples
    --------
    >>> from stickslip import Measurement, check
    >>> [one.mark for one in check_items(check(Measurement(travel=0.2, uncertainty=0.005)))]
    ['warn']
    """
    result, last, kinds = [], "", [finding.kind for finding in checks.findings]
    for finding in sorted(grouped(checks.findings), key=lambda item: kinds.index(item.kind)):
        kind = finding.kind.replace("-", " ").replace("_", " ").capitalize()
        mark = MARKS.get(finding.severity, "none")
        result.append(page.KeyValue(key=kind * (kind != last), value=str(finding), mark=mark))
        last = kind
    return tuple(result)


def opening(
    words: Wording,
    kicker: str,
    remark: str = "",
    *,
    facts: Sequence[page.Fact] = (),
    settles: Sequence[str] | None = None,
    record: str = "record",
) -> page.Section:
    """Return the section that a reader may stop after; it may settle less than the wording says."""
    block = page.Opening(
        kicker=kicker,
        verdict=words.verdict,
        lede=" ".join(part for part in (words.lede, remark) if part),
        facts=tuple(facts[: page.MOST]),
        settles=tuple((words.settles if settles is None else settles)[: page.MOST]),
        cannot_tell=tuple(words.cannot_tell[: page.MOST]),
        measure_next=tuple(words.measure_next[: page.MOST]),
        record=record,
    )
    return page.Section(id="verdict", nav="Verdict", heading="", blocks=(block,))


def figure(
    draw: Any, alt: str, prefix: str, caption: str, sizes: Mapping[str, Any] = MappingProxyType({})
) -> page.Figure:
    """Return a figure that is drawn where it is shown: by `inline_svg`, with these arguments."""
    return page.Figure(
        svg=partial(inline_svg, draw, alt=alt, prefix=prefix, **sizes), caption=caption
    )


def record_and_checks(checks: Checks) -> page.Section | None:
    """Return the section on what was checked of the record."""
    result = check_items(checks)
    if not result:
        return None
    heading = checks_heading(sum(item.mark != "none" for item in result))
    blocks = (page.KeyValues(items=result),)
    return page.Section(id="record", nav="Record and checks", heading=heading, blocks=blocks)


def certificate(items: Sequence[page.KeyValue]) -> page.Section:
    """Return the section that says how far to trust the computation behind a verdict."""
    blocks = (page.KeyValues(items=tuple(items)),)
    return page.Section(id="certificate", nav="Certificate", heading=CERTIFICATE, blocks=blocks)


def evidence(run: Trajectory, *, located: bool = True) -> tuple[page.KeyValue, ...]:
    """Return the certificate of a run, check by check.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> [item.key for item in evidence(run)]
    ['Energy', 'Events', 'Sticking and slipping', 'Drift at rest', 'Steps']
    """
    book = run.certificate
    parts = book.work_friction, book.work_stops, book.energy_end
    given, friction, at_stops, left = _balance(book.energy_start + book.work_supplied, *parts)
    stops = f", {at_stops} by the stops" if book.work_stops else ""
    energy = (
        f"{given} initially and from the drives; {friction} dissipated by friction{stops};"
        f" {left} remaining. Mismatch {residue(book.energy_error)}"
    )
    items = [page.KeyValue(key="Energy", value=energy, mark="ok" if book.certified else "warn")]
    if located:
        events = "event" if len(run.events) == 1 else "events"
        still = book.stick_drift == 0.0
        items += [
            page.KeyValue(
                key="Events",
                value=f"{len(run.events):,} {events} located; largest relative residual of an"
                f" event condition {residue(book.event_residual)}",
            ),
            page.KeyValue(
                key="Sticking and slipping",
                value=f"largest violation of a condition: {residue(book.guard_violation)}",
            ),
            page.KeyValue(
                key="Drift at rest",
                value="exactly 0" if still else quantity(book.stick_drift, "m", 1),
                mark="ok" if still else "warn",
            ),
        ]
    steps = f"{book.steps:,} accepted, {book.rejected:,} rejected"
    items.append(page.KeyValue(key="Steps", value=steps))
    items += [page.KeyValue(key="Warning", value=text, mark="warn") for text in book.warnings]
    items += [page.KeyValue(key="Problem", value=text, mark="bad") for text in book.problems]
    return tuple(items)


def _balance(*energies: float) -> list[str]:
    """Return energies in one unit and with the decimals of the largest, which has four digits."""
    scale = scale_of(energies, "J")
    largest = scale.factor * max((abs(x) for x in energies if math.isfinite(x)), default=0.0)
    if not largest >= 1e-3:
        return [with_unit(significant(scale.factor * energy, 4), scale.unit) for energy in energies]
    decimals = max(3 - math.floor(math.log10(largest)), 0)
    return [
        with_unit(fixed(scale.factor * energy, decimals) if energy else "0", scale.unit)
        for energy in energies
    ]


REPRODUCE: Final = "Reproduce and cite"


def reproduce(
    origin: page.Origin,
    *,
    code: Sequence[tuple[str, str]] = (),
    items: Sequence[page.KeyValue] = (),
    data: str = "",
    laws: Iterable[FrictionLaw | RateState] = (),
    cited: Mapping[str, Sequence[str]] = MappingProxyType({}),
) -> page.Section:
    """Return the section with commands, code, data, versions, hashes and the sources of laws.

    `cited` has by key what else is cited, and for what.

    Examples
    --------
    >>> section = reproduce(
    ...     page.Origin(title="Block", data="one travel", commands=("stickslip select",))
    ... )
    >>> section.blocks[0].text
    '$ stickslip select'
    """
    blocks: list[page.Block] = []
    if origin.commands:
        blocks.append(page.Code(text="\n".join(f"$ {command}" for command in origin.commands)))
    for text, caption in code:
        blocks.append(page.Code(text=text))
        if caption:
            blocks.append(page.Caption(text=caption))
    known = [*items, *([page.KeyValue(key="Data", value=data)] if data else [])]
    known += (page.KeyValue(key=name, value=version) for name, version in origin.versions.items())
    known += [
        page.KeyValue(key=f"SHA-256 of {name}", value=f"`{x}`") for name, x in origin.files.items()
    ]
    if origin.digest:
        known.append(page.KeyValue(key="Hash of the inputs", value=f"`{origin.digest}`"))
    if known:
        blocks.append(page.KeyValues(items=tuple(known)))
    references = law_references(laws, cited)
    if references:
        text = "Sources of the laws and criteria on this page."
        blocks += [page.References(items=references), page.Caption(text=text)]
    return page.Section(id="reproduce", nav=REPRODUCE, heading=REPRODUCE, blocks=tuple(blocks))


def law_references(
    laws: Iterable[FrictionLaw | RateState], first: Mapping[str, Sequence[str]]
) -> tuple[page.Reference, ...]:
    """Return the sources of laws with the laws they are for, after those given by key."""
    used = {key: list(who) for key, who in first.items()}
    for law in laws:
        for key in law.sources:
            who = used.setdefault(key, [])
            if law.title not in who:
                who.append(law.title)
    return tuple(
        page.Reference(**CITATIONS[key]._asdict(), note=joined(who))
        for key, who in used.items()
        if key in CITATIONS
    )
