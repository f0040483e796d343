"""Structures of a force balance become laws that one can simulate, with their coefficients."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from benchmarks.faults import FAULTS, faulty

from stickslip import Axis, CoulombViscous, LuGre, Measurement, SpringBlock, fit, select
from stickslip.evidence import SIGN, Balance, Fit, Series, Structure, Term, explain
from stickslip.friction import law
from stickslip.identification import ModelError, RecordSettings, model_errors
from stickslip.identification.settings import PROMPT, SensorResponse
from stickslip.identification.terms import composed_laws
from stickslip.identification.terms.composed_laws import Asked, composed_law, structure_of
from stickslip.identification.terms.dense_series import dense_series, is_dense
from stickslip.identification.terms.findings import _inside, asked_of
from stickslip.kinds.joints.explained import Explained, _compared
from stickslip.selection.verdict import friction_of

FADES = (0.1, 2.0)
BOTH = {"stribeck": FADES, "stribeck_dir": FADES, "power": (0.6,)}
DAHL, STOP, LUGRE = (2e-3, 1.0), (2e-3, 0.0), (2e-3, 1.0, 0.1, 0.5, 1.0)


POWERS = ("power", "power_cov")
WARMED = " + ".join(f"{part} * linear[temperature]" for part in ("level", "stribeck", "viscous"))
WARM = ("temperature", "stribeck_cov", "viscous_cov", "power_cov")
COVARIATES = {
    "weight": "transmitted",
    "motor_weight": "motor",
    "weight2": "transmitted",
    **dict.fromkeys(WARM, "temperature"),
}


def fitted(shape=SIGN, par=None, **coefficients):
    """Return a fit of terms with these coefficients, in a channel without a name."""
    par = par or {}
    terms = {
        kind: Term(kind, par.get(kind, ()), "", COVARIATES.get(kind, "")) for kind in coefficients
    }
    owner = [one for one in terms.values() for _ in range(np.size(coefficients[one.kind]))]
    structure = Structure(tuple(sorted(terms.values(), key=str)))
    return Fit(
        structure=structure if shape == SIGN else structure.shaped("", shape),
        coef=np.concatenate([np.atleast_1d(one) for one in coefficients.values()]).astype(float),
        owner=tuple(owner),
        sse=np.ones(10),
        counts=np.ones(10),
        residual=np.zeros(10),
        ok=True,
    )


@pytest.mark.parametrize(
    ("fit", "text", "name"),
    [
        (fitted(level=2.0), "level", "coulomb"),
        (fitted(viscous=2.0), "viscous", "viscous"),
        (fitted(level=2.0, viscous=3.0, inertia=1.0), "level + viscous", "coulomb-viscous"),
        (
            fitted(level=2.0, stribeck=1.0, viscous=3.0, par={"stribeck": (0.1, 2.0)}),
            "level + stribeck + viscous",
            "stribeck",
        ),
        (fitted(level=2.0, power=3.0, par={"power": (0.5,)}), "level + power", "power-viscous"),
        (fitted(level=2.0, viscous=3.0, quadratic=4.0), "level + viscous + drag", "quadratic-drag"),
        (
            fitted(level=2.0, offset=0.2, viscous=3.0, viscous_dir=0.5),
            "both_ways[levels](level + viscous)",
            "direction-dependent",
        ),
        (fitted(level=2.0, viscous=3.0, shape=DAHL), "dahl(level) + viscous", "dahl"),
        (fitted(level=2.0, viscous=3.0, shape=LUGRE), "lugre(level + stribeck) + viscous", "lugre"),
        (fitted(level=2.0, shape=STOP), "maxwell[1](level)", "maxwell[1](level)"),
        (
            fitted(level=2.0, level_slope=0.1),
            "level * linear[position]",
            "level * linear[position]",
        ),
        (
            fitted(level=2.0, weight=0.1, viscous=3.0),
            "level + weight[transmitted] + viscous",
            "bam-m3",
        ),
        (
            fitted(level=2.0, motor_weight=0.1, offset=0.2, viscous=3.0, viscous_dir=0.5),
            "both_ways[levels](level + viscous) + weight[motor]",
            "both_ways[levels](level + viscous) + weight[motor]",
        ),
        (
            fitted(level=2.0, weight2=0.1, shape=DAHL),
            "dahl(level + weight2[transmitted])",
            "dahl(level + weight2[transmitted])",
        ),
        (fitted(weight=0.1), "weight[transmitted]", "weight[transmitted]"),
        (
            fitted(
                level=2.0,
                stribeck=1.0,
                viscous=3.0,
                par={"stribeck": FADES, "stribeck_cov": FADES},
                **dict.fromkeys(WARM[:3], -0.01),
            ),
            WARMED,
            WARMED,
        ),
        (
            fitted(
                level=2.0,
                offset=0.2,
                power=3.0,
                power_dir=0.5,
                par=dict.fromkeys(("power", "power_dir"), (0.6,)),
            ),
            "both_ways[levels](level + power)",
            "both_ways(level + power)",
        ),
        (
            fitted(level=2.0, power=3.0, power_cov=-0.01, par=dict.fromkeys(POWERS, (0.6,))),
            "level + power * linear[temperature]",
            "level + power * linear[temperature]",
        ),
    ],
)
def test_a_structure_is_a_law_in_the_notation(fit, text, name):
    found = composed_law(fit, 1.0)
    assert (found.text, found.name) == (text, name)


def test_exponents_of_a_power_are_looked_for_whatever_stands_beside_it():
    par = {"stribeck": FADES, "stribeck_dir": FADES, "power": (0.6,), "power_dir": (0.6,)}
    both = {"level": 2.0, "stribeck": 1.0, "stribeck_dir": 0.2, "power": 3.0, "power_dir": 0.1}
    found = composed_law(fitted(shape=STOP, par=par, **both), 1.0)
    assert (
        found.text == "maxwell[1](both_ways[levels](level + stribeck)) + both_ways[levels](power)"
    )
    assert "viscous_exponent" in found.specification.free
    plain = composed_law(fitted(level=2.0, power=3.0, shape=DAHL, par={"power": (0.6,)}), 1.0)
    assert "friction.viscous_exponent" not in plain.held


def test_what_an_input_adds_needs_what_it_adds_to_and_is_like_it():
    step = Term("stribeck", (0.1, 2.0))
    grown = Term("stribeck_cov", (), "", "temperature")
    level = Structure((Term("level"),))
    for kind in ("stribeck_cov", "viscous_cov", "power_cov"):
        assert not level.having(Term(kind, (), "", "temperature")).complete
    both = level.having(step).having(grown)
    assert both.complete
    assert {one.par for one in both.terms} == {(), step.par}
    moved = both.without(step).having(Term("stribeck", (0.2, 2.0)))
    assert [one.par for one in moved.terms if one.kind == "stribeck_cov"] == [(0.2, 2.0)]


@pytest.mark.parametrize(
    ("beside", "held"),
    [
        (
            {"second": 0.2},
            {"friction.fading_exponent"},
        ),  # a second memory has no place in LuGre's law
        ({}, {"friction.fading_exponent"}),
    ],
)
def test_an_exponent_is_looked_for_under_the_name_of_the_law_that_has_it(beside, held):
    par = {"power": (0.3,), "second": (0.1, 10.0)}
    found = composed_law(fitted(level=2.0, power=3.0, shape=LUGRE, par=par, **beside), 1.0)
    assert found.name == "lugre-power"
    assert "viscous_exponent" in found.specification.free
    assert set(found.held) == held


def test_coefficients_are_those_of_the_law_over_the_load():
    fit = fitted(level=2.0, stribeck=1.0, viscous=3.0, par={"stribeck": (0.1, 2.0)})
    found = composed_law(fit, 4.0)
    assert found.held == ("friction.fading_exponent",)
    law = found.specification.law
    assert law.kinetic_coefficient == pytest.approx(0.5)
    assert law.static_coefficient == pytest.approx(0.75)
    assert (law.stribeck_velocity, law.fading_exponent) == (0.1, 2.0)
    assert law.viscous_coefficient == 3.0
    # the same friction, at a speed where the surplus has faded to 1/e
    assert law.force(0.1, 4.0) == pytest.approx(2.0 + np.exp(-1.0) + 0.3)


def strokes():
    """Return times, positions, velocities of strokes, and how warm it gets."""
    t = np.arange(0.0, 60.0, 0.01)
    x = 0.02 * np.sin(2.0 * t) + 0.005 * np.sin(5.3 * t)
    v = 0.04 * np.cos(2.0 * t) + 0.0265 * np.cos(5.3 * t)
    return t, x, v, 15.0 * (1.0 - np.exp(-t / 20.0))


def warmed(step):
    """Return measured friction of strokes while it warms; of its step, such a share per kelvin."""
    random = np.random.default_rng(5)
    t, x, v, warm = strokes()
    level, surplus = 5.0 * (1.0 - 0.01 * warm), 4.0 * (1.0 + step * warm)
    force = np.sign(v) * (level + surplus * np.exp(-((v / 0.01) ** 2))) + 20.0 * v
    force += random.normal(0.0, 0.05, len(t))
    return Measurement(
        time=t, position=x, velocity=v, friction=force, inputs={"temperature": 20.0 + warm}
    )


@pytest.mark.parametrize("step", [-0.02, 0.0])
def test_a_step_that_changes_with_the_temperature_is_told_from_one_that_does_not(step):
    asked = asked_of(Axis(inertia=1.0), warmed(step), "zero", (), PROMPT)
    found = composed_law(asked.explanation.best, 1.0)
    surplus = "stribeck * linear[temperature]" if step else "stribeck"
    assert found.text == f"level * linear[temperature] + {surplus} + viscous"
    if step:
        law = found.specification.law
        assert law.stribeck_temperature_slope == pytest.approx(step, rel=0.2)


@pytest.mark.slow
def test_a_level_grows_with_each_of_two_inputs_by_a_slope_of_its_own():
    t, x, v, warm = strokes()
    pressure = 1.0 + 0.5 * np.sin(0.3 * t)
    level = 5.0 * (1.0 + 0.4 * (pressure - 1.0)) * (1.0 - 0.01 * warm)
    force = np.sign(v) * level + 20.0 * v + np.random.default_rng(6).normal(0.0, 0.05, len(t))
    inputs = {"temperature": 20.0 + warm, "pressure": pressure}
    record = Measurement(time=t, position=x, velocity=v, friction=force, inputs=inputs)
    found = composed_law(
        asked_of(Axis(inertia=1.0), record, "zero", (), PROMPT).explanation.best, 1.0
    )
    assert found.text == "level * linear[pressure] * linear[temperature] + viscous"
    fitted_law = fit(Axis(inertia=1.0), found.specification.law, record, vary=["friction.*"]).law
    # 5 N at 20 degC and 1 Pa, of 3 N + 2 N a pascal: a slope of 2/3 a pascal, beyond its start
    assert fitted_law.level_pressure_slope == pytest.approx(2.0 / 3.0, rel=0.02)


@pytest.mark.parametrize("slope", [9.0, -7.0])
def test_a_slope_along_the_way_is_found_beyond_one_a_metre(slope):
    t, x, v, _ = strokes()
    force = np.sign(v) * 5.0 * (1.0 + slope * x) + 20.0 * v
    force += np.random.default_rng(7).normal(0.0, 0.05, len(t))
    record = Measurement(time=t, position=x, velocity=v, friction=force)
    found = fit(Axis(inertia=1.0), law("level * linear[position] + viscous"), record)
    assert found.law.level_position_slope == pytest.approx(slope, rel=0.02)


def test_directions_share_what_a_constant_force_cannot_stand_for():
    fit = fitted(level=2.0, offset=0.2, viscous=3.0, viscous_dir=0.5)
    found = composed_law(fit, 1.0)
    law = found.specification.law
    assert law.force(1.0, 1.0) == pytest.approx(2.2 + 3.5)
    assert law.force(-1.0, 1.0) == pytest.approx(-(1.8 + 2.5))
    assert found.constant == 0.0


def test_an_offset_alone_is_a_force_beside_the_law():
    found = composed_law(fitted(level=2.0, offset=0.2, inertia=1.5), 1.0)
    assert (found.text, found.constant, found.inertia) == ("level", 0.2, 1.5)


def test_the_length_of_a_memory_is_that_over_which_its_force_rises():
    law = composed_law(fitted(level=2.0, viscous=3.0, shape=DAHL), 4.0).specification.law
    # over the load: level 0.5, reached along 2 mm
    assert law.bristle_stiffness == pytest.approx(0.5 / 2e-3)


def test_factors_are_relative_to_what_they_multiply():
    fit = fitted(level=2.0, level_ripple=[0.4, 0.2], par={"level_ripple": (8.0,)})
    law = composed_law(fit, 1.0).specification.law
    assert law.level_position_sine == pytest.approx(0.2)
    assert law.level_position_cosine == pytest.approx(0.1)
    assert law.level_position_harmonic == 8.0


T = 0.01 * np.arange(400.0)
RECORD = Measurement(time=T, position=np.sin(T), force=np.cos(T))


@pytest.mark.parametrize(
    ("kind", "field"),
    [
        ("weight", "transmitted_coefficient"),
        ("motor_weight", "motor_coefficient"),
        ("weight2", "transmitted_quadratic_coefficient"),
    ],
)
def test_a_level_that_grows_with_the_torque_of_a_gear_is_a_part_of_the_law(kind, field):
    one = fitted(level=2.0, viscous=3.0, **{kind: 0.4})
    found = composed_law(one, 4.0)
    assert found.start[f"friction.{field}"] == 0.1
    assert found.start["friction.kinetic_coefficient"] == 0.5
    law_ = found.specification.law
    known = {COVARIATES[kind]: 0.0}
    assert structure_of(law_, one.structure, covariates=known).terms == one.structure.terms
    assert structure_of(law_, one.structure) is None  # of a record that does not tell the torque


def test_a_level_grows_with_the_torque_of_a_gear_in_one_way():
    structure = fitted(level=2.0, weight=0.1).structure
    assert structure.clashes(Term("weight2", (), "", "transmitted"))
    assert structure.clashes(Term("motor_weight", (), "", "motor"))
    assert not structure.clashes(Term("weight", (), "elbow", "transmitted"))


def test_known_springs_and_dampers_are_taken_off_the_force():
    (one,) = dense_series(Axis(inertia=2.0, stiffness=3.0), RECORD, "first", [])
    np.testing.assert_allclose(one.force, np.cos(T))
    np.testing.assert_allclose(one.taken, 3.0 * np.sin(T), atol=1e-6)
    assert one.mass == 2.0
    (free,) = dense_series(Axis(inertia=2.0), RECORD, "zero", ["mechanism.inertia"])
    assert free.mass is None
    assert free.inertia
    assert free.hold


def test_a_load_that_does_not_change_is_no_covariate():
    record = Measurement(time=T, position=np.sin(T), friction=np.cos(T), load=2.0)
    (one,) = dense_series(Axis(inertia=2.0), record, "zero", [])
    assert not one.covariates
    changing = Measurement(time=T, position=np.sin(T), friction=np.cos(T), load=2.0 + np.cos(T))
    (other,) = dense_series(Axis(inertia=2.0), changing, "zero", [])
    np.testing.assert_allclose(other.covariates["load"], 2.0 + np.cos(T))


def test_records_in_time_have_a_balance_at_every_sample_and_tables_have_none():
    table = Measurement(velocity=[0.1, 0.2], friction=[2.0, 2.1])
    decay = Measurement(time=T, position=np.sin(T))
    axis = Axis(inertia=1.0)
    assert is_dense(axis, RECORD)
    assert not is_dense(axis, table)
    assert is_dense(SpringBlock(mass=1.0, stiffness=1.0), decay)


def test_a_temperature_that_each_trial_has_for_itself_is_a_covariate():
    trials = [
        Measurement(time=T, position=np.sin(T), friction=np.cos(T), inputs={"temperature": one})
        for one in (20.0, 40.0 + T)
    ]
    first, second = dense_series(Axis(inertia=2.0), Measurement(trials=tuple(trials)), "zero", [])
    np.testing.assert_allclose(first.covariates["temperature"], 20.0)
    np.testing.assert_allclose(second.covariates["temperature"], 40.0 + T)


def test_a_bristle_without_a_step_has_a_shape_too():
    lugre = law("lugre(level) + viscous")(
        kinetic_coefficient=2.0, bristle_stiffness=1e3, bristle_damping=1.0, viscous_coefficient=3.0
    )
    found = structure_of(lugre, fitted(level=1.0).structure)
    assert found.shape("") == (2e-3, 1.0)


@pytest.mark.slow
def test_the_cure_adds_to_what_is_corrected_already():
    random = np.random.default_rng(1)
    t = np.arange(0.0, 8.0, 0.004)
    v = 0.12 * np.cos(4.0 * t) + 0.113 * np.cos(11.3 * t)
    x = 0.03 * np.sin(4.0 * t) + 0.01 * np.sin(11.3 * t)
    friction = SensorResponse(delay=0.02).shown(t, 2.0 * np.sign(v) + 3.0 * v)
    friction = friction + 0.02 * random.normal(size=t.size)
    record = Measurement(time=t, position=x, friction=friction)
    half = RecordSettings(friction_delay=0.01)
    (error,) = fit(Axis(inertia=1.0), CoulombViscous, record, settings=half).model_errors
    assert error.effect == pytest.approx(-0.01, abs=1e-3)
    asked = float(error.consequence.partition("friction_delay=")[2].partition(")")[0])
    assert asked == pytest.approx(0.02, abs=1e-3)


def left_of(share):
    """Return the findings where so much of the friction of a record without noise is left."""
    t = 0.002 * np.arange(5000)
    record = Measurement(time=t, position=np.sin(t), friction=2.0 * np.sign(np.cos(t)) + 0.01 * t)
    asked = asked_of(Axis(inertia=1.0), record, "zero", (), SensorResponse())
    found = asked.explanation
    left = np.full(len(found.best.counts), (share * found.scale) ** 2) * found.best.counts
    found = replace(found, best=replace(found.best, sse=left), faults=())
    return model_errors(found, record, "zero", SensorResponse())


@pytest.mark.slow
def test_what_is_left_beside_a_law_is_said_before_no_law_explains_it():
    assert not any(one.kind == "unexplained" for one in left_of(0.02))
    (partly,) = (one for one in left_of(0.07) if one.kind == "unexplained")
    assert "7 % of the friction" in partly.finding
    assert "a law that was not tried may come closer" in partly.finding
    assert (partly.share, partly.moved) == (0.0, ())
    (whole,) = left_of(0.2)
    assert whole.finding.startswith("No law and no fault that was tried explains")


def test_the_fading_of_a_law_is_that_of_its_shape():
    bell = law("lugre(level + stribeck) + viscous")(
        kinetic_coefficient=2.0,
        static_coefficient=3.0,
        stribeck_velocity=0.1,
        bristle_stiffness=1e3,
        bristle_damping=1.0,
        viscous_coefficient=3.0,
        fading_exponent=2.0,
    )
    best = fitted(level=2.0, viscous=3.0, shape=LUGRE).structure
    assert structure_of(bell, best).shape("") == (2e-3, 1.0, 0.1, 0.5, 2.0)


def test_the_textbook_bristle_stands_beside_other_laws_with_one():
    wide = {"level": 2.0, "viscous": 3.0}
    stop, lugre = fitted(**wide, shape=STOP), fitted(**wide, shape=LUGRE)
    rivals = [fitted(**wide, shape=DAHL), fitted(level=2.0, shape=DAHL)]
    asked = Asked(
        explanation=SimpleNamespace(best=stop, scale=2.0),
        laws={one.name: one for one in (composed_law(f, 1.0) for f in (stop, *rivals, lugre))},
        fits={composed_law(f, 1.0).name: f for f in (stop, *rivals, lugre)},
    )
    names = [one.name for one in _compared(asked)]
    assert names[:2] == ["maxwell[1](level) + viscous", "lugre"]
    assert names[-1] == "coulomb-viscous"
    assert len(names) == 4


def test_elasto_plastic_friction_stands_beside_a_bristle_that_does_not_yield():
    stop = fitted(STOP, level=2.0, stribeck=1.0, viscous=3.0, par={"stribeck": FADES})
    asked = Asked(
        explanation=SimpleNamespace(best=stop, scale=2.0),
        laws={one.name: one for one in [composed_law(stop, 1.0)]},
        fits={composed_law(stop, 1.0).name: stop},
    )
    assert [one.name for one in _compared(asked)] == [
        "maxwell[1](level + stribeck) + viscous",
        "elasto-plastic",
        "coulomb-viscous",
    ]


@pytest.mark.parametrize(("shape", "left"), [(SIGN, ["unexplained", "delay"]), (DAHL, ["delay"])])
def test_a_fit_with_a_memory_that_leaves_far_less_than_the_balance_lacks_no_law(shape, left):
    best = fitted(level=2.0, viscous=3.0, shape=shape)
    said = [
        ModelError(
            kind=kind, finding=kind, consequence="", effect=1.0, interval=(0.0, 1.0), share=0.0
        )
        for kind in ("unexplained", "delay")
    ]
    own = composed_law(best, 1.0)
    asked = Asked(
        explanation=SimpleNamespace(best=best, scale=2.0),
        laws={own.name: own},
        fits={own.name: best},
    )
    explained = Explained(asked=asked, specs=(), starts={}, errors=tuple(said), unit="N")

    def kinds(*left):
        return [one.kind for one in explained.errors_of(own.name, own.specification.law, *left)]

    assert best.rms == 1.0
    assert kinds(0.9) == ["unexplained", "delay"]
    assert kinds(0.1) == left  # of other laws, a fit has the narrower band
    assert kinds() == ["unexplained", "delay"]  # a fit to positions leaves no force


@pytest.mark.slow
def test_bristles_that_positions_do_not_resolve_are_no_reason_to_ask_for_another_law():
    t = np.arange(0.0, 10.0, 0.002)
    x, v = np.sin(t) - 0.4 * np.sin(2.3 * t), np.cos(t) - 0.92 * np.cos(2.3 * t)
    random = np.random.default_rng(4)
    friction = 2.0 * np.sign(v) + 0.5 * v + 0.02 * random.normal(size=len(t))
    seen = x + 1e-4 * random.normal(size=len(t))
    record = Measurement(time=t, position=seen, friction=friction)
    asked = asked_of(Axis(inertia=1.0), record, "zero", (), PROMPT)
    kind = law("dahl(level) + viscous")
    for stiffness, unlike in ((2.0 / 3e-4, False), (2.0 / 3e-2, True)):
        own = kind(kinetic_coefficient=2.0, viscous_coefficient=0.5, bristle_stiffness=stiffness)
        assert asked.rejects(asked.fit_of(own.name, own)) is unlike


@pytest.mark.slow
@pytest.mark.parametrize("known", [None, 1.0])
def test_beside_other_joints_a_spring_may_be_an_error_of_their_parameters(known):
    t = np.arange(0.0, 10.0, 0.002)
    x, v = np.sin(t) - 0.4 * np.sin(2.3 * t), np.cos(t) - 0.92 * np.cos(2.3 * t)
    force = 0.8 * x + 2.0 * np.sign(v) + 0.02 * np.random.default_rng(4).normal(size=len(t))
    taken = None if known is None else known * np.sin(0.7 * t)
    whole = force if taken is None else force + taken
    found = explain([Series(t, x, whole, mass=0.0, taken=taken)])
    record = Measurement(time=t, position=x, force=whole)
    (error,) = model_errors(found, record, "zero", PROMPT)
    assert error.kind == ("spring" if known is None else "spring or parameters")
    assert ("given parameters of the mechanism" in error.finding) is (known is not None)
    assert " explains 0.598 N of the force" in error.consequence


def under_a_load(friction):
    """Return a record of measured friction (n,) under a load that swells, given speed and load."""
    t = np.arange(0.0, 14.0, 0.004)
    v = 0.1 * (np.sin(2.5 * t) + 0.6 * np.sin(4.3 * t + 1.0))
    load = 50.0 * 2.0 ** np.sin(1.3 * t)
    noise = 0.2 * np.random.default_rng(2).normal(size=len(t))
    x = np.concatenate([[0.0], np.cumsum(0.002 * (v[1:] + v[:-1]))])
    return Measurement(time=t, position=x, friction=friction(v, load) + noise, load=load)


@pytest.mark.slow
def test_a_level_that_grows_with_the_load_is_the_level_of_the_law():
    record = under_a_load(lambda v, load: 0.3 * load * np.sign(v) + 40.0 * v)
    asked = asked_of(Axis(inertia=1.0), record, "zero", (), PROMPT)
    assert asked.best.text == "level + viscous"
    assert asked.best.start["friction.kinetic_coefficient"] == pytest.approx(0.3, abs=0.003)
    assert model_errors(asked.explanation, record, "zero", PROMPT) == ()
    coulomb = CoulombViscous(kinetic_coefficient=0.3, viscous_coefficient=40.0)
    assert not asked.rejects(asked.fit_of("other", coulomb))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("share", "said"),
    [
        (0.3, "N of the friction level does not grow with the load; 0.3"),
        (0.0, "N, does not grow with the load that was recorded."),
    ],
)
def test_a_level_that_does_not_grow_with_the_load_is_said(share, said):
    record = under_a_load(lambda v, load: (share * load + 6.0) * np.sign(v) + 40.0 * v)
    asked = asked_of(Axis(inertia=1.0), record, "zero", (), PROMPT)
    (found,) = model_errors(asked.explanation, record, "zero", PROMPT)
    assert found.kind == "load"
    assert said in found.finding
    assert found.interval[0] < 6.0 < found.interval[1]


def broken(name, seed, change=lambda one: one):
    """Return what is said of a rig of the benchmark with a fault, whose mass is looked for."""
    _, record = faulty(name, np.random.default_rng([seed, list(FAULTS).index(name)]))
    record = change(record)
    asked = asked_of(Axis(inertia=1.0), record, "zero", ("mechanism.inertia",), PROMPT)
    return model_errors(asked.explanation, record, "zero", PROMPT)


def clipped(record, share):
    force = np.asarray(record.force)
    most = share * np.max(np.abs(force))
    return replace(record, force=np.clip(force, -most, most))


@pytest.mark.slow
def test_a_fault_that_samples_at_the_end_of_a_range_alone_ask_for_may_be_that_range():
    (found,) = broken("clipped-sensor", 7330)
    assert found.kind == "backlash or saturation"
    assert "more force than was recorded where it stays at its extreme" in found.finding


@pytest.mark.slow
def test_a_fault_that_the_other_samples_ask_for_too_is_named_beside_a_range():
    (found,) = broken("unknown-spring", 7330, lambda one: clipped(one, 0.95))
    assert found.kind == "spring"


def test_only_the_end_at_which_a_force_stays_is_left_out_whatever_its_sign():
    """A constant 12 N: the smallest force is 8 N, of one record, and the other has none so low."""
    time = 0.002 * np.arange(5000)
    force = 12.0 + 2.0 * np.sign(np.cos(3.0 * time)) + 4.0 * np.sin(3.0 * time)
    low = Measurement(time=time, position=np.sin(3.0 * time), force=np.maximum(force, 8.0))
    both = Measurement(trials=[low, replace(low, force=force + 10.0)])
    balance = Balance(dense_series(Axis(inertia=1.0), both, "zero", ()))
    inside = _inside(SimpleNamespace(balance=balance), both)
    first, second = balance.parts
    there = first.raw[:: first.every] == 8.0
    assert there.mean() > 0.1
    assert not (inside.use[first.rows] & there).any()
    assert np.mean(inside.use[first.rows]) > 0.5
    assert np.mean(inside.use[second.rows]) > 0.9


@pytest.mark.slow
def test_where_lost_samples_make_the_position_jump_nothing_is_called_late():
    assert [one.kind for one in broken("dropped-samples", 7330)] == ["unexplained"]


@pytest.mark.slow
def test_outliers_are_counted_and_blame_nothing_else():
    record = under_a_load(lambda v, load: 0.3 * load * np.sign(v) + 40.0 * v)
    friction = np.array(record.friction)
    friction[[500, 1400, 2600]] += 200.0
    broken = replace(record, friction=friction)
    asked = asked_of(Axis(inertia=1.0), broken, "zero", (), PROMPT)
    (found,) = model_errors(asked.explanation, broken, "zero", PROMPT)
    assert found.kind == "outliers"
    assert found.finding.startswith("3 samples of the friction lie far off those beside")


@pytest.mark.slow
def test_outliers_are_left_out_of_fits_and_leave_the_verdict_alone():
    record = under_a_load(lambda v, load: 0.3 * load * np.sign(v) + 40.0 * v)
    friction, position = np.array(record.friction), np.array(record.position)
    friction[[500, 1400, 1401, 2600]] += 200.0
    position[[800, 2000]] -= 0.5 * np.ptp(position)
    broken = replace(record, friction=friction, position=position)
    whole, found = (fit(Axis(inertia=1.0), CoulombViscous, one) for one in (record, broken))
    assert found.values[:2] == pytest.approx(whole.values[:2], rel=1e-3)
    said = {one.finding: one.moved for one in found.model_errors}
    assert said == {
        "2 samples of the position lie far off those beside.": (),
        "4 samples of the friction lie far off those beside.": (),
    }
    verdict = select(Axis(inertia=1.0), ["coulomb", "coulomb-viscous"], broken)
    assert verdict.words.verdict.startswith("Use Coulomb + viscous friction")
    assert any("4 samples of the friction" in line for line in verdict.words.cannot_tell)


@pytest.mark.parametrize(
    ("fit", "said"),
    [
        (
            fitted(level=2.0, viscous=3.0, viscous_dir=1.0, stribeck=1.0, par={"stribeck": FADES}),
            "Stribeck by direction",
        ),
        (
            fitted(level=2.0, stribeck=1.0, stribeck_dir=0.5, power=3.0, offset=0.1, par=BOTH),
            "Stribeck by direction + power of speed",
        ),
        (
            fitted(level=2.0, stribeck=1.0, par={"stribeck": FADES}),
            "Stribeck without viscous part",
        ),
        (fitted(STOP, level=2.0, viscous=3.0), "Maxwell slip + viscous"),
        (
            fitted(level=2.0, level_ripple=[0.4, 0.2], viscous=1.0, par={"level_ripple": (8.0,)}),
            "Coulomb with teeth + viscous",
        ),
    ],
)  # fmt: skip
def test_a_composition_without_a_name_is_called_in_words(fit, said):
    title = composed_law(fit, 1.0).specification.title
    assert title == said
    assert not {"(", "[", "*", "_"} & set(friction_of(title))


def test_dahl_with_a_level_that_fades_is_lugre_without_damping():
    faded = law("dahl(level + stribeck) + viscous")(
        kinetic_coefficient=2.0,
        static_coefficient=3.0,
        stribeck_velocity=0.1,
        bristle_stiffness=1e3,
        viscous_coefficient=3.0,
    )
    lugre = law("lugre(level + stribeck) + viscous")(
        kinetic_coefficient=2.0,
        static_coefficient=3.0,
        stribeck_velocity=0.1,
        bristle_stiffness=1e3,
        viscous_coefficient=3.0,
        bristle_damping=1.0,
    )
    rest = Structure((Term("level"), Term("inertia")))
    assert structure_of(faded, rest).having(Term("damping")) == structure_of(lugre, rest)
    assert structure_of(faded, rest).memories[0][1] == pytest.approx((2e-3, 1.0, 0.1, 0.5, 2.0))


BRISTLE = LuGre(
    kinetic_coefficient=2.0,
    static_coefficient=3.0,
    stribeck_velocity=0.01,
    bristle_stiffness=1e4,
    bristle_damping=10.0,
    viscous_coefficient=1.0,
)


@pytest.mark.parametrize(
    "shift", [Term("offset"), Term("level_dir"), Term("stribeck_dir", (0.1, 2.0))]
)
def test_a_law_of_one_level_has_a_constant_force_where_the_best_structure_has_a_like_one(shift):
    # else LuGre friction left twice what LuGre by direction did, and another law was asked for;
    # a Stribeck step by direction stands for a constant force, too, where motion is slow
    best = Structure((Term("inertia"), Term("level"), shift)).shaped("", DAHL)
    found = structure_of(BRISTLE, best)
    assert found is not None
    assert found.has("offset")
    assert not found.has("level_dir")


@pytest.mark.parametrize(("shape", "kept"), [(SIGN, False), (DAHL, True), ((1.0, 1.0), False)])
def test_a_bristle_that_no_path_resolves_is_compared_with_one_like_it(monkeypatch, shape, kept):
    monkeypatch.setattr(composed_laws, "polished", lambda balance, one: one)
    monkeypatch.setattr(
        composed_laws, "fit", lambda balance, one: SimpleNamespace(structure=one, rms=1.0)
    )
    best = Structure((Term("inertia"), Term("level"))).shaped("", shape)
    balance = SimpleNamespace(resolves=lambda length, channel: length > 0.1, references={})
    explanation = SimpleNamespace(balance=balance, best=SimpleNamespace(structure=best))
    asked = Asked(explanation=explanation, laws={}, fits={})
    assert bool(asked.fit_of("lugre", BRISTLE).structure.memories) is kept
