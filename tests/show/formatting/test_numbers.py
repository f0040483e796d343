"""Numbers in words and digits, as the house style asks."""

import math
import re

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from stickslip.show import formatting

anything = st.floats(allow_nan=True, allow_infinity=True)
finite = st.floats(-1e12, 1e12)
FORMATS = {
    "significant": lambda x: formatting.significant(x, 3),
    "fixed": lambda x: formatting.fixed(x, 2),
    "number": formatting.number,
    "rounded": lambda x: formatting.rounded(x, abs(x)),
    "signed": formatting.signed,
    "percent": formatting.percent,
    "signed_percent": formatting.signed_percent,
    "ratio": formatting.ratio,
    "residue": formatting.residue,
    "quantity": lambda x: formatting.quantity(x, "m"),
    "estimate": lambda x: formatting.estimate(x, abs(x)),
    "interval": lambda x: formatting.interval(x, x),
    "half width": lambda x: formatting.estimate(1.0, abs(x)),
    "low end": lambda x: formatting.interval(x, math.inf),
    "high end": lambda x: formatting.interval(-math.inf, x),
}
POWERS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")


def read(text: str) -> float:
    """Read a printed number back."""
    number, _, power = text.replace("−", "-").replace(",", "").partition(" × 10")
    return float(number) * 10.0 ** int(power.translate(POWERS) or 0)


@pytest.mark.parametrize(
    ("value", "half_width", "printed"),
    [
        (158.2, 4.1, "158 ± 4"),
        (231.4, 11.9, "231 ± 12"),
        (21.13, 0.42, "21.1 ± 0.4"),
        (93.21, 1.13, "93.2 ± 1.1"),
        (-0.6, 1.0, "−0.6 ± 1.0"),
        (0.2442, 0.0961, "0.24 ± 0.10"),
        (0.2442, 0.0196, "0.24 ± 0.02"),
        (0.01, 85, "0 ± 90"),
        (12345.6, 1234.5, "12,300 ± 1,200"),
        (2.54e-7, 2.2e-8, "(2.5 ± 0.2) × 10⁻⁷"),
        (3.1e9, 1.4e8, "(3.10 ± 0.14) × 10⁹"),
        (158.3333, 0.0, "158.333"),
        (52.944775321548619, 1.4e-14, "52.9448"),  # rounding, which is no error
        (52.944775321548619, 1e-4, "52.94478 ± 0.00010"),
        (0.0, 1e-9, "(0.0 ± 1.0) × 10⁻⁹"),
        (-2.13e-6, 4e-8, "(−2.13 ± 0.04) × 10⁻⁶"),
        (0.0195, 0.00073, "0.0195 ± 0.0007"),
        (0.25512, math.inf, "0.255 (uncertainty unbounded)"),
        (0.25512, math.nan, "0.255 (uncertainty not finite)"),
        (math.nan, 1.0, "not finite"),
        (math.inf, 1.0, "unbounded"),
    ],
)
def test_an_estimate_and_its_half_width_end_at_the_same_digit(value, half_width, printed):
    assert formatting.estimate(value, half_width) == printed


@pytest.mark.parametrize(
    ("low", "high", "printed"),
    [
        (0.2487, 0.2611, "0.249 to 0.261"),
        (0.195, 0.205, "0.195 to 0.205"),
        (-3.21, 0.72, "−3.2 to 0.7"),
        (0.0, 24.3, "0 to 24"),
        (12_345, 23_456, "12,000 to 23,000"),
        (1e-8, 1e4, "1.0 × 10⁻⁸ to 10,000"),
        (2.0, 2.0, "exactly 2"),
        (-math.inf, 0.7, "at most 0.700"),
        (0.7, math.inf, "at least 0.700"),
        (-math.inf, math.inf, "not bounded"),
        (math.nan, 1.0, "not finite"),
    ],
)
def test_a_range_shows_two_digits_of_its_width(low, high, printed):
    assert formatting.interval(low, high) == printed


