r"""From a structure and its coefficients to a law of `stickslip.friction`, and back to parameters.

A kind of measurement says which composition a structure is: the text of its law and the values of
its parameters, one for each draw. What no composition can say, such as the measured curve, becomes
a law through measured levels (``table[...]``).
"""

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, SetValuedLaw, bound, curve_through, monotone_slopes
from stickslip.friction import law as law_class
from stickslip.identify.own_laws import OwnLaw, is_own, is_slope
from stickslip.maths import Scalar, where
from stickslip.quantities import Parametrised, Quantity, fields_of

Array: TypeAlias = NDArray[np.float64]
Shape: TypeAlias = tuple[float, ...]

POINTS = 24
"""Points of a law through measured levels, of each direction."""
LINEAR, FALLS, FALLING = "viscous_coefficient", "polynomial[1]", "speed_coefficient_1"
"""The coefficient of a viscous part, and that of a part in which it may be below 0."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Sliding:
    """Friction of a structure in steady sliding in both directions, without its rig."""

    velocity: Array
    """Rising velocities (n,), each in both directions [m/s] or [rad/s]."""
    friction: Array
    """Friction (n,) [N] or [N m]."""

    def levels(self, load: float) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Return rising speeds (k,) and levels above 0 (k,) over a load, forwards and backwards."""
        level = np.sign(self.velocity) * self.friction / load
        level = np.maximum(level, 1e-9 * max(float(np.max(np.abs(level))), 1e-300))
        half = len(level) // 2
        speeds = self.velocity[half:]
        return (speeds, level[half:]), (speeds, level[:half][::-1])

    def off(self, law: FrictionLaw, composed: "Composition") -> float:
        """Return how far the friction of a law is off at most [N] or [N m]."""
        force = bound(law, composed.inputs).steady(self.velocity, composed.normal())
        return float(np.max(np.abs(force - self.friction)))

    def brakes(self, law: FrictionLaw, composed: "Composition") -> bool:
        """Return whether a law takes energy at ten times these velocities: runs may go there."""
        far = 10.0 * self.velocity
        force = bound(law, composed.inputs).steady(far, composed.normal())
        return bool(np.all(force * far >= 0.0))


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
    instead: str = ""
    """Notation of a law that slides as the terms do where `text` is none of them all: one whose
    linear part may fall."""
    load: Array | float = 1.0
    """Normal force (d,) over which its levels are [N]."""
    inputs: Mapping[str, float] = field(default_factory=dict)
    """Means of the inputs that its terms depend on."""
    memory: str = ""
    """Notation of the memory around its levels; empty without any."""
    own: OwnLaw | None = None
    """The law, where it is no sum of the vocabulary's parts."""

    @property
    def kind(self) -> type[FrictionLaw] | None:
        """The type of the law; None if it is none."""
        if self.own is not None:
            return type(self.own.law)
        return law_class(self.text) if self.text else None

    @property
    def untold(self) -> tuple[str, ...]:
        """Names of parameters that nothing tells."""
        return () if self.own is None else self.own.untold

    def normal(self) -> float:
        """Return the normal force of the first draw [N]."""
        return float(np.ravel(self.load)[0])

    def law(self, draw: int = 0) -> FrictionLaw | None:
        """Return the law of one draw; None if there is none."""
        if self.own is not None:
            return self.own.at([float(self.values[name][draw]) for name in self.own.varied])
        for text in filter(None, (self.text, self.instead)):
            names = law_class(text).__dataclass_fields__
            own = {name: float(x[draw]) for name, x in self.values.items()}
            if not own.keys() <= names.keys():
                own = {name.replace(LINEAR, FALLING): x for name, x in own.items()}
            with suppress(InputError):  # such as friction at rest below that of sliding
                result: FrictionLaw = law_class(text)(**own)
                return result
        return None

    def through(self, sliding: Sliding) -> FrictionLaw:
        """Return the law through levels in steady sliding, with the memory of this one."""
        stiff = self.memory and self.values["bristle_stiffness"][0] > 0.0
        kind = curve_law(sliding, self.normal(), f"{self.memory}({{}})" if stiff else "{}")
        names = kind.__dataclass_fields__
        return kind(**{name: float(x[0]) for name, x in self.values.items() if name in names})

    def paths(self) -> dict[str, Array]:
        """Return what was fitted (d,) by path."""
        own = {f"friction.{name}": x for name, x in self.values.items() if name not in self.fixed}
        return {**own, **self.rig}


def own_composition(
    structure: Sequence[tuple[str, tuple[Array | float, ...]]], coefficients: Array
) -> Composition:
    """Return the law that terms with coefficients (k, p) are, without what stands beside it."""
    first = next(name for name, _ in structure if is_slope(name))
    values = {
        name.own.varied[name.place]: coefficients[:, at]
        for at, (name, _) in enumerate(structure)
        if is_slope(name) and name.place >= 0
    }
    still = {
        name: np.full(len(coefficients), first.own.beside(name, values))
        for name in first.own.untold
        if name not in values
    }
    return Composition(text="", values=values | still, own=first.own)


