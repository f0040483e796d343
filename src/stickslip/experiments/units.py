"""Numbers with units, as files and command lines give them."""

import functools
import math
import numbers
import re
from dataclasses import replace
from decimal import Decimal
from typing import TYPE_CHECKING, Any

from stickslip.errors import ParameterError
from stickslip.formatting import number as number_text
from stickslip.quantities import Quantity

if TYPE_CHECKING:
    import pint

__all__ = [
    "allowed",
    "check_uncertainty",
    "factor",
    "is_of",
    "is_pixel",
    "read_number",
    "shown",
]

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_FACTOR = r"[^\W\d_%°]+(?:\^?-?\d|[⁻¹²³]+)?|%|°"
# The grammar is closed, so that no text can make the unit library compute powers of powers.
_UNIT = rf"(?:1\s*/\s*)?(?:{_FACTOR})(?:(?:\s*[*·/]\s*|\s+)(?:{_FACTOR}))*"
_TEXT = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>\S.*?)?\s*")
_LONGEST = 100
LARGEST, LEAST = 1e30, 1e-30
"""Magnitudes in SI between which a number lies that is not 0: tenth powers of these are numbers."""


def shown(value: object) -> str:
    """Return a value as it should stand in a message, shortened."""
    if isinstance(value, bool):
        return str(value).lower()
    text = f"{value:g}" if isinstance(value, float) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def allowed(quantity: Quantity) -> str:
    """Return the allowed values in words."""
    text = quantity.range
    if text.startswith("a finite number") and quantity.unit != "1":
        return f"a finite number in {quantity.unit}"
    return text


def read_number(value: object, quantity: Quantity) -> float:
    """Return a number in SI from a number or from a text with a unit.

    Parameters
    ----------
    value : object
        As found in a file: a number in SI, or text such as ``"60 mm"``.
    quantity : Quantity
        What the number means.

    Returns
    -------
    float
        The checked number.

    Raises
    ------
    ParameterError
        If it cannot be used. The message begins with the symbol, so that the caller can put the
        file and the key before it.

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
        found = quantity.check("", "", number)
    except (ParameterError, OverflowError):
        raise ParameterError(
            f"({quantity.symbol}) must be {allowed(_as_written(quantity, value))}, got"
            f" {shown(value)}."
        ) from None
    if found and not LEAST <= abs(found) <= LARGEST:
        unit = "" if quantity.unit == "1" else f" {quantity.unit}"
        raise ParameterError(
            f"({quantity.symbol}) must be 0 or have a magnitude from {LEAST:g} to"
            f" {LARGEST:g}{unit}, got {shown(value)}: correct the number or its unit."
        )
    return found


def _as_written(quantity: Quantity, value: object) -> Quantity:
    """Return a quantity with its range in the unit that a text has."""
    match = _TEXT.fullmatch(value) if isinstance(value, str) else None
    unit = match["unit"] if match else None
    if unit is None or unit == quantity.unit:
        return quantity
    size = factor(unit, quantity.unit)
    above = None if quantity.above is None else quantity.above / size
    return replace(
        quantity, unit=unit, low=quantity.low / size, high=quantity.high / size, above=above
    )


MOST_UNCERTAIN = 0.5
"""Standard uncertainty over a value that cannot be negative, from which on two standard
uncertainties reach 0: to first order, a fit would follow values that do not exist."""


def check_uncertainty(
    uncertainty: float, value: float, quantity: Quantity, given: object = None
) -> float:
    """Return a standard uncertainty of a value in SI, or say what is wrong with it.

    Parameters
    ----------
    uncertainty, value : float
        In the unit of the quantity.
    quantity : Quantity
        What the value is of.
    given : object, optional
        The uncertainty as it was written; with its unit if not given.

    Returns
    -------
    float
        The uncertainty, as it was given.

    Raises
    ------
    ParameterError
        If it is not above 0, or half or more of a value that cannot be negative. The message begins
        with the symbol, as that of `read_number`.

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
    most = MOST_UNCERTAIN * abs(value) if positive and value else math.inf
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
        f' "{_example(quantity)}", {allowed(quantity)}, got {shown(value)}.'
    )


def _from_text(text: str, quantity: Quantity) -> float:
    match = _TEXT.fullmatch(text) if len(text) <= _LONGEST else None
    if match is None:
        raise ParameterError(_no_number(text, quantity))
    number, unit = match["number"], match["unit"]
    if not math.isfinite(float(number)):
        return float(number)
    if unit is None and quantity.unit != "1":
        raise ParameterError(
            f'({quantity.symbol}) has no unit in {shown(text)}: write "{number}'
            f' {quantity.unit}", or the number in SI units without quotes.'
        )
    try:
        return float(Decimal(number) * _factor(unit or "1", quantity.unit))
    except ParameterError as error:
        raise ParameterError(
            f"({quantity.symbol}) {error}, got {shown(text)}; write"
            f' for example "{_example(quantity)}".'
        ) from None


