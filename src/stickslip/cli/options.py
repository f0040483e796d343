"""Arguments and options of commands, and groups of them that are handed on together."""

import shlex
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any

import typer

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
        typed, own = (shlex.quote(str(one)) for one in (given, given.with_suffix(".toml")))
        raise InputError(
            f"{given} is a data file, not a rig file: `stickslip init {typed}` writes one for it;"
            f" then {name} {own}."
        )
    return given


Rig = Annotated[
    Path | None,
    typer.Argument(
        metavar="RIG",
        callback=_rig,
        help="Rig file (TOML), or `demo` for the rig that comes with the package.",
    ),
]


def _hush(wanted: bool) -> bool:
    from stickslip.cli.console import hush

    hush(wanted)
    return wanted


Quiet = Annotated[
    bool,
    typer.Option(
        "-q", "--quiet", callback=_hush, is_eager=True, help="Print no progress and no remarks."
    ),
]
MotorConstant = Annotated[
    str | None,
    typer.Option(
        "--motor-constant",
        metavar="VALUE",
        help='Force or torque per current of the motor with its gears, e.g. "0.12 N m/A": the'
        " column `current` is then read as the force.",
    ),
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="Override a value of the rig file, e.g. mechanism.attached=true or mass=2; the last"
        " name is enough where it is the only one.",
    ),
]
AllowImport = Annotated[
    bool,
    typer.Option(
        "--allow-import",
        help="Allow the rig file to import classes (type = 'module:Class'); this runs their code.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document to stdout.")]
Force = Annotated[bool, typer.Option("--force", help="Replace existing files.")]
EndTime = Annotated[
    float | None, typer.Option("--t-end", help="End time [s]; default: that of the rig file.")
]
Folder = Annotated[
    Path | None,
    typer.Option(
        "-o",
        "--output",
        help="Folder for the report. Default: stickslip- and the name of what is written, such as"
        " stickslip-report; with --json, nothing is written unless a folder is given.",
    ),
]
Record = Annotated[str, typer.Argument(metavar="NAME", help="Name of a record, see `data list`.")]
Enforce = Annotated[
    bool, typer.Option("--enforce", help="Exit with code 4 if a criterion of the paper fails.")
]
Law = Annotated[
    str | None,
    typer.Option(
        "--law",
        metavar="NAME|FILE",
        help="Friction law (see `stickslip models`), or a file with one, such as the law.toml of"
        " `stickslip select`. Default: the only law with values in the rig file, else"
        " coulomb.",
    ),
]
LawOfFile = Annotated[str | None, typer.Option("--law", help="Which law, if the file has several.")]
LawLoad = Annotated[
    str | None,
    typer.Option(
        "--law-load",
        metavar="FORCE",
        help='Normal force at which the law of a file was fitted, e.g. "50 N", if its levels are'
        " forces: they are divided by it.",
    ),
]
FittedLaw = Annotated[
    str | None,
    typer.Option(
        "--law",
        help="Friction law (see `stickslip models`); for records of several joints, laws by contact"
        " as in shoulder=coulomb,elbow=dahl. Default: the only law with a table in the rig file,"
        " or below a contact, else coulomb-viscous.",
    ),
]
LawFile = Annotated[
    Path | None,
    typer.Option("-o", "--output", help="Write the fitted law to this rig file (TOML)."),
]
Laws = Annotated[
    str | None,
    typer.Option(
        "--laws", help="Friction laws to use, e.g. coulomb,viscous. Default: all that apply."
    ),
]
PlannedLaws = Annotated[
    str | None,
    typer.Option(
        "--law",
        "--laws",
        help="Laws to discriminate, e.g. coulomb,viscous. Default: the laws of the rig file.",
    ),
]

