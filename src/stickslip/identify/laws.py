r"""From a structure and its coefficients to a law of `stickslip.friction`, and back to parameters.

A kind of measurement says which composition a structure is: the text of its law and the values of
its parameters, one for each draw. What no composition can say, such as the measured curve, becomes
a law through measured levels (``table[...]``).
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, SetValuedLaw, curve_through, monotone_slopes
from stickslip.friction import law as law_class
from stickslip.maths import Scalar
from stickslip.quantities import Parametrised, Quantity, fields_of

Array: TypeAlias = NDArray[np.float64]
Shape: TypeAlias = tuple[float, ...]

POINTS = 24
"""Points of a law through measured levels."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Composition:
    """A law with its parameters for each of some draws."""

    text: str
    """Notation of the law; empty if it is none of `stickslip.friction`."""
    values: Mapping[str, Array]
    """Parameters of the law (d,) by name."""
    rig: Mapping[str, Array] = field(default_factory=dict)
    """Properties of rig and record (d,) by path, such as ``"mechanism.inertia"``."""
    fixed: frozenset[str] = frozenset()
    """Names in `values` that were not fitted."""
    flow: str = ""
    """Part that has the viscous coefficient: of other parts, it is another quantity."""

    def law(self, draw: int = 0) -> FrictionLaw | None:
        """Return the law of one draw; None if there is none."""
        if not self.text:
            return None
        values = {name: float(x[draw]) for name, x in self.values.items()}
        try:
            found: FrictionLaw = law_class(self.text)(**values)
        except InputError:  # such as friction at rest below that of sliding, in one direction
            return None
        return found

    def paths(self) -> dict[str, Array]:
        """Return what was fitted (d,) by path."""
        own = {f"friction.{name}": x for name, x in self.values.items() if name not in self.fixed}
        return {**own, **self.rig}


def bounds_of(text: str, name: str) -> tuple[float, float]:
    """Return the range in which a parameter of a law is looked for.

    Examples
    --------
    >>> bounds_of("power", "viscous_exponent")
    (0.2, 1.5)
    """
    bounds = fields_of(law_class(text))[name].bounds
    assert bounds is not None
    return bounds


TITLES: Mapping[str, str] = {
    "level": "level",
    "viscous": "viscous friction",
    "saturating": "viscous friction that saturates",
    "level_direction": "level that differs by direction",
    "viscous_direction": "viscous friction that differs by direction",
    "stribeck": "static surplus that fades (Stribeck)",
    "stribeck_direction": "static surplus that differs by direction",
    "power": "power of the speed",
    "drag": "drag with the square of the speed",
    "offset": "constant offset",
    "adhesion": "level that no load changes",
    "curve": "curve as measured",
    "jump": "jump at a speed",
}
"""What terms are called that several kinds of measurements have."""
CHANGING: Mapping[str, str] = {
    "level": "level that changes with the {}",
    "viscous": "viscous friction that changes with the {}",
}
"""The same of terms that change with an input of the contact."""
FLOWS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "viscous": ("viscous_coefficient", ()),
    "power": ("viscous_coefficient", ("viscous_exponent",)),
    "saturating": ("viscous_coefficient", ("saturation_velocity",)),
    "drag": ("quadratic_coefficient", ()),
}
"""Parts beside the level: the parameter of their coefficient, and those of their shape."""
SURPLUSES = ("stribeck", "stribeck_sides", "step")
"""Terms of a static surplus; the second has another one for each direction."""
DIRECTIONS = ("level_direction", "viscous_direction", "stribeck_sides")
"""Terms that differ by direction."""


def compose(
    terms: Mapping[str, tuple[Shape, Array]],
    means: Mapping[str, float],
    count: int,
    *,
    memory: str = "",
    memory_values: Mapping[str, Array] | None = None,
    memory_fixed: Collection[str] = (),
) -> Composition:
    """Return the law that terms are together.

    Examples
    --------
    >>> terms = {"level": ((), np.array([[2.0]])), "viscous": ((), np.array([[0.5]]))}
    >>> compose(terms, {}, 1).law().force(0.1, 1.0)
    2.05
    """
    made = _Composer(terms, means, count)
    made.level(memory, memory_values or {})
    made.fixed |= {*memory_fixed}
    made.flows()
    made.inputs()
    return made.composition()


