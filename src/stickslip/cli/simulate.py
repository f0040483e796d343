"""``stickslip simulate`` and ``stickslip animate``."""

import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer
from rich.text import Text

from stickslip import mechanisms
from stickslip.cli import console as terminal
from stickslip.cli import inputs
from stickslip.cli.console import print_json, refuse_overwriting, stdout
from stickslip.cli.inputs import (
    ChosenForm,
    ChosenLaw,
    ChosenLaws,
    friction_of,
    friction_title,
    rig_and_form,
    rig_and_friction,
    rig_content,
    show_heading,
)
from stickslip.cli.options import AnimateOptions, SimulateOptions
from stickslip.cli.progress import Drawing
from stickslip.data import Measurement, Rig, bristle_remark, extrapolations
from stickslip.engine.simulation import refuse, simulate
from stickslip.engine.solver import FixedStep, Solver
from stickslip.engine.trajectory import Event, Status, Trajectory
from stickslip.errors import InputError, StickslipError
from stickslip.friction import PRINTED_FORMS, Friction, assigned, law_of
from stickslip.identify import criteria_of
from stickslip.identify.fits import RecordSettings, inside, with_inputs
from stickslip.identify.kinds import PAGE, fit
from stickslip.show.display import require_library
from stickslip.show.documents import document, write_file, write_folder
from stickslip.show.formatting import Scale, fixed, number, quantity, residue, scale_of, within
from stickslip.study import sweep

if TYPE_CHECKING:
    import pandas as pd


# ``stickslip animate``.

SIZE = re.compile(r"(\d+)\s*[x×]\s*(\d+)")


def run_animate(options: AnimateOptions) -> None:
    """Simulate, draw, show; a run_animate that ends early is shown up to its end."""
    from stickslip.show.plots import animate, frame_rate, frame_times

    output, speed = options.output, options.speed
    size = _size(options.size)
    fps = frame_rate(output, options.fps)
    refuse_overwriting(output, output.parent, force=options.force)
    rig, chosen = inputs.rig_and_friction(options)
    law = inputs.friction_of(chosen)
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
        print_json(document("animate", _animation_content(rig, chosen, seen, int(count), output)))
    else:
        _show_animation(rig, inputs.friction_title(chosen), seen, int(count), output)


def _animation_content(
    rig: Rig,
    chosen: inputs.ChosenLaw | inputs.ChosenLaws,
    seen: Trajectory,
    count: int,
    output: Path,
) -> dict[str, Any]:
    return {
        **inputs.rig_content(rig, chosen),
        "status": seen.status.name,
        "meaning": seen.ending,
        "certified": seen.certificate.certified,
        "frames": count,
        "file": str(output),
    }


def _show_animation(rig: Rig, friction: str, seen: Trajectory, count: int, output: Path) -> None:
    console = stdout()
    console.print(Text.assemble((rig.heading, "bold"), f", {friction} friction"))
    console.print(seen.ending)
    for problem in seen.certificate.problems:
        console.print(f"Not certified: {problem}")
    console.print(f"\nAnimation: {output}, {count} frames")


def _size(text: str) -> tuple[float, float]:
    match = SIZE.fullmatch(text.strip())
    if match is None:
        raise InputError(f"--size takes WIDTHxHEIGHT such as 880x400, got {text!r}.")
    return float(match[1]), float(match[2])


# ``stickslip simulate``.

CRITERIA_FAILED = 4
DRAWS = 200
"""Draws with which measurements are compared where --ensemble gives no number."""
EVENT_CHECKS = ("guard_violation", "event_residual", "stick_drift")
"""Parts of a certificate that only a run with located events has."""
NO_ESTIMATES = (
    "--ensemble samples uncertain parameters, and neither this law nor the mechanism has any: give"
    " the law.toml of `stickslip select`, or of `stickslip fit -o law.toml`, as --law law.toml, or"
    ' state uncertainties, such as --set kinetic_coefficient="0.25 +- 0.01".'
)
MODES = {0: "stick", 1: "slip +", -1: "slip -", 2: "at stop +", -2: "at stop -", 3: "open"}
FIRST_EVENTS, LAST_EVENTS = 12, 4
"""Events of which the terminal shows the first and the last."""
MATLAB_NAME = 63
"""Characters of a name in MATLAB."""
MATLAB_HEADER = b"MATLAB 5.0 MAT-file, written by stickslip".ljust(116)
"""Text at the start of a MATLAB file."""
MOST_STATES = 12
"""Final states, and contacts, that the terminal shows."""


