"""What to measure before the runs of a plan, by which simple means, and how well."""

import math
from collections.abc import Mapping

from stickslip.experiments.wording import number
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, parameters
from stickslip.selection.lab_sheet import in_unit

__all__ = ["how_to", "otherwise"]

PLAIN = {
    "mass": "Weigh all that slides, to {needed}. Take a light spring: a third of it moves along.",
    "level": "Measure the push with the force sensor that will record it, to {needed}.",
    "amplitude": "Measure the force with the sensor that will record it, to {needed}.",
    "duration": "Read the push off a record of its force, to {needed}.",
    "lower_stop": "Measure where the stop is, to {needed}.",
    "upper_stop": "Measure where the stop is, to {needed}.",
}
"""How to measure a parameter, by its last name, where nothing has to be computed for it."""


def how_to(mechanism: Mechanism, path: str, needed: float, largest: float) -> str:
    """Return how a parameter of a mechanism is measured well enough.

    Parameters
    ----------
    mechanism : Mechanism
        The rig as it stands.
    path : str
        The parameter.
    needed : float
        Standard uncertainty that it needs, SI.
    largest : float
        Largest setting of the plan, SI: how far a spring is compressed.
    """
    known: Mapping[str, tuple[Quantity, float]] = {
        name: (q, value) for name, q, value in parameters(mechanism, "mechanism")
    }
    unit, value = known[path][0].unit, known[path][1]
    name = path.rpartition(".")[2]
    text = in_unit(needed, unit)
    if name == "stiffness" and "mechanism.gravity" in known and value > 0.0 and largest > 0.0:
        g = known["mechanism.gravity"][1]
        read = needed / value * largest / math.sqrt(2.0)  # a length between two readings
        return (
            f"Hang {in_unit(value * largest / g, 'kg', 3)} on the spring, or press it on a scale:"
            f" it gives way by {in_unit(largest, 'm', 3)}. Read both lengths to"
            f" {in_unit(read, 'm')} for {text}; or take the slope of several masses."
        )
    if name == "compression":
        return (
            f"Set it against a stop or a scale that is good to {text}, anew for each run; its zero"
            " is where the spring just touches."
        )
    return PLAIN.get(name, "Measure it to {needed}.").format(needed=text)


def otherwise(mechanism: Mechanism, law: FrictionLaw, share: float) -> Mapping[str, str]:
    """Return ways to measure the level at rest as well as travels tell that of sliding.

    Parameters
    ----------
    mechanism : Mechanism
        The rig as it stands.
    law : FrictionLaw
        The law with its plausible values.
    share : float
        Standard uncertainty of the kinetic level over itself.
    """
    known = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    level = float(law.break_away(1.0))
    names = ("mechanism.mass", "mechanism.gravity")
    if level <= 0.0 or not all(name in known for name in names) or not math.isfinite(share):
        return {}
    weight = math.prod(known[name] for name in names)
    slope = known.get("mechanism.incline", 0.0)
    pressed, down = weight * math.cos(slope), weight * math.sin(slope)
    pull = max(level * pressed + down, 0.0)
    angle = math.degrees(math.atan(level))
    read = math.degrees(share * level / (1.0 + level**2))
    found = {
        "$mu_s$ by tilt": (
            "Raise the track until the block just slides: $mu_s$ is the tangent of the angle, about"
            f" {number(angle, 2)}° for {number(level, 2)}. Read it to {number(read, 1)}° to know"
            " $mu_s$ as well as $mu_k$."
        ),
        "$mu_s$ by a slow pull": (
            f"Pull uphill until the block slides: the largest force, about {in_unit(pull, 'N')},"
            f" less {in_unit(down, 'N', 3)} of weight along the ground, over the normal force of"
            f" {in_unit(pressed, 'N', 3)}. Read it to {in_unit(share * level * pressed, 'N', 1)}."
            if slope
            else f"It is the largest force before the block slides over its weight, about"
            f" {in_unit(pull, 'N')} at a weight of {in_unit(weight, 'N', 3)}. Read it to"
            f" {in_unit(share * level * weight, 'N', 1)}."
        ),
    }
    stiffness = known.get("mechanism.stiffness", 0.0)
    if stiffness > 0.0 and known.get("mechanism.compression", 0.0):
        least = in_unit(pull / stiffness, "m")
        said = "the force of a slow pull over $k$" if slope else "$mu_s$ $m$ $g$ / $k$"
        found["$mu_s$ by the spring"] = (
            f"The least compression that starts the block is {said}, about {least}."
        )
    return found