def composed_over(
    structure: Sequence[tuple[str, tuple[Array | float, ...]]], coefficients: Array, normal: Array,
    means: Mapping[str, float],
) -> Composition:  # fmt: skip
    """Return the law that a structure with coefficients (k, p) is over normal forces (k,).

    `means` are those of inputs of the contact.
    """
    if is_own(structure):
        result = replace(own_composition(structure, coefficients), inputs=means)
    else:
        terms: dict[str, tuple[Any, Array]] = {
            name: (shape, (c if name in FLOWS else c / normal)[:, None])
            for (name, shape), c in zip(structure, coefficients.T, strict=True)
        }
        result = compose(terms, means, len(coefficients))
    return replace(result, load=normal)


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
    "stribeck_sides": "static surplus that differs by direction",
    "hersey": "static surplus that fades with speed over load (Hersey number)",
    "power": "power of the speed",
    "power_direction": "power of the speed that differs by direction",
    "tanh": "level that is smooth in the velocity (tanh)",
    "logarithmic": "logarithm of the speed",
    "gear": "share of what the gear transmits",
    "drag": "drag with the square of the speed",
    "offset": "constant offset",
    "adhesion": "level that no load changes",
    "curve": "curve as measured",
}
"""What terms are called."""
CHANGING: Mapping[str, str] = {
    "level": "level that changes with the {}",
    "viscous": "viscous friction that changes with the {}",
}
"""The same of terms that change with an input of the contact."""


def term_title(term: str) -> str:
    """Return what a term is called in a sentence.

    Examples
    --------
    >>> term_title("viscous"), term_title("level*temperature")
    ('viscous friction', 'level that changes with the temperature')
    """
    part, _, of = term.partition("*")
    return CHANGING[part].format(of) if of else TITLES.get(term, term.rpartition(".")[2])


