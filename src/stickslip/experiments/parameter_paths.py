"""Finds the quantity that a parameter path names."""

import dataclasses

from stickslip.errors import UnknownNameError
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Parametrised, Quantity, fields_of, full_path

PREFIX = "mechanism"


def all_paths(root: Parametrised, prefix: str) -> dict[str, Quantity]:
    """Return the quantities below `root` by path, those that are not given included.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> from stickslip.drives import Pulse
    >>> block = SpringBlock(mass=1.0, drive=Pulse(level=1.0, duration=1.0))
    >>> list(all_paths(block, "mechanism"))[-1]
    'mechanism.drive.start'
    """
    found = {f"{prefix}.{name}": quantity for name, quantity in fields_of(type(root)).items()}
    for field in dataclasses.fields(root):
        value = getattr(root, field.name)
        path = f"{prefix}.{field.name}"
        if isinstance(value, Parametrised):
            found.update(all_paths(value, path))
        elif isinstance(value, tuple):
            for index, item in enumerate(value):
                if isinstance(item, Parametrised):
                    found.update(all_paths(item, f"{path}.{index}"))
    return found


def canonical(mechanism: Mechanism, path: str) -> str:
    """Return the full path for a full path, or for a last name that only one parameter has.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> canonical(SpringBlock(mass=1.0), "compression")
    'mechanism.compression'
    """
    return full_path(path, all_paths(mechanism, PREFIX))


def quantity_at(mechanism: Mechanism, path: str) -> Quantity:
    """Return the quantity at a full path, or say which known paths are nearest."""
    known = all_paths(mechanism, PREFIX)
    if path not in known:
        raise UnknownNameError("parameter", path, known)
    return known[path]