class _Composer:
    """A composition in the making: parts, levels, slopes and other values."""

    def __init__(
        self, terms: Mapping[str, tuple[Shape, Array]], means: Mapping[str, float], count: int
    ) -> None:
        self.terms, self.means, self.count = terms, means, count
        self.parts: list[str] = []
        self.levels: dict[str, Array] = {}
        self.slopes: dict[str, Array] = {}
        self.values: dict[str, Array] = {}
        self.fixed: set[str] = set()

    def first(self, name: str, column: int = 0) -> Array:
        """Return a coefficient of a term (d,); 0 without it."""
        return self.terms[name][1][:, column] if name in self.terms else np.zeros(self.count)

    def shape(self, term: str, *names: str) -> None:
        """Give the entries of a term's shape their names."""
        for name, value in zip(names, self.terms[term][0], strict=False):
            self.values[name] = np.full(self.count, value)

    def linear(self, part: str) -> tuple[str, Array]:
        """Return a part with its changes with inputs, and what they take off where these are 0."""
        text, off = part, np.zeros(self.count)
        for name, mean in self.means.items():
            if f"{part}*{name}" in self.terms:
                text, off = f"{text} * linear[{name}]", off + mean * self.first(f"{part}*{name}")
        return text, off

    def level(self, memory: str, memory_values: Mapping[str, Array]) -> None:
        """Compose the level: its surplus, its sign, and the bristles around it."""
        smooth = "tanh" in self.terms
        text, off = self.linear("level")
        kinetic = self.first("tanh" if smooth else "level") - off
        self.levels["kinetic_coefficient"] = kinetic
        parts = [text] if smooth or "level" in self.terms else []
        if not parts:
            self.fixed.add("kinetic_coefficient")
        surplus = next((name for name in SURPLUSES if name in self.terms), "")
        if surplus:
            parts = [text, "step" if surplus == "step" else "stribeck"]
            self.levels["static_coefficient"] = kinetic + self.first(surplus)
            self.shape(surplus, "stribeck_velocity", "fading_exponent")
            self.fixed.add("fading_exponent")
        if "logarithmic" in self.terms:
            parts.append("logarithmic")
            self.values["logarithmic_coefficient"] = self.first("logarithmic")
            self.shape("logarithmic", "reference_velocity")
        if "gear" in self.terms:
            parts.append("weight[transmitted]")
            self.values["transmitted_coefficient"] = self.first("gear")
        text = " + ".join(parts)
        if smooth:
            text = f"tanh({text})"
            self.shape("tanh", "smoothing_velocity")
        if memory and text:
            text = f"{memory}({text})"
            self.values |= memory_values
        self.parts = [text] if text else []

    def flows(self) -> None:
        """Compose what stands beside the level."""
        for name, (parameter, shapes) in FLOWS.items():
            if name in self.terms:
                text, off = self.linear(name)
                self.parts.append(text)
                into = self.slopes if parameter == "viscous_coefficient" else self.values
                into[parameter] = self.first(name) - off
                self.shape(name, *shapes)

    def inputs(self) -> None:
        """Give changes with inputs as shares of what changes."""
        owners = {
            "level": self.levels["kinetic_coefficient"],
            "viscous": self.slopes.get("viscous_coefficient", np.ones(self.count)),
        }
        for name in self.means:
            for part, own in owners.items():
                if f"{part}*{name}" in self.terms:
                    change = self.first(f"{part}*{name}") / np.where(own, own, 1.0)
                    self.values[f"{part}_{name}_slope"] = change

    def directions(self, text: str) -> str:
        """Give levels and slopes of both directions; return the text."""
        difference = {
            "kinetic_coefficient": self.first("level_direction"),
            "static_coefficient": self.first("level_direction"),
            "viscous_coefficient": self.first("viscous_direction"),
        }
        if "stribeck_sides" in self.terms:
            own = difference["static_coefficient"] + self.first("stribeck_sides", 1)
            difference["static_coefficient"] = own
        for name, x in {**self.levels, **self.slopes}.items():
            self.values[f"forward_{name}"] = x + difference[name]
            self.values[f"backward_{name}"] = x - difference[name]
        text = f"both_ways[levels]({text})"
        if not _is_law(text):  # bristles stand around directions, not within
            return ""
        doubled = law_class(text).__dataclass_fields__
        for name in [one for one in self.values if one not in doubled]:
            x = self.values.pop(name)
            if f"forward_{name}" in doubled:
                self.values |= {f"forward_{name}": x, f"backward_{name}": x}
        return text

    def composition(self) -> Composition:
        """Return the law; without a text if it has none of these values."""
        text = " + ".join(self.parts) or "level"
        if any(name in self.terms for name in DIRECTIONS):
            text = self.directions(text)
        else:
            levels = self.levels if "level" in text else {}
            self.values |= {**levels, **self.slopes}
        lacks = any(
            bool(np.any(self.values[name] < self.values[name.replace("static", "kinetic")]))
            for name in self.values
            if name.endswith("static_coefficient")
        )
        positive = [x for name, x in self.values.items() if name.endswith("_coefficient")]
        if lacks or any(np.any(x < 0.0) for x in positive):
            text = ""
        text = text if text and _is_law(text) else ""
        flow = next((name for name in ("power", "saturating", "viscous") if name in self.terms), "")
        return Composition(text=text, values=self.values, fixed=frozenset(self.fixed), flow=flow)


def _is_law(text: str) -> bool:
    """Return whether parts can stand together in a law."""
    try:
        law_class(text)
    except InputError:
        return False
    return True


