"""Coordinates along which contacts slip: a constant change of coordinates where theirs are sums.

Kernels hold a contact by leaving a coordinate out, so that each independent slip has to be one. A
slip that is a sum over several moving coordinates takes the place of one of them. Contacts whose
slips are multiples of each other are along one coordinate. A slip that follows from those of others
closes a loop and has no coordinate of its own.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import symengine as se
from numpy.typing import NDArray

from stickslip.engine.formulation.trace import expression
from stickslip.errors import InputError, UnknownNameError
from stickslip.mechanisms import Contact, Mechanism, stops_of
from stickslip.show.formatting import joined, number

MOST_TRIALS = 1500
"""Most sets of held contacts that are tried for the cuts of one loop."""
ZERO = se.Integer(0)
SINGULAR = 1e-12
"""Volume of slips of length 1 below which they count as dependent: digits are gone by then."""
Row = Mapping[int, se.Expr]
Entries = tuple[se.Expr, ...]


@dataclass(frozen=True)
class Loops:
    """Closing slips and cuts, over the coordinates of the equations."""

    closing: tuple[Entries, ...] = ()
    """Factors of the coordinates in each closing slip."""
    cuts: tuple[Entries, ...] = ()
    """Rates of the coordinates in the motion of each cut."""
    crossings: tuple[Entries, ...] = ()
    """Rate of each closing slip in the motion of each cut."""
    looped: frozenset[int] = frozenset()
    """Indices of the coordinates that have a part in a loop."""

    def numbers(self) -> list[se.Expr]:
        """Return closing slips, cuts and crossings row by row, as kernels read them."""
        return [e for row in (*self.closing, *self.cuts, *self.crossings) for e in row]


NO_LOOPS = Loops()
"""Of contacts whose slips are independent."""


def vanishes(e: se.Expr) -> bool:
    """Whether an expression of parameters is 0, whatever these are: tried for two sets of them."""
    if se.expand(e) == 0:
        return True
    symbols = sorted(e.free_symbols, key=str)
    return not any(abs(complex(e.subs(numbers))) > 1e-9 for numbers in _trials(symbols))


def _trials(symbols: Sequence[se.Symbol]) -> Iterator[dict[se.Symbol, float]]:
    """Yield two sets of values for parameters."""
    for seed in (0.7548776662, 0.5698402909):  # irrational, so that nothing cancels by chance
        yield {symbol: 1.0 + (k * seed) % 1.0 for k, symbol in enumerate(symbols, 1)}


def trials_of(closing: Sequence[Entries]) -> list[tuple[list[int], int]]:
    """Return how many sets of held contacts are tried for the cuts of each loop."""
    result = []
    for own in _components(closing):
        # Held are s - 1 of the s coordinates and the closing slips: what is left is one motion.
        s = len({j for d in own for j, e in enumerate(closing[d]) if e != 0})
        result.append((own, math.comb(s + len(own), s - 1)))
    return result


def loops_of(closing: Sequence[Entries]) -> Loops | None:
    """Return the cuts of the loops that some slips close."""
    cuts: list[Entries] = []
    crossings: list[Entries] = []
    # Loops without a coordinate in common break open by themselves.
    for own, trials in trials_of(closing):
        if trials > MOST_TRIALS:
            return None
        support = sorted({j for d in own for j, e in enumerate(closing[d]) if e != 0})
        n, s = len(closing[0]), len(support)
        units = [tuple(se.Integer(j == k) for k in support) for j in support]
        rows = [*units, *(tuple(closing[d][k] for k in support) for d in own)]
        seen: dict[tuple[bool, ...], list[list[se.Expr]]] = {}
        # A cut is a motion in which all but one of the independent slips hold.
        for held in combinations(rows, s - 1):
            motion = _motion(held, s)
            if motion is None:
                continue
            crossed = [_exact(_product(row, motion)) for row in rows]
            same = seen.setdefault(tuple(e == 0 for e in crossed), [])
            # multiples by what may be 0 at some values of the parameters are told apart
            if any(_are_one(crossed, other) for other in same):
                continue
            same.append(crossed)
            cut, crossing = [ZERO] * n, [ZERO] * len(closing)
            for j, e in zip(support, crossed, strict=False):
                cut[j] = e
            for d, e in zip(own, crossed[s:], strict=True):
                crossing[d] = e
            cuts.append(tuple(cut))
            crossings.append(tuple(crossing))
    looped = {j for row in closing for j, e in enumerate(row) if e != 0}
    return Loops(tuple(closing), tuple(cuts), tuple(crossings), frozenset(looped))


def _components(closing: Sequence[Entries]) -> list[list[int]]:
    """Return the closing slips in groups that have no coordinate in common."""
    groups: list[tuple[list[int], set[int]]] = []
    for d, row in enumerate(closing):
        own, parts = [d], {j for j, e in enumerate(row) if e != 0}
        apart = []
        for members, others in groups:
            if parts & others:
                own, parts = members + own, parts | others
            else:
                apart.append((members, others))
        groups = [*apart, (own, parts)]
    return [sorted(members) for members, _ in groups]


def _are_one(crossed: Sequence[se.Expr], other: Sequence[se.Expr]) -> bool:
    """Return whether a cut is a multiple of another, by the same factor for all parameters."""
    first = next(j for j, e in enumerate(crossed) if e != 0)
    symbols = sorted(crossed[first].free_symbols | other[first].free_symbols, key=str)
    factors = []
    # At two values of the parameters: one ratio for both is one for all.
    for numbers in _trials(symbols):
        a, b = (complex(matrix[first].subs(numbers)) for matrix in (crossed, other))
        factors.append(a / b)
    return abs(factors[0] - factors[1]) <= 1e-9 * abs(factors[0])


def _exact(e: se.Expr) -> se.Expr:
    """Return an expression expanded, 0 where it vanishes."""
    return ZERO if vanishes(e) else se.expand(e)


def _motion(held: Sequence[Entries], s: int) -> Entries | None:
    """Return the motion in which some slips hold, None if there is more than one.

    Its rates are the minors of the rows, by their columns: nothing is divided by. Where rows become
    dependent at some values of the parameters, all rates are 0 there, and others have the cut. So
    that cuts are fewer, a parameter that is a factor of all rates is left out.
    """
    minors: dict[tuple[int, ...], se.Expr] = {(): se.Integer(1)}
    # Rows with few entries first: minors of sparse rows stay short.
    for row in sorted(held, key=lambda row: sum(e != 0 for e in row)):
        larger: dict[tuple[int, ...], se.Expr] = {}
        for columns, minor in minors.items():
            for j, e in enumerate(row):
                if e != 0 and j not in columns:
                    # The sign of a minor's term is that of moving column j into its place.
                    place = sum(k < j for k in columns)
                    sign = -1 if (len(columns) - place) % 2 else 1
                    own = tuple(sorted((*columns, j)))
                    larger[own] = larger.get(own, ZERO) + sign * minor * e
        minors = {columns: e for columns, e in larger.items() if e != 0}
    every = range(s)
    # By Cramer: the rates are orthogonal to all held rows.
    rates = [_exact((-1) ** j * minors.get(tuple(k for k in every if k != j), ZERO)) for j in every]
    for symbol in set[se.Symbol]().union(*(e.free_symbols for e in rates)):
        while all(_has_factor(e, symbol) for e in rates if e != 0) and any(e != 0 for e in rates):
            rates = [se.expand(e / symbol) for e in rates]
    # A number as the last rate is divided by, so that multiples are the same cut.
    last = next((e for e in reversed(rates) if e != 0), None)
    if last is None:
        return None
    unit = last if last.is_Number else se.Integer(1)
    return tuple(e / unit for e in rates)


def _has_factor(e: se.Expr, symbol: se.Symbol) -> bool:
    """Return whether a parameter, or a power of it, is a factor of each term of an expanded sum."""
    for term in e.args if e.is_Add else (e,):
        factors = term.args if term.is_Mul else (term,)
        bases = [f.args for f in factors if f.is_Pow and f.args[0] == symbol]
        powers = [exponent for _, exponent in bases if exponent.is_Integer and exponent > 0]
        if symbol not in factors and not powers:
            return False
    return True


@dataclass(frozen=True)
class SlipDirections:
    """What contacts slip along, and how the coordinates of the equations follow from others."""

    slips: tuple[int, ...]
    """Index of the coordinate along which each contact slips; closing slips come behind them."""
    factors: tuple[se.Expr, ...]
    """Slip velocity of each over the rate of its coordinate."""
    forward: tuple[Entries, ...]
    """Coordinates of the equations, a row each over those of the mechanism; empty if the same."""
    backward: tuple[Entries, ...]
    """Coordinates of the mechanism, a row each over those of the equations; empty if the same."""
    loops: Loops = NO_LOOPS
    """Closing slips over the coordinates of the equations, and how loops break open."""

    def seen(self, symbols: Sequence[se.Symbol]) -> list[se.Expr]:
        """Return the mechanism's coordinates, or their rates, by symbols of the equations' ones."""
        if not self.backward:
            return list(symbols)
        return [_product(row, symbols) for row in self.backward]

    def along(self, forces: Sequence[se.Expr]) -> list[se.Expr]:
        """Return generalised forces along the coordinates of the equations."""
        if not self.backward:
            return list(forces)
        # Virtual work: forces go by the transposed matrix.
        return [_product(column, forces) for column in zip(*self.backward, strict=True)]

    def congruent(self, mass: Sequence[Sequence[se.Expr]]) -> list[list[se.Expr]]:
        """Return a mass matrix for the coordinates of the equations, held ones below it."""
        if not self.backward:
            return [list(row) for row in mass]
        columns = [self.along(row) for row in mass]
        n = len(self.backward)
        # Congruence B^T M B for moving rows and columns; held rows only change their columns.
        moving = zip(
            *[self.along(column) for column in zip(*columns[:n], strict=True)], strict=True
        )
        return [*(list(row) for row in moving), *columns[n:]]


def _product(row: Sequence[se.Expr], others: Sequence[se.Expr]) -> se.Expr:
    terms = (a * b for a, b in zip(row, others, strict=True) if a != 0 and b != 0)
    return sum(terms, se.Integer(0))


def direction_of(way: str | Mapping[str, object] | None) -> dict[str, se.Expr]:
    """Return a slip, or a normal direction, as factors by coordinate."""
    if way is None:
        return {}
    if isinstance(way, str):
        return {way: se.Integer(1)}
    return {name: expression(factor) for name, factor in way.items()}


def slip_directions(mechanism: Mechanism, contacts: Sequence[Contact]) -> SlipDirections:
    """Return the coordinates along which contacts slip."""
    names, owner = list(mechanism.coordinates), type(mechanism).__name__
    rows = [_row(mechanism, contact, names) for contact in contacts]
    kept = {stop.coordinate for stop in stops_of(mechanism)} | set(mechanism.guided())
    # index of the coordinate that stands for each direction, the direction, whose slip it is
    result: dict[int, tuple[Row, str]] = {}
    echelon: dict[int, Row] = {}
    slips, factors = [0] * len(rows), [se.Integer(1)] * len(rows)
    closing: list[tuple[Row, str]] = []
    # Slips along a single coordinate first: they take no other's place.
    for c in sorted(range(len(rows)), key=lambda c: len(rows[c]) > 1):
        row, name = rows[c], contacts[c].name
        if len(row) == 1:
            ((slips[c], factors[c]),) = row.items()
            echelon[slips[c]] = {slips[c]: se.Integer(1)}
            result.setdefault(slips[c], (echelon[slips[c]], name))
            continue
        ratios = ((i, _ratio(row, other)) for i, (other, _) in result.items())
        same = next(((i, ratio) for i, ratio in ratios if ratio is not None), None)
        if same is not None:
            slips[c], factors[c] = same
            continue
        # What earlier slips do not give of it; nothing left means that it closes a loop.
        free = _reduced(row, echelon)
        if not free:
            slips[c], factors[c] = _closing(row, name, closing, len(names))
            continue
        # A coordinate with a stop or a prescribed motion has to stay one of the equations.
        replaced = [i for i in free if names[i] not in kept]
        if not replaced:
            raise InputError(
                f"{owner}: the contact {name!r} slips along a sum of"
                f" {' and '.join(names[i] for i in free)}, all of which have hard stops or"
                " prescribed motions: use relative coordinates, of which the slip is one."
            )
        # a number is never 0 here, and a parameter may be: what it takes the place of is lost then
        i = ([i for i in replaced if free[i].is_Number] or replaced)[-1]
        slips[c] = i
        result[i], echelon[i] = (row, name), free
    changed = {i: row for i, (row, _) in result.items() if len(row) > 1}
    forward, backward = _change(changed, len(names))
    turned = [_turned(row, backward, len(names)) for row, _ in closing]
    loops = loops_of(turned)
    if loops is None:
        own, trials = max(trials_of(turned), key=lambda pair: pair[1])
        raise InputError(
            f"{owner}: the slips of {', '.join(closing[d][1] for d in own)} follow from those of"
            " others in so many ways that what all of them hold together cannot be worked out:"
            f" {trials:,} sets of held contacts would be tried, and at most {MOST_TRIALS:,} are."
            " Give some of them no law (None), or let their supports move by coordinates of their"
            " own."
        )
    return SlipDirections(tuple(slips), tuple(factors), forward, backward, loops)


def refuse_singular(mechanism: Mechanism, contacts: Mapping[str, int]) -> None:
    """Refuse values of parameters at which slips cannot take the places of coordinates.

    Examples
    --------
    >>> from stickslip import TwoFeet
    >>> refuse_singular(TwoFeet(mass=2.0, front=0.3, rear=0.2), {"front": 0})
    """
    names = list(mechanism.coordinates)
    matrix, sums = np.eye(len(names)), {}
    for contact in mechanism.contacts():
        place = contacts.get(contact.name, -1)
        factors = {} if isinstance(contact.slip, str) else dict(contact.slip)
        moving = {name: float(x) for name, x in factors.items() if name in names}
        if len(moving) > 1 and 0 <= place < len(names) and contact.name not in sums:
            sums[contact.name] = moving
            matrix[place] = [moving.get(name, 0.0) for name in names]
    if _is_regular(matrix):
        return
    said = (
        f"{name} ({joined([f'{number(x)} {key}' for key, x in moving.items()])})"
        for name, moving in sums.items()
    )
    raise InputError(
        f"{type(mechanism).__name__}: at these values of its parameters the slips of its contacts"
        f" cannot take the places of coordinates: {'; '.join(said)}. A factor is 0 or not finite,"
        " or slips depend on each other that do not at other values. Change the parameters, or use"
        " relative coordinates, of which the slips are some."
    )


def _is_regular(matrix: NDArray[np.float64]) -> bool:
    """Whether a change of coordinates can be undone."""
    if not np.isfinite(matrix).all():
        return False
    # Scaled rows: the volume tells how near to dependent they are, whatever their units.
    sizes = np.linalg.norm(matrix, axis=1)
    if not sizes.all():
        return False
    return abs(float(np.linalg.det(matrix / sizes[:, None]))) > SINGULAR


def _closing(row: Row, name: str, closing: list[tuple[Row, str]], n: int) -> tuple[int, se.Expr]:
    """Return the place of a slip among those that close loops, and its factor there."""
    for d, (other, _) in enumerate(closing):
        ratio = _ratio(row, other)
        if ratio is not None:
            return n + d, ratio
    closing.append((row, name))
    return n + len(closing) - 1, se.Integer(1)


def _turned(row: Row, backward: Sequence[Entries], n: int) -> Entries:
    """Return a row over the coordinates of the mechanism as one over those of the equations."""
    if not backward:
        return tuple(row.get(j, se.Integer(0)) for j in range(n))
    sums = [sum((e * backward[i][j] for i, e in row.items()), se.Integer(0)) for j in range(n)]
    return tuple(se.Integer(0) if vanishes(e) else se.expand(e) for e in sums)


def _row(mechanism: Mechanism, contact: Contact, names: Sequence[str]) -> Row:
    """Return the factors of the moving coordinates in a contact's slip, by their indices."""
    table = direction_of(contact.slip)
    for name in table:
        if name not in names and name not in (*contact.normals, *mechanism.held()):
            raise UnknownNameError(f"coordinate in the slip of {contact.name}", name, names)
    owner = f"{type(mechanism).__name__}: the contact {contact.name!r}"
    moving = [name for name in table if name in names]
    if not moving:
        raise InputError(f"{owner} slips along no moving coordinate.")
    for name in moving:
        if table[name] == 0:
            raise InputError(f"{owner} has the factor 0 for {name}: leave it out.")
    return {names.index(name): table[name] for name in moving}


