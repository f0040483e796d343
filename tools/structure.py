"""Print the numbers by which the structure of the package is judged: python -m tools.structure.

Everything is counted from the sources with `ast` and from the text of pages, but for what one
command and one function run, and how long an import and a run take, which is watched in processes
of their own, and the tests, which pytest collects.
"""

import ast
import importlib
import io
import json
import os
import re
import subprocess
import sys
import tempfile
import tokenize
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path

from tools import stubs

from stickslip import lazy

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "src"
PACKAGE = "stickslip"
JUDGE = f"{PACKAGE}.identify"
CAPSULES = {"study.sweep.continuation", "study.sweep.orbit_diagrams", "study.sweep.orbits"}
"""Modules that only capsules asked for. By commit, capsules added 3,025 lines outside the judge:
1,595 in these and in tissues, the rest in modules that others use too."""
UPPER = ("cli", "identify.fits", "show.report", "show.plots")
"""Rooms that only a route should tell apart."""
ROUTE_BASES = {"Fit", "Verdict", "Problem"}
"""Classes of which each route has its own subclasses."""
ROUTE_TYPES = {"Measurement", "Balanced", "_Rubbed", "_Shot"}
"""Further classes by which code tells routes apart."""
ROUTE_QUESTIONS = {"travel", "friction", "spring_force", "balance", "features"} | {
    "series",
    "friction-map",
    "scalars",
    "rate-state",
    "pull",
}
"""Texts that name a route or what it is chosen by."""

WATCH = """
import json, sys, threading
from pathlib import Path
import stickslip
root = str(Path(stickslip.__file__).parent)
seen, frames = set(), []
def watch(frame, event, argument):
    if event == "call":
        seen.add(frame.f_code)
        if frame.f_code.co_name == ALGORITHM and not frames:
            while frame is not None:
                frames.append(frame.f_code.co_filename.startswith(root))
                frame = frame.f_back
PREPARE
threading.setprofile(watch)
sys.setprofile(watch)
try:
    RUN
except SystemExit as ended:
    code = ended.code
else:
    code = 0
sys.setprofile(None)
# bodies of modules and classes run on import; comprehensions belong to their function
own = [c for c in seen if c.co_filename.startswith(root) and not c.co_name.startswith("<")]
own = [c for c in own if c.co_flags & 2]
print(json.dumps({
    "code": code,
    "imported": len([name for name in sys.modules if name.partition(".")[0] == "stickslip"]),
    "functions": len({(c.co_filename, c.co_firstlineno, c.co_name) for c in own}),
    "modules": len({c.co_filename for c in own}),
    "frames": sum(frames),
}), file=sys.stderr)
"""
"""Watches what RUN runs; flag 2, CO_NEWLOCALS, is that of functions."""

DEMO = {
    "PREPARE": "",
    "RUN": """
    from stickslip.cli import main
    main(["demo", "--output", sys.argv[1], "--force"])
""",
    "ALGORITHM": "None",
}
"""The command on the bundled rig."""

TABLE = {
    "PREPARE": """
import numpy as np
from stickslip import Axis, Measurement, select
v = np.linspace(0.1, 1.0, 10)
noise = 0.02 * np.random.default_rng(1).normal(size=10)
table = Measurement(velocity=v, friction=2.0 + 3.0 * v + noise)
""",
    "RUN": "select(Axis(inertia=1.0), None, table)",
    "ALGORITHM": "'select_table'",
}
"""A selection of all laws on a friction table of ten rows."""

TIMES = 7
"""Of so many the least is printed: on a loaded machine all others say how loaded it is."""
IMPORTED = """
from time import perf_counter
start = perf_counter()
import stickslip
print(perf_counter() - start)
"""
SIMULATED = f"""
from time import perf_counter
from stickslip import load_rig, simulate
rig = load_rig()
law = rig.laws["coulomb"]
spent = []
for _ in range({TIMES} + 1):
    start = perf_counter()
    simulate(rig.mechanism, law, t_end=1.0)
    spent.append(perf_counter() - start)
print(min(spent[1:]))
"""
"""A run of the bundled rig, which has run before."""

Function = ast.FunctionDef | ast.AsyncFunctionDef


