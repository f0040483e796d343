"""The commands and their options."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from stickslip.cli.help import CONTEXT, Panels, command
from stickslip.cli.options import (
    DEMO,
    AllowImport,
    AnimationOptions,
    ApplyOptions,
    Columns,
    Data,
    Draws,
    DrawSeed,
    EndTime,
    Enforce,
    EstimationOptions,
    ExecutorAt,
    ExportOptions,
    FittedLaw,
    Folder,
    Force,
    Gain,
    Json,
    LawFile,
    LawOptions,
    Laws,
    MotorConstant,
    ParameterOptions,
    PlannedLaws,
    ProfileOptions,
    ReadingOptions,
    Record,
    Rig,
    RunOptions,
    Set,
    Units,
    Workers,
)
from stickslip.errors import InputError

app = typer.Typer(
    cls=Panels,
    context_settings=dict(CONTEXT),
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Select a friction model for a mechanism from measurements, with parameters and"
    " uncertainties.",
    epilog="Exit codes: 0 success; 1 report not drawn; 2 invalid input or data; 3 no convergence,"
    " or no law fits; 4 criteria failed; 130 cancelled. Folders of files to write are made where"
    " they do not exist.",
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
    """Select a friction model for a mechanism from measurements, with uncertainties."""


@command(app, "select")
def select(
    *,
    rig: Rig = None,
    data: Data = None,
    reading: ReadingOptions,
    changes: Set = None,
    allow_import: AllowImport = False,
    laws: Laws = None,
    parameters: ParameterOptions,
    estimation: EstimationOptions,
    count: Workers = None,
    executor: ExecutorAt = None,
    output: Folder = None,
    force: Force = False,
    as_json: Json = False,
    enforce: Enforce = False,
) -> None:
    """Compare friction laws on a measurement; write a report.

    The verdict names a law and its parameters, gives a 95 % band that holds whichever law does,
    and says what to measure next.

    While laws are fitted to records of several joints, press Ctrl-C once to stop with the best fit
    so far, twice to cancel.
    """
    from stickslip.cli.inputs import measured, reading_of
    from stickslip.cli.judge import run_select

    ask = partial(measured, data=data or [], reading=reading_of(reading))
    ask = partial(ask, parameters=parameters, estimation=estimation)
    start = partial(
        run_select, allow_import=allow_import, force=force, as_json=as_json, enforce=enforce
    )
    start(rig, ask, changes or [], laws, output, count=count, executor=executor)


@command(app, "demo")
def demo(
    laws: Laws = None,
    count: Workers = None,
    executor: ExecutorAt = None,
    output: Folder = None,
    force: Force = False,
    as_json: Json = False,
    enforce: Enforce = False,
) -> None:
    """Select a law for the rig that comes with the package; write a report.

    The rig is that of the source paper, a block that a spring pushes, with one measured travel.
    Other commands take it as `demo`, such as `stickslip simulate demo`.
    """
    from stickslip.cli.inputs import measured, reading_of
    from stickslip.cli.judge import run_select

    reading = reading_of(ReadingOptions())
    start = partial(run_select, allow_import=False, force=force, as_json=as_json, enforce=enforce)
    start(
        None, partial(measured, reading=reading), [], laws, output, count=count, executor=executor
    )


@command(app, "init")
def init(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE...",
            help="Record (CSV, Excel, Parquet, MATLAB, MDF, TDMS, MCAP, ROS bag); or films of one"
            " body, a run each.",
        ),
    ],
    urdf: Annotated[
        Path | None,
        typer.Option(
            "--urdf", metavar="FILE", help="Description of the robot whose joints were recorded."
        ),
    ] = None,
    columns: Columns = None,
    units: Units = None,
    gain: Gain = None,
    motor_constant: MotorConstant = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="Rig file to write; default: FILE with the ending .toml."
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Detect the contents of a data file; write a rig file.

    Detects code page, separators, decimal comma, lines above the header, a row of units, time
    stamps, and the quantity of each column, in English or German. What the file does not contain is
    assumed, printed, and marked as assumed in the rig file, which `stickslip select` then takes.

    With --urdf, joints of the log are found by the names of the description, and the rig file is
    that of the robot: joints that stood still are locked where they were.

    Several files are films of a capsule or a cart that drives itself, at other frequencies each:
    tracked positions, and nothing else. The rig file has a question mark for what they do not show.
    """
    from stickslip.cli.init import run
    from stickslip.cli.inputs import reading_of

    asked = ReadingOptions(columns=columns, units=units, gain=gain, motor_constant=motor_constant)
    run(files, reading_of(asked), output, urdf=urdf, force=force, as_json=as_json)


