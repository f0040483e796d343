"""Arguments and options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

from stickslip.errors import InputError

DEMO = Path("demo")
"""What stands for the rig that comes with the package."""


def _rig(context: typer.Context, given: Path | None) -> Path | None:
    """Return a rig file, None for the bundled rig; say what is missing or is no rig file."""
    from stickslip.experiments import is_data_file

    if context.resilient_parsing or given == DEMO:
        return None
    name = f"stickslip {context.info_name}"
    if given is None:
        raise InputError(
            f"{name} needs a rig file (TOML): {name} rig.toml. `stickslip init record.csv` writes"
            f" one for a data file; {name} demo takes the rig that comes with the package."
        )
    if is_data_file(given):
        own = given.with_suffix(".toml")
        raise InputError(
            f"{given} is a data file, not a rig file: `stickslip init {given}` writes one for it;"
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
Folder = Annotated[Path, typer.Option("-o", "--output", help="Folder for the report.")]
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
        " inverse-dynamics, features or rate-state. Default: chosen from the data.",
    ),
]
Segment = Annotated[
    float | None,
    typer.Option("--segment", help="Length of the simulated segments of a record [s] (default 1)."),
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
        "--starts", min=1, help="Number of starting points per search, for records (default 4)."
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
Purpose = Annotated[
    str | None,
    typer.Option(
        "--purpose", help="Intended use of the law, for records: simulate, position or compensate."
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

Goal = Annotated[
    str,
    typer.Option(
        "--goal", help="Objective: travel (per cycle), speed, or economy (travel per joule)."
    ),
]
Kind = Annotated[
    str,
    typer.Option(
        "--kind", help="Kind of motion: three-phase, seven-step, sine(-swing) or spline(-swing)."
    ),
]
Position = Annotated[
    str,
    typer.Option(
        "--angle", "--stroke", help='Largest angle or half stroke, e.g. "60 deg" or "10 mm".'
    ),
]
Rate = Annotated[
    str,
    typer.Option("--rate", help='Largest angular velocity or speed, e.g. "12 rad/s" or "0.5 m/s".'),
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
