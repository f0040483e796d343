"""Reads the equations of a mechanism that gives matrices."""

from collections.abc import Mapping, Sequence
from typing import Any

import symengine as se

from stickslip.errors import InputError
from stickslip.formulation.trace import expression, is_zero
from stickslip.mechanisms import MatrixMechanism

__all__ = ["matrix_rows", "matrix_supply"]


def matrix_rows(
    mechanism: MatrixMechanism, places: Mapping[str, Any], held: Sequence[str]
) -> list[se.Expr]:
    """Return the mass matrix row by row, those of held coordinates last.

    Parameters
    ----------
    mechanism : MatrixMechanism
        Mechanism with `mass_matrix`.
    places : mapping of str to object
        Traced coordinates by name, held ones included.
    held : sequence of str (m,)
        Names of the coordinates held at 0.

    Returns
    -------
    ((n + m) n,)
        Entries of the matrix, rows one after the other.

    Raises
    ------
    InputError
        If the matrix does not have n + m rows of n entries.
    """
    n = len(mechanism.coordinates)
    rows = [list(row) for row in mechanism.mass_matrix(places)]
    if len(rows) != n + len(held) or any(len(row) != n for row in rows):
        got = f"{len(rows)} rows of {' or '.join(sorted({str(len(row)) for row in rows}))}"
        names = ", ".join((*mechanism.coordinates, *held))
        raise InputError(
            f"{type(mechanism).__name__}.mass_matrix must return {n + len(held)} rows ({names})"
            f" of {n} ({', '.join(mechanism.coordinates)}), got {got}."
        )
    return [expression(entry) for row in rows for entry in row]


def matrix_supply(
    given: Any,
    energy: se.Expr,
    force: Mapping[str, se.Expr],
    places: Mapping[str, se.Symbol],
    speeds: Mapping[str, se.Symbol],
) -> se.Expr:
    """Return the power supplied [W]: what is given, or what the forces do beyond the energies.

    Parameters
    ----------
    given : object
        What `MatrixMechanism.power` returned: an expression, or None.
    energy : Expr
        Kinetic and potential energy [J].
    force : mapping of str to Expr
        Generalised forces by coordinate, friction left out.
    places : mapping of str to Symbol
        Symbols of the coordinates by name.
    speeds : mapping of str to Symbol
        Symbols of the rates by name of the coordinate.

    Returns
    -------
    Expr
        Power supplied [W].
    """
    if given is not None:
        return expression(given)
    pairs = [(f * speeds[i], energy.diff(places[i]) * speeds[i]) for i, f in force.items()]
    left = [pair for pair in pairs if not is_zero(sum(pair))]
    total = sum((sum(part, se.Integer(0)) for part in zip(*left, strict=True)), se.Integer(0))
    return se.Integer(0) if is_zero(total) else total
