"""Parameters that know themselves: symbol, unit, allowed range; and the tree they form.

A class with physical parameters is a frozen, keyword-only dataclass derived from `Parametrised`,
whose numeric fields are annotated with a `Quantity`. Everything that needs to know the parameters
(checks, paths, tracing, forms, tables) reads that one declaration.
"""

import contextlib
import dataclasses
import functools
import importlib
import math
import numbers
import re
import threading
import types
import typing
import weakref
from collections import ChainMap
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeAlias, TypeVar, cast

from stickslip.errors import ParameterError, StickslipError, UnknownNameError, nearest
from stickslip.show.described import Described, alternatives
from stickslip.units import number_in

__all__ = [
    "SCALES",
    "Converted",
    "Given",
    "Group",
    "Numbers",
    "Parametrised",
    "Quantity",
    "fields_of",
    "full_path",
    "gathered",
    "is_rotary",
    "kept_by_identity",
    "motion_kinds",
    "named",
    "own_classes",
    "parameters",
    "plugins",
    "shadow",
    "structure",
    "turned",
    "unchecked",
    "vary",
]

if TYPE_CHECKING:
    from numpy.typing import NDArray

LARGEST_COEFFICIENT = 1e100
"""Largest coefficient; where it has to be above 0, its inverse is the smallest."""

T = TypeVar("T", bound="Parametrised")
R = TypeVar("R")
Accepted_contra = TypeVar("Accepted_contra", contravariant=True)
Kept_co = TypeVar("Kept_co", covariant=True)


class HasArray(Protocol):
    """What NumPy makes an array of: arrays, columns of tables."""

    def __array__(self) -> "NDArray[Any]":
        """Return the array."""


class HasUnit(Protocol):
    """A quantity of the unit library pint, of any registry."""

    @property
    def magnitude(self) -> Any:
        """The number."""

    def to_base_units(self) -> Any:
        """Return the quantity in base units."""


Given: TypeAlias = float | str | HasUnit
"""A number as constructors take it: in SI units, as a text such as ``"60 mm"``, or of pint."""
Numbers: TypeAlias = Sequence[float] | HasArray
"""A series of numbers, as arguments take it."""

if TYPE_CHECKING:

    class Converted(Generic[Accepted_contra, Kept_co]):
        """The type of a field whose class converts what it was given: ``Converted[given, kept]``.

        Type checkers read off a descriptor what a constructor accepts and what an attribute is. At
        run time there is none: the annotation is the type that is kept.
        """

        def __get__(self, instance: object, owner: type | None = None) -> Kept_co:
            """Return what is kept."""

        def __set__(self, instance: object, value: Accepted_contra) -> None:
            """Take what is given."""

else:

    class Converted:
        """A field whose class converts what it was given: ``Converted[given, kept]``."""

        def __class_getitem__(cls, types: tuple[type, type]) -> type:
            """Return the type that is kept."""
            return types[1]


SCALES: Mapping[str, str] = types.MappingProxyType(
    {
        "none": "",
        "level": "1",
        "level+": "1",
        "level-": "1",
        "load": "N",
        "force": "N",
        "slope": "N s/m",
        "slope+": "N s/m",
        "slope-": "N s/m",
        "drag": "N s^2/m^2",
        "speed": "m/s",
        "displacement": "m",
        "stiffness": "1/m",
        "damping": "s/m",
    }
)
"""Sizes that measurements tell, and their units; start values and bounds are multiples of one.

``level`` is friction over the normal force, ``load``, and ``force`` is friction itself; ``slope``
is its growth with speed and ``drag`` that with the squared speed. ``speed`` is the largest one.
``displacement`` is that of presliding, ``stiffness`` and ``damping`` are those of bristles, over
the normal force. ``+`` and ``-`` stand for forward and backward slip alone. With ``none``, start
value and bounds are no multiples but values.
"""

PER_LOAD = ("level", "level+", "level-", "stiffness", "damping")
"""Those of them that are over the normal force."""


