"""Columns of a record in SI: by their units, by their gains, and coefficients by the load."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.experiments.measurement import Array, quantity_called
from stickslip.experiments.units import gain_factor, read_gain, read_number
from stickslip.formatting import number
from stickslip.quantities import Quantity
from stickslip.units import factor, is_of

if TYPE_CHECKING:
    from stickslip.experiments.readers.table_reader import Frame

RUBBING: Final = ("friction", "spring_force")
"""Forces that are often written as coefficients, over the load."""
TWICE: Final = 0.01
"""Relative distance at which a gain is taken for the factor of the column's own unit, rounded."""


def gains_of(given: Mapping[str, float | str], known: Iterable[str]) -> dict[str, float | str]:
    """Return gains as numbers, each of a quantity that is known.

    Examples
    --------
    >>> gains_of({"force": 35}, ["time", "force"])
    {'force': 35.0}
    """
    known = list(known)
    found: dict[str, float | str] = {}
    for name, value in given.items():
        found[name] = _gain(name, value)
        if found[name] == 0.0:
            raise ParameterError(
                f"gain.{name} (g) must be a finite number other than 0, got 0: it would set the"
                " whole column to 0."
            )
    for name in found:
        if name not in known:
            raise UnknownNameError("quantity in gain", name, known)
    return found


def _gain(name: str, value: object) -> float | str:
    """Return a gain, checked; a number is one by which a column is multiplied."""
    if not isinstance(value, str):
        return Quantity("g", "").check("gain", name, value)
    try:
        return read_gain(value)
    except ParameterError as error:
        raise ParameterError(f"gain.{name} {error}") from None


def with_motors(
    frame: "Frame", gains: Mapping[str, float | str], constants: Mapping[str, float | str]
) -> tuple["Frame", dict[str, float | str]]:
    """Return a table with currents as forces, and the gains that make forces of them."""
    gains = dict(gains)
    if not constants:
        return frame, gains
    names, units = dict(frame.names), dict(frame.units)
    for current, constant in constants.items():
        force = current.replace("current", "force", 1)
        if current not in names:
            raise InputError(
                f'{frame.file}: motor_constant="{constant}" belongs to a {current}, and there is'
                f' no such column: name it, as columns={{"{current}": "..."}}.'
            )
        if force in names:
            raise InputError(
                f"{frame.file}: {names[force]!r} and {names[current]!r} both give the {force}:"
                " leave out the motor constant, or the column of the force."
            )
        names[force], unit = names.pop(current), units.pop(current) or "A"
        factor_of = _gain(current, gains.pop(current, 1.0))
        if isinstance(factor_of, str):
            raise ParameterError(f"gain.{current} (g) must be a factor without a unit.")
        if isinstance(constant, str):
            number, _, own = constant.strip().partition(" ")
            value = read_number(number, Quantity("K_m")) * factor_of
            gains[force] = f"{value!r} {own.strip()}"
        else:
            gains[force] = constant * factor_of * factor(unit, "A")
        units[force] = unit
    return replace(frame, names=names, units=units), gains


