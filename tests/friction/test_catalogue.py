"""The catalogue of named laws: entries that read as such, and classes made when asked for."""

import doctest
import inspect
import pickle

import pytest

import stickslip
from stickslip.friction import LAWS, FrictionLaw, law, listed, said_of
from stickslip.friction.notation import canonical, without_optional

each_law = pytest.mark.parametrize("name", LAWS)


def within(kind):
    """Return the parts that a law has whatever its values."""
    return canonical(without_optional(kind.composition))


@each_law
def test_a_named_law_is_found_by_its_composition_and_survives_pickle(name):
    kind = LAWS[name]
    assert kind.name == name
    assert getattr(stickslip, kind.__name__) is kind
    assert pickle.loads(pickle.dumps(kind)) is kind
    found = law(str(kind.composition))
    # of laws with the same parts, the one in whose entry a level may be left out has the text
    assert found is kind or within(found) == within(kind)


@each_law
def test_examples_in_the_docstring_of_a_law_give_what_they_say(name):
    kind = LAWS[name]
    tests = doctest.DocTestParser().get_doctest(inspect.getdoc(kind), {}, name, None, 0)
    assert doctest.DocTestRunner().run(tests).failed == 0


def test_entries_say_what_their_classes_say():
    for name, one in listed().items():
        kind = LAWS[name]
        assert issubclass(kind, FrictionLaw)
        for key in ("title", "sources", "on_request", "states"):
            assert getattr(one, key) == getattr(kind, key)
        assert str(one.composition) == str(kind.composition)


def test_travels_are_compared_with_six_laws_unasked():
    unasked = [name for name, one in listed().items() if not one.on_request]
    assert unasked == ["coulomb", "viscous", "coulomb-viscous", "stribeck", "dahl", "lugre"]


def test_a_composition_of_a_part_that_was_not_compared_with_its_source_says_so():
    for text in ("makkar + viscous", "bengisu_akay", "dahl(level + lorentz) + power"):
        kind = law(text)
        assert not kind.compared
        assert ("Note", "formula not compared with its source") in said_of(kind)
    for name in ("haessig-friedland", "bliman-sorine", "hess-soom", "warm-viscous"):
        assert not listed()[name].compared
        assert not LAWS[name].compared
        assert "not compared with its source" in LAWS[name].__doc__
    assert law("level + stribeck + viscous").compared