Data = Annotated[
    list[Path] | None,
    typer.Option(
        "--data",
        metavar="FILE",
        help="Table of travels, or time record (CSV, Parquet, MATLAB, MDF), instead of the rig's"
        " own data. Repeat the option for several trials.",
    ),
]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--columns",
        metavar="NAME=COLUMN,...",
        help="Column of each quantity, e.g. position=q,force=u; for a video track position=x,y.",
    ),
]
Units = Annotated[
    list[str] | None,
    typer.Option("--unit", metavar="NAME=UNIT,...", help="Unit of a column, e.g. position=mm."),
]
Gain = Annotated[
    list[str] | None,
    typer.Option(
        "--gain",
        metavar="NAME=FACTOR,...",
        help="Scale factor per quantity, e.g. friction=-1 to flip a sign, force=35.15 to convert"
        ' volts to newtons, or "position=4096 counts/rev".',
    ),
]
Repair = Annotated[
    list[str] | None,
    typer.Option(
        "--repair",
        metavar="sort,gaps",
        help="Repair the time base: 'sort' sorts rows by time, 'gaps' drops rows with empty cells.",
    ),
]
Conditions = Annotated[
    list[str] | None,
    typer.Option(
        "--conditions",
        metavar="NAME,...",
        help="Columns with a condition of each trial, such as temperature or direction.",
    ),
]
Validate = Annotated[
    Path | None,
    typer.Option(
        "--validate",
        metavar="FILE",
        help="Second record for validation; it is not used in any fit.",
    ),
]
Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        metavar="NAME,...",
        help="Parameters to fit, in addition to those that the rig file marks, e.g."
        " 'friction.*,inertia'; all others are held fixed. Default: 'friction.*', all"
        " parameters of the law.",
    ),
]
Fixed = Annotated[
    list[str] | None,
    typer.Option(
        "--fixed",
        metavar="NAME=VALUE,...",
        help="Values of fixed parameters, e.g. viscous_coefficient=0.4 or 'inertia=80 kg'.",
    ),
]


Horizon = Annotated[
    float | None,
    typer.Option("--horizon", help="Prediction length on the second record [s]."),
]
Route = Annotated[
    str | None,
    typer.Option(
        "--route",
        help="Estimation method for records: shooting, force-map,"
        " inverse-dynamics, features or rate-state; balance to select by the band of all laws;"
        " travel for films of a capsule or a cart."
        " Default: chosen from the data.",
    ),
]
Segment = Annotated[
    float | None,
    typer.Option(
        "--segment",
        help="Length of the simulated segments of a record [s]; default: 1, or 20 samples if that"
        " is longer.",
    ),
]
Hold = Annotated[
    str | None,
    typer.Option(
        "--hold",
        metavar="zero|first",
        help="Interpolation of the force: zero-order hold (a command) or first-order, linear (a"
        " sensor). Default: estimated from the record.",
    ),
]
Starts = Annotated[
    int | None,
    typer.Option(
        "--starts", min=1, help="Number of starting points per search, for records (default 1)."
    ),
]
Seed = Annotated[
    int | None,
    typer.Option("--seed", min=0, help="Random seed for the extra starting points (default 0)."),
]
PositionZeros = Annotated[
    bool | None,
    typer.Option(
        "--position-zeros/--no-position-zeros",
        help="Whether positions of each record count from an unknown place, as where encoders were"
        " set to 0 at rest. Default: yes for a body that swings or slides freely, no for records of"
        " several joints.",
        show_default=False,
    ),
]
FrictionDelay = Annotated[
    float | None,
    typer.Option(
        "--friction-delay",
        help="For measured friction: how long after the motion it is recorded [s] (default 0).",
    ),
]
FrictionLag = Annotated[
    float | None,
    typer.Option(
        "--friction-lag",
        help="For measured friction: time constant of a first-order filter of it [s] (default 0).",
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, help="Number of processes that share the work."),
]
ExecutorAt = Annotated[
    str | None,
    typer.Option(
        "--executor",
        metavar="dask://HOST:PORT",
        help="Dask cluster that does the work, by the address of its scheduler.",
    ),
]

