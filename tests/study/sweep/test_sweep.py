"""Campaigns: mean velocity, basins, against closed forms and symmetries."""

import dataclasses
import math

import numpy as np
import pytest

from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    EventDriven,
    Pendulum,
    PendulumCart,
    Viscous,
    ensemble,
    simulate,
)
from stickslip.engine import Status
from stickslip.errors import InputError
from stickslip.identify.criteria import criteria_of
from stickslip.mechanisms import Prescribed, Torque
from stickslip.mechanisms.drives import Pulse, Sine, SineSwing, ThreePhase, TimedThreePhase
from stickslip.study.sweep import VelocityMap, average_velocity, basins, cycle_of, velocity_band
from stickslip.study.sweep.attractors import cycles_in, period_of
from stickslip.study.sweep.parameter_grid import early_ends

PLAIN = EventDriven(tier="python")
"""Runs in plain Python, which need no compiling; the numbers are those of compiled runs."""
FREQUENCY = "mechanism.drive.drive.frequency"


def capsule(**changes):
    drive = Torque(drive=Sine(amplitude=1.0, frequency=4.0))
    settings = {"stiffness": 100.0, "damping": 0.3, "restitution": 0.6, "drive": drive} | changes
    return Capsule(capsule_mass=0.8, inner_mass=0.2, **settings)


def test_three_phase_capsule_moves_on_as_its_closed_form_says():
    fast, slow, p, g = 50.0, 9.81, 0.2, 9.81
    stroke = ThreePhase(amplitude=0.01, fast=fast, slow=slow, first="slow")
    levels = np.array([0.2, 0.25, 0.3])
    found = average_velocity(
        capsule(drive=Prescribed(profile=stroke), stiffness=0.0, damping=0.0),
        Coulomb(kinetic_coefficient=0.2),
        {"kinetic_coefficient": levels},
        settle=2,
        cycles=4,
        solver=PLAIN,
    )
    peak = math.sqrt(2 * 0.02 / (1 / slow + 1 / fast))
    quick = 2 * peak / fast
    v_m = (p * fast - levels * g) * quick
    travel = v_m * quick / 2 + v_m**2 / (2 * (levels * g + p * slow))
    expected = travel / (2 * peak / slow + quick)
    # the pieces are polynomials, stepped exactly; what is left is rounding over six cycles
    np.testing.assert_allclose(found.velocity, expected, rtol=1e-9)
    assert (found.unsettled < 1e-9).all()
    assert found.certified.all()
    assert found.period == pytest.approx(float(stroke.period))


@pytest.mark.parametrize(
    "stroke",
    [
        ThreePhase(amplitude=0.01, fast=5.0, slow=1.0, first="slow"),
        TimedThreePhase(
            amplitude=0.01, first_duration=0.3, middle_duration=0.12, last_duration=0.3
        ),
    ],
)
def test_the_frequency_of_three_phases_is_swept_though_none_was_given(stroke):
    frequencies, law = [6.0, 9.0], Coulomb(kinetic_coefficient=0.2)
    one = capsule(drive=Prescribed(profile=stroke), stiffness=0.0, damping=0.0)
    found = average_velocity(one, law, {"frequency": frequencies}, settle=2, cycles=2, solver=PLAIN)
    assert [*found.axes] == ["mechanism.drive.profile.frequency"]
    assert found.units == {"mechanism.drive.profile.frequency": "Hz"}
    np.testing.assert_allclose(found.period, 1 / np.array(frequencies))
    for f, velocity in zip(frequencies, found.velocity, strict=True):
        # the same way in another time: accelerations go with the square of the frequency
        s = f * stroke.period
        first, middle, _ = (s * s * size for size in stroke.accelerations)
        own = ThreePhase(amplitude=0.01, fast=middle, slow=first, first="slow")
        assert own.period == pytest.approx(1 / f, rel=1e-12)
        run = simulate(dataclasses.replace(one, drive=Prescribed(profile=own)), law, t_end=4 / f)
        x = run.at([2 / f, 4 / f])["x"]
        assert velocity == pytest.approx((x[1] - x[0]) / (2 / f), rel=1e-9)
    runs = ensemble(one, law, {"frequency": frequencies}, t_end=0.5, solver=PLAIN)
    assert [status.complete for status in runs.status] == [True, True]


