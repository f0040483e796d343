"""The route of measured friction: a law is fitted to the force along the measured motion."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import MISSING, fields, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError, InputError
from stickslip.experiments import Measurement
from stickslip.friction import BristleLaw, DirectionalLaw, FrictionLaw, SetValuedLaw
from stickslip.identification.map_problem import ForceMap
from stickslip.identification.map_records import Stretch, stretches_of
from stickslip.identification.map_starts import Rough, looked_for
from stickslip.identification.optimise import improve
from stickslip.identification.unknowns import Unknown, Unknowns
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary

__all__ = ["MECHANISM", "SENSOR", "ForceMap", "force_map", "map_along"]

Array = NDArray[np.float64]

MECHANISM, SENSOR = "mechanism.offset", "measurement.offset.friction"
"""Paths of the constant force: of the mechanism if it has one, else of the force sensor."""
FEW = 1_000
"""Samples of a record that start values are looked for with."""
EXPONENTS = (0.1, 0.6, 1.5)
"""Exponents that start values are looked for at; whole ones are another law."""
SPEEDS = (0.01, 0.05, 0.25, 1.0)
"""Stribeck velocities over the largest speed."""
FACTORS = (0.4, 1.0, 2.5)
"""Stiffness over that of the first look."""
BEST = 2
"""Points of the grid from which a law of bristles with a static surplus goes downhill."""
ROUNDS = 4
"""Steps downhill from there."""
SAMPLES = 4_000
"""Samples of a record that a fit uses at most."""


def force_map(
    law: FrictionLaw | type[FrictionLaw],
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    segment: float | None = None,
    samples: float = SAMPLES,
    held: Collection[str] = (),
    known: Mapping[str, float] | None = None,
) -> ForceMap:
    """Return the problem of fitting a law to measured friction, with start values from the data.

    Parameters
    ----------
    law : FrictionLaw or type
        With a type, all parameters of `fit_order` are looked for, and start where the data say.
        With a law, those of them that stand in its equations are looked for, from its values: a
        whole exponent is kept.
    mechanism : Mechanism
        Gives the normal force where it was not measured.
    measurement : Measurement
        Friction, with velocity or position in time, or with velocity as a table.
    segment : float, optional
        Length of segments [s]; a fortieth of each record if not given. Segments only say which
        rows belong together: bristles are carried through from one to the next.
    samples : float
        Samples of a record that are compared at most; ``float("inf")`` for all. The motion between
        them is kept.
    held : collection of str
        Parameters that are not looked for, by path or last name.
    known : mapping of str to float, optional
        Values of those, by last name, where the law is a type; defaults if not given.

    Returns
    -------
    ForceMap
        A constant offset is looked for as well: ``mechanism.offset`` of a mechanism that has one,
        else ``measurement.offset.friction``. Not so where the data or the law cannot tell it from
        a level: slip in one direction only, or a law that differs by direction. Parameters that
        the record does not depend on are left out.

    Raises
    ------
    InputError
        If there is no friction, no motion or no normal force, or nothing to look for.

    Examples
    --------
    >>> from stickslip import Axis, Dahl, Measurement
    >>> from stickslip.identification.optimise import search
    >>> t = np.linspace(0.0, 2.0, 401)
    >>> x = 1e-3 * np.sin(2.0 * np.pi * t)
    >>> friction = np.sign(np.cos(2.0 * np.pi * t)) * 3.0
    >>> record = Measurement(time=t, position=x, friction=friction, load=6.0)
    >>> problem = force_map(Dahl, Axis(inertia=1.0), record, held=["exponent"])
    >>> found = search(problem, starts=1)
    >>> round(float(found.best.values[0]), 2)
    0.5
    """
    stretches = stretches_of(mechanism, measurement, segment=segment, samples=samples)
    few = stretches_of(mechanism, measurement, samples=min(FEW, samples))
    return map_along(law, mechanism, stretches, few, held=held, known=known)


def map_along(
    law: FrictionLaw | type[FrictionLaw],
    mechanism: Mechanism,
    stretches: Sequence[Stretch],
    few: Sequence[Stretch],
    *,
    held: Collection[str] = (),
    known: Mapping[str, float] | None = None,
) -> ForceMap:
    """Return the problem as `force_map` does, along stretches; of fewer samples for start values.

    Raises
    ------
    InputError
        If there is nothing to look for, or the law is none that can be mapped.
    """
    kind = law if isinstance(law, type) else type(law)
    if not issubclass(kind, SetValuedLaw | DirectionalLaw | BristleLaw):
        raise InputError(
            f"a force map needs a law that is set-valued, directional or of bristles;"
            f" {kind.__name__} is none of them."
        )
    own = getattr(mechanism, "offset", None)
    constant = SENSOR if own is None else MECHANISM
    told = Rough.of(stretches, offset=None)
    free = (
        told.two_sided
        and not issubclass(kind, DirectionalLaw)
        and not {constant, "offset"} & set(held)
    )
    rough = told if free else Rough.of(stretches, offset=own or 0.0)
    start = _without(rough.law(kind), held, known) if isinstance(law, type) else law
    paths = looked_for(start, whole=isinstance(law, type), held=held)
    problem = _seen(
        ForceMap(
            law=start,
            unknowns_=rough.unknowns(start, paths, constant if free else None),
            stretches=tuple(stretches),
            constant=constant,
            offset=own or 0.0,
        )
    )
    if not isinstance(law, type):
        return problem
    return _from_grid(problem, replace(problem, stretches=tuple(few)))


def _without(
    law: FrictionLaw, held: Collection[str], known: Mapping[str, float] | None
) -> FrictionLaw:
    """Return a law in which what is not looked for has its value or default, where it has one."""
    names = {name.rpartition(".")[2] for name in held}
    defaults = {field.name: field.default for field in fields(law) if field.name in names}
    plain = {name: v for name, v in defaults.items() if v is not MISSING}
    return replace(law, **{**plain, **{n: v for n, v in (known or {}).items() if n in names}})


def _from_grid(problem: ForceMap, coarse: ForceMap) -> ForceMap:
    """Return the problem with start values from a grid of what the force is not linear in.

    At each point of the grid the other parameters are fitted: for a law of bristles one factor on
    all that is per load, a viscous part and an offset; for any other law all of them.
    """
    unknowns, memory = problem.unknowns, isinstance(problem.law, BristleLaw)
    curved = [item for item in unknowns.items if item.log or (memory and item.above)]
    tried: list[tuple[float, Array]] = []
    for point in product(*(_grid(item) for item in curved)):
        chosen = dict(zip((item.path for item in curved), point, strict=True))
        values = np.array([chosen.get(item.path, item.start) for item in unknowns.items])
        if memory:
            values, cost = _scaled(coarse, values)
        else:
            values, cost = _fitted(coarse, values, set(chosen))
        tried.append((cost, unknowns.values(unknowns.coordinates(values))))
    tried.sort(key=lambda one: one[0])
    if memory and any(item.above for item in curved):
        # a static surplus and its speed stand for each other: a factor alone misjudges the points
        tried = [_fitted_all(coarse, values) for _, values in tried[:BEST]]
    _, best = min(tried, key=lambda one: one[0])
    return replace(problem, unknowns_=unknowns.starting_at(best))


def _fitted_all(coarse: ForceMap, values: Array) -> tuple[float, Array]:
    """Return the cost after some steps downhill from values, and where they lead."""
    try:
        end, _ = improve(coarse, values, rounds=ROUNDS)
    except ConvergenceError:
        return np.inf, values
    return end.cost, end.values


def _grid(item: Unknown) -> Sequence[float]:
    """Return the values of a parameter on the grid."""
    if item.above:
        return [item.start, 5.0 * item.start]
    if item.quantity.structural:
        return EXPONENTS
    if item.quantity.unit == "m/s":
        return [item.high / 10.0 * share for share in SPEEDS]
    return [item.start * factor for factor in FACTORS]


def _scaled(coarse: ForceMap, values: Array) -> tuple[Array, float]:
    """Return values whose levels and stiffness are scaled to fit, and the cost."""
    items = coarse.unknowns.items
    predicted = coarse.predicted(values)
    offset = next((v for v, i in zip(values, items, strict=True) if i.path == coarse.constant), 0.0)
    if not np.all(np.isfinite(predicted)):
        return values, np.inf
    velocity = np.concatenate([one.path.velocity[one.rows_of(None)] for one in coarse.stretches])
    table = np.column_stack([predicted - offset, np.ones(len(predicted)), velocity])
    found = np.linalg.lstsq(table, coarse.measured, rcond=None)[0]
    factor = float(np.clip(found[0], 0.1, 10.0))
    residual = coarse.measured - table @ [factor, *found[1:]]
    new = []
    for value, item in zip(values, items, strict=True):
        per_load = item.quantity.unit in ("1", "1/m", "s/m") and not item.quantity.structural
        new.append(value * factor if per_load else value)
        if item.path == coarse.constant:
            new[-1] = float(found[1])
        if item.quantity.unit == "N s/m":
            new[-1] = max(factor * value + float(found[2]), 0.0)
    return np.array(new), float(residual @ residual)


def _fitted(coarse: ForceMap, values: Array, kept: Collection[str]) -> tuple[Array, float]:
    """Return values fitted where some of them are kept, and the cost."""
    items = coarse.unknowns.items
    law = vary(
        coarse.law,
        "friction",
        {i.path: float(v) for i, v in zip(items, values, strict=True) if i.path in kept},
    )
    free = [k for k, item in enumerate(items) if item.path not in kept]
    unknowns = Unknowns(tuple(items[k] for k in free), coarse.unknowns.known)
    if not free:
        return values, coarse.linearise(values, slopes=False).cost
    try:
        end, _ = improve(replace(coarse, law=law, unknowns_=unknowns), values[free], rounds=4)
    except ConvergenceError:
        return values, np.inf
    new = values.copy()
    new[free] = end.values
    return new, end.cost


def _seen(problem: ForceMap) -> ForceMap:
    """Return the problem without parameters that nothing in the record depends on.

    Raises
    ------
    InputError
        If none is left.
    """
    slopes = problem.linearise(problem.unknowns.start).slopes
    dead = np.all(slopes == 0.0, axis=0)
    items = problem.unknowns.items
    left = tuple(item for item, gone in zip(items, dead, strict=True) if not gone)
    if not left:
        raise InputError(
            f"nothing is left to look for in the law {problem.law.title}: its parameters are held"
            " or do not show in the record."
        )
    return replace(problem, unknowns_=replace(problem.unknowns, items=left))
