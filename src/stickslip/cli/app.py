"""The commands and their options."""

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["app"]

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Which friction model fits a mechanism, with which parameters, and how surely.",
    epilog="Exit codes: 0 done, 2 bad input or data, 3 no convergence or no law fits,"
    " 4 criteria failed, 130 cancelled.",
)

Rig = Annotated[Path | None, typer.Argument(help="Rig file (TOML); the paper's rig if not given.")]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="PATH=VALUE", help="Override, e.g. mechanism.attached=true."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout.")]
Force = Annotated[bool, typer.Option("--force", help="Replace a report that is already there.")]
Folder = Annotated[Path, typer.Option("-o", "--output", help="Folder of the report.")]
Record = Annotated[str, typer.Argument(metavar="NAME", help="A record, see `data list`.")]
Enforce = Annotated[
    bool, typer.Option("--enforce", help="Exit with 4 if a criterion of the paper fails.")
]


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
    data: Annotated[
        Path | None,
        typer.Option("--data", help="Table of trials (CSV or Parquet) with a column travel."),
    ] = None,
    changes: Set = None,
    laws: Annotated[
        str | None, typer.Option("--laws", help="Only these, e.g. coulomb,viscous.")
    ] = None,
    output: Folder = Path("stickslip-report"),
    force: Force = False,
    as_json: Json = False,
    enforce: Enforce = False,
) -> None:
    """Fit every law to the rig's measurement, compare them, write a report."""
    from stickslip.cli.select import run

    run(rig, data, changes or [], laws, output, force=force, as_json=as_json, enforce=enforce)


@app.command()
def check(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE", help="CSV, Parquet or MATLAB files; several are trials."),
    ],
    columns: Annotated[
        list[str] | None,
        typer.Option("--columns", metavar="NAME=COLUMN,...", help="E.g. position=q,force=u."),
    ] = None,
    units: Annotated[
        list[str] | None,
        typer.Option("--unit", metavar="NAME=UNIT,...", help="Of columns, e.g. position=mm."),
    ] = None,
    gain: Annotated[
        list[str] | None,
        typer.Option("--gain", metavar="NAME=FACTOR,...", help="To SI, e.g. force=35.15."),
    ] = None,
    repair: Annotated[
        list[str] | None,
        typer.Option("--repair", metavar="sort,gaps", help="Order the times, drop what is empty."),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder for a picture and the findings.")
    ] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Say what a measurement can tell and what is wrong with it; exit with 2 at an error."""
    from stickslip.cli.check import Reading, run

    reading = Reading(columns=columns, units=units, gain=gain, repair=repair)
    run(files, reading, output, force=force, as_json=as_json)


@app.command()
def simulate(
    rig: Rig = None,
    law: Annotated[
        str, typer.Option("--law", help="Friction law, see `stickslip models`.")
    ] = "coulomb",
    changes: Set = None,
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
        typer.Option("--fixed-step", help="Run as a block diagram with this step [s] instead."),
    ] = None,
    method: Annotated[
        str, typer.Option("--method", help="Integrator of the fixed step: euler, heun or rk4.")
    ] = "euler",
    no_stick_rule: Annotated[
        bool, typer.Option("--no-stick-rule", help="Fixed step: never hold the body.")
    ] = False,
    force: Force = False,
    as_json: Json = False,
    enforce: Enforce = False,
) -> None:
    """Simulate the rig with one law; show events and certificate, export the run."""
    from stickslip.cli.simulate import Settings, run

    settings = Settings(
        law=law,
        t_end=t_end,
        samples=samples,
        fixed_step=fixed_step,
        method=method,
        stick_rule=not no_stick_rule,
    )
    run(rig, changes or [], settings, output, force=force, as_json=as_json, enforce=enforce)


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
    laws: Annotated[
        str | None, typer.Option("--laws", help="Only these, e.g. coulomb,viscous.")
    ] = None,
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

    run(rig, mechanisms or [], laws, jobs=jobs, as_json=as_json)


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


data = typer.Typer(
    no_args_is_help=True, help="Public friction records: what there is, and where the files are."
)
app.add_typer(data, name="data")


@data.command("list")
def data_list(as_json: Json = False) -> None:
    """List the records of the catalogue and where their files are."""
    from stickslip.cli.data import run_list

    run_list(as_json=as_json)


@data.command("show")
def data_show(name: Record, as_json: Json = False) -> None:
    """Show a record in full: source, licence, columns, files, what is known."""
    from stickslip.cli.data import run_show

    run_show(name, as_json=as_json)


@data.command("path")
def data_path(
    name: Record,
    file: Annotated[
        str | None, typer.Option("--file", help="One of its files; the first if not given.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Print the path of a record's table, downloading and converting it if necessary."""
    from stickslip.cli.data import run_path

    run_path(name, file, as_json=as_json)