Draws = Annotated[
    int | None,
    typer.Option(
        "--ensemble",
        metavar="N",
        min=2,
        help="Take N laws: those drawn beside the law.toml of a selection that --law names, or"
        " draws from the estimates of the law.",
    ),
]
DrawSeed = Annotated[
    int, typer.Option("--seed", min=0, help="Random seed where --ensemble draws from estimates.")
]
Quantile = Annotated[
    str,
    typer.Option(
        "--quantile",
        help="Statistic over the laws of --ensemble: a quantile of the objective, 0 for the worst"
        " case, or mean.",
    ),
]
Goal = Annotated[
    str,
    typer.Option(
        "--goal", help="Objective: travel (per cycle), speed, or economy (travel per joule)."
    ),
]
Kind = Annotated[
    str,
    typer.Option(
        "--kind", help="three-phase, three-accelerations, seven-step, sine(-swing), spline(-swing)."
    ),
]
Angle = Annotated[
    str | None,
    typer.Option("--angle", help='Largest angle of a pendulum from its middle, e.g. "60 deg".'),
]
Stroke = Annotated[
    str | None,
    typer.Option(
        "--stroke", help='Largest stroke of an inner mass, from end to end, e.g. "20 mm".'
    ),
]
Rate = Annotated[
    str,
    typer.Option("--rate", help='Largest angular velocity or speed, e.g. "12 rad/s" or "0.5 m/s".'),
]
Acceleration = Annotated[
    str | None,
    typer.Option("--acceleration", help='Largest acceleration of the inner body, e.g. "50 m/s^2".'),
]
Effort = Annotated[
    str | None,
    typer.Option("--torque", "--force-limit", help='Largest torque or force, e.g. "0.6 N m".'),
]
LoadShare = Annotated[
    str,
    typer.Option(
        "--load-share", help='Smallest normal force, relative to the weight, e.g. "10 %".'
    ),
]
BackSlip = Annotated[
    str | None, typer.Option("--back-slip", help='Largest back-slip per cycle, e.g. "1 mm".')
]
Energy = Annotated[
    str | None,
    typer.Option("--energy", help='Largest work of the motor per travel, e.g. "2 J/m".'),
]
Interval = Annotated[
    list[str] | None,
    typer.Option(
        "--interval",
        metavar="PATH=LOW..HIGH",
        help="Range of an uncertain parameter, e.g. kinetic_coefficient=0.15..0.25; the worst case"
        " is optimised. May be repeated.",
    ),
]
Evaluations = Annotated[
    int,
    typer.Option(
        "--evaluations",
        min=1,
        help="Evaluation budget per search. Local refinement may use up to six times as many, or"
        " 80 (n + 1) for n parameters of the motion, whichever is larger.",
    ),
]
Knots = Annotated[int, typer.Option("--knots", help="Number of knots of a spline.")]
Resume = Annotated[
    Path | None,
    typer.Option(
        "--resume",
        metavar="FILE",
        help="Save the state of the search to this file, and resume from it if it exists.",
    ),
]


@dataclass(frozen=True, kw_only=True)
class LawOptions:
    """Which law, and the load that its levels refer to."""

    law: Law = None
    load: LawLoad = None


@dataclass(frozen=True, kw_only=True)
class ReadingOptions:
    """How the files of a measurement are read."""

    columns: Columns = None
    units: Units = None
    gain: Gain = None
    repair: Repair = None
    conditions: Conditions = None
    motor_constant: MotorConstant = None


@dataclass(frozen=True, kw_only=True)
class ParameterOptions:
    """What is fitted, and on what it is tried."""

    validate: Validate = None
    vary: Vary = None
    fixed: Fixed = None


