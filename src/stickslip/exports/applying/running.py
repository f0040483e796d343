"""Joints of a model in MuJoCo, beside the law itself on the same inertia."""

import copy
import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any, Final, final
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from stickslip.described import Described
from stickslip.drives import Drive, PiecewiseLinear, Sine
from stickslip.errors import StickslipError
from stickslip.exports.applying.markup import markup_of
from stickslip.exports.applying.mjcf import HARD, Mjcf
from stickslip.exports.applying.models import SHARE, Model
from stickslip.exports.applying.urdf import Urdf
from stickslip.exports.applying.workload import (
    check_steps,
    check_workload,
    limited_memory,
    timed,
)
from stickslip.exports.joints import SOFT, TIMESTEP
from stickslip.exports.simplification import steady_force
from stickslip.exports.subject import Subject
from stickslip.formatting import percent, quantity
from stickslip.friction import FrictionLaw, bound
from stickslip.mechanisms import Axis, gear_inputs, given_inputs, input_names
from stickslip.quantities import turned
from stickslip.simulation import simulate

HOLD: Final = 10.0
"""How long [s]."""
LONGEST: Final = 10.0
"""Longest decay or sweep [s]."""
PUSH: Final = 1.5
"""Amplitude of a sweep over the largest friction."""
PERIODS: Final = 2
"""Periods of a sweep."""
ROUNDING: Final = 1e-12
"""Share of the travel that roundings leave of a difference."""
HEAVY: Final = 1e9
"""Armature over the largest inertia of a model, with which its other joints stand still."""


@final
@dataclass(frozen=True, kw_only=True)
class Tested:
    """A joint that is run."""

    name: str
    subject: Subject
    joint: FrictionLaw
    """The friction that the law became."""
    damping: float
    """Damper of the mechanism, beside the law."""


@final
@dataclass(frozen=True, kw_only=True)
class JointMotion(metaclass=Described):
    """A motion of a joint in MuJoCo beside that with the law, which is exact."""

    kind: str
    """``"hold"``, ``"decay"`` or ``"sweep"``."""
    said: str
    """What it is, in words."""
    settings: str
    """``"stiff"`` where friction holds by other settings than those of the file, else empty."""
    t_end: float
    """How long it lasts [s]."""
    travel: float
    """Range of the motion with the law [rad] or [m]."""
    error: float
    """Largest distance of MuJoCo from it [rad] or [m]."""
    simplification: float
    """That of the joint's friction, simulated exactly, from the law [rad] or [m]."""
    rotary: bool
    """Whether the joint turns."""

    @property
    def sentence(self) -> str:
        """The motion in words."""
        length = turned("m", self.rotary)
        error, travel = quantity(self.error, length), quantity(self.travel, length)
        settings = f" ({self.settings})" if self.settings else ""
        if self.kind == "hold":
            return f"{self.said}: MuJoCo{settings} lets it move {error}, the law {travel}."
        return (
            f"{self.said}: MuJoCo{settings} is at most {error} from the law, over a travel of"
            f" {travel}; without MuJoCo, the simplification makes"
            f" {quantity(self.simplification, length)}."
        )

    def to_dict(self) -> Mapping[str, Any]:
        """Return the motion as plain numbers."""
        return {
            "kind": self.kind,
            "settings": self.settings,
            "t_end": self.t_end,
            "travel": self.travel,
            "error": self.error,
            "simplification": self.simplification,
            "sentence": self.sentence,
        }


@final
@dataclass(frozen=True, kw_only=True)
class Compiled:
    """A file as MuJoCo has it: with its own settings, and with those by which friction holds."""

    mujoco: ModuleType
    models: tuple[tuple[str, Any], ...]
    """Settings in a word, empty for those of the file, with MuJoCo's model."""


