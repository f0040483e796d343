"""The changelog says what the first release contains, by names that exist."""

import pydoc
import re
from pathlib import Path

import typer.main
from tests.support import for_all

from stickslip.cli.app import app
from stickslip.friction import LAW_MODULES
from stickslip.mechanisms import MECHANISM_MODULES

TEXT = (Path(__file__).parents[2] / "CHANGELOG.md").read_text(encoding="utf-8")
COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]


@for_all([*LAW_MODULES, *MECHANISM_MODULES, *COMMANDS])
def test_every_law_mechanism_and_command_is_named(name: str) -> None:
    assert f"`{name}`" in TEXT or f"`stickslip {name}`" in TEXT


def test_nothing_has_changed_before_a_release() -> None:
    assert re.findall("^### (.*)$", TEXT.partition("\n## [0")[0], re.MULTILINE) == ["Added"]


def test_names_and_commands_exist() -> None:
    for path in re.findall(r"`stickslip\.([\w.]+)", TEXT):
        assert pydoc.locate(f"stickslip.{path}") is not None
    for command in re.findall(r"`stickslip (\w+)", TEXT):
        assert command in COMMANDS
