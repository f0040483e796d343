"""Arguments and options of commands: a class for each, whose fields are declared once.

A field `t_end` is the option `--t-end` unless its type is annotated with another name or as an
argument; the text below it is its help, and a sequence may be given several times (see
`stickslip.cli.app`). What commands share stands in base classes.
"""

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from stickslip.cli import QUIET
from stickslip.errors import InputError

DEMO = Path("demo")
"""What stands for the rig that comes with the package."""


def _rig(context: typer.Context, given: Path | None) -> Path | None:
    """Return a rig file, None for the bundled rig; say what is missing or is no rig file."""
    from stickslip.data import is_data_file

    if context.resilient_parsing or given == DEMO:
        return None
    name = f"stickslip {context.info_name}"
    if given is None:
        raise InputError(
            f"{name} needs a rig file (TOML): {name} rig.toml. `stickslip init record.csv` writes"
            f" one for a data file; {name} demo takes the rig that comes with the package."
        )
    if is_data_file(given):
        typed, own = (shlex.quote(str(path)) for path in (given, given.with_suffix(".toml")))
        raise InputError(
            f"{given} is a data file, not a rig file: `stickslip init {typed}` writes one for it;"
            f" then {name} {own}."
        )
    return given


def declared(mark: Any) -> list[str]:
    """Return the names that the mark of an option declares; none where its field names it."""
    return [
        param_decl
        for param_decl in (mark.default, *(mark.param_decls or ()))
        if isinstance(param_decl, str)
    ]


def typed(options: Any, *names: str) -> list[str]:
    """Return as they are typed those options that have another value than their default.

    Examples
    --------
    >>> typed(
    ...     SimulateOptions(stick_rule=False, changes=("mass=2",)), "stick_rule", "changes", "law"
    ... )
    ['--no-stick-rule', '--set']
    """
    hints = get_type_hints(type(options), include_extras=True)
    defaults = {part.name: part.default for part in fields(options)}
    result = []
    for name in names:
        value = getattr(options, name)
        if value is None or value == defaults[name]:
            continue
        marks = getattr(hints[name], "__metadata__", ())
        called = [item for mark in marks for item in declared(mark) if item.startswith("--")]
        on, _, off = (called or [f"--{name.replace('_', '-')}"])[0].partition("/")
        result.append(off if value is False else on)
    return result


def _hush(wanted: bool) -> bool:
    QUIET.set(wanted)
    return wanted


Rig = Annotated[
    Path | None,
    typer.Argument(
        metavar="RIG",
        callback=_rig,
        help="Rig file (TOML), or `demo` for the rig that comes with the package.",
    ),
]
Output = Annotated[Path | None, typer.Option("-o")]
Names = Annotated[Sequence[str], typer.Option(metavar="NAME,...")]
Force = Annotated[str | None, typer.Option(metavar="FORCE")]
Speed = Annotated[str | None, typer.Option(metavar="SPEED")]
Ensemble = Annotated[int | None, typer.Option("--ensemble", metavar="N", min=2)]
Seed = Annotated[int, typer.Option(min=0)]
At = Annotated[Sequence[str], typer.Option(metavar="INPUT=VALUE")]


# What several commands take.


@dataclass(frozen=True, kw_only=True)
class QuietOption:
    """What every command takes, and none has to heed."""

    quiet: Annotated[bool, typer.Option("-q", callback=_hush, is_eager=True)] = False
    """Print no progress and no remarks."""


@dataclass(frozen=True, kw_only=True)
class JsonOption:
    """How the result is printed."""

    as_json: Annotated[bool, typer.Option("--json")] = False
    """Print one JSON document to stdout."""


@dataclass(frozen=True, kw_only=True)
class WriteOptions(JsonOption):
    """How the result is printed and written."""

    force: bool = False
    """Replace existing files."""


@dataclass(frozen=True, kw_only=True)
class ReportOptions(WriteOptions):
    """How the result is printed and written into a folder."""

    output: Output = None
    """Folder for the report. Default: the name of the rig file and -report, or stickslip- and the
    name of the command; with --json, nothing is written unless a folder is given. A folder that
    holds nothing but an earlier report is replaced."""


@dataclass(frozen=True, kw_only=True)
class EnforceOption:
    """Whether criteria of the paper decide on the exit code."""

    enforce: bool = False
    """Exit with code 4 if a criterion of the paper fails."""


