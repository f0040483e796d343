"""Baselines for stickslip/Capsule-v0 whose ground is known by a measurement only.

python train_capsule.py [PPO steps] trains and scores them, with PPO if stable-baselines3 is
installed. Episodes draw a law of the ensemble of a verdict, and an incline. The laws that score are
other draws than those of training. `score` takes any policy: a function of the step and of what is
observed (n, 3) that returns actions (n,).
"""

import dataclasses
import sys
import time
from importlib.util import find_spec

import cma
import gymnasium
import numpy as np

from stickslip import Axis, Measurement, Stribeck, select
from stickslip.exports import CAPSULE, MotorEnvironment, MotorVectorEnvironment
from stickslip.mechanisms.drives import ThreePhase

TASK = dataclasses.replace(CAPSULE, work_weight=0.5 * CAPSULE.work_weight)
"""Half the weight, so that going up and over rough ground is worth more than staying."""
VARY = {"incline": np.radians(np.linspace(-2.0, 2.0, 9))}
EPISODES, GENERATIONS = 128, 15
SEEDS = {"measurement": 1, "training": 0, "laws that score": 1, "episodes that score": 1000}


def measured():
    """Return the verdict on 15 readings of sliding friction, made up with 3 % of noise."""
    law = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.05)
    speeds, loads = np.geomspace(0.005, 1.0, 15), np.resize([4.0, 6.0, 8.0], 15)
    noise = 0.03 * np.random.default_rng(SEEDS["measurement"]).normal(size=15)
    forces = [float(law.force(v, n)) for v, n in zip(speeds, loads, strict=True)]
    table = Measurement(velocity=speeds, load=loads, friction=forces * (1.0 + noise))
    return select(Axis(inertia=1.0), None, table)


def score(policy, laws, *, seed=SEEDS["episodes that score"], episodes=EPISODES):
    """Return travel [m] and work [J] of episodes (n,), each with a law and an incline."""
    envs = MotorVectorEnvironment(episodes, TASK, laws=laws, vary=VARY)
    seen, _ = envs.reset(seed=seed)
    over = np.zeros(episodes, dtype=bool)
    travel, work = np.zeros(episodes), np.zeros(episodes)
    for step in range(TASK.steps):
        seen, _, terminated, truncated, info = envs.step(policy(step, seen)[:, None])
        travel, work = np.where(over, (travel, work), (info["travel"], info["work"]))
        over |= terminated | truncated
    return travel, work


def returned(policy, laws, seed):
    """Return the mean of the worst quarter of 32 returns of a policy [m]."""
    travel, work = score(policy, laws, seed=seed, episodes=32)
    return float(np.sort(travel - TASK.work_weight * work)[:8].mean())


def constant(laws):
    """Return the policy that holds the best of 21 efforts."""

    def holding(effort):
        return lambda _, seen: np.full(len(seen), effort)

    efforts = np.linspace(-1.0, 1.0, 21)
    return holding(max(efforts, key=lambda one: returned(holding(one), laws, 0)))


def following(profile):
    """Return the policy that leads the inner mass along a profile.

    The effort brings the rate to that of the profile within a period, with a tenth of what the
    place is behind made up for in each period.
    """
    capsule, period = TASK.mechanism, TASK.period
    mass = 1.0 / (1.0 / capsule.capsule_mass + 1.0 / capsule.inner_mass)
    cycle = float(profile.period)

    def policy(step, seen):
        place, _ = profile.at(step * period % cycle)
        _, rate = profile.at((step + 1) * period % cycle)
        missing = rate + 0.1 * (place - seen[:, 1]) / period - seen[:, 2]
        return np.clip(mass * missing / period / TASK.effort_limit, -1.0, 1.0)

    return policy