@dataclass(frozen=True, kw_only=True)
class CurvePoint(Parametrised):
    """A point of a measured curve."""

    speed: Annotated[float, Quantity("v", "m/s", above=0)]
    """Its speed."""
    level: Annotated[float, Quantity("mu", above=0)]
    """Friction over the normal force there."""
    slope: Annotated[float, Quantity("mu'", "s/m")]
    """Slope of the curve there."""


@dataclass(frozen=True, kw_only=True)
class MeasuredCurve(SetValuedLaw):
    """The law ``table[...]`` with its points as parameters: draws of one curve share their kernels.

    Examples
    --------
    >>> law = MeasuredCurve.through(np.array([0.1, 1.0]), np.array([2.0, 3.0]))
    >>> law.force(1.0, 1.0), law.break_away(2.0)
    (3.0, 4.0)
    """

    name: ClassVar[str] = "measured-curve"
    title: ClassVar[str] = "Measured curve"
    formula: ClassVar[str] = r"F = c\, \mu(|v|)\, N"
    sources: ClassVar[tuple[str, ...]] = ()

    points: tuple[CurvePoint, ...]
    """Between them are cubics without overshoot; beyond them it is constant."""
    curve_factor: Annotated[
        float,
        Quantity("c", low=0, scale="none", bounds=(0.1, 10.0), start=1.0, per_load=True),
    ] = 1.0
    """Factor on the measured levels."""

    @classmethod
    def through(cls, speeds: Array, levels: Array) -> "MeasuredCurve":
        """Return the curve through levels at rising speeds (n,)."""
        pairs = list(zip(speeds.tolist(), levels.tolist(), strict=True))
        each = zip(pairs, monotone_slopes(pairs), strict=True)
        points = [CurvePoint(speed=v, level=mu, slope=slope) for (v, mu), slope in each]
        return cls(points=tuple(points))

    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        pairs = [(one.speed, one.level) for one in self.points]
        slopes = [one.slope for one in self.points]
        return self.curve_factor * curve_through(pairs, slopes, speed) * load

    def break_away(self, load: Scalar) -> Scalar:
        return self.curve_factor * self.points[0].level * load


def drawn_curve(speed: Array, force: Array, load: float) -> FrictionLaw:
    """Return the law of `curve_law` with its points as parameters, if it has none at rest.

    Examples
    --------
    >>> law = drawn_curve(np.array([0.1, 1.0]), np.array([2.0, 3.0]), 1.0)
    >>> law.name, float(law.force(1.0, 1.0))
    ('measured-curve', 3.0)
    """
    if np.min(speed) <= 0.0:
        return curve_law(speed, force, load)
    return MeasuredCurve.through(np.asarray(speed), _levels(force, load))


def _levels(force: Array, load: float) -> Array:
    """Return levels over the load that are above 0."""
    level = np.asarray(force, dtype=float) / load
    return np.maximum(level, 1e-9 * max(float(np.max(np.abs(level))), 1e-300))


def curve_law(speed: Array, force: Array, load: float) -> FrictionLaw:
    """Return the law through levels at speeds (n,), constant beyond them.

    Examples
    --------
    >>> law = curve_law(np.array([0.1, 1.0]), np.array([2.0, 3.0]), 1.0)
    >>> float(law.force(1.0, 1.0))
    3.0
    """
    level = _levels(force, load)
    points = ", ".join(f"{u:.6g}: {f:.6g}" for u, f in zip(speed, level, strict=True))
    found: FrictionLaw = law_class(f"table[{points}]")()
    return found


RIG_QUANTITIES: Mapping[str, Quantity] = {
    "offset": Quantity("F_0", "N"),
    "drift": Quantity("d", "N"),
    "load_exponent": Quantity("a", "1"),
    "adhesion": Quantity("F_a", "N"),
    "offset_drift": Quantity("d_0", "N"),
    "viscous_drift": Quantity("d_2", "N s/m"),
    "spring": Quantity("k", "N/m"),
    "bow": Quantity("b", "N/m^2"),
    "ripple": Quantity("F_r", "N"),
    "mechanism": Quantity("g", "1"),
    "lag": Quantity("t_l", "s"),
    "delay": Quantity("t_d", "s"),
    "latency": Quantity("t_l", "s"),
    "hose": Quantity("k_h", "N/m"),
    "clip": Quantity("F_max", "N"),
    "backlash": Quantity("x_b", "m"),
    "flexible": Quantity("f_0", "Hz"),
    "inertia_error": Quantity("Delta_J", "kg"),
    "force_gain": Quantity("g", "1"),
    "position_scale": Quantity("g", "1"),
    "dead_zone": Quantity("F_d", "N"),
    "gear_direction": Quantity("mu_d", "1"),
}
"""Symbols and units of what is no parameter of a law or mechanism."""
RATIOS: Mapping[str, str] = {
    "mechanism": "they are {} times those given",
    "force_gain": "force and friction as recorded are {} times what acts",
    "position_scale": "ways and speeds are {} times those recorded, by which friction is stated",
}
"""Terms whose size is a ratio, 1 where what is given is right: what it is, in words."""
