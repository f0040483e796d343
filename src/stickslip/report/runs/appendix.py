"""The end of the report of a run: the law and its doubt, certificate, how to reproduce it."""

import math

import numpy as np

from stickslip.errors import InputError
from stickslip.experiments import HARD, LawEstimates, equated, unit_on
from stickslip.formatting import interval, number
from stickslip.quantities import parameters
from stickslip.report.core.blocks import Block, Caption, KeyValues, Math, Note
from stickslip.report.core.documents import Origin, Section
from stickslip.report.core.shared_sections import evidence, reproduce
from stickslip.report.core.tables import Column, Row, Table
from stickslip.report.runs.subject import RunReport
from stickslip.sweep import Band
from stickslip.trajectory import Trajectory


def law_section(about: RunReport) -> Section:
    """Return the law with its parameters, their intervals, and what does not carry over."""
    law = about.law
    rows = []
    for path, one, value in parameters(law, "friction"):
        name = path.removeprefix("friction.")
        span, how = how_known(about.estimates, name)
        label = f"{name.replace('_', ' ').capitalize()} ${one.symbol}$"
        unit = unit_on(about.rig.mechanism, one)
        unit = "none" if unit == "1" else unit
        rows.append(Row(cells=(label, number(value, 4), unit, span, how)))
    for name, (own, other) in equated(law).items():
        label = f"{name.replace('_', ' ').capitalize()} ${own}$"
        rows.append(Row(cells=(label, f"${other}$", "none", "—", "assumed, not measured")))
    kind = "95 %" if about.estimates is None else about.estimates.interval
    columns = (
        Column(head="parameter"),
        Column(head="value", numeric=True),
        Column(head="unit", phone="label", label="unit:"),
        Column(head=kind, numeric=True, phone="label", label=f"{kind}:"),
        Column(head="how it is known"),
    )
    blocks: list[Block] = [Math(latex=law.formula), Table(columns=columns, rows=tuple(rows))]
    if about.remarks:
        title = "Validity of the law."
        blocks.append(Note(kind="info", title=title, text=" ".join(about.remarks)))
    blocks += drawn(about.band, about.estimates)
    from_file = f", from `{about.law_file}`" if about.law_file else ""
    heading = f"{law.title} friction{from_file}"
    return Section(id="law", nav="The law", heading=heading, blocks=tuple(blocks))


def how_known(known: LawEstimates | None, name: str) -> tuple[str, str]:
    """Return the interval of a parameter, and how it is known."""
    if known is None or name not in (*known.intervals, *known.not_identified, *known.not_fitted):
        return "—", "as given"
    if name in known.not_fitted:
        return "—", "overridden" if name in known.overridden else "given or assumed"
    if name in known.not_identified:
        return "—", f"not identified: {known.not_identified[name]}"
    return interval(*known.intervals[name]), "stated" if name in known.stated else "fitted"


def drawn(band: Band | None, known: LawEstimates | None) -> list[Block]:
    """Return how the runs of a band were drawn, in words; nothing where there is no band."""
    if band is None:
        return []
    of_law = [path for path in band.draws if path.startswith("friction.")]
    of_rig = ", ".join(_in_words(path) for path in band.draws if path not in of_law)
    begin = f"The band: {band.count} draws (seed {band.seed}) of"
    rig = f"{of_rig}, normal with their standard uncertainties and independent"
    if known is None or not of_law:
        return [Caption(text=f"{begin} {rig}. It has no measurement noise."), *explained(band)]
    names = ", ".join(_in_words(path.removeprefix("friction.")) for path in of_law)
    how = (
        "with their covariance"
        if len(known.covariance_of) > 1
        else f"uniform within the {known.interval}"
        if known.interval in HARD
        else "normal with the 95 % interval"
    )
    text = (
        f"{begin} {names}, {how}, in the valid ranges of"
        f" {'the law' if isinstance(known.law, str) else 'the laws'}"
        f"{f'; and of {rig}' if of_rig else ''}. It has no measurement noise."
    )
    if known.kept:
        words = ", ".join(map(_in_words, known.kept))
        text += f" Fixed: {words}."
    return [Caption(text=text), *explained(band)]


def explained(band: Band) -> list[Block]:
    """Return which uncertain parameter spreads each travel, or why that is not said."""
    if len(band.draws) < 2:
        return []
    try:
        shares = {name: band.shares(name) for name in band.travels}
    except InputError as error:
        return [Caption(text=f"Which parameter the spread comes from is not said: {error}")]
    rows = tuple(
        Row(
            cells=(
                _in_words(path.removeprefix("friction.").removeprefix("mechanism.")),
                *(one.text_of("first", place) for one in shares.values()),
            )
        )
        for place, path in enumerate(band.draws)
    )
    heads = (
        Column(head=f"share of the variance\nof the travel of {name}", numeric=True)
        for name in shares
    )
    table = Table(columns=(Column(head="uncertain parameter"), *heads), rows=rows)
    text = (
        "Sobol indices of first order with 95 % intervals, from the draws of the band: what each"
        " parameter explains alone."
    )
    for name, one in shares.items():
        share, half = one.indices["first"], one.half_widths["first"]
        *_, second, first = np.argsort(share).tolist()
        if share[first] - share[second] > math.hypot(half[first], half[second]):
            text += (
                f" To know the travel of {name} better, measure the {rows[first].cells[0]} first."
            )
        elif share[first] <= half[first]:
            text += f" No parameter alone is shown to spread the travel of {name}."
        else:
            both = f"{rows[first].cells[0]} and {rows[second].cells[0]}"
            text += (
                f" {one.used} runs do not settle which of {both} spreads the travel of {name} more."
            )
    return [table, Caption(text=text)]


def _in_words(name: str) -> str:
    """Return a parameter in words, after its contact if it has one."""
    contact, _, own = name.rpartition(".")
    return f"{contact} {own.replace('_', ' ')}".strip()


def certificate_section(about: RunReport) -> Section:
    """Return how far to trust the computation, in words."""
    return certificate_of(about.run, exact=about.fixed_step is None)


def certificate_of(run: Trajectory, *, exact: bool = True) -> Section:
    """Return how far to trust a computation, in words."""
    if not exact:
        heading = "Fixed steps have no certificate"
    elif run.certificate.certified:
        heading = "The run is certified"
    else:
        heading = "The run is not certified"
    text = (
        "The certificate shows that the equations were solved correctly: energies are integrated"
        " independently of the motion. It does not show that the law describes the contact."
    )
    items = evidence(run, located=exact)
    blocks = (KeyValues(items=items), Caption(text=text))
    return Section(id="certificate", nav="Certificate", heading=heading, blocks=blocks)


def reproduce_section(about: RunReport) -> Section:
    """Return commands, versions, hashes and the sources of the law."""
    origin = Origin(
        title=about.rig.heading,
        data="",
        files=about.digests,
        commands=about.commands,
        versions=about.versions,
    )
    return reproduce(origin, laws=[about.law], cited={"paper": ["criteria"]})
