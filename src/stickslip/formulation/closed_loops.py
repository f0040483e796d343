"""Loops of contacts: slips that follow from others, and the motions that break a loop open.

The slip of a closing contact is a constant combination of the coordinates along which others slip.
What contacts of a loop can carry together is decided by cuts: motions in which as few of them slip
as can be, while the others hold. Forces are within reach of all held contacts exactly if the work
that they would do in no such motion exceeds that of the levels of the contacts that would slip.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import symengine as se

MOST_TRIALS = 1500
"""Most sets of held contacts that are tried for the cuts of one loop."""

Row = tuple[se.Expr, ...]
ZERO = se.Integer(0)


@dataclass(frozen=True)
class Loops:
    """Closing slips and cuts, over the coordinates of the equations."""

    closing: tuple[Row, ...] = ()
    """Factors of the coordinates in each closing slip."""
    cuts: tuple[Row, ...] = ()
    """Rates of the coordinates in the motion of each cut."""
    crossings: tuple[Row, ...] = ()
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


def trials_of(closing: Sequence[Row]) -> list[tuple[list[int], int]]:
    """Return how many sets of held contacts are tried for the cuts of each loop."""
    found = []
    for own in _components(closing):
        s = len({j for d in own for j, e in enumerate(closing[d]) if e != 0})
        found.append((own, math.comb(s + len(own), s - 1)))
    return found


def loops_of(closing: Sequence[Row]) -> Loops | None:
    """Return the cuts of the loops that some slips close."""
    cuts: list[Row] = []
    crossings: list[Row] = []
    for own, trials in trials_of(closing):
        if trials > MOST_TRIALS:
            return None
        support = sorted({j for d in own for j, e in enumerate(closing[d]) if e != 0})
        n, s = len(closing[0]), len(support)
        units = [tuple(se.Integer(j == k) for k in support) for j in support]
        rows = [*units, *(tuple(closing[d][k] for k in support) for d in own)]
        seen: dict[tuple[bool, ...], list[list[se.Expr]]] = {}
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


def _components(closing: Sequence[Row]) -> list[list[int]]:
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


def _product(row: Row, motion: Row) -> se.Expr:
    return sum((a * b for a, b in zip(row, motion, strict=True)), ZERO)


def _are_one(crossed: Sequence[se.Expr], other: Sequence[se.Expr]) -> bool:
    """Return whether a cut is a multiple of another, by the same factor for all parameters."""
    first = next(j for j, e in enumerate(crossed) if e != 0)
    symbols = sorted(crossed[first].free_symbols | other[first].free_symbols, key=str)
    factors = []
    for numbers in _trials(symbols):
        a, b = (complex(one[first].subs(numbers)) for one in (crossed, other))
        factors.append(a / b)
    return abs(factors[0] - factors[1]) <= 1e-9 * abs(factors[0])


def _exact(e: se.Expr) -> se.Expr:
    """Return an expression expanded, 0 where it vanishes."""
    return ZERO if vanishes(e) else se.expand(e)


def _motion(held: Sequence[Row], s: int) -> Row | None:
    """Return the motion in which some slips hold, None if there is more than one.

    Its rates are the minors of the rows, by their columns: nothing is divided by. Where rows become
    dependent at some values of the parameters, all rates are 0 there, and others have the cut. So
    that cuts are fewer, a parameter that is a factor of all rates is left out.
    """
    minors: dict[tuple[int, ...], se.Expr] = {(): se.Integer(1)}
    for row in sorted(held, key=lambda row: sum(e != 0 for e in row)):
        larger: dict[tuple[int, ...], se.Expr] = {}
        for columns, minor in minors.items():
            for j, e in enumerate(row):
                if e != 0 and j not in columns:
                    place = sum(k < j for k in columns)
                    sign = -1 if (len(columns) - place) % 2 else 1
                    own = tuple(sorted((*columns, j)))
                    larger[own] = larger.get(own, ZERO) + sign * minor * e
        minors = {columns: e for columns, e in larger.items() if e != 0}
    every = range(s)
    rates = [_exact((-1) ** j * minors.get(tuple(k for k in every if k != j), ZERO)) for j in every]
    for symbol in set[se.Symbol]().union(*(e.free_symbols for e in rates)):
        while all(_has_factor(e, symbol) for e in rates if e != 0) and any(e != 0 for e in rates):
            rates = [se.expand(e / symbol) for e in rates]
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
