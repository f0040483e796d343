"""Rigs and records of which `benchmarks.golden` keeps what the public commands write."""

import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks import closed_loop_axes
from stickslip import (
    Capsule,
    Coulomb,
    CoulombViscous,
    Pendulum,
    PendulumCart,
    simulate,
)
from stickslip.data import catalogue
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import Square
from stickslip.quantities import vary

PYTHON = "python"
"""First word of a command that is a script and not `stickslip`."""


@dataclass(frozen=True, kw_only=True)
class Command:
    """A command line; what it prints is kept as ``<name>.txt``, or ``.json`` where it is JSON."""

    name: str
    line: tuple[str, ...]
    codes: tuple[int, ...] = (0,)
    """Exit codes that are no failure: 3 is a verdict too, that no law is recommended."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """A rig, what was measured on it, and commands that are run beside them."""

    name: str
    seconds: float
    """Processor time of the commands; longest cases are started first."""
    commands: tuple[Command, ...]
    prepare: Callable[[Path], None] = lambda _: None
    """Writes rig and record into a folder."""


def stickslip(name: str, line: str, *codes: int) -> Command:
    return Command(name=name, line=("stickslip", *line.split()), codes=codes or (0,))


def write(path: Path, text: str) -> None:
    path.write_text(text.lstrip("\n"), encoding="utf-8")


def script(name: str) -> Command:
    return Command(name=name, line=(PYTHON, f"{name}.py"))


TRAVELS = """
title = "Block on a table"

[mechanism]
type = "spring-block"
mass = "0.82 kg"
stiffness = "145 N/m"
compression = "60 mm"

[data]
file = "travels.csv"
"""
READINGS = """
travel [mm],uncertainty [mm],mechanism.compression [mm],name
106,1,60,run 1
105,1,60,run 2
187,1,80,run 3
189,1,80,run 4
292,1,100,run 5
"""
IN_PYTHON = '''
"""The verdict and its page by public functions instead of the command."""

from stickslip import load_rig, select
from stickslip import write_report

rig = load_rig("block.toml")
verdict = select(rig.mechanism, ["coulomb", "viscous"], rig.measurement)
print(verdict)
write_report(verdict, "python-report")
'''


def travels(folder: Path) -> None:
    write(folder / "block.toml", TRAVELS)
    write(folder / "in_python.py", IN_PYTHON)
    write(folder / "travels.csv", READINGS)


EMPS = """
title = "EMPS axis"

[mechanism]
type = "axis"
inertia = { value = "100 kg", vary = true }

[data]
file = "train.parquet"
columns = { time = "t_s", position = "q_meas_m", force = "ctrl_V" }
gain = { force = 35.15065188248547 }
"""


def emps(folder: Path) -> None:
    write(folder / "axis.toml", EMPS)
    shutil.copy(catalogue.dataset("emps").path("train"), folder)


FORCE_MAP = """
title = "Force map at three temperatures"

[mechanism]
type = "axis"
inertia = 1

[data]
files = ["cold.csv", "warm.csv", "hot.csv"]
conditions = ["temperature"]
"""


def force_map(folder: Path) -> None:
    """Write three trials whose level rises by 0.01 N per degree."""
    random, time = np.random.default_rng(0), 0.005 * np.arange(600)
    for number, (name, temperature) in enumerate({"cold": 20, "warm": 40, "hot": 60}.items(), 1):
        v = 0.3 * np.sin(2 * np.pi * (0.7 + 0.1 * number) * time)
        friction = (5.0 + 0.01 * temperature) * np.sign(v) + 4.0 * v
        columns = {
            "time": time,
            "velocity": v,
            "friction": friction + 0.1 * random.normal(size=len(time)),
            "temperature [degC]": temperature,
        }
        pd.DataFrame(columns).to_csv(folder / f"{name}.csv", index=False)
    write(folder / "map.toml", FORCE_MAP)


TRIBOMETER = """
title = "Reciprocating tribometer"

[mechanism]
type = "axis"
inertia = 1

[data]
file = "loops.parquet"
columns = { time = "t_s", position = "x_m", load = "normal_N", friction = "friction_N" }
gain = { friction = -1 }
"""


def tribometer(folder: Path) -> None:
    table = pd.read_parquet(catalogue.dataset("reciprocating_tribometer").path("train"))
    table[table["t_s"].between(12.0, 30.0)].to_parquet(folder / "loops.parquet")
    write(folder / "tribometer.toml", TRIBOMETER)


PENDULUM = """
title = "Pendulum left to swing"

