"""Parameters of a servo as Rhoban/bam has them, in JSON: the motor and one of six gear laws."""

import json
import math
import re
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final, final

from typing_extensions import override

from stickslip.errors import InputError
from stickslip.exports.applying.edits import Edit
from stickslip.exports.applying.models import (
    ONE_DAMPING,
    Beside,
    Carried,
    Model,
    ModelJoint,
    Wishes,
    level_and_damping,
    number,
    of_damper,
)
from stickslip.exports.subject import Subject
from stickslip.formatting import quantity
from stickslip.friction import LAWS, FrictionLaw

LEVELS: Final = MappingProxyType(
    {
        "friction_base": "kinetic_coefficient",
        "load_friction_base": "transmitted_coefficient",
        "load_friction_stribeck": "transmitted_static_surplus",
        "load_friction_motor": "motor_friction",
        "load_friction_external": "external_friction",
        "load_friction_motor_stribeck": "motor_static_friction",
        "load_friction_external_stribeck": "external_static_friction",
        "load_friction_motor_quad": "motor_quadratic",
        "load_friction_external_quad": "external_quadratic",
    }
)
"""Parameters over the load, by the names of the file."""
SPEEDS: Final = MappingProxyType(
    {
        "dtheta_stribeck": "stribeck_velocity",
        "alpha": "fading_exponent",
        "friction_viscous": "viscous_coefficient",
    }
)
"""Parameters that do not depend on the load."""
MODELS: Final = MappingProxyType({f"bam-m{i}": f"m{i}" for i in range(1, 7)})
"""Laws that the file has, with what it calls them; the simplest first."""
SPEEDS_COMPARED: Final = (0.001, 0.01, 0.1, 1.0, 10.0)
"""At which a law of another name is one of these [rad/s]."""
SURPLUS: Final = "friction_stribeck"
NAMES: Final = frozenset((*LEVELS, *SPEEDS, SURPLUS, "kt", "R", "armature", "model"))
MEMBER: Final = re.compile(r'\s*("(?:\\.|[^"\\])*")\s*:\s*')


@final
class Bam(Model):
    """A file of parameters of a servo."""

    name: ClassVar[str] = "bam"
    title: ClassVar[str] = "JSON of Rhoban/bam"
    program: ClassVar[str] = "Rhoban/bam"
    refuses: ClassVar[Mapping[str, str]] = ONE_DAMPING

    @classmethod
    @override
    def recognises(cls, path: Path, data: bytes) -> bool:
        return path.suffix.lower() == ".json"

    @cached_property
    def text(self) -> str:
        """The text of the file."""
        try:
            return self.data.decode("utf-8")
        except UnicodeDecodeError:
            raise InputError(f"{self.path} is not in UTF-8.") from None

    @cached_property
    def members(self) -> Mapping[str, tuple[Any, int, int]]:
        """Values of the file by name, with the characters between which they stand."""
        try:
            whole = json.loads(self.text)
        except (ValueError, RecursionError):
            raise InputError(f"{self.path} is not JSON.") from None
        if not isinstance(whole, dict) or not {"model", "actuator"} <= whole.keys():
            raise InputError(
                f'{self.path} has no "model" and "actuator": files of parameters of Rhoban/bam,'
                " such as params/xl330/m1.json, have both."
            )
        return dict(_members(self.text))

    @override
    def joints(self) -> Iterator[ModelJoint]:
        name = str(self.members["actuator"][0])
        given = {
            key: (self.text[start:end].strip('"'), "")
            for key, (_, start, end) in self.members.items()
            if key in NAMES
        }
        yield ModelJoint(name=name, kind="hinge", line=1, place=None, given=given)

    @override
    def has_exactly(self, subject: Subject) -> bool:
        return gear_law(subject.law) is not None

    @override
    def carry(self, joint: ModelJoint, subject: Subject, beside: Beside, wishes: Wishes) -> Carried:
        values, lost = _of_motor(beside)
        law = gear_law(subject.law)
        if law is not None and not wishes.holds:
            model, near = MODELS[law.name], None
            friction = dict(_parameters(law, subject.needed_load()))
            friction["friction_viscous"] += beside.damping
            lost = (*of_damper(subject, beside), *lost)
        else:
            model = "m1"
            found, near, left = level_and_damping(subject, beside, wishes)
            friction = {"friction_base": found.level, "friction_viscous": found.damping[0]}
            lost = (*left, *lost)
        stays = [
            key for key in (*LEVELS, *SPEEDS, SURPLUS) if key in joint.has and key not in friction
        ]
        if stays:
            lost += (f"{model.upper()} does not read {', '.join(stays)}, which stay as they were.",)
        written = {key: number(value) for key, value in (*friction.items(), *values.items())}
        return Carried(values={**written, "model": model}, near=near, lost=lost)

    @override
    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[Edit]:
        found, added = [], []
        for key, value in values.items():
            text = json.dumps(value) if key == "model" else value
            if key in self.members:
                _, start, end = self.members[key]
                found.append(Edit(self._byte(start), self._byte(end), text.encode("ascii")))
            else:
                added.append(f'"{key}": {text}')
        if added:
            first, (_, _, last) = self.text.index("{") + 1, [*self.members.values()][-1]
            between = re.match(r"\s*", self.text[first:])
            assert between is not None  # it may be empty
            place, space = self._byte(last), between[0] or " "
            text = "".join(f",{space}{one}" for one in added)
            found.append(Edit(place, place, text.encode("ascii")))
        return found

    def _byte(self, place: int) -> int:
        return len(self.text[:place].encode("utf-8"))


