"""Rooms of the package are entered by their doors: what others use stands in `__init__`."""

import ast
import functools
import importlib
from collections.abc import Iterator, Sequence
from pathlib import Path

from tests.support import for_all

import stickslip

ROOT = Path(stickslip.__file__).parent
ROOMS = {path.parent.name for path in ROOT.glob("*/__init__.py")}
OF_MODULES = {"kernels", "catalogue", "paper"}
"""Rooms whose doors are modules: the text of a kernel's module is what is compiled."""
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


def imports_past_a_door(file: Path) -> Iterator[str]:
    """Yield the imports of a file that name a module inside of another room."""
    own = file.relative_to(ROOT).parts[0].removesuffix(".py")
    for node in imports_of(file):
        if isinstance(node, ast.ImportFrom) and node.module:
            modules = [node.module]
        elif isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
        else:
            continue
        for module in modules:
            first, *rest = module.split(".")
            if first == "stickslip" and len(rest) > 1 and rest[0] in ROOMS - OF_MODULES - {own}:
                yield f"{module}, line {node.lineno}"


@for_all(FILES)
def test_no_import_goes_past_the_door_of_another_room(file: Path) -> None:
    assert list(imports_past_a_door(file)) == []


@for_all(sorted(ROOMS))
def test_what_a_door_names_is_there(room: str) -> None:
    module = importlib.import_module(f"stickslip.{room}")
    table = {**getattr(module, "HOMES", {}), **getattr(module, "INSIDE", {})}
    for name in {*table, *getattr(module, "__all__", ())}:
        assert getattr(module, name) is not None


@for_all(sorted(ROOMS))
def test_what_stands_inside_is_used_by_another_room(room: str) -> None:
    module = importlib.import_module(f"stickslip.{room}")
    used = {
        alias.name
        for file in [*(one for one in FILES if one.relative_to(ROOT).parts[0] != room), *TOYS]
        for node in imports_of(file)
        if isinstance(node, ast.ImportFrom) and node.module == f"stickslip.{room}"
        for alias in node.names
    }
    if (
        room == "plots"
    ):  # results draw themselves by `stickslip.show.display.plots`, below all figures
        used |= {
            node.attr
            for file in FILES
            for node in ast.walk(tree_of(file))
            if isinstance(node, ast.Attribute)
            and isinstance(node.value, ast.Call)
            and ast.unparse(node.value) == "plots()"
        }
    assert set(getattr(module, "INSIDE", {})) <= used


@for_all(["", *sorted(ROOMS)])
def test_the_tables_of_a_door_are_in_the_order_of_their_names(room: str) -> None:
    tables = {
        node.targets[0].id: [key.value for key in node.value.keys if isinstance(key, ast.Constant)]
        for node in tree_of(ROOT / room / "__init__.py").body
        if isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Name)
        and isinstance(node.value, ast.Dict)
    }
    for name in {"HOMES", "INSIDE"} & tables.keys():
        assert tables[name] == sorted(tables[name]), name
