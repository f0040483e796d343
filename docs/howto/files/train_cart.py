"""Train a policy for stickslip/Cart-v0 by CMA-ES: python train_cart.py [cart-policy.json].

The policy leads the pendulum along a periodic swing of three harmonics with feedback of angle and
rate. Its 11 numbers are sought for the largest travel per energy in episodes of five seconds from
rest on. All candidates of a generation step together in one vectorised environment.
"""

import json
import sys
from pathlib import Path

import cma
import numpy as np

from stickslip.exports import CART, MotorVectorEnvironment

CANDIDATES, EPISODES, GENERATIONS = 32, 4, 120
"""Candidates of a generation, episodes of each, generations."""
NAMES = (
    "frequency", "offset", "sine_1", "sine_2", "cosine_2", "sine_3", "cosine_3",
    "stiffness", "damping", "gravity", "ramp",
)  # fmt: skip
START = np.array([1.4, 0.0, 0.6, 0.1, 0.1, 0.0, 0.0, 8.0, 0.6, 0.3, 0.3])
"""Hz, rad, rad ..., N m/rad, N m s/rad, N m, s."""
SCALE = np.array([0.3, 0.1, 0.2, 0.15, 0.15, 0.1, 0.1, 3.0, 0.3, 0.1, 0.1])
"""Sizes that the search begins with."""
FELL = 1.0
"""What an episode that ends early takes from the travel [m]."""
SMALL = 0.2
"""Work that is added to that of an episode [J], so that hardly moving is no solution."""


def act(policy, t, seen):
    """Return the action of policies (..., 11) at a time, for observations (..., 3)."""
    frequency, offset, a1, a2, b2, a3, b3, stiffness, damping, gravity, ramp = np.moveaxis(
        policy, -1, 0
    )
    w = 2.0 * np.pi * np.abs(frequency)
    grown = 1.0 - np.exp(-t / (np.abs(ramp) + 1e-3))
    phase = w * t
    place = a1 * np.sin(phase) + a2 * np.sin(2 * phase) + b2 * np.cos(2 * phase)
    place = place + a3 * np.sin(3 * phase) + b3 * np.cos(3 * phase)
    rate = a1 * np.cos(phase) + 2 * (a2 * np.cos(2 * phase) - b2 * np.sin(2 * phase))
    rate = w * (rate + 3 * (a3 * np.cos(3 * phase) - b3 * np.sin(3 * phase)))
    theta, omega = seen[..., 1], seen[..., 2]
    torque = stiffness * (offset + grown * place - theta) + damping * (grown * rate - omega)
    torque = torque - gravity * np.sin(theta)
    return np.clip(torque / CART.effort_limit, -1.0, 1.0)


def scores(envs, policies, seed):
    """Return travel over work of each policy (n,) in some episodes [m/J], from rest on."""
    each = np.repeat(policies, EPISODES, axis=0)
    seen, info = envs.reset(seed=seed)
    over = np.zeros(len(each), dtype=bool)
    travel, work = np.zeros(len(each)), np.zeros(len(each))
    for step in range(envs.task.steps):
        actions = act(each, step * envs.task.period, seen)
        seen, _, terminated, truncated, info = envs.step(actions[:, None])
        travel, work = (
            np.where(over, old, info[k]) for k, old in (("travel", travel), ("work", work))
        )
        fallen = terminated & ~over
        travel[fallen] -= FELL
        over |= terminated | truncated
    return (travel / (work + SMALL)).reshape(-1, EPISODES).mean(axis=1)


def train(generations=GENERATIONS, *, seed=1, told=print):
    """Return the best policy (11,) and its mean score [m/J]."""
    envs = MotorVectorEnvironment(CANDIDATES * EPISODES, "cart")
    options = {"popsize": CANDIDATES, "seed": seed, "verbose": -9}
    search = cma.CMAEvolutionStrategy(np.zeros(len(START)), 1.0, options)
    for generation in range(generations):
        points = search.ask()
        found = scores(envs, START + SCALE * np.array(points), seed=generation)
        search.tell(points, (-found).tolist())
        if generation % 10 == 0:
            told(f"generation {generation}: best {found.max():+.4f} m/J")
    policy = START + SCALE * search.result.xfavorite  # the mean of what is left
    mean = float(scores(envs, np.tile(policy, (CANDIDATES, 1)), seed=10**6).mean())
    return policy, mean


if __name__ == "__main__":
    best, mean = train()
    text = json.dumps({"score": mean, **dict(zip(NAMES, best.tolist(), strict=True))}, indent=2)
    print(text)
    if len(sys.argv) > 1:
        Path(sys.argv[1]).write_text(text + "\n", encoding="utf-8")
