"""Parameter files of controllers and servos, and all formats of model files by name."""

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final

import numpy as np

from stickslip.errors import InputError
from stickslip.exports.applying import models
from stickslip.exports.applying.markup import Edit, root_of
from stickslip.exports.joints import JointFriction, SmoothFriction, compared, steady_of
from stickslip.exports.program import Subject
from stickslip.friction import LAWS, FrictionLaw
from stickslip.quantities import named
from stickslip.show.display import require_library
from stickslip.show.documents import check_xml, read_bytes
from stickslip.show.formatting import quantity

# Parameter files of ROS 2, in YAML: controllers that make up for friction.

ARRAYS: Final = ("fp1", "fp2", "fp3")
"""Parameters of a smooth friction compensation, each with an entry for each joint."""
FEED_FORWARD: Final = "ff_velocity_scale"
"""Torque per wanted velocity of a trajectory controller."""
CALLED: Final = "the controller"


class Ros2(models.Model):
    """Parameters of the nodes of ROS 2."""

    name: ClassVar[str] = "ros2"
    title: ClassVar[str] = "YAML of ROS 2"
    program: ClassVar[str] = "ROS 2"
    refuses: ClassVar[Mapping[str, str]] = MappingProxyType(
        {**models.ONE_DAMPING, "holds": "has no friction at rest"}
    )

    @classmethod
    def recognises(cls, path: Path, data: bytes) -> bool:
        return path.suffix.lower() in (".yaml", ".yml")

    @cached_property
    def nodes(self) -> Sequence[tuple[str, Mapping[str, Any]]]:
        """Parameters of nodes by name, as nodes of YAML."""
        yaml = require_library("yaml", "ros")
        try:
            text = self.data.decode("utf-8")
            root = yaml.compose(text, Loader=yaml.SafeLoader)
            aliases = [token for token in yaml.scan(text) if isinstance(token, yaml.AliasToken)]
        except (yaml.YAMLError, UnicodeDecodeError, RecursionError):
            raise InputError(f"{self.path} is not YAML.") from None
        if aliases:
            line = aliases[0].start_mark.line + 1
            raise InputError(
                f"{self.path} has an alias in line {line}, which ROS 2 does not read: write what it"
                " stands for."
            )
        found = [*_node_parameters("", root)]
        if not found:
            raise InputError(f"{self.path} has no ros__parameters, so it has none of a ROS 2 node.")
        return found

    def joints(self) -> Iterator[models.ModelJoint]:
        for node, parameters in self.nodes:
            names = _texts(parameters.get("joints"))
            friction = _yaml_members(parameters.get("friction"))
            gains = _yaml_members(parameters.get("gains"))
            for i, name in enumerate(names):
                place: dict[str, Any] = {}
                if friction:
                    place = {
                        f"{node}.friction.{key}[{i}]": friction[key].value[i]
                        for key in ARRAYS
                        if key in friction and len(_texts(friction[key])) == len(names)
                    }
                elif "effort" in _texts(parameters.get("command_interfaces")):
                    own = _yaml_members(gains.get(name))
                    if FEED_FORWARD in own:
                        place = {f"{node}.gains.{name}.{FEED_FORWARD}": own[FEED_FORWARD]}
                if len(place) in (1, len(ARRAYS)):
                    yield models.ModelJoint(
                        name=name,
                        kind="either",
                        line=parameters["joints"].start_mark.line + 1,
                        place=(place, parameters.get("use_friction")),
                        given={key: (setting.value, "") for key, setting in place.items()},
                    )

    def elsewhere(self, name: str) -> str:
        for node, parameters in self.nodes:
            if name in _texts(parameters.get("joints")):
                return (
                    f"{self.path}: joint {name!r} of {node} has no friction to be written: neither"
                    f" friction.{', '.join(ARRAYS)} with an entry for each joint, nor"
                    f" gains.{name}.{FEED_FORWARD} with effort among the command_interfaces."
                )
        return ""

    def carry(
        self,
        joint: models.ModelJoint,
        subject: Subject,
        beside: models.Beside,
        wishes: models.Wishes,
    ) -> models.Carried:
        steady = steady_of(subject)
        v, force = steady.velocity, steady.force + beside.damping * steady.velocity
        steady, (place, use) = replace(steady, force=force), joint.place
        lost: tuple[str, ...] = tuple(models.of_damper(subject, beside))
        law: JointFriction | SmoothFriction
        if len(place) == 1:
            damping = max(0.0, float(v @ force) / float(v @ v))
            law = JointFriction(level=0.0, damping=damping)
            values = [damping]
        else:
            steepness = self._steepness(place)
            shape = np.tanh(0.5 * steepness * v)
            height = max(0.0, 2.0 * float(shape @ force) / float(shape @ shape))
            law = SmoothFriction(height=height, steepness=steepness)
            values = [height, steepness, 0.0]
            if use is None or use.value.lower() not in ("true", "yes", "on"):
                lost += ("use_friction is not true: the controller leaves friction as it is.",)
        near = compared(subject, steady, law, CALLED)
        return models.Carried(
            values=dict(zip(place, map(_real, values), strict=True)),
            near=near,
            lost=(*lost, *near.lost),
        )

    def _steepness(self, place: Mapping[str, Any]) -> float:
        name = next(key for key in place if ".fp2[" in key)
        try:
            found = float(place[name].value)
        except ValueError:
            found = 0.0
        if not 0.0 < found < float("inf"):
            raise InputError(
                f"{self.path}: {name} must be above 0 s/rad, got {place[name].value}: it is the"
                " inverse of the speed within which the compensation grows, and stays as it is."
            )
        return found

    def edits(self, joint: models.ModelJoint, values: Mapping[str, str]) -> list[Edit]:
        place, _ = joint.place
        return [
            Edit(self._byte(one.start_mark), self._byte(one.end_mark), values[key].encode("ascii"))
            for key, one in place.items()
        ]

    def _byte(self, mark: Any) -> int:
        return len(self.data.decode("utf-8")[: mark.index].encode("utf-8"))


