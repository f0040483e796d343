"""Reads rig files; the libraries for it are imported only when one is read."""

import numbers
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stickslip.data.rig import Rig
from stickslip.errors import InputError


def load_rig(
    path: str | Path | None = None,
    *,
    overrides: Mapping[str, str | float | bool] | None = None,
    allow_import: bool = False,
) -> Rig:
    """Read a rig file.

    Parameters
    ----------
    path : str or Path, optional
        A TOML file; the rig of the source paper, which comes with the package, if not given.
    overrides : mapping, optional
        Values by dotted path, as on the command line: ``{"run.t_end": "5 s"}``. A shared value
        under ``friction`` does not replace one in a law's own table.
    allow_import : bool
        Whether a file may name a mechanism or a law by import path (``type = "module:Class"``),
        which runs the code of that module. Allow it for files you trust only.

    Returns
    -------
    Rig
        With everything in SI.

    Raises
    ------
    InputError
        If the file cannot be read or used; one message with file, key, range, unit and cure.

    Examples
    --------
    >>> rig = load_rig(overrides={"mechanism.compression": "60 mm"})
    >>> rig.mechanism.compression, sorted(rig.laws)[:3]
    (0.06, ['coulomb', 'coulomb-viscous', 'coulomb-viscous-static'])
    """
    from stickslip.data.rigs.rig_builder import read_rig

    given: Any = {} if overrides is None else overrides
    if not isinstance(given, Mapping):
        raise InputError(f"overrides must be a mapping by dotted path, got {given!r}.")
    for key, value in given.items():
        if not isinstance(value, str | bool | numbers.Real):
            raise InputError(f"override {key!r}: must be text, a number or a bool, got {value!r}.")
    return read_rig(path, given, allow_import=allow_import)


def rig_schema() -> dict[str, Any]:
    """Return the JSON schema of rig files: tables, types, units and ranges.

    Examples
    --------
    >>> sorted(rig_schema()["properties"])[:3]
    ['contact', 'data', 'estimates']
    """
    from stickslip.data.rigs.schema import json_schema

    return json_schema()
