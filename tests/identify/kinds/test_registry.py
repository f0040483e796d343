"""Which measurement gets which route, and what each route refuses."""

import re

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    Dahl,
    Measurement,
    RecordSettings,
    SpringBlock,
    TowedBlock,
    fit,
    select,
)
from stickslip.errors import InputError, StickslipError, UnknownNameError
from stickslip.friction import RateState
from stickslip.identify.kinds import registry
from stickslip.identify.kinds.kind import Kind, Request
from stickslip.identify.kinds.records import FrictionTableKind
from stickslip.identify.kinds.registry import kind_of, kind_of_route, kinds, refuse_unused

T = np.linspace(0.0, 1.0, 50)
RISE, WAVE = 1e-6 * T, np.sin(6.0 * T)
TOWED = TowedBlock(mass=1e-3, stiffness=2e3, speed=1e-6, load=1.0)
AXIS = Axis(inertia=1.0)
KINDS = {
    "one travel": (
        SpringBlock(mass=1.0, stiffness=100.0, compression=0.1),
        {"travel": 0.2, "uncertainty": 0.005},
        "travel",
    ),
    "spring force": (TOWED, {"time": T, "spring_force": WAVE}, "features"),
    "velocity steps": (TOWED, {"time": T, "pull": RISE, "friction": 0.6 + WAVE}, "rate-state"),
    "motion and force": (AXIS, {"time": T, "position": WAVE, "force": WAVE}, "balance"),
    "friction over velocity": (AXIS, {"velocity": WAVE, "friction": WAVE}, "table"),
    "friction of a measured motion": (
        TOWED,
        {"time": T, "pull": RISE, "velocity": WAVE, "friction": WAVE},
        "balance",
    ),
}
"""Mechanism, values and the first name of the route."""
USED = {
    "travel": {"assumed", "t_end"},
    "features": {"route", "settings", "validate"},
    "rate-state": {"route", "settings", "validate"},
    "balance": {"route", "settings", "validate"},
    "table": {"route", "validate"},
}
GIVEN = {
    "route": "balance",
    "settings": RecordSettings(starts=2),
    "validate": Measurement(time=T, position=WAVE, force=WAVE),
    "assumed": {"coulomb": ["friction.kinetic_coefficient"]},
    "t_end": 5.0,
}
OF_FIT = ("route", "settings", "t_end")


def measured(kind):
    mechanism, values, _ = KINDS[kind]
    return mechanism, Measurement(**values)


@pytest.mark.parametrize("kind", KINDS)
def test_a_measurement_gets_the_route_of_its_kind(kind):
    _, record = measured(kind)
    assert kind_of(record).routes[0] == KINDS[kind][-1]


@pytest.mark.parametrize("kind", KINDS)
def test_the_last_route_leaves_nothing_without_one(kind):
    _, record = measured(kind)
    own = [one for one in kinds() if one.serves(record)]
    assert own  # the first is taken, and the more special ones are asked first
    assert own[0] is kind_of(record)


@pytest.mark.parametrize("asked", ["table", "features", "rate-state"])
def test_a_record_gets_the_route_that_is_asked_for(asked):
    for kind in KINDS:
        _, record = measured(kind)
        if kind == "one travel":  # which then refuses the option
            assert kind_of(record, asked).routes == ("travel",)
        else:
            assert asked in kind_of(record, asked).routes


def test_names_of_routes_are_known_and_apart():
    # friction tables are a special case of records, and share one of their routes
    apart = [kind for kind in kinds() if Kind in type(kind).__bases__]
    names = [name for kind in apart for name in kind.routes]
    assert len(set(names)) == len(names)
    assert all(name in kind_of_route(name).routes for name in names)
    with pytest.raises(UnknownNameError, match=r"'rate-stat'.*'rate-state'"):
        kind_of(measured("velocity steps")[1], "rate-stat")


def test_a_route_of_another_package_needs_names_of_its_own(monkeypatch):
    class Other(type(kind_of_route("travel"))):
        routes = ("features",)

    monkeypatch.setattr(registry, "plugins", lambda *_: [("other:Other", Other)])
    with pytest.raises(StickslipError, match=r"other:Other is named .*, which is taken: rename it"):
        kinds.__wrapped__()
    Other.routes = ("other",)
    first, second, *_ = kinds.__wrapped__()
    assert (first.routes, second) == (("other",), registry.OWN[0])


