"""The frequency of a towed block: of its slips and of the spectrum, which must not contradict."""

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.experiments import CURE, MainsLine, is_narrow, lines_of, words_of
from stickslip.formatting import quantity
from stickslip.kinds.features.slip_detection import cycles_of, peak_of, spectra_of

Array: TypeAlias = NDArray[np.float64]

BLOCKS = 15
"""Half overlapping stretches, of an eighth of the record each, for spectra and the bootstrap."""
STRETCHES = 8
DRAWS = 400
HIGHEST = 5.0
"""Frequencies are sought up to so many times the natural one."""
AGREE = 0.25
"""Logarithm by which the top of a spectrum and the rate of regular slips may differ: irregular
slips with a coefficient of variation of 0.2 reach 0.1."""
WANDERS = 1.5
"""Slower by this logarithm, a spectrum shows how levels wander from slip to slip, not slips."""
CERTAIN = 3.0
"""And by so many standard errors."""
FEWEST = 3
"""Cycles at least."""
BIASED = 0.02
"""Share of the variance from which hum falsifies features: the standard deviation by 1 %."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Frequency:
    """A frequency, and what it is in the draws of a block bootstrap."""

    frequency: float
    """Hz."""
    draws: Array
    """By draw (draws,) [Hz]."""
    chosen: NDArray[np.intp]
    """Stretches of each draw (draws, stretches)."""


def frequency_of(
    force: Array, step: float, *, natural: float, slips: NDArray[np.intp] | None
) -> Frequency:
    """Return the frequency of a force: of its slips if there are any, else of its spectrum.

    Examples
    --------
    >>> saw = np.tile(np.linspace(0.0, 1.0, 100), 40)
    >>> found = frequency_of(saw, 0.01, natural=20.0, slips=np.arange(100, 4000, 100))
    >>> round(found.frequency, 6)
    1.0
    """
    chosen = np.random.default_rng(0).integers(0, STRETCHES, (DRAWS, STRETCHES))
    frequencies, spectra = spectra_of(force, BLOCKS, HIGHEST * natural * step)
    top = peak_of(frequencies, spectra.mean(axis=0)) / step
    # overlapping spectra stand around the stretch they begin with
    tops = [
        peak_of(frequencies, spectra[np.minimum(2 * drawn, BLOCKS - 1)].mean(axis=0))
        for drawn in chosen
    ]
    spectral = Frequency(frequency=top, draws=np.array(tops) / step, chosen=chosen)
    if slips is not None:
        found = _rate(slips, len(force), step, chosen)
        _refuse_contradiction(spectral, found, force, step, len(slips))
        return found
    if _hum(force, step, top):
        raise InputError(
            "the force shows mains hum and no stick-slip: no slips are detected, the power per"
            f" octave is largest at {quantity(top, 'Hz', 4)}, and the line at"
            f" {words_of(_hum(force, step, top))} is narrow. {CURE}. Motion of the block at"
            " exactly this frequency cannot be distinguished from hum: record it at another speed."
        )
    return spectral


def _hum(force: Array, step: float, top: float) -> tuple[MainsLine, ...]:
    """Return the lines of the mains, if one is the top of the spectrum or they falsify features."""
    lines = lines_of(force, step)
    falsify = sum(line.share for line in lines) > BIASED
    return lines if falsify or any(abs(one.frequency / top - 1.0) < 0.01 for one in lines) else ()


def _rate(
    events: NDArray[np.intp], samples: int, step: float, chosen: NDArray[np.intp]
) -> Frequency:
    """Return the rate of events, which a stretch has as many of as begin in it."""
    waits = step * np.diff(events)
    stretch = np.minimum(events[:-1] * STRETCHES // samples, STRETCHES - 1)
    counts = np.bincount(stretch, minlength=STRETCHES)
    times = np.bincount(stretch, weights=waits, minlength=STRETCHES)
    rate = 1.0 / float(waits.mean())
    drawn, spent = counts[chosen].sum(axis=1), times[chosen].sum(axis=1)
    draws = np.where(drawn > 0, drawn / np.where(drawn > 0, spent, 1.0), rate)
    return Frequency(frequency=rate, draws=draws, chosen=chosen)


def _refuse_contradiction(
    spectral: Frequency, slips: Frequency, force: Array, step: float, count: int
) -> None:
    """Refuse a record whose spectrum has its top far from the rate of its slips."""
    top, rate = spectral.frequency, slips.frequency
    apart = math.log(top / rate)
    narrow = apart > AGREE and is_narrow(force, step, top)
    errors = [float(np.log(one.draws).std()) for one in (spectral, slips)]
    least = AGREE if apart > 0.0 else WANDERS
    contradict = narrow or abs(apart) > least + CERTAIN * math.hypot(*errors)
    lines = _hum(force, step, top)
    if not contradict and not lines:
        return
    found = (
        f"{count} slips are {quantity(1.0 / rate, 's')} apart on average, a rate of"
        f" {quantity(rate, 'Hz')}"
    )
    if lines:
        said = f"the force has mains hum at {words_of(lines)}, but {found}"
        cure = f"{CURE}."
    else:
        said = (
            "the spectrum and the slips disagree: the power per octave is largest at"
            f" {quantity(top, 'Hz')}, but {found}"
        )
        cure = f"Find the cause of the force at {quantity(top, 'Hz')}, or remove it with a "
        cure += "notch filter." if apart > 0.0 else "high-pass filter below the slip rate."
    raise InputError(f"{said}: the features would mix two motions. {cure}")


def refuse_without_cycles(force: Array, step: float, top: float) -> None:
    """Refuse a slow force with too few slips to be stick-slip, unless it has smooth cycles.

    `top` is the frequency [Hz] of its spectrum.

    Examples
    --------
    >>> t = np.arange(0.0, 20.0, 0.01)
    >>> refuse_without_cycles(np.sin(2.0 * np.pi * t), 0.01, 1.0)
    """
    cycles = cycles_of(force, 1.0 / (top * step))
    rate = (len(cycles) - 1) / (step * float(np.ptp(cycles))) if len(cycles) > FEWEST else 0.0
    if rate == 0.0 or abs(math.log(top / rate)) > AGREE:
        said = f"but it passes through {len(cycles)} cycles"
        said += f", which are {quantity(rate, 'Hz')}" if rate else " only"
        raise InputError(
            "the force shows no stick-slip: fewer than four slips are detected. Its power per"
            f" octave is largest at {quantity(top, 'Hz')}, {said}. Record for longer or with less"
            " noise."
        )
