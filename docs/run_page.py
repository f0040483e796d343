"""Run a page whose commands and outputs are plain Markdown, and compare what it shows.

``python docs/run_page.py docs/tutorials/film-to-speed.md`` follows the page in an empty folder,
with files that it links to, and fails where a number differs by a part in ten, or a word.
With ``--write``, what was printed and drawn goes into the page and beside it.

A ``text`` block holds what the ``sh`` or ``python`` block before it prints; figures are files that
these write, under the names by which the page shows them. A line ``...`` stands for lines that the
page leaves out.
"""

import argparse
import contextlib
import io
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

BLOCK = re.compile(r"^```(sh|python|text)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"\]\((\.\./howto/files/[^)]+)\)")
FIGURE = re.compile(r"\]\((\.\./figures/[^)]+)\)")
NUMBER = re.compile(r"(?<![\w.])[-\N{MINUS SIGN}]?\d+(?:\.\d+)?(?![\w.]*\w)")
NEAR = 0.1
"""Part by which numbers may differ: those of other processors and versions do."""


def printed(page: Path, folder: Path) -> list[str]:
    """Return what the blocks of a page print that runs in a folder, in their order."""
    text = page.read_text(encoding="utf-8")
    for link in FILE.findall(text):
        shutil.copy(page.parent / link, folder)
    scripts = str(Path(sys.executable).parent)
    known = os.environ | {"COLUMNS": "100", "NO_COLOR": "1", "MPLBACKEND": "agg"}
    known["PATH"] = os.pathsep.join([scripts, os.environ["PATH"]])
    names: dict[str, object] = {}
    found = []
    for kind, code in BLOCK.findall(text):
        if kind == "sh":
            done = subprocess.run(
                ["sh", "-ec", code], cwd=folder, env=known, stdout=subprocess.PIPE, check=True
            )
            found.append(done.stdout.decode())
        elif kind == "python":
            out = io.StringIO()
            with contextlib.chdir(folder), contextlib.redirect_stdout(out):
                exec(compile(code, page.name, "exec"), names)
            found.append(out.getvalue())
    return found


def shown(text: str) -> list[str]:
    """Return what a page shows below each block that prints, empty where that is nothing."""
    found = list[str]()
    for kind, content in BLOCK.findall(text):
        if kind == "text":
            found[-1] = content
        else:
            found.append("")
    return found


def differences(old: str, new: str) -> Iterator[str]:
    """Yield lines that differ in words, or in numbers by more than a part."""
    lines = [[line.split() for line in one.splitlines() if line.strip()] for one in (old, new)]
    if ["..."] in lines[0]:  # lines that the page leaves out
        cut = lines[0].index(["..."])
        lines[0].pop(cut)
        lines[1] = lines[1][:cut] + lines[1][len(lines[1]) - (len(lines[0]) - cut) :]
    if len(lines[0]) != len(lines[1]):
        yield f"{len(lines[0])} lines are shown and {len(lines[1])} are printed"
    for left, right in zip(*lines, strict=False):
        numbers = [
            [float(x.replace("\N{MINUS SIGN}", "-")) for x in NUMBER.findall(" ".join(one))]
            for one in (left, right)
        ]
        size = max(map(abs, numbers[0]), default=0.0)
        words = [NUMBER.sub("", " ".join(one)) for one in (left, right)]
        near = len(numbers[0]) == len(numbers[1]) and all(
            abs(a - b) <= NEAR * size for a, b in zip(*numbers, strict=True)
        )
        if words[0] != words[1] or not near:
            yield f"{' '.join(left)}\n  now: {' '.join(right)}"


def written(text: str, outputs: list[str]) -> str:
    """Return a page with other outputs."""
    rest = iter(outputs)
    last = [""]

    def one(match: re.Match[str]) -> str:
        if match[1] != "text":
            last[0] = next(rest)
            return match[0]
        shown_lines = last[0].strip("\n").rstrip()
        return f"```text\n{shown_lines}\n```"

    return BLOCK.sub(one, text)


def main() -> None:
    """Run a page; exit with 1 where it shows something else."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("page", type=Path)
    parser.add_argument("--write", action="store_true")
    asked = parser.parse_args()
    page = asked.page.resolve()
    text = page.read_text(encoding="utf-8")
    with TemporaryDirectory() as place:
        folder = Path(place)
        outputs = printed(page, folder)
        if asked.write:
            for link in FIGURE.findall(text):
                shutil.copy(folder / Path(link).name, page.parent / link)
            page.write_text(written(text, outputs), encoding="utf-8")
            return
    blocks = zip(shown(text), outputs, strict=True)
    found = [line for old, new in blocks if old for line in differences(old, new)]
    print(*found, sep="\n")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