def optimised(laws, start):
    """Return the profile that CMA-ES finds from a start, for the worst quarter of episodes."""
    names = ("amplitude", "fast", "slow", "last")
    sizes = np.array([start.amplitude, start.fast, start.slow, start.slow])

    def profile_at(point):
        given = dict(zip(names, (sizes * np.exp(point)).tolist(), strict=True))
        return dataclasses.replace(start, **given)

    search = cma.CMAEvolutionStrategy(
        np.zeros(4), 0.2, {"popsize": 10, "seed": SEEDS["training"] + 1, "verbose": -9}
    )
    for generation in range(GENERATIONS):
        points = search.ask()
        values = [returned(following(profile_at(p)), laws, generation) for p in points]
        search.tell(points, [-value for value in values])
    return profile_at(search.result.xfavorite)


def learned(laws, steps, profile=None):
    """Return what PPO of stable-baselines3 learns: efforts, or what is added to a profile."""
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize

    follow = (lambda _, seen: np.zeros(len(seen))) if profile is None else following(profile)
    rate = 0.0 if profile is None else 2.0 * np.pi * TASK.period / float(profile.period)

    def with_phase(step, seen):
        phase = np.full((len(seen), 1), rate * step)
        return np.hstack([seen, np.sin(phase), np.cos(phase)])

    class Corrected(gymnasium.Wrapper):
        """Sees the phase of the profile too; actions are beside those that follow it."""

        def __init__(self):
            super().__init__(MotorEnvironment(TASK, laws=laws, vary=VARY))
            self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (5,))

        def reset(self, **given):
            self.done, (self.seen, info) = 0, self.env.reset(**given)
            return with_phase(0, self.seen[None])[0], info

        def step(self, action):
            effort = follow(self.done, self.seen[None]) + action
            self.seen, *rest = self.env.step(np.clip(effort, -1.0, 1.0))
            self.done += 1
            return with_phase(self.done, self.seen[None])[0], *rest

    torch.set_num_threads(1)
    envs = VecNormalize(DummyVecEnv([Corrected] * 16), gamma=0.99)
    model = PPO(
        "MlpPolicy", envs, n_steps=512, batch_size=512, seed=SEEDS["training"], device="cpu",
        policy_kwargs={"log_std_init": -2.0},
    )  # fmt: skip
    model.learn(steps)

    def policy(step, seen):
        given = envs.normalize_obs(with_phase(step, seen))
        action = model.predict(given, deterministic=True)[0][:, 0]
        return np.clip(follow(step, seen) + action, -1.0, 1.0)

    return policy


def table(steps=300_000):
    """Print the table."""
    verdict = measured()
    laws = verdict.sample(20, seed=SEEDS["training"])
    others = verdict.sample(20, seed=SEEDS["laws that score"])
    start = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    makers = {
        "best constant effort": lambda: constant(laws),
        "three-phase profile": lambda: following(start),
        "optimised profile": lambda: following(optimised(laws, start)),
        f"PPO, {steps:,} steps": lambda: learned(laws, steps),
        f"PPO beside the three-phase profile, {steps:,} steps": lambda: learned(laws, steps, start),
    }
    print(
        "| policy | return, mm: mean | worst | speed, mm/s: mean | worst | travel per energy, m/J"
        " | processor time, s |\n|---|---|---|---|---|---|---|"
    )
    for name, make in makers.items():
        if name.startswith("PPO") and find_spec("stable_baselines3") is None:
            print(f"| {name} | not run: pip install stable-baselines3 |")
            continue
        begun = time.process_time()
        policy = make()
        spent = time.process_time() - begun
        travel, work = score(policy, others)
        gain, speed = 1e3 * (travel - TASK.work_weight * work), 1e3 * travel / TASK.duration
        print(
            f"| {name} | {gain.mean():.1f} | {gain.min():.1f} | {speed.mean():.1f} |"
            f" {speed.min():.1f} | {travel.sum() / max(work.sum(), 1e-300):.4f} | {spent:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    table(*map(int, sys.argv[1:]))