def test_pendulum_cart_moves_on_as_published_checks_say():
    swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    cart = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    )
    found = average_velocity(
        cart, Coulomb(kinetic_coefficient=0.2), {"kinetic_coefficient": [0.2]}, settle=2, cycles=2,
        solver=PLAIN,
    )  # fmt: skip
    # .0634659 m in .72360 s: the reference has six digits
    assert found.velocity[0] == pytest.approx(0.0634659 / 0.72360, rel=1e-5)


@pytest.mark.slow
def test_a_mirrored_capsule_moves_the_other_way_as_fast():
    axis = {FREQUENCY: [3.5, 5.0]}
    law = Coulomb(kinetic_coefficient=0.05)
    settings = {"settle": 20, "cycles": 4, "solver": PLAIN}
    moved = average_velocity(capsule(upper_stop=0.02), law, axis, **settings)
    turned = Torque(drive=Sine(amplitude=-1.0, frequency=4.0))
    other = average_velocity(capsule(lower_stop=-0.02, drive=turned), law, axis, **settings)
    # mirrored equations have mirrored rounding, but events are located from the other side
    np.testing.assert_allclose(other.velocity, -moved.velocity, rtol=1e-7)
    assert moved.velocity[0] > 0.01
    assert moved.velocity[1] < -0.005  # beyond resonance the same drive carries it back


@pytest.mark.slow  # a mirrored drive, below, shows both directions
def test_without_a_stop_a_symmetric_drive_carries_nothing_anywhere():
    found = average_velocity(
        capsule(), Coulomb(kinetic_coefficient=0.05), {FREQUENCY: [3.5, 4.5]}, settle=60, cycles=4,
        solver=PLAIN,
    )  # fmt: skip
    with_stop = 0.01
    # what is left of the start decays with the damping; 60 cycles leave less than a 1e-4 of it
    assert (np.abs(found.velocity) < 1e-4 * with_stop).all()


def test_back_slip_is_motion_against_the_travel_whichever_way_that_goes():
    law, seen = Coulomb(kinetic_coefficient=0.05), []
    for side in (1.0, -1.0):
        stop = {"upper_stop": 0.02} if side > 0 else {"lower_stop": -0.02}
        drive = Torque(drive=Sine(amplitude=side, frequency=4.0))
        one = capsule(drive=drive, **stop)
        run = simulate(one, law, t_end=1.5)
        seen.append((cycles_in(run, one, 0.25)[-1], criteria_of(run, one)))
    (there, whole), (back, mirrored) = seen
    assert back.travel == pytest.approx(-there.travel, rel=1e-6)
    # mirrored equations round alike, but for the events
    assert back.back_slip == pytest.approx(there.back_slip, rel=1e-6)
    assert there.backward == there.back_slip
    assert back.backward == pytest.approx(there.back_slip + there.travel, rel=1e-6)
    assert mirrored.largest_return == pytest.approx(whole.largest_return, rel=1e-6)
    assert not mirrored.displacement_never_decreases


def test_runs_that_end_early_have_no_mean_velocity():
    stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    weak = Prescribed(profile=stroke, limit=1.0)
    found = average_velocity(
        capsule(drive=weak, stiffness=0.0, damping=0.0), Coulomb(kinetic_coefficient=0.2),
        {"mechanism.drive.limit": [1.0, 100.0]}, settle=1, cycles=2, solver=PLAIN,
    )  # fmt: skip
    assert np.isnan(found.velocity).tolist() == [True, False]
    assert found.status[0] is Status.LIMIT
    (sentence,) = found.early_ends()
    assert sentence == (
        "At 1 of 2 points (limit 1 N m) the run stopped: The mechanism reached one of its limits."
        " No mean velocity there."
    )
    assert sentence in str(found)
    assert found.to_dataframe()["reason"].tolist() == [Status.LIMIT.value, ""]


