"""Joints of a model run in MuJoCo, beside the law itself on the same inertia.

A model file is not trusted: what it asks of memory and time is worked out, and refused, before
MuJoCo does any of it.
"""

import contextlib
import copy
import math
import re
import stat
import sys
import time
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any, Final, TypeVar
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.simulation import simulate
from stickslip.errors import InputError, StickslipError, check_size
from stickslip.exports.applying.markup import Markup, Tag, markup_of
from stickslip.exports.applying.models import HARD, SHARE, Mjcf, Model, Urdf
from stickslip.exports.joints import SOFT, TIMESTEP, steady_force
from stickslip.exports.program import Subject
from stickslip.friction import FrictionLaw, bound
from stickslip.mechanisms import Axis, gear_inputs, given_inputs, input_names
from stickslip.mechanisms.drives import Drive, PiecewiseLinear, Sine
from stickslip.quantities import turned
from stickslip.show.described import Described
from stickslip.show.display import require_library
from stickslip.show.formatting import percent, quantity

# What a model asks of MuJoCo, refused before any of it is done.
#
# A few characters of a model stand for any amount of memory or time: copies of a body, points of a
# cloth, sizes of arenas and tables, steps of a nanosecond, solvers that never stop. MuJoCo does
# what it is told. Textures and skins, which no motion depends on, are left out.

T = TypeVar("T")
CURE: Final = "run a smaller model, with the same joints"
MOST_ELEMENTS: Final = 20_000
"""Elements of a model, copies included: large robots with their rooms have some thousand."""
MOST_NUMBERS: Final = 10_000_000
"""Numbers of a table that a model has MuJoCo make."""
MOST_ITERATIONS: Final = 10_000
"""Iterations of a solver in a step; the default is 100."""
MOST_STEPS: Final = 500_000
"""Steps of a motion: ten seconds of 20 us."""
LARGEST_FILE: Final = 200_000_000
"""Bytes of a file that a model names, such as a mesh."""
LARGEST_ARENA: Final = 2**30
LARGEST_GROWTH: Final = 4 * 2**30
"""Bytes that MuJoCo may take for a model: its arena, its tables and what makes them."""
MOST_PROCESSOR_TIME: Final = 120.0
"""Processor time that a motion may take [s]."""
COPIES: Final = ("replicate", "composite", "flexcomp")
COUNTS: Final = ("nrow", "ncol", "dim", "nsample", "ninterp", "maxhullvert", "octree_maxdepth")
ITERATIONS: Final = ("iterations", "ls_iterations", "noslip_iterations", "ccd_iterations")
FOLDERS: Final = ("meshdir", "texturedir", "assetdir")
_BYTES: Final = re.compile(r"\s*(\d{1,30})([kmgtpe]?)\s*", re.IGNORECASE)


def check_workload(parts: list[Markup]) -> None:
    """Refuse a model, in the files that it is made of, that takes more than a robot does."""
    main = parts[0].path
    dirs = {
        tag.attributes[key] for markup in parts for tag in markup.root.walk() for key in FOLDERS
        if key in tag.attributes
    }  # fmt: skip
    total = 0.0
    for part in parts:
        for tag, copies in _copied(part.root, 1.0):
            total += copies
            where = f"{part.path}, line {tag.line}"
            check_size(str(main), total, CURE, unit="elements", most=MOST_ELEMENTS)
            for what, amount, most in _amounts(tag):
                check_size(f"{where}: {what}", amount * copies, CURE, unit="of it", most=most)
            _check_files(tag, where, {main.parent, part.path.parent}, dirs)


def check_steps(path: Path, time: float, step: float) -> None:
    """Refuse a motion of so many steps that it takes minutes."""
    steps = time / step if step > 0.0 else math.inf
    check_size(
        f"{path}: time step of {step:g} s", steps, "make it longer", unit="steps", most=MOST_STEPS
    )


@contextlib.contextmanager
def limited_memory() -> Iterator[None]:
    """Let what MuJoCo makes of a model fail where it grows beyond measure, whatever asked for it.

    It is the memory of the process that has a limit meanwhile, where the system knows one.
    """
    with contextlib.ExitStack() as stack:
        if sys.platform == "linux":
            import resource

            with contextlib.suppress(OSError):  # not told
                pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
                before = resource.getrlimit(resource.RLIMIT_AS)
                limits = [index for index in before if index != resource.RLIM_INFINITY]
                most = min([pages * resource.getpagesize() + LARGEST_GROWTH, *limits])
                resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
                stack.callback(resource.setrlimit, resource.RLIMIT_AS, before)
        yield


