"""``stickslip simulate`` and ``stickslip animate``."""

import io
import re
from collections.abc import Mapping
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import typer

from stickslip import mechanisms
from stickslip.cli import console as terminal
from stickslip.cli import inputs
from stickslip.cli.console import print_json, refuse_overwriting, stdout
from stickslip.cli.inputs import (
    ChosenForm,
    ChosenLaw,
    ChosenLaws,
    rig_and_form,
    rig_and_friction,
    rig_content,
)
from stickslip.cli.options import AnimateOptions, SimulateOptions, typed
from stickslip.cli.progress import Drawing
from stickslip.data import Measurement, Rig, bristle_remark, extrapolations
from stickslip.engine.simulation import refuse, simulate
from stickslip.engine.solver import FixedStep, Solver
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError
from stickslip.friction import PRINTED_FORMS, Friction, assigned, law_of
from stickslip.identify.fits import inside, with_inputs
from stickslip.identify.kinds import PAGE
from stickslip.show.display import Summary, require_library
from stickslip.show.documents import document, write_file, write_folder
from stickslip.show.report import RunReport, run_sections, versions
from stickslip.study import sweep

if TYPE_CHECKING:
    import pandas as pd


# ``stickslip animate``.

SIZE = re.compile(r"(\d+)\s*[x×]\s*(\d+)")


def run_animate(options: AnimateOptions) -> None:
    """Simulate, draw, show; a run that ends early is shown up to its end."""
    from stickslip.show.plots import animate, frame_rate, frame_times

    output, speed = options.output, options.speed
    size = _size(options.size)
    fps = frame_rate(output, options.fps)
    refuse_overwriting(output, output.parent, force=options.force)
    rig, chosen = inputs.rig_and_friction(options)
    law = chosen.law
    end = rig.t_end if options.t_end is None else options.t_end
    start = rig.start(law)
    seen = simulate(rig.mechanism, law, t_end=end, y0=start, throw=False)
    count = frame_times(seen, rig.mechanism, fps=fps, speed=speed).size
    output.parent.mkdir(parents=True, exist_ok=True)
    with Drawing() as progress:
        animate(
            seen,
            rig.mechanism,
            output,
            fps=fps,
            speed=speed,
            size=size,
            dpi=options.dpi,
            progress=progress,
        )
    if options.as_json:
        content = {
            **inputs.rig_content(rig, chosen),
            "status": seen.status.name,
            "meaning": seen.ending,
            "certified": seen.certificate.certified,
            "frames": int(count),
            "file": str(output),
        }
        print_json(document("animate", content))
        return
    inputs.show_heading(rig, f"{inputs.friction_title(chosen)} friction")
    lines = [seen.ending, *(f"Not certified: {why}" for why in seen.certificate.problems)]
    stdout().print("\n".join([*lines, "", f"Animation: {output}, {count} frames"]))


def _size(text: str) -> tuple[float, float]:
    match = SIZE.fullmatch(text.strip())
    if match is None:
        raise InputError(f"--size takes WIDTHxHEIGHT such as 880x400, got {text!r}.")
    return float(match[1]), float(match[2])


# ``stickslip simulate``.

CRITERIA_FAILED = 4
EVENT_CHECKS = ("guard_violation", "event_residual", "stick_drift")
"""Parts of a certificate that only a run with located events has."""
NO_ESTIMATES = (
    "--ensemble samples uncertain parameters, and neither this law nor the mechanism has any: give"
    " the law.toml of `stickslip select`, or of `stickslip fit -o law.toml`, as --law law.toml, or"
    ' state uncertainties, such as --set kinetic_coefficient="0.25 +- 0.01".'
)
MATLAB_NAME = 63
"""Characters of a name in MATLAB."""
MATLAB_HEADER = b"MATLAB 5.0 MAT-file, written by stickslip".ljust(116)
"""Text at the start of a MATLAB file."""


Chosen: TypeAlias = ChosenLaw | ChosenLaws | ChosenForm