@dataclasses.dataclass(frozen=True)
class Quantity:
    """What a number means: symbol, SI unit, allowed range, and where a fit looks for it.

    Parameters
    ----------
    symbol : str
        The field's symbol in plain text, such as ``"mu_s"``.
    unit : str
        SI unit, ``"1"`` for a pure number.
    low, high : float, optional
        Bounds that are still allowed.
    above : float, optional
        Bound that is no longer allowed.
    at_least : str, optional
        Name of another field of the same object that this one must not fall below.
    structural : bool
        A whole number here shapes the equations (an exponent, say) instead of standing in them.
    nuisance : bool
        Fits find it beside what is asked for, as a part of a combination; reports do not list it.
    or_unit : str, optional
        SI unit where the same field is of the other kind of motion: straight, or about an axis.
    scale : str, optional
        What the parameter is proportional to in a measurement, one of `SCALES`, or a product or
        quotient of them such as ``"displacement/speed"`` for a time. ``"none"`` for a pure number,
        or for a value that is known beforehand. Parameters of a friction law need it to be fitted.
    bounds : (float, float), optional
        Least and largest value that a fit looks at, as multiples of the scale; of the surplus where
        there is `at_least`.
    start : float, optional
        Value at which a fit begins, as a multiple of the scale.
    per_load : bool
        Whether the value, times the normal force, makes friction, as those do whose `scale` has
        ``level``, ``stiffness`` or ``damping``. To be said where another scale, or none, hides it.

    Raises
    ------
    ParameterError
        If only some of `scale`, `bounds` and `start` are given, or they contradict each other.

    Examples
    --------
    >>> Quantity("v_s", "m/s", above=0).range
    'above 0 m/s'
    >>> v_s = Quantity("v_s", "m/s", above=0, scale="speed", bounds=(1e-3, 1.0), start=0.1)
    >>> v_s.scaled_by({"speed": 0.5})
    0.5
    >>> Quantity("mu_s", low=0, at_least="kinetic_coefficient").range
    'at least 0 and at least kinetic_coefficient'
    """

    symbol: str
    unit: str = "1"
    low: float = -math.inf
    high: float = math.inf
    above: float | None = None
    at_least: str | None = None
    structural: bool = False
    nuisance: bool = False
    or_unit: str = ""
    scale: str = ""
    bounds: tuple[float, float] | None = None
    start: float | None = None
    per_load: bool = False

    def __post_init__(self) -> None:
        # What has one of them to the first power is over the load, whatever else it is multiplied
        # by.
        if sum(power for name, power in self.powers.items() if name in PER_LOAD) == 1:
            object.__setattr__(self, "per_load", True)
        if not self.scale and self.bounds is None and self.start is None:
            return
        label = f"Quantity {self.symbol!r}"
        if not self.scale or self.bounds is None or self.start is None:
            raise ParameterError(
                f'{label}: a fit needs scale, bounds and start together, such as scale="speed",'
                " bounds=(1e-3, 1.0), start=0.1."
            )
        powers = self.powers
        unknown = [name for name in powers if name not in SCALES]
        if unknown:
            raise ParameterError(
                f"{label}: scale={self.scale!r} contains the unknown size {unknown[0]!r}; known"
                f" sizes are {', '.join(SCALES)}, and their products and quotients."
            )
        low, high = self.bounds
        within = low < high and (self.at_least is not None or low <= self.start <= high)
        if not (within and all(map(math.isfinite, (low, high, self.start)))):
            raise ParameterError(
                f"{label}: bounds must be two finite numbers with start between them, got"
                f" bounds={self.bounds!r}, start={self.start!r}."
            )
        # With a scale the limits are multiples of sizes, which are not known here.
        if self.scale == "none" and self.at_least is None:
            for value in (self.start, high):
                self.check("Quantity", "start and bounds", value)

    def check_scale(self, owner: str, name: str) -> None:
        """Refuse a scale that has another unit than the parameter.

        Parameters
        ----------
        owner, name : str
            Class and field that declare the quantity, for the error.

        Raises
        ------
        ParameterError
            If the units differ, or unit or scale have powers that are not whole.
        """
        for text in (self.unit, self.scale):
            if self.scale not in ("", "none") and BROKEN_POWER.search(text):
                raise ParameterError(
                    f"{owner}.{name} ({self.symbol}): beside a scale, powers must be whole, got"
                    f' {text}. Use scale="none", with start and bounds in the unit itself.'
                )
        # In units of the sizes: both sides must have the same powers of the base units.
        unit = _sum((_unit_powers(SCALES[name]), power) for name, power in self.powers.items())
        if self.scale not in ("", "none") and unit != _unit_powers(self.unit):
            raise ParameterError(
                f"{owner}.{name} ({self.symbol}) has the unit {self.unit}, but scale={self.scale}"
                ' has a different one. Correct one of them, or use scale="none", with start and'
                " bounds in the unit itself."
            )

    def __str__(self) -> str:
        """Return symbol and allowed values."""
        return f"{self.symbol}: {self.range}" + (f" or {self.or_unit}" if self.or_unit else "")

    @property
    def powers(self) -> Mapping[str, int]:
        """The sizes that the scale is made of, and their powers."""
        return {name: power for name, power in _powers(self.scale).items() if name != "1"}

    @property
    def force_unit(self) -> str:
        """The unit of the value times a normal force; its own if it is not over one.

        Shapes and shares are pure numbers at any normal force, and so is a factor on levels.
        """
        if not self.per_load or (self.scale == "none" and self.unit == "1"):
            return self.unit
        over = self.unit.removeprefix("1/")
        simple = {"1": "N", "N": "1", "N^2": "1/N"}.get(over)
        return simple or (f"N {self.unit}" if over == self.unit else f"N/{over}")

    def unit_at(self, *, per_load: bool, turning: bool) -> str:
        """Return the unit of the value at a contact.

        Levels over a normal force are pure numbers, or lengths where slip is an angle: torques
        over a force, the coefficient of friction times the radius at which it acts. If no normal
        force is known, they are forces or torques.

        Parameters
        ----------
        per_load : bool
            Whether a normal force is known, which levels are over.
        turning : bool
            Whether slip is an angle.

        Returns
        -------
        str
            The unit of the value.

        Examples
        --------
        >>> level = Quantity("mu_k", per_load=True)
        >>> level.unit_at(per_load=True, turning=False), level.unit_at(per_load=True, turning=True)
        ('1', 'm')
        >>> level.unit_at(per_load=False, turning=True)
        'N m'
        """
        force = turned(self.force_unit, turning)
        if not per_load:
            return force
        if not turning or self.force_unit == self.unit:
            return turned(self.unit, turning)
        return {"1": "1/N", "1/N/m": "1/N^2/m"}.get(force) or force.removeprefix("N ")

    def scaled_by(self, sizes: Mapping[str, float]) -> float:
        """Return what start value and bounds are multiples of.

        Parameters
        ----------
        sizes : mapping of str to float
            The sizes that a measurement tells [SI], by name.

        Returns
        -------
        float
            Its value in the unit of the quantity; 1 if there is no scale.
        """
        return math.prod(
            sizes[name] ** power for name, power in self.powers.items() if SCALES[name]
        )

    def stands_in_equations(self, value: float | None) -> bool:
        """Whether `value` is a parameter of the equations and not part of their shape."""
        return value is not None and not (self.structural and float(value).is_integer())

    def allows(self, value: float) -> bool:
        """Whether `value` is a finite number in the allowed range."""
        return math.isfinite(value) and self._is_within(value) and self._is_sized(value)

    def _is_within(self, value: float) -> bool:
        return self.low <= value <= self.high and (self.above is None or value > self.above)

    def _is_sized(self, value: float) -> bool:
        """Whether a coefficient has a square, and an inverse with one where it divides."""
        if self.above == 0.0:
            # A divisor must have an inverse with a square, too.
            return 1.0 / LARGEST_COEFFICIENT <= value <= LARGEST_COEFFICIENT
        return self.low == -math.inf or abs(value) <= LARGEST_COEFFICIENT

    @property
    def range(self) -> str:
        """The allowed values in words."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        parts = []
        if self.above is not None:
            parts.append(f"above {self.above:g}")
        if self.low > -math.inf:
            parts.append(f"at least {self.low:g}")
        if self.high < math.inf:
            parts.append(f"at most {self.high:g}")
        text = " and ".join(parts) + unit if parts else ""
        if self.at_least is not None:
            text += (" and " if text else "") + f"at least {self.at_least}"
        return text or "a finite number" + (f" in{unit}" if unit else "")

    def wanted(self, value: float) -> str:
        """Return the allowed values in words, for a message on one that is not allowed.

        Parameters
        ----------
        value : float
            The value, in the unit of the quantity.

        Returns
        -------
        str
            The range, which begins with "finite" if the value is infinite or NaN.
        """
        if math.isfinite(value) and self._is_within(value):
            least = f"between {1.0 / LARGEST_COEFFICIENT:g} and" if self.above == 0.0 else "at most"
            return f"{self.range}, and {least} {LARGEST_COEFFICIENT:g}"
        finite = math.isfinite(value) or self.range.startswith("a finite")
        return self.range if finite else f"finite and {self.range}"

    def check(self, owner: str, name: str, value: object) -> float:
        """Return `value` as a float, or raise `ParameterError` that says how to mend it.

        Parameters
        ----------
        owner : str
            Class or function that asks, for the error.
        name : str
            Name of the parameter, for the error.
        value : object
            What was given: a number, a text with a unit such as ``"60 mm"``, or a quantity of the
            package pint.

        Returns
        -------
        float
            The value, in the unit of the quantity.

        Raises
        ------
        ParameterError
            If the value is no finite number in the allowed range.
        """
        if type(value) is float and self.allows(value):  # nearly always, and the rest is slow
            return value
        label = f"{owner}.{name} ({self.symbol})"
        number: Any = self._with_unit(label, value) if has_unit(value) else value
        if isinstance(number, bool) or not isinstance(number, numbers.Real):
            raise ParameterError(f"{label} must be a number, {self.range}, got {value!r}.")
        result = float(number)
        if not self.allows(result):
            got = repr(str(value)) if has_unit(value) else f"{result:g}"
            raise ParameterError(f"{label} must be {self.wanted(result)}, got {got}.")
        return result

    def _with_unit(self, label: str, value: object) -> float:
        """Return a value with a unit as a number, in the unit of either kind of motion."""
        try:
            return number_in(value, self.unit)
        except ParameterError as error:
            # Both kinds of motion are tried before the unit is refused.
            if self.or_unit:
                with contextlib.suppress(ParameterError):
                    return number_in(value, self.or_unit)
            raise ParameterError(f"{label} {error}; allowed is {self.range}.") from None


def has_unit(value: object) -> bool:
    """Whether something is a number with a unit: a text, or of the unit library, of any registry.

    Examples
    --------
    >>> import pint
    >>> has_unit(pint.UnitRegistry().Quantity(35, "mm")), has_unit("35 mm"), has_unit(35)
    (True, True, False)
    """
    of_pint = hasattr(value, "magnitude") and hasattr(value, "to_base_units")
    return of_pint or isinstance(value, str)


def motion_kinds(cls: type, given: Mapping[str, object]) -> dict[bool, str]:
    """Return a value whose unit is of rotary motion (True), and one whose unit is of linear motion.

    Examples
    --------
    >>> from stickslip import Axis
    >>> motion_kinds(Axis, {"inertia": "0.02 kg m^2", "stiffness": "3 N/m", "damping": 0.1})
    {True: 'inertia = 0.02 kg m^2', False: 'stiffness = 3 N/m'}
    """
    kinds: dict[bool, str] = {}
    for name, quantity in fields_of(cls).items():
        value = given.get(name)
        if not quantity.or_unit or not has_unit(value):
            continue
        for rotary, unit in ((True, quantity.or_unit), (False, quantity.unit)):
            with contextlib.suppress(ParameterError):
                number_in(value, unit)
                kinds.setdefault(rotary, f"{name} = {value}")
    return kinds


def is_rotary(kinds: Mapping[bool, str], stated: bool | None = None) -> bool:
    """Return whether a motion is rotary by units and by what is stated; linear if neither says."""
    known = dict(kinds)
    if stated is not None:
        known.setdefault(stated, f"rotary = {str(stated).lower()}")
    if len(known) == 2:
        raise ParameterError(
            f"{known[True]} is of a rotary axis, but {known[False]} of a linear one: give both in"
            " units of the same kind of motion, such as kg m^2, N m and rad, or kg, N and m."
        )
    return True in known


BROKEN_POWER = re.compile(r"\^(?!\d+(?:[\s*/]|$))")
"""A power that `_powers` cannot read."""


def _powers(text: str) -> dict[str, int]:
    """Return names and powers of products and quotients such as ``force/displacement^2``."""
    result: dict[str, int] = {}
    for place, factors in enumerate(text.split("/")):
        for factor in factors.replace("*", " ").split():
            name, _, power = factor.partition("^")
            # All that stands behind the first stroke divides: a/b/c is a/(b c).
            sign = -1 if place else 1
            result[name] = result.get(name, 0) + sign * (int(power) if power.isdigit() else 1)
    return result


def _unit_powers(unit: str) -> dict[str, int]:
    return {name: power for name, power in _powers(unit).items() if name != "1" and power}


def _sum(parts: Iterable[tuple[Mapping[str, int], int]]) -> dict[str, int]:
    """Return the sum of powers, each times a number, without those that are 0."""
    result: dict[str, int] = {}
    for powers, times in parts:
        for name, power in powers.items():
            result[name] = result.get(name, 0) + times * power
    return {name: power for name, power in result.items() if power}


@dataclasses.dataclass(frozen=True, kw_only=True)
class Parametrised(metaclass=Described):
    """Base of laws, mechanisms and drives: checks every declared quantity on construction."""

    data_fields: typing.ClassVar[tuple[str, ...]] = ()
    """Fields whose content never enters an equation's text, such as the points of a drive."""
    wanted: typing.ClassVar[str] = ""
    """What a field of this class holds, for the message on something else: "a drive such as"."""

    @classmethod
    def instead(cls, given: object) -> str:  # subclasses look at it
        """Return how what was given is written instead; empty if it may stand, or if unknown."""
        return ""

    def __post_init__(self) -> None:
        owner = type(self).__name__
        for name, kinds in _members(type(self)).items():
            value = getattr(self, name)
            kind, given = kinds[0], value is not None
            cure = kind.instead(value) if given and issubclass(kind, Parametrised) else ""
            if cure or not isinstance(value, kinds):
                raise ParameterError(_refusal(f"{owner}.{name}", kinds, value))
        for name, quantity in fields_of(type(self)).items():
            value = getattr(self, name)
            if value is None and _optional(type(self), name):
                continue
            object.__setattr__(self, name, quantity.check(owner, name, value))
        # Orders are compared once all values are numbers.
        for name, quantity in fields_of(type(self)).items():
            self._check_order(name, quantity)

    def _check_order(self, name: str, quantity: Quantity) -> None:
        value = getattr(self, name)
        if quantity.at_least is None or value is None:
            return
        bound = getattr(self, quantity.at_least)
        if value < bound:
            raise ParameterError(
                f"{type(self).__name__}.{name} ({quantity.symbol}) must be at least "
                f"{quantity.at_least} = {bound:g}, got {value:g}."
            )


