"""Plans of travels against the closed form of the released block, s = k x_0^2 / (2 mu m g)."""

import csv
import io
import math
from dataclasses import replace

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Measurement,
    SpringBlock,
    TowedBlock,
    Viscous,
    plan,
    select,
    simulate,
)
from stickslip.errors import InputError
from stickslip.identify.kinds.plan_sheet import Plan, plan_sections
from stickslip.mechanisms.drives import Pulse, Sine

BLOCK = SpringBlock(mass=0.82, stiffness=145.0, compression=0.08)
K, M, X = "mechanism.stiffness", "mechanism.mass", "mechanism.compression"
EXACT = {K: 1e-6, M: 1e-9, X: 1e-9}
SIGMA = 0.004
SETTINGS = np.array([0.032, 0.048, 0.064, 0.08])
TRAVELS = 145.0 * SETTINGS**2 / (2.0 * 0.25 * 0.82 * 9.81)


@pytest.fixture(scope="module")
def three() -> Plan:
    return plan(BLOCK, ["coulomb", "viscous", "coulomb-viscous"], uncertainty=SIGMA)


def filled(sheet: Plan, travels, parameter_uncertainties=None, sigma=SIGMA) -> Measurement:
    """Return the readings of a filled sheet."""
    rows = list(csv.reader(io.StringIO(sheet.csv())))[1:]
    return Measurement(
        trials=tuple(
            Measurement(
                travel=travels(float(x) / 1e3), uncertainty=sigma, overrides={X: float(x) / 1e3}
            )
            for _, x, _ in rows
        ),
        parameter_uncertainties=parameter_uncertainties or {},
    )


@pytest.mark.parametrize(
    ("readings", "stated", "expected", "freedom"),
    [
        ((0.210, 0.204, 0.199), 0.0005, 0.005507571, 2),  # their standard deviation, n - 1
        ((0.210, 0.204, 0.199), None, 0.005507571, 2),
        ((0.204, 0.204, 0.204), 0.0005, 0.0005, 0),  # a coarse reading hides the scatter
        ((0.210, 0.204), 0.0005, 0.0005, 0),  # one difference tells no scatter
    ],
)
def test_the_scatter_of_repeats_is_the_uncertainty(readings, stated, expected, freedom):
    known = {} if stated is None else {"uncertainty": stated}
    trials = tuple(Measurement(travel=reading, **known) for reading in readings)
    sheet = plan(BLOCK, "coulomb", Measurement(trials=trials))
    assert sheet.uncertainty == pytest.approx(expected, rel=1e-6)
    assert (sheet.repeated, sheet.assumed) == (freedom, False)
    said = " ".join(block.text for block in plan_sections(sheet)[0].blocks)
    assert ("the scatter of the repeats" in said) is bool(freedom)


@pytest.mark.slow
def test_settings_go_from_two_fifths_of_the_present_one_to_it(three):
    assert [row.value for row in three.settings] == pytest.approx(SETTINGS)
    found = [row.predicted["coulomb"] for row in three.settings]
    assert found == pytest.approx(TRAVELS.tolist(), rel=1e-6)


def test_all_laws_travel_equally_far_at_the_present_setting(three):
    last = three.settings[-1].predicted
    assert last == pytest.approx(dict.fromkeys(last, TRAVELS[-1]), rel=5e-3)


def test_a_viscous_part_that_nobody_gave_is_plausible(three):
    law = three.laws["coulomb-viscous"]
    run = simulate(BLOCK, law, t_end=10.0)
    viscous = law.viscous_coefficient * float(np.max(run["v"]))
    assert 0.05 < viscous / (viscous + law.kinetic_coefficient * 0.82 * 9.81) < 0.7


def test_the_band_holds_all_laws_and_the_runs_narrow_it(three):
    for row in three.settings[:-1]:
        assert row.low <= min(row.predicted.values())
        assert max(row.predicted.values()) <= row.high
        assert row.expected < 0.5 * row.half
    widest = max(three.settings, key=lambda row: row.half)
    assert f"compression {widest.text}" in three.band_sentence


