"""Writes rig files."""

import dataclasses
import json

from stickslip.drives.registry import PROFILES
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import MOTORS, Mechanism
from stickslip.quantities import Parametrised, fields_of

__all__ = ["rig_toml"]


def rig_toml(
    mechanism: Mechanism, law: FrictionLaw, *, title: str = "", t_end: float | None = None
) -> str:
    """Return the text of a rig file with a mechanism and one law, in SI.

    Numbers, texts and truth values are written, and the motor of a pendulum or an inner mass with
    its motion; a drive is left out, which in an identified mechanism is the record itself.

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
        *_table("mechanism", mechanism.name, mechanism),
        "",
        f"[friction.{law.name}]",
        *_values(law),
    ]
    if t_end is not None:
        lines += ["", "[run]", f"t_end = {float(t_end)!r}"]
    return "\n".join(lines) + "\n"


def _table(key: str, kind: str, root: Parametrised) -> list[str]:
    """Return a table that is told apart by its type, and the tables of motor and motion below."""
    lines = [f"[{key}]", f'type = "{kind}"', *_values(root)]
    for field in dataclasses.fields(root):
        value = getattr(root, field.name)
        for members in (PROFILES, MOTORS):
            for name, member in members.items():
                if type(value) is member:
                    lines += ["", *_table(f"{key}.{field.name}", name, value)]
    return lines


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