def read_gain(value: object) -> float | str:
    """Return a gain: a number, or a text with the unit that makes SI of the unit of a column.

    Parameters
    ----------
    value : object
        As found in a file: a number, or text such as ``"0.3 N m/A"`` for a column in A.

    Returns
    -------
    float or str
        The number; the text if it has a unit.

    Raises
    ------
    ParameterError
        If it cannot be used.

    Examples
    --------
    >>> read_gain(35.15), read_gain("-1"), read_gain("0.3 N m/A")
    (35.15, -1.0, '0.3 N m/A')
    """
    found = _TEXT.fullmatch(value) if isinstance(value, str) else None
    unit = found["unit"] if found else None
    if found is None or unit is None or unit == "%" or is_of(unit, "1"):
        return read_number(value, Quantity("g"))
    read_number(found["number"], Quantity("g"))
    return f"{found['number']} {unit}"


def gain_factor(gain: str, unit: str, target: str) -> float:
    """Return by what a column is multiplied whose gain has a unit.

    Parameters
    ----------
    gain : str
        Number and unit, from `read_gain`.
    unit : str
        Unit of the column.
    target : str
        SI unit of what is measured.

    Returns
    -------
    float
        The factor.

    Raises
    ------
    ParameterError
        If the product of both units is another one.

    Examples
    --------
    >>> gain_factor("0.3 N m/A", "mA", "N m")
    0.0003
    """
    number, _, own = gain.partition(" ")
    return float(Decimal(number) * _factor(f"{own} * {unit}", target))


def factor(unit: str, target: str | None) -> float:
    """Return by what numbers in `unit` are to be multiplied to be in `target`, or in SI.

    Parameters
    ----------
    unit : str
        Unit of the numbers.
    target : str or None
        Unit of the result; SI if None.

    Returns
    -------
    float
        The factor.

    Examples
    --------
    >>> factor("mm", "m")
    0.001
    """
    return float(_factor(unit, target))


def is_of(unit: str, target: str) -> bool:
    """Whether a unit is of the same kind as another one.

    Parameters
    ----------
    unit : str
        A unit.
    target : str
        The unit that it is compared with.

    Returns
    -------
    bool
        Whether one can be converted into the other.

    Examples
    --------
    >>> is_of("deg", "rad"), is_of("deg", "m")
    (True, False)
    """
    try:
        _factor(unit, target)
    except ParameterError:
        return False
    return True


def is_pixel(unit: str) -> bool:
    """Whether a unit is the distance of points in a picture, which has no length of its own.

    Examples
    --------
    >>> is_pixel("px"), is_of("px", "m")
    (True, False)
    """
    return unit in {"px", "pixel", "pixels"}


@functools.cache
def _registry() -> "pint.UnitRegistry[Any]":
    import pint

    # Decimals make "35 mm" the same float as 0.035.
    return pint.UnitRegistry(non_int_type=Decimal)


@functools.cache
def _factor(unit: str, target: str | None) -> Decimal:
    if unit == target:
        return Decimal(1)
    one = _one(unit)
    if target is None:
        return Decimal(one.to_base_units().magnitude)
    wanted = _one(target)
    # Radians have no dimension, but 1 rad/s is not 1 Hz and an angle is no coefficient.
    same_kind = one.dimensionality == wanted.dimensionality and _radians(one) == _radians(wanted)
    if not same_kind:
        kind = "a pure number or in %" if target == "1" else f"in {target} or a unit of that kind"
        raise ParameterError(f"must be {kind}, not in {unit}")
    return Decimal(one.to(wanted.units).magnitude)


def _one(unit: str) -> Any:
    registry = _registry()
    if unit == "1":
        return registry.Quantity(Decimal(1), "")
    if re.fullmatch(_UNIT, unit) is None:
        raise ParameterError(f"has an unreadable unit {shown(unit)}")
    try:
        # To the unit library px is that of web pages, which has a length.
        unit = "pixel" if is_pixel(unit) else unit
        found = registry.parse_units(unit.replace("·", "*").replace("°", "deg"))
        one = registry.Quantity(Decimal(1), found)
    except Exception:
        # Whatever the unit library says, it cannot say where in the file.
        raise ParameterError(f"has an unknown unit {shown(unit)}") from None
    if not one._is_multiplicative:
        raise ParameterError(f"has a unit with an offset zero: {shown(unit)}")
    return one


def _radians(one: Any) -> Any:
    return one.to_root_units()._units.get("radian", 0)
