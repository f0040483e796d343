"""Laws composed of parts: one line gives class, equations, formula, names and what they contain."""

import dataclasses
import itertools
import math
import re
from collections import Counter
from random import Random
from typing import Annotated, ClassVar

import numpy as np
import pytest
from tests.support import quick

from stickslip import (
    Axis,
    Coulomb,
    LuGre,
    Measurement,
    SpringBlock,
    Stribeck,
    fit,
    load_rig,
    simulate,
)
from stickslip.data import Rig, carried, unit_on
from stickslip.data.rigs.rig_writer import rig_toml
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import (
    LAWS,
    SetValuedLaw,
    anywhere,
    bound,
    force_parameters,
    law,
    law_type,
    laws,
    specification,
)
from stickslip.friction.notation import Around, Product, Sum, read
from stickslip.friction.parts import PARTS
from stickslip.friction.parts.base import Level, Slip
from stickslip.identify.fits.parameters import starting_law
from stickslip.maths import Latches
from stickslip.mechanisms.drives import Sine
from stickslip.quantities import Quantity, _powers, fields_of
from stickslip.study.sweep.parameter_grid import unit_of

FREE = (
    "level + stribeck + power",
    "level + lorentz + saturating",
    "level + hyperbolic + drag",
    "both_ways(level + stribeck + viscous)",
    "both_ways[levels](level + stribeck) + viscous",
    "tanh(level + stribeck) + viscous",
    "atan(level)",
    "root(level) + power",
    "ramp(level)",
    "threlfall(level) + viscous",
    "brown_mcphee + viscous",
    "simscape + viscous",
    "dahl(level + stribeck) + power",
    "dahl(both_ways[levels](level + stribeck)) + both_ways[levels](power)",
    "lugre_fading(level + stribeck) + viscous",
    "elasto_plastic(level + stribeck) + viscous",
    "bouc_wen(level) + viscous",
    "maxwell[3](level) + viscous",
    "gms[2](level + stribeck) + viscous",
    "reset(level + lorentz) + viscous",
    "bliman_sorine(both_ways[levels](level)) + power",
    "relaxing[2](both_ways[levels](level + stribeck)) + viscous",
    "level + viscous * exponential[temperature]",
    "(level + stribeck) * linear[gravity] + viscous * exponential[temperature]",
    "level * ripple[position] * linear[temperature] + power * linear[pressure]",
    "level + stribeck * linear[temperature, stribeck_velocity] + viscous",
    "level + weight[transmitted] + weight2[pressure] + viscous",
    "level + stribeck + weight[transmitted] + weight_fading[transmitted] + viscous",
    "level + stribeck + gear + gear_stribeck + gear_quadratic + viscous",
    "lugre((level + stribeck) * linear[temperature] + weight[transmitted]) + viscous",
    "both_ways(level * linear[temperature] + stribeck) + viscous * linear[temperature]",
    "both_ways[levels](level + viscous) * linear[temperature]",
    "dahl(both_ways(level * linear[temperature])) + viscous",
    "tanh((level + stribeck) * linear[gravity] + weight[motor]) + viscous",
    "(level + step) * linear[temperature] + viscous",
    "maxwell[3](level * linear[temperature] + weight[transmitted])",
    "reset(both_ways[levels](level + stribeck) * linear[temperature]) + viscous",
    "level + stribeck + logarithmic + polynomial[3]",
    "lugre(level + logarithmic) + viscous",
    "makkar + viscous",
    "bengisu_akay + drag",
    "table[0: 2, 1e-2: 15e-1, 5e-2: 12e-1, 3e-1: 13e-1] + viscous",
    "lugre(table[1e-3: 3e-1, 1e-1: 2e-1]) + viscous",
)
CONTACT = {
    "motor": 1.3, "external": -0.7, "transmitted": 2.0, "gravity": -0.4,
    "position": 0.3, "temperature": 8.0, "pressure": 2e4,
}  # fmt: skip


LEVELS = (
    "step", "stribeck", "tustin", "lorentz", "hyperbolic", "logarithmic", "peak",
)  # fmt: skip
FLOWS = (
    "viscous", "power", "drag", "saturating", "polynomial[2]", "viscous + drag", "power + drag",
)  # fmt: skip
AROUND = (
    "{}", "both_ways({})", "both_ways[levels]({})", "({}) * linear[temperature]", "tanh({})",
    "root({})", "dahl({})", "lugre({})", "lugre_fading({})", "elasto_plastic({})", "bouc_wen({})",
    "maxwell[3]({})", "gms[2]({})", "reset({})", "bliman_sorine({})", "relaxing[2]({})",
    "dahl(both_ways[levels]({}))", "lugre(both_ways({}))",
)  # fmt: skip