@dataclass(frozen=True, kw_only=True)
class WorkerOptions:
    """Who does the work."""

    count: Annotated[int | None, typer.Option("--workers", min=1)] = None
    """Number of processes that share the work."""
    executor: Annotated[str | None, typer.Option(metavar="dask://HOST:PORT")] = None
    """Dask cluster that does the work, by the address of its scheduler."""


@dataclass(frozen=True, kw_only=True)
class ImportOption:
    """What a rig file may do."""

    allow_import: bool = False
    """Allow the rig file to import classes (type = 'module:Class'); this runs their code."""


@dataclass(frozen=True, kw_only=True)
class ChangeOption:
    """What is changed of a rig file."""

    changes: Annotated[Sequence[str], typer.Option("--set", metavar="PATH=VALUE")] = ()
    """Override a value of the rig file, e.g. mechanism.attached=true or mass=2; the last name is
    enough where it is the only one."""


@dataclass(frozen=True, kw_only=True)
class RigOptions(ChangeOption, ImportOption):
    """A rig file and what is changed of it."""

    rig: Rig = None
    """The rig file; None for the bundled rig."""


@dataclass(frozen=True, kw_only=True)
class LawLoadOption:
    """The load that the levels of a law from a file refer to."""

    law_load: Force = None
    """Normal force at which the law of a file was fitted, e.g. "50 N", if its levels are forces:
    they are divided by it."""


@dataclass(frozen=True, kw_only=True)
class FrictionOptions(LawLoadOption):
    """A law, by name or from a file."""

    law: Annotated[str | None, typer.Option(metavar="NAME|FILE")] = None
    """Friction law (see `stickslip models`), or a file with one, such as the law.toml of `stickslip
    select`. Default: the only law with values in the rig file, else coulomb."""


@dataclass(frozen=True, kw_only=True)
class LawOptions(RigOptions, FrictionOptions):
    """A rig and its law."""


@dataclass(frozen=True, kw_only=True)
class LawOfFileOptions(ImportOption, LawLoadOption):
    """A law of a file that is handed over."""

    law: str | None = None
    """Which law, if the file has several."""


@dataclass(frozen=True, kw_only=True)
class LawsOption:
    """Laws by name."""

    laws: str | None = None
    """Friction laws to use, e.g. coulomb,viscous. Default: all that apply."""


@dataclass(frozen=True, kw_only=True)
class DrawOptions:
    """An ensemble of laws."""

    draws: Ensemble = None
    """Take N laws: those drawn beside the law.toml of a selection that --law names, or draws from
    the estimates of the law."""


@dataclass(frozen=True, kw_only=True)
class DrawSeedOption:
    """Where an ensemble begins."""

    seed: Seed = 0
    """Random seed where --ensemble draws from estimates."""


@dataclass(frozen=True, kw_only=True)
class ColumnOptions:
    """How the columns of a file are read."""

    columns: Annotated[Sequence[str], typer.Option(metavar="NAME=COLUMN,...")] = ()
    """Column of each quantity, e.g. position=q,force=u; for a video track position=x,y."""
    units: Annotated[Sequence[str], typer.Option("--unit", metavar="NAME=UNIT,...")] = ()
    """Unit of a column, e.g. position=mm."""
    gain: Annotated[Sequence[str], typer.Option(metavar="NAME=FACTOR,...")] = ()
    """Scale factor per quantity, e.g. friction=-1 to flip a sign, force=35.15 to convert volts to
    newtons, or "position=4096 counts/rev"."""
    rate: Annotated[str | None, typer.Option(metavar="50Hz")] = None
    """Rate of the rows, or time from one to the next such as 0.5ms, where no column has times."""
    motor_constant: Annotated[str | None, typer.Option(metavar="VALUE")] = None
    """Force or torque per current of the motor with its gears, e.g. "0.12 N m/A": the column
    `current` is then read as the force."""


@dataclass(frozen=True, kw_only=True)
class ReadingOptions(ColumnOptions):
    """How the files of a measurement are read."""

    repair: Annotated[Sequence[str], typer.Option(metavar="sort,gaps,hold")] = ()
    """Repair the time base: 'sort' sorts rows by time, 'gaps' drops rows with empty cells, 'hold'
    keeps commands until the next."""
    conditions: Names = ()
    """Columns with a condition of each trial, such as temperature or direction."""


