"""Writes friction of laws into joints of a model file, and says what that leaves of them."""

import json
import math
import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from stickslip import mechanisms
from stickslip.data import Rig
from stickslip.errors import InputError, UnknownNameError
from stickslip.exports.applying import models
from stickslip.exports.applying.markup import Edit, root_of
from stickslip.exports.applying.models import Beside, Carried, Model, ModelJoint, Wishes
from stickslip.exports.joints import JointFriction, SmoothFriction, compared, steady_of
from stickslip.exports.program import Subject
from stickslip.exports.verb import Usage, evaluated, law_or_rig, subject_of
from stickslip.friction import LAWS, FrictionLaw
from stickslip.quantities import Given, named, turned
from stickslip.show.described import Described
from stickslip.show.display import require_library
from stickslip.show.documents import check_xml, read_bytes, write_file
from stickslip.show.formatting import joined, quantity

if TYPE_CHECKING:
    from stickslip.exports.verb import Exported


# Parameter files of controllers and servos, and all formats of model files by name.

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
            if not found.inputs and _same_parameters(found, law):
                return found
    return None


def _same_parameters(found: FrictionLaw, law: FrictionLaw) -> bool:
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


# Writes friction of laws into joints of a model file, and says what that leaves of them.


@dataclass(frozen=True, kw_only=True)
class AppliedJoint(metaclass=Described):
    """A joint with its new friction, and what that leaves of the law."""

    joint: str
    """Name of the joint in the file."""
    contact: str
    """Whose law it has, where contacts have laws of their own."""
    law: str
    """Name of the law."""
    before: Mapping[str, str]
    """Attributes that the file gave it."""
    after: Mapping[str, str]
    """Attributes that were written."""
    largest_speed: float | None
    """End of the range of speeds over which both are compared [m/s] or [rad/s]; None where the file
    has the law itself."""
    rms: float
    """Root mean square of the difference of the steady friction, over speeds from 0 to the end of
    the range in both directions, all alike [N] or [N m]."""
    largest: float
    """Largest difference there [N] or [N m]."""
    rotary: bool
    """Whether it turns."""
    lost: tuple[str, ...]
    """What the file cannot have of the law, in sentences."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """Attributes, error of the friction and what is lost, in words."""
        unit, speed = turned("N", self.rotary), turned("m/s", self.rotary)
        values = " ".join(f'{key}="{value}"' for key, value in self.after.items())
        before = " ".join(f'{key}="{value}"' for key, value in self.before.items())
        error = (
            "The file has the law itself: the error of the friction is 0."
            if self.largest_speed is None
            else f"Error of the friction up to {quantity(self.largest_speed, speed)}:"
            f" {quantity(self.rms, unit)} rms, {quantity(self.largest, unit)} at most."
        )
        return (f"{values}; before: {before or 'none'}.", error, *self.lost)

    def to_dict(self) -> Mapping[str, Any]:
        """Return the joint as plain values."""
        return {
            "joint": self.joint,
            "contact": self.contact,
            "law": self.law,
            "before": dict(self.before),
            "after": dict(self.after),
            "largest_speed": self.largest_speed,
            "rms": self.rms,
            "largest": self.largest,
            "unit": turned("N", self.rotary),
            "lost": list(self.lost),
        }


@dataclass(frozen=True, kw_only=True, repr=False)
class Applied(metaclass=Described):
    """A model file with friction; made by `apply`."""

    path: Path
    """The file that was read."""
    target: str
    """What reads it, such as ``"urdf"`` or ``"mjcf"``."""
    content: bytes
    """The file with friction, equal to the one that was read but for the joints' attributes."""
    joints: tuple[AppliedJoint, ...]
    """What was written, joint by joint."""
    remarks: tuple[str, ...] = ()
    """What concerns the file as a whole, in sentences."""

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the file, whole or not at all.

        Parameters
        ----------
        path : str or Path
            Where to; its folder is made if needed.
        force : bool
            Whether a file may be replaced, such as the one that was read.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            If there is such a file, or it cannot be written.
        """
        check_output(self.path, Path(path), force=force)
        write_file(Path(path), self.content)
        return Path(path)

    def to_dict(self) -> Mapping[str, Any]:
        """Return what was written as plain values."""
        return {
            "target": self.target,
            "input": str(self.path),
            "joints": [joint.to_dict() for joint in self.joints],
            "remarks": list(self.remarks),
        }

    def __repr__(self) -> str:
        return f"<Applied {self.target}: {', '.join(joint.joint for joint in self.joints)}>"


def check_output(source: Path, path: Path, *, force: bool) -> None:
    """Refuse to replace a file, before any work."""
    if path.is_dir():
        raise InputError(f"{path} is a folder, but a file is written: give its name.")
    if force or not os.path.lexists(path):
        return
    same = source.exists() and path.exists() and path.samefile(source)
    what = "is the file that is read" if same else "already exists"
    raise InputError(
        f"{path} {what}; give --force (in Python force=True) to replace it, or another -o."
    )


def apply(
    source: "Exported",
    file: str | Path,
    *,
    joints: str | Collection[str] | Mapping[str, str] | None = None,
    law: str | None = None,
    load: float | None = None,
    largest_speed: Given | None = None,
    law_load: float | None = None,
    at: Mapping[str, Given | Mapping[str, Given]] | None = None,
    to: str | None = None,
    polynomial: bool = False,
    holds: bool = False,
) -> Applied:
    """Write friction laws into the joints of a model file, and change nothing else in it.

    Files are URDF, MJCF, USD as text for PhysX (Isaac Sim) or Newton, the parameters of a servo in
    Rhoban/bam's JSON, and parameters of ROS 2 controllers in YAML. The level and the damping of a
    joint are those that come closest to the law, by least squares over speeds up to the largest in
    both directions; a damper of the law's mechanism is added.

    Parameters
    ----------
    source : FrictionLaw, Fit, Verdict or Rig
        The law, or what has it: of a verdict it is the law to use. `load_rig` reads a ``law.toml``.
        Contacts with laws of their own go to the joints with their names.
    file : str or Path
        The file with the joints.
    joints : str, collection of str, or mapping of str to str, optional
        Joints that get the law; or, by contact, the joint that gets its law. If not given, all
        contacts with a law, or the only joint of the file.
    law : str, optional
        Which of the laws of a rig.
    load : float, optional
        Normal force [N] at which the joint has its friction, as in `export`.
    largest_speed : float or str, optional
        End of the range of speeds; that of the fit if not given.
    law_load : float, optional
        Normal force [N] at which the law was fitted, if its levels are forces.
    at : mapping of str to float, str or mapping, optional
        Contact inputs of the laws at which the joints have their friction: by name for all laws
        that depend on them, and by contact and name for one.
    to : str, optional
        What reads the file: ``"urdf"``, ``"mjcf"``, ``"physx"``, ``"newton"``, ``"bam"`` or
        ``"ros2"``. Needed for USD only, which PhysX and Newton both read.
    polynomial : bool
        Of MJCF, whether the damping changes with the speed (MuJoCo 3.7 and later). Off by default.
    holds : bool
        Whether the level is that of break-away, so that the joint holds what the law holds. By
        default it is the one that comes closest to the law while sliding.

    Returns
    -------
    Applied
        The file with friction, and what it leaves of the laws.

    Raises
    ------
    InputError
        If the file cannot be read, has no such joint, or the joint does not take the law.

    Examples
    --------
    >>> from importlib.resources import files
    >>> from stickslip import CoulombViscous
    >>> arm = files("stickslip.mechanisms") / "desk_arm.urdf"
    >>> law = CoulombViscous(kinetic_coefficient=0.3, viscous_coefficient=0.1)
    >>> found = apply(law, arm, joints="elbow", largest_speed=2.0)
    >>> found.joints[0].sentences[0]
    'damping="0.1" friction="0.3"; before: friction="0.15" damping="0.02".'
    """
    model = read_model(Path(file), to)
    wishes = Wishes(polynomial=polynomial, holds=holds)
    _check_wishes(model, wishes)
    given = Usage(law=law, load=load, largest_speed=largest_speed, law_load=law_load)
    rows: dict[str, AppliedJoint] = {}
    values: list[tuple[ModelJoint, Mapping[str, str]]] = []
    source = law_or_rig(source)
    by_contact = source.contacts.items() if isinstance(source, Rig) else ()
    pairs = _pairs([name for name, known in by_contact if known is not None], model, joints)
    shared, own = _stated(at or {}, [contact for contact, _ in pairs])
    unasked = dict(shared)
    for contact, name in pairs:
        joint = model.joint(name)
        if name in rows:
            raise InputError(f"joint {name!r} is named twice; it has one friction.")
        usage = replace(given, contact=contact or None)
        if isinstance(source, FrictionLaw):
            usage = replace(usage, rotary=joint.rotary is not False)
        whole = subject_of(source, model.title, usage, evaluates=False, rig=None)
        # of several laws, each takes what it depends on
        known = {k: x for k, x in shared.items() if len(pairs) == 1 or k in whole.law.inputs}
        unasked = {k: x for k, x in unasked.items() if k not in known}
        stated = {**known, **own.get(contact, {})}
        exact = not stated and model.has_exactly(whole)
        subject = whole if exact else evaluated(whole, model.title, stated)
        _check_kind(model, joint, subject)
        beside = _beside(subject.mechanism, subject.contact)
        carried = model.carry(joint, subject, beside, wishes)
        values.append((joint, carried.values))
        rows[name] = _applied(joint, contact, subject, carried)
    if unasked:
        raise InputError(f"no law of these joints depends on {joined(list(unasked))}.")
    return Applied(
        path=Path(file),
        target=model.name,
        content=model.written(values),
        joints=tuple(rows.values()),
        remarks=tuple(model.remarks()),
    )


def _check_wishes(model: Model, wishes: Wishes) -> None:
    for name, instead in model.refuses.items():
        if getattr(wishes, name):
            raise InputError(f"{model.title} {instead}: leave {name} (--{name}) out.")


def _pairs(
    contacts: Sequence[str], model: Model, joints: str | Collection[str] | Mapping[str, str] | None
) -> list[tuple[str, str]]:
    """Return contacts and the joints that get their laws; without contacts, empty names."""
    chosen = [joints] if isinstance(joints, str) else joints
    if chosen is not None and not chosen:
        raise InputError("joints is empty: leave it out, or name at least one.")
    if not contacts:
        if isinstance(chosen, Mapping):
            raise InputError(
                f"this is one law and not laws by contact, so there is no"
                f" {', '.join(map(repr, chosen))}: name joints alone."
            )
        names = model.movable if chosen is None else list(chosen)
        if chosen is None and len(names) != 1:
            raise InputError(
                f"{model.path} has {len(names)} joints that take friction"
                f" ({', '.join(names) or 'none with a name'}), and this is one law: choose with"
                " --joint (in Python joints)."
            )
        return [("", name) for name in names]
    if isinstance(chosen, Mapping):
        pairs = dict(chosen)
    else:
        wanted = model.movable if chosen is None else list(chosen)
        pairs = {contact: name for name in wanted for contact in contacts if _same(contact, name)}
        missing = [name for name in chosen or () if name not in pairs.values()]
        if missing:
            raise InputError(
                f"no contact has the name of the joint {missing[0]!r}; contacts with a law:"
                f" {', '.join(contacts)}. Pair them, as --joint {contacts[0]}={missing[0]}"
                f" (in Python joints={{{contacts[0]!r}: {missing[0]!r}}})."
            )
        if chosen is None:
            for contact in contacts:
                pairs.setdefault(contact, contact)  # refused with the names of the joints
    for contact in pairs:
        if contact not in contacts:
            raise InputError(
                f"no contact {contact!r} has a law; those that do: {', '.join(contacts)}."
            )
    return list(pairs.items())


def _same(contact: str, joint: str) -> bool:
    """Return whether a contact has the name of a joint, as robots give it to theirs."""
    if contact == joint:
        return True
    try:
        return mechanisms.RobotJoint(joint=joint, mass=1.0).contact_name == contact
    except InputError:  # a name without letters
        return False


def _check_kind(model: Model, joint: ModelJoint, subject: Subject) -> None:
    if joint.rotary is not None and subject.rotary != joint.rotary:
        what = "turns" if joint.rotary else "slides"
        raise InputError(
            f"{model.path}: joint {joint.name!r} {what}, but the law is of a mechanism that"
            f" {'turns' if subject.rotary else 'slides'}, with friction in"
            f" {turned('N', subject.rotary)}: choose another joint; of an axis, rotary in"
            " [mechanism] says which it is."
        )


def _beside(mechanism: mechanisms.Mechanism | None, contact: str) -> Beside:
    """Return the damper, the motor and its inertia at a joint."""
    if isinstance(mechanism, mechanisms.Axis | mechanisms.Pendulum):
        motor = mechanism.drive if isinstance(mechanism.drive, mechanisms.DCMotor) else None
        inertia = float(mechanisms.driving_inertia(mechanism.drive))
        return Beside(damping=mechanism.damping, armature=inertia or None, motor=motor)
    if isinstance(mechanism, mechanisms.Robot):
        for joint in mechanism.joints:
            if contact in ("", joint.contact_name):
                if joint.coupling:
                    raise InputError(
                        f"friction of {joint.joint!r} acts along a motor that other joints turn too"
                        " (coupling), and that of a joint in a file along its own angle: choose the"
                        " other joints with --joint."
                    )
                inertia = max(0.0, joint.armature + joint.added_armature)
                return Beside(damping=joint.damping, armature=inertia or None)
    if isinstance(mechanism, mechanisms.SerialArm):
        names = [place.name for place in mechanism.contacts()]
        link = mechanism.links[names.index(contact) if contact else 0]
        inertia = link.rotor_inertia * link.gear_ratio**2
        return Beside(damping=link.damping, armature=inertia or None)
    return Beside()


def _stated(
    at: Mapping[str, Given | Mapping[str, Given]], contacts: Sequence[str]
) -> tuple[dict[str, Given], dict[str, Mapping[str, Given]]]:
    """Return contact inputs that are stated for all laws, and those for the law of a contact."""
    shared: dict[str, Given] = {}
    own: dict[str, Mapping[str, Given]] = {}
    for name, value in at.items():
        if not isinstance(value, Mapping):
            shared[name] = value
        elif name in contacts:
            own[name] = value
        else:
            raise UnknownNameError(
                "contact with inputs of its own", name, [*filter(None, contacts)]
            )
    return shared, own


def _applied(joint: ModelJoint, contact: str, subject: Subject, carried: Carried) -> AppliedJoint:
    near = carried.near
    return AppliedJoint(
        joint=joint.name,
        contact=contact,
        law=subject.law.name,
        before=joint.has,
        after=carried.values,
        largest_speed=None if near is None else near.largest_speed,
        rms=0.0 if near is None else near.rms,
        largest=0.0 if near is None else near.largest,
        rotary=subject.rotary,
        lost=carried.lost,
    )