[mechanism]
type = "pendulum"
mass = "200 g"
length = "50 cm"
"""
DECAY = """
[data]
file = "decay.csv"
"""
MOTOR = """
[mechanism.drive]
type = "sine"
amplitude = 0.2
frequency = 0.6

[run]
t_end = "10 s"
"""


def pendulum(folder: Path) -> None:
    """Write a decay, as an angle encoder with noise would see it."""
    t = np.arange(0.0, 15.0, 0.01)
    law = CoulombViscous(kinetic_coefficient=0.02, viscous_coefficient=0.003)
    run = simulate(Pendulum(mass=0.2, length=0.5), law, t_end=15.0, y0={"theta": 0.5})
    angle = run.at(np.minimum(t, run.t[-1]))["theta"]
    angle = angle + 1e-3 * np.random.default_rng(0).normal(size=len(t))
    pd.DataFrame({"time [s]": t, "position [rad]": angle}).to_csv(folder / "decay.csv", index=False)
    write(folder / "pendulum.toml", PENDULUM + DECAY)
    write(folder / "driven.toml", PENDULUM + MOTOR)


SLIDER = """
title = "Slider on paper"

[mechanism]
type = "towed-block"
mass = { value = "30.7 g", vary = true }
stiffness = "1002 N/m"
speed = "4.3 mm/s"

[data]
file = "k1002_v4300.parquet"
columns = { time = "t_s", spring_force = "F_over_mg" }
units = { spring_force = "1" }
"""


def slider(folder: Path) -> None:
    shutil.copy(catalogue.dataset("spring_pulled_slider").path("k1002_v4300"), folder)
    write(folder / "slider.toml", SLIDER)


CAPSULE = """
title = "Capsule with a square wave"

[mechanism]
type = "capsule"
capsule_mass = "800 g"
inner_mass = "200 g"
stiffness = "80 N/m"
damping = "0.8 N s/m"

[mechanism.drive]
type = "torque"
drive = { type = "square", high = "6 N", low = "-1 N", period = "400 ms", duty = "30 %" }

[friction.coulomb]
kinetic_coefficient = 0.25
static_coefficient = 0.3

[run]
t_end = "6 s"

[data]
file = "travels.csv"
"""


def capsule(folder: Path) -> None:
    """Write how far a capsule came, by period and duty of its drive."""
    wave = Torque(drive=Square(high=6.0, low=-1.0, period=0.4, duty=0.3))
    rig = Capsule(capsule_mass=0.8, inner_mass=0.2, stiffness=80.0, damping=0.8, drive=wave)
    law = Coulomb(kinetic_coefficient=0.18, static_coefficient=0.24)
    period, duty = "mechanism.drive.drive.period", "mechanism.drive.drive.duty"
    rows = []
    for T, D in product((0.3, 0.4, 0.5), (0.2, 0.3, 0.4)):
        run = simulate(vary(rig, "mechanism", {period: T, duty: D}), law, t_end=6.0)
        travel = 1e3 * run["x"][-1]
        rows.append({"travel [mm]": travel, f"{period} [s]": T, f"{duty} [1]": D})
    table = pd.DataFrame(rows)
    table["travel [mm]"] += np.random.default_rng(2).normal(0.0, 2.0, len(table))
    table["travel [mm]"] = table["travel [mm]"].round()
    table["uncertainty [mm]"] = 2.0
    table.to_csv(folder / "travels.csv", index=False)
    write(folder / "capsule.toml", CAPSULE)


CART = """
title = "Cart whose pendulum is turned by a motor"

[mechanism]
type = "pendulum-cart"
cart_mass = "500 g"
ball_mass = "100 g"
length = "30 cm"
pivot_stiffness = 2.0
pivot_damping = 0.02

[mechanism.pendulum]
type = "torque"
drive = { type = "square", high = 0.5, low = -0.2, period = "500 ms", duty = "30 %" }

[run]
t_end = "3 s"

