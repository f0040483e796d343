"""The tables of a plan: what stands in which row, for a terminal and a page alike.

Symbols stand between dollar signs, which pages typeset.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from stickslip.identify.kinds.travels.fit import unit_of
from stickslip.identify.kinds.travels.plan.sheet import Plan, Telling
from stickslip.quantities import parameters
from stickslip.show.formatting import count, fixed, joined, number, quantity, significant

BLOCK = 6
"""Settings in one table, so that it fits a terminal of 80 columns and a sheet of paper."""


@dataclass(frozen=True, kw_only=True)
class SheetRow:
    """A row of a table."""

    cells: tuple[str, ...]
    """One for each head."""
    aside: str = ""
    """What distinguishes the first cell, where there is room for it."""
    chosen: bool = False
    """Whether the sheet is written for this law."""
    muted: bool = False
    """Whether it is not told."""


@dataclass(frozen=True, kw_only=True)
class SheetTable:
    """A table, and what is said in a line each below it."""

    name: str
    """What it is about: ``"before"``, ``"settings"``, ``"apart"`` or ``"values"``."""
    title: str
    """Its heading."""
    heads: tuple[str, ...]
    """What the columns are, with their units; the first one names the rows."""
    rows: tuple[SheetRow, ...]
    """None where there is nothing of the kind."""
    caption: str = ""
    """How to read it, in full."""
    lines: Mapping[str, str] = field(default_factory=dict)
    """Sentences below it, by what they are of."""


def tables_of(plan: Plan) -> tuple[SheetTable, ...]:
    """Return the tables of a plan in the order in which they are read.

    Examples
    --------
    >>> from stickslip import SpringBlock, plan
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> tables = tables_of(plan(rig, ["coulomb", "viscous"], uncertainty=0.004))
    >>> [table.name for table in tables]
    ['before', 'settings', 'apart', 'values']
    >>> tables[1].heads
    ('law', '40', '60', '80', '100')
    """
    apart = (_apart(plan),) if plan.tellings else ()
    return (_before(plan), *_settings(plan), *apart, _values(plan))


def _titles(plan: Plan) -> dict[str, str]:
    return {name: law.title for name, law in plan.laws.items()}


def _before(plan: Plan) -> SheetTable:
    """Return what to measure before the runs, and below it how."""
    rows, how = [], {}
    for one in plan.preparations:
        unit = one.quantity.unit
        name = f"{one.name} ${one.quantity.symbol}$"
        rows.append(
            SheetRow(
                cells=(
                    name,
                    quantity(one.value, unit, 4, degrees=True),
                    quantity(one.needed, unit, 2, degrees=True),
                    one.verdict,
                )
            )
        )
        how[f"{one.name[:1].upper()}{one.name[1:]}"] = f"{one.how} {one.rough}".rstrip()
    caption = (
        "Uncertainties are standard uncertainties. A parameter with the needed uncertainty"
        f" contributes half as much as the {len(plan.runs())} readings to the uncertainty of the"
        f" level of {_titles(plan)[plan.reference]} friction; three such parameters widen its"
        " interval by a third. An error common to all runs does not average out; the error of a"
        " setting that is adjusted anew for each run does."
    )
    return SheetTable(
        name="before",
        title="Measure before the runs",
        heads=("parameter", "value", "needed uncertainty", "stated uncertainty"),
        rows=tuple(rows),
        caption=caption,
        lines={**how, **plan.rest},
    )


def _settings(plan: Plan) -> tuple[SheetTable, ...]:
    """Return the travels that each law predicts, of up to six settings at a time."""
    titles = _titles(plan)
    unit, factor = unit_of(plan.settings[0].unit)
    # a digit beyond that of the uncertainty
    decimals = min(max(0, 1 - math.floor(math.log10(1e3 * plan.uncertainty))), 4)
    level = (
        "Each law is fitted to the trials."
        if plan.from_trials
        else "Each law gives the same travel with the rig as described."
    )
    band = (
        "The last rows are half the width of the 95 % band of the travel over all laws: now,"
        " and as these runs will leave it in the worst case."
    )
    known = quantity(plan.uncertainty, "m", 2)
    doubt = (
        f"The uncertainty of a travel is assumed to be {known}, 2 % of the longest travel, until"
        " repeats at one setting show the scatter."
        if plan.assumed
        else f"The uncertainty of a travel is {known}, {known_by(plan)}."
    )
    size = math.ceil(len(plan.settings) / math.ceil(len(plan.settings) / BLOCK))
    blocks = [plan.settings[i : i + size] for i in range(0, len(plan.settings), size)]
    title = f"Predicted travel [mm] at each {plan.knob} [{unit}], {plan.repeats} runs each"
    found = []
    for block in blocks:
        rows = [
            SheetRow(
                cells=(
                    titles[name],
                    *(fixed(1e3 * row.predicted[name], decimals) for row in block),
                ),
                aside=_values_of(plan, name),
                chosen=name == plan.reference,
            )
            for name in plan.laws
        ]
        for head, half in (
            ("± now", [row.half for row in block]),
            ("± expected", [row.expected for row in block]),
        ):
            rows.append(SheetRow(cells=(head, *(fixed(1e3 * one, decimals) for one in half))))
        last = block is blocks[-1]
        found.append(
            SheetTable(
                name="settings",
                title=title,
                heads=("law", *(number(factor * row.value) for row in block)),
                rows=tuple(rows),
                caption=f"{level} {band} {doubt} {plan.range_source}".rstrip() if last else "",
            )
        )
    return tuple(found)


def known_by(plan: Plan) -> str:
    """Return what the uncertainty of a travel is that was not assumed, in words.

    Examples
    --------
    >>> from stickslip import SpringBlock, plan
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> known_by(plan(rig, "coulomb", uncertainty=0.004))
    'scatter and measurement uncertainty combined'
    """
    if not plan.repeated:
        return "scatter and measurement uncertainty combined"
    return (
        "the scatter of the repeats measured so far"
        f" ({count(plan.repeated, 'degree of freedom', 'degrees of freedom')})"
    )


def _values_of(plan: Plan, name: str) -> str:
    """Return the values of a law that were counted on."""
    return ", ".join(
        f"${asked.symbol}$ = {quantity(value, asked.unit)}"
        for _, asked, value in parameters(plan.laws[name], "friction")
        if value
    )


def _apart(plan: Plan) -> SheetTable:
    """Return which laws the runs tell apart, and below it which they do not, and why."""
    titles = _titles(plan)
    unit, factor = unit_of(plan.settings[0].unit)
    told = [one for one in plan.tellings if one.repeats is not None]
    rows = [
        SheetRow(
            cells=(
                titles[one.holds],
                titles[one.rival],
                number(1e3 * one.gap, 2),
                number(factor * one.setting.value),
                f"{one.repeats}",
            )
        )
        for one in told
    ]
    open_: dict[str, list[Telling]] = {}
    for one in plan.tellings:
        if one.repeats is None:
            open_.setdefault(one.obstacle, []).append(one)
    return SheetTable(
        name="apart",
        title=f"The runs distinguish {len(told)} of {count(len(plan.tellings), 'pair')} of laws",
        heads=(
            "if this law is true",
            "this law is ruled out",
            "gap [mm]",
            f"at [{unit}]",
            "runs each",
        ),
        rows=tuple(rows),
        caption=(
            "Gap: the largest difference that remains when the law to be ruled out is fitted to"
            " the travels of the other law, and the setting at which it occurs. Runs each: the"
            " runs per setting with which `stickslip select` rules that law out in nine of ten"
            " experiments."
        ),
        lines={said: _pairs(pairs, titles) for said, pairs in open_.items()},
    )


def _pairs(pairs: Sequence[Telling], titles: Mapping[str, str]) -> str:
    """Return pairs of laws in words, each law once."""
    by_law: dict[str, list[str]] = {}
    for one in pairs:
        by_law.setdefault(titles[one.holds], []).append(titles[one.rival])
    return f"{'; '.join(f'{law} from {joined(rivals)}' for law, rivals in by_law.items())}."


def _values(plan: Plan) -> SheetTable:
    """Return what the runs will tell of each parameter, and below it what tells the others."""
    titles = _titles(plan)
    rows = []
    for one in plan.expectations:
        estimate, asked = one.estimate, one.estimate.quantity
        unit = "" if asked.unit == "1" else f" [{asked.unit}]"
        rows.append(
            SheetRow(
                cells=(
                    titles[one.law],
                    f"${asked.symbol}${unit}",
                    significant(estimate.value, 3),
                    estimate.range if one.identified else "not identified",
                ),
                muted=not one.identified,
            )
        )
    advice: dict[str, str] = {}
    for one in plan.expectations:
        if one.advice:
            advice.setdefault(one.estimate.quantity.symbol, one.advice)
    return SheetTable(
        name="values",
        title="Expected intervals of each law",
        heads=("law", "parameter", "true value", "expected 95 % interval"),
        rows=tuple(rows),
        caption=(
            "The interval that `stickslip select` will state if the law is true with this value"
            " and the rig has the stated (otherwise the needed) uncertainties. Not identified: the"
            " travels hardly depend on it, or the interval reaches the lowest value that the law"
            " allows."
        ),
        lines={f"To identify ${symbol}$": text for symbol, text in advice.items()},
    )
