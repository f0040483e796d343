"""Typed stand-ins for what exists only in a generated module: one mechanism with one law.

Kernels import these names so that they can be linted, typed and read; the generated module drops
the import and defines them. All functions write to `out`.
"""

from stickslip.kernels.tier import Vector

__all__ = [
    "CAN_STICK",
    "HAS_BRISTLES",
    "N_COORDINATES",
    "N_DRIVES",
    "N_GUARDS",
    "N_STATES",
    "N_SWITCHES",
    "REST_IS_FINAL",
    "SLIP",
    "contact",
    "field",
    "guards",
    "jacobian",
    "margins",
    "power",
    "rest",
    "time_slope",
]

N_STATES: int = 0
N_COORDINATES: int = 0
N_GUARDS: int = 0
N_SWITCHES: int = 0
N_DRIVES: int = 0
SLIP: int = 0
CAN_STICK: bool = False
HAS_BRISTLES: bool = False
REST_IS_FINAL: bool = False


def field(mode: int, flags: int, t: float, y: Vector, p: Vector, out: Vector) -> None:
    """Time derivatives of the states."""


def jacobian(mode: int, flags: int, t: float, y: Vector, p: Vector, out: Vector) -> None:
    """Derivatives of the field with respect to the states, row by row."""


def time_slope(mode: int, flags: int, t: float, y: Vector, p: Vector, out: Vector) -> None:
    """Derivatives of the field with respect to time."""


def guards(mode: int, flags: int, t: float, y: Vector, p: Vector, out: Vector) -> None:
    """Quantities that are not negative while the mode lasts, by the indices of `codes`."""


def contact(mode: int, flags: int, t: float, y: Vector, p: Vector, out: Vector) -> None:
    """Friction force, normal force, needed friction, break-away level."""


def power(mode: int, flags: int, t: float, y: Vector, p: Vector, out: Vector) -> None:
    """Power supplied, power taken by friction."""


def margins(flags: int, t: float, y: Vector, p: Vector, out: Vector) -> None:
    """Margins of the switches, positive where their condition holds."""


def rest(flags: int, t: float, y: Vector, p: Vector, d: Vector, out: Vector) -> None:
    """Needed friction and break-away level of a held body for given drive values."""
