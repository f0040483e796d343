r"""Terms that a design does not tell apart: their columns span the same.

Let :math:`A_\perp` be what is left of the columns of a term of a structure beside those of all its
other terms, and :math:`B_\perp` the same of another term that could stand in its place. On this
design no data tell the two apart where the largest principal angle between :math:`A_\perp` and
:math:`B_\perp` vanishes: whatever one says of the response, the other says too. Where
:math:`B_\perp` itself vanishes beside the whole structure, the term adds nothing to it.

The angle is judged by the columns alone, weighted as the rows are, not by how well a law fits; so
names of one group follow from the design, and from no list.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip.identify.problem import Array, Column, Structure
from stickslip.identify.regression import BlockRegression
from stickslip.identify.thresholds import THRESHOLDS


@dataclass(frozen=True, kw_only=True)
class Spans:
    """What else the columns of a structure may be."""

    instead: Mapping[str, Sequence[Column]]
    """For each term of the structure, those that could stand in its place, with their shapes."""
    within: Sequence[Column]
    """Terms whose columns lie in the span of all of its columns together."""


def same_span(regression: BlockRegression, structure: Structure) -> Spans:
    """Return the terms of a vocabulary that a structure is not told apart from."""
    problem, w = regression.problem, regression.weights[:, None]

    def columns(column: Column) -> Array:
        x = regression.columns.of(column) * w
        return np.asarray(x / (np.linalg.norm(x, axis=0) + 1e-300))

    own = {name: columns((name, shape)) for name, shape in structure}
    everything = _basis(np.hstack([*own.values()]) if own else np.zeros((len(w), 0)))
    beside = {
        name: _basis(np.hstack([np.zeros((len(w), 0)), *(own[k] for k in own if k != name)]))
        for name in own
    }
    instead: dict[str, list[Column]] = {name: [] for name in own}
    within = []
    least = THRESHOLDS.same_span
    for name, term in problem.terms.items():
        if name in own or term.role == "curve":
            continue
        for shape in term.shapes:
            x = columns((name, shape))
            if np.linalg.norm(x) == 0.0:
                continue
            if _left(x, everything) > least:
                continue
            within.append((name, shape))
            for known, others in beside.items():
                new = _basis(np.hstack([others, x]), least)
                if new.shape[1] >= everything.shape[1] and _left(own[known], new) <= least:
                    instead[known].append((name, shape))
            break  # one shape of a term tells
    return Spans(instead={name: found for name, found in instead.items() if found}, within=within)


def _basis(x: Array, least: float = 1e-10) -> Array:
    """Return an orthonormal basis (n, r) of the span of columns (n, p) of size 1."""
    if not x.shape[1]:
        return x
    u, s, _ = np.linalg.svd(x, full_matrices=False)
    return np.asarray(u[:, s > least])


def _left(x: Array, basis: Array) -> float:
    """Return the largest part of columns of size 1 that lies outside a span."""
    return float(np.max(np.linalg.norm(x - basis @ (basis.T @ x), axis=0)))
