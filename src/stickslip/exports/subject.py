"""What is exported: a law, how well it is known, and where it is from."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib.metadata import version
from typing import Final, final

from stickslip.errors import InputError
from stickslip.experiments import LawEstimates, Levels, Rig
from stickslip.exports.equations import Equations, equations_of
from stickslip.exports.program import Constant
from stickslip.formatting import parameter_words, printable
from stickslip.friction import FrictionLaw
from stickslip.identification import inputs_text
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, turned

LOAD_TEXT: Final = {
    "per load": "Levels are over the normal force: the load is the normal force in N.",
    "torques per load": "Levels are friction torques over the normal force, in N m per N: the load"
    " is the normal force in N.",
    "forces": "Levels are forces in N, because no normal force was known: the load is 1.",
    "torques": "Levels are torques in N m, because no normal force was known: the load is 1.",
}
JOINT_TEXT: Final = {
    "forces": "Levels are forces in N: the load is 1.",
    "torques": "Levels are torques in N m: the load is 1.",
}
"""The same of joints, which no normal force presses together."""


@final
@dataclass(frozen=True, kw_only=True)
class Subject:
    """A law that is exported."""

    law: FrictionLaw
    """The law with its values."""
    name: str
    """Name of the program, which all languages accept."""
    estimates: LawEstimates | None = None
    """How well it is known, if its file says so."""
    mechanism: Mechanism | None = None
    """The mechanism on which it was fitted, if there is one."""
    contact: str = ""
    """Which contact of the mechanism has it, where there are several."""
    rotary: bool = False
    """Whether the contact slips by an angle, so that friction is a torque."""
    levels: Levels = "per load"
    """What levels of the law are."""
    source: str = ""
    """Where it is from, in words; empty if it was given as an object."""
    load: float | None = None
    """Normal force [N] at which tables and joints have their friction, if it is known."""
    at: Mapping[str, float] = field(default_factory=dict)
    """Contact inputs at which they have it, by name."""
    largest_speed: float | None = None
    """End of the range of use [m/s] or [rad/s], if it is known."""
    rig: Rig | None = None
    """A rig on which the effect of a simplification is computed."""
    own_rig: Rig | None = None
    """The rig of the law's file, which stands in for it where a run of it is possible and moves."""

    @cached_property
    def equations(self) -> Equations:
        """The equations of the law."""
        return equations_of(self.law)

    def unit(self, quantity: Quantity) -> str:
        """Return the unit in which a parameter of the law reads."""
        unit = quantity.unit if self.levels == "per load" else quantity.force_unit
        return turned(unit, self.rotary)

    def constants(self) -> tuple[Constant, ...]:
        """Return the parameters with units and with how well they are known."""
        return tuple(
            Constant(
                name=one.identifier,
                value=one.value,
                unit=self.unit(one.quantity),
                meaning=", ".join(filter(None, (parameter_words(one.name), self.known(one.name)))),
            )
            for one in self.equations.parameters
        )

    def known(self, name: str) -> str:
        """Return how well a parameter is known, in words; empty where nothing is said of it."""
        known = self.estimates
        if known is None:
            return ""
        if name in known.intervals:
            low, high = known.intervals[name]
            return f"{known.interval}: {low:.6g} to {high:.6g}"
        if name in known.not_identified:
            return f"not identified: {printable(known.not_identified[name])}"
        return "not fitted" if name in known.not_fitted else ""

    def header(self) -> Iterator[str]:
        """Yield what every target says of the law, line by line."""
        title, release = printable(self.law.title), version("stickslip")
        yield f"{title} friction ({printable(self.law.name)}), exported by stickslip {release}."
        if self.source:
            yield f"Source: {printable(self.source)}"
        yield f"Law (LaTeX): {printable(self.law.formula)}"
        yield "Parameters in SI units:"
        for one in self.constants():
            yield f"  {one.name} = {one.value!r} [{one.unit}] ({one.meaning})"
        ratio = self.levels == "per load"
        if ratio or self.has_normal_force:
            yield LOAD_TEXT["torques per load" if ratio and self.rotary else self.levels]
        else:
            yield JOINT_TEXT[self.levels]
        if self.estimates is not None and self.estimates.largest_speed is not None:
            unit = turned("m/s", self.rotary)
            yield (
                f"Fitted at speeds up to {self.estimates.largest_speed:.6g} {unit}; the law is"
                " extrapolated beyond."
            )

    @property
    def has_normal_force(self) -> bool:
        """Whether a normal force presses the contact together, known or not; joints have none."""
        if self.mechanism is None:
            return self.levels != "torques"  # a law itself, of a rotary joint
        return hasattr(self.mechanism, "load")

    @property
    def at_text(self) -> str:
        """The contact inputs at which tables and joints have their friction, in words."""
        return inputs_text(self.at, turning=self.rotary)

    def needed_load(self) -> float:
        """Return the load of tables and joints."""
        if self.load is not None:
            return self.load
        raise InputError(
            "this target has friction at one normal force, and that of the law's mechanism is not"
            ' known: give it, as --load "50 N" (in Python load=50.0).'
        )

    def needed_speed(self) -> float:
        """Return the end of the range of use [m/s] or [rad/s]."""
        if self.largest_speed is not None:
            return self.largest_speed
        unit = turned("m/s", self.rotary)
        raise InputError(
            "this target has friction over a range of speeds, and neither the law's file nor a rig"
            f' says which: give its end, as --largest-speed "0.5 {unit}" (in Python'
            " largest_speed=0.5)."
        )
