"""The equations of a law with its parameters as symbols, one expression for each sense of slip."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeAlias, final

import symengine as se

from stickslip.errors import InputError, TracingError
from stickslip.exports.identifiers import identifiers
from stickslip.formulation import Switchboard, Traced, collapsed, expression
from stickslip.friction import (
    FrictionLaw,
)
from stickslip.quantities import Quantity, parameters, shadow

__all__ = ["LOCAL", "BySense", "Equations", "Parameter", "equations_of"]

Values: TypeAlias = tuple[se.Expr, ...]

LOCAL: Final = (
    "velocity", "load", "force", "applied", "mass", "period", "direction", "speed", "width",
    "factor", "normal", "displacement", "friction", "sticks", "steady", "level", "velocity_end",
    "speed_end", "share", "used", "rest", "sense", "pivot", "ahead", "back", "rates",
    "break_away", "step", "slide", "departure", "compensation", "slip", "x", "v", "along",
    "v_start", "force_v", "speed_mid", "first_v", "second_v", "rate", "drop", "low", "miss",
    "miss_low", "tried", "miss_tried", "scale", "shift", "turn", "settle", "implicit", "inertia",
    "torque", "each",
)  # fmt: skip
"""Names that programs use themselves."""
OF_BRISTLES: Final = ("{}_end", "{}_rate")
"""Names that they make of each bristle state."""


@final
@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter of a law in programs."""

    name: str
    """Name of the field."""
    identifier: str
    """Name in programs."""
    quantity: Quantity
    """Symbol and unit."""
    value: float
    """Value [SI]."""


@final
@dataclass(frozen=True, kw_only=True)
class BySense:
    """What holds in forward slip, in backward slip and at rest."""

    ahead: Values
    """At velocities above 0."""
    back: Values
    """At velocities below 0."""
    rest: Values
    """At velocity 0."""


@final
@dataclass(frozen=True, kw_only=True)
class Equations:
    """A law as expressions of the symbols `velocity`, `load`, its bristles and its parameters."""

    parameters: tuple[Parameter, ...]
    """Those that stand in the equations."""
    bristles: tuple[str, ...]
    """Names of the bristle states in programs."""
    slip: BySense
    """Friction force, then the rates of the bristles."""
    steady: BySense | None
    """Friction force of steady sliding, of laws with bristles."""
    break_away: tuple[se.Expr, se.Expr]
    """Levels that rest gives way to, forward and backward."""
    holds: bool
    """Whether a body is held at rest by a force of any size up to break-away."""


VELOCITY, LOAD = se.Symbol("velocity"), se.Symbol("load")


def equations_of(law: FrictionLaw) -> Equations:
    """Return the equations of a law, whoever wrote it.

    Parameters
    ----------
    law : FrictionLaw
        The law with its values.

    Returns
    -------
    Equations
        Its equations, with names that all languages accept.

    Raises
    ------
    InputError
        If it is no friction law, or not written with `stickslip.maths` alone.

    Examples
    --------
    >>> from stickslip import CoulombViscous
    >>> found = equations_of(CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=3.0))
    >>> found.slip.ahead, found.slip.back, found.slip.rest
    ((load*mu_k + sigma_2*velocity,), (-(load*mu_k - sigma_2*velocity),), (0,))
    """
    if not isinstance(law, FrictionLaw):
        raise InputError(
            f"{law!r} is no friction law that can be exported: give one such as Coulomb(...), a"
            " fit, a verdict, or a rig with one law."
        )
    found = list(parameters(law, "friction"))
    states = identifiers(law.states, LOCAL)
    taken = (*LOCAL, *states, *(form.format(z) for z in states for form in OF_BRISTLES))
    names = identifiers([quantity.symbol for _, quantity, _ in found], taken)
    symbols = {path: name for (path, _, _), name in zip(found, names, strict=True)}
    try:
        return Equations(
            parameters=tuple(
                Parameter(
                    name=path.removeprefix("friction."),
                    identifier=symbols[path],
                    quantity=quantity,
                    value=float(value),
                )
                for path, quantity, value in found
            ),
            bristles=states,
            slip=_by_sense(law, symbols, lambda twin, v, load: _slip(twin, v, _z(states, v), load)),
            steady=_by_sense(law, symbols, lambda twin, v, load: (twin.steady(v[0], load),))
            if law.states
            else None,
            break_away=_levels(law, symbols),
            holds=law.holds,
        )
    except TracingError as error:
        raise InputError(
            f"{type(law).__name__} cannot be exported: {error}. See 'Write your own friction law'."
        ) from error


At: TypeAlias = tuple[Any, Switchboard]
"""A velocity, and what collects the switches of its sense."""


def _z(states: tuple[str, ...], at: At) -> tuple[Traced, ...]:
    return tuple(Traced(se.Symbol(name), at[1]) for name in states)


def _slip(law: Any, at: At, bristles: tuple[Traced, ...], load: Traced) -> tuple[Any, ...]:
    arguments = at[0], load, bristles
    return (law.force(*arguments), *law.rates(*arguments))


def _by_sense(
    law: FrictionLaw,
    names: dict[str, str],
    evaluate: Callable[[Any, At, Traced], tuple[Any, ...]],
) -> BySense:
    """Evaluate a law in both senses of slip and at rest."""

    def traced(sense: int) -> Values:
        board = Switchboard(signs={"velocity": sense} if sense else {})
        twin = shadow(law, "friction", lambda path: Traced(se.Symbol(names[path]), board))
        velocity = Traced(VELOCITY, board) if sense else 0.0
        values = evaluate(twin, (velocity, board), Traced(LOAD, board))
        return tuple(_closed(expression(value), board) for value in values)

    return BySense(ahead=traced(1), back=traced(-1), rest=traced(0))


def _levels(law: FrictionLaw, names: dict[str, str]) -> tuple[se.Expr, se.Expr]:
    board = Switchboard()
    twin = shadow(law, "friction", lambda path: Traced(se.Symbol(names[path]), board))
    load = Traced(LOAD, board)
    ahead, back = (twin.towards(side).break_away(load) for side in (1, -1))
    return _closed(expression(ahead), board), _closed(expression(back), board)


def _closed(e: se.Expr, board: Switchboard) -> se.Expr:
    """Put the margins of switches in place of their symbols; a margin may have switches too."""
    for one in reversed(board.switches.values()):
        e = e.subs({one.symbol: one.margin})
    return collapsed(e)
