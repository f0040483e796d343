"""Small dense linear systems, factorised in place with row pivoting."""

from stickslip.kernels.backend import Vector


def lu_factor(w: Vector, a: int, n: int, pivots: int) -> bool:
    """Factorise the n x n matrix at `a`, rows one after the other; False if it is singular."""
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(w[a + i * n + k]) > abs(w[a + best * n + k]):
                best = i
        w[pivots + k] = best
        if not abs(w[a + best * n + k]) > 0.0:  # false for NaN, too
            return False
        if best != k:
            for j in range(n):
                swap = w[a + k * n + j]
                w[a + k * n + j] = w[a + best * n + j]
                w[a + best * n + j] = swap
        w[a + k * n + k] = 1.0 / w[a + k * n + k]  # many solutions follow, and products are faster
        for i in range(k + 1, n):
            factor = w[a + i * n + k] * w[a + k * n + k]
            w[a + i * n + k] = factor
            for j in range(k + 1, n):
                w[a + i * n + j] -= factor * w[a + k * n + j]
    return True


def lu_solve(w: Vector, a: int, n: int, pivots: int, b: int) -> None:
    """Solve with a factorised matrix; the solution replaces the right-hand side at `b`."""
    for k in range(n):
        best = int(w[pivots + k])
        if best != k:
            swap = w[b + k]
            w[b + k] = w[b + best]
            w[b + best] = swap
    # sums in variables of their own: a processor waits for what it has just put into memory
    if n == 3:  # a coordinate and its bristle
        x = w[b]
        y = w[b + 1] - w[a + 3] * x
        z = (w[b + 2] - w[a + 6] * x - w[a + 7] * y) * w[a + 8]
        y = (y - w[a + 5] * z) * w[a + 4]
        w[b] = (x - w[a + 1] * y - w[a + 2] * z) * w[a]
        w[b + 1] = y
        w[b + 2] = z
        return
    for i in range(1, n):
        total = w[b + i]
        for j in range(i):
            total -= w[a + i * n + j] * w[b + j]
        w[b + i] = total
    for i in range(n - 1, -1, -1):
        total = w[b + i]
        for j in range(i + 1, n):
            total -= w[a + i * n + j] * w[b + j]
        w[b + i] = total * w[a + i * n + i]
