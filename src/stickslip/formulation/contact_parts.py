"""Parts of the equations of a mechanism with several contacts; no mode enters them.

They are the mass matrix, the forces without friction, the loads, how the contacts slip, and each
law once for each structure. What holds in which mode is worked out by the kernels: with n contacts
there would be 3^n sets of equations to derive.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import symengine as se

from stickslip.errors import InputError, UnknownNameError
from stickslip.formulation.linearity import linear_where
from stickslip.formulation.load_factor import load_factor, unknown_kind
from stickslip.formulation.mechanics import lagrange_rows
from stickslip.formulation.trace import Switchboard, Traced, collapsed, expression
from stickslip.friction import BristleLaw, FrictionLaw, SetValuedLaw, towards
from stickslip.kernels.header import LAW_NUMBERS
from stickslip.mechanisms import Contact, Mechanism, stops_of
from stickslip.quantities import parameters, shadow

__all__ = ["AnyForce", "ContactParts", "LawParts", "derive_parts", "law_parts"]


@dataclass(frozen=True)
class ContactParts:
    """Equations of motion ``M q'' + W F = h`` of a mechanism, and where it rubs."""

    coordinates: tuple[str, ...]
    """Names of the moving coordinates."""
    held: tuple[str, ...]
    """Names of the held ones, those that normal forces act on first."""
    contacts: tuple[str, ...]
    """Names of the contacts that rub."""
    slips: tuple[int, ...]
    """Index of the coordinate along which each of them slips."""
    factors: tuple[se.Expr, ...]
    """Slip velocity of each over the rate of its coordinate."""
    held_slips: tuple[tuple[se.Expr, ...], ...]
    """How friction of each acts on each held coordinate."""
    held_normals: tuple[tuple[se.Expr, ...], ...]
    """How a unit of load of each acts on each held coordinate."""
    reacts: tuple[bool, ...]
    """Whether the load of each is a reaction."""
    mass: Mapping[tuple[int, int], se.Expr]
    """Entries of the lower triangle of the mass matrix, and of the rows of held coordinates."""
    forces: tuple[se.Expr, ...]
    """Forces on the moving coordinates, then on the held ones, friction left out."""
    loads: tuple[se.Expr, ...]
    """Prescribed load of each contact, 0 where it is a reaction."""
    energy: se.Expr
    """Kinetic and potential energy [J]."""
    supplied: se.Expr
    """Power that drives, dampers and moved supports put in [W]."""


def derive_parts(
    mechanism: Mechanism,
    rubbing: Sequence[str],
    t: se.Symbol,
    q: Mapping[str, se.Symbol],
    q_dot: Mapping[str, se.Symbol],
    drives: Mapping[str, se.Symbol],
    board: Switchboard,
) -> ContactParts:
    """Trace the energies, forces and contacts of a mechanism whose parameters are symbols.

    Parameters
    ----------
    mechanism : Mechanism
        Mechanism whose parameters are symbols.
    rubbing : sequence of str
        Names of the contacts that have a law.
    t : Symbol
        Time [s].
    q : mapping of str to Symbol
        Symbols of the coordinates by name, in their order.
    q_dot : mapping of str to Symbol
        Symbols of the rates by name of the coordinate.
    drives : mapping of str to Symbol
        Symbols of the drives' values by name.
    board : Switchboard
        Collects the switches met in the energies and forces.

    Returns
    -------
    ContactParts
        The parts.

    Raises
    ------
    InputError
        If the mechanism has what this version does not do with several contacts, or its contacts
        do not determine what they should.
    """
    contacts = tuple(one for one in mechanism.contacts() if one.name in rubbing)
    held = _held(mechanism, contacts)
    _refuse(mechanism)
    rows = lagrange_rows(mechanism, t, q, q_dot, drives, held, board)
    loads = _loads(mechanism, contacts, t, q, q_dot, drives, board)
    n = len(q)
    mass = {
        (i, j): entry
        for i, row in enumerate(rows.mass)
        for j, entry in enumerate(row)
        if entry != 0 and (i >= n or j <= i)
    }
    slips = [_slip(mechanism, one, list(q)) for one in contacts]
    _check_shares(mechanism, contacts, slips, held)
    return ContactParts(
        coordinates=tuple(q),
        held=held,
        contacts=tuple(one.name for one in contacts),
        slips=tuple(index for index, _ in slips),
        factors=tuple(factor for _, factor in slips),
        held_slips=tuple(_along(_table(one.slip), held) for one in contacts),
        held_normals=tuple(_along(_table(one.normal), held) for one in contacts),
        reacts=tuple(one.normal is not None for one in contacts),
        mass=mass,
        forces=tuple(rows.forces),
        loads=loads,
        energy=rows.energy,
        supplied=rows.supplied,
    )


def _table(direction: str | Mapping[str, object] | None) -> dict[str, se.Expr]:
    """Return a direction as factors by coordinate."""
    if direction is None:
        return {}
    if isinstance(direction, str):
        return {direction: se.Integer(1)}
    return {name: expression(factor) for name, factor in direction.items()}


def _along(table: Mapping[str, se.Expr], held: Sequence[str]) -> tuple[se.Expr, ...]:
    return tuple(table.get(name, se.Integer(0)) for name in held)


def _held(mechanism: Mechanism, contacts: Sequence[Contact]) -> tuple[str, ...]:
    """Return the held coordinates, those that normal forces act on first."""
    normals = dict.fromkeys(name for one in contacts for name in _table(one.normal))
    others = [name for name in mechanism.held() if name not in normals]
    owner = type(mechanism).__name__
    for name in (*normals, *others):
        if name in mechanism.coordinates:
            raise InputError(
                f"{owner} holds {name!r} at 0, but that coordinate moves: give held coordinates"
                " names of their own."
            )
    reacting = [one.name for one in contacts if one.normal is not None]
    idle = [
        one.name
        for one in mechanism.contacts()
        if one.normal is not None and one.name not in reacting
    ]
    if idle:  # its reaction holds a coordinate, and has to be watched for lift-off
        raise InputError(
            f"{owner}: {', '.join(idle)} has no law but carries load: give it a law with levels of"
            " 0, such as Coulomb(kinetic_coefficient=0.0), where nothing rubs."
        )
    if len(reacting) != len(normals):
        raise InputError(
            f"{owner}: the loads of {', '.join(reacting)} are not determined by the"
            f" {len(normals)} held coordinates {', '.join(normals)}: give one of them a load, or"
            " let a support give way."
        )
    return (*normals, *others)


def _refuse(mechanism: Mechanism) -> None:
    """Refuse what is not done with several contacts yet."""
    owner = type(mechanism).__name__
    for what, given in (
        ("hard stops", stops_of(mechanism)),
        ("prescribed motions", mechanism.guided()),
        ("limits", mechanism.limits(AnyForce())),
    ):
        if given:
            raise InputError(
                f"{owner} has several contacts and {what}, which this version does not combine:"
                f" leave the {what} out, or let all contacts but one have no law (None)."
            )


class AnyForce(dict[str, float]):
    """Answers any name of a force: whether there are limits is all that is asked."""

    def __missing__(self, name: str) -> float:
        return 1.0


def _slip(mechanism: Mechanism, contact: Contact, coordinates: list[str]) -> tuple[int, se.Expr]:
    """Return the coordinate along which a contact slips, and the factor of its rate."""
    table = _table(contact.slip)
    for name in table:
        if (
            name not in coordinates
            and name not in _table(contact.normal)
            and (name not in mechanism.held())
        ):
            raise UnknownNameError(f"coordinate in the slip of {contact.name}", name, coordinates)
    moving = [name for name in table if name in coordinates]
    owner = f"{type(mechanism).__name__}: the contact {contact.name!r}"
    if not moving:
        raise InputError(f"{owner} slips along no moving coordinate.")
    if len(moving) > 1:
        raise InputError(
            f"{owner} slips along {' and '.join(moving)}; this version needs its slip to be a"
            " coordinate: use relative coordinates."
        )
    factor = table[moving[0]]
    if factor == 0:
        raise InputError(f"{owner} has the factor 0 for {moving[0]}: leave the contact out.")
    return coordinates.index(moving[0]), factor


def _check_shares(
    mechanism: Mechanism,
    contacts: Sequence[Contact],
    slips: Sequence[tuple[int, se.Expr]],
    held: Sequence[str],
) -> None:
    """Refuse reactions that depend on how contacts of one coordinate share what holds it."""
    if all(one.normal is None for one in contacts):
        return
    known: dict[int, tuple[str, list[se.Expr]]] = {}
    for one, (index, factor) in zip(contacts, slips, strict=True):
        arms = [se.expand(e / factor) for e in _along(_table(one.slip), held)]
        other, expected = known.setdefault(index, (one.name, arms))
        if arms != expected:
            raise InputError(
                f"{type(mechanism).__name__}: the contacts {other!r} and {one.name!r} slip along"
                " one coordinate but act differently on the held ones, so that the loads depend on"
                " how they share friction while they stick: let them slip at the same height."
            )


def _loads(
    mechanism: Mechanism,
    contacts: Sequence[Contact],
    t: se.Symbol,
    q: Mapping[str, se.Symbol],
    q_dot: Mapping[str, se.Symbol],
    drives: Mapping[str, se.Symbol],
    board: Switchboard,
) -> tuple[se.Expr, ...]:
    """Return the prescribed loads, 0 where a load is a reaction."""
    traced = [{k: Traced(s, board) for k, s in given.items()} for given in (q, q_dot, drives)]
    given = mechanism.loads(Traced(t, board), *traced)
    known = [one.name for one in mechanism.contacts()]
    for name in given:
        if name not in known:
            raise UnknownNameError(f"contact in {type(mechanism).__name__}.loads", name, known)
    found = []
    for one in contacts:
        prescribed = given.get(one.name, one.load)
        if one.normal is not None and prescribed is not None:
            raise InputError(
                f"{type(mechanism).__name__}: the load of the contact {one.name!r} is the reaction"
                " of its normal coordinate and cannot be prescribed too."
            )
        if one.normal is None and prescribed is None:
            raise InputError(
                f"{type(mechanism).__name__}: the contact {one.name!r} has neither a normal"
                " coordinate nor a load: give one of them."
            )
        found.append(se.Integer(0) if one.normal is not None else expression(prescribed))
    return tuple(found)


@dataclass(frozen=True)
class LawParts:
    """What kernels ask of a law of one structure, by direction of slip."""

    numbers: Mapping[int, Sequence[se.Expr]]
    """As `kernels.contacts.assembly.ask_law` writes them."""
    slopes: Mapping[int, Sequence[se.Expr]]
    """Derivatives of constant and factor of friction and level, and of the rates of bristles, with
    respect to speed, parameters, bristles and load: a row each."""
    margins: Sequence[se.Expr]
    """Margins of its switches."""
    margin_slopes: Sequence[se.Expr]
    """Their derivatives with respect to the same."""
    switch_events: tuple[tuple[str, str] | None, ...]
    """What each switch is called in events, when it comes true and when it ceases to hold."""

    @property
    def is_linear(self) -> bool:
        """Whether friction is affine in the speed, and no switch changes how."""
        return not self.margins and all(case[6] == 1 for case in self.numbers.values())


def law_parts(law: FrictionLaw, bristles: int) -> LawParts:
    """Trace a law: y0 is the slip speed, then come its parameters, its bristles and its load.

    These are the variables along which slopes are taken, in this order.

    Parameters
    ----------
    law : FrictionLaw
        The law; its values do not matter.
    bristles : int
        How many bristle states it has.

    Returns
    -------
    LawParts
        Its numbers in both directions of slip.

    Raises
    ------
    InputError
        If the law holds its contact by a rule of its own beside its bristles.
    TracingError
        If friction is not affine in the load.
    """
    if isinstance(law, BristleLaw) and law.static_switch:
        raise InputError(
            f"{type(law).__name__}(static_switch=True) holds one contact; with several, use"
            " static_switch=False."
        )
    board = Switchboard()
    paths = [path for path, _, _ in parameters(law, "friction")]
    place = {path: i + 1 for i, path in enumerate(paths)}
    twin = shadow(law, "friction", lambda path: Traced(se.Symbol(f"y{place[path]}"), board))
    speed, load = se.Symbol("y0"), se.Symbol("N")
    states = tuple(se.Symbol(f"y{len(paths) + 1 + k}") for k in range(bristles))
    own_load = se.Symbol(f"y{len(paths) + 1 + bristles}")
    variables = [speed, *(se.Symbol(f"y{place[path]}") for path in paths), *states, own_load]
    numbers, slopes = {}, {}
    for side in (1, -1):
        one = towards(twin, side)
        rates: list[se.Expr] = []
        if isinstance(one, SetValuedLaw):
            board.signs = {"y0": 1}
            friction = expression(one.sliding(Traced(speed, board), Traced(load, board)))
        elif isinstance(one, BristleLaw):
            board.signs = {"y0": 1}
            arguments = (
                Traced(side * speed, board),
                tuple(Traced(z, board) for z in states),
                Traced(load, board),
            )
            friction = side * expression(one.force(*arguments))
            rates = [expression(rate) for rate in one.bristle_rates(*arguments)]
        else:
            raise unknown_kind(law)
        board.signs = {}
        level = expression(one.break_away(Traced(load, board)))
        factor, level_factor = (load_factor(law, part, load) for part in (friction, level))
        constant, level_constant = friction.subs({load: 0}), level.subs({load: 0})
        flags = [switch.symbol for switch in board.switches.values()]
        linear = linear_where([constant, factor], [speed], flags)
        if rates or se.expand(collapsed(factor.diff(speed))) != 0:
            linear = se.Integer(0)
        numbers[side] = [
            constant,
            factor,
            level_constant,
            level_factor,
            collapsed(constant.diff(speed)),
            collapsed(factor.diff(speed)),
            linear,
            *[rate.subs({load: own_load}) for rate in rates],
        ]
        case = [*numbers[side][:4], *numbers[side][LAW_NUMBERS:]]
        slopes[side] = [e.diff(x) for e in case for x in variables]
    margins = [switch.margin for switch in board.switches.values()]
    return LawParts(
        numbers=numbers,
        slopes=slopes,
        margins=margins,
        margin_slopes=[e.diff(x) for e in margins for x in variables],
        switch_events=tuple(switch.events for switch in board.switches.values()),
    )
