"""Energy of a run: what drives put in, and what friction, dampers and stops take.

With kinetic and potential energy E of the states,

    E(t) - E(t_0) = W_drive - W_friction - W_dampers - W_stops

1. Power is integrated in each step of the run, between events and pieces of the drives, by Gauss's
   rule with 12 nodes, of degree 23.
2. A drive's force in a coordinate is the generalised force with the drives less that without; of a
   prescribed motion, it is the effort of the guide. Moved supports count as drives: their power is
   dV/dt at rest of all coordinates. All forces of a mechanism with a controller in its equations
   are those of its loop.
3. What other forces do against the motion is taken by dampers, those of soft stops included.
4. An impact takes what the energy falls by at that instant.

E is taken from states alone, so that the mismatch of both sides is evidence.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, UnknownNameError
from stickslip.maths import Scalar
from stickslip.mechanisms import DCMotor, MatrixMechanism, Mechanism, slip_among
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import Parametrised
from stickslip.show.display import OnAxes, Summary, Tabular
from stickslip.show.formatting import number, quantity

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["EnergyBalance", "energy_balance"]

Array = NDArray[np.float64]

PER_TRAVEL = "energy per travel"
"""Column of the positive work of the drives over the travel."""
GROUND = "ground"
"""Drive that moves the ground and not the mechanism."""
BATCH = 10_000
"""Steps whose roots are sought at once: 2.5 kB each."""
_LEGENDRE = np.polynomial.legendre
_NODES, _WEIGHTS = _LEGENDRE.leggauss(12)  # long steps of exact modes need so many
# Of Legendre series of as many terms: coefficients from values at the nodes, the integral, and the
# companion matrix but for its last column, in which a series stands over its last coefficient.
_SERIES = np.linalg.inv(_LEGENDRE.legvander(_NODES, len(_NODES) - 1))
_INTEGRAL = _LEGENDRE.legint(np.eye(len(_NODES)))
_COMPANION = _LEGENDRE.legcompanion([0.0] * (len(_NODES) - 1) + [1.0])
_SHARES = -(_LEGENDRE.legcompanion([1.0] * len(_NODES)) - _COMPANION)[:, -1]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class EnergyBalance(OnAxes, Tabular):
    """Energy and works of a run since its first time (n,) [J]."""

    t: Array
    """Times [s]."""
    energy: Array
    """Kinetic and potential energy."""
    drive: Array
    """Work of drives and moved supports."""
    positive: Array
    """The same without what comes back: where the power is positive."""
    friction: Mapping[str, Array]
    """Work taken by friction, by contact."""
    dampers: Array
    """Work taken by dampers and other forces that no drive exerts."""
    stops: Array
    """Energy lost in impacts at hard stops."""
    travel: float
    """Last place less the first along the slip [m] or [rad]; NaN where several coordinates slip."""
    unit: str
    """Its unit."""

    @property
    def mismatch(self) -> float:
        """Largest mismatch of the balance over the largest energy or work."""
        taken = self.dampers + self.stops + sum(self.friction.values(), np.zeros_like(self.t))
        off = self.energy - self.energy[0] - self.drive + taken
        parts = (self.energy, self.drive, self.positive, self.dampers, taken)
        size = max(float(np.abs(part).max()) for part in parts)
        return float(np.abs(off).max()) / size if size > 0.0 else 0.0

    @property
    def per_travel(self) -> float:
        """Positive work of the drives over the travel, either way [J/m]; infinite without one."""
        return float(self.positive[-1] / abs(self.travel)) if self.travel else np.inf

    @property
    def works(self) -> dict[str, float]:
        """Works over the run by name [J]."""
        return {name: float(work[-1]) + 0.0 for name, work in self._parts.items()}

    @property
    def _parts(self) -> dict[str, Array]:
        """Works (n,) until each time [J], by what does them."""
        friction = {f"friction {name}".strip(): work for name, work in self.friction.items()}
        return {"drive": self.drive, **friction, "dampers": self.dampers, "stops": self.stops}

    def columns(self) -> dict[str, float]:
        """Return mean powers [W] and the energy per travel [J/m] by the names of their columns."""
        length = float(self.t[-1] - self.t[0])
        powers = {f"power {name}": work / length for name, work in self.works.items()}
        return powers | {PER_TRAVEL: self.per_travel}

    def to_dict(self) -> dict[str, Any]:
        """Return works over the run [J], energy per travel and mismatch, for JSON."""
        per_travel = {"energy per travel": self.per_travel, "unit": f"J/{self.unit}"}
        return {"works": self.works, **per_travel, "mismatch": self.mismatch}

    def _over(self) -> str:
        return "t"

    def _column_units(self) -> Mapping[str, str]:
        return {"t": "s"} | dict.fromkeys(self.to_dataframe().columns[1:], "J")

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each time: energy and works since the first [J]."""
        import pandas as pd

        parts = {"drive": self.drive, "positive drive": self.positive} | self._parts
        return pd.DataFrame({"t": self.t, "energy": self.energy, **parts})

    def _summary(self) -> Summary:
        rows = [(name, quantity(value, "J", 4)) for name, value in self.works.items()]
        over = f"{quantity(float(self.t[0]), 's', 4)} to {quantity(float(self.t[-1]), 's', 4)}"
        return Summary(
            sentence=f"Works from {over}; mismatch {number(self.mismatch, 2)}.",
            rows=[*rows, (PER_TRAVEL, quantity(self.per_travel, f"J/{self.unit}", 4))],
        )


