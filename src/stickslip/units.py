"""Units as people write them, and the factors between them."""

import functools
import math
import re
from collections.abc import Mapping
from decimal import Decimal
from typing import TYPE_CHECKING, Any, Final

from stickslip.errors import InputError, ParameterError

if TYPE_CHECKING:
    import pint

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_NAME = r"[^\W\d_%°⁻¹²³]+"
_FACTOR = rf"{_NAME}(?:\^?[-−]?\d|[⁻¹²³]+)?|%|°"
# The grammar is closed, so that no text can make the unit library compute powers of powers.
_UNIT = rf"(?:1\s*/\s*)?(?:{_FACTOR})(?:(?:\s*[*·⋅/]\s*|\s+)(?:{_FACTOR}))*"
_NUMBER_WITH_UNIT = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>\S.*?)?\s*")

LONGEST_TEXT: Final = 100
"""Characters of a number with its unit at most."""
REMEMBERED: Final = 8192
"""Units whose kind is remembered: columns of a wide table have few."""
_POWER = re.compile(rf"(?P<name>{_NAME})(?P<power>\^?[-−]?\d|[⁻¹²³]+)?")
_RAISED: Final = str.maketrans("⁻−¹²³", "--123")

WRITTEN: Final[Mapping[str, str]] = {
    alias: name
    for name, aliases in {
        "kgf": "kp kilopond",
        "revolution": "rev revs Rev U Umdr Umdrehung Umdrehungen r",
        "rpm": "RPM Upm UPM",
        "count": "cnt cnts inc incs Inc Ink Inkr Inkremente increment increments tick ticks"
        " pulse pulses Impulse digit digits",
        "second": "sek Sek Sekunde Sekunden Sec SEC Secs Second Seconds",
        "millisecond": "Msec Millisecond Milliseconds",
        "minute": "Minute Minutes Minuten",
        "degree": "Grad degs Deg DEG Degree Degrees",
        "radian": "Rad RAD Radian Radians",
        "newton": "Newton Newtons NEWTON",
        "meter": "Meter Meters Metre Metres",
        "millimeter": "Millimeter Millimeters Millimetres",
        "ampere": "Ampere Amperes Amp Amps",
        "volt": "Volt Volts",
        "kilogram": "Kg KG",
        "kilonewton": "KN",
    }.items()
    for alias in aliases.split()
}
"""Names of units that the unit library does not know, or takes for others: to it, U is an amount
of an enzyme and Grad a thousand million radians."""
_JOINED: Final = re.compile(
    r"(?P<force>(?:[mckdMµμu]|da)?N|kp|kgf|kg|g|A|V)(?P<length>[mckdµμu]?m)?(?P<time>s)?"
)
"""Products without a mark between their factors: Nm, mNm, Ncm, kgcm, Ns, Nms."""
_DOTTED: Final = re.compile(r"(?<=N)[.-](?=[mckdµμu]?m\b)")
"""Mark in a torque in N.m or N-m."""
CELSIUS: Final = "degC"
"""Unit of temperatures: coefficients of a law are those at 0 of it, and no contact is near 0 K."""
_REVOLUTIONS: Final = {
    **dict.fromkeys(("1/minute", "1/min", "minute**-1", "min**-1"), "rpm"),
    **dict.fromkeys(("Hz", "hertz"), "rev/s"),
}
"""What means revolutions where a speed of rotation is wanted."""
_ROTATION: Final = ("rad/s", "radian/second")


def shown(value: object) -> str:
    """Return a value as it should stand in a message, shortened."""
    if isinstance(value, bool):
        return str(value).lower()
    text = f"{value:g}" if isinstance(value, float) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def factor(unit: str, target: str | None) -> float:
    """Return by what numbers in `unit` are to be multiplied to be in `target`, or in SI.

    Examples
    --------
    >>> factor("mm", "m"), factor("Ncm", "N m"), factor("kp", "N"), factor("deg/s", "rad/s")
    (0.001, 0.01, 9.80665, 0.017453292519943295)

    Per minute, and Hz, mean revolutions where a speed of rotation is wanted, else a frequency:

    >>> factor("1/min", "rad/s") == factor("U/min", "rad/s"), factor("1/min", "Hz")
    (True, 0.016666666666666666)
    >>> factor("Hz", "rad/s"), factor("rad/s", "rad/s")
    (6.283185307179586, 1.0)
    """
    return float(exact_factor(unit, target))


def converted(values: Any, unit: str, target: str | None) -> Any:
    """Return numbers of a unit in another one, or in SI; of a temperature with its zero.

    Examples
    --------
    >>> converted(300.0, "K", "degC"), converted(5.0, "mm", "m"), converted(68.0, "°F", "degC")
    (26.85, 0.005, 20.0)
    """
    if target != CELSIUS:
        return values * factor(unit, target)
    base = _one(_plain(unit))
    if base.dimensionality != {"[temperature]": 1}:
        raise ParameterError(f"must be in {CELSIUS} or a unit of that kind, not in {unit}")
    zero, at_one = (
        Decimal(_registry().Quantity(Decimal(x), base.units).to(CELSIUS).magnitude) for x in (0, 1)
    )
    if isinstance(values, float):  # which decimals keep as it is written
        return float(Decimal(repr(values)) * (at_one - zero) + zero)
    return values * float(at_one - zero) + float(zero)


