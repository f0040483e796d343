"""The suite for mechanisms, and the generated equations in plain numbers."""

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.formulation import formulate
from stickslip.engine.simulation import simulate
from stickslip.engine.solver import Equations, gather
from stickslip.engine.trajectory import Status
from stickslip.friction import Coulomb, FrictionLaw, bristle_names, laws
from stickslip.mechanisms import MatrixMechanism, Mechanism
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import Parametrised, fields_of
from stickslip.show.formatting import number
from stickslip.study.testing.report import Report, Suite, examine

# The generated equations in plain numbers, and checks that laws and mechanisms share.

DERIVED = "its equations can be derived"
BALANCED = "runs satisfy the energy balance"
FINITE = "equations are finite at the end of slip"
NEAR_REST = (0.0, -1e-4)
"""Slip velocities, in the direction of slip: at its end, and where a step overshoots it [m/s]."""
LAWFUL = ("field", "jacobian", "time_slope", "contact", "guards", "guard_slopes", "power")
OF_PARTS = ("masses", "forces", "force_slopes", "loads", "power")
"""The same where there are several contacts, whose laws have equations of their own."""


def generated(mechanism: Mechanism, law: FrictionLaw) -> Equations:
    """Return the equations of a mechanism with a law, to be called with numbers."""
    model = formulate(mechanism, law)
    return Equations(model, gather(mechanism, law, model, 0.0))


def derived(mechanism: Mechanism, law: FrictionLaw) -> Iterator[str]:
    """Yield nothing; raise what keeps the equations from being derived."""
    formulate(mechanism, law)
    yield from ()


def slip_rates(mechanism: Mechanism) -> list[str]:
    """Return the rates of the coordinates along which contacts slip."""
    rates = dict(zip(mechanism.coordinates, mechanism.rates, strict=True))
    slips = dict.fromkeys(name for contact in mechanism.contacts() for name in contact.slips)
    return [rates[name] for name in slips if name in rates]


def vector(mechanism: Mechanism, law: FrictionLaw, values: Mapping[str, float]) -> list[float]:
    """Return all states in order; what is not given is 0."""
    contacts = tuple(contact.name for contact in mechanism.contacts())
    names = (*mechanism.coordinates, *mechanism.rates, *bristle_names(contacts, law))
    return [float(values.get(name, 0.0)) for name in names]


def finite_near_rest(
    mechanism: Mechanism, law: FrictionLaw, starts: Sequence[Mapping[str, float]]
) -> Iterator[str]:
    """Yield functions of the equations that are not finite where slip ends."""
    equations = generated(mechanism, law)
    names = OF_PARTS if formulate(mechanism, law).contacts else LAWFUL
    for start in starts:
        for sense in (1, -1):
            for speed in NEAR_REST:
                slow = dict.fromkeys(slip_rates(mechanism), sense * speed)
                y = vector(mechanism, law, {**start, **slow})
                flags = equations.flags(0.0, y)
                for name in names:
                    size = equations(name, sense, flags, 0.0, y)
                    if not np.all(np.isfinite(size)):
                        yield f"{name} is not finite at slip velocity {number(sense * speed)}"


def reach(law: FrictionLaw) -> float:
    """Return the deflection [m] that carries the break-away level."""
    return float(law.break_away(1.0) / law.force(0.0, 1.0, (1.0,) * len(law.states)))


# The suite for mechanisms.

ROUNDING = 1e-11
"""Some thousand roundings of the largest term: what sums of a mechanism's size may leave."""
ENDS = (Status.LIFT_OFF, Status.PAINLEVE, Status.LIMIT)
"""How a run may end early for reasons of mechanics."""
USUAL = Coulomb(kinetic_coefficient=0.2)