def _members(text: str) -> Iterator[tuple[str, tuple[Any, int, int]]]:
    """Yield the members of an object, each value with where it stands."""
    decoder, place = json.JSONDecoder(), text.index("{") + 1
    while found := MEMBER.match(text, place):
        value, end = decoder.raw_decode(text, found.end())
        yield json.loads(found[1]), (value, found.end(), end)
        comma = re.compile(r"\s*,?").match(text, end)
        assert comma is not None  # it may be empty
        place = comma.end()


def gear_law(law: FrictionLaw) -> FrictionLaw | None:
    """Return a law as one of the six, if it is one of them by this name or another."""
    if law.name in MODELS:
        return law
    for name in MODELS:
        for one in LAWS[name].contained:
            values = one.embed(law) if one.law == law.name else None
            if values is None:
                continue
            found = LAWS[name](**values)
            if not found.inputs and _same(found, law):
                return found
    return None


def _same(found: FrictionLaw, law: FrictionLaw) -> bool:
    """Return whether laws agree; an option such as a level of its own at rest may be in neither."""
    forces = [
        [one.break_away(1.0), *(one.steady(v, 1.0) for v in SPEEDS_COMPARED)]
        for one in (found, law)
    ]
    return all(math.isclose(a, b, rel_tol=1e-12) for a, b in zip(*forces, strict=True))


def _parameters(law: FrictionLaw, load: float) -> Iterator[tuple[str, float]]:
    """Yield the parameters of a law by the names of the file."""
    for name, own in LEVELS.items():
        if hasattr(law, own):
            yield name, load * getattr(law, own)
    if hasattr(law, "static_coefficient"):
        yield SURPLUS, load * (law.static_coefficient - getattr(law, LEVELS["friction_base"]))
    for name, own in SPEEDS.items():
        if hasattr(law, own):
            yield name, getattr(law, own)


def _of_motor(beside: Beside) -> tuple[Mapping[str, float], tuple[str, ...]]:
    """Return the values of the motor at the shaft of the servo, and what they leave of it."""
    motor, found = beside.motor, dict[str, float]()
    lost: tuple[str, ...] = ()
    if motor is not None:
        found |= {"kt": motor.gear_ratio * motor.torque_constant, "R": motor.resistance}
        if motor.back_emf != motor.torque_constant:
            lost = (
                f"The back-EMF constant is taken to be the torque constant, and was"
                f" {quantity(motor.gear_ratio * motor.back_emf, 'V s/rad')} at the shaft.",
            )
    if beside.armature is not None:
        found["armature"] = beside.armature
    return found, lost