def timed(steps: Iterable[T]) -> Iterator[T]:
    """Yield the steps of a motion, unless they take too much processor time.

    Examples
    --------
    >>> [*timed([1.0, 2.0])]
    [1.0, 2.0]
    """
    start = time.process_time()
    for step in steps:
        if time.process_time() - start > MOST_PROCESSOR_TIME:
            raise InputError(
                f"a motion takes more than {MOST_PROCESSOR_TIME:g} s of processor time: {CURE}."
            )
        yield step


def _copied(tag: Tag, copies: float) -> Iterator[tuple[Tag, float]]:
    """Yield each element with how often MuJoCo makes it."""
    if tag.name in COPIES:
        copies *= max(math.prod(_readable_numbers(tag.attributes.get("count", "1"))), 1.0)
    yield tag, copies
    for child in tag.children:
        yield from _copied(child, copies)


def _amounts(tag: Tag) -> Iterator[tuple[str, float, float]]:
    """Yield what an element has MuJoCo make or do, how much of it, and the limit."""
    values: Mapping[str, str] = tag.attributes
    table = math.prod(max(_largest(values[key]), 1.0) for key in COUNTS if key in values)
    yield "numbers", table, MOST_NUMBERS
    for key in ITERATIONS:
        if key in values:
            yield key, _largest(values[key]), MOST_ITERATIONS
    if tag.name == "numeric" and "size" in values:
        yield "numbers", _largest(values["size"]), MOST_NUMBERS
    if "builtin" in values and tag.name == "mesh":
        yield "points of a mesh", _largest(values.get("params", "1")) ** 2, MOST_NUMBERS
    if tag.name == "size":
        for key, text in values.items():
            if key == "memory":
                yield "bytes of memory", _bytes(text), LARGEST_ARENA
            else:
                yield key, _largest(text), MOST_NUMBERS


def _check_files(tag: Tag, where: str, places: set[Path], dirs: set[str]) -> None:
    """Refuse a file that would be read without end, or that is a model within the model."""
    name = tag.attributes.get("file", "")
    if not name or tag.name in ("texture", "skin", "include"):
        return
    for path in (place / folder / name for place in places for folder in ("", *dirs)):
        try:
            found = path.stat()
        except (OSError, ValueError):
            continue
        size = found.st_size if stat.S_ISREG(found.st_mode) else math.inf
        check_size(f"{where}: the file {name}", size, CURE, unit="bytes", most=LARGEST_FILE)
        if tag.name == "model":
            check_size(
                f"{where}: models within the model", 1.0, "include it", unit="files", most=0.0
            )


def _readable_numbers(text: str) -> list[float]:
    found = []
    for word in text.split():
        try:
            found.append(abs(float(word)))
        except ValueError:
            continue  # MuJoCo says what it cannot read
    return found


def _largest(text: str) -> float:
    return max(_readable_numbers(text), default=0.0)


def _bytes(text: str) -> float:
    found = _BYTES.fullmatch(text)
    return float(found[1]) * 1024.0 ** " kmgtpe".index(found[2].lower() or " ") if found else 0.0


# Joints of a model in MuJoCo, beside the law itself on the same inertia.

HOLD: Final = 10.0
"""How long [s]."""
LONGEST_MOTION: Final = 10.0
"""Longest decay or sweep [s]."""
PUSH: Final = 1.5
"""Amplitude of a sweep over the largest friction."""
PERIODS: Final = 2
"""Periods of a sweep."""
ROUNDING: Final = 1e-12
"""Share of the travel that roundings leave of a difference."""
HEAVY: Final = 1e9
"""Armature over the largest inertia of a model, with which its other joints stand still."""


@dataclass(frozen=True, kw_only=True)
class Tested:
    """A joint that is run."""

    name: str
    subject: Subject
    joint: FrictionLaw
    """The friction that the law became."""
    damping: float
    """Damper of the mechanism, beside the law."""


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
        in_words = ("said", "rotary")  # the sentence has them
        numbers = {name: value for name, value in vars(self).items() if name not in in_words}
        return numbers | {"sentence": self.sentence}


