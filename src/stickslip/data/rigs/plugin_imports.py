"""Classes that a rig file names by import path; nothing is imported unless the user allows it."""

import importlib
import re
import sys
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

from stickslip.data.rigs.rig_models import RigFile
from stickslip.errors import InputError, concerning
from stickslip.friction import FrictionLaw, curves_beside, is_composition, law_type, laws
from stickslip.mechanisms import Mechanism

_PATH = re.compile(r"(?P<module>[^\W\d]\w*(\.[^\W\d]\w*)*):(?P<name>[^\W\d]\w*)")


@dataclass(frozen=True)
class Imported:
    """What was imported for one file."""

    mechanism: tuple[str, type[Mechanism]] | None = None
    """Its import path and the class."""
    laws: Mapping[str, type[FrictionLaw]] = field(default_factory=dict)
    """By name."""
    tables: Mapping[str, str] = field(default_factory=dict)
    """Paths of tables of laws by those that the file calls them."""


def imported(raw: dict[str, Any], file: RigFile, *, beside: Path | None, allow: bool) -> Imported:
    """Import what the tables name by import path, and take those names of laws out of them."""
    wanted = dict(_wanted(raw))
    for key, path in wanted.items():
        where = f"{file.place(key)}: {key}"
        match = _PATH.fullmatch(path)
        if match is None:
            raise InputError(
                f"{where} must be a name, or module:Class such as my_module:MyClass, got {path!r}."
            )
        if not allow:
            raise InputError(
                f"{where} requests the import of {match['name']} from the Python module"
                f" {match['module']}, which runs its code. Nothing was imported. If you trust it,"
                " give --allow-import on the command line or load_rig(..., allow_import=True)."
            )
    found = {key: _class(path, f"{file.place(key)}: {key}", beside) for key, path in wanted.items()}
    mechanism = found.pop("mechanism.type", None)
    own: dict[str, type[FrictionLaw]] = {}
    tables: dict[str, str] = {}
    for where, table, law in _composed(raw, file, beside):
        tables[f"{where}.{table}"] = f"{where}.{law.name}"
        if law.name not in laws():
            own[law.name] = law
    for key, kind in found.items():
        *above, table, _ = key.split(".")
        _check_name(kind, table, f"{file.place(key)}: {key}")
        holder = raw
        for step in above:
            holder = holder[step]
        del holder[table]["type"]
        own[table] = kind
    given = None if mechanism is None else (wanted["mechanism.type"], mechanism)
    return Imported(given, own, tables)


def _composed(
    raw: dict[str, Any], file: RigFile, beside: Path | None
) -> Iterator[tuple[str, str, type[FrictionLaw]]]:
    """Put tables of composed laws under the names of these; yield where, both names and law."""
    friction = raw.get("friction")
    if not isinstance(friction, dict):
        return
    inner = {f"friction.{key}": item for key, item in friction.items() if isinstance(item, dict)}
    if "law" in friction:  # its values are shared ones
        kind = _law(friction.pop("law"), f"{file}: friction", beside)
        friction.setdefault(kind.name, {})
        yield "friction", kind.name, kind
    for above, tables in {"friction": friction, **inner}.items():  # one contact, or several
        for name, table in list(tables.items()):
            if not isinstance(table, dict):
                continue
            named_by = is_composition(name) and not name.isidentifier()  # not a contact "ramp"
            text = table.pop("law", name if named_by else None)
            if text is None:
                continue
            where = f"{file}: {above}.{name}"
            kind = _law(text, where, beside)
            if laws().get(name, kind) is not kind:
                raise InputError(
                    f"{where} has the name of another law than its law = {text!r}: rename the"
                    f" table, such as [{above}.own], or leave law out."
                )
            other = tables.pop(kind.name, {}) if kind.name != name else {}
            if any(f"{above}.{kind.name}.{key}" not in file.overridden for key in other):
                raise InputError(
                    f"{where} is the law {kind.name}, which has a table already: leave one out."
                )
            tables[kind.name] = tables.pop(name) | other
            yield above, name, kind


