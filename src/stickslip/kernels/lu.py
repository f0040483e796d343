"""Small dense linear systems, factorised in place with row pivoting."""

from stickslip.kernels.tier import Vector

__all__ = ["lu_factor", "lu_solve"]


def lu_factor(a: Vector, n: int, pivots: Vector) -> bool:
    """Factorise the n x n matrix `a`, rows one after the other; False if it is singular."""
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(a[i * n + k]) > abs(a[best * n + k]):
                best = i
        pivots[k] = best
        if not abs(a[best * n + k]) > 0.0:
            return False
        if best != k:
            for j in range(n):
                swap = a[k * n + j]
                a[k * n + j] = a[best * n + j]
                a[best * n + j] = swap
        for i in range(k + 1, n):
            a[i * n + k] /= a[k * n + k]
            for j in range(k + 1, n):
                a[i * n + j] -= a[i * n + k] * a[k * n + j]
    return True


def lu_solve(a: Vector, n: int, pivots: Vector, b: Vector) -> None:
    """Solve with a factorised matrix; the solution replaces `b`."""
    for k in range(n):
        best = int(pivots[k])
        swap = b[k]
        b[k] = b[best]
        b[best] = swap
    for i in range(n):
        for j in range(i):
            b[i] -= a[i * n + j] * b[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            b[i] -= a[i * n + j] * b[j]
        b[i] /= a[i * n + i]
