"""Random robot descriptions, and the equations of a robot by another way: Jacobians in NumPy."""

import math
import xml.etree.ElementTree as ET

import numpy as np


def random_urdf(seed, count=6, kinds=("revolute", "continuous", "prismatic", "fixed")):
    """Return the text of a URDF file with a random tree of joints."""
    dice = np.random.default_rng(seed)

    def numbers(scale, n=3):
        return " ".join(f"{x:.17g}" for x in scale * dice.normal(size=n))

    parts = ['<robot name="random"><link name="link-0"/>']
    for i in range(1, count + 1):
        spread = dice.uniform(0.01, 0.1, 3)  # integrals of squares of x, y and z
        turn, _ = np.linalg.qr(dice.normal(size=(3, 3)))
        inertia = turn @ np.diag(spread.sum() - spread) @ turn.T
        entries = " ".join(
            f'i{a}{b}="{inertia["xyz".index(a), "xyz".index(b)]:.17g}"'
            for a, b in ("xx", "yy", "zz", "xy", "xz", "yz")
        )
        kind = str(dice.choice(kinds)) if i > 1 else "revolute"
        axis = numbers(1.0) if dice.random() < 0.5 else str(dice.choice(["1 0 0", "0 -1 0"]))
        parts.append(
            f'<link name="link-{i}"><inertial><origin xyz="{numbers(0.1)}" rpy="{numbers(1.0)}"/>'
            f'<mass value="{dice.uniform(0.5, 3.0):.17g}"/><inertia {entries}/></inertial></link>'
            f'<joint name="joint_{i}" type="{kind}"><parent link="link-{dice.integers(0, i)}"/>'
            f'<child link="link-{i}"/><origin xyz="{numbers(0.3)}" rpy="{numbers(1.0)}"/>'
            f'<axis xyz="{axis}"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
            f'<dynamics damping="{dice.uniform():.3g}" friction="0.5"/></joint>'
        )
    return "\n".join([*parts, "</robot>"])


def _vector(element, key, default="0 0 0"):
    text = default if element is None else element.get(key, default)
    return np.array([float(x) for x in text.split()])


def _turn(axis, angle):
    k = np.cross(np.eye(3), axis)
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * (k @ k)


def _origin(element):
    origin = element.find("origin")
    roll, pitch, yaw = _vector(origin, "rpy")
    x, y, z = np.eye(3)
    return _turn(z, yaw) @ _turn(y, pitch) @ _turn(x, roll), _vector(origin, "xyz")


def by_jacobians(text, q, gravity=9.81):
    """Return mass matrix and potential energy, by the motion of every link of the file.

    Works with complex coordinates, so that derivatives by complex steps are exact.
    """
    root = ET.fromstring(text)
    joints = root.findall("joint")
    moving = [joint.get("name") for joint in joints if joint.get("type") != "fixed"]
    where = {joint.find("child").get("link"): joint for joint in joints}
    mass, height = np.zeros((len(moving),) * 2, dtype=complex), 0.0
    for link in root.findall("link"):
        chain = []
        name = link.get("name")
        while name in where:
            chain.append(where[name])
            name = where[name].find("parent").get("link")
        turn, place = np.eye(3, dtype=complex), np.zeros(3, dtype=complex)
        axes = []
        for one in reversed(chain):
            r, p = _origin(one)
            place, turn = place + turn @ p, turn @ r
            if one.get("type") == "fixed":
                continue
            axis = _vector(one.find("axis"), "xyz", "1 0 0")
            axis /= math.sqrt(axis @ axis)
            k = moving.index(one.get("name"))
            if one.get("type") == "prismatic":
                axes.append((k, turn @ axis, None))
                place = place + turn @ axis * q[k]
            else:
                axes.append((k, turn @ axis, place))
                turn = turn @ _turn(axis, q[k])
        inertial = link.find("inertial")
        if inertial is None:
            continue
        r, p = _origin(inertial)
        centre, own = place + turn @ p, turn @ r
        entry = inertial.find("inertia").get
        tensor = np.array(
            [[float(entry("i" + "".join(sorted((a, b))))) for b in "xyz"] for a in "xyz"]
        )
        m = float(inertial.find("mass").get("value"))
        slide = np.zeros((3, len(moving)), dtype=complex)
        spin = np.zeros((3, len(moving)), dtype=complex)
        for k, axis, at in axes:
            slide[:, k] = axis if at is None else np.cross(axis, centre - at)
            spin[:, k] = 0.0 if at is None else axis
        mass = mass + m * slide.T @ slide + spin.T @ (own @ tensor @ own.T) @ spin
        height = height + m * centre[2]
    return mass, gravity * height


def needed(text, q, v, gravity=9.81):
    """Return what the joints take so that no rate changes, by Christoffel's symbols."""
    n, step = len(q), 1e-30
    slopes, weight = np.zeros((n, n, n)), np.zeros(n)
    for k in range(n):
        mass, energy = by_jacobians(text, q + 1j * step * np.eye(n)[k], gravity)
        slopes[k], weight[k] = mass.imag / step, energy.imag / step
    turning = np.einsum("kij,k,j->i", slopes, v, v)
    return turning - 0.5 * np.einsum("ijk,j,k->i", slopes, v, v) + weight