@command(app, "fit")
def fit(
    *,
    rig: Rig = None,
    law: FittedLaw = None,
    data: Data = None,
    reading: ReadingOptions,
    changes: Set = None,
    allow_import: AllowImport = False,
    parameters: ParameterOptions,
    estimation: EstimationOptions,
    output: LawFile = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Fit one friction law to measurements.

    The parameters are printed with their confidence intervals.

    While a record is fitted, press Ctrl-C once to stop with the best fit so far, twice to cancel.
    """
    from stickslip.cli.inputs import measured, reading_of
    from stickslip.cli.judge import run_fit

    ask = partial(measured, data=data or [], reading=reading_of(reading))
    ask = partial(ask, parameters=parameters, estimation=estimation)
    start = partial(run_fit, allow_import=allow_import, force=force, as_json=as_json)
    start(rig, law, ask, changes or [], output)


@command(app, "check")
def check(
    *,
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE",
            help="Data files (CSV, Parquet, MATLAB, MDF), one per trial, and/or a rig file (TOML)."
            " The mechanism of the rig file allows more checks; its [data] is read too.",
        ),
    ],
    data: Data = None,
    reading: ReadingOptions,
    allow_import: AllowImport = False,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Folder for the findings and an overview figure."),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Check the quality of a measurement.

    Exits with code 2 if the check finds an error.
    """
    from stickslip.cli.check import run
    from stickslip.cli.inputs import reading_of

    named = [*files, *(data or [])]
    run(named, reading_of(reading), output, allow_import=allow_import, force=force, as_json=as_json)


@command(app, "simulate")
def simulate(
    *,
    rig: Rig = None,
    law: LawOptions,
    changes: Set = None,
    allow_import: AllowImport = False,
    settings: RunOptions,
    force: Force = False,
    as_json: Json = False,
    enforce: Enforce = False,
) -> None:
    """Simulate the rig with one friction law, or with an equation of the source paper as printed.

    Prints the events and the certificate; writes the run and a report on request.
    With a fitted law from a file, --ensemble samples its parameters from their estimated
    distribution and shows the 95 % band of the motion.
    What was measured on the rig is compared with the prediction.
    --law printed-5 and the others of `stickslip models --published` run with --fixed-step; they
    take the values of their corrected law, and --set friction.signed=true adds a missing sgn.
    """
    from stickslip.cli.simulate import run

    start = partial(run, allow_import=allow_import, force=force, as_json=as_json, enforce=enforce)
    start(rig, changes or [], law, settings)


@command(app, "export")
def export(
    *,
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="Rig file (TOML) with a law, such as the law.toml of `stickslip select` or of"
            " `stickslip fit -o law.toml`.",
        ),
    ],
    to: Annotated[
        str,
        typer.Option(
            "--to",
            metavar="TARGET",
            help="c (C99), matlab (MATLAB, Simulink, Octave), modelica, mjcf (MuJoCo), urdf,"
            " csv (lookup table) or json; fmu (the whole rig with its law).",
        ),
    ],
    wanted: ExportOptions,
    allow_import: AllowImport = False,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the files.")] = Path(
        "stickslip-export"
    ),
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Export a friction law to another program, or a rig with its law as an FMU.

    Writes the law as source code, as friction of a joint, as a table or as a document. An FMU has
    the solver inside and needs no Python; making one takes Linux and a C compiler.
    """
    from stickslip.cli.export import run_export

    run_export(file, to, wanted, output, allow_import=allow_import, force=force, as_json=as_json)


@command(app, "apply")
def apply(
    *,
    file: Annotated[
        Path,
        typer.Argument(
            metavar="LAW",
            help="Rig file (TOML) with laws, such as the law.toml of `stickslip select` or of"
            " `stickslip fit -o law.toml`; or the verdict.json beside it.",
        ),
    ],
    model: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL",
            help="File whose joints get the laws: a robot description (URDF), a model for MuJoCo"
            " (MJCF), a scene in USD as text, parameters of a servo for Rhoban/bam (JSON) or of"
            " controllers of ROS 2 (YAML).",
        ),
    ],
    output: Annotated[
        Path,
        typer.Option("-o", "--output", help="File to write: MODEL with this joint friction."),
    ],
    wanted: ApplyOptions,
    allow_import: AllowImport = False,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Write friction into the joints of a model file, and change nothing else in it.

    Prints which parts of the laws the format cannot express, and the resulting error of the
    friction force, of the motion in MuJoCo and, with --record, on a measured record.
    """
    from stickslip.cli.export import run_apply

    run_apply(file, model, wanted, output, allow_import=allow_import, force=force, as_json=as_json)


