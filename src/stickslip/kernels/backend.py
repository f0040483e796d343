"""What differs between the tiers: how vectors are made, how equations are called.

These are the definitions of the plain Python tier; those of the compiled one stand in
`solver.compile.numba_prelude`.
"""

from collections.abc import MutableSequence
from typing import Any, TypeAlias

__all__ = ["Vector", "Wholes", "call_contacts", "call_model", "vector"]

Vector: TypeAlias = MutableSequence[float]
"""A list of floats in the Python tier, an array in the compiled one."""
Wholes: TypeAlias = MutableSequence[int]
"""A list of whole numbers, or an array of them."""


def vector(size: int) -> Vector:
    """Return a vector of zeros."""
    return [0.0] * size


def call_model(
    w: Any, place: int, name: int, mode: int, flags: int, t: float, at: int, to: int
) -> None:
    """Call a function of the equations that the vector of the run names.

    Parameters
    ----------
    w : list (SIZE,)
        Vector of the run.
    place : int
        Place in it of the functions; compiled ones have an address there.
    name : int
        Number of the function.
    mode : int
        Contact mode.
    flags : int
        Bit j is set where the condition of switch j holds.
    t : float
        Time [s].
    at : int
        Place in `w` of the state.
    to : int
        Place of the result.
    """
    w[place][name](mode, flags, t, w, at, to)


def call_contacts(w: Any, place: int, whole: Wholes, name: int, t: float, at: int, to: int) -> None:
    """Call what works out the equations of several contacts.

    It is a function of its own, as the equations are, so that the code of all that calls it stays
    small: machine code is made of everything together.

    Parameters
    ----------
    w : list (SIZE,)
        Vector of the run.
    place : int
        Place in it of the function, or of its address.
    whole : list (WHOLES,)
        Whole numbers of the run.
    name : int
        Number of the question, as in `contacts.answers`.
    t : float
        Time [s].
    at : int
        Place in `w` of the state.
    to : int
        Place of the result.
    """
    w[place](name, t, w, whole, at, to)