@dataclass(frozen=True)
class _Case:
    mechanism: Mechanism
    law: FrictionLaw
    t_end: float
    starts: Sequence[Mapping[str, float]]
    draws: int
    seed: int

    @property
    def names(self) -> tuple[str, ...]:
        """All coordinates, those that are held last."""
        normals = dict.fromkeys(n for contact in self.mechanism.contacts() for n in contact.normals)
        others = [name for name in self.mechanism.held() if name not in normals]
        return (*self.mechanism.coordinates, *normals, *others)

    def states(self) -> Iterator[tuple[dict[str, float], dict[str, float]]]:
        """Yield coordinates and rates, those of held coordinates 0."""
        dice = random.Random(self.seed)
        moving = self.mechanism.coordinates
        for _ in range(self.draws):
            q = {name: dice.uniform(-1.0, 1.0) * (name in moving) for name in self.names}
            q_dot = {name: dice.uniform(-1.0, 1.0) * (name in moving) for name in self.names}
            yield q, q_dot

    def mass_matrix(self, q: Mapping[str, float]) -> NDArray[np.float64]:
        """Return the mass matrix (n, n) that is given, or follows from the kinetic energy."""
        moving = self.mechanism.coordinates
        if isinstance(self.mechanism, MatrixMechanism):
            return np.array(self.mechanism.mass_matrix(q)[: len(moving)], dtype=float)

        def energy(*which: str) -> float:
            rates = {name: float(which.count(name)) for name in self.names}
            return float(self.mechanism.kinetic_energy(q, rates))

        alone = [energy(i) for i in moving]
        return np.array(
            [[energy(i, j) - a - b for j, b in zip(moving, alone, strict=True)]
             for i, a in zip(moving, alone, strict=True)]
        )  # fmt: skip


def check_mechanism(
    mechanism: Mechanism,
    law: FrictionLaw = USUAL,
    *,
    t_end: float = 1.0,
    starts: Sequence[Mapping[str, float]] | None = None,
    draws: int = 20,
    seed: int = 0,
    throw: bool = False,
) -> Report:
    """Check that a mechanism is what the solver takes it for.

    Parameters
    ----------
    mechanism : Mechanism
        What is checked, with ordinary values.
    law : FrictionLaw
        The friction with which it is run; several contacts share it.
    t_end : float
        Length of the runs [s]: as long as the mechanism needs to show all it does.
    starts : sequence of mapping, optional
        States by name from which runs begin; from where the mechanism begins by itself, and with a
        slip velocity of 0.5, if not given.
    draws : int
        Number of random states.
    seed : int
        Of these.
    throw : bool
        Raise `ConformanceError` if there are findings.

    Returns
    -------
    Report
        With all findings; ``report.ok`` where there are none.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> check_mechanism(block)
    <SpringBlock: 10 checks passed>
    """
    if starts is None:
        starts = ({}, dict.fromkeys(_slip_rates(mechanism), 0.5))
    case = _Case(mechanism, law, t_end, starts, draws, seed)
    return examine(type(mechanism).__name__, case, FIRST, THEN, throw=throw)


def _slip_rates(mechanism: Mechanism) -> list[str]:
    """Return the slip velocity, if contacts are named as they should be."""
    try:
        return slip_rates(mechanism)
    except Exception:  # a check says what is wrong with the contacts
        return []


def _lengths(case: _Case) -> Iterator[str]:
    own = case.mechanism
    sizes = {name: len(getattr(own, name)) for name in ("coordinates", "rates", "units")}
    if len(set(sizes.values())) > 1:
        yield ", ".join(f"{n} {name}" for name, n in sizes.items())
    names = (*own.coordinates, *own.rates)
    yield from (f"{name!r} is listed twice" for name in {*names} if names.count(name) > 1)


def _contacts(case: _Case) -> Iterator[str]:
    coordinates = case.mechanism.coordinates
    contacts = case.mechanism.contacts()
    names = [contact.name for contact in contacts]
    if not contacts or (len(contacts) > 1 and (len(set(names)) < len(names) or "" in names)):
        yield f"there must be a contact, and several need different names; got {names}"
    taken = {*laws(), *(field for law in laws().values() for field in fields_of(law))}
    for name in taken.intersection(names):
        yield f"{name!r} is the name of a law or of its parameter, which rig files take it for"
    prescribed = _prescribed(case)
    for name in prescribed.keys() - set(names):
        yield f"loads gives a load to {name!r}, which is no contact"
    for contact in contacts:
        moving = [name for name in contact.slips if name in coordinates]
        if not moving:
            slips = ", ".join(contact.slips)
            yield f"{slips!r} slips, but the coordinates are {', '.join(coordinates)}"
        loaded = contact.load is not None or contact.name in prescribed
        if (contact.normal is None) != loaded:
            yield "either a normal coordinate or a load must be given, and not both"
        for name in contact.normals:
            if name in coordinates:
                yield f"{name!r} is held, but is listed among the moving coordinates"