def _ratio(row: Row, other: Row) -> se.Expr | None:
    """Return the factor of a row that is a multiple of another, or None."""
    if row.keys() != other.keys():
        return None
    first = next(iter(row))
    factor = row[first] / other[first]
    same = all(vanishes(entry - factor * other[j]) for j, entry in row.items())
    return factor if same else None


def _reduced(row: Row, echelon: Mapping[int, Row]) -> Row:
    """Return what is left of a row beside others, at whose pivots it vanishes then."""
    # At the pivot of each earlier row the new one has to vanish.
    rest = dict(row)
    for pivot, other in echelon.items():
        weight = rest.get(pivot, se.Integer(0)) / other[pivot]
        if weight != 0:
            for j, factor in other.items():
                rest[j] = se.expand(rest.get(j, se.Integer(0)) - weight * factor)
    return {j: rest[j] for j in sorted(rest) if not vanishes(rest[j])}


def _change(changed: Mapping[int, Row], n: int) -> tuple[tuple[Entries, ...], tuple[Entries, ...]]:
    """Return the change of coordinates that replaces some by rows, and its inverse."""
    if not changed:
        return (), ()
    zero, new = se.Integer(0), list(changed)
    identity = [tuple(se.Integer(i == j) for j in range(n)) for i in range(n)]
    forward, backward = list(identity), list(identity)
    for i, row in changed.items():
        forward[i] = tuple(row.get(j, zero) for j in range(n))
    # Only the block of replaced coordinates is inverted; the rest is unchanged.
    inverse = se.DenseMatrix([[changed[i].get(j, zero) for j in new] for i in new]).inv()
    for place, i in enumerate(new):
        own = [zero] * n
        for k, other in enumerate(new):
            weight = inverse[place, k]
            own[other] += weight
            for j, factor in changed[other].items():
                if j not in changed:
                    own[j] -= weight * factor
        backward[i] = tuple(se.expand(e) for e in own)
    return tuple(forward), tuple(backward)
