"""Build wheel and sdist, and use them as the README says, in empty environments off the network.

``python -m tools.package``: builds in dist/, checks what was built with twine, and downloads what
that depends on to wheelhouse/. From there alone the wheel is installed in an empty environment, in
which the first commands of the README run; each extra is then added to a copy; the sdist is built
and installed in another. Prints sizes and times. ``--extras xlsx,mdf`` tries these only.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
DIST, HOUSE = ROOT / "dist", ROOT / "wheelhouse"
FOR_CONTRIBUTORS = {"bench", "dev", "docs"}
FIRST = re.compile(r"^```sh\n(pip install .*?)^```$", re.DOTALL | re.MULTILINE)
"""The first commands of the README: the one that installs, and what it is followed by."""
SCRIPTS = "Scripts" if os.name == "nt" else "bin"


def run(*command: object, **settings: object) -> float:
    """Run a command, which must succeed; return how long it took [s]."""
    begun = time.perf_counter()
    words = [str(item) for item in command]
    print("$", " ".join(words), flush=True)
    environment = {name: v for name, v in os.environ.items() if name != "PYTHONPATH"}
    subprocess.run(words, check=True, env=environment, **settings)  # type: ignore[call-overload]
    return time.perf_counter() - begun


def environment(place: Path) -> Path:
    """Make an empty environment; return its interpreter."""
    run(sys.executable, "-m", "venv", place)
    return place / SCRIPTS / "python"


def install(python: Path, *wanted: object) -> float:
    """Install from the wheelhouse alone."""
    seconds = run(
        python, "-m", "pip", "--disable-pip-version-check", "install", "--quiet", "--no-index",
        "--find-links", HOUSE, "--find-links", DIST, *wanted,
    )  # fmt: skip
    run(python, "-m", "pip", "--disable-pip-version-check", "check")
    return seconds


def megabytes(folder: Path) -> int:
    return sum(item.stat().st_size for item in folder.rglob("*") if item.is_file()) // 1_000_000


def built(tools: Path) -> tuple[Path, Path]:
    """Build wheel and sdist, and check them; return both."""
    shutil.rmtree(DIST, ignore_errors=True)
    for old in HOUSE.glob("stickslip-*"):
        old.unlink()
    pip = (tools, "-m", "pip", "--disable-pip-version-check")
    run(*pip, "install", "--quiet", "build", "twine")
    run(tools, "-m", "build", "--outdir", DIST, ROOT)
    run(tools, "-m", "twine", "check", "--strict", *DIST.iterdir())
    (wheel,), (sdist,) = DIST.glob("*.whl"), DIST.glob("*.tar.gz")
    return wheel, sdist


def download(tools: Path, *wanted: object) -> None:
    run(
        tools, "-m", "pip", "--disable-pip-version-check", "download", "--quiet", "--only-binary",
        ":all:", "--dest", HOUSE, "--find-links", HOUSE, *wanted,
    )  # fmt: skip


def follow_the_readme(python: Path, folder: Path) -> None:
    """Install from the wheelhouse, and run what follows in the first block of the README."""
    result = FIRST.search((ROOT / "README.md").read_text(encoding="utf-8"))
    if result is None:
        sys.exit("README.md has no block that begins with pip install.")
    _, *others = [line.partition("#")[0].split() for line in result[1].splitlines()]
    print(f"installed in {install(python, 'stickslip'):.0f} s, {megabytes(python.parents[1])} MB")
    for name, *words in others:
        print(f"took {run(python.parent / name, *words, cwd=folder):.0f} s")


def extras_of(python: Path) -> list[str]:
    """Return the extras that the doctor of an environment finds, if its self-test passes."""
    done = subprocess.run(
        [python, "-m", "stickslip", "doctor", "--json"], check=True, stdout=subprocess.PIPE,
        env={name: v for name, v in os.environ.items() if name != "PYTHONPATH"},
    )  # fmt: skip
    return list(json.loads(done.stdout)["extras"]["present"])


def try_extra(extra: str, empty: Path, size: int) -> None:
    """Add an extra to a copy of an environment."""
    copy = empty.with_name(f"with-{extra}")
    shutil.copytree(empty, copy, symlinks=True, copy_function=os.link)
    python = copy / SCRIPTS / "python"
    install(python, f"stickslip[{extra}]")
    if extra not in extras_of(python):
        sys.exit(f"stickslip[{extra}] was installed, and stickslip doctor does not find it.")
    print(f"stickslip[{extra}] adds {megabytes(copy) - size} MB")
    shutil.rmtree(copy)


def main(arguments: Sequence[str] | None = None) -> None:
    known = sorted(PROJECT["project"]["optional-dependencies"].keys() - FOR_CONTRIBUTORS)
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--extras", default=",".join(known), help="joined by commas; default: all")
    asked = [item for item in parser.parse_args(arguments).extras.split(",") if item]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        os.environ["STICKSLIP_CACHE"] = str(folder / "cache")
        tools = environment(folder / "tools")
        wheel, sdist = built(tools)
        download(tools, wheel, *PROJECT["build-system"]["requires"])
        print(f"{len([*HOUSE.iterdir()])} files of {megabytes(HOUSE)} MB are enough for the wheel.")
        empty = environment(folder / "empty").parents[1]
        follow_the_readme(empty / SCRIPTS / "python", folder)
        size = megabytes(empty)
        if asked:
            download(tools, f"{wheel}[{','.join(asked)}]")
        for extra in asked:
            try_extra(extra, empty, size)
        other = environment(folder / "from-sdist")
        install(other, sdist)
        extras_of(other)


if __name__ == "__main__":
    main()