@dataclass(frozen=True, kw_only=True)
class Ran:
    """What was run, and what came of it."""

    rig: Rig
    """The rig that was simulated."""
    chosen: ChosenLaw | ChosenLaws | ChosenForm
    """The law, with its estimates; laws by contact where contacts have their own."""
    run: Trajectory
    """The trajectory."""
    band: sweep.Band | None
    """Where 95 % of the runs of an ensemble lie; None without an ensemble."""
    remarks: tuple[str, ...]
    """What does not carry over from where the law was fitted."""
    validation: sweep.Validation | None = None
    """What was measured on the rig beside the prediction; None if that cannot be compared."""
    refit: sweep.Refit | None = None
    """The law fitted to that, on request."""


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
    ran = _ran(rig, chosen, options)
    criteria = criteria_of(ran.run, rig.mechanism) if _has_criteria(ran) else None
    if output is not None:
        table = _table(ran, options.samples)
        write_file(output, table_bytes(table, output, _units(ran, table)))
    if not options.as_json:
        _show(ran, options)
        if output is not None:
            terminal.stdout().print(f"\nWritten: {output}")
    page_code = 0
    if options.report is not None:
        kept = "The result of the run is not affected."
        drawn = partial(_page, ran, options)
        write = partial(_write_page, options.report)
        page_code = terminal.draw_page(
            options.report, drawn, write, kept=kept, quiet=options.as_json
        )
    if options.as_json:
        content = _content(ran, options)
        content |= {} if criteria is None else {"criteria": asdict(criteria)}
        if options.report is not None:
            content["report"] = None if page_code else str(options.report / PAGE)
        terminal.print_json(document("simulate", content))
    refuse(ran.run, certified=options.exact)
    advances = criteria is None or (
        criteria.velocity_never_negative and criteria.displacement_never_decreases
    )
    if options.enforce and not advances:
        terminal.note("A criterion of the paper fails: the body moves backwards.")
        raise typer.Exit(CRITERIA_FAILED)
    terminal.leave_unless_drawn(page_code)


def _write_page(folder: Path, text: str | None) -> None:
    write_folder(folder, {} if text is None else {PAGE: text}, stale=[PAGE])


def _ran(rig: Rig, chosen: ChosenLaw | ChosenLaws | ChosenForm, options: SimulateOptions) -> Ran:
    """Make the run, in the way of what was chosen."""
    if isinstance(chosen, ChosenForm):
        return _ran_form(rig, chosen, options)
    if mechanisms.has_one_slip(rig.mechanism) and isinstance(chosen, ChosenLaw):
        return _ran_law(rig, chosen, options)
    return _ran_by_contact(rig, chosen, options)


def _has_criteria(ran: Ran) -> bool:
    """Whether one contact slips along a coordinate, so that the criteria of the paper apply."""
    return mechanisms.has_one_slip(ran.rig.mechanism) and not isinstance(ran.chosen, ChosenLaws)


def _ran_law(rig: Rig, chosen: ChosenLaw, options: SimulateOptions) -> Ran:
    """Make the run, the ensemble if one was asked for, and what was measured beside it."""
    _refuse_impossible(rig, chosen, options)
    rig = _told(rig, chosen.law)
    t_end = rig.t_end if options.t_end is None else options.t_end
    start = rig.start(chosen.law)
    wanted = options.report is None and options.ensemble is None
    run = simulate(
        rig.mechanism,
        chosen.law,
        t_end=t_end,
        y0=start,
        solver=_solver(options),
        throw=wanted,  # a page is drawn of a run that ended early, too
    )
    band = _band(rig, chosen, options, run, t_end=t_end)
    lengths = _lengths(rig.mechanism, run)
    resting = bristle_remark(chosen.law, chosen.estimates, lengths, rig.mechanism)
    beyond = (*extrapolations(chosen.carried, rig.mechanism, run), *([resting] if resting else []))
    for remark in beyond:
        terminal.note(terminal.plain(remark))
    return Ran(
        rig=rig,
        chosen=chosen,
        run=run,
        band=band,
        remarks=(*chosen.remarks, *beyond),
        validation=_validated(rig, chosen, options),
        refit=_refitted(rig, chosen) if options.refit else None,
    )


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


