"""Arguments and options that several commands share."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from stickslip.errors import RenamedError

__all__ = [
    "AllowImport",
    "BackSlip",
    "Columns",
    "Conditions",
    "Data",
    "Effort",
    "Enforce",
    "Evaluations",
    "FittedLaw",
    "Fixed",
    "Folder",
    "Force",
    "FormerFree",
    "FormerUnknown",
    "Gain",
    "Goal",
    "Hold",
    "Horizon",
    "Interval",
    "Jobs",
    "Json",
    "Kind",
    "Knots",
    "Law",
    "LawFile",
    "LawLoad",
    "Laws",
    "LoadShare",
    "PlannedLaws",
    "Position",
    "Purpose",
    "Rate",
    "Record",
    "Repair",
    "Resume",
    "Rig",
    "Route",
    "Seed",
    "Segment",
    "Set",
    "Starts",
    "Units",
    "Validate",
    "Vary",
]

Rig = Annotated[Path | None, typer.Argument(help="Rig file (TOML); the paper's rig if not given.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="PATH=VALUE", help="Override, e.g. mechanism.attached=true."),
]
AllowImport = Annotated[
    bool,
    typer.Option(
        "--allow-import",
        help="Let the rig file import classes (type = 'module:Class'), which runs their code.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout.")]
Force = Annotated[bool, typer.Option("--force", help="Replace what is already there.")]
Folder = Annotated[Path, typer.Option("-o", "--output", help="Folder of the report.")]
Record = Annotated[str, typer.Argument(metavar="NAME", help="A record, see `data list`.")]
Enforce = Annotated[
    bool, typer.Option("--enforce", help="Exit with 4 if a criterion of the paper fails.")
]
Law = Annotated[
    str | None,
    typer.Option(
        "--law",
        metavar="NAME|FILE",
        help="Friction law, see `stickslip models`, or a file that has one, such as the law.toml of"
        " `stickslip select`; if not given, the only one that the rig file has values for, else"
        " coulomb.",
    ),
]
LawLoad = Annotated[
    str | None,
    typer.Option(
        "--law-load",
        metavar="FORCE",
        help='Normal force at which the law of a file was fitted, e.g. "50 N", where its levels are'
        " forces: they are divided by it.",
    ),
]
FittedLaw = Annotated[
    str | None,
    typer.Option(
        "--law",
        help="Friction law, see `stickslip models`; if not given, the only one that the rig file"
        " has a table for, else coulomb-viscous.",
    ),
]
LawFile = Annotated[
    Path | None, typer.Option("-o", "--output", help="Rig file (TOML) of the fitted law.")
]
Laws = Annotated[str | None, typer.Option("--laws", help="Only these, e.g. coulomb,viscous.")]
PlannedLaws = Annotated[
    str | None,
    typer.Option(
        "--law",
        "--laws",
        help="What to tell apart, e.g. coulomb,viscous; the laws of the rig file if not given.",
    ),
]

Data = Annotated[
    list[Path] | None,
    typer.Option(
        "--data",
        metavar="FILE",
        help="Table of travels, or record in time (CSV, Parquet, MATLAB), instead of the rig's own;"
        " may be repeated, for trials.",
    ),
]
Columns = Annotated[
    list[str] | None,
    typer.Option(
        "--columns",
        metavar="NAME=COLUMN,...",
        help="E.g. position=q,force=u; of a video position=x,y.",
    ),
]
Units = Annotated[
    list[str] | None,
    typer.Option("--unit", metavar="NAME=UNIT,...", help="Of columns, e.g. position=mm."),
]
Gain = Annotated[
    list[str] | None,
    typer.Option(
        "--gain",
        metavar="NAME=FACTOR,...",
        help="Factor of a column in SI units, e.g. friction=-1; of one in volts or without a unit,"
        " the factor that gives SI units, e.g. force=35.15.",
    ),
]
Repair = Annotated[
    list[str] | None,
    typer.Option(
        "--repair", metavar="sort,gaps", help="Sort the rows by time; drop rows with empty cells."
    ),
]
Conditions = Annotated[
    list[str] | None,
    typer.Option(
        "--conditions",
        metavar="NAME,...",
        help="Columns with a condition of each trial, such as a temperature or a direction.",
    ),
]
Validate = Annotated[
    Path | None,
    typer.Option("--validate", metavar="FILE", help="A second record, not used in any fit."),
]
Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        metavar="NAME,...",
        help="Parameters to fit, beside those that the rig file marks; all others are held. E.g."
        " 'friction.*,inertia': what is fitted of the law by default, and the mass. Default:"
        " 'friction.*'.",
    ),
]
Fixed = Annotated[
    list[str] | None,
    typer.Option(
        "--fixed",
        metavar="NAME=VALUE,...",
        help="Values of parameters that are held, e.g. viscous_coefficient=0.4 or 'inertia=80 kg'.",
    ),
]


def _former(option: str, cure: str) -> Callable[[list[str] | None], None]:
    """Return what refuses an option that has another name now."""

    def refuse(given: list[str] | None) -> None:
        if given:
            raise RenamedError(f"{option} is now --vary: {cure}.")

    return refuse


FormerFree = Annotated[
    list[str] | None,
    typer.Option(
        "--free",
        hidden=True,
        callback=_former("--free", "--vary kinetic_coefficient; what is not named is held"),
    ),
]
FormerUnknown = Annotated[
    list[str] | None,
    typer.Option(
        "--unknown", hidden=True, callback=_former("--unknown", "--vary 'friction.*,inertia'")
    ),
]
Horizon = Annotated[
    float | None,
    typer.Option("--horizon", help="Length of the predicted segments [s], for records."),
]
Route = Annotated[
    str | None,
    typer.Option("--route", help="shooting, force-map, inverse-dynamics or features, for records."),
]
Segment = Annotated[
    float | None,
    typer.Option(
        "--segment", help="Length of the simulated segments [s], for records; 1 by default."
    ),
]
Hold = Annotated[
    str | None,
    typer.Option(
        "--hold",
        metavar="zero|first",
        help="Force between samples, for records: zero holds it (a command), first interpolates it"
        " (a force sensor); default zero.",
    ),
]
Starts = Annotated[
    int | None,
    typer.Option("--starts", min=1, help="Starts of each search, for records; default 4."),
]
Seed = Annotated[
    int | None,
    typer.Option("--seed", min=0, help="Seed of random starts, for records; default 0."),
]
Purpose = Annotated[
    str | None, typer.Option("--purpose", help="simulate, position or compensate, for records.")
]
Jobs = Annotated[
    int | None,
    typer.Option("--jobs", min=1, help="Processes that fit laws to records; default 1."),
]

Goal = Annotated[str, typer.Option("--goal", help="travel (per cycle), speed or economy (per J).")]
Kind = Annotated[
    str,
    typer.Option(
        "--kind", help="Kind of motion: three-phase, seven-step, sine(-swing) or spline(-swing)."
    ),
]
Position = Annotated[
    str,
    typer.Option(
        "--angle", "--stroke", help='Largest angle or half a stroke, e.g. "60 deg" or "10 mm".'
    ),
]
Rate = Annotated[str, typer.Option("--rate", help='Largest rate, e.g. "12 rad/s" or "0.5 m/s".')]
Effort = Annotated[
    str | None,
    typer.Option("--torque", "--force-limit", help='Largest torque or force, e.g. "0.6 N m".'),
]
LoadShare = Annotated[
    str, typer.Option("--load-share", help='Least normal force over the weight, e.g. "10 %".')
]
BackSlip = Annotated[
    str | None, typer.Option("--back-slip", help='Largest back-slip in a cycle, e.g. "1 mm".')
]
Interval = Annotated[
    list[str] | None,
    typer.Option(
        "--interval",
        metavar="PATH=LOW..HIGH",
        help="The worst case counts, e.g. kinetic_coefficient=0.15..0.25; may be repeated.",
    ),
]
Evaluations = Annotated[
    int,
    typer.Option(
        "--evaluations",
        min=1,
        help="Motions that each search tries; each of its up to three polishes at most six"
        " times as many, or 80 (n + 1) for the n numbers of a motion: 320 for three-phase.",
    ),
]
Knots = Annotated[int, typer.Option("--knots", help="Positions of a spline.")]
Resume = Annotated[
    Path | None,
    typer.Option(
        "--resume",
        metavar="FILE",
        help="Keep the state of the search in this file, and go on from it if it is there.",
    ),
]