@dataclasses.dataclass(frozen=True, kw_only=True)
class Group(Parametrised):
    """Several objects by name: paths of their parameters have the name after that of the group."""

    members: tuple[tuple[str, Any], ...]
    """Names and objects, in order."""

    def __getitem__(self, name: str) -> Any:
        """Return the object of a name."""
        return dict(self.members)[name]


_DECLARED: dict[type, Mapping[str, Quantity]] = {}
"""Declared quantities by class; type hints are slow to resolve."""


def _hints(cls: type) -> dict[str, Any]:
    return typing.get_type_hints(cls, include_extras=True)


_OPTIONAL: dict[tuple[type, str], bool] = {}
"""Whether a field may be None, by class and name."""


def _optional(cls: type, name: str) -> bool:
    if (cls, name) not in _OPTIONAL:
        _OPTIONAL[cls, name] = type(None) in alternatives(_hints(cls)[name])
    return _OPTIONAL[cls, name]


_MEMBERS: dict[type, Mapping[str, tuple[type, ...]]] = {}
"""Types of the fields that hold objects with parameters, by class."""


def _members(cls: type) -> Mapping[str, tuple[type, ...]]:
    """Return the fields that hold an object with parameters, or True or False, and their types."""
    if cls not in _MEMBERS:
        result: dict[str, tuple[type, ...]] = {}
        for field in dataclasses.fields(cls):
            kinds = alternatives(_hints(cls)[field.name])
            if kinds == (bool,) or (
                isinstance(kinds[0], type) and issubclass(kinds[0], Parametrised)
            ):
                result[field.name] = (*kinds, *([type(None)] if field.default is None else []))
        _MEMBERS[cls] = result
    return _MEMBERS[cls]


