"""Loops of contacts: slips that follow from others, and the motions that break a loop open.

The slip of a closing contact is a constant combination of the coordinates along which others slip.
What contacts of a loop can carry together is decided by cuts: motions in which as few of them slip
as can be, while the others hold. Forces are within reach of all held contacts exactly if the work
that they would do in no such motion exceeds that of the levels of the contacts that would slip.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import symengine as se

__all__ = ["NO_LOOPS", "Loops", "loops_of", "vanishes"]

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
    """Whether an expression of parameters is 0, whatever these are: tried for two sets of them.

    Parameters
    ----------
    e : Expr
        Expression.

    Returns
    -------
    bool
        Whether it is.
    """
    if se.expand(e) == 0:
        return True
    symbols = sorted(e.free_symbols, key=str)
    for seed in (0.7548776662, 0.5698402909):  # irrational, so that nothing cancels by chance
        numbers = {symbol: 1.0 + (k * seed) % 1.0 for k, symbol in enumerate(symbols, 1)}
        if abs(complex(e.subs(numbers))) > 1e-9:
            return False
    return True


def loops_of(closing: Sequence[Row]) -> Loops | None:
    """Return the cuts of the loops that some slips close.

    Parameters
    ----------
    closing : sequence of Row (m, n)
        Factors of the coordinates in each closing slip.

    Returns
    -------
    Loops or None
        Closing slips, cuts and crossings; None if a loop has too many contacts to try them.
    """
    cuts: list[Row] = []
    crossings: list[Row] = []
    for own in _components(closing):
        support = sorted({j for d in own for j, e in enumerate(closing[d]) if e != 0})
        n, s = len(closing[0]), len(support)
        units = [tuple(se.Integer(j == k) for k in support) for j in support]
        rows = [*units, *(tuple(closing[d][k] for k in support) for d in own)]
        if math.comb(len(rows), s - 1) > MOST_TRIALS:
            return None
        seen: set[tuple[bool, ...]] = set()
        for held in combinations(rows, s - 1):
            motion = _motion(held, s)
            if motion is None:
                continue
            crossed = [_exact(_product(row, motion)) for row in rows]
            pattern = tuple(e == 0 for e in crossed)
            if pattern in seen:
                continue
            seen.add(pattern)
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


def _exact(e: se.Expr) -> se.Expr:
    """Return an expression expanded, 0 where it vanishes."""
    return ZERO if vanishes(e) else se.expand(e)


def _motion(held: Sequence[Row], s: int) -> Row | None:
    """Return the motion in which some slips hold, None if there is more than one."""
    found: dict[int, list[se.Expr]] = {}
    for row in held:
        rest = list(row)
        for pivot, other in found.items():
            weight = rest[pivot]
            if weight != 0:
                rest = [_exact(a - weight * b) for a, b in zip(rest, other, strict=True)]
        pivot = next((j for j, e in enumerate(rest) if e != 0), -1)
        if pivot < 0:
            return None
        own = [e / rest[pivot] for e in rest]
        for place, other in found.items():
            weight = other[pivot]
            if weight != 0:
                found[place] = [_exact(a - weight * b) for a, b in zip(other, own, strict=True)]
        found[pivot] = own
    free = next(j for j in range(s) if j not in found)
    return tuple(se.Integer(1) if j == free else -found[j][free] for j in range(s))
