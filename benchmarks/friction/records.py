"""Tasks on public records: axes, contacts, robots, a servo, and simulations by other programs."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from benchmarks.friction import definition
from stickslip.data import Measurement
from stickslip.data.catalogue import dataset
from stickslip.data.differentiation import rows_of
from stickslip.data.readers.binary import parquet_data
from stickslip.identify.fits import RecordSettings
from stickslip.mechanisms import Axis, DCMotor, Pendulum, Robot, RobotJoint, TowedBlock, TwoLinkArm

# Tasks of one coordinate under a known force: a ball-screw axis, a driven pendulum.

JANOT = "Janot, Gautier, Brunot 2019"
SWINGS = {"ddp": 6.0, "sac": 4.0, "ilqr": 2.8, "energy_shaping": 5.0}
"""Records of the pendulum with one mass, and until when [s] it moves as torque and weight have it.

People push it later. In ilqr it accelerates by 54 rad/s^2 at 3.0 s; torque and weight give 16.
"""
UNEVEN = 0.1
"""Time [s] from which the steps of all of them are even."""


def swing(name: str) -> Measurement:
    """Return a record of the pendulum, driven by the torque that its drive reports."""
    return definition.between(
        dataset("simple_pendulum_drive").measurement(name), UNEVEN, SWINGS[name]
    )


def _emps() -> tuple[Measurement, Measurement]:
    record = dataset("emps").measurement()
    return definition.between(record, -math.inf, 16.0), definition.between(record, 16.0, math.inf)


def _pendulum() -> tuple[Measurement, Measurement]:
    first, others = ("ddp", "energy_shaping"), ("sac", "ilqr")
    both = [Measurement(trials=tuple(map(swing, own))) for own in (first, others)]
    return both[0], both[1]


EMPS = definition.Task(
    name="emps",
    title="Ball-screw axis under position control",
    record="emps",
    files=("train",),
    fitted="the first 16 s",
    judged="the last 9 s",
    mechanism=Axis(inertia=95.0),
    split=_emps,
    metric=definition.PositionError(horizon=1.0),
    vary=("friction.*", "mechanism.inertia"),
    cutoff=50.0,
    published=(
        definition.Published(
            what="IDIM-LS, Coulomb + viscous",
            result="relative error of the force 4.08 %, whole record, in sample",
            source=JANOT,
        ),
        definition.Published(
            what="IDIM-LS, by direction",
            result="relative error of the force 3.11 %, whole record, in sample",
            source=JANOT,
        ),
    ),
)
PENDULUM = definition.Task(
    name="pendulum",
    title="Pendulum with a quasi-direct drive",
    record="simple_pendulum_drive",
    files=tuple(SWINGS),
    fitted="ddp (6 s) and energy_shaping (5 s)",
    judged="sac (4 s) and ilqr (2.8 s)",
    mechanism=Pendulum(mass=0.74, length=0.5, rest_angle=0.0),
    split=_pendulum,
    metric=definition.PositionError(horizon=0.5, unit="rad"),
    vary=("friction.*", "mechanism.mass", "mechanism.inertia", "mechanism.rest_angle"),
    cutoff=3.0,
    published=(
        definition.Published(
            what="parameters printed with the record (J, m c, F_v, F_c)",
            result="0.15 to 0.60 rad over 0.5 s, by record",
            source="Wiebe et al. 2022; errors by the notes of the catalogue",
        ),
    ),
)
AXIS_TASKS = (EMPS, PENDULUM)


# Tasks of one contact: a tribometer, rock, a slider over paper.

NO_DYNAMICS = "friction was measured: there are no dynamics to discover or to roll out"
IRREGULAR = "irregular stick-slip is judged by its features, which no regression of samples gives"
STEP = 21_820.0
"""Time [s] of the clock of the rock's record from which it judges."""
MASS = 0.0307
"""Of the slider over paper [kg]."""


def _tribometer() -> tuple[Measurement, Measurement]:
    record = dataset("reciprocating_tribometer").measurement("train")
    return definition.between(record, 12.0, 75.0), definition.between(record, 75.0, 110.0)


def _rock() -> tuple[Measurement, Measurement]:
    record = dataset("rock_velocity_step").measurement()
    return definition.between(record, -math.inf, STEP), record


