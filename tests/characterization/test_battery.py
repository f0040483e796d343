"""The battery gives the published numbers of laws, and their closed forms."""

import json

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    Dahl,
    DirectionDependent,
    LuGre,
    characterize,
    simulate,
)
from stickslip.cli.console import show_sections
from stickslip.errors import InputError, SimulationError, UnknownNameError
from stickslip.friction import law
from stickslip.show.documents import document, json_text
from stickslip.show.report import characterization_page
from stickslip.study.characterization import TESTS, Bench, battery, cycle_energy
from stickslip.study.characterization.battery import (
    break_away,
    drift,
    passivity,
    presliding,
    steady_curve,
    there_and_back,
)

LEVELS = {"kinetic_coefficient": 1.0, "static_coefficient": 1.5, "stribeck_velocity": 1e-3}
BRISTLE = {"bristle_stiffness": 1e5, "bristle_damping": 1e5**0.5}
FLAT = {"kinetic_coefficient": 1.5, "bristle_stiffness": 1e5, "viscous_coefficient": 0.4}

LUGRE = LuGre(**LEVELS, **BRISTLE, viscous_coefficient=0.4)
"""The law of Canudas de Wit et al. (1995) with the parameters of that paper."""
DAHL = Dahl(**FLAT)
BOUC_WEN = law("bouc_wen(level) + viscous")(**FLAT, loop_share=0.5)
MAXWELL = law("maxwell[4](level) + viscous")(**FLAT)
ELASTO_PLASTIC = law("elasto_plastic(level + stribeck) + viscous")(
    **LEVELS, **BRISTLE, viscous_coefficient=0.4, elastic_share=0.7
)
COULOMB = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)


def test_break_away_of_lugre_falls_with_the_rate_as_published():
    found = break_away(Bench(law=LUGRE), rates=(1.0, 2.0, 10.0, 30.0), dwells=())
    # four decimals, as the design quotes them
    np.testing.assert_allclose(found.force, [1.4324, 1.3944, 1.2200, 1.0245], atol=5e-5)
    assert found.sentence.startswith("Break-away falls from 1.432 N at 1 N/s to 1.024 N at 30 N/s")


@pytest.mark.parametrize(
    ("one", "distance"),
    [(LUGRE, 6.2e-4), (DAHL, 6.2e-4), (BOUC_WEN, 1.2e-4), (ELASTO_PLASTIC, 0.0), (MAXWELL, 0.0)],
    ids=["lugre", "dahl", "bouc-wen", "elasto-plastic", "maxwell"],
)
def test_bristles_drift_under_a_ripple_and_elastic_contacts_do_not(one, distance):
    found = drift(Bench(law=one), bias=0.5, ripple=0.4)
    # two digits are published; what stays moves by less than 1e-7 m
    assert found.distance == pytest.approx(distance, rel=0.04, abs=1e-7)
    assert found.sentence.startswith("It drifts" if distance else "It does not drift")


@pytest.mark.parametrize(
    ("one", "change", "memory"),
    [(DAHL, -0.29, "local"), (BOUC_WEN, -0.12, "local"), (MAXWELL, 0.0, "non-local")],
    ids=["dahl", "bouc-wen", "maxwell"],
)
def test_only_a_non_local_memory_gives_the_force_back_after_a_closed_inner_loop(
    one, change, memory
):
    found = presliding(Bench(law=one), inner=(1.2e-5, 0.6e-5))
    assert found.change == pytest.approx(change, abs=5e-3)
    assert found.memory == memory


def test_the_first_loading_of_dahl_is_its_exponential():
    found = presliding(Bench(law=DAHL), amplitude=2e-5)
    first = found.force[: int(np.argmax(found.displacement)) + 1]
    x = found.displacement[: len(first)]
    # the viscous part at 0.1 um/s, and the state's start at 1e-9 of the length
    np.testing.assert_allclose(first, 1.5 * (1.0 - np.exp(-1e5 * x / 1.5)), atol=2e-7)


def test_the_published_cycle_returns_energy_from_lugre_unless_it_is_viscous_enough():
    cycle = {"velocity": [1e-4, 0.1], "duration": [0.25, 2e-4]}
    assert cycle_energy(LUGRE, **cycle)[0] == pytest.approx(-5.63e-5, rel=1e-3)
    # sigma_2 >= sigma_1 (F_s / F_c - 1) = 158 N s/m is the condition of passivity
    viscous = LuGre(**LEVELS, **BRISTLE, viscous_coefficient=160.0)
    assert cycle_energy(viscous, **cycle)[0] == pytest.approx(2.6e-4, rel=0.02)
    assert cycle_energy(ELASTO_PLASTIC, **cycle)[0] == pytest.approx(-7.1e-5, rel=0.01)