def _ran_form(rig: Rig, chosen: ChosenForm, options: SimulateOptions) -> Ran:
    """Make the run of an equation as printed, which only fixed steps do."""
    if options.fixed_step is None:
        raise InputError(
            f"{chosen.form.name} is an equation as printed, which has no exact solution: give a"
            f" step in seconds, such as --fixed-step 0.001, or its corrected law as --law"
            f" {chosen.corrected.name}."
        )
    if options.report is not None or options.ensemble is not None or options.refit:
        raise InputError(
            "--report, --ensemble and --refit take a friction law: with an equation as printed,"
            " leave them out, or write the run with -o run.csv."
        )
    run = simulate(
        rig.mechanism,
        chosen.form,
        t_end=rig.t_end if options.t_end is None else options.t_end,
        y0=rig.start(chosen.corrected),
        solver=_solver(options),
    )
    return Ran(rig=rig, chosen=chosen, run=run, band=None, remarks=())


def _refuse_impossible(rig: Rig, chosen: ChosenLaw | ChosenLaws, options: SimulateOptions) -> None:
    if options.ensemble is not None and options.fixed_step is not None:
        raise InputError("--ensemble requires exact events: leave --fixed-step out.")
    if options.refit and options.fixed_step is not None:
        raise InputError("--refit requires exact events: leave --fixed-step out.")
    known = chosen.estimates is not None or rig.parameter_uncertainties
    if options.ensemble is not None and not known:
        raise InputError(NO_ESTIMATES)
    if options.refit and (rig.measurement is None or isinstance(chosen, ChosenLaws)):
        lacks = "nothing was measured" if rig.measurement is None else "it has several contacts"
        raise InputError(
            f"--refit fits the law to what was measured on {rig.path or rig.heading}, but {lacks}:"
            " leave it out."
        )


def _validated(rig: Rig, chosen: ChosenLaw, options: SimulateOptions) -> sweep.Validation | None:
    """Return what was measured beside the prediction; None, with a note, if that cannot be."""
    if rig.measurement is None:
        return None
    try:
        if options.fixed_step is not None:
            raise InputError("that requires exact events, and --fixed-step locates none.")
        return sweep.validate(
            rig.mechanism,
            chosen.law,
            rig.measurement,
            chosen.estimates,
            t_end=rig.t_end,
            count=options.ensemble or DRAWS,
            seed=options.seed,
        )
    except StickslipError as error:
        terminal.note(
            terminal.plain(f"The prediction was not compared with what was measured: {error}")
        )
        return None


def _refitted(rig: Rig, chosen: ChosenLaw) -> sweep.Refit:
    """Fit what is known of the law with an interval, or all of it, to what was measured."""
    assert rig.measurement is not None
    known = chosen.estimates
    vary = [f"friction.{name}" for name in known.intervals] if known else None
    records = any(record.time is not None for record in rig.measurement.records())
    measurement = _without_fitted_start(rig) if records else rig.measurement
    with Drawing("Refitting"):
        found = fit(
            rig.mechanism,
            chosen.law,
            measurement,
            vary=vary or None,
            settings=RecordSettings(hold=rig.hold) if records else None,
            t_end=None if records else rig.t_end,
        )
    return sweep.Refit(fit=found, parameters=sweep.compare_estimates(chosen.law, known, found))


def _band(
    rig: Rig,
    chosen: ChosenLaw | ChosenLaws,
    options: SimulateOptions,
    run: Trajectory,
    *,
    t_end: float,
) -> sweep.Band | None:
    """Return the band of the ensemble; None if none was asked for, or the run ended early."""
    known = chosen.estimates
    if options.ensemble is None:
        return None
    if not run.status.complete:
        terminal.note(
            "The ensemble was not simulated: the run with the best-fit values ended early."
        )
        return None
    friction = friction_of(chosen)
    with Drawing("Running") as progress:
        return sweep.band_of(
            rig.mechanism,
            friction,
            known,
            t_end=t_end,
            parameter_uncertainties=rig.parameter_uncertainties,
            count=options.ensemble,
            seed=options.seed,
            times=run.sampled(options.samples).t,
            y0=rig.start(friction),
            progress=progress,
        )


