"""What differs between the tiers: how a vector is made. This is the plain Python one."""

from collections.abc import MutableSequence
from typing import TypeAlias

__all__ = ["Vector", "vector"]

Vector: TypeAlias = MutableSequence[float]
"""A list of floats in the Python tier, an array in the compiled one."""


def vector(size: int) -> Vector:
    """Return a vector of zeros."""
    return [0.0] * size