@command(app, "animate")
def animate(
    *,
    rig: Rig = None,
    law: LawOptions,
    changes: Set = None,
    allow_import: AllowImport = False,
    t_end: EndTime = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="GIF or MP4 file; MP4 needs ffmpeg.")
    ] = Path("stickslip.gif"),
    look: AnimationOptions,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Animate the rig, simulated with one law.

    The mechanism is drawn to scale beside its time plots.
    """
    from stickslip.cli.animate import run

    start = partial(run, allow_import=allow_import, force=force, as_json=as_json)
    start(rig, changes or [], law, t_end, look, output)


@command(app, "sweep")
def sweep(
    *,
    rig: Rig = None,
    law: LawOptions,
    changes: Set = None,
    allow_import: AllowImport = False,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="PATH=LOW:HIGH:N",
            help="Grid of a parameter, e.g. mechanism.drive.drive.frequency=1:6:50; one or two"
            " grids.",
        ),
    ] = None,
    cycles: Annotated[
        int, typer.Option("--cycles", help="Number of drive cycles in the mean; even.")
    ] = 20,
    settle: Annotated[
        int, typer.Option("--settle", help="Number of drive cycles before the mean is taken.")
    ] = 100,
    coordinate: Annotated[
        str | None,
        typer.Option(
            "--coordinate",
            help="Coordinate whose mean rate is taken, where contacts slip along several.",
        ),
    ] = None,
    draws: Draws = None,
    seed: DrawSeed = 0,
    count: Workers = None,
    executor: ExecutorAt = None,
    dry_run: Annotated[
        bool,
        typer.Option("--dry-run", help="Print number, size and time of a campaign; run nothing."),
    ] = False,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="CSV, Parquet or MATLAB file, with a figure (SVG) beside it; of a campaign, its"
            " folder. Default: stickslip-sweep.csv, or stickslip-campaign.",
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Run a campaign, or the mean velocity over a parameter grid.

    With --vary: simulates a driven rig at every point of the grid; writes a table and a figure.
    With --ensemble as well: the band of the mean velocity over the laws that a selection does not
    exclude (give its law.toml as --law), beside the speeds of films if the rig file names some.
    Without: makes the runs of a campaign file, as Parquet files in a folder. The same command goes
    on where a campaign was ended.
    """
    if vary:
        from stickslip.cli.studies import run_sweep

        if dry_run:
            raise InputError("--dry-run applies to campaign files, not to --vary: leave it out.")
        start = partial(run_sweep, allow_import=allow_import, force=force, as_json=as_json)
        start = partial(start, count=count, executor=executor, draws=draws, seed=seed)
        table = output or Path("stickslip-sweep.csv")
        start(rig, changes or [], law, vary, cycles, settle, coordinate, table)
        return
    from stickslip.cli.campaign import run as run_campaign

    given = {
        "--law": law.law,
        "--law-load": law.load,
        "--set": changes,
        "--coordinate": coordinate,
        "--ensemble": draws,
    }
    if unused := [option for option, value in given.items() if value]:
        raise InputError(
            f"{unused[0]} applies to a rig file with --vary PATH=LOW:HIGH:N; a campaign file says"
            " rigs, laws and factors itself."
        )
    folder = output or Path("stickslip-campaign")
    choice = partial(run_campaign, dry_run=dry_run, force=force, allow_import=allow_import)
    choice(rig, folder, at_once=count, executor=executor, as_json=as_json)


