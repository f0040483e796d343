"""``stickslip check``."""

import tempfile
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import typer

from stickslip.cli.console import (
    MOST_NAMED,
    note,
    print_json,
    reading_of,
    refuse_overwriting,
    stdout,
)
from stickslip.cli.options import CheckOptions
from stickslip.data import (
    SEVERITIES,
    Checks,
    Finding,
    Measurement,
    Reading,
    Rig,
    check,
    load_rig,
    read_data,
)
from stickslip.errors import InputError
from stickslip.show.documents import document, json_text, write_folder
from stickslip.show.formatting import count, joined

BAD_DATA = 2
MARKS = {"info": ("  ", ""), "warning": ("! ", "yellow"), "error": ("✗ ", "red")}
FORMATS = ("svg", "png")
DOCUMENT = "checks.json"

MOST_LINES = 24
"""Lines about several trials at most: a screen has hardly more."""
RESTED = "constant"
"""Kind of the finding that a trial shows no motion."""
LABELS = {
    "conditions": "conditions that are not used",
    "constant": "a quantity that does not change",
    "contact input": "what was measured beside",
    "coverage": "the range of speeds",
    "drift": "drift",
    "drive": "the force that drives the motion",
    "drive frequency": "the frequency of the drive",
    "effective size": "too few independent samples",
    "force sign": "the sign of the force",
    "friction sign": "the sign of friction",
    "gap": "gaps",
    "held samples": "samples logged at a lower rate",
    "jump": "jumps",
    "length": "too few samples",
    "line": "the line of a motion in a plane",
    "load": "the normal force",
    "lost": "missing rows or cells",
    "volts": "a force made of volts",
    "low speed": "slow samples",
    "mains hum": "mains hum",
    "mechanism": "the mechanism",
    "motion": "how much moves",
    "order": "the order of the readings",
    "outliers": "samples far off those beside",
    "quantisation": "coarse steps of a signal",
    "repeated trial": "trials with the same samples",
    "rest": "readings at rest",
    "rests": "periods of rest",
    "reversals": "motion in one direction only",
    "sampling": "uneven sampling",
    "saturation": "clipped values",
    "settings": "the settings of the readings",
    "steady readings": "steady readings taken for a motion",
    "trials": "trials with different quantities",
    "uncertainty": "uncertainties of the readings",
    "units": "units",
    "unused column": "unused columns",
    "velocity": "the velocity beside the position",
}
"""Words of the last line for each kind of finding."""


def run(options: CheckOptions) -> None:
    """Check, print the sentences, draw an overview if asked for one."""
    output, reading = options.output, reading_of(options)
    if output is not None:
        refuse_overwriting(output, output, force=options.force, files=(DOCUMENT,))
    files = [*options.files, *options.data]
    rig, data = _parted(files, allow_import=options.allow_import)
    mechanism = None if rig is None else rig.mechanism
    measurement = _measurement(rig, data, reading)
    vary = () if rig is None else rig.vary
    found = check(measurement, mechanism=mechanism, vary=vary, conditions=_used(measurement))
    records = measurement.records()
    origins = {"records": [{"name": r.name, "provenance": r.provenance} for r in records]}
    content = document("check", {**found.to_dict(), **origins})
    if options.as_json:
        print_json(content)
    else:
        _show(measurement, found)
    if output is not None:
        note("Drawing the overview ...")
        write_folder(output, {**_pictures(measurement), DOCUMENT: json_text(content)})
        if not options.as_json:
            stdout().print(f"\nFindings and pictures: {output}")
    if not options.as_json:
        stdout().print(f"\n{_summary(found.findings)}")
    if found.worst == "error":
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
    for origin in [one for one in origins if "; " in one][:MOST_LINES]:  # something was repaired
        console.print(f"  {origin}", style="dim")
    findings = [*_by_trial(found.findings)] if measurement.trials else found.findings
    left = len(findings) - MOST_LINES
    if left > 0:  # what is graver comes first, and what all share before what is of one
        grave = sorted(
            findings, key=lambda one: (-SEVERITIES.index(one.severity), bool(one.record))
        )
        findings = [one for one in findings if one in grave[:MOST_LINES]][:MOST_LINES]
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
        said = [one for one in (first, *rest) if shared[one.sentence] == 1 or one.kind == RESTED]
        lines = [first.sentence] * (first not in said and first.severity == "info")
        lines += [finding.sentence for finding in said]
        if lines:
            gravest = max(said, key=lambda item: SEVERITIES.index(item.severity), default=first)
            yield replace(first, sentence=" ".join(lines), severity=gravest.severity)
    for sentence in (key for key, number in shared.items() if number > 1):
        same = [finding for finding in findings if finding.sentence == sentence]
        who = [finding.record for finding in same]
        everyone = len(who) == len(names)
        yield replace(same[0], record="all trials" if everyone else joined(who, MOST_NAMED))
    yield from (finding for finding in findings if not finding.record)


def _summary(findings: Sequence[Finding]) -> str:
    """Return in one line what is to be corrected."""
    errors, warnings = (
        joined([*dict.fromkeys(LABELS[f.kind] for f in findings if f.severity == name)])
        for name in ("error", "warning")
    )
    if errors:
        return f"To correct before a fit: {errors}."
    if warnings:
        return f"Nothing must be corrected; to look at: {warnings}."
    return "Nothing to correct."


def _name(measurement: Measurement, index: int, ending: str) -> str:
    return f"overview-{index + 1}.{ending}" if measurement.trials else f"overview.{ending}"


def _pictures(measurement: Measurement) -> dict[str, str | bytes]:
    """Return an overview of each record in both formats."""
    from stickslip.show.plots import draw_overview, overview_size, save

    files: dict[str, str | bytes] = {}
    if measurement.kind == "scalars":
        return files
    with tempfile.TemporaryDirectory() as folder:
        for index, record in enumerate(measurement.records()):
            for ending in FORMATS:
                name = _name(measurement, index, ending)
                size = overview_size(record)
                path = save(draw_overview(record), Path(folder, name), size=size, title=record.name)
                files[name] = path.read_bytes()
    return files