def _slider(file: str) -> tuple[Measurement, Measurement]:
    record = dataset("spring_pulled_slider").measurement(file)
    time = np.asarray(record.time)
    middle = float(time[len(time) // 2])
    return definition.between(record, -math.inf, middle), definition.between(
        record, middle, math.inf
    )


def _slow() -> tuple[Measurement, Measurement]:
    return _slider("k168_v42")


def _fast() -> tuple[Measurement, Measurement]:
    return _slider("k1002_v4300")


CONTACT_TASKS = (
    definition.Task(
        name="tribometer",
        title="Reciprocating tribometer, strokes of 0.23 mm",
        record="reciprocating_tribometer",
        files=("train",),
        fitted="12 to 75 s",
        judged="75 to 110 s",
        mechanism=Axis(inertia=1.0),
        split=_tribometer,
        metric=definition.ForceError(),
        cutoff=5.0,
        published=(
            definition.Published(
                what="sign(v), Dahl, LuGre",
                result="relative error of the force 94.5 %, 11.6 %, 9.1 %, whole file, in sample",
                source="notes of the catalogue",
            ),
        ),
        left_out={"pysindy": NO_DYNAMICS, "mujoco": NO_DYNAMICS},
    ),
    definition.Task(
        name="rock",
        title="Sepiolite gouge at 30 MPa, a step from 0.2 to 2 µm/s",
        record="rock_velocity_step",
        files=("sepiolite",),
        fitted="the record up to the middle of what follows the step",
        judged="the rest of it",
        mechanism=TowedBlock(mass=1e-3, stiffness=1e3, speed=2e-7, load=1.0),
        split=_rock,
        metric=definition.CoefficientError(since=STEP),
        vary=("friction.*", "mechanism.stiffness"),
        published=(
            definition.Published(
                what="rate and state (a = 0.0157, b = 0)",
                result="rms 1.1e-3, whole record, in sample",
                source="Giacomel et al. 2024",
            ),
        ),
        left_out={
            "pysindy": NO_DYNAMICS,
            "mujoco": "its friction does not depend on speed and state",
        },
    ),
    *(
        definition.Task(
            name=f"slider-{name}",
            title=f"Slider pulled over paper by a spring at {speed:g} µm/s",
            record="spring_pulled_slider",
            files=(file,),
            fitted="the first half",
            judged="the second half",
            mechanism=TowedBlock(mass=MASS, stiffness=stiffness, speed=speed * 1e-6),
            split=split,
            metric=definition.FeatureError(),
            vary=("friction.*", "mechanism.mass"),
            left_out=dict.fromkeys(("scipy", "lmfit", "pysindy", "mujoco"), IRREGULAR),
        )
        for name, file, stiffness, speed, split in (
            ("slow", "k168_v42", 168.0, 42.0, _slow),
            ("fast", "k1002_v4300", 1002.0, 4300.0, _fast),
        )
    ),
)


# Tasks of several joints at once: an arm of two links, an industrial robot.

Frame: TypeAlias = tuple[tuple[float, float, float], tuple[float, float, float]]
NO_LIBRARY = "its library of functions has no rigid-body terms of an arm"
NO_MODEL = "it rolls a model file out, and masses of the links are not published"
LAWS = ("coulomb-viscous", "stribeck", "power-viscous", "direction-dependent")
"""Laws that all joints are given alike."""
TX40 = (
    ((0.0, 0.0, 0.320), (0.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((0.225, 0.0, 0.035), (0.0, 0.0, 0.0)),
    ((0.0, -0.225, 0.0), (0.5, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (0.5, 1.0, 0.0)),
)
"""TX40: place [m], and roll, pitch and yaw [half turns] of each joint, which turns about z."""
SCHUNK = (
    ((0.0, 0.0, 0.205), (0.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((0.0, -0.350, 0.0), (1.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((0.0, 0.0, 0.305), (-0.5, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (0.5, 0.0, 0.0)),
)
"""The same of the Schunk arm, whose third joint is counted against the second."""
INERTIA = 0.01
"""Moment of inertia that each link is described with [kg m^2], which is not what it has."""
FITTED = ("143339", "143704", "143747", "144003", "154548")
JUDGED = ("143524", "144115")
EVEN = ("run080", "run084", "run088")
ODD = ("run082", "run086")
"""Runs in turn: their friction falls from one to the next."""


def robot_of(frames: Sequence[Frame], coupling: Mapping[str, Mapping[str, float]]) -> Robot:
    """Return a robot with links of which only the frames are right."""
    joints = [
        RobotJoint(
            joint=f"q{i}",
            parent=f"q{i - 1}" if i > 1 else "",
            place=place,
            orientation=_rotation(*turns),
            coupling=coupling.get(f"q{i}", {}),
            mass=1.0,
            inertia_xx=INERTIA,
            inertia_yy=INERTIA,
            inertia_zz=INERTIA,
        )
        for i, (place, turns) in enumerate(frames, 1)
    ]
    return Robot(joints=tuple(joints))


def tx40_robot() -> Robot:
    """Return the TX40, whose sixth motor turns with the fifth joint too."""
    return robot_of(TX40, {"q6": {"q5": 1.0}})


def _rotation(roll: float, pitch: float, yaw: float) -> tuple[float, ...]:
    (a, b, c), (d, e, f) = (
        [round(wave(math.pi * x), 12) for x in (roll, pitch, yaw)] for wave in (math.cos, math.sin)
    )
    rows = (
        (c * b, c * e * d - f * a, c * e * a + f * d),
        (f * b, f * e * d + c * a, f * e * a - c * d),
        (-e, b * d, b * a),
    )
    return tuple(x + 0.0 for row in rows for x in row)


def by_motors(record: Measurement) -> Measurement:
    """Return a record with place and torque of the sixth motor, which turns with both joints."""
    joints = dict(record.joints)
    fifth, sixth = joints["q5"], joints["q6"]
    joints["q5"] = replace(fifth, force=fifth.values("force") - sixth.values("force"))
    joints["q6"] = replace(sixth, position=fifth.values("position") + sixth.values("position"))
    return replace(record, joints=joints)


def _tx40() -> tuple[Measurement, Measurement]:
    record = by_motors(dataset("staubli_tx40").measurement())
    rows = len(np.asarray(record.time))
    return rows_of(record, 0, rows // 2), rows_of(record, rows // 2, rows)


def _schunk() -> tuple[Measurement, Measurement]:
    return definition.together("schunk_arm", EVEN), definition.together("schunk_arm", ODD)


def _arm() -> tuple[Measurement, Measurement]:
    return definition.together("two_link_arm", FITTED), definition.together("two_link_arm", JUDGED)


ROBOT_TASKS = (
    definition.Task(
        name="two-link-arm",
        title="Arm of two links, motors at both joints",
        record="two_link_arm",
        files=(*FITTED, *JUDGED),
        fitted=f"records {', '.join(FITTED)}",
        judged=f"records {' and '.join(JUDGED)}",
        mechanism=TwoLinkArm(
            upper_mass=0.5,
            upper_length=0.2,
            upper_centre=0.1,
            upper_inertia=0.02,
            lower_mass=0.6,
            lower_centre=0.2,
            lower_inertia=0.03,
            rotor_inertia=6e-5,
            gear_ratio=6.0,
        ),
        split=_arm,
        metric=definition.ForceError(),
        vary=(
            "friction.*",
            *(
                f"mechanism.{part}_{what}"
                for part in ("upper", "lower")
                for what in ("centre", "inertia")
            ),
        ),
        laws=LAWS,
        selects=False,
        settings=RecordSettings(hold="first"),
        cutoff=6.0,
        published=(
            definition.Published(
                what="levels of Coulomb friction",
                result="0.16 to 0.175 N m at the shoulder, 0.11 to 0.12 N m at the elbow",
                source="Wiebe et al. 2023",
            ),
        ),
        left_out={"pysindy": NO_LIBRARY, "mujoco": NO_MODEL},
    ),
    definition.Task(
        name="tx40",
        title="Stäubli TX40, six joints, links unknown",
        record="staubli_tx40",
        files=("train",),
        fitted="the first half",
        judged="the second half",
        mechanism=tx40_robot(),
        split=_tx40,
        metric=definition.ForceError(),
        vary=("friction.*", "links"),
        laws=LAWS,
        selects=False,
        cutoff=80.0,
        published=(
            definition.Published(
                what="Coulomb + viscous, joints 1 to 6",
                result="F_v 8.05, 5.53, 1.97, 1.11, 1.86, 0.65 N m s/rad;"
                " F_c 7.14, 8.26, 6.34, 2.48, 3.03, 0.282 N m",
                source="TX40_config.yaml of figaroh-examples",
            ),
        ),
        left_out={"pysindy": NO_LIBRARY, "mujoco": NO_MODEL},
    ),
    definition.Task(
        name="schunk-arm",
        title="Schunk arm, six joints under replayed torques, links unknown",
        record="schunk_arm",
        files=(*EVEN, *ODD),
        fitted=f"runs {', '.join(key[3:] for key in EVEN)}",
        judged=f"runs {', '.join(key[3:] for key in ODD)}, between them",
        mechanism=robot_of(SCHUNK, {}),
        split=_schunk,
        metric=definition.ForceError(),
        vary=("friction.*", "links"),
        laws=LAWS,
        selects=False,
        cutoff=6.0,
        left_out={"pysindy": NO_LIBRARY, "mujoco": NO_MODEL},
    ),
)


# The task of a hobby servo that lifts a load, in closed loop.

Array = NDArray[np.float64]

SERVO = "bam_xl330"
SUPPLY, DUTIES = 7.4, 885
"""Voltage of the supply [V], and counts of the full duty."""
DROOP = 0.14
"""Resistance of its supply [ohm]: regression of the recorded bus voltage on duty times current,
with R and k_t of the law of M3."""
GRID = 5e-3
"""Steps [s] on which records and runs are compared, as in BAM."""
SETTINGS = RecordSettings(hold="first")
"""Records are fitted under the recorded voltage."""
UNKNOWN = ("resistance", "torque_constant", "rotor_inertia")
OPEN = {"mechanism.drive.current_limit": 0.0}
"""A winding that is not connected."""
HELD_OUT = 200
"""Gain whose runs judge: the middle one. At 800 a tenth of the torque decides whether the arm goes
over the top in one run, and this run would decide the task."""
RIG = Pendulum(
    mass=0.49,
    length=0.1,
    gravity=9.80665,
    rest_angle=0.0,
    drive=DCMotor(resistance=4.0, torque_constant=0.4, rotor_inertia=1e-3, current_limit=100.0),
)


@dataclass(frozen=True, kw_only=True)
class Log:
    """One file of the servo, on an even grid."""

    name: str
    gain: int
    time: Array
    angle: Array
    goal: Array
    voltage: Array
    off: float
    """When the winding was opened [s]; infinity if it was not."""

    @property
    def volts(self) -> float:
        """Gain of its position loop [V/rad], by the formula of its firmware."""
        return self.gain * 4096.0 / (2.0 * math.pi) / (256.0 * DUTIES) * SUPPLY

    def records(self, *, loop: bool) -> Iterator[Measurement]:
        """Yield the part that was driven, by voltage or goal, and that of the open winding."""
        gain = {"mechanism.drive.loop.gain": self.volts} if loop else {}
        for label, rows in (("", self.time < self.off), (" open", self.time >= self.off)):
            if rows.any():
                t = self.time[rows]
                yield Measurement(
                    time=t - t[0],
                    position=self.angle[rows],
                    voltage=None if loop else self.voltage[rows] * (not label),
                    reference=self.goal[rows] if loop else None,
                    turning=True,
                    name=self.name + label,
                    overrides={**gain, **(OPEN if label else {})},
                )


def logs() -> list[Log]:
    """Return the measured files; the voltage is the duty times the slow part of that of the bus."""
    result, record = [], dataset(SERVO)
    for file in record.files:
        d: Any = parquet_data(record.path(file))
        t, on = d["t_s"].to_numpy(), d["torque_enable"].to_numpy(dtype=bool)
        grid = np.arange(t[0], t[-1], GRID)
        bus = d["bus_V"].rolling(61, center=True, min_periods=1).median().to_numpy()
        last = np.searchsorted(t, grid, side="right") - 1  # goals are held
        off = float(t[~on][0]) if not on.all() else math.inf
        result.append(
            Log(
                name=file,
                gain=int(file.partition("_")[0].removeprefix("kp")),
                time=grid - grid[0],
                angle=np.interp(grid, t, d["q_rad"].to_numpy()),
                goal=d["q_goal_rad"].to_numpy()[last],
                voltage=np.interp(grid, t, d["pwm_count"].to_numpy() / DUTIES * bus),
                off=off - grid[0],
            )
        )
    return result


def joined(chosen: Sequence[Log], *, loop: bool = False) -> Measurement:
    """Return files as trials of one measurement."""
    trials = tuple(record for log in chosen for record in log.records(loop=loop))
    return Measurement(trials=trials, name="xl330")


def _gains() -> tuple[Measurement, Measurement]:
    every = logs()
    own = [log for log in every if log.gain != HELD_OUT]
    return joined(own), joined([log for log in every if log.gain == HELD_OUT], loop=True)


SERVO_TASKS = (
    definition.Task(
        name="servo",
        title="Dynamixel XL330 lifting a load",
        record=SERVO,
        files=tuple(dataset(SERVO).files),
        fitted="8 runs at the gains 100 and 800, under the recorded voltage",
        judged="4 runs at the gain 200",
        mechanism=RIG,
        split=_gains,
        metric=definition.ClosedLoop(supply=SUPPLY, supply_resistance=DROOP),
        vary=("friction.*", "mechanism.rest_angle", *(f"mechanism.drive.{key}" for key in UNKNOWN)),
        laws=("coulomb-viscous", "bam-m3", "bam-m4"),
        selects=False,
        settings=SETTINGS,
        cutoff=10.0,
        published=(
            definition.Published(
                what="parameters m1 to m6 printed by BAM for this servo, fitted to other records",
                result="0.069 to 0.083 rad on the 12 runs",
                source="Duclusaud et al. 2025; errors by the notes of the catalogue",
            ),
        ),
        left_out={
            "pysindy": "what drives is a voltage behind unknown R and k_t",
            "mujoco": "its joints have no gear friction that grows with the load",
        },
    ),
)


# Tasks of reference simulations by other programs, whose laws are known.

EVERY = 10
"""Rows of the Modelica result that become one: 200 Hz."""


def _modelica() -> tuple[Measurement, Measurement]:
    table = parquet_data(dataset("modelica_friction").path()).drop_duplicates("time")
    time = np.asarray(table["time"])[::EVERY]
    record = Measurement(
        time=time,
        position=np.asarray(table["stop1.s"])[::EVERY],
        force=25.0 * np.sin(0.5 * np.pi * time),
    )
    return definition.between(record, 0.0, 3.0), definition.between(record, 3.0, 6.0)


def _siconos() -> tuple[Measurement, Measurement]:
    table = parquet_data(dataset("siconos_friction_oscillator").path())
    record = Measurement(time=np.asarray(table["t_s"]), position=np.asarray(table["x"]))
    return definition.between(record, 0.0, 12.0), definition.between(record, 12.0, 22.0)


REFERENCE_TASKS = (
    definition.Task(
        name="modelica-friction",
        title="Mass under a sine force with a Stribeck law, simulated by Dymola",
        record="modelica_friction",
        files=("reference",),
        fitted="the first 3 s",
        judged="the last 2 s",
        mechanism=Axis(inertia=1.0),
        split=_modelica,
        metric=definition.PositionError(horizon=1.0, hold="first"),
        settings=RecordSettings(hold="first"),
        cutoff=60.0,
        truth={"level": 5.0, "excess at rest": 10.0, "viscous": 1.0, "inertia": 1.0},
    ),
    definition.Task(
        name="siconos-oscillator",
        title="Oscillator with Coulomb friction, simulated by Siconos",
        record="siconos_friction_oscillator",
        files=("reference",),
        fitted="the first 12 s",
        judged="12 to 22 s",
        mechanism=Axis(inertia=1.0, stiffness=1.0),
        split=_siconos,
        metric=definition.PositionError(horizon=2.0),
        cutoff=10.0,
        truth={"level": 1.0},
        left_out={"mujoco": "nothing drives it: mujoco.sysid is given records with a force"},
    ),
)


TASKS = (*AXIS_TASKS, *CONTACT_TASKS, *ROBOT_TASKS, *SERVO_TASKS, *REFERENCE_TASKS)
"""All of them, in the order of the page."""
