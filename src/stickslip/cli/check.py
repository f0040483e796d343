"""``stickslip check``, ``stickslip init`` and ``stickslip data``."""

import os
import re
import shlex
import tempfile
import warnings
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import typer
from rich.console import Console

from stickslip import data
from stickslip.cli.console import (
    check_rig_file,
    columns_of,
    note,
    print_json,
    reading_of,
    refuse_overwriting,
    say,
    show_table,
    stdout,
)
from stickslip.cli.options import (
    CheckOptions,
    InitOptions,
    ListOptions,
    PathOptions,
    RecordOptions,
)
from stickslip.data import (
    SEVERITIES,
    Checks,
    Finding,
    Measurement,
    Reading,
    Rig,
    check,
    grouped,
    load_rig,
    read_data,
)
from stickslip.data.catalogue import Column, DataFile, Dataset, dataset, names
from stickslip.errors import InputError, UnknownNameError
from stickslip.show.documents import document, json_text, write_file, write_folder
from stickslip.show.formatting import count, joined

# ``stickslip data``.


def run_list(options: ListOptions) -> None:
    """List the records."""
    records = [dataset(name) for name in names()]
    if options.as_json:
        print_json(document("data", {"records": [_record(record) for record in records]}))
        return
    rows = [[file.name, file.title, _short(file.licence), _places(file)] for file in records]
    show_table("", ["name", "title", "licence", "where"], rows, whole=["name", "where"])
    stdout().print(
        "\nDetails of a record: stickslip data show NAME. Its table: stickslip data path NAME"
    )


def run_show(options: RecordOptions) -> None:
    """Show a record in full."""
    record = dataset(options.name)
    if options.as_json:
        print_json(document("data", _record(record)))
        return
    console = stdout()
    console.print(record.title, style="bold")
    for label, text in _head(record).items():
        if text:
            console.print(f"{label:<11}{text}")
    console.print()
    rows = [[c.name, c.unit, c.quantity, _number(c), c.meaning] for c in record.columns]
    show_table("", ["column", "unit", "quantity", "gain", "meaning"], rows)
    for file in record.files.values():
        _show_file(console, record, file)
    for title, known in {"known": record.known, **record.published}.items():
        if known:
            console.print(f"\n{title}", style="bold")
        for key, value in known.items():
            console.print(f"  {key} = {value}")
    if record.notes:
        console.print(f"\n{record.notes}")


def run_path(options: PathOptions) -> None:
    """Print the path of a table; what is downloaded for it is said on stderr."""
    record, file = dataset(options.name), options.file
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always", UserWarning)
        path = record.path(file, report=note)
    for warning in warned:
        note(f"stickslip: {warning.message}")
    if options.as_json:
        content = {"name": options.name, "file": record.file(file).name, "path": str(path)}
        print_json(document("data", content))
    else:
        print(path)


def _places(record: Dataset) -> str:
    """Return where the files of a record are, each place once."""
    return ", ".join(dict.fromkeys(record.place(file).value for file in record.files))


def _short(licence: str) -> str:
    """Return a licence without what is said about it."""
    return re.split(r"[:(]", licence)[0].strip()


def _head(record: Dataset) -> dict[str, str]:
    return {
        "kind": record.kind,
        "citation": record.citation,
        "licence": record.licence,
        "source": f"https://github.com/{record.repository}",
        "commit": record.commit,
        "format": record.format,
        "sampling": record.sampling,
    }


def _number(column: Column) -> str:
    return f"{column.gain:.12g}" if column.quantity else ""


def _show_file(console: Console, record: Dataset, file: DataFile) -> None:
    place = record.place(file.name).value
    console.print(f"\nfile {file.name} ({place})", style="bold")
    about = {
        "about": file.about,
        "rows": "" if file.rows is None else str(file.rows),
        "sha256": file.sha256,
        "upstream": file.source,
        "its sha256": file.source_sha256,
        **file.known,
    }
    for key, value in about.items():
        if value != "":
            text = f"  {key} = {value}" if key in file.known else f"  {key:<11}{value}"
            console.print(text)


def _record(record: Dataset) -> dict[str, Any]:
    return {
        **vars(record),
        "columns": [_column(column) for column in record.columns],
        "files": {name: _file(record, file) for name, file in record.files.items()},
    }