@command(app, "orbits")
def orbits(
    *,
    rig: Rig = None,
    law: LawOptions,
    changes: Set = None,
    allow_import: AllowImport = False,
    vary: Annotated[
        str,
        typer.Option(
            "--vary",
            metavar="PATH=LOW:HIGH",
            help="Range of a parameter in SI units, e.g. drive.frequency=2:20.",
        ),
    ],
    cycles: Annotated[
        int, typer.Option("--period", help="Largest period that is sought, in drive cycles.")
    ] = 4,
    values: Annotated[
        int, typer.Option("--values", help="Number of values at which settled runs are made.")
    ] = 61,
    settle: Annotated[
        int, typer.Option("--settle", help="Number of drive cycles before a run counts as settled.")
    ] = 200,
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", help="CSV, Parquet or MATLAB file, with a figure (SVG) beside it."
        ),
    ] = Path("stickslip-orbits.csv"),
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Find periodic orbits over a parameter, stable and unstable.

    Branches are followed from settled runs of a driven rig by continuation. Folds, period
    doublings, grazing contacts and changes of sticking are listed. Writes a table of the orbits and
    a figure: solid where stable, dashed where not.
    """
    from stickslip.cli.studies import run_orbits

    start = partial(run_orbits, allow_import=allow_import, force=force, as_json=as_json)
    start(rig, changes or [], law, vary, cycles, values, settle, output)


@command(app, "plan")
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
            help="Range of settings of the rig, e.g. 40mm..100mm; default: those of the trials"
            " and the rig file, or 0.4 to 1 times the value in the rig file.",
        ),
    ] = None,
    settings: Annotated[int, typer.Option("--settings", help="Number of settings, 2 to 12.")] = 4,
    uncertainty: Annotated[
        str | None,
        typer.Option(
            "--uncertainty",
            help="Standard uncertainty of one travel, scatter and reading combined, e.g. 2mm;"
            " default: that of the rig's trials, or 2 % of the longest travel.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Lab sheet to print (HTML); its table is written beside it as CSV, to fill in.",
        ),
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Plan travel measurements.

    Proposes settings, number of repeats and uncertainty, and lists the laws that they discriminate.
    """
    from stickslip.cli.judge import run_plan

    start = partial(run_plan, allow_import=allow_import, force=force, as_json=as_json)
    start(rig, changes or [], laws, between, settings, uncertainty, output)


@command(app, "models")
def models(
    name: Annotated[str | None, typer.Argument(help="Law or mechanism to show in full.")] = None,
    published: Annotated[
        bool, typer.Option("--published", help="Show the equations as printed in the source paper.")
    ] = False,
    as_json: Json = False,
) -> None:
    """List friction laws and mechanisms, or show one in full.

    A single law is shown with its formula, parameters and sources, a mechanism with its parameters.
    """
    from stickslip.cli.models import run

    run(name, published=published, as_json=as_json)


@command(app, "characterize")
def characterize(
    laws: Annotated[
        list[str],
        typer.Argument(
            help="Names or compositions of laws, such as lugre or 'dahl(level) + power', or files"
            " with a fitted law such as law.toml.",
            metavar="LAW...",
        ),
    ],
    tests: Annotated[
        str | None,
        typer.Option(
            "--tests",
            metavar="NAMES",
            help="Tests, joined by commas: steady, presliding, break-away, lag, map, drift, creep,"
            " limit-cycle, passivity, cost; default: all.",
        ),
    ] = None,
    rig: Annotated[
        Path | None,
        typer.Option(
            "--rig",
            help="Rig file of an axis or a block, whose mass and stiffness are taken; default: 1 kg"
            " on 100 N/m.",
        ),
    ] = None,
    load: Annotated[
        str | None,
        typer.Option(
            "--load", help="Normal force with its unit, e.g. 20N; default: that of the rig, or 1 N."
        ),
    ] = None,
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--input",
            metavar="NAME=VALUE,...",
            help="Values of an input of a law, e.g. temperature=20,40; each is tested.",
        ),
    ] = None,
    match: Annotated[
        bool,
        typer.Option(
            "--match/--no-match",
            help="Give the other laws the levels, Stribeck velocity and stiffness of the first.",
        ),
    ] = True,
    report: Annotated[
        Path | None, typer.Option("--report", help="Page with all figures (HTML).")
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Test friction laws on a virtual bench.

    Steady curve, presliding and memory, break-away, lag, stick-slip map, drift, creep, hunting,
    passivity and cost of one law, or of several side by side. A law without values has typical
    ones.
    """
    from stickslip.cli.studies import run

    start = partial(run, match=match, force=force, as_json=as_json)
    start(laws, rig, load, tests, inputs or [], report)


@command(app, "paper")
def paper(
    rig: Rig = DEMO,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="A mass, a length or the swing of the cart, which the paper does not print, e.g."
            ' cart_mass=0.4, ball_mass="60 g", length=0.25, amplitude="40 deg", fast=100, slow=25.',
        ),
    ] = None,
    output: Folder = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Recompute the results of the source paper, or apply its criteria to your own rig.

    Every table and figure is shown beside the printed values. With a rig file: the same models,
    excitations, criteria and rules for rest for your own block on a spring.
    """
    from stickslip.cli.reproduce import run_paper

    run_paper(rig, changes or [], output, force=force, as_json=as_json)


@command(app, "benchmark")
def benchmark(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[TASK]...", help="Tasks; all if not given.")
    ] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder of page, tables and results so far.")
    ] = Path("stickslip-benchmark"),
    peers: Annotated[
        str | None,
        typer.Option(
            "--peers",
            metavar="NAME,...",
            help="Other libraries to run beside: scipy, lmfit, pysindy, mujoco. Default: those"
            " that are installed.",
        ),
    ] = None,
    count: Workers = None,
    executor: ExecutorAt = None,
    listed: Annotated[bool, typer.Option("--list", help="Only list the tasks.")] = False,
    as_json: Json = False,
) -> None:
    """Run the friction benchmark: public records, our laws, other libraries.

    Each task fits one part of a record and predicts another. Records are downloaded where they are
    missing. An interrupted benchmark is resumed by the same command.
    """
    from stickslip.cli.reproduce import run_benchmark

    start = partial(run_benchmark, peers=peers, count=count, executor=executor, listed=listed)
    start(names or [], output, as_json=as_json)


