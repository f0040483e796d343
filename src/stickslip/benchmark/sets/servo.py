"""The task of a hobby servo that lifts a load, in closed loop."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from stickslip.benchmark.definition import Published, Task
from stickslip.benchmark.metrics import ClosedLoop
from stickslip.catalogue import dataset
from stickslip.experiments import Measurement
from stickslip.identification import RecordSettings
from stickslip.mechanisms import DCMotor, Pendulum

Array = NDArray[np.float64]

SERVO = "bam_xl330"
SUPPLY, DUTIES = 7.4, 885
"""Voltage of the supply [V], and counts of the full duty."""
DROOP = 0.14
"""Resistance of its supply [ohm]: regression of the recorded bus voltage on duty times current,
with R and k_t of the law of M3."""
GRID = 5e-3
"""Steps [s] on which records and runs are compared, as in BAM."""
SETTINGS = RecordSettings(hold="first", segment=2.0, resolution=80, starts=4, position_zeros=False)
"""Records are simulated under the recorded voltage, in segments of 2 s: in those of 1 s, searches
end at resistances of less than 0.1 ohm."""
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


@final
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
    import pandas as pd

    found, record = [], dataset(SERVO)
    for file in record.files:
        d: Any = pd.read_parquet(record.path(file))
        t, on = d["t_s"].to_numpy(), d["torque_enable"].to_numpy(dtype=bool)
        grid = np.arange(t[0], t[-1], GRID)
        bus = d["bus_V"].rolling(61, center=True, min_periods=1).median().to_numpy()
        last = np.searchsorted(t, grid, side="right") - 1  # goals are held
        off = float(t[~on][0]) if not on.all() else math.inf
        found.append(
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
    return found


def joined(chosen: Sequence[Log], *, loop: bool = False) -> Measurement:
    """Return files as trials of one measurement."""
    trials = tuple(record for one in chosen for record in one.records(loop=loop))
    return Measurement(trials=trials, name="xl330")


def _gains() -> tuple[Measurement, Measurement]:
    every = logs()
    own = [one for one in every if one.gain != HELD_OUT]
    return joined(own), joined([one for one in every if one.gain == HELD_OUT], loop=True)


TASKS = (
    Task(
        name="servo",
        title="Dynamixel XL330 lifting a load",
        record=SERVO,
        files=tuple(dataset(SERVO).files),
        fitted="8 runs at the gains 100 and 800, under the recorded voltage",
        judged="4 runs at the gain 200",
        mechanism=RIG,
        split=_gains,
        metric=ClosedLoop(supply=SUPPLY, supply_resistance=DROOP),
        vary=("friction.*", "mechanism.rest_angle", *(f"mechanism.drive.{one}" for one in UNKNOWN)),
        laws=("coulomb-viscous", "bam-m3", "bam-m4"),
        selects=False,
        route="shooting",
        settings=SETTINGS,
        cutoff=10.0,
        published=(
            Published(
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
