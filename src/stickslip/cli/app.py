"""The commands: the function that does each, and the options it takes, which say what it does."""

import importlib
import inspect
from collections.abc import Iterator, Sequence
from copy import copy
from dataclasses import MISSING, fields
from types import GenericAlias
from typing import Annotated, Any, Final, get_args, get_origin, get_type_hints

import typer
from typer.core import TyperCommand, TyperGroup
from typer.models import OptionInfo

from stickslip.cli import options as option_groups
from stickslip.cli.options import QuietOption, declared
from stickslip.errors import InputError
from stickslip.show.described import texts_below

# How commands are listed, take their options, and what their help ends with.

KEYWORD = inspect.Parameter.KEYWORD_ONLY

CONTEXT: Final = {"help_option_names": ["-h", "--help"]}
"""Settings of all commands."""

PANELS: Final[dict[str, tuple[str, ...]]] = {
    "Start here": ("demo", "init", "check", "select"),
    "Fit and plan": ("fit", "plan"),
    "Simulate": ("simulate", "animate", "sweep", "orbits", "optimise"),
    "Hand over": ("export", "apply"),
    "Look up": ("models", "cite", "schema", "data", "paper"),
    "Set up": ("doctor", "warmup"),
}
"""Commands by the heading under which they are listed."""

EXAMPLES: Final[dict[str, tuple[str, ...]]] = {
    "demo": ("stickslip demo", "stickslip simulate demo --law lugre"),
    "init": ("stickslip init record.csv", "stickslip init record.csv --columns force=Kanal3"),
    "select": (
        "stickslip select rig.toml",
        "stickslip select rig.toml --laws coulomb,stribeck -o report",
    ),
    "fit": ("stickslip fit rig.toml --law stribeck -o law.toml",),
    "check": ("stickslip check rig.toml", "stickslip check record.csv --columns position=q"),
    "simulate": (
        "stickslip simulate rig.toml --law coulomb --t-end 2 -o run.csv",
        'stickslip simulate demo --set mass="2 kg"',
    ),
    "animate": ("stickslip animate rig.toml --law lugre -o run.gif",),
    "sweep": (
        "stickslip sweep rig.toml --vary mechanism.drive.drive.frequency=1:6:50",
        "stickslip sweep campaign.toml -o runs --dry-run",
    ),
    "orbits": ("stickslip orbits rig.toml --vary drive.frequency=2:20 -o orbits.csv",),
    "plan": ("stickslip plan rig.toml --data table.csv --readings 12 -o next.csv",),
    "models": ("stickslip models", "stickslip models lugre"),
    "export": (
        "stickslip export law.toml --to c",
        "stickslip export law.toml --to mjcf --rig rig.toml",
    ),
    "apply": (
        "stickslip apply law.toml robot.urdf -o new.urdf --joint elbow",
        "stickslip apply law.toml scene.xml -o new.xml --holds",
        "stickslip apply law.toml robot.usda --to physx -o new.usda",
    ),
    "paper": ("stickslip paper -o paper-report",),
    "warmup": ("stickslip warmup --rig rig.toml",),
    "doctor": ("stickslip doctor",),
    "schema": ("stickslip schema > rig-schema.json",),
    "cite": ("stickslip cite lugre",),
    "data list": ("stickslip data list",),
    "data show": ("stickslip data show emps",),
    "data path": ("stickslip data path reciprocating_tribometer --file record",),
    "optimise": (
        "stickslip optimise capsule.toml --vary drive.drive.duty=0.1..0.9 --limit xi=5mm",
        "stickslip optimise rig.toml --vary stiffness=10N/m..1kN/m --goal speed --goal energy",
    ),
}
"""Commands as one may type them, by the name of the command."""


class Panels(TyperGroup):
    """A group whose commands are listed under headings, in the order of the table."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the commands under their headings, where Click would write one list."""
        width = max(map(len, self.commands), default=0)
        for title, names in PANELS.items():
            rows = [
                (name.ljust(width), self.commands[name].get_short_help_str(limit=90))
                for name in names
                if name in self.commands
            ]
            if rows:
                with formatter.section(title):
                    formatter.write_dl(rows)


class _Command(TyperCommand):
    """A command that says in one line what it needs, with an example."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        try:
            return super().parse_args(ctx, args)
        except typer.BadParameter as error:
            parameter: Any = error.param
            if parameter is None or not hasattr(error, "param_type"):  # given, but not valid
                raise
            argument = parameter.param_type_name == "argument"
            name = parameter.metavar or parameter.name.upper() if argument else parameter.opts[0]
            help_text = f": {parameter.help.rstrip('.')}" if parameter.help else ""
            path = ctx.command_path
            example = EXAMPLES[path.partition(" ")[2]][0]
            raise InputError(f"{path} needs {name}{help_text}. Example: `{example}`.") from None


def add_command(app: typer.Typer, name: str, place: str, kind: type) -> None:
    """Add a command to an application, with its examples below its options.

    It has an option for each field of a class, whose docstring is its help, and `--quiet`, which
    none has to heed. Its function, at a place such as ``judge.run_fit``, is loaded when it is run.
    """
    examples = EXAMPLES[name]
    heading = "Example:" if len(examples) == 1 else "Examples:"
    # \b keeps the lines as they are
    epilog = "\n".join(("\b", heading, *(f"  $ {line}" for line in examples)))
    single = [parameter for part in (kind, QuietOption) for parameter in _parameters(part)]
    several = [field.name for field in fields(kind) if field.default == ()]

    def called(*, quiet: bool, **given: Any) -> None:  # noqa: ARG001  # heeded by its callback
        given |= {field: () for field in several if given[field] is None}
        module, _, function = place.partition(".")
        getattr(importlib.import_module(f"stickslip.cli.{module}"), function)(kind(**given))

    called.__doc__ = kind.__doc__
    called.__signature__ = inspect.Signature(single)  # type: ignore[attr-defined]  # what typer reads
    called.__annotations__ = {parameter.name: parameter.annotation for parameter in single}
    add = app.command(
        name.rsplit(maxsplit=1)[-1], cls=_Command, epilog=epilog, context_settings=dict(CONTEXT)
    )
    add(called)


def _parameters(kind: type) -> Iterator[inspect.Parameter]:
    """Yield the fields of a class as typer reads parameters: its own, then those of its bases.

    An option is called as its field, unless its mark has a long name, and the text below the field
    is its help.
    """
    hints, texts = get_type_hints(kind, include_extras=True), texts_below(kind)
    known = {field.name: field for field in fields(kind)}
    for name in dict.fromkeys(
        name for base in kind.__mro__ for name in inspect.get_annotations(base)
    ):
        default, hint = known[name].default, hints[name]
        info, plain = typer.Option(), hint
        if hasattr(hint, "__metadata__"):
            info, plain = copy(hint.__metadata__[0]), hint.__origin__
        names = declared(info)
        if isinstance(info, OptionInfo) and not any(item.startswith("--") for item in names):
            names.append(f"--{name.replace('_', '-')}")
        info.param_decls, info.help = (
            tuple(names),
            info.help or " ".join(texts.get(name, "").split()),
        )
        info.default = ... if default is MISSING else None if default == () else default
        if get_origin(plain) is Sequence:
            plain = GenericAlias(list, get_args(plain))
        yield inspect.Parameter(name, KEYWORD, default=info, annotation=plain)


# The commands: the function that does each, and the options it takes, which say what it does.

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
    "paper": ("studies.run_paper", option_groups.PaperOptions),
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