@dataclass(frozen=True, kw_only=True)
class DataOptions(ReadingOptions):
    """Files of a measurement, and how they are read."""

    data: Annotated[Sequence[Path], typer.Option(metavar="FILE")] = ()
    """Table of travels, or time record (CSV, Parquet, MATLAB, MDF), instead of the rig's own data.
    Repeat the option for several trials."""


@dataclass(frozen=True, kw_only=True)
class EstimationOptions:
    """How parameters are estimated."""

    route: str | None = None
    """Estimation method: table or balance for records, features, rate-state; travel for films of
    a capsule or a cart. Default: chosen from the data."""
    hold: Annotated[str | None, typer.Option(metavar="zero|first")] = None
    """Interpolation of the force: zero-order hold (a command) or first-order, linear (a sensor).
    Default: estimated from the record."""
    starts: Annotated[int | None, typer.Option(min=1)] = None
    """Searches of a law that are followed to their end, for velocity steps."""
    seed: Annotated[int | None, typer.Option(min=0)] = None
    """Random seed of the draws, for features and velocity steps (default 0)."""
    position_zeros: Annotated[
        bool | None,
        typer.Option("--position-zeros/--no-position-zeros", show_default=False),
    ] = None
    """Whether positions of each record count from an unknown place, as where encoders were set to 0
    at rest; for records of several joints. Default: no."""

    @property
    def settings(self) -> dict[str, Any]:
        """What is said of the settings of estimates, by their fields."""
        names = [field.name for field in fields(EstimationOptions)]
        given = {name: getattr(self, name) for name in names if name != "route"}
        return {name: value for name, value in given.items() if value is not None}


@dataclass(frozen=True, kw_only=True)
class MeasuredOptions(RigOptions, DataOptions, EstimationOptions):
    """What was measured, what is fitted to it and how."""

    validate: Annotated[Path | None, typer.Option(metavar="FILE")] = None
    """Second record for validation; it is not used in any fit."""
    vary: Names = ()
    """Parameters to fit, in addition to those that the rig file marks, e.g. 'friction.*,inertia';
    all others are held fixed. Default: 'friction.*', all parameters of the law."""
    fixed: Annotated[Sequence[str], typer.Option(metavar="NAME=VALUE,...")] = ()
    """Values of fixed parameters, e.g. viscous_coefficient=0.4 or 'inertia=80 kg'."""


# What single commands take.


@dataclass(frozen=True, kw_only=True)
class DemoOptions(LawsOption, ReportOptions, EnforceOption):
    """Select a law for the rig that comes with the package; write a report.

    The rig is that of the source paper, a block that a spring pushes, with one measured travel.
    Other commands take it as `demo`, such as `stickslip simulate demo`.
    """


@dataclass(frozen=True, kw_only=True)
class SelectOptions(MeasuredOptions, DemoOptions):
    """Compare friction laws on a measurement; write a report.

    The verdict names a law and its parameters, gives a 95 % band over all candidate laws,
    and says what to measure next.

    While laws are fitted to travels, stick-slip or velocity steps, press Ctrl-C once to stop with
    the best fit so far, twice to cancel.
    """

    tolerance: Annotated[str | None, typer.Option(metavar="2%")] = None
    """Share of friction by which the law that is named may be off (default 2 %)."""


@dataclass(frozen=True, kw_only=True)
class FitOptions(MeasuredOptions, WriteOptions):
    """Fit one friction law to measurements.

    The parameters are printed with their confidence intervals.

    While a law is fitted to travels, stick-slip or velocity steps, press Ctrl-C once to stop with
    the best fit so far, twice to cancel.
    """

    law: str | None = None
    """Friction law (see `stickslip models`); for records of several joints, laws by contact as in
    shoulder=coulomb,elbow=dahl. Default: the only law with a table in the rig file, or below a
    contact, else coulomb-viscous."""
    output: Output = None
    """Write the fitted law to this rig file (TOML)."""