def _ran_by_contact(rig: Rig, chosen: ChosenLaw | ChosenLaws, options: SimulateOptions) -> Ran:
    """Make a run of a mechanism with several contacts, or with one that slips by a factor."""
    names = ", ".join(contact.name for contact in rig.mechanism.contacts())
    if options.enforce:
        raise InputError(
            "--enforce takes a mechanism with one contact that slips along a coordinate, but"
            f" {rig.mechanism.name} has {names}: leave it out."
        )
    _refuse_impossible(rig, chosen, options)
    if rig.measurement is not None:
        terminal.note(
            "The prediction was not compared with what was measured: that takes one contact."
        )
    friction = friction_of(chosen)
    rig = _told(rig, friction)
    t_end = rig.t_end if options.t_end is None else options.t_end
    run = simulate(
        rig.mechanism,
        friction,
        t_end=t_end,
        y0=rig.start(friction),
        solver=_solver(options),
        throw=options.report is None and options.ensemble is None,
    )
    band = _band(rig, chosen, options, run, t_end=t_end)
    return Ran(rig=rig, chosen=chosen, run=run, band=band, remarks=chosen.remarks)


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


def _lengths(mechanism: mechanisms.Mechanism, run: Trajectory) -> dict[str, float]:
    """Return what the headline and the tiles of a run say of its motion, by what it is called."""
    if cycles := _cycles(mechanism, run):
        return {
            "travel in a cycle": cycles[-1].advance,
            "back-slip in a cycle": cycles[-1].back_slip,
        }
    seen = criteria_of(run, mechanism)
    return {"travel": seen.travel, "largest back-slip": seen.largest_return}


def _cycles(mechanism: mechanisms.Mechanism, run: Trajectory) -> tuple[sweep.DrivenCycle, ...]:
    """Return the whole cycles of a run, none where the drives do not repeat themselves."""
    period = None if not mechanisms.has_one_slip(mechanism) else mechanisms.cycle_or_none(mechanism)
    return () if period is None else sweep.cycles_in(run, mechanism, period)


def _table(ran: Ran, samples: int) -> "pd.DataFrame":
    """Return the run at even times; with a band, its ends beside the columns they are of."""
    sampled = ran.run.sampled(samples)
    frame = sampled.to_dataframe()
    if ran.band is not None:
        for name in ran.band.states:
            low, median, high = ran.band.at(name, sampled.t)
            frame[f"{name}_low"], frame[f"{name}_median"], frame[f"{name}_high"] = low, median, high
    return frame


def _page(ran: Ran, options: SimulateOptions) -> str:
    """Return the page of a run."""
    from stickslip.show.report import ContactsReport, RunReport, contacts_page, run_page, versions

    assert not isinstance(ran.chosen, ChosenForm)  # refused before the run
    source = ran.chosen.source
    digests = {"the rig": ran.rig.digest}
    digests |= {} if source is None else {"the law": source.digest}
    if isinstance(ran.chosen, ChosenLaws) or not mechanisms.has_one_slip(ran.rig.mechanism):
        return contacts_page(
            ContactsReport(
                rig=ran.rig,
                friction=friction_of(ran.chosen),
                run=ran.run,
                estimates=ran.chosen.estimates,
                band=ran.band,
                commands=(terminal.command_line(),),
                versions=versions(),
                digests=digests,
            )
        )
    return run_page(
        RunReport(
            rig=ran.rig,
            law=ran.chosen.law,
            run=ran.run,
            estimates=ran.chosen.estimates,
            remarks=ran.remarks,
            law_file="" if source is None else source.path,
            band=ran.band,
            validation=ran.validation,
            refit=() if ran.refit is None else ran.refit.sentences(ran.validation),
            fixed_step=options.fixed_step,
            commands=(terminal.command_line(),),
            versions=versions(),
            digests=digests,
        )
    )


def _solver(options: SimulateOptions) -> Solver | None:
    if options.fixed_step is None:
        given = {
            "--method": options.method is not None,
            "--stick-rule": options.stick_rule is True,
            "--no-stick-rule": options.stick_rule is False,
            "--break-away": options.break_away is not None,
            "--zero-velocity-band": options.zero_velocity_band != 0.0,
        }
        for option in (option for option, is_given in given.items() if is_given):
            raise InputError(
                f"{option} is for --fixed-step: give a step as well, such as --fixed-step 0.001."
            )
        return None
    return FixedStep(
        dt=options.fixed_step,
        method=options.method or "euler",  # type: ignore[arg-type]  # checked by FixedStep itself
        stick_rule=options.stick_rule,
        break_away=options.break_away,  # type: ignore[arg-type]
        zero_velocity_band=options.zero_velocity_band,
    )


