"""Mean velocities and travels per cycle as trials, and bodies that do not come to rest."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from stickslip import (
    Capsule,
    Coulomb,
    Dahl,
    Measurement,
    SpringBlock,
    Stribeck,
    Viscous,
    fit,
    load_measurement,
    load_rig,
    select,
    simulate,
)
from stickslip.data.travels import scale_of
from stickslip.errors import ConvergenceError, InputError, ParameterError
from stickslip.identify.fits.travel_model import (
    standard_errors,
    trials_of,
    under_cycles,
)
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import Pulse, Sine, Square

WAVE = Square(high=6.0, low=-1.0, period=0.4, duty=0.3)
CAPSULE = Capsule(
    capsule_mass=0.8, inner_mass=0.2, stiffness=80.0, damping=0.8, drive=Torque(drive=WAVE)
)
PERIOD = "mechanism.drive.drive.period"
TRUTH = Coulomb(kinetic_coefficient=0.18)
BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
END = 3.0


def capsule(period):
    return replace(CAPSULE, drive=Torque(drive=replace(WAVE, period=period)))


def way(period, end):
    run = simulate(capsule(period), TRUTH, t_end=end)
    return float(run["x"][-1])


def readings(name, values, error, **more):
    """Return trials of one quantity by period."""
    return Measurement(
        trials=tuple(
            Measurement(**{name: value}, uncertainty=error, overrides={PERIOD: period}, **more)
            for period, value in values.items()
        )
    )


def test_mean_velocities_are_fitted_as_the_travels_that_they_stand_for():
    noise = dict(zip((0.3, 0.4, 0.5), (1e-3, -2e-3, 1.5e-3), strict=True))
    ways = {period: way(period, END) + noise[period] for period in noise}
    speeds = {period: one / END for period, one in ways.items()}
    by_travel = fit(CAPSULE, TRUTH, readings("travel", ways, 2e-3), t_end=END)
    by_speed = fit(CAPSULE, TRUTH, readings("mean_velocity", speeds, 2e-3 / END), t_end=END)
    # the same numbers but for the rounding of a quotient and a product
    np.testing.assert_allclose(by_speed.measured, by_travel.measured, rtol=1e-15)
    (estimate,), (other,) = by_speed.estimates, by_travel.estimates
    assert (estimate.value, estimate.low, estimate.high) == pytest.approx(
        (other.value, other.low, other.high), rel=1e-9
    )
    assert estimate.low < 0.18 < estimate.high


def test_travels_per_cycle_at_several_periods_need_one_end_time_only():
    """3.1 s are 10, 7 and 6 whole cycles and a rest of each: the rest is no part of the mean."""
    counts = {0.3: 10, 0.4: 7, 0.5: 6}
    each = {period: way(period, n * period) / n for period, n in counts.items()}
    measured = readings("travel_per_cycle", each, 1e-4)
    trials = trials_of(CAPSULE, measured, 3.1)
    assert [trial.cycles for trial in trials] == [10, 7, 6]
    assert [trial.half_width for trial in trials] == pytest.approx([1e-3, 7e-4, 6e-4])
    assert [trial.until(3.1) for trial in trials] == pytest.approx([3.0, 2.8, 3.0])
    found = fit(CAPSULE, Coulomb(kinetic_coefficient=0.2), measured, t_end=3.1)
    assert found.law.kinetic_coefficient == pytest.approx(0.18, rel=1e-6)
    assert max(map(abs, found.residuals)) < 1e-8  # runs are exact to that


def test_a_whole_run_of_cycles_is_one_run_whatever_was_read():
    (trial,) = trials_of(CAPSULE, Measurement(travel_per_cycle=0.01), 15 * 0.4)
    assert (trial.scale, trial.until(15 * 0.4)) == (15.0, 15 * 0.4)
    assert scale_of(CAPSULE, Measurement(travel=0.01), 6.0, "") == (1.0, None)


@pytest.mark.parametrize(
    ("mechanism", "said"),
    [
        (BLOCK, "SpringBlock has no drive"),
        (
            replace(CAPSULE, drive=Torque(drive=Pulse(level=5.0, duration=0.1))),
            "is a Pulse, which is not known to be periodic. Give travel or mean_velocity",
        ),
        (capsule(4.0), "one whole cycle of 4 s.*t_end = 3 s. Increase t_end"),
    ],
)
def test_a_travel_per_cycle_needs_a_cycle(mechanism, said):
    with pytest.raises(InputError, match=f"travel_per_cycle.*{said}"):
        fit(mechanism, TRUTH, Measurement(travel_per_cycle=0.01), t_end=END)


def test_a_trial_gives_one_of_the_three():
    with pytest.raises(InputError, match="only one of travel, mean_velocity, travel_per_cycle"):
        Measurement(travel=0.2, mean_velocity=0.1)


def test_the_last_digit_of_a_mean_velocity_is_that_of_the_velocity():
    """0.0123 m/s over 6 s is 0.0738 m, known no better than to 6 s times 0.1 mm/s."""
    errors, stated = standard_errors(trials_of(BLOCK, Measurement(mean_velocity=0.0123), 6.0))
    assert not stated
    assert errors[0] == pytest.approx(6.0 * 1e-4 / math.sqrt(12.0))


def test_the_offset_of_a_travel_is_subtracted():
    fitted = fit(BLOCK, Coulomb, Measurement(travel=0.25, offset={"travel": 0.05}))
    assert fitted.measured == pytest.approx((0.20,))


def test_an_array_of_travels_is_repeats_of_one_run():
    together = fit(BLOCK, Coulomb, Measurement(travel=[0.20, 0.202], uncertainty=1e-3))
    apart = [Measurement(travel=value, uncertainty=1e-3) for value in (0.20, 0.202)]
    other = fit(BLOCK, Coulomb, Measurement(trials=tuple(apart)))
    assert together.law == other.law
    assert together.measured == (0.20, 0.202)


def test_a_sum_with_a_part_that_repeats_is_a_drive_that_repeats():
    shaken = SpringBlock(
        mass=1.0, drive=Sine(amplitude=9.0, frequency=1.0) + Pulse(level=2.0, duration=0.1)
    )
    assert under_cycles(trials_of(shaken, Measurement(travel=0.1), 2.0))


RIG = """
[mechanism]
type = "capsule"
capsule_mass = "800 g"
inner_mass = "200 g"
stiffness = "80 N/m"
damping = "0.8 N s/m"