def compositions():
    """Yield all sums of up to three levels on a level, around them something, and a flow."""
    for count in range(4):
        for more in itertools.combinations(LEVELS, count):
            levels = " + ".join(("level", *more))
            for around in AROUND:
                yield around.format(levels)
                for flow in FLOWS:
                    yield f"{around.format(levels)} + {flow}"
                    if around.startswith("both_ways"):
                        yield around.format(f"{levels} + {flow}")


def random_law(kind, random):
    """Return a law with random values, its levels in their order."""
    values, ranks = {}, {"kinetic": 0.1, "static": 0.4, "break_away": 0.7}
    for name, quantity in fields_of(kind).items():
        rank = next((low for word, low in ranks.items() if f"{word}_coefficient" in name), None)
        value = (rank or quantity.start or 0.2) * (1.0 + 0.5 * random.random())
        values[name] = min(value, quantity.high)
    return bound(kind(**values), CONTACT)


class Side:
    """The parameters of one direction of slip, by the names that parts have for them."""

    def __init__(self, one, prefix):
        self.one, self.prefix = one, prefix

    def __getattr__(self, name):
        own = {name, self.prefix + name} & {*fields_of(type(self.one))}
        return getattr(self.one, max(own, key=len))


def by_parts(term, p, speed):
    """Return level and force of steady sliding, and the level at rest, part by part."""
    match term:
        case Sum(items=items):
            level, flow, rest = zip(*(by_parts(one, p, speed) for one in items), strict=True)
            return sum(level), sum(flow), max(rest)
        case Around(head=head, inner=inner):
            level, flow, rest = by_parts(inner, p, speed)
            if head.role == "sign":
                return level * head.part.shape(p, Slip(speed=speed, along=speed)), flow, 0.0
            return level, flow, rest * (head.part.peak(p) if head.role == "memory" else 1.0)
        case Product(first=first):
            (slope,) = (name for name in fields_of(type(p.one)) if name.endswith("ature_slope"))
            times = 1.0 + getattr(p.one, slope) * CONTACT["temperature"]
            return tuple(times * part for part in by_parts(first, p, speed))
    slip = Slip(speed=speed, along=speed)
    if term.role == "flow":
        return 0.0, term.part.flow(p, slip), 0.0
    rest = getattr(p, term.part.rest) if isinstance(term.part, Level) else 0.0
    return term.part.sliding(p, slip) or 0.0, 0.0, rest


def lost(text):
    """Return why a text does not run as it reads; None if it does, or is no law."""
    try:
        kind = law(text)
    except InputError:
        return None
    parts, own = (
        {str(name) for name in term.parts() if name.name != "both_ways"}
        for term in (read(text), kind.composition)
    )
    if parts - own or not own - parts <= {"step", "peak"}:
        return f"{text} has the class of {kind.composition}"
    if law(str(kind.composition)) is not kind:
        return f"{kind.composition} is not the text of its law"
    random = Random(text)
    one = random_law(kind, random)
    one = bound(dataclasses.replace(one, **{
        name: None for name in fields_of(kind)
        if any(f"{low}_coefficient" in name for low in ("static", "break_away"))
        and not any(name.endswith(p.name) for n in read(text).parts() for p in n.part.parameters)
    }), CONTACT)  # fmt: skip
    load, rests = 2.0, []
    for sign, prefix in ((1.0, "forward_"), (-1.0, "backward_")):
        speed = 10.0 ** random.uniform(-3.0, 0.0)
        level, flow, rest = by_parts(read(text), Side(one, prefix), speed)
        rests.append(rest * load)
        expected = sign * (level * load + flow)
        if one.steady(sign * speed, load) != pytest.approx(expected, rel=1e-12):
            return f"{text}: friction at {sign * speed} is {one.steady(sign * speed, load)}"
    if one.break_away(load) != pytest.approx(min(rests), rel=1e-12):
        return f"{text}: break-away is {one.break_away(load)}"
    return None


NAMED_BEFORE = (
    "level + step + power", "dahl(level + step) + power", "both_ways(level + step + viscous)",
    "level + stribeck + power + peak", "lugre(level + stribeck + peak) + power",
    "level + viscous + step", "level + stribeck + viscous",
)  # fmt: skip


@pytest.mark.parametrize("step", quick(("211", "1"), "211"))
def test_what_is_read_is_what_runs_part_by_part(step):
    texts = [*NAMED_BEFORE, *itertools.islice(compositions(), 0, None, int(step))]
    assert [text for text in map(lost, texts) if text] == []


