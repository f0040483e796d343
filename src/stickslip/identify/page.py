"""The page of a verdict: law, band and figure on the first screen; then what they rest on."""

from functools import partial

from stickslip.identify.candidates import Verdict
from stickslip.identify.figures import BandDrawing, draw_band, draw_run
from stickslip.identify.fits import Estimate
from stickslip.identify.judgement import RIVAL
from stickslip.identify.ladder import ladder_rows
from stickslip.identify.verdict import BandVerdict, importance
from stickslip.show.formatting import (
    interval,
    number,
    percent,
    with_unit,
    within,
)
from stickslip.show.plots import MAP_SIZES, inline_svg
from stickslip.show.report import (
    MOST,
    Column,
    Fact,
    Figure,
    KeyValue,
    KeyValues,
    Name,
    Number,
    Origin,
    Row,
    Section,
    SectionMaker,
    Table,
    opening,
    record_and_checks,
    reproduce,
)


def verdict_sections(verdict: BandVerdict, origin: Origin, remark: str) -> tuple[SectionMaker, ...]:
    """Return what makes the sections of the page of a verdict with a band."""
    run = partial(run_section, verdict)
    middle = run, partial(figure_section, verdict), partial(laws_section, verdict)
    return sections_of(verdict, origin, remark, *middle)


def sections_of(
    verdict: Verdict, origin: Origin, remark: str, *middle: SectionMaker
) -> tuple[SectionMaker, ...]:
    """Return what makes the sections of the page of any verdict, with its figures and laws."""
    return (
        partial(opening_section, verdict, origin, remark),
        *middle,
        partial(parameters_section, verdict),
        partial(remarks_section, verdict),
        partial(record_and_checks, verdict.checks),
        partial(
            reproduce,
            origin,
            laws=[candidate.fit.law for candidate in verdict.candidates[:1] if candidate.fit],
        ),
    )


def opening_section(verdict: Verdict, origin: Origin, remark: str) -> Section:
    """Return the section that a reader may stop after."""
    words = verdict.words
    return opening(
        words,
        origin.data,
        remark,
        facts=facts(verdict),
        settles=words.settles[:1],
        record="measurement",
    )


def _estimates(verdict: Verdict) -> list[tuple[Estimate, Estimate]]:
    """Return the parameters, if the named law holds and over all laws, levels and slopes first."""
    return sorted(verdict.stated, key=lambda item: importance(item[0]))


def facts(verdict: Verdict) -> list[Fact]:
    """Return the parameters of the named law with their intervals, three at most."""
    result = []
    for own, every in _estimates(verdict):
        value = with_unit(within(own.value, every.low, every.high), own.quantity.unit)
        what = f"{own.words} ${own.quantity.symbol}$, 95 % over all laws"
        aside = interval(every.low, every.high)
        result.append(Fact(value=value, what=what, aside=aside))
    return result[:MOST]


def run_section(verdict: BandVerdict, prefix: str = "run") -> Section | None:
    """Return the figure of the motion as measured and as simulated; None where none was run."""
    seen = verdict.certificate
    if seen is None:
        return None
    unit = verdict.measurement.unit(seen.compared)
    svg = inline_svg(
        draw_run(seen, unit), alt="Measured and simulated motion over time, one stretch enlarged",
        prefix=f"{prefix}-figure", **MAP_SIZES,
    )  # fmt: skip
    block = Figure(svg=svg, caption=f"**Motion.** {seen} Shaded: the stretch that is enlarged.")
    return Section(id="run", nav="Run", heading="The motion, measured and run", blocks=(block,))


