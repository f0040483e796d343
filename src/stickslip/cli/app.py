"""The commands: the function that does each, and the options it takes, which say what it does."""

from typing import Annotated, Final

import typer

from stickslip.cli import options as option_groups
from stickslip.cli.help import CONTEXT, Panels, add_command

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


data_commands = typer.Typer(
    context_settings=dict(CONTEXT),
    no_args_is_help=True,
    help="List and download public friction records.",
)

COMMANDS: Final[dict[str, tuple[str, type]]] = {
    "select": ("judge.run_select", option_groups.SelectOptions),
    "demo": ("judge.run_demo", option_groups.DemoOptions),
    "init": ("check.run_init", option_groups.InitOptions),
    "fit": ("judge.run_fit", option_groups.FitOptions),
    "check": ("check.run", option_groups.CheckOptions),
    "simulate": ("simulate.run", option_groups.SimulateOptions),
    "export": ("export.run_export", option_groups.ExportOptions),
    "apply": ("export.run_apply", option_groups.ApplyOptions),
    "animate": ("simulate.run_animate", option_groups.AnimateOptions),
    "sweep": ("studies.run_sweep", option_groups.SweepOptions),
    "orbits": ("studies.run_orbits", option_groups.OrbitOptions),
    "optimise": ("studies.run_optimise", option_groups.OptimiseOptions),
    "plan": ("judge.run_plan", option_groups.PlanOptions),
    "models": ("models.run", option_groups.ModelsOptions),
    "characterize": ("studies.run_characterize", option_groups.CharacterizeOptions),
    "paper": ("reproduce.run_paper", option_groups.PaperOptions),
    "warmup": ("warmup.run", option_groups.WarmupOptions),
    "doctor": ("warmup.run_doctor", option_groups.DoctorOptions),
    "schema": ("models.run_schema", option_groups.SchemaOptions),
    "cite": ("models.run_cite", option_groups.CiteOptions),
    "data list": ("check.run_list", option_groups.ListOptions),
    "data show": ("check.run_show", option_groups.RecordOptions),
    "data path": ("check.run_path", option_groups.PathOptions),
}
"""Function in a module of this package, loaded when the command is run, and options, by command."""

for name, (place, options_of) in COMMANDS.items():
    add_command(data_commands if name.startswith("data ") else app, name, place, options_of)
app.add_typer(data_commands, name="data")