@pytest.mark.slow
def test_the_search_finds_a_cycle_that_is_no_better_than_the_published_one():
    found = passivity(Bench(law=LUGRE))
    assert not found.passive
    assert found.worst <= -5.6e-5
    energy = cycle_energy(LUGRE, found.velocity, found.duration)[0]
    assert energy == pytest.approx(found.worst, rel=1e-9)
    assert passivity(Bench(law=LuGre(**LEVELS, **BRISTLE, viscous_coefficient=160.0))).passive
    assert passivity(Bench(law=MAXWELL)).passive


def test_energies_of_cycles_have_the_closed_form_of_dahl():
    # a slow swing between +-X, long after its beginning, encloses the loop of two exponentials
    plain = Dahl(kinetic_coefficient=1.5, bristle_stiffness=1e5)
    reach, speed = 4e-5, 1e-3
    duration = [2 * reach / speed] * 2
    a = 1.5 / 1e5
    turn = np.tanh(reach / a)  # the force at a turn over the level
    expected = 2 * 1.5 * (2 * reach - a * (1 + turn) * (1 - np.exp(-2 * reach / a)))
    found = cycle_energy(plain, [speed, -speed], duration)[0]
    assert found == pytest.approx(expected, rel=1e-7)


def test_a_steady_curve_is_said_to_depend_on_the_speed_where_it_does_at_all():
    texts = {"grows with": 1e-3, "does not depend on": 0.0}
    for told, viscous in texts.items():
        one = law("level + viscous")(kinetic_coefficient=1.0, viscous_coefficient=viscous)
        assert f"friction {told} speed" in steady_curve(Bench(law=one)).sentence
    falls = law("level + tustin")(
        kinetic_coefficient=1.0, static_coefficient=1.005, stribeck_velocity=1e-3
    )
    assert "falls by no more than 1 %" in steady_curve(Bench(law=falls)).sentence
    assert "stable" not in steady_curve(Bench(law=falls)).sentence


def test_a_steady_curve_reaches_the_speeds_at_which_viscous_friction_is_seen():
    one = law("level + viscous")(kinetic_coefficient=1.0, viscous_coefficient=0.4)
    found = steady_curve(Bench(law=one))
    assert found.force.max() == pytest.approx(1.4)  # at 1 m/s; at 0.1 m/s it has grown by 4 %


def test_forces_scale_with_the_load():
    light, heavy = (
        break_away(Bench(law=LuGre(**LEVELS, **BRISTLE), load=load, mass=load), dwells=(1.0,))
        for load in (1.0, 1000.0)
    )
    # affine in the load without viscous part: with the mass as well, the same motion
    np.testing.assert_allclose(heavy.force, 1000.0 * light.force, rtol=1e-6)
    np.testing.assert_allclose(heavy.force_after, 1000.0 * light.force_after, rtol=1e-5)


def test_a_path_goes_where_it_is_told_and_stays_as_long_as_it_is_told():
    path, arrivals = there_and_back([1e-3, -2e-3], (0.1, 0.2), [0.5, 0.0])
    bench = Bench(law=Coulomb(kinetic_coefficient=0.1))
    run = simulate(bench.guided(path), bench.law, t_end=float(arrivals[-1]))
    at = run.at([arrivals[0], arrivals[0] + 0.5, arrivals[-1]])
    np.testing.assert_allclose(at["u"], [1e-3, 1e-3, -2e-3], atol=1e-12)


@pytest.fixture(scope="module")
def several():
    kinds = ("dahl(level + stribeck) + power", "tanh(level) + viscous")
    told = []
    found = characterize(
        LUGRE,
        *kinds,
        tests=["steady", "drift", "presliding"],
        progress=lambda done, total: told.append((done, total)),
    )
    assert told == [(n, 9) for n in range(1, 10)]
    return found


@pytest.mark.slow
def test_laws_beside_the_first_take_its_levels_speed_and_stiffness(several):
    dahl, smooth = (one.law for one in several.others)
    assert (dahl.kinetic_coefficient, dahl.static_coefficient) == (1.0, 1.5)
    assert (dahl.stribeck_velocity, dahl.bristle_stiffness) == (1e-3, 1e5)
    assert smooth.kinetic_coefficient == 1.0
    assert several.others[1].matched == "Kinetic coefficient as LuGre."
    apart = characterize(LUGRE, DAHL, tests=["steady"], match=False)
    assert apart.others[0].law is DAHL


def test_a_directional_law_is_matched_both_ways():
    other = DirectionDependent(
        forward_kinetic_coefficient=3.0,
        backward_kinetic_coefficient=4.0,
        forward_viscous_coefficient=0.1,
        backward_viscous_coefficient=0.2,
    )
    found = characterize(COULOMB, other, tests=["steady"]).others[0]
    assert found.law.backward_kinetic_coefficient == 1.0
    own = characterize(other, tests=["steady"]).steady
    assert own.break_away == (4.0, 3.0)
    assert own.sentence.startswith("Forwards:")
    assert "Backwards:" in own.sentence