def _refusal(label: str, kinds: tuple[type, ...], given: object) -> str:
    """Return the message on a field that holds an object of another kind."""
    kind = kinds[0]
    if kind is bool:
        return f"{label} must be True or False, got {given!r}."
    assert issubclass(kind, Parametrised)
    wanted = kind.wanted or f"of the class {kind.__name__}"
    none = " or None" if type(None) in kinds else ""
    cure = kind.instead(given)
    shown = "a function" if isinstance(given, types.FunctionType) else repr(given)
    if isinstance(given, type):
        shown = f"the class {given.__name__}"
        cure = f"Give its parameters: {given.__name__}(...)." if issubclass(given, kinds) else cure
    return f"{label} must be {wanted}{none}, got {shown}." + (f" {cure}" if cure else "")


_NAMES: dict[type, tuple[str, ...]] = {}
"""Names of fields by class; every run asks for them several times."""


def _names(cls: type) -> tuple[str, ...]:
    """Return the names of the fields of a class."""
    if cls not in _NAMES:
        _NAMES[cls] = tuple(field.name for field in dataclasses.fields(cls))
    return _NAMES[cls]


def fields_of(cls: type) -> Mapping[str, Quantity]:
    """Return the declared quantities of a class by field name, in order.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> [quantity.symbol for quantity in fields_of(Coulomb).values()]
    ['mu_k', 'mu_s']
    """
    if cls not in _DECLARED:
        result = {}
        for field in dataclasses.fields(cls):
            for hint in alternatives(_hints(cls)[field.name]):
                for mark in getattr(hint, "__metadata__", ()):
                    if isinstance(mark, Quantity):
                        mark.check_scale(cls.__name__, field.name)
                        result[field.name] = mark
        _DECLARED[cls] = types.MappingProxyType(result)
    return _DECLARED[cls]


