"""Inverse dynamics: friction levels by linear least squares from forces and filtered positions."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement, as_recorded, between_gaps, with_voltage
from stickslip.errors import InputError, UnknownNameError
from stickslip.identify.fits.estimation.jackknife import Directions
from stickslip.identify.fits.estimation.parameters import WIDE, FreeParameter
from stickslip.identify.fits.series.applied_force import applied_force
from stickslip.identify.fits.series.applied_force import driven as is_driven
from stickslip.identify.fits.settings import ROUNDING, ROUNDS, SETTLED
from stickslip.identify.fits.signals import GAP, ORDER
from stickslip.identify.fits.validation import LAW, names_of
from stickslip.mechanisms import Mechanism, slip_of
from stickslip.quantities import Quantity
from stickslip.quantities import vary as with_values
from stickslip.show.display import Tabular
from stickslip.show.formatting import estimate, number, percent, quantity

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

HUBER = 1.345
"""Residuals beyond this many standard deviations weigh less; 95 % as efficient as least squares."""
POSITION_SHARE = 10.0
"""The position's filter passes a 10th of the sampling frequency if nothing else is asked for."""
PARALLEL_SHARE = 50.0
"""The filter of all regressors passes a 50th of it, where nothing is decimated."""
HARMONICS = 20.0
"""Both pass at least so many times the mean frequency of the motion, where reversals are seen."""
HIGHEST = 0.2
"""Both stay below this share of the sampling frequency."""
MARGIN = 49
"""Samples dropped at the start, where filters and differences begin."""
LEAST = 30
"""Samples a record must have."""
LITTLE = 0.01
"""Share of a force that is next to nothing of it, and of samples that are few of them."""
MOST = 0.5
"""Share of a force that explains it: where a regression leaves more, its signs accuse no channel,
and a level of less brakes nothing. A force recorded with the wrong sign fits as well as with the
right one."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class InverseDynamics(Tabular):
    """What linear least squares on forces says, with the usual standard deviations.

    They are those of largest likelihood for independent errors, too small for filtered signals.
    """

    names: tuple[str, ...]
    """``"inertia"``, ``"viscous"``, ``"level"``, ``"offset"``; ``"viscous+"`` and so on by
    direction."""
    values: Array
    """Estimates (p,)."""
    deviations: Array
    """Their standard deviations (p,)."""
    relative_error: float
    """Root mean square of the residuals over that of the forces."""
    time: Array
    """Times (n,) [s] of the rows."""
    velocity: Array
    """Filtered velocities (n,) [m/s]."""
    friction: Array
    """Force less inertia and springs (n,) [N]: friction and offset."""
    residual: Array
    """Forces less those of the regression (n,) [N]."""
    table: Array
    """Columns of the regression (n, p)."""
    weights: Array
    """Weights of the rows (n,), 1 where regression is not robust."""

    def to_dataframe(self) -> "pd.DataFrame":
        """Return time, velocity, friction and residual as a pandas DataFrame, a row a sample."""
        import pandas as pd

        names = ("time", "velocity", "friction", "residual")
        return pd.DataFrame({name: getattr(self, name) for name in names})

    def _over(self) -> str:
        return "time"

    def _column_units(self) -> Mapping[str, str]:
        return {"time": "s"}

    def __getitem__(self, name: str) -> float:
        """Return an estimate by name."""
        if name not in self.names:
            raise UnknownNameError("estimate", name, self.names)
        return float(self.values[self.names.index(name)])

    def __repr__(self) -> str:
        found = zip(self.names, self.values, self.deviations, strict=True)
        estimates = ", ".join(f"{name} = {estimate(value, sd)}" for name, value, sd in found)
        return (
            f"<InverseDynamics: {estimates} [SI, standard deviations]; {len(self.time)} samples,"
            f" residual {percent(self.relative_error)} of the force>"
        )

    @property
    def inertial_share(self) -> float:
        """Standard deviation of the inertial force over the median friction, with its sign.

        0 where the inertia was not looked for.
        """
        if "inertia" not in self.names:
            return 0.0
        accelerations = self.table[:, self.names.index("inertia")]
        size = float(np.median(np.abs(self.friction)))
        return self["inertia"] * float(np.std(accelerations)) / size if size > 0.0 else 0.0


def inverse_dynamics(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] = ("mechanism.inertia",),
    directional: bool = False,
    offset: bool | None = None,
    cutoff: float | None = None,
    decimate: int = 1,
    robust: bool = False,
) -> InverseDynamics:
    """Fit inertia, viscous part, level and offset to a record of position and force.

    The position, and then all regressors alike, are filtered forward and backward, so that nothing
    is delayed; velocity and acceleration are central differences. Nothing is filtered across a gap:
    what lies on either side is taken as two records, and left out if it has fewer than 30 samples.

    Source: M. Gautier, "Dynamic identification of robots with power model", 1997; filtered as in
    A. Janot et al., EMPS, 2019.

    Parameters
    ----------
    mechanism : Mechanism
        An `Axis` or `SpringBlock`: one coordinate.
    measurement : Measurement
        Records in time with position, and the force applied if there is one.
    vary : str or sequence of str
        The mass, as ``"mechanism.inertia"``, ``"mechanism.mass"`` or by last name; empty to hold
        it. Friction is always fitted, so that ``"friction.*"`` adds nothing.
    directional : bool
        Whether each direction has its own viscous part and level.
    offset : bool, optional
        Whether a constant force is looked for; if not given, unless each direction has its level,
        from half the difference of which it cannot be told.
    cutoff : float, optional
        Of the position's filter [Hz]; a 10th of the sampling frequency if not given.
    decimate : int
        Every how manieth row is kept, after a filter that forbids aliases; 1 keeps all rows, and
        filters them at a 50th of the sampling frequency.
    robust : bool
        Whether large residuals weigh less (Huber).

    Returns
    -------
    InverseDynamics
        Estimates and what they leave.

    Raises
    ------
    InputError
        If there is no position in time or too little of it.
    """
    offset = not directional if offset is None else offset
    names = [name for name in names_of(vary) if name != LAW]
    check_is_mass(names)
    inertia = bool(names)
    parts = []
    for given in measurement.records():
        record = with_voltage(mechanism, given, "zero")
        set_up = as_recorded(mechanism, record)
        for piece in _pieces(record):
            parts.append(_columns(set_up, piece, cutoff, decimate, directional=directional))
    whole = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    rest, inertial = whole["forces"], whole["mass"] * whole["inertia"]
    names = [name for name in whole if name.startswith(("viscous", "level"))]
    names = [*(("inertia",) if inertia else ()), *names, *(("offset",) if offset else ())]
    table = np.column_stack([whole[name] for name in names])
    wanted = rest if inertia else rest - inertial
    values, weights = _solved(table, wanted, robust=robust)
    residual = wanted - table @ values
    return InverseDynamics(
        names=tuple(names),
        values=values,
        deviations=_deviations(table, residual, weights),
        relative_error=float(np.linalg.norm(residual)) / max(float(np.linalg.norm(wanted)), 1e-300),
        time=whole["time"],
        velocity=whole["velocity"],
        friction=wanted - values[0] * whole["inertia"] if inertia else wanted,
        residual=residual,
        table=table,
        weights=weights,
    )


def check_is_mass(names: Iterable[str]) -> None:
    """Refuse parameters of a mechanism other than its mass, which is all that is identified."""
    for name in names:
        if name.rpartition(".")[2] not in ("inertia", "mass"):
            raise InputError(f"inverse dynamics identifies the mass of a mechanism, not {name!r}.")


def is_mass(mechanism: Mechanism, path: str) -> bool:
    """Whether a parameter of a mechanism is its mass as it moves, and nothing else.

    Examples
    --------
    >>> from stickslip import Axis, Pendulum
    >>> is_mass(Axis(inertia=2.0), "mechanism.inertia")
    True
    >>> is_mass(Pendulum(mass=2.0, length=0.5), "mechanism.mass")
    False
    """
    if path not in ("mechanism.inertia", "mechanism.mass"):
        return False
    mass = mass_of(mechanism)
    return bool(abs(mass - getattr(mechanism, path.rpartition(".")[2])) <= ROUNDING * mass)


def times_of(record: Measurement) -> Array:
    """Return the times (n,) of a record [s]."""
    if not isinstance(record.time, np.ndarray):
        raise InputError("inverse dynamics needs the motion in time.")
    return record.time


def _pieces(record: Measurement) -> list[Measurement]:
    """Return what lies between the gaps of a record and is long enough to be filtered."""
    times_of(record)
    pieces = between_gaps(record)
    sizes = [np.asarray(piece.time).size for piece in pieces]
    found = [piece for piece, size in zip(pieces, sizes, strict=True) if size >= LEAST]
    if not found:
        raise InputError(
            f"inverse dynamics, which gives the start values, needs a stretch of at least {LEAST}"
            f" samples without a gap, and the longest has {max(sizes, default=1)}: record longer,"
            " or resample at even times."
        )
    return found


def _columns(
    mechanism: Mechanism,
    record: Measurement,
    cutoff: float | None,
    decimate: int,
    *,
    directional: bool,
) -> dict[str, Array]:
    """Return the columns of the regression for one record, by name."""
    time, x, v, a, applied = _signals(mechanism, record, cutoff)
    mass, forces = known_forces(mechanism, x, v, applied)
    columns = {"forces": forces, "inertia": a, "velocity": v}
    for name, column in (("viscous", v), ("level", np.sign(v))):
        if directional:
            columns[name + "+"] = np.where(v > 0.0, column, 0.0)
            columns[name + "-"] = np.where(v < 0.0, column, 0.0)
        else:
            columns[name] = column
    columns["offset"] = np.ones_like(v)
    passed = _share(x, 1.0 / PARALLEL_SHARE)
    found = {name: _decimated(column, decimate, passed) for name, column in columns.items()}
    found["mass"] = np.full_like(found["forces"], mass)
    found["time"] = time[(len(time) - 1) % decimate :: decimate]
    return found


def _signals(mechanism: Mechanism, record: Measurement, cutoff: float | None) -> tuple[Array, ...]:
    """Return times, positions, velocities, accelerations and forces of one record, filtered."""
    from scipy import signal

    assert isinstance(record.time, np.ndarray)
    dt = check_even(record.time)
    x = positions_of(record)
    share = _share(x, 1.0 / POSITION_SHARE) if cutoff is None else min(2.0 * cutoff * dt, 0.99)
    smooth = _both_ways(signal.butter(ORDER, share), x)
    v = np.gradient(smooth, dt)
    applied = applied_force(mechanism, record)
    force = 0.0 * x if applied is None else applied
    found = (record.time, smooth, v, np.gradient(v, dt), force)
    dropped = min(MARGIN, len(x) // 20)
    return tuple(column[dropped:] for column in found)


def check_even(time: Array) -> float:
    """Return the mean step of times (n,) [s]."""
    dt = float(np.ptp(time)) / (len(time) - 1)
    longest = float(np.diff(time).max())
    if longest > GAP * dt:
        raise InputError(
            "inverse dynamics, which gives the start values, needs evenly spaced times: the mean"
            f" step is {quantity(dt, 's')} and the longest {quantity(longest, 's')}. Resample the"
            " record."
        )
    return dt


def positions_of(record: Measurement) -> Array:
    """Return positions (n,) [m] as measured, or from the velocity."""
    if "position" in record.quantities():
        return np.asarray(record.values("position"))
    if "velocity" not in record.quantities():
        raise InputError("inverse dynamics needs the position or the velocity in time.")
    v, t = np.asarray(record.values("velocity")), np.asarray(record.time)
    steps = 0.5 * (v[1:] + v[:-1]) * np.diff(t)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _share(x: Array, least: float) -> float:
    """Return what a filter passes, over half the sampling frequency.

    The mean frequency of a motion is that of the sine with the same mean squares of position,
    seen from its mean, and of steps.
    """
    spread, step = float(np.std(x)), float(np.std(np.diff(x)))
    mean = step / max(2.0 * np.pi * spread, 1e-300)
    return 2.0 * min(max(least, HARMONICS * mean), max(HIGHEST, least))


def _decimated(column: Array, every: int, share: float) -> Array:
    """Return every so manieth value of a filtered column; the last one is kept."""
    from scipy import signal

    if every == 1:
        return _both_ways(signal.butter(ORDER, share), column)
    smooth = _both_ways(signal.cheby1(8, 0.05, 0.8 / every), column)
    return smooth[(len(smooth) - 1) % every :: every]


def _both_ways(coefficients: tuple[Array, Array], column: Array) -> Array:
    from scipy import signal

    b, a = coefficients
    smooth: Array = signal.filtfilt(b, a, column, padlen=3 * (max(len(a), len(b)) - 1))
    return smooth


def known_forces(mechanism: Mechanism, x: Array, v: Array, applied: Array) -> tuple[float, Array]:
    """Return the mass [kg], and the forces (n,) [N] on it but for friction and a constant."""
    if len(mechanism.coordinates) != 1:
        raise InputError(
            f"inverse dynamics needs a mechanism of one coordinate, and"
            f" {type(mechanism).__name__} has {len(mechanism.coordinates)}: give position and"
            f" force of each of {', '.join(mechanism.coordinates)} by its name, zeros where nothing"
            " drives it."
        )
    if "offset" in mechanism.__dataclass_fields__:
        mechanism = with_values(mechanism, "mechanism", {"mechanism.offset": 0.0})
    (name,) = mechanism.coordinates
    q: Mapping[str, Any] = defaultdict(float, {name: x})
    q_dot: Mapping[str, Any] = defaultdict(float, {name: v})
    h = 1e-6 * max(float(np.ptp(x)), 1e-9)
    ahead, back = (
        mechanism.potential_energy(0.0, defaultdict(float, {**q, name: x + side * h})) + 0.0 * x
        for side in (1.0, -1.0)
    )
    forces = mechanism.forces(0.0, q, q_dot, {"drive": applied})[name]
    return mass_of(mechanism), np.asarray(forces - (ahead - back) / (2.0 * h) + 0.0 * x)


def mass_of(mechanism: Mechanism) -> float:
    """Return what moves as the coordinate that slips does, all else being at rest in it [kg]."""
    name = slip_of(mechanism)
    one = mechanism.kinetic_energy(defaultdict(float), defaultdict(float, {name: 1.0}))
    return 2.0 * float(one)


def _solved(table: Array, wanted: Array, *, robust: bool) -> tuple[Array, Array]:
    """Return least-squares values, and the weights of rows where large residuals weigh less."""
    weights = np.ones(len(wanted))
    values = np.asarray(np.linalg.lstsq(table, wanted, rcond=None)[0], dtype=float)
    size = np.linalg.norm(table, axis=0)
    scaled = table / np.where(size > 0.0, size, 1.0)
    for _ in range(ROUNDS if robust else 0):
        residual = wanted - table @ values
        deviation = 1.4826 * float(np.median(np.abs(residual))) or 1.0
        weights = np.minimum(1.0, HUBER * deviation / np.maximum(np.abs(residual), 1e-300))
        # normal equations: a tenth of the time, and start values need no more digits
        weighted = scaled.T * weights
        before, scaled_values = values, _least(weighted @ scaled, weighted @ wanted)
        values = scaled_values / np.where(size > 0.0, size, 1.0)
        if np.max(np.abs(values - before) * size) <= SETTLED * np.max(np.abs(values) * size):
            break
    return np.asarray(values, dtype=float), weights


def _least(square: Array, wanted: Array) -> Array:
    """Return the least of the solutions (p,) of normal equations, which may be singular."""
    return np.asarray(np.linalg.lstsq(square, wanted, rcond=1e-12)[0], dtype=float)


def _deviations(table: Array, residual: Array, weights: Array) -> Array:
    root = np.sqrt(weights)[:, None]
    variance = float((weights * residual) @ residual) / len(residual)
    known = Directions.of(root * table)
    deviations: Array = np.sqrt(variance * np.sum(known.inverse**2, axis=1))
    deviations[[bool(why) for why in known.reasons(np.eye(len(known.size)))]] = np.inf
    return deviations


def regressed(
    mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str] = ()
) -> InverseDynamics:
    """Return the regression of forces, with the mass if that is looked for.

    A force against the motion that it should cause is refused.
    """
    free = ["inertia"] if any(path.endswith(("inertia", "mass")) for path in unknown) else []
    found = inverse_dynamics(mechanism, measurement, vary=free, robust=True)
    check_signs(found, driven=is_driven(measurement))
    return found


def check_signs(found: InverseDynamics, *, driven: bool) -> None:
    """Refuse a force that acts against the motion it should cause."""
    if _says_little(found) and not (found["level"] < 0.0 and found["viscous"] < 0.0):
        return
    said = ", ".join(f"{n} {number(v)}" for n, v in zip(found.names, found.values, strict=True))
    if not driven:
        raise InputError(
            "no drive was given, and friction alone cannot cause this motion: linear regression"
            f" gives {said}. Give the force if there was one; only a free decay needs none."
        )
    if found.relative_error > MOST:
        raise InputError(
            f"inertia and sliding friction leave {100.0 * found.relative_error:.0f} % of the force:"
            f" linear regression gives {said}, which therefore says nothing. Friction may hold the"
            " body for most of the record, so that it moves by deflection only, or another force"
            " acts. Record moves in which the body slides; check the meaning of each column."
        )
    raise InputError(
        f"the force acts against the motion that it should cause: linear regression gives {said}."
        " Check its sign (gain -1) and the meaning of each column."
    )


def _says_little(found: InverseDynamics) -> bool:
    """Whether an inertia that came out negative says nothing of the sign of the force.

    The motion was slow, and it takes a small share of the force; or slip in both directions has a
    level that brakes: a force that bends bristles goes with the acceleration too. In one direction
    a level is not told from a weight.
    """
    if found.inertial_share > -LITTLE:
        return True
    ahead = float(np.mean(found.velocity > 0.0))
    if not LITTLE < ahead < 1.0 - LITTLE or found.relative_error > MOST:
        return False
    level = min(found[name] for name in found.names if name.startswith("level"))
    return level > MOST * float(np.std(found.friction))


def mechanism_unknown(path: str, quantity: Quantity, start: float, level: float) -> FreeParameter:
    """Return an unknown of a mechanism under friction of a level [N], with wide bounds."""
    log = quantity.above is not None
    most = WIDE * (level + abs(start))
    return FreeParameter(
        path=path,
        quantity=quantity,
        start=start,
        low=start / WIDE if log else max(quantity.low, -most),
        high=WIDE * start if log else min(quantity.high, most),
        log=log,
    )
