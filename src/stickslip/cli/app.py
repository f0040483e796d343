"""The commands and their options."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from stickslip.cli.options import (
    AllowImport,
    Columns,
    Conditions,
    Data,
    Enforce,
    FittedLaw,
    Fixed,
    Folder,
    Force,
    FormerFree,
    FormerUnknown,
    Gain,
    Hold,
    Horizon,
    Jobs,
    Json,
    Law,
    LawFile,
    LawLoad,
    Laws,
    PlannedLaws,
    Purpose,
    Repair,
    Rig,
    Route,
    Seed,
    Segment,
    Set,
    Starts,
    Units,
    Validate,
    Vary,
)
from stickslip.cli.subcommands import data, profile

if TYPE_CHECKING:
    from stickslip.identification import RouteName
    from stickslip.selection import PurposeName

__all__ = ["app"]

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Which friction model fits a mechanism, with which parameters, and how surely.",
    epilog="Exit codes: 0 done, 1 page not drawn, 2 bad input or data, 3 no convergence or no law"
    " fits, 4 criteria failed, 130 cancelled.",
)


def _version(wanted: bool) -> None:
    if wanted:
        from stickslip import __version__

        print(f"stickslip {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Which friction model fits a mechanism, with which parameters, and how surely."""


@app.command()
def select(
    rig: Rig = None,
    data: Data = None,
    columns: Columns = None,
    units: Units = None,
    gain: Gain = None,
    repair: Repair = None,
    conditions: Conditions = None,
    changes: Set = None,
    allow_import: AllowImport = False,
    laws: Laws = None,
    validate: Validate = None,
    vary: Vary = None,
    fixed: Fixed = None,
    _unknown: FormerUnknown = None,
    purpose: Purpose = None,
    horizon: Horizon = None,
    route: Route = None,
    segment: Segment = None,
    hold: Hold = None,
    starts: Starts = None,
    seed: Seed = None,
    jobs: Jobs = None,
    output: Folder = Path("stickslip-report"),
    force: Force = False,
    as_json: Json = False,
    enforce: Enforce = False,
) -> None:
    """Fit every law to what was measured, compare them, write a report.

    Ctrl-C while laws are fitted to a record: once ends with the best so far, twice cancels.
    """
    from stickslip.cli.file_options import reading_of
    from stickslip.cli.inputs import CommandInputs, FitOptions
    from stickslip.cli.select import run

    reading = reading_of(
        columns=columns, units=units, gain=gain, repair=repair, conditions=conditions
    )
    fitted = partial(FitOptions, segment=segment, hold=hold, starts=starts, seed=seed)
    how = fitted(
        purpose=cast("PurposeName | None", purpose),  # names are checked where they are used
        horizon=horizon,
        route=cast("RouteName | None", route),
    )
    asked = CommandInputs(
        data=data or [],
        reading=reading,
        validate=validate,
        vary=vary or [],
        fixed=fixed or [],
        how=how,
    )
    start = partial(run, allow_import=allow_import, force=force, as_json=as_json, enforce=enforce)
    start(rig, asked, changes or [], laws, output, jobs=jobs)


