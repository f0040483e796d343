"""Suites that check laws and mechanisms of others: what the solver takes them for."""

import functools
import html
import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.formulation import formulate
from stickslip.engine.simulation import simulate
from stickslip.engine.solver import Equations, gather
from stickslip.engine.trajectory import Status
from stickslip.errors import ConformanceError
from stickslip.friction import Coulomb, FrictionLaw, bound, bristle_names, laws
from stickslip.maths import Latches
from stickslip.mechanisms import Axis, MatrixMechanism, Mechanism, given_inputs
from stickslip.quantities import fields_of
from stickslip.show.formatting import number

# What a suite found, and how its checks are run.

Case = TypeVar("Case")
Suite = Mapping[str, Callable[[Case], Iterable[str]]]
"""Checks by what should be; each yields what is not so."""

MOST_PROBLEMS = 3
"""Problems that are told of one check."""


@dataclass(frozen=True, kw_only=True)
class ConformanceFinding:
    """Something that should be and is not.

    Parameters
    ----------
    check : str
        What should be.
    problem : str
        What was met instead.
    """

    check: str
    problem: str


@dataclass(frozen=True, kw_only=True, repr=False)
class Report:
    """What a suite found.

    Parameters
    ----------
    subject : str
        What was checked.
    checks : tuple of str
        What was looked at, in order.
    findings : tuple of ConformanceFinding
        What is not as it should be.
    skipped : tuple of str
        What could not be looked at because of an earlier finding.

    Examples
    --------
    >>> report = Report(subject="Mine", checks=("a is b",), findings=())
    >>> report.ok, report
    (True, <Mine: 1 check passed>)
    """

    subject: str
    checks: tuple[str, ...]
    findings: tuple[ConformanceFinding, ...]
    skipped: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether all is as it should be."""
        return not self.findings

    def _lines(self) -> list[str]:
        failed = dict.fromkeys(finding.check for finding in self.findings)
        n = len(self.checks)
        made = f"{n} check{'' if n == 1 else 's'}"
        head = f"{made} passed" if self.ok else f"{len(failed)} of {made} failed"
        lines = [f"{self.subject}: {head}"]
        for check in failed:
            lines.append(f"- {check}")
            lines += [
                f"    {finding.problem}" for finding in self.findings if finding.check == check
            ]
        if self.skipped:
            lines.append(f"Not checked until these are corrected: {'; '.join(self.skipped)}")
        return lines

    def __repr__(self) -> str:
        return "<" + "\n ".join(self._lines()) + ">"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(chr(10).join(self._lines()))}</pre>"


def examine(
    subject: str, case: Case, first: "Suite[Case]", then: "Suite[Case]", *, throw: bool
) -> Report:
    """Make the first checks, and the others if these found nothing that stands in their way."""
    findings = _found(case, first)
    skipped: tuple[str, ...] = ()
    if any(finding.check == list(first)[-1] for finding in findings):
        skipped = tuple(then)
    else:
        findings += _found(case, then)
    made = (*first, *(() if skipped else then))
    report = Report(subject=subject, checks=made, findings=tuple(findings), skipped=skipped)
    if throw and not report.ok:
        raise ConformanceError(repr(report)[1:-1])
    return report


def _found(case: Case, suite: "Suite[Case]") -> list[ConformanceFinding]:
    """Return what checks find; one that cannot be made has found something, too."""
    result = []
    for name, check in suite.items():
        try:
            problems = list(islice(check(case), MOST_PROBLEMS))
        except Exception as error:  # code of somebody else may raise anything
            problems = [f"{type(error).__name__}: {error}"]
        result += [ConformanceFinding(check=name, problem=problem) for problem in problems]
    return result


# The suite for friction laws.

# The suite for mechanisms, and the generated equations in plain numbers.

# The generated equations in plain numbers, and checks that laws and mechanisms share.

DERIVED = "its equations can be derived"
BALANCED = "runs satisfy the energy balance"


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


def reach(law: FrictionLaw) -> float:
    """Return the deflection [m] that carries the break-away level."""
    return float(law.break_away(1.0) / law.force(0.0, 1.0, (1.0,) * len(law.states)))


# The suite for mechanisms.

INTEGRATED = 1e-11
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
    <SpringBlock: 6 checks passed>
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


FIRST: Suite[_Case] = {
    "contacts name coordinates": _contacts,
    "its kinetic energy is positive and quadratic in the rates": _quadratic,
    "its mass matrix is symmetric and positive definite": _symmetric,
    DERIVED: lambda case: derived(case.mechanism, case.law),
}
THEN: Suite[_Case] = {
    "centrifugal and Coriolis forces do no work": _gyroscopic,
    BALANCED: _balanced,
}


# The suite for friction laws.


@dataclass(frozen=True)
class _OfLaw:
    law: FrictionLaw
    inputs: Mapping[str, float]
    load: float
    speed: float
    t_end: float

    @property
    def speeds(self) -> Sequence[float]:
        """Slip speeds over nine decades [m/s]."""
        return [float(v) for v in self.speed * np.logspace(-8, 1, 37)]

    def steady(self, velocity: float, load: float) -> float:
        """Return the friction force after long sliding [N]."""
        return float(self.told.steady(velocity, load))

    def level(self, direction: int, load: float) -> float:
        """Return the break-away level in a direction [N]."""
        return float(self.told.towards(direction).break_away(load))

    @functools.cached_property
    def told(self) -> FrictionLaw:
        """The law, which sees its inputs."""
        return bound(self.law, self.inputs)

    @property
    def rig(self) -> Axis:
        """A mass between springs, which friction alone brings to rest, with the law's inputs."""
        bare = Axis(inertia=1.0, stiffness=(self.load + 1.0), load=self.load)
        return given_inputs(bare, {name: self.inputs[name] for name in self.law.inputs})


