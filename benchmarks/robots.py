"""Arms and robots with friction in every joint: size of the equations, and time of the kernel."""

import math
import time

import numpy as np

from benchmarks.kernel import Kernel
from benchmarks.measuring import REPEATS, Section, Target
from stickslip import Coulomb, TwoLinkArm
from stickslip.engine.formulation import formulate
from stickslip.engine.solver.compile.programs import code_of
from stickslip.friction import Laws
from stickslip.mechanisms import Link, Mechanism, Robot, RobotJoint, SerialArm
from stickslip.mechanisms.drives import Sine

LEVELS = [(1.0, 1.4), (1.2, 1.6), (0.8, 1.1), (0.3, 0.45), (0.3, 0.45), (0.2, 0.3)]
"""Kinetic and static levels in the joints of the robot [N m]."""
START = (0.3, -1.2, 0.9, -0.6, 0.4, 0.2)
"""Angles at which it begins at rest [rad]."""
HEADS = ("mechanism", "text, kB", "derived, s", "compiled, s", "tolerance", "steps", "kernel, ms")


def ur():
    """Return the robot of the reference numbers, with the values of a UR5 and a payload of 1 kg."""
    d, a = (0.089159, 0.0, 0.0, 0.10915, 0.09465, 0.0823), (0.0, -0.425, -0.39225, 0.0, 0.0, 0.0)
    bends = (1, 0, 0, 1, -1, 0)  # sines of the angles between axes, which are at right angles or 0
    masses = (3.7, 8.393, 2.33, 1.219, 1.219, 0.1879)
    centres = (
        (0, -0.02561, 0.00193), (0.2125, 0, 0.11336), (0.15, 0, 0.0265), (0, -0.0018, 0.01634),
        (0, 0.0018, 0.01634), (0, 0, -0.001159),
    )  # fmt: skip
    moments = (
        (0.0084, 0.0064, 0.0084), (0.0078, 0.21, 0.21), (0.0016, 0.0462, 0.0462),
        (0.0016, 0.0016, 0.0009), (0.0016, 0.0016, 0.0009), (0.0001, 0.0001, 0.0001),
    )  # fmt: skip
    joints, before = [], (np.zeros(3), np.eye(3))
    for i, s in enumerate(bends):
        c = 1 - abs(s)
        end = np.array([a[i], 0.0, d[i]])
        turn = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
        lumps = [(masses[i], end + turn @ centres[i], turn @ np.diag(moments[i]) @ turn.T)]
        lumps += [(1.0, end, np.zeros((3, 3)))] if i == 5 else []
        mass = sum(m for m, _, _ in lumps)
        centre = sum(m * r for m, r, _ in lumps) / mass
        inertia = sum(
            k + m * ((r - centre) @ (r - centre) * np.eye(3) - np.outer(r - centre, r - centre))
            for m, r, k in lumps
        )
        numbers = {f"inertia_{p}{q}": inertia["xyz".index(p), "xyz".index(q)]
                   for p, q in ("xx", "yy", "zz", "xy", "xz", "yz")}  # fmt: skip
        joints.append(
            RobotJoint(
                joint=f"q{i + 1}", parent=f"q{i}" if i else "", place=tuple(before[0]),
                orientation=tuple(before[1].ravel().astype(float)), mass=mass, armature=0.1,
                **{f"centre_{k}": x for k, x in zip("xyz", centre, strict=True)}, **numbers,
                effort=Sine(amplitude=8.0, frequency=0.5) if i == 1 else None,
            )
        )  # fmt: skip
        before = end, turn
    return Robot(joints=tuple(joints))


def ur_laws() -> dict[str, Coulomb]:
    """Return its friction by contact."""
    return {f"q{i + 1}": _coulomb(*levels) for i, levels in enumerate(LEVELS)}


def _coulomb(kinetic: float, static: float) -> Coulomb:
    return Coulomb(kinetic_coefficient=kinetic, static_coefficient=static)


def _cases() -> dict[str, tuple[Mechanism, dict[str, Coulomb], tuple[float, ...], float, float]]:
    """Return mechanism, laws, angles at the start, time and tolerance by name."""
    result = {}
    for n in (2, 3, 4, 6):
        link = Link(mass=1.0, length=0.4, centre=0.2, inertia=0.16 / 3.0)
        arm = SerialArm(links=(link,) * n)
        laws = {contact.name: _coulomb(0.2, 0.3) for contact in arm.contacts()}
        result[f"{n} links in a plane"] = (arm, laws, (1.2, 0.8, *(0.0,) * (n - 2)), 4.0, 1e-9)
    two = TwoLinkArm(
        upper_mass=1.0, upper_length=0.4, upper_centre=0.4, upper_inertia=0.16,
        lower_mass=0.5, lower_centre=0.4, lower_inertia=0.08,
    )  # fmt: skip
    laws = {"shoulder": _coulomb(0.3, 0.45), "elbow": _coulomb(0.12, 0.2)}
    result["arm of the reference numbers, 6 s"] = (two, laws, (1.2, 0.8), 6.0, 1e-9)
    result["robot with six joints, 4 s"] = (ur(), ur_laws(), START, 4.0, 1e-12)
    return result


GOALS = {"arm of the reference numbers, 6 s": 1.5, "robot with six joints, 4 s": 15.0}
"""Time of the kernel that was aimed at [ms]."""


def run() -> Section:
    """Run the case."""
    rows, targets = [], []
    for name, (mechanism, by_contact, angles, t_end, tolerance) in _cases().items():
        laws = Laws(members=tuple(by_contact.items()))
        began = time.thread_time()
        model = formulate(mechanism, laws)
        derived = time.thread_time() - began
        began = time.thread_time()
        fresh = code_of(model).load()
        compiled = f"{time.thread_time() - began:.2f}" if fresh else "kept"
        start = dict(zip(mechanism.coordinates, angles, strict=True))
        kernel = Kernel(mechanism, laws, t_end, start=start)
        kernel.run(tolerance)
        best = math.inf
        for _ in range(REPEATS):
            began = time.thread_time()
            kernel.run(tolerance)
            best = min(best, 1e3 * (time.thread_time() - began))
        size = f"{len(model.text) / 1e3:.1f}"
        steps = str(kernel.steps())
        rows.append(
            (name, size, f"{derived:.2f}", compiled, f"{tolerance:g}", steps, f"{best:.3g}")
        )
        if name in GOALS:
            met = best <= GOALS[name]
            targets.append(
                Target(
                    work=f"{name}, kernel", goal=f"{GOALS[name]:g} ms", measured=f"{best:.3g} ms",
                    met=met, reason="" if met else "guards of held joints evaluate all equations",
                )
            )  # fmt: skip
    return Section(
        title="Arms and robots",
        heads=HEADS,
        rows=tuple(rows),
        notes=(
            "- Coulomb friction with a higher static level in every joint; times of the processor.",
            "- The robot has the values of a UR5 with a payload of 1 kg.",
        ),
        targets=tuple(targets),
    )
