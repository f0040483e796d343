"""Writes the rig file of a record of which only the data file is known."""

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, Final

from stickslip.experiments.readers.formats import log_name
from stickslip.experiments.readers.guess import Guess
from stickslip.experiments.readers.layout import Layout
from stickslip.formatting import joined

LONGEST: Final = 8
"""Entries of a table that stand on one line."""


def guessed_rig(
    guess: Guess, file: str | Path, *, inertia: float = 1.0, robot: str | Path = ""
) -> str:
    """Return the text of a commented rig file for what a file seems to hold.

    The mechanism is an `Axis` whose inertia is fitted, or a robot with the joints that move. What
    is assumed is marked "assumed".

    Parameters
    ----------
    guess : Guess
        What the file seems to hold, from `guess_data`.
    file : str or Path
        The data file as the rig file should name it: relative to the rig file, or absolute.
    inertia : float
        Mass [kg] or moment of inertia [kg m^2] from which a fit begins.
    robot : str or Path
        The robot description as the rig file should name it; `Guess.robot` if not given.

    Returns
    -------
    str
        Text in TOML.

    Examples
    --------
    >>> guess = Guess(
    ...     file="a.csv", layout=None, columns={"time": "t", "force": "F"}, units={"force": "kN"}
    ... )
    >>> print(guessed_rig(guess, "a.csv").partition("[data]")[2])
    <BLANKLINE>
    file = "a.csv"
    # How the force runs between its samples is estimated. If it is known: hold =
    # "zero" (keeps its value, as a command does) or "first" (straight lines).
    columns = { time = "t", force = "F" }
    units = { force = "kN" }
    <BLANKLINE>
    """
    mechanism = _robot(guess, robot) if guess.robot else _mechanism(guess, inertia)
    return "\n".join([*_head(guess, file), *mechanism, *_data(guess, file), ""])


def _head(guess: Guess, file: str | Path) -> Iterator[str]:
    name = Path(guess.file).name
    yield f"# Written by `stickslip init` from what {name} seems to hold:"
    yield "#"
    yield from (f"#   {line}" for line in str(guess).replace("\t", " ").splitlines())
    yield "#"
    yield "# Numbers are in SI units, or text with a unit. Correct what is wrong; then run"
    yield "# `stickslip check` and `stickslip select` with this file."
    yield ""
    yield f"title = {_toml(log_name(Path(file)))}"
    yield ""


def _mechanism(guess: Guess, inertia: float) -> Iterator[str]:
    turning = guess.turning
    yield "[mechanism]"
    what = "moment of inertia" if turning else "mass"
    yield f'type = "axis"  # one {what} with friction; `stickslip models` lists the others'
    unit, example = ("kg m^2", "0.02 kg m^2") if turning else ("kg", "5 kg")
    if "time" in guess.columns and _drive(guess):
        yield f"# The {what} is not in the file. It is fitted; the search begins at this value."
        yield f'# If it is known, write it without vary: inertia = "{example}"'
        if guess.motor_constant and not _is_stated(guess):
            yield "# It goes with the motor constant below: change both by the same factor."
        yield f'inertia = {{ value = "{inertia:.2g} {unit}", vary = true }}'
    else:
        yield f"# assumed: the file cannot tell the {what}."
        yield f'inertia = "1 {unit}"'
    if "load" not in guess.columns:
        yield '# With the normal force, as in load = "50 N", levels become coefficients.'
    yield ""


def _robot(guess: Guess, file: str | Path) -> Iterator[str]:
    """Yield the table of a robot: its description, which joints move, and where others stand."""
    yield "[mechanism]"
    yield 'type = "urdf"'
    yield f"file = {_toml(str(file) or guess.robot)}"
    yield f"moving = {_toml(list(guess.moving))}"
    if guess.locked:
        yield f"locked = {_inline(guess.locked)}  # where they stood"
    yield "# Masses of a description are often wrong, and rotors of motors are not in it: fits find"
    yield '# what the motion tells of them beside friction. If all is known, write links = "known".'
    yield 'links = "unknown"'
    yield ""


def _drive(guess: Guess) -> str:
    """Return what drives the axis: a force, a current, or nothing that matters.

    Where friction was measured, it tells friction whatever drives the axis.
    """
    known = {name.partition(".")[0] for name in guess.columns}
    if "friction" in known:
        return ""
    return next((name for name in ("force", "current") if name in known), "")


def _data(guess: Guess, file: str | Path) -> Iterator[str]:
    first, *rest = data_options(guess)
    yield from (first, f"file = {_toml(str(file))}", *rest)


def data_options(guess: Guess) -> Iterator[str]:
    """Yield the lines of ``[data]`` that say how a file is read, and so others like it."""
    yield "[data]"
    if _drive(guess) and "time" in guess.columns:
        yield "# How the force runs between its samples is estimated. If it is known: hold ="
        yield '# "zero" (keeps its value, as a command does) or "first" (straight lines).'
    if guess.repair:
        yield f"repair = {_toml(list(guess.repair))}"
    yield from _entries("columns", guess.columns)
    if guess.conditions:
        yield f"conditions = {_toml(list(guess.conditions))}"
    yield from _entries("units", guess.units)
    if guess.motor_constant:
        cure = "assumed: replace it by that of the data sheet, times the gear ratio"
        given = guess.motor_constant
        text = _toml(given) if isinstance(given, str) else _inline(given)
        yield f"motor_constant = {text}" + ("" if _is_stated(guess) else f"  # {cure}")
    if guess.gain:
        assumed = [name for name in guess.gain if name in guess.assumed]
        which = f"{joined(assumed)} " if len(assumed) < len(guess.gain) else ""
        cure = f"  # {which}assumed: replace it by the sensitivity of the sensor, or of the encoder"
        yield f"gain = {_inline(guess.gain)}{cure if assumed else ''}"
    if guess.layout is not None and guess.layout != Layout():
        yield ""
        yield "[data.layout]"
        for one in fields(Layout):
            value = getattr(guess.layout, one.name)
            if value != one.default:
                yield f"{one.name} = {_toml(value)}"


def _is_stated(guess: Guess) -> bool:
    """Whether the motor constant was given, and is no assumption."""
    return guess.reasons.get("motor constant", "").endswith("as given")


def _entries(name: str, table: Mapping[str, Any]) -> Iterator[str]:
    """Yield a table on one line, or a long one with a line for each entry."""
    if len(table) > LONGEST:
        yield from (f"{name}.{_key(key)} = {_toml(value)}" for key, value in table.items())
    elif table:
        yield f"{name} = {_inline(table)}"


def _inline(table: Mapping[str, Any]) -> str:
    return f"{{ {', '.join(f'{_key(key)} = {_toml(value)}' for key, value in table.items())} }}"


def _key(name: str) -> str:
    """Return a key: a quantity with its joint stays dotted, any other name is quoted if needed."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)?", name) else json.dumps(name)


def _toml(value: Any) -> str:
    import tomlkit

    return str(tomlkit.item(list(value) if isinstance(value, tuple) else value).as_string())
