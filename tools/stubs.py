"""Write the `__init__.pyi` of packages whose names are loaded lazily: python tools/stubs.py.

Type checkers and editors do not run `__getattr__`. They read these stubs, and so do the packages:
where a name is stands there alone. What is registered, laws and mechanisms, is put in, and lines
are put in order.

Constructors of laws, mechanisms and drives take texts with units where they keep numbers. No type
of a dataclass's field says so: stubs declare such a class as a subclass with a constructor.
"""

import ast
import copy
import dataclasses
import importlib
import inspect
import sys
import textwrap
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from types import NoneType
from typing import Any, get_args

from stickslip import lazy

SOURCE = Path(__file__).resolve().parent.parent / "src"
PACKAGES = (
    "stickslip",
    "stickslip.data",
    "stickslip.data.catalogue",
    "stickslip.engine",
    "stickslip.engine.formulation",
    "stickslip.engine.solver",
    "stickslip.exports",
    "stickslip.friction",
    "stickslip.identify",
    "stickslip.identify.fits",
    "stickslip.identify.kinds",
    "stickslip.mechanisms",
    "stickslip.mechanisms.drives",
    "stickslip.paper",
    "stickslip.show",
    "stickslip.show.plots",
    "stickslip.show.report",
    "stickslip.study",
    "stickslip.study.control",
    "stickslip.study.optimisation",
    "stickslip.study.sweep",
)
EXTRA = {
    "stickslip": {"__version__": "str"},
    "stickslip.friction": {"LAW_MODULES": "dict[str, str]"},
    "stickslip.mechanisms": {"MECHANISM_MODULES": "dict[str, str]"},
}
"""Further names, which no module defines, with their types."""
CONSTRUCTED = (
    "stickslip.engine.solver",
    "stickslip.exports",
    "stickslip.friction",
    "stickslip.mechanisms",
    "stickslip.mechanisms.drives",
    "stickslip.study.control",
)
"""Packages of whose classes with quantities the constructors are declared."""
REGISTERED = {"friction": "LAW_MODULES", "mechanisms": "MECHANISM_MODULES"}
"""Tables of what is registered by its room, which the top of the package has as well."""
HEAD = (
    "# Where each name of the package is; `make stubs` puts lines in order and adds constructors."
)
EQUATIONS = {
    "states": "tuple[_Scalar, ...]",
    "rates": "tuple[_Scalar, ...]",
}
"""Types of arguments and results of the equations of laws that are no scalars."""
GIVEN = "stickslip.quantities", "Given"
"""Module and name of what a constructor takes for a number."""


def folder(package: str) -> Path:
    """Return the folder of a package."""
    return SOURCE.joinpath(*package.split("."))


def door(package: str) -> lazy.Door:
    """Return the names of a package with those of what is registered: laws and mechanisms."""
    importlib.import_module(package)
    result = lazy.Door(package)
    for room, table in REGISTERED.items():
        own = getattr(importlib.import_module(f"{PACKAGES[0]}.{room}"), table)
        if package == PACKAGES[0]:
            result.homes |= dict.fromkeys(own, f"{package}.{room}")
        elif package == f"{PACKAGES[0]}.{room}":
            result.homes |= {name: f"{package}.{home}" for name, home in own.items()}
        else:
            continue
        result.public = sorted({*result.public, *own})
    rooms = tuple(f"{PACKAGES[0]}.{room}" for room in REGISTERED)
    for name, home in [*result.homes.items()]:  # the stub may have what is registered no more
        if home.startswith(rooms) and not hasattr(importlib.import_module(home), name):
            del result.homes[name]
            result.public = [item for item in result.public if item != name]
    return result


def stub(package: str) -> str:
    """Return the text of the `__init__.pyi` of a package."""
    names = door(package)
    modules = defaultdict(list)
    for name, module in names.homes.items():
        modules[module].append(name)
    extra = EXTRA.get(package, {})
    homes = sorted(names.homes.items()) if package in CONSTRUCTED else ()
    kinds = [getattr(importlib.import_module(home), name) for name, home in homes]
    made = [kind for kind in kinds if has_quantities(kind)]
    built = [Declaration(item, made) for item in made]
    own = {item.name for item in built}
    needed = {(m, n, alias) for item in built for alias, (m, n) in item.imports.items()}
    lines = [
        HEAD,
        *(["from dataclasses import dataclass", ""] if built else []),
    ]
    lines += sorted(
        [
            *(
                f"from {module} import {name} as {name}"
                for module in modules
                for name in modules[module]
                if name not in own
            ),
            *(f"from {module} import {name} as {alias}" for module, name, alias in needed),
            *(f"from {package} import {name} as {name}" for name in names.namespaces),
        ]
    )
    lines += ["", *(f"{name}: {kind}\n" for name, kind in extra.items())]
    lines += [line for item in built for line in item.lines()]
    lines += ["__all__ = [", *(f'    "{name}",' for name in names.public), "]", ""]
    return "\n".join(lines)