@dataclass(frozen=True, kw_only=True)
class EstimationOptions:
    """How parameters are estimated."""

    horizon: Horizon = None
    route: Route = None
    segment: Segment = None
    hold: Hold = None
    starts: Starts = None
    seed: Seed = None
    position_zeros: PositionZeros = None
    friction_delay: FrictionDelay = None
    friction_lag: FrictionLag = None

    @property
    def settings(self) -> dict[str, Any]:
        """What is said of the settings of estimates, by their fields."""
        apart = ("horizon", "route")
        given = {one.name: getattr(self, one.name) for one in fields(self) if one.name not in apart}
        return {name: value for name, value in given.items() if value is not None}


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """What to run and how."""

    t_end: EndTime = None
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="Write the run to this CSV, Parquet or MATLAB file."),
    ] = None
    samples: Annotated[
        int, typer.Option("--samples", min=2, help="Number of evenly spaced rows of the run.")
    ] = 1001
    fixed_step: Annotated[
        float | None,
        typer.Option(
            "--fixed-step",
            help="Simulate with a fixed step of this size [s], as a block diagram does.",
        ),
    ] = None
    method: Annotated[
        str | None,
        typer.Option(
            "--method",
            help="Integration method for --fixed-step: euler, semi-implicit, heun or rk4.",
        ),
    ] = None
    stick_rule: Annotated[
        bool | None,
        typer.Option(
            "--stick-rule/--no-stick-rule",
            help="With --fixed-step: hold the body where its velocity changes sign. By default with"
            " friction laws, not with equations as printed.",
        ),
    ] = None
    break_away: Annotated[
        str | None,
        typer.Option(
            "--break-away",
            metavar="RULE",
            help="With --fixed-step: friction in the first step out of rest: static, kinetic or"
            " zero.",
        ),
    ] = None
    zero_velocity_band: Annotated[
        float,
        typer.Option(
            "--zero-velocity-band",
            metavar="SPEED",
            help="With --fixed-step: hold the body where a step ends within this speed [m/s], as"
            " Karnopp (1985) does.",
        ),
    ] = 0.0
    program: Annotated[
        str | None,
        typer.Option(
            "--as",
            metavar="PROGRAM",
            help="Simulate as another program does, and compare that with the exact run: mujoco,"
            " mujoco-dcmotor, drake, simscape or karnopp, with settings such as"
            " mujoco:timestep=0.001,impedance=0.99.",
        ),
    ] = None
    ensemble: Annotated[
        int | None,
        typer.Option(
            "--ensemble",
            metavar="N",
            min=2,
            help="Also simulate N samples of the uncertain parameters: of the law, drawn from the"
            " estimates in its file, and of the mechanism.",
        ),
    ] = None
    seed: DrawSeed = 0
    refit: Annotated[
        bool,
        typer.Option(
            "--refit",
            help="Also fit the law to what was measured on this rig, and compare the intervals.",
        ),
    ] = False
    report_asked: Annotated[
        bool,
        typer.Option("--report", help="Write a report of the run to stickslip-run/index.html."),
    ] = False
    report_to: Annotated[
        Path | None,
        typer.Option(
            "--report-to", metavar="FOLDER", help="Write the report to this folder instead."
        ),
    ] = None

    @property
    def report(self) -> Path | None:
        """Folder of the report; none is written if None."""
        given = self.report_to
        return given if given is not None else Path("stickslip-run") if self.report_asked else None

    @property
    def exact(self) -> bool:
        """Whether events are located, so that the run can be certified."""
        return self.fixed_step is None and self.program is None


@dataclass(frozen=True, kw_only=True)
class ExportOptions:
    """The law to export, and its use."""

    law: LawOfFile = None
    contact: Annotated[
        str | None,
        typer.Option("--contact", help="Contact whose law is exported, if laws differ."),
    ] = None
    name: Annotated[
        str | None,
        typer.Option("--name", help="Name of the program. Default: that of the law."),
    ] = None
    rig: Annotated[
        Path | None,
        typer.Option(
            "--rig",
            metavar="FILE",
            help="Rig file (TOML) on which the law is used: an fmu is of that rig with the law;"
            " mjcf and urdf say what their simplified friction changes of its motion.",
        ),
    ] = None
    load: Annotated[
        str | None,
        typer.Option(
            "--load",
            metavar="FORCE",
            help="Normal force for mjcf, urdf and csv. Default: that of the mechanism at rest.",
        ),
    ] = None
    law_load: LawLoad = None
    largest_speed: Annotated[
        str | None,
        typer.Option(
            "--largest-speed",
            metavar="SPEED",
            help="End of the range of speeds for mjcf, urdf and csv. Default: that of the motion of"
            " --rig, or of the fit.",
        ),
    ] = None
    fmi: Annotated[
        int, typer.Option("--fmi", min=2, max=3, help="Version of FMI of an fmu, 2 or 3.")
    ] = 3
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--at",
            metavar="INPUT=VALUE",
            help="Contact input of the law at which tables and joints have their friction, such"
            ' as "temperature=35 degC"; may be repeated.',
        ),
    ] = None
    inputs: Annotated[
        list[str] | None,
        typer.Option(
            "--input",
            metavar="DRIVE",
            help="Drive of the rig that becomes an input of the fmu (repeatable).",
        ),
    ] = None
    t_end: EndTime = None