def sources() -> dict[str, Path]:
    """Return the files of the package by the names of their modules."""
    result = {}
    for path in sorted((SOURCE / PACKAGE).rglob("*.py")):
        parts = path.relative_to(SOURCE).with_suffix("").parts
        result[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return result


def door(package: str) -> dict[str, str]:
    """Return the modules that define the names of a package that loads them lazily."""
    importlib.import_module(package)
    return lazy.Door(package).homes


def imports(
    tree: ast.Module, known: dict[str, Path], doors: dict[str, dict[str, str]]
) -> Iterator[str]:
    """Yield the modules of the package that a module imports, also by tables of subpackages."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom) and node.module in known:
            behind = doors.get(node.module, {})
            for alias in node.names:
                below = f"{node.module}.{alias.name}"
                yield below if below in known else behind.get(alias.name, node.module)


def importers(trees: dict[str, ast.Module], known: dict[str, Path]) -> dict[str, set[str]]:
    """Return by module the modules that import it."""
    doors = {package: door(package) for package in stubs.PACKAGES}
    result: dict[str, set[str]] = defaultdict(set)
    for name, tree in trees.items():
        for other in imports(tree, known, doors):
            result[other].add(name)
    for package in (PACKAGE, f"{PACKAGE}.engine", JUDGE, f"{PACKAGE}.show.plots"):
        for home in doors[package].values():  # what users import
            result[home].add(package)
    return result


def lines_of_texts(tree: ast.Module) -> set[int]:
    """Return which lines are texts that stand by themselves: docstrings, texts of fields."""
    return {
        line
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
        for line in range(node.lineno, (node.end_lineno or node.lineno) + 1)
    }


def lines_of_code(text: str, tree: ast.Module) -> int:
    """Return how many lines are neither empty, a comment, nor a text that stands by itself."""
    said = lines_of_texts(tree)
    lines = enumerate(map(str.strip, text.splitlines()), 1)
    return sum(bool(line) and not line.startswith("#") and at not in said for at, line in lines)


def lines_of_imports(tree: ast.Module) -> int:
    """Return how many lines import something."""
    return sum(
        (node.end_lineno or node.lineno) - node.lineno + 1
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
    )


def comments(text: str) -> int:
    """Return how many comments there are, but for those that speak to tools."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    spoken = ("# noqa", "# type:", "# fmt:")
    return sum(
        token.type == tokenize.COMMENT and not token.string.startswith(spoken) for token in tokens
    )


def at_the_top() -> int:
    """Return how many folders and modules of Python stand at the top of the package."""
    top = SOURCE / PACKAGE
    return sum((path / "__init__.py").exists() for path in top.iterdir()) + sum(
        path.name != "__init__.py" for path in top.glob("*.py")
    )


def seconds(program: str) -> float:
    """Return the number that a process prints."""
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": str(SOURCE), "PYTHONDONTWRITEBYTECODE": ""},
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout)


def house(texts: dict[str, str], trees: dict[str, ast.Module]) -> Iterator[tuple[str, object]]:
    """Yield the numbers that say how large the house is, and how fast."""
    code = {name: lines_of_code(texts[name], tree) for name, tree in trees.items()}
    outside = [name for name in texts if not f"{name}.".startswith(f"{JUDGE}.")]
    lines = sum(code[name] for name in outside)
    yield "code lines outside the judge", lines
    capsules = sum(code[f"{PACKAGE}.{name}"] for name in CAPSULES)
    yield "of these, in modules that only capsules asked for", capsules
    yield "modules in all (files)", len(texts)
    yield "folders and modules at the top", at_the_top()
    share = sum(map(lines_of_imports, trees.values())) / sum(code.values())
    yield "lines of imports, % of code", round(100.0 * share, 1)
    spoken = sum(comments(texts[name]) for name in outside)
    yield "comments per 100 code lines outside the judge", round(100.0 * spoken / lines, 1)
    yield "simulate, of the bundled rig once more [ms]", round(1e3 * seconds(SIMULATED), 2)
    spent = min(seconds(IMPORTED) for _ in range(TIMES))
    yield "import stickslip [ms]", round(1e3 * spent, 1)


def arguments(function: Function, *, is_method: bool) -> list[str]:
    """Return the names of the arguments of a function, without the first one of a method."""
    a = function.args
    named = [*a.posonlyargs, *a.args][is_method:]
    rest = [*([a.vararg] if a.vararg else []), *a.kwonlyargs, *([a.kwarg] if a.kwarg else [])]
    return [item.arg for item in (*named, *rest)]


def public_functions(tree: ast.Module) -> Iterator[tuple[str, Function, list[str]]]:
    """Yield the name, the definition and the arguments of each public function and method."""
    bodies = [(tree.body, "")]
    bodies += [
        (node.body, f"{node.name}.")
        for node in tree.body
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    ]
    for body, owner in bodies:
        for node in body:
            if not isinstance(node, Function) or node.name.startswith("_"):
                continue
            marks = {ast.unparse(mark).rpartition(".")[2] for mark in node.decorator_list}
            if marks & {"override", "overload", "property", "cached_property", "setter"}:
                continue  # documented where they are declared, or attributes
            is_method = bool(owner) and "staticmethod" not in marks
            yield f"{owner}{node.name}", node, arguments(node, is_method=is_method)