[data]
file = "cart.csv"
"""


def torque_cart(folder: Path) -> None:
    """Write the position of a cart, as a camera would see it."""
    turns = Torque(drive=Square(high=0.5, low=-0.2, period=0.5, duty=0.3))
    cart = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pivot_stiffness=2.0, pivot_damping=0.02,
        pendulum=turns,
    )  # fmt: skip
    law = Coulomb(kinetic_coefficient=0.18, static_coefficient=0.24)
    t = np.arange(0.0, 3.0, 0.005)
    x = simulate(cart, law, t_end=3.0).at(t)["x"]
    x = x + 3e-4 * np.random.default_rng(1).normal(size=len(t))
    pd.DataFrame({"time [s]": t, "position [m]": x}).to_csv(folder / "cart.csv", index=False)
    write(folder / "cart.toml", CART)


STEPS = '''
"""Velocity steps of a made-up record, whose a and b overshoot tells apart."""

import json

import numpy as np

from stickslip import Measurement, TowedBlock
from stickslip.friction import RateState
from stickslip.identify.kinds import fit_rate_state, simulate_velocity_steps

law = RateState(
    reference_coefficient=0.6,
    direct_effect=0.010,
    evolution_effect=0.014,
    critical_distance=10e-6,
    reference_velocity=1e-6,
)
knots, pull = [0.0, 20.0, 60.0], [0.0, 20e-6, 420e-6]
t = np.arange(0.0, 60.0, 0.05)
run = simulate_velocity_steps(law, stiffness=2e3, time=knots, pull=pull, at=t)
noise = np.random.default_rng(0).normal(0.0, 3e-4, len(t))
friction = run.coefficient + noise
record = Measurement(time=t, pull=np.interp(t, knots, pull), friction=friction, load=1.0)
machine = TowedBlock(mass=1e-3, stiffness=1e3, speed=1e-6, load=1.0)
free = ["friction.*", "mechanism.stiffness"]
names = {"ageing": "rate-and-state", "slip": "rate-and-state-slip"}
fits = {key: fit_rate_state(machine, name, record, vary=free) for key, name in names.items()}
print(json.dumps({name: fit.to_dict() for name, fit in fits.items()}))
'''
ROCK = '''
"""The velocity step of sepiolite gouge."""

from stickslip import TowedBlock
from stickslip.data import catalogue
from stickslip.identify.kinds import fit_rate_state

machine = TowedBlock(mass=1e-3, stiffness=1e3, speed=2e-7, load=1.0)
record = catalogue.dataset("rock_velocity_step").measurement()
free = ["friction.*", "mechanism.stiffness"]
print(fit_rate_state(machine, "rate-and-state", record, vary=free))
'''
GOUGE = """
title = "Sepiolite gouge"

[mechanism]
type = "towed-block"
mass = "1 g"
stiffness = { value = "1 kN/m", vary = true }
speed = "0.2 um/s"
load = "1 N"

[data]
file = "sepiolite.parquet"
columns = { time = "t_s", pull = "disp_um", friction = "mu" }
gain = { pull = 1e-6 }
"""


def rate_and_state(folder: Path) -> None:
    write(folder / "steps.py", STEPS)
    write(folder / "rock.py", ROCK)
    write(folder / "gouge.toml", GOUGE)
    shutil.copy(catalogue.dataset("rock_velocity_step").path("sepiolite"), folder)


CONTROLLED = """
title = "Axis under control"

[mechanism]
type = "axis"
inertia = {{ value = {inertia:.3g}, vary = true }}

[data]
file = "axis.csv"
"""


def controlled(truth: str, seed: int) -> Callable[[Path], None]:
    """Return what writes two records of a random axis, and its rig file with 1.5 times its mass."""

    def prepare(folder: Path) -> None:
        random = np.random.default_rng(seed)
        rig = replace(closed_loop_axes.draw(random, truth), duration=10.0)
        for name in ("axis", "later"):
            record = closed_loop_axes.record(rig, random)
            columns = {"time": record.time, "position": record.position, "force": record.force}
            pd.DataFrame(columns).to_csv(folder / f"{name}.csv", index=False)
        write(folder / "axis.toml", CONTROLLED.format(inertia=1.5 * rig.axis.inertia))

    return prepare


SLIDE = """
title = "Slide that is pushed to and fro"

[mechanism]
type = "axis"
inertia = "3 kg"

[[mechanism.drive]]
type = "sine"
amplitude = "40 N"
frequency = "2 Hz"

[friction.stribeck]
kinetic_coefficient = 20
static_coefficient = 28
stribeck_velocity = "30 mm/s"
viscous_coefficient = 40

[friction.lugre]
kinetic_coefficient = 20
static_coefficient = 28
stribeck_velocity = "30 mm/s"
bristle_stiffness = 1e5
bristle_damping = 300

[friction.direction-dependent]
forward_kinetic_coefficient = 15
backward_kinetic_coefficient = 18

