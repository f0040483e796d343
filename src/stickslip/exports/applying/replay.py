"""A measured record beside the law of its joints, their simplified friction, and MuJoCo."""

import copy
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import ModuleType
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from stickslip import mechanisms
from stickslip.data import (
    Measurement,
    as_recorded,
    between_gaps,
    command_of,
    with_voltage,
)
from stickslip.engine.formulation import JointTorques
from stickslip.engine.simulation import simulate
from stickslip.errors import InputError, StickslipError
from stickslip.exports.applying.running import ROUNDING, Compiled, Tested, alone, not_run, timed
from stickslip.friction import FrictionLaw
from stickslip.identify import fits
from stickslip.mechanisms.drives import Drive, Sampled
from stickslip.quantities import turned
from stickslip.show.described import Described
from stickslip.show.formatting import quantity

Array = NDArray[np.float64]

HORIZON: Final = 1.0
"""Length of what is simulated at a time [s]: errors of the torque add up in a motion."""
MOST: Final = 12
"""Such parts of a record at most, spread over it."""
LAW: Final = "law"
SIMPLIFIED: Final = "level and damping"
MUJOCO: Final = "MuJoCo"
HOLD: Final = "zero"
"""What a motor is told keeps its value between samples, but for the goal of a continuous loop."""
SLOW: Final = 1e-6
"""Speed [m/s] or [rad/s] at which no limit of a motor is met that it does not meet at rest."""


@dataclass(frozen=True, kw_only=True)
class Replayed(metaclass=Described):
    """What one model makes of a joint of a record; root mean squares over the record."""

    model: str
    """``"law"`` or ``"level and damping"``, both with the mechanism of the law; or ``"MuJoCo"``,
    which runs the file, with its settings in brackets."""
    force: float
    """Difference from the measured force, along the measured motion [N] or [N m]."""
    cost: float
    """Difference from the force with the law, there [N] or [N m]."""
    position: float
    """Difference from the measured position, under what drove the record [m] or [rad]; NaN where
    that was not run."""
    drift: float
    """Difference from the position with the law, there [m] or [rad]."""

    def to_dict(self) -> Mapping[str, Any]:
        """Return the errors as plain values, None where there is none."""
        values = {name: getattr(self, name) for name in ("force", "cost", "position", "drift")}
        known = {name: x if math.isfinite(x) else None for name, x in values.items()}
        return {"model": self.model, **known}