def started(kind):
    """Return a law at its start values, where factors have an effect, bound to its inputs."""
    one = starting_law(kind)
    ranges = {name: quantity for name, quantity in fields_of(kind).items() if quantity.start == 0.0}
    felt = {name: 0.3 * quantity.bounds[1] for name, quantity in ranges.items()}
    sized = {
        name: value / 10.0 if name.startswith("gravity") else value for name, value in felt.items()
    }
    return bound(dataclasses.replace(one, **sized), CONTACT)


def magnitude(one, v, load=2.0):
    """Return the force of steady slip."""
    return one.steady(v, load) if hasattr(one, "steady") else one.force(v, load)


@pytest.mark.parametrize("text", FREE)
def test_every_part_is_used_by_some_law_of_these_tests_and_floats_agree_with_arrays(text):
    one = started(law(text))
    for v in (-0.3, -1e-3, 2e-3, 0.7):
        (of_array,) = np.atleast_1d(magnitude(one, np.array([v])))
        # NumPy's functions and those of the C library differ in the last digit
        assert magnitude(one, v) == pytest.approx(of_array, rel=1e-14)
        assert magnitude(one, v) * v >= 0.0


def test_the_texts_of_these_tests_contain_every_part():
    named = [str(kind.composition) for kind in LAWS.values()]
    used = {name.name for text in (*FREE, *named) for name in read(text).parts()}
    assert set(PARTS) <= used


@pytest.mark.parametrize("text", [text for text in FREE if "both_ways" not in text])
@pytest.mark.parametrize("v", [1e-3, 0.2])
def test_a_law_with_one_set_of_parameters_is_odd(text, v):
    one = started(law(text))
    assert magnitude(one, -v) == -magnitude(one, v)


def test_directions_keep_parameters_that_the_law_of_one_direction_names_otherwise():
    kind = law("both_ways(level + stribeck + viscous)")
    ahead = {"kinetic_coefficient": 1.0, "static_coefficient": 2.0, "stribeck_velocity": 0.1}
    back = {"kinetic_coefficient": 1.5, "static_coefficient": 1.7, "stribeck_velocity": 0.2}
    values = {f"forward_{name}": value for name, value in ahead.items()}
    values |= {f"backward_{name}": value for name, value in back.items()}
    values |= {"forward_fading_exponent": 0.7, "backward_fading_exponent": 1.0}
    values |= {"forward_viscous_coefficient": 0.3, "backward_viscous_coefficient": 0.0}
    one = kind(**values)
    assert one.towards(1) == Stribeck(**ahead, viscous_coefficient=0.3, fading_exponent=0.7)
    expected = 1.5 + 0.2 * math.exp(-0.5)  # at half the Stribeck velocity, exponent 1
    assert one.force(-0.1, load=1.0) == pytest.approx(-expected, rel=1e-15)
    assert one.break_away(1.0) == 1.7  # the smaller one


@pytest.mark.parametrize(
    "name", [name for name, one in LAWS.items() if hasattr(one, "composition")]
)
def test_the_name_of_a_law_is_no_other_law_when_it_is_read_as_a_composition(name):
    kind = LAWS[name]
    if name == str(kind.composition):
        assert law(name) is kind
        return
    told = re.escape(f"The law named {name} is {kind.composition}")
    with pytest.raises(InputError, match=rf"{told}: .*\.{kind.__name__}\.$"):
        law(name)
    if name in PARTS:
        with pytest.raises(InputError, match=told):
            law(read(name))


def test_smooth_laws_take_the_values_that_their_formulas_print():
    brown = law("brown_mcphee")(
        kinetic_coefficient=1.0, static_coefficient=1.5, transition_velocity=0.01
    )
    # tanh 4 = 0.99933 is what the smoothing leaves of the kinetic level at the transition velocity
    assert brown.force(0.01, 1.0) == pytest.approx(math.tanh(4.0) + 0.5, rel=1e-15)
    block = law("simscape + viscous")(
        kinetic_coefficient=1.0,
        static_coefficient=1.5,
        breakaway_velocity=0.01,
        viscous_coefficient=0.0,
    )
    assert block.force(0.01, 1.0) == pytest.approx(math.tanh(10.0) + 0.5, rel=1e-15)
    rise = law("threlfall(level)")(kinetic_coefficient=2.0, smoothing_velocity=0.1)
    assert rise.force(0.1, 1.0) == 2.0
    assert rise.force(0.05, 1.0) == pytest.approx(2.0 * math.expm1(-1.5) / math.expm1(-3.0))