[run]
t_end = "2 s"
"""


EXPORTED = '''
"""Each law to each target, in one process."""

from stickslip import export, load_rig

rig = load_rig("slide.toml")
for law, targets in {
    "stribeck": ("c", "matlab", "urdf", "csv", "json"),
    "lugre": ("c",),
    "direction-dependent": ("c", "mjcf"),
}.items():
    for to in targets:
        code = export(rig, to, law=law, name="slide")
        code.save(f"{law}-{to}")
        print(law, to, *code.files, *code.remarks, sep="\\n  ")
'''


def slide(folder: Path) -> None:
    """Write an axis with three laws, and what exports them."""
    write(folder / "slide.toml", SLIDE)
    write(folder / "exported.py", EXPORTED)


RUN = "--law {}-report/law.toml -o run.csv"
PLAIN = "coulomb,coulomb-viscous"
CASES: tuple[Case, ...] = (
    Case(
        name="paper",
        seconds=30,
        commands=(
            stickslip("select", "demo"),
            stickslip("simulate", f"simulate demo {RUN.format('demo')} --report"),
            stickslip("published", "simulate demo --law stribeck --json"),
            stickslip("fit", "fit demo --law coulomb-viscous --json -o fitted.toml"),
        ),
    ),
    Case(
        name="travels",
        seconds=28,
        prepare=travels,
        commands=(
            stickslip("select", "select block.toml"),
            stickslip(
                "simulate", f"simulate block.toml {RUN.format('block')} --ensemble 50 --report"
            ),
            stickslip("fit", "fit block.toml --law coulomb-viscous -o fitted.toml"),
            stickslip("plan", "plan block.toml --laws coulomb,viscous --json"),
            script("in_python"),
        ),
    ),
    Case(
        name="emps",
        seconds=20,
        prepare=emps,
        commands=(
            stickslip(
                "select",
                "select axis.toml",
                0,
                3,
            ),
            stickslip("check", "check axis.toml --json"),
        ),
    ),
    Case(
        name="force-map",
        seconds=10,
        prepare=force_map,
        commands=(
            stickslip("select", "select map.toml"),
            stickslip("fit", "fit map.toml --law coulomb-viscous --json -o fitted.toml"),
            stickslip("check", "check map.toml"),
        ),
    ),
    Case(
        name="tribometer",
        seconds=40,
        prepare=tribometer,
        commands=(
            stickslip(
                "select",
                "select tribometer.toml",
            ),
            stickslip("fit", "fit tribometer.toml --law dahl --json -o fitted.toml"),
        ),
    ),
    Case(
        name="pendulum",
        seconds=22,
        prepare=pendulum,
        commands=(
            stickslip("select", "select pendulum.toml"),
            stickslip("simulate", f"simulate driven.toml {RUN.format('pendulum')} --json"),
            stickslip("fit", "fit pendulum.toml --law coulomb-viscous --starts 2"),
        ),
    ),
    Case(
        name="slider",
        seconds=12,
        prepare=slider,
        commands=(
            stickslip("select", "select slider.toml --laws coulomb,stribeck"),
            stickslip("simulate", f"simulate slider.toml {RUN.format('slider')} --t-end 0.5"),
            stickslip("fit", "fit slider.toml --law coulomb --json -o fitted.toml"),
        ),
    ),
    Case(
        name="capsule",
        seconds=30,
        prepare=capsule,
        commands=(
            stickslip("select", f"select capsule.toml --laws {PLAIN}"),
            stickslip(
                "simulate", f"simulate capsule.toml {RUN.format('capsule')} --ensemble 50 --report"
            ),
        ),
    ),
    Case(
        name="torque-cart",
        seconds=16,
        prepare=torque_cart,
        commands=(
            stickslip("select", "select cart.toml"),
            stickslip("simulate", f"simulate cart.toml {RUN.format('cart')} --json"),
        ),
    ),
    Case(
        name="rate-and-state",
        seconds=20,
        prepare=rate_and_state,
        commands=(
            script("steps"),
            script("rock"),
            stickslip("refused", "fit gouge.toml --law coulomb", 2),
            stickslip("fit", "fit gouge.toml"),
            stickslip("select", "select gouge.toml --laws constant-coefficient,logarithmic"),
        ),
    ),
    Case(
        name="axis-stribeck",
        seconds=10,
        prepare=controlled("stribeck", 6),
        commands=(
            stickslip(
                "select",
                "select axis.toml --validate later.csv",
                0,
                3,
            ),
        ),
    ),
    Case(
        name="axis-lugre",
        seconds=40,
        prepare=controlled("lugre", 4),
        commands=(stickslip("select", "select axis.toml", 0, 3),),
    ),
    Case(
        name="exports",
        seconds=6,
        prepare=slide,
        commands=(
            script("exported"),
            stickslip("mjcf", "export slide.toml --law stribeck --to mjcf --name slide"),
        ),
    ),
)
