"""The collocation that carries sensitivities: its order conditions, and what it does with them."""

import numpy as np
import pytest

from stickslip.kernels.radau_tableau import RADAU, RADAU_NODES, RADAU_STAGES

A = np.array(RADAU).reshape(RADAU_STAGES, RADAU_STAGES)
C = np.array(RADAU_NODES)
B = A[-1]
ROUNDING = 2e-16
"""Of coefficients below 1, summed five at a time."""


@pytest.mark.parametrize("q", range(1, 10))
def test_the_weights_integrate_powers_up_to_order_nine(q):
    assert abs(B @ C ** (q - 1) - 1 / q) <= 2 * ROUNDING


def test_the_weights_integrate_no_higher_power():
    assert abs(B @ C**9 - 1 / 10) > 1e-7


@pytest.mark.parametrize("q", range(1, 6))
def test_the_stages_integrate_powers_up_to_order_five(q):
    assert np.abs(A @ C ** (q - 1) - C**q / q).max() <= 2 * ROUNDING


@pytest.mark.parametrize("q", range(1, 5))
def test_the_weights_simplify_against_the_matrix_up_to_order_four(q):
    found = (B * C ** (q - 1)) @ A
    assert np.abs(found - B * (1 - C**q) / q).max() <= 2 * ROUNDING


def test_the_last_stage_is_the_end_of_the_step():
    assert C[-1] == 1.0
    assert np.all(np.diff(C) > 0)


def test_the_nodes_are_those_of_the_derivative_that_defines_the_method():
    x = np.polynomial.Polynomial([0.0, 1.0])
    defining = (x**4 * (x - 1) ** 5).deriv(4)
    # slopes of the ninth-degree polynomial at its roots reach some hundreds
    assert np.abs(defining(C) / defining.deriv()(C)).max() <= 1e-14


@pytest.mark.parametrize("z", [-1.0, -1e3, -1e9, 1j, 10j])
def test_stiff_components_die_out_and_others_do_not_grow(z):
    stages = np.linalg.solve(np.eye(RADAU_STAGES) - z * A, np.ones(RADAU_STAGES))
    growth = abs(stages[-1])
    assert growth <= 1.0 + 1e-14
    # R(z) tends to 0 like 5! / 4! ... / |z|: stiffly accurate, and so L-stable
    assert growth <= 30.0 / abs(z)


def test_one_step_has_the_error_of_order_nine():
    def error(z):
        stages = np.linalg.solve(np.eye(RADAU_STAGES) - z * A, np.ones(RADAU_STAGES))
        return abs(stages[-1] - np.exp(z))

    assert 2**9.5 <= error(-2.0) / error(-1.0) <= 2**10.5  # local error of z^10