@dataclass(frozen=True, kw_only=True)
class InitOptions(ColumnOptions, WriteOptions):
    """Detect the contents of a data file; write a rig file.

    Detects code page, separators, decimal comma, lines above the header, a row of units, time
    stamps, and the quantity of each column, in English or German. What the file does not contain is
    assumed, printed, and marked as assumed in the rig file, which `stickslip select` then takes.

    With --urdf, joints of the log are found by the names of the description, and the rig file is
    that of the robot: joints that stood still are locked where they were.

    Several files are films of a capsule or a cart that drives itself, at other frequencies each:
    tracked positions, and nothing else. The rig file has a question mark for what they do not show.
    """

    files: Annotated[Sequence[Path], typer.Argument(metavar="FILE...")]
    """Record (CSV, Excel, Parquet, MATLAB, MDF, TDMS, MCAP, ROS bag); or films of one body, a run
    each."""
    urdf: Annotated[Path | None, typer.Option(metavar="FILE")] = None
    """Description of the robot whose joints were recorded."""
    output: Output = None
    """Rig file to write; default: FILE with the ending .toml."""


@dataclass(frozen=True, kw_only=True)
class CheckOptions(DataOptions, ImportOption, WriteOptions):
    """Check the quality of a measurement.

    Exits with code 2 if the check finds an error.
    """

    files: Annotated[Sequence[Path], typer.Argument(metavar="FILE")]
    """Data files (CSV, Parquet, MATLAB, MDF), one per trial, and/or a rig file (TOML). The
    mechanism of the rig file allows more checks; its [data] is read too."""
    output: Output = None
    """Folder for the findings and an overview figure."""


@dataclass(frozen=True, kw_only=True)
class SimulateOptions(LawOptions, DrawSeedOption, WriteOptions, EnforceOption):
    """Simulate the rig with one friction law, or with an equation of the source paper as printed.

    Prints the events and the certificate; writes the run and a report on request.
    With a fitted law from a file, --ensemble samples its parameters from their estimated
    distribution and shows the 95 % band of the motion.
    --law printed-5 and the others of `stickslip models --published` run with --fixed-step; they
    take the values of their corrected law, and --set friction.signed=true adds a missing sgn.
    """

    t_end: float | None = None
    """End time [s]; default: that of the rig file."""
    output: Output = None
    """Write the run to this CSV, Parquet or MATLAB file."""
    samples: Annotated[int, typer.Option(min=2)] = 1001
    """Number of evenly spaced rows of the run."""
    fixed_step: float | None = None
    """Simulate with a fixed step of this size [s], as a block diagram does."""
    method: str | None = None
    """Integration method for --fixed-step: euler, semi-implicit, heun or rk4."""
    stick_rule: Annotated[bool | None, typer.Option("--stick-rule/--no-stick-rule")] = None
    """With --fixed-step: hold the body where its velocity changes sign. By default with friction
    laws, not with equations as printed."""
    break_away: Annotated[str | None, typer.Option(metavar="RULE")] = None
    """With --fixed-step: friction in the first step out of rest: static, kinetic or zero."""
    zero_velocity_band: Annotated[float, typer.Option(metavar="SPEED")] = 0.0
    """With --fixed-step: hold the body where a step ends within this speed [m/s], as Karnopp (1985)
    does."""
    ensemble: Ensemble = None
    """Also simulate N samples of the uncertain parameters: of the law, drawn from the estimates in
    its file, and of the mechanism."""
    energy: bool = False
    """Add works of drives, friction, dampers and stops, and the energy per travel."""
    report_asked: Annotated[bool, typer.Option("--report")] = False
    """Write a report of the run to stickslip-run/index.html."""
    report_to: Annotated[Path | None, typer.Option(metavar="FOLDER")] = None
    """Write the report to this folder instead."""

    @property
    def report(self) -> Path | None:
        """Folder of the report; none is written if None."""
        given = self.report_to
        return given if given is not None else Path("stickslip-run") if self.report_asked else None

    @property
    def exact(self) -> bool:
        """Whether events are located, so that the run can be certified."""
        return self.fixed_step is None