@pytest.mark.parametrize("name", GIVEN)
@pytest.mark.parametrize("kind", KINDS)
def test_an_option_is_used_or_refused_in_one_sentence_by_both_verbs(kind, name):
    mechanism, record = measured(kind)
    route = KINDS[kind][-1]
    if route in ("table", "balance") and name in ("route", "settings"):
        return  # the next test
    if name in USED[route]:
        refuse_unused(
            kind_of_route(route),
            {name: name},
            Request(mechanism=mechanism, measurement=record, **{name: GIVEN[name]}),
        )
        return
    verbs = [(select, None)] + ([(fit, "coulomb")] if name in OF_FIT else [])
    for verb, law in verbs:
        with pytest.raises(InputError) as refused:
            verb(mechanism, law, record, **{name: GIVEN[name]})
        said = str(refused.value)
        assert said.startswith(f"{name} ")
        assert said.count(". ") == 0
        if (route, name) == ("travel", "validate"):
            assert "give more trials instead" in said
            continue
        assert f"it has no effect on {kind_of_route(route).measured}: leave it out." in said
        for other, used in USED.items():
            assert (kind_of_route(other).measured in said.partition(";")[0]) is (name in used)


TABLE = Measurement(velocity=WAVE, friction=WAVE)
MOTION = Measurement(time=T, position=WAVE, force=WAVE)


@pytest.mark.parametrize(
    ("verb", "measurement", "options", "said"),
    [
        (select, MOTION, {"route": "table"}, "route 'table' applies to tables of friction, not to"),
        (fit, MOTION, {"route": "table"}, "route 'table' applies to tables of friction, not to"),
        (
            select,
            TABLE,
            {"settings": RecordSettings(starts=2)},
            "settings applies to the force of",
        ),
        (select, TABLE, {"vary": ["inertia"]}, r"vary applies to `fit`.*, got inertia"),
        (select, TABLE, {"fixed": {"offset": 0.0}}, r"fixed applies to `fit`.*, got offset"),
        (
            select,
            MOTION,
            {"settings": RecordSettings(starts=2)},
            "RecordSettings.starts applies to velocity steps",
        ),
    ],
)
def test_of_tables_and_records_each_verb_refuses_what_the_other_uses(
    verb, measurement, options, said
):
    with pytest.raises(InputError, match=rf"^{said}.*: leave it out\.$") as refused:
        verb(AXIS, "coulomb", measurement, **options)
    assert str(refused.value).count(". ") == 0


@pytest.mark.parametrize(
    ("verb", "options"),
    [
        (select, {"route": "table"}),
        (fit, {"route": "table"}),
        (fit, {"fixed": {"offset": 0.0}}),
    ],
)
def test_of_tables_each_verb_takes_its_own(verb, options, monkeypatch):
    seen = []
    monkeypatch.setattr(
        FrictionTableKind, verb.__name__, lambda self, request: seen.append(request)
    )
    verb(AXIS, "coulomb", TABLE, **options)
    assert len(seen) == 1


SETTINGS = {"hold": "first", "starts": 2, "seed": 3}
WITHOUT = {
    ("velocity steps", None): ({"hold"}, "velocity steps"),
    ("spring force", None): ({"hold", "starts"}, "the force of a spring"),
    ("motion and force", "balance"): ({"starts", "seed"}, "records of motion or friction"),
    ("friction over velocity", None): ({*SETTINGS}, "tables of friction"),
}


@pytest.mark.parametrize("name", SETTINGS)
@pytest.mark.parametrize(("kind", "asked"), WITHOUT)
def test_a_setting_without_effect_is_refused_by_both_verbs(kind, asked, name, monkeypatch):
    mechanism, record = measured(kind)
    settings = RecordSettings(**{name: SETTINGS[name]})
    unused, where = WITHOUT[kind, asked]
    law = "logarithmic" if kind == "velocity steps" else "coulomb"
    way, seen = type(kind_of(record, asked)), []
    for method in ("fit", "select"):
        monkeypatch.setattr(way, method, lambda self, request: seen.append(request))
    # of tables, select uses no settings at all
    for verb in (fit,) if kind == "friction over velocity" else (fit, select):
        if name not in unused:
            verb(mechanism, law, record, route=asked, settings=settings)
            assert getattr(seen[-1].settings, name) == SETTINGS[name]
            continue
        with pytest.raises(
            InputError, match=f"^(RecordSettings.{name}|settings) applies to"
        ) as refused:
            verb(mechanism, law, record, route=asked, settings=settings)
        assert where in str(refused.value)
        assert str(refused.value).endswith("leave it out.")
        assert seen == []


def test_a_route_with_a_misspelt_option_is_refused_where_it_is_defined():
    with pytest.raises(TypeError, match=r"Other.uses has 'jobs', which is no option of Request"):

        class Other(Kind):
            uses = frozenset({"jobs"})

    with pytest.raises(TypeError, match=r"Next.settings has 'start', which is no .*: .*hold"):

        class Next(Kind):
            uses, settings = frozenset(), frozenset({"start"})


