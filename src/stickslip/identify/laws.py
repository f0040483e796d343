r"""From a structure and its coefficients to a law of `stickslip.friction`, and back to parameters.

A kind of measurement says which composition a structure is: the text of its law and the values of
its parameters, one for each draw. What no composition can say, such as the measured curve, becomes
a law through measured levels (``table[...]``).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.friction import FrictionLaw
from stickslip.friction import law as law_class
from stickslip.quantities import Quantity

Array: TypeAlias = NDArray[np.float64]
Shape: TypeAlias = tuple[float, ...]

POINTS = 24
"""Points of a law through measured levels."""


@final
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
        found: FrictionLaw = law_class(self.text)(**values)
        return found

    def paths(self) -> dict[str, Array]:
        """Return what was fitted (d,) by path."""
        own = {f"friction.{name}": x for name, x in self.values.items() if name not in self.fixed}
        return {**own, **self.rig}


FLOWS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "viscous": ("viscous_coefficient", ()),
    "power": ("viscous_coefficient", ("viscous_exponent",)),
    "saturating": ("viscous_coefficient", ("saturation_velocity",)),
    "drag": ("quadratic_coefficient", ()),
}
"""Parts beside the level: the parameter of their coefficient, and those of their shape."""
SURPLUSES = ("stribeck", "stribeck_sides")
"""Terms of a static surplus; the latter has another one for each direction."""
DIRECTIONS = ("level_direction", "viscous_direction", "stribeck_sides")
"""Terms that differ by direction."""


def compose(
    terms: Mapping[str, tuple[Shape, Array]],
    means: Mapping[str, float],
    *,
    memory: str = "",
    memory_values: Mapping[str, Array] | None = None,
) -> Composition:
    """Return the law that terms are together.

    Parameters
    ----------
    terms : mapping of str to (shape, array (d, size))
        By name, the shape without exponents of the load, and the coefficients of each draw in units
        of the law's parameters. Terms that are no part of a law are left out.
    means : mapping of str to float
        Inputs of the contact at which the coefficients hold; changes with them are straight lines.
    memory : str
        Bristles around the level, such as ``"dahl"``.
    memory_values : mapping of str to array (d,), optional
        Their parameters.

    Returns
    -------
    Composition
        Without a text if no law of `stickslip.friction` has these values.

    Examples
    --------
    >>> terms = {"level": ((), np.array([[2.0]])), "viscous": ((), np.array([[0.5]]))}
    >>> compose(terms, {}).law()
    CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=0.5)
    """
    count = len(next(iter(terms.values()))[1]) if terms else 1

    def first(name: str, column: int = 0) -> Array:
        return terms[name][1][:, column] if name in terms else np.zeros(count)

    def linear(part: str) -> tuple[str, Array]:
        """Return a part with its changes with inputs, and what they take off where these are 0."""
        text, off = part, np.zeros(count)
        for name, mean in means.items():
            if f"{part}*{name}" in terms:
                text, off = f"{text} * linear[{name}]", off + mean * first(f"{part}*{name}")
        return text, off

    values: dict[str, Array] = {}
    fixed: set[str] = set()
    smooth = "tanh" in terms
    level_text, level_off = linear("level")
    kinetic = first("tanh" if smooth else "level") - level_off
    levels = {"kinetic_coefficient": kinetic}
    texts = [level_text] if smooth or "level" in terms else []
    if not texts:
        fixed.add("kinetic_coefficient")
    surplus = next((name for name in SURPLUSES if name in terms), "step" if "step" in terms else "")
    if surplus:
        shape = terms[surplus][0]
        texts = [level_text, "step" if surplus == "step" else "stribeck"]
        levels["static_coefficient"] = kinetic + first(surplus)
        if surplus != "step":
            values["stribeck_velocity"] = np.full(count, shape[0])
            values["fading_exponent"] = np.full(count, shape[1])
            fixed.add("fading_exponent")
    if "logarithmic" in terms:
        texts.append("logarithmic")
        values["logarithmic_coefficient"] = first("logarithmic")
        values["reference_velocity"] = np.full(count, terms["logarithmic"][0][0])
    text = " + ".join(texts)
    if smooth:
        text = f"tanh({text})"
        values["smoothing_velocity"] = np.full(count, terms["tanh"][0][0])
    if memory and text:
        text = f"{memory}({text})"
        values |= memory_values or {}
    slopes: dict[str, Array] = {}
    flow = next((name for name in ("power", "saturating", "viscous") if name in terms), "")
    flows = [text] if text else []
    for name, (parameter, shapes) in FLOWS.items():
        if name in terms:
            part, off = linear(name)
            flows.append(part)
            into = slopes if parameter == "viscous_coefficient" else values
            into[parameter] = first(name) - off
            values |= {k: np.full(count, x) for k, x in zip(shapes, terms[name][0], strict=False)}
    for name in means:
        for part, own in (("level", kinetic), ("viscous", slopes.get("viscous_coefficient"))):
            if f"{part}*{name}" in terms and own is not None:
                values[f"{part}_{name}_slope"] = first(f"{part}*{name}") / np.where(own, own, 1.0)
    text = " + ".join(flows) or "level"
    difference = {
        "kinetic_coefficient": first("level_direction"),
        "static_coefficient": first("level_direction")
        + (first("stribeck_sides", 1) if "stribeck_sides" in terms else 0.0),
        "viscous_coefficient": first("viscous_direction"),
    }
    both = any(name in terms for name in DIRECTIONS)
    for name, x in {**levels, **slopes}.items():
        if both:
            values[f"forward_{name}"] = x + difference[name]
            values[f"backward_{name}"] = x - difference[name]
        elif name != "kinetic_coefficient" or "level" in text:
            values[name] = x
    if both:
        text = f"both_ways[levels]({text})"
        doubled = law_class(text).__dataclass_fields__
        for name in [one for one in values if one not in doubled]:
            x = values.pop(name)
            values |= {f"forward_{name}": x, f"backward_{name}": x}
    least = {name: x for name, x in values.items() if name.endswith("_coefficient")}
    if surplus and np.any(levels["static_coefficient"] < kinetic):
        text = ""  # a surplus below 0 is no part of a law
    if any(np.any(x < 0.0) for x in least.values()):
        text = ""
    return Composition(text=text, values=values, fixed=frozenset(fixed), flow=flow)


def curve_law(speed: Array, force: Array, load: float) -> FrictionLaw:
    """Return the law through levels at speeds (n,), constant beyond them.

    Examples
    --------
    >>> law = curve_law(np.array([0.1, 1.0]), np.array([2.0, 3.0]), 1.0)
    >>> float(law.force(1.0, 1.0))
    3.0
    """
    level = np.asarray(force, dtype=float) / load
    level = np.maximum(level, 1e-9 * max(float(np.max(np.abs(level))), 1e-300))
    points = ", ".join(f"{u:.6g}: {f:.6g}" for u, f in zip(speed, level, strict=True))
    found: FrictionLaw = law_class(f"table[{points}]")()
    return found


RIG_QUANTITIES: Mapping[str, Quantity] = {
    "offset": Quantity("F_0", "N"),
    "drift": Quantity("d", "1"),
    "load_exponent": Quantity("a", "1"),
    "run_spread": Quantity("s_r", "1"),
}
"""Symbols and units of what is no parameter of a law or mechanism."""
