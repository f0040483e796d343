"""JSON documents, and files and folders that are written whole or not at all."""

import json
import math
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stickslip.errors import InputError

__all__ = ["document", "json_text", "write_file", "write_folder"]

SCHEMA_VERSION = 1


def document(kind: str, content: Mapping[str, Any]) -> dict[str, Any]:
    """Return a JSON document of a kind, with the version of its form.

    Parameters
    ----------
    kind : str
        What the document holds, part of its ``schema``.
    content : mapping of str to object
        What it says; NaN and infinity become null.

    Returns
    -------
    dict of str to object
        Schema, version of the package, and the content.

    Examples
    --------
    >>> document("fit", {"rms": math.nan})["rms"] is None
    True
    """
    from importlib.metadata import version

    head = {"schema": f"stickslip/{kind}/{SCHEMA_VERSION}", "stickslip": version("stickslip")}
    return {**head, **_finite(content)}


def json_text(content: Mapping[str, Any]) -> str:
    """Return a JSON document as text."""
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_folder(folder: Path, files: Mapping[str, str | bytes]) -> None:
    """Write files into a folder; each appears whole, and all were made before the first.

    Parameters
    ----------
    folder : Path
        The folder; made if it is not there.
    files : mapping of str to str or bytes
        Content by name; texts are written in UTF-8.

    Raises
    ------
    InputError
        If something cannot be written.
    """
    made: dict[Path, Path] = {}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            content = text if isinstance(text, bytes) else text.encode("utf-8")
            made[folder / name] = _beside(folder / name, content)
        for path, temporary in made.items():
            temporary.replace(path)
    except OSError as error:
        raise InputError(f"{folder} cannot be written: {error.strerror}.") from error
    finally:
        for temporary in made.values():
            temporary.unlink(missing_ok=True)


def write_file(path: Path, content: bytes) -> None:
    """Write a file so that it appears whole or not at all.

    Parameters
    ----------
    path : Path
        The file; its folder is made if it is not there.
    content : bytes
        What it holds.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary = _beside(path, content)
        try:
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror}.") from error


def _finite(value: Any) -> Any:
    """Replace what JSON has no word for by null, and -0.0 by 0.0."""
    if isinstance(value, float):
        return value + 0.0 if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return value


def _beside(path: Path, content: bytes) -> Path:
    """Write a temporary file beside a path; leave none if that fails."""
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        temporary = Path(file.name)
        try:
            file.write(content)
            file.flush()
            temporary.chmod(0o644)
        except BaseException:
            temporary.unlink()
            raise
    return temporary
