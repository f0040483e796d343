"""Parameters that know themselves."""

import dataclasses
import math
import pickle
import weakref
from typing import Annotated

import numpy as np
import pytest

from stickslip import Axis, Coulomb, LuGre, Stribeck
from stickslip.errors import InputError, ParameterError, StickslipError, UnknownNameError, nearest
from stickslip.mechanisms.drives import Pulse, Sine
from stickslip.quantities import (
    MOST_KEPT,
    Parametrised,
    Quantity,
    fields_of,
    kept_by_identity,
    named,
    parameters,
    shadow,
    vary,
)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rod(Parametrised):
    length: Annotated[float, Quantity("l", "m", above=0)]
    tilt: Annotated[float, Quantity("phi", "rad", low=-1, high=1)] = 0.0
    order: Annotated[float, Quantity("n", above=0, structural=True)] = 2.0
    longest: Annotated[float, Quantity("l_x", "m", at_least="length")] | None = None
    label: str = ""


BAD = [math.nan, math.inf, -math.inf, None, "1", True, 1j, [1.0]]


@pytest.mark.parametrize("value", BAD, ids=repr)
def test_what_is_no_finite_number_is_refused(value):
    with pytest.raises(ParameterError) as caught:
        Rod(length=value)
    message = str(caught.value)
    for part in ("Rod.length", "(l)", "above 0 m", "got"):
        assert part in message
    assert (f"{value:g}" if isinstance(value, float) else repr(value)) in message


@pytest.mark.parametrize("value", [-0.01, 0.0, 0, -1e300])
def test_a_length_of_zero_or_less_is_refused_with_all_that_is_needed_to_mend_it(value):
    with pytest.raises(
        ParameterError, match=r"^Rod\.length \(l\) must be above 0 m, got "
    ) as error:
        Rod(length=value)
    assert str(error.value).endswith(f"got {float(value):g}.")


@pytest.mark.parametrize("value", [-1.5, 1.0000001])
def test_a_value_outside_two_bounds_is_refused_with_both(value):
    with pytest.raises(ParameterError, match="at least -1 and at most 1 rad"):
        Rod(length=1.0, tilt=value)


@pytest.mark.parametrize("value", [-1.0, 1.0])
def test_bounds_themselves_are_allowed(value):
    assert Rod(length=1.0, tilt=value).tilt == value


def test_a_value_below_the_field_it_must_not_fall_below_is_refused():
    with pytest.raises(
        ParameterError, match=r"Rod\.longest \(l_x\) must be at least length = 2, got 1\."
    ):
        Rod(length=2.0, longest=1.0)


def test_equal_values_satisfy_an_order():
    assert Rod(length=2.0, longest=2.0).longest == 2.0


@pytest.mark.parametrize("law", [Coulomb, Stribeck, LuGre])
def test_no_law_takes_a_static_level_below_the_kinetic_one(law):
    values = dict.fromkeys(fields_of(law), 1.0) | {"static_coefficient": 0.5}
    with pytest.raises(ParameterError, match=r"static_coefficient \(mu_s\) must be at least"):
        law(**values)


def test_none_is_allowed_only_where_the_field_says_so():
    assert Rod(length=1.0, longest=None).longest is None
    with pytest.raises(ParameterError, match=r"Rod\.tilt"):
        Rod(length=1.0, tilt=None)


@pytest.mark.parametrize("value", [2, np.float64(2.0), np.float32(2.0), np.int64(2)])
def test_numbers_of_any_kind_become_floats(value):
    assert type(Rod(length=value).length) is float
    assert Rod(length=value).length == 2.0


def test_errors_are_ours_and_the_built_in_one_would_expect():
    with pytest.raises(ValueError, match="Rod"):
        Rod(length=0)
    with pytest.raises(LookupError, match="x"):
        named({}, "x", "thing")
    assert issubclass(ParameterError, InputError)
    assert issubclass(InputError, StickslipError)


@pytest.mark.parametrize(
    ("quantity", "words"),
    [
        (Quantity("a"), "a finite number"),
        (Quantity("a", "N"), "a finite number in N"),
        (Quantity("a", low=0), "at least 0"),
        (Quantity("a", "Hz", above=0, high=10), "above 0 and at most 10 Hz"),
        (Quantity("a", at_least="b"), "at least b"),
        (Quantity("a", "m", low=0, at_least="b"), "at least 0 m and at least b"),
    ],
)
def test_a_range_reads_as_words(quantity, words):
    assert quantity.range == words


def test_only_what_stands_in_the_equations_is_a_parameter():
    assert {path: value for path, _, value in parameters(Rod(length=3.0), "rod")} == {
        "rod.length": 3.0,
        "rod.tilt": 0.0,
    }
    bent = Rod(length=3.0, order=1.5, longest=4.0)
    paths = [path for path, _, _ in parameters(bent, "rod")]
    assert paths == ["rod.length", "rod.tilt", "rod.order", "rod.longest"]


TWO = Pulse(level=1.0, duration=2.0) + Sine(amplitude=3.0, frequency=4.0)
AXIS = Axis(inertia=1.0, drive=TWO)


def test_paths_reach_into_drives_and_sums():
    values = {path: value for path, _, value in parameters(AXIS, "mechanism")}
    assert values["mechanism.inertia"] == 1.0
    assert values["mechanism.drive.parts.0.level"] == 1.0
    assert values["mechanism.drive.parts.1.frequency"] == 4.0


def test_every_path_can_be_varied_and_nothing_else_changes():
    for path, _, value in parameters(AXIS, "mechanism"):
        varied = vary(AXIS, "mechanism", {path: value + 0.5})
        before = {path: value for path, _, value in parameters(AXIS, "mechanism")}
        after = {path: value for path, _, value in parameters(varied, "mechanism")}
        assert after == before | {path: value + 0.5}