def test_needed_uncertainties_are_half_the_readings_part():
    """Weights of least squares are the travels: what all share is plain, what is set anew not."""
    sheet = plan(BLOCK, ["coulomb"], uncertainty=SIGMA)
    n = sheet.repeats
    readings = SIGMA / math.sqrt(n * np.sum(TRAVELS**2))
    by_hand = math.sqrt(n * np.sum((2.0 * TRAVELS**2 / SETTINGS) ** 2)) / (n * np.sum(TRAVELS**2))
    needed = {preparation.path: preparation.needed for preparation in sheet.preparations}
    assert needed[K] / 145.0 == pytest.approx(0.5 * readings, rel=1e-3)
    assert needed[M] / 0.82 == pytest.approx(0.5 * readings, rel=1e-3)
    assert needed[X] == pytest.approx(0.5 * readings / by_hand, rel=1e-3)


def test_worse_readings_take_more_runs():
    few, many = (
        plan(BLOCK, ["coulomb", "viscous"], uncertainty=size, parameter_uncertainties=EXACT)
        for size in (SIGMA, 0.015)
    )
    assert few.tellings["coulomb", "viscous"] == few.repeats == 3
    assert 3 < many.tellings["coulomb", "viscous"] == many.repeats <= 10


def test_a_rig_known_as_the_sheet_asks_for_keeps_what_is_expected():
    laws = ["coulomb", "viscous"]
    sheet = plan(BLOCK, laws, uncertainty=0.015)
    known = {item.path: item.needed for item in sheet.preparations}
    same = plan(BLOCK, laws, uncertainty=0.015, parameter_uncertainties=known)
    assert same.repeats == sheet.repeats > 3
    for name in laws:
        expected, again = sheet.expectations[name][0], same.expectations[name][0]
        assert again.half_width == pytest.approx(expected.half_width, rel=0.01)


@pytest.mark.slow
def test_a_planned_set_rules_the_rival_out_in_nine_of_ten_cases():
    """25 made-up sets: of a binomial with 0.9, 99 % are 18 or more."""
    draw, ruled_out = np.random.default_rng(3), 0
    laws = ["coulomb", "coulomb-viscous"]
    sigma = 0.002
    sheet = plan(BLOCK, laws, uncertainty=sigma)
    assert sheet.tellings["coulomb-viscous", "coulomb"] is not None
    law = sheet.laws["coulomb-viscous"]
    known = {preparation.path: preparation.needed for preparation in sheet.preparations}
    for _ in range(25):
        k, m = 145.0 + known[K] * draw.normal(), 0.82 + known[M] * draw.normal()

        def travel(x, k=k, m=m):
            block = SpringBlock(mass=m, stiffness=k, compression=x + known[X] * draw.normal())
            run = simulate(block, law, t_end=10.0)
            return float(run.at(run.span)["x"][-1]) + sigma * draw.normal()

        verdict = select(BLOCK, laws, filled(sheet, travel, known, sigma))
        ruled_out += ("coulomb",) not in verdict.set
    assert ruled_out >= 18


def test_expected_intervals_are_those_of_a_filled_sheet(three):
    law = three.laws["coulomb-viscous"]

    def travel(x):
        run = simulate(SpringBlock(mass=0.82, stiffness=145.0, compression=x), law, t_end=10.0)
        return float(run.at(run.span)["x"][-1])

    known = {preparation.path: preparation.needed for preparation in three.preparations}
    verdict = select(BLOCK, [*three.laws], filled(three, travel, known))
    found = next(c.fit for c in verdict.candidates if c.name == "coulomb-viscous")
    expected = three.expectations["coulomb-viscous"]
    for estimate, other in zip(found.estimates, expected, strict=True):
        assert estimate.value == pytest.approx(other.value, rel=1e-2)
        # limits are of draws, which scatter
        assert estimate.half_width == pytest.approx(other.half_width, rel=0.25)


