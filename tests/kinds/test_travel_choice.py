"""Several travels: the simplest law that the readings' uncertainty allows, or no law at all."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip import (
    Coulomb,
    CoulombViscous,
    DirectionDependent,
    Measurement,
    PowerViscous,
    SpringBlock,
    Stribeck,
    fit,
    select,
    simulate,
)
from stickslip.drives import Pulse
from stickslip.kinds.travels.wording import _remarks

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
SET_VALUED = ["coulomb", "viscous", "coulomb-viscous", "stribeck"]
PLAIN = ["coulomb", "coulomb-viscous"]
COMPRESSIONS = (0.06, 0.08, 0.10, 0.13, 0.15)
THREE = (0.06, 0.10, 0.15)


def travel(rig, law):
    return float(simulate(rig, law, t_end=10.0).at(10.0)["x"][0])


def readings(law, settings=COMPRESSIONS, *, rig=RIG, errors=None, uncertainty=None, scale=None):
    """Return travels to 1 mm, or with errors [m]; `scale` multiplies readings by index."""
    trials = []
    for i, setting in enumerate(settings):
        true = travel(dataclasses.replace(rig, compression=setting), law)
        read = round(true, 3) if errors is None else true + errors[i]
        read *= (scale or {}).get(i, 1.0)
        given = 0.0005 if errors is None else uncertainty
        trials.append(
            Measurement(
                travel=read,
                uncertainty={} if given is None else {"travel": given},
                uncertainty_kind="rounding" if errors is None else "standard",
                overrides={"mechanism.compression": setting},
            )
        )
    return Measurement(trials=tuple(trials))


COULOMB = Coulomb(kinetic_coefficient=0.25)
VISCOUS = CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=0.6)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_coulomb_friction_read_to_a_millimetre_is_named_with_defaults(seed):
    random = np.random.default_rng(seed)
    law = Coulomb(kinetic_coefficient=float(random.uniform(0.1, 0.5)))
    settings = np.sort(random.uniform(0.07, 0.16, 3)).round(3)
    errors = random.normal(0.0, 0.0005, 3)
    verdict = select(RIG, PLAIN, readings(law, settings, errors=errors, uncertainty=0.0005))
    assert verdict.best.name == "coulomb"
    assert not verdict.best.invented


@pytest.mark.slow
def test_a_viscous_part_that_is_there_is_found():
    verdict = select(RIG, SET_VALUED, readings(VISCOUS, THREE))
    assert verdict.best.name == "coulomb-viscous"
    assert verdict.best.fit.law.viscous_coefficient == pytest.approx(0.6, rel=0.05)


@pytest.mark.slow
def test_a_law_with_values_that_nobody_gave_is_shown_and_never_taken():
    verdict = select(RIG, ["coulomb", "coulomb-viscous", "stribeck"], readings(VISCOUS, THREE))
    stribeck = next(c for c in verdict.candidates if c.name == "stribeck")
    assert stribeck.invented == ("static_coefficient", "stribeck_velocity")
    assert stribeck.score is None
    assert stribeck.unscored == "not scored: $mu_s$ and $v_s$ were assumed, not fitted"
    assert verdict.best.unscored == ""
    assert "neither measured, given nor fitted" in stribeck.passed_over
    assert verdict.to_dict()["candidates"][-1]["invented"]


@pytest.mark.slow
def test_laws_that_are_not_told_apart_are_listed_in_the_first_sentence():
    verdict = select(RIG, SET_VALUED, readings(COULOMB, THREE))
    assert verdict.best.name == "coulomb"
    assert "Coulomb + viscous" in verdict.sentence
    assert "do not distinguish it from" in verdict.sentence
    viscous = next(c for c in verdict.candidates if c.name == "viscous")
    assert viscous.distinguished
    assert "Viscous" not in verdict.sentence.replace("Coulomb + viscous", "")


@pytest.mark.slow
def test_a_law_never_leaves_more_than_one_that_it_contains():
    attached = dataclasses.replace(RIG, attached=True)
    truth = Coulomb(kinetic_coefficient=0.09)  # five half swings: travels rise and fall with it
    measured = readings(truth, (0.08, 0.1, 0.12, 0.14), rig=attached)
    verdict = select(attached, ["coulomb", "coulomb-viscous"], measured)
    coulomb, viscous = (
        next(c for c in verdict.candidates if c.name == name)
        for name in ("coulomb", "coulomb-viscous")
    )
    assert verdict.best.name == "coulomb"
    assert coulomb.fit.law.kinetic_coefficient == pytest.approx(0.09, rel=0.01)
    assert viscous.fit.chi_square <= coulomb.fit.chi_square * (1.0 + 1e-6)


@pytest.mark.slow
def test_a_stribeck_step_that_matters_is_fitted_where_the_settings_pay_for_it():
    truth = Stribeck(kinetic_coefficient=0.15, static_coefficient=0.3, stribeck_velocity=0.4)
    settings = (0.05, 0.065, 0.08, 0.10, 0.12, 0.15)
    verdict = select(RIG, ["coulomb", "coulomb-viscous", "stribeck"], readings(truth, settings))
    assert verdict.best.name == "stribeck"
    assert verdict.best.invented == ()
    found = {e.path.rpartition(".")[2]: e for e in verdict.best.fit.estimates}
    assert set(found) >= {"kinetic_coefficient", "static_coefficient", "stribeck_velocity"}
    # the slope that the law has by default, 0, is not known either: six settings pay for it too
    assert found["viscous_coefficient"].low == 0.0


FASTENED = SpringBlock(mass=1.0, stiffness=200.0, compression=0.1, attached=True)


def near_each_other():
    """Return travels that levels of 0.4, 0.4 / 3 and 0.4 / 5 give alike: 1, 3 and 5 half swings."""
    truth = Coulomb(kinetic_coefficient=0.4)
    settings = (0.036, 0.038, 0.042)
    return readings(truth, settings, rig=FASTENED, errors=(0.0, 0.0, 0.0), uncertainty=1e-4)


def test_three_travels_of_a_fastened_block_are_given_all_levels_that_explain_them():
    found = fit(FASTENED, Coulomb, near_each_other())
    (level,) = found.estimates
    # half swings shorten the amplitude by 2 mu m g / k each, and leave the same way for odd numbers
    expected = sorted(0.4 / n for n in (1, 3, 5))
    assert sorted((level.value, *found.others)) == pytest.approx(expected, rel=1e-3)
    assert len(level.pieces) == 3
    for one, (low, high) in zip(expected, level.pieces, strict=True):
        assert low < one < high < 1.1 * low
    assert (level.low, level.high) == (level.pieces[0][0], level.pieces[-1][1])
    assert " or " in level.range
    assert "Other values of mu_k explain the travels as well" in found.told_apart[0]


@pytest.mark.slow
def test_a_level_that_is_one_of_several_is_not_stated():
    verdict = select(FASTENED, PLAIN, near_each_other())
    assert verdict.best.name == "coulomb"
    assert "$mu_k$ =" not in verdict.sentence
    assert not any("mu_k" in line for line in verdict.words.settles)
    assert any("these readings do not tell which" in line for line in verdict.words.cannot_tell)


@pytest.mark.slow
def test_the_interval_of_the_best_law_holds_what_laws_that_are_not_ruled_out_say():
    verdict = select(RIG, SET_VALUED, readings(COULOMB, THREE))
    alone = fit(RIG, Coulomb, readings(COULOMB, THREE)).estimates[0]
    level = verdict.best.fit.estimate("kinetic_coefficient")
    others = [c for c in verdict.candidates if not c.distinguished]
    assert others
    assert level.low < alone.low
    for other in others:
        same = other.fit.estimate("kinetic_coefficient")
        assert level.low <= same.low
        assert same.high <= level.high


def test_a_slope_that_is_zero_by_default_does_not_count_as_known():
    settings = (0.08, 0.12)
    truth = Stribeck(
        kinetic_coefficient=0.2,
        static_coefficient=0.22,
        stribeck_velocity=0.02,
        viscous_coefficient=0.8,
    )
    given = dataclasses.replace(truth, viscous_coefficient=0.0)
    verdict = select(RIG, {"stribeck": given}, readings(truth, settings))
    (candidate,) = [one for one in verdict.candidates if not one.beside]
    level = candidate.fit.estimate("kinetic_coefficient")
    assert level.low <= 0.2 <= level.high
    assert candidate.influence["viscous_coefficient"] > 1e-3


def test_no_law_is_named_where_only_values_that_nobody_measured_explain_the_travels():
    truth = Stribeck(kinetic_coefficient=0.15, static_coefficient=0.3, stribeck_velocity=0.4)
    verdict = select(RIG, [*PLAIN, "stribeck"], readings(truth, THREE))
    assert verdict.best is None
    assert verdict.sentence == "These readings cannot tell which friction law holds."
    assert "Stribeck friction explains them" in verdict.words.lede
    assert "5 settings or more" in verdict.words.measure_next[0]


def test_without_a_stated_uncertainty_it_is_estimated_with_its_degrees_of_freedom():
    errors = np.random.default_rng(3).normal(0.0, 0.002, 5)
    stated = fit(RIG, Coulomb, readings(COULOMB, errors=errors, uncertainty=0.002))
    open_ = fit(RIG, Coulomb, readings(COULOMB, errors=errors))
    (known,), (estimated,) = stated.estimates, open_.estimates
    scatter = np.sqrt(np.sum(np.square(open_.residuals)) / 4)
    # t(4) is 2.776 where the normal distribution has 1.960
    wanted = scatter / 0.002 * 2.776445 / 1.959964
    ratio = (estimated.high - estimated.low) / (known.high - known.low)
    assert ratio == pytest.approx(wanted, rel=1e-3)  # one-sided differences of step 1e-4
    verdict = select(RIG, PLAIN, readings(COULOMB, errors=errors))
    assert verdict.best.name == "coulomb"
    assert "4 degrees of freedom" in verdict.words.lede


@pytest.mark.slow
def test_repeats_of_a_setting_are_left_out_together():
    once = readings(VISCOUS, (0.06, 0.1, 0.15)).records()
    twice = Measurement(trials=tuple(one for one in once for _ in range(2)))
    alone = select(RIG, ["coulomb"], Measurement(trials=once))
    verdict = select(RIG, ["coulomb"], twice)
    assert alone.candidates[0].held_out[0] == pytest.approx(
        verdict.candidates[0].held_out[0], abs=1e-6
    )


def contradicted(verdict):
    said = verdict.to_dict()
    assert said["best"] is None
    assert said["ranked"] is False
    assert verdict.sentence == "No candidate explains these readings."
    assert verdict.words.cannot_tell
    return " ".join((verdict.words.lede, *verdict.words.measure_next)).replace("$", "")


@pytest.mark.slow
def test_swapped_readings_are_explained_by_no_law():
    records = list(readings(VISCOUS).records())
    one, other = records[1], records[3]
    records[1] = dataclasses.replace(one, overrides=other.overrides)
    records[3] = dataclasses.replace(other, overrides=one.overrides)
    said = contradicted(select(RIG, PLAIN, Measurement(trials=tuple(records))))
    assert "swapped" in said
    assert "x_0 = 0.08 m" in said
    assert "x_0 = 0.13 m" in said


@pytest.mark.slow
@pytest.mark.parametrize("stated", [True, False])
def test_a_reading_in_another_unit_is_explained_by_no_law(stated):
    errors = np.zeros(5)
    wrong = readings(COULOMB, errors=errors, uncertainty=0.001 if stated else None, scale={2: 10.0})
    verdict = select(RIG, PLAIN, wrong)
    said = contradicted(verdict)
    assert "centimetres entered as millimetres" in said
    # no law is passed over in favour of one that is not taken either
    assert all(c.passed_over == "" for c in verdict.candidates)
    assert verdict.to_dict()["closest"] == verdict.closest.name
    assert "x_0 = 0.1 m" in said


@pytest.mark.slow
def test_repeats_that_contradict_each_other_are_explained_by_no_law():
    records = readings(COULOMB).records()
    again = dataclasses.replace(records[1], travel=records[1].travel + 0.08)
    verdict = select(RIG, PLAIN, Measurement(trials=(*records, again)))
    said = contradicted(verdict)
    assert "disagree" in said
    assert "0.13 m" in said
    assert "0.21 m" in said


def test_repeats_of_one_setting_alone_are_contradicted_too():
    both = tuple(Measurement(travel=one, uncertainty=0.001) for one in (0.2, 0.3))
    contradicted(select(RIG, PLAIN, Measurement(trials=both)))


@pytest.mark.slow
def test_an_uncertainty_stated_too_small_widens_intervals_and_is_said():
    errors = np.array([1.0, -1.0, 1.0, -1.0, 1.0]) * 0.002
    verdict = select(RIG, PLAIN, readings(COULOMB, errors=errors, uncertainty=0.0005))
    assert verdict.best.name == "coulomb"
    assert "4.4 times the stated uncertainty" in verdict.sentence


@pytest.mark.slow
def test_text_heading_and_marks_of_what_to_measure_next_are_one_proposal():
    verdict = select(RIG, SET_VALUED, readings(COULOMB, (0.06, 0.1, 0.15)))
    proposal = verdict.proposal
    said = verdict.words.measure_next[0]
    assert set(proposal.rivals) == {c.name for c in verdict.candidates if not c.distinguished}
    if proposal.settings:
        assert said.startswith("Set $x_0$ to")
        assert proposal.apart
    else:
        assert said.startswith("No setting of $x_0$")
        assert proposal.apart == ()
        assert "within the uncertainty of reading and predicting them" in said
    assert verdict.to_dict()["proposal"]["separates"] == list(proposal.apart)


@pytest.mark.slow
def test_a_proposed_setting_moves_the_body_and_is_of_what_the_trials_set():
    rig = SpringBlock(mass=1.0, drive=Pulse(level=8.0, duration=0.2))
    trials = tuple(
        Measurement(
            travel=round(
                travel(SpringBlock(mass=1.0, drive=Pulse(level=8.0, duration=d)), COULOMB), 3
            ),
            uncertainty=0.0005,
            uncertainty_kind="rounding",
            overrides={"mechanism.drive.duration": d},
        )
        for d in (0.1, 0.2, 0.3)
    )
    verdict = select(rig, PLAIN, Measurement(trials=trials))
    assert {row.path for row in verdict.separations} == {"mechanism.drive.duration"}
    assert all(row.predicted[verdict.best.name] > 1e-3 for row in verdict.proposal.tried)


@pytest.mark.slow
def test_values_are_called_given_only_where_somebody_gave_them():
    measured = readings(COULOMB, (0.06, 0.1, 0.15))
    assert not any("given" in line for line in select(RIG, ["coulomb"], measured).words.settles)
    assert any("the given 0.25" in line for line in select(RIG, [COULOMB], measured).words.settles)


def test_repeats_rounded_to_one_number_tell_no_more_than_one_of_them():
    once = readings(VISCOUS, THREE).records()
    thrice = Measurement(trials=tuple(one for one in once for _ in range(3)))
    alone, repeated = (
        fit(RIG, CoulombViscous, measured).estimates[1]
        for measured in (Measurement(trials=once), thrice)
    )
    assert repeated.high - repeated.low == pytest.approx(alone.high - alone.low, rel=1e-2)


def test_a_rig_without_friction_values_tries_the_usual_laws_and_calls_nothing_given():
    reading = Measurement(travel=0.2, uncertainty=0.005, uncertainty_kind="rounding")
    verdict = select(RIG, {}, reading)
    assert [c.name for c in verdict.candidates][:3] == ["coulomb", "viscous", "coulomb-viscous"]
    assert not any("given" in line for line in verdict.words.settles)


@pytest.mark.slow
def test_no_law_is_passed_over_where_none_is_named():
    verdict = select(RIG, PLAIN, readings(COULOMB, scale={2: 10.0}))
    content = verdict.to_dict()
    assert content["best"] is None
    assert content["closest"] == verdict.closest.name
    assert not any(one["passed_over"] for one in content["candidates"])


@pytest.mark.slow
def test_assumed_values_are_fitted_where_no_law_explains_the_travels_without():
    rig = dataclasses.replace(RIG, mass=0.82, stiffness=145.0)
    truth = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.45, stribeck_velocity=0.3)
    measured = readings(
        truth, (0.06, 0.085, 0.12), rig=rig, errors=(0.0, 0.0, 0.0), uncertainty=1e-3
    )
    laws = {
        "coulomb": Coulomb(kinetic_coefficient=0.25, static_coefficient=0.45),
        "stribeck": dataclasses.replace(truth, kinetic_coefficient=0.25, stribeck_velocity=0.05),
    }
    given = select(rig, laws, measured)
    assert given.best is None
    found = select(rig, laws, measured, assumed={"stribeck": ("stribeck_velocity",)})
    assert found.best is not None
    assert found.best.name == "stribeck"
    # exact travels of the law itself: what is left is the tolerance of the search
    assert found.best.fit.estimate("stribeck_velocity").value == pytest.approx(0.3, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("marked", "settings", "hint", "instead"),
    [
        ((), 4, "A value marked assumed = true in the rig file", ""),
        (
            ("static_coefficient",),
            4,
            "Another value marked assumed",
            "$mu_s$, marked as assumed, do",
        ),
        (
            ("static_coefficient", "stribeck_velocity"),
            4,
            "",
            "Fitting $mu_s$ and $v_s$, marked as assumed, does not explain the readings either.",
        ),
        (
            ("static_coefficient", "stribeck_velocity"),
            2,
            "",
            "To fit $mu_s$ and $v_s$, marked as assumed, takes more than two settings.",
        ),
    ],
)
def test_who_has_marked_all_values_as_assumed_is_not_told_to(marked, settings, hint, instead):
    # readings in the wrong order: no level, however it changes with speed, explains them
    rig = dataclasses.replace(RIG, mass=0.82, stiffness=145.0)
    read = {0.06: 0.30, 0.08: 0.20, 0.10: 0.12, 0.12: 0.05}
    trials = tuple(
        Measurement(travel=x, uncertainty=1e-3, overrides={"mechanism.compression": c})
        for c, x in [*read.items()][:settings]
    )
    law = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.45, stribeck_velocity=0.3)
    laws, measured = {"stribeck": law}, Measurement(trials=trials)
    verdict = select(rig, laws, measured, assumed={"stribeck": marked} if marked else None)
    assert verdict.best is None
    (line,) = [one for one in verdict.words.measure_next if "not fitted" in one]
    assert ("assumed = true" in line) is bool(hint)
    assert hint in line
    assert instead in line


@pytest.mark.slow
def test_a_law_that_explains_the_readings_alone_does_so_beside_laws_that_do_not():
    # Coulomb friction leaves 18 mm of one reading; with a viscous part 2.7 mm are left of all
    read = {0.06: 0.164, 0.08: 0.265, 0.10: 0.396}
    trials = tuple(
        Measurement(travel=x, uncertainty=1e-3, overrides={"mechanism.compression": c})
        for c, x in read.items()
    )
    rig = SpringBlock(mass=0.82, stiffness=145.0, compression=0.06)
    alone = select(rig, ["coulomb-viscous"], Measurement(trials=trials))
    beside = select(rig, ["coulomb", "coulomb-viscous"], Measurement(trials=trials))
    assert alone.best is not None
    assert beside.best is not None
    assert alone.best.name == beside.best.name == "coulomb-viscous"


@pytest.mark.parametrize(("gap", "said"), [(2e-11, False), (1e-4, True)])
def test_a_law_is_said_to_fit_more_closely_only_where_readings_could_show_it(gap, said):
    def candidate(title, passed_over, residual):
        fit = SimpleNamespace(residuals=(residual, -residual), measured=(0.1, 0.3))
        return SimpleNamespace(title=title, passed_over=passed_over, invented=(), fit=fit)

    best = candidate("Coulomb + viscous", "", 5e-4)
    richer = candidate("Coulomb + viscous + static", "mu_s was assumed", 5e-4 - gap)
    text = _remarks([best, richer], best)
    assert (" Coulomb + viscous + static fits these readings more closely" in text) is said


def test_one_travel_of_a_block_that_swings_gives_no_mean_force_and_no_single_value():
    reading = Measurement(travel=0.0975, uncertainty=0.0005, uncertainty_kind="standard")
    verdict = select(FASTENED, PLAIN, reading)
    level = verdict.best.fit.estimates[0]
    assert level.pieces
    assert verdict.sentence.startswith("Coulomb friction with any of several values of")
    assert "mean friction" not in f"{verdict.words.lede} {verdict.words.settles}".lower()
    straight = select(RIG, PLAIN, Measurement(travel=0.2, uncertainty=0.001))
    assert "the mean friction force of 2.5 N" in straight.words.lede


def test_a_given_value_between_the_pieces_of_an_interval_is_outside():
    reading = Measurement(travel=0.0975, uncertainty=0.0005, uncertainty_kind="standard")
    pieces = select(FASTENED, ["coulomb"], reading).best.fit.estimates[0].pieces
    between = 0.5 * (pieces[0][1] + pieces[1][0])
    verdict = select(FASTENED, [Coulomb(kinetic_coefficient=between)], reading)
    assert "is outside the 95 % interval" in " ".join(verdict.words.settles)


@pytest.mark.slow
@pytest.mark.parametrize("directions", [(0.22, 0.25), (0.2, 0.3)])
def test_friction_that_differs_by_direction_is_no_certainty_where_nobody_asked_for_it(directions):
    truth = DirectionDependent(
        forward_kinetic_coefficient=directions[0], backward_kinetic_coefficient=directions[1]
    )
    errors = np.random.default_rng(5).normal(0.0, 5e-4, 5)
    measured = readings(truth, rig=FASTENED, errors=errors, uncertainty=5e-4)
    verdict = select(FASTENED, PLAIN, measured)
    beside = {c.name: c for c in verdict.candidates if c.beside}["direction-dependent"]
    if directions == (0.22, 0.25):
        assert not beside.distinguished
        level = verdict.best.fit.estimate("kinetic_coefficient")
        assert level.low <= min(directions)
        assert max(directions) <= level.high
        assert "direction-dependent" in verdict.sentence
    else:  # so large a difference is seen
        assert verdict.best is None
        assert "Direction-dependent friction explains them" in verdict.words.lede
        assert "Direction-dependent friction as a candidate" in verdict.words.measure_next[0]
        asked = select(FASTENED, [*PLAIN, "direction-dependent"], measured)
        assert asked.best.name == "direction-dependent"  # so the advice is sound


# in no order, in which friction could drift instead
@pytest.mark.slow
@pytest.mark.parametrize("settings", [(0.08, 0.04, 0.12, 0.06, 0.1), (0.08, 0.12, 0.05)])
def test_a_level_holds_for_powers_of_the_speed_that_nobody_asked_for(settings):
    truth = PowerViscous(kinetic_coefficient=0.2, viscous_coefficient=0.3, viscous_exponent=0.5)
    verdict = select(RIG, PLAIN, readings(truth, settings, uncertainty=5e-4))
    level = verdict.best.fit.estimate("kinetic_coefficient")
    (alone,) = [one for one in verdict.best.alone if one.path == level.path]
    assert alone.low > 0.2  # Coulomb + viscous friction alone excludes the truth
    assert level.low <= 0.2 <= level.high
    assert "power of speed" in verdict.sentence
    assert any("whichever of these laws holds" in line for line in verdict.words.settles)
    assert any("proportional to the speed" in x for x in verdict.words.settles)


@pytest.mark.slow
def test_laws_tried_beside_the_candidates_are_never_named():
    truth = PowerViscous(kinetic_coefficient=0.2, viscous_coefficient=0.6, viscous_exponent=2.0)
    measured = readings(truth, (0.04, 0.06, 0.08, 0.1, 0.12), uncertainty=1e-4)
    verdict = select(RIG, PLAIN, measured)
    assert verdict.best is None
    assert "Coulomb + power of speed" in verdict.words.lede
    asked = select(RIG, [*PLAIN, "power-viscous"], measured)
    assert asked.best.name == "power-viscous"
    assert not asked.best.beside
    found = asked.best.fit.estimate("viscous_exponent")
    assert found.low <= 2.0 <= found.high


@pytest.mark.slow
def test_no_setting_is_advised_whose_prediction_is_as_uncertain_as_the_laws_are_apart():
    verdict = select(FASTENED, PLAIN, near_each_other())
    assert verdict.proposal.widest > 0.01  # levels of 0.08, 0.13 and 0.4 predict other travels
    assert verdict.proposal.settings == ()
    assert "within the uncertainty" in verdict.words.measure_next[0]


@pytest.mark.slow
def test_a_law_stays_where_its_best_level_swings_on_and_another_explains_as_well():
    rig = SpringBlock(mass=0.40955, stiffness=36.5607, compression=0.24019, attached=True)
    truth, errors = Coulomb(kinetic_coefficient=0.42525), (-5.96e-4, 2.06e-4, 5.18e-4)
    measured = readings(truth, (0.201, 0.228, 0.23), rig=rig, errors=errors, uncertainty=5.24e-4)
    verdict = select(rig, PLAIN, measured)
    coulomb = next(c for c in verdict.candidates if c.name == "coulomb")
    assert not coulomb.dropped
    assert verdict.best.name == "coulomb"


@pytest.mark.slow
def test_advice_has_the_uncertainty_of_what_it_predicts_and_truth_meets_it():
    truth = CoulombViscous(kinetic_coefficient=0.22, viscous_coefficient=1.5)
    errors = np.random.default_rng(8).normal(0.0, 2e-4, 5)
    measured = readings(truth, errors=errors, uncertainty=2e-4)
    proposal = select(RIG, PLAIN, measured).proposal
    assert proposal.settings
    for row, error in zip(proposal.settings, proposal.errors[proposal.best], strict=True):
        rig = dataclasses.replace(RIG, compression=row.value)
        run = simulate(rig, truth, t_end=10.0)
        assert abs(run["x"][-1] - run["x"][0] - row.predicted[proposal.best]) < 2.0 * error


@pytest.mark.slow
def test_a_power_of_the_speed_is_found_where_the_level_alone_fits_on_another_branch():
    law = PowerViscous(kinetic_coefficient=0.1, viscous_coefficient=1.2, viscous_exponent=0.5)
    settings = (0.06, 0.08, 0.1, 0.12, 0.14, 0.16)
    # read with errors of 0.5 mm; the best fit cannot leave more than the truth does
    errors = np.array([0.45, -0.3, 0.2, -0.6, 0.5, -0.2]) * 1e-3
    measured = readings(law, settings, rig=FASTENED, errors=errors, uncertainty=5e-4)
    found = fit(FASTENED, PowerViscous, measured)
    assert found.chi_square <= float(np.sum((errors / 5e-4) ** 2))


@pytest.mark.slow
def test_bristles_are_searched_in_all_valleys_where_a_stribeck_curve_is_named():
    # their search knew that of the best law alone, whose level lies below 0.137
    rig = SpringBlock(mass=1.1720783, stiffness=91.712509, compression=0.2218701, attached=True)
    read = (
        (0.078, (99.2314, 101.9837)), (0.102, (109.0619, 109.2957)), (0.132, (108.4349, 108.5133)),
        (0.168, (176.3736, 176.5794)), (0.215, (211.7013, 212.5189)),
    )  # fmt: skip
    trials = tuple(
        Measurement(
            travel=1e-3 * one, uncertainty=6.587e-4, overrides={"mechanism.compression": setting}
        )
        for setting, both in read
        for one in both
    )
    verdict = select(rig, ["coulomb", "stribeck", "lugre"], Measurement(trials=trials))
    assert "LuGre" in verdict.sentence  # the truth, with bristles that bend by 0.8 mm
    level = verdict.best.fit.estimate("kinetic_coefficient")
    assert any(low <= 0.2064 <= high for low, high in level.pieces or ((level.low, level.high),))


def test_friction_that_falls_all_the_way_is_among_what_the_readings_allow():
    truth = Stribeck(
        kinetic_coefficient=0.0872,
        static_coefficient=0.0967,
        stribeck_velocity=0.98,
        viscous_coefficient=0.591,
    )
    rig = SpringBlock(mass=1.318, stiffness=54.44, compression=0.22)
    settings = (0.08, 0.102, 0.129, 0.166, 0.22)
    verdict = select(rig, [*PLAIN, "stribeck"], readings(truth, settings, rig=rig))
    assert verdict.best.name == "coulomb-viscous"
    level, slope = verdict.best.fit.estimates
    # Coulomb + viscous friction alone has 0.0983 and 0.491 N s/m with narrow intervals
    assert level.low < truth.kinetic_coefficient < level.high
    assert slope.low < truth.viscous_coefficient < slope.high


def test_a_static_level_below_the_usual_sliding_one_can_be_given():
    truth = Stribeck(kinetic_coefficient=0.1, static_coefficient=0.15, stribeck_velocity=0.3)
    found = fit(RIG, Stribeck, readings(truth), fixed={"static_coefficient": 0.15})
    assert found.law.static_coefficient == 0.15
    assert found.law.kinetic_coefficient == pytest.approx(0.1, abs=0.01)
