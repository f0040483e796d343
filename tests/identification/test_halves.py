"""Halves of a record that contradict each other, and what becomes of intervals then."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    DirectionDependent,
    Measurement,
    Pendulum,
    QuadraticDrag,
    RecordSettings,
    fit,
    simulate,
)
from stickslip.errors import InputError
from stickslip.identification.estimation.halves import Halves, blocks_of_half, widened
from stickslip.identification.estimation.jackknife import Inference, infer
from stickslip.identification.estimation.problem import ResidualJacobian
from stickslip.identification.records import refits

CLOCK = Pendulum(mass=0.2, length=0.5)


def decay_of(law, seed, *, noise=1e-3):
    run = simulate(CLOCK, law, t_end=30.0, y0={"theta": 0.8})
    t = np.arange(0.0, 30.0, 0.01)
    angle = np.asarray(run.at(np.minimum(t, run.t[-1]))["theta"])
    return Measurement(
        time=t, position=angle + noise * np.random.default_rng(seed).normal(size=len(t))
    )


@pytest.mark.parametrize("drag", [pytest.param(1e-4, marks=pytest.mark.slow), 3e-4])
def test_a_law_that_does_not_hold_is_said_first_and_intervals_cover_both_halves(drag):
    law = QuadraticDrag(
        kinetic_coefficient=0.005, viscous_coefficient=0.002, quadratic_coefficient=drag
    )
    found = fit(CLOCK, CoulombViscous, decay_of(law, 1))
    assert found.sentences[0].startswith("The two halves of the record give ")
    assert "the law does not hold over the whole record" in found.sentences[0]
    pairs = dict(
        zip(found.free_parameters.paths, zip(*found.halves.values, strict=True), strict=True)
    )
    for estimate in found.estimates:
        if estimate.bounded:
            first, second = pairs[estimate.path]
            assert estimate.low <= min(first, second) <= max(first, second) <= estimate.high


@pytest.mark.parametrize("seed", [0, *(pytest.param(i, marks=pytest.mark.slow) for i in (1, 2))])
def test_a_law_that_holds_is_not_doubted(seed):
    law = CoulombViscous(kinetic_coefficient=0.005, viscous_coefficient=0.002)
    found = fit(CLOCK, CoulombViscous, decay_of(law, seed))
    assert found.halves is not None
    assert not found.halves.contradicting
    plain = infer(found.optimum.best, found.scale)
    np.testing.assert_array_equal(found.inference.half_widths, plain.half_widths)


def test_a_table_has_no_order_and_so_no_halves():
    v = np.linspace(0.1, 1.0, 40)
    table = Measurement(velocity=v, friction=2.0 + v + 0.5 * v**3)
    found = fit(Axis(inertia=1.0), CoulombViscous, table)
    assert found.halves is None
    assert not any("halves" in line for line in found.sentences)


def halves_of_a_mean(rows):
    """Return the halves of a record of which a mean and a slope are looked for."""
    columns = np.column_stack([np.ones(len(rows)), np.sin(np.arange(len(rows)))])
    values, known = [], []
    for part in np.array_split(np.arange(len(rows)), 2):
        own = np.linalg.lstsq(columns[part], rows[part], rcond=None)[0]
        seen = ResidualJacobian(
            values=own,
            residual=rows[part] - columns[part] @ own,
            slopes=columns[part],
            segment=np.zeros(len(part), dtype=int),
        )
        values.append(own)
        known.append(infer(seen, np.eye(2), blocks=blocks_of_half(seen)))
    return Halves.of(tuple(values), tuple(known))


# 1 % is asked for; blocks of 100 rows, five correlation lengths, are nearly independent
@pytest.mark.parametrize(
    ("count", "most"), [(100, 0.04), pytest.param(500, 0.025, marks=pytest.mark.slow)]
)
def test_halves_contradict_each_other_seldom_where_the_law_holds_and_residuals_are_correlated(
    count, most
):
    random, alarms, seen = np.random.default_rng(3), 0, 0
    for _ in range(count):
        rows = lfilter([1.0], [1.0, -0.9], random.normal(size=800))
        alarms += bool(halves_of_a_mean(rows).contradicting)
        # the mean shifts by 4 standard deviations of the noise, 9 standard errors of either half
        shifted = rows + np.where(np.arange(800) < 400, 0.0, 9.2)
        seen += bool(halves_of_a_mean(shifted).contradicting)
    assert alarms / count <= most
    assert seen / count >= 0.5


def test_what_a_half_does_not_show_contradicts_nothing_and_widens_nothing():
    own = Inference(
        covariance=np.diag([1.0, 4.0]),
        naive=np.eye(2),
        freedom=np.array([7.0, 7.0]),
        condition=1.0,
        effective=100.0,
    )
    apart = Halves(
        values=(np.array([30.0, 5.0]), np.array([-40.0, 1e6])),
        errors=np.array([2.0, math.inf]),
        freedom=np.array([6.0, 1.0]),
    )
    assert list(apart.contradicting) == [0]
    wide = widened(own, np.zeros(2), apart)
    assert wide.half_widths[0] >= 40.0
    assert wide.half_widths[1] == own.half_widths[1]
    assert np.all(np.linalg.eigvalsh(wide.covariance) > 0.0)


def test_halves_of_several_trials_are_not_called_those_of_a_record():
    draw, time = np.random.default_rng(0), 0.01 * np.arange(400)
    v = 0.3 * np.sin(7.0 * time)
    trials = tuple(
        Measurement(
            time=time,
            velocity=v,
            friction=level * np.sign(v) + 0.1 * draw.normal(size=400),
        )
        for level in (5.0, 6.0)
    )
    found = fit(Axis(inertia=1.0), Coulomb, Measurement(trials=trials))
    assert found.halves.contradicting
    assert "The first and second half of the trials give mu_k" in found.sentences[0]
    assert "not hold over all trials" in found.sentences[0]


def test_a_half_that_cannot_be_built_leaves_no_halves(monkeypatch):
    def refused(*_arguments):
        raise InputError("a half is too short")

    v = np.linspace(-1.0, 1.0, 80)
    table = Measurement(velocity=v, friction=2.0 * np.sign(v) + 0.01 * np.cos(40.0 * v))
    found = fit(Axis(inertia=1.0), Coulomb, table)
    monkeypatch.setattr(refits, "refitted", refused)
    assert refits.halves_of(found) is None


@pytest.mark.slow
@pytest.mark.parametrize("zero", [1.6e-3, -0.05])
def test_a_displaced_zero_of_the_encoder_makes_no_friction_that_differs_by_direction(zero):
    true = CoulombViscous(kinetic_coefficient=0.02, viscous_coefficient=0.003)
    right = decay_of(true, 1)
    wrong = replace(right, position=right.position + zero)
    both = [fit(CLOCK, CoulombViscous, one) for one in (right, wrong)]
    # only a zero that is estimated leaves everything else as it was, to the search's tolerance
    for one, other in zip(*(each.estimates for each in both), strict=True):
        assert other.value == pytest.approx(one.value, rel=1e-3)
    assert any("zero of the position is not known" in line for line in both[1].sentences)
    (found,) = both[1].problem.zeros(both[1].optimum.best).values()
    assert abs(found.value - zero) < 6.0 * found.error
    levels = {e.path: e for e in fit(CLOCK, DirectionDependent, wrong).estimates}
    gaps = [levels[f"friction.{side}ward_kinetic_coefficient"] for side in ("for", "back")]
    assert gaps[0].low <= gaps[1].high
    assert gaps[1].low <= gaps[0].high


def test_a_zero_that_is_known_is_not_estimated():
    true = CoulombViscous(kinetic_coefficient=0.02, viscous_coefficient=0.003)
    record = decay_of(true, 1)
    found = fit(
        CLOCK, CoulombViscous, record, settings=RecordSettings(position_zeros=False, starts=1)
    )
    assert not any("zero of the position" in line for line in found.sentences)
    assert found.law.kinetic_coefficient == pytest.approx(0.02, rel=0.05)