def has_quantities(found: object) -> bool:
    """Whether a class has fields that are numbers with a unit, and is made by users."""
    from stickslip.quantities import Parametrised, fields_of

    if not (inspect.isclass(found) and issubclass(found, Parametrised)):
        return False
    return bool(fields_of(found)) and not inspect.isabstract(found)


@cache
def imported(module: str) -> Mapping[str, tuple[str, str]]:
    """Return module and name of what a module imports or defines, by the name it has there."""
    tree = ast.parse(inspect.getsource(sys.modules[module]))
    result = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            result |= {name.asname or name.name: (node.module, name.name) for name in node.names}
    for node in tree.body:
        match node:
            case ast.ClassDef(name=name) | ast.AnnAssign(target=ast.Name(id=name)):
                result[name] = module, name
            case ast.Assign(targets=[ast.Name(id=name)]):
                result[name] = module, name
    return result


def spelt(hint: object) -> str:
    """Return the type of a parameter without what it is annotated with."""
    return "float | None" if NoneType in get_args(hint) else "float"


@cache
def annotations(kind: type) -> Mapping[str, ast.expr]:
    """Return the annotations of the fields that a class declares itself."""
    if kind is object:
        return {}
    if composition_of(kind) is not None:
        return {
            name: ast.parse(spelt(field.hint), mode="eval").body
            for name, field in composition_of(kind).fields.items()
        }
    tree = ast.parse(textwrap.dedent(inspect.getsource(kind))).body[0]
    assert isinstance(tree, ast.ClassDef)
    return {
        node.target.id: node.annotation
        for node in tree.body
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    }


def composition_of(kind: type) -> Any:
    """Return what a law is composed of: no source has its fields. None of other classes."""
    return getattr(kind, "made_of", None)


def fields_with_owners(kind: type) -> Iterator[tuple[dataclasses.Field[object], type]]:
    """Yield each field with the class that declares it."""
    for field in dataclasses.fields(kind):  # type: ignore[arg-type]  # a dataclass
        yield field, next(item for item in kind.__mro__ if field.name in annotations(item))


def held_by(kind: type, made: Sequence[type]) -> list[str]:
    """Return the fields of a class whose types name one of those that are declared anew."""
    known = {(item.__module__, item.__name__) for item in made}
    return [
        field.name
        for field, owner in fields_with_owners(kind)
        if any(
            imported(owner.__module__).get(node.id) in known
            for node in ast.walk(annotations(owner)[field.name])
            if isinstance(node, ast.Name)
        )
    ]