@dataclass(frozen=True, kw_only=True)
class JointReplay(metaclass=Described):
    """A joint of a measured record, as the law, its simplification and MuJoCo have it."""

    spread: float
    """Standard deviation of the measured force where the joint slips [N] or [N m]."""
    constant: float
    """Mean of what the law leaves of the measured force: a constant force of the sensor, which is
    taken off for all models [N] or [N m]. 0 where a motor drives."""
    horizon: float
    """Length of the simulated parts [s], each from the measured position and velocity."""
    parts: int
    """Their number."""
    rotary: bool
    """Whether the joint turns."""
    models: tuple[Replayed, ...]
    """The law first, then its simplification, then MuJoCo."""
    driven_by: str = "force"
    """What drove the record: ``"force"``, or of a motor its ``"voltage"``, ``"current"`` or
    ``"reference"``. Each model's motor then has the back-EMF of that model's own speed."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """What the simplification costs on the record, in words."""
        force, length = turned("N", self.rotary), turned("m", self.rotary)
        what = "torque" if self.rotary else "force"
        own, near, *_ = self.models
        by_motor = self.driven_by != "force"
        measured = (
            f"{what} of the motor under the recorded {self.driven_by}"
            if by_motor
            else (f"measured {what}")
        )
        said = [
            f"On the record, level and damping change the {what} of the law by"
            f" {quantity(near.cost, force)} rms; from the {measured}, with a spread of"
            f" {quantity(self.spread, force)}, {_compared([m.force for m in self.models], force)}."
        ]
        if math.isfinite(own.position):
            under = f"recorded {self.driven_by} of the motor" if by_motor else measured
            said.append(
                f"Simulated {quantity(self.horizon, 's')} at a time under the {under}, they"
                f" change the position by {quantity(near.drift, length)} rms; from the measured"
                f" position, {_compared([m.position for m in self.models], length)}."
            )
        return tuple(said)

    def to_dict(self) -> Mapping[str, Any]:
        """Return the joint as plain values."""
        own = {name: value for name, value in vars(self).items() if name != "rotary"}
        models = [model.to_dict() for model in self.models]
        return own | {"models": models, "sentences": list(self.sentences)}


def replay_of(record: Measurement, mechanism: mechanisms.Mechanism) -> "Replay":
    """Return a record in stretches between its gaps, as the mechanism of its laws has it."""
    commands: tuple[_Commanded, ...] = ()
    if mechanisms.motor_of(mechanism) is None:
        own = _by_coordinate(mechanism, record)
        found = fits.hold_of(mechanism, own, None)
        hold = "first" if found is None else found.hold
    else:
        commands = tuple(_commanded(mechanism, record))
        own = Measurement(trials=tuple(command.by_torque() for command in commands))
        mechanism, hold = _without_current(mechanism), "first"
    torques = JointTorques.of(mechanism, [])
    pieces = tuple(fits.joint_pieces(torques, mechanism, own, hold=hold, resolved=True))
    if not pieces:
        raise InputError(
            "the record has no stretch without a gap that is long enough to be filtered."
        )
    return Replay(
        record=own,
        mechanism=mechanism,
        pieces=pieces,
        contacts={along: contact.name for along, contact in fits.contacts_along(mechanism).items()},
        commands=commands,
    )


def _by_coordinate(mechanism: mechanisms.Mechanism, measurement: Measurement) -> Measurement:
    """Return a record of one coordinate as one by joint."""
    if measurement.joint_names():
        return measurement
    name = mechanisms.slip_of(mechanism)
    found = []
    for record in measurement.records():
        if record.time is None or not {"position", "velocity"} & {*record.quantities()}:
            raise InputError("a motion in time is needed: position or velocity, and force.")
        force = fits.applied_force(as_recorded(mechanism, record), record)
        what = "position" if "position" in record.quantities() else "velocity"
        motion = {what: {name: np.asarray(record.values(what))}}
        found.append(
            Measurement(
                time=record.time,
                force={name: np.zeros(len(record.time)) if force is None else force},
                inputs=record.inputs,
                overrides=record.overrides,
                name=record.name,
                **motion,  # type: ignore[arg-type]  # by the name of what was measured
            )
        )
    return found[0] if len(found) == 1 else Measurement(trials=tuple(found))


@dataclass(frozen=True, kw_only=True)
class _Commanded:
    """What a motor was told between two gaps of a record."""

    mechanism: mechanisms.Mechanism
    """With the motor as it was in the record."""
    record: Measurement
    what: str
    """Name of what was recorded of the motor."""
    values: Array
    """What it was told (n,)."""
    straight: bool
    """Whether that goes straight from sample to sample."""

    @property
    def motor(self) -> mechanisms.DCMotor:
        """The motor."""
        motor: Any = mechanisms.motor_of(self.mechanism)
        assert motor is not None
        found: mechanisms.DCMotor = motor
        return found

    def by_torque(self) -> Measurement:
        """Return the same as a record of the motor's torque along the measured motion."""
        name = mechanisms.slip_of(self.mechanism)
        what = "position" if "position" in self.record.quantities() else "velocity"
        motion = {what: {name: np.asarray(self.record.values(what))}}
        return Measurement(
            time=self.record.time,
            force={name: fits.torque_along(self.mechanism, self.record, HOLD)},
            inputs=self.record.inputs,
            overrides=self.record.overrides,
            name=self.record.name,
            **motion,  # type: ignore[arg-type]  # by the name of what was measured
        )

    def told(self, start: float, end: float) -> Sampled:
        """Return what the motor is told from a time of the record to another; times from 0 on."""
        time = np.asarray(self.record.time, dtype=float)
        first = max(int(np.searchsorted(time, start, side="right")) - 1, 0)
        last = int(np.searchsorted(time, end)) + 1
        times, values = time[first:last] - start, self.values[first:last]
        return Sampled(times=times, values=values, hold="first" if self.straight else "zero")