@dataclass(frozen=True, kw_only=True)
class ApplyOptions:
    """The laws to apply, and their joints."""

    joints: Annotated[
        list[str] | None,
        typer.Option(
            "--joint",
            metavar="[CONTACT=]JOINT",
            help="Joint that gets the law, or the law of a contact; may be repeated. Default:"
            " joints with the names of the contacts, or the only joint.",
        ),
    ] = None
    law: LawOfFile = None
    load: Annotated[
        str | None,
        typer.Option(
            "--load",
            metavar="FORCE",
            help="Normal force at which joints have their friction. Default: that of the mechanism"
            " at rest.",
        ),
    ] = None
    law_load: LawLoad = None
    largest_speed: Annotated[
        str | None,
        typer.Option(
            "--largest-speed",
            metavar="SPEED",
            help="End of the range of speeds over which level and damping come closest to the law."
            " Default: that of the fit.",
        ),
    ] = None
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--at",
            metavar="INPUT=VALUE",
            help="Contact input of the laws at which joints have their friction, such as"
            ' "temperature=35 degC", or "elbow.temperature=35 degC" for one; may be repeated.',
        ),
    ] = None
    to: Annotated[
        str | None,
        typer.Option(
            "--to",
            metavar="PROGRAM",
            help="What reads MODEL: urdf, mjcf, physx, newton, bam or ros2. Needed for USD, which"
            " PhysX (Isaac Sim) and Newton read.",
        ),
    ] = None
    polynomial: Annotated[
        bool,
        typer.Option(
            "--polynomial",
            help="Of MJCF, a damping that changes with the speed (MuJoCo 3.7 and later).",
        ),
    ] = False
    holds: Annotated[
        bool,
        typer.Option(
            "--holds",
            help="Give joints the level of break-away, so that they hold what the law holds."
            " Default: the level that comes closest to the law while sliding.",
        ),
    ] = False
    run: Annotated[
        bool,
        typer.Option(
            "--run/--no-run",
            help="Run the joints in MuJoCo, if it is installed, and compare that with the laws.",
        ),
    ] = True
    record: Annotated[
        Path | None,
        typer.Option(
            "--record",
            metavar="FILE",
            help="Record of the joints, positions and forces in time, on which the law, its"
            " simplification and the file in MuJoCo are compared: a data file or log, or the rig"
            " file (TOML) that says how it is read.",
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class AnimationOptions:
    """What the animation looks like."""

    fps: Annotated[float, typer.Option("--fps", help="Frames per second.")] = 25.0
    speed: Annotated[
        float, typer.Option("--speed", help="Playback speed; 1 is real time, 0.1 is slow motion.")
    ] = 1.0
    size: Annotated[
        str, typer.Option("--size", metavar="WIDTHxHEIGHT", help="Size in CSS pixels.")
    ] = "880x400"
    dpi: Annotated[
        float,
        typer.Option("--dpi", help="Resolution in dots per inch; 72 is one pixel per CSS pixel."),
    ] = 72.0


@dataclass(frozen=True, kw_only=True)
class ProfileOptions:
    """What motion to look for and how."""

    rate: Rate
    angle: Angle = None
    stroke: Stroke = None
    acceleration: Acceleration = None
    effort: Effort = None
    load_share: LoadShare = "0 %"
    back_slip: BackSlip = None
    energy: Energy = None
    goal: Goal = "travel"
    kind: Kind = "spline"
    law: Law = None
    load: LawLoad = None
    interval: Interval = None
    draws: Draws = None
    quantile: Quantile = "0.05"
    changes: Set = None
    knots: Knots = 12
    evaluations: Evaluations = 2000
    seed: Annotated[int, typer.Option("--seed", min=0, help="Random seed.")] = 0
    resume: Resume = None
    count: Workers = None
    executor: ExecutorAt = None
