"""What the columns of files may hold."""

from collections.abc import Iterable

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments.measurement import QUANTITIES
from stickslip.experiments.parameter_paths import PREFIX, canonical
from stickslip.mechanisms import Mechanism

__all__ = ["check_columns"]

OF_TRIALS = ("uncertainty", "uncertainty_kind", "name", "provenance")
"""What else a table of trials may have."""
MOTORS = {
    "current": "newtons per ampere (of the motor's constant and its gears)",
    "voltage": "newtons per volt (of the amplifier and its motor)",
    "torque": "the factor to the mechanism's unit, 1 if the mechanism is in radians",
}
"""What drives a rig but is no quantity of its own, and what its gain is."""


def check_columns(names: Iterable[str], mechanism: Mechanism | None = None) -> None:
    """Check that each key of ``columns`` is a quantity or a path: a typo would drop its column.

    Parameters
    ----------
    names : iterable of str
        Keys of ``columns``: quantities or parameter paths.
    mechanism : Mechanism, optional
        Mechanism whose parameters may be named too.

    Raises
    ------
    InputError
        If a name is ``current``, ``voltage`` or ``torque``, which is read as a force with a gain.
    UnknownNameError
        If a name is neither a quantity nor a path.

    Examples
    --------
    >>> check_columns(["time", "position", "mechanism.compression", "initial.x"])
    >>> check_columns(["positon"])
    Traceback (most recent call last):
    stickslip.errors.UnknownNameError: unknown quantity in columns 'positon'. Did you mean ...
    """
    known = ("time", *QUANTITIES, *OF_TRIALS, "trial")
    for name in names:
        first, _, rest = str(name).partition(".")
        if name in known or (rest and first in ("initial", PREFIX)):
            continue
        if name in MOTORS:
            raise InputError(
                f"columns: {name} is not a quantity of a measurement, but a force with a gain:"
                f" give its column as force, and as gain of force {MOTORS[name]}."
            )
        if mechanism is not None and _is_path(mechanism, str(name)):
            continue
        raise UnknownNameError("quantity in columns", name, known)


def _is_path(mechanism: Mechanism, name: str) -> bool:
    """Whether a plain last name stands for a parameter of a mechanism."""
    try:
        canonical(mechanism, name)
    except UnknownNameError:
        return False
    return True