def _commanded(mechanism: mechanisms.Mechanism, measurement: Measurement) -> Iterator[_Commanded]:
    """Yield what lies between gaps of the records of a motor, with what it was told."""
    if len(mechanism.coordinates) != 1:
        raise InputError(
            f"the motor of a record drives a mechanism of one coordinate here, and"
            f" {type(mechanism).__name__} has {len(mechanism.coordinates)}."
        )
    for given in measurement.records():
        if given.time is None or not {"position", "velocity"} & {*given.quantities()}:
            raise InputError("a motion in time is needed: position or velocity, and a voltage.")
        # where the loop samples, what it tells follows from the recorded goal
        record = with_voltage(mechanism, given, HOLD)
        set_up, what = as_recorded(mechanism, record), command_of(record)
        for piece in between_gaps(record):
            applied = fits.applied_force(set_up, piece)
            yield _Commanded(
                mechanism=set_up,
                record=piece,
                what=what or "voltage",
                values=np.zeros(len(np.asarray(piece.time))) if applied is None else applied,
                straight=fits.goes_straight(piece, HOLD),
            )


def _without_current(mechanism: mechanisms.Mechanism) -> mechanisms.Mechanism:
    """Return a mechanism whose motor has its rotor and no torque."""
    motor: Any = mechanisms.motor_of(mechanism)
    still = replace(
        motor, loop=mechanisms.CurrentLoop(), supply=None, supply_resistance=None, drive=None
    )
    return replace(mechanism, drive=still)  # type: ignore[call-arg]  # it has one