def test_a_factor_of_a_parameter_is_printed_wherever_a_part_reads_that_parameter():
    kind = law_type("joint-load-temperature")
    assert kind.formula.count(r"e^{-|v/(v_s (1 + \alpha_T T))|^n}") == 2
    assert "v/v_s" not in kind.formula
    one = kind(
        kinetic_coefficient=1.0,
        static_coefficient=1.5,
        stribeck_velocity=0.01,
        stribeck_velocity_temperature_slope=0.02,
        gravity_coefficient=0.0,
        gravity_static_surplus=0.5,
        viscous_coefficient=0.0,
        viscous_temperature_decay=0.0,
    )
    loaded, free = (
        bound(one, {"temperature": 50.0, "gravity": x}).force(0.01, 1.0) for x in (1.0, 0.0)
    )
    assert loaded - free == pytest.approx(0.5 * math.exp(-((1.0 / 2.0) ** 2)))


def test_further_curves_take_the_values_that_their_formulas_print():
    peaked = law("bengisu_akay")(
        kinetic_coefficient=1.0, static_coefficient=1.5, peak_velocity=0.02, fall_rate=30.0
    )
    assert peaked.force(0.02, 1.0) == 1.5
    assert peaked.force(0.005, 1.0) == pytest.approx(1.5 - 1.5 / 0.02**2 * 0.015**2, rel=1e-15)
    assert peaked.force(0.12, 1.0) == pytest.approx(1.0 + 0.5 * math.exp(-3.0), rel=1e-15)
    smooth = law("makkar + viscous")(
        bump_coefficient=0.25, rise_rate=100.0, fall_rate=10.0, kinetic_coefficient=0.5,
        smoothing_rate=90.0, viscous_coefficient=0.01,
    )  # fmt: skip
    expected = 0.25 * (math.tanh(4.0) - math.tanh(0.4)) + 0.5 * math.tanh(3.6) + 0.01 * 0.04
    assert smooth.force(0.04, 1.0) == pytest.approx(expected, rel=1e-15)
    growing = law("level + logarithmic")(
        kinetic_coefficient=1.0, logarithmic_coefficient=0.2, reference_velocity=0.1
    )
    assert growing.force(0.1 * (math.e - 1.0), 2.0) == pytest.approx(2.4, rel=1e-15)
    assert growing.break_away(2.0) == 2.0
    cubic = law("level + polynomial[3]")(
        kinetic_coefficient=1.0, speed_coefficient_1=3.0, speed_coefficient_2=-2.0,
        speed_coefficient_3=0.5,
    )  # fmt: skip
    assert cubic.force(-2.0, 1.0) == -(1.0 + 6.0 - 8.0 + 4.0)


def test_elements_of_maxwell_slip_yield_one_after_the_other_up_to_the_level():
    one = law("maxwell[3](level)")(kinetic_coefficient=6.0, bristle_stiffness=900.0)
    # each element has a third of the stiffness; levels 1 : 2 : 3 with the sum of the law's
    assert one.rates(0.5, 1.0, (0.0, 0.0, 0.0)) == (0.5, 0.5, 0.5)
    slack = [2.0 * i / 4.0 * 6.0 / 900.0 for i in (1, 2, 3)]
    assert one.rates(0.5, 1.0, tuple(slack)) == (0.0, 0.0, 0.0)
    assert one.force(0.5, 1.0, tuple(slack)) == pytest.approx(6.0, rel=1e-15)
    assert one.rates(-0.5, 1.0, tuple(slack)) == (-0.5, -0.5, -0.5)


