r"""What a mechanism says of the forces along a record, and what its unknown parameters change.

Where the force balance is affine in the parameters :math:`p` that are looked for,

.. math:: F(t; p) - J(p)\,\ddot x = F_0(t) - J_0\,\ddot x
          + \sum_i p_i\,(F_i(t) - J_i\,\ddot x),

each is the coefficient of a column :math:`J_i \ddot x - F_i`, as the inertia is that of
:math:`\ddot x`. Whether it is affine is seen from two steps of each, and one of all together. What
changes the force of the drive itself, as the constant of a motor does, is the coefficient of what
it changes from its given value, so that the force as commanded stays one. Where the balance is not
affine, as in a length or a resistance, columns are slopes about the values given, and `settled`
moves these to where the balance leaves least.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement, command_of
from stickslip.errors import InputError, ParameterError
from stickslip.identify.fits import (
    applied_force,
    drives_itself,
    known_forces,
    load_of,
    refuse_load,
    span_of,
    transmitted_along,
    uncertainties_of,
)
from stickslip.identify.inner import pushed
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import Mechanism, motor_of
from stickslip.mechanisms.contact_inputs import DRIVES
from stickslip.quantities import all_paths, parameters, vary

Array = NDArray[np.float64]

STEP = 0.1
"""Share of its value by which a parameter is moved; 1 where that is 0."""
NEAR = 1e-3
"""Share of that step over which a slope is taken: its error is about as large a share of it, which
counts for nothing where values have settled, and that of rounding is less."""
TRANSMITTED = "transmitted"
"""Input of a contact: what goes through its gear."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Unknown:
    """What the force balance changes by for each unit of a parameter that is looked for."""

    force: Array
    """Forces (n,) [N]."""
    inertia: float
    """Inertia [kg]."""
    given: float = 0.0
    """Value from which it counts: 0, or that which is given where it changes the drive's force."""
    limits: tuple[float, float] = (-np.inf, np.inf)
    """Range of what is counted."""
    doubt: float = 0.0
    """Standard uncertainty, where that is stated and the parameter is not looked for."""
    along: Mapping[str, float] = field(default_factory=dict)
    """What a unit of it changes, by path: that of one standard deviation where runs told it; none
    of a parameter that changes alone, by its unit."""
    link: bool = False
    """Whether records of other joints tell its doubt."""
    bent: bool = False
    """Whether forces are not linear in what is looked for: the column is their slope where it
    counts from."""

    @property
    def is_open(self) -> bool:
        """Whether nothing but the balance tells it."""
        return not self.doubt and not self.along

    def within(self, step: float) -> float:
        """Return a step that stays in the range, and neither halves nor doubles what is counted."""
        low, high = self.limits
        if self.given:
            ends = sorted((-0.5 * self.given, self.given))
            low, high = max(low, ends[0]), min(high, ends[1])
        return min(max(step, 0.9 * low), 0.9 * high)


@dataclass(frozen=True, kw_only=True, eq=False)
class Forces:
    """Forces on a coordinate along a record, but for friction and a constant."""

    driven: Array
    """Of the drive (n,) [N]."""
    still: Array
    """Of the mechanism, where the drive gives none (n,) [N]."""
    inertia: float
    """What moves [kg]."""
    unknown: Mapping[str, Unknown]
    """By path, what is not in the other three."""
    load: Array | None = None
    """Normal force (n,) [N], where inner bodies change it."""


def doubts_of(
    mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str]
) -> dict[str, float]:
    """Return stated standard uncertainties by path, of parameters that are not looked for.

    What was set anew for each record counts as one number for all, which averages out less.

    Examples
    --------
    >>> from stickslip import Axis
    >>> record = Measurement(
    ...     time=[0.0, 1.0], position=[0.0, 0.5], parameter_uncertainties={"inertia": 0.1}
    ... )
    >>> doubts_of(Axis(inertia=3.0), record, [])
    {'mechanism.inertia': 0.1}
    """
    result: dict[str, float] = {}
    for parts in uncertainties_of(mechanism, measurement):
        for path, doubt in (item for part in parts for item in part.items()):
            result[path] = max(doubt, result.get(path, 0.0))
    refuse_load(result, measurement)
    return {path: doubt for path, doubt in result.items() if path not in unknown}


