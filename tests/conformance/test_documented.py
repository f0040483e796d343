"""What every registered law, mechanism and printed form says of itself."""

import ast
import dataclasses
import inspect
import pickle
import re

import pytest
from latex2mathml.converter import convert
from tests.support import SEVERAL, SHOWN, example_of, for_all

from stickslip.errors import ParameterError, UnknownNameError
from stickslip.friction import LAWS, PRINTED_FORMS, SOURCES, laws
from stickslip.mechanisms import MECHANISMS, mechanisms
from stickslip.quantities import fields_of

FIRST = (*LAWS.values(), *MECHANISMS.values())
ALL = (*FIRST, *PRINTED_FORMS.values())
KEBAB = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
UNITS = {
    "1",
    "m",
    "kg",
    "kg m^2",
    "N m s/rad",
    "N m/rad",
    "m/s",
    "m/s^2",
    "N",
    "N/m",
    "N s/m",
    "N s^2/m^2",
    "1/m",
    "N/(m s)",
    "N m/(rad s)",
    "1/N",
    "1/N^2",
    "1/K",
    "s/m",
    "1/s",
    "rad",
    "s",
    "Hz",
}


def written_docstrings(kind):
    """Return the names of a class body that are followed by a string."""
    (body,) = ast.parse(inspect.getsource(kind)).body
    pairs = zip(body.body, body.body[1:], strict=False)
    return {
        before.target.id
        for before, after in pairs
        if isinstance(before, ast.AnnAssign)
        and isinstance(after, ast.Expr)
        and isinstance(after.value, ast.Constant)
    }


@for_all(ALL)
def test_every_class_is_a_frozen_keyword_only_dataclass(kind):
    assert dataclasses.is_dataclass(kind)
    assert kind.__dataclass_params__.frozen
    assert all(field.kw_only for field in dataclasses.fields(kind))


@for_all(ALL)
def test_every_class_has_a_docstring_of_its_own(kind):
    assert (kind.__doc__ or "").strip()
    assert not kind.__doc__.startswith(f"{kind.__name__}(")  # what dataclasses write by themselves


@for_all(FIRST)
def test_every_field_of_a_class_is_explained(kind):
    own = inspect.get_annotations(kind)
    fields = {field.name for field in dataclasses.fields(kind)} & set(own)
    if getattr(kind, "composition", None) is None:
        assert fields <= written_docstrings(kind)
    else:  # the section of the docstring that comes from its parts
        section = re.findall(r"^(\w+) : float.*\n    \w", kind.__doc__ or "", re.MULTILINE)
        assert fields <= set(section)


@for_all(ALL)
def test_every_number_has_a_symbol_and_a_unit(kind):
    for name, quantity in fields_of(kind).items():
        assert quantity.symbol, name
        assert quantity.unit in UNITS, f"{name}: add {quantity.unit} to UNITS, if it is SI"


@for_all(ALL)
def test_symbols_tell_the_parameters_of_a_class_apart(kind):
    symbols = [quantity.symbol for quantity in fields_of(kind).values()]
    assert len(symbols) == len(set(symbols))


@for_all(ALL)
def test_names_are_kebab_case(kind):
    assert KEBAB.fullmatch(kind.name)


def test_registries_file_each_class_under_its_own_name():
    for registry in (LAWS, MECHANISMS, PRINTED_FORMS):
        assert all(name == kind.name for name, kind in registry.items())


def test_registries_with_installed_packages_hold_at_least_our_own():
    assert LAWS.items() <= laws().items()
    assert MECHANISMS.items() <= mechanisms().items()


@for_all([*LAWS.values(), *PRINTED_FORMS.values()])
def test_every_formula_renders_as_mathml(kind):
    rendered = convert(kind.formula)
    assert rendered.startswith("<math")
    assert "\\" not in re.sub(r"<[^>]*>", "", rendered)  # no command was left unrendered


@for_all(LAWS.values())
def test_every_law_names_sources_that_are_known(law):
    assert law.sources
    assert set(law.sources) <= set(SOURCES)


def test_citations_are_read_from_the_bibliography():
    assert SOURCES["olsson1998"] == (
        "H. Olsson, K. J. Åström, C. Canudas de Wit, M. Gäfvert, P. Lischinsky. Friction models and"
        " friction compensation. European Journal of Control 4(3), 1998."
    )
    assert SOURCES["dahl1968"].endswith("El Segundo, California, TOR-0158(3107-18)-1, 1968.")
    assert SOURCES["ambrosio2003"].endswith(". Virtual Nonlinear Multibody Systems, Kluwer, 2003.")
    assert SOURCES["paper"] == "Modelling of the pendulum-driven cart system with friction."
    for text in SOURCES.values():
        assert not re.search(r"[{}\\]|, ,|\. \.", text)


@for_all(LAWS.values())
def test_the_order_of_fitting_names_real_parameters_once(law):
    assert law.fit_order
    assert len(set(law.fit_order)) == len(law.fit_order)
    assert set(law.fit_order) <= set(fields_of(law))


@for_all(PRINTED_FORMS.values())
def test_every_printed_form_says_what_is_wrong_and_how_to_mend_it(form):
    assert form.defect
    assert form.cure
    assert re.fullmatch(r"\(\d+\)(, \(\d+\))*", form.equation)
    assert form.corrected in LAWS.values()


@for_all({**SHOWN, **SEVERAL}.values())
def test_a_mechanism_has_one_rate_and_one_unit_for_each_coordinate(mechanism):
    assert len(mechanism.coordinates) == len(mechanism.rates) == len(mechanism.units)
    names = (*mechanism.coordinates, *mechanism.rates)
    assert len(set(names)) == len(names)


SPECIMENS = [*map(example_of, LAWS.values()), *SHOWN.values()]


@for_all(SPECIMENS)
def test_objects_survive_pickling(specimen):
    assert pickle.loads(pickle.dumps(specimen)) == specimen


@for_all(SPECIMENS)
def test_objects_cannot_be_changed(specimen):
    name = next(iter(fields_of(type(specimen))))
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(specimen, name, 1.0)


@for_all(SPECIMENS)
def test_parameters_are_given_by_keyword(specimen):
    with pytest.raises(ParameterError, match="takes parameters by name"):
        type(specimen)(1.0)
    unknown = rf"unknown parameter of {type(specimen).__name__} 'no_such'"
    with pytest.raises(UnknownNameError, match=re.escape(unknown)):
        type(specimen)(no_such=1.0)


@for_all(SPECIMENS)
def test_a_copy_with_one_parameter_changed_is_checked_like_any_other(specimen):
    name = next(iter(fields_of(type(specimen))))
    doubled = dataclasses.replace(specimen, **{name: getattr(specimen, name) * 1.25})
    assert getattr(doubled, name) == getattr(specimen, name) * 1.25
    assert doubled != specimen
    with pytest.raises(ParameterError, match=f"{type(specimen).__name__}.{name}"):
        dataclasses.replace(specimen, **{name: float("nan")})


@for_all(SPECIMENS)
def test_equal_objects_have_equal_hashes(specimen):
    assert hash(dataclasses.replace(specimen)) == hash(specimen)