ORDINARY: Mapping[str, float] = {
    "motor": 1.5,
    "external": -0.5,
    "transmitted": 2.0,
    "gravity": -0.5,
    "position": 0.1,
    "temperature": 20.0,
    "pressure": 1e5,
}
"""Inputs of a contact at which laws are checked [SI, degC]."""


def check_friction(
    law: FrictionLaw,
    *,
    load: float = 10.0,
    speed: float = 1.0,
    inputs: Mapping[str, float] | None = None,
    t_end: float = 2.0,
    throw: bool = False,
) -> Report:
    """Check that a friction law is what the solver takes it for.

    Parameters
    ----------
    law : FrictionLaw
        What is checked, with ordinary values.
    load : float
        An ordinary normal force [N], or 1 where levels are forces.
    speed : float
        A high slip speed [m/s]; checks go from 1e-8 to 10 times this.
    inputs : mapping of str to float, optional
        What the contact tells the law beside these, by name; ordinary values if not given.
    t_end : float
        Length of the runs [s], of an oscillation with a period of some seconds.
    throw : bool
        Raise `ConformanceError` if there are findings.

    Returns
    -------
    Report
        With all findings; ``report.ok`` where there are none.

    Examples
    --------
    >>> from stickslip import Stribeck
    >>> law = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.01)
    >>> check_friction(law)
    <Stribeck: 6 checks passed>
    """
    case = _OfLaw(law, {**ORDINARY, **(inputs or {})}, load, speed, t_end)
    return examine(type(law).__name__, case, LAW_FIRST, LAW_THEN, throw=throw)


def _opposes(case: _OfLaw) -> Iterator[str]:
    for speed in case.speeds:
        for v in (speed, -speed):
            force = case.steady(v, case.load)
            if not force * v >= 0.0:
                yield f"the force of {number(force)} N at {number(v)} m/s drives the motion"


def _breaks_away(case: _OfLaw) -> Iterator[str]:
    """Yield levels that do not go with the sliding they give way to.

    Friction may grow with speed beyond the break-away level, but must grow from there: an excess
    that does not vanish with the speed would stop the body as soon as it breaks away.
    """
    slowest = case.speeds[0]
    for sense in (1, -1):
        level = case.level(sense, case.load)
        slow, quick = (
            abs(case.steady(sense * v, case.load)) - abs(case.steady(sense * v, 0.0))
            for v in (slowest, 100.0 * slowest)
        )
        if not level >= 0.0:
            yield f"the break-away level is {number(level)} N, below 0"
        if slow - level > max(INTEGRATED * (slow + level), 0.5 * (quick - level)):
            yield (
                f"sliding begins with {number(slow)} N, above the break-away level of"
                f" {number(level)} N: friction may grow beyond it with speed, but must begin at or"
                " below it"
            )
        if case.level(sense, 0.0) != 0.0:
            yield f"without load the break-away level is {number(case.level(sense, 0.0))} N, not 0"
        if case.law.states:
            yield from _bristles_break_away(case.told, case.load, sense, level)


