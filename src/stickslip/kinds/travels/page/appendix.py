"""The end of the report: what to measure next, parameters, certificate, and how to reproduce it."""

from collections.abc import Mapping

from stickslip import formatting
from stickslip.formatting import fixed, joined, scale_of, within
from stickslip.kinds.travels.figures import SEPARATION_SIZES
from stickslip.kinds.travels.separations import Proposal
from stickslip.kinds.travels.verdict import (
    TravelVerdict,
    draw_proposal,
    estimate_range,
    estimate_text,
)
from stickslip.plots import inline_svg
from stickslip.quantities import fields_of
from stickslip.report import (
    Block,
    Code,
    Column,
    Figure,
    KeyValue,
    Math,
    Origin,
    Row,
    Section,
    Table,
    certificate,
    evidence,
    reproduce,
)


def next_section(verdict: TravelVerdict) -> Section | None:
    """Return the section on further measurements, None if none would tell more.

    Heading, table and figure show the proposal of the verdict, and no other.
    """
    best, proposal = verdict.best, verdict.proposal
    if best is None or proposal is None or not proposal.tried:
        return None
    names = (best.name, *proposal.rivals)
    rows = verdict.separations
    titles = {c.name: c.title for c in verdict.candidates}
    if proposal.settings:
        count = "One more setting" if len(proposal.settings) == 1 else "Two more settings"
        apart = joined([titles[name] for name in proposal.apart])
        heading = f"{count} of the {proposal.what} would distinguish {apart} friction"
    else:
        apart = joined([titles[name] for name in proposal.rivals])
        heading = (
            f"No setting of the {proposal.what} distinguishes {best.title} from {apart} friction"
        )
    scale = scale_of([row.value for row in rows], rows[0].unit)
    settings, unit = [scale.number(row.value, 6) for row in rows], scale.unit
    columns = [Column(head=f"travel predicted, m\n{proposal.what}, {unit}")]
    columns += [Column(head=s, numeric=True, phone="label", label=f"{s} {unit}") for s in settings]
    table = Table(
        columns=tuple(columns),
        rows=tuple(
            Row(
                cells=(titles[n], *(fixed(row.predicted[n], 3) for row in rows)),
                chosen=n == best.name,
            )
            for n in names
        ),
    )
    figure = _separation_figure(verdict, proposal, unit, titles)
    return Section(id="next", nav="Measure next", heading=heading, blocks=(figure, table))


def _separation_figure(
    verdict: TravelVerdict, proposal: Proposal, unit: str, titles: Mapping[str, str]
) -> Figure:
    still = [titles[name] for name in proposal.rivals if name not in proposal.apart]
    caption = f"**Predicted travel** of each law as fitted, against the {proposal.what}."
    if still and proposal.settings:
        caption += f" The proposed settings do not distinguish {joined(still)} from"
        caption += f" {titles[proposal.best]}."
    elif still:
        apart = formatting.quantity(proposal.widest, "m", 2)
        caption += f" They differ by at most {apart} at new settings."
    svg = inline_svg(
        draw_proposal(verdict),
        alt=f"Travel predicted by each law against the {proposal.what} in {unit}",
        prefix="separation",
        **SEPARATION_SIZES,
    )
    return Figure(svg=svg, caption=caption)


def parameters_section(verdict: TravelVerdict) -> Section | None:
    """Return the section on the parameters of the chosen law."""
    best = verdict.best
    if best is None or best.fit is None:
        return None
    law = best.fit.law
    estimates = {e.path.rpartition(".")[2]: e for e in best.fit.estimates}
    rows = []
    for name, quantity in fields_of(type(law)).items():
        value = getattr(law, name)
        label = f"{name.replace('_', ' ').capitalize()} ${quantity.symbol}$"
        unit = "none" if quantity.unit == "1" else quantity.unit
        if name in estimates:
            estimate = estimates[name]
            cells = (
                label,
                within(estimate.value, estimate.low, estimate.high),
                unit,
                estimate_range(estimate),
                "fitted",
            )
        elif value is None:
            cells = (label, "not given", unit, "—", "set equal to the kinetic level")
        else:
            how = "fixed form" if quantity.structural else "fixed as given"
            how = "assumed, not measured" if name in best.invented else how
            cells = (label, formatting.quantity(value, "1"), unit, "—", how)
        rows.append(Row(cells=cells, chosen=name in estimates))
    kinds = joined(sorted({e.interval for e in estimates.values()}))
    table = Table(
        columns=(
            Column(head="parameter"),
            Column(head="value", numeric=True),
            Column(head="unit", phone="label", label="unit:"),
            Column(head=kinds or "interval", numeric=True, phone="label", label="interval"),
            Column(head="how it is known"),
        ),
        rows=tuple(rows),
    )
    fitted = joined(list(map(estimate_text, best.fit.estimates)))
    blocks: tuple[Block, ...] = (Math(latex=law.formula), table, Code(text=_as_code(verdict)))
    heading = f"Fitted: {fitted}" if fitted else f"The parameters of {best.title} friction"
    return Section(id="parameters", nav="Parameters", heading=heading, blocks=blocks)


def _as_code(verdict: TravelVerdict) -> str:
    """Return the chosen law as one would write it."""
    if verdict.best is None or verdict.best.fit is None:
        return ""
    law = verdict.best.fit.law
    values = ", ".join(
        f"{name}={getattr(law, name):.6g}"
        for name in fields_of(type(law))
        if getattr(law, name) is not None
    )
    return f"{type(law).__name__}({values})"


def certificate_section(verdict: TravelVerdict) -> Section:
    """Return the section that says how far to trust the computation."""
    best = verdict.best
    items = [] if best is None or best.run is None else list(evidence(best.run))
    runs = [c.run for c in verdict.candidates if c.run is not None]
    passed = sum(run.certificate.certified for run in runs)
    if runs:
        items.append(
            KeyValue(
                key="All fitted runs",
                value=f"{passed} of {len(runs)} certified",
                mark="ok" if passed == len(runs) else "warn",
            )
        )
    items.append(_data(verdict))
    return certificate(items)


def _data(verdict: TravelVerdict) -> KeyValue:
    records = verdict.measurement.records()
    band = verdict.measured_band
    half = 0.5 * (band[1] - band[0]) if band else 0.0
    doubt = f"± {formatting.quantity(half, 'm', 1)}" if half else "no uncertainty stated"
    if len(records) == 1:
        kind = {"rounding": "its rounding", "standard": "standard error", "interval": "interval"}
        text = f"one travel, {doubt}"
        text += f" ({kind[records[0].uncertainty_kind]})" if half else ""
        return KeyValue(
            key="Data", value=(f"{text}, not repeated: the scatter is unknown"), mark="warn"
        )
    distinct = len({tuple(sorted(record.overrides.items())) for record in records})
    text = f"{len(records)} travels at {distinct} settings, {doubt} each"
    return KeyValue(key="Data", value=text, mark="ok" if distinct > 1 else "warn")


def reproduce_section(verdict: TravelVerdict, origin: Origin) -> Section:
    """Return the section with commands, versions, hash and references."""
    laws = [candidate.law for candidate in verdict.candidates]
    return reproduce(origin, laws=laws, cited={"paper": ["criteria"]})
