"""Held-out errors of all candidates at once, as additions to a fit and swaps against its terms."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from stickslip.evidence.balance import Balance
from stickslip.evidence.fits import Design, design, solved
from stickslip.evidence.structure import GIVEN, Structure
from stickslip.evidence.terms import TERMS, Term

Array = NDArray[np.float64]


@final
@dataclass(frozen=True)
class Move:
    """A candidate that is added to a structure, perhaps in place of one of its terms."""

    error: float
    """Mean squared held-out error [N^2] on slipping rows."""
    term: Term
    """The term that is added."""
    gone: Term | None
    """The term that it takes the place of."""

    def applied(self, structure: Structure) -> Structure:
        """Return the structure after the move."""
        rest = structure if self.gone is None else structure.without(self.gone)
        return rest.having(self.term)


@final
@dataclass(frozen=True, eq=False)
class _Grams:
    """Products of columns over blocks: (2 K, ...), held-out blocks first, then with their gaps."""

    own: Array
    """Of the structure's columns (2 K, p, p)."""
    cross: Array
    """Of these with the candidates' (2 K, p, m)."""
    among: tuple[Array, ...]
    """Of each candidate's columns with each other (2 K, d, d)."""
    own_force: Array
    """Of the structure's columns with the force (2 K, p)."""
    force: Array
    """Of the candidates' columns with the force (2 K, m)."""
    power: Array
    """Of the force with itself (2 K,)."""


def moves(balance: Balance, structure: Structure, candidates: Sequence[Term]) -> list[Move]:
    """Return all additions and swaps of candidates that physics admits, the best first.

    Each costs a solution of normal equations for each block: the products of columns are shared.
    """
    made = design(balance, structure)
    columns = [balance.columns(term, structure.shape(term.channel))[0] for term in candidates]
    kept = [i for i, x in enumerate(columns) if x.any() and np.isfinite(x).all()]
    candidates, columns = [candidates[i] for i in kept], [columns[i] for i in kept]
    if not candidates:
        return []
    grams = _grams(made, columns)
    ends = np.cumsum([x.shape[1] for x in columns])
    places = [slice(end - x.shape[1], end) for end, x in zip(ends, columns, strict=True)]
    rows = max(int(made.slipping.sum()), 1)
    found: list[Move] = []
    gone_terms: list[Term | None] = [None]
    gone_terms += [term for term in dict.fromkeys(made.owners) if term.kind not in GIVEN]
    for gone in gone_terms:
        rest = structure if gone is None else structure.without(gone)
        kept_columns = np.array([term != gone for term in made.owners], dtype=bool)
        for width in sorted({x.shape[1] for x in columns}):
            which = [
                i
                for i, (term, x) in enumerate(zip(candidates, columns, strict=True))
                if x.shape[1] == width and not rest.clashes(term)
            ]
            if not which:
                continue
            errors, values = _judged(
                grams, kept_columns, [places[i] for i in which], [grams.among[i] for i in which]
            )
            owners = [term for term in made.owners if term != gone]
            allowed = _admitted(values, owners, [candidates[i] for i in which])
            found += [
                Move(float(error) / rows, candidates[i], gone)
                for i, error, ok in zip(which, errors, allowed, strict=True)
                if ok
            ]
    return sorted(found, key=lambda move: move.error)


def _grams(made: Design, columns: Sequence[Array]) -> _Grams:
    """Return the products of columns over held-out blocks and over these with their gaps."""
    balance = made.balance
    slipping = made.slipping
    wide = np.hstack(columns)
    parts: list[tuple[Array, Array, list[Array], Array, Array, float]] = []
    blocks = [(balance.fold == k) & slipping for k in range(balance.folds)]
    gaps = [
        balance.near[k] & slipping & ~block
        for k, block in zip(range(balance.folds), blocks, strict=True)
    ]
    ends = np.cumsum([x.shape[1] for x in columns])
    for rows in map(np.flatnonzero, (*blocks, *gaps)):
        own, force = made.columns.take(rows, axis=0), made.force[rows]
        other = wide.take(rows, axis=0)
        among = [
            other[:, end - x.shape[1] : end].T @ other[:, end - x.shape[1] : end]
            for end, x in zip(ends, columns, strict=True)
        ]
        parts.append(
            (
                own.T @ own,
                own.T @ other,
                among,
                own.T @ force,
                other.T @ force,
                float(force @ force),
            )
        )

    def stacked(index: int) -> Array:
        blocks_of = np.array([one[index] for one in parts])
        half = len(blocks_of) // 2
        blocks_of[half:] += blocks_of[:half]
        return blocks_of

    among_of = []
    for i in range(len(columns)):
        one = np.array([part[2][i] for part in parts])
        one[len(one) // 2 :] += one[: len(one) // 2]
        among_of.append(one)
    return _Grams(
        own=stacked(0),
        cross=stacked(1),
        among=tuple(among_of),
        own_force=stacked(3),
        force=stacked(4),
        power=stacked(5),
    )


def _judged(
    grams: _Grams, kept: NDArray[np.bool_], places: Sequence[slice], among: Sequence[Array]
) -> tuple[Array, Array]:
    """Return squared held-out errors (c,) and coefficients (c, p) of candidates of one width."""
    index = np.array([np.arange(one.start, one.stop) for one in places])
    count, width = index.shape
    old = int(kept.sum())
    total = len(grams.power)
    square = np.empty((count, total, old + width, old + width))
    product = np.empty((count, total, old + width))
    square[:, :, :old, :old] = grams.own[:, kept][:, :, kept]
    cross = grams.cross[:, kept][:, :, index].transpose(2, 0, 1, 3)
    square[:, :, :old, old:] = cross
    square[:, :, old:, :old] = cross.transpose(0, 1, 3, 2)
    square[:, :, old:, old:] = np.array(among)
    product[:, :, :old] = grams.own_force[:, kept]
    product[:, :, old:] = grams.force[:, index].transpose(1, 0, 2)
    half = total // 2
    held, held_product = square[:, :half], product[:, :half]
    whole, whole_product = held.sum(axis=1), held_product.sum(axis=1)
    values = solved(
        whole[:, None] - square[:, half:],
        whole_product[:, None] - product[:, half:],
        whole[:, None],
    )
    fitted = np.einsum("ckp,ckpq,ckq->c", values, held, values, optimize=True)
    errors = grams.power[:half].sum() - 2.0 * np.einsum("ckp,ckp->c", values, held_product) + fitted
    return errors, solved(whole, whole_product)


def _admitted(values: Array, owners: Sequence[Term], candidates: Sequence[Term]) -> list[bool]:
    """Return whether physics admits coefficients (c, p) of each candidate with the others."""
    positive = [TERMS[one.kind].positive for one in owners]
    limits = [TERMS[one.kind].limits for one in owners]
    found = []
    for row, term in zip(values, candidates, strict=True):
        kind = TERMS[term.kind]
        own = [kind] * (len(row) - len(owners))
        signs = [*positive, *(one.positive for one in own)]
        ranges = [*limits, *(one.limits for one in own)]
        found.append(
            all(
                not (sign and value < 0.0) and (limit is None or limit[0] <= value <= limit[1])
                for value, sign, limit in zip(row, signs, ranges, strict=True)
            )
        )
    return found
