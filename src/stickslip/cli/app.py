"""The commands: what each does, the options it takes, and the function that does it."""

from typing import Annotated

import typer

from stickslip.cli import options as option_groups
from stickslip.cli.help import CONTEXT, Panels, command

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
def select(options: option_groups.SelectOptions) -> None:
    """Compare friction laws on a measurement; write a report.

    The verdict names a law and its parameters, gives a 95 % band that holds whichever law does,
    and says what to measure next.

    While laws are fitted to records of several joints, press Ctrl-C once to stop with the best fit
    so far, twice to cancel.
    """
    from stickslip.cli.judge import run_select

    run_select(options)


@command(app, "demo")
def demo(options: option_groups.DemoOptions) -> None:
    """Select a law for the rig that comes with the package; write a report.

    The rig is that of the source paper, a block that a spring pushes, with one measured travel.
    Other commands take it as `demo`, such as `stickslip simulate demo`.
    """
    from stickslip.cli.judge import run_select

    run_select(option_groups.SelectOptions(**vars(options)))


@command(app, "init")
def init(options: option_groups.InitOptions) -> None:
    """Detect the contents of a data file; write a rig file.

    Detects code page, separators, decimal comma, lines above the header, a row of units, time
    stamps, and the quantity of each column, in English or German. What the file does not contain is
    assumed, printed, and marked as assumed in the rig file, which `stickslip select` then takes.

    With --urdf, joints of the log are found by the names of the description, and the rig file is
    that of the robot: joints that stood still are locked where they were.

    Several files are films of a capsule or a cart that drives itself, at other frequencies each:
    tracked positions, and nothing else. The rig file has a question mark for what they do not show.
    """
    from stickslip.cli.check import run_init

    run_init(options)


@command(app, "fit")
def fit(options: option_groups.FitOptions) -> None:
    """Fit one friction law to measurements.

    The parameters are printed with their confidence intervals.

    While a record is fitted, press Ctrl-C once to stop with the best fit so far, twice to cancel.
    """
    from stickslip.cli.judge import run_fit

    run_fit(options)


@command(app, "check")
def check(options: option_groups.CheckOptions) -> None:
    """Check the quality of a measurement.

    Exits with code 2 if the check finds an error.
    """
    from stickslip.cli.check import run

    run(options)


@command(app, "simulate")
def simulate(options: option_groups.SimulateOptions) -> None:
    """Simulate the rig with one friction law, or with an equation of the source paper as printed.

    Prints the events and the certificate; writes the run and a report on request.
    With a fitted law from a file, --ensemble samples its parameters from their estimated
    distribution and shows the 95 % band of the motion.
    What was measured on the rig is compared with the prediction.
    --law printed-5 and the others of `stickslip models --published` run with --fixed-step; they
    take the values of their corrected law, and --set friction.signed=true adds a missing sgn.
    """
    from stickslip.cli.simulate import run

    run(options)


@command(app, "export")
def export(options: option_groups.ExportOptions) -> None:
    """Export a friction law to another program, or a rig with its law as an FMU.

    Writes the law as source code, as friction of a joint, as a table or as a document. An FMU has
    the solver inside and needs no Python; making one takes Linux and a C compiler.
    """
    from stickslip.cli.export import run_export

    run_export(options)


@command(app, "apply")
def apply(options: option_groups.ApplyOptions) -> None:
    """Write friction into the joints of a model file, and change nothing else in it.

    Prints which parts of the laws the format cannot express, and the resulting error of the
    friction force.
    """
    from stickslip.cli.export import run_apply

    run_apply(options)


@command(app, "animate")
def animate(options: option_groups.AnimateOptions) -> None:
    """Animate the rig, simulated with one law.

    The mechanism is drawn to scale beside its time plots.
    """
    from stickslip.cli.simulate import run_animate

    run_animate(options)


@command(app, "sweep")
def sweep(options: option_groups.SweepOptions) -> None:
    """Run a campaign, or the mean velocity over a parameter grid.

    With --vary: simulates a driven rig at every point of the grid; writes a table and a figure.
    With --ensemble as well: the band of the mean velocity over the laws that a selection does not
    exclude (give its law.toml as --law), beside the speeds of films if the rig file names some.
    Without: makes the runs of a campaign file, as Parquet files in a folder. The same command goes
    on where a campaign was ended.
    """
    if options.vary:
        from stickslip.cli.studies import run_sweep

        run_sweep(options)
    else:
        from stickslip.cli.studies import run

        run(options)


