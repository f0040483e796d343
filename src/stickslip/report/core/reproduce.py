"""How to make a page again, and what to cite: the end of every page."""

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from stickslip.formatting import joined
from stickslip.friction import CITATIONS, FrictionLaw, RateState
from stickslip.report.core.blocks import (
    Block,
    Caption,
    Code,
    KeyValue,
    KeyValues,
    Reference,
    References,
)
from stickslip.report.core.documents import Origin, Section

HEADING: Final = "Reproduce and cite"


def reproduce(
    origin: Origin,
    *,
    code: Sequence[tuple[str, str]] = (),
    items: Sequence[KeyValue] = (),
    data: str = "",
    laws: Iterable[FrictionLaw | RateState] = (),
    cited: Mapping[str, Sequence[str]] = MappingProxyType({}),
) -> Section:
    """Return the section with commands, code, data, versions, hashes and the sources of laws.

    `cited` has by key what else is cited, and for what.

    Examples
    --------
    >>> section = reproduce(
    ...     Origin(title="Block", data="one travel", commands=("stickslip select",))
    ... )
    >>> section.blocks[0].text
    '$ stickslip select'
    """
    blocks: list[Block] = []
    if origin.commands:
        blocks.append(Code(text="\n".join(f"$ {command}" for command in origin.commands)))
    for text, caption in code:
        blocks.append(Code(text=text))
        if caption:
            blocks.append(Caption(text=caption))
    known = [*items, *([KeyValue(key="Data", value=data)] if data else [])]
    known += (KeyValue(key=name, value=one) for name, one in origin.versions.items())
    known += [
        KeyValue(key=f"SHA-256 of {name}", value=f"`{x}`") for name, x in origin.files.items()
    ]
    if origin.digest:
        known.append(KeyValue(key="Hash of the inputs", value=f"`{origin.digest}`"))
    if known:
        blocks.append(KeyValues(items=tuple(known)))
    references = law_references(laws, cited)
    if references:
        text = "Sources of the laws and criteria on this page."
        blocks += [References(items=references), Caption(text=text)]
    return Section(id="reproduce", nav=HEADING, heading=HEADING, blocks=tuple(blocks))


def law_references(
    laws: Iterable[FrictionLaw | RateState], first: Mapping[str, Sequence[str]]
) -> tuple[Reference, ...]:
    """Return the sources of laws with the laws they are for, after those given by key."""
    used = {key: list(who) for key, who in first.items()}
    for law in laws:
        for key in law.sources:
            who = used.setdefault(key, [])
            if law.title not in who:
                who.append(law.title)
    return tuple(
        Reference(**CITATIONS[key]._asdict(), note=joined(who))
        for key, who in used.items()
        if key in CITATIONS
    )
