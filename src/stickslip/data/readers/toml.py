"""Reads TOML files and puts overrides into them."""

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeVar

from stickslip.data.tolerances import DEEPEST
from stickslip.errors import InputError

T = TypeVar("T")

_PART = r"""(?:[\w-]++|"(?:[^"\\\n]|\\[^\n])*+"|'[^'\n]*+')"""
_DEEP_KEY = re.compile(
    rf"(?:^|[\[{{,])[ \t]*+(?:{_PART}[ \t]*+\.[ \t]*+){{{DEEPEST}}}", re.MULTILINE | re.ASCII
)


def read_bytes(path: str | Path, *, largest: int | None = None) -> bytes:
    """Return the contents of a regular file, or say why it cannot be read."""
    check_file(path, largest=largest)
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}.") from None


def packaged(name: str) -> dict[str, Any]:
    """Return a table that comes with the readers."""
    return tomllib.loads(files("stickslip.data.readers").joinpath(name).read_text("utf-8"))


def check_path(path: object) -> None:
    """Check that something may name a file."""
    if not isinstance(path, str | Path):
        raise InputError(f"A path must be text or a Path, got {path!r}.")


def check_file(path: str | Path, *, largest: int | None = None) -> None:
    """Check that a file is there, is a file, and is neither empty nor too large."""
    check_path(path)
    try:
        size = Path(path).stat().st_size
        regular, folder = Path(path).is_file(), Path(path).is_dir()
    except FileNotFoundError:
        raise InputError(f"{path} does not exist. {_siblings(Path(path))}") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{str(path)!r}: cannot be read: {reason}.") from None
    if folder:
        raise InputError(f"{str(path)!r} is a folder: give the path of a file.")
    if not regular:
        raise InputError(f"{str(path)!r} is not a regular file.")
    if largest is not None and size > largest:
        raise InputError(
            f"{path}: is {size / 1e6:.0f} MB; a rig file may be at most"
            f" {largest / 1e6:.0f} MB. Store long records in a CSV or Parquet file."
        )
    if size == 0:
        needs = " A rig file needs at least [mechanism]." if Path(path).suffix == ".toml" else ""
        raise InputError(f"{path}: is empty.{needs}")


def _siblings(path: Path) -> str:
    try:
        same = sorted(file.name for file in path.parent.iterdir() if file.suffix == path.suffix)
    except OSError:
        return f"The folder {path.parent} does not exist either."
    if not same:
        return "Check the path."
    more = "" if len(same) <= 5 else f" and {len(same) - 5} more"
    return f"Files in {str(path.parent)!r}: {', '.join(same[:5])}{more}."


def decode(data: bytes, file: str) -> str:
    """Return text from UTF-8, or the line at which it is none."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"{file}: is not UTF-8 (byte 0x{data[error.start]:02x} in line {line})."
            " Save it as UTF-8."
        ) from None


def parse(data: bytes, file: str) -> dict[str, Any]:
    """Return the tables of a TOML file."""
    text, tables = decode(data, file), None
    try:
        if not _DEEP_KEY.search(text):
            tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{file}: is not valid TOML: {error}.") from None
    except RecursionError:
        pass
    except ValueError:
        raise InputError(
            f"{file}: has a number that cannot be read: it has too many digits."
        ) from None
    if tables is None or _is_deep(tables):
        raise InputError(f"{file}: its tables are nested too deeply.")
    if not tables:
        raise InputError(f"{file}: has no tables; a rig needs at least [mechanism].")
    return tables


def _is_deep(tables: dict[str, Any]) -> bool:
    """Whether functions that call themselves would not get to the end of tables."""
    level: list[Any] = [tables]
    for _ in range(DEEPEST):
        lists = (node.values() if isinstance(node, dict) else node for node in level)
        level = [inner for nodes in lists for inner in nodes if isinstance(inner, dict | list)]
        if not level:
            return False
    return True


def apply(tables: dict[str, Any], overrides: Mapping[Any, object]) -> None:
    """Put values given by dotted path into the tables.

    Examples
    --------
    >>> tables = {"run": {"t_end": 1.0}}
    >>> apply(tables, {"run.t_end": "5 s", "mechanism.attached": "true"})
    >>> tables
    {'run': {'t_end': '5 s'}, 'mechanism': {'attached': True}}
    """
    for path, value in overrides.items():
        is_text = isinstance(path, str) and not re.search("[\ud800-\udfff]", path)
        steps = path.split(".") if is_text else []
        if not steps or not all(steps) or len(steps) > DEEPEST:
            raise InputError(
                f"override {path!r}: must be a dotted path such as mechanism.mass, with a value."
            )
        node: Any = tables
        for index, step in enumerate(steps[:-1]):
            node = _below(node, step, ".".join(steps[: index + 1]), path)
        _place(node, steps[-1], _value(value), path)


def resolved(
    tables: Mapping[str, Any], overrides: Mapping[Any, T], known: Iterable[str]
) -> dict[Any, T]:
    """Return overrides by full path, where the end of a path was given that only one has.

    What is no end of a known path is left as it is.

    Examples
    --------
    >>> resolved({"mechanism": {"mass": 1.0}}, {"mass": 2, "t_end": 3}, ["run.t_end"])
    {'mechanism.mass': 2, 'run.t_end': 3}
    """
    paths = dict.fromkeys((*paths_of(tables), *known))
    firsts = {path.partition(".")[0] for path in paths}
    result: dict[Any, T] = {}
    for path, value in overrides.items():
        ends = [full for full in paths if full.endswith(f".{path}")]
        if path in paths or str(path).partition(".")[0] in firsts or not ends:
            ends = [path]
        if len(ends) > 1:
            raise InputError(
                f"override {path!r}: several paths end so, {', '.join(ends)}: give one of them."
            )
        result[ends[0]] = value
    return result


def paths_of(node: Any, prefix: str = "") -> Iterator[str]:
    """Yield the paths of all values in tables; a value with its mark is one."""
    inner = node.items() if isinstance(node, Mapping) else enumerate(node)
    for key, value in inner:
        path = f"{prefix}{key}"
        tables = isinstance(value, Mapping) and "value" not in value
        if tables or (isinstance(value, list) and any(isinstance(entry, dict) for entry in value)):
            yield from paths_of(value, f"{path}.")
        else:
            yield path


def _below(node: Any, step: str, here: str, path: str) -> Any:
    inner = node.setdefault(step, {}) if isinstance(node, dict) else node[_index(node, step, path)]
    if not isinstance(inner, dict | list):
        raise InputError(f"override {path!r}: {here} is a value, not a table.")
    return inner


def _place(node: Any, step: str, value: object, path: str) -> None:
    if isinstance(node, dict):
        node[step] = value
    else:
        node[_index(node, step, path)] = value


def _index(node: list[Any], step: str, path: str) -> int:
    if not re.fullmatch(r"\d{1,6}", step) or int(step) >= len(node):
        raise InputError(
            f"override {path!r}: {step!r} must be a whole number from 0 to {len(node) - 1}."
        )
    return int(step)


def _value(value: object) -> object:
    """Return the TOML value that a text from a command line spells, or the text itself."""
    if not isinstance(value, str):
        return value
    try:
        result = tomllib.loads(f"value = {value}")
    except (ValueError, RecursionError):
        return value
    return result["value"] if set(result) == {"value"} else value