def parameters(root: Parametrised, prefix: str) -> Iterator[tuple[str, Quantity, float]]:
    """Yield path, quantity and value of each parameter that stands in the equations.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> [
    ...     (path, value)
    ...     for path, _, value in parameters(Coulomb(kinetic_coefficient=0.2), "friction")
    ... ]
    [('friction.kinetic_coefficient', 0.2)]
    """
    if isinstance(root, Group):
        for name, member in root.members:
            yield from parameters(member, f"{prefix}.{name}")
        return
    quantities = fields_of(type(root))
    for name in _names(type(root)):
        value = getattr(root, name)
        path = f"{prefix}.{name}"
        if name in quantities:
            if quantities[name].stands_in_equations(value):
                yield path, quantities[name], value
        elif isinstance(value, Parametrised):
            yield from parameters(value, path)
        elif isinstance(value, tuple) and name not in root.data_fields:
            for index, item in enumerate(value):
                if isinstance(item, Parametrised):
                    yield from parameters(item, f"{path}.{index}")


def unchecked(kind: type[R], /, **values: Any) -> R:
    """Make an object from values that were checked elsewhere, or that are symbols of tracing."""
    made = object.__new__(kind)
    vars(made).update(values)
    return made


def replaced(root: Any, prefix: str, path: str, value: float) -> Any:
    """Return `root` with the parameter at a full path replaced, unchecked: by one nearby, say.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> law = Coulomb(kinetic_coefficient=0.2)
    >>> replaced(law, "friction", "friction.kinetic_coefficient", 0.21).kinetic_coefficient
    0.21
    """
    if path == prefix:
        return value
    name = path[len(prefix) + 1 :].partition(".")[0]
    inner = f"{prefix}.{name}"
    if isinstance(root, tuple):
        place = int(name)
        return (*root[:place], replaced(root[place], inner, path, value), *root[place + 1 :])
    made: Any = object.__new__(type(root))
    values = vars(made)
    for own in _names(type(root)):
        values[own] = getattr(root, own)
    if name in values:
        values[name] = replaced(values[name], inner, path, value)
    else:  # of a group
        members = dict(root.members)
        members[name] = replaced(members[name], inner, path, value)
        values["members"] = tuple(members.items())
    return made


