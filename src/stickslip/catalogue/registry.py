"""The entries of the catalogue, one TOML file each."""

import functools
import tomllib
from collections.abc import Mapping
from importlib.resources import files
from types import MappingProxyType
from typing import Any

from stickslip.catalogue.dataset import Dataset
from stickslip.catalogue.schema import Column, DataFile
from stickslip.errors import UnknownNameError


def names() -> tuple[str, ...]:
    """Return the names of all records.

    Returns
    -------
    tuple of str
        In alphabetical order.

    Examples
    --------
    >>> names()[:2]
    ('bam_xl330', 'emps')
    """
    return tuple(_texts())


def dataset(name: str) -> Dataset:
    """Return a record of the catalogue; nothing is downloaded yet.

    Examples
    --------
    >>> dataset("rock_velocity_step").licence
    'MIT'
    >>> dataset("emsp")
    Traceback (most recent call last):
    stickslip.errors.UnknownNameError: unknown record of the catalogue 'emsp'. Did you mean 'emps'?
    """
    if name not in _texts():
        raise UnknownNameError("record of the catalogue", name, names())
    return _read(name)


@functools.cache
def _texts() -> Mapping[str, str]:
    """Return the text of each entry by its name."""
    folder = files("stickslip.catalogue").joinpath("records")
    found = {
        entry.name.removesuffix(".toml"): entry.read_text(encoding="utf-8")
        for entry in folder.iterdir()
        if entry.name.endswith(".toml")
    }
    return MappingProxyType(dict(sorted(found.items())))


@functools.cache
def _read(name: str) -> Dataset:
    tables: dict[str, Any] = tomllib.loads(_texts()[name])
    columns = tuple(Column(**table) for table in tables.pop("columns"))
    known = {key: DataFile(name=key, **table) for key, table in tables.pop("files").items()}
    tables["notes"] = " ".join(tables.get("notes", "").split())
    return Dataset(name=name, columns=columns, files=MappingProxyType(known), **tables)
