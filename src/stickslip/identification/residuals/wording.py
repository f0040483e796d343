"""Errors of models in words."""

from collections.abc import Mapping

import numpy as np

from stickslip.experiments import Measurement
from stickslip.formatting import (
    percent,
    quantity,
    scale_of,
    with_unit,
    within,
)
from stickslip.identification.residuals.effects import Effect
from stickslip.identification.sensor_response import SensorResponse
from stickslip.identification.settings import Hold
from stickslip.quantities import turned

HALF = (0.35, 0.65)
"""Delays over the step of time which are those of a wrong setting of hold."""
FLEXIBLE = (
    "High-frequency forces do not act on a single rigid mass: the residuals are proportional to the"
    " second derivative of the force ({size} s²), as with a flexible coupling, belt or mount."
)
WAVY = "Friction depends on position, with amplitude {size} and wavelength {scale}."
SAID: Mapping[str, tuple[str, str, str]] = {
    "delay": (
        "s",
        "The motion lags the recorded force by {size}{half} a delay of the amplifier or of the"
        " position sensor, or two unsynchronised clocks.",
        "The recorded force lags the motion by {size}{half} a delay or filter of the force sensor,"
        " or two unsynchronised clocks.",
    ),
    "lag": (
        "s",
        "",
        "The recorded force follows friction through a filter with a time constant of {size}: one"
        " of the force sensor or its amplifier.",
    ),
    "clock": (
        "s",
        "The motion lags the recorded force by a further {size} each second: two clocks that"
        " drift apart.",
        "The recorded force lags the motion by a further {size} each second: two clocks that"
        " drift apart.",
    ),
    "flexibility": ("", FLEXIBLE, FLEXIBLE),
    "force limit": (
        "share",
        "Of the recorded force beyond {scale}, {size} does not act: the amplifier saturates.",
        "Of the force beyond {scale}, {size} is missing from the record: the sensor saturates.",
    ),
    "inertia": (
        "mass",
        "The motion needs a mass {size} larger than the one given: the mass or the gain of the"
        " force is wrong.",
        "The motion needs a mass {size} smaller than the one given: the mass or the gain of the"
        " force is wrong.",
    ),
    "offset": (
        "force",
        "A constant force of {size} acts in addition to friction, such as gravity.",
        "A constant force of -{size} acts in addition to friction, such as gravity.",
    ),
    "drift of the level": (
        "force",
        "The friction level rises by {size} over the record.",
        "The friction level falls by {size} over the record.",
    ),
    "drift of the offset": (
        "force",
        "A force in addition to friction rises by {size} over the record.",
        "A force in addition to friction falls by {size} over the record.",
    ),
    "drift of the viscous part": (
        "force",
        "Viscous friction at the largest speed rises by {size} over the record.",
        "Viscous friction at the largest speed falls by {size} over the record, as in warm-up.",
    ),
    "asymmetry": (
        "force",
        "Viscous friction is larger forward: at the largest speed, by {size} from the mean of both"
        " directions.",
        "Viscous friction is larger backward: at the largest speed, by {size} from the mean of"
        " both directions.",
    ),
    "speed": (
        "force",
        "Friction {where} exceeds the prediction of the law by {size}.",
        "Friction {where} is below the prediction of the law by {size}.",
    ),
    "spring": (
        "stiffness",
        "A force rises with position by {size}: the mechanism lacks a spring.",
        "A force falls with position by {size}: the mechanism lacks a spring.",
    ),
    "position friction": ("force", WAVY, WAVY),
    "position force": (
        "force",
        "A force in addition to friction depends on position, with amplitude {size} and"
        " wavelength {scale}: cogging, a cable or gravity.",
        "",
    ),
    "imbalance": (
        "force",
        "A force depends on position and grows with the square of speed, to {size} at the largest"
        " speed, with wavelength {scale}: imbalance.",
        "",
    ),
    "after reversals": (
        "",
        "For {scale} after each reversal, friction or inertia is larger by {size} of its"
        " coefficient: backlash, or presliding that the law lacks.",
        "For {scale} after each reversal, friction or inertia is smaller by {size} of its"
        " coefficient: backlash, or presliding that the law lacks.",
    ),
}
"""What the size is measured in, and what an error is where its coefficient is above or below 0."""


def finding_of(
    effect: Effect,
    value: float,
    ends: tuple[float, float],
    measurement: Measurement,
    hold: Hold = "zero",
) -> str:
    """Return what an error is, with its size and interval.

    Examples
    --------
    >>> record = Measurement(time=[0.0, 1e-3], position=[0.0, 1e-3], force=[1.0, 1.0])
    >>> spring = Effect("spring", lambda s: (s.middle,))
    >>> finding_of(spring, -4.0, (-4.1, -3.9), record).partition(":")[0]
    'A force falls with position by 4.00 N/m (95 % interval 3.90 to 4.10 N/m)'
    """
    unit, above, below = SAID[effect.kind]
    sign = -1.0 if value < 0.0 else 1.0
    low, high = sorted(sign * end for end in ends)
    size, span = _sized(abs(value), (low, high), unit, measurement)
    scaled = measurement.unit("force" if effect.kind == "force limit" else "position")
    return (above if value > 0.0 else below).format(
        size=f"{size} (95 % interval {span})",
        scale=quantity(effect.scale, scaled),
        where="near rest" if effect.scale else "at the largest speed",
        half=_half_sample(value, measurement, hold),
    )


def cure_of(response: SensorResponse) -> str:
    """Return how to fit friction that a sensor shows late.

    Examples
    --------
    >>> cure_of(SensorResponse(lag=0.012)).partition(": ")[2]
    'RecordSettings(friction_lag=0.012), or --friction-lag 0.012.'
    >>> cure_of(SensorResponse(delay=0.02, lag=0.012)).rpartition(" or ")[2]
    '--friction-delay 0.02 --friction-lag 0.012.'
    """
    both = {"delay": response.delay, "lag": response.lag}
    shown = {name: f"{value:.3g}" for name, value in both.items() if value}
    settings = ", ".join(f"friction_{name}={value}" for name, value in shown.items())
    options = " ".join(f"--friction-{name} {value}" for name, value in shown.items())
    return f"If the channel is late, correct for it: RecordSettings({settings}), or {options}."


def _sized(
    value: float, ends: tuple[float, float], unit: str, measurement: Measurement
) -> tuple[str, str]:
    """Return a number and its interval, both to the same digit and in one unit."""
    low, high = ends
    if unit == "share":
        return percent(value), f"{percent(low)} to {percent(high)}"
    force = measurement.unit("force")
    units = {
        "force": force,
        "stiffness": f"{force}/{measurement.unit('position')}",
        "mass": turned("kg", measurement.turning),
    }
    scale = scale_of([value], units.get(unit, unit))
    shown = within(scale.factor * value, scale.factor * low, scale.factor * high)
    return with_unit(shown, scale.unit), scale.interval(low, high)


def _half_sample(delay: float, measurement: Measurement, hold: Hold) -> str:
    """Return that a delay [s] may be a wrong setting: a held force is half a sample late."""
    other: Hold = "zero" if delay > 0.0 else "first"
    if "friction" in measurement.quantities() or other == hold:
        return ":"
    step = max(float(np.median(np.diff(np.asarray(r.time)))) for r in measurement.records())
    if not HALF[0] <= abs(delay) / step <= HALF[1]:
        return ":"
    meant = "a held command" if other == "zero" else "a sampled sensor signal"
    return f'. This is half a sample: either set hold to "{other}" ({meant}), or there is'
