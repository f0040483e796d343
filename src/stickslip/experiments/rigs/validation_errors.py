"""Turns what pydantic finds into one message in the words of the file."""

from collections.abc import Collection, Mapping
from typing import Any

from pydantic import ValidationError

from stickslip.errors import InputError, ParameterError, UnknownNameError, nearest
from stickslip.experiments.readers.toml import paths_of
from stickslip.experiments.rigs.rig_models import ITS_TABLE
from stickslip.units import shown

_WANTED = {
    "model_type": "must be a table",
    "model_attributes_type": "must be a table",
    "dict_type": "must be a table",
    "list_type": "must be a list of tables",
    "string_type": "must be text in quotes",
    "bool_type": "must be true or false",
    "too_short": "must not be an empty list: leave it out or fill it",
}


def place(key: str, file: str, overridden: Collection[str]) -> str:
    """Return where a key was given: the file, or an override of it."""
    own = any(key == path or key.startswith(path + ".") for path in overridden)
    return f"override of {file}" if own else file


def complaint(
    error: ValidationError,
    raw: Mapping[str, Any],
    file: str,
    overridden: Collection[str],
    called: Mapping[str, str],
) -> InputError:
    """Return the error to raise: the first that was found, unknown keys before all others."""
    found = error.errors(include_url=False)
    found.sort(key=lambda one: one["type"] not in {"unknown_key", "misplaced"})
    first: Mapping[str, Any] = found[0]
    key, value = _as_called(_key(first["loc"], raw), called), first["input"]
    overridden = [_as_called(path, called) for path in overridden]
    context = first.get("ctx", {})
    kind = first["type"]
    where = place(key, file, overridden)
    if kind == "unknown_key":
        full = _join(key, context["key"])
        # An override may have made a whole table that is not known.
        made = any(path.startswith(full + ".") for path in overridden)
        where = place(full, file, [*overridden, full] if made else overridden)
        table = f" in {_heading(key)}" if key else ""
        known = context["known"]
        of_law = key.partition(".")[0] == "friction" and isinstance(context["value"], dict)
        if of_law and not nearest(context["key"], known):
            return InputError(
                f"{where}: [{full}] has the name of no law or contact: add law = "
                f'"level + viscous", or another one, under [{full}].'
            )
        if not key and context["key"] in overridden:  # the end of a path, perhaps
            ends = {path.rpartition(".")[2] for path in paths_of(raw)} - {context["key"]}
            known = ends if nearest(context["key"], ends) else known
        return UnknownNameError(f"key{table} of {where}:", context["key"], known)
    if kind == "unknown_name":
        owner = f"{context['kind']} in {key} of {where}:"
        return UnknownNameError(owner, context["key"], context["known"])
    if kind == "union_tag_invalid":
        known = [tag.strip(" '") for tag in context["expected_tags"].split(",")]
        return UnknownNameError(f"{key}.type in {where}:", context["tag"], known)
    if kind == "union_tag_not_found":
        return ParameterError(f'{where}: {key}.type is missing. Add type = "..." under [{key}].')
    if kind == "missing_key":
        return ParameterError(_missing(where, key, context))
    if kind == "misplaced":
        return ParameterError(f"{where}: {_join(key, context['key'])}: {context['cure']}.")
    if kind == "value_error":
        text = str(context["error"]).replace(ITS_TABLE, key.rpartition(".")[0])
        return ParameterError(f"{where}: {key} {text}")
    wanted = _WANTED.get(kind)
    if kind == "literal_error":
        wanted = f"must be {context['expected']}"
    if wanted is None:
        wanted = first["msg"]
    return ParameterError(f"{where}: {key or 'the file'} {wanted}, got {shown(value)}.")


def _as_called(key: str, called: Mapping[str, str]) -> str:
    """Return a key with the name that the file gives its table."""
    own = next((path for path in called if f"{key}.".startswith(f"{path}.")), None)
    return key if own is None else called[own] + key.removeprefix(own)


def _missing(where: str, key: str, context: Mapping[str, Any]) -> str:
    name, quantity = context["key"], context["quantity"]
    under = f"under {_heading(key)}" if key else "at the top of the file"
    full = _join(key, name)
    if quantity is None:
        table = name in {"mechanism", "run", "friction"}
        return f"{where}: {full} is missing. Add {f'[{name}]' if table else f'{name} {under}'}."
    return f"{where}: {full} ({quantity.symbol}) is missing. Add {name} {under}, {quantity.range}."


def _heading(key: str) -> str:
    """Return how a table is written in the file; entries of a list are counted from 1."""
    table, _, last = key.rpartition(".")
    return f"[[{table}]] number {int(last) + 1}" if last.isdecimal() else f"[{key}]"


def _join(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name


def _has(node: Any, step: int | str) -> bool:
    if isinstance(node, list):
        return isinstance(step, int) and step < len(node)
    return isinstance(node, dict) and step in node


def _key(loc: tuple[int | str, ...], raw: Any) -> str:
    """Return the dotted key in the file; pydantic adds type names and indices of its own."""
    parts: list[str] = []
    node = raw
    for step in loc:
        if _has(node, step):
            node = node[step]
        elif " " in str(step) or (  # which of several kinds, in words
            isinstance(node, dict) and (isinstance(step, int) or node.get("type") == step)
        ):
            continue
        parts.append(str(step))
    return ".".join(parts)
