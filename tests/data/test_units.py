"""Numbers with units."""

import contextlib
import math

import numpy as np
import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stickslip import Axis, Coulomb, Measurement
from stickslip.data.units import check_uncertainty, gain_factor, read_number
from stickslip.errors import ParameterError
from stickslip.quantities import Quantity
from stickslip.units import factor

WRITTEN = {
    "Nm": ("N m", 1.0), "mNm": ("N m", 1e-3), "Ncm": ("N m", 1e-2), "Nmm": ("N m", 1e-3),
    "kNm": ("N m", 1e3), "kp": ("N", 9.80665), "kpm": ("N m", 9.80665), "daN": ("N", 10.0),
    "1/min": ("rad/s", math.pi / 30), "min^-1": ("rad/s", math.pi / 30),
    "min⁻¹": ("rad/s", math.pi / 30), "min-1": ("rad/s", math.pi / 30),
    "U/min": ("rad/s", math.pi / 30), "rpm": ("rad/s", math.pi / 30),
    "Upm": ("rad/s", math.pi / 30), "rev/s": ("rad/s", 2 * math.pi), "rev": ("rad", 2 * math.pi),
    "deg/s": ("rad/s", math.pi / 180), "°/s": ("rad/s", math.pi / 180),
    "Grad": ("rad", math.pi / 180), "µm": ("m", 1e-6), "μm": ("m", 1e-6), "um": ("m", 1e-6),
    "kgcm²": ("kg m^2", 1e-4), "kgm2": ("kg m^2", 1.0), "gcm^2": ("kg m^2", 1e-7),
    "Nms/rad": ("N m s/rad", 1.0), "Ns/m": ("N s/m", 1.0), "Nm/A": ("N m/A", 1.0),
    "1/Ncm": ("1/N/m", 100.0), "mm/sek": ("m/s", 1e-3), "m/s²": ("m/s^2", 1.0),
}  # fmt: skip


@pytest.mark.parametrize("unit", WRITTEN)
def test_units_are_read_as_people_write_them(unit):
    target, size = WRITTEN[unit]
    assert factor(unit, target) == pytest.approx(size, rel=1e-15)


@pytest.mark.parametrize(
    ("unit", "target"), [("1/s", "rad/s"), ("U", "m"), ("counts", "1"), ("1/min", "m"), ("Nm", "N")]
)
def test_what_looks_alike_is_of_another_kind(unit, target):
    with pytest.raises(ParameterError, match=f"in {target}|a pure number"):
        factor(unit, target)
    assert factor("1/min", "Hz") == 1 / 60  # a frequency, where no rotation is wanted


def test_constructors_take_text_with_units_and_quantities_of_pint():
    unit = pint.UnitRegistry()
    for value in ("3 kg cm^2", "3 kgcm²", unit.Quantity(3, "kg*cm**2"), 3e-4):
        assert Axis(inertia=value).inertia == 3e-4
    assert Coulomb(kinetic_coefficient="20 %").kinetic_coefficient == 0.2
    assert Measurement(travel="200 mm").travel == 0.2
    angles = unit.Quantity(np.array([0.0, 180.0]), "deg")
    assert Measurement(time=[0, 1], position=angles, turning=True).position[1] == math.pi
    own = pint.UnitRegistry()
    own.define("stone_of_ours = 5 kilogram")
    assert Axis(inertia=own.Quantity(2, "stone_of_ours")).inertia == 10.0


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("3 mm", "in kg or a unit of that kind, not in mm, got '3 mm'; write for example \"1 kg\""),
        ("3", "has no unit, got '3': write \"3 kg\""),
        ("-3 kg", "must be above 0 kg, got '-3 kg'"),
        ("heavy", "must be a number or text with a unit such as \"1 kg\", got 'heavy'"),
        (pint.UnitRegistry().Quantity(3, "m"), "not in meter, got '3 meter'"),
        (pint.UnitRegistry().Quantity(20, "degC"), "offset zero"),
        (pint.UnitRegistry().Quantity(np.ones(2), "kg"), "must be one number"),
    ],
)
def test_a_wrong_unit_in_a_constructor_is_one_message(value, message):
    with pytest.raises(ParameterError) as caught:
        Axis(inertia=value)
    text = str(caught.value)
    assert text.startswith("Axis.inertia (J) ")
    assert message in text
    assert "above 0 kg" in text


def test_an_angle_is_no_position_along_a_line():
    angles = pint.UnitRegistry().Quantity(np.zeros(2), "deg")
    with pytest.raises(ParameterError, match=r"position \(x\).*not in degree.*turning=True"):
        Measurement(time=[0, 1], position=angles)


@pytest.mark.parametrize(
    ("gain", "unit", "size"),
    [("0.5 um/count", "counts", 5e-7), ("1000 counts/mm", "inc", 1e-6), ("3 mm/V", "mV", 3e-6)],
)
def test_a_gain_makes_lengths_of_counts_in_either_direction(gain, unit, size):
    assert gain_factor(gain, unit, "m") == pytest.approx(size, rel=1e-14)


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
        ("1 kg", "N", "in N or a unit of that kind, not in kg; of a mass .* the weight is in kgf"),
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


@pytest.mark.slow
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