def energy_balance(
    mechanism: Mechanism,
    run: Trajectory,
    *,
    coordinate: str | None = None,
    since: float | None = None,
    until: float | None = None,
    times: Array | None = None,
) -> EnergyBalance:
    """Return the energy of a run, what drives put in, and what friction, dampers and stops take.

    Parameters
    ----------
    mechanism : Mechanism
        What moved.
    run : Trajectory
        Its run.
    coordinate : str, optional
        Coordinate of the travel; the one along which contacts slip if not given.
    since, until : float, optional
        First and last time [s]; those of the run if not given.
    times : array (n,), optional
        Further times at which energy and works are known.

    Returns
    -------
    EnergyBalance
        Energy and works at the ends of steps, and at the times that are given.

    Raises
    ------
    InputError
        If the times are not within the run, or a drive is a voltage, whose force depends on the
        motion.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb, simulate
    >>> from stickslip.mechanisms import Torque
    >>> from stickslip.mechanisms.drives import Sine
    >>> push = Torque(drive=Sine(amplitude=0.2, frequency=13.0))
    >>> capsule = Capsule(
    ...     capsule_mass=0.08,
    ...     inner_mass=0.02,
    ...     stiffness=60.0,
    ...     damping=0.03,
    ...     drive=push,
    ...     upper_stop=2e-3,
    ...     restitution=0.6,
    ... )
    >>> run = simulate(capsule, Coulomb(kinetic_coefficient=0.2), t_end=2.0)
    >>> balance = energy_balance(capsule, run, since=1.0)
    >>> balance.mismatch < 1e-9
    True
    """
    first, last = run.span
    since, until = first if since is None else since, last if until is None else until
    if not first <= since < until <= last * (1.0 + 1e-12):
        raise InputError(
            f"energy_balance: since and until must lie within the run, {number(first, 6)} to"
            f" {number(last, 6)} s, in this order, got {number(since, 6)} and {number(until, 6)} s."
        )
    columns_of(mechanism)
    times = _times(mechanism, run, since, min(until, last), times)
    widths = np.diff(times)
    at = (times[:-1] + 0.5 * widths)[:, None] + 0.5 * widths[:, None] * _NODES
    seen = run.at(at.ravel())
    powers = _powers(mechanism, seen, float(widths.max()))

    def summed(power: Scalar) -> Array:
        cells = np.broadcast_to(power, seen.t.shape).reshape(at.shape) @ _WEIGHTS
        return np.append(0.0, np.cumsum(0.5 * widths * cells))

    parts = sum(powers["drive"].values(), np.zeros_like(seen.t))
    shape = at.shape
    positive = sum(
        (_positive(np.reshape(p + 0.0 * seen.t, shape)) for p in powers["drive"].values()),
        np.zeros(shape[0]),
    )
    energy = _energy(mechanism, run.at(times))
    before = _energy(mechanism, run.at(np.maximum(np.nextafter(times, -np.inf), first)))
    struck = np.isin(times, [event.t for event in run.events])
    struck[0] = False
    along, unit = travel_of(mechanism, coordinate)
    places = run.at(times[[0, -1]])
    return EnergyBalance(
        t=times,
        energy=energy,
        drive=summed(parts),
        positive=np.append(0.0, np.cumsum(0.5 * widths * positive)),
        friction={name: summed(power) for name, power in powers["friction"].items()},
        dampers=summed(-sum(powers["others"].values(), np.zeros_like(seen.t))),
        stops=np.cumsum(np.where(struck, before - energy, 0.0)),
        travel=float(np.diff(places[along])[0]) if along else np.nan,
        unit=unit,
    )


