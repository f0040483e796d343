"""Do trials share one law? How often the test is wrong, what it finds, and whether slopes cover.

``python -m benchmarks.shared_law --sets 100 --seed 0``. A set is friction along the motions of
several trials with autocorrelated noise (100 Hz, 0.1 N of 5 N); under the alternative the level
rises with a temperature of 20 to 60 degC.
"""

import argparse

import numpy as np
from scipy.signal import lfilter

from stickslip import Axis, CoulombViscous, Measurement, compare_trials

LEVEL, SLOPE, NOISE = 5.0, 4.0, 0.1
CASES = (
    # trials, samples of each, memory of the noise, rise [N/degC] and scatter [N] of levels
    (2, 100, 0.0, 0.0, 0.0),
    (3, 400, 0.0, 0.0, 0.0),
    (3, 400, 0.9, 0.0, 0.0),
    (6, 400, 0.9, 0.0, 0.0),
    (3, 1000, 0.9, 0.0, 0.0),
    (3, 400, 0.9, 0.001, 0.0),
    (3, 400, 0.9, 0.002, 0.0),
    (3, 400, 0.9, 0.004, 0.0),
    (6, 400, 0.9, 0.004, 0.1),
)


def trials(
    draw: np.random.Generator, count: int, samples: int, memory: float, rise: float, scatter: float
) -> Measurement:
    """Return made-up trials, each with a motion of its own."""
    t, result = 0.01 * np.arange(samples), []
    for number, temperature in enumerate(np.linspace(20.0, 60.0, count)):
        phase, pace = draw.uniform(0.0, 6.28), draw.uniform(0.6, 1.2)
        v = 0.3 * np.sin(2.0 * np.pi * pace * t + phase) * (1.0 + 0.3 * np.sin(1.3 * t))
        noise = lfilter([1.0], [1.0, -memory], draw.normal(size=samples))
        noise *= NOISE * np.sqrt(1.0 - memory**2)
        level = LEVEL + rise * temperature + scatter * draw.normal()
        result.append(
            Measurement(
                time=t,
                velocity=v,
                friction=level * np.sign(v) + SLOPE * v + noise,
                conditions={"temperature [degC]": float(temperature)},
                name=f"run {number}",
            )
        )
    return Measurement(trials=tuple(result))


def main() -> None:
    """Print one line a case."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--sets", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    print("trials samples memory rise scatter | rejected at 5 % | slopes covered | levels covered")
    for number, case in enumerate(CASES):
        rejected, slopes, levels = 0, [], []
        for k in range(asked.sets):
            draw = np.random.default_rng([asked.seed, number, k])
            result = compare_trials(Axis(inertia=1.0), CoulombViscous, trials(draw, *case))
            rejected += not result.shared
            truth = {"friction.kinetic_coefficient": case[3], "friction.viscous_coefficient": 0.0}
            slopes += [line.low <= truth[line.path] <= line.high for line in result.lines]
            if not case[4]:
                for trial in result.trials:
                    level = LEVEL + case[3] * float(trial.conditions["temperature [degC]"])
                    levels.append(trial.estimates[0].low <= level <= trial.estimates[0].high)
        said = " ".join(f"{value:g}" for value in case)
        own = 100 * np.mean(levels) if levels else np.nan
        print(
            f"{said} | {100 * rejected / asked.sets:.0f} % | {100 * np.mean(slopes):.0f} % of"
            f" {len(slopes)} | {own:.0f} % of {len(levels)}",
            flush=True,
        )


if __name__ == "__main__":
    main()
