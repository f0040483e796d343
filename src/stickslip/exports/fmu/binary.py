"""The binary of an FMU: object code of the solver, joined with a little C by the C compiler."""

import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path

from stickslip.errors import CompilationError, InputError
from stickslip.exports.fmu.description import Fmi

__all__ = ["check_platform", "compiled", "folder_of"]

FOLDERS: Mapping[tuple[str, Fmi], str] = {
    ("x86_64", 2): "linux64",
    ("x86_64", 3): "x86_64-linux",
    ("aarch64", 3): "aarch64-linux",
}
"""Folder of the binaries by processor and version of FMI, which 2.0 has for x86-64 alone."""
COMPILERS = ("cc", "gcc", "clang")
FLAGS = (
    "-std=c99", "-O1", "-fPIC", "-shared", "-s", "-ffp-contract=off",
    "-Wl,-z,defs", "-Wl,-Bsymbolic", "-Wl,--version-script=exports.map", "-Wl,--build-id=none",
)  # fmt: skip


def folder_of(fmi: Fmi) -> str:
    """Return the folder of the binaries of this platform in an FMU."""
    return FOLDERS[platform.machine(), fmi]


def check_platform(fmi: Fmi) -> str:
    """Return the C compiler; refuse early where no binary can be made.

    Raises
    ------
    InputError
        If the platform is another one, or there is no C compiler.
    """
    if sys.platform != "linux" or (platform.machine(), fmi) not in FOLDERS:
        raise InputError(
            f"an FMU for FMI {fmi}.0 is made on Linux on x86-64"
            f"{' or ARM 64' if fmi == 3 else ''}, and this is {platform.system()} on"
            f" {platform.machine()}: export the rig on such a machine."
        )
    for name in COMPILERS:
        path = shutil.which(name)
        if path is not None:
            return path
    raise InputError(
        "an FMU is linked by the C compiler of the system, and there is none (cc, gcc or clang):"
        " install one, as with `apt install gcc` (it is not needed to run the FMU)."
    )


def compiled(objects: Mapping[str, bytes], header: str, fmi: Fmi) -> bytes:
    """Return the binary.

    Parameters
    ----------
    objects : mapping of str to bytes
        Object code by file name.
    header : str
        Numbers of the model in C.
    fmi : {2, 3}
        Version of the standard.

    Returns
    -------
    bytes
        A shared library.

    Raises
    ------
    CompilationError
        If the compiler fails.
    """
    compiler = check_platform(fmi)
    sources = files("stickslip.exports.fmu").joinpath("c")
    texts = {name: sources.joinpath(name).read_bytes() for name in ("instance.h", f"fmi{fmi}.c")}
    texts["model.h"] = header.encode()
    texts["exports.map"] = f"{{ global: fmi{fmi}*; local: *; }};\n".encode()
    with tempfile.TemporaryDirectory(prefix="stickslip-fmu-") as name:
        folder = Path(name)
        for file, content in (texts | dict(objects)).items():
            (folder / file).write_bytes(content)
        command = [compiler, *FLAGS, "-o", "fmu.so", f"fmi{fmi}.c", *objects, "-lm"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            raise CompilationError(f"{' '.join(command)} failed: {done.stderr.strip()}")
        return (folder / "fmu.so").read_bytes()