def _positive(power: Array) -> Array:
    """Return the integral over [-1, 1] of the positive part of a power at Gauss's nodes (m, 12).

    Where its sign changes, the polynomial through the nodes is integrated between its roots.
    """
    result: Array = np.maximum(power, 0.0) @ _WEIGHTS
    changes = np.flatnonzero((power.min(axis=1) < 0.0) & (power.max(axis=1) > 0.0))
    for start in range(0, len(changes), BATCH):
        cells = changes[start : start + BATCH]
        result[cells] = _between_roots(power[cells])
    return result


def _between_roots(power: Array) -> Array:
    """Return the integral of the positive part of powers that change their sign (m, 12)."""
    series = power @ _SERIES.T
    last = series[:, -1:]
    least = np.finfo(float).eps * np.abs(series).max(axis=1, keepdims=True)
    matrix = np.repeat(_COMPANION[None], len(power), axis=0)
    matrix[:, :, -1] -= series[:, :-1] / np.where(np.abs(last) < least, least, last) * _SHARES
    # turned round: eigenvalues of a matrix graded upwards have smaller errors
    roots = np.linalg.eigvals(matrix[:, ::-1, ::-1])
    real = (np.abs(roots.imag) < 1e-8) & (np.abs(roots.real) < 1.0)
    edge = np.ones((len(power), 1))
    # what is no root within the cell ends it, after which nothing is left
    ends = np.hstack([-edge, np.sort(np.where(real, roots.real, 1.0), axis=1), edge])
    grown = (_LEGENDRE.legvander(ends, series.shape[1]) @ (series @ _INTEGRAL.T)[..., None])[..., 0]
    return np.asarray(np.maximum(np.diff(grown, axis=1), 0.0).sum(axis=1))