@pytest.mark.parametrize(
    ("call", "printed"),
    [
        (lambda: formatting.percent(0.019), "1.9 %"),
        (lambda: formatting.percent(0.23), "23 %"),
        (lambda: formatting.percent(0.9999), "100 %"),
        (lambda: formatting.percent(0.0), "0 %"),
        (lambda: formatting.signed_percent(0.0191), "+1.9 %"),
        (lambda: formatting.signed_percent(-0.51), "−51 %"),
        (lambda: formatting.residue(2.9e-15), "3 × 10⁻¹⁵"),
        (lambda: formatting.residue(9.7e-16), "1 × 10⁻¹⁵"),
        (lambda: formatting.residue(-0.0), "exactly 0"),
        (lambda: formatting.ratio(3.78), "3.8 ×"),
        (lambda: formatting.quantity(0.2039, "m"), "0.204 m"),
        (lambda: formatting.quantity(0.05, "m"), "50 mm"),
        (lambda: formatting.quantity(0.0, "m"), "0 m"),
        (lambda: formatting.significant(99.96, 3), "100"),
        (lambda: formatting.significant(0.2, 3), "0.200"),
        (lambda: formatting.with_unit(formatting.NOT_FINITE, "N"), "not finite"),
    ],
)
def test_numbers_follow_the_house_style(call, printed):
    assert call() == printed


@pytest.mark.parametrize("name", FORMATS)
@given(x=anything)
def test_no_number_is_printed_as_nan_inf_e_notation_or_with_a_hyphen(name, x):
    text = FORMATS[name](x)
    words = re.sub(
        "not finite|unbounded|not bounded|at least|at most|exactly|uncertainty", "", text
    )
    assert not re.search(r"[A-Za-z-]", re.sub(r"\b[kmµ]?m$|to", "", words))
    assert not re.search("nan|inf(?!inite)", text.replace("finite", ""))


@given(finite, st.floats(1e-9, 1e9))
def test_a_printed_half_width_has_one_digit_or_two_if_it_begins_with_one(value, half_width):
    value_text, doubt = formatting.estimate_text(value, half_width)
    assume(doubt.startswith("±"))
    digits = doubt[2:].replace(")", "").split(" × ")[0].replace(",", "").replace(".", "").strip("0")
    plain = doubt[2:].replace(")", "").split(" × ")[0].replace(",", "")
    assert len(digits) <= (2 if digits[0] == "1" else 1)
    assert "." not in plain or len(plain.partition(".")[2]) == len(
        value_text.removeprefix("(").split(" × ")[0].partition(".")[2]
    )
    # Rounding to one digit moves a half width by at most a quarter (0.2 to 0.25).
    assert read(doubt.removeprefix("±").replace(")", "").strip()) == pytest.approx(
        half_width, rel=0.2501
    )


@given(finite.filter(bool), st.integers(1, 12))
def test_a_rounded_number_reads_back_within_half_its_last_digit(value, digits):
    assert read(formatting.significant(value, digits)) == pytest.approx(
        value, rel=0.5000001 * 10.0 ** (1 - digits)
    )


@given(finite, finite)
def test_the_ends_of_a_range_read_back_within_a_tenth_of_its_width(one, other):
    low, high = sorted((one, other))
    assume(high - low > 1e-9 * max(abs(low), abs(high), 1e-300))
    ends = [read(end) for end in formatting.interval(low, high).split(" to ")]
    # Both ends, rounded to two digits of the width or to two digits of their own.
    tolerance = 0.0500001 * (high - low)
    assert ends == [pytest.approx(low, abs=tolerance), pytest.approx(high, abs=tolerance)]


def test_a_negative_half_width_a_reversed_range_and_zero_digits_are_refused():
    for call in (
        lambda: formatting.estimate(1, -1),
        lambda: formatting.interval(2, 1),
        lambda: formatting.significant(1, 0),
    ):
        with pytest.raises(ValueError, match="got"):
            call()
