"""Steps of many carts at once, here and in MuJoCo: python -m benchmarks.environments.

A step is one period of the control, in which each motor holds its torque. MuJoCo's carts step by
its own `rollout` on as many threads. All get the same torques, so that travels can be compared.
"""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from benchmarks import tables
from benchmarks.measuring import Section
from stickslip.exports import CART
from stickslip.exports.gym import Steps

Array = NDArray[np.float64]
COUNT, STEPS = 256, 100
SHARE = 0.3
"""Of the largest torque: random torques of this size move all carts and lift none off."""
SEED = 0
GOAL = 1000.0
"""Vectorised steps a second."""
WORLD = """
<mujoco><option gravity="0 0 -{g}" {option}/>
  <default><geom {stiff}/></default>
  <worldbody>
    {ground}
    <body pos="0 0 0.05"><joint type="slide" axis="1 0 0" {loss}/>{vertical}
      <geom type="box" size="0.1 0.05 0.05" mass="{M}" friction="{mu} 0.005 0.0001"/>
      <body><joint name="pivot" type="hinge" axis="0 -1 0"/>
        <geom type="sphere" size="0.001" pos="0 0 {l}" mass="{m}" contype="0" conaffinity="0"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="pivot"/></actuator>
</mujoco>"""
PLANE = '<geom type="plane" size="100 1 1" friction="{mu} 0.005 0.0001"/>'
STIFF = (
    0.0001,
    'cone="elliptic" impratio="100"',
    'solref="0.0003 1" solimp="0.99 0.9999 0.0001"',
)
"""Time constant of the contact of three steps instead of 20 ms, in which a load lags."""
SETTINGS = (
    ("MuJoCo, contact, defaults (2 ms)", True, 0.002),
    ("MuJoCo, joint frictionloss, defaults (2 ms)", False, 0.002),
    ("MuJoCo, stiff contact, elliptic, 0.1 ms", True, *STIFF),
)
"""Name, whether the load is that of the contact, time step [s], options, those of contacts."""


@dataclass(frozen=True)
class Measured:
    """A setting: time and processor time of a vectorised step [s], places at the end."""

    name: str
    wall: float
    processor: float
    places: Array


def torques(count: int, steps: int) -> Array:
    """Return the share of the largest torque in each step (steps, count)."""
    return np.random.default_rng(SEED).uniform(-SHARE, SHARE, (steps, count))


def starts(count: int) -> Array:
    """Return the states at which the carts begin (count, 4)."""
    result = np.zeros((count, 4))
    result[:, 1] = np.random.default_rng(SEED + 1).uniform(
        -CART.start_spread, CART.start_spread, count
    )
    return result


def timed(name: str, step: Callable[[Array], object], told: Array, places: Callable[[], Array]):
    """Return what the steps took."""
    wall, processor = time.perf_counter(), time.process_time()
    for actions in told:
        step(actions)
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    return Measured(name, wall / len(told), processor / len(told), places())


def by_stickslip(count: int, steps: int, threads: int) -> Measured:
    """Step the carts of this package."""
    carts = Steps(CART, count, threads=threads)
    rows = np.arange(count)
    for _ in range(2):  # the first time is that of loading
        carts.begin(rows, [np.random.default_rng(SEED + 1)] * count)
        name = f"stickslip, {threads} thread{'s' * (threads > 1)}"
        result = timed(name, carts.step, torques(count, steps), lambda: carts.states[:, 0])
    return result


def by_mujoco(
    count: int,
    steps: int,
    threads: int,
    name: str,
    contact: bool,
    dt: float,
    option: str = "",
    stiff: str = "",
) -> Measured:
    """Step the same carts in MuJoCo."""
    import mujoco
    from mujoco import rollout

    cart, mu = CART.mechanism, CART.law.kinetic_coefficient
    weight = cart.gravity * (cart.cart_mass + cart.ball_mass)
    text = WORLD.format(
        g=cart.gravity, M=cart.cart_mass, m=cart.ball_mass, l=cart.length, mu=mu,
        option=f'timestep="{dt}" {option}', stiff=stiff,
        ground=PLANE.format(mu=mu) if contact else "",
        vertical='<joint type="slide" axis="0 0 1"/>' if contact else "",
        loss="" if contact else f'frictionloss="{mu * weight}"',
    )  # fmt: skip
    model = mujoco.MjModel.from_xml_string(text)
    data, substeps = mujoco.MjData(model), round(CART.period / dt)
    full = mujoco.mjtState.mjSTATE_FULLPHYSICS
    if contact:
        mujoco.mj_step(model, data, nstep=round(0.2 / dt))  # until the soft contact has sunk in
    places = 2 if contact else 1  # that of the pivot among the coordinates
    first = np.empty((count, mujoco.mj_stateSize(model, full)))
    begin = starts(count)
    for row in range(count):
        data.qpos[0], data.qpos[places] = begin[row, 0], begin[row, 1]
        data.qvel[:] = 0.0
        mujoco.mj_getState(model, data, first[row], full)
    with rollout.Rollout(nthread=threads) as pool:
        workers = [mujoco.MjData(model) for _ in range(threads)]
        state = first.copy()

        def step(actions: Array) -> None:
            told = np.broadcast_to(actions[:, None, None] * CART.effort_limit, (count, substeps, 1))
            state[:] = pool.rollout(model, workers, state, np.ascontiguousarray(told))[0][:, -1]

        return timed(name, step, torques(count, steps), state[:, 1].copy)


def run(count: int = COUNT, steps: int = STEPS, threads: int | None = None) -> Section:
    """Run the case."""
    most = threads or os.cpu_count() or 1
    own = [by_stickslip(count, steps, t) for t in sorted({1, most})]
    exact = own[0].places
    others = []
    if find_spec("mujoco") is not None:
        others = [by_mujoco(count, steps, most, *setting) for setting in SETTINGS]
    best = own[-1]
    rows = tuple(
        (
            other.name,
            f"{1.0 / other.wall:.0f}",
            f"{1e3 * other.processor:.3g}",
            f"{other.processor / best.processor:.2g}",
            f"{1e3 * np.median(np.abs(other.places - exact)):.2g}",
        )
        for other in (*own, *others)
    )
    notes = (
        f"- {count} carts, {steps} steps of {1e3 * CART.period:g} ms with random torques up to"
        f" {SHARE * CART.effort_limit:g} N m; goal {GOAL:g} steps of all carts a second on two"
        " processors. Processor time does not depend on what else the machine does.",
        "- Difference: of the carts' places at the end from those of the first row, the median."
        " Pendulums fall meanwhile, so that differences grow exponentially.",
        *(() if others else ("- MuJoCo is not installed: `pip install mujoco`.",)),
    )
    heads = (
        "engine", "steps/s", "processor time of a step, ms", "over stickslip's", "difference, mm"
    )  # fmt: skip
    return Section(title="Environments", heads=heads, rows=rows, notes=notes)


if __name__ == "__main__":
    print("\n".join(tables.section(run())))