def _real(value: float) -> str:
    """Return a number as all of ROS 2 reads it for a double: with a point, without an exponent."""
    text = format(Decimal(models.number(value)), "f")
    return text if "." in text else f"{text}.0"


def _yaml_members(node: Any) -> Mapping[str, Any]:
    """Return the members of a mapping of YAML; none of anything else."""
    pairs = node.value if node is not None and node.id == "mapping" else ()
    return {str(key.value): value for key, value in pairs}


def _texts(node: Any) -> Sequence[str]:
    """Return the scalars of a list of YAML; none of anything else."""
    items = node.value if node is not None and node.id == "sequence" else ()
    return [str(item.value) for item in items if item.id == "scalar"]


def _node_parameters(name: str, node: Any) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the parameters of nodes below a node of YAML, with the names of both."""
    for key, value in _yaml_members(node).items():
        if key == "ros__parameters":
            yield name, _yaml_members(value)
        elif value is not None and value.id == "mapping":
            yield from _node_parameters(key.strip("/"), value)


# Parameters of a servo as Rhoban/bam has them, in JSON: the motor and one of six gear laws.

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


class Bam(models.Model):
    """A file of parameters of a servo."""

    name: ClassVar[str] = "bam"
    title: ClassVar[str] = "JSON of Rhoban/bam"
    program: ClassVar[str] = "Rhoban/bam"
    refuses: ClassVar[Mapping[str, str]] = models.ONE_DAMPING

    @classmethod
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
        return dict(_json_members(self.text))

    def joints(self) -> Iterator[models.ModelJoint]:
        name = str(self.members["actuator"][0])
        given = {
            key: (self.text[start:end].strip('"'), "")
            for key, (_, start, end) in self.members.items()
            if key in NAMES
        }
        yield models.ModelJoint(name=name, kind="hinge", line=1, place=None, given=given)

    def has_exactly(self, subject: Subject) -> bool:
        return gear_law(subject.law) is not None

    def carry(
        self,
        joint: models.ModelJoint,
        subject: Subject,
        beside: models.Beside,
        wishes: models.Wishes,
    ) -> models.Carried:
        values, lost = _of_motor(beside)
        law = gear_law(subject.law)
        if law is not None and not wishes.holds:
            model, near = MODELS[law.name], None
            friction = dict(_gear_parameters(law, subject.needed_load()))
            friction["friction_viscous"] += beside.damping
            lost = (*models.of_damper(subject, beside), *lost)
        else:
            model = "m1"
            found, near, left = models.level_and_damping(subject, beside, wishes)
            friction = {"friction_base": found.level, "friction_viscous": found.damping[0]}
            lost = (*left, *lost)
        stays = [
            key for key in (*LEVELS, *SPEEDS, SURPLUS) if key in joint.has and key not in friction
        ]
        if stays:
            lost += (f"{model.upper()} does not read {', '.join(stays)}, which stay as they were.",)
        written = {key: models.number(value) for key, value in (*friction.items(), *values.items())}
        return models.Carried(values={**written, "model": model}, near=near, lost=lost)

    def edits(self, joint: models.ModelJoint, values: Mapping[str, str]) -> list[Edit]:
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
            text = "".join(f",{space}{name}" for name in added)
            found.append(Edit(place, place, text.encode("ascii")))
        return found

    def _byte(self, place: int) -> int:
        return len(self.text[:place].encode("utf-8"))


def _json_members(text: str) -> Iterator[tuple[str, tuple[Any, int, int]]]:
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
        for containment in LAWS[name].contained:
            values = containment.embed(law) if containment.law == law.name else None
            if values is None:
                continue
            found = LAWS[name](**values)
            if not found.inputs and _same(found, law):
                return found
    return None


def _same(found: FrictionLaw, law: FrictionLaw) -> bool:
    """Return whether laws agree; an option such as a level of its own at rest may be in neither."""
    forces = [
        [member.break_away(1.0), *(member.steady(v, 1.0) for v in SPEEDS_COMPARED)]
        for member in (found, law)
    ]
    return all(math.isclose(a, b, rel_tol=1e-12) for a, b in zip(*forces, strict=True))


def _gear_parameters(law: FrictionLaw, load: float) -> Iterator[tuple[str, float]]:
    """Yield the parameters of a law by the names of the file."""
    for name, own in LEVELS.items():
        if hasattr(law, own):
            yield name, load * getattr(law, own)
    if hasattr(law, "static_coefficient"):
        yield SURPLUS, load * (law.static_coefficient - getattr(law, LEVELS["friction_base"]))
    for name, own in SPEEDS.items():
        if hasattr(law, own):
            yield name, getattr(law, own)


def _of_motor(beside: models.Beside) -> tuple[Mapping[str, float], tuple[str, ...]]:
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


# The formats of model files by name.

CONSUMERS: Final[Mapping[str, type[models.Model]]] = MappingProxyType(
    {item.name: item for item in (models.Urdf, models.Mjcf, models.Physx, models.Newton, Bam, Ros2)}
)
"""What laws can be applied to."""


XML: Final = (".xml", ".urdf", ".mjcf", ".xacro")
"""Names of files that are XML, or should be."""


def read_model(path: Path, to: str | None = None) -> models.Model:
    """Read a file in the format that it seems to have, or in a named one."""
    data = read_bytes(path)
    fitting = [consumer for consumer in CONSUMERS.values() if consumer.recognises(path, data)]
    if to is not None:
        wanted: type[models.Model] = named(CONSUMERS, to, "format")
        if wanted not in fitting:
            raise InputError(f"{path} is no file of {wanted.title}.")
        return wanted(path, data)
    if len(fitting) > 1:
        choices = " or ".join(f"--to {kind.name}, {kind.title}" for kind in fitting)
        raise InputError(f"{path} has room for friction of several programs: choose by {choices}.")
    if not fitting:
        raise _unknown(path, data)
    return fitting[0](path, data)


def _unknown(path: Path, data: bytes) -> InputError:
    if data.startswith((b"PXR-USDC", b"PK")):
        return InputError(f"{path} is binary USD: write it as text first, with usdcat -o new.usda.")
    root = root_of(data)
    if root or path.suffix.lower() in XML:
        check_xml(data, str(path))
        return InputError(
            f"{path} has the root <{root}>; a URDF file has <robot>, an MJCF file <mujoco>."
        )
    known = "; ".join(consumer.title for consumer in CONSUMERS.values())
    return InputError(f"{path} is none of the files that friction can be written into: {known}.")