def test_the_least_residual_has_words_on_every_route():
    table = Measurement(velocity=[0.1, 0.2], friction=[2.0, 2.0])
    asked = Request(mechanism=Axis(inertia=1.0), measurement=table)
    words = {kind.routes[0]: kind.residual_text(0.012, asked) for kind in kinds()}
    assert all("12" in word or "1.2" in word for word in words.values())
    assert (
        words.items()
        >= {
            "features": "residual of the features 0.012",
            "travel": "residual 0.012",
            "rate-state": "coefficient off by 0.012",
            "joints": "residual 0.012",
        }.items()
    )


def test_options_that_say_nothing_are_not_refused():
    asked = {"mechanism": Axis(inertia=1.0), "measurement": Measurement(travel=0.2)}
    assert Request(**asked, vary="friction.*").given == ()
    both = Request(**asked, route="travel", t_end=2.0)
    assert both.given == ("route", "t_end")
    assert both.only({"t_end"}) == Request(**asked, t_end=2.0)


@pytest.mark.parametrize(
    ("name", "free"),
    [
        ("dahl", ["kinetic_coefficient", "bristle_stiffness", "viscous_coefficient"]),
        (
            "dahl-exponent",
            ["kinetic_coefficient", "bristle_stiffness", "viscous_coefficient", "yield_exponent"],
        ),
        ("coulomb", None),
    ],
)
@pytest.mark.parametrize("route", ["balance", "features"])
def test_a_name_stands_for_a_law_and_what_is_fitted_of_it(route, name, free):
    way, stiffness = kind_of_route(route), "mechanism.stiffness"
    kind = Coulomb if name == "coulomb" else Dahl
    own = ["friction.*"] if free is None else [f"friction.{one}" for one in free]
    assert way.law_and_parameters(name, None) == (kind, None if free is None else own)
    law, vary = way.law_and_parameters(name, ["friction.*", stiffness])
    assert (law, list(vary)) == (kind, [*own, stiffness])
    # what is named by itself is fitted alone, whatever the name stands for
    assert way.law_and_parameters(name, ["yield_exponent"]) == (kind, ["yield_exponent"])


def test_what_is_held_is_not_varied_by_the_name():
    vary = kind_of_route("balance").law_and_parameters(
        "dahl", None, ["bristle_stiffness", "friction.viscous_coefficient"]
    )[1]
    assert vary == ["friction.kinetic_coefficient"]


def test_a_law_that_is_given_itself_keeps_what_is_asked_for():
    law = Dahl(kinetic_coefficient=1.0, bristle_stiffness=1e3, viscous_coefficient=0.0)
    for given in (Dahl, law):
        found, vary = kind_of_route("balance").law_and_parameters(given, ["yield_exponent"])
        assert found is given
        assert vary == ["yield_exponent"]


def test_of_travels_a_name_is_the_law_alone_and_of_steps_the_name_stays():
    assert kind_of_route("travel").law_and_parameters("dahl", None) == (Dahl, None)
    with pytest.raises(InputError, match=r"only for fits to records.*Give dahl"):
        kind_of_route("travel").law_and_parameters("dahl-exponent", None)
    way = kind_of_route("rate-state")
    assert way.law_and_parameters("logarithmic", ["friction.*"]) == ("logarithmic", ["friction.*"])
    assert way.owner("logarithmic") is RateState


STATE = RateState(
    reference_coefficient=0.6,
    direct_effect=0.01,
    evolution_effect=0.0,
    reference_velocity=1e-6,
    evolution="none",
)


@pytest.mark.parametrize("law", [RateState, STATE, int, 3.0])
@pytest.mark.parametrize("kind", KINDS)
def test_a_law_of_another_kind_is_refused_before_any_work(kind, law):
    mechanism, record = measured(kind)
    if KINDS[kind][-1] == "rate-state" and law in (RateState, STATE):
        law = Coulomb
    what = re.escape(kind_of(record).measured)
    for verb, given in ((fit, law), (select, law), (select, [law]), (select, {"mine": law})):
        with pytest.raises(InputError, match=rf"A fit to {what} takes a \w+, its type or its name"):
            verb(mechanism, given, record)
    with pytest.raises(InputError, match=what) as refused:
        fit(mechanism, law, record)
    assert ("which is for" in str(refused.value)) is (law not in (int, 3.0))


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "velocity steps"])
def test_names_of_laws_for_velocity_steps_say_what_these_are(kind):
    mechanism, record = measured(kind)
    with pytest.raises(InputError, match="rate-and-state is a law for velocity steps"):
        fit(mechanism, "rate-and-state", record)


def test_the_route_of_other_measurements_is_refused_by_what_it_is_for() -> None:
    table = Measurement(velocity=[0.1, 0.2], friction=[2.0, 2.0])
    with pytest.raises(InputError, match=r"^route 'travel' applies to travels, not to this"):
        kind_of(table, "travel")