def test_several_paths_can_be_varied_at_once():
    varied = vary(
        AXIS,
        "mechanism",
        {
            "mechanism.drive.parts.0.level": 7.0,
            "mechanism.drive.parts.0.duration": 8.0,
            "mechanism.drive.parts.1.phase": 9.0,
            "mechanism.inertia": 10.0,
        },
    )
    pulse, sine = varied.drive.parts
    assert (pulse.level, pulse.duration, sine.phase, varied.inertia) == (7.0, 8.0, 9.0, 10.0)


def test_an_optional_parameter_can_be_taken_away():
    law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.3)
    assert vary(law, "friction", {"friction.static_coefficient": None}).static_coefficient is None


def test_varied_values_are_checked():
    with pytest.raises(ParameterError, match=r"Sine\.frequency"):
        vary(AXIS, "mechanism", {"mechanism.drive.parts.1.frequency": -1.0})


@pytest.mark.parametrize(
    "path",
    [
        "mechanism.inertai",
        "mechanism.drive",
        "mechanism.drive.parts.0.levle",
        "mechanism.drive.parts.7.level",
        "mechanism.drive.parts.first.level",
        "mechanism.drive.parts.0",
        "mechanism.inertia.deeper",
        "friction.inertia",
        "",
    ],
)
def test_an_unknown_path_is_an_error_of_ours(path):
    with pytest.raises(UnknownNameError, match="unknown parameter"):
        vary(AXIS, "mechanism", {path: 1.0})


def test_an_unknown_path_lists_the_nearest():
    with pytest.raises(UnknownNameError, match=r"Did you mean 'mechanism\.inertia'"):
        vary(AXIS, "mechanism", {"mechanism.inertai": 1.0})


def test_a_shadow_stands_in_for_every_parameter_and_keeps_the_rest():
    rod = Rod(length=3.0, order=2.0, label="top")
    twin = shadow(rod, "rod", lambda path: path.upper())
    assert (twin.length, twin.tilt) == ("ROD.LENGTH", "ROD.TILT")
    assert (twin.order, twin.longest, twin.label) == (2.0, None, "top")
    assert rod == Rod(length=3.0, order=2.0, label="top")


def test_a_shadow_reaches_into_drives_and_sums():
    twin = shadow(AXIS, "mechanism", str)
    assert twin.drive.parts[1].amplitude == "mechanism.drive.parts.1.amplitude"
    assert isinstance(twin.drive.parts[1], Sine)


def test_fields_are_read_only():
    with pytest.raises(TypeError):
        fields_of(Rod)["length"] = Quantity("x")


def test_looking_up_a_wrong_name_lists_the_nearest_known_ones():
    with pytest.raises(UnknownNameError, match=r"'coulmob'\. Did you mean 'coulomb'"):
        named({"coulomb": 1, "dahl": 2}, "coulmob", "law")


def test_looking_up_a_name_unlike_any_other_lists_all():
    with pytest.raises(UnknownNameError, match="Known: coulomb, dahl"):
        named({"dahl": 2, "coulomb": 1}, "zzzz", "law")
    assert nearest("zzzz", ["coulomb"]) == ""


def test_looking_up_a_known_name_gives_what_it_names():
    assert named({"coulomb": 1}, "coulomb", "law") == 1


@pytest.fixture
def counted():
    """Return a function that is worked out once for the same objects, and the objects it had."""
    had = []
    return kept_by_identity(lambda one, other: had.append((one, other)) or len(had)), had


def test_what_follows_from_the_same_objects_is_worked_out_once(counted):
    number, _ = counted
    rod, law = Rod(length=1.0), Coulomb(kinetic_coefficient=0.2)
    assert [number(rod, law), number(law, rod), number(rod, law)] == [1, 2, 1]


def test_equal_objects_are_not_the_same(counted):
    number, _ = counted
    rods = [Rod(length=1.0), Rod(length=1.0)]
    assert [number(rod, rod) for rod in (*rods, *rods)] == [1, 2, 1, 2]


def test_an_object_in_the_place_of_one_that_is_gone_is_another(counted):
    number, had = counted
    places = set()
    for i in range(50):
        rod = Rod(length=1.0 + i)
        places.add(id(rod))
        assert number(rod, rod) == i + 1
        had[-1] = None
    assert len(places) < 50  # or nothing was shown


def test_few_objects_are_kept_and_none_alive(counted):
    number, had = counted
    rods = [Rod(length=1.0 + i) for i in range(MOST_KEPT + 1)]
    for rod in rods:
        number(rod, rod)
    assert number(rods[-1], rods[-1]) == MOST_KEPT + 1
    assert number(rods[0], rods[0]) == MOST_KEPT + 2
    last = weakref.ref(rods[-1])
    del rod
    rods.clear()
    had.clear()
    assert last() is None


@dataclasses.dataclass(frozen=True, kw_only=True)
class Bag(Parametrised):
    content: list[float]


def test_what_can_be_changed_in_place_is_looked_at_each_time():
    total = kept_by_identity(lambda one, other: sum(one.content))
    bag = Bag(content=[1.0])
    assert total(bag, bag) == 1.0
    bag.content.append(2.0)
    assert total(bag, bag) == 3.0
    assert total(bag, Rod(length=1.0)) == 3.0


def test_what_has_no_parameters_is_looked_at_each_time(counted):
    number, _ = counted
    rod, name = Rod(length=1.0), "coulomb"
    assert [number(rod, name), number(rod, name)] == [1, 2]


def test_errors_survive_pickling():
    with pytest.raises(UnknownNameError) as caught:
        named({"coulomb": 1}, "coulmob", "law")
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