@functools.lru_cache(maxsize=REMEMBERED)
def is_of(unit: str, target: str) -> bool:
    """Whether a unit is of the same kind as another one.

    Examples
    --------
    >>> is_of("deg", "rad"), is_of("deg", "m"), is_of("counts", "1")
    (True, False, False)
    """
    try:
        exact_factor(unit, target)
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


def split_number(value: object) -> re.Match[str] | None:
    """Return the number and the unit of a text, in groups of these names; None of all else.

    Examples
    --------
    >>> split_number("35 mm").groups(), split_number("a lot")
    (('35', 'mm'), None)
    """
    if not isinstance(value, str) or len(value) > LONGEST_TEXT:
        return None
    return _NUMBER_WITH_UNIT.fullmatch(value)


def pint_magnitude(value: Any, target: str) -> Any:
    """Return what a quantity of the unit library holds, in another unit.

    Examples
    --------
    >>> import pint
    >>> unit = pint.UnitRegistry()
    >>> pint_magnitude(unit.Quantity(35, "mm"), "m")
    0.035
    >>> pint_magnitude(unit.Quantity([0.0, 90.0], "deg"), "rad").round(3).tolist()
    [0.0, 1.571]
    """
    registry, held, unit = _registry(), value.magnitude, str(value.units)
    try:
        unit_quantity = registry.Quantity(Decimal(1), registry.parse_units(unit))
    except Exception:
        # a unit of a registry of the caller's, which only that can convert
        base = value.to_base_units()
        held, unit_quantity = (
            base.magnitude,
            registry.Quantity(Decimal(1), registry.parse_units(str(base.units))),
        )
    try:
        scale = _converted(unit_quantity, target, unit)
    except ParameterError as error:
        raise ParameterError(f"{error}, got {shown(str(value))}") from None
    if hasattr(held, "__len__") or not math.isfinite(held):
        return held * float(scale)
    return float(Decimal(str(held)) * scale)


def number_in(value: Any, unit: str) -> float:
    """Return a text with a unit, or a quantity of the unit library, as a number.

    Examples
    --------
    >>> number_in("35 mm", "m"), number_in("10 %", "1"), number_in("3 kgcm²", "kg m^2")
    (0.035, 0.1, 0.0003)
    >>> number_in("35", "m")
    Traceback (most recent call last):
    stickslip.errors.ParameterError: has no unit, got '35': write "35 m" (without a unit it must ...
    """
    if not isinstance(value, str):
        held = pint_magnitude(value, unit)
        if not isinstance(held, float):
            raise ParameterError(f"must be one number, got {shown(str(value))}")
        return held
    result = split_number(value)
    example = "10 %" if unit == "1" else f"1 {unit}"
    if result is None:
        raise ParameterError(
            f'must be a number or text with a unit such as "{example}", got {shown(value)}'
        )
    number, own = result["number"], result["unit"]
    if own is None and unit != "1":
        raise ParameterError(
            f'has no unit, got {shown(value)}: write "{number} {unit}" (without a unit it must be'
            " a number in SI units, not a text)"
        )
    if not math.isfinite(float(number)):
        return float(number)
    try:
        if unit == CELSIUS:
            return float(converted(float(number), own or "1", unit))
        return float(Decimal(number) * exact_factor(own or "1", unit))
    except ParameterError as error:
        raise ParameterError(
            f'{error}, got {shown(value)}; write for example "{example}"'
        ) from None


@functools.cache
def _registry() -> "pint.UnitRegistry[Any]":
    import pint

    # Decimals make "35 mm" the same float as 0.035.
    return pint.UnitRegistry(non_int_type=Decimal)


@functools.cache
def exact_factor(unit: str, target: str | None) -> Decimal:
    """Return by what numbers in `unit` are to be multiplied, as `factor`, as a decimal."""
    if unit == target:
        return Decimal(1)
    if target in _ROTATION:
        unit = _REVOLUTIONS.get(_plain(unit), unit)
    base = _one(unit)
    if target is None:
        _check_zero(base, unit)
        return Decimal(base.to_base_units().magnitude)
    return _converted(base, target, unit)


def _converted(base: Any, target: str, unit: str) -> Decimal:
    """Return one of a unit in another one of its kind, or say that it is of another."""
    _check_zero(base, unit)
    wanted = _one(target)
    # Radians have no dimension, but 1 rad/s is not 1 Hz and an angle is no coefficient.
    same_kind = base.dimensionality == wanted.dimensionality and _counted(base) == _counted(wanted)
    if not same_kind:
        kind = "a pure number or in %" if target == "1" else f"in {target} or a unit of that kind"
        mass = base.is_compatible_with("kg") and wanted.is_compatible_with("N")
        weight = "; of a mass that rests on it, the weight is in kgf" * mass
        raise ParameterError(f"must be {kind}, not in {unit}{weight}")
    return Decimal(base.to(wanted.units).magnitude)