@dataclass(frozen=True, kw_only=True)
class Scaling:
    """How the columns of one file become numbers in SI."""

    frame: "Frame"
    """The table of the file."""
    gains: Mapping[str, float | str]
    """Factors by quantity; with its unit where that makes SI of the column's."""
    load: Array | float | None = None
    """Normal force [N] by which coefficients are multiplied where the file has none."""
    load_offset: float = 0.0
    """Offset of a load in the file [N]."""
    rotary: bool | None = None
    """Whether the mechanism turns, as columns without units then do; None if they decide."""
    motors: Mapping[str, float | str] = field(default_factory=dict)
    """Motor constants by current, which became gains of forces."""

    def scaled(self, raw: Mapping[str, Array]) -> tuple[dict[str, Array], bool]:
        """Return columns (n,) in SI, and whether they are of an axis that turns."""
        targets, turning = self._targets(raw)
        # The load first: coefficients are multiplied by it.
        order = sorted(raw, key=lambda name: name in RUBBING)
        found: dict[str, Array] = {}
        for name in order:
            load = found["load"] - self.load_offset if "load" in found else self.load
            found[name] = self._one(name, raw[name], targets[name], load)
        return {name: found[name] for name in raw}, turning

    def _one(self, name: str, raw: Array, target: str, load: Array | float | None) -> Array:
        unit, gain = self.frame.units.get(name), self.gains.get(name)
        if name in RUBBING and unit is not None and is_of(unit, "1"):
            return self._by_load(name, raw, load, target)
        if gain is None:
            return self.frame.scaled(name, raw, target)
        if isinstance(gain, str):
            return self._in_unit(name, unit, target, gain) * raw
        if unit is None or not is_of(unit, target):  # volts, say: the gain makes SI of them
            return gain * raw
        self._refuse_twice(name, unit, target, gain)
        return gain * self.frame.scaled(name, raw, target)

    def _in_unit(self, name: str, unit: str | None, target: str, gain: str) -> float:
        """Return the factor of a gain with a unit, which the column must have too."""
        if unit is None:
            raise ParameterError(
                f"gain.{name} (g) has a unit, {gain}, but the column has none: add units.{name},"
                " or give the gain as a number."
            )
        try:
            return gain_factor(gain, unit, target)
        except ParameterError:
            motor = self.motors.get(name.replace("force", "current", 1))
            if motor is not None:
                raise ParameterError(self._of_motor(motor, gain, unit, target)) from None
            raise ParameterError(
                f"gain.{name} (g) of {gain} times a column in {unit} is not in {target}: correct"
                " the unit of one of them."
            ) from None

    def _of_motor(self, constant: float | str, gain: str, unit: str, target: str) -> str:
        """Return that a motor constant is not in the unit of the axis, and what it would be."""
        said = f'motor_constant="{constant}" times a current in {unit} is not in {target}:'
        whole = f"{gain.partition(' ')[2]} * {unit}"
        if target == "N" and is_of(whole, "N m"):
            return (
                f"{said} the axis moves along a line and takes N/A. With a screw, give the constant"
                " times 2 pi over its lead in m; with a pulley or pinion, over its radius in m; if"
                " the axis turns, give its position in rad or deg."
            )
        if target == "N m" and is_of(whole, "N"):
            return (
                f"{said} the axis turns and takes N m/A. Give the constant times the radius at"
                " which the force acts, in m; if the axis moves along a line, give its position in"
                " m or mm."
            )
        return f"{said} give it in {target}/A."

    def _by_load(self, name: str, raw: Array, load: Array | float | None, target: str) -> Array:
        """Return a coefficient as a force: by a gain, or by the load. A gain of -1 or 1 is a sign.

        About an axis a load makes forces of coefficients, and only a radius makes torques of these.
        """
        gain = self.gains.get(name)
        if isinstance(gain, str):
            return self._in_unit(name, "1", target, gain) * self.frame.scaled(name, raw, "1")
        if gain is not None and abs(gain) != 1.0:
            return gain * self.frame.scaled(name, raw, "1")
        what = f"{self.frame.file}: column {self.frame.names[name]!r} is a coefficient, in"
        what += f" {self.frame.units[name]}, and {name} is"
        if target != quantity_called(name).unit:
            raise ParameterError(
                f"{what} a torque in {target}: give as its gain the load times the contact radius,"
                f" in {target}."
            )
        if load is None:
            raise ParameterError(
                f"{what} a force in N: give the load as a column in N or in the mechanism, or give"
                f" the load in N as the gain of {name}."
            )
        return np.asarray((gain or 1.0) * self.frame.scaled(name, raw, "1") * load)

    def _refuse_twice(self, name: str, unit: str, target: str, gain: float) -> None:
        scale = factor(unit, target)
        if scale == 1.0 or not math.isclose(abs(gain), scale, rel_tol=TWICE):
            return
        cure = "leave the gain out" if gain > 0.0 else "give the gain as -1"
        raise InputError(
            f"{self.frame.file}: column {self.frame.names[name]!r} is in {unit} and converted to"
            f" {target}; a gain of {number(gain, 6)} would apply this conversion a second time:"
            f" {cure}."
        )

    def _targets(self, names: Iterable[str]) -> tuple[dict[str, str], bool]:
        """Return the SI units of columns: those of an axis that turns, or of a straight one.

        Columns without a gain say which it is; only where they do not, those with one.
        """
        moving = [name for name in names if name != "time"]
        plain = self._kinds(name for name in moving if name not in self.gains)
        kinds = plain or self._kinds(name for name in moving if name in self.gains)
        if len(kinds) == 2:
            raise InputError(
                f"{self.frame.file}: {kinds[True]}, as for a rotary axis, but {kinds[False]}, as"
                " for a linear one: combine angles with torques, such as N m, and lengths with"
                " forces."
            )
        words = {True: "rotary", False: "linear"}
        if self.rotary is not None and (not self.rotary) in kinds:
            raise InputError(
                f"{self.frame.file}: {kinds[not self.rotary]}, as for a {words[not self.rotary]}"
                f" axis, but the mechanism is {words[self.rotary]}: correct the unit of the column"
                " or those of the mechanism."
            )
        turning = True in kinds or bool(self.rotary)
        targets = {"time": "s"}
        for name in moving:
            quantity = quantity_called(name)
            turns = turning and bool(quantity.or_unit)
            targets[name] = quantity.or_unit if turns else quantity.unit
        return targets, turning

    def _kinds(self, names: Iterable[str]) -> dict[bool, str]:
        """Return which column says that the motion turns, and which that it is straight.

        What is of neither kind is no reason to say that kinds differ.
        """
        kinds: dict[bool, str] = {}
        for name in names:
            unit, quantity = self.frame.units.get(name), quantity_called(name)
            gain = self.gains.get(name)
            if unit is not None and isinstance(gain, str):
                unit = f"{gain.partition(' ')[2]} * {unit}"
            if unit is None or not quantity.or_unit:
                continue
            for turns, target in ((True, quantity.or_unit), (False, quantity.unit)):
                if is_of(unit, target):
                    kinds.setdefault(turns, f"{name} is in {unit}")
        return kinds