@command(app, "orbits")
def orbits(options: option_groups.OrbitOptions) -> None:
    """Find periodic orbits over a parameter, stable and unstable.

    Branches are followed from settled runs of a driven rig by continuation. Folds, period
    doublings, grazing contacts and changes of sticking are listed. Writes a table of the orbits and
    a figure: solid where stable, dashed where not.
    """
    from stickslip.cli.studies import run_orbits

    run_orbits(options)


@command(app, "optimise")
def optimise(options: option_groups.OptimiseOptions) -> None:
    """Optimise parameters of a driven rig for speed, energy or peak force, within limits.

    Writes the best rig file, a figure and the numbers; with two goals, the front of both. Press
    Ctrl-C once to stop with the best motion so far, twice to cancel.
    """
    from stickslip.cli.studies import run_optimise

    run_optimise(options)


@command(app, "plan")
def plan(options: option_groups.PlanOptions) -> None:
    """Plan travel measurements.

    Proposes settings, number of repeats and uncertainty, and lists the laws that they discriminate.
    """
    from stickslip.cli.judge import run_plan

    run_plan(options)


@command(app, "models")
def models(options: option_groups.ModelsOptions) -> None:
    """List friction laws and mechanisms, or show one in full.

    A single law is shown with its formula, parameters and sources, a mechanism with its parameters.
    """
    from stickslip.cli.models import run

    run(options)


@command(app, "characterize")
def characterize(options: option_groups.CharacterizeOptions) -> None:
    """Test friction laws on a virtual bench.

    Steady curve, presliding and memory, break-away, drift and passivity of one law, or of several
    side by side. A law without values has typical ones.
    """
    from stickslip.cli.studies import run_characterize

    run_characterize(options)


@command(app, "paper")
def paper(options: option_groups.PaperOptions) -> None:
    """Recompute the results of the source paper.

    Every table and figure is shown beside the printed values.
    """
    from stickslip.cli.reproduce import run_paper

    run_paper(options)


@command(app, "warmup")
def warmup(options: option_groups.WarmupOptions) -> None:
    """Compile equations ahead of time.

    Intended for container images and continuous integration.

    Default: every mechanism, with and without a drive, with every default candidate, for single
    runs and for ensembles; others with --laws. With --rig: the mechanism of the rig file with its
    laws. Other parameter values need no compilation. Equations that are already in the
    cache are kept.
    """
    from stickslip.cli.warmup import run

    run(options)


@command(app, "doctor")
def doctor(options: option_groups.JsonOption) -> None:
    """Check the installation; print what to paste into an issue.

    Versions, extras, cache, threads, compiler and folders of data; and a self-test of two closed
    forms, in plain Python and in machine code, which is compiled first if it is not there.
    """
    from stickslip.cli.warmup import run_doctor

    run_doctor(options)


@command(app, "schema")
def schema() -> None:
    """Print the JSON schema of rig files."""
    from stickslip.cli.console import print_json
    from stickslip.data import rig_schema
    from stickslip.show.documents import document

    print_json(document("rig-schema", rig_schema()))


@command(app, "cite")
def cite(options: option_groups.CiteOptions) -> None:
    """Print how to cite stickslip and the sources of friction laws."""
    from stickslip.cli.models import run_cite

    run_cite(options)


data_commands = typer.Typer(
    context_settings=dict(CONTEXT),
    no_args_is_help=True,
    help="List and download public friction records.",
)


@command(data_commands, "list", group="data")
def data_list(options: option_groups.JsonOption) -> None:
    """List the records of the catalogue and where their files are."""
    from stickslip.cli.check import run_list

    run_list(as_json=options.as_json)


@command(data_commands, "show", group="data")
def data_show(options: option_groups.RecordOptions) -> None:
    """Show a record in full: source, licence, columns, files, parameters."""
    from stickslip.cli.check import run_show

    run_show(options)


@command(data_commands, "path", group="data")
def data_path(options: option_groups.PathOptions) -> None:
    """Print the path of a record's table, downloading and converting it if necessary."""
    from stickslip.cli.check import run_path

    run_path(options)


app.add_typer(data_commands, name="data")
