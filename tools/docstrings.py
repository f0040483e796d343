"""Check the numpydoc sections of public functions and classes: python -m tools.docstrings.

In the subpackages listed here, a public function or method of two or more arguments has sections
Parameters and Returns (or Yields), and Raises if it raises something itself. Parameters, wherever
they stand, have the names of the signature, in its order; each has a type and says something. A
public class tells the arguments of its `__init__` in a section Parameters, and its fields there, in
a text after each of them or in a `description` that a call such as pydantic's `Field` is given.
Overrides, properties and enumerations need none, nor do commands of the command line, whose
docstrings are their help.

Kernels have a hundred functions that only kernels call: of these, what is in `__all__` needs the
sections. The docstring of each says which slots of the vectors it reads and writes, as
`tools/slots.py` finds them. The exit code is 1 if anything is missing.
"""

import ast
import re
import sys
import warnings
from collections.abc import Iterable, Iterator

from numpydoc.docscrape import NumpyDocString
from tools import slots, structure

SUBPACKAGES = (
    "adapters",
    "catalogue",
    "cli",
    "control",
    "formatting",
    "documents",
    "drives",
    "errors",
    "experiments",
    "exports",
    "formulation",
    "friction",
    "identification",
    "kernels",
    "lazy",
    "maths",
    "mechanisms",
    "optimisation",
    "paper",
    "plots",
    "quantities",
    "report",
    "routes",
    "selection",
    "simulation",
    "solver",
    "sweep",
    "testing",
    "trajectory",
)
"""Subpackages that are checked; the others follow one by one."""
INSIDE = (
    "stickslip.friction.classes",
    "stickslip.friction.composition",
    "stickslip.friction.containment",
    "stickslip.friction.equations",
    "stickslip.friction.formulas",
    "stickslip.friction.named",
    "stickslip.friction.notation",
    "stickslip.friction.parts",
    "stickslip.friction.text",
)
"""Modules that users do not call: a summary line is enough there."""
TITLES = ("Parameters", "Returns", "Yields", "Raises")
LEAST = 2
"""From this number of arguments on, sections are needed."""
SKIPPED_BASES = {"Enum", "IntEnum", "Flag", "Protocol", "TypedDict", "Exception"}
"""Classes without fields of their own."""

SLOTS = re.compile(r"^(?:Reads|Writes): [^.]*\.", re.MULTILINE)

Sections = dict[str, list[str]]


def sections(text: str) -> Sections:
    """Return the names that each section of a docstring lists, by the title of the section."""
    with warnings.catch_warnings(record=True) as unknown:
        warnings.simplefilter("always")
        parsed = NumpyDocString(text)
    found = {title: [] for title, content in parsed.items() if content} | {
        "unknown": [str(one.message).splitlines()[0] for one in unknown]
    }
    for title in TITLES:
        for entry in parsed[title]:
            names = entry.name or entry.type  # a lone type is an exception, or what comes back
            found[title] += [name.strip().lstrip("*") for name in names.split(",")]
            if not entry.type or not "".join(entry.desc).strip():
                found["unknown"].append(f"{title} has no type or no word of {names}")
    return found


def raised(function: structure.Function) -> Iterator[str]:
    """Yield the names of the exceptions that a function raises itself."""
    inner: list[ast.AST] = list(function.body)
    while inner:
        node = inner.pop()
        if isinstance(node, ast.Raise) and node.exc is not None:
            made = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
            name = ast.unparse(made).rpartition(".")[2]
            if name[0].isupper() and name != "NotImplementedError":
                yield name
        if not isinstance(node, structure.Function | ast.ClassDef | ast.Lambda):
            inner += ast.iter_child_nodes(node)


def is_command(function: structure.Function) -> bool:
    """Return whether a decorator makes a function a command.

    It is one such as ``@app.command()`` or ``@command(app, "show")``.
    """
    calls = [mark.func for mark in function.decorator_list if isinstance(mark, ast.Call)]
    names = (
        call.attr if isinstance(call, ast.Attribute) else getattr(call, "id", "") for call in calls
    )
    return "command" in names


def answers(function: structure.Function) -> bool:
    """Return whether a function gives something back."""
    return function.returns is not None and ast.unparse(function.returns) not in {
        "None",
        "NoReturn",
        "Never",
    }