def shadow(root: T, prefix: str, symbol: Callable[[str], Any]) -> T:
    """Copy `root` with each parameter of the equations replaced by `symbol(path)`, unchecked.

    This is how equations written for numbers are traced: the same methods run on symbols.
    """
    if isinstance(root, Group):
        members = tuple((n, shadow(member, f"{prefix}.{n}", symbol)) for n, member in root.members)
        return unchecked(type(root), members=members)
    values = {}
    quantities = fields_of(type(root))
    for field in dataclasses.fields(root):
        value = getattr(root, field.name)
        path = f"{prefix}.{field.name}"
        if field.name in quantities:
            if quantities[field.name].stands_in_equations(value):
                value = symbol(path)
        elif isinstance(value, Parametrised):
            value = shadow(value, path, symbol)
        elif isinstance(value, tuple) and field.name not in root.data_fields:
            value = tuple(
                shadow(item, f"{path}.{index}", symbol) if isinstance(item, Parametrised) else item
                for index, item in enumerate(value)
            )
        values[field.name] = value
    return unchecked(type(root), **values)


def structure(root: Parametrised) -> tuple[Hashable, ...]:
    """Return what shapes the equations of an object: its class, and all but its parameters.

    Two objects of the same structure differ in numbers only.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> one, other = (Coulomb(kinetic_coefficient=mu) for mu in (0.2, 0.3))
    >>> structure(one) == structure(other)
    True
    """
    if isinstance(root, Group):
        return (type(root), *((name, structure(member)) for name, member in root.members))
    quantities = fields_of(type(root))
    parts: list[Any] = [type(root)]
    for name in _names(type(root)):
        value = getattr(root, name)
        if name in root.data_fields:
            continue
        if name in quantities and quantities[name].stands_in_equations(value):
            continue
        parts.append((name, _structure_of(value)))
    return tuple(parts)


MOST_KEPT = 256
"""Objects, or pairs of them, of which something is kept."""
_FIXED: dict[int, weakref.ref[Any]] = {}
"""Objects of which nothing can be changed in place, by their places in memory."""
_LOCK = threading.RLock()
"""Held while what is kept changes, which may end objects that ask for what is kept."""


def _is_fixed(root: object) -> bool:
    """Whether nothing of an object with parameters can be changed in place."""
    known = _FIXED.get(id(root))
    if known is not None and known() is root:
        return True
    if not isinstance(root, Parametrised):
        return False
    # What has no hash, as a list, may be changed in place.
    try:
        hash(structure(root))
    except TypeError:
        return False
    # Weakly: what is kept must not keep objects alive.
    _keep(_FIXED, id(root), weakref.ref(root))
    return True


def _keep(kept: dict[Any, Any], key: object, value: object) -> None:
    """Keep a value in place of the one that was kept first, where there are many."""
    with _LOCK:
        kept[key] = value
        # The oldest first: a dictionary keeps the order of insertion.
        while len(kept) > MOST_KEPT:
            del kept[next(iter(kept))]


def kept_by_identity(function: Callable[[Any, Any], R]) -> Callable[[Any, Any], R]:
    """Let a function of two objects with parameters work out its value once for the same objects.

    Such objects are frozen, so that what follows from them never changes. The same are the same
    in memory, which takes less time to see than that two are equal. They are not kept alive,
    unless the value holds them; it is not None. What is of another kind, or holds something
    that can be changed in place, is looked at each time.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> calls = []
    >>> sum_of = kept_by_identity(lambda one, other: calls.append(1) or one.kinetic_coefficient)
    >>> law = Coulomb(kinetic_coefficient=0.2)
    >>> sum_of(law, law), sum_of(law, law), len(calls)
    (0.2, 0.2, 1)
    """
    # Weak references tell an object from one that is gone and had the same place in memory.
    kept: dict[tuple[int, int], tuple[weakref.ref[Any], weakref.ref[Any], R | None]] = {}

    @functools.wraps(function)
    def cached(first: Any, second: Any) -> R:
        key = id(first), id(second)
        known = kept.get(key)
        if known is not None and known[0]() is first and known[1]() is second:
            return cast("R", second if known[2] is None else known[2])
        value = function(first, second)
        if _is_fixed(first) and _is_fixed(second):
            # the second object itself, such as a law that was checked, is not kept alive
            own = None if value is second else value
            _keep(kept, key, (weakref.ref(first), weakref.ref(second), own))
        return value

    return cached


def _structure_of(value: Any) -> Any:
    if isinstance(value, Parametrised):
        return structure(value)
    if isinstance(value, tuple):
        return tuple(map(_structure_of, value))
    return value


