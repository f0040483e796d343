"""What to measure before the runs of a plan, by which simple means, and how well."""

import math
from collections.abc import Mapping

from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, parameters
from stickslip.show.formatting import number, quantity

PLAIN = {
    "mass": "Weigh all sliding parts, to {needed}.",
    "level": "Measure the push with the force sensor that will record it, to {needed}.",
    "amplitude": "Measure the force with the sensor that will record it, to {needed}.",
    "duration": "Determine the push from a record of its force, to {needed}.",
    "incline": "Measure the rise of the track over its length, or its angle, to {needed}.",
    **dict.fromkeys(("lower_stop", "upper_stop"), "Measure where the stop is, to {needed}."),
}
"""How to measure a parameter, by its last name, where nothing has to be computed for it."""
LIFTED = 20.0
"""Largest mass that is hung on a spring [kg]; what needs more is pressed."""


def how_to(mechanism: Mechanism, path: str, needed: float, largest: float) -> str:
    """Return how a parameter of a mechanism is measured well enough."""
    known: Mapping[str, tuple[Quantity, float]] = {
        name: (q, value) for name, q, value in parameters(mechanism, "mechanism")
    }
    unit, value = known[path][0].unit, known[path][1]
    name = path.rpartition(".")[2]
    text = quantity(needed, unit, 2, degrees=True)
    if name == "stiffness" and "mechanism.gravity" in known and value > 0.0 and largest > 0.0:
        load = value * largest / known["mechanism.gravity"][1]
        read = quantity(needed / value * largest / math.sqrt(2.0), "m", 2)  # two readings
        length = quantity(largest, "m")
        if load > LIFTED:
            return (
                f"Compress the spring by {length} against a load cell (range at least"
                f" {number(value * largest)} N). Measure both lengths to {read} to reach {text},"
                " or take the slope over several loads."
            )
        return (
            f"Hang {quantity(load, 'kg')} on the spring, or press it onto a scale: its length"
            f" changes by {length}. Measure both lengths to {read} to reach {text}, or take the"
            " slope over several masses."
        )
    if name == "mass" and known.get("mechanism.stiffness", (None, 0.0))[1]:
        plain = PLAIN[name].format(needed=text)
        return f"{plain} A third of the spring's mass moves with the body: use a light spring."
    if name == "compression":
        return (
            f"Set it anew for each run, against a stop or a scale accurate to {text}. Its zero is"
            " where the spring just touches the body."
        )
    return PLAIN.get(name, "Measure it to {needed}.").format(needed=text)


def otherwise(mechanism: Mechanism, law: FrictionLaw, share: float) -> Mapping[str, str]:
    """Return ways to measure the level at rest as well as travels tell that of sliding."""
    known = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    level = float(law.break_away(1.0))
    names = ("mechanism.mass", "mechanism.gravity")
    if level <= 0.0 or not all(name in known for name in names) or not math.isfinite(share):
        return {}
    weight = math.prod(known[name] for name in names)
    slope = known.get("mechanism.incline", 0.0)
    # the way of the run: a spring on the other side drives the block the other way
    way = math.copysign(1.0, known.get("mechanism.compression", 0.0) or 1.0)
    pressed, along = weight * math.cos(slope), way * weight * math.sin(slope)
    pull = max(level * pressed + along, 0.0)
    angle = math.degrees(math.atan(level))
    read = math.degrees(share * level / (1.0 + level**2))
    force = quantity(share * level * pressed, "N", 1)
    found = {
        "$mu_s$ by tilt": (
            "Raise the track until the block just slides: $mu_s$ is the tangent of the angle, about"
            f" {number(angle, 2)}° for {number(level, 2)}. Read it to {number(read, 1)}° to know"
            " $mu_s$ as well as $mu_k$."
        ),
        "$mu_s$ by a slow pull": (
            f"Pull {'uphill' if along > 0.0 else 'downhill'} until the block slides: the largest"
            f" force, about {quantity(pull, 'N', 2)}, {'less' if along > 0.0 else 'plus'}"
            f" {quantity(abs(along), 'N')} of weight along the track, over the normal force of"
            f" {quantity(pressed, 'N')}. Read it to {force}."
            if slope
            else f"Pull until the block slides: $mu_s$ is the largest force, about"
            f" {quantity(pull, 'N', 2)}, over the weight of {quantity(weight, 'N')}. Read it to"
            f" {force}."
        ),
    }
    stiffness = known.get("mechanism.stiffness", 0.0)
    if stiffness > 0.0 and known.get("mechanism.compression", 0.0) and pull > 0.0:
        least = quantity(pull / stiffness, "m", 2)
        said = "the force of a slow pull over $k$" if slope else "$mu_s$ $m$ $g$ / $k$"
        found["$mu_s$ by the spring"] = (
            f"The least compression that starts the block is {said}, about {least}."
        )
    return found
