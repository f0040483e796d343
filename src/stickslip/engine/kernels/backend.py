"""What differs between the tiers: vectors, and how equations are called.

These are the definitions of the plain Python tier; in the compiled one, vectors are places in
memory, and what is called here by its place in a list is called by its address.
"""

from collections.abc import Callable, MutableSequence
from typing import Any, TypeAlias, TypeVar

Vector: TypeAlias = MutableSequence[float]
"""A list of floats in the Python tier, an array in the compiled one."""
IntVector: TypeAlias = MutableSequence[int]
"""A list of whole numbers, or an array of them."""
Kernel = TypeVar("Kernel", bound=Callable[..., object])
"""A function of the kernels."""


def rare(function: Kernel) -> Kernel:
    """Mark what few mechanisms need: compiled code calls it, and is not made longer by its text."""
    return function


def call_model(
    w: Vector, place: int, name: int, mode: int, flags: int, t: float, at: int, to: int
) -> None:
    """Call a function of the equations that the vector of the run names."""
    functions: Any = w[place]
    functions[name](mode, flags, t, w, at, to)


def call_contacts(
    w: Vector, place: int, iw: IntVector, name: int, t: float, at: int, to: int
) -> None:
    """Call what works out the equations of several contacts.

    It is called by its place, as the equations are, since it asks the kernels in its turn.
    """
    function: Any = w[place]
    function(name, t, w, iw, at, to)
