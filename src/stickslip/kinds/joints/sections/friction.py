"""The friction map: what was measured against velocity, and the law that was chosen."""

import itertools
import math
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.formatting import Scale, joined, quantity, significant, with_unit
from stickslip.friction import DirectionDependent
from stickslip.identification import RecordFit, inputs_text
from stickslip.kinds.joints.joint_verdict import RecordCandidate, RecordVerdict
from stickslip.kinds.joints.sections.texts import rival_of
from stickslip.plots import (
    MAP_SIZES,
    MapPoints,
    characteristic,
    draw_fitted_map,
    inline_svg,
    map_points,
    sampled,
)
from stickslip.report import Figure, Section
from stickslip.selection import in_sentence

Array: TypeAlias = NDArray[np.float64]
FELT: Final = 0.02
"""Share of friction by which it has to change with the speed to be said to."""
REFUTED: Final = 0.25
"""Points this far off the curve on average, over the size of friction, speak against it."""
MIXED: Final = 0.05
"""Share of the largest speed below which filtered points mix both directions."""


def map_section(verdict: RecordVerdict) -> Section | None:
    """Return the section with the friction map, None where friction cannot be read off."""
    best, rival = verdict.closest, rival_of(verdict)
    points = map_points(best.fit) if best.fit else None
    if best.fit is None or points is None or not np.any(points.velocity):
        return None
    laws = {best.title: best.fit}
    if rival is not None and rival.fit is not None:
        laws[rival.title] = rival.fit
    draw = draw_fitted_map(points, laws)
    svg = inline_svg(
        draw,
        alt=f"Friction against velocity, measured and by {' and '.join(laws)}",
        prefix="map-figure",
        **MAP_SIZES,
    )
    caption = _caption(points, len(sampled(len(points.velocity))), laws, best.title)
    figure = Figure(svg=svg, caption=caption)
    return Section(id="map", nav="Friction map", heading=_heading(best, points), blocks=(figure,))


def _heading(best: RecordCandidate, points: MapPoints) -> str:
    """Return what the chosen law says of friction, where the points do not contradict its curve."""
    fit = best.fit
    assert fit is not None
    law = fit.law
    if _off(fit, points) > REFUTED:
        if law.states:
            return "The measured friction is not a function of velocity"
        return "Friction against velocity"
    if isinstance(law, DirectionDependent) and _viscous_parts_differ(fit):
        faster = law.backward_viscous_coefficient > law.forward_viscous_coefficient
        ways = ("in reverse than forward", "forward than in reverse")
        return f"Friction grows faster {ways[0] if faster else ways[1]}"
    fastest = float(np.percentile(np.abs(points.velocity), 99.5))
    v, force = characteristic(fit.typical_law, points.load, fastest)
    ahead = v > 0.0
    units = (fit.measurement.unit("velocity"), fit.measurement.unit("friction"))
    words = course(v[ahead], force[ahead], *units)
    return f"In the {in_sentence(best.title)} law, friction {words}"


def course(speed: Array, force: Array, speed_unit: str, force_unit: str) -> str:
    """Return how friction changes with the speed, with where it turns, in words.

    Examples
    --------
    >>> course(np.array([0.0, 0.1, 1.0]), np.array([5.0, 2.0, 4.0]), "m/s", "N")
    'falls from 5 N near rest to 2 N at 0.1 m/s and grows to 4 N at 1 m/s'
    >>> course(np.array([0.0, 1.0]), np.array([5.0, 5.01]), "m/s", "N")
    'is 5.01 N at all speeds'
    """
    shown = Scale(1.0, force_unit)  # as on the axis of the map
    size = float(np.max(np.abs(force)))
    at = _turns(force, FELT * size)
    if at is None:
        return f"is {shown.quantity(float(force[-1]))} at all speeds"
    first = float(force[0])
    start = "0" if abs(first) <= 0.01 * size else f"{shown.quantity(first, 2)} near rest"
    legs: list[str] = []
    for before, here in itertools.pairwise((0, *at)):
        turn = "grows" if force[here] > force[before] else "falls"
        where = quantity(float(speed[here]), speed_unit, 3 if here == len(speed) - 1 else 2)
        origin = "" if legs else f"from {start} "
        legs.append(f"{turn} {origin}to {shown.quantity(float(force[here]), 2)} at {where}")
    return joined(legs)


def _turns(force: Array, least: float) -> list[int] | None:
    """Return where a curve turns by more than some force, and its end; None if it is level."""
    found, way, best = list[int](), 0.0, 0
    for i, change in enumerate((force - force[0]).tolist()):
        beyond = float(force[i] - force[best])
        if not way:
            if abs(change) > least:
                way, best = math.copysign(1.0, change), i
        elif beyond * way >= 0.0:
            best = i
        elif abs(beyond) > least:
            found.append(best)
            way, best = -way, i
    return [*found, len(force) - 1] if way else None


def _off(fit: RecordFit, points: MapPoints) -> float:
    """Return how far points are off the curve of a law, over the size of friction.

    Where friction is derived, filters mix both directions close to rest: those points do not count.
    """
    top = float(np.max(np.abs(points.velocity)))
    v, force = characteristic(fit.typical_law, points.load, 1.01 * top)
    kept = np.full(len(points.velocity), fill_value=True)
    if not points.measured:
        kept = np.abs(points.velocity) > MIXED * top
    friction = points.friction[kept]
    gaps = friction - np.interp(points.velocity[kept], v, force) - fit.offset
    size = float(np.sqrt(np.mean(friction**2))) if len(friction) else 0.0
    return float(np.sqrt(np.mean(gaps**2))) / size if size > 0.0 else 0.0


def _viscous_parts_differ(fit: RecordFit) -> bool:
    """Whether the viscous parts of the directions differ by more than their intervals."""
    found = [e for e in fit.estimates if e.path.endswith("ward_viscous_coefficient")]
    if len(found) < 2 or not all(e.bounded for e in found):
        return False
    return abs(found[0].value - found[1].value) > sum(e.half_width for e in found)


def _caption(points: MapPoints, shown: int, laws: dict[str, RecordFit], chosen: str) -> str:
    count = len(points.velocity)
    some = f"{shown:,} of {count:,}" if shown < count else f"{count:,}"
    if points.measured:
        text = f"**Friction map.** {some} samples of measured friction against velocity."
    else:
        text = (
            f"**Friction map.** {some} samples: drive force minus mass times acceleration and the"
            " forces of the mechanism, all passed through the same zero-phase filter, against"
            " velocity. Near zero velocity the filter mixes both branches."
        )
    if np.any(points.trend):
        text += " Green dots: speeding up; purple triangles: slowing down; grey: neither."
    text += f" Solid: {in_sentence(chosen)}, as fitted"
    others = [in_sentence(name) for name in laws if name != chosen]
    text += "; dashed: " + ", ".join(others) if laws else ""
    text = text.removesuffix("; dashed: ") + "."
    if any(one.law.states for one in laws.values()):
        text += " Bristle laws are drawn in steady sliding; their loops surround these curves."
    if points.load_varies:
        load = with_unit(significant(points.load, 3), "N")
        text += f" Laws are drawn at the median normal force, {load}."
    inputs = {name: value for one in laws.values() for name, value in one.typical_inputs.items()}
    if inputs:
        turning = laws[chosen].measurement.turning
        text += f" Laws are drawn at the median of {inputs_text(inputs, turning=turning)}."
    return text