def limited():
    """Return a capsule whose drive cannot give the force of its stroke."""
    drive = Prescribed(profile=SineSwing(amplitude=0.01, frequency=0.5), limit=1e-3)
    return capsule(drive=drive, stiffness=0.0, damping=0.0)


def test_starts_that_lead_to_no_attractor_have_a_reason():
    found = basins(
        limited(), Coulomb(kinetic_coefficient=0.2), {"x": [0.0, 0.001], "v": [0.0, 0.1]},
        settle=1, keep=2, solver=PLAIN,
    )  # fmt: skip
    assert (found.index == -1).all()
    assert str(found).startswith("0 of 4 starts lead to 0 attractors.\nAt 4 of 4 starts (x within")
    assert found.to_dataframe()["reason"].tolist() == 4 * [Status.LIMIT.value]


def test_ranges_without_a_value_are_named_one_by_one_where_they_are_few():
    ends = {True: Status.END_TIME, False: Status.ZENO}

    def places(*complete):
        status = np.array([ends[bool(one)] for one in complete], dtype=object)
        axes = {"a.frequency": np.arange(1.0, 1.0 + len(complete))[::-1]}
        (sentence,) = early_ends(status, "", axes, {"a.frequency": "Hz"})
        return sentence.partition(" the run")[0]

    assert places(0, 0, 1) == "At 2 of 3 points (frequency 2 to 3 Hz)"
    assert places(0, 1, 0) == "At 2 of 3 points (frequency 1 Hz, 3 Hz)"
    assert places(0, 1, 0, 1, 0, 1, 0) == "At 4 of 7 points (frequency within 1 to 7 Hz)"


def line(values, velocity):
    velocity = np.asarray(velocity, dtype=float)
    return VelocityMap(
        axes={"f": np.asarray(values, dtype=float)},
        units={"f": "Hz"},
        unit="m/s",
        velocity=velocity,
        unsettled=np.zeros_like(velocity),
        closes=np.ones(velocity.shape, dtype=int),
        spread=np.full(velocity.shape, np.nan),
        chaotic=np.zeros(velocity.shape, dtype=bool),
        period=np.ones_like(velocity),
        status=np.full(velocity.shape, Status.END_TIME, dtype=object),
        certified=np.ones(velocity.shape, dtype=bool),
    )


def test_reversals_lie_on_the_straight_line_between_signs():
    assert line([1, 2, 3, 4], [3.0, 1.0, -3.0, -1.0]).reversals().tolist() == [2.25]


def test_over_points_without_motion_the_middle_is_the_reversal():
    assert line([1, 2, 3, 4], [3.0, 0.0, 1e-9, -1.0]).reversals().tolist() == [2.5]


def test_a_body_that_stops_moving_does_not_turn():
    assert line([1, 2, 3], [1.0, 0.0, 0.0]).reversals().size == 0


@pytest.mark.slow
def test_grids_have_a_dimension_for_each_axis_and_a_row_for_each_point():
    drive = Sine(amplitude=4.0, frequency=1.0)
    found = average_velocity(
        Axis(inertia=1.0, drive=drive), Coulomb(kinetic_coefficient=1.0),
        {"frequency": [1.0, 2.0, 3.0], "amplitude": [3.0, 4.0]}, settle=2, cycles=2, solver=PLAIN,
    )  # fmt: skip
    assert found.velocity.shape == (3, 2)
    table = found.to_dataframe()
    assert table["mechanism.drive.frequency"].tolist() == [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]
    np.testing.assert_allclose(table["period"], [1.0, 1.0, 0.5, 0.5, 1 / 3, 1 / 3])


