"""Errors of models in words."""

from collections.abc import Mapping

import numpy as np

from stickslip.experiments import Measurement, turned
from stickslip.formatting import number, percent, quantities, quantity
from stickslip.identification.residuals.effects import Effect

__all__ = ["finding_of"]

HALF = (0.35, 0.65)
"""Delays over the step of time which are those of a wrong setting of hold."""
SAID: Mapping[str, tuple[str, str, str]] = {
    "delay": (
        "s",
        "The motion follows the recorded force {size} late{half} a delay or lag of the amplifier"
        " or of the position sensor, or two clocks.",
        "The recorded force follows the motion {size} late{half} a delay or filter of the force"
        " sensor, or two clocks.",
    ),
    "clock": (
        "s",
        "The motion falls behind the recorded force by {size} each second: two clocks that run"
        " apart.",
        "The recorded force falls behind the motion by {size} each second: two clocks that run"
        " apart.",
    ),
    "flexibility": (
        "",
        "Fast forces do not move one rigid mass: the residuals are proportional to the second"
        " derivative of the force ({size} s²), as with a flexible coupling, belt or mount.",
        "Fast forces do not move one rigid mass: the residuals are proportional to the second"
        " derivative of the force ({size} s²), as with a flexible coupling, belt or mount.",
    ),
    "force limit": (
        "share",
        "Of the recorded force beyond {scale}, {size} does not act: a limit of the amplifier.",
        "Of the force beyond {scale}, {size} is missing in the record: a limit of the sensor.",
    ),
    "inertia": (
        "mass",
        "The motion takes {size} more than the mass given: a wrong mass or gain of the force.",
        "The motion takes {size} less than the mass given: a wrong mass or gain of the force.",
    ),
    "offset": (
        "force",
        "A constant force of {size} acts beside friction, such as gravity.",
        "A constant force of -{size} acts beside friction, such as gravity.",
    ),
    "drift of the level": (
        "force",
        "The friction level rises over the record, by {size}.",
        "The friction level falls over the record, by {size}.",
    ),
    "drift of the offset": (
        "force",
        "A force beside friction rises over the record, by {size}.",
        "A force beside friction falls over the record, by {size}.",
    ),
    "drift of the viscous part": (
        "force",
        "The viscous part rises over the record, at the largest speed by {size}.",
        "The viscous part falls over the record, at the largest speed by {size}, as in warm-up.",
    ),
    "asymmetry": (
        "force",
        "The viscous part is larger forward, at the largest speed by {size} to either side.",
        "The viscous part is larger backward, at the largest speed by {size} to either side.",
    ),
    "speed": (
        "force",
        "Friction is larger {where} than this law says, by {size}.",
        "Friction is smaller {where} than this law says, by {size}.",
    ),
    "spring": (
        "stiffness",
        "A force grows with position, by {size}: a spring that the mechanism lacks.",
        "A force falls with position, by {size}: a spring that the mechanism lacks.",
    ),
    "position friction": (
        "force",
        "Friction depends on position, by ± {size}, wavelength {scale}.",
        "Friction depends on position, by ± {size}, wavelength {scale}.",
    ),
    "position force": (
        "force",
        "A force beside friction depends on position, by ± {size}, wavelength {scale}: cogging, a"
        " cable, gravity.",
        "",
    ),
    "imbalance": (
        "force",
        "A force depends on position and grows with speed squared, at the largest speed to"
        " {size}, wavelength {scale}: imbalance.",
        "",
    ),
    "after reversals": (
        "",
        "For {scale} after each reversal friction or inertia is larger, by {size} of its"
        " coefficient: backlash, or presliding that the law lacks.",
        "For {scale} after each reversal friction or inertia is smaller, by {size} of its"
        " coefficient: backlash, or presliding that the law lacks.",
    ),
}
"""What the size is measured in, and what an error is where its coefficient is above or below 0."""


def finding_of(
    effect: Effect, value: float, interval: tuple[float, float], measurement: Measurement
) -> str:
    """Return what an error is, with its size and interval.

    Parameters
    ----------
    effect : Effect
        The error.
    value : float
        Its coefficient [SI].
    interval : (float, float)
        Ends of its 95 % interval [SI].
    measurement : Measurement
        The record, which says whether units are those of rotation.

    Returns
    -------
    str
        A clause with size, unit and interval.

    Examples
    --------
    >>> record = Measurement(time=[0.0, 1e-3], position=[0.0, 1e-3], force=[1.0, 1.0])
    >>> spring = Effect("spring", lambda s: (s.middle,))
    >>> finding_of(spring, -4.0, (-4.1, -3.9), record).partition(":")[0]
    'A force falls with position, by 4 N/m (95 % interval 3.9 N/m to 4.1 N/m)'
    """
    unit, above, below = SAID[effect.kind]
    sign = -1.0 if value < 0.0 else 1.0
    ends = sorted(sign * end for end in interval)
    size, low, high = _sized([abs(value), *ends], unit, measurement)
    scaled = measurement.unit("force" if effect.kind == "force limit" else "position")
    return (above if value > 0.0 else below).format(
        size=f"{size} (95 % interval {low} to {high})",
        scale=quantity(effect.scale, scaled),
        where="near rest" if effect.scale else "at the largest speed",
        half=_half_sample(value, measurement),
    )


def _sized(values: list[float], unit: str, measurement: Measurement) -> list[str]:
    """Return numbers with their unit."""
    if unit == "share":
        return [percent(value) for value in values]
    if not unit:
        return [number(value) for value in values]
    force = measurement.unit("force")
    if unit == "stiffness":
        stiffness = f"{force}/{measurement.unit('position')}"
        return [quantity(value, stiffness) for value in values]
    if unit == "mass":
        return [quantity(value, turned("kg", measurement.turning)) for value in values]
    unit = force if unit == "force" else unit
    return [quantity(values[0], unit), *quantities(values[1:], unit)]


def _half_sample(delay: float, measurement: Measurement) -> str:
    """Return that a delay [s] may be a wrong setting: a held force is half a sample late."""
    step = max(float(np.median(np.diff(np.asarray(r.time)))) for r in measurement.records())
    if not HALF[0] <= abs(delay) / step <= HALF[1]:
        return ":"
    hold = '"zero" (a held command)' if delay > 0.0 else '"first" (a sampled sensor signal)'
    return f". This is half a sample: either hold should be {hold}, or there is"
