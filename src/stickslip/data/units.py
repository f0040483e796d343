"""Numbers with units, as files and command lines give them."""

import math
import numbers
from dataclasses import replace
from decimal import Decimal
from typing import Any, Final

from stickslip.errors import ParameterError
from stickslip.quantities import Quantity
from stickslip.show.formatting import number as number_text
from stickslip.units import exact_factor, factor, is_of, number_in, shown, split_number

LARGEST_NUMBER: Final = 1e30
LEAST_NUMBER: Final = 1e-30
"""Magnitudes in SI between which a number lies that is not 0: tenth powers of these are numbers."""


def read_number(value: object, quantity: Quantity) -> float:
    """Return a number in SI from a number or from a text with a unit.

    Examples
    --------
    >>> read_number("35 mm", Quantity("x", "m"))
    0.035
    """
    if isinstance(value, str):
        number: Any = _from_text(value, quantity)
    elif isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise ParameterError(_no_number(value, quantity))
    else:
        number = value
    try:
        result = quantity.check("", "", number)
    except (ParameterError, OverflowError):
        wanted = _wanted(quantity, value, _size(number))
        raise ParameterError(f"({quantity.symbol}) must be {wanted}, got {shown(value)}.") from None
    wanted = size_wanted(result, quantity)
    if wanted:
        raise ParameterError(
            f"({quantity.symbol}) must {wanted}, got {shown(value)}: correct the number or its"
            " unit."
        )
    return result


def size_wanted(value: float, quantity: Quantity) -> str:
    """Return what magnitude a number must have, if its own cannot be computed with.

    Examples
    --------
    >>> size_wanted(1e308, Quantity("s", "m"))
    'be 0 or have a magnitude from 1e-30 to 1e+30 m'
    """
    if not value or LEAST_NUMBER <= abs(value) <= LARGEST_NUMBER:
        return ""
    unit = "" if quantity.unit == "1" else f" {quantity.unit}"
    return f"be 0 or have a magnitude from {LEAST_NUMBER:g} to {LARGEST_NUMBER:g}{unit}"


def _size(value: Any) -> float:
    """Return a number as a float, infinite if none is large enough."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _wanted(quantity: Quantity, given: object, value: float) -> str:
    """Return the allowed values beside one [SI] that is not, in the unit in which it was given."""
    match = split_number(given)
    unit = match["unit"] if match else None
    if unit is None or unit == quantity.unit:
        return quantity.wanted(value)
    size = factor(unit, quantity.unit)
    above = None if quantity.above is None else quantity.above / size
    written = replace(
        quantity, unit=unit, low=quantity.low / size, high=quantity.high / size, above=above
    )
    return written.wanted(value / size)


def check_uncertainty(
    uncertainty: float, value: float, quantity: Quantity, given: object = None
) -> float:
    """Return a standard uncertainty of a value in SI, or say what is wrong with it.

    Examples
    --------
    >>> check_uncertainty(2.0, 100.0, Quantity("k", "N/m", low=0))
    2.0
    >>> check_uncertainty(200.0, 100.0, Quantity("k", "N/m", low=0), "200 %")
    Traceback (most recent call last):
    stickslip.errors.ParameterError: (u_k) must be above 0 N/m and below 50 N/m, half of the ...
    """
    unit = "" if quantity.unit == "1" else f" {quantity.unit}"
    got = f"{uncertainty:g}{unit}" if given is None else shown(given)
    positive = quantity.low >= 0.0 or (quantity.above is not None and quantity.above >= 0.0)
    # Of a value that cannot be negative, two standard uncertainties must not reach 0: to first
    # order, a fit would follow values that do not exist.
    most = 0.5 * abs(value) if positive and value else math.inf
    if 0.0 < uncertainty < most:
        return uncertainty
    room = f" and below {number_text(most, 6)}{unit}, half of the value" if most < math.inf else ""
    cure = (
        "leave it out of a value that is exact"
        if uncertainty <= 0.0
        else "measure the value, or fit it to a record"
    )
    raise ParameterError(f"(u_{quantity.symbol}) must be above 0{unit}{room}, got {got}: {cure}.")


def _example(quantity: Quantity) -> str:
    return "10 %" if quantity.unit == "1" else f"1 {quantity.unit}"


def _no_number(value: object, quantity: Quantity) -> str:
    pure = quantity.unit == "1"
    plain = "a number" if pure else "a number in SI units"
    return (
        f"({quantity.symbol}) must be {plain} or text with a unit such as"
        f' "{_example(quantity)}", {quantity.range}, got {shown(value)}.'
    )


def _from_text(text: str, quantity: Quantity) -> float:
    match = split_number(text)
    if match is None:
        raise ParameterError(_no_number(text, quantity))
    try:
        return number_in(text, quantity.unit)
    except ParameterError as error:
        raise ParameterError(f"({quantity.symbol}) {error}.") from None


def read_gain(value: object) -> float | str:
    """Return a gain: a number, or a text with the unit that makes SI of the unit of a column.

    Examples
    --------
    >>> read_gain(35.15), read_gain("-1"), read_gain("0.3 N m/A")
    (35.15, -1.0, '0.3 N m/A')
    """
    result = split_number(value)
    unit = result["unit"] if result else None
    if result is None or unit is None or unit == "%" or is_of(unit, "1"):
        return read_number(value, Quantity("g"))
    read_number(result["number"], Quantity("g"))
    return f"{result['number']} {unit}"


def gain_factor(gain: str, unit: str, target: str) -> float:
    """Return by what a column is multiplied whose gain has a unit.

    Examples
    --------
    >>> gain_factor("0.3 N m/A", "mA", "N m"), gain_factor("0.5 um/count", "counts", "m")
    (0.0003, 5e-07)
    >>> gain_factor("2 kN", "1", "N")
    2000.0

    What an encoder counts in a unit will do as well:

    >>> gain_factor("1000 counts/mm", "counts", "m")
    1e-06
    """
    number, _, own = gain.partition(" ")
    try:
        product = own if unit == "1" else f"{own} * {unit}"  # a coefficient times a load
        return float(Decimal(number) * exact_factor(product, target))
    except ParameterError:
        per = exact_factor(f"{own} * {target}", unit)  # raises: it is of neither kind
        if not float(number):
            raise
        return float(1 / (Decimal(number) * per))