FLOWS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "viscous": ("viscous_coefficient", ()),
    "power": ("viscous_coefficient", ("viscous_exponent",)),
    "saturating": ("viscous_coefficient", ("saturation_velocity",)),
    "drag": ("quadratic_coefficient", ()),
}
"""Parts beside the level: the parameter of their coefficient, and those of their shape."""
SURPLUSES = ("stribeck", "stribeck_sides", "step")
"""Terms of a static surplus; the second has another one for each direction."""
DIRECTIONS = ("level_direction", "viscous_direction", "power_direction", "stribeck_sides")
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

    Their coefficients are those of the parts of laws, levels over the load; what changes with an
    input is 0 at its mean.

    Examples
    --------
    >>> terms = {"level": ((), np.array([[2.0]])), "viscous": ((), np.array([[0.5]]))}
    >>> compose(terms, {}, 1).law().force(0.1, 1.0)
    2.05
    >>> terms = {"level": ((), np.array([[2.0]])), "viscous_direction": ((), np.array([[0.5]]))}
    >>> compose(terms, {}, 1).law().force(-0.1, 1.0)
    -1.95
    """
    made = _Composer(terms, means, count)
    made.level()
    made.flows()
    result = made.composition(memory)
    values = {**result.values, **(memory_values or {})} if result.memory else result.values
    return replace(result, values=values, fixed=result.fixed | {*memory_fixed})


class _Composer:
    """A composition in the making: parts, and the values that they have in a direction."""

    def __init__(
        self, terms: Mapping[str, tuple[Shape, Array]], means: Mapping[str, float], count: int
    ) -> None:
        self.terms, self.means, self.count = terms, means, count
        self.levels: list[str] = []
        self.beside: list[str] = []
        self.values: dict[str, Array] = {}
        """Values of the law that holds in both directions."""
        self.change: dict[str, Array] = {}
        """What levels and slopes are more forwards, and less backwards."""
        self.inputs: dict[str, tuple[str, Array, float]] = {}
        """By factor, what it multiplies, by how much that changes, and the mean of the input."""
        self.fixed: set[str] = set()
        self.used: dict[str, float] = {}
        """Means of the inputs that parts depend on."""
        self.smooth = "tanh" in terms

    def first(self, name: str, column: int = 0) -> Array:
        """Return a coefficient of a term (d,); 0 without it."""
        return self.terms[name][1][:, column] if name in self.terms else np.zeros(self.count)

    def shape(self, term: str, *names: str) -> None:
        """Give the entries of a term's shape their names."""
        for name, value in zip(names, self.terms[term][0], strict=False):
            self.values[name] = np.full(self.count, value)

    def linear(self, part: str, parameter: str) -> str:
        """Return a part with its changes with inputs."""
        for name, mean in self.means.items():
            if f"{part}*{name}" in self.terms:
                change = self.first(f"{part}*{name}")
                self.inputs[f"{part}_{name}_slope"] = parameter, change, mean
                self.used[name] = mean
        factors = [name for name in self.means if f"{part}*{name}" in self.terms]
        return " * ".join([part, *(f"linear[{name}]" for name in factors)])

    def level(self) -> None:
        """Compose the levels."""
        text = self.linear("level", "kinetic_coefficient")
        surplus = next((name for name in SURPLUSES if name in self.terms), "")
        if surplus or {"level", "level_direction", "tanh"} & self.terms.keys():
            self.levels = [text]
            self.values["kinetic_coefficient"] = self.first("tanh" if self.smooth else "level")
            self.change["kinetic_coefficient"] = self.first("level_direction")
        if not (self.smooth or "level" in self.terms):
            self.fixed.add("kinetic_coefficient")
        if surplus:
            self.levels.append("step" if surplus == "step" else "stribeck")
            self.values["static_coefficient"] = self.first(surplus)  # on top of the kinetic one
            if surplus == "stribeck_sides":
                self.change["static_coefficient"] = self.first(surplus, 1)
            self.shape(surplus, "stribeck_velocity", "fading_exponent")
            self.fixed.add("fading_exponent")
        if "logarithmic" in self.terms:
            self.levels.append("logarithmic")
            self.values["logarithmic_coefficient"] = self.first("logarithmic")
            self.shape("logarithmic", "reference_velocity")
            self.fixed.add("reference_velocity")
        if "gear" in self.terms:
            self.levels.append("weight[transmitted]")
            self.used["transmitted"] = self.means["transmitted"]
            self.values["transmitted_coefficient"] = self.first("gear")
        if self.smooth:
            self.shape("tanh", "smoothing_velocity")

    def flows(self) -> None:
        """Compose what stands beside the levels."""
        for name, (parameter, shapes) in FLOWS.items():
            if name in self.terms:
                self.beside.append(self.linear(name, parameter))
                self.values[parameter] = self.first(name)
                self.shape(name, *shapes)
        if "viscous_direction" in self.terms:
            # beside other flows than a viscous one it is a part of its own
            own = LINEAR if "viscous" in self.terms else FALLING
            self.values.setdefault(own, np.zeros(self.count))
            self.change[own] = self.first("viscous_direction")
        if "power_direction" in self.terms:
            self.change[LINEAR] = self.first("power_direction")

    def composition(self, memory: str) -> Composition:
        """Return the law; without a text if it has none of these values."""
        if not (self.levels or self.beside or self.change):  # no friction
            self.levels, self.values["kinetic_coefficient"] = ["level"], np.zeros(self.count)
        memory = memory if self.levels else ""
        text = self.text(memory, falls=FALLING in self.values)
        values, instead = self.by_direction(text), ""
        lacks = any(
            bool(np.any(x < values[name.replace("static", "kinetic")]))
            for name, x in values.items()
            if name.endswith("static_coefficient")
        )
        below = {n for n, x in values.items() if n.endswith("_coefficient") and np.any(x < 0.0)}
        if FALLING in self.values:
            text, instead = "", text
        elif "viscous" in self.beside and all(name.endswith(LINEAR) for name in below):
            instead = self.text(memory, falls=True) if below else ""
        flow = next((name for name in ("power", "saturating", "viscous") if name in self.terms), "")
        return Composition(
            text="" if lacks or below else text,
            instead="" if lacks else instead,
            values=values,
            fixed=frozenset(self.fixed),
            flow=flow,
            inputs=self.used,
            memory=memory,
        )

    def text(self, memory: str, *, falls: bool) -> str:
        """Return the notation, with a linear part that may fall or not; empty if it is none."""
        sides = {name for name in DIRECTIONS if name in self.terms}
        alone = sides == {"viscous_direction"} and FALLING in self.values
        # slopes with inputs are shares of what differs
        both = "both_ways({})" if self.inputs else "both_ways[levels]({})"
        around = both if sides and not alone else "{}"
        levels = " + ".join(
            [f"tanh({item})" if item == "level" and self.smooth else item for item in self.levels]
        )
        beside = [item for item in self.beside if not (falls and item == "viscous")]
        if memory:
            parts = [f"{memory}({around.format(levels)})"]
            rest = " + ".join(beside)
        else:
            parts = []
            rest = " + ".join(filter(None, (levels, *beside)))
        parts += [around.format(rest)] if rest else []
        parts += [f"both_ways({FALLS})" if sides else FALLS] if falls else []
        text = " + ".join(parts)
        # a level that differs by direction does so at once, one that is smooth does not
        return text if _is_law(text) and not (self.smooth and "level_direction" in sides) else ""

    def by_direction(self, text: str) -> dict[str, Array]:
        """Return values of a law (d,) by name, of those that it has twice both.

        A level that changes with inputs has at their means what the terms say, and their slopes
        there: of several inputs the law has a product, and the terms a sum.
        """

        def along(side: float) -> dict[str, Array]:
            result = {
                name: x + side * self.change.get(name, 0.0) for name, x in self.values.items()
            }
            middle = dict(result)
            for name, (of, x, mean) in self.inputs.items():
                share = x / np.where(middle[of], middle[of], 1.0)
                result[of] = result[of] * (1.0 - share * mean)  # where the input is 0
                result[name] = share / np.where(share * mean == 1.0, 1.0, 1.0 - share * mean)
            if "static_coefficient" in result:
                result["static_coefficient"] += result["kinetic_coefficient"]
            return result

        names = law_class(text).__dataclass_fields__ if text else {}
        ahead, back = along(1.0), along(-1.0)
        return {
            key: x
            for name, middle in along(0.0).items()
            for key, x in (
                {f"forward_{name}": ahead[name], f"backward_{name}": back[name]}
                if f"forward_{name}" in names
                else {name: middle}
            ).items()
        }


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
        pairs = [(point.speed, point.level) for point in self.points]
        slopes = [point.slope for point in self.points]
        return self.curve_factor * curve_through(pairs, slopes, speed) * load

    def break_away(self, load: Scalar) -> Scalar:
        return self.curve_factor * self.points[0].level * load