@dataclass(frozen=True, kw_only=True)
class ExportOptions(LawOfFileOptions, WriteOptions):
    """Export a friction law to another program, or a rig with its law as an FMU.

    Writes the law as source code, as friction of a joint, as a table or as a document. An FMU has
    the solver inside and needs no Python; making one takes Linux and a C compiler.
    """

    file: Annotated[Path, typer.Argument(metavar="FILE")]
    """Rig file (TOML) with a law, such as the law.toml of `stickslip select` or of `stickslip fit
    -o law.toml`."""
    to: Annotated[str, typer.Option(metavar="TARGET")]
    """c (C99), matlab (MATLAB, Simulink, Octave), mjcf (MuJoCo), urdf, csv (lookup table)
    or json; fmu (the whole rig with its law)."""
    contact: str | None = None
    """Contact whose law is exported, if laws differ."""
    name: str | None = None
    """Name of the program. Default: that of the law."""
    rig: Annotated[Path | None, typer.Option(metavar="FILE")] = None
    """Rig file (TOML) on which the law is used: an fmu is of that rig with the law; mjcf and urdf
    say what their simplified friction changes of its motion."""
    load: Force = None
    """Normal force for mjcf, urdf and csv. Default: that of the mechanism at rest."""
    largest_speed: Speed = None
    """End of the range of speeds for mjcf, urdf and csv. Default: that of the motion of --rig, or
    of the fit."""
    fmi: Annotated[int, typer.Option(min=2, max=3)] = 3
    """Version of FMI of an fmu, 2 or 3."""
    at: At = ()
    """Contact input of the law at which tables and joints have their friction, such as
    "temperature=35 degC"; may be repeated."""
    inputs: Annotated[Sequence[str], typer.Option("--input", metavar="DRIVE")] = ()
    """Drive of the rig that becomes an input of the fmu (repeatable)."""
    t_end: float | None = None
    """End time [s]; default: that of the rig file."""
    output: Annotated[Path, typer.Option("-o")] = Path("stickslip-export")
    """Folder for the files."""


@dataclass(frozen=True, kw_only=True)
class ApplyOptions(LawOfFileOptions, WriteOptions):
    """Write friction into the joints of a model file, and change nothing else in it.

    Prints which parts of the laws the format cannot express, and the resulting error of the
    friction force.
    """

    file: Annotated[Path, typer.Argument(metavar="LAW")]
    """Rig file (TOML) with laws, such as the law.toml of `stickslip select` or of `stickslip fit -o
    law.toml`; or the verdict.json beside it."""
    model: Annotated[Path, typer.Argument(metavar="MODEL")]
    """File whose joints get the laws: a robot description (URDF), a model for MuJoCo (MJCF), a
    scene in USD as text, parameters of a servo for Rhoban/bam (JSON) or of controllers of ROS 2
    (YAML)."""
    output: Annotated[Path, typer.Option("-o")]
    """File to write: MODEL with this joint friction."""
    joints: Annotated[Sequence[str], typer.Option("--joint", metavar="[CONTACT=]JOINT")] = ()
    """Joint that gets the law, or the law of a contact; may be repeated. Default: joints with the
    names of the contacts, or the only joint."""
    load: Force = None
    """Normal force at which joints have their friction. Default: that of the mechanism at rest."""
    largest_speed: Speed = None
    """End of the range of speeds over which level and damping come closest to the law. Default:
    that of the fit."""
    at: At = ()
    """Contact input of the laws at which joints have their friction, such as "temperature=35 degC",
    or "elbow.temperature=35 degC" for one; may be repeated."""
    to: Annotated[str | None, typer.Option(metavar="PROGRAM")] = None
    """What reads MODEL: urdf, mjcf or physx; default: seen from the file."""
    polynomial: bool = False
    """Of MJCF, a damping that changes with the speed (MuJoCo 3.7 and later)."""
    holds: bool = False
    """Give joints the level of break-away, so that they hold what the law holds. Default: the level
    that comes closest to the law while sliding."""


@dataclass(frozen=True, kw_only=True)
class AnimateOptions(LawOptions, WriteOptions):
    """Animate the rig, simulated with one law.

    The mechanism is drawn to scale beside its time plots.
    """

    t_end: float | None = None
    """End time [s]; default: that of the rig file."""
    output: Annotated[Path, typer.Option("-o")] = Path("stickslip.gif")
    """GIF or MP4 file; MP4 needs ffmpeg."""
    fps: float = 25.0
    """Frames per second."""
    speed: float = 1.0
    """Playback speed; 1 is real time, 0.1 is slow motion."""
    size: Annotated[str, typer.Option(metavar="WIDTHxHEIGHT")] = "880x400"
    """Size in CSS pixels."""
    dpi: float = 72.0
    """Resolution in dots per inch; 72 is one pixel per CSS pixel."""