def test_an_elasto_plastic_contact_does_not_drift_below_its_elastic_share_and_lugre_does():
    values = {
        "kinetic_coefficient": 1.0, "static_coefficient": 1.5, "stribeck_velocity": 1e-2,
        "bristle_stiffness": 1e4, "bristle_damping": 100.0, "viscous_coefficient": 0.4,
    }  # fmt: skip
    # a mean force of a third of the static level and a ripple around it
    shaken = Axis(inertia=1.0, drive=Sine(amplitude=0.4, frequency=1.0), offset=-0.5)
    drifts = []
    for kind in (law("elasto_plastic(level + stribeck) + viscous"), LuGre):
        more = {"elastic_share": 0.8} if kind is not LuGre else {}
        run = simulate(shaken, kind(**values, **more), t_end=8.0)
        seen = run.at(np.arange(1.0, 8.5))
        drifts.append(float(np.ptp(seen["x"] - seen["z"])))
    # what has not yielded has moved as far as its bristle has bent, to rounding
    assert drifts[0] < 1e-15
    assert drifts[1] > 1e-4


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "linear[temperature] * viscous",
            r"character 21: .*write viscous \* linear.temperature.[.]",
        ),
        ("(level) * viscous", "character 9: behind [*] stands a factor, not viscous"),
        ("level + linear[gravity]", r"linear.gravity. without what it multiplies: write level [*]"),
        ("viscous * linear", r"linear does not say what it depends on: write linear.temperature."),
        (
            "viscous * linear[temprature]",
            "contact input at character 11.*Did you mean 'temperature'",
        ),
        ("weight[transmited]", "contact input at character 1 .*Did you mean 'transmitted'"),
        ("level + weight", r"weight does not say what it depends on"),
        ("level + weight[gravity, motor]", "brackets of weight hold one contact input"),
        (
            "level + weight_fading[gravity]",
            r"without stribeck, .*stribeck \+ weight_fading.gravity.",
        ),
        ("level + gear_stribeck", "gear_stribeck without stribeck"),
        ("dahl(weight[gravity])", r"without level, .*write level \+ weight.gravity."),
        (
            "dahl(level) * linear[gravity]",
            r"behind the memory dahl: .*dahl.level \* linear.gravity..",
        ),
        ("level * linear[gravity] * linear[gravity]", "level_gravity_slope twice"),
        ("level * linear[gravity, kinetic]", "parameter in linear.*Known: kinetic_coefficient"),
        ("level + stribeck * linear[gravity, fading_exponent]", "on an exponent"),
        (
            "tanh(level) + weight[gravity]",
            r"only some of level and weight.gravity. inside a smooth",
        ),
        ("level + weight[gravity] + weight[gravity]", r"weight.gravity. twice"),
        ("gear[motor]", "gear has no argument"),
        (
            "maxwell[2](both_ways[levels](level) + weight[motor])",
            r"weight.motor. and both_ways inside maxwell, whose force would jump where slip turns",
        ),
        (
            "reset(both_ways(level * ripple[position]))",
            "by different ratios: .* dahl, lugre or gms",
        ),
        ("level *", "expected the name of a part at character 8, got the end"),
        ("level + stribek", "part at character 9 of the friction law .*: .stribek."),
        ("level +", "expected the name of a part at character 8, got the end"),
        ("dahl(level", r"expected '\)' at character 11"),
        ("level ? viscous", r"expected '\+' or '\*' at character 7, got '\?'"),
        ("level + level", "has level twice"),
        ("lugre(level) + dahl(level)", "two memories, lugre and dahl"),
        ("dahl(level + viscous)", "viscous inside a memory, which holds levels only"),
        ("dahl(tanh(level))", "tanh inside a memory"),
        ("tanh(dahl(level))", "the memory dahl inside another term"),
        ("both_ways(both_ways(level))", "both_ways inside both_ways"),
        ("both_ways[x](level)", "brackets of both_ways"),
        ("level(viscous)", r"brackets behind level, which takes none: write level \+ viscous"),
        ("level[2]", "level has no argument"),
        ("dahl", r"dahl without brackets: write dahl\(level\)"),
        ("gms", r"gms without brackets: write gms\[4\]\(level\)"),
        ("maxwell[3]", r"maxwell without brackets: write maxwell\[3\]\(level\)"),
        ("stribeck + viscous", "stribeck without level"),
        ("level + peak", "peak without a static surplus"),
        ("level + stribeck + step", "stribeck and step, which both have static_coefficient"),
        ("viscous + power", "viscous and power, which both have viscous_coefficient"),
        ("dahl(level) + both_ways(viscous) + saturating", "viscous and saturating, which both"),
        ("brown_mcphee + level", r"has level besides brown_mcphee, .*brown_mcphee \+ viscous"),
        ("makkar(level)", r"has level besides makkar, .*takes no brackets: write makkar, or"),
        ("level + bengisu_akay", r"has level besides bengisu_akay, .*: write bengisu_akay, or"),
        ("makkar + simscape", "makkar and simscape, which both have kinetic_coefficient"),
        ("polynomial + level", r"up to which power polynomial goes: write polynomial\[2\]"),
        ("dahl(level) + both_ways(polynomial)", r"up to which power polynomial goes"),
        ("polynomial[0]", "polynomial.0.: the highest power must be a whole number from 1 to 99"),
        ("maxwell[2.5](level)", "maxwell.2.5.: the number of elements must be a whole number from"),
        ("elasto_plastic(level + power)", r"write elasto_plastic\(level\) \+ power"),
        ("gms[3](level + power)", r"write gms\[3\]\(level\) \+ power"),
        ("both_ways[level](level)", r"Did you mean both_ways\[levels\]"),
        ("dahl(brown_mcphee)", "brown_mcphee inside a memory, which holds levels only[.]$"),
        ("tanh(level + step)", "step inside tanh, which is 0 at rest"),
        ("tanh(level) + stribeck", "only some of level and stribeck inside a smooth sign"),
        ("maxwell[1\u0663](level)", "the number of elements must be a whole number from 1 to 99"),
        ("(" * 5000 + "level" + ")" * 5000, "at most 2000 characters and 20 brackets, got 10005"),
        ("x" * 10000, "at most 2000 characters and 20 brackets, got 10000 and 0"),
        ("tanh(level + viscous)", "other parts than levels inside tanh"),
        ("maxwell(level)", r"how many elements maxwell has: write maxwell\[4\]"),
        ("maxwell[0](level)", "the number of elements must be a whole number from 1 to 99"),
        ("", "expected the name of a part at character 1"),
    ],
)
def test_what_cannot_be_meant_is_refused_with_its_place_or_cure(text, said):
    with pytest.raises((InputError, UnknownNameError), match=said):
        law(text)


