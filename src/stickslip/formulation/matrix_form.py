"""Reads the equations of a mechanism that gives matrices."""

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import symengine as se
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.formatting import number
from stickslip.formulation.trace import expression, is_zero
from stickslip.mechanisms import MatrixMechanism

FEW = 3
"""Coordinates that are eliminated by symbols, at most."""
SAME = 1e-9
"""Difference of two entries, over their size, that is the rounding of two ways to write them."""
VANISHED = 1e-6
"""Share of the mass of a motion that is next to nothing: it is a thousand times as fast then."""
LINKS = (
    "For a link, the moment of inertia about its joint is at least its mass times the square of the"
    " distance of its centre."
)
"""What is often wrong with a mass matrix that is not positive definite."""
SINGULAR = 1e-13
"""What is left of a mass, over the mass itself, where rounding cannot tell it from 0."""


def matrix_rows(
    mechanism: MatrixMechanism, places: Mapping[str, Any], held: Sequence[str]
) -> list[se.Expr]:
    """Return the mass matrix row by row, those of held coordinates last."""
    n = len(mechanism.coordinates)
    rows = [list(row) for row in mechanism.mass_matrix(places)]
    if len(rows) != n + len(held) or any(len(row) != n for row in rows):
        got = f"{len(rows)} rows of {' or '.join(sorted({str(len(row)) for row in rows}))}"
        names = ", ".join((*mechanism.coordinates, *held))
        raise InputError(
            f"{type(mechanism).__name__}.mass_matrix must return {n + len(held)} rows ({names})"
            f" of {n} ({', '.join(mechanism.coordinates)}), got {got}."
        )
    found = [[expression(entry) for entry in row] for row in rows]
    for i, j in itertools.combinations(range(n), 2):
        one, other = found[i][j], found[j][i]
        if not is_zero(one - other) and _differ(one, other):
            row, column = mechanism.coordinates[i], mechanism.coordinates[j]
            raise InputError(_asymmetry(mechanism, row, column, _shown(one), _shown(other)))
    free = [i for i in range(n) if mechanism.coordinates[i] not in mechanism.guided()]
    for k in range(1, min(len(free), FEW) + 1):
        part = free[:k]
        minor = se.DenseMatrix(k, k, [found[i][j] for i in part for j in part])
        if is_zero(minor.det()):
            names = ", ".join(repr(mechanism.coordinates[i]) for i in part)
            raise InputError(
                f"{type(mechanism).__name__}.mass_matrix must be positive definite, but some motion"
                f" of {names} has no mass wherever it is: the rows and columns of these coordinates"
                " depend on each other."
            )
    return [entry for row in found for entry in row]


def _differ(one: se.Expr, other: se.Expr) -> bool:
    """Whether two expressions have other values than each other at some numbers for all symbols.

    Forms such as that of a sum of angles need not cancel by symbols.
    """
    random = np.random.default_rng(0)
    names = sorted(one.free_symbols | other.free_symbols, key=str)
    for _ in range(3):
        numbers = dict(zip(names, random.uniform(0.2, 1.2, len(names)).tolist(), strict=True))
        try:
            a, b = (float(e.subs(numbers)) for e in (one, other))
        except (RuntimeError, TypeError, ValueError):
            return False  # with switches: the state at hand tells
        if abs(a - b) > SAME * (abs(a) + abs(b)):
            return True
    return False


def _shown(e: se.Expr) -> str:
    """Return a number as text; nothing for an expression, whose symbols mean nothing to users."""
    return "" if e.free_symbols else number(float(e), 6)


def _asymmetry(
    mechanism: MatrixMechanism, row: str, column: str, one: str, other: str, where: str = ""
) -> str:
    """Return what is wrong with two entries that should be equal."""
    first, second = (f" ({value})" if value else "" for value in (one, other))
    return (
        f"{type(mechanism).__name__}.mass_matrix must be symmetric{where}, but the entry of row"
        f" {row!r} and column {column!r}{first} is not that of row {column!r} and column"
        f" {row!r}{second}."
    )


def mass_fault(mechanism: MatrixMechanism, places: Sequence[float]) -> str:
    """Return what is wrong with a mass matrix at a place: nothing, or a sentence."""
    names, owner = mechanism.coordinates, type(mechanism).__name__
    n, mass = len(names), _mass_at(mechanism, places)
    q = dict(zip(names, map(float, places), strict=True))
    at = ", ".join(f"{name} = {number(value, 4)} {unit}" for (name, value), unit in zip(
        q.items(), mechanism.units, strict=True
    ))  # fmt: skip
    for i, j in itertools.combinations(range(n), 2):
        if abs(mass[i, j] - mass[j, i]) > SAME * (abs(mass[i, j]) + abs(mass[j, i])):
            values = number(mass[i, j], 6), number(mass[j, i], 6)
            return _asymmetry(mechanism, names[i], names[j], *values, f" at {at}")
    moving = [i for i in range(n) if names[i] not in mechanism.guided()]
    for i in moving:
        if not mass[i, i] > 0.0:
            return (
                f"{owner}.mass_matrix must have masses above 0 on its diagonal, but the entry of"
                f" row and column {names[i]!r} is {number(mass[i, i], 6)} at {at}."
            )
    left = mass[np.ix_(moving, moving)]
    left = left / np.sqrt(np.outer(left.diagonal(), left.diagonal()))
    for k, i in enumerate(
        moving
    ):  # elimination: what is left of each row once those before it move freely
        if not left[k, k] > SINGULAR:
            return (
                f"{owner}.mass_matrix must be positive definite, but at {at} some motion of"
                f" {', '.join(repr(names[j]) for j in moving[: k + 1])} has no mass or a negative"
                f" one: the entries of row and column {names[i]!r} are too large for it. {LINKS}"
            )
        left[k + 1 :, k + 1 :] -= np.outer(left[k + 1 :, k], left[k, k + 1 :]) / left[k, k]
    return ""


def matrix_supply(
    given: Any,
    energy: se.Expr,
    force: Mapping[str, se.Expr],
    places: Mapping[str, se.Symbol],
    speeds: Mapping[str, se.Symbol],
) -> se.Expr:
    """Return the power supplied [W]: what is given, or what the forces do beyond the energies."""
    if given is not None:
        return expression(given)
    pairs = [(f * speeds[i], energy.diff(places[i]) * speeds[i]) for i, f in force.items()]
    left = [pair for pair in pairs if not is_zero(sum(pair))]
    total = sum((sum(part, se.Integer(0)) for part in zip(*left, strict=True)), se.Integer(0))
    return se.Integer(0) if is_zero(total) else total


def mass_vanishes(mechanism: MatrixMechanism, start: Sequence[float], end: Sequence[float]) -> bool:
    """Whether some motion has next to no mass any more at the end of a run."""
    before, after = (_mass_at(mechanism, places) for places in (start, end))
    scale = 1.0 / np.sqrt(before.diagonal())
    least = [np.linalg.eigvalsh(m * np.outer(scale, scale))[0] for m in (before, after)]
    return bool(least[1] <= VANISHED * least[0])


def _mass_at(mechanism: MatrixMechanism, places: Sequence[float]) -> NDArray[np.float64]:
    """Return the mass matrix of the moving coordinates (n, n) at a place (n,)."""
    names = mechanism.coordinates
    held = [*mechanism.held(), *(name for one in mechanism.contacts() for name in one.normals)]
    q = dict(zip(names, map(float, places), strict=True))
    rows = mechanism.mass_matrix({**dict.fromkeys(held, 0.0), **q})
    return np.array([[float(entry) for entry in row] for row in rows[: len(names)]])