def test_stated_uncertainties_count_and_are_judged():
    sheet = plan(
        BLOCK,
        ["coulomb"],
        uncertainty=SIGMA,
        parameter_uncertainties={"stiffness": 5.0, "mass": 1e-4},
    )
    said = {preparation.path: preparation.verdict for preparation in sheet.preparations}
    assert said[K] == "5 N/m, too large"
    assert said[M] == "0.1 g, sufficient"
    assert said[X] == "not stated"
    (estimate,) = sheet.expectations["coulomb"]
    assert estimate.half_width / estimate.value == pytest.approx(2.33 * 5.0 / 145.0, rel=0.1)


def test_what_no_travel_tells_has_no_interval_and_another_way():
    sheet = plan(BLOCK, Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35))
    (static,) = (e for e in sheet.expectations["coulomb"] if e.quantity.symbol == "mu_s")
    assert not static.bounded
    assert static.reason.startswith("Pull slowly until the block moves")


def test_settings_go_up_and_down():
    sheet = plan(BLOCK, ["coulomb"], settings=2, between=(0.05, 0.1))
    assert [row[1] for row in csv.reader(io.StringIO(sheet.csv()))][1:] == [
        "50", "100", "100", "50", "50", "100",
    ]  # fmt: skip


def test_readings_made_before_give_level_and_uncertainty():
    done = Measurement(travel=0.3, uncertainty=0.003)
    sheet = plan(BLOCK, [Coulomb], measurement=done)
    assert sheet.uncertainty == 0.003
    assert not sheet.assumed
    assert sheet.laws["coulomb"].kinetic_coefficient == pytest.approx(
        145.0 * 0.08**2 / (2.0 * 0.82 * 9.81 * 0.3), rel=1e-6
    )


@pytest.mark.slow
def test_a_push_is_planned_by_its_level():
    block = SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))
    sheet = plan(block, ["coulomb", "viscous"], between=(6.0, 12.0), uncertainty=0.001)
    assert sheet.csv().startswith("name,mechanism.drive.level [N],travel [mm]\n")
    # (F - f) T^2 F / (2 m f) with f = 0.25 m g
    f = 0.25 * 9.81
    for row in sheet.settings:
        expected = (row.value - f) * 0.01 * row.value / (2.0 * f)
        assert row.predicted["coulomb"] == pytest.approx(expected, rel=1e-6)
    assert {preparation.path for preparation in sheet.preparations} >= {
        "mechanism.mass",
        "mechanism.drive.level",
    }


def test_settings_at_which_the_block_hardly_moves_are_left_out():
    law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
    sheet = plan(BLOCK, law, between=(0.01, 0.08), settings=8)
    assert min(row.value for row in sheet.settings) > 0.01
    assert any("hardly moves" in line for line in sheet.remarks)


@pytest.mark.parametrize(
    ("given", "options", "said"),
    [
        (TowedBlock(mass=1.0, stiffness=100.0, speed=0.1), {}, "plan needs a body"),
        (Axis(inertia=1.0), {}, "this Axis is not one"),
        (SpringBlock(mass=1.0), {}, "compression, drive.level or drive.amplitude"),
        (
            SpringBlock(mass=1.0, drive=Sine(amplitude=9.0, frequency=1.0)),
            {},
            "does not come to rest because its drive never ends",
        ),
        (BLOCK, {"settings": 1}, "settings.*at least 2 and at most 12, got 1"),
        (BLOCK, {"between": (0.08, 0.04)}, "the smaller one first"),
        (BLOCK, {"between": (0.001, 0.004)}, "give a higher range with --between"),
        (BLOCK, {"uncertainty": 0.0}, "above 0 m, got 0"),
        (BLOCK, {"uncertainty": 50.0}, "0.231 m \\(the longest planned travel\\), got 50 m"),
        (BLOCK, {"uncertainty": 1e-9}, "from 2.31 µm \\(the accuracy of the simulation\\)"),
        (replace(BLOCK, upper_stop=0.15), {}, "hits the stop at 0.15 m"),
        (replace(BLOCK, compression=0.01), {}, r"\(mu_k = 0.25\) holds the body at rest"),
        (BLOCK, {"parameter_uncertainties": {"stifness": 1.0}}, "stifness"),
        (BLOCK, {"laws": []}, "no friction law was given"),
        (BLOCK, {"laws": Coulomb(kinetic_coefficient=2.0)}, "holds the body at rest"),
        (BLOCK, {"laws": "culomb"}, "coulomb"),
    ],
)
def test_what_cannot_be_planned_is_said(given, options, said):
    with pytest.raises(InputError, match=said):
        plan(given, **options)


