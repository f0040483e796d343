"""The collocation that carries sensitivities: its order conditions, and what it does with them."""

import numpy as np
import pytest

from stickslip import Axis, Coulomb, EventDriven, ensemble, simulate
from stickslip.engine import (
    EventCount,
    EventTimes,
    Final,
    Max,
    Mean,
    Min,
    Samples,
    Sensitivity,
    Status,
)
from stickslip.engine.kernels.sensitivities import RADAU, RADAU_NODES, RADAU_STAGES
from stickslip.mechanisms.drives import Sine

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

    # the terms of z^11 in it cancel in the product of both sides
    ratio = error(1.0) * error(-1.0) / (error(0.5) * error(-0.5))
    assert 2**19.4 <= ratio <= 2**20.6  # of z^10, twice


# What ensembles keep of each run, against its dense samples.

PYTHON = EventDriven(tier="python")
RIG = Axis(inertia=1.0, drive=Sine(amplitude=3.0, frequency=0.9), stiffness=2.0)
LAW = Coulomb(kinetic_coefficient=0.4, static_coefficient=0.9)
STARTS = np.array([0.0, 1.5, -0.7])
T = 4.0


def kept(outputs, t_end=T):
    """Return an ensemble and its runs one by one."""
    runs = ensemble(RIG, LAW, {"initial.x": STARTS}, t_end=t_end, outputs=outputs, solver=PYTHON)
    return runs, [simulate(RIG, LAW, t_end=t_end, y0={"x": x}, solver=PYTHON) for x in STARTS]


@pytest.mark.parametrize("state", ["x", "v"])
@pytest.mark.parametrize(
    "since", [*(pytest.param(t, marks=pytest.mark.slow) for t in (0.0, 1.3, T)), [0.5, 2.0, 3.9]]
)
def test_extrema_are_those_of_dense_samples_also_inside_steps(state, since):
    runs, single = kept({"max": Max(state, since), "min": Min(state, since)})
    for row, run in enumerate(single):
        first = np.broadcast_to(since, 3)[row]
        t = np.linspace(first, T, 40_001)
        samples = run.at(t)[state]
        size = np.abs(run[state]).max()
        # a parabola's top is missed by its curvature, some tens, times an eighth of 1e-8
        assert -1e-14 * size <= runs["max"][row] - samples.max() <= 1e-6 * size
        assert -1e-14 * size <= samples.min() - runs["min"][row] <= 1e-6 * size


def test_means_are_those_of_the_last_stretch_of_each_run():
    last = np.array([T, 1.1, 0.3])
    runs, single = kept({"x": Mean("x", last), "all": Mean("v")})
    for row, run in enumerate(single):
        edges = np.unique([T - last[row], T, *run.t[run.t > T - last[row]]])
        nodes, weights = np.polynomial.legendre.leggauss(20)
        width = np.diff(edges)[:, None]
        t = edges[:-1, None] + 0.5 * width * (1 + nodes)
        known = (run.at(t.ravel())["x"].reshape(t.shape) * weights * width).sum() / 2 / last[row]
        # both rules are exact for the interpolants; roundings of a sum
        assert abs(runs["x"][row] - known) <= 1e-13
        assert abs(runs["all"][row] - (run["x"][-1] - run["x"][0]) / T) <= 1e-11  # solver's steps


def test_samples_are_those_of_the_run_at_any_times():
    times = [0.0, 3.3, 1.7, 1.7, T]
    runs, single = kept({"x": Samples("x", times), "v": Samples("v", times)})
    assert runs["x"].shape == (3, 5)
    for row, run in enumerate(single):
        for state in ("x", "v"):
            assert runs[state][row].tolist() == run.at(times)[state].tolist()


def test_event_times_count_from_the_front_or_the_back_and_are_nan_beyond():
    reasons = ("stop", "break-away", "reversal")
    outputs = {f"first {r}": EventTimes(r, 40) for r in reasons}
    outputs |= {f"last {r}": EventTimes(r, -3) for r in reasons}
    outputs |= {f"count {r}": EventCount(r) for r in reasons}
    runs, single = kept(outputs)
    for row, run in enumerate(single):
        for reason in reasons:
            known = [event.t for event in run.events if event.reason == reason]
            front = known + [np.nan] * (40 - len(known))
            back = (known[::-1] + [np.nan] * 3)[:3]
            np.testing.assert_array_equal(runs[f"first {reason}"][row], front)
            np.testing.assert_array_equal(runs[f"last {reason}"][row], back)
            assert runs[f"count {reason}"][row] == len(known)
    assert runs["count reversal"].sum() > 6


def test_outputs_beyond_the_end_of_a_run_that_ended_early_are_nan():
    solver = EventDriven(tier="python", max_steps=2)
    outputs = {
        "early": Samples("x", [0.0, T]), "max": Max("x", since=T), "mean": Mean("x", 0.1),
        "end": Final("x"),
    }  # fmt: skip
    runs = ensemble(RIG, LAW, {"initial.x": STARTS}, t_end=T, outputs=outputs, solver=solver)
    assert all(status is Status.STEP_LIMIT for status in runs.status)
    assert np.isnan(runs["early"]).tolist() == [[False, True]] * 3
    assert np.isnan(runs["max"]).all()
    assert np.isnan(runs["mean"]).all()
    assert np.isfinite(runs["end"]).all()


def test_sensitivities_of_ensembles_are_those_of_the_runs():
    outputs = {
        f"{s} {p}": Sensitivity(s, p)
        for s in "xv"
        for p in ("inertia", "frequency", "friction.kinetic_coefficient", "initial.x")
    }
    runs, single = kept(outputs)
    for name in outputs:
        state, path = name.split()
        found = [run.at(T).sensitivity(state, path)[0] for run in single]
        assert runs[name].tolist() == found
