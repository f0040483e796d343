"""What every mechanism of the package must be, as the solver takes it for it."""

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip import Coulomb, MatrixMechanism, Mechanism, simulate
from stickslip.engine.formulation import formulate
from stickslip.engine.solver import Equations, gather
from stickslip.engine.trajectory import Status
from stickslip.friction import FrictionLaw, bristle_names, laws
from stickslip.quantities import fields_of
from stickslip.show.formatting import number

INTEGRATED = 1e-11
"""Some thousand roundings of the largest term: what sums of a mechanism's size may leave."""
ENDS = (Status.LIFT_OFF, Status.PAINLEVE, Status.LIMIT)
"""How a run may end early for reasons of mechanics."""
USUAL = Coulomb(kinetic_coefficient=0.2)


def faults_of(mechanism, law=USUAL, *, t_end=1.0, draws=20) -> dict[str, list[str]]:
    """Return what is not as it should be, by check."""
    starts = ({}, dict.fromkeys(slip_rates(mechanism), 0.5))
    case = _Case(mechanism, law, t_end, starts, draws, seed=0)
    found = {name: list(check(case)) for name, check in CHECKS.items()}
    return {name: problems for name, problems in found.items() if problems}


def slip_rates(mechanism: Mechanism) -> list[str]:
    """Return the rates of the coordinates along which contacts slip."""
    rates = dict(zip(mechanism.coordinates, mechanism.rates, strict=True))
    slips = dict.fromkeys(name for contact in mechanism.contacts() for name in contact.slips)
    return [rates[name] for name in slips if name in rates]


def generated(mechanism: Mechanism, law: FrictionLaw) -> Equations:
    """Return the equations of a mechanism with a law, to be called with numbers."""
    model = formulate(mechanism, law)
    return Equations(model, gather(mechanism, law, model, 0.0))


def vector(mechanism: Mechanism, law: FrictionLaw, values: Mapping[str, float]) -> list[float]:
    """Return all states in order; what is not given is 0."""
    contacts = tuple(contact.name for contact in mechanism.contacts())
    names = (*mechanism.coordinates, *mechanism.rates, *bristle_names(contacts, law))
    return [float(values.get(name, 0.0)) for name in names]


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


def _quadratic(case: _Case) -> Iterator[str]:
    for q, q_dot in case.states():
        once = float(case.mechanism.kinetic_energy(q, q_dot))
        thrice = float(
            case.mechanism.kinetic_energy(q, {name: 3.0 * v for name, v in q_dot.items()})
        )
        if not once > 0.0:
            yield f"it is {number(once)} J at rates {q_dot}"
        elif abs(thrice - 9.0 * once) > INTEGRATED * thrice:
            yield (
                f"three times the rates give {number(thrice / once, 6)} times the energy, not 9"
                " times"
            )


def _symmetric(case: _Case) -> Iterator[str]:
    for q, _ in case.states():
        mass = case.mass_matrix(q)
        size = float(np.abs(mass).max())
        if np.abs(mass - mass.T).max() > INTEGRATED * size:
            yield f"it is not symmetric at {q}: {mass.tolist()}"
        elif np.linalg.eigvalsh(mass).min() <= INTEGRATED * size:
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
        if abs(odd_twice - 2.0 * odd) > 1e3 * INTEGRATED * size:
            yield f"they give {number((odd_twice - 2.0 * odd) / 12.0)} W at {q}, {q_dot}"


def _balanced(case: _Case) -> Iterator[str]:
    for start in case.starts:
        run = simulate(case.mechanism, case.law, t_end=case.t_end, y0=start, throw=False)
        if not run.status.complete and run.status not in ENDS:
            yield f"from {dict(start)}: {run.status.value}"
        yield from (f"from {dict(start)}: {problem}" for problem in run.certificate.problems)


CHECKS = {
    "contacts name coordinates": _contacts,
    "its kinetic energy is positive and quadratic in the rates": _quadratic,
    "its mass matrix is symmetric and positive definite": _symmetric,
    "centrifugal and Coriolis forces do no work": _gyroscopic,
    "runs satisfy the energy balance": _balanced,
}