@app.command()
def fit(
    rig: Rig = None,
    law: FittedLaw = None,
    _free: FormerFree = None,
    data: Data = None,
    columns: Columns = None,
    units: Units = None,
    gain: Gain = None,
    repair: Repair = None,
    conditions: Conditions = None,
    changes: Set = None,
    allow_import: AllowImport = False,
    validate: Validate = None,
    vary: Vary = None,
    fixed: Fixed = None,
    _unknown: FormerUnknown = None,
    horizon: Horizon = None,
    route: Route = None,
    segment: Segment = None,
    hold: Hold = None,
    starts: Starts = None,
    seed: Seed = None,
    output: LawFile = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Fit one law to what was measured; print its parameters with their intervals.

    Ctrl-C while a record is fitted: once ends with the best so far, twice cancels.
    """
    from stickslip.cli.file_options import reading_of
    from stickslip.cli.fit import run
    from stickslip.cli.inputs import CommandInputs, FitOptions

    reading = reading_of(
        columns=columns, units=units, gain=gain, repair=repair, conditions=conditions
    )
    how = FitOptions(
        horizon=horizon,
        route=cast("RouteName | None", route),
        segment=segment,
        hold=hold,
        starts=starts,
        seed=seed,
    )
    asked = CommandInputs(
        data=data or [],
        reading=reading,
        validate=validate,
        vary=vary or [],
        fixed=fixed or [],
        how=how,
    )
    start = partial(run, allow_import=allow_import, force=force, as_json=as_json)
    start(rig, law, asked, changes or [], output)


@app.command()
def check(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE",
            help="CSV, Parquet or MATLAB files, of which several are trials; with or instead of"
            " these a rig file (TOML), whose mechanism tells more and whose [data] is read.",
        ),
    ],
    columns: Columns = None,
    units: Units = None,
    gain: Gain = None,
    repair: Repair = None,
    conditions: Conditions = None,
    allow_import: AllowImport = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder for a picture and the findings.")
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Say what a measurement can tell and what is wrong with it; exit with 2 at an error."""
    from stickslip.cli.check import run
    from stickslip.cli.file_options import reading_of

    reading = reading_of(
        columns=columns, units=units, gain=gain, repair=repair, conditions=conditions
    )
    run(files, reading, output, allow_import=allow_import, force=force, as_json=as_json)


@app.command()
def simulate(
    rig: Rig = None,
    law: Law = None,
    law_load: LawLoad = None,
    changes: Set = None,
    allow_import: AllowImport = False,
    t_end: Annotated[
        float | None, typer.Option("--t-end", help="Last time [s]; the rig's if not given.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Export to this CSV or Parquet file.")
    ] = None,
    samples: Annotated[
        int, typer.Option("--samples", min=2, help="Evenly spaced rows of the export.")
    ] = 1001,
    fixed_step: Annotated[
        float | None,
        typer.Option(
            "--fixed-step",
            help="Simulate in fixed steps of this size [s], as a block diagram does.",
        ),
    ] = None,
    method: Annotated[
        str, typer.Option("--method", help="Integrator of the fixed step: euler, heun or rk4.")
    ] = "euler",
    no_stick_rule: Annotated[
        bool,
        typer.Option(
            "--no-stick-rule", help="Fixed step: without the rule that holds the body at rest."
        ),
    ] = False,
    ensemble: Annotated[
        int | None,
        typer.Option(
            "--ensemble",
            metavar="N",
            min=2,
            help="Also simulate N draws of the law's parameters from the estimates in its file.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Random seed of these draws.")] = 0,
    report: Annotated[
        bool, typer.Option("--report", help="Write a report of the run, stickslip-run/index.html.")
    ] = False,
    report_to: Annotated[
        Path | None,
        typer.Option(
            "--report-to", metavar="FOLDER", help="Write the report into this folder instead."
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
    enforce: Enforce = False,
) -> None:
    """Simulate the rig with one law; show events and certificate, export the run, write a report.

    With a fitted law from a file, --ensemble draws its parameters from their estimates and shows
    the 95 % band of the motion.
    """
    from stickslip.cli.law_choice import LawAsked
    from stickslip.cli.simulate import Settings, run

    folder = report_to if report_to is not None else Path("stickslip-run") if report else None
    settings = Settings(
        law=LawAsked(law=law, load=law_load),
        t_end=t_end,
        samples=samples,
        fixed_step=fixed_step,
        method=method,
        stick_rule=not no_stick_rule,
        ensemble=ensemble,
        seed=seed,
        report=folder,
    )
    start = partial(run, allow_import=allow_import, force=force, as_json=as_json, enforce=enforce)
    start(rig, changes or [], settings, output)


@app.command()
def animate(
    rig: Rig = None,
    law: Law = None,
    law_load: LawLoad = None,
    changes: Set = None,
    allow_import: AllowImport = False,
    t_end: Annotated[
        float | None, typer.Option("--t-end", help="Last time [s]; the rig's if not given.")
    ] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="GIF or MP4 file; MP4 needs ffmpeg.")
    ] = Path("stickslip.gif"),
    fps: Annotated[float, typer.Option("--fps", help="Frames a second.")] = 25.0,
    speed: Annotated[
        float, typer.Option("--speed", help="Times as fast as it is; 0.1 is slow motion.")
    ] = 1.0,
    size: Annotated[
        str, typer.Option("--size", metavar="WIDTHxHEIGHT", help="In CSS pixels.")
    ] = "880x400",
    dpi: Annotated[
        float, typer.Option("--dpi", help="Resolution; 72 is a pixel for each CSS pixel.")
    ] = 72.0,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Simulate the rig with one law and draw what moves, to scale, beside its time plots."""
    from stickslip.cli.animate import AnimationStyle, run
    from stickslip.cli.law_choice import LawAsked

    look = AnimationStyle(fps=fps, speed=speed, size=size, dpi=dpi)
    start = partial(run, allow_import=allow_import, force=force, as_json=as_json)
    start(rig, changes or [], LawAsked(law=law, load=law_load), t_end, look, output)


@app.command()
def sweep(
    rig: Rig = None,
    law: Law = None,
    law_load: LawLoad = None,
    changes: Set = None,
    allow_import: AllowImport = False,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="PATH=LOW:HIGH:N",
            help="E.g. mechanism.drive.drive.frequency=1:6:50; once or twice.",
        ),
    ] = None,
    cycles: Annotated[
        int, typer.Option("--cycles", help="Cycles the mean is taken over; even.")
    ] = 20,
    settle: Annotated[int, typer.Option("--settle", help="Cycles before them.")] = 100,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="CSV or Parquet file; a figure (SVG) beside it.")
    ] = Path("stickslip-sweep.csv"),
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Mean velocity of a driven rig over a grid of parameters: a table and a figure."""
    from stickslip.cli.law_choice import LawAsked
    from stickslip.cli.sweep import run

    start = partial(run, allow_import=allow_import, force=force, as_json=as_json)
    asked = LawAsked(law=law, load=law_load)
    start(rig, changes or [], asked, vary or [], cycles, settle, output)


@app.command()
def plan(
    rig: Rig = None,
    laws: PlannedLaws = None,
    changes: Set = None,
    allow_import: AllowImport = False,
    between: Annotated[
        str | None,
        typer.Option(
            "--between",
            metavar="LOW..HIGH",
            help="Settings that the rig can take, e.g. 40mm..100mm; if not given, those of the"
            " trials and the rig file, or 0.4 of what the rig file sets to all of it.",
        ),
    ] = None,
    settings: Annotated[int, typer.Option("--settings", help="How many, from 2 to 12.")] = 4,
    uncertainty: Annotated[
        str | None,
        typer.Option(
            "--uncertainty",
            help="Standard uncertainty of one travel, scatter and reading together, e.g. 2mm; if"
            " not given, that of the rig's trials, or else 2 % of the longest travel.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="Sheet to print (HTML); its table as CSV beside it, to fill in."
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Plan travels: what to measure, how often and how well, and which laws that tells apart."""
    from stickslip.cli.plan import run

    start = partial(run, allow_import=allow_import, force=force, as_json=as_json)
    start(rig, changes or [], laws, between, settings, uncertainty, output)


@app.command()
def models(
    name: Annotated[str | None, typer.Argument(help="Show one law in full.")] = None,
    published: Annotated[
        bool, typer.Option("--published", help="The equations of the source paper as printed.")
    ] = False,
    as_json: Json = False,
) -> None:
    """List the friction laws, or show one: formula, parameters, sources."""
    from stickslip.cli.models import run

    run(name, published=published, as_json=as_json)


@app.command()
def paper(
    output: Folder = Path("stickslip-paper"),
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Recompute every table and figure of the source paper, beside what was printed."""
    from stickslip.cli.paper import run

    run(output, force=force, as_json=as_json)


@app.command()
def warmup(
    rig: Annotated[
        Path | None, typer.Option("--rig", help="Only the mechanism and laws of this rig file.")
    ] = None,
    mechanisms: Annotated[
        list[str] | None,
        typer.Option("--mechanism", help="Only this one, e.g. spring-block; may be repeated."),
    ] = None,
    laws: Laws = None,
    allow_import: AllowImport = False,
    jobs: Annotated[
        int | None, typer.Option("--jobs", min=1, help="Processes; one a core if not given.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Compile equations ahead of time, for container images and continuous integration.

    Every mechanism with its defaults, without and with a drive, is compiled with every law with its
    defaults, for single runs and for ensembles; or the mechanism of a rig file with its laws. Other
    values of parameters need no compiling. What is there already is left alone.
    """
    from stickslip.cli.warmup import run

    run(rig, mechanisms or [], laws, allow_import=allow_import, jobs=jobs, as_json=as_json)


@app.command()
def schema() -> None:
    """Print the JSON schema of rig files."""
    from stickslip.cli.schema import run

    run()


@app.command()
def cite(
    laws: Annotated[
        list[str] | None, typer.Argument(help="Laws whose sources to print; all if none.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Print how to cite stickslip and the sources of friction laws."""
    from stickslip.cli.cite import run

    run(laws or [], as_json=as_json)


app.add_typer(data, name="data")
app.add_typer(profile, name="profile")
