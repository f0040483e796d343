"""The numeric building blocks, as plain Python."""

import math
import random

import numpy as np
import pytest
from scipy.integrate import DOP853
from tests.support import Generated

from stickslip import Axis, LuGre
from stickslip.engine.kernels import steppers
from stickslip.engine.kernels.numerics import interpolate, lu_factor, lu_solve
from stickslip.engine.kernels.state_layout import FLAGS, MODE, POINT, SCALE, Y1, Y
from stickslip.engine.kernels.steppers import rodas_dense, rodas_step


def solved(a, b):
    """Return the solution by the kernels, which keep all in one vector; None if singular."""
    n = len(b)
    w = [*a, *[0.0] * n, *b]
    if not lu_factor(w, 0, n, n * n):
        return None
    lu_solve(w, 0, n, n * n, n * n + n)
    return w[n * n + n :]


@pytest.mark.parametrize("n", [1, 2, 3, 6])
def test_linear_systems_are_solved_to_rounding(n):
    dice = random.Random(n)
    for _ in range(20):
        a = [dice.gauss(0, 1) for _ in range(n * n)]
        b = [dice.gauss(0, 1) for _ in range(n)]
        matrix, right = np.array(a).reshape(n, n), np.array(b)
        x = np.array(solved(a, b))
        # backward stable: the residual is a few roundings of its parts
        size = np.abs(matrix) @ np.abs(x) + np.abs(right)
        assert np.all(np.abs(matrix @ x - right) <= 1e-13 * size)


def test_a_zero_on_the_diagonal_is_pivoted_away():
    assert solved([0.0, 2.0, 3.0, 0.0], [4.0, 6.0]) == [2.0, 2.0]


@pytest.mark.parametrize("a", [[0.0], [1.0, 2.0, 2.0, 4.0], [math.nan]])
def test_a_singular_matrix_is_recognised(a):
    assert solved(a, [1.0] * math.isqrt(len(a))) is None


def test_the_stages_of_dop853_are_those_of_scipy():
    row = 0
    for s in range(1, 12):
        np.testing.assert_array_equal(steppers.A[row : row + s], DOP853.A[s, :s])
        row += s
    np.testing.assert_array_equal(steppers.A[row : row + 12], DOP853.B)
    np.testing.assert_array_equal(steppers.C[:12], DOP853.C[:12])
    np.testing.assert_array_equal(steppers.ERROR_5[:13], DOP853.E5)
    np.testing.assert_array_equal(steppers.ERROR_3[:13], DOP853.E3)


def test_the_last_stage_of_rodas5p_is_the_one_before_with_its_correction():
    a = steppers.A_RODAS
    rows = [a[s * (s - 1) // 2 : s * (s + 1) // 2] for s in range(1, 8)]
    assert rows[5] == (*rows[4], 1.0)
    assert rows[6] == (*rows[5], 1.0)


@pytest.fixture(scope="module")
def stiff():
    law = LuGre(
        kinetic_coefficient=1.0, static_coefficient=1.5, stribeck_velocity=0.1,
        bristle_stiffness=10.0, bristle_damping=0.3, viscous_coefficient=0.4,
    )  # fmt: skip
    return Generated(Axis(inertia=1.0, stiffness=3.0), law)


def rodas(stiff, h, count):
    """Return the state after equal steps, and the middle of the first from its dense output."""
    w, iw, middle = stiff.equations.w, stiff.equations.iw, None
    y, y1, scale, point = (iw[slot] for slot in (Y, Y1, SCALE, POINT))
    iw[MODE], iw[FLAGS] = 1, stiff.flags([0.5, 0.8, 0.01])
    w[y : y + 3], w[scale : scale + 3] = [0.5, 0.8, 0.01], [1.0] * 3
    for i in range(count):
        rodas_step(i * h, h, w, iw, 1.0)
        if middle is None:
            rodas_dense(w, iw)
            interpolate(w, iw, 0.5, point)
            middle = w[point : point + 3]
        w[y : y + 3] = w[y1 : y1 + 3]
    return np.array(w[y : y + 3]), np.array(middle)


def test_rodas5p_converges_with_order_five(stiff):
    exact, _ = rodas(stiff, 0.1 / 256, 256)
    errors = [np.abs(rodas(stiff, 0.1 / n, n)[0] - exact).max() for n in (4, 8, 16)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all(orders > 4.5)  # the next term of the error still shows


def test_the_dense_output_of_rodas5p_converges_with_order_four(stiff):
    errors = []
    for h in (0.04, 0.02, 0.01):
        exact, _ = rodas(stiff, h / 64, 32)
        errors.append(np.abs(rodas(stiff, h, 1)[1] - exact).max())
    # a single step errs with one order more
    assert np.all(np.log2(np.divide(errors[:-1], errors[1:])) > 4.5)


def test_a_guard_that_falls_steadily_is_not_searched_for_a_turn():
    """One such search takes forty evaluations of the equations; each step has several of them."""
    from stickslip.engine.kernels.guard_roots import turns

    assert not turns(1.0, 0.99, 0.98)
    assert not turns(1.0, 0.99, 0.981)  # turns, after ten such parts of the step
    assert turns(0.1, 0.06, 0.34)  # 0.1 - 0.2 x + 0.16 x^2 turns at 0.6, where it is 0.04
    assert turns(0.001, 0.2, 0.5)
