"""`check_law`: whether a law of one's own is what the solver takes it for."""

import functools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from stickslip.engine.formulation import formulate
from stickslip.engine.simulation import simulate
from stickslip.engine.solver import Equations, gather
from stickslip.errors import ConformanceError
from stickslip.friction import FrictionLaw, bound
from stickslip.maths import Latches
from stickslip.mechanisms import Axis, given_inputs
from stickslip.show.formatting import number

MOST_PROBLEMS = 3
"""Problems that are told of one check."""
INTEGRATED = 1e-11
"""Some thousand roundings of the largest term: what sums of a mechanism's size may leave."""
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


def check_law(
    law: FrictionLaw,
    *,
    load: float = 10.0,
    speed: float = 1.0,
    inputs: Mapping[str, float] | None = None,
    t_end: float = 2.0,
) -> None:
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

    Raises
    ------
    ConformanceError
        If it is not; the message lists each check that failed, with up to three problems.

    Examples
    --------
    >>> from stickslip import Stribeck
    >>> law = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.01)
    >>> check_law(law)
    """
    case = _Case(law, {**ORDINARY, **(inputs or {})}, load, speed, t_end)
    lines: list[str] = []
    for name, check in CHECKS.items():
        try:
            problems = list(islice(check(case), MOST_PROBLEMS))
        except Exception as error:  # code of somebody else may raise anything
            problems = [f"{type(error).__name__}: {error}"]
        if problems:
            lines += [f"- {name}", *(f"    {problem}" for problem in problems)]
        if problems and check is _derived:
            lines.append("Not checked until this is corrected: what needs generated equations.")
            break
    if lines:
        raise ConformanceError("\n".join([f"{type(law).__name__} fails these checks:", *lines]))


@dataclass(frozen=True)
class _Case:
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


def _reach(law: FrictionLaw) -> float:
    """Return the deflection [m] that carries the break-away level."""
    return float(law.break_away(1.0) / law.force(0.0, 1.0, (1.0,) * len(law.states)))


def _opposes(case: _Case) -> Iterator[str]:
    for speed in case.speeds:
        for v in (speed, -speed):
            force = case.steady(v, case.load)
            if not force * v >= 0.0:
                yield f"the force of {number(force)} N at {number(v)} m/s drives the motion"


def _breaks_away(case: _Case) -> Iterator[str]:
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


def _affine(case: _Case) -> Iterator[str]:
    for speed in case.speeds:
        for v in (speed, -speed):
            parts = [case.steady(v, share * case.load) for share in (2.0, 1.0, 0.0)]
            if abs(parts[0] - 2.0 * parts[1] + parts[2]) > INTEGRATED * max(map(abs, parts)):
                yield f"at {number(v)} m/s friction is not affine in the load, a + b N"


def _derived(case: _Case) -> Iterator[str]:
    """Yield nothing; raise what keeps the equations from being derived."""
    formulate(case.rig, case.law)
    yield from ()


def _traced(case: _Case) -> Iterator[str]:
    """Yield speeds at which the generated equations have another force than the law itself."""
    law = case.told
    model = formulate(case.rig, case.law)
    equations = Equations(model, gather(case.rig, case.law, model, 0.0))
    share = _reach(law) * 0.3 if law.states else 0.0
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


def _dissipates(case: _Case) -> Iterator[str]:
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


CHECKS: Mapping[str, Callable[[_Case], Iterable[str]]] = {
    "friction opposes slip": _opposes,
    "friction is affine in the load": _affine,
    "break-away and sliding agree": _breaks_away,
    "its equations can be derived": _derived,
    "the generated equations agree with the law": _traced,
    "friction never increases the energy": _dissipates,
}