[mechanism.drive]
type = "torque"
drive = { type = "square", high = "6 N", low = "-1 N", period = "400 ms", duty = "30 %" }

[run]
t_end = "6 s"
"""


def rig(folder, text):
    file = folder / "rig.toml"
    file.write_text(RIG + text)
    return file


def test_a_rig_file_gives_mean_velocities_and_travels_per_cycle_in_their_own_units(tmp_path):
    read = load_rig(
        rig(
            tmp_path,
            """
            [[trial]]
            mean_velocity = "12 mm/s"
            uncertainty = "0.5 mm/s"

            [[trial]]
            travel_per_cycle = "5 mm"
            uncertainty = 1e-4
            """,
        )
    )
    first, second = read.measurement.records()
    assert (first.mean_velocity, first.uncertainty) == (0.012, {"mean_velocity": 0.0005})
    assert (second.travel_per_cycle, second.uncertainty) == (0.005, {"travel_per_cycle": 1e-4})
    trials = trials_of(read.mechanism, read.measurement, read.t_end)
    assert [trial.travel for trial in trials] == pytest.approx([0.072, 0.075])
    assert [trial.half_width for trial in trials] == pytest.approx([0.003, 0.0015])


@pytest.mark.parametrize(
    ("trial", "said"),
    [
        ('mean_velocity = "12 mm/s"\nuncertainty = "1 mm"', "trial.0.uncertainty.*m/s"),
        ('mean_velocity = "12 mm"', "trial.0.mean_velocity.*m/s"),
        ('travel_per_cycle = "5 mm"\nuncertainty = "-1 mm"', "trial.0.uncertainty.*above 0"),
        ('travel = "5 mm"\nmean_velocity = 0.1', "travel and mean_velocity both.*give only one of"),
        ('name = "run"', "Add travel.*or mean_velocity, travel_per_cycle"),
        ("mean_velocity = 0.1\ngain = { force = 2 }", "gain applies to the file"),
        (
            'travel_per_cycle = 0.1\nset = { mechanism.drive.drive.period = "7 s" }',
            "rig.toml: trial.0: travel_per_cycle.*one whole cycle of 7 s",
        ),
    ],
)
def test_a_rig_file_names_what_is_wrong_with_a_trial(tmp_path, trial, said):
    with pytest.raises(InputError, match=said):
        load_rig(rig(tmp_path, f"[[trial]]\n{trial}\n"))


def test_tables_give_mean_velocities_with_their_uncertainty(tmp_path):
    file = tmp_path / "speeds.csv"
    file.write_text(
        f"mean_velocity [mm/s],uncertainty [mm/s],{PERIOD} [s]\n12,0.5,0.4\n9,0.5,0.3\n"
    )
    first, second = load_measurement(file, mechanism=CAPSULE).records()
    assert (first.mean_velocity, first.uncertainty) == (0.012, {"mean_velocity": 0.0005})
    assert second.overrides == {PERIOD: 0.3}
    file.write_text("mean_velocity [mm/s],uncertainty [mm]\n12,0.5\n")
    with pytest.raises(ParameterError, match=r"uncertainty.*m/s"):
        load_measurement(file)
    file.write_text("mean_velocity [mm/s],travel [mm]\n12,72\n")
    with pytest.raises(InputError, match=r"line 2.*give only one of travel"):
        load_measurement(file)


def test_a_table_of_a_rig_is_checked_for_cycles(tmp_path):
    (tmp_path / "ways.csv").write_text(f"travel_per_cycle [mm],{PERIOD} [s]\n5,0.4\n5,7\n")
    with pytest.raises(InputError, match=r"ways.csv, line 3.*one whole cycle of 7 s"):
        load_rig(rig(tmp_path, '[data]\nfile = "ways.csv"\n'))


@pytest.mark.slow
def test_the_report_shows_what_was_read():
    from stickslip.identify.kinds.travels import trials_section

    speeds = {0.3: way(0.3, END) / END, 0.4: way(0.4, END) / END}
    verdict = select(CAPSULE, [Coulomb], readings("mean_velocity", speeds, 1e-3), t_end=END)
    (table,) = trials_section(verdict).blocks
    assert all("m/s" in str(row.cells) for row in table.rows)
    # an exact law predicts what it was made with
    np.testing.assert_allclose(verdict.compared()["measured"], [*speeds.values()], rtol=1e-12)
    np.testing.assert_allclose(verdict.compared()["predicted"], [*speeds.values()], rtol=1e-6)


def test_mean_velocities_beside_travels_are_shown_as_travels():
    ways = {period: way(period, END) for period in (0.3, 0.4, 0.5)}
    speeds = readings("mean_velocity", {0.3: ways.pop(0.3) / END}, 1e-3)
    both = Measurement(trials=(*speeds.trials, *readings("travel", ways, 3e-3).trials))
    verdict = select(CAPSULE, [Coulomb], both, t_end=END)
    expected = [way(period, END) for period in (0.3, 0.4, 0.5)]
    np.testing.assert_allclose(verdict.compared()["measured"], expected, rtol=1e-12)
    drawing = verdict.drawing()
    assert drawing.names[1] == "travel"
    drawn = np.interp(0.4, drawing.speeds, drawing.law)
    assert drawn == pytest.approx(way(0.4, END), rel=0.05)


SLOPE = replace(BLOCK, incline=-0.1)
LEVEL = replace(BLOCK, attached=True)


def test_a_block_that_slides_on_down_an_incline_has_no_travel_to_rest():
    """Viscous friction has no level: the block goes on at m g sin(0.1) / c."""
    with pytest.raises(ConvergenceError, match=r"Viscous friction does not bring.*not slow down"):
        fit(SLOPE, Viscous, Measurement(travel=0.5, uncertainty=0.005), t_end=5.0)


def test_a_mean_velocity_needs_no_rest():
    speed = simulate(SLOPE, Viscous(viscous_coefficient=8.0), t_end=5.0)["x"][-1] / 5.0
    found = fit(SLOPE, Viscous, Measurement(mean_velocity=speed), t_end=5.0)
    assert found.law.viscous_coefficient == pytest.approx(8.0, rel=1e-6)


def test_what_creeps_to_its_end_within_the_uncertainty_counts_as_at_rest():
    """A strongly damped block creeps to the end of its spring with the time constant c / k."""
    law, constant = Viscous(viscous_coefficient=100.0), 1.0 - 100.0 / 100.0**2
    for end, error, rests in ((10.0, 1e-3, True), (10.0, 1e-6, False), (2.0, 1e-3, False)):
        left = 0.1 * math.exp(-end / constant)
        assert (left < error) is rests  # what the case is made for
        seen = float(simulate(LEVEL, law, t_end=end)["x"][-1])
        measured = Measurement(travel=seen, uncertainty=error)
        if rests:
            found = fit(LEVEL, law, measured, t_end=end)
            assert found.predicted[0] == pytest.approx(seen, abs=1e-5)  # a hundredth of the error
        else:
            with pytest.raises(
                ConvergenceError, match=r"farther in the same time again. Increase t_end"
            ):
                fit(LEVEL, law, measured, t_end=end)


def test_a_run_that_ends_too_early_for_coulomb_friction_is_told_what_to_do():
    """It is at v - mu g t after leaving the spring, and would go on for v / (mu g)."""
    law = Coulomb(kinetic_coefficient=0.1)
    early = float(simulate(BLOCK, law, t_end=0.5)["x"][-1])
    reading = Measurement(travel=early, uncertainty=1e-3)
    with pytest.raises(ConvergenceError, match=r"at t_end = 0.5 s it still moves.*Increase t_end"):
        fit(BLOCK, law, reading, t_end=0.5)
    assert fit(BLOCK, law, reading, t_end=5.0).law.kinetic_coefficient > 0.1
    with pytest.raises(ConvergenceError, match=r"no value of .* does not bring the body to rest"):
        fit(BLOCK, Coulomb, Measurement(travel=0.2), t_end=0.2)


@pytest.mark.slow
def test_a_law_whose_bristles_creep_is_at_rest_within_the_scatter_of_unrounded_readings():
    """Numbers with sixteen digits state no error: what they scatter about the law by is one."""
    scatter = 1e-3 * np.random.default_rng(1).normal(size=6)
    trials = []
    for x, error in zip(np.linspace(0.12, 0.26, 6).tolist(), scatter.tolist(), strict=True):
        run = simulate(replace(LEVEL, compression=x), Coulomb(kinetic_coefficient=0.3), t_end=9.0)
        way = float(run["x"][-1] - run["x"][0]) + error
        trials.append(Measurement(travel=way, overrides={"mechanism.compression": x}))
    found = fit(LEVEL, Dahl, Measurement(trials=tuple(trials)), t_end=9.0)
    assert found.law.kinetic_coefficient == pytest.approx(0.3, rel=0.1)


def test_a_stiffness_of_bristles_is_found_from_a_guess_decades_off():
    # each stiffness has a level of its own: stiff bristles have no slope that leads to soft ones
    true = Dahl(kinetic_coefficient=0.25, bristle_stiffness=7.5, static_switch=True)
    trials = []
    for compression in (0.06, 0.085, 0.12):
        block = SpringBlock(mass=0.82, stiffness=145.0, compression=compression)
        trials.append(
            Measurement(
                name=f"{compression}", uncertainty=1e-3,
                travel=float(simulate(block, true, t_end=5.0)["x"][-1]),
                overrides={"mechanism.compression": compression},
            )
        )  # fmt: skip
    rig = SpringBlock(mass=0.82, stiffness=145.0, compression=0.06)
    found = fit(
        rig,
        replace(true, kinetic_coefficient=0.3, bristle_stiffness=1200.0),
        Measurement(trials=tuple(trials)),
        vary=["friction.kinetic_coefficient", "friction.bristle_stiffness"],
        t_end=5.0,
    )
    assert found.law.bristle_stiffness == pytest.approx(7.5, rel=1e-3)
    assert found.law.kinetic_coefficient == pytest.approx(0.25, rel=1e-3)


@pytest.mark.slow
def test_select_drops_a_law_that_does_not_come_to_rest_and_says_why():
    ways = {}
    for x in (0.06, 0.08, 0.1):
        run = simulate(replace(SLOPE, compression=x), Coulomb(kinetic_coefficient=0.3), t_end=5.0)
        ways[x] = float(run["x"][-1])
    measured = Measurement(
        trials=tuple(
            Measurement(travel=s, uncertainty=1e-3, overrides={"mechanism.compression": x})
            for x, s in ways.items()
        )
    )
    verdict = select(SLOPE, [Coulomb, Viscous], measured, t_end=5.0)
    coulomb, viscous = sorted(verdict.candidates, key=lambda candidate: candidate.name)
    assert verdict.best.name == "coulomb"
    assert not coulomb.dropped
    assert "does not bring the body to rest: at t_end = 5 s it still moves" in viscous.dropped


def test_travels_of_what_drives_itself_are_those_of_the_run():
    """A capsule under a wave never rests; its travel is where it is at the end."""
    seen = way(0.4, 2.9)
    found = fit(CAPSULE, Coulomb(kinetic_coefficient=0.2), Measurement(travel=seen), t_end=2.9)
    assert found.predicted[0] == pytest.approx(seen, abs=1e-8)


HIGH, DUTY = "mechanism.drive.drive.high", "mechanism.drive.drive.duty"


def pushed(stiffness, damping, high, period=0.5, duty=0.5):
    return Capsule(
        capsule_mass=0.6,
        inner_mass=0.4,
        stiffness=stiffness,
        damping=damping,
        drive=Torque(drive=Square(high=high, low=0.0, period=period, duty=duty)),
    )


@cache
def speeds(count, seed=0, periods=(0.25, 1.25), duties=(0.2, 0.7)):
    """Return mean velocities with errors of 4 mm/s, at settings that are drawn."""
    random = np.random.default_rng(seed)
    trials = []
    for period, duty in zip(
        random.uniform(*periods, count), random.uniform(*duties, count), strict=True
    ):
        run = simulate(
            pushed(60.0, 0.8, 4.0, period, duty), Coulomb(kinetic_coefficient=0.06), t_end=2.0
        )
        read = float(np.ptp(run.at(run.span)["x"])) * np.sign(run.at(run.span)["x"][-1]) / 2.0
        trials.append(
            Measurement(
                mean_velocity=float(read) + random.normal(0.0, 0.004),
                uncertainty=0.004,
                overrides={PERIOD: period, DUTY: duty},
            )
        )
    return Measurement(trials=tuple(trials))


TOLD = ("friction.*", "stiffness", "damping", HIGH)


@cache
def fit_to_many():
    return fit(pushed(85.0, 0.5, 3.0), Coulomb, speeds(20), vary=TOLD, t_end=2.0)


@pytest.mark.slow
def test_many_mean_speeds_separate_a_capsules_stiffness_damping_force_and_friction():
    found = fit_to_many()
    truth = {"mu_k": 0.06, "k": 60.0, "c": 0.8, "F_1": 4.0}
    for estimate in found.estimates:
        # two half-widths are four standard errors: one estimate of 16,000 is farther off
        assert estimate.bounded
        assert abs(estimate.value - truth[estimate.quantity.symbol]) < 2.0 * estimate.half_width
    assert found.mechanism.stiffness == found.estimates[1].value


def test_intervals_reach_over_other_values_that_fit_as_well():
    """Speeds rise and fall with the stiffness: chi-square has minima side by side."""
    told = ("friction.*", "stiffness")
    found = fit(pushed(85.0, 0.5, 3.0), Coulomb, speeds(4), vary=told, t_end=2.0)
    for other in (60.0, found.mechanism.stiffness):
        assert found.estimates[1].low < other < found.estimates[1].high


@pytest.mark.slow
def test_one_setting_of_a_capsule_tells_a_combination_only_and_says_so():
    same = speeds(6, periods=(0.5, 0.5001), duties=(0.5, 0.5001))
    found = fit(pushed(85.0, 0.5, 3.0), Coulomb, same, vary=TOLD, t_end=2.0)
    assert not any(estimate.bounded for estimate in found.estimates)
    assert sum(one.reason != "" for one in found.estimates) >= 3  # of the mechanism
    assert "the trials hardly depend on it" in str(found.sentences)


@pytest.mark.slow
def test_what_scales_with_all_else_is_not_identified_however_many_trials_there_are():
    everything = (*TOLD, "capsule_mass", "inner_mass")
    found = fit(pushed(60.0, 0.8, 4.0), Coulomb, speeds(12), vary=everything, t_end=2.0)
    scaled = [e for e in found.estimates if e.path.startswith("mechanism.")]
    assert not any(estimate.bounded for estimate in scaled)


@pytest.mark.parametrize(
    ("count", "start", "vary", "said"),
    [
        (4, 0.5, TOLD, "at least 5 different settings"),
        (6, 0.0, TOLD, "is 0 N s/m, from which no search can begin"),
        (6, 0.5, (*TOLD[:2], PERIOD), "trials set mechanism.drive.drive.period themselves"),
    ],
)
def test_parameters_that_travels_cannot_tell_are_refused(count, start, vary, said):
    with pytest.raises(InputError, match=said):
        fit(pushed(85.0, start, 3.0), Coulomb, speeds(count), vary=vary, t_end=2.0)


def test_laws_are_compared_by_travels_with_the_mechanism_as_given():
    with pytest.raises(InputError, match="fit these first with one law"):
        select(pushed(85.0, 0.5, 3.0), None, speeds(6), vary=TOLD, t_end=2.0)


@pytest.mark.slow
def test_a_level_above_the_static_one_that_a_law_starts_with_is_found():
    """Stribeck friction starts with a static level of .35, and this capsule has one of .5."""
    travels = {}
    for period in (0.3, 0.4, 0.5):
        run = simulate(capsule(period), Coulomb(kinetic_coefficient=0.5), t_end=END)
        travels[period] = float(run["x"][-1])
    found = fit(CAPSULE, Stribeck, readings("travel", travels, 1e-3), t_end=END)
    assert max(map(abs, found.residuals)) < 1e-3
    assert found.law.static_coefficient > 0.35
