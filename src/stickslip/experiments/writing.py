"""Writes rig files."""

import dataclasses
import json

from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Parametrised, fields_of

__all__ = ["rig_toml"]


def rig_toml(mechanism: Mechanism, law: FrictionLaw, *, title: str = "") -> str:
    """Return the text of a rig file with a mechanism and one law, in SI.

    Numbers, texts and truth values are written; a drive is left out, which in an identified
    mechanism is the record itself.

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
        f'type = "{mechanism.name}"',
        *_values(mechanism),
        "",
        f"[friction.{law.name}]",
        *_values(law),
    ]
    return "\n".join(lines) + "\n"


def _values(root: Parametrised) -> list[str]:
    """Return a line for each plain value, its unit as a comment."""
    lines = []
    for field in dataclasses.fields(root):
        value = getattr(root, field.name)
        if isinstance(value, bool):
            lines.append(f"{field.name} = {str(value).lower()}")
        elif isinstance(value, (int, float)) and field.name in fields_of(type(root)):
            lines.append(f"{field.name} = {float(value)!r}")
        elif isinstance(value, str):
            lines.append(f"{field.name} = {json.dumps(value, ensure_ascii=False)}")
    return lines