def _check_zero(base: Any, unit: str) -> None:
    if not base._is_multiplicative:
        raise ParameterError(f"has a unit with an offset zero: {shown(unit)}")


def _one(unit: str) -> Any:
    registry = _registry()
    if unit == "1":
        return registry.Quantity(Decimal(1), "")
    # a long text is not searched, which takes a time that grows with the square of its length
    unit = unit if len(unit) > LONGEST_TEXT else _DOTTED.sub("*", unit)
    if len(unit) > LONGEST_TEXT or re.fullmatch(_UNIT, unit) is None:
        raise ParameterError(f"has an unreadable unit {shown(unit)}")
    try:
        # To the unit library px is that of web pages, which has a length.
        result = registry.parse_units("pixel" if is_pixel(unit) else _plain(unit))
        base = registry.Quantity(Decimal(1), result)
    except Exception:
        # Whatever the unit library says, it cannot say where in the file.
        raise ParameterError(f"has an unknown unit {shown(unit)}") from None
    return base


@functools.cache
def _plain(unit: str) -> str:
    """Return a unit as the unit library spells it.

    Examples
    --------
    >>> _plain("min⁻¹"), _plain("1/Ncm"), _plain("U/min")
    ('min**-1', '1/(N*cm)', 'revolution/min')
    """
    text = unit.replace("·", "*").replace("⋅", "*").replace("°", "deg")
    text = re.sub(r"\s*([*/])\s*", r"\1", text)
    return re.sub(r"\s+", "*", _POWER.sub(_spelled, text))


def _spelled(found: re.Match[str]) -> str:
    """Return one factor: an alias by its name, a product with marks, a power in ASCII."""
    name = WRITTEN.get(found["name"], found["name"])
    power = (found["power"] or "").translate(_RAISED).lstrip("^")
    joined = _JOINED.fullmatch(name)
    parts = [part for part in joined.groups() if part] if joined and not _is_known(name) else []
    exponent = f"**{power}" if power else ""
    if len(parts) < 2:
        return name + exponent
    parts = [WRITTEN.get(part, part) for part in parts]
    return f"({'*'.join(parts)}{exponent})"


def _is_known(name: str) -> bool:
    """Whether what looks like a product is a unit of its own, such as mg or gs."""
    if "N" in name:  # to the unit library Nm is a textile's number of yarn
        return False
    try:
        _registry().parse_units(name)
    except Exception:
        return False
    return True


def _counted(base: Any) -> tuple[Any, Any]:
    """Return the powers of what has no dimension, but is no pure number either."""
    powers = base.to_root_units()._units
    return powers.get("radian", 0), powers.get("count", 0)


@functools.lru_cache(maxsize=REMEMBERED)
def is_unit(text: str) -> bool:
    """Whether a text is a unit of something.

    Examples
    --------
    >>> is_unit("U/min"), is_unit("Weg"), is_unit("1")
    (True, False, False)
    """
    if text in ("1", "°C", "°F"):  # the degree of a temperature is no angle
        return text != "1"
    try:
        return _one(text) is not None
    except ParameterError:
        return is_pixel(text)


_SI_FACTOR = re.compile(r"(?P<name>[A-Za-z]+|1)(?:\^(?P<power>\d+))?")


def powers_in(unit: str) -> dict[str, int]:
    """Return the powers of the units that stand in a unit, in their order.

    Examples
    --------
    >>> powers_in("N m/(rad s^2)")
    {'N': 1, 'm': 1, 'rad': -1, 's': -2}
    """
    result: dict[str, int] = {}
    above, *below = unit.split("/")
    sides = [(above, 1), *((key.removeprefix("(").removesuffix(")"), -1) for key in below)]
    for side, sign in sides:
        for factor in side.split():
            parsed = _SI_FACTOR.fullmatch(factor)
            if parsed is None:
                raise InputError(f"the unit {unit!r} has {factor!r}, which is no unit.")
            name = parsed["name"]
            result[name] = result.get(name, 0) + sign * int(parsed["power"] or 1)
    return result


def per_second(unit: str) -> str:
    """Return the unit of a time derivative; of a unit that is not in SI, that over a second.

    Examples
    --------
    >>> per_second("m"), per_second("rad/s"), per_second("N m/rad"), per_second("N m s/rad")
    ('m/s', 'rad/s^2', 'N m/(rad s)', 'N m/rad')
    """
    if not unit:
        return ""
    try:
        powers = powers_in(unit)
    except InputError:
        return f"{unit}/s" if "/" not in unit else f"({unit})/s"
    powers["s"] = powers.get("s", 0) - 1
    above, below = (
        [
            name if abs(power) == 1 else f"{name}^{abs(power)}"
            for name, power in powers.items()
            if power * side > 0 and name != "1"
        ]
        for side in (1, -1)
    )
    divisors = f"({' '.join(below)})" if len(below) > 1 else "".join(below)
    return "/".join(filter(None, (" ".join(above) or "1", divisors)))
