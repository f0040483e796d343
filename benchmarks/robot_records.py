"""Friction of a measured robot whose links nobody knows, beside published values.

``python -m benchmarks.robot_records`` fits Coulomb and viscous friction of all joints of the
Stäubli TX40 with its links (``vary="links"``), prints what was found with 95 % intervals beside the
values that figaroh-examples states, and predicts each half of the record from the other half.
"""

import argparse
import math
from dataclasses import replace

import numpy as np

from stickslip import CoulombViscous, Measurement, catalogue, fit
from stickslip.identification import RecordFit
from stickslip.mechanisms import Robot, RobotJoint

FRAMES = (
    ((0.0, 0.0, 0.320), (0.0, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((0.225, 0.0, 0.035), (0.0, 0.0, 0.0)),
    ((0.0, -0.225, 0.0), (0.5, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (-0.5, 0.0, 0.0)),
    ((0.0, 0.0, 0.0), (0.5, 1.0, 0.0)),
)
"""Place [m] and roll, pitch and yaw [half turns] of each joint, which turns about its z-axis."""
PUBLISHED = {
    "viscous_coefficient": (8.05, 5.53, 1.97, 1.11, 1.86, 0.65),
    "kinetic_coefficient": (7.14, 8.26, 6.34, 2.48, 3.03, 0.282),
}
"""TX40_config.yaml of figaroh-examples; joints 5 and 6 share .616 N m s/rad and 1.95 N m more."""
INERTIA = 0.01
"""Moment of inertia that each link is described with [kg m^2], which is not what it has."""


def tx40_robot() -> Robot:
    """Return the robot with links of which only the frames are right."""
    joints = [
        RobotJoint(
            joint=f"q{i}",
            parent=f"q{i - 1}" if i > 1 else "",
            place=place,
            orientation=_rotation(*turns),
            coupling={"q5": 1.0} if i == len(FRAMES) else {},
            mass=1.0,
            **{f"inertia_{entry}": INERTIA for entry in ("xx", "yy", "zz")},
        )
        for i, (place, turns) in enumerate(FRAMES, 1)
    ]
    return Robot(joints=tuple(joints))


def _rotation(roll: float, pitch: float, yaw: float) -> tuple[float, ...]:
    (a, b, c), (d, e, f) = (
        [round(one(math.pi * x), 12) for x in (roll, pitch, yaw)] for one in (math.cos, math.sin)
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
