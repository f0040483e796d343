"""Exported C, compiled and called."""

import ctypes
import shutil
import subprocess
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

STRICT = (
    "-std=c99",
    "-O2",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wshadow",
    "-Werror",
)


def compiler() -> str:
    """Return the C compiler, or skip the test."""
    found = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if found is None:
        pytest.skip("no C compiler (cc, gcc, clang) is installed")
    return found


def library(folder: Path, files: Mapping[str, str]) -> ctypes.CDLL:
    """Compile files with all warnings as errors."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    sources = [name for name in files if name.endswith(".c")]
    command = [compiler(), *STRICT, "-shared", "-fPIC", "-o", "law.so", *sources, "-lm"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return ctypes.CDLL(str(folder / "law.so"))


def number(library: ctypes.CDLL, name: str) -> Callable[..., float]:
    """Return a function with one result."""
    function: Any = library[name]
    function.restype = ctypes.c_double
    return lambda *arguments: function(*map(ctypes.c_double, arguments))


def numbers(
    library: ctypes.CDLL, name: str, results: Sequence[str]
) -> Callable[..., dict[str, float]]:
    """Return a function with several results."""
    fields = [(result, ctypes.c_double) for result in results]
    kind = type("Result", (ctypes.Structure,), {"_fields_": fields})
    function: Any = library[name]
    function.restype = kind

    def call(*arguments: float) -> dict[str, float]:
        found = function(*map(ctypes.c_double, arguments))
        return {result: getattr(found, result) for result in results}

    return call