def run(options: SimulateOptions) -> None:
    """Simulate, write the run, show; then draw the page."""
    output = options.output
    if output is not None:
        check_table(output)
        terminal.refuse_overwriting(output, output.parent, force=options.force)
    if options.report is not None:
        page = options.report / PAGE
        option = "--report-to FOLDER"
        terminal.refuse_overwriting(
            page, options.report, force=options.force, option=option, files=(PAGE,)
        )
    choose = rig_and_form if options.law in PRINTED_FORMS else rig_and_friction
    rig, chosen = choose(options)
    if output is not None:
        terminal.refuse_inputs(output, rig.files)
    about = _ran(rig, chosen, options)
    works = None
    if options.energy:
        times = about.run.sampled(options.samples).t
        works = sweep.energy_balance(about.rig.mechanism, about.run, times=times)
    if output is not None:
        table, units = _table(about, works, options.samples)
        write_file(output, table_bytes(table, output, units))
    if not options.as_json:
        terminal.show_sections(run_sections(about))
        terminal.show_summary(works.in_short() if works else Summary())
        if output is not None:
            terminal.stdout().print(f"\nWritten: {output}")
    page_code = 0
    if options.report is not None:
        kept = "The result of the run is not affected."
        write = partial(_write_page, options.report)
        page_code = terminal.draw_page(
            options.report, partial(_page, about), write, kept=kept, quiet=options.as_json
        )
    if options.as_json:
        content = _content(about, chosen, works)
        if options.report is not None:
            content["report"] = None if page_code else str(options.report / PAGE)
        terminal.print_json(document("simulate", content))
    refuse(about.run, certified=options.exact)
    if options.enforce and not (
        about.criteria.velocity_never_negative and about.criteria.displacement_never_decreases
    ):
        terminal.note("A criterion of the paper fails: the body moves backwards.")
        raise typer.Exit(CRITERIA_FAILED)
    terminal.leave_unless_drawn(page_code)


def _page(about: RunReport) -> str:
    from stickslip.show.report import run_page  # templates and figures, of a page alone

    return run_page(about)


def _write_page(folder: Path, text: str | None) -> None:
    write_folder(folder, {} if text is None else {PAGE: text}, stale=[PAGE])


def _ran(rig: Rig, chosen: Chosen, options: SimulateOptions) -> RunReport:
    """Make the run, and the ensemble if one was asked for."""
    mechanism, form = rig.mechanism, isinstance(chosen, ChosenForm)
    single = mechanisms.has_one_slip(mechanism) and not isinstance(chosen, ChosenLaws)
    if options.enforce and not single:
        names = ", ".join(contact.name for contact in mechanism.contacts())
        raise InputError(
            "--enforce takes a mechanism with one contact that slips along a coordinate, but"
            f" {mechanism.name} has {names}: leave it out."
        )
    _refuse_impossible(rig, chosen, options)
    friction = chosen.corrected if isinstance(chosen, ChosenForm) else chosen.law
    rig = rig if form else _told(rig, friction)
    source = chosen.source
    digests = {"the rig": rig.digest} | ({} if source is None else {"the law": source.digest})
    run = simulate(
        rig.mechanism,
        chosen.form if isinstance(chosen, ChosenForm) else friction,
        t_end=rig.t_end if options.t_end is None else options.t_end,
        y0=rig.start(friction),
        solver=_solver(options),
        # a page is drawn of a run that ended early, too
        throw=options.report is None and options.ensemble is None,
    )
    about = RunReport(
        rig=rig,
        law=chosen.form if isinstance(chosen, ChosenForm) else friction,
        run=run,
        estimates=chosen.estimates,
        remarks=chosen.remarks,
        law_file="" if source is None else source.path,
        band=_band(rig, chosen, options, run),
        fixed_step=options.fixed_step,
        commands=(terminal.command_line(),),
        versions=versions(),
        digests=digests,
    )
    if not isinstance(chosen, ChosenLaw) or not single:
        return about
    resting = bristle_remark(chosen.law, chosen.estimates, about.lengths, rig.mechanism)
    beyond = (*extrapolations(chosen.carried, rig.mechanism, run), *([resting] if resting else []))
    for remark in beyond:
        terminal.note(terminal.plain(remark))
    return replace(about, remarks=(*chosen.remarks, *beyond))


