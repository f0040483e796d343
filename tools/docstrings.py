"""Check the numpydoc sections of functions and classes: python -m tools.docstrings.

What a page of the reference shows (the tables of `docs/`) has sections where it has two or more
arguments: Parameters and Returns (or Yields), and Raises if it raises something itself. Any other
function has none of these: a line that says why is enough inside, and an example where it helps.

Parameters, wherever they stand, have the names of the signature, in its order; each has a type and
says something. A public class tells the arguments of its `__init__` in a section Parameters, and
its fields there, in a text after each of them or in a `description` that a call such as pydantic's
`Field` is given. Overrides, properties and enumerations need none, nor do commands of the command
line, whose docstrings are their help. A public method has a docstring, on its class or on a class
that it overrides the method of. The exit code is 1 if anything is wrong.
"""

import ast
import functools
import importlib
import inspect
import re
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from numpydoc.docscrape import NumpyDocString
from tools import structure

TITLES = {"Parameters", "Returns", "Yields", "Raises"}
LEAST = 2
"""From this number of arguments on, sections are needed."""
SKIPPED_BASES = {"Enum", "IntEnum", "Flag", "Protocol", "TypedDict", "Exception"}
"""Classes without fields of their own."""

Sections = dict[str, list[str]]


def sections(text: str) -> Sections:
    """Return the names that each section of a docstring lists, by the title of the section."""
    with warnings.catch_warnings(record=True) as unknown:
        warnings.simplefilter("always")
        parsed = NumpyDocString(text)
    result = {title: [] for title, content in parsed.items() if content} | {
        "unknown": [str(item.message).splitlines()[0] for item in unknown]
    }
    for title in TITLES:
        for entry in parsed[title]:
            names = entry.name or entry.type  # a lone type is an exception, or what comes back
            result[title] += [name.strip().lstrip("*") for name in names.split(",")]
            if not entry.type or not "".join(entry.desc).strip():
                result["unknown"].append(f"{title} has no type or no word of {names}")
    return result


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
    for item, after in zip(node.body, [*node.body[1:], None], strict=True):
        if isinstance(item, structure.Function) and item.name == "__init__":
            own = structure.arguments(item, is_method=True)
            fields += own
            silent += own
            listed += sections(ast.get_docstring(item) or "").get("Parameters", [])
        if not isinstance(item, ast.AnnAssign) or "ClassVar" in ast.unparse(item.annotation):
            continue
        name = ast.unparse(item.target)
        has_text = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        has_text |= isinstance(item.value, ast.Call) and any(
            word.arg == "description" for word in item.value.keywords
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


def silent_methods(node: ast.ClassDef, module: str) -> Iterator[tuple[int, str]]:
    """Yield line and name of each public method that neither its class nor a base documents."""
    methods = [item for item in node.body if isinstance(item, structure.Function)]
    bare = [method for method in methods if method.name[0] != "_" and not ast.get_docstring(method)]
    if not bare or node.name.startswith("_"):
        return
    kind = getattr(importlib.import_module(module), node.name)
    for entry in bare:
        if not any(getattr(vars(base).get(entry.name), "__doc__", "") for base in kind.__mro__):
            yield entry.lineno, f"{node.name}.{entry.name}"


def members(found: object) -> Iterator[object]:
    """Yield a function, or the functions of a class and of its bases, as they were defined."""
    if not inspect.isclass(found):
        yield inspect.unwrap(found) if callable(found) else found
        return
    for base in found.__mro__:
        for value in vars(base).values():
            plain = value
            for name in ("__func__", "fget", "func", "__wrapped__"):
                plain = getattr(plain, name, plain)
            yield plain


@functools.cache
def shown() -> frozenset[tuple[str, str]]:
    """Return module and qualified name of each function and class that a page shows."""
    result: set[tuple[str, str]] = set()
    for page in sorted((structure.ROOT / "docs").rglob("*.md")):
        for name in names_of(page.read_text(encoding="utf-8")):
            whole = resolved(name)
            result |= {
                (member.__module__, member.__qualname__)
                for member in (whole, *members(whole))
                if inspect.isfunction(member) or inspect.isclass(member)
            }
    return frozenset(result)


def names_of(page: str) -> Iterator[str]:
    """Yield the full names in the tables of a page."""
    for block in re.split(r"^(?=\.\. |```)", page, flags=re.MULTILINE):
        kind, _, rest = block.partition("::")
        if kind == ".. currentmodule":
            module = rest.strip()
        elif kind == ".. autosummary":
            words = (line.strip() for line in rest.splitlines())
            yield from (f"{module}.{word}" for word in words if word and not word.startswith(":"))


def resolved(name: str) -> Any:
    """Return what a full name means; of a module and a function of one name, the function."""
    module, *inner = name.split(".")
    result: Any = importlib.import_module(module)
    for item in inner:
        if inspect.ismodule(result) and not hasattr(result, item):
            importlib.import_module(f"{result.__name__}.{item}")
        result = getattr(result, item)
    return getattr(result, name.rpartition(".")[2], result) if inspect.ismodule(result) else result


def faults(tree: ast.Module, module: str = "") -> Iterator[tuple[int, str, str]]:
    """Yield line, name and fault of each public function and class of a module.

    Without a name of the module all functions count as shown.
    """
    for name, function, arguments in structure.public_functions(tree):
        if "." in name and not ast.get_docstring(function):
            continue  # documented where it is declared, which `silent_methods` holds
        if not module or (module, name) in shown():
            result = [*of_function(function, arguments, needed=not is_command(function))]
        else:
            extra = TITLES & sections(ast.get_docstring(function) or "").keys()
            result = [f"section {item}, but no page shows it" for item in sorted(extra)]
        for fault in result:
            yield function.lineno, name, fault
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and (not module or (module, node.name) in shown()):
            for fault in of_class(node):
                yield node.lineno, node.name, fault
        if isinstance(node, ast.ClassDef) and module:
            for line, name in silent_methods(node, module):
                yield line, name, "no docstring, nor has what it overrides"


def of_modules(sources: Iterable[tuple[str, Path]]) -> Iterator[str]:
    """Yield a line for each fault in some modules."""
    for module, path in sources:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for line, name, fault in sorted(faults(tree, module)):
            yield f"{path.relative_to(structure.ROOT)}:{line}: {name}: {fault}"


if __name__ == "__main__":
    found = [*of_modules(structure.sources().items())]
    print(*found, sep="\n", end="\n" if found else "")
    raise SystemExit(bool(found))