@dataclass(frozen=True, kw_only=True)
class SweepOptions(LawOptions, DrawOptions, DrawSeedOption, WorkerOptions, WriteOptions):
    """Run a campaign, or the mean velocity over a parameter grid.

    With --vary: simulates a driven rig at every point of the grid; writes a table and a figure.
    With --ensemble as well: the band of the mean velocity over the laws that a selection does not
    exclude (give its law.toml as --law), beside the speeds of films if the rig file names some.
    Without: makes the runs of a campaign file, as Parquet files in a folder. The same command goes
    on where a campaign was ended.
    """

    vary: Annotated[Sequence[str], typer.Option(metavar="PATH=LOW:HIGH:N")] = ()
    """Values of a parameter in SI units, e.g. mechanism.drive.drive.frequency=1:6:50 or
    "drive.frequency=[5.1, 7.3]"; once or twice."""
    cycles: int = 20
    """Number of drive cycles in the mean; even."""
    settle: int = 100
    """Number of drive cycles before the mean is taken."""
    coordinate: str | None = None
    """Coordinate whose mean rate is taken, where contacts slip along several."""
    energy: bool = False
    """Add mean powers of drives, friction, dampers and stops, and the energy per travel."""
    dry_run: bool = False
    """Print number, size and time of a campaign; run nothing."""
    output: Output = None
    """CSV, Parquet or MATLAB file, with a figure (SVG) beside it; of a campaign, its folder.
    Default: stickslip-sweep.csv, or stickslip-campaign."""


@dataclass(frozen=True, kw_only=True)
class OrbitOptions(LawOptions, WriteOptions):
    """Find periodic orbits over a parameter, stable and unstable, or over two.

    Branches are followed from settled runs of a driven rig, or of one that sticks and slips by
    itself, by continuation. Folds, period doublings, grazing contacts and changes of sticking are
    listed. Writes a table of the orbits and a figure: solid where stable, dashed where not. Over
    two parameters: the number and the speed of stable orbits on a grid, and the curves of these
    events.
    """

    vary: Annotated[Sequence[str], typer.Option(metavar="PATH=LOW:HIGH")]
    """Range of a parameter in SI units, e.g. drive.frequency=2:20, or values at which runs settle,
    e.g. "drive.frequency=[2, 5.1, 20]"; twice for a chart."""
    cycles: Annotated[int, typer.Option("--period")] = 4
    """Largest period that is sought, in drive cycles or turns of a self-excited motion."""
    values: int | None = None
    """Number of values in a range at which settled runs are made, 61; of a chart, the cells along
    both, 40."""
    settle: int = 200
    """Number of drive cycles before a run counts as settled."""
    energy: bool = False
    """Add mean powers of drives, friction, dampers and stops, and the energy per travel."""
    output: Annotated[Path, typer.Option("-o")] = Path("stickslip-orbits.csv")
    """CSV, Parquet or MATLAB file, with a figure (SVG) beside it."""


@dataclass(frozen=True, kw_only=True)
class PlanOptions(RigOptions, DataOptions, LawsOption, WriteOptions):
    """Plan the next measurement.

    Says what narrows most what a first measurement leaves open. Of a table of friction, it lists
    the readings that narrow the 95 % band most, with the width to expect; of travels, settings of
    the rig; of records, the further record.
    """

    readings: Annotated[int | None, typer.Option(min=1)] = None
    """Number of readings of a table; default: no more than the table has."""
    vary: Names = ()
    """Parameters to fit to records, as for `stickslip select`."""
    route: str | None = None
    """Estimation method, as for `stickslip select`."""

    output: Output = None
    """Table of the readings to make, to fill in (CSV); `stickslip select --data` reads it."""


@dataclass(frozen=True, kw_only=True)
class ModelsOptions(JsonOption):
    """List friction laws and mechanisms, or show one in full.

    A single law is shown with its formula, parameters and sources, a mechanism with its parameters.
    """

    name: Annotated[str | None, typer.Argument()] = None
    """Law or mechanism to show in full."""
    published: bool = False
    """Show the equations as printed in the source paper."""


