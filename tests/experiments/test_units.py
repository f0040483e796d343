"""Numbers with units."""

import contextlib
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stickslip.errors import ParameterError
from stickslip.experiments.units import check_uncertainty, read_number
from stickslip.quantities import Quantity
from stickslip.units import factor


@pytest.mark.parametrize(
    ("text", "unit", "number"),
    [
        ("35 mm", "m", 0.035),
        ("60mm", "m", 0.06),
        (" 0.2 m ", "m", 0.2),
        ("-5 mm", "m", -0.005),
        ("1e4 1/m", "1/m", 1e4),
        ("100 N/m", "N/m", 100.0),
        ("0.5 N s/m", "N s/m", 0.5),
        ("0.5 N*s/m", "N s/m", 0.5),
        ("0.5 N·s/m", "N s/m", 0.5),
        ("9.81 m/s^2", "m/s^2", 9.81),
        ("9.81 m/s²", "m/s^2", 9.81),
        ("240 ms", "s", 0.24),
        ("25 %", "1", 0.25),
        ("0.25", "1", 0.25),
        ("2 kHz", "Hz", 2000.0),
        ("1 in", "m", 0.0254),
        ("500 g", "kg", 0.5),
    ],
)
def test_a_text_with_a_unit_is_the_float_one_would_write_in_si(text, unit, number):
    assert read_number(text, Quantity("q", unit)) == number


def test_degrees_become_radians():
    # Decimal digits of pi in the unit library, one rounding.
    assert read_number("180 deg", Quantity("phi", "rad")) == pytest.approx(math.pi, rel=1e-15)


@pytest.mark.parametrize(
    ("value", "unit", "message"),
    [
        ("1 kgg", "kg", "unknown unit 'kgg', got '1 kgg'; write for example \"1 kg\""),
        ("60 mm", "kg", "must be in kg or a unit of that kind, not in mm"),
        ("30 deg", "1", "must be a pure number or in %, not in deg"),
        ("60 rpm", "Hz", "not in rpm"),
        ("20 degC", "m", "an offset zero"),
        ("5", "m", "has no unit, got '5': write \"5 m\""),
        ("heavy", "kg", 'such as "1 kg"'),
        ("", "kg", "got ''"),
        ("nan m", "m", "got 'nan m'"),
        ("1e999 m", "m", "got '1e999 m'"),
        ("1,5 mm", "m", "unreadable unit"),
        ("9**9**9**9 m", "m", "unreadable unit"),
        ("1 m^9^9^9", "m", "unreadable unit"),
        ("1 __import__", "m", "unreadable unit"),
        ("1" * 101, "m", "must be a number"),
        (True, "m", "got true"),
        (None, "m", "got None"),
        ([1.0], "m", r"got \[1.0\]"),
        (math.nan, "m", "must be a finite number in m, got nan"),
        (10**400, "m", "must be a finite number in m"),
    ],
)
def test_what_is_no_number_is_refused_with_the_symbol_and_a_cure(value, unit, message):
    with pytest.raises(ParameterError, match=message) as caught:
        read_number(value, Quantity("q", unit))
    assert str(caught.value).startswith("(q) ")
    assert caught.value.__suppress_context__ or caught.value.__context__ is None


def test_ranges_are_checked_after_conversion_and_the_text_is_shown():
    with pytest.raises(ParameterError, match=r"\(m\) must be above 0 g, got '-1 g'"):
        read_number("-1 g", Quantity("m", "kg", above=0))


def test_units_without_a_target_are_converted_to_si():
    assert factor("mm", None) == 0.001
    assert factor("N/mm", None) == 1000.0


@given(st.text(max_size=30))
def test_any_text_is_a_number_or_a_parameter_error(text):
    with contextlib.suppress(ParameterError):
        assert math.isfinite(read_number(text, Quantity("q", "1")))


@pytest.mark.parametrize(
    ("text", "quantity", "said"),
    [
        (
            "90 deg",
            Quantity("beta", "rad", low=-1.57, high=1.57),
            "at least -89.9544 and at most 89.9544 deg, got '90 deg'",
        ),
        ("-3 g", Quantity("m", "kg", above=0), "above 0 g, got '-3 g'"),
        ("700 mm", Quantity("x", "m", high=0.5), "at most 500 mm, got '700 mm'"),
        ("120 %", Quantity("e", high=1.0), "at most 100 %, got '120 %'"),
        ("2", Quantity("e", high=1.0), "at most 1, got '2'"),
    ],
)
def test_a_range_is_told_in_the_unit_that_was_written(text, quantity, said):
    with pytest.raises(ParameterError) as error:
        read_number(text, quantity)
    assert said in str(error.value)


STIFFNESS = Quantity("k", "N/m", low=0)


@pytest.mark.parametrize(
    ("uncertainty", "given", "said"),
    [
        (
            200.0,
            "200 %",
            "(u_k) must be above 0 N/m and below 50 N/m, half of the value, got '200 %'",
        ),
        (50.0, None, "below 50 N/m, half of the value, got 50 N/m"),
        (0.0, "0 N/m", "got '0 N/m': leave it out of a value that is exact"),
        (math.nan, None, "got nan N/m"),
    ],
)
def test_an_uncertainty_says_its_range_its_unit_and_a_cure(uncertainty, given, said):
    with pytest.raises(ParameterError) as error:
        check_uncertainty(uncertainty, 100.0, STIFFNESS, given)
    assert said in str(error.value)


def test_what_may_be_negative_may_be_less_than_its_uncertainty():
    angle = Quantity("beta", "rad", low=-1.57, high=1.57)
    assert check_uncertainty(0.01, 0.002, angle) == 0.01
    assert check_uncertainty(0.01, 0.0, STIFFNESS) == 0.01  # of 0, any share is infinite
    with pytest.raises(ParameterError, match="above 0 rad, got"):
        check_uncertainty(-0.01, 0.002, angle)
