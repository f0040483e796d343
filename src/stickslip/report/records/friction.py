"""The friction map: what was measured against velocity, and the law that was chosen."""

import numpy as np

from stickslip.friction import BristleLaw, DirectionDependent
from stickslip.identification import RecordFit
from stickslip.plots.friction_map import MAP_SIZES, MapLaw, draw_friction_map
from stickslip.plots.laws import characteristic
from stickslip.plots.svg import inline_svg
from stickslip.report import numbers
from stickslip.report.blocks import Figure
from stickslip.report.documents import Section
from stickslip.report.records.data import MapPoints, map_points, offset_of, sampled
from stickslip.report.records.texts import half_width, rival_of
from stickslip.report.selection.texts import quantity_value
from stickslip.selection import RecordVerdict

__all__ = ["map_section"]


def map_section(verdict: RecordVerdict) -> Section | None:
    """Return the section with the friction map, None where friction cannot be read off."""
    best, rival = verdict.best, rival_of(verdict)
    points = map_points(best.fit) if best and best.fit else None
    if best is None or best.fit is None or points is None or not np.any(points.velocity):
        return None
    laws = {best.title: MapLaw(best.fit.law, offset_of(best.fit))}
    if rival is not None and rival.fit is not None:
        laws[rival.title] = MapLaw(rival.fit.law, offset_of(rival.fit))
    shown = sampled(len(points.velocity))
    draw = draw_friction_map(
        points.velocity[shown], points.friction[shown], laws, points.load, chosen=best.title
    )
    svg = inline_svg(
        draw,
        alt=f"Friction against velocity, measured and by {' and '.join(laws)}",
        prefix="map-figure",
        **MAP_SIZES,
    )
    caption = _caption(points, len(shown), laws, best.title)
    figure = Figure(svg=svg, caption=caption)
    return Section(
        id="map", nav="Friction map", heading=_heading(best.fit, points), blocks=(figure,)
    )


def _heading(fit: RecordFit, points: MapPoints) -> str:
    law = fit.law
    if isinstance(law, DirectionDependent) and _viscous_parts_differ(fit):
        faster = law.backward_viscous_coefficient > law.forward_viscous_coefficient
        ways = ("in reverse than forward", "forward than in reverse")
        return f"Friction grows faster {ways[0] if faster else ways[1]}"
    fastest = float(np.percentile(np.abs(points.velocity), 99.5))
    v, force = characteristic(law, points.load, fastest)
    slow = float(force[np.flatnonzero(v > 0.0)[0]])
    fast = float(force[-1])
    speed = quantity_value(fastest, "m/s")
    if abs(fast - slow) <= 0.02 * max(abs(fast), abs(slow)):
        return f"Friction of {quantity_value(fast, 'N')}, the same at all speeds"
    if abs(slow) <= 0.01 * abs(fast):
        return f"Friction grows from 0 to {quantity_value(fast, 'N', 2)} at {speed}"
    turn = "grows" if fast > slow else "falls"
    start, end = quantity_value(slow, "N", 2), quantity_value(fast, "N", 2)
    return f"Friction {turn} from {start} near rest to {end} at {speed}"


def _viscous_parts_differ(fit: RecordFit) -> bool:
    """Whether the viscous parts of the directions differ by more than their intervals."""
    found = [e for e in fit.estimates if e.path.endswith("ward_viscous_coefficient")]
    if len(found) < 2 or not all(e.bounded for e in found):
        return False
    return abs(found[0].value - found[1].value) > sum(half_width(e) for e in found)


def _caption(points: MapPoints, shown: int, laws: dict[str, MapLaw], chosen: str) -> str:
    count = len(points.velocity)
    some = f"{shown:,} of {count:,}" if shown < count else f"{count:,}"
    if points.measured:
        text = f"**Friction map.** {some} samples of measured friction against velocity."
    else:
        text = (
            f"**Friction map.** {some} samples: drive force minus mass times acceleration and the"
            " forces of the mechanism, all filtered alike without a delay, against velocity. Close"
            " to zero the filter mixes both branches."
        )
    text += f" Solid: {chosen}, as fitted"
    text += "; dashed: " + ", ".join(name for name in laws if name != chosen) if laws else ""
    text = text.removesuffix("; dashed: ") + "."
    if any(isinstance(one.law, BristleLaw) for one in laws.values()):
        text += " Laws with bristles are drawn as in steady sliding; their loops lie around it."
    if points.load_varies:
        load = numbers.with_unit(numbers.significant(points.load, 3), "N")
        text += f" Laws are drawn at the median normal force, {load}."
    return text
