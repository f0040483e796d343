"""The equations of a law with its parameters as symbols, one expression for each sense of slip."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias, final

import symengine as se

from stickslip.errors import InputError, TracingError
from stickslip.exports.identifiers import identifiers
from stickslip.formulation import Switchboard, Traced, collapsed, expression
from stickslip.friction import FrictionLaw, bound
from stickslip.maths import Latches
from stickslip.quantities import Quantity, parameters, shadow

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
    flags: tuple[str, ...]
    """Names of what tells whether latched switches are on, 1 or 0."""
    inputs: Mapping[str, str]
    """Contact inputs by their names in programs."""
    slip: BySense
    """Friction force, then the rates of the bristles."""
    moved: BySense | None
    """Bristles after a `period` at a velocity, of laws that have a formula for them."""
    steady: BySense | None
    """Friction force of steady sliding, of laws with bristles."""
    break_away: tuple[se.Expr, se.Expr]
    """Levels that rest gives way to, forward and backward."""
    holds: bool
    """Whether a body is held at rest by a force of any size up to break-away."""
    drops: bool
    """Whether the force falls at once where a bristle gives way."""


VELOCITY, LOAD, PERIOD = map(se.Symbol, ("velocity", "load", "period"))


def equations_of(law: FrictionLaw) -> Equations:
    """Return the equations of a law, whoever wrote it.

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
    states = identifiers((*law.states, *_flags(law)), LOCAL)
    own = identifiers(law.inputs, (*LOCAL, *states))
    inputs = dict(zip(own, law.inputs, strict=True))
    taken = (*LOCAL, *states, *inputs, *(form.format(z) for z in states for form in OF_BRISTLES))
    names = identifiers([quantity.symbol for _, quantity, _ in found], taken)
    symbols = {path: name for (path, _, _), name in zip(found, names, strict=True)}

    def traced(board: Switchboard) -> FrictionLaw:
        twin = shadow(law, "friction", lambda path: Traced(se.Symbol(symbols[path]), board))
        return bound(twin, {one: Traced(se.Symbol(name), board) for name, one in inputs.items()})

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
            bristles=states[: len(law.states)],
            flags=states[len(law.states) :],
            inputs=inputs,
            slip=_by_sense(traced, states, _slip),
            moved=_by_sense(traced, states, _moved) if _has_formula(law) else None,
            steady=_by_sense(traced, states, lambda twin, v, load, _: (twin.steady(v[0], load),))
            if law.states
            else None,
            break_away=_levels(traced),
            holds=law.holds,
            drops=law.made_of is not None and law.made_of.drops,
        )
    except TracingError as error:
        raise InputError(
            f"{type(law).__name__} cannot be exported: {error}. See 'Write your own friction law'."
        ) from error


At: TypeAlias = tuple[Any, Switchboard]
"""A velocity, and what collects the switches of its sense."""


def _slip(law: Any, at: At, load: Traced, states: tuple[Traced, ...]) -> tuple[Any, ...]:
    arguments = at[0], load, states
    return (law.force(*arguments), *law.rates(*arguments))


def _moved(law: Any, at: At, load: Traced, states: tuple[Traced, ...]) -> tuple[Any, ...]:
    """Return the states after a period, and whether each latched switch is on then."""
    found = law.moved(at[0], load, states, Traced(PERIOD, at[1]))
    after = (
        se.Piecewise((se.Integer(1), at[1].deciding(one) > 0), (se.Integer(0), True))
        for one in at[1].switches.values()
        if one.hold is not None
    )
    return (*found, *(Traced(one, at[1]) for one in after))


def _has_formula(law: FrictionLaw) -> bool:
    with Latches():
        return _told(law).moved(0.0, 1.0, (0.0,) * len(law.states), 1.0) is not None


def _told(law: FrictionLaw) -> FrictionLaw:
    """Return a law that can be asked for its switches, whatever its contact inputs are."""
    return bound(law, dict.fromkeys(law.inputs, 1.0))


def _flags(law: FrictionLaw) -> tuple[str, ...]:
    """Return names of the latched switches of the rates of a law."""
    latches = Latches()
    with latches:
        _told(law).rates(1.0, 1.0, (0.0,) * len(law.states))
    if latches and (law.holds or not _has_formula(law)):
        raise InputError(
            f"{type(law).__name__} cannot be exported: it has latched switches, which exports"
            " follow with a formula for constant velocity and without static_switch. An FMU of the"
            " rig does: --to fmu."
        )
    return tuple(f"slips{i + 1}" for i in range(len(latches.flags)))


TracedLaw: TypeAlias = Callable[[Switchboard], FrictionLaw]
"""Makes a law of symbols, whose switches are collected."""


def _by_sense(
    law: TracedLaw,
    states: tuple[str, ...],
    evaluate: Callable[[Any, At, Traced, tuple[Traced, ...]], tuple[Any, ...]],
) -> BySense:
    """Evaluate a law in both senses of slip and at rest, where no latched switch is on."""

    def traced(sense: int) -> Values:
        board = Switchboard(signs={"velocity": sense} if sense else {})
        velocity = Traced(VELOCITY, board) if sense else 0.0
        twin = law(board)
        count = len(twin.states)
        z = tuple(Traced(se.Symbol(name), board) for name in states[:count])
        values = evaluate(twin, (velocity, board), Traced(LOAD, board), z)
        flags = [se.Symbol(name) if sense else se.Integer(0) for name in states[count:]]
        return tuple(_closed(expression(value), board, flags) for value in values)

    return BySense(ahead=traced(1), back=traced(-1), rest=traced(0))


def _levels(law: TracedLaw) -> tuple[se.Expr, se.Expr]:
    board = Switchboard()
    load = Traced(LOAD, board)
    ahead, back = (law(board).towards(side).break_away(load) for side in (1, -1))
    return _closed(expression(ahead), board), _closed(expression(back), board)


def _closed(e: se.Expr, board: Switchboard, flags: Sequence[se.Expr] = ()) -> se.Expr:
    """Put the margins of switches in place of their symbols; a margin may have switches too.

    In place of those of latched ones stand their flags, in their order.
    """
    latched = [one.symbol for one in board.switches.values() if one.hold is not None]
    return collapsed(board.settled(e).subs(dict(zip(latched, flags, strict=False))))