def in_mujoco(model: Model, content: bytes, joints: Sequence[str]) -> tuple[Compiled | None, str]:
    """Return a file as MuJoCo has it, or why there is nothing where MuJoCo does not take it."""
    try:
        import mujoco
    except ImportError:
        return None, (
            "MuJoCo is not installed, so the file was not run in it:"
            " pip install 'stickslip[mujoco]'."
        )
    if isinstance(model, Mjcf) and model.markup.root.name == "mujocoinclude":
        return None, "The file is a part of a model, so it was not run in MuJoCo."
    try:
        if isinstance(model, Mjcf | Urdf):
            check_workload([markup_of(model.path, content), *model.included()])
        with limited_memory():
            spec = _spec(mujoco, model, content)
            models = [("", spec.compile())]
            mujoco.MjData(models[0][1])
        if not isinstance(model, Mjcf):
            for name in joints:
                its = spec.joint(name)
                its.solref_friction, its.solimp_friction[:3] = _numbers(SOFT), _numbers(HARD)
            spec.option.timestep = TIMESTEP
            models.append(("stiff", spec.compile()))
        for _, one in models:
            check_steps(model.path, LONGEST, float(one.opt.timestep))
    # of memory that it does not get, MuJoCo says "unknown exception"
    except (ValueError, KeyError, MemoryError, RuntimeError, mujoco.FatalError) as error:
        return None, not_run(error)
    return Compiled(mujoco=mujoco, models=tuple(models)), ""


def not_run(error: Exception) -> str:
    """Return that a file was not run, and why."""
    return f"The file was not run in MuJoCo: {' '.join(str(error).split())}"


def motions_of(
    compiled: Compiled, joints: Sequence[Tested]
) -> tuple[dict[str, tuple[JointMotion, ...]], str]:
    """Return the motions of joints, and why there are none where one could not be run."""
    mujoco, found = compiled.mujoco, defaultdict[str, tuple[JointMotion, ...]](tuple)
    try:
        for settings, model in compiled.models:
            for one in joints:
                found[one.name] += tuple(_motions(mujoco, model, one, settings))
    except (ValueError, KeyError, mujoco.FatalError, StickslipError) as error:
        return {}, not_run(error)
    return dict(found), ""


def _numbers(text: str) -> list[float]:
    return [float(one) for one in text.split()]


def _spec(mujoco: ModuleType, model: Model, content: bytes) -> Any:
    """Return the model as MuJoCo reads it; of URDF without shapes, which have no part in it."""
    if isinstance(model, Mjcf):
        parts = {name: part.data for name, part in model.parts()}
        spec = mujoco.MjSpec.from_string(content.decode(), include=parts or None)
        spec.modelfiledir = str(model.path.resolve().parent)
        return _unpainted(spec)
    root = ElementTree.fromstring(content)
    for link in root.iter("link"):
        for shape in [one for one in link if one.tag in ("visual", "collision")]:
            link.remove(shape)
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    spec.compiler.balanceinertia = True  # moments of inertia of a file are rounded
    return _unpainted(spec)


def _unpainted(spec: Any) -> Any:
    """Return a model without textures and skins: they take memory, and no part in a motion."""
    for material in spec.materials:
        for place in range(len(material.textures)):
            material.textures[place] = ""
    for one in [*spec.textures, *spec.skins]:
        spec.delete(one)
    return spec


def _held(subject: Subject, load: float) -> float:
    """Return the force from which a joint alone leaves rest.

    A gear that the force itself loads holds more of it than at the torque that was stated; where it
    holds any force, it is that at the stated one.
    """

    def break_away(law: FrictionLaw) -> float:
        return min(float(law.towards(side).break_away(load)) for side in (1, -1))

    def level(force: float) -> float:
        told = gear_inputs(force, 0.0, position=0.0)
        return break_away(bound(replace(subject.law), {**subject.at, **told}))

    if not {"motor", "external", "transmitted"}.intersection(subject.law.inputs):
        return break_away(subject.law)
    last, force = 0.0, level(0.0)
    # a level that grows evenly, or ever more, is met from below, by secants
    while not math.isclose(held := level(force), force):
        slope = (held - level(last)) / (force - last)
        if not slope < 1.0:  # it locks, or grows beyond all numbers
            return break_away(subject.law)
        last, force = force, force + (held - force) / (1.0 - slope)
    return force