def test_results_are_tables_json_and_sentences(several):
    assert [*several.results] == ["steady", "presliding", "drift"]
    assert several.by_test["drift"].keys() == {one.title for one in several.all}
    text = json.loads(json_text(document("characterize", several.to_dict())))
    assert text["tests"]["drift"]["sentence"] == several.drift.sentence
    assert len(text["others"]) == 2
    for result in several.results.values():
        table = result.to_dataframe()
        assert len(table) > 10
        assert set(result._column_units()) <= {*table.columns}
    assert "It drifts" in str(several.drift)
    assert "laws side by side" in str(several)


@pytest.mark.slow
def test_all_tests_of_a_law_have_a_sentence_and_a_table():
    found = characterize(LUGRE)
    assert [*found.results] == [*TESTS]
    assert not found.failed
    for result in found.results.values():
        assert result.sentence.endswith(".")
        assert result.conditions.endswith(".")
        assert "nan" not in result.sentence
        assert len(result.to_dataframe())


def test_the_mass_is_that_of_the_rig():
    bench = Bench.of(COULOMB, 1.0, Axis(inertia=3.0, stiffness=50.0))
    assert bench.mass == 3.0
    with pytest.raises(InputError, match="rig must be an Axis"):
        Bench.of(COULOMB, 1.0, object())


@pytest.mark.parametrize(
    ("call", "error", "match"),
    [
        (lambda: characterize("lugr"), UnknownNameError, "lugre"),
        (lambda: characterize(LUGRE, tests=["drfit"]), UnknownNameError, "drift"),
        (lambda: characterize(LUGRE, tests=[]), InputError, "tests must name"),
        (lambda: characterize(LUGRE, load=-1.0), InputError, "above 0"),
        (lambda: characterize(3.0), InputError, "a law must be"),
        (lambda: characterize(LUGRE, inputs={"temperature": 20.0}), InputError, "temperature"),
        (lambda: drift(Bench(law=DAHL), bias=1.4, ripple=0.2), InputError, "must stay below"),
        (lambda: cycle_energy(DAHL, [1.0, 2.0], [1.0]), InputError, "2 velocities and 1 duration"),
    ],
)
def test_what_cannot_be_used_is_refused(call, error, match):
    with pytest.raises(error, match=match):
        call()


WARM = law("level + viscous * exponential[temperature]")(
    kinetic_coefficient=1.0, viscous_coefficient=10.0, viscous_temperature_decay=0.03
)


def test_each_value_of_an_input_is_a_law_of_its_own():
    cold, warm = characterize(
        WARM, inputs={"temperature": (20.0, 60.0)}, tests=["steady", "drift"]
    ).all
    assert cold.title.endswith("temperature 20 °C")
    viscous = [one.steady.force - np.sign(one.steady.velocity) for one in (cold, warm)]
    np.testing.assert_allclose(viscous[1], viscous[0] * np.exp(-0.03 * 40.0), rtol=1e-9)
    assert cold.drift.stays


def test_runs_see_the_inputs_that_are_given():
    geared = law("level + weight[transmitted]")(
        kinetic_coefficient=1.0, transmitted_coefficient=0.1
    )
    found = characterize(geared, inputs={"transmitted": (0.0, 5.0)}, tests=["break-away"])
    assert [one.break_away.force[0] for one in found.all] == pytest.approx([1.0, 1.5], rel=1e-9)


def test_an_input_without_a_value_is_one_error_that_names_the_option():
    with pytest.raises(InputError, match=r"depends on temperature.*--input temperature=VALUE"):
        characterize(WARM)


@pytest.mark.slow
def test_latched_laws_are_tested_by_runs_and_what_cannot_be_is_said():
    slipping = law("gms[4](level + stribeck) + viscous")
    found = characterize(slipping, load=10.0, tests=["presliding", "drift", "passivity"])
    assert found.presliding.memory == "non-local"
    assert found.drift.stays
    # searched only as far as shorter steps give the same energies
    assert (found.passivity is None) == ("passivity" in found.failed)


def test_a_law_that_creeps_within_small_speeds_is_moved_to_and_fro_briefly():
    found = characterize("tanh-stribeck", tests=["presliding"])
    assert not found.failed
    assert found.presliding.sentence.startswith("It neither deflects nor holds")
    law, most = found.law, float(np.abs(found.presliding.force).max())
    # 1 % of the smoothing velocity, where tanh(u) = u to within u^2 / 3
    at_most = law.static_coefficient * 0.01
    assert most == pytest.approx(at_most, rel=1e-3)


def test_a_test_that_fails_is_told_beside_the_table_in_words_of_the_bench(monkeypatch, capsys):
    def ends(_bench):
        raise SimulationError("Reached the end. 1000000 steps led to 45 s. Use EventDriven(...).")

    monkeypatch.setattr(battery, "TESTS", {**TESTS, "drift": ends})
    found = characterize("coulomb", tests=["drift"])
    assert found.told("drift") == f"no result: {found.failed['drift']}"
    assert found.failed["drift"].startswith("Reached the end. The bench cannot follow this law")
    assert "EventDriven" not in found.failed["drift"]
    show_sections(characterization_page(found, versions={}).sections[:1])
    assert "no result: Reached the end. The bench" in " ".join(capsys.readouterr().out.split())