def of_function(
    function: structure.Function, arguments: list[str], *, needed: bool
) -> Iterator[str]:
    """Yield what is wrong with the docstring of a function, and what it lacks that is needed."""
    told = sections(ast.get_docstring(function) or "")
    yield from told["unknown"]
    if "Parameters" in told:
        yield from differing(told["Parameters"], arguments)
    if len(arguments) < LEAST or not needed:
        return
    if "Parameters" not in told:
        yield f"no section Parameters ({', '.join(arguments)})"
    if answers(function) and not {"Returns", "Yields"} & told.keys():
        yield "no section Returns or Yields"
    for name in sorted(set(raised(function)) - set(told.get("Raises", ()))):
        yield f"no {name} in a section Raises"


def differing(told: list[str], asked: list[str]) -> Iterator[str]:
    """Yield how the names of a section differ from those of the signature."""
    if told != asked:
        yield f"Parameters are {', '.join(told)} instead of {', '.join(asked)}"


def of_class(node: ast.ClassDef) -> Iterator[str]:
    """Yield what is wrong with the docstrings of a class and of its fields."""
    told = sections(ast.get_docstring(node) or "")
    yield from told["unknown"]
    bases = {ast.unparse(base).partition("[")[0].rpartition(".")[2] for base in node.bases}
    if bases & SKIPPED_BASES:
        return
    listed = told.get("Parameters", []) + told.get("Attributes", [])
    fields, silent = [], []
    for one, after in zip(node.body, [*node.body[1:], None], strict=True):
        if isinstance(one, structure.Function) and one.name == "__init__":
            own = structure.arguments(one, is_method=True)
            fields += own
            silent += own
            listed += sections(ast.get_docstring(one) or "").get("Parameters", [])
        if not isinstance(one, ast.AnnAssign) or "ClassVar" in ast.unparse(one.annotation):
            continue
        name = ast.unparse(one.target)
        has_text = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        has_text |= isinstance(one.value, ast.Call) and any(
            word.arg == "description" for word in one.value.keywords
        )
        if not name.startswith("_"):
            fields.append(name)
            silent += [] if has_text else [name]
    inherited = bool(bases)  # a section may also tell what a base class asks for
    for name in silent:
        if name not in listed:
            yield f"no word on {name}"
    for name in told.get("Parameters", ()):
        if name not in fields and not inherited:
            yield f"Parameters have {name}, which the class has not"


def listed(tree: ast.Module) -> set[str]:
    """Return what a module lists as public."""
    return {
        name
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
        for name in ast.literal_eval(node.value)
    }


def of_kernel(name: str, function: structure.Function) -> Iterator[str]:
    """Yield the lists of slots that a docstring lacks, and those that are wrong."""
    told = [" ".join(text.split()) for text in SLOTS.findall(ast.get_docstring(function) or "")]
    if told != slots.lines(name):
        yield f"slots are {' '.join(told) or 'not told'}; it should say {slots.lines(name)}"


def faults(tree: ast.Module, *, kernel: bool = False) -> Iterator[tuple[int, str, str]]:
    """Yield line, name and fault of each public function and class of a module."""
    public = listed(tree) if kernel else set()
    for name, function, arguments in structure.public_functions(tree):
        needed = name in public if kernel else not is_command(function)
        found = [*of_function(function, arguments, needed=needed)]
        if kernel and name in slots.kernels():
            found += of_kernel(name, function)
        for fault in found:
            yield function.lineno, name, fault
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for fault in of_class(node):
                yield node.lineno, node.name, fault


def of_subpackages(subpackages: Iterable[str]) -> Iterator[str]:
    """Yield a line for each fault in some subpackages."""
    for module, path in structure.sources().items():
        subpackage = module.partition(".")[2].partition(".")[0]
        if subpackage in subpackages and not module.startswith(INSIDE):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            for line, name, fault in sorted(faults(tree, kernel=subpackage == "kernels")):
                yield f"{path.relative_to(structure.ROOT)}:{line}: {name}: {fault}"


if __name__ == "__main__":
    subpackages = sys.argv[1:] or SUBPACKAGES
    known = {module.partition(".")[2].partition(".")[0] for module in structure.sources()}
    if not known.issuperset(subpackages):
        raise SystemExit(f"no subpackages: {', '.join(sorted({*subpackages} - known))}")
    found = [*of_subpackages(subpackages)]
    print(*found, sep="\n", end="\n" if found else "")
    raise SystemExit(bool(found))
