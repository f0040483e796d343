"""Peaks in the spectrum of residuals: vibrations of the rig, and ripples of the recorded force."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import scipy
from numpy.typing import NDArray

from stickslip.experiments import step_of
from stickslip.formatting import quantity
from stickslip.identification.estimation.model_error import UNSAID, ModelError
from stickslip.identification.estimation.parameters import FreeParameters
from stickslip.identification.force_map.data import MotionSegment
from stickslip.identification.force_map.force_balance import (
    balanced,
    mean_force,
    second_differences,
)
from stickslip.identification.force_map.model import ForceMap
from stickslip.identification.residuals.balance import Fitted
from stickslip.identification.series.applied_force import applied_force
from stickslip.identification.series.inverse_dynamics import known_forces, mass_of, positions_of

Array = NDArray[np.float64]

SPECTRA = 8
"""Parts of a record over which spectra are averaged, which overlap by half."""
PEAK = 6.0
"""Power of the residuals at a frequency over the median near it: by chance, less than 4."""
NEAR = 15
"""Frequencies on either side that this median is taken over."""
OWN = 0.3
"""Power of force or inertia over that of the other at a peak below which it has no part in it."""
RIPPLE = (
    "The recorded force has a spectral peak at {} (root mean square {}) that the motion lacks:"
    " ripple of the amplifier or sensor, possibly aliased from a higher frequency."
)
VIBRATION = (
    "The motion vibrates at {} (inertial force {} root mean square) without such a component in"
    " the recorded force: a flexible coupling or mount, or a disturbance."
)


def peaks_of(fit: Fitted, least: float) -> Iterator[ModelError]:
    """Yield what stands out of the spectrum of the unfiltered residuals, at any frequency.

    A vibration is in the motion and not in the force, a ripple of the recorded force is not in the
    motion; what is in both is how the rig was driven.
    """
    stretches = balanced(
        fit.mechanism, fit.measurement, hold=fit.hold, samples=math.inf, slipping=True
    )
    longest = max(stretches, key=lambda one: len(one.path.time))
    rate = 1.0 / float(np.mean(np.diff(longest.path.time)))
    length = 2 ** int(math.log2(2.0 * len(longest.path.time) / (SPECTRA + 1.0)))
    if length < 4 * NEAR:
        return
    signals = _unfiltered(fit, longest)
    if not np.isfinite(signals[0]).all():  # bristles were not found along the measured motion
        return
    at, *powers = _spectra(rate, length, signals)
    floors = [scipy.ndimage.median_filter(one, size=2 * NEAR + 1, mode="nearest") for one in powers]
    ratio = powers[0] / np.maximum(floors[0], 1e-300)
    peak = NEAR // 2 + int(np.argmax(ratio[NEAR // 2 : len(at) - NEAR // 2]))
    near = slice(peak - 1, peak + 2)
    residual, pushed, moved = (
        float(np.sum(np.maximum(one - floor, 0.0)[near]))
        for one, floor in zip(powers, floors, strict=True)
    )
    where, step = float(at[peak]), float(at[1])
    size = math.sqrt(residual * step)
    if ratio[peak] < PEAK or size < least:
        return
    swing = size / (mass_of(fit.mechanism) * (2.0 * math.pi * where) ** 2)
    ripple = moved < OWN * pushed < residual < pushed / OWN
    vibration = pushed < OWN * moved < residual < moved / OWN
    if ripple or (vibration and swing > _resolved(fit, longest)):
        sized = quantity(where, "Hz"), quantity(size, fit.measurement.unit("force"))
        yield ModelError(
            kind="ripple" if ripple else "vibration",
            finding=(RIPPLE if ripple else VIBRATION).format(*sized),
            consequence=UNSAID,
            effect=where,
            interval=(where - step, where + step),
            share=residual / float(np.sum(powers[0])),
        )


def _resolved(fit: Fitted, one: MotionSegment) -> float:
    """Return the step of the readings of a position: what toggles between two is no vibration."""
    return step_of(positions_of(fit.measurement.records()[one.record]))


def _spectra(rate: float, length: int, signals: Sequence[Array]) -> tuple[Array, ...]:
    """Return frequencies [Hz] and power densities of signals, each averaged over parts."""
    found = [scipy.signal.welch(one, rate, nperseg=length, detrend="linear") for one in signals]
    return (found[0][0], *(power for _, power in found))


def _unfiltered(fit: Fitted, one: MotionSegment) -> tuple[Array, Array, Array]:
    """Return what both leave of friction, known forces and inertia (n,) [N], none filtered."""
    mechanism, measurement = fit.mechanism, fit.measurement
    record = measurement.records()[one.record]
    time = np.asarray(record.time)
    first = int(np.searchsorted(time, one.path.time[0]))
    rows = slice(first, first + len(one.path.time))
    x, applied = positions_of(record)[rows], applied_force(mechanism, record)
    joined = fit.hold == "first" or "force" not in record.quantities()
    force = np.zeros(len(time)) if applied is None else mean_force(applied, joined=joined)
    mass, rest = known_forces(mechanism, x, one.path.velocity, force[rows])
    problem = ForceMap(
        law=fit.law,
        free_parameters_=FreeParameters(()),
        stretches=(replace(one, passed=0.0, segment=np.zeros(len(x), dtype=np.intp)),),
        offset=float(getattr(mechanism, "offset", 0.0)),
    )
    inertial = mass * second_differences(x, float(np.mean(np.diff(one.path.time))))
    return rest - inertial - problem.predicted(np.zeros(0)), rest, inertial
