"""Friction of a measured robot whose links nobody knows, beside published values.

``python -m benchmarks.robot_records`` fits Coulomb and viscous friction of all joints of the
Stäubli TX40 with its links (``vary="links"``), prints what was found with 95 % intervals beside the
values that figaroh-examples states, and predicts each half of the record from the other half.
"""

import argparse
import math

import numpy as np

from stickslip import CoulombViscous, Measurement, catalogue, fit
from stickslip.benchmark.sets.robots import by_motors, tx40_robot
from stickslip.identification import RecordFit

PUBLISHED = {
    "viscous_coefficient": (8.05, 5.53, 1.97, 1.11, 1.86, 0.65),
    "kinetic_coefficient": (7.14, 8.26, 6.34, 2.48, 3.03, 0.282),
}
"""TX40_config.yaml of figaroh-examples; joints 5 and 6 share .616 N m s/rad and 1.95 N m more."""


def halves(record: Measurement) -> tuple[Measurement, Measurement]:
    """Return both halves of a record."""
    time = np.asarray(record.time)
    middle = len(time) // 2
    return tuple(  # type: ignore[return-value]  # of two
        Measurement(
            time=time[part],
            position={name: one.values("position")[part] for name, one in record.joints.items()},
            force={name: one.values("force")[part] for name, one in record.joints.items()},
        )
        for part in (slice(middle), slice(middle, None))
    )


def main() -> None:
    """Print the tables."""
    argparse.ArgumentParser(description=__doc__.partition("\n")[0]).parse_args()
    robot, record = tx40_robot(), by_motors(catalogue.dataset("staubli_tx40").measurement())
    asked = ["friction.*", "links"]
    found = fit(robot, CoulombViscous, record, vary=asked)
    for name, published in PUBLISHED.items():
        print(f"{name}: fitted, published")
        for i, value in enumerate(published, 1):
            print(f"  joint {i}: {found.estimate(f'friction.q{i}.{name}')}, {value}")
    told = len(found.estimates) - len(found.shown)
    print(f"{told} parameters of links fitted beside")
    print("residual over spread of the torque, by joint:")
    print(f"  of the record: {_errors(found, None)}")
    first, second = halves(record)
    for one, other in ((first, second), (second, first)):
        half = fit(robot, CoulombViscous, one, vary=asked)
        print(f"  of one half, from the other: {_errors(half, other)}")


def _errors(found: RecordFit, record: Measurement | None) -> str:
    seen = found.predict(record) if record is not None else found.predict()
    every = [seen.of(name) for name in found.mechanism.coordinates]
    shares = [float(np.std(own.residual) / np.std(own.measured)) for own in every]
    return ", ".join(f"{x:.3f}" for x in (*shares, math.sqrt(np.mean(np.square(shares)))))


if __name__ == "__main__":
    main()