@dataclass(frozen=True, kw_only=True)
class Replay:
    """A record that models are compared on."""

    record: Measurement
    mechanism: mechanisms.Mechanism
    pieces: tuple[fits.JointPiece, ...]
    contacts: Mapping[str, str]
    """Contacts by coordinate."""
    commands: tuple[_Commanded, ...] = ()
    """What the motor was told in each record; empty where forces were measured."""
    laws: Sequence[Mapping[str, FrictionLaw]] = ()
    """Laws by contact, and with what became of them."""
    places: Mapping[str, Tested] = field(default_factory=dict)
    """Joints of the file by coordinate."""

    def _coordinate(self, contact: str) -> str:
        """Return the coordinate along which a contact slips, of the only one without its name."""
        return next(along for along, name in self.contacts.items() if contact in ("", name))

    def typical_inputs(self, contact: str, names: Collection[str]) -> dict[str, float]:
        """Return the usual values of contact inputs of a joint along the record, by name."""
        i = self.mechanism.coordinates.index(self._coordinate(contact))
        inputs = [piece.inputs[i][0] for piece in self.pieces]
        known = [name for name in names if all(name in table for table in inputs)]
        return fits.usual_values({name: [table[name] for table in inputs] for name in known})

    def judged(
        self,
        laws: Mapping[str, FrictionLaw],
        joints: Sequence[Tested],
        compiled: Compiled | None,
    ) -> tuple[dict[str, JointReplay], tuple[str, ...]]:
        """Return what becomes of the record by joint, and what is to be said of it as a whole.

        `laws` are those of all contacts of the mechanism; MuJoCo's models may be missing.
        """
        places = {self._coordinate(joint.subject.contact): joint for joint in joints}
        if len(self.contacts) == 1:  # which may have no name
            laws = dict(zip(self.contacts.values(), laws.values(), strict=True))
        near = {**laws, **{self.contacts[along]: tested.joint for along, tested in places.items()}}
        return replace(self, laws=(laws, near), places=places)._judged(compiled)

    def _judged(self, compiled: Compiled | None) -> tuple[dict[str, JointReplay], tuple[str, ...]]:
        """Return what each model makes of each joint."""
        said: list[str] = []
        theirs = {} if compiled is None else dict(self._models(compiled, said))
        forces = {
            key: [there.torques(piece) for piece in self.pieces] for key, there in theirs.items()
        }
        constants, rows = {}, {}
        for i, name in enumerate(self.mechanism.coordinates):
            columns = self._forces(i, name, [forces[other] for other in theirs])
            measured, own = columns[:2]
            known = len(measured) and not self.commands
            constants[name] = float(np.mean(measured - own)) if known else 0.0
            rows[name] = [column - measured + constants[name] for column in columns], measured
        horizon = min(HORIZON, *(piece.span for piece in self.pieces))
        parts = list(self._parts(horizon))
        motions = self._motions(parts, constants, theirs, said)
        found = {}
        for coordinate, tested in self.places.items():
            errors, measured = rows[coordinate]
            if not len(measured):
                said.append(f"{tested.name} hardly moves in the record: nothing is said of it.")
                continue
            i = self.mechanism.coordinates.index(coordinate)
            seen = np.concatenate([part.motion(self.mechanism)[:, i] for part in parts])
            spread = float(np.std(measured))
            moved = [None if x is None else x[:, i] for x in motions]
            models = tuple(
                Replayed(
                    model=model,
                    force=_rms(error),
                    cost=_rms(error - errors[1], spread),
                    position=_rms(x - seen) if x is not None else math.nan,
                    drift=_rms(x - moved[0], float(np.ptp(seen)))
                    if x is not None and moved[0] is not None
                    else math.nan,
                )
                for model, error, x in zip(
                    (LAW, SIMPLIFIED, *theirs), errors[1:], moved, strict=True
                )
            )
            found[tested.name] = JointReplay(
                spread=spread,
                constant=constants[coordinate],
                horizon=horizon,
                parts=len(parts),
                rotary=tested.subject.rotary,
                models=models,
                driven_by=self.commands[0].what if self.commands else "force",
            )
        return found, tuple(said)

    def _forces(self, i: int, name: str, theirs: Sequence[Sequence[Array]]) -> list[Array]:
        """Return the force of a joint where it slips: measured, with both laws, and MuJoCo's."""
        contact = self.contacts.get(name, "")
        law, near = (entry.get(contact) for entry in self.laws)
        table: list[list[Array]] = []
        for number, piece in enumerate(self.pieces):
            whole = [other[number][:, i] for other in theirs]
            measured, own, *rest = piece.compared(i, law, whole)
            _, simple = piece.compared(i, near)
            table.append([measured, own, simple, *rest])
        return [np.concatenate(column) for column in zip(*table, strict=True)]

    def _models(self, compiled: Compiled, said: list[str]) -> Iterator[tuple[str, "_InMuJoCo"]]:
        for settings, model in compiled.models:
            there = _InMuJoCo.of(compiled.mujoco, model, self._named(compiled.mujoco, model))
            if there.still and not settings:
                said.append(
                    "In MuJoCo, joints that the record does not have stand where the file puts"
                    f" them: {', '.join(there.still)}."
                )
            yield f"{MUJOCO} ({settings})" if settings else MUJOCO, there

    def _named(self, mujoco: ModuleType, model: Any) -> list[str]:
        """Return the joints of the file by coordinate of the mechanism."""
        known = {key: place.name for key, place in self.places.items()}
        found = []
        for name in self.mechanism.coordinates:
            joint = known.get(name, name)
            if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint) < 0:
                raise InputError(
                    f"the record has {name!r}, and the file no joint of that name: pair them by"
                    " --joint (in Python joints)."
                )
            found.append(joint)
        return found

    def _parts(self, horizon: float) -> Iterator["_Part"]:
        share = max(1, MOST // len(self.pieces))
        for piece in self.pieces[:MOST]:
            dt = float(piece.time[1] - piece.time[0])
            length = min(round(horizon / dt), len(piece.time) - 1)
            room = len(piece.time) - 1 - length
            count = max(1, min(share, round(piece.span / horizon)))
            for first in np.unique(np.linspace(0, room, count).astype(int)).tolist():
                yield _Part(piece=piece, rows=slice(first, first + length + 1))

    def _motions(
        self,
        parts: Sequence["_Part"],
        constants: Mapping[str, float],
        theirs: Mapping[str, "_InMuJoCo"],
        said: list[str],
    ) -> list[Array | None]:
        """Return positions of all parts by both laws and by MuJoCo; None if they were not run."""
        known = np.array([constants[name] for name in self.mechanism.coordinates])
        found: list[Array | None] = []
        for laws in self.laws:
            try:
                found.append(np.concatenate([self._simulated(part, laws, known) for part in parts]))
            except StickslipError as error:
                said.append(f"The record was not simulated: {' '.join(str(error).split())}")
                return [None] * (len(self.laws) + len(theirs))
        for there in theirs.values():
            try:
                moved = [there.moved(part, known, self._command_of(part)) for part in parts]
                found.append(np.concatenate(moved))
            except InputError as error:
                said.append(not_run(error))
                found.append(None)
        return found

    def _command_of(self, part: "_Part") -> tuple[mechanisms.DCMotor, Sampled] | None:
        """Return the motor of a part and what it is told there; None without one."""
        if not self.commands:
            return None
        own, time = self.commands[part.piece.record], part.piece.time[part.rows]
        return own.motor, own.told(float(time[0]), float(time[-1]))

    def _simulated(self, part: "_Part", laws: Mapping[str, FrictionLaw], constants: Array) -> Array:
        names = self.mechanism.coordinates
        time, forces, command = part.time, part.forces - constants, self._command_of(part)
        if command is not None:
            rig = fits.with_drive(self.commands[part.piece.record].mechanism, command[1])
        else:
            drives = {
                name: Sampled(times=time, values=column, hold="first")
                for name, column in zip(names, forces.T, strict=True)
            }
            rig = driven_by(part.piece.mechanism, drives)
        whole = self.record.records()[part.piece.record]
        rig = fits.with_inputs(rig, whole, part.piece.time[part.rows])
        place, rate = part.start
        begin = dict(zip(names, place.tolist(), strict=True))
        begin |= dict(zip(self.mechanism.rates, rate.tolist(), strict=True))
        several = len(self.mechanism.contacts()) > 1
        run = simulate(
            rig,
            dict(laws) if several else next(iter(laws.values())),
            t_end=float(time[-1]),
            y0=begin,
        ).at(time)
        return np.column_stack([run[name] for name in names])


def driven_by(mechanism: mechanisms.Mechanism, drives: Mapping[str, Drive]) -> mechanisms.Mechanism:
    """Return a mechanism with a drive along each coordinate."""
    if isinstance(mechanism, mechanisms.Robot):
        joints = tuple(
            replace(joint, effort=drives[joint.coordinate]) for joint in mechanism.joints
        )
        return replace(mechanism, joints=joints)
    if isinstance(mechanism, mechanisms.SerialArm):
        pairs = zip(mechanism.links, mechanism.coordinates, strict=True)
        return replace(
            mechanism, links=tuple(replace(link, torque=drives[name]) for link, name in pairs)
        )
    if isinstance(mechanism, mechanisms.TwoLinkArm):
        shoulder, elbow = (drives[name] for name in mechanism.coordinates)
        return replace(mechanism, shoulder_drive=shoulder, elbow_drive=elbow)
    (only,) = drives.values()
    return fits.with_drive(mechanism, only)


@dataclass(frozen=True, kw_only=True)
class _Part:
    """What is simulated at a time."""

    piece: fits.JointPiece
    rows: slice

    @property
    def time(self) -> Array:
        """Times from its start on (n,) [s]."""
        own = self.piece.time[self.rows]
        shifted: Array = own - own[0]
        return shifted

    @property
    def forces(self) -> Array:
        """Measured forces (n, m)."""
        return self.piece.applied[self.rows]

    def motion(self, mechanism: mechanisms.Mechanism) -> Array:
        """Return the measured positions (n, m)."""
        count = len(mechanism.coordinates)
        return np.column_stack([self.piece.motions[i].position[self.rows] for i in range(count)])

    @property
    def start(self) -> tuple[Array, Array]:
        """Positions and velocities at which it begins (m,)."""
        at, motions = self.rows.start, self.piece.motions
        return (
            np.array([motion.position[at] for motion in motions]),
            np.array([motion.velocity[at] for motion in motions]),
        )


@dataclass(frozen=True, kw_only=True)
class _InMuJoCo:
    """A model whose joints of the record move, and the others stand."""

    mujoco: ModuleType
    model: Any
    places: NDArray[np.intp]
    """Where positions of the joints stand (m,)."""
    dofs: NDArray[np.intp]
    """Where their velocities do (m,)."""
    still: tuple[str, ...]
    """Other joints that could move."""

    @classmethod
    def of(cls, mujoco: ModuleType, model: Any, joints: Sequence[str]) -> "_InMuJoCo":
        dofs = np.array([model.joint(name).dofadr[0] for name in joints], dtype=np.intp)
        model = alone(mujoco, model, dofs)
        names = [model.joint(i).name or f"number {i + 1}" for i in range(model.njnt)]
        return cls(
            mujoco=mujoco,
            model=model,
            places=np.array([model.joint(name).qposadr[0] for name in joints], dtype=np.intp),
            dofs=dofs,
            still=tuple(name for name in names if name not in joints),
        )

    def torques(self, piece: fits.JointPiece) -> Array:
        """Return the forces that the motion takes, friction included (n, m)."""
        data = self.mujoco.MjData(self.model)
        found = np.empty((len(piece.time), len(self.dofs)))
        motions = piece.motions
        places = np.column_stack([motion.position for motion in motions])
        rates = np.column_stack([motion.velocity for motion in motions])
        for row, (q, v, a) in enumerate(zip(places, rates, piece.accelerations, strict=True)):
            data.qpos[self.places], data.qvel[self.dofs], data.qacc[self.dofs] = q, v, a
            self.mujoco.mj_inverse(self.model, data)
            found[row] = data.qfrc_inverse[self.dofs]
        return found

    def moved(
        self,
        part: _Part,
        constants: Array,
        command: tuple[mechanisms.DCMotor, Sampled] | None = None,
    ) -> Array:
        """Return the positions that the measured forces, or what a motor was told, lead to (n, m).

        A motor has the back-EMF of the speed here. Its slope by the speed is a damping that MuJoCo
        integrates implicitly, and is given back at the speed before the step: no step is too long.
        """
        model, damping = self.model, 0.0
        if command is not None:
            motor, drive = command
            damping = 0.5 * float(motor.force(0.0, 0.0, -SLOW) - motor.force(0.0, 0.0, SLOW)) / SLOW
            model = copy.copy(model)
            model.dof_damping[self.dofs] += damping
        data = self.mujoco.MjData(model)
        place, rate = part.start
        data.qpos[self.places], data.qvel[self.dofs] = place, rate
        step, time = float(model.opt.timestep), part.time
        times = np.arange(math.ceil(time[-1] / step) + 1) * step
        forces = np.column_stack(
            [np.interp(times + 0.5 * step, time, item) for item in (part.forces - constants).T]
        )
        found = np.empty((len(times), len(self.dofs)))
        for row, force in enumerate(timed(forces)):
            found[row] = data.qpos[self.places]
            if command is not None:
                x, v = data.qpos[self.places], data.qvel[self.dofs]
                told_now = drive.value(float(times[row]) + 0.5 * step)
                data.qfrc_applied[self.dofs] = motor.force(told_now, x, v) + damping * v
            else:
                data.qfrc_applied[self.dofs] = force
            self.mujoco.mj_step(model, data)
        return np.column_stack([np.interp(time, times, column) for column in found.T])


def _compared(errors: Sequence[float], unit: str) -> str:
    """Return the errors of the law, of its simplification and of the last of MuJoCo's models."""
    words = ("the law is off by", "they by", f"{MUJOCO} by")
    chosen = (*errors[:2], *errors[2:][-1:])
    return ", ".join(
        f"{word} {quantity(value, unit)}" for word, value in zip(words, chosen, strict=False)
    )


def _rms(x: Array, of: float = 0.0) -> float:
    """Return the root mean square; 0 where it is the rounding of numbers of a size."""
    found = float(np.sqrt(np.mean(np.square(x))))
    return 0.0 if found <= ROUNDING * of else found
