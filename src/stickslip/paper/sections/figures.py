"""The paper's figures, drawn again.

The captions of the paper could not be read: which figure shows which model is our assignment, in
the order of its Table II, and is said so on the page.
"""

from stickslip.friction import BristleLaw
from stickslip.paper.audit import PaperAudit, TableRow
from stickslip.plots.laws import (
    characteristic_sizes,
    draw_characteristics,
    draw_presliding,
    presliding_sizes,
)
from stickslip.plots.motion import draw_motion
from stickslip.plots.svg import inline_svg
from stickslip.report import Figure, Paragraph, Section

__all__ = ["figure_sections"]

FIRST_RUN = 6
"""Figs 6 to 10 are the runs of Table II's rows."""


def figure_sections(found: PaperAudit) -> tuple[Section, ...]:
    """Return Figs 3 and 4, the laws, and Figs 6 to 10, the runs."""
    text = (
        "Figs 3 and 4 show the laws, Figs 6 to 10 the block, in the order of Table II. The"
        " captions of the paper were not at hand: the numbers of the figures are our assignment."
        " Figs 2 and 11, the cart, have sections of their own."
    )
    runs = [_run_figure(row, FIRST_RUN + i) for i, row in enumerate(found.table)]
    return (
        Section(
            id="figures",
            nav="Figures again",
            heading="The paper’s other figures, recomputed",
            blocks=(Paragraph(text=text), *_law_figures(found), *runs),
        ),
    )


def _law_figures(found: PaperAudit) -> tuple[Figure, Figure]:
    laws = {row.law.title: row.law for row in found.table}
    bristle = {title: law for title, law in laws.items() if isinstance(law, BristleLaw)}
    load = found.values.load
    characteristics = inline_svg(
        draw_characteristics(laws, load=load, v_max=0.5),
        alt="Friction force against slip velocity of the five models",
        prefix="fig3",
        **characteristic_sizes(len(laws)),
    )
    presliding = inline_svg(
        draw_presliding(bristle, load=load),
        alt="Friction force against displacement before slip",
        prefix="fig4",
        **presliding_sizes(len(bristle)),
    )
    return (
        Figure(
            svg=characteristics,
            caption="**Fig. 3. Friction against velocity**, corrected laws. At rest any force up"
            " to break-away; bristle laws by their steady curve.",
        ),
        Figure(
            svg=presliding,
            caption="**Fig. 4. Friction against displacement** before and at the onset of slip,"
            " slowly pushed to and fro.",
        ),
    )


def _run_figure(row: TableRow, number: int) -> Figure:
    runs = {f"{reading.key}. {reading.title}": reading.run for reading in row.readings}
    return Figure(
        svg=inline_svg(
            draw_motion(runs, chosen=_chosen(row)),
            alt=f"Displacement and velocity of the block with {row.law.title} friction",
            prefix=f"fig{number}",
        ),
        caption=f"**Fig. {number}. {row.law.title}.** Published travel"
        f" {row.published.travel or 0.0:.2f} m; {_said(row)}",
    )


def _chosen(row: TableRow) -> str:
    return next(f"{r.key}. {r.title}" for r in row.readings if r.key == "B")


def _said(row: TableRow) -> str:
    travels = [f"{r.key} {r.criteria.travel:.3f} m" for r in row.readings]
    return f"ours {', '.join(travels)}."