class Declaration:
    """A class as stubs declare it, with all that its types name."""

    def __init__(self, kind: type, made: Sequence[type]) -> None:
        self.name = kind.__name__
        self.base = f"_{self.name}"
        self.imports = {self.base: (kind.__module__, self.name)}
        self.attributes = []
        for field, owner in fields_with_owners(kind):
            if field.name in held_by(kind, made):
                public = Renamed(owner.__module__, {}, made)
                text = ast.unparse(public.visit(copy.deepcopy(annotations(owner)[field.name])))
                self.imports |= public.imports
                self.attributes.append(f"{field.name}: {text}{default_of(field)}")
        self.parameters = list(self._parameters(kind))
        self.methods: list[str] = []
        if composition_of(kind) is None:
            self.methods += self._methods(kind)
        else:
            self._compose(kind)

    def _parameters(self, kind: type) -> Iterator[str]:
        from stickslip.quantities import fields_of

        self.imports["_Given"] = GIVEN
        for field, owner in fields_with_owners(kind):
            if not field.init:
                continue
            annotation = annotations(owner)[field.name]
            spelt = ast.unparse(annotation)
            if field.name in fields_of(kind) and "[int" not in spelt:
                text = "_Given | None" if "None" in spelt else "_Given"
            elif field.name in fields_of(kind):
                text = "int"
            else:
                text = self._spelt(annotation, owner)
            yield f"{field.name}: {text}{default_of(field)}"

    def _methods(self, kind: type) -> Iterator[str]:
        """Yield the class methods that make an object."""
        (tree,) = ast.parse(textwrap.dedent(inspect.getsource(kind))).body
        assert isinstance(tree, ast.ClassDef)
        for node in tree.body:
            if not isinstance(node, ast.FunctionDef) or node.returns is None:
                continue
            if ast.unparse(node.returns) != "Self" or not node.decorator_list:
                continue
            taken = [
                f"{option.arg}: {self._spelt(option.annotation, kind)}{' = ...' if default else ''}"
                for option, default in zip(node.args.options, node.args.kw_defaults, strict=True)
                if option.annotation is not None
            ]
            self.imports["_override"] = "typing_extensions", "override"
            yield "    @classmethod"
            yield "    @_override"
            yield f"    def {node.name}("
            yield "        cls,"
            yield "        *,"
            yield from (f"        {item}," for item in taken)
            yield f"    ) -> {self.name}: ..."

    def _compose(self, kind: type) -> None:
        """Declare fields and equations, which a composition makes, on the class that it is of."""
        (base,) = kind.__bases__
        self.base = f"_{base.__name__}"
        self.imports = {"_Given": GIVEN, self.base: (base.__module__, base.__name__)}
        self.imports |= {"_Scalar": ("stickslip.maths", "Scalar")}
        self.imports |= {"_override": ("typing_extensions", "override")}
        for name, field in composition_of(kind).fields.items():
            has = getattr(kind, name, dataclasses.MISSING) is not dataclasses.MISSING
            self.attributes.append(f"{name}: {spelt(field.hint)}{' = ...' if has else ''}")
        for name in sorted(getattr(base, "__abstractmethods__", ())):
            asked = list(inspect.signature(getattr(base, name)).parameters)[1:]
            taken = "".join(f", {item}: {EQUATIONS.get(item, '_Scalar')}" for item in asked)
            taken += " = ..." * (name == "force")
            gives = EQUATIONS.get(name, "_Scalar")
            self.methods += ["    @_override", f"    def {name}(self{taken}) -> {gives}: ..."]

    def _spelt(self, annotation: ast.expr, owner: type) -> str:
        return ast.unparse(
            Renamed(owner.__module__, self.imports, ()).visit(copy.deepcopy(annotation))
        )

    def lines(self) -> Iterator[str]:
        """Yield the declaration of a subclass with the constructor."""
        yield "@dataclass(frozen=True, kw_only=True, init=False)"
        yield f"class {self.name}({self.base}):"
        yield from (f"    {attribute}" for attribute in self.attributes)
        yield "    def __init__("
        yield "        self,"
        yield "        *,"
        yield from (f"        {parameter}," for parameter in self.parameters)
        yield "    ) -> None: ..."
        yield from self.methods
        yield ""


def default_of(field: dataclasses.Field[object]) -> str:
    """Return how a stub says that a field has a default."""
    missing = dataclasses.MISSING
    has = field.default is not missing or field.default_factory is not missing
    return " = ..." if has else ""


class Renamed(ast.NodeTransformer):
    """Names of a module by private ones, which a stub imports."""

    def __init__(
        self, module: str, imports: dict[str, tuple[str, str]], public: Sequence[type]
    ) -> None:
        self.module, self.imports = module, imports
        self.public = {(item.__module__, item.__name__) for item in public}

    def visit_Name(self, node: ast.Name) -> ast.Name:
        """Rename what is not built in."""
        known = imported(self.module)
        if node.id not in known or known[node.id] in self.public:
            return node
        self.imports[f"_{node.id}"] = known[node.id]
        return ast.Name(id=f"_{node.id}", ctx=node.ctx)

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        """Leave the texts of a literal as they are."""
        if ast.unparse(node.value) == "Literal":
            return ast.Subscript(self.visit(node.value), node.slice, node.ctx)
        return self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        """Read what stands in quotes."""
        if isinstance(node.value, str):
            result: ast.expr = self.visit(ast.parse(node.value, mode="eval").body)
            return result
        return node


def renew() -> None:
    """Write all stubs, or nothing."""
    written = {folder(item) / "__init__.pyi": stub(item) for item in PACKAGES}
    for path, text in written.items():
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    try:
        renew()
    except ValueError as error:  # of the package: what an entry says is wrong
        sys.exit(f"{error} Nothing was written.")
