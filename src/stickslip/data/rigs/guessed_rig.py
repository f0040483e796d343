"""Rig files where only data are known: of one record, or of films at several frequencies.

What no file can tell has a question mark in the rig file, which is refused until it is given.
"""

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

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

if TYPE_CHECKING:
    from jinja2 import Environment

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
    turning, length, mass = guess.turning, 0.0, 0.0
    if swing is not None and swing.inertia is not None:
        length = ROD * swing.length
        mass = swing.inertia * swing.stiffness / (GRAVITY * length)
    return _filled(
        "record.toml.j2",
        guess,
        file=_toml(str(file)),
        source=Path(guess.file).name,
        lines=str(guess).replace("\t", " ").splitlines(),
        title=_toml(log_name(Path(file))),
        robot=guess.robot and _toml(str(robot) or guess.robot),
        swing=swing,
        length=length,
        mass=mass,
        hangs=swing is not None and turning and abs(swing.rest) > NEGLIGIBLE,  # [rad]
        inertia=inertia,
        what="moment of inertia" if turning else "mass",
        unit="kg m^2" if turning else "kg",
    )


def _filled(template: str, guess: Guess, **given: Any) -> str:
    """Return a rig file from its template, with how its data files are read."""
    known = {name.partition(".")[0] for name in guess.columns}
    # Where friction was measured, it tells friction whatever drives the axis.
    driven = bool({"force", "current"} & known) and "time" in guess.columns
    assumed = [name for name in guess.gain if name in guess.assumed]
    which = f"{joined(assumed)} " if len(assumed) < len(guess.gain) else ""
    cure = f"  # {which}assumed: replace it by the sensitivity of the sensor, or of the encoder"
    layout = vars(guess.layout or Layout())
    return (
        _templates()
        .get_template(template)
        .render(
            guess=guess,
            driven=driven and "friction" not in known,
            stated=guess.reasons.get("motor constant", "").endswith("as given"),
            assumed=cure if assumed else "",
            layout={name: x for name, x in layout.items() if x != getattr(Layout, name)},
            **given,
        )
    )


@cache
def _templates() -> "Environment":
    from jinja2 import Environment, PackageLoader, StrictUndefined

    result = Environment(
        loader=PackageLoader("stickslip.data.rigs", ""),
        autoescape=False,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    result.filters |= {
        "entries": _entries,
        "g": lambda value, digits: f"{value:.{digits}g}",
        "json": json.dumps,
        "left_open": _left_open,
        "toml": _toml,
    }
    return result


def _left_open(text: str, stated: bool) -> str:
    """Return a text with question marks for motor constants that were 1 to look at the file."""
    return text if stated else re.sub(r'"1 (N( m)?/A)"', r'"? \1"', text)


def _entries(table: Mapping[str, Any], name: str) -> str:
    """Return a table on one line, or a long one with a line for each entry."""
    if len(table) > LONGEST:
        return "".join(f"{name}.{_key(key)} = {_toml(value)}\n" for key, value in table.items())
    return f"{name} = {_toml(table)}\n" if table else ""


def _key(name: str) -> str:
    """Return a key: a quantity with its joint stays dotted, any other name is quoted if needed."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)?", name) else json.dumps(name)


def _toml(value: Any) -> str:
    """Return a value, or a table on one line."""
    import tomlkit

    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{_key(key)} = {_toml(x)}' for key, x in value.items())} }}"
    return str(tomlkit.item(list(value) if isinstance(value, tuple) else value).as_string())


# Finds a body that drives itself in films of it at several frequencies, and writes its rig file.
#
# Each film has a position in time. A capsule or a cart moves to and fro with its drive, and
# travels: what a film oscillates with is compared with the frequency in its name. Masses, spring
# and drive are not in any film; the rig file has a question mark for each, and is refused until
# they are given.

IN_NAME = re.compile(r"(?<![\d.])(\d+(?:[.,_p]\d+)?)[ _-]?hz", re.IGNORECASE)
"""A frequency in the name of a file: capsule_5.5Hz.txt, run-4p5_hz.csv."""


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
    of_settings = groupby(rig.runs, lambda run: f"{number(run.frequency, 4)} Hz")
    return _filled(
        "films.toml.j2",
        rig.guess,
        file="",
        rig=rig,
        lines=[*map(printable, str(rig).splitlines())],
        settings=[(setting, [*runs]) for setting, runs in of_settings],
        names=names,
    )
