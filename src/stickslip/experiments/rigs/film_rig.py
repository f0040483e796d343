"""Finds a body that drives itself in films of it at several frequencies, and writes its rig file.

Each film has a position in time. A capsule or a cart moves to and fro with its drive, and travels:
what a film oscillates with is compared with the frequency in its name. Masses, spring and drive are
not in any film; the rig file has a question mark for each, and is refused until they are given.
"""

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import final

import numpy as np
from typing_extensions import override

from stickslip.errors import InputError
from stickslip.experiments.films import (
    HARMONICS,
    OTHER,
    SHOWN,
    frequency_of,
    is_filmed,
    oscillation,
)
from stickslip.experiments.readers.guess import Guess, guess_data
from stickslip.experiments.readers.reader_options import Reading
from stickslip.experiments.records import read_data
from stickslip.experiments.rigs.guessed_rig import data_options
from stickslip.formatting import number, printable, quantity

IN_NAME = re.compile(r"(?<![\d.])(\d+(?:[.,_p]\d+)?)[ _-]?hz", re.IGNORECASE)
"""A frequency in the name of a file: capsule_5.5Hz.txt, run-4p5_hz.csv."""
FREQUENCY = "mechanism.drive.drive.frequency"


@final
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

    @override
    def __str__(self) -> str:
        return (
            f"{self.file.name}  {self.frames} frames at {number(self.rate, 3)} Hz, drive"
            f" {number(self.frequency, 4)} Hz {self.reason}, travels"
            f" {quantity(self.travel, 'm', 3)}"
        )


@final
@dataclass(frozen=True, kw_only=True)
class FilmedRig:
    """What films of one body show."""

    guess: Guess
    """How the first file is read, and so all of them."""
    runs: tuple[FilmedRun, ...]
    doubts: tuple[str, ...] = field(default=())

    @override
    def __str__(self) -> str:
        parts = [str(run) for run in self.runs]
        return "\n".join([*parts, *(f"! {doubt}" for doubt in self.doubts)])


def guess_films(files: Sequence[Path], reading: Reading) -> FilmedRig:
    """Find out what films of one body show: positions, frequencies and travels."""
    guess = guess_data(files[0], columns=reading.columns, units=reading.units, gain=reading.gain)
    runs, doubts = list[FilmedRun](), list(guess.doubts)
    for path in files:
        film = read_data([path], guess.reading)
        if not is_filmed(film) or film.trials:
            raise InputError(
                f"{path.name} is no film: it holds {', '.join(film.quantities())}. Several files"
                " are taken for films, which have positions in time and no more; give the others"
                " one by one."
            )
        runs.append(_run(path, film.time, film.values("position")))
        doubts += [runs[-1].doubt] if runs[-1].doubt else []
    no_force = next((one for one in doubts if "no force" in one), None)
    if no_force in doubts:  # films of what drives itself need none
        doubts.remove(no_force)
    runs.sort(key=lambda run: run.frequency)
    return FilmedRig(guess=guess, runs=tuple(runs), doubts=tuple(dict.fromkeys(doubts)))


def _run(path: Path, time: object, position: object) -> FilmedRun:
    """Return what a film shows."""
    t, x = np.asarray(time, dtype=float), np.asarray(position, dtype=float)
    best, share = frequency_of(t, x)
    named = IN_NAME.search(path.stem)
    stated = float(re.sub("[,_p]", ".", named[1].lower())) if named else math.nan
    doubt = ""
    if share < SHOWN and not named:
        raise InputError(
            f"{path.name} shows no oscillation: the best frequency explains {share:.0%} of its"
            " motion about a smooth curve. Write the frequency of its drive into its name, as in"
            " capsule_5.5Hz.txt."
        )
    frequency, reason = stated, "by its name"
    if not named:
        frequency, reason = float(f"{best:.3g}"), "as it oscillates"
        doubt = f"{path.name}: the frequency is read off the film; write the one that was set."
    elif oscillation(t, x, 0.5 * stated, 2 * HARMONICS) < OTHER * share:
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
    return "\n".join([*_head(rig), *_capsule(rig), *data_options(rig.guess), *_trials(rig, names)])


def _head(rig: FilmedRig) -> Iterator[str]:
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
    yield 'drive_on = "both"  # "inner mass" if a coil or magnets outside pull at it'
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
    for run in rig.runs:
        yield ""
        yield "[[trial]]"
        yield f'name = "{number(run.frequency, 4)} Hz"'
        yield f"file = {json.dumps(names[run.file])}"
        yield f'set = {{ {FREQUENCY} = "{number(run.frequency, 4)} Hz" }}  # {run.reason}'
    yield ""