@command(app, "warmup")
def warmup(
    rig: Annotated[
        Path | None,
        typer.Option("--rig", help="Compile only the mechanism and the laws of this rig file."),
    ] = None,
    mechanisms: Annotated[
        list[str] | None,
        typer.Option(
            "--mechanism", help="Compile only this mechanism, e.g. spring-block; may be repeated."
        ),
    ] = None,
    laws: Laws = None,
    allow_import: AllowImport = False,
    as_json: Json = False,
) -> None:
    """Compile equations ahead of time.

    Intended for container images and continuous integration.

    Default: every mechanism, with and without a drive, with every default candidate, for single
    runs and for ensembles; others with --laws. With --rig: the mechanism of the rig file with its
    laws. Other parameter values need no compilation. Equations that are already in the
    cache are kept.
    """
    from stickslip.cli.warmup import run

    run(rig, mechanisms or [], laws, allow_import=allow_import, as_json=as_json)


@command(app, "doctor")
def doctor(as_json: Json = False) -> None:
    """Check the installation; print what to paste into an issue.

    Versions, extras, cache, threads, compiler and folders of data; and a self-test of two closed
    forms, in plain Python and in machine code, which is compiled first if it is not there.
    """
    from stickslip.cli.warmup import run_doctor

    run_doctor(as_json=as_json)


@command(app, "schema")
def schema() -> None:
    """Print the JSON schema of rig files."""
    from stickslip.cli.console import print_json
    from stickslip.data import rig_schema
    from stickslip.show.documents import document

    print_json(document("rig-schema", rig_schema()))


@command(app, "cite")
def cite(
    laws: Annotated[
        list[str] | None, typer.Argument(help="Laws whose sources are printed; default: all.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Print how to cite stickslip and the sources of friction laws."""
    from stickslip.cli.models import cite

    cite(laws or [], as_json=as_json)


data_commands = typer.Typer(
    context_settings=dict(CONTEXT),
    no_args_is_help=True,
    help="List and download public friction records.",
)


@command(data_commands, "list", group="data")
def data_list(as_json: Json = False) -> None:
    """List the records of the catalogue and where their files are."""
    from stickslip.cli.data import run_list

    run_list(as_json=as_json)


@command(data_commands, "show", group="data")
def data_show(name: Record, as_json: Json = False) -> None:
    """Show a record in full: source, licence, columns, files, parameters."""
    from stickslip.cli.data import run_show

    run_show(name, as_json=as_json)


@command(data_commands, "path", group="data")
def data_path(
    name: Record,
    file: Annotated[
        str | None, typer.Option("--file", help="One of its files; default: the first.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Print the path of a record's table, downloading and converting it if necessary."""
    from stickslip.cli.data import run_path

    run_path(name, file, as_json=as_json)


profile_commands = typer.Typer(
    context_settings=dict(CONTEXT),
    no_args_is_help=True,
    help="Optimise motion profiles within limits.",
)


@command(profile_commands, "optimise", group="profile")
def profile_optimise(
    *,
    rig: Annotated[Path, typer.Argument(help="Rig file (TOML) with a prescribed motion.")],
    settings: ProfileOptions,
    output: Folder = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Optimise the motion that drives the rig, within limits; write its rig file and a figure.

    Press Ctrl-C once to stop with the best motion so far, twice to cancel; --resume continues a
    search.
    """
    from stickslip.cli.studies import run_profile

    run_profile(rig, settings, output, force=force, as_json=as_json)


app.add_typer(data_commands, name="data")
app.add_typer(profile_commands, name="profile")