def _told(rig: Rig, friction: Friction) -> Rig:
    """Return a rig that tells its laws what only its first record has of contact inputs."""
    names = tuple(contact.name for contact in rig.mechanism.contacts())
    laws = assigned(names, friction)

    def lacking(mechanism: mechanisms.Mechanism) -> set[str]:
        return {
            name
            for contact in names
            for name in getattr(law_of(contact, laws), "inputs", ())
            if name not in mechanisms.input_names(mechanism, contact)
        }

    missing = lacking(rig.mechanism)
    if not missing or rig.measurement is None:
        return rig
    record = rig.measurement.records()[0]
    times = np.zeros(1) if record.time is None else np.asarray(record.time)
    informed = with_inputs(rig.mechanism, record, times)
    if lacking(informed):
        return rig
    for name in sorted(missing):
        terminal.note(f"The {name} of the run is that of {record.name or 'the first record'}.")
    return replace(rig, mechanism=informed)


def _refuse_impossible(rig: Rig, chosen: Chosen, options: SimulateOptions) -> None:
    if isinstance(chosen, ChosenForm):
        if options.fixed_step is None:
            raise InputError(
                f"{chosen.form.name} is an equation as printed, which has no exact solution: give a"
                " step in seconds, such as --fixed-step 0.001, or its corrected law as --law"
                f" {chosen.corrected.name}."
            )
        if options.report is not None or options.ensemble is not None:
            raise InputError(
                "--report and --ensemble take a friction law: with an equation as printed,"
                " leave them out, or write the run with -o run.csv."
            )
    if options.ensemble is not None and options.fixed_step is not None:
        raise InputError("--ensemble requires exact events: leave --fixed-step out.")
    if options.energy and options.fixed_step is not None:
        raise InputError("--energy requires exact events: leave --fixed-step out.")
    known = chosen.estimates is not None or rig.parameter_uncertainties
    if options.ensemble is not None and not known:
        raise InputError(NO_ESTIMATES)


def _band(rig: Rig, chosen: Chosen, options: SimulateOptions, run: Trajectory) -> sweep.Band | None:
    """Return the band of the ensemble; None if none was asked for, or the run ended early."""
    if options.ensemble is None or isinstance(chosen, ChosenForm):
        return None
    if not run.status.complete:
        terminal.note(
            "The ensemble was not simulated: the run with the best-fit values ended early."
        )
        return None
    friction = chosen.law
    with Drawing("Running") as progress:
        return sweep.band_of(
            rig.mechanism,
            friction,
            chosen.estimates,
            t_end=rig.t_end if options.t_end is None else options.t_end,
            parameter_uncertainties=rig.parameter_uncertainties,
            count=options.ensemble,
            seed=options.seed,
            times=run.sampled(options.samples).t,
            y0=rig.start(friction),
            progress=progress,
        )


def _without_fitted_start(rig: Rig) -> Measurement:
    """Return the records of a rig without initial states that fits estimate."""
    assert rig.measurement is not None
    kept = [
        replace(
            record,
            initial={
                name: value
                for name, value in record.initial.items()
                if name in inside(rig.mechanism, record)
            },
        )
        for record in rig.measurement.records()
    ]
    return replace(rig.measurement, trials=tuple(kept)) if rig.measurement.trials else kept[0]


def _table(
    about: RunReport, works: sweep.EnergyBalance | None, samples: int
) -> tuple["pd.DataFrame", dict[str, str]]:
    """Return the run at even times with units; with a band, its ends beside their columns."""
    sampled = about.run.sampled(samples)
    frame, band = sampled.to_dataframe(), about.band
    for name in () if band is None else band.states:
        assert band is not None
        low, median, high = band.at(name, sampled.t)
        frame[f"{name}_low"], frame[f"{name}_median"], frame[f"{name}_high"] = low, median, high
    units = _units(about, frame)
    if works is not None:
        added = works.to_dataframe().set_index("t").reindex(sampled.t).reset_index(drop=True)
        added = added.add_prefix("work ").rename(columns={"work energy": "energy"})
        frame, units = frame.join(added), units | dict.fromkeys(map(str, added), "J")
    return frame, units


