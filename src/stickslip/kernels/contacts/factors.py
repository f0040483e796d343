"""The mass matrix of the coordinates that are free to move, factorised by Cholesky."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.contacts.loops import fold, project_mass
from stickslip.kernels.directions import bind
from stickslip.kernels.enums import HELD_FAST
from stickslip.kernels.state_layout import (
    CHOLESKY,
    DIAGONAL,
    MASS,
    MODES,
    N_COORDINATES,
    N_DIRECTIONS,
)


def factorise(w: Vector, whole: Wholes) -> None:
    """Factorise the mass matrix of the free coordinates; those of held ones are rows of 1.

    A principal part of a positive definite matrix is one itself: there is always an answer.
    """
    n = whole[N_COORDINATES]
    modes = whole[MODES]
    mass = whole[MASS]
    factors = whole[CHOLESKY]
    if whole[N_DIRECTIONS] > n:
        mass = project_mass(w, whole)
    for i in range(n):
        free_row = whole[modes + i] != HELD_FAST
        for j in range(i):
            free = free_row and whole[modes + j] != HELD_FAST
            total = w[mass + i * n + j] if free else 0.0
            for k in range(j):
                total -= w[factors + i * n + k] * w[factors + j * n + k]
            w[factors + i * n + j] = total / w[factors + j * n + j]
        total = w[mass + i * n + i] if free_row else 1.0
        for k in range(i):
            total -= w[factors + i * n + k] * w[factors + i * n + k]
        w[factors + i * n + i] = math.sqrt(total) if total > 0.0 else math.nan


def solve_free(w: Vector, whole: Wholes, right: int) -> None:
    """Solve for the free coordinates in place; 0 at held ones."""
    n = whole[N_COORDINATES]
    modes = whole[MODES]
    if whole[DIAGONAL]:
        mass = whole[MASS]
        for i in range(n):
            held = whole[modes + i] == HELD_FAST
            w[right + i] = 0.0 if held else w[right + i] / w[mass + i * n + i]
        return
    factors = whole[CHOLESKY]
    if whole[N_DIRECTIONS] > n:
        fold(right, w, whole)
    for i in range(n):
        total = 0.0 if whole[modes + i] == HELD_FAST else w[right + i]
        for k in range(i):
            total -= w[factors + i * n + k] * w[right + k]
        w[right + i] = total / w[factors + i * n + i]
    for i in range(n - 1, -1, -1):
        total = w[right + i]
        for k in range(i + 1, n):
            total -= w[factors + k * n + i] * w[right + k]
        w[right + i] = total / w[factors + i * n + i]
    for i in range(n):
        if whole[modes + i] == HELD_FAST:
            w[right + i] = 0.0
    if whole[N_DIRECTIONS] > n:
        bind(right, 1, w, whole)
