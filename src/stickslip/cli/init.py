"""``stickslip init``."""

import os
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

from stickslip import data
from stickslip.cli.console import check_rig_file, columns_of, print_json, refuse_overwriting, say
from stickslip.cli.options import InitOptions
from stickslip.errors import InputError, UnknownNameError
from stickslip.show.documents import document, write_file


def run(options: InitOptions) -> None:
    """Find out what a file holds, or films do, write a rig file, and print what was found."""
    file, urdf, reading = options.files[0], options.urdf, columns_of(options)
    if len(options.files) > 1:
        if urdf is not None:
            raise InputError("--urdf takes one log of a robot, got several files.")
        _films(options, reading)
        return
    named = file if file.name else file.absolute()  # "." is the folder that it stands for
    if not named.name:
        raise InputError(f"{str(file)!r} is no data file: give the file, or the folder of a log.")
    ended = named.suffix[1:2].isalpha()  # run_0.5mm has no ending
    own = named.with_suffix(".toml") if ended else named.with_name(f"{named.name}.toml")
    target = options.output or own
    check_rig_file(target)
    refuse_overwriting(target, target.parent, force=options.force)
    try:
        guess = _guess(file, reading, urdf)
    except UnknownNameError:
        raise
    except InputError as error:
        raise type(error)(data.spelled(str(error), "options")) from None
    if not options.as_json:  # all of the file is read once more below
        say(str(guess))
    name = _relative(data.data_file(file), target)
    if urdf is None:
        record = data.read_data([file], replace(guess.reading, by="options"))
        inertia, swing = data.inertia_of(record) or 1.0, data.swing_of(record)
        text = data.guessed_rig(guess, name, inertia=inertia, swing=swing)
    else:
        text = data.guessed_rig(guess, name, robot=_relative(urdf, target))
    write_file(target, text)
    if options.as_json:
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
    left = " Replace each question mark in it." if '"? ' in text else ""
    say(
        f"\nThe rig file is {target}.{left} Next: stickslip check {typed}; stickslip select {typed}"
    )


def _films(options: InitOptions, reading: data.Reading) -> None:
    """Find out what films of one body show, write its rig file, and print what was found."""
    target = options.output or options.files[0].with_name("capsule.toml")
    check_rig_file(target)
    refuse_overwriting(target, target.parent, force=options.force)
    files = options.files
    found = data.guess_films(files, reading)
    write_file(target, data.filmed_rig(found, {file: _relative(file, target) for file in files}))
    if options.as_json:
        runs = [
            {"file": str(run.file), "frequency": run.frequency, "travel": run.travel}
            for run in found.runs
        ]
        content = {"rig": str(target), "films": runs, "doubts": list(found.doubts)}
        print_json(document("init", content))
        return
    typed = shlex.quote(str(target))
    low, high = 0.9 * found.runs[0].frequency, 1.1 * found.runs[-1].frequency
    say(str(found))
    say(
        f"\nThe rig file is {target}. Films do not show masses, springs and forces: replace each"
        f" question mark in it. Next: stickslip check {typed}; stickslip select {typed} --route"
        f" travel; stickslip sweep {typed} --law stickslip-report/law.toml --vary"
        f" drive.frequency={low:.3g}:{high:.3g}:45 --ensemble 24"
    )


def _guess(file: Path, reading: data.Reading, urdf: Path | None) -> data.Guess:
    """Return what a file holds of one axis, or of the joints of a robot."""
    if urdf is None:
        return data.guess_data(
            file,
            columns=reading.columns,
            units=reading.units,
            gain=reading.gain,
            motor_constant=reading.motor_constant.get("current"),
        )
    if reading.columns or reading.gain or reading.motor_constant:
        raise InputError(
            "--columns, --rate, --gain and --motor-constant are those of one axis: with --urdf,"
            " change the rig file that is written, as columns = { position.elbow = ... }."
        )
    return data.guess_robot(file, urdf, units=reading.units)


def _relative(file: Path, target: Path) -> str:
    """Return the data file as its rig file names it."""
    try:
        return Path(os.path.relpath(file.absolute(), target.absolute().parent)).as_posix()
    except ValueError:  # another drive
        return str(file.absolute())
