"""What was measured on the rig of a run, beside the prediction."""

from stickslip.plots import VALIDATION_SIZES, draw_validation, inline_svg
from stickslip.report.core.blocks import Block, Caption, Figure
from stickslip.report.core.documents import Section
from stickslip.report.core.tables import Column, Row, Table
from stickslip.report.runs.subject import RunReport
from stickslip.sweep import Validation

MOST_RECORDS = 4
"""Records that have a figure."""
HEADINGS = {
    True: "What was measured agrees with the prediction",
    False: "What was measured does not agree with the prediction",
    None: "What was measured beside the prediction",
}


def validation_section(about: RunReport) -> Section | None:
    """Return what was measured beside the prediction, None where nothing was compared."""
    seen = about.validation
    if seen is None:
        return None
    verdict, *rest = seen.sentences()
    blocks: list[Block] = [Caption(text=verdict)]
    for index in range(min(len(seen.records), MOST_RECORDS)):
        name = seen.records[index].name or f"record {index + 1}"
        band = "; shaded: 95 % band of the prediction, without noise" if seen.drawn else ""
        svg = inline_svg(
            draw_validation(seen, record=index),
            alt=f"Measured and predicted, {name}",
            prefix=f"validation-{index}",
            **VALIDATION_SIZES,
        )
        label = f" ({name})" if len(seen.records) > 1 else ""
        blocks.append(
            Figure(svg=svg, caption=f"**Measured and predicted**{label}, and residual{band}.")
        )
    if seen.travels:
        blocks.append(_travels(seen))
    blocks += [Caption(text=text) for text in rest]
    if about.refit:
        blocks.append(Caption(text="**Refitted to this measurement.** " + " ".join(about.refit)))
    return Section(
        id="validation", nav="Measured", heading=HEADINGS[seen.agrees], blocks=tuple(blocks)
    )


def _travels(seen: Validation) -> Table:
    heads = ("measured", "predicted", "95 % band", "meets it")
    columns = (
        Column(head="trial"),
        Column(head="quantity", phone="label", label="quantity:"),
        *(Column(head=head, numeric=True, phone="label", label=f"{head}:") for head in heads),
    )
    rows = (
        Row(cells=(one.name, one.quantity.replace("_", " "), *one.cells())) for one in seen.travels
    )
    return Table(columns=columns, rows=tuple(rows))
