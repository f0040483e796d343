"""Rig files where only data are known: of one record, or of films at several frequencies.

What no file can tell has a question mark in the rig file, which is refused until it is given.
"""

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from itertools import groupby
from pathlib import Path
from typing import Any, Final

import numpy as np

from stickslip.data import travels
from stickslip.data.checking.motion import GRAVITY, Swing
from stickslip.data.readers.columns import Reading
from stickslip.data.readers.guess import UNDRIVEN, Guess, guess_data
from stickslip.data.readers.layout import Layout
from stickslip.data.readers.table_reader import log_name
from stickslip.data.records import read_data
from stickslip.data.tolerances import HALF, NEGLIGIBLE
from stickslip.errors import InputError
from stickslip.show.formatting import joined, number, percent, printable, quantity

# Writes the rig file of a record of which only the data file is known.

ROD: Final = 0.75
"""Length to the centre of mass of a rod, over that of a point mass that swings as it does."""
LONGEST: Final = 8
"""Entries of a table that stand on one line."""


def guessed_rig(
    guess: Guess,
    file: str | Path,
    *,
    inertia: float = 1.0,
    swing: Swing | None = None,
    robot: str | Path = "",
) -> str:
    """Return the text of a commented rig file for what a file seems to hold.

    The mechanism is an `Axis` whose inertia is fitted, or a robot with the joints that move; of a
    body that swings freely a `Pendulum`, or an axis with a spring. What is assumed is marked
    "assumed".

    Parameters
    ----------
    guess : Guess
        What the file seems to hold, from `guess_data`.
    file : str or Path
        The data file as the rig file should name it: relative to the rig file, or absolute.
    inertia : float
        Mass [kg] or moment of inertia [kg m^2] from which a fit begins.
    swing : Swing, optional
        How the body swings where nothing drives it.
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
    if guess.robot:
        mechanism = _robot(guess, robot)
    else:
        mechanism = _mechanism(guess, inertia) if swing is None else _swinging(guess, swing)
    return "\n".join([*_record_head(guess, file), *mechanism, *_data(guess, file), ""])


def _record_head(guess: Guess, file: str | Path) -> Iterator[str]:
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
            yield "# With a motor constant of 1 it is this: multiply it by the constant below."
        yield f'inertia = {{ value = "{inertia:.2g} {unit}", vary = true }}'
    elif "time" in guess.columns and "friction" not in guess.columns:
        yield f"# The file cannot tell the {what}, and friction is in proportion to it: give it."
        yield f'inertia = "? {unit}"'
    else:
        yield f"# assumed: the file cannot tell the {what}."
        yield f'inertia = "1 {unit}"'
    yield from _with_load(guess)


def _with_load(guess: Guess) -> Iterator[str]:
    if "load" not in guess.columns:
        yield '# With the normal force, as in load = "50 N", levels become coefficients.'
    yield ""


def _swinging(guess: Guess, swing: Swing) -> Iterator[str]:
    """Yield the table of a body that swings: of a pendulum, or on a spring."""
    frequency = f"{swing.frequency:.3g} Hz"
    yield "[mechanism]"
    if not guess.turning:
        yield 'type = "axis"  # a mass on a spring, as it swings by itself'
        yield f"# The file cannot tell the mass. It swings at {frequency}: for each kg of mass"
        yield f"# the stiffness is {swing.stiffness:.4g} N/m, and friction is found in proportion."
        yield 'inertia = "? kg"'
        yield 'stiffness = "? N/m"'
    elif swing.inertia is None:
        length = swing.length
        yield 'type = "pendulum"  # assumed, as it swings by itself; on a spring it is an "axis"'
        yield f'# with stiffness = "{swing.stiffness:.3g} N m/rad" for each kg m^2 of its inertia.'
        yield 'mass = "? kg"  # a free motion tells friction over the mass only'
        yield f"# From the axis to the centre of mass, if all of it is there: {frequency} in small"
        yield "# swings. Else give the true length, and as inertia that about the centre of mass,"
        yield f"# mass * length * ({length:.3g} m - length)."
        yield f'length = "{length:.4g} m"'
    else:
        weight = swing.inertia * swing.stiffness
        length = ROD * swing.length
        mass = weight / (GRAVITY * length)
        yield 'type = "pendulum"  # assumed, as the torque holds a weight; else it is an "axis"'
        product = f"{weight / GRAVITY:.3g} kg m"
        yield f"# The torque tells mass * length ({product}) and the inertia about the axis only."
        yield "# The length is that of a rod: give the true one, to the centre of mass."
        yield f'length = "{length:.4g} m"'
        yield "# Both are fitted; the search begins at these values. The inertia is that about the"
        yield "# centre of mass. If one is known, write it without vary."
        yield f'mass = {{ value = "{mass:.3g} kg", vary = true }}'
        about = swing.inertia - mass * length**2
        yield f'inertia = {{ value = "{about:.3g} kg m^2", vary = true }}'
    if guess.turning and abs(swing.rest) > NEGLIGIBLE:  # [rad]
        of = "" if "position" in guess.columns else ", counted from where the record begins"
        yield f'rest_angle = "{swing.rest:.4g} rad"  # where it hangs at rest{of}'
    yield from _with_load(guess)


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
        given = guess.motor_constant
        text = _left_open(guess, _toml(given) if isinstance(given, str) else _inline(given))
        yield f"motor_constant = {text}  # that of the data sheet, times the gear ratio"
    if guess.gain:
        assumed = [name for name in guess.gain if name in guess.assumed]
        which = f"{joined(assumed)} " if len(assumed) < len(guess.gain) else ""
        cure = f"  # {which}assumed: replace it by the sensitivity of the sensor, or of the encoder"
        yield f"gain = {_left_open(guess, _inline(guess.gain))}{cure if assumed else ''}"
    if guess.layout is not None and guess.layout != Layout():
        yield ""
        yield "[data.layout]"
        for entry in fields(Layout):
            value = getattr(guess.layout, entry.name)
            if value != entry.default:
                yield f"{entry.name} = {_toml(value)}"


def _left_open(guess: Guess, text: str) -> str:
    """Return a text with question marks for motor constants that were 1 to look at the file."""
    return text if _is_stated(guess) else re.sub(r'"1 (N( m)?/A)"', r'"? \1"', text)


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


# Finds a body that drives itself in films of it at several frequencies, and writes its rig file.
#
# Each film has a position in time. A capsule or a cart moves to and fro with its drive, and
# travels: what a film oscillates with is compared with the frequency in its name. Masses, spring
# and drive are not in any film; the rig file has a question mark for each, and is refused until
# they are given.

IN_NAME = re.compile(r"(?<![\d.])(\d+(?:[.,_p]\d+)?)[ _-]?hz", re.IGNORECASE)
"""A frequency in the name of a file: capsule_5.5Hz.txt, run-4p5_hz.csv."""
FREQUENCY = "mechanism.drive.drive.frequency"


@dataclass(frozen=True, kw_only=True)
class FilmedRun:
    """One film: how the body moved in it."""

    file: Path
    frames: int
    """Number of frames with a position."""
    rate: float
    """Frames a second [Hz]."""
    frequency: float
    """Of the drive [Hz]."""
    reason: str
    """Where the frequency is from."""
    travel: float
    """Last position less the first [m]."""
    doubt: str = ""
    """What is doubtful about the frequency."""

    def __str__(self) -> str:
        return (
            f"{self.file.name}  {self.frames} frames at {number(self.rate, 3)} Hz, drive"
            f" {number(self.frequency, 4)} Hz {self.reason}, travels"
            f" {quantity(self.travel, 'm', 3)}"
        )


@dataclass(frozen=True, kw_only=True)
class FilmedRig:
    """What films of one body show."""

    guess: Guess
    """How the first file is read, and so all of them."""
    runs: tuple[FilmedRun, ...]
    doubts: tuple[str, ...] = field(default=())

    def __str__(self) -> str:
        parts = [str(run) for run in self.runs]
        return "\n".join([*parts, *(f"! {doubt}" for doubt in self.doubts)])


def guess_films(files: Sequence[Path], reading: Reading) -> FilmedRig:
    """Find out what films of one body show: positions, frequencies and travels."""
    guess = guess_data(files[0], columns=reading.columns, units=reading.units, gain=reading.gain)
    runs, doubts = list[FilmedRun](), list(guess.doubts)
    for path in files:
        film = read_data([path], guess.reading)
        if not travels.is_filmed(film) or film.trials:
            raise InputError(
                f"{path.name} is no film: it holds {', '.join(film.quantities())}. Several files"
                " are taken for films, which have positions in time and no more; give the others"
                " one by one."
            )
        runs.append(_run(path, film.time, film.values("position")))
        doubts += [runs[-1].doubt] if runs[-1].doubt else []
    doubts = [doubt for doubt in doubts if not doubt.startswith(UNDRIVEN)]
    runs.sort(key=lambda run: run.frequency)
    return FilmedRig(guess=guess, runs=tuple(runs), doubts=tuple(dict.fromkeys(doubts)))


def _run(path: Path, time: object, position: object) -> FilmedRun:
    """Return what a film shows."""
    t, x = np.asarray(time, dtype=float), np.asarray(position, dtype=float)
    best, share = travels.frequency_of(t, x)
    named = IN_NAME.search(path.stem)
    stated = float(re.sub("[,_p]", ".", named[1].lower())) if named else math.nan
    doubt = ""
    if share < HALF and not named:
        raise InputError(
            f"{path.name} shows no oscillation: the best frequency explains {percent(share)} of its"
            " motion about a smooth curve. Write the frequency of its drive into its name, as in"
            " capsule_5.5Hz.txt."
        )
    frequency, reason = stated, "by its name"
    if not named:
        frequency, reason = float(f"{best:.3g}"), "as it oscillates"
        doubt = f"{path.name}: the frequency is read off the film; write the one that was set."
    elif travels.oscillation(t, x, 0.5 * stated, 2 * travels.HARMONICS) < HALF * share:
        frequency, reason = float(f"{best:.3g}"), "as it oscillates"
        doubt = (
            f"{path.name} oscillates with {number(best, 3)} Hz, and its name says"
            f" {number(stated, 3)} Hz: find out which is right."
        )
    return FilmedRun(
        file=path,
        frames=len(t),
        rate=1.0 / float(np.median(np.diff(t))),
        frequency=frequency,
        reason=reason,
        travel=float(x[-1] - x[0]),
        doubt=doubt,
    )


def filmed_rig(rig: FilmedRig, names: Mapping[Path, str]) -> str:
    """Return the text of a rig file of films, with question marks for what they do not show."""
    return "\n".join(
        [*_films_head(rig), *_capsule(rig), *data_options(rig.guess), *_trials(rig, names)]
    )


def _films_head(rig: FilmedRig) -> Iterator[str]:
    yield f"# Written by `stickslip init` from {len(rig.runs)} films of a body that drives itself:"
    yield "#"
    yield from (f"#   {printable(line)}" for line in str(rig).splitlines())
    yield "#"
    yield "# Films show no masses, springs and forces: replace each question mark. Then run"
    yield "# `stickslip check` and `stickslip select --route travel` with this file."
    yield ""
    yield 'title = "Filmed capsule"'
    yield ""


def _capsule(rig: FilmedRig) -> Iterator[str]:
    yield "[mechanism]"
    yield 'type = "capsule"  # assumed; `stickslip models` lists others that drive themselves'
    yield 'capsule_mass = "? g"  # without what moves inside'
    yield 'inner_mass = "? g"'
    yield 'stiffness = "? N/m"  # of the spring between the two'
    yield 'damping = "? N s/m"  # from how the inner mass rings while the capsule is held'
    yield 'drive_on = "?"  # "both"; or "inner mass" if a coil or magnets outside pull at it'
    yield "# A hard stop on the side of positive x; then remove the elastic stop below."
    yield '# upper_stop = "? mm"  # from where the spring is free of force'
    yield "# restitution = 0.5  # speed after an impact over that before; 0 if nothing bounces"
    yield ""
    yield "# An elastic stop that the inner mass meets on the side of positive x; else remove it."
    yield "[mechanism.upper_soft_stop]"
    yield 'place = "? mm"  # from where the spring is free of force'
    yield 'stiffness = "? N/m"'
    yield 'damping = "? N s/m"'
    yield ""
    yield "[mechanism.drive]"
    yield 'type = "torque"'
    first = number(rig.runs[0].frequency, 4)
    yield f'drive = {{ type = "sine", amplitude = "? N", frequency = "{first} Hz" }}'
    yield ""


def _trials(rig: FilmedRig, names: Mapping[Path, str]) -> Iterator[str]:
    for setting, runs in groupby(rig.runs, lambda run: f"{number(run.frequency, 4)} Hz"):
        for repeat, run in enumerate(runs, 1):
            yield ""
            yield "[[trial]]"
            yield f'name = "{setting}"' if repeat == 1 else f'name = "{setting}, {repeat}"'
            yield f"file = {json.dumps(names[run.file])}"
            yield f'set = {{ {FREQUENCY} = "{setting}" }}  # {run.reason}'
    yield ""
