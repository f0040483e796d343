"""What is known of a made-up measurement: its curve, parameters, terms, faults, and more of it."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip import Axis, Measurement

Array: TypeAlias = NDArray[np.float64]
Random: TypeAlias = np.random.Generator
KINETIC, STATIC, FALL = "kinetic_coefficient", "static_coefficient", "stribeck_velocity"
VISCOUS, EXPONENT, DRAG = "viscous_coefficient", "viscous_exponent", "quadratic_coefficient"
"""Names of parameters of laws, as `Rig.parameters` has them."""
AXIS = Axis(inertia=1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Points:
    """Where friction is asked, or was read."""

    velocity: Array
    """Velocities (n,) [m/s]."""
    load: Array | None = None
    """Loads (n,) [N]."""
    inputs: Mapping[str, Array] = field(default_factory=dict)
    """Temperatures (n,) [degC] and other inputs of the contact, by name."""

    def __len__(self) -> int:
        return len(self.velocity)

    def __getitem__(self, rows: Any) -> "Points":
        return Points(
            velocity=self.velocity[rows],
            load=None if self.load is None else self.load[rows],
            inputs={name: values[rows] for name, values in self.inputs.items()},
        )

    def joined(self, other: "Points") -> "Points":
        """Return these points and others behind them."""
        load = None
        if self.load is not None and other.load is not None:
            load = np.concatenate([self.load, other.load])
        return Points(
            velocity=np.concatenate([self.velocity, other.velocity]),
            load=load,
            inputs={k: np.concatenate([v, other.inputs[k]]) for k, v in self.inputs.items()},
        )


Curve: TypeAlias = Callable[[Points], Array]
"""Friction [N] at points (n,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Rig:
    """A made-up measurement with what is true of it."""

    kind: str
    """Tables, maps, records or decays."""
    truth: str
    """What kind of truth it is."""
    inside: bool
    """Whether the vocabulary holds the law, and nothing is wrong with the measurement."""
    measurement: Measurement
    mechanism: Any = AXIS
    unknown: tuple[str, ...] = ()
    """Paths of parameters of the mechanism that are looked for."""
    family: frozenset[str] | None = None
    """Terms of the true law and its rig; None: the vocabulary does not hold them."""
    faults: frozenset[str] = frozenset()
    """Kinds of faults that may be named."""
    causes: frozenset[str] | None = None
    """Terms of the rig that are there beside those, where all that are named are to be true."""
    curves: tuple[Curve, ...] = ()
    """True steady friction, of each run where they differ; empty where there is none."""
    noise: Curve | None = None
    """Standard deviation of readings at points."""
    shown: Curve | None = None
    """Standard deviation of single samples that a sensor shows at points; `noise` if not given."""
    asked: Points | None = None
    """Points within what was measured."""
    beyond: Points | None = None
    """Points at a third to twice the measured speeds."""
    parameters: Mapping[str, float] = field(default_factory=dict)
    """True values, by the name of the parameter."""
    fitted: Curve | None = None
    """The true structure, fitted to the readings by least squares."""
    second: Measurement | None = None
    """Another record of the same rig."""
    t_end: float | None = None
    """Time after which a body counts as stopped [s], of travels."""
    more: "Callable[[Points, int], Rig] | None" = None
    """The rig with further readings at points, drawn by a seed."""

    def with_(self, **changes: Any) -> "Rig":
        return replace(self, **changes)


def factor(low: float, high: float, random: Random) -> float:
    """Return a number between two, even over its logarithm."""
    return float(np.exp(random.uniform(math.log(low), math.log(high))))


def asked_over(low: float, high: float, *, both: bool) -> tuple[Points, Points]:
    """Return points at speeds within a range, and from a third of it to twice."""
    inside = np.geomspace(low, high, 40)
    over = np.concatenate([np.geomspace(low / 3.0, low, 8)[:-1],
                           np.geomspace(high, 2.0 * high, 5)[1:]])  # fmt: skip
    sides = (-1.0, 1.0) if both else (1.0,)
    result = [np.concatenate([side * u for side in sides]) for u in (inside, over)]
    return Points(velocity=result[0]), Points(velocity=result[1])