def _column(column: Column) -> dict[str, Any]:
    about = {"name": column.name, "unit": column.unit, "meaning": column.meaning}
    if not column.quantity:
        return about
    return {**about, "quantity": column.quantity, "gain": column.gain}


def _file(record: Dataset, file: DataFile) -> dict[str, Any]:
    own = {key: value for key, value in vars(file).items() if key not in ("name", "ending")}
    return {**own, "where": record.place(file.name).value}


# ``stickslip init``.


def run_init(options: InitOptions) -> None:
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
        result: dict[str, Any] = {"file": str(file), "rig": str(target)}
        result |= {"columns": dict(guess.columns)}
        result |= {"units": dict(guess.units), "turning": guess.turning}
        if urdf is not None:
            result |= {"moving": list(guess.moving), "locked": dict(guess.locked)}
            result |= {"delays": dict(guess.delays)}
        result |= {"reasons": dict(guess.reasons), "doubts": list(guess.doubts)}
        print_json(document("init", result))
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
    result = data.guess_films(files, reading)
    write_file(target, data.filmed_rig(result, {file: _relative(file, target) for file in files}))
    if options.as_json:
        runs = [
            {"file": str(run_init.file), "frequency": run_init.frequency, "travel": run_init.travel}
            for run_init in result.runs
        ]
        content = {"rig": str(target), "films": runs, "doubts": list(result.doubts)}
        print_json(document("init", content))
        return
    typed, law = shlex.quote(str(target)), shlex.quote(f"{target.stem}-report/law.toml")
    low, high = 0.9 * result.runs[0].frequency, 1.1 * result.runs[-1].frequency
    say(str(result))
    say(
        f"\nThe rig file is {target}. Films do not show masses, springs and forces: replace each"
        f" question mark in it. Next: stickslip check {typed}; stickslip select {typed} --route"
        f" travel; stickslip sweep {typed} --law {law} --vary"
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


# ``stickslip check``.

BAD_DATA = 2
MARKS = {"info": ("  ", ""), "warning": ("! ", "yellow"), "error": ("✗ ", "red")}
FORMATS = ("svg", "png")
DOCUMENT = "checks.json"

MOST_LINES = 24
"""Lines about several trials at most: a screen has hardly more."""
RESTED = "constant"
"""Kind of the finding that a trial shows no motion."""


def run(options: CheckOptions) -> None:
    """Check, print the sentences, draw an overview if asked for one."""
    output, reading = options.output, reading_of(options)
    if output is not None:
        refuse_overwriting(output, output, force=options.force, files=(DOCUMENT,))
    files = [*options.files, *options.data]
    rig, data = _parted(files, allow_import=options.allow_import)
    measurement = _measurement(rig, data, reading)
    mechanism, vary = (None, ()) if rig is None else (rig.mechanism, rig.vary)
    result = check(measurement, mechanism=mechanism, vary=vary, conditions=_used(measurement))
    if result.worst != "error":
        from stickslip.identify import sign_findings  # loads the judge

        signs = sign_findings(measurement, mechanism, vary)
        result = replace(result, findings=(*result.findings, *signs))
    origins = [{"name": r.name, "provenance": r.provenance} for r in measurement.records()]
    content = document("check", {**result.to_dict(), "records": origins})
    if options.as_json:
        print_json(content)
    else:
        _show(measurement, result)
    if output is not None:
        note("Drawing the overview ...")
        write_folder(output, {**_pictures(measurement), DOCUMENT: json_text(content)})
        if not options.as_json:
            stdout().print(f"\nFindings and pictures: {output}")
    if not options.as_json:
        stdout().print(f"\n{_summary(result.findings)}")
    if result.worst == "error":
        raise typer.Exit(BAD_DATA)


def _used(measurement: Measurement) -> Collection[str]:
    """Return the conditions that the kind uses; kinds take seconds to load."""
    if not any(record.conditions for record in measurement.records()):
        return ()
    from stickslip.identify.kinds import kind_of

    return kind_of(measurement).conditions


def _parted(files: Sequence[Path], *, allow_import: bool) -> tuple[Rig | None, list[Path]]:
    """Return the rig, if a rig file is among the files, and the files with data."""
    rigs = [file for file in files if file.suffix.lower() == ".toml"]
    if len(rigs) > 1:
        raise InputError(f"check takes one rig file, got {', '.join(map(str, rigs))}.")
    rig = load_rig(rigs[0], allow_import=allow_import) if rigs else None
    return rig, [file for file in files if file not in rigs]


def _measurement(rig: Rig | None, data: Sequence[Path], reading: Reading) -> Measurement:
    """Return what the files hold, read as the rig and then the options say, or what the rig has."""
    if data:
        own = reading if rig is None else rig.reading.with_changes(reading)
        return read_data(data, own, mechanism=None if rig is None else rig.mechanism)
    assert rig is not None  # one file at least is given
    if reading != Reading():
        raise InputError(
            "--columns, --rate, --unit, --gain, --repair and --conditions apply to data files: name"
            f" one beside {rig.path}, or write these settings under its [data]."
        )
    if rig.measurement is None:
        raise InputError(
            f"{rig.path} has no measurement: add [data] with a file, or name the data file as"
            f" well: stickslip check {rig.path} FILE."
        )
    return rig.measurement


def _show(measurement: Measurement, found: Checks) -> None:
    console = stdout()
    origins = dict.fromkeys(record.provenance for record in measurement.records())
    for origin in [item for item in origins if "; " in item][:MOST_LINES]:  # something was repaired
        console.print(f"  {origin}", style="dim")
    findings = [*_by_trial(found.findings)] if measurement.trials else found.findings
    left = len(findings) - MOST_LINES
    if left > 0:  # what is graver comes first, and what all share before what is of one
        grave = sorted(
            findings, key=lambda item: (-SEVERITIES.index(item.severity), bool(item.record))
        )
        findings = [item for item in findings if item in grave[:MOST_LINES]][:MOST_LINES]
    for finding in findings:
        mark, style = MARKS[finding.severity]
        console.print(f"{mark}{finding}", style=style)
    if left > 0:
        console.print(f"And {count(left, 'line')} more.")
    if len(findings) < len(found.findings):
        console.print("All findings of each trial: --json.")


def _by_trial(findings: Sequence[Finding]) -> Iterator[Finding]:
    """Yield one line a trial, what several trials share, and what is of none.

    The line has the first finding of the trial, its warnings and errors that no other has, and that
    the body rested.
    """
    shared = Counter(f.sentence for f in findings if f.record and f.severity != "info")
    names = dict.fromkeys(finding.record for finding in findings if finding.record)
    for name in names:
        first, *rest = [finding for finding in findings if finding.record == name]
        said = [
            item for item in (first, *rest) if shared[item.sentence] == 1 or item.kind == RESTED
        ]
        lines = [first.sentence] * (first not in said and first.severity == "info")
        lines += [finding.sentence for finding in said]
        if lines:
            gravest = max(said, key=lambda item: SEVERITIES.index(item.severity), default=first)
            yield replace(first, sentence=" ".join(lines), severity=gravest.severity)
    several = [item for item in findings if shared[item.sentence] > 1]
    yield from grouped([*several, *(finding for finding in findings if not finding.record)])


def _summary(findings: Sequence[Finding]) -> str:
    """Return in one line what is to be corrected."""
    errors, warnings = (
        joined([*dict.fromkeys(f.kind for f in findings if f.severity == name)])
        for name in ("error", "warning")
    )
    if errors:
        return f"To correct before a fit: the findings marked ✗ ({errors})."
    if warnings:
        return f"Nothing must be corrected; to look at: the findings marked ! ({warnings})."
    return "Nothing to correct."


def _pictures(measurement: Measurement) -> dict[str, str | bytes]:
    """Return an overview of each record in both formats."""
    from stickslip.show.plots import draw_overview, overview_size, save

    files: dict[str, str | bytes] = {}
    if measurement.kind == "scalars":
        return files
    with tempfile.TemporaryDirectory() as folder:
        for index, record in enumerate(measurement.records()):
            for ending in FORMATS:
                name = f"overview{f'-{index + 1}' * bool(measurement.trials)}.{ending}"
                size = overview_size(record)
                path = save(draw_overview(record), Path(folder, name), size=size, title=record.name)
                files[name] = path.read_bytes()
    return files
