"""A block on rough ground is pushed, coasts to a stop, and is held by a force below break-away."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

M, G = 1.0, 9.81
MU_K, MU_S = 0.25, 0.35
F_K, F_S = MU_K * M * G, MU_S * M * G
PUSH, PUSH_TIME = 10.0, 0.1
HOLD_START, HOLD_TIME = 1.0, 10.0
"""The block has stopped after 0.41 s and rests until the hold begins [s]."""
LIGHT, HEAVY = 2.0, 3.0
"""Holds [N]: below both levels, and between the two."""
SIDE, HEIGHT = 0.2, 0.1
"""Of the block, where an engine has bodies [m]."""
SETTLE = 1.0
"""Time for a soft contact to sink in before the push; not measured [s]."""

TRAVEL = (PUSH - F_K) * PUSH_TIME**2 * PUSH / (2 * M * F_K)
"""Where the block stops [m]."""


@dataclass(frozen=True, kw_only=True)
class Places:
    """Where the block was."""

    before: float
    """When the hold began [m]."""
    after: float
    """When it ended [m]."""


Run: TypeAlias = Callable[[], Places]


def pushes(hold: float, seconds: float) -> tuple[tuple[float, float, float], ...]:
    """Return force [N], begin and end [s] of the parts of a run."""
    end = HOLD_START + seconds
    return (
        (PUSH, 0.0, PUSH_TIME),
        (0.0, PUSH_TIME, HOLD_START),
        (hold, HOLD_START, end),
    )