def test_a_law_whose_values_do_not_reach_the_travel_is_left_out_and_named():
    laws = {
        "coulomb": Coulomb(kinetic_coefficient=0.25),
        "held": CoulombViscous(kinetic_coefficient=0.1, viscous_coefficient=50.0),
        "viscous": Viscous(viscous_coefficient=1.0),
    }
    sheet = plan(BLOCK, laws)
    assert list(sheet.laws) == ["coulomb", "viscous"]
    assert any("was left out" in line for line in sheet.remarks)


def test_a_plan_prints_and_goes_into_json(three):
    assert f"{4 * three.repeats} travels" in repr(three)
    content = three.to_dict()
    assert content["repeats"] == three.repeats
    assert content["settings"][0]["band"] == [three.settings[0].low, three.settings[0].high]
    assert content["sheet"].startswith("name,mechanism.compression [mm],travel [mm]")
    assert content["tells_apart"][0] == {"holds": "coulomb", "ruled_out": "viscous", "repeats": 3}
    assert {item["law"] for item in content["expected"]} == {*three.laws}


def measured(**travels):
    """Return trials at settings of one parameter, given as ``x40=0.058`` in thousandths."""
    path, pairs = travels.pop("path"), travels.items()
    return Measurement(
        trials=tuple(
            Measurement(travel=s, uncertainty=SIGMA, overrides={path: int(name[1:]) / 1e3})
            for name, s in pairs
        )
    )


def test_settings_span_the_trials_and_the_present_one():
    sheet = plan(
        BLOCK, ["coulomb"], measurement=measured(path=X, x100=0.36, x120=0.519), settings=3
    )
    assert [setting.value for setting in sheet.settings] == pytest.approx([0.08, 0.1, 0.12])
    assert "of the trials and of the rig, 80 to 120 mm" in sheet.range_source


def test_one_trial_at_the_present_setting_gives_no_range():
    sheet = plan(BLOCK, ["coulomb"], measurement=measured(path=X, x80=0.231))
    assert [setting.value for setting in sheet.settings] == pytest.approx(SETTINGS)
    assert "The trials and the rig have one compression" in sheet.range_source


def test_a_given_range_is_taken_and_needs_no_source():
    done = measured(path=X, x100=0.36, x120=0.519)
    sheet = plan(BLOCK, ["coulomb"], measurement=done, between=(0.05, 0.09), settings=2)
    assert [setting.value for setting in sheet.settings] == pytest.approx([0.05, 0.09])
    assert sheet.range_source == ""


def test_what_trials_vary_is_what_is_set():
    """The plan set the compression to shares of the stiffness: travels are k x_0^2 / (2 mu m g)."""
    done = measured(path=K, x100000=0.159, x200000=0.318)
    sheet = plan(BLOCK, Coulomb(kinetic_coefficient=0.25), measurement=done, settings=3)
    assert {estimate.path for estimate in sheet.settings} == {K}
    assert [estimate.value for estimate in sheet.settings] == pytest.approx([100.0, 150.0, 200.0])
    level = sheet.laws["coulomb"].kinetic_coefficient
    for setting in sheet.settings:
        expected = setting.value * 0.08**2 / (2.0 * level * 0.82 * 9.81)
        assert setting.predicted["coulomb"] == pytest.approx(expected, rel=1e-6)