def forces_along(
    mechanism: Mechanism,
    record: Measurement,
    x: Array,
    v: Array,
    unknown: Sequence[str],
    doubts: Mapping[str, float] | None = None,
    *,
    linear: bool = True,
) -> Forces:
    """Return the forces along a record, split by parameters that are looked for or doubtful.

    Where they may not be taken as linear, parameters count from their values here.

    Examples
    --------
    >>> from stickslip import Axis
    >>> record = Measurement(time=[0.0, 1.0], position=[0.0, 0.5], force=[0.0, 2.0])
    >>> x, v = np.array([0.0, 0.5]), np.array([0.5, 0.5])
    >>> spring = Axis(inertia=3.0, stiffness=4.0, damping=1.0)
    >>> found = forces_along(spring, record, x, v, ["mechanism.stiffness"])
    >>> found.still.round(6).tolist(), found.unknown["mechanism.stiffness"].force.round(6).tolist()
    ([-0.5, -0.5], [0.0, -0.5])
    """
    count, none = len(x), np.zeros_like(x)
    load: Array | None = None
    several = len(mechanism.coordinates) > 1
    if several:
        recorded = bool(command_of(record))

        def on(changes: Mapping[str, float]) -> Array:
            nonlocal load
            one = pushed(vary(mechanism, "mechanism", changes), record, x, v)
            load = load if changes else one.load
            parts = (one.force, none) if recorded else (none, one.force)
            return np.concatenate([*parts, [one.inertia]])

    else:

        def on(changes: Mapping[str, float]) -> Array:
            one = vary(mechanism, "mechanism", changes) if changes else mechanism
            applied = _applied(one, record)
            mass, force = known_forces(one, x, v, none if applied is None else applied)
            still = none
            if motor_of(one) is not None:  # the back EMF is a part of what the motor gives
                still = known_forces(replace(one, drive=None), x, v, none)[1]  # type: ignore[call-arg]
            elif command_of(record) != "reference":  # there, they are gains of a controller
                still = known_forces(one, x, v, none)[1]
            return np.concatenate([force - still, still, [mass]])

    result, rest = _looked_for(mechanism, on, unknown, linear=linear and not several)
    result |= _doubtful(mechanism, on, doubts or {})
    return Forces(
        driven=rest[:count],
        still=rest[count:-1],
        inertia=float(rest[-1]),
        unknown=result,
        load=load,
    )


def _looked_for(
    mechanism: Mechanism,
    forces: Callable[[Mapping[str, float]], Array],
    unknown: Sequence[str],
    *,
    linear: bool,
) -> tuple[dict[str, Unknown], Array]:
    """Return what parameters change that are looked for, and the rest of forces (2 n + 1,).

    Forces that are linear in all of them are divided into columns, if they may be. Else parameters
    count from their values here, about which a column is the slope.
    """
    base = forces({})
    result, count = dict[str, Unknown](), len(base) // 2
    values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    ranges = all_paths(mechanism, "mechanism")
    looked = [path for path in unknown if not path.endswith(".offset")]  # that is a term of its own
    steps = {path: _step(mechanism, path, values[path]) for path in looked}

    def changed(share: float, *paths: str) -> Array:
        return forces({path: values[path] + share * steps[path] for path in paths}) - base

    firsts, least = dict[str, Array](), THRESHOLDS.rounding * _rounding(base)
    for path in looked if linear else ():
        first, second = (changed(n, path) for n in (1.0, 2.0))
        linear &= not np.any(np.abs(second - 2.0 * first) > _rounding(first) + least)
        firsts[path] = first
    if linear and len(looked) > 1:
        together = np.sum([*firsts.values()], axis=0)
        off = np.abs(changed(1.0, *looked) - together)
        linear = not np.any(off > _rounding(together) + least)
    rest = base.copy()
    for path in looked:
        share = 1.0 if linear else NEAR
        first = firsts[path] if linear else changed(share, path)
        first[np.abs(first) <= least] = 0.0
        slope = first / (share * steps[path])
        own = ranges[path]
        low, high = own.low if own.above is None else max(own.low, own.above), own.high
        drives = bool(np.any(np.abs(first[:count]) > _rounding(first)[:count]))
        given = values[path] if drives or not linear else 0.0
        result[path] = Unknown(
            force=slope[:count] + slope[count:-1],
            inertia=float(slope[-1]),
            given=given,
            limits=(low - given, high - given),
            bent=not linear,
        )
        rest -= (values[path] - given) * slope
    # what is left of unknowns is rounding
    rest[(np.abs(rest) <= _rounding(base)) & (rest != base)] = 0.0
    return result, rest


def _doubtful(
    mechanism: Mechanism,
    forces: Callable[[Mapping[str, float]], Array],
    doubts: Mapping[str, float],
) -> dict[str, Unknown]:
    """Return what doubtful parameters change of forces (2 n + 1,), about their given values."""
    values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    result = {}
    for path, doubt in doubts.items():
        low, high = span_of(mechanism, path, doubt)
        slope = (forces({path: high}) - forces({path: low})) / (high - low)
        count = len(slope) // 2
        result[path] = Unknown(
            force=slope[:count] + slope[count:-1],
            inertia=float(slope[-1]),
            given=values[path],
            doubt=doubt,
        )
    return result


