"""Parameter files of ROS 2, in YAML: controllers that make up for friction."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final, final

import numpy as np
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
    number,
    of_damper,
)
from stickslip.exports.simplification import JointFriction, SmoothFriction, compared, steady_of
from stickslip.exports.subject import Subject

ARRAYS: Final = ("fp1", "fp2", "fp3")
"""Parameters of a smooth friction compensation, each with an entry for each joint."""
FEED_FORWARD: Final = "ff_velocity_scale"
"""Torque per wanted velocity of a trajectory controller."""
CALLED: Final = "the controller"


@final
class Ros2(Model):
    """Parameters of the nodes of ROS 2."""

    name: ClassVar[str] = "ros2"
    title: ClassVar[str] = "YAML of ROS 2"
    program: ClassVar[str] = "ROS 2"
    refuses: ClassVar[Mapping[str, str]] = MappingProxyType(
        {**ONE_DAMPING, "holds": "has no friction at rest"}
    )

    @classmethod
    @override
    def recognises(cls, path: Path, data: bytes) -> bool:
        return path.suffix.lower() in (".yaml", ".yml")

    @cached_property
    def nodes(self) -> Sequence[tuple[str, Mapping[str, Any]]]:
        """Parameters of nodes by name, as nodes of YAML."""
        try:
            import yaml
        except ImportError:
            raise InputError(
                f"{self.path}: parameters of ROS 2 need the package PyYAML: pip install"
                " 'stickslip[ros]'."
            ) from None
        try:
            text = self.data.decode("utf-8")
            root = yaml.compose(text, Loader=yaml.SafeLoader)
            aliases = [one for one in yaml.scan(text) if isinstance(one, yaml.AliasToken)]
        except (yaml.YAMLError, UnicodeDecodeError, RecursionError):
            raise InputError(f"{self.path} is not YAML.") from None
        if aliases:
            line = aliases[0].start_mark.line + 1
            raise InputError(
                f"{self.path} has an alias in line {line}, which ROS 2 does not read: write what it"
                " stands for."
            )
        found = [*_parameters("", root)]
        if not found:
            raise InputError(f"{self.path} has no ros__parameters, so it has none of a ROS 2 node.")
        return found

    @override
    def joints(self) -> Iterator[ModelJoint]:
        for node, parameters in self.nodes:
            names = _texts(parameters.get("joints"))
            friction = _members(parameters.get("friction"))
            gains = _members(parameters.get("gains"))
            for i, name in enumerate(names):
                place: dict[str, Any] = {}
                if friction:
                    place = {
                        f"{node}.friction.{key}[{i}]": friction[key].value[i]
                        for key in ARRAYS
                        if key in friction and len(_texts(friction[key])) == len(names)
                    }
                elif "effort" in _texts(parameters.get("command_interfaces")):
                    own = _members(gains.get(name))
                    if FEED_FORWARD in own:
                        place = {f"{node}.gains.{name}.{FEED_FORWARD}": own[FEED_FORWARD]}
                if len(place) in (1, len(ARRAYS)):
                    yield ModelJoint(
                        name=name,
                        kind="either",
                        line=parameters["joints"].start_mark.line + 1,
                        place=(place, parameters.get("use_friction")),
                        given={key: (one.value, "") for key, one in place.items()},
                    )

    @override
    def elsewhere(self, name: str) -> str:
        for node, parameters in self.nodes:
            if name in _texts(parameters.get("joints")):
                return (
                    f"{self.path}: joint {name!r} of {node} has no friction to be written: neither"
                    f" friction.{', '.join(ARRAYS)} with an entry for each joint, nor"
                    f" gains.{name}.{FEED_FORWARD} with effort among the command_interfaces."
                )
        return ""

    @override
    def carry(self, joint: ModelJoint, subject: Subject, beside: Beside, wishes: Wishes) -> Carried:
        steady = steady_of(subject)
        v, force = steady.velocity, steady.force + beside.damping * steady.velocity
        steady, (place, use) = replace(steady, force=force), joint.place
        lost: tuple[str, ...] = tuple(of_damper(subject, beside))
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
        return Carried(
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

    @override
    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[Edit]:
        place, _ = joint.place
        return [
            Edit(self._byte(one.start_mark), self._byte(one.end_mark), values[key].encode("ascii"))
            for key, one in place.items()
        ]

    def _byte(self, mark: Any) -> int:
        return len(self.data.decode("utf-8")[: mark.index].encode("utf-8"))


def _real(value: float) -> str:
    """Return a number as all of ROS 2 reads it for a double: with a point, without an exponent."""
    text = format(Decimal(number(value)), "f")
    return text if "." in text else f"{text}.0"


def _members(node: Any) -> Mapping[str, Any]:
    """Return the members of a mapping of YAML; none of anything else."""
    pairs = node.value if node is not None and node.id == "mapping" else ()
    return {str(key.value): value for key, value in pairs}


def _texts(node: Any) -> Sequence[str]:
    """Return the scalars of a list of YAML; none of anything else."""
    items = node.value if node is not None and node.id == "sequence" else ()
    return [str(one.value) for one in items if one.id == "scalar"]


def _parameters(name: str, node: Any) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield the parameters of nodes below a node of YAML, with the names of both."""
    for key, value in _members(node).items():
        if key == "ros__parameters":
            yield name, _members(value)
        elif value is not None and value.id == "mapping":
            yield from _parameters(key.strip("/"), value)