def _motions(
    mujoco: ModuleType, compiled: Any, one: Tested, settings: str
) -> Iterator[JointMotion]:
    """Yield what a joint does while the others stand still, without gravity and contacts."""
    dof = int(compiled.jnt_dofadr[compiled.joint(one.name).id])
    inertia = float(_masses(mujoco, compiled)[dof])
    compiled = alone(mujoco, compiled, [dof])
    for bit in ("GRAVITY", "LIMIT", "SPRING"):
        compiled.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{bit}"))
    subject = one.subject
    rotary, load, fastest = subject.rotary, subject.needed_load(), subject.needed_speed()
    axis = Axis(inertia=inertia, load=load, damping=one.damping, rotary=rotary)
    told = input_names(axis)  # such as the torque of a gear, which the motion decides
    stated = {name: value for name, value in subject.at.items() if name not in told}
    rest = _held(subject, load)
    sliding = abs(steady_force(subject, np.array([-fastest, fastest]), load)).max()
    sliding += one.damping * fastest
    step, unit = float(compiled.opt.timestep), turned("N", rotary)

    def motion(
        kind: str, said: str, t_end: float, drive: Drive | None, start: float
    ) -> JointMotion:
        steps = max(1, round(t_end / step))
        t = np.arange(steps + 1) * step
        force = np.zeros(steps) if drive is None else np.array([drive.value(x) for x in t[:-1]])
        theirs = _stepped(mujoco, compiled, dof, force, start)
        driven = given_inputs(replace(axis, drive=drive), stated)
        ours, plain = (
            simulate(driven, law, t_end=float(t[-1]), y0={"x": 0.0, "v": start}).at(t)["x"]
            for law in (replace(subject.law), one.joint)
        )
        travel, costs = float(np.ptp(ours)), float(np.abs(plain - ours).max())
        return JointMotion(
            kind=kind,
            said=said,
            settings=settings,
            t_end=float(t[-1]),
            travel=travel,
            error=float(np.abs(theirs - (0.0 if kind == "hold" else ours)).max()),
            simplification=costs if costs > ROUNDING * travel else 0.0,
            rotary=rotary,
        )

    if rest > 0.0:
        push = SHARE * rest
        constant = PiecewiseLinear(times=(0.0, HOLD), values=(push, push))
        said = f"Hold for {HOLD:g} s under {quantity(push, unit)}, {percent(SHARE)} of break-away"
        yield motion("hold", said, HOLD, constant, 0.0)
    speed = quantity(fastest, turned("m/s", rotary))
    slowest = min(sliding, rest) if rest > 0.0 else sliding
    if slowest > 0.0:
        t_end = min(LONGEST, 1.25 * inertia * fastest / slowest)
        yield motion("decay", f"Decay from {speed}, {quantity(t_end, 's')}", t_end, None, fastest)
    largest = PUSH * max(sliding, rest)
    if largest > 0.0:
        # with the force that friction leaves, the speed reaches about the largest of the law
        frequency = max((largest - sliding) / (inertia * fastest) / math.pi, PERIODS / LONGEST)
        said = f"Sweep by {quantity(largest, unit)} at {quantity(frequency, 'Hz')}"
        wave = Sine(amplitude=largest, frequency=frequency)
        yield motion("sweep", said, PERIODS / frequency, wave, 0.0)


def alone(mujoco: ModuleType, compiled: Any, dofs: "Sequence[int] | NDArray[np.intp]") -> Any:
    """Return a model of which some joints move freely and all others stand still.

    Nothing else moves them: neither contacts, nor couplings, nor actuators.
    """
    compiled = copy.copy(compiled)
    largest = _masses(mujoco, compiled).max()
    for bit in ("CONTACT", "EQUALITY", "ACTUATION"):
        compiled.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{bit}"))
    others = np.ones(compiled.nv, dtype=bool)
    others[dofs] = False
    compiled.dof_armature[others] = HEAVY * largest
    compiled.opt.tolerance = 0.0  # it is relative to a mass that such armatures exceed by far
    return compiled


def _masses(mujoco: ModuleType, compiled: Any) -> NDArray[np.float64]:
    """Return the inertia of each joint, all others at rest."""
    data = mujoco.MjData(compiled)
    mujoco.mj_forward(compiled, data)
    masses = np.empty(compiled.nv)
    for i, unit in enumerate(np.eye(compiled.nv)):
        column = np.empty(compiled.nv)
        mujoco.mj_mulM(compiled, data, column, unit)
        masses[i] = column[i]
    return masses


def _stepped(
    mujoco: ModuleType, compiled: Any, dof: int, force: NDArray[np.float64], start: float
) -> NDArray[np.float64]:
    """Return the positions of a joint, from where it begins."""
    data = mujoco.MjData(compiled)
    place = int(compiled.jnt_qposadr[compiled.dof_jntid[dof]])
    data.qvel[dof] = start
    found: NDArray[np.float64] = np.empty(force.size + 1)
    found[0] = data.qpos[place]
    for i, one in enumerate(timed(force)):
        data.qfrc_applied[dof] = one
        mujoco.mj_step(compiled, data)
        found[i + 1] = data.qpos[place]
    found -= found[0]
    return found