def figure_section(verdict: BandVerdict, prefix: str = "band") -> Section:
    """Return the figure of the readings, the band and the law."""
    drawing = verdict.drawing()
    over = drawing.names[0]
    text = (
        "**Friction.** Points: readings, hollow where they lie far from the others. Line:"
        f" {verdict.closest.title}. Band: the 95 % interval of friction at each {over}, whichever"
        " law holds, if any."
    )
    if over != "velocity":
        text += " What else differs between the readings is corrected for by the law."
    if drawing.places:
        text += " Dotted: where further readings would narrow the band most."
    heading = f"Friction over the {'speed' if over == 'velocity' else over}"
    return band_section(drawing, f"Friction against {over}", heading, text, prefix)


def band_section(
    drawing: BandDrawing, alt: str, heading: str, caption: str, prefix: str = "band"
) -> Section:
    """Return the section with the figure of a band."""
    svg = inline_svg(
        draw_band(drawing), alt=f"{alt}: readings, the 95 % band and the named law",
        prefix=f"{prefix}-figure", **MAP_SIZES,
    )  # fmt: skip
    block = Figure(svg=svg, caption=caption)
    return Section(id="band", nav="Band", heading=heading, blocks=(block,))


def laws_section(verdict: BandVerdict, *, with_caption: bool = True) -> Section:
    """Return the ladder: laws by their parameters, with how close each is to friction.

    Its caption, which another ladder of the page may have, says what its columns are.
    """
    (law, *heads, _), texts = ladder_rows(verdict)
    rows = tuple(
        Row(cells=(Name(text=title, aside=outcome), *cells), chosen=outcome == "named")
        for title, *cells, outcome in texts
    )
    others = (Column(head=head, numeric=True, phone="label") for head in heads)
    columns = (Column(head=law), *others)
    caption = (
        "Differs by: how far the law is from the most probable friction curve, over friction, at"
        " 95 % of the speeds. Worst: the largest difference. Scatter: root mean square of the"
        " readings about the law. Probability: that the law holds, but for a small discrepancy that"
        f" no law describes. A law is ruled out at odds of {number(RIVAL)} to 1 against it. The"
        " named law is the most probable one that describes friction to"
        f" {percent(verdict.judgement.tolerance)}; if none does, the one that differs least for its"
        " number of parameters."
    )
    table = Table(columns=columns, rows=rows, caption=caption if with_caption else "")
    count = len(verdict.set)
    heading = "The named law and others"
    if count > 1:
        heading = f"{count} laws are not ruled out by the measurement"
    return Section(id="models", nav="Laws", heading=heading, blocks=(table,))


def parameters_section(verdict: Verdict, *, with_caption: bool = True) -> Section | None:
    """Return the parameters: under the named law, and over the laws that have them."""
    if not verdict.stated:
        return None
    rows = []
    for own, every in _estimates(verdict):
        unit = own.quantity.unit if own.quantity.unit != "1" and own.known else ""
        text = own.range if own.known else "not identified"
        value, doubt = own.parts if own.bounded else (text, "")
        rows.append(
            Row(
                cells=(
                    Name(text=f"${own.quantity.symbol}$", aside=own.words),
                    with_unit(interval(every.low, every.high), unit if every.known else ""),
                    Number(value=value, doubt=doubt, unit=unit),
                )
            )
        )
    columns = (
        Column(head="parameter"),
        Column(head="95 % over all laws", numeric=True),
        Column(head="95 % if this law holds", numeric=True, phone="label"),
    )
    caption = (
        "Quote the first interval, which allows for every law that has the parameter, less for"
        " less probable ones. The second holds only if the named law does."
    )
    table = Table(columns=columns, rows=tuple(rows), caption=caption if with_caption else "")
    heading = f"Parameters of {verdict.closest.title}"
    return Section(id="parameters", nav="Parameters", heading=heading, blocks=(table,))


def remarks_section(verdict: Verdict) -> Section | None:
    """Return what is open beyond what the opening says; None without more."""
    lines = verdict.words.cannot_tell[MOST:]
    if not lines:
        return None
    items = tuple(KeyValue(key="Open", value=line) for line in lines)
    return Section(
        id="open", nav="Open", heading="What else is open", blocks=(KeyValues(items=items),)
    )
