"""Writes rig files."""

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any, get_args, get_type_hints

from stickslip.data.estimates import LawEstimates
from stickslip.friction import Friction, FrictionLaw, Laws, assigned, laws
from stickslip.mechanisms import LOOPS, MOTORS, DCMotor, Mechanism, mechanisms, without_given
from stickslip.mechanisms.drives import DRIVES, PROFILES, Drive, Profile, Sum
from stickslip.quantities import Parametrised, fields_of


def rig_toml(
    mechanism: Mechanism,
    law: Friction,
    *,
    title: str = "",
    t_end: float | None = None,
    estimates: LawEstimates | None = None,
) -> str:
    """Return the text of a rig file with a mechanism, its friction and how well it is known, in SI.

    Numbers, texts, truth values, motors, profiles, drives and parts are written. A drive that a rig
    file cannot have is left out, which a comment says. A mechanism or a law that is in no registry
    is named by its import path.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> print(rig_toml(Axis(inertia=2.0), Coulomb(kinetic_coefficient=0.5)))
    [mechanism]
    type = "axis"
    rotary = false
    inertia = 2.0
    stiffness = 0.0
    damping = 0.0
    load = 1.0
    offset = 0.0
    restitution = 0.0
    <BLANKLINE>
    [friction.coulomb]
    kinetic_coefficient = 0.5
    <BLANKLINE>
    """
    import tomlkit

    document: dict[str, object] = {"title": title} if title else {}
    bare, inputs = without_given(mechanism)
    document["mechanism"] = _table(bare, _type(bare, mechanisms()))
    if inputs:
        document["contact"] = {name: _contact_input(value) for name, value in inputs.items()}
    result = assigned(tuple(contact.name for contact in mechanism.contacts()), law)
    document["friction"] = (
        _by_contact(mechanism, result) if isinstance(result, Laws) else _law(result)
    )
    if t_end is not None:
        document["run"] = {"t_end": float(t_end)}
    if estimates is not None:
        document["estimates"] = _estimates(estimates)
    lost = "".join(
        f"# {path} is left out: a rig file cannot have a {kind}, so that runs are without it.\n"
        for path, kind in _unwritten(mechanism, "mechanism")
    )
    return lost + tomlkit.dumps(document)


def _contact_input(value: Drive | float | Mapping[str, Any]) -> object:
    """Return a contact input as a number, or the tables of a drive; those of a contact by name."""
    if isinstance(value, Mapping):
        return {name: _contact_input(entry) for name, entry in value.items()}
    return _drives(value) if isinstance(value, Drive) else value


def _law(law: FrictionLaw) -> dict[str, object]:
    """Return the table of a law under its name; of one without a name, with its composition."""
    if law.name in laws():
        return {law.name: _table(law, "")}
    if law.name == str(law.composition):  # not a class of somebody that is derived from one
        return {"composed": {"law": str(law.composition), **_table(law, "")}}
    return {law.name: _table(law, _type(law, laws()))}


def _by_contact(mechanism: Mechanism, found: Laws) -> dict[str, object]:
    """Return the tables of laws by contact, and what says that nothing rubs at one."""
    own = dict(found.members)
    names = [contact.name for contact in mechanism.contacts()]
    idle: dict[str, object] = {name: "none" for name in names if name not in own}
    return idle | {name: _law(own[name]) for name in names if name in own}


def _table(root: Parametrised, kind: str) -> dict[str, object]:
    """Return the plain values of a part, and the tables of motors, drives and parts."""
    table: dict[str, object] = {"type": kind} if kind else {}
    for field in dataclasses.fields(root):
        value = getattr(root, field.name)
        kinds: Mapping[str, type] = PROFILES if _is_profile(root, field.name) else DRIVERS
        name = next((name for name, kind in kinds.items() if type(value) is kind), None)
        if name is not None:
            table[field.name] = _table(value, name)
        elif isinstance(value, Drive):
            drives = _drives(value)
            table |= {field.name: drives[0] if len(drives) == 1 else drives} if drives else {}
        elif isinstance(value, (bool, str)):
            table[field.name] = value
        elif isinstance(value, (int, float)) and field.name in fields_of(type(root)):
            table[field.name] = float(value)
        elif isinstance(value, tuple) and all(isinstance(x, float) for x in value):
            table[field.name] = list(value)
        elif isinstance(value, tuple) and isinstance(value[0], Parametrised):
            table[field.name] = [_differing(x) for x in value]
        elif isinstance(value, tuple):
            table[field.name] = dict(value)
        elif isinstance(value, Parametrised):
            table[field.name] = _table(value, "")
    return table


DRIVERS: Mapping[str, type] = {**MOTORS, **LOOPS, DCMotor.name: DCMotor}
"""What has a ``type`` beside drives and motions."""


def _differing(part: Parametrised) -> dict[str, object]:
    """Return the plain values of a part that are not its defaults."""
    defaults = {field.name: field.default for field in dataclasses.fields(part)}
    return {
        name: value
        for name, value in _table(part, "").items()
        if getattr(part, name) != defaults[name]
    }


def _is_profile(root: Parametrised, name: str) -> bool:
    """Whether a field holds a motion, and no force."""
    hint = get_type_hints(type(root))[name]
    return Profile in (hint, *get_args(hint))


def _drives(drive: Drive) -> list[dict[str, object]]:
    """Return the tables of the parts of a drive; none where one of them cannot be written."""
    parts = drive.parts if isinstance(drive, Sum) else (drive,)
    names = {kind: name for name, kind in DRIVES.items()}
    known = all(type(part) in names for part in parts)
    return [_table(part, names[type(part)]) for part in parts] if known else []


def _unwritten(root: Parametrised, path: str) -> Iterator[tuple[str, str]]:
    """Yield path and class of each drive that a rig file cannot have."""
    for field in dataclasses.fields(root):
        value, own = getattr(root, field.name), f"{path}.{field.name}"
        if isinstance(value, Drive):
            if not _is_profile(root, field.name) and not _drives(value):
                yield own, type(value).__name__
            continue
        several = isinstance(value, tuple)
        for index, part in enumerate(value if several else (value,)):
            if isinstance(part, Parametrised):
                yield from _unwritten(part, f"{own}.{index}" if several else own)


def _estimates(known: LawEstimates) -> dict[str, object]:
    """Return the tables that say how well a law is known."""
    import tomlkit

    table: dict[str, object] = {
        "law": known.law if isinstance(known.law, str) else dict(known.law),
        "interval": known.interval,
        "levels": known.levels,
        "largest_speed": dict(known.largest_speed)
        if isinstance(known.largest_speed, Mapping)
        else known.largest_speed,
        "not_fitted": list(known.not_fitted),
        "covariance_of": list(known.covariance_of),
        "covariance": tomlkit.item([list(row) for row in known.covariance]).multiline(True),
        "intervals": {name: list(ends) for name, ends in known.intervals.items()},
        "not_identified": dict(known.not_identified),
    }
    return {key: value for key, value in table.items() if value or value == 0}


def _type(model: Mechanism | FrictionLaw, known: Mapping[str, type]) -> str:
    """Return the name in the registry, or the import path of a class that has none."""
    kind = type(model)
    return model.name if model.name in known else f"{kind.__module__}:{kind.__qualname__}"