def test_a_composition_with_a_name_is_the_law_of_that_name_in_any_order():
    assert law("viscous + level") is laws()["coulomb-viscous"]
    assert law("power + lugre(stribeck + level)") is LuGre
    assert law_type("level + viscous") is laws()["coulomb-viscous"]
    assert specification("level + power").law is laws()["power-viscous"]


LIMITS_BY_SIDE = (
    "level + both_ways(saturating)",
    "level + both_ways[levels](saturating + drag)",
    "dahl(both_ways[levels](level + hyperbolic)) + both_ways(saturating + drag)",
    "maxwell[3](level) + both_ways(power)",
)


@pytest.mark.parametrize("text", [*FREE, *LIMITS_BY_SIDE])
def test_what_a_composition_contains_has_its_friction(text):
    kind = law(text)
    for one in kind.contained:
        simpler = started(laws()[one.law])
        simpler = bound(dataclasses.replace(simpler, **one.where), CONTACT)
        values = one.embed(simpler)
        assert values is not None
        rest = started(kind)
        # stands for infinity: bristles give way by less than a picometre
        values |= dict.fromkeys(one.limits, 1e12)
        names = {f.name: getattr(rest, f.name) for f in dataclasses.fields(kind)} | values
        for v in (-0.8, -1e-3, 1e-3, 0.3):
            expected = magnitude(simpler, v, 7.0)
            assert magnitude(bound(kind(**names), CONTACT), v, 7.0) == pytest.approx(
                expected, rel=1e-12
            ), one.law


def test_a_rig_file_names_a_law_by_its_composition_and_is_written_back(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(
        '[mechanism]\ntype = "axis"\ninertia = 2.0\n\n[friction.joint]\n'
        'law = "dahl(level + stribeck) + power"\nkinetic_coefficient = 2.0\n'
        'static_coefficient = 3.0\nstribeck_velocity = "10 mm/s"\nbristle_stiffness = 1e4\n'
        "viscous_coefficient = 3.0\nviscous_exponent = 0.6\n",
        encoding="utf-8",
    )
    rig = load_rig(path)
    (one,) = rig.laws.values()
    assert one.stribeck_velocity == 0.01
    assert type(one) is law("dahl(level + stribeck) + power")
    path.write_text(rig_toml(rig.mechanism, one), encoding="utf-8")
    assert load_rig(path).laws == rig.laws


def test_a_composition_of_a_rig_file_that_cannot_be_read_names_its_table(tmp_path):
    path = tmp_path / "rig.toml"
    text = '[mechanism]\ntype = "axis"\ninertia = 2.0\n[friction.joint]\nlaw = "level + stribek"\n'
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"friction\.joint.*Did you mean 'stribeck'"):
        load_rig(path)


ARM = """
[mechanism]
type = "two-link-arm"
upper_mass = 1.0
upper_length = 0.4
upper_centre = 0.2
upper_inertia = 0.06
lower_mass = 0.5
lower_centre = 0.2
lower_inertia = 0.03
"""


def test_a_composition_of_one_contact_is_never_taken_for_that_of_all(tmp_path):
    path = tmp_path / "arm.toml"
    own = 'law = "level + lorentz"\nkinetic_coefficient = 0.3\nstatic_coefficient = 0.4\n'
    own += "stribeck_velocity = 0.1\n"
    path.write_text(f"{ARM}[friction.shoulder]\n{own}", encoding="utf-8")
    with pytest.raises(InputError, match=r"shoulder is a contact.*\[friction\.shoulder\.own\]"):
        load_rig(path)
    path.write_text(f'{ARM}[friction]\nelbow = "none"\n[friction.shoulder.own]\n{own}', "utf-8")
    found = load_rig(path).law_by_contact()
    assert type(found["shoulder"]) is law("level + lorentz")
    assert found["elbow"] is None


