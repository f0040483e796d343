"""Rooms of the package are entered by their doors: what others use stands in `__init__`."""

import ast
import functools
import importlib
from collections.abc import Iterator, Sequence
from pathlib import Path

from tests.support import for_all

import stickslip
from stickslip.lazy import Door

ROOT = Path(stickslip.__file__).parent
DOORS = {
    ".".join(path.parent.relative_to(ROOT).parts)
    for path in ROOT.glob("*/**/__init__.py")
    if "__all__" in path.read_text(encoding="utf-8")
}
"""Packages with a door: rooms, and subpackages that have one of their own."""
LAZY = {
    room: Door(importlib.import_module(f"stickslip.{room}").__name__)
    for room in sorted(DOORS)
    if (ROOT.joinpath(*room.split(".")) / "__init__.pyi").exists()
}
"""Those that load their names when they are asked for."""
OF_MODULES = {"data.catalogue", "engine", "paper", "show"}
"""Those whose modules are doors too: the text of a kernel's module is what is compiled."""
PUBLIC = {f"{room}.{name}" for room, door in LAZY.items() for name in door.namespaces}
"""Modules and subpackages that stand open in a room."""
FILES = sorted(ROOT.rglob("*.py"))
TOYS = sorted((Path(__file__).parent / "toys").rglob("*.py"))
"""Kinds and laws of other packages, which use what stands inside too."""


@functools.cache
def tree_of(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


@functools.cache
def imports_of(file: Path) -> Sequence[ast.Import | ast.ImportFrom]:
    nodes = ast.walk(tree_of(file))
    return [node for node in nodes if isinstance(node, ast.Import | ast.ImportFrom)]


def door_of(module: Sequence[str]) -> str:
    """Return the innermost door before which a module stands: a door itself is behind none."""
    ends = range(len(module) - 1, 0, -1)
    return next(
        (door for door in map(".".join, (module[:end] for end in ends)) if door in DOORS), ""
    )


def imports_past_a_door(file: Path) -> Iterator[str]:
    """Yield the imports of a file that name a module behind a door at which the file is not."""
    own = ".".join(file.relative_to(ROOT).with_suffix("").parts)
    for node in imports_of(file):
        if isinstance(node, ast.ImportFrom) and node.module:
            modules = [node.module]
        elif isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
        else:
            continue
        for module in modules:
            first, *rest = module.split(".")
            door = (
                door_of(rest)
                if first == "stickslip" and ".".join(rest) not in DOORS | PUBLIC
                else ""
            )
            if door and door not in OF_MODULES and not f"{own}.".startswith(f"{door}."):
                yield f"{module}, line {node.lineno}"


@for_all(FILES)
def test_no_import_goes_past_the_door_of_another_room(file: Path) -> None:
    assert list(imports_past_a_door(file)) == []


@for_all(sorted(DOORS))
def test_what_a_door_names_is_there(door: str) -> None:
    module = importlib.import_module(f"stickslip.{door}")
    table = LAZY[door].homes if door in LAZY else {}
    for name in {*table, *module.__all__}:
        assert getattr(module, name) is not None


def taken_from(door: str, file: Path) -> Iterator[str]:
    """Yield the names that a file takes from a door: by name, or as attributes of its module."""
    room, _, last = f"stickslip.{door}".rpartition(".")
    nodes = [node for node in imports_of(file) if isinstance(node, ast.ImportFrom)]
    pairs = [(node.module, alias) for node in nodes for alias in node.names]
    yield from (alias.name for module, alias in pairs if module == f"stickslip.{door}")
    doors = {
        alias.asname or last for module, alias in pairs if (module, alias.name) == (room, last)
    }
    for node in ast.walk(tree_of(file)) if doors else ():
        match node:
            case ast.Attribute(value=ast.Name(id=name), attr=attribute) if name in doors:
                yield attribute


@for_all(LAZY)
def test_what_stands_inside_is_used_by_another_room(door: str) -> None:
    folder = ROOT.joinpath(*door.split("."))
    outside = [file for file in FILES if not file.is_relative_to(folder)]
    below = [  # subpackages, which take from the room that they are in
        file
        for file in FILES
        if file.is_relative_to(folder) and door_of(file.relative_to(ROOT).parts) not in {door, ""}
    ]
    used = {name for file in (*outside, *below, *TOYS) for name in taken_from(door, file)}
    if door == "show.plots":  # results draw themselves by `display.plots`, below all figures
        used |= {
            node.attr
            for file in FILES
            for node in ast.walk(tree_of(file))
            if isinstance(node, ast.Attribute)
            and isinstance(node.value, ast.Call)
            and ast.unparse(node.value) == "plots()"
        }
    assert {*LAZY[door].homes} - {*LAZY[door].public} <= used


def test_ten_rooms_and_six_modules_stand_at_the_top() -> None:
    folders = {path.name for path in ROOT.iterdir() if (path / "__init__.py").exists()}
    assert len(folders) <= 10
    assert len({path.stem for path in ROOT.glob("*.py")} - {"__init__"}) <= 6