def check_table(output: Path) -> None:
    """Refuse what is no table by its ending."""
    if output.suffix not in (".csv", ".parquet", ".mat"):
        raise InputError(f"--output takes a .csv, .parquet or .mat file, got {output}.")
    if output.suffix == ".parquet":
        require_library("pyarrow", "parquet", "write a .csv file")


def _units(ran: Ran, table: "pd.DataFrame") -> dict[str, str]:
    """Return the units of the columns of an export."""
    units = {"t": "s", **ran.run.units}
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


def _content(ran: Ran, options: SimulateOptions) -> dict[str, Any]:
    run = ran.run
    ends = run.at(run.span)
    unchecked = () if options.exact else EVENT_CHECKS
    content: dict[str, Any] = {
        **rig_content(ran.rig, ran.chosen),
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
    if ran.remarks:
        content["remarks"] = list(map(terminal.plain, ran.remarks))
    cycles = _cycles(ran.rig.mechanism, run)
    if cycles:
        content["cycles"] = [
            asdict(cycle) | {"mean_velocity": cycle.mean_velocity} for cycle in cycles
        ]
    if ran.band is not None:
        content["band"] = ran.band.to_dict()
    if ran.validation is not None:
        content["validation"] = ran.validation.to_dict()
    if ran.refit is not None:
        content["refit"] = ran.refit.to_dict()
    return content


def _show(ran: Ran, options: SimulateOptions) -> None:
    console, run = terminal.stdout(), ran.run
    form = isinstance(ran.chosen, ChosenForm)  # its title says what it is an equation of
    show_heading(ran.rig, friction_title(ran.chosen) + ("" if form else " friction"))
    console.print(f"{run.ending}{_still_moving(ran)}")
    if run.events:
        contact = ["contact"] if run.contacts else []
        terminal.show_table("", ["t, s", *contact, "event", "from", "to"], _event_rows(run.events))
    ends = run.at(run.span)
    shown = run.names[: 2 * len(ran.rig.mechanism.coordinates)] if run.contacts else run.names[:2]
    left = len(shown) - MOST_STATES
    final = ", ".join(
        f"{name} = {number(ends[name][1] + 0.0, 6)} {run.units[name]}"
        for name in shown[:MOST_STATES]
    )
    final += f", and {left} further states; --json lists all" if left > 0 else ""
    console.print(f"At {number(run.span[1], 6)} s: {final}{_cycles_lines(ran)}")
    work_by_contact = list(run.certificate.work.items())
    for name, work in work_by_contact[:MOST_STATES]:
        held = run.contact(name).stick_time()
        console.print(
            f"{f'{name}: sticks' if name else 'It sticks'} for {number(held, 4)} s,"
            f" {number(work, 4)} J taken by friction"
        )
    if len(work_by_contact) > MOST_STATES:
        more = len(work_by_contact) - MOST_STATES
        console.print(f"{more} further contacts; --json lists all")
    trust = run.certificate
    checked = f"Energy mismatch {residue(trust.energy_error)}, "
    if options.exact:
        checked += f"guard violation {residue(trust.guard_violation)}, "
        checked += f"stick drift {residue(trust.stick_drift)}, "
    console.print(f"{checked}{trust.steps} steps")
    for warning in trust.warnings:
        console.print(f"Warning: {warning}")
    for problem in trust.problems:
        console.print(f"Not certified: {problem}")
    if ran.band is not None:
        _show_band(ran.band)
    if ran.validation is not None:
        _show_validation(ran.validation)
    if ran.refit is not None:
        console.print("\nRefitted to this measurement", style="bold")
        for line in ran.refit.sentences(ran.validation):
            console.print(f"  {line}")


def _still_moving(ran: Ran) -> str:
    """Return that what a printed equation was to bring to rest moves at the end; else nothing."""
    run, mechanism = ran.run, ran.rig.mechanism
    if not isinstance(ran.chosen, ChosenForm) or run.status is not Status.END_TIME:
        return ""
    rate = mechanism.rates[mechanism.coordinates.index(mechanisms.slip_of(mechanism))]
    speed = float(run[rate][-1])
    if speed == 0.0:
        return ""
    return f" The body still moves then, at {quantity(speed, run.units[rate], 3)}."


def _cycles_lines(ran: Ran) -> str:
    """Return what moves in a cycle of the drives, and how fast on average, a line each."""
    mechanism = ran.rig.mechanism
    period = mechanisms.cycle_or_none(mechanism)
    if period is None:
        return ""
    names = [name for name in mechanisms.slipping(mechanism) if name not in mechanism.guided()]
    names = names[:MOST_STATES]
    return "".join(_cycles_line(ran, period, name, alone=len(names) == 1) for name in names)


def _cycles_line(ran: Ran, period: float, name: str, *, alone: bool) -> str:
    cycles = sweep.cycles_in(ran.run, ran.rig.mechanism, period, coordinate=name)
    if not cycles:
        return ""
    cycle, unit = cycles[-1], ran.run.units[name]
    settled = len(cycles) > 1 and cycle.repeats(cycles[-2])
    which = "the only cycle" if len(cycles) == 1 else f"the last of {len(cycles)} cycles"
    when = " per cycle, once the motion has settled" if settled else f" in {which}"
    of = "" if alone else f" of {name}"
    mean = quantity(cycle.advance / cycle.period, f"{unit}/s", 4)
    return (
        f"\nTravel{of}{when}: {quantity(cycle.advance, unit, 3)}; mean velocity {mean}, back-slip"
        f" {quantity(cycle.back_slip, unit, 3)}"
    )


def _show_validation(seen: sweep.Validation) -> None:
    """Print what was measured beside the prediction, and what to think of it."""
    console = terminal.stdout()
    console.print("\nPrediction and measurement", style="bold")
    if seen.travels:
        rows = [
            [travel.name, travel.quantity.replace("_", " "), *travel.cells()]
            for travel in seen.travels
        ]
        terminal.show_table(
            "", ["trial", "", "measured", "predicted", "95 % band", "meets it"], rows
        )
    for line in seen.sentences():
        console.print(line)


def _event_rows(events: Sequence[Event]) -> list[list[str]]:
    """Return the first events and the last, and how many are left out between them."""
    rows = [
        [
            fixed(event.t, 6),
            *([event.contact] if event.contact else []),
            event.reason,
            MODES[event.from_mode],
            MODES[event.to_mode],
        ]
        for event in events
    ]
    left = len(rows) - FIRST_EVENTS - LAST_EVENTS
    if left < 2:  # a row that says so would take the place of the only one it leaves out
        return rows
    gap = ["", f"… {left:,} further events; --json lists all", *[""] * (len(rows[0]) - 2)]
    return [*rows[:FIRST_EVENTS], gap, *rows[-LAST_EVENTS:]]


def _show_band(band: sweep.Band) -> None:
    """Print the spread of the motion over draws of the parameters of the law, or of the laws."""
    rows = []
    for name, travel in list(band.travels.items())[:MOST_STATES]:
        unit, of = band.units[name], f" of {name}" if len(band.travels) > 1 else ""
        cycles = band.travels_by_cycle[name]
        rows.append([f"travel{of}", *_cells(travel, unit)])
        rows += [
            [f"cycle {k + 1}{of}", *_cells(spread, unit)]
            for k, spread in enumerate(cycles)
            if k in (0, len(cycles) - 1)
        ]
        rows.append([f"mean velocity{of}", *_cells(band.mean_velocities[name], f"{unit}/s")])
    terminal.stdout().print()
    title = f"{band.count} runs with samples of {', '.join(band.draws)}, seed {band.seed}"
    terminal.show_table(title, ["", "median", "95 % of the runs", "unit"], rows)
    for reason in band.reasons:
        terminal.stdout().print(reason)


def _cells(spread: sweep.Spread, unit: str) -> list[str]:
    factor, unit = scale_of([spread.median, spread.low, spread.high], unit)
    median, low, high = (factor * value for value in (spread.median, spread.low, spread.high))
    return [within(median, low, high), Scale(factor, "").interval(spread.low, spread.high), unit]