def test_progress_counts_all_runs_and_can_end_them():
    seen = []

    def stop(done, total):
        seen.append((done, total))
        return False

    found = average_velocity(
        Axis(inertia=1.0, drive=Sine(amplitude=4.0, frequency=1.0)),
        Coulomb(kinetic_coefficient=1.0),
        {"frequency": [1.0, 2.0]},
        settle=1,
        cycles=2,
        solver=PLAIN,
        progress=stop,
    )
    assert seen == [(1, 2)]
    # short cycles are run first
    assert [status.name for status in found.status] == ["CANCELLED", "END_TIME"]


def test_a_cycle_is_that_of_the_slowest_drive():
    both = Sine(amplitude=1.0, frequency=2.0) + Sine(amplitude=1.0, frequency=6.0)
    assert cycle_of(Axis(inertia=1.0, drive=both)) == 0.5


@pytest.mark.parametrize(
    ("drive", "words"),
    [
        (None, "has no drive"),
        (Pulse(level=1.0, duration=1.0), "not known to be periodic"),
        (Sine(amplitude=1.0, frequency=2.0) + Sine(amplitude=1.0, frequency=3.0), "common period"),
    ],
)
def test_what_has_no_cycle_is_refused_with_the_cure(drive, words):
    with pytest.raises(InputError, match=words) as caught:
        cycle_of(Axis(inertia=1.0, drive=drive))
    assert "give the period [s] explicitly" in str(caught.value)


def swinging_cart(amplitude):
    swing = ThreePhase(amplitude=amplitude, fast=120.0, slow=30.0)
    return PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    )


def test_mean_velocity_over_amplitudes_is_that_of_runs_of_their_own():
    law = Coulomb(kinetic_coefficient=0.2)
    path, amplitudes = "mechanism.pendulum.profile.amplitude", [0.6, 0.785]
    found = average_velocity(
        swinging_cart(0.7), law, {path: amplitudes}, settle=4, cycles=2, solver=PLAIN
    )
    for velocity, amplitude in zip(found.velocity, amplitudes, strict=True):
        cart = swinging_cart(amplitude)
        cycle = cycle_of(cart)
        x = simulate(cart, law, t_end=6 * cycle).at([4 * cycle, 6 * cycle])["x"]
        # the runs share an end, a little later for the shorter cycle, when they have settled
        assert velocity == pytest.approx((x[1] - x[0]) / (2 * cycle), rel=1e-6)


def test_a_chaotic_looking_series_has_no_period():
    logistic = [0.3]
    for _ in range(40):
        logistic.append(3.9 * logistic[-1] * (1 - logistic[-1]))
    assert period_of(np.array(logistic), 1.0) == 0


def test_a_thrown_pendulum_comes_to_hang_after_whole_turns():
    clock = Pendulum(mass=1.0, length=0.5, damping=0.15)
    found = basins(
        clock,
        Viscous(viscous_coefficient=0.05),
        {"theta": [0.0, 0.5], "omega": [-12.0, 0.0, 12.0]},
        settle=40,
        keep=4,
        period=1.0,
        solver=PLAIN,
    )
    ends = np.array([motion.points[-1, 0] for motion in found.attractors]) / (2 * np.pi)
    np.testing.assert_allclose(ends, np.round(ends), atol=1e-6)  # it rests below, and only there
    assert len(set(np.round(ends))) == len(ends) > 1
    assert found.index[0, 1] == found.index[1, 1]
    assert found.attractors[found.index[0, 1]].points[-1, 0] == pytest.approx(0.0, abs=1e-6)
    assert sum(motion.share for motion in found.attractors) == pytest.approx(1.0)
    # thrown the other way from below it turns the other way as often
    turns = ends[found.index[0, [0, 2]]]
    assert turns[0] == pytest.approx(-turns[1], abs=1e-6)


def test_a_motion_is_the_same_whatever_cycle_a_run_falls_into_it():
    from stickslip.study.sweep.attractors import Attractor, _same

    points = np.array([[1.0], [2.0], [1.0], [2.0]])
    attractor = Attractor(points=points, period=2, velocity=0.0, share=1.0)
    limit = np.array([1e-3])
    assert _same(attractor, np.roll(points, 1, axis=0), 2, limit)
    assert not _same(attractor, points + 0.1, 2, limit)
    assert not _same(attractor, points, 1, limit)


