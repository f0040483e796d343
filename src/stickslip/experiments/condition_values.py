"""Conditions of trials: what was different between them and is no parameter of the mechanism."""

import math
import numbers
from collections.abc import Mapping

from stickslip.errors import InputError, ParameterError


def plain_conditions(given: object) -> dict[str, float | str]:
    """Return conditions by name as floats and texts.

    Examples
    --------
    >>> plain_conditions({"temperature [degC]": 20, "direction": "up"})
    {'temperature [degC]': 20.0, 'direction': 'up'}
    """
    if not isinstance(given, Mapping):
        raise InputError(f"Measurement.conditions must be a mapping by name, got {given!r}.")
    found: dict[str, float | str] = {}
    for name, value in given.items():
        if isinstance(value, str) and value.strip():
            found[str(name)] = value.strip()
            continue
        real = isinstance(value, numbers.Real) and not isinstance(value, bool)
        if not real or not math.isfinite(float(value)):
            raise ParameterError(
                f"Measurement.conditions of {name!r} must be a finite number or a text, got"
                f" {value!r}: leave an unknown condition out."
            )
        found[str(name)] = float(value)
    return found


def condition_name(full: str) -> str:
    """Return the name of a condition without its unit.

    Examples
    --------
    >>> condition_name("temperature [degC]"), condition_name("direction")
    ('temperature', 'direction')
    """
    return full.partition("[")[0].strip()


def condition_unit(full: str) -> str:
    """Return the unit of a condition, as it stands in brackets after its name.

    Examples
    --------
    >>> condition_unit("temperature [degC]"), condition_unit("run")
    ('degC', '')
    """
    return full.partition("[")[2].partition("]")[0].strip()