def vary(root: T, prefix: str, changes: Mapping[str, float | None]) -> T:
    """Return `root` with the parameters at the given full paths changed, checked as ever."""
    grouped: dict[str, dict[str, float | None]] = {}
    own: dict[str, Any] = {}
    quantities = fields_of(type(root))
    members = dict(root.members) if isinstance(root, Group) else {}
    for path, value in changes.items():
        name, _, rest = path.removeprefix(prefix + ".").partition(".")
        if not rest and name in quantities:
            own[name] = value
        elif rest and (name in members if isinstance(root, Group) else hasattr(root, name)):
            grouped.setdefault(name, {})[path] = value
        else:
            known = [known for known, _, _ in parameters(root, prefix)]
            raise UnknownNameError("parameter", path, known)
    if isinstance(root, Group):
        for name, inner in grouped.items():
            members[name] = vary(members[name], f"{prefix}.{name}", inner)
        # `replace` makes a new object, which checks itself.
        return dataclasses.replace(root, members=tuple(members.items()))
    for name, inner in grouped.items():
        own[name] = _vary_member(getattr(root, name), f"{prefix}.{name}", inner)
    return dataclasses.replace(root, **own)


def beginning(
    roots: Mapping[str, Parametrised], varied: Mapping[str, Any], known: Mapping[str, Quantity]
) -> dict[str, Any]:
    """Return the roots with the first values of what varies, where they have none of their own yet.

    A name is sought among the parameters that are given and what else is known, as `full_path`
    does, then among all parameters. What is found in neither changes nothing.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> roots = {"friction": Coulomb(kinetic_coefficient=0.2)}
    >>> beginning(roots, {"mu_s": [0.3, 0.4]}, {})["friction"].static_coefficient
    0.3
    """
    given, declared = dict(known), dict[str, Quantity]()
    for prefix, root in roots.items():
        given |= {path: quantity for path, quantity, _ in parameters(root, prefix)}
        declared |= all_paths(root, prefix)
    changes: dict[str, dict[str, Any]] = {prefix: {} for prefix in roots}
    for name, values in varied.items():
        with contextlib.suppress(UnknownNameError):
            path = _sought(name, given, declared)
            if path.partition(".")[0] in roots:
                changes[path.partition(".")[0]][path] = _first(values)
    # where one is new, all begin with their first value, as they may have to be in some order
    return {
        prefix: root if changes[prefix].keys() <= given.keys() else vary(root, prefix, entry)
        for (prefix, root), entry in zip(roots.items(), changes.values(), strict=True)
    }


def _sought(name: str, given: Mapping[str, Quantity], declared: Mapping[str, Quantity]) -> str:
    """Return the full path of a parameter that is given, else of one that may be."""
    try:
        return full_path(name, given)
    except UnknownNameError:
        return full_path(name, declared)


def _first(values: Any) -> Any:
    while hasattr(values, "__len__") and len(values) and not isinstance(values, str):
        values = values[0]
    return values


def _vary_member(member: Any, prefix: str, changes: Mapping[str, float | None]) -> Any:
    if isinstance(member, Parametrised):
        return vary(member, prefix, changes)
    if isinstance(member, tuple):
        items = list(member)
        for path, value in changes.items():
            place = path.removeprefix(prefix + ".").partition(".")[0]
            if place not in map(str, range(len(items))):
                raise UnknownNameError(
                    "parameter", path, [f"{prefix}.{i}" for i in range(len(items))]
                )
            items[int(place)] = vary(items[int(place)], f"{prefix}.{place}", {path: value})
        return tuple(items)
    raise UnknownNameError("parameter", next(iter(changes)), [])


def full_path(path: str, known: Collection[str], kind: str = "parameter") -> str:
    """Return the full path for a full path, or for an end of it that only one of the known has.

    Where their quantities are known, a symbol stands for the name.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> full_path("mu_k", {f"friction.{n}": one for n, one in fields_of(Coulomb).items()})
    'friction.kinetic_coefficient'
    """
    if path in known:
        return path
    symbols = {}
    if isinstance(known, Mapping):
        symbols = {f: item.symbol for f, item in known.items() if isinstance(item, Quantity)}
    # Names before symbols: a name that is also the symbol of another one means itself.
    same = [full for full in known if full.endswith(f".{path}")]
    if len(same) > 1:
        raise UnknownNameError(kind, path, same)
    if not same:
        place, _, symbol = path.rpartition(".")
        within = (full for full, known_symbol in symbols.items() if known_symbol == symbol)
        same = [full for full in within if place in ("", full.rpartition(".")[0])]
    if len(same) == 1:
        return same[0]
    if same:
        raise UnknownNameError(kind, path, same, symbols)
    ends = {full.rpartition(".")[2] for full in known}
    # Near to no full path but to an end of one: ends are what to propose then.
    closer = not nearest(path, known) and bool(nearest(path, ends))
    raise UnknownNameError(kind, path, ends if closer else known, {} if closer else symbols)


def all_paths(root: Parametrised, prefix: str) -> dict[str, Quantity]:
    """Return the quantities below `root` by path, those that are not given included.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> from stickslip.mechanisms.drives import Pulse
    >>> block = SpringBlock(mass=1.0, drive=Pulse(level=1.0, duration=1.0))
    >>> list(all_paths(block, "mechanism"))[-1]
    'mechanism.drive.start'
    """
    if isinstance(root, Group):
        below = (all_paths(member, f"{prefix}.{name}") for name, member in root.members)
        return {path: quantity for paths in below for path, quantity in paths.items()}
    result = {f"{prefix}.{name}": quantity for name, quantity in fields_of(type(root)).items()}
    for field in dataclasses.fields(root):
        value = getattr(root, field.name)
        path = f"{prefix}.{field.name}"
        if isinstance(value, Parametrised):
            result.update(all_paths(value, path))
        elif isinstance(value, tuple):
            for index, item in enumerate(value):
                if isinstance(item, Parametrised):
                    result.update(all_paths(item, f"{path}.{index}"))
    return result


