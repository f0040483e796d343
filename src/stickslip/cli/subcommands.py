"""The commands that belong together: `stickslip data ...` and `stickslip profile ...`."""

from pathlib import Path
from typing import Annotated

import typer

from stickslip.cli.help import CONTEXT, command
from stickslip.cli.options import (
    BackSlip,
    Effort,
    Evaluations,
    ExecutorAt,
    Folder,
    Force,
    Goal,
    Interval,
    Json,
    Kind,
    Knots,
    Law,
    LawLoad,
    LoadShare,
    Position,
    Quiet,
    Rate,
    Record,
    Resume,
    Set,
    Workers,
)

data = typer.Typer(
    context_settings=dict(CONTEXT),
    no_args_is_help=True,
    help="List and download public friction records.",
)


@command(data, "list", group="data")
def data_list(as_json: Json = False, _quiet: Quiet = False) -> None:
    """List the records of the catalogue and where their files are."""
    from stickslip.cli.data import run_list

    run_list(as_json=as_json)


@command(data, "show", group="data")
def data_show(name: Record, as_json: Json = False, _quiet: Quiet = False) -> None:
    """Show a record in full: source, licence, columns, files, parameters."""
    from stickslip.cli.data import run_show

    run_show(name, as_json=as_json)


@command(data, "path", group="data")
def data_path(
    name: Record,
    file: Annotated[
        str | None, typer.Option("--file", help="One of its files; default: the first.")
    ] = None,
    as_json: Json = False,
    _quiet: Quiet = False,
) -> None:
    """Print the path of a record's table, downloading and converting it if necessary."""
    from stickslip.cli.data import run_path

    run_path(name, file, as_json=as_json)


profile = typer.Typer(
    context_settings=dict(CONTEXT),
    no_args_is_help=True,
    help="Optimise motion profiles within limits.",
)


@command(profile, "optimise", group="profile")
def profile_optimise(
    rig: Annotated[Path, typer.Argument(help="Rig file (TOML) with a prescribed motion.")],
    angle: Position,
    rate: Rate,
    torque: Effort = None,
    load_share: LoadShare = "0 %",
    back_slip: BackSlip = None,
    goal: Goal = "travel",
    kind: Kind = "spline",
    law: Law = None,
    law_load: LawLoad = None,
    interval: Interval = None,
    changes: Set = None,
    knots: Knots = 12,
    evaluations: Evaluations = 2000,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Random seed.")] = 0,
    resume: Resume = None,
    count: Workers = None,
    executor: ExecutorAt = None,
    output: Folder = Path("stickslip-profile"),
    force: Force = False,
    as_json: Json = False,
    _quiet: Quiet = False,
) -> None:
    """Optimise the motion that drives the rig, within limits; write its rig file and a figure.

    Press Ctrl-C once to stop with the best motion so far, twice to cancel; --resume continues a
    search.
    """
    from stickslip.cli.law_choice import LawAsked
    from stickslip.cli.profile import Settings, run

    settings = Settings(
        limits={
            "position": angle,
            "rate": rate,
            "effort": torque,
            "load_share": load_share,
            "back_slip": back_slip,
        },
        goal=goal,
        kind=kind,
        law=LawAsked(law=law, load=law_load),
        interval=interval or [],
        knots=knots,
        evaluations=evaluations,
        seed=seed,
        resume=resume,
        count=count,
        executor=executor,
    )
    run(rig, changes or [], settings, output, force=force, as_json=as_json)