def _solver(options: SimulateOptions) -> Solver | None:
    names = ("method", "stick_rule", "break_away", "zero_velocity_band")
    given: dict[str, Any] = {name: getattr(options, name) for name in names}
    if options.fixed_step is not None:
        known = {name: value for name, value in given.items() if value is not None}
        return FixedStep(dt=options.fixed_step, **known)
    for option in typed(options, *names):
        raise InputError(
            f"{option} is for --fixed-step: give a step as well, such as --fixed-step 0.001."
        )
    return None


def check_table(output: Path) -> None:
    """Refuse what is no table by its ending."""
    if output.suffix not in (".csv", ".parquet", ".mat"):
        raise InputError(f"--output takes a .csv, .parquet or .mat file, got {output}.")
    if output.suffix == ".parquet":
        require_library("pyarrow", "parquet", "write a .csv file")


def _units(about: RunReport, table: "pd.DataFrame") -> dict[str, str]:
    """Return the units of the columns of an export."""
    units = {"t": "s", **about.run.units}
    ends = ("_low", "_median", "_high")
    names = [str(name) for name in table]
    stems = {name: name.rpartition("_")[0] for name in names if name.endswith(ends)}
    return {name: units.get(stems.get(name, name), units.get(name, "")) for name in names}


def table_bytes(frame: "pd.DataFrame", output: Path, units: Mapping[str, str]) -> bytes:
    """Return a table as the file's kind asks for, with units; in CSV they stand in the header."""
    if output.suffix == ".csv":
        headers = {
            name: f"{name} [{unit}]" for name, unit in units.items() if unit not in ("", "1")
        }
        return frame.rename(columns=headers).to_csv(index=False).encode()
    if output.suffix == ".mat":
        return _mat_bytes(frame, units)
    buffer = io.BytesIO()
    frame.to_parquet(buffer, index=False)
    return buffer.getvalue()


def _mat_bytes(frame: "pd.DataFrame", units: Mapping[str, str]) -> bytes:
    """Return a table as a MATLAB file: a variable for each column, and their units in `units`."""
    from scipy.io import savemat

    names: dict[str, str] = {}
    for column in map(str, frame):
        name = re.sub(r"\W", "_", column, flags=re.ASCII)[:MATLAB_NAME]
        name = name if name[0].isalpha() else f"c{name}"[:MATLAB_NAME]
        while name in (*names.values(), "units"):
            name = f"{name[: MATLAB_NAME - 1]}_"
        names[column] = name
    content: dict[str, Any] = {
        name: frame[column].to_numpy()
        if frame[column].dtype.kind in "fiub"
        else frame[column].to_numpy(dtype=object)
        for column, name in names.items()
    }
    content["units"] = {name: units.get(column, "") for column, name in names.items()}
    buffer = io.BytesIO()
    savemat(buffer, content, long_field_names=True, oned_as="column")
    # its header has the time of writing, and equal runs would give different files
    return MATLAB_HEADER + buffer.getvalue()[len(MATLAB_HEADER) :]


def _content(about: RunReport, chosen: Chosen, works: sweep.EnergyBalance | None) -> dict[str, Any]:
    run = about.run
    ends = run.at(run.span)
    unchecked = () if about.fixed_step is None else EVENT_CHECKS
    content: dict[str, Any] = {
        **rig_content(about.rig, chosen),
        "status": run.status.name,
        "meaning": run.ending,
        "final": {name: float(ends[name][1]) for name in run.names},
        "events": [asdict(event) for event in run.events],
        "certificate": {
            **asdict(run.certificate),
            **dict.fromkeys(unchecked),
            "certified": run.certificate.certified,
        },
    }
    if about.remarks:
        content["remarks"] = list(map(terminal.plain, about.remarks))
    if works is not None:
        content["energy"] = works.to_dict()
    if about.cycles:
        content["cycles"] = [
            asdict(cycle) | {"mean_velocity": cycle.mean_velocity} for cycle in about.cycles
        ]
    if about.band is not None:
        content["band"] = about.band.to_dict()
    return content | ({"criteria": asdict(about.criteria)} if about.single else {})