def route_types(trees: dict[str, ast.Module]) -> set[str]:
    """Return the names of the classes that belong to one route."""
    classes = [
        node for tree in trees.values() for node in tree.body if isinstance(node, ast.ClassDef)
    ]
    result, before = set(ROUTE_BASES), 0
    while len(result) > before:
        before = len(result)
        result |= {
            node.name
            for node in classes
            if result & {ast.unparse(base).partition("[")[0] for base in node.bases}
        }
    return (result - ROUTE_BASES) | ROUTE_TYPES


def route_checks(tree: ast.Module, types: set[str]) -> tuple[int, int]:
    """Return how often a module asks for the type of a route, and for its name or quantities."""
    by_type = by_text = 0
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "isinstance":
            asked = {n.id for n in ast.walk(node.args[1]) if isinstance(n, ast.Name)}
            by_type += bool(asked & types)
        elif isinstance(node, ast.MatchClass):
            by_type += ast.unparse(node.cls) in types
        elif isinstance(node, ast.Compare):
            texts = {n.value for n in ast.walk(node) if isinstance(n, ast.Constant)}
            by_text += bool(texts & ROUTE_QUESTIONS)
    return by_type, by_text


def watched(what: dict[str, str]) -> dict[str, int]:
    """Return what a command, or a function, imports and runs."""
    program = WATCH
    for name, text in what.items():
        program = program.replace(name, text)
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            [sys.executable, "-c", program, str(Path(folder, "report"))],
            env={**os.environ, "PYTHONPATH": str(SOURCE)},
            capture_output=True,
            text=True,
            check=True,
        )
    result: dict[str, int] = json.loads(done.stderr.splitlines()[-1])
    if result["code"]:
        raise SystemExit(f"it ended with {result['code']}:\n{done.stderr}")
    return result


def tests_collected() -> str:
    """Return how many tests pytest collects, those included that only `make slow` runs."""
    command = [
        sys.executable,
        "-m",
        "pytest",
        "--collect-only",
        "-q",
        "-m",
        "",
        "-p",
        "no:cacheprovider",
    ]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.strip().splitlines()[-1].partition(" tests")[0]


def words_of_docs() -> tuple[int, int]:
    """Return the words of all tracked pages of the documentation, and without their code blocks."""
    listed = ["git", "ls-files", "docs/*.md"]
    names = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    pages = [(ROOT / name).read_text(encoding="utf-8") for name in names.split()]
    prose = [re.sub(r"```.*?```", "", page, flags=re.DOTALL) for page in pages]
    return len(" ".join(pages).split()), len(" ".join(prose).split())


def table() -> Iterator[tuple[str, object]]:
    """Yield what is counted and the number."""
    known = sources()
    texts = {name: path.read_text(encoding="utf-8") for name, path in known.items()}
    trees = {name: ast.parse(text) for name, text in texts.items()}
    modules = {name for name, path in known.items() if path.name != "__init__.py"}
    yield from house(texts, trees)
    yield "lines in src", sum(text.count("\n") for text in texts.values())
    yield "lines of code", sum(lines_of_code(texts[name], tree) for name, tree in trees.items())
    texts_of = [len(lines_of_texts(tree)) for tree in trees.values()]
    yield "lines of docstrings and texts of fields", sum(texts_of)
    yield "files in src", len(known)
    yield "modules (files without __init__)", len(modules)
    users = importers(trees, known)
    yield "modules with exactly one importer", sum(len(users[name]) == 1 for name in modules)
    folders = Counter(known[name].parent for name in modules)
    for folder, count in folders.most_common(3):
        yield f"modules in {folder.relative_to(SOURCE)}", count
    types = route_types(trees)
    for room in UPPER:
        own = [tree for name, tree in trees.items() if name.startswith(f"{PACKAGE}.{room}")]
        by_type, by_text = (
            sum(match) for match in zip(*(route_checks(t, types) for t in own), strict=True)
        )
        yield f"{room}: isinstance and match on types of a route", by_type
        yield f"{room}: comparisons with the name or quantity of a route", by_text
    yield "public names at the top", len(importlib.import_module(PACKAGE).__all__)
    seen = watched(DEMO)
    yield "stickslip demo: modules imported", seen["imported"]
    yield "stickslip demo: modules with a function that ran", seen["modules"]
    yield "stickslip demo: functions that ran", seen["functions"]
    seen = watched(TABLE)
    yield "select on a friction table: modules that ran", seen["modules"]
    yield "select on a friction table: functions that ran", seen["functions"]
    yield "select on a friction table: frames to it", seen["frames"]
    yield "tests collected", tests_collected()
    words, prose = words_of_docs()
    yield "words of the documentation", words
    yield "words of the documentation without code blocks", prose


if __name__ == "__main__":
    for name, value in table():
        print(f"{name:62} {value}", flush=True)
