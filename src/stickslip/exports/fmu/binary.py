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

FOLDERS: Mapping[Fmi, str] = {2: "linux64", 3: "x86_64-linux"}
"""Folder of the binaries by version of FMI."""
COMPILERS = ("cc", "gcc", "clang")
FLAGS = (
    "-std=c99", "-O1", "-fPIC", "-shared", "-s", "-ffp-contract=off",
    "-Wl,-z,defs", "-Wl,-Bsymbolic", "-Wl,--version-script=exports.map", "-Wl,--build-id=none",
)  # fmt: skip


def compiler_here() -> str:
    """Return the C compiler; refuse early where no binary can be made."""
    if sys.platform != "linux" or platform.machine() != "x86_64":
        raise InputError(
            f"an FMU is made on Linux on x86-64, and this is {platform.system()} on"
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
    """Return the binary."""
    compiler = compiler_here()
    sources = files("stickslip.exports.fmu").joinpath("c")
    names = ("instance.h", "exchange.h", "calls.h", f"fmi{fmi}.c")
    texts = {name: sources.joinpath(name).read_bytes() for name in names}
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