def columns_of(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the names of `EnergyBalance.columns`; what has no balance is refused.

    Examples
    --------
    >>> from stickslip import Axis
    >>> columns_of(Axis(inertia=1.0))[:2]
    ('power drive', 'power friction')
    """
    if has_electric_motor(mechanism):
        raise InputError(
            f"energy_balance: the force of the electric motor of {type(mechanism).__name__} depends"
            " on the motion, too, so that its work is not known apart."
        )
    rubs = (f"friction {contact.name}".strip() for contact in mechanism.contacts())
    return (*(f"power {name}" for name in ("drive", *rubs, "dampers", "stops")), PER_TRAVEL)


def units_of_columns(names: Iterable[str], unit: str) -> dict[str, str]:
    """Return the SI units of `EnergyBalance.columns`, for a travel in a unit.

    Examples
    --------
    >>> from stickslip.study.sweep import units_of_columns
    >>> units_of_columns(["power drive", "energy per travel"], "m")
    {'power drive': 'W', 'energy per travel': 'J/m'}
    """
    known = (name for name in names if name == PER_TRAVEL or name.startswith("power "))
    return {name: f"J/{unit}" if name == PER_TRAVEL else "W" for name in known}


def travel_of(mechanism: Mechanism, coordinate: str | None = None) -> tuple[str, str]:
    """Return coordinate and unit of the travel; no coordinate if none was named and several slip.

    Examples
    --------
    >>> from stickslip import Axis
    >>> travel_of(Axis(inertia=1.0))
    ('x', 'm')
    """
    slips = {name for contact in mechanism.contacts() for name in contact.slips}
    if coordinate is None and len(slips) != 1:
        return "", "m"
    name = slip_among(mechanism, None, "energy_balance")[0] if coordinate is None else coordinate
    if name not in mechanism.coordinates:
        raise UnknownNameError("coordinate", name, mechanism.coordinates)
    return name, mechanism.units[mechanism.coordinates.index(name)]


def _times(
    mechanism: Mechanism, run: Trajectory, since: float, until: float, others: Array | None
) -> Array:
    """Return ends of steps, events, starts of pieces of the drives, and other times."""
    starts = [
        float(piece.start) for drive in mechanism.drives().values() for piece in drive.pieces(until)
    ]
    ends = [since, until, *(() if others is None else others)]
    times = np.concatenate([run.t, [event.t for event in run.events], starts, ends])
    return np.unique(times[(times >= since) & (times <= until)])


def _energy(mechanism: Mechanism, seen: Trajectory) -> Array:
    q, q_dot = _motion(mechanism, seen)
    q_dot |= dict.fromkeys(mechanism.computed, np.zeros_like(seen.t))
    energy = mechanism.kinetic_energy(q, q_dot) + mechanism.potential_energy(seen.t, q)
    return np.asarray(energy + 0.0 * seen.t, dtype=np.float64)


def _motion(mechanism: Mechanism, seen: Trajectory) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return coordinates and rates by coordinate, held ones at 0."""
    places: dict[str, Array] = defaultdict(lambda: np.zeros_like(seen.t))
    rates: dict[str, Array] = defaultdict(lambda: np.zeros_like(seen.t))
    places |= {name: seen[name] for name in mechanism.coordinates}
    for name, rate in zip(mechanism.coordinates, mechanism.rates, strict=True):
        rates[name] = seen[rate]
    for held in (*mechanism.held(), *(n for c in mechanism.contacts() for n in c.normals)):
        places.setdefault(held, np.zeros_like(seen.t))
        rates.setdefault(held, np.zeros_like(seen.t))
    return places, rates


def _powers(mechanism: Mechanism, seen: Trajectory, step: float) -> dict[str, dict[str, Scalar]]:
    """Return powers at times (n,) [W]: of drives, of friction (taken), and of other forces."""
    q, q_dot = _motion(mechanism, seen)
    efforts = efforts_of(mechanism, seen)
    drives = {name: values_of(drive, seen.t, seen) for name, drive in mechanism.drives().items()}
    forces = mechanism.forces(seen.t, q, q_dot, drives)
    guided = mechanism.guided()
    # Given coordinates: the effort balances all forces on them, so that others work there as well.
    others = {
        name: (force - (0.0 if name in guided else efforts.get(name, 0.0))) * q_dot[name]
        for name, force in forces.items()
        if name in mechanism.coordinates and name not in mechanism.computed
    }
    driven: dict[str, Scalar] = {name: effort * q_dot[name] for name, effort in efforts.items()}
    if mechanism.computed:  # all that acts is its loop, with the drives in it
        driven |= {name: forces[name] * q_dot[name] for name in others}
        others = {}
    if isinstance(mechanism, MatrixMechanism):  # whose forces are those of inertia, too
        total = mechanism.power(seen.t, q, q_dot, drives)
        if total is None:
            raise InputError(
                f"energy_balance: {type(mechanism).__name__} does not tell the power of its drives"
                " and dampers: write its method power."
            )
        others = {"": total - sum(driven.values())}
    h = 1e-4 * step  # supports move smoothly within a step
    after, before = (mechanism.potential_energy(seen.t + side, q) for side in (h, -h))
    driven["support"] = (after - before) / (2.0 * h) + 0.0 * seen.t
    several = len(mechanism.contacts()) > 1
    rubbed: dict[str, Scalar] = {}
    for contact in mechanism.contacts():
        slip = {contact.slip: 1.0} if isinstance(contact.slip, str) else contact.slip
        speed = sum(factor * q_dot[name] for name, factor in slip.items())
        column = f"friction:{contact.name}" if several else "friction"
        rubbed[contact.name] = seen[column] * speed
    return {"drive": driven, "friction": rubbed, "others": others}


def efforts_of(mechanism: Mechanism, seen: Trajectory) -> dict[str, Array]:
    """Return what drives exert along each coordinate: forces, and efforts of prescribed motions.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, simulate
    >>> from stickslip.mechanisms.drives import Pulse
    >>> axis = Axis(inertia=1.0, drive=Pulse(level=3.0, duration=1.0))
    >>> run = simulate(axis, Coulomb(kinetic_coefficient=0.5), t_end=0.5)
    >>> efforts_of(axis, run.at([0.1]))["x"].tolist()
    [3.0]
    """
    guided = mechanism.guided()
    result = {name: seen[guide.effort] for name, guide in guided.items() if guide.effort}
    drives = {
        name: values_of(drive, seen.t, seen)
        for name, drive in mechanism.drives().items()
        if name not in {guide.drive for guide in guided.values()}
    }
    if not drives or has_electric_motor(mechanism):
        return result
    q, q_dot = _motion(mechanism, seen)
    idle = {name: 0.0 * x if name != GROUND else x for name, x in drives.items()}
    driven, still = (mechanism.forces(seen.t, q, q_dot, given) for given in (drives, idle))
    for name, force in driven.items():
        if name not in mechanism.coordinates:  # what presses a body, and moves nothing
            continue
        effort = np.broadcast_to(force - still.get(name, 0.0), seen.t.shape)
        if name not in guided and np.any(effort != 0.0):
            result[name] = effort
    return result


def has_electric_motor(part: object) -> bool:
    """Whether a drive is a voltage or a current, whose force depends on the motion too.

    Examples
    --------
    >>> from stickslip import Axis
    >>> has_electric_motor(Axis(inertia=1.0))
    False
    """
    if isinstance(part, DCMotor):
        return True
    if isinstance(part, Parametrised):
        part = tuple(vars(part).values())
    return isinstance(part, tuple) and any(map(has_electric_motor, part))


def values_of(drive: Drive, times: Array, seen: Trajectory | None = None) -> Array:
    """Return the values of a drive at times (n,), with what follows the states of a run there.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import Pulse
    >>> values_of(Pulse(level=10.0, duration=0.1), np.array([0.05, 0.1])).tolist()
    [10.0, 0.0]
    """
    pieces = drive.pieces(float(times.max()))
    starts = np.array([float(piece.start) for piece in pieces])
    here = np.searchsorted(starts, times, side="right") - 1
    table = np.array([(p.value, p.slope, p.start) for p in pieces] or [(0.0, 0.0, 0.0)])
    value, slope, start = table[np.maximum(here, 0)].T
    linear = np.where(here >= 0, value + slope * (times - start), 0.0)
    value = np.asarray(drive.shaped(linear, times), dtype=np.float64)
    return value if seen is None else value + drive.fed({name: seen[name] for name in seen.names})
