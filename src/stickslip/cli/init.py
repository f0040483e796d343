"""``stickslip init``."""

import os
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

from stickslip.cli.console import check_rig_file, print_json, refuse_overwriting, stdout
from stickslip.documents import document, write_file
from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments import (
    Guess,
    Reading,
    data_file,
    guess_data,
    guess_robot,
    guessed_rig,
    inertia_of,
    read_data,
)


def run(
    file: Path,
    reading: Reading,
    output: Path | None,
    *,
    urdf: Path | None = None,
    force: bool,
    as_json: bool,
) -> None:
    """Find out what a file holds, write its rig file, and print what was found."""
    named = file if file.name else file.absolute()  # "." is the folder that it stands for
    if not named.name:
        raise InputError(f"{str(file)!r} is no data file: give the file, or the folder of a log.")
    target = named.with_suffix(".toml") if output is None else output
    check_rig_file(target)
    refuse_overwriting(target, target.parent, force=force)
    try:
        guess = _guess(file, reading, urdf)
    except UnknownNameError:
        raise
    except InputError as error:
        text = str(error).replace('columns={"', "--columns ").replace('": "..."}', "=...")
        raise type(error)(text) from None
    if not as_json:  # all of the file is read once more below
        stdout().print(str(guess), markup=False)
    name = _relative(data_file(file), target)
    if urdf is None:
        inertia = inertia_of(read_data([file], replace(guess.reading, by="options")))
        text = guessed_rig(guess, name, inertia=inertia or 1.0)
    else:
        text = guessed_rig(guess, name, robot=_relative(urdf, target))
    write_file(target, text)
    if as_json:
        found: dict[str, Any] = {"file": str(file), "rig": str(target)}
        found |= {"columns": dict(guess.columns)}
        found |= {"units": dict(guess.units), "turning": guess.turning}
        if urdf is not None:
            found |= {"moving": list(guess.moving), "locked": dict(guess.locked)}
            found |= {"delays": dict(guess.delays)}
        found |= {"reasons": dict(guess.reasons), "doubts": list(guess.doubts)}
        print_json(document("init", found))
        return
    typed = shlex.quote(str(target))
    stdout().print(
        f"\nThe rig file is {target}. Next: stickslip check {typed}; stickslip select {typed}",
        markup=False,
    )


def _guess(file: Path, reading: Reading, urdf: Path | None) -> Guess:
    """Return what a file holds of one axis, or of the joints of a robot."""
    if urdf is None:
        return guess_data(
            file,
            columns=reading.columns,
            units=reading.units,
            gain=reading.gain,
            motor_constant=reading.motor_constant.get("current"),
        )
    if reading.columns or reading.gain or reading.motor_constant:
        raise InputError(
            "--columns, --gain and --motor-constant are those of one axis: with --urdf, change the"
            " rig file that is written, as columns = { position.elbow = ... }."
        )
    return guess_robot(file, urdf, units=reading.units)


def _relative(file: Path, target: Path) -> str:
    """Return the data file as its rig file names it."""
    try:
        return Path(os.path.relpath(file.absolute(), target.absolute().parent)).as_posix()
    except ValueError:  # another drive
        return str(file.absolute())
