r"""Travels and mean velocities of a body that carries its drive, also read off films of it.

A film has positions :math:`x_i` at times :math:`t_i`, counted from where the drive begins. Over a
cycle of length :math:`T` the body moves to and fro by more than it gains, so a travel is read where
a cycle ends, :math:`\tau = N T`, from a regression on the frames about there,

.. math:: x(t) = a + b\,s + \sum_{k \le K} c_k \cos(k \omega s) + d_k \sin(k \omega s),
   \quad s = t - \tau ,

with as many harmonics as the frames resolve: :math:`x(\tau) = a + \sum c_k`. Its standard error is
that of the regression, with the noise of the frames before anything moves, and that of the start,
which is known to a frame: :math:`\dot x(\tau)\,\Delta t / \sqrt{12}`.

The frequency with which a film oscillates is that whose first three harmonics leave least of it.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stickslip.data.measurement import QUANTITIES, Measurement
from stickslip.data.tolerances import HALF, NEARLY_ALL
from stickslip.errors import InputError
from stickslip.mechanisms import PREFIX, WHOLE, Mechanism, cycle_of
from stickslip.quantities import vary
from stickslip.show.formatting import number, quantity

# What a mean velocity or a travel per cycle has to be multiplied by to be a travel.


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
    >>> from stickslip.mechanisms.drives import Square
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
    >>> from stickslip.mechanisms.drives import Sine
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


Array = NDArray[np.float64]

CYCLES = 4
"""Cycles before the end of a travel from whose frames it is read."""
HARMONICS = 6
"""Harmonics of the drive in these at most: stick and slip in a cycle have many."""
LATE = 0.125
"""Part of a cycle after the start of the drive in which a film may begin, beside a frame."""
DEGREE = 6
"""Degree of the polynomial about which a film oscillates: how it gains way, and lost frames."""
BINS = 4
"""Frequencies that are tried in the width of a line of the film, one over its length."""


def is_filmed(measurement: Measurement) -> bool:
    """Return whether all that is known of each run is its position in time.

    Examples
    --------
    >>> (
    ...     is_filmed(Measurement(time=[0.0, 0.1], position=[0.0, 1.0])),
    ...     is_filmed(Measurement(travel=1.0)),
    ... )
    (True, False)
    """
    return all(record.quantities() == ("position",) for record in measurement.records())


def oscillation(time: Array, position: Array, frequency: float, harmonics: int = 3) -> float:
    """Return the share of a film's motion about a smooth curve that a frequency explains.

    Examples
    --------
    >>> t = np.arange(200) / 60.0
    >>> x = 0.02 * t + 0.001 * np.sin(2 * np.pi * 7.0 * t)
    >>> round(oscillation(t, x, 7.0), 3), oscillation(t, x, 5.0) < 0.05
    (1.0, True)
    """
    s = (time - time[0]) / np.ptp(time)
    line = np.polynomial.legendre.legvander(2.0 * s - 1.0, DEGREE)
    left = position - line @ np.linalg.lstsq(line, position, rcond=None)[0]
    most = max(int(0.5 / (frequency * float(np.median(np.diff(time))))), 1)
    phases = 2.0 * np.pi * frequency * np.outer(time, np.arange(1, min(harmonics, most) + 1))
    table = np.hstack([line, np.cos(phases), np.sin(phases)])
    rest = position - table @ np.linalg.lstsq(table, position, rcond=1e-9)[0]
    return 1.0 - float(rest @ rest) / max(float(left @ left), 1e-300)


def frequency_of(time: Array, position: Array) -> tuple[float, float]:
    """Return the frequency with which a film oscillates [Hz], and the share that it explains.

    Examples
    --------
    >>> t = np.arange(240) / 60.0
    >>> frequency, share = frequency_of(t, 0.02 * t + 0.001 * np.sin(2 * np.pi * 7.1 * t) ** 3)
    >>> round(frequency, 2), share > 0.99
    (7.1, True)
    """
    span, step = float(np.ptp(time)), float(np.median(np.diff(time)))
    tried = np.arange(2.0 / span, 0.45 / step, 1.0 / (BINS * span))
    if not len(tried):
        return math.nan, 0.0
    shares = np.array([oscillation(time, position, f) for f in tried])
    at = int(np.flatnonzero(shares >= NEARLY_ALL * shares.max())[-1])
    at = max(range(max(at - BINS, 0), min(at + BINS, len(tried))), key=lambda i: float(shares[i]))
    fine = np.linspace(tried[at] - 1.0 / (BINS * span), tried[at] + 1.0 / (BINS * span), 17)
    near = [oscillation(time, position, f) for f in fine]
    return float(fine[int(np.argmax(near))]), float(max(near))


def other_drives(mechanism: Mechanism, measurement: Measurement) -> Iterator[str]:
    """Yield a sentence for each film that oscillates with another frequency than its drive.

    A motion that repeats itself after up to four cycles is that of its drive: the frequency of the
    film then goes into that of the drive, as far as frequencies are tried.
    """
    for index, record in enumerate(measurement.records(), 1):
        time, x = np.asarray(record.time), np.asarray(record.values("position"))
        drive = 1.0 / cycle_of(vary(mechanism, PREFIX, record.overrides))
        best, share = frequency_of(time, x)
        own = oscillation(time, x, 0.5 * drive, 2 * HARMONICS)
        cycles = max(1.0, float(np.rint(drive / best)))
        near = abs(best - drive / cycles) * float(np.ptp(time)) < 1.0 / BINS
        repeats = near and 1.0 < cycles <= CYCLES
        if share > HALF and own < HALF * share and not repeats:
            yield (
                f"{record.name or f'film {index}'} oscillates with {number(best, 3)} Hz, and its"
                f" drive has {number(drive, 3)} Hz: one of the two is not of this run."
            )


def travels_of_films(
    mechanism: Mechanism, measurement: Measurement, t_end: float | None = None
) -> tuple[Measurement, float]:
    """Return the travel per cycle of each film, and the time up to which they are read [s].

    Parameters
    ----------
    mechanism : Mechanism
        What was filmed, with drives that repeat themselves from time 0 on; records may override
        its parameters.
    measurement : Measurement
        Records of the position, from rest.
    t_end : float, optional
        Last time that is used [s], at most the end of the shortest film.

    Returns
    -------
    measurement : Measurement
        Travels per cycle, with standard uncertainties.
    t_end : float
        The time, for `fit` and `select`.

    Raises
    ------
    InputError
        If a film has no whole cycle, begins late, or oscillates with another frequency than its
        drive.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb, simulate
    >>> from stickslip.mechanisms.drives import Square
    >>> from stickslip.mechanisms import Torque
    >>> wave = Torque(drive=Square(high=6.0, low=-1.0, period=0.4, duty=0.3))
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, stiffness=80.0, damping=0.8, drive=wave)
    >>> run = simulate(capsule, Coulomb(kinetic_coefficient=0.2), t_end=4.0)
    >>> time = np.arange(0.0, 4.0, 1 / 60)
    >>> film = Measurement(time=time, position=run.at(time)["x"])
    >>> read, t_end = travels_of_films(capsule, film)
    >>> true = run.at([3.6])["x"][0] / 9
    >>> bool(abs(read.travel_per_cycle - true) < 3.0 * read.uncertainty["travel_per_cycle"])
    True
    """
    records = measurement.records()
    if not is_filmed(measurement):
        raise InputError("travels are read off films, which have positions in time and no more.")
    t_end = math.inf if t_end is None else t_end
    t_end = min(t_end, *(float(np.asarray(record.time)[-1]) for record in records))
    if said := list(other_drives(mechanism, measurement)):
        raise InputError(" ".join(said))
    result = [_read(mechanism, record, t_end, i) for i, record in enumerate(records, 1)]
    if len(result) == 1:
        doubts = {**measurement.parameter_uncertainties, **result[0].parameter_uncertainties}
        return replace(result[0], parameter_uncertainties=doubts), t_end
    return replace(measurement, trials=tuple(result)), t_end


def settled_speed(mechanism: Mechanism, film: Measurement) -> tuple[float, float]:
    """Return the mean velocity in the second half of a film, and its standard error [m/s].

    Parameters
    ----------
    mechanism : Mechanism
        What was filmed, with drives that repeat themselves; the film may override its parameters.
    film : Measurement
        One record of the position.

    Returns
    -------
    tuple of float
        Velocity and its standard error [m/s].

    Raises
    ------
    InputError
        If half of the film is no whole cycle, or has too few frames.

    Examples
    --------
    >>> from stickslip import Capsule
    >>> from stickslip.mechanisms.drives import Sine
    >>> from stickslip.mechanisms import Torque
    >>> drive = Torque(drive=Sine(amplitude=0.2, frequency=5.0))
    >>> capsule = Capsule(capsule_mass=0.08, inner_mass=0.02, drive=drive)
    >>> time = np.arange(0.0, 2.0, 1 / 60)
    >>> film = Measurement(time=time, position=0.03 * time + 0.001 * np.sin(10 * np.pi * time))
    >>> speed, error = settled_speed(capsule, film)
    >>> round(speed, 6), error < 1e-9
    (0.03, True)
    """
    rig = vary(mechanism, PREFIX, film.overrides)
    count = whole_cycles(rig, float(np.asarray(film.time)[-1]))
    if count < 2:
        raise InputError(f"{film.name or 'the film'} has no two cycles of its drive.")
    period = cycle_of(rig)
    seen = _Harmonics.of(film, period, count * period, count // 2, 0.0, film.name or "the film")
    return float(seen.values[1]), seen.noise * math.sqrt(float(seen.covariance[1, 1]))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Harmonics:
    """A straight line and harmonics of the drive, fitted to frames about the end of a cycle."""

    values: Array
    """Place and velocity at the end of the cycle, cosines, sines (2 + 2 K,)."""
    covariance: Array
    """Of these, for frames of noise 1."""
    noise: float
    """Standard deviation of the frames [m]."""
    harmonics: int
    step: float
    """Time from frame to frame [s]."""

    @classmethod
    def of(
        cls,
        film: Measurement,
        period: float,
        end: float,
        before: int,
        after: float,
        name: str,
    ) -> "_Harmonics":
        """Fit them to frames of some cycles before the end, and a part of one after it."""
        time, x = np.asarray(film.time, dtype=float), _position(film)
        step = float(np.median(np.diff(time)))
        near = (time > end - before * period) & (time < end + after * period)
        s = time[near] - end
        harmonics = min(HARMONICS, int(0.45 * period / step), (len(s) - 4) // 4)
        if harmonics < 1:
            raise InputError(
                f"{name} has {number(period / step, 2)} frames in a cycle of its drive: film at"
                " three times its frequency at least."
            )
        phases = 2.0 * np.pi / period * np.outer(s, np.arange(1, harmonics + 1))
        table = np.hstack([np.ones((len(s), 1)), s[:, None], np.cos(phases), np.sin(phases)])
        values, *_ = np.linalg.lstsq(table, x[near], rcond=1e-9)
        left = x[near] - table @ values
        return cls(
            values=values,
            covariance=np.linalg.pinv(table.T @ table, hermitian=True),
            noise=math.sqrt(float(left @ left) / max(len(s) - table.shape[1], 1)),
            harmonics=harmonics,
            step=step,
        )


def _position(film: Measurement) -> Array:
    """Return positions (n,) [m]; those in a plane count one way, whichever way each film goes."""
    x = np.asarray(film.values("position"), dtype=float)
    return -x if film.line is not None and film.line.reversed else x


def _read(mechanism: Mechanism, record: Measurement, t_end: float, index: int) -> Measurement:
    """Return a film as a travel per cycle."""
    name = record.name or f"film {index}"
    rig = vary(mechanism, PREFIX, record.overrides)
    period, time, x = cycle_of(rig), np.asarray(record.time, dtype=float), _position(record)
    count = whole_cycles(rig, t_end)
    seen = _Harmonics.of(record, period, count * period, min(CYCLES, count), 0.5, name)
    if time[0] > LATE * period + seen.step:
        raise InputError(
            f"{name} begins {quantity(float(time[0]), 's')} after its drive: a travel is counted"
            " from rest. Films have to show the start of the drive, which is time 0."
        )
    k = seen.harmonics
    ends = np.concatenate([[1.0, 0.0], np.ones(k), np.zeros(k)])
    before = time <= max(0.5 * seen.step, float(time[0]))  # then the drive may move it
    omega = 2.0 * np.pi / period * np.arange(1, k + 1)
    speed = float(seen.values[1] + omega @ seen.values[2 + k :])
    own = float(ends @ seen.covariance @ ends) + 1.0 / np.count_nonzero(before)
    error = math.sqrt(seen.noise**2 * own + (speed * seen.step) ** 2 / 12.0)
    return Measurement(
        travel_per_cycle=(float(ends @ seen.values) - float(np.mean(x[before]))) / count,
        uncertainty={"travel_per_cycle": error / count},
        overrides=record.overrides,
        parameter_uncertainties=record.parameter_uncertainties,
        conditions=record.conditions,
        initial=record.initial,
        name=record.name,
        provenance=record.provenance,
    )