def _bristles_break_away(law: FrictionLaw, load: float, sense: int, level: float) -> Iterator[str]:
    """Yield what bristles hold, or keep, at rest that they should not."""
    stiffness = float(law.force(0.0, load, (1.0,) * len(law.states)))
    z = (sense * level / stiffness,) * len(law.states)
    # of several, some hold more than their share, but none of equal ones twice as much
    beyond = tuple((1.01 if len(z) == 1 else 2.0) * value for value in z)
    v = sense * 1e-3
    with Latches():
        turning = law.rates(0.0, load, z)
    with Latches():
        rates = law.rates(v, load, beyond)
    made = getattr(law, "made_of", None)
    relaxes = made is not None and made.memory is not None and made.memory.part.relaxes
    if not relaxes and any(rate != 0.0 for rate in turning):
        yield "the bristle deflections change at rest"
    later = tuple(x + 1e-6 * abs(x / v) * rate for x, rate in zip(beyond, rates, strict=True))
    with Latches():
        held, grown = (law.force(0.0, load, pair) for pair in (beyond, later))
    if sense * (grown - held) > 0.0:
        yield f"bristles at the break-away level of {number(level)} N deflect further"


def _affine(case: _OfLaw) -> Iterator[str]:
    for speed in case.speeds:
        for v in (speed, -speed):
            parts = [case.steady(v, share * case.load) for share in (2.0, 1.0, 0.0)]
            if abs(parts[0] - 2.0 * parts[1] + parts[2]) > INTEGRATED * max(map(abs, parts)):
                yield f"at {number(v)} m/s friction is not affine in the load, a + b N"


def _traced(case: _OfLaw) -> Iterator[str]:
    """Yield speeds at which the generated equations have another force than the law itself."""
    law = case.told
    equations = generated(case.rig, case.law)
    share = reach(law) * 0.3 if law.states else 0.0
    for speed in case.speeds[::4]:
        for sense in (1, -1):
            v = sense * speed
            if law.states:
                z = (share,) * len(law.states)
                y = [0.0, v, *z]
                expected = float(law.force(v, case.load, z))
            else:
                y, expected = [0.0, v], case.steady(v, case.load)
            force = equations("contact", sense, equations.flags(0.0, y), 0.0, y)[0]
            if abs(force - expected) > INTEGRATED * (abs(expected) + case.load):
                yield (
                    f"{number(force, 6)} N at {number(v)} m/s in the generated equations, but"
                    f" {number(expected, 6)} N from the law"
                )


def _dissipates(case: _OfLaw) -> Iterator[str]:
    """Yield times at which a mass on springs has more energy than it had without deflection."""
    rig = case.rig
    for v in (case.speed, -case.speed):
        run = simulate(rig, case.law, t_end=case.t_end, y0={"v": v}, throw=False)
        energy = 0.5 * rig.inertia * run["v"] ** 2 + 0.5 * rig.stiffness * run["x"] ** 2
        # the solver's tolerance, a hundredfold
        if energy.max() > energy[0] * (1.0 + 1e-6):
            worst = int(np.argmax(energy))
            yield (
                f"from {number(energy[0])} J to {number(energy[worst])} J at"
                f" {number(run.t[worst])} s"
            )


LAW_FIRST: Suite[_OfLaw] = {
    "friction opposes slip": _opposes,
    "friction is affine in the load": _affine,
    "break-away and sliding agree": _breaks_away,
    DERIVED: lambda case: derived(case.rig, case.law),
}
LAW_THEN: Suite[_OfLaw] = {
    "the generated equations agree with the law": _traced,
    "friction never increases the energy": _dissipates,
}
