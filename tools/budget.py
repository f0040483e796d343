"""Print the size of each room of the package beside its budget, and fail above it.

``python -m tools.budget``; ``--lower`` writes today's numbers where they are below the budget:
every change that shrinks a room lowers it. Budgets are in ``tools/budget.toml``; what they are to
become is written there beside them.

Code lines are those without docstrings, comments and blank lines. A numeric constant is a number
that a module or a class gives a name in capitals, or a field with a number as its default in a
class of thresholds: those of the judge, and those of studies and data, are counted.
"""

import argparse
import ast
import re
import sys
import tomllib
from collections import Counter
from pathlib import Path

from tools.structure import SOURCE, lines_of_code

BUDGET = Path(__file__).with_name("budget.toml")
THRESHOLDS = ("Thresholds",)
"""Classes whose fields are thresholds."""
COUNTED = {
    "judge": "constants",
    "study": "constants of study and data",
    "data": "constants of study and data",
}
"""Rooms whose numeric constants are counted, and the row that they are counted in."""


def room_of(module: str, rooms: dict[str, list[str]]) -> str:
    """Return the room of a module, such as ``identify/laws.py``; empty if it has none."""
    first = module.split("/", maxsplit=1)[0].removesuffix(".py")
    return next((room for room, folders in rooms.items() if first in folders), "")


def is_number(node: ast.expr | None) -> bool:
    """Return whether an expression is a number, or a tuple or list of numbers."""
    match node:
        case ast.Constant(value=bool()):
            return False
        case ast.Constant(value=int() | float()):
            return True
        case ast.UnaryOp(operand=operand):
            return is_number(operand)
        case ast.BinOp(left=left, right=right):
            return is_number(left) and is_number(right)
        case ast.Tuple(elts=parts) | ast.List(elts=parts):
            return bool(parts) and all(is_number(part) for part in parts)
    return False


def constants(tree: ast.Module) -> int:
    """Return the number of named numbers, and named rows of numbers, of a module."""
    result = 0
    bodies = [(tree.body, False)]
    bodies += [
        (node.body, node.name in THRESHOLDS) for node in tree.body if isinstance(node, ast.ClassDef)
    ]
    for body, threshold in bodies:
        for node in body:
            match node:
                case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Tuple(elts=values)):
                    pairs = list(zip(names, values, strict=False))
                case ast.Assign(targets=[name], value=value):
                    pairs = [(name, value)]
                case ast.AnnAssign(target=name, value=ast.expr() as value):
                    pairs = [(name, value)]
                case _:
                    pairs = []
            for name, value in pairs:
                capital = isinstance(name, ast.Name) and bool(
                    re.fullmatch("_?[A-Z][A-Z0-9_]*", name.id)
                )
                result += (capital or threshold) and is_number(value)
    return result


def counted(rooms: dict[str, list[str]]) -> dict[str, int]:
    """Return code lines by room, modules of all, and numeric constants."""
    result: Counter[str] = Counter()
    package = SOURCE / "stickslip"
    for path in sorted(package.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text)
        room = room_of(path.relative_to(package).as_posix(), rooms)
        result[room or "elsewhere"] += lines_of_code(text, tree)
        result["modules"] += 1
        if room in COUNTED:
            result[COUNTED[room]] += constants(tree)
    result["lines"] = sum(result[room] for room in (*rooms, "elsewhere"))
    return dict(result)


def main() -> None:
    """Print the budget, and fail where it is exceeded."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lower", action="store_true", help="write smaller numbers as budgets")
    given = parser.parse_args()
    text = BUDGET.read_text(encoding="utf-8")
    budget = tomllib.loads(text)
    result = counted(budget["rooms"])
    over = []
    print(f"{'':28}{'today':>9}{'budget':>9}{'target':>9}")
    for name, limit in budget["budget"].items():
        today = result.get(name, 0)
        print(f"{name:28}{today:9,}{limit:9,}{budget['target'].get(name, 0):9,}")
        if today > limit:
            over.append(f"{name} has {today:,}, {today - limit:,} above its budget of {limit:,}")
        if given.lower and today < limit:
            key = f'"{name}"' if " " in name else name
            text = re.sub(rf"(?m)^{key} = {limit}$", f"{key} = {today}", text, count=1)
    if given.lower:
        BUDGET.write_text(text, encoding="utf-8")
    if over:
        sys.exit("\n".join([*over, "Shrink what grew, or what stands beside it."]))


if __name__ == "__main__":
    main()
