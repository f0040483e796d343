"""What a mean velocity or a travel per cycle has to be multiplied by to be a travel."""

import math

from stickslip.errors import InputError
from stickslip.experiments.measurement import QUANTITIES, Measurement
from stickslip.formatting import quantity
from stickslip.mechanisms import PREFIX, WHOLE, Mechanism, cycle_of
from stickslip.quantities import vary


def scale_of(
    mechanism: Mechanism, record: Measurement, t_end: float, label: str
) -> tuple[float, int | None]:
    """Return the travel over what a trial gives of it, and after how many cycles its run ends.

    A mean velocity is that of the whole run, so that the travel is ``t_end`` times it. A travel per
    cycle is a mean over all whole cycles that end by ``t_end``, the first one included; the run of
    that trial ends with the last of them, and so one ``t_end`` serves trials at several periods.

    Examples
    --------
    >>> from stickslip import Capsule
    >>> from stickslip.drives import Square
    >>> from stickslip.mechanisms import Torque
    >>> wave = Torque(drive=Square(high=6.0, low=-1.0, period=0.4))
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=wave)
    >>> scale_of(capsule, Measurement(mean_velocity=0.01), 6.0, "trial 1")
    (6.0, None)
    >>> scale_of(capsule, Measurement(travel_per_cycle=0.004), 6.1, "trial 1")
    (15.0, 15)
    """
    if record.travelled == "mean_velocity":
        return float(t_end), None
    if record.travelled != "travel_per_cycle":
        return 1.0, None
    try:
        count = whole_cycles(vary(mechanism, PREFIX, record.overrides), t_end)
    except InputError as error:
        what = f"{label}: travel_per_cycle ({QUANTITIES['travel_per_cycle'].symbol})"
        raise InputError(f"{what} {error}") from None
    return float(count), count


def whole_cycles(mechanism: Mechanism, t_end: float) -> int:
    """Return the number of cycles of the drives that end by a time [s], at least 1.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.drives import Sine
    >>> whole_cycles(Axis(inertia=1.0, drive=Sine(amplitude=2.0, frequency=4.0)), 0.9)
    3
    """
    try:
        period = cycle_of(mechanism)
    except InputError as error:
        reason = str(error).removesuffix("; give the period [s] explicitly.").removesuffix(".")
        raise InputError(
            f"needs periodic drives, but {reason}. Give travel or mean_velocity instead."
        ) from None
    count = math.floor(t_end / period * (1.0 + WHOLE))
    if not count:
        raise InputError(
            f"needs at least one whole cycle of {quantity(period, 's')}, but the run ends at t_end"
            f" = {quantity(t_end, 's')}. Increase t_end."
        )
    return count