def standing_path(
    path: str, known: Mapping[str, Quantity], roots: Mapping[str, Parametrised]
) -> str:
    """Return the full path of a parameter that stands in the equations, as `full_path` does.

    What is a parameter of one of the roots (by prefix) but does not stand there is refused with the
    reason.
    """
    try:
        return full_path(path, known)
    except UnknownNameError:
        declared: dict[str, Quantity] = {}
        # Only where it is a parameter at all is there a reason to tell; else the first error
        # stands.
        for prefix, root in roots.items():
            declared |= all_paths(root, prefix)
        with contextlib.suppress(UnknownNameError):
            full = full_path(path, declared)
            raise ParameterError(_absence(full, declared[full])) from None
        raise


def _absence(path: str, quantity: Quantity) -> str:
    """Return why a parameter does not stand in the equations, and the cure."""
    if not quantity.structural:
        return f"{path} ({quantity.symbol}) was not given, so it does not vary: give it a value."
    return (
        f"{path} ({quantity.symbol}) is a whole number, which shapes the equations and does not"
        " vary in them: give it a value that is not whole, such as 1.000001 for 1."
    )


def named(registry: Mapping[str, Any], name: str, kind: str) -> Any:
    """Look a name up, or say which known names are nearest."""
    if name not in registry:
        raise UnknownNameError(kind, name, registry)
    return registry[name]


def own_classes(package: str, modules: Mapping[str, str], base: type[T]) -> tuple[type[T], ...]:
    """Return the classes that a table of lazy names registers.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import Drive
    >>> [
    ...     kind.__name__
    ...     for kind in own_classes("stickslip.mechanisms.drives", {"Sine": "shapes"}, Drive)
    ... ]
    ['Sine']
    """
    result = []
    for name, module in modules.items():
        kind = getattr(importlib.import_module(f"{package}.{module}"), name)
        if not (isinstance(kind, type) and issubclass(kind, base)):
            raise TypeError(f"{package}.{name} must be a class derived from {base.__name__}.")
        result.append(kind)
    return tuple(result)


def gathered(ours: Mapping[str, type[T]], group: str, base: type[T]) -> Mapping[str, type[T]]:
    """Return our classes by name, and those that installed packages register in a group."""
    result: dict[str, type[T]] = {}
    # Ours are not looked through: they are classes to import only when asked for.
    known = ChainMap(result, ours)  # type: ignore[arg-type]  # ours is only read
    for where, kind in plugins(group, base):
        name = getattr(kind, "name", None)
        if not isinstance(name, str) or known.get(name, kind) is not kind:
            raise name_taken(where, repr(name))
        result[name] = kind
    return types.MappingProxyType(known)


def name_taken(where: str, name: str) -> StickslipError:
    """Return the error of a plug-in by a name that another one has."""
    return StickslipError(f"{where} is named {name}, which is taken: rename it.")


def plugins(group: str, base: type[T]) -> Iterator[tuple[str, type[T]]]:
    """Yield the classes that installed packages register in a group, with where each is from."""
    from importlib.metadata import entry_points

    for entry in entry_points(group=group):
        package = "" if entry.dist is None else f" of the installed package {entry.dist.name}"
        where = f"entry point {entry.name} = {entry.value} in {group}{package}"
        try:
            kind = entry.load()
        except Exception as error:  # a module of somebody else may raise anything
            raise StickslipError(
                f"{where} cannot be imported: {type(error).__name__}: {error}. Correct or remove"
                " it."
            ) from error
        if not (isinstance(kind, type) and issubclass(kind, base)):
            raise StickslipError(f"{where} must be a class derived from {base.__name__}.")
        yield where, kind


TURNED = {
    "m": "rad",
    "m/s": "rad/s",
    "N": "N m",
    "kg": "kg m^2",
    "N/m": "N m/rad",
    "N s/m": "N m s/rad",
    "N s^2/m^2": "N m s^2/rad^2",
    "1/m": "1/rad",
    "N/s": "N m/s",
    "N s": "N m s",
    "N/(m s)": "N m/(rad s)",
    "N/K": "N m/K",
    "s/m": "s/rad",
    "1/N": "1/N/m",
    "1/N^2": "1/N^2/m^2",
}
"""Units of a straight motion -> those of the same quantities about an axis."""


def turned(unit: str, turning: bool = True) -> str:
    """Return the unit of the same quantity about an axis; as it is where nothing is `turning`.

    Examples
    --------
    >>> turned("N s/m"), turned("1"), turned("m", turning=False)
    ('N m s/rad', '1', 'm')
    """
    return TURNED.get(unit, unit) if turning else unit


def __dir__() -> list[str]:
    return sorted(__all__)