def _prescribed(case: _Case) -> Mapping[str, float]:
    """Return the loads that the mechanism gives where nothing moves."""
    rest = dict.fromkeys(case.names, 0.0)
    drives = {name: drive.value(0.0) for name, drive in case.mechanism.drives().items()}
    return case.mechanism.loads(0.0, rest, rest, drives)


def _drives(case: _Case) -> Iterator[str]:
    held = {id(part) for part in _drives_in(case.mechanism)}
    for name, drive in case.mechanism.drives().items():
        if not name:
            yield f"a drive is named {name!r}"
        if id(drive) not in held:
            yield f"{name!r} is not a field, so its parameters are unknown"


def _drives_in(root: Parametrised) -> Iterator[Drive]:
    """Yield the drives in the fields of an object and of its parts."""
    for value in vars(root).values():
        for part in value if isinstance(value, tuple) else (value,):
            if isinstance(part, Drive):
                yield part
            elif isinstance(part, Parametrised):
                yield from _drives_in(part)


def _start(case: _Case) -> Iterator[str]:
    known = (*case.mechanism.coordinates, *case.mechanism.rates)
    yield from (f"{name!r} is not a state" for name in case.mechanism.start() if name not in known)


def _quadratic(case: _Case) -> Iterator[str]:
    for q, q_dot in case.states():
        once = float(case.mechanism.kinetic_energy(q, q_dot))
        thrice = float(
            case.mechanism.kinetic_energy(q, {name: 3.0 * v for name, v in q_dot.items()})
        )
        if not once > 0.0:
            yield f"it is {number(once)} J at rates {q_dot}"
        elif abs(thrice - 9.0 * once) > ROUNDING * thrice:
            yield (
                f"three times the rates give {number(thrice / once, 6)} times the energy, not 9"
                " times"
            )


def _symmetric(case: _Case) -> Iterator[str]:
    for q, _ in case.states():
        mass = case.mass_matrix(q)
        size = float(np.abs(mass).max())
        if np.abs(mass - mass.T).max() > ROUNDING * size:
            yield f"it is not symmetric at {q}: {mass.tolist()}"
        elif np.linalg.eigvalsh(mass).min() <= ROUNDING * size:
            yield f"it is not positive definite at {q}: {mass.tolist()}"


def _gyroscopic(case: _Case) -> Iterator[str]:
    """Yield states at which power grows with the cube of the rates, as no damper's does.

    That of guided coordinates does, with the accelerations of the others.
    """
    if case.mechanism.guided():
        return
    equations = generated(case.mechanism, case.law)

    def power(q: Mapping[str, float], q_dot: Mapping[str, float], scale: float) -> float:
        rates = zip(case.mechanism.rates, case.mechanism.coordinates, strict=True)
        values = {**q, **{rate: scale * q_dot[i] for rate, i in rates}}
        y = vector(case.mechanism, case.law, values)
        return float(equations("power", 1, equations.flags(0.0, y), 0.0, y)[0])

    for q, q_dot in case.states():
        odd, odd_twice = (power(q, q_dot, k) - power(q, q_dot, -k) for k in (1.0, 2.0))
        size = float(case.mechanism.kinetic_energy(q, q_dot)) + abs(odd) + abs(odd_twice)
        if abs(odd_twice - 2.0 * odd) > 1e3 * ROUNDING * size:
            yield f"they give {number((odd_twice - 2.0 * odd) / 12.0)} W at {q}, {q_dot}"


def _balanced(case: _Case) -> Iterator[str]:
    for start in case.starts:
        run = simulate(case.mechanism, case.law, t_end=case.t_end, y0=start, throw=False)
        if not run.status.complete and run.status not in ENDS:
            yield f"from {dict(start)}: {run.status.value}"
        yield from (f"from {dict(start)}: {problem}" for problem in run.certificate.problems)


FIRST: Suite[_Case] = {
    "every coordinate has one rate and one unit": _lengths,
    "contacts name coordinates": _contacts,
    "drives are named and are fields": _drives,
    "its initial state consists of states": _start,
    "its kinetic energy is positive and quadratic in the rates": _quadratic,
    "its mass matrix is symmetric and positive definite": _symmetric,
    DERIVED: lambda case: derived(case.mechanism, case.law),
}
THEN: Suite[_Case] = {
    "centrifugal and Coriolis forces do no work": _gyroscopic,
    BALANCED: _balanced,
    FINITE: lambda case: finite_near_rest(
        case.mechanism, case.law, [dict(case.mechanism.start()) | dict(s) for s in case.starts]
    ),
}
