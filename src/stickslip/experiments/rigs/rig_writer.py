"""Writes rig files."""

import dataclasses
import json
from collections.abc import Mapping

from stickslip.drives.registry import PROFILES
from stickslip.experiments.estimates import LawEstimates
from stickslip.friction import FrictionLaw, laws
from stickslip.mechanisms import MOTORS, Mechanism, Motor, mechanisms
from stickslip.quantities import Parametrised, fields_of

__all__ = ["rig_toml"]


def rig_toml(
    mechanism: Mechanism,
    law: FrictionLaw,
    *,
    title: str = "",
    t_end: float | None = None,
    estimates: LawEstimates | None = None,
) -> str:
    """Return the text of a rig file with a mechanism, one law and how well it is known, in SI.

    Numbers, texts, truth values, motors and profiles are written; a drive is left out, which in an
    identified mechanism is the record itself. What is in no registry is named by its import path.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> print(rig_toml(Axis(inertia=2.0), Coulomb(kinetic_coefficient=0.5)))
    [mechanism]
    type = "axis"
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
    head = [f"title = {json.dumps(title, ensure_ascii=False)}", ""] if title else []
    lines = [
        *head,
        "[mechanism]",
        f'type = "{_type(mechanism, mechanisms())}"',
        *_values(mechanism),
        *_parts(mechanism, "mechanism"),
        "",
        f"[friction.{law.name}]",
        *([] if law.name in laws() else [f'type = "{_type(law, laws())}"']),
        *_values(law),
    ]
    if t_end is not None:
        lines += ["", "[run]", f"t_end = {float(t_end)!r}"]
    if estimates is not None:
        lines += ["", *_estimates(estimates)]
    return "\n".join(lines) + "\n"


def _parts(root: Parametrised, path: str) -> list[str]:
    """Return the tables of motors and of the profiles that they follow."""
    lines = []
    for field in dataclasses.fields(root):
        part, below = getattr(root, field.name), f"{path}.{field.name}"
        kinds: Mapping[str, type] = MOTORS if isinstance(part, Motor) else PROFILES
        name = next((name for name, kind in kinds.items() if type(part) is kind), None)
        if name is not None:
            lines += ["", f"[{below}]", f'type = "{name}"', *_values(part), *_parts(part, below)]
    return lines


def _estimates(known: LawEstimates) -> list[str]:
    """Return the tables that say how well a law is known."""
    lines = ["[estimates]", f'law = "{known.law}"', f'interval = "{known.interval}"']
    lines.append(f'levels = "{known.levels}"')
    if known.largest_speed is not None:
        lines.append(f"largest_speed = {known.largest_speed!r}")
    if known.not_fitted:
        lines.append(f"not_fitted = {json.dumps(known.not_fitted)}")
    if known.covariance_of:
        rows = (f"  [{', '.join(map(repr, row))}]," for row in known.covariance)
        lines += [
            f"covariance_of = {json.dumps(known.covariance_of)}",
            "covariance = [",
            *rows,
            "]",
        ]
    if known.intervals:
        lines += ["", "[estimates.intervals]"]
        lines += [f"{name} = [{low!r}, {high!r}]" for name, (low, high) in known.intervals.items()]
    if known.not_identified:
        lines += ["", "[estimates.not_identified]"]
        lines += [
            f"{name} = {json.dumps(reason, ensure_ascii=False)}"
            for name, reason in known.not_identified.items()
        ]
    return lines


def _type(one: Mechanism | FrictionLaw, known: Mapping[str, type]) -> str:
    """Return the name in the registry, or the import path of a class that has none."""
    kind = type(one)
    return one.name if one.name in known else f"{kind.__module__}:{kind.__qualname__}"


def _values(root: Parametrised) -> list[str]:
    """Return a line for each plain value."""
    lines = []
    for field in dataclasses.fields(root):
        value = getattr(root, field.name)
        if isinstance(value, bool):
            lines.append(f"{field.name} = {str(value).lower()}")
        elif isinstance(value, (int, float)) and field.name in fields_of(type(root)):
            lines.append(f"{field.name} = {float(value)!r}")
        elif isinstance(value, str):
            lines.append(f"{field.name} = {json.dumps(value, ensure_ascii=False)}")
        elif isinstance(value, tuple) and field.name in root.data_fields:
            lines.append(f"{field.name} = [{', '.join(repr(float(x)) for x in value)}]")
    return lines
