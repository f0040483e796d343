"""What the chosen law leaves: residuals, and errors of predictions over time."""

import numpy as np

from stickslip.formatting import joined, number, percent, significant
from stickslip.identification import RecordFit, has_trend, ljung_box, noise_floor
from stickslip.kinds.joints.joint_verdict import RecordVerdict
from stickslip.kinds.joints.sections.texts import rival_of, symbols_of
from stickslip.plots import (
    ERROR_SIZES,
    ResidualPanel,
    block_edges,
    draw_prediction_error,
    draw_residuals,
    errors_of,
    inline_svg,
    is_timed,
    residual_panels,
    residual_sizes,
    rows_of,
)
from stickslip.report import Block, Figure, Section, typeset

NO_CAUSE = ("law", "unexplained")
"""Kinds of errors of the model that say that there is one, and not what it is."""
FLOOR = 10.0
"""Residuals over what noise would leave from which a missing trend alone says too little."""


def residuals_section(verdict: RecordVerdict) -> Section | None:
    """Return the section on what the chosen law does not explain."""
    best = verdict.closest
    if best.fit is None or not np.all(np.isfinite(best.fit.residual)):
        return None
    panels, trends = _panels(best.fit, verdict.scale.factor)
    blocks: list[Block] = []
    if panels:
        blocks.append(_residual_figure(verdict, best.fit, panels, trends))
    errors = _error_figure(verdict)
    if errors is not None:
        blocks.append(errors)
    if not blocks:
        return None
    return Section(
        id="residuals",
        nav="Residuals",
        heading=_heading(best.fit, list(panels), trends),
        blocks=tuple(blocks),
    )


def _panels(fit: RecordFit, factor: float) -> tuple[dict[str, ResidualPanel], list[str]]:
    """Return the panels by what residuals are drawn against, and with which they have a trend."""
    panels, rows = residual_panels(fit, factor), rows_of(fit)
    against = {"time": rows.t, "velocity": rows.velocity, "position": rows.position}
    trends = [
        name
        for name in panels
        if (x := against[name]) is not None and has_trend(factor * rows.residual, x)
    ]
    return panels, trends


def _heading(fit: RecordFit, panels: list[str], trends: list[str]) -> str:
    if fit.model_errors:
        causes = [one.kind for one in fit.model_errors if one.kind not in NO_CAUSE]
        if not causes:
            return "The residuals show an error of the model"
        return f"Model error: the residuals show an effect of {joined(causes)}"
    if trends:
        return f"The residuals depend on {joined(trends)}"
    if not panels:
        return "Prediction errors over time"
    names = joined(panels).replace(" and ", " or ")
    over = _over_noise(fit)
    if over > FLOOR:
        return (
            f"Residuals {significant(over, 2)} times the sensor noise, without dependence on"
            f" {names}"
        )
    return f"No test finds a dependence of the residuals on {names}"


def _over_noise(fit: RecordFit) -> float:
    """Return the residuals over those that noise alone would leave; 0 where that is not known."""
    floor = noise_floor(fit.mechanism, fit.measurement, fit.problem.quantity)
    return fit.rms / floor if floor > 0.0 else 0.0


def _residual_figure(
    verdict: RecordVerdict,
    fit: RecordFit,
    panels: dict[str, ResidualPanel],
    trends: list[str],
) -> Figure:
    scale = verdict.scale
    svg = inline_svg(
        draw_residuals(list(panels.values()), f"residual, {scale.unit}"),
        alt=f"Residuals of the chosen law against {joined(list(panels))}",
        prefix="residual-figure",
        **residual_sizes(len(panels)),
    )
    caption = (
        f"**Residuals** of the fit: measured minus predicted {verdict.quantity}. Root mean"
        f" square {scale.error(fit.rms)}{_share(fit)}."
    )
    rival = rival_of(verdict)
    if rival is not None and rival.fit is not None:
        caption += f" {rival.title}: {scale.error(rival.fit.rms)}."
    caption += (
        f" Error bars assume an effective sample size of {significant(fit.inference.effective, 2)}"
        f" of {len(fit.residual):,} rows."
    )
    text = typeset(f"{caption} {_tests(fit, trends)}", symbols_of(verdict.candidates))
    return Figure(svg=svg, caption=text)


def _tests(fit: RecordFit, trends: list[str]) -> str:
    """Return what tests say of the residuals, in sentences."""
    text = _autocorrelation(fit)
    if trends:
        text += (
            f" The mean residual depends on {joined(trends)} (confirmed on held-out blocks): the"
            " law or the mechanism is incomplete."
        )
    over = _over_noise(fit)
    if over > FLOOR:
        text += (
            f" They are {significant(over, 2)} times the sensor noise, because of an unmeasured"
            " disturbance or a model error."
        )
    text += "".join(f" {one}" for one in fit.model_errors)
    return text


def _autocorrelation(fit: RecordFit) -> str:
    """Return what the test of Ljung and Box says."""
    chance = ljung_box(fit.residual)
    if chance >= 0.05:
        return f"The residuals are not autocorrelated (Ljung-Box test, p = {number(chance, 2)})."
    said = "p < 0.001" if chance < 1e-3 else f"p = {number(chance, 2)}"
    return f"The residuals are autocorrelated (Ljung-Box test, {said})."


def _share(fit: RecordFit) -> str:
    """Return how much of what was measured a law leaves, in words."""
    spread = float(np.std(fit.problem.measured))
    share = percent(fit.rms / spread) if spread > 0.0 else ""
    return f", {share} of the spread of {fit.problem.quantity}" if share else ""


def _error_figure(verdict: RecordVerdict) -> Figure | None:
    """Return errors over time and by block, None where there is no time or a block is missing."""
    best, rival = verdict.closest, rival_of(verdict)
    if best.fit is None or not is_timed(best.fit):
        return None
    scale, edges = verdict.scale, block_edges(best.fit, verdict.plan.folds)
    series = {}
    for one in (best, rival):
        found = errors_of(one, verdict.plan.horizon, scale.factor) if one is not None else None
        if one is not None and found is not None and len(found.blocks) == len(edges) - 1:
            series[one.title] = found
    if best.title not in series:
        return None
    svg = inline_svg(
        draw_prediction_error(series, edges, f"error, {scale.unit}", chosen=best.title),
        alt=f"Prediction errors over time by {' and '.join(series)}",
        prefix="error-figure",
        **ERROR_SIZES,
    )
    caption = (
        f"**Prediction errors.** Above: measured minus predicted {verdict.quantity}. Below: each"
        " block predicted by a fit without it. An error that repeats in every cycle is a model"
        " error, not noise."
    )
    return Figure(svg=svg, caption=caption)