def _rounding(x: Array) -> Array:
    """Return what is rounding beside forces and, the last, an inertia (n,): each in its unit."""
    forces = np.full(len(x) - 1, np.max(np.abs(x[:-1]), initial=0.0))
    return THRESHOLDS.rounding * np.append(forces, abs(float(x[-1])))


def with_gear(mechanism: Mechanism, measurement: Measurement) -> Measurement:
    """Return records with the torque that a gear transmits, where one can be told.

    It is made of what the motion takes and of friction that grows with it, found beside: of the
    measured torque friction is a part, which would explain whatever friction there is.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> t = np.arange(0.0, 10.0, 0.01)
    >>> swing = Measurement(time=t, position=np.sin(t), force=9.81 * np.sin(np.sin(t)))
    >>> found = with_gear(Pendulum(mass=1.0, length=1.0), swing)
    >>> bool(np.max(np.abs(found.inputs["transmitted"])) > 15.0)  # the motor holds the weight
    True
    """
    if len(mechanism.coordinates) > 1:
        return measurement
    result = transmitted_along(mechanism, measurement)
    if result is None:
        return measurement
    records = tuple(
        replace(record, inputs={**record.inputs, TRANSMITTED: x})
        for record, x in zip(measurement.records(), result, strict=True)
    )
    return replace(measurement, trials=records) if measurement.trials else records[0]


def with_transmitted(inputs: Mapping[str, Array]) -> dict[str, Array]:
    """Return inputs of a contact (n,) with the size of what a gear transmits for its forces.

    Examples
    --------
    >>> both = {"motor": np.array([-1.0]), "external": np.array([2.0])}
    >>> with_transmitted(both)["transmitted"].tolist()
    [3.0]
    """
    result = {name: x for name, x in inputs.items() if name not in DRIVES}
    if TRANSMITTED in inputs:
        result[TRANSMITTED] = np.abs(inputs[TRANSMITTED])
    elif {"motor", "external"} <= {*inputs}:
        result[TRANSMITTED] = np.abs(inputs["motor"] - inputs["external"])
    return result


def transmitted_of(inputs: Mapping[str, Array]) -> Array | None:
    """Return what a gear transmits (n,) with its sign; None where its inputs have no sign.

    Where it has the direction of the motion the motor drives, else it is driven.

    Examples
    --------
    >>> both = {"motor": np.array([-1.0, 2.0]), "external": np.array([1.0, 0.0])}
    >>> transmitted_of(both).tolist()
    [-2.0, 2.0]
    """
    result = inputs.get(TRANSMITTED)
    if result is None and {"motor", "external"} <= {*inputs}:
        result = inputs["motor"] - inputs["external"]
    signed = result is not None and float(np.min(result)) < 0.0 < float(np.max(result))
    return result if signed else None


def load_slopes(
    mechanism: Mechanism, unknown: Sequence[str], doubts: Mapping[str, float] | None = None
) -> dict[str, tuple[float, float]]:
    """Return by how much parameters change the normal force, and their values.

    Those are meant that are looked for, or doubtful.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> slopes = load_slopes(SpringBlock(mass=2.0, stiffness=1.0), ["mechanism.mass"])
    >>> round(slopes["mechanism.mass"][0], 6)
    9.81
    """
    base, result = load_of(mechanism), {}
    values = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    for path in unknown:
        step = _step(mechanism, path, values[path])
        step *= NEAR
        change = load_of(vary(mechanism, "mechanism", {path: values[path] + step})) - base
        if abs(change) > NEAR * THRESHOLDS.rounding * base:
            result[path] = change / step, values[path]
    for path, doubt in (doubts or {}).items():
        ends = span_of(mechanism, path, doubt)
        low, high = (load_of(vary(mechanism, "mechanism", {path: end})) for end in ends)
        if abs(high - low) > THRESHOLDS.rounding * base * (ends[1] - ends[0]) / doubt:
            result[path] = (high - low) / (ends[1] - ends[0]), values[path]
    return result


def _applied(mechanism: Mechanism, record: Measurement) -> Array | None:
    """Return what drives a record: as recorded, or as a drive of the mechanism gives it."""
    if not drives_itself(mechanism, record):
        return applied_force(mechanism, record)
    (drive,) = mechanism.drives().values()
    time = np.asarray(record.time, dtype=float)
    return np.array([drive.value(t) for t in time.tolist()])


def _step(mechanism: Mechanism, path: str, value: float) -> float:
    """Return a step of a parameter, two of which stay in its range."""
    step = STEP * abs(value) or 1.0
    for item in (step, -step, 1e-3 * step, -1e-3 * step):
        try:
            vary(mechanism, "mechanism", {path: value + 2.0 * item})
        except ParameterError:
            continue
        return item
    name = path.removeprefix("mechanism.")
    raise InputError(f"vary: {name} cannot be moved from {value:.4g} in its range: leave it out.")