def test_wrong_counts_are_refused():
    axis = Axis(inertia=1.0, drive=Sine(amplitude=4.0, frequency=1.0))
    law = Coulomb(kinetic_coefficient=1.0)
    with pytest.raises(InputError, match="cycles must be even"):
        average_velocity(axis, law, {"frequency": [1.0]}, cycles=3)
    with pytest.raises(InputError, match="keep must be a whole number"):
        basins(axis, law, {"x": [0.0], "v": [0.0]}, keep=1)
    with pytest.raises(InputError, match="two states"):
        basins(axis, law, {"x": [0.0]})
    with pytest.raises(InputError, match="array"):
        average_velocity(axis, law, {"frequency": "fast"})


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"cycles": "a"}, "cycles must be a whole number .* got 'a'"),
        ({"cycles": math.nan}, "cycles must be a whole number .* got nan"),
        ({"settle": None}, "settle must be a whole number .* got None"),
        ({"settle": 10**9}, "settle must be a whole number of 0 to 1000000"),
        ({"settle": 400_000}, "400020 cycles are too many"),
    ],
)
def test_cycles_that_cannot_be_run_are_refused_before_anything_is(settings, words, monkeypatch):
    monkeypatch.setattr(
        "stickslip.study.sweep.mean_velocity.ensemble", None
    )  # would be no InputError
    with pytest.raises(InputError, match=words):
        average_velocity(
            swinging_cart(0.7), Coulomb(kinetic_coefficient=0.2), {"fast": [120.0]}, **settings
        )


def test_what_is_no_law_is_refused_by_each_campaign():
    axis = Axis(inertia=1.0, drive=Sine(amplitude=4.0, frequency=1.0))
    for campaign in (
        lambda: average_velocity(axis, None, {"frequency": [1.0]}),
        lambda: basins(axis, None, {"x": [0.0], "v": [0.0]}),
    ):
        with pytest.raises(InputError, match="law must be a friction law"):
            campaign()


def test_results_are_frozen():
    found = line([1, 2], [1.0, 2.0])
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.unit = "m"


@pytest.mark.slow
def test_a_band_of_velocities_holds_the_laws_and_their_errors():
    law = Coulomb(kinetic_coefficient=0.2)
    stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    mechanism = capsule(drive=Prescribed(profile=stroke), stiffness=0.0, damping=0.0)
    laws = [dataclasses.replace(law, kinetic_coefficient=mu) for mu in np.linspace(0.2, 0.3, 21)]
    frequencies = {"mechanism.drive.profile.frequency": [1.0, 1.382]}
    settings = {"settle": 2, "cycles": 2, "solver": PLAIN}
    band = velocity_band(mechanism, laws, frequencies, level=0.9, **settings)
    each = [average_velocity(mechanism, law, frequencies, **settings).velocity for law in laws]
    np.testing.assert_allclose(band.velocities, each)
    np.testing.assert_allclose(band.low, np.quantile(each, 0.05, axis=0))
    quicker = int(np.argmax(np.median(each, axis=0)))
    assert band.fastest == [1.0, 1.382][quicker]
    wider = dataclasses.replace(band, error=0.01)
    # of a law alone, it is the quantile of Student's t with four degrees of freedom
    alone = dataclasses.replace(wider, velocities=band.velocities[:1])
    assert alone.high[1] - alone.median[1] == pytest.approx(0.01 * 2.132, rel=0.05)
    assert (wider.low < band.low).all()
    assert "90 % band over 21 laws" in str(band) or "90% band over 21 laws" in str(band)


def test_a_band_of_velocities_needs_laws_and_one_parameter():
    with pytest.raises(InputError, match="takes laws and one parameter, got 0 laws and 1"):
        velocity_band(capsule(), [], {FREQUENCY: [1.0]})
