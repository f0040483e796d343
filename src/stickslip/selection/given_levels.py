"""Break-away levels that were given, not fitted, and that the measurement refutes directly."""

from collections.abc import Collection

from stickslip.errors import ParameterError
from stickslip.experiments import levels_at
from stickslip.formatting import number, quantity
from stickslip.friction import FrictionLaw, anywhere
from stickslip.mechanisms import Mechanism
from stickslip.quantities import fields_of, parameters, vary

STEP = 1e-3
"""Relative change of a parameter that shows whether the break-away level depends on it."""
CLEAR = 0.2
"""Share by which friction at rest must stay below a level that is said to be refuted."""
RESTED = 5
"""Samples of a rest at least."""


def given_level(law: FrictionLaw, held: Collection[str]) -> str:
    """Return the name of the held parameter that sets the break-away level of a law.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.3)
    >>> given_level(law, ["static_coefficient"]), given_level(law, ["kinetic_coefficient"])
    ('static_coefficient', '')
    """
    level, found = anywhere(law).break_away(1.0), []
    for path, _, value in parameters(law, "friction"):
        for factor in (1.0 + STEP, 1.0 - STEP):
            try:
                other = vary(law, "friction", {path: factor * value})
            except ParameterError:  # a level at rest may not fall below that of sliding
                continue
            if anywhere(other).break_away(1.0) != level:
                found.append(path.rpartition(".")[2])
                break
    return found[0] if len(found) == 1 and found[0] in held else ""


def level_text(mechanism: Mechanism, friction: float, load: float) -> str:
    """Return friction at rest as levels of a law on this mechanism are given, with its unit.

    Examples
    --------
    >>> from stickslip import Axis, SpringBlock
    >>> level_text(SpringBlock(mass=1.0), 2.0, 10.0), level_text(Axis(inertia=1.0), 2.0, 1.0)
    ('0.2 N/N', '2 N')
    """
    levels = levels_at(mechanism)
    if levels == "per load":
        return f"{number(friction / load)} N/N"
    return quantity(friction, "N m" if levels == "torques" else "N")


def given_text(law: FrictionLaw, name: str) -> str:
    """Return a value that was given, with symbol and unit, as part of a sentence."""
    of = fields_of(type(law))[name]
    return f"given ${of.symbol}$ = {quantity(getattr(law, name), of.unit)}"