@dataclass(frozen=True, kw_only=True)
class Compiled:
    """A file as MuJoCo has it: with its own settings, and with those by which friction holds."""

    mujoco: ModuleType
    models: tuple[tuple[str, Any], ...]
    """Settings in a word, empty for those of the file, with MuJoCo's model."""


def in_mujoco(model: Model, content: bytes, joints: Sequence[str]) -> tuple[Compiled | None, str]:
    """Return a file as MuJoCo has it, or why there is nothing where MuJoCo does not take it."""
    try:
        mujoco = require_library("mujoco", "mujoco")
    except InputError as error:
        return None, not_run(error)
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
        for _, item in models:
            check_steps(model.path, LONGEST_MOTION, float(item.opt.timestep))
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
            for joint in joints:
                found[joint.name] += tuple(_motions(mujoco, model, joint, settings))
    except (ValueError, KeyError, mujoco.FatalError, StickslipError) as error:
        return {}, not_run(error)
    return dict(found), ""


def _numbers(text: str) -> list[float]:
    return [float(name) for name in text.split()]


def _spec(mujoco: ModuleType, model: Model, content: bytes) -> Any:
    """Return the model as MuJoCo reads it; of URDF without shapes, which have no part in it."""
    if isinstance(model, Mjcf):
        parts = {name: part.data for name, part in model.parts()}
        spec = mujoco.MjSpec.from_string(content.decode(), include=parts or None)
        spec.modelfiledir = str(model.path.resolve().parent)
        return _unpainted(spec)
    root = ElementTree.fromstring(content)
    for link in root.iter("link"):
        for shape in [element for element in link if element.tag in ("visual", "collision")]:
            link.remove(shape)
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    spec.compiler.balanceinertia = True  # moments of inertia of a file are rounded
    return _unpainted(spec)


def _unpainted(spec: Any) -> Any:
    """Return a model without textures and skins: they take memory, and no part in a motion."""
    for material in spec.materials:
        for place in range(len(material.textures)):
            material.textures[place] = ""
    for texture in [*spec.textures, *spec.skins]:
        spec.delete(texture)
    return spec


def _held(subject: Subject, load: float) -> float:
    """Return the force from which a joint alone leaves rest.

    A gear that the force itself loads holds more of it than at the torque that was stated; where it
    holds any force, it is that at the stated one.
    """

    def break_away(law: FrictionLaw) -> float:
        return min(float(law.towards(side).break_away(load)) for side in (1, -1))

    def level(force: float) -> float:
        inputs = gear_inputs(force, 0.0, position=0.0)
        return break_away(bound(replace(subject.law), {**subject.at, **inputs}))

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
    mujoco: ModuleType, compiled: Any, tested: Tested, settings: str
) -> Iterator[JointMotion]:
    """Yield what a joint does while the others stand still, without gravity and contacts."""
    dof = int(compiled.jnt_dofadr[compiled.joint(tested.name).id])
    inertia = float(_masses(mujoco, compiled)[dof])
    compiled = alone(mujoco, compiled, [dof])
    for bit in ("GRAVITY", "LIMIT", "SPRING"):
        compiled.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{bit}"))
    subject = tested.subject
    rotary, load, fastest = subject.rotary, subject.needed_load(), subject.needed_speed()
    axis = Axis(inertia=inertia, load=load, damping=tested.damping, rotary=rotary)
    inputs = input_names(axis)  # such as the torque of a gear, which the motion decides
    stated = {name: value for name, value in subject.at.items() if name not in inputs}
    rest = _held(subject, load)
    sliding = abs(steady_force(subject, np.array([-fastest, fastest]), load)).max()
    sliding += tested.damping * fastest
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
            for law in (replace(subject.law), tested.joint)
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
        t_end = min(LONGEST_MOTION, 1.25 * inertia * fastest / slowest)
        yield motion("decay", f"Decay from {speed}, {quantity(t_end, 's')}", t_end, None, fastest)
    largest = PUSH * max(sliding, rest)
    if largest > 0.0:
        # with the force that friction leaves, the speed reaches about the largest of the law
        frequency = max(
            (largest - sliding) / (inertia * fastest) / math.pi, PERIODS / LONGEST_MOTION
        )
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
    for i, level in enumerate(timed(force)):
        data.qfrc_applied[dof] = level
        mujoco.mj_step(compiled, data)
        found[i + 1] = data.qpos[place]
    found -= found[0]
    return found
