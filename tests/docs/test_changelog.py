"""The changelog says what the first release contains, by names that exist, and what is gone."""

import pydoc
import re
from pathlib import Path

import typer.main
from tests.support import for_all

import stickslip
from stickslip.cli.app import app
from stickslip.friction import LAW_MODULES
from stickslip.mechanisms import MECHANISM_MODULES

TEXT = (Path(__file__).parents[2] / "CHANGELOG.md").read_text(encoding="utf-8")
COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]


@for_all([*LAW_MODULES, *MECHANISM_MODULES, *COMMANDS])
def test_every_law_mechanism_and_command_is_named(name: str) -> None:
    assert f"`{name}`" in TEXT or f"`stickslip {name}`" in TEXT


def test_what_is_removed_is_at_no_door() -> None:
    added, changed, removed = re.split(
        "^### .*\n", TEXT.partition("\n## [0")[0], flags=re.MULTILINE
    )[1:]
    names = set(re.findall(r"`(\w+)`", removed.partition("\n- Of fits")[0]))
    assert names
    doors = (
        stickslip,
        stickslip.identify.fits,
        stickslip.identify.kinds,
        stickslip.show.plots,
        stickslip.engine,
        stickslip.identify,
    )
    assert not {name for name in names for door in doors if name in dir(door)}
    assert not names & set(re.findall(r"`(\w+)`", added + changed))


def test_changes_stand_in_the_order_of_what_users_look_for() -> None:
    heads = re.findall("^### (.*)$", TEXT.partition("\n## [0")[0], re.MULTILINE)
    assert heads == ["Added", "Changed", "Removed"]


def test_names_and_commands_exist() -> None:
    for path in re.findall(r"`stickslip\.([\w.]+)", TEXT):
        assert pydoc.locate(f"stickslip.{path}") is not None
    for command in re.findall(r"`stickslip (\w+)", TEXT):
        assert command in COMMANDS