@dataclass(frozen=True, kw_only=True)
class PaperOptions(ReportOptions):
    """Recompute the results of the source paper.

    Every table and figure is shown beside the printed values.
    """

    changes: Annotated[Sequence[str], typer.Option("--set", metavar="NAME=VALUE")] = ()
    """A mass, a length or the swing of the cart, which the paper does not print, e.g.
    cart_mass=0.4, ball_mass="60 g", length=0.25, amplitude="40 deg", fast=100, slow=25."""


@dataclass(frozen=True, kw_only=True)
class WarmupOptions(LawsOption, ImportOption, JsonOption):
    """Compile equations ahead of time.

    Intended for container images and continuous integration.

    Default: every mechanism, with and without a drive, with every default candidate, for single
    runs and for ensembles; others with --laws. With --rig: the mechanism of the rig file with its
    laws. Other parameter values need no compilation. Equations that are already in the
    cache are kept.
    """

    rig: Path | None = None
    """Compile only the mechanism and the laws of this rig file."""
    mechanisms: Annotated[Sequence[str], typer.Option("--mechanism")] = ()
    """Compile only this mechanism, e.g. spring-block; may be repeated."""


@dataclass(frozen=True, kw_only=True)
class CiteOptions(JsonOption):
    """Print how to cite stickslip and the sources of friction laws."""

    laws: Annotated[Sequence[str], typer.Argument()] = ()
    """Laws whose sources are printed; default: all."""


@dataclass(frozen=True, kw_only=True)
class RecordOptions(JsonOption):
    """Show a record in full: source, licence, columns, files, parameters."""

    name: Annotated[str, typer.Argument(metavar="NAME")]
    """Name of a record, see `data list`."""


@dataclass(frozen=True, kw_only=True)
class PathOptions(RecordOptions):
    """Print the path of a record's table, downloading and converting it if necessary."""

    file: str | None = None
    """One of its files; default: the first."""


@dataclass(frozen=True, kw_only=True)
class OptimiseOptions(FrictionOptions, ChangeOption, DrawOptions, WorkerOptions, ReportOptions):
    """Optimise parameters of a driven rig for speed, energy or peak force, within limits.

    Writes the best rig file, a figure and the numbers; with two goals, the front of both. Press
    Ctrl-C once to stop with the best motion so far, twice to cancel.
    """

    rig: Annotated[Path, typer.Argument()]
    """Rig file (TOML) whose drives repeat themselves."""
    vary: Annotated[Sequence[str], typer.Option(metavar="PATH=LOW..HIGH")]
    """Parameter to optimise and its range, e.g. drive.drive.duty=0.1..0.9 or
    upper_soft_stop.place=0.1mm..3mm. May be repeated."""
    goal: Annotated[Sequence[str], typer.Option()] = ("speed",)
    """Objective: speed, energy (per travel) or peak_force. Given twice, the front of both."""
    limit: Annotated[Sequence[str], typer.Option(metavar="NAME=VALUE")] = ()
    """Largest value of a coordinate, rate or effort, of acceleration, back_slip, energy or
    peak_force, or least load_share, e.g. xi=10mm or load_share=10%. May be repeated."""
    interval: Annotated[Sequence[str], typer.Option(metavar="PATH=LOW..HIGH")] = ()
    """Range of an uncertain parameter, e.g. kinetic_coefficient=0.15..0.25: objectives are taken
    over five values of it. May be repeated."""
    quantile: str = "0.05"
    """Statistic over --ensemble or --interval: a quantile of the objective, counted from the worst
    (0), or mean."""
    coordinate: str | None = None
    """Coordinate of the travel; default: the one along which contacts slip."""
    evaluations: Annotated[int, typer.Option(min=1)] = 800
    """Motions to try."""
    seed: Seed = 0
    """Random seed."""


@dataclass(frozen=True, kw_only=True)
class DoctorOptions(JsonOption):
    """Check the installation; print what to paste into an issue.

    Versions, extras, cache, threads, compiler and folders of data; and a self-test of two closed
    forms, in plain Python and in machine code, which is compiled first if it is not there.
    """


@dataclass(frozen=True, kw_only=True)
class SchemaOptions:
    """Print the JSON schema of rig files."""


@dataclass(frozen=True, kw_only=True)
class ListOptions(JsonOption):
    """List the records of the catalogue and where their files are."""