def test_inclines_are_set_in_degrees():
    track = replace(BLOCK, incline=math.radians(5.0))
    path = "mechanism.incline"
    done = Measurement(
        trials=tuple(
            Measurement(travel=s, uncertainty=0.002, overrides={path: math.radians(angle)})
            for angle, s in ((5.0, 0.17), (10.0, 0.138))
        )
    )
    sheet = plan(track, ["coulomb"], measurement=done, settings=2)
    assert sheet.csv().splitlines()[:2] == ["name,mechanism.incline [deg],travel [mm]", "run 1,5,"]
    assert sheet.sentence.startswith("Set the incline to 5 and 10°, 3 runs each")


def test_trials_on_an_incline_leave_the_compression_of_a_level_rig_to_be_set():
    done = Measurement(travel=0.17, uncertainty=0.002, overrides={"mechanism.incline": 0.09})
    sheet = plan(
        BLOCK, ["coulomb"], measurement=Measurement(trials=(done, Measurement(travel=0.23)))
    )
    assert {setting.path for setting in sheet.settings} == {X}


def test_a_law_under_which_the_body_creeps_on_is_left_out_and_named():
    """Viscous friction stops no body on an incline: its distance is that of the last time."""
    sheet = plan(replace(BLOCK, incline=0.17), ["coulomb", "viscous"])
    assert list(sheet.laws) == ["coulomb"]
    assert any("Viscous friction was left out" in line for line in sheet.remarks)
    assert any("does not bring the body to rest: at t_end = 10 s" in line for line in sheet.remarks)


@pytest.mark.slow
def test_bristles_that_ring_are_at_rest():
    """Dahl's bristles have no damping: the block stops but for micrometres."""
    assert "dahl" in plan(BLOCK, ["coulomb", "dahl"], settings=2).laws


@pytest.mark.slow
def test_a_viscous_law_needs_no_guess_of_its_coefficient():
    """At 2.3 m/s and 1.06 m of travel c is 540 N s/m, 10,000 times the ordinary value."""
    heavy = SpringBlock(mass=250.0, stiffness=9e4, compression=0.12)
    assert "viscous" in plan(heavy, ["coulomb", "viscous"]).laws
    assert plan(heavy, ["viscous"]).reference == "viscous"


@pytest.mark.parametrize(
    "laws",
    [
        ["coulomb", "stribeck"],
        {  # equal travels, whatever the rig is known to
            "plain": Coulomb(kinetic_coefficient=0.25),
            "static": Coulomb(kinetic_coefficient=0.25, static_coefficient=0.3),
        },
    ],
)
def test_what_no_number_of_repeats_separates_is_said(laws):
    sheet = plan(BLOCK, laws, uncertainty=SIGMA)
    assert [*sheet.tellings.values()] == [None]
    assert "They distinguish 0 of 1 pair of laws" in sheet.sentence


def test_no_more_runs_are_planned_than_are_asked_for(three):
    assert len(three.runs()) == 12
    few = plan(BLOCK, ["coulomb", "viscous", "coulomb-viscous"], uncertainty=SIGMA, readings=9)
    assert len(few.runs()) == 8  # two at each of four settings
    assert few.settings[0].expected > three.settings[0].expected
    assert all(many is None or many > 2 for many in few.tellings.values())
    assert few.sentence.endswith(f"They distinguish 0 of {len(few.tellings)} pairs of laws.")
    least = plan(BLOCK, ["coulomb", "viscous"], uncertainty=SIGMA, readings=3)
    assert len(least.runs()) == len(least.settings) == 3
    assert "1 run each: 3 travels" in least.sentence
