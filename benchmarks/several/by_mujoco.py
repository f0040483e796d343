"""The mechanisms in MuJoCo: joints with frictionloss, which has one level."""

import functools
from collections.abc import Callable, Sequence

import numpy as np

from benchmarks.peers import Engine
from benchmarks.several.problem import (
    BENT,
    COUPLING,
    GROUND,
    LENGTH,
    LOWER,
    MU,
    SPEED,
    UPPER,
    Case,
    G,
    Run,
    levels,
    loads,
    speeds,
    torque,
)

FINE = 'timestep="0.0001" integrator="implicitfast" noslip_iterations="5"'
STIFF = 'solreffriction="0.0002 1" solimpfriction="0.999 0.9999 0.001"'
"""A time constant of two steps, and as little softness as the documentation allows."""


def chain(case: Case, stiff: str) -> str:
    bodies, pairs = "", ""
    for i, level in enumerate(levels(len(case.mechanism.coordinates))):
        bodies += (
            f'<body><joint name="x{i}" type="slide" axis="1 0 0" stiffness="{GROUND}"'
            f' frictionloss="{level}" {stiff}/><geom size="0.01" mass="1"/></body>'
        )
        if i:
            pairs += (
                f'<fixed stiffness="{COUPLING}" springlength="0">'
                f'<joint joint="x{i - 1}" coef="-1"/><joint joint="x{i}" coef="1"/></fixed>'
            )
    return f"<worldbody>{bodies}</worldbody><tendon>{pairs}</tendon>"


def arm(case: Case, stiff: str) -> str:
    def link(level: float, mass: float, place: float, more: str = "") -> str:
        return (
            f'<body pos="0 0 {place}"><joint axis="0 1 0" frictionloss="{level}" {stiff}/>'
            f'<inertial pos="0 0 {-LENGTH}" mass="{mass}" diaginertia="1e-9 1e-9 1e-9"/>'
            f"{more}</body>"
        )

    shoulder, elbow = case.kinetic
    links = link(shoulder, UPPER, 0.0, link(elbow, LOWER, -LENGTH))
    return f"<worldbody>{links}</worldbody>"


def clutches(case: Case, stiff: str) -> str:
    text = ""
    for _ in range(4):
        text = (
            f'<body><joint axis="0 0 1" frictionloss="1" {stiff}/>'
            f'<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>{text}</body>'
        )
    return f"<worldbody>{text}</worldbody>"


def build(
    world: str, option: str, start: Sequence[float], t_end: float, push: Callable | None
) -> Run:
    import mujoco

    text = f'<mujoco><option {option}><flag contact="disable"/></option>{world}</mujoco>'
    model = mujoco.MjModel.from_xml_string(text)
    data, n = mujoco.MjData(model), model.nv
    steps = round(t_end / model.opt.timestep)

    def run() -> np.ndarray:
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = start[:n], start[n:]
        if push is None:
            mujoco.mj_step(model, data, nstep=steps)
            return data.qpos.copy()
        for _ in range(steps):
            push(model, data)
            mujoco.mj_step(model, data)
        return np.cumsum(data.qpos)

    return run


def press(model, data) -> None:
    """Set the torque and the levels of the clutches."""
    data.qfrc_applied[0] = torque(data.time)
    model.dof_frictionloss[1:] = MU * loads(data.time)
    model.dof_frictionloss[0] = 0.0


def engines(name: str, case: Case) -> tuple[Engine, ...]:
    world = {"chain": chain, "arm": arm, "clutches": clutches}[name]
    n = len(case.mechanism.coordinates)
    start, push, gravity = {
        "chain": ((*[0.0] * n, *speeds(n)), None, 0.0),
        "arm": ((*BENT, 0.0, 0.0), None, -G),
        "clutches": ((*[0.0] * 4, SPEED, -SPEED, 0.0, 0.0), press, 0.0),
    }[name]
    down = f'gravity="0 0 {gravity}"'
    settings = (("defaults (2 ms)", "", ""), ("stiff, 0.1 ms, noslip", STIFF, FINE))
    return tuple(
        Engine(
            name=f"MuJoCo, joint frictionloss, {label}",
            build=functools.partial(
                build, world(case, stiff), f"{down} {option}", start, case.t_end, push
            ),
        )
        for label, stiff, option in settings
    )