@dataclass(frozen=True, kw_only=True)
class MeasuredCurves(FrictionLaw):
    """A measured curve for each direction, with its points as parameters.

    Examples
    --------
    >>> curve = MeasuredCurve.through(np.array([0.1, 1.0]), np.array([2.0, 3.0]))
    >>> law = MeasuredCurves(forward=curve, backward=replace(curve, curve_factor=2.0))
    >>> law.force(1.0, 1.0), law.force(-1.0, 1.0), law.break_away(1.0)
    (3.0, -6.0, 2.0)
    """

    name: ClassVar[str] = "measured-curves"
    title: ClassVar[str] = "Measured curve by direction"
    formula: ClassVar[str] = r"F = c_\pm\, \mu_\pm(|v|)\, N"
    sources: ClassVar[tuple[str, ...]] = ()
    directional: ClassVar[bool] = True

    forward: MeasuredCurve
    """That of slip forwards."""
    backward: MeasuredCurve
    """That of slip backwards."""

    def force(self, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...] = ()) -> Scalar:
        ahead, back = (item.force(velocity, load) for item in (self.forward, self.backward))
        return where(velocity < 0.0, back, ahead)

    def break_away(self, load: Scalar) -> Scalar:
        ahead, back = (item.break_away(load) for item in (self.forward, self.backward))
        return where(ahead < back, ahead, back)

    def towards(self, direction: int) -> MeasuredCurve:
        return self.forward if direction > 0 else self.backward


def drawn_curve(sliding: Sliding, load: float) -> MeasuredCurve | MeasuredCurves:
    """Return the law of `curve_law` with its points as parameters.

    Examples
    --------
    >>> v = np.array([-1.0, -0.1, 0.1, 1.0])
    >>> law = drawn_curve(Sliding(velocity=v, friction=2.0 * v + np.sign(v)), 1.0)
    >>> law.name, float(law.force(1.0, 1.0))
    ('measured-curve', 3.0)
    """
    ahead, back = (MeasuredCurve.through(*level) for level in sliding.levels(load))
    return ahead if ahead == back else MeasuredCurves(forward=ahead, backward=back)


def curve_law(sliding: Sliding, load: float, memory: str = "{}") -> type[FrictionLaw]:
    """Return the type of laws through levels in each direction, constant beyond them.

    Examples
    --------
    >>> v = np.array([-1.0, -0.1, 0.1, 1.0])
    >>> kind = curve_law(Sliding(velocity=v, friction=np.array([-5.0, -4.0, 2.0, 3.0])), 1.0)
    >>> kind.name
    'table[-1: 5, -1e-1: 4, 1e-1: 2, 1: 3]'
    >>> float(kind().force(-1.0, 1.0))
    -5.0
    """
    texts = [
        [f"{u:.6g}: {f:.6g}" for u, f in zip(*level, strict=True)] for level in sliding.levels(load)
    ]
    ahead, back = texts
    points = ahead if ahead == back else [*(f"-{item}" for item in reversed(back)), *ahead]
    return law_class(memory.format(f"table[{', '.join(points)}]"))


RIG_QUANTITIES: Mapping[str, Quantity] = {
    "offset": Quantity("F_0", "N"),
    "load_exponent": Quantity("a", "1"),
    "adhesion": Quantity("F_a", "N"),
}
"""Symbols and units of what is no parameter of a law or mechanism."""
