"""What an explanation of a force balance says of the rig and of the record, as model errors."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final, final

import numpy as np

from stickslip.evidence import Explanation, Fault, Term
from stickslip.experiments import Measurement
from stickslip.formatting import percent, quantity, scale_of, with_unit, within
from stickslip.identification.estimation.model_error import ModelError

LATE: Final = ("delay", "backlash", "loose", "flexible")
"""Kinds of faults that all shift force against motion near reversals."""
CALLED: Final[Mapping[str, str]] = {
    "delay": "a delay",
    "backlash": "backlash",
    "loose": "backlash",
    "flexible": "a flexible coupling",
    "spring": "a spring",
    "drift": "a drift of the friction level",
    "offset_drift": "a drifting force beside friction",
    "viscous_drift": "a drift of the viscous friction",
    "saturation": "saturation of the force",
    "mass": "another mass",
    "ripple": "a force that depends on position",
}
"""Kinds as nouns."""


@final
@dataclass(frozen=True, kw_only=True)
class _Sized:
    """A fault with its size in words."""

    value: float
    """Its parameter, SI."""
    text: str
    """That, without a sign, with its unit and interval."""
    force: str
    """Root mean square of the force that it explains, with its unit."""
    scale: str
    """Its nonlinear parameter, where the size is another."""
    measured: bool
    """Whether friction itself was measured."""


def model_errors(found: Explanation, measurement: Measurement) -> tuple[ModelError, ...]:
    """Return the faults of an explanation, the largest first, and forces that no law has."""
    errors = [_error(found, one, measurement) for one in found.faults]
    errors += [
        _ripple(found, term, measurement)
        for term in found.best.structure.free
        if term.kind == "ripple"
    ]
    return tuple(sorted(errors, key=lambda one: -one.share))


def _error(found: Explanation, fault: Fault, measurement: Measurement) -> ModelError:
    kind = fault.kinds[0]
    value = fault.value or 0.0
    ends = fault.interval or (math.nan, math.nan)
    sized = _Sized(
        value=value,
        text=_size(value, ends, _unit(kind, measurement)),
        force=quantity(fault.size, measurement.unit("force")),
        scale="",
        measured="friction" in measurement.quantities(),
    )
    others = [one for one in dict.fromkeys(CALLED[k] for k in fault.kinds) if one != CALLED[kind]]
    if others:
        finding = _undecided(fault, sized, others)
    else:
        finding = f"{SAID[kind](sized)}."
    return ModelError(
        kind=_group(fault.kinds),
        finding=finding,
        consequence=(
            f"It explains {sized.force} of the force, {percent(fault.share)} of the friction."
            " The 95 % intervals do not account for it."
        ),
        effect=value,
        interval=(float(ends[0]), float(ends[1])),
        share=fault.share**2,
    )


def _group(kinds: tuple[str, ...]) -> str:
    """Return the name of a finding: of several kinds that are all late or elastic, the group."""
    names = dict.fromkeys("backlash" if one == "loose" else one for one in kinds)
    if len(names) == 1:
        return next(iter(names))
    return "late or elastic" if set(kinds) <= set(LATE) else " or ".join(names)


def _undecided(fault: Fault, sized: _Sized, others: list[str]) -> str:
    own = f"{CALLED[fault.kinds[0]]} of {sized.text}"
    choice = " or ".join([own, *others])
    if set(fault.kinds) <= set(LATE):
        return (
            f"Something late or elastic acts between force and motion: {choice}. The record does"
            " not tell which."
        )
    return f"Beside the friction law, the force balance asks for {choice}; the record does not tell which."


def _ripple(found: Explanation, term: Term, measurement: Measurement) -> ModelError:
    own = [float(x) for x, one in zip(found.best.coef, found.best.owner, strict=True) if one == term]
    amplitude = math.hypot(*own)
    length = quantity(2.0 * math.pi / term.par[0], measurement.unit("position"))
    force = quantity(amplitude, measurement.unit("force"))
    share = amplitude / math.sqrt(2.0) / found.scale
    return ModelError(
        kind="position force",
        finding=(
            f"A force in addition to friction depends on position, with amplitude {force} and"
            f" wavelength {length}: cogging, a cable or gravity."
        ),
        consequence=f"It is {percent(share)} of the friction, and no law of friction has it.",
        effect=amplitude,
        interval=(math.nan, math.nan),
        share=share**2,
    )


def _size(value: float, ends: tuple[float, float], unit: str) -> str:
    """Return a number without its sign, and its interval if there is one."""
    low, high = sorted(math.copysign(1.0, value) * one for one in ends)
    scale = scale_of([abs(value)], unit)
    if not np.isfinite([low, high]).all():
        return scale.quantity(abs(value))
    shown = within(scale.factor * abs(value), scale.factor * low, scale.factor * high)
    return f"{with_unit(shown, scale.unit)} (95 % interval {scale.interval(low, high)})"


def _unit(kind: str, measurement: Measurement) -> str:
    force, position = measurement.unit("force"), measurement.unit("position")
    return {
        "delay": "s",
        "spring": f"{force}/{position}",
        "drift": force,
        "offset_drift": force,
        "viscous_drift": f"{force} s/{position}",
        "saturation": force,
        "backlash": position,
        "loose": position,
        "flexible": "Hz",
        "mass": "kg m^2" if measurement.turning else "kg",
    }[kind]


def _rises(sized: _Sized) -> str:
    return "rises" if sized.value > 0.0 else "falls"


def _late(sized: _Sized) -> str:
    if sized.value > 0.0:
        return (
            f"The recorded force lags the motion by {sized.text}: a delay or filter of the force"
            " sensor, or two unsynchronised clocks"
        )
    return (
        f"The motion lags the recorded force by {sized.text}: a delay of the amplifier or of the"
        " position sensor, or two unsynchronised clocks"
    )


def _saturated(sized: _Sized) -> str:
    where = "is missing from the record: the sensor" if sized.measured else "does not act: the amplifier"
    return f"Of the force beyond {sized.text}, what is recorded {where} saturates"


def _missing_mass(sized: _Sized) -> str:
    more = "larger" if sized.value > 0.0 else "smaller"
    return (
        f"The motion needs a mass {sized.text} {more} than the one given: the mass or the gain of"
        " the force is wrong"
    )


SAID: Final[Mapping[str, Callable[[_Sized], str]]] = {
    "delay": _late,
    "saturation": _saturated,
    "mass": _missing_mass,
    "backlash": lambda s: (
        f"After each reversal, inertia and friction differ over {s.text}: backlash"
    ),
    "loose": lambda s: f"Part of the inertia follows the motion through a gap of {s.text}: backlash",
    "flexible": lambda s: (
        f"Part of the inertia is coupled elastically, with a resonance at {s.text}"
    ),
    "spring": lambda s: f"A force {_rises(s)} with position by {s.text}: the mechanism lacks a spring",
    "drift": lambda s: f"The friction level {_rises(s)} by {s.text} over the record",
    "offset_drift": lambda s: (
        f"A force in addition to friction {_rises(s)} by {s.text} over the record"
    ),
    "viscous_drift": lambda s: (
        f"Viscous friction {_rises(s)} by {s.text} over the record, as in warm-up"
    ),
}
"""Sentences of faults, by kind."""