@pytest.mark.parametrize("text", ["level + lorentz", "simscape"])
@pytest.mark.parametrize(
    ("line", "message"),
    [
        (
            "static_coefficient = 0.4",
            r"friction\.joint\.kinetic_coefficient \(mu_k\) is missing\."
            r" Add kinetic_coefficient under \[friction\.joint\] or \[friction",
        ),
        ("kinetic_coefficient = -1.0", r"friction\.joint\.kinetic_coefficient \(mu_k\) must be"),
        ("kinetic_coefficent = 1.0", r"unknown key in \[friction\.joint\]"),
    ],
)
def test_what_is_wrong_in_a_table_with_a_composition_is_told_with_the_name_of_that_table(
    tmp_path, text, line, message
):
    path = tmp_path / "rig.toml"
    rig = f'[mechanism]\ntype = "axis"\ninertia = 2.0\n[friction.joint]\nlaw = "{text}"\n{line}\n'
    path.write_text(rig, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        load_rig(path)
    path.write_text(f"{ARM}{rig.partition('2.0')[2].replace('joint', 'elbow.own')}", "utf-8")
    with pytest.raises(InputError, match=message.replace("joint", r"elbow\.own")):
        load_rig(path)


def test_an_override_that_contradicts_the_file_is_told_with_the_name_of_its_table(tmp_path):
    path = tmp_path / "rig.toml"
    values = "kinetic_coefficient = 1.0\nstatic_coefficient = 2.0\nstribeck_velocity = 0.1\n"
    head = '[mechanism]\ntype = "axis"\ninertia = 2.0\n[friction.joint]\nlaw = "level + lorentz"\n'
    path.write_text(head + values, encoding="utf-8")
    for key in ("friction.joint.static_coefficient", "friction.static_coefficient"):
        with pytest.raises(InputError, match=rf"{key} \(mu_s\) = 0.5 is below kinetic_coefficient"):
            load_rig(path, overrides={key: 0.5})
    wrong = r"\[friction\.joint\] of override of .*: 'static_coeficient'"
    with pytest.raises(InputError, match=wrong):
        load_rig(path, overrides={"friction.joint.static_coeficient": 0.5})


def test_a_part_without_the_name_of_a_law_is_a_composition_by_itself():
    assert specification("brown_mcphee").law is law("brown_mcphee")
    assert law_type("level") is laws()["coulomb"]
    assert law_type("dahl") is laws()["dahl"]


def test_an_exponent_that_must_be_given_is_fitted_and_one_with_a_default_is_kept():
    assert "viscous_exponent" in law("dahl(level + lorentz) + power").fit_order
    assert "yield_exponent" not in law("dahl(level + lorentz) + power").fit_order
    v = np.linspace(0.01, 1.0, 60)
    table = Measurement(velocity=v, friction=2.0 + 1.0 / (1.0 + (v / 0.1) ** 2) + 3.0 * v**0.6)
    found = fit(Axis(inertia=1.0), law("level + lorentz + power"), table)
    assert found.law.viscous_exponent == pytest.approx(0.6, rel=0.01)
    assert found.estimate("viscous_exponent").low < 0.6 < found.estimate("viscous_exponent").high


@pytest.mark.parametrize(
    "text",
    [
        "level + lorentz + drag",
        "both_ways(level + stribeck) + power",
        "tanh(level + hyperbolic) + saturating",
        "makkar + viscous",
        "bengisu_akay",
        "level + logarithmic",
        "level * exponential[temperature] + weight2[pressure]",
    ],
)
def test_a_law_without_memory_whose_parts_oppose_slip_is_passive_unasked(text):
    kind = law(text)
    assert kind.passivity.condition == "always"
    rng = np.random.default_rng(3)
    for _ in range(20):
        values = {}
        for name, one in fields_of(kind).items():
            low, high = one.bounds
            above = values.get(one.at_least, 0.0) if one.at_least else 0.0
            values[name] = above + rng.uniform(low, high)
        own = anywhere(kind(**values))
        for v in (-3.0, -0.1, -1e-5, 1e-5, 0.01, 0.2, 5.0):
            assert own.force(v, 2.0) * v >= 0.0


def test_of_parts_that_may_drive_and_of_memories_passivity_is_not_claimed():
    for text in ("level + polynomial[3]", "level * linear[temperature]", "gms[3](level) + viscous"):
        assert law(text).passivity is None


AT_LOAD = 40.0
"""Normal force [N] at which forces are measured."""


def as_force(kind):
    """Return a law in forces, with values of all its parameters that are felt."""
    one = started(kind)
    silent = {name: 0.4 for name, value in parameters_of(one).items() if value in (None, 0.0)}
    return bound(dataclasses.replace(one, **silent), CONTACT)


def parameters_of(one):
    """Return the values of a law by field."""
    return {name: getattr(one, name) for name in fields_of(type(one))}


def carried_to(one, load):
    """Return a law in forces as `carried` divides it by a load, bound to the same inputs."""
    plain = type(one)(**parameters_of(one))
    rig = Rig(mechanism=Axis(inertia=1.0), laws={one.name: plain}, path="law.toml")
    return bound(carried(rig, SpringBlock(mass=1.0), load=load).law, CONTACT)


@pytest.mark.parametrize("text", [*FREE, *laws()])
def test_a_law_in_forces_carries_the_same_friction_to_a_body_with_a_load(text):
    there = as_force(laws().get(text) or law(text))
    here = carried_to(there, AT_LOAD)
    z = tuple(0.0 for _ in there.states)
    time, own, carries = 1e-5, Latches(off=True), Latches(off=True)
    for v in [0.3] * 20 + [-0.2] * 20 + [0.001] * 5:  # presliding, yielding, and turns
        with own:
            force, rates = float(there.force(v, 1.0, z)), there.rates(v, 1.0, z)
        with carries:
            got, found = float(here.force(v, AT_LOAD, z)), here.rates(v, AT_LOAD, z)
        own.turn()
        carries.turn()
        # loads are multiplied and divided: equal to within rounding
        assert got == pytest.approx(force, rel=1e-9, abs=1e-12)
        assert found == pytest.approx(rates, rel=1e-9, abs=1e-12)
        assert here.steady(v, AT_LOAD) == pytest.approx(there.steady(v, 1.0), rel=1e-9)
        z = tuple(one + time * rate for one, rate in zip(z, rates, strict=True))


@pytest.mark.parametrize(
    ("text", "units"),
    [
        ("elasto-plastic", {"kinetic_coefficient": "N", "elastic_share": "1"}),
        ("cogging", {"level_position_harmonic": "1/m", "level_position_cosine": "1"}),
        ("makkar + viscous", {"rise_rate": "s/m", "bump_coefficient": "N"}),
        ("level + weight[temperature]", {"temperature_coefficient": "N/K"}),
        ("bam-m3", {"transmitted_coefficient": "1"}),
        ("gms", {"attraction": "N/s", "bristle_damping": "N s/m"}),
    ],
)
def test_only_what_is_over_the_normal_force_reads_as_a_force_where_none_is_known(text, units):
    kind = laws().get(text) or law(text)
    found = {name: unit_on(Axis(inertia=1.0), one) for name, one in fields_of(kind).items()}
    assert {name: found[name] for name in units if name in found} == {
        name: unit for name, unit in units.items() if name in found
    }
    in_table = {field: parameter.unit for field, parameter in force_parameters(kind).values()}
    assert all(in_table.get(name, unit) == unit for name, unit in units.items())


@pytest.mark.parametrize("name", laws())
def test_a_value_over_a_load_times_that_load_has_the_dimension_of_its_force_or_torque(name):
    for field, known in fields_of(laws()[name]).items():
        powers = Counter(_powers(known.unit_at(per_load=True, turning=True)))
        if known.force_unit != known.unit:
            powers["N"] += 1
        torque = _powers(known.unit_at(per_load=False, turning=True))
        sizes = {unit: n for unit, n in powers.items() if n and unit != "1"}
        assert sizes == {unit: n for unit, n in torque.items() if n and unit != "1"}, field


def test_a_share_of_a_torque_over_a_load_is_over_a_force_alone():
    axis, fields = Axis(inertia=1.0, rotary=True, load=20.0), fields_of(laws()["bam-m6"])
    units = {name: unit_on(axis, fields[name]) for name in ("motor_friction", "motor_quadratic")}
    assert units == {"motor_friction": "1/N", "motor_quadratic": "1/N^2/m"}


def test_sweeps_and_fits_give_a_level_over_a_load_at_a_rotary_contact_in_metres():
    axis, law = Axis(inertia=1.0, rotary=True, load=20.0), Coulomb(kinetic_coefficient=0.2)
    level = fields_of(Coulomb)["kinetic_coefficient"]
    assert unit_of(axis, law, "friction.kinetic_coefficient") == unit_on(axis, level) == "m"


def test_a_law_of_another_package_that_does_not_say_what_is_over_the_load_is_not_divided():
    rig = Rig(mechanism=Axis(inertia=1.0), laws={"silent": Silent(grip=5.0)}, path="law.toml")
    with pytest.raises(InputError, match=r"Declare per_load=True .* grip has no scale"):
        carried(rig, SpringBlock(mass=1.0), load=20.0)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Silent(SetValuedLaw):
    """A law whose level has no scale."""

    name: ClassVar[str] = "silent"
    title: ClassVar[str] = "Silent"
    formula: ClassVar[str] = "F = G N"
    sources: ClassVar[tuple[str, ...]] = ("reynolds1886",)
    grip: Annotated[float, Quantity("G", low=0)]

    def sliding(self, speed, load):
        return self.grip * load + 0.0 * speed

    def break_away(self, load):
        return self.grip * load
