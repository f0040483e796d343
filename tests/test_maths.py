"""One set of functions for floats, arrays and symbols."""

import math

import numpy as np
import pytest
import symengine as se
from hypothesis import given
from hypothesis import strategies as st

from stickslip import maths
from stickslip.engine.formulation.trace import Switchboard, Traced
from stickslip.errors import InputError, TracingError

ONE_ARGUMENT = {
    "exp": math.exp,
    "log": math.log,
    "sqrt": math.sqrt,
    "sin": math.sin,
    "cos": math.cos,
    "tanh": math.tanh,
    "arctan": math.atan,
}
each_function = pytest.mark.parametrize(("name", "reference"), ONE_ARGUMENT.items())


def traced(name, board=None):
    return Traced(se.Symbol(name), Switchboard() if board is None else board)


@each_function
@pytest.mark.parametrize("x", [0.3, 1.0, 2.5, 3])
def test_a_float_gives_the_float_of_math(name, reference, x):
    result = getattr(maths, name)(x)
    assert type(result) is float
    assert result == reference(x)


@each_function
def test_an_array_gives_an_array(name, reference):
    x = np.array([[0.3, 1.0], [2.5, 3.0]])
    result = getattr(maths, name)(x)
    assert result.shape == x.shape
    expected = [[reference(value) for value in row] for row in x.tolist()]
    np.testing.assert_allclose(result, expected, rtol=1e-15)  # the last digit may differ


@each_function
def test_a_symbol_gives_an_expression_with_the_same_value(name, reference):
    result = getattr(maths, name)(traced("x"))
    assert isinstance(result, Traced)
    value = float(result.expr.subs({se.Symbol("x"): 0.7}))
    assert math.isclose(value, reference(0.7), rel_tol=1e-15)


@given(x=st.floats(allow_nan=False))
def test_the_sign_is_one_or_zero_with_the_sign_of_its_argument(x):
    assert maths.sign(x) == (x > 0) - (x < 0)
    assert type(maths.sign(x)) is float


@pytest.mark.parametrize("exponent", [0.5, 1.5, 2.25])
@pytest.mark.parametrize("base", [0.0, -1e-12, -3.0])
def test_fractional_powers_of_what_is_not_positive_are_zero(base, exponent):
    assert maths.power(base, exponent) == 0.0
    np.testing.assert_array_equal(maths.power(np.array([base, base]), exponent), [0.0, 0.0])


@pytest.mark.parametrize("exponent", [1, 2.0, 3])
@pytest.mark.parametrize("base", [0.0, -1.5, 2.0])
def test_whole_powers_are_powers_for_every_sign(base, exponent):
    assert maths.power(base, exponent) == base ** int(exponent)
    np.testing.assert_array_equal(maths.power(np.array([base]), exponent), [base ** int(exponent)])


def test_the_slope_of_a_fractional_power_is_zero_where_the_base_is_not_positive():
    x = se.Symbol("x")
    slope = maths.power(traced("x"), 1.5).expr.diff(x)
    assert float(slope.subs({x: -0.2})) == 0.0
    assert float(slope.subs({x: 0.0})) == 0.0
    assert math.isclose(float(slope.subs({x: 4.0})), 3.0, rel_tol=1e-15)


def test_a_power_may_have_a_symbol_as_exponent():
    n = se.Symbol("n")
    result = maths.power(3.0, traced("n")).expr
    assert math.isclose(float(result.subs({n: 0.5})), math.sqrt(3.0), rel_tol=1e-15)


@pytest.mark.parametrize("condition", [True, np.True_])
def test_where_chooses_for_numbers(condition):
    assert maths.where(condition, 1.0, 2.0) == 1.0
    assert maths.where(not condition, 1.0, 2.0) == 2.0


@pytest.mark.parametrize("value", [1.0, 0, np.float64(2.0), np.array([-1.0, 2.0])])
def test_where_asks_for_a_comparison_of_numbers(value):
    with pytest.raises(InputError, match=r"where\(x > 0\.0, yes, no\) instead of where\(x, yes"):
        maths.where(value, 1.0, 2.0)


def test_where_asks_for_a_comparison_of_symbols():
    with pytest.raises(TracingError, match=r"chooses by a comparison, and got a value"):
        maths.where(traced("v", Switchboard()), 1.0, 2.0)


def test_where_on_symbols_becomes_a_switch():
    board = Switchboard()
    v = traced("v", board)
    maths.where(v > 1.0, v, 0.0, ("in", "out"))
    (switch,) = board.switches.values()
    assert switch.events == ("in", "out")
    assert switch.margin == se.Symbol("v") - 1


def test_the_same_condition_met_twice_is_one_switch():
    board = Switchboard()
    v = traced("v", board)
    maths.where(v > 1.0, v, 0.0)
    maths.where(v > 1.0, 2.0, v)
    assert len(board.switches) == 1


def test_a_sign_that_the_mode_fixes_makes_no_switch():
    board = Switchboard(signs={"v": -1})
    v = traced("v", board)
    assert abs(v).expr == -se.Symbol("v")
    assert maths.sign(-v).expr == 1
    assert maths.where(v > 0, 1.0, 2.0).expr == 2
    assert not board.switches


@pytest.mark.parametrize(
    "mistake",
    [
        pytest.param(lambda v: 1.0 if v > 0 else 2.0, id="if"),
        pytest.param(lambda v: v > 0 and v < 1, id="and"),
        pytest.param(lambda v: not v, id="not"),
        pytest.param(lambda v: max(v, 0.0), id="max"),
        pytest.param(bool, id="bool"),
        pytest.param(lambda v: v == 0, id="equal"),
        pytest.param(lambda v: v != 0, id="not equal"),
        pytest.param(lambda v: v in (1.0, 2.0), id="in"),
    ],
)
def test_choosing_by_a_symbol_without_where_names_where(mistake):
    with pytest.raises(TracingError, match="where"):
        mistake(traced("v"))


@pytest.mark.parametrize(
    "mistake",
    [
        pytest.param(lambda v: v**0.5, id="fractional"),
        pytest.param(lambda v: v**v, id="traced"),
        pytest.param(lambda v: 2.0**v, id="number to a traced"),
    ],
)
def test_powers_that_need_care_are_refused_and_name_power(mistake):
    with pytest.raises(TracingError, match=r"maths\.power"):
        mistake(traced("v"))


@pytest.mark.parametrize(
    "mistake",
    [
        pytest.param(math.exp, id="exp"),
        pytest.param(math.sqrt, id="sqrt"),
        pytest.param(float, id="float"),
        pytest.param(lambda v: math.copysign(1.0, v), id="copysign"),
    ],
)
def test_functions_of_math_are_refused_and_those_of_maths_named(mistake):
    with pytest.raises(TracingError, match=r"stickslip\.maths"):
        mistake(traced("v"))


@pytest.mark.parametrize("thing", ["a", None, True, [1.0]], ids=repr)
def test_an_equation_takes_nothing_but_numbers_and_symbols(thing):
    with pytest.raises(TracingError, match="neither a number nor a symbol"):
        traced("v") + thing


def test_arithmetic_on_symbols_is_arithmetic():
    x, y = traced("x"), traced("y")
    result = (-x + 2.0) * (3 - y) / (x - 1.0) + 1.0 / (+y) - y**3
    value = float(result.expr.subs({se.Symbol("x"): 3.0, se.Symbol("y"): 2.0}))
    assert value == (-3.0 + 2.0) * (3 - 2.0) / (3.0 - 1.0) + 0.5 - 8.0