def _law(text: object, where: str, beside: Path | None) -> type[FrictionLaw]:
    """Return the law of a table."""
    if not isinstance(text, str):
        raise InputError(f"{where}.law must be a text such as 'level + viscous', got {text!r}.")
    with concerning(f"{where}:", InputError):
        return law_type(text if beside is None else curves_beside(text, beside))


def _wanted(raw: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the keys under which import paths stand."""
    mechanism, friction = raw.get("mechanism"), raw.get("friction")
    tables = {"mechanism": mechanism}
    if isinstance(friction, dict):
        tables |= {f"friction.{name}": table for name, table in friction.items()}
        tables |= {  # the laws of one of several contacts
            f"friction.{contact}.{name}": table
            for contact, inner in friction.items()
            if isinstance(inner, dict)
            for name, table in inner.items()
        }
    for name, table in tables.items():
        path = table.get("type") if isinstance(table, dict) else None
        if isinstance(path, str) and ":" in path:
            yield f"{name}.type", path


def _class(path: str, where: str, beside: Path | None) -> Any:
    """Import a class and check that it is one of which objects can be made."""
    module, _, name = path.partition(":")
    found = getattr(_module(module, where, beside), name, None)
    if found is None:
        raise InputError(f"{where}: the module {module} has no {name}.")
    base: type = Mechanism if where.endswith("mechanism.type") else FrictionLaw
    if not (isinstance(found, type) and issubclass(found, base)):
        raise InputError(
            f"{where}: {path} must be a class derived from stickslip.{base.__name__},"
            f" got {found!r}."
        )
    missing = ", ".join(_missing(found, base))
    if missing:
        raise InputError(f"{where}: {path} is abstract: implement {missing}.")
    return found


def _missing(kind: type, base: type) -> list[str]:
    """Return what a class has yet to define or to say of itself."""
    required: tuple[str, ...] = ("name", "coordinates", "rates", "units")
    if base is FrictionLaw:
        required = ("name", "title", "formula", "sources")
    abstract: Collection[str] = getattr(kind, "__abstractmethods__", ())
    return [*sorted(abstract), *(name for name in required if not hasattr(kind, name))]


def _module(name: str, where: str, beside: Path | None) -> ModuleType:
    """Import a module, from beside the rig file too."""
    folder = None if beside is None else str(beside.resolve())
    if folder is not None and folder not in sys.path:
        # at the end, so that no file there hides another module; it stays for worker processes
        sys.path.append(folder)
        importlib.invalidate_caches()
    try:
        module = importlib.import_module(name)
    except (Exception, SystemExit) as error:  # a module of somebody else may raise anything
        raise InputError(
            f"{where}: the module {name} cannot be imported: {type(error).__name__}: {error}."
            " Modules are searched for on Python's path and in the folder of the rig file."
        ) from error
    _check_is_the_one_beside(module, where, folder)
    return module


def _check_is_the_one_beside(module: ModuleType, where: str, folder: str | None) -> None:
    """Check that another module does not hide the one in the folder of the rig file."""
    if folder is None:
        return
    stem = Path(folder, *module.__name__.split("."))
    for own in (stem.with_suffix(".py"), stem / "__init__.py"):
        actual = getattr(module, "__file__", None) or "none"
        if own.exists() and Path(actual).resolve() != own.resolve():
            raise InputError(
                f"{where}: {own} is shadowed by a module of the same name, {actual}. Rename it."
            )


def _check_name(law: type[FrictionLaw], table: str, where: str) -> None:
    """Check that a law stands under its name, which no other law has."""
    if law.name != table:
        raise InputError(
            f"{where}: the law {law.__name__} is named {law.name!r}: write [friction.{law.name}]."
        )
    if laws().get(table, law) is not law:
        raise InputError(
            f"{where}: {table!r} is already the name of another law; give {law.__name__}.name"
            " another value."
        )
